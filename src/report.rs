//! Results for people and for scripts: contact lines, records, tables, JSON, plots.

#[cfg(feature = "plots")]
mod chart;
mod contact_line;
mod contact_surface;
mod csv;
mod explain;
#[cfg(feature = "meshes")]
mod fields;
#[cfg(all(feature = "meshes", feature = "plots"))]
mod folder;
#[cfg(all(feature = "meshes", feature = "plots"))]
mod increments;
#[cfg(feature = "plots")]
mod map;
#[cfg(feature = "plots")]
mod plot;
#[cfg(feature = "meshes")]
mod pvd;
mod resultant;
mod run;
#[cfg(feature = "cli")]
mod schema;
mod table;
mod unknowns;
mod usage;
mod validity;
#[cfg(feature = "meshes")]
mod vtu;
mod warnings;

#[cfg(feature = "plots")]
pub use chart::{Axis, Chart, Curve, Dash, Line, Marker, Panel, PlotError, Scale};
pub use contact_line::{ContactLine, ContactPoint};
pub use contact_surface::{ContactSurface, SurfaceNode};
pub use csv::table as csv_table;
pub use explain::{Explanation, WorstNode};
#[cfg(feature = "meshes")]
pub use fields::fields;
#[cfg(all(feature = "meshes", feature = "plots"))]
pub use folder::{ResultFolder, write_file};
#[cfg(feature = "plots")]
pub use plot::{contact_stresses, stress_chart};
#[cfg(feature = "meshes")]
pub use pvd::series as pvd_series;
pub use resultant::{ComponentSums, ForceRecord, Resultant};
pub use run::{Facts, Measured, RunReport, SCHEMA_VERSION, Totals};
#[cfg(feature = "cli")]
pub use schema::run_schema;
pub use table::Table;
pub use unknowns::{LeftOut, Unknowns};
pub use usage::{available_bytes, cpu_seconds, peak_rss_bytes};
pub use validity::{LargestDisplacement, NOT_SMALL, Validity};
#[cfg(feature = "meshes")]
pub use vtu::{Field, Grid, Values};
pub use warnings::{Warning, WarningKind};
