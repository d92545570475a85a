//! Pairs of boundaries: choice of the slave, mortar rows and relative displacements.

use std::collections::{BTreeMap, BTreeSet};

use super::coupling::Couplings;
use super::find;
use super::holding::{self, Holding};
use super::joint::{self, Joints};
use super::place::suits;
use crate::algebra::vector::{across, axis, dot, minus, norm, plus, unit};
use crate::base::formula::Field;
use crate::base::input_error::InputError;
use crate::base::units::{Quantity, UnitSystem};
use crate::body::constraints::{Apart, Bonds, Dofs, Relative, SAME_DIRECTION, Tie};
use crate::body::contact::{
    ContactNode, Mortar, MortarFault, MortarOptions, MortarRow, SlaveChoice, Supports, coupled_nodes, outsides,
    relative,
};
use crate::body::description::{Description, Opposite, Slave};
use crate::body::fem::Elasticity;
use crate::body::mesh::{Bodies, Boundary, Mesh};

/// The largest initial overlap of two bodies, as a share of the thickness, as for obstacles.
const DEEPEST: f64 = 0.2;

/// The largest gap of a period, as a share of its length, and the largest share of a facet without anything in front of it:
/// coordinates are rounded.
const NEAR: f64 = 1e-3;

/// Two boundaries in contact with each other.
#[derive(Debug, Clone)]
pub struct Pair {
    /// The number of the contact in the description.
    pub contact: usize,
    /// The boundary whose nodes have the contact forces.
    pub slave: String,
    /// The other boundary; if it combines several boundaries, it has their facets and names.
    pub master: Boundary,
    /// The choice of the slave, if it was automatic.
    pub choice: Option<SlaveChoice>,
    /// `true` if the two are glued.
    pub glued: bool,
    /// The origin of its gaps at the beginning.
    pub gap: Option<Field>,
    /// `true` if the master is moved by a period to be in front of the slave.
    pub shifted: bool,
    /// `true` if a jump is between the two: pretension, or periodic boundaries.
    pub jumps: bool,
    /// The mortar rows.
    pub mortar: Mortar,
    /// The gap of each row when the history begins, m.
    pub gaps: Vec<f64>,
    /// If a direction is given: the slope of the slave's surface relative to it at each node, the tangent of the angle.
    pub(super) slopes: BTreeMap<usize, f64>,
    /// The shortest edge of the facets in front of each slave node, m.
    pub(crate) edges: BTreeMap<usize, f64>,
    /// The nodes of the rows that determine a displacement, each with the node that it determines: relative to the others of the
    /// row. It is the row's own one, except where glue joins what is held or carried.
    relative: BTreeMap<usize, usize>,
}

/// The pairs of a description.
#[derive(Debug, Clone, Default)]
pub(super) struct Pairs {
    pub all: Vec<Pair>,
    /// The nodes whose displacements are relative to others.
    pub relative: Vec<Relative>,
}

/// The body that pairs are on, before they tie its displacements.
struct Untied<'a> {
    description: &'a Description,
    mesh: &'a Mesh,
    dofs: &'a Dofs,
    materials: &'a [Elasticity],
    couplings: &'a Couplings,
    joints: &'a Joints,
    /// The supports that move each node.
    moving: BTreeMap<usize, Vec<Moving>>,
    /// The nodes that depend on reference points.
    dependent_nodes: BTreeSet<usize>,
}

impl<'a> Untied<'a> {
    /// Returns the contacts between two boundaries that are `glued`, or those that are not, with their numbers.
    fn contacts(&self, glued: bool) -> impl Iterator<Item = (usize, &'a Opposite)> + use<'a> {
        let contacts = self.description.contacts.iter().enumerate();
        contacts.filter_map(move |(k, contact)| Some((k, contact.opposite().filter(|other| other.glued == glued)?)))
    }

    /// Creates the glued pair of contact `k`; the nodes of `idle` need no row.
    fn glue(
        &self,
        (k, opposite): (usize, &Opposite),
        slaves: &BTreeSet<String>,
        idle: &BTreeSet<usize>,
    ) -> Result<Pair, InputError> {
        let Untied { description, mesh, dofs, materials, moving, dependent_nodes, .. } = self;
        let first = find(mesh, &description.contacts[k].boundary, &format!("contact[{k}]"))?;
        let is_fixed = |node: &usize| dependent_nodes.contains(node) || dofs.held(*node).count() == 3;
        let sides = [first, &self::opposite(mesh, opposite, k)?];
        let joins = !sides.iter().any(|side| side.nodes().iter().all(is_fixed));
        let tied = if joins { idle } else { &idle.union(dependent_nodes).copied().collect() };
        let supports = OfNodes { dofs, tied, joins, moving };
        pair(description, mesh, k, opposite, materials, (&supports, &|node| node), slaves)
    }

    /// Creates the glued pairs and adds their slaves to `slaves`. A node that a support, a reference point or another row
    /// determines needs no row if the opposite side depends on the same nodes.
    fn glued(&self, relations: &[Relative], slaves: &mut BTreeSet<String>) -> Result<Vec<Pair>, InputError> {
        let (mut bonds, mut pairs) = (Bonds::new(relations), Vec::<Pair>::new());
        let (mut later, mut slaves_before) = (Vec::new(), Vec::new());
        for contact in self.contacts(true) {
            let pair = self.glue(contact, slaves, &BTreeSet::new())?;
            slaves_before.push(slaves.clone());
            slaves.insert(pair.slave.clone());
            for (r, row) in pair.mortar.rows.iter().enumerate() {
                if bonds.bind(row.node) || !held_alone(self.dofs, row).is_empty() {
                    later.push((pairs.len(), r));
                } else {
                    bonds.add(relative(row, true));
                }
            }
            pairs.push(pair);
        }
        let mut idle = vec![BTreeSet::new(); pairs.len()];
        for (p, r) in later {
            let row = &pairs[p].mortar.rows[r];
            let own = bonds.roots(row.node);
            if bonds.bind(row.node) && row.master.iter().any(|(other, _)| !bonds.roots(*other).is_disjoint(&own)) {
                idle[p].insert(row.node);
            }
        }
        for (p, contact) in self.contacts(true).enumerate().filter(|(p, _)| !idle[*p].is_empty()) {
            pairs[p] = self.glue(contact, &slaves_before[p], &idle[p])?;
        }
        Ok(pairs)
    }
}

impl Pairs {
    /// Creates the pairs of `description`, whose supports hold the displacements in `dofs` and `holdings`. Glued pairs
    /// are first, since a tied node has no displacement that could be relative.
    pub(super) fn new(
        description: &Description,
        mesh: &Mesh,
        dofs: &Dofs,
        holdings: &[Holding],
        materials: &[Elasticity],
        (couplings, joints): (&Couplings, &Joints),
    ) -> Result<Self, InputError> {
        let relations = holding::relations(couplings, description, mesh, dofs, holdings)?;
        let (moving, dependent_nodes) = (moving(description, holdings), couplings.dependent_nodes());
        let body = Untied { description, mesh, dofs, materials, couplings, joints, moving, dependent_nodes };
        // Boundaries whose contact does not choose the slave automatically are slaves in any case.
        let chosen = |opposite: &Opposite| opposite.slave == Slave::Automatic;
        let named = description.contacts.iter().filter(|contact| !contact.opposite().is_some_and(chosen));
        let mut slaves: BTreeSet<String> = named.map(|contact| contact.boundary.clone()).collect();
        let mut bonds = Bonds::new(&relations);
        let mut pairs = Pairs { all: body.glued(&relations, &mut slaves)?, relative: relations };
        pairs.tie(&body, &mut bonds)?;
        pairs.touch(&body, &mut bonds, slaves)?;
        Ok(pairs)
    }

    /// Makes displacements relative to others by the rows of the glued pairs: first the rows of free nodes.
    fn tie(&mut self, body: &Untied<'_>, bonds: &mut Bonds) -> Result<(), InputError> {
        let Untied { description, mesh, dofs, joints, ref dependent_nodes, .. } = *body;
        let (mut first, mut later, mut used) = (Vec::new(), Vec::new(), dependent_nodes.clone());
        for (p, pair) in self.all.iter().enumerate() {
            let slave = find(mesh, &pair.slave, "contact")?;
            joints.may_follow(description, mesh, dofs, pair.contact, slave, &used)?;
            for (r, row) in pair.mortar.rows.iter().enumerate() {
                let is_free = used.insert(row.node) && held_alone(dofs, row).is_empty();
                if is_free { first.push((p, r)) } else { later.push((p, r)) }
            }
        }
        for (p, r) in first.into_iter().chain(later) {
            let pair = &mut self.all[p];
            let row = &pair.mortar.rows[r];
            let relation = joints.with_jump(dofs, pair.contact, &pair.slave, row, relative(row, true));
            let solved = bonds.solved(dofs, relation, &held_alone(dofs, row)).map_err(|Apart| {
                let place = description.system(mesh.dimension).point(mesh.nodes[row.node]);
                let message = format!(
                    "at {place}, supports or couplings determine both sides of the glued `{}`, each in its own way",
                    pair.slave
                );
                let help = "let the same supports, or the same coupling, hold both sides there";
                InputError::new(format!("contact[{}].glue", pair.contact), message, help)
            })?;
            if let Some(solved) = solved {
                pair.relative.insert(row.node, solved.node);
                bonds.add(solved.clone());
                self.relative.push(solved);
            }
        }
        for relation in self.relative.iter_mut().skip(dependent_nodes.len()) {
            *relation = bonds.resolved(dofs, relation);
        }
        Ok(())
    }

    /// Adds the pairs that are not glued. At both ends of a period, a contact has one row for the nodes that move alike,
    /// and none for others that are tied.
    fn touch(&mut self, body: &Untied<'_>, bonds: &mut Bonds, mut slaves: BTreeSet<String>) -> Result<(), InputError> {
        let Untied { description, mesh, dofs, materials, couplings, joints, moving, .. } = body;
        let has_periods = self.all.iter().any(|pair| pair.shifted);
        let untied = Dofs::clone(dofs);
        let with_ties = if has_periods { self.clone().dofs(description, mesh, joints, untied)? } else { untied };
        let periodic = self.all.iter().filter(|pair| pair.shifted).flat_map(|pair| pair.relative.values());
        let mut tied = couplings.rigid_bodies();
        tied.extend(periodic.filter(|node| with_ties.moving_alike(**node) == **node));
        for (k, opposite) in body.contacts(false) {
            let supports = OfNodes { dofs, tied: &tied, joins: false, moving };
            let alike = |node: usize| with_ties.moving_alike(node);
            let mut pair = pair(description, mesh, k, opposite, materials, (&supports, &alike), &slaves)?;
            slaves.insert(pair.slave.clone());
            for row in &pair.mortar.rows {
                if !bonds.bind(row.node) {
                    bonds.add(relative(row, false));
                    self.relative.push(relative(row, false));
                    pair.relative.insert(row.node, row.node);
                }
            }
            self.all.push(pair);
        }
        Ok(())
    }

    /// Adds the relative displacements to `dofs`.
    pub(super) fn dofs(
        &mut self,
        description: &Description,
        mesh: &Mesh,
        joints: &Joints,
        mut dofs: Dofs,
    ) -> Result<Dofs, InputError> {
        if self.relative.is_empty() {
            return Ok(dofs);
        }
        for pair in &self.all {
            let row = pair.mortar.rows.iter().find(|row| pair.relative.contains_key(&row.node));
            if let Some((jump, sum)) = row.and_then(|row| joints.sum(pair.contact, &pair.slave, row)) {
                dofs.set_jump(jump, sum);
            }
        }
        dofs.relative_to(std::mem::take(&mut self.relative)).map_err(|ring| {
            let place = description.system(mesh.dimension).point(mesh.nodes[ring.0]);
            let of = self.all.iter().find(|pair| pair.relative.values().any(|node| *node == ring.0));
            let k = of.map_or(0, |pair| pair.contact);
            let message =
                format!("the node at {place} is in front of nodes that are, in other contacts, in front of it");
            let help = "let boundary and against change places in one of these contacts";
            InputError::new(format!("contact[{k}].against"), message, help)
        })
    }

    /// Returns the number of the pair of contact `k`, if it is in front of another boundary.
    pub(super) fn of_contact(&self, k: usize) -> Option<usize> {
        self.all.iter().position(|pair| pair.contact == k)
    }

    /// Returns the ties of glued pairs: sums of displacements along axes that are 0.
    pub(super) fn ties(&self, dofs: &Dofs, joints: &Joints) -> Vec<Tie> {
        let glued = self.all.iter().filter(|pair| pair.glued);
        let rows = glued.flat_map(|pair| {
            pair.mortar.rows.iter().filter_map(move |row| Some((pair, row, *pair.relative.get(&row.node)?)))
        });
        let of_row = |(pair, row, determined): (&Pair, &MortarRow, usize)| {
            let along = |n: [f64; 3]| {
                let own = row.slave.iter().map(|&(node, c)| (node, n.map(|x| c * x)));
                let form = own.chain(row.master.iter().map(|&(node, c)| (node, n.map(|x| -c * x)))).collect();
                joints.tied(dofs, pair.contact, &pair.slave, row, n, form)
            };
            dofs.free_axes(determined).into_iter().map(along).collect::<Vec<_>>()
        };
        rows.flat_map(of_row).collect()
    }
}

/// Returns the directions in which supports hold the node of a row, but not the opposite side.
fn held_alone(dofs: &Dofs, row: &MortarRow) -> Vec<[f64; 3]> {
    let across_still = |n: &[f64; 3]| norm(row.still.iter().copied().fold(*n, across));
    dofs.held(row.node).filter(|n| across_still(n) > SAME_DIRECTION).collect()
}

/// The supports of a description at each node.
struct OfNodes<'a> {
    dofs: &'a Dofs,
    /// The nodes that need no row, as their displacements are determined by other nodes or by a reference point.
    tied: &'a BTreeSet<usize>,
    /// `true` if nodes that only supports hold have rows, which join them to the other side.
    joins: bool,
    moving: &'a BTreeMap<usize, Vec<Moving>>,
}

/// A support that moves a node: its history, its direction, and its displacement (m) at factor 1.
type Moving = (Vec<[f64; 2]>, [f64; 3], f64);

/// Returns the supports that move each node.
fn moving(description: &Description, holdings: &[Holding]) -> BTreeMap<usize, Vec<Moving>> {
    let mut moving = BTreeMap::<usize, Vec<Moving>>::new();
    for (support, holding) in description.supports.iter().zip(holdings).filter(|(support, _)| support.moves()) {
        let history = support.factors(description.end());
        for &(node, n, to) in holding.iter().filter(|(.., to)| *to != 0.0) {
            moving.entry(node).or_default().push((history.clone(), n, to));
        }
    }
    moving
}

impl Supports for OfNodes<'_> {
    fn held(&self, node: usize) -> Vec<[f64; 3]> {
        if self.tied.contains(&node) && !self.joins {
            [0, 1, 2].map(axis).to_vec()
        } else {
            self.dofs.held(node).collect()
        }
    }

    fn settled(&self, node: usize, still: &[[f64; 3]]) -> Vec<[f64; 3]> {
        match self.joins {
            true if self.tied.contains(&node) => [0, 1, 2].map(axis).to_vec(),
            true => still.to_vec(),
            false => self.held(node),
        }
    }

    fn move_apart(&self, nodes: [usize; 2], n: [f64; 3]) -> bool {
        let along = |node: usize| {
            let of_node = self.moving.get(&node).into_iter().flatten();
            of_node.filter(|(_, direction, _)| dot(*direction, n).abs() > SAME_DIRECTION).collect::<Vec<_>>()
        };
        along(nodes[0]) != along(nodes[1])
    }
}

impl Pair {
    /// Returns `true` if its gaps are those between the facets.
    pub fn is_measured(&self) -> bool {
        self.mortar.rows.iter().zip(&self.gaps).all(|(row, gap)| row.gap == *gap)
    }

    /// Creates its contact nodes.
    pub(super) fn nodes(&self, mesh: &Mesh, dofs: &Dofs, number: usize) -> Vec<ContactNode> {
        let gaps: BTreeMap<usize, f64> =
            self.mortar.rows.iter().map(|row| row.node).zip(self.gaps.iter().copied()).collect();
        let gap = |row: &MortarRow| [gaps[&row.node], if self.gap.is_none() { row.edges } else { 0.0 }];
        coupled_nodes(mesh, dofs, number, &self.mortar.rows, gap, |node| self.relative.contains_key(&node))
    }
}

/// Returns the opposite side of contact `k` as one boundary.
pub(super) fn opposite(mesh: &Mesh, opposite: &Opposite, k: usize) -> Result<Boundary, InputError> {
    let of_name = |name: &String| {
        let found = find(mesh, name, &format!("contact[{k}]"));
        found.map_err(|fault| InputError { key: format!("contact[{k}].against"), ..fault })
    };
    let all = opposite.boundaries.iter().map(of_name).collect::<Result<Vec<_>, _>>()?;
    let facets = all.iter().flat_map(|boundary| boundary.facets.iter().cloned()).collect();
    Ok(Boundary { name: opposite.boundaries.join("+"), facets })
}

/// Fails if the shifted opposite of a periodic boundary is not in front of all of it, or nowhere meets it.
fn fits(mortar: &Mortar, opposite: &Opposite, units: &UnitSystem, key: &str) -> Result<(), InputError> {
    let Some(shift) = opposite.shift else { return Ok(()) };
    let gap = mortar.rows.iter().map(|row| row.gap).min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0);
    let covered = mortar.covered.iter().fold(1.0, |least: f64, share| least.min(*share));
    let message = if gap.abs() > NEAR * norm(shift.components()) {
        let gap = units.rounded(Quantity::Length, gap, 3);
        format!("the two sides of the period are at least {gap} apart after the shift")
    } else if covered < 1.0 - NEAR {
        format!(
            "after the shift, part of the boundary has nothing in front of it: {:.1} % of a facet is covered",
            100.0 * covered
        )
    } else {
        return Ok(());
    };
    Err(InputError::new(format!("{key}.shift"), message, "give the vector from the opposite boundary to this one"))
}

/// Creates the pair of contact `k`, which is in front of `opposite`.
fn pair(
    description: &Description,
    mesh: &Mesh,
    k: usize,
    opposite: &Opposite,
    materials: &[Elasticity],
    (supports, alike): (&dyn Supports, &dyn Fn(usize) -> usize),
    slaves: &BTreeSet<String>,
) -> Result<Pair, InputError> {
    let key = format!("contact[{k}]");
    let first = find(mesh, &description.contacts[k].boundary, &key)?;
    let second = &self::opposite(mesh, opposite, k)?;
    share_nothing(description, mesh, first, second, k)?;
    let moved = joint::shifted(mesh, opposite, second);
    let mesh = moved.as_ref().unwrap_or(mesh);
    let units = description.system(mesh.dimension);
    if let Some(direction) = opposite.direction.filter(|_| mesh.dimension == 2) {
        suits(mesh, direction, &format!("{key}.direction"))?;
    }
    let direction = opposite.direction.map(|direction| unit(direction.components()));
    let options = MortarOptions { search: opposite.search, direction };
    let refused = |fault: MortarFault| {
        let length = |x: f64| units.rounded(Quantity::Length, x, 4);
        let message = fault.message(length, |at| units.point(at.components()));
        InputError::new(format!("{key}.{}", fault.key()), message, fault.help())
    };
    let all_held = first.nodes().into_iter().all(|node| supports.held(node).len() == 3);
    if opposite.slave == Slave::Automatic && opposite.boundaries.len() > 1 {
        let message = "several boundaries that are against one cannot be the slave";
        return Err(InputError::new(format!("{key}.slave"), message, "remove the key, or name one boundary"));
    }
    let may_change = opposite.boundaries.len() == 1;
    let (mut mortar, choice) = if opposite.slave == Slave::Automatic || all_held && may_change {
        let young = [first, second].map(|boundary| young(mesh, boundary, materials));
        let are_slaves = [first, second].map(|boundary| slaves.contains(&boundary.name));
        let (mortar, choice) =
            Mortar::of_better_slave(mesh, [first, second], young, are_slaves, &options, supports).map_err(refused)?;
        (mortar, Some(choice))
    } else {
        (Mortar::new(mesh, first, second, &options, supports).map_err(refused)?, None)
    };
    fits(&mortar, opposite, &units, &key)?;
    mortar.join(alike);
    let swapped = choice.is_some_and(|choice| choice.slave == 1);
    let (slave, master) = if swapped { (second, first) } else { (first, second) };
    let gaps = gaps(mesh, &mortar, [slave, master], opposite, &units, &key)?;
    let tightened = description.pretensions.iter().any(|own| own.boundary == description.contacts[k].boundary);
    Ok(Pair {
        contact: k,
        slave: slave.name.clone(),
        master: master.clone(),
        choice,
        glued: opposite.glued,
        gap: opposite.gap.clone(),
        shifted: moved.is_some(),
        jumps: moved.is_some() || tightened,
        slopes: opposite.direction.map_or_else(BTreeMap::new, |_| slopes(mesh, slave, &mortar.rows)),
        edges: edges(mesh, master, &mortar.rows),
        mortar,
        gaps,
        relative: BTreeMap::new(),
    })
}

/// Returns the initial gap of each row of a mortar between `sides`, m; fails if the two are deep inside each other.
fn gaps(
    mesh: &Mesh,
    mortar: &Mortar,
    sides: [&Boundary; 2],
    opposite: &Opposite,
    units: &UnitSystem,
    key: &str,
) -> Result<Vec<f64>, InputError> {
    if opposite.glued {
        return Ok(vec![0.0; mortar.rows.len()]);
    }
    // A measured gap is a difference of coordinates; below their rounding it is 0.
    let coordinates = sides.map(Boundary::nodes).into_iter().flatten().flat_map(|node| mesh.nodes[node]);
    let touches = opposite.adjust.max(8.0 * f64::EPSILON * coordinates.fold(0.0, |most: f64, x| most.max(x.abs())));
    let adjusted = |gap: f64| if gap.abs() <= touches { 0.0 } else { gap };
    let gap = |row: &MortarRow| -> Result<f64, InputError> {
        let place = mesh.nodes[row.node];
        let gap = opposite.gap.as_ref().map_or_else(|| adjusted(row.gap - row.bulge), |gap| gap.at(place));
        if gap.is_finite() {
            return Ok(gap);
        }
        let message = format!("the gap is {gap} at the node at {}, but must be a number", units.point(place));
        Err(InputError::new(format!("{key}.gap"), message, "mend the formula"))
    };
    let gaps: Vec<f64> = mortar.rows.iter().map(gap).collect::<Result<_, _>>()?;
    let deepest = mortar.rows.iter().zip(&gaps).min_by(|a, b| a.1.total_cmp(b.1));
    let Some((row, gap)) = deepest else { return Ok(gaps) };
    let bodies = mesh.bodies();
    let [of_slave, of_master] = sides.map(|boundary| thickness(mesh, &bodies, boundary, row.normal));
    let thickness = of_slave.min(of_master);
    if *gap >= -DEEPEST * thickness {
        return Ok(gaps);
    }
    let [depth, thickness] = [-gap, thickness].map(|x| units.rounded(Quantity::Length, x, 3));
    let place = units.point(mesh.nodes[row.node]);
    let message = format!("the bodies start {depth} inside each other at {place}, where one is {thickness} thick");
    let (place, help) = match opposite.gap {
        None => ("against", "move a body out, or give the gap"),
        _ => ("gap", "the gap is in the scene's unit of length, and negative where bodies overlap: give a smaller one"),
    };
    Err(InputError::new(format!("{key}.{place}"), message, help))
}

/// Returns the slope of the surface of `slave` relative to the normal of each row, by its node: the tangent of the
/// angle.
fn slopes(mesh: &Mesh, slave: &Boundary, rows: &[MortarRow]) -> BTreeMap<usize, f64> {
    let normals = outsides(mesh, slave);
    let of_row = |row: &MortarRow| {
        let normal = normals.get(&row.node).copied().unwrap_or(row.normal);
        let along = dot(normal, row.normal);
        (row.node, norm(plus(normal, -along, row.normal)) / along)
    };
    rows.iter().map(of_row).collect()
}

/// Returns the shortest edge of the facets of `master` with a node in each row, by the slave node, m.
fn edges(mesh: &Mesh, master: &Boundary, rows: &[MortarRow]) -> BTreeMap<usize, f64> {
    let mut shortest: BTreeMap<usize, f64> = BTreeMap::new();
    for facet in &master.facets {
        let ends = facet.iter().zip(facet.iter().skip(1).chain(facet.first()));
        let least = ends.map(|(a, b)| norm(minus(mesh.nodes[*a], mesh.nodes[*b]))).fold(f64::INFINITY, f64::min);
        for node in facet {
            let edge = shortest.entry(*node).or_insert(f64::INFINITY);
            *edge = edge.min(least);
        }
    }
    let of_row = |row: &MortarRow| {
        let of_nodes = row.master.iter().filter_map(|(node, _)| shortest.get(node));
        (row.node, of_nodes.copied().fold(f64::INFINITY, f64::min))
    };
    rows.iter().map(of_row).collect()
}

/// Returns Young's modulus of the softest cell with a facet of `boundary`, Pa.
fn young(mesh: &Mesh, boundary: &Boundary, materials: &[Elasticity]) -> f64 {
    let nodes: BTreeSet<usize> = boundary.nodes().into_iter().collect();
    let at_boundary = |e: &usize| mesh.cells[*e].nodes.iter().any(|node| nodes.contains(node));
    let young = |e: usize| {
        let Elasticity { lambda, mu, .. } = materials[e];
        mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu)
    };
    (0..mesh.cells.len()).filter(at_boundary).map(young).fold(f64::INFINITY, f64::min)
}

/// Returns the thickness along `normal` of the body of `boundary`, m.
fn thickness(mesh: &Mesh, bodies: &Bodies, boundary: &Boundary, normal: [f64; 3]) -> f64 {
    let own = boundary.facets.first().map_or(0, |facet| bodies.of_nodes()[facet[0]]);
    let along = || bodies.nodes(own).map(|node| dot(mesh.nodes[node], normal));
    along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
}

/// Fails if two boundaries of one pair share a node; it would be in front of itself.
fn share_nothing(
    description: &Description,
    mesh: &Mesh,
    first: &Boundary,
    second: &Boundary,
    k: usize,
) -> Result<(), InputError> {
    let of_first: BTreeSet<usize> = first.nodes().into_iter().collect();
    let Some(node) = second.nodes().into_iter().find(|node| of_first.contains(node)) else { return Ok(()) };
    let place = description.system(mesh.dimension).point(mesh.nodes[node]);
    let message = format!("`{}` and `{}` have the node at {place} in common", first.name, second.name);
    let help = "let the bodies have nodes of their own: do not join them in Gmsh where they are in contact";
    Err(InputError::new(format!("contact[{k}].against"), message, help))
}
