//! Rigid obstacles as seen from the nodes of a boundary. In front of a body of revolution they are bodies of revolution about
//! the same axis, x = 0, and keep this symmetry as they move.

use std::sync::Arc;

use super::description::{GapDirection, Obstacle, Place, Rotation, SKEW, Shape};
use super::facing::faces_away;
use super::gap_table::{GapTable, TableError};
use super::surface::{SolidCone, Surface};
use super::tree::Bounds;
use super::triangles::{Chords, SurfaceError, Triangles};
use crate::algebra::vector::{Vector, across, axis_across, cross, dot, minus, norm, plus, unit};
use crate::body::mesh::{Boundary, Mesh};

/// An obstacle in front of a boundary. Since displacements are small, gaps are measured once, in the undeformed state.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedObstacle {
    surface: Surface,
    direction: GapDirection,
    /// The size of the boundary, m.
    extent: f64,
    /// Unit vector out of the body towards the obstacle.
    pub normal: [f64; 3],
    /// Orthonormal vectors along the obstacle: the positive directions of `w_t` and `w_o`. In two dimensions the second
    /// is normal to the plane.
    pub tangents: [[f64; 3]; 2],
}

/// An obstacle as seen from one node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facing {
    /// The distance along the normal, m; NaN if the obstacle is not in front of the node.
    pub gap: f64,
    /// Unit vector towards the obstacle.
    pub normal: [f64; 3],
    /// Orthonormal vectors at right angles to the normal.
    pub tangents: [[f64; 3]; 2],
    /// The direction into the obstacle, normal to the surface in front of the node, with a component 1 along the node's
    /// normal: if the surface moves by `d`, the gap changes by `d · inward`.
    pub inward: [f64; 3],
}

impl Facing {
    /// Returns the slope of the surface in front of the node relative to the node's normal: the tangent of the angle.
    pub fn slope(&self) -> f64 {
        norm(minus(self.inward, self.normal))
    }
}

/// A cylinder or sphere with the body outside.
pub(crate) struct Round {
    /// The radius, m.
    pub radius: f64,
    /// The centre, or a point of the axis, m.
    pub centre: [f64; 3],
    /// The axis of a cylinder.
    pub axis: Option<[f64; 3]>,
}

impl PlacedObstacle {
    /// Returns the geometry of a cylinder or a sphere; `None` for other shapes.
    pub(crate) fn roundness(&self) -> Option<Round> {
        match self.surface {
            Surface::Round { radius, apex, axis } if radius > 0.0 => {
                Some(Round { radius, centre: plus(apex, radius, self.normal), axis })
            }
            _ => None,
        }
    }

    /// Places the obstacle `given`, which is valid, in front of `boundary`.
    ///
    /// The default normal is the mean outward normal of the boundary. The default first tangent is, in two dimensions,
    /// the normal turned by +90°, which is +x above a foundation; in three dimensions, the projection on the tangent
    /// plane of x, or of another axis that is closer to that plane. The second tangent is normal × first tangent.
    ///
    /// # Errors
    /// If there is no mean normal, the shape does not suit the dimension, or a file cannot be used.
    pub fn new(mesh: &Mesh, boundary: &Boundary, given: &Obstacle) -> Result<Self, ObstacleError> {
        if mesh.dimension == 2 {
            lies_in_plane(given)?;
        } else if let Some(name) = given.plane_vector() {
            return Err(ObstacleError::PlaneVector(name));
        }
        let along = |given: Option<Vector>| given.map(|vector| unit(vector.components()));
        let normal = along(given.normal).or_else(|| mean_normal(mesh, boundary)).ok_or(ObstacleError::NoNormal)?;
        let first = along(given.tangent).unwrap_or_else(|| match mesh.dimension {
            2 => [-normal[1], normal[0], 0.0],
            _ => first_tangent(normal),
        });
        let axis = |given: Option<Vector>| match (along(given), mesh.dimension) {
            (None, 2) => Ok([0.0, 0.0, 1.0]),
            (None, _) => Err(ObstacleError::NoAxis),
            (Some(axis), _) if dot(axis, normal).abs() > SKEW => Err(ObstacleError::SkewAxis),
            (Some(axis), _) => Ok(axis),
        };
        let round = |radius: f64, place: Place, axis| Surface::Round { radius, apex: place.apex(radius, normal), axis };
        if mesh.geometry.is_revolved() {
            moves_along_axis(given, normal)?;
        }
        // Shapes of three dimensions, each with `true` if it is about the axis of a body of revolution.
        let in_space = match given.shape {
            Shape::Sphere { radius, place } => Some(("sphere", is_centred(place, radius, normal))),
            Shape::Socket { radius, place } => Some(("socket", is_centred(place, -radius, normal))),
            Shape::Cone { apex, axis, .. } => Some(("cone", is_about_axis(apex, along(axis).unwrap_or(normal)))),
            _ => None,
        };
        match (in_space, mesh.geometry.is_revolved()) {
            (Some((shape, false)), true) => return Err(ObstacleError::OffAxis(shape)),
            (Some(_), true) => {}
            (Some((shape, _)), _) if mesh.dimension == 2 => return Err(ObstacleError::OnlyInSpace(shape)),
            _ if mesh.dimension == 2 && matches!(given.shape, Shape::Surface { .. }) => {
                return Err(ObstacleError::OnlyInSpace("surface"));
            }
            _ => {}
        }
        let surface = match &given.shape {
            Shape::Plane { gap } => {
                let along = boundary.nodes().into_iter().map(|node| dot(normal, mesh.nodes[node]));
                Surface::Plane { level: along.fold(f64::NEG_INFINITY, f64::max), gap: *gap }
            }
            Shape::PlaneThrough { through } => Surface::Plane { level: dot(normal, through.components()), gap: 0.0 },
            Shape::Cylinder { radius, place, axis: given } => round(*radius, *place, Some(axis(*given)?)),
            Shape::Bore { radius, place, axis: given } => round(-radius, *place, Some(axis(*given)?)),
            Shape::Sphere { radius, place } => round(*radius, *place, None),
            Shape::Socket { radius, place } => round(-radius, *place, None),
            Shape::Cone { apex, half_angle, axis: given } => {
                let axis = along(*given).unwrap_or(normal);
                if dot(axis, normal) <= SKEW {
                    return Err(ObstacleError::ConeTowardsBody);
                }
                Surface::Cone(SolidCone { apex: apex.components(), axis, half_angle: *half_angle })
            }
            Shape::Wedge { apex, angle, axis: given } => {
                let aside = unit(cross(axis(*given)?, normal));
                Surface::Wedge { apex: apex.components(), aside, slope: angle.tan() }
            }
            Shape::Formula(formula) => Surface::Formula(formula.clone()),
            Shape::Table { file, scale } => Surface::Table(GapTable::read(file, *scale)?),
            Shape::Surface { file, scale } => Surface::Triangles(Arc::new(Triangles::read(file, *scale)?)),
        };
        Ok(PlacedObstacle {
            surface,
            direction: given.direction,
            extent: Bounds::of(&mesh.points(&boundary.nodes())).extent(),
            normal,
            tangents: [first, cross(normal, first)],
        })
    }

    /// Returns the obstacle as seen from a node at `x` (m).
    pub fn at(&self, x: [f64; 3]) -> Facing {
        match self.direction {
            GapDirection::Normal => {
                let gap = self.surface.along(self.normal, x, self.normal, x);
                let inward = self.inward(x, (gap, self.normal));
                let closing = dot(inward, self.normal);
                Facing { gap, normal: self.normal, tangents: self.tangents, inward: inward.map(|c| c / closing) }
            }
            GapDirection::Nearest => {
                let (gap, normal) = self.surface.nearest(self.normal, x);
                let first = across(self.tangents[0], normal);
                // Around an axis the tangent turns with the normal; after a quarter of a turn its projection points
                // backwards.
                let back = dot(self.normal, normal) < 0.0 && self.surface.goes_round_along(self.tangents[0]);
                let first = match (norm(first) > SKEW, back) {
                    (true, false) => unit(first),
                    (true, true) => unit(first).map(|c| -c),
                    // If the first tangent has become the normal, the second one determines it.
                    (false, _) => cross(self.tangents[1], normal),
                };
                Facing { gap, normal, tangents: [first, cross(normal, first)], inward: normal }
            }
        }
    }

    /// Returns the obstacle as seen from a node at `x` (m) on the edge of a node in front of the obstacle, see
    /// [`PlacedObstacle::in_front`].
    pub(crate) fn seen_from(&self, x: [f64; 3]) -> Facing {
        self.in_front(self.at(x))
    }

    /// Returns `true` if the obstacle is in front of all nodes at these `distances` (m). A node without the obstacle in
    /// front of it has at least the size of the boundary as its distance. A plane is in front of every node.
    pub fn is_in_front_of_all(&self, distances: &[f64]) -> bool {
        self.is_plane() || distances.iter().all(|distance| *distance < self.extent)
    }

    /// Completes the `facing` of a node that the obstacle reaches later: until then its distance is taken to be the
    /// size of the boundary.
    pub(super) fn in_front(&self, facing: Facing) -> Facing {
        if facing.gap.is_finite() { facing } else { Facing { gap: self.extent, inward: facing.normal, ..facing } }
    }

    /// Returns the distance (m) along `n` from `x`, a point transformed to the obstacle at rest whose reference
    /// position is `reference`; this is the gap without linearisation.
    pub fn distance(&self, x: [f64; 3], n: [f64; 3], reference: [f64; 3]) -> f64 {
        self.surface.along(self.normal, x, n, reference)
    }

    /// Returns the distance (m) from `x` (m), transformed to the obstacle at rest with the reference position
    /// `reference`, to the nearest point, negative inside, and the unit vector of its direction; for a field of gaps,
    /// along its normal.
    ///
    /// NaN beyond the rim of a bounded surface.
    pub fn nearest(&self, x: [f64; 3], reference: [f64; 3]) -> (f64, [f64; 3]) {
        match self.surface {
            Surface::Formula(_) | Surface::Table(_) => (self.distance(x, self.normal, reference), self.normal),
            _ => self.surface.nearest(self.normal, x),
        }
    }

    /// Returns `true` if the surface is bounded, so that a body can be beside it.
    pub fn is_bounded(&self) -> bool {
        match self.surface {
            Surface::Round { radius, .. } => radius > 0.0,
            Surface::Triangles(_) => true,
            _ => false,
        }
    }

    /// Returns the size of the boundary, m.
    pub fn extent(&self) -> f64 {
        self.extent
    }

    /// Returns `true` if gaps are measured along one normal.
    pub fn has_one_normal(&self) -> bool {
        self.direction == GapDirection::Normal
    }

    /// Returns `true` if it presses every node along the same normal as the `other` obstacle.
    pub(crate) fn presses_as(&self, other: &PlacedObstacle) -> bool {
        self.has_one_normal() && other.has_one_normal() && norm(minus(self.normal, other.normal)) <= SKEW
    }

    /// Returns `true` if the surface is a plane.
    pub fn is_plane(&self) -> bool {
        matches!(self.surface, Surface::Plane { .. })
    }

    /// Returns `true` if a rotation about the unit vector `axis` through the point `through` (m) maps the obstacle to
    /// itself, within rounding.
    pub fn is_the_same_about(&self, axis: [f64; 3], through: [f64; 3]) -> bool {
        self.surface.is_the_same_about(self.normal, axis, through)
    }

    /// Finds the first node of `boundary` at which the normal does not point out of the body on every facet there.
    pub fn faces_away(&self, mesh: &Mesh, boundary: &Boundary) -> Option<usize> {
        faces_away(mesh, boundary, |node| self.at(mesh.nodes[node]).normal)
    }

    /// Returns the reason why a node without a distance from the obstacle is an error, and the correction; `None` if
    /// such a node is simply not in front of the obstacle.
    pub fn out_of_reach(&self) -> Option<(&'static str, &'static str)> {
        match &self.surface {
            Surface::Table(_) => {
                Some(("the table of gaps does not reach", "extend the table; outside it nothing is assumed"))
            }
            Surface::Formula(_) => {
                Some(("the formula has no finite value at", "mend the formula, or use a smaller boundary"))
            }
            surface => surface.surrounds().then_some((
                "the bore or socket is narrower than the body at",
                "use a larger radius, a smaller boundary or direction = \"nearest\"",
            )),
        }
    }

    /// Returns `true` for a bore or a socket, which a line can miss only inside the obstacle.
    pub(super) fn surrounds(&self) -> bool {
        self.surface.surrounds()
    }

    /// Returns `true` if `x` (m), transformed to the obstacle at rest with the reference position `reference`, is
    /// inside the obstacle but its depth along `n` is undefined.
    pub(super) fn swallows(&self, x: [f64; 3], n: [f64; 3], reference: [f64; 3]) -> bool {
        self.distance(x, n, reference).is_nan() && self.surface.swallows(self.normal, x, n, reference)
    }

    /// Returns the slope of the surface in front of a point at `x` (m) in the obstacle at rest, relative to the unit
    /// vector `n`: the tangent of the angle; NaN if the obstacle is not in front of the point.
    pub(super) fn slope(&self, x: [f64; 3], n: [f64; 3], reference: [f64; 3]) -> f64 {
        let gap = self.distance(x, n, reference);
        let inward = self.inward(x, (gap, n));
        let closing = dot(inward, n);
        norm(minus(inward.map(|c| c / closing), n))
    }

    /// Returns a vector into the obstacle at the point where the line from `x` along `n` meets it after `gap`.
    fn inward(&self, x: [f64; 3], (gap, n): (f64, [f64; 3])) -> [f64; 3] {
        let [t, o] = self.tangents;
        // Difference steps of 1e-6 give a slope with half the digits of double precision.
        self.surface.inward([self.normal, t, o], x, (gap, n), 1e-6 * self.extent)
    }

    /// Returns the surface if it consists of triangles.
    pub(super) fn surface_of_triangles(&self) -> Option<&Triangles> {
        match &self.surface {
            Surface::Triangles(triangles) => Some(triangles),
            _ => None,
        }
    }

    /// Returns how far the curved surface that triangles approximate is beyond them where lines from `points` along
    /// unit vectors meet them, m; nothing for other surfaces.
    pub(crate) fn sagittas(&self, points: impl Iterator<Item = ([f64; 3], [f64; 3])>) -> Vec<f64> {
        let Some(surface) = self.surface_of_triangles() else { return Vec::new() };
        let mut chords = Chords::new(surface);
        points.filter_map(|(x, n)| surface.entry(x, n)).map(|entry| chords.sagitta(entry.triangle)).collect()
    }

    /// Returns the number of triangles of the surface, if it consists of triangles.
    pub fn triangles(&self) -> Option<usize> {
        self.surface_of_triangles().map(Triangles::count)
    }
}

/// Fails if vectors of an obstacle of a plane body leave its plane.
fn lies_in_plane(given: &Obstacle) -> Result<(), ObstacleError> {
    let leaves = |vector: Vector| vector.components()[2] != 0.0;
    let upright = |axis: Vector| norm(cross(unit(axis.components()), [0.0, 0.0, 1.0])) <= SKEW;
    let (point, axis) = given.shape.stands();
    let in_plane = matches!(given.shape, Shape::Cone { .. });
    let turning = given.rotation.as_ref().is_some_and(|Rotation { axis, .. }| axis.is_some_and(|axis| !upright(axis)));
    for (name, leaves) in [
        ("the normal", given.normal.is_some_and(leaves)),
        ("the tangent", given.tangent.is_some_and(leaves)),
        ("the place", point.is_some_and(|(_, point)| leaves(point))),
        // The axis of a cone in front of a body of revolution lies in the plane.
        ("the axis", axis.is_some_and(|axis| if in_plane { leaves(axis) } else { !upright(axis) })),
        ("the translation", given.translation.iter().flatten().any(|(_, to)| leaves(*to))),
        ("the rotation", turning),
    ] {
        if leaves {
            return Err(ObstacleError::OutOfPlane(name));
        }
    }
    Ok(())
}

fn mean_normal(mesh: &Mesh, boundary: &Boundary) -> Option<[f64; 3]> {
    let (mut sum, mut total) = ([0.0; 3], 0.0);
    for facet in &boundary.facets {
        let area = mesh.area_vector(facet);
        sum.iter_mut().zip(area).for_each(|(sum, c)| *sum += c);
        total += norm(area);
    }
    // + 0.0 turns -0 into 0.
    (norm(sum) > 1e-9 * total).then(|| unit(sum).map(|c| c + 0.0))
}

/// Returns the projection, on the plane at right angles to `normal`, of the coordinate axis closest to that plane; x is
/// preferred to y and y to z, whatever the rounding of the normal.
pub(super) fn first_tangent(normal: [f64; 3]) -> [f64; 3] {
    let closer = |c: usize, best: usize| normal[c].abs() < normal[best].abs() - 1e-9;
    let closest = [1, 2].into_iter().fold(0, |best, c| if closer(c, best) { c } else { best });
    axis_across(closest, normal)
}

/// The error of an obstacle that does not fit its boundary.
#[derive(Debug, thiserror::Error)]
pub enum ObstacleError {
    /// The boundary has no mean normal, because it is closed or symmetric.
    #[error("the boundary has no mean normal to face an obstacle with")]
    NoNormal,
    /// A vector leaves the plane of a two-dimensional body.
    #[error("{0} of the obstacle leaves the plane of the body, which has two dimensions")]
    OutOfPlane(&'static str),
    /// A vector has two components in three dimensions.
    #[error("{0} of the obstacle has two components, but the body has three dimensions")]
    PlaneVector(&'static str),
    /// The shape, for example a sphere, needs three dimensions.
    #[error("the obstacle is a {0}, but the body has two dimensions")]
    OnlyInSpace(&'static str),
    /// A cylinder, bore or wedge in three dimensions has no axis.
    #[error("a cylinder, bore or wedge in three dimensions needs an axis")]
    NoAxis,
    /// The axis is not at right angles to the normal.
    #[error("the axis of the obstacle is not at right angles to its normal")]
    SkewAxis,
    /// The cone opens towards the body.
    #[error("the axis of the cone points into the body, or along its surface")]
    ConeTowardsBody,
    /// A sphere, socket or cone in front of a body of revolution does not have the same axis.
    #[error("the obstacle is a {0} that is not about the axis x = 0 of the body")]
    OffAxis(&'static str),
    /// An obstacle in front of a body of revolution turns; it would lose the symmetry or rub across the section.
    #[error("the obstacle turns, but the body is axisymmetric")]
    TurnsRound,
    /// The radius of an obstacle of revolution changes.
    #[error("the obstacle moves away from the axis of the body, or towards it, by its {0}")]
    MovesAside(&'static str),
    /// The table of gaps cannot be used.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The file of triangles cannot be used.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
}

impl ObstacleError {
    /// Returns the correction, in words.
    pub fn help(&self) -> &'static str {
        match self {
            ObstacleError::NoNormal => "give the obstacle a `normal`",
            ObstacleError::OutOfPlane(_) => "let vectors have two components, and axes be [0, 0, 1] or left out",
            ObstacleError::PlaneVector(_) => "give [x, y, z], and points of a translation as [time, x, y, z]",
            ObstacleError::OnlyInSpace(_) => {
                "use a cylinder, bore or wedge, whose axis is across the plane, or a table"
            }
            ObstacleError::NoAxis => "give an axis, such as [0, 1, 0]",
            ObstacleError::SkewAxis => "turn the axis, or give the obstacle a normal at right angles to it",
            ObstacleError::ConeTowardsBody => "let the axis point from the tip into the cone, out of the body",
            ObstacleError::OffAxis(_) => {
                "give a point of the axis, [0, y], for its `center` or `apex`, and a cone the axis [0, 1] or [0, -1]; a cylinder, \
                 bore or wedge may be anywhere, and is a ring"
            }
            ObstacleError::TurnsRound => {
                "remove motion.rotation: with material.plane = \"axisymmetric-torsion\" the body turns by a coupling in place of \
                 the obstacle, and what turns about another axis is no obstacle of revolution"
            }
            ObstacleError::MovesAside(_) => {
                "let it move along y: by motion.translation, or by approach with the normal [0, 1] or [0, -1]; an interference of \
                 radii is a negative gap"
            }
            ObstacleError::Table(_) => {
                "give a CSV file with the header x,gap or x,y,gap and numbers in m or as [units] says"
            }
            ObstacleError::Surface(_) => {
                "give an STL file or a Gmsh file whose faces are counterclockwise seen from the body"
            }
        }
    }
}

/// Checks that an obstacle of revolution with the normal `normal` keeps its symmetry and its radius as it moves.
fn moves_along_axis(given: &Obstacle, normal: [f64; 3]) -> Result<(), ObstacleError> {
    if given.rotation.is_some() {
        return Err(ObstacleError::TurnsRound);
    }
    if given.translation.iter().flatten().any(|(_, to)| to.components()[0] != 0.0) {
        return Err(ObstacleError::MovesAside("translation"));
    }
    let moves = given.approach.iter().flatten().any(|point| point[1] != 0.0);
    if moves && normal[0].abs() > SKEW { Err(ObstacleError::MovesAside("approach")) } else { Ok(()) }
}

/// Returns `true` if the centre of a sphere or socket is on the axis x = 0.
fn is_centred(place: Place, radius: f64, normal: [f64; 3]) -> bool {
    plus(place.apex(radius, normal), radius, normal)[0].abs() <= SKEW * radius.abs()
}

/// Returns `true` if the axis of a cone is x = 0.
fn is_about_axis(apex: Vector, axis: [f64; 3]) -> bool {
    apex.components()[0] == 0.0 && axis[0].abs() <= SKEW
}

#[cfg(test)]
mod tests {
    use super::first_tangent;

    #[test]
    fn rounding_of_the_normal_chooses_no_tangent() {
        for off in [0.0, 1e-15, 1e-12] {
            assert!((first_tangent([off, 0.0, -1.0])[0] - 1.0).abs() < 1e-9);
            assert!((first_tangent([0.0, off, -1.0])[0] - 1.0).abs() < 1e-9);
        }
        assert!((first_tangent([0.1, 0.0, -1.0])[1] - 1.0).abs() < 1e-9);
    }
}
