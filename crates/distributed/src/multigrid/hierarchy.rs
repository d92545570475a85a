//! A multigrid hierarchy, which is reused for other matrices: building one takes as long as twenty iterations.

use super::node::Eliminated;
use super::shared::SharedCycle;
use super::small::{on, put, transposed_on, vector};
use super::stiffness::BlockLayout;
use crate::petsc::{Amg, Rows};
use stickslip::algebra::linear::LinearError;

/// An approximate inverse of `K̂`.
pub(super) trait Cycle: Send {
    /// Computes `z` with `K̂ z ≈ r`.
    fn cycle(&mut self, r: &[f64], z: &mut [f64]) -> Result<(), LinearError>;
}

impl Cycle for Amg {
    fn cycle(&mut self, r: &[f64], z: &mut [f64]) -> Result<(), LinearError> {
        Amg::cycle(self, r, z)
    }
}

impl Cycle for SharedCycle {
    fn cycle(&mut self, r: &[f64], z: &mut [f64]) -> Result<(), LinearError> {
        SharedCycle::cycle(self, r, z)
    }
}

/// A constructor from `K̂`, its rigid modes, and the row bounds of the ranks.
pub(super) type MakeCycle = fn(Rows, Vec<Vec<f64>>, &[usize]) -> Result<Box<dyn Cycle>, LinearError>;

/// A hierarchy is reused if the share of contact nodes with more or fewer constrained directions is below this.
const CHANGED: f64 = 0.1;
/// A hierarchy is not reused if it takes this many times its initial iterations per digit.
const WORN: f64 = 1.6;

/// The number of iterations that take as long as building a hierarchy.
const SET_UP: f64 = 20.0;

/// A hierarchy with the frames for which it was built.
pub(super) struct Hierarchy {
    cycle: Box<dyn Cycle>,
    nodes: Vec<Eliminated>,
    /// `true` if all contact nodes are clamped, as in the response to a change of the loads without slip or opening.
    pub(super) all_held: bool,
    /// The iterations per digit of its first matrix.
    rate: Option<f64>,
    worn: bool,
    /// `true` if the present matrix is not its own.
    pub(super) lent: bool,
    rest: Vec<f64>,
}

fn directions(node: &Eliminated) -> usize {
    node.held.iter().filter(|held| **held).count()
}

/// Returns `true` if contact constrains every node in every direction that supports leave.
pub(super) fn all_held(nodes: &[Eliminated]) -> bool {
    nodes.iter().all(|node| node.gone() == [true; 3])
}

impl Hierarchy {
    pub(super) fn new(cycle: Box<dyn Cycle>, nodes: &[Eliminated]) -> Self {
        Hierarchy {
            cycle,
            nodes: nodes.to_vec(),
            all_held: all_held(nodes),
            rate: None,
            worn: false,
            lent: false,
            rest: Vec::new(),
        }
    }

    /// Returns `true` if the hierarchy can be reused for a matrix with the contact `nodes`.
    pub(super) fn serves(&self, nodes: &[Eliminated]) -> bool {
        let changed = self.nodes.iter().zip(nodes).filter(|(own, other)| directions(own) != directions(other)).count();
        !self.worn && changed as f64 <= CHANGED * nodes.len() as f64
    }

    /// Marks the hierarchy as used for another matrix.
    pub(super) fn lend(&mut self) {
        self.lent = true;
    }

    /// Returns the iteration limit for a reused hierarchy, beyond which rebuilding is cheaper.
    pub(super) fn patience(&self, tolerance: f64) -> usize {
        let digits = (-tolerance.log10()).max(1.0);
        self.rate.filter(|_| self.lent).map_or(usize::MAX, |rate| (rate * digits + SET_UP).ceil() as usize)
    }

    /// Records the number of iterations and the digits gained.
    pub(super) fn took(&mut self, iterations: usize, residual: f64) {
        let rate = iterations as f64 / (-residual.log10()).max(1.0);
        let first = *self.rate.get_or_insert(rate);
        self.worn |= rate > WORN * first;
    }

    /// Applies one cycle for the present matrix, whose frames are those of `nodes`.
    pub(super) fn cycle(
        &mut self,
        layout: &BlockLayout,
        nodes: &[Eliminated],
        r: &[f64],
        z: &mut [f64],
    ) -> Result<(), LinearError> {
        if !self.lent {
            return self.cycle.cycle(r, z);
        }
        let d = layout.dimension;
        self.rest.clear();
        self.rest.extend_from_slice(r);
        let frames = || layout.contacts.iter().zip(self.nodes.iter().zip(nodes));
        for (&(node, _), (own, present)) in frames() {
            let turned = transposed_on(&own.frame, on(&present.frame, vector(r, node, d)));
            put(&mut self.rest, node, d, turned);
        }
        self.cycle.cycle(&self.rest, z)?;
        for (&(node, _), (own, present)) in frames() {
            let turned = transposed_on(&present.frame, on(&own.frame, vector(z, node, d)));
            put(z, node, d, turned);
        }
        Ok(())
    }
}
