//! The settings of a history.

use super::Error;
use super::method::{Method, Start};
use crate::base::units::Scaling;
use crate::solver::checkpoint::Checkpoint;
use crate::solver::formulation::{FormulationScaling, Layout};
use crate::solver::loading::Loading;
use crate::solver::problem::ContactProblem;
use crate::solver::problem::error::{expect_each, expect_increasing, expect_length, expect_value};

/// The settings of a history: data derived from the problem and its loading, and the choice of a method.
#[derive(Debug, Clone, PartialEq)]
pub struct HistorySettings {
    /// The algorithm of the increments.
    pub method: Method,
    /// `r_i` of `H_N`, and the units in which `Theta` adds its rows.
    pub conventions: FormulationScaling,
    /// [`ContactProblem::contact_stiffness`] of the body, n_c, N/m, for starting points and stopping tests.
    pub contact_stiffness: Vec<f64>,
    /// The units of the internal numbers.
    pub scaling: Scaling,
    /// The tolerance, in (0, 1). An increment has converged if every component of its error measure is at most this.
    pub tolerance: f64,
    /// The limit of iterations in an increment, 1 or more.
    pub max_iterations: usize,
    /// The number of times that a failing increment may be halved, at most 52. Its substeps are increments of their
    /// own.
    pub halvings: u32,
    /// The initial working set of the condensed equations, ascending. Other nodes join when the error measure, which
    /// covers all nodes, requires them. `None` means all contact nodes. With the constants of the paper, or if only
    /// contact holds a body, all nodes are used in any case.
    pub working_set: Option<Vec<usize>>,
    /// `true` if the outcome keeps the records of all increments and the events of an exact path, `false` for only
    /// the last two records. Millions of records need gigabytes, and an observer sees each of them anyway.
    pub keeps_records: bool,
    /// `true` if the time-step error of BN's increments is estimated, see [`super::IncrementError`]. The
    /// estimate costs two solves an increment, and another factorisation where nodes first touch and slide.
    pub estimates_error: bool,
    /// The checkpoint from which the history resumes, instead of the unloaded body. It comes from
    /// [`super::Observer::checkpoint_offered`] of a run with the same problem, loading, times so far, settings and
    /// linear system.
    pub from: Option<Checkpoint>,
}

/// The default number of halvings. An increment may become 64 substeps, one and a half orders of magnitude, which
/// distinguishes a history that cannot continue from one with too coarse increments.
const HALVINGS: u32 = 6;

/// The default limit of iterations: twice the most that any solved increment has needed.
pub(super) const MAX_ITERATIONS: usize = 200;

impl HistorySettings {
    /// Derives the settings of a history of `problem` under `loading`: units near its stiffness and its
    /// displacements, `r` from the stiffness of its contact nodes, and the default tolerance and limit of iterations
    /// of `method`.
    ///
    /// # Errors
    /// [`Error::NoWeight`] if `method` has the constants of the paper and the problem has no weights;
    /// [`Error::Problem`] if `loading` does not fit `problem`.
    pub fn new(problem: &ContactProblem, loading: &Loading, method: Method) -> Result<Self, Error> {
        loading.check(problem)?;
        let contact_stiffness = problem.contact_stiffness().to_vec();
        let conventions = match method {
            Method::PaperBn | Method::PaperIp { .. } => {
                FormulationScaling::paper(problem.weight().ok_or(Error::NoWeight { method })?)
            }
            Method::Bn { r_factor, .. } => {
                let mut conventions = FormulationScaling::of_stiffness(&Layout::new(problem), &contact_stiffness);
                conventions.scale_r(r_factor);
                conventions
            }
            Method::Ip => FormulationScaling::of_stiffness(&Layout::new(problem), &contact_stiffness),
        };
        let scaling = match method {
            // These units are the paper's: its starting points and constants are absolute.
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

    /// Sets the limit of iterations and the tolerance.
    #[must_use]
    pub fn until(self, max_iterations: usize, tolerance: f64) -> Self {
        HistorySettings { tolerance, max_iterations, ..self }
    }

    /// Checks that the settings fit `problem`.
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
        // After more halvings there is no time between two numbers.
        expect_value("halvings", f64::from(self.halvings), "at most 52", |most| most <= 52.0)?;
        Ok(())
    }
}
