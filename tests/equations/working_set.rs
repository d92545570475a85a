//! Condensed equations that do not hold all contact nodes: the answer is that of all of them, whichever they begin with.

use crate::common::prelude::*;
use stickslip::solver::history::WorkingSet;
use stickslip::solver::working_set;

/// Runs `method` on condensed equations that hold the nodes `first`, or all.
fn condensed(scene: &Scene, model: &Model, method: Method, first: Option<Vec<usize>>) -> (HistoryOutcome, Keep) {
    solve(scene, model, method, first, LinearAlgebra::condensed())
}

fn solve(
    scene: &Scene,
    model: &Model,
    method: Method,
    first: Option<Vec<usize>>,
    linear: LinearAlgebra,
) -> (HistoryOutcome, Keep) {
    let settings = settings_of(model, method);
    let settings = HistorySettings { working_set: first, ..settings };
    let (problem, loading, times, mut keep) = (&model.problem, &model.loading, scene.time.all(), Keep::default());
    let outcome = history::run(problem, loading, &times, &settings, SystemSolver::from(linear), &mut keep).unwrap();
    (outcome, keep)
}

fn within_reach(problem: &ContactProblem, loading: &Loading, times: &[f64], affordable: f64) -> Option<Vec<usize>> {
    working_set(problem, loading, times, affordable, Some(SparseCholesky::default())).unwrap().nodes
}

/// Some of `n` nodes, one at least, each with this probability.
fn some(random: &mut Random, n: usize, share: f64) -> Vec<usize> {
    let one = (random.next() * n as f64) as usize;
    (0..n).filter(|&i| random.next() < share || i == one).collect()
}

/// A block that lies on its bottom, its top under `obstacle`, with `more` at its end.
fn block(size: &str, elements: &str, friction: f64, obstacle: &str, more: &str) -> String {
    let fix = if size.matches(',').count() == 1 { "[\"x\", \"y\"]" } else { "[\"x\", \"y\", \"z\"]" };
    format!(
        "[material]\nyoung = 1e9\npoisson = 0.3\n[mesh]\nkind = \"block\"\nsize = {size}\nelements = {elements}\n\
         [[support]]\nboundary = \"bottom\"\nfix = {fix}\n\
         [[contact]]\nboundary = \"top\"\nfriction = {friction}\nobstacle = {obstacle}\n{more}"
    )
}

/// Presses, moves along, and comes back until nothing touches.
const ROUND: &str = "approach = [[0, 0], [1, 2e-2], [2, 2e-2], [4, -5e-3]]";

/// Round obstacles and planes that move, friction and none, second order, nodes in front of two obstacles, two bodies, loads that
/// open what they have closed.
fn scenes() -> Vec<(&'static str, String)> {
    let cylinder = format!(
        "{{ kind = \"cylinder\", radius = 2.0, apex = [0.6, 1.0], {ROUND}, \
         motion = {{ translation = [[1, 0, 0], [2, 3e-3, 0]] }} }}"
    );
    let sphere = format!(
        "{{ kind = \"sphere\", radius = 2.0, apex = [0.6, 0.5, 0.6], {ROUND}, \
         motion = {{ translation = [[1, 0, 0, 0], [2, 3e-3, 1e-3, 0]] }} }}"
    );
    let time = "[time]\nend = 4.0\nincrements = 8\n";
    let (plane, space) = ("[1.0, 1.0]", "[1.0, 1.0, 0.6]");
    let corner = "[[contact]]\nboundary = \"right\"\nfriction = 0.2\nobstacle = { kind = \"plane\", gap = 1e-3 }\n\
         [[load]]\nboundary = \"left\"\ntraction = [4e6, 2e6]\nhistory = [[0, 0], [1, 1], [2, 1], [3, -0.2], [4, 0.5]]\n";
    let bodies = "[[body]]\nname = \"lower\"\n[body.mesh]\nkind = \"block\"\nsize = [1.0, 0.5]\nelements = [10, 4]\n\
         [body.material]\nyoung = 1e9\npoisson = 0.3\n\
         [[body]]\nname = \"upper\"\nat = [0.0, 0.5]\n[body.mesh]\nkind = \"block\"\nsize = [1.0, 0.5]\nelements = [13, 5]\n\
         [body.material]\nyoung = 2e9\npoisson = 0.3\n\
         [[support]]\nboundary = \"lower:bottom\"\nfix = [\"x\", \"y\"]\n[[support]]\nboundary = \"upper:left\"\nfix = [\"x\", \"y\"]\n\
         [[contact]]\nboundary = \"upper:bottom\"\nagainst = \"lower:top\"\nfriction = 0.3\n\
         [[load]]\nboundary = \"upper:top\"\ntraction = [5e5, -1e6]\nhistory = [[0, 0], [1, 1], [3, -0.5], [4, 1]]\n";
    let plane_obstacle = "{ kind = \"plane\", gap = 1e-3 }";
    vec![
        ("a cylinder", block(plane, "[30, 6]", 0.3, &cylinder, time)),
        ("a cylinder without friction", block(plane, "[30, 6]", 0.0, &cylinder, time)),
        (
            "second order",
            block(plane, "[16, 4]", 0.3, &cylinder, time).replacen("[mesh]", "[mesh]\ncells = \"triangle6\"", 1),
        ),
        ("a sphere", block(space, "[6, 6, 3]", 0.3, &sphere, time)),
        ("a sphere without friction", block(space, "[6, 6, 3]", 0.0, &sphere, time)),
        (
            "a sphere, second order",
            block(space, "[3, 3, 2]", 0.3, &sphere, time).replacen("[mesh]", "[mesh]\ncells = \"tetrahedron10\"", 1),
        ),
        ("a corner", block(plane, "[10, 10]", 0.3, plane_obstacle, &format!("{corner}{time}"))),
        ("two bodies", format!("{bodies}{time}")),
    ]
}

#[test]
fn any_set_leads_to_the_same_answer() {
    let mut random = Random(18);
    let mut grown = 0;
    for (name, text) in scenes() {
        let scene = parsed(&text);
        let model = discretise(&scene).unwrap();
        let (whole, expected) = solve(&scene, &model, Method::BN, None, LinearAlgebra::default());
        assert_eq!(whole.status, Status::Converged, "{name}");
        for (method, share) in [(Method::BN, 0.0), (Method::BN, 0.3), (Method::Ip, 0.1)] {
            let first = some(&mut random, model.problem.contacts(), share);
            let (outcome, keep) = condensed(&scene, &model, method, Some(first.clone()));
            assert_eq!(outcome.status, whole.status, "{name} {method} {first:?}");
            let worst = difference(&expected.states, &keep.states);
            assert!(worst <= 1e-9, "{name} {method} {first:?}: {worst:e}");
            let set = outcome.working_set.unwrap();
            assert!(set.first == first.len() && set.last >= set.first && set.all == model.problem.contacts());
            let joined: usize = outcome.records.iter().map(|record| record.joined).sum();
            assert_eq!(set.last - set.first, joined, "{name} {method}");
            grown += set.grown;
        }
    }
    assert!(grown > 20, "{grown}");
}

/// All nodes are what they are without a set: to the last bit.
#[test]
fn a_set_of_all_nodes_changes_nothing() {
    for (name, text) in scenes() {
        let scene = parsed(&text);
        let model = discretise(&scene).unwrap();
        let all = (0..model.problem.contacts()).collect();
        let (none, expected) = condensed(&scene, &model, Method::BN, None);
        let (outcome, keep) = condensed(&scene, &model, Method::BN, Some(all));
        assert_eq!((none.working_set, outcome.working_set), (None, None), "{name}");
        assert!(expected.states == keep.states, "{name}");
    }
}

/// A set that holds all that ever closes stays, and so does one of any size where the constants of the paper or a body that contact
/// alone holds ask for all.
#[test]
fn sets_that_need_not_grow() {
    let (_, text) = scenes().swap_remove(0);
    let scene = parsed(&text);
    let model = discretise(&scene).unwrap();
    let (_, keep) = condensed(&scene, &model, Method::BN, None);
    let pressed = |i: &usize| keep.states.iter().any(|state| state.p_n[*i] > 0.0);
    let first: Vec<usize> = (0..model.problem.contacts()).filter(pressed).collect();
    let (outcome, other) = condensed(&scene, &model, Method::BN, Some(first.clone()));
    let (held, all) = (first.len(), model.problem.contacts());
    assert_eq!(outcome.working_set, Some(WorkingSet { first: held, last: held, all, grown: 0 }));
    assert!(difference(&keep.states, &other.states) <= 1e-9);
    let (paper, _) = condensed(&scene, &model, Method::PaperBn, Some(first));
    assert_eq!(paper.working_set, None);
    let free = common::scene("held_by_contact.toml", &["time.increments=2"]);
    let model = discretise(&free).unwrap();
    assert_eq!(condensed(&free, &model, Method::BN, Some(vec![0])).0.working_set, None);
}

/// A lever without weight lifts nodes on springs of their own ten times as high as its end is pushed, each towards a stop. The stops
/// are out of reach of what is known before, and in each increment the lever comes to more of them than have joined.
#[test]
fn a_set_that_is_wrong_five_times_in_a_row() {
    const STOPS: usize = 200;
    const REACHED: [usize; 5] = [1, 4, 8, 15, 29];
    // Displacements: the lever's, then those of the nodes.
    let mut entries = vec![(0, 0, 1.0 + 100.0 * STOPS as f64)];
    entries.extend((1..=STOPS).flat_map(|i| [(i, i, 1.0), (i, 0, -10.0)]));
    let stiffness = Symmetric::from_triplets(STOPS + 1, &entries).unwrap();
    // What pushes the lever comes from the other side than the stops.
    let c_n = Csr::from_rows(STOPS + 1, (0..=STOPS).map(|i| [(i, if i == 0 { -1.0 } else { 1.0 })])).unwrap();
    let problem = ContactProblem::new(Parts::new(stiffness, c_n)).unwrap();
    // The end of the lever is pushed by 1 at each time, and by then so many stops are reached.
    let met = |i: usize| REACHED.iter().position(|reached| i < *reached).map_or(6.0, |k| k as f64 + 1.0);
    let gap: Vec<f64> = std::iter::once(0.0).chain((0..STOPS).map(|i| 10.0 * met(i) - 4.0 + 0.01 * i as f64)).collect();
    let push = Motion::new(0..1, vec![-1.0], vec![[0.0; 2]], vec![[0.0, 0.0], [5.0, 5.0]]).unwrap();
    let loading = Loading::new(Vec::new(), gap).unwrap().with_motions(vec![push], Vec::new()).unwrap();
    let times = [1.0, 2.0, 3.0, 4.0, 5.0];
    // One stop is guessed beside the end that is pushed. To be wrong once more, none.
    assert_eq!(within_reach(&problem, &loading, &times, 0.0), Some(vec![0, 1]));
    let first = vec![0];
    for method in [Method::BN, Method::Ip] {
        let settings = HistorySettings::new(&problem, &loading, method).unwrap();
        let set = HistorySettings { working_set: Some(first.clone()), ..settings.clone() };
        let (mut keep, mut expected) = (Keep::default(), Keep::default());
        let linear = || LinearAlgebra::condensed().into();
        let outcome = history::run(&problem, &loading, &times, &set, linear(), &mut keep).unwrap();
        let all = history::run(&problem, &loading, &times, &settings, SystemSolver::default(), &mut expected).unwrap();
        assert_eq!((outcome.status, all.status), (Status::Converged, Status::Converged));
        let joined: Vec<usize> = outcome.records.iter().map(|record| record.joined).collect();
        assert_eq!(joined, [2, 4, 7, 14, 28]);
        assert_eq!(outcome.working_set, Some(WorkingSet { first: 1, last: 56, all: STOPS + 1, grown: 5 }));
        for (state, reached) in keep.states.iter().zip(REACHED) {
            assert_eq!(state.p_n[1..].iter().filter(|p| **p > 0.0).count(), reached);
        }
        assert!(difference(&expected.states, &keep.states) <= 1e-9);
    }
}

/// What the method does not solve on some nodes is left to all of them: too few iterations are told as that, by all.
#[test]
fn a_failure_is_that_of_all_nodes() {
    let (_, text) = scenes().swap_remove(0);
    let scene = parsed(&text);
    let model = discretise(&scene).unwrap();
    let (problem, loading, times) = (&model.problem, &model.loading, scene.time.all());
    let settings = HistorySettings::new(problem, loading, Method::BN).unwrap().until(1, 1e-10);
    let settings = HistorySettings { halvings: 0, ..settings };
    let set = HistorySettings { working_set: Some((10..20).collect()), ..settings.clone() };
    let [all, some] = [&settings, &set].map(|settings| {
        history::run(problem, loading, &times, settings, LinearAlgebra::condensed().into(), &mut ()).unwrap()
    });
    assert_eq!((all.status, some.status), (Status::MaxIterations, Status::MaxIterations));
    assert_eq!(all.records.len(), some.records.len());
    assert_eq!(some.working_set.unwrap().last, problem.contacts());
}

/// Within reach are those that would be in their obstacle, loads included, and as many again.
#[test]
fn what_is_within_reach() {
    // Nodes on springs of 1 N/m, each in front of its stop.
    let n = 10;
    let stiffness = Symmetric::from_triplets(n, &(0..n).map(|i| (i, i, 1.0)).collect::<Vec<_>>()).unwrap();
    let c_n = Csr::from_rows(n, (0..n).map(|i| [(i, 1.0)])).unwrap();
    let problem = ContactProblem::new(Parts::new(stiffness, c_n)).unwrap();
    let gap: Vec<f64> = (0..n).map(|i| i as f64 - 0.5).collect();
    let loading = |force: f64| {
        let force = (0..n).map(|i| if i == 4 { force } else { 0.0 }).collect();
        Loading::new(vec![LoadCase::new(force, vec![[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]]).unwrap()], gap.clone())
            .unwrap()
    };
    let set = |loading: &Loading, times: &[f64]| within_reach(&problem, loading, times, 0.0);
    assert_eq!(set(&loading(0.0), &[1.0]), Some(vec![0, 1]));
    // Node 4 too, but not at these times.
    assert_eq!(set(&loading(5.0), &[1.0]), Some(vec![0, 1, 2, 4]));
    assert_eq!(set(&loading(5.0), &[2.0]), Some(vec![0, 1]));
    // Too many, and as many as the entries of the stiffness, which are as many as nodes, allow.
    assert_eq!(set(&Loading::new(Vec::new(), vec![-0.1; n]).unwrap(), &[1.0]), None);
    let spared = |affordable| within_reach(&problem, &loading(0.0), &[1.0], affordable);
    assert_eq!((spared(1.0), spared(2.0)), (Some(vec![0, 1, 2]), Some(vec![0, 1, 2, 3])));
    assert_eq!((spared(10.0), spared(f64::INFINITY)), (None, None));
    // A body that contact alone holds has them all.
    let parts = Parts { rigid_modes: None, ..problem.clone().into_parts() };
    let free = Symmetric::from_triplets(n, &[(0, 0, 1.0)]).unwrap();
    let free = ContactProblem::new(Parts { stiffness: free.into(), ..parts }).unwrap();
    assert_eq!(within_reach(&free, &loading(0.0), &[1.0], 0.0), None);
}

/// Through the door: chosen, told before and after.
#[test]
fn a_long_face_under_a_small_roller() {
    let obstacle = "{ kind = \"cylinder\", radius = 20.0, apex = [3.0, 1.0], approach = [[0, 0], [1, 1e-3], [2, 0]] }";
    let text = block("[10.0, 1.0]", "[700, 3]", 0.3, obstacle, "[time]\nend = 2.0\nincrements = 4\n");
    let scene = |solver: &str| parsed(&format!("{text}[solver]\nlinear = \"{solver}\"\n"));
    let whole = if cfg!(feature = "umfpack") { "umfpack" } else { "faer" };
    let [condensed, whole] = ["condensed", whole].map(scene);
    let run = Run::new(&condensed).unwrap();
    let first = run.working_set().unwrap().len();
    assert!(first < 350, "{first}");
    let mut recording = Recording::all();
    let report = run.solve(&mut recording).unwrap();
    assert_eq!(report.status, Status::Converged);
    assert_eq!(report.working_set, Some(WorkingSet { first, last: first, all: 701, grown: 0 }));
    let out_of_reach = |left_out: &&EliminatedUnknown| left_out.reason.contains("out of reach");
    let left_out: Vec<_> =
        report.left_out.iter().filter(out_of_reach).map(|nodes| (nodes.count, nodes.unknown)).collect();
    assert_eq!(left_out, [(701 - first, "p_n"), (701 - first, "p_t")]);
    let mut expected = Recording::all();
    let other = Run::new(&whole).unwrap();
    assert_eq!(other.working_set(), None);
    let other = other.solve(&mut expected).unwrap();
    assert_eq!(other.working_set, None);
    let states = |recording: &Recording| recording.increments.iter().map(|step| step.state.clone()).collect::<Vec<_>>();
    assert!(difference(&states(&expected), &states(&recording)) <= 1e-9);
}
