"""Several solvers on one history, with one judge."""

from __future__ import annotations

import html
from collections.abc import Mapping
from typing import Any

from numpy.typing import ArrayLike

from . import _plot
from ._judge import Solver, Verdict, history_of, known, tolerated, verdict_on
from ._problem import ContactProblem
from ._scene import Model
from ._words import counted


class Comparison(dict[str, Verdict]):
    """Verdicts on several solvers by their names; prints as a table, and in a notebook with what is wrong in red.

    Attributes
    ----------
    tolerance : float
        The largest error of any law that still holds.

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    >>> def lazy(posed):
    ...     return np.linalg.solve(problem.K.toarray(), posed.force), [0.0], [[0.0]]
    >>> table = ss.compare(problem, {"Newton": "bn", "lazy": lazy}, history={"force": [[40.0, -100.0]]})
    >>> table["Newton"].converged, table["lazy"].converged, table["lazy"].law
    (True, False, 'penetration')
    """

    tolerance: float

    def __missing__(self, name: str) -> Verdict:
        raise KeyError(f"name is {name!r}, expected one of {', '.join(self)}")

    def __repr__(self) -> str:
        held = sum(verdict.converged for verdict in self.values())
        return f"<Comparison of {counted(len(self), 'solver')}, {held} within {self.tolerance:g}>"

    def _rows(self) -> list[tuple[str, str, str, str]]:
        def last(verdict: Verdict) -> str:
            total = f"sum p_n = {verdict.p_n[-1].sum():.9e} N" if len(verdict.p_n) else ""
            if not len(verdict.errors):
                return verdict.reason
            return total if verdict.converged else f"{total}  WRONG: {verdict.reason or verdict.law}"

        return [(v.name, f"{v.error:.1e}", f"{v.seconds:.3f} s", last(v)) for v in self.values()]

    def __str__(self) -> str:
        width = max(map(len, self))
        return "\n".join(f"{name:{width}}  {error:>8}  {seconds:>9}  {last}" for name, error, seconds, last in self._rows())

    def _repr_html_(self) -> str:
        def row(verdict: Verdict, cells: tuple[str, ...]) -> str:
            colour = "inherit" if verdict.converged or not len(verdict.errors) else "#cf222e"
            return f"<tr style='color:{colour}'>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells) + "</tr>"

        head = "<tr><th>solver</th><th>largest error</th><th>CPU time</th><th>at the end</th></tr>"
        return f"<table>{head}{''.join(map(row, self.values(), self._rows()))}</table>"

    def to_pandas(self) -> Any:
        """A `DataFrame` with a row for each solver."""
        import pandas

        keys = ("name", "error", "law", "increment", "seconds", "converged", "reason")
        return pandas.DataFrame([{key: getattr(v, key) for key in keys} for v in self.values()]).set_index("name")

    def plot(self, ax: Any = None) -> Any:
        """Error against CPU time; what breaks a law by more than the tolerance is red.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; new axes without it.

        Returns
        -------
        matplotlib.axes.Axes
        """
        ax = _plot.axes(ax)
        for k, verdict in enumerate(verdict for verdict in self.values() if len(verdict.errors)):
            colour, at = _plot.GOOD if verdict.converged else _plot.BAD, (max(verdict.seconds, 1e-6), max(verdict.error, 1e-17))
            ax.loglog(*at, "o", color=colour)
            # Above and below in turn, for those that are near each other.
            ax.annotate(verdict.name, at, (0, 6 if k % 2 else -14), textcoords="offset points", ha="center", color=colour)
        ax.margins(0.25)
        ax.axhline(self.tolerance, linestyle=":", color="grey")
        ax.set_xlabel("CPU time, s")
        ax.set_ylabel("largest error of any law")
        return ax


def compare(
    of: Model | ContactProblem, solvers: Mapping[str, Solver | str], *,
    history: Mapping[str, ArrayLike] | None = None, tolerance: float = 1e-8,
) -> Comparison:
    """Several solvers on one history, with one judge.

    Parameters
    ----------
    of, history, tolerance
        As those of `judge`.
    solvers : mapping of str to callable or str
        By name, each as `judge` takes it. All answers are judged by the same history. A word whose method does not solve such a
        problem is remarked as not applicable.

    Returns
    -------
    Comparison

    Raises
    ------
    ValueError, TypeError
        No solvers, one that is none, or a history that does not fit.

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    >>> ss.compare(problem, {"Newton": "bn", "interior point": "ip"}, history={"force": [[40.0, -100.0]]})
    <Comparison of 2 solvers, 2 within 1e-08>
    """
    if not isinstance(solvers, Mapping):
        raise TypeError(f"solvers is {type(solvers).__name__}, expected a dictionary of names and solvers")
    if not solvers:
        raise ValueError("solvers is empty: there is nothing to compare")
    for name, solver in solvers.items():
        if not isinstance(name, str):
            raise TypeError(f"solvers: names are words, {name!r} found")
        known(f"solvers[{name!r}]", solver)
    tolerated(tolerance)
    data = history_of(of, history)
    table = Comparison((name, verdict_on(of, solver, history, data, name, tolerance)) for name, solver in solvers.items())
    table.tolerance = float(tolerance)
    return table
