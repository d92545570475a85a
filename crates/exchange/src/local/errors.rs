//! The error measure of a local problem: how well `(r, u)` satisfies the exact laws.
//!
//! It shares only the problem with the solvers, in its own units: no scaling, no projection of theirs, no merit
//! function. Forces are compared with `F / s`, velocities with `V s`, where `s = √W_NN` of the contact, `F` is the largest
//! `s |r|` and `V` the largest `|u| / s` or `|q| / s` of the contacts that `W` connects with it. Every error is a number
//! without a unit, whatever the unit of a contact, and no large number of contacts that nothing connects makes it small.
//! With `ρ = s r / F` and `υ = u / (s V)`, each error is the largest over all contacts of
//!
//! ```text
//! equilibrium   |u - W r - q| / (s V)                   where u is given; otherwise u is W r + q, summed in twice the precision
//! normal        |min(ρ_N, υ_N)|                         no penetration, no tension, no pressure across a gap
//! cone          (|ρ_T| - μ (ρ_N)₊)₊                     Coulomb's cone
//! dissipation   min(|υ_T|, |ρ_T + μ (ρ_N)₊ υ_T/|υ_T||)  slip against full friction
//! natural map   |(min(ρ_N, υ_N), ρ_T - Π(ρ_T - υ_T))|   Π projects on the disk of radius μ (ρ_N)₊
//! ```
//!
//! The natural map is 0 exactly if all laws hold. A residual of [`SOLVED`] counts as solved. Without friction, the only
//! law of the tangents is `r_T = 0`.

use serde::{Deserialize, Serialize};

use super::LocalProblem;
use stickslip::algebra::{DoubleDouble, UnionFind};

/// The natural map below which a problem counts as solved.
pub const SOLVED: f64 = 1e-10;

/// The violation of each law, the largest over all contacts, without units.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct LocalErrors {
    /// `|u - W r - q|`, relative to the largest velocity; 0 without a given `u`.
    pub equilibrium: f64,
    /// Penetration, tension, or a pressure across a gap.
    pub normal: f64,
    /// The force beyond Coulomb's cone.
    pub cone: f64,
    /// Slip without full friction opposing it.
    pub dissipation: f64,
    /// The combined residual of all laws.
    pub natural_map: f64,
    /// The contact where the natural map is largest; 0 without any error.
    pub contact: usize,
}

impl LocalErrors {
    /// Returns the larger of the natural map and the error of equilibrium.
    pub fn worst(&self) -> f64 {
        larger(self.natural_map, self.equilibrium)
    }

    /// Returns `true` if the laws hold within `tolerance`, and `false` if an error is NaN.
    pub fn within(&self, tolerance: f64) -> bool {
        self.worst() <= tolerance
    }
}

/// Returns the larger of two numbers; NaN is the largest.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// Returns the errors of forces `r`, with the velocities that follow from them.
pub(super) fn measure(problem: &LocalProblem, r: &[f64]) -> LocalErrors {
    judged(problem, r).1
}

/// Returns the velocities that follow from forces `r`, and the errors.
pub(super) fn judged(problem: &LocalProblem, r: &[f64]) -> (Vec<f64>, LocalErrors) {
    let u = velocities(problem, r);
    let errors = of_laws(problem, r, &u);
    (u, errors)
}

/// Returns the errors of given forces `r` and velocities `u`.
pub(super) fn measure_given(problem: &LocalProblem, r: &[f64], u: &[f64]) -> LocalErrors {
    let (scales, d) = (scales(problem, r, u), problem.dimension());
    let missed = velocities(problem, r).into_iter().zip(u).enumerate();
    let missed = missed.fold(0.0, |m, (k, (exact, u))| larger(over((exact - u).abs(), scales[k / d].velocity), m));
    LocalErrors { equilibrium: missed, ..of_laws(problem, r, u) }
}

/// The sizes with which the force and the velocity of a contact are compared.
#[derive(Clone, Copy, Default)]
struct Scales {
    force: f64,
    velocity: f64,
}

/// Returns the scales of each contact.
fn scales(problem: &LocalProblem, r: &[f64], u: &[f64]) -> Vec<Scales> {
    let (d, contacts) = (problem.dimension(), problem.contacts());
    let (mut sets, mut compliance) = (UnionFind::new(contacts), vec![0.0; contacts]);
    for (row, column, w) in problem.delassus().entries().filter(|(.., w)| *w != 0.0) {
        sets.join(row / d, column / d);
        if row == column && row % d == 0 {
            compliance[row / d] = w.abs();
        }
    }
    let part: Vec<usize> = (0..contacts).map(|i| sets.least(i)).collect();
    let mut whole = vec![0.0; contacts];
    part.iter().zip(&compliance).for_each(|(&part, w)| whole[part] = larger(*w, whole[part]));
    // A contact without compliance has the largest of its part.
    let unit = |i: usize| match (compliance[i], whole[part[i]]) {
        (0.0, 0.0) => 1.0,
        (0.0, largest) => largest.sqrt(),
        (own, _) => own.sqrt(),
    };
    let mut parts = vec![Scales::default(); contacts];
    for i in 0..contacts {
        let (own, at) = (&mut parts[part[i]], d * i..d * (i + 1));
        own.force = larger(largest(&r[at.clone()]) * unit(i), own.force);
        own.velocity = larger(larger(largest(&u[at.clone()]), largest(&problem.q()[at])) / unit(i), own.velocity);
    }
    let own = |i: usize| {
        let Scales { force, velocity } = parts[part[i]];
        Scales { force: force / unit(i), velocity: velocity * unit(i) }
    };
    (0..contacts).map(own).collect()
}

/// Returns the largest magnitude.
fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, value| larger(value.abs(), m))
}

/// Returns `value / scale`; 0 / 0 is 0.
fn over(value: f64, scale: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value / scale }
}

/// Returns the errors of the laws.
fn of_laws(problem: &LocalProblem, r: &[f64], u: &[f64]) -> LocalErrors {
    let scales = scales(problem, r, u);
    let mut errors = LocalErrors::default();
    let d = problem.dimension();
    for (i, mu) in problem.mu().iter().enumerate() {
        let part = |from: &[f64], scale: f64| {
            let mut whole = [0.0; 3];
            whole.iter_mut().zip(&from[d * i..d * (i + 1)]).for_each(|(to, from)| *to = over(*from, scale));
            whole
        };
        let ([r_n, r_t @ ..], [u_n, u_t @ ..]) = (part(r, scales[i].force), part(u, scales[i].velocity));
        let LocalContact { normal, cone, dissipation, natural_map } = contact(r_n, r_t, u_n, u_t, *mu);
        errors.normal = larger(normal, errors.normal);
        errors.cone = larger(cone, errors.cone);
        errors.dissipation = larger(dissipation, errors.dissipation);
        if natural_map.is_nan() || natural_map > errors.natural_map {
            (errors.natural_map, errors.contact) = (larger(natural_map, errors.natural_map), i);
        }
    }
    errors
}

/// Returns `W r + q`, in twice the working precision, because large forces may cancel almost completely.
fn velocities(problem: &LocalProblem, r: &[f64]) -> Vec<f64> {
    let mut sums = vec![DoubleDouble::default(); r.len()];
    problem.delassus().entries().for_each(|(row, column, w)| sums[row].add_product(w, r[column]));
    sums.iter_mut().zip(problem.q()).for_each(|(sum, q)| sum.add(*q));
    sums.into_iter().map(DoubleDouble::value).collect()
}

/// The errors of one contact.
struct LocalContact {
    normal: f64,
    cone: f64,
    dissipation: f64,
    natural_map: f64,
}

/// Returns the errors of a force and a velocity without units.
fn contact(r_n: f64, r_t: [f64; 2], u_n: f64, u_t: [f64; 2], mu: f64) -> LocalContact {
    let size = |[a, b]: [f64; 2]| a.hypot(b);
    let normal = if r_n < u_n { r_n } else { u_n };
    let radius = if r_n > 0.0 { mu * r_n } else { 0.0 };
    let (friction, slip) = (size(r_t), size(u_t));
    let missing = [0, 1].map(|k| if slip > 0.0 { r_t[k] + radius * (u_t[k] / slip) } else { 0.0 });
    let trial = [0, 1].map(|k| r_t[k] - u_t[k]);
    let reach = size(trial);
    let tangential = [0, 1].map(|k| if reach > radius { r_t[k] - radius * (trial[k] / reach) } else { u_t[k] });
    LocalContact {
        normal: normal.abs(),
        cone: if friction > radius { friction - radius } else { 0.0 },
        dissipation: if mu > 0.0 { slip.min(size(missing)) } else { 0.0 },
        natural_map: normal.hypot(size(tangential)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::algebra::Csc;

    /// Returns two unit masses that fall on a floor at 2 and slide at 3 and 0.5. Friction stops the second.
    fn masses() -> LocalProblem {
        let delassus = Csc::from_triplets(4, 4, &[(0, 0, 1.0), (1, 1, 1.0), (2, 2, 1.0), (3, 3, 1.0)]).unwrap();
        LocalProblem::new(2, delassus, vec![-2.0, 3.0, -2.0, 0.5], vec![0.5; 2]).unwrap()
    }

    const FORCES: [f64; 4] = [2.0, -1.0, 2.0, -0.5];

    #[test]
    fn the_solution_has_no_error() {
        assert_eq!(masses().errors(&FORCES, None).unwrap(), LocalErrors::default());
        assert_eq!(masses().errors(&FORCES, Some(&[0.0, 2.0, 0.0, 0.0])).unwrap(), LocalErrors::default());
    }

    /// Forces and velocities that violate one law each, with the error calculated by hand. Nothing connects the masses: the
    /// forces of each are compared with its own largest, mostly 2, velocities with 3 and 2.
    #[test]
    fn each_law_is_missed() {
        let of = |r: [f64; 4], u: Option<[f64; 4]>| masses().errors(&r, u.as_ref().map(|u| &u[..])).unwrap();
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-15, "{a} {b}");
        // A pressure too small lets the mass penetrate. A pressure too large acts although the mass separates.
        near(of([1.7, -0.85, 2.0, -0.5], None).normal, 0.1);
        near(of([2.0, -1.0, 2.5, -0.5], None).normal, 0.25);
        near(of([-0.5, 0.0, 2.0, -0.5], Some([0.0; 4])).normal, 1.0);
        // More friction than possible; less than slip requires; none at all.
        near(of([2.0, -1.2, 2.0, -0.5], None).cone, 0.1);
        near(of([2.0, -0.8, 2.0, -0.5], None).dissipation, 0.1);
        near(of([2.0, 0.0, 2.0, -0.5], None).dissipation, 0.5);
        let along = of([2.0, 1.0, 2.0, -0.5], None);
        near(along.dissipation, 1.0);
        assert_eq!(along.contact, 0);
        assert_eq!(of([2.0, -1.0, 2.0, 0.0], None).contact, 1);
        // Velocities that do not follow from the forces.
        near(of(FORCES, Some([0.0, 2.0, 0.0, 0.3])).equilibrium, 0.15);
        // The natural map detects every violation.
        for r in
            [[1.7, -0.85, 2.0, -0.5], [2.0, -0.8, 2.0, -0.5], [2.0, -1.2, 2.0, -0.5], [2.0, 1.0, 2.0, -0.5], [0.0; 4]]
        {
            assert!(of(r, None).natural_map > 0.05 && !of(r, None).within(SOLVED), "{r:?}");
        }
    }

    /// A load of 1e12 on the other mass hides nothing, and the unit of a contact does not matter.
    #[test]
    fn errors_do_not_depend_on_what_is_elsewhere() {
        let problem = |unit: f64, far: f64| {
            let entries = [(0, 0, unit * unit), (1, 1, unit * unit), (2, 2, 1.0), (3, 3, 1.0)];
            let q = vec![-2.0 * unit, 3.0 * unit, -far, 0.0];
            LocalProblem::new(2, Csc::from_triplets(4, 4, &entries).unwrap(), q, vec![0.5; 2]).unwrap()
        };
        let wrong = |unit: f64, far: f64| {
            problem(unit, far).errors(&[1.7 / unit, -1.0 / unit, far, 0.0], None).unwrap().natural_map
        };
        for (unit, far) in [(1e-12, 1.0), (1e12, 1.0), (1.0, 1e-12), (1.0, 1e12)] {
            assert!(
                (wrong(unit, far) / wrong(1.0, 1.0) - 1.0).abs() < 1e-9,
                "{unit:e} {far:e}: {:e}",
                wrong(unit, far)
            );
        }
    }

    /// Forces 1e9 and velocities 1e-9 times as large, approximated by powers of two so that results agree to the last
    /// bit.
    #[test]
    fn errors_have_no_unit() {
        let (force, velocity) = (2.0_f64.powi(30), 2.0_f64.powi(-30));
        let entries: Vec<_> = (0..4).map(|k| (k, k, velocity / force)).collect();
        let q = masses().q().iter().map(|q| q * velocity).collect();
        let other = LocalProblem::new(2, Csc::from_triplets(4, 4, &entries).unwrap(), q, vec![0.5; 2]).unwrap();
        let r = [1.9, -1.0, 2.1, 0.4];
        let there = other.errors(&r.map(|r| r * force), None).unwrap();
        assert_eq!(there, masses().errors(&r, None).unwrap());
    }

    #[test]
    fn what_is_no_number_is_no_solution() {
        let error = masses().errors(&[f64::NAN, 0.0, 0.0, 0.0], None).unwrap_err();
        assert_eq!(error.to_string(), "r[0] is NaN, but must be finite");
        let error = masses().errors(&FORCES, Some(&[0.0; 3])).unwrap_err();
        assert_eq!(error.to_string(), "u: there are 3, but must be 4, one for each direction of each contact in mu");
        let nan = LocalErrors { natural_map: f64::NAN, ..LocalErrors::default() };
        assert!(!nan.within(1.0) && nan.worst().is_nan());
        // Sums that overflow are no solution.
        let entries = [(0, 0, 1e300), (1, 1, 1.0)];
        let huge =
            LocalProblem::new(2, Csc::from_triplets(2, 2, &entries).unwrap(), vec![-1.0, 0.0], vec![0.5]).unwrap();
        assert!(!huge.errors(&[1e300, 0.0], None).unwrap().within(SOLVED));
        // If W r and q cancel, the remainder is exact.
        let r = [1.0 + f64::EPSILON, 0.0];
        let one = LocalProblem::new(
            2,
            Csc::from_triplets(2, 2, &[(0, 0, 1.0 - f64::EPSILON)]).unwrap(),
            vec![-1.0, 0.0],
            vec![0.5],
        );
        assert_eq!(velocities(&one.unwrap(), &r)[0], -f64::EPSILON * f64::EPSILON);
    }
}
