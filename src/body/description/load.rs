//! Loads of a body.

use crate::algebra::vector::{Vector, norm};
use crate::base::formula::Field;
use crate::base::input_error::{InputError, ensure, finite, not_huge};
use crate::base::timeline::check_points;
use crate::base::units::UnitSystem;

/// A load: an action times a factor that varies in time.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// The action at factor 1.
    pub action: Action,
    /// Points `[time (s), factor]` with increasing times: linear between them, constant outside. Default: the factor
    /// grows from 0 at the beginning to 1 at the end.
    pub history: Option<Vec<[f64; 2]>>,
}

/// The action of a load at factor 1. Lists of components have as many entries as the body has dimensions.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// A traction on a boundary, N/m².
    Traction {
        /// The boundary.
        boundary: String,
        /// Its components.
        traction: Vec<Field>,
    },
    /// A pressure on a boundary, N/m²: a traction against the outward normal of each facet.
    Pressure {
        /// The boundary.
        boundary: String,
        /// The pressure; negative for tension.
        pressure: Field,
    },
    /// A force, distributed uniformly over a boundary or acting at the node at a point, N; in two dimensions N per m of
    /// depth.
    Force {
        /// The boundary or the point.
        at: Where,
        /// Its components.
        force: Vec<f64>,
    },
    /// A moment on the reference point of a coupling, N m: about z in two dimensions, there N m per m of depth.
    Moment {
        /// The name of the coupling.
        coupling: String,
        /// One component in two dimensions, three in three.
        moment: Vec<f64>,
    },
    /// An acceleration of the ground, or gravity: the force `density · acceleration`, m/s².
    Acceleration(Vec<f64>),
    /// A steady rotation of the body about an axis: the centrifugal force `density · ω² · r`.
    Spin {
        /// Direction of the axis; default: z.
        axis: Option<Vector>,
        /// A point of the axis, m; for a body of revolution it may be left out.
        through: Option<Vector>,
        /// Angular speed `ω`, rad/s. A history multiplies the force, that is `ω²`.
        speed: f64,
    },
    /// The temperature above the stress-free temperature, K: the strain `expansion · temperature`.
    Temperature(Field),
}

/// A boundary, a single node, or the reference point of a coupling.
#[derive(Debug, Clone, PartialEq)]
pub enum Where {
    /// The boundary of this name.
    Boundary(String),
    /// The node at this point, m.
    Point(Vector),
    /// The reference point of the coupling of this name.
    Coupling(String),
}

impl From<Action> for Load {
    /// Creates a load that grows from 0 at the beginning to `action` at the end.
    fn from(action: Action) -> Self {
        Load { action, history: None }
    }
}

impl Load {
    /// Creates a uniform `traction` (N/m², two or three components) on `boundary` that grows from 0 at the beginning to
    /// its full value at the end.
    pub fn new(boundary: &str, traction: &[f64]) -> Self {
        let traction = traction.iter().map(|t| Field::from(*t)).collect();
        Action::Traction { boundary: boundary.to_string(), traction }.into()
    }

    /// Sets the history: points `[time (s), factor]`.
    #[must_use]
    pub fn over(self, history: &[[f64; 2]]) -> Self {
        Load { history: Some(history.to_vec()), ..self }
    }

    /// Returns the points `[time (s), factor]` of the history; the default history ends at `end` (s).
    pub fn factors(&self, end: f64) -> Vec<[f64; 2]> {
        self.history.clone().unwrap_or_else(|| vec![[0.0, 0.0], [end, 1.0]])
    }

    pub(super) fn check(&self) -> Result<(), InputError> {
        self.action.check()?;
        self.history.as_ref().map_or(Ok(()), |history| check_points("history", "factor", history))
    }
}

impl Action {
    /// Returns the name of the coupling that it acts on.
    pub(crate) fn coupling(&self) -> Option<&str> {
        match self {
            Action::Force { at, .. } => at.coupling(),
            Action::Moment { coupling, .. } => Some(coupling),
            _ => None,
        }
    }

    /// Describes what the load acts on, with coordinates in `units`.
    pub fn location(&self, units: &UnitSystem) -> String {
        match self {
            Action::Traction { boundary, .. } | Action::Pressure { boundary, .. } => boundary.clone(),
            Action::Force { at, .. } => at.location(units),
            Action::Moment { coupling, .. } => coupling.clone(),
            Action::Acceleration(_) | Action::Spin { .. } | Action::Temperature(_) => "the body".to_string(),
        }
    }

    fn check(&self) -> Result<(), InputError> {
        match self {
            Action::Traction { traction, .. } => {
                let is_valid = (2..=3).contains(&traction.len());
                let is_valid = is_valid && traction.iter().filter_map(Field::uniform).all(f64::is_finite);
                let given: Vec<String> = traction.iter().map(Field::to_string).collect();
                let (must, help) =
                    ("two or three finite numbers or formulas", "give one for each axis, not nan or inf");
                if !is_valid {
                    let message = format!("traction is [{}], but must be {must}", given.join(", "));
                    return Err(InputError::new("traction", message, help));
                }
                not_huge("traction", traction.iter().filter_map(Field::uniform))
            }
            Action::Pressure { pressure, .. } => pressure.check("pressure"),
            Action::Force { at, force } => {
                at.check()?;
                components("force", force)
            }
            Action::Moment { moment, .. } => axial("moment", moment),
            Action::Acceleration(acceleration) => components("acceleration", acceleration),
            Action::Spin { axis, through, speed } => {
                axis.map_or(Ok(()), |axis| direction("rotation.axis", axis))?;
                through.map_or(Ok(()), |through| components("rotation.through", &through.components()))?;
                finite("rotation.speed", *speed)
            }
            Action::Temperature(temperature) => temperature.check("temperature"),
        }
    }
}

impl Where {
    /// Returns the name of the coupling.
    pub(crate) fn coupling(&self) -> Option<&str> {
        match self {
            Where::Coupling(name) => Some(name),
            Where::Boundary(_) | Where::Point(_) => None,
        }
    }

    /// Returns the name of the boundary, or the coordinates in `units`.
    pub fn location(&self, units: &UnitSystem) -> String {
        match self {
            Where::Boundary(name) | Where::Coupling(name) => name.clone(),
            Where::Point(point) => format!("{:?}", units.coordinates(&point.components()[..point.dimension()])),
        }
    }

    pub(super) fn check(&self) -> Result<(), InputError> {
        match self {
            Where::Boundary(_) | Where::Coupling(_) => Ok(()),
            Where::Point(point) => components("point", &point.components()),
        }
    }
}

/// Checks that there are two or three finite numbers.
pub(super) fn components(key: &str, values: &[f64]) -> Result<(), InputError> {
    let is_valid = (2..=3).contains(&values.len()) && values.iter().all(|x| x.is_finite());
    ensure(is_valid, key, &values, "two or three finite numbers", "give one for each axis, not nan or inf")?;
    not_huge(key, values.iter().copied())
}

/// Checks that there is one finite number, about z, or that there are three.
pub(super) fn axial(key: &str, values: &[f64]) -> Result<(), InputError> {
    let is_valid = [1, 3].contains(&values.len()) && values.iter().all(|x| x.is_finite());
    ensure(is_valid, key, &values, "one or three finite numbers", "give one about z in the plane, three in space")?;
    not_huge(key, values.iter().copied())
}

/// Checks that a vector has a direction.
pub(super) fn direction(key: &str, given: Vector) -> Result<(), InputError> {
    components(key, &given.components())?;
    let length = norm(given.components());
    ensure(length > 0.0 && length.is_finite(), key, &given, "a vector with a direction", "give e.g. [0, -1]")
}
