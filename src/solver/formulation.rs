//! Equations `H(z) = 0` of one increment and their linearisation on one fixed pattern.
//!
//! | equations | file |
//! | --- | --- |
//! | `H_N` (18), (19) with its B-derivative (20) and the linearisation (21) | `bdiff.rs` |
//! | `H_I` (25) with its partitions (26)–(31) | `constrained.rs` |
//! | the exact cone in space, for an interior point method | `cone.rs` |
//!
//! All formulations use the same [`Assembled`] problem: one layout, one pattern, one `K`.

mod bdiff;
mod cone;
mod constrained;
mod interior;
mod layout;
mod mixed;
mod natural;
mod scaled;

use crate::algebra::sparse::Pattern;
use crate::base::units::Scaling;
use crate::solver::problem::ContactProblem;
pub use bdiff::{Bdiff, Linearization};
pub use cone::ConeSystem;
pub use constrained::{Constrained, Partition, SlackLayout};
pub use interior::{Face, InteriorPoint, Pair, largest_step};
pub use layout::Layout;
use mixed::MixedMatrix;
pub use natural::{FormulationScaling, Pressure};
use scaled::ScaledData;
use std::sync::Arc;

/// A problem in the units of a scaling, with the matrix on `(u, p_t, p_o, p_n)`: its pattern, its equilibrium rows
/// and the places of all others. A formulation takes a clone, which shares all constant data. Since all formulations
/// have one pattern, one symbolic analysis serves BN, its fallback and an interior point method.
#[derive(Clone)]
pub struct Assembled {
    data: ScaledData,
    matrix: MixedMatrix,
}

impl Assembled {
    /// Sets up the matrix of `problem`.
    pub fn new(problem: &ContactProblem, scaling: Scaling) -> Self {
        let data = ScaledData::new(problem, scaling);
        let matrix = MixedMatrix::new(problem, &data.layout, &scaling);
        Assembled { data, matrix }
    }

    /// Returns the layout of `(u, p_t, p_o, p_n)`.
    pub fn layout(&self) -> &Layout {
        &self.data.layout
    }

    /// Returns the union of the patterns of all cases of (21).
    pub fn pattern(&self) -> &Arc<Pattern> {
        self.matrix.matrix().pattern()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::sparse::{Csr, Symmetric};
    use crate::solver::formulation::{Bdiff, Constrained, FormulationScaling, InteriorPoint, Partition};
    use crate::solver::problem::Parts;

    #[test]
    fn all_formulations_have_one_pattern() {
        let stiffness = Symmetric::from_triplets(2, &[(0, 0, 2.0), (1, 0, 1.0), (1, 1, 2.0)]).unwrap();
        let [c_n, c_t] = [1, 0].map(|dof| Csr::of_rows(2, [[(dof, 1.0)]]));
        let problem = ContactProblem::new(Parts { c_t, mu: vec![0.3], ..Parts::new(stiffness, c_n) }).unwrap();
        let conventions = FormulationScaling::natural(&problem);
        let bn = Bdiff::new(&problem, Scaling::SI, &conventions);
        let ip = Constrained::on(bn.assembled(), &conventions, Partition::Products);
        assert!(Arc::ptr_eq(bn.jacobian().pattern(), ip.matrix().pattern()));
        assert!(Arc::ptr_eq(bn.jacobian().pattern(), bn.assembled().pattern()));
    }
}
