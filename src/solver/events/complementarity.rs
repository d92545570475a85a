//! The rate problem as a linear complementarity problem, for Lemke's method.
//!
//! The base is a set of statuses with linear equations: the nodes concerned are all free, or all clamped. Each way in
//! which a node may leave the base has one unknown `z ≥ 0` and one row `q + M z ≥ 0`. A free grazing node has the
//! unknowns `p_n`, `β⁺`, `β⁻` with `p_t = β⁺ - β⁻`, and its slip speed `λ` (Stewart and Trinkle, Int. J. Numer. Meth.
//! Engng 39, 1996),
//!
//! ```text
//! g' - w_n' ⟂ p_n,    λ ∓ v ⟂ β±,    μ p_n - β⁺ - β⁻ ⟂ λ,    v = w_t' less that of the obstacle,
//! ```
//!
//! This matrix is copositive, so that Lemke's method finds a solution. For a node that slips on the border of its
//! cone, the unknown is the amount by which friction falls below `μ p_n`, complementary to `± v`. If nothing but
//! contact holds the body, the base of free nodes is singular. In the other base the nodes are clamped, and leave it
//! by motions.
//!
//! # Lemke's method for a linear complementarity problem
//!
//! It finds `z ≥ 0` with `q + M z ≥ 0` and `zᵀ (q + M z) = 0`. An artificial variable is added to every row, large
//! enough that `z = 0` is feasible. Complementary pivots then remove it again (Cottle, Pang, Stone, The Linear
//! Complementarity Problem, 1992, section 4.4).

use super::node::{AdmissibleTransition, Given, NodalContact, NodeStatus};
use super::rate_problem::{RateProblem, RateSearch};
use crate::algebra::linear::Computed;

/// The kind of the unknowns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Unknowns {
    /// The forces of nodes that are free in the base.
    Forces,
    /// The motions of nodes that are clamped in the base.
    Motions,
}

/// A way in which a node may leave the base.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Way {
    /// A pressure, or a motion away from the obstacle.
    Normal,
    /// Friction, or a slip, in the direction of this sign.
    Tangential(f64),
    /// A slip against the friction of the node, which affects no other node.
    Slip,
}

impl Unknowns {
    /// Returns the status of a node in the base.
    fn base(self, may: AdmissibleTransition, has_friction: bool) -> NodeStatus {
        match (self, may) {
            (Unknowns::Forces, AdmissibleTransition::Turn(sign)) => NodeStatus::slip(sign),
            (Unknowns::Forces, _) => NodeStatus::Open,
            (Unknowns::Motions, _) if has_friction => NodeStatus::Stick,
            (Unknowns::Motions, _) => NodeStatus::Forward,
        }
    }

    /// Returns the ways in which a node may leave the base.
    fn ways(self, may: AdmissibleTransition, has_friction: bool) -> &'static [Way] {
        match (self, may) {
            (_, AdmissibleTransition::Turn(sign)) if sign < 0.0 => &[Way::Tangential(-1.0)],
            (_, AdmissibleTransition::Turn(_)) => &[Way::Tangential(1.0)],
            _ if !has_friction => &[Way::Normal],
            (Unknowns::Forces, _) => &[Way::Normal, Way::Tangential(1.0), Way::Tangential(-1.0), Way::Slip],
            (Unknowns::Motions, _) => &[Way::Normal, Way::Tangential(1.0), Way::Tangential(-1.0)],
        }
    }

    /// Returns the status of a node that leaves the base by the ways that are `is_basic`.
    fn status(self, may: AdmissibleTransition, has_friction: bool, is_basic: &[bool]) -> NodeStatus {
        match (self, may, is_basic) {
            (Unknowns::Forces, AdmissibleTransition::Turn(_), [true])
            | (Unknowns::Motions, AdmissibleTransition::Turn(_), [false]) => NodeStatus::Stick,
            (_, AdmissibleTransition::Turn(sign), _) => NodeStatus::slip(sign),
            (Unknowns::Forces, _, [false, ..]) | (Unknowns::Motions, _, [true, ..] | [_, true, true]) => {
                NodeStatus::Open
            }
            _ if !has_friction => NodeStatus::Forward,
            (Unknowns::Forces, _, [_, true, false, true]) | (Unknowns::Motions, _, [_, true, false]) => {
                NodeStatus::Forward
            }
            (Unknowns::Forces, _, [_, false, true, true]) | (Unknowns::Motions, _, [_, false, true]) => {
                NodeStatus::Backward
            }
            _ => NodeStatus::Stick,
        }
    }
}

impl RateSearch<'_> {
    /// Returns the statuses that Lemke's method finds for the nodes `concerned`, or `None` if the base is singular or
    /// the method ends on a ray.
    pub(super) fn by_lemke(
        &mut self,
        unknowns: Unknowns,
        statuses: &[NodeStatus],
        concerned: &[usize],
    ) -> Computed<Option<Vec<NodeStatus>>> {
        let problem = self.problem;
        let mut base = statuses.to_vec();
        for &i in concerned {
            base[i] = unknowns.base(problem.may[i], problem.has_friction[i]);
        }
        if !self.rates(&base)? {
            return Ok(None);
        }
        let ways = |i: usize| unknowns.ways(problem.may[i], problem.has_friction[i]);
        let rows = |given: &Given, rate: &NodalContact| -> Vec<f64> {
            let row = |&i: &usize| ways(i).iter().map(move |way| problem.row(unknowns, i, *way, given, rate));
            concerned.iter().flat_map(row).collect()
        };
        let mut q = rows(problem.given, self.rate);
        let n = q.len();
        let mut m = vec![0.0; n * n];
        let mut first = 0;
        for &i in concerned {
            for (k, way) in ways(i).iter().enumerate() {
                let column = first + k;
                if *way == Way::Slip {
                    (m[(first + 1) * n + column], m[(first + 2) * n + column]) = (1.0, 1.0);
                    continue;
                }
                let unit = problem.unit(unknowns, i, *way);
                self.effort.solves += 1;
                self.tangent.solve(&unit, self.rate)?;
                rows(&unit, self.rate).into_iter().enumerate().for_each(|(row, value)| m[row * n + column] = value);
                if ways(i).contains(&Way::Slip) {
                    m[(first + 3) * n + column] = if *way == Way::Normal { problem.mu[i] } else { -1.0 };
                }
            }
            first += ways(i).len();
        }
        // Scales lengths by the largest compliance, so that lengths and forces have the same order of magnitude.
        if unknowns == Unknowns::Forces {
            let largest = m.iter().fold(f64::MIN_POSITIVE, |m, value| m.max(value.abs()));
            problem.measure(concerned, largest, &mut q, &mut m);
        }
        let Some(basic) = lemke(&m, &q) else { return Ok(None) };
        let mut found = statuses.to_vec();
        let mut basic = &basic[..];
        for &i in concerned {
            let (basic_ways, others) = basic.split_at(ways(i).len());
            found[i] = unknowns.status(problem.may[i], problem.has_friction[i], basic_ways);
            basic = others;
        }
        Ok(Some(found))
    }
}

impl RateProblem<'_> {
    /// Divides lengths by `unit`.
    fn measure(&self, concerned: &[usize], unit: f64, q: &mut [f64], m: &mut [f64]) {
        let n = q.len();
        let ways = || concerned.iter().flat_map(|&i| Unknowns::Forces.ways(self.may[i], self.has_friction[i]));
        let is_slip: Vec<bool> = ways().map(|way| *way == Way::Slip).collect();
        for (row, values) in m.chunks_exact_mut(n).enumerate().filter(|(row, _)| !is_slip[*row]) {
            q[row] /= unit;
            values.iter_mut().zip(&is_slip).filter(|(_, slip)| !**slip).for_each(|(value, _)| *value /= unit);
        }
    }

    /// Returns the row value complementary to a `way` of node `i`, as far as it follows from the rates in the base.
    fn row(&self, unknowns: Unknowns, i: usize, way: Way, given: &Given, rate: &NodalContact) -> f64 {
        let slip = rate.w_t[i] - given.slide[i];
        let reserve = |sign: f64| self.mu[i] * rate.p_n[i] - sign * rate.p_t[i];
        match (unknowns, way, self.may[i]) {
            (Unknowns::Forces, Way::Normal, _) => given.gap[i] - rate.w_n[i],
            (Unknowns::Forces, Way::Tangential(sign), AdmissibleTransition::Turn(_)) => sign * slip,
            (Unknowns::Forces, Way::Tangential(sign), _) => -sign * slip,
            (Unknowns::Motions, Way::Normal, _) => rate.p_n[i],
            (Unknowns::Motions, Way::Tangential(sign), _) => reserve(sign),
            (_, Way::Slip, _) => 0.0,
        }
    }

    /// Returns the data for node `i` taking a `way` by one unit and no other change.
    fn unit(&self, unknowns: Unknowns, i: usize, way: Way) -> Given {
        let zeros = |values: &[f64]| vec![0.0; values.len()];
        let Given { force, gap, slide } = self.given;
        let mut unit = Given { force: zeros(force), gap: zeros(gap), slide: zeros(slide) };
        let maps = self.problem.tangential_maps();
        match (unknowns, way) {
            (Unknowns::Motions, Way::Normal) => unit.gap[i] = -1.0,
            (Unknowns::Motions, Way::Tangential(sign)) => unit.slide[i] = sign,
            (Unknowns::Forces, Way::Normal) => {
                self.problem.c_n().row(i).iter().for_each(|&(dof, c)| unit.force[dof] -= c);
            }
            (Unknowns::Forces, Way::Tangential(sign)) => {
                // The friction of a slipping node falls; that of a free node rises.
                let sign = if let AdmissibleTransition::Turn(_) = self.may[i] { -sign } else { sign };
                let row = self.tangents[i].map_or(&[][..], |k| maps[k].row(i));
                for &(dof, c) in row {
                    unit.force[dof] -= sign * c;
                }
            }
            (_, Way::Slip) => {}
        }
        unit
    }
}

/// A pivot below this share of the largest entry of its column counts as rounding.
const PIVOT: f64 = 1e-11;

/// The perturbation of the rows, relative to the largest entry of `q`.
const APART: f64 = 1e-9;

/// The number of pivots for each variable after which the method is assumed to cycle.
const PATIENCE: usize = 50;

/// Returns which of the `n` variables `z` are basic at a solution; the slacks of the others are basic. Returns `None`
/// if the method ends on a ray. `m` is stored row by row.
pub(super) fn lemke(m: &[f64], q: &[f64]) -> Option<Vec<bool>> {
    let n = q.len();
    if q.iter().all(|q| *q >= 0.0) {
        return Some(vec![false; n]);
    }
    // The perturbation prevents two rows from reaching 0 at once, so that no basis repeats. Multiples of the golden
    // section modulo 1 are all different.
    let size = q.iter().fold(0.0_f64, |m, q| m.max(q.abs()));
    let apart = |i: usize| APART * size * (1.0 + (i as f64 * 0.618_033_988_749_895).fract());
    // w - M z - e z0 = q; variables 0..n are w, n..2n are z, 2n is z0, and the last column is the right-hand side.
    let width = 2 * n + 2;
    let (artificial, right) = (2 * n, 2 * n + 1);
    let mut table = vec![0.0; n * width];
    for (i, row) in table.chunks_exact_mut(width).enumerate() {
        row[i] = 1.0;
        row[n..2 * n].iter_mut().zip(&m[i * n..]).for_each(|(to, m)| *to = -m);
        row[artificial] = -1.0;
        row[right] = q[i] + apart(i);
    }
    let mut basis: Vec<usize> = (0..n).collect();
    let first = (0..n).min_by(|&a, &b| q[a].total_cmp(&q[b]))?;
    let (mut row, mut entering) = (first, artificial);
    for _ in 0..PATIENCE * (n + 1) {
        pivot(&mut table, width, row, entering);
        let leaving = std::mem::replace(&mut basis[row], entering);
        if leaving == artificial {
            return Some((0..n).map(|k| basis.contains(&(n + k))).collect());
        }
        entering = if leaving < n { leaving + n } else { leaving - n };
        row = ratio_test(&table, width, entering, &basis, artificial)?;
    }
    None
}

/// Returns the row whose basic variable `entering` drives to 0 first. The artificial variable wins ties.
fn ratio_test(table: &[f64], width: usize, entering: usize, basis: &[usize], artificial: usize) -> Option<usize> {
    let rows = || table.chunks_exact(width);
    let largest = rows().fold(0.0_f64, |m, row| m.max(row[entering].abs()));
    let ratio = |row: &[f64]| (row[entering] > PIVOT * largest).then(|| row[width - 1].max(0.0) / row[entering]);
    let least = rows().filter_map(ratio).min_by(f64::total_cmp)?;
    let ties = rows().enumerate().filter(|(_, row)| ratio(row).is_some_and(|ratio| ratio <= least * (1.0 + PIVOT)));
    ties.max_by(|(i, a), (k, b)| {
        let rank = |i: &usize| basis[*i] == artificial;
        rank(i).cmp(&rank(k)).then(a[entering].total_cmp(&b[entering]))
    })
    .map(|(row, _)| row)
}

/// Turns `column` into the unit vector with its 1 in `row`.
fn pivot(table: &mut [f64], width: usize, row: usize, column: usize) {
    let scale = 1.0 / table[row * width + column];
    let pivotal: Vec<f64> = table[row * width..][..width].iter().map(|value| value * scale).collect();
    for (i, other) in table.chunks_exact_mut(width).enumerate() {
        let factor = other[column];
        if i == row {
            other.copy_from_slice(&pivotal);
        } else if factor != 0.0 {
            other.iter_mut().zip(&pivotal).for_each(|(value, pivotal)| *value -= factor * pivotal);
            other[column] = 0.0;
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::algebra::linear::RefinedSolver;
    use crate::algebra::sparse::{Csr, Symmetric};
    use crate::base::units::Scaling;
    use crate::solver::events::rate_problem::Effort;
    use crate::solver::events::tangent::SparseTangent;
    use crate::solver::problem::{ContactProblem, Parts};

    const NODES: usize = 12;

    /// Creates nodes on random springs in front of a plane that all nodes touch.
    fn problem(random: &mut impl FnMut() -> f64) -> ContactProblem {
        let n = 2 * NODES;
        let a: Vec<f64> = (0..n * n).map(|_| random()).collect();
        let entry = |i: usize, j: usize| {
            (0..n).map(|k| a[i * n + k] * a[j * n + k]).sum::<f64>() + if i == j { 1e-3 } else { 0.0 }
        };
        let lower: Vec<_> =
            (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|(i, j)| (i, j, entry(i, j))).collect();
        let rows = |k: usize| Csr::from_rows(n, (0..NODES).map(|i| [(2 * i + k, 1.0)])).unwrap();
        let mu = (0..NODES).map(|_| 0.75 + 0.75 * random()).collect();
        let stiffness = Symmetric::from_triplets(n, &lower).unwrap();
        ContactProblem::new(Parts { c_t: rows(0), mu, ..Parts::new(stiffness, rows(1)) }).unwrap()
    }

    /// If all nodes graze, the matrix is copositive, and rates exist for any load and any friction.
    #[test]
    fn of_nodes_that_graze_forces_find_rates_for_any_load() {
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        for sample in 0..40 {
            let problem = problem(&mut random);
            let given = Given {
                force: (0..2 * NODES).map(|_| random()).collect(),
                gap: (0..NODES).map(|_| 0.1 * random()).collect(),
                slide: vec![0.0; NODES],
            };
            let rate_problem = RateProblem {
                problem: &problem,
                tangents: &[Some(0); NODES],
                given: &given,
                mu: problem.mu(),
                has_friction: &[true; NODES],
                may: &[AdmissibleTransition::Anything; NODES],
            };
            let mut linear = RefinedSolver::default();
            let mut tangent = SparseTangent::new(&problem, vec![Some(0); NODES], Scaling::SI, &mut linear).unwrap();
            let (mut rate, mut effort) = (NodalContact::zero(NODES), Effort::default());
            let concerned: Vec<usize> = (0..NODES).collect();
            let open = [NodeStatus::Open; NODES];
            let (problem, tangent) = (rate_problem, &mut tangent);
            let mut search = RateSearch { problem, tangent, rate: &mut rate, effort: &mut effort, best: None };
            let found = search.by_lemke(Unknowns::Forces, &open, &concerned).unwrap().unwrap();
            let breach = search.try_out(&found).unwrap();
            assert!(breach.is_some_and(|size| size <= 1e-12), "{sample}: {breach:?} {found:?}");
        }
    }

    /// Returns `true` if `z` of this basis, solved from the rows of its variables, is a solution.
    fn holds(m: &[f64], q: &[f64], basic: &[bool]) -> bool {
        // Gauss–Seidel sweeps solve the small diagonally dominant systems of these tests.
        let n = q.len();
        let mut z = vec![0.0; n];
        for _ in 0..500 {
            for i in (0..n).filter(|&i| basic[i]) {
                let rest: f64 = (0..n).filter(|&j| j != i).map(|j| m[i * n + j] * z[j]).sum();
                z[i] = -(q[i] + rest) / m[i * n + i];
            }
        }
        let slack = |i: usize| q[i] + (0..n).map(|j| m[i * n + j] * z[j]).sum::<f64>();
        (0..n).all(|i| z[i] >= -1e-12 && slack(i) >= -1e-12)
    }

    #[test]
    fn complementary_solutions_are_found() {
        let m = [4.0, 1.0, -1.0, 1.0, 5.0, 2.0, -1.0, 2.0, 6.0];
        for q in [[1.0, 2.0, 3.0], [-1.0, 2.0, 3.0], [-1.0, -2.0, 0.5], [-3.0, -1.0, -2.0], [0.0, -1.0, 0.0]] {
            let basic = lemke(&m, &q).unwrap();
            assert!(holds(&m, &q, &basic), "{q:?}: {basic:?}");
        }
        // An unsymmetric matrix.
        let m = [3.0, -2.0, 2.0, 3.0];
        for q in [[-1.0, -1.0], [1.0, -2.0], [-2.0, 1.0]] {
            assert!(holds(&m, &q, &lemke(&m, &q).unwrap()), "{q:?}");
        }
    }

    #[test]
    fn where_there_is_none_it_ends() {
        assert_eq!(lemke(&[0.0], &[-1.0]), None);
        assert_eq!(lemke(&[-1.0], &[-1.0]), None);
        assert_eq!(lemke(&[0.0, 0.0, 0.0, 1.0], &[-1.0, -1.0]), None);
        // There are two solutions; either is correct.
        assert!(lemke(&[-1.0], &[1.0]).is_some());
    }
}
