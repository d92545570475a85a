//! The numbering of the free displacements, those of nodes outside the mesh included: the two nodes of each reference point,
//! which carries nodes of the mesh, and the jumps between the two sides of glued pairs.
//!
//! A node at `x` that a point at `p` carries moves by `u(x) = U + θ × (x - p)`. The first node of the point has the
//! translation `U` as its displacement, the second one `r θ`, where the length `r` gives the unknowns one size; in two
//! dimensions its first component is `r θ_z`, and the second is held.
//!
//! The rows of a pair with the jump `J` are `Σ D u - Σ P u = J`. Along axes that are held, `J` is 0 or prescribed; along
//! free axes it is an unknown, on which the force across the pair acts.

use std::collections::{BTreeMap, HashSet};

use super::relative::{Coefficient, Relative};
use crate::algebra::vector::{axis, axis_across, cross, dot, minus, norm, plus, unit};
use crate::body::mesh::Mesh;

/// Three orthogonal directions, the axes of the displacement components of a node.
type Frame = [[f64; 3]; 3];

/// The numbering of the unknown displacement components. Supported components are eliminated and have no number.
///
/// The components of a node are along the coordinate axes, except at a node with an oblique support: its frame is
/// turned so that the held directions are axes of the frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Dofs {
    /// The number of components of a displacement.
    pub(crate) dimension: usize,
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
    pub(super) transform_rows: BTreeMap<usize, Vec<(usize, f64)>>,
    free: usize,
}

/// A unit vector counts as dependent on others if its remainder after projection is at most this long.
pub const SAME_DIRECTION: f64 = 1e-9;

/// A component of a unit vector along an axis of an oblique frame counts as rounding if it is at most this.
const AXIS_ROUNDING: f64 = 1e-14;

/// A linear form of displacements, `Σ c_k · u(x_k)`, as nodes and their coefficients.
pub type Tie = Vec<(usize, [f64; 3])>;

impl Dofs {
    /// Numbers, node by node, all components for which `fixed(node, component)` is `false`.
    pub fn new(mesh: &Mesh, fixed: impl Fn(usize, usize) -> bool) -> Self {
        let axes = |node: usize| (0..mesh.components()).filter(|&c| fixed(node, c)).map(axis).collect();
        Self::with_points(mesh, Vec::new(), Vec::new(), axes)
    }

    /// Numbers the free components of each node, of the two nodes of each of `points` and of the node of each of `jumps`,
    /// which follow those of the mesh.
    ///
    /// Each node is held along the directions `held`: unit vectors, in two dimensions in the plane. Dependent directions
    /// are ignored. Nodes on the axis of a body of revolution are also held along x and z, and its points and jumps move
    /// along the axis and, with torsion, turn about it.
    pub fn with_points(
        mesh: &Mesh,
        points: Vec<ReferencePoint>,
        jumps: Vec<Jump>,
        mut held: impl FnMut(usize) -> Vec<[f64; 3]>,
    ) -> Self {
        let dimension = mesh.components();
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
            transform_rows: BTreeMap::new(),
            free: 0,
        };
        for node in 0..dofs.node_of_jump(dofs.jumps.len()) {
            let mut held = held(node);
            let of_mesh = node < dofs.of_mesh;
            if if of_mesh { mesh.is_on_axis(node) } else { mesh.geometry.is_revolved() } {
                held.extend([0, 2].map(axis).into_iter().filter(|n| dimension == 3 || n[2] == 0.0));
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

    /// Returns the number of nodes, including those of reference points and jumps.
    pub fn nodes(&self) -> usize {
        self.held.len() / self.dimension
    }

    /// Returns `true` if supports hold a component of `node`.
    pub fn is_held(&self, node: usize) -> bool {
        let components = if self.dimension == 2 && self.is_rotation(node) { 1 } else { self.dimension };
        self.held[self.dimension * node..][..components].contains(&true)
    }

    /// Returns for each node of the mesh `true` if it has none of the `acted` unknowns, no support holds it, it is not relative to
    /// other nodes, and none is to it.
    pub fn untouched(&self, acted: impl Iterator<Item = usize>) -> Vec<bool> {
        let followed = self.transform_rows.values().flatten().map(|(dof, _)| *dof);
        let touched: HashSet<Option<usize>> = followed.chain(acted).map(Some).collect();
        let is_touched =
            |node: usize| self.relative.contains_key(&node) || self.node(node).iter().any(|dof| touched.contains(dof));
        (0..self.of_mesh).map(|node| !self.is_held(node) && !is_touched(node)).collect()
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
        let others = self.transform_rows.get(&k).into_iter().flatten().copied();
        self.numbers[k].map(|dof| (dof, own())).into_iter().chain(others)
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
        for (&k, row) in &self.transform_rows {
            let node = k / self.dimension;
            let own = &mut displacements[node][k % self.dimension];
            *own = *own / self.relative[&node].own + row.iter().map(|(dof, c)| c * u[*dof]).sum::<f64>();
        }
        for (&node, frame) in &self.frames {
            let along = displacements[node];
            displacements[node] = [0, 1, 2].map(|c| (0..3).map(|k| along[k] * frame[k][c]).sum());
        }
        displacements
    }

    /// Returns the reference point of a node outside the mesh, and `true` for the node of its rotation.
    pub(super) fn point_of(&self, node: usize) -> Option<(&ReferencePoint, bool)> {
        let index = node.checked_sub(self.of_mesh)?;
        Some((self.points.get(index / 2)?, index % 2 == 1))
    }

    /// Returns `true` if there are nodes outside the mesh: those of reference points and jumps.
    pub fn has_nodes_outside(&self) -> bool {
        self.nodes() > self.of_mesh
    }

    /// Returns `true` for a node whose displacement is the rotation of a reference point.
    pub fn is_rotation(&self, node: usize) -> bool {
        self.point_of(node).is_some_and(|(_, rotation)| rotation)
    }

    /// Returns the node of the translation for that of the rotation of a reference point, and other nodes unchanged.
    pub fn translating(&self, node: usize) -> usize {
        if self.is_rotation(node) { node - 1 } else { node }
    }

    /// Returns the nodes of translation and rotation of reference point `k`.
    pub fn nodes_of_point(&self, k: usize) -> [usize; 2] {
        [self.of_mesh + 2 * k, self.of_mesh + 2 * k + 1]
    }

    /// Returns the node of the mesh that belongs to `node`: the node itself or, for a node of a reference point, one
    /// that the point carries, and for a jump one on its first side.
    pub fn in_mesh(&self, node: usize) -> usize {
        match self.jump_of(node) {
            Some(jump) => jump.node,
            None => self.point_of(node).map_or(node, |(point, _)| point.carried_node),
        }
    }

    /// Returns the force on the node of the rotation of point `k` that is equivalent to a `moment`, N m.
    pub fn of_moment(&self, k: usize, moment: [f64; 3]) -> [f64; 3] {
        let radius = self.points[k].radius;
        self.points[k].of_rotation(self.dimension, moment).map(|x| x / (radius * radius))
    }

    /// Returns the rotation (rad) of point `k` from the displacement of its second node.
    pub fn rotation(&self, k: usize, u: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = u.map(|u| u / self.points[k].radius);
        if self.dimension == 2 { [0.0, 0.0, x] } else { [x, y, z] }
    }

    /// Returns the moment (N m) of a force on the node of a rotation; `None` for other nodes.
    pub fn moment(&self, node: usize, force: [f64; 3]) -> Option<[f64; 3]> {
        let (point, _) = self.point_of(node).filter(|(_, rotation)| *rotation)?;
        let [x, y, z] = force.map(|f| point.radius * f);
        Some(if self.dimension == 2 { [0.0, 0.0, x] } else { [x, y, z] })
    }

    /// Returns the stiffness (N/m, along the components of the second node) of a `rotational` stiffness of point `k`, N m.
    pub fn of_rotational(&self, k: usize, rotational: [f64; 3]) -> [f64; 3] {
        let radius = self.points[k].radius;
        self.of_moment(k, rotational).map(|x| x / radius)
    }

    /// Returns `true` if the other nodes of `relation` can move along the parts of `n` that act on them: supports do not
    /// hold them there, or move them along such an axis, as `moved` tells for a node and an axis.
    pub fn may_move(&self, relation: &Relative, n: [f64; 3], moved: impl Fn(usize, [f64; 3]) -> bool) -> bool {
        relation.others.iter().any(|(other, coefficient)| {
            let along = self.in_frame(*other, coefficient.transposed_times(n));
            let axes = self.axes(*other).into_iter().enumerate();
            axes.filter(|(a, _)| along[*a].abs() > SAME_DIRECTION)
                .any(|(a, axis)| !self.is_held_along(*other, a) || moved(*other, axis))
        })
    }

    /// Returns the form `n · (u - Σ coefficient · u_other)` of a relation.
    pub fn tie(&self, relation: &Relative, n: [f64; 3]) -> Tie {
        let others = relation.others.iter().map(|(other, c)| (*other, c.transposed_times(n).map(|x| -x)));
        std::iter::once((relation.node, n)).chain(others).collect()
    }

    /// Returns `true` if one reference point carries all of `nodes`, which then cause no strain.
    pub fn are_rigid(&self, nodes: &[usize]) -> bool {
        let first = nodes.first().and_then(|node| self.point_carrying(*node));
        first.is_some() && nodes.iter().all(|node| self.point_carrying(*node) == first)
    }

    /// Returns the reference point that carries `node`, if one does.
    pub fn point_carrying(&self, node: usize) -> Option<usize> {
        let (other, _) = self.relative.get(&node)?.others.first()?;
        self.point_of(*other)?;
        Some((other - self.of_mesh) / 2)
    }

    /// Returns the position of a node of the mesh or of a reference point, m, and for a jump that of its node.
    pub fn position(&self, mesh: &Mesh, node: usize) -> [f64; 3] {
        self.point_of(node).map_or_else(|| mesh.nodes[self.in_mesh(node)], |(point, _)| point.position)
    }

    /// Returns the relation that lets point `k` carry `node` of the mesh.
    pub fn carried_by(&self, mesh: &Mesh, k: usize, node: usize) -> Relative {
        let [translation, rotation] = self.nodes_of_point(k);
        let arm = self.points[k].arm(self.dimension, mesh.nodes[node]);
        let others = vec![(translation, Coefficient::Factor(1.0)), (rotation, Coefficient::Matrix(Box::new(arm)))];
        Relative { node, own: 1.0, others, tied: true }
    }

    /// Returns the node of jump `k`. These nodes follow those of reference points.
    pub fn node_of_jump(&self, k: usize) -> usize {
        self.of_mesh + 2 * self.points.len() + k
    }

    /// Returns the jump of a node outside the mesh.
    pub(super) fn jump_of(&self, node: usize) -> Option<&Jump> {
        self.jumps.get(node.checked_sub(self.node_of_jump(0))?)
    }

    /// Returns `true` for a node whose displacement is a jump.
    pub fn is_jump(&self, node: usize) -> bool {
        self.jump_of(node).is_some()
    }

    /// Returns jump `k` as the sum `Σ c u` of displacements of nodes.
    pub fn sum_of_jump(&self, k: usize) -> &[(usize, f64)] {
        self.jumps.get(k).map_or(&[], |jump| &jump.sum)
    }

    /// Sets the sum of displacements that is jump `k`.
    pub(crate) fn set_jump(&mut self, k: usize, sum: Vec<(usize, f64)>) {
        if let Some(jump) = self.jumps.get_mut(k) {
            jump.sum = sum;
        }
    }
}

/// Returns an orthonormal basis of the span of the unit vectors `directions`, beginning with those along coordinate
/// axes.
pub fn independent(mut directions: Vec<[f64; 3]>, dimension: usize) -> Vec<[f64; 3]> {
    directions.sort_by_key(|n| n.iter().filter(|c| **c != 0.0).count());
    let mut basis: Vec<[f64; 3]> = Vec::new();
    for n in directions {
        let remainder = basis.iter().fold(n, |rest, b| {
            let along = dot(rest, *b);
            minus(rest, b.map(|c| along * c))
        });
        if basis.len() < dimension && norm(remainder) > SAME_DIRECTION {
            basis.push(if basis.is_empty() { n } else { unit(remainder) });
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

/// A point that carries nodes of a mesh as a rigid body.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferencePoint {
    /// Its position, m.
    pub position: [f64; 3],
    /// The length `r` by which rotations are multiplied, m.
    pub radius: f64,
    /// A node that it carries.
    pub carried_node: usize,
}

impl ReferencePoint {
    /// Creates the point at `position` (m) that carries `nodes` of `mesh`, which must not be empty.
    pub fn new(mesh: &Mesh, position: [f64; 3], nodes: &[usize]) -> Self {
        let arm = |node: &usize| norm(minus(mesh.nodes[*node], position));
        let radius = nodes.iter().map(arm).fold(0.0, f64::max);
        let radius = if radius > 0.0 { radius } else { mesh.size() };
        ReferencePoint { position, radius, carried_node: nodes.first().copied().unwrap_or(0) }
    }

    /// Returns the displacement of its second node for a `rotation`, rad.
    pub fn of_rotation(&self, dimension: usize, rotation: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = rotation.map(|angle| self.radius * angle);
        if dimension == 2 { [z, 0.0, 0.0] } else { [x, y, z] }
    }

    /// Returns the matrix `θ × (x - p)` of the displacement of the second node.
    pub(super) fn arm(&self, dimension: usize, x: [f64; 3]) -> [[f64; 3]; 3] {
        let [x, y, z] = minus(x, self.position).map(|arm| arm / self.radius);
        match dimension {
            2 => [[-y, 0.0, 0.0], [x, 0.0, 0.0], [0.0; 3]],
            _ => [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]],
        }
    }
}

/// The jump between the two sides of a glued pair.
#[derive(Debug, Clone, PartialEq)]
pub struct Jump {
    /// A node of the mesh on the first side.
    pub node: usize,
    /// The jump as the sum `Σ c u` of displacements of nodes; empty if it is held along all axes.
    pub sum: Vec<(usize, f64)>,
}

impl Jump {
    /// Returns the jump for the displacements `u` of the nodes of the mesh, m.
    pub(super) fn at(&self, u: impl Fn(usize) -> [f64; 3]) -> [f64; 3] {
        self.sum.iter().fold([0.0; 3], |sum, &(node, c)| plus(sum, c, u(node)))
    }
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
