"""Contact problems made of matrices."""

from __future__ import annotations

import numbers as numbers_abc
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
import scipy.sparse as sp
from numpy.typing import ArrayLike, NDArray

from . import _core, _dependent
from ._result import Result

if TYPE_CHECKING:
    from ._judge import Posed
    from ._stepper import Stepper
    from .siconos import GlobalFriction

Array = NDArray[np.float64]

#: Called with (increment from 1, time, status, iterations, error); an exception ends the run and comes out.
Callback = Callable[[int, float, str, int, float], object]


class LinearSolver(Protocol):
    """What `linear=` takes beside its words: a direct solver of one's own."""

    def analyze(self, n: int, indptr: NDArray[np.int64], indices: NDArray[np.int64], /) -> object:
        """Once a run: the pattern of the matrix, by columns."""

    def factorize(self, data: Array, /) -> object:
        """Once an iteration: its values; `ZeroDivisionError` says that it is singular."""

    def solve(self, b: Array, /) -> Array:
        """With the last factors: x, (n,)."""
        ...


def vector(name: str, values: ArrayLike, length: int) -> Array:
    """A contiguous, finite vector of that length, of a number or of as many."""
    array = _numbers(name, values)
    if array.ndim > 1 or (array.ndim == 1 and array.shape != (length,)):
        raise ValueError(f"{name} has the shape {array.shape}, expected {(length,)}")
    return np.ascontiguousarray(np.broadcast_to(array, length))


def _numbers(name: str, values: ArrayLike) -> Array:
    if np.iscomplexobj(values):
        raise ValueError(f"{name} is complex")
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} is no array of numbers: {error}") from None
    if not np.isfinite(array).all():
        raise ValueError(f"{name} is not finite")
    return array


def numbers(name: str, values: ArrayLike, shape: tuple[int, ...]) -> Array:
    """An array of this shape, or what numpy makes one of by repeating it."""
    array = _numbers(name, values)
    if 0 in array.shape and 0 not in shape:
        raise ValueError(f"{name} is empty, expected the shape {shape}")
    try:
        return np.broadcast_to(array, shape)
    except ValueError:
        raise ValueError(f"{name} has the shape {array.shape}, expected {shape}") from None


def _matrix(name: str, matrix: Any, kind: Any, shape: tuple[int, int] | None = None) -> Any:
    if np.iscomplexobj(matrix):
        raise ValueError(f"{name} is complex")
    try:
        matrix = kind(matrix, dtype=np.float64, copy=True)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} is no matrix: {error}") from None
    if matrix.ndim != 2 or (shape is not None and matrix.shape != shape):
        raise ValueError(f"{name} has the shape {matrix.shape}, expected {shape}")
    matrix.sum_duplicates()
    if not np.isfinite(matrix.data).all():
        raise ValueError(f"{name} is not finite")
    return matrix


def _compressed(matrix: Any) -> tuple[Any, Any, Any]:
    return matrix.data, matrix.indices.astype(np.int64), matrix.indptr.astype(np.int64)


def keep(keep_u: str | bool | Sequence[int], increments: int) -> bool | list[int]:
    """What the core is told of `keep_u`: numbers from 1, 0 for the last."""
    if isinstance(keep_u, (bool, np.bool_)):
        return bool(keep_u)
    if isinstance(keep_u, str):
        words: dict[str, bool | list[int]] = {"all": True, "none": False, "last": [0]}
        if keep_u not in words:
            raise ValueError(f"keep_u is {keep_u!r}, expected 'all', 'last', 'none' or a list of increments")
        return words[keep_u]
    try:
        return [range(increments)[k] + 1 for k in keep_u]
    except (TypeError, IndexError) as error:
        raise ValueError(f"keep_u: {error}") from None


def _symmetric(K: Any, check: bool) -> Any:
    """K, whose lower triangle is read; refused where that would be another matrix."""
    above, below = ((part.data != 0).any() for part in (sp.triu(K, 1), sp.tril(K, -1)))
    triangle = above != below
    if triangle and not check:
        return K.T.tocsc() if above else K
    if check:
        off, size = abs(K - K.T), abs(K)
    else:
        # By products with a vector, which cost a small part of a difference of matrices.
        x = np.random.default_rng(0).uniform(1.0, 2.0, K.shape[0])
        off, size = abs(K @ x - K.T @ x), abs(K) @ x
    share = off.max() / size.max() if above or below else 0.0
    if share <= 1e-10:
        return K
    cure = "pass check=False, which takes a triangle" if triangle else "where that is rounding, give (K + K.T) / 2"
    what = "has entries on one side of its diagonal only" if triangle else f"differs from its transpose by {share:.1e} of its largest entry"
    raise ValueError(f"K is not symmetric: it {what}; {cure}")


def _options(method: str, setting: str, r_factor: float, tolerance: float | None, max_iterations: int) -> dict[str, Any]:
    """The options of a solve, of the types that the core takes."""
    options: dict[str, Any] = {"method": method, "setting": setting, "r_factor": r_factor, "tolerance": tolerance, "max_iterations": max_iterations}
    kinds: dict[str, tuple[Any, str]] = {
        "method": (str, "a word"), "setting": (str, "a word"), "r_factor": (numbers_abc.Real, "a number"),
        "tolerance": ((numbers_abc.Real, type(None)), "a number or None"), "max_iterations": (numbers_abc.Integral, "a whole number"),
    }
    for name, (kind, words) in kinds.items():
        if not isinstance(options[name], kind):
            raise TypeError(f"{name} is {options[name]!r}, expected {words}")
    return options


class ContactProblem:
    """One body against rigid obstacles, as matrices.

    K u + C_n' p_n + C_t' p_t = f;  C_n u <= g, p_n >= 0;  |p_t| <= mu p_n, against the slip C_t u - w_t_last.

    Args:
        K: stiffness, symmetric positive semidefinite, (n_u, n_u), N/m; sparse or dense.
        C_n: displacements towards the obstacle, (n_c, n_u).
        C_t: displacements along the tangents, (n_c, n_u): one matrix, a pair in three dimensions, None without friction.
        mu: friction coefficients, a number or (n_c,).
        weight: lengths or areas of the contact nodes, m or m², (n_c,): for stresses and the setting "paper".
        free_motions: a basis of the null space of K, (k, n_u): the rigid motions that nothing holds. None: found from K.
        check: whether K is compared with its transpose, entry by entry. With False, it is compared by a product with a vector, and may
            also be a triangle of a symmetric matrix, lower or upper.
    """

    def __init__(
        self, K: Any, C_n: Any, C_t: Any = None, mu: ArrayLike = 0.0, *, weight: ArrayLike | None = None,
        free_motions: ArrayLike | None = None, check: bool = True,
    ) -> None:
        K = _matrix("K", K, sp.csc_array)
        n = K.shape[0]
        if K.shape != (n, n):
            raise ValueError(f"K has the shape {K.shape}, which is not square")
        K = _symmetric(K, check)
        C_n = _matrix("C_n", C_n, sp.csr_array)
        n_c = C_n.shape[0]
        # A list of matrices, and no matrix that is written as a list of its rows.
        several = isinstance(C_t, (list, tuple)) and all(sp.issparse(C) or np.ndim(C) == 2 for C in C_t)
        tangents = () if C_t is None else tuple(C_t) if several else (C_t,)
        if len(tangents) > 2:
            raise ValueError(f"C_t has {len(tangents)} matrices, expected one or two")
        names = ("C_t",) if len(tangents) == 1 else ("C_t[0]", "C_t[1]")
        maps = [_matrix("C_n", C_n, sp.csr_array, (n_c, n))]
        maps += [_matrix(name, C, sp.csr_array, (n_c, n)) for name, C in zip(names, tangents)]
        maps += [sp.csr_array((n_c, n))] * (3 - len(maps))
        free: Array | None = None
        if free_motions is not None:
            free = np.atleast_2d(_numbers("free_motions", free_motions))
            free = np.zeros((0, n)) if free.size == 0 else np.ascontiguousarray(free)
            if free.ndim != 2 or free.shape[1] != n:
                raise ValueError(f"free_motions has the shape {free.shape}, expected (k, {n})")
        coefficients = vector("mu", mu, n_c)
        if not tangents and coefficients.any():
            raise ValueError("C_t is missing, but mu is above 0: give C_t, or mu = 0 for contact without friction")
        weights = None if weight is None else vector("weight", weight, n_c)
        lower = _matrix("K", sp.tril(K, format="csc"), sp.csc_array)
        self.tangents = len(tangents)
        self._core = _core.Problem(
            n, _compressed(lower), [_compressed(C) for C in maps], coefficients, weights, free
        )

    @classmethod
    def _of(cls, core: _core.Problem, tangents: int) -> ContactProblem:
        self = cls.__new__(cls)
        self._core, self.tangents = core, tangents
        return self

    @property
    def n_u(self) -> int:
        """The number of free displacements."""
        return self._core.n_u

    @property
    def n_c(self) -> int:
        """The number of contact nodes."""
        return self._core.n_c

    @property
    def mu(self) -> Array:
        """Friction coefficients, (n_c,)."""
        return self._core.mu

    @property
    def weight(self) -> Array | None:
        """Lengths or areas of the contact nodes, m or m², (n_c,), if they are known."""
        return self._core.weight

    @property
    def free_motions(self) -> Array:
        """A basis of the null space of K, (k, n_u)."""
        return np.array(self._core.free_motions()).reshape(-1, self.n_u)

    @property
    def K(self) -> Any:
        """The stiffness, csc_array, (n_u, n_u), N/m."""
        lower = sp.csc_array(self._core.lower(), shape=(self.n_u, self.n_u))
        return (lower + sp.tril(lower, -1, format="csc").T).tocsc()

    @property
    def C_n(self) -> Any:
        """Displacements towards the obstacle, csr_array, (n_c, n_u)."""
        return sp.csr_array(self._core.map(0), shape=(self.n_c, self.n_u))

    @property
    def C_t(self) -> tuple[Any, ...]:
        """Displacements along each tangent, csr_array, (n_c, n_u)."""
        return tuple(sp.csr_array(self._core.map(1 + d), shape=(self.n_c, self.n_u)) for d in range(self.tangents))

    def __reduce__(self) -> Any:
        return _restore, (self.K, self.C_n, self.C_t, self.mu, self.weight, self.free_motions)

    def __repr__(self) -> str:
        return f"<ContactProblem {self.n_u} displacements, {self.n_c} contact nodes, {self.tangents} tangents>"

    def slip(self, u: ArrayLike) -> Array:
        """Tangential displacements C_t u, m, (n_c, d)."""
        u = vector("u", u, self.n_u)
        return np.stack([C @ u for C in self.C_t], axis=-1) if self.tangents else np.zeros((self.n_c, 0))

    def with_friction(self, mu: ArrayLike) -> ContactProblem:
        """The problem with other friction coefficients.

        It shares the stiffness with this one. Once one of the two has been solved condensed, the other is not condensed anew.

        Args:
            mu: friction coefficients, a number or (n_c,).

        Raises:
            ValueError: mu has another shape, or is negative.
        """
        coefficients = vector("mu", mu, self.n_c)
        if not self.tangents and coefficients.any():
            raise ValueError("mu is above 0, but the problem has no C_t")
        return ContactProblem._of(self._core.with_friction(coefficients), self.tangents)

    def solve(
        self, force: ArrayLike, factors: ArrayLike | None = None, *, gap: ArrayLike = 0.0, drift: ArrayLike | None = None,
        mu: ArrayLike | None = None, times: ArrayLike | None = None, method: str = "bn", setting: str = "default",
        linear: str | LinearSolver | None = "auto", tolerance: float | None = None, max_iterations: int = 200,
        r_factor: float = 1.0, keep_u: str | bool | Sequence[int] = "all", callback: Callback | None = None,
    ) -> Result:
        """Solves a history that begins unloaded.

        Args:
            force: nodal forces, N. Without factors a row of (m, n_u) for each increment, or (n_u,) for a single one.
                With factors: loads (n_u,) or (loads, n_u).
            factors: of the loads at the ends of the increments, (m,) or (m, loads).
            gap: m; a number, (n_c,), or (m + 1, n_c), the first row before the first increment.
            drift: how far the obstacle has moved past each node at the ends, m, (m, n_c) or (m, n_c, d).
            mu: friction coefficients at the ends where they change, (m, n_c) or what numpy makes of it; those of the problem without it.
            times: ends of the increments, s, (m,), increasing from above 0; equal parts of 1 s without them.
            method, setting: "bn" or "ip", "default" or "paper"; "events" follows the exact path in the plane. Where contact rows depend
                on each other, so that forces are not unique, each increment goes through the cascade for local problems instead.
            linear: "auto", "faer", "partial", "condensed", "umfpack" where it is built in, or a `LinearSolver`.
            tolerance: the largest error of any law, relative; 1e-10 without it.
            max_iterations: of an increment.
            keep_u: of which increments displacements are kept: "all", "last", "none" or a list.
            callback: told of each increment once it is judged.
        """
        loads = np.atleast_2d(_numbers("force", force))
        if loads.ndim != 2 or loads.shape[1] != self.n_u:
            raise ValueError(f"force has the shape {loads.shape}, expected (..., {self.n_u})")
        table = np.eye(len(loads)) if factors is None else _numbers("factors", factors)
        table = table[:, None] if table.ndim == 1 else table
        if table.ndim != 2 or table.shape[1] != len(loads) or len(table) == 0:
            raise ValueError(f"factors has the shape {table.shape}, expected (m, {len(loads)})")
        m = len(table)
        ends = np.arange(1.0, m + 1) / m if times is None else vector("times", times, m)
        if ends[0] <= 0 or (np.diff(ends) <= 0).any():
            raise ValueError("times must increase from above 0")
        gaps = _numbers("gap", gap)
        if gaps.ndim < 2:
            gaps = vector("gap", gaps, self.n_c)[None]
        elif gaps.shape != (m + 1, self.n_c):
            raise ValueError(f"gap has the shape {gaps.shape}, expected {(m + 1, self.n_c)}")
        drifts: list[Array | None] = [None, None]
        if drift is not None:
            array = _numbers("drift", drift)
            array = array[:, :, None] if array.ndim == 2 else array
            if array.shape != (m, self.n_c, self.tangents):
                raise ValueError(f"drift has the shape {array.shape}, expected {(m, self.n_c, self.tangents)}")
            for d in range(self.tangents):
                drifts[d] = np.ascontiguousarray(array[:, :, d])
        tables = {
            "times": ends.tolist(), "forces": np.ascontiguousarray(loads), "factors": np.ascontiguousarray(table),
            "gap": np.ascontiguousarray(gaps), "drift": drifts, "mu": self._friction(mu, m),
        }
        if method == "events" and tables["mu"] is not None:
            raise ValueError("mu: friction that changes is solved by the methods bn and ip; events follows the path of friction that stays")
        options = _options(method, setting, r_factor, tolerance, max_iterations)
        kept = keep(keep_u, m)
        raw = self._core.run(tables, options, linear, kept, callback)
        reason = ""
        if raw["status"] == "singular":
            reason = _dependent.reason(self, raw["free_motion"])
            if reason and raw["free_motion"] is None and not len(raw["p_n"]) and method != "events" and not len(self.free_motions):
                raw = _dependent.solve(self, tables, 1e-10 if tolerance is None else tolerance, kept, callback)
                reason = "" if raw["status"] == "converged" else reason
        return Result._of(raw, self.tangents, reason=reason, stacklevel=3)

    def _friction(self, mu: ArrayLike | None, increments: int) -> Array | None:
        """Friction coefficients for each increment where they are others than the problem's."""
        if mu is None:
            return None
        rows = numbers("mu", mu, (increments, self.n_c))
        if (rows < 0).any():
            raise ValueError("mu is negative")
        wrong = np.flatnonzero(((rows > 0) != (self.mu > 0)).any(axis=0))
        if len(wrong):
            raise ValueError(
                f"mu: contact node {wrong[0]} has friction in some increments or in the problem, and none in others. A node has friction "
                "at all times or never: give a small coefficient in place of 0"
            )
        return np.ascontiguousarray(rows) if (rows != self.mu).any() else None

    def solve_increment(
        self, force: ArrayLike, *, gap: ArrayLike = 0.0, w_t_last: ArrayLike | None = None, **options: Any
    ) -> Result:
        """One increment from given tangential displacements, set up anew; for many of them in a row see `stepper`.

        Args:
            force: nodal forces at its end, N, (n_u,).
            gap: gaps at its end, m, a number or (n_c,).
            w_t_last: tangential displacements at its beginning, m, (n_c,) or (n_c, d); `slip` of the last `u`.
            options: as those of `solve`.
        """
        shape = (self.n_c, self.tangents)
        w = np.zeros(shape) if w_t_last is None else _numbers("w_t_last", w_t_last)
        if w.size != self.n_c * self.tangents:
            raise ValueError(f"w_t_last has the shape {w.shape}, expected {shape}")
        w = w.reshape(shape)
        return self.solve(vector("force", force, self.n_u), [1.0], gap=vector("gap", gap, self.n_c),
                          drift=w[None] if w.any() else None, **options)

    def stepper(
        self, *, gap: ArrayLike = 0.0, method: str = "bn", setting: str = "default",
        linear: str | LinearSolver | None = "auto", tolerance: float | None = None, max_iterations: int = 200,
        r_factor: float = 1.0,
    ) -> Stepper:
        """A history whose rest nobody knows yet: for time loops of one's own, and couplings.

        Args:
            gap: before the first increment, m, a number or (n_c,).
            method: "bn" or "ip"; all else as in `solve`.
        """
        from ._stepper import Stepper

        return Stepper(self, gap, _options(method, setting, r_factor, tolerance, max_iterations), linear)

    def condensed(self) -> tuple[Array, Array]:
        """The compliance W of the contact displacements, m/N, and C = [C_n; C_t...] in the order of the nodes.

        Rows 0, 1 (, 2) of W are the normal and the tangents of node 0, and so on: w = C K^-1 f - W p. K must be invertible.
        """
        from scipy.sparse.linalg import splu

        if len(self.free_motions):
            raise ValueError("K is singular: the body has free motions, and no compliance")
        maps = [self.C_n, *self.C_t]
        order = np.arange(len(maps) * self.n_c).reshape(len(maps), -1).T.ravel()
        C: Any = sp.csr_array(sp.vstack(maps, format="csr"))[order]
        return C @ splu(self.K).solve(C.T.toarray()), C

    def residual(
        self, u: ArrayLike, p_n: ArrayLike, p_t: ArrayLike | None = None, *, force: ArrayLike, gap: ArrayLike = 0.0,
        w_t_last: ArrayLike | None = None, r: ArrayLike | None = None, mu: ArrayLike | None = None,
    ) -> Array:
        """H(z) of the natural map, (n_u + n_c (1 + d),): zero exactly at a solution; see `stickslip.newton`."""
        from .newton import Natural

        return Natural(self, force, gap=gap, w_t_last=w_t_last, r=r, mu=mu).residual(u, p_n, p_t)

    def jacobian(
        self, u: ArrayLike, p_n: ArrayLike, p_t: ArrayLike | None = None, *, force: ArrayLike, gap: ArrayLike = 0.0,
        w_t_last: ArrayLike | None = None, r: ArrayLike | None = None, mu: ArrayLike | None = None,
    ) -> Any:
        """A generalised Jacobian of `residual`, csc_array: the linear piece that holds at z."""
        from .newton import Natural

        return Natural(self, force, gap=gap, w_t_last=w_t_last, r=r, mu=mu).jacobian(u, p_n, p_t)

    @classmethod
    def from_siconos(cls, M: Any, H: Any, q: ArrayLike, b: ArrayLike, mu: ArrayLike) -> Posed:
        """An increment, of the global problem of Siconos; see `stickslip.siconos`."""
        from . import siconos

        return siconos.from_siconos(M, H, q, b, mu)

    def to_siconos(
        self, force: ArrayLike, gap: ArrayLike = 0.0, w_t_last: ArrayLike | None = None, mu: ArrayLike | None = None
    ) -> GlobalFriction:
        """One increment as the global problem of Siconos; see `stickslip.siconos`."""
        from . import siconos

        return siconos.to_siconos(self, force, gap, w_t_last, mu)


def _restore(K: Any, C_n: Any, C_t: Any, mu: Any, weight: Any, free_motions: Any) -> ContactProblem:
    return ContactProblem(K, C_n, C_t, mu, weight=weight, free_motions=free_motions, check=False)
