//! A change of basis after which each contact row has only displacements of its own node.
//!
//! On boundaries of second order the rows of a midside node also contain displacements of the corners, which couples
//! all contact nodes. Let `e` be the displacements of node `i` that no other contact node has. Its rows are
//! `O u_e + A u_a`. Then
//!
//! ```text
//! u_e = ũ_e - Oᵀ (O Oᵀ)⁻¹ A u_a,   u_a = ũ_a
//! ```
//!
//! leaves only `O ũ_e` in them: `u = Q ũ`, the rows of `C Q` belong to single nodes again, and `Q⁻¹` differs from `Q`
//! in the sign of the off-diagonal entries.

use super::ContactProblem;
use crate::algebra::sparse::{Csr, DoubleDouble};
use crate::algebra::union_find::UnionFind;

/// A number of displacements larger than that of one node of a mesh.
const SEVERAL_NODES: usize = 4;

/// A row of `O Oᵀ` is linearly dependent if elimination leaves less than this share of it.
const INDEPENDENT: f64 = 1e-10;

/// A displacement, and its coefficients for others.
type Change = (usize, Vec<(usize, f64)>);

/// The matrix `Q`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct OwnBasis {
    /// The displacements that change, each with its coefficients for others.
    changed: Vec<Change>,
    /// `true` for each contact node whose transformed rows have only its own displacements.
    local: Vec<bool>,
    /// `true` for each displacement that belongs to only one such node.
    own: Vec<bool>,
}

impl OwnBasis {
    /// Creates `Q` of `problem`. Returns `None` if contact rows are coupled only within a node, as on boundaries of
    /// first order.
    pub(crate) fn of(problem: &ContactProblem) -> Option<Self> {
        let (n_u, n_c) = (problem.displacements(), problem.contacts());
        let rows = |i: usize| rows(problem, i);
        let mut sets = UnionFind::new(n_u);
        // The number of contact nodes that have each displacement, and the last of them.
        let mut owners = vec![(0_usize, 0_usize); n_u];
        for i in 0..n_c {
            let mut own: Vec<usize> = rows(i).flatten().map(|(dof, _)| *dof).collect();
            own.sort_unstable();
            own.dedup();
            for &dof in &own {
                owners[dof] = (owners[dof].0 + 1, i);
                sets.join(own[0], dof);
            }
        }
        let mut sizes = vec![0_usize; n_u];
        (0..n_u).filter(|&dof| owners[dof].0 > 0).for_each(|dof| sizes[sets.least(dof)] += 1);
        if sizes.iter().all(|size| *size < SEVERAL_NODES) {
            return None;
        }
        let mut basis = OwnBasis { changed: Vec::new(), local: vec![false; n_c], own: vec![false; n_u] };
        for i in 0..n_c {
            let rows: Vec<&[(usize, f64)]> = rows(i).filter(|row| !row.is_empty()).collect();
            if let Some(changes) = changes(&rows, |dof| owners[dof] == (1, i)) {
                basis.local[i] = true;
                for (dof, others) in changes {
                    basis.own[dof] = true;
                    if !others.is_empty() {
                        basis.changed.push((dof, others));
                    }
                }
            }
        }
        Some(basis)
    }

    /// Returns the displacements that change, each with its coefficients for others: `u_e = ũ_e + Σ c ũ_a`.
    pub(crate) fn changes(&self) -> &[(usize, Vec<(usize, f64)>)] {
        &self.changed
    }

    /// Replaces `ũ` by `u = Q ũ`.
    pub(crate) fn apply(&self, u: &mut [f64]) {
        for (dof, others) in &self.changed {
            u[*dof] += others.iter().map(|(other, c)| c * u[*other]).sum::<f64>();
        }
    }

    /// Applies `Q` to `u + u_rest`, where `u_rest` is below the rounding of `u`.
    pub(crate) fn apply_dd(&self, u: &mut [f64], u_rest: &mut [f64]) {
        for (dof, others) in &self.changed {
            let mut sum = DoubleDouble::default();
            sum.add(u[*dof]);
            sum.add(u_rest[*dof]);
            for (other, c) in others {
                sum.add_product(*c, u[*other]);
                sum.add(c * u_rest[*other]);
            }
            u[*dof] = sum.value();
            sum.add(-u[*dof]);
            u_rest[*dof] = sum.value();
        }
    }

    /// Replaces `u` by `ũ = Q⁻¹ u`.
    pub(crate) fn undo(&self, u: &mut [f64]) {
        for (dof, others) in &self.changed {
            u[*dof] -= others.iter().map(|(other, c)| c * u[*other]).sum::<f64>();
        }
    }

    /// Replaces `f` by `Qᵀ f`.
    pub(crate) fn apply_transposed(&self, f: &mut [f64]) {
        for (dof, others) in &self.changed {
            let force = f[*dof];
            for (other, c) in others {
                f[*other] += c * force;
            }
        }
    }

    /// Replaces the symmetric `S` by `Qᵀ S Q`, on the displacements `border` (ascending, with all that `Q` uses), m ×
    /// m, column by column.
    pub(crate) fn congruence(&self, border: &[usize], s: &mut [f64]) {
        let m = border.len();
        let index = |dof: &usize| border.binary_search(dof).expect("a contact displacement");
        for (dof, others) in &self.changed {
            let from = index(dof);
            let column = s[from * m..(from + 1) * m].to_vec();
            for (other, c) in others {
                let to = index(other);
                s[to * m..(to + 1) * m].iter_mut().zip(&column).for_each(|(to, from)| *to += c * from);
            }
        }
        for column in s.chunks_exact_mut(m) {
            for (dof, others) in &self.changed {
                let from = column[index(dof)];
                for (other, c) in others {
                    column[index(other)] += c * from;
                }
            }
        }
    }

    /// Returns row `i` of `map Q`, where `map` is a contact map.
    pub(crate) fn row(&self, map: &Csr, i: usize) -> Vec<(usize, f64)> {
        map.row(i).iter().copied().filter(|(dof, _)| !self.local[i] || self.own[*dof]).collect()
    }
}

/// Returns the rows of contact node `i`: the normal one, and with friction the tangential ones.
fn rows(problem: &ContactProblem, i: usize) -> impl Iterator<Item = &[(usize, f64)]> {
    let tangential = problem.tangential_maps().map(|map| if problem.mu()[i] > 0.0 { map.row(i) } else { &[] });
    [problem.c_n().row(i)].into_iter().chain(tangential)
}

/// Returns `-Oᵀ (O Oᵀ)⁻¹ A` for each displacement that only this node has, by the other displacements in its `rows`,
/// or `None` if the rows are not independent in its own displacements.
fn changes(rows: &[&[(usize, f64)]], is_own: impl Fn(usize) -> bool) -> Option<Vec<Change>> {
    let mut all: Vec<usize> = rows.iter().flat_map(|row| row.iter().map(|(dof, _)| *dof)).collect();
    all.sort_unstable();
    all.dedup();
    let (own, others): (Vec<usize>, Vec<usize>) = all.into_iter().partition(|dof| is_own(*dof));
    let entry = |row: &[(usize, f64)], dof: usize| row.iter().find(|(d, _)| *d == dof).map_or(0.0, |(_, c)| *c);
    let (r, columns) = (rows.len(), rows.len() + others.len());
    // [O Oᵀ | A], reduced to [1 | (O Oᵀ)⁻¹ A].
    let mut table: Vec<Vec<f64>> = (rows.iter())
        .map(|row| {
            let product = |other: &[(usize, f64)]| own.iter().map(|&d| entry(row, d) * entry(other, d)).sum::<f64>();
            rows.iter().map(|other| product(other)).chain(others.iter().map(|&d| entry(row, d))).collect()
        })
        .collect();
    for k in 0..r {
        let whole = rows[k].iter().map(|(_, c)| c * c).sum::<f64>();
        let pivot = table[k][k];
        if pivot.is_nan() || pivot <= INDEPENDENT * whole {
            return None;
        }
        for value in &mut table[k] {
            *value /= pivot;
        }
        let row = table[k].clone();
        for (_, other) in table.iter_mut().enumerate().filter(|(j, _)| *j != k) {
            let factor = other[k];
            (0..columns).for_each(|j| other[j] -= factor * row[j]);
        }
    }
    let change = |dof: usize| {
        let by = |j: usize| -(0..r).map(|k| entry(rows[k], dof) * table[k][r + j]).sum::<f64>();
        others.iter().enumerate().map(|(j, &other)| (other, by(j))).filter(|(_, c)| *c != 0.0).collect()
    };
    Some(own.iter().map(|&dof| (dof, change(dof))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::sparse::Symmetric;
    use crate::solver::problem::Parts;

    /// Creates a line of three nodes in the plane, the middle one between corners, in front of a slanted obstacle
    /// with friction; the last node is clamped along x.
    fn line() -> ContactProblem {
        let (n, t) = ([0.6, -0.8], [0.8, 0.6]);
        let dofs = [[Some(0), Some(1)], [Some(2), Some(3)], [None, Some(4)]];
        let along = |node: usize, direction: [f64; 2], factor: f64| {
            let pairs = dofs[node].into_iter().zip(direction);
            pairs.filter_map(move |(dof, c)| Some((dof?, factor * c))).collect::<Vec<_>>()
        };
        let rows = |direction: [f64; 2]| {
            let end = |node| along(node, direction, -0.5);
            [along(0, direction, 1.0), [along(1, direction, 2.0), end(0), end(2)].concat(), along(2, direction, 1.0)]
        };
        let [first, second, _] = rows(t);
        let entries = |i: usize| (0..=i).map(move |j| (i, j, if i == j { 4.0 + i as f64 } else { 0.3 }));
        let stiffness = Symmetric::from_triplets(5, &(0..5).flat_map(entries).collect::<Vec<_>>()).unwrap();
        let c_n = Csr::from_rows(5, rows(n)).unwrap();
        let c_t = Csr::from_rows(5, [first, second, Vec::new()]).unwrap();
        let parts = Parts { c_t, mu: vec![0.3; 3], rigid_modes: Some(Vec::new()), ..Parts::new(stiffness, c_n) };
        ContactProblem::new(parts).unwrap()
    }

    #[test]
    fn rows_become_those_of_single_nodes() {
        let problem = line();
        let basis = OwnBasis::of(&problem).unwrap();
        let columns = |map: &Csr, i: usize| basis.row(map, i).into_iter().map(|(dof, _)| dof).collect::<Vec<_>>();
        assert_eq!([0, 1, 2].map(|i| columns(problem.c_n(), i)), [vec![0, 1], vec![2, 3], vec![4]]);
        assert_eq!([0, 1, 2].map(|i| columns(problem.c_t(), i)), [vec![0, 1], vec![2, 3], vec![]]);
        let changed = [0.3, -0.7, 0.2, 0.9, -0.4];
        let mut u = changed;
        basis.apply(&mut u);
        for map in [problem.c_n(), problem.c_t()] {
            for i in 0..3 {
                let in_basis: f64 = basis.row(map, i).into_iter().map(|(dof, c)| c * changed[dof]).sum();
                assert!((in_basis - map.dot(i, &u)).abs() < 1e-15);
            }
        }
        let mut back = u;
        basis.undo(&mut back);
        assert!(back.iter().zip(changed).all(|(a, b)| (a - b).abs() < 1e-15));
        // uᵀ f = ũᵀ Qᵀ f, uᵀ K u = ũᵀ (Qᵀ K Q) ũ.
        let force = [1.0, 2.0, -3.0, 0.5, 0.7];
        let mut changed_force = force;
        basis.apply_transposed(&mut changed_force);
        let work = |u: &[f64], f: &[f64]| u.iter().zip(f).map(|(u, f)| u * f).sum::<f64>();
        assert!((work(&u, &force) - work(&changed, &changed_force)).abs() < 1e-14);
        let k = problem.stiffness().assembled().unwrap();
        let mut s: Vec<f64> = (0..25).map(|at| k.get((at % 5).max(at / 5), (at % 5).min(at / 5))).collect();
        basis.congruence(&[0, 1, 2, 3, 4], &mut s);
        let times: Vec<f64> = (0..5).map(|i| (0..5).map(|j| s[j * 5 + i] * changed[j]).sum()).collect();
        let mut energy = vec![0.0; 5];
        k.mul(&u, &mut energy);
        assert!((work(&u, &energy) - work(&changed, &times)).abs() < 1e-14);
        // Parts below the rounding of a number are kept.
        let (mut high, mut low) = (changed, [1e-20; 5]);
        basis.apply_dd(&mut high, &mut low);
        assert_eq!(high, u);
        assert!(low.iter().all(|low| low.abs() < 1e-15 && *low != 0.0), "{low:?}");
    }

    #[test]
    fn rows_of_single_nodes_stay() {
        let parts = line().into_parts();
        let diagonal = |c: f64| Csr::from_rows(5, [[(0, c)], [(2, c)], [(4, c)]]).unwrap();
        let single =
            ContactProblem::new(Parts { c_n: diagonal(-1.0), c_t: Csr::empty(3, 5).unwrap(), ..parts }).unwrap();
        assert_eq!(OwnBasis::of(&single), None);
    }
}
