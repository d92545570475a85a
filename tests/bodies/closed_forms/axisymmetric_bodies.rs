//! Bodies of revolution against closed forms: pressure, weight, spin, heat, beds and supports.

use crate::common::prelude::*;

/// All elements there are.
pub const ELEMENTS: [(CellKind, Element); 5] = [
    (CellKind::Quadrilateral, Element::Bilinear),
    (CellKind::Quadrilateral, Element::BBar),
    (CellKind::Triangle, Element::Bilinear),
    (CellKind::Triangle, Element::NodalVolume),
    (CellKind::Triangle6, Element::Bilinear),
];

/// A ring, or a cylinder where `inner` is 0, of height `size[1]`.
pub fn ring(inner: f64, size: [f64; 2], elements: [usize; 2], cells: CellKind, material: Material) -> Description {
    let source = MeshSource::segmented(&size.map(|x| vec![x]), &elements.map(|n| vec![n]), None, Some(cells)).unwrap();
    let MeshSource::Block { axes, cells, .. } = source else { panic!() };
    let mesh = MeshSource::Block { axes, cells, origin: Some([inner, 0.0].into()) };
    Description::new(mesh, material.in_plane(Plane::Axisymmetric), vec![1.0])
}

pub struct Solved {
    pub model: Model,
    pub report: RunReport,
    /// The displacements of all nodes at the end.
    pub end: Vec<[f64; 3]>,
}

/// Solves, and asks that forces along the axis balance.
pub fn solved(description: &Description) -> Solved {
    let mut recording = Recording::last();
    let (model, report) = solved_by_bn(description, &mut recording);
    for record in &report.reactions {
        let equilibrium = report.increments[record.index - 1].kkt.equilibrium;
        assert!(record.balance < 1e-12_f64.max(10.0 * equilibrium), "{equilibrium:e} {record:?}");
    }
    let last = &recording.increments[0];
    let end = model.displacements(last.record.time, &last.state.u).unwrap();
    Solved { model, report, end }
}

impl Solved {
    /// The largest difference of displacements from what they are to be.
    fn off(&self, exact: impl Fn([f64; 3]) -> [f64; 2]) -> f64 {
        let off = |(x, u): (&[f64; 3], &[f64; 3])| {
            let exact = exact(*x);
            (u[0] - exact[0]).abs().max((u[1] - exact[1]).abs())
        };
        self.model.mesh.nodes.iter().zip(&self.end).map(off).fold(0.0, f64::max)
    }

    /// The force of support `k` on the body along the axis, all around.
    pub fn reaction(&self, k: usize) -> f64 {
        self.report.reactions.last().unwrap().supports[k].force[1]
    }
}

fn formula(text: &str) -> Field {
    Formula::parse(text).unwrap().into()
}

const YOUNG: f64 = 200e9;
const NU: f64 = 0.3;

/// The energy (J) of the difference of the strains from those of the radial displacement `u` with its `slope`.
fn off(found: &Solved, u: impl Fn(f64) -> f64, slope: impl Fn(f64) -> f64) -> f64 {
    let (mesh, law) = (&found.model.mesh, Elasticity::isotropic(YOUNG, NU));
    let mut all = 0.0;
    for cell in &mesh.cells {
        let nodes = mesh.points(&cell.nodes);
        let moved: Vec<_> = cell.nodes.iter().map(|&node| found.end[node]).collect();
        for (point, weight) in fine_quadrature(cell.kind) {
            let r: f64 = shape(cell.kind, point).iter().zip(&nodes).map(|(n, x)| n * x[0]).sum();
            let (_, area) = gradients(cell.kind, point, &nodes).unwrap();
            let strain = strain_at(cell.kind, mesh.geometry, point, &nodes, &moved, Element::Bilinear).unwrap();
            let exact = [slope(r), 0.0, u(r) / r, 0.0, 0.0, 0.0];
            let apart = std::array::from_fn(|c| strain[c] - exact[c]);
            all += weight * area * mesh.geometry.depth([r, 0.0, 0.0]) * law.energy_density(&apart);
        }
    }
    all
}

/// Lamé's thick cylinder under internal pressure, its ends held: displacement, hoop stress, reaction, energy; and what the error of the
/// mesh is estimated at.
#[test]
fn thick_cylinder() {
    let (a, b, h, p) = (0.1_f64, 0.2_f64, 0.02, 100e6);
    let c = p * a * a / (b * b - a * a);
    let u = |r: f64| (1.0 + NU) / YOUNG * c * ((1.0 - 2.0 * NU) * r + b * b / r);
    let slope = |r: f64| (1.0 + NU) / YOUNG * c * ((1.0 - 2.0 * NU) - b * b / (r * r));
    for (cells, element) in ELEMENTS {
        let quadratic = cells.is_quadratic();
        let errors = [8, 16].map(|n| {
            let mut body = ring(a, [b - a, h], [n, n / 4], cells, Material::new(YOUNG, NU))
                .with_support(Support::new("bottom", &[Axis::Y]))
                .with_support(Support::new("top", &[Axis::Y]))
                .load(Action::Pressure { boundary: "left".into(), pressure: p.into() }.into());
            body.element = element;
            let found = solved(&body);
            let inner = found.model.mesh.nodes.iter().position(|x| x[0] == a).unwrap();
            let displacement = found.end[inner][0] / u(a) - 1.0;
            // The whole force on the end, in N.
            let end = found.reaction(1) / (2.0 * NU * c * PI * (b * b - a * a));
            assert!((end - 1.0).abs() < 1e-12, "{cells:?} {element:?}: {end}");
            let stresses = found.model.centre_stresses(1.0, &found.end).unwrap();
            let hoop = stresses.iter().enumerate().map(|(e, s)| {
                let r = found.model.mesh.centre(e)[0];
                (s[2] / (c * (1.0 + b * b / (r * r))) - 1.0).abs()
            });
            let hoop = hoop.fold(0.0, f64::max);
            let exact = 0.5 * p * 2.0 * PI * a * h * u(a);
            let energy = ((exact - found.report.increments[0].strain_energy).abs() / exact).sqrt();
            // Three points are not exact for r times squares of strains of second order, so that their energy is nearer than they are.
            let energy = if quadratic { (off(&found, u, slope) / exact).sqrt() } else { energy };
            let estimate = found.report.estimates.discretisation.unwrap();
            println!(
                "{cells:?} {element:?} {n}: u(a) {displacement:.2e}, hoop stress {hoop:.2e}, end {:.2e}, error {energy:.3e}, \
                 estimated {estimate:.3e}, {:.3}",
                end - 1.0,
                estimate / energy
            );
            assert!((0.5..2.0).contains(&(estimate / energy)), "{cells:?} {element:?}: {estimate} {energy}");
            (displacement.abs(), hoop)
        });
        let [coarse, fine] = errors;
        let [most, falls] = if quadratic { [2e-5, 5.0] } else { [3e-3, 2.5] };
        assert!(fine.0 < most && fine.0 < coarse.0 / falls, "{cells:?} {element:?}: {errors:?}");
        assert!(fine.1 < if quadratic { 2e-3 } else { 3e-2 }, "{cells:?} {element:?}: {errors:?}");
    }
}

/// What is free expands without stress, on the axis and off it.
#[test]
fn warm_discs_are_free_of_stress() {
    for inner in [0.0, 0.05] {
        for (cells, element) in ELEMENTS {
            let material = Material { expansion: Some(12e-6), ..Material::new(YOUNG, NU) };
            let mut body = ring(inner, [0.1, 0.02], [5, 3], cells, material)
                .with_support(Support::new("bottom", &[Axis::Y]))
                .load(Action::Temperature(Field::from(50.0)).into());
            body.element = element;
            let found = solved(&body);
            let off = found.off(|[x, y, _]| [6e-4 * x, 6e-4 * y]);
            assert!(off < 1e-15, "{cells:?} {element:?}: {off:e}");
            let stresses = found.model.centre_stresses(1.0, &found.end).unwrap();
            let most = stresses.iter().flatten().fold(0.0_f64, |m, s| m.max(s.abs()));
            assert!(most < 1e-6 * 50.0 * 12e-6 * YOUNG, "{cells:?} {element:?}: {most:e}");
            assert!(found.report.increments[0].strain_energy < 1e-9);
        }
    }
}

/// A long cylinder that spins, its ends held: all stresses are those of a plane disc, also next to the axis, where the two in the section are equal.
#[test]
fn spinning_cylinder() {
    let (b, density, speed) = (0.2_f64, 7850.0, 500.0);
    let rim = (1.0 - 2.0 * NU) / (4.0 * (1.0 - NU)) * density * speed * speed * b * b;
    let material = Material { density: Some(density), ..Material::new(YOUNG, NU) };
    for (cells, within) in [(CellKind::Quadrilateral, 5e-3), (CellKind::Triangle, 2e-2), (CellKind::Triangle6, 1e-3)] {
        let found = solved(
            &ring(0.0, [b, 0.02], [20, 2], cells, material.clone())
                .with_support(Support::new("bottom", &[Axis::Y]))
                .with_support(Support::new("top", &[Axis::Y]))
                .load(Action::Spin { axis: None, through: None, speed }.into()),
        );
        let unit = density * speed * speed / (8.0 * (1.0 - NU));
        let along_r = |r: f64| unit * (3.0 - 2.0 * NU) * (b * b - r * r);
        let around = |r: f64| unit * ((3.0 - 2.0 * NU) * b * b - (1.0 + 2.0 * NU) * r * r);
        let stresses = found.model.centre_stresses(1.0, &found.end).unwrap();
        let off = stresses.iter().enumerate().map(|(e, stress)| {
            let r = found.model.mesh.centre(e)[0];
            (stress[0] - along_r(r)).abs().max((stress[2] - around(r)).abs()) / around(0.0)
        });
        let off = off.fold(0.0, f64::max);
        println!("spinning, {cells:?}: stresses {off:.2e}");
        assert!(off < within, "{cells:?}: {off:e}");
        // At the rim σ_r = 0 and σ_z = ν σ_θ, so that E ε_θ = (1 - ν²) σ_θ.
        let exact = b / YOUNG * (rim - NU * NU * rim);
        let node = found.model.mesh.nodes.iter().position(|x| x[0] == b).unwrap();
        assert!((found.end[node][0] / exact - 1.0).abs() < within, "{cells:?} {}", found.end[node][0] / exact - 1.0);
    }
}

/// A cylinder on a bed, pressed by its weight and a force: each is told in N, all around.
#[test]
fn forces_are_those_all_round() {
    let (r, h, density, g, bed) = (0.3_f64, 0.5, 7850.0, 9.81, 1e9);
    let area = PI * r * r;
    for (cells, element) in ELEMENTS {
        let material = Material { density: Some(density), ..Material::new(YOUNG, 0.0) };
        let mut body = ring(0.0, [r, h], [4, 5], cells, material)
            .spring(Bed::Axes { at: Where::Boundary("bottom".into()), stiffness: vec![0.0, bed] })
            .load(Action::Acceleration(vec![0.0, -g]).into())
            .load(Action::Force { at: Where::Boundary("top".into()), force: vec![0.0, -1e5] }.into())
            .load(Load::new("right", &[0.0, -1e4]));
        body.element = element;
        let found = solved(&body);
        let weight = density * g * area * h;
        let side = 1e4 * 2.0 * PI * r * h;
        let forces: Vec<f64> = found.model.forces_of_loads().map(|f| f[1]).collect();
        for (found, exact) in forces.iter().zip([-weight, -1e5, -side]) {
            assert!((found / exact - 1.0).abs() < 1e-13, "{cells:?}: {forces:?}");
        }
        let on_bed = found.report.reactions[0].springs[0].force[1];
        assert!((on_bed / (weight + 1e5 + side) - 1.0).abs() < 1e-9, "{cells:?}: {on_bed}");
        assert_eq!(found.report.reactions[0].springs[0].moment, [0.0]);
    }
}

/// A cylinder is pressed by supports that move: carried along as a whole, the strain is exact; those on the axis need no support, and
/// what is said of them along x is said already.
#[test]
fn supports_move_along_the_axis() {
    let (r, h, to) = (0.3_f64, 0.5, -1e-3);
    for (cells, element) in ELEMENTS {
        for fixed in [&[Axis::Y][..], &[Axis::X, Axis::Y]] {
            let nu = if fixed.len() == 1 { NU } else { 0.0 };
            let mut body = ring(0.0, [r, h], [4, 5], cells, Material::new(YOUNG, nu))
                .with_support(Support::new("bottom", fixed).moved(&[&[0.0; 2][..fixed.len() - 1], &[0.5e-3]].concat()))
                .with_support(
                    Support::new("top", fixed).moved(&[&[0.0; 2][..fixed.len() - 1], &[0.5e-3 + to]].concat()),
                )
                .with_support(Support::new("left", &[Axis::X]));
            body.element = element;
            let found = solved(&body);
            let strain = to / h;
            let off = found.off(|[x, y, _]| [-nu * strain * x, 0.5e-3 + strain * y]);
            assert!(off < 1e-17 + 1e-13 * to.abs(), "{cells:?} {element:?}: {off:e}");
            let force = YOUNG * strain * PI * r * r;
            assert!((found.reaction(1) / force - 1.0).abs() < 1e-11, "{cells:?}: {} {force}", found.reaction(1));
            assert_eq!(found.report.reactions[0].supports[2].force, [0.0, 0.0]);
        }
    }
}

/// Oblique supports that reach the axis: there what is along y is left of them.
#[test]
fn a_cone_on_its_seat() {
    let mut body = ring(0.0, [0.3, 0.5], [4, 5], CellKind::Quadrilateral, Material::new(YOUNG, NU));
    body = body.with_support(Support::along("bottom", [0.6, -0.8], 4e-4)).load(Load::new("top", &[0.0, -1e6]));
    let found = solved(&body);
    for (x, u) in found.model.mesh.nodes.iter().zip(&found.end).filter(|(x, _)| x[1] == 0.0) {
        assert!((0.6 * u[0] - 0.8 * u[1] - 4e-4).abs() < 1e-16, "{x:?} {u:?}");
        assert!(x[0] > 0.0 || u[0] == 0.0);
    }
}

/// On the axis the strain around it is the slope of the displacement, in nodes as well as beside them.
#[test]
fn strains_on_the_axis() {
    for kind in [CellKind::Triangle, CellKind::Quadrilateral, CellKind::Triangle6] {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [1.2, 1.1, 0.0], [0.0, 1.0, 0.0]];
        let [a, b, _, c] = corners;
        let middle = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| 0.5 * (a[k] + b[k]));
        let triangle = [a, b, c, middle(a, b), middle(b, c), middle(c, a)];
        let all = if kind == CellKind::Quadrilateral { &corners[..] } else { &triangle };
        let nodes = all[..kind.nodes()].to_vec();
        let moved: Vec<[f64; 3]> = nodes.iter().map(|[x, y, _]| [0.3 * x, -0.2 * y, 0.0]).collect();
        let on_axis = if kind == CellKind::Quadrilateral { [-1.0, -1.0, 0.0] } else { [0.0; 3] };
        for point in [on_axis, kind.centre()] {
            let strain = strain_at(kind, Geometry::Axisymmetric, point, &nodes, &moved, Element::Bilinear).unwrap();
            let exact = [0.3, -0.2, 0.3, 0.0, 0.0, 0.0];
            assert!(strain.iter().zip(exact).all(|(s, e)| (s - e).abs() < 1e-15), "{kind:?}: {strain:?}");
        }
    }
}

/// Forces are in N in results, stiffnesses at points in N/mm.
#[test]
fn units_are_not_per_depth() {
    let mm = Units::new(LengthUnit::Millimetre, StressUnit::Megapascal);
    let point = |x: [f64; 2]| Where::Point(x.into());
    let body = ring(0.0, [0.3, 0.5], [3, 5], CellKind::Quadrilateral, Material::new(200e9, NU))
        .spring(Bed::Axes { at: point([0.0, 0.0]), stiffness: vec![0.0, 1e9] })
        .load(Action::Force { at: point([0.0, 0.5]), force: vec![0.0, -2e3] }.into());
    let found = solved(&Description { units: mm, ..body });
    assert_eq!(found.model.units().name(Quantity::Force), "N");
    assert_eq!(found.model.units().name(Quantity::Energy), "mJ");
    assert_eq!(found.model.units().name(Quantity::Spring), "N/mm");
    // The spring is 1e9 N/m, so that it gives by 2 um.
    let foot = found.model.mesh.nodes.iter().position(|x| x[0] == 0.0 && x[1] == 0.0).unwrap();
    assert!((found.end[foot][1] / -2e-6 - 1.0).abs() < 1e-9, "{:?}", found.end[foot]);
    let load = &found.report.reactions[0].loads[0].force;
    assert!((load[1] + 2e3).abs() < 1e-9, "{load:?}");
    // A load by a formula of the radius.
    let by_formula = ring(0.0, [0.3, 0.5], [3, 5], CellKind::Quadrilateral, Material::new(200e9, NU))
        .with_support(Support::new("bottom", &[Axis::Y]))
        .load(Action::Pressure { boundary: "top".into(), pressure: formula("1e6 * x") }.into());
    let sum = Model::build(&by_formula).unwrap().forces_of_loads().next().unwrap()[1];
    assert!((sum / -(2.0 * PI * 1e6 * 0.3_f64.powi(3) / 3.0) - 1.0).abs() < 1e-13, "{sum}");
}

/// A bonded disc of rubber: by how much elements that lock are too stiff, and what that is estimated at, before the run and after it.
#[test]
fn locking_is_seen() {
    for poisson in [0.45, 0.49, 0.499] {
        let disc = |cells, element, n: usize| {
            let mut body = ring(0.0, [1.0, 0.5], [2 * n, n], cells, Material::new(1e6, poisson))
                .with_support(Support::new("bottom", &[Axis::X, Axis::Y]))
                .with_support(Support::new("top", &[Axis::X, Axis::Y]).moved(&[0.0, -1e-3]));
            body.element = element;
            let found = solved(&body);
            (found.reaction(1), found.report)
        };
        let (exact, _) = disc(CellKind::Triangle6, Element::Bilinear, 24);
        for (cells, element) in ELEMENTS {
            for n in [4, 8] {
                let (force, report) = disc(cells, element, n);
                let (error, estimate) = (force / exact - 1.0, report.estimates.locking);
                println!(
                    "bonded disc, {cells:?} {element:?}, nu {poisson}, {n}: too stiff by {error:.4}, estimated {estimate:.4?}"
                );
                let locks = element == Element::Bilinear && !cells.is_quadratic();
                assert_eq!(estimate.is_some(), locks);
                if let Some(estimate) = estimate.filter(|_| error < 1.0) {
                    assert!((0.4..2.5).contains(&(estimate / error)), "{cells:?} {poisson} {n}: {error} {estimate}");
                } else if !locks {
                    assert!(error < 0.25, "{cells:?} {element:?} {poisson} {n}: {error}");
                }
            }
        }
    }
}
