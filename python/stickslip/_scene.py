"""Scenes: a file, a text, a dictionary or a builder, discretised and run."""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Mapping, Sequence
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from . import mesh as _mesh
from ._errors import SceneError
from ._problem import Callback, ContactProblem, LinearSolver, keep, vector
from ._result import Result
from .builder import Scene

Array = NDArray[Any]

#: A path, the text of a scene (it has several lines), a dictionary of its keys, or a `Scene`.
SceneLike = Union[str, "os.PathLike[str]", Mapping[str, Any], Scene]


def toml_value(value: Any) -> str:
    """A value as TOML, tables inline."""
    value = value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, str)):
        return json.dumps(value)
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else ("nan" if math.isnan(value) else "inf" if value > 0 else "-inf")
    if isinstance(value, os.PathLike):
        return json.dumps(os.fspath(value))
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(k)} = {toml_value(v)}" for k, v in value.items() if v is not None) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(toml_value, value)) + "]"
    raise TypeError(f"a scene has no values of the type {type(value).__name__}")


def _key(name: Any) -> str:
    return str(name) if re.fullmatch(r"[A-Za-z0-9_-]+", str(name)) else json.dumps(str(name))


def to_toml(scene: Mapping[str, Any]) -> str:
    """A dictionary as the text of a scene: tables and lists of tables on lines of their own."""
    plain, tables = [], []
    for name, value in scene.items():
        if isinstance(value, Mapping):
            tables += [f"\n[{_key(name)}]", *_lines(value)]
        elif isinstance(value, (list, tuple)) and value and all(isinstance(item, Mapping) for item in value):
            for item in value:
                tables += [f"\n[[{_key(name)}]]", *_lines(item)]
        elif value is not None:
            plain.append(f"{_key(name)} = {toml_value(value)}")
    return "\n".join([*plain, *tables]) + "\n"


def _lines(table: Mapping[str, Any]) -> list[str]:
    return [f"{_key(name)} = {toml_value(value)}" for name, value in table.items() if value is not None]


def _read(scene: SceneLike) -> tuple[str, str]:
    """Name and text."""
    if isinstance(scene, Scene):
        scene = scene.to_dict()
    if isinstance(scene, Mapping):
        return "scene", to_toml(scene)
    if isinstance(scene, str) and "\n" in scene:
        return "scene", scene
    if not isinstance(scene, (str, os.PathLike)):
        raise TypeError(f"scene: a path, a text, a dictionary or a Scene expected, {type(scene).__name__} found")
    path = os.fspath(scene)
    with open(path, encoding="utf-8") as file:
        return path, file.read()


class Model:
    """A scene, discretised; nothing is solved yet.

    Args:
        scene: a path, the text of a scene, a dictionary of its keys, or a `Scene`.
        overrides: by key, such as {"mesh.elements": [50, 50], "contact[0].friction": 0.3}.
        mesh: a mesh in memory in place of the scene's, which then may leave out [mesh]: of meshio, gmsh or `stickslip.mesh`, in m.

    Attributes:
        title, dimension: the scene's title; 2 or 3.
        times: ends of the increments, s, (m,).
        problem: K, C_n, C_t, mu and weights as a `ContactProblem`.
        points: nodes, m, (nodes, 3).
        cells: (kind by meshio's names, nodes (k, corners)), neighbouring cells of a kind together, in the order of the mesh.
        contact_nodes: the nodes of the mesh that are contact nodes, (n_c,).
        contact_points: where they are, m, (n_c, 3).
        frames: normal towards the obstacle and tangents, (n_c, 1 + d, 3).
        boundaries: by name, the contact nodes of a boundary.
    """

    def __init__(self, scene: SceneLike, overrides: Mapping[str, Any] | None = None, *, mesh: Any = None, name: str = "") -> None:
        read, text = _read(scene)
        self._has_text = not isinstance(scene, (Mapping, Scene))
        given = None if mesh is None else _mesh.given(mesh)
        if given is not None and not re.search(r"(?m)^\s*\[mesh\]", text):
            space = any(_mesh._DIMENSION.get(kind) == 3 for kind, _, _ in given["cells"])
            ones = "[1, 1, 1]" if space else "[1, 1]"
            text += f'\n[mesh]\nkind = "block"\nsize = {ones}\nelements = {ones}\n'
        self._make(name or read, text, {k: toml_value(v) for k, v in (overrides or {}).items()}, given, {})

    def _make(self, name: str, text: str, overrides: dict[str, str], given: _mesh.Given | None, files: dict[str, bytes]) -> None:
        self._arguments = (name, text, overrides, given)
        words = [f"{key}={value}" for key, value in overrides.items()]
        try:
            self._core = core = _core.SceneModel(name, text, words, given, files)  # type: ignore[arg-type]
        except SceneError as error:
            raise error.in_python(self._has_text) from None
        self.title, self.dimension = core.title, core.dimension
        self.times = np.array(core.times)
        self.problem = ContactProblem._of(core.problem(), self.dimension - 1)
        self.points = core.points()
        contacts = core.contacts()
        self.contact_nodes = np.array([node for node, _ in contacts], dtype=np.int64)
        self.contact_points = np.array([x for _, x in contacts]).reshape(-1, 3)
        self.frames = np.array(core.frames()).reshape(-1, 3, 3)[:, : self.dimension]
        self.boundaries = {name: np.array(nodes, dtype=np.int64) for name, nodes in core.boundaries()}
        self.cells = _blocks(core.cells())

    def _files(self) -> dict[str, bytes]:
        """The files that the scene names, meshes for one, as they were when the model was made."""
        return {os.fspath(path): content for path, content in self._core.files()}

    def __reduce__(self) -> Any:
        return _restore, (*self._arguments, self._files())

    def _saved(self) -> tuple[dict[str, Any], dict[str, Array]]:
        """All that makes it again, in words and in arrays."""
        files = self._files()
        words: dict[str, Any] = {"name": self._arguments[0], "text": self._core.text, "files": list(files)}
        arrays: dict[str, Array] = {f"model.file{k}": np.frombuffer(content, np.uint8) for k, content in enumerate(files.values())}
        given = self._arguments[3]
        if given is not None:
            arrays["model.points"] = given["points"]
            for k, (_, nodes, group) in enumerate(given["cells"]):
                arrays |= {f"model.cells{k}": nodes, f"model.group{k}": group}
            kinds = [kind for kind, _, _ in given["cells"]]
            words["mesh"] = {"kinds": kinds, "groups": given["groups"], "boundaries": given["boundaries"]}
        return words, arrays

    @classmethod
    def _loaded(cls, words: dict[str, Any], arrays: dict[str, Array]) -> Model:
        given: _mesh.Given | None = None
        if words.get("mesh"):
            cells = [(kind, arrays[f"model.cells{k}"], arrays[f"model.group{k}"]) for k, kind in enumerate(words["mesh"]["kinds"])]
            boundaries = [(name, facets) for name, facets in words["mesh"]["boundaries"]]
            given = {"points": arrays["model.points"], "cells": cells, "groups": words["mesh"]["groups"], "boundaries": boundaries}
        files = {path: arrays[f"model.file{k}"].tobytes() for k, path in enumerate(words.get("files", []))}
        return _restore(words["name"], words["text"], {}, given, files)

    def __repr__(self) -> str:
        return f"<Model {self.title!r}: {len(self.points)} nodes, {len(self.times)} increments, {self.problem!r}>"

    @property
    def history(self) -> dict[str, Array]:
        """What drives it, for other people's solvers.

        force: N, (m, n_u). gap: m, (m + 1, n_c), the first row before the first increment. drift: how far the obstacle has moved past
        each node, m, (m, n_c, d). mu: (m, n_c). cases, factors: the loads (loads, n_u), N, that force is the sum of, (m, loads).
        """
        raw = self._core.history()
        drift = np.stack([raw["drift"], raw["drift_o"]][: self.dimension - 1], axis=-1)
        force = raw["factors"].reshape(len(self.times), -1) @ raw["cases"]
        return {"force": force, "gap": raw["gap"], "drift": drift, "mu": raw["mu"], "cases": raw["cases"], "factors": raw["factors"]}

    def displacement(self, u: ArrayLike, t: float | None = None) -> Array:
        """Displacements of all nodes, m, (nodes, 3), of the free ones u at time t (the end without it), where supports have moved."""
        return self._core.displacements(self.times[-1] if t is None else t, vector("u", u, self.problem.n_u))

    def stress(self, u: ArrayLike, t: float | None = None) -> Array:
        """Stresses in the middle of each cell, Pa, (cells, 6): xx, yy, zz, xy, yz, zx, of free displacements u at time t."""
        return self._core.stresses(self.times[-1] if t is None else t, vector("u", u, self.problem.n_u))

    def run(
        self, *, linear: str | LinearSolver | None = "auto", keep_u: str | bool | Sequence[int] = "all",
        callback: Callback | None = None, progress: bool = False, uniqueness: bool = False,
        max_iterations: int | None = None, tolerance: float | None = None, _stacklevel: int = 3,
    ) -> Result:
        """Solves the history as the scene says.

        Args:
            linear: "auto", the cheapest; "faer", "condensed", "umfpack" where it is built in; or a `LinearSolver`. None: what the
                scene says, which without a word is a sparse LU of the whole system.
            keep_u: of which increments displacements are kept: "all", "last", "none" or a list of indices.
            callback: called with (increment, time, status, iterations, error) once an increment is judged;
                whatever it raises ends the run and comes out.
            progress: a bar by tqdm.
            uniqueness: whether `report["critical_friction"]` is wanted.
            max_iterations, tolerance: in place of the scene's.
        """
        if max_iterations is not None and max_iterations < 1:
            raise ValueError("max_iterations must be 1 or more")
        if tolerance is not None and not 0 < tolerance < 1:
            raise ValueError("tolerance must be between 0 and 1")
        bar: Any = None
        told: Callback | None = callback
        if progress:
            from tqdm.auto import tqdm

            bar = tqdm(total=len(self.times), unit="increment")

            def counted(index: int, time: float, status: str, iterations: int, error: float) -> None:
                bar.update(1)
                bar.set_postfix(error=f"{error:.1e}")
                if callback is not None:
                    callback(index, time, status, iterations, error)

            told = counted

        try:
            kept = keep(keep_u, len(self.times))
            raw = self._core.run(linear, kept, told, uniqueness, max_iterations, tolerance)
        finally:
            if bar is not None:
                bar.close()
        return Result._of(raw, self.dimension - 1, self, stacklevel=_stacklevel)


def _blocks(cells: list[tuple[str, list[int], int]]) -> list[tuple[str, Array]]:
    """Neighbours of one kind together."""
    blocks: list[tuple[str, list[list[int]]]] = []
    for kind, nodes, _ in cells:
        if not blocks or blocks[-1][0] != kind:
            blocks.append((kind, []))
        blocks[-1][1].append(nodes)
    return [(kind, np.array(nodes, dtype=np.int64)) for kind, nodes in blocks]


def _restore(name: str, text: str, overrides: dict[str, str], given: _mesh.Given | None, files: dict[str, bytes]) -> Model:
    model = Model.__new__(Model)
    model._has_text = True
    model._make(name, text, overrides, given, files)
    return model


def run(scene: SceneLike, overrides: Mapping[str, Any] | None = None, *, mesh: Any = None, **options: Any) -> Result:
    """Discretises a scene and solves it: `Model(scene, overrides, mesh=mesh).run(**options)`.

        result = stickslip.run("block.toml", {"mesh.elements": [50, 50]})
        result.check().plot()
    """
    return Model(scene, overrides, mesh=mesh).run(_stacklevel=4, **options)
