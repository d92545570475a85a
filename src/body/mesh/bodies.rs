//! The bodies of a mesh, its connected parts, which share no node; and the joining of the meshes of several.

use std::collections::BTreeMap;

use super::Mesh;
use crate::algebra::union_find::UnionFind;
use crate::algebra::vector::{Vector, plus};
use crate::base::input_error::InputError;

/// The body of each node and each cell of a mesh. Bodies are numbered from 0 in the order of their first cells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Bodies {
    names: Vec<String>,
    of_node: Vec<usize>,
    of_cell: Vec<usize>,
}

impl Bodies {
    /// Returns the number of bodies.
    pub fn count(&self) -> usize {
        self.names.len()
    }

    /// Returns `true` if there is more than one body.
    pub fn are_several(&self) -> bool {
        self.count() > 1
    }

    /// Returns the names of the bodies. A name is that of the group of the cells up to a colon; for several groups,
    /// their names joined by `+`. Names that several bodies share are numbered: `disc 1`, `disc 2`.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Returns the name of body `k` for messages: its name if there are several, otherwise "the body".
    pub fn label(&self, k: usize) -> String {
        if self.are_several() { format!("`{}`", self.names[k]) } else { "the body".to_string() }
    }

    /// Returns the body of each node of the mesh.
    pub fn of_nodes(&self) -> &[usize] {
        &self.of_node
    }

    /// Returns the body of each cell of the mesh.
    pub fn of_cells(&self) -> &[usize] {
        &self.of_cell
    }

    /// Returns the nodes of body `k`, ascending.
    pub fn nodes(&self, k: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.of_node.len()).filter(move |&node| self.of_node[node] == k)
    }

    /// Returns the cells of body `k`, ascending.
    pub fn cells(&self, k: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.of_cell.len()).filter(move |&e| self.of_cell[e] == k)
    }
}

impl Mesh {
    /// Finds the bodies of the mesh: the cells connected by their nodes. The mesh must be valid.
    pub fn bodies(&self) -> Bodies {
        let mut pieces = UnionFind::new(self.nodes.len());
        for cell in &self.cells {
            cell.nodes.windows(2).for_each(|pair| pieces.join(pair[0], pair[1]));
        }
        let mut numbers: Vec<Option<usize>> = vec![None; self.nodes.len()];
        let mut groups: Vec<Vec<usize>> = Vec::new();
        let mut of_cell = Vec::with_capacity(self.cells.len());
        for cell in &self.cells {
            let body = *numbers[pieces.least(cell.nodes[0])].get_or_insert_with(|| {
                groups.push(Vec::new());
                groups.len() - 1
            });
            if !groups[body].contains(&cell.group) {
                groups[body].push(cell.group);
            }
            of_cell.push(body);
        }
        let of_node = (0..self.nodes.len()).map(|node| numbers[pieces.least(node)].unwrap_or(0)).collect();
        let names =
            groups.iter().map(|groups| named(groups.iter().map(|&group| self.groups[group].as_str()).collect()));
        Bodies { names: numbered(&names.collect::<Vec<_>>()), of_node, of_cell }
    }

    /// Finds pairs of coincident nodes of different `bodies` of this mesh: each node with the next one at its place.
    /// Such pairs are correct if bodies touch; if the bodies should be one, their meshes were not joined.
    pub fn touching_nodes(&self, bodies: &Bodies) -> Vec<(usize, usize)> {
        let of = bodies.of_nodes();
        if !bodies.are_several() {
            return Vec::new();
        }
        self.pairs_in(&self.in_order(), self.near(), |a, b| of[a] != of[b])
    }
}

/// Returns the name of a body whose cells are in `groups`; cells without a group have a group without a name.
fn named(groups: Vec<&str>) -> String {
    let body = |group: &&str| group.split(':').next().unwrap_or_default().to_string();
    let whole = |name: &str| if name.is_empty() { "body".to_string() } else { name.to_string() };
    match groups.first().map(body) {
        Some(first) if groups.iter().all(|group| body(group) == first) => whole(&first),
        _ => groups.into_iter().map(whole).collect::<Vec<_>>().join("+"),
    }
}

/// Numbers the names that occur several times.
fn numbered(names: &[String]) -> Vec<String> {
    let mut counts: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for name in names {
        counts.entry(name).or_default().0 += 1;
    }
    let number = |name: &String| match counts.get_mut(name.as_str()) {
        Some((2.., count)) => {
            *count += 1;
            format!("{name} {count}")
        }
        _ => name.clone(),
    };
    names.iter().map(number).collect()
}

/// Adds the name of the body `name` to the boundaries and groups of `mesh` and moves its origin to `at` (m).
pub(super) fn of_body(mut mesh: Mesh, name: &str, at: Option<Vector>) -> Mesh {
    if let Some(at) = at {
        mesh.nodes.iter_mut().for_each(|x| *x = plus(*x, 1.0, at.components()));
    }
    let is_default = matches!(&mesh.groups[..], [one] if one == "body");
    for group in &mut mesh.groups {
        *group = if is_default || group.is_empty() { name.to_string() } else { format!("{name}:{group}") };
    }
    for boundary in &mut mesh.boundaries {
        boundary.name = format!("{name}:{}", boundary.name);
    }
    mesh.notes = mesh.notes.of_body(name);
    mesh
}

/// Appends the body `name` with this `mesh` to `all`.
pub(super) fn append(all: &mut Mesh, name: &str, mut mesh: Mesh) -> Result<(), InputError> {
    let differs = |what: &str, help: &str| InputError::new("mesh", format!("the mesh of `{name}` {what}"), help);
    if mesh.dimension != all.dimension {
        let what = format!("has {} dimensions, those before it have {}", mesh.dimension, all.dimension);
        return Err(differs(&what, "let all bodies be plane, or all have a volume"));
    }
    if mesh.geometry != all.geometry {
        let what = "is the section of a body of revolution and those before it are not, or the other way round";
        return Err(differs(what, "let all meshes be sections, or none"));
    }
    let (first, group) = (all.nodes.len(), all.groups.len());
    for cell in &mut mesh.cells {
        cell.nodes.iter_mut().for_each(|node| *node += first);
        cell.group += group;
    }
    let facets = mesh.boundaries.iter_mut().flat_map(|boundary| &mut boundary.facets);
    facets.flatten().for_each(|node| *node += first);
    all.nodes.extend(mesh.nodes);
    all.cells.extend(mesh.cells);
    all.groups.extend(mesh.groups);
    all.boundaries.extend(mesh.boundaries);
    all.notes.append(mesh.notes);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{named, numbered};

    #[test]
    fn bodies_are_called_by_their_groups() {
        assert_eq!(named(vec!["upper"]), "upper");
        assert_eq!(named(vec!["upper:a", "upper:b"]), "upper");
        assert_eq!(named(vec!["upper", "upper:b"]), "upper");
        assert_eq!(named(vec!["steel", "rubber"]), "steel+rubber");
        assert_eq!(named(vec!["", "rubber"]), "body+rubber");
        assert_eq!(named(vec![""]), "body");
        let names = ["disc", "plate", "disc"].map(str::to_string);
        assert_eq!(numbered(&names), ["disc 1", "plate", "disc 2"]);
    }
}
