//! `stickslip check`.

mod histories;
mod mesh;
mod needs;
mod obstacles;

use super::run::print_warnings;
use super::{Failure, SceneArgs, origin};
use clap::Args;
use histories::points;
use mesh::{bodies, made};
use needs::needs;
use obstacles::{frame, motions, shape};
use std::borrow::Cow;
use std::collections::BTreeSet;
use stickslip::base::{Budget, Quantity, UnitSystem, in_words, six_digits};
use stickslip::body::constraints::RigidMotion;
use stickslip::body::fem::{Element, Material, Plane};
use stickslip::body::mesh::MeshSource;
use stickslip::body::{
    Action, Bed, Coupling, CouplingKind, Direction, Held, Model, Pretension, Support, Tightening, Where,
};
use stickslip::run::report::{PairRecord, Warning};
use stickslip::run::{RunError, tightening};
use stickslip::scene::Scene;
use stickslip::solver::formulation::Layout;
use stickslip::solver::{Conditions, ProblemError, history, rigid_equilibrium_with};
use stickslip_output::bytes_on_disk;

use crate::words::{acts, listed, rounded, vector};

#[derive(Args)]
pub(super) struct CheckArgs {
    #[command(flatten)]
    scene: SceneArgs,
}

pub(super) fn check(args: &CheckArgs) -> Result<(), Failure> {
    let scene = args.scene.read()?;
    // A file that is missing is named with its line.
    origin(&scene)?;
    let budget = Budget::of_process();
    let model = tightening(&scene)?;
    say!("{}", scene.title);
    body(&scene, &model);
    contacts(&scene, &model);
    loads(&scene, &model);
    let solver = &scene.solver;
    row!(
        "history      {} increments of {} s to t = {} s",
        scene.time.increments,
        six_digits(scene.time.end / scene.time.increments as f64),
        scene.time.end
    );
    for kinks in histories::between(&scene, &model.units()) {
        row!("             further ends: {kinks}");
    }
    row!(
        "solver       {}, setting {}, {}; at most {} iterations; error of every law at most {:.0e}",
        solver.method.name(),
        solver.method.setting(),
        solver.linear.map_or("auto".to_string(), |linear| linear.to_string()),
        solver.max_iterations,
        solver.tolerance
    );
    for line in needs(&scene, &model, budget)? {
        row!("{line}");
    }
    row!("disk         about {} for the results", in_words(bytes_on_disk(&scene, &model)));
    holding(&model);
    print_warnings(&Warning::of_model(&model));
    if !model.contact.nodes.is_empty() {
        theorem(&model);
        equilibrium(&scene, model)?;
    }
    Ok(())
}

fn body(scene: &Scene, model: &Model) {
    let units = model.units();
    let kind = made(&scene.description.mesh, model);
    let kinds = model.mesh.cells.iter().map(|cell| cell.kind.name()).collect::<BTreeSet<_>>();
    let element = Some(model.element().name()).filter(|_| model.element() != Element::Bilinear);
    row!(
        "mesh         {kind} elements ({}), {} nodes, boundaries {}",
        kinds.into_iter().chain(element).collect::<Vec<_>>().join(", "),
        model.mesh.nodes.len(),
        model.mesh.boundary_names().join(", ")
    );
    for line in bodies(&scene.description.mesh, model) {
        row!("{line}");
    }
    for remark in &model.mesh.notes.remarks {
        row!("             {remark}");
    }
    let Material { young, poisson, plane, thickness, layers, groups, .. } = &scene.description.material;
    let thick =
        thickness.map_or("unit thickness".to_string(), |t| format!("{} thick", rounded(&units, Quantity::Length, t)));
    let state = match (model.mesh.dimension, plane.unwrap_or_default()) {
        (2, Plane::Strain) => format!("plane strain, {thick}"),
        (2, Plane::Stress) => format!("plane stress, {thick}"),
        (2, Plane::Axisymmetric) => "axisymmetric about x = 0, forces all around".to_string(),
        (2, Plane::Torsion) => "axisymmetric about x = 0 with torsion, forces all around".to_string(),
        _ => "three dimensions".to_string(),
    };
    let modulus = |young: f64| rounded(&units, Quantity::Stress, young);
    match &scene.description.mesh {
        MeshSource::Bodies(_) => row!("material     {state}"),
        _ => row!("material     E = {}, nu = {poisson}, {state}", modulus(*young)),
    }
    for group in groups {
        row!("group        {}: E = {}, nu = {}", group.name, modulus(group.young), group.poisson);
    }
    let height = if model.mesh.dimension == 2 { "y" } else { "z" };
    let mut bottom = 0.0;
    for (layer, top) in layers.iter().zip(scene.description.material.tops()) {
        // A height is a sum of thicknesses. Fifteen digits hide its rounding.
        let top = units.of_si(Quantity::Length, top);
        let top: f64 = format!("{top:.14e}").parse().unwrap_or(top);
        let (unit, young) = (units.name(Quantity::Length), modulus(layer.young));
        row!("layer        {height} = {bottom} to {top} {unit}: E = {young}, nu = {}", layer.poisson);
        bottom = top;
    }
    for Coupling { name, part, kind, .. } in &scene.description.couplings {
        let how = match kind {
            CouplingKind::Rigid => "carries",
            CouplingKind::Distributing => "distributes forces over",
        };
        row!("coupling     {name}: {how} {}", part.name());
    }
    for pretension in &scene.description.pretensions {
        let how = match pretension.tightening {
            Tightening::Force { space, plane } => {
                let force = if model.mesh.dimension == 2 { plane } else { space };
                format!("a force of {}", rounded(&units, Quantity::Force, force))
            }
            Tightening::Shortening(by) => format!("a shortening by {}", rounded(&units, Quantity::Length, by)),
        };
        let lock = pretension.lock.map_or(String::new(), |lock| format!(", locked at t = {lock} s"));
        row!("pretension   {}: {how} across {}{lock}", pretension.name, pretension.boundary);
    }
    for support in &scene.description.supports {
        row!("support      {}: {}", support.at.location(&units), holds(support, &units, scene.time.end));
    }
    for bed in &scene.description.springs {
        let stiffness = match bed {
            Bed::Axes { at: Where::Boundary(_), stiffness } => {
                format!("{} along the axes", vector(&units, Quantity::Foundation, stiffness))
            }
            Bed::Axes { stiffness, .. } => format!("{} along the axes", vector(&units, Quantity::Spring, stiffness)),
            Bed::Rotational { rotational, .. } => {
                format!("{} per rad", vector(&units, Quantity::Moment, rotational))
            }
            Bed::Surface { normal, tangential, .. } => {
                let [normal, tangential] = [normal, tangential].map(|x| rounded(&units, Quantity::Foundation, *x));
                format!("{normal} along the normal, {tangential} across")
            }
        };
        row!("spring       {}: {stiffness}", bed.location(&units));
    }
}

/// Prints how the meshes of opposing bodies match.
fn pairs(model: &Model) {
    let units = model.units();
    let length = |x: f64| rounded(&units, Quantity::Length, x);
    for (pair, record) in model.contact.pairs.iter().zip(PairRecord::all(model)) {
        let PairRecord { slave, master, reason, glued, rows, segments, covered, least_gap, largest_gap, .. } = record;
        let glued = if glued { ", glued" } else { "" };
        row!("pair         {slave} (slave) against {master}{glued}: {rows} rows, {segments} segments");
        if let Some(reason) = reason {
            row!("             {slave} is the slave: {reason}");
        }
        let largest = pair.mortar.rows.iter().flat_map(|row| &row.master).fold(0.0_f64, |m, (_, c)| m.max(*c));
        row!(
            "             {:.0} % of the slave covered, gaps {} to {}, largest share of a master node {largest:.3}",
            100.0 * covered,
            length(least_gap),
            length(largest_gap)
        );
        if !pair.glued && !pair.is_measured() {
            let least = pair.gaps.iter().copied().fold(f64::INFINITY, f64::min);
            let largest = pair.gaps.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            row!("             gaps of {} to {} when the history begins", length(least), length(largest));
        }
    }
}

fn contacts(scene: &Scene, model: &Model) {
    for boundary in &model.contact.boundaries {
        let contact = &scene.description.contacts[boundary.contact];
        let several = contact.obstacles().len() > 1;
        let friction = &contact.friction;
        let mu = friction.uniform().map_or_else(|| friction.to_string(), |mu| mu.to_string());
        let changing = contact.friction_history.as_ref().map(|history| points(history, |factor| factor[0].to_string()));
        let mu = changing.map_or(mu.clone(), |factors| format!("{mu}, times {factors}"));
        if let Some(pair) = boundary.pair {
            row!(
                "contact      {} against {}, mu = {mu}",
                model.contact.pairs[pair].slave,
                model.contact.pairs[pair].master.name
            );
        }
        if several {
            row!("contact      {}: {} obstacles, mu = {mu}", contact.boundary, contact.obstacles().len());
        }
        for (given, k) in contact.obstacles().iter().zip(boundary.obstacles.clone()) {
            let placed = &model.contact.obstacles[k].0;
            let mut obstacle = vec![shape(model, given, placed)];
            obstacle.extend(motions(model, given));
            let obstacle = obstacle.join(", ");
            if several {
                let assigned = model.contact.nodes.iter().filter(|contact| contact.obstacle() == Some(k)).count();
                row!("             {obstacle}, met by {assigned} node{}", if assigned == 1 { "" } else { "s" });
            } else {
                row!("contact      {}: {obstacle}, mu = {mu}", contact.boundary);
            }
            row!("             {}", frame(model, placed, given.direction));
        }
        if boundary.unreached > 0 {
            row!("             {} nodes remain open because no obstacle ever reaches them", boundary.unreached);
        }
    }
    pairs(model);
    let layout = Layout::new(&model.problem);
    row!("unknowns     {} displacements u", layout.displacements());
    match (layout.contacts(), layout.tangentials()) {
        (0, _) => row!("             no contact: one linear solve per increment, one factorisation"),
        (n, t) => {
            row!("             {n} normal forces p_n");
            let with = |has: &dyn Fn(usize) -> bool| (0..n).filter(|&i| has(i)).count();
            let frictionless = match with(&|i| !layout.has_friction(i)) {
                0 => String::new(),
                rest => format!("; {rest} nodes have no friction or cannot slide"),
            };
            let along = match model.mesh.components() {
                2 => "p_t".to_string(),
                _ => format!("p_t and p_o; {} nodes slide in a plane", with(&|i| layout.slides_in_a_plane(i))),
            };
            row!("             {t} tangential forces {along}{frictionless}");
        }
    }
}

fn loads(scene: &Scene, model: &Model) {
    let units = model.units();
    let has_steps = scene.description.loads.iter().any(|load| load.history.is_some());
    for (load, sum) in scene.description.loads.iter().zip(model.forces_of_loads()) {
        // A temperature and a moment have no resulting force.
        let sum = match load.action {
            Action::Temperature { .. } | Action::Moment { .. } => String::new(),
            _ => format!(", in all {}", vector(&units, Quantity::Force, &sum[..model.mesh.components()])),
        };
        row!(
            "load         {}: {}{sum}; factor {}{}",
            load.action.location(&units),
            acts(&load.action, 1.0, &units),
            points(&load.factors(scene.time.end), |factor| factor[0].to_string()),
            if has_steps && load.history.is_none() { ": it has no history, as others have" } else { "" }
        );
    }
}

/// Describes the constrained components of a support and their displacement at the end.
fn holds(support: &Support, units: &UnitSystem, end: f64) -> String {
    let direction = |held: &Held| match held.direction {
        Direction::Axis(axis) => format!("{axis:?}").to_lowercase(),
        Direction::Normal => "its normal".to_string(),
        Direction::Along(vector) => format!("{vector:?}"),
        Direction::Rotation(axis) => format!("the rotation about {}", format!("{axis:?}").to_lowercase()),
    };
    let held = format!("{} held", listed(support.held.iter().map(direction).collect()));
    if !support.moves() {
        return held;
    }
    let turns = |held: &&Held| matches!(held.direction, Direction::Rotation(_));
    let to: Vec<f64> = support.held.iter().filter(|held| !turns(held)).map(|held| held.displacement).collect();
    let by: Vec<String> = support.held.iter().filter(turns).map(|held| format!("{} rad", held.displacement)).collect();
    let factor = points(&support.factors(end), |factor| factor[0].to_string());
    let moved = (!to.is_empty()).then(|| format!(", moved by {}", vector(units, Quantity::Length, &to)));
    let turned = (!by.is_empty()).then(|| format!(", turned by {}", by.join(", ")));
    format!("{held}{}{}; factor {factor}", moved.unwrap_or_default(), turned.unwrap_or_default())
}

fn holding(model: &Model) {
    if model.constraints.rigid_motions.is_empty() {
        row!("held         by its supports");
        return;
    }
    let by = if model.contact.nodes.is_empty() { "NOT HELD     nothing holds" } else { "CONTACT      alone can hold" };
    for motion in &model.constraints.rigid_motions {
        row!("{by} {}", motion.against(&model.units()));
    }
}

fn theorem(model: &Model) {
    let conditions = Conditions::of(&model.problem);
    if conditions.hold() {
        row!(
            "theorem 3    holds: (a) every rigid motion moves a node towards an obstacle; (b) contact rows independent"
        );
        return;
    }
    let mut label = "theorem 3";
    if let Some(motion) = conditions.leaving.as_deref().and_then(|weights| named(model, weights)) {
        row!(
            "{label:<12} (a) violated: {} moves no node towards an obstacle, so the loads must prevent it; or add a \
             support",
            motion.describe(&model.units())
        );
        label = "";
    }
    let nodes: BTreeSet<usize> = conditions.dependent.iter().map(|&i| model.contact.nodes[i].node).collect();
    if let Some(&first) = nodes.first() {
        let place = model.units().point(model.mesh.nodes[first]);
        let others = match nodes.len() - 1 {
            0 => String::new(),
            n => format!(" (and at {n} more)"),
        };
        row!(
            "{label:<12} (b) violated: the contact rows at {place}{others} depend on each other, so the contact \
             forces there are not unique; a run finds those that keep their friction and have the smallest pressures"
        );
    }
}

/// Prints the first increment that no contact force can balance. Locked sections hold their parts together.
fn equilibrium(scene: &Scene, model: Model) -> Result<(), RunError> {
    let (mut scene, mut model) = (Cow::Borrowed(scene), model);
    let mut rubbing = None;
    for time in scene.time.all() {
        let locked = |pretension: &Pretension| pretension.lock.is_some_and(|lock| lock < time);
        if scene.description.pretensions.iter().any(locked) {
            for pretension in scene.to_mut().description.pretensions.iter_mut().filter(|pretension| locked(pretension))
            {
                *pretension = Pretension::by_shortening(&pretension.name, &pretension.boundary, 0.0);
            }
            model = tightening(&scene)?;
        }
        if let Some(motion) = driven(&model, time).map_err(history::Error::from)? {
            row!(
                "NO BALANCE   first at t = {} s: the loads drive {}, and no contact force within the friction \
                 limit resists; change the loads or add a support",
                six_digits(time),
                motion.describe(&model.units())
            );
            return Ok(());
        }
        if rubbing.is_none() {
            rubbing = held_by_friction(&model, time).map_err(history::Error::from)?;
        }
    }
    if let Some(motion) = rubbing {
        row!(
            "FRICTION     alone holds {}, against the loads: if it suffices depends on pressures that interference, bolts or \
             other bodies cause, so that only a run tells",
            motion.against(&model.units())
        );
    }
    Ok(())
}

/// Returns the rigid motion along the contact that the loads drive at `time` (s).
fn driven(model: &Model, time: f64) -> Result<Option<RigidMotion>, ProblemError> {
    let mu = model.loading.friction().map(|friction| friction.at(time));
    driven_against(model, time, mu.as_deref().unwrap_or(model.problem.mu()))
}

/// Returns the rigid motion along the contact that the loads drive at `time` (s) against friction `mu`.
fn driven_against(model: &Model, time: f64, mu: &[f64]) -> Result<Option<RigidMotion>, ProblemError> {
    if model.constraints.rigid_motions.is_empty() {
        return Ok(None);
    }
    let force = model.loading.force_at(time, &model.problem)?;
    let driven = rigid_equilibrium_with(&model.problem, mu, &force)?;
    Ok(driven.and_then(|weights| model.motion_along_contact(time, &weights, |_| true)))
}

/// Returns the rigid motion that the loads drive at `time` (s) if there were no friction, if friction resists any force
/// along it: with pressures that no load causes.
fn held_by_friction(model: &Model, time: f64) -> Result<Option<RigidMotion>, ProblemError> {
    let motion = driven_against(model, time, &vec![0.0; model.problem.contacts()])?;
    let resists = |motion: &RigidMotion| {
        let along = motion.displacements(&model.mesh, &model.constraints.dofs);
        rigid_equilibrium_with(&model.problem, model.problem.mu(), &along).map(|driven| driven.is_none())
    };
    Ok(match motion {
        Some(motion) if resists(&motion)? => Some(motion),
        _ => None,
    })
}

fn named(model: &Model, weights: &[f64]) -> Option<RigidMotion> {
    RigidMotion::combination(&model.constraints.rigid_motions, weights)
}
