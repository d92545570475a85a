//! The null space of a large semidefinite matrix: the rigid modes of a body.

use faer::{Mat, Side};

use super::{Cholesky, Computed, LinearError};
use crate::algebra::sparse::Symmetric;

/// The shift of the unit diagonal of the scaled matrix, so that it can be factored. One step of inverse iteration
/// multiplies motions of the relative stiffness `λ` by this shift divided by `λ`, relative to rigid modes.
const SHIFT: f64 = 1e-12;

/// The number of steps. With [`SHIFT`], the remainder is below rounding.
const STEPS: usize = 4;

/// The largest force on a rigid mode, relative to the diagonal. Rounding leaves 1e-15.
const FREE: f64 = 1e-13;

/// The size of the first block: the rigid modes of one body and one more vector, which shows that there are no
/// others.
const FIRST_BLOCK: usize = 7;

/// Returns a basis of the null space of the positive semidefinite `k`, each vector with the largest entry 1; empty if
/// `k` is definite.
///
/// Uses inverse iteration on a block of vectors, `(K + ρ D)⁻¹ D` with `D` the diagonal of `K`, then the smallest Ritz
/// vectors, of which those with `K x = 0` up to rounding are kept.
///
/// # Errors
/// As [`Cholesky::factor`]; [`LinearError::Singular`] if `k` is indefinite.
pub(crate) fn null_space_of(k: &Symmetric) -> Computed<Vec<Vec<f64>>> {
    let n = k.order();
    // A displacement without stiffness is a mode of its own.
    let diagonal: Vec<f64> = k.diagonal().iter().map(|d| if *d > 0.0 { *d } else { 1.0 }).collect();
    let mut shifted = Symmetric::of(n, |take| {
        k.lower_entries().for_each(|(i, j, _)| take(i, j));
        (0..n).for_each(|i| take(i, i));
    });
    let terms = k.lower_entries().chain((0..n).map(|i| (i, i, SHIFT * diagonal[i])));
    terms.for_each(|(i, j, value)| shifted.raise(i, j, value));
    let factor = Cholesky::factor(&shifted, &[])?;
    let mut block = FIRST_BLOCK.min(n);
    loop {
        let free = free_in_block(k, &diagonal, &factor, block)?;
        if free.len() < block || block == n {
            return Ok(free);
        }
        block = (4 * block).min(n);
    }
}

/// Returns the null vectors of `k` in a subspace of this dimension.
fn free_in_block(k: &Symmetric, diagonal: &[f64], factor: &Cholesky, block: usize) -> Computed<Vec<Vec<f64>>> {
    let n = diagonal.len();
    let mut vectors: Vec<Vec<f64>> = (0..block).map(|seed| start(n, seed)).collect();
    for _ in 0..STEPS {
        for x in &mut vectors {
            let force: Vec<f64> = x.iter().zip(diagonal).map(|(x, d)| x * d).collect();
            factor.solve(&force, x)?;
        }
        orthonormalise(&mut vectors, diagonal);
    }
    let forces: Vec<Vec<f64>> = (vectors.iter())
        .map(|x| {
            let mut force = vec![0.0; n];
            k.mul(x, &mut force);
            force
        })
        .collect();
    let energy = Mat::from_fn(vectors.len(), vectors.len(), |i, j| product(&vectors[i], &forces[j]));
    let failed = |_| LinearError::Backend { backend: "faer", step: "eigenvalues", status: -1 };
    let eigen = energy.self_adjoint_eigen(Side::Lower).map_err(failed)?;
    let ritz = (0..vectors.len()).map(|column| {
        let mut x = vec![0.0; n];
        for (i, vector) in vectors.iter().enumerate() {
            let share = eigen.U()[(i, column)];
            for (x, v) in x.iter_mut().zip(vector) {
                *x += share * v;
            }
        }
        let largest = x.iter().fold(0.0_f64, |m, x| if x.abs() > m.abs() { *x } else { m });
        for x in &mut x {
            *x /= largest;
        }
        x
    });
    Ok(ritz.filter(|x| is_free(k, diagonal, x)).collect())
}

/// Returns `true` if `K x` is rounding, in units in which the diagonal of `K` is 1.
fn is_free(k: &Symmetric, diagonal: &[f64], x: &[f64]) -> bool {
    let mut force = vec![0.0; x.len()];
    k.mul(x, &mut force);
    let force = force.iter().zip(diagonal).map(|(f, d)| f.abs() / d.sqrt()).fold(0.0, f64::max);
    let moved = x.iter().zip(diagonal).map(|(x, d)| x.abs() * d.sqrt()).fold(0.0, f64::max);
    force <= FREE * moved
}

/// Returns a vector without symmetry, the same in every run.
fn start(n: usize, seed: usize) -> Vec<f64> {
    let mut state = seed as u64 + 1;
    let mut draw = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    draw();
    (0..n).map(|_| draw()).collect()
}

/// Orthonormalises twice by Gram–Schmidt, in the inner product of the `diagonal`.
fn orthonormalise(vectors: &mut Vec<Vec<f64>>, diagonal: &[f64]) {
    let inner = |x: &[f64], y: &[f64]| x.iter().zip(y).zip(diagonal).map(|((x, y), d)| x * y * d).sum::<f64>();
    let mut basis: Vec<Vec<f64>> = Vec::with_capacity(vectors.len());
    for mut x in std::mem::take(vectors) {
        for _ in 0..2 {
            for other in &basis {
                let along = inner(&x, other);
                for (x, y) in x.iter_mut().zip(other) {
                    *x -= along * y;
                }
            }
            let length = inner(&x, &x).sqrt();
            for x in &mut x {
                *x /= length;
            }
        }
        basis.push(x);
    }
    *vectors = basis;
}

fn product(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
#[cfg(any(feature = "umfpack", feature = "faer"))]
mod tests {
    use super::*;

    /// Creates chains of springs; a further spring supports the first point of each chain for which `held` is `true`.
    fn chains(points: usize, held: &[bool]) -> Symmetric {
        let mut entries = Vec::new();
        for (chain, held) in held.iter().enumerate() {
            let first = chain * points;
            entries.push((first, first, f64::from(u8::from(*held))));
            for i in first + 1..first + points {
                entries.extend([(i - 1, i - 1, 1.0), (i, i, 1.0), (i, i - 1, -1.0)]);
            }
        }
        Symmetric::from_triplets(points * held.len(), &entries).unwrap()
    }

    #[test]
    fn as_many_as_chains_that_nothing_holds() {
        assert!(null_space_of(&chains(50, &[true])).unwrap().is_empty());
        for held in [vec![false], vec![false, true, false], vec![false; 9]] {
            let found = null_space_of(&chains(20, &held)).unwrap();
            assert_eq!(found.len(), held.iter().filter(|held| !**held).count());
            // Each null vector is constant along each chain, and 0 along supported ones.
            for r in &found {
                for (chain, held) in r.chunks(20).zip(&held) {
                    assert!(chain.iter().all(|x| (x - chain[0]).abs() < 1e-9 && (!held || x.abs() < 1e-9)), "{r:?}");
                }
            }
        }
    }

    #[test]
    fn a_matrix_of_zeros_lets_everything_move() {
        let none = Symmetric::from_triplets(3, &[]).unwrap();
        assert_eq!(null_space_of(&none).unwrap().len(), 3);
    }
}
