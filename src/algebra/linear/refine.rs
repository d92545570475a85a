//! Iterative refinement and the backward error, the same for every backend. A solve to a tolerance by an iterative solver is
//! not refined.

use super::{Computed, LinearError, SystemMatrix, expect_length};

/// The accuracy of a solution.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SolveInfo {
    /// The componentwise backward error of the returned solution, see [`backward_error`].
    pub backward_error: f64,
    /// The number of refinement steps.
    pub refinements: usize,
}

impl SolveInfo {
    /// Returns an error if the backward error is above `bound`. A caller that does not check the solution in another way calls
    /// this.
    ///
    /// # Errors
    /// [`LinearError::Inaccurate`].
    pub fn within(self, bound: f64) -> Computed<Self> {
        let SolveInfo { backward_error, .. } = self;
        if backward_error <= bound { Ok(self) } else { Err(LinearError::Inaccurate { backward_error }) }
    }
}

/// The backward error at which refinement stops. The residual of a row of 12 to 24 entries has as much rounding itself, and a
/// further step costs a solve.
const TARGET: f64 = 4.0 * f64::EPSILON;
/// The largest number of steps. With good factors one or two reach the target. Two more are allowed; further ones would hide
/// bad factors.
const MAX_STEPS: usize = 4;

/// The workspace of refinement, kept between calls.
#[derive(Default)]
pub(super) struct Workspace {
    residual: Vec<f64>,
    scale: Vec<f64>,
    /// The correction, then the corrected solution.
    candidate: Vec<f64>,
}

/// A function that solves with the present factors.
type Solve<'a> = &'a mut dyn FnMut(&[f64], &mut [f64]) -> Computed<()>;

/// Solves `A x = b` by `solve_once` and refines until the backward error is at rounding level or stops falling by half.
pub(super) fn solve(
    solve_once: Solve<'_>,
    a: &SystemMatrix,
    b: &[f64],
    x: &mut [f64],
    work: &mut Workspace,
) -> Computed<SolveInfo> {
    let n = b.len();
    for vector in [&mut work.residual, &mut work.scale, &mut work.candidate] {
        vector.resize(n, 0.0);
    }
    let largest = a.largest_entry();
    solve_once(b, x)?;
    let mut info = SolveInfo { backward_error: measure(a, largest, b, x, work)?, refinements: 0 };
    while info.backward_error > TARGET && info.refinements < MAX_STEPS {
        solve_once(&work.residual, &mut work.candidate)?;
        let mut candidate = std::mem::take(&mut work.candidate);
        candidate.iter_mut().zip(&*x).for_each(|(correction, x)| *correction += x);
        let error = measure(a, largest, b, &candidate, work)?;
        let better = error < info.backward_error;
        let worthwhile = error <= 0.5 * info.backward_error;
        if better {
            x.copy_from_slice(&candidate);
            info = SolveInfo { backward_error: error, refinements: info.refinements + 1 };
        }
        work.candidate = candidate;
        if !worthwhile {
            break;
        }
    }
    Ok(info)
}

fn measure(a: &SystemMatrix, largest: f64, b: &[f64], x: &[f64], work: &mut Workspace) -> Computed<f64> {
    a.residual(x, b, &mut work.residual, &mut work.scale)?;
    let error = from_residual(a, largest, x, &work.residual, &work.scale);
    if error.is_finite() { Ok(error) } else { Err(LinearError::NotFinite) }
}

/// Returns the componentwise backward error `max_i |b - A x|_i / (|A| |x| + |b|)_i`: the smallest relative change of
/// the entries of `A` and `b` that makes `x` exact (Oettli and Prager).
///
/// If the scale `s_i` of a row is at rounding level, its residual is divided by `s_i + ‖A_i‖_∞ ‖x‖_1` (Arioli, Demmel and
/// Duff, 1989). Without this, the rounding in a row such as `du_n = 0` would count as 100 %.
///
/// # Errors
/// [`LinearError`] if `b` or `x` does not fit `a`.
pub fn backward_error(a: &SystemMatrix, b: &[f64], x: &[f64]) -> Computed<f64> {
    expect_length("right-hand side", a.pattern().rows(), b.len())?;
    expect_length("solution", a.order(), x.len())?;
    let mut r = vec![0.0; b.len()];
    let mut s = vec![0.0; b.len()];
    a.residual(x, b, &mut r, &mut s)?;
    Ok(from_residual(a, a.largest_entry(), x, &r, &s))
}

/// Returns the error of `x` with the residual `r` and its scale `s`.
fn from_residual(a: &SystemMatrix, largest_entry: f64, x: &[f64], r: &[f64], s: &[f64]) -> f64 {
    componentwise_error(x, r, s, largest_entry, || a.row_norms())
}

/// Computes [`backward_error`] of `x` from its residual `r`, the scale `s` of the residual, the largest entry of the
/// matrix, and the largest entry of each row, which is computed only if it is needed.
pub(crate) fn componentwise_error(
    x: &[f64],
    r: &[f64],
    s: &[f64],
    largest_entry: f64,
    row_norms: impl FnOnce() -> Vec<f64>,
) -> f64 {
    let n = r.len();
    let largest = x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let one_norm: f64 = x.iter().map(|v| v.abs()).sum();
    if !one_norm.is_finite() {
        return f64::NAN;
    }
    // Rows below the threshold are rare.
    let mut doubtful: Vec<usize> = Vec::new();
    let mut worst = 0.0_f64;
    let threshold = 1000.0 * n as f64 * f64::EPSILON * largest;
    for i in 0..n {
        if r[i] == 0.0 {
            continue;
        }
        if s[i] > threshold * largest_entry { worst = worst.max(r[i].abs() / s[i]) } else { doubtful.push(i) }
    }
    if !doubtful.is_empty() {
        let row_norm = row_norms();
        for i in doubtful {
            let against = if s[i] > threshold * row_norm[i] { s[i] } else { s[i] + row_norm[i] * one_norm };
            worst = worst.max(r[i].abs() / against);
        }
    }
    worst
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::linear::RefinedSolver;
    use crate::algebra::sparse::{Csc, Pattern};
    use std::sync::Arc;

    #[test]
    fn backward_error_of_a_known_perturbation() {
        let pattern = Arc::new(Pattern::from_entries(2, 2, |take| (0..2).for_each(|i| take(i, i))).unwrap());
        let a = SystemMatrix::from(Csc::new(pattern, vec![1.0, 4.0]).unwrap());
        // The second row misses by 1 against |4 · 1| + |5|.
        assert_eq!(backward_error(&a, &[1.0, 5.0], &[1.0, 1.0]).unwrap(), 1.0 / 9.0);
        assert!(backward_error(&a, &[1.0, 5.0], &[f64::NAN, 1.0]).unwrap().is_nan());
    }

    #[test]
    fn refinement_reaches_rounding_on_a_badly_scaled_matrix() {
        let n = 40;
        let pattern =
            Arc::new(Pattern::from_entries(n, n, |take| (0..n).for_each(|i| (0..n).for_each(|j| take(i, j)))).unwrap());
        let mut a = Csc::zeros(Arc::clone(&pattern));
        for j in 0..n {
            for i in 0..n {
                // A Hilbert-like matrix whose rows span twelve decades.
                a.values_mut()[j * n + i] = 10_f64.powi((i % 13) as i32) / (1.0 + i as f64 + 2.0 * j as f64)
                    + if i == j { 10_f64.powi((i % 13) as i32) } else { 0.0 };
            }
        }
        let b: Vec<f64> = (0..n).map(|i| 1.0 + i as f64).collect();
        let mut direct = RefinedSolver::default();
        let a = SystemMatrix::from(a);
        direct.analyze(&a).unwrap();
        direct.factorize(&a).unwrap();
        let mut x = vec![0.0; n];
        let info = direct.solve(&a, &b, &mut x).unwrap();
        assert!(info.backward_error <= 1e-15, "{info:?}");
        assert_eq!(info.backward_error, backward_error(&a, &b, &x).unwrap());
    }
}
