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

/// The rigid modes, each scaled by its largest displacement, so that units do not matter, and by the loads of its part of the
/// body, so that a large load elsewhere does not.
pub(super) struct Free<'a> {
    motions: &'a [Vec<f64>],
    largest: Vec<f64>,
    /// The size of the loads on the part, relative to the largest.
    loads: Vec<f64>,
}

impl<'a> Free<'a> {
    pub(super) fn new(problem: &'a ContactProblem) -> Self {
        let motions = problem.rigid_modes();
        let largest = motions.iter().map(|motion| motion.iter().fold(0.0_f64, |m, u| m.max(u.abs()))).collect();
        Free { motions, largest, loads: vec![1.0; motions.len()] }
    }

    /// Returns the work of `load` on each mode, and the sizes of the terms in these sums.
    pub(super) fn work(&self, load: &Load<'_>) -> (Vec<f64>, Vec<f64>) {
        let of = |(motion, largest): (&Vec<f64>, &f64)| {
            // Rounding in a mode's zero components counts as zero, since it would be multiplied by whole forces.
            let felt = |u: &f64| if u.abs() <= NEGLIGIBLE * largest { 0.0 } else { *u };
            let size = motion.iter().zip(load.sizes).map(|(u, size)| (felt(u) * size).abs()).sum::<f64>() / largest;
            (motion.iter().zip(load.force).map(|(u, f)| felt(u) * f).sum::<f64>() / largest, size)
        };
        self.motions.iter().zip(&self.largest).map(of).unzip()
    }

    /// Scales the modes by `load`. Returns them with its work on each mode, and the size of the terms in these sums.
    pub(super) fn under(problem: &'a ContactProblem, load: &Load<'_>) -> (Self, Vec<f64>, f64) {
        let mut free = Free::new(problem);
        let (mut work, mut sizes) = free.work(load);
        let part = |motion: &Vec<f64>| motion.iter().position(|u| *u != 0.0).map(|dof| problem.natural().part[dof]);
        let parts: Vec<Option<usize>> = free.motions.iter().map(part).collect();
        let on =
            |part| sizes.iter().zip(&parts).filter(|(_, of)| **of == part).map(|(size, _)| *size).collect::<Vec<_>>();
        let loads: Vec<f64> = parts.iter().map(|part| norm(&on(*part))).collect();
        let most = loads.iter().fold(0.0_f64, |most, load| most.max(*load));
        free.loads = loads.iter().map(|load| if *load > 0.0 { load / most } else { 1.0 }).collect();
        for (k, load) in free.loads.iter().enumerate() {
            (work[k], sizes[k]) = (work[k] / load, sizes[k] / load);
        }
        (free, work, norm(&sizes))
    }

    /// Returns the product of a contact row with each mode. Rounding counts as zero, because the cone uses any
    /// vector, however short, as a direction.
    pub(super) fn felt(&self, row: &[(usize, f64)]) -> Vec<f64> {
        let size: f64 = row.iter().map(|(_, c)| c.abs()).sum();
        (self.motions.iter().zip(&self.largest))
            .map(|(motion, largest)| row.iter().map(|&(j, c)| c * motion[j]).sum::<f64>() / largest)
            .zip(&self.loads)
            .map(|(w, load)| if w.abs() <= NEGLIGIBLE * size { 0.0 } else { w / load })
            .collect()
    }

    /// Returns the weights of the unscaled modes in `y`, normalised to length one.
    pub(super) fn weights(&self, y: &[f64]) -> Vec<f64> {
        let motion: Vec<f64> = y.iter().zip(&self.loads).map(|(y, load)| y / load).collect();
        let length = norm(&motion);
        motion.iter().zip(&self.largest).map(|(y, largest)| y / length / largest).collect()
    }

    /// Returns the weights of the unscaled modes in `y`.
    pub(super) fn weights_of(&self, y: &[f64]) -> Vec<f64> {
        (0..y.len()).map(|k| y[k] / self.loads[k] / self.largest[k]).collect()
    }
}
