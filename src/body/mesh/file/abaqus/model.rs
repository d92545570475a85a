//! The nodes, elements, sets and surfaces of an input file, and their conversion to groups.

use std::collections::{HashMap, HashSet};

use super::{Data, Keyword};
use crate::body::mesh::file::raw::{Element, ElementKind, RawMesh, add_boundary, no_side, outer, real, within};
use crate::body::mesh::file::{MeshFormatError, Parsed, Place};
use crate::body::mesh::sides::sorted;
use crate::body::mesh::{CellKind, Facet};

/// Sides of elements by their number from 0, or all outer sides of the elements.
type Sides = (Vec<Span>, Option<usize>);

/// A name with sides of elements: the elements and the numbers of the sides.
type Named = (String, Vec<(usize, usize)>);

/// The contents of an input file up to the last keyword.
#[derive(Default)]
pub(super) struct Model {
    mesh: RawMesh,
    nodes: HashMap<usize, usize>,
    node_sets: Sets,
    elements: Vec<Element>,
    element_indices: HashMap<usize, usize>,
    element_sets: Sets,
    surfaces: Vec<(String, Vec<Sides>)>,
    /// The ELSETs of `*SOLID SECTION`, each with the error that tells its place.
    sections: Vec<(String, MeshFormatError)>,
    /// Keywords that are no mesh.
    aside: Vec<String>,
    /// Types of elements that choose a formulation.
    variants: Vec<String>,
    /// The number of fields of data.
    fields: usize,
}

const TYPES: &str = "only solid elements are read: remove the others from the file, or mesh with CPE, CPS or CAX of 3, 4, 6 or 8 \
                     nodes, or with C3D4, C3D6, C3D8, C3D10, C3D15 or C3D20";

impl Model {
    /// Takes a keyword with its data.
    pub(super) fn read(&mut self, keyword: &Keyword<'_>, data: &[Data<'_>]) -> Parsed<()> {
        self.fields += data.iter().map(|row| row.fields.len()).sum::<usize>();
        match keyword.name.as_str() {
            "NODE" => self.take_nodes(keyword, data),
            "ELEMENT" => self.take_elements(keyword, data),
            "NSET" => self.take_node_set(keyword, data),
            "ELSET" => {
                complete(keyword)?;
                self.element_sets.define(&keyword.needed("ELSET")?, keyword, data, most(self.fields))
            }
            "SURFACE" => self.take_surface(keyword, data),
            "SOLID SECTION" | "SOLIDSECTION" => {
                let name = keyword.needed("ELSET")?;
                let message = format!("*SOLID SECTION names the ELSET `{name}`, which is not there");
                self.sections.push((name, keyword.error(message, "define the set, or correct its name")));
                Ok(())
            }
            "PART" | "INSTANCE" | "ASSEMBLY" => Err(keyword.error(
                format!("*{}: parts and assemblies are not read", keyword.name),
                "write the file without them: in Abaqus/CAE, Model, Edit Attributes, tick \"Do not use parts and assemblies in \
                 input files\"",
            )),
            "NGEN" | "NFILL" | "NCOPY" | "NMAP" | "ELGEN" | "ELCOPY" | "SYSTEM" => Err(keyword.error(
                format!("*{}: generated nodes and elements, and systems of coordinates, are not read", keyword.name),
                "write all nodes in rectangular coordinates with *NODE, and all elements with *ELEMENT",
            )),
            "HEADING" | "END STEP" => Ok(()),
            name => {
                if !self.aside.iter().any(|known| known == name) {
                    self.aside.push(name.to_string());
                }
                Ok(())
            }
        }
    }

    fn take_nodes(&mut self, keyword: &Keyword<'_>, data: &[Data<'_>]) -> Parsed<()> {
        complete(keyword)?;
        if keyword.value("SYSTEM").is_some_and(|system| !system.eq_ignore_ascii_case("R")) {
            return Err(keyword.error("*NODE has no rectangular coordinates", "write them without SYSTEM="));
        }
        let set = keyword.set("NSET");
        for row in data {
            let number = row.fields.first().and_then(|field| field.parse().ok());
            let coordinates = [1, 2, 3]
                .map(|k| row.fields.get(k).filter(|field| !field.is_empty()).map_or(Some(0.0), |field| real(field)));
            let (Some(number), [Some(x), Some(y), Some(z)]) = (number, coordinates) else {
                let help = "write a line such as 1, 0.5, 2.5, 0.";
                return Err(keyword.error_at(
                    row,
                    "*NODE: a number and finite coordinates expected in this line",
                    help,
                ));
            };
            match self.nodes.get(&number) {
                Some(&known) if self.mesh.nodes[known] == [x, y, z] => {}
                Some(_) => {
                    let message = format!("the node {number} is there twice, in two places");
                    return Err(keyword.error_at(row, message, "give each node a number of its own"));
                }
                None => {
                    self.nodes.insert(number, self.mesh.nodes.len());
                    self.mesh.nodes.push([x, y, z]);
                    self.mesh.numbers.push(number);
                }
            }
            if let Some(set) = &set {
                self.node_sets.add(set, [Span::one(number)]);
            }
        }
        Ok(())
    }

    fn take_elements(&mut self, keyword: &Keyword<'_>, data: &[Data<'_>]) -> Parsed<()> {
        complete(keyword)?;
        let name = keyword.needed("TYPE")?;
        let Some(kind) = kind_of(&name) else {
            return Err(keyword.error(format!("elements of the type {name} are not supported"), TYPES));
        };
        if is_variant(&name) && !self.variants.contains(&name) {
            self.variants.push(name);
        }
        let set = keyword.set("ELSET");
        let mut rows = data.iter();
        while let Some(row) = rows.next() {
            let damaged = |message: String| {
                let help = "give in a line the number of an element and its nodes, 9 and more also in several lines; TYPE= says how \
                            many it has";
                keyword.error_at(row, message, help)
            };
            let mut fields = row.words();
            let Some(first) = fields.next() else { continue };
            let Ok(number) = first.parse::<usize>() else {
                return Err(damaged(format!(
                    "*ELEMENT: the number of an element was expected, but there is `{first}`"
                )));
            };
            let mut words: Vec<&str> = fields.collect();
            // Rows follow until the element is complete.
            while words.len() < kind.nodes() {
                let Some(more) = rows.next() else { break };
                words.extend(more.words());
            }
            if words.len() != kind.nodes() {
                let message = format!("element {number} has {} nodes, but a {kind} has {}", words.len(), kind.nodes());
                return Err(damaged(message));
            }
            let mut nodes = Vec::with_capacity(kind.nodes());
            for word in words {
                let node = word.parse().ok().and_then(|node: usize| self.nodes.get(&node));
                let absent =
                    || damaged(format!("element {number} names the node {word}, which no *NODE before it has"));
                nodes.push(*node.ok_or_else(absent)?);
            }
            if self.element_indices.insert(number, self.elements.len()).is_some() {
                return Err(damaged(format!("the element {number} is there twice")));
            }
            self.elements.push(Element { number, kind, nodes });
            if let Some(set) = &set {
                self.element_sets.add(set, [Span::one(number)]);
            }
        }
        Ok(())
    }

    fn take_node_set(&mut self, keyword: &Keyword<'_>, data: &[Data<'_>]) -> Parsed<()> {
        complete(keyword)?;
        let name = keyword.needed("NSET")?;
        let Some(of) = keyword.set("ELSET") else {
            return self.node_sets.define(&name, keyword, data, most(self.fields));
        };
        if !self.element_sets.has(&of) {
            let message = format!("*NSET names the ELSET `{of}`, which is not defined before");
            return Err(keyword.error(message, "define the set first, or correct its name"));
        }
        let elements = self.element_sets.indices(&of, &self.element_indices);
        let nodes: HashSet<usize> = elements.iter().flat_map(|&e| self.elements[e].nodes.iter().copied()).collect();
        self.node_sets.add(&name, nodes.into_iter().map(|node| Span::one(self.mesh.numbers[node])));
        self.limited(keyword, self.node_sets.size)
    }

    fn take_surface(&mut self, keyword: &Keyword<'_>, data: &[Data<'_>]) -> Parsed<()> {
        complete(keyword)?;
        let name = keyword.needed("NAME")?;
        match keyword.set("TYPE").as_deref() {
            None | Some("ELEMENT") if keyword.value("COMBINE").is_none() => {}
            Some("NODE") => {
                // The second field is an area.
                let first = data.iter().map(|row| (row.line, row.fields.iter().take(1).copied().collect()));
                let data: Vec<Data<'_>> = first.map(|(line, fields)| Data { line, fields }).collect();
                return self.node_sets.define(&name, keyword, &data, most(self.fields));
            }
            _ => {
                self.aside.push(format!("SURFACE, NAME={name}"));
                return Ok(());
            }
        }
        let mut sides = Vec::new();
        for row in data {
            let which = row.fields.first().copied().unwrap_or_default();
            let Some(members) = self.element_sets.members(which) else {
                let message = format!("`{which}` is neither an element nor an ELSET that is defined before");
                return Err(keyword.error_at(row, message, "define the set first, or correct its name"));
            };
            let side = row.fields.get(1).copied().unwrap_or_default();
            let number = match side.strip_prefix(['S', 's']) {
                Some(digits) => {
                    digits.parse().ok().filter(|side| (1..=6).contains(side)).map(|side: usize| Some(side - 1))
                }
                None if side.is_empty() => Some(None),
                None => None,
            };
            let Some(number) = number else {
                let message = format!("`{side}` is no side of an element");
                return Err(keyword.error_at(row, message, "name a side, S1 to S6, or none for all outer sides"));
            };
            sides.push((members, number));
        }
        self.surfaces.push((name, sides));
        self.limited(keyword, self.surfaces.iter().flat_map(|(_, sides)| sides).map(|(spans, _)| spans.len()).sum())
    }

    /// Fails if sets that repeat one another have more members than the file justifies.
    fn limited(&self, keyword: &Keyword<'_>, size: usize) -> Parsed<()> {
        if size <= most(self.fields) { Ok(()) } else { Err(too_many(keyword)) }
    }

    /// Converts all that was taken to a mesh; messages name the file `name`.
    pub(super) fn finish(mut self, name: &str) -> Parsed<RawMesh> {
        for (section, error) in &self.sections {
            let elements = self.element_sets.indices(section, &self.element_indices);
            if elements.into_iter().any(|e| self.elements[e].kind.dimension() == 1) {
                let message = "*SOLID SECTION makes trusses of elements that would be lines of a boundary".to_string();
                return Err(MeshFormatError { message, help: TYPES.to_string(), ..error.clone() });
            }
            if !self.element_sets.has(section) {
                return Err(error.clone());
            }
        }
        let dimension = self.elements.iter().map(|element| element.kind.dimension()).max().unwrap_or(0);
        let many = || MeshFormatError {
            file: name.to_string(),
            place: Place::Line(1),
            message: "the sets of the file have names and members that are far longer than the file".to_string(),
            help: "define fewer sets, or give them shorter names".to_string(),
        };
        self.remark();
        let mut left = most(self.fields) + 16 * self.elements.len();
        let groups = self.groups(dimension, &mut left).ok_or_else(many)?;
        for (element, groups) in self.elements.iter().zip(groups) {
            self.mesh.add(element.kind, groups, (element.number, element.nodes.clone()));
        }
        let boundaries = self.boundaries(dimension, &mut left).ok_or_else(many)?;
        for (name, sides) in boundaries {
            add_boundary(&mut self.mesh, &self.elements, &name, &sides);
        }
        Ok(self.mesh)
    }

    /// Remarks on what is left aside.
    fn remark(&mut self) {
        if !self.aside.is_empty() {
            let all: Vec<String> = self.aside.iter().map(|name| format!("*{name}")).collect();
            self.mesh.remarks.push(format!("left aside, as no part of the mesh: {}", all.join("; ")));
        }
        if !self.variants.is_empty() {
            let all = self.variants.join(", ");
            self.mesh.remarks.push(format!("of the elements {all} the nodes are read; `element` chooses the strains"));
        }
    }

    /// Returns the names of the groups of each element: the sets of `*SOLID SECTION` or, without any, all sets; for
    /// plane elements beside solid ones all sets. `None` if there are more than are `left`, where a long name counts
    /// several times: each element has a copy of it.
    fn groups(&self, dimension: usize, left: &mut usize) -> Option<Vec<Vec<String>>> {
        let sections: HashSet<&str> = self.sections.iter().map(|(name, _)| name.as_str()).collect();
        let mut groups = vec![Vec::new(); self.elements.len()];
        for name in &self.element_sets.names {
            let of_section = sections.is_empty() || sections.contains(name.as_str());
            for e in self.element_sets.indices(name, &self.element_indices) {
                if of_section || self.elements[e].kind.dimension() < dimension {
                    *left = left.checked_sub(1 + name.len() / 16)?;
                    groups[e].push(name.clone());
                }
            }
        }
        Some(groups)
    }

    /// Returns the sides of each boundary as elements and numbers of sides, each once, and remarks on the node sets that
    /// are none. `None` if there are more than are `left`.
    fn boundaries(&mut self, dimension: usize, left: &mut usize) -> Option<Vec<Named>> {
        let outer = outer(&self.elements, dimension);
        let mut boundaries: Vec<Named> = Vec::new();
        let mut index_of = HashMap::new();
        let mut add = |name: &str, found: Vec<(usize, usize)>| {
            *left = left.checked_sub(found.len())?;
            let k = *index_of.entry(name.to_string()).or_insert_with(|| {
                boundaries.push((name.to_string(), Vec::new()));
                boundaries.len() - 1
            });
            boundaries[k].1.extend(found);
            Some(())
        };
        for (name, sides) in &self.surfaces {
            for (spans, side) in sides {
                let elements = present(spans, &self.element_indices).into_iter();
                let found = if let Some(side) = side {
                    let has = |&e: &usize| {
                        let kind = self.elements[e].kind;
                        kind.dimension() == dimension && *side < kind.sides().len()
                    };
                    elements.filter(has).map(|e| (e, *side)).collect()
                } else {
                    let elements: HashSet<usize> = elements.collect();
                    outer.iter().copied().filter(|(e, _)| elements.contains(e)).collect()
                };
                add(name, found)?;
            }
        }
        let mut points = Vec::new();
        for name in &self.node_sets.names {
            let nodes = self.node_sets.indices(name, &self.nodes);
            let found = within(&self.elements, &outer, &nodes);
            if found.is_empty() {
                points.push(no_side(&self.mesh, dimension, name, &nodes));
            } else {
                add(name, found)?;
            }
        }
        for (name, sides) in &mut boundaries {
            // An element of a lower dimension in the ELSET of this name is the same side.
            let skin = self.element_sets.indices(name, &self.element_indices).into_iter();
            let mut known: HashSet<Facet> = skin.map(|e| sorted(&self.elements[e].nodes)).collect();
            sides.retain(|&(e, k)| {
                let Element { kind, nodes, .. } = &self.elements[e];
                known.insert(sorted(&kind.sides()[k].iter().map(|&k| nodes[k]).collect::<Vec<_>>()))
            });
        }
        self.mesh.remarks.extend(points);
        Some(boundaries)
    }
}

/// The largest number of members of sets for a file with so many `fields`.
fn most(fields: usize) -> usize {
    1000 + 16 * fields
}

/// Fails if the data are in another file, or belong to an instance of a part.
fn complete(keyword: &Keyword<'_>) -> Parsed<()> {
    let name = &keyword.name;
    if keyword.value("INPUT").is_some() {
        let help = format!(
            "write the keyword without INPUT=, and after it *INCLUDE, INPUT=FILE; or let the file begin with *{name}"
        );
        return Err(keyword.error(format!("*{name}, INPUT= is not read"), help));
    }
    if keyword.value("INSTANCE").is_some() {
        let help = "write the file without parts: in Abaqus/CAE, Model, Edit Attributes, tick \"Do not use parts and assemblies in \
                    input files\"";
        return Err(keyword.error(format!("*{name}, INSTANCE= is not read"), help));
    }
    Ok(())
}

/// Returns the kind of elements of Abaqus's type `name`; `None` if it is not supported. Abaqus and
/// [`CellKind`] have the same orders of nodes and of sides. Gmsh writes lines as trusses.
fn kind_of(name: &str) -> Option<ElementKind> {
    match name {
        "T2D2" | "T3D2" => return Some(ElementKind::Line),
        "T2D3" | "T3D3" => return Some(ElementKind::Line3),
        _ => {}
    }
    let (solid, rest) = match name.strip_prefix("C3D") {
        Some(rest) => (true, rest),
        None => (false, ["CPE", "CPS", "CAX"].iter().find_map(|family| name.strip_prefix(family))?),
    };
    let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
    let (nodes, variant) = rest.split_at(digits);
    // Reduced, hybrid, incompatible modes, modified, thermal, and improved surface stress.
    if !variant.bytes().all(|letter| b"RHIMTS".contains(&letter)) {
        return None;
    }
    Some(ElementKind::Cell(match (solid, nodes) {
        (false, "3") => CellKind::Triangle,
        (false, "4") => CellKind::Quadrilateral,
        (false, "6") => CellKind::Triangle6,
        (false, "8") => CellKind::Quadrilateral8,
        (true, "4") => CellKind::Tetrahedron,
        (true, "6") => CellKind::Prism,
        (true, "8") => CellKind::Hexahedron,
        (true, "10") => CellKind::Tetrahedron10,
        (true, "15") => CellKind::Prism15,
        (true, "20") => CellKind::Hexahedron20,
        _ => return None,
    }))
}

/// Returns `true` for a type whose last letters choose a formulation, such as CPE4R.
fn is_variant(name: &str) -> bool {
    name.ends_with(|last: char| last.is_ascii_alphabetic())
}

/// The numbers `first`, `first + step`, ... up to `last`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Span {
    first: usize,
    last: usize,
    step: usize,
}

impl Span {
    fn one(number: usize) -> Self {
        Span { first: number, last: number, step: 1 }
    }

    fn contains(&self, number: usize) -> bool {
        (self.first..=self.last).contains(&number) && (number - self.first).is_multiple_of(self.step)
    }
}

/// Sets of numbers by name. A set of many numbers may be one [`Span`].
#[derive(Default)]
struct Sets {
    /// The names in the order of the file.
    pub names: Vec<String>,
    spans: HashMap<String, Vec<Span>>,
    /// The number of spans of all sets.
    size: usize,
}

impl Sets {
    /// Adds members to the set `name`.
    fn add(&mut self, name: &str, members: impl IntoIterator<Item = Span>) {
        if !self.spans.contains_key(name) {
            self.names.push(name.to_string());
        }
        let spans = self.spans.entry(name.to_string()).or_default();
        let before = spans.len();
        spans.extend(members);
        self.size += spans.len() - before;
    }

    fn has(&self, name: &str) -> bool {
        self.spans.contains_key(name)
    }

    /// Adds the data of `*NSET` or `*ELSET` to the set `name`: numbers and names of sets, or with GENERATE first and last
    /// number and increment. There may be `most` members of all sets.
    fn define(&mut self, name: &str, keyword: &Keyword<'_>, data: &[Data<'_>], most: usize) -> Parsed<()> {
        let mut members = Vec::new();
        for row in data {
            let fields = row.words();
            if keyword.value("GENERATE").is_some() {
                let numbers: Option<Vec<usize>> = fields.map(|field| field.parse().ok()).collect();
                members.push(match numbers.as_deref() {
                    Some(&[first, last]) => Span { first, last, step: 1 },
                    Some(&[first, last, step]) if step > 0 => Span { first, last, step },
                    _ => {
                        let help = "give first number, last number, increment, such as 1, 9, 2";
                        return Err(keyword.error_at(row, "GENERATE needs two or three whole numbers", help));
                    }
                });
                continue;
            }
            for field in fields {
                members.extend(self.members(field).ok_or_else(|| {
                    let message = format!("`{field}` is neither a number nor a set that is defined before");
                    keyword.error_at(row, message, "define the set first, or correct its name")
                })?);
                if members.len() > most {
                    return Err(too_many(keyword));
                }
            }
        }
        members.sort_unstable();
        members.dedup();
        self.add(name, members);
        // Sets that name one another could otherwise grow without bound.
        if self.size > most { Err(too_many(keyword)) } else { Ok(()) }
    }

    /// Returns the members of a set, or the number itself, of a `field`; `None` if it is neither.
    fn members(&self, field: &str) -> Option<Vec<Span>> {
        match field.parse() {
            Ok(number) => Some(vec![Span::one(number)]),
            Err(_) => self.spans.get(&field.trim_matches('"').to_uppercase()).cloned(),
        }
    }

    /// Returns the indices of all members of the set `name` that `indices` has, in increasing order of numbers.
    fn indices(&self, name: &str, indices: &HashMap<usize, usize>) -> Vec<usize> {
        present(self.spans.get(name).map_or(&[], Vec::as_slice), indices)
    }
}

/// Returns the indices of all numbers in `spans` that `indices` has, each once, in increasing order of numbers.
fn present(spans: &[Span], indices: &HashMap<usize, usize>) -> Vec<usize> {
    let mut found: Vec<(usize, usize)> = Vec::new();
    for span in spans {
        let count = span.last.saturating_sub(span.first) / span.step;
        if span.first > span.last {
            continue;
        }
        if count < indices.len() {
            let numbers = (0..=count).map(|k| span.first + k * span.step);
            found.extend(numbers.filter_map(|number| Some((number, *indices.get(&number)?))));
        } else {
            found.extend(indices.iter().filter(|(number, _)| span.contains(**number)).map(|(a, b)| (*a, *b)));
        }
        if found.len() > 2 * indices.len() {
            found.sort_unstable();
            found.dedup();
        }
    }
    found.sort_unstable();
    found.dedup();
    found.into_iter().map(|(_, index)| index).collect()
}

fn too_many(keyword: &Keyword<'_>) -> MeshFormatError {
    keyword
        .error("the sets repeat one another: they have far more members than the file has numbers", "define fewer sets")
}
