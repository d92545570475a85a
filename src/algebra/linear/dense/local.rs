//! The contact rows of one group of nodes that share displacements (usually one node), solved before any coupling.
//!
//! With the displacements `u` (c) and the other unknowns `q` (k) of the group, the k contact rows
//! `A u + D q = b` have the solutions
//!
//! ```text
//! u = P_u b + V t        q = P_q b + Y t + Z s
//! ```
//!
//! with c parameters in total: `t` moves displacements, the reactions `s` do not. In the equilibrium rows,
//! `… + E u + B q`, the reactions are found at the end, by `H B Z = 1`, and until then are excluded by `Wᵀ B Z = 0`.
//! An open node has two `t`, a slipping node has one `t` and one `s`, with `Z = (μ s, 1)` in `(p_t, p_n)`, and a
//! sticking node has two reactions. In an interior point method all parameters are `t`. Oblique normals only add
//! entries to the small matrices.

use crate::algebra::linear::{Computed, LinearError};
use crate::algebra::vector::dot;

/// The solutions of the contact rows of a group.
pub(super) struct Local {
    /// The number of displacements; `others` is that of the other unknowns.
    displacements: usize,
    others: usize,
    /// The number of parameters `t`.
    pub moving: usize,
    /// `[A D]`, row by row.
    pub rows: Vec<f64>,
    /// `[E B]`, row by row.
    pub forces: Vec<f64>,
    /// `[P_u; P_q]`, row by row.
    particular: Vec<f64>,
    /// `[V 0; Y Z]`, column by column.
    null: Vec<f64>,
    /// `[Wᵀ; H]`, row by row.
    left: Vec<f64>,
}

impl Local {
    /// Solves `[A D]`, given as `rows`, for a group with these numbers of displacements and other unknowns. `forces`
    /// is `[E B]`, their effect on equilibrium. Both are stored row by row.
    ///
    /// # Errors
    /// [`LinearError::Singular`] if the rows, or the reactions, are linearly dependent; [`LinearError::NotFinite`] if
    /// an entry is not finite.
    pub(super) fn new(displacements: usize, others: usize, rows: Vec<f64>, forces: Vec<f64>) -> Computed<Self> {
        if !rows.iter().chain(&forces).all(|value| value.is_finite()) {
            return Err(LinearError::NotFinite);
        }
        let singular = LinearError::Singular { pivot_ratio: 0.0 };
        let (c, n) = (displacements, displacements + others);
        // [A D | 1], with every row divided by its largest entry.
        let mut table = Table::new(others, n, others);
        for (i, row) in rows.chunks_exact(n).enumerate() {
            let largest = row.iter().fold(0.0_f64, |m, value| m.max(value.abs()));
            if largest == 0.0 {
                return Err(singular);
            }
            table.row(i).iter_mut().zip(row).for_each(|(to, from)| *to = from / largest);
            table.row(i)[n + i] = 1.0 / largest;
        }
        let pivots = table.solve(f64::EPSILON);
        if pivots.len() < others {
            return Err(singular);
        }
        let mut row_of = vec![None; n];
        let mut particular = vec![0.0; n * others];
        for &(row, column) in &pivots {
            row_of[column] = Some(row);
            particular[column * others..][..others].copy_from_slice(&table.row(row)[n..]);
        }
        let (mut null, mut reactions) = (Vec::with_capacity(n * c), Vec::new());
        for free in (0..n).filter(|&column| row_of[column].is_none()) {
            let column: Vec<f64> = (0..n)
                .map(|k| row_of[k].map_or(if k == free { 1.0 } else { 0.0 }, |row| -table.row(row)[free]))
                .collect();
            let moves = column[..c].iter().any(|value| *value != 0.0);
            (if moves { &mut null } else { &mut reactions }).extend(column);
        }
        let moving = null.len() / n.max(1);
        null.append(&mut reactions);
        let mut local = Local { displacements, others, moving, rows, forces, particular, null, left: Vec::new() };
        local.left = local.eliminate_reactions().ok_or(singular)?;
        Ok(local)
    }

    /// Returns `[Wᵀ; H]`, or `None` if the reactions are linearly dependent.
    fn eliminate_reactions(&self) -> Option<Vec<f64>> {
        let (c, reactions) = (self.displacements, self.displacements - self.moving);
        // [B Z | 1]
        let mut table = Table::new(c, reactions, c);
        let mut largest = 0.0_f64;
        for i in 0..c {
            table.row(i)[reactions + i] = 1.0;
        }
        for j in 0..reactions {
            let force = self.act(self.column(self.moving + j));
            for (i, value) in force.enumerate() {
                table.row(i)[j] = value;
                largest = largest.max(value.abs());
            }
        }
        let pivots = table.solve(f64::EPSILON * largest);
        if pivots.len() < reactions {
            return None;
        }
        let of_reaction = |j: usize| pivots.iter().find(|pivot| pivot.1 == j).map(|pivot| pivot.0);
        let without = (0..c).filter(|&row| pivots.iter().all(|pivot| pivot.0 != row));
        let rows: Vec<usize> = without.chain((0..reactions).filter_map(of_reaction)).collect();
        Some(rows.into_iter().flat_map(|row| table.row(row)[reactions..].to_vec()).collect())
    }

    /// Returns `E u + B q` for `x = (u, q)`.
    pub(super) fn act<'a>(&'a self, x: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let n = self.displacements + self.others;
        (0..self.displacements).map(move |i| dot(&self.forces[i * n..(i + 1) * n], x))
    }

    /// Returns column `j` of `[V 0; Y Z]`.
    fn column(&self, j: usize) -> &[f64] {
        let n = self.displacements + self.others;
        &self.null[j * n..(j + 1) * n]
    }

    /// Returns column `j` of `V`.
    pub(super) fn motion(&self, j: usize) -> &[f64] {
        &self.column(j)[..self.displacements]
    }

    /// Returns row `i` of `Wᵀ`.
    pub(super) fn projection(&self, i: usize) -> &[f64] {
        &self.left[i * self.displacements..(i + 1) * self.displacements]
    }

    /// Returns `Wᵀ r`.
    pub(super) fn project<'a>(&'a self, r: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        (0..self.moving).map(move |i| dot(self.projection(i), r))
    }

    /// Returns column `j` of `Wᵀ (E V + B Y)`.
    pub(super) fn own(&self, j: usize) -> Vec<f64> {
        let force: Vec<f64> = self.act(self.column(j)).collect();
        self.project(&force).collect()
    }

    /// Returns `u = P_u b`, `q = P_q b`.
    pub(super) fn start<'a>(&'a self, b: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let rows = 0..self.displacements + self.others;
        rows.map(move |k| dot(&self.particular[k * self.others..(k + 1) * self.others], b))
    }

    /// Returns `V t`, `Y t`.
    pub(super) fn moved(&self, t: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; self.displacements + self.others];
        for (j, factor) in t.iter().enumerate() {
            x.iter_mut().zip(self.column(j)).for_each(|(x, n)| *x += factor * n);
        }
        x
    }

    /// Returns `true` if there are reactions.
    pub(super) fn reacts(&self) -> bool {
        self.moving < self.displacements
    }

    /// Adds `Z H r` to `q`.
    pub(super) fn react(&self, r: &[f64], q: &mut [f64]) {
        let c = self.displacements;
        for j in self.moving..c {
            let reaction = dot(self.projection(j), r);
            q.iter_mut().zip(&self.column(j)[c..]).for_each(|(q, n)| *q += reaction * n);
        }
    }
}

/// A small matrix augmented by another one, row by row, for Gauss–Jordan elimination.
struct Table {
    rows: usize,
    columns: usize,
    width: usize,
    entries: Vec<f64>,
}

impl Table {
    fn new(rows: usize, columns: usize, beside: usize) -> Self {
        let width = columns + beside;
        Table { rows, columns, width, entries: vec![0.0; rows * width] }
    }

    fn row(&mut self, i: usize) -> &mut [f64] {
        &mut self.entries[i * self.width..(i + 1) * self.width]
    }

    /// Turns as many columns as possible into unit vectors, the largest pivot first, until the remaining entries are
    /// at most `tiny`. Returns the (row, column) of each 1.
    fn solve(&mut self, tiny: f64) -> Vec<(usize, usize)> {
        let mut pivots = Vec::with_capacity(self.rows);
        let mut done = vec![false; self.rows];
        loop {
            let (mut best, mut largest) = (None, tiny);
            for i in (0..self.rows).filter(|&i| !done[i]) {
                for (j, value) in self.entries[i * self.width..][..self.columns].iter().enumerate() {
                    if value.abs() > largest {
                        (best, largest) = (Some((i, j)), value.abs());
                    }
                }
            }
            let Some((row, column)) = best else { return pivots };
            let mut pivot_row = self.row(row).to_vec();
            let pivot = pivot_row[column];
            for value in &mut pivot_row {
                *value /= pivot;
            }
            pivot_row[column] = 1.0;
            for i in 0..self.rows {
                let to = self.row(i);
                let factor = to[column];
                if i != row && factor != 0.0 {
                    to.iter_mut().zip(&pivot_row).for_each(|(to, from)| *to -= factor * from);
                    to[column] = 0.0;
                }
            }
            self.row(row).copy_from_slice(&pivot_row);
            done[row] = true;
            pivots.push((row, column));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the forces of a node with the normal `(n_x, n_y)` and the tangent orthogonal to it.
    fn coupling([n_x, n_y]: [f64; 2]) -> [f64; 4] {
        // B = C^T with the unknowns (p_t, p_n).
        [-n_y, n_x, n_x, n_y]
    }

    /// Returns `[E B]` of a node with these forces, without springs.
    fn with_forces(b: &[f64; 4]) -> Vec<f64> {
        vec![0.0, 0.0, b[0], b[1], 0.0, 0.0, b[2], b[3]]
    }

    fn parameters(normal: [f64; 2], tangential_row: [f64; 4], normal_row: [f64; 4]) -> usize {
        let (rows, b) = ([tangential_row, normal_row].concat(), coupling(normal));
        let local = Local::new(2, 2, rows.clone(), with_forces(&b)).unwrap();
        for j in 0..2 {
            let column = local.column(j);
            for row in rows.chunks_exact(4) {
                assert!(dot(row, column).abs() < 1e-15 * row.iter().fold(0.0_f64, |m, x| m.max(x.abs())));
            }
            // W^T B Z = 0 and H B Z = 1.
            if j >= local.moving {
                let force: Vec<f64> = local.act(column).collect();
                assert!(local.project(&force).all(|value| value.abs() < 1e-15));
                let mut q = [0.0; 2];
                local.react(&force, &mut q);
                assert!(q.iter().zip(&column[2..]).all(|(q, z)| (q - z).abs() < 1e-15));
            }
        }
        let given = [0.3, -0.7];
        let x: Vec<f64> = local.start(&given).collect();
        for (row, b) in rows.chunks_exact(4).zip(given) {
            assert!((dot(row, &x) - b).abs() < 1e-15);
        }
        local.moving
    }

    #[test]
    fn every_status_has_its_parameters() {
        for angle in [0.0_f64, 0.3, 0.5, 1.2] {
            let normal = [angle.sin(), -angle.cos()];
            let ([b_0, b_1, b_2, b_3], r) = (coupling(normal), 3.0);
            let (tangent, outward) = ([b_0, b_2], [b_1, b_3]);
            let moves = |c: [f64; 2], factor: f64| [factor * c[0], factor * c[1], 0.0, 0.0];
            let open = [0.0, 0.0, 0.0, -1.0];
            let no_pressure = [0.0, 0.0, -1.0, 0.0];
            let slip = [0.0, 0.0, -1.0, 0.4];
            assert_eq!(parameters(normal, no_pressure, open), 2);
            assert_eq!(parameters(normal, slip, moves(outward, r)), 1);
            assert_eq!(parameters(normal, moves(tangent, r), moves(outward, r)), 0);
            // Closed without pressure, and sticking although open, as possible between two iterates.
            assert_eq!(parameters(normal, no_pressure, moves(outward, r)), 1);
            assert_eq!(parameters(normal, moves(tangent, r), open), 1);
            let mut inside = moves(outward, -0.2);
            inside[3] = 1.0;
            let mut within = moves(tangent, -1.0);
            (within[2], within[3]) = (1e-7, 0.3e-7);
            assert_eq!(parameters(normal, within, inside), 2);
        }
    }

    #[test]
    fn what_depends_on_each_other_is_an_error() {
        let b = coupling([0.0, -1.0]);
        let error = |rows: &[f64], b: &[f64; 4]| Local::new(2, 2, rows.to_vec(), with_forces(b)).err();
        let singular = Some(LinearError::Singular { pivot_ratio: 0.0 });
        assert_eq!(error(&[1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0], &b), singular);
        assert_eq!(error(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], &b), singular);
        // Two parallel reactions.
        assert_eq!(error(&[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0], &[1.0, 2.0, 1.0, 2.0]), singular);
        assert_eq!(error(&[f64::NAN, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0], &b), Some(LinearError::NotFinite));
    }

    #[test]
    fn unknowns_without_a_displacement() {
        let local = Local::new(0, 2, vec![2.0, 0.0, 1.0, 4.0], Vec::new()).unwrap();
        assert_eq!((local.moving, local.start(&[2.0, 5.0]).collect::<Vec<_>>()), (0, vec![1.0, 1.0]));
    }
}
