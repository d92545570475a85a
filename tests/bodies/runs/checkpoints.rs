//! Histories that are taken up from each of their checkpoints: the numbers are those of the whole, to the last bit.

use crate::common::prelude::*;
use stickslip::solver::CheckpointError;

/// Keeps all checkpoints, as bytes, and all increments.
#[derive(Default)]
struct All {
    checkpoints: Vec<Vec<u8>>,
    increments: Vec<RecordedIncrement>,
}

impl Observer for All {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        self.increments.push(RecordedIncrement::new(step));
        ControlFlow::Continue(())
    }

    fn checkpoint_offered(&mut self, here: &dyn Fn() -> Checkpoint) {
        self.checkpoints.push(here().to_bytes().unwrap());
    }
}

/// The linear algebras of this build, as a scene says them.
fn linear() -> impl Iterator<Item = String> {
    let words = ["umfpack", "faer", "condensed", "condensed-faer"].into_iter();
    let built_in = words.filter(|word| word.parse::<LinearAlgebra>().unwrap().is_built_in());
    built_in.map(|word| format!("solver.linear=\"{word}\""))
}

/// Takes the run of a scene up from each of its checkpoints; gives how many there were.
fn taken_up(scene: &Scene) -> usize {
    let mut all = All::default();
    let whole = Run::new(scene).unwrap().solve(&mut all).unwrap();
    for bytes in &all.checkpoints {
        let checkpoint = Checkpoint::from_bytes(bytes).unwrap();
        let done = checkpoint.increments();
        let mut resumed = Recording::all();
        let report = Run::new(scene).unwrap().from(checkpoint).solve(&mut resumed).unwrap();
        for (one, other) in all.increments[done..].iter().zip(&resumed.increments) {
            assert_eq!(one.state, other.state, "increment {}", one.record.index);
            assert_eq!((&one.statuses, &one.gap, &one.w_t_last), (&other.statuses, &other.gap, &other.w_t_last));
            assert_eq!((one.record.kkt, one.record.iterations), (other.record.kkt, other.record.iterations));
            assert_eq!((one.record.friction_work, one.record.theta), (other.record.friction_work, other.record.theta));
        }
        assert_eq!(resumed.increments.len(), all.increments.len() - done);
        assert_eq!(report.status, whole.status);
        assert_eq!((&report.boundaries, &report.estimates), (&whole.boundaries, &whole.estimates));
        assert_eq!((&report.warnings, &report.largest_pressure), (&whole.warnings, &whole.largest_pressure));
        assert_eq!((report.totals.kkt, report.totals.iterations), (whole.totals.kkt, whole.totals.iterations));
        assert_eq!(report.totals.nnz_factors, whole.totals.nnz_factors);
        assert_eq!((report.working_set, &report.curves), (whole.working_set, &whole.curves));
    }
    all.checkpoints.len()
}

#[test]
fn each_method_on_each_linear_algebra_goes_on_to_the_last_bit() {
    let methods: [&[&str]; 4] = [
        &["solver.setting=\"default\""],
        &["solver.setting=\"paper\""],
        &["solver.method=\"ip\"", "solver.setting=\"default\""],
        &["solver.method=\"ip\"", "solver.setting=\"paper\""],
    ];
    for method in methods {
        for linear in linear() {
            let block = parsed_with(BLOCK, &[&["mesh.elements=[8,8]", "time.increments=8", &linear], method].concat());
            assert!(taken_up(&block) >= 3);
            if method != ["solver.method=\"ip\"", "solver.setting=\"paper\""] {
                let cube =
                    parsed_with(CUBE, &[&["mesh.elements=[3,3,3]", "time.increments=4", &linear], method].concat());
                assert!(taken_up(&cube) >= 3);
            }
        }
    }
}

#[test]
fn bodies_that_contact_holds_friction_that_changes_and_two_bodies_go_on() {
    let small = ["mesh.elements=[8,8]", "time.increments=6"];
    taken_up(&parsed_with(include_str!("../../../data/scenes/held_by_contact.toml"), &small));
    taken_up(&parsed_with(include_str!("../../../data/scenes/frictionless.toml"), &small));
    taken_up(&parsed_with(include_str!("../../../data/scenes/wedge.toml"), &["time.increments=4"]));
    taken_up(&parsed_with(
        include_str!("../../../data/scenes/turning_load.toml"),
        &["time.end=0.25", "output.times=[0.25]", "time.increments=4"],
    ));
    taken_up(&parsed_with(
        include_str!("../../../data/scenes/cycles.toml"),
        &["time.end=8", "output.times=[8]", "time.increments=8"],
    ));
}

/// On tables that have changed by rank one, and on factors of the last statuses.
#[test]
fn exact_paths_go_on_to_the_last_bit() {
    const CYCLES: &str = include_str!("../../../data/scenes/cycles.toml");
    let scenes: [(&str, &[&str]); 2] = [
        (BLOCK, &["mesh.elements=[8,8]", "time.increments=8"]),
        (CYCLES, &["mesh.elements=[6,6]", "time.end=8", "time.increments=12", "output.times=[8]"]),
    ];
    for linear in linear() {
        for (text, set) in scenes {
            let scene = parsed_with(
                text,
                &[set, &["solver.setting=\"default\"", "solver.method=\"events\"", &linear]].concat(),
            );
            assert_eq!(taken_up(&scene), scene.time.all().len());
        }
    }
}

/// An obstacle that rolls in from a side reaches one node after the other.
#[test]
fn working_sets_that_grow_go_on() {
    let text = "[material]\nyoung = 1e9\npoisson = 0.3\n[mesh]\nkind = \"block\"\nsize = [4, 1]\nelements = [40, 6]\n\
        [[support]]\nboundary = \"bottom\"\nfix = [\"x\", \"y\"]\n[[contact]]\nboundary = \"top\"\nfriction = 0.3\n\
        obstacle = { kind = \"cylinder\", center = [2.0, 3.0], radius = 2.0, approach = [[0, 0], [3, 9e-2]] }\n\
        [time]\nend = 3\nincrements = 9\n";
    let scene = parsed(text);
    let (model, times) = (discretise(&scene).unwrap(), scene.time.all());
    let settings = settings_of(&model, Method::BN);
    let settings = HistorySettings { working_set: Some(vec![20]), ..settings };
    let run = |settings: &HistorySettings, all: &mut All| {
        let system = SystemSolver::from(LinearAlgebra::condensed());
        history_of(&model, &times, settings, system, all)
    };
    let mut all = All::default();
    let whole = run(&settings, &mut all);
    assert!(whole.working_set.unwrap().grown > 1 && all.checkpoints.len() > 3, "{:?}", whole.working_set);
    for bytes in &all.checkpoints {
        let from = Some(Checkpoint::from_bytes(bytes).unwrap());
        let resumed = run(&HistorySettings { from, ..settings.clone() }, &mut All::default());
        assert_eq!((resumed.status, &resumed.state, resumed.tally), (whole.status, &whole.state, whole.tally));
        assert_eq!((resumed.working_set, resumed.increment_error), (whole.working_set, whole.increment_error));
    }
}

#[test]
fn what_is_no_checkpoint_of_this_run_is_refused() {
    let block = parsed_with(BLOCK, &["mesh.elements=[6,6]", "time.increments=4", "solver.setting=\"default\""]);
    let mut all = All::default();
    Run::new(&block).unwrap().solve(&mut all).unwrap();
    let checkpoint = Checkpoint::from_bytes(&all.checkpoints[1]).unwrap();
    let refused = |set: &[&str]| {
        let other = parsed_with(
            BLOCK,
            &[&["mesh.elements=[6,6]", "time.increments=4", "solver.setting=\"default\""], set].concat(),
        );
        let run = Run::new(&other).unwrap().from(checkpoint.clone());
        match run.solve(&mut ()) {
            Err(RunError::History(history::Error::Checkpoint(error))) => error,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(refused(&["mesh.elements=[7,6]"]), CheckpointError::Other { what: "the mesh or its contact" });
    assert_eq!(refused(&["solver.setting=\"paper\""]), CheckpointError::Other { what: "the method" });
    assert_eq!(refused(&["time.increments=5"]), CheckpointError::Other { what: "the times of the increments" });
    // Data that change no size.
    for (set, what) in [
        ("material.young=1e6", "the stiffness of the body"),
        ("material.poisson=0.1", "the stiffness of the body"),
        ("mesh.size=[2,1]", "the stiffness of the body"),
        ("mesh.size=[2,2]", "the weights of the contact nodes"),
        ("contact.friction=0.01", "the friction"),
        ("load[0].traction=[0,-1]", "the loads, gaps or motions"),
        ("load[0].history=[[0,0],[0.9,1],[1,1]]", "the loads, gaps or motions"),
        ("contact.obstacle.gap=1e-9", "the loads, gaps or motions"),
        ("time.end=7", "the times of the increments"),
        ("solver.tolerance=1e-6", "the method"),
    ] {
        assert_eq!(refused(&[set]), CheckpointError::Other { what }, "{set}");
    }
    // What an exact path leaves is another part.
    assert_eq!(refused(&["solver.method=\"events\""]), CheckpointError::Damaged);
    assert_eq!(
        refused(&["solver.linear=\"condensed\"", "solver.linear=\"faer\"", "mesh.elements=[6,7]"]).to_string(),
        "the checkpoint is that of another run: the mesh or its contact differs"
    );
}

/// A history of one's own, without a run, over more increments than were asked for at first.
#[test]
fn a_history_goes_on_beyond_its_first_end() {
    let block = parsed_with(BLOCK, &["mesh.elements=[6,6]", "time.increments=4", "solver.setting=\"default\""]);
    let model = discretise(&block).unwrap();
    let times = block.time.all();
    let settings = settings_of(&model, Method::BN);
    let run = |times: &[f64], settings: &HistorySettings, all: &mut All| {
        history_of(&model, times, settings, SystemSolver::default(), all)
    };
    let whole = run(&times, &settings, &mut All::default());
    let mut half = All::default();
    run(&times[..2], &settings, &mut half);
    let from = Checkpoint::from_bytes(half.checkpoints.last().unwrap()).unwrap();
    assert_eq!((from.increments(), from.time()), (2, times[1]));
    let resumed =
        run(&times, &HistorySettings { from: Some(from), keeps_records: false, ..settings }, &mut All::default());
    assert_eq!((resumed.status, &resumed.state, resumed.tally), (Status::Converged, &whole.state, whole.tally));
    assert_eq!(resumed.records.len(), 2);
}
