//! Stresses recovered at the nodes and along the contact surface, beside closed forms: how far they are off, and how fast
//! that falls with the size of the elements. doc/method/estimates.md has the figures, which `--nocapture` prints.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use crate::common::{self, hertz::Hertz};
use std::f64::consts::FRAC_PI_2;
use std::ops::ControlFlow;
use stickslip::algebra::norm;
use stickslip::base::Formula;
use stickslip::body::fem::{Element, Material, Plane};
use stickslip::body::mesh::{CellKind, Mesh, MeshSource};
use stickslip::body::{
    Action, Axis, Description, Field, GapDirection, Model, Obstacle, Place, Shape, Support, SurfaceStress,
};
use stickslip::run::{Recording, Run, discretise};
use stickslip::solver::history::{IncrementView, Method, Observer, SolverChoice, Status};

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
        let at_end = plane != Some(Plane::Axisymmetric) && contact.position[..2].iter().any(|x| x.abs() < 1e-9);
        if at_end {
            continue;
        }
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

/// A block bent by a traction that is linear over its height: the largest error of the stress at the nodes, relative to
/// the largest stress.
fn bent(kind: CellKind, n: usize) -> f64 {
    let d = kind.dimension();
    let mesh = MeshSource::segmented(&vec![vec![1.0]; d], &vec![vec![n]; d], None, Some(kind)).unwrap();
    let across = format!("{PRESSURE} * (1 - 2 * y)");
    let traction = [across.as_str(), "0", "0"];
    let traction = traction[..d].iter().map(|text| Field::Formula(Formula::parse(text).unwrap())).collect();
    let mut body = Description::new(mesh, Material::new(YOUNG, 0.3), vec![1.0])
        .support("left", &[Axis::X])
        .load(Action::Traction { boundary: "right".to_string(), traction }.into());
    body = match d {
        2 => body.held(Support::new("left", &[Axis::Y]).at([0.0, 0.0])),
        _ => body
            .held(Support::new("left", &[Axis::Y, Axis::Z]).at([0.0, 0.0, 0.0]))
            .held(Support::new("left", &[Axis::Z]).at([0.0, 1.0, 0.0])),
    };
    let Solved { model, nodal, .. } = solved(&body);
    let off = |(x, stress): (&[f64; 3], &[f64; 6])| (stress[0] / PRESSURE - (1.0 - 2.0 * x[1])).abs();
    let inside = |(x, _): &(&[f64; 3], &[f64; 6])| (0.25..=0.75).contains(&x[0]);
    model.mesh.nodes.iter().zip(&nodal).filter(inside).map(off).fold(0.0, f64::max)
}

#[test]
fn the_stress_of_a_bent_block() {
    use CellKind::{Hexahedron, Prism, Quadrilateral, Tetrahedron, Tetrahedron10, Triangle, Triangle6};
    for (kind, sizes) in [
        (Quadrilateral, [8, 16]),
        (Triangle, [8, 16]),
        (Triangle6, [2, 4]),
        (Hexahedron, [4, 8]),
        (Prism, [4, 8]),
        (Tetrahedron, [4, 8]),
        (Tetrahedron10, [2, 4]),
    ] {
        let [coarse, fine] = sizes.map(|n| bent(kind, n));
        println!("bent {kind:?}: {coarse:.2e} {fine:.2e} order {:.2}", (coarse / fine).log2());
    }
}

/// Keeps the stresses along the surface of all increments.
struct Keep<'a> {
    model: &'a Model,
    states: Vec<(f64, f64, Vec<SurfaceStress>, Vec<[f64; 6]>)>,
}

impl Observer for Keep<'_> {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        let sum = |p: &[f64]| p.iter().sum::<f64>();
        let stresses = self.model.surface_stresses(step.record.time, step.state);
        let end = self.model.displacements(step.record.time, &step.state.u).unwrap();
        let nodal = self.model.nodal_stresses_at(step.record.time, &end).unwrap();
        self.states.push((sum(&step.state.p_n), -sum(&step.state.p_t), stresses, nodal));
        ControlFlow::Continue(())
    }
}

/// Hertz' contact of a cylinder, pushed sideways until it slides, after Cattaneo and Mindlin: along the surface the stress
/// is `-p` under the pressure alone, and `2 p₀ √(μ Q / P)` at the edge behind which the surface is drawn. The errors of
/// the stress, in the root mean square over five half-widths, and of its largest value for each of three states, relative
/// to p₀ and to the exact value.
fn cylinder(kind: (&str, &str), elements: usize) -> [[f64; 2]; 3] {
    let mesh = format!("mesh.elements=[[{0},{1},{0}],{2}]", 4 * elements / 3, 2 * elements, 16 * elements / 9);
    let motion = "contact.obstacle.motion.translation=[[1,0,0],[2,2.1e-5,0],[3,1e-4,0]]";
    let (cells, element) = kind;
    let [cells, element] = [("cells", cells), ("element", element)].map(|(key, value)| format!("mesh.{key}={value:?}"));
    let scene = common::scene("cattaneo_mindlin.toml", &[&mesh, &cells, &element, motion]);
    let model = discretise(&scene).unwrap();
    let mut keep = Keep { model: &model, states: Vec::new() };
    let outcome = common::run_default(&scene, &model, &mut keep);
    assert_eq!(outcome.status, Status::Converged);
    let (mu, nu, middle) = (0.4, 0.499_f64, 5.0);
    [1, 3, 5].map(|k| {
        let (load, pushed, stresses, nodal) = &keep.states[k];
        let hertz = Hertz::line(*load, 100.0, 210e9 / (1.0 - nu * nu));
        let q = (pushed / (mu * load)).clamp(0.0, 1.0);
        let c = hertz.stick(q);
        // ∫ of a Hertzian shear stress, over 2 μ p₀.
        let drawn = |s: f64| if s.abs() <= 1.0 { s } else { s - s.signum() * (s * s - 1.0).sqrt() };
        let of_stick = |x: f64| if c > 1e-3 * hertz.a { c / hertz.a * drawn(x / c) } else { 0.0 };
        let exact = |x: f64| -hertz.pressure(x) - 2.0 * mu * hertz.p0 * (drawn(x / hertz.a) - of_stick(x));
        let (mut squares, mut of_nodal, mut weight, mut most) = (0.0, 0.0, 0.0, f64::MIN);
        for (contact, stress) in model.contacts.iter().zip(stresses) {
            let x = contact.position[0] - middle;
            if x.abs() < 2.5 * hertz.a {
                squares += contact.weight * ((stress.along - exact(x)) / hertz.p0).powi(2);
                of_nodal += contact.weight * ((nodal[contact.node][0] - exact(x)) / hertz.p0).powi(2);
                if std::env::var("DUMP").is_ok() { println!("   {:.5} {:.4} {:.4} {:.4} mm {:.4} p {:.4}", x / hertz.a, stress.along / hertz.p0, exact(x) / hertz.p0, nodal[contact.node][0]/hertz.p0, stress.stress[1]/hertz.p0, hertz.pressure(x)/hertz.p0); }
                weight += contact.weight;
                most = most.max(stress.along);
            }
        }
        let peak = 2.0 * mu * hertz.p0 * q.sqrt();
        let off_peak = if k == 1 { 0.0 } else { most / peak - 1.0 };
        println!("{kind:?} {elements} state {k}: q {q:.3}, a {:.5}, p0 {:.4e}, nodal rms {:.4}", hertz.a, hertz.p0, (of_nodal / weight).sqrt());
        [(squares / weight).sqrt(), off_peak]
    })
}

#[test]
fn the_stress_along_a_fretted_surface() {
    for kind in if std::env::var("DUMP").is_ok() { vec![("triangle6", "nodal-volume")] } else { vec![("quadrilateral", "b-bar"), ("triangle", "nodal-volume"), ("triangle6", "nodal-volume")] } {
        let sizes = if kind.0 == "triangle6" { [9, 18, 36] } else { [18, 36, 72] };
        let errors = sizes.map(|n| cylinder(kind, n));
        for (k, state) in ["normal", "partial", "sliding"].iter().enumerate() {
            let [a, b, c] = errors.map(|errors| errors[k][0]);
            let peaks = errors.map(|errors| errors[k][1]);
            println!("{kind:?} {state}: rms {a:.4} {b:.4} {c:.4}, orders {:.2} {:.2}, peak {peaks:.4?}", (a / b).log2(), (b / c).log2());
        }
    }
}
