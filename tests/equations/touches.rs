//! A node that first touches within an increment: its motion before the touch is no slip.

use crate::common::prelude::*;

/// The gap of the node, m. Its springs have 2 N/m in each direction.
const GAP: f64 = 0.4;

/// A node on springs in space, with μ = 3.
fn problem() -> ContactProblem {
    let stiffness = Symmetric::from_triplets(3, &[(0, 0, 2.0), (1, 1, 2.0), (2, 2, 2.0)]).unwrap();
    let map = |column| Csr::from_rows(3, [[(column, 1.0)]]).unwrap();
    let parts = Parts::new(stiffness, map(0));
    ContactProblem::new(Parts { c_t: map(1), c_o: map(2), mu: vec![3.0], ..parts }).unwrap()
}

fn run(method: Method, loading: &Loading, times: &[f64], halvings: Option<u32>) -> HistoryOutcome {
    let problem = problem();
    let mut settings = HistorySettings::new(&problem, loading, method).unwrap();
    settings.halvings = halvings.unwrap_or(settings.halvings);
    let outcome = history::run(&problem, loading, times, &settings, SystemSolver::default(), &mut ()).unwrap();
    assert_eq!(outcome.status, Status::Converged, "{method:?}");
    outcome
}

/// A load that grows to `force`, N.
fn load(force: [f64; 3]) -> LoadCase {
    LoadCase::new(force.to_vec(), vec![[0.0, 0.0], [1.0, 1.0]]).unwrap()
}

/// The load of 1 N presses the node on the obstacle after 0.8 s, where -1 N along it has moved the node by -0.4 m. It
/// sticks there, and friction takes the last 0.2 N. As one increment, it would slip from the start, with 3 times 0.2 N.
#[test]
fn a_node_sticks_where_it_touches() {
    for method in [Method::BN, Method::Ip] {
        for along in [[-1.0, 0.0], [0.6, 0.8]] {
            let loading = Loading::new(vec![load([1.0, along[0], along[1]])], vec![GAP]).unwrap();
            // After 0.795 s, what is left of the motion may set friction wrong by 0.005 N, less than a twentieth of 0.2 N.
            for (times, left) in [(&[1.0][..], 0.0), (&[0.5, 1.0], 0.0), (&[0.3, 0.795, 1.0], 0.005)] {
                let outcome = run(method, &loading, times, None);
                let (p_t, p_o) = (outcome.state.p_t[0], outcome.state.p_o[0]);
                assert!((outcome.state.p_n[0] - 0.2).abs() < 1e-9, "{method:?} {times:?}");
                let error = (p_t - 0.2 * along[0]).hypot(p_o - 0.2 * along[1]);
                assert!(error < left + 1e-6, "{method:?} {times:?}: {p_t} {p_o}");
                let parts: usize = outcome.records.iter().map(|record| record.parts).sum();
                assert_eq!(parts, times.len() + usize::from(left == 0.0), "{method:?} {times:?}");
            }
        }
    }
    let loading = Loading::new(vec![load([1.0, -1.0, 0.0])], vec![GAP]).unwrap();
    let whole = run(Method::BN, &loading, &[1.0], Some(0));
    assert!((whole.state.p_t[0] + 0.6).abs() < 1e-12 && whole.records[0].parts == 1, "{}", whole.state.p_t[0]);
}

/// An obstacle that comes from 0.4 m to 0 m, and moves by 3 m along the node on the way, drags it only after it touches.
#[test]
fn an_obstacle_drags_what_it_touches() {
    let comes = Motion::new(0..1, vec![-1.0], vec![[0.0; 2]], vec![[0.0, 0.0], [1.0, 0.5]]).unwrap();
    let slides = Motion::new(0..1, vec![0.0], vec![[0.1, 0.0]], vec![[0.0, 0.0], [1.0, 1.0]]).unwrap();
    let loading = Loading::new(Vec::new(), vec![GAP]).unwrap().with_motions(vec![comes, slides], Vec::new()).unwrap();
    for method in [Method::BN, Method::Ip] {
        // It touches after 0.8 s; the last fifth of the drift, 0.02 m, is far below the limit of 3 times 0.2 N.
        let outcome = run(method, &loading, &[1.0], None);
        assert!((outcome.state.p_n[0] - 0.2).abs() < 1e-9, "{method:?}");
        assert!((outcome.state.p_t[0] + 0.04).abs() < 1e-6, "{method:?}: {}", outcome.state.p_t[0]);
    }
}

/// Nothing is divided where nodes do not move along the obstacle before they touch, or where the load is there at once.
#[test]
fn what_does_not_matter_is_not_divided() {
    let straight = Loading::new(vec![load([1.0, 0.0, 0.0])], vec![GAP]).unwrap();
    let at_once = Loading::new(vec![LoadCase::new(vec![1.0, -1.0, 0.0], Vec::new()).unwrap()], vec![GAP]).unwrap();
    for (name, loading) in [("straight", straight), ("at once", at_once)] {
        assert_eq!(run(Method::BN, &loading, &[1.0], None).records[0].parts, 1, "{name}");
    }
}
