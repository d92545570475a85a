//! Rows of pairs: what is exact of them, for every kind of facet, and what is refused.

mod covers;
mod prototype;
mod refused;

use crate::common::prelude::*;
use std::collections::BTreeMap;

use stickslip::algebra::axis;
use stickslip::body::fem::{area, bernstein, facet_weights};
use stickslip::body::{Mortar, MortarFault, MortarOptions, MortarRow};

/// What the two blocks of a pair are made of.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Cells {
    Bricks,
    Simplices,
    SecondOrder,
    Prisms,
    SecondOrderBricks,
}

fn is_quadratic(cells: Cells) -> bool {
    matches!(cells, Cells::SecondOrder | Cells::SecondOrderBricks)
}

/// The kinds of cells there are in a dimension.
fn kinds(dimension: usize) -> Vec<Cells> {
    let all = vec![Cells::Bricks, Cells::Simplices, Cells::SecondOrder, Cells::SecondOrderBricks, Cells::Prisms];
    if dimension == 2 { all[..4].to_vec() } else { all }
}

/// A block with its lowest corner at `at`.
fn body<const D: usize>(size: [f64; D], elements: [usize; D], at: [f64; D], cells: Cells) -> Mesh {
    shaped(size, elements, cells, |x| [0, 1, 2].map(|c| x[c] + at.get(c).unwrap_or(&0.0)))
}

/// A block whose nodes have moved before it is divided, so that edges are straight.
fn shaped<const D: usize>(
    size: [f64; D],
    elements: [usize; D],
    cells: Cells,
    moved: impl Fn([f64; 3]) -> [f64; 3],
) -> Mesh {
    let mut mesh = block(&size, &elements);
    mesh.nodes.iter_mut().for_each(|x| *x = moved(*x));
    match cells {
        Cells::Bricks => mesh,
        Cells::Simplices => mesh.into_simplices(),
        Cells::SecondOrder => mesh.into_simplices().into_second_order(),
        Cells::Prisms => mesh.into_prisms(),
        Cells::SecondOrderBricks => mesh.into_second_order(),
    }
}

/// Both in one mesh, with the boundaries `lower:top`, `upper:bottom` and so on.
fn joined(lower: Mesh, upper: Mesh) -> Mesh {
    let first = lower.nodes.len();
    let mut mesh = lower;
    mesh.boundaries.iter_mut().for_each(|boundary| boundary.name = format!("lower:{}", boundary.name));
    mesh.nodes.extend(upper.nodes);
    let moved = |nodes: &[usize]| nodes.iter().map(|node| node + first).collect::<Vec<usize>>();
    mesh.cells.extend(upper.cells.into_iter().map(|mut cell| {
        cell.nodes = moved(&cell.nodes);
        cell
    }));
    mesh.boundaries.extend(upper.boundaries.into_iter().map(|boundary| Boundary {
        name: format!("upper:{}", boundary.name),
        facets: boundary.facets.iter().map(|facet| moved(facet)).collect(),
    }));
    mesh
}

/// The upper block's bottom and the lower one's top.
fn sides(mesh: &Mesh) -> [&Boundary; 2] {
    ["upper:bottom", "lower:top"].map(|name| mesh.boundary(name).unwrap())
}

fn free(_: usize) -> Vec<[f64; 3]> {
    Vec::new()
}

fn within(search: f64) -> MortarOptions {
    MortarOptions { search: Some(search), ..MortarOptions::default() }
}

fn pair(mesh: &Mesh, [slave, master]: [&Boundary; 2], search: f64) -> Mortar {
    Mortar::new(mesh, slave, master, &within(search), &free).unwrap()
}

fn swapped([a, b]: [&Boundary; 2]) -> [&Boundary; 2] {
    [b, a]
}

/// Moves what is at the height `at` along the interface, by up to `share` of an element, and the rim along itself.
fn distorted(x: [f64; 3], up: usize, at: f64, size: [f64; 2], elements: [usize; 2], share: f64) -> [f64; 3] {
    let bump = |c: usize| 4.0 * x[c] / size[c] * (1.0 - x[c] / size[c]);
    let by = |c: usize| share * size[c] / elements[c] as f64 * bump(c) * (7.0 * x[0] + 3.0 * x[1] + c as f64).sin();
    let at_it = (x[up] - at).abs() < 1e-9;
    [0, 1, 2].map(|c| if at_it && c < up { x[c] + by(c) } else { x[c] })
}

/// Both sides in all kinds, the upper block as large as the lower one, or smaller and on part of it, with nodes moved along the
/// interface by a `share` of an element.
fn flat_pairs(share: f64, each: impl Fn(&Mesh, &str)) {
    let pairs = |dimension| {
        let kinds = kinds(dimension);
        kinds.clone().into_iter().flat_map(move |a| kinds.clone().into_iter().map(move |b| (a, b)))
    };
    for (a, b) in pairs(2) {
        for (n, m, size, at) in [(3, 5, 1.0, 0.0), (1, 13, 1.0, 0.0), (10, 3, 0.53, 0.211)] {
            let lower = shaped([1.0, 0.5], [n, 2], a, |x| distorted(x, 1, 0.5, [1.0; 2], [n; 2], share));
            let upper = shaped([size, 0.5], [m, 2], b, |x| {
                let [x, y, z] = distorted(x, 1, 0.0, [size; 2], [m; 2], share);
                [x + at, y + 0.5, z]
            });
            each(&joined(lower, upper), &format!("{a:?} {b:?} {n}:{m}"));
        }
    }
    for (a, b) in pairs(3) {
        for (n, m, size, at) in [([2, 3], [3, 2], [1.0, 1.0], [0.0, 0.0]), ([3, 4], [2, 2], [0.6, 0.53], [0.211, 0.3])]
        {
            let lower = shaped([1.0, 1.0, 0.5], [n[0], n[1], 1], a, |x| distorted(x, 2, 0.5, [1.0; 2], n, share));
            let upper = shaped([size[0], size[1], 0.5], [m[0], m[1], 1], b, |x| {
                let [x, y, z] = distorted(x, 2, 0.0, size, m, share);
                [x + at[0], y + at[1], z + 0.5]
            });
            each(&joined(lower, upper), &format!("{a:?} {b:?} {n:?}:{m:?}"));
        }
    }
}

/// `Σ c x` of a part of a row.
fn place(mesh: &Mesh, terms: &[(usize, f64)]) -> [f64; 3] {
    [0, 1, 2].map(|c| terms.iter().map(|(node, value)| value * mesh.nodes[*node][c]).sum())
}

fn total(terms: &[(usize, f64)]) -> f64 {
    terms.iter().map(|(_, value)| value).sum()
}

/// What makes patch tests exact: translations and linear fields pass, and a uniform pressure is put on the master as its own
/// facets would have it, as far as `pressures`.
fn is_exact(mesh: &Mesh, [slave, master]: [&Boundary; 2], name: &str, pressures: f64) {
    // The mass matrix of a face of eight nodes is the worst conditioned.
    let tolerance = if [slave, master].iter().any(|side| side.facets[0].len() == 8) { 1e-12 } else { 1e-13 };
    let pair = pair(mesh, [slave, master], 0.1);
    let (mut largest, up) = (0.0_f64, mesh.dimension - 1);
    for row in &pair.rows {
        let scale = row.slave.iter().chain(&row.master).map(|(_, value)| value.abs()).sum::<f64>();
        assert!((total(&row.slave) - 1.0).abs() < 1e-14 * scale && (total(&row.master) - 1.0).abs() < 1e-14 * scale);
        let (own, other) = (place(mesh, &row.slave), place(mesh, &row.master));
        largest = (0..3).map(|c| (own[c] - other[c]).abs() / scale).fold(largest, f64::max);
        assert!(row.gap.abs() < 1e-15 * scale, "{name}: {:e}", row.gap);
        let normal = if slave.name.starts_with("upper") { axis(up).map(|c| -c) } else { axis(up) };
        assert_eq!(row.normal, normal.map(|c| c + 0.0), "{name}");
    }
    assert!(largest < tolerance, "{name}: linear fields to {largest:e}");
    let (all, smaller) =
        (pair.rows.iter().map(|row| row.weight).sum::<f64>(), area(mesh, slave).min(area(mesh, master)));
    assert!((all / smaller - 1.0).abs() < tolerance, "{name}: {all} of {smaller}");
    let pressure = vec![1.0; pair.rows.len()];
    let forces: Vec<[f64; 3]> =
        pair.rows.iter().zip(&pressure).map(|(row, p)| row.normal.map(|n| -p * row.weight * n)).collect();
    for (node, traction) in pair.on_master(mesh, &forces) {
        let off = (traction[up].abs() - 1.0).abs();
        assert!(off < pressures, "{name}: traction {traction:?} on {node}");
    }
    // Where the master is covered whole its weights are those of its facets.
    if area(mesh, master) <= smaller * (1.0 + 1e-9) {
        let mut whole = BTreeMap::<usize, f64>::new();
        for facet in &master.facets {
            for (&node, weight) in facet.iter().zip(bernstein(mesh, facet, &facet_weights(mesh, facet))) {
                *whole.entry(node).or_default() += weight;
            }
        }
        for (node, weight) in &pair.master_weights {
            assert!((weight / whole[node] - 1.0).abs() < pressures, "{name}: {weight} of {}", whole[node]);
        }
    }
}

#[test]
fn linear_fields_and_pressures_pass_flat_interfaces() {
    flat_pairs(0.0, |mesh, name| {
        is_exact(mesh, sides(mesh), name, 1e-12);
        is_exact(mesh, swapped(sides(mesh)), name, 1e-12);
    });
}

/// On quadrilaterals that are no parallelograms integrals are not exact, but linear fields are.
#[test]
fn and_distorted_ones() {
    flat_pairs(0.2, |mesh, name| {
        let pressures = if mesh.dimension == 3 && name.contains("Bricks") { 1e-8 } else { 1e-12 };
        is_exact(mesh, sides(mesh), name, pressures);
        is_exact(mesh, swapped(sides(mesh)), name, pressures);
    });
}

/// Between meshes that match rows are those from node to node, to the last bit: flat and curved, with a gap and without.
#[test]
fn matching_meshes_are_joined_node_to_node() {
    let meshes = |cells: Cells| {
        let plane = || [body([1.0, 0.5], [7, 2], [0.0, 0.0], cells), body([1.0, 0.5], [7, 3], [0.0, 0.5], cells)];
        let space = || {
            [
                body([1.0, 0.7, 0.5], [3, 4, 1], [0.0; 3], cells),
                body([1.0, 0.7, 0.5], [3, 4, 2], [0.0, 0.0, 0.5], cells),
            ]
        };
        if cells == Cells::Prisms { vec![space()] } else { vec![plane(), space()] }
    };
    for (cells, share, bent, gap) in kinds(3).into_iter().flat_map(|cells| {
        [(0.0, 0.0, 0.0), (0.2, 0.0, 0.125), (0.0, 0.3, 0.0), (0.2, 0.3, 0.0)].map(|(s, b, g)| (cells, s, b, g))
    }) {
        for [mut lower, mut upper] in meshes(cells) {
            let up = lower.dimension - 1;
            // After the blocks are divided: edges of second order are bent.
            for mesh in [&mut lower, &mut upper] {
                for x in &mut mesh.nodes {
                    *x = distorted(*x, up, 0.5, [1.0, 0.7], [7, 4], share);
                    x[up] += bent * x[0] * (x[0] + if up == 2 { x[1] } else { 0.0 });
                }
            }
            upper.nodes.iter_mut().for_each(|x| x[up] += gap);
            let mesh = joined(lower, upper);
            for sides in [sides(&mesh), swapped(sides(&mesh))] {
                let name = format!("{cells:?} {share} {bent} {gap} {}", sides[0].name);
                let pair = pair(&mesh, sides, 0.2);
                assert_eq!(pair.rows.len(), sides[0].nodes().len(), "{name}");
                for row in &pair.rows {
                    let twin = |node: usize| {
                        let same = |other: &usize| {
                            (0..3).all(|c| {
                                (mesh.nodes[*other][c] - mesh.nodes[node][c]).abs() < if c == up { 0.2 } else { 1e-12 }
                            })
                        };
                        sides[1].facets.iter().flatten().copied().find(same).unwrap()
                    };
                    let mut expected: Vec<(usize, f64)> = row.slave.iter().map(|(node, c)| (twin(*node), *c)).collect();
                    expected.sort_by_key(|(node, _)| *node);
                    assert_eq!(row.master, expected, "{name}");
                    assert_eq!(row.slave.len(), if row.slave.iter().any(|(_, c)| *c >= 2.0) { 3 } else { 1 });
                    assert!(row.slave.len() == 3 || row.slave == [(row.node, 1.0)]);
                    // Coefficients of faces of eight nodes are larger, and so is the rounding of what they add up.
                    let rounding = if cells == Cells::SecondOrderBricks { 1e-15 } else { 0.0 };
                    assert!((row.gap - gap).abs() <= rounding, "{name}: {} {gap}", row.gap);
                }
            }
        }
    }
}

/// A block of `elements` whose face towards the other, at y = 0, is bent.
fn curved(elements: [usize; 2], x: [f64; 2], at: f64, up: bool) -> Mesh {
    let mut mesh = block(&[1.0, 0.4], &elements);
    for node in &mut mesh.nodes {
        let along = x[0] + (x[1] - x[0]) * node[0];
        let share = if up { 1.0 - node[1] / 0.4 } else { node[1] / 0.4 };
        let bend = if up { 0.5 } else { -0.25 };
        *node = [along, at + node[1] + bend * along * along * share, 0.0];
    }
    mesh
}

fn agrees(found: &[MortarRow], expected: &str, all: bool, name: &str) {
    let expected = prototype::rows(expected);
    assert!(!all || found.len() == expected.len(), "{name}: {} rows", found.len());
    let near = |a: f64, b: f64, scale: f64| (a - b).abs() < 1e-13 * scale;
    for (node, weight, gap, normal, master) in expected {
        let row = found.iter().find(|row| row.node == node).unwrap();
        assert!(
            near(row.weight, weight, weight) && near(row.gap, gap, 1.0),
            "{name} {node}: {} {}",
            row.weight,
            row.gap
        );
        assert!((0..3).all(|c| near(row.normal[c], normal[c], 1.0)), "{name} {node}: {:?}", row.normal);
        assert_eq!(row.master.len(), master.len(), "{name} {node}");
        for (found, expected) in row.master.iter().zip(&master) {
            assert!(found.0 == expected.0 && near(found.1, expected.1, 10.0), "{name} {node}: {found:?} {expected:?}");
        }
    }
}

/// Curved, partly covered, not matching, with a node that is held; bricks and tetrahedra on bricks.
#[test]
fn rows_are_those_of_the_prototype() {
    let mesh = joined(curved([5, 2], [0.0, 1.0], -0.4, false), curved([4, 2], [0.13, 0.83], 0.02, true));
    agrees(&pair(&mesh, sides(&mesh), 2.0).rows, "curved upper", true, "upper");
    agrees(&pair(&mesh, swapped(sides(&mesh)), 2.0).rows, "curved lower", true, "lower");
    let held = |node: usize| if node == 18 { vec![axis(0), axis(1)] } else { Vec::new() };
    let held = Mortar::new(&mesh, sides(&mesh)[0], sides(&mesh)[1], &within(2.0), &held).unwrap();
    agrees(&held.rows, "curved held", true, "held");
    for (cells, upper, lower) in
        [(Cells::Bricks, "bricks upper", "bricks lower"), (Cells::Simplices, "tetrahedra upper", "tetrahedra lower")]
    {
        let mesh = joined(
            body([1.0, 1.0, 0.5], [3, 2, 1], [0.0; 3], Cells::Bricks),
            body([0.9, 0.7, 0.49], [2, 2, 1], [0.2, 0.1, 0.51], cells),
        );
        agrees(&pair(&mesh, sides(&mesh), 0.2).rows, upper, false, "upper");
        agrees(&pair(&mesh, swapped(sides(&mesh)), 0.2).rows, lower, false, "lower");
    }
}

#[test]
fn the_better_slave() {
    let mesh = |n: usize, m: usize| {
        joined(body([1.0, 0.5], [n, 2], [0.0, 0.0], Cells::Bricks), body([1.0, 0.5], [m, 2], [0.0, 0.5], Cells::Bricks))
    };
    let choice = |mesh: &Mesh, young: [f64; 2], held: &dyn Fn(usize) -> Vec<[f64; 3]>| {
        let (pair, choice) =
            Mortar::of_better_slave(mesh, sides(mesh), young, [false; 2], &within(0.1), &held).unwrap();
        assert_eq!(pair.rows.len(), choice.rows[choice.slave]);
        (choice.slave, choice.rows, choice.reason)
    };
    assert_eq!(choice(&mesh(4, 8), [2.0, 1.0], &free), (0, [9, 5], SlaveReason::MoreNodes));
    assert_eq!(choice(&mesh(8, 4), [1.0, 2.0], &free), (1, [5, 9], SlaveReason::MoreNodes));
    assert_eq!(choice(&mesh(20, 21), [2.0, 1.0], &free), (1, [22, 21], SlaveReason::Softer));
    assert_eq!(choice(&mesh(20, 21), [1.0, 1.0], &free), (0, [22, 21], SlaveReason::Alike));
    let coarse = mesh(4, 8);
    let tool = coarse.nodes.len() - 27;
    let held = |node: usize| if node >= tool { vec![axis(0), axis(1), axis(2)] } else { Vec::new() };
    assert_eq!(choice(&coarse, [1.0, 1.0], &held), (1, [0, 5], SlaveReason::OtherHeld));
    let all = |_: usize| vec![axis(0), axis(1), axis(2)];
    let refused = Mortar::of_better_slave(&coarse, sides(&coarse), [1.0; 2], [false; 2], &within(0.1), &all);
    assert!(matches!(refused, Err(MortarFault::SlaveHeld { .. })));
}

/// Gaps as they are, and when the upper block has turned by moving its nodes.
#[test]
fn gaps_at_points() {
    let mesh = joined(
        body([1.0, 0.5], [3, 2], [0.0, 0.0], Cells::Bricks),
        body([1.0, 0.5], [4, 2], [0.0, 0.75], Cells::Bricks),
    );
    let pair = pair(&mesh, sides(&mesh), 0.5);
    assert!(pair.gaps.iter().all(|gap| gap.gap == 0.25) && pair.rows.iter().all(|row| row.gap == 0.25));
    assert_eq!(pair.segments(), 6);
    let first = mesh.nodes.len() - 15;
    let u: Vec<[f64; 3]> = mesh
        .nodes
        .iter()
        .enumerate()
        .map(|(node, x)| [0.0, if node >= first { -0.5 * x[0] } else { 0.0 }, 0.0])
        .collect();
    let least = pair.least_gap(&mesh, &u).unwrap();
    // The last of three Gauss points of the last segment, which goes from 0.75 to 1.
    let x = 0.875 + 0.125 * 0.6_f64.sqrt();
    assert!((least.at[0] - x).abs() < 1e-15 && (least.gap - (0.25 - 0.5 * x)).abs() < 1e-15, "{least:?}");
}

/// How long 10^5 facets a side take: `cargo test --release --test bodies -- --ignored mortar::speed --nocapture`.
#[test]
#[ignore = "a measurement"]
#[allow(clippy::print_stdout)]
fn speed() {
    for (cells, n) in [(Cells::Bricks, 316), (Cells::Simplices, 224), (Cells::SecondOrder, 112)] {
        let mesh = joined(
            body([1.0, 1.0, 0.01], [n, n, 1], [0.0; 3], cells),
            body([1.0, 1.0, 0.01], [n - 3, n - 3, 1], [0.001, 0.002, 0.01], cells),
        );
        let start = std::time::Instant::now();
        let pair = pair(&mesh, sides(&mesh), 0.01);
        let facets = sides(&mesh).map(|side| side.facets.len());
        println!("{cells:?}: {facets:?} facets, {} segments, {:.2?}", pair.segments(), start.elapsed());
    }
}
