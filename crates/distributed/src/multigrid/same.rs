//! Test that a distributed stiffness equals that of one process: here with one rank, which assembles all rows.

#[cfg(test)]
pub(super) mod tests {
    use crate::multigrid::exact::tests::{INVERSE, LAWS, Numbers, system};
    use crate::multigrid::*;
    use crate::stiffness::share;
    use stickslip::algebra::linear::{Distributed, Stiffness, backward_error};
    use stickslip::algebra::{DoubleDouble, NodeRows, Symmetric};

    /// A chain of nodes; each cell has two.
    #[derive(Debug)]
    struct Chain {
        grid: Grid,
        stiffness: Symmetric,
    }

    impl NodeRows for Chain {
        fn dimension(&self) -> usize {
            3
        }

        fn nodes(&self) -> usize {
            self.grid.nodes
        }

        fn order(&self) -> usize {
            self.grid.displacements.len()
        }

        fn places(&self, node: usize) -> [Option<usize>; 3] {
            [0, 1, 2].map(|c| self.grid.displacements.iter().position(|at| *at == (node, c)))
        }

        fn each_cell(&self, take: &mut dyn FnMut(&[usize])) {
            (1..self.nodes()).for_each(|node| take(&[node - 1, node]));
        }

        fn fingerprint(&self) -> u64 {
            7
        }

        fn rows(&self, nodes: &[bool]) -> Option<Symmetric> {
            let here = |dof: usize| nodes[self.grid.displacements[dof].0];
            let entries: Vec<_> = self.stiffness.lower().entries().filter(|(i, j, _)| here(*i) || here(*j)).collect();
            Symmetric::from_triplets(self.order(), &entries).ok()
        }
    }

    /// Creates `a` with its stiffness in one process, and with the stiffness shared, as `factor` times another.
    fn both(factor: f64) -> (Grid, [SystemMatrix; 2], Arc<dyn Distributed>) {
        let (grid, a) = system(&LAWS, false);
        let n_u = grid.displacements.len();
        let is_stiffness = |i: usize, j: usize| i < n_u && j < n_u;
        let lower = a.rest().entries().filter(|(i, j, _)| is_stiffness(*i, *j) && i >= j);
        let lower: Vec<_> = lower.map(|(i, j, value)| (i, j, value / factor)).collect();
        let stiffness = Symmetric::from_triplets(n_u, &lower).unwrap();
        let chain = Chain { grid: grid.clone(), stiffness: stiffness.clone() };
        // The last node is far from contact.
        let near: Vec<bool> = (0..grid.nodes).map(|node| node + 1 < grid.nodes).collect();
        let Some(Stiffness::Distributed(shared)) = share(Arc::new(chain), &near, LAWS.len()).unwrap() else {
            panic!("one rank has all rows")
        };
        let mut rest: Vec<_> = a.rest().entries().filter(|(i, j, _)| !is_stiffness(*i, *j)).collect();
        // A spring on one displacement.
        rest.extend((0..n_u).map(|i| (i, i, if i == 4 { 0.7 } else { 0.0 })));
        let n = a.order();
        let rest = Csc::from_triplets(n, n, &rest).unwrap();
        let mut whole: Vec<_> = rest.entries().collect();
        whole.extend(stiffness.entries().map(|(i, j, value)| (i, j, factor * value)));
        let whole = SystemMatrix::from(Csc::from_triplets(n, n, &whole).unwrap());
        let mut beside =
            SystemMatrix::of(&Stiffness::Distributed(Arc::clone(&shared)), factor, (**rest.pattern()).clone());
        beside.rest_mut().values_mut().copy_from_slice(rest.values());
        (grid, [whole, beside], shared)
    }

    fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
        let largest = expected.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() <= tolerance * largest, "{found} {expected}");
        }
    }

    #[test]
    fn products_and_entries_are_the_same() {
        let (_, [whole, shared], stiffness) = both(2.0);
        let (n, mut numbers) = (whole.order(), Numbers(3));
        let mut vector = || (0..n).map(|_| numbers.next()).collect::<Vec<f64>>();
        let (x, rest, b) = (vector(), vector(), vector());
        assert_close(&shared.times(&x).unwrap(), &whole.times(&x).unwrap(), 1e-15);
        let error = |a: &SystemMatrix| backward_error(a, &b, &x).unwrap();
        assert!((error(&shared) - error(&whole)).abs() <= 1e-14);
        let gathered = stiffness.gathered().unwrap();
        let n_u = gathered.order();
        let (mut y, mut sizes, mut sums) = (vec![0.0; n_u], vec![0.0; n_u], vec![DoubleDouble::default(); n_u]);
        stiffness.products(&x[..n_u], &mut y, &mut sizes).unwrap();
        stiffness.add_beyond(2.0, &x[..n_u], &rest[..n_u], &mut sums).unwrap();
        let (mut expected_sizes, mut expected_sums) = (vec![0.0; n_u], vec![0.0; n_u]);
        for (i, j, value) in gathered.entries() {
            expected_sizes[i] += (value * x[j]).abs();
            expected_sums[i] += 2.0 * value * (x[j] + rest[j]);
        }
        assert_close(&y, &gathered.times(&x[..n_u]).unwrap(), 1e-14);
        assert_close(&sizes, &expected_sizes, 1e-14);
        assert_close(&sums.into_iter().map(DoubleDouble::value).collect::<Vec<_>>(), &expected_sums, 1e-14);
        let compressed = SystemMatrix::from(shared.to_csc().unwrap().into_owned());
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            assert!((compressed.get(i, j) - whole.get(i, j)).abs() <= 1e-15, "{i} {j}");
        }
        assert!((0..n).all(|i| (shared.get(i, i) - whole.get(i, i)).abs() <= 1e-15));
        // Terms added to the block count separately.
        assert_eq!(stiffness.row_norms().len(), n_u);
        assert_close(stiffness.diagonal(), &gathered.diagonal(), 0.0);
    }

    #[test]
    fn it_is_solved_in_as_many_iterations() {
        for (interior, options) in
            [(false, INVERSE), (true, INVERSE), (false, Some("-pc_type lu -pc_factor_mat_solver_type mumps"))]
        {
            let (grid, matrices, _) = both(4.0);
            let grid = Grid { interior, ..grid };
            let mut numbers = Numbers(11);
            let b: Vec<f64> = (0..matrices[0].order()).map(|_| numbers.next()).collect();
            let solved = |a: &SystemMatrix| {
                let mut x = vec![0.0; b.len()];
                let mut solver = Multigrid::new(grid.clone(), options);
                solver.analyze_system(a).unwrap();
                solver.factorize_system(a).unwrap();
                solver.solve(&b, &mut x).unwrap();
                (x, solver.iterated())
            };
            let expected = solved(&matrices[0]);
            let compressed = SystemMatrix::from(matrices[1].to_csc().unwrap().into_owned());
            for other in [solved(&compressed), solved(&matrices[1])] {
                assert_close(&other.0, &expected.0, 1e-8);
                assert_eq!(other.1, expected.1);
            }
        }
    }

    #[test]
    fn what_is_shared_is_known() {
        let (_, _, stiffness) = both(1.0);
        // Ten couplings and the nodes themselves.
        assert_eq!((stiffness.order(), stiffness.entries()), (32, 9 * (2 * 10 + 11)));
        assert_eq!((stiffness.owner(0), stiffness.owner(11)), (Some(0), None));
        // All columns except those of the last node.
        assert_eq!(stiffness.near().entries().map(|(_, column, _)| column).max(), Some(29));
    }
}
