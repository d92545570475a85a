//! Results for people and for scripts: contact lines, records, tables, JSON, plots.

mod chart;
mod contact_line;
mod contact_surface;
mod csv;
mod fields;
mod folder;
mod map;
mod plot;
mod pvd;
mod run;
mod table;
mod unknowns;
mod usage;
mod vtu;

pub use chart::{Axis, Chart, Curve, Dash, Line, Marker, Panel, PlotError, Scale};
pub use contact_line::{ContactLine, ContactPoint};
pub use contact_surface::{ContactSurface, SurfaceNode};
pub use csv::table as csv_table;
pub use fields::fields;
pub use folder::{ResultFolder, write_file};
pub use plot::{contact_stresses, stress_chart};
pub use pvd::series as pvd_series;
pub use run::{Explanation, Final, Measured, Resultant, RunReport, Totals, WorstNode};
pub use table::Table;
pub use unknowns::{LeftOut, Unknowns};
pub use usage::{available_bytes, cpu_seconds, peak_rss_bytes};
pub use vtu::{Field, Grid, Values};
