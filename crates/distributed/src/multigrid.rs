//! GMRES of PETSc on the uncondensed system, preconditioned by multigrid including contact: for bodies too large for a
//! factorisation.
//!
//! Contact is eliminated exactly, node by node, on a matrix with the pattern of `K` (`node`, `layout`), and one cycle
//! of algebraic multigrid on it preconditions the whole Newton system (`crate::system`). The number of iterations is
//! independent of the mesh, the contact statuses and the friction. Exceptions are nearly incompressible materials and
//! meshes graded in two directions at once, for which MUMPS takes over.

mod layout;
mod node;
mod small;

use std::any::Any;
use std::sync::Arc;

use stickslip::algebra::linear::{
    FactorInfo, Grid, Iterated, LinearError, LinearSolver, SparseLu, Stiffness, SystemMatrix,
};
use stickslip::algebra::{Csc, Pattern};

use crate::job::{Job, Own, Remote};
use crate::petsc::Found;
use crate::stiffness::SharedStiffness;
use crate::system::{By, Change, Contact, Places, Setup, Values, factorize, solve};
use crate::{direct, expect_length, ranks};
use layout::Layout;
use node::Eliminated;

/// The number of iterations beyond which a direct solver is faster.
const MAX_ITERATIONS: usize = 60;
/// The default relative residual; refinement does the rest. It is that of all solves in the plane, where inexact steps
/// cost more Newton iterations than they save of the Krylov method, and of the last steps: those that may leave less
/// than `LAST`.
const TIGHT: f64 = 1e-10;
const LAST: f64 = 1e-4;
/// A cycle is reused if the share of contact nodes with more or fewer constrained directions is below this.
const CHANGED: f64 = 0.1;
/// A cycle is not reused if it takes this many times its initial iterations per digit.
const WORN: f64 = 1.6;
/// The number of iterations that take as long as making a cycle.
const SET_UP: f64 = 20.0;

/// Options of PETSc for all systems, before those of the user; MUMPS, if the user takes it, needs room for pivots that
/// it delays.
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
    stiffness: Option<SharedStiffness>,
    system: Option<System>,
    /// One cycle for the matrix with all contact nodes clamped, which recurs in every increment, and one for the
    /// others.
    cycles: Vec<Cycle>,
    /// `true` once PETSc has asked for all of them.
    is_checked: bool,
    /// `true` once MUMPS has taken over.
    gave_way: bool,
    /// The iterations since the last query.
    iterated: Iterated,
}

/// The systems of one pattern.
struct System {
    remote: Remote,
    layout: Layout,
    order: usize,
    pattern: Arc<Pattern>,
    /// The contact nodes of the present matrix, and its cycle.
    present: Option<(Vec<Eliminated>, Contact, bool)>,
}

/// A cycle with the contact for which it was made.
struct Cycle {
    held: Vec<usize>,
    /// `true` if all contact nodes are clamped, as in the response to a change of the loads without slip or opening.
    all_held: bool,
    /// The iterations per digit of its first matrix.
    rate: Option<f64>,
    worn: bool,
    /// `true` if the present matrix is not its own.
    reused: bool,
}

impl Cycle {
    fn serves(&self, nodes: &[Eliminated]) -> bool {
        let changed = self.held.iter().zip(nodes).filter(|(held, node)| **held != node.held).count();
        !self.worn && changed as f64 <= CHANGED * nodes.len() as f64
    }

    /// Returns the iteration limit for a reused cycle, beyond which a new one is cheaper.
    fn patience(&self, tolerance: f64) -> usize {
        let digits = (-tolerance.log10()).max(1.0);
        let rate = self.rate.filter(|_| self.reused);
        rate.map_or(MAX_ITERATIONS, |rate| ((rate * digits + SET_UP).ceil() as usize).min(MAX_ITERATIONS))
    }

    /// Records the number of iterations and the digits gained.
    fn took(&mut self, iterations: usize, tolerance: f64) {
        let rate = iterations as f64 / (-tolerance.log10()).max(1.0);
        let first = *self.rate.get_or_insert(rate);
        self.worn |= rate > WORN * first;
    }
}

impl Multigrid {
    /// Creates a solver for systems with this stiffness and grid, with `options` of PETSc's.
    pub(crate) fn new(stiffness: &Stiffness, grid: Grid, options: Option<&str>) -> Self {
        let shared = stiffness.distributed().and_then(|k| (k as &dyn Any).downcast_ref::<SharedStiffness>());
        Multigrid {
            grid,
            options: options.map(str::to_string),
            is_checked: false,
            stiffness: shared.cloned(),
            system: None,
            cycles: Vec::new(),
            gave_way: false,
            iterated: Iterated::default(),
        }
    }

    /// Returns the shared stiffness, if it is that of `a`.
    fn shared(&self, a: &SystemMatrix) -> Option<&SharedStiffness> {
        self.stiffness.as_ref().filter(|_| a.distributed().is_some())
    }

    /// Returns `true` if a block of `a` must be converted to compressed columns.
    fn must_be_compressed(&self, a: &SystemMatrix) -> bool {
        (a.leading().is_some() || a.distributed().is_some()) && self.shared(a).is_none()
    }

    /// Passes the values of the present matrix on, `factor` times the stiffness and `others`, or leaves them without a
    /// factor, with its cycle or a new one.
    fn prepare(&mut self, factor: Option<f64>, others: [&[f64]; 2]) -> Result<FactorInfo, LinearError> {
        let System { remote, present, .. } = self.system.as_mut().ok_or(crate::NOT_ANALYZED)?;
        let [stiffness, rest] = others;
        if self.gave_way {
            let values = Values { stiffness, rest, contact: None };
            return factorize(remote, Change { factor, by: By::Factors }, values);
        }
        let Some((nodes, contact, all_held)) = present else { return Err(crate::NOT_FACTORIZED) };
        // In the oblique form the swept terms differ from matrix to matrix.
        let unsymmetric = self.grid.interior;
        let serving = self.cycles.iter_mut().find(|cycle| !unsymmetric && cycle.serves(nodes));
        let (fresh, cycle) = (serving.is_none(), serving.as_ref().map_or(*all_held, |cycle| cycle.all_held));
        *all_held = cycle;
        match serving {
            Some(serving) => serving.reused = true,
            None => self.cycles.retain(|other| other.all_held != cycle),
        }
        let by = By::Options { cycle: cycle.into(), fresh, unsymmetric };
        let info = factorize(remote, Change { factor, by }, Values { stiffness, rest, contact: Some(contact) })?;
        if fresh {
            let held = nodes.iter().map(|node| node.held).collect();
            self.cycles.push(Cycle { held, all_held: cycle, rate: None, worn: false, reused: false });
        }
        Ok(info)
    }

    /// Solves with the present cycle. Returns PETSc's end, and `true` if a new cycle might help.
    fn iterate(&mut self, b: &[f64], x: &mut [f64], tolerance: f64) -> Result<(Found, bool), LinearError> {
        let System { remote, order, present, .. } = self.system.as_ref().ok_or(crate::NOT_ANALYZED)?;
        expect_length("right-hand side", *order, b.len())?;
        expect_length("solution", *order, x.len())?;
        if self.gave_way {
            return Ok((solve(remote, tolerance, None, b, x)?, false));
        }
        let Some((_, _, all_held)) = present else { return Err(crate::NOT_FACTORIZED) };
        let cycle = self.cycles.iter_mut().find(|cycle| cycle.all_held == *all_held).ok_or(crate::NOT_FACTORIZED)?;
        let limit = cycle.patience(tolerance);
        let limit = (self.options.is_none() || cycle.reused).then_some(limit);
        let found = solve(remote, tolerance, limit, b, x)?;
        self.iterated.iterations += found.iterations;
        cycle.took(found.iterations, if found.reason > 0 { tolerance } else { 0.1 });
        if let (Some(options), false) = (&self.options, self.is_checked) {
            ranks::check_options(options)?;
            self.is_checked = true;
        }
        Ok((found, cycle.reused))
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
        if self.must_be_compressed(a) {
            return self.analyze(a.to_csc()?.pattern());
        }
        (self.system, self.gave_way) = (None, false);
        self.cycles.clear();
        let ranks = ranks::start()?.1;
        let shared = self.shared(a);
        let changed = shared.map_or(0, |_| self.grid.changed.len());
        expect_length("changed displacements of a shared stiffness", 0, changed)?;
        let layout = Layout::new(&self.grid, a.order(), shared.map(|shared| &**shared.numbering()), ranks)?;
        let smoother = if self.grid.interior { UNSYMMETRIC } else { SYMMETRIC[usize::from(ranks > 1)] };
        let ([stiffness, rest], _) = layout.entries(a, shared.is_some());
        let motions = layout.motions(&self.grid);
        let setup = Setup {
            dimension: layout.dimension,
            options: [direct::OPTIONS, OPTIONS, smoother, self.options.as_deref().unwrap_or("")].join(" "),
            nodes: layout.nodes.clone(),
            rows: layout.rows.clone(),
            motions: motions.len(),
            stiffness: shared.map(SharedStiffness::number),
        };
        let places = Places { rows: &layout.places, motions, stiffness, rest };
        let remote = Remote::new(Job::System(setup), Own { places, ..Own::default() })?;
        let pattern = Arc::clone(a.pattern());
        self.system = Some(System { remote, layout, order: a.order(), pattern, present: None });
        Ok(())
    }

    fn factorize(&mut self, values: &[f64]) -> Result<FactorInfo, LinearError> {
        let Some(System { pattern, .. }) = &self.system else { return Err(crate::NOT_ANALYZED) };
        expect_length("values", pattern.len(), values.len())?;
        let a = Csc::new(Arc::clone(pattern), values.to_vec()).map_err(|_| LinearError::PatternChanged)?;
        self.factorize_system(&SystemMatrix::from(a))
    }

    fn factorize_system(&mut self, a: &SystemMatrix) -> Result<FactorInfo, LinearError> {
        if self.must_be_compressed(a) {
            let whole = SystemMatrix::from(a.to_csc()?.into_owned());
            return self.factorize_system(&whole);
        }
        let oblique = self.grid.interior;
        let factor = self.shared(a).and(a.distributed()).map(|(_, factor)| factor);
        let System { layout, order, pattern, present, .. } = self.system.as_mut().ok_or(crate::NOT_ANALYZED)?;
        expect_length("columns of the matrix", *order, a.order())?;
        expect_length("values", pattern.len(), a.rest().values().len())?;
        let nodes = layout.nodes(a, oblique);
        let all_held = nodes.iter().all(|node| node.all_held);
        *present = Some((nodes.clone(), layout.contact(&nodes), all_held));
        let (_, [stiffness, rest]) = layout.entries(a, factor.is_some());
        self.prepare(Some(factor.unwrap_or(1.0)), [&stiffness, &rest])
    }

    fn iterates(&self) -> bool {
        !self.gave_way
    }

    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        self.solve_to(TIGHT, b, x)
    }

    fn solve_to(&mut self, tolerance: f64, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        let is_tight = self.grid.dimension == 2 || tolerance < LAST;
        let tolerance = if is_tight { tolerance.min(TIGHT) } else { tolerance };
        let (mut found, reused) = self.iterate(b, x, tolerance)?;
        if found.reason <= 0 && reused {
            // The reused cycle converges too slowly; make a new one for this matrix.
            self.cycles.clear();
            self.prepare(None, [&[], &[]])?;
            found = self.iterate(b, x, tolerance)?.0;
        }
        if found.reason > 0 {
            return Ok(());
        }
        if self.options.is_some() || self.gave_way {
            return Err(not_converged(found));
        }
        // The iterations stall, so a factorisation shared among ranks, which adds the least memory, takes over.
        self.gave_way = true;
        self.cycles.clear();
        self.prepare(None, [&[], &[]])?;
        self.iterated.instead = Some(SparseLu::Mumps);
        let (found, _) = self.iterate(b, x, tolerance)?;
        if found.reason > 0 { Ok(()) } else { Err(not_converged(found)) }
    }

    fn iterated(&mut self) -> Iterated {
        std::mem::take(&mut self.iterated)
    }
}

/// Returns the error of a solve that ended in this way, with the option that helps.
fn not_converged(found: Found) -> LinearError {
    let Found { iterations, reason } = found;
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
