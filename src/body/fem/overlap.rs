//! Search for bodies inside one another.

use super::locate::reference_point;
use crate::body::mesh::{Bodies, CellKind, Mesh};

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
    reference_point(kind, nodes, x).is_some_and(|at| is_inside(kind, at))
}

/// Returns `true` if a point of the reference cell is not on its sides.
fn is_inside(kind: CellKind, [xi, eta, zeta]: [f64; 3]) -> bool {
    let shares = [1.0 - xi - eta, xi, eta];
    let away = |x: f64| x.abs() < 1.0 - INSIDE;
    match kind {
        _ if kind.is_prism() => shares.iter().all(|share| *share > INSIDE) && away(zeta),
        _ if kind.is_simplex() && kind.dimension() == 2 => shares.iter().all(|share| *share > INSIDE),
        _ if kind.is_simplex() => [1.0 - xi - eta - zeta, xi, eta, zeta].iter().all(|share| *share > INSIDE),
        _ => [xi, eta, zeta][..kind.dimension()].iter().all(|x| away(*x)),
    }
}
