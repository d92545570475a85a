//! The matrix on `(u, p_t, p_n)` that both methods factor: equilibrium rows that never change, and
//! per contact node a normal and a tangential row whose coefficients do.

use std::sync::Arc;

use super::Layout;
use crate::problem::ContactProblem;
use crate::sparse::{Csc, Pattern};
use crate::units::Scaling;

/// `[K C_tᵀ C_nᵀ; tangential rows; normal rows]` on one fixed pattern.
pub(super) struct MixedMatrix {
    matrix: Csc,
    slots: Vec<Slots>,
}

/// Where the values of one contact node's rows are stored.
struct Slots {
    /// `∂(normal row)/∂u`: slot and coefficient of `C_n`.
    normal_u: Vec<(usize, f64)>,
    normal_p_n: usize,
    tangential: Option<TangentialSlots>,
}

struct TangentialSlots {
    /// `∂(tangential row)/∂u`: slot and coefficient of `C_t`.
    u: Vec<(usize, f64)>,
    p_t: usize,
    p_n: usize,
}

impl MixedMatrix {
    /// Sets up the pattern, the constant entries and the places of the others.
    ///
    /// # Panics
    /// If the union pattern lacked an entry that it was made with: never.
    pub(super) fn new(problem: &ContactProblem, layout: &Layout, scaling: &Scaling) -> Self {
        let mut matrix = Csc::zeros(Arc::new(union_pattern(problem, layout)));
        write_equilibrium(&mut matrix, problem, layout, scaling);
        let slot = |row, column| slot(&matrix.pattern, row, column);
        let slots = (0..layout.contacts()).map(|i| {
            let p_n = layout.p_n(i);
            let tangential = layout.p_t(i).map(|p_t| TangentialSlots {
                u: problem.c_t.row(i).iter().map(|&(dof, c)| (slot(p_t, dof), c)).collect(),
                p_t: slot(p_t, p_t),
                p_n: slot(p_t, p_n),
            });
            Slots {
                normal_u: problem.c_n.row(i).iter().map(|&(dof, c)| (slot(p_n, dof), c)).collect(),
                normal_p_n: slot(p_n, p_n),
                tangential,
            }
        });
        let slots = slots.collect();
        MixedMatrix { matrix, slots }
    }

    pub(super) fn matrix(&self) -> &Csc {
        &self.matrix
    }

    /// Writes the normal row of node `i`: `by_w_n C_n du + by_p_n dp_n`.
    pub(super) fn set_normal(&mut self, i: usize, by_w_n: f64, by_p_n: f64) {
        let (values, slots) = (&mut self.matrix.values, &self.slots[i]);
        slots.normal_u.iter().for_each(|&(k, c)| values[k] = by_w_n * c);
        values[slots.normal_p_n] = by_p_n;
    }

    /// Writes the tangential row of node `i`, if it has one:
    /// `by_w_t C_t du + by_p_t dp_t + by_p_n dp_n`.
    pub(super) fn set_tangential(&mut self, i: usize, by_w_t: f64, by_p_t: f64, by_p_n: f64) {
        let (values, slots) = (&mut self.matrix.values, &self.slots[i]);
        if let Some(slots) = &slots.tangential {
            slots.u.iter().for_each(|&(k, c)| values[k] = by_w_t * c);
            values[slots.p_t] = by_p_t;
            values[slots.p_n] = by_p_n;
        }
    }
}

/// The slot of an entry that `pattern` was made with.
pub(super) fn slot(pattern: &Pattern, row: usize, column: usize) -> usize {
    pattern.slot(row, column).expect("the pattern holds every entry it was made with")
}

/// Names the entries of the equilibrium rows, `K`, `C_nᵀ` and `C_tᵀ`.
pub(super) fn take_equilibrium(problem: &ContactProblem, layout: &Layout, take: &mut dyn FnMut(usize, usize)) {
    problem.stiffness.entries().for_each(|(row, column, _)| take(row, column));
    for i in 0..layout.contacts() {
        problem.c_n.row(i).iter().for_each(|&(dof, _)| take(dof, layout.p_n(i)));
        if let Some(p_t) = layout.p_t(i) {
            problem.c_t.row(i).iter().for_each(|&(dof, _)| take(dof, p_t));
        }
    }
}

/// Writes the equilibrium rows, which are constant.
pub(super) fn write_equilibrium(matrix: &mut Csc, problem: &ContactProblem, layout: &Layout, scaling: &Scaling) {
    let Csc { pattern, values } = matrix;
    // The rows of each column come in ascending order, and those of K are the first: no search, which would
    // take longest of all in the set-up where K is dense.
    let mut next: Vec<usize> = pattern.column_starts().iter().map(|&start| start as usize).collect();
    for (row, column, value) in problem.stiffness.entries() {
        debug_assert_eq!(pattern.row_indices()[next[column]], row as i64);
        values[next[column]] = value / scaling.stiffness();
        next[column] += 1;
    }
    for i in 0..layout.contacts() {
        for &(dof, c) in problem.c_n.row(i) {
            values[slot(pattern, dof, layout.p_n(i))] = c;
        }
        if let Some(p_t) = layout.p_t(i) {
            for &(dof, c) in problem.c_t.row(i) {
                values[slot(pattern, dof, p_t)] = c;
            }
        }
    }
}

/// The union of the patterns of all cases of (21), which is also that of (25) once its slacks and
/// multipliers are eliminated: what a case does not use holds an explicit zero.
fn union_pattern(problem: &ContactProblem, layout: &Layout) -> Pattern {
    let n = layout.unknowns();
    Pattern::from_entries(n, n, |take| {
        take_equilibrium(problem, layout, take);
        for i in 0..layout.contacts() {
            let p_n = layout.p_n(i);
            problem.c_n.row(i).iter().for_each(|&(dof, _)| take(p_n, dof));
            take(p_n, p_n);
            if let Some(p_t) = layout.p_t(i) {
                problem.c_t.row(i).iter().for_each(|&(dof, _)| take(p_t, dof));
                take(p_t, p_t);
                take(p_t, p_n);
            }
        }
    })
}
