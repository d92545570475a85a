"""Scenes: the same numbers as the program, arrays, errors with places, interrupts."""

from __future__ import annotations

import json
import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
import warnings
from pathlib import Path

import numpy as np
import pytest

import stickslip as ss
from scenes import SCENES, block, needs
from stickslip.builder import plane

#: Reduced, so that each takes a second at most.
REDUCED: dict[str, dict[str, object]] = {
    "block": {"mesh.elements": [10, 10]},
    "bolt": {},
    "boxed": {},
    "cattaneo_mindlin": {"mesh.elements": [[6, 8, 6], 8]},
    "confined": {},
    "cube": {"mesh.elements": [3, 3, 3]},
    "cycles": {},
    "disk": {"mesh.elements": [6, 6, 3]},
    "frictionless": {"mesh.elements": [10, 10]},
    "held_by_contact": {},
    "hertz_line": {"mesh.contact_elements": 8, "mesh.outer_elements": 8, "mesh.layers": 6},
    "hertz_sphere": {"mesh.elements": [[4, 3], [4, 3], 5]},
    "mindlin_sphere": {"mesh.elements": [[2, 4, 2], [2, 2], 3]},
    "punch": {"mesh.contact_elements": 8, "mesh.outer_elements": 8, "mesh.layers": 4},
    "seal": {"mesh.elements": [8, 8]},
    "ssnv128": {},
    "strip": {"mesh.elements": [40, 4]},
    "tilted_punch": {},
    "tip": {"mesh.elements": [8, 5, 3]},
    "turning_load": {"mesh.elements": [8, 8]},
    "two_blocks": {},
    "wedge": {},
}


def program() -> str | None:
    """The program, if it is built: STICKSLIP_PROGRAM, or on the path."""
    return os.environ.get("STICKSLIP_PROGRAM") or shutil.which("stickslip")


def same(a: object, b: object, where: str = "") -> None:
    """Equal to rounding: numbers to 1e-9 of the larger, all else exactly."""
    if isinstance(a, dict) and isinstance(b, dict):
        assert a.keys() == b.keys(), where
        for key in a.keys() - NOT_COMPARED:
            same(a[key], b[key], f"{where}.{key}")
    elif isinstance(a, list) and isinstance(b, list):
        assert len(a) == len(b), where
        for k, (x, y) in enumerate(zip(a, b)):
            same(x, y, f"{where}[{k}]")
    elif isinstance(a, float) or isinstance(b, float):
        assert a == pytest.approx(b, rel=1e-9, abs=1e-300), where
    else:
        assert a == b, where


#: Where it was read from, how long it took, and what is rounding itself.
NOT_COMPARED = {
    "scene", "scene_text", "title", "seconds", "cpu_seconds", "wall_seconds", "model_seconds", "peak_rss_bytes", "kkt", "theta",
    "backward_error", "blas", "solver_choice", "residual", "imbalance",
}


@pytest.mark.skipif(program() is None, reason="the program is not built")
@pytest.mark.parametrize("name", REDUCED)
def test_a_scene_is_what_the_program_says(name: str) -> None:
    overrides = {**REDUCED[name], "time.increments": 4, "solver.linear": "faer"}
    words = [f"--set={key}={json.dumps(value)}" for key, value in overrides.items()]
    path = SCENES / f"{name}.toml"
    done = subprocess.run([str(program()), "run", str(path), "--json", *words], capture_output=True, text=True)
    said = json.loads(done.stdout)
    with pytest.warns(ss.NotConvergedWarning) if said["status"] != "converged" else _no_warning():
        result = ss.run(path, overrides, linear=None)
    assert result.status == said["status"]
    for key in ("increments", "forces", "final", "unknowns"):
        same(result.report[key], said[key], key)


class _no_warning:
    def __enter__(self) -> None: ...

    def __exit__(self, *_: object) -> None: ...


@pytest.mark.parametrize("path", sorted(SCENES.glob("*.toml")), ids=lambda path: path.stem)
def test_every_scene_is_discretised(path: Path) -> None:
    model = ss.Model(path, REDUCED[path.stem])
    p = model.problem
    assert p.C_n.shape == (p.n_c, p.n_u) and len(p.C_t) == model.dimension - 1
    assert model.frames.shape == (p.n_c, model.dimension, 3)
    np.testing.assert_allclose(np.linalg.norm(model.frames[:, 0], axis=1), 1.0, rtol=1e-12)
    assert sum(len(nodes) for _, nodes in model.cells) == len(model._core.cells())


def test_arrays_have_the_documented_shapes() -> None:
    model = ss.Model(block())
    result = model.run().check()
    m, n_u, n_c = 10, model.problem.n_u, model.problem.n_c
    assert (n_u, n_c) == (220, 10)
    assert result.u.shape == result.u_rest.shape == result.force.shape == (m, n_u)
    assert result.p_n.shape == result.gap.shape == result.mu.shape == result.contact.shape == (m, n_c)
    assert result.p_t.shape == result.w_t_last.shape == (m, n_c, 1)
    assert result.errors.shape == (m, 6) and result.error < 1e-10
    assert result.displacement().shape == (121, 3) and result.stress().shape == (100, 6)
    assert list(model.boundaries) == ["bottom"] and len(model.boundaries["bottom"]) == n_c
    history = model.history
    np.testing.assert_allclose(history["force"], result.force, rtol=0, atol=1e-9 * abs(result.force).max())
    assert len(result.iterations) >= m and set(result.iterations.increment) == set(range(1, m + 1))


def test_stresses_are_in_equilibrium_with_the_load() -> None:
    # In a block that is only pressed from above, the mean of the vertical stress is the pressure.
    scene = block(friction=0.0).to_dict()
    scene["load"], scene["support"] = scene["load"][:1], [{"boundary": "left", "fix": ["x"]}]
    scene["material"]["poisson"] = 0.0
    result = ss.run(scene).check()
    np.testing.assert_allclose(result.stress()[:, 1], -10e6, rtol=1e-9)


def test_the_same_scene_as_file_text_dictionary_and_builder() -> None:
    path = SCENES / "block.toml"
    overrides = {"mesh.elements": [5, 5], "time.increments": 4}
    import stickslip._scene as scene

    first = ss.run(path, overrides)
    assert (ss.run(path.read_text(), overrides).u == first.u).all()
    builder = block(n=5, increments=4, setting="paper")
    assert (ss.run(builder).u == ss.run(builder.to_dict()).u).all()
    assert (ss.run(scene.to_toml(builder.to_dict())).u == ss.run(builder).u).all()


def test_the_units_of_the_user_give_the_same_body() -> None:
    scene = block(n=5).to_dict()
    expected = ss.run(scene)
    scene["units"] = {"length": "mm", "stress": "MPa"}
    scene["mesh"]["size"] = [1000.0, 1000.0]
    scene["material"]["young"] = 210e3
    scene["contact"][0]["obstacle"]["gap"] = 1e-2
    for load in scene["load"]:
        load["traction"] = [t * 1e-6 for t in load["traction"]]
    result = ss.run(scene)
    np.testing.assert_allclose(result.p_n, expected.p_n, rtol=1e-9, atol=1e-9 * expected.p_n.max())
    assert result.report["units"]["length"]["name"] == "mm"


def test_errors_are_exceptions_with_a_place() -> None:
    with pytest.raises(ss.SceneError) as caught:
        ss.run("title = 'x'\n[mesh]\nkind = \"block\"\nsize = [1, -1]\nelements = [2, 2]\n")
    assert caught.value.line is not None and caught.value.file == "scene"
    bad = block().to_dict()
    bad["contact"][0]["friction"] = -0.1
    with pytest.raises(ss.SceneError, match="friction") as caught:
        ss.run(bad)
    assert caught.value.key == "contact[0].friction"
    again = pickle.loads(pickle.dumps(caught.value))
    assert (again.line, again.key, again.help) == (caught.value.line, caught.value.key, caught.value.help)
    with pytest.raises(FileNotFoundError):
        ss.run("nowhere.toml")
    with pytest.raises(ValueError, match="frction"):
        ss.run(block(), {"contact.frction": 0.3})
    with pytest.raises(TypeError, match="scene"):
        ss.run(3)  # type: ignore[arg-type]


@pytest.mark.parametrize("change, message, help", [
    (lambda s: s["time"].pop("end"), "end", r"help\(stickslip.builder\)"),
    (lambda s: s.update(material=[s["material"]]), "material", "give a dictionary"),
    (lambda s: s.update(contact=s["contact"][0]), "contact", "give a list of dictionaries"),
    (lambda s: s["contact"][0].update(friction="much"), r"contact\[0\]\.friction", ""),
    (lambda s: s["mesh"].update(size=[1.0, -1.0]), "mesh.size", ""),
])
def test_errors_of_a_dictionary_lead_with_its_key(change: object, message: str, help: str) -> None:
    scene = block().to_dict()
    change(scene)  # type: ignore[operator]
    with pytest.raises(ss.SceneError, match=message) as caught:
        ss.run(scene)
    words = str(caught.value)
    assert caught.value.line is None and "scene:" not in words and "stickslip init" not in words and "[[" not in words
    assert re.search(help, caught.value.help) and words.startswith(caught.value.key or "missing")


def test_warnings_of_the_run_are_warnings_of_python() -> None:
    with pytest.warns(ss.AccuracyWarning, match="increments-force: ") as warned:
        result = ss.run(SCENES / "confined.toml")
    assert {w.filename for w in warned} == {__file__} and len(warned) == len(result.warnings)
    kinds = [warning["kind"] for warning in result.warnings]
    assert kinds == [warning["kind"] for warning in result.report["warnings"]]
    assert all(kind in repr(result) and kind in result._repr_html_() for kind in kinds)
    with pytest.warns(ss.AccuracyWarning) as warned:
        ss.Model(SCENES / "confined.toml").run()
    assert {w.filename for w in warned} == {__file__}
    # Without anything to say nothing is said, and of a saved result it was said before.
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fine = ss.run(SCENES / "frictionless.toml", REDUCED["frictionless"])
        assert not fine.warnings and "warning" not in repr(fine) and "arning" not in fine._repr_html_()
        pickle.loads(pickle.dumps(result))
    said = " ".join(warning["message"] for warning in [*result.warnings, *ss.run(SCENES / "tip.toml", REDUCED["tip"]).warnings])
    assert said and "stickslip " not in said


FORK = """
import multiprocessing, sys
import stickslip as ss
def one(friction):
    return float(ss.run(sys.argv[1], {"contact.friction": friction, "mesh.elements": [10, 10], "time.increments": 2}).p_n[-1].sum())
def stepped(force):
    return float(stepper.step(force).p_n.sum())
if __name__ == "__main__":
    import warnings
    warnings.simplefilter("ignore")
    expected = [one(0.2), one(0.3)]
    model = ss.Model(sys.argv[1], {"mesh.elements": [10, 10], "time.increments": 2})
    stepper = model.problem.stepper(gap=model.history["gap"][0])
    fork = multiprocessing.get_context("fork")
    with fork.Pool(2) as pool:
        assert pool.map_async(one, [0.2, 0.3]).get(timeout=60) == expected
    with fork.Pool(1) as pool:
        found = pool.map_async(stepped, [model.history["force"][0]]).get(timeout=60)
    assert found == [stepped(model.history["force"][0])]
    # Threads of a child, and the child of a child.
    def child(queue):
        from concurrent.futures import ThreadPoolExecutor
        with ThreadPoolExecutor(2) as threads:
            queue.put(list(threads.map(one, [0.2, 0.3])))
        grandchild = fork.Process(target=lambda: queue.put([one(0.2), one(0.3)]))
        grandchild.start()
        grandchild.join(60)
    queue = fork.Queue()
    process = fork.Process(target=child, args=(queue,))
    process.start()
    assert [queue.get(timeout=60), queue.get(timeout=60)] == [expected, expected]
    process.join(60)
    print("done")
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="fork")
def test_processes_that_were_forked_compute_as_their_parent() -> None:
    command = [sys.executable, "-c", FORK, str(SCENES / "block.toml")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.stdout.strip() == "done", done.stderr


def test_no_convergence_is_a_warning_and_check_raises() -> None:
    with pytest.warns(ss.NotConvergedWarning, match="max-iterations") as warned:
        result = ss.run(block(max_iterations=1, setting="paper"))
    assert warned[0].filename == __file__
    with pytest.raises(ss.NotConverged) as caught:
        result.check()
    assert caught.value.result is result and result.reason
    assert "#cf222e" in result._repr_html_()


def test_callbacks_see_increments_and_can_stop() -> None:
    seen: list[int] = []
    ss.run(block(), callback=lambda index, *_: seen.append(index))
    assert seen == list(range(1, 11))

    class Enough(Exception):
        pass

    def stop(index: int, *_: object) -> None:
        if index == 3:
            raise Enough

    with pytest.raises(Enough):
        ss.run(block(), callback=stop)


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_control_c_ends_a_run_within_a_fifth_of_a_second() -> None:
    # A shell that starts the tests in the background has the interpreter ignore the signal.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    model = ss.Model(block(n=60, increments=400))
    sent: list[tuple[float, float]] = []

    def send() -> None:
        time.sleep(0.3)
        sent.append((time.monotonic(), time.process_time()))
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=send)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        model.run(linear="faer")
        # A run that is done before the signal is no test of it.
        time.sleep(60)
    # On a machine that others use, too, the time of this process alone counts.
    late = min(time.monotonic() - sent[0][0], time.process_time() - sent[0][1])
    thread.join()
    assert late < 0.2


def test_progress_is_a_bar(capsys: pytest.CaptureFixture[str]) -> None:
    needs("tqdm")
    ss.Model(block()).run(progress=True)
    assert "10/10" in capsys.readouterr().err


def test_results_are_saved_and_loaded(tmp_path: Path) -> None:
    result = ss.run(block())
    result.save(tmp_path / "run.npz")
    again = ss.load(tmp_path / "run.npz")
    assert (again.u == result.u).all() and again.records == result.records and again.kept == result.kept
    assert (again.displacement() == result.displacement()).all()
    assert (pickle.loads(pickle.dumps(result)).p_n == result.p_n).all()
    assert "Christensen" in ss.cite(again)


@pytest.mark.filterwarnings("ignore")
def test_results_do_not_depend_on_the_files_of_their_scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for file in ("roller.toml", "roller.msh"):
        shutil.copy(SCENES.parent / "init" / file, tmp_path / file)
    (tmp_path / "floor.csv").write_text("x,gap\n-1,0\n1,1e-5\n")
    monkeypatch.chdir(tmp_path)
    scene = block(n=6, increments=2).to_dict()
    scene["contact"][0]["obstacle"] = {"kind": "table", "file": "floor.csv"}
    results = [ss.run("roller.toml", {"time.increments": 2}), ss.run(scene)]
    expected = [result.stress() for result in results]
    gaps = [result.model.history["gap"] for result in results if result.model]
    for k, result in enumerate(results):
        result.save(f"{k}.npz")
    frozen = [pickle.dumps(result) for result in results]
    # Other files of the same names, then none, seen from another folder.
    (tmp_path / "roller.msh").write_text("no mesh")
    (tmp_path / "floor.csv").write_text("x,gap\n-1,0\n1,5\n")
    for change in (lambda: None, lambda: [(tmp_path / name).unlink() for name in ("roller.msh", "floor.csv")], lambda: monkeypatch.chdir("/")):
        change()
        for k in range(2):
            for again in (ss.load(tmp_path / f"{k}.npz"), pickle.loads(frozen[k])):
                assert (again.stress() == expected[k]).all() and (again.model.history["gap"] == gaps[k]).all()
            # Once more, of what was loaded.
            again = ss.load(tmp_path / f"{k}.npz")
            again.save(tmp_path / "twice.npz")
            assert (ss.load(tmp_path / "twice.npz").stress() == expected[k]).all()


def test_results_on_meshes_in_memory_are_saved(tmp_path: Path) -> None:
    points = np.array([[0, 0], [0.5, 0], [1, 0], [0, 1], [0.5, 1], [1, 1]], dtype=float)
    sides = {"left": lambda x: x[:, 0] == 0, "right": lambda x: x[:, 0] == 1, "bottom": lambda x: x[:, 1] == 0, "top": lambda x: x[:, 1] == 1}
    cells = [("quad", [[0, 1, 4, 3]]), ("triangle", [[1, 2, 5], [1, 5, 4]])]
    scene = block().to_dict()
    del scene["mesh"]
    scene["material"]["group"] = [{"name": "soft", "young": 1e9, "poisson": 0.3}]
    result = ss.run(scene, mesh=ss.mesh.from_arrays(points, cells, sides, groups={"soft": [[], [0, 1]]}))
    result.save(tmp_path / "run.npz")
    for again in (ss.load(tmp_path / "run.npz"), pickle.loads(pickle.dumps(result))):
        assert (again.stress() == result.stress()).all() and again.model.boundaries.keys() == result.model.boundaries.keys()


def test_a_scene_is_written_for_the_command(tmp_path: Path) -> None:
    scene = block(4, 2)
    assert ss.Scene.from_toml(scene.to_toml()).to_dict() == scene.to_dict()
    assert scene.to_toml().startswith("title = ")
    scene.save(tmp_path / "block.toml")
    told = subprocess.run(
        [sys.executable, "-m", "stickslip", "run", "block.toml", "--json"], cwd=tmp_path, capture_output=True, text=True, check=True,
    )
    report = json.loads(told.stdout)
    assert report["friction"]["friction_work"] == pytest.approx(ss.run(scene).report["friction"]["friction_work"])
    with pytest.raises(TypeError, match="path: a str or os.PathLike expected, NoneType found"):
        scene.save(None)  # type: ignore[arg-type]


def test_files_in_memory_are_written_beside_a_scene(tmp_path: Path) -> None:
    scene = ss.Scene.example("gmsh")
    for _ in range(2):
        scene.save(tmp_path / "mine.toml")
    assert ss.run(tmp_path / "mine.toml").p_n == pytest.approx(ss.run(scene).p_n)
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "roller.msh").write_text("mine")
    with pytest.raises(ValueError, match=r"path: .*roller\.msh exists and is another file than the scene's roller\.msh"):
        scene.save(tmp_path / "other" / "mine.toml")
    assert not (tmp_path / "other" / "mine.toml").exists()
    outside = ss.Scene.example("gmsh")
    outside._files = {"../roller.msh": b""}
    with pytest.raises(ValueError, match="would not be written beside it"):
        outside.save(tmp_path / "mine.toml")


def test_a_scene_is_not_saved_away_from_the_files_that_it_names(tmp_path: Path) -> None:
    ss.Scene.example("gmsh").save(tmp_path / "mine.toml")
    scene = ss.Scene.from_file(tmp_path / "mine.toml")
    scene.save(tmp_path / "again.toml")
    (tmp_path / "other").mkdir()
    with pytest.raises(ValueError, match=r"path: the scene names roller\.msh, which is no copy of .*; copy it, or"):
        scene.save(tmp_path / "other" / "mine.toml")
    shutil.copy(tmp_path / "roller.msh", tmp_path / "other")
    scene.save(tmp_path / "other" / "mine.toml")


def test_texts_of_scenes_have_every_sign() -> None:
    scene = block(2, 1)
    scene._keys["title"] = '"ä" \U0001f600 \x7f \\ \n'
    assert ss.Scene.from_toml(scene.to_toml()).to_dict() == scene.to_dict()
    assert ss.Model(scene).title == scene._keys["title"]


def test_the_builder_names_keys_that_scenes_have() -> None:
    space = ss.Scene.example("cube").to_dict()["mesh"]
    scene = (
        ss.Scene({"mesh": space}).material(young=1e9, poisson=0.3, density=1e3, expansion=1e-5)
        .support("top", "x", "y", displacement=[0, 0], history=[[0, 0], [1, 1]]).support(None, "z", point=[0, 0, 0])
        .contact("bottom", [plane()], friction="0.1 + 0.2 * x", friction_history=[[0, 1], [1, 2]])
        .load(acceleration=[0, 0, -9.81]).load(temperature=20.0).load("front", traction=[0, 0, "-1e3 * z"])
        .time(end=1.0, increments=1)
    )
    model = ss.Model(scene)
    assert np.ptp(model.problem.mu) > 0
    for method in (ss.Scene.support, ss.Scene.load):
        assert "motion" not in (method.__doc__ or "") and "gravity" not in (method.__doc__ or "")


def test_stress_takes_off_the_thermal_strain_of_the_scene() -> None:
    scene = block(2, 1).load(temperature=20.0, history=[[0, 0], [2, 1]])
    scene = scene.material(young=1e9, poisson=0.3, expansion=1e-5)
    model = ss.Model(scene)
    free = model.stress(np.zeros(model.problem.n_u), 2.0)
    assert free[:, 0] == pytest.approx(-1e9 * 1e-5 * 20.0 / (1.0 - 2.0 * 0.3))
    assert model.stress(np.zeros(model.problem.n_u), 0.0) == pytest.approx(np.zeros_like(free))
    assert "is subtracted" in (ss.Model.stress.__doc__ or "")
    cases, factors = model.loads
    np.testing.assert_allclose(factors @ cases, model.history["force"], atol=1e-9)
    assert len(cases) == 3 and cases[1][::2].sum() == pytest.approx(-10e6)
