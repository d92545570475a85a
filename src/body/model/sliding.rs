//! The motion of bodies that slide; rigid ones may slide so far that the moments of their forces are wrong.

use std::collections::BTreeSet;

use super::Model;
use crate::algebra::vector::{dot, minus, norm, plus, unit};
use crate::body::constraints::RigidMotion;
use crate::body::contact::ContactNode;
use crate::solver::problem::State;

/// A part of a motion along the contact that is smaller than this share of it is rounding, or belongs to a body that is lifted.
const LEAST: f64 = 0.1;

/// The loads drive a part of a motion if they do at least this share of their work along it.
const DRIVEN: f64 = 0.5;

/// A node parts from its obstacle if it moves away by more than this multiple of the friction angle.
const PARTS: f64 = 1.01;

/// A row of contact that is smaller than this share of itself after the other rows are removed depends on them.
const DEPENDENT: f64 = 1e-9;

impl Model {
    /// Returns the rigid motion with these weights, of `constraints.rigid_motions`, without its components along the normals of the
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
        RigidMotion::combination(&self.constraints.rigid_motions, along.as_deref().unwrap_or(weights))
    }

    fn along_contact(&self, weights: &[f64], is_closed: impl Fn(usize) -> bool) -> Option<Vec<f64>> {
        let modes: Vec<Vec<f64>> = self
            .constraints
            .rigid_motions
            .iter()
            .map(|motion| motion.displacements(&self.mesh, &self.constraints.dofs))
            .collect();
        let normal: Vec<Vec<f64>> =
            modes.iter().map(|mode| self.problem.c_n().times(mode)).collect::<Result<_, _>>().ok()?;
        let [w_n, w_t, w_o] = self.problem.contact_motion(&self.problem.rigid_motion(weights));
        let slides = |i: &usize| {
            -w_n[*i] <= PARTS * (self.problem.mu()[*i] * w_t[*i].hypot(w_o[*i])).max(DEPENDENT * size(weights))
        };
        let mut basis = Vec::<Vec<f64>>::new();
        for i in (0..self.contact.nodes.len()).filter(|&i| is_closed(i)).filter(slides) {
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

    /// Returns the rigid body that has moved furthest along its contact, relative to the pressed zone, at time `t` (s) in the
    /// `state` at that time.
    pub fn large_motion(&self, t: f64, state: &State) -> Option<LargeMotion> {
        let free = |k: usize| {
            self.constraints.dofs.node(self.constraints.dofs.nodes_of_point(k)[1]).iter().any(Option::is_some)
        };
        let rigid: Vec<_> = self.constraints.couplings.each_rigid_body().filter(|(_, k, _)| free(*k)).collect();
        if rigid.is_empty() {
            return None;
        }
        let all = self.constraints.displaced(t, &state.u);
        let of_body = |(coupling, k, nodes): &(usize, usize, Vec<usize>)| {
            let nodes: BTreeSet<usize> = nodes.iter().copied().collect();
            let point = all[self.constraints.dofs.nodes_of_point(*k)[0]];
            let own = (0..self.contact.pairs.len()).filter(|&pair| {
                self.contact.pairs[pair].master.facets.first().is_some_and(|facet| nodes.contains(&facet[0]))
            });
            own.filter_map(|pair| self.moved_along(pair, point, &all, state))
                .map(|(moved, share)| LargeMotion { coupling: *coupling, moved, share })
                .max_by(|a, b| a.share.total_cmp(&b.share))
        };
        rigid.iter().filter_map(of_body).max_by(|a, b| a.share.total_cmp(&b.share))
    }

    /// Returns how far a body that moves by `point` (m) has moved along the contact of a pair relative to the slave, m, and
    /// relative to half the width of the pressed zone.
    fn moved_along(&self, pair: usize, point: [f64; 3], all: &[[f64; 3]], state: &State) -> Option<(f64, f64)> {
        let pressed: Vec<usize> = (0..self.contact.nodes.len())
            .filter(|&i| state.p_n[i] > 0.0 && self.contact.nodes[i].coupled().is_some_and(|own| own.pair == pair))
            .collect();
        let total: f64 = pressed.iter().map(|&i| state.p_n[i]).sum();
        let mean = |of: &dyn Fn(&ContactNode) -> [f64; 3]| {
            pressed.iter().fold([0.0; 3], |sum, &i| plus(sum, state.p_n[i] / total, of(&self.contact.nodes[i])))
        };
        let normal = mean(&|contact| contact.facing.normal);
        if norm(normal) == 0.0 {
            return None;
        }
        let normal = unit(normal);
        let along = |x: [f64; 3]| norm(plus(x, -dot(x, normal), normal));
        let middle = mean(&|contact| contact.position);
        let moved = along(minus(point, mean(&|contact| all[contact.node])));
        let width = |&i: &usize| {
            let contact = &self.contact.nodes[i];
            let edge = self.contact.pairs[pair].edges.get(&contact.node).copied().filter(|edge| edge.is_finite());
            along(minus(contact.position, middle)).max(edge.unwrap_or(0.0))
        };
        let half = pressed.iter().map(width).fold(0.0, f64::max);
        (half > 0.0).then_some((moved, moved / half))
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

/// A rigid body that has moved along its contact, and that supports do not hold against rotation. With small displacements
/// forces act where they were, so that their moment about the contact is off by force times motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LargeMotion {
    /// The number of the coupling.
    pub coupling: usize,
    /// The motion of the reference point along the contact relative to the other side, m.
    pub moved: f64,
    /// The motion divided by half the width of the pressed zone, at least by the size of a facet.
    pub share: f64,
}
