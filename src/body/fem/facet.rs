//! Integrals over the facets of the boundary: nodal weights and consistent nodal forces.

use crate::algebra::vector::{cross, norm, unit};
use crate::body::mesh::{Boundary, CellKind, Geometry, Mesh, UNIT_GAUSS3, fine_quadrature, local_gradients, shape};

/// Forces on nodes (N; in two dimensions per unit depth, for a body of revolution over the full circumference), each
/// with the number of its node; forces on the same node are added.
pub type NodalForces = Vec<(usize, [f64; 3])>;

/// An integration point of a facet.
pub(super) struct FacetPoint {
    /// The shape functions of the nodes of the facet.
    pub shape: Vec<f64>,
    /// The position, m.
    pub position: [f64; 3],
    /// The outward normal times the weight of the point: length (m) or area (m²), for a body of revolution the area of
    /// the full circumference.
    pub area: [f64; 3],
}

/// Returns the integration points of a facet. The rule is exact for cubic polynomials along an edge and along both axes
/// of a quadrilateral, and for quadratic polynomials on a triangle; on facets of second order, for degree five along an
/// edge and along both axes of a quadrilateral, and degree four on a triangle.
pub(super) fn facet_points(mesh: &Mesh, facet: &[usize]) -> Vec<FacetPoint> {
    let nodes = mesh.points(facet);
    let position = |shape: &[f64]| [0, 1, 2].map(|c| shape.iter().zip(&nodes).map(|(n, x)| n * x[c]).sum());
    let flat = |shape: Vec<f64>, weight: f64| {
        let position = position(&shape);
        let depth = mesh.geometry.depth(position);
        FacetPoint { position, shape, area: mesh.area_vector(facet).map(|a| weight * a * depth) }
    };
    match (mesh.dimension, facet.len()) {
        (2, 2) => {
            [-1.0, 1.0].map(|side| 0.5 * (1.0 + side / 3.0_f64.sqrt())).map(|s| flat(vec![1.0 - s, s], 0.5)).into()
        }
        (3, 3) => (0..3)
            .map(|k| flat((0..3).map(|j| if j == k { 2.0 / 3.0 } else { 1.0 / 6.0 }).collect(), 1.0 / 3.0))
            .collect(),
        _ => (curved_points(mesh, facet).into_iter())
            .map(|Point { shape, along: [along, across], weight }| FacetPoint {
                position: position(&shape),
                shape,
                area: cross(along, across).map(|a| weight * a),
            })
            .collect(),
    }
}

/// A point of a facet whose normal or size changes along it.
struct Point {
    /// The shape functions of the nodes of the facet.
    shape: Vec<f64>,
    /// `∂x/∂ξ` and `∂x/∂η`; in two dimensions the latter is normal to the plane.
    along: [[f64; 3]; 2],
    /// The weight, including the depth of the body there.
    weight: f64,
}

/// Returns the integration points of a quadrilateral or a facet of second order.
fn curved_points(mesh: &Mesh, facet: &[usize]) -> Vec<Point> {
    let rule = match mesh.dimension {
        2 => UNIT_GAUSS3.map(|(s, weight)| ([s, 0.0, 0.0], weight)).into(),
        _ => fine_quadrature(kind_of(facet)),
    };
    rule.into_iter().map(|(at, weight)| point(mesh, facet, at, weight)).collect()
}

/// Returns the point at `[ξ, η]` of a quadrilateral or a facet of second order; along an edge ξ goes from 0 to 1.
fn point(mesh: &Mesh, facet: &[usize], at: [f64; 3], weight: f64) -> Point {
    let nodes = mesh.points(facet);
    let sum = |d: &[f64]| [0, 1, 2].map(|c| d.iter().zip(&nodes).map(|(d, x)| d * x[c]).sum::<f64>());
    if mesh.dimension == 2 {
        let [s, ..] = at;
        let shape = vec![(1.0 - s) * (1.0 - 2.0 * s), 4.0 * s * (1.0 - s), s * (2.0 * s - 1.0)];
        let along = [sum(&[4.0 * s - 3.0, 4.0 - 8.0 * s, 4.0 * s - 1.0]), [0.0, 0.0, 1.0]];
        return Point { along, weight: weight * mesh.geometry.depth(sum(&shape)), shape };
    }
    let kind = kind_of(facet);
    let all = |value: &dyn Fn(usize) -> f64| (0..facet.len()).map(|k| value(order(kind, k))).collect::<Vec<f64>>();
    let (values, gradients) = (shape(kind, at), local_gradients(kind, at));
    Point { shape: all(&|k| values[k]), along: [0, 1].map(|r| sum(&all(&|k| gradients[k][r]))), weight }
}

/// Returns the kind of a face that is no triangle of three nodes.
fn kind_of(facet: &[usize]) -> CellKind {
    match facet.len() {
        6 => CellKind::Triangle6,
        8 => CellKind::Quadrilateral8,
        _ => CellKind::Quadrilateral,
    }
}

/// Returns the number, in a face of this kind, of node `k` of a facet; in a facet, nodes between corners are listed
/// between these corners.
fn order(kind: CellKind, k: usize) -> usize {
    if kind.is_quadratic() { k / 2 + kind.corners() * (k % 2) } else { k }
}

/// Computes `∫ N_a dA` for each node of a facet: its share of the length (m, half of an edge) or of the area (m²), in a
/// body of revolution over the full circumference.
///
/// The result is exact for edges, triangles and flat quadrilaterals, and for straight facets of second order. The
/// corners of a flat triangle of six nodes have 0, those of a rectangle of eight nodes -1/12 of its area.
pub fn facet_weights(mesh: &Mesh, facet: &[usize]) -> Vec<f64> {
    let nodes = facet.len();
    if nodes <= mesh.dimension && mesh.geometry == Geometry::Cartesian {
        return vec![norm(mesh.area_vector(facet)) / nodes as f64; nodes];
    }
    let mut weights = vec![0.0; nodes];
    let mut add = |shape: Vec<f64>, area: f64| weights.iter_mut().zip(shape).for_each(|(sum, n)| *sum += n * area);
    if nodes <= mesh.dimension {
        for FacetPoint { shape, area, .. } in facet_points(mesh, facet) {
            add(shape, norm(area));
        }
    } else {
        for Point { shape, along: [along, across], weight } in curved_points(mesh, facet) {
            add(shape, weight * norm(cross(along, across)));
        }
    }
    weights
}

/// Converts `values` of the shape functions of a facet's nodes to nowhere negative functions, so that weighted
/// quantities keep their sign: on facets of second order
///
/// ```text
/// Ñ_a = N_a + α Σ N_m      at corners, m between a and others,
/// Ñ_m = (1 - 2 α) N_m      between corners.
/// ```
///
/// The functions are Bernstein's polynomials if α = ¼, on edges and triangles. On a quadrilateral of eight nodes
/// `Ñ_a = ¼ (1 + ξ ξ_a) (1 + η η_a) (4 α - 1 + (1 - 2 α) (ξ ξ_a + η η_a))`, so that α = ⅜ is the least share without a
/// negative value. The sum of all functions is 1, too. On facets of first order they are the shape functions.
pub fn bernstein(mesh: &Mesh, facet: &[usize], values: &[f64]) -> Vec<f64> {
    let mut changed = values.to_vec();
    let share = mesh.share_of_ends(facet);
    for (k, _) in mesh.bent_edges(facet).iter().enumerate() {
        let [a, m, b] = [2 * k, 2 * k + 1, (2 * k + 2) % facet.len()];
        changed[m] = (1.0 - 2.0 * share) * values[m];
        changed[a] += share * values[m];
        changed[b] += share * values[m];
    }
    changed
}

/// Computes `∫ Ñ_a Ñ_b dA` (m or m²) for all nodes of a facet, with the functions of [`bernstein`].
pub(crate) fn facet_mass(mesh: &Mesh, facet: &[usize]) -> Vec<Vec<f64>> {
    let mut mass = vec![vec![0.0; facet.len()]; facet.len()];
    for FacetPoint { shape, area, .. } in facet_points(mesh, facet) {
        let (n, d_area) = (bernstein(mesh, facet, &shape), norm(area));
        for (row, n_a) in mass.iter_mut().zip(&n) {
            row.iter_mut().zip(&n).for_each(|(entry, n_b)| *entry += n_a * n_b * d_area);
        }
    }
    mass
}

/// Returns the outward normal at each node of a facet with the length or area of the facet as its magnitude: the area
/// vector on facets of first order, turned according to the curvature on facets of second order.
pub fn facet_normals(mesh: &Mesh, facet: &[usize]) -> Vec<[f64; 3]> {
    let area = mesh.area_vector(facet);
    if !mesh.is_quadratic(facet) {
        return vec![area; facet.len()];
    }
    let normal = |k: usize| {
        let at = match (mesh.dimension, kind_of(facet)) {
            (2, _) => [0.5 * k as f64, 0.0, 0.0],
            (_, kind) => kind.reference_node(order(kind, k)),
        };
        let [along, across] = point(mesh, facet, at, 1.0).along;
        unit(cross(along, across)).map(|c| norm(area) * c)
    };
    (0..facet.len()).map(normal).collect()
}

/// Computes the length (m) or area (m²) of `boundary`, in a body of revolution over the full circumference.
pub fn area(mesh: &Mesh, boundary: &Boundary) -> f64 {
    boundary.facets.iter().flat_map(|facet| facet_weights(mesh, facet)).sum()
}

/// Computes the forces of a uniform `traction` (N/m²) on `boundary`: `∫ N_a t dA`.
pub fn uniform_traction(mesh: &Mesh, boundary: &Boundary, traction: [f64; 3]) -> NodalForces {
    let on_facet = |facet: &Vec<usize>| {
        let weights = facet_weights(mesh, facet);
        facet.iter().copied().zip(weights.into_iter().map(|weight| traction.map(|t| weight * t))).collect::<Vec<_>>()
    };
    boundary.facets.iter().flat_map(on_facet).collect()
}

/// Computes the forces of varying tractions on `boundary`: `∫ N_a t dA`, where `force` returns `t dA` (N) for a
/// position (m) and the outward area vector (m or m²) of a point.
pub fn traction(mesh: &Mesh, boundary: &Boundary, force: impl Fn([f64; 3], [f64; 3]) -> [f64; 3]) -> NodalForces {
    let mut forces = Vec::new();
    for facet in &boundary.facets {
        for FacetPoint { shape, position, area } in facet_points(mesh, facet) {
            let force = force(position, area);
            forces.extend(facet.iter().zip(&shape).map(|(&node, n)| (node, force.map(|f| n * f))));
        }
    }
    forces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::mesh::block;

    /// The first moments of a flat facet distinguish its shares: `Σ w_a x_a = ∫ x dA`.
    #[test]
    fn shares_are_exact_on_a_trapezium() {
        let mut mesh = block(&[1.0, 1.0, 1.0], &[1, 1, 1]);
        let top = mesh.boundary("top").unwrap().facets[0].clone();
        // The top becomes the trapezium 0 <= x <= 1 + 2 y of area 2, with ∫ x dA = 13/6, ∫ y dA = 7/6.
        mesh.nodes[7][0] = 3.0;
        let weights = facet_weights(&mesh, &top);
        let moment = |c: usize| weights.iter().zip(&top).map(|(w, &node)| w * mesh.nodes[node][c]).sum::<f64>();
        assert!((weights.iter().sum::<f64>() - 2.0).abs() < 1e-14);
        assert!((moment(0) - 13.0 / 6.0).abs() < 1e-14 && (moment(1) - 7.0 / 6.0).abs() < 1e-14, "{weights:?}");
        // ∫ x y dA = ∫ (1 + 2 y)² y / 2 dy = 17/12.
        let forces = traction(&mesh, mesh.boundary("top").unwrap(), |[x, y, _], area| area.map(|a| a * x * y));
        let sum = forces.iter().map(|(_, force)| force[2]).sum::<f64>();
        assert!((sum - 17.0 / 12.0).abs() < 1e-14, "{sum}");
    }

    /// The products of a quadratic and a linear function, integrated on every kind of facet.
    #[test]
    fn tractions_that_change_along_a_boundary() {
        let plane = block(&[3.0, 1.0], &[2, 1]);
        let space = block(&[3.0, 2.0, 1.0], &[2, 1, 1]);
        let simplices = space.clone().into_simplices();
        for (mesh, exact) in [(&plane, 9.0), (&space, 18.0), (&simplices, 18.0)] {
            let up = mesh.dimension - 1;
            let forces = traction(mesh, mesh.boundary("top").unwrap(), |[x, ..], area| area.map(|a| a * x * x));
            let sum = forces.iter().map(|(_, force)| force[up]).sum::<f64>();
            assert!((sum - exact).abs() < 1e-13, "{sum}");
            let uniform = uniform_traction(mesh, mesh.boundary("top").unwrap(), [1.0; 3]);
            let sum = uniform.iter().map(|(_, force)| force[0]).sum::<f64>();
            assert!((sum - area(mesh, mesh.boundary("top").unwrap())).abs() < 1e-14);
        }
    }

    /// Bernstein's weights are equal on a square of eight nodes but for corners and middles, where the shape functions are
    /// negative at corners; no function is negative anywhere, and with a lesser share one would be.
    #[test]
    fn functions_of_a_quadrilateral_of_eight_nodes_are_nowhere_negative() {
        let mesh = block(&[1.0; 3], &[1; 3]).into_second_order();
        let facet = &mesh.boundary("top").unwrap().facets[0];
        let weights = facet_weights(&mesh, facet);
        let raised = bernstein(&mesh, facet, &weights);
        for (k, (weight, raised)) in weights.iter().zip(raised).enumerate() {
            let expected = if k % 2 == 0 { [-1.0 / 12.0, 1.0 / 6.0] } else { [1.0 / 3.0, 1.0 / 12.0] };
            assert!((weight - expected[0]).abs() < 1e-15 && (raised - expected[1]).abs() < 1e-15, "{k}");
        }
        let step = |k: i32| f64::from(k) / 20.0;
        let places = (-20..=20).flat_map(|i| (-20..=20).map(move |j| [step(i), step(j), 0.0]));
        let mut least = f64::INFINITY;
        for at in places {
            let values = bernstein(&mesh, facet, &point(&mesh, facet, at, 1.0).shape);
            assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            least = values.into_iter().fold(least, f64::min);
        }
        assert!((-1e-16..1e-15).contains(&least), "{least}");
        // Opposite a corner the function begins with the slope 0: 4 α - 1 - 2 (1 - 2 α) = 0.
        let share = mesh.share_of_ends(facet);
        assert!((4.0 * share - 1.0 - 2.0 * (1.0 - 2.0 * share)).abs() < 1e-15);
    }
}
