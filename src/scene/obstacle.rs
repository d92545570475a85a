//! Obstacles as a scene gives them.

use std::ops::Range;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::Formula;

/// A rigid obstacle.
#[derive(Debug, Clone, PartialEq)]
pub struct Obstacle {
    /// Its shape and place.
    pub shape: Shape,
    /// Unit vector out of the body towards the obstacle; without it, the boundary's outward normal.
    pub normal: Option<[f64; 3]>,
    /// Unit vector of positive slip; without it, one that follows from the normal.
    pub tangent: Option<[f64; 3]>,
    /// Along which normals gaps are measured.
    pub direction: GapDirection,
    /// How far it has moved towards the body, against the normal: points `[time (s), distance (m)]`
    /// with increasing times from 0 to the end of the scene; linear between, constant outside. Empty if it does not move.
    pub approach: Vec<[f64; 2]>,
    /// How far it has moved: points `[time (s), x, y, z (m)]`, as above.
    pub translation: Vec<[f64; 4]>,
    /// How it turns, if it does.
    pub rotation: Option<Rotation>,
    /// The first of its vectors that was given with two components, as only suits a plane body.
    pub plane_vector: Option<&'static str>,
    /// Where the scene says it.
    pub span: Range<usize>,
}

/// A rotation about an axis that stands still.
#[derive(Debug, Clone, PartialEq)]
pub struct Rotation {
    /// Unit vector along the axis.
    pub axis: [f64; 3],
    /// A point of the axis, m.
    pub through: [f64; 3],
    /// Points `[time (s), angle (rad)]` with increasing times from 0 to the end of the scene; linear between, constant
    /// outside.
    pub history: Vec<[f64; 2]>,
}

/// Along which normals the gaps of an obstacle are measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GapDirection {
    /// Along one normal for the whole boundary.
    #[default]
    Normal,
    /// From each node to the nearest point of the obstacle.
    Nearest,
}

/// The shape of an obstacle.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A plane at right angles to the normal.
    Plane {
        /// Distance to the nearest point of the boundary, m; negative for interference.
        gap: f64,
    },
    /// The same, by a point of it.
    PlaneThrough {
        /// The point, m.
        through: [f64; 3],
    },
    /// A cylinder.
    Cylinder {
        /// Radius, m.
        radius: f64,
        /// A point nearest to the body, m.
        apex: [f64; 3],
        /// Unit vector along its axis; in two dimensions that is z.
        axis: Option<[f64; 3]>,
    },
    /// A sphere.
    Sphere {
        /// Radius, m.
        radius: f64,
        /// Its point nearest to the body, m.
        apex: [f64; 3],
    },
    /// Two planes that meet in a ridge.
    Wedge {
        /// A point of the ridge, m.
        apex: [f64; 3],
        /// How far each plane leans away from the body, rad, between 0 and π/2.
        angle: f64,
        /// Unit vector along the ridge; in two dimensions that is z.
        axis: Option<[f64; 3]>,
    },
    /// Gaps (m) by a formula of the position of the node.
    Formula(Formula),
    /// Gaps (m) from a CSV file.
    Table {
        /// The file.
        file: PathBuf,
    },
}

impl Obstacle {
    /// An obstacle that faces the boundary and stands still.
    pub fn at_rest(shape: Shape) -> Self {
        Obstacle {
            shape,
            normal: None,
            tangent: None,
            direction: GapDirection::default(),
            approach: Vec::new(),
            translation: Vec::new(),
            rotation: None,
            plane_vector: None,
            span: 0..0,
        }
    }
}
