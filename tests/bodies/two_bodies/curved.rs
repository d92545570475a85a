//! Gaps between the curved surfaces that facets approximate.

use super::whole;
use crate::common::convergence::order;
use crate::common::pairs::solved;
use crate::common::round::moved;
use std::f64::consts::{FRAC_PI_2, PI};
use stickslip::algebra::linear::SparseLu;
use stickslip::body::fem::{Material, Plane};
use stickslip::body::mesh::{Body, Mesh, MeshSource, block};
use stickslip::body::{Axis, Description, FirstGap, Load, Model, Opposite, Support};
use stickslip::run::report::WarningKind;
use stickslip::solver::history::{LinearAlgebra, Method, SolverChoice};

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
    /// Of second order, with nodes between corners on the surface.
    SecondOrder,
    /// Of second order, with straight edges.
    Straight,
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
    let across = if from < RADII[1] - 0.01 { 3 } else { 4 };
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
    }
}

/// Two bodies whose interference is drawn, `n` facets around the inner and the outer one.
fn pressed(shape: Shape, cells: Cells, n: [usize; 2], gap: FirstGap, inner_is_slave: bool) -> Description {
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
                .held(Support::normal(&at("back")))
                .held(Support::normal(&at("top"))),
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

/// The errors of the mean pressure, and of the pressure that is furthest off.
fn errors(shape: Shape, cells: Cells, n: [usize; 2], gap: FirstGap, inner_is_slave: bool) -> [f64; 2] {
    let model = Model::build(&pressed(shape, cells, n, gap, inner_is_slave)).unwrap();
    let solver = SolverChoice { linear: Some(LinearAlgebra::default()), ..SolverChoice::new(Method::BN) };
    let state = solved(&model, solver, &mut ()).state;
    let area: f64 = model.contacts.iter().map(|contact| contact.weight).sum();
    let mean = state.p_n.iter().sum::<f64>() / area / exact(shape) - 1.0;
    let pressures = model.contacts.iter().zip(&state.p_n).map(|(contact, p)| p / contact.weight / exact(shape) - 1.0);
    [mean, pressures.fold(0.0, |worst: f64, error| if error.abs() > worst.abs() { error } else { worst })]
}

fn table(shape: Shape, cells: Cells, meshes: &[[usize; 2]]) {
    let gaps = [FirstGap::Measured, FirstGap::Curved, FirstGap::Uniform(-INTERFERENCE)];
    for inner_is_slave in [true, false] {
        for gap in &gaps {
            let all: Vec<[f64; 2]> =
                meshes.iter().map(|&n| errors(shape, cells, n, gap.clone(), inner_is_slave)).collect();
            let elements: Vec<usize> = meshes.iter().map(|n| n[0]).collect();
            let orders = [0, 1].map(|k| order(&elements, &all.iter().map(|errors| errors[k]).collect::<Vec<_>>()));
            println!("{shape:?} {cells:?} {meshes:?} inner {inner_is_slave} {gap:?}: {all:.4?}, orders {orders:.1?}");
            if inner_is_slave {
                println!("{:?}", faceted(&pressed(shape, cells, meshes[meshes.len() - 1], gap.clone(), true)));
            }
        }
    }
}

/// Half of a pin that lies at the bottom of a bore with `CLEARANCE` and is pressed down, `n` facets around each.
fn pin(cells: Cells, n: [usize; 2], gap: FirstGap, inner_is_slave: bool) -> Description {
    let ring = |radii: [f64; 2], n: usize, down: f64| {
        let place = move |[s, t, _]: [f64; 3]| {
            let (r, angle) = (radii[0] + s * (radii[1] - radii[0]), PI * (uneven(t, 0.1) - 0.5));
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
fn pressed_pin(cells: Cells, n: [usize; 2], gap: FirstGap, inner_is_slave: bool) -> ([f64; 2], Option<String>) {
    let body = pin(cells, n, gap, inner_is_slave);
    let model = Model::build(&body).unwrap();
    let solver = SolverChoice { linear: Some(LinearAlgebra::default()), ..SolverChoice::new(Method::BN) };
    let state = solved(&model, solver, &mut ()).state;
    let mut worst: f64 = 0.0;
    let [mut closed, mut all] = [0.0; 2];
    for (contact, p) in model.contacts.iter().zip(&state.p_n) {
        worst = worst.max(p / contact.weight);
        all += contact.weight;
        closed += if *p > 0.0 { contact.weight } else { 0.0 };
    }
    ([worst, closed / all], faceted(&body))
}

/// The warning of facets.
fn faceted(body: &Description) -> Option<String> {
    let report = whole::report(body, Method::BN, LinearAlgebra::Whole(SparseLu::default()));
    report.warnings.into_iter().find(|warning| warning.kind == WarningKind::FacetedGaps).map(|warning| warning.message)
}

#[test]
#[ignore = "prints the figures of the pages"]
fn table_of_pins() {
    for inner_is_slave in [true, false] {
        println!("fine {:?}", pressed_pin(Cells::SecondOrder, [96, 72], FirstGap::Measured, inner_is_slave));
        for gap in [FirstGap::Measured, FirstGap::Curved] {
            for n in [[16, 12], [24, 24], [32, 24], [64, 48]] {
                println!("{n:?} {gap:?} {:?}", pressed_pin(Cells::Blocks, n, gap.clone(), inner_is_slave));
            }
        }
    }
}

#[test]
#[ignore = "prints the figures of the pages"]
fn table_of_fits() {
    for cells in [Cells::Blocks, Cells::Simplices, Cells::SecondOrder, Cells::Straight] {
        for shape in [Shape::Rings, Shape::Section] {
            table(shape, cells, &[[8, 6], [16, 12], [32, 24]]);
        }
        for shape in [Shape::Tubes, Shape::Balls] {
            table(shape, cells, &[[4, 3], [8, 6]]);
        }
    }
}
