//! Meshes from arrays of nodes, cells and named facets.

use std::collections::HashSet;

use super::boundaries::Outline;
use super::check::Numbers;
use super::sides::from_least;
use super::{Boundary, Cell, Geometry, Mesh, MeshFault, Notes};

impl Mesh {
    /// Creates a mesh of `nodes` (m; z = 0 in two dimensions) and `cells`, whose kind determines the dimension.
    ///
    /// `groups` are the names of the material groups, to which the group numbers of cells refer; if it is empty, there
    /// is one group `body`. Facets of `boundaries` may have any orientation and order: they are oriented with their
    /// outside on the right and, in two dimensions, ordered consecutively.
    ///
    /// # Errors
    /// The first fault found, with all cells or nodes concerned, counted from 0.
    ///
    /// ```
    /// use stickslip::body::mesh::{Boundary, Cell, CellKind, Mesh};
    ///
    /// let nodes = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let cells = vec![Cell { kind: CellKind::Triangle, nodes: vec![0, 1, 2], group: 0 }];
    /// let foot = Boundary { name: "foot".into(), facets: vec![vec![1, 0]] };
    /// let mesh = Mesh::new(nodes, cells, Vec::new(), vec![foot])?;
    /// assert_eq!(mesh.boundary("foot").unwrap().facets, [[0, 1]]);
    /// # Ok::<(), stickslip::body::mesh::MeshFault>(())
    /// ```
    pub fn new(
        nodes: Vec<[f64; 3]>,
        cells: Vec<Cell>,
        groups: Vec<String>,
        boundaries: Vec<Boundary>,
    ) -> Result<Self, MeshFault> {
        let dimension = cells.first().ok_or(MeshFault::Empty)?.kind.dimension();
        let groups = if groups.is_empty() { vec!["body".to_string()] } else { groups };
        let mut mesh = Mesh {
            dimension,
            geometry: Geometry::Cartesian,
            nodes,
            cells,
            groups,
            boundaries: Vec::new(),
            notes: Notes::default(),
        };
        mesh.check_indices()?;
        let all: Vec<usize> = (0..mesh.nodes.len().max(mesh.cells.len())).collect();
        mesh.check_cells(&Numbers { cells: &all, nodes: &all })?;
        let outline = Outline::new(&mesh.cells);
        for Boundary { name, facets } in boundaries {
            let facets: Vec<_> = facets.into_iter().enumerate().collect();
            mesh.boundaries.push(outline.boundary(&name, &facets)?);
        }
        mesh.check_names()?;
        Ok(mesh)
    }

    /// Checks that every cell has the dimension of the mesh and refers to existing nodes and an existing group.
    pub(super) fn check_indices(&self) -> Result<(), MeshFault> {
        if self.cells.is_empty() {
            return Err(MeshFault::Empty);
        }
        let those = |bad: &dyn Fn(&[f64; 3]) -> bool| -> Vec<usize> {
            (0..self.nodes.len()).filter(|&k| bad(&self.nodes[k])).collect()
        };
        let not_finite = those(&|x| x.iter().any(|c| !c.is_finite()));
        if !not_finite.is_empty() {
            return Err(MeshFault::NotFinite(not_finite));
        }
        let lifted = those(&|x| self.dimension == 2 && x[2] != 0.0);
        if !lifted.is_empty() {
            return Err(MeshFault::OutOfPlane(lifted));
        }
        self.check_section()?;
        let (nodes, groups) = (self.nodes.len(), self.groups.len());
        for (element, Cell { kind, nodes: own, group }) in self.cells.iter().enumerate() {
            if kind.dimension() != self.dimension {
                return Err(MeshFault::Dimensions { element, cell: kind.dimension(), mesh: self.dimension });
            }
            if own.len() != kind.nodes() {
                return Err(MeshFault::Corners { element, given: own.len(), needed: kind.nodes() });
            }
            if let Some(&node) = own.iter().find(|&&node| node >= nodes) {
                return Err(MeshFault::NoNode { element, node, nodes });
            }
            if *group >= groups {
                return Err(MeshFault::NoGroup { element, group: *group, groups });
            }
        }
        Ok(())
    }

    /// Checks that every boundary consists of outer facets, each once and with its outside on the right.
    pub(super) fn check_boundaries(&self) -> Result<(), MeshFault> {
        self.check_names()?;
        let outline = Outline::new(&self.cells);
        for Boundary { name, facets } in &self.boundaries {
            let numbered: Vec<_> = facets.iter().cloned().enumerate().collect();
            let sound: HashSet<_> = outline.boundary(name, &numbered)?.facets.into_iter().map(from_least).collect();
            if let Some(element) = facets.iter().position(|facet| !sound.contains(&from_least(facet.clone()))) {
                return Err(MeshFault::TurnedFacet { boundary: name.clone(), element });
            }
        }
        Ok(())
    }

    fn check_names(&self) -> Result<(), MeshFault> {
        let mut known = HashSet::new();
        let mut names = self.boundaries.iter().map(|boundary| &boundary.name);
        names.find(|name| !known.insert(*name)).map_or(Ok(()), |name| Err(MeshFault::RepeatedName(name.clone())))
    }
}
