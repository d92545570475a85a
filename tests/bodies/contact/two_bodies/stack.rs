//! A block on another with friction, pressed, pushed and pushed back.

use crate::common::pairs::{pushed, stack, states};
use crate::common::prelude::*;

/// The numbers of a text.
fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().map(|word| word.parse().unwrap()).collect()
}

/// Iterations, statuses after every fifth increment and the forces at the end, from left to right.
#[test]
fn a_finer_block_on_a_coarser_one() {
    let model = Model::build(&stack([8, 4], [11, 5], Side::Upper)).unwrap();
    let mut keep = Keep::default();
    let outcome = solved(&model, solver(Method::BN, LinearAlgebra::condensed()), &mut keep);
    let iterations: Vec<usize> = iterations(&outcome);
    let expected = [2, 1, 1, 1, 1, 2, 1, 1, 1, 4, 2, 1, 1, 1, 1, 1, 2, 1, 3, 3];
    // Those are from the last state. From the tangent there it takes fewer, but where the load turns round up to two more.
    assert!(iterations.iter().zip(expected).all(|(found, expected)| *found <= expected + 2), "{iterations:?}");
    assert!(iterations.iter().sum::<usize>() <= expected.iter().sum(), "{iterations:?}");
    let p_n = numbers(
        "805151.7220 1304763.7720 1164776.2691 1069746.4843 987537.1824 918519.9553 865443.9645 \
             804157.5978 729193.3768 640599.2858 518226.1180 191884.2721",
    );
    let p_t = numbers(
        "-161030.34441 -194227.30420 -232955.25380 -213949.29687 -197507.43647 -183703.99106 \
             -173088.79290 -160831.51957 -145838.67535 -128119.85717 -3526.23548 -5221.29273",
    );
    let mut order: Vec<usize> = (0..model.contact.nodes.len()).collect();
    order.sort_by(|a, b| model.contact.nodes[*a].position[0].total_cmp(&model.contact.nodes[*b].position[0]));
    for (k, i) in order.into_iter().enumerate() {
        let (n, t) = (outcome.state.p_n[i], outcome.state.p_t[i]);
        assert!((n / p_n[k] - 1.0).abs() < 1e-9 && (t / p_t[k] - 1.0).abs() < 1e-7, "{k}: {n} {t}");
    }
}

#[test]
fn the_coarser_side_as_the_slave() {
    let model = Model::build(&stack([8, 4], [11, 5], Side::Lower)).unwrap();
    let outcome = solved(&model, solver(Method::BN, LinearAlgebra::condensed()), &mut ());
    let mut p_n: Vec<(f64, f64)> =
        model.contact.nodes.iter().zip(&outcome.state.p_n).map(|(contact, p)| (contact.position[0], *p)).collect();
    p_n.sort_by(|a, b| a.0.total_cmp(&b.0));
    let expected = numbers(
        "1053722.6767 1727464.7745 1490806.1295 1351907.9913 1227197.2279 1110004.7537 984203.3680 \
             766378.5232 288314.5552",
    );
    for ((x, found), expected) in p_n.iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 1e-9, "{x}: {found}");
    }
}

/// A block on a larger one, which covers parts of facets at its ends.
fn narrow() -> Description {
    let lower = (MeshSource::block([1.0, 0.5], [12, 6]), 210e9);
    let upper = (MeshSource::block([0.6, 0.5], [7, 6]), 70e9);
    pushed(bodies(lower, upper, Some([0.23, 0.5].into()), equal_increments(20.0, 20)), Side::Upper)
}

/// What a history must come to: iterations, nodes that are open, stick and slip after every fifth increment, forces from left to right.
struct Expected {
    iterations: [usize; 20],
    statuses: [[usize; 3]; 4],
    p_n: Vec<f64>,
    p_t: Vec<f64>,
}

fn assert_history(description: &Description, expected: &Expected) {
    let model = Model::build(description).unwrap();
    for linear in [LinearAlgebra::condensed(), LinearAlgebra::Whole(SparseLu::default())] {
        let outcome = solved(&model, solver(Method::BN, linear), &mut ());
        let iterations: Vec<usize> = iterations(&outcome);
        assert!(iterations.iter().zip(expected.iterations).all(|(a, b)| a.abs_diff(b) <= 1), "{iterations:?}");
        let fifth = outcome.records.iter().skip(4).step_by(5).map(|record| &record.contact);
        let statuses: Vec<[usize; 3]> = fifth.map(|count| [count.open, count.stick, count.slip]).collect();
        assert_eq!(statuses, expected.statuses);
        let mut order: Vec<usize> = (0..model.contact.nodes.len()).collect();
        order.sort_by(|a, b| model.contact.nodes[*a].position[0].total_cmp(&model.contact.nodes[*b].position[0]));
        assert_eq!(order.len(), expected.p_n.len());
        for (k, i) in order.into_iter().enumerate() {
            let (n, t) = (outcome.state.p_n[i], outcome.state.p_t[i]);
            let largest = expected.p_n[k];
            assert!(
                (n - largest).abs() < 1e-9 * largest && (t - expected.p_t[k]).abs() < 1e-9 * largest,
                "{k}: {n} {t}"
            );
        }
    }
}

#[test]
fn a_narrow_block_on_a_wide_one() {
    let expected = Expected {
        iterations: [3, 1, 1, 1, 1, 2, 1, 2, 2, 2, 2, 2, 1, 1, 1, 2, 2, 1, 2, 2],
        statuses: [[0, 4, 4], [0, 3, 5], [0, 7, 1], [0, 3, 5]],
        p_n: numbers(
            "1041345.1704521239 1299571.1379285709 1015395.1852244978 855373.1673131896 719484.2873895401 \
             579679.9997839216 396875.52215183014 92275.52975627582",
        ),
        p_t: numbers(
            "-208269.03409042477 -259914.2275857142 -203079.03704489957 -166193.98240000542 \
             -81765.50157711063 -62948.00692024028 -79375.10443036603 -18455.10595125517",
        ),
    };
    assert_history(&narrow(), &expected);
}

/// On meshes that match each node of the one has a node of the other in front of it: the figures are those of rows from node to node.
#[test]
fn matching_meshes_are_node_to_node() {
    let expected = Expected {
        iterations: [2, 1, 1, 1, 1, 2, 1, 1, 1, 3, 2, 1, 1, 1, 1, 1, 2, 1, 2, 2],
        statuses: [[0, 7, 2], [0, 3, 6], [0, 9, 0], [0, 3, 6]],
        p_n: numbers(
            "1052323.4957945812 1723892.1217779757 1499890.6285459273 1347272.083659251 \
             1227273.6914424272 1113536.6730105346 974683.4730520322 779391.26072013 281736.5719971117",
        ),
        p_t: numbers(
            "-210464.69915891628 -280431.9355489124 -299978.1257091855 -269454.4167318502 \
             -245454.73828848547 -222707.33460210692 -194936.69461040644 -82275.51966401805 \
             5703.464313903363",
        ),
    };
    let matching = stack([8, 4], [8, 4], Side::Upper);
    let model = Model::build(&matching).unwrap();
    for contact in &model.contact.nodes {
        // A row of the relative displacement of the node, in whole numbers.
        let one = |row: &Vec<(usize, f64)>| row.len() == 1 && row[0].1.abs() == 1.0;
        assert!(one(&contact.normal) && one(&contact.tangents[0]), "{contact:?}");
    }
    assert_history(&matching, &expected);
}

/// Every linear algebra and every method come to the same.
#[test]
fn all_ways_agree() {
    let model = Model::build(&stack([8, 4], [11, 5], Side::Upper)).unwrap();
    let run = |method, linear| states(&model, (method, linear));
    let reference = run(Method::BN, LinearAlgebra::condensed());
    for (method, linear) in [
        (Method::BN, LinearAlgebra::Whole(SparseLu::default())),
        (Method::BN, LinearAlgebra::Whole(SparseLu::Faer)),
        (Method::BN, LinearAlgebra::Condensed(SparseCholesky::Faer)),
        (Method::Ip, LinearAlgebra::Whole(SparseLu::default())),
        (Method::Ip, LinearAlgebra::condensed()),
        (Method::Bn { r_factor: 1.0, rescue: false }, LinearAlgebra::condensed()),
    ] {
        let apart = difference(&reference, &run(method, linear));
        assert!(apart < 1e-8, "{method:?} {linear:?}: {apart:e}");
    }
}

/// Gaps that are only rounding of the coordinates are 0: a block that contact alone holds is found by the exact path, too.
#[test]
fn a_block_that_just_touches() {
    for cells in ["quadrilateral", "triangle6", "quadrilateral8"] {
        for height in [0.1, 0.3, 0.7] {
            let text = format!(
                "solver = {{ method = \"events\" }}\ntime = {{ end = 1.0, increments = 2 }}\n\
                 [[body]]\nname = \"low\"\nmaterial = {{ young = 1e9, poisson = 0.3 }}\n\
                 mesh = {{ kind = \"block\", cells = \"{cells}\", size = [1.0, {height}], elements = [7, 2] }}\n\
                 [[body]]\nname = \"high\"\nmaterial = {{ young = 1e9, poisson = 0.3 }}\n\
                 mesh = {{ kind = \"block\", cells = \"{cells}\", size = [1.0, 0.3], elements = [7, 2], \
                 origin = [0.3, {height}] }}\n\
                 [[support]]\nboundary = \"low:bottom\"\nfix = [\"x\", \"y\"]\n\
                 [[contact]]\nboundary = \"high:bottom\"\nagainst = \"low:top\"\nfriction = 0.3\n\
                 [[load]]\nboundary = \"high:top\"\ntraction = [0.0, -1e6]\n"
            );
            let scene = parsed(&text);
            let run = Run::new(&scene).unwrap();
            assert!(run.model().contact.nodes.iter().all(|contact| contact.facing.gap == 0.0), "{cells} {height}");
            let report = run.solve(&mut ()).unwrap();
            assert_eq!(report.status, Status::Converged, "{cells} {height}: {}", report.explanation.reason);
        }
    }
}
