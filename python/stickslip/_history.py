"""The data of a history, as the core takes them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ._arrays import Array, finite, numbers, rows_or_row, vector

if TYPE_CHECKING:
    from ._problem import ContactProblem


def tables(
    problem: ContactProblem, force: ArrayLike, factors: ArrayLike | None, gap: ArrayLike, drift: ArrayLike,
    mu: ArrayLike | None, t: ArrayLike | None, names: tuple[str, str, str] = ("force", "gap", "mu"),
) -> tuple[ContactProblem, dict[str, Any]]:
    """The problem with the friction of this history, and the history; `names` are those of force, gap and mu in errors."""
    return posed(problem, forces(problem, force, factors, names[0]), gap, drift, mu, t, names[1:])


def forces(problem: ContactProblem, force: ArrayLike, factors: ArrayLike | None, name: str = "force") -> tuple[Array, Array]:
    """Loads, (loads, n_u), and their factors, (m, loads)."""
    loads = np.atleast_2d(finite(name, force))
    if loads.ndim != 2 or loads.shape[1] != problem.n_u or not len(loads) and factors is None:
        raise ValueError(f"{name} has the shape {loads.shape}, expected (..., {problem.n_u})")
    if factors is None:
        return few_loads(np.ascontiguousarray(loads))
    table = finite("factors", factors)
    table = table[:, None] if table.ndim == 1 else table
    if table.ndim != 2 or table.shape[1] != len(loads) or len(table) == 0:
        raise ValueError(f"factors has the shape {table.shape}, expected (m, {len(loads)})")
    return np.ascontiguousarray(loads), np.ascontiguousarray(table)


def posed(
    problem: ContactProblem, loads: tuple[Array, Array], gap: ArrayLike, drift: ArrayLike, mu: ArrayLike | None,
    t: ArrayLike | None, names: tuple[str, str] = ("gap", "mu"),
) -> tuple[ContactProblem, dict[str, Any]]:
    """`tables` of loads that are checked already."""
    m, n_c, d = len(loads[1]), problem.n_c, problem.tangents
    ends = np.arange(1.0, m + 1) / m if t is None else times("t", t, m)
    gaps = finite(names[0], gap)
    if gaps.shape not in ((), (n_c,), (m + 1, n_c)):
        raise ValueError(f"{names[0]} has the shape {gaps.shape}, expected {rows_or_row((m + 1, n_c))}")
    if gaps.ndim < 2:
        gaps = vector(names[0], gaps, n_c)[None]
    moved = motion("drift", drift, (m, n_c, d))
    drifts = [np.ascontiguousarray(moved[:, :, k]) if k < d and moved[:, :, k].any() else None for k in range(2)]
    rows = None
    if mu is not None:
        problem, rows = changing(problem, numbers(names[1], mu, (m, n_c)), names[1])
    return problem, {
        "times": ends.tolist(), "forces": loads[0], "factors": loads[1],
        "gap": np.ascontiguousarray(gaps), "drift": drifts, "mu": rows,
    }


def times(name: str, t: ArrayLike, increments: int) -> Array:
    """The ends of increments."""
    ends = vector(name, t, increments)
    if ends[0] <= 0 or (np.diff(ends) <= 0).any():
        raise ValueError(f"{name} must increase from above 0")
    return ends


def motion(name: str, drift: ArrayLike, shape: tuple[int, int, int]) -> Array:
    """The motion of obstacles, (m, n_c, d), of a number, of a table without tangents, or of a part that is repeated."""
    array = finite(name, drift)
    array = array[:, :, None] if array.ndim == 2 else array
    try:
        if array.ndim in (0, 3):
            return np.broadcast_to(array, shape)
    except ValueError:
        pass
    raise ValueError(f"{name} has the shape {np.shape(drift)}, expected a number, {shape[:2]} or {shape}")


def changing(problem: ContactProblem, coefficients: Array, name: str) -> tuple[ContactProblem, Array | None]:
    """The problem with the largest friction of a history, (m, n_c), and `friction`."""
    if (coefficients < 0).any():
        raise ValueError(f"{name} is negative")
    if not problem.tangents and coefficients.any():
        raise ValueError(f"{name} is above 0, but the problem has no C_t")
    largest = coefficients.max(axis=0)
    if (largest != problem.mu).any():
        problem = problem.with_(mu=largest)
    return problem, friction(problem, coefficients, name)


def friction(problem: ContactProblem, rows: Array, name: str = "mu") -> Array | None:
    """Friction coefficients for each increment, (m, n_c), where they are others than the problem's."""
    if (rows < 0).any():
        raise ValueError(f"{name} is negative")
    wrong = np.flatnonzero(((rows > 0) != (problem.mu > 0)).any(axis=0))
    if len(wrong):
        raise ValueError(
            f"{name}: contact node {wrong[0]} has friction in some increments or in the problem, and none in others. A node has friction "
            "at all times or never: give a small coefficient in place of 0"
        )
    return np.ascontiguousarray(rows) if (rows != problem.mu).any() else None


def few_loads(table: Array) -> tuple[Array, Array]:
    """A table of forces as few loads and their factors, where that is the same to the last digits; else the table itself.

    Each load is reduced to the contact once a run, and a history of m increments is most often a sum of one or two. Crosses are
    taken out of the table: the row of its largest entry, times the column of that entry.
    """
    rest, loads, columns = table.copy(), list[Array](), list[Array]()
    sizes = _ROUNDING * abs(table).max(axis=1)
    with np.errstate(all="ignore"):
        for _ in range(1 + min(_LOADS, len(table) // 2)):
            left = abs(rest).max(axis=1)
            if loads and (left <= sizes).all():
                basis, factors = np.stack(loads), np.ascontiguousarray(np.stack(columns, axis=1))
                if (abs(table - factors @ basis).max(axis=1) <= sizes).all():
                    return basis, factors
                break
            row = int(left.argmax())
            place = int(abs(rest[row]).argmax())
            if rest[row, place] == 0.0:
                break
            load, column = rest[row] / rest[row, place], rest[:, place].copy()
            rest -= np.outer(column, load)
            loads.append(load)
            columns.append(column)
    return table, np.eye(len(table))


#: More loads than scenes have; a table of more costs as many passes in vain.
_LOADS = 6

#: What sums of loads may differ by, relative to the largest force of an increment.
_ROUNDING = 4 * np.finfo(float).eps
