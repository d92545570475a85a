//! The opposite boundary of a contact, as input.

use serde::Deserialize;

use super::load::{components, direction};
use crate::algebra::vector::{Vector, norm};
use crate::base::formula::Field;
use crate::base::input_error::{InputError, ensure, finite, not_huge, positive};

/// The opposite boundary of a contact, on a deformable body.
#[derive(Debug, Clone, PartialEq)]
pub struct Opposite {
    /// The boundary, or several boundaries of one or more bodies that count as one.
    pub boundaries: Vec<String>,
    /// `true` if the two are glued: they neither separate nor slide under any load.
    pub glued: bool,
    /// The vector (m) by which the opposite boundary is moved to be in front of the first one, such as the period of a
    /// periodic body; glued boundaries only.
    pub shift: Option<Vector>,
    /// The largest distance at which the two surfaces are paired, m; default: a tenth of the size of the smaller one.
    pub search: Option<f64>,
    /// The gap between the two when the history begins, m, negative for interference: a formula is of the position of
    /// the slave node. Default: the gap of the mesh, between the curved surfaces where facets of both sides approximate
    /// some; overlaps are interference.
    pub gap: Option<Field>,
    /// Measured gaps and overlaps up to this size (m) count as 0.
    pub adjust: f64,
    /// The normal for the whole boundary, out of the first boundary; default: at each node the mean of the normals of
    /// both sides.
    pub direction: Option<Vector>,
    /// The boundary whose nodes carry the contact forces.
    pub slave: Slave,
}

/// The boundary whose nodes carry the contact forces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Slave {
    /// The boundary that is named first, unless supports hold all of it.
    #[default]
    #[serde(rename = "boundary")]
    First,
    /// The boundary with more free nodes in front of the other, with fewer if the two are curved; if the numbers are about
    /// equal, that of the softer body.
    Automatic,
}

impl From<&str> for Opposite {
    /// Uses measured gaps and defaults otherwise.
    fn from(boundary: &str) -> Self {
        Opposite::from([boundary])
    }
}

impl<const N: usize> From<[&str; N]> for Opposite {
    /// Combines several boundaries; uses measured gaps and defaults otherwise.
    fn from(boundaries: [&str; N]) -> Self {
        Opposite {
            boundaries: boundaries.map(str::to_string).to_vec(),
            glued: false,
            shift: None,
            search: None,
            gap: None,
            adjust: 0.0,
            direction: None,
            slave: Slave::First,
        }
    }
}

impl Opposite {
    /// Sets a uniform gap (m) instead of that of the mesh; negative for interference.
    #[must_use]
    pub fn apart(self, gap: f64) -> Self {
        Opposite { gap: Some(gap.into()), ..self }
    }

    /// Sets the largest distance (m) at which the two boundaries are paired.
    #[must_use]
    pub fn within(self, search: f64) -> Self {
        Opposite { search: Some(search), ..self }
    }

    /// Sets the vector (m) by which the opposite boundary is moved to be in front of the first one.
    #[must_use]
    pub fn shifted(self, shift: impl Into<Vector>) -> Self {
        Opposite { shift: Some(shift.into()), ..self }
    }

    /// Checks that all values are valid.
    ///
    /// # Errors
    /// [`InputError`] with the key of the wrong value, relative to `contact`.
    pub fn check(&self) -> Result<(), InputError> {
        if let Some(search) = self.search {
            positive("search", search, "give the distance in m or as [units] says")?;
        }
        finite("adjust", self.adjust)?;
        ensure(self.adjust >= 0.0, "adjust", &self.adjust, "0 or more", "give a distance in m or as [units] says")?;
        if let Some(Field::Uniform(gap)) = self.gap {
            finite("gap", gap)?;
            not_huge("gap", [gap])?;
        }
        self.direction.map_or(Ok(()), |given| direction("direction", given))?;
        if let Some(shift) = self.shift {
            components("shift", &shift.components())?;
            let length = norm(shift.components());
            ensure(length > 0.0, "shift", &shift, "a vector other than 0", "give the period, or remove the key")?;
            if !self.glued {
                let message = "a contact has shift, but is not glued";
                return Err(InputError::new("shift", message, "add glue = true, or remove the key"));
            }
        }
        let help = "name the boundary that is in front of it";
        ensure(!self.boundaries.is_empty(), "against", &"[]", "a name, or a list of names", help)?;
        if let Some(twice) = (1..self.boundaries.len()).find(|&k| self.boundaries[..k].contains(&self.boundaries[k])) {
            let message = format!("`{}` stands there twice", self.boundaries[twice]);
            return Err(InputError::new("against", message, "keep it once"));
        }
        if self.glued && self.gap.is_some() {
            let help = "remove the key: gaps between glued bodies count as 0";
            return Err(InputError::new("gap", "gap must be left out where bodies are glued", help));
        }
        let help = "remove the key";
        let must = "left out where gap says what the gap is";
        ensure(self.gap.is_none() || self.adjust == 0.0, "adjust", &self.adjust, must, help)
    }
}
