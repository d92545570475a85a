//! Checks of the parts of a problem.

use super::error::{expect_each, expect_finite, expect_length};
use super::{Increment, Parts, ProblemError, State};
use crate::algebra::linear::Stiffness;
use crate::algebra::sparse::Csr;
use crate::solver::problem::ContactProblem;

const PER_CONTACT: &str = "one for each row of c_n";
const PER_DISPLACEMENT: &str = "one for each displacement";

/// The relative negative eigenvalue of a 2 × 2 block of `K` that counts as rounding.
const SEMIDEFINITE: f64 = 1e-10;

/// The largest `K r` of a rigid mode `r`, relative to its terms. Rotations of bodies with a thousand elements per
/// side leave 1e-13.
const FREE: f64 = 1e-9;

/// A unit vector is linearly independent if its component orthogonal to the vectors before it is longer than this.
const INDEPENDENT: f64 = 1e-8;

pub(super) fn parts(parts: &Parts) -> Result<(), ProblemError> {
    let Parts { stiffness, c_n, c_t, c_o, mu, weight, .. } = parts;
    let (n_u, n_c) = (stiffness.order(), c_n.rows());
    if n_u == 0 {
        return Err(ProblemError::Empty);
    }
    semidefinite(stiffness)?;
    for (name, map) in [("c_n", c_n), ("c_t", c_t), ("c_o", c_o)] {
        size(name, map, n_c, n_u)?;
    }
    friction(mu, n_c)?;
    if let Some(weight) = weight {
        expect_length("weight", n_c, weight.len(), PER_CONTACT)?;
        expect_each("weight", weight, "above 0", |l| l > 0.0 && l.is_finite())?;
    }
    Ok(())
}

/// Checks friction coefficients of `n_c` contact nodes.
pub(super) fn friction(mu: &[f64], n_c: usize) -> Result<(), ProblemError> {
    expect_length("mu", n_c, mu.len(), PER_CONTACT)?;
    expect_each("mu", mu, "0 or more", |mu| mu >= 0.0 && mu.is_finite())
}

fn size(name: &str, map: &Csr, rows: usize, columns: usize) -> Result<(), ProblemError> {
    let fault = |of, expected, found, reason| {
        Err(ProblemError::Length { array: name.to_string(), of, expected, found, reason })
    };
    if map.rows() != rows {
        return fault("rows", rows, map.rows(), PER_CONTACT);
    }
    if map.columns() != columns {
        return fault("columns", columns, map.columns(), PER_DISPLACEMENT);
    }
    Ok(())
}

/// Checks every 2 × 2 block: `K_ii ≥ 0` and `K_ij² ≤ K_ii K_jj`. The factorisations detect what only larger blocks
/// would show. A distributed one is a sum of element stiffnesses, and no process sees all of it.
fn semidefinite(stiffness: &Stiffness) -> Result<(), ProblemError> {
    let stiffness = match stiffness {
        Stiffness::Assembled(stiffness) => stiffness,
        Stiffness::Distributed(rows) => return expect_finite("stiffness", rows.row_norms()),
    };
    let diagonal = stiffness.diagonal();
    for (row, column, between) in stiffness.lower_entries() {
        if !between.is_finite() {
            return Err(ProblemError::Value {
                array: format!("stiffness({row}, {column})"),
                value: between,
                must: "finite",
            });
        }
        let (first, second) = (diagonal[row], diagonal[column]);
        let bound = first.max(0.0).sqrt() * second.max(0.0).sqrt();
        if first < 0.0 || between.abs() > (1.0 + SEMIDEFINITE) * bound {
            return Err(ProblemError::Indefinite { row, column, first, between, second });
        }
    }
    Ok(())
}

/// Checks that `K r = 0` for each motion `r`, and that the motions are linearly independent.
pub(super) fn rigid_modes(stiffness: &Stiffness, motions: &[Vec<f64>]) -> Result<(), ProblemError> {
    let n_u = stiffness.order();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for (motion, r) in motions.iter().enumerate() {
        let name = format!("rigid_modes[{motion}]");
        expect_length(&name, n_u, r.len(), PER_DISPLACEMENT)?;
        expect_finite(&name, r)?;
        let (mut force, sizes) = (vec![0.0; n_u], stiffness.sizes(r)?);
        stiffness.mul(r, &mut force)?;
        let largest = sizes.iter().fold(0.0_f64, |m, size| m.max(*size));
        let worst = (0..n_u).max_by(|&i, &j| force[i].abs().total_cmp(&force[j].abs()));
        if let Some(row) = worst.filter(|&row| force[row].abs() > FREE * largest) {
            return Err(ProblemError::Resisted { motion, row, share: force[row].abs() / largest });
        }
        let length = r.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let mut left: Vec<f64> = r.iter().map(|x| x / length).collect();
        let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        let whole = norm(&left);
        for other in &basis {
            let along: f64 = left.iter().zip(other).map(|(x, y)| x * y).sum();
            left.iter_mut().zip(other).for_each(|(x, y)| *x -= along * y);
        }
        let rest = norm(&left);
        if rest.is_nan() || rest <= INDEPENDENT * whole {
            return Err(ProblemError::Dependent { motion });
        }
        for x in &mut left {
            *x /= rest;
        }
        basis.push(left);
    }
    Ok(())
}

impl Increment<'_> {
    /// # Errors
    /// [`ProblemError`] with the array that does not fit `problem`, or has a number that is not finite.
    pub fn check(&self, problem: &ContactProblem) -> Result<(), ProblemError> {
        expect_length("force", problem.displacements(), self.force.len(), PER_DISPLACEMENT)?;
        expect_finite("force", self.force)?;
        for (name, values) in [("gap", self.gap), ("w_t_last", self.w_t_last), ("w_o_last", self.w_o_last)] {
            expect_length(name, problem.contacts(), values.len(), PER_CONTACT)?;
            expect_finite(name, values)?;
        }
        expect_length("mu", problem.contacts(), self.mu.len(), PER_CONTACT)?;
        expect_finite("mu", self.mu)?;
        let mut pairs = self.mu.iter().zip(problem.mu());
        match pairs.position(|(now, ever)| !(*now >= 0.0 && (*now > 0.0) == (*ever > 0.0))) {
            None => Ok(()),
            Some(i) => {
                let must = "above 0 where that of the problem is, and 0 elsewhere";
                Err(ProblemError::Value { array: format!("mu[{i}]"), value: self.mu[i], must })
            }
        }
    }
}

impl State {
    /// Checks that the arrays have the lengths that `problem` needs. Their values are not checked: the error measure
    /// rejects a state that is not finite.
    ///
    /// # Errors
    /// [`ProblemError`] with the array of another length.
    pub fn check(&self, problem: &ContactProblem) -> Result<(), ProblemError> {
        expect_length("u", problem.displacements(), self.u.len(), PER_DISPLACEMENT)?;
        if !self.u_rest.is_empty() {
            expect_length("u_rest", problem.displacements(), self.u_rest.len(), PER_DISPLACEMENT)?;
        }
        for (name, values) in [("p_t", &self.p_t), ("p_o", &self.p_o), ("p_n", &self.p_n)] {
            expect_length(name, problem.contacts(), values.len(), PER_CONTACT)?;
        }
        Ok(())
    }
}
