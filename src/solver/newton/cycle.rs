//! Detection of cycles in an iteration.

use std::collections::HashSet;

/// The sets of cases that an increment has visited.
#[derive(Default)]
pub(super) struct Cycle {
    seen: HashSet<Vec<u8>>,
    visits: usize,
    /// The number of the visit that brought the last new set.
    last_new: usize,
}

impl Cycle {
    pub(super) fn visit(&mut self, cases: Vec<u8>) {
        self.visits += 1;
        if self.seen.insert(cases) {
            self.last_new = self.visits;
        }
    }

    /// Returns `true` if the second half of the visits brought no new set.
    pub(super) fn closed(&self) -> bool {
        2 * self.last_new <= self.visits
    }
}

#[cfg(test)]
mod tests {
    use super::Cycle;

    #[test]
    fn a_cycle_is_closed_when_half_of_the_visits_bring_nothing_new() {
        let closed = |visits: &[u8]| {
            let mut cycle = Cycle::default();
            for &case in visits {
                cycle.visit(vec![case]);
            }
            cycle.closed()
        };
        assert!(closed(&[1, 2, 1, 2]));
        assert!(closed(&[1, 2, 3, 2, 3, 2]));
        assert!(!closed(&[1, 2, 3, 2, 3]));
        assert!(!closed(&[1, 2, 3, 4]));
    }
}
