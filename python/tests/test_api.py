"""What scripts rely on: short reprs, pickles, keywords as words, names in errors, the names of scipy's results."""

from __future__ import annotations

import inspect
import pickle
import re
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest

import stickslip as ss
from scenes import block
from stickslip._options import Linear, Method, Setting
from stickslip.newton import Natural

HISTORY = {"force": [[0.0, -100.0], [40.0, -100.0]]}


def small() -> ss.ContactProblem:
    return ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)


def objects() -> dict[str, Any]:
    problem = small()
    result = problem.solve(HISTORY["force"])
    errors = ss.measure(problem, [40.0, -100.0], result.u[1], result.p_n[1], result.p_t[1])
    posed = ss.siconos.from_siconos(*ss.siconos.to_siconos(problem, [40.0, -100.0])[1:])
    table = ss.compare(problem, {"Newton": "bn"}, history=HISTORY)
    return {
        "problem": problem, "condensed": problem.condense(), "result": result, "errors": errors, "posed": posed, "table": table,
        "verdict": table["Newton"], "results": problem.solve_many([40.0, -100.0], mus=[0.1, 0.2]), "natural": Natural(problem, [40.0, -100.0]),
        "siconos": ss.siconos.to_siconos(problem, [40.0, -100.0]),
    }


@pytest.mark.parametrize("name", objects())
def test_reprs_are_short_and_all_but_live_objects_pickle(name: str) -> None:
    value = objects()[name]
    assert repr(value).startswith("<") and len(repr(value)) < 140
    again = pickle.loads(pickle.dumps(value))
    assert type(again) is type(value) and repr(again) == repr(value)


def test_results_have_the_names_of_scipy() -> None:
    result = small().solve(HISTORY["force"])
    assert result.converged is True and result.message == "converged" and result.nit == sum(r["iterations"] for r in result.records) > 0
    with pytest.warns(ss.NotConvergedWarning):
        failed = ss.Model(block(6)).problem.solve(ss.Model(block(6)).history["force"], gap=1e-5, max_iterations=1, setting="paper")
    assert failed.converged is False and failed.message.startswith("max-iterations in increment")


def test_words_are_those_of_the_core() -> None:
    problem = small()
    for method in get_args(Method):
        assert problem.solve([40.0, -100.0], method=method, setting=None, linear=None, tolerance=None).converged
    assert get_args(Setting) == ("default", "paper")
    for linear in get_args(Linear):
        if linear != "umfpack" or ss.UMFPACK:
            assert problem.solve([40.0, -100.0], linear=linear).converged
    for function in (problem.solve, problem.stepper):
        defaults = {name: p.default for name, p in inspect.signature(function).parameters.items()}
        assert defaults["method"] is defaults["setting"] is defaults["linear"] is defaults["tolerance"] is None


@pytest.mark.parametrize("name, raised, options", [
    ("method", ValueError, {"method": "newton"}), ("method", TypeError, {"method": 3}), ("setting", ValueError, {"setting": "magic"}),
    ("method", ValueError, {"method": "events", "setting": "paper"}),
    ("linear", ValueError, {"linear": "LU"}), ("linear", TypeError, {"linear": 3}), ("tolerance", TypeError, {"tolerance": "1e-9"}),
    ("tolerance", ValueError, {"tolerance": 0.0}), ("max_iterations", TypeError, {"max_iterations": True}),
    ("max_iterations", ValueError, {"max_iterations": 0}), ("r_factor", ValueError, {"r_factor": -1.0}),
])
def test_errors_begin_with_the_argument(name: str, raised: type[Exception], options: dict[str, Any]) -> None:
    for call in (lambda **o: small().solve([1.0, 1.0], **o), lambda **o: small().stepper(**o), lambda **o: small().solve_many([1.0, 1.0], mus=[0.1], **o)):
        with pytest.raises(raised, match=f"^{name}"):
            call(**options)


def test_a_missing_name_is_a_key_error_that_lists_the_others() -> None:
    with pytest.raises(KeyError, match="name is 'other', expected one of Newton"):
        ss.compare(small(), {"Newton": "bn"}, history=HISTORY)["other"]


def test_arguments_of_another_shape_are_named() -> None:
    p = small()
    for name, call in {
        "w_t_last": lambda: p.solve_increment([1.0, 1.0], w_t_last=[1.0, 2.0]), "u": lambda: p.slip([1.0]),
        "p_t": lambda: Natural(p, [0.0, 0.0]).residual([0.0, 0.0], [0.0], [1.0, 2.0]), "r": lambda: Natural(p, [0.0, 0.0], r=0.0),
        "drift": lambda: p.stepper().step([1.0, 1.0], drift=[1.0, 2.0]), "C_n": lambda: p.with_(C_n=[[1.0]]),
    }.items():
        with pytest.raises(ValueError, match=f"^{name} "):
            call()


def test_one_of_a_kind_is_said_in_the_singular() -> None:
    problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    result, many = problem.solve([40.0, -100.0]), problem.solve_many([40.0, -100.0], mus=[0.1])
    model = ss.Model(block(n=2, increments=1), {"time.end": 1.0})
    assert "; 1 increment, 1 iteration, " in repr(result) and "1 increment, 1 iteration<" in result._repr_html_()
    assert repr(many) == "<Results of 1 history, all converged>" and ", 1 increment, " in repr(model)
    assert repr(ss.compare(problem, {"Newton": "bn"}, history={"force": [[40.0, -100.0]]})).startswith("<Comparison of 1 solver, ")
    assert repr(ss.sweep(block(n=2), {"contact.friction": [0.9]})) == "<Sweep of contact.friction: 1 result, all converged>"
    assert repr(ss.Scene({"body": [{}, {}], "contact": [{}]})) == "<Scene '': 2 bodies, 1 contact>" and repr(ss.Svg("x")) == "<Svg of 1 character>"
    with pytest.raises(ValueError, match="^keep_u is .* of 1 increment$"):
        problem.solve([40.0, -100.0], keep_u=[1])


@pytest.mark.parametrize("kind, way", [
    (ss.CondensedProblem, r"condense\(\)"), (ss.Stepper, r"problem\.stepper\("), (ss.StepperState, "Stepper.save"),
])
def test_what_others_make_says_how(kind: Any, way: str) -> None:
    for arguments in ((), (np.eye(2), [[0, -1]], [[1, 0]], 0.3), (small(),)):
        with pytest.raises(TypeError, match=way):
            kind(*arguments)


@pytest.mark.parametrize("call", [ss.ContactProblem.solve, ss.ContactProblem.solve_many, ss.Model.run, ss.sweep])
def test_the_first_word_of_keep_u_is_its_default(call: Any) -> None:
    first = re.search(r"keep_u : \{?\"(\w+)\".*\n.*are kept\. \S", inspect.getdoc(call) or "")
    assert first and first[1] == inspect.signature(call).parameters["keep_u"].default


def test_the_natural_map_is_public() -> None:
    assert "newton" in ss.__all__ and ss.newton.Natural is Natural
    page = Path(__file__).parents[2] / "doc/python/api/matrices.md"
    assert "::: stickslip.newton\n" in page.read_text(encoding="utf-8")
