//! Linearly dependent tangents.
//!
//! If a support holds a contact node, its row along the held direction contains only displacements of the other body.
//! Several such nodes in front of few nodes of the other body have more rows than these nodes have displacements. Then
//! sticking at some nodes follows from sticking at others, and the equations do not determine their forces.

use std::collections::{BTreeMap, BTreeSet};

use super::kinematics::{ContactNode, Counterpart, Row};
use crate::body::fem::Dofs;

/// A row counts as dependent on earlier rows if elimination leaves less than this share of it.
const INDEPENDENT: f64 = 1e-3;

/// Removes the tangents of `contacts` whose rows depend on other rows; `mu` are the friction coefficients.
pub fn leave_out_dependent(contacts: &mut [ContactNode], mu: &[f64], dofs: &Dofs) {
    let has_too_few = |i: &usize| {
        let contact = &contacts[*i];
        let rows = 1 + contact.tangents.iter().filter(|row| !row.is_empty()).count();
        contact.coupled().is_some_and(|coupled| coupled.relative)
            && dofs.node(contact.node).iter().flatten().count() < rows
    };
    let supported: Vec<usize> = (0..contacts.len()).filter(has_too_few).collect();
    let mut known = Echelon::default();
    for &i in &supported {
        known.add(&contacts[i].normal);
    }
    for i in supported.into_iter().filter(|&i| mu[i] > 0.0) {
        let contact = &mut contacts[i];
        let there: Vec<usize> = (0..2).filter(|&k| !contact.tangents[k].is_empty()).collect();
        let kept: Vec<usize> = there.iter().copied().filter(|&k| known.add(&contact.tangents[k])).collect();
        if kept.len() < there.len() {
            let tangents = contact.facing.tangents;
            contact.slide_along(dofs, [0, 1].map(|k| kept.get(k).map_or([0.0; 3], |&k| tangents[k])));
            if let Counterpart::Boundary(coupled) = &mut contact.counterpart {
                coupled.tangent_left_out = true;
            }
        }
    }
}

/// Rows in echelon form: no row contains the pivots of earlier rows.
#[derive(Default)]
struct Echelon {
    rows: Vec<(usize, Row)>,
    of_pivot: BTreeMap<usize, usize>,
}

impl Echelon {
    /// Adds a row; returns `true` if it is independent of the earlier rows.
    fn add(&mut self, row: &Row) -> bool {
        let mut rest: BTreeMap<usize, f64> = row.iter().copied().collect();
        let mut to_do: BTreeSet<usize> = rest.keys().filter_map(|dof| self.of_pivot.get(dof).copied()).collect();
        while let Some(k) = to_do.pop_first() {
            let (pivot, known) = &self.rows[k];
            let factor = rest.get(pivot).copied().unwrap_or(0.0);
            for (dof, c) in known {
                *rest.entry(*dof).or_insert(0.0) -= factor * c;
                to_do.extend(self.of_pivot.get(dof).filter(|later| **later > k));
            }
            rest.remove(pivot);
        }
        let size = row.iter().fold(0.0_f64, |size, (_, c)| size.max(c.abs()));
        let largest = rest.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).map(|(dof, c)| (*dof, *c));
        let Some((pivot, c)) = largest.filter(|(_, c)| c.abs() > INDEPENDENT * size) else { return false };
        self.of_pivot.insert(pivot, self.rows.len());
        self.rows.push((pivot, rest.into_iter().map(|(dof, value)| (dof, value / c)).collect()));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_depend_on_others_are_found() {
        let mut known = Echelon::default();
        let add = |known: &mut Echelon, row: &[(usize, f64)]| known.add(&row.to_vec());
        assert!(add(&mut known, &[(0, 1.0), (1, 2.0)]));
        assert!(add(&mut known, &[(1, 1.0), (2, 1.0)]));
        assert!(!add(&mut known, &[(0, 2.0), (1, 3.0), (2, -1.0)]));
        assert!(add(&mut known, &[(0, 2.0), (1, 3.0), (2, 1.0)]));
        assert!(!add(&mut known, &[(2, 0.5)]));
        assert!(!add(&mut known, &[]));
    }
}
