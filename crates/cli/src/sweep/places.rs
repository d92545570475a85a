//! The places at which forces act, by the names in `forces.csv`.

use std::collections::BTreeMap;
use std::fmt;

use stickslip::body::{Against, Contact, Description};

use super::quantity::{QuantityError, TableQuantity};

/// The forces at a place: the kinds of lines of `forces.csv` that a quantity can name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Acting {
    Contact,
    Support,
    Spring,
    Load,
    Coupling,
    Pretension,
}

impl Acting {
    pub(super) const ALL: [Acting; 6] =
        [Acting::Contact, Acting::Support, Acting::Spring, Acting::Load, Acting::Coupling, Acting::Pretension];

    /// Returns the name in the column `kind`.
    pub(super) fn name(self) -> &'static str {
        match self {
            Acting::Contact => "contact",
            Acting::Support => "support",
            Acting::Spring => "spring",
            Acting::Load => "load",
            Acting::Coupling => "coupling",
            Acting::Pretension => "pretension",
        }
    }

    /// Returns the list of `reactions[]` with its forces; `None` for contacts, which are in `forces[]`.
    pub(super) fn list(self) -> Option<&'static str> {
        match self {
            Acting::Contact => None,
            Acting::Support => Some("supports"),
            Acting::Spring => Some("springs"),
            Acting::Load => Some("loads"),
            Acting::Coupling => Some("couplings"),
            Acting::Pretension => Some("pretensions"),
        }
    }
}

impl fmt::Display for Acting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The places of the scenes of a sweep, with what acts there.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Places(BTreeMap<String, Vec<Acting>>);

impl Places {
    /// Adds the places of a scene.
    pub fn add(&mut self, description: &Description) {
        // The coordinates of a point do not depend on the dimension.
        let units = description.system(3);
        let sides = |contact: &Contact| match &contact.against {
            Against::Obstacles(_) => vec![contact.boundary.clone()],
            Against::Boundary(opposite) => vec![contact.boundary.clone(), opposite.boundaries.join("+")],
        };
        let contacts = description.contacts.iter().flat_map(sides).map(|boundary| (boundary, Acting::Contact));
        let supports = description.supports.iter().map(|support| (support.at.place(&units), Acting::Support));
        let springs = description.springs.iter().map(|spring| (spring.place(&units), Acting::Spring));
        let loads = description.loads.iter().map(|load| (load.action.place(&units), Acting::Load));
        let couplings = description.couplings.iter().map(|coupling| (coupling.name.clone(), Acting::Coupling));
        let sections = description.pretensions.iter().map(|pretension| (pretension.name.clone(), Acting::Pretension));
        for (place, acting) in contacts.chain(supports).chain(springs).chain(loads).chain(couplings).chain(sections) {
            let known = self.0.entry(place).or_default();
            if !known.contains(&acting) {
                known.push(acting);
                known.sort_unstable();
            }
        }
    }

    /// Returns what acts at the place of this name; nothing if there is no such place.
    pub(super) fn at(&self, place: &str) -> &[Acting] {
        self.0.get(place).map_or(&[], Vec::as_slice)
    }

    /// Returns the names of all places.
    pub(super) fn names(&self) -> Vec<String> {
        self.0.keys().cloned().collect()
    }
}

/// Completes the quantities of forces with what acts at their places.
///
/// # Errors
/// [`QuantityError::Place`], [`QuantityError::Ambiguous`], [`QuantityError::NotThere`] or [`QuantityError::Column`].
pub fn check_places(quantities: &[TableQuantity], places: &Places) -> Result<Vec<TableQuantity>, QuantityError> {
    quantities.iter().map(|quantity| quantity.at(places)).collect()
}
