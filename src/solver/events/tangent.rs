//! The linear equations of the contact nodes while no status changes, as a sparse system: one factorisation for each set of
//! statuses, on one pattern.
//!
//! # Solutions in twice the working precision
//!
//! They serve where rounding of elastic forces would decide between statuses.
//!
//! In slender bodies elastic forces are small differences of large numbers. If a body slides as a whole, the rates of
//! all forces are nothing but rounding. The residual of a solution is then computed in twice the precision, and the
//! same equations give the correction.

use super::node::{Given, NodalContact, NodeStatus, largest};
use crate::algebra::linear::{Computed, LinearError, RefinedSolver, Statistics};
use crate::base::units::Scaling;
use crate::solver::formulation::{Bdiff, FormulationScaling};
use crate::solver::laws::coulomb::{NormalCase, TangentialCase};
use crate::solver::problem::{ContactProblem, State};
use serde::{Deserialize, Serialize};

/// A snapshot of the equations.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Snapshot {
    /// The statuses; empty before the first are set.
    pub statuses: Vec<NodeStatus>,
    /// The dictionary, if the equations depend on all earlier statuses.
    pub table: Vec<f64>,
    /// The statistics up to the snapshot.
    pub statistics: Statistics,
}

/// The equations for given statuses, in which the contact law is linear in displacements and forces, and in their
/// rates:
///
/// ```text
/// K u + C_nᵀ p_n + C_tᵀ p_t = f
/// open:   p_n = 0,    p_t = 0
/// closed: w_n = g,    stick: w_t = slide,    slip: p_t = ± μ p_n
/// ```
pub(super) trait Tangent {
    /// Sets the status of each contact node. Returns `true` if the equations are then regular.
    ///
    /// # Errors
    /// If the linear solver fails.
    fn set_statuses(&mut self, statuses: &[NodeStatus]) -> Computed<bool>;

    /// Solves the equations for the current statuses and writes the solution to `answer`. Returns `true` if it
    /// satisfies them.
    ///
    /// # Errors
    /// If the linear solver fails.
    fn solve(&mut self, given: &Given, answer: &mut NodalContact) -> Computed<bool>;

    /// Returns the statistics of the linear solver.
    fn statistics(&self) -> Statistics;

    /// Returns a snapshot of the equations.
    fn snapshot(&self) -> Snapshot;

    /// Restores the equations from a snapshot. Returns `false` if the snapshot belongs to another problem.
    ///
    /// # Errors
    /// If the linear solver fails.
    fn restore(&mut self, snapshot: &Snapshot) -> Computed<bool>;
}

/// A solution counts as that of a singular system if its rows are violated by more than this share of their largest
/// term.
const UNSOLVED: f64 = 1e-9;

/// The linearisation (21) of the whole problem. For given cases it is also that of the rates.
pub(super) struct SparseTangent<'a> {
    problem: &'a ContactProblem,
    tangents: Vec<Option<usize>>,
    linear: &'a mut RefinedSolver,
    rows: Bdiff,
    /// Scaled `r` of the rows of closed and of sticking nodes.
    r_n: Vec<f64>,
    r_t: Vec<f64>,
    /// `true` if `linear` has factors.
    regular: bool,
    rhs: Vec<f64>,
    z: Vec<f64>,
}

impl<'a> SparseTangent<'a> {
    /// Analyses the pattern.
    ///
    /// # Errors
    /// [`LinearError::Singular`] if the body is unconstrained even with clamped contact nodes.
    pub(super) fn new(
        problem: &'a ContactProblem,
        tangents: Vec<Option<usize>>,
        scaling: Scaling,
        linear: &'a mut RefinedSolver,
    ) -> Computed<Self> {
        let conventions = FormulationScaling::natural(problem);
        let mut rows = Bdiff::new(problem, scaling, &conventions);
        rows.clamp_contacts();
        if rows.unconstrained_mode().is_some() {
            return Err(LinearError::Singular { pivot_ratio: 0.0 });
        }
        linear.analyze(rows.jacobian())?;
        let scaled = |r: &[f64]| r.iter().map(|r| r / scaling.stiffness()).collect();
        let (r_n, r_t) = (scaled(&conventions.r_n), scaled(&conventions.r_t));
        let zeros = || vec![0.0; rows.unknowns()];
        Ok(SparseTangent { problem, tangents, linear, r_n, r_t, regular: false, rhs: zeros(), z: zeros(), rows })
    }
}

impl Tangent for SparseTangent<'_> {
    fn set_statuses(&mut self, statuses: &[NodeStatus]) -> Computed<bool> {
        let tangents = &self.tangents;
        self.rows.set_cases(statuses.iter().enumerate().map(|(i, status)| {
            let normal = if status.is_closed() { NormalCase::Closed } else { NormalCase::Open };
            let tangential = match status {
                NodeStatus::Open => TangentialCase::NoPressure,
                NodeStatus::Stick => TangentialCase::Stick,
                NodeStatus::Forward | NodeStatus::Backward => {
                    let mut direction = [0.0; 2];
                    if let Some(k) = tangents[i] {
                        direction[k] = status.sign();
                    }
                    TangentialCase::Slip { direction, turning: [[0.0; 2]; 2] }
                }
            };
            (normal, tangential)
        }));
        self.regular = false;
        if self.rows.unconstrained_mode().is_some() {
            return Ok(false);
        }
        match self.linear.factorize(self.rows.jacobian()) {
            Ok(_) => self.regular = self.linear.reciprocal_condition(self.rows.jacobian())? > f64::EPSILON,
            Err(LinearError::Singular { .. } | LinearError::NotFinite) => {}
            Err(error) => return Err(error),
        }
        Ok(self.regular)
    }

    fn solve(&mut self, given: &Given, answer: &mut NodalContact) -> Computed<bool> {
        if !self.regular {
            return Ok(false);
        }
        let layout = self.rows.layout().clone();
        self.rhs.fill(0.0);
        self.rhs[..given.force.len()].copy_from_slice(&given.force);
        let statuses = self.rows.cases();
        for (i, case) in statuses.chunks_exact(2).enumerate() {
            let (closed, sticks) = (case[0] == 1, case[1] == 2);
            if closed {
                self.rhs[layout.p_n(i)] = self.r_n[i] * given.gap[i];
            }
            if let (true, Some(place)) = (sticks, self.tangents[i].and_then(|k| layout.tangential(i)[k])) {
                self.rhs[place] = self.r_t[i] * given.slide[i];
            }
        }
        let info = match self.linear.solve(self.rows.jacobian(), &self.rhs, &mut self.z) {
            Ok(info) => info,
            Err(LinearError::NotFinite) => return Ok(false),
            Err(error) => return Err(error),
        };
        answer.u = self.z[..self.problem.displacements()].to_vec();
        answer.u_rest.clear();
        let maps = self.problem.tangential_maps();
        for i in 0..layout.contacts() {
            answer.w_n[i] = self.problem.c_n().dot(i, &self.z);
            answer.p_n[i] = self.z[layout.p_n(i)];
            let tangent = self.tangents[i];
            answer.w_t[i] = tangent.map_or(0.0, |k| maps[k].dot(i, &self.z));
            answer.p_t[i] = tangent.and_then(|k| layout.tangential(i)[k]).map_or(0.0, |place| self.z[place]);
        }
        Ok(info.backward_error <= UNSOLVED && largest(&self.z).is_finite())
    }

    fn statistics(&self) -> Statistics {
        *self.linear.statistics()
    }

    fn snapshot(&self) -> Snapshot {
        Snapshot::default()
    }

    /// Factors the matrix of the snapshot's statuses alone, since intermediate statuses may be singular.
    fn restore(&mut self, snapshot: &Snapshot) -> Computed<bool> {
        if !snapshot.statuses.is_empty() {
            self.set_statuses(&snapshot.statuses)?;
        }
        Ok(true)
    }
}

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
            u_rest: of.u_rest.iter().map(|u_rest| u_rest * length).collect(),
            p_t,
            p_o,
            p_n: of.p_n.iter().map(|p| p * force).collect(),
        }
    }

    /// Returns the residual of a solution for the `given` data.
    fn residual(&self, given: &Given, of: &NodalContact) -> Computed<Given> {
        let Scaling { force, length } = self.scaling;
        let state = self.state(of);
        let load: Vec<f64> = given.force.iter().map(|f| f * force).collect();
        let imbalance = self.problem.imbalance(&load, &state)?;
        let maps = self.problem.tangential_maps();
        let mut residual = Given {
            force: imbalance.into_iter().map(|r| -r / force).collect(),
            gap: vec![0.0; given.gap.len()],
            slide: vec![0.0; given.slide.len()],
        };
        for (i, status) in self.statuses.iter().enumerate() {
            if status.is_closed() {
                residual.gap[i] =
                    -self.problem.c_n().difference(i, &state.u, &state.u_rest, given.gap[i] * length) / length;
            }
            if let (true, Some(k)) = (status.is_sticking(), self.tangents[i]) {
                residual.slide[i] = -maps[k].difference(i, &state.u, &state.u_rest, given.slide[i] * length) / length;
            }
        }
        Ok(residual)
    }
}

impl Tangent for Refined<'_> {
    fn set_statuses(&mut self, statuses: &[NodeStatus]) -> Computed<bool> {
        self.statuses = statuses.to_vec();
        self.equations.set_statuses(statuses)
    }

    fn solve(&mut self, given: &Given, answer: &mut NodalContact) -> Computed<bool> {
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
            let residual = self.residual(given, answer)?;
            let violation = largest(&residual.force);
            if violation >= 0.5 * before {
                break;
            }
            before = violation;
            let mut change = NodalContact::zero(self.statuses.len());
            if !self.equations.solve(&residual, &mut change)? {
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

    fn snapshot(&self) -> Snapshot {
        Snapshot { statuses: self.statuses.clone(), ..self.equations.snapshot() }
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Computed<bool> {
        self.statuses.clone_from(&snapshot.statuses);
        self.equations.restore(snapshot)
    }
}
