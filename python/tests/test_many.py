"""One body, many problems: the same answers as one by one."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
import time
import tracemalloc
import weakref
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from scenes import SCENES, block, needs
from stickslip._history import few_loads

EXAMPLES = Path(__file__).parents[1] / "examples"


def fields(problem: ss.ContactProblem, n: int = 5) -> np.ndarray:
    return np.random.default_rng(0).uniform(0.1, 0.8, (n, problem.n_c))


def same(a: ss.Result, b: ss.Result) -> None:
    for name in ("p_n", "p_t"):
        np.testing.assert_allclose(getattr(a, name), getattr(b, name), rtol=0, atol=1e-12 * abs(b.p_n).max())
    assert (a.contact == b.contact).all() and (a.mu == b.mu).all() and (a.gap == b.gap).all()


@pytest.mark.parametrize("method", ["bn", "ip", "events"])
@pytest.mark.parametrize("linear", [None, "faer", "condensed"])
def test_many_are_as_one_by_one(method: Any, linear: Any) -> None:
    model = ss.Model(block(8))
    p, h = model.problem, model.history
    mus = fields(p)
    shared = {"gap": h["gap"], "method": method, "linear": linear}
    many = p.solve_many(*model.loads, mus=mus, workers=2, keep_u="all", **shared).check()
    assert len(many) == 5 and many.converged.all()
    for mu, result in zip(mus, many):
        anew = ss.ContactProblem(p.K, p.C_n, p.C_t, mu).solve(*model.loads, **shared).check()
        same(result, anew)
        np.testing.assert_allclose(result.u, anew.u, rtol=0, atol=1e-12 * abs(anew.u).max())
    for workers in (1, 3):
        again = p.solve_many(*model.loads, mus=mus, workers=workers, **shared)
        assert (again.stack("p_t") == many.stack("p_t")).all(), "threads change nothing, to the last bit"


def test_forces_gaps_and_friction_that_changes_differ_too() -> None:
    model = ss.Model(block(6))
    p, h = model.problem, model.history
    forces = [h["force"] * factor for factor in (0.5, 1.0)]
    gaps: list[Any] = [h["gap"], 2e-5]
    mus: list[Any] = [np.linspace(0.5, 0.3, 10)[:, None], 0.2]
    many = p.solve_many(forces=forces, gaps=gaps, mus=mus).check()
    for k, result in enumerate(many):
        same(result, p.solve(forces[k], gap=gaps[k], mu=mus[k]).check())
    assert many.stack("p_n").shape == (2, 10, p.n_c) and many.stack("u").shape == (2, 1, p.n_u)
    assert pickle.loads(pickle.dumps(many)).converged.all()


def test_a_failure_does_not_lose_the_others() -> None:
    model = ss.Model(ss.Scene.example("block"), {"mesh.elements": [8, 4]})
    p, h = model.problem, model.history
    forces = [h["force"], h["force"] + np.tile([1e3, 0.0], p.n_u // 2), h["force"][:3]]
    with pytest.warns(ss.NotConvergedWarning, match=r"1 of 3 histories did not converge \(1\)"):
        many = p.solve_many(forces=forces)
    assert many.converged.tolist() == [True, False, True] and not many[1].converged and many[1].message
    assert repr(many) == "<Results of 3 histories, 1 not converged: 1>"
    same(many[0], p.solve(h["force"]))
    stacked = many.stack("p_n")
    assert np.isfinite(stacked[0]).all() and np.isnan(stacked[2, 3:]).all() and np.isfinite(stacked[2, :3]).all()
    with pytest.raises(ss.NotConverged, match="history 1"):
        many.check()
    with pytest.raises(KeyError, match="name"):
        many.stack("q")


def test_dependent_contacts_share_their_force_here_too() -> None:
    p = ss.ContactProblem(np.eye(4), np.eye(4)[[0, 0]], np.eye(4)[[1, 1]], 0.3)
    many = p.solve_many(np.ones(4), mus=[0.3, 0.5]).check()
    for mu, result in zip((0.3, 0.5), many):
        assert result.p_t.sum() == pytest.approx(p.solve(np.ones(4), mu=mu).p_t.sum(), rel=1e-12)


@pytest.mark.parametrize("message, arguments", [
    (r"^mus\[1\] is negative", {"mus": [0.1, -0.1]}), (r"^mus\[0\] has the shape", {"mus": [[0.1] * 3]}),
    (r"^forces\[1\] has the shape", {"forces": [np.ones(4), np.ones(3)]}), (r"^gaps\[0\] is not finite", {"gaps": [np.nan]}),
    ("^forces, gaps and mus are missing", {}), ("^mus has 1 entry, gaps|^gaps has 2 entries, mus has 1 entry:", {"mus": [0.1], "gaps": [0.0, 0.0]}),
    ("^workers", {"mus": [0.1], "workers": 0}), ("^force is missing", {"mus": [0.1], "force": None}), ("^method", {"mus": [0.1], "method": "newton"}),
    ("^tolerance", {"mus": [0.1], "tolerance": 2.0}), ("weight", {"mus": [0.1], "setting": "paper"}), ("^gaps: give", {"gaps": [0.0], "gap": 1.0}),
])
def test_wrong_input_is_named_before_anything_is_computed(message: str, arguments: dict[str, Any]) -> None:
    p = ss.ContactProblem(np.eye(4), np.eye(4)[:1], np.eye(4)[1:2], 0.3)
    force = arguments.pop("force", None if "forces" in arguments else np.ones(4))
    with pytest.raises(ValueError, match=message):
        p.solve_many(force, **arguments)


def test_a_solver_of_ones_own_is_refused() -> None:
    class Own:
        analyze = factorize = solve = print

    with pytest.raises(TypeError, match="^linear"):
        ss.ContactProblem(np.eye(2), np.eye(2)[:1]).solve_many(np.ones(2), gaps=[0.0], linear=Own())  # type: ignore[typeddict-item]


@pytest.mark.parametrize("arguments", [
    {"workers": "2"}, {"workers": 1.5}, {"workers": 0}, {"workers": 2**70}, {"mus": 0.3}, {"mus": {0.1, 0.2}}, {"mu": 0.3},
    {"max_iterations": -1}, {"max_iterations": 2**70}, {"keep_u": [9]},
])
def test_arguments_of_another_kind_are_named(arguments: dict[str, Any]) -> None:
    problem = ss.ContactProblem(np.eye(2), np.eye(2)[:1], np.eye(2)[1:], 0.3)
    with pytest.raises((TypeError, ValueError), match=f"^{next(iter(arguments))} is"):
        problem.solve_many(np.ones(2), **{"mus": [0.1, 0.2], **arguments})


def test_an_interrupt_comes_out() -> None:
    # A shell that starts the tests in the background has the interpreter ignore the signal.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    model = ss.Model(block(30, increments=40))
    p, h = model.problem, model.history
    timer = threading.Timer(0.5, signal.raise_signal, (signal.SIGINT,))
    timer.start()
    begun = time.monotonic()
    try:
        with pytest.raises(KeyboardInterrupt):
            p.solve_many(*model.loads, gap=1e-5, mus=fields(p, 5000), keep_u="none")
            # Done before the signal on a very fast machine: then it comes here.
            time.sleep(5)
    finally:
        timer.cancel()
    assert time.monotonic() - begun < 30


def test_values_of_results_are_kept_in_the_order_of_the_input() -> None:
    model = ss.Model(block(6))
    p, mus = model.problem, fields(model.problem, 12)
    shared = {"gap": model.history["gap"], "keep_u": "all"}
    expected = [result.u.sum() for result in p.solve_many(*model.loads, mus=mus, **shared)]
    threads, alive, most = set(), weakref.WeakSet[ss.Result](), 0

    def reduce(result: ss.Result) -> float:
        nonlocal most
        threads.add(threading.get_ident())
        alive.add(result)
        most = max(most, len(alive))
        return float(result.u.sum())

    assert p.solve_many(*model.loads, mus=mus, workers=2, reduce=reduce, **shared) == expected
    assert threads == {threading.get_ident()} and most <= 2, "no result outlives its value"
    with pytest.raises(ZeroDivisionError):
        p.solve_many(*model.loads, mus=mus, workers=2, reduce=lambda result: 1 / 0, **shared)
    with pytest.raises(TypeError, match="^reduce: a function expected, str found"):
        p.solve_many(*model.loads, mus=mus, reduce="sum", **shared)
    with pytest.warns(ss.NotConvergedWarning, match=r"12 of 12 histories did not converge .*; 0: max-iterations"):
        assert p.solve_many(*model.loads, mus=mus, max_iterations=1, setting="paper", reduce=lambda r: r.converged, **shared) == [False] * 12


def test_memory_does_not_grow_with_histories_that_are_reduced() -> None:
    model = ss.Model(block(10, 40))
    small, mus = model.problem.condense(), fields(model.problem, 80)
    loads = small.reduce(model.history["force"])

    def of_a_history(reduce: Any) -> float:
        """kB."""
        tracemalloc.start()
        kept = small.solve_many(loads, gap=1e-5, mus=mus, workers=2, reduce=reduce)
        most = tracemalloc.get_traced_memory()[1] / len(kept) / 1e3
        tracemalloc.stop()
        return most

    assert of_a_history(None) > 50.0 > 15.0 > of_a_history(lambda result: result.p_t[-1].sum())


def test_progress_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    needs("tqdm")
    p = ss.ContactProblem(np.eye(4), np.eye(4)[:1], np.eye(4)[1:2], 0.3)
    p.solve_many(np.ones(4), mus=[0.1, 0.2], progress=True)
    assert "2/2" in capsys.readouterr().err


def test_other_friction_by_solve_is_another_problem() -> None:
    model = ss.Model(block(8))
    p, h = model.problem, model.history
    loads = {"gap": h["gap"]}
    for mu in (0.0, 0.2, fields(p)[0], np.where(np.arange(p.n_c) % 2, 0.3, 0.0)):
        anew = ss.ContactProblem(p.K, p.C_n, p.C_t, mu)
        same(p.solve(h["force"], mu=mu, **loads), anew.solve(h["force"], **loads))
        same(p.solve(h["force"], mu=mu, method="events", **loads), anew.solve(h["force"], method="events", **loads))
    changing = np.linspace(0.2, 0.6, 10)[:, None] * np.ones(p.n_c)
    same(p.solve(h["force"], mu=changing, **loads), p.with_(mu=0.9).solve(h["force"], mu=changing, **loads))
    with pytest.raises(ValueError, match="^mu: contact node 0 has friction in some increments"):
        p.solve(h["force"], mu=np.linspace(0.0, 0.6, 10)[:, None], **loads)
    with pytest.raises(ValueError, match="^mu .*C_t"):
        ss.ContactProblem(p.K, p.C_n).solve(h["force"], mu=0.1)


def test_other_contact_on_one_body() -> None:
    model = ss.Model(block(6))
    p, h = model.problem, model.history
    some = slice(2, 5)
    part = p.with_(C_n=p.C_n[some], C_t=p.C_t[0][some], mu=0.2, weight=p.weight[some])
    anew = ss.ContactProblem(p.K, p.C_n[some], p.C_t[0][some], 0.2)
    assert part.n_c == 3 and (part.weight == p.weight[some]).all() and (part.K != p.K).nnz == 0
    same(part.solve(h["force"], gap=1e-5), anew.solve(h["force"], gap=1e-5))
    same(p.with_(weight=2.0).solve(h["force"], gap=1e-5), p.solve(h["force"], gap=1e-5))
    with pytest.raises(ValueError, match="^mu is of 6 contact nodes, but C_n has 3 rows"):
        p.with_(C_n=p.C_n[some], C_t=p.C_t[0][some])
    with pytest.raises(ValueError, match="^C_t"):
        p.with_(C_n=p.C_n[some], mu=0.2, weight=1.0)
    with pytest.raises(ValueError, match="^weight"):
        p.with_(weight=-1.0)


def test_another_stiffness_under_one_contact() -> None:
    model = ss.Model(block(6))
    p, force = model.problem, model.history["force"]
    stiff = p.with_(K=2.0 * p.K)
    np.testing.assert_allclose(stiff.solve(2.0 * force, gap=1e-5).u, p.solve(force, gap=1e-5).u, rtol=0, atol=1e-12)
    assert (stiff.weight == p.weight).all() and (stiff.mu == p.mu).all() and (stiff.C_t[0] != p.C_t[0]).nnz == 0
    part = p.with_(K=2.0 * p.K, C_n=p.C_n[2:5], C_t=p.C_t[0][2:5], mu=0.2, weight=p.weight[2:5])
    assert part.n_c == 3 and (part.mu == 0.2).all() and abs(part.K - 2.0 * p.K).max() == 0
    loose = ss.ContactProblem(np.eye(2), [[0, -1]]).with_(K=np.diag([0.0, 1.0]))
    assert loose.free_motions.shape == (1, 2) and loose.C_t == ()
    for K, message in ((np.eye(3), "^C_n has the shape"), ([[1.0, 2.0], [0.0, 1.0]], "^K is not symmetric")):
        with pytest.raises(ValueError, match=message):
            loose.with_(K=K)
    with pytest.raises(ValueError, match="^K, C_n and C_t decide to what a body is condensed"):
        p.condense().with_(K=p.K)


@pytest.mark.parametrize("scene", [block(8), SCENES / "cube.toml"])
def test_a_condensed_problem_is_the_whole_one(scene: Any) -> None:
    model = ss.Model(scene, {} if isinstance(scene, ss.Scene) else {"mesh.elements": [3, 3, 3]})
    p, h = model.problem, model.history
    small = p.condense()
    assert small.n_u == (1 + p.tangents) * p.n_c or small.n_u < p.n_u
    whole = p.solve(h["force"], gap=h["gap"], drift=h["drift"]).check()
    part = small.solve(small.reduce(h["force"]), gap=h["gap"], drift=h["drift"]).check()
    np.testing.assert_allclose(part.p_n, whole.p_n, rtol=0, atol=1e-9 * abs(whole.p_n).max())
    np.testing.assert_allclose(part.p_t, whole.p_t, rtol=0, atol=1e-9 * abs(whole.p_n).max())
    lifted = small.lift(part.u, h["force"])
    np.testing.assert_allclose(lifted, whole.u, rtol=0, atol=1e-11 * abs(whole.u).max())
    k = -1
    judged = ss.measure(p, h["force"][k], lifted[k], part.p_n[k], part.p_t[k], gap=h["gap"][k], w_t_last=whole.w_t_last[k])
    assert judged.error < 1e-9
    again = pickle.loads(pickle.dumps(small))
    np.testing.assert_allclose(again.lift(part.u[k], h["force"][k]), lifted[k], rtol=0, atol=1e-12 * abs(lifted).max())
    slippery = small.with_(mu=0.1)
    assert slippery.solve(small.reduce(h["force"]), gap=h["gap"]).check().p_t.shape == part.p_t.shape
    with pytest.raises(ValueError, match="^force has the shape"):
        small.reduce([1.0])
    with pytest.raises(ValueError, match="^u has the shape"):
        small.lift([1.0], h["force"][0])


def test_a_frictionless_node_keeps_its_tangent_when_it_is_condensed() -> None:
    p = ss.Model(block(6)).problem
    small = p.with_(mu=0.0).condense()
    force = np.zeros(p.n_u)
    assert small.with_(mu=0.3).C_t[0].nnz == p.C_t[0].nnz and small.solve(small.reduce(force)).converged


def test_what_nothing_holds_cannot_be_condensed() -> None:
    p = ss.ContactProblem(np.diag([1.0, 1.0, 0.0]), np.eye(3)[[0]], np.eye(3)[[1]], 0.3)
    with pytest.raises(ValueError, match="^K: a part of the body can move"):
        p.condense()


def test_the_example_runs(capsys: pytest.CaptureFixture[str]) -> None:
    code: dict[str, Any] = {"__name__": "example"}
    exec(compile((EXAMPLES / "many.py").read_text(encoding="utf-8"), "many.py", "exec"), code)
    code["main"](n=8, samples=6)
    assert "the same to" in capsys.readouterr().out


def test_a_table_of_forces_is_few_loads_where_that_changes_nothing() -> None:
    rng = np.random.default_rng(0)
    loads, factors = rng.standard_normal((2, 30)), rng.standard_normal((12, 2))
    factors[3] = 0.0
    for table, few in ((factors @ loads, 2), (rng.standard_normal((12, 30)), 12), (np.zeros((4, 30)), 4), (loads, 2), (loads[:1], 1)):
        found, factor = few_loads(table)
        assert len(found) == few and found.shape[0] == factor.shape[1]
        assert (abs(factor @ found - table).max(axis=1) <= 1e-15 * abs(table).max(axis=1)).all()


def _sums(problem: ss.ContactProblem) -> list[float]:
    return [float(result.p_n.sum()) for result in problem.solve_many(np.ones(problem.n_u), mus=[0.1, 0.3], gap=-1e-6, workers=2)]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="fork")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_forked_process_solves_many_too() -> None:
    problem = ss.Model(block(6)).problem
    expected = _sums(problem)
    with multiprocessing.get_context("fork").Pool(1) as pool:
        assert pool.map_async(_sums, [problem]).get(timeout=60)[0] == pytest.approx(expected, rel=1e-12)


def test_a_part_of_results_is_results() -> None:
    problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    results = problem.solve_many([[0.0, -100.0], [40.0, -100.0]], mus=[0.1, 0.2, 0.3], keep_u="all")
    part = results[1:]
    assert type(part) is ss.Results and list(part) == [results[1], results[2]] and results[-1] is part[-1]
    assert (part.stack("p_t") == results.stack("p_t")[1:]).all() and part.converged.tolist() == [True, True]
    rows = {"t": (), "u": (2,), "p_n": (1,), "p_t": (1, 1), "contact": (1,), "gap": (1,), "mu": (1,), "w_t_last": (1, 1), "errors": (6,)}
    for name, width in rows.items():
        assert results.stack(name).shape == (3, 2, *width)
        for none in (results[:0], problem.solve_many(forces=[]), pickle.loads(pickle.dumps(results[:0]))):
            assert none.stack(name).shape == (0, 0, *width) and none.stack(name).dtype == results.stack(name).dtype


@pytest.mark.filterwarnings("ignore::stickslip.NotConvergedWarning")
def test_results_without_an_increment_have_their_shape() -> None:
    loose = ss.ContactProblem(np.zeros((2, 2)), [[0, -1]], [[1, 0]], mu=0.3, free_motions=np.eye(2))
    result, results = loose.solve([1.0, 1.0], linear="condensed"), loose.solve_many(forces=[[1.0, 1.0]], linear="condensed")
    assert len(result.t) == 0 and result.p_n.shape == (0, 1) and result.p_t.shape == (0, 1, 1) and result.u.shape == (0, 2)
    assert results.stack("p_t").shape[2:] == (1, 1) and results.stack("u").shape[2:] == (2,)


def test_shapes_of_fields_are_a_row_or_rows() -> None:
    problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    for name in ("mus", "gaps"):
        rows = {"mus": 2, "gaps": 3}[name]
        with pytest.raises(ValueError, match=rf"{name}\[0\] has the shape \(7,\), expected \(1,\) or \({rows}, 1\)"):
            problem.solve_many([[0.0, -1.0], [0.1, -1.0]], **{name: np.full((3, 7), 0.3)})  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"history\['mu'\] has the shape \(7,\), expected \(1,\) or \(1, 1\)"):
        ss.judge(problem, "bn", history={"force": [[0.0, -1.0]], "mu": [0.3] * 7})


def test_a_table_has_a_row_for_each_history() -> None:
    pd = pytest.importorskip("pandas")
    problem = ss.ContactProblem(np.diag([2e6, 1e6, 2e6, 1e6]), [[0, -1, 0, 0], [0, 0, 0, -1]], [[1, 0, 0, 0], [0, 0, 1, 0]], mu=0.3)
    force = [[0, -100, 0, -100], [90, -100, 90, -100]]
    for rows in (2, 3):
        mus = np.linspace(0.1, 0.9, 2 * rows).reshape(rows, 2)
        gaps = 1e-5 * mus
        forces = np.array([k * np.array(force[1], dtype=float) for k in range(1, rows + 1)])
        names = [f"s{k}" for k in range(rows)]
        for many, array in (("mus", mus), ("gaps", gaps), ("forces", forces)):
            shared = {} if many == "forces" else {"force": force}
            expected = problem.solve_many(**shared, **{many: array})
            found = problem.solve_many(**shared, **{many: pd.DataFrame(array, index=names)})
            assert (found.stack("p_t") == expected.stack("p_t")).all(), (many, rows)
    found = problem.solve_many(force, mus=pd.Series([0.1, 0.2, 0.3], index=[7, 8, 9]))
    assert [result.mu[0, 0] for result in found] == [0.1, 0.2, 0.3]
