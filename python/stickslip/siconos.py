"""Siconos's global friction problem, M v = q + H r, u = H' v + b, with the signs of both sides.

| here | Siconos |
| --- | --- |
| K, f | M, q |
| u, m | v |
| distance g - C_n u >= 0 | normal of u = H' v + b: columns -C_n', b = g |
| slip C_t u - w_t_last | tangents of u: columns C_t', b = -w_t_last |
| p_n, of the body on the obstacle | normal of r, the same number |
| p_t, of the body on the obstacle | minus the tangents of r, which is on the body |

The rows of a contact follow each other: normal, tangents.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu
from numpy.typing import ArrayLike, NDArray

from ._judge import Posed, Solver
from ._problem import ContactProblem, vector

Array = NDArray[np.float64]


class GlobalFriction(NamedTuple):
    """What `siconos.numerics.GlobalFrictionContactProblem` is made of."""

    dimension: int
    M: Any
    H: Any
    q: Array
    b: Array
    mu: Array


def to_siconos(
    problem: ContactProblem, force: ArrayLike, gap: ArrayLike = 0.0, w_t_last: ArrayLike | None = None, mu: ArrayLike | None = None
) -> GlobalFriction:
    """One increment of `problem` as Siconos has it.

    Args:
        force: N, (n_u,). gap: m, a number or (n_c,). w_t_last: m, (n_c,) or (n_c, d). mu: of this increment where it changes, (n_c,).
    """
    n_c, d = problem.n_c, problem.tangents
    if d == 0:
        raise ValueError("C_t: Siconos's friction problems need tangents")
    w = np.zeros((n_c, d)) if w_t_last is None else np.asarray(w_t_last, dtype=float).reshape(n_c, d)
    order = np.arange((1 + d) * n_c).reshape(1 + d, n_c).T.ravel()
    H = sp.csr_array(sp.vstack([-problem.C_n, *problem.C_t], format="csr"))[order].T.tocsc()
    b = np.column_stack([vector("gap", gap, n_c), -w]).ravel()
    coefficients = problem.mu if mu is None else vector("mu", mu, n_c)
    return GlobalFriction(1 + d, problem.K, H, vector("force", force, problem.n_u), b, coefficients)


def from_siconos(M: Any, H: Any, q: ArrayLike, b: ArrayLike, mu: ArrayLike) -> Posed:
    """The increment that Siconos's matrices pose, with its problem, force, gap and w_t_last."""
    contacts = len(np.atleast_1d(np.asarray(mu, dtype=float)))
    H = sp.csc_array(H)
    dimension, left = divmod(H.shape[1], contacts)
    if left or dimension not in (2, 3):
        raise ValueError(f"H has {H.shape[1]} columns, expected 2 or 3 for each of {contacts} contacts in mu")
    rows = H.T.tocsr()
    normal, *tangents = (rows[k::dimension] for k in range(dimension))
    problem = ContactProblem(M, -normal, tangents, mu)
    by_node = vector("b", b, dimension * contacts).reshape(contacts, dimension)
    nothing = (np.zeros(problem.n_u), np.zeros(contacts), np.zeros((contacts, dimension - 1)))
    force = vector("q", q, problem.n_u)
    return Posed(problem, force, by_node[:, 0].copy(), -by_node[:, 1:], problem.mu, nothing)


def answer(problem: ContactProblem, v: ArrayLike, r: ArrayLike) -> tuple[Array, Array, Array]:
    """(u, p_n, p_t) of Siconos's `v` (n_u,) and reactions `r` (n_c (1 + d),), as the judge wants them."""
    by_node = vector("r", r, problem.n_c * (1 + problem.tangents)).reshape(problem.n_c, -1)
    return vector("v", v, problem.n_u), by_node[:, 0].copy(), -by_node[:, 1:]


def reactions(p_n: ArrayLike, p_t: ArrayLike) -> Array:
    """Siconos's `r` of contact forces here, (n_c (1 + d),)."""
    p_n = np.asarray(p_n, dtype=float)
    return np.column_stack([p_n, -np.asarray(p_t, dtype=float).reshape(len(p_n), -1)]).ravel()


#: Siconos 4.4 frees what a problem still points to; what it has seen is kept for as long as it may run.
_SEEN: list[Any] = []


def fc2d(name: str, tolerance: float = 1e-12, max_iterations: int = 100_000) -> Solver:
    """A solver of Siconos for problems in the plane, as `judge` and `compare` take it: "NSGS", "LEMKE", "CPG", ...

    Siconos has the contact forces as its unknowns: the body is condensed to its compliance, in units near 1.

    Args:
        name: what follows SICONOS_FRICTION_2D_.
        tolerance, max_iterations: what Siconos is told.
    """
    from siconos import numerics  # pyright: ignore[reportAttributeAccessIssue]

    def solve(posed: Posed) -> tuple[Array, Array, Array]:
        problem, cache = posed.problem, posed.cache
        if problem.tangents != 1:
            raise ValueError("fc2d: a problem in the plane expected")
        if "lu" not in cache:
            cache["lu"], (cache["W"], cache["C"]) = splu(problem.K), problem.condensed()
        lu, W, C = cache["lu"], cache["W"], cache["C"]
        signs = np.tile([-1.0, 1.0], problem.n_c)
        free = signs * (C @ lu.solve(posed.force)) + np.column_stack([posed.gap, -posed.w_t_last[:, 0]]).ravel()
        length = float(abs(free).max()) or 1.0
        force = length / float(abs(W).max())
        scaled = np.asfortranarray(signs[:, None] * (0.5 * (W + W.T)) * signs * (force / length))
        r, v, q = reactions(*posed.last[1:]) / force, np.zeros(len(free)), free / length
        options = numerics.SolverOptions(getattr(numerics, "SICONOS_FRICTION_2D_" + name))
        options.dparam[numerics.SICONOS_DPARAM_TOL] = tolerance
        options.iparam[numerics.SICONOS_IPARAM_MAX_ITER] = max_iterations
        local = numerics.FrictionContactProblem(2, problem.n_c, scaled, q, posed.mu.copy())
        _SEEN.append((local, options, scaled, q))
        info = numerics.fc2d_driver(local, r, v, options)
        if info != 0:
            raise RuntimeError(f"fc2d_driver returns {info}")
        _, p_n, p_t = answer(problem, np.zeros(problem.n_u), r * force)
        return lu.solve(posed.force - C.T @ np.column_stack([p_n, p_t]).ravel()), p_n, p_t

    return solve
