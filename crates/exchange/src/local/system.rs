//! The linear systems of all methods: `(A (W + ε D) + B) x = b` with blocks `A` and `B` of one contact each.
//!
//! `D` is the compliance `1/ρ` of each contact. The proximal term `ε` makes the matrix regular if `W` is not. It
//! appears only in this matrix and in no equation, so it does not change the limit of an iteration. Contacts with `A =
//! 0` are eliminated.

use super::factors::{Add, Factors};
use super::law::Linear;
use super::scaled::ScaledContacts;
use stickslip::algebra::linear::LinearError;

/// The factors of one matrix.
pub(super) struct FactoredMatrix<'a> {
    scaled: &'a ScaledContacts,
    blocks: &'a [Linear],
    /// The index of each row in the factored matrix; `None` for an eliminated contact.
    numbers: Vec<Option<usize>>,
    factors: Factors,
}

impl<'a> FactoredMatrix<'a> {
    /// Factors the matrix of these `blocks` with the `proximal` term `ε`.
    ///
    /// # Errors
    /// When it is singular, or has numbers that are not finite.
    pub(super) fn new(scaled: &'a ScaledContacts, blocks: &'a [Linear], proximal: f64) -> Result<Self, LinearError> {
        let (mut numbers, mut order) = (vec![None; scaled.rows()], 0);
        for (k, block) in blocks.iter().enumerate() {
            if block.by_u.iter().flatten().any(|a| *a != 0.0) {
                for row in scaled.range(k) {
                    numbers[row] = Some(order);
                    order += 1;
                }
            }
        }
        let visit = |add: &mut Add<'_>| {
            for (k, Linear { by_u, by_r }) in blocks.iter().enumerate() {
                let range = scaled.range(k);
                let Some(first) = numbers[range.start] else { continue };
                for (c, source) in range.clone().enumerate() {
                    for &(column, w) in scaled.delassus.row(source) {
                        let Some(place) = numbers[column] else { continue };
                        let w = if column == source { w + proximal / scaled.laws[k].stiffness } else { w };
                        for (a, by_u) in by_u.iter().take(range.len()).enumerate() {
                            add(first + a, place, by_u[c] * w);
                        }
                    }
                    for (a, by_r) in by_r.iter().take(range.len()).enumerate() {
                        add(first + a, first + c, by_r[c]);
                    }
                }
            }
        };
        let factors = Factors::new(order, &visit)?;
        Ok(FactoredMatrix { scaled, blocks, numbers, factors })
    }

    /// Returns the solution for `b`.
    pub(super) fn solve(&mut self, b: &[f64]) -> Vec<f64> {
        // For an eliminated contact the solution is known: x = b.
        let mut x: Vec<f64> =
            b.iter().zip(&self.numbers).map(|(b, place)| if place.is_some() { 0.0 } else { *b }).collect();
        let known = x.iter().any(|x| *x != 0.0);
        let given = if known { self.scaled.product(&x) } else { vec![0.0; x.len()] };
        let mut rest = Vec::with_capacity(x.len());
        for (k, Linear { by_u, .. }) in self.blocks.iter().enumerate() {
            let range = self.scaled.range(k);
            if self.numbers[range.start].is_none() {
                continue;
            }
            let given = self.scaled.at(k, &given);
            rest.extend(range.enumerate().map(|(a, row)| b[row] - (0..3).map(|c| by_u[a][c] * given[c]).sum::<f64>()));
        }
        let found = self.factors.solve(&rest);
        x.iter_mut().zip(&self.numbers).for_each(|(x, place)| {
            if let Some(place) = place {
                *x = found[*place];
            }
        });
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::local::LocalProblem;
    use crate::local::law::UNIT;
    use stickslip::algebra::Csc;

    /// Solves `(A (W + ε D) + B) x = b` with blocks of all kinds and one eliminated contact.
    #[test]
    fn the_solution_solves_the_system() {
        let entries: Vec<_> = (0..81).map(|k| (k / 9, k % 9, 1.0 / (1.0 + (k / 9 + k % 9) as f64))).collect();
        let problem = LocalProblem::new(3, Csc::from_triplets(9, 9, &entries).unwrap(), vec![1.0; 9], vec![0.5; 3]);
        let scaled = ScaledContacts::new(&problem.unwrap());
        let mixed = |shift: f64| [0, 1, 2].map(|k| [0, 1, 2].map(|l| shift / (2.0 + f64::from(k + 3 * l))));
        let mut by_u = mixed(1.0);
        (0..3).for_each(|k| by_u[k][k] += 1.0);
        let open = Linear { by_u: [[0.0; 3]; 3], by_r: UNIT };
        let blocks = [Linear { by_u, by_r: mixed(0.3) }, open, Linear { by_u, by_r: UNIT }];
        let b: Vec<f64> = (0..9).map(|k| f64::from(k) - 3.0).collect();
        let proximal = 0.25;
        let x = FactoredMatrix::new(&scaled, &blocks, proximal).unwrap().solve(&b);
        let mut product = scaled.product(&x);
        for (k, law) in scaled.laws.iter().enumerate() {
            scaled.range(k).for_each(|row| product[row] += proximal / law.stiffness * x[row]);
        }
        for (k, Linear { by_u, by_r }) in blocks.iter().enumerate() {
            let (w, own, right) = (scaled.at(k, &product), scaled.at(k, &x), scaled.at(k, &b));
            for c in 0..3 {
                let left: f64 = (0..3).map(|l| by_u[c][l] * w[l] + by_r[c][l] * own[l]).sum();
                assert!((left - right[c]).abs() < 1e-12, "{k} {c}: {left} {}", right[c]);
            }
        }
    }

    #[test]
    fn the_proximal_term_makes_it_regular() {
        let entries = [(0, 0, 1.0), (0, 2, 1.0), (2, 0, 1.0), (2, 2, 1.0)];
        let problem = LocalProblem::new(2, Csc::from_triplets(4, 4, &entries).unwrap(), vec![-1.0; 4], vec![0.0; 2]);
        let scaled = ScaledContacts::new(&problem.unwrap());
        let closed = scaled.laws.iter().map(|law| law.linearize([1.0, 0.0, 0.0], [0.0; 3])).collect::<Vec<_>>();
        assert!(matches!(FactoredMatrix::new(&scaled, &closed, 0.0), Err(LinearError::Singular { .. })));
        let x = FactoredMatrix::new(&scaled, &closed, 1e-6).unwrap().solve(&[1.0, 1.0]);
        assert!(x.iter().all(|x| (x - 0.5).abs() < 1e-6), "{x:?}");
    }
}
