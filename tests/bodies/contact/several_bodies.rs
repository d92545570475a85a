//! Bodies beside each other: each has the motions and the answer that it has alone.

use crate::common::prelude::*;
use crate::refused::bodies::TWO;
use stickslip::base::UnitSystem;
use stickslip::body::constraints::{Tie, unresisted_motions};
use stickslip::body::fem::overlaps;

fn joined(bodies: Vec<Body>) -> Mesh {
    Mesh::clone(&MeshSource::Bodies(bodies).build().unwrap())
}

fn two() -> Mesh {
    let square = || MeshSource::block([2.0, 1.0], [4, 2]);
    joined(vec![Body::new("lower", square()), Body::new("upper", square()).at([0.0, 3.0])])
}

fn si(dimension: usize) -> UnitSystem {
    Description::new(block(&[1.0, 1.0], &[1, 1]), Material::new(1.0, 0.0), vec![1.0]).system(dimension)
}

/// How many independent ones there are, by Gram and Schmidt.
fn rank(motions: &[Vec<f64>]) -> usize {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for motion in motions {
        let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let mut remainder: Vec<f64> = motion.iter().map(|x| x / length(motion)).collect();
        for b in &basis {
            let along: f64 = b.iter().zip(&remainder).map(|(b, x)| b * x).sum();
            remainder.iter_mut().zip(b).for_each(|(x, b)| *x -= along * b);
        }
        let left = length(&remainder);
        if left > 1e-6 {
            basis.push(remainder.iter().map(|x| x / left).collect());
        }
    }
    basis.len()
}

#[test]
fn the_motions_of_free_bodies_span_the_null_space() {
    let tets = MeshSource::segmented(
        &[vec![1.0], vec![2.0], vec![1.0]],
        &[vec![1], vec![2], vec![1]],
        None,
        Some(CellKind::Tetrahedron),
    );
    let space = joined(vec![
        Body::new("a", MeshSource::block([1.0; 3], [2; 3])),
        Body::new("b", tets.unwrap()).at([5.0, 0.0, 1.0]),
        Body::new("c", MeshSource::block([1e-3; 3], [1; 3])).at([0.0, 0.0, 9.0]),
    ]);
    let ring = two().into_axisymmetric().unwrap();
    for (mesh, count) in [(two(), 6), (space, 18), (ring, 2)] {
        let dofs = Dofs::new(&mesh, |_, _| false);
        let motions: Vec<Vec<f64>> =
            rigid_motions(&mesh, &dofs).iter().map(|motion| motion.displacements(&mesh, &dofs)).collect();
        assert_eq!((motions.len(), rank(&motions)), (count, count));
        let k = assemble(&mesh, &dofs, Element::Bilinear, |_| Elasticity::isotropic(1.0, 0.3)).unwrap();
        for motion in &motions {
            let largest = largest(motion);
            assert!(k.times(motion).unwrap().iter().all(|f| f.abs() < 1e-13 * largest), "{count}");
        }
    }
}

#[test]
fn supports_of_one_body_leave_the_other_free() {
    let mesh = two();
    let free = |fixed: &dyn Fn(usize, usize) -> bool| -> Vec<String> {
        rigid_motions(&mesh, &Dofs::new(&mesh, fixed)).iter().map(ToString::to_string).collect()
    };
    let upper = [
        "`upper`: a translation along (1, 0)",
        "`upper`: a translation along (0, 1)",
        "`upper`: a rotation about (1, 3.5) m",
    ];
    assert_eq!(free(&|node, _| mesh.nodes[node][1] == 0.0), upper);
    assert_eq!(
        free(&|node, c| c == 1 && [0.0, 3.0].contains(&mesh.nodes[node][1])),
        ["`lower`: a translation along (1, 0)", "`upper`: a translation along (1, 0)"]
    );
    let all = rigid_motions(&mesh, &Dofs::new(&mesh, |_, _| false));
    let sum = |weights: [f64; 6]| RigidMotion::combination(&all, &weights).unwrap();
    let described = |weights| (sum(weights).to_string(), sum(weights).against(&si(2)));
    let (words, against) = described([0.0, 1.0, 0.0, 0.0, 0.0, 2.0]);
    assert_eq!(words, "`lower`: a translation along (0, 1); `upper`: a rotation about (1, 3.5) m");
    assert_eq!(against, format!("the bodies against {words}"));
    let (words, against) = described([0.0, 1.0, 0.0, 1e-9, 0.0, 0.0]);
    assert_eq!(
        (words.as_str(), against.as_str()),
        ("`lower`: a translation along (0, 1)", "`lower` against a translation along (0, 1)")
    );
    assert_eq!(described([0.0, 1.0, 0.0, 0.0, 3.0, 0.0]).0, "`lower`, `upper`: a translation along (0, 1)");
    // One body alone is told as ever.
    let one = block(&[2.0, 1.0], &[4, 2]);
    let hinge = rigid_motions(&one, &Dofs::new(&one, |node, _| node == 2));
    assert_eq!(hinge[0].against(&si(2)), "the body against a rotation about (1, 0) m");
}

/// What ties bodies makes their motions one.
#[test]
fn tied_bodies_move_together() {
    let mesh = joined(vec![
        Body::new("lower", MeshSource::block([2.0, 1.0], [4, 2])),
        Body::new("upper", MeshSource::block([2.0, 1.0], [4, 2])).at([0.0, 1.0]),
        Body::new("beside", MeshSource::block([1.0, 1.0], [1, 1])).at([5.0, 0.0]),
    ]);
    let dofs = Dofs::new(&mesh, |_, _| false);
    let touching = mesh.touching_nodes(&mesh.bodies());
    assert_eq!(touching.len(), 5);
    let equal = |c: usize| {
        let axis = |sign: f64| [0, 1, 2].map(|k| if k == c { sign } else { 0.0 });
        touching.iter().map(move |&(a, b)| vec![(b, axis(2.0)), (a, axis(-2.0))]).collect::<Vec<Tie>>()
    };
    let free = |ties: &[Tie]| {
        let motions = unresisted_motions(&mesh, &dofs, &[], ties);
        for (motion, tie) in motions.iter().flat_map(|motion| ties.iter().map(move |tie| (motion, tie))) {
            let u = dofs.displacements(&motion.displacements(&mesh, &dofs));
            let form: f64 = tie.iter().map(|(node, c)| (0..3).map(|k| c[k] * u[*node][k]).sum::<f64>()).sum();
            assert!(form.abs() < 1e-13, "{motion}: {form:e}");
        }
        let vectors: Vec<Vec<f64>> = motions.iter().map(|motion| motion.displacements(&mesh, &dofs)).collect();
        assert_eq!(rank(&vectors), motions.len());
        motions.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    let glued = free(&[equal(0), equal(1)].concat());
    assert_eq!(
        glued[..2],
        ["`lower`, `upper`: a translation along (1, 0)", "`lower`, `upper`: a translation along (0, 1)"]
    );
    assert_eq!(glued.len(), 6);
    assert!(glued[2].starts_with("`lower`, `upper`: a rotation about "), "{}", glued[2]);
    assert!(glued[3..].iter().all(|words| words.starts_with("`beside`: ")), "{glued:?}");
    // Tied along the normal alone they slide past each other.
    assert_eq!(free(&equal(1)).len(), 7);
    // To the ground, too.
    assert_eq!(free(&[vec![(0, [1.0, 0.0, 0.0])]]).len(), 8);
    assert_eq!(free(&[]).len(), 9);
}

fn solve(scene: &Scene) -> (Model, HistoryOutcome) {
    let model = discretise(scene).unwrap();
    let outcome = common::run(scene, &model, &mut ());
    assert_eq!(outcome.status, Status::Converged);
    (model, outcome)
}

/// The scene of one of the bodies of [`TWO`] alone, without a name.
fn only_body(name: &str) -> String {
    let tables = TWO.split("\n\n").filter(|table| !table.contains(if name == "lower" { "upper" } else { "lower" }));
    let text = tables.collect::<Vec<_>>().join("\n\n").replace(&format!("{name}:"), "");
    let text = text.replace(&format!("[[body]]\nname = \"{name}\"\n"), "").replace("[body.", "[");
    text.replace("at = [0.1, 0.7]\n", "").replace("size = [0.6", "origin = [0.1, 0.7]\nsize = [0.6")
}

#[test]
fn a_single_body_is_the_same_to_the_last_bit() {
    for name in ["lower", "upper"] {
        let scene = parsed(&only_body(name));
        let other = if name == "lower" { "upper" } else { "lower" };
        let named = TWO.split("\n\n").filter(|table| !table.contains(other)).collect::<Vec<_>>().join("\n\n");
        let (model, outcome) = solve(&scene);
        let (of_body, own) = solve(&parsed(&named));
        assert_eq!(of_body.mesh.boundary_names()[0], format!("{name}:bottom"));
        assert_eq!((&model.mesh.nodes, &model.constraints.dofs), (&of_body.mesh.nodes, &of_body.constraints.dofs));
        assert_eq!(outcome.state, own.state);
        assert_eq!(model.constraints.rigid_motions[0].to_string(), of_body.constraints.rigid_motions[0].to_string());
    }
}

#[test]
fn bodies_that_do_not_meet_have_their_own_answers() {
    let (both, outcome) = solve(&parsed(&TWO));
    assert_eq!(both.constraints.rigid_motions.len(), 2);
    let bodies = both.mesh.bodies();
    for (k, name) in ["lower", "upper"].into_iter().enumerate() {
        let (model, own) = solve(&parsed(&only_body(name)));
        let (all, u) =
            (both.constraints.dofs.displacements(&outcome.state.u), model.constraints.dofs.displacements(&own.state.u));
        let largest = u.iter().flatten().fold(0.0_f64, |m, u| m.max(u.abs()));
        for (node, u) in bodies.nodes(k).zip(u) {
            assert!((0..3).all(|c| (all[node][c] - u[c]).abs() < 1e-9 * largest), "{name}");
        }
        let forces = |model: &Model, p_n: &[f64]| -> Vec<f64> {
            let of = model.contact.boundaries.iter().find(|boundary| {
                boundary.name.ends_with("bottom") && boundary.name.contains(name) || boundary.name == "bottom"
            });
            of.unwrap().nodes.iter().map(|&i| p_n[i]).collect()
        };
        let (here, there) = (forces(&both, &outcome.state.p_n), forces(&model, &own.state.p_n));
        let sum: f64 = there.iter().sum();
        assert!(sum > 0.0 && here.len() == there.len());
        assert!(here.iter().zip(&there).all(|(a, b)| (a - b).abs() < 1e-9 * sum), "{name}: {here:?}, {there:?}");
    }
}

/// The verdict names the body that comes free.
#[test]
fn verdicts_name_the_body() {
    let unheld = edit(&TWO, "[[support]]\nboundary = \"upper:left\"\nfix = [\"x\"]\n", "");
    let pulled = edit(&unheld, "traction = [1e6, -2e7]", "traction = [0, 2e7]");
    let scene = parsed(&pulled);
    let model = discretise(&scene).unwrap();
    assert_eq!(model.constraints.rigid_motions.len(), 4);
    let report = stickslip::run::Run::new(&scene).unwrap().solve(&mut ()).unwrap();
    assert_eq!(report.status, Status::NoEquilibrium);
    assert!(report.explanation.reason.contains("the loads drive `upper`: a "), "{}", report.explanation.reason);
    assert_eq!(
        report.bodies.iter().map(|body| (body.name.as_str(), body.nodes, body.cells)).collect::<Vec<_>>(),
        [("lower", 45, 32), ("upper", 30, 20)]
    );
    // Without any contact the matrix itself is singular.
    let floor =
        "[[contact]]\nboundary = \"upper:bottom\"\nfriction = 0.2\nobstacle = { kind = \"plane\", gap = 1e-6 }\n";
    let scene = parsed(&edit(&unheld, floor, ""));
    let report = stickslip::run::Run::new(&scene).unwrap().solve(&mut ()).unwrap();
    assert_ne!(report.status, Status::Converged);
    assert!(report.explanation.reason.contains("`upper`"), "{:?}: {}", report.status, report.explanation.reason);
}

#[test]
fn bodies_inside_one_another_are_found() {
    const THIRD: f64 = 1.0 / 3.0;
    let cubes = |by: [f64; 3]| {
        joined(vec![
            Body::new("a", MeshSource::block([1.0; 3], [3; 3])),
            Body::new("b", MeshSource::block([0.5; 3], [2; 3])).at(by),
        ])
    };
    let found = |mesh: &Mesh, apart: bool| {
        let found = overlaps(mesh, &mesh.bodies(), |a, b| apart && (a, b) == (0, 1));
        found.iter().map(|overlap| (overlap.bodies, mesh.nodes[overlap.node])).collect::<Vec<_>>()
    };
    assert_eq!(found(&cubes([0.9, 0.1, 0.1]), true), [((0, 1), [1.0, THIRD, THIRD])]);
    assert_eq!(found(&cubes([0.9, 0.1, 0.1]), false), []);
    // Beside, on one another, and within rounding of that.
    for x in [1.0 - 1e-9, 1.0, 1.1] {
        assert_eq!(found(&cubes([x, 0.1, 0.1]), true), []);
    }
    assert_eq!(found(&cubes([0.999, 0.1, 0.1]), true).len(), 1);
    // All of it inside.
    assert_eq!(found(&cubes([0.2, 0.2, 0.2]), true), [((0, 1), [THIRD; 3])]);
    // The larger elements have no node in the smaller ones, but these in them.
    let plates = joined(vec![
        Body::new("fine", MeshSource::block([0.2, 0.2], [4, 4])).at([0.4, 0.9]),
        Body::new(
            "coarse",
            MeshSource::segmented(&[vec![1.0], vec![1.0]], &[vec![1], vec![1]], None, Some(CellKind::Triangle6))
                .unwrap(),
        ),
    ]);
    assert_eq!(found(&plates, true)[0].0, (0, 1));
}

/// A force on nothing but bodies that are held apart, from Rust.
#[test]
fn materials_of_bodies_from_rust() {
    let bodies = vec![
        Body::new("foot", MeshSource::block([1.0, 1.0], [2, 2])),
        Body::new("head", MeshSource::block([1.0, 1.0], [2, 2])).at([0.0, 2.0]),
    ];
    let materials = [("foot".to_string(), Material::new(1e9, 0.3)), ("head".to_string(), Material::new(2e9, 0.2))];
    let description = Description::new(MeshSource::Bodies(bodies), Material::of_bodies(materials).unwrap(), vec![1.0]);
    let held = description.support("foot:bottom", &[Axis::X, Axis::Y]).support("head:top", &[Axis::X, Axis::Y]);
    let model = Model::build(&held).unwrap();
    assert!(model.constraints.rigid_motions.is_empty() && model.materials()[0] != model.materials()[7]);
    let nothing = Material::of_bodies([]).unwrap_err();
    assert_eq!((nothing.key.as_str(), nothing.message.as_str()), ("body", "there is no body"));
}
