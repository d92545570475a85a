//! Meshes that refine themselves: what they cost, and how fast their errors fall.

use crate::common::prelude::*;
use stickslip::run::{RunError, tightening};

/// A cylinder that is pressed into a block and pushed sideways, in partial slip.
const CYLINDER: &str = r#"
    [mesh] kind = "block", size = [1, 1], elements = [8, 8], cells = "triangle", refine = 0.05
    [material] young = 210e9, poisson = 0.3, plane = "strain"
    [[support]] boundary = "bottom", fix = ["x", "y"]
    [[contact]] boundary = "top", friction = 0.3
    [contact.obstacle] kind = "cylinder", radius = 10, apex = [0.5, 1], normal = [0, 1], tangent = [1, 0]
    approach = [[0, 0], [1, 1e-4]]
    motion.translation = [[1, 0, 0], [2, 2.2e-5, 0]]
    [time] end = 2, increments = 8
    [output] times = [1, 2]
"#;

/// Solves the scene of `text`; returns its report and the number of its nodes.
fn solved_scene(text: &str, overrides: &[&str]) -> (RunReport, usize) {
    let scene = parsed_with(&scene_text(text), overrides);
    let run = Run::new(&scene).unwrap();
    (run.solve(&mut ()).unwrap(), run.model().mesh.nodes.len())
}

fn error_of(report: &RunReport) -> f64 {
    report.estimates.discretisation.unwrap()
}

/// The limits are those of uniform meshes with up to 263 169 nodes and of refined ones.
#[test]
fn a_cylinder_on_a_refined_mesh_is_within_a_percent() {
    let (report, nodes) = solved_scene(CYLINDER, &[]);
    let (force, work) = (report.largest_force.as_ref().unwrap().force[1].abs(), report.friction.unwrap().friction_work);
    println!("{nodes} nodes: error {:.3}, force {force:.5e} N/m, work {work:.4} J/m", error_of(&report));
    assert!(nodes < 4000 && error_of(&report) < 0.055, "{nodes} {}", error_of(&report));
    assert!((force / 7.5335e6 - 1.0).abs() < 0.01 && (work / 1.136 - 1.0).abs() < 0.01, "{force} {work}");
}

/// The part of a cylinder within `angle` of its lowest point that is pressed on a plane, with so many elements along its
/// radius, and so many facets.
fn polygon(angle: f64, elements: [usize; 2]) -> Scene {
    let text = r#"
        [mesh] kind = "block", size = [1, 1], elements = [1, 1], cells = "triangle", refine = 0.02
        [material] young = 1e9, poisson = 0.3, plane = "strain"
        [[support]] boundary = "left", fix = ["x", "y"], displacement = [0, -0.012]
        [[contact]] boundary = "right", friction = 0, obstacle = { kind = "plane" }
        [time] end = 1, increments = 1
    "#;
    let mesh = moved(block(&[0.7, 1.0], &elements).into_simplices(), |[s, t, _]| {
        let angle = 2.0 * angle * (t - 0.5);
        [(0.3 + s) * angle.sin(), -(0.3 + s) * angle.cos(), 0.0]
    });
    let mut scene = parsed_with(&scene_text(text), &[]);
    scene.description.mesh = mesh.into();
    scene
}

/// Each facet is nearly as long as the contact is wide. The polygon becomes round: peak pressure and force are those of
/// Hertz.
#[test]
fn a_polygon_that_refines_itself_rolls() {
    let report = Run::new(&polygon(0.5 * FRAC_PI_2, [3, 12])).unwrap().solve(&mut ()).unwrap();
    let force = report.forces.last().unwrap().resultant.sums.sum_p_n;
    let peak = report.largest_pressure.as_ref().unwrap().pressure.unwrap();
    let hertz = (force * 1e9 / (1.0 - 0.09) / PI).sqrt();
    let width = (4.0 * force * (1.0 - 0.09) / (PI * 1e9)).sqrt();
    println!("half-width {width:.4}, peak {:.4} of Hertz, error {:.3}", peak / hertz, error_of(&report));
    assert!((peak / hertz - 1.0).abs() < 0.03, "{peak} {hertz}");
}

/// The surface of a half cylinder and of a tall half ellipse ends along the normal of the plane. Facets there may lean away, by
/// the error of the surface; a straight side beside a corner may not be along it.
#[test]
fn a_round_surface_may_end_along_the_normal() {
    for tall in [1.0, 2.0] {
        let mut scene = polygon(FRAC_PI_2, [3, 10]);
        let MeshSource::Given(mesh) = &scene.description.mesh else { panic!() };
        scene.description.mesh = moved((**mesh).clone(), |[x, y, z]| [x, tall * y, z]).into();
        let report = Run::new(&scene).unwrap().solve(&mut ()).unwrap();
        assert!(report.coarser_meshes.len() > 4 && report.status == Status::Converged, "{:?}", report.coarser_meshes);
    }
    let mut mesh = block(&[1.0, 1.0], &[4, 4]);
    let side = mesh.boundary("left").unwrap().facets.clone();
    mesh.boundaries.iter_mut().find(|boundary| boundary.name == "bottom").unwrap().facets.extend(side);
    let down = Obstacle { normal: Some([0.0, -1.0].into()), ..Obstacle::at_rest(Shape::Plane { gap: 0.0 }) };
    let bottom = mesh.boundary("bottom").unwrap();
    assert!(PlacedObstacle::new(&mesh, bottom, &down).unwrap().faces_away(&mesh, bottom).is_some());
}

/// Between the nodes of the first mesh a cylinder is inside the body: a contact is not seen, and nodes are put there.
#[test]
fn an_obstacle_between_nodes_is_found() {
    let text = CYLINDER.replace("apex = [0.5, 1]", "apex = [0.4375, 1]").replace("radius = 10", "radius = 1");
    let (report, nodes) = solved_scene(&text, &["time.end=1", "output.times=[1]"]);
    let force = report.largest_force.as_ref().map_or(0.0, |force| force.magnitude);
    println!("{nodes} nodes: error {:.3}, force {force:.5e} N/m", error_of(&report));
    assert!(error_of(&report) < 0.055 && report.coarser_meshes[0].error == 1.0, "{:?}", report.coarser_meshes);
    assert!(force > 1e6 && report.warnings.iter().all(|warning| warning.kind != WarningKind::NO_CONTACT), "{force}");
}

/// New nodes on the circle would fold the cells of a polygon with few facets.
#[test]
fn polygons_of_flat_cells_are_refused() {
    let error = Run::new(&polygon(0.5 * FRAC_PI_2, [12, 4])).unwrap_err().to_string();
    assert!(error.contains("the first mesh is too coarse to become so"), "{error}");
}

/// Where stresses are singular, at the ends of a side that is held, errors fall as fast as elsewhere: as N^(-1/2) with
/// linear triangles and as 1/N with those of second order. Uniform meshes reach N^(-0.36) with both. Errors are the true ones in
/// the energy norm: under loads alone their square is the energy that is missing.
#[test]
fn singular_corners_do_not_slow_a_refined_mesh() {
    let block = r#"
        [mesh] kind = "block", size = [1, 1], elements = [4, 4], cells = "triangle"
        [material] young = 1e9, poisson = 0.3, plane = "strain"
        [[support]] boundary = "bottom", fix = ["x", "y"]
        [[load]] boundary = "top", traction = [0, -1e6]
        [time] end = 1, increments = 1
    "#;
    let energy = |overrides: &[&str]| {
        let scene = parsed_with(&scene_text(block), overrides);
        let run = Run::new(&scene).unwrap();
        let mut last = Recording::last();
        let report = run.solve(&mut last).unwrap();
        let end = &last.increments[0];
        let energy: f64 = end.force.iter().zip(&end.state.u).map(|(force, u)| 0.5 * force * u).sum();
        (run.model().mesh.nodes.len() as f64, energy, error_of(&report))
    };
    let (_, exact, _) = energy(&["mesh.cells=\"triangle6\"", "mesh.refine=0.0003"]);
    for (cells, order, refined) in [("triangle", 0.5, ["0.08", "0.02"]), ("triangle6", 1.0, ["0.02", "0.002"])] {
        let cells = format!("mesh.cells=\"{cells}\"");
        let found = |meshes: [String; 2]| {
            let [coarse, fine] = meshes.map(|mesh| {
                let (nodes, energy, told) = energy(&[&cells, &mesh]);
                let error = (1.0 - energy / exact).sqrt();
                println!("{cells} {mesh}: {nodes} nodes, error {error:.5}, told {told:.5}");
                assert!((told / error - 1.0).abs() < 0.5, "{told} {error}");
                (nodes, error)
            });
            (coarse.1 / fine.1).ln() / (fine.0 / coarse.0).ln()
        };
        let adaptive = found(refined.map(|error| format!("mesh.refine={error}")));
        let uniform = found([8, 32].map(|n| format!("mesh.elements=[{n},{n}]")));
        println!("orders {adaptive:.3}, {uniform:.3}");
        assert!(adaptive > 0.9 * order && uniform < 0.42, "{adaptive} {uniform}");
    }
}

/// Tetrahedra, and two bodies of which each has its own mesh.
#[test]
fn tetrahedra_and_several_bodies_refine_themselves() {
    let bodies = r#"
        [[body]] name = "lower"
        [body.mesh] kind = "block", size = [1, 1, 0.5], elements = [2, 2, 1], cells = "tetrahedron", refine = 0.2
        [body.material] young = 1e9, poisson = 0.3
        [[body]] name = "upper", at = [0.25, 0.25, 0.5]
        [body.mesh] kind = "block", size = [0.5, 0.5, 0.5], elements = [1, 1, 1], cells = "tetrahedron"
        [body.material] young = 1e9, poisson = 0.3
        [[support]] boundary = "lower:bottom", fix = ["x", "y", "z"]
        [[support]] boundary = "upper:top", fix = ["x", "y", "z"], displacement = [0, 0, -1e-3]
        [[contact]] boundary = "upper:bottom", against = "lower:top", friction = 0.3
        [time] end = 1, increments = 2
    "#;
    let (report, nodes) = solved_scene(bodies, &[]);
    println!("{nodes} nodes, error {:.3}", error_of(&report));
    assert_eq!(report.status.to_string(), "converged");
    assert!(error_of(&report) < 0.22, "{}", error_of(&report));
}

#[test]
fn other_cells_and_errors_are_refused() {
    let scene = |overrides: &[&str]| Run::new(&parsed_with(&scene_text(CYLINDER), overrides)).unwrap_err();
    // Nothing is solved before, not even where the first mesh would suffice; a model alone is refused, too.
    for overrides in [&["mesh.cells=\"quadrilateral\""][..], &["mesh.cells=\"quadrilateral\"", "mesh.refine=0.9"]] {
        let model = tightening(&parsed_with(&scene_text(CYLINDER), overrides)).unwrap_err();
        for error in [scene(overrides), model] {
            let RunError::Scene(error) = error else { panic!() };
            assert!(error.to_string().contains("triangles or of tetrahedra refine themselves"), "{error}");
        }
    }
    let scene = Scene::parse("scene.toml", &scene_text(CYLINDER), &["mesh.refine=2".parse().unwrap()]);
    assert!(scene.unwrap_err().to_string().contains("mesh.refine"));
}

/// Beside a force at a point the energy of finer meshes grows without a limit: the mesh is refined no further, and its
/// error is told.
#[test]
fn a_force_at_a_point_ends_the_refinement() {
    let plate = r#"
        [mesh] kind = "block", size = [0.2, 0.1], elements = [4, 2], cells = "triangle", refine = 0.1
        [material] young = 1e9, poisson = 0.3, plane = "strain"
        [[support]] boundary = "left", fix = ["x", "y"]
        [[load]] point = [0.1, 0.1], force = [0, -1e3]
        [time] end = 1, increments = 1
    "#;
    let (report, nodes) = solved_scene(plate, &[]);
    println!("{nodes} nodes, {} coarser meshes, error {:.3}", report.coarser_meshes.len(), error_of(&report));
    assert_eq!(report.status.to_string(), "converged");
    assert!(error_of(&report) > 0.1 && report.coarser_meshes.len() < 30, "{nodes}");
}
