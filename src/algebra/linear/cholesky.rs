//! Cholesky factors of a symmetric positive definite matrix, with chosen unknowns eliminated last.
//!
//! With the unknowns `c` last and the interior `r` before them, in the order of the factors,
//!
//! ```text
//! K = [ K_rr K_rc ] = L Lᵀ,  L = [ L_rr      ]     S = K_cc - K_cr K_rr⁻¹ K_rc = L_cc L_ccᵀ:
//!     [ K_cr K_cc ]              [ L_cr L_cc ]
//! ```
//!
//! The factors therefore contain the Schur complement, which costs no solves. If the system of the border is solved
//! by other means, [`Cholesky::reduce`] reduces a right-hand side to `c`, and [`Cholesky::expand`] completes the
//! solution, as in (35).

// Without a backend nothing is factored.
#![cfg_attr(not(any(feature = "umfpack", feature = "faer")), allow(dead_code))]

mod sweep;

use super::supernodal::{Supernodal, Supernode};
use super::{Computed, FactorInfo, LinearError, SparseCholesky, expect_length, times_transposed};
use crate::algebra::sparse::{Pattern, Symmetric};
use sweep::Branches;

/// The Cholesky factors of a symmetric positive definite matrix.
pub struct Cholesky {
    factor: Box<dyn Supernodal>,
    /// The permutation: row and column `k` of `L` belong to the unknown `order[k]`.
    order: Vec<usize>,
    /// The number of unknowns that come last.
    border: usize,
    /// The branches of the interior.
    tree: Branches,
    info: FactorInfo,
}

/// A right-hand side reduced to the border, see [`Cholesky::reduce`].
#[derive(Debug, Clone, PartialEq)]
pub struct Reduced {
    /// `b_c - K_cr K_rr⁻¹ b_r`, in the order of `last`.
    pub border: Vec<f64>,
    /// `L_rr⁻¹ b_r` in the order of the factors.
    interior: Vec<f64>,
}

impl std::fmt::Debug for Cholesky {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Cholesky").field("border", &self.border).field("info", &self.info).finish_non_exhaustive()
    }
}

impl SparseCholesky {
    /// Computes [`Cholesky::factor`] with this backend.
    ///
    /// # Errors
    /// As [`Cholesky::factor`].
    pub fn factor(self, k: &Symmetric, last: &[usize]) -> Computed<Cholesky> {
        match self {
            #[cfg(feature = "umfpack")]
            SparseCholesky::Cholmod => Cholesky::cholmod(k, last),
            #[cfg(feature = "faer")]
            SparseCholesky::Faer => Cholesky::faer(k, last),
            #[cfg(not(all(feature = "umfpack", feature = "faer")))]
            absent => {
                let _ = (k, last, absent);
                Err(LinearError::NotBuiltIn { backend: "sparse Cholesky factorisation" })
            }
        }
    }

    /// Factors `K` with the unknowns `last` eliminated last. If `K` is singular because they hold the body, `ρ`, usually the
    /// diagonal of `K`, is added to their block first. Returns `ρ`, which [`Cholesky::schur_complement`] subtracts again, or an
    /// empty vector.
    ///
    /// # Errors
    /// As [`Cholesky::factor`]; [`LinearError::Singular`] if a part of the body can move while `last` are fixed.
    pub(crate) fn factor_held(self, k: &Symmetric, last: &[usize]) -> Computed<(Cholesky, Vec<f64>)> {
        match self.factor(k, last) {
            Err(LinearError::Singular { .. }) if !last.is_empty() => {
                let (mut held, diagonal) = (k.clone(), k.diagonal());
                // Displacements without stiffness get the largest `ρ` of the others, or 1.
                let largest = diagonal.iter().fold(0.0_f64, |m, rho| m.max(*rho));
                let other = if largest > 0.0 { largest } else { 1.0 };
                let rho = |&place: &usize| match diagonal[place] {
                    own if own > 0.0 => own,
                    _ if k.stores(place, place) => other,
                    _ => 0.0,
                };
                let shift: Vec<f64> = last.iter().map(rho).collect();
                last.iter().zip(&shift).filter(|(_, rho)| **rho > 0.0).for_each(|(&i, rho)| held.raise(i, i, *rho));
                Ok((self.factor(&held, last)?, shift))
            }
            factor => Ok((factor?, Vec::new())),
        }
    }
}

impl Cholesky {
    /// Factors `K = L Lᵀ` with the unknowns `last` eliminated last, in the given order, by CHOLMOD if it is built in,
    /// otherwise by faer.
    ///
    /// # Errors
    /// [`LinearError::Singular`] if `k` is not positive definite; [`LinearError::NotFinite`] if it has NaN or an
    /// infinity; [`LinearError::Shape`] if `last` repeats an unknown or names one that does not exist;
    /// [`LinearError::NotBuiltIn`] if this build has neither backend; an error if memory is short or the backend
    /// fails.
    pub fn factor(k: &Symmetric, last: &[usize]) -> Computed<Self> {
        SparseCholesky::default().factor(k, last)
    }

    /// Computes [`Cholesky::factor`] by CHOLMOD: SuiteSparse's supernodal Cholesky, ordered by minimum degree or
    /// nested dissection.
    ///
    /// # Errors
    /// As [`Cholesky::factor`].
    #[cfg(feature = "umfpack")]
    pub fn cholmod(k: &Symmetric, last: &[usize]) -> Computed<Self> {
        super::expect_finite(k.lower().values())?;
        let mut session = super::cholmod::Session::new()?;
        let order = with_border(k.lower().pattern(), last, |interior| session.order(interior))?;
        let factor = session.factor(&k.lower(), &order)?;
        Self::new(Box::new(factor), order, last.len())
    }

    /// Computes [`Cholesky::factor`] by faer: a supernodal Cholesky in pure Rust, ordered by minimum degree.
    ///
    /// # Errors
    /// As [`Cholesky::factor`].
    #[cfg(feature = "faer")]
    pub fn faer(k: &Symmetric, last: &[usize]) -> Computed<Self> {
        super::expect_finite(k.lower().values())?;
        let order = with_border(k.lower().pattern(), last, super::faer::minimum_degree)?;
        let factor = super::faer::Llt::factor(&k.lower(), &order)?;
        Self::new(Box::new(factor), order, last.len())
    }

    /// Predicts the entries of `L` and the operations for a matrix of this pattern, without factoring it, with a
    /// fill-reducing order of all unknowns.
    ///
    /// # Errors
    /// If memory is short; [`LinearError::NotBuiltIn`] if this build has no backend.
    pub fn predict(k: &Symmetric) -> Computed<FactorInfo> {
        #[cfg(feature = "umfpack")]
        {
            let mut session = super::cholmod::Session::new()?;
            session.order(k.lower().pattern())?;
            Ok(session.predicted())
        }
        #[cfg(all(feature = "faer", not(feature = "umfpack")))]
        {
            let order = super::faer::minimum_degree(k.lower().pattern())?;
            super::faer::Llt::predict(&k.lower(), &order)
        }
        #[cfg(not(any(feature = "umfpack", feature = "faer")))]
        {
            let _ = k;
            Err(LinearError::NotBuiltIn { backend: "sparse Cholesky factorisation" })
        }
    }

    fn new(factor: Box<dyn Supernodal>, order: Vec<usize>, border: usize) -> Computed<Self> {
        let pivot_ratio = pivot_ratio(&*factor, order.len())?;
        let info = FactorInfo { pivot_ratio, ..factor.info() };
        let tree = Branches::new(&*factor, order.len() - border);
        Ok(Cholesky { factor, order, border, tree, info })
    }

    /// Returns information about the factorisation. The entries are those of `L` without the zeros stored in
    /// supernodes; the peak memory excludes the ordering.
    pub fn info(&self) -> FactorInfo {
        self.info
    }

    /// Returns the ratio of the smallest to the largest pivot of the interior.
    ///
    /// # Errors
    /// [`LinearError::NotFinite`] if a pivot is not finite.
    pub fn interior_pivot_ratio(&self) -> Computed<f64> {
        pivot_ratio(&*self.factor, self.interior())
    }

    /// Returns the order of the matrix.
    pub fn order(&self) -> usize {
        self.order.len()
    }

    /// Returns `L_cc`, column by column, m × m for m unknowns last, zero above the diagonal. `L_cc L_ccᵀ` is the
    /// Schur complement of the interior.
    pub fn trailing(&self) -> Vec<f64> {
        let (m, interior) = (self.border, self.interior());
        let mut dense = vec![0.0; m * m];
        for node in nodes(&*self.factor) {
            for k in interior.saturating_sub(node.first)..node.columns {
                let to = &mut dense[(node.first + k - interior) * m..][..m];
                node.rows(k).zip(node.column(k)).for_each(|(row, value)| to[row - interior] = *value);
            }
        }
        dense
    }

    /// Returns the Schur complement of the interior, column by column, without the `shift` of [`SparseCholesky::factor_held`].
    ///
    /// # Errors
    /// [`LinearError::Singular`] if the interior has rigid modes, in which the border does not move.
    pub(crate) fn schur_complement(&self, shift: &[f64]) -> Computed<Vec<f64>> {
        let pivot_ratio = self.interior_pivot_ratio()?;
        if pivot_ratio <= f64::EPSILON {
            return Err(LinearError::Singular { pivot_ratio });
        }
        let m = self.border;
        let mut values = times_transposed(&self.trailing(), m);
        shift.iter().enumerate().for_each(|(i, rho)| values[i * m + i] -= rho);
        Ok(values)
    }

    /// Solves `K x = b`.
    ///
    /// # Errors
    /// If a vector has the wrong length.
    pub fn solve(&self, b: &[f64], x: &mut [f64]) -> Computed<()> {
        expect_length("solution", self.order(), x.len())?;
        let mut ordered = self.ordered(b)?;
        sweep::forward(&*self.factor, &self.tree, self.order(), &mut ordered);
        sweep::backward(&*self.factor, &self.tree, self.order(), &mut ordered);
        self.scatter(&ordered, x);
        Ok(())
    }

    /// Returns the right-hand side of the Schur complement, `b_c - K_cr K_rr⁻¹ b_r`, with the data for
    /// [`Cholesky::expand`].
    ///
    /// # Errors
    /// If `b` has the wrong length.
    pub fn reduce(&self, b: &[f64]) -> Computed<Reduced> {
        let mut interior = self.ordered(b)?;
        // Many right-hand sides are zero there.
        if interior[..self.interior()].iter().any(|b| *b != 0.0) {
            sweep::forward(&*self.factor, &self.tree, self.interior(), &mut interior);
        }
        // b_c - L_cr y_r directly. Computing it from the rest y_c of the solution as L_cc y_c would involve the
        // condition of L_cc.
        let border = interior.split_off(self.interior());
        Ok(Reduced { border, interior })
    }

    /// Completes the border `x_c`, in the order of `last`, by the interior `x_r` with `K_rr x_r = b_r - K_rc x_c`,
    /// where `b` is the reduced right-hand side.
    ///
    /// # Errors
    /// If a vector has the wrong length.
    pub fn expand(&self, reduced: &Reduced, x_c: &[f64], x: &mut [f64]) -> Computed<()> {
        expect_length("reduced right-hand side", self.interior(), reduced.interior.len())?;
        expect_length("solution", self.order(), x.len())?;
        x.copy_from_slice(&self.expand_sum(std::slice::from_ref(reduced), &[1.0], x_c)?);
        Ok(())
    }

    /// Computes [`Cholesky::expand`] for the sum of the `parts`, each times its factor.
    ///
    /// # Errors
    /// If the border has the wrong length.
    pub(crate) fn expand_sum(&self, parts: &[Reduced], factors: &[f64], x_c: &[f64]) -> Computed<Vec<f64>> {
        expect_length("border of the solution", self.border, x_c.len())?;
        let mut ordered = vec![0.0; self.interior()];
        for (part, factor) in parts.iter().zip(factors) {
            ordered.iter_mut().zip(&part.interior).for_each(|(sum, x)| *sum += factor * x);
        }
        ordered.extend(x_c);
        sweep::backward(&*self.factor, &self.tree, self.interior(), &mut ordered);
        let mut x = vec![0.0; self.order()];
        self.scatter(&ordered, &mut x);
        Ok(x)
    }

    /// Returns the number of interior unknowns.
    fn interior(&self) -> usize {
        self.order() - self.border
    }

    /// Returns `b` in the order of the factors.
    fn ordered(&self, b: &[f64]) -> Computed<Vec<f64>> {
        expect_length("right-hand side", self.order(), b.len())?;
        Ok(self.order.iter().map(|&unknown| b[unknown]).collect())
    }

    /// Writes a vector in the order of the factors to `x`.
    fn scatter(&self, ordered: &[f64], x: &mut [f64]) {
        self.order.iter().zip(ordered).for_each(|(&unknown, &value)| x[unknown] = value);
    }
}

/// Iterates over all supernodes.
fn nodes(factor: &dyn Supernodal) -> impl DoubleEndedIterator<Item = Supernode<'_>> {
    (0..factor.len()).map(|k| factor.supernode(k))
}

/// Returns the ratio of the smallest to the largest of the first `n` pivots, the squares on the diagonal of `L`.
fn pivot_ratio(factor: &dyn Supernodal, n: usize) -> Computed<f64> {
    let (mut smallest, mut largest) = (f64::INFINITY, 0.0_f64);
    for node in nodes(factor).take_while(|node| node.first < n) {
        for k in 0..node.columns.min(n - node.first) {
            let pivot = node.column(k)[0].powi(2);
            // The kernels of some BLAS libraries accept NaN as positive.
            if !pivot.is_finite() {
                return Err(LinearError::NotFinite);
            }
            (smallest, largest) = (smallest.min(pivot), largest.max(pivot));
        }
    }
    // The ratio of no pivots is 1.
    Ok(if smallest > largest { 1.0 } else { smallest / largest })
}

/// Returns a fill-reducing order with `last` at the end. Only the interior is ordered, by `interior` from the lower
/// triangle of its pattern: `last` has an order already, and the Schur complement is nearly dense in any order.
fn with_border(
    lower: &Pattern,
    last: &[usize],
    interior: impl FnOnce(&Pattern) -> Computed<Vec<usize>>,
) -> Computed<Vec<usize>> {
    let n = lower.columns();
    let mut is_last = vec![false; n];
    let distinct = last.iter().filter(|&&k| k < n && !std::mem::replace(&mut is_last[k], true)).count();
    expect_length("distinct unknowns to eliminate last", last.len(), distinct)?;
    let inside: Vec<usize> = (0..n).filter(|&k| !is_last[k]).collect();
    let mut order = Vec::with_capacity(n);
    if !inside.is_empty() {
        let mut place = vec![None; n];
        inside.iter().enumerate().for_each(|(k, &unknown)| place[unknown] = Some(k));
        let block = Pattern::of(inside.len(), inside.len(), |take| {
            for (column, &unknown) in inside.iter().enumerate() {
                for &row in &lower.row_indices()[lower.column(unknown)] {
                    if let Some(row) = place[row as usize] {
                        take(row, column);
                    }
                }
            }
        });
        order.extend(interior(&block)?.into_iter().map(|k| inside[k]));
    }
    order.extend(last);
    Ok(order)
}
