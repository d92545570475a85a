//! What increments leave, by the run itself, beside the exact path in time. doc/method/estimates.md has the figures, which `--nocapture` prints.

use crate::common::prelude::*;
use stickslip::solver::history::IncrementError;

const LINE: &str = include_str!("../../../data/scenes/hertz_line.toml");
const SPHERE: &str = include_str!("../../../data/scenes/hertz_sphere.toml");

fn solved(scene: &str, increments: usize, set: &[&str]) -> RunReport {
    let increments = format!("time.increments={increments}");
    let set: Vec<_> = set.iter().chain([&increments.as_str()]).map(|set| set.parse().unwrap()).collect();
    let scene = Scene::parse("scene.toml", scene, &set).unwrap();
    let report = Run::new(&scene).unwrap().solve(&mut ()).unwrap();
    assert_eq!(report.status.to_string(), "converged");
    report
}

fn left(report: &RunReport) -> IncrementError {
    report.estimates.increments.unwrap()
}

fn warned(report: &RunReport) -> [bool; 2] {
    [WarningKind::INCREMENTS_WORK, WarningKind::INCREMENTS_FORCE]
        .map(|kind| report.warnings.iter().any(|warning| warning.kind == kind))
}

/// A plane that is pressed in from where it touches: forces and slip grow in proportion, so that every increment has the exact forces, and the
/// work of `n` of them is `1 + 1/n` of the true one.
#[test]
fn proportional_loads_leave_an_error_of_the_work_alone() {
    let start = LINE.find("kind = \"cylinder\"").unwrap();
    let end = LINE.find("approach").unwrap();
    let plane = format!("{}kind = \"plane\"\n{}", &LINE[..start], &LINE[end..]);
    let coarse = ["contact[0].friction=0.2", "mesh.contact_elements=24", "mesh.outer_elements=24", "mesh.layers=14"];
    let works = [1, 4, 16].map(|n| {
        let report = solved(&plane, n, &coarse);
        let found = left(&report);
        assert_eq!((found.force_error, found.sticking_begins), (Some(0.0), 0));
        assert!((found.work_error - 1.0 / (n + 1) as f64).abs() < 1e-9, "{n}: {found:?}");
        assert_eq!(warned(&report), [found.work_error > 0.1, false]);
        found.friction_work_corrected
    });
    assert!(works.iter().all(|work| (work / works[0] - 1.0).abs() < 1e-9), "{works:?}");
}

/// A push that comes and goes between the ends of equal increments: further increments end at its kinks, so that it leaves the same forces as with
/// increments that are short enough for it. So do a support, an obstacle and friction that come and go.
#[test]
fn increments_end_at_kinks() {
    let block = ["contact.friction=0.1", "mesh.elements=[10,10]", "solver.setting=\"default\""];
    let obstacle = "contact.obstacle={kind=\"plane\", gap=1e-5, approach=[[1,0],[1.1,9e-6],[1.2,0]]}";
    let support = ["support[0].displacement=[1e-5,0]", "support[0].history=[[1,0],[1.1,1],[1.2,0]]"];
    for set in [
        &["load[1].history=[[1,0],[1.1,1],[1.2,0]]"][..],
        &[obstacle],
        &support,
        &["contact.friction_history=[[1,1],[1.1,0.1],[1.2,1]]"],
    ] {
        let set = [&block, set].concat();
        let [coarse, fine] = [10, 20].map(|n| solved(BLOCK, n, &set));
        assert_eq!((&coarse.kinks[..], fine.kinks.len(), coarse.increments.len()), (&[1.1][..], 0, 11));
        let [few, many] = [&coarse, &fine].map(|report| report.end.sum_p_t);
        assert!((few - many).abs() < 1e-3 * many.abs(), "{set:?}: {few} {many}");
    }
}

/// Increments are not divided. A node on springs of 2 N/m moves along a floor, 0.4 m above it, while it is pressed towards it, and touches when 0.8 of the loads of 1 N are
/// there: it has moved by 0.4 m and sticks there, under 0.2 N along the floor. The increment has it slide by 0.2 m, counted from where it was
/// when it was still apart, under 0.6 N.
#[test]
fn a_node_that_sticks_where_it_touches_though_its_increment_has_it_slide() {
    let stiffness = Symmetric::from_triplets(2, &[(0, 0, 2.0), (1, 1, 2.0)]).unwrap();
    let [c_n, c_t] = [(1, -1.0), (0, 1.0)].map(|entry| Csr::from_rows(2, [[entry]]).unwrap());
    let problem = ContactProblem::new(Parts { c_t, mu: vec![3.0], ..Parts::new(stiffness, c_n) }).unwrap();
    let load = LoadCase::new(vec![1.0, -1.0], vec![[0.0, 0.0], [1.0, 1.0]]).unwrap();
    let loading = Loading::new(vec![load], vec![0.4]).unwrap();
    let settings = HistorySettings::new(&problem, &loading, Method::BN).unwrap();
    let settings = HistorySettings { estimates_error: true, halvings: 0, ..settings };
    let outcome = history::run(&problem, &loading, &[1.0], &settings, SystemSolver::default(), &mut ()).unwrap();
    assert!((outcome.state.p_t[0] - 0.6).abs() < 1e-12, "{:?}", outcome.state);
    let found = outcome.increment_error.unwrap();
    let estimate = found.force_error.unwrap() / (0.4 / 0.6);
    assert!((0.4..2.0).contains(&estimate), "{found:?}");
    assert_eq!((found.work_error, found.sticking_begins, found.fewest), (1.0, 1, Some(1)));

    // A history that does not ask for the estimate pays nothing for it, and has the same state.
    let settings = HistorySettings { estimates_error: false, ..settings };
    let without = history::run(&problem, &loading, &[1.0], &settings, SystemSolver::default(), &mut ()).unwrap();
    assert_eq!((&without.state, without.increment_error), (&outcome.state, None));
    assert!(without.linear.factorizations < outcome.linear.factorizations);
}

/// The block is pressed in full at t = 0 and let go by three quarters: the first increment presses and lets go at once, so that friction points as
/// after a smaller press. With a stage that holds the press there is nothing to tell.
#[test]
fn loads_that_are_there_at_the_start_and_change_at_once_are_warned_of() {
    let block = ["mesh.elements=[20,20]", "contact.friction=0.2", "load[1].history=[[0,0],[2,0]]"];
    let warning = |history: &str, increments: usize| {
        let history = format!("load[0].history={history}");
        let report = solved(BLOCK, increments, &[&block[..], &[&history]].concat());
        let message = report.warnings.into_iter().find(|warning| warning.kind == WarningKind::INCREMENTS_FORCE);
        message.filter(|warning| warning.message.contains("t = 0")).map(|warning| warning.message)
    };
    let message = warning("[[0,1],[2,0.25]]", 1).unwrap();
    assert!(message.contains("history = [[0, 1], [1, 1], [2, 0]]"), "{message}");
    for (history, increments) in [("[[0,1],[1,1],[2,0.25]]", 2), ("[[0,0],[2,1]]", 1), ("[[0,1],[2,1]]", 1)] {
        assert_eq!(warning(history, increments), None, "{history}");
    }
}

/// Interference as small as rounding, or as the error of a curved gap, is none: it costs no second solution. Interference that
/// counts does, and is told.
#[test]
fn interference_of_the_size_of_rounding_is_none() {
    let of_gap = |gap: f64| {
        let gap = format!("contact.obstacle.gap={gap:e}");
        let block = ["mesh.elements=[20,20]", "contact.friction=0.2", "support.boundary=top"];
        let set: Vec<_> = block.iter().chain([&gap.as_str()]).map(|set| set.parse().unwrap()).collect();
        let scene = Scene::parse("block.toml", BLOCK, &set).unwrap();
        let mut iterations = Iterations::default();
        let report = Run::new(&scene).unwrap().solve(&mut iterations).unwrap();
        assert_eq!(report.status, history::Status::Converged);
        (report.estimates.start, iterations.0)
    };
    let (none, iterations) = of_gap(0.0);
    assert_eq!((none, of_gap(-1e-18)), (None, (None, iterations)));
    assert_eq!(of_gap(-1e-12).0, None);
    let (start, more) = of_gap(-1e-6);
    assert!(start.is_some() && more > iterations, "{start:?}");
}

/// Counts the iterations of all solutions.
#[derive(Default)]
struct Iterations(usize);

impl history::Observer for Iterations {
    fn iteration(&mut self, _: usize, _: &stickslip::solver::IterationRecord) -> ControlFlow<()> {
        self.0 += 1;
        ControlFlow::Continue(())
    }
}

/// Interference at t = 0 comes with the first increment, which has twice its friction work: more increments do not help, and are not advised.
#[test]
fn the_work_of_interference_at_the_start_is_warned_of_with_its_cure() {
    let block =
        ["mesh.elements=[10,10]", "solver.setting=\"default\"", "contact.obstacle.gap=-1e-4", "support.boundary=top"];
    let set = [&block[..], &["load[0].history=[[0,0],[2,0.01]]", "load[1].history=[[0,0],[2,0.01]]"]].concat();
    for n in [4, 64] {
        let report = solved(BLOCK, n, &set);
        let message =
            &report.warnings.iter().find(|warning| warning.kind == WarningKind::INCREMENTS_WORK).unwrap().message;
        assert!(message.contains("grow from 0") && !message.contains("four times"), "{message}");
        let found = left(&report);
        assert!((0.4..0.6).contains(&found.first_work_error), "{n}: {found:?}");
    }
}

/// A block slides along springs while its friction falls to a third: they take (F² - R²) / 2k, whatever the increments make of it.
#[test]
fn the_work_of_friction_that_falls_is_corrected() {
    let scene = BLOCK.replace(
        "[[load]]                        # Q1\nboundary = \"right\"\ntraction = [-10e6, 0.0]         # N/m²\nhistory = [[0, 0], [1, 1], [2, 0]]\n",
        "[[load]]\nboundary = \"left\"\ntraction = [3e6, 0]\nhistory = [[0.5, 0], [1, 1], [2, 1]]\n\
         [[spring]]\nboundary = \"left\"\nstiffness = [1e9, 0]\n",
    );
    assert!(scene.contains("[[spring]]"));
    let start = scene.find("[[support]]").unwrap();
    let end = start + scene[start..].find("[[contact]]").unwrap();
    let scene = format!("{}{}", &scene[..start], &scene[end..]);
    let falls = ["mesh.elements=[10,10]", "contact.friction=0.4", "contact.friction_history=[[0,1],[1,1],[2,0.25]]"];
    let [few, many] = [8, 320].map(|n| left(&solved(&scene, n, &falls)));
    let truth = many.friction_work_corrected;
    assert!((many.friction_work / truth - 1.0).abs() < 0.02, "{many:?}");
    assert!((few.friction_work / truth - 1.0).abs() > 0.1, "{few:?}");
    assert!((few.friction_work_corrected / truth - 1.0).abs() < 0.05, "{few:?} {many:?}");
}

/// All nodes of the block slip with little friction: backward Euler has the exact forces, and there is nothing to warn of.
#[test]
fn slip_alone_leaves_no_error_of_the_forces() {
    for n in [2, 6, 20] {
        let report = solved(BLOCK, n, &["contact.friction=0.1", "mesh.elements=[20,20]"]);
        let found = left(&report);
        assert_eq!((found.force_error, found.sticking_begins), (Some(0.0), 0), "{n}: {found:?}");
        assert_eq!(warned(&report), [found.work_error > 0.1, false], "{n}: {found:?}");
    }
}

/// A cylinder with friction (Spence): nodes come into contact one after the other, and stick. One increment has far too small a stick zone.
#[test]
fn a_cylinder_is_warned_of_with_few_increments() {
    let coarse = ["contact[0].friction=0.3", "mesh.contact_elements=32", "mesh.outer_elements=24", "mesh.layers=16"];
    let of = |n| solved(LINE, n, &coarse);
    let [one, four, many] = [1, 4, 64].map(of);
    assert_eq!(warned(&one), [true; 2]);
    assert!(warned(&four)[0]);
    // The exact path has 11 % less work than 64 increments.
    assert_eq!(warned(&many), [true, false]);
    let message = &one.warnings.iter().find(|warning| warning.kind == WarningKind::INCREMENTS_FORCE).unwrap().message;
    assert!(message.contains("a single increment") && message.ends_with("; take 8 or more"), "{message}");
    // The stick zone on the screen: of nodes in contact.
    let share = |report: &RunReport| {
        let counts = report.increments.last().unwrap().contact;
        counts.stick as f64 / (counts.stick + counts.slip) as f64
    };
    for report in [&one, &four, &many] {
        println!("cylinder, {:2} increments: stick {:.2}, {:?}", report.increments.len(), share(report), left(report));
    }
    assert!(share(&one) < 0.35 && share(&many) > 0.6, "{} {}", share(&one), share(&many));
}

/// The same with a sphere in space, where only the work has an estimate.
#[test]
fn a_sphere_is_warned_of_with_few_increments() {
    let coarse = ["contact[0].friction=0.3", "mesh.elements=[[8,4],[8,4],8]"];
    let of = |n| solved(SPHERE, n, &coarse);
    let [one, eight, many] = [1, 8, 64].map(of);
    for report in [&one, &eight, &many] {
        println!("sphere, {:2} increments: {:?}", report.increments.len(), left(report));
    }
    assert_eq!((warned(&one), left(&one).fewest), ([true; 2], Some(1)));
    assert_eq!(warned(&eight), [true, false]);
    assert_eq!(warned(&many), [false; 2]);
}

/// A cube whose base touches from the beginning, under loads in proportion: no node begins to stick that did not from the first.
#[test]
fn a_cube_in_proportion_is_not_warned_of() {
    let touching = ["contact[0].friction=0.8", "contact[0].obstacle.gap=0.0"];
    let set = [&touching[..], &["mesh.elements=[4,4,4]", "time.end=1.0", "output.times=[1.0]"]].concat();
    for n in [1, 3, 8] {
        let report = solved(CUBE, n, &set);
        let found = left(&report);
        assert_eq!((found.sticking_begins, warned(&report)), (0, [found.work_error > 0.1, false]), "{n}");
        let counts = report.increments.last().unwrap().contact;
        assert!(counts.stick > 0 && counts.slip > 0, "{counts:?}");
    }
}

/// Under a rounded punch the work is several times too large with few increments: the estimate sees it, and what it makes of it is nearer
/// to that of the exact path.
#[test]
fn the_work_under_a_punch_is_corrected() {
    let path = solved(PUNCH, 1, &["solver.method=\"events\""]);
    let truth: f64 = path.increments.iter().map(|record| record.friction_work).sum();
    for n in [8, 16, 32, 64] {
        let found = left(&solved(PUNCH, n, &[]));
        let error = (found.friction_work - truth) / found.friction_work;
        let effectivity = found.work_error / error;
        println!("punch, {n:2} increments: {error:.3} of the work, estimate {:.3}", found.work_error);
        assert!((1.0 / 1.5..1.5).contains(&effectivity), "{n}: {effectivity}");
        assert!((found.friction_work_corrected - truth).abs() < 0.2 * (found.friction_work - truth), "{n}: {found:?}");
    }
}

/// The same on the contact displacements alone, where increments go together and nodes join as they are needed.
#[test]
fn the_condensed_body_has_the_same_estimate() {
    let whole = left(&solved(PUNCH, 32, &[]));
    let condensed = left(&solved(PUNCH, 32, &["solver.linear=\"condensed\""]));
    assert_eq!(whole.sticking_begins, condensed.sticking_begins);
    assert_eq!(whole.fewest, condensed.fewest);
    for (a, b) in [
        (whole.friction_work_corrected, condensed.friction_work_corrected),
        (whole.force_error.unwrap(), condensed.force_error.unwrap()),
    ] {
        assert!((a / b - 1.0).abs() < 1e-6, "{whole:?} {condensed:?}");
    }
}

/// No friction, nothing to say.
#[test]
fn nothing_is_told_without_friction() {
    assert!(solved(BLOCK, 4, &["mesh.elements=[6,6]", "contact.friction=0.0"]).estimates.increments.is_none());
}

/// The error of the increments belongs to the history, not to the method that solves it: both methods tell the same.
#[test]
fn all_methods_tell_the_same_of_increments() {
    for (scene, n, set) in [
        (PUNCH, 4, &["contact.friction=0.4"][..]),
        (BLOCK, 8, &["mesh.elements=[12,12]", "solver.setting=\"default\""]),
        (LINE, 2, &["contact.friction=0.3", "mesh.contact_elements=16", "mesh.layers=8"]),
    ] {
        let bn = solved(scene, n, set);
        let ip = solved(scene, n, &[set, &["solver.method=\"ip\""]].concat());
        let (a, b) = (left(&bn), left(&ip));
        assert!((a.work_error - b.work_error).abs() < 1e-6, "{a:?} {b:?}");
        assert!((a.force_error.unwrap() - b.force_error.unwrap()).abs() < 1e-6, "{a:?} {b:?}");
        assert_eq!((warned(&bn), a.fewest), (warned(&ip), b.fewest));
    }
}

/// Tangential forces that are rounding have no error, in however few increments nodes touch.
#[test]
fn rounding_is_not_warned_of() {
    let body = |name: &str, y: f64, n: usize| {
        format!(
            "[[body]]\nname = \"{name}\"\nat = [0, {y:?}]\nmesh = {{ kind = \"block\", size = [0.3, 0.2], elements = [{n}, 2] \
             }}\nmaterial = {{ young = 2e9, poisson = 0.3 }}\n[[support]]\nboundary = \"{name}:left\"\nfix = [\"x\"]\n"
        )
    };
    let text = [
        body("lower", 0.0, 3),
        body("upper", 0.2, 4),
        "[[support]]\nboundary = \"lower:bottom\"\nfix = [\"y\"]\n[[contact]]\nboundary = \"upper:bottom\"\nagainst = \
         \"lower:top\"\nfriction = 0.5\n[[load]]\nboundary = \"upper:top\"\npressure = 1e6\n[time]\nend = 1\n"
            .to_string(),
    ]
    .concat();
    let report = solved(&text, 2, &[]);
    assert_eq!(warned(&report), [false; 2], "{:?}", report.warnings);
    assert_eq!(left(&report).sticking_begins, 0);
}
