"""Meshes in memory, and results in the formats of others."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import stickslip as ss
from scenes import block, needs
from stickslip import mesh

SIDES = {
    "left": lambda x: x[:, 0] == 0.0, "right": lambda x: x[:, 0] == 1.0, "bottom": lambda x: x[:, 1] == 0.0,
    "top": lambda x: x[:, 1] == 1.0,
}


def grid(n: int) -> tuple[np.ndarray, np.ndarray]:
    x = np.linspace(0, 1, n + 1)
    points = np.array([[a, b] for b in x for a in x])
    corner = np.array([j * (n + 1) + i for j in range(n) for i in range(n)])
    return points, np.stack([corner, corner + 1, corner + n + 2, corner + n + 1], axis=1)


def without_mesh() -> dict[str, object]:
    scene = block().to_dict()
    del scene["mesh"]
    return scene


def test_arrays_are_the_block_again() -> None:
    points, quads = grid(10)
    given = mesh.from_arrays(points * 1000, [("quad", quads)], {**SIDES, "left": lambda x: x[:, 0] < 1e-9}, scale=1e-3)
    result, expected = ss.run(without_mesh(), mesh=given), ss.run(block())
    np.testing.assert_allclose(result.p_n.sum(axis=1), expected.p_n.sum(axis=1), rtol=1e-9)


def test_meshio_with_physical_groups_and_back(tmp_path: Path) -> None:
    meshio = needs("meshio")
    points, quads = grid(10)
    facets = mesh.outer_facets([("quad", quads)])
    lines = {name: np.array([f for f in facets if where(points)[f].all()]) for name, where in SIDES.items()}
    cells = [("quad", quads)] + [("line", of) for of in lines.values()]
    tags = [np.ones(len(quads), int)] + [np.full(len(of), 10 + k) for k, of in enumerate(lines.values())]
    names = {"body": np.array([1, 2])} | {name: np.array([10 + k, 1]) for k, name in enumerate(lines)}
    # A point of the geometry alone is no node of the body.
    theirs = meshio.Mesh(np.vstack([points, [[5.0, 5.0]]]), cells, cell_data={"gmsh:physical": tags}, field_data=names)
    result, expected = ss.run(without_mesh(), mesh=theirs), ss.run(block())
    np.testing.assert_allclose(result.p_n.sum(axis=1), expected.p_n.sum(axis=1), rtol=1e-9)
    written = result.to_meshio()
    assert written.point_data["displacement"].shape == (121, 3)
    assert written.cell_data["stress"][0].shape == (100, 6)
    written.write(tmp_path / "block.vtu")
    assert (tmp_path / "block.vtu").stat().st_size > 0


def test_gmsh_objects() -> None:
    gmsh = needs("gmsh")
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
        gmsh.model.occ.synchronize()
        for name, tag in (("bottom", 1), ("right", 2), ("top", 3), ("left", 4)):
            gmsh.model.addPhysicalGroup(1, [tag], name=name)
        gmsh.model.addPhysicalGroup(2, [1], name="body")
        gmsh.option.setNumber("Mesh.MeshSizeMax", 0.1)
        gmsh.model.mesh.generate(2)
        result = ss.run(without_mesh(), mesh=gmsh.model)
    finally:
        gmsh.finalize()
    expected = ss.run(block())
    np.testing.assert_allclose(result.p_n.sum(axis=1)[-1], expected.p_n.sum(axis=1)[-1], rtol=0.05)


def test_pyvista_there_and_back() -> None:
    pyvista = needs("pyvista")
    points, quads = grid(10)
    theirs = pyvista.UnstructuredGrid({pyvista.CellType.QUAD: quads}, np.column_stack([points, np.zeros(len(points))]))
    result = ss.run(without_mesh(), mesh=mesh.from_pyvista(theirs, SIDES))
    assert result.to_pyvista().n_cells == 100


@pytest.mark.parametrize("name, make", [
    ("boundaries", lambda p, q: mesh.from_arrays(p, [("quad", q)], {"bottom": lambda x: x[:, 1] == 7.0})),
    ("cells", lambda p, q: mesh.from_arrays(p, [("quad", q + 1000)], SIDES)),
    ("cells", lambda p, q: mesh.from_arrays(p, [("octagon", q)], SIDES)),
    ("cells", lambda p, q: mesh.from_arrays(p, [], SIDES)),
    ("points", lambda p, q: mesh.from_arrays(p[:, 0], [("quad", q)], SIDES)),
    ("mesh", lambda p, q: ss.Model(without_mesh(), mesh=mesh.from_arrays(p, [("quad", q[:, [0, 2, 1, 3]])], {}))),
    ("mesh", lambda p, q: ss.Model(without_mesh(), mesh=3)),
    ("bottom", lambda p, q: ss.Model(without_mesh(), mesh=mesh.from_arrays(p, [("quad", q)], {"left": SIDES["left"]}))),
])
def test_bad_meshes_are_value_errors(name: str, make: object) -> None:
    with pytest.raises(ValueError, match=name):
        make(*grid(3))  # type: ignore[operator]


def test_tables_and_pictures() -> None:
    needs("matplotlib").use("Agg")
    result = ss.run(block())
    assert "converged" in result.plot().get_title()
    assert result.plot_convergence().get_yscale() == "log" and result.plot_history().lines
    table = needs("pandas") and result.to_pandas()
    assert table["equilibrium"].max() == pytest.approx(result.errors[:, 0].max())
    data = needs("xarray") and result.to_xarray()
    assert data["p_t"].shape == (10, 10, 1) and float(data["x"].max()) == 1.0
    assert "#1a7f37" in result._repr_html_()


def test_meshes_refine_themselves() -> None:
    keys = {"mesh.elements": [4, 4], "mesh.cells": "triangle"}
    coarse = ss.Model(block(), keys)
    fine = coarse.refined(0.1)
    assert len(fine.points) > 2 * len(coarse.points) and fine.points.max() == coarse.points.max()
    # As the scene says, and with other values on the same mesh.
    result = ss.run(block(), {**keys, "mesh.refine": 0.1})
    np.testing.assert_array_equal(result.p_n, fine.run().p_n)
    swept = ss.sweep(block(), {"mesh.refine": [0.1]}, overrides=keys)
    np.testing.assert_array_equal(swept[0].p_n[-1], result.p_n[-1])
    other = fine.with_({"contact.friction": 0.1})
    np.testing.assert_array_equal(other.points, fine.points)
    again = pickle.loads(pickle.dumps(fine))
    np.testing.assert_array_equal(again.points, fine.points)
    with pytest.raises(ss.SceneError, match="triangles or of tetrahedra"):
        ss.Model(block()).refined(0.1)
    with pytest.raises(ValueError, match="error"):
        coarse.refined(2)
