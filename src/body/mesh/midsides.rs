//! Cells and facets of second order, with nodes at the middles of edges.

use std::collections::HashMap;

use super::{Cell, CellKind, Facet, Mesh};

impl Mesh {
    /// Returns `true` if there are nodes between the corners of a facet of this mesh.
    pub fn is_quadratic(&self, facet: &[usize]) -> bool {
        if self.dimension == 2 { facet.len() == 3 } else { matches!(facet.len(), 6 | 8) }
    }

    /// Returns the edges of a facet with a node between their ends: one end, that node, the other end.
    pub fn bent_edges(&self, facet: &[usize]) -> Vec<[usize; 3]> {
        let places = if self.is_quadratic(facet) { 1..facet.len() } else { 0..0 };
        places.step_by(2).map(|k| [facet[k - 1], facet[k], facet[(k + 1) % facet.len()]]).collect()
    }

    /// Returns the share α of each end of an edge in the node between them, `w_m = (1 - 2 α) w̃_m + α (w̃_a + w̃_b)`: the
    /// least for which the functions of [`crate::body::fem::bernstein`] are nowhere negative on the facet.
    pub fn share_of_ends(&self, facet: &[usize]) -> f64 {
        if facet.len() == 8 { 0.375 } else { 0.25 }
    }

    /// Divides a facet between its nodes: an edge of three nodes into two edges, a triangle of six nodes into four
    /// triangles, a quadrilateral of eight nodes into four triangles and a quadrilateral. Other facets are not changed.
    pub fn pieces_of(&self, facet: &[usize]) -> Vec<Facet> {
        match (self.is_quadratic(facet), facet) {
            (true, &[a, b, c]) => vec![vec![a, b], vec![b, c]],
            (true, &[a, ab, b, bc, c, ca]) => {
                vec![vec![a, ab, ca], vec![ab, b, bc], vec![bc, c, ca], vec![ab, bc, ca]]
            }
            (true, &[a, ab, b, bc, c, cd, d, da]) => {
                vec![vec![a, ab, da], vec![ab, b, bc], vec![bc, c, cd], vec![cd, d, da], vec![ab, bc, cd, da]]
            }
            _ => vec![facet.to_vec()],
        }
    }

    /// Adds a node at the middle of each edge, so that all cells are of second order with straight edges.
    #[must_use]
    pub fn into_second_order(self) -> Mesh {
        self.with_middles(CellKind::of_second_order)
    }

    /// Adds a node at the middle of each edge and at the centre of each quadrilateral, which has nine nodes then.
    #[must_use]
    pub(super) fn with_centres(self) -> Mesh {
        self.with_middles(|kind| match kind {
            CellKind::Quadrilateral => Some(CellKind::Quadrilateral9),
            other => other.of_second_order(),
        })
    }

    /// Adds the nodes that cells of the kind `of` have beyond those of their own kind.
    fn with_middles(mut self, of: impl Fn(CellKind) -> Option<CellKind>) -> Mesh {
        let mut middles = HashMap::<[usize; 2], usize>::new();
        for cell in &mut self.cells {
            let Some(kind) = of(cell.kind) else { continue };
            for edge in kind.properties().edges {
                let [a, b] = edge.map(|k| cell.nodes[k]);
                let middle = *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                    let (x, y) = (self.nodes[a], self.nodes[b]);
                    self.nodes.push([0, 1, 2].map(|c| 0.5 * (x[c] + y[c])));
                    self.nodes.len() - 1
                });
                cell.nodes.push(middle);
            }
            for around in kind.properties().around {
                let mean = |c: usize| around.iter().map(|&k| self.nodes[cell.nodes[k]][c]).sum::<f64>();
                let centre = [0, 1, 2].map(|c| mean(c) / around.len() as f64);
                self.nodes.push(centre);
                cell.nodes.push(self.nodes.len() - 1);
            }
            cell.kind = kind;
        }
        let around = |facet: &Facet| -> Facet {
            let edges = if self.dimension == 2 { facet.len() - 1 } else { facet.len() };
            let middle = |k: usize| {
                let (a, b) = (facet[k], facet[(k + 1) % facet.len()]);
                middles.get(&[a.min(b), a.max(b)]).copied().filter(|_| k < edges)
            };
            (0..facet.len()).flat_map(|k| [Some(facet[k]), middle(k)]).flatten().collect()
        };
        for boundary in &mut self.boundaries {
            boundary.facets = boundary.facets.iter().map(around).collect();
        }
        self
    }
}

impl Cell {
    /// Reverses the orientation of the nodes, which changes the sign of the volume.
    pub(super) fn turn_over(&mut self) {
        self.nodes = self.kind.properties().mirrored.iter().map(|&k| self.nodes[k]).collect();
    }
}

#[cfg(test)]
mod tests {
    use crate::body::mesh::block;

    /// Every facet of a boundary is a side of its cell with the same orientation.
    #[test]
    fn sides_and_boundaries_agree() {
        let (plane, space) = (block(&[2.0, 1.0], &[3, 2]), block(&[2.0, 1.0, 1.5], &[3, 2, 2]));
        let (corners, bricks) = ([plane.nodes.len(), space.nodes.len()], 7 * 5 * 5 - 12 - 36 - 16);
        for (mesh, nodes) in [
            (plane.clone().into_simplices().into_second_order(), 7 * 5),
            (plane.clone().into_second_order(), 7 * 5 - 6),
            (plane.with_centres(), 7 * 5),
            (space.clone().into_simplices().into_second_order(), 7 * 5 * 5),
            (space.clone().into_prisms().into_second_order(), bricks + 18),
            (space.into_second_order(), bricks),
        ] {
            let (corners, d) = (corners[mesh.dimension - 2], mesh.dimension);
            mesh.check().unwrap();
            assert_eq!(mesh.nodes.len(), nodes);
            for facet in mesh.boundaries.iter().flat_map(|boundary| &boundary.facets) {
                assert!(mesh.is_quadratic(facet));
                let edges = mesh.bent_edges(facet);
                assert_eq!(edges.len(), if d == 2 { 1 } else { facet.len() / 2 });
                for [a, m, b] in edges {
                    assert!(a < corners && b < corners && m >= corners);
                    let middle = [0, 1, 2].map(|c| 0.5 * (mesh.nodes[a][c] + mesh.nodes[b][c]));
                    assert_eq!(mesh.nodes[m], middle);
                }
                let pieces: [f64; 3] = mesh.pieces_of(facet).iter().fold([0.0; 3], |sum, piece| {
                    let area = mesh.area_vector(piece);
                    [0, 1, 2].map(|c| sum[c] + area[c])
                });
                let whole = mesh.area_vector(facet);
                assert!((0..3).all(|c| (pieces[c] - whole[c]).abs() < 1e-15), "{pieces:?} {whole:?}");
            }
        }
    }

    /// A plane mesh with the wrong orientation is valid after its cells are turned over.
    #[test]
    fn cells_are_turned_over_with_their_edges() {
        let (plane, space) = (block(&[2.0, 1.0], &[2, 2]), block(&[2.0, 1.0, 1.0], &[2, 2, 1]));
        for mut mesh in [
            plane.clone().into_simplices().into_second_order(),
            plane.clone().into_second_order(),
            plane.with_centres(),
            space.clone().into_simplices().into_second_order(),
            space.clone().into_prisms().into_second_order(),
            space.into_second_order(),
        ] {
            mesh.nodes.iter_mut().for_each(|x| x[0] = -x[0]);
            assert!(mesh.check_indices().is_ok() && mesh.check().is_err());
            mesh.cells.iter_mut().for_each(super::Cell::turn_over);
            mesh.boundaries.clear();
            mesh.check().unwrap();
        }
    }

    /// The area vector of a curved face with straight edges is that of the flat face; otherwise Simpson's rule applies.
    #[test]
    fn area_vectors_of_curved_facets() {
        let cube = block(&[1.0, 1.0, 1.0], &[1, 1, 1]);
        for mut mesh in [cube.clone().into_simplices().into_second_order(), cube.into_second_order()] {
            let facet = mesh.boundary("top").unwrap().facets[0].clone();
            // The curved edge from a to b bulges by 0.1 aside: a parabola, whose segment has the area 2/3 · 0.1 · |b - a|.
            let [a, m, b] = mesh.bent_edges(&facet)[0];
            let (x, y) = (mesh.nodes[a], mesh.nodes[b]);
            let along = [y[0] - x[0], y[1] - x[1]];
            let length = along[0].hypot(along[1]);
            let flat = mesh.area_vector(&facet)[2];
            mesh.nodes[m][0] += 0.1 * along[1] / length;
            mesh.nodes[m][1] -= 0.1 * along[0] / length;
            assert!((mesh.area_vector(&facet)[2] - flat - 0.2 / 3.0 * length).abs() < 1e-15);
        }
    }
}
