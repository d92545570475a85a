//! The solver of a scene.

use std::ops::Range;

use toml::Spanned;

use crate::scene::document;
use crate::scene::error::Source;
use crate::scene::solver::LinearName;
use crate::scene::{LinearBackend, Method, MethodName, NewtonSystem, SceneError, Setting, Solver};

const NOTHING_BUILT_IN: &str = "this build has no linear algebra to choose from";
const BUILD_IT: &str = "build it with the cargo feature umfpack or faer";

/// The paper's interior point method ends at an absolute `Theta`, which leaves errors of up to
/// 1e-7 on the paper's problems; the other methods reach rounding.
fn default_tolerance(method: Method) -> f64 {
    if let Method::PaperIp { .. } = method { 1e-6 } else { 1e-10 }
}

/// Which key asks for a `method` that knows one tangent a node only, if one does.
pub(super) fn one_tangent_key(method: Method) -> Option<&'static str> {
    match method {
        Method::PaperIp { .. } => Some("solver.setting"),
        Method::Ip { newton: NewtonSystem::Extended } => Some("solver.newton"),
        Method::Bn { .. } | Method::PaperBn | Method::Ip { newton: NewtonSystem::Reduced } => None,
    }
}

pub(super) struct Check<'a> {
    pub(super) source: &'a Source,
}

impl Check<'_> {
    fn fail<T>(&self, span: Range<usize>, message: impl Into<String>, help: &str) -> Result<T, SceneError> {
        Err(self.source.at(span, message, help))
    }

    /// Fails unless `sound`, saying what `name` is and what it must be.
    fn demand<T: std::fmt::Debug>(
        &self,
        sound: bool,
        name: &str,
        value: &Spanned<T>,
        must: &str,
        help: &str,
    ) -> Result<(), SceneError> {
        if sound {
            return Ok(());
        }
        self.fail(value.span(), format!("{name} is {:?}, but must be {must}", value.get_ref()), help)
    }

    /// Fails if a key is given that belongs to another kind of thing.
    fn foreign<T>(&self, name: &str, value: Option<&Spanned<T>>, whose: &str) -> Result<(), SceneError> {
        value.map_or(Ok(()), |value| self.fail(value.span(), format!("{whose} has no {name}"), "remove the key"))
    }

    fn finite(&self, name: &str, value: &Spanned<f64>) -> Result<f64, SceneError> {
        let help = "give a number other than nan or inf";
        self.demand(value.get_ref().is_finite(), name, value, "a finite number", help)?;
        Ok(*value.get_ref())
    }

    /// `touches` tells whether there is contact.
    pub(super) fn solver(&self, solver: &document::Solver, touches: bool) -> Result<Solver, SceneError> {
        let method = self.method(solver)?;
        let (mut max_iterations, mut tolerance) = (200, default_tolerance(method));
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

    fn linear(&self, given: Option<&Spanned<LinearName>>, touches: bool) -> Result<Option<LinearBackend>, SceneError> {
        let Some(given) = given else {
            // Without contact a condensed body is all interior: what is left is the Cholesky factor of K.
            let cholesky = !touches && LinearBackend::Condensed.is_built_in();
            return Ok(Some(if cholesky { LinearBackend::Condensed } else { LinearBackend::default() }));
        };
        // What is compared: if one of both is built in, the other is, too.
        let Some(linear) = given.get_ref().backend() else {
            let compared = LinearBackend::default().is_built_in();
            return if compared { Ok(None) } else { self.fail(given.span(), NOTHING_BUILT_IN.to_string(), BUILD_IT) };
        };
        let missing = match linear {
            linear if linear.is_built_in() => return Ok(Some(linear)),
            LinearBackend::Umfpack => "UMFPACK",
            LinearBackend::Faer => "faer",
            LinearBackend::Condensed => "Cholesky factorisation, which \"condensed\" needs",
        };
        let help = if LinearBackend::default().is_built_in() {
            format!("use \"{}\" or \"condensed\"", LinearBackend::default())
        } else {
            BUILD_IT.to_string()
        };
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
                start: start.as_ref().map(|value| *value.get_ref()).unwrap_or_default(),
                partition: partition.as_ref().map(|value| *value.get_ref()).unwrap_or_default(),
                newton: chosen(newton),
            },
            (MethodName::Ip, Setting::Default) => Method::Ip { newton: chosen(newton) },
            (MethodName::Bn, Setting::Paper) => Method::PaperBn,
            (MethodName::Bn, Setting::Default) => Method::Bn { r_factor: self.r_factor(r_factor.as_ref())? },
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
