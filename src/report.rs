//! Results for people and for scripts: contact lines, records, tables, JSON, plots.

mod contact_line;
mod csv;
mod folder;
mod plot;
mod run;
mod table;
mod usage;

pub use contact_line::{ContactLine, ContactPoint};
pub use folder::ResultFolder;
pub use plot::contact_stresses;
pub use run::{Final, Measured, Resultant, RunReport, Totals, Unknowns};
pub use table::Table;
pub use usage::{available_bytes, cpu_seconds, peak_rss_bytes};
