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
    let mut left: BTreeMap<usize, &Relative> = nodes.iter().map(|relative| (relative.node, relative)).collect();
    let waits_for = |left: &BTreeMap<usize, &Relative>, relative: &Relative| {
        relative.others.iter().map(|(other, _)| *other).find(|other| left.contains_key(other))
    };
    let mut order = Vec::with_capacity(left.len());
    while let Some(&least) = left.keys().next() {
        let ready: Vec<usize> = left
            .values()
            .filter(|relative| waits_for(&left, relative).is_none())
            .map(|relative| relative.node)
            .collect();
        if ready.is_empty() {
            // Each of the nodes waits for another of them, so that following these dependencies ends in a cycle.
            return Err(Ring((0..nodes.len()).fold(least, |node, _| waits_for(&left, left[&node]).unwrap_or(node))));
        }
        left.retain(|node, _| ready.binary_search(node).is_err());
        order.extend(ready);
    }
    Ok(order)
}
