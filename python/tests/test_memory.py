"""A mesh in memory is the mesh of a file: every kind of cell, of both orders, with groups, in every plane, with couplings."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import stickslip as ss
from scenes import needs
from stickslip import mesh
from stickslip._kinds import DIMENSION, GMSH, GMSH_ORDER, MIRRORED, SIDES

#: The corners of the cells of a unit square or cube, by the kind of first order.
CORNERS: dict[str, list[list[tuple[int, ...]]]] = {
    "quad": [[(0, 0), (1, 0), (1, 1), (0, 1)]],
    "triangle": [[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (0, 1)]],
    "hexahedron": [[(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]],
    "wedge": [
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1)], [(0, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1), (0, 1, 1)],
    ],
    # Along the six ways from corner to corner.
    "tetra": [
        [(0, 0, 0), tuple(int(k == p[0]) for k in range(3)), tuple(int(k in p[:2]) for k in range(3)), (1, 1, 1)]
        for p in itertools.permutations(range(3))
    ],
}
FIRST = {"triangle6": "triangle", "quad8": "quad", "quad9": "quad", "tetra10": "tetra", "hexahedron20": "hexahedron", "wedge15": "wedge"}
FACET = {2: "line", 3: "triangle", 4: "quad", 6: "triangle6", 8: "quad8"}
NAMES = ("left", "bottom", "top")


def edges(kind: str) -> list[tuple[int, int]]:
    """The corners on both sides of each node in the middle of an edge, in the order of the nodes."""
    found: dict[int, tuple[int, int]] = {}
    for side in SIDES[kind]:
        n = len(side) // 2 if DIMENSION[kind] == 3 else 2
        middle = side[n:]
        for k, node in enumerate(middle):
            found[node] = (side[k], side[(k + 1) % n])
    return [found[node] for node in sorted(found)]


def body(kind: str, counts: tuple[int, ...], bend: float) -> tuple[np.ndarray, np.ndarray]:
    """Points and cells of a unit square or cube, bent inside and straight on its border."""
    first, dimension = FIRST.get(kind, kind), DIMENSION[kind]
    cells = []
    for at in itertools.product(*map(range, counts)):
        for corners in CORNERS[first]:
            own = (np.array(corners, dtype=float) + at) / counts
            if kind in FIRST:
                own = np.vstack([own, [own[[a, b]].mean(axis=0) for a, b in edges(kind)]])
            if kind == "quad9":
                own = np.vstack([own, own[:4].mean(axis=0)])
            cells.append(own)
    places = np.round(np.array(cells) * 720).astype(int)
    points, number = np.unique(places.reshape(-1, dimension), axis=0, return_inverse=True)
    x = points / 720
    x = x + bend * np.prod(x * (1 - x), axis=1, keepdims=True) * np.linspace(1.0, -0.5, dimension)
    return x, number.reshape(len(cells), -1)


def facets(kind: str, points: np.ndarray, cells: np.ndarray) -> dict[str, list[list[int]]]:
    """The outer facets on three sides."""
    outer, last = mesh.outer_facets([(kind, cells)]), points.shape[1] - 1
    on = {"left": points[:, 0] == 0, "bottom": points[:, last] == 0, "top": points[:, last] == 1}
    return {name: [facet for facet in outer if on[name][facet].all()] for name in NAMES}


def facet_kind(dimension: int, facet: list[int]) -> str:
    return {2: "line", 3: "line3"}[len(facet)] if dimension == 2 else FACET[len(facet)]


def write(path: Path, kind: str, points: np.ndarray, cells: np.ndarray, soft: np.ndarray, sides: dict[str, list[list[int]]]) -> None:
    """MSH 2.2: the soft cells are the group 1, the others are of the group 9, the sides are 2, 3 and 4."""
    code, dimension = {name: number for number, name in GMSH.items()}, DIMENSION[kind]

    def line(number: int, of: str, group: int, nodes: Any) -> str:
        order = np.empty(len(nodes), dtype=int)
        order[GMSH_ORDER.get(of, np.arange(len(nodes)))] = np.arange(len(nodes))
        return " ".join(map(str, [number, code[of], 2, group, group, *(np.asarray(nodes)[order] + 1)]))

    elements = [(facet_kind(dimension, facet), 2 + k, facet) for k, name in enumerate(NAMES) for facet in sides[name]]
    elements += [(kind, 1 if s else 9, nodes) for nodes, s in zip(cells, soft)]
    names = [(dimension - 1, 2 + k, name) for k, name in enumerate(NAMES)] + [(dimension, 1, "soft"), (dimension, 9, "hard")]
    text = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names))]
    text += [f'{d} {tag} "{name}"' for d, tag, name in names] + ["$EndPhysicalNames", "$Nodes", str(len(points))]
    text += [f"{k + 1} " + " ".join(repr(float(c)) for c in x) for k, x in enumerate(points)]
    text += ["$EndNodes", "$Elements", str(len(elements))]
    text += [line(k + 1, *element) for k, element in enumerate(elements)] + ["$EndElements", ""]
    path.write_text("\n".join(text))


def scene(dimension: int, coupling: str | None = None, has_soft: bool = False) -> dict[str, Any]:
    down = [5e4] + [0.0] * (dimension - 2) + [-1e6]
    keys: dict[str, Any] = {
        "material": {"young": 210e9, "poisson": 0.3, "group": [{"name": "soft", "young": 1e9, "poisson": 0.3}] if has_soft else None},
        "support": [{"boundary": "left", "fix": ["x", "y", "z"][:dimension]}],
        "contact": [{"boundary": "bottom", "friction": 0.4, "obstacle": {"kind": "plane", "gap": 1e-6}}],
        "load": [{"boundary": "top", "traction": down, "history": [[0, 0], [1, 1]]}],
        "time": {"end": 1.0, "increments": 2},
    }
    if coupling:
        keys["coupling"] = [{"name": "lever", "boundary": "top", "kind": coupling}]
        keys["load"] = [{"coupling": "lever", "force": down, "history": [[0, 0], [1, 1]]}]
        if coupling == "rigid":
            # The sides meet at an edge, whose nodes one of them alone can hold.
            keys["support"] = [{"boundary": "bottom", "fix": ["x"] if dimension == 2 else ["x", "y"]}]
            keys["contact"][0]["obstacle"]["gap"] = 0.0
    return keys


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(data=st.data())
@pytest.mark.filterwarnings("ignore::stickslip.AccuracyWarning")
def test_a_mesh_in_memory_is_that_of_a_file(data: st.DataObject, tmp_path: Path) -> None:
    kind = data.draw(st.sampled_from(sorted(SIDES)))
    dimension = DIMENSION[kind]
    counts = data.draw(st.tuples(*[st.integers(1, 3 if dimension == 2 else 2)] * dimension))
    x, cells = body(kind, counts, data.draw(st.sampled_from([0.0, 0.2])))
    sides = facets(kind, x, cells)
    soft = x[cells].mean(axis=1)[:, 0] < data.draw(st.sampled_from([0.0, 0.5, 1.0]))
    turned = data.draw(st.lists(st.booleans(), min_size=len(cells), max_size=len(cells))) if data.draw(st.booleans()) else [False] * len(cells)
    cells[turned] = cells[turned][:, MIRRORED[kind]]
    planes = [(0, 1), (0, 2), (1, 2)] if dimension == 2 else [(0, 1, 2)]
    axes, points = data.draw(st.sampled_from(planes)), np.full((len(x), 3), data.draw(st.sampled_from([0.0, 0.25])) if dimension == 2 else 0.0)
    points[:, axes] = x
    problem = scene(dimension, data.draw(st.sampled_from([None, None, "rigid", "distributing"])), bool(soft.any()))
    file = tmp_path / "body.msh"
    write(file, kind, points, cells, soft, sides)
    expected = ss.run({**problem, "mesh": {"kind": "gmsh", "file": str(file)}}).check()

    # No meshio so far knows the dimension of prisms of second order.
    source = data.draw(st.sampled_from(["arrays", "pyvista"] if kind == "wedge15" else ["arrays", "meshio", "pyvista"]))
    if source == "meshio":
        meshio = needs("meshio")
        blocks = [(facet_kind(dimension, of[0]), np.array([f for f in of if len(f) == len(of[0])])) for of in sides.values()]
        rest = [(name, [f for f in of if len(f) != len(of[0])]) for name, of in sides.items()]
        tags = [np.full(len(nodes), 2 + k) for k, (_, nodes) in enumerate(blocks)]
        for name, more in rest:
            if more:
                blocks.append((facet_kind(dimension, more[0]), np.array(more)))
                tags.append(np.full(len(more), 2 + NAMES.index(name)))
        names = {"soft": np.array([1, dimension]), "hard": np.array([9, dimension])}
        names |= {name: np.array([2 + k, dimension - 1]) for k, name in enumerate(NAMES)}
        tags = [np.where(soft, 1, 9), *tags]
        in_memory: Any = meshio.Mesh(points, [(kind, cells), *blocks], cell_data={"gmsh:physical": tags}, field_data=names)
    elif source == "pyvista" and not soft.any():
        pyvista = needs("pyvista")
        from stickslip._kinds import VTK

        code = next(number for number, name in VTK.items() if name == kind)
        last = axes[-1]
        chosen = {
            "left": lambda p: p[:, axes[0]] == 0, "bottom": lambda p: p[:, last] == 0, "top": lambda p: p[:, last] == 1,
        }
        in_memory = mesh.from_pyvista(pyvista.UnstructuredGrid({code: cells}, points), chosen)
    else:
        in_memory = mesh.from_arrays(points, [(kind, cells)], sides, groups={"soft": [soft], "hard": [~soft]})
    result = ss.run(problem, mesh=in_memory).check()
    scale = abs(expected.u).max()
    np.testing.assert_allclose(result.displacement(), expected.displacement(), rtol=0, atol=1e-12 * scale)
    np.testing.assert_allclose(result.p_n, expected.p_n, rtol=1e-12, atol=1e-12 * max(abs(expected.p_n).max(), abs(expected.force).max()))
    assert (result.contact == expected.contact).all()


def test_a_surface_in_space_is_no_plane_body() -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 1], [0, 1, 1]], dtype=float)
    with pytest.raises(ValueError, match="points: .* none of the coordinate planes"):
        mesh.from_arrays(points, [("quad", [[0, 1, 2, 3]])], {})


@pytest.mark.parametrize("mesh_key", ["mesh = { kind = 'block', size = [1, 1], elements = [1, 1] }\n", "mesh.kind = 'block'\nmesh.size = [1, 1]\nmesh.elements = [1, 1]\n", ""])
def test_a_mesh_in_memory_takes_the_place_of_that_of_the_text(mesh_key: str) -> None:
    from stickslip._toml import to_toml

    x, cells = body("quad", (3, 3), 0.0)
    text = mesh_key + to_toml(scene(2))
    given_mesh = mesh.from_arrays(x, [("quad", cells)], {**facets("quad", x, cells)})
    assert len(ss.Model(text, mesh=given_mesh).points) == 16
