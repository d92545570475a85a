//! Obstacles in front of bodies of revolution. They are bodies of revolution about the same axis, x = 0, and keep this
//! symmetry as they move.

use super::description::{Obstacle, SKEW};
use super::obstacle_error::ObstacleError;
use crate::algebra::vector::{Vector, plus};

/// Checks that an obstacle of revolution with the normal `normal` keeps its symmetry and its radius as it moves.
pub(super) fn moves_along_axis(given: &Obstacle, normal: [f64; 3]) -> Result<(), ObstacleError> {
    if given.rotation.is_some() {
        return Err(ObstacleError::TurnsRound);
    }
    if given.translation.iter().flatten().any(|(_, to)| to.components()[0] != 0.0) {
        return Err(ObstacleError::MovesAside("translation"));
    }
    let moves = given.approach.iter().flatten().any(|point| point[1] != 0.0);
    if moves && normal[0].abs() > SKEW { Err(ObstacleError::MovesAside("approach")) } else { Ok(()) }
}

/// Returns `true` if the centre of a sphere or socket is on the axis x = 0.
pub(super) fn centred(apex: [f64; 3], radius: f64, normal: [f64; 3]) -> bool {
    plus(apex, radius, normal)[0].abs() <= SKEW * radius.abs()
}

/// Returns `true` if the axis of a cone is x = 0.
pub(super) fn is_about_axis(apex: Vector, axis: [f64; 3]) -> bool {
    apex.components()[0] == 0.0 && axis[0].abs() <= SKEW
}
