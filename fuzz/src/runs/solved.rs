//! A scene, solved and judged.

use super::laws;
use stickslip::body::Model;
use stickslip::run::report::RunReport;
use stickslip::run::{RecordedIncrement, Recording, Run};
use stickslip::scene::Scene;
use stickslip::solver::history::{SolverChoice, Status};

/// What a run is and what it gave.
pub(super) struct Solved {
    pub model: Model,
    pub solver: SolverChoice,
    pub report: RunReport,
    pub increments: Vec<RecordedIncrement>,
}

impl Solved {
    /// The run of a scene; none if it is refused. What converged obeys the laws.
    pub fn of(scene: &Scene) -> Result<Option<Self>, String> {
        match Run::new(scene) {
            Ok(run) => Solved::run(run, scene.solver).map(Some),
            Err(error) if error.to_string().trim().is_empty() => Err(format!("refused without a word: {error:?}")),
            Err(_) => Ok(None),
        }
    }

    /// What a run gives.
    pub fn run(run: Run<'_>, solver: SolverChoice) -> Result<Self, String> {
        let mut recording = Recording::all();
        let report = run.solve(&mut recording).map_err(|error| format!("the run breaks off: {error}"))?;
        let solved = Solved { model: run.into_model(), solver, report, increments: recording.increments };
        laws::check(&solved.model, &solved.solver, &solved.increments)?;
        Ok(solved)
    }

    /// Whether every law holds to the end.
    pub fn converged(&self) -> bool {
        self.report.status == Status::Converged
    }

    /// How it ended, in the words of a tally.
    pub fn kind(&self) -> &'static str {
        match self.report.status {
            Status::Converged => "converged",
            Status::NoEquilibrium | Status::Slips => "without equilibrium",
            Status::NoContinuation => "without continuation",
            Status::Singular => "singular",
            Status::Unsupported => "unsupported",
            _ => "given up",
        }
    }

    /// Whether the laws leave no choice, as far as that is known beforehand: a body that is held, with little friction, by a
    /// method that asks for the laws at the ends of increments.
    pub fn is_unique(&self) -> bool {
        const LITTLE: f64 = 0.3;
        let problem = &self.model.problem;
        let friction = problem.mu().iter().fold(0.0_f64, |m, mu| m.max(*mu));
        friction <= LITTLE && problem.rigid_modes().is_empty() && !self.solver.method.is_exact_path()
    }
}
