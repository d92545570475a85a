//! Search for the boundaries and nodes that a description names.

use super::find;
use crate::algebra::vector::{Vector, minus, norm, unit};
use crate::base::input_error::InputError;
use crate::base::units::UnitSystem;
use crate::body::description::Where;
use crate::body::fem::{area, facet_normals};
use crate::body::mesh::{Boundary, Mesh};

/// The tolerance of coordinates that name a node, as a share of the size of the body; coordinates are given with a few
/// digits.
const NEAR: f64 = 1e-6;

/// Returns the nodes at the place given at `key`, each once.
pub(super) fn nodes(mesh: &Mesh, at: &Where, units: &UnitSystem, key: &str) -> Result<Vec<usize>, InputError> {
    match at {
        Where::Boundary(name) => Ok(find(mesh, name, key)?.nodes()),
        Where::Point(point) => Ok(vec![node(mesh, *point, units, key)?]),
        // Callers find the points of couplings.
        Where::Coupling(_) => Ok(Vec::new()),
    }
}

/// Returns the node at `point`; errors use `units`.
pub(super) fn node(mesh: &Mesh, point: Vector, units: &UnitSystem, key: &str) -> Result<usize, InputError> {
    suits(mesh, point, &format!("{key}.point"))?;
    let x = point.components();
    let distance = |node: usize| norm(minus(mesh.nodes[node], x));
    let nearest = (0..mesh.nodes.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
    let nearest = nearest.unwrap_or(0);
    let near = NEAR * mesh.size();
    if distance(nearest) <= near {
        return only(mesh, nearest, |node| distance(node) <= near, units, key);
    }
    let message = format!("no node of the mesh is at {}", units.point(x));
    let help = format!("the nearest is at {}", units.point(mesh.nodes[nearest]));
    Err(InputError::new(format!("{key}.point"), message, help))
}

/// Returns `node`, unless another body also has a node that is `near`.
fn only(
    mesh: &Mesh,
    node: usize,
    near: impl Fn(usize) -> bool,
    units: &UnitSystem,
    key: &str,
) -> Result<usize, InputError> {
    let bodies = mesh.bodies();
    let of = bodies.of_nodes();
    let Some(other) = (0..mesh.nodes.len()).find(|&other| of[other] != of[node] && near(other)) else {
        return Ok(node);
    };
    let names = [node, other].map(|node| bodies.label(of[node]));
    let message = format!("{} and {} both have a node at {}", names[0], names[1], units.point(mesh.nodes[node]));
    let help = "name a boundary in place of the point: those are of one body";
    Err(InputError::new(format!("{key}.point"), message, help))
}

/// Fails unless a vector has as many components as the body has dimensions.
pub(super) fn suits(mesh: &Mesh, vector: Vector, key: &str) -> Result<(), InputError> {
    counts(key, vector.dimension(), mesh.dimension, "dimensions")
}

/// Fails unless a displacement or force at `key` has as many components as those of the mesh.
pub(super) fn counts_as_force(mesh: &Mesh, key: &str, count: usize) -> Result<(), InputError> {
    let what = if mesh.components() == mesh.dimension { "dimensions" } else { "components of displacements" };
    counts(key, count, mesh.components(), what)
}

fn counts(key: &str, count: usize, expected: usize, what: &str) -> Result<(), InputError> {
    if count == expected {
        return Ok(());
    }
    let name = key.rsplit('.').next().unwrap_or(key);
    let message = format!("{name} has {count} components, but the body has {expected} {what}");
    Err(InputError::new(key, message, if expected == 2 { "give [x, y]" } else { "give [x, y, z]" }))
}

/// Returns the outward unit normal of `boundary` at each node of the mesh, the direction of the sum over its facets at
/// the node; `None` off the boundary.
pub(super) fn normals(mesh: &Mesh, boundary: &Boundary) -> Vec<Option<[f64; 3]>> {
    let mut sums = vec![[0.0; 3]; mesh.nodes.len()];
    for facet in &boundary.facets {
        for (&node, area) in facet.iter().zip(facet_normals(mesh, facet)) {
            sums[node].iter_mut().zip(area).for_each(|(sum, a)| *sum += a);
        }
    }
    // + 0.0 turns -0 into 0.
    sums.into_iter().map(|sum| (sum != [0.0; 3]).then(|| unit(sum).map(|c| c + 0.0))).collect()
}

/// Returns the `boundary`, which is called `name` at `key`, if it has an area; the axis of a body of revolution has
/// none.
pub(super) fn with_area<'a>(
    mesh: &Mesh,
    name: &str,
    key: &str,
    boundary: &'a Boundary,
    what: &str,
) -> Result<&'a Boundary, InputError> {
    if area(mesh, boundary) > 0.0 {
        return Ok(boundary);
    }
    let message = format!("`{name}` is the axis of the body, which has no area for {what}");
    Err(InputError::new(key, message, "name another boundary, or a point"))
}

/// Returns an error if a `vector`, which the key gives a coupling of a body of revolution, is not along the axis.
pub(super) fn along_the_axis(mesh: &Mesh, what: &str, vector: [f64; 3], key: &str) -> Result<(), InputError> {
    if mesh.geometry.is_revolved() && (vector[0] != 0.0 || vector[2] != 0.0) {
        let message =
            format!("the {what} has a component across the axis, but a body of revolution moves along its axis only");
        return Err(InputError::new(key, message, "give [0, y], with torsion [0, y, 0]"));
    }
    Ok(())
}

/// Extends components to three dimensions.
pub(super) fn in_space(mesh: &Mesh, components: &[f64], key: &str) -> Result<[f64; 3], InputError> {
    counts_as_force(mesh, key, components.len())?;
    Ok([0, 1, 2].map(|c| components.get(c).copied().unwrap_or(0.0)))
}
