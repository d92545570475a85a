//! Results for people and for scripts: contact lines, records, tables, JSON, plots.

mod balance;
mod chart;
mod colours;
mod contact_line;
mod contact_surface;
mod csv;
mod deformation;
mod deformed;
mod explain;
mod fields;
mod file_names;
mod folder;
mod history_chart;
mod increments;
mod map;
mod plot;
mod principal;
mod probe;
mod pvd;
mod resultant;
mod run;
#[cfg(feature = "cli")]
mod schema;
mod svg;
mod table;
mod unknowns;
mod usage;
mod validity;
mod vtu;
mod warnings;

pub use balance::{Acting, BalanceRecord};
pub use chart::{Axis, Chart, Curve, Panel, Scale};
pub use contact_line::{ContactLine, ContactPoint};
pub use contact_surface::{ContactSurface, SurfaceNode};
pub use csv::{number as csv_number, table as csv_table};
pub use deformed::DeformedBody;
pub use explain::{Explanation, WorstNode};
pub use fields::fields;
pub use folder::{ResultFolder, write_file};
pub use history_chart::history_charts;
pub use plot::{contact_stresses, stress_chart};
pub use principal::{principal_stresses, von_mises};
pub use probe::{ProbeTable, ProbeValue};
pub use pvd::series as pvd_series;
pub use resultant::{ComponentSums, ForceRecord, Resultant};
pub use run::{Facts, Measured, RunReport, SCHEMA_VERSION, Totals};
#[cfg(feature = "cli")]
pub use schema::run_schema;
pub use svg::{Dash, Line, Marker, PlotError};
pub use table::Table;
pub use unknowns::{LeftOut, Unknowns};
pub use usage::{available_bytes, cpu_seconds, peak_rss_bytes};
pub use validity::{LargestDisplacement, LargestPressure, NOT_SMALL, Validity};
pub use vtu::{Field, Grid, Values};
pub use warnings::{Warning, WarningKind};
