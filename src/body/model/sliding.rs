//! The motion of a body that slides.

use super::Model;
use crate::algebra::vector::dot;
use crate::body::constraints::RigidMotion;

/// A part of a motion along the contact that is smaller than this share of it is rounding, or belongs to a body that is lifted.
const LEAST: f64 = 0.1;

/// The loads drive a part of a motion if they do at least this share of their work along it.
const DRIVEN: f64 = 0.5;

/// A node parts from its obstacle if it moves away by more than this multiple of the friction angle.
const PARTS: f64 = 1.01;

/// A row of contact that is smaller than this share of itself after the other rows are removed depends on them.
const DEPENDENT: f64 = 1e-9;

impl Model {
    /// Returns the rigid motion with these weights, of [`Model::rigid_motions`], without its components along the normals of the
    /// contact nodes for which `is_closed` is `true` and that do not part by more than the friction angle; if it has no others,
    /// or the loads at time `t` (s) do not drive them, the motion itself. The proof that nothing balances the loads of a sliding
    /// body has a motion that also lifts it, by the friction angle; that of a body that tips is a rotation.
    pub fn motion_along_contact(
        &self,
        t: f64,
        weights: &[f64],
        is_closed: impl Fn(usize) -> bool,
    ) -> Option<RigidMotion> {
        let power = |weights: &[f64]| {
            let mut force = vec![0.0; self.problem.displacements()];
            self.loading.force(t, &mut force);
            dot(self.problem.rigid_motion(weights), &force)
        };
        let along = self.along_contact(weights, is_closed).filter(|along| power(along) >= DRIVEN * power(weights));
        RigidMotion::combination(&self.rigid_motions, along.as_deref().unwrap_or(weights))
    }

    fn along_contact(&self, weights: &[f64], is_closed: impl Fn(usize) -> bool) -> Option<Vec<f64>> {
        let modes: Vec<Vec<f64>> =
            self.rigid_motions.iter().map(|motion| motion.displacements(&self.mesh, &self.dofs)).collect();
        let normal: Vec<Vec<f64>> =
            modes.iter().map(|mode| self.problem.c_n().times(mode)).collect::<Result<_, _>>().ok()?;
        let [w_n, w_t, w_o] = self.problem.contact_motion(&self.problem.rigid_motion(weights));
        let slides = |i: &usize| {
            -w_n[*i] <= PARTS * (self.problem.mu()[*i] * w_t[*i].hypot(w_o[*i])).max(DEPENDENT * size(weights))
        };
        let mut basis = Vec::<Vec<f64>>::new();
        for i in (0..self.contacts.len()).filter(|&i| is_closed(i)).filter(slides) {
            let mut row: Vec<f64> = normal.iter().map(|w_n| w_n[i]).collect();
            let before = size(&row);
            remove(&basis, &mut row);
            let length = size(&row);
            if length > DEPENDENT * before {
                for x in &mut row {
                    *x /= length;
                }
                basis.push(row);
            }
        }
        let mut along = weights.to_vec();
        remove(&basis, &mut along);
        (size(&along) >= LEAST * size(weights)).then_some(along)
    }
}

fn size(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Removes the components of a vector along an orthonormal basis.
fn remove(basis: &[Vec<f64>], x: &mut [f64]) {
    for b in basis {
        let along: f64 = b.iter().zip(&*x).map(|(b, x)| b * x).sum();
        x.iter_mut().zip(b).for_each(|(x, b)| *x -= along * b);
    }
}
