//! Nodes whose unknowns are displacements relative to other nodes.
//!
//! In front of another body, a node of the slave boundary has the unknown
//!
//! ```text
//! w_j = d_j u_j - Σ_k c_jk u_k
//! ```
//!
//! instead of `u_j`, where the `k` are nodes of the master or other nodes of the slave. This is the displacement in the
//! contact law. With the vector `û` of all unknowns, `u = T û`; the stiffness of a body becomes `Tᵀ K T` and its loads
//! `Tᵀ f`, element by element. A tied node has `w_j = 0` and no unknown. Held displacements remain held.

use std::collections::{BTreeMap, BTreeSet};

use super::dofs::{Dofs, SAME_DIRECTION};
use super::relative::{Coefficient, Relative, Ring, in_order, merged};
use crate::algebra::vector::{axis, dot, plus};

impl Dofs {
    /// Makes the unknowns of `nodes`, which must be distinct, relative to other nodes.
    ///
    /// # Errors
    /// [`Ring`] if nodes are relative to each other.
    pub fn relative_to(mut self, nodes: Vec<Relative>) -> Result<Self, Ring> {
        self.relative_order = in_order(&nodes)?;
        self.relative = nodes.into_iter().map(|relative| (relative.node, relative)).collect();
        self.number();
        for node in self.relative_order.clone() {
            for (a, n) in self.axes(node).into_iter().enumerate() {
                if self.is_held_along(node, a) {
                    continue;
                }
                let Relative { own, others, .. } = &self.relative[&node];
                let mut sum = BTreeMap::new();
                for (dof, value) in
                    others.iter().flat_map(|(other, c)| self.along(*other, c.over(*own).transposed_times(n)))
                {
                    *sum.entry(dof).or_insert(0.0) += value;
                }
                self.transform_rows.insert(self.dimension * node + a, sum.into_iter().collect());
            }
        }
        Ok(self)
    }

    /// Returns `true` if the unknowns of a node are relative to other nodes, or it is tied to them.
    pub fn is_relative(&self, node: usize) -> bool {
        self.relative.contains_key(&node)
    }

    /// Returns the node that a tied node moves with, if it is tied to one alone, and other nodes unchanged. A jump between
    /// the two does not count, nor do nodes that supports hold in all directions.
    pub fn moving_alike(&self, mut node: usize) -> usize {
        // Tied nodes have no rings.
        while let Some(Relative { own, others, tied: true, .. }) = self.relative.get(&node) {
            let is_held = |other: usize| !self.is_relative(other) && self.node(other).iter().all(Option::is_none);
            let mut in_mesh = others.iter().filter(|(other, _)| *other < self.of_mesh && !is_held(*other));
            match (in_mesh.next(), in_mesh.next()) {
                (Some((other, Coefficient::Factor(c))), None) if (c - own).abs() <= SAME_DIRECTION => node = *other,
                _ => break,
            }
        }
        node
    }

    /// Returns the relative displacement of a node along `vector`, `own · u - Σ coefficient · u_other`, in terms of
    /// unknowns: its own and, along held directions, those of the other nodes.
    pub fn relative_along(&self, node: usize, vector: [f64; 3]) -> Vec<(usize, f64)> {
        let Some(Relative { others, tied: false, .. }) = self.relative.get(&node) else { return Vec::new() };
        let mut row = Vec::new();
        for ((a, n), (dof, component)) in
            self.axes(node).into_iter().enumerate().zip(self.node(node).iter().zip(self.in_frame(node, vector)))
        {
            match dof {
                Some(dof) => row.push((*dof, component)),
                None if component != 0.0 && self.is_held_along(node, a) => {
                    let others = others.iter().flat_map(|(other, c)| self.along(*other, c.transposed_times(n)));
                    row.extend(others.map(|(dof, value)| (dof, -component * value)));
                }
                None => (),
            }
        }
        merged(row)
    }

    /// Returns the unknowns for the displacements `at` (m) of the nodes; held components are ignored.
    pub fn unknowns(&self, at: impl Fn(usize) -> [f64; 3]) -> Vec<f64> {
        let mut u = vec![0.0; self.free()];
        for node in 0..self.nodes() {
            let own = match self.relative.get(&node) {
                None => at(node),
                Some(Relative { own, others, .. }) => {
                    let of_node = at(node);
                    let others = others.iter().map(|(other, c)| c.times(at(*other)));
                    let sum = others.fold([0.0; 3], |sum, u| plus(sum, 1.0, u));
                    [0, 1, 2].map(|k| own * of_node[k] - sum[k])
                }
            };
            for (dof, component) in self.node(node).iter().zip(self.in_frame(node, own)) {
                if let Some(dof) = dof {
                    u[*dof] = component;
                }
            }
        }
        u
    }

    /// Returns the relative nodes that move with nodes moved by supports, each after the nodes that it is relative to.
    pub fn followers(&self) -> Vec<usize> {
        let mut follow = BTreeSet::new();
        let moves = |node: &usize| {
            let mut others = self.relative[node].others.iter();
            others.any(|(other, _)| self.is_held(*other) || follow.contains(other)) && follow.insert(*node)
        };
        self.relative_order.iter().copied().filter(moves).collect()
    }

    /// Returns the nodes to which a `force` on a tied node is transferred, each with its part; empty if the node is
    /// not tied.
    pub fn passed_on(&self, node: usize, force: [f64; 3]) -> Vec<(usize, [f64; 3])> {
        match self.relative.get(&node) {
            Some(Relative { own, others, tied: true, .. }) => {
                let term = |(other, c): &(usize, Coefficient)| (*other, c.over(*own).transposed_times(force));
                others.iter().map(term).collect()
            }
            _ => Vec::new(),
        }
    }

    /// Adds to the displacements `u` (m) of all nodes, those that supports prescribe, the displacements that relative nodes
    /// have by them.
    pub fn follow(&self, u: &mut [[f64; 3]]) {
        for &node in &self.relative_order {
            let Relative { own, others, .. } = &self.relative[&node];
            let along = |n: [f64; 3]| others.iter().map(|(other, c)| dot(c.over(*own).times(u[*other]), n)).sum();
            let sum = self.free_axes(node).into_iter().fold([0.0; 3], |sum, n| plus(sum, along(n), n));
            u[node] = plus(u[node], 1.0, sum);
        }
    }

    /// Computes the stiffness `Tᵀ K T` of an element with these nodes, and returns its unknowns and the stiffness.
    pub(super) fn reduced(&self, nodes: &[usize], stiffness: &[Vec<f64>]) -> (Vec<usize>, Vec<Vec<f64>>) {
        let unknowns = self.unknowns_of(nodes);
        let index = |dof: usize| unknowns.binary_search(&dof).unwrap_or(0);
        let components = stiffness.len() / nodes.len();
        let row = |k: usize| self.along(nodes[k / components], axis(k % components));
        let rows: Vec<Vec<(usize, f64)>> =
            (0..stiffness.len()).map(|k| row(k).map(|(dof, c)| (index(dof), c)).collect()).collect();
        let mut reduced = vec![vec![0.0; unknowns.len()]; unknowns.len()];
        for (row, values) in rows.iter().zip(stiffness).filter(|(row, _)| !row.is_empty()) {
            let mut of_row = vec![0.0; unknowns.len()];
            for (column, value) in rows.iter().zip(values) {
                for (j, c) in column {
                    of_row[*j] += c * value;
                }
            }
            for (i, c) in row {
                reduced[*i].iter_mut().zip(&of_row).for_each(|(sum, value)| *sum += c * value);
            }
        }
        (unknowns, reduced)
    }

    /// Returns the unknowns in the displacements of `nodes`, ascending.
    pub(super) fn unknowns_of(&self, nodes: &[usize]) -> Vec<usize> {
        let d = self.dimension;
        let rows = nodes.iter().flat_map(|node| d * node..d * (node + 1));
        let mut unknowns: Vec<usize> = rows.flat_map(|k| self.row(k)).map(|(dof, _)| dof).collect();
        unknowns.sort_unstable();
        unknowns.dedup();
        unknowns
    }

    /// Returns the free axes of the frame of `node`.
    pub fn free_axes(&self, node: usize) -> Vec<[f64; 3]> {
        let axes = self.axes(node).into_iter().enumerate();
        axes.filter(|(a, _)| !self.is_held_along(node, *a)).map(|(_, n)| n).collect()
    }

    /// Returns the axes of the frame of `node`, as many as there are dimensions.
    pub(super) fn axes(&self, node: usize) -> Vec<[f64; 3]> {
        let frame = self.frame(node).copied().unwrap_or([0, 1, 2].map(axis));
        frame[..self.node(node).len()].to_vec()
    }
}
