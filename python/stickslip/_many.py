"""Many histories of one body."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, SupportsIndex, overload

import numpy as np
from numpy.typing import NDArray

from . import _core, _history
from ._errors import NotConvergedWarning
from ._kinds import LAWS
from ._linear import Checked
from ._options import called, core_options, keep, processors
from ._result import NotConverged, Result
from ._words import counted, few, reason_of, warn

if TYPE_CHECKING:
    from typing_extensions import Self

    from ._options import Several
    from ._problem import ContactProblem

Array = NDArray[Any]

#: The arrays of a `Result` with a row for each increment.
_ROWS = ("t", "p_n", "p_t", "contact", "gap", "mu", "w_t_last", "errors")


class Results(list[Result]):
    """The results of `ContactProblem.solve_many`: a list in the order of the input, whose slices are `Results` too.

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    >>> results = problem.solve_many(forces=[[10.0, -100.0], [40.0, -100.0]])
    >>> results.converged
    array([ True,  True])
    >>> results[1].p_n
    array([[100.]])
    """

    #: n_u, n_c and d, which no results do not show.
    _sizes: tuple[int, int, int] = (0, 0, 0)

    @overload
    def __getitem__(self, k: SupportsIndex, /) -> Result: ...

    @overload
    def __getitem__(self, k: slice, /) -> Self: ...

    def __getitem__(self, k: SupportsIndex | slice, /) -> Result | Self:
        if not isinstance(k, slice):
            return super().__getitem__(k)
        part = copy.copy(self)
        part[:] = super().__getitem__(k)
        part._cut(k)
        return part

    def _cut(self, k: slice) -> None:
        """Leaves of what goes with each result that of the part k."""

    @property
    def converged(self) -> NDArray[np.bool_]:
        """True for each history that converged, (N,)."""
        return np.array([result.converged for result in self], dtype=bool)

    def _name(self, k: int) -> str:
        return f"history {k}"

    def check(self) -> Self:
        """Itself; raises `NotConverged` with the first result that did not converge, if there is one."""
        for k, result in enumerate(self):
            if not result.converged:
                raise NotConverged(f"{self._name(k)}: {result.message}", result)
        return self

    def stack(self, name: str) -> Array:
        """One array of all results.

        Parameters
        ----------
        name : str
            "p_n", "p_t", "contact", "gap", "mu", "w_t_last", "errors" or "t", with a row for each increment; "u"; or
            "friction_work", a number for each result.

        Returns
        -------
        (N, m, ...) or (N,) array
            NaN, or 255 in "contact", for increments that were not reached. Of "u" the increments that are kept.

        Raises
        ------
        KeyError
            `name` is no such array.
        ValueError
            The results are of different meshes.
        """
        names = (*_ROWS, "u", "friction_work")
        if name not in names:
            raise KeyError(f"name is {name!r}, expected one of {', '.join(names)}")
        if name == "friction_work":
            return np.array([result.friction_work for result in self], dtype=np.float64)
        arrays = [getattr(result, name) for result in self]
        rows = max((len(array) for array in arrays), default=0)
        n_u, n_c, d = self._sizes
        empty = {"t": (), "errors": (len(LAWS),), "p_t": (n_c, d), "w_t_last": (n_c, d), "u": (n_u,)}.get(name, (n_c,))
        if len({array.shape[1:] for array in arrays if len(array)}) > 1:
            raise ValueError(f"{name} has other shapes in some results, as of other meshes, and is no one array")
        width = next((array.shape[1:] for array in arrays if len(array)), arrays[0].shape[1:] if arrays else empty)
        kind = np.uint8 if name == "contact" else np.float64
        stacked = np.full((len(self), rows, *width), 255 if name == "contact" else np.nan, dtype=kind)
        for k, array in enumerate(arrays):
            if len(array):
                stacked[k, : len(array)] = array
        return stacked

    def __repr__(self) -> str:
        failed = np.flatnonzero(~self.converged)
        if not len(failed):
            return f"<Results of {counted(len(self), *_HISTORY)}{', all converged' if len(self) else ''}>"
        return f"<Results of {counted(len(self), *_HISTORY)}, {len(failed)} not converged: {few(failed.tolist())}>"


_HISTORY = ("history", "histories")


def _samples(several: dict[str, Several | None]) -> int:
    for name, values in several.items():
        if values is not None and not (isinstance(values, Sequence) or np.ndim(values) > 0):
            raise TypeError(f"{name} is {type(values).__name__}, expected a list or an array with an entry for each history")
    lengths = {name: len(values) for name, values in several.items() if values is not None}
    if not lengths:
        raise ValueError("forces, gaps and mus are missing: give at least one of them, with an entry for each history")
    if len(set(lengths.values())) > 1:
        raise ValueError(", ".join(f"{name} has {counted(length, 'entry', 'entries')}" for name, length in lengths.items()) + ": as many expected")
    return next(iter(lengths.values()))


def _histories(
    problem: ContactProblem, shared: tuple[Any, ...], several: dict[str, Several | None]
) -> list[tuple[ContactProblem, dict[str, Any]]]:
    """The problem and the tables of each; equal loads are one array."""
    force, factors, gap, drift, times = shared
    count = _samples(several)
    # Rows of what is no sequence, such as a table of pandas, whose own entries are columns.
    forces, gaps, mus = (
        values if values is None or isinstance(values, Sequence) else np.asanyarray(values)
        for values in (several["forces"], several["gaps"], several["mus"])
    )
    if (force is None) == (forces is None):
        raise ValueError("force is missing: give it, or forces" if force is None else "forces: give them or force, not both")
    if gaps is not None and np.any(np.asarray(gap) != 0):
        raise ValueError("gaps: give them or gap, not both")
    loads = None if force is None else _history.forces(problem, force, factors)
    found = []
    for k in range(count):
        own = _history.forces(problem, forces[k], factors, f"forces[{k}]") if forces is not None else loads
        assert own is not None
        found.append(
            _history.posed(
                problem, own, gap if gaps is None else gaps[k], drift, None if mus is None else mus[k], times,
                ("gap" if gaps is None else f"gaps[{k}]", f"mus[{k}]"),
            )
        )
    return found


def solve(
    problem: ContactProblem, shared: tuple[Any, ...], several: dict[str, Several | None], reduce: Callable[[Result], Any] | None,
    keep_u: str | Sequence[int], workers: int | None, progress: bool, options: dict[str, Any],
) -> Any:
    """`ContactProblem.solve_many`."""
    histories = _histories(problem, shared, several)
    if options.get("linear") is None:
        options["linear"] = problem._linear
    core, linear = core_options(**options)
    if isinstance(linear, Checked):
        raise TypeError(f"linear: {linear.name} is one solver, which cannot work for several histories at once; a word expected")
    if core["method"] == "events" and (changing := [k for k, (_, tables) in enumerate(histories) if tables["mu"] is not None]):
        raise ValueError(f"mus[{changing[0]}] changes in time, which the method events does not follow; take bn or ip")
    threads = processors(workers)
    kept = keep(keep_u, min((len(tables["times"]) for _, tables in histories), default=1))
    called(reduce, "reduce")
    found: list[Any] = [None] * len(histories)
    failed: dict[int, str] = {}
    bar: Any = None
    if progress:
        from tqdm.auto import tqdm

        bar = tqdm(total=len(histories), unit="history")

    def take(k: int, raw: dict[str, Any]) -> None:
        problem, tables = histories[k]
        result = Result._of(raw, problem, reason=reason_of(raw), drift=tables["drift"])
        if not result.converged:
            failed[k] = result.message
        found[k] = result if reduce is None else reduce(result)
        if bar is not None:
            bar.update()

    try:
        _core.solve_many([(own._core, tables) for own, tables in histories], core, linear, kept, threads, take)
    finally:
        if bar is not None:
            bar.close()
    if failed:
        first = min(failed)
        which = f"{len(failed)} of {counted(len(found), *_HISTORY)} did not converge ({few(sorted(failed))})"
        warn(f"{which}; {first}: {failed[first]}", NotConvergedWarning)
    if reduce is not None:
        return found
    results = Results(found)
    results._sizes = (problem.n_u, problem.n_c, problem.tangents)
    return results
