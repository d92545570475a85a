//! Checks the assumptions of the equations: small displacements, and gaps linearised in the undeformed state.

use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

use super::largest::is_as_large;
use super::warnings::{Warning, WarningKind};
use crate::algebra::vector::norm;
use crate::base::units::{Quantity, six_digits};
use crate::body::constraints::RigidMotion;
use crate::body::contact::{Passed, RangeLeft, TOLERATED_SHARE};
use crate::body::mesh::Boundary;
use crate::body::model::{BetweenNodes, Faceted, LargeMotion, Model, ObstacleChords, OnTheWay, Overlap, Pair, Slid};
use crate::solver::history::{IncrementView, Status};
use crate::solver::laws::ContactStatus;
use crate::solver::problem::State;
use crate::solver::uniqueness::{NeutralMotion, neutral_motions};

/// The displacement, relative to the body's size, above which displacements are not small. A rotation of this size
/// turns normals by six degrees, and the neglected squares of strains reach a percent.
pub const NOT_SMALL: f64 = 0.1;

/// The share of a force on nodes beyond the end of the other body above which it is reported.
const BEYOND_THE_END: f64 = 0.05;

/// The ratio of the error of pressures to the error of distances by the triangles of an obstacle, both relative: 2.3 to 2.8 for the peaks of cylinders of which 2 to 6 strips press.
const STIFFER_OBSTACLE: f64 = 2.6;

/// The error of pressures, and of gaps of pairs, by facets above which it is reported.
const FACETED: f64 = 0.1;

/// The depth of an obstacle's passage within an increment above which it is reported, relative to the indentation. For
/// an obstacle that rolls on, the friction is then off by a few percent at most.
const PASSES: f64 = 1.0;

/// The share of neglected friction above which it is reported.
const LEFT_OUT: f64 = 0.01;

/// The largest motion of a rigid body along its contact, as a share of half the width of the pressed zone. Pressures shift by
/// about this share.
const MOVED_ALONG: f64 = 0.1;

/// The slip of a node above which it is reported, relative to the size of the opposing facet.
const ACROSS_FACETS: f64 = 0.25;

/// Collects violated assumptions in the converged increments of a history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Validity {
    /// The largest displacement, if there was any increment.
    pub largest: Option<LargestDisplacement>,
    /// The largest error of the linearised gaps, if they were out of their range.
    pub range_left: Option<RangeLeft>,
    /// The pair with the largest share of its force beyond the end of the other body, that share, and the time, s;
    /// `None` without pairs.
    pub beyond: Option<(usize, f64, f64)>,
    /// The deepest penetration of a body into another one without a contact row, and the time, s.
    pub passed: Option<(Passed, f64)>,
    /// The effect of facets on the gaps of each pair with curved boundaries, at its largest force.
    pub faceted: Vec<Faceted>,
    /// The boundary with the largest share of neglected friction, that share, and the time, s.
    pub friction_left_out: Option<(usize, f64, f64)>,
    /// The largest slip of bodies relative to the size of their facets, if any, and the time, s.
    pub slid: Option<(Slid, f64)>,
    /// The largest motion of a rigid body along its contact, if any, and the time, s.
    pub large_motion: Option<(LargeMotion, f64)>,
    /// The contact node deepest inside an obstacle that it does not meet, if any, and the time, s.
    pub overlap: Option<(Overlap, f64)>,
    /// The largest deviation of an obstacle between nodes when contact forces were largest, if any, and the time, s.
    pub between: Option<(BetweenNodes, f64)>,
    /// The obstacle of triangles that is furthest from its curved surface when contact forces were largest, if any.
    pub chords: Option<ObstacleChords>,
    /// The deepest passage of an obstacle within an increment.
    pub on_the_way: Option<OnTheWay>,
    /// The end of the last increment, if the paths of obstacles are checked: its time, s, and its state.
    last: Option<(f64, State)>,
    /// The indentation by contact forces, m.
    pressed: f64,
    /// The largest normal force, N.
    largest_force: f64,
    /// The unconstrained motion of the first non-unique equilibrium, if any, and its time, s.
    pub neutral: Option<(NeutralMotion, f64)>,
    /// The contact node that touched the obstacle with the largest slope against the node's normal, and the slope.
    steepest: Option<(usize, f64)>,
    /// `true` for each contact node that ever touched its obstacle.
    touched: Vec<bool>,
}

/// The largest displacement of a history.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct LargestDisplacement {
    /// The length of the displacement, m.
    pub length: f64,
    /// The node's position, m.
    pub position: [f64; 3],
    /// The time, s.
    pub time: f64,
}

impl Validity {
    /// Begins with the first increment of `model`.
    pub fn new(model: &Model) -> Self {
        let touched = vec![false; model.contacts.len()];
        Validity {
            largest: None,
            range_left: None,
            beyond: None,
            passed: None,
            faceted: Vec::new(),
            friction_left_out: None,
            slid: None,
            large_motion: None,
            overlap: None,
            between: None,
            chords: None,
            on_the_way: None,
            last: model.has_passing_obstacles().then(|| (0.0, State::zero(&model.problem))),
            pressed: 0.0,
            largest_force: 0.0,
            neutral: None,
            steepest: None,
            touched,
        }
    }

    /// Returns `true` if the data belongs to `model`.
    pub(crate) fn fits(&self, model: &Model) -> bool {
        let contacts = model.contacts.len();
        let is_contact = |i: Option<usize>| i.is_none_or(|i| i < contacts);
        self.touched.len() == contacts
            && is_contact(self.steepest.map(|(i, _)| i))
            && is_contact(self.slid.map(|(slid, _)| slid.contact))
            && self.large_motion.is_none_or(|(motion, _)| motion.coupling < model.description().couplings.len())
            && is_contact(self.overlap.map(|(overlap, _)| overlap.contact))
            && self.overlap.is_none_or(|(overlap, _)| overlap.obstacle < model.obstacles.len())
            && self.beyond.is_none_or(|(pair, ..)| pair < model.pairs.len())
            && self.passed.is_none_or(|(passed, _)| passed.node < model.mesh.nodes.len())
            && self.faceted.iter().all(|faceted| faceted.pair < model.pairs.len())
            && self.chords.is_none_or(|chords| chords.obstacle < model.obstacles.len())
            && self.on_the_way.is_none_or(|found| found.contact < contacts)
            && self.last.as_ref().is_none_or(|(_, state)| state.check(&model.problem).is_ok())
            && self.friction_left_out.is_none_or(|(boundary, ..)| boundary < model.contact_boundaries.len())
            && self.neutral.as_ref().is_none_or(|(motion, _)| motion.weights.len() == model.rigid_motions.len())
    }

    /// Examines the end of an increment. Increments that did not converge are ignored.
    pub fn see(&mut self, model: &Model, step: &IncrementView<'_>) {
        let IncrementView { record, increment, state, statuses } = step;
        if record.status != Status::Converged {
            return;
        }
        let displaced = model.displaced(record.time, &state.u);
        if let Some(passed) = model.passed(&displaced)
            && self.passed.is_none_or(|(worst, _)| passed.depth > worst.depth)
        {
            self.passed = Some((passed, record.time));
        }
        for (position, u) in model.mesh.nodes.iter().zip(&displaced) {
            let u = *u;
            let largest = self.largest.map_or(-1.0, |largest| largest.length);
            // No length exceeds the sum of its components, which is faster to compute. NaN exceeds everything.
            if u.iter().map(|u| u.abs()).sum::<f64>() <= largest {
                continue;
            }
            let length = norm(u);
            if length > largest {
                self.largest = Some(LargestDisplacement { length, position: *position, time: record.time });
            }
        }
        for (i, _) in statuses.iter().enumerate().filter(|(_, status)| **status != ContactStatus::Open) {
            self.touched[i] = true;
            // The slope is that of the moving obstacle when it touches.
            let slope = model.slope(i, record.time);
            if !slope.is_nan() && self.steepest.is_none_or(|(_, steepest)| slope >= steepest) {
                self.steepest = Some((i, slope));
            }
        }
        if let Some(left) = model.range_left(record.time, state, increment.gap, statuses)
            && self.range_left.is_none_or(|worst| left.share.is_nan() || left.share > worst.share)
        {
            self.range_left = Some(left);
        }
        if let Some(slid) = model.slid(record.time, state, statuses)
            && self.slid.is_none_or(|(worst, _)| slid.share > worst.share)
        {
            self.slid = Some((slid, record.time));
        }
        if let Some(motion) = model.large_motion(record.time, state)
            && self.large_motion.is_none_or(|(worst, _)| motion.share > worst.share)
        {
            self.large_motion = Some((motion, record.time));
        }
        if let Some(overlap) = model.overlap(record.time, state)
            && self.overlap.is_none_or(|(deepest, _)| overlap.depth > deepest.depth)
        {
            self.overlap = Some((overlap, record.time));
        }
        if let Some((time, last)) = &mut self.last {
            if let Some(found) = model.on_the_way([*time, record.time], [&*last, state])
                && self.on_the_way.is_none_or(|worst| found.distance.abs() > worst.distance.abs())
            {
                self.on_the_way = Some(found);
            }
            (*time, *last) = (record.time, (*state).clone());
        }
        let pressed = model.pressed(record.time, state);
        if is_as_large(pressed, self.pressed) {
            self.pressed = pressed.max(self.pressed);
            self.chords = model.obstacle_chords(record.time, state);
            self.between = model.between_nodes(record.time, state, statuses).map(|between| (between, record.time));
        }
        if let Some((k, share)) = model.beyond_the_end(state)
            && self.beyond.is_none_or(|(_, worst, _)| share > worst)
        {
            self.beyond = Some((k, share, record.time));
        }
        for faceted in model.faceted(state) {
            match self.faceted.iter_mut().find(|before| before.pair == faceted.pair) {
                Some(before) if faceted.force > before.force => *before = faceted,
                Some(_) => (),
                None => self.faceted.push(faceted),
            }
        }
        if let Some((k, share)) = model.friction_left_out(state, increment.mu)
            && self.friction_left_out.is_none_or(|(_, worst, _)| share > worst)
        {
            self.friction_left_out = Some((k, share, record.time));
        }
        self.largest_force = state.p_n.iter().fold(self.largest_force, |most, p| most.max(*p));
        if self.neutral.is_none() {
            let neutral = neutral_motions(&model.problem, increment, state, statuses, self.largest_force);
            self.neutral = neutral.into_iter().next().map(|motion| (motion, record.time));
        }
    }

    /// Returns the deepest passage of an obstacle within an increment, unless it is small.
    pub(super) fn passage(&self) -> Option<OnTheWay> {
        self.on_the_way.filter(|found| found.distance.abs() > PASSES * self.pressed)
    }

    /// Returns the pairs whose facets change the gaps so much that pressures mean little.
    fn faceted_gaps(&self) -> impl Iterator<Item = &Faceted> {
        self.faceted.iter().filter(|faceted| faceted.bulge.abs() > FACETED * faceted.closed.abs())
    }

    /// Returns the largest displacement if it is not small.
    fn large_displacement(&self, model: &Model) -> Option<LargestDisplacement> {
        self.largest.filter(|largest| largest.length > NOT_SMALL * model.mesh.size())
    }

    /// Returns `true` if displacements are not small.
    pub(super) fn has_large_displacements(&self, model: &Model) -> bool {
        self.large_displacement(model).is_some()
    }

    /// Returns `true` if facets change the gaps in front of `boundary` so much that warnings of its pressures would
    /// name the wrong cause.
    pub(super) fn has_faceted_gaps(&self, model: &Model, boundary: &str) -> bool {
        let of_obstacle = |k: usize| {
            model.contact_boundaries.iter().any(|other| other.name == boundary && other.obstacles.contains(&k))
        };
        self.faceted_gaps().any(|faceted| model.pairs[faceted.pair].slave == boundary)
            || self.faceted_obstacle().is_some_and(|chords| of_obstacle(chords.obstacle))
    }

    /// Returns the obstacle whose triangles change distances so much that pressures mean little.
    fn faceted_obstacle(&self) -> Option<ObstacleChords> {
        self.chords.filter(|chords| STIFFER_OBSTACLE * chords.beyond > FACETED * self.pressed)
    }

    /// Returns the resulting warnings.
    pub fn warnings(&self, model: &Model) -> Vec<Warning> {
        let units = model.units();
        let unit = units.name(Quantity::Length);
        let mut warnings = Vec::new();
        let mut warn = |kind, message| warnings.push(Warning { kind, message });
        let mut boundaries = model.contact_boundaries.iter();
        // Without a converged increment, nothing is known of the contact.
        let untouched = boundaries.find(|boundary| !boundary.nodes.iter().any(|&i| self.touched[i]));
        if let (Some(boundary), Some(_)) = (untouched, self.largest) {
            let message = match boundary.pair.map(|k| &model.pairs[k].master.name) {
                None => format!(
                    "`{}` never touched its obstacle; `stickslip check` shows where the obstacle is and how it moves",
                    boundary.name
                ),
                Some(master) => {
                    format!(
                        "`{}` never touched `{master}`; `stickslip check` shows how far apart they are",
                        boundary.name
                    )
                }
            };
            warn(WarningKind::NoContact, message);
        }
        if let Some((i, slope)) = self.steepest.filter(|(_, slope)| *slope > NOT_SMALL) {
            let message = if model.contacts[i].coupled().is_some() {
                format!(
                    "at the node {} the surface is inclined by {:.0} degrees to the direction of its contact; \
                     remove `direction`",
                    units.place(model.contacts[i].position),
                    slope.atan().to_degrees()
                )
            } else {
                format!(
                    "at the node {} the obstacle is inclined by {:.0} degrees to the normal along which it presses; \
                     use direction = \"nearest\", or another normal",
                    units.place(model.contacts[i].position),
                    slope.atan().to_degrees()
                )
            };
            warn(WarningKind::LeaningObstacle, message);
        }
        let size = model.mesh.size();
        if let Some(LargestDisplacement { length, position, time }) = self.large_displacement(model) {
            let message = format!(
                "displacements are assumed to be small, but the node {} moves by {} at t = {} s, \
                 {:.0} % of the body's size; are lengths in {unit}, moduli and tractions in {}?",
                units.place(position),
                units.rounded(Quantity::Length, length, 3),
                six_digits(time),
                100.0 * length / size,
                units.name(Quantity::Stress)
            );
            warn(WarningKind::LargeDisplacements, message);
        }
        if let Some(left) = &self.range_left {
            warn(WarningKind::GapsOutOfRange, out_of_range(model, left));
        }
        if let Some((k, share, time)) = self.beyond.filter(|(_, share, _)| *share > BEYOND_THE_END) {
            warn(WarningKind::BeyondTheEnd, beyond_the_end(&model.pairs[k], share, time));
        }
        if let Some((passed, time)) = &self.passed {
            warn(WarningKind::PassedThrough, passed_through(model, passed, *time));
        }
        for faceted in self.faceted_gaps() {
            warn(WarningKind::FacetedGaps, faceted_gaps(model, faceted));
        }
        if let Some(chords) = self.faceted_obstacle() {
            warn(WarningKind::FacetedGaps, faceted_obstacle(model, chords, self.pressed));
        }
        if let Some((k, share, time)) = self.friction_left_out.filter(|(_, share, _)| *share > LEFT_OUT) {
            let message = friction_left_out(&model.contact_boundaries[k].name, share, time);
            warn(WarningKind::FrictionLeftOut, message);
        }
        if let Some((overlap, time)) =
            self.overlap.filter(|(overlap, _)| overlap.depth > TOLERATED_SHARE * self.pressed)
        {
            warn(WarningKind::ObstacleNotMet, not_met(model, overlap, time, self.pressed));
        }
        if let Some((between, time)) =
            self.between.as_ref().filter(|(between, _)| between.missed > TOLERATED_SHARE * self.pressed)
        {
            warn(WarningKind::ObstacleBetweenNodes, between_nodes(model, between, *time, self.pressed));
        }
        if let Some(found) = self.passage() {
            warn(WarningKind::CurvedGaps, on_the_way(model, found, self.pressed));
        }
        if let Some((found, time)) = self.slid.filter(|(slid, _)| slid.share > ACROSS_FACETS) {
            warn(WarningKind::SlidAcrossFacets, slid(model, found, time));
        }
        if let Some((motion, time)) = self.large_motion.filter(|(motion, _)| motion.share > MOVED_ALONG) {
            warn(WarningKind::LargeMotion, moved_along(model, motion, time));
        }
        if let Some((motion, time)) = &self.neutral
            && let Some(message) = not_unique(model, motion, *time)
        {
            warn(WarningKind::NotUnique, message);
        }
        if let Some(message) = forces_not_unique(model, &self.touched) {
            warn(WarningKind::NotUnique, message);
        }
        warnings
    }
}

/// Describes that a `share` of the friction of `boundary` is at nodes constrained by supports, or without friction on the
/// exact path.
fn friction_left_out(boundary: &str, share: f64, time: f64) -> String {
    let time = six_digits(time);
    format!(
        "at t = {time} s {:.0} % of the possible friction of `{boundary}` is neglected, because supports hold its \
         nodes in the direction of sliding, or the exact path has none where two contacts meet; end the support at \
         some distance from the contact, make the other side the slave, or use solver.method = \"bn\"",
        100.0 * share
    )
}

/// Describes that a `share` of the force of a pair is beyond the end of the master.
fn beyond_the_end(pair: &Pair, share: f64, time: f64) -> String {
    let time = six_digits(time);
    let (slave, master) = (&pair.slave, &pair.master.name);
    let cure = if pair.mortar.overhangs()[1] {
        format!("give the mesh of `{slave}` nodes where `{master}` ends, or smaller elements there")
    } else {
        format!("make `{master}` the slave, or the elements of `{slave}` smaller there")
    };
    format!(
        "at t = {time} s {:.0} % of the force of `{slave}` on `{master}` is on nodes beyond the end of `{master}`, \
         which also pull at its inner nodes; {cure}",
        100.0 * share
    )
}

/// Describes that a body has penetrated another one.
fn passed_through(model: &Model, passed: &Passed, time: f64) -> String {
    let time = six_digits(time);
    let Passed { node, bodies, depth, apart } = *passed;
    let (units, all) = (model.units(), model.mesh.bodies());
    let of = all.of_nodes();
    let [depth, apart] = [depth, apart].map(|x| units.rounded(Quantity::Length, x, 3));
    let place = units.place(model.mesh.nodes[node]);
    let nodes_of = |name: &str| model.mesh.boundary(name).map_or(Vec::new(), Boundary::nodes);
    let is_between = |pair: &&Pair| {
        let (slave, master) = (nodes_of(&pair.slave), pair.master.nodes());
        let faces =
            |own: &[usize], other: &[usize]| own.contains(&node) && other.iter().any(|&node| of[node] == bodies[1]);
        faces(&slave, &master) || faces(&master, &slave)
    };
    if let Some(pair) = model.pairs.iter().find(is_between) {
        let search = units.rounded(Quantity::Length, pair.mortar.search, 3);
        return format!(
            "at t = {time} s the node at {place} is {depth} inside the other side of `{}` against `{}`, and no \
             contact stops it: nothing was in front of it within the search distance of {search}, and it was \
             {apart} away; set contact[{}].search larger than every gap that closes",
            pair.slave, pair.master.name, pair.contact
        );
    }
    format!(
        "at t = {time} s the node at {place} of {} is {depth} inside {}, and no contact stops it; define a \
         [[contact]] with `against` between the boundaries of the two there",
        all.told(bodies[0]),
        all.told(bodies[1])
    )
}

/// Describes that gaps are others if facets that count as apart are of one curved surface.
fn faceted_gaps(model: &Model, &Faceted { pair, bulge, closed, .. }: &Faceted) -> String {
    let pair = &model.pairs[pair];
    let [now, curved] = [-closed, -closed - bulge].map(|gap| model.units().rounded(Quantity::Length, gap, 3));
    format!(
        "facets of `{}` or `{}` turn by more than 44° where they meet, and count as edges: if they are of one curved surface, measured \
         gaps are {curved} in the mean, not {now}; forces of a fit are off by that ratio, and pressures by more: use twice as many \
         elements along the curve, or set contact[{}].gap if it is known",
        pair.slave, pair.master.name, pair.contact
    )
}

/// Describes that an obstacle of triangles is not the curved surface that it stands for.
fn faceted_obstacle(model: &Model, chords: ObstacleChords, pressed: f64) -> String {
    let (units, share) = (model.units(), chords.beyond / pressed);
    format!(
        "the triangles of {} are chords of a curved surface, which is {} beyond their middle (median), {}: pressures may be off by \
         about {:.0} %; write the file with edges at most {:.2} times as long, or use an obstacle of that shape",
        model.obstacle_key(chords.obstacle),
        units.rounded(Quantity::Length, chords.beyond, 3),
        beside(chords.beyond, pressed),
        100.0 * (STIFFER_OBSTACLE * share).min(1.0),
        (FACETED / (STIFFER_OBSTACLE * share)).sqrt()
    )
}

fn slid(model: &Model, slid: Slid, time: f64) -> String {
    let time = six_digits(time);
    let units = model.units();
    format!(
        "the contact node at {} has slid by {} at t = {time} s, {:.0} % of the opposing facet, but remains paired with \
         its initial nodes; pressures may be off by as much as they change over that distance",
        units.place(model.contacts[slid.contact].position),
        units.rounded(Quantity::Length, slid.slip, 3),
        100.0 * slid.share
    )
}

fn moved_along(model: &Model, motion: LargeMotion, time: f64) -> String {
    let time = six_digits(time);
    format!(
        "the rigid body `{}` has moved by {} along its contact at t = {time} s, {:.0} % of half the width of the pressed \
         zone: forces act where they were, so that moments about the contact are off by force times motion, and a body \
         does not roll; hold its rotation, or let it move less",
        model.description().couplings[motion.coupling].name,
        model.units().rounded(Quantity::Length, motion.moved, 3),
        100.0 * motion.share
    )
}

fn not_unique(model: &Model, neutral: &NeutralMotion, time: f64) -> Option<String> {
    let time = six_digits(time);
    let motion = RigidMotion::combination(&model.rigid_motions, &neutral.weights)?;
    // The body may move one way only.
    let room = neutral.room[0].max(neutral.room[1]);
    if room == 0.0 {
        return None;
    }
    let units = model.units();
    let motion = motion.against(&units);
    let room = if room.is_finite() {
        format!("by up to {}", units.rounded(Quantity::Length, room, 3))
    } else {
        "by any distance".to_string()
    };
    Some(format!(
        "at t = {time} s contact forces balance the loads, but nothing holds {motion}: displacements are one of \
         many solutions, which may differ {room} before another node touches, with the same stresses; add a \
         support to make them unique"
    ))
}

/// Describes the contact nodes that touched and whose rows depend on each other.
fn forces_not_unique(model: &Model, touched: &[bool]) -> Option<String> {
    let acts = |i: &usize| touched[*i] && !model.problem.c_n().row(*i).is_empty();
    let acting: Vec<usize> = (0..touched.len()).filter(acts).collect();
    let dependent = model.problem.of_nodes(&acting).dependent_nodes();
    let nodes: BTreeSet<usize> = dependent.into_iter().map(|k| model.contacts[acting[k]].node).collect();
    let place = model.units().place(model.mesh.nodes[*nodes.first()?]);
    Some(format!(
        "the contact forces at {} nodes, the first at {place}, are not unique, because one contact can take over what others \
         carry: those that keep their friction and have the smallest pressures are told; the sums over all contacts there and the \
         rest of the body do not depend on that",
        nodes.len()
    ))
}

/// Describes the size of `length` (m) relative to the indentation `pressed` (m) by contact forces.
fn beside(length: f64, pressed: f64) -> String {
    match length / pressed {
        share if share < 10.0 => format!("{:.0} % of the indentation", 100.0 * share),
        share if share.is_finite() => "more than ten times the indentation".to_string(),
        _ => "where nothing else presses".to_string(),
    }
}

fn not_met(model: &Model, overlap: Overlap, time: f64, pressed: f64) -> String {
    let time = six_digits(time);
    let Overlap { contact, obstacle, depth } = overlap;
    let units = model.units();
    let place = units.place(model.contacts[contact].position);
    let key = model.obstacle_key(obstacle);
    let boundary = model.contact_boundaries.iter().find(|boundary| boundary.obstacles.contains(&obstacle));
    let own = boundary.is_some_and(|boundary| boundary.nodes.contains(&contact));
    let cure = match (own, boundary) {
        (false, Some(boundary)) => {
            format!("an obstacle of `{}` only; list it for the node's boundary too", boundary.name)
        }
        _ => "which it does not meet: of obstacles with different normals, a node meets only the nearest one at the \
         beginning; give these obstacles one `normal`, with direction = \"normal\", or one boundary each"
            .to_string(),
    };
    format!(
        "the contact node at {place} is {} inside {key} at t = {time} s, {}, {cure}",
        units.rounded(Quantity::Length, depth, 3),
        beside(depth, pressed)
    )
}

fn between_nodes(model: &Model, between: &BetweenNodes, time: f64, pressed: f64) -> String {
    let time = six_digits(time);
    let BetweenNodes { boundary, position, missed, size } = between;
    let units = model.units();
    let length = |x: f64| units.rounded(Quantity::Length, x, 3);
    format!(
        "the obstacle in front of `{boundary}` has details that are finer than the elements: between nodes, at {}, \
         its distance at t = {time} s differs by {} from the distances at the nodes, {}, and pressures \
         may be equally wrong; make the elements there, now {} long, smaller than these details",
        units.place(*position),
        length(*missed),
        beside(*missed, pressed),
        length(*size)
    )
}

/// Describes that an obstacle passes a node within an increment.
fn on_the_way(model: &Model, found: OnTheWay, pressed: f64) -> String {
    let OnTheWay { contact, time, distance } = found;
    let time = six_digits(time);
    let (units, does) = (model.units(), if distance < 0.0 { "goes through" } else { "leaves" });
    format!(
        "within the increment that ends at t = {time} s an obstacle {does} the contact node at {}, by {}, {}: \
         friction between the ends of increments is neglected; take more increments",
        units.place(model.contacts[contact].position),
        units.rounded(Quantity::Length, distance.abs(), 3),
        beside(distance.abs(), pressed)
    )
}

fn out_of_range(model: &Model, left: &RangeLeft) -> String {
    let RangeLeft { position, time, linearised, exact, share, .. } = *left;
    let time = six_digits(time);
    let units = model.units();
    let place = units.place(position);
    let remedy = "pressures may be equally wrong; place the obstacle of the scene nearer to where it presses, or let it move \
         less";
    if exact.is_nan() {
        return format!("the obstacle is no longer in front of the contact node at {place} at t = {time} s: {remedy}");
    }
    let off = if share < 10.0 { format!(", off by {:.0} % of the indentation", 100.0 * share) } else { String::new() };
    let [linearised, exact] = [linearised, exact].map(|distance| units.rounded(Quantity::Length, distance, 3));
    format!(
        "gaps are linearised in the undeformed state, and the contact leaves the range of this approximation: at \
         the node {place} at t = {time} s the distance is {exact}, not {linearised}{off}; {remedy}"
    )
}
