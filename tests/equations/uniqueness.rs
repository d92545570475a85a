//! Uniqueness: the critical friction against closed forms and dense algebra, and what happens
//! below and above it to the one node of Klarbring (1990), worked out by hand.

use crate::common::prelude::*;
use faer::Mat;
use faer::prelude::Solve;
use stickslip::solver::formulation::Pressure;
use stickslip::solver::{Armijo, Bn, StopCriterion};

/// One node on a plane, `K = [[k_tt, k_tn], [k_tn, 2]]` N/m for `u = (u_t, u_n)`, no gap.
fn node(k_tt: f64, k_tn: f64, mu: f64) -> ContactProblem {
    let entries = [(0, 0, k_tt), (1, 0, k_tn), (1, 1, 2.0)];
    let node = common::nodes::node(2, &entries, [&[(1, 1.0)], &[(0, 1.0)], &[]], mu);
    let rigid_modes = if k_tt == 0.0 { vec![vec![1.0, 0.0]] } else { vec![] };
    common::changed(&node, |parts| parts.rigid_modes = Some(rigid_modes))
}

/// The example of VERIFY: `K = [[2, 1.5], [1.5, 2]]`.
fn example(mu: f64) -> ContactProblem {
    node(2.0, 1.5, mu)
}

/// To be measured with the friction of a problem.
fn load(force: &[f64; 2]) -> Increment<'_> {
    Increment { force, gap: &[0.0], mu: &[], w_t_last: &[0.0], w_o_last: &[0.0] }
}

fn state(u: [f64; 2], p_t: f64, p_n: f64) -> State {
    State { u: u.to_vec(), u_rest: Vec::new(), p_t: vec![p_t], p_o: vec![0.0], p_n: vec![p_n] }
}

fn critical(problem: &ContactProblem, increment: &Increment<'_>, state: &State) -> CriticalFriction {
    let increment = &Increment { mu: problem.mu(), ..*increment };
    let mut linear = RefinedSolver::default();
    critical_friction(problem, increment, state, Scaling::SI, &mut linear).unwrap().unwrap()
}

fn kkt(problem: &ContactProblem, increment: &Increment<'_>, state: &State) -> f64 {
    let increment = &Increment { mu: problem.mu(), ..*increment };
    KktErrors::measure(problem, increment, state, &KktScales::default()).unwrap().worst().1
}

/// Every start of a grid of `(u_t, u_n, p_t, p_n)`.
fn grid() -> Vec<[f64; 4]> {
    let displacements = [-2.0, -0.6, 0.0, 0.45, 1.7];
    let forces = [-3.0, -0.9, 0.0, 0.55, 1.1, 4.0];
    let mut starts = Vec::new();
    for u_t in displacements {
        for u_n in displacements {
            starts.extend(forces.into_iter().flat_map(|p_t| forces.map(|p_n| [u_t, u_n, p_t, p_n])));
        }
    }
    starts
}

/// BN from one start; the solution if it gets there, and the law holds.
fn solve(problem: &ContactProblem, increment: &Increment<'_>, start: [f64; 4]) -> Option<State> {
    let conventions =
        FormulationScaling { r_n: vec![1.0], r_t: vec![1.0], pressure: Pressure::Unknown, row_unit: vec![1.0] };
    let mut formulation = Bdiff::new(problem, Scaling::SI, &conventions);
    formulation.begin(&Increment { mu: problem.mu(), ..*increment }, &vec![0.0; formulation.unknowns()]);
    let mut linear = RefinedSolver::default();
    linear.analyze(formulation.jacobian()).unwrap();
    let mut z = start;
    let mut bn = Bn::new(Armijo::PAPER, 60, formulation.unknowns());
    bn.solve(&mut formulation, &mut linear, &mut z, StopCriterion::Merit(1e-26), &mut |_| ControlFlow::Continue(()))
        .unwrap();
    let state = formulation.layout().unpack(&z, &Scaling::SI).unwrap();
    (kkt(problem, increment, &state) < 1e-12).then_some(state)
}

/// The different solutions that the grid leads to, with the number of starts that lead to each.
fn solutions(problem: &ContactProblem, increment: &Increment<'_>) -> Vec<(State, usize)> {
    let mut found: Vec<(State, usize)> = Vec::new();
    for state in grid().into_iter().filter_map(|start| solve(problem, increment, start)) {
        match found.iter_mut().find(|(known, _)| near(known, &state)) {
            Some((_, count)) => *count += 1,
            None => found.push((state, 1)),
        }
    }
    found
}

fn near(a: &State, b: &State) -> bool {
    let values = |s: &State| [s.u[0], s.u[1], s.p_t[0], s.p_n[0]];
    values(a).iter().zip(values(b)).all(|(a, b)| (a - b).abs() < 1e-9)
}

fn contains(found: &[(State, usize)], wanted: &State) -> bool {
    found.iter().any(|(state, _)| near(state, wanted))
}

/// `K_tt / |K_tn|`, from slipping solutions with less and with more friction than that.
#[test]
fn one_node_has_its_closed_form() {
    // Sliding forwards: 2 u_t = f_t - mu p_n and 1.5 u_t = f_n - p_n.
    for (mu, force) in [(0.3, [1.0, 1.0]), (1.2, [1.3, 1.0]), (1.5, [1.4, 1.0]), (2.0, [1.6, 1.0])] {
        let problem = example(mu);
        let p_n = (2.0 * force[1] - 1.5 * force[0]) / (2.0 - 1.5 * mu);
        let u_t = (force[0] - mu * p_n) / 2.0;
        assert!(p_n > 0.0 && u_t > 0.0);
        let (increment, state) = (load(&force), state([u_t, 0.0], mu * p_n, p_n));
        assert!(kkt(&problem, &increment, &state) < 1e-14);
        let CriticalFriction { factor, slipping } = critical(&problem, &increment, &state);
        assert!((factor * mu - 4.0 / 3.0).abs() < 1e-12, "mu {mu}: {factor}");
        assert_eq!(slipping, 1);
    }
}

#[test]
fn where_friction_cannot_be_critical() {
    let force = [-1.0, 1.0];
    // Sliding backwards lifts the node instead of pressing it: any friction will do.
    let mu = 0.9;
    let p_n = 1.75 / (1.0 + 0.75 * mu);
    let backwards = state([0.5 * (mu * p_n - 1.0), 0.0], -mu * p_n, p_n);
    assert!(kkt(&example(mu), &load(&force), &backwards) < 1e-14);
    let none = |slipping| CriticalFriction { factor: f64::INFINITY, slipping };
    assert_eq!(critical(&example(mu), &load(&force), &backwards), none(1));
    // Tangent and normal do not feel each other.
    let slides = state([0.35, 0.0], 0.3, 1.0);
    assert_eq!(critical(&node(2.0, 0.0, 0.3), &load(&[1.0, 1.0]), &slides), none(1));
    // Stick, open, and without friction: no node slips with friction.
    let force = [1.6, 1.0];
    assert_eq!(critical(&example(2.0), &load(&force), &state([0.0; 2], 1.6, 1.0)), none(0));
    assert_eq!(critical(&example(2.0), &load(&force), &state([1.7 / 1.75, -0.4 / 1.75], 0.0, 0.0)), none(0));
    assert_eq!(critical(&example(0.0), &load(&[1.0, 1.0]), &state([0.5, 0.0], 0.0, 0.25)), none(0));
}

/// Nothing but friction acts along the tangent, declared as a free motion or not.
#[test]
fn a_body_that_slides_freely_is_singular_without_friction() {
    let slides = state([1.0, 0.0], 0.3, 1.0);
    let singular = CriticalFriction { factor: 0.0, slipping: 1 };
    let problem = node(0.0, 0.0, 0.3);
    assert_eq!(critical(&problem, &load(&[0.3, 1.0]), &slides), singular);
    let problem = common::changed(&problem, |parts| parts.rigid_modes = Some(Vec::new()));
    assert_eq!(critical(&problem, &load(&[0.3, 1.0]), &slides), singular);
}

/// mu = 2 > 4/3, f = (1.6, 1): stick, slip and open are solutions, and BN finds each from somewhere.
#[test]
fn above_the_critical_friction_there_are_three_solutions() {
    let (problem, force) = (example(2.0), [1.6, 1.0]);
    let increment = load(&force);
    let stick = state([0.0, 0.0], 1.6, 1.0);
    let slip = state([0.4, 0.0], 0.8, 0.4);
    let open = state([1.7 / 1.75, -0.4 / 1.75], 0.0, 0.0);
    let found = solutions(&problem, &increment);
    assert_eq!(found.len(), 3, "{found:?}");
    for wanted in [&stick, &slip, &open] {
        assert!(kkt(&problem, &increment, wanted) < 1e-14);
        assert!(contains(&found, wanted), "{found:?}");
    }
    // Only the one in the middle tells: stick and open do not depend on the friction.
    assert!(!critical(&problem, &increment, &slip).regular());
    assert!(critical(&problem, &increment, &stick).regular() && critical(&problem, &increment, &open).regular());
}

/// mu = 2, f = (2.1, 1): the cone cannot hold the node, and sliding would need a negative pressure.
#[test]
fn above_the_critical_friction_a_load_may_leave_only_the_open_solution() {
    let (problem, force) = (example(2.0), [2.1, 1.0]);
    let found = solutions(&problem, &load(&force));
    // K⁻¹ f = (4.2 - 1.5, 2 - 3.15) / 1.75.
    assert!(contains(&found, &state([2.7 / 1.75, -1.15 / 1.75], 0.0, 0.0)), "{found:?}");
    assert_eq!(found.len(), 1, "{found:?}");
}

/// Loads that make the node stick, slip either way and open.
const FORCES: [[f64; 2]; 7] = [[1.6, 1.0], [1.3, 1.0], [1.0, 1.0], [2.1, 1.0], [-1.3, 1.0], [-2.0, 0.5], [0.3, -1.0]];

/// mu = 1.2 < 4/3: each load has one solution, and no start leads BN to another.
#[test]
fn below_the_critical_friction_every_start_leads_to_one_solution() {
    let problem = example(1.2);
    for force in FORCES {
        let found = solutions(&problem, &load(&force));
        assert_eq!(found.len(), 1, "{force:?}: {found:?}");
        let (solution, starts) = &found[0];
        // To the one that sticks, with so much friction, BN finds the way from 147 starts of 900 only.
        let sticks = *solution == state([0.0; 2], solution.p_t[0], solution.p_n[0]) && solution.p_n[0] > 0.0;
        assert!(*starts == grid().len() || sticks && *starts > 100, "{force:?}: {found:?}");
    }
}

/// The signs of det J, which turns with the only eigenvalue, add up to that without friction.
#[test]
fn the_signs_of_all_solutions_add_up_to_one() {
    for (mu, force) in [0.3, 1.2, 1.5, 2.0].into_iter().flat_map(|mu| FORCES.map(|force| (mu, force))) {
        let (problem, increment) = (example(mu), load(&force));
        let found = solutions(&problem, &increment);
        let sign = |state: &State| if critical(&problem, &increment, state).regular() { 1 } else { -1 };
        assert_eq!(found.iter().map(|(state, _)| sign(state)).sum::<i32>(), 1, "mu {mu}, {force:?}: {found:?}");
    }
}

/// The block with no gap, and a state in which node `i` does what `wanted[i]` says, sliding in the
/// direction of `s[i]`: not a solution, but only its statuses and signs matter.
pub(crate) fn posed(
    cells: &str,
    n: usize,
    mu: f64,
    wanted: &[ContactStatus],
    s: &[f64],
) -> (Model, Vec<f64>, State, Vec<f64>) {
    // Half as many elements have a node between corners each.
    let along = if cells == "triangle6" { n / 2 } else { n };
    let elements = format!("mesh.elements=[{along},{along}]");
    let (friction, cells) = (format!("contact.friction={mu}"), format!("mesh.cells=\"{cells}\""));
    let model = discretise(&common::block(&[&elements, &friction, &cells])).unwrap();
    let mut state = State::zero(&model.problem);
    let mut gap = vec![0.0; n];
    let mut w_t_last = vec![0.0; n];
    for i in 0..n {
        match wanted[i] {
            ContactStatus::Open => gap[i] = 1e-5,
            ContactStatus::Stick => state.p_n[i] = 1e5,
            ContactStatus::Slip => {
                state.p_n[i] = 1e5;
                state.p_t[i] = s[i] * mu * 1e5;
                w_t_last[i] = -s[i] * 1e-5;
            }
        }
    }
    (model, gap, state, w_t_last)
}

pub(crate) fn posed_critical(cells: &str, n: usize, mu: f64, wanted: &[ContactStatus], s: &[f64]) -> f64 {
    let (model, gap, state, w_t_last) = posed(cells, n, mu, wanted, s);
    let force = vec![0.0; model.problem.displacements()];
    let (mu, w_o_last) = (model.problem.mu(), vec![0.0; w_t_last.len()]);
    let increment = Increment { force: &force, gap: &gap, mu, w_t_last: &w_t_last, w_o_last: &w_o_last };
    assert_eq!(statuses(&model.problem, &increment, &state).unwrap(), wanted);
    let mut linear = RefinedSolver::default();
    let critical =
        critical_friction(&model.problem, &increment, &state, model.scaling(), &mut linear).unwrap().unwrap();
    assert_eq!(critical.slipping, wanted.iter().filter(|status| **status == ContactStatus::Slip).count());
    critical.factor
}

/// `κ_c` from the dense compliance `W = C K⁻¹ Cᵀ` of the held rows: `w_n` of closed nodes, `w_t` of
/// sticking ones. With `A` its block of held rows and `B` the columns of sliding tangents,
/// `dp = -A⁻¹ B diag(μ s) v`, of which the normal forces at the sliding nodes are `T v`.
fn dense_critical(problem: &ContactProblem, mu: f64, wanted: &[ContactStatus], s: &[f64]) -> f64 {
    let n_u = problem.displacements();
    let mut k = Mat::<f64>::zeros(n_u, n_u);
    for (row, column, value) in problem.stiffness().assembled().unwrap().entries() {
        k[(row, column)] += value;
    }
    let nodes = |keep: &dyn Fn(ContactStatus) -> bool| -> Vec<usize> {
        (0..wanted.len()).filter(|&i| keep(wanted[i])).collect()
    };
    let sliding = nodes(&|status| status == ContactStatus::Slip);
    let closed = nodes(&|status| status != ContactStatus::Open);
    let sticking = nodes(&|status| status == ContactStatus::Stick);
    let rows = |c: &Csr, nodes: &[usize]| -> Vec<Vec<(usize, f64)>> {
        nodes.iter().map(|&i| c.row(i).iter().map(|&(dof, value)| (dof, value)).collect()).collect()
    };
    let mut held = rows(problem.c_n(), &closed);
    held.extend(rows(problem.c_t(), &sticking));
    let driven = rows(problem.c_t(), &sliding);
    let dense = |rows: &[Vec<(usize, f64)>]| {
        let mut c = Mat::<f64>::zeros(rows.len(), n_u);
        for (i, row) in rows.iter().enumerate() {
            for &(dof, value) in row {
                c[(i, dof)] = value;
            }
        }
        c
    };
    let (held, driven) = (dense(&held), dense(&driven));
    let lu = k.partial_piv_lu();
    let a = &held * lu.solve(held.transpose().to_owned());
    let b = &held * lu.solve(driven.transpose().to_owned());
    let p = a.partial_piv_lu().solve(b);
    let place = |node: usize| closed.iter().position(|&i| i == node).unwrap();
    let t = Mat::from_fn(sliding.len(), sliding.len(), |i, j| -p[(place(sliding[i]), j)] * mu * s[sliding[j]]);
    let eigenvalues = t.eigenvalues().unwrap();
    let real = eigenvalues.iter().filter(|value| value.im == 0.0).map(|value| value.re);
    1.0 / real.fold(0.0, f64::max)
}

#[test]
fn the_block_agrees_with_dense_algebra() {
    use ContactStatus::{Open, Slip, Stick};
    let mut finite = 0;
    for (mu, wanted, s) in [
        (0.4, [Slip; 6], [1.0; 6]),
        (0.4, [Slip; 6], [-1.0; 6]),
        (3.5, [Slip; 6], [1.0; 6]),
        (0.8, [Slip; 6], [1.0, 1.0, -1.0, -1.0, -1.0, -1.0]),
        (0.8, [Open, Open, Slip, Slip, Stick, Stick], [1.0; 6]),
        (0.8, [Stick, Slip, Slip, Stick, Slip, Open], [1.0, -1.0, -1.0, 1.0, 1.0, 1.0]),
        (0.8, [Open, Stick, Slip, Slip, Slip, Slip], [-1.0; 6]),
        (0.8, [Open, Stick, Slip, Slip, Slip, Slip], [1.0; 6]),
    ] {
        for cells in ["quadrilateral", "triangle6"] {
            let factor = posed_critical(cells, 6, mu, &wanted, &s);
            let expected = dense_critical(&posed(cells, 6, mu, &wanted, &s).0.problem, mu, &wanted, &s);
            finite += usize::from(expected.is_finite());
            assert!(
                factor == expected || (factor / expected - 1.0).abs() < 1e-9,
                "{cells} {wanted:?} {s:?}: {factor} {expected}"
            );
        }
    }
    assert!(finite >= 5, "{finite}");
}

/// VERIFY: 3.02–3.10 with all nodes slipping; and `μ_c` itself does not depend on the friction.
#[test]
fn the_block_has_its_known_critical_friction() {
    for n in [6, 10, 20, 40] {
        let wanted = vec![ContactStatus::Slip; n];
        let [low, high] = [0.4, 3.5].map(|mu| mu * posed_critical("quadrilateral", n, mu, &wanted, &vec![1.0; n]));
        assert!((3.0..3.12).contains(&low), "n = {n}: {low}");
        assert!((low / high - 1.0).abs() < 1e-12, "n = {n}: {low} {high}");
    }
}
