//! The solver of a scene.

use std::ops::Range;

use toml::Spanned;

use super::Check;
use crate::formulation::NewtonSystem;
use crate::history::{LinearAlgebra, Method, Solver};
use crate::linear::SparseLu;
use crate::scene::solver::{LinearName, MethodName, Setting};
use crate::scene::{SceneError, document};

const NOTHING_BUILT_IN: &str = "this build has no linear algebra to choose from";
const BUILD_IT: &str = "build it with the cargo feature umfpack or faer";

/// Where `solver` asks for a `method` that knows one tangent a node only, if it does.
pub(super) fn one_tangent_span(solver: &document::Solver, method: Method) -> Option<Range<usize>> {
    match method {
        Method::PaperIp { .. } => solver.setting.as_ref().map(Spanned::span),
        Method::Ip { newton: NewtonSystem::Extended } => solver.newton.as_ref().map(Spanned::span),
        Method::Bn { .. } | Method::PaperBn | Method::Ip { newton: NewtonSystem::Reduced } => None,
    }
}

impl Check<'_> {
    /// `touches` tells whether there is contact.
    pub(super) fn solver(&self, solver: &document::Solver, touches: bool) -> Result<Solver, SceneError> {
        let method = self.method(solver)?;
        let (mut max_iterations, mut tolerance) = (Solver::MAX_ITERATIONS, method.default_tolerance());
        if let Some(given) = &solver.max_iterations {
            let help = "an increment that needs more iterations has not converged";
            let sound = (1..=1_000_000).contains(given.get_ref());
            self.demand(sound, "solver.max_iterations", given, "at least 1 and at most a million", help)?;
            max_iterations = *given.get_ref() as usize;
        }
        if let Some(given) = &solver.tolerance {
            tolerance = self.finite("solver.tolerance", given)?;
            let help = "the relative error that every law may have, e.g. 1e-10";
            let sound = tolerance > 0.0 && tolerance < 1.0;
            self.demand(sound, "solver.tolerance", given, "above 0 and below 1", help)?;
        }
        Ok(Solver { method, linear: self.linear(solver.linear.as_ref(), touches)?, max_iterations, tolerance })
    }

    fn linear(&self, given: Option<&Spanned<LinearName>>, touches: bool) -> Result<Option<LinearAlgebra>, SceneError> {
        let whole = LinearAlgebra::default();
        let Some(given) = given else {
            // Without contact a condensed body is all interior: what is left is the Cholesky factor of K.
            let cholesky = !touches && LinearAlgebra::condensed().is_built_in();
            return Ok(Some(if cholesky { LinearAlgebra::condensed() } else { whole }));
        };
        // What is compared: if one of both is built in, the other is, too.
        let Some(linear) = given.get_ref().algebra() else {
            let compared = whole.is_built_in();
            return if compared { Ok(None) } else { self.fail(given.span(), NOTHING_BUILT_IN.to_string(), BUILD_IT) };
        };
        let missing = match linear {
            linear if linear.is_built_in() => return Ok(Some(linear)),
            LinearAlgebra::Whole(SparseLu::Umfpack) => "UMFPACK".to_string(),
            LinearAlgebra::Whole(SparseLu::Faer) => "faer".to_string(),
            condensed => format!("Cholesky factorisation, which \"{condensed}\" needs"),
        };
        let help = if whole.is_built_in() { format!("use \"{whole}\" or \"condensed\"") } else { BUILD_IT.to_string() };
        self.fail(given.span(), format!("this build has no {missing}"), &help)
    }

    fn method(&self, solver: &document::Solver) -> Result<Method, SceneError> {
        let document::Solver { method, setting, start, partition, newton, r_factor, .. } = solver;
        let setting = setting.as_ref().map_or(Setting::Default, |setting| *setting.get_ref());
        let chosen = |newton: &Option<Spanned<_>>| newton.as_ref().map(|value| *value.get_ref()).unwrap_or_default();
        let whose = match (method, setting) {
            (MethodName::Ip, Setting::Paper) => "the method ip",
            (MethodName::Ip, Setting::Default) => {
                "the method ip has a start and a partition in the setting paper only; here it"
            }
            (MethodName::Bn, Setting::Paper) => "the method bn in the setting paper",
            (MethodName::Bn, Setting::Default) => "the method bn",
        };
        if (*method, setting) != (MethodName::Ip, Setting::Paper) {
            self.foreign("start", start.as_ref(), whose)?;
            self.foreign("partition", partition.as_ref(), whose)?;
        }
        if *method == MethodName::Bn {
            self.foreign("newton", newton.as_ref(), whose)?;
        }
        if (*method, setting) != (MethodName::Bn, Setting::Default) {
            self.foreign("r_factor", r_factor.as_ref(), whose)?;
        }
        Ok(match (method, setting) {
            (MethodName::Ip, Setting::Paper) => Method::PaperIp {
                start: start.as_ref().map(|value| *value.get_ref()).unwrap_or_default().constants(),
                partition: partition.as_ref().map(|value| *value.get_ref()).unwrap_or_default(),
                newton: chosen(newton),
            },
            (MethodName::Ip, Setting::Default) => Method::Ip { newton: chosen(newton) },
            (MethodName::Bn, Setting::Paper) => Method::PaperBn,
            (MethodName::Bn, Setting::Default) => {
                Method::Bn { r_factor: self.r_factor(r_factor.as_ref())?, rescue: true }
            }
        })
    }

    fn r_factor(&self, given: Option<&Spanned<f64>>) -> Result<f64, SceneError> {
        let Some(given) = given else { return Ok(1.0) };
        let factor = self.finite("solver.r_factor", given)?;
        let help = "r comes from the problem; this multiplies it, for studies of r alone";
        self.demand(factor > 0.0, "solver.r_factor", given, "positive", help)?;
        Ok(factor)
    }
}
