//! Checks of a contact's `obstacle`.

use toml::Spanned;

use super::Check;
use crate::scene::document::{self, ObstacleKind, Tuple};
use crate::scene::{Obstacle, SceneError, Shape};

impl Check<'_> {
    pub(super) fn obstacle(&self, given: &Spanned<document::Obstacle>) -> Result<Obstacle, SceneError> {
        let obstacle = given.get_ref();
        let shape = self.shape(obstacle)?;
        let normal = obstacle.normal.as_ref().map(|normal| self.direction("normal", normal)).transpose()?;
        let tangent = obstacle.tangent.as_ref().map(|tangent| self.direction("tangent", tangent)).transpose()?;
        if let (Some(given), Some(t)) = (&obstacle.tangent, tangent) {
            let help = "give both, at right angles, or leave the tangent out";
            let sound = normal.is_some_and(|n| (n[0] * t[0] + n[1] * t[1]).abs() <= 1e-9);
            self.demand(sound, "tangent", given, "at right angles to a given normal", help)?;
        }
        let approach = match &obstacle.approach {
            Some(given) => self.history("approach", "distance", given)?,
            None => Vec::new(),
        };
        Ok(Obstacle { shape, normal, tangent, approach, span: given.span() })
    }

    fn shape(&self, obstacle: &document::Obstacle) -> Result<Shape, SceneError> {
        let kind = &obstacle.kind;
        match kind.get_ref() {
            ObstacleKind::Plane => {
                self.foreign("radius", obstacle.radius.as_ref(), "a plane")?;
                self.foreign("apex", obstacle.apex.as_ref(), "a plane")?;
                let gap = obstacle.gap.as_ref().map_or(Ok(0.0), |gap| self.finite("gap", gap))?;
                Ok(Shape::Plane { gap })
            }
            ObstacleKind::Cylinder => {
                self.foreign("gap", obstacle.gap.as_ref(), "a cylinder")?;
                let given = self.needed("radius", obstacle.radius.as_ref(), &kind.span(), "a cylinder")?;
                let radius = self.finite("radius", given)?;
                self.demand(radius > 0.0, "radius", given, "positive", "give the radius in m")?;
                let apex = self.needed("apex", obstacle.apex.as_ref(), &kind.span(), "a cylinder")?;
                Ok(Shape::Cylinder { radius, apex: self.finite_pair("apex", apex)? })
            }
        }
    }

    /// A direction of any length, as a unit vector.
    fn direction(&self, name: &str, value: &Spanned<Tuple<f64>>) -> Result<[f64; 2], SceneError> {
        let [x, y] = self.finite_pair(name, value)?;
        let length = x.hypot(y);
        self.demand(length > 0.0, name, value, "a vector with a direction", "give e.g. [0, -1]")?;
        Ok([x / length, y / length])
    }
}
