"""Meshes from meshio, gmsh, pyvista or arrays, as `Model(scene, mesh=...)` takes them.

Boundaries and material groups are physical groups (gmsh, and meshio's `field_data`), cell sets of meshio, or chosen by
`boundaries`: a function of points (n, 3) that says which are on the boundary, or the facets themselves.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypedDict, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._kinds import (
    DIMENSION, FACETS, GMSH, GMSH_ORDER, NODES, VTK, VTK_LINES, coordinate_plane, outer_facets as outer_facets, right_way_round,
    SIDES as SIDES,
)
from ._words import counted

Array = NDArray[Any]

#: Which outer facets a boundary has: by their corners' points, or by their nodes.
Where = Union[Callable[[Array], Array], Sequence[Sequence[int]]]


class Given(TypedDict):
    """A mesh of arrays.

    Attributes
    ----------
    points : ndarray, shape (n, 3)
        m.
    cells : list of (str, ndarray, ndarray)
        Kind, nodes (k, nodes of the kind), group of each (k,).
    groups : list of str
        Names of the materials; cells of no group are of the group with the empty name, which has the material of the scene itself.
    boundaries : list of (str, list)
        Name, and facets by their nodes.
    """

    points: Array
    cells: list[tuple[str, Array, Array]]
    groups: list[str]
    boundaries: list[tuple[str, list[list[int]]]]


def _refuse(unknown: Mapping[str, int]) -> None:
    """Cells of kinds that are not known are refused, since the body would be solved without them."""
    if unknown:
        found = ", ".join(f"{count} of the kind {kind}" for kind, count in unknown.items())
        raise ValueError(f"cells: {found}, expected the kinds {', '.join(SIDES)}: mesh the body with these, or remove the others from the mesh")


def _integers(name: str, values: ArrayLike) -> Array:
    try:
        array = np.asarray(values)
        whole = array.astype(np.int64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name}: whole numbers expected, {error}") from None
    if array.size and (array.dtype == bool or (whole != array).any()):
        raise ValueError(f"{name}: whole numbers expected, {array.dtype} found")
    return whole


def _members(name: str, chosen: ArrayLike, count: int) -> Array:
    """The numbers of the cells of a group in one block of `count` cells, given as numbers or as a mask."""
    mask = np.asarray(chosen)
    if mask.dtype == bool:
        if mask.shape != (count,):
            raise ValueError(f"{name}: a mask of the shape {mask.shape}, expected {(count,)}")
        return np.flatnonzero(mask)
    numbers = _integers(name, chosen).ravel()
    if numbers.size and (numbers.min() < 0 or numbers.max() >= count):
        raise ValueError(f"{name}: cell {numbers.min() if numbers.min() < 0 else numbers.max()} is not among those of its block, 0 to {count - 1}")
    return numbers


def _tagged(blocks: list[tuple[str, Array]], groups: Mapping[str, Sequence[ArrayLike]]) -> tuple[list[tuple[str, Array, Array]], list[str]]:
    """The blocks with the group of each cell, and the names of the groups; cells of no group are of one without a name."""
    if not groups:
        return [(kind, nodes, np.zeros(len(nodes), dtype=np.int64)) for kind, nodes in blocks], []
    names = list(groups)
    tagged = [(kind, nodes, np.full(len(nodes), -1, dtype=np.int64)) for kind, nodes in blocks]
    for number, name in enumerate(names):
        by_block = list(groups[name])
        if len(by_block) != len(blocks):
            raise ValueError(f"groups[{name!r}] has the cells of {counted(len(by_block), 'block')}, expected {len(blocks)}: one entry for each block of cells")
        for k, ((_, nodes, of_cell), chosen) in enumerate(zip(tagged, by_block)):
            members = _members(f"groups[{name!r}][{k}]", chosen, len(nodes))
            twice = members[of_cell[members] >= 0]
            if len(twice):
                other = names[of_cell[twice[0]]]
                raise ValueError(
                    f"groups: {other!r} and {name!r} have {counted(len(twice), 'cell')} in common; keep one group, the material, for each cell, "
                    "and remove the other from the mesh"
                )
            of_cell[members] = number
    if any((of_cell < 0).any() for _, _, of_cell in tagged):
        if "" not in names:
            names.append("")
        for _, _, of_cell in tagged:
            of_cell[of_cell < 0] = names.index("")
    return tagged, names


def from_arrays(
    points: ArrayLike, cells: Iterable[tuple[str, ArrayLike]], boundaries: Mapping[str, Where], *, scale: float = 1.0,
    groups: Mapping[str, Sequence[ArrayLike]] | None = None,
) -> Given:
    """A mesh of points and cells.

    Parameters
    ----------
    points : array_like, shape (n, 2) or (n, 3)
        In units of `scale`. A plane body may lie in any of the three coordinate planes.
    cells : iterable of (str, array_like)
        Kind of those in `SIDES` and nodes (k, nodes of the kind), in the order of VTK. Cells that are turned over are renumbered.
    boundaries : Mapping of str to callable or list
        By name, a function of the points that says which are on the boundary, (n, 3) to (n,), or the facets by their nodes.
    scale : float, optional
        The length of the unit of `points`, m.
    groups : Mapping of str to list, optional
        By name, for each block of cells the numbers of those in the material group, or a mask. Cells of no group have the material
        of the scene itself, as have groups that the scene does not name.

    Returns
    -------
    Given
        What `Model` and `run` take as `mesh`.

    Raises
    ------
    ValueError
        It names the argument.

    Examples
    --------
    >>> import stickslip as ss
    >>> points = [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]]
    >>> given = ss.mesh.from_arrays(points, [("quad", [[0, 1, 4, 3], [1, 2, 5, 4]])], {"bottom": lambda x: x[:, 1] == 0})
    >>> given["boundaries"]
    [('bottom', [[0, 1], [1, 2]])]
    """
    try:
        xyz = np.asarray(points, dtype=float)
    except (TypeError, ValueError) as error:
        raise ValueError(f"points: {error}") from None
    if xyz.ndim != 2 or xyz.shape[1] not in (2, 3):
        raise ValueError(f"points has the shape {xyz.shape}, expected (n, 2) or (n, 3)")
    xyz = np.column_stack([xyz, np.zeros((len(xyz), 3 - xyz.shape[1]))]) * scale
    if not 0 < scale < np.inf:
        raise ValueError(f"scale: {scale} found, expected the length of the unit of the points in m, above 0")
    if not isinstance(boundaries, Mapping):
        raise TypeError(f"boundaries: a dictionary expected, {type(boundaries).__name__} found")
    try:
        pairs = [(kind, nodes) for kind, nodes in cells]
    except (TypeError, ValueError):
        raise TypeError("cells: a list of pairs expected, such as [('quad', nodes)]") from None
    blocks = [(kind, _integers(f"cells: {kind}", nodes)) for kind, nodes in pairs]
    _refuse({kind: len(nodes) for kind, nodes in blocks if kind not in SIDES})
    for kind, nodes in blocks:
        if nodes.size and (nodes.ndim != 2 or nodes.shape[1] != NODES[kind]):
            raise ValueError(f"cells: {kind} has nodes of the shape {nodes.shape}, expected (k, {NODES[kind]})")
        if nodes.size and (nodes.min() < 0 or nodes.max() >= len(xyz)):
            raise ValueError(f"cells: {kind} has nodes that are not among the points, 0 to {len(xyz) - 1}")
    blocks = [(kind, nodes.reshape(-1, NODES[kind])) for kind, nodes in blocks]
    if not blocks or not any(len(nodes) for _, nodes in blocks):
        raise ValueError("cells: there is none")
    dimension = max(DIMENSION[kind] for kind, _ in blocks)
    if any(DIMENSION[kind] != dimension for kind, _ in blocks):
        raise ValueError("cells: some are of the plane, others of space; leave the facets out")
    axes = coordinate_plane(xyz, blocks) if dimension == 2 else (0, 1)
    if dimension == 2 and axes == (0, 1):
        xyz[:, 2] = 0.0
    tagged, names = _tagged(blocks, groups or {})
    outer: list[list[int]] | None = None
    chosen_facets = []
    for name, where in boundaries.items():
        if callable(where):
            outer = outer_facets(blocks) if outer is None else outer
            on = np.asarray(where(xyz), dtype=bool)
            if on.shape != (len(xyz),):
                raise ValueError(f"boundaries[{name!r}] gives the shape {on.shape}, expected {(len(xyz),)}")
            facets = [facet for facet in outer if on[facet].all()]
        else:
            try:
                facets = [[int(node) for node in facet] for facet in where]
            except (TypeError, ValueError):
                raise TypeError(f"boundaries[{name!r}]: a function of points or a list of facets expected, {type(where).__name__} found") from None
        if not facets:
            raise ValueError(f"boundaries[{name!r}] has no facet")
        chosen_facets.append((name, facets))
    if dimension == 2:
        xyz = np.column_stack([xyz[:, axes], np.zeros(len(xyz))])
    tagged = [(kind, right_way_round(xyz, kind, nodes), group) for kind, nodes, group in tagged]
    return _used({"points": xyz, "cells": tagged, "groups": names, "boundaries": chosen_facets})


def _used(mesh: Given) -> Given:
    """The same without points that no cell has, such as those of geometry."""
    used = np.unique(np.concatenate([nodes.ravel() for _, nodes, _ in mesh["cells"]]))
    number = np.full(len(mesh["points"]), -1, dtype=np.int64)
    number[used] = np.arange(len(used))
    for name, all_ in mesh["boundaries"]:
        alien = next((n for facet in all_ for n in facet if not 0 <= n < len(number) or number[n] < 0), None)
        if alien is not None:
            raise ValueError(f"boundaries[{name!r}] has the node {alien}, which no cell has")
    facets = [(name, [[int(number[n]) for n in facet] for facet in all_]) for name, all_ in mesh["boundaries"]]
    return {
        "points": np.ascontiguousarray(mesh["points"][used]),
        "cells": [(kind, np.ascontiguousarray(number[nodes]), group) for kind, nodes, group in mesh["cells"]],
        "groups": mesh["groups"], "boundaries": facets,
    }


def from_meshio(mesh: Any, boundaries: Mapping[str, Where] | None = None, *, scale: float = 1.0) -> Given:
    """A mesh of meshio: physical groups, cell sets, and `boundaries` beside them.

    Parameters
    ----------
    mesh : meshio.Mesh
        ``Model(scene, mesh=mesh)`` calls this by itself.
    boundaries, scale : optional
        See `from_arrays`.

    Returns
    -------
    Given
    """
    filled = [(k, block) for k, block in enumerate(mesh.cells) if len(block.data)]
    dimension = max((block.dim for _, block in filled), default=0)
    body = [k for k, block in filled if block.dim == dimension]
    skin = [k for k, block in filled if block.dim == dimension - 1]
    unknown: Counter[str] = Counter()
    for kinds, blocks in ((SIDES, body), (FACETS.get(dimension, ()), skin)):
        for k in blocks:
            if mesh.cells[k].type not in kinds:
                unknown[mesh.cells[k].type] += len(mesh.cells[k].data)
    _refuse(unknown)
    tags = mesh.cell_data.get("gmsh:physical")
    groups: dict[str, list[Any]] = {}
    named: dict[str, Where] = {}

    def take(name: str, members: Callable[[int], Any]) -> None:
        facets = [facet for k in skin for facet in mesh.cells[k].data[members(k)].tolist()]
        inside = [np.asarray(members(k), dtype=np.int64) for k in body]
        if facets:
            named[name] = facets
        elif any(len(cells) for cells in inside):
            groups[name] = inside

    if tags is not None:
        names = {(int(of), int(tag)): name for name, (tag, of) in mesh.field_data.items()}
        for of, blocks in ((dimension, body), (dimension - 1, skin)):
            # A group without a name is called by its number, as in a file of Gmsh.
            for tag in sorted({int(tag) for k in blocks for tag in tags[k]} - {0}):
                take(names.get((of, tag), str(tag)), lambda k: np.flatnonzero(tags[k] == tag) if k in blocks else np.zeros(0, dtype=np.int64))
    for name, by_block in getattr(mesh, "cell_sets", {}).items():
        if name not in named and name not in groups and not name.startswith("gmsh:"):
            take(name, lambda k: np.asarray([] if by_block[k] is None else by_block[k], dtype=np.int64))
    cells = [(mesh.cells[k].type, mesh.cells[k].data) for k in body]
    return from_arrays(mesh.points, cells, {**named, **(boundaries or {})}, scale=scale, groups=groups)


def from_gmsh(model: Any, boundaries: Mapping[str, Where] | None = None, *, scale: float = 1.0) -> Given:
    """A mesh of Gmsh in memory, as it is meshed now: physical groups are boundaries and materials.

    Parameters
    ----------
    model : gmsh or gmsh.model
        ``Model(scene, mesh=gmsh)`` calls this by itself.
    boundaries, scale : optional
        See `from_arrays`.

    Returns
    -------
    Given

    Notes
    -----
    Cells of no physical group have the material of the scene itself, if they share nodes with cells of one. Where there are groups of
    materials, a part of the mesh without any is refused: it may be left over from the construction, and a file of Gmsh would not have it.
    """
    model = getattr(model, "model", model)
    tags, coordinates, _ = model.mesh.getNodes()
    number = {int(tag): k for k, tag in enumerate(tags)}
    dimension = max(dim for dim, _ in model.getEntities())
    unknown: Counter[str] = Counter()

    def blocks(dim: int, entity: int) -> list[tuple[str, Array]]:
        found = []
        for kind, elements, nodes in zip(*model.mesh.getElements(dim, entity)):
            name, _, _, count = model.mesh.getElementProperties(kind)[:4]
            if kind not in GMSH:
                unknown[name] += len(elements)
                continue
            table = np.array([number[int(n)] for n in nodes], dtype=np.int64).reshape(-1, int(count))
            found.append((GMSH[kind], table[:, GMSH_ORDER.get(GMSH[kind], slice(None))]))
        return found

    cells: list[tuple[str, Array]] = []
    owner: list[int] = []
    for dim, entity in model.getEntities(dimension):
        new = blocks(dim, entity)
        cells += new
        owner += [entity] * len(new)
    materials: dict[str, set[int]] = {}
    named: dict[str, Where] = {}
    for dim, tag in model.getPhysicalGroups():
        name = model.getPhysicalName(dim, tag) or str(tag)
        entities = {int(entity) for entity in model.getEntitiesForPhysicalGroup(dim, tag)}
        if dim == dimension:
            materials[name] = entities
        elif dim == dimension - 1:
            named[name] = [facet for entity in sorted(entities) for _, nodes in blocks(dim, entity) for facet in nodes.tolist()]
    _refuse(unknown)
    groups = {
        name: [np.arange(len(nodes) if of in entities else 0) for (_, nodes), of in zip(cells, owner)]
        for name, entities in materials.items()
    }
    if groups:
        _refuse_loose([(nodes, any(of in entities for entities in materials.values())) for (_, nodes), of in zip(cells, owner)])
    points = np.asarray(coordinates, dtype=float).reshape(-1, 3)
    return from_arrays(points, cells, {**named, **(boundaries or {})}, scale=scale, groups=groups)


def _refuse_loose(blocks: list[tuple[Array, bool]]) -> None:
    """Parts of which no cell is in a group, where other parts are."""
    grouped = np.unique(np.concatenate([nodes.ravel() for nodes, known in blocks if known] or [np.zeros(0, dtype=np.int64)]))
    others = [nodes for nodes, known in blocks if not known]
    while others:
        near = [nodes for nodes in others if np.isin(nodes, grouped).any()]
        if not near:
            raise ValueError(
                f"groups: a part of {counted(sum(map(len, others)), 'cell')} without a physical group is apart from those with one. Put it into a "
                "physical group if it is of the body, or remove its entities if it is left over"
            )
        grouped = np.unique(np.concatenate([grouped, *[nodes.ravel() for nodes in near]]))
        others = [nodes for nodes in others if not np.isin(nodes, grouped).any()]


def from_pyvista(grid: Any, boundaries: Mapping[str, Where], *, scale: float = 1.0) -> Given:
    """A mesh of pyvista, which has no names for its boundaries.

    Parameters
    ----------
    grid : pyvista.UnstructuredGrid
        Points and lines of it are left out.
    boundaries, scale
        See `from_arrays`.

    Returns
    -------
    Given
    """
    if not hasattr(grid, "celltypes"):
        raise ValueError(f"mesh: a pyvista.UnstructuredGrid expected, {type(grid).__name__} found; its cast_to_unstructured_grid() makes one")
    kinds = Counter(np.asarray(grid.celltypes).tolist())
    _refuse({_vtk_name(kind): count for kind, count in kinds.items() if kind not in VTK and kind not in VTK_LINES})
    cells = [(VTK[int(kind)], nodes) for kind, nodes in grid.cells_dict.items() if int(kind) in VTK]
    dimension = max((DIMENSION[kind] for kind, _ in cells), default=0)
    return from_arrays(grid.points, [c for c in cells if DIMENSION[c[0]] == dimension], boundaries, scale=scale)


def _vtk_name(kind: int) -> str:
    from pyvista import CellType

    return str(CellType(kind).name)


def given(mesh: Any) -> Given:
    """A mesh of arrays from any object that `Model` and `run` take as `mesh`.

    Parameters
    ----------
    mesh : object
        Of meshio or gmsh, or what this module makes.

    Returns
    -------
    Given
    """
    if isinstance(mesh, dict):
        missing = [name for name in Given.__annotations__ if name not in mesh]
        if missing:
            raise ValueError(f"mesh: a dictionary without {', '.join(missing)}; stickslip.mesh.from_arrays makes a whole one")
        return mesh  # type: ignore[return-value]
    if hasattr(mesh, "field_data") and isinstance(getattr(mesh, "cells", None), list):
        return from_meshio(mesh)
    if hasattr(getattr(mesh, "model", mesh), "getPhysicalGroups"):
        return from_gmsh(mesh)
    raise ValueError(f"mesh: {type(mesh).__name__} is none of meshio, gmsh; use stickslip.mesh.from_arrays or from_pyvista")
