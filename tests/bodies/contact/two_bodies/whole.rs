//! Runs to their reports.

use crate::common::prelude::*;

/// The report of a run that converges.
pub fn report(body: &Description, method: Method, linear: LinearAlgebra) -> RunReport {
    let model = Model::build(body).unwrap();
    let solver = solver_of(method, linear);
    converged(&model, solver, &mut ())
}

pub fn warns(report: &RunReport, kind: WarningKind) -> bool {
    report.warnings.iter().any(|warning| warning.kind == kind)
}
