//! `∇H_I` on all unknowns, in one fixed pattern.

use crate::algebra::linear::SystemMatrix;
use crate::algebra::sparse::Pattern;
use crate::solver::formulation::SlackLayout;
use crate::solver::formulation::mixed::{matrix_with, slot, take_equilibrium, write_equilibrium};
use crate::solver::formulation::scaled::ScaledData;
use crate::solver::problem::ContactProblem;

/// The matrix, and the places of the entries of the products.
pub(super) struct Extended {
    matrix: SystemMatrix,
    /// The slots of each product row, in the order of the pairs: `∂/∂force` and `∂/∂length`.
    products: Vec<[usize; 2]>,
}

impl Extended {
    pub(super) fn new(problem: &ContactProblem, data: &ScaledData) -> Self {
        let layout = &SlackLayout::new(&data.layout);
        let n = layout.unknowns();
        let pattern = Pattern::of(n, n, |take| {
            take_equilibrium(problem, &data.layout, take);
            linear_rows(data, layout, &mut |row, column, _| take(row, column));
            for pair in layout.pairs() {
                take(pair.length, pair.force);
                take(pair.length, pair.length);
            }
        });
        let mut matrix = matrix_with(pattern, problem, &data.scaling);
        write_equilibrium(&mut matrix, problem, &data.layout, &data.scaling);
        let (pattern, values) = matrix.rest_mut().parts_mut();
        linear_rows(data, layout, &mut |row, column, value| values[slot(pattern, row, column)] = value);
        let products = layout.pairs().map(|pair| [pair.force, pair.length].map(|k| slot(pattern, pair.length, k)));
        let products = products.collect();
        Extended { matrix, products }
    }

    pub(super) fn matrix(&self) -> &SystemMatrix {
        &self.matrix
    }

    /// Writes the rows of the products; the others are constant.
    pub(super) fn linearize(&mut self, layout: &SlackLayout, z: &[f64]) {
        let values = self.matrix.rest_mut().values_mut();
        for (pair, [by_force, by_length]) in layout.pairs().zip(&self.products) {
            values[*by_force] = z[pair.length];
            values[*by_length] = z[pair.force];
        }
    }
}

/// Writes the entries of the gap, slip and cone rows, which are linear.
fn linear_rows(data: &ScaledData, layout: &SlackLayout, write: &mut dyn FnMut(usize, usize, f64)) {
    for i in 0..data.layout.contacts() {
        let p_n = data.layout.p_n(i);
        data.c_n.row(i).iter().for_each(|&(dof, c)| write(p_n, dof, c));
        write(p_n, layout.v_n(i), 1.0);
        if let Some(p_t) = data.layout.p_t(i) {
            data.c_t.row(i).iter().for_each(|&(dof, c)| write(p_t, dof, -c));
            let (s, lambda) = (layout.s(p_t), layout.lambda(p_t));
            for (sign, s, lambda) in [(1.0, s[0], lambda[0]), (-1.0, s[1], lambda[1])] {
                write(p_t, lambda, sign);
                write(s, s, 1.0);
                write(s, p_n, -data.mu[i]);
                write(s, p_t, sign);
            }
        }
    }
}
