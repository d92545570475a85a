//! All formulas of a description, with their keys.

use super::{Action, Description, Field};
use crate::contact::{Friction, Shape};
use crate::formula::Formula;

impl Description {
    /// Each formula with the key at which it stands.
    pub(crate) fn formulas(&self) -> Vec<(String, &Formula)> {
        let mut formulas = Vec::new();
        for (k, contact) in self.contacts.iter().enumerate() {
            if let Friction::Formula(formula) = &contact.friction {
                formulas.push((format!("contact[{k}].friction"), formula));
            }
            for (j, obstacle) in contact.obstacles.iter().enumerate() {
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
                Action::Force { .. } | Action::Acceleration(_) | Action::Spin { .. } => continue,
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
