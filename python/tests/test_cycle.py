"""What each contact node does in a part of a history, histories as one, and derivatives of forces."""

from __future__ import annotations

import csv
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from scenes import SCENES
from test_program import program

SMALL = {"mesh.elements": [10, 10], "time.increments": 20, "contact.obstacle.gap": 0.0}


def pushed() -> tuple[ss.Model, ss.Result]:
    model = ss.Model(ss.Scene.example("block"), SMALL)
    return model, model.problem.solve(**model.history)


def test_results_of_matrices_have_the_fields_of_the_scene() -> None:
    model = ss.Model(SCENES / "punch.toml", {"mesh.contact_elements": 6, "mesh.outer_elements": 6, "mesh.layers": 4})
    of_scene, of_matrices = model.run(linear="faer"), model.problem.solve(**model.history, linear="faer")
    for name in ("pressure", "traction", "slip", "opening"):
        size = np.abs(getattr(of_scene, name)).max()
        assert getattr(of_matrices, name) == pytest.approx(getattr(of_scene, name), abs=1e-9 * size), name
    again = pickle.loads(pickle.dumps(of_matrices))
    assert (again.slip == of_matrices.slip).all()
    with pytest.raises(ValueError, match="pressure: give the problem the lengths"):
        ss.ContactProblem(np.eye(2), [[0, -1]], [[1, 0]], mu=0.3).solve([0.0, -1.0]).pressure


def test_a_cycle_is_that_of_the_program(tmp_path: Path) -> None:
    scene = SCENES.parent / "tutorials" / "fretting.toml"
    model = ss.Model(scene, {f"body[{k}].mesh.elements": [[4, 16, 4], 4] for k in (0, 1)} | {"time.increments": 36})
    result = model.run(linear="faer")
    cycle = result.cycle(2.0)
    sets = [f"body[{k}].mesh.elements=[[4,16,4],4]" for k in (0, 1)] + ["time.increments=36"]
    words = [word for change in sets for word in ("--set", change)]
    program("run", str(scene), *words, "--out", str(tmp_path / "out"), "--quiet")
    rows = list(csv.DictReader((tmp_path / "out" / "cycle.csv").read_text().splitlines()))
    told = {name: np.array([float(row[name]) for row in rows]) for name in ("slip_path", "energy_density", "area")}
    assert len(told["area"]) == model.problem.n_c
    parts = [record["parts"] for record in result.records]
    assert max(parts) == 1
    assert cycle.slip_path == pytest.approx(told["slip_path"] * 1e-3, rel=1e-4, abs=1e-12)
    assert cycle.friction_work / model.problem.weight == pytest.approx(told["energy_density"] * 1e3, rel=1e-4, abs=1e-6)
    assert cycle.friction_work.sum() == pytest.approx(sum(r["friction_work"] for r in result.records[12:]), rel=1e-6)


def test_wrong_cycles() -> None:
    problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    forces = [[0.0, -100.0], [40.0, -100.0]]
    result = problem.solve(forces)
    for start, end, said in ((0.3, None, "start: no increment of the result begins or ends at 0.3 s"), (0.5, 0.5, "end: no increment that converged is between"), (0.0, 2.0, "end: no increment")):
        with pytest.raises(ValueError, match=said):
            result.cycle(start, end)
    assert result.cycle().pressed_path is None
    with pytest.raises(ValueError, match="increment 0 were not kept"):
        problem.solve(forces, keep_u="last").cycle(0.5)


def test_steps_put_together_are_the_history() -> None:
    model, whole = pushed()
    table, stepper = model.history, model.problem.stepper(gap=model.history["gap"][0])
    first, *later = [stepper.step(force, gap=gap) for force, gap in zip(table["force"], table["gap"][1:])]
    result = first.joined(*later)
    assert result.converged and len(result.t) == 20 and result.kept == tuple(range(20))
    assert result.p_n == pytest.approx(whole.p_n, abs=1e-7 * whole.p_n.max())
    assert result.cycle(10.0).friction_work == pytest.approx(whole.cycle(1.0).friction_work, rel=1e-5, abs=1e-12)
    assert [record["index"] for record in result.records] == list(range(1, 21)) and result.iterations.increment[-1] >= 20
    # Later increments alone know where they begin.
    tail = later[9].joined(*later[10:])
    for found, expected in ((tail.cycle(), result.cycle(10.0)), (later[9].cycle(), result.cycle(10.0, 11.0))):
        assert found.start == 10.0 and found.slip_path == pytest.approx(expected.slip_path, rel=1e-12, abs=1e-20)
        assert found.pressed_path == pytest.approx(expected.pressed_path, rel=1e-9, abs=1e-15)
    assert result.iterations.increment.max() <= 20 and tail.iterations.increment.max() <= 10
    with pytest.raises(ValueError, match="join all of the stepper's"):
        model.problem.derivative(tail, mu=1.0)
    other = ss.ContactProblem(np.eye(2), [[0, -1]], [[1, 0]], mu=0.3).solve([0.0, -1.0])
    for wrong in (first, later[1], whole, other):
        with pytest.raises(ValueError, match="does not begin where the one before ended"):
            first.joined(wrong)
    with pytest.raises(TypeError, match="results expected"):
        first.joined(3)  # type: ignore[arg-type]


def test_friction_of_each_node_of_a_scene() -> None:
    model = ss.Model(ss.Scene.example("block"), SMALL)
    field = np.random.default_rng(1).uniform(0.2, 0.6, model.problem.n_c)
    result = model.run(mu=field, linear="faer")
    expected = model.problem.solve(**{**model.history, "mu": field}, linear="faer")
    assert result.p_t == pytest.approx(expected.p_t, abs=1e-8 * expected.p_n.max()) and (result.mu[-1] == field).all()
    assert model.run(mu=0.4).quantity("force") == pytest.approx(model.run().quantity("force"), rel=1e-9)
    with pytest.raises(ValueError, match="mu: a checkpoint"):
        model.run(mu=field, checkpoint="a.ckpt")
    with pytest.raises(ValueError, match="mu"):
        model.run(mu=field[1:])


def directions(problem: ss.ContactProblem) -> dict[str, Any]:
    rng = np.random.default_rng(2)
    return {"mu": rng.uniform(0.5, 1.0, problem.n_c), "K": problem.K / 2.0, "gap": 1e-7 * rng.uniform(0.0, 1.0, problem.n_c)}


@pytest.mark.parametrize("name", ["mu", "K", "gap", "force"])
@pytest.mark.parametrize("scene", ["plane", "space"])
def test_derivatives_are_those_of_differences(name: str, scene: str) -> None:
    if scene == "plane":
        model = ss.Model(ss.Scene.example("block"), SMALL)
    else:
        model = ss.Model(SCENES / "cube.toml", {"mesh.elements": [3, 3, 3], "contact.obstacle.gap": 0.0, "time.increments": 8})
    problem, table = model.problem, model.history
    along = directions(problem) | {"force": table["force"]}
    result = problem.solve(table["force"], gap=0.0, tolerance=1e-13)
    found = problem.derivative(result, **{name: along[name]})
    ends = []
    h = 1e-6
    for sign in (1, -1):
        step = {key: sign * h * value for key, value in along.items() if key == name}
        mu, gap = problem.mu + step.get("mu", 0.0), step.get("gap", 0.0)
        changed = problem.with_(mu=mu, K=problem.K + step["K"] if "K" in step else None)
        ends.append(changed.solve(table["force"] + step.get("force", 0.0), gap=np.broadcast_to(gap, problem.n_c), tolerance=1e-13))
    # Where a status changes within the difference there is no derivative.
    same = (ends[0].contact == ends[1].contact).all(axis=1)
    until = len(same) if same.all() else int(np.argmin(same))
    assert until > len(same) // 2
    for value in ("p_n", "p_t", "u"):
        difference = (getattr(ends[0], value) - getattr(ends[1], value))[:until] / (2 * h)
        derivative = getattr(found, value)[:until]
        size = np.abs(getattr(result, value)).max()
        assert derivative == pytest.approx(difference, abs=2e-4 * np.abs(derivative).max() + 1e-7 * size), value


def test_a_fit_finds_friction_and_stiffness() -> None:
    model = ss.Model(ss.Scene.example("block"), SMALL)
    force = model.history["force"]
    measured = model.problem.with_(K=1.2 * model.problem.K, mu=0.46).solve(force)
    scale, mu = 1.0, 0.5
    for _ in range(8):
        problem = model.problem.with_(K=scale * model.problem.K, mu=mu)
        result = problem.solve(force)
        columns = [problem.derivative(result, **along).u.ravel() for along in ({"K": model.problem.K}, {"mu": 1.0})]
        step, *_ = np.linalg.lstsq(np.stack(columns, axis=1), (measured.u - result.u).ravel(), rcond=None)
        scale, mu = scale + step[0], mu + step[1]
    assert (scale, mu) == pytest.approx((1.2, 0.46), rel=1e-8)


def test_wrong_derivatives() -> None:
    problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    result = problem.solve([[0.0, -100.0], [40.0, -100.0]])
    for options, said in (({"mu": [1.0, 2.0, 3.0]}, "mu has the shape"), ({"K": np.eye(3)}, "K has the shape"), ({"gap": np.nan}, "gap")):
        with pytest.raises(ValueError, match=said):
            problem.derivative(result, **options)
    stiff = ss.ContactProblem(np.array([[2e6, 1e5], [1e5, 1e6]]), [[0, -1]], [[1, 0]], mu=0.3)
    for of, along, said in ((problem, {"K": np.tril(np.ones((2, 2)))}, "not symmetric"), (stiff, {"mu": 1.0}, "of another problem")):
        with pytest.raises(ValueError, match=said):
            of.derivative(result, **along)
    with pytest.raises(ValueError, match="displacements of all increments"):
        problem.derivative(problem.solve([[0.0, -100.0], [40.0, -100.0]], keep_u="last"))
