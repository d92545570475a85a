//! Parser of Gmsh files: MSH 2.2 and 4.1, text and binary, and MSH 4.0, text.
//!
//! The name of a physical group without one is its number. The formats: Gmsh reference manual, "MSH file format" and
//! "Legacy formats".

mod reader;

use std::collections::{HashMap, HashSet};

use super::raw::{Block, ElementKind, RawMesh};
use super::{Parsed, expect};
use crate::base::input::FileKind;
use crate::body::mesh::{CellKind, sorted};
use reader::{Fields, Reader};

/// The versions that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Version {
    V22,
    V40,
    V41,
}

/// The dimension and the number of a physical group or of an entity of the geometry.
type Entity = (usize, i64);

/// The sections read so far.
#[derive(Default)]
struct SectionsSeen {
    entities: bool,
    nodes: bool,
    elements: bool,
}

/// Parses `bytes`; messages name the file `name`.
pub(super) fn read(name: &str, bytes: &[u8]) -> Parsed<RawMesh> {
    expect(name, bytes, FileKind::Gmsh)?;
    let mut reader = Reader::new(name, bytes);
    let version = format(&mut reader, name)?;
    let (mut file, mut seen) = (RawMesh::default(), SectionsSeen::default());
    let mut names = HashMap::new();
    let mut groups: HashMap<Entity, Vec<String>> = HashMap::new();
    let mut indices = HashMap::new();
    while let Some(section) = reader.section()? {
        match (section.as_str(), version) {
            ("PhysicalNames", _) => names = physical_names(&mut reader)?,
            ("Entities", Version::V40 | Version::V41) => {
                entities(&mut reader, &section, version, &names, &mut groups)?;
                seen.entities = true;
            }
            ("PartitionedEntities", Version::V41) => entities(&mut reader, &section, version, &names, &mut groups)?,
            ("PartitionedEntities", Version::V40) => {
                let help =
                    "convert the file with: gmsh OLD -save -format msh41 -o NEW.msh, or export it without partitions";
                return Err(reader.error("the mesh is partitioned, which is read in MSH 2.2 and 4.1 only", help));
            }
            ("Nodes" | "ParametricNodes", Version::V22) => {
                indices = numbered_nodes(&mut reader, &section, &mut file)?;
                seen.nodes = true;
            }
            ("Nodes", _) => {
                indices = nodes(&mut reader, version, &mut file)?;
                seen.nodes = true;
            }
            ("Elements", _) if !seen.nodes => return Err(reader.damaged("$Elements comes before $Nodes")),
            ("Elements", _) => {
                match version {
                    Version::V22 => tagged(&mut reader, &names, &indices, &mut file)?,
                    _ => of_entities(&mut reader, version, &groups, &indices, &mut file)?,
                }
                seen.elements = true;
            }
            _ => {
                reader.skip_to_end(&section)?;
                continue;
            }
        }
        reader.end(&section)?;
    }
    let entities = seen.entities || version == Version::V22;
    let missing = [("Entities", entities), ("Nodes", seen.nodes), ("Elements", seen.elements)];
    match missing.into_iter().find(|(_, seen)| !seen) {
        Some((section, _)) => {
            let help = "export the whole mesh: gmsh -2 part.geo -format msh41 (in space -3), without -save";
            Err(reader.error(format!("the file has no section ${section}"), help))
        }
        None => Ok(file),
    }
}

/// Reads `$MeshFormat`.
fn format(reader: &mut Reader<'_>, name: &str) -> Parsed<Version> {
    let export = "export the mesh with: gmsh -2 part.geo -format msh41, in space -3 (in Gmsh: File, Export, \"Version 4 ASCII\")";
    let help = format!("convert the file with: gmsh {name} -save -format msh41 -o new.msh, or {export}");
    let section = "MeshFormat";
    let mut next = reader.section()?;
    while next.as_deref() == Some("Comments") {
        reader.skip_to_end("Comments")?;
        next = reader.section()?;
    }
    if next.as_deref() != Some(section) {
        let message = "the file does not begin with $MeshFormat: it is no Gmsh mesh, or one of an older format";
        return Err(reader.error(message, help));
    }
    let line = reader.next(section)?;
    let words: Vec<&str> = line.split_whitespace().collect();
    let [number, kind, size] = [0, 1, 2].map(|k| words.get(k).copied().unwrap_or_default());
    let version = match (number, kind) {
        ("2.2", "0" | "1") => Version::V22,
        ("4" | "4.0", "0") => Version::V40,
        ("4.1", "0" | "1") => Version::V41,
        ("4" | "4.0", "1") => {
            return Err(reader.error("the file has the format MSH 4.0, binary, which is read as text only", help));
        }
        ("2.2" | "4" | "4.0" | "4.1", _) => {
            return Err(reader.malformed(section, "a version, 0 for text or 1 for binary, and a size"));
        }
        _ => {
            let message = format!("the file has the format MSH {number}, but only MSH 2.2, 4.0 and 4.1 are read");
            return Err(reader.error(message, help));
        }
    };
    if kind == "1" {
        if size != "8" {
            return Err(reader.error(format!("the numbers of the file have {size} bytes, but only 8 are read"), help));
        }
        match reader.four_bytes() {
            Some([1, 0, 0, 0]) => reader.binary = true,
            Some([0, 0, 0, 1]) => {
                return Err(reader.error("the file is binary and big-endian, but only little-endian is read", help));
            }
            _ => return Err(reader.error("the file is binary, but has no mark of the order of bytes", help)),
        }
    }
    reader.end(section)?;
    Ok(version)
}

/// Reads the names of the physical groups by dimension and number.
fn physical_names(reader: &mut Reader<'_>) -> Parsed<HashMap<Entity, String>> {
    let section = "PhysicalNames";
    let count = reader.text_row(section, "1 whole number", |row| row.size().and_then(|count| row.last(count)))?;
    let mut names = HashMap::new();
    for _ in 0..count {
        let line = reader.next(section)?;
        let mut words = line.splitn(3, char::is_whitespace);
        let dimension = words.next().and_then(|word| word.parse().ok());
        let number = words.next().and_then(|word| word.parse().ok());
        // Gmsh fills the names of a MED file up with spaces.
        let quoted = |word: &'_ str| Some(word.trim().strip_prefix('"')?.strip_suffix('"')?.trim().to_string());
        let name = words.next().and_then(quoted);
        let (Some(dimension), Some(number), Some(name)) = (dimension, number, name) else {
            return Err(reader.malformed(section, "a dimension, a number and a name in quotes"));
        };
        names.insert((dimension, number), name);
    }
    Ok(names)
}

/// Returns the name of a physical group; without one, its number. The sign is an orientation and not part of the number.
fn name_of(names: &HashMap<Entity, String>, dimension: usize, number: i64) -> String {
    let number = number.checked_abs().unwrap_or(number);
    names.get(&(dimension, number)).cloned().unwrap_or_else(|| number.to_string())
}

/// Reads the physical groups of every entity in `$Entities` or `$PartitionedEntities` into `groups`.
fn entities(
    reader: &mut Reader<'_>,
    section: &str,
    version: Version,
    names: &HashMap<Entity, String>,
    groups: &mut HashMap<Entity, Vec<String>>,
) -> Parsed<()> {
    let partitioned = section == "PartitionedEntities";
    if partitioned {
        reader.count(section)?;
        for _ in 0..reader.count(section)? {
            reader.row(section, "2 whole numbers", |row| row.list(2, Fields::int))?;
        }
    }
    let counts = reader.row(section, "4 whole numbers", |row| {
        let counts = row.list(4, Fields::size)?;
        row.last(counts)
    })?;
    for (dimension, count) in counts.into_iter().enumerate() {
        for _ in 0..count {
            let (tag, physical) = reader.row(section, "an entity with its box and its physical groups", |row| {
                let tag = row.int()?;
                if partitioned {
                    row.list(2, Fields::int)?;
                    let partitions = row.size()?;
                    row.list(partitions, Fields::int)?;
                }
                // In MSH 4.1 a point has its coordinates, other entities the corners of their bounding box.
                row.doubles::<3>()?;
                if dimension > 0 || version == Version::V40 {
                    row.doubles::<3>()?;
                }
                let count = row.size()?;
                let physical = row.list(count, Fields::int)?;
                if dimension > 0 && row.is_binary() {
                    let count = row.size()?;
                    row.list(count, Fields::int)?;
                }
                Some((tag, physical))
            })?;
            let of_tag: &mut Vec<String> = groups.entry((dimension, tag)).or_default();
            for name in physical.iter().map(|&number| name_of(names, dimension, number)) {
                // Groups of the same name are merged.
                if !of_tag.contains(&name) {
                    of_tag.push(name);
                }
            }
        }
    }
    Ok(())
}

/// Adds the node `number` to `file`.
fn add_node(reader: &Reader<'_>, file: &mut RawMesh, indices: &mut HashMap<usize, usize>, number: usize) -> Parsed<()> {
    if indices.insert(number, file.numbers.len()).is_some() {
        return Err(reader.damaged(format!("the node {number} is there twice")));
    }
    file.numbers.push(number);
    Ok(())
}

const COORDINATES: &str = "the number of a node and three finite coordinates";

/// Reads `$Nodes` of MSH 4 into `file` and returns the index of every node by Gmsh's number.
fn nodes(reader: &mut Reader<'_>, version: Version, file: &mut RawMesh) -> Parsed<HashMap<usize, usize>> {
    let section = "Nodes";
    let (blocks, count) = reader.counts(section, version)?;

    let mut indices = HashMap::new();
    for _ in 0..blocks {
        let (entity, parametric, here) = reader.row(section, "4 whole numbers", |row| {
            let (first, second, parametric, here) = (row.int()?, row.int()?, row.int()?, row.size()?);
            row.last((if version == Version::V41 { first } else { second }, parametric, here))
        })?;
        if version == Version::V40 {
            for _ in 0..here {
                let (number, x) = reader.row(section, COORDINATES, |row| Some((row.short()?, row.doubles()?)))?;
                add_node(reader, file, &mut indices, number)?;
                file.nodes.push(x);
            }
            continue;
        }
        let first = file.numbers.len();
        for _ in 0..here {
            let number = reader.count(section)?;
            add_node(reader, file, &mut indices, number)?;
        }
        let parameters = if parametric == 0 { 0 } else { usize::try_from(entity.clamp(0, 3)).unwrap_or(0) };
        for k in first..file.numbers.len() {
            let read = reader.row(section, "three finite coordinates", |row| {
                let x = row.doubles()?;
                if row.is_binary() {
                    row.list(parameters, Fields::doubles::<1>)?;
                }
                Some(x)
            });
            match read {
                Ok(x) => file.nodes.push(x),
                Err(mut error) => {
                    error.message =
                        error.message.replace("coordinates", &format!("coordinates of node {}", file.numbers[k]));
                    return Err(error);
                }
            }
        }
    }
    announced(reader, section, "nodes", count, file.nodes.len())?;
    Ok(indices)
}

/// Reads `$Nodes` or `$ParametricNodes` of MSH 2.2 into `file` and returns the index of every node by Gmsh's number.
fn numbered_nodes(reader: &mut Reader<'_>, section: &str, file: &mut RawMesh) -> Parsed<HashMap<usize, usize>> {
    let count = reader.text_row(section, "1 whole number", |row| row.size().and_then(|count| row.last(count)))?;
    let parametric = section == "ParametricNodes";
    let mut indices = HashMap::new();
    for _ in 0..count {
        let (number, x) = reader.row(section, COORDINATES, |row| {
            let (number, x) = (row.short()?, row.doubles()?);
            if parametric && row.is_binary() {
                // The dimension and the number of the entity; nodes of curves and surfaces have parameters.
                let (dimension, _) = (row.int()?, row.int()?);
                let parameters = if dimension == 1 || dimension == 2 { dimension as usize } else { 0 };
                row.list(parameters, Fields::doubles::<1>)?;
            }
            Some((number, x))
        })?;
        add_node(reader, file, &mut indices, number)?;
        file.nodes.push(x);
    }
    Ok(indices)
}

/// Fails unless a section has as many `things` as it announces.
fn announced(reader: &Reader<'_>, section: &str, things: &str, count: usize, read: usize) -> Parsed<()> {
    if read == count {
        return Ok(());
    }
    Err(reader.damaged(format!("${section} announces {count} {things}, but has {read}")))
}

const SECTION: &str = "Elements";

/// Returns the kind for Gmsh's number of the type. The error is the name of an unsupported type.
fn kind_of(number: i64) -> Result<ElementKind, String> {
    Ok(match number {
        15 => ElementKind::Point,
        1 => ElementKind::Line,
        8 => ElementKind::Line3,
        _ => match (CellKind::ALL.into_iter().find(|kind| kind.properties().gmsh == number), number) {
            (Some(kind), _) => ElementKind::Cell(kind),
            (None, 7) => return Err("7 (pyramid)".to_string()),
            (None, 12) => return Err("12 (hexahedron of 27 nodes)".to_string()),
            (None, 13) => return Err("13 (prism of 18 nodes)".to_string()),
            (None, 14 | 19) => return Err(format!("{number} (pyramid of second order)")),
            (None, 20..) => return Err(format!("{number} (third order or higher)")),
            _ => return Err(number.to_string()),
        },
    })
}

/// Returns the kind of Gmsh's type `number`, or the error at the place of the reader.
fn supported(reader: &Reader<'_>, number: i64) -> Parsed<ElementKind> {
    kind_of(number).map_err(|name| {
        let help = match number {
            12 | 13 => "mesh with nodes at the middles of edges alone (Mesh.SecondOrderIncomplete = 1)",
            _ => {
                "mesh with triangles, quadrilaterals, tetrahedra, hexahedra or prisms of first or second order (Mesh.ElementOrder = 2, \
                 Mesh.SecondOrderIncomplete = 1)"
            }
        };
        reader.error(format!("the mesh has elements of the type {name}, which is not supported"), help)
    })
}

/// Converts Gmsh's `nodes` of an element to indices in the order of [`CellKind`].
fn placed(
    reader: &Reader<'_>,
    kind: ElementKind,
    number: usize,
    nodes: &[usize],
    indices: &HashMap<usize, usize>,
) -> Parsed<Vec<usize>> {
    if nodes.len() != kind.nodes() {
        let message = format!("element {number} has {} nodes, but a {kind} has {}", nodes.len(), kind.nodes());
        return Err(reader.damaged(message));
    }
    let found = |node: &usize| {
        let absent = || reader.damaged(format!("element {number} names the node {node}, which $Nodes does not have"));
        indices.get(node).copied().ok_or_else(absent)
    };
    match kind {
        ElementKind::Cell(kind) => kind.properties().gmsh_order.iter().map(|&place| found(&nodes[place])).collect(),
        _ => nodes.iter().map(found).collect(),
    }
}

/// Reads `$Elements` of MSH 4, where entities of the geometry belong to physical `groups`.
fn of_entities(
    reader: &mut Reader<'_>,
    version: Version,
    groups: &HashMap<Entity, Vec<String>>,
    indices: &HashMap<usize, usize>,
    file: &mut RawMesh,
) -> Parsed<()> {
    let (blocks, count) = reader.counts(SECTION, version)?;

    let mut read = 0_usize;
    for _ in 0..blocks {
        let (first, second, kind, here) = reader.row(SECTION, "4 whole numbers", |row| {
            let header = (row.int()?, row.int()?, row.int()?, row.size()?);
            row.last(header)
        })?;
        let (dimension, entity) = if version == Version::V41 { (first, second) } else { (second, first) };
        let kind = supported(reader, kind)?;
        let dimension = usize::try_from(dimension).unwrap_or(usize::MAX);
        let groups = groups.get(&(dimension, entity)).cloned().unwrap_or_default();
        let (mut elements, mut listed) = (Vec::new(), HashSet::new());
        for _ in 0..here {
            let all = reader.row(SECTION, "the number of an element and its nodes", |row| {
                row.read_all(1 + kind.nodes(), Fields::size).filter(|all| !all.is_empty())
            })?;
            let nodes = placed(reader, kind, all[0], &all[1..], indices)?;
            read += 1;
            // The older formats of Gmsh list an element of several groups once for each group, and so do files
            // converted from them.
            if groups.len() < 2 || listed.insert(sorted(&nodes)) {
                elements.push((all[0], nodes));
            }
        }
        file.blocks.push(Block { kind, groups, elements });
    }
    announced(reader, SECTION, "elements", count, read)
}

/// An element of MSH 2.2.
struct Tagged {
    kind: ElementKind,
    number: usize,
    nodes: Vec<usize>,
    /// The numbers of its physical groups.
    physical: Vec<i64>,
}

/// The elements of MSH 2.2 read so far.
#[derive(Default)]
struct TaggedElements {
    all: Vec<Tagged>,
    /// The first element of each kind with the same nodes.
    first: HashMap<(ElementKind, Vec<usize>), usize>,
}

impl TaggedElements {
    /// Adds an element. An element of several groups is listed once for each of them.
    fn add(&mut self, element: Tagged) {
        match self.first.entry((element.kind, sorted(&element.nodes))) {
            std::collections::hash_map::Entry::Vacant(place) => {
                place.insert(self.all.len());
                self.all.push(element);
            }
            std::collections::hash_map::Entry::Occupied(place) => {
                let known = &mut self.all[*place.get()].physical;
                match element.physical[..] {
                    [group] if !known.is_empty() && !known.contains(&group) => known.push(group),
                    _ => self.all.push(element),
                }
            }
        }
    }

    /// Divides the elements into blocks of one kind and the same groups.
    fn blocks(self, names: &HashMap<Entity, String>) -> Vec<Block> {
        let (mut blocks, mut last) = (Vec::<Block>::new(), None);
        for Tagged { kind, number, nodes, physical } in self.all {
            let key = (kind, physical);
            if last.as_ref() != Some(&key) {
                let mut groups: Vec<String> = Vec::new();
                for name in key.1.iter().map(|&number| name_of(names, kind.dimension(), number)) {
                    if !groups.contains(&name) {
                        groups.push(name);
                    }
                }
                blocks.push(Block { kind, groups, elements: Vec::new() });
                last = Some(key);
            }
            if let Some(block) = blocks.last_mut() {
                block.elements.push((number, nodes));
            }
        }
        blocks
    }
}

/// Reads `$Elements` of MSH 2.2, where each element has tags: its physical group, its entity, and partitions.
fn tagged(
    reader: &mut Reader<'_>,
    names: &HashMap<Entity, String>,
    indices: &HashMap<usize, usize>,
    file: &mut RawMesh,
) -> Parsed<()> {
    let count = reader.text_row(SECTION, "1 whole number", |row| row.size().and_then(|count| row.last(count)))?;
    let mut elements = TaggedElements::default();
    let mut read = 0_usize;
    while read < count {
        // In a binary file, elements of one type have a common header.
        let header = if reader.binary {
            Some(reader.row(SECTION, "3 whole numbers", |row| Some((row.int()?, row.short()?, row.short()?)))?)
        } else {
            None
        };
        for _ in 0..header.map_or(1, |(_, here, _)| here) {
            let (number, kind, tags, nodes) = reader.row(SECTION, "an element with its tags and nodes", |row| {
                let number = row.short()?;
                let (kind, tags) = match header {
                    Some((kind, _, tags)) => (kind, tags),
                    None => (row.int()?, row.short()?),
                };
                let tags = row.list(tags, Fields::int)?;
                let needed = kind_of(kind).map_or(0, ElementKind::nodes);
                Some((number, kind, tags, row.read_all(needed, Fields::short)?))
            })?;
            let kind = supported(reader, kind)?;
            let nodes = placed(reader, kind, number, &nodes, indices)?;
            // The sign is an orientation; 0 is no group.
            let physical = tags.first().filter(|group| **group != 0).map(|group| group.checked_abs().unwrap_or(*group));
            elements.add(Tagged { kind, number, nodes, physical: physical.into_iter().collect() });
            read += 1;
        }
    }
    file.blocks.extend(elements.blocks(names));
    announced(reader, SECTION, "elements", count, read)
}
