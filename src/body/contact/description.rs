//! Rigid obstacles as input, before they are placed in front of a boundary.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::algebra::vector::{Vector, dot, norm, plus, unit};
use crate::base::formula::Formula;
use crate::base::input_error::{InputError, ensure, finite, not_huge, positive};
use crate::base::timeline::check_points;

/// A rigid obstacle. Vectors have as many components as the body has dimensions, two or three; directions may have any
/// length.
#[derive(Debug, Clone, PartialEq)]
pub struct Obstacle {
    /// The shape and the position of the obstacle.
    pub shape: Shape,
    /// Direction out of the body towards the obstacle; default: the boundary's mean outward normal.
    pub normal: Option<Vector>,
    /// Direction of positive slip, at right angles to a given normal; default: a direction derived from the normal.
    pub tangent: Option<Vector>,
    /// The normals along which gaps are measured.
    pub direction: GapDirection,
    /// The motion towards the body, against the normal: points `[time (s), distance (m)]` with increasing times; linear
    /// between them, constant outside.
    pub approach: Option<Vec<[f64; 2]>>,
    /// The translation: points of time (s) and displacement (m), interpolated like `approach`.
    pub translation: Option<Vec<(f64, Vector)>>,
    /// The rotation, if any.
    pub rotation: Option<Rotation>,
}

/// A rotation about a fixed axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Rotation {
    /// Direction of the axis; default: z.
    pub axis: Option<Vector>,
    /// A point of the axis, m.
    pub through: Vector,
    /// Points `[time (s), angle (rad)]` with increasing times; linear between, constant outside.
    pub history: Vec<[f64; 2]>,
}

/// The normals along which the gaps of an obstacle are measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum GapDirection {
    /// Along one normal for the whole boundary.
    #[default]
    Normal,
    /// Along an individual normal of each node, to the nearest point of the obstacle.
    Nearest,
}

/// The position of a round obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// A point of its surface, m. For a cylinder or a sphere, the point nearest to the body; for a bore or a socket,
    /// the point in the direction of the normal from the axis or centre.
    Apex(Vector),
    /// Its centre, or a point of its axis, m.
    Center(Vector),
}

impl Place {
    /// Returns the point and its key.
    fn point(self) -> (&'static str, Vector) {
        match self {
            Place::Apex(point) => ("apex", point),
            Place::Center(point) => ("center", point),
        }
    }

    /// Returns the apex (m) of a round obstacle that is seen along the unit vector `normal`. `radius` (m) is negative
    /// if the body is inside.
    pub(super) fn apex(self, radius: f64, normal: [f64; 3]) -> [f64; 3] {
        match self {
            Place::Apex(apex) => apex.components(),
            Place::Center(centre) => plus(centre.components(), -radius, normal),
        }
    }
}

/// The shape of an obstacle.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A plane at right angles to the normal.
    Plane {
        /// Distance to the nearest point of the boundary, m; negative for interference.
        gap: f64,
    },
    /// A plane at right angles to the normal, given by one of its points.
    PlaneThrough {
        /// The point, m.
        through: Vector,
    },
    /// A cylinder.
    Cylinder {
        /// Radius, m.
        radius: f64,
        /// The position.
        place: Place,
        /// Direction of its axis; z in two dimensions.
        axis: Option<Vector>,
    },
    /// A sphere.
    Sphere {
        /// Radius, m.
        radius: f64,
        /// The position.
        place: Place,
    },
    /// A cylinder that surrounds the body, such as the bore around a shaft.
    Bore {
        /// Radius, m.
        radius: f64,
        /// The position.
        place: Place,
        /// Direction of its axis; z in two dimensions.
        axis: Option<Vector>,
    },
    /// A sphere that surrounds the body, such as the socket around a ball.
    Socket {
        /// Radius, m.
        radius: f64,
        /// The position.
        place: Place,
    },
    /// A circular cone with its tip towards the body.
    Cone {
        /// The tip, m.
        apex: Vector,
        /// The angle between its axis and its surface, rad, between 0 and π/2.
        half_angle: f64,
        /// Direction of its axis, from the tip into the cone; default: the normal.
        axis: Option<Vector>,
    },
    /// Two planes that meet in a ridge.
    Wedge {
        /// A point of the ridge, m.
        apex: Vector,
        /// The angle by which each plane leans away from the body, rad, between 0 and π/2.
        angle: f64,
        /// Direction of the ridge; z in two dimensions.
        axis: Option<Vector>,
    },
    /// Gaps (m) given by a formula of the position of the node.
    Formula(Formula),
    /// Gaps from a CSV file.
    Table {
        /// The file.
        file: PathBuf,
        /// The length of the file's unit, m.
        scale: f64,
    },
    /// A surface of triangles, counterclockwise as seen from the body: an STL file, or the faces of a Gmsh file.
    Surface {
        /// The file.
        file: PathBuf,
        /// The length of the file's unit, m.
        scale: f64,
    },
}

impl From<Obstacle> for Vec<Obstacle> {
    fn from(obstacle: Obstacle) -> Self {
        vec![obstacle]
    }
}

impl Obstacle {
    /// Creates an obstacle that faces the boundary and does not move.
    pub fn at_rest(shape: Shape) -> Self {
        Obstacle {
            shape,
            normal: None,
            tangent: None,
            direction: GapDirection::default(),
            approach: None,
            translation: None,
            rotation: None,
        }
    }

    /// Creates a plane at the distance `gap` (m) from the nearest point of the boundary.
    pub fn plane(gap: f64) -> Self {
        Self::at_rest(Shape::Plane { gap })
    }

    /// Sets the motion towards the body: points `[time (s), distance (m)]`.
    #[must_use]
    pub fn approaching(self, history: &[[f64; 2]]) -> Self {
        Obstacle { approach: Some(history.to_vec()), ..self }
    }

    /// Checks that all values are valid and consistent.
    ///
    /// # Errors
    /// [`InputError`] with the key of the wrong value, relative to `obstacle`.
    pub fn check(&self) -> Result<(), InputError> {
        self.shape.check()?;
        let normal = self.normal.map(|normal| direction("normal", normal)).transpose()?;
        if let Some(given) = self.tangent {
            let tangent = direction("tangent", given)?;
            let help = "give both, at right angles, or leave the tangent out";
            let is_valid = normal.is_some_and(|normal| dot(normal, tangent).abs() <= SKEW);
            ensure(is_valid, "tangent", &given, "at right angles to a given normal", help)?;
        }
        let one_normal = matches!(
            self.shape,
            Shape::Plane { .. } | Shape::PlaneThrough { .. } | Shape::Formula(_) | Shape::Table { .. }
        );
        if self.direction == GapDirection::Nearest && one_normal {
            let message = "a plane, a formula and a table have no direction \"nearest\"";
            return Err(InputError::new("direction", message, "remove the key: gaps are measured along the normal"));
        }
        if let Some(approach) = &self.approach {
            check_points("approach", "distance", approach)?;
        }
        if self.translation.is_some() {
            not_huge("motion.translation", self.path().into_iter().flatten())?;
            let message = "translation is not a list of points with increasing times";
            check_points("motion.translation", "x, y, z", &self.path())
                .map_err(|fault| InputError { message: message.to_string(), ..fault })?;
        }
        self.rotation
            .as_ref()
            .map_or(Ok(()), |rotation| rotation.check().map_err(|fault| fault.with_key("motion.rotation")))
    }

    /// Returns the points `[time (s), x, y, z (m)]` of the translation; empty without one.
    pub fn path(&self) -> Vec<[f64; 4]> {
        let point = |(t, to): &(f64, Vector)| {
            let [x, y, z] = to.components();
            [*t, x, y, z]
        };
        self.translation.iter().flatten().map(point).collect()
    }

    /// Returns the name of the first vector with two components, which is valid only for a plane body.
    pub(super) fn plane_vector(&self) -> Option<&'static str> {
        let (point, axis) = self.shape.stands();
        let (name, point) = point.map_or(("", None), |(name, point)| (name, Some(point)));
        let rotation = self.rotation.as_ref();
        let flat = |vector: &Vector| vector.dimension() == 2;
        let given = [
            ("normal", self.normal),
            ("tangent", self.tangent),
            (name, point),
            ("axis", axis),
            ("rotation.axis", rotation.and_then(|rotation| rotation.axis)),
            ("rotation.through", rotation.map(|rotation| rotation.through)),
            ("translation", self.translation.iter().flatten().map(|(_, to)| *to).find(flat)),
        ];
        given.iter().find(|(_, vector)| vector.as_ref().is_some_and(flat)).map(|(name, _)| *name)
    }
}

/// The tolerance of right angles, for the rounding of vectors given with a few digits.
pub(super) const SKEW: f64 = 1e-9;

impl Shape {
    /// Returns the point that gives the position, with its key, and the direction of the axis.
    pub(super) fn stands(&self) -> (Option<(&'static str, Vector)>, Option<Vector>) {
        match *self {
            Shape::PlaneThrough { through } => (Some(("through", through)), None),
            Shape::Sphere { place, .. } | Shape::Socket { place, .. } => (Some(place.point()), None),
            Shape::Cylinder { place, axis, .. } | Shape::Bore { place, axis, .. } => (Some(place.point()), axis),
            Shape::Cone { apex, axis, .. } | Shape::Wedge { apex, axis, .. } => (Some(("apex", apex)), axis),
            Shape::Plane { .. } | Shape::Formula(_) | Shape::Table { .. } | Shape::Surface { .. } => (None, None),
        }
    }

    fn check(&self) -> Result<(), InputError> {
        let (point, axis) = self.stands();
        if let Some((key, value)) = point {
            self::point(key, value)?;
        }
        if let Some(axis) = axis {
            direction("axis", axis)?;
        }
        match *self {
            Shape::Plane { gap } => finite("gap", gap),
            Shape::Cylinder { radius, .. }
            | Shape::Bore { radius, .. }
            | Shape::Sphere { radius, .. }
            | Shape::Socket { radius, .. } => positive("radius", radius, "give the radius in m or as [units] says"),
            Shape::Cone { half_angle, .. } => {
                acute("half_angle", half_angle, "give the angle in rad between the axis and the surface of the cone")
            }
            Shape::Wedge { angle, .. } => {
                acute("angle", angle, "give the angle in rad by which each plane leans away from the body")
            }
            Shape::Table { scale, .. } | Shape::Surface { scale, .. } => {
                positive("scale", scale, "give the length of the file's unit in m, or in the unit of [units]")
            }
            Shape::PlaneThrough { .. } | Shape::Formula(_) => Ok(()),
        }
    }
}

fn acute(key: &str, angle: f64, help: &str) -> Result<(), InputError> {
    finite(key, angle)?;
    ensure(angle > 0.0 && angle < std::f64::consts::FRAC_PI_2, key, &angle, "between 0 and pi/2", help)
}

impl Rotation {
    fn check(&self) -> Result<(), InputError> {
        self.axis.map_or(Ok(()), |axis| direction("axis", axis).map(drop))?;
        point("through", self.through)?;
        check_points("history", "angle", &self.history)
    }
}

fn point(key: &str, value: Vector) -> Result<(), InputError> {
    let is_valid = value.components().iter().all(|x| x.is_finite());
    ensure(is_valid, key, &value, "finite numbers", "give numbers other than nan or inf")?;
    not_huge(key, value.components())
}

/// Returns the unit vector along `value`.
fn direction(key: &str, value: Vector) -> Result<[f64; 3], InputError> {
    point(key, value)?;
    let length = norm(value.components());
    ensure(length > 0.0 && length.is_finite(), key, &value, "a vector with a direction", "give e.g. [0, -1]")?;
    Ok(unit(value.components()))
}
