//! Checks of the values of a description, individually and in combination.

use super::{Action, Against, Contact, Description, Opposite};
use crate::base::formula::{Field, Formula};
use crate::base::input_error::{InputError, each, ensure, finite};
use crate::base::timeline::{check_points, check_times};
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

impl Contact {
    /// Checks a contact, also against the `earlier` ones.
    fn check(&self, earlier: &[Contact]) -> Result<(), InputError> {
        if earlier.iter().any(|other| other.boundary == self.boundary) {
            let message = format!("the boundary `{}` has a [[contact]] already", self.boundary);
            let help = match self.opposite() {
                None => "keep one [[contact]] for each boundary",
                Some(_) => {
                    "keep one [[contact]] for each boundary: against may be a list of all that is in front of it"
                }
            };
            return Err(InputError::new("boundary", message, help));
        }
        if let Field::Uniform(coefficient) = self.friction {
            finite("friction", coefficient)?;
            let help = "give Coulomb's coefficient, 0 for a frictionless contact";
            ensure(coefficient >= 0.0, "friction", &coefficient, "0 or more", help)?;
        }
        if let Some(history) = &self.friction_history {
            check_points("friction_history", "factor", history)?;
            let is_valid = history.iter().all(|point| point[1] >= 0.0);
            ensure(is_valid, "friction_history", history, "of factors from 0 on", "friction cannot be negative")?;
        }
        match &self.against {
            Against::Boundary(opposite) => self.check_opposite(opposite),
            Against::Obstacles(obstacles) => match &obstacles[..] {
                [] => {
                    let message = format!("there is no obstacle in front of `{}`", self.boundary);
                    Err(InputError::new("obstacle", message, "give an obstacle, or remove the contact"))
                }
                [obstacle] => obstacle.check().map_err(|fault| fault.with_key("obstacle")),
                all => each("obstacle", all, |_, obstacle| obstacle.check()).map(drop),
            },
        }
    }

    fn check_opposite(&self, opposite: &Opposite) -> Result<(), InputError> {
        opposite.check()?;
        if opposite.boundaries.contains(&self.boundary) {
            let message = format!("the boundary `{}` is against itself", self.boundary);
            return Err(InputError::new("against", message, "name the boundary that is in front of it"));
        }
        if opposite.glued && (self.friction != Field::Uniform(0.0) || self.friction_history.is_some()) {
            let help = "remove the friction, or glue";
            return Err(InputError::new("friction", "what is glued does not slide, so that it has no friction", help));
        }
        Ok(())
    }
}
