//! Systems with a dense stiffness, such as that of a condensed body: an iteration factors only the part that contact
//! leaves unconstrained.
//!
//! The matrices of a run, on displacements `u` and other unknowns `q` (contact forces, slacks), are
//!
//! ```text
//! [ S + E  B ] [u]   [b_u]
//! [   A    D ] [q] = [b_q]
//! ```
//!
//! with `S` dense and constant; `E`, mostly 0, contains springs on single displacements. Contact rows couple a node's
//! unknowns only to each other. Their solutions (see `local`) are `u = P_u b_q + V t`, `q = P_q b_q + Y t + Z s`,
//! where the reactions `s` appear only in the equilibrium rows of their own node. `Wᵀ` takes the combinations of
//! these rows without reactions:
//!
//! ```text
//! Wᵀ (S V + E V + B Y) t = Wᵀ (b_u - ((S + E) P_u + B P_q) b_q).
//! ```
//!
//! Only this matrix is factored. Its order is the number of displacements that contact leaves unconstrained: two for
//! an open node, one for a slipping node, none for a sticking node, and two for all nodes in an interior point
//! method, which uses the same elimination.
//!
//! `S` is read in place. The matrix to factor is gathered from it each time, although most of it is unchanged:
//! storing it besides its factors would need one more copy, and copying it is as much work as gathering it.

use std::sync::Arc;

use faer::Mat;
use rayon::prelude::*;

use super::{Computed, FactorInfo, LinearError, LinearSolver, SystemMatrix, expect_length};
use crate::algebra::sparse::{Csc, Csr, DenseSymmetric, Pattern};

mod blocks;
mod local;
mod lu;

use blocks::Blocks;
use local::Local;
pub use lu::Lu;
pub(crate) use lu::times_transposed;

/// A dense solver that eliminates the contact rows node by node.
#[derive(Default)]
pub struct Dense {
    blocks: Option<Blocks>,
    contact: Option<ContactFactors>,
}

/// The factors, with the solutions of the contact rows.
struct ContactFactors {
    /// `S`, shared with the matrix that was factored.
    stiffness: DenseSymmetric,
    /// The solved groups.
    groups: Vec<Local>,
    /// The displacements of the groups that have reactions.
    reacting: Vec<usize>,
    /// The factors of `Wᵀ (S V + E V + B Y)`.
    lu: Lu,
}

impl Dense {
    /// Returns the largest number of unknowns that contact rows couple; 0 before the analysis.
    pub(super) fn largest_group(&self) -> usize {
        let groups = self.blocks.iter().flat_map(|blocks| &blocks.groups);
        groups.map(|group| group.unknowns().count()).max().unwrap_or(0)
    }
}

impl LinearSolver for Dense {
    fn name(&self) -> &'static str {
        "dense"
    }

    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Computed<()> {
        self.analyze_system(&Csc::zeros(Arc::clone(pattern)).into())
    }

    fn factorize(&mut self, values: &[f64]) -> Computed<FactorInfo> {
        let blocks = self.blocks.as_ref().ok_or(LinearError::Order { missing: "analyze" })?;
        expect_length("values of the matrix", blocks.pattern.len(), values.len())?;
        let mut matrix = Csc::zeros(Arc::clone(&blocks.pattern));
        matrix.values_mut().copy_from_slice(values);
        self.factorize_system(&matrix.into())
    }

    /// Finds the groups of unknowns that the contact rows of `a` couple.
    fn analyze_system(&mut self, a: &SystemMatrix) -> Computed<()> {
        (self.blocks, self.contact) = (None, None);
        self.blocks = Some(Blocks::new(a)?);
        Ok(())
    }

    /// # Errors
    /// [`LinearError::Singular`] if a pivot vanishes or may be mere rounding, [`LinearError::NotFinite`] if an entry
    /// is not finite.
    fn factorize_system(&mut self, a: &SystemMatrix) -> Computed<FactorInfo> {
        let blocks = self.blocks.as_ref().ok_or(LinearError::Order { missing: "analyze" })?;
        let stiffness = a.leading().map_or_else(|| DenseSymmetric::of_lower(0, Vec::new()), DenseSymmetric::clone);
        expect_length("values of the matrix", blocks.pattern.len(), a.pattern().len())?;
        expect_length("displacements in the matrix", blocks.displacements, stiffness.order())?;
        // Unchanged groups and the memory of the last factors are reused.
        let last = self.contact.take().map(|contact| (contact.groups, contact.lu.into_memory()));
        let (last, mut matrix) = last.unwrap_or_else(|| (Vec::new(), Mat::new()));
        if !stiffness.is_finite() {
            return Err(LinearError::NotFinite);
        }
        let (mut last, values) = (last.into_iter(), a.rest().values());
        let groups =
            blocks.groups.iter().map(|group| group.solve(values, last.next())).collect::<Result<Vec<_>, _>>()?;
        let sizes = blocks.form(&stiffness, &groups, &mut matrix);
        let lu = Lu::new(matrix, &sizes)?;
        let reacting = blocks.groups.iter().zip(&groups).filter(|(_, local)| local.reacts());
        let reacting = reacting.flat_map(|(group, _)| group.displacements.iter().copied()).collect();
        let contact = self.contact.insert(ContactFactors { stiffness, groups, reacting, lu });
        let (m, k) = (blocks.displacements, contact.lu.order());
        Ok(FactorInfo {
            entries: k * k,
            flops: 2.0 / 3.0 * (k as f64).powi(3),
            pivot_ratio: contact.lu.pivot_ratio(),
            peak_bytes: 8.0 * (m * m + k * k) as f64,
        })
    }

    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Computed<()> {
        let (Some(blocks), Some(contact)) = (&self.blocks, &self.contact) else {
            return Err(LinearError::Order { missing: "factorize" });
        };
        expect_length("right-hand side", blocks.pattern.columns(), b.len())?;
        expect_length("solution", blocks.pattern.columns(), x.len())?;
        contact.solve(blocks, b, x);
        Ok(())
    }
}

impl Blocks {
    /// Returns a matrix with one row for each `t`: the vector `row` of its group, on the displacements of the group.
    fn on_displacements(&self, groups: &[Local], row: fn(&Local, usize) -> &[f64]) -> Csr {
        let rows = self.groups.iter().zip(groups).flat_map(|(group, local)| {
            let entries = move |j| group.displacements.iter().copied().zip(row(local, j).iter().copied());
            (0..local.moving).map(entries)
        });
        Csr::of_rows(self.displacements, rows)
    }

    /// Writes `Wᵀ (S V + E V + B Y)` of the `groups`. Returns for each column the size of the numbers from which it
    /// was computed.
    fn form(&self, stiffness: &DenseSymmetric, groups: &[Local], matrix: &mut Mat<f64>) -> Vec<f64> {
        let projections = self.on_displacements(groups, Local::projection);
        let motions = self.on_displacements(groups, Local::motion);
        let order = motions.rows();
        matrix.resize_with(order, order, |_, _| 0.0);
        let project = |column: &[f64], factor: f64, to: &mut [f64]| {
            to.iter_mut().enumerate().for_each(|(i, to)| *to = factor * projections.dot(i, column));
        };
        let write = |(j, to): (usize, &mut [f64])| match motions.row(j) {
            // Most nodes move along an axis.
            &[(place, factor)] => project(stiffness.column(place), factor * stiffness.factor(), to),
            several => {
                let mut column = vec![0.0; self.displacements];
                for &(place, factor) in several {
                    column.iter_mut().zip(stiffness.column(place)).for_each(|(sum, s)| *sum += factor * s);
                }
                project(&column, stiffness.factor(), to);
            }
        };
        if lu::threads(order) == 1 {
            (0..order).for_each(|j| write((j, matrix.col_as_slice_mut(j))));
        } else {
            let columns: Vec<&mut [f64]> = matrix
                .as_mut()
                .col_iter_mut()
                .filter_map(|column| Some(column.try_as_col_major_mut()?.as_slice_mut()))
                .collect();
            columns.into_par_iter().enumerate().for_each(write);
        }
        let mut sizes = Vec::with_capacity(order);
        for (group, local) in self.groups.iter().zip(groups) {
            let first = sizes.len();
            for j in 0..local.moving {
                let own = local.own(j);
                let column = matrix.col_as_slice_mut(first + j);
                column[first..].iter_mut().zip(&own).for_each(|(to, own)| *to += own);
                let moved = group.displacements.iter().zip(local.motion(j));
                let of_stiffness =
                    moved.map(|(&place, factor)| (factor * stiffness.get(place, place)).abs()).sum::<f64>();
                sizes.push(own.iter().fold(0.0_f64, |m, value| m.max(value.abs())) + of_stiffness);
            }
        }
        sizes
    }
}

impl ContactFactors {
    /// Solves for `x = (u, q)`.
    fn solve(&self, blocks: &Blocks, b: &[f64], x: &mut [f64]) {
        let m = blocks.displacements;
        let all = || blocks.groups.iter().zip(&self.groups);
        let gather = |from: &[f64], places: &[usize], to: &mut Vec<f64>| {
            to.clear();
            to.extend(places.iter().map(|&place| from[place]));
        };
        // The values of a group, and the residual of its equilibrium rows.
        let (mut given, mut own) = (Vec::new(), Vec::new());
        let mut rest = b[..m].to_vec();
        for (group, local) in all() {
            gather(b, &group.others, &mut given);
            own.clear();
            own.extend(local.start(&given));
            group.displacements.iter().zip(local.act(&own)).for_each(|(&place, force)| rest[place] -= force);
            group.unknowns().zip(&own).for_each(|(unknown, value)| x[unknown] = *value);
        }
        if x[..m].iter().any(|u| *u != 0.0) {
            let mut force = vec![0.0; m];
            self.stiffness.mul(&x[..m], &mut force);
            rest.iter_mut().zip(&force).for_each(|(rest, force)| *rest -= force);
        }
        let mut projected = Vec::with_capacity(self.lu.order());
        for (group, local) in all() {
            gather(&rest, &group.displacements, &mut own);
            projected.extend(local.project(&own));
        }
        let t = self.lu.solve(&projected);
        let (mut change, mut t) = (vec![0.0; m], &t[..]);
        for (group, local) in all() {
            let (own, others) = t.split_at(local.moving);
            t = others;
            let moved = local.moved(own);
            group.unknowns().zip(&moved).for_each(|(unknown, value)| x[unknown] += value);
            for ((&place, moved), force) in group.displacements.iter().zip(&moved).zip(local.act(&moved)) {
                change[place] = *moved;
                rest[place] -= force;
            }
        }
        let forces = self.stiffness.products(&self.reacting, &change);
        self.reacting.iter().zip(forces).for_each(|(&place, force)| rest[place] -= force);
        for (group, local) in all().filter(|(_, local)| local.reacts()) {
            gather(&rest, &group.displacements, &mut own);
            gather(x, &group.others, &mut given);
            local.react(&own, &mut given);
            group.others.iter().zip(&given).for_each(|(&unknown, q)| x[unknown] = *q);
        }
    }
}
