//! The key results of a run against forces and pressures that are known.

use crate::common::prelude::*;

const FRICTION: f64 = 0.3;

/// A block of 2 m by 1 m, pressed on a plane by 1 mm in the first half of the history, and drawn along it by `drawn`
/// (m) in the second half.
fn drawn(drawn: f64, friction: f64) -> RunReport {
    let material = Material::new(1e9, 0.0).in_plane(Plane::Stress);
    let times = (1..=20).map(|k| 0.1 * f64::from(k)).collect();
    let along = Support::new("top", &[Axis::X]).moved(&[drawn]).over(&[[1.0, 0.0], [2.0, 1.0]]);
    let down = Support::new("top", &[Axis::Y]).moved(&[-1e-3]).over(&[[0.0, 0.0], [1.0, 1.0]]);
    let body = Description::new(block(&[2.0, 1.0], &[8, 4]), material, times)
        .with_support(along)
        .with_support(down)
        .contact("bottom", friction, [Obstacle::plane(0.0)]);
    let model = Model::build(&body).unwrap();
    let report = Run::of(&model, model.times().to_vec(), bn()).unwrap();
    let report = report.solve(&mut ()).unwrap();
    assert_eq!(report.status, Status::Converged);
    report
}

/// Without transverse strain and friction, the pressure is uniform: E times 1 mm per m.
#[test]
fn the_mean_of_a_uniform_pressure_is_the_pressure() {
    let report = drawn(0.0, 0.0);
    let largest = report.largest_pressure.unwrap();
    for pressure in [largest.pressure, largest.mean_pressure] {
        assert!((pressure.unwrap() / 1e6 - 1.0).abs() < 1e-9, "{pressure:?}");
    }
    assert!(report.holding_force.is_none());
}

/// When all nodes slip, the block is held by the friction of its whole normal force.
#[test]
fn a_block_that_is_drawn_holds_by_its_friction() {
    let report = drawn(5e-3, FRICTION);
    let holding = report.holding_force.unwrap();
    let largest = FRICTION * report.boundaries[0].sums.sum_p_n;
    assert!((holding.magnitude / largest - 1.0).abs() < 1e-6, "{holding:?} {largest}");
    assert_eq!(holding.boundary, "bottom");
    assert!(holding.time > 1.0);
    // Before all nodes slip, it is less.
    let sticking = drawn(1e-4, FRICTION).holding_force.unwrap();
    assert!(sticking.magnitude < 0.5 * holding.magnitude, "{sticking:?}");
}

/// A block of 1 m by 0.5 m that is pressed on a plane, with `finer` meshes and more of the scene.
fn pressed(finer: usize, more: &str) -> RunReport {
    let text = format!(
        "mesh = {{ kind = \"block\", size = [1, 0.5], elements = [{}, {}] }}\nmaterial = {{ young = 1e9, poisson = 0.3 \
         }}\n[[contact]]\nboundary = \"bottom\"\nfriction = 0.3\nobstacle = {{ kind = \"plane\" }}\n[[load]]\nboundary = \
         \"top\"\npressure = 1e6\n[time]\nend = 1\nincrements = 4\n{more}",
        12 * finer,
        6 * finer
    );
    let report = Run::new(&parsed(&text)).unwrap().solve(&mut ()).unwrap();
    assert_eq!(report.status, Status::Converged, "{}", report.explanation.reason);
    report
}

/// Springs that take a small part of the load make the force of the contact depend on the mesh by a small part of the error in
/// the energy norm. The told error is the distance to a mesh four times as fine, within a factor of three.
#[test]
fn the_error_of_a_shared_force_is_told() {
    let springs = "[[spring]]\nboundary = \"right\"\nstiffness = [0, 1e8]\n";
    let (coarse, fine) = (pressed(1, springs), pressed(4, springs));
    let [here, there] = [&coarse, &fine].map(|report| report.largest_force.clone().unwrap());
    let (estimate, error) = (here.mesh_error.unwrap(), (here.magnitude - there.magnitude).abs() / here.magnitude);
    let of_energy = coarse.estimates.discretisation.unwrap().powi(2);
    println!("told {estimate:.2e}, true {error:.2e}, square of the error in the energy norm {of_energy:.2e}");
    assert!(!here.given && (1.0 / 3.0..3.0).contains(&(estimate / error)), "{estimate} {error}");
    assert!(of_energy > 4.0 * error, "{of_energy} {error}");
    // However it is solved, it is the same.
    for solver in ["linear = \"condensed\"", "method = \"ip\"", "method = \"events\""] {
        let other = pressed(1, &format!("{springs}[solver]\n{solver}\n")).largest_force.unwrap().mesh_error.unwrap();
        assert!((other / estimate - 1.0).abs() < 1e-3, "{solver} {other} {estimate}");
    }
}

/// A force that loads alone determine has no error of the mesh, whatever the load, the statuses and the solver.
#[test]
fn forces_that_loads_determine_have_no_error() {
    let load = |traction: f64| format!("[[load]]\nboundary = \"right\"\ntraction = [{traction:?}, 0]\n");
    let solver = |word: &str| load(5.8e5) + "[solver]\n" + word + "\n";
    for more in [load(3e5), load(5.8e5), solver("linear = \"condensed\""), solver("method = \"ip\"")] {
        let report = pressed(1, &more);
        let (force, holding) = (report.largest_force.unwrap(), report.holding_force.unwrap());
        assert!(force.given && force.mesh_error.is_none(), "{more} {force:?}");
        assert!(holding.given && holding.mesh_error.is_none(), "{more} {holding:?}");
    }
}

/// A spring holds a block along a round floor: the error of few increments is many times the force, so unknown.
#[test]
fn an_error_of_increments_above_the_force_is_unknown() {
    let of = |increments: usize| {
        let text = format!(
            "[mesh]\nkind = \"block\"\nsize = [4, 1]\nelements = [16, 4]\n[material]\nyoung = 1e9\npoisson = 0.3\n\
             [[contact]]\nboundary = \"bottom\"\nfriction = 0.1\n\
             obstacle = {{ kind = \"cylinder\", radius = 20, apex = [2.1, 0] }}\n\
             [[spring]]\nboundary = \"left\"\nstiffness = [1e8, 0]\n[[support]]\npoint = [2, 1]\nfix = [\"y\"]\n\
             [[load]]\nboundary = \"top\"\npressure = 4e6\nhistory = [[0, 0], [1, 1], [2, 1]]\n\
             [time]\nend = 2\nincrements = {increments}\n"
        );
        let report = Run::new(&parsed(&text)).unwrap().solve(&mut ()).unwrap();
        (report.estimates.increments.unwrap().resultant_error.unwrap(), report.holding_force.unwrap().time_error)
    };
    let (error, estimate) = of(4);
    assert!(error > 1.0 && estimate.is_none(), "{error} {estimate:?}");
    let (error, estimate) = of(64);
    assert!(error < 1.0 && estimate == Some(error), "{error} {estimate:?}");
}

/// Two blocks of one width, of which the upper one is pressed and pulled along the other until it slides. A coarse mesh does
/// not show the singular pressures at the ends.
#[test]
fn the_peak_of_a_surface_that_slides_at_its_rim_is_unknown() {
    let of = |finer: usize| {
        let block = |name: &str, y: f64, elements: usize| {
            format!(
                "[[body]]\nname = \"{name}\"\nat = [0, {y:?}]\nmaterial = {{ young = 2.1e11, poisson = 0.3 }}\n\
                 mesh = {{ kind = \"block\", size = [2, 1], elements = [{}, {}] }}\n",
                2 * elements * finer,
                elements * finer
            )
        };
        let text = format!(
            "{}{}[[support]]\nboundary = \"lower:bottom\"\nfix = [\"x\", \"y\"]\n[[contact]]\nboundary = \"upper:bottom\"\n\
             friction = 0.2\nagainst = \"lower:top\"\n[[load]]\nboundary = \"upper:top\"\npressure = 3e7\n\
             history = [[0, 0], [1, 1], [2, 1]]\n[[support]]\nboundary = \"upper:left\"\nfix = [\"x\"]\n\
             displacement = [1e-3]\nhistory = [[1, 0], [2, 1]]\n[time]\nend = 2\nincrements = 4\n",
            block("upper", 1.0, 5),
            block("lower", 0.0, 4)
        );
        let report = Run::new(&parsed(&text)).unwrap().solve(&mut ()).unwrap();
        assert_eq!(report.status, Status::Converged, "{}", report.explanation.reason);
        report.largest_pressure.unwrap()
    };
    let (coarse, fine) = (of(1), of(4));
    let missing = fine.pressure.unwrap() / coarse.pressure.unwrap() - 1.0;
    println!("peak of a mesh four times as fine: {:+.1} %", 100.0 * missing);
    assert!(coarse.mesh_error.is_none() && !coarse.singular && missing > 0.1, "{coarse:?} {missing}");
}
