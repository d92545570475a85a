//! The contact nodes of all boundaries and their opposite sides, with checks.

use std::collections::{BTreeMap, BTreeSet};

use super::constraints::Constraints;
use super::find;
use super::glued_contact::carry_glued;
use super::pair::Pairs;
use super::support::PrescribedMotion;
use crate::algebra::null_space::{self, null_space};
use crate::algebra::vector::{dot, plus};
use crate::base::input_error::InputError;
use crate::base::timeline::within;
use crate::base::units::{Quantity, UnitSystem, six_digits};
use crate::body::constraints::{Dofs, SAME_DIRECTION, merged};
use crate::body::contact::{
    ContactBoundary, ContactNode, Counterpart, NodeObstacle, ObstacleMotion, PlacedObstacle, Row, Unclear,
    contact_nodes, meetings, unreachable,
};
use crate::body::description::{Contact, Description};
use crate::body::mesh::{Boundary, Mesh, sorted};
use crate::solver::loading::FrictionHistory;
use crate::solver::problem::ProblemError;

/// The largest initial overlap of an obstacle and the body, as a share of the thickness of the body. Strains are about
/// this share, which is far beyond small deformations; a larger overlap is an input error.
const DEEPEST: f64 = 0.2;

/// The data of the body that contacts need.
struct ContactBody<'a> {
    description: &'a Description,
    mesh: &'a Mesh,
    constraints: &'a Constraints,
    pairs: &'a Pairs,
}

/// The contacts of a description.
#[derive(Default)]
pub(super) struct Contacts {
    pub nodes: Vec<ContactNode>,
    /// The friction coefficient of each node.
    pub mu: Vec<f64>,
    pub boundaries: Vec<ContactBoundary>,
    /// The obstacles in front of all boundaries, and their motions.
    pub obstacles: Vec<(PlacedObstacle, ObstacleMotion)>,
    /// The friction coefficients at the nodes of each boundary, before averaging at nodes of several boundaries.
    own_mu: Vec<Vec<f64>>,
    /// The contact nodes at each node of the mesh.
    at_node: BTreeMap<usize, Vec<usize>>,
}

impl Contacts {
    /// Creates the contacts of `description`, boundary by boundary.
    pub(super) fn new(
        description: &Description,
        mesh: &Mesh,
        constraints: &Constraints,
        pairs: &Pairs,
    ) -> Result<Self, InputError> {
        let mut contacts = Contacts::default();
        share_no_facet(description, mesh, pairs)?;
        edges_are_alike(description, mesh, pairs)?;
        let dofs = &constraints.dofs;
        let body = ContactBody { description, mesh, constraints, pairs };
        for k in 0..description.contacts.len() {
            not_between_rigid(description, mesh, dofs, k)?;
            match pairs.of_contact(k) {
                Some(pair) => contacts.add_pair(&body, k, pair)?,
                None => contacts.add(&body, k)?,
            }
        }
        let Contacts { nodes, mu, boundaries, own_mu, obstacles, .. } = &mut contacts;
        carry_glued((nodes, mu), (boundaries, own_mu), (pairs, obstacles));
        determined((&contacts.nodes, &contacts.mu), &contacts.boundaries, description, dofs)?;
        Ok(contacts)
    }

    /// Adds the contact nodes of a pair of boundaries, unless they are glued.
    fn add_pair(&mut self, body: &ContactBody<'_>, k: usize, number: usize) -> Result<(), InputError> {
        let ContactBody { description, mesh, constraints: Constraints { dofs, .. }, pairs } = *body;
        let (pair, contact) = (&pairs.all[number], &description.contacts[k]);
        if pair.glued {
            return Ok(());
        }
        let boundary = find(mesh, &pair.slave, &format!("contact[{k}]"))?;
        let units = description.system(mesh.dimension);
        // In the order of the nodes along the boundary.
        let mut nodes: BTreeMap<usize, ContactNode> =
            pair.nodes(mesh, dofs, number).into_iter().map(|node| (node.node, node)).collect();
        let nodes: Vec<ContactNode> = boundary.nodes().iter().filter_map(|node| nodes.remove(node)).collect();
        let mut own_mu = Vec::with_capacity(nodes.len());
        for node in &nodes {
            own_mu.push(friction(contact, &units, node, k)?);
        }
        refuse_idle_history(contact, &own_mu, k)?;
        let first = self.nodes.len();
        // The nodes at both ends of a period are one.
        let apart: BTreeSet<usize> = boundary.nodes().into_iter().map(|node| dofs.moving_alike(node)).collect();
        self.boundaries.push(ContactBoundary {
            name: pair.slave.clone(),
            contact: k,
            nodes: (first..first + nodes.len()).collect(),
            weights: nodes.iter().map(|node| node.weight).collect(),
            unreached: apart.len().saturating_sub(nodes.len()),
            obstacles: self.obstacles.len()..self.obstacles.len(),
            pair: Some(number),
        });
        for (i, node) in nodes.iter().enumerate() {
            self.at_node.entry(node.node).or_default().push(first + i);
        }
        self.mu.extend(&own_mu);
        self.nodes.extend(nodes);
        self.own_mu.push(own_mu);
        Ok(())
    }

    fn add(&mut self, body: &ContactBody<'_>, k: usize) -> Result<(), InputError> {
        let ContactBody { description, mesh, constraints, .. } = *body;
        let Constraints { dofs, prescribed, groups, .. } = constraints;
        let contact = &description.contacts[k];
        let boundary = find(mesh, &contact.boundary, &format!("contact[{k}]"))?;
        let mut obstacles = placed(contact, description.end(), mesh, boundary, k)?;
        for (_, motion) in &mut obstacles {
            // All bodies in front of one obstacle have the same rigid offset.
            let group = boundary.nodes().first().map_or(0, |&node| groups.of_node[node]);
            for PrescribedMotion { offset, history, .. } in prescribed {
                motion.pass(offset[group], history);
            }
        }
        let assigned = assigned(contact, body, boundary, &obstacles, k)?;
        let nodes = contact_nodes(mesh, dofs, boundary, &obstacles, &assigned);
        if nodes.is_empty() {
            let message = if assigned.len() < boundary.nodes().len() {
                format!("supports hold every node of `{}` that an obstacle reaches", contact.boundary)
            } else {
                format!("supports hold every node of the contact boundary `{}`", contact.boundary)
            };
            let help = "remove the contact or the support";
            return Err(InputError::new(format!("contact[{k}].boundary"), message, help));
        }
        let first = self.obstacles.len();
        self.obstacles.extend(obstacles);
        let mut own = ContactBoundary {
            name: contact.boundary.clone(),
            contact: k,
            nodes: Vec::with_capacity(nodes.len()),
            weights: Vec::with_capacity(nodes.len()),
            unreached: boundary.nodes().len() - assigned.len(),
            obstacles: first..self.obstacles.len(),
            pair: None,
        };
        let (mut own_mu, mut places) = (Vec::with_capacity(nodes.len()), BTreeMap::new());
        let units = description.system(mesh.dimension);
        for node in nodes {
            let (mu, weight) = (friction(contact, &units, &node, k)?, node.weight);
            let obstacle = node.obstacle().unwrap_or(0);
            let others = node.others.iter().map(|k| first + k).collect();
            let node = ContactNode { counterpart: Counterpart::Obstacle(first + obstacle), others, ..node };
            let i = self.add_node(node, mu, dofs, &contact.boundary, (&description.system(3), k))?;
            // Corners of a periodic body count as one node.
            let same = *places.entry(i).or_insert(own.nodes.len());
            if same < own.nodes.len() {
                own.weights[same] += weight;
                own_mu[same] += (mu - own_mu[same]) * (weight / own.weights[same]);
            } else {
                own.nodes.push(i);
                own.weights.push(weight);
                own_mu.push(mu);
            }
        }
        refuse_idle_history(contact, &own_mu, k)?;
        self.boundaries.push(own);
        self.own_mu.push(own_mu);
        Ok(())
    }

    /// Returns the history of friction if the coefficient of any contact varies in time: the part of each contact in
    /// the coefficients of its nodes.
    pub(super) fn friction_history(&self, description: &Description) -> Result<Option<FrictionHistory>, ProblemError> {
        let contacts = &description.contacts;
        if contacts.iter().all(|contact| contact.friction_history.is_none()) {
            return Ok(None);
        }
        let case = |(boundary, own): (&ContactBoundary, &Vec<f64>)| {
            let contact = &contacts[boundary.contact];
            let mut mu = vec![0.0; self.nodes.len()];
            boundary.shares(&self.nodes).zip(own).for_each(|((i, part), own)| mu[i] = part * own);
            let history = contact.friction_history.as_ref().map(|points| within(description.end(), points));
            (mu, history.unwrap_or_default())
        };
        let cases = self.boundaries.iter().zip(&self.own_mu).map(case).collect();
        FrictionHistory::new(self.nodes.len(), cases).map(Some)
    }

    /// Returns the number of a node of the boundary `name`: the number from an earlier boundary with the same normal, that
    /// of a node that is glued to it and has the same rows, or a new one. Fails for opposite normals, since forces of any size would cancel.
    fn add_node(
        &mut self,
        node: ContactNode,
        mu: f64,
        dofs: &Dofs,
        name: &str,
        (units, k): (&UnitSystem, usize),
    ) -> Result<usize, InputError> {
        let sharing = self.at_node.entry(dofs.moving_alike(node.node)).or_default();
        // Normals within one degree count as parallel; a sharper edge of a body cannot be meshed.
        let parallel = |i: &&usize| {
            let other = &self.nodes[**i];
            let alike = other.node == node.node || has_rows_of(&node, other);
            alike && other.obstacle().is_some() && dot(node.facing.normal, other.facing.normal).abs() > 0.9998
        };
        let Some(&same) = sharing.iter().find(parallel) else {
            sharing.push(self.nodes.len());
            self.nodes.push(node);
            self.mu.push(mu);
            return Ok(self.nodes.len() - 1);
        };
        let earlier = &self.nodes[same];
        if dot(node.facing.normal, earlier.facing.normal) < 0.0 {
            let place = units.point(node.position);
            let message =
                format!("the node at {place} of `{name}` lies in front of two obstacles with opposite normals");
            let help = "give an obstacle another normal, or let the boundaries share no node";
            return Err(InputError::new(format!("contact[{k}].obstacle"), message, help));
        }
        let weight = earlier.weight + node.weight;
        // The mean of equal coefficients is exactly their value.
        self.mu[same] += (mu - self.mu[same]) * (node.weight / weight);
        let gap = |node: &ContactNode| {
            node.obstacle().map_or(node.facing.gap, |k| {
                let (obstacle, motion) = &self.obstacles[k];
                motion.exact_gap(obstacle, 0.0, node.position, &node.facing)
            })
        };
        let (nearest, other) = if gap(&node) < gap(earlier) { (&node, earlier) } else { (earlier, &node) };
        let own = nearest.obstacle().map(|k| &self.obstacles[k].0);
        let presses_alike = |k: &usize| own.is_some_and(|own| self.obstacles[*k].0.presses_as(own));
        let further = other.obstacle().into_iter().chain(other.others.iter().copied()).filter(presses_alike);
        let others = nearest.others.iter().copied().chain(further).collect();
        self.nodes[same] = ContactNode { others, weight, ..nearest.clone() };
        Ok(same)
    }
}

/// Returns `true` if two contact nodes have the same rows.
fn has_rows_of(node: &ContactNode, other: &ContactNode) -> bool {
    let same = |a: &Row, b: &Row| {
        let sorted = |row: &Row| merged(row.clone());
        let (a, b) = (sorted(a), sorted(b));
        a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() <= SAME_DIRECTION)
    };
    same(&node.normal, &other.normal) && node.tangents.iter().zip(&other.tangents).all(|(a, b)| same(a, b))
}

/// Fails for a friction history without friction.
fn refuse_idle_history(contact: &Contact, own_mu: &[f64], k: usize) -> Result<(), InputError> {
    if contact.friction_history.is_none() || own_mu.iter().any(|mu| *mu != 0.0) {
        return Ok(());
    }
    let message = format!("friction_history multiplies a friction that is 0 on the whole of `{}`", contact.boundary);
    let help = "give the friction at factor 1, or remove the key";
    Err(InputError::new(format!("contact[{k}].friction_history"), message, help))
}

/// Fails if two contacts share a facet whose nodes carry the forces of both; the facet would count twice.
fn share_no_facet(description: &Description, mesh: &Mesh, pairs: &Pairs) -> Result<(), InputError> {
    let contacts = &description.contacts;
    if contacts.len() < 2 {
        return Ok(());
    }
    let mut whose: BTreeMap<Vec<usize>, &str> = BTreeMap::new();
    for (k, contact) in contacts.iter().enumerate() {
        let own = pairs.of_contact(k).map_or(&contact.boundary, |pair| &pairs.all[pair].slave);
        for facet in &find(mesh, own, &format!("contact[{k}]"))?.facets {
            let Some(other) = whose.insert(sorted(facet), own) else { continue };
            let corners = facet.len() as f64;
            let middle = facet.iter().fold([0.0; 3], |sum, node| plus(sum, 1.0 / corners, mesh.nodes[*node]));
            let place = description.system(mesh.dimension).point(middle);
            let message = format!("the boundaries `{other}` and `{own}` have the facet at {place} in common");
            let help = "let each facet be of one [[contact]]; several obstacles may be in front of one boundary";
            return Err(InputError::new(format!("contact[{k}].boundary"), message, help));
        }
    }
    Ok(())
}

/// Fails if an edge of second order is between a triangle and a quadrilateral with contact, on which the shares of its
/// ends differ, see [`Mesh::share_of_ends`]. The rows of glue are those of its own pair alone.
fn edges_are_alike(description: &Description, mesh: &Mesh, pairs: &Pairs) -> Result<(), InputError> {
    if mesh.dimension == 2 {
        return Ok(());
    }
    let mut of_contacts: BTreeMap<usize, f64> = BTreeMap::new();
    for (k, contact) in description.contacts.iter().enumerate() {
        let mut of_glue = BTreeMap::new();
        let is_glued = contact.opposite().is_some_and(|opposite| opposite.glued);
        let shares = if is_glued { &mut of_glue } else { &mut of_contacts };
        let pair = pairs.of_contact(k).map(|pair| &pairs.all[pair]);
        let own = find(mesh, pair.map_or(&contact.boundary, |pair| &pair.slave), &format!("contact[{k}]"))?;
        for facet in own.facets.iter().chain(pair.iter().flat_map(|pair| &pair.master.facets)) {
            let share = mesh.share_of_ends(facet);
            for [_, middle, _] in mesh.bent_edges(facet) {
                if *shares.entry(middle).or_insert(share) != share {
                    let place = description.system(mesh.dimension).point(mesh.nodes[middle]);
                    let message =
                        format!("a triangle and a quadrilateral of second order with contact meet at {place}");
                    let help = "let the boundaries with contact be of triangles alone or of quadrilaterals alone, or use \
                                cells of first order";
                    return Err(InputError::new(format!("contact[{k}].boundary"), message, help));
                }
            }
        }
    }
    Ok(())
}

/// Returns the friction coefficient of `node`.
fn friction(contact: &Contact, units: &UnitSystem, node: &ContactNode, k: usize) -> Result<f64, InputError> {
    let mu = contact.friction.at(node.position);
    if mu.is_finite() && mu >= 0.0 {
        return Ok(mu);
    }
    let place = units.point(node.position);
    let message = format!("the friction is {mu} at the contact node at {place}, but must be 0 or more");
    Err(InputError::new(format!("contact[{k}].friction"), message, "mend the formula, such as by max(0, ...)"))
}

/// Returns the obstacles of contact `k` in front of its `boundary`, and their motions.
fn placed(
    contact: &Contact,
    end: f64,
    mesh: &Mesh,
    boundary: &Boundary,
    k: usize,
) -> Result<Vec<(PlacedObstacle, ObstacleMotion)>, InputError> {
    let name = &contact.boundary;
    let place = |(j, given)| {
        let obstacle = PlacedObstacle::new(mesh, boundary, given).map_err(|error| {
            InputError::new(contact.obstacle_key(k, j), format!("contact at `{name}`: {error}"), error.help())
        })?;
        let motion = ObstacleMotion::new(given, obstacle.normal, end).of(&obstacle);
        Ok((obstacle, motion))
    };
    contact.obstacles().iter().enumerate().map(place).collect()
}

/// Returns the nodes of contact `k`, each with the obstacle that it meets.
fn assigned(
    contact: &Contact,
    body: &ContactBody<'_>,
    boundary: &Boundary,
    obstacles: &[(PlacedObstacle, ObstacleMotion)],
    k: usize,
) -> Result<Vec<NodeObstacle>, InputError> {
    let ContactBody { description, mesh, constraints: Constraints { dofs, prescribed, .. }, .. } = *body;
    let name = &contact.boundary;
    let at_obstacle =
        |j: usize, message: String, help: &str| InputError::new(contact.obstacle_key(k, j), message, help);
    let units = description.system(mesh.dimension);
    let place = |node: usize| units.point(mesh.nodes[node]);
    let times = &description.times;
    let assigned =
        meetings(mesh, boundary, obstacles, times).map_err(|Unclear { node, obstacle, time, why: (what, help) }| {
            let when = time.map_or(String::new(), |t| format!(" at t = {} s", six_digits(t)));
            at_obstacle(obstacle, format!("{what} the contact node at {}{when}", place(node)), help)
        })?;
    if let [(obstacle, _)] = obstacles
        && let Some(node) = obstacle.faces_away(mesh, boundary)
    {
        let (message, help) = if obstacle.has_one_normal() {
            let message = format!("the normal of the obstacle points into the body at `{name}`, or along it");
            (message, "let the normal point out of the body")
        } else {
            let what = "the nearest point of the obstacle is beside or behind the contact node at";
            let message = format!("{what} {}, from which the way there does not lead out of the body", place(node));
            (
                message,
                "use direction = \"normal\", which leaves open what the obstacle is not in front of, or a smaller boundary",
            )
        };
        return Err(at_obstacle(0, message, help));
    }
    let is_met_later = |j: usize| {
        let comes_nearest = |node: &NodeObstacle| {
            node.others.contains(&j) && times.iter().any(|t| node.nearest(obstacles, mesh.nodes[node.node], *t).0 == j)
        };
        assigned.iter().any(comes_nearest)
    };
    let is_met = |j: usize| assigned.iter().any(|node| node.obstacle == j) || is_met_later(j);
    if let Some(j) = (0..obstacles.len()).find(|j| !is_met(*j)) {
        let (message, help) = match obstacles.len() {
            1 => (
                format!("the obstacle is in front of no node of `{name}`, now or later"),
                "move the obstacle, give it another normal, or use smaller elements; triangles must be counterclockwise seen \
                 from the body",
            ),
            _ => (
                format!(
                    "no node of `{name}` meets this obstacle: to each another is nearer, or it is in front of none"
                ),
                "if it comes by within an increment, take more increments; otherwise remove or move it, or give it a boundary of its own",
            ),
        };
        return Err(at_obstacle(j, message, help));
    }
    let start = |node: &NodeObstacle| {
        let (obstacle, motion) = &obstacles[node.obstacle];
        motion.exact_gap(obstacle, 0.0, mesh.nodes[node.node], &node.facing)
    };
    for (j, (obstacle, _)) in obstacles.iter().enumerate() {
        let along = || mesh.nodes.iter().map(|x| dot(*x, obstacle.normal));
        let thickness = along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min);
        let own = assigned.iter().filter(|node| node.obstacle == j);
        if let Some(deepest) = own.min_by(|a, b| start(a).total_cmp(&start(b)))
            && start(deepest) < -DEEPEST * thickness
        {
            let [depth, thickness] = [-start(deepest), thickness].map(|x| units.rounded(Quantity::Length, x, 3));
            let place = place(deepest.node);
            let message =
                format!("the obstacle starts {depth} inside the body at {place}, which is {thickness} thick there");
            return Err(at_obstacle(j, message, "move the obstacle out, or the part of the motion before time 0"));
        }
    }
    let normal_deviation = |node: &NodeObstacle, t: f64| {
        prescribed.iter().map(|motion| motion.factor(t) * dot(motion.deviation[node.node], node.facing.normal)).sum()
    };
    if let Some(node) = unreachable(mesh, dofs, obstacles, &assigned, times, normal_deviation) {
        let message = format!("supports hold the body where the obstacle is or comes to be, at {}", place(node));
        let help = "use a gap of at least 0, a shorter approach or fewer supports";
        return Err(InputError::new(format!("contact[{k}].boundary"), message, help));
    }
    Ok(assigned)
}

/// The cure for such a contact.
const HELP: &str =
    "end the coupled boundary before the contact, use a distributing coupling, or let one part be elastic";

/// Fails if reference points carry every node of both sides of contact `k`.
fn not_between_rigid(description: &Description, mesh: &Mesh, dofs: &Dofs, k: usize) -> Result<(), InputError> {
    let contact = &description.contacts[k];
    let is_rigid = |name: &String| mesh.boundary(name).is_some_and(|boundary| dofs.are_rigid(&boundary.nodes()));
    let Some(opposite) = contact.opposite().filter(|_| is_rigid(&contact.boundary)) else { return Ok(()) };
    if !opposite.boundaries.iter().all(is_rigid) {
        return Ok(());
    }
    let message = format!("`{}` and the boundary against it are rigid by couplings", contact.boundary);
    Err(InputError::new(format!("contact[{k}].boundary"), message, HELP))
}

/// Fails if the forces of obstacles on the nodes that a reference point carries are not determined: their rows of `C_n`,
/// `C_t` and `C_o`, in the unknowns of the point, depend on each other.
///
/// `mu` are the friction coefficients of `nodes`.
pub(super) fn determined(
    (nodes, mu): (&[ContactNode], &[f64]),
    boundaries: &[ContactBoundary],
    description: &Description,
    dofs: &Dofs,
) -> Result<(), InputError> {
    let mut of_point: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (i, node) in nodes.iter().enumerate().filter(|(_, node)| node.obstacle().is_some()) {
        if let Some(point) = dofs.point_carrying(node.node) {
            of_point.entry(point).or_default().push(i);
        }
    }
    for nodes_of_point in of_point.values() {
        let rows = |&i: &usize| {
            let ContactNode { normal, tangents, .. } = &nodes[i];
            let tangents = tangents.iter().filter(move |row| mu[i] != 0.0 && !row.is_empty());
            std::iter::once(normal).chain(tangents)
        };
        let rows: Vec<_> = nodes_of_point.iter().flat_map(rows).collect();
        let mut columns = BTreeMap::new();
        for &(dof, _) in rows.iter().copied().flatten() {
            let next = columns.len();
            columns.entry(dof).or_insert(next);
        }
        let row = |row: &&Vec<(usize, f64)>| {
            let mut entries = vec![0.0; columns.len()];
            row.iter().for_each(|(dof, c)| entries[columns[dof]] += c);
            null_space::Row::of_unit_size(entries)
        };
        let free = null_space(columns.len(), rows.iter().map(row)).len();
        if columns.len() - free == rows.len() {
            continue;
        }
        let boundary = boundaries.iter().find(|boundary| nodes_of_point.iter().any(|i| boundary.nodes.contains(i)));
        let k = boundary.map_or(0, |boundary| boundary.contact);
        let message = format!(
            "a rigid coupling carries {} nodes in contact with a rigid obstacle, `{}` among them",
            nodes_of_point.len(),
            description.contacts[k].boundary,
        );
        return Err(InputError::new(format!("contact[{k}].boundary"), message, HELP));
    }
    Ok(())
}
