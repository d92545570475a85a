//! The numbering of the free displacements.

use std::collections::BTreeMap;

use super::reference_point::{Jump, ReferencePoint};
use super::relative::Relative;
use crate::algebra::vector::{axis, axis_across, cross, dot, minus, norm, unit};
use crate::body::mesh::{Geometry, Mesh};

/// Three orthogonal directions, the axes of the displacement components of a node.
type Frame = [[f64; 3]; 3];

/// The numbering of the unknown displacement components. Supported components are eliminated and have no number.
///
/// The components of a node are along the coordinate axes, except at a node with an oblique support: its frame is
/// turned so that the held directions are axes of the frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Dofs {
    dimension: usize,
    /// The number of nodes of the mesh; the two nodes of each reference point and the node of each jump follow.
    pub(super) of_mesh: usize,
    /// The reference points.
    pub(super) points: Vec<ReferencePoint>,
    /// The jumps of glued pairs.
    pub(super) jumps: Vec<Jump>,
    /// The numbers of the components, node by node.
    numbers: Vec<Option<usize>>,
    /// For each component: `true` if supports hold it.
    held: Vec<bool>,
    /// The frames that differ from the coordinate axes.
    frames: BTreeMap<usize, Frame>,
    /// The nodes whose unknowns are relative to other nodes.
    pub(super) relative: BTreeMap<usize, Relative>,
    /// The relative nodes, each after the nodes that it is relative to.
    pub(super) relative_order: Vec<usize>,
    /// The rows of `T` beyond the own unknown, for the free components of relative nodes.
    pub(super) beyond: BTreeMap<usize, Vec<(usize, f64)>>,
    free: usize,
}

/// A unit vector counts as dependent on others if its remainder after projection is at most this long.
pub const SAME_DIRECTION: f64 = 1e-9;

/// A component of a unit vector along an axis of an oblique frame counts as rounding if it is at most this.
const AXIS_ROUNDING: f64 = 1e-14;

impl Dofs {
    /// Numbers, node by node, all components for which `fixed(node, component)` is `false`.
    pub fn new(mesh: &Mesh, fixed: impl Fn(usize, usize) -> bool) -> Self {
        let axes = |node: usize| (0..mesh.dimension).filter(|&c| fixed(node, c)).map(axis).collect();
        Self::with_points(mesh, Vec::new(), Vec::new(), axes)
    }

    /// Numbers the free components of each node, of the two nodes of each of `points` and of the node of each of `jumps`,
    /// which follow those of the mesh.
    ///
    /// Each node is held along the directions `held`: unit vectors, in two dimensions in the plane. Dependent directions
    /// are ignored. Nodes on the axis of a body of revolution are also held along x, and its points and jumps move along
    /// the axis only.
    pub fn with_points(
        mesh: &Mesh,
        points: Vec<ReferencePoint>,
        jumps: Vec<Jump>,
        mut held: impl FnMut(usize) -> Vec<[f64; 3]>,
    ) -> Self {
        let dimension = mesh.dimension;
        let mut dofs = Dofs {
            dimension,
            of_mesh: mesh.nodes.len(),
            points,
            jumps,
            numbers: Vec::new(),
            held: Vec::new(),
            frames: BTreeMap::new(),
            relative: BTreeMap::new(),
            relative_order: Vec::new(),
            beyond: BTreeMap::new(),
            free: 0,
        };
        for node in 0..dofs.node_of_jump(dofs.jumps.len()) {
            let mut held = held(node);
            let of_mesh = node < dofs.of_mesh;
            if if of_mesh { mesh.is_on_axis(node) } else { mesh.geometry == Geometry::Axisymmetric } {
                held.push(axis(0));
            }
            if dimension == 2 && dofs.is_rotation(node) {
                held.push(axis(1));
            }
            let held = independent(held, dimension);
            let along_axis = |n: &[f64; 3]| n.iter().filter(|c| **c != 0.0).count() == 1;
            let fixed = if held.len() == dimension || held.iter().all(along_axis) {
                [0, 1, 2].map(|c| held.len() == dimension || held.iter().any(|n| n[c] != 0.0))
            } else {
                let (frame, fixed) = turned(&held, dimension);
                dofs.frames.insert(node, frame);
                fixed
            };
            dofs.held.extend(&fixed[..dimension]);
        }
        dofs.number();
        dofs
    }

    /// Numbers the components that are not held, except those of tied nodes.
    pub(super) fn number(&mut self) {
        (self.numbers, self.free) = (Vec::with_capacity(self.held.len()), 0);
        for (k, held) in self.held.iter().enumerate() {
            let counts = !held && !self.relative.get(&(k / self.dimension)).is_some_and(|relative| relative.tied);
            self.numbers.push(counts.then_some(self.free));
            self.free += usize::from(counts);
        }
    }

    /// Returns the number of dimensions.
    pub(crate) fn dimension(&self) -> usize {
        self.dimension
    }

    /// Returns the number of nodes, including those of reference points and jumps.
    pub fn nodes(&self) -> usize {
        self.held.len() / self.dimension
    }

    /// Returns `true` if supports hold a component of `node`.
    pub fn is_held(&self, node: usize) -> bool {
        let components = if self.dimension == 2 && self.is_rotation(node) { 1 } else { self.dimension };
        self.held[self.dimension * node..][..components].contains(&true)
    }

    /// Returns `true` if supports hold `node` along axis `a` of its frame.
    pub(super) fn is_held_along(&self, node: usize, a: usize) -> bool {
        self.held[self.dimension * node + a]
    }

    /// Returns the number of unknown displacements, n_u.
    pub fn free(&self) -> usize {
        self.free
    }

    /// Returns the unknowns of `node` along the axes of its frame: x, y and, in three dimensions, z, unless an oblique
    /// support holds the node.
    ///
    /// A component is `None` if a support holds it or the node is tied to others. The unknowns of a [`super::Relative`]
    /// node are relative.
    pub fn node(&self, node: usize) -> &[Option<usize>] {
        &self.numbers[self.dimension * node..self.dimension * (node + 1)]
    }

    /// Returns the axes of the frame of `node`, if they differ from the coordinate axes.
    pub fn frame(&self, node: usize) -> Option<&[[f64; 3]; 3]> {
        self.frames.get(&node)
    }

    /// Returns the node of an unknown.
    pub fn node_of(&self, dof: usize) -> Option<usize> {
        Some(self.numbers.iter().position(|&number| number == Some(dof))? / self.dimension)
    }

    /// Returns the row of `T` of component `k`, counted node by node along the axes of their frames: the displacement as a
    /// sum of unknowns with coefficients, its own unknown first.
    pub(super) fn row(&self, k: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let own = || self.relative.get(&(k / self.dimension)).map_or(1.0, |relative| 1.0 / relative.own);
        let beyond = self.beyond.get(&k).into_iter().flatten().copied();
        self.numbers[k].map(|dof| (dof, own())).into_iter().chain(beyond)
    }

    /// Returns the displacement of `node` along `vector` as a sum of unknowns with coefficients. An unknown may occur
    /// several times.
    pub fn along(&self, node: usize, vector: [f64; 3]) -> impl Iterator<Item = (usize, f64)> + '_ {
        let (d, components) = (self.dimension, self.in_frame(node, vector));
        let of_axis = move |a: usize| self.row(d * node + a).map(move |(dof, c)| (dof, components[a] * c));
        (0..d).filter(move |a| components[*a] != 0.0).flat_map(of_axis)
    }

    /// Returns the components of `vector` along the axes of the frame of `node`.
    pub(super) fn in_frame(&self, node: usize, vector: [f64; 3]) -> [f64; 3] {
        match self.frame(node) {
            None => vector,
            Some(frame) => frame.map(|axis| {
                let along = dot(axis, vector);
                if along.abs() <= AXIS_ROUNDING * norm(vector) { 0.0 } else { along }
            }),
        }
    }

    /// Returns the directions along which supports or the axis of a body of revolution hold `node`; in two dimensions
    /// also z.
    pub fn held(&self, node: usize) -> impl Iterator<Item = [f64; 3]> + '_ {
        let frame = self.frame(node).copied().unwrap_or([0, 1, 2].map(axis));
        (0..3).filter(move |&c| c >= self.dimension || self.is_held_along(node, c)).map(move |c| frame[c])
    }

    /// Converts forces (N) on nodes to forces on the unknowns, n_u.
    pub fn forces(&self, nodal: impl IntoIterator<Item = (usize, [f64; 3])>) -> Vec<f64> {
        let mut forces = vec![0.0; self.free];
        for (node, force) in nodal {
            self.along(node, force).for_each(|(dof, component)| forces[dof] += component);
        }
        forces
    }

    /// Returns the displacement of every node (m), those outside the mesh last, from the vector `u` of unknowns; held components are 0.
    pub fn displacements(&self, u: &[f64]) -> Vec<[f64; 3]> {
        let node = |dofs: &[Option<usize>]| [0, 1, 2].map(|c| dofs.get(c).copied().flatten().map_or(0.0, |dof| u[dof]));
        let mut displacements: Vec<[f64; 3]> = self.numbers.chunks_exact(self.dimension).map(node).collect();
        for (&k, beyond) in &self.beyond {
            let node = k / self.dimension;
            let own = &mut displacements[node][k % self.dimension];
            *own = *own / self.relative[&node].own + beyond.iter().map(|(dof, c)| c * u[*dof]).sum::<f64>();
        }
        for (&node, frame) in &self.frames {
            let along = displacements[node];
            displacements[node] = [0, 1, 2].map(|c| (0..3).map(|k| along[k] * frame[k][c]).sum());
        }
        displacements
    }
}

/// Returns an orthonormal basis of the span of the unit vectors `directions`, beginning with those along coordinate
/// axes.
pub fn independent(mut directions: Vec<[f64; 3]>, dimension: usize) -> Vec<[f64; 3]> {
    directions.sort_by_key(|n| n.iter().filter(|c| **c != 0.0).count());
    let mut basis: Vec<[f64; 3]> = Vec::new();
    for n in directions {
        let rest = basis.iter().fold(n, |rest, b| {
            let along = dot(rest, *b);
            minus(rest, b.map(|c| along * c))
        });
        if basis.len() < dimension && norm(rest) > SAME_DIRECTION {
            basis.push(if basis.is_empty() { n } else { unit(rest) });
        }
    }
    basis
}

/// Returns a frame that contains the directions `held`, fewer than the number of dimensions, and marks its held axes.
fn turned(held: &[[f64; 3]], dimension: usize) -> (Frame, [bool; 3]) {
    match *held {
        [n] => (normal_frame(n, dimension), [false, dimension == 2, true]),
        [a, b, ..] => ([unit(cross(a, b)), a, b], [false, true, true]),
        [] => ([0, 1, 2].map(axis), [false; 3]),
    }
}

/// Returns an orthonormal frame with the unit vector `n` after the directions across it, in two dimensions in the plane.
pub fn normal_frame(n: [f64; 3], dimension: usize) -> Frame {
    if dimension == 2 {
        return [[-n[1], n[0], 0.0], n, axis(2)];
    }
    let least = (0..3).min_by(|&a, &b| n[a].abs().total_cmp(&n[b].abs())).unwrap_or(0);
    let first = axis_across(least, n);
    [first, cross(n, first), n]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::mesh::block;

    /// A displacement given by its unknowns has these components along the frame, and none along held directions.
    #[test]
    fn oblique_supports_leave_what_is_across() {
        let n = unit([1.0, 2.0, -2.0]);
        let cases: [Vec<[f64; 3]>; 5] =
            [vec![n], vec![n, n.map(|c| -c)], vec![n, axis(1)], vec![axis(0), n, axis(2)], vec![unit([1.0, 0.0, 1.0])]];
        let mesh = block(&[1.0; 3], &[1; 3]);
        for held in cases {
            let dofs =
                Dofs::with_points(
                    &mesh,
                    Vec::new(),
                    Vec::new(),
                    |node| if node == 3 { held.clone() } else { Vec::new() },
                );
            let rank = independent(held.clone(), 3).len();
            assert_eq!(dofs.free(), 24 - rank, "{held:?}");
            let u: Vec<f64> = (0..dofs.free()).map(|k| 1.0 + k as f64).collect();
            let moved = dofs.displacements(&u);
            assert!(held.iter().all(|n| dot(*n, moved[3]).abs() < 1e-14), "{held:?}");
            assert_eq!(moved[0], [1.0, 2.0, 3.0]);
            for (dof, along) in dofs.along(3, moved[3]) {
                assert!((along - u[dof]).abs() < 1e-14, "{held:?}");
            }
            assert_eq!(dofs.held(3).count(), rank);
        }
    }
}
