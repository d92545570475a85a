//! Warnings of what a run costs, and of results that it lacks.

use super::prelude::*;
use crate::algebra::linear::Statistics;
use crate::algebra::linear::process::blas::{Blas, KERNEL_VARIABLE};
use crate::solver::history::LinearAlgebra;

kinds! {
    /// `--uniqueness` failed, as for want of memory, or `output.cycle = "last"` found no cycle.
    NOT_COMPUTED("not-computed", "See the message.", "the other results suffice; they are complete");
    /// The BLAS is slower than the processor allows.
    SLOW_BLAS("slow-blas", "Follow the message; see [the BLAS](command-line.md#the-blas).", "time does not matter", before);
    /// A direct solver replaced multigrid.
    MULTIGRID_GAVE_WAY("multigrid-gave-way", "`solver.linear = \"auto\"`.", "time and memory suffice");
    /// An MPI process has another body than rank 0, or cannot read the scene.
    RANKS_APART("ranks-apart", "Same scene, options and paths for [all](../howto/large-bodies.md#on-several-processes).",
        "memory suffices");
}

impl Warning {
    /// Warns that `result` could not be computed, although the history was solved.
    pub fn of_missing(result: &str, why: &dyn std::error::Error) -> Self {
        let message = format!("{result} could not be computed: {why}; all other results are complete");
        WarningKind::NOT_COMPUTED.warning(message)
    }

    /// Warns of a slow BLAS and names the cure.
    pub fn of_blas(blas: &Blas) -> Option<Self> {
        let cure = match blas.better_kernel {
            Some(better) if blas.selectable => format!("set {KERNEL_VARIABLE}={better} in the environment"),
            Some(_) => "install an OpenBLAS that was built for several processors".to_string(),
            None => "install OpenBLAS, or BLIS or MKL".to_string(),
        };
        let message = format!(
            "the BLAS in use is {blas}, which makes factorisations up to several times slower than necessary: {cure}"
        );
        blas.is_slow().then_some(WarningKind::SLOW_BLAS.warning(message))
    }

    /// Warns that multigrid was `asked` for and stagnated, for the reason `why` if known, or could not begin, so that
    /// the solver `used` replaced it.
    pub(in crate::run) fn of_multigrid(
        linear: &Statistics,
        asked: bool,
        used: &str,
        why: Option<&str>,
    ) -> Option<Self> {
        let message = if asked && used != "multigrid" && used != "petsc" {
            format!(
                "multigrid cannot treat two obstacles at a node, or contact rows shared by nodes: {used} was used instead"
            )
        } else {
            let (instead, why) = (linear.instead?, why.unwrap_or("it does not suit these matrices"));
            format!(
                "multigrid did not converge within 60 iterations, so {instead} took over, which needs more memory: \
                 {why}; use solver.linear = \"auto\""
            )
        };
        Some(WarningKind::MULTIGRID_GAVE_WAY.warning(message))
    }

    /// Warns that rank 0 has the whole stiffness although several processes might share it, because one of them has
    /// another body.
    pub(in crate::run) fn of_ranks(model: &Model, linear: LinearAlgebra, ranks: usize) -> Option<Self> {
        let is_whole = model.has_rows() && model.problem.stiffness().distributed().is_none();
        let message = "a process has another body than rank 0, or cannot read the scene, so rank 0 has assembled \
         the whole stiffness, which needs more memory there: start all processes with the same scene and options, \
         and keep all files at the same paths";
        (ranks > 1 && linear.iterates() && is_whole).then(|| WarningKind::RANKS_APART.warning(message.to_string()))
    }
}
