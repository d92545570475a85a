//! The solver of a scene.

use toml::Spanned;

use super::Check;
use crate::scene::document;
use crate::scene::{Method, MethodName, SceneError, Setting, Solver};

/// The paper's interior point method ends at an absolute `Theta`, which leaves errors of up to
/// 1e-7 on the paper's problems; the other methods reach rounding.
fn default_tolerance(method: Method) -> f64 {
    if let Method::PaperIp { .. } = method { 1e-6 } else { 1e-10 }
}

impl Check<'_> {
    pub(super) fn solver(&self, solver: &document::Solver) -> Result<Solver, SceneError> {
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
        Ok(Solver { method, linear: solver.linear, max_iterations, tolerance })
    }

    fn method(&self, solver: &document::Solver) -> Result<Method, SceneError> {
        let document::Solver { method, setting, start, partition, newton, .. } = solver;
        let paper = setting.as_ref().map(|setting| *setting.get_ref() == Setting::Paper);
        let chosen = |newton: &Option<Spanned<_>>| newton.as_ref().map(|value| *value.get_ref()).unwrap_or_default();
        match (method, paper) {
            (MethodName::Ip, Some(true)) => Ok(Method::PaperIp {
                start: start.as_ref().map(|value| *value.get_ref()).unwrap_or_default(),
                partition: partition.as_ref().map(|value| *value.get_ref()).unwrap_or_default(),
                newton: chosen(newton),
            }),
            (MethodName::Ip, None | Some(false)) => {
                let whose = "the method ip has a start and a partition in the setting paper only; here it";
                self.foreign("start", start.as_ref(), whose)?;
                self.foreign("partition", partition.as_ref(), whose)?;
                Ok(Method::Ip { newton: chosen(newton) })
            }
            (MethodName::Bn, paper) => {
                if let (Some(false), Some(setting)) = (paper, setting) {
                    let help = "use setting = \"paper\", or method = \"ip\"";
                    return self.fail(setting.span(), "the method bn has no setting default", help);
                }
                self.foreign("start", start.as_ref(), "the method bn")?;
                self.foreign("partition", partition.as_ref(), "the method bn")?;
                self.foreign("newton", newton.as_ref(), "the method bn")?;
                Ok(Method::PaperBn)
            }
        }
    }
}
