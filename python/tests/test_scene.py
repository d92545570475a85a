"""Scenes: the same numbers as the program, arrays, errors with places, interrupts."""

from __future__ import annotations

import json
import os
import pickle
import shutil
import signal
import subprocess
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import stickslip as ss
from scenes import SCENES, block

#: Reduced, so that each takes a second at most.
REDUCED: dict[str, dict[str, object]] = {
    "block": {"mesh.elements": [10, 10]},
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
    pytest.importorskip("tqdm")
    ss.Model(block()).run(progress=True)
    assert "10/10" in capsys.readouterr().err


def test_results_are_saved_and_loaded(tmp_path: Path) -> None:
    result = ss.run(block())
    result.save(tmp_path / "run.npz")
    again = ss.Result.load(tmp_path / "run.npz")
    assert (again.u == result.u).all() and again.records == result.records and again.kept == result.kept
    assert (again.displacement() == result.displacement()).all()
    assert (pickle.loads(pickle.dumps(result)).p_n == result.p_n).all()
    assert "Christensen" in ss.cite(again)
