//! VTU files, and PVTU files that name some, read by the XML of a maintained crate and the page "VTK XML file formats" alone: nothing here is the writer's.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use roxmltree::{Document, Node};

/// VTK's numbers for the types of cells.
pub const QUAD: u8 = 9;
pub const TETRA: u8 = 10;
pub const HEXAHEDRON: u8 = 12;
pub const WEDGE: u8 = 13;

/// An array: its name, its numbers to a point or a cell, and all its numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    pub name: String,
    pub components: usize,
    pub values: Vec<f64>,
}

/// A grid in several files: the arrays that each of them has, without numbers, and these files.
#[derive(Debug, Clone, PartialEq)]
pub struct Parallel {
    pub point: Vec<Array>,
    pub cell: Vec<Array>,
    pub sources: Vec<String>,
}

impl Parallel {
    /// What a text names.
    pub fn read(text: &str) -> Self {
        let document = Document::parse(text).unwrap();
        let root = document.root_element();
        let said = ["type", "byte_order", "header_type"].map(|name| attribute(root, name));
        assert_eq!((root.tag_name().name(), said), ("VTKFile", ["PUnstructuredGrid", "LittleEndian", "UInt64"]));
        let grid = child(root, "PUnstructuredGrid");
        assert_eq!(attribute(grid, "GhostLevel"), "0");
        let arrays = |name: &str| child(grid, name).children().filter(Node::is_element).map(declared).collect();
        let points: Vec<Array> = arrays("PPoints");
        assert_eq!(points, [Array { name: "Points".to_string(), components: 3, values: Vec::new() }]);
        let pieces = grid.children().filter(|child| child.has_tag_name("Piece"));
        Parallel {
            point: arrays("PPointData"),
            cell: arrays("PCellData"),
            sources: pieces.map(|piece| attribute(piece, "Source").to_string()).collect(),
        }
    }
}

/// The one piece of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// Three numbers to a point.
    pub points: Vec<f64>,
    /// The points of all cells, one after the other, and where each cell ends.
    pub connectivity: Vec<u64>,
    pub offsets: Vec<u64>,
    pub types: Vec<u8>,
    pub point: Vec<Array>,
    pub cell: Vec<Array>,
}

impl Piece {
    /// The piece of a text. What the format does not allow is a panic: arrays that do not fit their numbers of points and cells,
    /// cells that do not end where the array of their points does, points that are not there.
    pub fn read(text: &str) -> Self {
        let document = Document::parse(text).unwrap();
        let root = document.root_element();
        let said = ["type", "byte_order", "header_type"].map(|name| attribute(root, name));
        assert_eq!((root.tag_name().name(), said), ("VTKFile", ["UnstructuredGrid", "LittleEndian", "UInt64"]));
        assert_eq!(root.attribute("compressor"), None);
        let piece = child(child(root, "UnstructuredGrid"), "Piece");
        let [points, cells] = ["NumberOfPoints", "NumberOfCells"].map(|name| attribute(piece, name).parse().unwrap());
        let whole = |array: &Array| array.values.iter().map(|x| *x as u64).collect::<Vec<_>>();
        let [coordinates] = arrays(child(piece, "Points"), points).try_into().unwrap();
        let lists = child(piece, "Cells");
        let list = |name: &str| {
            let found = lists.children().find(|node| node.attribute("Name") == Some(name));
            whole(&array(found.unwrap_or_else(|| panic!("{name} is missing"))))
        };
        let read = Piece {
            points: coordinates.values,
            connectivity: list("connectivity"),
            offsets: list("offsets"),
            types: list("types").into_iter().map(|kind| kind as u8).collect(),
            point: arrays(child(piece, "PointData"), points),
            cell: arrays(child(piece, "CellData"), cells),
        };
        assert_eq!((coordinates.components, read.offsets.len(), read.types.len()), (3, cells, cells));
        assert!(
            read.offsets.is_sorted() && read.offsets.last().is_none_or(|end| *end == read.connectivity.len() as u64)
        );
        assert!(read.connectivity.iter().all(|point| (*point as usize) < points));
        read
    }
}

/// The numbers to a point or a cell of the array of this name, and all its numbers.
pub fn values(arrays: &[Array], name: &str) -> (usize, Vec<f64>) {
    let found = arrays.iter().find(|array| array.name == name).unwrap_or_else(|| panic!("{name} is missing"));
    (found.components, found.values.clone())
}

fn attribute<'a>(node: Node<'a, '_>, name: &str) -> &'a str {
    node.attribute(name).unwrap_or_else(|| panic!("{node:?} has no {name}"))
}

fn child<'a, 'd>(node: Node<'a, 'd>, name: &str) -> Node<'a, 'd> {
    let mut found = node.children().filter(|child| child.has_tag_name(name));
    let first = found.next().unwrap_or_else(|| panic!("{node:?} has no {name}"));
    assert!(found.next().is_none(), "one {name}, not several");
    first
}

/// All arrays below a node, each with numbers for `count` points or cells.
fn arrays(node: Node, count: usize) -> Vec<Array> {
    let arrays: Vec<Array> = node.children().filter(Node::is_element).map(array).collect();
    for array in &arrays {
        assert_eq!(array.values.len(), count * array.components, "{}", array.name);
    }
    arrays
}

/// An array that other files have.
fn declared(node: Node) -> Array {
    assert_eq!(node.tag_name().name(), "PDataArray");
    assert!(["Float64", "Int32"].contains(&attribute(node, "type")));
    Array {
        name: attribute(node, "Name").to_string(),
        components: attribute(node, "NumberOfComponents").parse().unwrap(),
        values: Vec::new(),
    }
}

/// An array within the XML: base64 of so many bytes as the first eight say, then these.
fn array(node: Node) -> Array {
    assert_eq!((node.tag_name().name(), attribute(node, "format")), ("DataArray", "binary"));
    let bytes = STANDARD.decode(node.text().unwrap_or_default().trim()).unwrap();
    let (length, bytes) = bytes.split_first_chunk().unwrap();
    assert_eq!(u64::from_le_bytes(*length), bytes.len() as u64);
    let values = match attribute(node, "type") {
        "Float64" => numbers(bytes, f64::from_le_bytes),
        "Int64" => numbers(bytes, |bytes| i64::from_le_bytes(bytes) as f64),
        "Int32" => numbers(bytes, |bytes| i32::from_le_bytes(bytes).into()),
        "UInt8" => numbers(bytes, |[byte]| byte.into()),
        other => panic!("{other}"),
    };
    Array {
        name: attribute(node, "Name").to_string(),
        components: attribute(node, "NumberOfComponents").parse().unwrap(),
        values,
    }
}

fn numbers<const N: usize>(bytes: &[u8], of: impl Fn([u8; N]) -> f64) -> Vec<f64> {
    let (numbers, rest) = bytes.as_chunks();
    assert!(rest.is_empty());
    numbers.iter().map(|bytes| of(*bytes)).collect()
}
