//! A boundary in front of another, as an input describes it.

use crate::algebra::vector::{Vector, norm};
use crate::base::formula::Formula;
use crate::base::input_error::{InputError, ensure, finite, not_huge, positive};

/// The boundary of a deformable body in front of another.
#[derive(Debug, Clone, PartialEq)]
pub struct Opposite {
    /// The boundary, or several, of one body or more, that count as one.
    pub boundaries: Vec<String>,
    /// Whether the two are glued: they neither part nor slide, whatever the load.
    pub glued: bool,
    /// How far apart parts of the two may be that belong to each other, m; without it, a tenth of the size of the smaller one.
    pub search: Option<f64>,
    /// The gap between the two when the history begins.
    pub gap: FirstGap,
    /// Measured gaps and overlaps that are as small as this (m) count as 0.
    pub adjust: f64,
    /// The normal for the whole of it, out of the first boundary; without it, each node has its own, between those of both sides.
    pub direction: Option<Vector>,
    /// Whose nodes carry the contact forces.
    pub slave: Slave,
}

/// The gap between two boundaries when the history begins.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum FirstGap {
    /// That of the mesh; overlaps are interference.
    #[default]
    Measured,
    /// A number, m, for the whole of it; negative for interference.
    Uniform(f64),
    /// By a formula of the position of the slave's node, m.
    Formula(Formula),
}

/// Whose nodes carry the contact forces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Slave {
    /// Those of the boundary that is named first, unless supports hold all of it.
    #[default]
    First,
    /// Those of the side with more free nodes in front of the other; if these are alike, of the softer body.
    Automatic,
}

impl From<&str> for Opposite {
    /// With measured gaps and everything else by default.
    fn from(boundary: &str) -> Self {
        Opposite::from([boundary])
    }
}

impl<const N: usize> From<[&str; N]> for Opposite {
    /// Several boundaries that count as one, with measured gaps and everything else by default.
    fn from(boundaries: [&str; N]) -> Self {
        Opposite {
            boundaries: boundaries.map(str::to_string).to_vec(),
            glued: false,
            search: None,
            gap: FirstGap::Measured,
            adjust: 0.0,
            direction: None,
            slave: Slave::First,
        }
    }
}

impl Opposite {
    /// With this gap (m) in place of that of the mesh; negative for interference.
    #[must_use]
    pub fn apart(self, gap: f64) -> Self {
        Opposite { gap: FirstGap::Uniform(gap), ..self }
    }

    /// With this distance (m) within which parts of the two boundaries belong to each other.
    #[must_use]
    pub fn within(self, search: f64) -> Self {
        Opposite { search: Some(search), ..self }
    }

    /// Whether all values are possible.
    ///
    /// # Errors
    /// [`InputError`] of the key that is wrong, as it stands under `contact`.
    pub fn check(&self) -> Result<(), InputError> {
        if let Some(search) = self.search {
            positive("search", search, "give the distance in m or as [units] says")?;
        }
        finite("adjust", self.adjust)?;
        ensure(self.adjust >= 0.0, "adjust", &self.adjust, "0 or more", "give a distance in m or as [units] says")?;
        if let FirstGap::Uniform(gap) = self.gap {
            finite("gap", gap)?;
            not_huge("gap", [gap])?;
        }
        if let Some(direction) = self.direction {
            let length = norm(direction.components());
            let sound = length > 0.0 && length.is_finite();
            ensure(sound, "direction", &direction, "a vector with a direction", "give e.g. [0, -1]")?;
        }
        let help = "name the boundary that is in front of it";
        ensure(!self.boundaries.is_empty(), "against", &"[]", "a name, or a list of names", help)?;
        if let Some(twice) = (1..self.boundaries.len()).find(|&k| self.boundaries[..k].contains(&self.boundaries[k])) {
            let message = format!("`{}` stands there twice", self.boundaries[twice]);
            return Err(InputError::new("against", message, "keep it once"));
        }
        let measured = self.gap == FirstGap::Measured;
        ensure(
            measured || self.adjust == 0.0,
            "adjust",
            &self.adjust,
            "left out where gap says what the gap is",
            "remove the key",
        )
    }
}
