//! The equations of given statuses as a sparse system: one factorisation for each set of statuses, on one pattern.

use super::node::{Given, NodalContact, NodeStatus, largest};
use super::tangent::{Taken, Tangent};
use crate::algebra::linear::{LinearError, RefinedSolver, Statistics};
use crate::base::units::Scaling;
use crate::solver::formulation::{Bdiff, FormulationScaling};
use crate::solver::laws::coulomb::{NormalCase, TangentialCase};
use crate::solver::problem::ContactProblem;

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
    /// `true` if `linear` has served other equations since it last factored these.
    lent: bool,
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
    ) -> Result<Self, LinearError> {
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
        Ok(SparseTangent {
            problem,
            tangents,
            linear,
            r_n,
            r_t,
            regular: false,
            lent: false,
            rhs: zeros(),
            z: zeros(),
            rows,
        })
    }
}

impl Tangent for SparseTangent<'_> {
    fn take(&mut self, statuses: &[NodeStatus]) -> Result<bool, LinearError> {
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
        if std::mem::take(&mut self.lent) {
            self.linear.analyze(self.rows.jacobian())?;
        }
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

    fn solve(&mut self, given: &Given, answer: &mut NodalContact) -> Result<bool, LinearError> {
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

    fn taken(&self) -> Taken {
        Taken::default()
    }

    /// Factors the matrix of the snapshot's statuses alone, since intermediate statuses may be singular.
    fn take_up(&mut self, taken: &Taken) -> Result<bool, LinearError> {
        if !taken.statuses.is_empty() {
            self.take(&taken.statuses)?;
        }
        Ok(true)
    }

    fn lend(&mut self) -> Option<&mut RefinedSolver> {
        (self.lent, self.regular) = (true, false);
        Some(self.linear)
    }
}
