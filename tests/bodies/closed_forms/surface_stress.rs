//! Stresses recovered at the nodes and along the contact surface, beside closed forms: how far they are off, and how fast
//! that falls with the size of the elements. doc/method/element-errors.md has the figures, which `--nocapture` prints.

use crate::common;
use crate::common::prelude::*;
use stickslip::body::SurfaceStress;

/// The nodal stresses of a body at the end, and those along its contact surface.
struct Solved {
    model: Model,
    nodal: Vec<[f64; 6]>,
    surface: Vec<SurfaceStress>,
}

fn solved(body: &Description) -> Solved {
    let mut recording = Recording::last();
    let (model, _) = solved_by_bn(body, &mut recording);
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
        (x[0], x[1]) = (r * angle.cos(), r * angle.sin());
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

/// Lamé's tube, its ends held: the largest errors of the hoop stress at the inner surface, relative to this stress: of
/// the nodal stress, and of that along the contact surface but for the nodes in the planes of symmetry.
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
    let planes: &[(&str, Axis)] = match (plane, d) {
        (Some(Plane::Axisymmetric), _) => &[("bottom", Axis::Y), ("top", Axis::Y)],
        (_, 2) => &[("bottom", Axis::Y), ("top", Axis::X)],
        _ => &[("front", Axis::Y), ("back", Axis::X), ("bottom", Axis::Z), ("top", Axis::Z)],
    };
    for (boundary, axis) in planes {
        body = body.with_support(Support::new(boundary, &[*axis]));
    }
    body = match inside {
        Inside::Pressure => {
            body.load(Action::Pressure { boundary: inner.to_string(), pressure: Field::Uniform(PRESSURE) }.into())
        }
        Inside::Core if plane == Some(Plane::Axisymmetric) => body.contact(inner, 0.0, Obstacle::plane(-delta)),
        Inside::Core => {
            let place = Place::Center(if d == 2 { [0.0, 0.0].into() } else { [0.0, 0.0, 0.0].into() });
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
    for (contact, stress) in model.contact.nodes.iter().zip(&surface) {
        let along = contact.frame[0];
        let around =
            if plane == Some(Plane::Axisymmetric) || along[2].abs() > 0.5 { stress.across } else { stress.along };
        let [x, y, _] = contact.position;
        let at_end = if plane == Some(Plane::Axisymmetric) { [y, y - 0.5] } else { [x, y] };
        if at_end.iter().any(|x| x.abs() < 1e-9) {
            continue;
        }
        off[1] = off[1].max((around / hoop - 1.0).abs());
    }
    off
}

/// Prints an error on two meshes, the finer one with half the size, and its order; asks for an error below `most` on the
/// finer one, and for an order above `least`.
fn falls(what: &str, [coarse, fine]: [f64; 2], most: f64, least: f64) {
    let order = (coarse / fine).log2();
    println!("{what}: {:.2} %, {:.2} %, order {order:.1}", 100.0 * coarse, 100.0 * fine);
    assert!(fine < most && order > least, "{what}: {coarse} {fine} {order}");
}

#[test]
fn the_hoop_stress_of_a_tube() {
    use CellKind::{Hexahedron, Prism, Quadrilateral, Tetrahedron, Tetrahedron10, Triangle, Triangle6};
    use Element::{BBar, Bilinear, NodalVolume};
    let (stress, ring) = (Some(Plane::Stress), Some(Plane::Axisymmetric));
    for (kind, element, plane, nu, n, nodal, surface) in [
        (Quadrilateral, Bilinear, None, 0.3, 8, [0.006, 1.8], [0.0002, 1.9]),
        (Quadrilateral, Bilinear, stress, 0.3, 8, [0.006, 1.8], [0.0002, 1.9]),
        (Quadrilateral, Bilinear, ring, 0.3, 8, [0.006, 1.7], [0.0003, 1.9]),
        (Quadrilateral, BBar, None, 0.499, 8, [0.006, 1.8], [0.0002, 1.9]),
        (Triangle, Bilinear, None, 0.3, 8, [0.01, 1.5], [0.006, 1.5]),
        (Triangle, Bilinear, stress, 0.3, 8, [0.009, 1.5], [0.005, 1.5]),
        (Triangle, Bilinear, ring, 0.3, 8, [0.008, 1.5], [0.001, 1.2]),
        (Triangle, NodalVolume, None, 0.499, 8, [0.03, 0.8], [0.09, 0.9]),
        (Triangle6, Bilinear, None, 0.3, 4, [0.007, 1.7], [0.001, 1.7]),
        (Triangle6, Bilinear, ring, 0.3, 4, [0.003, 2.0], [0.001, 1.3]),
        (Triangle6, NodalVolume, None, 0.499, 4, [0.006, 1.9], [0.001, 1.7]),
        (Hexahedron, Bilinear, None, 0.3, 4, [0.03, 1.5], [0.001, 1.8]),
        (Prism, Bilinear, None, 0.3, 8, [0.01, 1.5], [0.006, 1.4]),
        (Tetrahedron, Bilinear, None, 0.3, 8, [0.014, 1.0], [0.014, 1.0]),
        (Tetrahedron10, Bilinear, None, 0.3, 4, [0.007, 2.0], [0.003, 1.3]),
    ] {
        let errors = |inside| [n, 2 * n].map(|n| tube_errors(kind, element, plane, nu, n, inside));
        let name = format!("{kind:?} {element:?} {plane:?} {nu} {n}");
        falls(&format!("{name}, nodes"), errors(Inside::Pressure).map(|[nodal, _]| nodal), nodal[0], nodal[1]);
        falls(&format!("{name}, along"), errors(Inside::Core).map(|[_, along]| along), surface[0], surface[1]);
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
        2 => body.with_support(Support::new("left", &[Axis::Y]).at([0.0, 0.0])),
        _ => body
            .with_support(Support::new("left", &[Axis::Y, Axis::Z]).at([0.0, 0.0, 0.0]))
            .with_support(Support::new("left", &[Axis::Z]).at([0.0, 1.0, 0.0])),
    };
    let Solved { model, nodal, .. } = solved(&body);
    let off = |(x, stress): (&[f64; 3], &[f64; 6])| (stress[0] / PRESSURE - (1.0 - 2.0 * x[1])).abs();
    // The ends are not loaded as a bent beam is within the size of an element.
    let inside = |(x, _): &(&[f64; 3], &[f64; 6])| (0.25..=0.75).contains(&x[0]);
    model.mesh.nodes.iter().zip(&nodal).filter(inside).map(off).fold(0.0, f64::max)
}

#[test]
fn the_stress_of_a_bent_block() {
    use CellKind::{Hexahedron, Prism, Quadrilateral, Tetrahedron, Tetrahedron10, Triangle, Triangle6};
    for (kind, n, most, least) in [
        (Quadrilateral, 8, 0.005, 1.8),
        (Triangle, 8, 0.035, 1.4),
        (Hexahedron, 4, 0.02, 1.3),
        (Prism, 4, 0.11, 1.1),
        (Tetrahedron, 4, 0.14, 1.1),
    ] {
        falls(&format!("bent {kind:?} {n}"), [n, 2 * n].map(|n| bent(kind, n)), most, least);
    }
    // A linear stress is in the space of these cells.
    for kind in [Triangle6, Tetrahedron10] {
        assert!(bent(kind, 2) < 1e-12, "{kind:?}");
    }
}

/// The kept values of an increment.
struct Kept {
    /// The sums of the normal and of the tangential forces, N/m.
    pressed: f64,
    pushed: f64,
    along: Vec<SurfaceStress>,
    nodal: Vec<[f64; 6]>,
}

impl Kept {
    fn of(model: &Model, step: &IncrementView<'_>) -> Self {
        let sum = |p: &[f64]| p.iter().sum::<f64>();
        let time = step.record.time;
        let moved = model.displacements(time, &step.state.u).unwrap();
        Kept {
            pressed: sum(&step.state.p_n),
            pushed: -sum(&step.state.p_t),
            along: model.surface_stresses(time, step.state),
            nodal: model.nodal_stresses_at(time, &moved).unwrap(),
        }
    }
}

/// The errors along a surface, relative to the largest pressure p₀ in the root mean square: of the stress along the
/// surface, and of the nodal stress; and that of the largest tension, relative to itself.
#[derive(Clone, Copy)]
struct Errors {
    along: f64,
    nodal: f64,
    peak: f64,
}

/// Hertz' contact of a cylinder, pushed sideways until it slides, after Cattaneo and Mindlin: along the surface the stress
/// is `-p` under the pressure alone, and `2 p₀ √(μ Q / P)` at the edge behind which the surface is drawn. The errors over
/// five half-widths under the pressure alone, with partial slip, and when all nodes slide.
fn cylinder([cells, element]: [&str; 2], elements: usize) -> [Errors; 3] {
    let mesh = format!("mesh.elements=[[{0},{1},{0}],{2}]", 4 * elements / 3, 2 * elements, 16 * elements / 9);
    let motion = "contact.obstacle.motion.translation=[[1,0,0],[2,2.1e-5,0],[3,1e-4,0]]";
    let [cells, element] = [("cells", cells), ("element", element)].map(|(key, value)| format!("mesh.{key}={value:?}"));
    let scene = common::scene("cattaneo_mindlin.toml", &[&mesh, &cells, &element, motion]);
    let model = discretise(&scene).unwrap();
    let mut states = Vec::new();
    let outcome = common::run_default(&scene, &model, &mut each(|step| states.push(Kept::of(&model, step))));
    assert_eq!(outcome.status, Status::Converged);
    let (mu, nu, middle) = (0.4, 0.499_f64, 5.0);
    // Each path has two increments.
    [1, 3, 5].map(|k| {
        let Kept { pressed, pushed, along, nodal } = &states[k];
        let hertz = Hertz::line(*pressed, 100.0, 210e9 / (1.0 - nu * nu));
        let q = (pushed / (mu * pressed)).clamp(0.0, 1.0);
        let c = hertz.stick(q);
        // The stress of a shear `q₀ √(1 - s²)`, over 2 q₀.
        let drawn = |s: f64| if s.abs() <= 1.0 { s } else { s - s.signum() * (s * s - 1.0).sqrt() };
        let of_stick = |x: f64| if c > 1e-3 * hertz.a { c / hertz.a * drawn(x / c) } else { 0.0 };
        let exact = |x: f64| -hertz.pressure(x) - 2.0 * mu * hertz.p0 * (drawn(x / hertz.a) - of_stick(x));
        let (mut sums, mut weight, mut most) = ([0.0; 2], 0.0, f64::MIN);
        for (contact, along) in model.contact.nodes.iter().zip(along) {
            let x = contact.position[0] - middle;
            if x.abs() < 2.5 * hertz.a {
                for (sum, found) in sums.iter_mut().zip([along.along, nodal[contact.node][0]]) {
                    *sum += contact.weight * ((found - exact(x)) / hertz.p0).powi(2);
                }
                weight += contact.weight;
                most = most.max(along.along);
            }
        }
        let [along, nodal] = sums.map(|sum| (sum / weight).sqrt());
        Errors { along, nodal, peak: most / (2.0 * mu * hertz.p0 * q.sqrt()) - 1.0 }
    })
}

/// Where the surface begins to be drawn its stress has an infinite slope, which limits the order to one, and that of the
/// peak to a half. The finite block adds 0.4 % of p₀.
#[test]
fn the_stress_along_a_fretted_surface() {
    for (kind, most) in [
        (["quadrilateral", "b-bar"], 0.011),
        (["triangle", "nodal-volume"], 0.015),
        (["triangle6", "nodal-volume"], 0.027),
    ] {
        let sizes = if kind[0] == "triangle6" { [9, 18] } else { [18, 36] };
        let errors = sizes.map(|n| cylinder(kind, n));
        for (k, state) in ["pressed", "partial slip", "sliding"].iter().enumerate() {
            let [coarse, fine] = errors.map(|errors| errors[k]);
            let name = format!("{kind:?} {sizes:?} {state}");
            falls(&format!("{name}, nodes"), [coarse.nodal, fine.nodal], 0.02, 0.6);
            falls(&format!("{name}, along"), [coarse.along, fine.along], most, if k == 0 { 0.3 } else { 0.8 });
            if k > 0 {
                println!("{name}: peak {:.1} %, {:.1} %", 100.0 * coarse.peak, 100.0 * fine.peak);
                assert!(fine.peak < 0.0 && fine.peak.abs() < 0.8 * coarse.peak.abs() && fine.peak.abs() < 0.3);
            }
        }
    }
}
