"""A scene that an editor completes: each call hands back a new scene.

    scene = (
        Scene.block([1.0, 1.0], [50, 50])
        .material(young=210e9, poisson=0.3)
        .support("left", "x", "y")
        .contact("bottom", plane(gap=1e-5), friction=0.4)
        .load("top", traction=[0.0, -10e6], history=[[0, 0], [1, 1]])
        .time(end=1.0, increments=10)
    )
    result = stickslip.run(scene)
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Any, Literal


def plane(*, gap: float = 0.0, **keys: Any) -> dict[str, Any]:
    """An obstacle with a plane face at a distance `gap` (m) from the boundary; further keys as scenes have them."""
    return {"kind": "plane", "gap": gap, **keys}


class Scene:
    """The keys of a scene; `to_dict` shows them. SI units unless `units` says otherwise."""

    def __init__(self, keys: dict[str, Any] | None = None) -> None:
        self._keys = keys or {}

    def to_dict(self) -> dict[str, Any]:
        """The keys, as a scene file has them."""
        return copy.deepcopy(self._keys)

    def __repr__(self) -> str:
        return f"Scene({self._keys!r})"

    def _with(self, **keys: Any) -> Scene:
        return Scene({**self.to_dict(), **keys})

    def _and(self, table: str, **keys: Any) -> Scene:
        one = {name: value for name, value in keys.items() if value is not None}
        return self._with(**{table: [*self._keys.get(table, []), one]})

    @classmethod
    def block(cls, size: Sequence[float], elements: Sequence[int], *, title: str = "", **keys: Any) -> Scene:
        """A rectangle or box of `size` (m): boundaries left, right, bottom, top (and front, back)."""
        mesh = {"kind": "block", "size": list(size), "elements": list(elements), **keys}
        return cls({**({"title": title} if title else {}), "mesh": mesh})

    @classmethod
    def on_mesh(cls, *, title: str = "") -> Scene:
        """On a mesh that `Model` or `run` is given."""
        return cls({"title": title} if title else {})

    def material(self, *, young: float, poisson: float, plane: Literal["strain", "stress"] | None = None, **keys: Any) -> Scene:
        """Young's modulus, Pa, and Poisson's ratio."""
        return self._with(material={"young": young, "poisson": poisson, **({"plane": plane} if plane else {}), **keys})

    def support(self, boundary: str, *fix: Literal["x", "y", "z"], **keys: Any) -> Scene:
        """Holds a boundary along axes."""
        return self._and("support", boundary=boundary, fix=list(fix) or None, **keys)

    def contact(self, boundary: str, obstacle: dict[str, Any] | None = None, *, friction: float, **keys: Any) -> Scene:
        """Puts an obstacle in front of a boundary: `plane(gap=...)`, or the keys of another kind."""
        return self._and("contact", boundary=boundary, friction=friction, obstacle=obstacle, **keys)

    def load(
        self, boundary: str | None = None, *, traction: Sequence[float] | None = None,
        history: Sequence[Sequence[float]] | None = None, **keys: Any,
    ) -> Scene:
        """A traction, N/m², whose factor goes through the points [time, factor] of `history`."""
        points = None if history is None else [list(point) for point in history]
        return self._and("load", boundary=boundary, traction=None if traction is None else list(traction), history=points, **keys)

    def time(self, *, end: float, increments: int) -> Scene:
        """The end of the history, s, and its equal increments."""
        return self._with(time={"end": end, "increments": increments})

    def solver(
        self, method: Literal["bn", "ip", "events"] = "bn", setting: Literal["default", "paper"] | None = None, **keys: Any
    ) -> Scene:
        """The method with its constants; further keys as scenes have them: tolerance, max_iterations, linear."""
        return self._with(solver={"method": method, **({"setting": setting} if setting else {}), **keys})

    def units(self, *, length: str, stress: str) -> Scene:
        """The units of the numbers of this scene, such as "mm" and "MPa", and of `Result.report`; arrays of results stay SI."""
        return self._with(units={"length": length, "stress": stress})
