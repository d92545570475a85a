"""The words and functions that a solve takes."""

from __future__ import annotations

import numbers
import operator
import os
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypedDict, Union, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import LARGEST
from ._linear import Checked
from ._words import counted

if TYPE_CHECKING:
    from ._arrays import Array

#: Semismooth Newton, interior point, or the exact path from event to event.
Method = Literal["bn", "ip", "events"]
#: The settings of a method: this library's, or those of the paper.
Setting = Literal["default", "paper"]
#: The linear algebra: what suits the sizes, sparse LU or partial elimination by faer, condensed to the contact, UMFPACK where it is built in.
Linear = Literal["auto", "faer", "partial", "condensed", "umfpack"]

#: What differs between histories: an entry for each, or an array with a row for each.
Several = Union[Sequence[ArrayLike], NDArray[Any]]

#: Called with (increment from 1, time, status, iterations, error); an exception ends the run and comes out.
Callback = Callable[[int, float, str, int, float], object]


class LinearSolver(Protocol):
    """A direct solver of one's own, for `linear=`: any object with these three methods.

    Where a run fails, its last answer x is checked: the verdict has the relative residual |A x - b| / (|A| |x| + |b|) if that
    is above 1e-8, or says that x is not finite.

    Examples
    --------
    SuperLU of scipy:

    >>> import numpy as np, scipy.sparse as sp, stickslip as ss
    >>> from scipy.sparse.linalg import splu
    >>> class SuperLU:
    ...     def analyze(self, n, indptr, indices):
    ...         self.pattern = (n, indptr, indices)
    ...     def factorize(self, data):
    ...         n, indptr, indices = self.pattern
    ...         self.lu = splu(sp.csc_array((data, indices, indptr), shape=(n, n)))
    ...     def solve(self, b):
    ...         return self.lu.solve(b)
    >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    >>> problem.solve([40.0, -100.0], linear=SuperLU()).p_t[0, 0]
    array([30.])
    """

    def analyze(self, n: int, indptr: NDArray[np.int64], indices: NDArray[np.int64], /) -> object:
        """Once a run: the pattern of the (n, n) matrix, by columns."""

    def factorize(self, data: Array, /) -> object:
        """Once an iteration: the values of its entries; `ZeroDivisionError` says that it is singular."""

    def solve(self, b: Array, /) -> Array:
        """With the last factors: x, float64, (n,)."""
        ...


class SolveOptions(TypedDict, total=False):
    """The keywords of `ContactProblem.solve` that are not the history; `solve_increment` and `solve_many` pass them on."""

    method: Method | None
    setting: Setting | None
    linear: Linear | LinearSolver | None
    tolerance: float | None
    max_iterations: int | None
    r_factor: float | None


class ManyOptions(SolveOptions, total=False):
    """The keywords of `ContactProblem.solve_many` but `reduce`."""

    forces: Several | None
    gaps: Several | None
    mus: Several | None
    gap: ArrayLike
    drift: ArrayLike
    t: ArrayLike | None
    keep_u: str | Sequence[int]
    workers: int | None
    progress: bool


class IncrementOptions(SolveOptions, total=False):
    """The keywords of `ContactProblem.solve_increment` that are not the increment."""

    mu: ArrayLike | None
    keep_u: str | Sequence[int]
    callback: Callback | None


def _word(name: str, value: object, words: tuple[str, ...], default: str) -> str:
    if value is None:
        return default
    if not isinstance(value, str):
        raise TypeError(f"{name} is {value!r}, expected a word: {', '.join(words)}")
    if value not in words:
        raise ValueError(f"{name} is {value!r}, expected one of {', '.join(words)}")
    return value


def core_options(
    *, method: object = None, setting: object = None, linear: object = None, tolerance: object = None,
    max_iterations: object = 200, r_factor: object = 1.0, **others: object,
) -> tuple[dict[str, Any], str | Checked | None]:
    """The options of a solve and its linear algebra, of the types that the core takes."""
    for name in others:
        raise TypeError(f"{name} is no argument here, expected method, setting, linear, tolerance, max_iterations or r_factor")
    options: dict[str, Any] = {
        "method": _word("method", method, get_args(Method), "bn"), "setting": _word("setting", setting, get_args(Setting), "default"),
        "r_factor": 1.0 if r_factor is None else r_factor, "tolerance": tolerance,
        "max_iterations": 200 if max_iterations is None else max_iterations,
    }
    kinds: dict[str, tuple[Any, str]] = {
        "r_factor": (numbers.Real, "a number"), "tolerance": ((numbers.Real, type(None)), "a number or None"),
        "max_iterations": (numbers.Integral, "a whole number"),
    }
    if isinstance(r_factor, np.floating):
        # The bounds are beyond the range of shorter numbers.
        options["r_factor"] = float(r_factor)
    for name, (kind, words) in kinds.items():
        if not isinstance(options[name], kind) or isinstance(options[name], bool):
            raise TypeError(f"{name} is {options[name]!r}, expected {words}")
    if not 1 / LARGEST <= options["r_factor"] <= LARGEST:
        raise ValueError(f"r_factor is {r_factor}, but must be between {1 / LARGEST:g} and {LARGEST:g}")
    if not 1 <= options["max_iterations"] < 2**31:
        raise ValueError(f"max_iterations is {max_iterations}, but must be 1 or more, and below 2**31")
    return options, linear_of(linear)


def linear_of(linear: Any) -> str | Checked | None:
    """The linear algebra: a word, a solver of one's own, or None."""
    if linear is None or isinstance(linear, str):
        return linear and _word("linear", linear, get_args(Linear), "auto")
    missing = [step for step in ("analyze", "factorize", "solve") if not callable(getattr(linear, step, None))]
    if missing:
        raise TypeError(f"linear: {type(linear).__name__} has no {', '.join(missing)}; a word or a `LinearSolver` expected")
    return Checked(linear)


def _real(value: object) -> bool:
    return isinstance(value, numbers.Real) and not isinstance(value, (bool, np.bool_))


def whole(name: str, value: Any, expected: str = "a whole number of 1 or more", least: int = 1) -> int:
    """A whole number, up to those of 32 bits."""
    if not _real(value) or not value >= least or value != value // 1:
        raise ValueError(f"{name}: {value!r} found, expected {expected}")
    if not value < 2**31:
        raise ValueError(f"{name}: {value!r} found, but must be below 2**31")
    return int(value)


def processors(workers: Any) -> int:
    """So many threads; as many as there are processors for None."""
    if workers is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if isinstance(workers, bool) or not isinstance(workers, numbers.Integral):
        raise TypeError(f"workers is {workers!r}, expected a whole number")
    if not 1 <= (threads := int(workers)) < 2**16:
        raise ValueError(f"workers is {workers}, but must be 1 or more, and below 65536")
    return threads


def share(name: str, value: Any, expected: str) -> float:
    """A number between 0 and 1."""
    if not _real(value) or not 0 < value < 1:
        raise ValueError(f"{name}: {value!r} found, expected {expected}")
    return float(value)


def keep(keep_u: str | Sequence[int], increments: int) -> bool | list[int]:
    """`keep_u` as the core takes it: numbers from 1, 0 for the last."""
    if isinstance(keep_u, (bool, np.bool_)):
        raise TypeError(f"keep_u is {keep_u}, expected {'all' if keep_u else 'none'!r}")
    if isinstance(keep_u, str):
        words: dict[str, bool | list[int]] = {"all": True, "none": False, "last": [0]}
        if keep_u not in words:
            raise ValueError(f"keep_u is {keep_u!r}, expected 'all', 'last', 'none' or a list of increments")
        return words[keep_u]
    if not np.iterable(keep_u):
        raise ValueError(f"keep_u is {keep_u!r}, expected 'all', 'last', 'none' or a list of increments")
    try:
        return [range(increments)[operator.index(k)] + 1 for k in keep_u]
    except IndexError:
        raise ValueError(f"keep_u is {keep_u!r}, expected numbers from 0 to {increments - 1}, of {counted(increments, 'increment')}") from None
    except TypeError:
        raise ValueError(f"keep_u is {keep_u!r}, expected whole numbers, of increments from 0") from None


def called(function: object, name: str = "callback") -> None:
    """Refuses what is neither None nor a function."""
    if function is not None and not callable(function):
        raise TypeError(f"{name}: a function expected, {type(function).__name__} found")


def path_of(path: object) -> str:
    """The path of a file as a str."""
    found = os.fspath(path) if isinstance(path, (str, os.PathLike)) else None
    if not isinstance(found, str):
        raise TypeError(f"path: a str or os.PathLike expected, {type(path).__name__} found")
    return found
