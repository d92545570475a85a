//! A body to be run, as numbers in SI units: small enough to be solved many times a second.

/// A scalar of the position: `constant + slope · x + curve (x₀ - middle)²`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Scalar {
    pub constant: f64,
    pub slope: [f64; 3],
    pub curve: f64,
    pub middle: f64,
}

impl From<f64> for Scalar {
    fn from(constant: f64) -> Self {
        Scalar { constant, ..Scalar::default() }
    }
}

/// A block with its material.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Body {
    pub name: &'static str,
    pub at: [f64; 3],
    pub size: [f64; 3],
    pub elements: [usize; 3],
    pub grading: [f64; 3],
    pub young: f64,
    pub poisson: f64,
}

/// What is in front of a boundary.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Shape {
    Plane {
        gap: f64,
    },
    /// By its kind; a cylinder lies along this axis.
    Round {
        kind: &'static str,
        radius: f64,
        apex: [f64; 3],
        axis: usize,
    },
    /// A cone or a wedge, by its angle.
    Edge {
        kind: &'static str,
        angle: f64,
        apex: [f64; 3],
        axis: usize,
    },
    Formula {
        gap: Scalar,
    },
    /// Another boundary.
    Body {
        boundary: &'static str,
    },
}

/// How it moves.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Motion {
    None,
    /// Points of time and distance.
    Approach(Vec<[f64; 2]>),
    /// A direction, and points of time and distance along it.
    Translation([f64; 3], Vec<[f64; 2]>),
    /// About an axis through this place, across the plane or along z; points of time and angle.
    Rotation([f64; 3], Vec<[f64; 2]>),
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Contact {
    pub boundary: &'static str,
    pub friction: Scalar,
    pub history: Option<Vec<[f64; 2]>>,
    pub shape: Shape,
    pub nearest: bool,
    pub motion: Motion,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Support {
    pub boundary: &'static str,
    /// The numbers of the axes.
    pub fix: Vec<usize>,
    pub displacement: Option<Vec<f64>>,
    pub history: Vec<[f64; 2]>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Action {
    Traction(&'static str, [Scalar; 3]),
    Pressure(&'static str, Scalar),
    Acceleration([f64; 3]),
    Temperature(Scalar),
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Load {
    pub action: Action,
    pub history: Vec<[f64; 2]>,
}

/// A small body with all that acts on it.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    pub(super) dimension: usize,
    pub(super) cells: &'static str,
    pub(super) element: &'static str,
    pub(super) plane: &'static str,
    pub(super) bodies: Vec<Body>,
    pub(super) density: f64,
    pub(super) expansion: f64,
    /// Thickness, modulus, Poisson's ratio of layers from below, of a single body.
    pub(super) layers: Vec<[f64; 3]>,
    pub(super) supports: Vec<Support>,
    pub(super) contacts: Vec<Contact>,
    /// A foundation: boundary, normal and tangential stiffness.
    pub(super) spring: Option<(&'static str, f64, f64)>,
    pub(super) loads: Vec<Load>,
    pub(super) end: f64,
    pub(super) increments: usize,
    /// Lines of `[solver]`.
    pub(super) solver: &'static str,
}

impl Case {
    /// Its width, about whose middle it is mirrored, m.
    pub(super) fn width(&self) -> f64 {
        self.bodies[0].size[0]
    }
}
