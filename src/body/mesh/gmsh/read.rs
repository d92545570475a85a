//! Parser of Gmsh files in the format MSH 4.1 (ASCII).

use std::collections::{HashMap, HashSet};
use std::str::FromStr;

use super::lines::Lines;
use super::{ElementKind, GmshError};
use crate::algebra::vector::{dot, minus, norm};
use crate::base::input::FileKind;

/// Elements of one kind on one entity of the geometry.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Block {
    pub kind: ElementKind,
    /// The physical groups of the entity, by name.
    pub groups: Vec<String>,
    /// Gmsh's element number and the nodes, as indices into [`File::nodes`].
    pub elements: Vec<(usize, Vec<usize>)>,
}

/// The content of a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct File {
    /// Coordinates in the file's unit.
    pub nodes: Vec<[f64; 3]>,
    /// Gmsh's number of each node.
    pub numbers: Vec<usize>,
    pub blocks: Vec<Block>,
}

impl File {
    /// Removes the nodes that belong to no element of this `dimension`, such as the centres of arcs, and returns their
    /// number. In elements of lower dimension they are replaced by the coincident used node, if there is one, otherwise
    /// by an index beyond the end.
    pub(super) fn leave_out_unused_nodes(&mut self, dimension: usize) -> usize {
        let mut used = vec![false; self.nodes.len()];
        let cells = self.blocks.iter().filter(|block| block.kind.dimension() == dimension);
        cells.flat_map(|block| &block.elements).flat_map(|(_, nodes)| nodes).for_each(|&node| used[node] = true);
        let kept = used.iter().filter(|used| **used).count();
        let unused = used.len() - kept;
        if unused == 0 {
            return 0;
        }
        let twins = self.twins(&used);
        let (mut next_used, mut next_unused) = (0, kept);
        let mut places: Vec<usize> = used
            .iter()
            .map(|&used| {
                let next = if used { &mut next_used } else { &mut next_unused };
                *next += 1;
                *next - 1
            })
            .collect();
        for (unused, twin) in twins {
            places[unused] = places[twin];
        }
        let mut used_nodes = used.iter();
        self.nodes.retain(|_| used_nodes.next() == Some(&true));
        let mut used_nodes = used.iter();
        self.numbers.retain(|_| used_nodes.next() == Some(&true));
        let nodes = self.blocks.iter_mut().flat_map(|block| &mut block.elements).flat_map(|(_, nodes)| nodes);
        nodes.for_each(|node| *node = places[*node]);
        unused
    }

    /// Returns the nodes that are not `used`, each with the coincident used node; copied curves have such nodes. Places
    /// with nodes of several bodies are ambiguous and left out.
    fn twins(&self, used: &[bool]) -> Vec<(usize, usize)> {
        let bound = |c: usize, pick: fn(f64, f64) -> f64| self.nodes.iter().map(|x| x[c]).reduce(pick).unwrap_or(0.0);
        let size = (0..3).map(|c| bound(c, f64::max) - bound(c, f64::min)).fold(0.0, f64::max);
        let near = SAME_PLACE * size;
        // Along a direction that is not that of a lattice, few nodes have the same coordinate.
        let along = |node: usize| dot(self.nodes[node], [0.742, 0.534, 0.406]);
        let mut order: Vec<(f64, usize)> = (0..used.len()).filter(|&k| used[k]).map(|k| (along(k), k)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let twin = |node: usize| {
            let place = along(node);
            let from = order.partition_point(|(other, _)| *other < place - near);
            let beside = order[from..].iter().take_while(|(other, _)| *other <= place + near);
            let mut there = beside
                .filter(|(_, other)| norm(minus(self.nodes[*other], self.nodes[node])) <= near)
                .map(|(_, other)| *other);
            there.next().filter(|_| there.next().is_none())
        };
        (0..used.len()).filter(|&k| !used[k]).filter_map(|k| Some((k, twin(k)?))).collect()
    }
}

/// The largest distance of coincident nodes, as a share of the size of the mesh. Coordinates are written with about
/// sixteen digits; nine leave room for the errors of the program that made them.
pub(super) const SAME_PLACE: f64 = 1e-9;

/// The sections read so far, in the order required in a file.
#[derive(Default)]
struct SectionsSeen {
    entities: bool,
    nodes: bool,
    elements: bool,
}

type Entity = (usize, i64);

/// Parses `bytes`; messages name the file `name`.
pub(super) fn read(name: &str, bytes: &[u8]) -> Result<File, GmshError> {
    if let Some(kind) = FileKind::of(bytes).filter(|kind| *kind != FileKind::Gmsh) {
        let message = format!("it is {}, but a mesh in the format MSH 4.1 of Gmsh is needed", kind.name());
        return Err(GmshError { file: name.to_string(), line: 1, message, help: kind.as_mesh().to_string() });
    }
    // A binary file is marked as such in its first lines, before the first byte that is not text.
    let text = String::from_utf8_lossy(bytes);
    let mut lines = Lines::new(name, &text);
    format(&mut lines, name)?;
    let (mut file, mut seen) = (File::default(), SectionsSeen::default());
    let mut names = HashMap::new();
    let mut groups: HashMap<Entity, Vec<String>> = HashMap::new();
    let mut indices = HashMap::new();
    while let Some(section) = lines.section()? {
        match section.as_str() {
            "PhysicalNames" => names = physical_names(&mut lines)?,
            "Entities" => {
                groups = entities(&mut lines, &names)?;
                seen.entities = true;
            }
            "Nodes" => {
                indices = nodes(&mut lines, &mut file)?;
                seen.nodes = true;
            }
            "Elements" if !seen.nodes => {
                return Err(lines.error("$Elements comes before $Nodes", "export the mesh again from Gmsh"));
            }
            "Elements" => {
                elements(&mut lines, &groups, &indices, &mut file)?;
                seen.elements = true;
            }
            "PartitionedEntities" => {
                let help = "export the mesh without partitions";
                return Err(lines.error("the mesh is partitioned, which is not supported", help));
            }
            _ => {
                lines.skip_to_end(&section)?;
                continue;
            }
        }
        lines.end(&section)?;
    }
    let missing = [("Entities", seen.entities), ("Nodes", seen.nodes), ("Elements", seen.elements)];
    match missing.into_iter().find(|(_, seen)| !seen) {
        Some((section, _)) => {
            let help = "export the whole mesh in the format MSH 4.1: gmsh -2 part.geo -format msh41 (in space -3), without -save";
            Err(lines.error(format!("the file has no section ${section}"), help))
        }
        None => Ok(file),
    }
}

fn format(lines: &mut Lines<'_>, name: &str) -> Result<(), GmshError> {
    let export = "export the mesh with: gmsh -2 part.geo -format msh41, in space -3 (in Gmsh: File, Export, \"Version 4 ASCII\")";
    let convert = format!("convert the file with: gmsh {name} -save -format msh41 -o new.msh");
    let help = format!("{convert}, or {export}");
    if lines.section()?.as_deref() != Some("MeshFormat") {
        let message = "the file does not begin with $MeshFormat: it is no Gmsh mesh, or one of an older format";
        return Err(lines.error(message, help));
    }
    let line = lines.next("MeshFormat")?;
    let mut words = line.split_whitespace();
    let version = words.next().unwrap_or_default();
    if version != "4.1" {
        return Err(lines.error(format!("the file has the format MSH {version}, but only MSH 4.1 is read"), help));
    }
    if words.next() != Some("0") {
        let help = format!("{convert}, or {export}, with Mesh.Binary = 0");
        return Err(lines.error("the file is binary, but only ASCII is read", help));
    }
    lines.end("MeshFormat")
}

/// Reads the names of the physical groups by dimension and number.
fn physical_names(lines: &mut Lines<'_>) -> Result<HashMap<Entity, String>, GmshError> {
    let section = "PhysicalNames";
    let [count] = lines.numbers(section)?;
    let mut names = HashMap::new();
    for _ in 0..count {
        let line = lines.next(section)?;
        let mut words = line.splitn(3, char::is_whitespace);
        let dimension = words.next().and_then(|word| word.parse().ok());
        let number = words.next().and_then(|word| word.parse().ok());
        let quoted = |word: &'_ str| word.trim().strip_prefix('"')?.strip_suffix('"').map(str::to_string);
        let name = words.next().and_then(quoted);
        let (Some(dimension), Some(number), Some(name)) = (dimension, number, name) else {
            return Err(lines.malformed(section, "a dimension, a number and a name in quotes"));
        };
        names.insert((dimension, number), name);
    }
    Ok(names)
}

/// Reads the physical groups of every entity; the name of a group without one is its number.
fn entities(lines: &mut Lines<'_>, names: &HashMap<Entity, String>) -> Result<HashMap<Entity, Vec<String>>, GmshError> {
    let section = "Entities";
    let counts: [usize; 4] = lines.numbers(section)?;
    let mut groups = HashMap::new();
    for (dimension, count) in counts.into_iter().enumerate() {
        for _ in 0..count {
            let line = lines.next(section)?;
            let words: Vec<&str> = line.split_whitespace().collect();
            // A point has its coordinates, other entities the corners of their bounding box.
            let before = if dimension == 0 { 4 } else { 7 };
            let tag: Option<i64> = word(&words, 0);
            let held: Option<usize> = word(&words, before);
            let physical: Option<Vec<i64>> =
                held.and_then(|held| (0..held).map(|k| word(&words, before + 1 + k)).collect());
            let (Some(tag), Some(physical)) = (tag, physical) else {
                return Err(lines.malformed(section, "an entity with its box and its physical groups"));
            };
            // The sign is an orientation and not part of the number.
            let name = |number: &i64| {
                let number = number.checked_abs().unwrap_or(*number);
                names.get(&(dimension, number)).cloned().unwrap_or_else(|| number.to_string())
            };
            let held: &mut Vec<String> = groups.entry((dimension, tag)).or_default();
            for name in physical.iter().map(name) {
                // Groups of the same name are merged.
                if !held.contains(&name) {
                    held.push(name);
                }
            }
        }
    }
    Ok(groups)
}

fn word<T: FromStr>(words: &[&str], k: usize) -> Option<T> {
    words.get(k)?.parse().ok()
}

/// Reads `$Nodes` into `file` and returns the index of every node by Gmsh's number.
fn nodes(lines: &mut Lines<'_>, file: &mut File) -> Result<HashMap<usize, usize>, GmshError> {
    let section = "Nodes";
    let [blocks, count, _, _] = lines.numbers(section)?;
    let mut indices = HashMap::new();
    for _ in 0..blocks {
        let [_, _, parametric, here] = lines.numbers::<4, i64>(section)?;
        let first = file.numbers.len();
        for _ in 0..here {
            let [number] = lines.numbers(section)?;
            if indices.insert(number, file.numbers.len()).is_some() {
                let help = "export the mesh again from Gmsh";
                return Err(lines.error(format!("the node {number} is there twice"), help));
            }
            file.numbers.push(number);
        }
        for &number in &file.numbers[first..] {
            let line = lines.next(section)?;
            let values: Option<Vec<f64>> = line.split_whitespace().map(|word| word.parse().ok()).collect();
            match values.as_deref() {
                Some(&[x, y, z, ..]) if [x, y, z].iter().all(|c| c.is_finite()) => file.nodes.push([x, y, z]),
                _ => {
                    let more = if parametric == 0 { "" } else { " and parameters" };
                    return Err(lines.malformed(section, &format!("three finite coordinates{more} of node {number}")));
                }
            }
        }
    }
    if file.nodes.len() != count {
        let message = format!("$Nodes announces {count} nodes, but has {}", file.nodes.len());
        return Err(lines.error(message, "export the mesh again from Gmsh"));
    }
    Ok(indices)
}

fn elements(
    lines: &mut Lines<'_>,
    groups: &HashMap<Entity, Vec<String>>,
    indices: &HashMap<usize, usize>,
    file: &mut File,
) -> Result<(), GmshError> {
    let section = "Elements";
    let [blocks, count, _, _] = lines.numbers(section)?;
    let mut read = 0_usize;
    for _ in 0..blocks {
        let [dimension, entity, kind, here] = lines.numbers::<4, i64>(section)?;
        let kind = ElementKind::from_gmsh(kind).map_err(|name| {
            let help = "mesh with triangles or tetrahedra of first or second order (Mesh.ElementOrder = 2), or with quadrilaterals, \
                        hexahedra or prisms of the first";
            lines.error(format!("the mesh has elements of the type {name}, which is not supported"), help)
        })?;
        let groups = groups.get(&(dimension as usize, entity)).cloned().unwrap_or_default();
        let (mut elements, mut listed) = (Vec::new(), HashSet::new());
        for _ in 0..here {
            let text = lines.next(section)?;
            let words: Option<Vec<usize>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
            let Some((&number, nodes)) = words.as_deref().and_then(<[usize]>::split_first) else {
                return Err(lines.malformed(section, "the number of an element and its nodes"));
            };
            if nodes.len() != kind.nodes() {
                let message = format!("element {number} has {} nodes, but a {kind} has {}", nodes.len(), kind.nodes());
                return Err(lines.error(message, "export the mesh again from Gmsh"));
            }
            let found: Result<Vec<usize>, usize> =
                nodes.iter().map(|node| indices.get(node).copied().ok_or(*node)).collect();
            let nodes = found.map_err(|node| {
                let help = "export the mesh again from Gmsh";
                lines.error(format!("element {number} names the node {node}, which $Nodes does not have"), help)
            })?;
            read += 1;
            // The older formats of Gmsh list an element of several groups once for each group, and so do files
            // converted from them.
            let repeated = groups.len() > 1 && {
                let mut key = nodes.clone();
                key.sort_unstable();
                !listed.insert(key)
            };
            if !repeated {
                elements.push((number, nodes));
            }
        }
        file.blocks.push(Block { kind, groups, elements });
    }
    if read != count {
        let message = format!("$Elements announces {count} elements, but has {read}");
        return Err(lines.error(message, "export the mesh again from Gmsh"));
    }
    Ok(())
}
