//! The solver of a scene.

use super::{given, only};
use crate::algebra::linear::SparseLu;
use crate::base::input_error::{InputError, ensure, finite};
use crate::scene::document::{self, Linear, MethodName, Setting};
use crate::solver::history::{HistoryMethod, LinearAlgebra, Method, SolverChoice, Start};

const NOTHING_BUILT_IN: &str = "this build has no linear algebra to choose from";
const BUILD_IT: &str = "build it with the cargo feature umfpack or faer";

/// Returns the key that selects `method`, if that method supports only one tangent for each node.
pub(super) fn one_tangent_key(method: Method) -> Option<&'static str> {
    matches!(method, Method::PaperIp { .. }).then_some("solver.setting")
}

/// Converts `given` to a choice of the solver.
pub(super) fn solver(given: &document::SolverTable) -> Result<SolverChoice, InputError> {
    let method = method(given)?;
    let max_iterations = given.max_iterations.unwrap_or(SolverChoice::MAX_ITERATIONS as i64);
    let help = "an increment that needs more iterations has not converged";
    let is_valid = (1..=1_000_000).contains(&max_iterations);
    ensure(is_valid, "solver.max_iterations", &max_iterations, "at least 1 and at most a million", help)?;
    let tolerance = given.tolerance.unwrap_or(method.increments().default_tolerance());
    finite("solver.tolerance", tolerance)?;
    let help = "the relative error that every law may have, e.g. 1e-10";
    let is_valid = tolerance > 0.0 && tolerance < 1.0;
    ensure(is_valid, "solver.tolerance", &tolerance, "above 0 and below 1", help)?;
    let linear = linear(given.linear)?;
    Ok(SolverChoice { method, linear, max_iterations: max_iterations as usize, tolerance })
}

/// Returns the options of PETSc, which its solver alone takes.
pub(super) fn petsc(given: &document::SolverTable, solver: &SolverChoice) -> Result<String, InputError> {
    let Some(options) = &given.petsc else { return Ok(String::new()) };
    if solver.linear == Some(LinearAlgebra::Petsc) && !options.contains('\0') {
        return Ok(options.trim().to_string());
    }
    let help = "add solver.linear = \"petsc\", or leave the options out";
    Err(InputError::new("solver.petsc", "only solver.linear = \"petsc\" takes options of PETSc", help))
}

fn linear(given: Option<Linear>) -> Result<Option<LinearAlgebra>, InputError> {
    let fault = |message: &str, help: &str| InputError::new("solver.linear", message, help);
    let whole = LinearAlgebra::default();
    let Some(Linear(Some(linear))) = given else {
        return if whole.is_built_in() { Ok(None) } else { Err(fault(NOTHING_BUILT_IN, BUILD_IT)) };
    };
    let missing = match linear {
        linear if linear.is_built_in() => return Ok(Some(linear)),
        LinearAlgebra::Whole(SparseLu::Umfpack) => "UMFPACK".to_string(),
        LinearAlgebra::Whole(SparseLu::Mumps) => "MUMPS".to_string(),
        LinearAlgebra::Whole(SparseLu::Faer) => "faer".to_string(),
        LinearAlgebra::Multigrid => "PETSc, which multigrid is of".to_string(),
        LinearAlgebra::Petsc => "PETSc".to_string(),
        condensed => format!("Cholesky factorisation, which \"{condensed}\" needs"),
    };
    let help = match linear {
        _ if !whole.is_built_in() => BUILD_IT.to_string(),
        LinearAlgebra::Multigrid | LinearAlgebra::Petsc | LinearAlgebra::Whole(SparseLu::Mumps) => {
            format!("use \"{whole}\" or \"condensed\", or compile with the feature petsc")
        }
        _ => format!("use \"{whole}\" or \"condensed\""),
    };
    Err(fault(&format!("this build has no {missing}"), &help))
}

fn method(solver: &document::SolverTable) -> Result<HistoryMethod, InputError> {
    let setting = solver.setting.unwrap_or_default();
    let (whose, own): (_, &[_]) = match (solver.method, setting) {
        (MethodName::Ip, Setting::Paper) => ("the method ip", &["start", "partition", "max_iterations"]),
        (MethodName::Ip, Setting::Default) => {
            ("the method ip has a start and a partition in the setting paper only; here it", &["max_iterations"])
        }
        (MethodName::Bn, Setting::Paper) => ("the method bn in the setting paper", &["max_iterations"]),
        (MethodName::Bn, Setting::Default) => ("the method bn", &["r_factor", "max_iterations"]),
        (MethodName::Events, Setting::Paper) => {
            let help = "the exact path has no constants of the paper: leave solver.setting out";
            return Err(InputError::new("solver.setting", "the method events has no setting paper", help));
        }
        (MethodName::Events, Setting::Default) => ("the method events", &[]),
    };
    let keys = given!(solver; start partition r_factor max_iterations);
    only(whose, own, keys).map_err(|fault| fault.with_key("solver"))?;
    Ok(match (solver.method, setting) {
        (MethodName::Ip, Setting::Paper) => {
            let start = if let Some(document::Start::Prev) = solver.start { Start::PREV } else { Start::Safe };
            Method::PaperIp { start, partition: solver.partition.unwrap_or_default() }.into()
        }
        (MethodName::Ip, Setting::Default) => Method::Ip.into(),
        (MethodName::Bn, Setting::Paper) => Method::PaperBn.into(),
        (MethodName::Bn, Setting::Default) => {
            Method::Bn { r_factor: checked_factor(solver.r_factor)?, rescue: true }.into()
        }
        (MethodName::Events, _) => HistoryMethod::ExactPath,
    })
}

fn checked_factor(given: Option<f64>) -> Result<f64, InputError> {
    let factor = given.unwrap_or(1.0);
    finite("solver.r_factor", factor)?;
    let help = "r comes from the problem; this multiplies it, for studies of r alone";
    ensure(factor > 0.0, "solver.r_factor", &factor, "positive", help)?;
    Ok(factor)
}
