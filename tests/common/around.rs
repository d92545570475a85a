//! A method around another one: its increments are solved by a closure, and all else is left to the method inside.

use stickslip::algebra::linear::{LinearError, RefinedSolver, SystemMatrix};
use stickslip::solver::history::{IncrementSolver, Observe, Task};
use stickslip::solver::{MethodResult, State};

struct Around<F> {
    inner: Box<dyn IncrementSolver>,
    solve: F,
}

/// Returns a method that solves increments by `solve`, which may pass them on to `inner`.
pub fn around<F>(inner: Box<dyn IncrementSolver>, solve: F) -> Box<dyn IncrementSolver>
where
    F: FnMut(&mut dyn IncrementSolver, &Task<'_>, &mut RefinedSolver, Observe<'_>) -> Result<MethodResult, LinearError>
        + Send
        + 'static,
{
    Box::new(Around { inner, solve })
}

impl<F> IncrementSolver for Around<F>
where
    F: FnMut(&mut dyn IncrementSolver, &Task<'_>, &mut RefinedSolver, Observe<'_>) -> Result<MethodResult, LinearError>
        + Send,
{
    fn matrix(&self) -> &SystemMatrix {
        self.inner.matrix()
    }

    fn linearize(&mut self) {
        self.inner.linearize();
    }

    fn clamp_contacts(&mut self) -> Result<(), Vec<f64>> {
        self.inner.clamp_contacts()
    }

    fn solve(
        &mut self,
        task: &Task<'_>,
        linear: &mut RefinedSolver,
        observe: Observe<'_>,
    ) -> Result<MethodResult, LinearError> {
        (self.solve)(self.inner.as_mut(), task, linear, observe)
    }

    fn state(&self) -> State {
        self.inner.state()
    }

    fn set_state(&mut self, state: &State) {
        self.inner.set_state(state);
    }

    fn unknowns(&mut self) -> &mut Vec<f64> {
        self.inner.unknowns()
    }
}
