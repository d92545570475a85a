//! An increment that fails is halved: what the failed tries did must leave no trace.

use crate::common::prelude::*;
use stickslip::solver::MethodResult;
use stickslip::solver::history::IncrementRecord;

/// BN that gives up after so many iterations, without help from the interior point method.
fn hasty(model: &Model, iterations: usize, times: &[f64], keep: &mut Keep) -> HistoryOutcome {
    let mut settings = settings_of(model, Method::BN).until(iterations, 1e-10);
    if let Method::Bn { rescue, .. } = &mut settings.method {
        *rescue = false;
    }
    history_of(model, times, &settings, SystemSolver::default(), keep)
}

/// Nearly incompressible, which makes BN work for its solution.
fn model(n: usize, friction: f64) -> Model {
    let (mesh, friction) = (format!("mesh.elements=[{n},{n}]"), format!("contact.friction={friction}"));
    discretise(&common::block(&[&mesh, &friction, "material.poisson=0.49"])).unwrap()
}

/// The first path in eight steps, the second in one, which the hasty method halves.
#[test]
fn halves_are_increments_of_their_own() {
    let model = model(20, 0.4);
    let loading: Vec<f64> = (1..=8).map(|k| f64::from(k) / 8.0).collect();
    let mut first = Keep::default();
    // As many iterations as the first path needs: the second needs more. A divided increment counts those of its parts.
    let first = hasty(&model, 40, &loading, &mut first).records;
    let needed = first.iter().filter(|r| r.parts == 1).map(|r| r.iterations).max().unwrap();
    let mut keep = Keep::default();
    let outcome = hasty(&model, needed, &[&loading[..], &[2.0]].concat(), &mut keep);
    let parts = outcome.records.last().unwrap().parts;
    assert!(outcome.status == Status::Converged && parts > 1, "the test has lost its case");
    // The reference has an increment for each part.
    let ends = |r: &IncrementRecord| if r.parts > 1 { r.part_ends.clone() } else { vec![r.time] };
    let ends: Vec<f64> = outcome.records.iter().flat_map(ends).collect();
    let mut whole = Keep::default();
    let settings = settings_of(&model, Method::BN).until(40, 1e-10);
    let settings = HistorySettings { halvings: 0, ..settings };
    let (problem, loading) = (&model.problem, &model.loading);
    let reference = history::run(problem, loading, &ends, &settings, SystemSolver::default(), &mut whole).unwrap();
    assert_eq!(reference.status, Status::Converged);
    let (found, expected) = (keep.states.last().unwrap(), whole.states.last().unwrap());
    assert!(forces_apart(found, expected) <= 1e-9);
    // The observer sees the slip of the second half.
    assert_eq!(keep.w_t_last.last().unwrap().len(), whole.w_t_last.last().unwrap().len());
    for (a, b) in keep.w_t_last.last().unwrap().iter().zip(whole.w_t_last.last().unwrap()) {
        assert!((a - b).abs() <= 1e-9 * 1e-4, "{a} {b}");
    }
    // The work of both halves counts.
    let work = |outcome: &HistoryOutcome| outcome.records.iter().map(|r| r.friction_work).sum::<f64>();
    let (found, expected) = (work(&outcome), work(&reference));
    assert!(expected > 0.0 && (found - expected).abs() <= 1e-9 * expected, "{found} {expected}");
}

/// After a part that converges the rest is tried whole: few parts, not 64.
#[test]
fn the_size_grows_back() {
    let model = model(20, 0.4);
    let outcome = hasty(&model, 5, &[1.0, 2.0], &mut Keep::default());
    assert_eq!(outcome.status, Status::Converged);
    let parts: Vec<usize> = outcome.records.iter().map(|record| record.parts).collect();
    assert!(parts.iter().any(|&parts| parts > 1) && parts.iter().all(|&parts| parts <= 16), "{parts:?}");
}

/// Without friction the path does not matter: any number of parts leads to the same state.
#[test]
fn without_friction_parts_change_nothing() {
    let model = model(40, 0.0);
    let whole = hasty(&model, 40, &[1.0, 2.0], &mut Keep::default());
    let parts = hasty(&model, 4, &[1.0, 2.0], &mut Keep::default());
    assert_eq!([whole.status, parts.status], [Status::Converged; 2]);
    assert!(parts.records.iter().any(|record| record.parts > 1), "the test has lost its case");
    assert!(apart(&parts.state.p_n, &whole.state.p_n) <= 1e-10);
}

/// Where no part is small enough, the history ends with the last good state and says how far it came.
#[test]
fn an_increment_that_no_halving_saves() {
    let model = model(20, 0.4);
    let mut keep = Keep::default();
    let outcome = hasty(&model, 1, &[1.0, 2.0], &mut keep);
    assert_ne!(outcome.status, Status::Converged);
    assert!(outcome.violation.is_some());
    let failed = outcome.records.last().unwrap();
    let before = if failed.index == 1 { 0.0 } else { 1.0 };
    assert!(outcome.reached >= before && outcome.reached < failed.time);
    match failed.index {
        1 => assert!(outcome.state.u.iter().all(|u| *u == 0.0)),
        k => assert_eq!(&outcome.state, &keep.states[k - 2]),
    }
}

/// BN that does nothing where the first gap has changed by more than 0.3 m since it last did something.
struct Timid(HistorySettings);

impl Algorithm for Timid {
    fn start(&self, problem: &ContactProblem, loading: &Loading) -> Box<dyn IncrementSolver> {
        gives_up(self.0.start(problem, loading), 0.0)
    }
}

/// A method that gives up as [`Timid`] does, and leaves a displacement that is not a number.
struct Lost(HistorySettings);

impl Algorithm for Lost {
    fn start(&self, problem: &ContactProblem, loading: &Loading) -> Box<dyn IncrementSolver> {
        gives_up(self.0.start(problem, loading), f64::NAN)
    }
}

/// Returns a method that gives up where a gap changes by more than 0.3 m, and then adds `leaves` to a displacement, m.
fn gives_up(inner: Box<dyn IncrementSolver>, leaves: f64) -> Box<dyn IncrementSolver> {
    let mut gap = 0.0_f64;
    around(inner, move |inner, task, linear, observe| {
        if (task.increment.gap[0] - gap).abs() > 0.3 {
            inner.unknowns()[0] += leaves;
            return Ok(MethodResult::new(1.0));
        }
        gap = task.increment.gap[0];
        inner.solve(task, linear, observe)
    })
}

/// An obstacle moves by 1 m into a node on springs. Before the first increment that is solved there is no force at all, against which
/// rounding could be told from an error; and where numbers are lost, that is no rounding either.
#[test]
fn without_any_force_a_failure_is_halved_too() {
    let stiffness = Symmetric::from_triplets(2, &[(0, 0, 2.0), (1, 1, 2.0)]).unwrap();
    let problem = ContactProblem::new(Parts::new(stiffness, Csr::from_rows(2, [[(1, 1.0)]]).unwrap())).unwrap();
    let comes = Motion::new(0..1, vec![-1.0], vec![[0.0; 2]], vec![[0.0, 0.0], [1.0, 1.0]]).unwrap();
    let loading = Loading::new(Vec::new(), vec![0.0]).unwrap().with_motions(vec![comes], Vec::new()).unwrap();
    let settings = HistorySettings::new(&problem, &loading, Method::BN).unwrap();
    for (name, algorithm) in
        [("timid", Box::new(Timid(settings.clone())) as Box<dyn Algorithm>), ("lost", Box::new(Lost(settings.clone())))]
    {
        let system = SystemSolver::default();
        let outcome = history::run_with(&problem, &loading, &[1.0], &*algorithm, &settings, system, &mut ()).unwrap();
        assert_eq!(outcome.status, Status::Converged, "{name}: {:?}", outcome.records);
        assert_eq!(outcome.records[0].part_ends, [0.25, 0.5, 0.75, 1.0], "{name}");
        assert!((outcome.state.p_n[0] - 2.0).abs() < 1e-12, "{name}");
    }
}
