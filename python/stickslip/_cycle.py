"""Friction work and slip of each contact node in a part of a history."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._kinds import SLIP

if TYPE_CHECKING:
    from ._result import Result

Array = NDArray[Any]


@dataclass(frozen=True, eq=False)
class Cycle:
    """Each contact node in a part of a history; only motion in contact counts as slip. See `Result.cycle`.

    Attributes
    ----------
    start, end : float
        Its times, s.
    friction_work : ndarray, shape (n_c,)
        J; in the plane J per m of depth.
    slip_path : ndarray, shape (n_c,)
        The length of the slip path, m.
    slip_net : ndarray, shape (n_c, d)
        The slip from the beginning to the end, m.
    pressed_path : ndarray, shape (n_c,) or None
        The integral of the pressure over the slip path, Pa m: times Archard's coefficient, 1/Pa, it is the wear depth. None for a
        problem of matrices without weights.
    """

    start: float
    end: float
    friction_work: Array
    slip_path: Array
    slip_net: Array
    pressed_path: Array | None


def of(result: Result, start: float, end: float | None) -> Cycle:
    """`Result.cycle`."""
    end = float(result.t[-1]) if end is None else float(end)
    near = 1e-9 * float(result.t[-1])
    rows = np.flatnonzero((result.t > start + near) & (result.t < end + near))
    ends = [0.0, *result.t]
    for name, time in (("start", start), ("end", end)):
        if not np.isclose(ends, time, rtol=0, atol=near).any():
            raise ValueError(f"{name}: no increment ends at {time:g} s")
    if not len(rows):
        raise ValueError(f"end: {end:g} s found, expected a time after {start:g} s")
    slip = result.slip
    first = int(rows[0])
    known = np.asarray(np.isfinite(slip).all(axis=(1, 2)))
    lost = [k for k in (*range(max(first - 1, 0), first), *rows) if not known[k]]
    if lost:
        raise ValueError(f'start: the displacements of increment {lost[0]} were not kept; take keep_u="all"')
    before = slip[first - 1] if first else np.zeros_like(slip[0])
    steps = np.diff(np.concatenate([before[None], slip[rows]]), axis=0)
    steps *= (result.contact[rows] == SLIP)[:, :, None]
    lengths = np.sqrt((steps**2).sum(axis=2))
    try:
        pressure = result.pressure
    except ValueError:
        pressed = None
    else:
        last = pressure[first - 1] if first else np.zeros_like(pressure[0])
        levels = np.concatenate([last[None], pressure[rows]])
        pressed = (0.5 * (levels[1:] + levels[:-1]) * lengths).sum(axis=0)
    work = (result.p_t[rows] * steps).sum(axis=(0, 2))
    return Cycle(start, end, work, lengths.sum(axis=0), steps.sum(axis=0), pressed)
