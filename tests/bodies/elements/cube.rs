//! Three dimensions as a whole: the cube under the paper's loads, slabs that are plane, scenes that are turned.

use crate::common::nodes::Count;
use crate::common::prelude::*;

/// BN on condensed matrices, which solves each increment as it stands.
fn solve(scene: &Scene) -> (Model, HistoryOutcome, Keep) {
    let model = discretise(scene).unwrap();
    let settings = undivided(&model, scene, Method::BN);
    let (outcome, keep) = recorded(&model, &scene.time.all(), &settings, LinearAlgebra::condensed());
    assert_eq!(outcome.status, Status::Converged, "{:?}", outcome.records.last());
    (model, outcome, keep)
}

fn undivided(model: &Model, scene: &Scene, method: Method) -> HistorySettings {
    let settings = settings_of(model, method);
    HistorySettings { halvings: 0, ..settings.until(100, scene.solver.tolerance) }
}

/// The cubes with `n`³ elements: each friction, load and number of increments.
fn cubes(n: usize) -> impl Iterator<Item = Scene> {
    let [forwards, sideways] = ["load[2].traction=[0,0,0]", "load[1].traction=[0,10e6,0]"];
    let loads = [vec![forwards], vec![forwards, sideways], Vec::new()];
    let steps = || [2, 10].into_iter();
    let variants = loads.into_iter().flat_map(move |load| steps().map(move |steps| (load.clone(), steps)));
    let variants = variants.flat_map(|variant| [0.1, 0.4, 0.8, 2.0].map(|mu| (mu, variant.clone())));
    variants.map(move |(mu, (load, steps))| {
        let [mesh, mu, steps] = [
            format!("mesh.elements=[{n},{n},{n}]"),
            format!("contact.friction={mu}"),
            format!("time.increments={steps}"),
        ];
        common::scene("cube.toml", &[&[mesh.as_str(), &mu, &steps], &load[..]].concat())
    })
}

/// Every increment of the cubes is solved by BN as it stands, without parts or rescue, in 4.07 and 4.66 iterations on average.
#[test]
fn cubes_by_bn() {
    iterations_by_bn(&[4, 6], 4.2);
}

#[test]
#[ignore = "half a minute without optimisation"]
fn larger_cubes_by_bn() {
    iterations_by_bn(&[10], 4.7);
}

/// At most so many iterations an increment on cubes of these sizes.
fn iterations_by_bn(sizes: &[usize], most: f64) {
    let mut count = Count::default();
    for scene in sizes.iter().flat_map(|&n| cubes(n)) {
        let (_, outcome, _) = solve(&scene);
        assert!(outcome.records.iter().all(|r| !r.rescued), "{scene:?}");
        count.add(&outcome);
    }
    println!("{sizes:?}: {count}");
    assert_eq!(count.increments, 144 * sizes.len());
    assert!(count.mean() <= most, "{count}");
}

/// The interior point method, from a cold start in each increment, ends where BN ends.
#[test]
fn cubes_by_the_interior_point_method() {
    let mut count = Count::default();
    for scene in [4, 6].into_iter().flat_map(cubes) {
        let (model, _, by_bn) = solve(&scene);
        let settings = undivided(&model, &scene, Method::Ip);
        let (outcome, by_ip) = recorded(&model, &scene.time.all(), &settings, LinearAlgebra::condensed());
        assert_eq!(outcome.status, Status::Converged, "{scene:?}");
        count.add(&outcome);
        let difference = largest_difference(&forces(&model, &by_ip), &forces(&model, &by_bn));
        assert!(difference < 1e-8, "{difference:e}: {scene:?}");
    }
    println!("{count}");
    assert!(count.increments == 288 && count.mean() <= 15.0, "{count}");
}

/// The setting of the paper, with its one r for all cubes and R, ends at the same forces.
#[test]
fn cubes_in_the_setting_of_the_paper() {
    let mut count = Count::default();
    for scene in cubes(4) {
        let (model, _, by_default) = solve(&scene);
        // It stops by its own test, with errors up to 1e-6.
        let settings = settings_of(&model, Method::PaperBn).until(200, 1e-6);
        let (outcome, by_paper) = recorded(&model, &scene.time.all(), &settings, LinearAlgebra::condensed());
        assert_eq!(outcome.status, Status::Converged, "{scene:?}");
        count.add(&outcome);
        let difference = largest_difference(&forces(&model, &by_paper), &forces(&model, &by_default));
        assert!(difference < 1e-5, "{difference:e}: {scene:?}");
    }
    println!("{count}");
}

/// Nearly incompressible elements that do not lock, and a layer a million times softer: BN needs neither parts nor rescue.
#[test]
fn uneven_cubes() {
    let incompressible = |poisson: &str| format!("material.poisson={poisson}");
    let soft = "[[0.25,210e9,0.3],[0.25,210e3,0.3]]";
    for material in [
        &["mesh.element=\"b-bar\"".to_string(), incompressible("0.499")][..],
        &["mesh.element=\"b-bar\"".to_string(), incompressible("0.499999")],
        &[format!("material.layers={soft}")],
    ] {
        let mut count = Count::default();
        for mu in [0.1, 0.4, 0.8, 2.0] {
            let mu = format!("contact.friction={mu}");
            let overrides = ["mesh.elements=[4,4,4]", &mu].into_iter().chain(material.iter().map(String::as_str));
            let (_, outcome, _) = solve(&common::scene("cube.toml", &overrides.collect::<Vec<_>>()));
            assert!(outcome.records.iter().all(|r| !r.rescued), "{mu} {material:?}");
            count.add(&outcome);
        }
        println!("{material:?}: {count}");
        assert!(count.mean() < 4.2, "{material:?}: {count}");
    }
}

/// A foundation of rubber under a cube of steel, much friction, the whole load at once: BN gives up, and the interior
/// point method ends the increment.
#[test]
fn a_rescue() {
    let overrides = [
        "mesh.elements=[4,4,4]",
        "material.layers=[[0.3,210e3,0.3]]",
        "contact.friction=2",
        "load[2].traction=[0,0,0]",
        "time.increments=2",
    ];
    let (_, outcome, _) = solve(&common::scene("cube.toml", &overrides));
    assert!(outcome.records.iter().any(|r| r.rescued && r.parts == 1), "the test has lost its case");
}

/// A block that only an oblique plane can hold comes to stand on one node. Started with all of them closed, BN would find nothing
/// that holds it on its way.
#[test]
fn a_body_that_comes_to_stand_on_a_node() {
    let text = scene! { r#"
[mesh] kind = "block", size = [1, 1, 1], elements = [1, 4, 4]
[material] young = 210e9, poisson = -0.5
[[support]] boundary = "top", fix = ["x", "y"]
[[contact]] boundary = "bottom", friction = 1
obstacle = { kind = "plane", gap = 1e-6, normal = [0.0996921, 0.186155, -1] }
[[load]] boundary = "top", traction = [0, 0, -1e6]
[time] end = 1, increments = 4
"# };
    let (_, outcome, _) = solve(&parsed(&text));
    assert_eq!(outcome.state.p_n.iter().filter(|p| **p > 0.0).count(), 1);
    assert!(outcome.records.iter().all(|record| !record.rescued && record.parts == 1 && record.iterations <= 3));
}

/// A slab of the plane x, z, one element thick and held across, does what the block in plane strain does, increment
/// by increment, iteration by iteration.
#[test]
fn a_slab_is_plane() {
    let n = 12;
    let block =
        common::block(&[&format!("mesh.elements=[{n},{n}]"), "time.increments=10", "solver.setting=\"default\""]);
    let thickness = 0.125;
    let size = format!("mesh.size=[1,{thickness},1]");
    let elements = format!("mesh.elements=[{n},1,{n}]");
    let held = "[[support]]\nboundary = \"front\"\nfix = [\"y\"]\n[[support]]\nboundary = \"back\"\nfix = [\"y\"]\n";
    let text = CUBE.to_string() + held;
    let slab = parsed_with(&text, &[&size, &elements, "load[2].traction=[0,0,0]"]);
    let ((plane, flat, flat_states), space) = (solve(&block), discretise(&slab).unwrap());
    let in_plane = |contact: &ContactNode| {
        plane.contact.nodes.iter().position(|c| (c.position[0] - contact.position[0]).abs() < 1e-9).unwrap()
    };
    // Alone, either of the two nodes across the slab is softer; with the same r, for half of the thickness, the way is the same.
    let mut settings = undivided(&space, &slab, Method::BN);
    let natural = FormulationScaling::natural(&plane.problem);
    let across = |r: &[f64]| space.contact.nodes.iter().map(|contact| 0.5 * thickness * r[in_plane(contact)]).collect();
    (settings.conventions.r_n, settings.conventions.r_t) = (across(&natural.r_n), across(&natural.r_t));
    let (thick, thick_states) = recorded(&space, &slab.time.all(), &settings, LinearAlgebra::condensed());
    assert_eq!(thick.status, Status::Converged);
    assert_eq!(iterations(&flat), iterations(&thick));
    assert_eq!(space.contact.nodes.len(), 2 * plane.contact.nodes.len());
    for (flat, thick) in flat_states.states.iter().zip(&thick_states.states) {
        let largest = largest(&flat.p_n);
        let u = plane.constraints.dofs.displacements(&flat.u);
        let longest = u.iter().flatten().fold(0.0_f64, |m, u| m.max(u.abs()));
        for (x, found) in space.mesh.nodes.iter().zip(space.constraints.dofs.displacements(&thick.u)) {
            let node = plane.mesh.nodes.iter().position(|y| (y[0] - x[0]).hypot(y[1] - x[2]) < 1e-9).unwrap();
            let error = [found[0] - u[node][0], found[1], found[2] - u[node][1]];
            assert!(error.iter().all(|e| e.abs() < 1e-9 * longest), "{x:?}: {error:?}");
        }
        for (i, contact) in space.contact.nodes.iter().enumerate() {
            let k = in_plane(contact);
            // Either face of the slab has half of the force.
            for (found, exact) in [(thick.p_n[i], flat.p_n[k]), (thick.p_t[i], flat.p_t[k]), (thick.p_o[i], 0.0)] {
                assert!((found / (0.5 * thickness) - exact).abs() < 1e-9 * largest, "{i}: {found} {exact}");
            }
        }
    }
}

/// Contact forces as vectors, of each increment.
fn forces(model: &Model, keep: &Keep) -> Vec<Vec<[f64; 3]>> {
    let of = |state: &stickslip::solver::State| {
        let force = |(i, contact): (usize, &ContactNode)| {
            let (n, [t, o]) = (contact.facing.normal, contact.facing.tangents);
            [0, 1, 2].map(|c| state.p_n[i] * n[c] + state.p_t[i] * t[c] + state.p_o[i] * o[c])
        };
        model.contact.nodes.iter().enumerate().map(force).collect()
    };
    keep.states.iter().map(of).collect()
}

fn largest_difference(a: &[Vec<[f64; 3]>], b: &[Vec<[f64; 3]>]) -> f64 {
    let pairs = a.iter().flatten().flatten().zip(b.iter().flatten().flatten());
    let largest = a.iter().flatten().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    pairs.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / largest
}

fn same_counts(a: &HistoryOutcome, b: &HistoryOutcome) -> bool {
    a.records.len() == b.records.len()
        && a.records.iter().zip(&b.records).all(|(a, b)| (a.iterations, a.contact) == (b.iterations, b.contact))
}

/// The choice of the tangents changes neither the iterations nor the forces.
#[test]
fn tangents_do_not_matter() {
    let mesh = "mesh.elements=[5,5,5]";
    let (model, first, keep) = solve(&common::scene("cube.toml", &[mesh]));
    for tangent in ["[0.6,0.8,0]", "[-0.28,0.96,0]", "[0,-1,0]"] {
        let tangent = format!("contact.obstacle.tangent={tangent}");
        let (other, turned, states) =
            solve(&common::scene("cube.toml", &[mesh, "contact.obstacle.normal=[0,0,-1]", &tangent]));
        assert!(same_counts(&first, &turned), "{tangent}");
        let difference = largest_difference(&forces(&model, &keep), &forces(&other, &states));
        assert!(difference < 1e-9, "{tangent}: {difference:e}");
    }
}

/// A turn about an oblique axis: 3-4-5 about z, then by 45° about x.
fn turn([x, y, z]: [f64; 3]) -> [f64; 3] {
    let [x, y] = [0.6 * x - 0.8 * y, 0.8 * x + 0.6 * y];
    [x, FRAC_1_SQRT_2 * (y - z), FRAC_1_SQRT_2 * (y + z)]
}

/// The whole scene, mesh, loads and obstacle, turned: results turn with it, iterations stay.
#[test]
fn a_turned_scene_gives_turned_results() {
    let text = include_str!("../../../data/meshes/cube_hexahedra.msh");
    let solve_turned = |name: &str, turn: &dyn Fn([f64; 3]) -> [f64; 3]| {
        let nodes = text.find("$Nodes").unwrap()..text.find("$EndNodes").unwrap();
        let line = |line: &str| match line.split(' ').map(str::parse).collect::<Result<Vec<f64>, _>>() {
            Ok(x) if x.len() == 3 => turn([x[0], x[1], x[2]]).map(|c| c.to_string()).join(" "),
            _ => line.to_string(),
        };
        let turned = text[nodes.clone()].lines().map(line).collect::<Vec<_>>().join("\n") + "\n";
        let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        std::fs::write(&file, [&text[..nodes.start], &turned, &text[nodes.end..]].concat()).unwrap();
        let vector = |x: [f64; 3]| turn(x).map(|c| format!("{c:e}")).join(",");
        let scene = format!(
            r#"
            mesh = {{ kind = "gmsh", file = '{}' }}
            material = {{ young = 210e9, poisson = 0.3 }}
            support = [{{ boundary = "left", fix = ["x", "y", "z"] }}]
            contact = [{{ boundary = "bottom", friction = 0.4, obstacle = {{ kind = "plane", gap = 1e-5,
                normal = [{}], tangent = [{}] }} }}]
            load = [
                {{ boundary = "top", traction = [{}], history = [[0, 0], [1, 1]] }},
                {{ boundary = "top", traction = [{}], history = [[0, 0], [1, 1], [2, 0]] }},
                {{ boundary = "top", traction = [{}], history = [[1, 0], [2, 1]] }},
            ]
            time = {{ end = 2, increments = 10 }}
            "#,
            file.display(),
            vector([0.0, 0.0, -1.0]),
            vector([1.0, 0.0, 0.0]),
            vector([0.0, 0.0, -10e6]),
            vector([-3e6, 0.0, 0.0]),
            vector([0.0, 3e6, 0.0]),
        );
        solve(&parsed(&scene))
    };
    let (model, upright, keep) = solve_turned("upright.msh", &|x| x);
    let (other, oblique, states) = solve_turned("oblique.msh", &turn);
    assert!(same_counts(&upright, &oblique), "{:?} {:?}", upright.records, oblique.records);
    assert!(upright.records.iter().any(|r| r.contact.slip > 0) && upright.records.iter().any(|r| r.contact.stick > 0));
    let turned: Vec<Vec<_>> =
        forces(&model, &keep).into_iter().map(|forces| forces.into_iter().map(turn).collect()).collect();
    let difference = largest_difference(&turned, &forces(&other, &states));
    assert!(difference < 1e-9, "{difference:e}");
    let displacements = |model: &Model, keep: &Keep| -> Vec<Vec<[f64; 3]>> {
        keep.states.iter().map(|state| model.constraints.dofs.displacements(&state.u)).collect()
    };
    let turned: Vec<Vec<_>> =
        displacements(&model, &keep).into_iter().map(|u| u.into_iter().map(turn).collect()).collect();
    let difference = largest_difference(&turned, &displacements(&other, &states));
    assert!(difference < 1e-9, "{difference:e}");
}
