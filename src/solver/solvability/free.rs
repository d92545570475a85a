//! The rigid modes of a body, and their products with loads and contact rows.

use super::cone::norm;
use crate::algebra::null_space::NEGLIGIBLE;
use crate::solver::problem::ContactProblem;

/// External forces (n_u, N) with the sizes of their terms: a resultant that is only rounding of these terms drives
/// nothing.
#[derive(Clone, Copy)]
pub(crate) struct Load<'a> {
    pub force: &'a [f64],
    pub sizes: &'a [f64],
}

/// The rigid modes, each scaled by its largest displacement, so that units do not matter.
pub(super) struct Free<'a> {
    motions: &'a [Vec<f64>],
    largest: Vec<f64>,
}

impl<'a> Free<'a> {
    pub(super) fn new(problem: &'a ContactProblem) -> Self {
        let motions = problem.rigid_modes();
        let largest = motions.iter().map(|motion| motion.iter().fold(0.0_f64, |m, u| m.max(u.abs()))).collect();
        Free { motions, largest }
    }

    /// Returns the product of a contact row with each mode. Rounding counts as zero, because the cone uses any
    /// vector, however short, as a direction.
    pub(super) fn felt(&self, row: &[(usize, f64)]) -> Vec<f64> {
        let size: f64 = row.iter().map(|(_, c)| c.abs()).sum();
        (self.motions.iter().zip(&self.largest))
            .map(|(motion, largest)| row.iter().map(|&(j, c)| c * motion[j]).sum::<f64>() / largest)
            .map(|w| if w.abs() <= NEGLIGIBLE * size { 0.0 } else { w })
            .collect()
    }

    /// Returns the work of `load` on each mode, and the size of the terms in these sums.
    pub(super) fn work(&self, &Load { force, sizes }: &Load<'_>) -> (Vec<f64>, f64) {
        let (mut load, mut size) = (Vec::new(), Vec::new());
        for (motion, largest) in self.motions.iter().zip(&self.largest) {
            // Rounding in a mode's zero components counts as zero, since it would be multiplied by whole forces.
            let felt = |u: &f64| if u.abs() <= NEGLIGIBLE * largest { 0.0 } else { *u };
            size.push(motion.iter().zip(sizes).map(|(u, size)| (felt(u) * size).abs()).sum::<f64>() / largest);
            load.push(motion.iter().zip(force).map(|(u, f)| felt(u) * f).sum::<f64>() / largest);
        }
        (load, norm(&size))
    }

    /// Returns the weights of the unscaled modes in `y`, normalised to length one.
    pub(super) fn weights(&self, y: &[f64]) -> Vec<f64> {
        let length = norm(y);
        y.iter().zip(&self.largest).map(|(y, largest)| y / length / largest).collect()
    }

    /// Returns the weights of the unscaled modes in `y`.
    pub(super) fn weights_of(&self, y: &[f64]) -> Vec<f64> {
        y.iter().zip(&self.largest).map(|(y, largest)| y / largest).collect()
    }
}
