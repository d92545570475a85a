"""A chain of single increments is the history."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from scenes import block
from stickslip.newton import Natural

EXAMPLES = Path(__file__).parents[1] / "examples"


@pytest.mark.parametrize("linear", ["auto", "faer", "condensed"])
@pytest.mark.parametrize("method", ["bn", "ip"])
def test_a_chain_of_steps_is_the_history(method: str, linear: str) -> None:
    model = ss.Model(block(n=8, increments=8))
    problem, history = model.problem, model.history
    drift = history["drift"] + 1e-6 * np.arange(1, 9)[:, None, None]
    gap = history["gap"] - 1e-7 * np.arange(9)[:, None]
    whole = problem.solve(history["force"], gap=gap, drift=drift, t=model.t, method=method, linear=linear)
    stepper = problem.stepper(gap=gap[0], method=method, linear=linear)
    for k, time in enumerate(model.t):
        step = stepper.step(history["force"][k], t=time, gap=gap[k + 1], drift=drift[k])
        assert step.converged and step.t == [time] and stepper.t == time
        np.testing.assert_allclose(step.p_n[0], whole.p_n[k], atol=1e-9 * whole.p_n.max())
        np.testing.assert_allclose(step.u[0], whole.u[k], atol=1e-9 * abs(whole.u).max())
        assert (step.contact[0] == whole.contact[k]).all()


def test_the_pattern_is_analysed_once() -> None:
    model = ss.Model(block(n=8, increments=8))
    stepper = model.problem.stepper(gap=1e-5, linear="faer")
    for force in model.history["force"]:
        stepper.step(force)
    assert stepper.work["analyses"] == 1


class Counting:
    """scipy's LU, which counts."""

    def __init__(self) -> None:
        self.analyses = 0

    def analyze(self, n: int, indptr: np.ndarray, indices: np.ndarray) -> None:
        self.analyses += 1
        self.pattern = n, indptr, indices

    def factorize(self, data: np.ndarray) -> None:
        import scipy.sparse as sp
        from scipy.sparse.linalg import splu

        n, indptr, indices = self.pattern
        self.lu = splu(sp.csc_array((data, indices, indptr), shape=(n, n)))

    def solve(self, b: np.ndarray) -> np.ndarray:
        return self.lu.solve(b)


def test_a_solver_in_python_is_kept_over_the_increments() -> None:
    model = ss.Model(block(n=6, increments=4))
    own = Counting()
    stepper = model.problem.stepper(gap=1e-5, linear=own)
    steps = [stepper.step(force).check() for force in model.history["force"]]
    expected = ss.run(block(n=6, increments=4))
    np.testing.assert_allclose(steps[-1].p_n[0], expected.p_n[-1], atol=1e-9 * expected.p_n.max())
    assert own.analyses == 1


def test_a_step_that_failed_is_tried_again() -> None:
    model = ss.Model(ss.Scene.example("block"), {"mesh.elements": [8, 4]})
    force = model.history["force"]
    stepper = model.problem.stepper()
    stepper.step(force[0])
    sideways = force[0].copy()
    sideways[::2] += 1e3
    with pytest.warns(ss.NotConvergedWarning):
        assert not stepper.step(sideways).converged
    assert stepper.t == 1.0
    again = stepper.step(force[1])
    np.testing.assert_allclose(again.p_n[0], model.run().p_n[1], rtol=1e-8, atol=1e-6)


def test_what_cannot_be_is_refused() -> None:
    model = ss.Model(block(n=4, increments=4))
    stepper = model.problem.stepper(gap=1e-5)
    stepper.step(model.history["force"][0])
    with pytest.raises(ValueError, match="^t is 0.5, but the last increment ended at 1"):
        stepper.step(model.history["force"][1], t=0.5)
    with pytest.raises(ValueError, match="gap"):
        stepper.step(model.history["force"][1], gap=[1.0])
    with pytest.raises(ValueError, match="increments"):
        model.problem.stepper(method="events").step(model.history["force"][0])

    def again(*_: object) -> None:
        stepper.step(model.history["force"][1])

    with pytest.raises(RuntimeError, match="callback"):
        stepper.step(model.history["force"][1], callback=again)


@pytest.mark.parametrize("linear", ["auto", "faer", "condensed", None])
@pytest.mark.parametrize("method", ["bn", "ip"])
def test_an_increment_that_was_taken_back_leaves_nothing_behind(method: Any, linear: Any) -> None:
    model = ss.Model(block(n=8, increments=8))
    force = model.history["force"]
    chain = model.problem.stepper(gap=1e-5, method=method, linear=linear)
    expected = [chain.step(row).check() for row in force]
    stepper = model.problem.stepper(gap=1e-5, method=method, linear=linear)
    for k, row in enumerate(force):
        before = stepper.save()
        for other in (-0.5, 2.0):
            stepper.step(other * row + 0.1 * force[-1], gap=2e-5, drift=np.full(model.problem.n_c, 1e-6), mu=0.3).check()
            stepper.step(force[2], mu=0.5).check()
            assert stepper.t == k + 2.0
            stepper.restore(before)
            assert stepper.t == float(k)
        found = stepper.step(row).check()
        np.testing.assert_allclose(found.p_n, expected[k].p_n, rtol=0, atol=1e-10 * abs(expected[k].p_n).max())
        np.testing.assert_allclose(found.p_t, expected[k].p_t, rtol=0, atol=1e-10 * abs(expected[k].p_n).max())
        np.testing.assert_allclose(found.u, expected[k].u, rtol=0, atol=1e-10 * abs(expected[k].u).max())
        assert (found.gap == expected[k].gap).all() and (found.mu == expected[k].mu).all()


def test_states_are_of_one_stepper() -> None:
    problem = ss.Model(block(n=4, increments=4)).problem
    one, two = problem.stepper(), problem.stepper()
    with pytest.raises(ValueError, match="^state is that of another stepper"):
        two.restore(one.save())
    with pytest.raises(TypeError, match="^state"):
        two.restore(1.0)  # type: ignore[arg-type]
    for live in (one, one.save()):
        with pytest.raises(TypeError, match="pickle"):
            pickle.dumps(live)
    assert repr(one.save()) == "<StepperState at t = 0 s>"


def test_the_implicit_coupling_agrees_with_the_history_that_it_found(capsys: pytest.CaptureFixture[str]) -> None:
    code: dict[str, Any] = {"__name__": "example"}
    exec(compile((EXAMPLES / "thermoelastic.py").read_text(encoding="utf-8"), "thermoelastic.py", "exec"), code)
    model, results, warm = code["main"](increments=4)
    problem, force = model.problem, model.history["force"][-1]
    assert warm.max() > 10.0 and capsys.readouterr().out.count("iterations") == 4
    # The gaps that came out, prescribed: the same forces, and they make the heat that makes the gaps.
    gap = np.vstack([np.zeros(problem.n_c), *(result.gap for result in results)])
    times = np.array([result.t[0] for result in results])
    drift = code["speed"] * times[:, None] * np.ones(problem.n_c)
    whole = problem.solve(np.tile(force, (4, 1)), gap=gap, drift=drift, t=times).check()
    p_n = np.vstack([result.p_n for result in results])
    np.testing.assert_allclose(whole.p_n, p_n, rtol=0, atol=1e-8 * p_n.max())
    slip = np.vstack([np.zeros((1, problem.n_c)), *(problem.slip(u).T for u in whole.u)])
    slid = np.diff(slip - code["speed"] * np.r_[0.0, times][:, None], axis=0)
    temperature = -gap / code["growth"]
    heat = whole.p_t[:, :, 0] * slid / problem.weight
    balance = code["capacity"] * np.diff(temperature, axis=0) + code["dt"] * code["loss"] * temperature[1:] - heat
    assert abs(balance).max() < 1e-6 * heat.max()


def test_arrays_that_change_after_a_step_are_not_followed() -> None:
    problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    stepper, own = problem.stepper(), {"gap": np.array([1e-6]), "drift": np.array([[1e-6]]), "mu": np.array([0.2])}
    state = stepper.save()
    expected = [stepper.step([40.0, -100.0], **own), stepper.step([-30.0, -100.0])][1]
    stepper.restore(state)
    stepper.step([40.0, -100.0], **own)
    for array in own.values():
        array *= 5.0
    found = stepper.step([-30.0, -100.0])
    assert (found.gap == expected.gap).all() and (found.mu == expected.mu).all() and (found.p_t == expected.p_t).all()
    force = np.array([40.0, -100.0])
    natural = Natural(problem, force)
    force *= 2.0
    assert natural.force.tolist() == [40.0, -100.0]


@pytest.mark.parametrize("first", [True, False])
def test_a_callback_that_raises_leaves_the_stepper_where_it_was(first: bool) -> None:
    def refuse(*_: object) -> None:
        raise RuntimeError("refused")

    problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    stepper, other = problem.stepper(), problem.stepper()
    if not first:
        stepper.step([0.0, -100.0])
        other.step([0.0, -100.0])
    begun = stepper.t
    with pytest.raises(RuntimeError, match="refused"):
        stepper.step([40.0, -100.0], callback=refuse)
    assert stepper.t == begun
    result, expected = (one.step([40.0, -100.0]).check() for one in (stepper, other))
    assert stepper.t == other.t == begun + 1.0
    assert (result.p_t == expected.p_t).all() and (result.w_t_last == expected.w_t_last).all()
