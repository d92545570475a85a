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
    scene.save("block.toml")  # for the command: stickslip run block.toml
"""

from __future__ import annotations

import copy
import filecmp
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Literal

from . import _core
from ._errors import SceneError
from ._files import replaced, scene_text
from ._options import path_of
from ._toml import from_toml, to_toml
from ._words import counted


def plane(*, gap: float = 0.0, **keys: Any) -> dict[str, Any]:
    """An obstacle with a plane face, for `Scene.contact`.

    Parameters
    ----------
    gap : float, optional
        Its distance from the boundary, m.
    **keys
        Further keys as scenes have them: ``normal``, ``approach``, ...

    Returns
    -------
    dict

    Examples
    --------
    >>> from stickslip.builder import plane
    >>> plane(gap=1e-5)
    {'kind': 'plane', 'gap': 1e-05}
    """
    return {"kind": "plane", "gap": gap, **keys}


def _named(keys: Any) -> Iterator[str]:
    """The files that a scene names."""
    for name, value in keys.items() if isinstance(keys, dict) else enumerate(keys) if isinstance(keys, (list, tuple)) else ():
        if name == "file" and isinstance(value, (str, os.PathLike)):
            yield os.fspath(value)
        else:
            yield from _named(value)


def _same(one: str, other: str) -> bool:
    return os.path.isfile(one) and os.path.isfile(other) and filecmp.cmp(one, other, shallow=False)


class Scene:
    """The keys of a scene; SI units unless `units` says otherwise.

    Parameters
    ----------
    keys : dict, optional
        As a scene file has them.

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.builder import plane
    >>> scene = (
    ...     ss.Scene.block([1.0, 1.0], [10, 10], title="A block on a plane")
    ...     .material(young=210e9, poisson=0.3)
    ...     .support("left", "x", "y")
    ...     .contact("bottom", plane(gap=1e-5), friction=0.4)
    ...     .load("top", traction=[0.0, -10e6], history=[[0, 0], [1, 1]])
    ...     .time(end=1.0, increments=4)
    ... )
    >>> scene
    <Scene 'A block on a plane': mesh, material, 1 support, 1 contact, 1 load, time>
    >>> ss.run(scene).converged
    True
    """

    def __init__(self, keys: dict[str, Any] | None = None) -> None:
        if keys is not None and not isinstance(keys, dict):
            raise TypeError(f"keys: a dictionary expected, {type(keys).__name__} found")
        self._keys = copy.deepcopy(keys) if keys else {}
        #: What stands for the file, and the files in memory that the scene names, by their paths.
        self._name: str = "scene"
        self._files: dict[str, bytes] = {}

    def to_dict(self) -> dict[str, Any]:
        """The keys, as a scene file has them.

        Returns
        -------
        dict
            A copy, which is free to change.
        """
        return copy.deepcopy(self._keys)

    def to_toml(self) -> str:
        """The text of a scene file: what the command reads, and `from_toml`.

        Returns
        -------
        str

        Examples
        --------
        >>> import stickslip as ss
        >>> print(ss.Scene.block([1.0, 1.0], [10, 10], title="A block").time(end=1.0, increments=4).to_toml(), end="")
        title = "A block"
        <BLANKLINE>
        [mesh]
        kind = "block"
        size = [1.0, 1.0]
        elements = [10, 10]
        <BLANKLINE>
        [time]
        end = 1.0
        increments = 4
        """
        return to_toml(self._keys).lstrip("\n")

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the scene to a file for the command, such as ``stickslip run block.toml``.

        Files in memory, such as the mesh of `example`, are written beside it. A mesh that only `Model` or `run` is given is in
        no scene.

        Parameters
        ----------
        path : str or os.PathLike
            The file, replaced if it exists.

        Raises
        ------
        ValueError
            A file that the scene names would not be beside it, or would replace another; nothing is written then.
        """
        path = path_of(path)
        text, folder = self.to_toml(), os.path.dirname(path)
        for name, content in self._files.items():
            if os.path.isabs(name) or ".." in Path(name).parts:
                raise ValueError(f"path: the scene's file {name} would not be written beside it")
            beside = os.path.join(folder, name)
            if os.path.exists(beside) and not (os.path.isfile(beside) and Path(beside).read_bytes() == content):
                raise ValueError(f"path: {beside} exists and is another file than the scene's {name}; save the scene in another folder")
        for name in _named(self._keys):
            there, here = os.path.join(os.path.dirname(self._name), name), os.path.join(folder, name)
            if name not in self._files and os.path.abspath(there) != os.path.abspath(here) and not _same(there, here):
                raise ValueError(f"path: the scene names {name}, which is no copy of {there} there; copy it, or name it by its whole path")
        for name, content in self._files.items():
            beside = os.path.join(folder, name)
            os.makedirs(os.path.dirname(beside) or ".", exist_ok=True)
            with open(beside, "wb") as file:
                file.write(content)
        with replaced(path) as written:
            written.write(text.encode())

    def __repr__(self) -> str:
        title = self._keys.get("title", "")
        parts = []
        for name, value in self._keys.items():
            if isinstance(value, list):
                parts.append(counted(len(value), name, {"body": "bodies"}.get(name, "")))
            elif name != "title":
                parts.append(name)
        return f"<Scene {title!r}: {', '.join(parts)}>"

    def _with(self, **keys: Any) -> Scene:
        scene = Scene({**self._keys, **keys})
        scene._name, scene._files = self._name, self._files
        return scene

    def _and(self, table: str, **keys: Any) -> Scene:
        one = {name: value for name, value in keys.items() if value is not None}
        return self._with(**{table: [*self._keys.get(table, []), one]})

    @classmethod
    def block(cls, size: Sequence[float], elements: Sequence[int], *, title: str = "", **keys: Any) -> Scene:
        """A rectangle or box with the boundaries left, right, bottom, top (and front, back).

        Parameters
        ----------
        size : sequence of float
            Its two or three lengths, m.
        elements : sequence of int
            So many elements along each.
        title : str, optional
            A line for headings.
        **keys
            Further keys of ``mesh`` as scenes have them.

        Returns
        -------
        Scene
        """
        mesh = {"kind": "block", "size": list(size), "elements": list(elements), **keys}
        return cls({**({"title": title} if title else {}), "mesh": mesh})

    @classmethod
    def on_mesh(cls, *, title: str = "") -> Scene:
        """On a mesh that `Model` or `run` is given.

        Parameters
        ----------
        title : str, optional
            A line for headings.

        Returns
        -------
        Scene
        """
        return cls({"title": title} if title else {})

    @classmethod
    def from_toml(cls, text: str) -> Scene:
        """The scene of a text in TOML.

        Parameters
        ----------
        text : str
            As a scene file has it; files that it names are looked for in the working folder.

        Returns
        -------
        Scene

        Raises
        ------
        SceneError
            A text that is no TOML. Which keys a scene may have, `Model` says.
        """
        if not isinstance(text, str):
            raise TypeError(f"text: a str expected, {type(text).__name__} found")
        try:
            return cls(from_toml(text))
        except ValueError as error:
            raise SceneError(f"text: {error}") from None

    @classmethod
    def from_file(cls, path: str | os.PathLike[str]) -> Scene:
        """The scene of a file, to be changed; files that it names are beside it.

        Parameters
        ----------
        path : str or os.PathLike
            A scene file.

        Returns
        -------
        Scene

        Raises
        ------
        FileNotFoundError
            If there is no such file.
        SceneError
            A text that is no TOML, no text at all, or what is neither a file nor a pipe.
        """
        path = path_of(path)
        scene = cls.from_toml(scene_text("path", path))
        scene._name = path
        return scene

    @staticmethod
    def examples() -> list[str]:
        """The names of the scenes to start from, those of ``stickslip init``.

        Returns
        -------
        list of str

        Examples
        --------
        >>> import stickslip as ss
        >>> ss.Scene.examples()
        ['block', 'cube', 'gmsh']
        """
        return _core.examples()

    @classmethod
    def example(cls, name: Literal["block", "cube", "gmsh"]) -> Scene:
        """A scene to start from, with the mesh that it reads.

        Parameters
        ----------
        name : {"block", "cube", "gmsh"}
            Which; `examples` lists them.

        Returns
        -------
        Scene

        Raises
        ------
        ValueError
            If there is none of this name.

        Examples
        --------
        >>> import stickslip as ss
        >>> ss.Scene.example("gmsh")
        <Scene 'Roller on a plane': mesh, material, 1 support, 1 contact, time, solver, output>
        """
        found = _core.example(name) if isinstance(name, str) else None
        if found is None:
            raise ValueError(f"name: {name!r} found, expected one of {', '.join(_core.examples())}")
        text, files = found
        scene = cls.from_toml(text)
        scene._name, scene._files = f"{name}.toml", dict(files)
        return scene

    def material(self, *, young: float, poisson: float, plane: Literal["strain", "stress", "axisymmetric", "axisymmetric-torsion"] | None = None, **keys: Any) -> Scene:
        """The elastic constants.

        Parameters
        ----------
        young : float
            Young's modulus, Pa.
        poisson : float
            Poisson's ratio.
        plane : {"strain", "stress", "axisymmetric", "axisymmetric-torsion"}, optional
            In two dimensions: a long body, a thin plate, or half the section of a body of revolution.
        **keys
            Further keys as scenes have them: ``thickness``, ``density``, ``expansion``, ``layers``.

        Returns
        -------
        Scene
        """
        return self._with(material={"young": young, "poisson": poisson, **({"plane": plane} if plane else {}), **keys})

    def support(
        self, boundary: str | None = None, *fix: Literal["x", "y", "z", "normal", "rotation_x", "rotation_y", "rotation_z"], **keys: Any
    ) -> Scene:
        """Holds a boundary, a point or a coupling.

        Parameters
        ----------
        boundary : str or None
            Its name; None with the key ``point`` or ``coupling``.
        *fix : {"x", "y", "z", "normal", "rotation_x", "rotation_y", "rotation_z"}
            Directions that are held; rotations are those of a coupling.
        **keys
            Further keys as scenes have them: ``displacement``, ``history``, ``direction``, ``point``, ``coupling``.

        Returns
        -------
        Scene
        """
        return self._and("support", boundary=boundary, fix=list(fix) or None, **keys)

    def contact(
        self, boundary: str, obstacle: dict[str, Any] | Sequence[dict[str, Any]] | None = None, *,
        friction: float | str | None = None, **keys: Any,
    ) -> Scene:
        """Puts an obstacle in front of a boundary.

        Parameters
        ----------
        boundary : str
            Its name.
        obstacle : dict or sequence of dict, optional
            `plane`, or the keys of another kind; without it another boundary by the key ``against``.
        friction : float or str
            Coulomb's coefficient, or a formula such as ``"0.1 + 0.2 * x"``; only contact with ``glue`` has none.
        **keys
            Further keys as scenes have them: ``against``, ``friction_history``, ``glue``, ``gap``, ...

        Returns
        -------
        Scene
        """
        return self._and("contact", boundary=boundary, friction=friction, obstacle=obstacle, **keys)

    def load(
        self, boundary: str | None = None, *, traction: Sequence[float | str] | None = None,
        history: Sequence[Sequence[float]] | None = None, **keys: Any,
    ) -> Scene:
        """A load whose factor goes through the points of its history.

        Parameters
        ----------
        boundary : str, optional
            Where a traction acts.
        traction : sequence of float or str, optional
            N/m² along the axes: numbers or formulas.
        history : sequence of pairs, optional
            [time, factor], s and a number.
        **keys
            Further keys as scenes have them: ``pressure``, ``force``, ``acceleration``, ``temperature``, ...

        Returns
        -------
        Scene
        """
        points = None if history is None else [list(point) for point in history]
        return self._and("load", boundary=boundary, traction=None if traction is None else list(traction), history=points, **keys)

    def time(self, *, end: float, increments: int) -> Scene:
        """The history.

        Parameters
        ----------
        end : float
            When it ends, s.
        increments : int
            So many, of equal length.

        Returns
        -------
        Scene
        """
        return self._with(time={"end": end, "increments": increments})

    def solver(
        self, method: Literal["bn", "ip", "events"] = "bn", setting: Literal["default", "paper"] | None = None, **keys: Any
    ) -> Scene:
        """The method with its constants.

        Parameters
        ----------
        method : {"bn", "ip", "events"}, optional
            Newton's method, the interior point method, or the exact path.
        setting : {"default", "paper"}, optional
            Its constants.
        **keys
            Further keys as scenes have them: ``tolerance``, ``max_iterations``, ``linear``, which the command takes and `run` only with
            ``linear=None``.

        Returns
        -------
        Scene
        """
        return self._with(solver={"method": method, **({"setting": setting} if setting else {}), **keys})

    def units(self, *, length: str, stress: str) -> Scene:
        """The units of the numbers of this scene and of `Result.report`; arrays of results stay SI.

        Parameters
        ----------
        length, stress : str
            Such as "mm" and "MPa".

        Returns
        -------
        Scene
        """
        return self._with(units={"length": length, "stress": stress})
