//! The contacts of one island scaled to numbers of order one, for all methods.
//!
//! With powers of two `d_i` for each contact and `v` for all, `r = v d r'` and `u = (v / d) u'` transform `u = W r + q`
//! into `u' = (d W d) r' + (d / v) q`, whose diagonal and largest free velocity are near one. The laws do not change,
//! because they hold for each contact and for any common factor of its forces or velocities. Powers of two cause no
//! rounding. A contact without friction has only its normal row.

use super::LocalProblem;
use super::law::{Block, LocalContact, Vector3};
use super::order::canonical;
use stickslip::algebra::Csr;

/// The problem `u' = W' r' + q'` of some contacts that influence no others.
pub(super) struct ScaledContacts {
    /// The contacts of the problem, in an order that does not depend on the input order.
    contacts: Vec<usize>,
    dimension: usize,
    /// The normal row of each contact, followed by the number of rows.
    first: Vec<usize>,
    /// The law of each contact.
    pub laws: Vec<LocalContact>,
    /// `W'`.
    pub delassus: Csr,
    /// The diagonal blocks of `W'`.
    pub diagonal: Vec<Block>,
    /// `q'`.
    pub q: Vec<f64>,
    /// `v d`, the force unit of each contact.
    force: Vec<f64>,
}

/// Returns the power of two next to `x`, or 1 if there is none.
fn power_of_two(x: f64) -> f64 {
    if x > 0.0 && x.is_finite() { x.log2().round().clamp(-1000.0, 1000.0).exp2() } else { 1.0 }
}

impl ScaledContacts {
    /// Scales all contacts of `problem`.
    pub(super) fn new(problem: &LocalProblem) -> Self {
        let d = problem.dimension();
        let contacts = canonical(problem);
        // The positions of each contact's directions in the new order. A contact without friction has no tangents.
        let (mut first, mut place, mut source) = (vec![0], vec![None; problem.q().len()], Vec::new());
        for &contact in &contacts {
            let size = if problem.mu()[contact] > 0.0 { d } else { 1 };
            for row in (d * contact..).take(size) {
                place[row] = Some(source.len());
                source.push(row);
            }
            first.push(source.len());
        }
        let mut normal = vec![0.0; problem.contacts()];
        for (row, column, w) in problem.delassus().entries() {
            if row == column && row % d == 0 {
                normal[row / d] = w;
            }
        }
        let unit = |row: &usize| 1.0 / power_of_two(normal[row / d].abs().sqrt());
        let units: Vec<f64> = source.iter().map(unit).collect();
        let mut rows = vec![Vec::new(); source.len()];
        let pattern = problem.delassus().pattern();
        for (to, &column) in source.iter().enumerate() {
            let starts = pattern.column_starts();
            for slot in starts[column] as usize..starts[column + 1] as usize {
                let row = pattern.row_indices()[slot] as usize;
                if let Some(row) = place[row] {
                    rows[row].push((to, units[row] * problem.delassus().values()[slot] * units[to]));
                }
            }
        }
        let q: Vec<f64> = source.iter().zip(&units).map(|(&row, unit)| unit * problem.q()[row]).collect();
        let velocity = power_of_two(q.iter().fold(0.0, |m, q| q.abs().max(m)));
        let mut scaled = ScaledContacts {
            dimension: d,
            laws: Vec::new(),
            diagonal: Vec::new(),
            q: q.into_iter().map(|q| q / velocity).collect(),
            force: first[..contacts.len()].iter().map(|&row| units[row] * velocity).collect(),
            delassus: Csr::from_distinct_rows(source.len(), rows).expect("columns are places of rows"),
            first,
            contacts,
        };
        for (k, &contact) in scaled.contacts.iter().enumerate() {
            let range = scaled.range(k);
            let mut block = [[0.0; 3]; 3];
            for row in range.clone() {
                for &(column, w) in scaled.delassus.row(row).iter().filter(|(column, _)| range.contains(column)) {
                    block[row - range.start][column - range.start] = w;
                }
            }
            scaled.laws.push(LocalContact::new(problem.mu()[contact], range.len() - 1, &block));
            scaled.diagonal.push(block);
        }
        scaled
    }

    /// Returns the number of rows.
    pub(super) fn rows(&self) -> usize {
        self.q.len()
    }

    /// Returns the rows of contact `k`.
    pub(super) fn range(&self, k: usize) -> std::ops::Range<usize> {
        self.first[k]..self.first[k + 1]
    }

    /// Returns the values of `x` at contact `k`.
    pub(super) fn at(&self, k: usize, x: &[f64]) -> Vector3 {
        let mut own = [0.0; 3];
        own.iter_mut().zip(&x[self.range(k)]).for_each(|(to, from)| *to = *from);
        own
    }

    /// Writes `own` to contact `k` of `x`.
    pub(super) fn put(&self, k: usize, own: Vector3, x: &mut [f64]) {
        x[self.range(k)].iter_mut().zip(own).for_each(|(to, from)| *to = from);
    }

    /// Returns the product of one row of `W'` with `r'`.
    pub(super) fn row_product(&self, row: usize, r: &[f64]) -> f64 {
        self.delassus.row(row).iter().map(|&(column, w)| w * r[column]).sum()
    }

    /// Returns `W' r'`.
    pub(super) fn product(&self, r: &[f64]) -> Vec<f64> {
        (0..self.rows()).map(|row| self.row_product(row, r)).collect()
    }

    /// Returns `u' = W' r' + q'`.
    pub(super) fn velocities(&self, r: &[f64]) -> Vec<f64> {
        let mut u = self.product(r);
        u.iter_mut().zip(&self.q).for_each(|(u, q)| *u += q);
        u
    }

    /// Returns the forces of the problem for `r'`; forces in missing directions are 0.
    pub(super) fn write(&self, r: &[f64]) -> Vec<f64> {
        let mut whole = vec![0.0; self.dimension * self.contacts.len()];
        for (k, &contact) in self.contacts.iter().enumerate() {
            for (c, row) in self.range(k).enumerate() {
                whole[self.dimension * contact + c] = self.force[k] * r[row];
            }
        }
        whole
    }

    /// Returns `r'` for forces of the problem.
    pub(super) fn read(&self, whole: &[f64]) -> Vec<f64> {
        let of_contact = |k: usize| {
            let start = self.dimension * self.contacts[k];
            (0..self.range(k).len()).map(move |c| whole[start + c] / self.force[k])
        };
        (0..self.contacts.len()).flat_map(of_contact).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::algebra::Csc;

    /// Returns three contacts, the second without friction, in large and small units.
    fn example() -> LocalProblem {
        let size = |row: usize| [3e4, 7e-6, 1e2][row / 2];
        let entry = |i: usize, j: usize| if i == j { 2.0 } else { 0.1 / (1.0 + (i + 2 * j) as f64) };
        let entries = (0..36).map(|k| (k / 6, k % 6, size(k / 6) * size(k % 6) * entry(k / 6, k % 6)));
        let delassus = Csc::from_triplets(6, 6, &entries.collect::<Vec<_>>()).unwrap();
        LocalProblem::new(2, delassus, vec![-3e7, 2.0, -1e-2, 5.0, -7e5, 1e5], vec![0.3, 0.0, 0.7]).unwrap()
    }

    #[test]
    fn numbers_are_of_order_one() {
        let scaled = ScaledContacts::new(&example());
        assert_eq!(scaled.rows(), 5);
        let largest = scaled.q.iter().fold(0.0_f64, |m, q| m.max(q.abs()));
        assert!((0.5..2.0).contains(&largest), "{largest}");
        assert!(scaled.diagonal.iter().all(|block| (0.5..=2.0).contains(&block[0][0])), "{:?}", scaled.diagonal);
    }

    #[test]
    fn there_and_back_is_exact() {
        let scaled = ScaledContacts::new(&example());
        let r = [0.3, -1.7, 2.5, 1e-7, 0.1];
        assert_eq!(scaled.read(&scaled.write(&r)), r);
    }

    /// `u' = (v / d) u` up to the order of sums. The tangent of the contact without friction is missing.
    #[test]
    fn velocities_are_those_of_the_problem() {
        let problem = example();
        let scaled = ScaledContacts::new(&problem);
        let r = [0.3, -0.1, 2.5, 0.7, 0.1];
        let whole = scaled.write(&r);
        let mut u = problem.delassus().times(&whole).unwrap();
        u.iter_mut().zip(problem.q()).for_each(|(u, q)| *u += q);
        let own = scaled.velocities(&r);
        for (k, &contact) in scaled.contacts.iter().enumerate() {
            for (c, row) in scaled.range(k).enumerate() {
                // r' u' is r u divided by the square of a common number.
                let unit = scaled.force[k] * u[2 * contact + c] / own[row];
                let first = scaled.force[0] * u[2 * scaled.contacts[0]] / own[0];
                assert!((unit / first - 1.0).abs() < 1e-13, "{unit} {first}");
            }
        }
    }

    #[test]
    fn units_do_not_overflow() {
        assert_eq!([0.0, f64::INFINITY, f64::NAN, -1.0].map(power_of_two), [1.0; 4]);
        assert_eq!([1.0, 3.0, 1e-3].map(power_of_two), [1.0, 4.0, 1.0 / 1024.0]);
    }
}
