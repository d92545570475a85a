//! Check of the formulas of a description.

use super::{Action, Description, Opposite};
use crate::base::formula::{Field, Formula};
use crate::base::input_error::InputError;
use crate::body::contact::Shape;

impl Description {
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
        let mut formulas = Vec::new();
        for (k, contact) in self.contacts.iter().enumerate() {
            if let Field::Formula(formula) = &contact.friction {
                formulas.push((format!("contact[{k}].friction"), formula));
            }
            if let Some(Opposite { gap: Some(Field::Formula(formula)), .. }) = contact.opposite() {
                formulas.push((format!("contact[{k}].gap"), formula));
            }
            for (j, obstacle) in contact.obstacles().iter().enumerate() {
                if let Shape::Formula(formula) = &obstacle.shape {
                    formulas.push((format!("{}.formula", contact.obstacle_key(k, j)), formula));
                }
            }
        }
        for (k, load) in self.loads.iter().enumerate() {
            let (key, fields) = match &load.action {
                Action::Traction { traction, .. } => ("traction", &traction[..]),
                Action::Pressure { pressure, .. } => ("pressure", std::slice::from_ref(pressure)),
                Action::Temperature(field) => ("temperature", std::slice::from_ref(field)),
                Action::Force { .. } | Action::Moment { .. } | Action::Acceleration(_) | Action::Spin { .. } => {
                    continue;
                }
            };
            for field in fields {
                if let Field::Formula(formula) = field {
                    formulas.push((format!("load[{k}].{key}"), formula));
                }
            }
        }
        formulas
    }
}
