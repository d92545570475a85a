//! The rigid motion of an obstacle and its effect on gaps and slip.

use super::description::Obstacle;
use super::obstacle::{Facing, PlacedObstacle};
use crate::algebra::vector::{across, axis, cross, dot, minus, plus, unit};
use crate::base::timeline::within;
use crate::solver::loading::piecewise_linear;

/// The motion of an obstacle: translations in fixed directions and a rotation, each times a factor that varies in time.
#[derive(Debug, Clone, PartialEq)]
pub struct ObstacleMotion {
    /// The directions, each with points `[time (s), distance (m)]`.
    translations: Vec<([f64; 3], Vec<[f64; 2]>)>,
    rotation: Option<Turning>,
    /// `true` if the rotation maps the surface of the obstacle to itself.
    in_itself: bool,
}

/// A rotation about a fixed axis.
#[derive(Debug, Clone, PartialEq)]
struct Turning {
    /// The direction of the axis, a unit vector.
    axis: [f64; 3],
    /// A point of the axis, m.
    through: [f64; 3],
    /// Points `[time (s), angle (rad)]`.
    history: Vec<[f64; 2]>,
}

/// The slope of a surface relative to the normal of the node above which the rate of the gap ignores the slope. The
/// contribution of so steep a rate, which the gap correction cancels again, would cost digits of the gap.
const STEEP: f64 = 1.0;

/// The effect of one motion on a node in front of the obstacle, for a unit of its factor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rates {
    /// The rate of the gap.
    pub gap: f64,
    /// The tangential motion of the surface, along both tangents.
    pub drift: [f64; 2],
}

impl ObstacleMotion {
    /// Creates the motion of a valid `obstacle` from 0 to `end` (s); its approach is against `normal`.
    pub fn new(obstacle: &Obstacle, normal: [f64; 3], end: f64) -> Self {
        let path: Vec<[f64; 4]> = within(end, &obstacle.path());
        let component = |c: usize| {
            let history = path.iter().map(|point| [point[0], point[1 + c]]).collect::<Vec<_>>();
            (axis(c), history)
        };
        let mut translations: Vec<_> = (0..3).map(component).collect();
        translations.push((normal.map(|c| -c), within(end, obstacle.approach.as_deref().unwrap_or_default())));
        translations.retain(|(_, history)| history.iter().any(|point| point[1] != 0.0));
        let rotation = obstacle.rotation.as_ref().map(|rotation| Turning {
            axis: rotation.axis.map_or([0.0, 0.0, 1.0], |axis| unit(axis.components())),
            through: rotation.through.components(),
            history: within(end, &rotation.history),
        });
        ObstacleMotion { translations, rotation, in_itself: false }
    }

    /// Adapts the motion to `obstacle`: if a round obstacle turns about its own axis, its rotation does not change
    /// gaps, at any slope.
    #[must_use]
    pub fn of(self, obstacle: &PlacedObstacle) -> Self {
        ObstacleMotion { in_itself: !self.turns(obstacle), ..self }
    }

    /// Adds the opposite motion for a body that supports move rigidly by `offset` (m) times the factor of `history`.
    pub fn pass(&mut self, offset: [f64; 3], history: &[[f64; 2]]) {
        if offset != [0.0; 3] {
            self.translations.push((offset.map(|c| -c), history.to_vec()));
        }
    }

    /// Returns for each motion its rates at the nodes at `positions` (m), which see the obstacle according to
    /// `facings`, and its history.
    ///
    /// A rotating surface passes a fixed node with the velocity `ω × (x - c)`, so that its displacement there is the
    /// angle times `a × (x - c)`, not the chord, for any angle. The rate of the gap follows from the motion of the
    /// surface in front of the node and from its slope.
    pub fn rates(&self, positions: &[[f64; 3]], facings: &[Facing]) -> Vec<(Vec<Rates>, Vec<[f64; 2]>)> {
        let of = |surface: &dyn Fn([f64; 3]) -> [f64; 3]| {
            let rates = |(x, facing): (&[f64; 3], &Facing)| {
                let d = surface(*x);
                // The product of a normal and its opposite is exactly -1.
                if d.iter().zip(facing.normal).all(|(d, n)| *d == -n) {
                    return Rates { gap: -1.0, drift: [0.0; 2] };
                }
                let in_front = surface(plus(*x, facing.gap, facing.normal));
                let steep = facing.slope() > STEEP;
                let inward = if steep { facing.normal } else { facing.inward };
                Rates { gap: dot(in_front, inward), drift: facing.tangents.map(|t| dot(d, t)) }
            };
            positions.iter().zip(facings).map(rates).collect::<Vec<_>>()
        };
        let mut motions: Vec<_> =
            self.translations.iter().map(|(direction, history)| (of(&|_| *direction), history.clone())).collect();
        if let Some(Turning { axis, through, history }) = &self.rotation {
            let mut rates = of(&|x| cross(*axis, minus(x, *through)));
            if self.in_itself {
                for rates in &mut rates {
                    rates.gap = 0.0;
                }
            }
            motions.push((rates, history.clone()));
        }
        motions
    }

    /// Returns the linearised gap (m) at time `t` of a node at `x` (m), where `facing` is the obstacle at rest as seen
    /// from the node.
    pub fn gap(&self, t: f64, x: [f64; 3], facing: &Facing) -> f64 {
        facing.gap + self.added(t, x, facing)
    }

    /// Returns the contribution (m) of the motions until time `t` to the gap by their rates.
    fn added(&self, t: f64, x: [f64; 3], facing: &Facing) -> f64 {
        let motions = self.rates(&[x], std::slice::from_ref(facing));
        motions.iter().map(|(rates, history)| rates[0].gap * piecewise_linear(history, t).unwrap_or(0.0)).sum()
    }

    /// Returns the gap (m) without linearisation: the distance from the moved obstacle.
    pub fn exact_gap(&self, obstacle: &PlacedObstacle, t: f64, x: [f64; 3], facing: &Facing) -> f64 {
        self.gap(t, x, facing) + self.correction(obstacle, t, x, facing)
    }

    /// Returns the smallest gap (m) of a node at the points of all histories and at `times` (s), after the node has
    /// `moved` (m) along its normal.
    pub fn smallest_gap(
        &self,
        obstacle: &PlacedObstacle,
        x: [f64; 3],
        facing: &Facing,
        times: &[f64],
        moved: impl Fn(f64) -> f64,
    ) -> f64 {
        let gap = |t: f64| self.exact_gap(obstacle, t, x, facing) - moved(t);
        self.moments(times).map(gap).fold(f64::INFINITY, f64::min)
    }

    /// Returns the smallest distance (m) of a node at `x` (m) from the moved obstacle, at the points of all histories
    /// and at `times`; infinite if the obstacle is never in front of the node.
    pub(super) fn nearest_approach(
        &self,
        obstacle: &PlacedObstacle,
        x: [f64; 3],
        facing: &Facing,
        times: &[f64],
    ) -> f64 {
        self.moments(times).map(|t| self.distance(obstacle, t, x, facing)).fold(f64::INFINITY, f64::min)
    }

    /// Returns the first time, among the points of all histories and `times`, at which a node at `x` (m) is inside the
    /// moved obstacle with undefined depth: the obstacle has turned its back to it, or the wall of a bore has passed it
    /// sideways.
    pub(super) fn swallows(
        &self,
        obstacle: &PlacedObstacle,
        x: [f64; 3],
        facing: &Facing,
        times: &[f64],
    ) -> Option<f64> {
        // Without rotation, a line along the normal can leave the obstacle only at its rim. Bores are the exception.
        if !(self.turns(obstacle) || self.moves() && obstacle.surrounds()) {
            return None;
        }
        let swallowed = |t: &f64| {
            let (back, n) = self.back(*t, x, facing.normal);
            obstacle.swallows(back, n, x)
        };
        self.moments(times).filter(swallowed).min_by(f64::total_cmp)
    }

    /// Returns the slope of the obstacle in front of a node at `x` (m) at time `t` (s), relative to the node's normal:
    /// the tangent of the angle; NaN if the obstacle is not in front of the node.
    pub fn slope(&self, obstacle: &PlacedObstacle, t: f64, x: [f64; 3], facing: &Facing) -> f64 {
        // If each node has an individual normal, it is the normal of the surface.
        if self.keeps_shape(obstacle, facing.normal) || !obstacle.has_one_normal() {
            return facing.slope();
        }
        let (back, n) = self.back(t, x, facing.normal);
        obstacle.slope(back, n, x)
    }

    /// Returns 0, the times of all histories, and `times` (s).
    fn moments(&self, times: &[f64]) -> impl Iterator<Item = f64> {
        let histories = self.translations.iter().map(|(_, history)| history);
        let histories = histories.chain(self.rotation.iter().map(|rotation| &rotation.history));
        histories.flatten().map(|point| point[0]).chain([0.0]).chain(times.iter().copied())
    }

    /// Returns `true` if the obstacle is in front of a node at `x` (m) at time `t` (s).
    pub(super) fn is_in_front(&self, obstacle: &PlacedObstacle, t: f64, x: [f64; 3], facing: &Facing) -> bool {
        !self.distance(obstacle, t, x, facing).is_nan()
    }

    /// Returns the tangential motion (m) of the surface past a node at `x` (m) until time `t` (s), along the tangents
    /// of `facing`.
    pub(crate) fn drift(&self, t: f64, x: [f64; 3], facing: &Facing) -> [f64; 2] {
        let motions = self.rates(&[x], std::slice::from_ref(facing));
        let sum = |k: usize| {
            motions.iter().map(|(of, history)| of[0].drift[k] * piecewise_linear(history, t).unwrap_or(0.0)).sum()
        };
        [0, 1].map(sum)
    }

    /// Returns `true` if the obstacle ever moves.
    pub(crate) fn moves(&self) -> bool {
        self.rotation.is_some() || !self.translations.is_empty()
    }

    /// Returns the exact distance (m) at time `t` (s) of a node at `x` (m) from the moved obstacle along the node's
    /// normal; NaN if the obstacle is not in front of the node.
    fn distance(&self, obstacle: &PlacedObstacle, t: f64, x: [f64; 3], facing: &Facing) -> f64 {
        let (back, n) = self.back(t, x, facing.normal);
        obstacle.distance(back, n, x)
    }

    /// Returns the correction (m) of [`ObstacleMotion::gap`] at time `t`: the exact distance of a node at `x` (m) from
    /// the moved obstacle along the node's normal, minus that gap. If the obstacle is no longer in front of the node,
    /// its distance is taken to be the size of the boundary.
    ///
    /// A translation along the normal changes both distances equally and is left out of both: an approach of a
    /// nanometre would lose its digits when added to the coordinates of the node.
    fn correction(&self, obstacle: &PlacedObstacle, t: f64, x: [f64; 3], facing: &Facing) -> f64 {
        if self.keeps_shape(obstacle, facing.normal) {
            return 0.0;
        }
        let (exact, along) = if self.turns(obstacle) {
            (self.distance(obstacle, t, x, facing), 0.0)
        } else {
            let at = |history: &[[f64; 2]]| piecewise_linear(history, t).unwrap_or(0.0);
            let moved = self.translations.iter();
            let moved = moved.fold([0.0; 3], |sum, (direction, history)| plus(sum, at(history), *direction));
            let aside = across(moved, facing.normal);
            (obstacle.distance(minus(x, aside), facing.normal, x), dot(moved, facing.normal))
        };
        if exact.is_nan() {
            return obstacle.extent() - self.gap(t, x, facing);
        }
        (exact - facing.gap) - (self.added(t, x, facing) - along)
    }

    /// Returns `true` if the gap along `normal` is linear in all motions: a plane without rotation, or motion along the
    /// normal.
    fn keeps_shape(&self, obstacle: &PlacedObstacle, normal: [f64; 3]) -> bool {
        let along = |direction: &[f64; 3]| cross(*direction, normal) == [0.0; 3];
        !self.turns(obstacle)
            && (obstacle.is_plane() || self.translations.iter().all(|(direction, _)| along(direction)))
    }

    /// Returns `true` if a rotation changes the position of the obstacle.
    pub(crate) fn turns(&self, obstacle: &PlacedObstacle) -> bool {
        self.rotation.as_ref().is_some_and(|turning| !obstacle.is_the_same_about(turning.axis, turning.through))
    }

    /// Returns the gap corrections (m) of nodes at `positions` (m), which see the obstacle at rest according to
    /// `facings`, at each of `times` (s); `None` if there are none.
    pub fn corrections(
        &self,
        obstacle: &PlacedObstacle,
        positions: &[[f64; 3]],
        facings: &[Facing],
        times: &[f64],
    ) -> Option<Vec<Vec<f64>>> {
        if facings.iter().all(|facing| self.keeps_shape(obstacle, facing.normal)) {
            return None;
        }
        let at = |t: f64| positions.iter().zip(facings).map(|(&x, of)| self.correction(obstacle, t, x, of)).collect();
        Some(times.iter().map(|t| at(*t)).collect())
    }

    /// Returns the direction at time `t` (s) of the direction `n` in the obstacle at rest.
    pub(crate) fn forth(&self, t: f64, n: [f64; 3]) -> [f64; 3] {
        let Some(Turning { axis, history, .. }) = &self.rotation else { return n };
        turned(n, *axis, piecewise_linear(history, t).unwrap_or(0.0))
    }

    /// Transforms the point `x` (m) and the direction `n` at time `t` to the obstacle at rest.
    pub fn back(&self, t: f64, x: [f64; 3], n: [f64; 3]) -> ([f64; 3], [f64; 3]) {
        let at = |history: &[[f64; 2]]| piecewise_linear(history, t).unwrap_or(0.0);
        let mut x = x;
        for (direction, history) in &self.translations {
            x = plus(x, -at(history), *direction);
        }
        let Some(Turning { axis, through, history }) = &self.rotation else { return (x, n) };
        let angle = -at(history);
        (plus(turned(minus(x, *through), *axis, angle), 1.0, *through), turned(n, *axis, angle))
    }
}

/// Rotates `a` about the unit vector `axis` by `angle` (rad).
fn turned(a: [f64; 3], axis: [f64; 3], angle: f64) -> [f64; 3] {
    let radial = across(a, axis);
    let along = minus(a, radial);
    plus(plus(along, angle.cos(), radial), angle.sin(), cross(axis, radial))
}
