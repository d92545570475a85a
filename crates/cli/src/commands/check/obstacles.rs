//! Describes obstacles.

use super::histories::points;
use crate::words::{number, rounded, vector};
use stickslip::algebra::Vector;
use stickslip::base::Quantity;
use stickslip::body::Model;
use stickslip::body::{GapDirection, Obstacle, Place, PlacedObstacle, Rotation, Shape};

/// Describes the normals along which the gaps of an obstacle are measured, and the positive slip direction.
pub(super) fn frame(model: &Model, obstacle: &PlacedObstacle, direction: GapDirection) -> String {
    let rounded = |c: &f64| format!("{c:.6}").parse().unwrap_or(*c) + 0.0;
    let vector = |x: [f64; 3]| {
        let components = x[..model.mesh.dimension].iter().map(|c| rounded(c).to_string());
        format!("({})", components.collect::<Vec<_>>().join(", "))
    };
    let normal = vector(obstacle.normal);
    let gaps = match direction {
        GapDirection::Normal => format!("gaps along the normal n = {normal}"),
        GapDirection::Nearest => {
            format!("gaps to the nearest point, each node along its own normal; n = {normal} at large")
        }
    };
    match (model.mesh.dimension, obstacle.tangents) {
        (2, [t, _]) => format!("{gaps}, slip along t = {}", vector(t)),
        (_, [t, o]) => format!("{gaps}, slip along t = {} and o = {}", vector(t), vector(o)),
    }
}

/// Lists the points of the motion of an obstacle.
pub(super) fn motions(model: &Model, obstacle: &Obstacle) -> Vec<String> {
    let mut motions = Vec::new();
    let units = model.units();
    if let Some(approach) = &obstacle.approach {
        let distance = |d: &[f64]| rounded(&units, Quantity::Length, d[0]);
        motions.push(format!("moves in by {}", points(approach, distance)));
    }
    if obstacle.translation.is_some() {
        let place = |x: &[f64]| vector(&units, Quantity::Length, &x[..model.mesh.dimension]);
        motions.push(format!("moves by {}", points(&obstacle.path(), place)));
    }
    if let Some(Rotation { history, .. }) = &obstacle.rotation {
        motions.push(format!("turns by {}", points(history, |angle| format!("{} rad", number(angle[0])))));
    }
    motions
}

/// Describes a shape and its position.
pub(super) fn shape(model: &Model, given: &Obstacle, placed: &PlacedObstacle) -> String {
    let units = model.units();
    let place = |x: &Vector| units.point(x.components());
    let length = |x: f64| units.text(Quantity::Length, x);
    let round = |kind: &str, radius: f64, at: &Place| match at {
        Place::Apex(apex) => format!("{kind}, radius {}, apex {}", length(radius), place(apex)),
        Place::Center(center) => format!("{kind}, radius {}, center {}", length(radius), place(center)),
    };
    match &given.shape {
        Shape::Plane { gap } => format!("plane at {}", rounded(&units, Quantity::Length, *gap)),
        Shape::PlaneThrough { through } => format!("plane through {}", place(through)),
        Shape::Cylinder { radius, place, .. } => round("cylinder", *radius, place),
        Shape::Bore { radius, place, .. } => round("bore", *radius, place),
        Shape::Sphere { radius, place } => round("sphere", *radius, place),
        Shape::Socket { radius, place } => round("socket", *radius, place),
        Shape::Cone { apex, half_angle, .. } => format!("cone, half angle {half_angle} rad, apex {}", place(apex)),
        Shape::Wedge { apex, angle, .. } => format!("wedge, angle {angle} rad, apex {}", place(apex)),
        Shape::Formula(formula) => format!("gap {}", formula.text()),
        Shape::Table { file, .. } => format!("gap from {}", file.display()),
        Shape::Surface { file, scale } => {
            let triangles = placed.triangles().unwrap_or_default();
            format!("surface of {triangles} triangles from {}, unit {}", file.display(), length(*scale))
        }
    }
}
