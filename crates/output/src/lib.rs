//! Writes the results of a run: its folder, tables, fields for ParaView, charts and maps.

mod chart;
mod colours;
mod contact_surface;
mod deformed;
mod disk;
mod fields;
mod file_names;
mod folder;
mod history_chart;
mod increments;
mod largest;
mod lists;
mod map;
mod mesh_lines;
mod msh;
mod pace;
mod page;
mod part;
mod plot;
mod pvd;
mod pvtu;
mod schema;
mod svg;
mod table;
mod unrolled;
mod view;
mod visible;
mod vtu;

pub use chart::{Axis, Chart, Curve, Note, Panel, Scale, curve_style};
pub use contact_surface::{ContactSurface, SurfaceNode};
pub use deformed::DeformedBody;
pub use disk::bytes_on_disk;
pub use fields::fields;
pub use folder::{FileLock, FolderLock, KeptSolver, LockedOutputDir, ResultFolder, write_file, write_page};
pub use history_chart::history_charts;
pub use msh::msh;
pub use pace::Pace;
pub use page::error::PageError;
pub use page::{CHART_SCRIPT, MAX_STATES, filled};
pub use plot::{contact_stresses, stress_chart};
pub use pvd::series as pvd_series;
pub use schema::{run_schema, schema_of};
pub use svg::{Dash, Line, Marker, PlotError};
pub use table::{LABEL, Table, paragraph};
pub use vtu::{Field, Grid, Values};

#[cfg(test)]
mod tests {
    use super::{fields, increments};
    use stickslip::run::report::is_known_quantity;

    /// A column or field without a quantity would be written in SI units, whatever its neighbours are written in.
    #[test]
    fn every_column_and_field_has_its_quantity() {
        let forces = [2, 3].map(|dimension| increments::forces_header(dimension, true, true));
        let events = [2, 3].map(increments::events_header);
        let headers = [increments::header()].into_iter().chain(forces).chain(events).collect::<Vec<_>>();
        let columns = headers.iter().flat_map(|header| header.trim_end().split(','));
        for name in columns.chain(fields::NAMES) {
            assert!(is_known_quantity(name), "{name}");
        }
    }
}
