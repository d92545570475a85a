"""The judge: how far anybody's answer is from the exact law, whatever the solver says of itself."""

from __future__ import annotations

import html
import time
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import plot as _plot
from ._errors import NotConvergedWarning
from ._problem import ContactProblem, numbers, vector
from ._result import LAWS, Result
from ._scene import Model

Array = NDArray[Any]


@dataclass(frozen=True, eq=False)
class Errors:
    """How far a state is from the exact law of an increment; relative, without a unit.

    Attributes:
        equilibrium, penetration, tension, complementarity, cone, dissipation: the largest violation of each law.
        contact: what each node does, `OPEN`, `STICK` or `SLIP`, uint8, (n_c,).
        scales: force, N, and length, m, that errors are relative to; hand them to the next increment.
    """

    equilibrium: float
    penetration: float
    tension: float
    complementarity: float
    cone: float
    dissipation: float
    contact: Array
    scales: tuple[float, float]

    @property
    def worst(self) -> tuple[str, float]:
        """The law that is violated most, and its error; NaN is larger than anything."""
        laws = [(law, float(getattr(self, law))) for law in LAWS]
        return max(laws, key=lambda item: np.inf if np.isnan(item[1]) else item[1])

    def _repr_html_(self) -> str:
        law, error = self.worst
        return f"<b>{law}</b>: {error:.1e}"


def _tangential(name: str, problem: ContactProblem, values: ArrayLike | None) -> list[Array]:
    n_c, d = problem.n_c, problem.tangents
    array = np.zeros((n_c, d)) if values is None else np.asarray(values, dtype=float)
    if array.size != n_c * d:
        raise ValueError(f"{name} has the shape {array.shape}, expected {(n_c, d)}")
    array = array.reshape(n_c, d)
    return [np.ascontiguousarray(array[:, k]) if k < d else np.zeros(n_c) for k in range(2)]


def errors(
    problem: ContactProblem, force: ArrayLike, u: ArrayLike | tuple[ArrayLike, ArrayLike], p_n: ArrayLike,
    p_t: ArrayLike | None = None, *, gap: ArrayLike = 0.0, w_t_last: ArrayLike | None = None,
    mu: ArrayLike | None = None, scales: tuple[float, float] = (0.0, 0.0),
) -> Errors:
    """Judges an answer to one increment.

    Args:
        force: external nodal forces, N, (n_u,).
        u: free displacements, m, (n_u,), or a pair of them and what rounding leaves off (`Result.u_rest`).
        p_n: normal contact forces, N, (n_c,), positive in compression.
        p_t: tangential forces of the body on the obstacle, N, (n_c,) or (n_c, d).
        gap: m, a number or (n_c,).
        w_t_last: tangential displacements before the increment, m, shaped as p_t.
        mu: friction of this increment where that changes, (n_c,).
        scales: those of the increments before, so that errors are relative to the largest of a history.
    """
    whole, rest = u if isinstance(u, tuple) else (u, None)
    p_t = _tangential("p_t", problem, p_t)
    answer = {
        "force": vector("force", force, problem.n_u), "gap": vector("gap", gap, problem.n_c),
        "mu": problem.mu if mu is None else vector("mu", mu, problem.n_c),
        "w_last": _tangential("w_t_last", problem, w_t_last), "u": vector("u", whole, problem.n_u),
        "u_rest": np.zeros(0) if rest is None else vector("u[1]", rest, problem.n_u),
        "p_n": vector("p_n", p_n, problem.n_c), "p_t": p_t[0], "p_o": p_t[1],
    }
    laws, contact, found = problem._core.errors(answer, scales)
    return Errors(**dict(zip(LAWS, laws)), contact=np.array(list(contact), dtype=np.uint8), scales=found)


@dataclass(frozen=True, eq=False)
class Posed:
    """One increment, as it is put to a solver.

    Attributes:
        problem: K, C_n, C_t, mu.
        force: external nodal forces at its end, N, (n_u,).
        gap: gaps at its end, m, (n_c,).
        w_t_last: tangential displacements at its beginning, past the obstacle, m, (n_c, d).
        mu: friction coefficients at its end, (n_c,).
        last: the solver's own last answer (u, p_n, p_t); zeros at first.
        index: its number, from 1.
        cache: a dictionary that is the same for all increments, for factors and the like.
    """

    problem: ContactProblem
    force: Array
    gap: Array
    w_t_last: Array
    mu: Array
    last: tuple[Array, Array, Array]
    index: int = 1
    cache: dict[str, Any] = field(default_factory=dict)


#: Anybody's solver: an increment in, (u, p_n, p_t) out.
Solver = Callable[[Posed], tuple[Any, Any, Any]]


@dataclass(frozen=True, eq=False)
class Verdict:
    """What the judge found of a solver over a history.

    Attributes:
        name: the solver.
        error: the largest error of any law in any increment.
        law: that law.
        increment: where, from 1.
        seconds: CPU time of the solver, s.
        holds: whether the error is within the tolerance.
        errors: by increment, (m, 6), columns `LAWS`.
        p_n, p_t: contact forces, N, (m, n_c) and (m, n_c, d).
        remark: what the solver raised, or that its answer was not finite.
    """

    name: str
    error: float
    law: str
    increment: int
    seconds: float
    holds: bool
    errors: Array
    p_n: Array
    p_t: Array
    remark: str = ""


def _history(of: Model | ContactProblem, history: Mapping[str, ArrayLike] | None) -> dict[str, Array]:
    if history is None:
        if not isinstance(of, Model):
            raise ValueError("history: a problem of matrices needs one, with the keys force and, if need be, gap, drift, mu")
        return of.history
    problem = of.problem if isinstance(of, Model) else of
    unknown = set(history) - {"force", "gap", "drift", "mu"}
    if unknown or "force" not in history:
        raise ValueError(f"history has the keys {sorted(history)}, expected force and, if need be, gap, drift, mu")
    m, n_c, d = len(np.atleast_2d(np.asarray(history["force"]))), problem.n_c, problem.tangents
    drift = np.asarray(history.get("drift", 0.0))
    if drift.shape == (m, n_c):
        drift = drift.reshape(m, n_c, 1)
    return {
        "force": numbers("history['force']", history["force"], (m, problem.n_u)),
        "gap": numbers("history['gap'], which begins before the first increment,", history.get("gap", 0.0), (m + 1, n_c)),
        "drift": numbers("history['drift']", drift, (m, n_c, d)),
        "mu": numbers("history['mu']", history.get("mu", problem.mu), (m, n_c)),
    }


def judge(
    of: Model | ContactProblem, solver: Solver, *, history: Mapping[str, ArrayLike] | None = None, name: str = "solver",
    tolerance: float = 1e-8,
) -> Verdict:
    """Runs anybody's solver over a history, each increment from its own last answer, and judges every increment.

    Args:
        of: a model, or a problem of matrices with a `history`: force (m, n_u) and, if need be, gap (m + 1, n_c),
            drift (m, n_c, d), mu (m, n_c).
        solver: called with a `Posed` increment; hands back (u, p_n, p_t).
        tolerance: the largest error of any law that still holds.
    """
    if not callable(solver):
        raise TypeError(f"solver: a function of an increment expected, {type(solver).__name__} found; `compare` takes words")
    problem = of.problem if isinstance(of, Model) else of
    data = _history(of, history)
    if not len(data["force"]):
        raise ValueError("history['force'] has no increments")
    n_c, d = problem.n_c, problem.tangents
    answer = (np.zeros(problem.n_u), np.zeros(n_c), np.zeros((n_c, d)))
    slip, drift = np.zeros((n_c, d)), np.zeros((n_c, d))
    scales, cache, seconds, remark = (0.0, 0.0), dict[str, Any](), 0.0, ""
    rows: list[list[float]] = []
    forces: list[tuple[Array, Array]] = []
    for k, (force, gap, moved, mu) in enumerate(zip(data["force"], data["gap"][1:], data["drift"], data["mu"])):
        w = slip + moved - drift
        posed = Posed(problem, force, gap, w, mu, answer, k + 1, cache)
        start = time.process_time()
        try:
            u, p_n, p_t = solver(posed)
            seconds += time.process_time() - start
            answer = (np.asarray(u, float), np.asarray(p_n, float), np.asarray(p_t, float).reshape(n_c, d))
            judged = errors(problem, force, *answer, gap=gap, w_t_last=w, mu=mu, scales=scales)
        except (ArithmeticError, LookupError, RuntimeError, TypeError, ValueError) as raised:
            remark = f"increment {k + 1}: {type(raised).__name__}: {raised}"
            rows.append([np.inf] * 6)
            break
        scales = judged.scales
        slip, drift = problem.slip(answer[0]), moved
        rows.append([getattr(judged, law) for law in LAWS])
        forces.append((answer[1], answer[2]))
    p_n = np.array([p_n for p_n, _ in forces]).reshape(-1, n_c)
    p_t = np.array([p_t for _, p_t in forces]).reshape(-1, n_c, d)
    return _verdict(name, rows, seconds, p_n, p_t, remark, tolerance)


def _verdict(
    name: str, rows: list[list[float]], seconds: float, p_n: Array, p_t: Array, remark: str, tolerance: float
) -> Verdict:
    table = np.array(rows)
    at = np.unravel_index(int(np.argmax(np.where(np.isnan(table), np.inf, table))), table.shape)
    error = float(table[at])
    law = LAWS[at[1]] if np.isfinite(error) or not remark else "no answer"
    return Verdict(name, error, law, int(at[0]) + 1, seconds, bool(error <= tolerance), table, p_n, p_t, remark)


@dataclass(frozen=True, eq=False)
class Comparison:
    """Verdicts on several solvers; prints as a table, and in a notebook with what is wrong in red."""

    verdicts: list[Verdict]
    tolerance: float

    def __getitem__(self, name: str) -> Verdict:
        return next(verdict for verdict in self.verdicts if verdict.name == name)

    def _rows(self) -> list[tuple[str, str, str, str]]:
        def last(verdict: Verdict) -> str:
            total = f"sum p_n = {verdict.p_n[-1].sum():.9e} N" if len(verdict.p_n) else ""
            return total if verdict.holds else f"{total}  WRONG: {verdict.remark or verdict.law}"

        return [(v.name, f"{v.error:.1e}", f"{v.seconds:.3f} s", last(v)) for v in self.verdicts]

    def __str__(self) -> str:
        width = max(len(verdict.name) for verdict in self.verdicts)
        return "\n".join(f"{name:{width}}  {error:>8}  {seconds:>9}  {last}" for name, error, seconds, last in self._rows())

    def _repr_html_(self) -> str:
        def row(verdict: Verdict, cells: tuple[str, ...]) -> str:
            colour = "inherit" if verdict.holds else "#cf222e"
            return f"<tr style='color:{colour}'>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells) + "</tr>"

        head = "<tr><th>solver</th><th>largest error</th><th>CPU time</th><th>at the end</th></tr>"
        return f"<table>{head}{''.join(map(row, self.verdicts, self._rows()))}</table>"

    def to_pandas(self) -> Any:
        """A `DataFrame` with a row for each solver."""
        import pandas

        keys = ("name", "error", "law", "increment", "seconds", "holds", "remark")
        return pandas.DataFrame([{key: getattr(v, key) for key in keys} for v in self.verdicts]).set_index("name")

    def plot(self, ax: Any = None) -> Any:
        """Error against CPU time; returns the axes."""
        return _plot.comparison(self, ax)


#: The words that `compare` takes.
_OWN = ("bn", "ip", "events", "stickslip")


def _own(of: Model | ContactProblem, word: str, history: Mapping[str, ArrayLike] | None, data: Mapping[str, Array]) -> Result:
    """A history by this module."""
    if isinstance(of, Model):
        if history is None and word == "stickslip":
            return of.run(_stacklevel=5)
        of = of.problem
    return of.solve(
        data["force"], gap=data["gap"], drift=data["drift"] if of.tangents else None, mu=data["mu"],
        method="bn" if word == "stickslip" else word,
    )


def _judged(problem: ContactProblem, result: Result, data: Mapping[str, Array]) -> tuple[list[list[float]], str]:
    """Errors by law of a result of this module, by the history that was posed, and why there are no more."""
    rows: list[list[float]] = []
    scales = (0.0, 0.0)
    increments = list(zip(data["force"], data["gap"][1:], data["mu"]))
    for k, (force, gap, mu) in enumerate(increments[: len(result.t)]):
        judged = errors(
            problem, force, (result.u[k], result.u_rest[k]), result.p_n[k], result.p_t[k], gap=gap,
            w_t_last=result.w_t_last[k], mu=mu, scales=scales,
        )
        scales = judged.scales
        rows.append([getattr(judged, law) for law in LAWS])
    if result.converged and len(rows) == len(increments):
        return rows, ""
    if len(rows) < len(increments):
        rows.append([np.inf] * 6)
    return rows, result._verdict()


def compare(
    of: Model | ContactProblem, solvers: Mapping[str, Solver | str], *,
    history: Mapping[str, ArrayLike] | None = None, tolerance: float = 1e-8,
) -> Comparison:
    """Several solvers on one history, with one judge.

    Args:
        of, history, tolerance: as those of `judge`.
        solvers: by name; a callable as `judge` takes it, or a word: "bn", "ip" and "events" are stickslip's on the matrices,
            "stickslip" the run of the model as its scene says. All answers are judged by the same history.
    """
    if not solvers:
        raise ValueError("solvers is empty: there is nothing to compare")
    data = _history(of, history)
    problem = of.problem if isinstance(of, Model) else of
    verdicts = []
    for name, solver in solvers.items():
        if not isinstance(solver, str):
            verdicts.append(judge(of, solver, history=history, name=name, tolerance=tolerance))
            continue
        if solver not in _OWN:
            raise ValueError(f"solvers[{name!r}] is {solver!r}, expected one of {', '.join(_OWN)} or a function of an increment")
        start = time.process_time()
        p_n, p_t = np.zeros((0, problem.n_c)), np.zeros((0, problem.n_c, problem.tangents))
        try:
            with warnings.catch_warnings():
                # The verdict says it.
                warnings.simplefilter("ignore", NotConvergedWarning)
                result = _own(of, solver, history, data)
            seconds = time.process_time() - start
            rows, remark = _judged(problem, result, data)
            p_n, p_t = result.p_n, result.p_t
        except (ArithmeticError, RuntimeError, ValueError) as raised:
            seconds = time.process_time() - start
            rows, remark = [[np.inf] * 6], f"{type(raised).__name__}: {raised}"
        verdicts.append(_verdict(name, rows, seconds, p_n, p_t, remark, tolerance))
    return Comparison(verdicts, tolerance)
