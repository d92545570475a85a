"""Derivatives of a solution along its contact statuses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import ArrayLike
from scipy.sparse.linalg import splu

from ._arrays import Array, finite, matrix, rows_or_row, symmetric
from ._kinds import OPEN, SLIP

if TYPE_CHECKING:
    from ._problem import ContactProblem
    from ._result import Result


@dataclass(frozen=True, eq=False)
class Derivative:
    """The change of a solution in a direction of its data. See `ContactProblem.derivative`.

    Attributes
    ----------
    u : ndarray, shape (m, n_u)
        Of the displacements.
    p_n : ndarray, shape (m, n_c)
        Of the normal contact forces.
    p_t : ndarray, shape (m, n_c, d)
        Of the tangential contact forces.
    """

    u: Array
    p_n: Array
    p_t: Array


def _rows(name: str, values: ArrayLike, m: int, width: int) -> Array:
    array = finite(name, values)
    if array.shape not in ((), (width,), (m, width)):
        raise ValueError(f"{name} has the shape {array.shape}, expected {rows_or_row((m, width))}")
    return np.broadcast_to(array, (m, width))


def of(problem: ContactProblem, result: Result, force: ArrayLike, gap: ArrayLike, mu: ArrayLike, K: Any) -> Derivative:
    """`ContactProblem.derivative`."""
    m, n_c, d, n_u = len(result.t), problem.n_c, problem.tangents, problem.n_u
    if result.p_n.shape != (m, n_c) or result.u.shape[1:] != (n_u,):
        raise ValueError("result is of another problem")
    if result._begun is not None:
        raise ValueError("result: it goes on from an earlier increment; join all of the stepper's: first.joined(*later)")
    if not result.converged or result.kept != tuple(range(m)):
        raise ValueError('result: a history that converged, with the displacements of all increments (keep_u="all"), is expected')
    divided = [record["index"] for record in result.records if record["parts"] != 1]
    if divided:
        raise ValueError(f"result: increment {divided[0] - 1} was divided, so that its path is not known; take more increments, and no exact path")
    d_force, d_gap, d_mu = _rows("force", force, m, n_u), _rows("gap", gap, m, n_c), _rows("mu", mu, m, n_c)
    d_K = None if K is None else matrix("K", K, sp.csc_array)
    if d_K is not None:
        if d_K.shape != (n_u, n_u):
            raise ValueError(f"K has the shape {d_K.shape}, expected {(n_u, n_u)}")
        d_K = symmetric(d_K, True)
    stiffness, C_n, C_t = sp.csr_array(problem.K), problem.C_n, problem.C_t
    found = Derivative(np.zeros((m, n_u)), np.zeros((m, n_c)), np.zeros((m, n_c, d)))
    moved, scale = np.zeros((n_c, d)), float(np.abs(stiffness.diagonal()).mean())
    for k in range(m):
        of_contact = C_n.T @ result.p_n[k] + sum(C.T @ result.p_t[k, :, i] for i, C in enumerate(C_t))
        rest = stiffness @ result.u[k] + of_contact - result.force[k]
        if np.abs(rest).max() > 1e-6 * max(np.abs(result.force[k]).max(), np.abs(of_contact).max()):
            raise ValueError(f"result is of another problem: its forces and displacements of increment {k} are not in equilibrium here")
        size = np.sqrt((result.p_t[k] ** 2).sum(axis=1))
        touches = result.contact[k] != OPEN
        slips = touches & (result.contact[k] == SLIP)
        sticks = touches & ~slips
        along = np.divide(result.p_t[k], size[:, None], out=np.zeros_like(result.p_t[k]), where=size[:, None] > 0)
        # Nodes that slip have p_t = mu p_n s, and in space s turns with the direction of the slip.
        tangent = stiffness
        right = d_force[k] - (d_K @ (result.u[k] + result.u_rest[k]) if d_K is not None else 0.0)
        carried = sp.csr_array(C_n.T)
        turns = np.zeros((n_c, d, d))
        if d:
            step = np.stack([C @ result.u[k] + C @ result.u_rest[k] for C in C_t], axis=1) - result.w_t_last[k]
            length = np.sqrt((step**2).sum(axis=1))
            if d == 2:
                share = np.divide(size, length, out=np.zeros(n_c), where=slips & (length > 0))
                turns = share[:, None, None] * (np.eye(2) - along[:, :, None] * along[:, None, :])
            bound = slips * result.mu[k]
            for i in range(d):
                carried = carried + C_t[i].T @ sp.diags_array(bound * along[:, i])
                right = right - C_t[i].T @ (slips * along[:, i] * result.p_n[k] * d_mu[k] - (turns[:, i] * moved).sum(axis=1))
                for j in range(d):
                    tangent = tangent + C_t[i].T @ sp.diags_array(turns[:, i, j]) @ C_t[j]
        held = [C_n[touches], *(C[sticks] for C in C_t)]
        forces = [sp.csc_array(carried)[:, touches], *(C[sticks].T for C in C_t)]
        ends = [d_gap[k][touches], *(moved[sticks, i] for i in range(d))]
        count = sum(rows.shape[0] for rows in held)
        if count:
            # Conditions in the size of the stiffness, so that pivots are of one size.
            forces, held = scale * sp.hstack(forces), scale * sp.vstack(held)
            tangent = sp.block_array([[tangent, forces], [held, sp.csr_array((count, count))]])
        try:
            solution = splu(sp.csc_matrix(tangent)).solve(np.concatenate([right, *(scale * end for end in ends)]))
        except RuntimeError:
            raise ValueError(f"result: the forces of increment {k} are not determined by its statuses") from None
        u, p = solution[:n_u], scale * solution[n_u:]
        found.u[k] = u
        found.p_n[k, touches] = p[: touches.sum()] + 0.0
        now = np.stack([C @ u for C in C_t], axis=1) if d else moved
        found.p_t[k, slips] = (along * (d_mu[k] * result.p_n[k] + result.mu[k] * found.p_n[k])[:, None])[slips]
        found.p_t[k] += slips[:, None] * np.einsum("kij,kj->ki", turns, now - moved)
        for i in range(d):
            found.p_t[k, sticks, i] = p[touches.sum() + i * sticks.sum() :][: sticks.sum()] + 0.0
        moved = now
    return found
