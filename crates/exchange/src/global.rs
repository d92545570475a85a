//! The global problem: the unknowns of bodies, and the forces between them.

use super::{Problem, Solution};
use crate::checks::{expect_dimension, expect_finite, expect_friction, expect_size};
use stickslip::algebra::{Csc, Csr, Symmetric};
use stickslip::base::InputError;
use stickslip::solver::{ContactProblem, LoadCase, Loading, Motion, Parts as ContactParts, ProblemError};

/// The problem `M v = f + H r`, `u = Hᵀ v + w` with the laws of contact and friction. It is valid, because
/// [`GlobalProblem::new`] checks it.
#[derive(Debug, Clone)]
pub struct GlobalProblem {
    parts: Parts,
}

/// The data of a [`GlobalProblem`], in any consistent units.
#[derive(Debug, Clone)]
pub struct Parts {
    /// `d`, the dimension: 2 in the plane and 3 in space.
    pub dimension: usize,
    /// `M`, n × n; it need not be symmetric.
    pub m: Csc,
    /// `H`, n × n_c d, which maps contact forces to forces on the unknowns, contact by contact, the normal first.
    pub h: Csc,
    /// `f`, n.
    pub f: Vec<f64>,
    /// `w`, n_c d.
    pub w: Vec<f64>,
    /// `μ`, n_c.
    pub mu: Vec<f64>,
    /// The number of unknowns, the last ones, that are multipliers of equality constraints, which have no diagonal.
    pub constraints: usize,
}

impl GlobalProblem {
    /// Creates a problem from its parts. It may have no contact at all.
    ///
    /// # Errors
    /// [`InputError`] of an array of wrong length, with a number that is not finite, or with a negative μ.
    pub fn new(parts: Parts) -> Result<Self, InputError> {
        let Parts { dimension, m, h, f, w, mu, constraints } = &parts;
        expect_dimension(*dimension)?;
        if f.is_empty() || *constraints >= f.len() {
            return Err(InputError::new("f", "there is no unknown", "give a body an unknown, or the local problem"));
        }
        let (n, rows) = (f.len(), mu.len().saturating_mul(*dimension));
        let sizes = [
            ("M", "rows", n, m.pattern().rows()),
            ("M", "columns", n, m.pattern().columns()),
            ("H", "rows", n, h.pattern().rows()),
            ("H", "columns", rows, h.pattern().columns()),
            ("w", "entries", rows, w.len()),
        ];
        let help = "M has a row for each entry of f, H and w have d for each entry of mu";
        sizes.into_iter().try_for_each(|(key, what, expected, found)| expect_size(key, what, expected, found, help))?;
        let arrays = [("M", m.values()), ("H", h.values()), ("f", f), ("w", w)];
        arrays.into_iter().try_for_each(|(key, values)| expect_finite(key, values))?;
        expect_friction(mu)?;
        Ok(GlobalProblem { parts })
    }

    /// Returns `d`, the dimension: 2 in the plane and 3 in space.
    pub fn dimension(&self) -> usize {
        self.parts.dimension
    }

    /// Returns n_c, the number of contacts.
    pub fn contacts(&self) -> usize {
        self.parts.mu.len()
    }

    /// Returns n, the number of unknowns, including multipliers of constraints.
    pub fn unknowns(&self) -> usize {
        self.parts.f.len()
    }

    /// Returns the number of unknowns, the last ones, that are multipliers of equality constraints.
    pub fn constraints(&self) -> usize {
        self.parts.constraints
    }

    /// Returns `M`, n × n.
    pub fn m(&self) -> &Csc {
        &self.parts.m
    }

    /// Returns `H`, n × n_c d.
    pub fn h(&self) -> &Csc {
        &self.parts.h
    }

    /// Returns `f`, n.
    pub fn f(&self) -> &[f64] {
        &self.parts.f
    }

    /// Returns `w`, n_c d.
    pub fn w(&self) -> &[f64] {
        &self.parts.w
    }

    /// Returns `μ`, n_c.
    pub fn mu(&self) -> &[f64] {
        &self.parts.mu
    }

    /// Returns `true` if `M` has entries in one triangle only. It is used as given, but may be meant as half of a
    /// symmetric matrix.
    pub fn is_triangular(&self) -> bool {
        let (mut below, mut above) = (false, false);
        for (row, column, value) in self.m().entries() {
            below |= row > column && value != 0.0;
            above |= row < column && value != 0.0;
        }
        below != above
    }

    /// Returns `M` if it is symmetric to rounding, which a triangle alone is not.
    fn symmetric(&self) -> Option<Symmetric> {
        if self.is_triangular() { None } else { Symmetric::from_csc(self.m()).ok() }
    }

    /// Converts the problem to the notation of [`stickslip::ContactProblem`], with the loading of one increment that
    /// ends at t = 1. Returns `None` if `M` is not symmetric.
    ///
    /// # Errors
    /// [`ProblemError`] of a stiffness that is not positive semidefinite.
    #[allow(clippy::missing_panics_doc, reason = "the entries of H were checked when the problem was made")]
    pub fn contact_problem(&self) -> Result<Option<(ContactProblem, Loading)>, ProblemError> {
        let Some(stiffness) = self.symmetric() else { return Ok(None) };
        let (n, d, n_c) = (self.unknowns(), self.dimension(), self.contacts());
        let mut rows: [Vec<Vec<(usize, f64)>>; 3] = std::array::from_fn(|_| vec![Vec::new(); n_c]);
        for (row, column, value) in self.h().entries() {
            // C_n = -H_Nᵀ, C_t = H_Tᵀ.
            let sign = if column % d == 0 { -1.0 } else { 1.0 };
            rows[column % d][column / d].push((row, sign * value));
        }
        let [c_n, c_t, c_o] = rows.map(|rows| Csr::from_rows(n, rows).expect("H has n rows and finite entries"));
        let mu = self.mu().to_vec();
        let problem = ContactProblem::new(ContactParts { c_t, c_o, mu, ..ContactParts::new(stiffness, c_n) })?;
        let part = |k: usize| self.w().iter().skip(k).step_by(d).copied();
        let gap: Vec<f64> = part(0).collect();
        let loading = Loading::new(vec![LoadCase::new(self.f().to_vec(), Vec::new())?], gap)?;
        let drift: Vec<[f64; 2]> = match d {
            2 => part(1).map(|w| [-w, 0.0]).collect(),
            _ => part(1).zip(part(2)).map(|(t, o)| [-t, -o]).collect(),
        };
        if drift.iter().flatten().all(|drift| *drift == 0.0) {
            return Ok(Some((problem, loading)));
        }
        let motion = Motion::new(0..n_c, vec![0.0; n_c], drift, vec![[0.0, 0.0], [1.0, 1.0]])?;
        Ok(Some((problem, loading.with_motions(vec![motion], Vec::new())?)))
    }

    /// Returns `u = Hᵀ v + w`.
    pub(super) fn velocities(&self, v: &[f64]) -> Vec<f64> {
        let mut u = self.w().to_vec();
        self.h().entries().for_each(|(row, column, value)| u[column] += value * v[row]);
        u
    }
}

impl Solution {
    /// Checks the lengths and numbers for `problem`.
    ///
    /// # Errors
    /// [`InputError`] of an array of wrong length, or with a number that is not finite.
    pub fn check(&self, problem: &Problem) -> Result<(), InputError> {
        let rows = problem.contacts() * problem.dimension();
        let arrays = [("v", problem.unknowns(), &self.v), ("r", rows, &self.r), ("u", rows, &self.u)];
        for (key, expected, values) in arrays {
            let help = "give a solution of this problem, in the same form: global or local";
            expect_size(key, "entries", expected, values.len(), help)?;
            expect_finite(key, values)?;
        }
        Ok(())
    }
}
