//! CHOLMOD, SuiteSparse's supernodal Cholesky, with chosen unknowns eliminated last.
//!
//! With the unknowns `c` last and the interior `r` before them, in the order of the factors,
//!
//! ```text
//! K = [ K_rr K_rc ] = L Lᵀ,  L = [ L_rr      ]     S = K_cc - K_cr K_rr⁻¹ K_rc = L_cc L_ccᵀ:
//!     [ K_cr K_cc ]              [ L_cr L_cc ]
//! ```
//!
//! the Schur complement stands in the factors and costs no solves. A system whose border is solved
//! by other means is reduced to `c` by [`Cholmod::reduce`] and completed by [`Cholmod::expand`], as
//! in (35).

mod raw;
mod sweep;

use super::error::expect_length;
use super::{FactorInfo, LinearError};
use crate::sparse::{Pattern, Symmetric};
use raw::{Factor, Session};

/// The Cholesky factors of a symmetric positive definite matrix.
pub struct Cholmod {
    factor: Factor,
    /// How many unknowns come last.
    border: usize,
    info: FactorInfo,
}

/// A right-hand side that was reduced to the border, see [`Cholmod::reduce`].
#[derive(Debug, Clone, PartialEq)]
pub struct Reduced {
    /// `b_c - K_cr K_rr⁻¹ b_r`, in the order of `last`.
    pub border: Vec<f64>,
    /// `L_rr⁻¹ b_r` in the order of the factors.
    interior: Vec<f64>,
}

impl Cholmod {
    /// Factors `K = L Lᵀ` with the unknowns `last` eliminated last, in the given order.
    ///
    /// # Errors
    /// [`LinearError::Singular`] when `k` is not positive definite, [`LinearError::NotFinite`] when
    /// it holds NaN or an infinity, [`LinearError::Shape`] when `last` repeats an unknown or names
    /// one that does not exist, and when memory is short or CHOLMOD fails.
    pub fn factor(k: &Symmetric, last: &[usize]) -> Result<Self, LinearError> {
        let lower = k.lower();
        let mut session = Session::new()?;
        let mut permutation = order(&mut session, &lower.pattern, last)?;
        let factor = session.factor(lower, &mut permutation)?;
        // What is read off the factors hangs on this order, so it is not taken on trust.
        if factor.permutation() != permutation {
            return Err(LinearError::Backend { backend: "cholmod", step: "keeping the given order", status: 0 });
        }
        let pivot_ratio = pivot_ratio(&factor, permutation.len())?;
        let (entries, flops, peak_bytes) = factor.statistics();
        let info = FactorInfo { entries: entries as usize, flops, pivot_ratio, peak_bytes };
        Ok(Cholmod { factor, border: last.len(), info })
    }

    /// What the factorisation tells about itself. The entries are those of `L` without the zeros
    /// that supernodes store, the peak leaves out what METIS takes while it orders.
    pub fn info(&self) -> FactorInfo {
        self.info
    }

    /// The smallest over the largest pivot of the interior.
    ///
    /// # Errors
    /// [`LinearError::NotFinite`] when a pivot is no number.
    pub fn interior_pivot_ratio(&self) -> Result<f64, LinearError> {
        pivot_ratio(&self.factor, self.interior())
    }

    /// The order of the matrix.
    pub fn order(&self) -> usize {
        self.factor.permutation().len()
    }

    /// `L_cc`, column after column, m × m for m unknowns last, zero above the diagonal:
    /// `L_cc L_ccᵀ` is the Schur complement of the interior.
    pub fn trailing(&self) -> Vec<f64> {
        let (m, interior) = (self.border, self.interior());
        let mut dense = vec![0.0; m * m];
        for (column, rows, values) in self.factor.columns().skip_while(|&(column, ..)| column < interior) {
            for (&row, &value) in rows.iter().zip(values) {
                dense[(column - interior) * m + row as usize - interior] = value;
            }
        }
        dense
    }

    /// Solves `K x = b`.
    ///
    /// # Errors
    /// When a vector has the wrong length, or memory is short.
    pub fn solve(&self, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        expect_length("right-hand side", self.order(), b.len())?;
        expect_length("solution", self.order(), x.len())?;
        self.factor.solve(b, x)
    }

    /// The right-hand side of the Schur complement, `b_c - K_cr K_rr⁻¹ b_r`, and what
    /// [`Cholmod::expand`] will need.
    ///
    /// # Errors
    /// When `b` has the wrong length, or memory is short.
    pub fn reduce(&self, b: &[f64]) -> Result<Reduced, LinearError> {
        expect_length("right-hand side", self.order(), b.len())?;
        let permutation = self.factor.permutation();
        let mut interior: Vec<f64> = permutation.iter().map(|&unknown| b[unknown as usize]).collect();
        sweep::forward(&self.factor, self.interior(), &mut interior);
        // b_c - L_cr y_r as it stands. By way of the rest y_c of the solution, as L_cc y_c, it would
        // carry in the condition of L_cc.
        let border = interior.split_off(self.interior());
        Ok(Reduced { border, interior })
    }

    /// Completes the border `x_c`, in the order of `last`, by the interior `x_r` with
    /// `K_rr x_r = b_r - K_rc x_c`, where `b` is what was reduced.
    ///
    /// # Errors
    /// When a vector has the wrong length, or memory is short.
    pub fn expand(&self, reduced: &Reduced, x_c: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        let n = self.order();
        expect_length("reduced right-hand side", self.interior(), reduced.interior.len())?;
        expect_length("border of the solution", self.border, x_c.len())?;
        expect_length("solution", n, x.len())?;
        let mut ordered = [&reduced.interior[..], x_c].concat();
        sweep::backward(&self.factor, self.interior(), &mut ordered);
        for (&unknown, &value) in self.factor.permutation().iter().zip(&ordered) {
            x[unknown as usize] = value;
        }
        Ok(())
    }

    /// The sum of `parts`, each times its factor.
    pub fn combine(&self, parts: &[Reduced], factors: &[f64]) -> Reduced {
        let mut sum = Reduced { border: vec![0.0; self.border], interior: vec![0.0; self.interior()] };
        for (part, factor) in parts.iter().zip(factors) {
            sum.border.iter_mut().zip(&part.border).for_each(|(sum, x)| *sum += factor * x);
            sum.interior.iter_mut().zip(&part.interior).for_each(|(sum, x)| *sum += factor * x);
        }
        sum
    }

    /// How many unknowns are interior.
    fn interior(&self) -> usize {
        self.order() - self.border
    }
}

/// An order of low fill with `last` at the end. Only the interior is ordered for fill: `last` has an
/// order already, and the Schur complement is as good as dense in any.
fn order(session: &mut Session, pattern: &Pattern, last: &[usize]) -> Result<Vec<i64>, LinearError> {
    let n = pattern.columns();
    let mut is_last = vec![false; n];
    let distinct = last.iter().filter(|&&k| k < n && !std::mem::replace(&mut is_last[k], true)).count();
    expect_length("distinct unknowns to eliminate last", last.len(), distinct)?;
    let inside: Vec<usize> = (0..n).filter(|&k| !is_last[k]).collect();
    let mut permutation = Vec::with_capacity(n);
    if !inside.is_empty() {
        let mut place = vec![None; n];
        inside.iter().enumerate().for_each(|(k, &unknown)| place[unknown] = Some(k));
        let block = Pattern::from_entries(inside.len(), inside.len(), |take| {
            for (column, &unknown) in inside.iter().enumerate() {
                for &row in &pattern.row_indices()[pattern.column(unknown)] {
                    if let Some(row) = place[row as usize] {
                        take(row, column);
                    }
                }
            }
        });
        permutation.extend(session.order(&block)?.iter().map(|&k| inside[k as usize] as i64));
    }
    permutation.extend(last.iter().map(|&unknown| unknown as i64));
    Ok(permutation)
}

/// The smallest over the largest of the first `n` pivots, the squares on the diagonal of `L`.
fn pivot_ratio(factor: &Factor, n: usize) -> Result<f64, LinearError> {
    let (mut smallest, mut largest) = (f64::INFINITY, 0.0_f64);
    for (.., values) in factor.columns().take(n) {
        let pivot = values[0] * values[0];
        // The kernels of some BLAS let NaN pass for positive.
        if !pivot.is_finite() {
            return Err(LinearError::NotFinite);
        }
        (smallest, largest) = (smallest.min(pivot), largest.max(pivot));
    }
    // Without unknowns nothing is small.
    Ok(if smallest > largest { 1.0 } else { smallest / largest })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A reproducible draw from (-1, 1).
    fn draw(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn vector(n: usize, mut seed: u64) -> Vec<f64> {
        (0..n).map(|_| draw(&mut seed)).collect()
    }

    /// Diagonally dominant with about a fifth of the entries.
    fn random(n: usize, mut seed: u64) -> Symmetric {
        let mut entries = Vec::new();
        let mut diagonal = vec![0.1; n];
        for i in 0..n {
            for j in 0..i {
                if draw(&mut seed) > 0.6 {
                    let value = draw(&mut seed);
                    entries.push((i, j, value));
                    diagonal[i] += value.abs();
                    diagonal[j] += value.abs();
                }
            }
        }
        entries.extend(diagonal.iter().enumerate().map(|(i, &value)| (i, i, value)));
        from(n, &entries)
    }

    fn from(n: usize, entries: &[(usize, usize, f64)]) -> Symmetric {
        let mut k = Symmetric::from_entries(n, |take| entries.iter().for_each(|&(i, j, _)| take(i, j)));
        for &(i, j, value) in entries {
            k.add(i, j, value);
        }
        k
    }

    /// The Laplacian on a grid of `nx` × `ny` nodes, nine points a row, held above the top.
    fn laplacian(nx: usize, ny: usize) -> Symmetric {
        let mut entries = Vec::new();
        for (i, j) in (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j))) {
            let mut diagonal = if j + 1 == ny { 3.0 } else { 0.0 };
            for (p, q) in (j.saturating_sub(1)..ny.min(j + 2))
                .flat_map(|q| (i.saturating_sub(1)..nx.min(i + 2)).map(move |p| (p, q)))
            {
                if (p, q) != (i, j) {
                    diagonal += 1.0;
                    if q * nx + p < j * nx + i {
                        entries.push((j * nx + i, q * nx + p, -1.0));
                    }
                }
            }
            entries.push((j * nx + i, j * nx + i, diagonal));
        }
        from(nx * ny, &entries)
    }

    /// The Schur complement of `last` by eliminating the others one by one, column-major.
    fn schur(k: &Symmetric, last: &[usize]) -> Vec<f64> {
        let n = k.order();
        let mut a = vec![0.0; n * n];
        k.entries().for_each(|(i, j, value)| a[j * n + i] = value);
        let mut left: Vec<usize> = (0..n).collect();
        for p in (0..n).filter(|p| !last.contains(p)) {
            left.retain(|&i| i != p);
            for &j in &left {
                let factor = a[j * n + p] / a[p * n + p];
                for &i in &left {
                    a[j * n + i] -= a[p * n + i] * factor;
                }
            }
        }
        last.iter().flat_map(|&j| last.iter().map(move |&i| (i, j))).map(|(i, j)| a[j * n + i]).collect()
    }

    /// `L Lᵀ` of a column-major lower triangle, which must be zero above the diagonal.
    fn square(l: &[f64], m: usize) -> Vec<f64> {
        assert!((0..m).all(|j| (0..j).all(|i| l[j * m + i] == 0.0)));
        let dot = |i, j| (0..m).map(|k: usize| l[k * m + i] * l[k * m + j]).sum();
        (0..m).flat_map(|j| (0..m).map(move |i| (i, j))).map(|(i, j)| dot(i, j)).collect()
    }

    /// `‖b - K x‖ / (‖K‖ ‖x‖ + ‖b‖)`, largest entries and row sums.
    fn error(k: &Symmetric, b: &[f64], x: &[f64]) -> f64 {
        let largest = |v: &[f64]| v.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let (mut kx, mut sums) = (vec![0.0; b.len()], vec![0.0; b.len()]);
        k.mul(x, &mut kx);
        k.entries().for_each(|(i, _, value)| sums[i] += value.abs());
        let residual: Vec<f64> = b.iter().zip(&kx).map(|(b, kx)| b - kx).collect();
        largest(&residual) / (largest(&sums) * largest(x) + largest(b)).max(f64::MIN_POSITIVE)
    }

    fn close(a: &[f64], b: &[f64], tolerance: f64) {
        assert_eq!(a.len(), b.len());
        let scale = b.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
        let worst = a.iter().zip(b).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(worst <= tolerance * scale, "{worst:e} against {scale:e}");
    }

    /// Everything a caller may ask of one matrix.
    fn exercise(k: &Symmetric, last: &[usize]) {
        let (n, m) = (k.order(), last.len());
        let factor = Cholmod::factor(k, last).unwrap();
        let s = square(&factor.trailing(), m);
        if n <= 100 {
            close(&s, &schur(k, last), 1e-13);
        }
        let (b, mut x, mut y) = (vector(n, 7), vec![0.0; n], vec![0.0; n]);
        factor.solve(&b, &mut x).unwrap();
        assert!(error(k, &b, &x) <= 1e-15);
        // The border by its own factors, which knows nothing of the interior.
        let pairs: Vec<_> = (0..m).flat_map(|j| (0..m).map(move |i| (i, j))).collect();
        let entries: Vec<_> = pairs.iter().zip(&s).map(|(&(i, j), &value)| (i, j, value)).collect();
        let reduced = factor.reduce(&b).unwrap();
        let mut x_c = vec![0.0; m];
        Cholmod::factor(&from(m, &entries), &[]).unwrap().solve(&reduced.border, &mut x_c).unwrap();
        factor.expand(&reduced, &x_c, &mut y).unwrap();
        assert!(last.iter().zip(&x_c).all(|(&unknown, &value)| y[unknown] == value));
        assert!(error(k, &b, &y) <= 1e-15);
        close(&x, &y, 1e-11);
    }

    #[test]
    fn scattered_unknowns_come_last() {
        for seed in 0..20 {
            exercise(&random(60, seed), &[31, 4, 59, 0, 17, 18, 44]);
        }
    }

    #[test]
    fn empty_cases() {
        let k = random(25, 3);
        exercise(&k, &[]);
        exercise(&k, &(0..25).rev().collect::<Vec<_>>());
        exercise(&from(0, &[]), &[]);
        exercise(&from(1, &[(0, 0, 4.0)]), &[0]);
        assert_eq!(Cholmod::factor(&from(1, &[(0, 0, 4.0)]), &[0]).unwrap().trailing(), [2.0]);
        exercise(&from(3, &[(0, 0, 1.0), (1, 1, 2.0), (2, 2, 3.0)]), &[1]);
    }

    #[test]
    fn a_grid_on_its_bottom_row() {
        let k = laplacian(60, 60);
        exercise(&k, &(0..60).collect::<Vec<_>>());
        let info = Cholmod::factor(&k, &[]).unwrap().info();
        assert!(info.entries > k.lower().pattern.len() && info.entries < 200_000, "{info:?}");
        assert!(info.flops > info.entries as f64 && info.peak_bytes > 8.0 * info.entries as f64, "{info:?}");
        assert!(info.pivot_ratio > 1e-4 && info.pivot_ratio < 1.0, "{info:?}");
    }

    #[test]
    fn what_cannot_be_factored() {
        let singular = |k: &Symmetric, last: &[usize]| {
            assert!(matches!(Cholmod::factor(k, last), Err(LinearError::Singular { pivot_ratio: 0.0 })));
        };
        let indefinite = from(3, &[(0, 0, 1.0), (1, 0, 2.0), (1, 1, 1.0), (2, 2, 1.0)]);
        for last in [&[][..], &[0], &[1], &[0, 1], &[2, 1, 0]] {
            singular(&indefinite, last);
        }
        singular(&from(2, &[(0, 0, 1.0)]), &[1]);
        let no_number = from(2, &[(0, 0, 1.0), (1, 0, f64::NAN), (1, 1, 1.0)]);
        assert!(Cholmod::factor(&no_number, &[]).is_err());
        for last in [&[3][..], &[1, 1]] {
            assert!(matches!(Cholmod::factor(&indefinite, last), Err(LinearError::Shape { .. })));
        }
    }

    #[test]
    fn wrong_lengths_are_errors() {
        let factor = Cholmod::factor(&random(5, 1), &[2]).unwrap();
        let (reduced, mut x) = (factor.reduce(&[1.0; 5]).unwrap(), [0.0; 5]);
        let shape = |result| assert!(matches!(result, Err(LinearError::Shape { .. })));
        shape(factor.solve(&[1.0; 4], &mut x));
        shape(factor.solve(&[1.0; 5], &mut x[1..]));
        shape(factor.reduce(&[1.0; 6]).map(|_| ()));
        shape(factor.expand(&reduced, &[], &mut x));
        shape(factor.expand(&reduced, &[1.0], &mut x[1..]));
        shape(Cholmod::factor(&random(5, 1), &[]).unwrap().expand(&reduced, &[], &mut x));
    }

    #[test]
    fn factors_move_between_threads_and_do_not_share_state() {
        let k = random(40, 9);
        let factors: Vec<_> = (0..100).map(|i| Cholmod::factor(&k, &[i % 40]).unwrap()).collect();
        let work = move || {
            for factor in factors {
                let (b, mut x) = (vector(40, 2), vec![0.0; 40]);
                factor.solve(&b, &mut x).unwrap();
                assert!(error(&k, &b, &x) <= 1e-15);
            }
        };
        std::thread::spawn(work).join().unwrap();
    }
}
