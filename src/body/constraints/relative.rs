//! Nodes whose unknowns are displacements relative to other nodes, see [`super::Dofs::relative_to`].

use std::collections::BTreeMap;

use crate::algebra::vector::{axis, dot, plus};

/// A sum of terms below this share of their sizes is rounding.
const CANCELS: f64 = 8.0 * f64::EPSILON;

/// The coefficient of the displacement of another node.
#[derive(Debug, Clone, PartialEq)]
pub enum Coefficient {
    /// A factor.
    Factor(f64),
    /// A matrix, such as that of `u = θ × x`.
    Matrix(Box<[[f64; 3]; 3]>),
}

impl Coefficient {
    /// Computes the product with a displacement.
    pub(super) fn times(&self, u: [f64; 3]) -> [f64; 3] {
        match self {
            Coefficient::Factor(c) => u.map(|u| c * u),
            Coefficient::Matrix(rows) => rows.map(|row| dot(row, u)),
        }
    }

    /// Returns the sum of two coefficients.
    pub(crate) fn plus(&self, other: &Self) -> Self {
        let rows = |c: &Self| [0, 1, 2].map(|k| c.transposed_times(axis(k)));
        match (self, other) {
            (Coefficient::Factor(a), Coefficient::Factor(b)) => Coefficient::Factor(a + b),
            _ => Coefficient::Matrix(Box::new([0, 1, 2].map(|k| plus(rows(self)[k], 1.0, rows(other)[k])))),
        }
    }

    /// Returns the largest absolute value of its entries.
    pub(crate) fn size(&self) -> f64 {
        let largest = |all: &[f64]| all.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        match self {
            Coefficient::Factor(c) => c.abs(),
            Coefficient::Matrix(rows) => largest(rows.as_flattened()),
        }
    }

    /// Returns the coefficient divided by `own`.
    pub(crate) fn over(&self, own: f64) -> Self {
        match self {
            Coefficient::Factor(c) => Coefficient::Factor(c / own),
            Coefficient::Matrix(rows) => Coefficient::Matrix(Box::new(rows.map(|row| row.map(|c| c / own)))),
        }
    }

    /// Computes the product of the transposed coefficient with `v`.
    pub(super) fn transposed_times(&self, v: [f64; 3]) -> [f64; 3] {
        match self {
            Coefficient::Factor(c) => v.map(|v| c * v),
            Coefficient::Matrix(rows) => rows.iter().zip(v).fold([0.0; 3], |sum, (row, v)| plus(sum, v, *row)),
        }
    }
}

/// A node whose unknowns are relative to other nodes, `w = own · u - Σ coefficient · u_other`.
#[derive(Debug, Clone, PartialEq)]
pub struct Relative {
    /// The number of the node in the mesh.
    pub node: usize,
    /// The coefficient of its own displacement, above 0.
    pub own: f64,
    /// The other nodes with their coefficients.
    pub others: Vec<(usize, Coefficient)>,
    /// `true` if `w` is 0.
    pub tied: bool,
}

/// The error that this node is part of a cycle of nodes that are relative to each other, so that their displacements
/// are undefined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ring(pub usize);

/// Combines the terms of a row so that each unknown occurs once, and not at all if its terms cancel up to rounding.
pub(crate) fn merged(row: Vec<(usize, f64)>) -> Vec<(usize, f64)> {
    let mut terms: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
    for (dof, c) in row {
        let [sum, size] = terms.entry(dof).or_default();
        *sum += c;
        *size += c.abs();
    }
    let remains = |(dof, [sum, size]): (usize, [f64; 2])| (sum.abs() > CANCELS * size).then_some((dof, sum));
    terms.into_iter().filter_map(remains).collect()
}

/// Orders the nodes so that each follows the nodes that it is relative to.
pub(super) fn in_order(nodes: &[Relative]) -> Result<Vec<usize>, Ring> {
    let all: BTreeMap<usize, &Relative> = nodes.iter().map(|relative| (relative.node, relative)).collect();
    let mut waits: BTreeMap<usize, usize> = BTreeMap::new();
    let mut waiting: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (&node, relative) in &all {
        let for_whom = relative.others.iter().map(|(other, _)| *other).filter(|other| all.contains_key(other));
        let for_whom: Vec<usize> = for_whom.collect();
        waits.insert(node, for_whom.len());
        for other in for_whom {
            waiting.entry(other).or_default().push(node);
        }
    }
    let mut order: Vec<usize> = waits.iter().filter(|(_, count)| **count == 0).map(|(node, _)| *node).collect();
    let mut next = 0;
    while next < order.len() {
        for node in waiting.get(&order[next]).into_iter().flatten() {
            if let Some(count) = waits.get_mut(node) {
                *count -= 1;
                if *count == 0 {
                    order.push(*node);
                }
            }
        }
        next += 1;
    }
    let Some(mut node) = waits.iter().find(|(_, count)| **count > 0).map(|(node, _)| *node) else { return Ok(order) };
    // Each node that cannot be ordered depends on another such node, so that following these dependencies ends in a
    // cycle.
    for _ in 0..all.len() {
        let next =
            all[&node].others.iter().map(|(other, _)| *other).find(|other| waits.get(other).is_some_and(|n| *n > 0));
        node = next.unwrap_or(node);
    }
    Err(Ring(node))
}
