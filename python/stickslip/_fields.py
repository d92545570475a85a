"""Quantities that follow from the arrays of a result by its model: stresses, slip, reactions, fields of the body, pictures and files."""

from __future__ import annotations

import json
import operator
import os
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from ._files import replaced
from ._kinds import VTK
from ._options import path_of
from ._words import counted

Array = NDArray[Any]


class _Body(Protocol):
    """The parts of a `Model` that its results need."""

    _core: Any
    dimension: int
    problem: Any
    points: Array
    cells: list[tuple[str, Array]]
    contact_nodes: Array
    contact_points: Array
    boundaries: dict[str, Array]

    def displacement(self, u: Any, t: float) -> Array: ...
    def stress(self, u: Any, t: float) -> Array: ...


class Svg(str):
    """A picture as the text of an SVG file; notebooks show it.

    Examples
    --------
    >>> import stickslip as ss
    >>> result = ss.run(ss.Scene.example("block"), {"mesh.elements": [20, 10]})
    >>> result.svg("deformed").startswith("<svg")
    True
    """

    def _repr_svg_(self) -> str:
        return str(self)

    def __repr__(self) -> str:
        return f"<Svg of {counted(len(self), 'character')}>"

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the picture to a file.

        Parameters
        ----------
        path : str or os.PathLike
            The file, replaced if it exists.
        """
        with replaced(path_of(path)) as file:
            file.write(self.encode())


@dataclass(frozen=True, eq=False, repr=False)
class Fields:
    """The arrays of a `Result`, and what needs its model."""

    status: str
    reason: str
    t: Array
    p_n: Array
    p_t: Array
    contact: Array
    gap: Array
    mu: Array
    w_t_last: Array
    errors: Array
    kept: tuple[int, ...]
    u: Array
    u_rest: Array
    force: Array
    records: list[dict[str, Any]]
    iterations: Array
    report: dict[str, Any]
    model: _Body | None

    #: Of a problem of matrices: the problem, and the motion of the obstacle past each node, m, (m, n_c, d).
    _posed: ClassVar[Any] = None
    #: Of a later step: the time of its beginning, s, with the slip, m, and the normal forces, N, there.
    _begun: ClassVar[Any] = None

    def _model(self) -> _Body:
        if self.model is None:
            raise ValueError("model: this result is of a problem of matrices, which has no mesh")
        return self.model

    def _number(self, k: int) -> int:
        """The row of increment k."""
        try:
            if isinstance(k, (bool, np.bool_)):
                raise TypeError
            return range(len(self.t))[operator.index(k)]
        except IndexError:
            raise IndexError(f"k: increment {k} of {len(self.t)}, counted from 0; -1 is the last") from None
        except TypeError:
            raise TypeError(f"k: a whole number expected, {type(k).__name__} found") from None

    def _row(self, k: int) -> int:
        """The row of `u` that belongs to increment k."""
        number = self._number(k)
        if number not in self.kept:
            raise ValueError(f"k: the displacements of increment {number} were not kept, see keep_u")
        return self.kept.index(number)

    def _step(self, k: int, with_u: bool = True) -> dict[str, Any]:
        """Increment k as the core takes it."""
        number, n_c = self._number(k), self.p_n.shape[1]
        of_body = np.zeros((3, self._model().problem.n_u))
        if with_u:
            row = self._row(k)
            of_body = np.stack([self.u[row], self.u_rest[row], self.force[row]])
        names, nothing = ("p_n", "gap", "mu"), np.zeros(n_c)
        two = self.p_t.shape[2] == 2
        step: dict[str, Any] = {name: np.ascontiguousarray(getattr(self, name)[number]) for name in names}
        step |= dict(zip(("u", "u_rest", "force"), of_body))
        for name, first, second in (("p_t", "p_t", "p_o"), ("w_t_last", "w_t_last", "w_o_last")):
            rows = getattr(self, name)[number]
            step[first] = np.ascontiguousarray(rows[:, 0])
            step[second] = np.ascontiguousarray(rows[:, 1]) if two else nothing
        step["contact"] = np.ascontiguousarray(self.contact[number])
        return step | {"record": json.dumps(self.records[number])}

    def _contact(self, k: int) -> dict[str, Array]:
        """Stresses of increment k, and its slip and opening if displacements were kept."""
        known, d = self._number(k) in self.kept, self.p_t.shape[2]
        values = self._model()._core.contact_values(self._step(k, known))
        found = {name: values[name] for name in ("pressure", "opening")[: 1 + known]}
        for name in ("traction", "slip")[: 1 + known]:
            found[name] = np.stack([values[f"{name}_t"], values[f"{name}_o"]][:d], axis=-1)
        return found

    def _at_nodes(self, name: str) -> Array:
        return self._of_nodes[name] if self.model is not None else self._of_matrices(name)

    def _of_matrices(self, name: str) -> Array:
        if self._posed is None:
            raise ValueError(f"{name}: this result was read from a file, which has no problem of matrices")
        problem, drift = self._posed
        if name in ("pressure", "traction"):
            if problem.weight is None:
                raise ValueError(f"{name}: give the problem the lengths or areas of its contact nodes: problem.with_(weight=...)")
            stress: Array = self.p_n / problem.weight if name == "pressure" else self.p_t / problem.weight[:, None]
            return stress
        found = np.full((self.p_n if name == "opening" else self.p_t).shape, np.nan)
        for k, u in zip(self.kept, self.u + self.u_rest):
            found[k] = self.gap[k] - problem.C_n @ u if name == "opening" else problem.slip(u) - drift[k]
        return found

    @cached_property
    def _of_nodes(self) -> dict[str, Array]:
        shape = self.p_n.shape
        found = {name: np.full(shape, np.nan) for name in ("pressure", "opening")}
        found |= {name: np.full((*shape, self.p_t.shape[2]), np.nan) for name in ("traction", "slip")}
        for k in range(len(self.t)):
            for name, values in self._contact(k).items():
                found[name][k] = values
        return found

    @property
    def pressure(self) -> Array:
        """Normal contact stresses, Pa, (m, n_c), positive in compression.

        On boundaries of second order they are recovered from the forces, as in the program's tables. A problem of matrices needs
        `weight` for stresses.

        Examples
        --------
        >>> import stickslip as ss
        >>> result = ss.run(ss.Scene.example("block"), {"mesh.elements": [20, 10]})
        >>> result.pressure.shape
        (20, 21)
        >>> print(f"{result.pressure[9].mean() / 1e3:.0f} kPa")
        53 kPa
        """
        return self._at_nodes("pressure")

    @property
    def traction(self) -> Array:
        """Tangential contact stresses of the body on the obstacle, Pa, (m, n_c, d), along the columns of the program's tables."""
        return self._at_nodes("traction")

    @property
    def slip(self) -> Array:
        """Motion of each contact node along its obstacle since the beginning, m, (m, n_c, d); NaN where displacements were not kept."""
        return self._at_nodes("slip")

    @property
    def opening(self) -> Array:
        """Distance that is left between each contact node and its obstacle, m, (m, n_c); NaN where displacements were not kept.

        ``gap`` is the prescribed distance, of the undeformed body.
        """
        return self._at_nodes("opening")

    @property
    def reactions(self) -> dict[str, Array]:
        """Force of each support on the body, N, (m, 2 or 3), by the name of its boundary; NaN in an increment that failed.

        Supports at one place add up.

        Examples
        --------
        >>> import stickslip as ss
        >>> cube = ss.run(ss.Scene.example("cube"), {"mesh.elements": [4, 4, 4]})
        >>> {name: force.shape for name, force in cube.reactions.items()}
        {'top': (10, 3)}
        """
        model = self._model()
        components = model._core.components
        size = self.report.get("units", {}).get("force", {}).get("si", 1.0) / model._core.thickness
        forces: dict[str, Array] = {}
        for record in self.report.get("reactions", []):
            seen: set[str] = set()
            for support in record["supports"]:
                rows = forces.setdefault(support["at"], np.full((len(self.t), components), np.nan))
                row, first = record["index"] - 1, support["at"] not in seen
                seen.add(support["at"])
                rows[row] = size * np.array(support["force"]) + (0.0 if first else rows[row])
        return forces

    def displacement(self, k: int = -1) -> Array:
        """Displacements of all nodes at the end of increment k, m, (nodes, 3).

        Parameters
        ----------
        k : int, optional
            The increment from 0; -1 is the last.

        Returns
        -------
        ndarray, shape (nodes, 3)
            m.
        """
        return self._model().displacement(self.u[self._row(k)], float(self.t[k]))

    def stress(self, k: int = -1) -> Array:
        """Stresses in the middle of each cell at the end of increment k, Pa, (cells, 6).

        Parameters
        ----------
        k : int, optional
            The increment from 0; -1 is the last.

        Returns
        -------
        ndarray, shape (cells, 6)
            Pa: xx, yy, zz, xy, yz, zx.
        """
        return self._model().stress(self.u[self._row(k)], float(self.t[k]))

    def fields(self, k: int = -1) -> tuple[dict[str, Array], dict[str, Array]]:
        """The fields of the program's VTU files at the end of increment k.

        Parameters
        ----------
        k : int, optional
            The increment from 0; -1 is the last.

        Returns
        -------
        points, cells : dict of str to ndarray
            By name, with a row for each node (cell), SI: numbers, vectors (.., 3), tensors row by row (.., 9). Of points, for
            instance ``contact_pressure``, ``slip``, ``nodal_von_mises``; of cells ``stress``, ``von_mises``. NaN off the contact.

        Examples
        --------
        >>> import stickslip as ss
        >>> result = ss.run(ss.Scene.example("block"), {"mesh.elements": [20, 10]})
        >>> points, cells = result.fields()
        >>> points["displacement"].shape, cells["stress"].shape
        ((231, 3), (200, 9))
        """
        points, cells = self._model()._core.fields(self._step(k))
        return points, cells

    def svg(
        self, kind: Literal["contact", "deformed"] = "contact", k: int = -1, *, boundary: str | None = None,
        magnification: float | None = None,
    ) -> Svg:
        """A picture as the program draws it.

        Parameters
        ----------
        kind : {"contact", "deformed"}, optional
            Contact stresses, in the plane along the boundary and in space as a map; or the deformed body.
        k : int, optional
            The increment from 0; -1 is the last.
        boundary : str, optional
            Which boundary with contact, if there are several.
        magnification : float, optional
            Of the displacements; one that shows them well without it. Only with "deformed".

        Returns
        -------
        Svg
        """
        if kind not in ("contact", "deformed"):
            raise ValueError(f"kind: {kind!r} found, expected 'contact' or 'deformed'")
        if magnification is not None and not (kind == "deformed" and 0 <= magnification < np.inf):
            raise ValueError(f"magnification: {magnification} with the kind {kind!r}, expected a number of 0 or more with 'deformed'")
        if boundary is not None and (kind == "deformed" or boundary not in self._model().boundaries):
            raise ValueError(f"boundary: {boundary!r} found, expected one with contact: {', '.join(self._model().boundaries)}")
        pictures = self._model()._core.pictures(self._step(k), kind == "deformed", magnification)
        for name, picture in pictures:
            if boundary is None and len(pictures) == 1 or name in (None, boundary):
                return Svg(picture)
        found = ", ".join(str(name) for name, _ in pictures)
        raise ValueError(f"boundary: choose one of {found}" if found else "kind: the scene has no line or surface of contact to draw")

    def write_vtu(self, path: str | os.PathLike[str], k: int = -1) -> None:
        """Writes the body with its fields at the end of increment k for ParaView, in the units of the scene.

        Parameters
        ----------
        path : str or os.PathLike
            The file, replaced if it exists.
        k : int, optional
            The increment from 0; -1 is the last.
        """
        path = path_of(path)
        text = self._model()._core.vtu(self._step(k))
        with replaced(path) as file:
            file.write(text.encode())

    def write_fclib(self, path: str | os.PathLike[str], k: int = -1, *, form: Literal["global", "local"] = "global") -> None:
        """Writes increment k as a problem with its solution to an FCLIB file, for other solvers; the state before it is a guess.

        Parameters
        ----------
        path : str or os.PathLike
            The file, replaced if it exists.
        k : int, optional
            The increment from 0; -1 is the last. Displacements of it and of the one before it must have been kept.
        form : {"global", "local"}, optional
            Unknowns: displacements too, or the contact forces alone.
        """
        path = path_of(path)
        if form not in ("global", "local"):
            raise ValueError(f"form: {form!r} found, expected 'global' or 'local'")
        number = self._number(k)
        before = self._step(number - 1) if number else None
        solved = self.records[number]["status"] == "converged"
        content = self._model()._core.fclib(self._step(number), before, form == "local", solved)
        with replaced(path) as file:
            file.write(content)

    def to_meshio(self, k: int = -1) -> Any:
        """A `meshio.Mesh` of the body at the end of increment k, SI.

        Parameters
        ----------
        k : int, optional
            The increment from 0; -1 is the last.

        Returns
        -------
        meshio.Mesh
            With the `fields` of points and cells, beside them ``p_n``, N, at the contact nodes. ``stress`` has six components.
        """
        import meshio

        model = self._model()
        points, of_cells = self._for_others(k)
        ends = np.cumsum([len(nodes) for _, nodes in model.cells])[:-1]
        cells: list[Any] = [(kind, nodes.copy()) for kind, nodes in model.cells]
        try:
            return meshio.Mesh(model.points.copy(), cells, point_data=points, cell_data={name: np.split(v, ends) for name, v in of_cells.items()})
        except KeyError as error:
            raise ValueError(f"cells: this meshio cannot hold the kind {error}; write_vtu and to_pyvista can") from None

    def _for_others(self, k: int) -> tuple[dict[str, Array], dict[str, Array]]:
        """Fields of points and cells as `to_meshio` describes them."""
        model = self._model()
        points, of_cells = self.fields(k)
        points["p_n"] = np.full(len(model.points), np.nan)
        points["p_n"][model.contact_nodes] = self.p_n[k]
        points.setdefault("contact", np.full(len(model.points), -1))
        of_cells["stress"] = self.stress(k)
        return points, of_cells

    def to_pyvista(self, k: int = -1) -> Any:
        """A `pyvista.UnstructuredGrid` with the fields of `to_meshio`.

        Parameters
        ----------
        k : int, optional
            The increment from 0; -1 is the last.

        Returns
        -------
        pyvista.UnstructuredGrid
        """
        import pyvista

        model = self._model()
        points, of_cells = self._for_others(k)
        codes = {name: code for code, name in VTK.items()}
        cells = np.concatenate([np.insert(nodes, 0, nodes.shape[1], axis=1).ravel() for _, nodes in model.cells])
        kinds = np.concatenate([np.full(len(nodes), codes[kind], dtype=np.uint8) for kind, nodes in model.cells])
        grid = pyvista.UnstructuredGrid(cells, kinds, model.points.copy())
        for data, values in ((grid.point_data, points), (grid.cell_data, of_cells)):
            for name, of in values.items():
                data[name] = of
        return grid
