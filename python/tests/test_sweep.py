"""Many runs of one scene, chosen increments, the second run, and scenes to start from."""

from __future__ import annotations

import json
import os
import pickle
import signal
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import stickslip as ss
from scenes import SCENES, block, needs
from test_program import program

INIT = SCENES.parent / "init"


@pytest.mark.parametrize("name, file", [("block", "block"), ("cube", "cube"), ("gmsh", "roller")])
def test_scenes_to_start_from_are_those_of_the_program(name: str, file: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    scene = ss.Scene.example(name)  # type: ignore[arg-type]
    few = {"time.increments": 2} if name == "gmsh" else {"time.increments": 2, "mesh.elements": [6, 4, 3][: 3 if name == "cube" else 2]}
    result, expected = ss.run(scene, few), ss.run(INIT / f"{file}.toml", few)
    assert (result.u == expected.u).all() and result.report["title"] == expected.report["title"]
    assert (ss.run(ss.Scene.from_file(INIT / f"{file}.toml"), few).u == expected.u).all()
    for again in (pickle.loads(pickle.dumps(result)), pickle.loads(pickle.dumps(scene))):
        assert (ss.run(again, few) if isinstance(again, ss.Scene) else again).p_n[-1] == pytest.approx(expected.p_n[-1])
    assert name in ss.Scene.examples() and len(repr(scene)) < 120


def test_a_scene_is_changed_without_its_source() -> None:
    scene = ss.Scene.example("gmsh")
    other = scene.material(young=1e9, poisson=0.3)
    assert ss.Model(other).problem.n_c == ss.Model(scene).problem.n_c
    keys = scene.to_dict()
    keys["material"]["young"] = 0
    assert scene.to_dict()["material"]["young"] == 3e9


@pytest.mark.filterwarnings("ignore::stickslip.NotConvergedWarning")
def test_a_sweep_has_all_combinations() -> None:
    vary = {"contact.friction": [0.2, 0.4], ("time.end", "time.increments"): [(1.0, 5), (2.0, 10)]}
    sweep = ss.sweep(block(n=6), vary, workers=3).check()
    assert len(sweep) == 4 and sweep.values[1] == {"contact.friction": 0.2, "time.end": 2.0, "time.increments": 10}
    for values, result in zip(sweep.values, sweep):
        assert (ss.run(block(n=6), values).p_t == result.p_t).all() and result.kept == (len(result.t) - 1,)
    table = sweep.table({"sum": lambda result: result.p_n[-1].sum()})
    assert list(table) == ["contact.friction", "time.end", "time.increments", "status", "error", "increments", "friction_work", "sum"]
    assert needs("pandas") and sweep.to_pandas()["increments"].tolist() == [5, 10, 5, 10]
    assert len(pickle.loads(pickle.dumps(sweep))) == 4
    part = sweep[1:3]
    assert type(part) is ss.Sweep and list(part) == list(sweep)[1:3] and part.values == sweep.values[1:3]
    failed = ss.sweep(block(n=6, setting="paper"), {"solver.max_iterations": [1, 50]})
    assert failed.converged.tolist() == [False, True] and "1 not converged" in repr(failed)
    with pytest.raises(ss.NotConverged):
        failed.check()


def test_a_sweep_warns_where_it_was_called() -> None:
    with pytest.warns(ss.AccuracyWarning) as warned:
        ss.sweep(SCENES / "confined.toml", {"contact.friction": [0.3, 0.4]})
    assert {w.filename for w in warned} == {__file__}


def test_a_sweep_warns_once_of_each_kind_and_names_the_runs() -> None:
    vary = {"contact.friction": [0.3, 0.4, 0.5, 0.6, 0.7], ("load[0].traction[1]", "time.increments"): [(-50e3, 20)]}
    with pytest.warns(UserWarning) as warned:
        sweep = ss.sweep(ss.Scene.example("block"), vary, overrides={"mesh.elements": [8, 4]})
    said = [(w.category, str(w.message)) for w in warned]
    kinds = {warning["kind"] for result in sweep for warning in result.warnings}
    assert len(said) == 1 + len(kinds) and len({message for _, message in said}) == len(said)
    failed = [k for k, result in enumerate(sweep) if not result.converged]
    name = "contact.friction={}, load[0].traction[1]=-50000.0, time.increments=20".format
    assert failed == [0] and said[0] == (ss.NotConvergedWarning, f"1 of 5 runs did not converge ({name(0.3)}): {sweep[0].message}")
    edges = [k for k, result in enumerate(sweep) if any(warning["kind"] == "singular-edge" for warning in result.warnings)]
    assert edges == [0, 1, 2, 3, 4]
    message = next(warning["message"] for warning in sweep[0].warnings if warning["kind"] == "singular-edge")
    runs = f"{name(0.3)}; {name(0.4)}; {name(0.5)}; and 2 more"
    assert (ss.AccuracyWarning, f"singular-edge: in 5 of 5 runs ({runs}); the first: {message}") in said
    with pytest.raises(ss.NotConverged, match=r"^contact.friction=0.3, load\[0\].*: slips in increment"):
        sweep.check()


def test_a_wrong_value_is_found_before_anything_is_solved() -> None:
    began = time.monotonic()
    with pytest.raises(ss.SceneError) as caught:
        ss.sweep(block(n=40, increments=200), {"contact.friction": [0.2, -0.4]})
    assert caught.value.key == "contact[0].friction" and time.monotonic() - began < 20


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_control_c_ends_a_sweep() -> None:
    signal.signal(signal.SIGINT, signal.default_int_handler)
    thread = threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))
    scene = block(n=40, increments=4000)
    with pytest.raises(KeyboardInterrupt):
        thread.start()
        ss.sweep(scene, {"contact.friction": [0.1 * k for k in range(1, 9)]}, linear="faer", workers=2)
        time.sleep(60)
    thread.join()


def test_other_increments_end_at_the_kinks_of_the_loads() -> None:
    result = ss.run(block(n=8), {"time.increments": 3})
    assert result.model is not None
    assert result.t == pytest.approx([2 / 3, 1.0, 4 / 3, 2.0]) and (result.model.t == ss.Model(block(n=8)).with_({"time.increments": 3}).t).all()
    assert (pickle.loads(pickle.dumps(result)).model.t == result.model.t).all()


def test_a_cycle_is_reported_as_by_the_program() -> None:
    scene = block(n=6, increments=8).to_dict()
    scene["output"] = {"cycle": [1.0, 2.0]}
    assert "cycle" in ss.run(scene).report


def test_a_quantity_that_raises_is_named_with_the_values_of_its_run() -> None:
    sweep = ss.sweep(block(n=4), {"contact.friction": [0.4, 0.5]}, workers=1)

    def work(result: ss.Result) -> float:
        if result.mu[0, 0] > 0.45:
            raise KeyError("energy")
        return result.friction_work

    with pytest.raises(ValueError, match=r"quantities\['W'\] of contact.friction=0.5: KeyError: 'energy'") as raised:
        sweep.table({"W": work})
    assert isinstance(raised.value.__cause__, KeyError)
    table = sweep.table()
    assert table["friction_work"] == [result.friction_work for result in sweep] and min(table["friction_work"]) > 0


def test_the_quantities_are_those_of_the_program(tmp_path: Path) -> None:
    names = ["largest_pressure.pressure", "size:largest_force.force", "max:bottom.f_x", "last:right.u_x", "largest_pressure.boundary", "totals.iterations"]
    scene = tmp_path / "block.toml"
    scene.write_text(ss.Model(block(n=6))._core.text)
    sweep = ss.sweep(scene, {"contact.friction": [0.2, 0.4]})
    told = json.loads(program("sweep", str(scene), "--vary", "contact.friction=0.2,0.4", "--table", ",".join(names), "--json").stdout)
    table = sweep.table([*names, "friction_work", "status"])
    assert list(table)[5:] == names and table["friction_work"] == [result.friction_work for result in sweep]
    for name in names:
        values = [variant["quantities"][name] for variant in told["variants"]]
        assert table[name] == (values if isinstance(values[0], str) else pytest.approx(values, rel=1e-12))
    assert sweep.table("peak")["peak"] == sweep.table({"p": "largest_pressure.pressure"})["p"] == table[names[0]]
    assert sweep[0].quantity("cycle.regime") is None
    with pytest.raises(ValueError, match=r"quantities\['max:botom.f_x'\] of contact.friction=0.2: .*did you mean bottom"):
        sweep.table(["force", "max:botom.f_x"])


def test_quantities_are_si_and_in_the_plane_per_depth() -> None:
    plain, result = (ss.run(block(n=6), overrides) for overrides in ({}, {"material.thickness": 0.02}))
    for name in ("peak", "force", "friction_work", "last:right.u_x", "stick_ratio"):
        assert result.quantity(name) == pytest.approx(plain.quantity(name), rel=1e-9)
    assert result.quantity("force") == pytest.approx(result.report["largest_force"]["magnitude"] / 0.02)
    assert result.quantity("friction_work") == pytest.approx(result.friction_work)
    seal = ss.run(SCENES / "seal.toml")
    assert seal.quantity("peak") == pytest.approx(1e6 * seal.report["largest_pressure"]["pressure"])


@pytest.mark.parametrize("vary, twice", [
    ({"contact.friction": [0.2], "contact[0].friction": [0.3]}, r"'contact\[0\].friction' is there twice, once as 'contact.friction'"),
    ({("contact.friction", "contact.friction"): [(0.2, 0.3)]}, "'contact.friction' is there twice$"),
    ({("contact.friction", "contact[1].friction"): [(0.2, 0.3)]}, "is there twice, once as"),
    ({"mesh.elements[0]": [4], "mesh.elements": [[4, 4]]}, r"'mesh.elements' is there twice, once as 'mesh.elements\[0\]'"),
])
def test_a_key_of_a_sweep_is_there_once(vary: dict[object, list[object]], twice: str) -> None:
    with pytest.raises(ValueError, match=f"^vary: .*{twice}"):
        ss.sweep(block(n=4, increments=2), vary)  # type: ignore[arg-type]


def test_columns_of_a_sweep_are_its_own_and_stay() -> None:
    sweep = ss.sweep(block(n=4, increments=2), {"load[0].traction[1]": [-1e6, -2e6], "load[1].traction[0]": [-1e6]})
    for name in ("status", "load[0].traction[1]"):
        with pytest.raises(ValueError, match="^quantities.*: the table has a column of this name"):
            sweep.table({name: len})  # type: ignore[dict-item]
    nothing = pickle.loads(pickle.dumps(sweep[0:0]))
    assert list(nothing.table()) == list(sweep.table()) and nothing.table()["status"] == [] and len(nothing[:].table()) == 6
    assert repr(nothing) == "<Sweep of load[0].traction[1], load[1].traction[0]: 0 results>"
