"""Materials and kinds of cells of meshes in memory: as in a file, and nothing is dropped or mistaken in silence."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import stickslip as ss
from scenes import needs
from stickslip import mesh

POINTS = np.array([[0, 0], [0.5, 0], [1, 0], [0, 1], [0.5, 1], [1, 1]], dtype=float)
QUADS = np.array([[0, 1, 4, 3], [1, 2, 5, 4]])
SIDES = {"left": lambda x: x[:, 0] == 0, "bottom": lambda x: x[:, 1] == 0, "top": lambda x: x[:, 1] == 1}
RUBBER = {"name": "rubber", "young": 1e7, "poisson": 0.3}


def scene(dimension: int = 2, groups: tuple[str, ...] = ("rubber",)) -> dict[str, Any]:
    """A body clamped on its left and pressed on from above."""
    axes, down = ["x", "y", "z"][:dimension], [0.0] * (dimension - 1) + [-1e4]
    return {
        "material": {"young": 210e9, "poisson": 0.3, "group": [{**RUBBER, "name": name, "young": 1e7 * (1 + k)} for k, name in enumerate(groups)]},
        "support": [{"boundary": "left", "fix": axes}],
        "contact": [{"boundary": "bottom", "friction": 0.4, "obstacle": {"kind": "plane", "gap": 1e-6}}],
        "load": [{"boundary": "top", "traction": down, "history": [[0, 0], [1, 1]]}],
        "time": {"end": 1.0, "increments": 2},
    }


def largest(given: Any) -> float:
    return float(abs(ss.run(scene(), mesh=given).check().u[-1]).max())


@pytest.mark.parametrize("members", [[1], [False, True]], ids=["numbers", "mask"])
def test_cells_of_no_group_have_the_material_itself(members: list[Any]) -> None:
    both = largest(mesh.from_arrays(POINTS, [("quad", QUADS)], SIDES, groups={"steel": [[0]], "rubber": [[1]]}))
    assert largest(mesh.from_arrays(POINTS, [("quad", QUADS)], SIDES, groups={"rubber": [members]})) == both
    split = [("quad", QUADS[:1]), ("quad", QUADS[1:])]
    assert largest(mesh.from_arrays(POINTS, split, SIDES, groups={"rubber": [[], [0]]})) == both


def test_cell_sets_and_tags_of_meshio_leave_others_alone() -> None:
    meshio = needs("meshio")
    both = largest(mesh.from_arrays(POINTS, [("quad", QUADS)], SIDES, groups={"steel": [[0]], "rubber": [[1]]}))
    cells = [("quad", QUADS)]
    assert largest(mesh.from_meshio(meshio.Mesh(POINTS, cells, cell_sets={"rubber": [np.array([1])]}), SIDES)) == both
    tagged = meshio.Mesh(POINTS, cells, cell_data={"gmsh:physical": [np.array([0, 7])]}, field_data={"rubber": np.array([7, 2])})
    assert largest(mesh.from_meshio(tagged, SIDES)) == both
    # Without a name a group is called by its number.
    nameless = mesh.from_meshio(meshio.Mesh(POINTS, cells, cell_data={"gmsh:physical": [np.array([0, 7])]}), SIDES)
    assert nameless["groups"] == ["7", ""] and nameless["cells"][0][2].tolist() == [1, 0]


@pytest.mark.parametrize("what, groups", [
    ("'a' and 'b' have 1 cell in common", {"a": [[0, 1]], "b": [[1]]}),
    ("2 blocks, expected 1", {"a": [[0], [1]]}),
    ("cell 2 is not among", {"a": [[2]]}),
    ("cell -1 is not among", {"a": [[-1]]}),
    ("mask of the shape", {"a": [[True]]}),
    ("whole numbers", {"a": [[0.5]]}),
])
def test_groups_that_cannot_be_are_refused(what: str, groups: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=what):
        mesh.from_arrays(POINTS, [("quad", QUADS)], SIDES, groups=groups)


def test_cells_of_other_kinds_are_refused_with_their_number() -> None:
    points = np.array([*POINTS, [0.75, 0], [1, 0.5], [0.75, 1], [0.5, 0.5]])
    second = np.array([[1, 2, 5, 4, 6, 7, 8]])
    with pytest.raises(ValueError, match="1 of the kind triangle7"):
        mesh.from_arrays(points, [("quad", QUADS[:1]), ("triangle7", second)], SIDES)
    with pytest.raises(ValueError, match="whole numbers"):
        mesh.from_arrays(POINTS, [("quad", QUADS + 0.5)], SIDES)
    with pytest.raises(ValueError, match="shape"):
        mesh.from_arrays(POINTS, [("quad", QUADS[:, :3])], SIDES)
    meshio = needs("meshio")
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1], [0.5, 0.5, 1.5]], dtype=float)
    house = [("hexahedron", [list(range(8))]), ("pyramid", [[4, 5, 6, 7, 8]])]
    with pytest.raises(ValueError, match="1 of the kind pyramid"):
        mesh.from_meshio(meshio.Mesh(corners, house), {"left": SIDES["left"]})
    # Sides of such cells in a group would be missing from their boundary.
    with pytest.raises(ValueError, match="1 of the kind triangle10"):
        mesh.from_meshio(meshio.Mesh(corners, [*house[:1], ("triangle10", [[*range(9), 0]])]), {"left": SIDES["left"]})


def test_cells_of_other_kinds_in_pyvista_are_refused() -> None:
    pyvista = needs("pyvista")
    points = np.column_stack([[*POINTS, [0.75, 0], [1, 0.5], [0.75, 1], [0.5, 0.5]], np.zeros(10)])
    cells = [4, *QUADS[0], 7, 1, 2, 5, 4, 6, 7, 8, 2, 0, 1]
    grid = pyvista.UnstructuredGrid(cells, [pyvista.CellType.QUAD, pyvista.CellType.BIQUADRATIC_TRIANGLE, pyvista.CellType.LINE], points)
    with pytest.raises(ValueError, match="1 of the kind BIQUADRATIC_TRIANGLE"):
        mesh.from_pyvista(grid, SIDES)
    with pytest.raises(ValueError, match="UnstructuredGrid"):
        mesh.from_pyvista(pyvista.Sphere(), SIDES)
    # Lines are no part of the body.
    assert len(mesh.from_pyvista(grid.extract_cells([0, 2]), {"left": SIDES["left"]})["cells"]) == 1


@pytest.fixture
def gmsh() -> Iterator[Any]:
    module = needs("gmsh")
    module.initialize(interruptible=False)
    try:
        module.option.setNumber("General.Terminal", 0)
        yield module
    finally:
        module.finalize()


def body(gmsh: Any, dimension: int, order: int, quads: bool, named: tuple[bool, bool], apart: bool) -> None:
    """Two blocks beside each other, one of rubber, meshed; `named` says which of them is in a physical group."""
    gmsh.clear()
    occ, shift = gmsh.model.occ, 0.1 if apart else 0.0
    if dimension == 2:
        pair = [(2, occ.addRectangle(0, 0, 0, 0.5, 1)), (2, occ.addRectangle(0.5 + shift, 0, 0, 0.5, 1))]
    else:
        pair = [(3, occ.addBox(0, 0, 0, 0.5, 1, 1)), (3, occ.addBox(0.5 + shift, 0, 0, 0.5, 1, 1))]
    if not apart:
        occ.fragment(pair[:1], pair[1:])
    occ.synchronize()
    last = dimension - 1
    for name, axis, at in (("left", 0, 0.0), ("bottom", last, 0.0), ("top", last, 1.0)):
        box = [-1.0, -1.0, -1.0, 2.0, 2.0, 2.0]
        box[axis], box[axis + 3] = at - 1e-3, at + 1e-3
        gmsh.model.addPhysicalGroup(last, [tag for _, tag in gmsh.model.getEntitiesInBoundingBox(*box, last)], name=name)
    for name, (dim, tag), wanted in zip(("steel", "rubber"), pair, named):
        if wanted:
            gmsh.model.addPhysicalGroup(dim, [tag], name=name)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 1.0)
    gmsh.option.setNumber("Mesh.RecombineAll", int(quads))
    gmsh.model.mesh.generate(dimension)
    gmsh.model.mesh.setOrder(order)


@settings(max_examples=6, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(data=st.data())
def test_a_mesh_in_memory_is_the_mesh_of_the_file(data: st.DataObject, gmsh: Any, tmp_path: Path) -> None:
    dimension, order = data.draw(st.sampled_from([2, 3])), data.draw(st.sampled_from([1, 2]))
    quads = dimension == 2 and data.draw(st.booleans())
    named = data.draw(st.sampled_from([(True, True), (True, False), (False, True), (False, False)]))
    material = data.draw(st.sampled_from([("rubber",), ("steel", "rubber"), ()]))
    body(gmsh, dimension, order, quads, named, apart=False)
    # All of them, as in memory: otherwise Gmsh leaves out what is in no group.
    gmsh.option.setNumber("Mesh.SaveAll", 1)
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    file = tmp_path / "body.msh"
    gmsh.write(str(file))
    problem = scene(dimension, tuple(name for name in material if name in np.array(["steel", "rubber"])[list(named)]))
    expected = ss.run({**problem, "mesh": {"kind": "gmsh", "file": str(file)}}).check()
    givens = [mesh.from_gmsh(gmsh)]
    if all(named):
        # meshio reads no file of Gmsh with elements of no group beside others.
        gmsh.option.setNumber("Mesh.SaveAll", 0)
        gmsh.write(str(file))
        givens.append(mesh.from_meshio(needs("meshio").read(file)))
    for given_mesh in givens:
        result = ss.run(problem, mesh=given_mesh).check()
        np.testing.assert_allclose(result.p_n.sum(axis=1), expected.p_n.sum(axis=1), rtol=1e-9, atol=1e-9)
        assert abs(result.u[-1]).max() == pytest.approx(abs(expected.u[-1]).max(), rel=1e-9)


def test_loose_parts_of_no_group_are_refused_from_gmsh(gmsh: Any) -> None:
    body(gmsh, 2, 1, False, (True, False), apart=True)
    with pytest.raises(ValueError, match="without a physical group is apart"):
        mesh.from_gmsh(gmsh)
    # With a group of its own it is a second body, and without any group no part is left over.
    for named in ((True, True), (False, False)):
        body(gmsh, 2, 1, False, named, apart=True)
        assert set(mesh.from_gmsh(gmsh)["groups"]) == ({"steel", "rubber"} if all(named) else set())


def test_cells_of_other_kinds_in_gmsh_are_refused(gmsh: Any) -> None:
    body(gmsh, 2, 3, False, (True, True), apart=False)
    with pytest.raises(ValueError, match=r"\d+ of the kind Triangle 10"):
        mesh.from_gmsh(gmsh)


def test_a_cell_of_gmsh_has_one_group(gmsh: Any) -> None:
    body(gmsh, 2, 1, False, (True, False), apart=False)
    gmsh.model.addPhysicalGroup(2, [1], name="all")
    with pytest.raises(ValueError, match="'steel' and 'all' have 86 cells in common"):
        mesh.from_gmsh(gmsh)
