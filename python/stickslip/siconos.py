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
from numpy.typing import ArrayLike

from ._arrays import Array, forces_of, tangential, vector
from ._judge import Posed, Solver
from ._problem import ContactProblem
from ._words import counted


class GlobalFriction(NamedTuple):
    """The arguments of `siconos.numerics.GlobalFrictionContactProblem`, in this order; see `stickslip.siconos.to_siconos`."""

    dimension: int
    M: Any
    H: Any
    q: Array
    b: Array
    mu: Array

    def __repr__(self) -> str:
        return f"<GlobalFriction in {self.dimension}D, M {self.M.shape}, H {self.H.shape}>"


def to_siconos(
    problem: ContactProblem, force: ArrayLike, gap: ArrayLike = 0.0, w_t_last: ArrayLike | None = None, mu: ArrayLike | None = None
) -> GlobalFriction:
    """One increment of `problem` as Siconos has it.

    Parameters
    ----------
    problem : ContactProblem
        With tangents.
    force : (n_u,)
        N.
    gap : float or (n_c,)
        m.
    w_t_last : (n_c,) or (n_c, d), optional
        Tangential displacements before the increment, m.
    mu : float or (n_c,), optional
        Friction coefficients of this increment where they change.

    Returns
    -------
    GlobalFriction

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    >>> ss.siconos.to_siconos(problem, [40.0, -100.0], gap=1e-5)
    <GlobalFriction in 2D, M (2, 2), H (2, 2)>
    """
    n_c, d = problem.n_c, problem.tangents
    if d == 0:
        raise ValueError("C_t: Siconos's friction problems need tangents")
    w = tangential("w_t_last", w_t_last, n_c, d)
    order = np.arange((1 + d) * n_c).reshape(1 + d, n_c).T.ravel()
    H = sp.csr_array(sp.vstack([-problem.C_n, *problem.C_t], format="csr"))[order].T.tocsc()
    b = np.column_stack([vector("gap", gap, n_c), -w]).ravel()
    coefficients = problem.mu.copy() if mu is None else vector("mu", mu, n_c)
    return GlobalFriction(1 + d, problem.K.copy(), H, forces_of("force", force, problem.n_u), b, coefficients)


def from_siconos(M: Any, H: Any, q: ArrayLike, b: ArrayLike, mu: ArrayLike) -> Posed:
    """The increment that Siconos's matrices pose.

    Parameters
    ----------
    M : (n_u, n_u) matrix
        K, N/m.
    H : (n_u, n_c (1 + d)) matrix
        Columns of a contact one after the other: normal, tangents.
    q : (n_u,)
        Force, N.
    b : (n_c (1 + d),)
        Gaps, and tangential displacements before the increment with the opposite sign, m.
    mu : (n_c,)
        Friction coefficients.

    Returns
    -------
    Posed
        With its problem, force, gap and w_t_last.

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    >>> _, M, H, q, b, mu = ss.siconos.to_siconos(problem, [40.0, -100.0], gap=1e-5)
    >>> posed = ss.siconos.from_siconos(M, H, q, b, mu)
    >>> posed.force, posed.gap
    (array([  40., -100.]), array([1.e-05]))
    """
    contacts = len(np.atleast_1d(np.asarray(mu, dtype=float)))
    H = sp.csc_array(H)
    dimension, left = divmod(H.shape[1], contacts)
    if left or dimension not in (2, 3):
        raise ValueError(f"H has {counted(H.shape[1], 'column')}, expected 2 or 3 for each of {counted(contacts, 'contact')} in mu")
    rows = H.T.tocsr()
    normal, *tangents = (rows[k::dimension] for k in range(dimension))
    problem = ContactProblem(M, -normal, tangents, mu)
    by_node = vector("b", b, dimension * contacts).reshape(contacts, dimension)
    nothing = (np.zeros(problem.n_u), np.zeros(contacts), np.zeros((contacts, dimension - 1)))
    force = forces_of("q", q, problem.n_u)
    return Posed(problem, force, by_node[:, 0].copy(), -by_node[:, 1:], problem.mu.copy(), nothing)


def answer(problem: ContactProblem, v: ArrayLike, r: ArrayLike) -> tuple[Array, Array, Array]:
    """Siconos's answer as the judge wants it.

    Parameters
    ----------
    problem : ContactProblem
        Its problem here.
    v : (n_u,)
        Displacements, m.
    r : (n_c (1 + d),)
        Reactions, N.

    Returns
    -------
    tuple of arrays
        (u, p_n, p_t).

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    >>> ss.siconos.answer(problem, [5e-6, 0.0], [100.0, -30.0])
    (array([5.e-06, 0.e+00]), array([100.]), array([[30.]]))
    """
    by_node = vector("r", r, problem.n_c * (1 + problem.tangents)).reshape(problem.n_c, -1)
    return vector("v", v, problem.n_u), by_node[:, 0].copy(), -by_node[:, 1:]


def reactions(p_n: ArrayLike, p_t: ArrayLike) -> Array:
    """Siconos's reactions of contact forces here.

    Parameters
    ----------
    p_n, p_t : (n_c,) and (n_c,) or (n_c, d)
        Contact forces, N.

    Returns
    -------
    (n_c (1 + d),) array
        N.

    Examples
    --------
    >>> import stickslip as ss
    >>> ss.siconos.reactions([100.0], [30.0])
    array([100., -30.])
    """
    p_n = np.asarray(p_n, dtype=float)
    return np.column_stack([p_n, -np.asarray(p_t, dtype=float).reshape(len(p_n), -1)]).ravel()


#: Siconos 4.4 frees what a problem still points to; what it has seen is kept for as long as it may run.
_SEEN: list[Any] = []


def fc2d(name: str, tolerance: float = 1e-12, max_iterations: int = 100_000) -> Solver:
    """A solver of Siconos for problems in the plane, as `judge` and `compare` take it: "NSGS", "LEMKE", "CPG", ...

    Siconos has the contact forces as its unknowns: the body is condensed to its compliance, in units near 1.

    Parameters
    ----------
    name : str
        What follows SICONOS_FRICTION_2D_.
    tolerance : float
        What Siconos is told.
    max_iterations : int
        What Siconos is told.

    Returns
    -------
    callable

    Raises
    ------
    ImportError
        Siconos is not installed.

    Examples
    --------
    >>> import stickslip as ss
    >>> ss.compare(model, {"NSGS": ss.siconos.fc2d("NSGS")})  # doctest: +SKIP
    """
    from siconos import numerics  # pyright: ignore[reportAttributeAccessIssue]

    def solve(posed: Posed) -> tuple[Array, Array, Array]:
        problem, cache = posed.problem, posed.cache
        if problem.tangents != 1:
            raise ValueError("fc2d: a problem in the plane expected")
        if "lu" not in cache:
            cache["lu"], (cache["W"], cache["C"]) = splu(problem.K), problem.compliance()
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
