//! The comparison of errors and times: errors agree with those calculated by hand, the friction work is the work of the
//! loads minus the strain energy, time stepping is of first order, and the fastest run is identified.
#![allow(clippy::unwrap_used)]

use crate::program::WHOLE;
use std::ops::ControlFlow;
use stickslip::algebra::linear::{SparseCholesky, SparseLu};
use stickslip::base::UnitSystem;
use stickslip::run::discretise;
use stickslip::scene::Scene;
use stickslip::solver::history::{
    self, HistoryMethod, HistorySettings, IncrementView, LinearAlgebra, Method, Observer, Status, SystemSolver,
};
use stickslip_cli::compare::{
    self, Comparison, Course, End, Estimate, MeshChoice, MeshErrors, MeshResult, MeshSize, Phases, Plan, SolverPath,
    TimeErrors, TractionNode, Tractions, Trial, front,
};

/// The solvers that this build has.
const LU: SparseLu = if cfg!(feature = "umfpack") { SparseLu::Umfpack } else { SparseLu::Faer };
const CHOLESKY: SparseCholesky = if cfg!(feature = "umfpack") { SparseCholesky::Cholmod } else { SparseCholesky::Faer };

const BN: SolverPath =
    SolverPath { method: HistoryMethod::Increments(Method::BN), linear: Some(LinearAlgebra::Whole(LU)) };
const IP: SolverPath = SolverPath { method: HistoryMethod::Increments(Method::Ip), ..BN };
const EVENTS: SolverPath = SolverPath { method: HistoryMethod::ExactPath, ..BN };
pub const CONDENSED: SolverPath = SolverPath { linear: Some(LinearAlgebra::Condensed(CHOLESKY)), ..BN };

fn block(overrides: &[&str]) -> Scene {
    let overrides: Vec<_> = overrides.iter().map(|text| text.parse().unwrap()).collect();
    Scene::parse("block.toml", include_str!("../../../../data/scenes/block.toml"), &overrides).unwrap()
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-14 * b.abs()
}

/// Returns contact nodes along x, a metre apart, each with the weight 1 m.
fn end(p_n: &[f64], p_t: &[f64], work: f64) -> End {
    let node = |(i, (n, t)): (usize, (&f64, &f64))| TractionNode {
        position: [i as f64, 0.0, 0.0],
        weight: 1.0,
        value: [*t, -*n, 0.0],
        at_the_rim: i == 0 || i + 1 == p_n.len(),
    };
    let pieces = (1..p_n.len()).map(|i| vec![i - 1, i]).collect();
    let tractions = Tractions { nodes: p_n.iter().zip(p_t).enumerate().map(node).collect(), pieces };
    End { p_n: p_n.to_vec(), p_t: p_t.to_vec(), p_o: vec![0.0; p_n.len()], work, energy: 10.0, peak: 1.0, tractions }
}

#[test]
fn errors_of_time_stepping_are_those_computed_by_hand() {
    let (run, reference) = (end(&[3.0, 4.0], &[0.5, 0.0], 8.0), end(&[3.0, 2.0], &[1.0, 0.0], 10.0));
    // Squares of tractions times weights: 2² / 4 relative to 3² / 1 + 2² / 4, and 0.5² / 1 relative to 1² / 1.
    let errors = TimeErrors::new(&run, &reference, &[1.0, 4.0]);
    assert!(close(errors.p_n, (1.0_f64 / 10.0).sqrt()));
    assert!(close(errors.p_t, 0.5));
    assert!(close(errors.forces, (1.25_f64 / 11.0).sqrt()));
    assert!(close(errors.work, 0.2));
    // Zero friction has no error.
    let frictionless = end(&[3.0, 2.0], &[0.0; 2], 0.0);
    let errors = TimeErrors::new(&frictionless, &frictionless, &[1.0, 4.0]);
    assert_eq!(errors, TimeErrors { p_n: 0.0, p_t: 0.0, forces: 0.0, work: 0.0 });
}

#[test]
fn errors_of_a_mesh_are_those_computed_by_hand() {
    // Of seven nodes, the two outermost elements at both ends, with nodes 0, 1, 5 and 6, are omitted.
    let coarse = end(&[9.0, 9.0, 1.0, 2.0, 3.0, 9.0, 9.0], &[0.0; 7], 0.0);
    let within = coarse.tractions.interior();
    // A mesh twice as fine with x/2 everywhere, so the values at nodes 2, 3, 4 are 1, 1.5, 2.
    let mut fine = end(&[0.0; 13], &[0.0; 13], 0.0);
    let mut nodes = fine.tractions.nodes.clone();
    for (i, node) in nodes.iter_mut().enumerate() {
        node.position = [0.5 * i as f64, 0.0, 0.0];
        node.value = [0.0, -0.25 * i as f64, 0.0];
    }
    let pieces = (1..nodes.len()).map(|i| vec![i - 1, i]).collect();
    fine.tractions = Tractions { nodes, pieces };
    // At x = 2, 2.5, 3, 3.5 and 4 the values are 1, 1.5, 2, 2.5 and 3 in place of 1, 1.25, 1.5, 1.75 and 2.
    let [apart, whole] = [[0.0, 0.25, 0.5, 0.75, 1.0], [1.0, 1.25, 1.5, 1.75, 2.0_f64]].map(|all| all.map(|x| x * x));
    let expected = (apart.iter().sum::<f64>() / whole.iter().sum::<f64>()).sqrt();
    assert!(close(coarse.tractions.distance(&fine.tractions, &within), expected));
    // A mesh is linear between its nodes, whatever their spacing.
    let pieces = [[0, 1], [1, 2], [2, 4], [4, 5], [5, 6]].map(Vec::from).to_vec();
    let wider = Tractions { nodes: coarse.tractions.nodes.clone(), pieces };
    assert!(close(wider.distance(&fine.tractions, &within), expected));

    fine.p_n = vec![3.0; 13];
    fine.p_t = vec![-1.0; 13];
    fine.energy = 8.0;
    let mut errors = MeshErrors::new(&coarse, &fine, &within);
    assert!(close(errors.sum_p_n, 3.0 / 39.0) && close(errors.sum_p_t, 13.0 / 39.0) && close(errors.energy, 0.25));
    // The tangential resultant is (13, 5) in place of (0, 0).
    fine.p_o[3] = 5.0;
    errors.sum_p_t = MeshErrors::new(&coarse, &fine, &within).sum_p_t;
    assert!(close(errors.sum_p_t, 13.0_f64.hypot(5.0) / 39.0));
    assert!(close(errors.tractions, expected));
}

#[test]
fn the_front_holds_what_no_cheaper_run_reaches() {
    let points = [[3.0, 1e-3], [1.0, 1e-2], [2.0, 1e-2], [4.0, 2e-3], [5.0, 0.9999e-3], [9.0, 1e-9], [0.1, f64::NAN]];
    assert_eq!(front(&points), [1, 0, 5]);
    assert_eq!(front(&[[1.0, 2.0], [1.0, 1.0]]), [1]);
    assert!(front(&[]).is_empty());
}

/// Returns a mesh with this number of elements in the first direction.
fn wide(elements: usize) -> MeshChoice {
    MeshSize::Elements(elements).into()
}

/// Returns meshes with these numbers of elements in the first direction.
fn elements(counts: &[usize]) -> Vec<MeshChoice> {
    counts.iter().copied().map(wide).collect()
}

/// Observer that sums the work of the external forces.
struct External {
    work: f64,
    force: Vec<f64>,
    u: Vec<f64>,
}

impl Observer for External {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        let moved = step.state.u.iter().zip(&self.u).map(|(u, before)| u - before);
        let mean = step.increment.force.iter().zip(&self.force).map(|(f, before)| 0.5 * (f + before));
        self.work += moved.zip(mean).map(|(u, f)| u * f).sum::<f64>();
        self.force = step.increment.force.to_vec();
        self.u.clone_from(&step.state.u);
        ControlFlow::Continue(())
    }
}

#[test]
fn friction_dissipates_what_the_loads_do_beyond_the_strain_energy() {
    for (mu, increments) in [("0.4", 400), ("0.8", 400), ("0.0", 20)] {
        let scene = block(&[
            "mesh.elements=[10,10]",
            &format!("time.increments={increments}"),
            &format!("contact.friction={mu}"),
        ]);
        let model = discretise(&scene).unwrap();
        let problem = &model.problem;
        let zero = vec![0.0; problem.displacements()];
        let mut external = External { work: 0.0, force: zero.clone(), u: zero.clone() };
        let settings = HistorySettings::new(problem, &model.loading, Method::BN).unwrap().until(100, 1e-10);
        let times = scene.time.all();
        let outcome =
            history::run(problem, &model.loading, &times, &settings, SystemSolver::default(), &mut external).unwrap();
        assert_eq!(outcome.status, Status::Converged);

        let force = problem.stiffness().assembled().unwrap().times(&outcome.state.u).unwrap();
        let energy = 0.5 * outcome.state.u.iter().zip(&force).map(|(u, f)| u * f).sum::<f64>();
        let friction = || outcome.records.iter().map(|record| record.friction_work);
        let total: f64 = friction().sum();
        assert!(friction().all(|work| work >= -1e-9 * energy), "mu = {mu}");
        if mu == "0.0" {
            assert_eq!(total, 0.0);
        } else {
            // Both sums have an error of first order in the increments.
            let dissipated = external.work - energy;
            assert!(
                total > 1e-3 * energy && (total / dissipated - 1.0).abs() < 0.02,
                "mu = {mu}: {total}, {dissipated}"
            );
        }
    }
}

#[test]
fn time_stepping_is_of_first_order_on_every_path() {
    let scene = block(&["contact.friction=0.8"]);
    let ip = SolverPath { method: Method::Ip.into(), ..CONDENSED };
    let paths = vec![BN, ip, CONDENSED];
    let plan = Plan { paths, meshes: elements(&[20, 10]), increments: vec![20, 320, 80], reference: 8, jobs: 1 };
    let mut messages = Vec::new();
    let comparison = compare::compute(&scene, &plan, &(), &mut |what| messages.push(what), || false).unwrap();
    assert_eq!(messages.len(), plan.histories());
    assert_eq!(comparison.runs.len(), plan.histories() - 2);
    assert!(comparison.runs.iter().all(|run| run.course.status == Status::Converged && run.course.kkt <= 1e-10));

    let meshes: Vec<_> = comparison.meshes.iter().map(|result| (result.mesh.clone(), result.increments)).collect();
    // The reference is the exact path.
    assert_eq!(meshes, [10, 20].map(|n| (wide(n), 0)));
    assert!(comparison.meshes[1].errors.is_none() && comparison.meshes[0].errors.unwrap().tractions > 1e-3);

    let finest = wide(20);
    let errors = |path, increments| {
        let run = comparison.on(&finest).find(|run| run.path == path && run.increments == increments).unwrap();
        assert!(run.course.iterates.iter().all(|iterate| iterate.increment <= increments));
        // The default settings end every increment by the error measure.
        assert!(run.course.iterates.last().unwrap().error.unwrap() <= 1e-10);
        run.errors.unwrap()
    };
    let [first, middle, last] = [20, 80, 320].map(|increments| errors(BN, increments));
    let order = (first.p_t / last.p_t).log2() / 4.0;
    assert!((0.8..1.3).contains(&order), "{first:?} {last:?}: order {order}");
    assert!(first.work > 3.0 * middle.work && middle.work > 3.0 * last.work, "{first:?} {middle:?} {last:?}");
    // The error depends on the increments, not on the solver.
    for path in [ip, CONDENSED] {
        let other = errors(path, 80);
        for (a, b) in [(other.p_n, middle.p_n), (other.p_t, middle.p_t), (other.work, middle.work)] {
            assert!((a / b - 1.0).abs() < 1e-5, "{path}: {other:?}, not {middle:?}");
        }
    }
}

#[test]
fn in_three_dimensions_both_tangents_count() {
    let text = include_str!("../../../../data/scenes/cube.toml");
    let scene =
        |overrides: [&str; 2]| Scene::parse("cube.toml", text, &overrides.map(|text| text.parse().unwrap())).unwrap();
    let increments = vec![4, 16];
    let plan = Plan { paths: vec![BN, CONDENSED], meshes: elements(&[2, 4]), increments, reference: 8, jobs: 1 };
    for scene in [
        scene(["mesh.elements=[6,6,6]", "mesh.size=[1,1,1]"]),
        scene(["mesh.elements=[16,16,4]", "mesh.size=[1,1,0.25]"]),
    ] {
        let comparison = compare::compute(&scene, &plan, &(), &mut |_| (), || false).unwrap();
        assert!(comparison.runs.iter().all(|run| run.course.status == Status::Converged && run.course.kkt <= 1e-10));
        // The clamped row of nodes is not in contact.
        let contacts: Vec<_> = comparison.meshes.iter().map(|result| result.contacts).collect();
        assert_eq!(contacts, [2 * 3, 4 * 5]);
        for result in &comparison.meshes {
            let End { p_n, p_t, p_o, tractions, .. } = &result.end;
            // The tractions, in the directions of space, add up to the same forces. The wall is below.
            let sum = |k: usize| tractions.nodes.iter().map(|node| node.value[k] * node.weight).sum::<f64>();
            let force = |p: &[f64]| p.iter().sum::<f64>();
            assert!((sum(2) / -force(p_n) - 1.0).abs() < 1e-12);
            assert!((sum(0).hypot(sum(1)) / force(p_t).hypot(force(p_o)) - 1.0).abs() < 1e-12);
            assert!(force(p_o).abs() > 1e-2 * force(p_n), "{p_o:?}");
        }
        assert!(comparison.meshes[0].errors.unwrap().tractions > 1e-3);
        for fine in [4, 16] {
            let errors: Vec<TimeErrors> =
                comparison.on(&wide(4)).filter(|run| run.increments == fine).map(|run| run.errors.unwrap()).collect();
            assert!(errors[0].p_t > 1e-6 && (errors[0].p_t / errors[1].p_t - 1.0).abs() < 1e-5, "{errors:?}");
        }
    }
}

/// Returns a run of `seconds` with the contact force error `forces`.
pub fn run(path: SolverPath, mesh: usize, increments: usize, seconds: f64, forces: f64) -> Trial {
    Trial {
        path,
        mesh: wide(mesh),
        increments,
        course: Course {
            status: Status::Converged,
            converged: increments,
            iterations: increments,
            factorizations: increments,
            seconds: Phases { cpu: seconds, ..Phases::default() },
            factor_entries: 1,
            factor_peak_bytes: 0.0,
            kkt: 0.0,
            iterates: Vec::new(),
        },
        errors: Some(TimeErrors { p_n: forces, p_t: forces, forces, work: forces }),
    }
}

/// Returns a mesh with this number of elements in each direction.
pub fn mesh(n: usize) -> MeshResult {
    MeshResult {
        mesh: wide(n),
        displacements: n * n,
        contacts: n,
        increments: 1000,
        not_exact: "",
        status: Status::Converged,
        seconds: 1.0,
        end: end(&[1.0], &[0.0], 0.0),
        errors: None,
        estimates: None,
    }
}

pub fn by_hand() -> Comparison {
    let runs = vec![
        run(BN, 10, 10, 1.0, 4e-3),
        run(BN, 10, 20, 2.0, 1e-3),
        run(IP, 10, 10, 3.0, 4e-3),
        run(IP, 10, 20, 6.0, 1e-3),
        run(CONDENSED, 10, 10, 0.5, 4e-3),
        run(CONDENSED, 10, 20, 0.8, 1e-3),
        run(BN, 100, 20, 2000.0, 1e-11),
        run(IP, 100, 20, 1000.0, 1e-11),
    ];
    Comparison {
        blas: None,
        title: "by hand".into(),
        units: UnitSystem::si(2),
        tolerance: 1e-10,
        meshes: vec![mesh(10), mesh(100)],
        runs,
    }
}

#[test]
fn the_cheapest_run_is_the_cheapest() {
    let mut comparison = by_hand();
    assert_eq!(comparison.cheapest(&wide(10), 1e-3, |_| true), Some(&comparison.runs[5]));
    assert_eq!(
        comparison.cheapest(&wide(10), 1e-2, |path| path.linear == Some(LinearAlgebra::Whole(LU))),
        Some(&comparison.runs[0])
    );
    assert_eq!(comparison.cheapest(&wide(10), 1e-4, |_| true), None);
    assert_eq!(comparison.front(&wide(10)), [&comparison.runs[4], &comparison.runs[5]]);

    // A quarter of the error for twice the increments is order 2. A hundredth of the error then takes ten times as
    // long.
    let Estimate { path, order, increments, seconds } = comparison.estimate(&wide(10), 1e-5).unwrap();
    assert_eq!(path, CONDENSED);
    assert!(close(order, 2.0) && (increments / 200.0 - 1.0).abs() < 1e-12 && (seconds / 8.0 - 1.0).abs() < 1e-12);
    assert_eq!(comparison.estimate(&wide(100), 1e-12), None);

    // The exact path is neither BN nor IP.
    comparison.runs.push(run(EVENTS, 10, 10, 4.0, 0.0));
    let leads = comparison.leads();
    assert_eq!(leads.len(), 1);
    assert_eq!(leads[0].ratios, [(10, 3.0), (100, 0.5)].map(|(n, ratio)| (wide(n), ratio)));
    assert!(close(comparison.growth(BN).unwrap(), 1.5), "{:?}", comparison.growth(BN));
    assert_eq!(comparison.growth(CONDENSED), None);
}

#[test]
fn answers_are_sentences_with_the_numbers() {
    let answers = by_hand().answers().join("\n");
    for part in [
        "Contact forces to 1e-3, n = 10: the cheapest is bn default, condensed with 20 increments, 0.80 s (error \
         1.0e-3); on the uncondensed system bn default, umfpack with 20 increments, 2.0 s.",
        "Contact forces to 1e-6, n = 10: no run comes so near, the best to 1.0e-3; if its error keeps falling at order \
         2.00, bn default, condensed takes about 632 increments and 25 s.",
        "Contact forces to 1e-6, n = 100: the cheapest is ip default, umfpack with 20 increments, 1000 s (error below \
         1.0e-10).",
        "On umfpack, setting default, IP takes 3.00 (n = 10), 0.50 (n = 100) times as long as BN.",
        "like n_u to the power of: bn default, umfpack 1.50; ip default, umfpack 1.11.",
    ] {
        let part = part.replace("umfpack", WHOLE);
        assert!(answers.contains(&part), "{part}\n{answers}");
    }
}

#[test]
fn charts_have_a_line_for_every_path() {
    let stems = |comparison: &Comparison| compare::charts(comparison).iter().map(|chart| chart.0).collect::<Vec<_>>();
    let comparison = by_hand();
    assert_eq!(stems(&comparison), ["forces", "mesh-size", "mesh-time"]);
    let charts = compare::charts(&comparison);
    let svg = charts[0].2.to_svg().unwrap();
    for label in ["bn default, umfpack", "ip default, umfpack", "bn default, condensed", "Pareto front"] {
        let label = label.replace("umfpack", WHOLE);
        assert!(svg.lines().any(|line| line == label), "{label}");
    }
}

#[test]
fn the_command_writes_tables_charts_and_a_page() {
    let folder = std::env::temp_dir().join(format!("stickslip-compare-{}", std::process::id()));
    let stickslip = |arguments: &[&str]| {
        let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/scenes/block.toml");
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_stickslip"))
            .args(["compare", scene, "--meshes", "4,8", "--increments", "2,4"])
            .args(arguments)
            .output();
        output.unwrap()
    };
    let output = stickslip(&["--solvers", WHOLE, "--csv", "--out", folder.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0));
    let csv = String::from_utf8(output.stdout).unwrap();
    assert_eq!(csv.lines().count(), 1 + 2 * 2 * 2, "{csv}");
    assert!(csv.lines().skip(1).all(|line| line.split(',').nth(6) == Some("converged")), "{csv}");
    let mut names: Vec<String> =
        std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    let tables = ["compare.csv", "compare.md", "iterations.csv", "meshes.csv"];
    let charts = ["forces.svg", "mesh-size.svg", "mesh-time.svg"];
    assert!(names.iter().map(String::as_str).filter(|name| !charts.contains(name)).eq(tables), "{names:?}");
    assert_eq!(names.len(), tables.len() + charts.len());
    let page = std::fs::read_to_string(folder.join("compare.md")).unwrap();
    assert!(
        page.contains(&format!("On {WHOLE}, setting default, IP takes")) && page.contains("](forces.svg)"),
        "{page}"
    );
    std::fs::remove_dir_all(&folder).unwrap();

    for bad in [&["--solvers", "mumps"], &["--meshes", "0"], &["--elements", "quad"]] {
        let output = stickslip(bad);
        assert_eq!(output.status.code(), Some(2));
    }
}
