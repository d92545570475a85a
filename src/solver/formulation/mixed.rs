//! The matrix on `(u, p_t, p_o, p_n)` that both methods factor: constant equilibrium rows, and for each contact node
//! a normal row and a row for each tangential unknown, with variable coefficients.

use std::sync::Arc;

use super::Layout;
use crate::algebra::linear::SystemMatrix;
use crate::algebra::sparse::Pattern;
use crate::base::units::Scaling;
use crate::solver::problem::ContactProblem;

/// `[K C_tᵀ C_oᵀ C_nᵀ; tangential rows; normal rows]` on one fixed pattern, which clones share.
#[derive(Clone)]
pub(super) struct MixedMatrix {
    matrix: SystemMatrix,
    slots: Arc<[Slots]>,
    springs: Vec<Spring>,
}

/// A spring that pins a displacement.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spring {
    /// The index of the displacement.
    pub dof: usize,
    /// The stiffness, equal to the entry of `K`, so that adding and removing it causes no rounding.
    pub stiffness: f64,
}

/// The places of the values of one contact node's rows.
struct Slots {
    /// The compliances of the node along normal and tangents, 0 unless its rows depend on others.
    compliance: [f64; 2],
    /// `∂(normal row)/∂u`: slot and coefficient of `C_n`.
    normal_u: Vec<(usize, f64)>,
    normal_p_n: usize,
    /// The slots of the rows at `p_t` and at `p_o`.
    tangential: [Option<TangentialSlots>; 2],
}

struct TangentialSlots {
    /// `∂(tangential row)/∂u`: slot and coefficients of `C_t` and `C_o`.
    u: Vec<(usize, [f64; 2])>,
    /// The slots of `p_t` and `p_o`, if the node has them.
    p: [Option<usize>; 2],
    p_n: usize,
}

/// The coefficients of a tangential row: those of `(C_t du, C_o du)`, of `(dp_t, dp_o)` and of `dp_n`. Coefficients
/// of unknowns that the node does not have are ignored.
pub(super) struct TangentialRow {
    pub w: [f64; 2],
    pub p: [f64; 2],
    pub p_n: f64,
}

impl MixedMatrix {
    /// Sets up the pattern, the constant entries and the places of the others.
    pub(super) fn new(problem: &ContactProblem, layout: &Layout, scaling: &Scaling) -> Self {
        let mut matrix = matrix_with(union_pattern(problem, layout), problem, scaling);
        write_equilibrium(&mut matrix, problem, layout, scaling);
        let slot = |row, column| slot(matrix.pattern(), row, column);
        let slots = (0..layout.contacts()).map(|i| {
            let p_n = layout.p_n(i);
            let dofs = layout.tangential(i);
            let tangential = dofs.map(|row| {
                row.map(|row| TangentialSlots {
                    u: sliding(problem, layout, i).into_iter().map(|(dof, c)| (slot(row, dof), c)).collect(),
                    p: dofs.map(|p| p.map(|p| slot(row, p))),
                    p_n: slot(row, p_n),
                })
            });
            Slots {
                compliance: problem.natural().compliance[i].map(|e| e * scaling.stiffness()),
                normal_u: problem.c_n().row(i).iter().map(|&(dof, c)| (slot(p_n, dof), c)).collect(),
                normal_p_n: slot(p_n, p_n),
                tangential,
            }
        });
        let slots = slots.collect();
        MixedMatrix { matrix, slots, springs: Vec::new() }
    }

    /// Pins the displacements at `dofs` by springs as stiff as their entries of `K`, or of unit stiffness if an
    /// entry is 0.
    pub(super) fn tie(&mut self, dofs: impl Iterator<Item = usize>) {
        for dof in dofs {
            if let Some(slot) = self.matrix.pattern().slot(dof, dof) {
                let stiffness = self.stiffness_at(dof);
                self.matrix.rest_mut().values_mut()[slot] += stiffness;
                self.springs.push(Spring { dof, stiffness });
            }
        }
    }

    /// Removes all springs.
    pub(super) fn release(&mut self) {
        for Spring { dof, stiffness } in std::mem::take(&mut self.springs) {
            let slot = slot(self.matrix.pattern(), dof, dof);
            self.matrix.rest_mut().values_mut()[slot] -= stiffness;
        }
    }

    /// Returns the entry of `K` of a displacement, or 1 if it is 0.
    fn stiffness_at(&self, dof: usize) -> f64 {
        Some(self.matrix.get(dof, dof)).filter(|own| *own > 0.0).unwrap_or(1.0)
    }

    /// Adds a drag of this `share` of its stiffness to the displacement `dof`, and returns it.
    pub(super) fn drag(&mut self, dof: usize, share: f64) -> f64 {
        let drag = share * self.stiffness_at(dof);
        if let Some(slot) = self.matrix.pattern().slot(dof, dof) {
            self.matrix.rest_mut().values_mut()[slot] += drag;
        }
        drag
    }

    /// Returns the springs in the equilibrium rows.
    pub(super) fn springs(&self) -> &[Spring] {
        &self.springs
    }

    pub(super) fn matrix(&self) -> &SystemMatrix {
        &self.matrix
    }

    /// Writes the normal row of node `i`: `by_w_n C_n du + by_p_n dp_n`.
    pub(super) fn set_normal(&mut self, i: usize, by_w_n: f64, by_p_n: f64) {
        let (values, slots) = (self.matrix.rest_mut().values_mut(), &self.slots[i]);
        slots.normal_u.iter().for_each(|&(k, c)| values[k] = by_w_n * c);
        values[slots.normal_p_n] = by_p_n - by_w_n * slots.compliance[0];
    }

    /// Writes the row of node `i` at its `p_t` (0) or `p_o` (1), if it has that unknown.
    pub(super) fn set_tangential(&mut self, i: usize, direction: usize, row: &TangentialRow) {
        let (values, slots) = (self.matrix.rest_mut().values_mut(), &self.slots[i]);
        let [_, compliance] = slots.compliance;
        if let Some(slots) = &slots.tangential[direction] {
            let [by_w_t, by_w_o] = row.w;
            slots.u.iter().for_each(|&(k, [c_t, c_o])| values[k] = by_w_t * c_t + by_w_o * c_o);
            for ((slot, value), by_w) in slots.p.into_iter().zip(row.p).zip(row.w) {
                if let Some(k) = slot {
                    values[k] = value - by_w * compliance;
                }
            }
            values[slots.p_n] = row.p_n;
        }
    }
}

/// Returns the slot of an entry of `pattern`.
pub(super) fn slot(pattern: &Pattern, row: usize, column: usize) -> usize {
    pattern.slot(row, column).expect("the pattern holds every entry it was made with")
}

/// Returns the displacements of the tangential unknowns of node `i`, with their coefficients in `C_t` and `C_o`.
fn sliding(problem: &ContactProblem, layout: &Layout, i: usize) -> Vec<(usize, [f64; 2])> {
    let mut columns = Vec::<(usize, [f64; 2])>::new();
    for (direction, map) in problem.tangential_maps().into_iter().enumerate() {
        let row = if layout.tangential(i)[direction].is_some() { map.row(i) } else { &[] };
        for &(dof, c) in row {
            match columns.iter_mut().find(|(column, _)| *column == dof) {
                Some((_, both)) => both[direction] += c,
                None => columns.push((dof, [0, 1].map(|d| if d == direction { c } else { 0.0 }))),
            }
        }
    }
    columns
}

/// Creates the matrix with these entries, all 0, and with `K` if it is dense or distributed.
pub(super) fn matrix_with(entries: Pattern, problem: &ContactProblem, scaling: &Scaling) -> SystemMatrix {
    SystemMatrix::of(problem.stiffness(), 1.0 / scaling.stiffness(), entries)
}

/// Passes the entries of the equilibrium rows, `K`, `C_nᵀ`, `C_tᵀ` and `C_oᵀ`, to `take`. Of a dense or distributed
/// `K` it passes the diagonal, to which springs are added.
pub(super) fn take_equilibrium(problem: &ContactProblem, layout: &Layout, take: &mut dyn FnMut(usize, usize)) {
    match problem.stiffness().compressed() {
        Some(stiffness) => stiffness.entries().for_each(|(row, column, _)| take(row, column)),
        None => (0..problem.displacements()).for_each(|place| take(place, place)),
    }
    for i in 0..layout.contacts() {
        problem.c_n().row(i).iter().for_each(|&(dof, _)| take(dof, layout.p_n(i)));
        for (map, place) in problem.tangential_maps().into_iter().zip(layout.tangential(i)) {
            if let Some(p) = place {
                map.row(i).iter().for_each(|&(dof, _)| take(dof, p));
            }
        }
    }
}

/// Writes the equilibrium rows, which are constant.
pub(super) fn write_equilibrium(
    matrix: &mut SystemMatrix,
    problem: &ContactProblem,
    layout: &Layout,
    scaling: &Scaling,
) {
    let (pattern, values) = matrix.rest_mut().parts_mut();
    if let Some(stiffness) = problem.stiffness().compressed() {
        // No search is needed: the rows of each column are ascending, and those of K come first.
        let mut next: Vec<usize> = pattern.column_starts().iter().map(|&start| start as usize).collect();
        for (row, column, value) in stiffness.entries() {
            debug_assert_eq!(pattern.row_indices()[next[column]], row as i64);
            values[next[column]] = value / scaling.stiffness();
            next[column] += 1;
        }
    }
    for i in 0..layout.contacts() {
        for &(dof, c) in problem.c_n().row(i) {
            values[slot(pattern, dof, layout.p_n(i))] = c;
        }
        for (map, place) in problem.tangential_maps().into_iter().zip(layout.tangential(i)) {
            if let Some(p) = place {
                map.row(i).iter().for_each(|&(dof, c)| values[slot(pattern, dof, p)] = c);
            }
        }
    }
}

/// Returns the union of the patterns of all cases of (21), which is also that of (25) after elimination of its slacks
/// and multipliers. Entries that a case does not use are explicit zeros.
fn union_pattern(problem: &ContactProblem, layout: &Layout) -> Pattern {
    let n = layout.unknowns();
    Pattern::of(n, n, |take| {
        take_equilibrium(problem, layout, take);
        for i in 0..layout.contacts() {
            let p_n = layout.p_n(i);
            problem.c_n().row(i).iter().for_each(|&(dof, _)| take(p_n, dof));
            take(p_n, p_n);
            let dofs = layout.tangential(i).into_iter().flatten();
            for row in dofs.clone() {
                for (dof, _) in sliding(problem, layout, i) {
                    take(row, dof);
                }
                dofs.clone().for_each(|p| take(row, p));
                take(row, p_n);
            }
        }
    })
}
