//! The equations of given statuses, solved for all data at once with a dense stiffness: a dictionary, in the language
//! of linear programming.
//!
//! In contact coordinates `F = Ŝ w`, with `F = f̂ - p`. The contact law prescribes one member of each pair
//! `(w_k, F_k)`: `w_n` of a closed node, `w_t` of a sticking node, and `F = f̂` of an open node. If a node slips,
//! `p_t = ± μ p_n` prescribes `F_t ∓ μ F_n`. The dictionary `y = D x` has the prescribed members in `x` and the
//! others in `y`. If one pair changes sides, `D` changes by a matrix of rank one,
//! ```text
//! D_ij ← D_ij - D_ik D_kj / D_kk,   D_kj ← -D_kj / D_kk,   D_ik ← D_ik / D_kk,   D_kk ← 1 / D_kk,
//! ```
//!
//! A force that is measured from another border of the cone also changes `D` by a matrix of rank one. Since rounding
//! accumulates, each solution is checked against `Ŝ`, and the dictionary is rebuilt if the check fails.

use faer::Mat;
use faer::linalg::solvers::DenseSolveCore;

use super::coordinates::Coordinates;
use super::node::{Given, NodalContact, NodeStatus, largest};
use super::tangent::{Snapshot, Tangent};
use crate::algebra::linear::{Computed, Statistics};
use crate::algebra::vector::dot;
use crate::base::units::Scaling;
use crate::solver::problem::ContactProblem;

/// A pivot below this share of the stiffness or compliance there counts as rounding.
const SINGULAR: f64 = 1e-12;

/// The largest residual without refinement, in roundings of the largest elastic force of a single coordinate.
const RESIDUAL_ROUNDINGS: f64 = 4.0;

/// The largest rounding of the elastic forces, relative to the forces. Beyond it the system counts as singular.
const LOST: f64 = 1e-3;

/// The dictionary is rebuilt if the residual exceeds this share of the largest force.
const RENEWED: f64 = 1e-12;

/// A solution is rejected if its residual exceeds this share: the system is then singular up to rounding.
const UNSOLVED: f64 = 1e-9;

/// The share of changed statuses beyond which rebuilding is cheaper than rank-one changes.
const MANY: f64 = 0.25;

pub(super) struct Dictionary {
    mu: Vec<f64>,
    coordinates: Coordinates,
    /// `Ŝ`, which is symmetric, column by column.
    stiffness: Vec<f64>,
    /// The largest entry of `Ŝ`, which is on its diagonal.
    stiffest: f64,
    /// `D`, column by column; empty before the first statuses are set, and if they are singular.
    table: Vec<f64>,
    statuses: Vec<NodeStatus>,
    /// The statistics, in which a rebuild of `D` counts as a factorisation.
    statistics: Statistics,
}

impl Dictionary {
    /// Creates the equations of a problem with a dense stiffness, whose nodes slide along these `tangents`. Returns
    /// `None` if contact rows are linearly dependent.
    pub(super) fn new(
        problem: &ContactProblem,
        tangents: &[Option<usize>],
        scaling: Scaling,
    ) -> Computed<Option<Self>> {
        let Some(coordinates) = Coordinates::new(problem, tangents) else { return Ok(None) };
        let n = coordinates.order();
        let mut entries = vec![0.0; n * n];
        for (i, j, value) in problem.stiffness().assembled()?.entries() {
            entries[j * n + i] = value / scaling.stiffness();
        }
        let stiffness = coordinates.stiffness(|i, j| entries[j * n + i]);
        Ok(Some(Dictionary {
            mu: problem.mu().to_vec(),
            coordinates,
            stiffest: (0..n).fold(0.0_f64, |m, k| m.max(stiffness[k * (n + 1)])),
            stiffness,
            table: Vec::new(),
            statuses: Vec::new(),
            statistics: Statistics::default(),
        }))
    }

    /// Returns for each coordinate `true` if the law prescribes its displacement, `false` if it prescribes its force.
    fn given_displacements(&self, statuses: &[NodeStatus]) -> Vec<bool> {
        let mut given = vec![false; self.coordinates.order()];
        for (i, status) in statuses.iter().enumerate() {
            given[self.coordinates.normal[i]] = status.is_closed();
            if let Some(t) = self.coordinates.tangential[i] {
                given[t] = status.is_sticking();
            }
        }
        given
    }

    /// Iterates over the slipping nodes: the two coordinates and `± μ` of each.
    fn sliders<'s>(&'s self, statuses: &'s [NodeStatus]) -> impl Iterator<Item = (usize, usize, f64)> + 's {
        statuses.iter().enumerate().filter_map(|(i, status)| {
            let t = self.coordinates.tangential[i].filter(|_| status.sign() != 0.0)?;
            Some((self.coordinates.normal[i], t, status.sign() * self.mu[i]))
        })
    }

    /// Builds the dictionary of these statuses from `Ŝ`. Returns `false` if they are singular.
    fn renew(&mut self, statuses: &[NodeStatus]) -> bool {
        self.statistics.factorizations += 1;
        self.table.clear();
        self.statuses = statuses.to_vec();
        let n = self.coordinates.order();
        let mut forces = self.stiffness.clone();
        for (normal, tangential, drive) in self.sliders(statuses) {
            for column in forces.chunks_exact_mut(n) {
                column[tangential] -= drive * column[normal];
            }
        }
        let given = self.given_displacements(statuses);
        let (free, fixed): (Vec<usize>, Vec<usize>) = (0..n).partition(|&k| !given[k]);
        let block = |rows: &[usize], columns: &[usize]| {
            Mat::from_fn(rows.len(), columns.len(), |i, j| forces[columns[j] * n + rows[i]])
        };
        let lu = block(&free, &free).partial_piv_lu();
        if (0..free.len()).any(|k| self.vanishes(lu.U()[(k, k)], free[k])) {
            return false;
        }
        let compliance = lu.inverse();
        let (coupling, back) = (block(&free, &fixed), block(&fixed, &free));
        let moved = &compliance * &coupling;
        let carried_over = &back * &compliance;
        let condensed = block(&fixed, &fixed) - &back * &moved;
        let mut table = vec![0.0; n * n];
        let mut write = |rows: &[usize], columns: &[usize], sign: f64, values: &Mat<f64>| {
            for (j, &column) in columns.iter().enumerate() {
                for (i, &row) in rows.iter().enumerate() {
                    table[column * n + row] = sign * values[(i, j)];
                }
            }
        };
        write(&free, &free, 1.0, &compliance);
        write(&free, &fixed, -1.0, &moved);
        write(&fixed, &free, 1.0, &carried_over);
        write(&fixed, &fixed, 1.0, &condensed);
        let finite = table.iter().all(|value| value.is_finite());
        if finite {
            self.table = table;
        }
        finite
    }

    /// Returns `true` if the pivot of coordinate `k`, a stiffness, is rounding of its diagonal entry or of the whole
    /// matrix.
    fn vanishes(&self, pivot: f64, k: usize) -> bool {
        let n = self.coordinates.order();
        let rounding = n as f64 * f64::EPSILON * self.stiffest;
        pivot.is_nan() || pivot.abs() <= (SINGULAR * self.stiffness[k * (n + 1)]).max(rounding)
    }

    /// Exchanges the members of pair `k`. Returns `false` if the pivot vanishes.
    fn pivot(&mut self, k: usize, frees: bool) -> bool {
        let n = self.coordinates.order();
        let pivot = self.table[k * n + k];
        let own = self.stiffness[k * n + k];
        if if frees { self.vanishes(pivot, k) } else { (pivot * own).is_nan() || (pivot * own).abs() <= SINGULAR } {
            return false;
        }
        let mut column = self.table[k * n..][..n].to_vec();
        column[k] = 0.0;
        for (j, other) in self.table.chunks_exact_mut(n).enumerate() {
            let along = other[k] / pivot;
            if j == k {
                for value in other.iter_mut() {
                    *value /= pivot;
                }
                other[k] = 1.0 / pivot;
            } else if along != 0.0 {
                other.iter_mut().zip(&column).for_each(|(value, c)| *value -= along * c);
                other[k] = -along;
            }
        }
        true
    }

    /// Changes the status of one node pair by pair. Returns `false` if a pivot vanishes.
    fn change(&mut self, i: usize, to: NodeStatus) -> bool {
        let n = self.coordinates.order();
        let (normal, tangential) = (self.coordinates.normal[i], self.coordinates.tangential[i]);
        let from = std::mem::replace(&mut self.statuses[i], to);
        let Some(t) = tangential else {
            return from.is_closed() == to.is_closed() || self.pivot(normal, !to.is_closed());
        };
        // The change goes through an intermediate status, sticking or open, whose force is measured from 0.
        let drive = |status: NodeStatus| status.sign() * self.mu[i];
        let (leaving, entered) = (drive(from), drive(to));
        if from == NodeStatus::Open && to.is_closed() {
            // F_t = (F_t - d F_n) + d F_n, both prescribed.
            self.add_column(t, normal, entered);
            return self.pivot(normal, false) && (to.sign() != 0.0 || self.pivot(t, false));
        }
        if to == NodeStatus::Open {
            if from == NodeStatus::Stick && !self.pivot(t, true) {
                return false;
            }
            if !self.pivot(normal, true) {
                return false;
            }
            self.add_column(t, normal, -leaving);
            return true;
        }
        if from.sign() != 0.0 {
            if !self.pivot(t, false) {
                return false;
            }
            self.add_row(n, normal, t, leaving);
        }
        if to.sign() != 0.0 {
            self.add_row(n, normal, t, -entered);
            return self.pivot(t, true);
        }
        true
    }

    /// Adds `factor` times row `from` to row `to`.
    fn add_row(&mut self, n: usize, from: usize, to: usize, factor: f64) {
        self.table.chunks_exact_mut(n).for_each(|column| column[to] += factor * column[from]);
    }

    /// Adds `factor` times column `from` to column `to`.
    fn add_column(&mut self, from: usize, to: usize, factor: f64) {
        let n = self.coordinates.order();
        for row in 0..n {
            self.table[to * n + row] += factor * self.table[from * n + row];
        }
    }

    /// Returns `D x`.
    fn product(&self, x: &[f64]) -> Vec<f64> {
        let n = x.len();
        let mut y = vec![0.0; n];
        for (x, column) in x.iter().zip(self.table.chunks_exact(n.max(1))).filter(|(x, _)| **x != 0.0) {
            y.iter_mut().zip(column).for_each(|(y, d)| *y += x * d);
        }
        y
    }

    /// Returns the prescribed members `x` for the `given` data, where the forces on the coordinates are `load`.
    fn prescribed(&self, given: &Given, load: &[f64]) -> Vec<f64> {
        let mut x = load.to_vec();
        self.measured(&mut x, 1.0);
        for (i, status) in self.statuses.iter().enumerate() {
            if status.is_closed() {
                x[self.coordinates.normal[i]] = given.gap[i];
            }
            if let (true, Some(t)) = (status.is_sticking(), self.coordinates.tangential[i]) {
                x[t] = given.slide[i];
            }
        }
        x
    }

    /// Writes the `answer` with the displacements `w` and the elastic forces `F` under the `load`.
    fn write(&self, w: &[f64], load: &[f64], forces: &[f64], answer: &mut NodalContact) {
        for i in 0..self.statuses.len() {
            let (normal, tangential) = (self.coordinates.normal[i], self.coordinates.tangential[i]);
            let open = !self.statuses[i].is_closed();
            answer.w_n[i] = w[normal];
            answer.p_n[i] = if open { 0.0 } else { load[normal] - forces[normal] };
            answer.w_t[i] = tangential.map_or(0.0, |t| w[t]);
            answer.p_t[i] = match (tangential, self.statuses[i].sign()) {
                (None, _) => 0.0,
                (Some(_), _) if open => 0.0,
                (Some(t), 0.0) => load[t] - forces[t],
                (Some(_), sign) => sign * self.mu[i] * answer.p_n[i],
            };
        }
        answer.u = self.coordinates.displacements(w);
        answer.u_rest.clear();
    }

    /// Measures the forces `F` of slipping nodes from the border of the cone (`sign` = 1), or reverses this (`sign` =
    /// -1).
    fn measured(&self, forces: &mut [f64], sign: f64) {
        for (normal, tangential, drive) in self.sliders(&self.statuses) {
            forces[tangential] -= sign * drive * forces[normal];
        }
    }
}

impl Tangent for Dictionary {
    fn set_statuses(&mut self, statuses: &[NodeStatus]) -> Computed<bool> {
        let changed: Vec<usize> = if self.table.is_empty() {
            (0..statuses.len()).collect()
        } else {
            (0..statuses.len()).filter(|&i| statuses[i] != self.statuses[i]).collect()
        };
        let few = changed.len() as f64 <= MANY * statuses.len() as f64;
        // Intermediate statuses may be singular even if the final ones are not.
        if !self.table.is_empty() && few && changed.iter().all(|&i| self.change(i, statuses[i])) {
            return Ok(true);
        }
        Ok(self.renew(statuses))
    }

    fn solve(&mut self, given: &Given, answer: &mut NodalContact) -> Computed<bool> {
        if self.table.is_empty() && self.coordinates.order() > 0 {
            return Ok(false);
        }
        self.statistics.solves += 1;
        let load = self.coordinates.forces(&given.force);
        let is_given = self.given_displacements(&self.statuses);
        let n = load.len();
        let x = self.prescribed(given, &load);
        // Prescribed displacements cause forces of this size, unless the whole body moves with them.
        let moved = (0..n).filter(|&k| is_given[k]).fold(0.0_f64, |m, k| m.max(x[k].abs()));
        let (mut left, mut scale, mut rounding) = (0.0, 0.0, 0.0);
        let (mut w, mut forces) = (vec![0.0; n], vec![0.0; n]);
        for attempt in 0..2 {
            let y = self.product(&x);
            for k in 0..n {
                (w[k], forces[k]) = if is_given[k] { (x[k], y[k]) } else { (y[k], x[k]) };
            }
            self.measured(&mut forces, -1.0);
            for refinement in 0..3 {
                let mut residual: Vec<f64> = (self.stiffness.chunks_exact(n.max(1)).zip(&forces))
                    .map(|(column, force)| force - dot(column, &w))
                    .collect();
                // In slender bodies elastic forces are small differences of large numbers.
                rounding = f64::EPSILON * self.stiffest * largest(&w);
                scale = largest(&load).max(largest(&forces));
                left = largest(&residual);
                if left <= RESIDUAL_ROUNDINGS * rounding || refinement == 2 {
                    break;
                }
                // With δF + rest = Ŝ δw: prescribed members stay, and the others follow.
                self.measured(&mut residual, 1.0);
                let pushed: Vec<f64> =
                    residual.iter().zip(&is_given).map(|(r, given)| if *given { 0.0 } else { *r }).collect();
                let change = self.product(&pushed);
                let mut force_change = vec![0.0; n];
                for k in 0..n {
                    if is_given[k] {
                        force_change[k] = change[k] - residual[k];
                    } else {
                        w[k] += change[k];
                    }
                }
                self.measured(&mut force_change, -1.0);
                forces.iter_mut().zip(&force_change).for_each(|(force, change)| *force += change);
            }
            if left <= (RENEWED * scale).max(n as f64 * rounding) || attempt == 1 || !self.renew(&self.statuses.clone())
            {
                break;
            }
        }
        self.write(&w, &load, &forces, answer);
        let singular = n as f64 * rounding > LOST * scale.max(self.stiffest * moved);
        let solved = left <= (UNSOLVED * scale).max(n as f64 * rounding) && !singular;
        Ok(solved && !self.table.is_empty() || n == 0)
    }

    fn statistics(&self) -> Statistics {
        self.statistics
    }

    fn snapshot(&self) -> Snapshot {
        Snapshot { statuses: self.statuses.clone(), table: self.table.clone(), statistics: self.statistics }
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Computed<bool> {
        let n = self.coordinates.order();
        let fits =
            [0, n * n].contains(&snapshot.table.len()) && (snapshot.table.is_empty() || !snapshot.statuses.is_empty());
        if fits {
            self.statuses.clone_from(&snapshot.statuses);
            self.table.clone_from(&snapshot.table);
            self.statistics = snapshot.statistics;
        }
        Ok(fits)
    }
}
