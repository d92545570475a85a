//! The list of the VTU files of a grid in several pieces, which VTK's readers distribute to processes.
//!
//! The format: VTK file formats, "XML file formats", type `PUnstructuredGrid`. It lists the arrays of the pieces, so
//! that a reader need not open a piece to know them.

use std::fmt::Write;

use super::vtu::{Field, Grid};

/// Returns the text of the file that lists the `pieces` of `grid`.
pub(super) fn parallel<'a>(grid: &Grid, pieces: impl IntoIterator<Item = &'a str>) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
         <PUnstructuredGrid GhostLevel=\"0\">\n\
         <PPoints>\n",
    );
    array(&mut text, "Points", "Float64", 3);
    text.push_str("</PPoints>\n");
    for (element, fields) in [("PPointData", &grid.point_fields), ("PCellData", &grid.cell_fields)] {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "<{element}>");
        for Field { name, components, values } in fields {
            array(&mut text, name, values.kind(), *components);
        }
        let _ = writeln!(text, "</{element}>");
    }
    for piece in pieces {
        let _ = writeln!(text, "<Piece Source=\"{piece}\"/>");
    }
    text.push_str("</PUnstructuredGrid>\n</VTKFile>\n");
    text
}

fn array(text: &mut String, name: &str, kind: &str, components: usize) {
    let _ = writeln!(text, "<PDataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\"/>");
}
