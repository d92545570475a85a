//! Runs to their reports.

use crate::common::prelude::*;

/// The report of a run that converges.
pub fn report(body: &Description, method: Method, linear: LinearAlgebra) -> RunReport {
    let model = Model::build(body).unwrap();
    let solver = SolverChoice { linear: Some(linear), ..SolverChoice::new(method) };
    let report = Run::of(&model, model.times().to_vec(), solver).unwrap().solve(&mut ()).unwrap();
    assert_eq!(report.status, Status::Converged, "{method:?} {linear:?}");
    report
}

pub fn warns(report: &RunReport, kind: WarningKind) -> bool {
    report.warnings.iter().any(|warning| warning.kind == kind)
}
