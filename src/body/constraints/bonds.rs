//! Relations that determine displacements: those of carried nodes, and one for each row of a glued pair.
//!
//! A row of glue determines the displacement of its own node. If a support, a reference point or another row determines
//! it already, the row determines another of its nodes, so that the two sides are joined there, too.

use std::collections::{BTreeMap, BTreeSet};

use super::dofs::{Dofs, SAME_DIRECTION};
use super::relative::{Coefficient, Relative};
use crate::algebra::vector::{across, axis, norm};

/// The least coefficient of the node that a row determines, relative to the largest.
const PIVOT: f64 = 0.1;

/// A coefficient counts as rounding if it is at most this; the largest are about 1.
const ROUNDING: f64 = 1e-12;

/// The relations by the node that each determines.
#[derive(Debug, Default)]
pub(crate) struct Bonds(BTreeMap<usize, Relative>);

/// The error that a row joins two sides that supports hold along different directions, or two reference points.
#[derive(Debug)]
pub(crate) struct Apart;

impl Bonds {
    /// Creates the bonds of `relations`.
    pub(crate) fn new(relations: &[Relative]) -> Self {
        Bonds(relations.iter().map(|relation| (relation.node, relation.clone())).collect())
    }

    /// Adds a relation.
    pub(crate) fn add(&mut self, relation: Relative) {
        self.0.insert(relation.node, relation);
    }

    /// Returns `true` if a relation determines the displacement of `node`.
    pub(crate) fn bind(&self, node: usize) -> bool {
        self.0.contains_key(&node)
    }

    /// Returns the nodes on whose displacements that of `node` depends: itself if no relation determines it.
    pub(crate) fn roots(&self, node: usize) -> BTreeSet<usize> {
        let (mut roots, mut visited, mut left) = (BTreeSet::new(), BTreeSet::new(), vec![node]);
        while let Some(node) = left.pop() {
            match self.0.get(&node) {
                Some(bond) if visited.insert(node) => left.extend(bond.others.iter().map(|(other, _)| *other)),
                Some(_) => (),
                None => drop(roots.insert(node)),
            }
        }
        roots
    }

    /// Returns a relation of the bonds in terms of nodes that no relation determines, and of carried ones.
    pub(crate) fn resolved(&self, dofs: &Dofs, relation: &Relative) -> Relative {
        let others = self.terms(dofs, relation.others.clone(), false).into_iter().collect();
        Relative { others, ..relation.clone() }
    }

    /// Solves `relation` for a node that no other one determines: its own, unless that is bound, or held along
    /// directions `own_only` in which the other nodes may move. Returns `None` if the relation follows from others and
    /// from supports.
    ///
    /// # Errors
    /// [`Apart`] if there is no such node.
    pub(crate) fn solved(
        &self,
        dofs: &Dofs,
        relation: Relative,
        own_only: &[[f64; 3]],
    ) -> Result<Option<Relative>, Apart> {
        let own = relation.node;
        let open = |node: usize| self.expands(dofs, node).is_none();
        if own_only.is_empty() && !self.bind(own) && relation.others.iter().all(|(other, _)| open(*other)) {
            return Ok(Some(relation));
        }
        let with_own = [(own, Coefficient::Factor(-relation.own))].into_iter().chain(relation.others.iter().cloned());
        let with_own: Vec<(usize, Coefficient)> = with_own.collect();
        let terms = self.terms(dofs, with_own.clone(), true);
        let whole = Relative { others: terms.iter().map(|(&node, c)| (node, c.clone())).collect(), ..relation };
        if !(0..dofs.node(own).len()).any(|k| dofs.may_move(&whole, axis(k), |_, _| false)) {
            return Ok(None);
        }
        // Directions in which the other nodes of the row are held, too, need no relation.
        let held_apart = |node: usize| {
            let of_own: Vec<[f64; 3]> = dofs.held(own).collect();
            let is_other = |n: &[f64; 3]| norm(of_own.iter().copied().fold(*n, across)) > SAME_DIRECTION;
            let apart = if node == own { own_only.to_vec() } else { dofs.held(node).filter(is_other).collect() };
            let others = whole.others.iter().filter(|(other, _)| *other != node).cloned().collect();
            let others_only = Relative { node, others, ..whole.clone() };
            apart.into_iter().any(|n| dofs.may_move(&others_only, n, |_, _| false))
        };
        let fits = |node: usize| dofs.in_mesh(node) == node && !self.bind(node) && !held_apart(node);
        let candidates: Vec<(usize, f64)> = (terms.iter())
            .filter_map(|(&node, c)| match c {
                Coefficient::Factor(c) if fits(node) => Some((node, *c)),
                _ => None,
            })
            .collect();
        let largest = candidates.iter().fold(0.0_f64, |most, (_, c)| most.max(c.abs()));
        // On a plane of symmetry a node in the plane is preferred, which is held across it as the own one is.
        let rank = |(node, c): &(usize, f64)| (*node == own, dofs.held(*node).count(), c.abs());
        let pivot = (candidates.iter().filter(|(_, c)| c.abs() >= PIVOT * largest))
            .max_by(|a, b| rank(a).partial_cmp(&rank(b)).unwrap_or(std::cmp::Ordering::Equal));
        let &(node, c) = pivot.ok_or(Apart)?;
        let others = self.terms(dofs, with_own, false).into_iter().filter(|(other, _)| *other != node);
        let others = others.map(|(other, term)| (other, term.over(-c.signum()))).collect();
        Ok(Some(Relative { node, own: c.abs(), others, tied: true }))
    }

    /// Returns the relation of a bound node by which the node is replaced in other relations. A node that supports hold
    /// along a direction in which the others may move stays, as the relation does not count there.
    fn expands(&self, dofs: &Dofs, node: usize) -> Option<&Relative> {
        let counts = |bond: &&Relative| !dofs.held(node).any(|n| dofs.may_move(bond, n, |_, _| false));
        self.0.get(&node).filter(counts)
    }

    /// Returns the sum `left` of displacements with coefficients in terms of nodes that no relation determines; carried
    /// nodes stay unless `to_points`.
    fn terms(&self, dofs: &Dofs, mut left: Vec<(usize, Coefficient)>, to_points: bool) -> BTreeMap<usize, Coefficient> {
        let mut terms = BTreeMap::<usize, Coefficient>::new();
        while let Some((node, c)) = left.pop() {
            let is_to_point = |bond: &Relative| bond.others.iter().any(|(other, _)| dofs.is_rotation(*other));
            let bond = self.expands(dofs, node).filter(|bond| to_points || !is_to_point(bond));
            if let (Some(bond), Coefficient::Factor(c)) = (bond, &c) {
                left.extend(bond.others.iter().map(|(other, of)| (*other, of.over(bond.own / c))));
            } else {
                let sum = terms.get(&node).map_or_else(|| c.clone(), |sum| sum.plus(&c));
                terms.insert(node, sum);
            }
        }
        terms.retain(|_, c| c.size() > ROUNDING);
        terms
    }
}
