//! Checks of the assumptions of the equations, and the warnings that follow.
//!
//! A check is a file with its kind of warning ([`kinds!`]), threshold, measure and sentence. A new one is a file, its
//! `mod`, and a line in the list [`checks!`] with one of these:
//! - a function of an increment, which returns a warning and its size, as in `friction.rs`;
//! - a type that implements [`Check`] and keeps more of the history, as in `passage.rs`;
//! - a function of the results in [`Solved`], as in `jumps.rs`.

mod balance;
mod contact_zone;
mod displacements;
mod facets;
mod friction;
mod increments;
mod jumps;
mod locking;
mod mesh;
mod model;
mod obstacles;
mod pairs;
mod passage;
mod process;
mod range;
mod sliding;
mod touch;
mod unique;

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserializer, de::Error};
use serde_json::json;

use prelude::*;

/// The names that every check uses.
mod prelude {
    pub(super) use serde::{Deserialize, Serialize};

    pub(super) use super::{Check, Largest, SoFar, Solved};
    pub(super) use crate::base::units::{Quantity, six_digits};
    pub(super) use crate::body::model::Model;
    pub(super) use crate::run::report::{LargestDisplacement, Warning, WarningKind, kinds};
    pub(super) use crate::solver::history::IncrementView;
}

pub(super) use balance::BalanceWatch;

use super::force_jumps::ForceJump;
use super::report::{Estimates, is_as_large};
use crate::body::model::RangeLeft;
use crate::solver::history::{HistoryOutcome, SolverChoice, Status};
use crate::solver::laws::ContactStatus;

/// An assumption of the equations, and what the history tells of it.
trait Check {
    /// Examines the end of a converged increment.
    fn observe(&mut self, model: &Model, step: &IncrementView<'_>, so_far: &SoFar);

    /// Returns the warning, if the assumption is violated.
    fn warning(&self, _model: &Model, _so_far: &SoFar) -> Option<Warning> {
        None
    }

    /// Returns `true` if its indices, restored from a checkpoint, are of `model`.
    fn fits(&self, _model: &Model) -> bool {
        true
    }
}

/// The contact in the increments so far.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
struct SoFar {
    /// The number of converged increments.
    increments: usize,
    /// `true` for each contact node that ever touched its obstacle.
    touched: Vec<bool>,
    /// The largest indentation by contact forces, m.
    indentation: f64,
    /// `true` if the largest indentation so far is that of the last increment.
    is_deepest: bool,
}

impl SoFar {
    fn observe(&mut self, model: &Model, step: &IncrementView<'_>) {
        self.increments += 1;
        self.touched.resize(model.contact.nodes.len(), false);
        let statuses = self.touched.iter_mut().zip(step.statuses);
        statuses.for_each(|(touched, status)| *touched |= *status != ContactStatus::Open);
        let indentation = model.pressed(step.record.time, step.state);
        self.is_deepest = is_as_large(indentation, self.indentation);
        self.indentation = self.indentation.max(indentation);
    }

    /// Describes the size of `length` (m) relative to the indentation.
    fn beside(&self, length: f64) -> String {
        match length / self.indentation {
            share if share < 10.0 => format!("{:.0} % of the indentation", 100.0 * share),
            share if share.is_finite() => "more than ten times the indentation".to_string(),
            _ => "where nothing else presses".to_string(),
        }
    }
}

/// The largest finding of a history, its size and its time, s. The first of equally large ones counts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Largest<T>(Option<(f64, f64, T)>);

impl<T> Default for Largest<T> {
    fn default() -> Self {
        Largest(None)
    }
}

impl<T> Largest<T> {
    /// Takes the size and the finding of an increment.
    fn add(&mut self, step: &IncrementView<'_>, found: Option<(f64, T)>) {
        if let Some((size, found)) = found
            && self.0.as_ref().is_none_or(|(largest, ..)| size > *largest)
        {
            self.0 = Some((size, step.record.time, found));
        }
    }

    /// Returns the size, the time in six digits, s, and the finding, if the size exceeds `limit`.
    fn above(&self, limit: f64) -> Option<(f64, f64, &T)> {
        let (size, time, found) = self.0.as_ref().filter(|(size, ..)| *size > limit)?;
        Some((*size, six_digits(*time), found))
    }
}

/// Declares the list of the modules with kinds of warnings, in the order of their warnings. Behind a module stand, as far
/// as it has them: in parentheses its functions of an increment, of whose warnings the largest of a history is given; in
/// braces its types that implement [`Check`]; behind the arrow its function of the results.
macro_rules! checks {
    ($($module:ident
        $(($($largest:ident),*))? $({ $($check:ident: $of_history:ty),* })? $(=> $of_results:ident)?;)*) => {
        /// The state that the checks keep of a history.
        #[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
        pub(super) struct Checks {
            so_far: SoFar,
            $($($($largest: Largest<Warning>,)*)? $($($check: $of_history,)*)?)*
        }

        impl Checks {
            /// Examines the end of an increment. Increments that did not converge are ignored.
            pub(super) fn observe(&mut self, model: &Model, step: &IncrementView<'_>) {
                if step.record.status == Status::Converged {
                    self.so_far.observe(model, step);
                    $($($(self.$largest.add(step, $module::$largest(model, step));)*)?)*
                    $($($(self.$check.observe(model, step, &self.so_far);)*)?)*
                }
            }

            /// Returns `true` if the checks, restored from a checkpoint, are of `model`.
            pub(super) fn fit(&self, model: &Model) -> bool {
                self.so_far.touched.len() == model.contact.nodes.len() $($($(&& self.$check.fits(model))*)?)*
            }
        }

        impl Solved<'_> {
            /// Returns the warnings of the increments and of the results.
            fn found(&self) -> Vec<Warning> {
                let (mut warnings, checks) = (Vec::new(), self.checks);
                $(
                    $($(warnings.extend(checks.$largest.0.iter().map(|(.., warning)| warning.clone()));)*)?
                    $($(warnings.extend(checks.$check.warning(self.model, &checks.so_far));)*)?
                    $(warnings.extend($module::$of_results(self));)?
                )*
                warnings
            }
        }

        /// Returns all kinds of warnings, by name.
        fn kinds() -> Vec<WarningKind> {
            let mut kinds = [$($module::KINDS),*].concat();
            kinds.sort_by_key(|kind| kind.name);
            kinds
        }
    };
}

checks! {
    touch { leaning: touch::LeaningObstacle } => no_contact;
    displacements { displacements: displacements::LargeDisplacements } => strains;
    range { range: range::GapsOutOfRange };
    pairs (beyond_the_end, passed_through);
    facets { faceted_gaps: facets::FacetedGaps, faceted_obstacle: facets::FacetedObstacle } => of_pairs;
    friction (left_out);
    obstacles { not_met: obstacles::ObstacleNotMet, between_nodes: obstacles::ObstacleBetweenNodes };
    passage { passage: passage::Passage } => along_chords;
    sliding (slid, large_motion);
    unique { neutral: unique::NeutralEquilibrium } => shared_forces;
    contact_zone => warnings;
    mesh => warnings;
    increments => warnings;
    jumps => warning;
    balance => warning;
    locking;
    model;
    process;
}

impl Checks {
    /// Returns the largest displacement, if there was any increment.
    pub(super) fn largest_displacement(&self) -> Option<LargestDisplacement> {
        let (length, time, position) = self.displacements.0.0?;
        Some(LargestDisplacement { length, position, time })
    }

    /// Returns the largest error of the linearised gaps, if they were out of their range.
    pub(super) fn range_left(&self) -> Option<RangeLeft> {
        self.range.0
    }
}

/// A run that is solved, with all that its warnings are about.
pub(super) struct Solved<'a> {
    pub model: &'a Model,
    pub solver: &'a SolverChoice,
    pub outcome: &'a HistoryOutcome,
    pub checks: &'a Checks,
    pub balance: &'a BalanceWatch,
    pub estimates: &'a Estimates,
    /// The first jump of contact forces, if any.
    pub jump: Option<ForceJump>,
}

impl Solved<'_> {
    /// Returns the warnings of the model and of its results.
    pub(super) fn warnings(&self) -> Vec<Warning> {
        let mut warnings = Warning::of_model(self.model);
        // The locking found in the solution replaces the expected one.
        warnings.retain(|warning| warning.kind != WarningKind::LOCKING || self.estimates.locking.is_none());
        warnings.extend(self.found());
        warnings
    }
}

impl<'de> Deserialize<'de> for WarningKind {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        let kind = kinds().into_iter().find(|kind| kind.name == name);
        kind.ok_or_else(|| D::Error::custom("no kind of warning"))
    }
}

impl JsonSchema for WarningKind {
    fn schema_name() -> Cow<'static, str> {
        "WarningKind".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let of = |kind: &WarningKind| json!({"type": "string", "const": kind.name, "description": kind.meaning});
        json_schema!({"description": "The kind of a warning.", "oneOf": kinds().iter().map(of).collect::<Vec<_>>()})
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::body::contact::Obstacle;
    use crate::body::description::{Axis, Description};
    use crate::body::fem::Material;
    use crate::body::mesh::MeshSource;

    /// A checkpoint may be damaged although its checksum is right.
    #[test]
    fn a_node_beyond_the_contact_does_not_fit() {
        let plate = Description::new(MeshSource::block([2.0, 1.0], [4, 2]), Material::new(1e9, 0.3), vec![1.0])
            .support("top", &[Axis::X, Axis::Y])
            .contact("bottom", 0.3, Obstacle::plane(1e-3));
        let model = Model::build(&plate).unwrap();
        let contacts = model.contact.nodes.len();
        let checks = |contacts: usize, contact: usize| Checks {
            so_far: SoFar { touched: vec![false; contacts], ..SoFar::default() },
            leaning: touch::LeaningObstacle(Some((contact, 1.0))),
            ..Checks::default()
        };
        let fit = |contacts: usize, contact: usize| checks(contacts, contact).fit(&model);
        assert_eq!([fit(contacts, contacts - 1), fit(contacts, contacts), fit(contacts + 1, 0)], [true, false, false]);
    }

    /// The table of the page of warnings is that of the kinds. `PAGES=write` writes it.
    #[test]
    fn the_page_has_the_kinds() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/doc/reference/warnings.md");
        let page = fs::read_to_string(path).unwrap();
        let (head, rest) = page.split_once("| --- | --- | --- | --- |\n").unwrap();
        let (_, tail) = rest.split_once("\n\n").unwrap();
        let row = |WarningKind { name, meaning, cure, ignored_if, needs_the_solution }: &WarningKind| {
            let mark = if *needs_the_solution { "" } else { "¹" };
            format!("| `{name}`{mark} | {meaning} | {cure} | {ignored_if} |")
        };
        let table = kinds().iter().map(row).collect::<Vec<_>>().join("\n");
        let made = format!("{head}| --- | --- | --- | --- |\n{table}\n\n{tail}");
        if std::env::var("PAGES").is_ok_and(|word| word == "write") {
            fs::write(path, &made).unwrap();
        } else {
            assert_eq!(page, made, "PAGES=write writes the page");
        }
    }

    /// A name stands for one kind, and each kind has all that the page says.
    #[test]
    fn kinds_are_complete() {
        let kinds = kinds();
        assert!(kinds.windows(2).all(|pair| pair[0].name < pair[1].name));
        let texts = kinds.iter().flat_map(|kind| [kind.meaning, kind.cure, kind.ignored_if]);
        assert!(texts.into_iter().all(|text| !text.is_empty() && !text.contains(['|', '\n'])));
    }
}
