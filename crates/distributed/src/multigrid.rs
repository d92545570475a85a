//! GMRES on the uncondensed system, preconditioned by multigrid including contact: for bodies too large for a
//! factorisation.
//!
//! Contact is eliminated exactly, node by node, on a matrix `K̂` with the pattern of `K` (`node`, `stiffness`), and
//! one cycle of algebraic multigrid on `K̂` preconditions the whole Newton system. The number of iterations is
//! independent of the mesh, the contact statuses and the friction. Exceptions are nearly incompressible materials and
//! meshes graded in two directions at once, for which a direct solver takes over.

mod block;
mod form;
mod gmres;
mod grid;
mod hierarchy;
mod node;
mod numbering;
mod piece;
mod precondition;
mod product;
mod rows;
mod shared;
mod small;
mod stiffness;

use std::any::Any;
use std::sync::Arc;

use super::petsc::Amg;
use super::ranks;
use crate::expect_length;
use block::Border;
use form::Form;
use hierarchy::{Cycle, Hierarchy, MakeCycle};
use node::Eliminated;
pub(super) use piece::Piece;
use precondition::{Elimination, Work, kernel};
use product::Product;
use shared::SharedStiffness;
pub(crate) use shared::share;
use stickslip::algebra::linear::{
    FactorInfo, Grid, Iterated, LinearError, LinearSolver, SparseLu, Stiffness, SystemMatrix,
};
use stickslip::algebra::{Csc, Pattern};
use stiffness::BlockLayout;

/// The number of iterations beyond which a direct solver is faster.
const MAX_ITERATIONS: usize = 60;
/// The default relative residual; refinement does the rest.
const TIGHT: f64 = 1e-10;

/// The iterative solver GMRES with algebraic multigrid.
pub(crate) struct Multigrid {
    grid: Grid,
    form: Form,
    /// The stiffness in its systems, if ranks share it.
    shared: Option<SharedStiffness>,
    matrix: Option<SystemMatrix>,
    layout: Option<BlockLayout>,
    /// The workspace of products.
    sums: Vec<Vec<f64>>,
    factored: Option<Factored>,
    /// One hierarchy for the matrix with all contact nodes clamped, which recurs in every increment, and one for the
    /// others.
    hierarchies: Vec<Hierarchy>,
    make_cycle: MakeCycle,
    instead: Option<Box<dyn LinearSolver>>,
    /// The iterations since the last query.
    iterated: Iterated,
}

/// A matrix with its hierarchy.
struct Factored {
    nodes: Vec<Eliminated>,
    border: Vec<Border>,
    /// The index of the hierarchy in use.
    hierarchy: usize,
    work: Work,
}

impl Multigrid {
    /// Creates a solver for systems whose unknowns have the positions in `grid`.
    pub fn new(grid: Grid, form: Form) -> Self {
        Multigrid {
            grid,
            form,
            shared: None,
            matrix: None,
            layout: None,
            sums: Vec::new(),
            factored: None,
            hierarchies: Vec::new(),
            make_cycle: |rows, motions, bounds| Ok(Box::new(Amg::new(rows, motions, bounds)?)),
            instead: None,
            iterated: Iterated::default(),
        }
    }

    /// Creates a solver for systems with this stiffness.
    pub(crate) fn of(stiffness: &Stiffness, grid: Grid) -> Self {
        let form = if grid.interior { Form::Oblique } else { Form::Symmetric };
        let shared = stiffness.distributed().and_then(|k| (k as &dyn Any).downcast_ref::<SharedStiffness>());
        Multigrid { shared: shared.cloned(), ..Self::new(grid, form) }
    }

    /// Returns `true` if the stiffness of `a` is a block that must be converted to compressed columns.
    fn must_be_compressed(&self, a: &SystemMatrix) -> bool {
        has_leading(a) && (self.shared.is_none() || a.distributed().is_none())
    }

    /// Returns `true` if the present matrix uses the hierarchy of another one.
    fn borrows(&self) -> bool {
        self.factored.as_ref().is_some_and(|factored| self.hierarchies[factored.hierarchy].lent)
    }

    fn iterate(&mut self, b: &[f64], x: &mut [f64], tolerance: f64) -> Result<gmres::Found, LinearError> {
        let (Some(matrix), Some(layout)) = (&self.matrix, &self.layout) else {
            return Err(LinearError::Order { missing: "analyze" });
        };
        let Some(Factored { nodes, border, hierarchy, work }) = &mut self.factored else {
            return Err(LinearError::Order { missing: "factorize" });
        };
        let elimination = Elimination { grid: &self.grid, layout, nodes, border, form: self.form };
        let hierarchy = &mut self.hierarchies[*hierarchy];
        let limit = hierarchy.patience(tolerance).min(MAX_ITERATIONS);
        let approximately = |r: &[f64], z: &mut [f64]| elimination.precondition(hierarchy, work, r, z);
        let found = if has_leading(matrix) {
            let times = |x: &[f64], y: &mut [f64]| {
                y.copy_from_slice(&matrix.times(x)?);
                Ok(())
            };
            gmres::solve(b, x, tolerance, limit, times, approximately)?
        } else {
            let mut product = Product::new(matrix.pattern(), matrix.rest().values(), &mut self.sums);
            let product = |x: &[f64], y: &mut [f64]| {
                product.times(x, y);
                Ok(())
            };
            gmres::solve(b, x, tolerance, limit, product, approximately)?
        };
        self.iterated.iterations += found.iterations;
        hierarchy.took(found.iterations, found.residual);
        Ok(found)
    }
}

impl Multigrid {
    /// Eliminates contact from the present matrix, and selects or builds a hierarchy.
    fn prepare(&mut self) -> Result<FactorInfo, LinearError> {
        let (Some(matrix), Some(layout)) = (&self.matrix, &self.layout) else {
            return Err(LinearError::Order { missing: "analyze" });
        };
        self.factored = None;
        if let Some(instead) = &mut self.instead {
            return instead.factorize_system(matrix);
        }
        let nodes = layout.nodes(matrix, self.form);
        // In the oblique form the swept terms differ from matrix to matrix.
        let serves = |hierarchy: &Hierarchy| self.form == Form::Symmetric && hierarchy.serves(&nodes);
        let (hierarchy, border) = if let Some(serving) = self.hierarchies.iter().position(serves) {
            self.hierarchies[serving].lend();
            (serving, layout.border(matrix, &nodes))
        } else {
            // The old hierarchy is dropped before a new one is built.
            let all_held = hierarchy::all_held(&nodes);
            self.hierarchies.retain(|hierarchy| hierarchy.all_held != all_held);
            let kernel = kernel(&self.grid, layout, &nodes);
            let (cycle, border) = if let Some(shared) = self.shared.as_ref().filter(|_| has_leading(matrix)) {
                let cycle = shared.cycle(&layout.state(matrix, &nodes, self.form), &kernel)?;
                (Box::new(cycle) as Box<dyn Cycle>, layout.border(matrix, &nodes))
            } else {
                let (rows, border) = layout.stiffness(matrix, &nodes, self.form)?;
                ((self.make_cycle)(rows, kernel, &layout.bounds())?, border)
            };
            self.hierarchies.push(Hierarchy::new(cycle, &nodes));
            (self.hierarchies.len() - 1, border)
        };
        let entries = layout.entries();
        self.factored = Some(Factored { nodes, border, hierarchy, work: Work::default() });
        Ok(FactorInfo { entries, flops: 0.0, pivot_ratio: 1.0, peak_bytes: 0.0 })
    }
}

/// Returns `true` if there is a block besides the compressed columns.
fn has_leading(a: &SystemMatrix) -> bool {
    a.leading().is_some() || a.distributed().is_some()
}

impl LinearSolver for Multigrid {
    fn name(&self) -> &'static str {
        "multigrid"
    }

    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<(), LinearError> {
        self.analyze_system(&SystemMatrix::from(Csc::zeros(Arc::clone(pattern))))
    }

    fn analyze_system(&mut self, a: &SystemMatrix) -> Result<(), LinearError> {
        if self.must_be_compressed(a) {
            return self.analyze(a.to_csc()?.pattern());
        }
        (self.factored, self.instead) = (None, None);
        self.hierarchies.clear();
        let shared = self.shared.as_ref().filter(|_| has_leading(a));
        let layout = BlockLayout::new(&self.grid, a, shared)?;
        self.layout = Some(if shared.is_some() { layout } else { layout.shared_among(ranks::count())? });
        self.matrix = Some(a.clone());
        Ok(())
    }

    fn factorize(&mut self, values: &[f64]) -> Result<FactorInfo, LinearError> {
        let Some(matrix) = &mut self.matrix else { return Err(LinearError::Order { missing: "analyze" }) };
        expect_length("values", matrix.pattern().len(), values.len())?;
        matrix.rest_mut().values_mut().copy_from_slice(values);
        self.prepare()
    }

    fn factorize_system(&mut self, a: &SystemMatrix) -> Result<FactorInfo, LinearError> {
        if self.must_be_compressed(a) {
            return self.factorize(a.to_csc()?.values());
        }
        self.factorize(a.rest().values())
    }

    fn iterates(&self) -> bool {
        self.instead.is_none()
    }

    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        self.solve_to(TIGHT, b, x)
    }

    fn solve_to(&mut self, tolerance: f64, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        if let Some(instead) = &mut self.instead {
            return instead.solve(b, x);
        }
        let mut found = self.iterate(b, x, tolerance)?;
        if found.residual > tolerance && self.borrows() {
            // The reused hierarchy converges too slowly; build a new one for this matrix.
            self.prepare()?;
            found = self.iterate(b, x, tolerance)?;
        }
        if found.residual <= tolerance {
            return Ok(());
        }
        // The iterations stall, so a direct solver finishes the solve.
        let Some(matrix) = &self.matrix else { return Err(LinearError::Order { missing: "analyze" }) };
        self.factored = None;
        self.hierarchies.clear();
        // Rank 0 now needs the whole matrix; a factorisation shared among ranks adds the least memory.
        let lu = SparseLu::for_ranks();
        let mut direct = lu.solver();
        direct.analyze_system(matrix)?;
        direct.factorize_system(matrix)?;
        direct.solve(b, x)?;
        self.iterated.instead = Some(lu);
        self.instead = Some(direct);
        Ok(())
    }

    fn iterated(&mut self) -> Iterated {
        std::mem::take(&mut self.iterated)
    }
}

#[cfg(test)]
mod exact;
#[cfg(test)]
mod same;
