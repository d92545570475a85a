//! The report on a problem that was solved or judged.

use serde::{Deserialize, Serialize};

use stickslip::run::report::SCHEMA_VERSION;
use stickslip_exchange::{Answer, Errors, Problem, ProblemFile, Stage};

/// The verdict on a problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// All laws hold within the tolerance, by the independent error measure.
    Solved,
    /// A law is violated. The errors show by how much.
    #[default]
    NotSolved,
    /// The file contains no readable problem.
    BadInput,
    /// The linear algebra could not go on.
    MachineFailure,
}

impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.serialize(f)
    }
}

/// A problem, its verdict, and the course of the solution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct ProblemReport {
    /// The version of this format.
    pub schema_version: u32,
    /// The file of the problem.
    pub file: String,
    /// The title of the problem.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// The form of the problem: `global` or `local`.
    pub form: String,
    /// The number of dimensions: 2 in the plane, 3 in space.
    pub dimension: usize,
    /// The number of contacts, n_c.
    pub contacts: usize,
    /// The number of unknowns of the bodies, n; 0 for a local problem.
    pub unknowns: usize,
    /// The verdict.
    pub status: Verdict,
    /// The largest relative error of any law, on which the verdict depends.
    pub residual: f64,
    /// The violation of each law.
    pub errors: Errors,
    /// Oddities of the problem that may be unintended.
    pub warnings: Vec<String>,
    /// The stages of the solution; empty if a given solution is judged.
    pub stages: Vec<Stage>,
    /// CPU time of the solution, s; 0 if a given solution is judged.
    pub cpu_seconds: f64,
}

/// Lists the oddities of `problem`.
fn warnings(problem: &Problem) -> Vec<String> {
    let triangular = matches!(problem, Problem::Global(problem) if problem.is_triangular());
    let half = "M has entries on one side of its diagonal alone, and is taken as it stands: where it is meant as half of a \
                symmetric matrix, write both halves";
    triangular.then(|| half.to_string()).into_iter().collect()
}

impl ProblemReport {
    /// Reports on a given solution of the problem in `file`, called `name`, with these errors.
    pub fn judged(name: &str, file: &ProblemFile, errors: Errors) -> Self {
        let problem = &file.problem;
        ProblemReport {
            schema_version: SCHEMA_VERSION,
            file: name.to_string(),
            title: file.info.title.clone(),
            form: problem.form().to_string(),
            dimension: problem.dimension(),
            contacts: problem.contacts(),
            unknowns: problem.unknowns(),
            status: if errors.is_solved() { Verdict::Solved } else { Verdict::NotSolved },
            residual: errors.worst(),
            errors,
            warnings: warnings(problem),
            stages: Vec::new(),
            cpu_seconds: 0.0,
        }
    }

    /// Reports on an answer that took this CPU time.
    pub fn solved(name: &str, file: &ProblemFile, answer: &Answer, cpu_seconds: f64) -> Self {
        let stages = answer.stages.clone();
        ProblemReport { stages, cpu_seconds, ..Self::judged(name, file, answer.errors) }
    }
}
