//! Parser of universal files (UNV), as I-DEAS, Salome and Gmsh write them.
//!
//! Groups of elements become material groups and boundaries. A group of nodes alone is a boundary if it has all nodes of
//! a side that belongs to one element only. Sources: Structural Dynamics Research Laboratory, University of Cincinnati,
//! universal file formats, datasets 15, 164, 781, 2411, 2412, 2420, 2467 and 2477; for the numbers of nodes and the
//! older datasets of groups, the files of Salome and Gmsh.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::str::FromStr;

use super::raw::{Element, ElementKind, RawMesh, add_boundary, no_side, outer, real, shortened, within};
use super::{MeshFormatError, Parsed, Place, expect};
use crate::base::input::FileKind;
use crate::body::mesh::CellKind;

/// The largest number of letters of a name; the format has 40, Salome writes more.
const MAX_LETTERS: usize = 200;

/// Parses `bytes`; messages name the file `name`.
pub(super) fn read(name: &str, bytes: &[u8]) -> Parsed<RawMesh> {
    expect(name, bytes, FileKind::Unv)?;
    let mut lines = Lines::new(name, bytes);
    let mut model = Model::default();
    while let Some(dataset) = lines.dataset()? {
        match dataset.as_str() {
            "2411" | "781" => model.take_nodes(&mut lines, true)?,
            "15" => model.take_nodes(&mut lines, false)?,
            "2412" => model.take_elements(&mut lines)?,
            "2417" | "2429" | "2430" | "2432" => model.take_groups(&mut lines, 2)?,
            "2435" | "2452" | "2467" | "2477" => model.take_groups(&mut lines, 4)?,
            "2420" => model.take_systems(&mut lines)?,
            "164" => model.take_units(&mut lines)?,
            _ => {
                if !model.aside.contains(&dataset) {
                    model.aside.push(dataset);
                }
                lines.skip()?;
            }
        }
    }
    model.finish(&lines)
}

/// A named group.
struct Group {
    name: String,
    /// The indices of its nodes.
    nodes: Vec<usize>,
    has_elements: bool,
}

/// The contents of the datasets read so far.
#[derive(Default)]
struct Model {
    mesh: RawMesh,
    nodes: HashMap<usize, usize>,
    elements: Vec<Element>,
    element_indices: HashMap<usize, usize>,
    groups: Vec<Group>,
    group_indices: HashMap<String, usize>,
    /// The indices of the groups of each element.
    memberships: Vec<Vec<usize>>,
    /// The first node in each system of coordinates, and its line.
    first_in: HashMap<usize, (usize, usize)>,
    /// The systems of coordinates that are not the global one.
    local_systems: HashSet<usize>,
    /// The datasets that are no mesh.
    aside: Vec<String>,
}

impl Model {
    /// Reads nodes with their coordinates in the next line, or in the same one.
    fn take_nodes(&mut self, lines: &mut Lines<'_>, next_line: bool) -> Parsed<()> {
        let what = "the number of a node, three more whole numbers and three finite coordinates";
        while let Some(line) = lines.record()? {
            let mut words: Vec<String> = line.split_whitespace().map(str::to_string).collect();
            if next_line {
                if words.len() != 4 {
                    return Err(lines.malformed("the number of a node and three more whole numbers"));
                }
                words.extend(lines.more("three finite coordinates")?.split_whitespace().map(str::to_string));
            }
            let [number, system, _, _, x, y, z] = &words[..] else { return Err(lines.malformed(what)) };
            let (Ok(number), Ok(system)) = (number.parse(), system.parse()) else {
                return Err(lines.malformed(what));
            };
            let (Some(x), Some(y), Some(z)) = (real(x), real(y), real(z)) else { return Err(lines.malformed(what)) };
            if self.nodes.insert(number, self.mesh.nodes.len()).is_some() {
                return Err(lines.damaged(format!("the node {number} is there twice")));
            }
            self.first_in.entry(system).or_insert((number, lines.line));
            self.mesh.nodes.push([x, y, z]);
            self.mesh.numbers.push(number);
        }
        Ok(())
    }

    fn take_elements(&mut self, lines: &mut Lines<'_>) -> Parsed<()> {
        let what = "an element: its number, its descriptor, three more whole numbers and the number of its nodes";
        while let Some(line) = lines.record()? {
            let header: Vec<usize> = lines.numbers(&line, what)?;
            let [number, descriptor, _, _, _, count] = header[..] else { return Err(lines.malformed(what)) };
            let kind = if is_beam(descriptor) {
                lines.more("three whole numbers of a beam")?;
                if count == 2 { ElementKind::Line } else { ElementKind::Line3 }
            } else {
                ElementKind::Cell(kind_of(descriptor).map_err(|name| {
                    let message =
                        format!("element {number} has the descriptor {descriptor} ({name}), which is not supported");
                    let help = "mesh with triangles, quadrilaterals, tetrahedra, hexahedra or prisms of first or second order, and export \
                                only these and edges";
                    lines.error(message, help)
                })?)
            };
            if count != kind.nodes() {
                let message = format!("element {number} has {count} nodes, but a {kind} has {}", kind.nodes());
                return Err(lines.damaged(message));
            }
            let mut nodes = Vec::new();
            while nodes.len() < count {
                let what = "the nodes of an element";
                let line = lines.more(what)?;
                for node in lines.numbers::<usize>(&line, what)? {
                    let index = self.nodes.get(&node).copied();
                    let absent = || {
                        lines.damaged(format!(
                            "element {number} names the node {node}, which no dataset of nodes before it has"
                        ))
                    };
                    nodes.push(index.ok_or_else(absent)?);
                }
            }
            if nodes.len() > count {
                return Err(lines.malformed(&format!("{count} nodes of the element {number}")));
            }
            if let ElementKind::Cell(kind) = kind {
                nodes = order(kind).into_iter().map(|place| nodes[place]).collect();
            }
            if self.element_indices.insert(number, self.elements.len()).is_some() {
                return Err(lines.damaged(format!("the element {number} is there twice")));
            }
            self.elements.push(Element { number, kind, nodes });
            self.memberships.push(Vec::new());
        }
        Ok(())
    }

    /// Reads groups whose members are given by so many numbers each, first the type and the number.
    fn take_groups(&mut self, lines: &mut Lines<'_>, width: usize) -> Parsed<()> {
        let what = "a group: its number, six more whole numbers and the number of its members";
        while let Some(line) = lines.record()? {
            let header: Vec<i64> = lines.numbers(&line, what)?;
            let [number, _, _, _, _, _, _, count] = header[..] else { return Err(lines.malformed(what)) };
            let Ok(count) = usize::try_from(count) else { return Err(lines.malformed(what)) };
            let mut name = lines.name()?;
            if name.is_empty() {
                name = number.to_string();
            }
            if name.chars().count() > MAX_LETTERS {
                let message = format!("the name of the group {number} has more than {MAX_LETTERS} letters");
                return Err(lines.error(message, "give the group a shorter name"));
            }
            let group = *self.group_indices.entry(name.clone()).or_insert_with(|| {
                self.groups.push(Group { name, nodes: Vec::new(), has_elements: false });
                self.groups.len() - 1
            });
            let (mut read, mut member) = (0, Vec::new());
            while read < count {
                let what = "types and numbers of members of a group";
                let line = lines.more(what)?;
                for value in lines.numbers::<i64>(&line, what)? {
                    member.push(value);
                    if member.len() == width {
                        self.add_member(lines, group, member[0], member[1])?;
                        member.clear();
                        read += 1;
                    }
                }
            }
            if read > count || !member.is_empty() {
                return Err(lines.malformed(&format!("the last of {count} members of the group")));
            }
        }
        Ok(())
    }

    /// Adds a member to a group. Members other than nodes and elements are no part of the mesh.
    fn add_member(&mut self, lines: &Lines<'_>, group: usize, code: i64, number: i64) -> Parsed<()> {
        let (what, indices) = match code {
            7 => ("node", &self.nodes),
            8 => ("element", &self.element_indices),
            _ => return Ok(()),
        };
        let index = usize::try_from(number).ok().and_then(|number| indices.get(&number)).copied();
        let Group { name, nodes, has_elements } = &mut self.groups[group];
        let Some(index) = index else {
            let message =
                format!("the group `{name}` has the {what} {number}, which no dataset of {what}s before it has");
            return Err(lines.damaged(message));
        };
        if code == 7 {
            nodes.push(index);
        } else {
            *has_elements = true;
            self.memberships[index].push(group);
        }
        Ok(())
    }

    /// Reads systems of coordinates.
    fn take_systems(&mut self, lines: &mut Lines<'_>) -> Parsed<()> {
        // The part and its name.
        if lines.record()?.is_none() {
            return Ok(());
        }
        lines.name()?;
        while let Some(line) = lines.record()? {
            let what = "a system of coordinates: its number, its type and its colour";
            let header: Vec<usize> = lines.numbers(&line, what)?;
            let [number, kind, _] = header[..] else { return Err(lines.malformed(what)) };
            lines.name()?;
            let mut global = kind == 0;
            for row in 0..4 {
                let what = "three numbers of the axes or the origin of a system of coordinates";
                let line = lines.more(what)?;
                let values: Option<Vec<f64>> = line.split_whitespace().map(real).collect();
                let Some(values) = values.filter(|values| values.len() == 3) else {
                    return Err(lines.malformed(what));
                };
                let unit = |column: usize| if column == row { 1.0 } else { 0.0 };
                global &= values.iter().enumerate().all(|(column, &value)| value == unit(column));
            }
            if !global {
                self.local_systems.insert(number);
            }
        }
        Ok(())
    }

    /// Remarks on the units of the file.
    fn take_units(&mut self, lines: &mut Lines<'_>) -> Parsed<()> {
        if let Some(line) = lines.record()? {
            let name: String = line.chars().skip(10).take(20).filter(|letter| !letter.is_control()).collect();
            self.mesh.remarks.push(format!(
                "the units of the file, `{}`, are left aside: mesh.scale or [units] gives its unit of length",
                name.trim()
            ));
            lines.skip()?;
        }
        Ok(())
    }

    /// Converts all that was taken to a mesh.
    fn finish(mut self, lines: &Lines<'_>) -> Parsed<RawMesh> {
        let local = self.local_systems.iter().filter_map(|system| Some((self.first_in.get(system)?, system)));
        if let Some(((node, line), system)) = local.min() {
            let message = format!("node {node} is in the system of coordinates {system}, which is not the global one");
            return Err(lines.error_at(*line, message, "export the mesh in the global rectangular coordinates"));
        }
        if !self.aside.is_empty() {
            let all = self.aside.join(", ");
            self.mesh.remarks.push(format!("left aside, as no part of the mesh: the datasets {all}"));
        }
        for (element, mut groups) in self.elements.iter().zip(std::mem::take(&mut self.memberships)) {
            groups.sort_unstable();
            groups.dedup();
            let names = groups.into_iter().map(|group| self.groups[group].name.clone()).collect();
            self.mesh.add(element.kind, names, (element.number, element.nodes.clone()));
        }
        let dimension = self.elements.iter().map(|element| element.kind.dimension()).max().unwrap_or(0);
        let sets: Vec<&Group> = self.groups.iter().filter(|set| !set.has_elements && !set.nodes.is_empty()).collect();
        let outer = if sets.is_empty() { Vec::new() } else { outer(&self.elements, dimension) };
        // Node sets that repeat one another could otherwise have more sides than the memory holds.
        let mut left = 1000 + 16 * lines.line;
        for Group { name, nodes, .. } in sets {
            let sides = within(&self.elements, &outer, nodes);
            if sides.is_empty() {
                let remark = no_side(&self.mesh, dimension, name, nodes);
                self.mesh.remarks.push(remark);
            }
            left = left.checked_sub(sides.len()).ok_or_else(|| {
                lines.error(
                    "the groups of nodes repeat one another: they have far more sides than the file has lines",
                    "define fewer groups",
                )
            })?;
            add_boundary(&mut self.mesh, &self.elements, name, &sides);
        }
        Ok(self.mesh)
    }
}

/// Returns `true` for rods and beams, which have a record of their own before their nodes.
fn is_beam(descriptor: usize) -> bool {
    matches!(descriptor, 11 | 21..=25)
}

/// Returns the kind of cells of a `descriptor`. The error is the name of an unsupported element.
fn kind_of(descriptor: usize) -> Result<CellKind, &'static str> {
    Ok(match descriptor {
        41 | 51 | 61 | 74 | 81 | 91 => CellKind::Triangle,
        42 | 52 | 62 | 72 | 82 | 92 => CellKind::Triangle6,
        44 | 54 | 64 | 71 | 84 | 94 => CellKind::Quadrilateral,
        45 | 55 | 65 | 75 | 85 | 95 => CellKind::Quadrilateral8,
        111 => CellKind::Tetrahedron,
        112 => CellKind::Prism,
        115 => CellKind::Hexahedron,
        113 => CellKind::Prism15,
        116 => CellKind::Hexahedron20,
        118 => CellKind::Tetrahedron10,
        114 => return Err("pyramid of second order, or prism of third order"),
        43 | 46 | 53 | 56 | 63 | 66 | 73 | 76 | 93 | 96 | 117 => return Err("third order"),
        31 | 32 => return Err("pipe"),
        101..=106 => return Err("thick shell"),
        121 | 122 => return Err("rigid element"),
        136..=142 => return Err("spring or damper"),
        151..=152 => return Err("gap"),
        161 => return Err("mass"),
        _ => return Err("unknown"),
    })
}

/// Returns the place in the file of each node of a cell in the order of [`CellKind`]. Nodes at the middles of edges come
/// between the corners.
fn order(kind: CellKind) -> Vec<usize> {
    match kind {
        CellKind::Triangle6 => vec![0, 2, 4, 1, 3, 5],
        CellKind::Quadrilateral8 => vec![0, 2, 4, 6, 1, 3, 5, 7],
        CellKind::Prism15 => vec![0, 2, 4, 9, 11, 13, 1, 3, 5, 10, 12, 14, 6, 7, 8],
        CellKind::Hexahedron20 => vec![0, 2, 4, 6, 12, 14, 16, 18, 1, 3, 5, 7, 13, 15, 17, 19, 8, 9, 10, 11],
        CellKind::Tetrahedron10 => vec![0, 2, 4, 9, 1, 3, 5, 6, 7, 8],
        _ => (0..kind.nodes()).collect(),
    }
}

const AGAIN: &str = "export the mesh again as UNV";
const CUT: &str = "the file is cut off: export or copy it again";

/// The line before and after each dataset.
const DELIMITER: &str = "-1";

/// A reader of the lines of a file from its beginning to its end.
struct Lines<'a> {
    file: &'a str,
    rest: &'a [u8],
    /// The number of the last line read, from 1.
    line: usize,
    /// The number of the dataset that is read.
    dataset: String,
}

impl<'a> Lines<'a> {
    fn new(file: &'a str, bytes: &'a [u8]) -> Self {
        Lines { file, rest: bytes, line: 0, dataset: String::new() }
    }

    /// Returns the next line without its end.
    fn next(&mut self) -> Option<Cow<'a, str>> {
        if self.rest.is_empty() {
            return None;
        }
        let length = self.rest.iter().position(|&byte| byte == b'\n').map_or(self.rest.len(), |end| end + 1);
        let (line, rest) = self.rest.split_at(length);
        self.rest = rest;
        self.line += 1;
        Some(String::from_utf8_lossy(line.trim_ascii_end()))
    }

    fn next_filled(&mut self) -> Option<Cow<'a, str>> {
        std::iter::from_fn(|| self.next()).find(|line| !line.trim().is_empty())
    }

    /// Goes to the next dataset and returns its number; `None` at the end of the file.
    fn dataset(&mut self) -> Parsed<Option<String>> {
        let Some(line) = self.next_filled() else { return Ok(None) };
        if line.trim() != DELIMITER {
            let line = shortened(&line);
            return Err(self.damaged(format!("a dataset, which begins with -1, was expected, but there is `{line}`")));
        }
        let Some(line) = self.next_filled() else {
            return Err(self.error("the file ends before the number of a dataset", CUT));
        };
        // 58b and others have binary data, which a header describes.
        let number = line.split_whitespace().next().unwrap_or_default();
        if !number.trim_end_matches('b').bytes().all(|digit| digit.is_ascii_digit()) {
            let message = format!("the number of a dataset was expected, but there is `{}`", shortened(&line));
            return Err(self.damaged(message));
        }
        self.dataset = number.to_string();
        Ok(Some(self.dataset.clone()))
    }

    /// Returns the next line of the dataset that is not empty; `None` at its end.
    fn record(&mut self) -> Parsed<Option<Cow<'a, str>>> {
        match self.next_filled() {
            None => Err(self.ends()),
            Some(line) if line.trim() == DELIMITER => Ok(None),
            Some(line) => Ok(Some(line)),
        }
    }

    /// Returns the next line of a record that has begun, where `what` is expected.
    fn more(&mut self, what: &str) -> Parsed<Cow<'a, str>> {
        self.record()?.ok_or_else(|| self.malformed(what))
    }

    /// Returns the next line, which may be empty, as a name.
    fn name(&mut self) -> Parsed<String> {
        self.next().map(|line| line.trim().to_string()).ok_or_else(|| self.ends())
    }

    /// Reads the numbers of a line, where `what` is expected.
    fn numbers<T: FromStr>(&self, line: &str, what: &str) -> Parsed<Vec<T>> {
        line.split_whitespace().map(|word| word.parse().map_err(|_| self.malformed(what))).collect()
    }

    /// Goes to the end of the dataset.
    fn skip(&mut self) -> Parsed<()> {
        while self.record()?.is_some() {}
        Ok(())
    }

    fn ends(&self) -> MeshFormatError {
        self.error(format!("the file ends within the dataset {}", self.dataset), CUT)
    }

    /// Creates an error at the line that was read last.
    fn error(&self, message: impl Into<String>, help: impl Into<String>) -> MeshFormatError {
        self.error_at(self.line, message, help)
    }

    /// Creates an error at a `line`.
    fn error_at(&self, line: usize, message: impl Into<String>, help: impl Into<String>) -> MeshFormatError {
        MeshFormatError::new(self.file, Place::Line(line.max(1)), message, help)
    }

    /// Creates the error of a fault that only a new export cures.
    fn damaged(&self, message: impl Into<String>) -> MeshFormatError {
        self.error(message, AGAIN)
    }

    /// Creates the error of a line that does not contain `what`.
    fn malformed(&self, what: &str) -> MeshFormatError {
        self.damaged(format!("dataset {}: {what} expected in this line", self.dataset))
    }
}
