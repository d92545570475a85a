//! Rigid obstacles: what each node of a boundary sees of them.

use std::sync::Arc;

use super::cone::SolidCone;
use super::description::{GapDirection, Obstacle, Place, Rotation, SKEW, Shape};
use super::gap_table::GapTable;
use super::obstacle_error::ObstacleError;
use super::revolution::{centred, is_about_axis, moves_along_axis};
use super::surface::Surface;
use super::triangles::Triangles;
use crate::algebra::vector::{Vector, across, axis_across, cross, dot, minus, norm, plus, unit};
use crate::body::mesh::{Boundary, Geometry, Mesh};

/// An obstacle in front of a part of the boundary. Small displacements: gaps are measured once, in
/// the undeformed state.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedObstacle {
    surface: Surface,
    direction: GapDirection,
    /// The size of the boundary, m.
    extent: f64,
    /// Unit vector out of the body, towards the obstacle.
    pub normal: [f64; 3],
    /// Orthonormal vectors along the obstacle: the positive directions of `w_t` and `w_o`. In two dimensions
    /// the second is across the plane.
    pub tangents: [[f64; 3]; 2],
}

/// What one node sees of an obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facing {
    /// The distance along the normal, m; NaN if the obstacle does not reach there.
    pub gap: f64,
    /// Unit vector towards the obstacle.
    pub normal: [f64; 3],
    /// Orthonormal vectors at right angles to it.
    pub tangents: [[f64; 3]; 2],
    /// At right angles to the surface in front of the node, into the obstacle, with a component 1 along the
    /// normal: a surface that moves by `d` adds `d · inward` to the gap.
    pub inward: [f64; 3],
}

impl Facing {
    /// The slope of the surface in front of the node, against its normal: the tangent of the angle.
    pub fn slope(&self) -> f64 {
        norm(minus(self.inward, self.normal))
    }
}

/// A round obstacle that the body is outside of.
pub(crate) struct Round {
    /// m.
    pub radius: f64,
    /// The centre, or a point of the axis, m.
    pub centre: [f64; 3],
    /// The axis of a cylinder.
    pub axis: Option<[f64; 3]>,
}

impl PlacedObstacle {
    /// A cylinder or a sphere.
    pub(crate) fn roundness(&self) -> Option<Round> {
        match self.surface {
            Surface::Round { radius, apex, axis } if radius > 0.0 => {
                Some(Round { radius, centre: plus(apex, radius, self.normal), axis })
            }
            _ => None,
        }
    }

    /// The obstacle that `given`, which is sound, puts in front of `boundary`. Without a normal it faces the mean outward
    /// normal of the boundary. Without a first tangent, that is in two dimensions the normal turned by
    /// +90°, which is +x above a foundation; in three it is the projection of x on the tangent plane, or of
    /// the axis that is closest to that plane where this is another. The second tangent is normal × first.
    ///
    /// # Errors
    /// When there is no mean normal, the shape does not suit the dimension, or a file cannot be used.
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
        let flat = mesh.dimension == 2;
        let round_about = mesh.geometry == Geometry::Axisymmetric;
        if round_about {
            moves_along_axis(given, normal)?;
        }
        let surface = match &given.shape {
            Shape::Plane { gap } => {
                let along = boundary.nodes().into_iter().map(|node| dot(normal, mesh.nodes[node]));
                Surface::Plane { level: along.fold(f64::NEG_INFINITY, f64::max), gap: *gap }
            }
            Shape::PlaneThrough { through } => Surface::Plane { level: dot(normal, through.components()), gap: 0.0 },
            Shape::Cylinder { radius, place, axis: given } => round(*radius, *place, Some(axis(*given)?)),
            Shape::Bore { radius, place, axis: given } => round(-radius, *place, Some(axis(*given)?)),
            Shape::Sphere { place, radius } if round_about && centred(place.apex(*radius, normal), *radius, normal) => {
                round(*radius, *place, None)
            }
            Shape::Socket { place, radius } if round_about && centred(place.apex(-radius, normal), -radius, normal) => {
                round(-radius, *place, None)
            }
            Shape::Sphere { .. } if round_about => return Err(ObstacleError::OffAxis("sphere")),
            Shape::Socket { .. } if round_about => return Err(ObstacleError::OffAxis("socket")),
            Shape::Sphere { .. } if flat => return Err(ObstacleError::OnlyInSpace("sphere")),
            Shape::Socket { .. } if flat => return Err(ObstacleError::OnlyInSpace("socket")),
            Shape::Cone { apex, axis: given, .. }
                if round_about && !is_about_axis(*apex, along(*given).unwrap_or(normal)) =>
            {
                return Err(ObstacleError::OffAxis("cone"));
            }
            Shape::Cone { .. } if flat && !round_about => return Err(ObstacleError::OnlyInSpace("cone")),
            Shape::Surface { .. } if flat => return Err(ObstacleError::OnlyInSpace("surface")),
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
        let extent = extent(mesh, boundary);
        Ok(PlacedObstacle {
            surface,
            direction: given.direction,
            extent,
            normal,
            tangents: [first, cross(normal, first)],
        })
    }

    /// What a node at `x` (m) sees.
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
                // About an axis it goes round with the normal, where its projection points back after a quarter of a turn.
                let back = dot(self.normal, normal) < 0.0 && self.surface.goes_round_along(self.tangents[0]);
                let first = match (norm(first) > SKEW, back) {
                    (true, false) => unit(first),
                    (true, true) => unit(first).map(|c| -c),
                    // A tangent that has become the normal gives way to the other one.
                    (false, _) => cross(self.tangents[1], normal),
                };
                Facing { gap, normal, tangents: [first, cross(normal, first)], inward: normal }
            }
        }
    }

    /// What a node at `x` (m) sees that is of the edge of one in front of the obstacle, see [`PlacedObstacle::in_front`].
    pub(crate) fn seen_from(&self, x: [f64; 3]) -> Facing {
        self.in_front(self.at(x))
    }

    /// Whether nodes at these distances (m) have the obstacle in front of them: others are taken to be as far as the boundary is long,
    /// or are as far. A plane is in front of every node.
    pub fn is_in_front_of_all(&self, distances: &[f64]) -> bool {
        self.is_plane() || distances.iter().all(|distance| *distance < self.extent)
    }

    /// What a node with `facing` sees of an obstacle that reaches it once: as long as it does not it is taken to be as far as its
    /// boundary is long.
    pub(super) fn in_front(&self, facing: Facing) -> Facing {
        if facing.gap.is_finite() { facing } else { Facing { gap: self.extent, inward: facing.normal, ..facing } }
    }

    /// The distance (m) along `n` of a point at `x` in the obstacle at rest that came from `reference`; the
    /// gap that is not linearised.
    pub fn distance(&self, x: [f64; 3], n: [f64; 3], reference: [f64; 3]) -> f64 {
        self.surface.along(self.normal, x, n, reference)
    }

    /// The distance (m) from a point at `x` (m) in the obstacle at rest that came from `reference` to the nearest point, negative
    /// inside, and the unit vector in which that is; of a field of gaps along its normal. NaN beyond the rim of a surface that ends.
    pub fn nearest(&self, x: [f64; 3], reference: [f64; 3]) -> (f64, [f64; 3]) {
        match self.surface {
            Surface::Formula(_) | Surface::Table(_) => (self.distance(x, self.normal, reference), self.normal),
            _ => self.surface.nearest(self.normal, x),
        }
    }

    /// Whether it ends somewhere aside: a body beside it is not in front of it.
    pub fn is_bounded(&self) -> bool {
        match self.surface {
            Surface::Round { radius, .. } => radius > 0.0,
            Surface::Triangles(_) => true,
            _ => false,
        }
    }

    /// The size of its boundary, m.
    pub fn extent(&self) -> f64 {
        self.extent
    }

    /// Whether gaps are measured along one normal.
    pub fn has_one_normal(&self) -> bool {
        self.direction == GapDirection::Normal
    }

    /// Whether it presses every node along the same normal as the `other` obstacle does.
    pub(crate) fn presses_as(&self, other: &PlacedObstacle) -> bool {
        self.has_one_normal() && other.has_one_normal() && norm(minus(self.normal, other.normal)) <= SKEW
    }

    /// Whether its surface is a plane.
    pub fn is_plane(&self) -> bool {
        matches!(self.surface, Surface::Plane { .. })
    }

    /// Whether it is the same when it has turned about the unit vector `axis` `through` a point (m), but for rounding.
    pub fn is_the_same_about(&self, axis: [f64; 3], through: [f64; 3]) -> bool {
        self.surface.is_the_same_about(self.normal, axis, through)
    }

    /// The first node of `boundary` at which the normal does not point out of the body, on each facet there.
    pub fn faces_away(&self, mesh: &Mesh, boundary: &Boundary) -> Option<usize> {
        boundary.facets.iter().find_map(|facet| {
            let outwards = mesh.area_vector(facet);
            facet.iter().copied().find(|&node| dot(outwards, self.at(mesh.nodes[node]).normal) <= 0.0)
        })
    }

    /// Why a node that has no distance from the obstacle may not stand there, and what helps, in words; nothing where such a
    /// node is simply not in front of it.
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

    /// Whether a line can miss it only inside it: a bore or a socket.
    pub(super) fn surrounds(&self) -> bool {
        self.surface.surrounds()
    }

    /// Whether a point at `x` (m) in the obstacle at rest that came from `reference` is inside it, but has no distance along `n`
    /// that tells how deep.
    pub(super) fn swallows(&self, x: [f64; 3], n: [f64; 3], reference: [f64; 3]) -> bool {
        self.distance(x, n, reference).is_nan() && self.surface.swallows(self.normal, x, n, reference)
    }

    /// The slope of the surface in front of a point at `x` (m) in the obstacle at rest, against the unit vector `n`: the tangent
    /// of the angle; NaN if the obstacle is not in front of it.
    pub(super) fn slope(&self, x: [f64; 3], n: [f64; 3], reference: [f64; 3]) -> f64 {
        let gap = self.distance(x, n, reference);
        let inward = self.inward(x, (gap, n));
        let closing = dot(inward, n);
        norm(minus(inward.map(|c| c / closing), n))
    }

    /// A vector into the obstacle where the line from `x` along `n` meets it after `gap`.
    fn inward(&self, x: [f64; 3], (gap, n): (f64, [f64; 3])) -> [f64; 3] {
        let [t, o] = self.tangents;
        // Steps of 1e-6 leave half the digits of a slope in double precision.
        self.surface.inward([self.normal, t, o], x, (gap, n), 1e-6 * self.extent)
    }

    /// Its surface, if that is of triangles.
    pub(super) fn surface_of_triangles(&self) -> Option<&Triangles> {
        match &self.surface {
            Surface::Triangles(triangles) => Some(triangles),
            _ => None,
        }
    }

    /// The number of triangles of a surface.
    pub fn triangles(&self) -> Option<usize> {
        self.surface_of_triangles().map(Triangles::count)
    }
}

/// Refuses vectors of an obstacle of a plane body that leave its plane.
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
        // A cone in front of a body of revolution has its axis in the plane.
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

/// The longest side of the box around a boundary, m.
fn extent(mesh: &Mesh, boundary: &Boundary) -> f64 {
    let points = mesh.points(&boundary.nodes());
    let side = |c: usize| {
        let along = || points.iter().map(|x| x[c]);
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    };
    (0..3).map(side).fold(0.0, f64::max)
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

/// The projection on the plane at right angles to `normal` of the axis that is closest to it, x before y
/// before z.
pub(super) fn first_tangent(normal: [f64; 3]) -> [f64; 3] {
    let closest = [1, 2].into_iter().fold(0, |best, c| if normal[c].abs() < normal[best].abs() { c } else { best });
    axis_across(closest, normal)
}
