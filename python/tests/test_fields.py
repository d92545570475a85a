"""What follows from a result: the numbers of the program's files, in memory and written."""

from __future__ import annotations

import base64
import dataclasses
import pickle
import struct
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from scenes import SCENES, block, needs


@pytest.fixture(scope="module")
def result() -> ss.Result:
    return ss.run(block()).check()


def vtu(path: Path) -> dict[str, np.ndarray]:
    """The arrays of a VTU file of the program."""
    arrays = {}
    for array in ElementTree.parse(path).iter("DataArray"):
        if array.get("format") == "binary":
            raw = base64.b64decode(array.text or "")
            (count,) = struct.unpack("<Q", raw[:8])
            kind = {"Float64": "<f8", "Int64": "<i8", "Int32": "<i4", "UInt8": "u1"}[array.get("type", "")]
            arrays[array.get("Name", "")] = np.frombuffer(raw[8 : 8 + count], kind)
    return arrays


def test_stresses_of_first_order_are_forces_over_weights(result: ss.Result) -> None:
    assert result.model is not None
    weight = result.model.problem.weight
    np.testing.assert_allclose(result.pressure, result.p_n / weight, rtol=1e-12)
    np.testing.assert_allclose(abs(result.traction[:, :, 0]), abs(result.p_t[:, :, 0]) / weight, rtol=1e-12)
    inside = (result.contact == ss.STICK) | (result.contact == ss.SLIP)
    assert abs(result.opening[inside]).max() < 1e-9 * result.gap.max() and (result.opening >= -1e-15).all()
    motion = result.gap - np.stack([result.model.problem.C_n @ u for u in result.u])
    np.testing.assert_allclose(result.opening, motion, rtol=0, atol=1e-15)
    slip = np.stack([result.model.problem.C_t[0] @ u for u in result.u])
    np.testing.assert_allclose(abs(result.slip[:, :, 0]), abs(slip), rtol=1e-9, atol=1e-18)


def test_pressures_of_second_order_are_recovered() -> None:
    scene = block(n=6, increments=2).to_dict()
    scene["mesh"]["cells"] = "quadrilateral8"
    result = ss.run(scene)
    points, _ = result.fields()
    at = result.model.contact_nodes if result.model else []
    np.testing.assert_allclose(result.pressure[-1], points["contact_pressure"][at], rtol=1e-12)


def test_reactions_balance_loads_and_contact(result: ss.Result) -> None:
    loads = np.array([[sum(load["force"][c] for load in r["loads"]) for c in range(2)] for r in result.report["reactions"]])
    contact = np.array([[f["force"][c] for c in range(2)] for f in result.report["forces"]])
    np.testing.assert_allclose(result.reactions["left"] + loads, contact, atol=1e-6 * abs(loads).max())
    scene = block().to_dict() | {"units": {"length": "mm", "stress": "MPa"}}
    scene["mesh"]["size"] = [1000.0, 1000.0]
    scene["material"]["young"] = 210e3
    scene["contact"][0]["obstacle"]["gap"] = 1e-2
    for load in scene["load"]:
        load["traction"] = [t * 1e-6 for t in load["traction"]]
    np.testing.assert_allclose(ss.run(scene).reactions["left"], result.reactions["left"], rtol=1e-8, atol=1e-3)


def test_displacements_that_were_not_kept_are_not_a_number() -> None:
    result = ss.run(block(), keep_u=[3])
    assert np.isfinite(result.pressure).all() and np.isfinite(result.traction).all()
    assert np.isfinite(result.slip[3]).all() and np.isnan(result.slip[4]).all() and np.isnan(result.opening[-1]).all()
    with pytest.raises(ValueError, match="k: the displacements of increment 9"):
        result.fields()


def test_fields_are_those_of_the_file(result: ss.Result, tmp_path: Path) -> None:
    result.write_vtu(tmp_path / "block.vtu", 4)
    written = vtu(tmp_path / "block.vtu")
    points, cells = result.fields(4)
    for name, values in {**points, **cells}.items():
        assert (written[name] == values.ravel()).all() or np.allclose(written[name], values.ravel(), rtol=1e-15, equal_nan=True), name
    assert points["displacement"].shape == (121, 3) and cells["stress"].shape == (100, 9)
    np.testing.assert_allclose(cells["stress"][:, [0, 4, 8, 1, 5, 2]], result.stress(4), rtol=1e-12, atol=1e-6)
    assert (points["displacement"] == result.displacement(4)).all()


def test_fields_go_to_meshio_and_pyvista(result: ss.Result) -> None:
    needs("meshio")
    mesh = result.to_meshio(4)
    assert {"contact_pressure", "slip", "contact", "opening", "p_n"} <= set(mesh.point_data) and {"stress", "von_mises"} <= set(mesh.cell_data)
    if needs("pyvista"):
        assert "von_mises" in result.to_pyvista().cell_data


def test_prisms_of_second_order_go_to_pyvista() -> None:
    scene = {"mesh.elements": [3, 3, 2], "mesh.cells": "prism15", "time.increments": 1}
    result = ss.run(ss.Scene.example("cube"), scene)
    if needs("pyvista"):
        grid = result.to_pyvista()
        volume = float(np.prod(result.model.points.max(axis=0))) if result.model else 0.0
        assert grid.n_cells == 36 and grid.volume == pytest.approx(volume, rel=1e-9)
    if needs("meshio"):
        try:
            assert result.to_meshio().cells[0].type == "wedge15"
        except ValueError as error:
            assert "write_vtu" in str(error)


@pytest.mark.parametrize("path, overrides", [("block", {"mesh.elements": [10, 10]}), ("cube", {"mesh.elements": [3, 3, 3]}), ("two_blocks", {})])
def test_pictures_are_those_of_the_program(path: str, overrides: dict[str, Any], tmp_path: Path) -> None:
    result = ss.run(SCENES / f"{path}.toml", overrides)
    assert result.model is not None
    deformed = result.svg("deformed", magnification=100.0)
    for boundary in result.model.boundaries:
        picture = result.svg("contact", 0, boundary=boundary)
        assert picture.startswith("<svg") and picture._repr_svg_() == picture
        ElementTree.fromstring(picture)
    deformed.save(tmp_path / "deformed.svg")
    assert (tmp_path / "deformed.svg").read_text(encoding="utf-8") == deformed and len(repr(deformed)) < 40


def test_an_increment_goes_to_fclib_and_back(result: ss.Result, tmp_path: Path) -> None:
    path = tmp_path / "block.hdf5"
    result.write_fclib(path, 4)
    file = ss.exchange.read(path)
    assert file.solution is not None and "increment 5 of 10" in file.title
    u, p_n, p_t = file.solution
    assert (u == result.u[4]).all() and (p_n == result.p_n[4]).all() and (p_t == result.p_t[4]).all()
    posed = file.posed
    errors = ss.measure(posed.problem, posed.force, u, p_n, p_t, gap=posed.gap, w_t_last=posed.w_t_last)
    assert errors.error < 1e-10
    answer = ss.exchange.solve(path)
    assert answer.converged and answer.r[::2] == pytest.approx(p_n, rel=1e-9, abs=1e-6)
    result.write_fclib(path, 4, form="local")
    assert ss.exchange.solve(path).converged
    with pytest.raises(ValueError, match="path: .* has the local form"):
        ss.exchange.read(path)
    (tmp_path / "nothing.txt").write_text("no problem")
    for call in (ss.exchange.read, ss.exchange.solve):
        with pytest.raises(ValueError, match="path: "):
            call(tmp_path / "nothing.txt")
        with pytest.raises(FileNotFoundError):
            call(tmp_path / "nowhere.hdf5")


@pytest.mark.filterwarnings("ignore::stickslip.NotConvergedWarning")
def test_an_increment_that_failed_can_be_looked_at() -> None:
    result = ss.run(block(max_iterations=1, setting="paper"))
    assert not result.converged
    points, _ = result.fields()
    assert np.isfinite(points["displacement"]).all() and result.pressure.shape == result.p_n.shape


def test_what_was_computed_again_is_not_pickled(result: ss.Result) -> None:
    before = len(pickle.dumps(dataclasses.replace(result)))
    assert result.slip.any() and len(pickle.dumps(result)) == before
    assert (pickle.loads(pickle.dumps(result)).slip == result.slip).all()


def test_a_result_of_matrices_has_no_fields_of_a_body(tmp_path: Path) -> None:
    result = ss.ContactProblem(np.eye(2), [[0.0, -1.0]], [[1.0, 0.0]], 0.3).solve([0.1, 1.0], gap=0.0)
    for what in ("pressure", "traction"):
        with pytest.raises(ValueError, match=rf"{what}: give the problem the lengths or areas .* problem.with_\(weight"):
            getattr(result, what)
    with pytest.raises(ValueError, match="model: this result is of a problem of matrices, which has no mesh"):
        result.reactions
    result.save(tmp_path / "a")
    with pytest.raises(ValueError, match="slip: this result was read from a file"):
        ss.load(tmp_path / "a.npz").slip


def test_the_substitutes_of_a_result_of_matrices_are_what_a_model_gives() -> None:
    model = ss.Model(block(4, 4))
    result, problem, history = model.run(), model.problem, model.history
    same = problem.solve(history["force"], gap=history["gap"])
    size = abs(result.pressure).max()
    np.testing.assert_allclose(same.p_n / problem.weight, result.pressure, atol=1e-10 * size)
    np.testing.assert_allclose(same.p_t / problem.weight[:, None], result.traction, atol=1e-10 * size)
    np.testing.assert_allclose(problem.slip(same.u[-1]), result.slip[-1], atol=1e-16)
    np.testing.assert_allclose(same.gap[-1] - problem.C_n @ same.u[-1], result.opening[-1], atol=1e-16)
