//! Systems whose stiffness is dense, as that of a condensed body: an iteration factors what contact
//! leaves free.
//!
//! The matrices of a run, on displacements `u` and other unknowns `q` (contact forces, slacks), are
//!
//! ```text
//! [ S B ] [u]   [b_u]
//! [ A D ] [q] = [b_q]
//! ```
//!
//! Contact rows couple a node's unknowns only to each other. Their solutions (see `local`) are
//! `u = P_u b_q + V t`, `q = P_q b_q + Y t + Z s`, where the reactions `s` stand in the equilibrium
//! rows of their own node alone; `Wᵀ` takes the combinations of those rows that are without them:
//!
//! ```text
//! Wᵀ (S V + B Y) t = Wᵀ (b_u - (S P_u + B P_q) b_q).
//! ```
//!
//! This matrix is all that is factored. Its order is the number of displacements that contact leaves
//! free: two for an open node, one for a slipping one, none for a sticking one, and two for all nodes
//! in an interior point method, where the same elimination serves.

use std::sync::Arc;

use faer::Mat;

use super::error::expect_length;
use super::{FactorInfo, LinearError, LinearSolver};
use crate::sparse::Pattern;

mod blocks;
mod local;
mod lu;

use blocks::Blocks;
use local::Local;
use lu::Lu;
pub use lu::times_transposed;

/// A dense solver that eliminates the contact rows node by node.
pub struct Dense {
    displacements: usize,
    blocks: Option<Blocks>,
    /// `S`, kept from one factorisation to the next for its memory.
    stiffness: Mat<f64>,
    contact: Option<Contact>,
}

/// The factors.
struct Contact {
    /// The groups, solved.
    groups: Vec<Local>,
    /// The factors of `Wᵀ (S V + B Y)`.
    lu: Lu,
}

impl Dense {
    /// A solver for matrices whose first `displacements` unknowns are `u`.
    pub fn new(displacements: usize) -> Self {
        Dense { displacements, blocks: None, stiffness: Mat::new(), contact: None }
    }
}

impl Contact {
    fn new(blocks: &Blocks, stiffness: &Mat<f64>, values: &[f64]) -> Result<Self, LinearError> {
        let groups = blocks.groups.iter().map(|group| group.solve(values)).collect::<Result<Vec<_>, _>>()?;
        let order = groups.iter().map(Local::moving).sum();
        let mut matrix = Mat::zeros(order, order);
        let mut column_of_s_v = vec![0.0; blocks.displacements.len()];
        let mut sizes = Vec::with_capacity(order);
        let all = || blocks.groups.iter().zip(&groups);
        for (k, (group, local)) in all().enumerate() {
            for j in 0..local.moving() {
                let own = local.own(j);
                let mut size = own.iter().fold(0.0_f64, |m, value| m.max(value.abs()));
                column_of_s_v.fill(0.0);
                for (place, factor) in group.displacements.clone().zip(local.motion(j)) {
                    // Most nodes move along an axis.
                    if *factor != 0.0 {
                        let s = stiffness.col_as_slice(place);
                        column_of_s_v.iter_mut().zip(s).for_each(|(sum, s)| *sum += factor * s);
                        size += factor.abs() * stiffness[(place, place)].abs();
                    }
                }
                let to = matrix.col_as_slice_mut(sizes.len());
                let mut row = 0;
                for (i, (group, local)) in all().enumerate() {
                    let to = &mut to[row..row + local.moving()];
                    let sums = local.project(&column_of_s_v[group.displacements.clone()]);
                    to.iter_mut().zip(sums).for_each(|(to, sum)| *to = sum);
                    if i == k {
                        to.iter_mut().zip(&own).for_each(|(to, own)| *to += own);
                    }
                    row += local.moving();
                }
                sizes.push(size);
            }
        }
        Ok(Contact { groups, lu: Lu::new(matrix, &sizes)? })
    }

    /// Solves for `x = (u, q)`.
    fn solve(&self, blocks: &Blocks, stiffness: &Mat<f64>, b: &[f64], x: &mut [f64]) {
        let mut u = vec![0.0; blocks.displacements.len()];
        let mut rest: Vec<f64> = blocks.displacements.iter().map(|&unknown| b[unknown]).collect();
        let all = || blocks.groups.iter().zip(&self.groups);
        let gather = |x: &[f64], others: &[usize]| others.iter().map(|&unknown| x[unknown]).collect::<Vec<f64>>();
        let scatter = |q: &[f64], others: &[usize], x: &mut [f64]| {
            others.iter().zip(q).for_each(|(&unknown, q)| x[unknown] = *q);
        };
        for (group, local) in all() {
            let mut q = vec![0.0; group.others.len()];
            local.start(&gather(b, &group.others), &mut u[group.displacements.clone()], &mut q);
            local.subtract_forces(&q, &mut rest[group.displacements.clone()]);
            scatter(&q, &group.others, x);
        }
        lu::subtract_product(stiffness, &u, &mut rest);
        let projected: Vec<f64> =
            all().flat_map(|(group, local)| local.project(&rest[group.displacements.clone()])).collect();
        let t = self.lu.solve(&projected);
        let (mut change, mut t) = (vec![0.0; u.len()], &t[..]);
        for (group, local) in all() {
            let (own, others) = t.split_at(local.moving());
            t = others;
            let mut q = vec![0.0; group.others.len()];
            local.move_by(own, &mut change[group.displacements.clone()], &mut q);
            local.subtract_forces(&q, &mut rest[group.displacements.clone()]);
            group.others.iter().zip(&q).for_each(|(&unknown, q)| x[unknown] += q);
        }
        lu::subtract_product(stiffness, &change, &mut rest);
        u.iter_mut().zip(&change).for_each(|(u, change)| *u += change);
        for (group, local) in all() {
            let mut q = gather(x, &group.others);
            local.react(&rest[group.displacements.clone()], &mut q);
            scatter(&q, &group.others, x);
        }
        blocks.displacements.iter().zip(&u).for_each(|(&unknown, u)| x[unknown] = *u);
    }
}

impl LinearSolver for Dense {
    fn name(&self) -> &'static str {
        "dense"
    }

    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<(), LinearError> {
        self.contact = None;
        let blocks = Blocks::new(pattern, self.displacements)?;
        self.stiffness = Mat::zeros(self.displacements, self.displacements);
        self.blocks = Some(blocks);
        Ok(())
    }

    fn factorize(&mut self, values: &[f64]) -> Result<FactorInfo, LinearError> {
        let blocks = self.blocks.as_ref().ok_or(LinearError::Order { missing: "analyze" })?;
        expect_length("values of the matrix", blocks.pattern.len(), values.len())?;
        self.contact = None;
        blocks.copy_stiffness(values, &mut self.stiffness);
        let contact = self.contact.insert(Contact::new(blocks, &self.stiffness, values)?);
        let (m, k) = (self.displacements, contact.lu.order());
        Ok(FactorInfo {
            entries: k * k,
            flops: 2.0 / 3.0 * (k as f64).powi(3),
            pivot_ratio: contact.lu.pivot_ratio(),
            peak_bytes: 8.0 * (m * m + k * k) as f64,
        })
    }

    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        let (Some(blocks), Some(contact)) = (&self.blocks, &self.contact) else {
            return Err(LinearError::Order { missing: "factorize" });
        };
        expect_length("right-hand side", blocks.pattern.columns(), b.len())?;
        expect_length("solution", blocks.pattern.columns(), x.len())?;
        contact.solve(blocks, &self.stiffness, b, x);
        Ok(())
    }
}
