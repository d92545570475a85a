"""Problems of matrices."""

from __future__ import annotations

import pickle
import re
import threading
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as spla

import stickslip as ss
from scenes import SCENES, block
from stickslip._words import REASONS
from stickslip.newton import Natural


def one_node() -> ss.ContactProblem:
    K = sp.csc_array([[2.0, 1.5], [1.5, 2.0]])
    return ss.ContactProblem(K, sp.csr_array([[0.0, 1.0]]), sp.csr_array([[1.0, 0.0]]), mu=0.3)


def test_one_node_is_what_it_is_by_hand() -> None:
    result = one_node().solve([1.0, 1.0]).check()
    assert result.p_n[0, 0] == pytest.approx(0.25 / 0.775, rel=1e-14)
    assert result.p_t[0, 0, 0] == pytest.approx(0.3 * 0.25 / 0.775, rel=1e-14)
    assert result.contact[0, 0] == ss.SLIP


@pytest.mark.parametrize("scene", [block(), SCENES / "cube.toml"])
def test_the_matrices_of_a_scene_solve_to_the_same_answer(scene: object) -> None:
    overrides = {} if isinstance(scene, ss.Scene) else {"mesh.elements": [3, 3, 3]}
    model = ss.Model(scene, overrides)  # type: ignore[arg-type]
    result, h, p = model.run().check(), model.history, model.problem
    again = ss.ContactProblem(p.K, p.C_n, p.C_t, p.mu, weight=p.weight)
    for linear in ("auto", "faer", "condensed"):
        other = again.solve(*model.loads, gap=h["gap"], drift=h["drift"], linear=linear).check()
        np.testing.assert_allclose(other.u, result.u, rtol=0, atol=1e-9 * abs(result.u).max())
        np.testing.assert_allclose(other.p_t, result.p_t, rtol=0, atol=1e-8 * abs(result.p_n).max())


def test_a_chain_of_increments_is_the_history() -> None:
    model = ss.Model(block())
    result, p = model.run(), model.problem
    w = np.zeros((p.n_c, 1))
    for k, f in enumerate(model.history["force"]):
        step = p.solve_increment(f, gap=1e-5, w_t_last=w).check()
        np.testing.assert_allclose(step.p_t[0], result.p_t[k], rtol=0, atol=1e-7 * abs(result.p_n).max())
        w = p.slip(step.u[0])


@pytest.mark.parametrize("linear", ["auto", "faer", "condensed"])
def test_other_friction_on_one_body(linear: str) -> None:
    model = ss.Model(block(8))
    p, h = model.problem, model.history
    for mu in (0.0, 0.2, np.linspace(0.1, 0.9, p.n_c)):
        other = p.with_(mu=mu)
        assert other.n_u == p.n_u and (other.mu == mu).all() and (p.mu == 0.4).all()
        anew = ss.ContactProblem(p.K, p.C_n, p.C_t, mu, weight=p.weight)
        for _ in range(2):
            a, b = (q.solve(*model.loads, gap=h["gap"], linear=linear).check() for q in (other, anew))
            np.testing.assert_allclose(a.p_n, b.p_n, rtol=0, atol=1e-12 * abs(b.p_n).max())
            np.testing.assert_allclose(a.p_t, b.p_t, rtol=0, atol=1e-12 * abs(b.p_n).max())
    with pytest.raises(ValueError, match="mu"):
        p.with_(mu=-0.1)
    with pytest.raises(ValueError, match="shape"):
        p.with_(mu=[0.1])
    with pytest.raises(ValueError, match="no C_t"):
        ss.ContactProblem(p.K, p.C_n).with_(mu=0.1)


class Scipy:
    """SuperLU as the linear algebra of a method."""

    factorizations = 0

    def analyze(self, n, indptr, indices):  # type: ignore[no-untyped-def]
        self.shape, self.indptr, self.indices = (n, n), indptr, indices

    def factorize(self, data):  # type: ignore[no-untyped-def]
        self.factorizations += 1
        try:
            self.lu = spla.splu(sp.csc_matrix((data, self.indices, self.indptr), shape=self.shape))
        except RuntimeError as error:
            raise ZeroDivisionError(str(error)) from error

    def solve(self, b):  # type: ignore[no-untyped-def]
        return self.lu.solve(b)


@pytest.mark.parametrize("linear", ["auto", "faer", "condensed", Scipy()])
@pytest.mark.parametrize("method", ["bn", "ip"])
def test_linear_algebra_and_methods_agree(linear: object, method: str) -> None:
    reference = ss.run(block())
    result = ss.Model(block(method=method)).run(linear=linear).check()  # type: ignore[arg-type]
    np.testing.assert_allclose(result.p_n, reference.p_n, rtol=0, atol=1e-8 * abs(reference.p_n).max())
    if isinstance(linear, Scipy):
        assert linear.factorizations > 0


@pytest.mark.parametrize("what, raised, message", [
    (list, None, ""), (lambda x: np.repeat(x, 2)[::2], None, ""),
    (lambda x: x.astype("f4"), TypeError, "float32 found"), (lambda x: x[:, None], ValueError, "shape"),
    (lambda x: None, TypeError, "NoneType found"), (lambda x: x[:-1], ValueError, "length"), (lambda x: 1.0, TypeError, "float found"),
    (lambda x: list(x[:-1]), ValueError, "length"), (lambda x: x + 0j, TypeError, "complex128 found"), (lambda x: "x", TypeError, "str found"),
])
def test_what_a_foreign_solver_may_hand_back(what: object, raised: type[Exception] | None, message: str) -> None:
    class Own(Scipy):
        def solve(self, b):  # type: ignore[no-untyped-def]
            return what(self.lu.solve(b))  # type: ignore[operator]

    if raised is None:
        assert one_node().solve([1.0, 1.0], linear=Own()).converged
    else:
        with pytest.raises(raised, match=rf"linear\.solve: .*{message}"):
            one_node().solve([1.0, 1.0], linear=Own())


@pytest.mark.parametrize("options", [{"tolerance": "1e-9"}, {"max_iterations": 1.5}, {"method": 3}, {"r_factor": "1"}])
def test_options_of_another_type_are_named(options: dict[str, object]) -> None:
    with pytest.raises(TypeError, match=next(iter(options))):
        one_node().solve([1.0, 1.0], **options)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=next(iter(options))):
        one_node().stepper(**options)  # type: ignore[arg-type]


def test_a_triangle_of_K_is_taken_and_another_matrix_refused() -> None:
    p = ss.Model(block(n=4, increments=4)).problem
    force = np.linspace(-1.0, 1.0, p.n_u)

    def total(K: object, **options: bool) -> float:
        return float(ss.ContactProblem(K, p.C_n, p.C_t, 0.4, **options).solve(force, gap=-1e-5).check().p_n.sum())  # type: ignore[arg-type]

    expected = total(p.K)
    for K in (p.K, sp.tril(p.K), sp.triu(p.K), p.K.toarray(), np.triu(p.K.toarray())):
        assert total(K, check=False) == pytest.approx(expected, rel=1e-12)
    for K in (p.K + 0.1 * sp.triu(p.K, 1), p.K + 1e-7 * sp.triu(p.K, 1), -sp.tril(p.K, -1) + sp.triu(p.K)):
        for check in (True, False):
            with pytest.raises(ValueError, match=r"differs from its transpose by .* \(K \+ K\.T\) / 2"):
                total(K, check=check)
    for K in (sp.tril(p.K), sp.triu(p.K)):
        with pytest.raises(ValueError, match="one side of its diagonal only; pass check=False"):
            total(K)
    rounded = p.K + 1e-7 * sp.triu(p.K, 1)
    assert total((rounded + rounded.T) / 2) == pytest.approx(expected, rel=1e-4)


def test_friction_without_tangents_is_refused() -> None:
    with pytest.raises(ValueError, match="C_t is missing"):
        ss.ContactProblem(np.eye(2), [[1.0, 0.0]], None, 0.4)
    assert ss.ContactProblem(np.eye(2), [[1.0, 0.0]]).solve([1.0, 1.0]).converged


def box(d: int) -> ss.ContactProblem:
    """A rigid box on springs, with more corners than it takes to hold it."""
    if d == 1:
        x = np.array([-1.0, -0.3, 0.4, 1.0])
        return ss.ContactProblem(np.eye(3), np.stack([0 * x, 0 * x - 1, -x], axis=1), np.stack([0 * x + 1, 0 * x, 0 * x + 1], axis=1), 0.3)
    corners = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1]], dtype=float)

    def rows(direction: list[float]) -> np.ndarray:
        return np.array([np.r_[direction, np.cross(x, direction)] for x in corners])

    return ss.ContactProblem(np.eye(6), rows([0, 0, -1]), (rows([1, 0, 0]), rows([0, 1, 0])) if d else None, 0.3 if d else 0.0)


@pytest.mark.parametrize("linear", ["auto", "faer", "condensed"])
@pytest.mark.parametrize("method", ["bn", "ip"])
@pytest.mark.parametrize("d", [0, 1, 2])
def test_contacts_that_depend_on_each_other_are_solved(d: int, method: str, linear: str) -> None:
    p = box(d)
    force = np.array([0.5, -10.0, 0.3]) if d == 1 else np.array([0.5, 0, -10, 0, 0, 0.2])
    factors = [0.5, 1.0, 0.2]
    result = p.solve(force, factors, method=method, linear=linear, keep_u="last").check()
    assert result.kept == (2,) and result.p_n.shape == (3, 4) and result.error < 1e-10
    assert result.p_n[-1].sum() == pytest.approx(0.2 * 10 - abs(result.u[-1, 1 if d == 1 else 2]), rel=1e-9)
    for k in range(3):
        w = result.w_t_last[k]
        one = p.solve_increment(force * factors[k], w_t_last=w if d else None, method=method, linear=linear).check()
        judged = ss.measure(p, force * factors[k], one.u[0], one.p_n[0], one.p_t[0], w_t_last=w)
        assert judged.error < 1e-10
    assert ss.compare(p, {"own": method}, history={"force": np.outer(factors, force)})["own"].converged


def test_dependent_contacts_share_their_force() -> None:
    p = ss.ContactProblem(np.eye(6), np.eye(6)[[0, 1, 0]], np.eye(6)[[3, 4, 3]], 0.3)
    assert p.solve(np.ones(6)).converged
    step = p.stepper().step(np.ones(6))
    assert step.status == "converged"
    assert step.p_n[0] == pytest.approx([0.5, 1.0, 0.5])
    free = ss.ContactProblem(np.diag([1.0, 1.0, 0.0]), np.eye(3)[[0]], np.eye(3)[[1]], 0.3)
    with pytest.warns(ss.NotConvergedWarning, match="free_motions"):
        assert free.solve(np.ones(3)).reason


def test_what_a_foreign_solver_raises_comes_out() -> None:
    class Broken(Scipy):
        def solve(self, b):  # type: ignore[no-untyped-def]
            raise KeyError("mine")

    class Short(Scipy):
        def solve(self, b):  # type: ignore[no-untyped-def]
            return b[:-1]

    with pytest.raises(KeyError, match="mine"):
        one_node().solve([1.0, 1.0], linear=Broken())
    with pytest.raises(ValueError, match=r"linear\.solve: length"):
        one_node().solve([1.0, 1.0], linear=Short())


@pytest.mark.filterwarnings("ignore::stickslip.NotConvergedWarning")
@pytest.mark.parametrize("what, said", [
    (lambda x: 0.0 * x, r"wrong, its relative residual is 1\.0e\+00$"), (lambda x: -x, r"wrong, its relative residual is \S+$"),
    (lambda x: np.full(len(x), np.nan), "not finite"), (lambda x: x + np.inf, "not finite"),
])
def test_a_wrong_answer_of_a_foreign_solver_is_said(what: Any, said: str) -> None:
    class Own(Scipy):
        def solve(self, b):  # type: ignore[no-untyped-def]
            return what(self.lu.solve(b))

    model = ss.Model(ss.Scene.example("block"), {"mesh.elements": [8, 4]})
    small = one_node()
    for result in (
        small.solve([1.0, 1.0], linear=Own()), small.solve([1.0, 1.0], linear=Own(), method="ip"), model.run(linear=Own()),
        small.stepper(linear=Own()).step([1.0, 1.0]),
    ):
        assert not result.converged and re.search(f"; linear: the last answer of Own is {said}|: linear: the last answer of Own is {said}", result.message)


def test_a_right_answer_of_a_foreign_solver_is_not_blamed() -> None:
    model = ss.Model(ss.Scene.example("block"), {"mesh.elements": [8, 4], "contact.friction": 0.1})
    with pytest.warns(ss.NotConvergedWarning, match="slips"):
        result = model.run(linear=Scipy())
    assert "linear" not in result.message
    with pytest.warns(ss.NotConvergedWarning):
        result = one_node().with_(weight=1.0).solve([1.0, 1.0], linear=Scipy(), setting="paper", max_iterations=1)
    assert "linear" not in result.message


def test_what_is_no_solver_is_refused_everywhere() -> None:
    model = ss.Model(ss.Scene.example("block"), {"mesh.elements": [8, 4]})
    for call in (model.run, lambda linear: one_node().solve([1.0, 1.0], linear=linear), lambda linear: one_node().stepper(linear=linear)):
        with pytest.raises(TypeError, match="^linear: int has no analyze, factorize, solve"):
            call(linear=3)
    scene, vary = ss.Scene.example("block"), {"contact.friction": [0.5, 0.7]}
    with pytest.raises(TypeError, match="^linear: Scipy is one solver.*workers=1"):
        ss.sweep(scene, vary, linear=Scipy())
    assert ss.sweep(scene, vary, overrides={"mesh.elements": [8, 4]}, linear=Scipy(), workers=1).converged.all()


@pytest.mark.parametrize("n", [2, 3])
def test_the_residual_vanishes_at_a_solution_and_newton_finds_it(n: int) -> None:
    scene, overrides = (block(), {}) if n == 2 else (SCENES / "cube.toml", {"mesh.elements": [3, 3, 3]})
    model = ss.Model(scene, overrides)  # type: ignore[arg-type]
    result, p, k = model.run(), model.problem, 5
    state = (result.u[k], result.p_n[k], result.p_t[k])
    natural = Natural(p, result.force[k], gap=result.gap[k], w_t_last=result.w_t_last[k])
    assert abs(natural.residual(*state)).max() < 1e-8 * result.p_n.max()
    # Away from kinks the Jacobian is the derivative: central differences along a random direction.
    rng = np.random.default_rng(n)
    z = np.concatenate([state[0], state[1], state[2].T.ravel()])
    size = np.concatenate([np.full(p.n_u, abs(state[0]).max()), np.full(len(z) - p.n_u, state[1].max())])
    z = z + 1e-2 * size * rng.standard_normal(len(z))

    def split(z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return z[: p.n_u], z[p.n_u : p.n_u + p.n_c], z[p.n_u + p.n_c :].reshape(p.tangents, p.n_c).T

    step = 1e-7 * size * rng.standard_normal(len(z))
    difference = natural.residual(*split(z + step)) - natural.residual(*split(z - step))
    predicted = 2 * natural.jacobian(*split(z)) @ step
    assert abs(difference - predicted).max() < 1e-4 * abs(predicted).max()


def test_problems_pickle_and_threads_agree_to_the_last_bit() -> None:
    model = pickle.loads(pickle.dumps(ss.Model(block())))
    problem = pickle.loads(pickle.dumps(model.problem))
    assert abs(problem.K - model.problem.K).max() == 0
    results: list[ss.Result | None] = [None] * 4

    def work(k: int) -> None:
        results[k] = model.run()

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    first = model.run()
    assert all(r is not None and (r.u == first.u).all() and (r.p_t == first.p_t).all() for r in results)


def test_displacements_are_kept_as_asked() -> None:
    model = ss.Model(block())
    everything = model.run()
    for keep, kept in (("all", range(10)), ("last", [9]), ("none", []), ([0, 4, -1], [0, 4, 9])):
        result = model.run(keep_u=keep)  # type: ignore[arg-type]
        assert result.kept == tuple(kept)
        assert len(result.u) == len(result.force) == len(list(kept))
        assert all((result.u[row] == everything.u[k]).all() for row, k in enumerate(kept))
    with pytest.raises(ValueError, match="keep_u"):
        model.run(keep_u="none").displacement()


def test_a_body_that_only_friction_holds_has_its_free_motions_found() -> None:
    K = sp.csc_array([[1.0, 0.0], [0.0, 0.0]])
    problem = ss.ContactProblem(K, [[1.0, 0.0]], [[0.0, 1.0]], 0.5)
    assert abs(abs(problem.free_motions) - [[0.0, 1.0]]).max() < 1e-12
    with pytest.raises(ValueError, match="free motions"):
        problem.compliance()


def test_data_of_a_problem_cannot_be_assigned() -> None:
    problem = ss.ContactProblem(np.eye(2), np.eye(2)[:1], np.eye(2)[1:], 0.3, weight=1.0)
    held = ss.ContactProblem(np.diag([0.0, 1.0]), np.eye(2)[:1], np.eye(2)[1:], 0.3)
    arrays = [problem.mu, problem.weight, held.free_motions]
    for matrix in (problem.K, problem.C_n, *problem.C_t, problem.condense().K):
        arrays += [matrix.data, matrix.indices, matrix.indptr]
    for array in arrays:
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
    own = problem.K.copy()
    own[0, 0] = own.data[1] = 2.0
    assert own.sum() == 4.0 and problem.K.sum() == 2.0


def test_arrays_of_a_model_cannot_be_assigned() -> None:
    model = ss.Model(ss.Scene.example("block"), {"mesh.elements": [8, 4]})
    arrays = [model.t, model.points, model.contact_nodes, model.contact_points, model.frames]
    arrays += [*model.boundaries.values(), *(nodes for _, nodes in model.cells), *model.history.values()]
    for array in arrays:
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
    given = ss.siconos.to_siconos(model.problem, model.history["force"][-1])
    given.M.data[0] = given.mu[0] = 0.0


@pytest.mark.parametrize("scene, tangents", [(block(n=4), 1), (SCENES / "cube.toml", 2)])
def test_tangents_are_a_tuple_that_a_problem_takes_back(scene: object, tangents: int) -> None:
    p = ss.Model(scene, {} if tangents == 1 else {"mesh.elements": [3, 3, 3]}).problem  # type: ignore[arg-type]
    again = p.with_(C_n=p.C_n, C_t=p.C_t)
    assert type(p.C_t) is tuple and len(p.C_t) == len(again.C_t) == again.tangents == tangents
    assert all(abs(a - b).sum() == 0.0 for a, b in zip(p.C_t, again.C_t))
    assert ss.ContactProblem(np.eye(2), [[0, -1]]).C_t == ()


def test_a_run_that_failed_has_its_reason() -> None:
    model = ss.Model(ss.Scene.example("block"), {"mesh.elements": [8, 4]})
    problem, history = model.problem, model.history
    with pytest.warns(ss.NotConvergedWarning, match="a joint slips as a whole"):
        pushed = problem.solve(history["force"], mu=0.05)
    assert pushed.status == "slips"
    unheld = ss.ContactProblem(sp.diags([0.0, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    with pytest.warns(ss.NotConvergedWarning):
        stepped = unheld.stepper().step([40.0, -100.0])
        many = problem.solve_many(history["force"], mus=[0.05])
        hurried = problem.solve(3.0 * history["force"], max_iterations=1, tolerance=1e-15)
    for result in (pushed, stepped, many[0], hurried):
        assert not result.converged and result.reason and result.reason in result.message


def test_each_status_has_a_reason() -> None:
    text = (SCENES.parents[1] / "src/solver/history/record.rs").read_text(encoding="utf-8")
    variants = re.findall(r"^    ([A-Z]\w+),$", text.split("pub enum Status {")[1].split("\n}")[0], re.MULTILINE)
    statuses = {re.sub(r"(?<!^)([A-Z])", r"-\1", variant).lower() for variant in variants}
    assert len(statuses) > 10 and statuses - {"converged"} == set(REASONS)


def test_friction_work_is_that_of_all_increments() -> None:
    model = ss.Model(block(6, 6))
    result = model.run()
    assert result.friction_work == pytest.approx(result.report["friction"]["friction_work"]) and result.friction_work > 0
    small = model.problem.condense()
    loads = small.reduce(model.history["force"])
    condensed = small.solve(loads, gap=1e-5)
    assert condensed.friction_work == pytest.approx(result.friction_work)
    many = small.solve_many(loads, gap=1e-5, mus=[0.3, 0.4])
    np.testing.assert_allclose(many.stack("friction_work"), [one.friction_work for one in many])
    assert many.stack("friction_work")[1] == pytest.approx(result.friction_work)
    in_mm = ss.Scene(block(6, 6).to_dict()).units(length="m", stress="kPa").to_dict()
    in_mm["material"]["young"], in_mm["load"][0]["traction"], in_mm["load"][1]["traction"] = 210e6, [0.0, -10e3], [-10e3, 0.0]
    assert ss.run(in_mm).friction_work == pytest.approx(result.friction_work)


def test_dependent_rows_have_their_friction_work() -> None:
    one = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    two = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]] * 2, [[1, 0]] * 2, mu=0.3)
    history = [[0.0, -100.0], [40.0, -100.0], [-80.0, -100.0]]
    single, double = one.solve(history), two.solve(history).check()
    assert double.friction_work == pytest.approx(single.friction_work)
    assert double.records[-1]["strain_energy"] == pytest.approx(single.records[-1]["strain_energy"])


def test_the_strain_energy_of_a_condensed_problem_is_that_of_the_condensed_body() -> None:
    model = ss.Model(block(4, 1))
    whole, force = model.problem, model.history["force"]
    small = whole.condense()
    result = small.solve(small.reduce(force), gap=1e-5)
    u_c, u = result.u[-1], small.lift(result.u, force)[-1]
    assert result.records[-1]["strain_energy"] == pytest.approx(0.5 * u_c @ small.K @ u_c)
    assert whole.solve(force, gap=1e-5).records[-1]["strain_energy"] == pytest.approx(0.5 * u @ whole.K @ u)
    assert result.records[-1]["strain_energy"] < 0.9 * (0.5 * u @ whole.K @ u)
    assert "small.whole.K @ u / 2" in (ss.CondensedProblem.__doc__ or "")


@pytest.mark.parametrize("step", ["analyze", "factorize", "solve"])
def test_factorize_alone_says_that_a_matrix_is_singular(step: str) -> None:
    def breaks(*_: object) -> None:
        raise ZeroDivisionError("by zero")

    own = Scipy()
    setattr(own, step, breaks)
    if step == "factorize":
        with pytest.warns(ss.NotConvergedWarning, match="singular"):
            assert one_node().solve([1.0, 1.0], linear=own).status == "singular"
    else:
        with pytest.raises(RuntimeError, match=rf"^linear\.{step}: Scipy raised ZeroDivisionError: by zero"):
            one_node().solve([1.0, 1.0], linear=own)


def test_options_that_may_be_left_out_may_be_none() -> None:
    result = one_node().solve([1.0, 1.0])
    for options in ({"r_factor": None}, {"max_iterations": None}, {"r_factor": np.float32(1)}):
        again = one_node().solve([1.0, 1.0], **options)  # type: ignore[arg-type]
        assert (again.u == result.u).all() and one_node().stepper(**options).step([1.0, 1.0]).converged  # type: ignore[arg-type]


@pytest.mark.parametrize("keep_u", [None, [0.0], ["all"], 3])
def test_which_displacements_are_kept_is_said_in_words(keep_u: object) -> None:
    with pytest.raises(ValueError, match="^keep_u is .*, expected"):
        one_node().solve([1.0, 1.0], keep_u=keep_u)  # type: ignore[arg-type]


@pytest.mark.parametrize("scene, overrides", [(block(), {}), (SCENES / "cube.toml", {"mesh.elements": [3, 3, 3]}), (SCENES / "cattaneo_mindlin.toml", {
    "mesh.elements": [[6, 8, 6], 8], "time.increments": 4,
}), (SCENES / "turning_load.toml", {"mesh.elements": [8, 8]})])
def test_the_history_of_a_model_is_that_of_its_problem(scene: Any, overrides: dict[str, Any]) -> None:
    model = ss.Model(scene, overrides)
    result, expected = model.problem.solve(**model.history), model.run()
    assert (result.t == expected.t).all() and result.converged
    np.testing.assert_allclose(result.p_n, expected.p_n, rtol=0, atol=1e-8 * expected.p_n.max())
    np.testing.assert_allclose(result.p_t, expected.p_t, rtol=0, atol=1e-8 * expected.p_n.max())
    loads = model.problem.solve(*model.loads, **{key: table for key, table in model.history.items() if key != "force"})
    np.testing.assert_allclose(loads.p_t, expected.p_t, rtol=0, atol=1e-8 * expected.p_n.max())


def test_drift_is_a_number_or_a_part_that_is_repeated() -> None:
    K = np.diag([2e6, 1e6] * 2)
    problem = ss.ContactProblem(K, [[0, -1, 0, 0], [0, 0, 0, -1]], [[1, 0, 0, 0], [0, 0, 1, 0]], mu=0.3)
    force = [[0, -100, 0, -100]] * 3
    for drift, whole in ((1e-5, np.full((3, 2), 1e-5)), ([[0.0], [1e-5], [2e-5]], np.outer([0.0, 1e-5, 2e-5], [1, 1])), ([[1e-5, 2e-5]], [[1e-5, 2e-5]] * 3)):
        expected = problem.solve(force, drift=whole)
        assert (problem.solve(force, drift=drift).p_t == expected.p_t).all() and expected.p_t.any()
        assert (problem.solve_many(force, mus=[0.3], drift=drift)[0].p_t == expected.p_t).all()
        assert ss.judge(problem, "bn", history={"force": force, "drift": drift}).p_t[-1].sum() == pytest.approx(expected.p_t[-1].sum())
    assert (problem.stepper().step(force[0], drift=1e-5).p_t == problem.stepper().step(force[0], drift=[1e-5, 1e-5]).p_t).all()
    assert ss.ContactProblem(K, [[0, -1, 0, 0]]).solve(force, drift=0.0).converged
    for wrong in ([1e-5], [[1e-5] * 3], np.zeros((2, 2))):
        with pytest.raises(ValueError, match=r"^drift has the shape .*, expected a number, \(3, 2\) or \(3, 2, 1\)"):
            problem.solve(force, drift=wrong)


@pytest.mark.parametrize("t", [[0.0, 1.0], [1.0, 1.0], [1.0]])
def test_ends_of_increments_of_a_history_that_do_not_fit(t: list[float]) -> None:
    with pytest.raises(ValueError, match=r"^history\['t'\] (must increase|has the shape)"):
        ss.judge(one_node(), "bn", history={"force": [[0.0, -1.0], [0.1, -1.0]], "t": t})
