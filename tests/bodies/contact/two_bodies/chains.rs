//! Bodies in front of several others.

use crate::common::pairs::{states, ways};
use crate::common::prelude::*;

/// All ways to solve.
fn all_ways() -> Vec<(Method, LinearAlgebra)> {
    [&ways()[..], &[(Method::BN, LinearAlgebra::Condensed(SparseCholesky::Faer))]].concat()
}

/// A block: its name, place, size and elements.
type Block<'a> = (&'a str, [f64; 2], [f64; 2], [usize; 2]);

/// Blocks of the same material.
fn blocks(blocks: &[Block<'_>], times: Vec<f64>) -> Description {
    let mut material = Material::new(70e9, 0.3);
    let group = |name: &str| MaterialGroup { name: name.into(), young: 70e9, poisson: 0.3, ..MaterialGroup::default() };
    material.groups = blocks.iter().map(|(name, ..)| group(name)).collect();
    let body = |(name, at, size, elements): &Block<'_>| Body::new(name, MeshSource::block(*size, *elements)).at(*at);
    Description::new(MeshSource::Bodies(blocks.iter().map(body).collect()), material, times)
}

/// Four blocks around a point, whose meshes do not match.
fn four(pairs: [[&str; 2]; 4], friction: f64) -> Description {
    let all = [
        ("a", [0.0, 0.0], [0.5, 0.5], [3, 4]),
        ("b", [0.5, 0.0], [0.5, 0.5], [4, 5]),
        ("c", [0.0, 0.5], [0.5, 0.5], [5, 3]),
        ("d", [0.5, 0.5], [0.5, 0.5], [2, 3]),
    ];
    let body = pairs.iter().fold(blocks(&all, vec![1.0]), |body, [slave, master]| body.pair(slave, friction, *master));
    let pressed = [("b:right", [-1e7, 0.0]), ("d:right", [-1e7, 0.0]), ("c:top", [0.0, -1e7]), ("d:top", [0.0, -1e7])];
    pressed
        .iter()
        .fold(body, |body, (boundary, traction)| body.load(Load::new(boundary, traction)))
        .support("a:left", &[Axis::X])
        .support("c:left", &[Axis::X])
        .support("a:bottom", &[Axis::Y])
        .support("b:bottom", &[Axis::Y])
}

/// The stress is the same everywhere: along x and y so many times 10 MPa, without shear.
fn is_uniform(model: &Model, solver: SolverChoice, [x, y]: [f64; 2]) {
    let u = model.displacements(1.0, &solved(model, solver, &mut ()).state.u).unwrap();
    for stress in model.centre_stresses(1.0, &u).unwrap() {
        let off = [stress[0] / 1e7 - x, stress[1] / 1e7 - y, stress[3] / 1e7];
        assert!(off.iter().all(|off| off.abs() < 1e-9), "{solver:?} {off:?}");
    }
}

/// At the point where all meet nodes are slaves in one pair and masters in another, and one is a slave in two.
#[test]
fn four_blocks_around_a_point() {
    let pairs = [["b:left", "a:right"], ["c:bottom", "a:top"], ["d:left", "c:right"], ["d:bottom", "b:top"]];
    for friction in [0.0, 0.3] {
        let model = Model::build(&four(pairs, friction)).unwrap();
        for (method, linear) in all_ways() {
            is_uniform(&model, solver(method, linear), [-1.0, -1.0]);
        }
    }
}

/// Two blocks side by side, glued, count as one for what lies on both.
#[test]
fn a_block_on_two() {
    let all = [
        ("left", [0.0, 0.0], [0.45, 0.5], [3, 3]),
        ("right", [0.45, 0.0], [0.55, 0.5], [5, 4]),
        ("above", [0.0, 0.5], [1.0, 0.5], [6, 3]),
    ];
    let body = blocks(&all, vec![1.0])
        .glued("left:right", "right:left")
        .pair("above:bottom", 0.3, ["left:top", "right:top"])
        .support("left:bottom", &[Axis::Y])
        .support("right:bottom", &[Axis::Y])
        .with_support(Support::new("", &[Axis::X]).at([0.0, 0.0]))
        .load(Load::new("above:top", &[0.0, -1e7]));
    let model = Model::build(&body).unwrap();
    for (method, linear) in all_ways() {
        is_uniform(&model, solver(method, linear), [0.0, -1.0]);
    }
    let mut apart = body.clone();
    apart.contacts.remove(0);
    let error = Model::build(&apart).unwrap_err().to_string();
    assert!(error.contains("`left` and `right` both have a node") && error.contains("nothing joins them"), "{error}");
    let twice = body.pair("above:bottom", 0.3, "left:top");
    let error = Model::build(&twice).unwrap_err().to_string();
    assert_eq!(error, "contact[2].boundary: the boundary `above:bottom` has a [[contact]] already");
}

#[test]
fn rings_of_bodies_are_refused() {
    let ring = [["c:bottom", "a:top"], ["a:right", "b:left"], ["b:top", "d:bottom"], ["d:left", "c:right"]];
    let error = Model::build(&four(ring, 0.0)).unwrap_err().to_string();
    assert!(error.contains("the node at (0.5, 0.5)") && error.contains(".against"), "{error}");
}

/// A tower between rigid walls that only contact holds, with friction everywhere, pressed and sheared.
#[test]
fn a_tower_between_obstacles() {
    let tower = [
        ("low", [0.0, 0.0], [1.0, 0.4], [5, 2]),
        ("middle", [0.1, 0.4], [0.7, 0.3], [6, 3]),
        ("high", [0.0, 0.7], [1.0, 0.3], [4, 2]),
    ];
    let slide =
        [(0.0, [0.0, 0.0].into()), (2.0, [0.0, 0.0].into()), (6.0, [3e-5, 0.0].into()), (10.0, [-1e-5, 0.0].into())];
    let above = Obstacle { translation: Some(slide.to_vec()), ..Obstacle::plane(0.0) };
    let body = blocks(&tower, equal_increments(10.0, 10))
        .contact("low:bottom", 0.6, Obstacle::plane(0.0))
        .pair("middle:bottom", 0.2, "low:top")
        .pair("middle:top", 0.3, "high:bottom")
        .contact("high:top", 0.5, above.approaching(&[[0.0, 0.0], [2.0, 1e-4], [10.0, 1e-4]]));
    let model = Model::build(&body).unwrap();
    assert_eq!(model.constraints.rigid_motions.len(), 9);
    let expected = states(&model, ways()[0]);
    for way in &all_ways()[1..] {
        let apart = difference(&expected, &states(&model, *way));
        assert!(apart < 1e-7, "{way:?} {apart:e}");
    }
}

/// One body pressed into the other by moving the supports of either is the same but for a motion of the whole.
#[test]
fn it_does_not_matter_which_support_moves() {
    let pressed = |upper: [f64; 2], lower: [f64; 2]| {
        let all = [("low", [0.0, 0.0], [1.0, 0.4], [5, 2]), ("high", [0.0, 0.4], [1.0, 0.3], [4, 2])];
        let body = blocks(&all, equal_increments(2.0, 4))
            .pair("high:bottom", 0.3, "low:top")
            .with_support(Support::new("high:top", &[Axis::X, Axis::Y]).moved(&upper))
            .with_support(Support::new("high:left", &[Axis::X]).moved(&upper[..1]))
            .with_support(Support::new("low:left", &[Axis::X]).moved(&lower[..1]))
            .with_support(Support::new("low:bottom", &[Axis::X, Axis::Y]).moved(&lower));
        let model = Model::build(&body).unwrap();
        let state = solved(&model, solver(Method::BN, LinearAlgebra::condensed()), &mut ()).state;
        let balance = model.balance(2.0, &state).unwrap();
        assert!(balance.closure < 1e-11, "{balance:?}");
        let u = model.displacements(2.0, &state.u).unwrap();
        (state, u)
    };
    let (reference, u) = pressed([2e-5, -1e-4], [0.0, 0.0]);
    assert!(reference.p_t.iter().any(|p| *p != 0.0));
    for lower in [[-2e-5, 1e-4], [1.0, 2.0], [1e-5, -1e-3]] {
        let (state, moved) = pressed([2e-5 + lower[0], -1e-4 + lower[1]], lower);
        let apart = forces_apart(&state, &reference);
        assert!(apart < 1e-9, "{lower:?} {apart:e}");
        let off = u.iter().zip(&moved).map(|(a, b)| (b[0] - a[0] - lower[0]).hypot(b[1] - a[1] - lower[1]));
        assert!(off.fold(0.0, f64::max) < 1e-14, "{lower:?}");
    }
}

/// A soft body that is moved against a stiff one that stays: errors are compared with the forces that act, not with what it would take
/// to move the stiff one along.
#[test]
fn stiff_bodies_that_stay_make_no_forces() {
    let group =
        |name: &str, young| MaterialGroup { name: name.into(), young, poisson: 0.3, ..MaterialGroup::default() };
    for contrast in [1.0, 1e6] {
        let mut material = Material::new(70e9, 0.3);
        material.groups = vec![group("low", 70e9), group("high", 70e9 / contrast)];
        let low = Body::new("low", MeshSource::block([1.0, 0.4], [5, 2]));
        let high = Body::new("high", MeshSource::block([0.8, 0.3], [4, 2])).at([0.1, 0.4]);
        let mesh = MeshSource::Bodies(vec![low, high]);
        let slide = Support::new("high:top", &[Axis::X, Axis::Y]).moved(&[2e-5, -1e-4]);
        let body = Description::new(mesh, material, equal_increments(2.0, 4))
            .pair("high:bottom", 0.1, "low:top")
            .with_support(slide.over(&[[0.0, 0.0], [2.0, 1.0]]))
            .support("low:bottom", &[Axis::X, Axis::Y]);
        let model = Model::build(&body).unwrap();
        let mut keep = Keep::default();
        let outcome = solved(&model, bn(), &mut keep);
        let largest = largest(&outcome.state.p_n);
        // A thousandth of the largest contact force that is missing counts as about that.
        let last = keep.states.len() - 1;
        let mut spoilt = keep.states[last].clone();
        let pressed = (0..spoilt.p_n.len()).max_by(|&a, &b| spoilt.p_n[a].total_cmp(&spoilt.p_n[b])).unwrap();
        spoilt.p_n[pressed] -= 1e-3 * largest;
        let increment = keep.increment(last, model.loading.gap());
        let errors = KktErrors::measure(&model.problem, &increment, &spoilt, &KktScales::default()).unwrap();
        assert!((0.5e-3..2e-3).contains(&errors.equilibrium), "{contrast}: {errors:?}");
        assert!(outcome.state.p_t.iter().any(|p| *p != 0.0));
    }
}

/// A boundary that two others are against is the slave of one of them at most.
#[test]
fn the_slave_of_one_contact_is_no_other() {
    let all = [
        ("left", [0.0, 0.0], [0.4, 0.5], [3, 3]),
        ("right", [0.6, 0.0], [0.4, 0.5], [3, 4]),
        ("above", [0.0, 0.5], [1.0, 0.5], [12, 3]),
    ];
    let automatic = |name: &str| Opposite { slave: Slave::Automatic, ..name.into() };
    let body = blocks(&all, vec![1.0])
        .pair("left:top", 0.3, automatic("above:bottom"))
        .pair("right:top", 0.3, automatic("above:bottom"))
        .support("left:bottom", &[Axis::X, Axis::Y])
        .support("right:bottom", &[Axis::X, Axis::Y])
        .load(Load::new("above:top", &[0.0, -1e7]));
    let model = Model::build(&body).unwrap();
    let slaves: Vec<&str> = model.contact.pairs.iter().map(|pair| pair.slave.as_str()).collect();
    assert_eq!(slaves, ["above:bottom", "right:top"]);
    assert_eq!(model.contact.pairs[1].choice.unwrap().reason, SlaveReason::OtherTaken);
    solved(&model, solver(Method::BN, LinearAlgebra::condensed()), &mut ());
}

/// A slide that supports make counts as one.
#[test]
fn slides_by_supports_are_told() {
    let all = [("low", [0.0, 0.0], [3.0, 0.4], [30, 2]), ("high", [1.0, 0.4], [0.8, 0.3], [4, 2])];
    let slide = |d: f64| {
        let pressed = Support::new("high:top", &[Axis::Y]).moved(&[-1e-4]).over(&[[0.0, 0.0], [1.0, 1.0]]);
        let moved = Support::new("high:top", &[Axis::X]).moved(&[d]).over(&[[1.0, 0.0], [2.0, 1.0]]);
        let body = blocks(&all, equal_increments(2.0, 4)).pair("high:bottom", 0.1, "low:top");
        let body = body.with_support(pressed).with_support(moved).support("low:bottom", &[Axis::X, Axis::Y]);
        let model = Model::build(&body).unwrap();
        let report = Run::of(&model, model.times().to_vec(), bn()).unwrap().solve(&mut ()).unwrap();
        report.warnings.iter().any(|warning| warning.kind == WarningKind::SLID_ACROSS_FACETS)
    };
    assert_eq!([1e-4, 0.02, 0.03, 0.3].map(slide), [false, false, true, true]);
}

/// A coarse block that sticks out beyond the end of another seems to rest on it where it would tip: that is told.
#[test]
fn forces_beyond_the_end_are_told() {
    let warned = |at: f64, slave: &str, master: &str, n: usize| {
        let all = [("low", [0.0, 0.0], [1.0, 0.5], [8, 4]), ("high", [at, 0.5], [0.4, 0.1], [n, 2])];
        let body = blocks(&all, vec![1.0]).pair(slave, 0.3, master).support("low:bottom", &[Axis::X, Axis::Y]);
        let model = Model::build(&body.load(Load::new("high:top", &[0.0, -1e5]))).unwrap();
        let report = Run::of(&model, vec![1.0], bn()).unwrap().solve(&mut ()).unwrap();
        let is_warned = report.warnings.iter().any(|warning| warning.kind == WarningKind::BEYOND_THE_END);
        (report.status == Status::Converged, is_warned)
    };
    assert_eq!(warned(0.83, "high:bottom", "low:top", 3), (true, true));
    assert_eq!(warned(0.83, "low:top", "high:bottom", 3), (false, false));
    for at in [0.1, 0.3, 0.6] {
        for n in [3, 7, 12] {
            assert_eq!(warned(at, "high:bottom", "low:top", n), (true, false), "{at} {n}");
        }
    }
}
