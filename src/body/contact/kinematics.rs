//! The contact nodes of a boundary, or of a pair: gaps, weights, and rows of `C_n`, `C_t` and `C_o` (2).
//!
//! On a facet of second order the shape function of a corner is negative over most of the facet, so that the sign of
//! its force does not give the sign of the pressure: under a flat punch all inner corners would open. On such facets
//! the law applies to forces weighted by polynomials that are nowhere negative ([`bernstein`]): `p̃_i = ∫ Ñ_i σ dA`. The
//! displacements conjugate to these forces are
//!
//! ```text
//! w̃_a = w_a                                     at corners,
//! w̃_m = (w_m - α (w_a + w_b)) / (1 - 2 α)       at the node m between the corners a and b,
//! ```
//!
//! with the share α of [`Mesh::share_of_ends`], each along the normal or the tangent of its own node; gaps `g̃` and tangential motions of the obstacle are formed in
//! the same way. `w̃ ≤ g̃` keeps every node out of the obstacle; in front of a plane it keeps a whole straight facet
//! out. If normals turn along the edge and the normal of m were used for all three nodes, the height of the arc between
//! them, as a share of a displacement, would appear as a gap.

use std::collections::BTreeMap;
use std::ops::Range;

use super::assignment::NodeObstacle;
use super::mortar::MortarRow;
use super::motion::ObstacleMotion;
use super::obstacle::{Facing, PlacedObstacle, first_tangent};
use crate::algebra::vector::{across, cross, dot, norm, plus, unit};
use crate::body::constraints::{Coefficient, Dofs, Relative, merged};
use crate::body::fem::{bernstein, facet_weights};
use crate::body::mesh::{Boundary, Mesh};

/// Two normals count as opposite if their cosine plus 1 is at most this.
const TURNED_BACK: f64 = 1e-9;

/// A row of a contact map, `w = Σ coefficient · u[dof]`, as pairs `(dof, coefficient)`.
pub type Row = Vec<(usize, f64)>;

/// A node that can touch an obstacle or another body.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactNode {
    /// The number of the node in the mesh.
    pub node: usize,
    /// The position of the node, m.
    pub position: [f64; 3],
    /// The ends of the edge, if the node is between corners of a boundary of second order.
    pub ends: Option<[End; 2]>,
    /// The nodes in the rows of glued contact nodes that this one carries, with their coefficients.
    pub dependent: Vec<Term>,
    /// The row of `C_n`.
    pub normal: Row,
    /// The rows of `C_t` and `C_o`, along orthonormal tangents. A row is empty if the node cannot slide in its
    /// direction; the first row is empty only if the second is.
    pub tangents: [Row; 2],
    /// The opposite side.
    pub counterpart: Counterpart,
    /// The numbers of the other obstacles that press the node along the same normal; the node meets the nearest at each
    /// time.
    pub others: Vec<usize>,
    /// The obstacle or the other body as seen from the node; the tangents are those of `C_t` and `C_o`, 0 for a missing
    /// one.
    pub facing: Facing,
    /// The tangents of the obstacle, which are the axes of the results; they are equal for all nodes in front of a
    /// plane.
    pub frame: [[f64; 3]; 2],
    /// The share of the node in the contact boundaries, `∫ N dA`: m in two dimensions (trapezoidal rule), m² in three
    /// dimensions and for a body of revolution (full circumference); on boundaries of second order `∫ Ñ dA`.
    pub weight: f64,
}

/// The opposite side of a contact node.
#[derive(Debug, Clone, PartialEq)]
pub enum Counterpart {
    /// The number of an obstacle.
    Obstacle(usize),
    /// The boundary of a body.
    Boundary(Coupled),
}

/// The rows of a contact node of a pair of boundaries, in terms of the nodes of both.
#[derive(Debug, Clone, PartialEq)]
pub struct Coupled {
    /// The number of the pair of boundaries.
    pub pair: usize,
    /// `true` if its relative displacement is an unknown, see [`crate::body::constraints::Relative`].
    pub relative: bool,
    /// `true` if the node is beyond the end of the other side, see [`super::MortarRow::is_beyond_the_end`].
    pub beyond_the_end: bool,
    /// The reduction of a measured gap if the surfaces had no edges, m; see [`super::MortarRow::edges`].
    pub edges: f64,
    /// Orthonormal directions in which supports fix both sides.
    pub still: Vec<[f64; 3]>,
    /// The nodes of its own side in its rows, with positions (m) and coefficients; the coefficients add up to 1.
    pub slave: Vec<(usize, [f64; 3], f64)>,
    /// The nodes of the other side in its rows; their coefficients add up to -1.
    pub master: Vec<(usize, [f64; 3], f64)>,
}

/// A corner at an end of the edge of a contact node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct End {
    /// The number of the corner in the mesh.
    pub node: usize,
    /// Its position, m.
    pub position: [f64; 3],
    /// The obstacle of the contact node as seen from the corner; the tangents are those of the contact node, turned
    /// with the normal.
    pub facing: Facing,
    /// The share of the corner in the contact node, see [`Mesh::share_of_ends`].
    pub share: f64,
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
    /// The obstacle as seen from the node, with tangents as in [`End`].
    pub facing: Facing,
    /// `true` if the node belongs to the opposite side.
    pub opposite: bool,
}

/// The contact nodes of one boundary.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactBoundary {
    /// The name of the boundary.
    pub name: String,
    /// The number of its contact in the description.
    pub contact: usize,
    /// The numbers of its contact nodes among all contact nodes, in the order of the boundary. A node may belong to
    /// several boundaries.
    pub nodes: Vec<usize>,
    /// The share of each node in this boundary, like [`ContactNode::weight`], m or m².
    pub weights: Vec<f64>,
    /// The number of its nodes that no obstacle ever reaches.
    pub unreached: usize,
    /// The numbers of its obstacles among all obstacles; empty in front of another boundary.
    pub obstacles: Range<usize>,
    /// The number of the pair of which it is the slave, if it is in front of another boundary.
    pub pair: Option<usize>,
}

impl ContactBoundary {
    /// Returns the contact nodes of the boundary and the share of each node's force that acts on this boundary: 1, or
    /// the share of the boundary in a node of several boundaries.
    pub fn shares<'a>(&'a self, contacts: &'a [ContactNode]) -> impl Iterator<Item = (usize, f64)> + Clone + 'a {
        self.nodes.iter().zip(&self.weights).map(|(&i, weight)| (i, weight / contacts[i].weight))
    }
}

/// Creates the contact nodes of `assigned`, nodes of `boundary` in front of obstacles.
///
/// A node that supports hold along the normal carries no contact force and is left out. Held displacements of the ends
/// of its edge are left out of its rows.
pub fn contact_nodes(
    mesh: &Mesh,
    dofs: &Dofs,
    boundary: &Boundary,
    obstacles: &[(PlacedObstacle, ObstacleMotion)],
    assigned: &[NodeObstacle],
) -> Vec<ContactNode> {
    let mut weights = vec![0.0; mesh.nodes.len()];
    let mut edges = BTreeMap::new();
    for facet in &boundary.facets {
        for (&node, weight) in facet.iter().zip(bernstein(mesh, facet, &facet_weights(mesh, facet))) {
            weights[node] += weight;
        }
        let share = mesh.share_of_ends(facet);
        edges.extend(mesh.bent_edges(facet).into_iter().map(|[a, middle, b]| (middle, ([a, b], share))));
    }
    (assigned.iter())
        .map(|&NodeObstacle { node, obstacle, mut facing, ref others }| {
            let frame = facing.tangents;
            let tangents = tangents(&dofs.held(node).collect::<Vec<_>>(), &facing);
            facing.tangents = [0, 1].map(|k| tangents.get(k).copied().unwrap_or_default());
            let end = |node: usize, share: f64| {
                let position = mesh.nodes[node];
                let at_end = obstacles[obstacle].0.seen_from(position);
                End { node, position, facing: Facing { tangents: turned(&facing, &at_end), ..at_end }, share }
            };
            let ends = edges.get(&node).map(|&(edge, share)| edge.map(|node| end(node, share)));
            let (position, weight, none) = (mesh.nodes[node], weights[node], [Row::new(), Row::new()]);
            let contact = ContactNode {
                node,
                position,
                ends,
                dependent: Vec::new(),
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

/// Returns the tangents of `facing` after the smallest rotation that takes its normal to the normal of `at_end`.
fn turned(facing: &Facing, at_end: &Facing) -> [[f64; 3]; 2] {
    let between = plus(facing.normal, 1.0, at_end.normal);
    let size = dot(between, at_end.normal);
    // Between opposite normals, at the edge of a sheet, there is no smallest rotation.
    if facing.normal == at_end.normal || size <= TURNED_BACK {
        return facing.tangents;
    }
    facing.tangents.map(|tangent| plus(tangent, -dot(tangent, at_end.normal) / size, between))
}

/// Returns the row of the displacement of `node` along `direction`.
fn row(dofs: &Dofs, node: usize, direction: [f64; 3]) -> Row {
    dofs.along(node, direction).filter(|&(_, c)| c != 0.0).collect()
}

impl ContactNode {
    /// Computes the rows of `C_n`, `C_t` and `C_o` from the other fields.
    pub(super) fn with_rows(self, dofs: &Dofs) -> Self {
        let normal = self.row(dofs, |facing| facing.normal);
        let tangents = [0, 1].map(|k| self.row(dofs, |facing| facing.tangents[k]));
        ContactNode { normal, tangents, ..self }
    }

    /// Returns the number of the obstacle that it meets first, if it is in front of one.
    pub fn obstacle(&self) -> Option<usize> {
        match self.counterpart {
            Counterpart::Obstacle(k) => Some(k),
            Counterpart::Boundary(_) => None,
        }
    }

    /// Returns the coupling to another boundary, if it is in front of one.
    pub fn coupled(&self) -> Option<&Coupled> {
        match &self.counterpart {
            Counterpart::Obstacle(_) => None,
            Counterpart::Boundary(coupled) => Some(coupled),
        }
    }

    /// Returns the nodes in its rows. In front of an obstacle, these are the node itself and, if it is between corners,
    /// the ends of its edge. The nodes of glued contact nodes that it carries come last.
    pub fn terms(&self) -> impl Iterator<Item = Term> + '_ {
        let dependent: f64 = self.dependent.iter().filter(|term| !term.opposite).map(|term| term.coefficient).sum();
        let rest = 1.0 - dependent;
        let scaled = move |term: Term| Term { coefficient: rest * term.coefficient, ..term };
        let own = 1.0 / (1.0 - self.ends.iter().flatten().map(|end| end.share).sum::<f64>());
        let term = |coefficient, node, position, facing| Term { coefficient, node, position, facing, opposite: false };
        let own = term(own, self.node, self.position, self.facing);
        let of_end = move |end: &End| term(-end.share * own.coefficient, end.node, end.position, end.facing);
        let of_node = move |opposite: bool| {
            move |&(node, position, c): &_| Term { opposite, ..term(c, node, position, self.facing) }
        };
        let coupled = self.coupled();
        let uncoupled = coupled.is_none().then_some(own).into_iter().chain(self.ends.iter().flatten().map(of_end));
        let both = move |coupled: &'_ Coupled| {
            let slave = coupled.slave.iter().map(of_node(false));
            slave.chain(coupled.master.iter().map(of_node(true))).collect::<Vec<_>>()
        };
        uncoupled.chain(coupled.into_iter().flat_map(both)).map(scaled).chain(self.dependent.iter().copied())
    }

    /// Computes `Σ coefficient · value` over the nodes in its rows.
    pub fn sum(&self, value: impl Fn(&Term) -> f64) -> f64 {
        self.terms().map(|term| term.coefficient * value(&term)).sum()
    }

    /// Computes the gap of its rows (m) from the distances (m) of its nodes from `obstacle`. If the obstacle is not in
    /// front of all of them, the gap is taken to be linear along the edge, and the result is that of the node itself.
    pub fn gap(&self, obstacle: &PlacedObstacle, distances: &[f64]) -> f64 {
        if self.is_single() || !obstacle.is_in_front_of_all(distances) {
            return distances[0];
        }
        self.terms().zip(distances).map(|(term, distance)| term.coefficient * distance).sum()
    }

    /// Returns `true` if no other node of the body is in its rows.
    pub fn is_single(&self) -> bool {
        self.ends.is_none() && self.dependent.is_empty()
    }

    /// Computes the gap of its rows in front of `obstacle` at rest, m.
    pub fn gap_at_rest(&self, obstacle: &PlacedObstacle) -> f64 {
        self.gap(obstacle, &self.terms().map(|term| term.facing.gap).collect::<Vec<_>>())
    }

    /// Returns the row of its displacement along a direction given for each node.
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

    /// Converts components `along` the node's tangents to components on its [`frame`].
    ///
    /// [`frame`]: ContactNode::frame
    pub fn in_frame(&self, along: [f64; 2]) -> [f64; 2] {
        let [t, o] = self.facing.tangents;
        if self.facing.tangents == self.frame {
            return along;
        }
        self.frame.map(|axis| along[0] * dot(t, axis) + along[1] * dot(o, axis))
    }
}

/// Returns the tangents along which a node can slide that supports hold along the orthogonal unit vectors `held`:
/// orthonormal directions at right angles to the normal in the space of its free displacements.
///
/// - All of space: the tangents of the obstacle.
/// - A plane, in two dimensions or if a support holds one component: the first tangent of the obstacle that lies in the
///   plane, otherwise the tangential direction in the plane.
/// - A line: none, since every motion along it has a normal part.
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

/// The rounding error of a zero gap, as a share of the body's size.
const TOUCHING: f64 = 1e-12;

/// Finds the first node of `assigned` that its obstacle reaches, as seen at `times` (s), while supports hold it or move
/// it by `moved` (m) along its normal. No displacement can bring such a node out of the obstacle.
pub fn unreachable(
    mesh: &Mesh,
    dofs: &Dofs,
    obstacles: &[(PlacedObstacle, ObstacleMotion)],
    assigned: &[NodeObstacle],
    times: &[f64],
    moved: impl Fn(&NodeObstacle, f64) -> f64,
) -> Option<usize> {
    let touching = TOUCHING * mesh.size();
    let caught = assigned.iter().find(|node| {
        let x = mesh.nodes[node.node];
        let smallest = |k: usize, facing: &Facing| {
            let (obstacle, motion) = &obstacles[k];
            motion.smallest_gap(obstacle, x, facing, times, |t| moved(node, t))
        };
        row(dofs, node.node, node.facing.normal).is_empty()
            && (smallest(node.obstacle, &node.facing) < -touching
                || node.others.iter().any(|&k| smallest(k, &obstacles[k].0.seen_from(x)) < -touching))
    });
    caught.map(|met| met.node)
}

/// The least length of a projected tangent; a shorter one is almost parallel to the normal.
const LEANS: f64 = 0.1;

/// Returns the relation that makes the displacement of the node of `row` relative to the other nodes of the row, see
/// [`Relative`]. If `glued`, the node is tied to them.
pub fn relative(row: &MortarRow, glued: bool) -> Relative {
    let own = row.slave.iter().find(|(node, _)| *node == row.node).map_or(1.0, |(_, c)| *c);
    let beside = row.slave.iter().filter(|(node, _)| *node != row.node).map(|&(node, c)| (node, -c));
    let others = beside.chain(row.master.iter().copied()).map(|(node, c)| (node, Coefficient::Factor(c)));
    Relative { node: row.node, own, others: others.collect(), tied: glued }
}

/// Creates the contact nodes of the pair `pair` from its `rows`.
///
/// `gap` (m) is the gap of each row, and how much less it may be, see [`super::Coupled::edges`]; `relative` marks the nodes with relative displacements in this pair. Normals are
/// those of the rows; the first tangent is that of an obstacle with their mean normal, turned with the normal.
pub fn coupled_nodes(
    mesh: &Mesh,
    dofs: &Dofs,
    pair: usize,
    rows: &[MortarRow],
    gap: impl Fn(&MortarRow) -> [f64; 2],
    relative: impl Fn(usize) -> bool,
) -> Vec<ContactNode> {
    let mean = rows.iter().fold([0.0; 3], |sum, row| plus(sum, row.weight, row.normal));
    let first = first_tangent(unit(mean));
    let node = |row: &MortarRow| {
        let normal = row.normal;
        let first = match mesh.dimension {
            2 => [-normal[1], normal[0], 0.0],
            _ => across(first, normal),
        };
        let first = if norm(first) > LEANS { unit(first) } else { first_tangent(normal) };
        let frame = [first, cross(normal, first)];
        let [gap, edges] = gap(row);
        let facing = Facing { gap, normal, tangents: frame, inward: normal };
        let nodes = |side: &[(usize, f64)], sign: f64| {
            side.iter().map(|&(node, c)| (node, mesh.nodes[node], sign * c)).collect::<Vec<_>>()
        };
        let (slave, master) = (nodes(&row.slave, 1.0), nodes(&row.master, -1.0));
        let coupled = Coupled {
            pair,
            relative: relative(row.node),
            beyond_the_end: row.is_beyond_the_end(),
            edges,
            still: row.still.clone(),
            slave,
            master,
        };
        let mut contact = ContactNode {
            node: row.node,
            position: mesh.nodes[row.node],
            ends: None,
            dependent: Vec::new(),
            normal: Row::new(),
            tangents: [Row::new(), Row::new()],
            counterpart: Counterpart::Boundary(coupled),
            others: Vec::new(),
            facing,
            frame,
            weight: row.weight,
        };
        // Along directions in which supports hold only this side, the other side moves past it.
        let moves = |n: &[f64; 3]| !row.still.contains(n) && !contact.row(dofs, |_| *n).is_empty();
        let fixed: Vec<[f64; 3]> = dofs.held(row.node).filter(|n| !moves(n)).collect();
        let tangents = tangents(&fixed, &contact.facing);
        contact.facing.tangents = [0, 1].map(|k| tangents.get(k).copied().unwrap_or_default());
        contact.with_rows(dofs)
    };
    // A node whose two sides move alike along its normal, as at the end of a weld, can neither open nor close.
    rows.iter().map(node).filter(|contact| !contact.normal.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{Obstacle, Shape, meetings};
    use super::*;
    use crate::algebra::vector::Vector;
    use crate::body::mesh::block;

    #[test]
    fn the_clamped_corner_is_no_contact_node() {
        let mesh = block(&[1.0, 1.0], &[4, 4]);
        let dofs = Dofs::new(&mesh, |node, _| mesh.nodes[node][0] == 0.0);
        let bottom = mesh.boundary("bottom").unwrap();
        let given = Obstacle::plane(1e-5);
        let assigned_to = |given: &Obstacle| {
            let plane = PlacedObstacle::new(&mesh, bottom, given).unwrap();
            let motion = ObstacleMotion::new(given, plane.normal, 2.0);
            let obstacles = vec![(plane, motion)];
            (meetings(&mesh, bottom, &obstacles, &[]).unwrap(), obstacles)
        };
        let (meetings, obstacles) = assigned_to(&given);
        let contacts = contact_nodes(&mesh, &dofs, bottom, &obstacles, &meetings);
        assert_eq!(contacts.iter().map(|c| c.position[0]).collect::<Vec<_>>(), [0.25, 0.5, 0.75, 1.0]);
        assert_eq!(contacts.iter().map(|c| c.weight).collect::<Vec<_>>(), [0.25, 0.25, 0.25, 0.125]);
        let [Some(x), Some(y)] = dofs.node(1)[..] else { panic!() };
        assert_eq!((&contacts[0].normal, &contacts[0].tangents), (&vec![(y, -1.0)], &[vec![(x, 1.0)], vec![]]));
        let reached = |given: &Obstacle| {
            let (assigned, obstacles) = assigned_to(given);
            unreachable(&mesh, &dofs, &obstacles, &assigned, &[], |_, _| 0.0)
        };
        assert_eq!(reached(&given), None);
        assert_eq!(reached(&given.clone().approaching(&[[0.0, 0.0], [1.0, 2e-5], [2.0, 0.0]])), Some(0));
        let inside = |gap| reached(&Obstacle { shape: Shape::Plane { gap }, ..given.clone() });
        assert_eq!([-1e-9, -1e-11, -1e-14].map(inside), [Some(0), Some(0), None]);
    }

    /// A support on the symmetry plane x = 0 or the roller y = 0 leaves one tangent; both together leave none.
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
            let assigned = meetings(&mesh, bottom, &obstacles, &[]).unwrap();
            let contacts = contact_nodes(&mesh, &dofs, bottom, &obstacles, &assigned);
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
