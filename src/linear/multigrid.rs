//! GMRES on the uncondensed system, with contact inside multigrid: for bodies too large to be factored.
//!
//! Contact is eliminated exactly, node by node, on a matrix `K̂` with the pattern of `K` (`node`, `stiffness`), and one cycle
//! of algebraic multigrid on `K̂` preconditions the whole Newton system. Iterations do not grow with the mesh, the contact statuses or the
//! friction; where they do, on matrices close to incompressible ones and meshes graded in two directions at once, a direct
//! solver takes over.

mod gmres;
mod grid;
mod hierarchy;
mod node;
mod small;
mod stiffness;

use std::sync::Arc;

use super::petsc::{Amg, Rows};
use super::{FactorInfo, Iterated, LinearError, LinearSolver, SparseLu};
use crate::sparse::Pattern;
pub use grid::{Contact, Grid};
use hierarchy::Hierarchy;
use node::Eliminated;
pub use stiffness::Form;
use stiffness::{Border, Layout};

/// Where more are needed a direct solver is faster.
const MOST_ITERATIONS: usize = 60;
/// The residual where nobody asks for less; refinement makes the rest.
const TIGHT: f64 = 1e-10;

/// The iterative solver.
pub struct Multigrid {
    grid: Grid,
    form: Form,
    pattern: Option<Arc<Pattern>>,
    layout: Option<Layout>,
    values: Vec<f64>,
    factored: Option<Factored>,
    /// One for the matrix in which all contact nodes are held, which comes again in every increment, and one for the others.
    hierarchies: Vec<Hierarchy>,
    make_cycle: MakeCycle,
    instead: Option<Box<dyn LinearSolver>>,
    /// What nobody has asked for yet.
    iterated: Iterated,
}

/// A matrix with its hierarchy.
struct Factored {
    nodes: Vec<Eliminated>,
    border: Vec<Border>,
    /// Which of the hierarchies serves.
    hierarchy: usize,
    work: Work,
}

/// What stands for the inverse of `K̂`.
trait Cycle: Send {
    /// `z` with `K̂ z ≈ r`.
    fn cycle(&mut self, r: &[f64], z: &mut [f64]) -> Result<(), LinearError>;
}

impl Cycle for Amg {
    fn cycle(&mut self, r: &[f64], z: &mut [f64]) -> Result<(), LinearError> {
        Amg::cycle(self, r, z)
    }
}

/// What makes it, from `K̂` and its rigid motions.
type MakeCycle = fn(Rows, Vec<Vec<f64>>) -> Result<Box<dyn Cycle>, LinearError>;

/// Vectors on all directions.
#[derive(Default)]
struct Work {
    rest: Vec<f64>,
    correction: Vec<f64>,
    displacements: Vec<f64>,
}

impl Multigrid {
    /// A solver for systems whose unknowns are where `grid` says.
    pub fn new(grid: Grid, form: Form) -> Self {
        Multigrid {
            grid,
            form,
            pattern: None,
            layout: None,
            values: Vec::new(),
            factored: None,
            hierarchies: Vec::new(),
            make_cycle: |rows, motions| Ok(Box::new(Amg::new(rows, motions)?)),
            instead: None,
            iterated: Iterated::default(),
        }
    }

    fn iterate(&mut self, b: &[f64], x: &mut [f64], tolerance: f64) -> Result<gmres::Found, LinearError> {
        let (Some(pattern), Some(layout)) = (&self.pattern, &self.layout) else {
            return Err(LinearError::Order { missing: "analyze" });
        };
        let Some(Factored { nodes, border, hierarchy, work }) = &mut self.factored else {
            return Err(LinearError::Order { missing: "factorize" });
        };
        let (grid, values, form) = (&self.grid, &self.values, self.form);
        let hierarchy = &mut self.hierarchies[*hierarchy];
        let product = |x: &[f64], y: &mut [f64]| {
            y.fill(0.0);
            let (starts, rows) = (pattern.column_starts(), pattern.row_indices());
            for (column, x) in x.iter().enumerate() {
                for slot in starts[column] as usize..starts[column + 1] as usize {
                    y[rows[slot] as usize] += values[slot] * x;
                }
            }
        };
        let precondition = |r: &[f64], z: &mut [f64]| apply(grid, layout, nodes, border, form, hierarchy, work, r, z);
        let found = gmres::solve(b, x, tolerance, MOST_ITERATIONS, product, precondition)?;
        self.iterated.iterations += found.iterations;
        hierarchy.took(found.iterations, found.residual);
        Ok(found)
    }
}

/// `z` with `A z ≈ r` on the whole system.
fn apply(
    grid: &Grid,
    layout: &Layout,
    nodes: &[Eliminated],
    border: &[Border],
    form: Form,
    hierarchy: &mut Hierarchy,
    work: &mut Work,
    r: &[f64],
    z: &mut [f64],
) -> Result<(), LinearError> {
    let (n_u, d) = (layout.displacements, layout.dimension);
    let Work { rest, correction, displacements } = work;
    rest.clear();
    rest.resize(layout.order(), 0.0);
    correction.clear();
    correction.resize(layout.order(), 0.0);
    // Equilibrium, in the frames.
    displacements.clear();
    displacements.extend_from_slice(&r[..n_u]);
    grid.residual_from_mesh(displacements);
    layout.place.iter().zip(&*displacements).for_each(|(&(node, direction), r)| rest[node * d + direction] = *r);
    let rows = |forces: &[Option<usize>; 3]| forces.map(|place| place.map_or(0.0, |place| r[place]));
    let mut held: Vec<[f64; 3]> = Vec::with_capacity(layout.contacts.len());
    let mut lacking: Vec<[f64; 3]> = Vec::with_capacity(layout.contacts.len());
    for (&(node, forces), eliminated) in layout.contacts.iter().zip(nodes) {
        let own = eliminated.into_frame(vector(rest, node, d));
        lacking.push(own);
        put(rest, node, d, own);
        held.push(eliminated.prescribed(rows(&forces)));
    }
    // Held displacements, and the forces that follow them, go to the right-hand side.
    for (i, (&(node, forces), eliminated)) in layout.contacts.iter().zip(nodes).enumerate() {
        let following = eliminated.on_equilibrium(eliminated.following(rows(&forces), held[i]));
        let mut own = vector(rest, node, d);
        own.iter_mut().zip(following).for_each(|(own, f)| *own -= f);
        put(rest, node, d, own);
    }
    for (i, &(node, _)) in layout.contacts.iter().enumerate() {
        for (row, w) in border[i].iter().zip(held[i]).filter(|(_, w)| *w != 0.0) {
            for (k, &column) in layout.columns(node).iter().enumerate() {
                (0..d).for_each(|c| rest[column * d + c] -= row[k * d + c] * w);
            }
        }
    }
    // The free directions, by the cycle.
    for (&(node, _), eliminated) in layout.contacts.iter().zip(nodes) {
        let mut own = vector(rest, node, d);
        if form == Form::Oblique {
            let before = own;
            for (own, coupling) in own.iter_mut().zip(&eliminated.coupling) {
                *own -= (0..3).map(|j| coupling[j] * before[j]).sum::<f64>();
            }
        }
        let gone = eliminated.gone();
        put(rest, node, d, [0, 1, 2].map(|k| if gone[k] { 0.0 } else { own[k] }));
    }
    hierarchy.cycle(layout, nodes, rest, correction)?;
    for (i, (&(node, _), eliminated)) in layout.contacts.iter().zip(nodes).enumerate() {
        let (own, gone) = (vector(correction, node, d), eliminated.gone());
        put(correction, node, d, [0, 1, 2].map(|k| if gone[k] { held[i][k] } else { own[k] }));
    }
    // The forces, of which the reactions are what equilibrium lacks.
    for (i, (&(node, forces), eliminated)) in layout.contacts.iter().zip(nodes).enumerate() {
        let w = vector(correction, node, d);
        let following = eliminated.following(rows(&forces), w);
        let by_following = eliminated.on_equilibrium(following);
        let lacking = [0, 1, 2].map(|a| {
            let by_body: f64 = layout
                .columns(node)
                .iter()
                .enumerate()
                .flat_map(|(k, &column)| (0..d).map(move |c| (k * d + c, column * d + c)))
                .map(|(entry, at)| border[i][a][entry] * correction[at])
                .sum();
            lacking[i][a] - by_body - by_following[a]
        });
        let reactions = eliminated.reactions(lacking);
        for (k, place) in forces.into_iter().enumerate() {
            if let Some(place) = place {
                z[place] = following[k] + reactions[k];
            }
        }
    }
    for (&(node, _), eliminated) in layout.contacts.iter().zip(nodes) {
        let own = eliminated.out_of_frame(vector(correction, node, d));
        put(correction, node, d, own);
    }
    z[..n_u].iter_mut().zip(&layout.place).for_each(|(z, &(node, direction))| *z = correction[node * d + direction]);
    grid.to_mesh(&mut z[..n_u]);
    Ok(())
}

fn vector(all: &[f64], node: usize, d: usize) -> [f64; 3] {
    let mut v = [0.0; 3];
    v[..d].copy_from_slice(&all[node * d..(node + 1) * d]);
    v
}

fn put(all: &mut [f64], node: usize, d: usize, v: [f64; 3]) {
    all[node * d..(node + 1) * d].copy_from_slice(&v[..d]);
}

impl LinearSolver for Multigrid {
    fn name(&self) -> &'static str {
        "multigrid"
    }

    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<(), LinearError> {
        (self.factored, self.instead) = (None, None);
        self.hierarchies.clear();
        self.layout = Some(Layout::new(&self.grid, pattern)?);
        self.pattern = Some(Arc::clone(pattern));
        Ok(())
    }

    fn factorize(&mut self, values: &[f64]) -> Result<FactorInfo, LinearError> {
        let (Some(pattern), Some(layout)) = (&self.pattern, &self.layout) else {
            return Err(LinearError::Order { missing: "analyze" });
        };
        super::error::expect_length("values", pattern.len(), values.len())?;
        self.factored = None;
        self.values.clear();
        self.values.extend_from_slice(values);
        if let Some(instead) = &mut self.instead {
            return instead.factorize(values);
        }
        let nodes = layout.nodes(pattern, values);
        // In the oblique form what is swept out differs from matrix to matrix.
        let serves = |hierarchy: &Hierarchy| self.form == Form::Symmetric && hierarchy.serves(&nodes);
        let (hierarchy, border) = if let Some(serving) = self.hierarchies.iter().position(serves) {
            self.hierarchies[serving].lend();
            (serving, layout.border(pattern, values, &nodes))
        } else {
            // The old one goes before there is a new one.
            let all_held = hierarchy::all_held(&nodes);
            self.hierarchies.retain(|hierarchy| hierarchy.all_held != all_held);
            let stiffness = layout.stiffness(pattern, values, &nodes, self.form);
            let (rows, border) = stiffness.split(layout.dimension, self.form == Form::Symmetric);
            let cycle = (self.make_cycle)(rows, kernel(&self.grid, layout, &nodes))?;
            self.hierarchies.push(Hierarchy::new(cycle, &nodes));
            (self.hierarchies.len() - 1, border)
        };
        let entries = layout.entries();
        self.factored = Some(Factored { nodes, border, hierarchy, work: Work::default() });
        Ok(FactorInfo { entries, flops: 0.0, pivot_ratio: 1.0, peak_bytes: 0.0 })
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
        let found = self.iterate(b, x, tolerance)?;
        if found.residual <= tolerance {
            return Ok(());
        }
        // It stands still: what is left to do is done directly.
        let Some(pattern) = &self.pattern else { return Err(LinearError::Order { missing: "analyze" }) };
        let mut direct = SparseLu::default().solver();
        direct.analyze(pattern)?;
        direct.factorize(&self.values)?;
        direct.solve(b, x)?;
        self.factored = None;
        self.hierarchies.clear();
        self.iterated.gave_way = true;
        self.instead = Some(direct);
        Ok(())
    }

    fn iterated(&mut self) -> Iterated {
        std::mem::take(&mut self.iterated)
    }
}

/// The rigid motions in the frames, orthonormal.
fn kernel(grid: &Grid, layout: &Layout, nodes: &[Eliminated]) -> Vec<Vec<f64>> {
    let d = layout.dimension;
    let mut kernel: Vec<Vec<f64>> = Vec::new();
    for motion in grid.motions() {
        let mut all = vec![0.0; layout.order()];
        layout.place.iter().zip(&motion).for_each(|(&(node, direction), u)| all[node * d + direction] = *u);
        for (&(node, _), eliminated) in layout.contacts.iter().zip(nodes) {
            let own = eliminated.into_frame(vector(&all, node, d));
            put(&mut all, node, d, own);
        }
        let norm = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let before = norm(&all);
        for _ in 0..2 {
            for other in &kernel {
                let share: f64 = other.iter().zip(&all).map(|(a, b)| a * b).sum();
                all.iter_mut().zip(other).for_each(|(v, other)| *v -= share * other);
            }
        }
        let size = norm(&all);
        if size > 1e-10 * before {
            all.iter_mut().for_each(|v| *v /= size);
            kernel.push(all);
        }
    }
    kernel
}

#[cfg(test)]
mod tests;
