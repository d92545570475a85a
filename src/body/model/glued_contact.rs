//! Contact at glued nodes.
//!
//! A glued slave node follows its masters, so that it has no contact force of its own: its contact stress is that which
//! its masters interpolate. With the share `c` of a master in it, the weights and rows of the two add up,
//! `l = l_m + c l_s`, `l C = l_m C_m + c l_s C_s`, and `l g = l_m g_m + c l_s g_s` for the gaps. Otherwise the two rows at a seam would determine more than the
//! displacements there, and pressures of neighbours would be far apart. A slave without a master in the same contact, as at
//! the end of a weld, keeps its row.

use std::collections::BTreeMap;

use super::pair::Pairs;
use crate::algebra::vector::dot;
use crate::body::constraints::merged;
use crate::body::contact::{ContactBoundary, ContactNode, Counterpart, ObstacleMotion, PlacedObstacle, Row, Term};

/// Normals within 1.15 degrees count as parallel.
const PARALLEL: f64 = 0.9998;

/// The obstacles, and their motions.
type Obstacles = [(PlacedObstacle, ObstacleMotion)];

/// A glued contact node: its number, and its masters among the contact nodes with their shares.
type Carried = (usize, Vec<(usize, f64)>);

/// Adds the weights and rows of glued contact nodes to those of their masters, and removes them. The friction coefficients
/// are those of all `nodes`, and those of the nodes of each of the `boundaries`.
pub(super) fn carry_glued(
    (nodes, mu): (&mut Vec<ContactNode>, &mut Vec<f64>),
    (boundaries, own_mu): (&mut [ContactBoundary], &mut [Vec<f64>]),
    (pairs, obstacles): (&Pairs, &Obstacles),
) {
    let dependent: BTreeMap<usize, Vec<(usize, f64)>> = of_masters(nodes, pairs, obstacles).into_iter().collect();
    if dependent.is_empty() {
        return;
    }
    let own: Vec<ContactNode> = nodes.clone();
    for (&slave, masters) in &dependent {
        for &(master, share) in masters {
            let to = &mut nodes[master];
            let weight = share * own[slave].weight;
            let all = to.weight + weight;
            mu[master] += (mu[slave] - mu[master]) * (weight / all);
            to.blend(&own[slave], weight / all);
            to.weight = all;
        }
    }
    let mut numbers = vec![0; own.len()];
    let mut count = 0;
    for (i, number) in numbers.iter_mut().enumerate() {
        *number = count;
        count += usize::from(!dependent.contains_key(&i));
    }
    let mut numbers_of_nodes = 0..;
    nodes.retain(|_| numbers_of_nodes.next().is_none_or(|i| !dependent.contains_key(&i)));
    let mut numbers_of_mu = 0..;
    mu.retain(|_| numbers_of_mu.next().is_none_or(|i| !dependent.contains_key(&i)));
    for (boundary, own_mu) in boundaries.iter_mut().zip(own_mu) {
        let (mut nodes, mut weights, mut mus) = (Vec::new(), Vec::<f64>::new(), Vec::<f64>::new());
        let mut index_of = BTreeMap::new();
        for ((&i, &weight), &mu) in boundary.nodes.iter().zip(&boundary.weights).zip(&*own_mu) {
            let of_masters = dependent.get(&i).cloned().unwrap_or_else(|| vec![(i, 1.0)]);
            for (to, share) in of_masters {
                let index = *index_of.entry(to).or_insert(nodes.len());
                if index == nodes.len() {
                    nodes.push(numbers[to]);
                    weights.push(0.0);
                    mus.push(mu);
                }
                weights[index] += share * weight;
                mus[index] += (mu - mus[index]) * (share * weight / weights[index]);
            }
        }
        (boundary.nodes, boundary.weights, *own_mu) = (nodes, weights, mus);
    }
}

/// Returns the glued contact nodes with masters in the same contact.
fn of_masters(nodes: &[ContactNode], pairs: &Pairs, obstacles: &Obstacles) -> Vec<Carried> {
    let mut at_node = BTreeMap::<usize, Vec<usize>>::new();
    nodes.iter().enumerate().for_each(|(i, contact)| at_node.entry(contact.node).or_default().push(i));
    let glued = pairs.all.iter().filter(|pair| pair.glued);
    let rows: BTreeMap<usize, &[(usize, f64)]> =
        glued.flat_map(|pair| &pair.mortar.rows).map(|row| (row.node, row.master.as_slice())).collect();
    let masters = |(i, contact): (usize, &ContactNode)| {
        let of_node = rows.get(&contact.node)?;
        let alike = |&(node, share): &(usize, f64)| {
            let mut there = at_node.get(&node).into_iter().flatten().copied();
            let other = there.find(|&j| meets_alike([contact, &nodes[j]], pairs, obstacles))?;
            (share > 0.0 && !rows.contains_key(&node)).then_some((other, share))
        };
        let found: Vec<(usize, f64)> = of_node.iter().filter_map(alike).collect();
        let sum: f64 = found.iter().map(|(_, share)| share).sum();
        (sum > 0.0).then(|| (i, found.into_iter().map(|(j, share)| (j, share / sum)).collect()))
    };
    nodes.iter().enumerate().filter_map(masters).collect()
}

/// Returns `true` if two contact nodes meet the same body, or obstacles that move alike, along the same normal.
fn meets_alike([a, b]: [&ContactNode; 2], pairs: &Pairs, obstacles: &Obstacles) -> bool {
    let same = match (&a.counterpart, &b.counterpart) {
        (Counterpart::Boundary(a), Counterpart::Boundary(b)) => {
            pairs.all[a.pair].master.name == pairs.all[b.pair].master.name
        }
        (&Counterpart::Obstacle(a), &Counterpart::Obstacle(b)) => obstacles[a].1 == obstacles[b].1,
        _ => false,
    };
    same && dot(a.facing.normal, b.facing.normal) > PARALLEL
}

impl ContactNode {
    /// Adds `share` of the rows and the gap of `other` to the rest of the own ones, along the own tangents.
    fn blend(&mut self, other: &ContactNode, share: f64) {
        let mixed = |own: &Row, parts: &[(f64, &Row)]| {
            let scaled = |row: &Row, by: f64| row.iter().map(|&(dof, c)| (dof, by * c)).collect::<Row>();
            let all = parts.iter().map(|(by, row)| scaled(row, share * by));
            merged(all.fold(scaled(own, 1.0 - share), |sum, row| [sum, row].concat()))
        };
        if self.coupled().is_some() {
            self.facing.gap += share * (other.facing.gap - self.facing.gap);
        }
        let weighted = |term: Term, by: f64| Term { coefficient: by * term.coefficient, ..term };
        let own = self.dependent.iter().map(|term| weighted(*term, 1.0 - share));
        self.dependent = own.chain(other.terms().map(|term| weighted(term, share))).collect();
        self.normal = mixed(&self.normal, &[(1.0, &other.normal)]);
        for k in 0..2 {
            if !self.tangents[k].is_empty() {
                let along =
                    [0, 1].map(|j| (dot(self.facing.tangents[k], other.facing.tangents[j]), &other.tangents[j]));
                self.tangents[k] = mixed(&self.tangents[k], &along);
            }
        }
    }
}
