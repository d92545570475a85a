//! Points in cells: their reference coordinates, and bodies inside one another.

use crate::algebra::vector::dot;
use crate::body::mesh::{Bodies, CellKind, Jacobian, Mesh, shape};

/// A node of a body inside a cell of another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Overlap {
    /// The body of the node, and the body of the cell.
    pub bodies: (usize, usize),
    /// The node.
    pub node: usize,
}

/// A node counts as inside a cell if its distance from the sides exceeds this, in reference coordinates; less is
/// rounding.
const INSIDE: f64 = 1e-6;

/// Smallest and largest coordinates.
type Bounds = [(f64, f64); 3];

/// Finds, for each pair of `bodies` of `mesh` for which `apart` returns `true`, the first node of one body inside a
/// cell of the other.
///
/// `apart` is called with the smaller number first. Bodies that intersect without a node inside each other are not
/// found.
pub fn overlaps(mesh: &Mesh, bodies: &Bodies, apart: impl Fn(usize, usize) -> bool) -> Vec<Overlap> {
    let bounds: Vec<Bounds> = (0..bodies.count()).map(|k| mesh.bounds_of(bodies.nodes(k))).collect();
    let mut found = Vec::new();
    for a in 0..bodies.count() {
        for b in a + 1..bodies.count() {
            let common = common(&bounds[a], &bounds[b]);
            if common[..mesh.dimension].iter().all(|(lo, hi)| lo < hi) && apart(a, b) {
                found.extend(inside(mesh, bodies, (a, b), &common).or_else(|| inside(mesh, bodies, (b, a), &common)));
            }
        }
    }
    found
}

fn common(a: &Bounds, b: &Bounds) -> Bounds {
    [0, 1, 2].map(|c| (a[c].0.max(b[c].0), a[c].1.min(b[c].1)))
}

/// Finds the first node of one body inside a cell of the other, within the bounds `common`.
fn inside(mesh: &Mesh, bodies: &Bodies, (a, b): (usize, usize), common: &Bounds) -> Option<Overlap> {
    let within = |bounds: &Bounds, x: [f64; 3]| (0..mesh.dimension).all(|c| bounds[c].0 <= x[c] && x[c] <= bounds[c].1);
    let mut nodes: Vec<usize> = bodies.nodes(a).filter(|&node| within(common, mesh.nodes[node])).collect();
    // Candidates for a cell are the nodes beside it along the longest axis.
    let axis =
        (0..mesh.dimension).max_by(|&i, &j| (common[i].1 - common[i].0).total_cmp(&(common[j].1 - common[j].0)))?;
    nodes.sort_by(|&i, &j| mesh.nodes[i][axis].total_cmp(&mesh.nodes[j][axis]));
    let node = bodies.cells(b).filter_map(|e| {
        let cell = &mesh.cells[e];
        let bounds = mesh.bounds_of(cell.nodes.iter().copied());
        let begin = nodes.partition_point(|&node| mesh.nodes[node][axis] < bounds[axis].0);
        let beside = nodes[begin..].iter().take_while(|&&node| mesh.nodes[node][axis] <= bounds[axis].1);
        let near = beside.copied().filter(|&node| within(&bounds, mesh.nodes[node]));
        let corners = mesh.points(&cell.nodes);
        let deep = |node: &usize| is_inside_cell(cell.kind, &corners, mesh.nodes[*node]);
        near.filter(deep).min()
    });
    Some(Overlap { bodies: (a, b), node: node.min()? })
}

/// Returns `true` if `x` (m) is inside the cell with `nodes` (m), excluding its sides.
pub(crate) fn is_inside_cell(kind: CellKind, nodes: &[[f64; 3]], x: [f64; 3]) -> bool {
    reference_point(kind, nodes, x).is_some_and(|at| is_within(kind, at, INSIDE))
}

/// The largest distance outside a cell of a point that counts as on its side, in reference coordinates.
const SLACK: f64 = 1e-9;

/// The largest number of Newton steps. Bilinear cells need four or five; a cell that needs more is invalid.
const MAX_STEPS: usize = 30;

/// Returns the reference point `[ξ, η, ζ]` that the shape functions map to `x` (m), if `x` is in the cell with `nodes`
/// (m), including its sides; `None` for a point outside.
pub(crate) fn reference_point(kind: CellKind, nodes: &[[f64; 3]], x: [f64; 3]) -> Option<[f64; 3]> {
    // The initial guess is the centre.
    let mut point = kind.centre();
    for _ in 0..MAX_STEPS {
        let values = shape(kind, point);
        let at = |c: usize| values.iter().zip(nodes).map(|(n, node)| n * node[c]).sum::<f64>();
        let residual = [0, 1, 2].map(|c| x[c] - at(c));
        let Jacobian { cofactors, determinant: det, .. } = Jacobian::new(kind, point, nodes);
        let step = cofactors.map(|cofactor| dot(residual, cofactor) / det);
        (0..3).for_each(|r| point[r] += step[r]);
        let length = step.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
        // Far outside, the map may not be invertible.
        if length.is_nan() || point.iter().any(|c| c.abs() > 10.0) {
            return None;
        }
        if length <= 1e-12 {
            return is_within(kind, point, -SLACK).then_some(point);
        }
    }
    None
}

/// Returns `true` if a point of the reference cell is further than `margin` within its sides.
fn is_within(kind: CellKind, [xi, eta, zeta]: [f64; 3], margin: f64) -> bool {
    let share = |shares: &[f64]| shares.iter().all(|share| *share > margin);
    let between = |x: f64| x.abs() < 1.0 - margin;
    match kind.dimension() {
        _ if kind.is_prism() => share(&[1.0 - xi - eta, xi, eta]) && between(zeta),
        2 if kind.is_simplex() => share(&[1.0 - xi - eta, xi, eta]),
        _ if kind.is_simplex() => share(&[1.0 - xi - eta - zeta, xi, eta, zeta]),
        dimension => [xi, eta, zeta][..dimension].iter().all(|x| between(*x)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::mesh::corner_shape;

    const CORNERS: [[f64; 3]; 8] = [
        [0.0, 0.0, 0.0],
        [2.0, 0.3, 0.1],
        [1.7, 1.4, 0.0],
        [-0.2, 1.1, -0.1],
        [0.1, 0.1, 1.0],
        [2.1, 0.2, 1.2],
        [1.6, 1.5, 0.9],
        [-0.1, 1.0, 1.1],
    ];

    #[test]
    fn points_are_found_where_they_are() {
        for kind in CellKind::ALL {
            let flat = |x: [f64; 3]| if kind.dimension() == 2 { [x[0], x[1], 0.0] } else { x };
            let spatial_simplex = kind.is_simplex() && kind.dimension() == 3;
            let chosen: Vec<usize> = match kind {
                _ if kind.is_prism() => vec![0, 1, 3, 4, 5, 7],
                _ if spatial_simplex => vec![0, 1, 3, 4],
                _ => (0..8).collect(),
            };
            let corners: Vec<_> = chosen[..kind.corners()].iter().map(|&k| flat(CORNERS[k])).collect();
            // Nodes between corners are moved off the middle.
            let off = |k: usize| flat([0.03 * (k as f64).sin(), 0.02 * (k as f64).cos(), 0.01]);
            let between = (corners.len()..kind.nodes()).map(|k| {
                let values = corner_shape(kind, kind.reference_node(k));
                [0, 1, 2].map(|c| values.iter().zip(&corners).map(|(n, x)| n * x[c]).sum::<f64>() + off(k)[c])
            });
            let nodes: Vec<_> = corners.iter().copied().chain(between).collect();
            let place = |reference: [f64; 3]| {
                let values = shape(kind, reference);
                [0, 1, 2].map(|c| values.iter().zip(&nodes).map(|(n, x)| n * x[c]).sum::<f64>())
            };
            let triangular = kind.is_simplex() || kind.is_prism();
            let reference = flat(if triangular { [0.2, 0.3, 0.1] } else { [0.7, -0.9, 0.3] });
            let found = reference_point(kind, &nodes, place(reference)).unwrap();
            assert!((0..3).all(|c| (found[c] - reference[c]).abs() < 1e-12), "{kind:?}: {found:?}");
            // Corners belong to the cell; a point beyond a side does not, at any distance.
            assert!(corners.iter().all(|&corner| reference_point(kind, &nodes, corner).is_some()), "{kind:?}");
            let outside = flat(if triangular { [-1e-6, 0.3, 0.1] } else { [1.0 + 1e-6, 0.0, 0.0] });
            assert_eq!(reference_point(kind, &nodes, place(outside)), None, "{kind:?}");
            assert_eq!(reference_point(kind, &nodes, flat([90.0, -40.0, 7.0])), None, "{kind:?}");
        }
    }
}
