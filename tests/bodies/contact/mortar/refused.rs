//! Pairs that are refused, each with its reason.

use super::*;

fn fault(
    mesh: &Mesh,
    [slave, master]: [&Boundary; 2],
    search: f64,
    held: impl Fn(usize) -> Vec<[f64; 3]>,
) -> MortarFault {
    Mortar::new(mesh, slave, master, &within(search), &held).unwrap_err()
}

#[test]
fn pairs_that_are_none() {
    let mesh = joined(
        body([1.0, 0.5], [3, 2], [0.0, 0.0], Cells::Bricks),
        body([0.5, 0.5], [2, 2], [0.25, 1.0], Cells::Bricks),
    );
    let said = fault(&mesh, sides(&mesh), 0.4, free);
    assert_eq!(
        said.to_string(),
        "nothing of `lower:top` is in front of `upper:bottom` within 0.4 m; the least distance is 0.5 m, at [0.25, 1.0]"
    );
    assert!(said.help().contains("longer"));
    // The default is a tenth of the smaller one.
    let [slave, master] = sides(&mesh);
    let default = Mortar::new(&mesh, slave, master, &MortarOptions::default(), &free).unwrap_err();
    assert!(matches!(default, MortarFault::NothingInFront { search, .. } if (search - 0.05).abs() < 1e-15));
    let away = ["upper:top", "lower:top"].map(|name| mesh.boundary(name).unwrap());
    assert!(fault(&mesh, away, 5.0, free).help().contains("face each other"));
    // Held all over, and held along the normal.
    assert!(matches!(
        fault(&mesh, sides(&mesh), 0.6, |_| vec![axis(0), axis(1), axis(2)]),
        MortarFault::SlaveHeld { .. }
    ));
    assert!(matches!(fault(&mesh, sides(&mesh), 0.6, |_| vec![axis(1)]), MortarFault::SlaveHeld { .. }));
}

/// Tops of two steps, one above the other, are two layers.
#[test]
fn two_layers_are_refused() {
    let lower = joined(
        body([1.0, 0.2], [3, 1], [0.0, 0.0], Cells::Bricks),
        body([1.0, 0.2], [2, 1], [0.0, 0.3], Cells::Bricks),
    );
    let mut mesh = joined(lower, body([0.5, 0.5], [2, 2], [0.25, 0.5], Cells::Bricks));
    let facets =
        ["lower:lower:top", "lower:upper:top"].map(|name| mesh.boundary(name).unwrap().facets.clone()).concat();
    mesh.boundaries.push(Boundary { name: "tops".into(), facets });
    let both = ["upper:bottom", "tops"].map(|name| mesh.boundary(name).unwrap());
    let said = fault(&mesh, both, 0.5, free);
    assert_eq!(
        said,
        MortarFault::TwoLayers { slave: "upper:bottom".into(), master: "tops".into(), at: Vector::from([0.375, 0.5]) }
    );
    assert!(said.help().contains("shorter"));
    pair(&mesh, both, 0.1);
}

#[test]
fn facets_that_cannot_be_clipped() {
    let mut mesh = joined(
        body([1.0, 1.0, 0.5], [2, 2, 1], [0.0; 3], Cells::Bricks),
        body([1.0, 1.0, 0.5], [2, 2, 1], [0.0, 0.0, 0.5], Cells::Bricks),
    );
    let middle = mesh.nodes.iter().position(|x| *x == [0.5, 0.5, 0.5]).unwrap();
    mesh.nodes[middle] = [0.9, 0.9, 0.5];
    assert!(
        matches!(fault(&mesh, sides(&mesh), 0.1, free), MortarFault::NotConvex { boundary, .. } if boundary == "lower:top")
    );
    mesh.nodes[middle] = [f64::NAN; 3];
    assert!(Mortar::new(&mesh, sides(&mesh)[0], sides(&mesh)[1], &within(0.1), &free).is_err());
}

/// Two faces of a body that lie on each other have opposite normals in their nodes.
#[test]
fn normals_that_cancel() {
    let mut mesh = body([1.0, 0.5], [2, 1], [0.0, 0.0], Cells::Bricks);
    let other = body([1.0, 0.5], [2, 1], [0.0, 0.5], Cells::Bricks);
    mesh = joined(mesh, other);
    let [slave, master] = sides(&mesh).map(Clone::clone);
    let back = slave.facets.iter().map(|facet| facet.iter().rev().copied().collect::<Vec<_>>());
    let both = Boundary { name: "both".into(), facets: slave.facets.iter().cloned().chain(back).collect() };
    assert!(
        matches!(fault(&mesh, [&both, &master], 0.1, free), MortarFault::NormalsCancel { boundary, .. } if boundary == "both")
    );
}

/// Nodes between corners are off by a seventh of an edge, or half of it: places between the chords have no local coordinates. What is in
/// front of them must not be left out, nor be given others, without a word.
#[test]
fn facets_that_are_bent_too_much() {
    let much = [[0.029, 0.142], [-0.043, 0.131], [0.101, -0.128]];
    let more = [[-0.135, 0.359], [0.153, 0.186], [-0.312, -0.219]];
    for moves in [much, more] {
        let mut mesh = joined(
            body([1.0, 1.0, 0.5], [1, 1, 1], [0.0; 3], Cells::SecondOrder),
            body([1.0, 1.0, 0.5], [1, 1, 1], [0.0, 0.0, 0.5], Cells::Bricks),
        );
        let facet = mesh.boundary("lower:top").unwrap().facets[0].clone();
        for (node, by) in [facet[1], facet[3], facet[5]].into_iter().zip(moves) {
            (0..2).for_each(|c| mesh.nodes[node][c] += by[c]);
        }
        for pair in [sides(&mesh), swapped(sides(&mesh))] {
            let found = Mortar::new(&mesh, pair[0], pair[1], &within(0.1), &free);
            let refused = matches!(&found, Err(MortarFault::TooBent { boundary, .. }) if boundary == "lower:top");
            assert!(refused, "{moves:?}: {:?}", found.map(|mortar| mortar.covered));
        }
        assert!(fault(&mesh, sides(&mesh), 0.1, free).help().contains("finer"));
    }
}
