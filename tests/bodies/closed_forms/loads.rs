//! Loads, supports and springs against closed forms, and the balance of all forces.

use crate::common::prelude::*;

const BOTH: [Axis; 2] = [Axis::X, Axis::Y];

struct Solved {
    model: Model,
    report: RunReport,
    /// The displacements of all nodes at the end of each increment.
    displacements: Vec<Vec<[f64; 3]>>,
}

/// Solves, and asks of every increment that it converges and that its forces balance.
fn solved(description: &Description) -> Solved {
    let mut recording = Recording::all();
    let (model, report) = solved_by_bn(description, &mut recording);
    for record in &report.reactions {
        let solved = report.increments[record.index - 1].kkt.equilibrium;
        assert!(record.balance < 1e-12_f64.max(10.0 * solved), "{solved:e} {record:?}");
    }
    let displacements =
        recording.increments.iter().map(|kept| model.displacements(kept.record.time, &kept.state.u).unwrap());
    let displacements = displacements.collect();
    Solved { model, report, displacements }
}

impl Solved {
    fn end(&self) -> &[[f64; 3]] {
        self.displacements.last().unwrap()
    }

    /// The reaction of support `k` at the end.
    fn reaction(&self, k: usize) -> &[f64] {
        &self.report.reactions.last().unwrap().supports[k].force
    }

    /// The displacement at the end of the node at `x`.
    fn at(&self, x: [f64; 3]) -> [f64; 3] {
        let distance = |node: &usize| norm([0, 1, 2].map(|c| self.model.mesh.nodes[*node][c] - x[c]));
        let node = (0..self.model.mesh.nodes.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
        assert!(distance(&node) < 1e-9);
        self.end()[node]
    }
}

fn formula(text: &str) -> Field {
    Formula::parse(text).unwrap().into()
}

const YOUNG: f64 = 200e9;
const NU: f64 = 0.3;

fn ring_of(material: Material, n: usize) -> Description {
    Description::new(ring(0.1, 0.2, n), material.in_plane(Plane::Stress), vec![1.0])
        .support("x axis", &[Axis::Y])
        .support("y axis", &[Axis::X])
}

/// The errors of a radial displacement at the inner radius with 8, 16 and 32 elements: each is to be a quarter of the one before.
fn converges(what: &str, load: &Load, material: &Material, exact: f64) {
    let errors = [8, 16, 32].map(|n| {
        let ring = solved(&ring_of(material.clone(), n).load(load.clone()));
        ring.at([0.1, 0.0, 0.0])[0] / exact - 1.0
    });
    println!("{what}: {errors:.6?}, order {:.2}", (errors[1] / errors[2]).log2());
    let [coarse, middle, fine] = errors.map(f64::abs);
    assert!(middle < 3e-3 && middle < 0.26 * coarse && fine < 0.26 * middle, "{errors:?}");
}

#[test]
fn ring_under_pressure() {
    let (a, b, p) = (0.1_f64, 0.2_f64, 5e6);
    let exact = p * a / YOUNG * ((a * a + b * b) / (b * b - a * a) + NU);
    let pressure = Action::Pressure { boundary: "inner".to_string(), pressure: p.into() };
    converges("ring under pressure", &pressure.into(), &Material::new(YOUNG, NU), exact);
    // As a traction by a formula.
    let along = |c: &str| formula(&format!("5e6 * {c} / sqrt(x^2 + y^2)"));
    let traction = Action::Traction { boundary: "inner".to_string(), traction: vec![along("x"), along("y")] };
    converges("the same by tractions", &traction.into(), &Material::new(YOUNG, NU), exact);
}

#[test]
fn rotating_ring() {
    let (a, b, density, speed) = (0.1_f64, 0.2_f64, 7850.0, 500.0);
    // u(a) of a rotating disk with a hole in plane stress: ρ ω² a ((3 + ν) b² + (1 - ν) a²) / (4 E).
    let exact = density * speed * speed * a / (4.0 * YOUNG) * ((3.0 + NU) * b * b + (1.0 - NU) * a * a);
    let material = Material { density: Some(density), ..Material::new(YOUNG, NU) };
    converges(
        "rotating ring",
        &Action::Spin { axis: None, through: Some([0.0, 0.0].into()), speed }.into(),
        &material,
        exact,
    );
}

#[test]
fn ring_warmed_from_within() {
    let (a, b, expansion) = (0.1_f64, 0.2_f64, 12e-6);
    // T = r²: u(a) = 2 α a / (b² - a²) ∫ T r dr = α a (a² + b²) / 2 on a free surface.
    let exact = 0.5 * expansion * a * (a * a + b * b) * 1e4;
    let material = Material { expansion: Some(expansion), ..Material::new(YOUNG, NU) };
    converges("warm ring", &Action::Temperature(formula("1e4 * (x^2 + y^2)")).into(), &material, exact);
}

/// A uniform temperature strains a free body without stress, and stresses a held one without strain.
#[test]
fn warm_bars() {
    for plane in [Plane::Strain, Plane::Stress] {
        let material = Material { expansion: Some(1e-5), ..Material::new(YOUNG, NU).in_plane(plane) };
        let bar = Description::new(MeshSource::block([2.0, 1.0], [4, 2]), material, vec![0.5, 1.0])
            .support("left", &[Axis::X])
            .support("bottom", &[Axis::Y])
            .load(Action::Temperature(100.0.into()).into());
        // In plane strain, what is held across pushes the rest: (1 + ν) α T.
        let across = if plane == Plane::Strain { 1.0 + NU } else { 1.0 };
        let free = solved(&bar);
        assert!((free.at([2.0, 1.0, 0.0])[0] / (across * 2e-3) - 1.0).abs() < 1e-12);
        let stress = free.model.centre_stresses(1.0, free.end()).unwrap();
        let zz = if plane == Plane::Strain { -YOUNG * 1e-3 } else { 0.0 };
        for s in stress {
            assert!((s[2] - zz).abs() < 1e-3 && s[0].abs().max(s[1].abs()).max(s[3].abs()) < 1e-3, "{s:?}");
        }
        let supported = solved(&bar.clone().support("right", &[Axis::X]).support("top", &[Axis::Y]));
        // Nothing moves: the stresses are those of a body pressed back by α T along all that is held.
        let sides = if plane == Plane::Strain { 1.0 - 2.0 * NU } else { 1.0 - NU };
        let expected = -YOUNG * 1e-3 / sides;
        let stress = supported.model.centre_stresses(1.0, supported.end()).unwrap();
        assert!(stress.iter().all(|s| (s[0] / expected - 1.0).abs() < 1e-12), "{:?}", stress[0]);
        // Support 2 is on the right, 1 m high.
        assert!((supported.reaction(2)[0] / expected - 1.0).abs() < 1e-12);
    }
}

/// A bar that hangs by its top, its density by group and its gravity for all: `u = ρ g L² / (2 E)` at the lower end.
#[test]
fn bar_under_gravity() {
    let material = Material { density: Some(1000.0), ..Material::new(1e6, 0.0) };
    for n in [1, 4] {
        let bar = Description::new(MeshSource::block([0.5, 2.0], [1, n]), material.clone(), vec![1.0])
            .support("top", &[Axis::Y])
            .support("left", &[Axis::X])
            .load(Action::Acceleration(vec![0.0, -10.0]).into());
        let bar = solved(&bar);
        assert!((bar.at([0.0, 0.0, 0.0])[1] / (-1000.0 * 10.0 * 4.0 / 2e6) - 1.0).abs() < 1e-12);
        assert!((bar.reaction(0)[1] / (1000.0 * 10.0) - 1.0).abs() < 1e-12);
    }
}

/// A foundation under a uniform pressure gives way by `p / k`; a long beam on it under a force in its middle by `F β / (2 k)`,
/// `β⁴ = k / (4 E I)` (Hetényi 1946), which is for slender beams.
#[test]
fn beams_on_a_foundation() {
    let bed = |boundary: &str| Bed::surface(boundary, 1e7, 1e6);
    let slab = Description::new(MeshSource::block([2.0, 0.5], [8, 2]), Material::new(1e9, 0.3), vec![1.0])
        .spring(bed("bottom"))
        .load(Load::new("top", &[0.0, -1e4]));
    let slab = solved(&slab);
    assert!(slab.model.constraints.rigid_motions.is_empty());
    let spring = &slab.report.reactions[0].springs[0].force;
    assert!((spring[1] / 2e4 - 1.0).abs() < 1e-12 && spring[0].abs() < 1e-6, "{spring:?}");
    let [left, right] = [0.0, 2.0].map(|x| slab.at([x, 0.0, 0.0])[1]);
    assert!((left + 1e-3).abs() < 2e-5 && (left - right).abs() < 1e-12, "{left}");

    let (height, young, k) = (0.1_f64, 200e9, 1e8);
    let beta = (k / (4.0 * young * height.powi(3) / 12.0)).powf(0.25);
    let exact = -1e5 * beta / (2.0 * k);
    let material = Material::new(young, 0.0).in_plane(Plane::Stress);
    let beam = Description::new(MeshSource::block([10.0, height], [400, 4]), material, vec![1.0])
        .element(stickslip::body::fem::Element::BBar)
        .spring(Bed::surface("bottom", k, 1.0));
    assert!(Model::build(&beam).is_err(), "B-bar has no plane stress");
    let force = Action::Force { at: Where::Point([5.0, height].into()), force: vec![0.0, -1e5] };
    let beam = Description { element: stickslip::body::fem::Element::Bilinear, ..beam }.load(force.into());
    let beam = solved(&beam);
    let deflection = beam.at([5.0, 0.0, 0.0])[1];
    println!("beam on a foundation: {:.4}", deflection / exact - 1.0);
    assert!((deflection / exact - 1.0).abs() < 0.03, "{deflection:e} {exact:e}");
}

/// A spring along an axis at a node, and the whole force of a boundary.
#[test]
fn a_body_on_two_springs() {
    let at = |x: f64| Where::Point([x, 0.0].into());
    let body = Description::new(MeshSource::block([1.0, 1.0], [4, 4]), Material::new(1e7, 0.3), vec![1.0])
        .spring(Bed::Axes { at: at(0.0), stiffness: vec![1e3, 1e3] })
        .spring(Bed::Axes { at: at(1.0), stiffness: vec![0.0, 3e3] })
        .load(Action::Force { at: Where::Boundary("top".to_string()), force: vec![0.0, -6.0] }.into());
    let body = solved(&body);
    assert!((body.at([0.0, 0.0, 0.0])[1] + 3e-3).abs() < 1e-12 && (body.at([1.0, 0.0, 0.0])[1] + 1e-3).abs() < 1e-12);
    let springs = &body.report.reactions[0].springs;
    assert!(springs.iter().all(|spring| (spring.force[1] - 3.0).abs() < 1e-9), "{springs:?}");
}

/// A block turned by 30° with its supports, loads and obstacle gives the block's answer, turned.
#[test]
fn oblique_supports() {
    let (s, c) = (0.5_f64, 0.75_f64.sqrt());
    let turn = |[x, y]: [f64; 2]| [c * x - s * y, s * x + c * y];
    let straight = stickslip::body::mesh::block(&[1.0, 1.0], &[6, 6]);
    let mut turned = straight.clone();
    for node in &mut turned.nodes {
        let [x, y] = turn([node[0], node[1]]);
        *node = [x, y, 0.0];
    }
    let body = |mesh: Mesh, turn: &dyn Fn([f64; 2]) -> [f64; 2]| {
        let plane = Shape::PlaneThrough { through: turn([0.0, -1e-5]).into() };
        let normal = Some(turn([0.0, -1.0]).into());
        Description::new(mesh, Material::new(210e9, 0.3), vec![0.5, 1.0])
            .with_support(Support::along("right", turn([1.0, 0.0]), -2e-5).over(&[[0.5, 0.0], [1.0, 1.0]]))
            .with_support(Support::normal("left"))
            .contact("bottom", 0.4, Obstacle { normal, ..Obstacle::at_rest(plane) })
            .load(Load::new("top", &turn([1e6, -10e6])).over(&[[0.0, 0.0], [0.5, 1.0]]))
    };
    let [straight, turned] = [solved(&body(straight, &|x| x)), solved(&body(turned, &turn))];
    for (u, v) in straight.end().iter().zip(turned.end()) {
        let [x, y] = turn([u[0], u[1]]);
        assert!((x - v[0]).hypot(y - v[1]) < 1e-10 * 4e-5, "{u:?} {v:?}");
    }
    for k in 0..2 {
        let [x, y] = turn([straight.reaction(k)[0], straight.reaction(k)[1]]);
        let turned = turned.reaction(k);
        assert!(x.hypot(y) > 1e5 && (x - turned[0]).hypot(y - turned[1]) < 1e-9 * 1e7, "{x} {y} {turned:?}");
    }
    assert!(straight.report.forces[1].resultant.sums.sum_p_t.abs() > 1e5);
}

/// In space, too: a cylinder wall held along its normal by nodes, each of another direction.
#[test]
fn a_ring_held_along_its_normals() {
    let material = Material { expansion: Some(1e-5), ..Material::new(YOUNG, NU) };
    let ring = ring_of(material, 16)
        .with_support(Support::normal("inner").moved(&[-1e-5]))
        .load(Action::Temperature(0.0.into()).into());
    let ring = solved(&ring);
    // Every node of the bore has moved by 1e-5 m outwards: the normal of the bore is inwards.
    for (x, u) in ring.model.mesh.nodes.iter().zip(ring.end()).filter(|(x, _)| norm(**x) < 0.1 + 1e-9) {
        let radial = (u[0] * x[0] + u[1] * x[1]) / 0.1;
        // At the ends the normal is that of the last facet.
        let end = x[0].min(x[1]) < 1e-9;
        assert!((radial - 1e-5).abs() < if end { 2e-3 } else { 1e-10 } * 1e-5, "{x:?} {radial:e}");
    }
    // Lamé's pressure for that expansion of the bore.
    let (a, b) = (0.1_f64, 0.2_f64);
    let pressure = 1e-5 * YOUNG / a / ((a * a + b * b) / (b * b - a * a) + NU);
    let [x, y] = ring.reaction(2) else { panic!() };
    assert!((x / (pressure * a) - 1.0).abs() < 0.01 && (y / x - 1.0).abs() < 1e-6, "{x} {y} {pressure}");
}

/// It is the same whether supports press the body on a plane that rests or the plane moves towards the body, along and across;
/// and whether both are carried along, a metre.
#[test]
fn supports_or_obstacles_move() {
    let mesh = || MeshSource::block([1.0, 0.5], [10, 5]);
    let body = || Description::new(mesh(), Material::new(210e9, 0.3), vec![0.25, 0.5, 0.75, 1.0]);
    let press = [[0.0, 0.0], [0.5, 1.0], [1.0, 1.0]];
    let slide = [[0.0, 0.0], [0.5, 0.0], [1.0, 1.0]];
    let path = |x: f64, y: f64| Some(vec![(0.0, [0.0, 0.0].into()), (0.5, [0.0, y].into()), (1.0, [x, y].into())]);
    let moving = |translation| Obstacle { translation, ..Obstacle::plane(1e-6) };
    let obstacle = body().support("top", &BOTH).contact("bottom", 0.3, moving(path(-8e-6, 2e-5)));
    let top = || Support::new("top", &[Axis::Y]).moved(&[-2e-5]).over(&press);
    let across = || Support::new("top", &[Axis::X]).moved(&[8e-6]).over(&slide);
    let supports = body().with_support(top()).with_support(across()).contact("bottom", 0.3, moving(None));
    let carry = [[0.0, 0.0], [1.0, 1.0]];
    let carried = supports.clone().with_support(Support::new("top", &[Axis::X]).moved(&[1.0]).over(&carry));
    assert!(Model::build(&carried).is_err(), "two supports move a node to different places");
    let reference = solved(&obstacle);
    let forces = |solved: &Solved| {
        solved
            .report
            .forces
            .iter()
            .map(|record| record.resultant.sums)
            .flat_map(|s| [s.sum_p_n, s.sum_p_t])
            .collect::<Vec<_>>()
    };
    let expected = forces(&reference);
    assert!(expected[7].abs() > 0.1 * expected[6], "{expected:?}");
    let far = Some(vec![(0.0, [0.0, 0.0].into()), (0.5, [0.5, 0.0].into()), (1.0, [1.0, 0.0].into())]);
    let coupled = body()
        .with_support(Support::new("top", &[Axis::Y]).moved(&[-2e-5]).over(&press))
        .with_support(Support::new("top", &[Axis::X]).moved(&[1.0 + 8e-6]).over(&[
            [0.0, 0.0],
            [0.5, 0.5 / (1.0 + 8e-6)],
            [1.0, 1.0],
        ]))
        .contact("bottom", 0.3, moving(far));
    for (what, other, tolerance) in [("supports", supports, 1e-10), ("carried", coupled, 1e-8)] {
        let other = solved(&other);
        for (a, b) in forces(&other).iter().zip(&expected) {
            assert!((a - b).abs() < tolerance * expected[6], "{what}: {a} {b}");
        }
        // The reactions are those of the body that stands still.
        for (record, still) in other.report.reactions.iter().zip(&reference.report.reactions) {
            let sum = |record: &stickslip::run::report::BalanceRecord, c: usize| {
                record.supports.iter().map(|support| support.force[c]).sum::<f64>()
            };
            for c in 0..2 {
                assert!((sum(record, c) - sum(still, c)).abs() < 10.0 * tolerance * expected[6], "{what}");
            }
        }
    }
}

/// All at once, in space: the balance closes, and reactions are where they belong.
#[test]
fn everything_in_balance() {
    let material = Material { density: Some(7850.0), expansion: Some(1.2e-5), ..Material::new(210e9, 0.3) };
    let body = Description::new(MeshSource::block([1.0, 1.0, 0.5], [4, 4, 2]), material, vec![0.5, 1.0])
        .support("left", &[Axis::X])
        .with_support(Support::along("right", [1.0, 1.0, 0.0], 1e-6))
        .with_support(Support::new("left", &[Axis::Y]).at([0.0, 0.0, 0.5]))
        .spring(Bed::surface("back", 1e9, 1e8))
        .contact("bottom", 0.3, Obstacle::plane(0.0))
        .load(Action::Acceleration(vec![0.0, 0.0, -9.81]).into())
        .load(Action::Pressure { boundary: "top".to_string(), pressure: formula("1e7 * x * y") }.into())
        .load(
            Action::Spin { axis: Some([0.0, 0.0, 1.0].into()), through: Some([0.5, 0.5, 0.0].into()), speed: 100.0 }
                .into(),
        )
        .load(Action::Temperature(formula("20 * z")).into())
        .load(Action::Force { at: Where::Point([1.0, 1.0, 0.5].into()), force: vec![1e4, 0.0, -1e4] }.into());
    let body = solved(&body);
    let end = body.report.reactions.last().unwrap();
    assert!((end.loads[0].force[2] / (-7850.0 * 9.81 * 0.5) - 1.0).abs() < 1e-12);
    assert!((end.loads[1].force[2] / (-1e7 / 4.0) - 1.0).abs() < 1e-12);
    assert!(norm([0, 1, 2].map(|c| end.loads[3].force[c])) < 1e-4 * end.loads[1].force[2].abs());
    // What is held along (1, 1, 0) is pressed along it, and what is held along y takes nothing along z.
    let oblique = &end.supports[1].force;
    assert!((oblique[0] - oblique[1]).abs() < 1e-9 * oblique[0].abs() && oblique[2].abs() < 1e-9 * oblique[0].abs());
    assert_eq!([end.supports[2].force[0], end.supports[2].force[2]], [0.0; 2]);
    assert!(body.report.forces.last().unwrap().resultant.sums.sum_p_n > 1e6);
}

/// A body that a support carries along by a centimetre while springs a billion times softer hold on to it: they bear on it, and
/// the contact keeps its force of a tenth of a newton.
#[test]
fn a_carried_body_drags_its_springs() {
    let body = |displacement: f64, friction: f64| {
        Description::new(MeshSource::block([0.2, 0.1], [16, 8]), Material::new(210e9, 0.3), vec![0.5, 1.0, 1.5, 2.0])
            .with_support(Support::new("left", &BOTH).moved(&[displacement, 0.0]))
            .spring(Bed::surface("right", 1.0, 1.0))
            .contact("bottom", friction, Obstacle::plane(0.0))
            .load(Load::new("top", &[0.0, -0.5]))
    };
    let (still, carried) = (solved(&body(0.0, 0.0)), solved(&body(0.01, 0.0)));
    let pressed = |solved: &Solved| solved.report.forces.last().unwrap().resultant.sums.sum_p_n;
    assert!((pressed(&carried) / pressed(&still) - 1.0).abs() < 0.02, "{} {}", pressed(&still), pressed(&carried));
    let spring = &carried.report.reactions.last().unwrap().springs[0].force;
    assert!((spring[0] / -(0.01 * 0.1) - 1.0).abs() < 1e-6, "{spring:?}");
    // Friction turns the body a little against its clamp: without it the nodes press less.
    let dragged = solved(&body(0.01, 0.4));
    assert!((pressed(&dragged) - 0.08964).abs() < 1e-5, "{}", pressed(&dragged));
}

/// A direction that rounding has turned off its axis moves the body along the axis, and not without end across it.
#[test]
fn directions_that_are_off_their_axis_by_rounding() {
    let pressed = |direction: [f64; 2]| {
        let mesh = MeshSource::block([1.0, 0.5], [10, 5]);
        let body = Description::new(mesh, Material::new(2e11, 0.3), vec![1.0])
            .with_support(Support::along("top", direction, 1e-6))
            .spring(Bed::surface("left", 1e10, 0.0))
            .contact("bottom", 0.3, Obstacle::plane(0.0))
            .load(Load::new("right", &[-1e3, 0.0]));
        let report = solved(&body).report;
        report.boundaries[0].force[1]
    };
    let along = pressed([0.0, -1.0]);
    assert!(along < -1e5, "{along}");
    for off in [1e-25, 6.1e-17, 1e-12, 1e-10] {
        let found = pressed([off, -1.0]);
        assert!((found / along - 1.0).abs() < 1e-8, "{off}: {found} {along}");
    }
}

/// Only bodies that are warmed somewhere need a coefficient of expansion.
#[test]
fn cold_bodies_need_no_expansion() {
    let block = || MeshSource::block([1.0, 1.0], [2, 2]);
    let bodies = vec![Body::new("cold", block()), Body::new("warm", block()).at([0.0, 2.0])];
    let build = |temperature: &str| {
        let warm = Material { expansion: Some(1e-5), ..Material::new(YOUNG, NU) };
        let materials = [("cold".to_string(), Material::new(YOUNG, NU)), ("warm".to_string(), warm)];
        let material = Material::of_bodies(materials).unwrap();
        let description = Description::new(MeshSource::Bodies(bodies.clone()), material, vec![1.0]);
        let axes = [Axis::X, Axis::Y];
        let supported = description.support("cold:bottom", &axes).support("warm:bottom", &axes);
        Model::build(&supported.load(Action::Temperature(formula(temperature)).into()))
    };
    assert!(build("max(0, y - 1.5)").is_ok());
    for needed in ["100", "y", "max(0, 0.4 - y)", "max(0, 0.1 - abs(x - 0.6))"] {
        let error = build(needed).unwrap_err().to_string();
        assert!(error.contains("a load needs the expansion of the group `cold`"), "{needed}: {error}");
    }
}

/// The mean displacement is that over the side, however its nodes are distributed.
#[test]
fn mean_displacements_do_not_depend_on_the_distribution_of_nodes() {
    for grading in [1.0, 8.0] {
        let mesh = MeshSource::segmented(
            &[vec![2.0], vec![1.0]],
            &[vec![4], vec![6]],
            Some(&[vec![1.0], vec![grading]]),
            None,
        );
        let pull = Action::Traction { boundary: "right".to_string(), traction: vec![formula("2e6"), formula("0")] };
        let bar = Description::new(mesh.unwrap(), Material::new(YOUNG, NU).in_plane(Plane::Stress), vec![1.0])
            .support("left", &[Axis::X])
            .support("bottom", &[Axis::Y])
            .load(pull.into());
        let record = solved(&bar).report.reactions.pop().unwrap();
        for (displacement, exact) in [
            (&record.loads[0].displacement, [2.0 * 2e6 / YOUNG, -0.5 * NU * 2e6 / YOUNG]),
            (&record.supports[0].displacement, [0.0, -0.5 * NU * 2e6 / YOUNG]),
            (&record.supports[1].displacement, [2e6 / YOUNG, 0.0]),
        ] {
            let off = displacement.iter().zip(exact).map(|(found, exact)| (found - exact).abs()).fold(0.0, f64::max);
            assert!(off < 1e-12 * 2e6 / YOUNG, "{grading}: {displacement:?}, not {exact:?}");
        }
    }
}
