//! Sections of bolts that are tightened.

use super::{Contact, Description};
use crate::base::input_error::{InputError, ensure, finite, in_one_line, not_huge};
use crate::base::timeline::check_points;

/// A glued contact whose sides are pulled towards each other, such as the section of a bolt: the boundary moves beyond the
/// other side by a length along its mean outward normal, the shortening of the bolt.
#[derive(Debug, Clone, PartialEq)]
pub struct Pretension {
    /// The name of the section.
    pub name: String,
    /// The boundary of a glued contact, the first of its two.
    pub boundary: String,
    /// The prescribed force or shortening at factor 1.
    pub tightening: Tightening,
    /// Points `[time (s), factor]` with increasing times: linear between them, constant outside. Default: the factor
    /// grows from 0 at the beginning to 1 at the end.
    pub history: Option<Vec<[f64; 2]>>,
    /// The time (s) from which the shortening stays as the force made it.
    pub lock: Option<f64>,
}

/// The prescribed quantity of a [`Pretension`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tightening {
    /// The force across the section, positive for tension.
    Force {
        /// The force of a body in space, N.
        space: f64,
        /// The force of a body of two dimensions: N per m of depth; over the full circumference, N.
        plane: f64,
    },
    /// The shortening, m.
    Shortening(f64),
}

impl Pretension {
    /// Creates a pretension by a `force`, N; in two dimensions N per m of depth.
    pub fn by_force(name: &str, boundary: &str, force: f64) -> Self {
        let tightening = Tightening::Force { space: force, plane: force };
        Pretension { name: name.to_string(), boundary: boundary.to_string(), tightening, history: None, lock: None }
    }

    /// Creates a pretension by a `shortening`, m.
    pub fn by_shortening(name: &str, boundary: &str, shortening: f64) -> Self {
        Pretension { tightening: Tightening::Shortening(shortening), ..Pretension::by_force(name, boundary, 0.0) }
    }

    /// Sets the history: points `[time (s), factor]`.
    #[must_use]
    pub fn over(self, history: &[[f64; 2]]) -> Self {
        Pretension { history: Some(history.to_vec()), ..self }
    }

    /// Returns the points `[time (s), factor]` of the history; the default history ends at `end` (s).
    pub fn factors(&self, end: f64) -> Vec<[f64; 2]> {
        self.history.clone().unwrap_or_else(|| vec![[0.0, 0.0], [end, 1.0]])
    }

    /// Checks a pretension of `description`, also against the `earlier` ones.
    pub(super) fn check(&self, description: &Description, earlier: &[Pretension]) -> Result<(), InputError> {
        in_one_line("a pretension", &self.name, "give a name such as \"bolt\"")?;
        let couplings = description.couplings.iter().map(|coupling| &coupling.name);
        if couplings.chain(earlier.iter().map(|other| &other.name)).any(|other| *other == self.name) {
            let message = format!("another pretension or coupling is called `{}`", self.name);
            return Err(InputError::new("name", message, "give each of them a name of its own"));
        }
        if earlier.iter().any(|other| other.boundary == self.boundary) {
            let message = format!("the boundary `{}` has a [[pretension]] already", self.boundary);
            return Err(InputError::new("boundary", message, "keep one [[pretension]] for each section"));
        }
        let is_glued = |contact: &&Contact| contact.opposite().is_some_and(|opposite| opposite.glued);
        let of_section = description.contacts.iter().find(|contact| contact.boundary == self.boundary);
        if !of_section.is_some_and(|contact| is_glued(&contact)) {
            let message = format!("no glued contact has the boundary `{}`", self.boundary);
            let glued: Vec<&str> =
                description.contacts.iter().filter(is_glued).map(|contact| contact.boundary.as_str()).collect();
            let help = match &glued[..] {
                [] => format!(
                    "cut the bolt in two, and add a [[contact]] with boundary = \"{}\", against = the other side and \
                     glue = true",
                    self.boundary
                ),
                glued => format!("the scene has glued contacts with the boundaries {}", glued.join(", ")),
            };
            return Err(InputError::new("boundary", message, help));
        }
        let (key, value) = match self.tightening {
            Tightening::Force { space, .. } => ("force", space),
            Tightening::Shortening(shortening) => ("shortening", shortening),
        };
        finite(key, value)?;
        not_huge(key, [value])?;
        self.history.as_ref().map_or(Ok(()), |history| check_points("history", "factor", history))?;
        let Some(lock) = self.lock else { return Ok(()) };
        if key == "shortening" {
            let help = "remove lock, and let history be constant from then on";
            return Err(InputError::new("lock", "a prescribed shortening cannot be locked", help));
        }
        let end = description.end();
        let is_valid = lock > 0.0 && lock < end;
        let help = "give a time within the history, or remove lock";
        let must = format!("above 0 and below the end of the history, {end}");
        ensure(is_valid, "lock", &lock, &must, help)
    }
}
