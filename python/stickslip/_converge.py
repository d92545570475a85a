"""A scene with finer meshes and increments until a quantity is known."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from numbers import Real
from typing import Any

import numpy as np

from . import _core
from ._errors import SceneError, in_python
from ._fields import Svg
from ._options import Linear, whole
from ._scene import SceneLike, _read, _with_linear


@dataclass(frozen=True, eq=False, repr=False)
class Convergence:
    """The value of a quantity on finer and finer meshes, with its uncertainty.

    Numbers are SI. What cannot be said is None: without a limit, where a pressure is singular, there is no uncertainty.

    Attributes
    ----------
    quantity : str
        The quantity, as it was asked for.
    unit : str
        Its SI unit.
    status : str
        "known", or why not: "warned", "singular", "not-converged", "run-limit", "time-limit", "no-finer-mesh" or "memory-limit".
    message : str
        The status in words, with numbers in the units of the scene and the cure.
    value : float or None
        The value of the last run.
    uncertainty : float or None
        Its uncertainty by mesh and increments together, as a share.
    uncertainty_mesh, uncertainty_increments : float or None
        The part of the mesh, and that of the increments.
    extrapolated : float or None
        The value extrapolated to infinitely fine mesh and increments.
    order_mesh, order_increments : float or None
        The observed orders.
    own_mesh_error : float or None
        The error of the mesh of the scene, as a share.
    boundary, position : str or None, list of float or None
        Where the peak is, m.
    warnings : list of dict
        ``kind`` and ``message`` of each warning of the last run.
    runs : list of dict
        For each run ``mesh``, ``elements``, ``increments``, ``value``, ``change``, ``resolved``, ``seconds``.

    Examples
    --------
    >>> import stickslip as ss
    >>> study = ss.converge(ss.Scene.example("block"), "friction_work", to=0.05, overrides={"mesh.elements": [20, 20]})
    >>> study.known, study.unit, study.uncertainty < 0.05
    (True, 'J/m', True)
    """

    quantity: str
    unit: str
    status: str
    message: str
    value: float | None
    uncertainty: float | None
    uncertainty_mesh: float | None
    uncertainty_increments: float | None
    extrapolated: float | None
    order_mesh: float | None
    order_increments: float | None
    own_mesh_error: float | None
    boundary: str | None
    position: list[float] | None
    warnings: list[dict[str, str]]
    runs: list[dict[str, Any]]
    _svg: str

    @property
    def known(self) -> bool:
        """True if the quantity is known to the asked share."""
        return self.status == "known"

    def svg(self) -> Svg:
        """The chart: the value of each run, the extrapolated value, the uncertainty.

        Returns
        -------
        Svg
        """
        return Svg(self._svg)

    def to_pandas(self) -> Any:
        """A `pandas.DataFrame` with a row for each run."""
        import pandas

        return pandas.DataFrame(self.runs)

    def __repr__(self) -> str:
        return f"<Convergence {self.status}: {self.message}>"

    def _repr_html_(self) -> str:
        return f"<div><p>{html.escape(self.message)}</p>{self._svg}</div>"


def _named(meshes: Iterable[int | str] | None) -> list[str]:
    """Meshes as the core takes them."""
    if meshes is None:
        return []
    if isinstance(meshes, (str, bytes)) or not np.iterable(meshes):
        raise TypeError(f'meshes: a list such as [20, 40, 80] or ["coarse.msh", "fine.msh"] expected, {meshes!r} found')
    expected = "a whole number of elements of 1 or more, or a mesh file"
    return [os.fspath(mesh) if isinstance(mesh, (str, os.PathLike)) else str(whole("meshes", mesh, expected)) for mesh in meshes]


def converge(
    scene: SceneLike, quantity: str, *, to: float = 0.02, overrides: Mapping[str, Any] | None = None,
    meshes: Iterable[int | str] | None = None, ratio: float = 2.0, max_runs: int = 12, within: float = 600.0,
    linear: Linear | None = "auto", progress: bool = False,
) -> Convergence:
    """Refines mesh and increments of a scene until the relative uncertainty of a quantity is at most `to`.

    Each run refines what has the larger error, the mesh or the increments.

    Parameters
    ----------
    scene, overrides
        See `Model`.
    quantity : str
        "peak", "force", "tangential", "friction_work" or "stick_ratio": the largest contact pressure, the largest resultant of a
        boundary, the largest tangential force of one, the friction work, or the width of the stick zone as a share. Or any number as the program's ``sweep --table`` names it, such as "max:top.f_x".
    to : float, optional
        The largest relative uncertainty of a known quantity.
    meshes : iterable of int or str, optional
        Meshes from coarse to fine: each its first number of elements, or a mesh file beside the scene. Without them triangles and
        tetrahedra refine themselves, and others have a quarter, half and all of the elements of the scene along each axis, and so on.
    ratio : float, optional
        The factor of the elements along each axis from mesh to mesh, 1.2 to 4.
    max_runs : int, optional
        The largest number of runs, 3 or more.
    within : float, optional
        The largest time of the study, s: a run that is predicted to exceed it is not started, one that exceeds it is stopped.
    linear : {"auto", "faer", "partial", "condensed", "umfpack"}, optional
        "auto": what suits the sizes of each mesh. None: what the scene says. ``solver.linear`` of the overrides goes before it.
    progress : bool, optional
        A bar by tqdm.

    Returns
    -------
    Convergence
        Look at ``known``: a quantity that is singular, or needs more runs than there may be, is no error.

    Raises
    ------
    SceneError
        A scene that is not sound; it names the key.
    ValueError
        A quantity that the scene does not have, meshes that do not become finer, an option that cannot be.
    KeyboardInterrupt
        After Ctrl-C, within an iteration.

    Examples
    --------
    >>> import stickslip as ss
    >>> study = ss.converge(ss.Scene.example("block"), "peak", max_runs=3, overrides={"mesh.elements": [20, 10]})
    >>> study.status, len(study.runs)
    ('run-limit', 3)
    """
    if not isinstance(quantity, str):
        raise ValueError(f"quantity: {quantity!r} found, expected a word such as 'peak'")
    numbers: tuple[tuple[str, Any, str, Callable[[Any], bool]], ...] = (
        ("to", to, "a share between 0 and 1", lambda to: 0 < to < 1),
        ("ratio", ratio, "a factor from 1.2 to 4", lambda ratio: 1.2 <= ratio <= 4),
        ("within", within, "a time in s above 0", lambda within: within > 0),
    )
    for name, number, expected, fits in numbers:
        if not isinstance(number, Real) or isinstance(number, bool) or not fits(number):
            raise ValueError(f"{name}: {number!r} found, expected {expected}")
    most = whole("max_runs", max_runs, "a whole number of 3 or more", least=3)
    words = _with_linear(overrides, linear)
    name, text, files = _read(scene)
    wanted = {
        "quantity": quantity, "to": float(to), "meshes": _named(meshes), "ratio": float(ratio),
        "max_runs": most, "within": float(within),
    }
    bar: Any = None
    if progress:
        from tqdm.auto import tqdm

        bar = tqdm(unit="run")

    def told(what: str) -> None:
        bar.update(1)
        bar.set_postfix_str(what)

    try:
        study, chart = _core.converge((name, text), words, files, wanted, None if bar is None else told)
    except SceneError as error:
        raise error._in_python(isinstance(scene, str)) from None
    except ValueError as error:
        raise ValueError(in_python(str(error))) from None
    finally:
        if bar is not None:
            bar.close()
    found = json.loads(study)
    found["status"], found["message"] = found["verdict"], in_python(found["message"])
    return Convergence(**{key: found[key] for key in Convergence.__dataclass_fields__ if key in found}, _svg=chart)
