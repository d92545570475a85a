//! Gaps between the curved surfaces that facets approximate.

use super::whole;
use crate::common::prelude::*;
use std::collections::BTreeSet;
use stickslip::body::Against;

const RADII: [f64; 3] = [0.05, 0.1, 0.2];
const YOUNG: f64 = 210e9;
const NU: f64 = 0.3;
const INTERFERENCE: f64 = 1e-5;
const CLEARANCE: f64 = 2e-5;

/// The cells of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Cells {
    Blocks,
    Simplices,
    /// Cells of second order, with nodes between corners on the surface.
    SecondOrder,
    /// Cells of second order, with straight edges.
    Straight,
    /// Cells of second order, with nodes between corners on the surface, but off the middle by 15 % of the edge.
    OffMiddle,
    /// Such quadrilaterals and hexahedra.
    OffMiddleBlocks,
    /// Cells of second order, with nodes between corners on straight edges, off the middle.
    StraightOffMiddle,
}

/// The bodies that are pressed into each other.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    /// A quarter of rings in the plane.
    Rings,
    /// A quarter of rings in space.
    Tubes,
    /// The section of hollow balls, from the equator to the axis.
    Section,
    /// Hollow balls in space: what a quarter of a side of a cube sees of them.
    Balls,
}

/// Places between the ends that are not at equal distances.
fn uneven(t: f64, by: f64) -> f64 {
    t + by * (2.0 * PI * t).sin() / (2.0 * PI)
}

/// A body between two radii, with `n` facets around.
fn part(shape: Shape, cells: Cells, [from, to]: [f64; 2], n: usize, by: f64) -> Mesh {
    // Nodes between corners are in the middle of arcs, as those of meshers.
    let by = if cells == Cells::SecondOrder { 0.0 } else { by };
    let off = |places: [f64; 3], n: [usize; 3]| {
        [0, 1, 2].map(|c| {
            let place = places[c] * n[c] as f64;
            places[c] + if (place - place.round()).abs() > 0.4 { 0.15 / n[c] as f64 } else { 0.0 }
        })
    };
    let across = if from < RADII[1] - 0.01 { 3 } else { 4 };
    let counts = match shape {
        Shape::Rings | Shape::Section => [across, n, 1],
        Shape::Tubes => [across, n, 1 + n / 8],
        Shape::Balls => [across, n, n],
    };
    let grid = match shape {
        Shape::Rings | Shape::Section => block(&[1.0, 1.0], &[across, n]),
        Shape::Tubes => block(&[1.0, 1.0, 1.0], &[across, n, 1 + n / 8]),
        Shape::Balls => block(&[1.0, 1.0, 1.0], &[across, n, n]),
    };
    let place = |[s, t, v]: [f64; 3]| {
        let r = from + s * (to - from);
        let angle = FRAC_PI_2 * uneven(t, by);
        let circle = [if t == 1.0 { 0.0 } else { r * angle.cos() }, r * angle.sin()];
        match shape {
            Shape::Rings | Shape::Section => [circle[0], circle[1], 0.0],
            Shape::Tubes => [circle[0], circle[1], 0.05 * v],
            Shape::Balls => {
                let [a, b] = [t, v].map(|t| if t == 1.0 { 1.0 } else { (0.5 * FRAC_PI_2 * uneven(t, by)).tan() });
                let size = r / (1.0 + a * a + b * b).sqrt();
                [size, size * a, size * b]
            }
        }
    };
    match cells {
        Cells::Blocks => moved(grid, place),
        Cells::Simplices => moved(grid.into_simplices(), place),
        Cells::SecondOrder => moved(grid.into_simplices().into_second_order(), place),
        Cells::Straight => moved(grid.into_simplices(), place).into_second_order(),
        Cells::OffMiddle => moved(grid.into_simplices().into_second_order(), |x| place(off(x, counts))),
        Cells::OffMiddleBlocks => moved(grid.into_second_order(), |x| place(off(x, counts))),
        Cells::StraightOffMiddle => {
            let mut mesh = moved(grid.into_simplices(), place).into_second_order();
            let facets = mesh.boundaries.iter().flat_map(|boundary| &boundary.facets);
            let edges = facets.flat_map(|facet| mesh.bent_edges(facet)).map(|[a, m, b]| [a.min(b), m, a.max(b)]);
            let edges: BTreeSet<[usize; 3]> = edges.collect();
            for [a, m, b] in edges {
                let (x, y) = (mesh.nodes[a], mesh.nodes[b]);
                (0..3).for_each(|c| mesh.nodes[m][c] += 0.15 * (y[c] - x[c]));
            }
            mesh
        }
    }
}

/// Two bodies whose interference is drawn, `n` facets around the inner and the outer one.
fn pressed(shape: Shape, cells: Cells, n: [usize; 2], gap: Option<Field>, inner_is_slave: bool) -> Description {
    let mesh = MeshSource::Bodies(vec![
        Body::new("inner", part(shape, cells, [RADII[0], RADII[1] + INTERFERENCE], n[0], 0.2)),
        Body::new("outer", part(shape, cells, [RADII[1], RADII[2]], n[1], -0.1)),
    ]);
    let material = Material::new(YOUNG, NU);
    let material = match shape {
        Shape::Rings => material.in_plane(Plane::Stress),
        Shape::Section => material.in_plane(Plane::Axisymmetric),
        _ => material,
    };
    let [slave, master] = if inner_is_slave { ["inner:right", "outer:left"] } else { ["outer:left", "inner:right"] };
    let against = Opposite { gap, ..Opposite::from(master).within(0.02) };
    let body = Description::new(mesh, material, vec![1.0]).pair(slave, 0.0, against);
    ["inner", "outer"].iter().fold(body, |body, name| {
        let at = |side: &str| format!("{name}:{side}");
        match shape {
            Shape::Rings => body.support(&at("bottom"), &[Axis::Y]).support(&at("top"), &[Axis::X]),
            Shape::Section => body.support(&at("bottom"), &[Axis::Y]),
            Shape::Tubes => body
                .support(&at("front"), &[Axis::Y])
                .support(&at("back"), &[Axis::X])
                .support(&at("bottom"), &[Axis::Z]),
            Shape::Balls => body
                .support(&at("front"), &[Axis::Y])
                .support(&at("bottom"), &[Axis::Z])
                .with_support(Support::normal(&at("back")))
                .with_support(Support::normal(&at("top"))),
        }
    })
}

/// Lamé, plane stress for rings.
fn exact(shape: Shape) -> f64 {
    let r = RADII[1];
    let stiff = match shape {
        Shape::Rings | Shape::Tubes => {
            let [a, c, b] = RADII.map(|r| r * r);
            (b + c) / (b - c) + NU + (c + a) / (c - a) - NU
        }
        Shape::Section | Shape::Balls => {
            let [a, c, b] = RADII.map(|r| r * r * r);
            let outer = ((1.0 - 2.0 * NU) * c + 0.5 * (1.0 + NU) * b) / (b - c);
            let inner = ((1.0 - 2.0 * NU) * c + 0.5 * (1.0 + NU) * a) / (c - a);
            outer + inner
        }
    };
    YOUNG * INTERFERENCE / (r * stiff)
}

/// The largest error of the gaps that are measured, relative to the interference.
fn gap_error(shape: Shape, cells: Cells, n: [usize; 2], inner_is_slave: bool) -> f64 {
    let model = Model::build(&pressed(shape, cells, n, None, inner_is_slave)).unwrap();
    model.contact.pairs[0].gaps.iter().map(|gap| (gap / -INTERFERENCE - 1.0).abs()).fold(0.0, f64::max)
}

/// The errors of the mean pressure, and of the pressure that is furthest off.
fn errors(shape: Shape, cells: Cells, n: [usize; 2], gap: Option<Field>, inner_is_slave: bool) -> [f64; 2] {
    let model = Model::build(&pressed(shape, cells, n, gap, inner_is_slave)).unwrap();
    let solver = solver_of(Method::BN, LinearAlgebra::default());
    let state = solved(&model, solver, &mut ()).state;
    let area: f64 = model.contact.nodes.iter().map(|contact| contact.weight).sum();
    let mean = state.p_n.iter().sum::<f64>() / area / exact(shape) - 1.0;
    let pressures =
        model.contact.nodes.iter().zip(&state.p_n).map(|(contact, p)| p / contact.weight / exact(shape) - 1.0);
    [mean, pressures.fold(0.0, |worst: f64, error| if error.abs() > worst.abs() { error } else { worst })]
}

const ALL: [(Shape, [[usize; 2]; 2]); 4] = [
    (Shape::Rings, [[8, 6], [16, 12]]),
    (Shape::Section, [[8, 6], [16, 12]]),
    (Shape::Tubes, [[8, 6], [12, 10]]),
    (Shape::Balls, [[4, 3], [6, 5]]),
];

/// Facets that do not match have the pressures of the surfaces between which they are, and nothing is told of them.
#[test]
fn fits_of_facets_that_do_not_match() {
    for (shape, meshes) in ALL {
        for inner_is_slave in [true, false] {
            let of = |n, gap| errors(shape, Cells::Blocks, n, gap, inner_is_slave);
            let [coarse, fine] = meshes.map(|n| {
                let (measured, given) = (of(n, None), of(n, Some((-INTERFERENCE).into())));
                println!("{shape:?} {n:?} {inner_is_slave}: measured {measured:.4?}, given {given:.4?}");
                (measured[0] - given[0], measured)
            });
            assert!(fine.1[0].abs() < 0.03 && fine.1[1].abs() < 0.1, "{shape:?}: {fine:?}");
            assert!(fine.0.abs() < 0.003 && fine.0.abs() < coarse.0.abs().max(1e-4), "{shape:?}: {coarse:?} {fine:?}");
        }
        assert_eq!(faceted(&pressed(shape, Cells::Blocks, meshes[1], None, true)), None, "{shape:?}");
    }
}

/// One facet in front of two or three: forces are right on both sides, and so is each pressure with the coarser side as slave, which is
/// therefore chosen; nodes of the finer one feel the facets of the master.
#[test]
fn fits_of_facets_in_front_of_several() {
    for n in [[12, 24], [24, 12], [8, 24], [24, 8]] {
        for inner_is_slave in [true, false] {
            let [mean, worst] = errors(Shape::Rings, Cells::Blocks, n, None, inner_is_slave);
            println!("{n:?} {inner_is_slave}: {mean:.4} {worst:.4}");
            let is_coarse = inner_is_slave == (n[0] < n[1]);
            assert!(mean.abs() < 0.01 && (worst.abs() < 0.01 || !is_coarse), "{n:?} {mean} {worst}");
        }
        let automatic = |mut body: Description| {
            let against = Opposite { slave: Slave::Automatic, ..body.contacts[0].opposite().unwrap().clone() };
            body.contacts[0].against = Against::Boundary(against);
            Model::build(&body).unwrap().contact.pairs[0].choice.unwrap()
        };
        let choice = automatic(pressed(Shape::Rings, Cells::Blocks, n, None, true));
        assert_eq!((choice.slave, choice.reason), (usize::from(n[1] < n[0]), SlaveReason::FewerNodes));
    }
}

/// Gaps between circles, balls and tubes are exact to the square of the angle of a facet, also at planes of symmetry.
#[test]
fn gaps_of_curved_surfaces() {
    for (shape, meshes) in ALL {
        for cells in [
            Cells::Blocks,
            Cells::Simplices,
            Cells::SecondOrder,
            Cells::Straight,
            Cells::OffMiddle,
            Cells::OffMiddleBlocks,
            Cells::StraightOffMiddle,
        ] {
            for inner_is_slave in [true, false] {
                let error = meshes.map(|n| gap_error(shape, cells, n, inner_is_slave));
                println!("{shape:?} {cells:?} {inner_is_slave}: {error:.5?}");
                assert!(error[1] < 0.05, "{shape:?} {cells:?} {inner_is_slave}: {error:?}");
            }
        }
    }
}

/// Flat boundaries keep their measured gaps to the last bit, also if nodes between corners are not in the middle.
#[test]
fn gaps_without_bulges() {
    for (turned, second_order) in [(0.0, false), (0.3_f64, false), (0.0, true), (0.3, true)] {
        let of = |gap| {
            let turn = |mesh| {
                moved(mesh, |[x, y, z]: [f64; 3]| {
                    [x, turned.cos() * y - turned.sin() * z, turned.sin() * y + turned.cos() * z]
                })
            };
            let of_order = |mesh: Mesh| if second_order { mesh.into_second_order() } else { mesh };
            // The faces stay plane, and their edges are bent.
            let bent = |x: f64, y: f64| if second_order { [x + 0.02 * y * y, y + 0.02 * x * (y + x)] } else { [x, y] };
            let place = |[x, y, z]: [f64; 3], down: f64| {
                let [x, y] = bent(x, y);
                [x, y, z - down * (0.5 + 1e-3 * (x - 1.0))]
            };
            let lower = moved(of_order(block(&[1.0, 1.0, 0.5], &[3, 3, 1])), |x| place(x, 1.0));
            let upper = moved(of_order(block(&[1.0, 1.0, 0.5], &[4, 5, 1])), |x| place(x, 0.0));
            let mesh = MeshSource::Bodies(vec![Body::new("lower", turn(lower)), Body::new("upper", turn(upper))]);
            let against = Opposite { gap, ..Opposite::from("lower:top") };
            Description::new(mesh, Material::new(YOUNG, NU), vec![1.0])
                .pair("upper:bottom", 0.0, against)
                .support("lower:bottom", &[Axis::X, Axis::Y, Axis::Z])
                .support("upper:top", &[Axis::X, Axis::Y, Axis::Z])
        };
        let model = Model::build(&of(None)).unwrap();
        let pair = &model.contact.pairs[0];
        assert!(pair.mortar.rows.iter().all(|row| row.bulge == 0.0 && row.edges == 0.0), "{turned}");
    }
}

/// The model of a body below a block.
fn under_a_block(lower: Mesh) -> Model {
    let mesh = MeshSource::Bodies(vec![
        Body::new("lower", lower),
        Body::new("upper", block(&[1.0, 0.5], &[13, 4])).at([0.0, 0.5]),
    ]);
    let body = Description::new(mesh, Material::new(YOUNG, NU), vec![1.0])
        .pair("lower:top", 0.0, Opposite::from("upper:bottom").within(0.4))
        .support("upper:top", &[Axis::X, Axis::Y])
        .support("lower:bottom", &[Axis::X, Axis::Y]);
    Model::build(&body).unwrap()
}

/// A flat that goes over into a rounding without an edge: the rounding has its whole bulge from the first facet on, however
/// long the facets of the flat are.
#[test]
fn roundings_that_begin_at_a_flat() {
    for (flat, after) in [(1, 1.0), (2, 1.0), (4, 1.0), (4, -1.0)] {
        let n = 8 / flat;
        let lower = moved(block(&[1.0, 0.5], &[n + 8, 4]), |[x, y, z]| {
            // The flat ends at 0.4, and the rounding of the radius 1 turns by 0.05 a facet.
            let k = x * (n + 8) as f64 - n as f64;
            let (x, down) = if k <= 0.0 {
                (0.4 + 0.05 * flat as f64 * k, 0.0)
            } else {
                ((0.05 * k).sin() + 0.4, 1.0 - (0.05 * k).cos())
            };
            [x, y * (1.0 - 2.0 * after * down), z]
        });
        let model = under_a_block(lower);
        for row in &model.contact.pairs[0].mortar.rows {
            let share = row.bulge / (after * 0.05 * 0.05 / 12.0);
            match model.mesh.nodes[row.node][0] {
                x if x < 0.39 => assert!(share.abs() < 1e-9, "{flat} {x}: {share}"),
                x if (0.41..0.75).contains(&x) => assert!((share - 1.0).abs() < 0.02, "{flat} {x}: {share}"),
                _ => {}
            }
        }
    }
}

/// A flat that ends in a chamfer or in a rounding stays flat, and a worn roller stays round beyond the edge of its flat.
#[test]
fn flats_beside_edges_and_curves() {
    for end in ["chamfer", "rounding", "roller"] {
        let lower = moved(block(&[1.0, 0.5], &[20, 4]), |[x, y, z]| {
            let outside = (x - 0.7).max(0.0);
            let down = match end {
                "chamfer" => outside,
                "rounding" => 0.5 - (0.25 - outside * outside).sqrt(),
                _ => ((12.25_f64 - 0.49).sqrt() - (12.25 - x * x).sqrt()).max(0.0),
            };
            [x, y * (1.0 - 2.0 * down), z]
        });
        let model = under_a_block(lower);
        for (row, gap) in model.contact.pairs[0].mortar.rows.iter().zip(&model.contact.pairs[0].gaps) {
            let x = model.mesh.nodes[row.node][0];
            if x < 0.69 {
                assert!(row.bulge == 0.0 && (gap - row.gap).abs() < 1e-15, "{end} {x}: {gap}");
            } else if end == "roller" && (0.74..0.93).contains(&x) {
                let mean = 0.05 * 0.05 * (1.0 + x * x / 12.25) / (12.0 * 3.5);
                assert!((row.bulge / mean - 1.0).abs() < 0.1, "{x}: {} {mean}", row.bulge);
            }
        }
    }
}

/// Half of a pin that lies at the bottom of a bore with `CLEARANCE` and is pressed down, `n` facets around each.
fn pin(cells: Cells, n: [usize; 2], gap: Option<Field>, inner_is_slave: bool) -> Description {
    let ring = |radii: [f64; 2], n: usize, down: f64| {
        let place = move |[s, t, _]: [f64; 3]| {
            let by = if cells == Cells::SecondOrder { 0.0 } else { 0.1 };
            let (r, angle) = (radii[0] + s * (radii[1] - radii[0]), PI * (uneven(t, by) - 0.5));
            [if t == 0.0 || t == 1.0 { 0.0 } else { r * angle.cos() }, r * angle.sin() - down, 0.0]
        };
        let grid = block(&[1.0, 1.0], &[4, n]);
        if cells == Cells::SecondOrder {
            moved(grid.into_simplices().into_second_order(), place)
        } else {
            moved(grid, place)
        }
    };
    let mesh = MeshSource::Bodies(vec![
        Body::new("inner", ring([RADII[0], RADII[1] - CLEARANCE], n[0], CLEARANCE)),
        Body::new("outer", ring([RADII[1], RADII[2]], n[1], 0.0)),
    ]);
    let [slave, master] = if inner_is_slave { ["inner:right", "outer:left"] } else { ["outer:left", "inner:right"] };
    let body = Description::new(mesh, Material::new(YOUNG, NU), vec![1.0]);
    body.pair(slave, 0.0, Opposite { gap, ..Opposite::from(master).within(0.02) })
        .support("inner:bottom", &[Axis::X])
        .support("inner:top", &[Axis::X])
        .support("outer:bottom", &[Axis::X])
        .support("outer:top", &[Axis::X])
        .support("outer:right", &[Axis::X, Axis::Y])
        .load(Load::new("inner:left", &[0.0, -1e7]))
}

/// The largest pressure (Pa), the part of the boundary in contact, and the warning of facets.
fn pressed_pin(cells: Cells, n: [usize; 2], gap: Option<Field>, inner_is_slave: bool) -> ([f64; 2], Option<String>) {
    let body = pin(cells, n, gap, inner_is_slave);
    let model = Model::build(&body).unwrap();
    let solver = solver_of(Method::BN, LinearAlgebra::default());
    let state = solved(&model, solver, &mut ()).state;
    let mut worst: f64 = 0.0;
    let [mut closed, mut all] = [0.0; 2];
    for (contact, p) in model.contact.nodes.iter().zip(&state.p_n) {
        worst = worst.max(p / contact.weight);
        all += contact.weight;
        closed += if *p > 0.0 { contact.weight } else { 0.0 };
    }
    ([worst, closed / all], faceted(&body))
}

/// The warning of facets.
fn faceted(body: &Description) -> Option<String> {
    let report = whole::report(body, Method::BN, LinearAlgebra::Whole(SparseLu::default()));
    report.warnings.into_iter().find(|warning| warning.kind == WarningKind::FACETED_GAPS).map(|warning| warning.message)
}

/// Forces of coarse curved facets are off by the normals of their nodes, which are those of the facets in the mean. Errors of half to
/// three per cent are told.
#[test]
fn errors_of_forces_by_mean_normals_are_told() {
    let force = |n: usize, inner_is_slave: bool| {
        let body = pressed(Shape::Rings, Cells::SecondOrder, [n; 2], Some((-INTERFERENCE).into()), inner_is_slave);
        let report = whole::report(&body, Method::BN, LinearAlgebra::Whole(SparseLu::default()));
        report.largest_force.map(|force| (force.magnitude, force.mesh_error.unwrap())).unwrap()
    };
    for (n, inner_is_slave) in [(3, true), (3, false), (4, true), (6, false), (8, true)] {
        let (force, told) = force(n, inner_is_slave);
        let true_error = (force / (exact(Shape::Rings) * RADII[1] * 2.0_f64.sqrt()) - 1.0).abs();
        println!("{n} {inner_is_slave}: told {told:.4}, true {true_error:.4}");
        assert!(told < 3.0 * true_error && true_error < 3.0 * told, "{n} {inner_is_slave}: {told} {true_error}");
    }
}

/// A pin in a bore with a clearance far below the bulge of its facets: the pressure is that on second order.
#[test]
fn pins_with_clearance() {
    for inner_is_slave in [true, false] {
        let (fine, _) = pressed_pin(Cells::SecondOrder, [48, 36], None, inner_is_slave);
        let (curved, warning) = pressed_pin(Cells::Blocks, [24, 18], None, inner_is_slave);
        println!("{inner_is_slave}: {fine:?} {curved:?}");
        assert!((curved[0] / fine[0] - 1.0).abs() < 0.05 && (curved[1] / fine[1] - 1.0).abs() < 0.1);
        assert_eq!(warning, None);
    }
}

/// Facets that turn by more than 44° count as apart, which is told where they are pressed: what is meant may be a circle. Nothing is said of
/// the edges of a block, and of a chamfer that is not pressed.
#[test]
fn circles_of_too_few_facets() {
    let few = |n, gap| faceted(&pressed(Shape::Rings, Cells::Blocks, n, gap, true));
    let message = few([2, 3], None).unwrap();
    assert!(message.contains("twice as many elements"), "{message}");
    assert_eq!(few([3, 4], None), None);
    for chamfer in [0.0, 0.2] {
        let place = |[x, y, z]: [f64; 3]| [x, y - 2.8 * y * (x - 1.0 + chamfer).max(0.0), z];
        let mut lower = moved(block(&[1.0, 0.5], &[10, 4]), place);
        let side = lower.boundary("right").unwrap().facets.clone();
        lower.boundaries.iter_mut().find(|boundary| boundary.name == "top").unwrap().facets.extend(side);
        let upper = block(&[1.5, 0.5], &[12, 4]);
        let mesh = MeshSource::Bodies(vec![Body::new("lower", lower), Body::new("upper", upper).at([-0.25, 0.499])]);
        let body = Description::new(mesh, Material::new(YOUNG, NU), vec![1.0])
            .pair("lower:top", 0.0, Opposite::from("upper:bottom").within(0.1))
            .support("lower:bottom", &[Axis::X, Axis::Y])
            .support("upper:top", &[Axis::X, Axis::Y]);
        assert_eq!(faceted(&body), None, "{chamfer}");
    }
}

/// Facets of different lengths are parts of one circle.
#[test]
fn gaps_of_graded_circles() {
    for grading in [1.3, 0.6, 0.4_f64] {
        let places = |k: usize| (0..k).map(|k| grading.powf(k as f64)).sum::<f64>();
        let part = |[from, to]: [f64; 2], n: usize, graded: bool| {
            moved(block(&[1.0, 1.0], &[3, n]), move |[s, t, _]: [f64; 3]| {
                let share = if graded { places((t * n as f64).round() as usize) / places(n) } else { t };
                let (r, angle) = (from + s * (to - from), FRAC_PI_2 * share);
                [if t == 1.0 { 0.0 } else { r * angle.cos() }, r * angle.sin(), 0.0]
            })
        };
        let mesh = MeshSource::Bodies(vec![
            Body::new("inner", part([RADII[0], RADII[1] + INTERFERENCE], 8, true)),
            Body::new("outer", part([RADII[1], RADII[2]], 11, false)),
        ]);
        let against = Opposite::from("outer:left").within(0.02);
        let body = Description::new(mesh, Material::new(YOUNG, NU), vec![1.0])
            .pair("inner:right", 0.0, against)
            .support("inner:bottom", &[Axis::Y])
            .support("inner:top", &[Axis::X])
            .support("outer:bottom", &[Axis::Y])
            .support("outer:top", &[Axis::X]);
        for gap in &Model::build(&body).unwrap().contact.pairs[0].gaps {
            assert!((gap / -INTERFERENCE - 1.0).abs() < 0.04, "{grading}: {gap}");
        }
    }
}

/// Nodes between corners that are on the surface, but not in the middle, bend facets away from it by more than a fit. Gaps
/// are those between the surfaces through the nodes.
#[test]
fn nodes_off_the_middle_of_their_edges() {
    for (shape, meshes) in [ALL[0], ALL[2]] {
        for cells in [Cells::OffMiddle, Cells::OffMiddleBlocks] {
            let found = errors(shape, cells, meshes[1], None, true);
            println!("{shape:?} {cells:?}: {found:.4?}");
            assert!(found[0].abs() < 0.03 && found[1].abs() < 0.25, "{found:?}");
        }
    }
}

/// Two rings of a few triangles that refine themselves have the pressure of circles: that of polygons is 30 times as large,
/// as the height of an arc over its facet is 50 times the interference.
#[test]
fn polygons_that_refine_themselves_become_circles() {
    let text = r#"
        [mesh] kind = "block", size = [1, 1], elements = [1, 1], cells = "triangle"
        [material] young = 1, poisson = 0.3
        [[support]] boundary = "bottom", fix = ["x", "y"]
        [time] end = 1, increments = 1
    "#;
    for (cells, inner_is_slave, refine) in
        [(Cells::Simplices, true, 0.05), (Cells::Simplices, false, 0.05), (Cells::Straight, true, 0.005)]
    {
        let mut scene = parsed_with(&scene_text(text), &[]);
        scene.description = pressed(Shape::Rings, cells, [10, 8], None, inner_is_slave);
        scene.refine = Some(refine);
        let run = Run::new(&scene).unwrap();
        let report = run.solve(&mut ()).unwrap();
        let model = run.model();
        let area: f64 = model.contact.nodes.iter().map(|contact| contact.weight).sum();
        let mean = report.forces.last().unwrap().resultant.sums.sum_p_n / area / exact(Shape::Rings) - 1.0;
        let gaps = model.contact.pairs[0].gaps.iter().map(|gap| (gap / -INTERFERENCE - 1.0).abs());
        let gap = gaps.fold(0.0, f64::max);
        println!("{cells:?} {inner_is_slave}: {} nodes, mean {mean:.5}, gap {gap:.4}", model.mesh.nodes.len());
        assert!(report.coarser_meshes.len() > 3, "{}", report.coarser_meshes.len());
        assert!(mean.abs() < 2e-3 && gap < 0.01, "{cells:?} {inner_is_slave}: {mean} {gap}");
    }
}
