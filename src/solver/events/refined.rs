//! Solutions in twice the working precision, for cases where rounding of elastic forces would decide between
//! statuses.
//!
//! In slender bodies elastic forces are small differences of large numbers. If a body slides as a whole, the rates of
//! all forces are nothing but rounding. The residual of a solution is then computed in twice the precision, and the
//! same equations give the correction.

use super::node::{Given, NodalContact, NodeStatus, largest};
use super::tangent::{Taken, Tangent};
use crate::algebra::linear::{LinearError, RefinedSolver, Statistics};
use crate::base::units::Scaling;
use crate::solver::problem::{ContactProblem, State};

/// The largest share of rounding of elastic forces in the largest force without refinement.
const ELASTIC_ROUNDING: f64 = 1e-12;

/// The number of refinements. Each gains as many digits as are correct in a solution.
const REFINEMENTS: usize = 3;

/// Equations whose solutions are refined.
pub(super) struct Refined<'a> {
    problem: &'a ContactProblem,
    tangents: Vec<Option<usize>>,
    scaling: Scaling,
    equations: Box<dyn Tangent + 'a>,
    statuses: Vec<NodeStatus>,
}

impl<'a> Refined<'a> {
    /// Refines the solutions of the `equations` of `problem`, whose nodes slide along these `tangents`.
    pub(super) fn new(
        problem: &'a ContactProblem,
        tangents: Vec<Option<usize>>,
        scaling: Scaling,
        equations: Box<dyn Tangent + 'a>,
    ) -> Self {
        Refined { problem, tangents, scaling, equations, statuses: Vec::new() }
    }

    /// Expands values along each node's tangent to values along both tangents.
    pub(super) fn along_both(&self, values: &[f64]) -> [Vec<f64>; 2] {
        [0, 1].map(|k| {
            let of = |(value, tangent): (&f64, &Option<usize>)| if *tangent == Some(k) { *value } else { 0.0 };
            values.iter().zip(&self.tangents).map(of).collect()
        })
    }

    /// Converts a solution to SI units.
    pub(super) fn state(&self, of: &NodalContact) -> State {
        let Scaling { force, length } = self.scaling;
        let [p_t, p_o] = self.along_both(&of.p_t.iter().map(|p| p * force).collect::<Vec<_>>());
        State {
            u: of.u.iter().map(|u| u * length).collect(),
            u_rest: of.u_rest.iter().map(|rest| rest * length).collect(),
            p_t,
            p_o,
            p_n: of.p_n.iter().map(|p| p * force).collect(),
        }
    }

    /// Returns the residual of a solution for the `given` data.
    fn left(&self, given: &Given, of: &NodalContact) -> Result<Given, LinearError> {
        let Scaling { force, length } = self.scaling;
        let state = self.state(of);
        let load: Vec<f64> = given.force.iter().map(|f| f * force).collect();
        let imbalance = self.problem.imbalance(&load, &state)?;
        let maps = self.problem.tangential_maps();
        let mut left = Given {
            force: imbalance.into_iter().map(|r| -r / force).collect(),
            gap: vec![0.0; given.gap.len()],
            slide: vec![0.0; given.slide.len()],
        };
        for (i, status) in self.statuses.iter().enumerate() {
            if status.is_closed() {
                left.gap[i] =
                    -self.problem.c_n().difference(i, &state.u, &state.u_rest, given.gap[i] * length) / length;
            }
            if let (true, Some(k)) = (status.is_held(), self.tangents[i]) {
                left.slide[i] = -maps[k].difference(i, &state.u, &state.u_rest, given.slide[i] * length) / length;
            }
        }
        Ok(left)
    }
}

impl Tangent for Refined<'_> {
    fn take(&mut self, statuses: &[NodeStatus]) -> Result<bool, LinearError> {
        self.statuses = statuses.to_vec();
        self.equations.take(statuses)
    }

    fn solve(&mut self, given: &Given, answer: &mut NodalContact) -> Result<bool, LinearError> {
        if !self.equations.solve(given, answer)? {
            return Ok(false);
        }
        answer.rounding = f64::EPSILON * largest(&answer.u) * self.problem.stiffest() / self.scaling.stiffness();
        if answer.rounding <= ELASTIC_ROUNDING * answer.largest_force().max(largest(&given.force)) {
            return Ok(true);
        }
        answer.u_rest = vec![0.0; answer.u.len()];
        let mut before = f64::INFINITY;
        for _ in 0..REFINEMENTS {
            let left = self.left(given, answer)?;
            let violation = largest(&left.force);
            if violation >= 0.5 * before {
                break;
            }
            before = violation;
            let mut change = NodalContact::zero(self.statuses.len());
            if !self.equations.solve(&left, &mut change)? {
                break;
            }
            answer.add(1.0, &change);
            if violation <= f64::EPSILON * answer.rounding {
                break;
            }
        }
        Ok(true)
    }

    fn statistics(&self) -> Statistics {
        self.equations.statistics()
    }

    fn taken(&self) -> Taken {
        Taken { statuses: self.statuses.clone(), ..self.equations.taken() }
    }

    fn take_up(&mut self, taken: &Taken) -> Result<bool, LinearError> {
        self.statuses.clone_from(&taken.statuses);
        self.equations.take_up(taken)
    }

    fn lend(&mut self) -> Option<&mut RefinedSolver> {
        self.equations.lend()
    }
}
