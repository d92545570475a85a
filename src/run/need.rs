//! Estimates of the memory that a run needs.

use std::path::Path;

use super::RunError;
use crate::algebra::linear::built_in::ranks;
use crate::algebra::linear::{Cholesky, Computed, FactorInfo, LinearError, SparseLu};
use crate::base::memory::{Budget, kilobytes};
use crate::body::model::Model;
use crate::solver::history::LinearAlgebra;
use crate::solver::initial_working_set::InitialWorkingSet;
use crate::solver::problem::ContactProblem;

/// Bytes per entry of the lower triangle of the stiffness, for mesh, assembly and the patterns and values of all
/// formulations; and where the formulations are those of condensed equations.
const BODY_BYTES: f64 = 160.0;
const CONDENSED_BODY_BYTES: f64 = 60.0;

/// Bytes per displacement for mesh, rows and vectors, if multigrid has the stiffness in rows of nodes.
const ROWS_BYTES: f64 = 1500.0;
/// Bytes per displacement if multigrid has an undivided stiffness, with Newton matrices besides.
const PIECE_BYTES: f64 = 3500.0;

/// Memory of the program before it has a mesh, bytes.
const PROGRAM_BYTES: f64 = 25e6;

/// Bytes of the records of an increment, if they are kept.
const RECORD_BYTES: f64 = 2000.0;

/// The largest memory of an entry of the Schur complement, bytes: the complement, the block of the factor that it comes
/// from, a square of the same size while it is formed, and later the factors of the unconstrained part (measured: 43
/// with 4000 contact displacements).
const SCHUR_BYTES: f64 = 44.0;
/// The largest memory of an entry of a sparse factor during the factorisation, bytes.
const LU_BYTES: f64 = 16.0;
/// The memory of an entry of a Cholesky factor once it is factored, bytes.
const CHOLESKY_BYTES: f64 = 8.0;
/// The largest memory of an entry of a factor with MUMPS, bytes.
const MUMPS_BYTES: f64 = 12.0;

/// The memory of multigrid for a displacement, bytes: the Newton matrix, the matrix with contact eliminated and its
/// hierarchy, twice, and the vectors of GMRES. Measured with everything else in a run: 6200 on one process, cube of 24³
/// elements; as much as these 6500 and the mesh on each of two.
const MULTIGRID_BYTES: f64 = 6500.0;

/// The share of the factors that ranks store twice: four ranks take 1.24 times the memory of one.
const KEPT_TWICE: f64 = 0.3;

/// An upper bound of the entries of a factor relative to those of the stiffness, for factors that fit into a machine.
/// If there is room for that many, no ordering is needed to know that there is enough.
const MAX_FILL: usize = 64;

/// The memory needed by a run, bytes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MemoryEstimate {
    /// The program, mesh, stiffness, contact and the equations.
    pub body: f64,
    /// The factors and, for a condensed system, the Schur complement, at most.
    pub factors: f64,
    /// Records of the history, if they are kept.
    pub history: f64,
}

impl MemoryEstimate {
    /// Estimates the memory for `model` with this linear solver and records of this number of increments, 0 if they are
    /// not kept.
    ///
    /// # Errors
    /// When memory is short for the symbolic analysis.
    pub fn of(model: &Model, linear: LinearAlgebra, records: usize) -> Computed<Self> {
        let stiffness = match linear {
            LinearAlgebra::Multigrid | LinearAlgebra::Petsc => FactorInfo::default(),
            LinearAlgebra::Whole(_) | LinearAlgebra::Condensed(_) => factor_of(&model.problem)?,
        };
        Ok(Self::with(model, &InitialWorkingSet::default(), linear, records, stiffness))
    }

    fn with(
        model: &Model,
        initial_set: &InitialWorkingSet,
        linear: LinearAlgebra,
        records: usize,
        stiffness: FactorInfo,
    ) -> Self {
        let factors = factors(&model.problem, initial_set, linear, stiffness);
        MemoryEstimate { body: body(model, linear), factors, history: RECORD_BYTES * records as f64 }
    }

    /// Returns the total.
    pub fn bytes(&self) -> u64 {
        (self.body + self.factors + self.history) as u64
    }

    /// Returns an error if `budget`, the memory left after building the model, is too small for the factors of a run of
    /// `model` whose condensed equations contain the contact nodes `initial_set`. A process that takes more memory than the
    /// machine or a control group has is killed without a verdict.
    pub(super) fn check(
        model: &Model,
        initial_set: &InitialWorkingSet,
        linear: LinearAlgebra,
        budget: Option<Budget>,
    ) -> Result<(), RunError> {
        let Some(budget) = budget else { return Ok(()) };
        // The memory in use belongs to the body.
        let used = kilobytes(Path::new("/proc/self/status"), "VmRSS:").unwrap_or(0) as f64;
        let of = |stiffness| {
            let need = Self::with(model, initial_set, linear, 0, stiffness);
            need.factors + (need.body - used).max(0.0)
        };
        let (what, stiffness) = if linear.iterates() {
            ("the hierarchies of this scene", FactorInfo::default())
        } else {
            if of(most_entries(&model.problem)) <= budget.bytes as f64 {
                return Ok(());
            }
            match factor_of(&model.problem) {
                Err(LinearError::NotBuiltIn { .. }) => return Ok(()),
                known => ("the factors of this scene", known?),
            }
        };
        let needed = of(stiffness);
        if needed > budget.bytes as f64 {
            return Err(RunError::NoRoom { what, needed: needed as u64, budget });
        }
        Ok(())
    }

    /// Returns an error if the records of this number of increments do not fit into `budget`.
    ///
    /// # Errors
    /// [`RunError::NoRoom`].
    pub fn check_records(increments: usize, budget: Option<Budget>) -> Result<(), RunError> {
        let needed = (RECORD_BYTES * increments as f64) as u64;
        match budget.filter(|budget| needed > budget.bytes) {
            Some(budget) => Err(RunError::NoRoom { what: "the records of so many increments", needed, budget }),
            None => Ok(()),
        }
    }
}

/// Returns the properties of the Cholesky factor of the stiffness, by one symbolic analysis.
pub(super) fn factor_of(problem: &ContactProblem) -> Computed<FactorInfo> {
    Cholesky::predict(problem.stiffness().assembled()?.as_ref())
}

/// Returns an upper bound of that, which needs no analysis.
pub(super) fn most_entries(problem: &ContactProblem) -> FactorInfo {
    FactorInfo { entries: MAX_FILL * problem.stiffness().lower_entries(), ..FactorInfo::default() }
}

/// Returns the largest memory of the factors on this process, bytes, where condensed equations contain the contact nodes
/// `initial_set` or all. `stiffness` tells of the Cholesky factor of the stiffness; LU has about twice its entries.
pub(super) fn factors(
    problem: &ContactProblem,
    initial_set: &InitialWorkingSet,
    linear: LinearAlgebra,
    stiffness: FactorInfo,
) -> f64 {
    let entries = stiffness.entries as f64;
    let bytes = match linear {
        LinearAlgebra::Whole(SparseLu::Partial) | LinearAlgebra::Condensed(_) => {
            let schur = (initial_set.displacements(problem) as f64).powi(2);
            (LU_BYTES * entries).max(CHOLESKY_BYTES * entries + SCHUR_BYTES * schur)
        }
        LinearAlgebra::Whole(SparseLu::Mumps) => MUMPS_BYTES * 2.0 * entries,
        LinearAlgebra::Whole(SparseLu::Umfpack | SparseLu::Faer) => LU_BYTES * 2.0 * entries,
        LinearAlgebra::Multigrid | LinearAlgebra::Petsc => MULTIGRID_BYTES * problem.displacements() as f64,
    };
    let ranks = if linear.is_shared() { ranks() as f64 } else { 1.0 };
    bytes * (1.0 + KEPT_TWICE * (1.0 - 1.0 / ranks)) / ranks
}

/// Returns the memory before anything is factored, bytes.
fn body(model: &Model, linear: LinearAlgebra) -> f64 {
    let stiffness = model.problem.stiffness();
    let bytes = match linear {
        LinearAlgebra::Multigrid | LinearAlgebra::Petsc => {
            let each = if stiffness.distributed().is_some() || model.has_rows() { ROWS_BYTES } else { PIECE_BYTES };
            each * stiffness.order() as f64
        }
        LinearAlgebra::Whole(_) => BODY_BYTES * stiffness.lower_entries() as f64,
        LinearAlgebra::Condensed(_) => CONDENSED_BODY_BYTES * stiffness.lower_entries() as f64,
    };
    PROGRAM_BYTES + bytes
}

/// Returns an error if this number of nodes in this number of dimensions, where known beforehand, does not fit into the
/// `budget`. An early error is better than a process killed half-way.
pub(super) fn has_room(nodes: Option<(usize, usize)>, budget: Option<Budget>) -> Result<(), RunError> {
    let (Some((nodes, d)), Some(budget)) = (nodes, budget) else { return Ok(()) };
    // The matrices alone: 16 bytes an entry, with 27 entries per unknown in two dimensions and 81 in three. The factors
    // take more.
    let needed = (nodes as u64).saturating_mul((d * 3_usize.pow(d as u32 + 1) * 16) as u64);
    if needed > budget.bytes {
        return Err(RunError::NoRoom { what: "the matrices of this mesh", needed, budget });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::memory::Source;
    use crate::run::discretise;
    use crate::scene::Scene;

    fn budget(bytes: u64) -> Budget {
        Budget { bytes, source: Source::AddressSpace }
    }

    fn words(result: Result<(), RunError>) -> Option<String> {
        result.err().map(|error| error.to_string())
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        // Two displacements per node, 27 entries each.
        let needed = 1_000_000 * 2 * 27 * 16;
        assert!(has_room(Some((1_000_000, 2)), Some(budget(needed))).is_ok());
        let refused = words(has_room(Some((1_000_000, 2)), Some(budget(needed - 1))));
        let expected =
            "the matrices of this mesh need about 864 MB of memory, but the address-space limit leaves 864 MB";
        assert_eq!(refused.as_deref(), Some(expected));
        assert!(has_room(None, Some(budget(0))).is_ok() && has_room(Some((1, 3)), None).is_ok());
        assert!(has_room(Some((usize::MAX / 4, 3)), Some(budget(u64::MAX - 1))).is_err());
        assert!(MemoryEstimate::check_records(1000, Some(budget(2_000_000))).is_ok());
        assert!(MemoryEstimate::check_records(1000, None).is_ok());
        let refused = words(MemoryEstimate::check_records(10_000_000, Some(budget(1_500_000_000))));
        let expected =
            "the records of so many increments need about 20.0 GB of memory, but the address-space limit leaves 1.5 GB";
        assert_eq!(refused.as_deref(), Some(expected));
    }

    #[cfg(any(feature = "umfpack", feature = "faer"))]
    #[test]
    fn factors_that_do_not_fit_are_refused() {
        let text = include_str!("../../data/scenes/block.toml");
        let scene = Scene::parse("block.toml", text, &["mesh.elements=[20,20]".parse().unwrap()]).unwrap();
        let model = discretise(&scene).unwrap();
        for linear in [LinearAlgebra::default(), LinearAlgebra::condensed()] {
            let need = MemoryEstimate::of(&model, linear, 100).unwrap();
            assert!(need.factors > 1e5 && need.history == 2e5, "{need:?}");
            assert!(need.body > PROGRAM_BYTES && need.bytes() as f64 > need.body + need.factors);
            let check = |budget| MemoryEstimate::check(&model, &InitialWorkingSet::default(), linear, budget);
            assert!(check(Some(budget(need.bytes()))).is_ok());
            assert!(matches!(
                check(Some(budget(need.factors as u64 - 1))),
                Err(RunError::NoRoom { needed, .. }) if (need.factors as u64..need.bytes()).contains(&needed)
            ));
            assert!(check(None).is_ok());
            // Nodes outside the initial set take no part in the Schur complement.
            let few = InitialWorkingSet { nodes: Some(vec![0]), ..InitialWorkingSet::default() };
            let of = |initial_set| MemoryEstimate::with(&model, initial_set, linear, 0, FactorInfo::default()).factors;
            assert_eq!(of(&few) < of(&InitialWorkingSet::default()), linear.condenses());
        }
    }
}
