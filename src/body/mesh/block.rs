//! Structured meshes of a rectangle, a box or a half-plane, and their division into triangles, tetrahedra and prisms.

use std::collections::HashSet;

use super::sides::from_least;
use super::{Boundary, Cell, CellKind, Facet, Geometry, Mesh, Notes};

/// Creates a rectangle or box of `size` (m, two or three lengths) with its lowest corner at the origin, divided into
/// `elements` equal quadrilaterals or hexahedra along each axis.
///
/// Boundaries: `left` and `right` are at the ends of x. In two dimensions `bottom` and `top` are at the
/// ends of y; in three they are at the ends of z, and `front` and `back` at those of y.
pub fn block<const D: usize>(size: &[f64; D], elements: &[usize; D]) -> Mesh {
    const { assert!(D == 2 || D == 3, "a block has two or three axes") };
    let axis = |k: usize| progression(size[k], elements[k], 1.0);
    graded_block(&axis(0), &axis(1), (D == 3).then(|| axis(2)).as_deref())
}

/// Creates a mesh like [`block`] with the mesh lines at the ascending coordinates (m) of each axis.
pub(super) fn graded_block(xs: &[f64], ys: &[f64], zs: Option<&[f64]>) -> Mesh {
    zs.map_or_else(|| rectangle(xs, ys), |zs| cuboid(xs, ys, zs))
}

/// Computes the ends of `n` lengths in geometric progression that fill `length`, the last `ratio` times the first:
/// `x_i = length (q^i - 1) / (q^n - 1)` with `q = ratio^(1 / (n - 1))`.
pub(super) fn progression(length: f64, n: usize, ratio: f64) -> Vec<f64> {
    // Both fractions are exact at both ends, so that the sides are exactly straight.
    if ratio == 1.0 || n == 1 {
        return (0..=n).map(|i| length * i as f64 / n as f64).collect();
    }
    let log = ratio.ln() / (n - 1) as f64;
    // exp_m1 keeps the digits of q^i - 1 for q close to 1.
    (0..=n).map(|i| length * ((log * i as f64).exp_m1() / (log * n as f64).exp_m1())).collect()
}

/// Creates the mesh of the products of the ascending coordinates `xs` and `ys`.
pub(super) fn rectangle(xs: &[f64], ys: &[f64]) -> Mesh {
    let (nx, ny) = (xs.len() - 1, ys.len() - 1);
    let node = |i: usize, j: usize| j * (nx + 1) + i;
    let nodes = ys.iter().flat_map(|&y| xs.iter().map(move |&x| [x, y, 0.0])).collect();
    let quad = |i, j| vec![node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
    let cells = (0..ny).flat_map(|j| (0..nx).map(move |i| quad(i, j)));
    let boundaries = vec![
        side("bottom", (0..nx).map(|i| vec![node(i, 0), node(i + 1, 0)]).collect()),
        side("right", (0..ny).map(|j| vec![node(nx, j), node(nx, j + 1)]).collect()),
        side("top", (0..nx).rev().map(|i| vec![node(i + 1, ny), node(i, ny)]).collect()),
        side("left", (0..ny).rev().map(|j| vec![node(0, j + 1), node(0, j)]).collect()),
    ];
    uniform(2, nodes, CellKind::Quadrilateral, cells, boundaries)
}

/// Creates the mesh of the products of the ascending coordinates `xs`, `ys` and `zs`.
fn cuboid(xs: &[f64], ys: &[f64], zs: &[f64]) -> Mesh {
    let (nx, ny, nz) = (xs.len() - 1, ys.len() - 1, zs.len() - 1);
    let node = |i: usize, j: usize, k: usize| (k * (ny + 1) + j) * (nx + 1) + i;
    let layer = |&z: &f64| ys.iter().flat_map(move |&y| xs.iter().map(move |&x| [x, y, z])).collect::<Vec<_>>();
    let nodes = zs.iter().flat_map(layer).collect();
    let around = |i, j, k| [node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k), node(i, j + 1, k)];
    let brick = |i, j, k| [around(i, j, k), around(i, j, k + 1)].concat();
    let cells = (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| brick(i, j, k))));
    // `at(a, b)` is a node of a side; a and b are numbered along it so that a × b points outwards.
    let face = |name: &str, n: [usize; 2], at: &dyn Fn(usize, usize) -> usize| {
        let quad = |a, b| vec![at(a, b), at(a + 1, b), at(a + 1, b + 1), at(a, b + 1)];
        side(name, (0..n[1]).flat_map(|b| (0..n[0]).map(move |a| quad(a, b))).collect())
    };
    let boundaries = vec![
        face("bottom", [ny, nx], &|a, b| node(b, a, 0)),
        face("top", [nx, ny], &|a, b| node(a, b, nz)),
        face("left", [nz, ny], &|a, b| node(0, b, a)),
        face("right", [ny, nz], &|a, b| node(nx, a, b)),
        face("front", [nx, nz], &|a, b| node(a, 0, b)),
        face("back", [nz, nx], &|a, b| node(b, ny, a)),
    ];
    uniform(3, nodes, CellKind::Hexahedron, cells, boundaries)
}

fn side(name: &str, facets: Vec<Facet>) -> Boundary {
    Boundary { name: name.into(), facets }
}

fn uniform(
    dimension: usize,
    nodes: Vec<[f64; 3]>,
    kind: CellKind,
    cells: impl Iterator<Item = Vec<usize>>,
    boundaries: Vec<Boundary>,
) -> Mesh {
    let cells = cells.map(|nodes| Cell { kind, nodes, group: 0 }).collect();
    Mesh {
        dimension,
        geometry: Geometry::Cartesian,
        nodes,
        cells,
        groups: vec!["body".into()],
        boundaries,
        notes: Notes::default(),
    }
}

/// Creates a rectangle of `size` (m) with its lower left corner at the origin, for contact at the left end of its top:
/// `contact_elements` equal columns over the first `contact_width` (m), `outer_elements` equal columns over the rest,
/// and `layers` in geometric progression downwards from elements that are square in the contact zone. Boundaries
/// `bottom`, `right`, `top` (without the contact zone), `contact` and `left`.
pub(super) fn half_plane(
    size: [f64; 2],
    contact_width: f64,
    contact_elements: usize,
    outer_elements: usize,
    layers: usize,
) -> Mesh {
    let [width, height] = size;
    let inner = (0..contact_elements).map(|i| contact_width * i as f64 / contact_elements as f64);
    let rest = width - contact_width;
    let outer = (0..=outer_elements).map(|i| contact_width + rest * i as f64 / outer_elements as f64);
    let xs: Vec<f64> = inner.chain(outer).collect();
    let depths = graded(height, layers, contact_width / contact_elements as f64);
    let ys: Vec<f64> = depths.iter().rev().map(|depth| height - depth).collect();

    let mut mesh = rectangle(&xs, &ys);
    if let Some(top) = mesh.boundaries.iter_mut().find(|boundary| boundary.name == "top") {
        // The top runs from right to left, so that the contact zone is its end.
        let facets = top.facets.split_off(outer_elements);
        // Contact nodes are numbered from the symmetry plane; each edge keeps its direction.
        mesh.boundaries.push(Boundary { name: "contact".into(), facets: facets.into_iter().rev().collect() });
    }
    mesh
}

/// Computes depths from 0 to `height` of `layers` layers in geometric progression with the first thickness `first`; the
/// layers are equal if `first` alone would fill the height.
fn graded(height: f64, layers: usize, first: f64) -> Vec<f64> {
    let sum = |q: f64| (0..layers).fold(0.0, |sum, k| sum + first * q.powi(k as i32));
    // The ratio follows by bisection: the sum grows with it, and a ratio of height / first is too large.
    let (mut low, mut high) = (1e-3, 1.0 + height / first);
    while high - low > f64::EPSILON * high {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if sum(middle) < height { low = middle } else { high = middle }
    }
    let ratio = if layers as f64 * first >= height { 1.0 } else { high };
    let mut depths = vec![0.0];
    let mut depth = 0.0;
    for k in 0..layers {
        depth += ratio.powi(k as i32);
        depths.push(depth);
    }
    depths.iter().map(|d| height * (d / depth)).collect()
}

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

    use super::*;
    use crate::algebra::vector::dot;

    #[test]
    fn boundaries_run_around_the_body() {
        let mesh = block(&[2.0, 1.0], &[3, 2]);
        assert_eq!((mesh.nodes.len(), mesh.cells.len()), (12, 6));
        assert_eq!(mesh.boundary("bottom").unwrap().nodes(), [0, 1, 2, 3]);
        assert_eq!(mesh.boundary("top").unwrap().nodes(), [11, 10, 9, 8]);
    }

    /// By Gauss's theorem, `d V = ∮ x · n`, for flat facets with x at any point of them.
    #[test]
    fn facets_point_outwards() {
        let sizes: [(&[f64], Mesh); 2] =
            [(&[2.0, 1.5], block(&[2.0, 1.5], &[3, 2])), (&[2.0, 1.5, 0.5], block(&[2.0, 1.5, 0.5], &[3, 2, 4]))];
        for (size, block) in sizes {
            for mesh in [block.clone(), block.into_simplices()] {
                let facets = || mesh.boundaries.iter().flat_map(|b| &b.facets);
                let volume: f64 = facets().map(|facet| dot(mesh.nodes[facet[0]], mesh.area_vector(facet))).sum();
                assert!((volume - size.len() as f64 * size.iter().product::<f64>()).abs() < 1e-14);
                let mut closed = [0.0; 3];
                for facet in facets() {
                    closed.iter_mut().zip(mesh.area_vector(facet)).for_each(|(sum, a)| *sum += a);
                }
                assert!(closed.iter().all(|c| c.abs() < 1e-14), "{closed:?}");
            }
        }
        let mesh = block(&[2.0, 1.5, 0.5], &[3, 2, 4]);
        for (name, normal) in [
            ("left", [-1.0, 0.0, 0.0]),
            ("right", [1.0, 0.0, 0.0]),
            ("front", [0.0, -1.0, 0.0]),
            ("back", [0.0, 1.0, 0.0]),
            ("bottom", [0.0, 0.0, -1.0]),
            ("top", [0.0, 0.0, 1.0]),
        ] {
            let facets = &mesh.boundary(name).unwrap().facets;
            assert!(facets.iter().all(|facet| dot(mesh.area_vector(facet), normal) > 0.0), "{name}");
        }
    }

    #[test]
    fn sizes_are_in_geometric_progression() {
        for ratio in [1e-6, 0.25, 1.0 + 1e-9, 8.0, 1e6] {
            let xs = progression(3.0, 10, ratio);
            let sizes: Vec<f64> = xs.windows(2).map(|x| x[1] - x[0]).collect();
            assert_eq!((xs.len(), xs[0], xs[10]), (11, 0.0, 3.0));
            assert!((sizes[9] / sizes[0] / ratio - 1.0).abs() < 1e-9, "{sizes:?}");
            let q = ratio.powf(1.0 / 9.0);
            assert!(sizes.windows(2).all(|h| (h[1] / h[0] / q - 1.0).abs() < 1e-9), "{sizes:?}");
        }
        assert_eq!(graded_block(&[0.0, 1.0, 2.0], &[0.0, 1.0], None), block(&[2.0, 1.0], &[2, 1]));
        assert_eq!(progression(3.0, 1, 8.0), [0.0, 3.0]);
    }

    #[test]
    fn layers_grow_geometrically_from_square_elements() {
        let depths = graded(1.0, 11, 1.0 / 300.0);
        assert_eq!((depths.len(), depths[0], depths[11]), (12, 0.0, 1.0));
        assert!((depths[1] - 1.0 / 300.0).abs() < 1e-14);
        let ratio = (depths[2] - depths[1]) / depths[1];
        assert!(depths.windows(3).all(|d| ((d[2] - d[1]) / (d[1] - d[0]) - ratio).abs() < 1e-9));
        assert_eq!(graded(1.0, 2, 0.7), [0.0, 0.5, 1.0]);
    }

    #[test]
    fn the_mesh_of_the_punch() {
        let mesh = half_plane([1.0, 1.0], 0.1, 30, 50, 11);
        assert_eq!(mesh.cells.len(), 880);
        let contact = mesh.boundary("contact").unwrap();
        let xs: Vec<f64> = contact.nodes().iter().map(|&node| mesh.nodes[node][0]).collect();
        assert_eq!((xs.len(), xs[0], xs[30]), (31, 0.0, 0.1));
        assert!(xs.windows(2).all(|x| x[1] > x[0]));
        assert_eq!(mesh.boundary("top").unwrap().facets.len(), 50);
    }

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
