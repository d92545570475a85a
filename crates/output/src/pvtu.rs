//! A grid in several VTU files, which VTK's readers share among processes: the text that names them.
//!
//! The format: VTK file formats, "XML file formats", type `PUnstructuredGrid`. It lists the arrays that each piece has, so that one of these
//! needs not be read to know them.

use std::fmt::Write;

use super::vtu::{Field, Grid};

/// The text of the file that names the `pieces` of `grid`.
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
