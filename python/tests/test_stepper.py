"""A chain of single increments is the history."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from scenes import block


@pytest.mark.parametrize("linear", ["auto", "faer", "condensed"])
@pytest.mark.parametrize("method", ["bn", "ip"])
def test_a_chain_of_steps_is_the_history(method: str, linear: str) -> None:
    model = ss.Model(block(n=8, increments=8))
    problem, history = model.problem, model.history
    drift = history["drift"] + 1e-6 * np.arange(1, 9)[:, None, None]
    gap = history["gap"] - 1e-7 * np.arange(9)[:, None]
    whole = problem.solve(history["force"], gap=gap, drift=drift, times=model.times, method=method, linear=linear)
    stepper = problem.stepper(gap=gap[0], method=method, linear=linear)
    for k, time in enumerate(model.times):
        step = stepper.step(history["force"][k], time=time, gap=gap[k + 1], drift=drift[k])
        assert step.converged and step.t == [time] and stepper.time == time
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
    model = ss.Model(block(n=6, increments=4))
    force = model.history["force"]
    stepper = model.problem.stepper(gap=1e-5)
    stepper.step(force[0])
    with pytest.warns(ss.NotConvergedWarning):
        assert not stepper.step(1e300 * np.ones(model.problem.n_u)).converged
    assert stepper.time == 1.0
    again = stepper.step(force[1])
    np.testing.assert_allclose(again.p_n[0], ss.run(block(n=6, increments=4)).p_n[1], rtol=1e-8, atol=1.0)


def test_what_cannot_be_is_refused() -> None:
    model = ss.Model(block(n=4, increments=4))
    stepper = model.problem.stepper(gap=1e-5)
    stepper.step(model.history["force"][0])
    with pytest.raises(ValueError, match="time"):
        stepper.step(model.history["force"][1], time=0.5)
    with pytest.raises(ValueError, match="gap"):
        stepper.step(model.history["force"][1], gap=[1.0])
    with pytest.raises(ValueError, match="increments"):
        model.problem.stepper(method="events").step(model.history["force"][0])

    def again(*_: object) -> None:
        stepper.step(model.history["force"][1])

    with pytest.raises(RuntimeError, match="callback"):
        stepper.step(model.history["force"][1], callback=again)
