//! The preconditioner: elimination of contact, a cycle for the remaining unknowns, and the forces that follow.

use super::block::Border;
use super::form::Form;
use super::grid::OnGrid;
use super::hierarchy::Hierarchy;
use super::node::Eliminated;
use super::small::{put, vector};
use super::stiffness::BlockLayout;
use stickslip::algebra::linear::{Grid, LinearError};

/// The workspace: vectors on all directions.
#[derive(Default)]
pub(super) struct Work {
    rest: Vec<f64>,
    correction: Vec<f64>,
    displacements: Vec<f64>,
}

/// The eliminated contact nodes of one matrix.
pub(super) struct Elimination<'a> {
    pub grid: &'a Grid,
    pub layout: &'a BlockLayout,
    pub nodes: &'a [Eliminated],
    pub border: &'a [Border],
    pub form: Form,
}

impl Elimination<'_> {
    /// Computes `z` with `A z ≈ r` on the whole system, by one cycle.
    pub(super) fn precondition(
        &self,
        hierarchy: &mut Hierarchy,
        work: &mut Work,
        r: &[f64],
        z: &mut [f64],
    ) -> Result<(), LinearError> {
        let Elimination { grid, layout, nodes, border, form } = *self;
        let (n_u, d) = (layout.displacements, layout.dimension);
        let Work { rest, correction, displacements } = work;
        rest.clear();
        rest.resize(layout.order(), 0.0);
        correction.clear();
        correction.resize(layout.order(), 0.0);
        // Equilibrium, in the frames.
        displacements.clear();
        displacements.extend_from_slice(&r[..n_u]);
        grid.residual_from_mesh(displacements);
        layout.place.iter().zip(&*displacements).for_each(|(&(node, direction), r)| rest[node * d + direction] = *r);
        let rows = |forces: &[Option<usize>; 3]| forces.map(|place| place.map_or(0.0, |place| r[place]));
        let mut held: Vec<[f64; 3]> = Vec::with_capacity(layout.contacts.len());
        let mut lacking: Vec<[f64; 3]> = Vec::with_capacity(layout.contacts.len());
        for (&(node, forces), eliminated) in layout.contacts.iter().zip(nodes) {
            let own = eliminated.in_frame(vector(rest, node, d));
            lacking.push(own);
            put(rest, node, d, own);
            held.push(eliminated.prescribed(rows(&forces)));
        }
        // Constrained displacements, and the forces that follow from them, go to the right-hand side.
        for (i, (&(node, forces), eliminated)) in layout.contacts.iter().zip(nodes).enumerate() {
            let following = eliminated.on_equilibrium(eliminated.following(rows(&forces), held[i]));
            let mut own = vector(rest, node, d);
            own.iter_mut().zip(following).for_each(|(own, f)| *own -= f);
            put(rest, node, d, own);
        }
        for (i, &(node, _)) in layout.contacts.iter().enumerate() {
            for (row, w) in border[i].iter().zip(held[i]).filter(|(_, w)| *w != 0.0) {
                for (k, &column) in layout.columns(node).iter().enumerate() {
                    (0..d).for_each(|c| rest[column * d + c] -= row[k * d + c] * w);
                }
            }
        }
        // The cycle gives the unconstrained directions.
        for (&(node, _), eliminated) in layout.contacts.iter().zip(nodes) {
            let mut own = vector(rest, node, d);
            if form == Form::Oblique {
                let before = own;
                for (own, sweep) in own.iter_mut().zip(&eliminated.sweep) {
                    *own -= (0..3).map(|j| sweep[j] * before[j]).sum::<f64>();
                }
            }
            let gone = eliminated.gone();
            put(rest, node, d, [0, 1, 2].map(|k| if gone[k] { 0.0 } else { own[k] }));
        }
        hierarchy.cycle(layout, nodes, rest, correction)?;
        for (i, (&(node, _), eliminated)) in layout.contacts.iter().zip(nodes).enumerate() {
            let (own, gone) = (vector(correction, node, d), eliminated.gone());
            put(correction, node, d, [0, 1, 2].map(|k| if gone[k] { held[i][k] } else { own[k] }));
        }
        // The forces; the reactions balance the equilibrium residual.
        for (i, (&(node, forces), eliminated)) in layout.contacts.iter().zip(nodes).enumerate() {
            let w = vector(correction, node, d);
            let following = eliminated.following(rows(&forces), w);
            let by_following = eliminated.on_equilibrium(following);
            let lacking = [0, 1, 2].map(|a| {
                let by_body: f64 = layout
                    .columns(node)
                    .iter()
                    .enumerate()
                    .flat_map(|(k, &column)| (0..d).map(move |c| (k * d + c, column * d + c)))
                    .map(|(entry, at)| border[i][a][entry] * correction[at])
                    .sum();
                lacking[i][a] - by_body - by_following[a]
            });
            let reactions = eliminated.reactions(lacking);
            for (k, place) in forces.into_iter().enumerate() {
                if let Some(place) = place {
                    z[place] = following[k] + reactions[k];
                }
            }
        }
        for (&(node, _), eliminated) in layout.contacts.iter().zip(nodes) {
            let own = eliminated.out_of_frame(vector(correction, node, d));
            put(correction, node, d, own);
        }
        z[..n_u]
            .iter_mut()
            .zip(&layout.place)
            .for_each(|(z, &(node, direction))| *z = correction[node * d + direction]);
        grid.to_mesh(&mut z[..n_u]);
        Ok(())
    }
}

/// Returns the orthonormal rigid modes, in the frames.
pub(super) fn kernel(grid: &Grid, layout: &BlockLayout, nodes: &[Eliminated]) -> Vec<Vec<f64>> {
    let d = layout.dimension;
    let mut kernel: Vec<Vec<f64>> = Vec::new();
    for motion in grid.motions() {
        let mut all = vec![0.0; layout.order()];
        layout.place.iter().zip(&motion).for_each(|(&(node, direction), u)| all[node * d + direction] = *u);
        for (&(node, _), eliminated) in layout.contacts.iter().zip(nodes) {
            let own = eliminated.in_frame(vector(&all, node, d));
            put(&mut all, node, d, own);
        }
        let norm = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let before = norm(&all);
        for _ in 0..2 {
            for other in &kernel {
                let share: f64 = other.iter().zip(&all).map(|(a, b)| a * b).sum();
                all.iter_mut().zip(other).for_each(|(v, other)| *v -= share * other);
            }
        }
        let size = norm(&all);
        if size > 1e-10 * before {
            for v in &mut all {
                *v /= size;
            }
            kernel.push(all);
        }
    }
    kernel
}
