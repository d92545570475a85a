//! Restriction of a loading to some of the contact nodes.

use std::ops::Range;

use super::{FrictionHistory, GapCorrection, Loading, Motion};

impl Loading {
    /// Restricts the loading to the contact `nodes`, ascending.
    pub(crate) fn of_nodes(&self, nodes: &[usize]) -> Self {
        let motion = |motion: &Motion| {
            let (places, nodes) = part(&motion.nodes, nodes);
            Motion {
                gap: nodes.iter().map(|i| motion.gap[i - motion.nodes.start]).collect(),
                drift: nodes.iter().map(|i| motion.drift[i - motion.nodes.start]).collect(),
                nodes: places,
                history: motion.history.clone(),
            }
        };
        let bend = |bend: &GapCorrection| {
            let (places, nodes) = part(&bend.nodes, nodes);
            let of = |i: &usize| i - bend.nodes.start;
            GapCorrection {
                gap: bend.gap.iter().map(|row| nodes.iter().map(|i| row[of(i)]).collect()).collect(),
                drift: bend.drift.iter().map(|row| nodes.iter().map(|i| row[of(i)]).collect()).collect(),
                nodes: places,
                times: bend.times.clone(),
            }
        };
        Loading {
            cases: self.cases.clone(),
            gap: nodes.iter().map(|&i| self.gap[i]).collect(),
            motions: self.motions.iter().map(motion).collect(),
            bends: self.bends.iter().map(bend).collect(),
            friction: self.friction.as_ref().map(|friction| friction.of_nodes(nodes)),
        }
    }
}

impl FrictionHistory {
    fn of_nodes(&self, nodes: &[usize]) -> Self {
        let case =
            |(mu, history): &(Vec<f64>, Vec<[f64; 2]>)| (nodes.iter().map(|&i| mu[i]).collect(), history.clone());
        FrictionHistory { nodes: nodes.len(), cases: self.cases.iter().map(case).collect() }
    }
}

/// Returns the `nodes` in `range`, and their positions in `nodes`.
fn part<'a>(range: &Range<usize>, nodes: &'a [usize]) -> (Range<usize>, &'a [usize]) {
    let place = |end: usize| nodes.partition_point(|node| *node < end);
    let places = place(range.start)..place(range.end);
    (places.clone(), &nodes[places])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_drifts_and_friction_are_those_of_the_nodes() {
        let history = vec![[0.0, 0.0], [2.0, 4.0]];
        let motion =
            Motion::new(1..4, vec![-1.0, -0.5, 2.0], vec![[0.0, 2.0], [1.0, 0.0], [3.0, 1.0]], history).unwrap();
        let bend = GapCorrection::new(0..2, vec![0.0, 2.0], vec![vec![0.0, 0.5], vec![1.0, 4.0]]).unwrap();
        let bend = bend.with_drift(vec![vec![[0.0; 2]; 2], vec![[1.0, 2.0], [3.0, 4.0]]]).unwrap();
        let friction = FrictionHistory::new(5, vec![(vec![0.1, 0.2, 0.3, 0.4, 0.5], Vec::new())]).unwrap();
        let all = Loading::new(Vec::new(), vec![1.0, 2.0, 3.0, 4.0, 5.0]).unwrap();
        let all = all.with_motions(vec![motion], vec![bend]).unwrap().with_friction(Some(friction)).unwrap();
        for nodes in [vec![0, 1, 2, 3, 4], vec![1, 3], vec![0, 4], vec![2], vec![3, 4], vec![4]] {
            let some = all.of_nodes(&nodes);
            let of_all = |values: Vec<f64>| nodes.iter().map(|&i| values[i]).collect::<Vec<_>>();
            for t in [0.0, 0.7, 2.0, 3.0] {
                assert_eq!(some.gaps_at(t), of_all(all.gaps_at(t)));
                assert_eq!(some.friction().unwrap().at(t), of_all(all.friction().unwrap().at(t)));
                for k in 0..2 {
                    assert_eq!(some.drift_at(t, k), of_all(all.drift_at(t, k)));
                }
            }
        }
    }
}
