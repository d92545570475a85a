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

Array = NDArray[Any]

#: Which outer facets a boundary has: by their corners' points, or by their nodes.
Where = Union[Callable[[Array], Array], Sequence[Sequence[int]]]

#: The sides of each kind of cell, corners first, then the nodes in the middle of their edges.
SIDES: dict[str, tuple[tuple[int, ...], ...]] = {
    "triangle": ((0, 1), (1, 2), (2, 0)),
    "quad": ((0, 1), (1, 2), (2, 3), (3, 0)),
    "tetra": ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)),
    "hexahedron": ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
    "wedge": ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    "triangle6": ((0, 1, 3), (1, 2, 4), (2, 0, 5)),
    "tetra10": ((0, 2, 1, 6, 5, 4), (0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 9, 8), (0, 3, 2, 7, 9, 6)),
    "quad8": ((0, 1, 4), (1, 2, 5), (2, 3, 6), (3, 0, 7)),
    "quad9": ((0, 1, 4), (1, 2, 5), (2, 3, 6), (3, 0, 7)),
    "hexahedron20": (
        (0, 3, 2, 1, 11, 10, 9, 8), (4, 5, 6, 7, 12, 13, 14, 15), (0, 1, 5, 4, 8, 17, 12, 16),
        (1, 2, 6, 5, 9, 18, 13, 17), (2, 3, 7, 6, 10, 19, 14, 18), (3, 0, 4, 7, 11, 16, 15, 19),
    ),
    "wedge15": (
        (0, 2, 1, 8, 7, 6), (3, 4, 5, 9, 10, 11), (0, 1, 4, 3, 6, 13, 9, 12), (1, 2, 5, 4, 7, 14, 10, 13), (2, 0, 3, 5, 8, 12, 11, 14),
    ),
}

_DIMENSION = {name: 2 if name in ("triangle", "quad", "triangle6", "quad8", "quad9") else 3 for name in SIDES}
# The centre of a quadrilateral is on no side.
_NODES = {name: 1 + max(max(side) for side in sides) for name, sides in SIDES.items()} | {"quad9": 9}
_FACETS = {2: ("line", "line3"), 3: ("triangle", "quad", "triangle6", "quad8")}
_GMSH = {
    1: "line", 2: "triangle", 3: "quad", 4: "tetra", 5: "hexahedron", 6: "wedge", 8: "line3", 9: "triangle6", 10: "quad9", 11: "tetra10",
    16: "quad8", 17: "hexahedron20", 18: "wedge15",
}
#: The place of each node in the order of Gmsh, where it is another.
_GMSH_ORDER = {
    "tetra10": [0, 1, 2, 3, 4, 5, 6, 7, 9, 8],
    "hexahedron20": [0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15],
    "wedge15": [0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11],
}
_VTK = {
    5: "triangle", 9: "quad", 10: "tetra", 12: "hexahedron", 13: "wedge", 22: "triangle6", 23: "quad8", 24: "tetra10",
    25: "hexahedron20", 26: "wedge15", 28: "quad9",
}
#: Points and lines of VTK, which are no part of a body.
_VTK_LINES = {0, 1, 2, 3, 4, 21, 35, 68}


class Given(TypedDict):
    """A mesh of arrays.

    points: m, (n, 3). cells: (kind, nodes (k, nodes of the kind), group of each (k,)). groups: names of the materials; cells of no
    group are of the group with the empty name, which has the material of the scene itself. boundaries: (name, facets by their nodes).
    """

    points: Array
    cells: list[tuple[str, Array, Array]]
    groups: list[str]
    boundaries: list[tuple[str, list[list[int]]]]


def outer_facets(cells: Iterable[tuple[str, Array]]) -> list[list[int]]:
    """The facets that belong to one cell only."""
    seen: Counter[tuple[int, ...]] = Counter()
    facets: dict[tuple[int, ...], list[int]] = {}
    for kind, nodes in cells:
        for side in SIDES[kind]:
            for facet in np.asarray(nodes)[:, side].tolist():
                key = tuple(sorted(facet))
                seen[key] += 1
                facets[key] = facet
    return [facets[key] for key, count in seen.items() if count == 1]


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
        raise ValueError(f"{name}: cell {numbers.min() if numbers.min() < 0 else numbers.max()} is not among the {count} of its block")
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
            raise ValueError(f"groups[{name!r}] has the cells of {len(by_block)} blocks, expected {len(blocks)}: one entry for each block of cells")
        for k, ((_, nodes, of_cell), chosen) in enumerate(zip(tagged, by_block)):
            members = _members(f"groups[{name!r}][{k}]", chosen, len(nodes))
            twice = members[of_cell[members] >= 0]
            if len(twice):
                other = names[of_cell[twice[0]]]
                raise ValueError(
                    f"groups: {len(twice)} cells are in both {other!r} and {name!r}; keep one group, the material, for each cell, "
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

    Args:
        points: (n, 2) or (n, 3).
        cells: (kind, nodes (k, nodes of the kind)) of the kinds in `SIDES`, in the order of VTK.
        boundaries: by name; see the head of this module.
        scale: the length of the unit of `points`, m.
        groups: by name, for each block of cells the numbers of those in the material group, or a mask. Cells of no group have the
            material of the scene itself, as have groups that the scene does not name.
    """
    try:
        xyz = np.asarray(points, dtype=float)
    except (TypeError, ValueError) as error:
        raise ValueError(f"points: {error}") from None
    if xyz.ndim != 2 or xyz.shape[1] not in (2, 3):
        raise ValueError(f"points has the shape {xyz.shape}, expected (n, 2) or (n, 3)")
    xyz = np.column_stack([xyz, np.zeros((len(xyz), 3 - xyz.shape[1]))]) * scale
    blocks = [(kind, _integers(f"cells: {kind}", nodes)) for kind, nodes in cells]
    _refuse({kind: len(nodes) for kind, nodes in blocks if kind not in SIDES})
    for kind, nodes in blocks:
        if nodes.size and (nodes.ndim != 2 or nodes.shape[1] != _NODES[kind]):
            raise ValueError(f"cells: {kind} has nodes of the shape {nodes.shape}, expected (k, {_NODES[kind]})")
        if nodes.size and (nodes.min() < 0 or nodes.max() >= len(xyz)):
            raise ValueError(f"cells: {kind} has nodes that are not among the {len(xyz)} points")
    blocks = [(kind, nodes.reshape(-1, _NODES[kind])) for kind, nodes in blocks]
    if not blocks or not any(len(nodes) for _, nodes in blocks):
        raise ValueError("cells: there is none")
    dimension = max(_DIMENSION[kind] for kind, _ in blocks)
    if any(_DIMENSION[kind] != dimension for kind, _ in blocks):
        raise ValueError("cells: some are of the plane, others of space; leave the facets out")
    if dimension == 2 and np.ptp(xyz[:, 2]) == 0:
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
            facets = [[int(node) for node in facet] for facet in where]
        if not facets:
            raise ValueError(f"boundaries[{name!r}] has no facet")
        chosen_facets.append((name, facets))
    return _used({"points": xyz, "cells": tagged, "groups": names, "boundaries": chosen_facets})


def _used(mesh: Given) -> Given:
    """The same without points that no cell has, such as those of geometry."""
    used = np.unique(np.concatenate([nodes.ravel() for _, nodes, _ in mesh["cells"]]))
    number = np.full(len(mesh["points"]), -1, dtype=np.int64)
    number[used] = np.arange(len(used))
    facets = [(name, [[int(number[n]) for n in facet] for facet in all_]) for name, all_ in mesh["boundaries"]]
    for name, all_ in facets:
        if any(n < 0 for facet in all_ for n in facet):
            raise ValueError(f"boundaries[{name!r}] has a node that no cell has")
    return {
        "points": np.ascontiguousarray(mesh["points"][used]),
        "cells": [(kind, np.ascontiguousarray(number[nodes]), group) for kind, nodes, group in mesh["cells"]],
        "groups": mesh["groups"], "boundaries": facets,
    }


def from_meshio(mesh: Any, boundaries: Mapping[str, Where] | None = None, *, scale: float = 1.0) -> Given:
    """Of a `meshio.Mesh`: physical groups, cell sets, and `boundaries` beside them."""
    filled = [(k, block) for k, block in enumerate(mesh.cells) if len(block.data)]
    dimension = max((block.dim for _, block in filled), default=0)
    body = [k for k, block in filled if block.dim == dimension]
    skin = [k for k, block in filled if block.dim == dimension - 1]
    unknown: Counter[str] = Counter()
    for kinds, blocks in ((SIDES, body), (_FACETS.get(dimension, ()), skin)):
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
    """Of `gmsh.model` (or `gmsh`) as it is meshed now: physical groups are boundaries and materials.

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
            if kind not in _GMSH:
                unknown[name] += len(elements)
                continue
            table = np.array([number[int(n)] for n in nodes], dtype=np.int64).reshape(-1, int(count))
            found.append((_GMSH[kind], table[:, _GMSH_ORDER.get(_GMSH[kind], slice(None))]))
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
                f"groups: {sum(map(len, others))} cells of no physical group are apart from those of a group. Put them into a physical "
                "group if they are of the body, or remove their entities if they are left over"
            )
        grouped = np.unique(np.concatenate([grouped, *[nodes.ravel() for nodes in near]]))
        others = [nodes for nodes in others if not np.isin(nodes, grouped).any()]


def from_pyvista(grid: Any, boundaries: Mapping[str, Where], *, scale: float = 1.0) -> Given:
    """Of a `pyvista.UnstructuredGrid`, which has no names for its boundaries: choose them by `boundaries`."""
    if not hasattr(grid, "celltypes"):
        raise ValueError(f"mesh: a pyvista.UnstructuredGrid expected, {type(grid).__name__} found; its cast_to_unstructured_grid() makes one")
    kinds = Counter(np.asarray(grid.celltypes).tolist())
    _refuse({_vtk_name(kind): count for kind, count in kinds.items() if kind not in _VTK and kind not in _VTK_LINES})
    cells = [(_VTK[int(kind)], nodes) for kind, nodes in grid.cells_dict.items() if int(kind) in _VTK]
    dimension = max((_DIMENSION[kind] for kind, _ in cells), default=0)
    return from_arrays(grid.points, [c for c in cells if _DIMENSION[c[0]] == dimension], boundaries, scale=scale)


def _vtk_name(kind: int) -> str:
    from pyvista import CellType

    return str(CellType(kind).name)


def given(mesh: Any) -> Given:
    """Whatever `mesh=` takes."""
    if isinstance(mesh, dict):
        return mesh  # type: ignore[return-value]
    if hasattr(mesh, "field_data") and isinstance(getattr(mesh, "cells", None), list):
        return from_meshio(mesh)
    if hasattr(getattr(mesh, "model", mesh), "getPhysicalGroups"):
        return from_gmsh(mesh)
    raise ValueError(f"mesh: {type(mesh).__name__} is none of meshio, gmsh; use stickslip.mesh.from_arrays or from_pyvista")
