//! The B-differentiable formulation: `H_N` (19) and its linearisation (21) on `z = (u, p_t, p_n)`.

use std::sync::Arc;

use super::{Formulation, Layout};
use crate::contact::coulomb::{
    NormalCase, TangentialCase, normal_case, normal_residual, tangential_case, tangential_residual,
};
use crate::null_space::null_space;
use crate::problem::{ContactProblem, Increment};
use crate::sparse::{Csc, Csr, Pattern};
use crate::units::Scaling;

/// The free choices of the formulation: `r_i`, and the units in which `Theta` adds its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Conventions {
    /// `r_i`, n_c, N/m.
    pub r: Vec<f64>,
    /// What a normal or tangential row, in N, is divided by before it enters `Theta`, n_c.
    pub row_unit: Vec<f64>,
}

impl Conventions {
    /// The paper's: `r_i = 10¹² l_i`, and contact rows as stresses (Pa) beside equilibrium rows as
    /// forces (N).
    pub fn paper(problem: &ContactProblem) -> Self {
        Conventions { r: problem.weight.iter().map(|l| 1e12 * l).collect(), row_unit: problem.weight.clone() }
    }
}

/// `H_N` of a problem, in the units of its scaling, with its Jacobian on one fixed pattern.
pub struct Bdiff {
    layout: Layout,
    scaling: Scaling,
    c_n: Csr,
    c_t: Csr,
    mu: Vec<f64>,
    r: Vec<f64>,
    /// Per contact node, in the unit of force: what its rows are divided by in `Theta`.
    row_unit: Vec<f64>,
    force: Vec<f64>,
    gap: Vec<f64>,
    w_t_last: Vec<f64>,
    jacobian: Csc,
    slots: Vec<Slots>,
    cases: Vec<Option<(NormalCase, Option<TangentialCase>)>>,
    free_motions: Vec<Vec<f64>>,
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

impl Bdiff {
    /// Sets up `H_N` of `problem`: the pattern, the constant entries of the Jacobian and the places
    /// of the others.
    ///
    /// # Panics
    /// If the union pattern lacked an entry that it was made with: never.
    pub fn new(problem: &ContactProblem, scaling: Scaling, conventions: &Conventions) -> Self {
        let layout = Layout::new(problem);
        let pattern = Arc::new(union_pattern(problem, &layout));
        let mut jacobian = Csc::zeros(pattern);
        let slot = |row: usize, column: usize, jacobian: &Csc| {
            jacobian.pattern.slot(row, column).expect("the union pattern holds every case's entries")
        };
        for (row, column, value) in problem.stiffness.entries() {
            let k = slot(row, column, &jacobian);
            jacobian.values[k] = value / scaling.stiffness();
        }
        let mut slots = Vec::with_capacity(layout.contacts());
        for i in 0..layout.contacts() {
            let p_n = layout.p_n(i);
            for &(dof, c) in problem.c_n.row(i) {
                let k = slot(dof, p_n, &jacobian);
                jacobian.values[k] = c;
            }
            let normal_u = problem.c_n.row(i).iter().map(|&(dof, c)| (slot(p_n, dof, &jacobian), c)).collect();
            let tangential = layout.p_t(i).map(|p_t| {
                for &(dof, c) in problem.c_t.row(i) {
                    let k = slot(dof, p_t, &jacobian);
                    jacobian.values[k] = c;
                }
                TangentialSlots {
                    u: problem.c_t.row(i).iter().map(|&(dof, c)| (slot(p_t, dof, &jacobian), c)).collect(),
                    p_t: slot(p_t, p_t, &jacobian),
                    p_n: slot(p_t, p_n, &jacobian),
                }
            });
            slots.push(Slots { normal_u, normal_p_n: slot(p_n, p_n, &jacobian), tangential });
        }
        let n_c = layout.contacts();
        Bdiff {
            force: vec![0.0; layout.displacements()],
            gap: vec![0.0; n_c],
            w_t_last: vec![0.0; n_c],
            layout,
            scaling,
            c_n: problem.c_n.clone(),
            c_t: problem.c_t.clone(),
            mu: problem.mu.clone(),
            r: conventions.r.iter().map(|r| r / scaling.stiffness()).collect(),
            row_unit: conventions.row_unit.clone(),
            jacobian,
            slots,
            cases: vec![None; n_c],
            free_motions: problem.free_motions.clone(),
        }
    }

    /// The layout of `z`.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// The units of `z`.
    pub fn scaling(&self) -> &Scaling {
        &self.scaling
    }

    /// `-min(p_n, r (g - w_n))` of node `i`.
    fn normal_row(&self, i: usize, p_n: f64, w_n: f64) -> f64 {
        normal_residual(p_n, w_n, self.gap[i], self.r[i])
    }

    /// `-p_t + Π(p_t + r (w_t - w̄_t))` of node `i`.
    fn tangential_row(&self, i: usize, p_t: f64, p_n: f64, w_t: f64) -> f64 {
        tangential_residual(p_t, p_n, w_t - self.w_t_last[i], self.mu[i], self.r[i])
    }

    /// Writes the rows of node `i` for its cases in (21); tells whether they changed.
    fn write_rows(&mut self, i: usize, normal: NormalCase, tangential: Option<TangentialCase>) -> bool {
        if self.cases[i] == Some((normal, tangential)) {
            return false;
        }
        self.cases[i] = Some((normal, tangential));
        let (values, slots, r) = (&mut self.jacobian.values, &self.slots[i], self.r[i]);

        let (by_u, by_p_n) = match normal {
            NormalCase::Open => (0.0, -1.0),
            NormalCase::Closed => (r, 0.0),
        };
        slots.normal_u.iter().for_each(|&(k, c)| values[k] = by_u * c);
        values[slots.normal_p_n] = by_p_n;

        if let (Some(case), Some(slots)) = (tangential, &slots.tangential) {
            let (by_u, by_p_t, by_p_n) = match case {
                TangentialCase::NoPressure => (0.0, -1.0, 0.0),
                TangentialCase::Stick => (r, 0.0, 0.0),
                TangentialCase::Slip { sign } => (0.0, -1.0, self.mu[i] * sign),
            };
            slots.u.iter().for_each(|&(k, c)| values[k] = by_u * c);
            values[slots.p_t] = by_p_t;
            values[slots.p_n] = by_p_n;
        }
        true
    }

    /// The contact rows' share of `Theta` at `z + t dz`, in units of force².
    fn contact_merit(&self, z: &[f64], dz: &[f64], t: f64) -> f64 {
        let mut sum = 0.0;
        for i in 0..self.layout.contacts() {
            let n = self.layout.p_n(i);
            let p_n = z[n] + t * dz[n];
            let w_n = self.c_n.dot(i, z) + t * self.c_n.dot(i, dz);
            let mut square = self.normal_row(i, p_n, w_n).powi(2);
            if let Some(k) = self.layout.p_t(i) {
                let w_t = self.c_t.dot(i, z) + t * self.c_t.dot(i, dz);
                square += self.tangential_row(i, z[k] + t * dz[k], p_n, w_t).powi(2);
            }
            sum += square / self.row_unit[i].powi(2);
        }
        0.5 * sum
    }

    /// The equilibrium rows' share of `Theta`, in units of force².
    fn equilibrium_merit(&self, h: &[f64]) -> f64 {
        0.5 * h[..self.layout.displacements()].iter().map(|x| x * x).sum::<f64>()
    }
}

impl Formulation for Bdiff {
    fn unknowns(&self) -> usize {
        self.layout.unknowns()
    }

    fn begin(&mut self, increment: &Increment<'_>) {
        let Scaling { force, length } = self.scaling;
        let convert = |to: &mut Vec<f64>, from: &[f64], unit: f64| {
            to.clear();
            to.extend(from.iter().map(|x| x / unit));
        };
        convert(&mut self.force, increment.force, force);
        convert(&mut self.gap, increment.gap, length);
        convert(&mut self.w_t_last, increment.w_t_last, length);
    }

    /// (19).
    fn residual(&self, z: &[f64], h: &mut [f64]) {
        // The equilibrium rows of the Jacobian are constant: K u + C_nᵀ p_n + C_tᵀ p_t - f.
        self.jacobian.mul(z, h);
        for (row, force) in h.iter_mut().zip(&self.force) {
            *row -= force;
        }
        for i in 0..self.layout.contacts() {
            let n = self.layout.p_n(i);
            h[n] = self.normal_row(i, z[n], self.c_n.dot(i, z));
            if let Some(k) = self.layout.p_t(i) {
                h[k] = self.tangential_row(i, z[k], z[n], self.c_t.dot(i, z));
            }
        }
    }

    /// (10), `½ Hᵀ H` with every row in its unit of [`Conventions`], SI.
    fn merit(&self, h: &[f64]) -> f64 {
        let mut contact = 0.0;
        for i in 0..self.layout.contacts() {
            let tangential = self.layout.p_t(i).map_or(0.0, |k| h[k]);
            contact += (h[self.layout.p_n(i)].powi(2) + tangential.powi(2)) / self.row_unit[i].powi(2);
        }
        (self.equilibrium_merit(h) + 0.5 * contact) * self.scaling.force.powi(2)
    }

    /// The equilibrium rows are linear and `dz` solves them, so along it they shrink by `1 - t`:
    /// a trial step costs O(n_c).
    fn merit_along<'a>(&'a self, z: &'a [f64], dz: &'a [f64], h: &[f64]) -> impl Fn(f64) -> f64 + 'a {
        let equilibrium = self.equilibrium_merit(h);
        let unit = self.scaling.force.powi(2);
        move |t| ((1.0 - t).powi(2) * equilibrium + self.contact_merit(z, dz, t)) * unit
    }

    /// (21).
    fn linearize(&mut self, z: &[f64]) -> bool {
        let mut changed = false;
        for i in 0..self.layout.contacts() {
            let (p_n, r) = (z[self.layout.p_n(i)], self.r[i]);
            let normal = normal_case(p_n, self.c_n.dot(i, z), self.gap[i], r);
            let tangential = self.layout.p_t(i).map(|k| {
                let slip = self.c_t.dot(i, z) - self.w_t_last[i];
                tangential_case(z[k], p_n, slip, self.mu[i], r)
            });
            changed |= self.write_rows(i, normal, tangential);
        }
        changed
    }

    fn hold_contacts(&mut self) {
        for i in 0..self.layout.contacts() {
            self.write_rows(i, NormalCase::Closed, self.layout.p_t(i).map(|_| TangentialCase::Stick));
        }
    }

    fn jacobian(&self) -> &Csc {
        &self.jacobian
    }

    /// A rigid motion stays free if no closed node stops it along the normal and no sticking node
    /// along the tangent.
    fn unheld_motion(&self) -> Option<Vec<f64>> {
        let motions = &self.free_motions;
        let row = |c: &Csr, i: usize| motions.iter().map(|motion| c.dot(i, motion)).collect::<Vec<f64>>();
        let closed = |i: usize| matches!(self.cases[i], Some((NormalCase::Closed, _)));
        let sticks = |i: usize| matches!(self.cases[i], Some((_, Some(TangentialCase::Stick))));
        let contacts = 0..self.layout.contacts();
        let normal = contacts.clone().filter(|&i| closed(i)).map(|i| row(&self.c_n, i));
        let tangential = contacts.filter(|&i| sticks(i)).map(|i| row(&self.c_t, i));
        null_space(motions.len(), normal.chain(tangential)).into_iter().next()
    }

    fn is_affine(&self) -> bool {
        self.layout.contacts() == 0
    }
}

/// The union of the patterns of all cases of (21): what a case does not use holds an explicit zero.
fn union_pattern(problem: &ContactProblem, layout: &Layout) -> Pattern {
    let n = layout.unknowns();
    Pattern::from_entries(n, n, |take| {
        problem.stiffness.entries().for_each(|(row, column, _)| take(row, column));
        for i in 0..layout.contacts() {
            let p_n = layout.p_n(i);
            for &(dof, _) in problem.c_n.row(i) {
                take(dof, p_n);
                take(p_n, dof);
            }
            take(p_n, p_n);
            if let Some(p_t) = layout.p_t(i) {
                for &(dof, _) in problem.c_t.row(i) {
                    take(dof, p_t);
                    take(p_t, dof);
                }
                take(p_t, p_t);
                take(p_t, p_n);
            }
        }
    })
}
