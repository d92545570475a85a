//! Checks of a contact's `obstacle`.

use toml::Spanned;

use super::{Check, within};
use crate::scene::document::{self, ObstacleKind, Vector};
use crate::scene::{Formula, GapDirection, Obstacle, Rotation, SceneError, Shape, Time};

impl Check<'_> {
    pub(super) fn obstacle(&self, given: &Spanned<document::Obstacle>, time: &Time) -> Result<Obstacle, SceneError> {
        let obstacle = given.get_ref();
        let shape = self.shape(obstacle)?;
        let normal = obstacle.normal.as_ref().map(|normal| self.direction("normal", normal)).transpose()?;
        let tangent = obstacle.tangent.as_ref().map(|tangent| self.direction("tangent", tangent)).transpose()?;
        if let (Some(given), Some(t)) = (&obstacle.tangent, tangent) {
            let help = "give both, at right angles, or leave the tangent out";
            let sound = normal.is_some_and(|n| (n[0] * t[0] + n[1] * t[1] + n[2] * t[2]).abs() <= 1e-9);
            self.demand(sound, "tangent", given, "at right angles to a given normal", help)?;
        }
        let direction = obstacle.direction.as_ref().map_or(GapDirection::default(), |given| *given.get_ref());
        let round = matches!(shape, Shape::Cylinder { .. } | Shape::Sphere { .. } | Shape::Wedge { .. });
        if let (Some(given), GapDirection::Nearest, false) = (&obstacle.direction, direction, round) {
            let help = "remove the key: gaps are measured along the normal";
            return self.fail(given.span(), "only a cylinder, a sphere or a wedge has the direction \"nearest\"", help);
        }
        let approach = match &obstacle.approach {
            Some(given) => self.history("approach", "distance", given, time)?,
            None => Vec::new(),
        };
        let motion = obstacle.motion.as_ref();
        let translation = match motion.and_then(|motion| motion.translation.as_ref()) {
            Some(given) => self.translation(given, time)?,
            None => Vec::new(),
        };
        let rotation =
            motion.and_then(|motion| motion.rotation.as_ref()).map(|given| self.rotation(given, time)).transpose()?;
        let plane_vector = plane_vector(obstacle);
        let span = given.span();
        Ok(Obstacle { shape, normal, tangent, direction, approach, translation, rotation, plane_vector, span })
    }

    fn shape(&self, obstacle: &document::Obstacle) -> Result<Shape, SceneError> {
        let document::Obstacle { kind, gap, through, radius, apex, axis, angle, formula, file, .. } = obstacle;
        let (whose, keys): (_, &[&str]) = match kind.get_ref() {
            ObstacleKind::Plane => ("a plane", &["gap", "through"]),
            ObstacleKind::Cylinder => ("a cylinder", &["radius", "apex", "axis"]),
            ObstacleKind::Sphere => ("a sphere", &["radius", "apex"]),
            ObstacleKind::Wedge => ("a wedge", &["apex", "angle", "axis"]),
            ObstacleKind::Formula => ("a formula", &["formula"]),
            ObstacleKind::Table => ("a table", &["file"]),
        };
        let alien = |name: &&str| !keys.contains(name);
        for (name, value) in [("gap", gap), ("radius", radius), ("angle", angle)].iter().filter(|(n, _)| alien(n)) {
            self.foreign(name, value.as_ref(), whose)?;
        }
        for (name, value) in [("through", through), ("apex", apex), ("axis", axis)].iter().filter(|(n, _)| alien(n)) {
            self.foreign(name, value.as_ref(), whose)?;
        }
        for (name, value) in [("formula", formula), ("file", file)].iter().filter(|(n, _)| alien(n)) {
            self.foreign(name, value.as_ref(), whose)?;
        }
        let apex = || self.vector("apex", self.needed("apex", apex.as_ref(), &kind.span(), whose)?);
        let radius = || {
            let given = self.needed("radius", radius.as_ref(), &kind.span(), whose)?;
            let radius = self.finite("radius", given)?;
            self.demand(radius > 0.0, "radius", given, "positive", "give the radius in m")?;
            Ok(radius)
        };
        let axis = || axis.as_ref().map(|axis| self.direction("axis", axis)).transpose();
        match kind.get_ref() {
            ObstacleKind::Plane => match (gap, through) {
                (Some(_), Some(through)) => {
                    self.fail(through.span(), "a plane has both gap and through", "keep one of them")
                }
                (None, Some(through)) => Ok(Shape::PlaneThrough { through: self.vector("through", through)? }),
                (gap, None) => Ok(Shape::Plane { gap: gap.as_ref().map_or(Ok(0.0), |gap| self.finite("gap", gap))? }),
            },
            ObstacleKind::Cylinder => Ok(Shape::Cylinder { radius: radius()?, apex: apex()?, axis: axis()? }),
            ObstacleKind::Sphere => Ok(Shape::Sphere { radius: radius()?, apex: apex()? }),
            ObstacleKind::Wedge => {
                let given = self.needed("angle", angle.as_ref(), &kind.span(), whose)?;
                let angle = self.finite("angle", given)?;
                let sound = angle > 0.0 && angle < std::f64::consts::FRAC_PI_2;
                let help = "give the angle in rad by which each plane leans away from the body";
                self.demand(sound, "angle", given, "between 0 and pi/2", help)?;
                Ok(Shape::Wedge { apex: apex()?, angle, axis: axis()? })
            }
            ObstacleKind::Formula => {
                let given = self.needed("formula", formula.as_ref(), &kind.span(), whose)?;
                let help = "give the gap in m as a formula of x, y and z in m, such as \"0.5 * x^2 / 0.1\"";
                let text = given.get_ref();
                Formula::parse(text).map(Shape::Formula).or_else(|why| {
                    // A text with escapes does not stand in the file as it is read.
                    let start = self.source.text[given.span()].find(text).map(|quote| given.span().start + quote);
                    let span = start.map_or(given.span(), |start| start + why.span.start..start + why.span.end);
                    self.fail(span, format!("the formula: {why}"), help)
                })
            }
            ObstacleKind::Table => {
                let given = self.needed("file", file.as_ref(), &kind.span(), whose)?;
                Ok(Shape::Table { file: self.source.beside(given.get_ref()) })
            }
        }
    }

    fn translation(&self, given: &Spanned<Vec<Vec<f64>>>, time: &Time) -> Result<Vec<[f64; 4]>, SceneError> {
        let help = "give points [time, x, y] or [time, x, y, z], s and m, ordered by time";
        let point = |point: &Vec<f64>| match point[..] {
            [t, x, y] => Some([t, x, y, 0.0]),
            [t, x, y, z] => Some([t, x, y, z]),
            _ => None,
        };
        let points: Option<Vec<[f64; 4]>> = given.get_ref().iter().map(point).collect();
        let sound = |points: &Vec<[f64; 4]>| {
            !points.is_empty()
                && points.iter().flatten().all(|x| x.is_finite())
                && points.windows(2).all(|pair| pair[0][0] < pair[1][0])
        };
        match points.filter(sound) {
            Some(points) => Ok(within(time, &points)),
            None => self.fail(given.span(), "translation is not a list of points with increasing times", help),
        }
    }

    fn rotation(&self, given: &document::Rotation, time: &Time) -> Result<Rotation, SceneError> {
        let axis = match &given.axis {
            Some(axis) => self.direction("axis", axis)?,
            None => [0.0, 0.0, 1.0],
        };
        let through = self.vector("through", &given.through)?;
        Ok(Rotation { axis, through, history: self.history("history", "angle", &given.history, time)? })
    }

    fn vector(&self, name: &str, value: &Spanned<Vector>) -> Result<[f64; 3], SceneError> {
        let vector = value.get_ref().components;
        let sound = vector.iter().all(|x| x.is_finite());
        self.demand(sound, name, value, "finite numbers", "give numbers other than nan or inf")?;
        Ok(vector)
    }

    /// A direction of any length, as a unit vector.
    fn direction(&self, name: &str, value: &Spanned<Vector>) -> Result<[f64; 3], SceneError> {
        let [x, y, z] = self.vector(name, value)?;
        let length = x.hypot(y).hypot(z);
        self.demand(length > 0.0, name, value, "a vector with a direction", "give e.g. [0, -1]")?;
        Ok([x / length, y / length, z / length])
    }
}

/// The first vector of an obstacle that has two components.
fn plane_vector(obstacle: &document::Obstacle) -> Option<&'static str> {
    let document::Obstacle { normal, tangent, apex, axis, through, motion, .. } = obstacle;
    let rotation = motion.as_ref().and_then(|motion| motion.rotation.as_ref());
    let given = [
        ("normal", normal.as_ref()),
        ("tangent", tangent.as_ref()),
        ("apex", apex.as_ref()),
        ("axis", axis.as_ref()),
        ("through", through.as_ref()),
        ("rotation.axis", rotation.and_then(|rotation| rotation.axis.as_ref())),
        ("rotation.through", rotation.map(|rotation| &rotation.through)),
    ];
    let translation = motion.as_ref().and_then(|motion| motion.translation.as_ref());
    let slides = translation.is_some_and(|points| points.get_ref().iter().any(|point| point.len() == 3));
    let of_plane = |vector: Option<&Spanned<Vector>>| vector.is_some_and(|vector| vector.get_ref().dimension == 2);
    let first = given.into_iter().find(|(_, vector)| of_plane(*vector)).map(|(name, _)| name);
    first.or(slides.then_some("translation"))
}
