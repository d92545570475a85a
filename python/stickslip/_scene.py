"""Scenes: a file, a text, a dictionary or a builder, discretised and run."""

from __future__ import annotations

import contextlib
import json
import os
import re
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any, Literal, Union, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from . import mesh as _mesh
from ._arrays import read_only, vector
from ._errors import SceneError
from ._files import scene_text
from ._kinds import DIMENSION
from ._options import Linear as LinearName
from ._options import Callback, LinearSolver, called, keep, linear_of, path_of, share, whole
from ._problem import ContactProblem
from ._result import Result
from ._toml import to_toml, toml_value
from ._words import counted, warn
from .builder import Scene

Array = NDArray[Any]

#: A path, the text of a scene (it has several lines), a dictionary of its keys, or a `Scene`.
SceneLike = Union[str, "os.PathLike[str]", Mapping[str, Any], Scene]

#: The linear algebra of a run: a word, an object of one's own, or None for what the scene says.
Linear = Union[Literal["auto", "faer", "partial", "condensed", "umfpack"], LinearSolver, None]

#: Of which increments displacements are kept.
KeepU = Union[Literal["all", "last", "none"], Sequence[int]]


def _read(scene: SceneLike) -> tuple[str, str, dict[str, bytes]]:
    """Name, text, and files in memory."""
    if isinstance(scene, Scene):
        return scene._name, to_toml(scene._keys), scene._files
    if isinstance(scene, Mapping):
        return "scene", to_toml(scene), {}
    if isinstance(scene, str) and "\n" in scene:
        return "scene", scene, {}
    if not isinstance(scene, (str, os.PathLike)):
        raise TypeError(f"scene: a path, a text, a dictionary or a Scene expected, {type(scene).__name__} found")
    path = os.fspath(scene)
    return path, scene_text("scene", path), {}


def _words(overrides: Mapping[str, Any] | None, has_mesh: bool) -> dict[str, str]:
    """The overrides by key, each value as TOML."""
    if overrides is None:
        return {}
    if not isinstance(overrides, Mapping):
        raise TypeError(f"overrides: a dictionary expected, such as {{'contact.friction': 0.3}}, {type(overrides).__name__} found")
    for key in overrides:
        if not isinstance(key, str):
            raise TypeError(f"overrides: keys are words such as 'contact[0].friction', {key!r} found")
        if not re.fullmatch(r"[\w-]+(\[\d+\])*(\.[\w-]+(\[\d+\])*)*", key):
            raise ValueError(f"{key}: this is no key of a scene, such as 'mesh.elements' or 'contact[0].friction'")
        if has_mesh and re.match(r"mesh\b", key):
            raise ValueError(f"{key}: the mesh is given by `mesh`, so that this key has no effect; leave it out")
    return {key: toml_value(value, key) for key, value in overrides.items()}


def _with_linear(overrides: Mapping[str, Any] | None, linear: str | None) -> list[str]:
    """The overrides as words, after this linear solver."""
    if linear is not None and linear not in get_args(LinearName):
        raise ValueError(f"linear: {linear!r} found, expected None or one of {', '.join(get_args(LinearName))}")
    chosen = {} if linear is None else {"solver.linear": linear}
    return [f"{key}={value}" for key, value in {**_words(chosen, has_mesh=False), **_words(overrides, has_mesh=False)}.items()]


def _with_any_mesh(text: str, given: _mesh.Given) -> str:
    """The text with a mesh, which the reader of scenes asks for; the one in memory takes its place."""
    if re.search(r"(?m)^\s*(\[\s*mesh\s*[\].]|mesh\s*[.=])", text):
        return text
    space = any(DIMENSION.get(kind) == 3 for kind, _, _ in given["cells"])
    ones = "[1, 1, 1]" if space else "[1, 1]"
    return text + f'\n[mesh]\nkind = "block"\nsize = {ones}\nelements = {ones}\n'


class Model:
    """A scene, discretised; nothing is solved yet. Its arrays are read-only, and copies of them are not.

    Parameters
    ----------
    scene : str, os.PathLike, Mapping or Scene
        A path, the text of a scene (it has several lines), a dictionary of its keys, or a `Scene`.
    overrides : Mapping, optional
        Values by key, such as ``{"mesh.elements": [50, 50], "contact[0].friction": 0.3}``.
    mesh : object, optional
        A mesh in memory in place of the scene's, which then may leave out ``mesh``: of meshio or gmsh, in m, or what
        `stickslip.mesh` makes.
    name : str, optional
        What stands for the file in messages; files that the scene names are beside it.

    Attributes
    ----------
    title : str
        The scene's title.
    dimension : int
        2 or 3.
    t : ndarray, shape (m,)
        Ends of the increments, s.
    problem : ContactProblem
        K, C_n, C_t, mu and weights.
    points : ndarray, shape (nodes, 3)
        Nodes, m.
    cells : list of (str, ndarray)
        Kind by meshio's names and nodes (k, nodes of the kind); neighbouring cells of a kind together, in the order of the mesh.
    contact_nodes : ndarray of int, shape (n_c,)
        The nodes of the mesh that are contact nodes.
    contact_points : ndarray, shape (n_c, 3)
        Where they are, m.
    frames : ndarray, shape (n_c, 1 + d, 3)
        Normal towards the obstacle and tangents, unit vectors.
    boundaries : dict of str to ndarray of int
        By name, the contact nodes of a boundary.

    Raises
    ------
    SceneError
        A scene that is not sound; it names the key.
    FileNotFoundError
        The scene or a file that it names.
    ValueError
        A mesh in memory that is not sound.

    Examples
    --------
    >>> import stickslip as ss
    >>> model = ss.Model(ss.Scene.example("block"), {"mesh.elements": [8, 4]})
    >>> model.dimension, model.points.shape, model.problem.n_c
    (2, (45, 3), 9)
    >>> list(model.boundaries)
    ['bottom']
    """

    def __init__(self, scene: SceneLike, overrides: Mapping[str, Any] | None = None, *, mesh: Any = None, name: str = "") -> None:
        read, text, files = _read(scene)
        self._has_text = not isinstance(scene, (Mapping, Scene))
        given = None if mesh is None else _mesh.given(mesh)
        if given is not None:
            text = _with_any_mesh(text, given)
        self._make(name or read, text, _words(overrides, given is not None), given, files)

    def _make(self, name: str, text: str, overrides: dict[str, str], given: _mesh.Given | None, files: dict[str, bytes]) -> None:
        self._arguments = (name, text, overrides, given)
        words = [f"{key}={value}" for key, value in overrides.items()]
        try:
            self._core = core = _core.SceneModel(name, text, words, given, files)  # type: ignore[arg-type]
        except SceneError as error:
            raise error._in_python(self._has_text) from None
        self.title: str = core.title
        self.dimension: int = core.dimension
        self.t: Array = read_only(np.array(core.times))
        self.problem: ContactProblem = ContactProblem._of(core.problem(), core.components - 1)
        self.points: Array = read_only(core.points())
        contacts = core.contacts()
        self.contact_nodes: Array = read_only(np.array([node for node, _ in contacts], dtype=np.int64))
        self.contact_points: Array = read_only(np.array([x for _, x in contacts]).reshape(-1, 3))
        self.frames: Array = read_only(np.array(core.frames()).reshape(-1, 3, 3)[:, : core.components])
        self.boundaries: dict[str, Array] = {name: read_only(np.array(nodes, dtype=np.int64)) for name, nodes in core.boundaries()}
        self.cells: list[tuple[str, Array]] = _blocks(core.cells())

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
        return f"<Model {self.title!r}: {counted(len(self.points), 'node')}, {counted(len(self.t), 'increment')}, {self.problem!r}>"

    @property
    def history(self) -> dict[str, Array]:
        """Loads, gaps, drift and friction over time, for other people's solvers: the keywords of `ContactProblem.solve`.

        Returns
        -------
        dict of str to ndarray
            ``force``, N, (m, n_u). ``gap``, m, (m + 1, n_c), the first row before the first increment. ``drift``, how far the
            obstacle has moved past each node, m, (m, n_c, d). ``mu``, (m, n_c). ``t``, the ends of the increments, s, (m,).
            Arrays are read-only; copies of them are not.

        Examples
        --------
        >>> import stickslip as ss
        >>> history = ss.Model(ss.Scene.example("block"), {"mesh.elements": [8, 4]}).history
        >>> history["force"].shape, history["gap"].shape
        ((20, 90), (21, 9))
        """
        raw = self._core.history()
        drift = np.stack([raw["drift"], raw["drift_o"]][: self._core.components - 1], axis=-1)
        force = raw["factors"].reshape(len(self.t), -1) @ raw["cases"]
        history = {"force": force, "gap": raw["gap"], "drift": drift, "mu": raw["mu"], "t": self.t}
        return {name: read_only(table) for name, table in history.items()}

    @property
    def loads(self) -> tuple[Array, Array]:
        """The loads that the force of `history` is the sum of, N, (loads, n_u), and their factors, (m, loads).

        In the order of ``[[load]]``; then those of supports and bolts, if there are any. `ContactProblem.solve` takes them in place
        of the sum: ``problem.solve(*model.loads, gap=model.history["gap"])``.
        """
        raw = self._core.history()
        return read_only(raw["cases"]), read_only(raw["factors"].reshape(len(self.t), -1))

    def displacement(self, u: ArrayLike, t: float | None = None) -> Array:
        """Displacements of all nodes, those of supports included.

        Parameters
        ----------
        u : array_like, shape (n_u,)
            Free displacements, m.
        t : float, optional
            When, s, where supports move; the end without it.

        Returns
        -------
        ndarray, shape (nodes, 3)
            m.
        """
        return self._core.displacements(self._time(t), vector("u", u, self.problem.n_u))

    def stress(self, u: ArrayLike, t: float | None = None) -> Array:
        """Stresses in the middle of each cell.

        The strain that the scene's own loads ``temperature`` have at t is subtracted, and supports are where the scene has them
        at t. A coupled run with factors of its own has another thermal strain: take a scene with these temperatures.

        Parameters
        ----------
        u : array_like, shape (n_u,)
            Free displacements, m.
        t : float, optional
            When, s; the end without it.

        Returns
        -------
        ndarray, shape (cells, 6)
            Pa: xx, yy, zz, xy, yz, zx.
        """
        return self._core.stresses(self._time(t), vector("u", u, self.problem.n_u))

    def _time(self, t: float | None) -> float:
        if t is None:
            return float(self.t[-1])
        if not np.isfinite(t):
            raise ValueError(f"t: {t} found, expected a time in s")
        return float(t)

    def with_(self, overrides: Mapping[str, Any]) -> Model:
        """The same scene with other values, discretised anew.

        Parameters
        ----------
        overrides : Mapping
            As those of `Model`, over those that the model has.

        Returns
        -------
        Model

        Examples
        --------
        >>> import stickslip as ss
        >>> model = ss.Model(ss.Scene.example("block"), {"mesh.elements": [8, 4]})
        >>> len(model.t), len(model.with_({"time.increments": 40}).t)
        (20, 40)
        """
        name, text, before, given = self._arguments
        return _restore(name, text, {**before, **_words(overrides, given is not None)}, given, self._files(), self._has_text)

    def refined(self, error: float) -> Model:
        """The same scene on a mesh of triangles or tetrahedra that has refined itself, as ``mesh.refine`` does for the command.

        The mesh is given from then on: other loads or materials, by `with_`, have the same one.

        Parameters
        ----------
        error : float
            The error of the stresses in the energy norm, relative, up to which the mesh is refined; 0.05 for 5 %. After a history
            that does not converge the mesh stays as it is.

        Returns
        -------
        Model

        Raises
        ------
        SceneError
            Other cells.

        Examples
        --------
        >>> import stickslip as ss
        >>> model = ss.Model(ss.Scene.example("block"), {"mesh.elements": [4, 4], "mesh.cells": "triangle"})
        >>> len(model.points) < len(model.refined(0.1).points)
        True
        """
        try:
            points, cells, groups, boundaries = self._core.refined(share("error", error, "a share above 0 and below 1"))
        except SceneError as fault:
            raise fault._in_python(self._has_text) from None
        of_group = np.array([group for _, _, group in cells])
        blocks = [(cells[0][0], np.array([nodes for _, nodes, _ in cells]), of_group)]
        given: _mesh.Given = {"points": points, "cells": blocks, "groups": groups, "boundaries": boundaries}
        name, text, before, _ = self._arguments
        return _restore(name, text, before, given, self._files(), self._has_text)

    def _as_said(self) -> Model:
        """On the mesh that ``mesh.refine`` asks for."""
        return self if self._core.refine is None else self.refined(self._core.refine)

    def run(
        self, *, linear: Linear = "auto", keep_u: KeepU = "all", callback: Callback | None = None, progress: bool = False,
        uniqueness: bool = False, mu: ArrayLike | None = None, max_iterations: int | None = None, tolerance: float | None = None,
        checkpoint: str | os.PathLike[str] | None = None, checkpoint_every: float | None = None, _tells: bool = True,
    ) -> Result:
        """Solves the history as the scene says; where it has ``mesh.refine``, on the mesh that `refined` finds, which is then
        ``result.model``.

        Parameters
        ----------
        linear : {"auto", "faer", "partial", "condensed", "umfpack"} or LinearSolver, optional
            "auto": what suits the sizes. "umfpack" where it is built in, see `stickslip.UMFPACK`. None: what the scene says.
        keep_u : {"all", "last", "none"} or sequence of int, optional
            Of which increments displacements are kept. One run has room for all; `stickslip.sweep` keeps the last.
        callback : callable, optional
            Called with (increment, time, status, iterations, error) once an increment is judged. Whatever it raises ends the run and
            comes out.
        progress : bool, optional
            A bar by tqdm.
        uniqueness : bool, optional
            Whether ``report["critical_friction"]`` is wanted.
        mu : float or (n_c,), optional
            Friction coefficients of the contact nodes in place of the scene's, such as a random field; not with a checkpoint. The model
            keeps those of the scene, and the result has these.
        max_iterations, tolerance : int, float, optional
            In place of the scene's.
        checkpoint : str or os.PathLike, optional
            A file in which the run is saved as it goes. A run with the file of an earlier one, which Ctrl-C, an exception or a power
            cut has ended, goes on from there; its result has all increments. The first Ctrl-C, or an exception of
            the callback, ends the run after its increment and saves it; a second one ends it at once. The callback is not called again
            for increments that are done. The file is removed when the history has converged.
        checkpoint_every : float, optional
            The seconds between; without it checkpoints take 2 % of the time.

        Returns
        -------
        Result

        Raises
        ------
        ValueError
            An option that cannot be; it names the option.
        KeyboardInterrupt
            After Ctrl-C, within an iteration.

        Warns
        -----
        NotConvergedWarning
            A law is violated by more than the tolerance.
        AccuracyWarning
            Each of ``result.warnings`` that may make the answer wrong.

        Examples
        --------
        >>> import stickslip as ss
        >>> model = ss.Model(ss.Scene.example("block"), {"mesh.elements": [20, 10]})
        >>> result = model.run(keep_u="last")
        >>> result.converged, result.kept
        (True, (19,))
        """
        most = None if max_iterations is None else whole("max_iterations", max_iterations)
        tolerance = None if tolerance is None else share("tolerance", tolerance, "a number between 0 and 1")
        called(callback)
        if checkpoint is not None and (not isinstance(checkpoint, (str, os.PathLike)) or not os.path.basename(checkpoint)):
            raise TypeError(f"checkpoint: the path of a file expected, {checkpoint!r} found")
        if checkpoint_every is not None and not (isinstance(checkpoint_every, Real) and 0 <= checkpoint_every < 1e9):
            raise ValueError(f"checkpoint_every: {checkpoint_every!r} found, expected seconds, 0 or more")
        # A callback may change the folder.
        checkpoint = None if checkpoint is None else os.path.abspath(checkpoint)
        if checkpoint is None and checkpoint_every is not None:
            raise ValueError("checkpoint_every: it is the time between checkpoints; name their file by checkpoint")
        algebra = linear_of(linear)
        bar: Any = None
        told: Callback | None = callback
        if progress:
            from tqdm.auto import tqdm

            bar = tqdm(total=len(self.t), unit="increment")

            def counted(index: int, time: float, status: str, iterations: int, error: float) -> None:
                # A run that goes on begins with the increments that are there.
                bar.update(index - bar.n)
                bar.set_postfix(error=f"{error:.1e}")
                if callback is not None:
                    callback(index, time, status, iterations, error)

            told = counted

        self = self._as_said()
        if mu is not None and checkpoint is not None:
            raise ValueError("mu: a checkpoint is of the scene's own friction; leave out one of the two")
        options = {
            "uniqueness": bool(uniqueness), "max_iterations": most, "tolerance": tolerance,
            "mu": None if mu is None else vector("mu", mu, self.problem.n_c),
            "checkpoint": None if checkpoint is None else (checkpoint, checkpoint_every),
        }
        try:
            kept = keep(keep_u, len(self.t))
            raw = self._core.run(algebra, kept, told, options)
        except KeyboardInterrupt as error:
            if checkpoint is not None and os.path.exists(checkpoint) and hasattr(error, "add_note"):
                error.add_note(f"The run is saved in {os.fspath(checkpoint)}: run it again with this checkpoint, and it goes on.")
            raise
        finally:
            if bar is not None:
                bar.close()
        result = Result._of(raw, self.problem, self, linear=algebra)
        if _tells:
            result._told()
        if raw["unsaved"]:
            warn(f"checkpoint: {raw['unsaved']}; the run went on without", RuntimeWarning)
        if checkpoint is not None and result.converged:
            with contextlib.suppress(FileNotFoundError):
                os.remove(checkpoint)
        return result


def _blocks(cells: list[tuple[str, list[int], int]]) -> list[tuple[str, Array]]:
    """Neighbours of one kind together."""
    blocks: list[tuple[str, list[list[int]]]] = []
    for kind, nodes, _ in cells:
        if not blocks or blocks[-1][0] != kind:
            blocks.append((kind, []))
        blocks[-1][1].append(nodes)
    return [(kind, read_only(np.array(nodes, dtype=np.int64))) for kind, nodes in blocks]


def _restore(
    name: str, text: str, overrides: dict[str, str], given: _mesh.Given | None, files: dict[str, bytes], has_text: bool = True
) -> Model:
    model = Model.__new__(Model)
    model._has_text = has_text
    model._make(name, text, overrides, given, files)
    return model


def run(
    scene: SceneLike, overrides: Mapping[str, Any] | None = None, *, mesh: Any = None, linear: Linear = "auto", keep_u: KeepU = "all",
    callback: Callback | None = None, progress: bool = False, uniqueness: bool = False, mu: ArrayLike | None = None,
    max_iterations: int | None = None, tolerance: float | None = None, checkpoint: str | os.PathLike[str] | None = None,
    checkpoint_every: float | None = None,
) -> Result:
    """Discretises a scene and solves it: `Model` and `Model.run` in one.

    Parameters
    ----------
    scene, overrides, mesh
        See `Model`.
    linear, keep_u, callback, progress, uniqueness, mu, max_iterations, tolerance, checkpoint, checkpoint_every
        See `Model.run`.

    Returns
    -------
    Result

    Raises
    ------
    SceneError
        A scene that is not sound; it names the key.
    ValueError
        An option that cannot be; it names the option.

    Examples
    --------
    >>> import stickslip as ss
    >>> result = ss.run(ss.Scene.example("block"), {"mesh.elements": [20, 10], "contact.friction": 0.6}).check()
    >>> print(f"{result.p_n[-1].sum():.0f} N per m of depth")
    10000 N per m of depth
    """
    return Model(scene, overrides, mesh=mesh).run(
        linear=linear, keep_u=keep_u, callback=callback, progress=progress, uniqueness=uniqueness, mu=mu,
        max_iterations=max_iterations, tolerance=tolerance, checkpoint=checkpoint, checkpoint_every=checkpoint_every,
    )


def load(path: str | os.PathLike[str]) -> Result:
    """Reads a file of `Result.save`; the model is made again of the scene, its mesh and its files as they were then.

    Parameters
    ----------
    path : str or os.PathLike
        The npz file.

    Returns
    -------
    Result

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it was not written by `Result.save`.
    """
    path = path_of(path)
    refused = f"path: {path} was not written by Result.save"
    with open(path, "rb") as opened:
        try:
            with np.load(opened, allow_pickle=False) as file:
                words = json.loads(str(file["words"]))
                arrays = {name: file[name] for name in file.files if name != "words"}
        except MemoryError:
            raise
        except Exception as error:
            # A damaged file is found by numpy, zipfile or a decompressor, each with exceptions of its own.
            raise ValueError(f"{refused}, or is damaged: {error}") from None
    if not isinstance(words, dict) or "model" not in words or "iterations" not in arrays:
        raise ValueError(refused)
    arrays["iterations"] = arrays["iterations"].view(np.recarray)
    of_model = {name: arrays.pop(name) for name in list(arrays) if name.startswith("model.")}
    model = Model._loaded(words["model"], of_model) if words["model"] else None
    return Result(
        status=words["status"], reason=words["reason"], records=words["records"], report=words["report"],
        kept=tuple(words["kept"]), model=model, **arrays,
    )
