//! The equations of the statuses solved for all data at once, on a dense stiffness: a dictionary, as linear programming calls it.
//!
//! In contact coordinates `F = Ŝ w`, with `F = f̂ - p`. Of each coordinate's pair `(w_k, F_k)` the law gives one and leaves one: a
//! closed node's `w_n` is given, a sticking one's `w_t`, an open one's `F`, which is `f̂`; where a node slips, `p_t = ± μ p_n` gives
//! `F_t ∓ μ F_n`. The dictionary `y = D x` has what the law gives in `x` and the rest in `y`. When one pair changes sides it
//! changes by a matrix of rank one,
//!
//! ```text
//! D_ij ← D_ij - D_ik D_kj / D_kk,   D_kj ← -D_kj / D_kk,   D_ik ← D_ik / D_kk,   D_kk ← 1 / D_kk,
//! ```
//!
//! and so does it when a force is measured from another border of the cone. Rounding adds up, so each solution is compared with
//! `Ŝ`, and the dictionary made anew where that says so.

use faer::Mat;
use faer::linalg::solvers::DenseSolveCore;

use super::coordinates::Coordinates;
use super::node::{Given, NodalContact, NodeStatus, largest};
use super::tangent::{Taken, Tangent};
use crate::algebra::linear::{LinearError, RefinedSolver, Statistics};
use crate::algebra::vector::dot;
use crate::base::units::Scaling;
use crate::solver::problem::ContactProblem;

/// A pivot smaller than this share of what a stiffness or compliance is there is rounding.
const SINGULAR: f64 = 1e-12;

/// Roundings of the largest elastic force of a single coordinate that a solution may leave out of balance before it is refined.
const ROUNDINGS: f64 = 4.0;

/// Where the rounding of elastic forces is a larger share of the forces, the system is singular but for rounding.
const LOST: f64 = 1e-3;

/// The share of the largest force with which it may be out of balance before the dictionary is made anew.
const RENEWED: f64 = 1e-12;

/// The share with which a solution is no solution: that of a system that is singular but for rounding.
const UNSOLVED: f64 = 1e-9;

/// To make it anew is cheaper than to change more than this share of the statuses one by one.
const MANY: f64 = 0.25;

pub(super) struct Dictionary {
    mu: Vec<f64>,
    coordinates: Coordinates,
    /// `Ŝ`, column after column: it is symmetric.
    stiffness: Vec<f64>,
    /// The largest entry of `Ŝ`, which is on its diagonal.
    stiffest: f64,
    /// `D`, column after column; empty before the first statuses are taken, and where they are singular.
    table: Vec<f64>,
    statuses: Vec<NodeStatus>,
    /// To make `D` anew counts as a factorisation.
    statistics: Statistics,
}

impl Dictionary {
    /// That of a problem with a dense stiffness, whose nodes slide along these `tangents`; `None` where contact rows depend on each
    /// other.
    pub(super) fn new(problem: &ContactProblem, tangents: &[Option<usize>], scaling: Scaling) -> Option<Self> {
        let coordinates = Coordinates::new(problem, tangents)?;
        let n = coordinates.order();
        let mut entries = vec![0.0; n * n];
        for (i, j, value) in problem.stiffness().entries() {
            entries[j * n + i] = value / scaling.stiffness();
        }
        let stiffness = coordinates.stiffness(|i, j| entries[j * n + i]);
        Some(Dictionary {
            mu: problem.mu().to_vec(),
            coordinates,
            stiffest: (0..n).fold(0.0_f64, |m, k| m.max(stiffness[k * (n + 1)])),
            stiffness,
            table: Vec::new(),
            statuses: Vec::new(),
            statistics: Statistics::default(),
        })
    }

    /// Whether the law gives the displacement of each coordinate, rather than its force.
    fn given_displacements(&self, statuses: &[NodeStatus]) -> Vec<bool> {
        let mut given = vec![false; self.coordinates.order()];
        for (i, status) in statuses.iter().enumerate() {
            given[self.coordinates.normal[i]] = status.is_closed();
            if let Some(t) = self.coordinates.tangential[i] {
                given[t] = status.is_held();
            }
        }
        given
    }

    /// `± μ` of each slipping node, with its coordinates.
    fn sliders<'s>(&'s self, statuses: &'s [NodeStatus]) -> impl Iterator<Item = (usize, usize, f64)> + 's {
        statuses.iter().enumerate().filter_map(|(i, status)| {
            let t = self.coordinates.tangential[i].filter(|_| status.sign() != 0.0)?;
            Some((self.coordinates.normal[i], t, status.sign() * self.mu[i]))
        })
    }

    /// Makes the dictionary of these statuses from `Ŝ`; tells whether there is one.
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
        let (free, held): (Vec<usize>, Vec<usize>) = (0..n).partition(|&k| !given[k]);
        let block = |rows: &[usize], columns: &[usize]| {
            Mat::from_fn(rows.len(), columns.len(), |i, j| forces[columns[j] * n + rows[i]])
        };
        let lu = block(&free, &free).partial_piv_lu();
        if (0..free.len()).any(|k| self.vanishes(lu.U()[(k, k)], free[k])) {
            return false;
        }
        let compliance = lu.inverse();
        let (coupling, back) = (block(&free, &held), block(&held, &free));
        let moved = &compliance * &coupling;
        let carried = &back * &compliance;
        let condensed = block(&held, &held) - &back * &moved;
        let mut table = vec![0.0; n * n];
        let mut write = |rows: &[usize], columns: &[usize], sign: f64, values: &Mat<f64>| {
            for (j, &column) in columns.iter().enumerate() {
                for (i, &row) in rows.iter().enumerate() {
                    table[column * n + row] = sign * values[(i, j)];
                }
            }
        };
        write(&free, &free, 1.0, &compliance);
        write(&free, &held, -1.0, &moved);
        write(&held, &free, 1.0, &carried);
        write(&held, &held, 1.0, &condensed);
        let finite = table.iter().all(|value| value.is_finite());
        if finite {
            self.table = table;
        }
        finite
    }

    /// Whether a pivot of coordinate `k`, a stiffness, is none: rounding of what stands there, or of the whole matrix.
    fn vanishes(&self, pivot: f64, k: usize) -> bool {
        let n = self.coordinates.order();
        let rounding = n as f64 * f64::EPSILON * self.stiffest;
        pivot.is_nan() || pivot.abs() <= (SINGULAR * self.stiffness[k * (n + 1)]).max(rounding)
    }

    /// Lets the pair `k` change sides; tells whether it can.
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

    /// Brings one node from one status to another; tells whether that can be done pair by pair.
    fn change(&mut self, i: usize, to: NodeStatus) -> bool {
        let n = self.coordinates.order();
        let (normal, tangential) = (self.coordinates.normal[i], self.coordinates.tangential[i]);
        let from = std::mem::replace(&mut self.statuses[i], to);
        let Some(t) = tangential else {
            return from.is_closed() == to.is_closed() || self.pivot(normal, !to.is_closed());
        };
        // To a closed node that sticks, or to an open one, whose force is measured from 0; then on from there.
        let drive = |status: NodeStatus| status.sign() * self.mu[i];
        let (left, taken) = (drive(from), drive(to));
        if from == NodeStatus::Open && to.is_closed() {
            // F_t = (F_t - d F_n) + d F_n, both given.
            self.add_column(t, normal, taken);
            return self.pivot(normal, false) && (to.sign() != 0.0 || self.pivot(t, false));
        }
        if to == NodeStatus::Open {
            if from == NodeStatus::Stick && !self.pivot(t, true) {
                return false;
            }
            if !self.pivot(normal, true) {
                return false;
            }
            self.add_column(t, normal, -left);
            return true;
        }
        if from.sign() != 0.0 {
            if !self.pivot(t, false) {
                return false;
            }
            self.add_row(n, normal, t, left);
        }
        if to.sign() != 0.0 {
            self.add_row(n, normal, t, -taken);
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

    /// `D x`.
    fn product(&self, x: &[f64]) -> Vec<f64> {
        let n = x.len();
        let mut y = vec![0.0; n];
        for (x, column) in x.iter().zip(self.table.chunks_exact(n.max(1))).filter(|(x, _)| **x != 0.0) {
            y.iter_mut().zip(column).for_each(|(y, d)| *y += x * d);
        }
        y
    }

    /// Forces `F`, those of slipping nodes measured from the border of the cone, or back.
    fn measured(&self, forces: &mut [f64], way: f64) {
        for (normal, tangential, drive) in self.sliders(&self.statuses) {
            forces[tangential] -= way * drive * forces[normal];
        }
    }
}

impl Tangent for Dictionary {
    fn take(&mut self, statuses: &[NodeStatus]) -> Result<bool, LinearError> {
        let changed: Vec<usize> = if self.table.is_empty() {
            (0..statuses.len()).collect()
        } else {
            (0..statuses.len()).filter(|&i| statuses[i] != self.statuses[i]).collect()
        };
        let few = changed.len() as f64 <= MANY * statuses.len() as f64;
        // Statuses on the way may be singular where those at its end are not.
        if !self.table.is_empty() && few && changed.iter().all(|&i| self.change(i, statuses[i])) {
            return Ok(true);
        }
        Ok(self.renew(statuses))
    }

    fn solve(&mut self, given: &Given, answer: &mut NodalContact) -> Result<bool, LinearError> {
        if self.table.is_empty() && self.coordinates.order() > 0 {
            return Ok(false);
        }
        self.statistics.solves += 1;
        let load = self.coordinates.forces(&given.force);
        let is_given = self.given_displacements(&self.statuses);
        let n = load.len();
        let mut x = load.clone();
        self.measured(&mut x, 1.0);
        for (i, status) in self.statuses.iter().enumerate() {
            if status.is_closed() {
                x[self.coordinates.normal[i]] = given.gap[i];
            }
            if let (true, Some(t)) = (status.is_held(), self.coordinates.tangential[i]) {
                x[t] = given.slide[i];
            }
        }
        // Displacements that are given bring such forces, unless the body goes along as a whole.
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
                let mut rest: Vec<f64> = (self.stiffness.chunks_exact(n.max(1)).zip(&forces))
                    .map(|(column, force)| force - dot(column, &w))
                    .collect();
                // In slender bodies elastic forces are small differences of large ones.
                rounding = f64::EPSILON * self.stiffest * largest(&w);
                scale = largest(&load).max(largest(&forces));
                left = largest(&rest);
                if left <= ROUNDINGS * rounding || refinement == 2 {
                    break;
                }
                // With δF + rest = Ŝ δw: what is given stays, and the rest follows.
                self.measured(&mut rest, 1.0);
                let pushed: Vec<f64> =
                    rest.iter().zip(&is_given).map(|(r, given)| if *given { 0.0 } else { *r }).collect();
                let change = self.product(&pushed);
                let mut force_change = vec![0.0; n];
                for k in 0..n {
                    if is_given[k] {
                        force_change[k] = change[k] - rest[k];
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
        answer.u = self.coordinates.displacements(&w);
        answer.u_rest.clear();
        let singular = n as f64 * rounding > LOST * scale.max(self.stiffest * moved);
        let solved = left <= (UNSOLVED * scale).max(n as f64 * rounding) && !singular;
        Ok(solved && !self.table.is_empty() || n == 0)
    }

    fn statistics(&self) -> Statistics {
        self.statistics
    }

    fn taken(&self) -> Taken {
        Taken { statuses: self.statuses.clone(), table: self.table.clone(), statistics: self.statistics }
    }

    fn take_up(&mut self, taken: &Taken) -> Result<bool, LinearError> {
        let n = self.coordinates.order();
        let fits = [0, n * n].contains(&taken.table.len()) && (taken.table.is_empty() || !taken.statuses.is_empty());
        if fits {
            self.statuses.clone_from(&taken.statuses);
            self.table.clone_from(&taken.table);
            self.statistics = taken.statistics;
        }
        Ok(fits)
    }

    fn lend(&mut self) -> Option<&mut RefinedSolver> {
        None
    }
}
