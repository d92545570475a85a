"""Numbers in words of messages, and warnings."""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Sequence
from typing import Any


#: Why a run ended early, by its status, where nothing more is known.
REASONS = {
    "inaccurate": "the method stopped by its own test, but a law is violated; try setting=\"default\", the other of the methods bn and ip, "
    "or a larger tolerance if rounding limits equilibrium, as of slender or hardly held bodies",
    "max-iterations": "the limit of iterations was reached; try a larger max_iterations, the other of the methods bn and ip, or smaller increments",
    "cycling": "the iterations repeat the same contact cases; try the other of the methods bn and ip, smaller increments, or less friction",
    "diverged": "the iterations left the range of numbers; try the other of the methods bn and ip, or smaller increments",
    "stalled": "the iterations no longer advance, away from a solution; try the other of the methods bn and ip, smaller increments, or less friction",
    "singular": "the linear system is singular, most likely because neither K nor contact holds the body; add a support",
    "slips": "a joint slips as a whole: the loads overcome all friction that holds the body; prescribe a displacement in place of the load to follow the slip",
    "no-equilibrium": "no contact forces within the friction limit balance the loads, so that the body lifts off or tips; change the loads or add a support",
    "no-continuation": "the quasi-static motion ends here: no rates satisfy the laws beyond this load; less friction or a support may help, "
    "and the method bn goes on with increments",
    "not-finite": "the linear solver gave numbers that are not finite; try another linear, or smaller loads",
    "out-of-memory": "memory ran out; the increments before are complete: take a smaller problem, or a machine with more memory",
    "interrupted": "the run was stopped on request",
    "unsupported": "the method does not solve this problem: ip with the setting paper has one tangent, and events needs nodes that slide "
    "along lines, friction that stays, and independent rows of C_n and C_t; take the method bn",
}


def counted(number: int, one: str, several: str = "") -> str:
    """A number with its noun, such as "1 node" and "2 nodes"; `several` where that is not `one` with an s."""
    return f"{number} {one if number == 1 else several or one + 's'}"


def violation(law: str, error: float, within: float = 1e-10) -> str:
    """The law that is violated most and its error, which is no violation within that."""
    return f"largest error {error:.1e} ({law})" if error <= within else f"{law} violated by {error:.1e}"


def few(words: Sequence[object], most: int = 5, separator: str = ", ") -> str:
    """The first of them, and how many are left out."""
    more = [f"and {len(words) - most} more"] if len(words) > most else []
    return separator.join([*map(str, words[:most]), *more])


def reason_of(raw: dict[str, Any]) -> str:
    """The reason why a run of the core ended early: its own, or the motion that nothing stops."""
    if raw["status"] != "singular" or raw["free_motion"] is None:
        return str(raw.get("reason", ""))
    weights = ", ".join(f"{weight:.3g}" for weight in raw["free_motion"])
    return f"neither K nor contact stops the body along the sum of its free_motions with the weights [{weights}]"


def warn(message: str, category: type[Warning]) -> None:
    """Warns at the line outside this package that led here."""
    here, frame, level = os.path.dirname(__file__) + os.sep, sys._getframe(1), 2
    while frame.f_back is not None and frame.f_code.co_filename.startswith(here):
        frame, level = frame.f_back, level + 1
    warnings.warn(message, category, stacklevel=level)
