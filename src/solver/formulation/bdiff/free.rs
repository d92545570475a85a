//! Rigid modes that a linearisation leaves unconstrained: pinned during a step, and followed where the loads drive
//! them.
//!
//! If the cases of the contact nodes leave rigid modes `r` unconstrained, the Jacobian is singular, `J (r, 0) = 0`.
//! It becomes regular if one displacement for each mode is pinned by a spring as stiff as its own diagonal entry of
//! `K`, which is in the pattern anyway. With a left null vector `y` of `J`, `yᵀ` times `(J + Σ k e eᵀ) dz = -H`
//! leaves `Σ (yᵀe) k dz = -yᵀ H`. If the equations have a solution, `yᵀ H = 0`: the springs carry nothing, and `dz`
//! solves (22) for any stiffness. If they have no solution, the springs carry the work of the loads on `r` and yield
//! to it.

use super::{Bdiff, Case};
use crate::algebra::null_space::{Motions, NEGLIGIBLE, Row};
use crate::algebra::sparse::Csr;
use crate::solver::laws::coulomb::{NormalCase, TangentialCase};
use std::sync::Arc;

/// The drag on all contact nodes, relative to their stiffness: a motion that nothing else resists is ten thousand times as long
/// as the deformation by its load. With 1e-3 the slip of the deformation is too large beside it; with 1e-6 more iterations fail.
const DRAG: f64 = 1e-4;

/// The number of bisections for the step at which a case changes: nine digits.
const BISECTIONS: usize = 30;

impl Bdiff {
    /// Returns the weights of a combination of the problem's rigid modes that the last linearisation leaves
    /// unconstrained, or `None` if there is none.
    pub fn unconstrained_mode(&self) -> Option<Vec<f64>> {
        self.unconstrained_modes().into_iter().next()
    }

    /// Returns the weights of all rigid modes that the last linearisation leaves unconstrained. A rigid mode is
    /// unconstrained if no closed node stops it along the normal and no sticking node along a tangent. A slipping
    /// node resists across its slip, since friction would turn.
    fn unconstrained_modes(&self) -> Vec<Vec<f64>> {
        if self.data.rigid_modes.is_empty() {
            return Vec::new();
        }
        let motions = Motions::new(&self.data.rigid_modes);
        let row = |c: &Csr, i: usize| motions.felt(c.row(i));
        let closed = |i: usize| matches!(self.cases[i], Some((NormalCase::Closed, _)));
        let tangents = |i: usize| [row(&self.data.c_t, i), row(&self.data.c_o, i)];
        let tangential_rows = |i: usize| match self.cases[i] {
            Some((_, Some(TangentialCase::Stick))) => tangents(i).to_vec(),
            Some((_, Some(TangentialCase::Slip { direction: [t, o], turning }))) if turning != [[0.0; 2]; 2] => {
                let [along_t, along_o] = tangents(i);
                let across = along_t.entries.iter().zip(&along_o.entries).map(|(w_t, w_o)| t * w_o - o * w_t);
                vec![Row { entries: across.collect(), size: along_t.size.max(along_o.size) }]
            }
            _ => Vec::new(),
        };
        let contacts = 0..self.layout().contacts();
        let normal = contacts.clone().filter(|&i| closed(i)).map(|i| row(&self.data.c_n, i));
        let tangential = contacts.flat_map(tangential_rows);
        motions.unfelt(normal.chain(tangential))
    }

    /// Pins one contact displacement per unconstrained rigid mode, chosen so that the modes can be distinguished.
    pub(super) fn pin_unconstrained_modes(&mut self) {
        self.matrix.release();
        let modes = self.unconstrained_modes();
        if modes.is_empty() {
            return;
        }
        let candidates = self.data.contact_displacements();
        let motion = |weights: &Vec<f64>| {
            let u = self.data.motion(weights, self.layout().displacements());
            candidates.iter().map(|&place| u[place]).collect()
        };
        let pinned = anchors(modes.iter().map(motion).collect());
        self.matrix.tie(pinned.into_iter().map(|k| candidates[k]));
    }

    /// Adds a small drag against displacements of contact nodes from `z` for good. No motion is rigid then. Returns the drag of
    /// each displacement.
    pub fn drag_from(&mut self, z: &[f64]) -> Vec<f64> {
        let dofs = self.data.contact_displacements();
        let mut drag = vec![0.0; self.layout().displacements()];
        for &place in &dofs {
            drag[place] = self.matrix.drag(place, DRAG / dofs.len() as f64);
            self.data.force[place] += drag[place] * z[place];
        }
        self.data.rigid_modes = Arc::default();
        drag
    }

    /// Returns `true` if the last linearisation has unconstrained modes, which are pinned.
    pub fn is_pinned(&self) -> bool {
        !self.matrix.springs().is_empty()
    }

    /// Returns the mode of [`Bdiff::unconstrained_mode`] if it is not pinned either.
    pub fn unpinned_mode(&self) -> Option<Vec<f64>> {
        if self.is_pinned() { None } else { self.unconstrained_mode() }
    }

    /// Returns the step from `z` along `dz` at which the first contact node leaves its case in the last
    /// linearisation, or `None` if none ever does. A slip in a plane may turn by a right angle.
    pub fn max_step(&self, z: &[f64], dz: &[f64]) -> Option<f64> {
        let (mut near, mut far) = (0.0, 1.0);
        while self.stays(z, dz, far) {
            (near, far) = (far, 2.0 * far);
            if !far.is_finite() {
                return None;
            }
        }
        Some(self.bisect(z, dz, near, far).1)
    }

    /// Moves the solution `z` along the unconstrained rigid modes, without a change of cases, as near as possible to
    /// `to` in the displacements of the contact nodes.
    pub fn settled(&self, z: &[f64], to: &[f64]) -> Vec<f64> {
        let dofs = self.data.contact_displacements();
        let product = |a: &[f64], b: &[f64]| dofs.iter().map(|&k| a[k] * b[k]).sum::<f64>();
        let mut dz = vec![0.0; z.len()];
        let mut residual: Vec<f64> = to.iter().zip(z).map(|(to, z)| to - z).collect();
        let mut orthogonal = Vec::<Vec<f64>>::new();
        for weights in self.unconstrained_modes() {
            let mut motion = self.data.motion(&weights, z.len());
            for other in &orthogonal {
                let projection = product(&motion, other) / product(other, other);
                motion.iter_mut().zip(other).for_each(|(u, other)| *u -= projection * other);
            }
            let step = product(&residual, &motion) / product(&motion, &motion);
            dz.iter_mut().zip(&motion).for_each(|(dz, u)| *dz += step * u);
            residual.iter_mut().zip(&motion).for_each(|(left, u)| *left -= step * u);
            orthogonal.push(motion);
        }
        let step = if self.stays(z, &dz, 1.0) { 1.0 } else { self.bisect(z, &dz, 0.0, 1.0).0 };
        z.iter().zip(&dz).map(|(z, dz)| z + step * dz).collect()
    }

    /// Returns `true` if all nodes have the cases of the last linearisation at `z + step dz`.
    fn stays(&self, z: &[f64], dz: &[f64], step: f64) -> bool {
        let ahead: Vec<f64> = z.iter().zip(dz).map(|(z, dz)| z + step * dz).collect();
        (0..self.layout().contacts()).all(|i| self.keeps_case(i, &ahead))
    }

    /// Returns `true` if node `i` has the case of the last linearisation at `z`.
    pub(super) fn keeps_case(&self, i: usize, z: &[f64]) -> bool {
        self.cases[i].is_some_and(|case| is_alike(case, self.case(i, z)))
    }

    /// Bisects between the step `near`, at which all nodes keep their cases, and `far`, at which one does not.
    fn bisect(&self, z: &[f64], dz: &[f64], mut near: f64, mut far: f64) -> (f64, f64) {
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (near + far);
            *(if self.stays(z, dz, middle) { &mut near } else { &mut far }) = middle;
        }
        (near, far)
    }
}

/// Returns one displacement per mode by which `motions` can be distinguished: the largest entry of each mode after
/// the modes before it have been eliminated.
fn anchors(motions: Vec<Vec<f64>>) -> Vec<usize> {
    let mut pinned = Vec::with_capacity(motions.len());
    // The remainder of a linearly dependent motion is rounding.
    let least = |motion: &Vec<f64>| NEGLIGIBLE * motion.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
    let mut motions: Vec<(f64, Vec<f64>)> = motions.into_iter().map(|motion| (least(&motion), motion)).collect();
    loop {
        let entries = motions.iter().enumerate().flat_map(|(k, (least, motion))| {
            let telling = motion.iter().enumerate().filter(|(_, u)| u.abs() > *least);
            telling.map(move |u| (k, u))
        });
        let largest = entries.max_by(|a, b| a.1.1.abs().total_cmp(&b.1.1.abs()));
        let Some((k, (place, _))) = largest else { return pinned };
        pinned.push(place);
        let (_, pivot) = motions.swap_remove(k);
        for (_, motion) in &mut motions {
            let factor = motion[place] / pivot[place];
            motion.iter_mut().zip(&pivot).for_each(|(u, pivot)| *u -= factor * pivot);
        }
    }
}

/// Returns `true` if two cases of a node are equal, ignoring turns of the slip direction by less than a right angle.
fn is_alike((normal, tangential): Case, (other_normal, other): Case) -> bool {
    let alike = match (tangential, other) {
        (Some(TangentialCase::Slip { direction: n, .. }), Some(TangentialCase::Slip { direction: m, .. })) => {
            n[0] * m[0] + n[1] * m[1] > 0.0
        }
        (one, other) => one == other,
    };
    normal == other_normal && alike
}

#[cfg(test)]
mod tests {
    use super::anchors;

    #[test]
    fn anchors_tell_motions_apart() {
        assert_eq!(anchors(vec![vec![0.0, -2.0, 1.0]]), [1]);
        // Two translations and a rotation of three points on a line.
        let motions = vec![
            vec![1.0, 0.0, 1.0, 0.0, 1.0, 0.0],
            vec![0.0, 1.0, 0.0, 1.0, 0.0, 1.0],
            vec![0.0, -0.5, 0.0, 0.0, 0.0, 0.5],
        ];
        let mut pinned = anchors(motions);
        pinned.sort_unstable();
        assert_eq!(pinned.len(), 3);
        assert!(pinned.iter().filter(|place| *place % 2 == 1).count() == 2, "{pinned:?}");
        // A linearly dependent motion has no anchor of its own.
        assert_eq!(anchors(vec![vec![1.0, 2.0], vec![2.0, 4.0]]).len(), 1);
        assert_eq!(anchors(vec![vec![0.1, 0.2, 0.3], vec![0.3, 0.6, 0.9]]).len(), 1);
        // A small motion has an anchor, however large the others are.
        assert_eq!(anchors(vec![vec![1.0, 0.0], vec![0.0, 1e-12]]).len(), 2);
    }
}
