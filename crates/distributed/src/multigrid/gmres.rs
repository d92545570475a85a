//! Flexible GMRES: the preconditioner may differ in each iteration (Saad, 1993).

use rayon::prelude::*;

use stickslip::algebra::linear::LinearError;

/// The result of a solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Found {
    pub iterations: usize,
    /// `‖b - A x‖ / ‖b‖`, from the recursion.
    pub residual: f64,
}

/// The largest size of a basis, after which GMRES restarts.
const RESTART: usize = 60;

/// The length of partial sums. It does not depend on the number of threads, so that sums do not either.
const PIECE: usize = 4096;

/// Solves `A x = b` from `x = 0` until the relative residual is `tolerance`, in at most `limit` iterations, as long
/// as numbers are finite. `product` computes `y = A x`, `precondition` an approximate solution `z` of `A z = r`.
pub(super) fn solve(
    b: &[f64],
    x: &mut [f64],
    tolerance: f64,
    limit: usize,
    mut product: impl FnMut(&[f64], &mut [f64]) -> Result<(), LinearError>,
    mut precondition: impl FnMut(&[f64], &mut [f64]) -> Result<(), LinearError>,
) -> Result<Found, LinearError> {
    let n = b.len();
    x.fill(0.0);
    let target = tolerance * norm(b);
    let (mut residual, mut iterations) = (b.to_vec(), 0);
    let mut beta = norm(&residual);
    while beta > target && iterations < limit && beta.is_finite() {
        let mut basis = vec![scaled(&residual, 1.0 / beta)];
        let mut directions: Vec<Vec<f64>> = Vec::new();
        let mut triangle: Vec<Vec<f64>> = Vec::new();
        let mut turns: Vec<(f64, f64)> = Vec::new();
        let mut right = vec![beta];
        while directions.len() < RESTART && iterations < limit && right[directions.len()].abs() > target {
            let k = directions.len();
            let (mut z, mut w) = (vec![0.0; n], vec![0.0; n]);
            precondition(&basis[k], &mut z)?;
            product(&z, &mut w)?;
            let mut column = orthogonalised(&mut w, &basis);
            let size = norm(&w);
            for (i, (c, s)) in turns.iter().enumerate() {
                (column[i], column[i + 1]) = (c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]);
            }
            let rest = column[k].hypot(size);
            iterations += 1;
            if !rest.is_finite() {
                return Ok(Found { iterations, residual: f64::NAN });
            }
            directions.push(z);
            if rest == 0.0 {
                // The basis cannot grow: the preconditioned direction adds nothing new.
                return Ok(Found { iterations, residual: right[k].abs() / norm(b) });
            }
            let (c, s) = (column[k] / rest, size / rest);
            turns.push((c, s));
            column[k] = rest;
            column.truncate(k + 1);
            triangle.push(column);
            right.push(-s * right[k]);
            right[k] *= c;
            basis.push(scaled(&w, if size > 0.0 { 1.0 / size } else { 0.0 }));
        }
        for (c, z) in back_substituted(&triangle, &right).iter().zip(&directions) {
            x.iter_mut().zip(z).for_each(|(x, z)| *x += c * z);
        }
        product(x, &mut residual)?;
        residual.iter_mut().zip(b).for_each(|(r, b)| *r = b - *r);
        let last = beta;
        beta = norm(&residual);
        if beta > 0.5 * last {
            break;
        }
    }
    Ok(Found { iterations, residual: if beta == 0.0 { 0.0 } else { beta / norm(b) } })
}

/// Orthogonalises `w` twice against an orthonormal `basis`, to remove rounding. Returns the coefficients, with one
/// more place.
fn orthogonalised(w: &mut [f64], basis: &[Vec<f64>]) -> Vec<f64> {
    let mut taken = vec![0.0; basis.len() + 1];
    for _ in 0..2 {
        // A part of w stays in the cache for the whole basis.
        let of_piece = |(k, w): (usize, &[f64])| -> Vec<f64> {
            basis.iter().map(|v| dot(&v[k * PIECE..][..w.len()], w)).collect()
        };
        let pieces: Vec<Vec<f64>> = w.par_chunks(PIECE).enumerate().map(of_piece).collect();
        let products: Vec<f64> = (0..basis.len()).map(|j| pieces.iter().map(|piece| piece[j]).sum()).collect();
        w.par_chunks_mut(PIECE).enumerate().for_each(|(k, w)| {
            for (v, product) in basis.iter().zip(&products) {
                w.iter_mut().zip(&v[k * PIECE..]).for_each(|(w, v)| *w -= product * v);
            }
        });
        taken.iter_mut().zip(products).for_each(|(taken, product)| *taken += product);
    }
    taken
}

/// Returns `aᵀ b`, in eight parallel sums.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    const SIDE_BY_SIDE: usize = 8;
    let (a, b) = (a.chunks_exact(SIDE_BY_SIDE), b.chunks_exact(SIDE_BY_SIDE));
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    let mut sums = [0.0; SIDE_BY_SIDE];
    for (a, b) in a.zip(b) {
        (0..SIDE_BY_SIDE).for_each(|k| sums[k] += a[k] * b[k]);
    }
    sums.iter().sum::<f64>() + rest
}

fn back_substituted(triangle: &[Vec<f64>], right: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; triangle.len()];
    for i in (0..triangle.len()).rev() {
        let known: f64 = (i + 1..triangle.len()).map(|j| triangle[j][i] * y[j]).sum();
        y[i] = (right[i] - known) / triangle[i][i];
    }
    y
}

fn norm(v: &[f64]) -> f64 {
    let pieces: Vec<f64> = v.par_chunks(PIECE).map(|v| dot(v, v)).collect();
    pieces.iter().sum::<f64>().sqrt()
}

fn scaled(v: &[f64], by: f64) -> Vec<f64> {
    v.iter().map(|v| v * by).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Multiplies by an unsymmetric tridiagonal matrix.
    #[allow(clippy::unnecessary_wraps, reason = "as products by several processes")]
    fn product(x: &[f64], y: &mut [f64]) -> Result<(), LinearError> {
        for i in 0..x.len() {
            let before = if i > 0 { x[i - 1] } else { 0.0 };
            let after = x.get(i + 1).copied().unwrap_or(0.0);
            y[i] = (3.0 + i as f64) * x[i] - 1.5 * before - 0.5 * after;
        }
        Ok(())
    }

    #[test]
    fn it_solves_with_a_diagonal_and_at_once_with_an_inverse() {
        let b: Vec<f64> = (0..50).map(|i| f64::from(i % 7) - 2.0).collect();
        let mut x = vec![0.0; 50];
        let diagonal = |r: &[f64], z: &mut [f64]| {
            z.iter_mut().zip(r).enumerate().for_each(|(i, (z, r))| *z = r / (3.0 + i as f64));
            Ok(())
        };
        let found = solve(&b, &mut x, 1e-12, 60, product, diagonal).unwrap();
        let mut again = vec![0.0; 50];
        product(&x, &mut again).unwrap();
        assert!(found.residual <= 1e-12 && found.iterations < 40, "{found:?}");
        assert!(again.iter().zip(&b).all(|(a, b)| (a - b).abs() <= 1e-10));
        let known = x.clone();
        let inverse = |r: &[f64], z: &mut [f64]| {
            // b is a multiple of the first vector of the basis.
            let share = r[0] / b[0];
            z.iter_mut().zip(&known).for_each(|(z, x)| *z = share * x);
            Ok(())
        };
        assert_eq!(solve(&b, &mut x, 1e-10, 60, product, inverse).unwrap().iterations, 1);
    }

    #[test]
    fn it_says_where_it_stands_still() {
        let b = vec![1.0; 50];
        let mut x = vec![0.0; 50];
        let found = solve(&b, &mut x, 1e-12, 5, product, |r, z| {
            z.copy_from_slice(r);
            Ok(())
        });
        assert!(found.unwrap().residual > 1e-12);
        let nothing = solve(&b, &mut x, 1e-12, 60, product, |_, z| {
            z.fill(f64::NAN);
            Ok(())
        });
        assert!(nothing.unwrap().residual.is_nan());
    }
}
