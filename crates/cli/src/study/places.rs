//! The places at which forces act, by the names in `forces.csv`.

use std::collections::BTreeMap;

use stickslip::body::{Against, Contact, Description};

/// The kinds of forces, as in the column `kind`. The forces of contacts are in `forces[]` of a report, those of another
/// kind in the list of `reactions[]` that is its plural.
pub(super) const KINDS: [&str; 6] = ["contact", "support", "spring", "load", "coupling", "pretension"];

/// The places of the scenes of a study, with the kinds of forces that act there.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Places {
    kinds: BTreeMap<String, Vec<&'static str>>,
    /// The most contacts of a scene.
    contacts: usize,
    /// `true` if forces of a scene have three components, or may have: the dimension of a mesh file is not known before
    /// it is read.
    in_space: bool,
}

impl Places {
    /// Adds the places of a scene.
    pub fn add(&mut self, description: &Description) {
        self.contacts = self.contacts.max(description.contacts.len());
        self.in_space |=
            description.mesh.nodes().is_none_or(|(_, dimension)| description.system(dimension).components == 3);
        // The coordinates of a point do not depend on the dimension.
        let units = description.system(3);
        let sides = |contact: &Contact| match &contact.against {
            Against::Obstacles(_) => vec![contact.boundary.clone()],
            Against::Boundary(opposite) => vec![contact.boundary.clone(), opposite.boundaries.join("+")],
        };
        let places: [Vec<String>; 6] = [
            description.contacts.iter().flat_map(sides).collect(),
            description.supports.iter().map(|support| support.at.location(&units)).collect(),
            description.springs.iter().map(|spring| spring.location(&units)).collect(),
            description.loads.iter().map(|load| load.action.location(&units)).collect(),
            description.couplings.iter().map(|coupling| coupling.name.clone()).collect(),
            description.pretensions.iter().map(|pretension| pretension.name.clone()).collect(),
        ];
        for (kind, places) in KINDS.into_iter().zip(places) {
            for place in places {
                let known = self.kinds.entry(place).or_default();
                if !known.contains(&kind) {
                    known.push(kind);
                    known.sort_by_key(|kind| KINDS.iter().position(|other| other == kind));
                }
            }
        }
    }

    /// Returns an error if no scene has a number of this name: a column of `forces.csv`, or the pointer of a key.
    pub(super) fn expect(&self, name: &str) -> Result<(), String> {
        let number = name.strip_prefix("/boundaries/").and_then(|rest| rest.split('/').next()?.parse::<usize>().ok());
        if number.is_some_and(|number| number >= self.contacts) {
            return Err(format!("the number of boundaries with contact, from 0, is {}", self.contacts));
        }
        let beside = ["f_z", "u_z", "m_x", "m_y", "rotation_x", "rotation_y", "sum_p_o"];
        let is_there = self.in_space || !beside.contains(&name.rsplit('/').next().unwrap_or_default());
        is_there.then_some(()).ok_or_else(|| "the scene is plane and has no such component".to_string())
    }

    /// Returns what acts at the place of this name; nothing if there is no such place.
    pub(super) fn at(&self, place: &str) -> &[&'static str] {
        self.kinds.get(place).map_or(&[], Vec::as_slice)
    }

    /// Returns the names of all places.
    pub(super) fn names(&self) -> Vec<&str> {
        self.kinds.keys().map(String::as_str).collect()
    }
}
