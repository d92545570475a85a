//! Static condensation (33)–(35): a problem on the contact displacements alone, and the way back.
//!
//! With the contact displacements `u_c` and the interior `u_r`,
//!
//! ```text
//! [ K_rr K_rc ] [u_r]   [f_r]         S u_c = f̃_c,  S = K_cc - K_cr K_rr⁻¹ K_rc,
//! [ K_cr K_cc ] [u_c] = [f_c - Cᵀ p]                f̃_c = f_c - Cᵀ p - K_cr K_rr⁻¹ f_r.
//! ```
//!
//! `K` never changes. It is factored once with `u_c` last, so that `S = L_cc L_ccᵀ` stands in the factors,
//! see [`Cholesky`]. This stiffness form bears slender bodies, where the compliance form `C K⁻¹ Cᵀ` loses
//! half the digits. What a load case leaves of the interior is worked out once, too, so an
//! increment touches the interior only at its end, in [`Condensed::state`].
//!
//! A body that only contact holds has a singular `K`; then `ρ`, the diagonal of `K` as a rule, is added to the
//! contact block and taken off again, `S = L_cc L_ccᵀ - ρ`, which changes nothing else.

use std::sync::Arc;

use crate::linear::{Cholesky, FactorInfo, LinearError, Reduced, SparseCholesky, times_transposed};
use crate::loading::{LoadCase, Loading};
use crate::problem::{ContactProblem, Parts, State};
use crate::sparse::{Csc, Csr, Pattern, Symmetric};

/// A condensed body.
pub struct Condensed {
    /// The problem on `u_c`.
    pub problem: ContactProblem,
    /// Its loads.
    pub loading: Loading,
    factor: Cholesky,
    /// The contact displacements among all, ascending.
    border: Vec<usize>,
    /// What each load case leaves of the interior.
    cases: Vec<Reduced>,
}

impl Condensed {
    /// Condenses a body with its loads.
    ///
    /// # Errors
    /// [`LinearError::Singular`] when a part of the body moves freely while the contact nodes are held;
    /// when memory is short.
    pub fn new(problem: &ContactProblem, loading: &Loading, cholesky: SparseCholesky) -> Result<Self, LinearError> {
        let border = problem.contact_displacements();
        let (factor, stiffness) = schur_complement(problem.stiffness(), &border, cholesky)?;
        let cases = loading.cases().iter().map(|case| factor.reduce(case.force())).collect::<Result<Vec<_>, _>>()?;
        let reduced = |(case, reduced): (&LoadCase, &Reduced)| case.on(reduced.border.clone());
        Ok(Condensed {
            problem: ContactProblem::of(Parts {
                stiffness,
                c_n: restrict(problem.c_n(), &border, |_| true),
                c_t: restrict(problem.c_t(), &border, |i| problem.mu()[i] > 0.0),
                c_o: restrict(problem.c_o(), &border, |i| problem.mu()[i] > 0.0),
                mu: problem.mu().to_vec(),
                weight: problem.weight().map(<[f64]>::to_vec),
                free_motions: Some(
                    (problem.free_motions().iter())
                        .map(|motion| border.iter().map(|&dof| motion[dof]).collect())
                        .collect(),
                ),
            }),
            loading: loading.with_cases(loading.cases().iter().zip(&cases).map(reduced).collect()),
            factor,
            border,
            cases,
        })
    }

    /// The factors of the body.
    pub fn info(&self) -> FactorInfo {
        self.factor.info()
    }

    /// The state of the whole body at `time` (35), where `contact` is that of the condensed problem.
    ///
    /// # Errors
    /// When memory is short.
    pub fn state(&self, time: f64, contact: &State) -> Result<State, LinearError> {
        let factors: Vec<f64> = self.loading.cases().iter().map(|case| case.factor(time)).collect();
        let u = self.displacements(&self.factor.combine(&self.cases, &factors), &contact.u)?;
        let mut u_rest = Vec::new();
        if !contact.u_rest.is_empty() {
            u_rest = vec![0.0; u.len()];
            self.border.iter().zip(&contact.u_rest).for_each(|(&dof, rest)| u_rest[dof] = *rest);
        }
        Ok(State { u, u_rest, ..contact.clone() })
    }

    /// Reduces forces on the whole body (N) to the contact displacements: `b_c - K_cr K_rr⁻¹ b_r`.
    ///
    /// # Errors
    /// When memory is short.
    pub fn reduce(&self, forces: &[f64]) -> Result<Reduced, LinearError> {
        self.factor.reduce(forces)
    }

    /// The displacements (m) that reduced forces make while the contact displacements are `border` (m).
    ///
    /// # Errors
    /// When memory is short.
    pub fn displacements(&self, forces: &Reduced, border: &[f64]) -> Result<Vec<f64>, LinearError> {
        let mut u = vec![0.0; self.factor.order()];
        self.factor.expand(forces, border, &mut u)?;
        Ok(u)
    }
}

/// The factors of `K`, and `S`.
fn schur_complement(
    stiffness: &Symmetric,
    border: &[usize],
    cholesky: SparseCholesky,
) -> Result<(Cholesky, Symmetric), LinearError> {
    let mut shift = Vec::new();
    let factor = match cholesky.factor(stiffness, border) {
        Err(LinearError::Singular { .. }) if !border.is_empty() => {
            let (mut held, diagonal) = (stiffness.clone(), stiffness.diagonal());
            // What has no stiffness of its own takes that of others, or any.
            let largest = diagonal.iter().fold(0.0_f64, |m, rho| m.max(*rho));
            let other = if largest > 0.0 { largest } else { 1.0 };
            let stored = |dof: usize| stiffness.lower().pattern().slot(dof, dof).is_some();
            let rho = |&dof: &usize| match diagonal[dof] {
                own if own > 0.0 => own,
                _ if stored(dof) => other,
                _ => 0.0,
            };
            shift.extend(border.iter().map(rho));
            border.iter().zip(&shift).filter(|entry| *entry.1 > 0.0).for_each(|(&dof, rho)| held.raise(dof, dof, *rho));
            cholesky.factor(&held, border)?
        }
        factor => factor?,
    };
    // What moves freely without contact taking part.
    let pivot_ratio = factor.interior_pivot_ratio()?;
    if pivot_ratio <= f64::EPSILON {
        return Err(LinearError::Singular { pivot_ratio });
    }
    let m = border.len();
    let mut values = times_transposed(&factor.trailing(), m);
    shift.iter().enumerate().for_each(|(i, rho)| values[i * m + i] -= rho);
    let mut lower = Csc::zeros(Arc::new(Pattern::full_lower(m)));
    let columns = (0..m).flat_map(|j| &values[j * m + j..(j + 1) * m]);
    lower.values_mut().iter_mut().zip(columns).for_each(|(entry, value)| *entry = *value);
    Ok((factor, Symmetric::from_lower(lower).expect("a lower triangle")))
}

/// The rows of `map` that are `wanted`, on the contact displacements; the others are empty.
fn restrict(map: &Csr, border: &[usize], wanted: impl Fn(usize) -> bool) -> Csr {
    let place = |dof: &usize| border.binary_search(dof).ok();
    let row = |i: usize| map.row(i).iter().filter_map(move |(dof, c)| place(dof).map(|k| (k, *c)));
    Csr::of_rows(border.len(), (0..map.rows()).map(|i| row(i).filter(|_| wanted(i)).collect::<Vec<_>>()))
}
