//! The natural units of a problem: what the error measure compares forces and motions with, whatever units single
//! unknowns and rows have.
//!
//! The stiffness of a contact node against a force on it is the scale of `r`.
//!
//! # Contact rows that depend on each other, so that their forces are not unique
//!
//! Where rows of `C` are linearly dependent, the contact forces have the same effect on the body if any relation of the rows
//! is added to them. The methods then find those that keep the friction of the last increment if they can, and have the least
//! pressures, in the norm `Σ |p_i|² / l_i` of the contact stresses in L². In this norm a dependent node has the stress that the
//! nodes on which it depends would interpolate there. They do so by the proximal point method: a dependent node gets small
//! compliances `e_n` and `e_T`, and its gap becomes `g_i + e_n (p_n - p̂_n)` and the origin of its slip
//! `w̄_T + e_T (p_T - p̂_T)`, with `p̂` the forces at the last solution of these equations, at first without pressures. When
//! `p = p̂`, the equations are those of the problem, and their matrix is regular.

use super::{ContactProblem, OwnBasis};
use crate::algebra::linear::Stiffness;
use crate::algebra::null_space::{NEGLIGIBLE, Row as Column, null_space};
use crate::algebra::sparse::{Csc, Csr};
use crate::algebra::union_find::UnionFind;
use crate::algebra::vector::median;
use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, Side};
use std::collections::{BTreeMap, BTreeSet};

/// The parts of the bodies that elasticity or contact connects, and the units of displacements and contact nodes.
///
/// With `√K_ii` as the unit of the forces on displacement `i`, and `√k_i` as that of the forces on contact node `i`,
/// where `k_i` is [`ContactProblem::contact_stiffness`], all forces are in `√J`. They do not change if an unknown or a
/// row of `C` is scaled.
#[derive(Debug, Clone)]
pub(crate) struct NaturalUnits {
    /// The part of each displacement.
    pub part: Vec<usize>,
    /// The part of each contact node.
    pub contact_part: Vec<usize>,
    /// The number of parts.
    pub parts: usize,
    /// `√K_ii`, or the largest of the part where `K_ii` is 0.
    pub displacement: Vec<f64>,
    /// `√k_i`.
    pub contact: Vec<f64>,
    /// `k_i`, N/m.
    pub contact_stiffness: Vec<f64>,
    /// The compliances of dependent contact nodes along normal and tangents in the proximal point method, m/N.
    pub compliance: Vec<[f64; 2]>,
}

impl NaturalUnits {
    pub(super) fn of(problem: &ContactProblem) -> Self {
        let mut sets = UnionFind::new(problem.displacements());
        match problem.stiffness() {
            Stiffness::Assembled(stiffness) => {
                let connected = stiffness.lower_entries().filter(|(.., value)| *value != 0.0);
                connected.for_each(|(row, column, _)| sets.join(row, column));
            }
            // No process sees all entries, so the whole is one part.
            Stiffness::Distributed(_) => (1..problem.displacements()).for_each(|dof| sets.join(0, dof)),
        }
        let row_of = |i: usize| [problem.c_n(), problem.c_t(), problem.c_o()].into_iter().flat_map(move |c| c.row(i));
        for i in 0..problem.contacts() {
            let mut row = row_of(i).map(|(dof, _)| *dof);
            if let Some(first) = row.next() {
                row.for_each(|dof| sets.join(first, dof));
            }
        }
        let (mut part, mut parts) = (vec![0; problem.displacements()], 0);
        for dof in 0..part.len() {
            let least = sets.least(dof);
            part[dof] = if least == dof { parts } else { part[least] };
            parts += usize::from(least == dof);
        }
        let contact_part = (0..problem.contacts()).map(|i| {
            row_of(i).next().map_or_else(
                || {
                    parts += 1;
                    parts - 1
                },
                |(dof, _)| part[*dof],
            )
        });
        let contact_part = contact_part.collect();
        let displacement = units(&problem.stiffness().diagonal(), &part, parts);
        let contact_stiffness = contact_stiffness(problem);
        let contact = contact_stiffness.iter().map(|k| k.sqrt()).collect();
        let compliance = problem.proximal_compliance(&contact_stiffness);
        NaturalUnits { part, contact_part, parts, displacement, contact, contact_stiffness, compliance }
    }

    /// Returns the units of the problem on some contact `nodes`.
    pub(super) fn of_nodes(&self, nodes: &[usize]) -> Self {
        let of_nodes = |values: &[f64]| nodes.iter().map(|&i| values[i]).collect();
        NaturalUnits {
            contact_part: nodes.iter().map(|&i| self.contact_part[i]).collect(),
            contact: of_nodes(&self.contact),
            contact_stiffness: of_nodes(&self.contact_stiffness),
            compliance: nodes.iter().map(|&i| self.compliance[i]).collect(),
            ..self.clone()
        }
    }

    /// Returns the units of a problem condensed on the displacements `kept`, with the `diagonal` of its stiffness.
    pub(crate) fn condensed(&self, kept: &[usize], diagonal: &[f64]) -> Self {
        let part: Vec<usize> = kept.iter().map(|&dof| self.part[dof]).collect();
        NaturalUnits { displacement: units(diagonal, &part, self.parts), part, ..self.clone() }
    }
}

/// Returns the square roots of the `diagonal`, or the largest of the part where it is 0.
fn units(diagonal: &[f64], part: &[usize], parts: usize) -> Vec<f64> {
    let mut units: Vec<f64> = diagonal.iter().map(|k| k.max(0.0).sqrt()).collect();
    let mut largest = vec![0.0_f64; parts];
    part.iter().zip(&units).for_each(|(&part, unit)| largest[part] = largest[part].max(*unit));
    for (unit, &part) in units.iter_mut().zip(part).filter(|(unit, _)| **unit == 0.0) {
        *unit = if largest[part] > 0.0 { largest[part] } else { 1.0 };
    }
    units
}

/// The displacements that share a stiffness entry with the normal motion of a contact node, ascending; with finite
/// elements, those of the adjacent elements.
type Patch = Vec<usize>;

/// A patch stiffness below this share of a node's own stiffness may be rounding of a patch that rotates about clamped
/// displacements. True contrasts of twelve decades cannot be distinguished from that.
const STIFFNESS_ROUNDING: f64 = 1e-12;

impl ContactProblem {
    /// Returns the stiffness of each contact node along its normal, with all other displacements of its patch free
    /// and everything beyond clamped, n_c, N/m: `1 / (C_n K_PP⁻¹ C_nᵀ)_ii` with `K_PP` the rows and columns of the
    /// displacements that the node's own are coupled to.
    ///
    /// It approximates `1 / C_nn`, the inverse of the compliance `C_n K⁻¹ C_nᵀ`, without far-field effects such as
    /// bending of a slender body, or a stiffness against volume change that does not act on surface nodes. If the
    /// patch could move as a rigid body, it is a quarter of the node's own `c K cᵀ / (c cᵀ)²`, which is about the same
    /// in a uniform mesh.
    pub fn contact_stiffness(&self) -> &[f64] {
        &self.natural().contact_stiffness
    }

    /// Returns `c K cᵀ / (c cᵀ)²`, N/m, of row `i` of `C_n`: the stiffness of the contact node along its normal with all
    /// other displacements clamped.
    pub(crate) fn own_stiffness(&self, i: usize) -> f64 {
        own_stiffness(&self.stiffness().at_hand(), self.c_n(), i)
    }

    /// Factors `K_PP`. Returns `None` if the patch is the whole body and nothing stops it, or if it is singular.
    fn factors(&self, at_hand: &Csc, patch: &Patch) -> Option<Llt<f64>> {
        if patch.len() == self.displacements() && !self.rigid_modes.is_empty() {
            return None;
        }
        let (pattern, values) = (at_hand.pattern(), at_hand.values());
        let mut matrix = Mat::zeros(patch.len(), patch.len());
        for (j, &column) in patch.iter().enumerate() {
            for slot in pattern.column(column) {
                if let Ok(i) = patch.binary_search(&(pattern.row_indices()[slot] as usize)) {
                    matrix[(i, j)] = values[slot];
                }
            }
        }
        matrix.llt(Side::Lower).ok()
    }
}

/// Computes [`ContactProblem::contact_stiffness`].
pub(super) fn contact_stiffness(problem: &ContactProblem) -> Vec<f64> {
    // The entries of a distributed stiffness in this process cover the patches.
    let at_hand = problem.stiffness().at_hand();
    let patches = patches(&at_hand, problem.c_n());
    let mut last: Option<(&Patch, Option<Llt<f64>>)> = None;
    let mut stiffness = Vec::with_capacity(patches.len());
    for (i, patch) in patches.iter().enumerate() {
        // In a dense matrix all patches are the same.
        let factors = match last.take() {
            Some((same, factors)) if same == patch => factors,
            _ => problem.factors(&at_hand, patch),
        };
        let compliance = factors.as_ref().map(|factors| compliance(factors, patch, problem.c_n().row(i)));
        let own = own_stiffness(&at_hand, problem.c_n(), i);
        let usable = compliance.map(|c| 1.0 / c).filter(|k| k.is_finite() && *k > STIFFNESS_ROUNDING * own);
        stiffness.push(usable.unwrap_or(0.25 * own));
        last = Some((patch, factors));
    }
    // A node without stiffness of its own gets a typical value of the body; any scale will do.
    if stiffness.contains(&0.0) {
        let mut present: Vec<f64> = problem.stiffness().diagonal().into_iter().filter(|k| *k > 0.0).collect();
        let typical = median(&mut present).unwrap_or(1.0);
        stiffness.iter_mut().filter(|k| **k == 0.0).for_each(|k| *k = typical);
    }
    stiffness
}

/// Returns `c K cᵀ / (c cᵀ)²` of row `i` of `C_n` from the entries in this process, which contain the lower triangle at contact nodes.
fn own_stiffness(at_hand: &Csc, c_n: &Csr, i: usize) -> f64 {
    let entry =
        |a: usize, b: usize| at_hand.pattern().slot(a.max(b), a.min(b)).map_or(0.0, |slot| at_hand.values()[slot]);
    let row = c_n.row(i);
    let pairs = row.iter().flat_map(|a| row.iter().map(move |b| (a, b)));
    let square: f64 = row.iter().map(|(_, c)| c * c).sum();
    if square == 0.0 { 0.0 } else { pairs.map(|(a, b)| a.1 * b.1 * entry(a.0, b.0)).sum::<f64>() / square.powi(2) }
}

/// Returns `c K_PP⁻¹ cᵀ` of a row `c` of `C_n`.
fn compliance(factors: &Llt<f64>, patch: &Patch, row: &[(usize, f64)]) -> f64 {
    let mut force = Mat::zeros(patch.len(), 1);
    let index = |dof: usize| patch.binary_search(&dof);
    for &(dof, c) in row {
        if let Ok(k) = index(dof) {
            force[(k, 0)] = c;
        }
    }
    let moved = factors.solve(&force);
    row.iter().map(|&(dof, c)| index(dof).map_or(0.0, |k| c * moved[(k, 0)])).sum()
}

/// Returns the patch of each contact node.
fn patches(at_hand: &Csc, c_n: &Csr) -> Vec<Patch> {
    let mut nodes_of = vec![Vec::new(); c_n.columns()];
    for i in 0..c_n.rows() {
        c_n.row(i).iter().for_each(|&(dof, _)| nodes_of[dof].push(i));
    }
    let mut patches = vec![Patch::new(); c_n.rows()];
    for (row, column, _) in at_hand.entries() {
        nodes_of[row].iter().for_each(|&i| patches[i].push(column));
        nodes_of[column].iter().for_each(|&i| patches[i].push(row));
    }
    for patch in &mut patches {
        patch.sort_unstable();
        patch.dedup();
    }
    patches
}

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
                let terms = group.iter().zip(relation).filter(|(_, weight)| weight.abs() > NEGLIGIBLE);
                found.extend(terms.map(|((node, _), _)| *node));
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

    /// Creates `n` points in a row with unit springs between them, the last one on a wall by another if it is
    /// `clamped`; every point is a contact node.
    fn chain(n: usize, clamped: bool) -> ContactProblem {
        let clamped_end = (n - 1, n - 1, f64::from(u8::from(clamped)));
        let springs = (1..n).flat_map(|i| [(i - 1, i - 1, 1.0), (i, i, 1.0), (i, i - 1, -1.0)]);
        let stiffness = Symmetric::from_triplets(n, &springs.chain([clamped_end]).collect::<Vec<_>>()).unwrap();
        let c_n = Csr::of_rows(n, (0..n).map(|i| [(i, -1.0)]));
        let none = Csr::empty(n, n).unwrap();
        ContactProblem::new(Parts {
            stiffness: stiffness.into(),
            c_n,
            c_t: none.clone(),
            c_o: none,
            mu: vec![0.0; n],
            weight: Some(vec![1.0; n]),
            rigid_modes: Some(if clamped { Vec::new() } else { vec![vec![1.0; n]] }),
        })
        .unwrap()
    }

    fn assert_close(found: &[f64], expected: &[f64]) {
        assert_eq!(found.len(), expected.len());
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?}");
    }

    /// There are two springs in a row on either side; those to the free end carry nothing.
    #[test]
    fn what_is_beyond_the_neighbours_is_clamped() {
        assert_close(chain(6, true).contact_stiffness(), &[0.5, 0.5, 1.0, 1.0, 1.0, 1.5]);
    }

    /// The middle point has no points beyond its neighbours.
    #[test]
    fn a_patch_that_moves_as_a_rigid_body() {
        assert_close(chain(3, false).contact_stiffness(), &[0.5, 0.25 * 2.0, 0.5]);
    }

    #[test]
    fn in_a_dense_matrix_it_is_the_inverse_of_the_compliance() {
        // K = 1 + e eᵀ, K⁻¹ = 1 - e eᵀ / (n + 1).
        let n = 5;
        let entry = |i: usize, j: usize| (i, j, if i == j { 2.0 } else { 1.0 });
        let entries: Vec<_> = (0..n).flat_map(|i| (0..=i).map(move |j| entry(i, j))).collect();
        let stiffness = Symmetric::from_triplets(n, &entries).unwrap();
        let problem =
            ContactProblem::new(Parts { stiffness: stiffness.into(), ..chain(n, true).into_parts() }).unwrap();
        assert_close(problem.contact_stiffness(), &[1.2; 5]);
    }

    /// Two nodes that slide along one displacement depend on each other with friction only.
    #[test]
    fn friction_decides_what_is_dependent() {
        let stiffness = Symmetric::from_triplets(3, &[(0, 0, 2.0), (1, 1, 2.0), (2, 2, 2.0)]).unwrap();
        let [c_n, c_t] = [[1, 2], [0, 0]].map(|at| Csr::from_rows(3, at.map(|k| [(k, 1.0)])).unwrap());
        let smooth = ContactProblem::new(Parts { c_t, mu: vec![0.0; 2], ..Parts::new(stiffness, c_n) }).unwrap();
        assert_eq!(smooth.natural().compliance, [[0.0; 2]; 2]);
        let frictional = smooth.with_friction(vec![0.3; 2]).unwrap();
        assert!(frictional.natural().compliance.iter().all(|e| e[0] > 0.0));
        assert_eq!(frictional.with_friction(vec![0.0; 2]).unwrap().natural().compliance, [[0.0; 2]; 2]);
    }
}
