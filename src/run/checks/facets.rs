//! Facets that stand for curved surfaces.

use super::prelude::*;
use crate::algebra::vector::median;
use crate::body::model::Pair;

kinds! {
    /// Facets that turn by 44° to 84° count as edges; if they were of one surface, measured gaps would change by more than
    /// 10 % (mean by force). The message has both overlaps: forces of a fit are off by their ratio. Or triangles of a
    /// curved obstacle: the surface is beyond their middle by more than 3.8 % of the indentation, and pressures may be
    /// more than 10 % off. Other warnings of that pressure are omitted.
    FACETED_GAPS("faceted-gaps", "Twice as many elements along the curve, or the gap if it is known. A finer file of the \
        obstacle, or its shape.", "the part has these edges");
}

/// The error of pressures, and of gaps of pairs, by facets above which it is reported.
const FACETED: f64 = 0.1;

/// The ratio of the error of pressures to the error of distances by the triangles of an obstacle, both relative: 2.3 to
/// 2.8 for the peaks of cylinders of which 2 to 6 strips press.
const STIFFER_OBSTACLE: f64 = 2.6;

/// Facets whose bulge is smaller than this share of the size of the mesh are flat: coordinates are rounded.
const FLAT: f64 = 1e-12;

/// The error of measured gaps of a pair if facets that count as apart, because they turn so much, are of one curved
/// surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Faceted {
    /// The number of the pair.
    pair: usize,
    /// The sum of the normal forces, N.
    force: f64,
    /// The reduction of the gaps by curved surfaces, m: the mean, weighted by the normal forces. If there is no force,
    /// it is the mean over the nodes at which curved surfaces overlap at the beginning.
    bulge: f64,
    /// The overlap at the beginning in the same mean, m; negative where contact has closed gaps.
    closed: f64,
}

/// The effect of facets on the gaps of each pair with curved boundaries, at its largest force.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct FacetedGaps(Vec<Faceted>);

impl FacetedGaps {
    /// Returns the pairs whose facets change the gaps so much that pressures mean little.
    fn large(&self) -> impl Iterator<Item = &Faceted> {
        self.0.iter().filter(|faceted| faceted.bulge.abs() > FACETED * faceted.closed.abs())
    }

    pub(super) fn are_of(&self, model: &Model, boundary: &str) -> bool {
        self.large().any(|faceted| model.contact.pairs[faceted.pair].slave == boundary)
    }
}

impl Check for FacetedGaps {
    fn observe(&mut self, model: &Model, step: &IncrementView<'_>, _: &SoFar) {
        let of_pair = |pair: usize| {
            let (mut by_force, mut without) = ([0.0; 3], [0.0; 3]);
            for (contact, p_n) in model.contact.nodes.iter().zip(&step.state.p_n) {
                let Some(coupled) = contact.coupled().filter(|coupled| coupled.pair == pair) else { continue };
                let gap = contact.facing.gap;
                // Facets may hold nodes apart that the curved surfaces press.
                let overlaps = if gap < coupled.edges { 1.0 } else { 0.0 };
                for (sums, weight) in [(&mut by_force, p_n.max(0.0)), (&mut without, overlaps)] {
                    let terms = [1.0, coupled.edges, -gap];
                    sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += weight * term);
                }
            }
            let [weight, bulge, closed] = if by_force[0] > 0.0 { by_force } else { without };
            let differs = bulge.abs() > FLAT * model.mesh.size() * weight;
            differs.then(|| Faceted { pair, force: by_force[0], bulge: bulge / weight, closed: closed / weight })
        };
        for faceted in (0..model.contact.pairs.len()).filter_map(of_pair) {
            match self.0.iter_mut().find(|before| before.pair == faceted.pair) {
                Some(before) if faceted.force > before.force => *before = faceted,
                Some(_) => (),
                None => self.0.push(faceted),
            }
        }
    }

    fn fits(&self, model: &Model) -> bool {
        self.0.iter().all(|faceted| faceted.pair < model.contact.pairs.len())
    }
}

/// Warns of the facets of pairs.
pub(super) fn of_pairs(Solved { model, checks, .. }: &Solved<'_>) -> Vec<Warning> {
    let warning = |&Faceted { pair, bulge, closed, .. }: &Faceted| {
        let Pair { slave, master, contact, .. } = &model.contact.pairs[pair];
        let gaps = [-closed, -closed - bulge];
        let [now, curved] = gaps.map(|gap| model.units().rounded(Quantity::Length, gap, 3));
        WarningKind::FACETED_GAPS.warning(format!(
            "facets of `{slave}` or `{}` turn by more than 44° where they meet, and count as edges: if they are of one \
             curved surface, measured gaps are {curved} in the mean, not {now}; forces of a fit are off by that ratio, \
             and pressures by more: use twice as many elements along the curve, or set contact[{contact}].gap if it is \
             known",
            master.name
        ))
    };
    checks.faceted_gaps.large().map(warning).collect()
}

/// The obstacle of triangles that is furthest from the curved surface that it stands for, of those pressed when contact
/// forces were largest, and the distance of that surface from the middle of the triangles, m: the median over the
/// pressed nodes.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct FacetedObstacle(Option<(usize, f64)>);

impl FacetedObstacle {
    /// Returns the obstacle if its triangles change distances so much that pressures mean little.
    fn large(&self, so_far: &SoFar) -> Option<(usize, f64)> {
        self.0.filter(|(_, sagitta)| STIFFER_OBSTACLE * sagitta > FACETED * so_far.indentation)
    }

    pub(super) fn is_of(&self, model: &Model, boundary: &str, so_far: &SoFar) -> bool {
        let mut own = model.contact.boundaries.iter().filter(|other| other.name == boundary);
        self.large(so_far).is_some_and(|(obstacle, _)| own.any(|other| other.obstacles.contains(&obstacle)))
    }
}

impl Check for FacetedObstacle {
    fn observe(&mut self, model: &Model, step: &IncrementView<'_>, so_far: &SoFar) {
        if so_far.is_deepest {
            let of_obstacle = |k: usize| {
                let (obstacle, motion) = &model.contact.obstacles[k];
                obstacle.triangles()?;
                let pressed = (0..model.contact.nodes.len()).filter(|&i| step.state.p_n[i] > 0.0);
                let place = |i: usize| {
                    let (own, facing) = model.assigned(i, step.record.time)?;
                    (own == k).then(|| motion.back(step.record.time, model.contact.nodes[i].position, facing.normal))
                };
                Some((k, median(&mut obstacle.sagittas(pressed.filter_map(place)))?))
            };
            self.0 = (0..model.contact.obstacles.len()).filter_map(of_obstacle).max_by(|a, b| a.1.total_cmp(&b.1));
        }
    }

    fn fits(&self, model: &Model) -> bool {
        self.0.is_none_or(|(obstacle, _)| obstacle < model.contact.obstacles.len())
    }

    fn warning(&self, model: &Model, so_far: &SoFar) -> Option<Warning> {
        let (obstacle, sagitta) = self.large(so_far)?;
        let share = STIFFER_OBSTACLE * (sagitta / so_far.indentation);
        let (off, shorter, beside) = (100.0 * share.min(1.0), (FACETED / share).sqrt(), so_far.beside(sagitta));
        let (key, far) = (model.obstacle_key(obstacle), model.units().rounded(Quantity::Length, sagitta, 3));
        Some(WarningKind::FACETED_GAPS.warning(format!(
            "the triangles of {key} are chords of a curved surface, which is {far} beyond their middle (median), \
             {beside}: pressures may be off by about {off:.0} %; write the file with edges at most {shorter:.2} times \
             as long, or use an obstacle of that shape"
        )))
    }
}
