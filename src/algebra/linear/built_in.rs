//! The sparse backends by name. A backend whose cargo feature is off returns an error at the analysis.

use super::{Engine, LinearSolver, RankUse, engine};

/// Creates UMFPACK, with `in_best_order` for many factorisations in the plane.
pub fn umfpack(in_best_order: bool) -> Box<dyn LinearSolver> {
    #[cfg(feature = "umfpack")]
    {
        use super::{Strategy, Umfpack};
        Box::new(Umfpack::new(if in_best_order { Strategy::SymmetricInBestOrder } else { Strategy::Symmetric }))
    }
    #[cfg(not(feature = "umfpack"))]
    {
        let _ = in_best_order;
        Box::new(absent::Absent("UMFPACK"))
    }
}

/// Creates MUMPS.
pub fn mumps() -> Box<dyn LinearSolver> {
    engine().map_or_else(|| Box::new(absent::Absent("MUMPS")) as Box<dyn LinearSolver>, Engine::direct)
}

/// Returns the resources used by each process; empty if there is only one.
pub(crate) fn ranks_used() -> Vec<RankUse> {
    engine().map(Engine::used).unwrap_or_default()
}

/// Returns the number of processes that share the work of MUMPS and multigrid.
pub fn ranks() -> usize {
    engine().map_or(1, Engine::ranks)
}

/// Creates faer's sparse LU.
pub fn faer() -> Box<dyn LinearSolver> {
    #[cfg(feature = "faer")]
    {
        Box::new(super::FaerLu::default())
    }
    #[cfg(not(feature = "faer"))]
    {
        Box::new(absent::Absent("faer"))
    }
}

/// Creates a placeholder for multigrid if the positions of the unknowns are not known.
pub(crate) fn without_grid() -> Box<dyn LinearSolver> {
    Box::new(absent::Absent("grid of the unknowns, which multigrid needs"))
}

mod absent {
    use std::sync::Arc;

    use crate::algebra::linear::{Computed, FactorInfo, LinearError, LinearSolver};
    use crate::algebra::sparse::Pattern;

    /// A placeholder for a backend that is not available.
    pub(super) struct Absent(pub(super) &'static str);

    impl LinearSolver for Absent {
        fn name(&self) -> &'static str {
            self.0
        }

        fn analyze(&mut self, _pattern: &Arc<Pattern>) -> Computed<()> {
            Err(LinearError::NotBuiltIn { backend: self.0 })
        }

        fn factorize(&mut self, _values: &[f64]) -> Computed<FactorInfo> {
            Err(LinearError::Order { missing: "analyze" })
        }

        fn solve(&mut self, _b: &[f64], _x: &mut [f64]) -> Computed<()> {
            Err(LinearError::Order { missing: "factorize" })
        }
    }
}
