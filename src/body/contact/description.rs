//! Rigid obstacles as an input describes them, before they stand in front of a boundary.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::algebra::vector::{Vector, dot, norm, plus, unit};
use crate::base::formula::Formula;
use crate::base::input_error::{InputError, ensure, finite, not_huge, positive};
use crate::base::timeline::check_points;

/// A rigid obstacle. Vectors have two components for a plane body and three for one in space; directions may have any
/// length.
#[derive(Debug, Clone, PartialEq)]
pub struct Obstacle {
    /// The shape and the place of the obstacle.
    pub shape: Shape,
    /// Direction out of the body towards the obstacle; without it, the boundary's mean outward normal.
    pub normal: Option<Vector>,
    /// Direction of positive slip, at right angles to a given normal; without it, one that follows from the normal.
    pub tangent: Option<Vector>,
    /// Along which normals gaps are measured.
    pub direction: GapDirection,
    /// How far it has moved towards the body, against the normal: points `[time (s), distance (m)]` with increasing
    /// times; linear between, constant outside.
    pub approach: Option<Vec<[f64; 2]>>,
    /// How far it has moved: points of time (s) and displacement (m), as above.
    pub translation: Option<Vec<(f64, Vector)>>,
    /// The rotation of the obstacle, if it turns.
    pub rotation: Option<Rotation>,
}

/// A rotation about an axis that stands still.
#[derive(Debug, Clone, PartialEq)]
pub struct Rotation {
    /// Direction of the axis; without it, along z.
    pub axis: Option<Vector>,
    /// A point of the axis, m.
    pub through: Vector,
    /// Points `[time (s), angle (rad)]` with increasing times; linear between, constant outside.
    pub history: Vec<[f64; 2]>,
}

/// Along which normals the gaps of an obstacle are measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GapDirection {
    /// Along one normal for the whole boundary.
    #[default]
    Normal,
    /// Along a normal of each node, to the nearest point of the obstacle.
    Nearest,
}

/// Where a round obstacle is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// A point of its surface, m: of a cylinder or a sphere the one nearest to the body, of a bore or a socket the one that the
    /// normal points to from the axis or centre.
    Apex(Vector),
    /// Its centre, or a point of its axis, m.
    Center(Vector),
}

impl Place {
    /// The point, and the key that it stands at.
    fn point(self) -> (&'static str, Vector) {
        match self {
            Place::Apex(point) => ("apex", point),
            Place::Center(point) => ("center", point),
        }
    }

    /// The same with another point.
    pub(crate) fn map(self, change: impl FnOnce(Vector) -> Vector) -> Self {
        match self {
            Place::Apex(point) => Place::Apex(change(point)),
            Place::Center(point) => Place::Center(change(point)),
        }
    }

    /// The apex (m) of a round obstacle of this radius (m), negative with the body in it, that is seen along the unit vector `normal`.
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
    /// A plane at right angles to the normal, by a point of it.
    PlaneThrough {
        /// The point, m.
        through: Vector,
    },
    /// A cylinder.
    Cylinder {
        /// Radius, m.
        radius: f64,
        /// Where it is.
        place: Place,
        /// Direction of its axis; in two dimensions that is z.
        axis: Option<Vector>,
    },
    /// A sphere.
    Sphere {
        /// Radius, m.
        radius: f64,
        /// Where it is.
        place: Place,
    },
    /// A cylinder with the body in it, as a shaft in its bore.
    Bore {
        /// Radius, m.
        radius: f64,
        /// Where it is.
        place: Place,
        /// Direction of its axis; in two dimensions that is z.
        axis: Option<Vector>,
    },
    /// A sphere with the body in it, as a ball in its socket.
    Socket {
        /// Radius, m.
        radius: f64,
        /// Where it is.
        place: Place,
    },
    /// A circular cone with its tip towards the body.
    Cone {
        /// The tip, m.
        apex: Vector,
        /// The angle between its axis and its surface, rad, between 0 and π/2.
        half_angle: f64,
        /// Direction of its axis, from the tip into the cone; without it, the normal.
        axis: Option<Vector>,
    },
    /// Two planes that meet in a ridge.
    Wedge {
        /// A point of the ridge, m.
        apex: Vector,
        /// How far each plane leans away from the body, rad, between 0 and π/2.
        angle: f64,
        /// Direction of the ridge; in two dimensions that is z.
        axis: Option<Vector>,
    },
    /// Gaps (m) by a formula of the position of the node.
    Formula(Formula),
    /// Gaps from a CSV file.
    Table {
        /// The file.
        file: PathBuf,
        /// The length of the file's unit, m.
        scale: f64,
    },
    /// A surface of triangles, seen counterclockwise by the body: an STL file, or the faces of a Gmsh file.
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
    /// An obstacle that faces the boundary and stands still.
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

    /// A plane at the distance `gap` (m) from the nearest point of the boundary.
    pub fn plane(gap: f64) -> Self {
        Self::at_rest(Shape::Plane { gap })
    }

    /// The same obstacle moving towards the body: points `[time (s), distance (m)]`.
    #[must_use]
    pub fn approaching(self, history: &[[f64; 2]]) -> Self {
        Obstacle { approach: Some(history.to_vec()), ..self }
    }

    /// Whether all values are possible and none contradicts another.
    ///
    /// # Errors
    /// [`InputError`] of the key that is wrong, as it stands under `obstacle`.
    pub fn check(&self) -> Result<(), InputError> {
        self.shape.check()?;
        let normal = self.normal.map(|normal| direction("normal", normal)).transpose()?;
        if let Some(given) = self.tangent {
            let tangent = direction("tangent", given)?;
            let help = "give both, at right angles, or leave the tangent out";
            let sound = normal.is_some_and(|normal| dot(normal, tangent).abs() <= SKEW);
            ensure(sound, "tangent", &given, "at right angles to a given normal", help)?;
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

    /// The points `[time (s), x, y, z (m)]` of the translation; none if there is none.
    pub fn path(&self) -> Vec<[f64; 4]> {
        let point = |(t, to): &(f64, Vector)| {
            let [x, y, z] = to.components();
            [*t, x, y, z]
        };
        self.translation.iter().flatten().map(point).collect()
    }

    /// The first of its vectors that is given with two components, as only suits a plane body.
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

/// How far an angle may be from a right one: what rounding leaves of vectors given with a few digits.
pub(super) const SKEW: f64 = 1e-9;

impl Shape {
    /// The point by which it is given where it stands, with its key, and the direction of its axis.
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
    let sound = value.components().iter().all(|x| x.is_finite());
    ensure(sound, key, &value, "finite numbers", "give numbers other than nan or inf")?;
    not_huge(key, value.components())
}

/// The unit vector along `value`.
fn direction(key: &str, value: Vector) -> Result<[f64; 3], InputError> {
    point(key, value)?;
    let length = norm(value.components());
    ensure(length > 0.0 && length.is_finite(), key, &value, "a vector with a direction", "give e.g. [0, -1]")?;
    Ok(unit(value.components()))
}
