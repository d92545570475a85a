//! The error measure of a local problem: how well `(r, u)` satisfies the exact laws, see [`Errors`].
//!
//! It shares only the problem with the solvers, in its own units. Forces are compared with `F / s`, velocities with `V s`,
//! where `s = √W_NN` of the contact, `F` is the largest `s |r|` and `V` the largest `|u| / s` or `|q| / s` of the contacts
//! that `W` connects with it: `ρ = s r / F`, `υ = u / (s V)`. Every error is a number without a unit, whatever the unit of a
//! contact, and no large number of contacts that nothing connects makes it small. The error of equilibrium is
//! `|u - W r - q| / (s V)` where `u` is given; otherwise `u` is `W r + q`, summed in twice the precision.

use super::LocalProblem;
use crate::measure::{Errors, Scales, raise, relative};
use stickslip::algebra::{DoubleDouble, UnionFind};

/// Returns the errors of forces `r` with the velocities `given`, or with those that follow from the forces, which are
/// returned as well.
pub(super) fn measure(problem: &LocalProblem, r: &[f64], given: Option<&[f64]>) -> (Errors, Vec<f64>) {
    let (exact, d) = (velocities(problem, r), problem.dimension());
    let u = given.unwrap_or(&exact);
    let scales = scales(problem, r, u);
    let mut errors = Errors::default();
    for (k, (exact, u)) in exact.iter().zip(u).enumerate() {
        raise(&mut errors.equilibrium, relative(exact - u, scales[k / d].velocity));
    }
    errors.add_laws(d, problem.mu(), &scales, r, u);
    (errors, exact)
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
    part.iter().zip(&compliance).for_each(|(&part, w)| raise(&mut whole[part], *w));
    // A contact without compliance has the largest of its part.
    let unit = |i: usize| match (compliance[i], whole[part[i]]) {
        (0.0, 0.0) => 1.0,
        (0.0, largest) => f64::sqrt(largest),
        (own, _) => own.sqrt(),
    };
    let mut parts = vec![Scales::default(); contacts];
    for k in 0..r.len() {
        let (own, unit) = (&mut parts[part[k / d]], unit(k / d));
        raise(&mut own.force, r[k].abs() * unit);
        raise(&mut own.velocity, u[k].abs() / unit);
        raise(&mut own.velocity, problem.q()[k].abs() / unit);
    }
    (0..contacts).map(|i| parts[part[i]].of_contact(unit(i))).collect()
}

/// Returns `W r + q`, in twice the working precision, because large forces may cancel almost completely.
fn velocities(problem: &LocalProblem, r: &[f64]) -> Vec<f64> {
    let mut sums = vec![DoubleDouble::default(); r.len()];
    problem.delassus().entries().for_each(|(row, column, w)| sums[row].add_product(w, r[column]));
    sums.iter_mut().zip(problem.q()).for_each(|(sum, q)| sum.add(*q));
    sums.into_iter().map(DoubleDouble::value).collect()
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
        assert_eq!(masses().errors(&FORCES, None).unwrap(), Errors::default());
        assert_eq!(masses().errors(&FORCES, Some(&[0.0, 2.0, 0.0, 0.0])).unwrap(), Errors::default());
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
            assert!(of(r, None).natural_map > 0.05 && !of(r, None).is_solved(), "{r:?}");
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
        assert_eq!(error.to_string(), "r: entry 0 is NaN, but must be finite");
        let error = masses().errors(&FORCES, Some(&[0.0; 3])).unwrap_err();
        assert_eq!(error.to_string(), "u: it has 3 entries, but must have 4");
        let nan = Errors { natural_map: f64::NAN, ..Errors::default() };
        assert!(!nan.within(1.0) && nan.worst().is_nan());
        // Sums that overflow are no solution.
        let entries = [(0, 0, 1e300), (1, 1, 1.0)];
        let huge =
            LocalProblem::new(2, Csc::from_triplets(2, 2, &entries).unwrap(), vec![-1.0, 0.0], vec![0.5]).unwrap();
        assert!(!huge.errors(&[1e300, 0.0], None).unwrap().is_solved());
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
