//! Meshes that do not match, glued.

use super::patch::mesh;
use crate::common::prelude::*;

fn solved(description: &Description) -> (Model, Vec<[f64; 3]>) {
    let model = Model::build(description).unwrap();
    let run = Run::of(&model, vec![1.0], bn()).unwrap();
    let outcome = run.history(&mut ()).unwrap();
    assert_eq!(outcome.status, Status::Converged);
    let u = model.displacements(1.0, &outcome.state.u).unwrap();
    (model, u)
}

/// A tension goes through without a contact node, and with one material the displacement is linear.
#[test]
fn tension_goes_through() {
    use CellKind::{Quadrilateral, Triangle6};
    for (lower, upper, kinds) in [
        ([7, 3], [5, 3], [Quadrilateral, Quadrilateral]),
        ([3, 2], [40, 8], [Quadrilateral, Quadrilateral]),
        ([3, 2], [4, 2], [Triangle6, Quadrilateral]),
        ([3, 2], [4, 2], [Triangle6, Triangle6]),
    ] {
        for (slave, master) in [("upper:bottom", "lower:top"), ("lower:top", "upper:bottom")] {
            let lower = (mesh([1.0, 0.5], lower, kinds[0]), 210e9);
            let upper = (mesh([1.0, 0.5], upper, kinds[1]), 210e9);
            let body = bodies(lower, upper, Some([0.0, 0.5].into()), vec![1.0])
                .glued(slave, master)
                .support("lower:bottom", &[Axis::Y])
                .with_support(Support::new("", &[Axis::X]).at([0.0, 0.0]))
                .load(Load::new("upper:top", &[0.0, 1e7]));
            let (model, u) = solved(&body);
            assert!(model.contact.nodes.is_empty() && model.constraints.rigid_motions.is_empty());
            let top = u.iter().map(|u| u[1]).fold(0.0, f64::max);
            let off = u.iter().zip(&model.mesh.nodes).map(|(u, x)| (u[1] - top * x[1]).abs() / top).fold(0.0, f64::max);
            assert!(off < 1e-11, "{kinds:?} {slave} {off:e}");
            let off =
                model.centre_stresses(1.0, &u).unwrap().iter().map(|s| (s[1] / 1e7 - 1.0).abs()).fold(0.0, f64::max);
            assert!(off < 1e-11, "{kinds:?} {slave} {off:e}");
        }
    }
}

/// What is glued to a body that moves goes along with it.
#[test]
fn what_is_glued_goes_along() {
    let lower = (MeshSource::block([1.0, 0.5], [4, 2]), 1e9);
    let upper = (MeshSource::block([1.0, 0.5], [3, 2]), 1e9);
    let body = bodies(lower, upper, Some([0.0, 0.5].into()), vec![1.0])
        .glued("upper:bottom", "lower:top")
        .with_support(Support::new("lower:top", &[Axis::X, Axis::Y]).moved(&[1e-3, -2e-3]))
        .support("lower:bottom", &[Axis::X, Axis::Y]);
    let (model, u) = solved(&body);
    let apart =
        u.iter().zip(&model.mesh.nodes).filter(|(_, x)| x[1] >= 0.5).map(|(u, _)| (u[0] - 1e-3).hypot(u[1] + 2e-3));
    assert!(apart.fold(0.0, f64::max) < 1e-15);
}

/// What glue passes on to a node that a support holds is in the reaction of that.
#[test]
fn supports_carry_what_glue_passes_on() {
    for (n, m) in [(10, 31), (31, 31), (31, 10)] {
        let lower = (MeshSource::block([0.2, 0.05], [n, 6]), 70e9);
        let upper = (MeshSource::block([0.2, 0.05], [m, 6]), 70e9);
        for held in ["lower:left", "upper:left"] {
            let body = bodies(lower.clone(), upper.clone(), Some([0.0, 0.05].into()), vec![1.0])
                .glued("upper:bottom", "lower:top")
                .support("lower:bottom", &[Axis::Y])
                .support(held, &[Axis::X])
                .load(Load::new("upper:top", &[3e6, -10e6]));
            let model = Model::build(&body).unwrap();
            let run = Run::of(&model, vec![1.0], bn()).unwrap();
            let state = run.history(&mut ()).unwrap().state;
            let balance = model.balance(1.0, &state).unwrap();
            assert!((balance.supports[1].force[0] / -6e5 - 1.0).abs() < 1e-10, "{n} {m} {held} {balance:?}");
            assert!(balance.closure < 1e-12, "{n} {m} {held} {:e}", balance.closure);
        }
    }
}

/// A square of two glued halves, whose right sides end in it, and the square of one mesh.
fn halves(slave: &str, master: &str) -> [Description; 2] {
    let half = || MeshSource::block([2.0, 1.0], [4, 2]);
    let glued = bodies((half(), 1e3), (half(), 1e3), Some([0.0, 1.0].into()), vec![1.0]).glued(slave, master);
    let mut mesh = block(&[2.0, 2.0], &[4, 4]);
    for (side, of_half) in [("left", "left"), ("right", "right")] {
        let facets = mesh.boundary(side).unwrap().facets.clone();
        for (name, is_upper) in [("lower", false), ("upper", true)] {
            let own = |facet: &&Vec<usize>| (mesh.nodes[facet[0]][1] + mesh.nodes[facet[1]][1] > 2.0) == is_upper;
            let facets = facets.iter().filter(own).cloned().collect();
            mesh.boundaries.push(Boundary { name: format!("{name}:{of_half}"), facets });
        }
    }
    for (side, name) in [("bottom", "lower:bottom"), ("top", "upper:top")] {
        let facets = mesh.boundary(side).unwrap().facets.clone();
        mesh.boundaries.push(Boundary { name: name.into(), facets });
    }
    let one = Description::new(MeshSource::Given(Arc::new(mesh)), Material::new(1e3, 0.3), vec![1.0]);
    [glued, one].map(|body| {
        body.support("lower:bottom", &[Axis::Y])
            .support("lower:left", &[Axis::X])
            .load(Load::new("upper:top", &[1.0, -2.0]))
            .load(Load::new("lower:right", &[5.0, 1.0]))
    })
}

/// A support or coupling of one side where glue begins holds the other body, too, whichever is the slave: matching meshes move as
/// one mesh.
#[test]
fn glue_joins_what_is_held_or_carried() {
    let oblique = || Support::along("upper:right", [1.0, 1.0], 0.0);
    let held: [&dyn Fn(Description) -> Description; 5] = [
        &|body| body.coupling(Coupling::rigid("end", "upper:right")),
        &|body| body.with_support(Support::new("upper:right", &[Axis::X, Axis::Y]).moved(&[0.01, -0.02])),
        &|body| body.support("upper:right", &[Axis::X, Axis::Y]),
        &|body| body.support("upper:right", &[Axis::Y]),
        &|body| body.with_support(oblique()),
    ];
    for (k, held) in held.iter().enumerate() {
        for (slave, master) in [("upper:bottom", "lower:top"), ("lower:top", "upper:bottom")] {
            let [glued, one] = halves(slave, master).map(|body| {
                let (model, u) = solved(&held(body));
                (model.mesh.nodes.clone(), u)
            });
            let largest = one.1.iter().fold(0.0_f64, |most, u| most.max(u[0].hypot(u[1])));
            for (x, u) in glued.0.iter().zip(&glued.1) {
                let same = one.0.iter().position(|y| (x[0] - y[0]).hypot(x[1] - y[1]) < 1e-9).unwrap();
                let apart = (u[0] - one.1[same][0]).hypot(u[1] - one.1[same][1]);
                assert!(apart < 1e-9 * largest, "{k} {slave}: {x:?} moves by {u:?}, not {:?}", one.1[same]);
            }
        }
    }
}

/// Two sides that supports hold along different directions cannot be joined, and are refused.
#[test]
fn glue_between_supports_of_its_own_kind_is_refused() {
    let [glued, _] = halves("upper:bottom", "lower:top");
    let error = Model::build(&glued.support("upper:right", &[Axis::X]).support("lower:right", &[Axis::Y])).unwrap_err();
    assert!(error.to_string().contains("each in its own way"), "{error}");
}

/// Glue that carries a shear across a gap leaves its moment, and that is what the warning says; without the gap there is none.
#[test]
fn the_moment_across_a_gap_is_told() {
    for (gap, warned) in [(0.0, false), (0.05, true)] {
        let lower = (MeshSource::block([1.0, 0.5], [4, 2]), 1e9);
        let upper = (MeshSource::block([1.0, 0.5], [3, 2]), 1e9);
        let body = bodies(lower, upper, Some([0.0, 0.5 + gap].into()), vec![1.0])
            .glued("upper:bottom", "lower:top")
            .support("lower:bottom", &[Axis::X, Axis::Y])
            .load(Load::new("upper:top", &[1e5, 0.0]));
        let model = Model::build(&body).unwrap();
        let report = Run::of(&model, vec![1.0], bn()).unwrap().solve(&mut ()).unwrap();
        let warning = report.warnings.iter().find(|warning| warning.kind == WarningKind::UNBALANCED);
        assert_eq!(warning.is_some(), warned, "{warning:?}");
        let names_gap = |message: &str| message.contains("50.0 mm apart") && !message.contains("rounding");
        assert!(warning.is_none_or(|told| names_gap(&told.message)), "{warning:?}");
    }
}

/// Bodies that next to nothing of each other is in front of are told so, and not that supports hold them.
#[test]
fn next_to_nothing_in_front_is_nothing() {
    let lower = (MeshSource::block([1.0, 0.5], [4, 2]), 1e9);
    let upper = (MeshSource::block([1.0, 0.5], [3, 2]), 1e9);
    let body = bodies(lower, upper, Some([1.0 - 1e-9, 0.5].into()), vec![1.0])
        .pair("upper:bottom", 0.0, "lower:top")
        .support("lower:bottom", &[Axis::X, Axis::Y])
        .support("upper:top", &[Axis::X, Axis::Y]);
    let message = Model::build(&body).unwrap_err().to_string();
    assert!(message.contains("is in front of") && !message.contains("supports hold"), "{message}");
}
