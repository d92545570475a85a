"""The judge: how far anybody's answer is from the exact law, whatever the solver says of itself."""

from __future__ import annotations

import os
import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from numbers import Real
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import finite, forces_of, not_masked, numbers, tangential, vector
from ._errors import NotConvergedWarning
from ._history import changing, motion, times
from ._kinds import LAWS
from ._problem import ContactProblem
from ._result import Result
from ._scene import Model
from ._words import violation
from .builder import Scene

if TYPE_CHECKING:
    from ._options import Method

Array = NDArray[Any]


@dataclass(frozen=True, eq=False)
class Errors:
    """The errors of a state by the exact law of an increment; relative, without a unit.

    Attributes
    ----------
    equilibrium, penetration, tension, complementarity, cone, dissipation : float
        The largest violation of each law.
    contact : (n_c,) uint8 array
        What each node does, `OPEN`, `STICK` or `SLIP`.
    scales : tuple of float
        The largest terms of forces and gaps so far, the square root of J, two for each part of the body that nothing
        connects with the others; hand them to the next increment, where forces below their rounding are none.

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    >>> ss.measure(problem, [0.0, -100.0], u=[0.0, -1e-4], p_n=[0.0])
    <Errors: penetration violated by 1.0e+00>
    >>> ss.measure(problem, [0.0, 0.0], u=[0.0, 0.0], p_n=[0.0])
    <Errors: largest error 0.0e+00 (equilibrium)>
    """

    equilibrium: float
    penetration: float
    tension: float
    complementarity: float
    cone: float
    dissipation: float
    contact: Array
    scales: tuple[float, ...]

    @property
    def law(self) -> str:
        """The law that is violated most; NaN is larger than anything."""
        return LAWS[int(np.argmax([getattr(self, law) for law in LAWS]))]

    @property
    def error(self) -> float:
        """The error of this law, the largest of all."""
        return float(getattr(self, self.law))

    def __repr__(self) -> str:
        return f"<Errors: {self._repr_html_()}>"

    def _repr_html_(self) -> str:
        return violation(self.law, self.error)


def _tangential(name: str, problem: ContactProblem, values: ArrayLike | None) -> list[Array]:
    n_c, d = problem.n_c, problem.tangents
    array = tangential(name, values, n_c, d)
    return [np.ascontiguousarray(array[:, k]) if k < d else np.zeros(n_c) for k in range(2)]


def measure(
    problem: ContactProblem, force: ArrayLike, u: ArrayLike | tuple[ArrayLike, ArrayLike], p_n: ArrayLike,
    p_t: ArrayLike | None = None, *, gap: ArrayLike = 0.0, w_t_last: ArrayLike | None = None,
    mu: ArrayLike | None = None, scales: Sequence[float] = (),
) -> Errors:
    """Judges an answer to one increment.

    Parameters
    ----------
    problem : ContactProblem
        K, C_n, C_t, mu.
    force : (n_u,)
        External nodal forces, N.
    u : (n_u,) or a pair of them
        Free displacements, m, alone or with what rounding leaves off (`Result.u_rest`).
    p_n : (n_c,)
        Normal contact forces, N, positive in compression.
    p_t : (n_c,) or (n_c, d), optional
        Tangential forces of the body on the obstacle, N.
    gap : float or (n_c,)
        m.
    w_t_last : (n_c,) or (n_c, d), optional
        Tangential displacements before the increment, m.
    mu : float or (n_c,), optional
        Friction of this increment where that changes.
    scales : sequence of float
        `Errors.scales` of the increment before.

    Returns
    -------
    Errors

    Raises
    ------
    ValueError
        An argument of another shape, or that is not finite.

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    >>> judged = ss.measure(problem, [40.0, -100.0], u=[5e-6, 0.0], p_n=[100.0], p_t=[30.0])
    >>> judged.error < 1e-12, bool(judged.contact[0] == ss.SLIP)
    (True, True)
    """
    if not isinstance(problem, ContactProblem):
        cure = "; take its problem" if isinstance(problem, Model) else ""
        raise TypeError(f"problem: a ContactProblem expected, {type(problem).__name__} found{cure}")
    # A tuple of two numbers is one vector.
    pair = u if isinstance(u, tuple) and len(u) == 2 and np.ndim(u[0]) > 0 else (u, None)
    whole, rest = cast("tuple[ArrayLike, ArrayLike | None]", pair)
    p_t = _tangential("p_t", problem, p_t)
    answer = {
        "force": forces_of("force", force, problem.n_u), "gap": vector("gap", gap, problem.n_c),
        "mu": problem.mu if mu is None else vector("mu", mu, problem.n_c),
        "w_last": _tangential("w_t_last", problem, w_t_last), "u": vector("u", whole, problem.n_u),
        "u_rest": np.zeros(0) if rest is None else vector("u[1]", rest, problem.n_u),
        "p_n": vector("p_n", p_n, problem.n_c), "p_t": p_t[0], "p_o": p_t[1],
    }
    known_scales = finite("scales", scales)
    if known_scales.ndim != 1 or (known_scales < 0).any():
        raise ValueError(f"scales is {scales!r}, expected numbers of 0 or more, as `Errors.scales`")
    laws, contact, found = problem._core.errors(answer, known_scales.tolist())
    return Errors(**dict(zip(LAWS, laws)), contact=np.array(list(contact), dtype=np.uint8), scales=tuple(found))


@dataclass(frozen=True, eq=False)
class Posed:
    """One increment, as it is put to a solver.

    Attributes
    ----------
    problem : ContactProblem
        K, C_n, C_t, mu.
    force : (n_u,) array
        External nodal forces at its end, N.
    gap : (n_c,) array
        Gaps at its end, m.
    w_t_last : (n_c, d) array
        Tangential displacements at its beginning, past the obstacle, m.
    mu : (n_c,) array
        Friction coefficients at its end.
    last : tuple of arrays
        The solver's own last answer (u, p_n, p_t); zeros at first.
    increment : int
        Its number, from 1.
    cache : dict
        The same for all increments, for factors and the like; a pickle has what is in it.

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    >>> ss.judge(problem, lambda posed: print(posed), history={"force": [[40.0, -100.0]]}).reason
    <Posed increment 1 of <ContactProblem 2 displacements, 1 contact node, 1 tangent>>
    'increment 1: TypeError: cannot unpack non-iterable NoneType object'
    """

    problem: ContactProblem
    force: Array
    gap: Array
    w_t_last: Array
    mu: Array
    last: tuple[Array, Array, Array]
    increment: int = 1
    cache: dict[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"<Posed increment {self.increment} of {self.problem!r}>"


#: Anybody's solver: an increment in, (u, p_n, p_t) out.
Solver = Callable[[Posed], tuple[Any, Any, Any]]


@dataclass(frozen=True, eq=False)
class Verdict:
    """The judgement on a solver over a history.

    Attributes
    ----------
    name : str
        The solver.
    error : float
        The largest error of any law in any increment.
    law : str
        That law.
    increment : int
        Where, from 1.
    seconds : float
        CPU time of the solver, s.
    converged : bool
        Whether the error is within the tolerance.
    errors : (m, 6) array
        By increment, columns `LAWS`.
    p_n, p_t : (m, n_c) and (m, n_c, d) arrays
        Contact forces, N.
    reason : str
        Why it ended early: what the solver raised, or that its answer was not finite. "not applicable: ...", with an error that
        is NaN and no rows of errors, where a method of this module does not solve such a problem.

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    >>> def broken(posed):
    ...     raise ArithmeticError("no pivot")
    >>> ss.judge(problem, broken, history={"force": [[40.0, -100.0]]})
    <Verdict on solver: WRONG; increment 1: ArithmeticError: no pivot>
    """

    name: str
    error: float
    law: str
    increment: int
    seconds: float
    converged: bool
    errors: Array
    p_n: Array
    p_t: Array
    reason: str = ""

    def __repr__(self) -> str:
        at = f"in increment {self.increment}"
        if not len(self.errors):
            words = "no answer"
        elif self.converged:
            words = f"converged, {violation(self.law, self.error, within=self.error)} {at}"
        elif np.isfinite(self.error) or not self.reason:
            words = f"WRONG, {violation(self.law, self.error, within=0.0)} {at}"
        else:
            words = "WRONG"
        return f"<Verdict on {self.name}: {words}{'; ' if self.reason else ''}{self.reason}>"


def history_of(of: Model | ContactProblem, history: Mapping[str, ArrayLike] | None) -> dict[str, Array]:
    """The tables of a history, which `judge` and `compare` take; refuses what is neither a model nor a problem."""
    if not isinstance(of, (Model, ContactProblem)):
        cure = "; ss.Model(scene) makes one" if isinstance(of, (str, os.PathLike, Mapping, Scene)) else ""
        raise TypeError(f"of: Model or ContactProblem expected, {type(of).__name__} found{cure}")
    if history is not None and not isinstance(history, Mapping):
        raise TypeError(f"history: a dictionary expected, such as that of Model.history, {type(history).__name__} found")
    if history is None:
        if not isinstance(of, Model):
            raise ValueError("history: a problem of matrices needs one, with the keys force and, if need be, gap, drift, mu, t")
        return of.history
    problem = of.problem if isinstance(of, Model) else of
    if not {"force"} <= set(history) <= {"force", "gap", "drift", "mu", "t"}:
        raise ValueError(f"history has the keys {sorted(history)}, expected force and, if need be, gap, drift, mu, t")
    force = np.atleast_2d(finite("history['force']", history["force"]))
    if force.ndim != 2 or force.shape[1] != problem.n_u:
        raise ValueError(f"history['force'] has the shape {np.shape(history['force'])}, expected {(len(force), problem.n_u)}")
    if not len(force):
        raise ValueError("history['force'] has no increments")
    m, n_c, d = len(force), problem.n_c, problem.tangents
    tables = {
        "force": force,
        "gap": numbers("history['gap'], which begins before the first increment,", history.get("gap", 0.0), (m + 1, n_c)),
        "drift": motion("history['drift']", history.get("drift", 0.0), (m, n_c, d)),
        "mu": numbers("history['mu']", history.get("mu", problem.mu), (m, n_c)),
    }
    if "t" in history:
        tables["t"] = times("history['t']", history["t"], m)
    changing(problem, tables["mu"], "history['mu']")
    # Copies: a solver may write into the arrays that the history was made of.
    return {name: table.copy() for name, table in tables.items()}


#: The words that `judge` and `compare` take.
_OWN = ("bn", "ip", "events", "stickslip")


class _NotApplicable(ValueError):
    """A method of this module that does not solve such a problem, which is no wrong answer."""


def _own(of: Model | ContactProblem, word: str, history: Mapping[str, ArrayLike] | None, data: Mapping[str, Array]) -> Result:
    """A history by this module."""
    if history is None and word == "stickslip" and isinstance(of, Model):
        result = of.run()
    elif word == "events" and (data["mu"] != data["mu"][0]).any():
        raise _NotApplicable("mu: friction that changes is solved by the methods bn and ip")
    else:
        problem, method = of.problem if isinstance(of, Model) else of, cast("Method", "bn" if word == "stickslip" else word)
        result = problem.solve(data["force"], gap=data["gap"], drift=data["drift"], mu=data["mu"], t=data.get("t"), method=method)
    if result.status == "unsupported":
        raise _NotApplicable(result.reason)
    return result


def _judged(problem: ContactProblem, result: Result, data: Mapping[str, Array]) -> tuple[list[list[float]], str]:
    """Errors by law of a result of this module, by the history that was posed, and why there are no more."""
    rows: list[list[float]] = []
    scales: tuple[float, ...] = ()
    increments = list(zip(data["force"], data["gap"][1:], data["mu"]))
    for k, (force, gap, mu) in enumerate(increments[: len(result.t)]):
        judged = measure(
            problem, force, (result.u[k], result.u_rest[k]), result.p_n[k], result.p_t[k], gap=gap,
            w_t_last=result.w_t_last[k], mu=mu, scales=scales,
        )
        scales = judged.scales
        rows.append([getattr(judged, law) for law in LAWS])
    if result.converged and len(rows) == len(increments):
        return rows, ""
    if len(rows) < len(increments):
        rows.append([np.inf] * 6)
    return rows, result.message


def tolerated(tolerance: object) -> None:
    """Refuses a tolerance that is no number of 0 or more."""
    if isinstance(tolerance, bool) or not isinstance(tolerance, Real):
        raise TypeError(f"tolerance: a number expected, {type(tolerance).__name__} found")
    if not 0 <= float(tolerance) < np.inf:
        raise ValueError(f"tolerance is {tolerance}, but must be 0 or more, and finite")


def known(name: str, solver: object) -> None:
    """Refuses what is neither a solver nor a word."""
    expected = f"one of {', '.join(_OWN)} or a function of an increment"
    if isinstance(solver, str) and solver not in _OWN:
        raise ValueError(f"{name} is {solver!r}, expected {expected}")
    if not isinstance(solver, str) and not callable(solver):
        raise TypeError(f"{name}: {expected} expected, {type(solver).__name__} found")


def judge(
    of: Model | ContactProblem, solver: Solver | str, *, history: Mapping[str, ArrayLike] | None = None, name: str | None = None,
    tolerance: float = 1e-8,
) -> Verdict:
    """Runs anybody's solver over a history, each increment from its own last answer, and judges every increment.

    Parameters
    ----------
    of : Model or ContactProblem
        A model, or a problem of matrices with a `history`.
    solver : callable or str
        Called with a `Posed` increment; hands back (u, p_n, p_t). Or a word: "bn", "ip" and "events" are stickslip's on the
        matrices, "stickslip" the run of the model as its scene says.
    history : mapping, optional
        force (m, n_u), N, and, if need be, gap (m + 1, n_c), m, drift (m, n_c, d), m, mu (m, n_c), t (m,), s. The `Model.history`
        of a model is one.
    name : str, optional
        Of the solver; the word, or "solver", without it.
    tolerance : float
        The largest error of any law that still holds.

    Returns
    -------
    Verdict
        Arithmetic and lookup errors of the solver, `RuntimeError`, `TypeError` and `ValueError` are in its `reason`.

    Raises
    ------
    ValueError, TypeError
        An argument that is no model or problem, no solver, history or tolerance; or a word whose method does not solve such a problem.

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    >>> def mine(posed):
    ...     result = posed.problem.solve_increment(posed.force, gap=posed.gap, w_t_last=posed.w_t_last, method="ip")
    ...     return result.u[0], result.p_n[0], result.p_t[0]
    >>> history = {"force": [[0.0, -100.0], [40.0, -100.0]]}
    >>> ss.judge(problem, mine, history=history).converged, ss.judge(problem, "ip", history=history).converged
    (True, True)
    """
    known("solver", solver)
    tolerated(tolerance)
    if name is None:
        name = solver if isinstance(solver, str) else "solver"
    return verdict_on(of, solver, history, history_of(of, history), name, tolerance, refuse=True)


def verdict_on(
    of: Model | ContactProblem, solver: Solver | str, history: Mapping[str, ArrayLike] | None, data: dict[str, Array], name: str,
    tolerance: float, refuse: bool = False,
) -> Verdict:
    """`judge` with the tables of the history; `refuse` a method that is not applicable, or say it as the reason."""
    problem = of.problem if isinstance(of, Model) else of
    if isinstance(solver, str):
        start, reason = time.process_time(), ""
        p_n, p_t = np.zeros((0, problem.n_c)), np.zeros((0, problem.n_c, problem.tangents))
        try:
            with warnings.catch_warnings():
                # The verdict says it.
                warnings.simplefilter("ignore", NotConvergedWarning)
                result = _own(of, solver, history, data)
            seconds = time.process_time() - start
            rows, reason = _judged(problem, result, data)
            p_n, p_t = result.p_n, result.p_t
        except _NotApplicable as raised:
            if refuse:
                raise ValueError(f"solver {solver!r} is not applicable: {raised}") from None
            return Verdict(name, np.nan, "no answer", 1, 0.0, False, np.zeros((0, 6)), p_n, p_t, f"not applicable: {raised}")
        except (ArithmeticError, RuntimeError, ValueError) as raised:
            seconds = time.process_time() - start
            rows, reason = [[np.inf] * 6], f"{type(raised).__name__}: {raised}"
        return _verdict(name, rows, seconds, p_n, p_t, reason, tolerance)
    n_c, d = problem.n_c, problem.tangents
    answer = (np.zeros(problem.n_u), np.zeros(n_c), np.zeros((n_c, d)))
    slip, drift = np.zeros((n_c, d)), np.zeros((n_c, d))
    scales: tuple[float, ...] = ()
    cache, seconds, reason = dict[str, Any](), 0.0, ""
    rows = list[list[float]]()
    forces: list[tuple[Array, Array]] = []
    for k, (force, gap, moved, mu) in enumerate(zip(data["force"], data["gap"][1:], data["drift"], data["mu"])):
        w = slip + moved - drift
        # Copies: what a solver writes into its arrays is its own affair.
        last = (answer[0].copy(), answer[1].copy(), answer[2].copy())
        posed = Posed(problem, force.copy(), gap.copy(), w.copy(), mu.copy(), last, k + 1, cache)
        start = time.process_time()
        try:
            u, p_n, p_t = solver(posed)
            seconds += time.process_time() - start
            answer = (_real("u", u), _real("p_n", p_n), _real("p_t", p_t).reshape(n_c, d))
            judged = measure(problem, force, *answer, gap=gap, w_t_last=w, mu=mu, scales=scales)
        except (ArithmeticError, LookupError, RuntimeError, TypeError, ValueError) as raised:
            reason = f"increment {k + 1}: {type(raised).__name__}: {raised}"
            rows.append([np.inf] * 6)
            break
        scales = judged.scales
        slip, drift = problem.slip(answer[0]), moved
        rows.append([getattr(judged, law) for law in LAWS])
        forces.append((answer[1], answer[2]))
    p_n = np.array([p_n for p_n, _ in forces]).reshape(-1, n_c)
    p_t = np.array([p_t for _, p_t in forces]).reshape(-1, n_c, d)
    return _verdict(name, rows, seconds, p_n, p_t, reason, tolerance)


def _real(name: str, values: Any) -> Array:
    not_masked(name, values)
    if np.iscomplexobj(values):
        raise TypeError(f"{name} is complex")
    return np.array(values, dtype=np.float64)


def _verdict(
    name: str, rows: list[list[float]], seconds: float, p_n: Array, p_t: Array, reason: str, tolerance: float
) -> Verdict:
    table = np.array(rows)
    at = np.unravel_index(int(np.argmax(np.where(np.isnan(table), np.inf, table))), table.shape)
    error = float(table[at])
    law = LAWS[at[1]] if np.isfinite(error) or not reason else "no answer"
    return Verdict(name, error, law, int(at[0]) + 1, seconds, bool(error <= tolerance), table, p_n, p_t, reason)
