//! The elements of Gmsh files.

use std::collections::{HashMap, HashSet};

use super::reader::{Fields, Reader};
use super::{Entity, Version, announced, name_of};
use crate::body::mesh::file::MeshFormatError;
use crate::body::mesh::file::raw::{Block, ElementKind, RawMesh};
use crate::body::mesh::{CellKind, sorted};

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
fn supported(reader: &Reader<'_>, number: i64) -> Result<ElementKind, MeshFormatError> {
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
) -> Result<Vec<usize>, MeshFormatError> {
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
pub(super) fn of_entities(
    reader: &mut Reader<'_>,
    version: Version,
    groups: &HashMap<Entity, Vec<String>>,
    indices: &HashMap<usize, usize>,
    file: &mut RawMesh,
) -> Result<(), MeshFormatError> {
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
                row.rest(1 + kind.nodes(), Fields::size).filter(|all| !all.is_empty())
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
pub(super) fn tagged(
    reader: &mut Reader<'_>,
    names: &HashMap<Entity, String>,
    indices: &HashMap<usize, usize>,
    file: &mut RawMesh,
) -> Result<(), MeshFormatError> {
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
                Some((number, kind, tags, row.rest(needed, Fields::short)?))
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
