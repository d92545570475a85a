//! The end of the interior point method: BN from where it is.
//!
//! Near the solution the interior point has small members in all its pairs, and what rounding does to
//! them is at times more than the tolerance allows. BN knows no such limit, and from there it needs a
//! step or two.

use super::task::{Observe, Task};
use crate::algebra::linear::{LinearError, RefinedSolver};
use crate::algebra::sparse::SystemMatrix;
use crate::solver::formulation::{Assembled, Bdiff, FormulationScaling, Linearization};
use crate::solver::newton::{Armijo, Bn, MethodResult, StopCriterion};
use crate::solver::problem::{ContactProblem, Increment};

/// From near the solution BN takes two or three iterations; more show that it is not near.
const ITERATIONS: usize = 10;

pub(super) struct NewtonEnd {
    formulation: Bdiff,
    bn: Bn,
    z: Vec<f64>,
}

impl NewtonEnd {
    pub(super) fn new(assembled: Assembled, natural: &FormulationScaling) -> Self {
        let formulation = Bdiff::on(assembled, natural);
        let unknowns = formulation.unknowns();
        NewtonEnd { formulation, bn: Bn::new(Armijo::HALVING, ITERATIONS, unknowns), z: vec![0.0; unknowns] }
    }

    /// Sets the data of a new increment.
    pub(super) fn begin(&mut self, increment: &Increment<'_>) {
        self.formulation.begin(increment);
    }

    /// BN from a `z` that begins with `(u, p_t, p_n)`, in at most `left` iterations.
    pub(super) fn solve(
        &mut self,
        problem: &ContactProblem,
        task: &Task<'_>,
        linear: &mut RefinedSolver,
        z: &[f64],
        left: usize,
        observe: Observe<'_>,
    ) -> Result<MethodResult, LinearError> {
        let NewtonEnd { formulation, bn, z: own } = self;
        bn.limit(left.min(ITERATIONS));
        own.copy_from_slice(&z[..formulation.unknowns()]);
        let (layout, scaling) = (formulation.layout().clone(), *formulation.scaling());
        let mut error = |z: &[f64], rest: &[f64]| task.error(problem, &layout.unpacked_with(z, rest, &scaling));
        bn.solve(
            formulation,
            linear,
            own,
            StopCriterion::Measured { tolerance: task.tolerance, error: &mut error },
            observe,
        )
    }

    /// Of the solutions along the motions that contact leaves free at `z`, which begins with `(u, p_t, p_n)`, the one nearest to
    /// `to`: its `(u, p_t, p_n)`; `None` if there is one only.
    pub(super) fn settled(&mut self, z: &[f64], to: &[f64]) -> Option<Vec<f64>> {
        self.linearize(z);
        let n = self.z.len();
        self.formulation.is_tied().then(|| self.formulation.settled(&z[..n], &to[..n]))
    }

    /// Linearises at a `z` that begins with `(u, p_t, p_n)`.
    pub(super) fn linearize(&mut self, z: &[f64]) {
        self.formulation.linearize(&z[..self.z.len()]);
    }

    /// The last linearisation, to be put away.
    pub(super) fn linearization(&self) -> Linearization {
        self.formulation.linearization()
    }

    /// Linearises as it was; whether that is one of this problem.
    pub(super) fn linearize_as(&mut self, kept: &Linearization) -> bool {
        self.formulation.linearize_as(kept)
    }

    /// What the last linearisation wrote.
    pub(super) fn matrix(&self) -> &SystemMatrix {
        self.formulation.jacobian()
    }

    /// Where it has come to, in `(u, p_t, p_n)`, and what rounding leaves off there.
    pub(super) fn reached(&self) -> (&[f64], &[f64]) {
        (&self.z, self.bn.rest())
    }
}
