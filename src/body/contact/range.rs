//! Check that the contact stays within the range of its linearisation.
//!
//! Gaps and normals are those of the undeformed body. The error is checked afterwards: the exact distance of the
//! deformed node from the moved obstacle, along the node's normal, is compared with the linearised distance.

use serde::{Deserialize, Serialize};

use super::motion::ObstacleMotion;
use super::obstacle::PlacedObstacle;
use crate::algebra::vector::{dot, norm};

/// The largest tolerated error of the linearisation, as a share of the indentation. Since pressures follow from the
/// indentation, about this share of a pressure is then wrong, which is more than the usual error of a mesh.
pub const TOLERATED_SHARE: f64 = 0.1;

/// The error of a distance of 0 in a solution, as a share of the largest displacement: the usual bound of the error
/// measure.
const SOLVED: f64 = 1e-10;

/// The rounding error of a distance, as a share of the coordinates that are subtracted: a few units in the last place.
const DISTANCE_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// A contact node whose linearised distance from the obstacle is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RangeLeft {
    /// The number of the node in the mesh, from 0.
    pub node: usize,
    /// The position of the node, m.
    pub position: [f64; 3],
    /// The time, s.
    pub time: f64,
    /// The linearised distance of the node from the obstacle, as computed, m.
    pub linearised: f64,
    /// The distance of the node along the normal without linearisation, m; null if the obstacle is no longer in front
    /// of it.
    pub exact: f64,
    /// The difference of the two distances divided by the largest indentation.
    pub share: f64,
}

/// A contact node in its deformed state.
#[derive(Debug, Clone, Copy)]
pub struct DeformedNode {
    /// The number of the node in the mesh.
    pub node: usize,
    /// The position of the node before the deformation, m.
    pub position: [f64; 3],
    /// The displacement of the node, m.
    pub displacement: [f64; 3],
    /// The normal along which the gap is measured.
    pub normal: [f64; 3],
    /// The gap of the node at this time, m.
    pub gap: f64,
    /// `true` if the node is in contact.
    pub closed: bool,
}

/// Returns the node of `nodes`, in front of `obstacle` at time `t` (s), with the largest error of the linearised
/// distance, if the error exceeds `TOLERATED_SHARE` of the indentation.
///
/// The indentation is the larger of `indentation` (m), a lower bound known beforehand, and the largest normal
/// displacement of a closed node; if no node is closed, the largest displacement. An open node counts only if it is
/// inside the obstacle by its exact distance. Differences within rounding and the tolerance of a solution are ignored:
/// on a plane that touches from the start, nothing is indented.
pub fn range_left(
    obstacle: &PlacedObstacle,
    motion: &ObstacleMotion,
    t: f64,
    indentation: f64,
    nodes: &[DeformedNode],
) -> Option<RangeLeft> {
    let normal_displacement = |node: &DeformedNode| dot(node.normal, node.displacement);
    let largest = nodes.iter().fold(0.0_f64, |m, node| m.max(norm(node.displacement)));
    let closed = nodes.iter().filter(|node| node.closed).map(|node| normal_displacement(node).abs());
    let indentation = indentation.max(closed.reduce(f64::max).unwrap_or(largest));
    let mut worst: Option<RangeLeft> = None;
    for node in nodes {
        let DeformedNode { position, displacement, normal, .. } = *node;
        let moved = [0, 1, 2].map(|c| position[c] + displacement[c]);
        let (x, n) = motion.back(t, moved, normal);
        let exact = obstacle.distance(x, n, position);
        let linearised = node.gap - normal_displacement(node);
        let missed = if node.closed { (exact - linearised).abs() } else { (-exact).max(0.0) };
        let share = missed / indentation;
        let noise = SOLVED * largest + DISTANCE_ROUNDING * (norm(position) + norm(x));
        // A closed node that no longer has the obstacle in front of it is the worst case.
        let left = missed > noise && share > TOLERATED_SHARE || node.closed && exact.is_nan();
        if left && worst.is_none_or(|worst| share.is_nan() || share > worst.share) {
            worst = Some(RangeLeft { node: node.node, position, time: t, linearised, exact, share });
        }
    }
    worst
}
