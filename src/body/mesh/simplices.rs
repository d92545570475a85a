//! Structured meshes of triangles, tetrahedra and prisms.

use std::collections::HashSet;

use super::sides::from_least;
use super::{Cell, CellKind, Facet, Mesh};

/// The six tetrahedra of a hexahedron around its diagonal from corner 0 to corner 6 (Kuhn), one for each order of the
/// three axes.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 2, 6], [0, 5, 1, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 4, 5, 6], [0, 7, 4, 6]];

impl Mesh {
    /// Divides each quadrilateral into two triangles, each hexahedron into six tetrahedra and each quadrilateral facet
    /// into two triangles.
    ///
    /// Cells and facets are divided along the diagonals at their node with the least number, so that neighbours match
    /// in a structured mesh whose node numbers grow along every axis, such as [`super::block`].
    #[must_use]
    pub fn into_simplices(mut self) -> Mesh {
        self.cells = self.cells.iter().flat_map(divided).collect();
        for boundary in &mut self.boundaries {
            boundary.facets = boundary.facets.iter().flat_map(|facet| triangles(facet)).collect();
        }
        self
    }

    /// Divides each hexahedron into two prisms by a plane through the diagonals from corner 0 to 2 and from 4 to 6, and
    /// the facets at the ends of the prisms accordingly.
    #[must_use]
    pub fn into_prisms(mut self) -> Mesh {
        const HALVES: [[usize; 6]; 2] = [[0, 1, 2, 4, 5, 6], [0, 2, 3, 4, 6, 7]];
        let halves = |cell: &Cell| match cell.kind {
            CellKind::Hexahedron => HALVES
                .map(|half| Cell { kind: CellKind::Prism, nodes: half.map(|k| cell.nodes[k]).to_vec(), ..cell.clone() })
                .to_vec(),
            _ => vec![cell.clone()],
        };
        self.cells = self.cells.iter().flat_map(halves).collect();
        let sides: HashSet<Facet> = self.cells.iter().flat_map(Cell::facets).map(from_least).collect();
        let parts = |facet: &Facet| {
            let whole = sides.contains(&from_least(facet.clone()));
            if whole { vec![facet.clone()] } else { triangles(facet) }
        };
        for boundary in &mut self.boundaries {
            boundary.facets = boundary.facets.iter().flat_map(parts).collect();
        }
        self
    }
}

fn divided(cell: &Cell) -> Vec<Cell> {
    let (kind, parts): (_, Vec<Vec<usize>>) = match cell.kind {
        CellKind::Quadrilateral => (CellKind::Triangle, triangles(&cell.nodes)),
        CellKind::Hexahedron => {
            (CellKind::Tetrahedron, TETRAHEDRA.iter().map(|part| part.map(|a| cell.nodes[a]).to_vec()).collect())
        }
        other => (other, vec![cell.nodes.clone()]),
    };
    parts.into_iter().map(|nodes| Cell { kind, nodes, group: cell.group }).collect()
}

/// Divides a quadrilateral into two triangles; facets with fewer corners are not changed.
fn triangles(corners: &[usize]) -> Vec<Facet> {
    if corners.len() != 4 {
        return vec![corners.to_vec()];
    }
    let first = (0..4).min_by_key(|&a| corners[a]).unwrap_or(0);
    let corner = |a: usize| corners[(first + a) % 4];
    vec![vec![corner(0), corner(1), corner(2)], vec![corner(0), corner(2), corner(3)]]
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use crate::body::mesh::block;

    /// Every face belongs to two tetrahedra, or to one and a boundary.
    #[test]
    fn tetrahedra_match() {
        let mesh = block(&[1.0, 1.0, 1.0], &[3, 2, 2]).into_simplices();
        assert_eq!(mesh.cells.len(), 6 * 12);
        let mut faces: HashMap<Vec<usize>, usize> = HashMap::new();
        let mut count = |face: Vec<usize>| {
            let mut face = face;
            face.sort_unstable();
            *faces.entry(face).or_default() += 1;
        };
        for cell in &mesh.cells {
            for left_out in 0..4 {
                count((0..4).filter(|&a| a != left_out).map(|a| cell.nodes[a]).collect());
            }
        }
        mesh.boundaries.iter().flat_map(|b| &b.facets).for_each(|facet| count(facet.clone()));
        assert!(faces.values().all(|&n| n == 2));
    }
}
