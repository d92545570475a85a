//! The exact path in time: sums found by another program, laws at every event, increments that converge to it, and the verdicts
//! where it ends.

use crate::common::prelude::*;
use stickslip::solver::NodeStatus;
use stickslip::solver::history::HistoryMethod;

fn block(n: usize, mu: f64) -> Model {
    model_with(BLOCK, &[&format!("mesh.elements=[{n},{n}]"), &format!("contact.friction={mu}")])
}

fn solve(
    problem: &ContactProblem,
    loading: &Loading,
    times: &[f64],
    method: impl Into<HistoryMethod>,
    linear: LinearAlgebra,
) -> HistoryOutcome {
    let solver = SolverChoice::new(method);
    let settings = solver.settings(problem, loading).unwrap();
    solver.solve(problem, loading, times, &settings, linear.into(), &mut ()).unwrap()
}

fn exact(model: &Model, times: &[f64], linear: LinearAlgebra) -> HistoryOutcome {
    solve(&model.problem, &model.loading, times, HistoryMethod::ExactPath, linear)
}

fn worst(outcome: &HistoryOutcome) -> f64 {
    outcome.records.iter().fold(0.0_f64, |m, record| m.max(record.kkt.worst().1))
}

fn rates(outcome: &HistoryOutcome) -> usize {
    outcome.records.iter().map(|record| record.iterations).sum()
}

/// Keeps all checkpoints, as bytes.
struct Kept(Vec<Vec<u8>>);

impl Observer for Kept {
    fn checkpoint_offered(&mut self, here: &dyn Fn() -> Checkpoint) {
        self.0.push(here().to_bytes().unwrap());
    }
}

/// From each of its checkpoints a history goes on to the same end.
fn taken_up(problem: &ContactProblem, loading: &Loading, times: &[f64], method: HistoryMethod, linear: LinearAlgebra) {
    let solver = SolverChoice::new(method);
    let settings = solver.settings(problem, loading).unwrap();
    let mut kept = Kept(Vec::new());
    let run = |settings: &HistorySettings, observer: &mut dyn Observer| {
        solver.solve(problem, loading, times, settings, linear.into(), observer).unwrap()
    };
    let whole = run(&settings, &mut kept);
    assert_eq!(kept.0.len(), times.len());
    for bytes in &kept.0 {
        let from = Some(Checkpoint::from_bytes(bytes).unwrap());
        let rest = run(&HistorySettings { from, ..settings.clone() }, &mut ());
        assert_eq!((rest.status, &rest.state, rest.tally), (whole.status, &whole.state, whole.tally));
        assert_eq!(rest.event_count, whole.event_count);
    }
}

/// The largest difference of contact forces, relative to the largest of them.
fn difference(a: &HistoryOutcome, b: &HistoryOutcome) -> f64 {
    let of = |a: &[f64], b: &[f64]| largest(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>());
    let (a, b) = (&a.state, &b.state);
    of(&a.p_n, &b.p_n).max(of(&a.p_t, &b.p_t)) / largest(&a.p_n)
}

/// Where a body slides as a whole the rates of all forces are rounding, and in a slender one rounding would decide statuses.
/// A strip touches while its forces are small: the rounding of its gaps would be a penetration, of 1e-10 in the thinner one.
#[test]
fn rounding_does_not_decide() {
    let wedge = include_str!("../../data/scenes/wedge.toml");
    let strip = include_str!("../../data/scenes/strip.toml");
    let thick = model_with(strip, &["mesh.elements=[60,2]"]);
    let thin = model_with(strip, &["mesh.elements=[60,2]", "mesh.size=[20,0.1]"]);
    for (model, end) in [(model_with(wedge, &[]), 2.0), (thick, 3.0), (thin, 3.0)] {
        let times = equal_increments(end, 4);
        let [whole, condensed] = both().map(|linear| exact(&model, &times, linear));
        for outcome in [&whole, &condensed] {
            assert_eq!(outcome.status, Status::Converged);
            // Relative to the contact forces, which are smaller than the loads of the strip.
            assert!(worst(outcome) <= 1e-11, "{:e}", worst(outcome));
        }
        assert!(difference(&whole, &condensed) < 1e-9, "{:e}", difference(&whole, &condensed));
    }
}

/// An obstacle comes to a body without loads, or with small ones: at its first touch there are no contact forces yet, and the
/// rounding of its way is no penetration.
#[test]
fn the_first_touch_of_an_obstacle_is_no_penetration() {
    for (k, load) in (1..40).flat_map(|k| [(k, 0.0), (k, 1e-6)]) {
        let gap = 0.01 * f64::from(k).sqrt();
        let force = LoadCase::new(vec![0.0, -load], vec![[0.0, 0.0], [0.2, 1.0]]).unwrap();
        let history = vec![[0.0, 0.0], [1.0 / 3.0, -gap - 0.001], [2.0, -gap - 0.01]];
        let motion = Motion::new(0..1, vec![1.0], vec![[0.3, 0.0]], history).unwrap();
        let loading = Loading::new(vec![force], vec![gap]).unwrap().with_motions(vec![motion], Vec::new()).unwrap();
        for linear in both() {
            let outcome = solve(&node(2.0, 0.5, 0.4), &loading, &[1.0, 2.0], HistoryMethod::ExactPath, linear);
            assert_eq!((outcome.status, worst(&outcome) < 1e-12), (Status::Converged, true), "{k} {load} {outcome:?}");
        }
    }
}

/// An obstacle touches a body without loads exactly at the end of an increment, or where its way ends.
#[test]
fn a_touch_at_the_end_of_an_increment_is_no_penetration() {
    let body = "mesh = { kind = \"block\", size = [1, 1], elements = [8, 6] }\n\
                material = { young = 1e9, poisson = 0.3 }\n\
                support = [{ boundary = \"bottom\", fix = [\"x\", \"y\"] }]\n\
                contact = [{ boundary = \"top\", friction = 0.5, obstacle = OBSTACLE }]\n\
                time = { end = 2, increments = 8 }\n";
    for way in ["[[0, -1e-4], [1, 1e-4]]", "[[0, -1e-4], [1, 0], [2, 0]]"] {
        for form in ["kind = \"formula\", formula = \"3e-5 * (1 - cos(20 * x))\"", "kind = \"plane\""] {
            let there = format!("{{ {form}, approach = {way} }}");
            let model = model_with(&body.replace("OBSTACLE", &there), &[]);
            for linear in both() {
                for times in [equal_increments(2.0, 8), vec![0.5, 2.0], vec![1.0, 2.0]] {
                    let outcome = exact(&model, &times, linear);
                    assert_eq!(outcome.status, Status::Converged, "{there}");
                    assert!(worst(&outcome) <= 1e-11, "{there}: {:e}", worst(&outcome));
                }
            }
        }
    }
}

/// An obstacle that is in the body from the start comes in no time, with events on the way, and is judged when it is there.
#[test]
fn interference_from_the_start_is_judged_when_it_is_there() {
    let bare = ["mesh.elements=[12,6]", "load[0].traction=[0,0]", "load[1].traction=[0,0]"];
    let there = "contact.obstacle={kind=\"cylinder\",radius=9,apex=[0.4,1e-4],approach=[[0,0],[2,-5e-5]]}";
    let model = model_with(BLOCK, &[&bare[..], &[there]].concat());
    let [whole, condensed] = both().map(|linear| exact(&model, &[1.0, 2.0], linear));
    for outcome in [&whole, &condensed] {
        assert_eq!(outcome.status, Status::Converged);
        assert!(worst(outcome) <= 1e-12, "{:e}", worst(outcome));
        // A part of its own.
        assert_eq!(outcome.records[0].part_ends.first(), Some(&0.0));
    }
    assert!(difference(&whole, &condensed) < 1e-10, "{:e}", difference(&whole, &condensed));
}

/// Sums of contact forces at the end (MN), by a prototype that follows the path with a dense solve for each set of statuses.
#[test]
fn sums_are_those_of_another_program() {
    let forms = both();
    for (model, times, sum_p_n, sum_p_t) in [
        (block(5, 0.4), vec![1.0, 2.0], 5.302_096, 1.268_765),
        (block(20, 0.8), vec![1.0, 2.0], 5.284_059, 0.811_258),
        (block(50, 0.4), vec![1.0, 2.0], 5.426_644, 1.180_136),
        (model_with(PUNCH, &[]), vec![1.0], 5.330_137, -1.023_347),
    ] {
        let [whole, condensed] = forms.map(|linear| exact(&model, &times, linear));
        for outcome in [&whole, &condensed] {
            assert_eq!(outcome.status, Status::Converged);
            assert!(worst(outcome) <= 1e-12, "{:e}", worst(outcome));
            let sum = |p: &[f64]| 1e-6 * p.iter().sum::<f64>();
            let (p_n, p_t) = (sum(&outcome.state.p_n), sum(&outcome.state.p_t));
            assert!((p_n - sum_p_n).abs() < 1e-6 && (p_t - sum_p_t).abs() < 1e-6, "{p_n} {p_t}");
            let nodes = model.problem.contacts();
            assert!(rates(outcome) <= 3 * nodes, "{} rates for {nodes} nodes", rates(outcome));
        }
        assert!(difference(&whole, &condensed) < 1e-10, "{:e}", difference(&whole, &condensed));
        let of = |outcome: &HistoryOutcome| outcome.events.iter().map(|e| (e.node, e.from, e.to)).collect::<Vec<_>>();
        assert_eq!(of(&whole), of(&condensed));
        // One factorisation for each set of statuses, on one analysis.
        assert_eq!((whole.linear.analyses, whole.linear.factorizations), (1, rates(&whole)));
        let work: [f64; 2] = [&whole, &condensed].map(|o| o.records.iter().map(|r| r.friction_work).sum());
        assert!((work[0] - work[1]).abs() <= 1e-10 * work[0], "{work:?}");
    }
}

/// Where the path is looked at changes nothing.
#[test]
fn increments_do_not_matter() {
    let model = block(10, 0.8);
    let once = exact(&model, &[2.0], LinearAlgebra::condensed());
    let often = exact(&model, &equal_increments(2.0, 37), LinearAlgebra::condensed());
    assert_eq!((once.status, often.status, often.records.len()), (Status::Converged, Status::Converged, 37));
    assert!(difference(&once, &often) < 1e-12);
    let work = |outcome: &HistoryOutcome| outcome.records.iter().map(|record| record.friction_work).sum::<f64>();
    assert!((work(&once) - work(&often)).abs() < 1e-12 * work(&once));
    let changes = |outcome: &HistoryOutcome| outcome.events.iter().map(|e| (e.node, e.from, e.to)).collect::<Vec<_>>();
    assert_eq!(changes(&once), changes(&often));
}

/// Backward Euler comes to the exact path, at first order over the whole range.
#[test]
fn increments_converge_to_the_path() {
    let model = block(10, 0.8);
    let path = exact(&model, &[1.0, 2.0], LinearAlgebra::condensed());
    let error = |count: usize| {
        let times = equal_increments(2.0, 2 * count);
        let outcome = solve(&model.problem, &model.loading, &times, Method::BN, LinearAlgebra::condensed());
        assert_eq!(outcome.status, Status::Converged);
        let work = |outcome: &HistoryOutcome| outcome.records.iter().map(|record| record.friction_work).sum::<f64>();
        (difference(&path, &outcome), (work(&outcome) - work(&path)).abs() / work(&path))
    };
    let (coarse, fine) = (error(20), error(1280));
    let order = |coarse: f64, fine: f64| (coarse / fine).log2() / 64.0_f64.log2();
    let orders = [order(coarse.0, fine.0), order(coarse.1, fine.1)];
    assert!(orders.iter().all(|order| (0.7..1.4).contains(order)), "{orders:?} {coarse:?} {fine:?}");
}

/// A block with gaps, friction and histories at random.
fn random_problem(random: &mut Random) -> (ContactProblem, Loading, f64) {
    let n = 3 + (random.next() * 9.0) as usize;
    let Model { problem, loading, .. } = block(n, 0.5);
    let contacts = problem.contacts();
    let largest_mu = 1.6 * random.next();
    let smooth = random.next() < 0.3;
    let mut mu: Vec<f64> = (0..contacts).map(|_| largest_mu * random.next()).collect();
    if smooth {
        mu[0] = 0.0;
    }
    let slope = 2e-5 * random.sign();
    let gap: Vec<f64> = match (random.next() * 4.0) as usize {
        0 => vec![0.0; contacts],
        1 => (0..contacts).map(|i| (slope * i as f64 / contacts as f64).max(0.0)).collect(),
        2 => (0..contacts).map(|_| 2e-5 * random.next()).collect(),
        _ => vec![1e-5; contacts],
    };
    let segments = 2 + (random.next() * 7.0) as usize;
    let mut history = |size: f64| {
        let points = (1..=segments).map(|k| [k as f64, size * random.sign()]);
        [[0.0, 0.0]].into_iter().chain(points).collect::<Vec<_>>()
    };
    let cases =
        loading.cases().iter().map(|case| LoadCase::new(case.force().to_vec(), history(1.5)).unwrap()).collect();
    let (towards, along) = (history(1e-5), history(1e-5));
    let nodes = 0..contacts;
    let motion = |gap: f64, drift: f64, history| {
        Motion::new(nodes.clone(), vec![gap; contacts], vec![[drift, 0.0]; contacts], history).unwrap()
    };
    let motions = vec![motion(-1.0, 0.0, towards), motion(0.0, 1.0, along)];
    let loading = Loading::new(cases, gap).unwrap().with_motions(motions, Vec::new()).unwrap();
    let problem = ContactProblem::new(Parts { mu, ..problem.into_parts() }).unwrap();
    (problem, loading, segments as f64)
}

fn random_paths(seeds: std::ops::Range<u64>) {
    let mut failed = Vec::new();
    for seed in seeds {
        let (problem, loading, end) = random_problem(&mut Random(seed));
        let outcome = solve(&problem, &loading, &[end], HistoryMethod::ExactPath, LinearAlgebra::condensed());
        if outcome.status != Status::Converged || worst(&outcome) > 1e-12 {
            failed.push((seed, outcome.status, outcome.reached, worst(&outcome)));
        }
    }
    assert!(failed.is_empty(), "{} failed: {failed:?}", failed.len());
}

/// Loads and an obstacle that come, go and turn.
#[test]
fn every_law_at_every_event_of_random_paths() {
    random_paths(0..60);
}

/// `cargo test --release --test equations -- --ignored events::a_thousand`.
#[test]
#[ignore = "minutes"]
fn a_thousand_random_paths() {
    random_paths(1000..2000);
}

/// Fifty cycles of the horizontal load: no error adds up, and each cycle after the first ones is the one before.
#[test]
fn cycles_come_to_a_limit() {
    let points: Vec<String> =
        (1..=100).map(|k| format!("[{},{}]", k + 1, if k % 2 == 0 { 1.0 } else { -0.5 })).collect();
    let history = format!("load[1].history=[[0,0],[1,1],{}]", points.join(","));
    let model =
        model_with(BLOCK, &["mesh.elements=[10,10]", "load[0].history=[[0,0],[1,1]]", &history, "time.end=101"]);
    let times: Vec<f64> = (1..=50).map(|k| 1.0 + 2.0 * f64::from(k)).collect();
    let outcome = exact(&model, &times, LinearAlgebra::condensed());
    assert_eq!(outcome.status, Status::Converged);
    assert!(worst(&outcome) <= 1e-12, "{:e}", worst(&outcome));
    let [before, last] = [48, 49].map(|k| outcome.records[k].friction_work);
    assert!(last > 0.0 && (before - last).abs() <= 1e-12 * last, "{before} {last}");
}

/// A node on the springs `[[k_tt, k_tn], [k_tn, 2]]` (N/m), in front of a plane without a gap.
fn node(k_tt: f64, k_tn: f64, mu: f64) -> ContactProblem {
    let stiffness = Symmetric::from_triplets(2, &[(0, 0, k_tt), (1, 0, k_tn), (1, 1, 2.0)]).unwrap();
    let c_n = Csr::from_rows(2, [[(1, 1.0)]]).unwrap();
    let c_t = Csr::from_rows(2, [[(0, 1.0)]]).unwrap();
    ContactProblem::new(Parts { c_t, mu: vec![mu], ..Parts::new(stiffness, c_n) }).unwrap()
}

fn loads(points: &[(f64, [f64; 2])]) -> Loading {
    let along = |k: usize| {
        let history = points.iter().map(|(time, force)| [*time, force[k]]).collect();
        LoadCase::new([0, 1].map(|j| f64::from(u8::from(j == k))).to_vec(), history).unwrap()
    };
    Loading::new(vec![along(0), along(1)], vec![0.0]).unwrap()
}

/// With `k_tn > 0` and slip towards it the critical friction is `k_tt/k_tn`; above it the same load is followed by sticking, by
/// slipping and by parting. The path takes one of them, and the laws hold on it.
#[test]
fn of_three_continuations_one_is_taken() {
    for mu in [0.5, 3.0] {
        let (problem, loading) = (node(2.0, 1.5, mu), loads(&[(0.0, [0.0; 2]), (1.0, [1.0, 1.0])]));
        for linear in both() {
            let outcome = solve(&problem, &loading, &[1.0], HistoryMethod::ExactPath, linear);
            assert_eq!((outcome.status, worst(&outcome) < 1e-14), (Status::Converged, true), "{mu} {linear}");
        }
    }
}

/// Pressed while it sticks, then unloaded along the normal: where friction is above `k_tt/k_tn` the node can neither stick, for its
/// friction would leave the cone, nor slip or part, for that would draw it back. The path ends at the load at which the cone is
/// reached.
#[test]
fn a_lost_continuation_is_told_with_its_load() {
    // Stuck at 0, p = f. On the border of the cone p_t = -mu p_n slip needs w_t' < 0 with (2 + 1.5 mu) w_t' = f_t' + mu f_n', and
    // on the other one (2 - 1.5 mu) w_t' = f_t' - mu f_n' of either sign.
    let mu = 2.0;
    let problem = node(2.0, 1.5, mu);
    let loading = loads(&[(0.0, [0.0; 2]), (1.0, [0.0, 1.0]), (2.0, [4.0, 1.0])]);
    for linear in both() {
        let outcome = solve(&problem, &loading, &[1.0, 2.0], HistoryMethod::ExactPath, linear);
        assert_eq!(outcome.status, Status::NoContinuation, "{linear}");
        // f_t = mu f_n at half of the second second.
        let lost = outcome.lost.unwrap();
        assert!(
            (outcome.reached - 1.5).abs() < 1e-12 && (lost.time - 1.5).abs() < 1e-12 && lost.certain,
            "{outcome:?}"
        );
        assert_eq!(outcome.records.len(), 2);
    }
    // With less friction it slips on.
    let outcome =
        solve(&node(2.0, 1.5, 1.0), &loading, &[1.0, 2.0], HistoryMethod::ExactPath, LinearAlgebra::default());
    assert_eq!(outcome.status, Status::Converged);
    assert!(outcome.events.iter().any(|event| event.to == NodeStatus::Forward));
}

/// A path that is taken up at the end of an increment goes on as the whole one.
#[test]
fn a_path_is_taken_up_where_it_rested() {
    let problem = node(2.0, 1.5, 1.0);
    let loading = loads(&[(0.0, [0.0; 2]), (1.0, [0.0, 1.0]), (2.0, [4.0, 1.0]), (3.0, [0.0, 3.0])]);
    for linear in [LinearAlgebra::default(), LinearAlgebra::condensed()] {
        for times in [vec![1.0, 2.0, 3.0], vec![0.7, 1.9, 2.2, 3.0]] {
            taken_up(&problem, &loading, &times, HistoryMethod::ExactPath, linear);
        }
    }
}

/// Nothing but friction holds the node along the plane: it sticks until the cone is reached, and then no rates are in equilibrium.
#[test]
fn a_body_that_slides_freely_is_lost_when_friction_gives_way() {
    let problem = node(0.0, 0.0, 0.5);
    let loading = loads(&[(0.0, [0.0; 2]), (1.0, [0.0, 2.0]), (2.0, [4.0, 2.0])]);
    for linear in both() {
        let outcome = solve(&problem, &loading, &[1.0, 2.0], HistoryMethod::ExactPath, linear);
        assert_eq!(outcome.status, Status::Slips, "{linear}");
        assert!((outcome.reached - 1.25).abs() < 1e-12, "{}", outcome.reached);
    }
}

/// What the path does not know it does not try.
#[test]
fn nodes_that_slide_in_a_plane_are_refused() {
    let cube = CUBE;
    let model = model_with(cube, &["mesh.elements=[2,2,2]"]);
    assert_eq!(exact(&model, &[1.0], LinearAlgebra::default()).status, Status::Unsupported);
}

/// A block stands on one corner, in front of a slanting floor or above it, and nothing else holds it: it first comes to rest on two, as a rigid
/// body does under loads however small, and then the path has the forces of an increment under loads that stay.
#[test]
fn a_body_that_contact_alone_holds_comes_to_rest_first() {
    let standing = scene! { r#"
[mesh] kind = "block", size = [1.0, 1.0], elements = [2, 2]
[material] young = 1e9, poisson = 0.3
[[contact]] boundary = "bottom", friction = 0.5
obstacle = { kind = "formula", formula = "1e-3 * x", normal = [0, -1] }
[[load]] boundary = "top", traction = [2e4, -1e5], history = [[0, 1]]
[time] end = 1.0, increments = 1
"# };
    for gap in ["1e-3 * x", "1e-3 * (1 + x)"] {
        let model = model_with(&standing, &[&format!("contact.obstacle.formula=\"{gap}\"")]);
        let by_increment = solve(&model.problem, &model.loading, &[1.0], Method::BN, LinearAlgebra::default()).state;
        for linear in both() {
            let outcome = exact(&model, &[1.0], linear);
            assert_eq!(outcome.status, Status::Converged, "{gap} {linear}");
            for (path, increment) in [(&outcome.state.p_n, &by_increment.p_n), (&outcome.state.p_t, &by_increment.p_t)]
            {
                let apart = path.iter().zip(increment).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
                assert!(apart < 1.0, "{gap} {linear}: {path:?} {increment:?}");
            }
        }
    }
}

/// A body that nothing holds, as it is or along smooth obstacles: all methods and linear algebras name the motion.
#[test]
fn a_body_that_nothing_holds_is_named() {
    let contact = BLOCK.find("[[contact]]").unwrap();
    let load = BLOCK.find("[[load]]").unwrap();
    let bare = [&BLOCK[..contact], &BLOCK[load..]].concat();
    let smooth = BLOCK.replace("friction = 0.4", "friction = 0.0");
    for (text, fix) in [(bare, "x"), (smooth, "y")] {
        let text = text.replace("fix = [\"x\", \"y\"]", &format!("fix = [\"{fix}\"]"));
        let model = model_with(&text, &["mesh.elements=[4,4]"]);
        for method in [HistoryMethod::ExactPath, Method::BN.into(), Method::Ip.into()] {
            for linear in both() {
                let outcome = solve(&model.problem, &model.loading, &[1.0], method, linear);
                assert_eq!(outcome.status, Status::Singular, "{fix} {method:?} {linear}");
                assert!(outcome.free_motion.is_some(), "{fix} {method:?} {linear}");
            }
        }
    }
}
