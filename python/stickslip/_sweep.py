"""One scene with combinations of values."""

from __future__ import annotations

import itertools
import threading
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from operator import methodcaller
from typing import Any, Union

from ._linear import Checked
from ._many import Results
from ._options import linear_of, processors
from ._result import Result
from ._scene import KeepU, Linear, Model, SceneLike
from ._words import counted, few, warn

#: A key, or several that change together.
Key = Union[str, tuple[str, ...]]

#: A name as `Result.quantity` takes it, several, or by the names of their columns such names and functions of a result.
Quantities = Union[str, Iterable[str], Mapping[str, Union[str, Callable[[Result], Any]]], None]


class Stopped(Exception):
    """Ends the runs of a sweep that another one, or Ctrl-C, has ended."""


class Sweep(Results):
    """The results of a sweep: a list in the order of their values, the last key the fastest, whose slices are a `Sweep` too.

    Attributes
    ----------
    values : list of dict
        What each scene has in place of its own values, by key.

    Examples
    --------
    >>> import stickslip as ss
    >>> sweep = ss.sweep(ss.Scene.example("block"), {"contact.friction": [0.5, 0.7]}, overrides={"mesh.elements": [20, 10]})
    >>> sweep
    <Sweep of contact.friction: 2 results, all converged>
    >>> [values["contact.friction"] for values in sweep.values]
    [0.5, 0.7]
    >>> sweep[1:]
    <Sweep of contact.friction: 1 result, all converged>
    """

    def __init__(self, values: list[dict[str, Any]], results: list[Result]) -> None:
        super().__init__(results)
        self.values: list[dict[str, Any]] = values
        self._keys: tuple[str, ...] = tuple(values[0]) if values else ()

    def _cut(self, k: slice) -> None:
        self.values = self.values[k]

    def _name(self, k: int) -> str:
        """The values of a run, such as "contact.friction=0.5"."""
        return ", ".join(f"{key}={value}" for key, value in self.values[k].items()) or "no value changed"

    def _told(self) -> Sweep:
        """Itself, once Python's warnings tell what was found, each kind once."""
        found: dict[tuple[type[UserWarning], str], dict[int, list[str]]] = {}
        for k, result in enumerate(self):
            for category, kind, message in result._found():
                found.setdefault((category, kind), {}).setdefault(k, []).append(message)
        for (category, kind), runs in found.items():
            of = f"{len(runs)} of {counted(len(self), 'run')}"
            head = f"{kind}: in {of}" if kind else f"{of} did not converge"
            first, *others = runs.values()
            link = ": " if all(messages == first for messages in others) else "; the first: "
            warn(f"{head} ({few([self._name(k) for k in runs], 3, '; ')}){link}{'; '.join(first)}", category)
        return self

    def __repr__(self) -> str:
        failed = int((~self.converged).sum())
        verdict = f", {failed} not converged" if failed else ", all converged" if len(self) else ""
        return f"<Sweep of {', '.join(self._keys)}: {counted(len(self), 'result')}{verdict}>"

    def table(self, quantities: Quantities = None) -> dict[str, list[Any]]:
        """Columns with an entry for each result.

        Parameters
        ----------
        quantities : str, iterable of str, or Mapping of str to str or callable, optional
            Further columns, each a name as `Result.quantity` takes it, such as "max:top.f_x"; or by name of the column such a name
            or a function of a result.

        Returns
        -------
        dict of str to list
            The keys of the sweep, ``status``, ``error``, ``increments``, ``friction_work``, the quantities.

        Raises
        ------
        ValueError
            A quantity has the name of another column; or has raised for a result; its name and the values of the run are in the message, and its exception is the cause.
        """
        columns: dict[str, list[Any]] = {key: [values[key] for values in self.values] for key in self._keys}
        columns["status"] = [result.status for result in self]
        columns["error"] = [result.error for result in self]
        columns["increments"] = [len(result.t) for result in self]
        columns["friction_work"] = [result.friction_work for result in self]
        names = [quantities] if isinstance(quantities, str) else quantities or ()
        for name, quantity in (names if isinstance(names, Mapping) else {name: name for name in names}).items():
            value = methodcaller("quantity", quantity) if isinstance(quantity, str) else quantity
            if not callable(value) or not isinstance(name, str):
                raise TypeError(f"quantities[{name!r}]: a name or a function of a result expected, {type(quantity).__name__} found")
            if name in columns:
                if name == quantity:
                    continue
                raise ValueError(f"quantities[{name!r}]: the table has a column of this name; take another")
            columns[name] = []
            for k, result in enumerate(self):
                try:
                    columns[name].append(value(result))
                except Exception as error:
                    raise ValueError(f"quantities[{name!r}] of {self._name(k)}: {type(error).__name__}: {error}") from error
        return columns

    def to_pandas(self, quantities: Quantities = None) -> Any:
        """`table` as a `pandas.DataFrame`.

        Parameters
        ----------
        quantities : str, iterable of str, or Mapping of str to str or callable, optional
            See `table`.

        Returns
        -------
        pandas.DataFrame
        """
        import pandas

        return pandas.DataFrame(self.table(quantities))


def _combinations(vary: Mapping[Key, Iterable[Any]]) -> list[dict[str, Any]]:
    if not isinstance(vary, Mapping):
        raise TypeError(f"vary: a dictionary expected, such as {{'contact.friction': [0.3, 0.5]}}, {type(vary).__name__} found")
    columns: list[list[list[tuple[str, Any]]]] = []
    for key, values in vary.items():
        keys = key if isinstance(key, tuple) else (key,)
        if not keys or not all(isinstance(name, str) for name in keys):
            raise TypeError(f"vary: a key is a word or a tuple of words, {key!r} found")
        if isinstance(values, (str, bytes, Mapping)) or not isinstance(values, Iterable):
            raise TypeError(f"vary[{key!r}]: a list of values expected, {type(values).__name__} found")
        column = []
        for value in values:
            together = value if isinstance(key, tuple) else (value,)
            if not isinstance(together, (tuple, list)) or len(together) != len(keys):
                raise ValueError(f"vary[{key!r}]: {value!r} found, expected {counted(len(keys), 'value')}, one for each key")
            column.append(list(zip(keys, together)))
        if not column:
            raise ValueError(f"vary[{key!r}]: there is no value")
        columns.append(column)
    names = [name for column in columns for name, _ in column[0]]
    for first, name in itertools.combinations(names, 2):
        parts = zip(*([part.partition("[") for part in key.split(".")] for key in (first, name)))
        # A list without a number is all of its tables or entries.
        if all(a == b and (i.startswith(j) or j.startswith(i)) for (a, _, i), (b, _, j) in parts):
            raise ValueError(f"vary: {name!r} is there twice" + ("" if first == name else f", once as {first!r}"))
    return [{name: value for part in parts for name, value in part} for parts in itertools.product(*columns)]


def sweep(
    scene: SceneLike, vary: Mapping[Key, Iterable[Any]], *, overrides: Mapping[str, Any] | None = None, mesh: Any = None,
    workers: int | None = None, linear: Linear = "auto", keep_u: KeepU = "last", uniqueness: bool = False,
) -> Sweep:
    """Runs a scene with all combinations of values, several at a time.

    All scenes are read and discretised before the first is solved, so that a wrong value is found at once.

    Parameters
    ----------
    scene, overrides, mesh
        See `Model`.
    vary : Mapping of str to list
        Values by key, as in `overrides`; a tuple of keys has tuples of values, which change together.
    workers : int, optional
        So many runs at a time, in threads; as many as there are processors without it.
    linear, uniqueness
        See `Model.run`; a `LinearSolver` needs ``workers=1``.
    keep_u : {"last", "all", "none"} or sequence of int, optional
        Of which increments displacements are kept. All of many runs may fill the memory; `Model.run` keeps all of one.

    Returns
    -------
    Sweep
        One that did not converge is among the results.

    Raises
    ------
    SceneError
        A scene that is not sound; it names the key.
    TypeError, ValueError
        Values that are no list; the message names the key.

    Warns
    -----
    NotConvergedWarning
        Once, with the number of runs that did not converge and the values of the first.
    AccuracyWarning
        Once for each kind, likewise; ``result.warnings`` has those of each run.

    Examples
    --------
    >>> import stickslip as ss
    >>> sweep = ss.sweep(
    ...     ss.Scene.example("block"),
    ...     {"contact.friction": [0.5, 0.7], ("load[0].traction[1]", "time.increments"): [(-50e3, 10), (-60e3, 20)]},
    ...     overrides={"mesh.elements": [20, 10]},
    ... )
    >>> table = sweep.table(["peak", "last:bottom.sum_p_n"])
    >>> table["time.increments"], [round(force) for force in table["last:bottom.sum_p_n"]]
    ([10, 20, 10, 20], [10000, 12000, 10000, 12000])
    """
    threads = processors(workers)
    if workers != 1 and isinstance(algebra := linear_of(linear), Checked):
        raise TypeError(f"linear: {algebra.name} is one solver, which cannot work for several runs at once; a word or workers=1 expected")
    values = _combinations(vary)
    models = [Model(scene, {**(overrides or {}), **value}, mesh=mesh) for value in values]
    stop = threading.Event()

    def watch(*_: object) -> None:
        if stop.is_set():
            raise Stopped

    def one(model: Model) -> Result:
        watch()
        return model.run(linear=linear, keep_u=keep_u, uniqueness=uniqueness, callback=watch, _tells=False)

    with ThreadPoolExecutor(threads) as pool:
        runs = [pool.submit(one, model) for model in models]
        try:
            # The first exception ends the others. It may be that of Ctrl-C, which this thread alone sees.
            wait(runs, return_when=FIRST_EXCEPTION)
        finally:
            stop.set()
    raised = [error for run in runs if (error := run.exception()) is not None and not isinstance(error, Stopped)]
    if raised:
        raise raised[0]
    return Sweep(values, [run.result() for run in runs])._told()
