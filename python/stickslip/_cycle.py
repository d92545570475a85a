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
        The integral of the pressure over the slip path, Pa m: times Archard's coefficient, 1/Pa, it is the wear depth. It takes the
        mean of the pressures at both ends of an increment. None for a problem of matrices without weights.
    """

    start: float
    end: float
    friction_work: Array
    slip_path: Array
    slip_net: Array
    pressed_path: Array | None


def of(result: Result, start: float | None, end: float | None) -> Cycle:
    """`Result.cycle`."""
    if not len(result.t):
        raise ValueError("start: the result has no increment")
    begun, slip = result._begun, result.slip
    time, before, normal = begun or (0.0, np.zeros_like(slip[0]), np.zeros_like(result.p_n[0]))
    start, end = (default if value is None else float(value) for value, default in ((start, time), (end, float(result.t[-1]))))
    near = 1e-9 * float(result.t[-1])
    for name, value in (("start", start), ("end", end)):
        if not np.isclose([time, *result.t], value, rtol=0, atol=near).any():
            raise ValueError(f"{name}: no increment of the result begins or ends at {value:g} s")
    converged = np.array([record["status"] == "converged" for record in result.records])
    rows = np.flatnonzero((result.t > start + near) & (result.t < end + near) & converged)
    if not len(rows):
        raise ValueError(f"end: no increment that converged is between {start:g} and {end:g} s")
    first = int(rows[0])
    if first:
        before, normal = slip[first - 1], result.p_n[first - 1]
    slips = np.concatenate([before[None], slip[rows]])
    known = np.asarray(np.isfinite(slips).all(axis=(1, 2)))
    if not known.all():
        raise ValueError(f'start: the displacements of increment {first - 1 + int(np.argmin(known))} were not kept; take keep_u="all"')
    steps = np.diff(slips, axis=0) * (result.contact[rows] == SLIP)[:, :, None]
    lengths = np.sqrt((steps**2).sum(axis=2))
    try:
        pressure = result.pressure[rows]
    except ValueError:
        pressed = None
    else:
        last = result.pressure[first - 1] if first else normal / result._posed[0].weight if begun else np.zeros_like(pressure[0])
        levels = np.concatenate([last[None], pressure])
        pressed = (0.5 * (levels[1:] + levels[:-1]) * lengths).sum(axis=0)
    work = (result.p_t[rows] * steps).sum(axis=(0, 2))
    return Cycle(start, end, work, lengths.sum(axis=0), steps.sum(axis=0), pressed)
