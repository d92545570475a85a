//! The effect of moving obstacles on the gaps and the tangential motion at contact nodes, and the obstacle that a node meets at
//! each time, if there are several.
//!
//! A node has the same row of `C_n` for all obstacles that press along one normal, so that `w_n <= g` with the smallest
//! gap is the law for all of them. The smallest gap is continuous in time like the gap of one obstacle. Slip is the
//! motion relative to the nearest obstacle.

use std::collections::BTreeMap;

use super::Model;
use crate::algebra::vector::cross;
use crate::body::contact::{ContactNode, Facing, ObstacleMotion, PlacedObstacle, Rates, Term, nearest};
use crate::solver::loading::{GapCorrection, Loading, Motion};
use crate::solver::problem::ProblemError;

/// The effect of the motions of obstacles on the contact nodes.
pub(super) struct Motions {
    /// The rates and their histories.
    pub rates: Vec<Motion>,
    /// The corrections of the linearised gaps at the ends of the increments.
    pub gap_corrections: Vec<GapCorrection>,
    /// The obstacle that each node meets.
    pub nearest: Nearest,
}

/// Computes the effect of the motions of `obstacles` at `times` (s) on the contact nodes, which have these gaps at rest
/// (m).
pub(super) fn motions(
    contacts: &[ContactNode],
    obstacles: &[(PlacedObstacle, ObstacleMotion)],
    gap: &[f64],
    times: &[f64],
) -> Result<Motions, ProblemError> {
    let times: Vec<f64> = [0.0].into_iter().chain(times.iter().copied()).collect();
    let (rates, mut gap_corrections) = of_first(contacts, obstacles, &times)?;
    if contacts.iter().all(|contact| contact.others.is_empty()) {
        return Ok(Motions { rates, gap_corrections, nearest: Nearest::default() });
    }
    let loading = Loading::new(Vec::new(), gap.to_vec())?.with_motions(rates.clone(), gap_corrections.clone())?;
    let (nearest, bend) = Nearest::new(contacts, obstacles, &times, &loading)?;
    gap_corrections.extend(bend);
    Ok(Motions { rates, gap_corrections, nearest })
}

/// Computes the effect of the motion of one obstacle on the nodes that met it first. Nodes that met another obstacle
/// have zeros.
fn of_first(
    contacts: &[ContactNode],
    obstacles: &[(PlacedObstacle, ObstacleMotion)],
    times: &[f64],
) -> Result<(Vec<Motion>, Vec<GapCorrection>), ProblemError> {
    let (mut motions, mut gap_corrections) = (Vec::new(), Vec::new());
    for (k, (obstacle, motion)) in obstacles.iter().enumerate() {
        let assigned: Vec<usize> = (0..contacts.len()).filter(|&i| contacts[i].obstacle() == Some(k)).collect();
        let (Some(&first), Some(&last)) = (assigned.first(), assigned.last()) else { continue };
        // The nodes in the rows of each contact node.
        let terms: Vec<Vec<Term>> = assigned.iter().map(|&i| contacts[i].terms().collect()).collect();
        let all = || terms.iter().flatten();
        let (positions, facings): (Vec<[f64; 3]>, Vec<Facing>) = all().map(|term| (term.position, term.facing)).unzip();
        for (rates, history) in motion.rates(&positions, &facings) {
            let (mut gap, mut drift) = (vec![0.0; last + 1 - first], vec![[0.0; 2]; last + 1 - first]);
            for ((&i, terms), own) in assigned.iter().zip(&terms).zip(by_row(&terms, &rates)) {
                let sum = |rate: &dyn Fn(&Rates) -> f64| match own {
                    [one] => rate(one),
                    _ => own.iter().zip(terms).map(|(rates, term)| term.coefficient * rate(rates)).sum(),
                };
                (gap[i - first], drift[i - first]) = (sum(&|r| r.gap), [0, 1].map(|k| sum(&|r| r.drift[k])));
            }
            motions.push(Motion::new(first..last + 1, gap, drift, history)?);
        }
        if let Some(of_nodes) = motion.corrections(obstacle, &positions, &facings, times) {
            let of_rows = |(t, of_nodes): (&f64, Vec<f64>)| {
                let mut gap = vec![0.0; last + 1 - first];
                for ((&i, terms), own) in assigned.iter().zip(&terms).zip(by_row(&terms, &of_nodes)) {
                    gap[i - first] = correction_of(&contacts[i], terms, own, (obstacle, motion), *t);
                }
                gap
            };
            let table = times.iter().zip(of_nodes).map(of_rows).collect();
            gap_corrections.push(GapCorrection::new(first..last + 1, times.to_vec(), table)?);
        }
    }
    Ok((motions, gap_corrections))
}

/// Divides the values of all nodes into those of the nodes in each row.
fn by_row<'a, T>(terms: &'a [Vec<Term>], mut values: &'a [T]) -> impl Iterator<Item = &'a [T]> {
    terms.iter().map(move |terms| {
        let own;
        (own, values) = values.split_at(terms.len());
        own
    })
}

/// Tangential motion below this share of the normal motion counts as rounding.
const DRIFTS: f64 = 1e-9;

/// Returns `true` if the opposite side moves past a contact node along a tangential direction without a row, because
/// supports hold the node. For another body, `others` decides for the tangents of the node passed to it.
pub(super) fn passes(
    contact: &ContactNode,
    components: usize,
    obstacles: &[(PlacedObstacle, ObstacleMotion)],
    others: impl Fn(&ContactNode) -> bool,
) -> bool {
    let facing = &contact.facing;
    let has = contact.tangents.iter().filter(|row| !row.is_empty()).count();
    let tangents = match (components - 1 - has, has) {
        (0, _) => return false,
        (_, 0) => contact.frame,
        _ => [cross(facing.normal, facing.tangents[0]), [0.0; 3]],
    };
    let facing = Facing { tangents, ..*facing };
    let drifts = contact.obstacle().is_some_and(|k| {
        let rates = obstacles[k].1.rates(&[contact.position], &[facing]);
        rates.iter().any(|(rates, _)| {
            let [t, o] = rates[0].drift;
            t.hypot(o) > DRIFTS * rates[0].gap.abs()
        })
    });
    drifts || others(&ContactNode { facing, ..contact.clone() })
}

/// Returns the correction at time `t` (s) of the linearised gap of the rows of a contact node, m, from the corrections
/// `own` at their nodes, `terms`.
fn correction_of(
    contact: &ContactNode,
    terms: &[Term],
    own: &[f64],
    (obstacle, motion): (&PlacedObstacle, &ObstacleMotion),
    t: f64,
) -> f64 {
    if let [one] = own {
        return *one;
    }
    let by_rates: Vec<f64> = terms.iter().map(|term| motion.gap(t, term.position, &term.facing)).collect();
    let exact: Vec<f64> = by_rates.iter().zip(own).map(|(gap, bend)| gap + bend).collect();
    let at_rest: Vec<f64> = terms.iter().map(|term| term.facing.gap).collect();
    if obstacle.is_in_front_of_all(&at_rest) && obstacle.is_in_front_of_all(&exact) {
        // Differences of whole gaps would lose digits.
        return terms.iter().zip(own).map(|(term, bend)| term.coefficient * bend).sum();
    }
    let changes = terms.iter().zip(&by_rates).map(|(term, gap)| term.coefficient * (gap - term.facing.gap));
    contact.gap(obstacle, &exact) - contact.gap(obstacle, &at_rest) - changes.sum::<f64>()
}

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
        let index = self.times.partition_point(|time| *time < t);
        of_node.get(index).or(of_node.last()).copied()
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
                let nearest = at[0].0;
                drift[k][i - from] = drift[last][i - from];
                if nearest != first {
                    let [before, now] = [times[last], *t].map(|t| drift_past(contact, &obstacles[nearest], t));
                    for axis in 0..2 {
                        let of_first = own[axis][i] - own_before[axis][i];
                        drift[k][i - from][axis] += (now[axis] - before[axis]) - of_first;
                    }
                }
            }
            own_before = own;
        }
        let correction = GapCorrection::new(nodes, times.to_vec(), gap)?;
        let slides = drift.iter().flatten().any(|drift| *drift != [0.0; 2]);
        Ok((found, Some(if slides { correction.with_drift(drift)? } else { correction })))
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
    pub fn assigned(&self, i: usize, t: f64) -> Option<(usize, Facing)> {
        let contact = &self.contact.nodes[i];
        let first = contact.obstacle()?;
        Some(match self.contact.nearest.at(i, t) {
            Some(k) if k != first => (
                k,
                Facing { tangents: contact.facing.tangents, ..self.contact.obstacles[k].0.seen_from(contact.position) },
            ),
            _ => (first, contact.facing),
        })
    }
}
