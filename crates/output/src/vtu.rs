//! Grids with fields as VTU, the XML format of VTK for unstructured grids, as ParaView reads it.
//!
//! Arrays are base64 within the XML, uncompressed, little-endian: a 64-bit count of bytes, then the
//! values. The format: VTK file formats, "XML file formats", type `UnstructuredGrid`, version 1.0.

use base64::display::Base64Display;
use base64::engine::general_purpose::STANDARD;
use std::fmt;
use stickslip::base::{Quantity, UnitSystem};
use stickslip::run::report::field_quantity;

/// The field data of a file: the sizes of the units of its numbers in SI. Numbers, because many readers refuse texts.
const UNITS: [(&str, Quantity); 2] = [("unit_length", Quantity::Length), ("unit_stress", Quantity::Stress)];

/// The values of a field.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Real numbers; NaN where the field is not defined.
    Real(Vec<f64>),
    /// Whole numbers.
    Whole(Vec<i32>),
}

impl Values {
    /// Returns VTK's name for the type of the values.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Values::Real(_) => "Float64",
            Values::Whole(_) => "Int32",
        }
    }
}

/// A field: a fixed number of values for each point or cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// The name of the field.
    pub name: &'static str,
    /// The number of values per point or cell: 1 for a number, 3 for a vector, 9 for a tensor, row by row.
    pub components: usize,
    /// The values, point by point or cell by cell.
    pub values: Values,
}

/// An unstructured grid with fields.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// The units that the file is written in; the numbers here are SI.
    pub units: UnitSystem,
    /// The points, m.
    pub points: Vec<[f64; 3]>,
    /// The points of each cell, and its type in VTK's numbering.
    pub cells: Vec<(Vec<usize>, u8)>,
    /// Fields with values for each point.
    pub point_fields: Vec<Field>,
    /// Fields with values for each cell.
    pub cell_fields: Vec<Field>,
}

/// Writes the text of a VTU file, an array at a time.
impl fmt::Display for Grid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "<?xml version=\"1.0\"?>\n\
             <VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
             <UnstructuredGrid>\n",
        )?;
        f.write_str("<FieldData>\n")?;
        for (name, quantity) in UNITS {
            let size = self.units.to_si(quantity, 1.0);
            write!(f, "<DataArray type=\"Float64\" Name=\"{name}\" NumberOfTuples=\"1\" format=\"ascii\">")?;
            writeln!(f, "{size}</DataArray>")?;
        }
        f.write_str("</FieldData>\n")?;
        let (points, cells) = (self.points.len(), self.cells.len());
        writeln!(f, "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">")?;
        f.write_str("<Points>\n")?;
        array(f, "Points", "Float64", 3, self.points.iter().flatten().map(|x| self.bytes_of(Quantity::Length, *x)))?;
        f.write_str("</Points>\n<Cells>\n")?;
        let corners = self.cells.iter().flat_map(|(corners, _)| corners);
        array(f, "connectivity", "Int64", 1, corners.map(|&k| (k as i64).to_le_bytes()))?;
        let ends = self.cells.iter().scan(0_i64, |end, (corners, _)| {
            *end += corners.len() as i64;
            Some(end.to_le_bytes())
        });
        array(f, "offsets", "Int64", 1, ends)?;
        array(f, "types", "UInt8", 1, self.cells.iter().map(|&(_, kind)| [kind]))?;
        f.write_str("</Cells>\n")?;
        for (element, fields) in [("PointData", &self.point_fields), ("CellData", &self.cell_fields)] {
            writeln!(f, "<{element}>")?;
            for Field { name, components, values } in fields {
                let (quantity, kind) = (field_quantity(name), values.kind());
                match values {
                    Values::Real(values) => {
                        array(f, name, kind, *components, values.iter().map(|x| self.bytes_of(quantity, *x)))?;
                    }
                    Values::Whole(values) => {
                        array(f, name, kind, *components, values.iter().map(|x| x.to_le_bytes()))?;
                    }
                }
            }
            writeln!(f, "</{element}>")?;
        }
        f.write_str("</Piece>\n</UnstructuredGrid>\n</VTKFile>\n")
    }
}

impl Grid {
    /// Returns the bytes of a number given in SI units.
    fn bytes_of(&self, quantity: Quantity, x: f64) -> [u8; 8] {
        self.units.of_si(quantity, x).to_le_bytes()
    }
}

fn array<const N: usize>(
    f: &mut fmt::Formatter<'_>,
    name: &str,
    kind: &str,
    components: usize,
    values: impl Iterator<Item = [u8; N]>,
) -> fmt::Result {
    // The count of bytes comes first but is known last.
    let mut bytes = vec![0; 8];
    bytes.extend(values.flatten());
    let count = bytes.len() as u64 - 8;
    bytes[..8].copy_from_slice(&count.to_le_bytes());
    let text = Base64Display::new(&bytes, &STANDARD);
    writeln!(
        f,
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"binary\">{text}</DataArray>"
    )
}
