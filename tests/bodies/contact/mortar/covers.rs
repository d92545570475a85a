//! Rows where a side is covered in part, held, curved, given a direction, or turned around an axis.

use super::*;

/// Where only part of a slave facet is covered, down to next to nothing.
#[test]
fn thin_covers_leave_rows_sound() {
    for eps in [0.5, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-11] {
        for cells in kinds(2) {
            let at = 0.3 - 0.1 * eps;
            let mesh = joined(body([1.0, 0.5], [10, 4], [0.0, 0.0], cells), body([0.5, 0.5], [4, 3], [at, 0.5], cells));
            let pair = pair(&mesh, swapped(sides(&mesh)), 0.05);
            let sum: f64 = pair.rows.iter().map(|row| row.weight).sum();
            assert!((sum - 0.5).abs() < 1e-9, "{cells:?} {eps:e}: {sum}");
            for row in &pair.rows {
                let largest = row.master.iter().map(|(_, value)| value.abs()).fold(0.0, f64::max);
                assert!(largest < if is_quadratic(cells) { 9.0 } else { 2.1 }, "{cells:?} {eps:e}: {largest}");
                let off = place(&mesh, &row.slave)[0] - place(&mesh, &row.master)[0];
                assert!(off.abs() < 1e-9, "{cells:?} {eps:e}: {off:e} at {}", row.node);
            }
            // Thinner than a millionth there is no row for the far node.
            let left = pair.rows.iter().map(|row| mesh.nodes[row.node][0]).fold(f64::INFINITY, f64::min);
            if !is_quadratic(cells) {
                assert_eq!(left < 0.25, eps > 3e-3, "{eps:e}: {left}");
            }
        }
    }
}

fn first(mesh: &Mesh, name: &str) -> usize {
    mesh.boundary(name).unwrap().nodes()[0]
}

/// What supports hold along its normal has no row, and its function goes to its neighbours; on a plane of symmetry normals have no
/// part across it.
#[test]
fn supports_on_the_slave() {
    const X: [f64; 3] = [1.0, 0.0, 0.0];
    const Y: [f64; 3] = [0.0, 1.0, 0.0];
    const SLOPE: [[f64; 3]; 2] = [[0.8, 0.6, 0.0], [0.6, -0.8, 0.0]];
    let mesh = joined(curved([5, 2], [0.0, 1.0], -0.4, false), curved([4, 2], [0.0, 0.8], 0.0, true));
    let corner = first(&mesh, "upper:bottom");
    let opposite = mesh.boundary("lower:top").unwrap().nodes().into_iter().find(|&node| mesh.nodes[node][0] == 0.0);
    let hold_both = |directions: &'static [[f64; 3]], both: bool| {
        let held = move |node: usize| {
            let is_held = node == corner || both && Some(node) == opposite;
            let at_corner = if is_held { directions.to_vec() } else { Vec::new() };
            [at_corner, vec![axis(2)]].concat()
        };
        Mortar::new(&mesh, sides(&mesh)[0], sides(&mesh)[1], &within(2.0), &held).unwrap()
    };
    let hold = |directions: &'static [[f64; 3]]| hold_both(directions, false);
    let row = |pair: &Mortar, node: usize| pair.rows.iter().find(|row| row.node == node).cloned();
    let symmetric = row(&hold_both(&[X], true), corner).unwrap();
    assert_eq!((symmetric.normal, symmetric.still.contains(&X)), ([0.0, -1.0, 0.0], true));
    // Held alone, the other side moves past the node.
    let own = row(&hold(&[X]), corner).unwrap();
    assert!(own.normal == row(&hold(&[]), corner).unwrap().normal && !own.still.contains(&X));
    assert_ne!(row(&hold(&[]), corner).unwrap().normal, [0.0, -1.0, 0.0]);
    for pair in [hold(&[Y]), hold(&[X, Y])] {
        assert_eq!(row(&pair, corner), None);
        let next = row(&pair, corner + 1).unwrap();
        assert!(next.slave.len() == 2 && (total(&next.slave) - 1.0).abs() < 1e-15, "{next:?}");
        let (own, other) = (place(&mesh, &next.slave), place(&mesh, &next.master));
        assert!(own[0] > 0.1 && other[0] > 0.1);
        let all = |pair: &Mortar| pair.rows.iter().map(|row| row.weight).sum::<f64>();
        assert!((all(&pair) - all(&hold(&[]))).abs() < 1e-15);
    }
    // Oblique, across the normal: the part along it goes; along the normal: no row.
    assert!(row(&hold(&SLOPE[..1]), corner).is_some() && row(&hold(&SLOPE), corner).is_none());
}

#[test]
fn directions_that_are_given() {
    let mesh = joined(curved([5, 2], [0.0, 1.0], -0.4, false), curved([4, 2], [0.1, 0.8], 0.0, true));
    let towards = |direction| {
        Mortar::new(
            &mesh,
            sides(&mesh)[0],
            sides(&mesh)[1],
            &MortarOptions { search: Some(2.0), direction: Some(direction) },
            &free,
        )
    };
    let pair = towards([0.0, -2.0, 0.0]).unwrap();
    assert!(pair.rows.iter().all(|row| row.normal == [0.0, -1.0, 0.0]));
    assert!(matches!(towards([0.0, 1.0, 0.0]), Err(MortarFault::Inwards { .. })));
    assert!(matches!(towards([0.0; 3]), Err(MortarFault::Inwards { .. })));
}

/// Weights go all around: `Σ l = π (R² - r²)`, and with the moment `Σ l x = ∫ 2 π r² dr` of linear facets.
#[test]
fn weights_of_bodies_of_revolution() {
    for cells in kinds(2) {
        for inner in [0.0, 1.0] {
            let mut mesh =
                joined(body([1.0, 0.5], [3, 2], [inner, 0.0], cells), body([0.7, 0.5], [4, 2], [inner, 0.5], cells));
            mesh.geometry = Geometry::Axisymmetric;
            for sides in [sides(&mesh), swapped(sides(&mesh))] {
                let pair = pair(&mesh, sides, 0.1);
                let outer: f64 = inner + 0.7;
                let sum = |value: &dyn Fn(&MortarRow) -> f64| pair.rows.iter().map(value).sum::<f64>();
                let pi = std::f64::consts::PI;
                assert!((sum(&|row| row.weight) - pi * (outer.powi(2) - inner.powi(2))).abs() < 1e-13, "{cells:?}");
                let moment = sum(&|row| row.weight * place(&mesh, &row.master)[0]);
                assert!((moment - 2.0 / 3.0 * pi * (outer.powi(3) - inner.powi(3))).abs() < 1e-13, "{cells:?}");
            }
        }
    }
}

/// A slit: what both sides share is one node, and has no row.
#[test]
fn nodes_of_both_sides_have_no_row() {
    let mut mesh = joined(
        body([1.0, 0.5], [4, 2], [0.0, 0.0], Cells::Bricks),
        body([1.0, 0.5], [4, 2], [0.0, 0.5], Cells::Bricks),
    );
    let [slave, master] = sides(&mesh).map(|side| side.facets.clone());
    let tip =
        [&slave, &master].map(|facets| *facets.iter().flatten().find(|&&node| mesh.nodes[node][0] == 1.0).unwrap());
    mesh.boundaries.iter_mut().flat_map(|boundary| boundary.facets.iter_mut().flatten()).for_each(|node| {
        if *node == tip[0] {
            *node = tip[1];
        }
    });
    let pair = pair(&mesh, sides(&mesh), 0.1);
    assert!(pair.rows.len() == 4 && pair.rows.iter().all(|row| row.node != tip[1]));
    assert_eq!(pair.rows.iter().filter(|row| row.slave.len() == 2).count(), 1);
}
