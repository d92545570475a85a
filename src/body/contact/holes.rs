//! Holes of a surface of triangles in front of a boundary.

use super::motion::ObstacleMotion;
use super::obstacle::PlacedObstacle;
use super::tree::Bounds;
use super::triangles::Hole;
use crate::algebra::vector::{dot, minus, plus};
use crate::body::mesh::{Boundary, Mesh};

/// Returns the holes of `obstacle`, if that is a surface of triangles, that are in front of `boundary` at 0 or at
/// `times` (s) as the obstacle moves by `motion`.
///
/// Holes that another part of the surface hides from the boundary are left out.
pub fn holes_in_front_of(
    mesh: &Mesh,
    boundary: &Boundary,
    (obstacle, motion): &(PlacedObstacle, ObstacleMotion),
    times: &[f64],
) -> Vec<Hole> {
    let Some(triangles) = obstacle.surface_of_triangles() else { return Vec::new() };
    let facets: Vec<Vec<[f64; 3]>> = boundary.facets.iter().map(|facet| mesh.points(facet)).collect();
    let longest = facets.iter().map(|points| Bounds::of(points).extent()).fold(0.0, f64::max);
    let mut holes = triangles.holes(longest);
    let is_seen_at = |hole: &Hole, t: f64| {
        let place = |x: &[f64; 3]| motion.back(t, *x, obstacle.normal).0;
        let [low, high] = hole.bounds;
        if !obstacle.has_one_normal() {
            return facets.iter().any(|points| {
                let points: Vec<[f64; 3]> = points.iter().map(place).collect();
                let around = Bounds::of(&points);
                let distances = points.iter().map(|x| obstacle.nearest(*x, *x).0.abs());
                let distance = distances.filter(|distance| distance.is_finite()).fold(0.0, f64::max);
                around.grown(distance + around.extent()).overlaps(&Bounds { low, high })
            });
        }
        let [normal, first, second] =
            [obstacle.normal, obstacle.tangents[0], obstacle.tangents[1]].map(|axis| motion.back(t, [0.0; 3], axis).1);
        let before = plus(hole.middle, -2.0 * triangles.extent(), normal);
        let way = dot(minus(hole.middle, before), normal);
        if triangles.entry(before, normal).is_some_and(|entry| entry.distance < way - hole.size) {
            return false;
        }
        let shadow = |points: Vec<[f64; 3]>| {
            Bounds::of(&points.iter().map(|x| [dot(*x, first), dot(*x, second), 0.0]).collect::<Vec<_>>())
        };
        let corner = |k: usize| [0, 1, 2].map(|c| if k >> c & 1 == 0 { low[c] } else { high[c] });
        let of_hole = shadow((0..8).map(corner).collect());
        facets.iter().any(|points| shadow(points.iter().map(place).collect()).overlaps(&of_hole))
    };
    holes.retain(|hole| [0.0].iter().chain(times).any(|t| is_seen_at(hole, *t)));
    holes
}
