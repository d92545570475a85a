//! From the words of a scene to the constants of a history.

use crate::history::{HistorySettings, Method, Start};
use crate::nonlinear::{IpSettings, PredictorCorrectorSettings};
use crate::problem::ContactProblem;
use crate::scene::{self, Solver};
use crate::units::Scaling;

/// The settings of a history of `problem` that `solver` asks for, in the units `scaling`.
pub fn history_settings(solver: &Solver, problem: &ContactProblem, scaling: Scaling) -> HistorySettings {
    let Solver { method, max_iterations, tolerance, .. } = *solver;
    match method {
        scene::Method::Bn { r_factor } => {
            let mut settings = HistorySettings::bn(problem, scaling, max_iterations, tolerance);
            settings.conventions.scale_r(r_factor);
            settings
        }
        scene::Method::PaperBn => HistorySettings::paper_bn(problem, scaling, max_iterations, tolerance),
        scene::Method::PaperIp { start, partition, newton } => {
            let start = match start {
                scene::Start::Safe => Start::Safe,
                scene::Start::Prev => Start::PREV,
            };
            let method = Method::Ip { settings: IpSettings::paper(max_iterations), start, partition, newton };
            HistorySettings { method, ..HistorySettings::paper_ip(problem, start, max_iterations, tolerance) }
        }
        scene::Method::Ip { newton } => {
            let settings = PredictorCorrectorSettings { tolerance, max_iterations };
            let method = Method::PredictorCorrector { settings, newton };
            HistorySettings { method, ..HistorySettings::ip(problem, scaling, max_iterations, tolerance) }
        }
    }
}
