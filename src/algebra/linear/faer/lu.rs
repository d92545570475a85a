//! faer's supernodal LU: a backend in pure Rust for the uncondensed system.
//!
//! faer pivots by the largest entry of a column in any row. The fill is therefore bounded by the factor of AᵀA.
//! COLAMD orders the columns for that and is the right choice although the pattern is almost symmetric. On the block,
//! with rows not yet scaled, AMD of A + Aᵀ was 6 to 7 times slower at n = 50 and 100, and without supernodes COLAMD
//! was 5 times slower at n = 50.
//!
//! faer reports neither zero pivots nor the pivots themselves. Each factorisation therefore ends with one solve for a
//! fixed right-hand side: a zero pivot leaves Inf or NaN there, a tiny pivot a huge solution.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::mat::MatMut;
use faer::sparse::FaerError;
use faer::sparse::linalg::lu::supernodal::{
    SupernodalLu, SymbolicSupernodalLu, factorize_supernodal_numeric_lu, factorize_supernodal_numeric_lu_scratch,
    factorize_supernodal_symbolic_lu, factorize_supernodal_symbolic_lu_scratch, solve_in_place_scratch,
};
use faer::sparse::linalg::{LuError, SymbolicSupernodalParams, colamd, qr};
use faer::{Conj, Par, Spec};

use super::{Indices, memory, out_of_memory, parallelism, permutation};
use crate::algebra::linear::{Computed, FactorInfo, LinearError, LinearSolver, expect_finite, expect_length};
use crate::algebra::sparse::Pattern;

/// The LU backend of faer.
#[derive(Default)]
pub struct FaerLu {
    analysed: Option<Analysed>,
    /// The factors, whose memory the next factorisation reuses.
    factors: SupernodalLu<usize, f64>,
    factored: bool,
}

/// The data that depend on the pattern alone, and the memory for every factorisation.
struct Analysed {
    a: Indices,
    /// The transposed pattern, with the slot of `a` for each of its slots.
    transposed: (Indices, Vec<usize>),
    /// The powers of two that scale the rows, see [`Analysed::scale`].
    scale: Vec<f64>,
    /// The scaled values, by columns and by rows.
    values: Vec<f64>,
    transposed_values: Vec<f64>,
    /// The order of the columns, and its inverse.
    columns: [Vec<usize>; 2],
    /// The order of the rows from pivoting, and its inverse.
    rows: [Vec<usize>; 2],
    symbolic: SymbolicSupernodalLu<usize>,
    /// A bound on the entries of L and U.
    entries: usize,
    par: Par,
    /// The right-hand side of the solve that checks the factors.
    probe: Vec<f64>,
    work: MemBuffer,
}

impl Analysed {
    fn new(pattern: &Pattern) -> Result<Self, FaerError> {
        let a = Indices::new(pattern);
        let transposed = a.transposed();
        let (n, nnz) = (a.n(), a.rows.len());
        let mut work = memory(StackReq::any_of(&[
            colamd::order_scratch::<usize>(n, n, nnz),
            qr::col_etree_scratch::<usize>(n, n),
            qr::postorder_scratch::<usize>(n),
            qr::column_counts_aat_scratch::<usize>(n, n),
            factorize_supernodal_symbolic_lu_scratch::<usize>(n, n),
        ]))?;
        let stack = MemStack::new(&mut work);

        let [mut order, mut inverse, mut post] = [(); 3].map(|()| vec![0; n]);
        colamd::order(&mut order, &mut inverse, a.symbolic(), colamd::Control::default(), stack)?;
        let mut tree = vec![0; n];
        let columns = Some(permutation(&order, &inverse));
        let parents = qr::col_etree(a.symbolic(), columns, &mut tree, stack);
        qr::postorder(&mut post, parents, stack);
        let (mut counts, mut first) = (vec![0; n], vec![0; n]);
        qr::column_counts_ata(&mut counts, &mut first, transposed.0.symbolic(), columns, parents, &post, stack);
        let symbolic = factorize_supernodal_symbolic_lu(
            a.symbolic(),
            columns,
            &first,
            parents,
            &counts,
            stack,
            SymbolicSupernodalParams::default(),
        )?;
        let work = memory(StackReq::or(
            factorize_supernodal_numeric_lu_scratch::<usize, f64>(&symbolic, Spec::default()),
            solve_in_place_scratch::<usize, f64>(n, 1, Par::Seq),
        ))?;
        Ok(Analysed {
            scale: vec![1.0; n],
            values: vec![0.0; nnz],
            transposed_values: vec![0.0; nnz],
            rows: [vec![0; n], vec![0; n]],
            // For any choice of pivots, row k of U and column k of L fit into column k of the factor of AᵀA.
            entries: 2 * counts.iter().sum::<usize>(),
            // The operations that correspond to this bound.
            par: parallelism(counts.iter().map(|&count| 2.0 * (count as f64).powi(2)).sum()),
            // Irregular signs, so that hardly any null vector is orthogonal to them.
            probe: (0..n).map(|i| if (i.wrapping_mul(0x9E37_79B9) >> 16) & 1 == 0 { 1.0 } else { -1.0 }).collect(),
            columns: [order, inverse],
            a,
            transposed,
            symbolic,
            work,
        })
    }
}

impl LinearSolver for FaerLu {
    fn name(&self) -> &'static str {
        "faer"
    }

    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Computed<()> {
        expect_length("rows of the matrix", pattern.columns().max(1), pattern.rows())?;
        (self.analysed, self.factored) = (None, false);
        self.analysed = Some(Analysed::new(pattern).map_err(|error| out_of_memory(error, "the symbolic analysis"))?);
        Ok(())
    }

    /// Returns `entries` as a bound for any choice of pivots, on the block four times what UMFPACK needs: faer does
    /// not report the lengths of its factors. Operations and memory are not known. `pivot_ratio` is `‖b‖ / (‖A‖ ‖x‖)`
    /// for a fixed `b` and scaled rows, an upper bound on the reciprocal condition number, since the pivots cannot be
    /// read.
    fn factorize(&mut self, values: &[f64]) -> Computed<FactorInfo> {
        self.factored = false;
        let Some(analysed) = &mut self.analysed else { return Err(LinearError::Order { missing: "analyze" }) };
        expect_length("values of the matrix", analysed.a.rows.len(), values.len())?;
        expect_finite(values)?;
        analysed.scale(values);
        let Analysed { a, transposed, values, transposed_values, columns, rows, symbolic, work, par, .. } = analysed;
        let [row_order, row_inverse] = rows;
        let result = factorize_supernodal_numeric_lu(
            row_order,
            row_inverse,
            &mut self.factors,
            a.with(values),
            transposed.0.with(transposed_values),
            permutation(&columns[0], &columns[1]),
            symbolic,
            *par,
            MemStack::new(work),
            Spec::default(),
        );
        match result {
            Ok(()) => {}
            Err(LuError::SymbolicSingular { .. }) => return Err(LinearError::Singular { pivot_ratio: 0.0 }),
            Err(LuError::Generic(error)) => return Err(out_of_memory(error, "the factorisation")),
        }
        let info = FactorInfo {
            entries: analysed.entries,
            pivot_ratio: analysed.conditioning(&self.factors),
            ..FactorInfo::default()
        };
        self.factored = info.pivot_ratio > 0.0;
        if self.factored { Ok(info) } else { Err(LinearError::Singular { pivot_ratio: 0.0 }) }
    }

    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Computed<()> {
        let (Some(analysed), true) = (&mut self.analysed, self.factored) else {
            return Err(LinearError::Order { missing: "factorize" });
        };
        expect_length("right-hand side", analysed.a.n(), b.len())?;
        expect_length("solution", analysed.a.n(), x.len())?;
        x.iter_mut().zip(b).zip(&analysed.scale).for_each(|((x, b), scale)| *x = scale * b);
        analysed.solve(&self.factors, x);
        expect_finite(x)
    }
}

impl Analysed {
    /// Divides each row by its size. Pivots are chosen by size, and a contact condition such as `du_n = -g` must be
    /// the pivot row of its own unknown, before the rows of the stiffness: then it holds exactly. A rounding error
    /// would affect the comparison with zero in BN with the paper's constants.
    fn scale(&mut self, values: &[f64]) {
        self.scale.fill(0.0);
        self.a.rows.iter().zip(values).for_each(|(&row, value)| self.scale[row] += value.abs());
        for scale in &mut self.scale {
            // A power of two, which causes no rounding, within the range of numbers.
            *scale = (-scale.log2().round()).clamp(-1000.0, 1000.0).exp2();
        }
        let scaled = self.values.iter_mut().zip(values).zip(&self.a.rows);
        scaled.for_each(|((scaled, value), &row)| *scaled = self.scale[row] * value);
        let transposed = self.transposed_values.iter_mut().zip(&self.transposed.1);
        transposed.for_each(|(value, &slot)| *value = self.values[slot]);
    }

    /// Solves in place.
    fn solve(&mut self, factors: &SupernodalLu<usize, f64>, x: &mut [f64]) {
        let n = x.len();
        factors.solve_in_place_with_conj(
            permutation(&self.rows[0], &self.rows[1]),
            permutation(&self.columns[0], &self.columns[1]),
            Conj::No,
            MatMut::from_column_major_slice_mut(x, n, 1),
            Par::Seq,
            MemStack::new(&mut self.work),
        );
    }

    /// Returns `‖b‖ / (‖A‖ ‖x‖)` in the maximum norm, or 0 if `x` is not finite. A doubtful `x` is itself the next
    /// right-hand side: one step of inverse iteration finds the critical direction.
    fn conditioning(&mut self, factors: &SupernodalLu<usize, f64>) -> f64 {
        const DOUBTFUL: f64 = 1e-10;
        let largest =
            |x: &[f64]| x.iter().fold(0.0_f64, |m, value| if value.is_nan() { f64::NAN } else { m.max(value.abs()) });
        let mut sums = vec![0.0; self.a.n()];
        self.a.rows.iter().zip(&self.values).for_each(|(&row, value)| sums[row] += value.abs());
        let norm = largest(&sums);
        let mut x = self.probe.clone();
        let mut ratio = f64::INFINITY;
        for _ in 0..2 {
            self.solve(factors, &mut x);
            let size = largest(&x);
            if !(size.is_finite() && size > 0.0) {
                return 0.0;
            }
            ratio = ratio.min(1.0 / (norm * size));
            if ratio > DOUBTFUL {
                break;
            }
            for x in &mut x {
                *x /= size;
            }
        }
        ratio
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::sparse::Csc;

    fn pattern(n: usize, entries: &[(usize, usize)]) -> Arc<Pattern> {
        Arc::new(Pattern::from_entries(n, n, |take| entries.iter().for_each(|&(i, j)| take(i, j))).unwrap())
    }

    /// Returns pseudo-random numbers in (-1, 1).
    fn noise(k: usize) -> f64 {
        (12.9898 * (k + 1) as f64).sin() * 43758.5453 % 1.0
    }

    /// Creates a grid of m × m nodes with an unsymmetric stencil, bordered as in a contact Jacobian: pressures act on
    /// the first row of nodes, and their own rows prescribe either the pressure or the displacement.
    fn bordered(m: usize, seed: usize) -> Csc {
        let n = m * m + m;
        let near = |k: usize| [Some(k), k.checked_sub(m), k.checked_sub(1), Some(k + 1), Some(k + m)];
        let pattern = Pattern::from_entries(n, n, |take| {
            for k in 0..m * m {
                near(k).into_iter().flatten().filter(|&j| j < m * m).for_each(|j| take(k, j));
            }
            for k in 0..m {
                for (i, j) in [(k, m * m + k), (m * m + k, k), (m * m + k, m * m + k)] {
                    take(i, j);
                }
            }
        })
        .unwrap();
        let mut a = Csc::zeros(Arc::new(pattern));
        let entries: Vec<_> = a.entries().collect();
        for (slot, (i, j, _)) in entries.into_iter().enumerate() {
            let closed = (i + seed).is_multiple_of(3);
            a.values_mut()[slot] = match (i < m * m, j < m * m) {
                (true, true) => {
                    if i == j {
                        4.5
                    } else {
                        0.3 * noise(slot + seed) - 1.0
                    }
                }
                (true, false) => -1.0,
                (false, true) => f64::from(u8::from(closed)),
                (false, false) => f64::from(u8::from(!closed)),
            };
        }
        a
    }

    #[cfg(feature = "umfpack")]
    #[test]
    fn agrees_with_umfpack_and_factors_again() {
        for m in [2, 5, 17, 30] {
            let [mut faer, mut umfpack] = [
                Box::new(FaerLu::default()) as Box<dyn LinearSolver>,
                Box::new(crate::algebra::linear::Umfpack::default()),
            ]
            .map(crate::algebra::linear::RefinedSolver::new);
            for seed in 0..4 {
                let a = crate::algebra::linear::SystemMatrix::from(bordered(m, seed));
                if seed == 0 {
                    faer.analyze(&a).unwrap();
                    umfpack.analyze(&a).unwrap();
                }
                let b: Vec<f64> = (0..a.order()).map(|k| noise(k + 7 * seed)).collect();
                let [x, y] = [&mut faer, &mut umfpack].map(|direct| {
                    let mut x = vec![0.0; b.len()];
                    let factor = direct.factorize(&a).unwrap();
                    assert!(factor.entries >= a.order() && factor.pivot_ratio > 1e-8, "{factor:?}");
                    assert!(direct.solve(&a, &b, &mut x).unwrap().backward_error <= 1e-15);
                    x
                });
                let largest = y.iter().fold(0.0_f64, |m, y| m.max(y.abs()));
                assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() <= 1e-12 * largest), "m = {m}, {seed}");
            }
        }
    }

    #[test]
    fn every_misuse_has_its_error() {
        let pattern = pattern(2, &[(0, 0), (1, 1)]);
        let mut solver = FaerLu::default();
        let mut x = [0.0; 2];
        assert_eq!(solver.factorize(&[1.0, 1.0]), Err(LinearError::Order { missing: "analyze" }));
        solver.analyze(&pattern).unwrap();
        assert_eq!(solver.solve(&[1.0, 1.0], &mut x), Err(LinearError::Order { missing: "factorize" }));
        assert!(matches!(solver.factorize(&[1.0]), Err(LinearError::Shape { expected: 2, found: 1, .. })));
        assert_eq!(solver.factorize(&[1.0, f64::NAN]), Err(LinearError::NotFinite));
        solver.factorize(&[1.0, 2.0]).unwrap();
        assert!(matches!(solver.solve(&[1.0], &mut x), Err(LinearError::Shape { expected: 2, found: 1, .. })));
        assert!(matches!(solver.factorize(&[1.0, 0.0]), Err(LinearError::Singular { .. })));
        // A failed factorisation leaves no old factors behind.
        assert_eq!(solver.solve(&[1.0, 1.0], &mut x), Err(LinearError::Order { missing: "factorize" }));
        let wide = Arc::new(Pattern::from_entries(1, 2, |take| take(0, 1)).unwrap());
        assert!(matches!(solver.analyze(&wide), Err(LinearError::Shape { .. })));
        let empty = Arc::new(Pattern::from_entries(0, 0, |_| {}).unwrap());
        assert!(matches!(solver.analyze(&empty), Err(LinearError::Shape { .. })));
    }

    #[test]
    fn singular_matrices_are_errors() {
        let singular = |n: usize, entries: &[(usize, usize)], values: &[f64]| {
            let mut solver = FaerLu::default();
            solver.analyze(&pattern(n, entries)).unwrap();
            assert!(matches!(solver.factorize(values), Err(LinearError::Singular { .. })), "{values:?}");
        };
        let full = [(0, 0), (1, 0), (0, 1), (1, 1)];
        singular(2, &full, &[0.0; 4]);
        singular(2, &full, &[1.0, 2.0, 2.0, 4.0]);
        singular(2, &full, &[0.0, 0.0, 1.0, 1.0]);
        // No entry in a row, in a column, or in both.
        singular(2, &[(0, 0), (0, 1)], &[1.0, 1.0]);
        singular(2, &[(0, 0), (1, 0)], &[1.0, 1.0]);
        singular(3, &[(0, 0), (1, 1)], &[1.0, 1.0]);
        singular(1, &[], &[]);
        // An empty row of the block.
        let mut a = bordered(12, 0);
        for (slot, (i, _, _)) in a.clone().entries().enumerate() {
            if i == 12 * 12 + 5 {
                a.values_mut()[slot] = 0.0;
            }
        }
        let mut solver = FaerLu::default();
        solver.analyze(a.pattern()).unwrap();
        assert!(matches!(solver.factorize(a.values()), Err(LinearError::Singular { .. })));
    }

    /// A matrix that is singular up to rounding, because it can be translated, has a small pivot ratio.
    #[test]
    fn a_zero_hidden_in_rounding_shows_in_the_ratio() {
        let n = 50;
        let spring = |k: usize| 1.0 + 0.5 * noise(k).abs();
        let all: Vec<_> = (0..n).flat_map(|i| [(i, i), (i, (i + 1) % n), ((i + 1) % n, i)]).collect();
        let mut a = Csc::zeros(pattern(n, &all));
        for i in 0..n {
            let j = (i + 1) % n;
            for (row, column, sign) in [(i, i, 1.0), (j, j, 1.0), (i, j, -1.0), (j, i, -1.0)] {
                let slot = a.pattern().slot(row, column).unwrap();
                a.values_mut()[slot] += sign * spring(i);
            }
        }
        let mut solver = FaerLu::default();
        solver.analyze(a.pattern()).unwrap();
        match solver.factorize(a.values()) {
            Ok(info) => assert!(info.pivot_ratio < 100.0 * f64::EPSILON, "{info:?}"),
            Err(error) => assert!(matches!(error, LinearError::Singular { .. })),
        }
    }
}
