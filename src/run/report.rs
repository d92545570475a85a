//! The report of a run: forces, pressures, estimates of the errors, and warnings, as plain data.

mod balance;
mod contact_line;
mod csv;
mod cycle;
mod deformation;
mod estimates;
mod explain;
mod friction_use;
mod history_curves;
mod key_results;
mod largest;
mod pairs;
mod peak;
mod pretension_force;
mod principal;
mod probe;
pub(crate) mod quantities;
mod resultant;
mod run;
mod thinned;
mod unknowns;
mod usage;
mod warnings;

pub use balance::{AppliedForce, BalanceRecord, PointRecord, SectionRecord};
pub use contact_line::{ContactLine, ContactPoint, points as contact_points};
pub use csv::{line as csv_line, number as csv_number, table as csv_table};
pub use cycle::{CycleNode, CycleOfBoundary, CycleReport, CycleWatch, CycleWork, SlipRegime};
pub use deformation::deformation;
pub(super) use estimates::ISOLATED;
pub use estimates::{EstimateWatch, Estimates};
pub use explain::{ChangingLoad, Explanation, JointSlip, WorstNode};
pub use history_curves::{ForceCurves, HistoryCurves};
pub(crate) use key_results::KeyWatch;
pub(super) use key_results::Moment;
pub use key_results::{FrictionResult, HoldingForce, LargestForce};
pub(super) use largest::is_as_large;
pub use pairs::PairRecord;
pub use peak::LargestPressure;
pub(super) use pretension_force::PretensionForce;
pub use principal::{principal_stresses, von_mises};
pub use probe::{ProbeTable, ProbeValue};
pub use quantities::{
    Columns, NamedUnit, UnitNames, column as column_quantity, field as field_quantity, in_units,
    is_known as is_known_quantity, key as key_quantity,
};
pub use resultant::{ComponentSums, ForceRecord, OfOpposite, OnObstacle, Resultant};
pub(super) use run::BodyRecord;
pub use run::{ExactPath, LargestDisplacement, RunReport, SCHEMA_VERSION, Totals};
pub use thinned::Thinned;
pub use unknowns::{EliminatedUnknown, Unknowns};
pub use usage::{RankRecord, cpu_seconds, peak_rss_bytes, thread_cpu_seconds};
pub(super) use warnings::kinds;
pub use warnings::{Warning, WarningKind};
