//! The door of the library: reports and arrays without files.

use crate::common::prelude::*;
use crate::common::{block, run};
use stickslip::run::Sink;

fn small() -> Scene {
    block(&["mesh.elements=[6,6]", "time.increments=6"])
}

/// All increments, or the last; each with data and result that satisfy the laws as the record says.
#[test]
fn a_recording_keeps_what_is_wanted() {
    let scene = parsed(&BELT);
    let run = Run::new(&scene).unwrap();
    let numbers = |mut recording: Recording| {
        let report = run.solve(&mut recording).unwrap();
        assert_eq!(report.status, Status::Converged);
        recording.increments.iter().map(|increment| increment.record.index).collect::<Vec<_>>()
    };
    assert_eq!(numbers(Recording::all()), [1, 2, 3, 4]);
    assert_eq!(numbers(Recording::last()), [4]);

    let mut recording = Recording::all();
    let report = run.solve(&mut recording).unwrap();
    let problem = &run.model().problem;
    for (kept, record) in recording.increments.iter().zip(&report.increments) {
        assert_eq!((kept.record.index, kept.record.time), (record.index, record.time));
        let errors = KktErrors::measure(problem, &kept.data(), &kept.state, &KktScales::default()).unwrap();
        assert!(errors.worst().1 < 1e-9, "{errors:?}");
        let open = kept.statuses.iter().filter(|status| **status == ContactStatus::Open).count();
        assert_eq!((open, kept.statuses.len()), (record.contact.open, problem.contacts()));
    }
    // The belt's obstacle moves: gaps and slips are those of each increment.
    assert_ne!(recording.increments[0].w_t_last, recording.increments[3].w_t_last);
}

/// As JSON: one object an increment, arrays by their names in the equations.
#[test]
fn a_recording_is_plain_data() {
    let scene = small();
    let mut recording = Recording::last();
    Run::new(&scene).unwrap().solve(&mut recording).unwrap();
    let json = serde_json::to_value(&recording).unwrap();
    let last = &json["increments"][0];
    assert_eq!((&last["index"], &last["status"]), (&6.into(), &"converged".into()));
    let length = |key: &str| last[key].as_array().unwrap().len();
    assert_eq!(["u", "force"].map(length), [84; 2]);
    assert_eq!(["p_n", "p_t", "p_o", "statuses", "gap", "w_t_last", "w_o_last"].map(length), [6; 7]);
    assert!(last["kkt"]["cone"].is_number());
}

/// A scene and its model by themselves lead to the same; without a scene the report has none.
#[test]
fn a_model_alone_is_run_as_its_scene_is() {
    let scene = small();
    let model = discretise(&scene).unwrap();
    let of_scene = Run::new(&scene).unwrap().solve(&mut ()).unwrap();
    let of_model = Run::of(&model, scene.time.all(), scene.solver).unwrap().solve(&mut ()).unwrap();
    assert_eq!((of_scene.end, &of_scene.forces), (of_model.end, &of_model.forces));
    assert_eq!(of_scene.scene_text.as_deref(), Some(scene.text()));
    assert_eq!((of_model.scene, of_model.scene_text), (None, None));

    let mut keep = Keep::default();
    let outcome = run(&scene, &model, &mut keep);
    assert_eq!(outcome.records.len(), of_scene.increments.len());
    assert_eq!(of_scene.end.sum_p_n, outcome.state.p_n.iter().sum::<f64>());
}

/// A solver of one's own: here one that counts.
struct Counting {
    backend: Box<dyn LinearSolver>,
    factorizations: Arc<std::sync::atomic::AtomicUsize>,
}

impl LinearSolver for Counting {
    fn name(&self) -> &'static str {
        "mine"
    }

    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<(), LinearError> {
        self.backend.analyze(pattern)
    }

    fn factorize(&mut self, values: &[f64]) -> Result<FactorInfo, LinearError> {
        self.factorizations.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        self.backend.factorize(values)
    }

    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        self.backend.solve(b, x)
    }
}

#[test]
fn a_linear_solver_of_ones_own() {
    let scene = small();
    let counts = Arc::default();
    let mine: Box<dyn LinearSolver> =
        Box::new(Counting { backend: SparseLu::default().solver(), factorizations: Arc::clone(&counts) });
    let report = Run::new(&scene).unwrap().solve_with(SystemSolver::from(mine), Sink::Observer(&mut ())).unwrap();
    assert_eq!((report.status, report.solver.as_str()), (Status::Converged, "mine"));
    assert_eq!(counts.load(std::sync::atomic::Ordering::Relaxed), report.totals.factorizations);
    // That of the run itself may have another order of elimination.
    let end = Run::new(&scene).unwrap().solve(&mut ()).unwrap().end;
    for (found, expected) in [(report.end.sum_p_n, end.sum_p_n), (report.end.sum_p_t, end.sum_p_t)] {
        assert!((found - expected).abs() <= 1e-12 * expected.abs(), "{found} {expected}");
    }
}
