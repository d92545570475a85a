//! Contact rows that depend on each other, so that their forces are not unique.
//!
//! Where rows of `C` are linearly dependent, the contact forces have the same effect on the body if any relation of the rows
//! is added to them. The methods then find those that keep the friction of the last increment if they can, and have the least
//! pressures, in the norm `Σ |p_i|² / l_i` of the contact stresses in L². In this norm a dependent node has the stress that the
//! nodes on which it depends would interpolate there. They do so by the proximal point method: a dependent node gets small
//! compliances `e_n` and `e_T`, and its gap becomes `g_i + e_n (p_n - p̂_n)` and the origin of its slip
//! `w̄_T + e_T (p_T - p̂_T)`, with `p̂` the forces at the last solution of these equations, at first without pressures. When
//! `p = p̂`, the equations are those of the problem, and their matrix is regular.

use std::collections::{BTreeMap, BTreeSet};

use super::{ContactProblem, OwnBasis};
use crate::algebra::null_space::{NEGLIGIBLE, Row as Column, null_space};
use crate::algebra::sparse::Csr;
use crate::algebra::union_find::UnionFind;
use crate::algebra::vector::median;

/// The compliances of a dependent node along normal and tangents, relative to that of a typical one: each solution gains so many
/// digits. If friction yields 1e3 to 1e5 times as easily as pressure, BN finds a slender body on an edge between two obstacles
/// with friction coefficients of 0.4 and 0.7, and not with 1.0; with equal compliances it finds none of the three.
const COMPLIANCE: [f64; 2] = [1e-9, 1e-5];

/// A contact node and one of its rows.
type Row = (usize, Vec<(usize, f64)>);

impl ContactProblem {
    /// Returns the contact nodes whose rows depend on others, ascending. Each group of rows that share displacements
    /// has its own linear relations, the null space of its transpose.
    pub(crate) fn dependent_nodes(&self) -> Vec<usize> {
        // A change of basis preserves the relations, and keeps the groups small.
        let basis = OwnBasis::of(self);
        let row = |map: &Csr, i: usize| basis.as_ref().map_or_else(|| map.row(i).to_vec(), |basis| basis.row(map, i));
        let rows: Vec<Row> = (0..self.contacts())
            .flat_map(|i| {
                let tangential = self.tangential_maps().map(|map| row(map, i));
                let sliding = tangential.into_iter().filter(move |row| self.mu()[i] > 0.0 && !row.is_empty());
                [row(self.c_n(), i)].into_iter().chain(sliding).map(move |row| (i, row)).collect::<Vec<_>>()
            })
            .collect();
        let mut found = BTreeSet::new();
        for group in groups(&rows) {
            let mut columns = BTreeMap::new();
            for (place, (_, row)) in group.iter().enumerate() {
                let length = row.iter().map(|(_, c)| c * c).sum::<f64>().sqrt();
                for &(column, c) in row {
                    columns.entry(column).or_insert_with(|| vec![0.0; group.len()])[place] += c / length;
                }
            }
            // The rows have been brought to length one.
            for relation in null_space(group.len(), columns.into_values().map(Column::of_unit_size)) {
                let part = group.iter().zip(relation).filter(|(_, weight)| weight.abs() > NEGLIGIBLE);
                found.extend(part.map(|((node, _), _)| *node));
            }
        }
        found.into_iter().collect()
    }

    /// Returns the compliances `(e_n, e_T)` of each contact node, m/N, from its stiffness `k_i` (N/m): inversely proportional to
    /// `l_i` if the node is dependent, and 0 if not.
    pub(super) fn proximal_compliance(&self, contact_stiffness: &[f64]) -> Vec<[f64; 2]> {
        let mut compliance = vec![[0.0; 2]; self.contacts()];
        let nodes = self.dependent_nodes();
        let weight = |i: usize| self.weight().map_or(1.0, |l| l[i]);
        let mut sizes: Vec<f64> = nodes.iter().map(|&i| weight(i) / contact_stiffness[i]).collect();
        if let Some(typical) = median(&mut sizes) {
            for i in nodes {
                compliance[i] = COMPLIANCE.map(|e| e * typical / weight(i));
            }
        }
        compliance
    }
}

/// Splits the rows into groups without common displacements. An empty row is a group of its own.
fn groups(rows: &[Row]) -> Vec<Vec<&Row>> {
    let mut sets = UnionFind::new(rows.len());
    let mut first = BTreeMap::new();
    for (k, (_, row)) in rows.iter().enumerate() {
        for (column, _) in row {
            sets.join(*first.entry(column).or_insert(k), k);
        }
    }
    let mut groups = BTreeMap::<usize, Vec<&Row>>::new();
    for (k, row) in rows.iter().enumerate() {
        groups.entry(sets.least(k)).or_default().push(row);
    }
    groups.into_values().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::sparse::Symmetric;
    use crate::solver::problem::Parts;

    /// Two nodes that slide along one displacement depend on each other with friction only.
    #[test]
    fn friction_decides_what_is_dependent() {
        let stiffness = Symmetric::from_triplets(3, &[(0, 0, 2.0), (1, 1, 2.0), (2, 2, 2.0)]).unwrap();
        let [c_n, c_t] = [[1, 2], [0, 0]].map(|at| Csr::from_rows(3, at.map(|k| [(k, 1.0)])).unwrap());
        let smooth = ContactProblem::new(Parts { c_t, mu: vec![0.0; 2], ..Parts::new(stiffness, c_n) }).unwrap();
        assert_eq!(smooth.natural().compliance, [[0.0; 2]; 2]);
        let rough = smooth.with_friction(vec![0.3; 2]).unwrap();
        assert!(rough.natural().compliance.iter().all(|e| e[0] > 0.0));
        assert_eq!(rough.with_friction(vec![0.0; 2]).unwrap().natural().compliance, [[0.0; 2]; 2]);
    }
}
