//! Shape functions: linear on triangles and tetrahedra, quadratic on triangles and tetrahedra of second order, bilinear
//! on quadrilaterals, trilinear on hexahedra, products on prisms, and those of second order of the last three. They also
//! map the reference cell to the cell. At the integration points they are computed once for all cells of a kind.

use super::kind::Functions;
use super::{CellKind, Geometry, Mesh, rules};
use crate::algebra::vector::{cross, dot, minus, norm};

/// An edge counts as curved if its middle node is off the middle of the straight line by more than this share of the
/// edge; rounding errors of coordinates are far smaller.
const STRAIGHT: f64 = 1e-10;

/// Returns the shape functions of all nodes at the reference point `[ξ, η, ζ]`: `Π ½ (1 + ξ_c ξ_ac)` over the axes c
/// for a square or cube; `1 - ξ - η - ζ, ξ, η, ζ` for a tetrahedron, without ζ for a triangle, and the latter times
/// `½ (1 ± ζ)` for a prism. With these `L_a`, simplices of second order have `L_a (2 L_a - 1)` at corners and
/// `4 L_a L_b` between the corners a and b.
///
/// Quadrilaterals of eight nodes and hexahedra of twenty have `(Σ ξ_c ξ_ac - d + 1) Π ½ (1 + ξ_c ξ_ac)` at corners, in
/// d dimensions, and the product with `1 - ξ_c²` in place of the factor of the axis c between corners. Quadrilaterals
/// of nine nodes have products of quadratic functions along the axes. Prisms of fifteen nodes have, with the `L_a` of
/// the triangle, `½ L_a (1 ± ζ) (2 L_a - 2 ± ζ)` at corners, `2 L_a L_b (1 ± ζ)` between corners of a triangle and
/// `L_a (1 - ζ²)` between the triangles.
pub fn shape(kind: CellKind, point: [f64; 3]) -> Vec<f64> {
    match kind.properties().functions {
        Functions::Multilinear | Functions::Linear | Functions::Prismatic => corner_shape(kind, point),
        Functions::Quadratic => {
            let l = barycentric(kind, point);
            let middles = kind.properties().edges.iter().map(|&[a, b]| 4.0 * l[a] * l[b]);
            l.iter().map(|l| l * (2.0 * l - 1.0)).chain(middles).collect()
        }
        Functions::Serendipity => {
            let of = |k: usize| product(kind, k, point, false) * edge_factor(kind, k, point);
            (0..kind.nodes()).map(of).collect()
        }
        Functions::Multiquadratic => (0..kind.nodes()).map(|k| product(kind, k, point, true)).collect(),
        Functions::SerendipityPrism => prism(kind, point).into_iter().map(|(value, _)| value).collect(),
    }
}

/// Returns the shape functions of the corners of a cell without other nodes.
pub(crate) fn corner_shape(kind: CellKind, point: [f64; 3]) -> Vec<f64> {
    if kind.is_prism() {
        let ends = [0.5 * (1.0 - point[2]), 0.5 * (1.0 + point[2])];
        let l = across(point);
        return ends.into_iter().flat_map(|end| l.map(|l| l * end)).collect();
    }
    if kind.is_simplex() {
        return barycentric(kind, point);
    }
    (0..kind.corners()).map(|k| product(kind, k, point, false)).collect()
}

/// Returns value and slope along one axis of the function of a node at the coordinate `at`, -1, 0 or 1. At 0 it is
/// `1 - ξ²`, otherwise linear or, if the functions of all three are `quadratic`, `½ ξ (ξ ± 1)`.
fn along_axis(at: f64, xi: f64, quadratic: bool) -> [f64; 2] {
    match () {
        () if at == 0.0 => [1.0 - xi * xi, -2.0 * xi],
        () if quadratic => [0.5 * xi * (xi + at), xi + 0.5 * at],
        () => [0.5 * (1.0 + xi * at), 0.5 * at],
    }
}

/// Returns the product over the axes of the functions of node `k` of a square or cube.
fn product(kind: CellKind, k: usize, point: [f64; 3], quadratic: bool) -> f64 {
    let node = kind.reference_node(k);
    (0..kind.dimension()).map(|c| along_axis(node[c], point[c], quadratic)[0]).product()
}

/// Returns the derivative of [`product`] along an axis.
fn slope(kind: CellKind, k: usize, point: [f64; 3], quadratic: bool, along: usize) -> f64 {
    let node = kind.reference_node(k);
    let others = (0..kind.dimension()).filter(|&c| c != along);
    along_axis(node[along], point[along], quadratic)[1]
        * others.map(|c| along_axis(node[c], point[c], quadratic)[0]).product::<f64>()
}

/// Returns `Σ ξ_c ξ_ac - d + 1`, the factor of a corner of a square or cube that makes its function 0 at the middles of
/// its edges; 1 for other nodes.
fn edge_factor(kind: CellKind, k: usize, point: [f64; 3]) -> f64 {
    if k >= kind.corners() {
        return 1.0;
    }
    dot(kind.reference_node(k), point) - (kind.dimension() - 1) as f64
}

/// Returns values and gradients of the functions of a prism of fifteen nodes.
fn prism(kind: CellKind, point: [f64; 3]) -> Vec<(f64, [f64; 3])> {
    let (l, zeta) = (across(point), point[2]);
    let of = |k: usize| -> (f64, [f64; 3]) {
        let sign = kind.reference_node(k)[2];
        match *kind.between(k) {
            [a, b] if sign == 0.0 => {
                // Between the triangles, at the same corner of both.
                let (a, end) = (a.min(b), 1.0 - zeta * zeta);
                let [x, y] = ACROSS[a].map(|d| d * end);
                (l[a] * end, [x, y, -2.0 * zeta * l[a]])
            }
            [a, b] => {
                let ([a, b], end) = ([a % 3, b % 3], 1.0 + sign * zeta);
                let [x, y] = [0, 1].map(|c| 2.0 * end * (l[a] * ACROSS[b][c] + l[b] * ACROSS[a][c]));
                (2.0 * l[a] * l[b] * end, [x, y, 2.0 * sign * l[a] * l[b]])
            }
            _ => {
                let (a, end) = (k % 3, 1.0 + sign * zeta);
                let rest = 2.0 * l[a] - 2.0 + sign * zeta;
                let [x, y] = ACROSS[a].map(|d| 0.5 * end * d * (rest + 2.0 * l[a]));
                (0.5 * l[a] * end * rest, [x, y, 0.5 * sign * l[a] * (rest + end)])
            }
        }
    };
    (0..kind.nodes()).map(of).collect()
}

/// `∂L_a/∂(ξ, η)` of the triangular section of a prism.
const ACROSS: [[f64; 2]; 3] = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];

/// Returns `L_a` of the triangular section of a prism.
fn across([xi, eta, _]: [f64; 3]) -> [f64; 3] {
    [1.0 - xi - eta, xi, eta]
}

/// Returns `L_a` of all corners of a simplex.
fn barycentric(kind: CellKind, [xi, eta, zeta]: [f64; 3]) -> Vec<f64> {
    match kind.dimension() {
        2 => vec![1.0 - xi - eta, xi, eta],
        _ => vec![1.0 - xi - eta - zeta, xi, eta, zeta],
    }
}

/// Returns `∂N_a/∂(ξ, η, ζ)` of all nodes; the last is 0 in two dimensions.
pub(crate) fn local_gradients(kind: CellKind, point: [f64; 3]) -> Vec<[f64; 3]> {
    let (axes, corners) = (kind.dimension(), kind.corners());
    let slopes =
        |k: usize, quadratic: bool| [0, 1, 2].map(|c| if c < axes { slope(kind, k, point, quadratic, c) } else { 0.0 });
    let linear = || match axes {
        2 => vec![[-1.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        _ => vec![[-1.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    match kind.properties().functions {
        Functions::Multilinear => (0..corners).map(|k| slopes(k, false)).collect(),
        Functions::Multiquadratic => (0..kind.nodes()).map(|k| slopes(k, true)).collect(),
        Functions::Serendipity => {
            let of = |k: usize| {
                let (factor, slopes, corner) = (edge_factor(kind, k, point), slopes(k, false), kind.reference_node(k));
                let own = if k < corners { product(kind, k, point, false) } else { 0.0 };
                [0, 1, 2].map(|c| factor * slopes[c] + own * corner[c])
            };
            (0..kind.nodes()).map(of).collect()
        }
        Functions::SerendipityPrism => prism(kind, point).into_iter().map(|(_, gradient)| gradient).collect(),
        Functions::Prismatic => {
            let l = across(point);
            let at_end = |sign: f64| {
                let end = 0.5 * (1.0 + sign * point[2]);
                (0..3).map(move |a| [end * ACROSS[a][0], end * ACROSS[a][1], 0.5 * sign * l[a]])
            };
            at_end(-1.0).chain(at_end(1.0)).collect()
        }
        Functions::Linear => linear(),
        Functions::Quadratic => {
            let (l, d) = (barycentric(kind, point), linear());
            let at_corner = |a: usize| d[a].map(|d| (4.0 * l[a] - 1.0) * d);
            let between = |[a, b]: [usize; 2]| [0, 1, 2].map(|c| 4.0 * (l[a] * d[b][c] + l[b] * d[a][c]));
            let middles = kind.properties().edges.iter().map(|&edge| between(edge));
            (0..corners).map(at_corner).chain(middles).collect()
        }
    }
}

/// The Jacobian of the map of a reference cell at a point.
pub(crate) struct Jacobian {
    /// `∂N_a/∂(ξ, η, ζ)` of all nodes.
    pub local: Vec<[f64; 3]>,
    /// `∂(x, y, z)/∂(ξ, η, ζ)`, with rows for ξ, η and ζ; in two dimensions the third row is (0, 0, 1), for a slice of
    /// unit depth.
    pub rows: [[f64; 3]; 3],
    /// The columns of the inverse times the determinant.
    pub cofactors: [[f64; 3]; 3],
    /// The determinant, m^d.
    pub determinant: f64,
}

impl Jacobian {
    /// Computes the Jacobian at the reference point `point` of the cell with `nodes` (m).
    pub(crate) fn new(kind: CellKind, point: [f64; 3], nodes: &[[f64; 3]]) -> Self {
        let local = local_gradients(kind, point);
        let mut j = [[0.0; 3]; 3];
        for (d, x) in local.iter().zip(nodes) {
            for r in 0..3 {
                for c in 0..3 {
                    j[r][c] += d[r] * x[c];
                }
            }
        }
        if kind.dimension() == 2 {
            j[2] = [0.0, 0.0, 1.0];
        }
        let cofactors = [cross(j[1], j[2]), cross(j[2], j[0]), cross(j[0], j[1])];
        Jacobian { local, rows: j, cofactors, determinant: dot(j[0], cofactors[0]) }
    }
}

impl CellKind {
    /// Returns `true` if an edge of the cell with these `nodes` is curved, or the node between its ends is not in the
    /// middle.
    pub(super) fn is_curved(self, nodes: &[[f64; 3]]) -> bool {
        let off = |(&[a, b], middle): (&[usize; 2], &[f64; 3])| {
            let (a, b) = (nodes[a], nodes[b]);
            let off = [0, 1, 2].map(|c| middle[c] - 0.5 * (a[c] + b[c]));
            norm(off) > STRAIGHT * norm(minus(b, a))
        };
        self.properties().edges.iter().zip(&nodes[self.corners()..]).any(off)
    }
}

/// Returns the points and weights of the rule for the stiffness of a cell with straight edges.
///
/// Squares and cubes have two Gauss points of weight 1 along each axis, exact for cubic polynomials in each of
/// [ξ, η, ζ]; triangles and tetrahedra have their centre, exact for linear polynomials; those of second order have
/// three and four points, exact for quadratic polynomials.
pub fn quadrature(kind: CellKind) -> Vec<([f64; 3], f64)> {
    (kind.properties().rule)()
}

/// Returns the rule that is exact for polynomials of one degree more on triangles and tetrahedra, and of two degrees
/// more on those of second order.
pub fn fine_quadrature(kind: CellKind) -> Vec<([f64; 3], f64)> {
    (kind.properties().fine_rule)()
}

/// Returns the rule for the stiffness of the cell with these `nodes`: a curved tetrahedron has more points than in
/// [`quadrature`]. In a body of revolution, integrands are multiplied by the distance from the axis, and the hoop
/// strain is divided by it. There a linear triangle has three points, since one point would leave a zero-energy mode,
/// and a curved triangle of second order has more than three.
pub fn quadrature_of(kind: CellKind, geometry: Geometry, nodes: &[[f64; 3]]) -> Vec<([f64; 3], f64)> {
    stiffness_rule(kind, geometry, kind.is_curved(nodes))
}

/// Returns the rule for the stiffness of a cell that is `curved` or not.
pub(crate) fn stiffness_rule(kind: CellKind, geometry: Geometry, curved: bool) -> Vec<([f64; 3], f64)> {
    let properties = kind.properties();
    match (geometry, curved) {
        // Gradients times the determinant of curved edges are cubic, so that four points fail the patch test.
        (Geometry::Cartesian, true) if kind == CellKind::Tetrahedron10 => rules::tetrahedron8(),
        (Geometry::Cartesian, _) => (properties.rule)(),
        (Geometry::Axisymmetric | Geometry::Torsion, false) if kind.is_quadratic() => (properties.rule)(),
        (Geometry::Axisymmetric | Geometry::Torsion, _) => (properties.fine_rule)(),
    }
}

/// The largest number of nodes of a cell.
pub(crate) const MAX_NODES: usize = 20;

/// The largest number of corners of a cell.
const MAX_CORNERS: usize = 8;

/// A point of a rule on a reference cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ReferencePoint {
    /// The weight of the point.
    pub weight: f64,
    /// The shape functions of the nodes; 0 beyond the last node.
    pub shape: [f64; MAX_NODES],
    /// The shape functions of the corners, see [`corner_shape`].
    pub corners: [f64; MAX_CORNERS],
    /// `∂N_a/∂(ξ, η, ζ)` of the nodes.
    pub slopes: [[f64; 3]; MAX_NODES],
}

/// A kind of cell at its integration points.
#[derive(Debug, Clone)]
pub(crate) struct ReferenceCell {
    straight: Vec<ReferencePoint>,
    curved: Vec<ReferencePoint>,
    /// The points of [`fine_quadrature`].
    pub fine: Vec<ReferencePoint>,
}

impl ReferenceCell {
    fn new(kind: CellKind, geometry: Geometry) -> Self {
        let at = |(point, weight): ([f64; 3], f64)| {
            let (values, gradients) = (shape(kind, point), local_gradients(kind, point));
            let (mut shape, mut slopes) = ([0.0; MAX_NODES], [[0.0; 3]; MAX_NODES]);
            shape[..values.len()].copy_from_slice(&values);
            slopes[..gradients.len()].copy_from_slice(&gradients);
            let (of_corners, mut corners) = (corner_shape(kind, point), [0.0; MAX_CORNERS]);
            corners[..of_corners.len()].copy_from_slice(&of_corners);
            ReferencePoint { weight, shape, corners, slopes }
        };
        ReferenceCell {
            straight: stiffness_rule(kind, geometry, false).into_iter().map(at).collect(),
            curved: stiffness_rule(kind, geometry, true).into_iter().map(at).collect(),
            fine: fine_quadrature(kind).into_iter().map(at).collect(),
        }
    }

    /// Returns the points of [`super::quadrature_of`] for the cell of this `kind` with these `nodes`.
    pub(crate) fn of(&self, kind: CellKind, nodes: &[[f64; 3]]) -> &[ReferencePoint] {
        if kind.is_curved(nodes) { &self.curved } else { &self.straight }
    }
}

/// The kinds of cells in a mesh.
#[derive(Debug, Clone)]
pub(crate) struct ReferenceCells([Option<ReferenceCell>; CellKind::ALL.len()]);

impl ReferenceCells {
    /// Computes the points of all kinds of cells in `mesh`.
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let mut cells = ReferenceCells(Default::default());
        for cell in &mesh.cells {
            cells.0[cell.kind as usize].get_or_insert_with(|| ReferenceCell::new(cell.kind, mesh.geometry));
        }
        cells
    }

    /// Returns the points of a kind; `None` if the mesh has no such cells.
    pub(crate) fn get(&self, kind: CellKind) -> Option<&ReferenceCell> {
        self.0[kind as usize].as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the nodes of a distorted reference cell; plane cells remain plane.
    fn distorted(kind: CellKind) -> Vec<[f64; 3]> {
        let bent = |[x, y, z]: [f64; 3]| [x + 0.2 * y * y + 0.1 * z, y - 0.3 * x + 0.1 * x * y, z + 0.2 * x * y * z];
        (0..kind.nodes()).map(|k| bent(kind.reference_node(k))).collect()
    }

    #[test]
    fn each_function_is_one_at_its_node() {
        for kind in CellKind::ALL {
            for a in 0..kind.nodes() {
                let values = shape(kind, kind.reference_node(a));
                assert!(values.iter().enumerate().all(|(b, &n)| n == f64::from(u8::from(a == b))), "{kind:?}");
            }
        }
    }

    /// The gradients are the derivatives of the functions, whose sum is 1.
    #[test]
    fn gradients_are_derivatives() {
        let (point, step) = ([0.2, 0.3, 0.1], 1e-6);
        for kind in CellKind::ALL {
            assert!((shape(kind, point).iter().sum::<f64>() - 1.0).abs() < 1e-15);
            let gradients = local_gradients(kind, point);
            assert_eq!(gradients.len(), kind.nodes());
            for c in 0..kind.dimension() {
                let at = |s: f64| shape(kind, [0, 1, 2].map(|k| point[k] + if k == c { s } else { 0.0 }));
                for ((ahead, behind), gradient) in at(step).iter().zip(at(-step)).zip(&gradients) {
                    assert!(((ahead - behind) / (2.0 * step) - gradient[c]).abs() < 1e-9, "{kind:?}");
                }
            }
        }
    }

    #[test]
    fn curved_is_what_is_off_the_middle() {
        for kind in CellKind::ALL {
            let straight: Vec<_> = (0..kind.nodes()).map(|k| kind.reference_node(k)).collect();
            assert!(!kind.is_curved(&straight), "{kind:?}");
            assert_eq!(kind.is_curved(&distorted(kind)), kind.is_quadratic(), "{kind:?}");
        }
    }
}
