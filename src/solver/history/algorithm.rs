//! The algorithms by name: the only place that lists all of them.

use super::bn::BnMethod;
use super::ip::IpMethod;
use super::method::Method;
use super::settings::HistorySettings;
use super::strategy::{self, Strategy};
use super::task::{Algorithm, IncrementSolver};
use crate::solver::formulation::{FormulationScaling, Layout};
use crate::solver::loading::Loading;
use crate::solver::problem::ContactProblem;

impl Algorithm for HistorySettings {
    fn start(&self, problem: &ContactProblem, loading: &Loading) -> Box<dyn IncrementSolver> {
        match self.method {
            Method::Bn { .. } | Method::Ip => {
                let attempts = match self.method {
                    Method::Ip => strategy::IP,
                    Method::Bn { rescue: true, .. } => strategy::BN,
                    _ => strategy::BN_ALONE,
                };
                Box::new(Strategy::new(BnMethod::new(problem, loading, self), self, attempts))
            }
            Method::PaperBn => Box::new(BnMethod::new(problem, loading, self)),
            Method::PaperIp { start, partition } => Box::new(IpMethod::new(problem, self, start, partition)),
        }
    }

    fn of_nodes(&self, nodes: &[usize]) -> Option<Box<dyn Algorithm>> {
        if self.method.is_of_paper() {
            return None;
        }
        let of = |values: &[f64]| nodes.iter().map(|&i| values[i]).collect();
        let FormulationScaling { r_n, r_t, row_unit, .. } = &self.conventions;
        let (r_n, r_t, row_unit) = (of(r_n), of(r_t), of(row_unit));
        Some(Box::new(HistorySettings {
            conventions: FormulationScaling { r_n, r_t, row_unit, ..self.conventions.clone() },
            contact_stiffness: of(&self.contact_stiffness),
            working_set: None,
            ..self.clone()
        }))
    }

    /// Returns `true` if the method supports this layout. The paper's interior point method has one tangent at every
    /// node.
    fn knows(&self, layout: &Layout) -> bool {
        !layout.has_second_tangent() || !matches!(self.method, Method::PaperIp { .. })
    }
}
