//! Measures how well a solution satisfies the laws, independent of its origin.
//!
//! For a local problem this is [`LocalProblem::errors`](crate::local::LocalProblem::errors). For a global one, the
//! equilibrium of the bodies is added. The measure needs no factorisation and uses nothing of the solvers. All errors
//! are without units, and do not depend on the units of single unknowns, contacts, lengths or angles, nor on bodies that
//! nothing connects. With `D`, the diagonal of `M`, and `s = √(Hᵀ D⁻¹ H)_NN` of a contact, the largest of each part being
//! meant,
//!
//! ```text
//! equilibrium   max |M v - f - H r| / √D   over   max (|f| + |H| |r|) / √D
//! velocities    |u - Hᵀ v - w| / (s V)
//! laws          with s r / F and u / (s V); F = max s |r|, V the largest of |u|, |w|, |H|ᵀ |v| and
//!               |H|ᵀ D⁻¹ (|f| + |H| |r|), each over s
//! ```
//!
//! Rounding `v` to double precision changes `M v` by `ε |M| |v|`, which does not count as an error.

use super::{GlobalProblem, Problem, Solution};
use crate::measure::{Errors, Scales, raise, relative};
use stickslip::algebra::{DoubleDouble, UnionFind};
use stickslip::base::InputError;

/// Returns the errors of `solution`.
///
/// # Errors
/// [`InputError`] when its lengths do not fit `problem`, or a number is not finite.
pub fn judge(problem: &Problem, solution: &Solution) -> Result<Errors, InputError> {
    solution.check(problem)?;
    match problem {
        Problem::Global(problem) => Ok(global(problem, solution)),
        Problem::Local(problem) => problem.errors(&solution.r, Some(&solution.u)),
    }
}

fn global(problem: &GlobalProblem, Solution { v, r, u }: &Solution) -> Errors {
    let n = problem.unknowns();
    let mut diagonal = vec![0.0; n];
    let mut balance = vec![DoubleDouble::default(); n];
    let (mut rounding, mut forces) = (vec![0.0; n], problem.f().iter().map(|f| f.abs()).collect::<Vec<_>>());
    for (row, column, m) in problem.m().entries() {
        balance[row].add_product(m, v[column]);
        rounding[row] += f64::EPSILON * (m * v[column]).abs();
        if row == column {
            diagonal[row] = m.abs();
        }
    }
    let mut exact: Vec<DoubleDouble> = vec![DoubleDouble::default(); u.len()];
    let mut sizes: Vec<f64> = problem.w().iter().map(|w| w.abs()).collect();
    for (row, column, h) in problem.h().entries() {
        balance[row].add_product(-h, r[column]);
        forces[row] += (h * r[column]).abs();
        exact[column].add_product(h, v[row]);
        sizes[column] += (h * v[row]).abs();
    }
    let mut errors = Errors::default();
    let Parts { of_unknown, of_contact, unit } = parts(problem, &diagonal);
    // Rows with a diagonal, and rows of constraints without one.
    for constrained in [false, true] {
        let scaled = |row: usize, value: f64| if constrained { value } else { value / diagonal[row].sqrt() };
        let (mut error, mut scale) = (vec![0.0; n], vec![0.0; n]);
        for row in (0..n).filter(|row| (diagonal[*row] == 0.0) == constrained) {
            let mut sum = balance[row];
            sum.add(-problem.f()[row]);
            let residual = sum.value().abs();
            let residual = if residual > rounding[row] { residual - rounding[row] } else { 0.0 * residual };
            raise(&mut error[of_unknown[row]], scaled(row, residual));
            // A constraint is compared only with the sizes of its terms.
            let own = if constrained { forces[row] + rounding[row] / f64::EPSILON } else { forces[row] };
            raise(&mut scale[of_unknown[row]], scaled(row, own));
        }
        error.iter().zip(&scale).for_each(|(error, scale)| raise(&mut errors.equilibrium, relative(*error, *scale)));
    }
    let mut free = vec![0.0; u.len()];
    for (row, column, h) in problem.h().entries().filter(|(row, ..)| diagonal[*row] > 0.0) {
        free[column] += (h * forces[row] / diagonal[row]).abs();
    }
    let d = problem.dimension();
    let mut largest = vec![Scales::default(); n.max(of_contact.len())];
    for (k, velocity) in [u, &sizes, &free].into_iter().flat_map(|values| values.iter().enumerate()) {
        let (own, unit) = (&mut largest[of_contact[k / d]], unit[k / d]);
        raise(&mut own.velocity, velocity.abs() / unit);
        raise(&mut own.force, r[k].abs() * unit);
    }
    let scales: Vec<Scales> =
        of_contact.iter().zip(&unit).map(|(&part, &unit)| largest[part].of_contact(unit)).collect();
    for (k, mut exact) in exact.into_iter().enumerate() {
        exact.add(problem.w()[k]);
        exact.add(-u[k]);
        raise(&mut errors.velocities, relative(exact.value(), scales[k / d].velocity));
    }
    errors.add_laws(d, problem.mu(), &scales, r, u);
    errors
}

/// The parts of the bodies that `M` and contacts connect.
struct Parts {
    of_unknown: Vec<usize>,
    of_contact: Vec<usize>,
    /// `s` of each contact, or 1 where nothing moves.
    unit: Vec<f64>,
}

fn parts(problem: &GlobalProblem, diagonal: &[f64]) -> Parts {
    let (n, d, contacts) = (problem.unknowns(), problem.dimension(), problem.mu().len());
    let (mut sets, mut compliance) = (UnionFind::new(n + contacts), vec![0.0; contacts]);
    problem.m().entries().filter(|(.., m)| *m != 0.0).for_each(|(row, column, _)| sets.join(row, column));
    for (row, column, h) in problem.h().entries().filter(|(.., h)| *h != 0.0) {
        sets.join(row, n + column / d);
        if column % d == 0 && diagonal[row] > 0.0 {
            compliance[column / d] += h * h / diagonal[row];
        }
    }
    // A contact alone counts with the first unknown.
    let of_contact = (0..contacts).map(|i| Some(sets.least(n + i)).filter(|part| *part < n).unwrap_or(0)).collect();
    let unit = compliance.into_iter().map(|w: f64| if w > 0.0 { w.sqrt() } else { 1.0 }).collect();
    Parts { of_unknown: (0..n).map(|row| sets.least(row)).collect(), of_contact, unit }
}
