"""Laws and statuses of contact, and kinds of cells by the names of meshio: their sides, numbers in other programs, orientation."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

#: The status of a node that does not touch.
OPEN: int = 0
#: The status of a node that touches and does not slide.
STICK: int = 1
#: The status of a node that slides.
SLIP: int = 2

#: The laws of the error measure, in the order of the columns of `Result.errors`.
LAWS: tuple[str, ...] = ("equilibrium", "penetration", "tension", "complementarity", "cone", "dissipation")

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

DIMENSION = {name: 2 if name in ("triangle", "quad", "triangle6", "quad8", "quad9") else 3 for name in SIDES}
# The centre of a quadrilateral is on no side.
NODES = {name: 1 + max(max(side) for side in sides) for name, sides in SIDES.items()} | {"quad9": 9}
#: The order of the nodes that turns a cell inside out.
MIRRORED = {
    "triangle": [2, 1, 0], "quad": [3, 2, 1, 0], "tetra": [1, 0, 2, 3], "hexahedron": [4, 5, 6, 7, 0, 1, 2, 3], "wedge": [3, 4, 5, 0, 1, 2],
    "triangle6": [2, 1, 0, 4, 3, 5], "quad8": [3, 2, 1, 0, 6, 5, 4, 7], "quad9": [3, 2, 1, 0, 6, 5, 4, 7, 8],
    "tetra10": [1, 0, 2, 3, 4, 6, 5, 8, 7, 9],
    "hexahedron20": [4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11, 16, 17, 18, 19],
    "wedge15": [3, 4, 5, 0, 1, 2, 9, 10, 11, 6, 7, 8, 12, 13, 14],
}
FACETS = {2: ("line", "line3"), 3: ("triangle", "quad", "triangle6", "quad8")}
GMSH = {
    1: "line", 2: "triangle", 3: "quad", 4: "tetra", 5: "hexahedron", 6: "wedge", 8: "line3", 9: "triangle6", 10: "quad9", 11: "tetra10",
    16: "quad8", 17: "hexahedron20", 18: "wedge15",
}
#: The place of each node in the order of Gmsh, where it is another.
GMSH_ORDER = {
    "tetra10": [0, 1, 2, 3, 4, 5, 6, 7, 9, 8],
    "hexahedron20": [0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15],
    "wedge15": [0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11],
}
VTK = {
    5: "triangle", 9: "quad", 10: "tetra", 12: "hexahedron", 13: "wedge", 22: "triangle6", 23: "quad8", 24: "tetra10",
    25: "hexahedron20", 26: "wedge15", 28: "quad9",
}
#: Points and lines of VTK, which are no part of a body.
VTK_LINES = {0, 1, 2, 3, 4, 21, 35, 68}


def outer_facets(cells: Iterable[tuple[str, Array]]) -> list[list[int]]:
    """The facets that belong to one cell only.

    Parameters
    ----------
    cells : iterable of (str, ndarray)
        Kind and nodes (k, nodes of the kind).

    Returns
    -------
    list of list of int
        The nodes of each, corners first.

    Examples
    --------
    >>> from stickslip import mesh
    >>> len(mesh.outer_facets([("quad", [[0, 1, 4, 3], [1, 2, 5, 4]])]))
    6
    """
    seen: Counter[tuple[int, ...]] = Counter()
    facets: dict[tuple[int, ...], list[int]] = {}
    for kind, nodes in cells:
        for side in SIDES[kind]:
            for facet in np.asarray(nodes)[:, side].tolist():
                key = tuple(sorted(facet))
                seen[key] += 1
                facets[key] = facet
    return [facets[key] for key, count in seen.items() if count == 1]


def coordinate_plane(xyz: Array, blocks: list[tuple[str, Array]]) -> tuple[int, int]:
    """The axes of the coordinate plane in which the body lies, as files are read."""
    used = xyz[np.unique(np.concatenate([nodes.ravel() for _, nodes in blocks]))]
    if not np.isfinite(used).all():
        return (0, 1)
    flat = np.ptp(used, axis=0) <= 1e-9 * abs(used).max()
    for axis, others in ((2, (0, 1)), (1, (0, 2)), (0, (1, 2))):
        if flat[axis]:
            return others
    raise ValueError("points: the cells are plane, but the points lie in none of the coordinate planes; a body in space needs cells with a volume")


def right_way_round(xyz: Array, kind: str, nodes: Array) -> Array:
    """The cells with their insides out are renumbered, as those of files are."""
    x = xyz[nodes]
    if DIMENSION[kind] == 2:
        count = len(SIDES[kind])
        a = x[:, 1:count, :2] - x[:, :1, :2]
        volume = (a[:, :-1, 0] * a[:, 1:, 1] - a[:, :-1, 1] * a[:, 1:, 0]).sum(axis=1)
    else:
        # By the theorem of Gauss: the corners of a side, its normal outwards.
        volume = np.zeros(len(nodes))
        for side in SIDES[kind]:
            corners = [x[:, k] - x[:, 0] for k in side[: 3 if len(side) in (3, 6) else 4]]
            for b, c in zip(corners[1:], corners[2:]):
                volume += np.einsum("ij,ij->i", corners[0], np.cross(b, c))
    with np.errstate(invalid="ignore"):
        inside_out = volume < 0
    if not inside_out.any():
        return nodes
    nodes = nodes.copy()
    nodes[inside_out] = nodes[inside_out][:, MIRRORED[kind]]
    return nodes
