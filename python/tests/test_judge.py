"""The judge, and the bridges whose answers it judges."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp

import stickslip as ss
from scenes import SCENES, block, needs
from stickslip import siconos
from stickslip.newton import Natural


def test_the_judge_agrees_with_the_run_and_sees_wrong_answers() -> None:
    model = ss.Model(block())
    result, p = model.run(), model.problem
    scales: tuple[float, ...] = ()
    for k in range(len(result.t)):
        judged = ss.measure(p, result.force[k], (result.u[k], result.u_rest[k]), result.p_n[k], result.p_t[k],
                           gap=result.gap[k], w_t_last=result.w_t_last[k], scales=scales)
        scales = judged.scales
        np.testing.assert_allclose([getattr(judged, law) for law in ss.LAWS], result.errors[k], rtol=1e-6, atol=1e-13)
        assert (judged.contact == result.contact[k]).all()
    wrong = ss.measure(p, result.force[-1], result.u[-1], result.p_n[-1], -result.p_t[-1], gap=1e-5)
    assert wrong.error > 1e-3


def test_arrays_that_a_solver_overwrites_are_its_own() -> None:
    problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)

    def nothing(posed: ss.Posed) -> tuple[Any, Any, Any]:
        for array in (posed.force, posed.gap, posed.w_t_last, posed.mu, *posed.last):
            array[...] = 0
        return np.zeros(2), np.zeros(1), np.zeros(1)

    history = {"force": [[40.0, -100.0], [40.0, -200.0]]}
    assert not ss.judge(problem, nothing, history=history).converged

    def complex_answer(posed: ss.Posed) -> tuple[Any, Any, Any]:
        result = posed.problem.solve_increment(posed.force, gap=posed.gap, w_t_last=posed.w_t_last)
        return result.u[0] + 5j, result.p_n[0], result.p_t[0]

    judged = ss.judge(problem, complex_answer, history=history)
    assert not judged.converged and "u is complex" in judged.reason
    judged = ss.judge(problem, lambda posed: (np.ma.array([0.0, 0.0], mask=[True, False]), [0.0], [0.0]), history=history)
    assert not judged.converged and "u has masked entries" in judged.reason


def test_each_law_is_seen_by_itself() -> None:
    K, C_n, C_t = np.eye(2), [[1.0, 0.0]], [[0.0, 1.0]]
    p = ss.ContactProblem(K, C_n, C_t, 0.5)

    def worst(force: list[float], u: list[float], p_n: float, p_t: float) -> str:
        return ss.measure(p, force, u, [p_n], [p_t]).law

    assert worst([1.0, 0.0], [0.5, 0.0], 0.0, 0.0) in ("equilibrium", "penetration")
    assert worst([1.0, 0.0], [1.0, 0.0], 0.0, 0.0) == "penetration"
    assert worst([-1.0, 0.0], [0.0, 0.0], -1.0, 0.0) == "tension"
    assert worst([0.0, 0.0], [-1.0, 0.0], 1.0, 0.0) == "complementarity"
    assert worst([1.0, 0.8], [0.0, 0.0], 1.0, 0.8) == "cone"
    assert worst([1.0, 0.8], [0.0, 0.8], 1.0, 0.0) == "dissipation"


def test_compare_marks_what_is_wrong() -> None:
    model = ss.Model(block())
    result = model.run()

    def honest(posed: ss.Posed) -> tuple[object, object, object]:
        k = posed.increment - 1
        return result.u[k], result.p_n[k], result.p_t[k]

    def turned(posed: ss.Posed) -> tuple[object, object, object]:
        u, p_n, p_t = honest(posed)
        return u, p_n, -np.asarray(p_t)

    def silent(posed: ss.Posed) -> tuple[object, object, object]:
        raise RuntimeError("no luck")

    table = ss.compare(model, {"stickslip": "stickslip", "ip": "ip", "honest": honest, "turned": turned, "silent": silent})
    assert [verdict.converged for verdict in table.values()] == [True, True, True, False, False]
    assert table["silent"].reason == "increment 1: RuntimeError: no luck"
    assert str(table).count("WRONG") == 2 and table._repr_html_().count("#cf222e") == 2
    needs("pandas")
    assert list(table.to_pandas().index) == ["stickslip", "ip", "honest", "turned", "silent"]


def lubricated() -> ss.Model:
    """The block, whose friction falls while it is pushed."""
    scene = block(n=8, increments=16).to_dict()
    scene["contact"][0]["friction_history"] = [[0, 1], [1, 1], [2, 0.25]]
    scene["load"][1]["traction"] = [10e6, 0.0]
    return ss.Model(scene)


def test_compare_solves_and_judges_with_the_friction_of_the_history() -> None:
    model = lubricated()
    table = ss.compare(model, {"scene": "stickslip", "bn": "bn", "ip": "ip", "events": "events"})
    assert [verdict.converged for verdict in table.values()] == [True, True, True, False]
    assert "mu" in table["events"].reason and table["events"].law == "no answer"
    for name in ("bn", "ip"):
        np.testing.assert_allclose(table[name].p_t[-1], table["scene"].p_t[-1], atol=1e-7 * table["scene"].p_n.max())
    # What was solved with another friction than the one that was asked for is seen.
    history = {key: model.history[key] for key in ("force", "gap", "drift")}
    asked = {**history, "mu": 0.5 * model.history["mu"]}
    result = model.run()
    wrong = ss.compare(model, {"as the scene is": lambda posed: _answer(result, posed.increment - 1)}, history=asked)
    assert not wrong["as the scene is"].converged and wrong["as the scene is"].law == "cone"
    right = ss.compare(model, {"bn": "bn", "scene": "stickslip"}, history=asked)
    assert right["bn"].converged and right["scene"].converged


def _answer(result: ss.Result, k: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return result.u[k], result.p_n[k], result.p_t[k]


@pytest.mark.parametrize("method", ["bn", "ip"])
def test_friction_that_changes_on_given_matrices(method: str) -> None:
    model = lubricated()
    result, h, p = model.run(), model.history, model.problem
    options = {"gap": h["gap"], "mu": h["mu"]}
    again = p.solve(h["force"], method=method, **options).check()
    np.testing.assert_allclose(again.p_t, result.p_t, rtol=0, atol=1e-8 * result.p_n.max())
    np.testing.assert_allclose(again.mu, h["mu"], rtol=1e-14)
    stepper, w = p.stepper(gap=h["gap"][0], method=method), np.zeros((p.n_c, 1))
    for k, force in enumerate(h["force"]):
        step = stepper.step(force, mu=h["mu"][k]).check()
        np.testing.assert_allclose(step.p_t[0], result.p_t[k], rtol=0, atol=1e-8 * result.p_n.max())
        one = p.solve_increment(force, gap=h["gap"][k + 1], w_t_last=w, mu=h["mu"][k], method=method).check()
        np.testing.assert_allclose(one.p_t[0], result.p_t[k], rtol=0, atol=1e-8 * result.p_n.max())
        state, w = (one.u[0], one.p_n[0], one.p_t[0]), p.slip(one.u[0])
        natural = Natural(p, force, gap=h["gap"][k + 1], w_t_last=one.w_t_last[0], mu=h["mu"][k])
        assert abs(natural.residual(*state)).max() < 1e-7 * result.p_n.max()
    assert (siconos.to_siconos(p, h["force"][-1], mu=h["mu"][-1]).mu == h["mu"][-1]).all()


def test_friction_is_there_at_all_times_or_never() -> None:
    p = lubricated().problem
    for mu in (0.0, [0.0] + [0.4] * (p.n_c - 1)):
        # Without friction at all times is another problem; a stepper has one.
        assert p.solve(np.zeros(p.n_u), mu=mu).converged
        with pytest.raises(ValueError, match="mu: contact node 0"):
            p.solve(np.zeros((2, p.n_u)), mu=[p.mu, mu * np.ones(p.n_c)])
        with pytest.raises(ValueError, match="mu: contact node 0"):
            p.stepper().step(np.zeros(p.n_u), mu=mu)
    with pytest.raises(ValueError, match="mu is negative"):
        p.solve(np.zeros(p.n_u), mu=-1.0)
    with pytest.raises(ValueError, match="mu has the shape"):
        p.solve(np.zeros(p.n_u), mu=[0.1, 0.2, 0.3])


def test_compare_says_of_a_word_why_there_is_no_answer() -> None:
    model = ss.Model(ss.Scene.example("block"), {"mesh.elements": [8, 4], "contact.friction": 0.1})
    table = ss.compare(model.problem, {"bn": "bn"}, history={"force": model.history["force"]})
    assert not table["bn"].converged and table["bn"].reason
    with pytest.raises(ValueError, match="newton"):
        ss.compare(model, {"mine": "newton"})


@pytest.mark.parametrize("scene, overrides", [(block(), {}), (SCENES / "cube.toml", {"mesh.elements": [3, 3, 3]})])
def test_signs_of_siconos_there_and_back(scene: object, overrides: dict[str, object]) -> None:
    model = ss.Model(scene, overrides)  # type: ignore[arg-type]
    result, p, k = model.run(), model.problem, -2
    force, gap, w = result.force[k], result.gap[k], result.w_t_last[k]
    dimension, M, H, q, b, mu = siconos.to_siconos(p, force, gap, w)
    r, v = siconos.reactions(result.p_n[k], result.p_t[k]), result.u[k]
    # Their laws, in their words: M v = q + H r, and of the local u = H' v + b the normal is complementary to r_n, ...
    assert abs(M @ v - q - H @ r).max() < 1e-9 * abs(r).max()
    u, r = (H.T @ v + b).reshape(-1, dimension), r.reshape(-1, dimension)
    length = abs(v).max()
    assert u[:, 0].min() > -1e-9 * length and r[:, 0].min() > -1e-9 * r.max()
    assert abs(u[:, 0] * r[:, 0]).max() < 1e-9 * length * r.max()
    # ... and where it slides, the tangential reaction is against the slip, mu r_n long.
    size = np.linalg.norm(u[:, 1:], axis=1)
    sliding = (size > 1e-6 * length) & (r[:, 0] > 1e-6 * r.max())
    assert sliding.any()
    against = -(mu * r[:, 0] / np.where(size > 0, size, 1))[:, None] * u[:, 1:]
    np.testing.assert_allclose(r[sliding, 1:], against[sliding], rtol=0, atol=1e-6 * r.max())
    posed = siconos.from_siconos(M, H, q, b, mu)
    assert abs(posed.problem.C_n - p.C_n).max() == 0 and (posed.w_t_last == w).all() and (posed.gap == gap).all()
    again = siconos.answer(posed.problem, v, r.ravel())
    assert ss.measure(posed.problem, posed.force, *again, gap=posed.gap, w_t_last=posed.w_t_last).error < 1e-9


def test_matrices_of_another_assembly_are_the_same_body() -> None:
    skfem = needs("skfem")
    from skfem.models.elasticity import lame_parameters, linear_elasticity

    n = 8
    mesh = skfem.MeshQuad.init_tensor(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuad1()))
    K = skfem.asm(linear_elasticity(*lame_parameters(210e9, 0.3)), basis)
    top = skfem.FacetBasis(mesh, basis.elem, facets=mesh.facets_satisfying(lambda x: x[1] == 1.0))
    f = skfem.asm(skfem.LinearForm(lambda v, w: -10e6 * v[1]), top)
    free = basis.complement_dofs(basis.get_dofs(lambda x: x[0] == 0.0))
    nodes = np.flatnonzero((mesh.p[1] == 0.0) & (mesh.p[0] > 0.0))
    I = sp.csr_array(sp.identity(K.shape[0]))[:, free]
    C_n, C_t = -I[basis.nodal_dofs[1, nodes]], I[basis.nodal_dofs[0, nodes]]
    problem = ss.ContactProblem(K[free][:, free], C_n, C_t, 0.4)
    result = problem.solve(f[free], np.linspace(0, 1, 6)[1:], gap=1e-5).check()
    scene = block(n=n, increments=5).to_dict()
    scene["load"], scene["time"]["end"] = scene["load"][:1], 1.0
    np.testing.assert_allclose(result.p_n.sum(axis=1), ss.run(scene).p_n.sum(axis=1), rtol=1e-6)


def test_a_history_that_does_not_fit_is_refused_and_not_cut_short() -> None:
    p = ss.ContactProblem(np.eye(2), [[1.0, 0.0]], [[0.0, 1.0]], 0.5)

    def zero(posed: ss.Posed) -> tuple[object, object, object]:
        return np.zeros(2), [0.0], [0.0]

    force = np.ones((3, 2))
    assert ss.judge(p, zero, history={"force": force, "gap": np.ones((4, 1))}).errors.shape == (3, 6)
    assert ss.judge(p, zero, history={"force": force, "gap": [1.0], "mu": 0.1, "drift": np.zeros((3, 1))}).errors.shape == (3, 6)
    for history, named in [
        ({"force": force, "gap": np.ones((2, 1))}, "gap"),
        ({"force": force, "gap": np.ones((3, 1))}, "gap"),
        ({"force": np.ones((3, 3))}, "force"),
        ({"force": np.ones((0, 2))}, "force"),
        ({"force": force * 1j}, "force"),
        ({"force": force, "drift": np.zeros((2, 1))}, "drift"),
        ({"force": force, "mu": [0.1, 0.2]}, "mu"),
        ({"force": force, "gaps": 1.0}, "gaps"),
        ({"gap": 1.0}, "force"),
    ]:
        with pytest.raises(ValueError, match=named):
            ss.judge(p, zero, history=history)
    with pytest.raises(TypeError, match=r"^solver: .* expected, int found"):
        ss.judge(p, 3, history={"force": force})  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"^solvers\['mine'\]: .* expected, NoneType found"):
        ss.compare(p, {"mine": None}, history={"force": force})  # type: ignore[dict-item]
    with pytest.raises(ValueError, match="solvers"):
        ss.compare(p, {}, history={"force": force})
    with pytest.raises(ValueError, match="K is complex"):
        ss.ContactProblem(np.eye(2) * 1j, [[1.0, 0.0]], [[0.0, 1.0]], 0.5)


def test_judge_takes_the_words_of_compare() -> None:
    model = ss.Model(block(n=4, increments=4))
    for word in ("bn", "ip", "events", "stickslip"):
        verdict, row = ss.judge(model, word), ss.compare(model, {word: word})[word]
        assert verdict.converged and verdict.name == word and (verdict.errors == row.errors).all() and (verdict.p_n == row.p_n).all()
    assert ss.judge(model, "ip", name="interior point").name == "interior point"
    with pytest.raises(ValueError, match="^solver is 'newton', expected one of bn, ip, events, stickslip or a function"):
        ss.judge(model, "newton")
    for wrong in ("bn", lambda posed: None):
        with pytest.raises(ValueError, match="no increments"):
            ss.judge(model.problem, wrong, history={"force": np.ones((0, model.problem.n_u))})
    with pytest.warns(ss.AccuracyWarning) as warned:
        ss.judge(ss.Model(SCENES / "confined.toml"), "stickslip")
        ss.compare(ss.Model(SCENES / "confined.toml"), {"own": "stickslip"})
    assert {w.filename for w in warned} == {__file__}


def test_a_history_of_a_model_is_taken() -> None:
    model = ss.Model(block(4, 4))
    assert ss.judge(model.problem, "bn", history=model.history).converged
    assert ss.compare(model.problem, {"mine": "ip"}, history=model.history)["mine"].converged
    with pytest.raises(TypeError, match="history: a dictionary expected, such as that of Model.history, list found"):
        ss.judge(model.problem, "bn", history=[1.0])  # type: ignore[arg-type]


@pytest.mark.parametrize("of", [block(4, 4), "block.toml", block(4, 4).to_dict()])
def test_a_scene_is_no_model(of: Any) -> None:
    said = f"of: Model or ContactProblem expected, {type(of).__name__} found; ss.Model\\(scene\\) makes one"
    with pytest.raises(TypeError, match=said):
        ss.judge(of, "bn")
    with pytest.raises(TypeError, match=said):
        ss.compare(of, {"mine": "bn"})


@pytest.mark.parametrize("tolerance, kind", [(-1.0, ValueError), (float("nan"), ValueError), (float("inf"), ValueError), ("1", TypeError), (True, TypeError)])
def test_a_tolerance_is_a_number_of_0_or_more(tolerance: Any, kind: type[Exception]) -> None:
    problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    history = {"force": [[40.0, -100.0]]}
    for ask in (lambda: ss.judge(problem, "bn", history=history, tolerance=tolerance), lambda: ss.compare(problem, {"a": "bn"}, history=history, tolerance=tolerance)):
        with pytest.raises(kind, match="tolerance"):
            ask()
    assert ss.judge(problem, "bn", history=history, tolerance=np.float32(1e-8)).converged  # type: ignore[arg-type]


@pytest.mark.parametrize("scales", [(float("nan"), 1.0), (-1.0, 1.0), (1.0,), 3.0])
def test_scales_are_those_of_errors(scales: Any) -> None:
    problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    with pytest.raises(ValueError, match="scales"):
        ss.measure(problem, [40.0, -100.0], [0.0, 0.0], [1.0], scales=scales)


def test_rounding_is_no_violation() -> None:
    problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    result = problem.solve_increment([40.0, -100.0])
    judged = ss.measure(problem, [40.0, -100.0], result.u[0] * (1 + 1e-14), result.p_n[0], result.p_t[0])
    assert repr(judged).startswith("<Errors: largest error ") and "violated" not in repr(judged) + judged._repr_html_()
    wrong = ss.measure(problem, [40.0, -100.0], result.u[0] * 1.1, result.p_n[0], result.p_t[0])
    assert "violated by" in repr(wrong)


PROBLEM = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
FORCE = [40.0, -100.0]


def test_a_tuple_of_two_numbers_is_one_vector() -> None:
    for u in ((5e-6, 0.0), [5e-6, 0.0], ([5e-6, 0.0], [0.0, 0.0]), ([5e-6, 0.0], None)):
        assert ss.measure(PROBLEM, FORCE, u, [100.0], [30.0]).error < 1e-12  # type: ignore[arg-type]


@pytest.mark.parametrize("solver", ["bn", lambda posed: (np.zeros(2), [0.0], [[0.0]])])
@pytest.mark.parametrize("history, message", [
    ({"force": [FORCE], "mu": [[-1.0]]}, r"history\['mu'\] is negative"), ({"force": [FORCE], "mu": [[np.nan]]}, r"history\['mu'\] is not finite"),
    ({"force": [FORCE] * 2, "mu": [[0.3], [0.0]]}, r"history\['mu'\]: contact node 0 has friction in some"),
    ({"force": -5}, r"history\['force'\] has the shape \(\), expected \(1, 2\)"), ({"force": [[-5]]}, r"history\['force'\] has the shape \(1, 1\)"),
    ({"force": np.zeros((0, 2))}, r"history\['force'\] has no increments"), ({"force": [FORCE], "drift": [[1.0, 2.0, 3.0]]}, r"history\['drift'\]"),
    ({"force": [FORCE], "gap": [np.inf]}, r"history\['gap'\].* is not finite"),
])
def test_a_history_that_does_not_fit_is_the_fault_of_no_solver(solver: Any, history: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=f"^{message}"):
        ss.judge(PROBLEM, solver, history=history)
    with pytest.raises(ValueError, match=f"^{message}"):
        ss.compare(PROBLEM, {"one": solver}, history=history)


def test_a_solver_cannot_change_the_history_that_judges_it() -> None:
    history = {"force": np.array([FORCE] * 2)}

    def nothing(posed: ss.Posed) -> tuple[Any, Any, Any]:
        history["force"][...] = 0.0
        return np.zeros(2), np.zeros(1), np.zeros(1)

    assert not ss.judge(PROBLEM, nothing, history=history).converged


def test_a_word_solves_a_model_at_the_times_of_its_scene() -> None:
    seen = ss.judge(ss.Model(block(n=4)), "bn", tolerance=0.0)
    model = ss.Model(block(n=4), {"solver.max_iterations": 1})
    assert seen.error < 1e-8
    with pytest.MonkeyPatch.context() as patch:
        told: list[Any] = []
        solve = ss.ContactProblem.solve
        patch.setattr(ss.ContactProblem, "solve", lambda *all, **named: told.append(named["t"]) or solve(*all, **named))
        ss.judge(model, "bn")
        ss.judge(model, "bn", history={"force": model.history["force"][:3], "gap": model.history["gap"][:4]})
    assert (told[0] == model.t).all() and told[1] is None


def test_a_method_that_is_not_made_for_a_problem_is_not_wrong() -> None:
    cube = ss.Model(ss.Scene.example("cube"), {"mesh.elements": [3, 3, 3]})
    with pytest.raises(ValueError, match="^solver 'events' is not applicable: "):
        ss.judge(cube, "events")
    table = ss.compare(cube, {"path": "events", "Newton": "bn"})
    assert table["path"].reason.startswith("not applicable: ") and not table["path"].converged and table["Newton"].converged
    for words in (str(table), repr(table["path"]), table._repr_html_()):
        assert "WRONG" not in words and "not applicable" in words and "#cf222e" not in words
    needs("matplotlib")
    assert len(table.plot().texts) == 1


def test_names_and_problems_of_the_judge() -> None:
    with pytest.raises(TypeError, match="^solvers: names are words, 5 found"):
        ss.compare(PROBLEM, {5: "bn"}, history={"force": [FORCE]})  # type: ignore[dict-item]
    with pytest.raises(TypeError, match="^problem: a ContactProblem expected, NoneType found"):
        ss.measure(None, FORCE, [0.0, 0.0], [0.0])  # type: ignore[arg-type]
