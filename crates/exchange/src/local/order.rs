//! An order of contacts that does not depend on their input order.
//!
//! Sweeps depend on the order of the contacts, and so does the rounding of every sum. Without sorting, the same problem
//! with permuted rows would take other iterations. Contacts are therefore sorted by their own data (friction, free
//! velocity, compliance), and equal ones by the data of their neighbours, as in the Weisfeiler–Leman refinement of
//! graphs. Numbers are compared to nine digits of the largest, so that rounding, which changes with units, has no
//! influence. Remaining ties are mirror images.

use super::LocalProblem;

/// The largest number of refinements. Each includes neighbours one step further away.
const ROUNDS: usize = 4;

/// Returns the contacts of `problem`, sorted.
pub(super) fn canonical(problem: &LocalProblem) -> Vec<usize> {
    let d = problem.dimension();
    let mut rows = vec![Vec::new(); problem.q().len()];
    problem.delassus().entries().for_each(|(row, column, w)| rows[row].push((column, w)));
    let (of_q, of_w) = (digits(problem.q().iter()), digits(problem.delassus().values().iter()));
    let of_mu = digits(problem.mu().iter());
    let row = |i: usize, k: usize| &rows[d * i + k];
    let own = |i: usize| {
        let mut key = vec![of_mu(problem.mu()[i])];
        key.extend(problem.q()[d * i..d * (i + 1)].iter().map(|q| of_q(*q)));
        key.extend((0..d).flat_map(|k| row(i, k)).filter(|(column, _)| column / d == i).map(|(_, w)| of_w(*w)));
        key
    };
    let mut rank = vec![0; problem.contacts()];
    let (mut order, mut classes) = sorted(&mut rank, own);
    for _ in 0..ROUNDS {
        if classes == problem.contacts() {
            break;
        }
        let before = rank.clone();
        let around = |i: usize| {
            let mut key: Vec<(usize, usize, i64)> = (0..d)
                .flat_map(|k| row(i, k).iter().map(move |&(column, w)| (k, column, w)))
                .map(|(k, column, w)| (before[column / d], d * k + column % d, of_w(w)))
                .collect();
            key.sort_unstable();
            (before[i], key)
        };
        let more = sorted(&mut rank, around);
        let settled = more.1 == classes;
        (order, classes) = more;
        if settled {
            break;
        }
    }
    order
}

/// The significant digits relative to the largest number.
const DIGITS: f64 = 1e9;

/// Rounds numbers to these digits, as integers.
fn digits<'a>(values: impl Iterator<Item = &'a f64> + Clone) -> impl Fn(f64) -> i64 {
    let largest = values.fold(0.0_f64, |m, value| m.max(value.abs()));
    move |x| if largest > 0.0 { (x / largest * DIGITS).round() as i64 } else { 0 }
}

/// Sorts contacts by their keys. Returns their order and the number of different keys; `rank` receives the rank of each
/// contact's key.
fn sorted<K: Ord>(rank: &mut [usize], key: impl Fn(usize) -> K) -> (Vec<usize>, usize) {
    let mut keyed: Vec<(K, usize)> = (0..rank.len()).map(|i| (key(i), i)).collect();
    keyed.sort_by(|a, b| a.0.cmp(&b.0));
    let mut classes = 0;
    for k in 0..keyed.len() {
        if k == 0 || keyed[k].0 != keyed[k - 1].0 {
            classes += 1;
        }
        rank[keyed[k].1] = classes;
    }
    (keyed.into_iter().map(|(_, i)| i).collect(), classes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::algebra::Csc;

    /// Returns a chain of contacts that differ only by their neighbours, where `order[k]` is the number of the contact
    /// at position `k`.
    fn chain(order: [usize; 5]) -> LocalProblem {
        let index = |i: usize| order.iter().position(|k| *k == i).unwrap();
        let mut entries = Vec::new();
        for i in 0..5 {
            entries.extend([(2 * index(i), 2 * index(i), 2.0), (2 * index(i) + 1, 2 * index(i) + 1, 1.0)]);
            if i < 4 {
                let coupling = if i == 0 { -0.5 } else { -0.25 };
                entries
                    .extend([(2 * index(i), 2 * index(i + 1), coupling), (2 * index(i + 1), 2 * index(i), coupling)]);
            }
        }
        let mut q = vec![0.0; 10];
        (0..5).for_each(|i| q[2 * index(i)] = -1.0);
        LocalProblem::new(2, Csc::from_triplets(10, 10, &entries).unwrap(), q, vec![0.5; 5]).unwrap()
    }

    #[test]
    fn the_order_is_that_of_the_contacts() {
        let sorted = |order: [usize; 5]| canonical(&chain(order)).into_iter().map(|k| order[k]).collect::<Vec<_>>();
        let one = sorted([0, 1, 2, 3, 4]);
        for other in [[4, 3, 2, 1, 0], [2, 0, 4, 1, 3], [1, 2, 3, 4, 0]] {
            assert_eq!(sorted(other), one);
        }
    }
}
