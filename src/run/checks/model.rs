//! Checks of a model before its solution.

use super::locking;
use super::prelude::*;
use crate::body::contact::holes_in_front_of;
use crate::body::description::Action;

kinds! {
    /// A border between layers cuts elements.
    LAYERS_THROUGH_ELEMENTS("layers-through-elements", "Let elements end there.", "the border's place does not matter", before);
    /// A load acts on supports only.
    IDLE_LOAD("idle-load", "Remove it, or free the direction.", "intended", before);
    /// A coefficient of friction is above 2, as if in percent.
    LARGE_FRICTION("large-friction", "Correct it; to prevent sliding use `glue` or a support.", "intended", before);
    /// A surface of triangles has a hole or crack in front of its boundary, where nothing presses.
    SURFACE_HOLE("surface-hole", "Repair the file.", "the part has that hole", before);
}

/// The largest plausible coefficient of friction: soft rubber on dry asphalt reaches 1.5.
const PLAUSIBLE: f64 = 2.0;

/// The rounding of the corners of an element, relative to the size of the body.
const CORNER_ROUNDING: f64 = 1e-9;

impl Warning {
    /// Returns the warnings known before the solution of a model.
    pub fn of_model(model: &Model) -> Vec<Self> {
        let locking = locking::expected(model);
        let found = [locking, cut_elements(model), idle_load(model), large_friction(model), surface_hole(model)];
        found.into_iter().flatten().collect()
    }
}

fn cut_elements(model: &Model) -> Option<Warning> {
    let mesh = &model.mesh;
    let up = mesh.dimension - 1;
    let cut = |height: f64| {
        let within = |e: usize| {
            let heights = || mesh.cells[e].nodes.iter().map(|&node| mesh.nodes[node][up]);
            let (low, high) = (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
            let slack = CORNER_ROUNDING * mesh.size();
            low + slack < height && height < high - slack
        };
        (0..mesh.cells.len()).filter(|&e| within(e)).count()
    };
    let tops = model.description().material.tops();
    let (height, count) = tops.into_iter().map(|top| (top, cut(top))).find(|cut| cut.1 > 0)?;
    let axis = ["x", "y", "z"][up];
    // A height is a sum of thicknesses. Seven digits hide its rounding.
    let height = model.units().of_si(Quantity::Length, height);
    let height: f64 = format!("{height:.6e}").parse().unwrap_or(height);
    let unit = model.units().name(Quantity::Length);
    Some(WarningKind::LAYERS_THROUGH_ELEMENTS.warning(format!(
        "the border between layers at {axis} = {height} {unit} cuts {count} elements, each of which takes the \
         material of one layer; let elements end at the border"
    )))
}

fn large_friction(model: &Model) -> Option<Warning> {
    let largest = |nodes: &[usize]| nodes.iter().map(|&i| model.problem.mu()[i]).fold(0.0, f64::max);
    let contacts = model.contact.boundaries.iter().map(|boundary| (largest(&boundary.nodes), &boundary.name));
    let (mu, name) = contacts.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(mu, _)| *mu > PLAUSIBLE)?;
    Some(WarningKind::LARGE_FRICTION.warning(format!(
        "the friction of `{name}` is up to {mu}, but few surfaces exceed {PLAUSIBLE}: is it in percent? To prevent \
         sliding, connect bodies with glue = true, or hold a body with a [[support]]"
    )))
}

/// Warns of the largest hole of the first triangulated surface with holes in front of its boundary.
fn surface_hole(model: &Model) -> Option<Warning> {
    let units = model.units();
    model.contact.boundaries.iter().find_map(|contact| {
        let boundary = model.mesh.boundary(&contact.name)?;
        contact.obstacles.clone().find_map(|k| {
            let holes = holes_in_front_of(&model.mesh, boundary, &model.contact.obstacles[k], model.times());
            let largest = holes.iter().max_by(|a, b| a.size.total_cmp(&b.size))?;
            let what = if holes.len() == 1 { "a hole".to_string() } else { format!("{} holes", holes.len()) };
            let (key, name, place) = (model.obstacle_key(k), &contact.name, units.point(largest.box_centre()));
            let size = units.rounded(Quantity::Length, largest.size, 3);
            Some(WarningKind::SURFACE_HOLE.warning(format!(
                "the surface of {key} has {what} in front of `{name}`, the largest {size} long at {place}: nothing \
                 presses there. A triangle may be missing, or triangles on both sides of a crack may have different \
                 corners; close the hole in the file if the part has none"
            )))
        })
    })
}

fn idle_load(model: &Model) -> Option<Warning> {
    let idle = |force: &[f64]| force.iter().all(|f| *f == 0.0);
    let mut loads = model.description().loads.iter().zip(model.loading.cases());
    let acts = |action: &Action| match action {
        Action::Traction { traction, .. } => traction.iter().any(|t| t.uniform() != Some(0.0)),
        Action::Pressure { pressure, .. } => pressure.uniform() != Some(0.0),
        Action::Force { force, .. } | Action::Acceleration(force) => force.iter().any(|f| *f != 0.0),
        Action::Moment { moment, .. } => moment.iter().any(|m| *m != 0.0),
        Action::Spin { speed, .. } => *speed != 0.0,
        Action::Temperature(temperature) => temperature.uniform() != Some(0.0),
    };
    let (load, _) = loads.find(|(load, case)| acts(&load.action) && idle(case.force()))?;
    Some(WarningKind::IDLE_LOAD.warning(format!(
        "the load on `{}` does nothing: supports hold the boundary in its direction; remove the load, or free that direction in [[support]]",
        load.action.location(&model.units())
    )))
}
