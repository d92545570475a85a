//! Contact coordinates `w = T u`, group by group: displacements of which each contact row is one.
//!
//! Contact rows couple only the displacements within their own group, usually those of one node. The remaining
//! displacements of a group are completed orthogonally. There `S u = f` becomes `Ŝ w = F` with `Ŝ = T⁻ᵀ S T⁻¹`,
//! `F = T⁻ᵀ f`, and a contact force acts on its own coordinate alone.

use faer::Mat;
use faer::linalg::solvers::DenseSolveCore;

use crate::algebra::union_find::UnionFind;
use crate::solver::problem::ContactProblem;

/// A row is linearly dependent if less than this share of it is orthogonal to the rows before it.
const INDEPENDENT: f64 = 1e-10;

pub(super) struct Coordinates {
    /// The coordinate of `w_n` of each contact node. `tangential` has that of `w_t` if the node has friction.
    pub normal: Vec<usize>,
    pub tangential: Vec<Option<usize>>,
    groups: Vec<Group>,
    order: usize,
}

/// A row of `C_n` or of a tangential map.
struct ContactRow<'a> {
    node: usize,
    is_tangential: bool,
    entries: &'a [(usize, f64)],
}

/// Displacements that contact rows couple. Coordinates are numbered group after group.
struct Group {
    displacements: Vec<usize>,
    first: usize,
    /// `T⁻¹`, row by row.
    inverse: Vec<f64>,
}

impl Coordinates {
    /// Creates the coordinates of a problem with the tangent `tangents[i]` of node `i` (0 for `C_t`, 1 for `C_o`).
    /// Returns `None` if contact rows are linearly dependent, so that their forces are not unique.
    pub(super) fn new(problem: &ContactProblem, tangents: &[Option<usize>]) -> Option<Self> {
        let (order, contacts) = (problem.displacements(), problem.contacts());
        let mut sets = UnionFind::new(order);
        let maps = problem.tangential_maps();
        let mut rows = Vec::new();
        for (node, tangent) in tangents.iter().enumerate() {
            rows.push(ContactRow { node, is_tangential: false, entries: problem.c_n().row(node) });
            let along = |k: &usize| ContactRow { node, is_tangential: true, entries: maps[*k].row(node) };
            rows.extend(tangent.iter().map(along));
        }
        for row in &rows {
            let (first, _) = row.entries.first()?;
            row.entries.iter().for_each(|(dof, _)| sets.join(*first, *dof));
        }
        let mut members: Vec<Vec<usize>> = vec![Vec::new(); order];
        (0..order).for_each(|dof| members[sets.least(dof)].push(dof));
        let mut rows_of: Vec<Vec<usize>> = vec![Vec::new(); order];
        rows.iter().enumerate().for_each(|(k, row)| rows_of[sets.least(row.entries[0].0)].push(k));

        let mut coordinates =
            Coordinates { normal: vec![0; contacts], tangential: vec![None; contacts], groups: Vec::new(), order };
        let mut first = 0;
        for (displacements, of_group) in members.into_iter().zip(rows_of).filter(|(members, _)| !members.is_empty()) {
            let size = displacements.len();
            let local = |k: &usize| {
                let mut dense = vec![0.0; size];
                for (dof, c) in rows[*k].entries {
                    if let Ok(place) = displacements.binary_search(dof) {
                        dense[place] = *c;
                    }
                }
                dense
            };
            let given: Vec<Vec<f64>> = of_group.iter().map(local).collect();
            let transform = completed(given, size)?;
            for (at, k) in of_group.iter().enumerate() {
                let ContactRow { node, is_tangential, .. } = rows[*k];
                if is_tangential {
                    coordinates.tangential[node] = Some(first + at);
                } else {
                    coordinates.normal[node] = first + at;
                }
            }
            let inverse = Mat::from_fn(size, size, |i, j| transform[i][j]).partial_piv_lu().inverse();
            let inverse =
                (0..size).flat_map(|i| (0..size).map(move |j| (i, j))).map(|(i, j)| inverse[(i, j)]).collect();
            coordinates.groups.push(Group { displacements, first, inverse });
            first += size;
        }
        Some(coordinates)
    }

    /// Returns the number of coordinates, which equals that of displacements.
    pub(super) fn order(&self) -> usize {
        self.order
    }

    /// Returns `Ŝ`, column by column, for a stiffness with the entries `of(i, j)`.
    pub(super) fn stiffness(&self, of: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        let n = self.order;
        let mut stiffness = vec![0.0; n * n];
        for b in &self.groups {
            for a in &self.groups {
                let (na, nb) = (a.displacements.len(), b.displacements.len());
                for i in 0..na {
                    for j in 0..nb {
                        let mut sum = 0.0;
                        for (k, &row) in a.displacements.iter().enumerate() {
                            for (l, &column) in b.displacements.iter().enumerate() {
                                let weight = a.inverse[k * na + i] * b.inverse[l * nb + j];
                                if weight != 0.0 {
                                    sum += weight * of(row, column);
                                }
                            }
                        }
                        stiffness[(b.first + j) * n + a.first + i] = sum;
                    }
                }
            }
        }
        stiffness
    }

    /// Computes `F = T⁻ᵀ f`.
    pub(super) fn forces(&self, f: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; self.order];
        for group in &self.groups {
            let size = group.displacements.len();
            for (k, &dof) in group.displacements.iter().enumerate() {
                for i in 0..size {
                    forces[group.first + i] += group.inverse[k * size + i] * f[dof];
                }
            }
        }
        forces
    }

    /// Computes `u = T⁻¹ w`.
    pub(super) fn displacements(&self, w: &[f64]) -> Vec<f64> {
        let mut u = vec![0.0; self.order];
        for group in &self.groups {
            let size = group.displacements.len();
            for (k, &dof) in group.displacements.iter().enumerate() {
                u[dof] = (0..size).map(|i| group.inverse[k * size + i] * w[group.first + i]).sum();
            }
        }
        u
    }
}

/// Completes `rows` by orthonormal rows, orthogonal to them, to a basis of dimension `size`.
fn completed(rows: Vec<Vec<f64>>, size: usize) -> Option<Vec<Vec<f64>>> {
    let mut orthonormal: Vec<Vec<f64>> = Vec::with_capacity(size);
    let normalised = |row: &[f64], orthonormal: &[Vec<f64>]| {
        let length = |row: &[f64]| row.iter().map(|x| x * x).sum::<f64>().sqrt();
        let (mut left, whole) = (row.to_vec(), length(row));
        // Two passes of orthogonalisation are enough.
        for other in orthonormal.iter().chain(orthonormal) {
            let projection: f64 = left.iter().zip(other).map(|(x, y)| x * y).sum();
            left.iter_mut().zip(other).for_each(|(x, y)| *x -= projection * y);
        }
        let share = length(&left) / whole;
        let scale = 1.0 / (share * whole);
        (share, left.into_iter().map(|x| x * scale).collect::<Vec<_>>())
    };
    for row in &rows {
        let (share, unit) = normalised(row, &orthonormal);
        if share.is_nan() || share < INDEPENDENT {
            return None;
        }
        orthonormal.push(unit);
    }
    let mut completed = rows;
    while completed.len() < size {
        let unit = |k: usize| (0..size).map(|i| f64::from(u8::from(i == k))).collect::<Vec<f64>>();
        let best = (0..size).map(|k| normalised(&unit(k), &orthonormal)).max_by(|a, b| a.0.total_cmp(&b.0))?;
        completed.push(best.1.clone());
        orthonormal.push(best.1);
    }
    Some(completed)
}

#[cfg(test)]
mod tests {
    use super::completed;

    #[test]
    fn rows_are_completed_at_right_angles() {
        let basis = completed(vec![vec![0.6, 0.8]], 2).unwrap();
        let product: f64 = basis[0].iter().zip(&basis[1]).map(|(a, b)| a * b).sum();
        assert!(product.abs() < 1e-15 && basis.len() == 2);
        assert_eq!(completed(Vec::new(), 2).unwrap().len(), 2);
        assert_eq!(completed(vec![vec![1.0, 2.0], vec![2.0, 4.0]], 2), None);
        assert_eq!(completed(vec![vec![1.0, 0.0], vec![0.0, 1.0], vec![1.0, 1.0]], 2), None);
    }
}
