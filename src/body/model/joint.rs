//! Jumps between the sides of glued contacts: pretensions and periodic boundaries.

use std::collections::BTreeSet;

use super::find;
use crate::algebra::vector::{axis, dot, norm, plus, unit};
use crate::base::input_error::InputError;
use crate::base::timeline::within;
use crate::body::constraints::{Coefficient, Dofs, Jump, Relative, SAME_DIRECTION, Tie, normal_frame};
use crate::body::contact::MortarRow;
use crate::body::description::{Description, Opposite, Tightening};
use crate::body::mesh::{Boundary, Mesh};

/// The least length of the sum of the area vectors of a section, as a share of the sum of their lengths.
const FLAT: f64 = 0.5;

/// A component of the normal of a section counts as rounding if it is at most this.
const ROUNDING: f64 = 1e-12;

/// The jumps of a description; jump `k` of [`Dofs`] belongs to joint `k`.
#[derive(Debug, Clone, Default)]
pub(super) struct Joints {
    pub all: Vec<Joint>,
}

/// A glued contact whose first side moves beyond the other by a jump.
#[derive(Debug, Clone)]
pub(super) struct Joint {
    /// The number of the contact.
    contact: usize,
    /// The first boundary.
    boundary: String,
    /// The pretension; `None` for periodic boundaries that do not move apart.
    pub tightened: Option<Section>,
    pub jump: Jump,
    /// The centroid of the boundary, m.
    centre: [f64; 3],
}

/// A section with a pretension.
#[derive(Debug, Clone, Copy)]
pub(super) struct Section {
    /// The number of the pretension.
    pub of: usize,
    /// The mean outward normal of the first boundary.
    pub normal: [f64; 3],
    tightening: Tightening,
}

impl Section {
    fn is_by_force(&self) -> bool {
        matches!(self.tightening, Tightening::Force { .. })
    }
}

impl Joints {
    /// Creates the joints of `description`.
    pub(super) fn new(description: &Description, mesh: &Mesh) -> Result<Self, InputError> {
        let mut all = Vec::new();
        for (contact, given) in description.contacts.iter().enumerate() {
            let pretensions = &description.pretensions;
            let of = pretensions.iter().position(|pretension| pretension.boundary == given.boundary);
            let shift = given.opposite().and_then(|opposite| opposite.shift);
            if of.is_none() && shift.is_none() {
                continue;
            }
            if let Some(shift) = shift {
                let key = format!("contact[{contact}].shift");
                super::place::suits(mesh, shift, &key)?;
                if mesh.geometry.is_revolved() && shift.components()[0] != 0.0 {
                    let message = "a body of revolution is periodic along its axis only";
                    return Err(InputError::new(key, message, "give [0, y]"));
                }
            }
            let boundary = find(mesh, &given.boundary, &format!("contact[{contact}]"))?;
            let section = |of: usize| -> Result<Section, InputError> {
                let normal = normal(mesh, boundary, of)?;
                Ok(Section { of, normal, tightening: pretensions[of].tightening })
            };
            all.push(Joint {
                contact,
                boundary: given.boundary.clone(),
                tightened: of.map(section).transpose()?,
                jump: Jump { node: boundary.facets.first().map_or(0, |facet| facet[0]), sum: Vec::new() },
                centre: centre(mesh, boundary),
            });
        }
        Ok(Joints { all })
    }

    /// Fails if a contact that is not glued ends at periodic boundaries that a pretension moves: the nodes at both ends of the
    /// period have one row of contact, but would not move alike.
    pub(super) fn meet_no_contact(&self, description: &Description, mesh: &Mesh) -> Result<(), InputError> {
        let nodes = |name: &String| mesh.boundary(name).map_or_else(Vec::new, Boundary::nodes);
        for joint in self.all.iter().filter(|joint| joint.tightened.is_some()) {
            let Some(period) = description.contacts[joint.contact].opposite().filter(|own| own.shift.is_some()) else {
                continue;
            };
            let ends: BTreeSet<usize> =
                std::iter::once(&joint.boundary).chain(&period.boundaries).flat_map(nodes).collect();
            for (k, contact) in description.contacts.iter().enumerate() {
                let opposite = contact.opposite();
                let mut sides =
                    std::iter::once(&contact.boundary).chain(opposite.iter().flat_map(|other| &other.boundaries));
                let glued = opposite.is_some_and(|other| other.glued);
                if !glued && sides.any(|name| nodes(name).iter().any(|node| ends.contains(node))) {
                    let message = format!(
                        "`{}` ends at the periodic boundary `{}`, which a pretension moves",
                        contact.boundary, joint.boundary
                    );
                    let help = "end one contact boundary an element before the period does; contact forces at both ends of a \
                                period belong to one node, which has one row of contact";
                    return Err(InputError::new(format!("contact[{k}].boundary"), message, help));
                }
            }
        }
        Ok(())
    }

    /// Returns the directions along which jump `k` is held.
    pub(super) fn held(&self, k: usize, mesh: &Mesh) -> Vec<[f64; 3]> {
        let components = mesh.components();
        match self.all[k].tightened {
            Some(section) if section.is_by_force() => {
                normal_frame(section.normal, components)[..components - 1].to_vec()
            }
            _ => [0, 1, 2].map(axis)[..components].to_vec(),
        }
    }

    /// Returns the number of the jump of contact `k`.
    fn of_contact(&self, k: usize) -> Option<usize> {
        self.all.iter().position(|joint| joint.contact == k)
    }

    /// Returns the coefficient of a jump in a row of its pair, whose slave has this name: the sum of those of the slave,
    /// negative if the slave is not the first boundary.
    fn factor(&self, jump: usize, slave: &str, row: &MortarRow) -> f64 {
        let whole: f64 = row.slave.iter().map(|(_, c)| c).sum();
        if slave == self.all[jump].boundary { whole } else { -whole }
    }

    /// Adds the jump of contact `k`, if it has one, to the relation of a row of its pair, whose slave has this name.
    pub(super) fn with_jump(
        &self,
        dofs: &Dofs,
        k: usize,
        slave: &str,
        row: &MortarRow,
        mut relation: Relative,
    ) -> Relative {
        if let Some(jump) = self.of_contact(k) {
            relation.others.push((dofs.node_of_jump(jump), Coefficient::Factor(self.factor(jump, slave, row))));
        }
        relation
    }

    /// Fails if a node of the `slave` of contact `k` cannot follow its jump: a support holds it, or another relation
    /// determines its displacement, as for the nodes `used`.
    pub(super) fn may_follow(
        &self,
        description: &Description,
        mesh: &Mesh,
        dofs: &Dofs,
        k: usize,
        slave: &Boundary,
        used: &BTreeSet<usize>,
    ) -> Result<(), InputError> {
        let joint = self.of_contact(k).map(|joint| &self.all[joint]);
        let Some(Section { of, normal, .. }) = joint.and_then(|joint| joint.tightened) else { return Ok(()) };
        let periodic = description.contacts[k].opposite().is_some_and(|opposite| opposite.shift.is_some());
        let key = format!("pretension[{of}].boundary");
        let place = |node: usize| description.system(mesh.dimension).point(mesh.nodes[node]);
        for node in slave.nodes() {
            if dofs.held(node).any(|n| dot(n, normal).abs() > SAME_DIRECTION) {
                let message = format!("a support holds the node of `{}` at {}, which moves", slave.name, place(node));
                let help = "support boundaries that share no node with the section, or sliding along it only";
                return Err(InputError::new(key, message, help));
            }
            // The corners of bodies that are periodic along two axes belong to both.
            if !periodic && used.contains(&node) {
                let message = format!(
                    "the node of `{}` at {} is also glued or coupled otherwise, so that it cannot move",
                    slave.name,
                    place(node)
                );
                let help = "let the section share no node with couplings and other glued boundaries";
                return Err(InputError::new(key, message, help));
            }
        }
        Ok(())
    }

    /// Returns the jump of contact `k` as a sum of displacements, from a row of its pair, whose slave has this name.
    pub(super) fn sum(&self, k: usize, slave: &str, row: &MortarRow) -> Option<(usize, Vec<(usize, f64)>)> {
        let jump = self.of_contact(k)?;
        let whole = self.factor(jump, slave, row);
        let own = row.slave.iter().map(|&(node, c)| (node, c / whole));
        Some((jump, own.chain(row.master.iter().map(|&(node, c)| (node, -c / whole))).collect()))
    }

    /// Returns the tie of a row of contact `k` along the unit vector `n`, from its form without the jump: a jump on which
    /// a force acts is subtracted.
    pub(super) fn tied(&self, dofs: &Dofs, k: usize, slave: &str, row: &MortarRow, n: [f64; 3], form: Tie) -> Tie {
        let Some(jump) = self.of_contact(k) else { return form };
        let Some(Section { normal, .. }) = self.all[jump].tightened.filter(Section::is_by_force) else { return form };
        let along = self.factor(jump, slave, row) * dot(n, normal);
        let jump = dofs.sum_of_jump(jump).iter().map(|&(node, c)| (node, normal.map(|x| -along * c * x)));
        form.into_iter().chain(jump.filter(|_| along != 0.0)).collect()
    }

    /// Returns the jumps that a force tightens if `by_force`, otherwise those that are prescribed: the node of each with the
    /// force (N) or the jump (m) at factor 1, and the history.
    pub(super) fn tightened<'a>(
        &'a self,
        description: &'a Description,
        dofs: &'a Dofs,
        by_force: bool,
    ) -> impl Iterator<Item = ((usize, [f64; 3]), Vec<[f64; 2]>)> + 'a {
        self.sections().filter(move |(_, section)| section.is_by_force() == by_force).map(move |(k, section)| {
            let size = match section.tightening {
                Tightening::Force { plane, .. } if dofs.dimension == 2 => plane,
                Tightening::Force { space, .. } => space,
                Tightening::Shortening(by) => by,
            };
            let factors = description.pretensions[section.of].factors(description.end());
            let history = within(description.end(), &factors);
            ((dofs.node_of_jump(k), section.normal.map(|n| size * n)), history)
        })
    }

    /// Returns the number of the pretension of the jump at `node`, and the centroid of its section, m.
    pub(super) fn section(&self, dofs: &Dofs, node: usize) -> Option<(usize, [f64; 3])> {
        let joint = self.all.get(node.checked_sub(dofs.node_of_jump(0))?)?;
        Some((joint.tightened?.of, joint.centre))
    }

    /// Returns the sections with the numbers of their jumps.
    pub(super) fn sections(&self) -> impl Iterator<Item = (usize, Section)> + '_ {
        self.all.iter().enumerate().filter_map(|(k, joint)| Some((k, joint.tightened?)))
    }
}

/// Returns the mean outward normal of the section of pretension `of`.
fn normal(mesh: &Mesh, boundary: &Boundary, of: usize) -> Result<[f64; 3], InputError> {
    let key = format!("pretension[{of}].boundary");
    let areas = boundary.facets.iter().map(|facet| mesh.area_vector(facet));
    let (sum, whole) = areas.fold(([0.0; 3], 0.0), |(sum, whole), area| (plus(sum, 1.0, area), whole + norm(area)));
    if !(whole > 0.0 && norm(sum) >= FLAT * whole) {
        let message = format!("`{}` has no direction: its facets face different ways", boundary.name);
        return Err(InputError::new(key, message, "cut the bolt along a plane across its axis"));
    }
    let normal = unit(unit(sum).map(|n| if n.abs() > ROUNDING { n } else { 0.0 }));
    if mesh.geometry.is_revolved() && normal[0] != 0.0 {
        let message = format!("`{}` is not across the axis of the body of revolution", boundary.name);
        return Err(InputError::new(key, message, "cut the bolt along a plane y = constant"));
    }
    Ok(normal)
}

/// Returns the centroid of a boundary, m; of a body of revolution on its axis.
fn centre(mesh: &Mesh, boundary: &Boundary) -> [f64; 3] {
    let (mut sum, mut whole) = ([0.0; 3], 0.0);
    for facet in &boundary.facets {
        let area = norm(mesh.area_vector(facet));
        let middle = facet.iter().fold([0.0; 3], |sum, node| plus(sum, 1.0 / facet.len() as f64, mesh.nodes[*node]));
        (sum, whole) = (plus(sum, area, middle), whole + area);
    }
    let centre = sum.map(|x| if whole > 0.0 { x / whole } else { x });
    if mesh.geometry.is_revolved() { [0.0, centre[1], 0.0] } else { centre }
}

/// Returns `mesh` with the nodes of `opposite` moved in front of the other side of the pair; `None` without a shift.
pub(super) fn shifted(mesh: &Mesh, opposite: &Opposite, boundary: &Boundary) -> Option<Mesh> {
    let shift = opposite.shift?.components();
    let mut moved = mesh.clone();
    for node in boundary.nodes() {
        moved.nodes[node] = plus(mesh.nodes[node], 1.0, shift);
    }
    Some(moved)
}
