//! The obstacle that a contact node meets at each time, if there are several.
//!
//! A node has the same row of `C_n` for all obstacles that press along one normal, so that `w_n <= g` with the smallest
//! gap is the law for all of them. The smallest gap is continuous in time like the gap of one obstacle. Slip is the
//! motion relative to the nearest obstacle.

use std::collections::BTreeMap;

use super::Model;
use crate::body::contact::{ContactNode, Facing, ObstacleMotion, PlacedObstacle, Term, nearest};
use crate::solver::loading::{GapCorrection, Loading};
use crate::solver::problem::ProblemError;

/// The nearest obstacle at each time of the contact nodes for which it is not always the obstacle they met first.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Nearest {
    /// The times, s, from 0.
    times: Vec<f64>,
    /// The number of the nearest obstacle at each time, by contact node.
    obstacles: BTreeMap<usize, Vec<usize>>,
}

impl Nearest {
    /// Returns the nearest obstacle to contact node `i` in the increment that ends at time `t` (s); `None` if it is
    /// always the first.
    fn at(&self, i: usize, t: f64) -> Option<usize> {
        let of_node = self.obstacles.get(&i)?;
        let place = self.times.partition_point(|time| *time < t);
        of_node.get(place).or(of_node.last()).copied()
    }

    /// Finds the nearest of `obstacles` to the `contacts` at each of `times` (s, from 0), and the corrections of gaps
    /// and tangential motions in `loading`, which refer to the obstacles met first.
    pub(super) fn new(
        contacts: &[ContactNode],
        obstacles: &[(PlacedObstacle, ObstacleMotion)],
        times: &[f64],
        loading: &Loading,
    ) -> Result<(Self, Option<GapCorrection>), ProblemError> {
        let moves = |k: &usize| obstacles[*k].1.moves();
        let mut found = Nearest { times: times.to_vec(), obstacles: BTreeMap::new() };
        let mut rows = BTreeMap::new();
        for (i, contact) in contacts.iter().enumerate() {
            let Some(first) = contact.obstacle().filter(|_| !contact.others.is_empty()) else { continue };
            if !contact.others.iter().chain([&first]).any(moves) {
                continue;
            }
            let terms: Vec<Term> = contact.terms().collect();
            let at = |t: &f64| -> Vec<(usize, f64)> {
                let of = |term: &Term| nearest(obstacles, (first, &term.facing), &contact.others, term.position, *t);
                terms.iter().map(of).collect()
            };
            let at_times: Vec<Vec<(usize, f64)>> = times.iter().map(at).collect();
            if at_times.iter().flatten().any(|(k, _)| *k != first) {
                // The first term is the node itself.
                found.obstacles.insert(i, at_times.iter().map(|terms| terms[0].0).collect());
                rows.insert(i, at_times);
            }
        }
        let (Some((&from, _)), Some((&to, _))) = (rows.first_key_value(), rows.last_key_value()) else {
            return Ok((found, None));
        };
        let (nodes, count) = (from..to + 1, to + 1 - from);
        let (mut gap, mut drift) = (vec![vec![0.0; count]; times.len()], vec![vec![[0.0; 2]; count]; times.len()]);
        let drifts = |t: f64| [0, 1].map(|axis| loading.drift_at(t, axis));
        let mut own_before = drifts(times[0]);
        for (k, t) in times.iter().enumerate() {
            let (gaps, own, last) = (loading.gaps_at(*t), drifts(*t), k.saturating_sub(1));
            for (&i, at_times) in &rows {
                let (contact, at) = (&contacts[i], &at_times[k]);
                let Some(first) = contact.obstacle() else { continue };
                if at.iter().any(|(nearest, _)| *nearest != first) {
                    let distances: Vec<f64> = at.iter().map(|(_, distance)| *distance).collect();
                    gap[k][i - from] = contact.gap(&obstacles[first].0, &distances) - gaps[i];
                }
                // A node slides past each obstacle while that obstacle is the nearest.
                let met = at[0].0;
                drift[k][i - from] = drift[last][i - from];
                if met != first {
                    let [before, now] = [times[last], *t].map(|t| drift_past(contact, &obstacles[met], t));
                    for axis in 0..2 {
                        let of_first = own[axis][i] - own_before[axis][i];
                        drift[k][i - from][axis] += (now[axis] - before[axis]) - of_first;
                    }
                }
            }
            own_before = own;
        }
        let bend = GapCorrection::new(nodes, times.to_vec(), gap)?;
        let slides = drift.iter().flatten().any(|drift| *drift != [0.0; 2]);
        Ok((found, Some(if slides { bend.with_drift(drift)? } else { bend })))
    }
}

/// Returns the tangential motion (m) of an obstacle past the rows of `contact` until time `t` (s).
fn drift_past(contact: &ContactNode, (obstacle, motion): &(PlacedObstacle, ObstacleMotion), t: f64) -> [f64; 2] {
    contact.terms().fold([0.0; 2], |sum, term| {
        let facing = Facing { tangents: term.facing.tangents, ..obstacle.seen_from(term.position) };
        let drift = motion.drift(t, term.position, &facing);
        [0, 1].map(|axis| sum[axis] + term.coefficient * drift[axis])
    })
}

impl Model {
    /// Returns the number of the obstacle that contact node `i` meets in the increment that ends at time `t` (s), and
    /// the obstacle as seen from the node; `None` in front of another body.
    pub fn met(&self, i: usize, t: f64) -> Option<(usize, Facing)> {
        let contact = &self.contacts[i];
        let first = contact.obstacle()?;
        Some(match self.nearest.at(i, t) {
            Some(k) if k != first => {
                (k, Facing { tangents: contact.facing.tangents, ..self.obstacles[k].0.seen_from(contact.position) })
            }
            _ => (first, contact.facing),
        })
    }
}
