//! The contact nodes of a boundary: gaps, weights, and rows of `C_n`, `C_t` and `C_o` (2).
//!
//! On a facet of second order the shape function of a corner is negative over most of the facet, so that its force says nothing about
//! the sign of the pressure: under a flat punch all inner corners would open. There the law is asked of Bernstein's polynomials
//! ([`bernstein`]), which are nowhere negative: `p̃_i = ∫ Ñ_i σ dA`. The displacements that these forces work on are
//!
//! ```text
//! w̃_a = w_a                     at corners,
//! w̃_m = 2 w_m - ½ (w_a + w_b)   at the node m between the corners a and b,
//! ```
//!
//! each along the normal, or the tangent, of its own node, and so are gaps `g̃` and what the obstacle slips past. `w̃ ≤ g̃` keeps every node
//! out of the obstacle, and in front of a plane the whole of a straight facet. Where normals turn along the edge, those of m for all three
//! would take the height of the arc between them, as a share of a displacement, for a gap.

use std::collections::BTreeMap;
use std::ops::Range;

use super::front::Meeting;
use super::motion::ObstacleMotion;
use super::obstacle::{Facing, PlacedObstacle};
use crate::algebra::vector::{cross, dot, plus, unit};
use crate::body::fem::{Dofs, bernstein, facet_weights, merged};
use crate::body::mesh::{Boundary, Mesh};

/// A normal that is turned round but for as much, by its cosine plus 1.
const TURNED_BACK: f64 = 1e-9;

/// A row of a contact map, `w = Σ coefficient · u[dof]`, as pairs `(dof, coefficient)`.
pub type Row = Vec<(usize, f64)>;

/// A node that can touch an obstacle.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactNode {
    /// The number of the node in the mesh.
    pub node: usize,
    /// The position of the node, m.
    pub position: [f64; 3],
    /// The ends of the edge in the middle of which the node is, on a boundary of second order.
    pub ends: Option<[End; 2]>,
    /// The row of `C_n`.
    pub normal: Row,
    /// The rows of `C_t` and `C_o`, along orthonormal tangents. A row is empty where there is no such
    /// direction to slide in: the first before the second never.
    pub tangents: [Row; 2],
    /// What it is in front of.
    pub counterpart: Counterpart,
    /// The obstacles that press the node along the same normal, by their numbers: it meets whichever is nearest at the time.
    pub others: Vec<usize>,
    /// What the node sees of the obstacle, or of the other body; the tangents are those of `C_t` and `C_o`, 0 where there is none.
    pub facing: Facing,
    /// The obstacle's own tangents, along which results are told: they are the same for all nodes in front of a plane.
    pub frame: [[f64; 3]; 2],
    /// The share of the node in the contact boundaries, `∫ N dA`: m in two dimensions (the trapezoidal rule), m² in three, and of a
    /// body of revolution all around; on boundaries of second order `∫ Ñ dA`.
    pub weight: f64,
}

/// What a contact node is in front of.
#[derive(Debug, Clone, PartialEq)]
pub enum Counterpart {
    /// An obstacle, by its number.
    Obstacle(usize),
    /// The boundary of a body.
    Boundary(Coupled),
}

/// How the nodes of two boundaries make up the rows of a contact node.
#[derive(Debug, Clone, PartialEq)]
pub struct Coupled {
    /// The number of the pair of boundaries.
    pub pair: usize,
    /// Whether its displacement is an unknown of its own, see [`crate::body::fem::Relative`].
    pub relative: bool,
    /// Whether it does without a tangent that depends on those of other nodes, see [`super::leave_out_dependent`].
    pub tangent_left_out: bool,
    /// Whether it is beyond the end of the other side, see [`super::MortarRow::is_beyond_the_end`].
    pub beyond_the_end: bool,
    /// By how much the gap is smaller between the curved surfaces that facets stand for, m; see [`super::MortarRow::bulge`].
    pub bulge: f64,
    /// Orthonormal directions along which supports let neither side move.
    pub still: Vec<[f64; 3]>,
    /// The nodes of its own side in its rows, with their positions (m) and coefficients, which add up to 1.
    pub slave: Vec<(usize, [f64; 3], f64)>,
    /// Those of the other side; their coefficients add up to -1.
    pub master: Vec<(usize, [f64; 3], f64)>,
}

/// A corner at the end of the edge of a contact node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct End {
    /// The number of the corner in the mesh.
    pub node: usize,
    /// Its position, m.
    pub position: [f64; 3],
    /// What it sees of the obstacle of the contact node; its tangents are those of the contact node, turned with the normal.
    pub facing: Facing,
}

/// A node in the rows of a contact node, `w̃ = Σ coefficient · w`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term {
    /// The coefficient.
    pub coefficient: f64,
    /// The number of the node in the mesh.
    pub node: usize,
    /// Its position, m.
    pub position: [f64; 3],
    /// What it sees of the obstacle, with tangents as [`End`] has them.
    pub facing: Facing,
    /// Whether it is of the body that the contact node is in front of.
    pub opposite: bool,
}

/// The contact nodes of one boundary.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactBoundary {
    /// The name of the boundary.
    pub name: String,
    /// The number of its contact in the description.
    pub contact: usize,
    /// The nodes of the boundary among all contact nodes, in its order. A node may be of several boundaries.
    pub nodes: Vec<usize>,
    /// The share of each node in this boundary, as [`ContactNode::weight`], m or m².
    pub weights: Vec<f64>,
    /// How many of its nodes no obstacle ever reaches.
    pub beyond: usize,
    /// The obstacles in front of it among all; none in front of another boundary.
    pub obstacles: Range<usize>,
    /// The pair of which it is the slave, if it is in front of another boundary.
    pub pair: Option<usize>,
}

impl ContactBoundary {
    /// The nodes of the boundary among all contact nodes, and what part of the forces on each of `contacts` is that of this
    /// boundary: 1, or by its share in a node that is of several.
    pub fn parts<'a>(&'a self, contacts: &'a [ContactNode]) -> impl Iterator<Item = (usize, f64)> + Clone + 'a {
        self.nodes.iter().zip(&self.weights).map(|(&i, weight)| (i, weight / contacts[i].weight))
    }
}

/// The contact nodes of `met`, nodes of `boundary` in front of obstacles. A node that supports hold along the normal carries no
/// contact force and is left out; what supports hold of the ends of its edge is left out of its rows.
pub fn contact_nodes(
    mesh: &Mesh,
    dofs: &Dofs,
    boundary: &Boundary,
    obstacles: &[(PlacedObstacle, ObstacleMotion)],
    met: &[Meeting],
) -> Vec<ContactNode> {
    let mut weights = vec![0.0; mesh.nodes.len()];
    let mut edges = BTreeMap::new();
    for facet in &boundary.facets {
        for (&node, weight) in facet.iter().zip(bernstein(mesh, facet, &facet_weights(mesh, facet))) {
            weights[node] += weight;
        }
        edges.extend(mesh.bent_edges(facet).into_iter().map(|[a, middle, b]| (middle, [a, b])));
    }
    (met.iter())
        .map(|&Meeting { node, obstacle, mut facing, ref others }| {
            let frame = facing.tangents;
            let tangents = tangents(&dofs.held(node).collect::<Vec<_>>(), &facing);
            facing.tangents = [0, 1].map(|k| tangents.get(k).copied().unwrap_or_default());
            let end = |node: usize| {
                let position = mesh.nodes[node];
                let seen = obstacles[obstacle].0.seen_from(position);
                End { node, position, facing: Facing { tangents: turned(&facing, &seen), ..seen } }
            };
            let ends = edges.get(&node).map(|edge| edge.map(end));
            let (position, weight, none) = (mesh.nodes[node], weights[node], [Row::new(), Row::new()]);
            let contact = ContactNode {
                node,
                position,
                ends,
                normal: Row::new(),
                tangents: none,
                counterpart: Counterpart::Obstacle(obstacle),
                others: others.clone(),
                facing,
                frame,
                weight,
            };
            contact.with_rows(dofs)
        })
        .filter(|contact| !row(dofs, contact.node, contact.facing.normal).is_empty())
        .collect()
}

/// The tangents of `facing` after the least turn that takes its normal to that of `seen`.
fn turned(facing: &Facing, seen: &Facing) -> [[f64; 3]; 2] {
    let between = plus(facing.normal, 1.0, seen.normal);
    let size = dot(between, seen.normal);
    // Of normals against each other, at the edge of a sheet, no turn is the least.
    if facing.normal == seen.normal || size <= TURNED_BACK {
        return facing.tangents;
    }
    facing.tangents.map(|tangent| plus(tangent, -dot(tangent, seen.normal) / size, between))
}

/// The row of a displacement of `node` along `direction`.
fn row(dofs: &Dofs, node: usize, direction: [f64; 3]) -> Row {
    dofs.along(node, direction).filter(|&(_, c)| c != 0.0).collect()
}

impl ContactNode {
    /// The same with the rows of `C_n`, `C_t` and `C_o` that follow from the rest.
    pub(super) fn with_rows(self, dofs: &Dofs) -> Self {
        let normal = self.row(dofs, |facing| facing.normal);
        let tangents = [0, 1].map(|k| self.row(dofs, |facing| facing.tangents[k]));
        ContactNode { normal, tangents, ..self }
    }

    /// The number of the obstacle that it meets at first, if it is in front of one.
    pub fn obstacle(&self) -> Option<usize> {
        match self.counterpart {
            Counterpart::Obstacle(k) => Some(k),
            Counterpart::Boundary(_) => None,
        }
    }

    /// How it is coupled to the nodes of another boundary, if it is in front of one.
    pub fn coupled(&self) -> Option<&Coupled> {
        match &self.counterpart {
            Counterpart::Obstacle(_) => None,
            Counterpart::Boundary(coupled) => Some(coupled),
        }
    }

    /// The nodes in its rows: in front of an obstacle itself, and the ends of its edge if it is between corners.
    pub fn terms(&self) -> impl Iterator<Item = Term> + '_ {
        let own = if self.ends.is_some() { 2.0 } else { 1.0 };
        let term = |coefficient, node, position, facing| Term { coefficient, node, position, facing, opposite: false };
        let own = term(own, self.node, self.position, self.facing);
        let of_end = move |end: &End| term(-0.5, end.node, end.position, end.facing);
        let of_node = move |opposite: bool| {
            move |&(node, position, c): &_| Term { opposite, ..term(c, node, position, self.facing) }
        };
        let coupled = self.coupled();
        let alone = coupled.is_none().then_some(own).into_iter().chain(self.ends.iter().flatten().map(of_end));
        let both = move |coupled: &'_ Coupled| {
            let slave = coupled.slave.iter().map(of_node(false));
            slave.chain(coupled.master.iter().map(of_node(true))).collect::<Vec<_>>()
        };
        alone.chain(coupled.into_iter().flat_map(both))
    }

    /// `Σ coefficient · value` over the nodes in its rows.
    pub fn sum(&self, value: impl Fn(&Term) -> f64) -> f64 {
        self.terms().map(|term| term.coefficient * value(&term)).sum()
    }

    /// The gap of its rows (m) where its nodes are at these distances (m) from `obstacle`. Where that is not in front of all of them
    /// the gap counts as linear along the edge, so that it is that of the node itself.
    pub fn gap(&self, obstacle: &PlacedObstacle, distances: &[f64]) -> f64 {
        match self.ends {
            Some(_) if obstacle.is_in_front_of_all(distances) => {
                self.terms().zip(distances).map(|(term, distance)| term.coefficient * distance).sum()
            }
            _ => distances[0],
        }
    }

    /// The gap of its rows in front of `obstacle` at rest, m.
    pub fn gap_at_rest(&self, obstacle: &PlacedObstacle) -> f64 {
        self.gap(obstacle, &self.terms().map(|term| term.facing.gap).collect::<Vec<_>>())
    }

    /// The row of its displacement along a direction of each node.
    pub(super) fn row(&self, dofs: &Dofs, direction: impl Fn(&Facing) -> [f64; 3]) -> Row {
        if self.coupled().is_some_and(|coupled| coupled.relative) {
            let row = dofs.relative_along(self.node, direction(&self.facing)).into_iter();
            return row.filter(|&(_, c)| c != 0.0).collect();
        }
        let of_term = |Term { coefficient, node, facing, .. }| {
            row(dofs, node, direction(&facing)).into_iter().map(move |(dof, c)| (dof, coefficient * c))
        };
        let row = self.terms().flat_map(of_term).collect();
        if self.terms().any(|term| dofs.is_relative(term.node)) { merged(row) } else { row }
    }

    /// A tangential vector with the components `along` on the node's tangents, in components on its [`frame`].
    ///
    /// [`frame`]: ContactNode::frame
    pub fn in_frame(&self, along: [f64; 2]) -> [f64; 2] {
        let [t, o] = self.facing.tangents;
        if self.facing.tangents == self.frame {
            return along;
        }
        self.frame.map(|axis| along[0] * dot(t, axis) + along[1] * dot(o, axis))
    }

    /// Takes `tangents` for its own, 0 for one that it does not have.
    pub(super) fn slide_along(&mut self, dofs: &Dofs, tangents: [[f64; 3]; 2]) {
        self.facing.tangents = tangents;
        for end in self.ends.iter_mut().flatten() {
            end.facing.tangents = turned(&self.facing, &end.facing);
        }
        self.tangents = [0, 1].map(|k| self.row(dofs, |facing| facing.tangents[k]));
    }
}

/// The tangents along which a node can slide that is `held` along these unit vectors at right angles: orthonormal
/// directions at right angles to the normal in the space of what is free.
///
/// - All of space: those of the obstacle.
/// - A plane, in two dimensions or where a support holds one component: the first tangent of the obstacle that lies
///   in the plane, otherwise the one direction of the plane that is tangential.
/// - A line: none. Tangential motion is normal motion, nothing is left to slide.
pub(super) fn tangents(held: &[[f64; 3]], facing: &Facing) -> Vec<[f64; 3]> {
    match *held {
        [] => facing.tangents.to_vec(),
        [n] => {
            let in_plane = facing.tangents.into_iter().find(|tangent| dot(*tangent, n) == 0.0);
            vec![in_plane.unwrap_or_else(|| unit(cross(n, facing.normal)))]
        }
        _ => Vec::new(),
    }
}

/// What rounding makes of a gap that is none, as a share of the body's size.
const TOUCHING: f64 = 1e-12;

/// The first node of `met` that its obstacle of `obstacles` reaches somewhere in its motion, as seen at `times` (s), while
/// supports hold it there, or move it there by `moved` (m) along its normal: no displacement can bring it out.
pub fn unreachable(
    mesh: &Mesh,
    dofs: &Dofs,
    obstacles: &[(PlacedObstacle, ObstacleMotion)],
    met: &[Meeting],
    times: &[f64],
    moved: impl Fn(&Meeting, f64) -> f64,
) -> Option<usize> {
    let touching = TOUCHING * mesh.size();
    let caught = met.iter().find(|met| {
        let x = mesh.nodes[met.node];
        let smallest = |k: usize, facing: &Facing| {
            let (obstacle, motion) = &obstacles[k];
            motion.smallest_gap(obstacle, x, facing, times, |t| moved(met, t))
        };
        row(dofs, met.node, met.facing.normal).is_empty()
            && (smallest(met.obstacle, &met.facing) < -touching
                || met.others.iter().any(|&k| smallest(k, &obstacles[k].0.seen_from(x)) < -touching))
    });
    caught.map(|met| met.node)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::vector::Vector;
    use crate::body::contact::{Obstacle, Shape, meetings};
    use crate::body::mesh::block;

    #[test]
    fn the_clamped_corner_is_no_contact_node() {
        let mesh = block(&[1.0, 1.0], &[4, 4]);
        let dofs = Dofs::new(&mesh, |node, _| mesh.nodes[node][0] == 0.0);
        let bottom = mesh.boundary("bottom").unwrap();
        let given = Obstacle::plane(1e-5);
        let met = |given: &Obstacle| {
            let plane = PlacedObstacle::new(&mesh, bottom, given).unwrap();
            let motion = ObstacleMotion::new(given, plane.normal, 2.0);
            let obstacles = vec![(plane, motion)];
            (meetings(&mesh, bottom, &obstacles, &[]).unwrap(), obstacles)
        };
        let (meetings, obstacles) = met(&given);
        let contacts = contact_nodes(&mesh, &dofs, bottom, &obstacles, &meetings);
        assert_eq!(contacts.iter().map(|c| c.position[0]).collect::<Vec<_>>(), [0.25, 0.5, 0.75, 1.0]);
        assert_eq!(contacts.iter().map(|c| c.weight).collect::<Vec<_>>(), [0.25, 0.25, 0.25, 0.125]);
        let [Some(x), Some(y)] = dofs.node(1)[..] else { panic!() };
        assert_eq!((&contacts[0].normal, &contacts[0].tangents), (&vec![(y, -1.0)], &[vec![(x, 1.0)], vec![]]));
        let reached = |given: &Obstacle| {
            let (met, obstacles) = met(given);
            unreachable(&mesh, &dofs, &obstacles, &met, &[], |_, _| 0.0)
        };
        assert_eq!(reached(&given), None);
        assert_eq!(reached(&given.clone().approaching(&[[0.0, 0.0], [1.0, 2e-5], [2.0, 0.0]])), Some(0));
        let inside = |gap| reached(&Obstacle { shape: Shape::Plane { gap }, ..given.clone() });
        assert_eq!([-1e-9, -1e-11, -1e-14].map(inside), [Some(0), Some(0), None]);
    }

    /// Supports on the symmetry plane x = 0 and the roller y = 0 leave one tangent, both together none.
    #[test]
    fn symmetry_planes_leave_one_tangent() {
        let mesh = block(&[1.0, 1.0, 1.0], &[2, 2, 2]);
        let dofs = Dofs::new(&mesh, |node, c| c < 2 && mesh.nodes[node][c] == 0.0);
        let bottom = mesh.boundary("bottom").unwrap();
        for normal in [None, Some([0.0, 0.6, -0.8]), Some([0.36, 0.48, -0.8])] {
            let given = Obstacle { normal: normal.map(Vector::from), ..Obstacle::plane(0.0) };
            let plane = PlacedObstacle::new(&mesh, bottom, &given).unwrap();
            let motion = ObstacleMotion::new(&given, plane.normal, 2.0);
            let obstacles = [(plane, motion)];
            let met = meetings(&mesh, bottom, &obstacles, &[]).unwrap();
            let contacts = contact_nodes(&mesh, &dofs, bottom, &obstacles, &met);
            assert!((contacts.iter().map(|c| c.weight).sum::<f64>() - 1.0).abs() < 1e-15);
            for contact in &contacts {
                let held = (0..2).filter(|&c| contact.position[c] == 0.0).count();
                let rows = [&contact.normal, &contact.tangents[0], &contact.tangents[1]];
                assert_eq!(rows.map(|row| usize::from(!row.is_empty())).iter().sum::<usize>(), 3 - held);
                // Tangents are of unit length, orthogonal to each other and to the normal.
                let dot = |a: &Row, b: &Row| -> f64 {
                    a.iter().flat_map(|x| b.iter().filter(|y| y.0 == x.0).map(|y| x.1 * y.1)).sum()
                };
                for (k, a) in rows.iter().enumerate().filter(|(_, row)| !row.is_empty()) {
                    for (l, b) in rows.iter().enumerate().filter(|(_, row)| !row.is_empty()) {
                        let expected = if k == l { 1.0 } else { 0.0 };
                        assert!(k == 0 && l == 0 || (dot(a, b) - expected).abs() < 1e-15, "{contact:?}");
                    }
                }
            }
        }
    }
}
