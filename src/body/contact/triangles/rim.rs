//! Where a surface of triangles has a hole or a crack in it, and where it only ends.

use std::collections::HashMap;

use super::{SINGLE, Triangles};
use crate::algebra::vector::{cross, dot, minus, norm, plus};
use crate::body::contact::tree::Bounds;

/// A hole or a crack in a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hole {
    /// The middle of its rim, m.
    pub middle: [f64; 3],
    /// The box around its rim: the least and the largest coordinates, m.
    pub bounds: [[f64; 3]; 2],
    /// The longest side of that box, m.
    pub size: f64,
}

/// A side of a triangle on a rim.
#[derive(Debug, Clone, Copy)]
struct Side {
    ends: [[f64; 3]; 2],
    /// The unit vector that leads off the surface.
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

/// The share of what leads off the surface at a rim that leads into the rim, from which on the rim is that of a hole. Of a hole in a
/// plane it is 1, of the outer rim of a plane -1, of the rim of a bowl 0.
const INTO: f64 = 0.5;

impl Triangles {
    /// The holes of the surface, and the cracks that are no wider than `reach` (m). Those that rounding makes are none.
    pub(in crate::body::contact) fn holes(&self, reach: f64) -> Vec<Hole> {
        let (holes, rest): (Vec<_>, Vec<_>) = self.rims().into_iter().partition(|rim| self.is_hole(rim));
        let along_crack =
            |rim: Vec<Side>| rim.into_iter().filter(|side| self.goes_on_beyond(side, reach)).collect::<Vec<_>>();
        holes.into_iter().chain(rest.into_iter().map(along_crack)).filter_map(|rim| Hole::around(&rim)).collect()
    }

    /// The rims: closed ways along sides that are of one triangle only.
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

    /// Whether the surface is around the rim, not within it: what leads off it leads into the rim.
    fn is_hole(&self, rim: &[Side]) -> bool {
        let centre = middle(rim);
        let into = rim.iter().map(|side| side.length() * dot(side.off, minus(centre, side.middle()))).sum::<f64>();
        let area = rim.iter().fold([0.0; 3], |sum, side| {
            plus(sum, 0.5, cross(minus(side.ends[0], centre), minus(side.ends[1], centre)))
        });
        let length = rim.iter().map(Side::length).sum::<f64>();
        // A rim around no area is a seam, whose corners differ by rounding: lines do not pass through it.
        let width = 2.0 * norm(area) / length;
        width > SINGLE * self.extent && into > INTO * 2.0 * norm(area)
    }

    /// Whether another part of the surface is beyond the side of a rim, no further than `reach` (m), with a crack between.
    fn goes_on_beyond(&self, side: &Side, reach: f64) -> bool {
        let across = |way: f64| self.nearest(plus(side.middle(), way, side.off)).map(|(distance, _)| distance.abs());
        // Rounding does not let a line through.
        let is_open = across(10.0 * SINGLE * self.extent).is_none();
        is_open && across(reach).is_some_and(|distance| distance < 0.5 * reach)
    }
}

/// The mean of the middles of the sides, by their lengths, m.
fn middle(rim: &[Side]) -> [f64; 3] {
    let length = rim.iter().map(Side::length).sum::<f64>();
    rim.iter().fold([0.0; 3], |sum, side| plus(sum, side.length() / length, side.middle()))
}

impl Hole {
    /// The centre of the box around its rim, m.
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
