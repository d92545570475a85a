//! How a history is solved.

use super::LinearAlgebra;
use super::error::Error;
use super::method::{Method, Start};
use crate::base::units::Scaling;
use crate::solver::checkpoint::Checkpoint;
use crate::solver::formulation::FormulationScaling;
use crate::solver::loading::Loading;
use crate::solver::problem::ContactProblem;
use crate::solver::problem::error::{expect_each, expect_increasing, expect_length, expect_value};

/// How a history is solved: what the problem and its loading tell of it, and the choice of a method.
#[derive(Debug, Clone, PartialEq)]
pub struct HistorySettings {
    /// The algorithm of the increments.
    pub method: Method,
    /// `r_i` of `H_N`, and the units in which `Theta` adds its rows.
    pub conventions: FormulationScaling,
    /// [`ContactProblem::contact_stiffness`] of the body, n_c, N/m, for all that starts or ends by it.
    pub contact_stiffness: Vec<f64>,
    /// The units of the numbers inside.
    pub scaling: Scaling,
    /// An increment has converged when every component of its error measure is at most this, in (0, 1).
    pub tolerance: f64,
    /// The limit of iterations in an increment, 1 or more.
    pub max_iterations: usize,
    /// How many times an increment that fails may be halved, at most 52. The parts are increments of their own.
    pub halvings: u32,
    /// The contact nodes that condensed equations hold at first, ascending; the others join as soon as the error measure, which
    /// has them all, asks for them. `None` stands for all, and so does any set with the constants of the paper or in a body that
    /// contact alone holds.
    pub working_set: Option<Vec<usize>>,
    /// Whether the outcome has the records of all increments, and the events on an exact path, and not only of the last two: of
    /// millions they need gigabytes, and an observer sees each as it comes.
    pub keeps_records: bool,
    /// `true`: the time-step error is estimated beside the increments of BN, see [`super::IncrementError`]. It costs a solve an increment, and
    /// two factorisations where nodes touch first.
    pub estimates_error: bool,
    /// From where it goes on, instead of from the unloaded body: what an observer was offered in [`super::Observer::rest`] of a run of the
    /// same problem, loading, times so far, settings and linear system.
    pub from: Option<Checkpoint>,
}

/// The contact forces from which BN starts its first increment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum FirstGuess {
    /// The same normal stress (Pa) in every contact node.
    Pressure(f64),
    /// Those that would hold the contact nodes where they are.
    Held,
}

/// An increment may become 64 parts: an order of magnitude and a half, after which a history that
/// cannot go on is told from one that was too coarse.
const HALVINGS: u32 = 6;

/// Twice what the longest increments that were met and solved need.
pub(super) const MAX_ITERATIONS: usize = 200;

impl HistorySettings {
    /// What a history of `problem` under `loading` asks for: units near its stiffness and its displacements, `r` from the
    /// stiffness of its contact nodes, the default tolerance and limit of iterations of `method`.
    ///
    /// # Errors
    /// [`Error::NoWeight`] when `method` has the constants of the paper and the problem has no weights;
    /// [`Error::Problem`] when `loading` does not fit `problem`.
    pub fn new(problem: &ContactProblem, loading: &Loading, method: Method) -> Result<Self, Error> {
        loading.check(problem)?;
        let contact_stiffness = problem.contact_stiffness();
        let conventions = match method {
            Method::PaperBn | Method::PaperIp { .. } => {
                FormulationScaling::paper(problem.weight().ok_or(Error::NoWeight { method })?)
            }
            Method::Bn { r_factor, .. } => {
                let mut conventions = FormulationScaling::of_stiffness(problem, &contact_stiffness);
                conventions.scale_r(r_factor);
                conventions
            }
            Method::Ip { .. } | Method::Events { .. } => FormulationScaling::of_stiffness(problem, &contact_stiffness),
        };
        let scaling = match method {
            // The numbers inside are the paper's: its starting points and constants are absolute.
            Method::PaperIp { .. } => Scaling { force: 1e6, length: 1e-5 },
            _ => problem.scaling(loading.largest_force(), loading.largest_interference()),
        };
        Ok(HistorySettings {
            method,
            conventions,
            contact_stiffness,
            scaling,
            tolerance: method.default_tolerance(),
            max_iterations: MAX_ITERATIONS,
            halvings: if method.is_of_paper() { 0 } else { HALVINGS },
            working_set: None,
            keeps_records: true,
            estimates_error: false,
            from: None,
        })
    }

    /// The same with another limit of iterations and another tolerance.
    #[must_use]
    pub fn until(self, max_iterations: usize, tolerance: f64) -> Self {
        HistorySettings { tolerance, max_iterations, ..self }
    }

    /// Whether they fit `problem`.
    pub(super) fn check(&self, problem: &ContactProblem) -> Result<(), Error> {
        let n_c = problem.contacts();
        let FormulationScaling { r_n, r_t, row_unit, .. } = &self.conventions;
        let arrays =
            [("r_n", r_n), ("r_t", r_t), ("row_unit", row_unit), ("contact_stiffness", &self.contact_stiffness)];
        let (must, sound) = ("finite and above 0", |x: f64| x > 0.0 && x.is_finite());
        for (array, values) in arrays {
            expect_length(array, n_c, values.len(), "one for each contact node")?;
            expect_each(array, values, must, sound)?;
        }
        for (name, unit) in [("scaling.force", self.scaling.force), ("scaling.length", self.scaling.length)] {
            expect_value(name, unit, must, sound)?;
        }
        if self.method.is_of_paper() && problem.weight().is_none() {
            return Err(Error::NoWeight { method: self.method });
        }
        if let Method::PaperIp { start: Start::Prev { shortest_step, far, patience }, .. } = self.method {
            let share = |x| x > 0.0 && x <= 1.0;
            expect_value("start.shortest_step", shortest_step, "above 0, and at most 1", share)?;
            expect_value("start.far", far, "above 0, and at most 1", share)?;
            expect_value("start.patience", patience as f64, "1 or more", |patience| patience >= 1.0)?;
        }
        let tolerance = |x| x > 0.0 && x < 1.0;
        expect_value("tolerance", self.tolerance, "above 0 and below 1", tolerance)?;
        expect_value("max_iterations", self.max_iterations as f64, "1 or more", |most| most >= 1.0)?;
        if let Some(nodes) = &self.working_set {
            let places: Vec<f64> = nodes.iter().map(|&i| i as f64).collect();
            expect_value("working_set's length", places.len() as f64, "1 or more", |length| length >= 1.0)?;
            expect_increasing("working_set", places.iter().copied())?;
            expect_each("working_set", &places, "below the number of contact nodes", |i| i < n_c as f64)?;
        }
        // Beyond that there is no time left between two numbers.
        expect_value("halvings", f64::from(self.halvings), "at most 52", |most| most <= 52.0)?;
        Ok(())
    }
}

/// What solves a history, as far as somebody chooses it; the rest, [`HistorySettings`], follows from the problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolverChoice {
    /// The algorithm with its named set of constants.
    pub method: Method,
    /// The linear algebra; `None` leaves it to [`crate::run::auto`].
    pub linear: Option<LinearAlgebra>,
    /// The most iterations an increment may take.
    pub max_iterations: usize,
    /// An increment has converged when every component of the error measure is at most this.
    pub tolerance: f64,
}

impl SolverChoice {
    /// The most iterations of an increment where nobody says otherwise.
    pub const MAX_ITERATIONS: usize = MAX_ITERATIONS;

    /// `method` with its default tolerance and limit, and the linear algebra of this build on the uncondensed system.
    pub fn new(method: Method) -> Self {
        SolverChoice {
            method,
            linear: Some(LinearAlgebra::default()),
            max_iterations: Self::MAX_ITERATIONS,
            tolerance: method.default_tolerance(),
        }
    }

    /// The settings of a history of `problem` under `loading`.
    ///
    /// # Errors
    /// As [`HistorySettings::new`].
    pub fn settings(&self, problem: &ContactProblem, loading: &Loading) -> Result<HistorySettings, Error> {
        Ok(HistorySettings::new(problem, loading, self.method)?.until(self.max_iterations, self.tolerance))
    }
}

impl Default for SolverChoice {
    fn default() -> Self {
        SolverChoice::new(Method::BN)
    }
}
