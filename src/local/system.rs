//! The linear systems of all methods: `(A (W + ε D) + B) x = b` with blocks `A` and `B` of one contact each.
//!
//! `D` is the compliance `1/ρ` of each contact; `ε`, the proximal term, makes the matrix regular where `W` is not. It stands in this matrix
//! alone and in no equation, so that what an iteration converges to is not changed by it. A contact whose `A` is 0 is left out.

use faer::Mat;

use super::law::Linear;
use super::scaled::Scaled;
use crate::linear::{LinearError, Lu};

/// Factors of one matrix.
pub(super) struct System<'a> {
    scaled: &'a Scaled,
    blocks: &'a [Linear],
    /// Place of each row in the matrix that is factored; none of a contact that is left out.
    places: Vec<Option<usize>>,
    lu: Lu,
}

impl<'a> System<'a> {
    /// Factors the matrix of these `blocks` with the `proximal` term `ε`.
    ///
    /// # Errors
    /// When it is singular, or holds numbers that are not finite.
    pub(super) fn new(scaled: &'a Scaled, blocks: &'a [Linear], proximal: f64) -> Result<Self, LinearError> {
        let (mut places, mut order) = (vec![None; scaled.rows()], 0);
        for (k, block) in blocks.iter().enumerate() {
            if block.by_u.iter().flatten().any(|a| *a != 0.0) {
                for row in scaled.range(k) {
                    places[row] = Some(order);
                    order += 1;
                }
            }
        }
        let mut matrix = Mat::<f64>::zeros(order, order);
        for (k, Linear { by_u, by_r }) in blocks.iter().enumerate() {
            let range = scaled.range(k);
            let Some(first) = places[range.start] else { continue };
            for (c, source) in range.clone().enumerate() {
                for &(column, w) in scaled.delassus.row(source) {
                    let Some(place) = places[column] else { continue };
                    let w = if column == source { w + proximal / scaled.laws()[k].stiffness } else { w };
                    for a in 0..range.len() {
                        matrix[(first + a, place)] += by_u[a][c] * w;
                    }
                }
                for a in 0..range.len() {
                    matrix[(first + a, first + c)] += by_r[a][c];
                }
            }
        }
        let lu = Lu::new(matrix, &vec![1.0; order])?;
        Ok(System { scaled, blocks, places, lu })
    }

    /// `x` of `b`.
    pub(super) fn solve(&self, b: &[f64]) -> Vec<f64> {
        // What is left out is known: x = b there.
        let mut x: Vec<f64> =
            b.iter().zip(&self.places).map(|(b, place)| if place.is_some() { 0.0 } else { *b }).collect();
        let known = x.iter().any(|x| *x != 0.0);
        let given = if known { self.scaled.delassus.mul(&x) } else { vec![0.0; x.len()] };
        let mut rest = Vec::with_capacity(x.len());
        for (k, Linear { by_u, .. }) in self.blocks.iter().enumerate() {
            let range = self.scaled.range(k);
            if self.places[range.start].is_none() {
                continue;
            }
            let given = self.scaled.at(k, &given);
            rest.extend(range.enumerate().map(|(a, row)| b[row] - (0..3).map(|c| by_u[a][c] * given[c]).sum::<f64>()));
        }
        let found = self.lu.solve(&rest);
        x.iter_mut().zip(&self.places).for_each(|(x, place)| {
            if let Some(place) = place {
                *x = found[*place];
            }
        });
        x
    }
}
