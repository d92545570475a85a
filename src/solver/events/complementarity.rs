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

use super::lemke::lemke;
use super::node::{AdmissibleTransition, Given, NodalContact, NodeStatus};
use super::rate_problem::{Effort, RateProblem};
use super::tangent::Tangent;
use crate::algebra::linear::LinearError;

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
    fn base(self, may: AdmissibleTransition, is_rough: bool) -> NodeStatus {
        match (self, may) {
            (Unknowns::Forces, AdmissibleTransition::Turn(sign)) => NodeStatus::slip(sign),
            (Unknowns::Forces, _) => NodeStatus::Open,
            (Unknowns::Motions, _) if is_rough => NodeStatus::Stick,
            (Unknowns::Motions, _) => NodeStatus::Forward,
        }
    }

    /// Returns the ways in which a node may leave the base.
    fn ways(self, may: AdmissibleTransition, is_rough: bool) -> &'static [Way] {
        match (self, may) {
            (_, AdmissibleTransition::Turn(sign)) if sign < 0.0 => &[Way::Tangential(-1.0)],
            (_, AdmissibleTransition::Turn(_)) => &[Way::Tangential(1.0)],
            _ if !is_rough => &[Way::Normal],
            (Unknowns::Forces, _) => &[Way::Normal, Way::Tangential(1.0), Way::Tangential(-1.0), Way::Slip],
            (Unknowns::Motions, _) => &[Way::Normal, Way::Tangential(1.0), Way::Tangential(-1.0)],
        }
    }

    /// Returns the status of a node that leaves the base by the `taken` ways.
    fn status(self, may: AdmissibleTransition, is_rough: bool, taken: &[bool]) -> NodeStatus {
        match (self, may, taken) {
            (Unknowns::Forces, AdmissibleTransition::Turn(_), [true])
            | (Unknowns::Motions, AdmissibleTransition::Turn(_), [false]) => NodeStatus::Stick,
            (_, AdmissibleTransition::Turn(sign), _) => NodeStatus::slip(sign),
            (Unknowns::Forces, _, [false, ..]) | (Unknowns::Motions, _, [true, ..] | [_, true, true]) => {
                NodeStatus::Open
            }
            _ if !is_rough => NodeStatus::Forward,
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

impl RateProblem<'_> {
    /// Returns the statuses that Lemke's method finds for the nodes `concerned`, or `None` if the base is singular or
    /// the method ends on a ray.
    pub(super) fn by_lemke(
        &self,
        unknowns: Unknowns,
        tangent: &mut dyn Tangent,
        statuses: &[NodeStatus],
        concerned: &[usize],
        rate: &mut NodalContact,
        effort: &mut Effort,
    ) -> Result<Option<Vec<NodeStatus>>, LinearError> {
        let mut base = statuses.to_vec();
        for &i in concerned {
            base[i] = unknowns.base(self.may[i], self.rough[i]);
        }
        effort.solves += 1;
        if !(tangent.take(&base)? && tangent.solve(self.given, rate)?) {
            return Ok(None);
        }
        let ways = |i: usize| unknowns.ways(self.may[i], self.rough[i]);
        let rows = |given: &Given, rate: &NodalContact| -> Vec<f64> {
            let row = |&i: &usize| ways(i).iter().map(move |way| self.row(unknowns, i, *way, given, rate));
            concerned.iter().flat_map(row).collect()
        };
        let mut q = rows(self.given, rate);
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
                let unit = self.unit(unknowns, i, *way);
                effort.solves += 1;
                tangent.solve(&unit, rate)?;
                rows(&unit, rate).into_iter().enumerate().for_each(|(row, value)| m[row * n + column] = value);
                if ways(i).contains(&Way::Slip) {
                    m[(first + 3) * n + column] = if *way == Way::Normal { self.mu[i] } else { -1.0 };
                }
            }
            first += ways(i).len();
        }
        // Scales lengths by the largest compliance, so that lengths and forces have the same order of magnitude.
        if unknowns == Unknowns::Forces {
            let largest = m.iter().fold(f64::MIN_POSITIVE, |m, value| m.max(value.abs()));
            self.measure(concerned, largest, &mut q, &mut m);
        }
        let Some(basic) = lemke(&m, &q) else { return Ok(None) };
        let mut found = statuses.to_vec();
        let mut basic = &basic[..];
        for &i in concerned {
            let (taken, others) = basic.split_at(ways(i).len());
            found[i] = unknowns.status(self.may[i], self.rough[i], taken);
            basic = others;
        }
        Ok(Some(found))
    }

    /// Divides lengths by `unit`.
    fn measure(&self, concerned: &[usize], unit: f64, q: &mut [f64], m: &mut [f64]) {
        let n = q.len();
        let ways = || concerned.iter().flat_map(|&i| Unknowns::Forces.ways(self.may[i], self.rough[i]));
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::algebra::linear::RefinedSolver;
    use crate::algebra::sparse::{Csr, Symmetric};
    use crate::base::units::Scaling;
    use crate::solver::events::sparse::SparseTangent;
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
                rough: &[true; NODES],
                may: &[AdmissibleTransition::Anything; NODES],
            };
            let mut linear = RefinedSolver::default();
            let mut tangent = SparseTangent::new(&problem, vec![Some(0); NODES], Scaling::SI, &mut linear).unwrap();
            let (mut rate, mut effort) = (NodalContact::zero(NODES), Effort::default());
            let concerned: Vec<usize> = (0..NODES).collect();
            let open = [NodeStatus::Open; NODES];
            let found = rate_problem
                .by_lemke(Unknowns::Forces, &mut tangent, &open, &concerned, &mut rate, &mut effort)
                .unwrap()
                .unwrap();
            let breach = rate_problem.try_out(&mut tangent, &found, &mut rate, &mut effort).unwrap();
            assert!(breach.is_some_and(|size| size <= 1e-12), "{sample}: {breach:?} {found:?}");
        }
    }
}
