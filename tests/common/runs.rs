//! Histories and runs of models, and how far apart their numbers are.

use std::ops::ControlFlow;

use stickslip::body::{Description, Model};
use stickslip::run::Run;
use stickslip::run::report::RunReport;
use stickslip::solver::State;
use stickslip::solver::history::{self, HistoryOutcome, HistorySettings, Method, Observer, SolverChoice, Status};
use stickslip::solver::history::{IncrementView, LinearAlgebra, SystemSolver};

use super::Keep;

/// BN as it is if nothing is said.
pub fn bn() -> SolverChoice {
    SolverChoice::new(Method::BN)
}

/// A method with one way of linear algebra.
pub fn solver_of(method: Method, linear: LinearAlgebra) -> SolverChoice {
    SolverChoice { linear: Some(linear), ..SolverChoice::new(method) }
}

/// Whole and condensed matrices.
pub fn both() -> [LinearAlgebra; 2] {
    [LinearAlgebra::default(), LinearAlgebra::condensed()]
}

/// The settings of a method for a model.
pub fn settings_of(model: &Model, method: Method) -> HistorySettings {
    HistorySettings::new(&model.problem, &model.loading, method).unwrap()
}

/// The history of a model, converged or not.
pub fn history_of(
    model: &Model,
    times: &[f64],
    settings: &HistorySettings,
    linear: impl Into<SystemSolver>,
    observer: &mut dyn Observer,
) -> HistoryOutcome {
    history::run(&model.problem, &model.loading, times, settings, linear.into(), observer).unwrap()
}

/// Solves a history in this way and keeps the states of all increments.
pub fn recorded(
    model: &Model,
    times: &[f64],
    settings: &HistorySettings,
    linear: impl Into<SystemSolver>,
) -> (HistoryOutcome, Keep) {
    let mut keep = Keep::default();
    (history_of(model, times, settings, linear, &mut keep), keep)
}

/// An observer that passes each increment on.
pub fn each(observe: impl FnMut(&IncrementView<'_>)) -> impl Observer {
    struct Each<F>(F);
    impl<F: FnMut(&IncrementView<'_>)> Observer for Each<F> {
        fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
            (self.0)(step);
            ControlFlow::Continue(())
        }
    }
    Each(observe)
}

/// The report of a run, which has converged.
pub fn converged(model: &Model, solver: SolverChoice, observer: &mut dyn Observer) -> RunReport {
    let report = Run::of(model, model.times().to_vec(), solver).unwrap().solve(observer).unwrap();
    assert_eq!(report.status, Status::Converged, "{}", report.explanation.reason);
    report
}

/// The report of a run, which has converged with all forces in balance.
pub fn balanced(model: &Model, solver: SolverChoice) -> RunReport {
    let report = converged(model, solver, &mut ());
    assert!(report.reactions.iter().all(|record| record.balance < 1e-9), "{:?}", report.reactions);
    report
}

/// The model of a description, and the report of its run by BN, which has converged.
pub fn solved_by_bn(description: &Description, observer: &mut dyn Observer) -> (Model, RunReport) {
    let model = Model::build(description).unwrap();
    let report = converged(&model, bn(), observer);
    (model, report)
}

/// The iterations of each increment.
pub fn iterations(outcome: &HistoryOutcome) -> Vec<usize> {
    outcome.records.iter().map(|record| record.iterations).collect()
}

/// The largest of some sizes; not a number if one of them is none.
fn most(sizes: impl Iterator<Item = f64>) -> f64 {
    sizes.fold(0.0, |most: f64, x| if most.is_nan() || x <= most { most } else { x })
}

/// The largest size of a number.
pub fn largest(values: &[f64]) -> f64 {
    most(values.iter().map(|x| x.abs()))
}

/// The largest difference of two arrays.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    most(a.iter().zip(b).map(|(a, b)| (a - b).abs()))
}

/// The largest difference, relative to the largest number of `b`; 0 if there is none.
pub fn apart(a: &[f64], b: &[f64]) -> f64 {
    let off = difference(a, b);
    if off == 0.0 { 0.0 } else { off / largest(b) }
}

/// The largest difference of contact forces, relative to the largest normal force of `b`.
pub fn forces_apart(a: &State, b: &State) -> f64 {
    let off = most([(&a.p_n, &b.p_n), (&a.p_t, &b.p_t), (&a.p_o, &b.p_o)].map(|(a, b)| difference(a, b)).into_iter());
    if off == 0.0 { 0.0 } else { off / largest(&b.p_n) }
}
