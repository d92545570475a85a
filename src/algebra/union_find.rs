//! Disjoint sets with union and find.

/// The numbers 0 to n - 1 in disjoint sets.
#[derive(Debug)]
pub struct UnionFind(Vec<usize>);

impl UnionFind {
    /// Creates `n` sets of one number each.
    pub fn new(n: usize) -> Self {
        UnionFind((0..n).collect())
    }

    /// Returns the smallest number of the set of `k`, which represents the set.
    pub fn least(&mut self, mut k: usize) -> usize {
        while self.0[k] != k {
            self.0[k] = self.0[self.0[k]];
            k = self.0[k];
        }
        k
    }

    /// Joins the sets of `i` and `j`.
    pub fn join(&mut self, i: usize, j: usize) {
        let (i, j) = (self.least(i), self.least(j));
        self.0[i.max(j)] = i.min(j);
    }
}

#[cfg(test)]
mod tests {
    use super::UnionFind;

    #[test]
    fn the_least_stands_for_a_set() {
        let mut sets = UnionFind::new(7);
        for (i, j) in [(5, 6), (3, 1), (6, 3), (1, 1), (4, 2)] {
            sets.join(i, j);
        }
        assert_eq!([0, 1, 2, 3, 4, 5, 6].map(|k| sets.least(k)), [0, 1, 2, 1, 2, 1, 1]);
    }
}
