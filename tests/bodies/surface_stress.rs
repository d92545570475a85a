//! Stresses recovered at the nodes and along the contact surface, beside closed forms: how far they are off, and how fast
//! that falls with the size of the elements. doc/method/estimates.md has the figures, which `--nocapture` prints.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::f64::consts::FRAC_PI_2;
use stickslip::algebra::norm;
use stickslip::body::fem::{Element, Material, Plane};
use stickslip::body::mesh::{CellKind, Mesh, MeshSource};
use stickslip::body::{
    Action, Axis, Description, Field, GapDirection, Model, Obstacle, Place, Shape, Support, SurfaceStress,
};
use stickslip::run::{Recording, Run};
use stickslip::solver::history::{Method, SolverChoice, Status};

/// The nodal stresses of a body at the end, and those along its contact surface.
struct Solved {
    model: Model,
    nodal: Vec<[f64; 6]>,
    surface: Vec<SurfaceStress>,
}

fn solved(body: &Description) -> Solved {
    let model = Model::build(body).unwrap();
    let mut recording = Recording::last();
    let run = Run::of(&model, model.times().to_vec(), SolverChoice::new(Method::BN)).unwrap();
    let report = run.solve(&mut recording).unwrap();
    assert_eq!(report.status, Status::Converged, "{}", report.explanation.reason);
    let state = &recording.increments[0].state;
    let end = *model.times().last().unwrap();
    let nodal = model.nodal_stresses_at(end, &model.displacements(end, &state.u).unwrap()).unwrap();
    let surface = model.surface_stresses(end, state);
    Solved { model, nodal, surface }
}

/// A quarter of a tube with radii 1 and 2, `n` elements across; in space a slice of it.
fn tube(kind: CellKind, n: usize) -> Mesh {
    let (lengths, elements) = (vec![vec![1.0], vec![1.0], vec![0.25]], vec![vec![n], vec![2 * n], vec![n.div_ceil(4)]]);
    let d = kind.dimension();
    let mesh = MeshSource::segmented(&lengths[..d], &elements[..d], None, Some(kind)).unwrap().build().unwrap();
    let mut mesh = (*mesh).clone();
    for x in &mut mesh.nodes {
        let (r, angle) = (1.0 + x[0], FRAC_PI_2 * x[1]);
        (x[0], x[1]) = (r * angle.sin(), r * angle.cos());
        // The order of the axes stays right-handed.
        x[0] = r * angle.cos();
        x[1] = r * angle.sin();
    }
    mesh
}

/// The loads of a tube: a pressure inside, or a rigid core that is too large.
#[derive(Clone, Copy, PartialEq)]
enum Inside {
    Pressure,
    Core,
}

const YOUNG: f64 = 1e9;
const PRESSURE: f64 = 1e6;

/// The largest errors at the inner surface, relative to the largest hoop stress: of the nodal hoop stress, and of that
/// along the contact surface.
fn tube_errors(kind: CellKind, element: Element, plane: Option<Plane>, nu: f64, n: usize, inside: Inside) -> [f64; 2] {
    let (a, b) = (1.0_f64, 2.0_f64);
    let c = a * a / (b * b - a * a);
    let hoop = PRESSURE * c * (1.0 + b * b / (a * a));
    // u(a) = a ε_θθ.
    let out = if plane == Some(Plane::Stress) { 0.0 } else { nu * 2.0 * PRESSURE * c };
    let delta = a * (hoop + nu * PRESSURE - nu * out) / YOUNG;
    let material = Material { plane, ..Material::new(YOUNG, nu) };
    let (mesh, inner, d) = if plane == Some(Plane::Axisymmetric) {
        let source = MeshSource::segmented(&[vec![1.0], vec![0.5]], &[vec![n], vec![n.div_ceil(2)]], None, Some(kind));
        let MeshSource::Block { axes, cells, .. } = source.unwrap() else { panic!() };
        let mesh = MeshSource::Block { axes, cells, origin: Some([1.0, 0.0].into()) };
        (mesh, "left", 2)
    } else {
        (MeshSource::Given(tube(kind, n).into()), "left", kind.dimension())
    };
    let mut body = Description::new(mesh, material, vec![1.0]);
    body = match plane {
        Some(Plane::Axisymmetric) => {
            body.held(Support::new("bottom", &[Axis::Y])).held(Support::new("top", &[Axis::Y]))
        }
        _ => {
            let ends = if d == 2 { ["bottom", "top"] } else { ["front", "back"] };
            let body = body.held(Support::new(ends[0], &[Axis::Y])).held(Support::new(ends[1], &[Axis::X]));
            if d == 2 {
                body
            } else {
                body.held(Support::new("bottom", &[Axis::Z])).held(Support::new("top", &[Axis::Z]))
            }
        }
    };
    body = match inside {
        Inside::Pressure => body.load(
            Action::Pressure { boundary: inner.to_string(), pressure: Field::Uniform(PRESSURE) }.into(),
        ),
        Inside::Core if plane == Some(Plane::Axisymmetric) => body.contact(inner, 0.0, Obstacle::plane(-delta)),
        Inside::Core => {
            let centre: &[f64] = &[0.0; 3][..d];
            let place = Place::Center(if d == 2 { [0.0, 0.0].into() } else { [0.0, 0.0, 0.0].into() });
            let _ = centre;
            let axis = (d == 3).then(|| [0.0, 0.0, 1.0].into());
            let core = Obstacle::at_rest(Shape::Cylinder { radius: 1.0 + delta, place, axis });
            body.contact(inner, 0.0, Obstacle { direction: GapDirection::Nearest, ..core })
        }
    };
    body.element = element;
    let Solved { model, nodal, surface } = solved(&body);
    let mut off = [0.0_f64; 2];
    for node in model.mesh.boundary(inner).unwrap().nodes() {
        let x = model.mesh.nodes[node];
        let [xx, yy, zz, xy, ..] = nodal[node];
        let found = if plane == Some(Plane::Axisymmetric) {
            zz
        } else {
            let r = norm([x[0], x[1], 0.0]);
            let t = [-x[1] / r, x[0] / r];
            xx * t[0] * t[0] + 2.0 * xy * t[0] * t[1] + yy * t[1] * t[1]
        };
        off[0] = off[0].max((found / hoop - 1.0).abs());
    }
    for (contact, stress) in model.contacts.iter().zip(&surface) {
        let along = contact.frame[0];
        let around = if plane == Some(Plane::Axisymmetric) || along[2].abs() > 0.5 { stress.across } else { stress.along };
        off[1] = off[1].max((around / hoop - 1.0).abs());
    }
    off
}

#[test]
fn the_hoop_stress_of_a_tube() {
    use CellKind::{Hexahedron, Prism, Quadrilateral, Tetrahedron, Tetrahedron10, Triangle, Triangle6};
    use Element::{BBar, Bilinear, NodalVolume};
    let strain = None;
    for (kind, element, plane, nu, sizes) in [
        (Quadrilateral, Bilinear, strain, 0.3, [8, 16]),
        (Quadrilateral, Bilinear, Some(Plane::Stress), 0.3, [8, 16]),
        (Quadrilateral, Bilinear, Some(Plane::Axisymmetric), 0.3, [8, 16]),
        (Quadrilateral, BBar, strain, 0.499, [8, 16]),
        (Triangle, Bilinear, strain, 0.3, [8, 16]),
        (Triangle, Bilinear, Some(Plane::Stress), 0.3, [8, 16]),
        (Triangle, Bilinear, Some(Plane::Axisymmetric), 0.3, [8, 16]),
        (Triangle, NodalVolume, strain, 0.499, [8, 16]),
        (Triangle6, Bilinear, strain, 0.3, [4, 8]),
        (Triangle6, Bilinear, Some(Plane::Axisymmetric), 0.3, [4, 8]),
        (Triangle6, NodalVolume, strain, 0.499, [4, 8]),
        (Hexahedron, Bilinear, None, 0.3, [8, 16]),
        (Prism, Bilinear, None, 0.3, [8, 16]),
        (Tetrahedron, Bilinear, None, 0.3, [8, 16]),
        (Tetrahedron10, Bilinear, None, 0.3, [4, 8]),
    ] {
        let pressed = sizes.map(|n| tube_errors(kind, element, plane, nu, n, Inside::Pressure)[0]);
        let [coarse, fine] = sizes.map(|n| tube_errors(kind, element, plane, nu, n, Inside::Core));
        let order = |coarse: f64, fine: f64| (coarse / fine).log2();
        println!(
            "{kind:?} {element:?} {plane:?} {nu}: pressure, nodal {:.4} {:.4} order {:.2}; core, nodal {:.4} {:.4} order {:.2}, surface {:.4} {:.4} order {:.2}",
            pressed[0],
            pressed[1],
            order(pressed[0], pressed[1]),
            coarse[0],
            fine[0],
            order(coarse[0], fine[0]),
            coarse[1],
            fine[1],
            order(coarse[1], fine[1])
        );
    }
}
