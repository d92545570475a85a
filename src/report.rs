//! Results for people and for scripts: contact lines, records, tables, JSON, plots.

mod balance;
mod chart;
mod contact_line;
mod contact_surface;
mod csv;
mod explain;
mod fields;
mod file_names;
mod folder;
mod increments;
mod map;
mod plot;
mod pvd;
mod quantities;
mod resultant;
mod run;
#[cfg(feature = "cli")]
mod schema;
mod svg;
mod table;
mod unit_names;
mod unknowns;
mod usage;
mod validity;
mod vtu;
mod warnings;

pub use balance::{Acting, BalanceRecord};
pub use chart::{Axis, Chart, Curve, Panel, Scale};
pub use contact_line::{ContactLine, ContactPoint};
pub use contact_surface::{ContactSurface, SurfaceNode};
pub use csv::table as csv_table;
pub use explain::{Explanation, WorstNode};
pub use fields::fields;
pub use folder::{ResultFolder, write_file};
pub use plot::{contact_stresses, stress_chart};
pub use pvd::series as pvd_series;
pub use quantities::{column as column_quantity, key as key_quantity};
pub use resultant::{ComponentSums, ForceRecord, Resultant};
pub use run::{Facts, Measured, RunReport, SCHEMA_VERSION, Totals};
#[cfg(feature = "cli")]
pub use schema::run_schema;
pub use svg::{Dash, Line, Marker, PlotError};
pub use table::Table;
pub use unit_names::{NamedUnit, UnitNames};
pub use unknowns::{LeftOut, Unknowns};
pub use usage::{available_bytes, cpu_seconds, peak_rss_bytes};
pub use validity::{LargestDisplacement, NOT_SMALL, Validity};
pub use vtu::{Field, Grid, Values};
pub use warnings::{Warning, WarningKind};
