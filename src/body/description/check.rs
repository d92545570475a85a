//! Checks of a description, entry by entry, and of its entries in combination.

use super::{Action, Description};
use crate::base::formula::{Field, Formula};
use crate::base::input_error::{InputError, each};
use crate::base::timeline::check_times;
use crate::body::contact::Shape;
use crate::body::fem::{Element, Plane};

impl Description {
    /// Checks the description as far as possible without its mesh.
    ///
    /// # Errors
    /// [`InputError`] with the key of the wrong value, such as `contact[0].friction`.
    pub fn check(&self) -> Result<(), InputError> {
        check_times("times", &self.times)?;
        self.mesh.check()?;
        self.material.check()?;
        if self.element != Element::Bilinear && self.material.plane == Some(Plane::Stress) {
            let message = format!("mesh.element is \"{}\", but material.plane is \"stress\"", self.element.name());
            let help = "plane stress does not constrain the volume, so nothing locks: use \"bilinear\"";
            return Err(InputError::new("mesh.element", message, help));
        }
        each("coupling", &self.couplings, |k, coupling| coupling.check(&self.couplings[..k]))?;
        each("support", &self.supports, |_, support| support.check())?;
        each("contact", &self.contacts, |k, contact| contact.check(&self.contacts[..k]))?;
        each("pretension", &self.pretensions, |k, pretension| pretension.check(self, &self.pretensions[..k]))?;
        each("spring", &self.springs, |_, spring| spring.check())?;
        each("load", &self.loads, |_, load| load.check()).map(drop)
    }

    /// Fails if a body of two dimensions has formulas of z.
    pub(crate) fn formulas_suit(&self, dimension: usize) -> Result<(), InputError> {
        match self.formulas().into_iter().find(|(_, formula)| formula.has_coordinate(2)) {
            Some((key, formula)) if dimension == 2 => {
                let message = format!("`{}` has z, but the body has two dimensions", formula.text());
                Err(InputError::new(key, message, "use x and y: y points up in the plane"))
            }
            _ => Ok(()),
        }
    }

    /// Returns each formula with its key.
    fn formulas(&self) -> Vec<(String, &Formula)> {
        let (mut fields, mut formulas) = (Vec::new(), Vec::new());
        for (k, contact) in self.contacts.iter().enumerate() {
            fields.push((format!("contact[{k}].friction"), &contact.friction));
            let gap = contact.opposite().and_then(|opposite| opposite.gap.as_ref());
            fields.extend(gap.map(|gap| (format!("contact[{k}].gap"), gap)));
            for (j, obstacle) in contact.obstacles().iter().enumerate() {
                if let Shape::Formula(formula) = &obstacle.shape {
                    formulas.push((format!("{}.formula", contact.obstacle_key(k, j)), formula));
                }
            }
        }
        for (k, load) in self.loads.iter().enumerate() {
            let (key, of_load) = match &load.action {
                Action::Traction { traction, .. } => ("traction", &traction[..]),
                Action::Pressure { pressure, .. } => ("pressure", std::slice::from_ref(pressure)),
                Action::Temperature(field) => ("temperature", std::slice::from_ref(field)),
                _ => continue,
            };
            fields.extend(of_load.iter().map(|field| (format!("load[{k}].{key}"), field)));
        }
        formulas.extend(fields.into_iter().filter_map(|(key, field)| match field {
            Field::Formula(formula) => Some((key, formula)),
            Field::Uniform(_) => None,
        }));
        formulas
    }
}
