//! Friction at contact nodes that supports hold, while the other side moves past them.

use super::whole;
use crate::common::pairs::ways;
use crate::common::prelude::*;

const MU: f64 = 0.1;

/// The section of a ring between two radii, 20 mm long.
fn section(radii: [f64; 2], n: [usize; 2], kind: CellKind) -> Mesh {
    let mesh = block(&[radii[1] - radii[0], 0.02], &n);
    let mesh = moved(mesh, |[x, y, z]| [radii[0] + x, y, z]);
    if kind == CellKind::Triangle6 { mesh.into_simplices().into_second_order() } else { mesh }
}

/// A shaft that is pressed into a hub, whose lower end is held, and is pushed out at its upper end, `pushed` to its lower end.
fn press_fit(kind: CellKind, shaft_is_slave: bool, pushed: &str) -> Description {
    let material = Material::new(196e9, 0.3).in_plane(Plane::Axisymmetric);
    let mesh = MeshSource::Bodies(vec![
        Body::new("shaft", section([0.01, 0.02], [3, 7], kind)),
        Body::new("hub", section([0.02, 0.03], [3, 5], kind)),
    ]);
    let [slave, master] = if shaft_is_slave { ["shaft:right", "hub:left"] } else { ["hub:left", "shaft:right"] };
    let push = Support::new(pushed, &[Axis::Y]).moved(&[-1e-4]).over(&[[1.0, 0.0], [2.0, 1.0]]);
    Description::new(mesh, material, equal_increments(2.0, 4))
        .pair(slave, MU, Opposite::from(master).apart(-5e-6))
        .support("hub:bottom", &[Axis::Y])
        .with_support(push)
}

/// The forces on the master along x and along the push.
fn forces(report: &RunReport) -> [f64; 2] {
    let force = &report.boundaries[0].force;
    [force[0].abs(), force[1].abs()]
}

/// The force that pushes a shaft out is the friction times the normal force, with either side as the slave.
#[test]
fn a_shaft_is_pushed_out_by_all_of_its_friction() {
    for kind in [CellKind::Quadrilateral, CellKind::Triangle6] {
        for (method, linear) in ways() {
            let [shaft, hub] =
                [true, false].map(|slave| forces(&whole::report(&press_fit(kind, slave, "shaft:top"), method, linear)));
            for [normal, push] in [shaft, hub] {
                assert!((push / (MU * normal) - 1.0).abs() < 1e-8, "{kind:?} {method:?} {linear:?} {normal} {push}");
            }
            assert!((shaft[1] / hub[1] - 1.0).abs() < 0.01, "{kind:?} {method:?} {linear:?} {shaft:?} {hub:?}");
        }
    }
}

/// The push at the same end where the hub is held: the two supports move apart. Where no row is left the friction is, and that is told.
#[test]
fn a_push_beside_the_support() {
    for is_slave in [true, false] {
        let report =
            whole::report(&press_fit(CellKind::Quadrilateral, is_slave, "shaft:bottom"), ways()[0].0, ways()[0].1);
        let [normal, push] = forces(&report);
        let whole = (push / (MU * normal) - 1.0).abs() < 1e-8;
        assert_eq!(whole::warns(&report, WarningKind::FRICTION_LEFT_OUT), !whole, "{is_slave} {normal} {push}");
    }
}

/// The forces along and across the contact where a block of `upper` elements slides over another of `lower`, towards the side of that which is
/// held: there it presses most.
fn slide(lower: usize, upper: usize, lower_is_slave: bool, solver: (Method, LinearAlgebra)) -> (f64, f64, bool) {
    let mesh = MeshSource::Bodies(vec![
        Body::new("lower", block(&[1.0, 1.0, 0.5], &[lower, lower, 1])),
        Body::new("upper", block(&[1.0, 1.0, 0.5], &[upper, upper, 1])).at([0.0, 0.0, 0.5]),
    ]);
    let slide = Support::new("upper:top", &[Axis::X]).moved(&[-0.01]).over(&[[1.0, 0.0], [2.0, 1.0]]);
    let [slave, master] = if lower_is_slave { ["lower:top", "upper:bottom"] } else { ["upper:bottom", "lower:top"] };
    let body = Description::new(mesh, Material::new(70e9, 0.0), equal_increments(2.0, 4))
        .pair(slave, 0.3, master)
        .support("lower:bottom", &[Axis::X, Axis::Y, Axis::Z])
        .support("lower:left", &[Axis::X])
        .support("upper:top", &[Axis::Y])
        .with_support(slide)
        .load(Load::new("upper:top", &[0.0, 0.0, -1e7]).over(&[[0.0, 0.0], [1.0, 1.0]]));
    let report = whole::report(&body, solver.0, solver.1);
    let force = &report.boundaries[0].force;
    (force[0].abs(), force[2].abs(), whole::warns(&report, WarningKind::FRICTION_LEFT_OUT))
}

/// With either side as the slave all nodes carry their friction.
#[test]
fn a_block_slides_over_a_side_that_is_held() {
    for way in ways() {
        for lower_is_slave in [true, false] {
            let (along, normal, warning) = slide(2, 3, lower_is_slave, way);
            assert!((normal / 1e7 - 1.0).abs() < 1e-9 && !warning, "{way:?} {normal}");
            assert!((along / (0.3 * normal) - 1.0).abs() < 1e-3, "{way:?} {lower_is_slave} {along} {normal}");
        }
    }
}

/// More nodes that are held than there are in front of them: their rows depend on each other, and all carry their friction.
#[test]
fn held_nodes_in_front_of_few_others() {
    for way in ways() {
        let (along, normal, warning) = slide(4, 2, true, way);
        assert!((normal / 1e7 - 1.0).abs() < 1e-9 && !warning, "{way:?} {normal}");
        assert!((along / (0.3 * normal) - 1.0).abs() < 1e-8, "{way:?} {along} {normal}");
    }
}

/// Both sides held in a plane of symmetry: a node there has no friction across it.
#[test]
fn a_plane_of_symmetry_stays_one() {
    let body = Description::new(
        MeshSource::Bodies(vec![
            Body::new("lower", block(&[1.0, 1.0, 0.5], &[3, 3, 1])),
            Body::new("upper", block(&[1.0, 1.0, 0.5], &[2, 2, 1])).at([0.0, 0.0, 0.5]),
        ]),
        Material::new(70e9, 0.3),
        vec![1.0],
    );
    let body = body
        .pair("lower:top", 0.3, "upper:bottom")
        .support("lower:bottom", &[Axis::Z])
        .support("lower:left", &[Axis::X])
        .support("upper:left", &[Axis::X])
        .support("lower:front", &[Axis::Y])
        .support("upper:front", &[Axis::Y])
        .load(Load::new("upper:top", &[0.0, 0.0, -1e7]));
    let model = stickslip::body::Model::build(&body).unwrap();
    for contact in &model.contact.nodes {
        let held = (0..2).filter(|&c| contact.position[c] == 0.0).count();
        assert_eq!(contact.tangents.iter().filter(|row| row.is_empty()).count(), held, "{:?}", contact.position);
    }
}

/// In front of an obstacle the friction of a node that a support moves acts on the support alone and is in no result: that is told.
#[test]
fn friction_that_is_left_out_is_told() {
    let warned = |held: &str| {
        let slide = Support::new(held, &[Axis::X]).moved(&[1e-3]).over(&[[1.0, 0.0], [2.0, 1.0]]);
        let body =
            Description::new(MeshSource::block([1.0, 0.5], [4, 2]), Material::new(70e9, 0.3), equal_increments(2.0, 4))
                .contact("bottom", 0.3, Obstacle::plane(0.0))
                .with_support(slide)
                .load(Load::new("top", &[0.0, -1e7]).over(&[[0.0, 0.0], [1.0, 1.0]]));
        let report = whole::report(&body, Method::BN, LinearAlgebra::Whole(SparseLu::default()));
        report.warnings.into_iter().find(|warning| warning.kind == WarningKind::FRICTION_LEFT_OUT).map(|w| w.message)
    };
    let message = warned("left").unwrap();
    assert!(message.contains("% of the possible friction of `bottom`"), "{message}");
    assert_eq!(warned("top"), None);
}
