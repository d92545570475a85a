//! The sparse backends by name. One whose cargo feature is off says so when it is to analyse.

use super::LinearSolver;

/// UMFPACK.
pub fn umfpack() -> Box<dyn LinearSolver> {
    #[cfg(feature = "umfpack")]
    {
        Box::new(super::Umfpack::default())
    }
    #[cfg(not(feature = "umfpack"))]
    {
        Box::new(absent::Absent("UMFPACK"))
    }
}

/// faer's sparse LU.
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

#[cfg(not(all(feature = "umfpack", feature = "faer")))]
mod absent {
    use std::sync::Arc;

    use crate::linear::{FactorInfo, LinearError, LinearSolver};
    use crate::sparse::Pattern;

    /// Stands in for a backend that is not there.
    pub(super) struct Absent(pub(super) &'static str);

    impl LinearSolver for Absent {
        fn name(&self) -> &'static str {
            self.0
        }

        fn analyze(&mut self, _pattern: &Arc<Pattern>) -> Result<(), LinearError> {
            Err(LinearError::NotBuiltIn { backend: self.0 })
        }

        fn factorize(&mut self, _values: &[f64]) -> Result<FactorInfo, LinearError> {
            Err(LinearError::Order { missing: "analyze" })
        }

        fn solve(&mut self, _b: &[f64], _x: &mut [f64]) -> Result<(), LinearError> {
            Err(LinearError::Order { missing: "factorize" })
        }
    }
}
