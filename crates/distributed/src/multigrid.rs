//! GMRES of PETSc on the uncondensed system, preconditioned by multigrid including contact: for bodies too large for a
//! factorisation.
//!
//! Contact is eliminated node by node (`node`, `layout`), and one cycle of algebraic multigrid on the matrix that is left
//! preconditions the whole Newton system (`crate::system`). BN's matrix is left symmetric: it lacks the coupling of
//! friction to normal forces, so that the number of iterations grows with friction, and slowly with the mesh. For nearly
//! incompressible materials and meshes graded in two directions at once, MUMPS takes over.

mod layout;
mod node;
mod small;

use std::any::Any;
use std::borrow::Cow;
use std::sync::Arc;

use stickslip::algebra::linear::{FactorInfo, Grid, Iterated, LinearError, LinearSolver, SparseLu, SystemMatrix};
use stickslip::algebra::{Csc, Pattern};

use crate::job::{Job, Own, Remote};
use crate::stiffness::SharedStiffness;
use crate::system::{By, Contact, Setup, info, solve};
use crate::{direct, expect_length, ranks};
use layout::Layout;

/// The default relative residual; refinement does the rest. It is that of all solves in the plane, where inexact steps
/// cost more Newton iterations than they save of the Krylov method.
const TIGHT: f64 = 1e-10;
/// A cycle is reused if the share of contact nodes with more or fewer constrained directions is at most this. Smaller
/// shares take more cycles, larger ones more iterations.
const CHANGED: f64 = 0.06;

/// Options of PETSc for all systems, before those of the user. Beyond the limit of iterations a direct solver is
/// faster. MUMPS, if the user takes it, needs room for pivots that it delays.
const OPTIONS: &str = "-ksp_type fgmres -ksp_gmres_restart 60 -ksp_max_it 60 \
    -ksp_gmres_cgs_refinement_type refine_ifneeded -contact_ksp_type preonly -contact_pc_type gamg \
    -mat_mumps_icntl_14 100";
/// Smoothers, for one process and for several. An incomplete Cholesky factorisation suits stretched elements.
const SYMMETRIC: [&str; 2] =
    ["-contact_mg_levels_pc_type icc", "-contact_mg_levels_pc_type bjacobi -contact_mg_levels_sub_pc_type icc"];
const UNSYMMETRIC: &str = "-contact_mg_levels_pc_type jacobi";

/// The iterative solver.
pub(crate) struct Multigrid {
    grid: Grid,
    /// The options of the user, if there are any. Then nothing but them says how to solve.
    options: Option<String>,
    /// `true` once PETSc has asked for all of them.
    is_checked: bool,
    system: Option<System>,
    /// The iterations since the last query.
    iterated: Iterated,
}

/// The systems of one pattern.
struct System {
    remote: Remote,
    layout: Layout,
    pattern: Arc<Pattern>,
    /// The numbers of constrained directions of the contact nodes of the present matrix, and their elimination.
    present: (Vec<usize>, Contact),
    /// These numbers for the matrix for which the cycle was made, and `true` if the present one is another.
    held: Option<Vec<usize>>,
    reused: bool,
    /// `true` once MUMPS has taken over.
    gave_way: bool,
}

/// Returns the shared stiffness of `a`, and its factor.
fn shared(a: &SystemMatrix) -> Option<(&SharedStiffness, f64)> {
    a.distributed().and_then(|(stiffness, factor)| Some(((stiffness as &dyn Any).downcast_ref()?, factor)))
}

/// Returns `a` without a block that is no shared stiffness.
fn compressed(a: &SystemMatrix) -> Result<Cow<'_, SystemMatrix>, LinearError> {
    let is_whole = a.leading().is_none() && a.distributed().is_none();
    Ok(if is_whole || shared(a).is_some() { Cow::Borrowed(a) } else { Cow::Owned(a.to_csc()?.into_owned().into()) })
}

impl Multigrid {
    /// Creates a solver for systems with this grid, with `options` of PETSc's.
    pub(crate) fn new(grid: Grid, options: Option<&str>) -> Self {
        let options = options.map(str::to_string);
        Multigrid { grid, options, is_checked: false, system: None, iterated: Iterated::default() }
    }

    /// Solves with the present cycle or factors.
    fn iterate(&mut self, b: &[f64], x: &mut [f64], tolerance: f64) -> Result<(usize, i32), LinearError> {
        let System { remote, pattern, gave_way, .. } = self.system.as_ref().ok_or(crate::NOT_ANALYZED)?;
        expect_length("right-hand side", pattern.columns(), b.len())?;
        expect_length("solution", pattern.columns(), x.len())?;
        let found = solve(remote, tolerance, b, x)?;
        self.iterated.iterations += if *gave_way { 0 } else { found.0 };
        if let (Some(options), false) = (&self.options, self.is_checked) {
            ranks::check_options(options)?;
            self.is_checked = true;
        }
        Ok(found)
    }
}

impl System {
    /// Passes the values of the present matrix on, `factor` times the stiffness and the `rest`, or leaves them without
    /// a factor, with its cycle or a new one.
    fn prepare(&mut self, factor: Option<f64>, rest: &[f64], oblique: bool) -> Result<FactorInfo, LinearError> {
        let (held, contact) = &self.present;
        let changed = |of: &Vec<usize>| of.iter().zip(held).filter(|(of, held)| of != held).count() as f64;
        // In the oblique form the swept terms differ from matrix to matrix.
        let serving = self.held.take().filter(|of| !oblique && changed(of) <= CHANGED * held.len() as f64);
        self.reused = serving.is_some();
        self.held = serving.or_else(|| Some(held.clone()));
        let by_cycle = if self.reused { By::Cycle } else { By::NewCycle { spd: !oblique } };
        let by = if self.gave_way { By::Factors } else { by_cycle };
        let own = Own { x: [rest, &[]], contact: Some(contact), ..Own::default() };
        info(&self.remote.run(Job::Factorize(factor, by), own)?)
    }
}

impl LinearSolver for Multigrid {
    fn name(&self) -> &'static str {
        if self.options.is_some() { "petsc" } else { "multigrid" }
    }

    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<(), LinearError> {
        self.analyze_system(&SystemMatrix::from(Csc::zeros(Arc::clone(pattern))))
    }

    fn analyze_system(&mut self, a: &SystemMatrix) -> Result<(), LinearError> {
        let a = &*compressed(a)?;
        self.system = None;
        let ranks = ranks::start()?.1;
        let stiffness = shared(a).map(|(stiffness, _)| stiffness);
        if let Some(stiffness) = stiffness {
            expect_length("changed displacements of a shared stiffness", 0, self.grid.changed.len())?;
            expect_length("contact nodes of a shared stiffness", stiffness.contacts, self.grid.contacts.len())?;
        }
        let layout = Layout::new(&self.grid, a.order(), stiffness.map(|stiffness| &stiffness.numbering), ranks)?;
        let (smoother, motions) = (
            if self.grid.interior { UNSYMMETRIC } else { SYMMETRIC[usize::from(ranks > 1)] },
            layout.motions(&self.grid),
        );
        let setup = Setup {
            dimension: self.grid.dimension,
            options: [direct::OPTIONS, OPTIONS, smoother, self.options.as_deref().unwrap_or("")].join(" "),
            rows: layout.rows.clone(),
            displacements: layout.displacements,
            motions: motions.len(),
            stiffness: stiffness.map(|stiffness| stiffness.rows.0),
        };
        let mut rest = layout.entries(a);
        rest.values.fill(0.0);
        let own =
            Own { places: layout.places.clone(), motions, shares: layout.shares(&self.grid), rest, ..Own::default() };
        let remote = Remote::new(Job::System(setup), own)?;
        let (pattern, present) = (Arc::clone(a.pattern()), Default::default());
        self.system = Some(System { remote, layout, pattern, present, held: None, reused: false, gave_way: false });
        Ok(())
    }

    fn factorize(&mut self, values: &[f64]) -> Result<FactorInfo, LinearError> {
        let Some(System { pattern, .. }) = &self.system else { return Err(crate::NOT_ANALYZED) };
        expect_length("values", pattern.len(), values.len())?;
        let a = Csc::new(Arc::clone(pattern), values.to_vec()).map_err(|_| LinearError::PatternChanged)?;
        self.factorize_system(&SystemMatrix::from(a))
    }

    fn factorize_system(&mut self, a: &SystemMatrix) -> Result<FactorInfo, LinearError> {
        let a = &*compressed(a)?;
        let (system, oblique) = (self.system.as_mut().ok_or(crate::NOT_ANALYZED)?, self.grid.interior);
        expect_length("columns of the matrix", system.pattern.columns(), a.order())?;
        expect_length("values", system.pattern.len(), a.pattern().len())?;
        let nodes = system.layout.nodes(a, oblique);
        system.present =
            (nodes.iter().map(|node| node.held).collect(), system.layout.contact(&nodes, self.grid.dimension));
        let rest = system.layout.entries(a).values;
        system.prepare(Some(shared(a).map_or(1.0, |(_, factor)| factor)), &rest, oblique)
    }

    fn iterates(&self) -> bool {
        self.system.as_ref().is_none_or(|system| !system.gave_way)
    }

    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        self.solve_to(TIGHT, b, x)
    }

    fn solve_to(&mut self, tolerance: f64, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        let tolerance = if self.grid.dimension == 2 { tolerance.min(TIGHT) } else { tolerance };
        let mut found = self.iterate(b, x, tolerance)?;
        while let (Some(system), ..=0) = (&mut self.system, found.1) {
            // The reused cycle converges too slowly; make a new one for this matrix.
            if !system.reused {
                if self.options.is_some() || system.gave_way {
                    return Err(not_converged(found));
                }
                // The iterations stall, so a factorisation shared among ranks, which adds the least memory, takes over.
                system.gave_way = true;
                self.iterated.instead = Some(SparseLu::Mumps);
            }
            system.held = None;
            system.prepare(None, &[], self.grid.interior)?;
            found = self.iterate(b, x, tolerance)?;
        }
        Ok(())
    }

    fn iterated(&mut self) -> Iterated {
        std::mem::take(&mut self.iterated)
    }
}

/// Returns the error of a solve that ended in this way, with the option that helps.
fn not_converged((iterations, reason): (usize, i32)) -> LinearError {
    let (why, help) = match reason {
        -3 => ("it did not converge", "allow more iterations by -ksp_max_it, or take another -pc_type"),
        -11 => ("the preconditioner failed", "take another -pc_type, or -contact_pc_type for the multigrid in it"),
        -9 | -4 => ("it diverged", "take another -contact_mg_levels_pc_type or -pc_type"),
        _ => ("it broke down", "take another -ksp_type or -pc_type"),
    };
    let reason = format!("{why} in {iterations} iterations (reason {reason})");
    LinearError::Engine { engine: "PETSc", step: "the solve", reason, help, of_options: false }
}

#[cfg(test)]
mod exact;
#[cfg(test)]
mod same;
