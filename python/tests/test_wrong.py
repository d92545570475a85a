"""Wrong input: an exception that names the argument, never a panic."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import stickslip as ss
from scenes import block

EYE, ROW = np.eye(3), np.array([[0.0, 0.0, 1.0]])


@pytest.mark.parametrize("name, arguments", [
    ("K", ([[1.0, 2.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], ROW, ROW, 0.1)),
    ("K", (EYE[:2], ROW, ROW, 0.1)),
    ("K", (EYE * np.nan, ROW, ROW, 0.1)),
    ("K", ("a word", ROW, ROW, 0.1)),
    ("^K is not positive semidefinite", (-EYE, ROW, ROW, 0.1)),
    ("^K has the number 1e\\+300", (1e300 * EYE, ROW, ROW, 0.1)), ("^C_n has the number", (EYE, 1e300 * ROW, ROW, 0.1)),
    ("C_n", (EYE, ROW[:, :2], ROW, 0.1)),
    ("C_t", (EYE, ROW, sp.csr_array((2, 3)), 0.1)),
    ("C_t", (EYE, ROW, (ROW, ROW, ROW), 0.1)),
    ("mu", (EYE, ROW, ROW, [0.1, 0.1])),
    ("mu", (EYE, ROW, ROW, -0.1)),
    ("mu", (EYE, ROW, ROW, np.nan)),
    ("mu", (EYE, ROW, ROW, "much")),
])
def test_matrices(name: str, arguments: tuple[object, ...]) -> None:
    with pytest.raises(ValueError, match=name):
        ss.ContactProblem(*arguments)  # type: ignore[arg-type]


@pytest.mark.parametrize("name, arguments", [
    ("weight", {"weight": [1.0, 2.0]}), ("weight", {"weight": 0.0}), ("free_motions", {"free_motions": [[1.0, 2.0]]}),
    ("free_motions", {"free_motions": [[1.0, 0.0, 0.0]]}),
])
def test_what_goes_with_matrices(name: str, arguments: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=name):
        ss.ContactProblem(EYE, ROW, ROW, 0.1, **arguments)  # type: ignore[arg-type]


@pytest.mark.parametrize("name, force, options", [
    ("force", [1.0, 2.0], {}), ("force", [1.0, np.nan, 0.0], {}), ("force", [[[1.0, 0.0, 0.0]]], {}),
    ("factors", [1.0, 0.0, 0.0], {"factors": [[1.0, 2.0]]}), ("factors", [1.0, 0.0, 0.0], {"factors": []}),
    ("gap", [1.0, 0.0, 0.0], {"gap": [0.0, 1.0]}), ("gap", [1.0, 0.0, 0.0], {"gap": [[0.0], [1.0], [2.0]]}),
    ("gap", [1.0, 0.0, 0.0], {"gap": np.nan}), ("drift", [1.0, 0.0, 0.0], {"drift": [1.0]}),
    ("t must", [1.0, 0.0, 0.0], {"t": [0.0]}), ("t has the shape", [1.0, 0.0, 0.0], {"t": [1.0, 2.0]}),
    ("method", [1.0, 0.0, 0.0], {"method": "newton"}), ("setting", [1.0, 0.0, 0.0], {"setting": "magic"}),
    ("linear", [1.0, 0.0, 0.0], {"linear": "magic"}), ("force", np.zeros((0, 3)), {}), ("tolerance", [1.0, 0.0, 0.0], {"tolerance": -1.0}),
    ("max_iterations", [1.0, 0.0, 0.0], {"max_iterations": 0}), ("r_factor", [1.0, 0.0, 0.0], {"r_factor": 0.0}),
    ("keep_u", [1.0, 0.0, 0.0], {"keep_u": "some"}), ("keep_u", [1.0, 0.0, 0.0], {"keep_u": [5]}),
    ("weight", [1.0, 0.0, 0.0], {"setting": "paper"}),
    ("gap has the number -1e\\+300, but", [1.0, 0.0, 0.0], {"gap": -1e300}), ("force has the number", [1e300, 0.0, 0.0], {}),
    ("drift has the number", [1.0, 0.0, 0.0], {"drift": [[1e300]]}), ("r_factor", [1.0, 0.0, 0.0], {"r_factor": 1e300}),
    ("r_factor", [1.0, 0.0, 0.0], {"r_factor": np.nan}),
])
def test_histories(name: str, force: object, options: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=f"^{name}" if name != "weight" else name):
        ss.ContactProblem(EYE, ROW, ROW[:, [2, 0, 1]], 0.1).solve(force, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("name, arguments", [
    ("force", {"force": [0.0]}), ("u", {"u": [0.0] * 2}), ("p_n", {"p_n": [0.0, 1.0]}), ("p_t", {"p_t": [0.0, 1.0]}),
    ("gap", {"gap": [0.0, 1.0]}), ("w_t_last", {"w_t_last": [0.0, 1.0]}), ("u", {"u": [0.0, 0.0, np.inf]}),
])
def test_answers(name: str, arguments: dict[str, object]) -> None:
    good: dict[str, object] = {"force": [0.0] * 3, "u": [0.0] * 3, "p_n": [0.0]}
    with pytest.raises(ValueError, match=name):
        ss.measure(ss.ContactProblem(EYE, ROW, ROW[:, [2, 0, 1]], 0.1), **{**good, **arguments})  # type: ignore[arg-type]


@pytest.mark.parametrize("name, arguments", [
    ("keep_u", {"keep_u": "some"}), ("linear", {"linear": "magic"}), ("max_iterations", {"max_iterations": 0}),
    ("tolerance", {"tolerance": 2.0}),
])
def test_runs(name: str, arguments: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=name):
        ss.run(block(), **arguments)


numbers = st.one_of(st.floats(allow_nan=True, allow_infinity=True), st.floats(-2, 2), st.just(0.0))


def arrays(rows: st.SearchStrategy[int], columns: st.SearchStrategy[int]) -> st.SearchStrategy[np.ndarray]:
    def of(shape: tuple[int, int]) -> st.SearchStrategy[np.ndarray]:
        size = shape[0] * shape[1]
        return st.lists(numbers, min_size=size, max_size=size).map(lambda values: np.array(values).reshape(shape))

    return st.tuples(rows, columns).flatmap(of)


def few(n: int) -> st.SearchStrategy[int]:
    """Mostly n."""
    return st.one_of(st.just(n), st.just(n), st.integers(0, 3))


@settings(max_examples=100, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(data=st.data())
@pytest.mark.filterwarnings("ignore::RuntimeWarning", "ignore::stickslip.NotConvergedWarning")
def test_random_input_is_an_answer_or_a_value_error(data: st.DataObject) -> None:
    half = data.draw(arrays(few(3), few(3)))
    K = half.T @ half if data.draw(st.booleans()) else half
    try:
        problem = ss.ContactProblem(
            K, data.draw(arrays(few(1), few(3))), data.draw(st.one_of(st.none(), arrays(few(1), few(3)))),
            data.draw(numbers), weight=data.draw(st.one_of(st.none(), numbers)),
        )
        force = data.draw(arrays(few(2), few(3)))
        result = problem.solve(
            force, gap=data.draw(st.one_of(numbers, arrays(few(3), few(1)))), t=data.draw(st.one_of(st.none(), st.just([1, 2]))),
            method=data.draw(st.sampled_from(["bn", "ip", "events"])), setting=data.draw(st.sampled_from(["default", "paper"])),
            linear=data.draw(st.sampled_from(["auto", "faer", "condensed"])), max_iterations=20,
        )
    except ValueError as error:
        assert any(name in str(error) for name in NAMES), error
        return
    assert isinstance(result.status, str) and len(result.t) <= len(force)


#: Every argument, and what `ContactProblem` calls K.
NAMES = ("K", "stiffness", "C_n", "C_t", "mu", "weight", "force", "gap", "t must", "factors", "method", "free motions", "drift")


@pytest.mark.parametrize("path", [None, 3, 1.5, b"bytes"])
def test_paths(path: object) -> None:
    result = ss.run(block(n=2, increments=1))
    for call in (
        result.save, ss.load, result.write_vtu, result.write_fclib, ss.Svg("x").save, ss.Scene.from_file, ss.exchange.read, ss.exchange.solve,
    ):
        with pytest.raises(TypeError, match=f"^path: a str or os.PathLike expected, {type(path).__name__} found"):
            call(path)  # type: ignore[arg-type]


TWO = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)


@pytest.mark.parametrize("call", [
    lambda: TWO.stepper().step(-5), lambda: TWO.solve_increment(-5), lambda: ss.measure(TWO, 5, [0.0, 0.0], [0.0]), lambda: ss.siconos.to_siconos(TWO, -5),
    lambda: ss.newton.Natural(TWO, -5),
])
def test_a_number_is_no_force_of_several_displacements(call: Callable[[], object]) -> None:
    with pytest.raises(ValueError, match=r"^force is a number, expected the shape \(2,\)"):
        call()
    assert ss.ContactProblem([[1e6]], [[-1]]).solve_increment(-5.0).p_n[0, 0] == 5.0


@pytest.mark.parametrize("message, call", [
    ("^force has masked entries", lambda: TWO.solve(np.ma.array([40.0, -100.0], mask=[False, True]))),
    ("^force has masked entries", lambda: TWO.solve([np.ma.array([40.0, -100.0], mask=[False, True])])),
    ("^K has masked entries", lambda: ss.ContactProblem(np.ma.array(np.eye(2), mask=[[0, 0], [0, 1]]), [[0, -1]])),
    ("^gap is no array of numbers: a truth value", lambda: TWO.solve([40.0, -100.0], gap=True)),
    ("^gap is no array of numbers: a word", lambda: TWO.solve([40.0, -100.0], gap="1")),
    ("^force is no array of numbers: .*inhomogeneous", lambda: TWO.solve([[1.0, 2.0], [3.0]])),  # type: ignore[list-item]
    ("^force is no array of numbers: int too large", lambda: TWO.solve([10**400, 0])),
    ("^force is complex", lambda: TWO.solve([1j, 0.0])),
    (r"^C_n has the shape \(2,\), expected rows and columns", lambda: ss.ContactProblem(np.eye(2), [0, -1], [1, 0], 0.3)),
])
def test_arrays_that_are_none(message: str, call: Callable[[], object]) -> None:
    with pytest.raises(ValueError, match=message):
        call()
    assert TWO.solve(np.ma.array([40.0, -100.0])).converged


@pytest.mark.parametrize("keep_u", [True, False, None, 5])
def test_a_step_keeps_u_or_not(keep_u: object) -> None:
    with pytest.raises((TypeError, ValueError), match="^keep_u is .*, expected 'all'|^keep_u is False, expected 'none'"):
        TWO.stepper().step([40.0, -100.0], keep_u=keep_u)  # type: ignore[arg-type]


@pytest.mark.parametrize("t", ["a", [1.0]])
def test_the_end_of_a_step_is_a_number(t: object) -> None:
    with pytest.raises(TypeError, match="^t is .*, expected a number"):
        TWO.stepper().step([40.0, -100.0], t=t)  # type: ignore[arg-type]


def test_rows_of_c_n_that_are_none() -> None:
    K = np.diag([2e6, 1e6, 2e6, 1e6])
    with pytest.raises(ValueError, match=r"C_n has the shape \(4, 2\), expected \(n_c, 4\): .* transposed: give C_n\.T"):
        ss.ContactProblem(K, np.array([[0, -1, 0, 0], [0, 0, 0, -1]]).T)
    with pytest.raises(ValueError, match=r"C_n has the shape \(1, 3\), expected \(n_c, 4\): a row for each contact node$"):
        ss.ContactProblem(K, [[0, -1, 0]])
    with pytest.raises(ValueError, match="C_n: row 1 is 0, .* leave the node out"):
        ss.ContactProblem(K, [[0, -1, 0, 0], [0, 0, 0, 0]], mu=0.0)
    problem = ss.ContactProblem(K, [[0, -1, 0, 0]])
    with pytest.raises(ValueError, match="C_n: row 0 is 0"):
        problem.with_(C_n=[[0, 0, 0, 0]])
