//! Published cases and closed forms of contact: shrink fit, flat punch, receding contact, stick under a growing load.
//! `doc/method/verification-bodies.md` has the figures, which `--nocapture` prints.

use crate::common::prelude::*;

const YOUNG: f64 = 210e9;
const NU: f64 = 0.3;

fn solve(description: &Description) -> (Model, Vec<RecordedIncrement>) {
    let model = Model::build(description).unwrap();
    let mut recording = Recording::all();
    let solver = solver_of(Method::BN, LinearAlgebra::condensed());
    converged(&model, solver, &mut recording);
    (model, recording.increments)
}

/// The contact node nearest to `x`, and its normal stress at the end.
fn stress_at(model: &Model, end: &RecordedIncrement, x: [f64; 2]) -> f64 {
    let distance = |i: &usize| {
        let [a, b, _] = model.contact.nodes[*i].position;
        (a - x[0]).hypot(b - x[1])
    };
    let i = (0..model.contact.nodes.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
    end.state.p_n[i] / model.contact.nodes[i].weight
}

/// A ring pressed on a rigid shaft that is δ too thick, in plane stress (Lamé): `p = E δ / a / ((a² + b²) / (b² - a²) + ν)`.
#[test]
fn shrink_fit() {
    let (a, b, interference) = (0.1_f64, 0.2_f64, 1e-5);
    let exact = YOUNG * interference / a / ((a * a + b * b) / (b * b - a * a) + NU);
    let errors = [10, 20, 40].map(|n| {
        let radius = a + interference;
        let shaft = Shape::Cylinder { radius, place: Place::Apex([radius * FRAC_1_SQRT_2; 2].into()), axis: None };
        let shaft = Obstacle { direction: GapDirection::Nearest, ..Obstacle::at_rest(shaft) };
        let ring = Description::new(ring(a, b, n), Material::new(YOUNG, NU).in_plane(Plane::Stress), vec![1.0])
            .support("x axis", &[Axis::Y])
            .support("y axis", &[Axis::X])
            .contact("inner", 0.0, shaft);
        let (model, increments) = solve(&ring);
        let resultant: f64 = increments[0].state.p_n.iter().sum();
        let mean = resultant / model.contact.nodes.iter().map(|contact| contact.weight).sum::<f64>();
        mean / exact - 1.0
    });
    println!("shrink fit: {errors:.6?}");
    assert!(
        errors[2].abs() < 2e-4 && errors[2].abs() < 0.3 * errors[1].abs() && errors[1].abs() < 0.3 * errors[0].abs()
    );
}

/// A rigid flat punch of half-width 1 on a half-plane: `p(0)` by `P / (π a)`, with `n` elements along half of it.
fn under_a_punch(n: usize, friction: f64) -> f64 {
    let elements = [vec![n, 2 * n], vec![3 * n]];
    let grading = [vec![1.0, 60.0], vec![1.0 / 60.0]];
    let size = [vec![1.0, 31.0], vec![32.0]];
    let mesh = MeshSource::segmented(&size, &elements, Some(&grading), None).unwrap();
    // Beyond its edge the punch is out of reach.
    let punch = Shape::Formula(Formula::parse("1e3 * max(0, x - 1.0001)").unwrap());
    let body = Description::new(mesh, Material::new(YOUNG, NU), vec![1.0])
        .support("left", &[Axis::X])
        .support("bottom", &[Axis::Y])
        .contact("top", friction, Obstacle::at_rest(punch).approaching(&[[0.0, 0.0], [1.0, 1e-4]]));
    let (model, increments) = solve(&body);
    let half: f64 = increments[0].state.p_n.iter().sum();
    stress_at(&model, &increments[0], [0.0, 32.0]) / (2.0 * half / PI)
}

/// Smooth: `p(0) = P / (π a)`. Bonded, `P / (π a) · 2 (1 - ν) / √(3 - 4ν)`: with friction without end nothing slips, and but for
/// the last 0.01 % of it the punch presses everywhere.
#[test]
fn flat_punches() {
    for (name, friction, exact) in [("smooth", 0.0, 1.0), ("bonded", 1e3, 2.0 * (1.0 - NU) / (3.0 - 4.0 * NU).sqrt())] {
        let errors = [8, 16, 32].map(|n| under_a_punch(n, friction) / exact - 1.0);
        println!("{name} punch: {errors:.6?}");
        assert!(errors[2].abs() < 0.02 && errors[2].abs() < 0.65 * errors[1].abs(), "{name}: {errors:?}");
    }
}

/// A layer pressed on a plane lifts off at its sides, and as far under any load: the pressures are in proportion to it.
#[test]
fn receding_contact() {
    let under = |factor: f64| {
        let size = [vec![0.25, 3.75], vec![1.0]];
        let mesh = MeshSource::segmented(&size, &[vec![5, 40], vec![12]], None, None).unwrap();
        let layer = Description::new(mesh, Material::new(YOUNG, NU), vec![1.0])
            .support("left", &[Axis::X])
            .contact("bottom", 0.0, Obstacle::plane(0.0))
            .load(
                Action::Traction {
                    boundary: "top".to_string(),
                    traction: vec![
                        0.0.into(),
                        Formula::parse(&format!("-1e6 * {factor} * exp(-(4 * x)^2)")).unwrap().into(),
                    ],
                }
                .into(),
            );
        solve(&layer).1.remove(0)
    };
    let (once, often) = (under(1.0), under(1000.0));
    assert_eq!(once.statuses, often.statuses);
    let open = once.statuses.iter().filter(|status| **status == ContactStatus::Open).count();
    assert!(open > 10 && open < once.statuses.len() - 5, "{open} of {}", once.statuses.len());
    let times: Vec<f64> = often.state.p_n.iter().map(|p| 1e-3 * p).collect();
    assert!(apart(&times, &once.state.p_n) < 1e-9, "{times:?} {:?}", once.state.p_n);
}

/// Pressed by a growing load, the middle of a contact with friction sticks up to the same share of the whole, under every load
/// and every profile (Spence, Proc. R. Soc. A 305 (1968) 55). Where shear does not disturb the pressure, c/a is that of
/// `K(c/a) / K'(c/a) = μ / β`, β = (1 - 2ν) / (2 - 2ν), 0.744 here; it does a little.
#[test]
fn stick_under_a_growing_load() {
    let overrides =
        ["contact.friction=0.3", "time.increments=48", "mesh.contact_elements=48", "mesh.outer_elements=32"];
    let scene = common::scene("hertz_line.toml", &overrides);
    let (model, increments) = solve(&scene.description);
    let reaches = |end: &RecordedIncrement, wanted: &dyn Fn(ContactStatus) -> bool| {
        let nodes = model.contact.nodes.iter().zip(&end.statuses).filter(|(_, status)| wanted(**status));
        nodes.map(|(contact, _)| contact.position[0]).fold(0.0, f64::max)
    };
    for k in [24, 36, 48] {
        let end = &increments[k - 1];
        let touch = reaches(end, &|status| status != ContactStatus::Open);
        let share = reaches(end, &|status| status == ContactStatus::Stick) / touch;
        println!("stick under a growing load: c/a = {share:.3}, a = {touch:.4} m");
        let element = 0.06 / 48.0;
        assert!((share - 0.73).abs() < 1.5 * element / touch, "{share} {touch}");
    }
}
