//! A multigrid hierarchy, which serves for other matrices than its own: setting one up takes as long as twenty iterations.

use super::node::Eliminated;
use super::shared::SharedCycle;
use super::small::{on, put, transposed_on, vector};
use super::stiffness::BlockLayout;
use crate::algebra::linear::LinearError;
use crate::algebra::linear::petsc::{Amg, Rows};

/// What stands for the inverse of `K̂`.
pub(super) trait Cycle: Send {
    /// `z` with `K̂ z ≈ r`.
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

/// What makes it, from `K̂`, its rigid motions, and which rows are of which rank.
pub(super) type MakeCycle = fn(Rows, Vec<Vec<f64>>, &[usize]) -> Result<Box<dyn Cycle>, LinearError>;

/// Where the share of contact nodes that are held in more or fewer directions is below this, a hierarchy still serves.
const CHANGED: f64 = 0.1;
/// With so many times the iterations for a digit that it took at first, it does not.
const WORN: f64 = 1.6;

/// To set one up takes as long as so many iterations.
const SET_UP: f64 = 20.0;

/// A hierarchy with the frames in which it was set up.
pub(super) struct Hierarchy {
    cycle: Box<dyn Cycle>,
    nodes: Vec<Eliminated>,
    /// Whether all contact nodes are held, as in what answers a change of the loads while nothing slips or opens.
    pub(super) all_held: bool,
    /// Iterations for a digit of its first matrix.
    rate: Option<f64>,
    worn: bool,
    /// Whether the present matrix is another than its own.
    pub(super) lent: bool,
    rest: Vec<f64>,
}

fn directions(node: &Eliminated) -> usize {
    node.held.iter().filter(|held| **held).count()
}

/// Whether contact holds every node in every direction that supports leave.
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

    /// Whether it serves for a matrix with the contact `nodes`.
    pub(super) fn serves(&self, nodes: &[Eliminated]) -> bool {
        let changed = self.nodes.iter().zip(nodes).filter(|(own, other)| directions(own) != directions(other)).count();
        !self.worn && changed as f64 <= CHANGED * nodes.len() as f64
    }

    /// Lends it to another matrix than its own.
    pub(super) fn lend(&mut self) {
        self.lent = true;
    }

    /// After how many iterations to `tolerance` a matrix that borrows it had better have had one of its own.
    pub(super) fn patience(&self, tolerance: f64) -> usize {
        let digits = (-tolerance.log10()).max(1.0);
        self.rate.filter(|_| self.lent).map_or(usize::MAX, |rate| (rate * digits + SET_UP).ceil() as usize)
    }

    /// Takes notice of how many iterations so many digits took.
    pub(super) fn took(&mut self, iterations: usize, residual: f64) {
        let rate = iterations as f64 / (-residual.log10()).max(1.0);
        let first = *self.rate.get_or_insert(rate);
        self.worn |= rate > WORN * first;
    }

    /// One cycle for the present matrix, whose frames are those of `nodes`.
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
