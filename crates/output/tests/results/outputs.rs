//! Results besides the forces: probes, energy, substeps, the undeformed body, pictures.

#![allow(clippy::unwrap_used)]

use crate::common;
use std::ops::ControlFlow;
use stickslip::body::{Model, Probe};
use stickslip::run::report::{ContactLine, ProbeTable, ProbeValue};
use stickslip::run::{RecordedIncrement, Recording, Run, discretise};
use stickslip::scene::Scene;
use stickslip::solver::KktErrors;
use stickslip::solver::history::{self, HistorySettings, IncrementView, Method, Observer, Status, SystemSolver};
use stickslip_output::{DeformedBody, contact_stresses, history_charts};

/// Returns a bar of length 2, height 1 (and depth 1), pulled along x at its right end with 1 MPa and free to contract.
/// Strain and stress are uniform, and displacements are linear.
fn bar(cells: &str, dimension: usize) -> Scene {
    let (size, elements, boundaries, traction) = match dimension {
        2 => ("[2, 1]", "[3, 2]", [("left", "x"), ("bottom", "y")].to_vec(), "[1e6, 0]"),
        _ => ("[2, 1, 1]", "[3, 2, 2]", [("left", "x"), ("bottom", "z"), ("front", "y")].to_vec(), "[1e6, 0, 0]"),
    };
    let supports =
        boundaries.iter().map(|(name, axis)| format!("[[support]]\nboundary = '{name}'\nfix = ['{axis}']\n"));
    let supports = supports.collect::<Vec<_>>().concat();
    let text = format!(
        "[mesh]\nkind = 'block'\nsize = {size}\nelements = {elements}\ncells = '{cells}'\n\
         [material]\nyoung = 1e9\npoisson = 0.25\n{}{supports}\
         [[load]]\nboundary = 'right'\ntraction = {traction}\n[time]\nend = 1\nincrements = 2\n",
        if dimension == 2 { "plane = 'stress'\n" } else { "" }
    );
    Scene::parse("bar.toml", &text, &[]).unwrap()
}

/// Returns the values of a probe in each increment.
fn probed(model: &Model, scene: &Scene, probe: Probe) -> Vec<Vec<ProbeValue>> {
    struct Values<'a>(&'a Model, ProbeTable, Vec<Vec<ProbeValue>>);
    impl Observer for Values<'_> {
        fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
            self.2.push(self.1.values(self.0, step));
            ControlFlow::Continue(())
        }
    }
    let table = ProbeTable::all(model, &[probe]).unwrap().remove(0);
    let mut values = Values(model, table, Vec::new());
    assert_eq!(common::run(scene, model, &mut values).status, Status::Converged);
    values.2
}

/// In a uniform field a probe is exact everywhere: inside cells, on their sides, in corners of the body.
#[test]
fn probes_of_a_uniform_field_are_exact() {
    for (cells, dimension) in [("quadrilateral", 2), ("triangle", 2), ("hexahedron", 3), ("tetrahedron", 3)] {
        let scene = bar(cells, dimension);
        let model = discretise(&scene).unwrap();
        let line = match dimension {
            2 => Probe::along("line", [0.0, 0.0], [2.0, 1.0], 13),
            _ => Probe::along("line", [0.0, 0.0, 0.0], [2.0, 1.0, 1.0], 13),
        };
        let values = probed(&model, &scene, line);
        assert_eq!((values.len(), values[0].len()), (2, 13));
        for (load, values) in [0.5, 1.0].into_iter().zip(values) {
            for ProbeValue { position: [x, y, z], displacement, stress } in values {
                let exact = [x * 1e-3, -0.25e-3 * y, -0.25e-3 * z].map(|u| load * u);
                assert!((0..3).all(|c| (displacement[c] - exact[c]).abs() < 1e-15), "{cells}: {displacement:?}");
                let pulled = [load * 1e6, 0.0, 0.0, 0.0, 0.0, 0.0];
                assert!(stress.iter().zip(pulled).all(|(s, e)| (s - e).abs() < 1e-5), "{cells}: {stress:?}");
            }
        }
    }
}

/// At a node the probe returns the node's displacement, and midway between two nodes their mean.
#[test]
fn probes_follow_the_shape_functions() {
    let scene = common::block(&["mesh.elements=[5,5]", "solver.setting=default"]);
    let model = discretise(&scene).unwrap();
    let values = probed(&model, &scene, Probe::along("row", [0.2, 1.0], [0.4, 1.0], 3)).pop().unwrap();
    let mut last = Recording::last();
    common::run(&scene, &model, &mut last);
    let displacements = model.displacements(2.0, &last.increments[0].state.u).unwrap();
    assert!(model.displacements(2.0, &[0.0]).is_err());
    let node = |x: [f64; 2]| {
        let near = |y: &[f64; 3]| (y[0] - x[0]).abs() + (y[1] - x[1]).abs() < 1e-12;
        displacements[model.mesh.nodes.iter().position(near).unwrap()]
    };
    let [a, b] = [[0.2, 1.0], [0.4, 1.0]].map(node);
    for c in 0..2 {
        let exact = [a[c], 0.5 * (a[c] + b[c]), b[c]];
        let found = [values[0], values[1], values[2]].map(|value| value.displacement[c]);
        assert!(found.iter().zip(exact).all(|(f, e)| (f - e).abs() < 1e-12 * a[1].abs()), "{found:?}, not {exact:?}");
    }
    // At the centre of a cell the stress is the mean of those recovered at its nodes.
    let centre = probed(&model, &scene, Probe::at("centre", [0.3, 0.5])).pop().unwrap()[0].stress;
    let cell = (0..25).find(|&e| (model.mesh.centre(e)[0] - 0.3).abs() + (model.mesh.centre(e)[1] - 0.5).abs() < 1e-9);
    let nodal = model.nodal_stresses_at(2.0, &displacements).unwrap();
    let exact: [f64; 6] =
        std::array::from_fn(|c| model.mesh.cells[cell.unwrap()].nodes.iter().map(|&node| 0.25 * nodal[node][c]).sum());
    assert!(centre.iter().zip(exact).all(|(s, e)| (s - e).abs() < 1e-9 * exact[1].abs()), "{centre:?}, not {exact:?}");
}

/// For the bar: half of force times path. For the block: calculated from its history and `K`, independent of the matrix
/// code.
#[test]
fn strain_energy_is_half_of_what_the_load_would_do_at_once() {
    for (cells, dimension) in [("quadrilateral", 2), ("tetrahedron", 3)] {
        let report = Run::new(&bar(cells, dimension)).unwrap().solve(&mut ()).unwrap();
        let energies: Vec<f64> = report.increments.iter().map(|record| record.strain_energy).collect();
        // ½ σ²/E for a volume of 2.
        let exact = [0.25, 1.0].map(|square| square * 0.5 * 1e12 / 1e9 * 2.0);
        assert!(energies.iter().zip(exact).all(|(e, x)| (e / x - 1.0).abs() < 1e-12), "{cells}: {energies:?}");
    }
    let scene = common::block(&["mesh.elements=[6,6]", "time.increments=4", "solver.setting=default"]);
    let model = discretise(&scene).unwrap();
    let mut all = Recording::all();
    let outcome = common::run(&scene, &model, &mut all);
    for (record, state) in outcome.records.iter().zip(all.states()) {
        let sum: f64 =
            model.problem.stiffness().assembled().unwrap().entries().map(|(i, j, k)| k * state.u[i] * state.u[j]).sum();
        assert!((record.strain_energy / (0.5 * sum) - 1.0).abs() < 1e-12);
    }
}

/// A bar pulled by a support has the same energy as one pulled by a traction. A constrained warm bar has the energy of
/// the stresses.
#[test]
fn strain_energy_counts_what_supports_and_temperatures_do() {
    let energies = |dimension: usize, cells: &str, change: &dyn Fn(&str) -> String| {
        let scene = Scene::parse("bar.toml", &change(bar(cells, dimension).text()), &[]).unwrap();
        let mut recording = Recording::all();
        let report = Run::new(&scene).unwrap().solve(&mut recording).unwrap();
        let energies: Vec<f64> = report.increments.iter().map(|record| record.strain_energy).collect();
        let observed: Vec<f64> = recording.increments.iter().map(|increment| increment.record.strain_energy).collect();
        assert_eq!((report.status, &energies), (Status::Converged, &observed));
        energies
    };
    let load = |text: &str| text.find("[[load]]").unwrap()..text.find("[time]").unwrap();
    let instead = |text: &str, with: &str| [&text[..load(text).start], with, &text[load(text).end..]].concat();
    for (dimension, cells) in [(2, "triangle"), (2, "quadrilateral"), (3, "hexahedron")] {
        let close = |found: Vec<f64>, exact: f64| {
            let all = found.iter().zip([0.25, 1.0]);
            assert!(all.clone().all(|(e, share)| (e - share * exact).abs() <= 1e-10 * exact), "{cells}: {found:?}");
        };
        let pulled = "[[support]]\nboundary = 'right'\nfix = ['x']\ndisplacement = [2e-3]\n";
        close(energies(dimension, cells, &|text| instead(text, pulled)), 1e3);
        let soft = format!("{pulled}[[spring]]\nboundary = 'right'\nnormal = 1e9\n");
        // The spring of 1e9 N/m moves with the support and adds ½ k u².
        close(energies(dimension, cells, &|text| instead(text, &soft)), 1e3 + 2e3);
        let warm = "[[load]]\ntemperature = 100\n";
        let expansion = |text: &str| text.replace("poisson = 0.25", "poisson = 0.25\nexpansion = 1e-5");
        // A free bar has no energy; a bar constrained at both ends has ½ E (α ΔT)² in a volume of 2.
        let free = energies(dimension, cells, &|text| expansion(&instead(text, warm)));
        assert!(free.iter().all(|energy| energy.abs() < 1e-9), "{cells}: {free:?}");
        let supported = format!("{warm}[[support]]\nboundary = 'right'\nfix = ['x']\n");
        close(energies(dimension, cells, &|text| expansion(&instead(text, &supported))), 1e3);
    }
}

/// Before the first increment the body is undeformed, but obstacles are at their positions for t = 0.
#[test]
fn the_body_before_is_undeformed() {
    let scene = common::block(&["mesh.elements=[4,4]", "contact.obstacle.approach=[[0,2e-6],[1,5e-6]]"]);
    let run = Run::new(&scene).unwrap();
    let before = run.undeformed();
    assert_eq!((before.record.index, before.record.time, before.record.contact.open), (0, 0.0, 4));
    assert!(before.gap.iter().all(|gap| (gap - 8e-6).abs() < 1e-20), "{:?}", before.gap);
    let data = before.data();
    let lines = ContactLine::all(run.model(), &before.step(&data));
    assert_eq!((lines[0].index, lines[0].time), (0, 0.0));
    assert!(lines[0].points.iter().all(|point| point.p_n == 0.0 && (point.gap - 8e-6).abs() < 1e-20));
    let body = DeformedBody::new(run.model(), &before.step(&data), None);
    assert_eq!((body.index, body.magnification, body.largest), (0, 1.0, 0.0));
    // This holds even if supports move it and heat strains it from the beginning.
    let early = "history = [[0, 1]]\n";
    let text = bar("quadrilateral", 2).text().replace("poisson = 0.25", "poisson = 0.25\nexpansion = 1e-5");
    let text = [&text, "\n[[load]]\ntemperature = 9\n", early, "[[support]]\nboundary = 'top'\nfix = ['y']\n"].concat();
    let text = [&text, "displacement = [1e-3]\n", early].concat();
    let scene = Scene::parse("bar.toml", &text, &[]).unwrap();
    let run = Run::new(&scene).unwrap();
    let before = run.undeformed();
    let data = before.data();
    let body = DeformedBody::new(run.model(), &before.step(&data), None);
    assert!(body.largest == 0.0 && body.patches.iter().all(|(_, stress)| *stress == 0.0));
}

/// Observer that keeps all substeps and all increments.
#[derive(Default)]
struct Parts(Vec<RecordedIncrement>, Vec<RecordedIncrement>);

impl Observer for Parts {
    fn substep(&mut self, substep: &IncrementView<'_>) {
        self.0.push(RecordedIncrement::new(substep));
    }

    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        self.1.push(RecordedIncrement::new(step));
        ControlFlow::Continue(())
    }
}

/// The law of friction holds over each substep of a halved increment, which can be checked if the ends of substeps are
/// known: the slip of a substep counts from the end of the previous one.
#[test]
fn the_law_can_be_checked_over_each_part() {
    let scene = common::block(&["mesh.elements=[20,20]", "material.poisson=0.49", "contact.friction=0.4"]);
    let model = discretise(&scene).unwrap();
    let (problem, loading) = (&model.problem, &model.loading);
    let mut settings = HistorySettings::new(problem, loading, Method::BN).unwrap().until(5, 1e-10);
    if let Method::Bn { rescue, .. } = &mut settings.method {
        *rescue = false;
    }
    let mut parts = Parts::default();
    let outcome = history::run(problem, loading, &[1.0, 2.0], &settings, SystemSolver::default(), &mut parts).unwrap();
    assert_eq!(outcome.status, Status::Converged);
    let Parts(parts, ends) = parts;
    assert!(!parts.is_empty(), "nothing was halved: the test has lost its case");
    for record in &outcome.records {
        let of_this = || parts.iter().filter(|part| part.record.index == record.index);
        assert_eq!(of_this().count() + 1, record.parts);
        let expected: Vec<f64> = of_this().map(|part| part.record.time).chain([record.time]).collect();
        assert_eq!(record.part_ends, if record.parts > 1 { expected } else { Vec::new() });
        assert!(of_this().enumerate().all(|(k, part)| part.record.parts == k + 1));
    }
    let mut all: Vec<&RecordedIncrement> = parts.iter().chain(&ends).collect();
    all.sort_by(|a, b| a.record.time.total_cmp(&b.record.time));
    let mut w_t = vec![0.0; problem.contacts()];
    for part in all {
        let data = part.data();
        // The data in the files: tangential displacements at the end of the previous substep.
        assert!(part.w_t_last.iter().zip(&w_t).all(|(found, known)| (found - known).abs() <= 1e-18));
        let errors = KktErrors::measure(problem, &data, &part.state, &outcome.scales).unwrap();
        assert!(errors.worst().1 <= 1e-9, "{errors:?}");
        let slip: Vec<f64> = problem.c_t().times(&part.state.u).unwrap();
        let force = part.state.p_t.iter().zip(&part.state.p_n).zip(slip.iter().zip(&w_t));
        for ((p_t, p_n), (now, before)) in force {
            // At a sliding node, friction is at its bound and opposes the motion of the body.
            if (now - before).abs() > 1e-9 * 1e-4 && *p_n > 0.0 {
                assert!((p_t - (now - before).signum() * 0.4 * p_n).abs() <= 1e-6 * p_n, "{p_t} {p_n}");
            }
        }
        w_t = slip;
    }
    // Over a whole halved increment the law does not hold, which is why substeps are written.
    let halved = outcome.records.iter().find(|record| record.parts > 1).unwrap();
    assert!(halved.strain_energy > 0.0);
}

/// Normals and tangents are the directions of the columns: the components along them add up to the force.
#[test]
fn contact_nodes_have_their_directions() {
    for (scene, dimension) in [
        (common::block(&["mesh.elements=[4,4]", "contact.obstacle.gap=0", "contact.obstacle.normal=[0.1,-1]"]), 2),
        (common::scene("cube.toml", &["mesh.elements=[3,3,3]"]), 3),
    ] {
        let run = Run::new(&scene).unwrap();
        let mut last = Recording::last();
        run.solve(&mut last).unwrap();
        let (step, data) = (&last.increments[0], last.increments[0].data());
        let line = ContactLine::all(run.model(), &step.step(&data)).remove(0);
        let csv = line.to_csv();
        let mut rows = csv.lines().map(|row| row.split(',').collect::<Vec<_>>());
        let header = rows.next().unwrap();
        let column = |row: &[&str], name: &str| -> f64 {
            row[header.iter().position(|head| *head == name).unwrap_or_else(|| panic!("{name}"))].parse().unwrap()
        };
        let axes = &["x", "y", "z"][..dimension];
        let mut pressed = 0;
        for (row, point) in rows.zip(&line.points) {
            assert_eq!(column(&row, "node") as usize, point.node);
            let node = run.model().mesh.nodes[point.node];
            assert!(axes.iter().zip(node).all(|(axis, x)| column(&row, axis) == x));
            for axis in axes {
                let along = |direction: &str| column(&row, &format!("{direction}_{axis}"));
                let mut force = column(&row, "p_n") * along("n") + column(&row, "p_t") * along("t");
                if dimension == 3 {
                    force += column(&row, "p_o") * along("o");
                }
                let written = column(&row, &format!("f_{axis}"));
                assert!((force - written).abs() <= 1e-12 * point.p_n.abs(), "{force} {written}");
            }
            pressed += usize::from(point.p_n > 0.0);
        }
        let along = header.iter().position(|head| *head == "sigma_along").unwrap();
        assert!(pressed > 0 && header[along - 1].starts_with(if dimension == 2 { "t_" } else { "o_" }));
        let surface: &[&str] = &["sigma_along", "sigma_across", "sigma_shear", "von_mises"];
        assert!(header[along..].iter().eq(surface.iter().filter(|name| dimension == 3 || **name != "sigma_shear")));
    }
}

#[test]
fn the_deformed_body_is_drawn_by_its_factor() {
    let scene = bar("quadrilateral", 2);
    let run = Run::new(&scene).unwrap();
    let mut last = Recording::last();
    let report = run.solve(&mut last).unwrap();
    let data = last.increments[0].data();
    let step = last.increments[0].step(&data);
    // The corner moves by 2 mm of 2 m along x. A twentieth of the body is 50 times that.
    let body = DeformedBody::new(run.model(), &step, None);
    assert_eq!((body.magnification, body.patches.len(), body.outline.len()), (20.0, 6, 10));
    let right =
        |body: &DeformedBody| body.patches.iter().flat_map(|(corners, _)| corners).map(|x| x[0]).fold(0.0, f64::max);
    assert!((right(&body) - (2.0 + 20.0 * 2e-3)).abs() < 1e-12);
    assert!(body.patches.iter().all(|(_, stress)| (stress / 1e6 - 1.0).abs() < 1e-9));
    let given = DeformedBody::new(run.model(), &step, Some(100.0));
    assert!((right(&given) - 2.2).abs() < 1e-12);
    let svg = given.to_svg("A <bar>").unwrap();
    for text in ["A &lt;bar&gt;", "before the deformation", "von Mises, MPa", "x", "y"] {
        assert!(svg.lines().any(|line| line == text), "{text}");
    }
    assert!(svg.contains("t = 1 s, displacements magnified 100 times, 2."), "{svg}");
    // The largest stress is marked, and the limits of the ten bands are round.
    let limits = (1..10).map(|k| format!("0.{k}")).chain(["0".into(), "1.0".into(), "1.000 MPa".into()]);
    for text in limits {
        assert!(svg.lines().any(|line| line == text), "{text}: {svg}");
    }
    assert_eq!(svg.matches("<polygon").count(), 10);
    // Without contact there are no forces to draw.
    let charts: Vec<&str> = history_charts(&report).iter().map(|chart| chart.0).collect();
    assert_eq!(charts, ["iterations"]);

    // In space three faces of a box are visible, the front ones last.
    let scene = bar("hexahedron", 3);
    let run = Run::new(&scene).unwrap();
    let mut last = Recording::last();
    run.solve(&mut last).unwrap();
    let data = last.increments[0].data();
    let body = DeformedBody::new(run.model(), &last.increments[0].step(&data), Some(1.0));
    assert_eq!(
        (body.patches.len(), body.outline.len(), body.axes.len()),
        (3 * 2 + 3 * 2 + 2 * 2, 3 * 3 + 3 * 2 + 3 * 2, 3)
    );
    assert!(!body.to_svg("box").unwrap().contains("NaN"));
}

/// A fine mesh takes no more room than its colours and its outline.
#[test]
fn pictures_of_fine_meshes_are_small() {
    let text = bar("quadrilateral", 2).text().replace("[3, 2]", "[300, 200]").replace("[1e6, 0]", "[1e6, 3e5]");
    let scene = Scene::parse("bar.toml", &text, &[]).unwrap();
    let run = Run::new(&scene).unwrap();
    let mut last = Recording::last();
    run.solve(&mut last).unwrap();
    let data = last.increments[0].data();
    let body = DeformedBody::new(run.model(), &last.increments[0].step(&data), None);
    assert_eq!(body.patches.len(), 60_000);
    let svg = body.to_svg("").unwrap();
    assert!(svg.len() < 50_000, "{}", svg.len());
    assert_eq!(svg, body.to_svg("").unwrap());
}

/// The largest pressure is marked with its place, and slip and gap are below the stresses, in a unit of their own.
#[test]
fn the_picture_of_a_contact_line_has_the_peak_slip_and_gap() {
    let scene = common::block(&["mesh.elements=[8,8]", "solver.setting=default"]);
    let run = Run::new(&scene).unwrap();
    let mut last = Recording::last();
    run.solve(&mut last).unwrap();
    let data = last.increments[0].data();
    let line = ContactLine::all(run.model(), &last.increments[0].step(&data)).remove(0);
    let svg = contact_stresses(&line, "Block").unwrap();
    let texts: Vec<&str> = svg.lines().filter(|line| !line.starts_with('<')).collect();
    let most = line.points.iter().max_by(|a, b| a.sigma_n.total_cmp(&b.sigma_n)).unwrap();
    let peak = format!("largest σₙ {:.2} MPa at x = {:.3} m", 1e-6 * most.sigma_n, most.x);
    assert!(texts.contains(&peak.as_str()), "{peak}: {texts:?}");
    for text in ["slip distance", "gap", "slip and gap, µm", "contact stress, MPa", "x, m"] {
        assert_eq!(texts.iter().filter(|found| **found == text).count(), 1, "{text}: {texts:?}");
    }
}

#[test]
fn forces_are_drawn_from_the_undeformed_body_on() {
    let scene = common::block(&["mesh.elements=[6,6]", "time.increments=4", "solver.setting=default"]);
    let report = Run::new(&scene).unwrap().solve(&mut ()).unwrap();
    let charts = history_charts(&report);
    let (forces, iterations) = (&charts[0].1, &charts[1].1);
    assert_eq!((charts[0].0, charts[1].0), ("forces", "iterations"));
    let curve = &forces.panels[0].curves[1];
    assert_eq!((curve.label.as_str(), curve.points.len(), curve.points[0]), ("along y", 5, [0.0, 0.0]));
    assert_eq!(curve.points[4], [2.0, report.boundaries[0].force[1]]);
    let counts: Vec<f64> = report.increments.iter().map(|record| record.iterations as f64).collect();
    let drawn = iterations.panels[0].curves.iter().find(|curve| curve.label == "iterations").unwrap();
    assert_eq!(drawn.points.iter().map(|point| point[1]).collect::<Vec<_>>(), counts);
    // A failed increment is marked, and its forces are not drawn.
    let scene = common::block(&["mesh.elements=[10,10]", "solver.max_iterations=2"]);
    let report = Run::new(&scene).unwrap().solve(&mut ()).unwrap();
    assert!(report.status != Status::Converged && report.increments.len() > 1);
    let charts = history_charts(&report);
    let curves = &charts[1].1.panels[0].curves;
    assert_eq!(curves[0].label, "did not converge");
    assert_eq!(charts[0].1.panels[0].curves[0].points.len(), report.increments.len());
    assert!(charts.iter().all(|chart| chart.1.to_svg().is_ok()));
}
