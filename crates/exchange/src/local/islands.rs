//! Islands: groups of contacts that influence each other, directly or through others, which are separate problems.

use super::LocalProblem;
use stickslip::algebra::{Csc, UnionFind};

/// A group of contacts, as a problem.
pub(super) struct Island {
    /// The indices of its contacts in the whole problem.
    pub contacts: Vec<usize>,
    /// Their problem.
    pub problem: LocalProblem,
}

impl Island {
    /// Returns the values of `whole` at these contacts.
    pub(super) fn read(&self, whole: &[f64]) -> Vec<f64> {
        let d = self.problem.dimension();
        self.contacts.iter().flat_map(|&i| whole[d * i..d * (i + 1)].iter().copied()).collect()
    }

    /// Writes `own` to these contacts in `whole`.
    pub(super) fn write(&self, own: &[f64], whole: &mut [f64]) {
        let d = self.problem.dimension();
        for (own, &i) in own.chunks(d).zip(&self.contacts) {
            whole[d * i..d * (i + 1)].copy_from_slice(own);
        }
    }
}

/// Returns the islands of `problem`, each with its contacts in ascending order. Zero entries of `W` connect nothing.
pub(super) fn islands(problem: &LocalProblem) -> Vec<Island> {
    let (d, n) = (problem.dimension(), problem.contacts());
    let entries = || problem.delassus().entries().filter(|entry| entry.2 != 0.0);
    let mut sets = UnionFind::new(n);
    entries().for_each(|(row, column, _)| sets.join(row / d, column / d));
    // Islands in the order of their first contacts, and the index of each contact in its island.
    let (mut contacts, mut island_of) = (Vec::<Vec<usize>>::new(), vec![(0, 0); n]);
    for i in 0..n {
        let least = sets.least(i);
        let island = if least == i { contacts.len() } else { island_of[least].0 };
        if least == i {
            contacts.push(Vec::new());
        }
        island_of[i] = (island, contacts[island].len());
        contacts[island].push(i);
    }
    let mut parts = vec![Vec::new(); contacts.len()];
    for (row, column, w) in entries() {
        let (island, place) = island_of[row / d];
        parts[island].push((d * place + row % d, d * island_of[column / d].1 + column % d, w));
    }
    let of_island = |(contacts, entries): (Vec<usize>, Vec<(usize, usize, f64)>)| {
        let rows = d * contacts.len();
        let problem = LocalProblem {
            dimension: d,
            delassus: Csc::from_triplets(rows, rows, &entries).expect("entries of a sound matrix"),
            q: contacts.iter().flat_map(|&i| problem.q[d * i..d * (i + 1)].iter().copied()).collect(),
            mu: contacts.iter().map(|&i| problem.mu[i]).collect(),
        };
        Island { contacts, problem }
    };
    contacts.into_iter().zip(parts).map(of_island).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contacts_are_taken_apart_and_put_together() {
        // The second contact is influenced by the fourth, in one direction only. A zero entry connects the first
        // contact to nothing.
        let entries = [(0, 0, 1.0), (2, 2, 2.0), (4, 4, 3.0), (6, 6, 4.0), (3, 7, 0.5), (1, 5, 0.0), (5, 5, 6.0)];
        let q: Vec<f64> = (0..8).map(f64::from).collect();
        let delassus = Csc::from_triplets(8, 8, &entries).unwrap();
        let problem = LocalProblem::new(2, delassus, q.clone(), vec![0.1, 0.2, 0.3, 0.4]).unwrap();
        let islands = islands(&problem);
        let contacts: Vec<&[usize]> = islands.iter().map(|island| &island.contacts[..]).collect();
        assert_eq!(contacts, [&[0][..], &[1, 3], &[2]]);
        assert_eq!((islands[1].problem.q(), islands[1].problem.mu()), (&[2.0, 3.0, 6.0, 7.0][..], &[0.2, 0.4][..]));
        let own: Vec<_> = islands[1].problem.delassus().entries().collect();
        assert_eq!(own, [(0, 0, 2.0), (2, 2, 4.0), (1, 3, 0.5)]);
        let mut whole = vec![0.0; 8];
        for island in &islands {
            island.write(&island.read(&q), &mut whole);
        }
        assert_eq!(whole, q);
    }
}
