//! Bodies whose dilatations are averaged at their corners: contact, supports, heat, stresses, estimates. Figures without a closed form are
//! those of a program that shares nothing with this one.

use crate::common::prelude::*;
use stickslip::body::Balance;
use stickslip::body::fem::cell_volume;

/// A scene with every linear algebra of this build.
fn each_way(text: &str, mut check: impl FnMut(&str, &Model, RunReport, &Recording)) {
    let scene = parsed(text);
    let model = discretise(&scene).unwrap();
    for (name, linear) in LinearAlgebra::WORDS.into_iter().filter(|(_, linear)| linear.is_built_in()) {
        let mut recording = Recording::all();
        let solver = SolverChoice { linear: Some(linear), ..scene.solver };
        let report = Run::of(&model, scene.time.all(), solver).unwrap().solve(&mut recording).unwrap();
        assert_eq!(report.status, Status::Converged, "{name}: {}", report.explanation.reason);
        check(name, &model, report, &recording);
    }
}

const CLAMPED_BELOW: &str = "[[support]]\nboundary = \"bottom\"\n";

/// The force on a bonded block, an eighth of it, whose top a support moves; its energy is half of force times path.
#[test]
fn a_bonded_block() {
    for (cells, elements, poisson, expected) in [
        ("tetrahedron", "[8, 8, 4]", 0.49, 3.384_946_441_9e-2),
        ("tetrahedron", "[8, 8, 4]", 0.499, 3.548_137_790_7e-2),
        ("tetrahedron10", "[4, 4, 2]", 0.49, 3.268_765_600_2e-2),
        ("tetrahedron10", "[4, 4, 2]", 0.499, 3.378_998_267_0e-2),
    ] {
        let text = format!(
            "[mesh]\nkind = \"block\"\nsize = [1, 1, 0.5]\nelements = {elements}\ncells = \"{cells}\"\n\
             element = \"nodal-volume\"\n[material]\nyoung = 1\npoisson = {poisson}\n\
             [[support]]\nboundary = \"left\"\nfix = [\"x\"]\n[[support]]\nboundary = \"front\"\nfix = [\"y\"]\n\
             {CLAMPED_BELOW}fix = [\"z\"]\n\
             [[support]]\nboundary = \"top\"\nfix = [\"x\", \"y\", \"z\"]\ndisplacement = [0, 0, -0.01]\n\
             [time]\nend = 1\nincrements = 1\n"
        );
        each_way(&text, |name, _, report, _| {
            let reaction = &report.reactions[0];
            let found = -reaction.supports[3].force[2];
            assert!((found / expected - 1.0).abs() < 1e-9, "{name}, {cells} at nu = {poisson}: {found:.10e}");
            assert!(reaction.balance < 1e-12, "{name}: {:e}", reaction.balance);
            let energy = report.increments[0].strain_energy;
            assert!((energy / (0.5 * found * 0.01) - 1.0).abs() < 1e-9, "{name}: {energy:e}");
            assert!(report.estimates.locking.is_none());
            assert!(report.warnings.iter().all(|warning| warning.kind != WarningKind::LOCKING));
        });
    }
}

/// A parabola pressed into the top, with and without friction.
#[test]
fn a_parabola_on_a_block() {
    for (d, cells, n, mu, expected) in [
        (2, "triangle", 8, 0.0, [2.073_932_061_8e-2, 0.0]),
        (2, "triangle", 8, 0.3, [2.125_465_950_0e-2, 4.242_379_963_2e-3]),
        (3, "tetrahedron", 4, 0.0, [1.088_538_998_0e-2, 0.0]),
        (3, "tetrahedron", 4, 0.3, [1.117_665_098_7e-2, 2.407_328_681_2e-3]),
        (3, "tetrahedron10", 2, 0.0, [1.182_853_429_2e-2, 0.0]),
        (3, "tetrahedron10", 2, 0.3, [1.196_795_385_0e-2, 1.569_300_736_0e-3]),
    ] {
        let (fix, square) = match d {
            2 => ("\"x\", \"y\"", "(x - 0.5)^2"),
            _ => ("\"x\", \"y\", \"z\"", "((x - 0.5)^2 + (y - 0.5)^2)"),
        };
        let text = format!(
            "[mesh]\nkind = \"block\"\nsize = {:?}\nelements = {:?}\ncells = \"{cells}\"\nelement = \"nodal-volume\"\n\
             [material]\nyoung = 1\npoisson = 0.49\n{CLAMPED_BELOW}fix = [{fix}]\n\
             [[contact]]\nboundary = \"top\"\nfriction = {mu}\n\
             obstacle = {{ kind = \"formula\", formula = \"0.1 * {square} - 0.02\" }}\n\
             [time]\nend = 1\nincrements = 1\n",
            vec![1; d],
            vec![n; d]
        );
        each_way(&text, |name, _, report, recording| {
            let state = &recording.increments[0].state;
            let friction = state.p_t.iter().zip(&state.p_o).map(|(t, o)| t.hypot(*o)).sum::<f64>();
            for (found, expected) in [state.p_n.iter().sum(), friction].into_iter().zip(expected) {
                let off: f64 = found - expected;
                assert!(off.abs() <= 2e-9 * expected, "{name}, {cells}, {mu}: {found:.10e} {expected:.10e}");
            }
            assert!(report.reactions[0].balance < 1e-12);
        });
    }
}

/// Layers under a pressure that cannot widen keep the dilatation each that it has in the closed form.
#[test]
fn layers_in_series() {
    let modulus = |young: f64, nu: f64| young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
    let exact = -1e6 * (0.25 / modulus(70e9, 0.49) + 0.25 / modulus(3e9, 0.499) + 0.5 / modulus(210e9, 0.3));
    let (plane, space) = ([("x", ["left", "right"])], [("x", ["left", "right"]), ("y", ["front", "back"])]);
    for (cells, sides, size, elements) in [
        ("triangle", &plane[..], "[1, 1]", "[3, 8]"),
        ("triangle6", &plane, "[1, 1]", "[2, 4]"),
        ("tetrahedron", &space, "[1, 1, 1]", "[2, 2, 4]"),
        ("tetrahedron10", &space, "[1, 1, 1]", "[1, 1, 4]"),
        ("prism", &space, "[1, 1, 1]", "[2, 2, 4]"),
    ] {
        let fixed = |(axis, sides): &(&str, [&str; 2])| {
            sides.map(|side| format!("[[support]]\nboundary = \"{side}\"\nfix = [\"{axis}\"]\n")).concat()
        };
        let sides: String = sides.iter().map(fixed).collect();
        let (up, zeros) = if size == "[1, 1]" { ("y", "0") } else { ("z", "0, 0") };
        let text = format!(
            "[mesh]\nkind = \"block\"\nsize = {size}\nelements = {elements}\ncells = \"{cells}\"\nelement = \"nodal-volume\"\n\
             [material]\nyoung = 210e9\npoisson = 0.3\nlayers = [[0.25, 70e9, 0.49], [0.25, 3e9, 0.499]]\n\
             {CLAMPED_BELOW}fix = [\"{up}\"]\n{sides}\
             [[load]]\nboundary = \"top\"\ntraction = [{zeros}, -1e6]\n[time]\nend = 1\nincrements = 1\n"
        );
        each_way(&text, |name, model, _, recording| {
            let c = model.mesh.dimension - 1;
            let all = model.displacements(1.0, &recording.increments[0].state.u).unwrap();
            let top = model.mesh.nodes.iter().zip(&all).filter(|(x, _)| x[c] == 1.0);
            assert!(top.clone().all(|(_, u)| (u[c] / exact - 1.0).abs() < 1e-11), "{name}, {cells}");
            let stresses = model.centre_stresses(1.0, &all).unwrap();
            assert!(stresses.iter().all(|s| (s[c] / -1e6 - 1.0).abs() < 1e-9), "{name}, {cells}");
        });
    }
}

/// The forces (N) with which the cells of a body pull at its nodes, from the stress of each.
fn forces_of_stresses(model: &Model, stresses: &[[f64; 6]]) -> Vec<[f64; 3]> {
    let mut forces = vec![[0.0; 3]; model.mesh.nodes.len()];
    for (cell, [xx, yy, zz, xy, yz, zx]) in model.mesh.cells.iter().zip(stresses) {
        let corners = model.mesh.points(&cell.nodes);
        let volume = cell_volume(cell.kind, Geometry::Cartesian, &corners).unwrap();
        let (of_nodes, _) = gradients(cell.kind, cell.kind.centre(), &corners).unwrap();
        for (node, g) in cell.nodes.iter().zip(of_nodes) {
            for (c, row) in [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]].into_iter().enumerate() {
                forces[*node][c] += volume * (0..3).map(|k| row[k] * g[k]).sum::<f64>();
            }
        }
    }
    forces
}

/// A body of two materials that is heated unevenly, clamped, moved by a support, held by an oblique one and by a spring: its
/// stresses leave no force on nodes that nothing holds, and ask of each support and of the spring for what it is told to bear.
#[test]
fn stresses_are_in_equilibrium() {
    for (cells, size, elements, all, z) in [
        ("triangle", "[1, 0.8]", "[5, 4]", "\"x\", \"y\"", ""),
        ("tetrahedron", "[1, 0.9, 0.8]", "[3, 3, 4]", "\"x\", \"y\", \"z\"", ", 0.4"),
    ] {
        let (y, high) = if z.is_empty() { (0.4, 0.8) } else { (0.3, 0.8) };
        let text = format!(
            "[mesh]\nkind = \"block\"\nsize = {size}\nelements = {elements}\ncells = \"{cells}\"\nelement = \"nodal-volume\"\n\
             [material]\nyoung = 1e7\npoisson = 0.499\nexpansion = 1e-5\nlayers = [[0.4, 4e7, 0.3]]\n\
             {CLAMPED_BELOW}fix = [{all}]\n\
             [[support]]\npoint = [1, {y}{z}]\ndirection = [1, 0.4{z}]\n\
             [[support]]\nboundary = \"top\"\nfix = [\"x\"]\ndisplacement = [2e-3]\nhistory = [[0, 0], [0.5, 1], [1, 0.5]]\n\
             [[spring]]\npoint = [0, {y}{z}]\nstiffness = [1e6, 2e6{}]\n\
             [[load]]\ntemperature = \"100 + 50 * x^2 - 80 * y\"\n[time]\nend = 1\nincrements = 2\n",
            if z.is_empty() { "" } else { ", 3e6" }
        );
        each_way(&text, |name, model, report, recording| {
            for (increment, record) in recording.increments.iter().zip(&report.reactions) {
                let t = increment.record.time;
                assert!(record.balance < 1e-12, "{name}, {cells}: {:e}", record.balance);
                let all = model.displacements(t, &increment.state.u).unwrap();
                let forces = forces_of_stresses(model, &model.centre_stresses(t, &all).unwrap());
                let size = forces.iter().fold(0.0_f64, |m, f| m.max(norm(*f)));
                let up = model.mesh.dimension - 1;
                let middle = |x: [f64; 3]| (x[1] - y).abs() < 1e-12 && (up == 1 || (x[2] - 0.4).abs() < 1e-12);
                // Who bears the node at x: the supports in their order, the spring, nobody.
                let bearer = |x: [f64; 3]| match x {
                    x if x[up] == 0.0 => 0,
                    x if x[0] == 1.0 && middle(x) => 1,
                    x if (x[up] - high).abs() < 1e-12 => 2,
                    x if x[0] == 0.0 && middle(x) => 3,
                    _ => 4,
                };
                let mut borne = [[0.0; 3]; 5];
                for (x, force) in model.mesh.nodes.iter().zip(&forces) {
                    let whose = bearer(*x);
                    assert!(
                        whose < 4 || norm(*force) < 1e-10 * size,
                        "{name}, {cells}: {force:?} of {size:e} at {x:?}"
                    );
                    (0..3).for_each(|c| borne[whose][c] += force[c]);
                }
                let Balance { supports, springs, .. } = model.balance(t, &increment.state).unwrap();
                for (reported, found) in supports.iter().chain(&springs).zip(borne) {
                    let off = norm(minus(reported.force, found));
                    assert!(off < 1e-10 * size, "{name}, {cells}: {:?} {found:?} of {size:e}", reported.force);
                }
            }
        });
    }
}

/// Blocks that are bent by tractions that are linear over their height, as those of `estimates.rs`: the error of the stresses in the
/// energy norm, which is known, and the estimate.
#[test]
fn the_error_of_the_mesh_is_seen() {
    let young = 1e9;
    for (d, cells, sizes) in [(2, "triangle", [8, 16]), (3, "tetrahedron", [4, 8])] {
        let (more, zeros) = match d {
            2 => ("fix = [\"y\"]\npoint = [0, 0]\n", "0"),
            _ => ("fix = [\"y\", \"z\"]\npoint = [0, 0, 0]\n[[support]]\nfix = [\"z\"]\npoint = [0, 1, 0]\n", "0, 0"),
        };
        for (poisson, n) in [0.3, 0.49].into_iter().flat_map(|poisson| sizes.map(|n| (poisson, n))) {
            let text = format!(
                "[mesh]\nkind = \"block\"\nsize = {:?}\nelements = {:?}\ncells = \"{cells}\"\nelement = \"nodal-volume\"\n\
                 [material]\nyoung = {young}\npoisson = {poisson}\n\
                 [[support]]\nboundary = \"left\"\nfix = [\"x\"]\n[[support]]\n{more}\
                 [[load]]\nboundary = \"right\"\ntraction = [\"1e6 * (1 - 2 * y)\", {zeros}]\n[time]\nend = 1\nincrements = 1\n",
                vec![1; d],
                vec![n; d]
            );
            let scene = parsed(&text);
            let (model, mut recording) = (discretise(&scene).unwrap(), Recording::all());
            let report = Run::of(&model, scene.time.all(), scene.solver).unwrap().solve(&mut recording).unwrap();
            assert_eq!(report.status, Status::Converged);
            // σ : D⁻¹ σ.
            let square = |[xx, yy, zz, xy, yz, zx]: [f64; 6]| {
                let all = xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + yz * yz + zx * zx);
                ((1.0 + poisson) * all - poisson * (xx + yy + zz).powi(2)) / young
            };
            let all = model.displacements(1.0, &recording.increments[0].state.u).unwrap();
            let (mut off, mut whole) = (0.0, 0.0);
            for (cell, stress) in model.mesh.cells.iter().zip(model.centre_stresses(1.0, &all).unwrap()) {
                let corners = model.mesh.points(&cell.nodes);
                let volume = cell_volume(cell.kind, Geometry::Cartesian, &corners).unwrap();
                let rule = fine_quadrature(cell.kind);
                let weights: f64 = rule.iter().map(|(_, weight)| weight).sum();
                for (point, weight) in rule {
                    let y: f64 = shape(cell.kind, point).iter().zip(&corners).map(|(n, x)| n * x[1]).sum();
                    let xx = 1e6 * (1.0 - 2.0 * y);
                    let exact = [xx, 0.0, if d == 2 { poisson * xx } else { 0.0 }, 0.0, 0.0, 0.0];
                    off += volume * weight / weights * square(std::array::from_fn(|c| stress[c] - exact[c]));
                    whole += volume * weight / weights * square(exact);
                }
            }
            let (error, estimate) = ((off / whole).sqrt(), report.estimates.discretisation.unwrap());
            println!("{cells} {n}, nu {poisson}: error {error:.4}, estimate over it {:.3}", estimate / error);
            assert!((0.75..1.05).contains(&(estimate / error)), "{cells} {n}, nu {poisson}: {error} {estimate}");
        }
    }
}

/// On cells of second order, where bending is in their space but for the averages, the estimate falls with the size of the cells to a
/// power above 1.
#[test]
fn the_estimate_falls_on_cells_of_second_order() {
    let estimate = |n: usize| {
        let text = format!(
            "[mesh]\nkind = \"block\"\nsize = [1, 1]\nelements = [{n}, {n}]\ncells = \"triangle6\"\nelement = \"nodal-volume\"\n\
             [material]\nyoung = 1e9\npoisson = 0.499\n\
             [[support]]\nboundary = \"left\"\nfix = [\"x\"]\n[[support]]\nfix = [\"y\"]\npoint = [0, 0]\n\
             [[load]]\nboundary = \"right\"\ntraction = [\"1e6 * (1 - 2 * y)\", 0]\n[time]\nend = 1\nincrements = 1\n"
        );
        let mut found = 0.0;
        each_way(&text, |_, _, report, _| {
            assert!(report.estimates.locking.is_none());
            found = report.estimates.discretisation.unwrap();
        });
        found
    };
    let [coarse, fine] = [4, 8].map(estimate);
    println!("{coarse:.4} {fine:.4}");
    assert!(coarse < 0.2 && fine < 0.5 * coarse, "{coarse} {fine}");
}

/// A uniform temperature strains a free body of two materials without stress, and stresses a held one without strain.
#[test]
fn warm_blocks() {
    let strain = 1e-3;
    let sides = |names: &[(&str, &str)]| -> String {
        names
            .iter()
            .map(|(name, axis)| format!("[[support]]\nboundary = \"{name}\"\nfix = [\"{axis}\"]\n"))
            .collect::<Vec<_>>()
            .concat()
    };
    let warm = |cells: &str, supports: &str, layers: &str| {
        format!(
            "[mesh]\nkind = \"block\"\nsize = [1, 1, 1]\nelements = [2, 3, 2]\ncells = \"{cells}\"\nelement = \"nodal-volume\"\n\
             [material]\nyoung = 1e7\npoisson = 0.49\nexpansion = 1e-5\n{layers}{supports}\
             [[load]]\ntemperature = 100\n[time]\nend = 1\nincrements = 1\n"
        )
    };
    for cells in ["tetrahedron", "tetrahedron10", "prism"] {
        let text = |supports: &str, layers: &str| warm(cells, supports, layers);
        let three = sides(&[("left", "x"), ("front", "y"), ("bottom", "z")]);
        let bulk = 1e7 / (3.0 * (1.0 - 2.0 * 0.49));
        each_way(&text(&three, "layers = [[0.5, 3e7, 0.3]]\n"), |name, model, report, recording| {
            let all = model.displacements(1.0, &recording.increments[0].state.u).unwrap();
            for (x, u) in model.mesh.nodes.iter().zip(&all) {
                assert!((0..3).all(|c| (u[c] - strain * x[c]).abs() < 1e-12), "{name}, {cells}: {u:?}");
            }
            let stresses = model.centre_stresses(1.0, &all).unwrap();
            assert!(stresses.iter().flatten().all(|s| s.abs() < 1e-9 * bulk * strain), "{name}");
            assert!(report.increments[0].strain_energy < 1e-18 * bulk);
        });
        let held = text(&(three + &sides(&[("right", "x"), ("back", "y"), ("top", "z")])), "");
        each_way(&held, |name, model, report, recording| {
            let all = model.displacements(1.0, &recording.increments[0].state.u).unwrap();
            let pressure = 3.0 * bulk * strain;
            for s in model.centre_stresses(1.0, &all).unwrap() {
                assert!(s[..3].iter().all(|s| (s / -pressure - 1.0).abs() < 1e-10), "{name}: {s:?}");
            }
            let energy = report.increments[0].strain_energy;
            assert!((energy / (0.5 * pressure * 3.0 * strain) - 1.0).abs() < 1e-10, "{name}: {energy:e}");
            assert!((report.reactions[0].supports[0].force[0] / pressure - 1.0).abs() < 1e-10);
        });
    }
}

/// A temperature that is linear in the position leaves a body of second order without stress, if nothing holds it: its displacements are
/// quadratic.
#[test]
fn an_uneven_temperature_without_stress() {
    let text = "[mesh]\nkind = \"block\"\nsize = [1, 0.9, 0.8]\nelements = [2, 2, 1]\ncells = \"tetrahedron10\"\n\
         element = \"nodal-volume\"\n[material]\nyoung = 1e7\npoisson = 0.499\nexpansion = 1e-5\n\
         [[support]]\nfix = [\"x\", \"y\", \"z\"]\npoint = [0, 0, 0]\n[[support]]\nfix = [\"y\", \"z\"]\npoint = [1, 0, 0]\n\
         [[support]]\nfix = [\"z\"]\npoint = [0, 0.9, 0]\n\
         [[load]]\ntemperature = \"100 * x - 30 * y\"\n[time]\nend = 1\nincrements = 1\n";
    let bulk = 1e7 / (3.0 * (1.0 - 2.0 * 0.499));
    each_way(text, |name, model, report, recording| {
        let all = model.displacements(1.0, &recording.increments[0].state.u).unwrap();
        let stresses = model.centre_stresses(1.0, &all).unwrap();
        let worst = stresses.iter().flatten().fold(0.0_f64, |m, s| m.max(s.abs()));
        assert!(worst < 1e-10 * bulk * 1e-3, "{name}: {worst:e}");
        assert!(report.increments[0].strain_energy < 1e-20 * bulk, "{name}: {:e}", report.increments[0].strain_energy);
    });
}
