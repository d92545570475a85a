//! The couplings of a description on its mesh: carried nodes, forces at reference points, and their motion.

use std::collections::{BTreeMap, BTreeSet};

use super::find;
use super::place::suits;
use crate::algebra::null_space::{Row, null_space};
use crate::algebra::vector::{axis, cross, dot, minus, norm, plus};
use crate::base::input_error::InputError;
use crate::body::constraints::{Dofs, ReferencePoint};
use crate::body::description::{Coupling, CouplingKind, Description, Part};
use crate::body::fem::{NodalForces, area, cell_volume, facet_weights, traction};
use crate::body::mesh::{Boundary, Mesh};

/// The largest distance of a reference point from its part, in sizes of the mesh. Moments lose as many digits.
const FURTHEST: f64 = 1e4;

/// The couplings of a description.
#[derive(Debug, Clone)]
pub(super) struct Couplings {
    pub all: Vec<Coupled>,
    /// The number of nodes of the mesh.
    of_mesh: usize,
}

/// A coupling on its mesh.
#[derive(Debug, Clone)]
pub(super) struct Coupled {
    name: String,
    /// The position of the reference point, m.
    pub position: [f64; 3],
    /// The coupled nodes with their shares in the area of the boundary, or in the volume of the body.
    shares: Vec<(usize, f64)>,
    link: Link,
}

#[derive(Debug, Clone)]
enum Link {
    /// Reference point `k` of [`Dofs`] carries the nodes; all nodes of a body if `whole`.
    Rigid { k: usize, whole: bool },
    /// Forces are distributed over the nodes.
    Distributing(Spread),
}

/// The distribution of forces over a boundary of area `A`: tractions that change linearly.
#[derive(Debug, Clone)]
struct Spread {
    /// The centroid `c`, m.
    centroid: [f64; 3],
    /// `∫ N_j r dA / A` with `r = x - c` for each node j, m; a node may occur several times.
    moments: NodalForces,
    /// The inverse of `∫ (r² 1 - r rᵀ) dA / A`, 1/m².
    inverse: [[f64; 3]; 3],
}

impl Couplings {
    /// Creates the couplings of `description`.
    pub(super) fn new(description: &Description, mesh: &Mesh) -> Result<Self, InputError> {
        let mut couplings = Couplings { all: Vec::new(), of_mesh: mesh.nodes.len() };
        let mut dependent: BTreeMap<usize, &str> = BTreeMap::new();
        let units = description.system(mesh.dimension);
        for (k, given) in description.couplings.iter().enumerate() {
            let coupled = couplings.coupled(given, mesh, k)?;
            for node in coupled.rigid().into_iter().flat_map(|(_, nodes)| nodes) {
                if let Some(other) = dependent.insert(node, &given.name) {
                    let place = units.point(mesh.nodes[node]);
                    let message =
                        format!("the couplings `{other}` and `{}` both carry the node at {place}", given.name);
                    let help = "couple boundaries that share no node, or make one coupling of both";
                    return Err(InputError::new(format!("coupling[{k}].{}", given.part.key()), message, help));
                }
            }
            couplings.all.push(coupled);
        }
        if dependent.len() == mesh.nodes.len() {
            let message = "couplings carry every node of the mesh, so that nothing is elastic";
            return Err(InputError::new("coupling[0].body", message, "leave one body elastic"));
        }
        Ok(couplings)
    }

    fn coupled(&self, given: &Coupling, mesh: &Mesh, k: usize) -> Result<Coupled, InputError> {
        let key = format!("coupling[{k}]");
        let shares = shares(mesh, &given.part, &key)?;
        let mut position = centroid(mesh, &shares);
        if mesh.geometry.is_revolved() {
            position[0] = 0.0;
        }
        if let Some(point) = given.point {
            suits(mesh, point, &format!("{key}.point"))?;
            position = point.components();
            if mesh.geometry.is_revolved() && position[0] != 0.0 {
                let message = "the reference point of a body of revolution is not on its axis, x = 0";
                return Err(InputError::new(format!("{key}.point"), message, "give [0, y]"));
            }
        }
        let apart = norm(minus(position, centroid(mesh, &shares)));
        if apart > FURTHEST * mesh.size() {
            let message = format!(
                "the reference point is {:.0} times the size of the body away from `{}`",
                apart / mesh.size(),
                given.part.name()
            );
            let help = "a moment of its force loses digits: give the force and its moment at a nearer point";
            return Err(InputError::new(format!("{key}.point"), message, help));
        }
        if !spans(mesh, &shares) {
            let name = given.part.name();
            let message = format!("`{name}` has its nodes on one line, so that it cannot follow a rotation about it");
            let place = format!("{key}.{}", given.part.key());
            let help = "couple a larger boundary, or use a support, a spring or a force";
            return Err(InputError::new(place, message, help));
        }
        let link = match given.kind {
            CouplingKind::Rigid => {
                Link::Rigid { k: self.each_rigid().count(), whole: matches!(given.part, Part::Body(_)) }
            }
            CouplingKind::Distributing => {
                let boundary = find(mesh, given.part.name(), &key)?;
                let spread = Spread::new(mesh, boundary, &shares).ok_or_else(|| {
                    let message = format!("`{}` has no area, so that nothing can be distributed", given.part.name());
                    InputError::new(format!("{key}.boundary"), message, "name another boundary")
                })?;
                Link::Distributing(spread)
            }
        };
        Ok(Coupled { name: given.name.clone(), position, shares, link })
    }

    /// Returns the reference points of rigid couplings.
    pub(super) fn points(&self, mesh: &Mesh) -> Vec<ReferencePoint> {
        let point =
            |(of, _, nodes): (usize, usize, Vec<usize>)| ReferencePoint::new(mesh, self.all[of].position, &nodes);
        self.each_rigid().map(point).collect()
    }

    /// Returns the coupling called `name`, which the table at `key` names.
    pub(super) fn find(&self, name: &str, key: &str) -> Result<&Coupled, InputError> {
        self.all.iter().find(|coupled| coupled.name == name).ok_or_else(|| {
            let known: Vec<&str> = self.all.iter().map(|coupled| coupled.name.as_str()).collect();
            let help = match &known[..] {
                [] => "add a [[coupling]] of this name".to_string(),
                known => format!("the scene has the couplings {}", known.join(", ")),
            };
            InputError::new(format!("{key}.coupling"), format!("there is no coupling `{name}`"), help)
        })
    }

    /// Returns the nodes of translation and rotation of the rigid coupling called `name`, which `whose` table at `key`
    /// needs.
    pub(super) fn rigid(&self, name: &str, whose: &str, key: &str) -> Result<(usize, [usize; 2]), InputError> {
        match self.find(name, key)?.link {
            Link::Rigid { k, .. } => Ok((k, [self.of_mesh + 2 * k, self.of_mesh + 2 * k + 1])),
            Link::Distributing(_) => {
                let message =
                    format!("`{name}` is a distributing coupling, whose point moves freely with its boundary");
                let help = format!("use kind = \"rigid\", or let {whose} act on the boundary");
                Err(InputError::new(format!("{key}.coupling"), message, help))
            }
        }
    }

    /// Returns the nodes of bodies that are rigid as a whole.
    pub(super) fn rigid_bodies(&self) -> BTreeSet<usize> {
        self.each_rigid_body().flat_map(|(.., nodes)| nodes).collect()
    }

    /// Returns all nodes that reference points carry.
    pub(super) fn dependent_nodes(&self) -> BTreeSet<usize> {
        self.each_rigid().flat_map(|(.., nodes)| nodes).collect()
    }

    /// Returns each rigid coupling with its number in the description, the number of its reference point and its nodes.
    pub(super) fn each_rigid(&self) -> impl Iterator<Item = (usize, usize, Vec<usize>)> {
        self.all.iter().enumerate().filter_map(|(of, coupled)| coupled.rigid().map(|(k, nodes)| (of, k, nodes)))
    }

    /// Returns the couplings of whole bodies among them.
    pub(super) fn each_rigid_body(&self) -> impl Iterator<Item = (usize, usize, Vec<usize>)> {
        self.each_rigid().filter(|(of, ..)| matches!(self.all[*of].link, Link::Rigid { whole: true, .. }))
    }

    /// Returns the forces on nodes due to a `force` (N) and a `moment` (N m) at the reference point of the coupling
    /// called `name`, which the table at `key` names.
    pub(super) fn forces(
        &self,
        dofs: &Dofs,
        name: &str,
        [force, moment]: [[f64; 3]; 2],
        key: &str,
    ) -> Result<NodalForces, InputError> {
        let coupled = self.find(name, key)?;
        Ok(match &coupled.link {
            Link::Rigid { k, .. } => {
                let [translation, rotation] = dofs.nodes_of_point(*k);
                let both = [(translation, force), (rotation, dofs.of_moment(*k, moment))];
                both.into_iter().filter(|(_, force)| *force != [0.0; 3]).collect()
            }
            Link::Distributing(spread) => {
                let arm = minus(coupled.position, spread.centroid);
                let moment = plus(moment, 1.0, cross(arm, force));
                let turn = spread.inverse.map(|row| dot(row, moment));
                let of_force = coupled.shares.iter().map(|&(node, share)| (node, force.map(|f| share * f)));
                of_force.chain(spread.moments.iter().map(|&(node, arm)| (node, cross(turn, arm)))).collect()
            }
        })
    }

    /// Returns the displacement (m) and the rotation (rad) of the reference point of coupling `k` from the displacements
    /// of all nodes.
    pub(super) fn motion(&self, mesh: &Mesh, dofs: &Dofs, k: usize, all: &[[f64; 3]]) -> [[f64; 3]; 2] {
        let coupled = &self.all[k];
        match &coupled.link {
            Link::Rigid { k, .. } => {
                let [translation, rotation] = dofs.nodes_of_point(*k);
                [all[translation], dofs.rotation(*k, all[rotation])]
            }
            Link::Distributing(spread) => {
                let mut mean = coupled.shares.iter().fold([0.0; 3], |sum, (node, share)| plus(sum, *share, all[*node]));
                if mesh.geometry.is_revolved() {
                    (mean[0], mean[2]) = (0.0, 0.0);
                }
                let turned = spread
                    .moments
                    .iter()
                    .fold([0.0; 3], |sum, (node, arm)| plus(sum, 1.0, cross(*arm, minus(all[*node], mean))));
                let rotation = spread.inverse.map(|row| dot(row, turned));
                let arm = minus(coupled.position, spread.centroid);
                [plus(mean, 1.0, cross(rotation, arm)), rotation]
            }
        }
    }
}

impl Coupled {
    /// Returns the number of the reference point and the nodes that it carries, for a rigid coupling.
    fn rigid(&self) -> Option<(usize, Vec<usize>)> {
        match self.link {
            Link::Rigid { k, .. } => Some((k, self.shares.iter().map(|(node, _)| *node).collect())),
            Link::Distributing(_) => None,
        }
    }
}

impl Spread {
    fn new(mesh: &Mesh, boundary: &Boundary, shares: &[(usize, f64)]) -> Option<Self> {
        let (mut centroid, area) = (centroid(mesh, shares), area(mesh, boundary));
        if mesh.geometry.is_revolved() {
            centroid[0] = 0.0;
        }
        let moments = traction(mesh, boundary, |x, d_area| minus(x, centroid).map(|r| r * norm(d_area) / area));
        let mut inertia = [[0.0; 3]; 3];
        for (node, moment) in &moments {
            let r = minus(mesh.nodes[*node], centroid);
            for (a, row) in inertia.iter_mut().enumerate() {
                for (b, entry) in row.iter_mut().enumerate() {
                    *entry += if a == b { dot(r, *moment) } else { 0.0 } - r[a] * moment[b];
                }
            }
        }
        let turns = mesh.rotation_axes();
        let inverse = if turns.len() == 3 {
            inverse(inertia)
        } else {
            [0, 1, 2].map(|k| if turns.contains(&k) { axis(k).map(|c| c / inertia[k][k]) } else { [0.0; 3] })
        };
        inverse.as_flattened().iter().all(|x| x.is_finite()).then_some(Spread { centroid, moments, inverse })
    }
}

/// Computes the inverse of a symmetric matrix.
fn inverse(m: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let columns = [cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])];
    let determinant = dot(m[0], columns[0]);
    columns.map(|column| column.map(|c| c / determinant))
}

/// Returns the nodes of `part` with their shares in its area or volume; they add up to 1.
fn shares(mesh: &Mesh, part: &Part, key: &str) -> Result<Vec<(usize, f64)>, InputError> {
    let mut weights: BTreeMap<usize, f64> = BTreeMap::new();
    match part {
        Part::Boundary(name) => {
            for facet in &find(mesh, name, key)?.facets {
                for (&node, weight) in facet.iter().zip(facet_weights(mesh, facet)) {
                    *weights.entry(node).or_default() += weight;
                }
            }
        }
        Part::Body(name) => {
            let bodies = mesh.bodies();
            let Some(body) = bodies.names().iter().position(|own| own == name) else {
                let message = format!("there is no body `{name}`");
                let help = format!("the mesh has the bodies {}", bodies.names().join(", "));
                return Err(InputError::new(format!("{key}.body"), message, help));
            };
            for e in bodies.cells(body) {
                let cell = &mesh.cells[e];
                let volume = cell_volume(cell.kind, mesh.geometry, &mesh.points(&cell.nodes)).unwrap_or(0.0);
                let share = volume / cell.nodes.len() as f64;
                cell.nodes.iter().for_each(|&node| *weights.entry(node).or_default() += share);
            }
        }
    }
    let whole: f64 = weights.values().sum();
    if !(whole > 0.0 && whole.is_finite()) {
        let message = format!("`{}` has no area or volume, so that it has no centroid", part.name());
        return Err(InputError::new(format!("{key}.{}", part.key()), message, "name another boundary or body"));
    }
    Ok(weights.into_iter().map(|(node, weight)| (node, weight / whole)).collect())
}

/// Returns the mean of the positions of nodes with shares.
fn centroid(mesh: &Mesh, shares: &[(usize, f64)]) -> [f64; 3] {
    // + 0.0 turns -0 into 0.
    shares.iter().fold([0.0; 3], |sum, (node, share)| plus(sum, *share, mesh.nodes[*node])).map(|c| c + 0.0)
}

/// Returns `true` if a rotation moves the nodes: two points in the plane, three off a line in space.
fn spans(mesh: &Mesh, shares: &[(usize, f64)]) -> bool {
    if mesh.geometry.is_revolved() {
        return true;
    }
    let first = mesh.nodes[shares[0].0];
    let arms = shares.iter().map(|(node, _)| minus(mesh.nodes[*node], first));
    let size = arms.clone().map(norm).fold(0.0, f64::max);
    let rotations = mesh.rotation_axes();
    let rows = arms.flat_map(|arm| {
        let arm = arm.map(|c| c / size);
        let along = |c: usize| rotations.clone().map(|r| cross(axis(r), arm)[c]).collect();
        (0..mesh.dimension).map(|c| Row::of_unit_size(along(c))).collect::<Vec<_>>()
    });
    size > 0.0 && null_space(rotations.len(), rows).is_empty()
}

/// Returns moments about the axes of space from the components of an input.
pub(super) fn about_axes(mesh: &Mesh, given: &[f64], key: &str) -> Result<[f64; 3], InputError> {
    let turns = mesh.rotation_axes();
    if turns.len() == given.len() {
        return Ok([0, 1, 2].map(|c| if turns.contains(&c) { given[c - turns.start] } else { 0.0 }));
    }
    let name = key.rsplit('.').next().unwrap_or(key);
    let message = format!("{name} has {} components, but {}", given.len(), turning(mesh));
    let help = ["remove the table", "give one number, such as 5", "", "give [x, y, z]"][turns.len()];
    Err(InputError::new(key, message, help))
}

/// Tells about which axes the body turns.
pub(super) fn turning(mesh: &Mesh) -> String {
    match &["x", "y", "z"][mesh.rotation_axes()] {
        [] => {
            "a body of revolution does not turn, unless its material has plane = \"axisymmetric-torsion\"".to_string()
        }
        axes => format!("the body turns about {} only", axes.join(", ")),
    }
}
