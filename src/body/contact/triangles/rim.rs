//! Holes and cracks of a surface of triangles, as distinct from its outer rim.

use std::collections::HashMap;

use super::{CRACK, Triangles};
use crate::algebra::vector::{cross, dot, minus, norm, plus};
use crate::body::contact::tree::Bounds;

/// A hole or a crack in a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hole {
    /// The middle of its rim, m.
    pub middle: [f64; 3],
    /// The bounding box of its rim: the least and the largest coordinates, m.
    pub bounds: [[f64; 3]; 2],
    /// The longest side of that box, m.
    pub size: f64,
}

/// A side of a triangle on a rim.
#[derive(Debug, Clone, Copy)]
struct Side {
    ends: [[f64; 3]; 2],
    /// The unit vector pointing off the surface.
    off: [f64; 3],
}

impl Side {
    fn middle(&self) -> [f64; 3] {
        plus(self.ends[0], 0.5, minus(self.ends[1], self.ends[0]))
    }

    fn length(&self) -> f64 {
        norm(minus(self.ends[1], self.ends[0]))
    }
}

/// The least share of a hole's rim. The share measures how far the directions off the surface point into the area that
/// the rim encloses: 1 for a hole in a plane, -1 for the outer rim of a plane, 0 for the rim of a bowl.
const INTO: f64 = 0.5;

/// A point so many times as far from a rim as triangles reach meets only what is beyond a crack.
const PAST: f64 = 1.01;

impl Triangles {
    /// Returns the holes of the surface and the cracks of at most the width `reach` (m). Openings within rounding do
    /// not count.
    pub(in crate::body::contact) fn holes(&self, reach: f64) -> Vec<Hole> {
        let (holes, rest): (Vec<_>, Vec<_>) = self.rims().into_iter().partition(|rim| self.is_hole(rim));
        let along_crack =
            |rim: Vec<Side>| rim.into_iter().filter(|side| self.goes_on_beyond(side, reach)).collect::<Vec<_>>();
        holes.into_iter().chain(rest.into_iter().map(along_crack)).filter_map(|rim| Hole::around(&rim)).collect()
    }

    /// Returns the rims: closed paths along sides that belong to only one triangle.
    fn rims(&self) -> Vec<Vec<Side>> {
        let mut from: HashMap<usize, Vec<(usize, Side)>> = HashMap::new();
        for (t, sides) in self.sides.iter().enumerate() {
            for (k, side) in sides.iter().enumerate() {
                let Some(off) = self.edges[*side].off.first() else { continue };
                let [a, b] = [k, (k + 1) % 3];
                let side = Side { ends: [self.corners[t][a], self.corners[t][b]], off: *off };
                from.entry(self.points[t][a]).or_default().push((self.points[t][b], side));
            }
        }
        let mut starts: Vec<usize> = from.keys().copied().collect();
        starts.sort_unstable();
        let mut rims = Vec::new();
        for start in starts {
            let (mut rim, mut at) = (Vec::new(), start);
            while let Some((next, side)) = from.get_mut(&at).and_then(Vec::pop) {
                rim.push(side);
                at = next;
                if at == start {
                    rims.push(std::mem::take(&mut rim));
                }
            }
            if !rim.is_empty() {
                rims.push(rim);
            }
        }
        rims
    }

    /// Returns `true` if the surface is around the rim and not within it: directions off the surface point into the
    /// rim.
    fn is_hole(&self, rim: &[Side]) -> bool {
        let centre = middle(rim);
        let into = rim.iter().map(|side| side.length() * dot(side.off, minus(centre, side.middle()))).sum::<f64>();
        let area = rim.iter().fold([0.0; 3], |sum, side| {
            plus(sum, 0.5, cross(minus(side.ends[0], centre), minus(side.ends[1], centre)))
        });
        let length = rim.iter().map(Side::length).sum::<f64>();
        // A rim that encloses no area is a seam whose corners differ by little; lines do not pass through it.
        let width = 2.0 * norm(area) / length;
        width > 2.0 * CRACK * self.extent && into > INTO * 2.0 * norm(area)
    }

    /// Returns `true` if another part of the surface is beyond the side of a rim, at most `reach` (m) away, with a
    /// crack between them.
    fn goes_on_beyond(&self, side: &Side, reach: f64) -> bool {
        let across = |way: f64| self.nearest(plus(side.middle(), way, side.off)).map(|(distance, _)| distance.abs());
        // The triangles beside a narrower crack meet what is in front of it.
        let is_open = across(PAST * CRACK * self.extent).is_none();
        is_open && across(reach).is_some_and(|distance| distance < 0.5 * reach)
    }
}

/// Returns the mean of the middles of the sides, weighted by their lengths, m.
fn middle(rim: &[Side]) -> [f64; 3] {
    let length = rim.iter().map(Side::length).sum::<f64>();
    rim.iter().fold([0.0; 3], |sum, side| plus(sum, side.length() / length, side.middle()))
}

impl Hole {
    /// Returns the centre of the bounding box of its rim, m.
    pub fn box_centre(&self) -> [f64; 3] {
        let [low, high] = self.bounds;
        plus(low, 0.5, minus(high, low))
    }

    fn around(rim: &[Side]) -> Option<Self> {
        let points: Vec<[f64; 3]> = rim.iter().flat_map(|side| side.ends).collect();
        let bounds = (!points.is_empty()).then(|| Bounds::of(&points))?;
        Some(Hole { middle: middle(rim), bounds: [bounds.low, bounds.high], size: bounds.extent() })
    }
}
