"""The factor by which a load may grow until a joint slips."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from . import _core
from ._errors import SceneError, in_python
from ._options import Linear
from ._scene import SceneLike, _read, _with_linear


@dataclass(frozen=True, eq=False, repr=False)
class Capacity:
    """The capacity of a joint for a load, as the program's ``stickslip capacity`` finds it.

    Attributes
    ----------
    load : int
        The number of the load, from 0.
    safety : float or None
        The factor of the last value of the load that the joint holds; None if it does not slip as a whole.
    between : list of float or None
        The factor at which equilibrium was found, and the one at which the joint slips.
    held : str or None
        The load that the joint holds, in the units of the scene.
    opens : dict or None
        ``boundary`` of the first contact that opens on the way, and the factors ``between`` which it does.
    slips_before : list of dict
        ``boundary`` of each contact that slips wholly before the joint does, and the factors ``between`` which it begins to.
    status : str
        The status of the last run: "slips", "converged" where the joint holds 1024 times the load, or why there is no capacity.
    message : str
        The capacity in a sentence, with the motion in which the joint slips.
    slip : dict or None
        The motion in which the joint slips, and the loads then.
    warnings : list of dict
        ``kind`` and ``message`` of each warning of the run.
    """

    load: int
    safety: float | None
    between: list[float] | None
    held: str | None
    opens: dict[str, Any] | None
    slips_before: list[dict[str, Any]]
    status: str
    message: str
    slip: dict[str, Any] | None
    warnings: list[dict[str, Any]]

    @property
    def holds(self) -> bool:
        """True if the joint holds the load as it is at the end."""
        return self.status == "converged" if self.safety is None else self.safety >= 1

    def __repr__(self) -> str:
        return f"<Capacity {self.message}>"


def capacity(
    scene: SceneLike, load: int | str = 0, *, overrides: Mapping[str, Any] | None = None, linear: Linear | None = "auto",
) -> Capacity:
    """Finds the factor by which a load may grow beyond its last value until the joint slips as a whole.

    Parameters
    ----------
    scene, overrides
        See `Model`.
    load : int or str, optional
        The load that grows, by its number from 0, or by its boundary, point or coupling.
    linear : {"auto", "faer", "partial", "condensed", "umfpack"}, optional
        "auto": what suits the sizes. None: what the scene says. ``solver.linear`` of the overrides goes before it.

    Returns
    -------
    Capacity

    Raises
    ------
    SceneError
        A scene that is not sound; it names the key.
    ValueError
        A load that the scene does not have, or that is 0 at the end.
    KeyboardInterrupt
        After Ctrl-C, within an iteration.

    Examples
    --------
    >>> import stickslip as ss
    >>> found = ss.capacity(ss.Scene.example("block"), 1)
    >>> found.holds, round(found.safety, 2), found.held
    (True, 1.25, '(50000, 0) N/m2')
    """
    name, text, files = _read(scene)
    try:
        found = json.loads(_core.find_capacity((name, text), _with_linear(overrides, linear), files, str(load)))
    except SceneError as error:
        raise error._in_python(isinstance(scene, str)) from None
    except ValueError as error:
        raise ValueError(in_python(str(error))) from None
    found["message"] = in_python(found["message"])
    return Capacity(**{key: found[key] for key in Capacity.__dataclass_fields__})
