//! Test of exactness: with a direct factorisation in place of the cycle, one iteration solves the system.

#[cfg(test)]
pub(super) mod tests {
    use crate::multigrid::small::{on, transposed};
    use crate::multigrid::*;
    use stickslip::algebra::linear::GridContact;

    fn solved(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
        let n = b.len();
        for k in 0..n {
            let p = (k..n).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs())).unwrap();
            a.swap(k, p);
            b.swap(k, p);
            for i in k + 1..n {
                let factor = a[i][k] / a[k][k];
                if factor != 0.0 {
                    let pivot = a[k].clone();
                    a[i].iter_mut().zip(pivot).skip(k).for_each(|(v, p)| *v -= factor * p);
                    b[i] -= factor * b[k];
                }
            }
        }
        for k in (0..n).rev() {
            let known: f64 = (k + 1..n).map(|j| a[k][j] * b[j]).sum();
            b[k] = (b[k] - known) / a[k][k];
        }
        b
    }

    /// A generator of pseudo-random numbers between -1 and 1.
    pub(crate) struct Numbers(pub u64);

    impl Numbers {
        pub(crate) fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }
    }

    /// The kind of a contact node's rows.
    #[derive(Clone, Copy)]
    pub(crate) enum Law {
        Open,
        Stick,
        /// Slip with this friction, along the first tangent.
        Slip(f64),
        /// On the edge of the cone without slip: constrained across, unconstrained along.
        Edge(f64),
        /// Forces proportional to the displacements, as during an interior point method.
        Compliant(f64),
    }

    /// Creates a chain of nodes in space, each coupled to the next, with a different frame at each contact; the last
    /// node has no y.
    pub(crate) fn system(laws: &[Law], changed: bool) -> (Grid, SystemMatrix) {
        let (m, mut numbers) = (laws.len() + 3, Numbers(5));
        let n_u = 3 * m - 1;
        let mut entries: Vec<(usize, usize, f64)> = Vec::new();
        // Springs between neighbours, in three directions each, and to the ground.
        for node in 0..m {
            for _ in 0..3 {
                let direction = [0, 1, 2].map(|_| numbers.next());
                let place = |node: usize, c: usize| {
                    Some(3 * node + c).filter(|dof| *dof != 3 * m - 2).map(|dof| dof.min(n_u - 1))
                };
                let ends: Vec<(usize, f64)> = (0..6)
                    .filter_map(|k| {
                        let (other, c) = (node + k / 3, k % 3);
                        let sign = if k < 3 { 1.0 } else { -1.0 };
                        (other < m).then(|| place(other, c)).flatten().map(|dof| (dof, sign * direction[c]))
                    })
                    .collect();
                for &(i, a) in &ends {
                    entries.extend(ends.iter().map(|&(j, b)| (i, j, a * b)));
                }
            }
        }
        entries.extend((0..n_u).map(|i| (i, i, 0.3)));
        let mut contacts = Vec::new();
        for (i, law) in laws.iter().enumerate() {
            let node = i + 1;
            let places = [0, 1, 2].map(|k| n_u + 3 * i + k);
            contacts.push(GridContact { node, forces: places.map(Some) });
            // Two tangents and a normal.
            let (c, s) = (0.3_f64.cos(), 0.3_f64.sin());
            let frame = [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]];
            let beyond = changed.then_some((0, 0.25));
            let mut row = |row: usize, w: [f64; 3], p: [f64; 3]| {
                for (axis, coefficient) in on(&transposed(&frame), w).into_iter().enumerate() {
                    entries.push((row, 3 * node + axis, coefficient));
                    if let (Some((dof, share)), 0) = (beyond, axis) {
                        entries.push((row, dof, share * coefficient));
                    }
                }
                (0..3).for_each(|k| entries.push((row, places[k], p[k])));
            };
            let [t, o, n] = places;
            match *law {
                Law::Open => {
                    (0..3).for_each(|k| row(places[k], [0.0; 3], [0, 1, 2].map(|j| f64::from(u8::from(j == k)))));
                }
                Law::Stick => {
                    (0..3).for_each(|k| row(places[k], [0, 1, 2].map(|j| f64::from(u8::from(j == k))), [0.0; 3]));
                }
                Law::Slip(mu) => {
                    row(t, [0.0; 3], [1.0, 0.0, -mu]);
                    row(o, [0.0, 0.2, 0.0], [0.0, 1.0, 0.0]);
                    row(n, [0.0, 0.0, 1.0], [0.0; 3]);
                }
                Law::Edge(mu) => {
                    row(t, [0.0; 3], [1.0, 0.0, -mu]);
                    row(o, [0.0, 1.0, 0.0], [0.0; 3]);
                    row(n, [0.0, 0.0, 1.0], [0.0; 3]);
                }
                Law::Compliant(k) => {
                    row(t, [-k, 0.0, 0.0], [1.0, 0.1, -0.3]);
                    row(o, [0.1, -k, 0.0], [0.0, 1.0, 0.2]);
                    row(n, [0.0, 0.0, -2.0 * k], [0.0, 0.0, 1.0]);
                }
            }
            for (place, direction) in places.into_iter().zip(frame) {
                for (axis, component) in direction.into_iter().enumerate() {
                    entries.push((3 * node + axis, place, component));
                    if let (Some((dof, share)), 0) = (beyond, axis) {
                        entries.push((dof, place, share * component));
                    }
                }
            }
        }
        let displacements =
            (0..m).flat_map(|node| (0..3).map(move |c| (node, c))).filter(|at| *at != (m - 1, 1)).collect();
        let changes =
            if changed { (0..laws.len()).map(|i| (3 * (i + 1), vec![(0, -0.25)])).collect() } else { Vec::new() };
        let motions = (0..3).map(|c| (0..n_u).map(|dof| f64::from(u8::from(dof % 3 == c))).collect()).collect();
        let n = n_u + 3 * laws.len();
        let grid = Grid { interior: false, dimension: 3, nodes: m, displacements, contacts, changed: changes, motions };
        (grid, SystemMatrix::from(Csc::from_triplets(n, n, &entries).unwrap()))
    }

    pub(crate) const LAWS: [Law; 8] = [
        Law::Open,
        Law::Stick,
        Law::Slip(0.0),
        Law::Slip(0.7),
        Law::Edge(0.4),
        Law::Compliant(0.5),
        Law::Stick,
        Law::Slip(1.6),
    ];

    /// A factorisation in place of the cycle.
    pub(crate) const INVERSE: Option<&str> = Some("-contact_pc_type lu");

    fn iterations(laws: &[Law], changed: bool, interior: bool) -> usize {
        let (grid, a) = system(laws, changed);
        let n = a.order();
        let mut solver = Multigrid::new(Grid { interior, ..grid }, INVERSE);
        solver.analyze_system(&a).unwrap();
        solver.factorize_system(&a).unwrap();
        let mut numbers = Numbers(11);
        let b: Vec<f64> = (0..n).map(|_| numbers.next()).collect();
        let mut x = vec![0.0; n];
        solver.solve(&b, &mut x).unwrap();
        let dense = (0..n).map(|i| (0..n).map(|j| a.get(i, j)).collect()).collect();
        let expected = solved(dense, b);
        let largest = expected.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for (found, expected) in x.iter().zip(&expected) {
            assert!((found - expected).abs() <= 1e-8 * largest, "{found} {expected}");
        }
        let Iterated { iterations, instead } = solver.iterated();
        assert!(instead.is_none());
        iterations
    }

    #[test]
    fn one_iteration_with_an_inverse_and_friction_in_it() {
        assert_eq!(iterations(&LAWS, false, true), 1);
    }

    #[test]
    fn one_iteration_where_rows_hold_what_is_not_of_their_node() {
        assert_eq!(iterations(&LAWS, true, true), 1);
    }

    #[test]
    fn without_friction_the_symmetric_form_is_exact_too() {
        let laws = [Law::Open, Law::Stick, Law::Slip(0.0), Law::Edge(0.0), Law::Stick];
        assert_eq!(iterations(&laws, false, false), 1);
        let found = iterations(&LAWS, false, false);
        assert!((2..=20).contains(&found), "{found}");
    }
}
