//! An increment of BN in the default setting starts on the tangent of the history: fewer iterations, the same answers.

use crate::common::prelude::*;
use crate::common::{block, scene};

/// The history of a scene by `method`, whose increments are not divided where nodes first touch.
fn history(scene: &Scene, method: Method, linear: LinearAlgebra) -> (HistoryOutcome, Keep) {
    let (model, mut keep, times) = (discretise(scene).unwrap(), Keep::default(), scene.time.all());
    let solver = SolverChoice { method: method.into(), linear: Some(linear), ..scene.solver };
    let (problem, loading) = (&model.problem, &model.loading);
    let settings = HistorySettings { halvings: 0, ..solver.settings(problem, loading).unwrap() };
    let outcome = solver.solve(problem, loading, &times, &settings, linear.into(), &mut keep).unwrap();
    assert_eq!(outcome.status, Status::Converged, "{method}, {linear}");
    (outcome, keep)
}

fn iterations(outcome: &HistoryOutcome) -> usize {
    outcome.records.iter().map(|record| record.iterations).sum()
}

/// BN, whole and condensed, takes at most so many iterations to the states of the interior point method.
fn agrees_within(scene: &Scene, most: usize) -> HistoryOutcome {
    let (_, expected) = history(scene, Method::Ip, LinearAlgebra::condensed());
    let [(whole, whole_states), (condensed, states)] = both().map(|linear| history(scene, Method::BN, linear));
    for (outcome, keep) in [(&whole, &whole_states), (&condensed, &states)] {
        let apart = difference(&expected.states, &keep.states);
        assert!(apart < 1e-8, "{apart:e}");
        assert!(iterations(outcome) <= most, "{}", iterations(outcome));
    }
    assert_eq!(iterations(&whole), iterations(&condensed));
    condensed
}

/// From the last state the same history takes 129 iterations; on the tangent 28, in 22 of its 100 increments.
#[test]
fn increments_without_a_change_of_status_take_no_iteration() {
    let scene = block(&["mesh.elements=[20,20]", "time.increments=100", "solver.setting='default'"]);
    let outcome = agrees_within(&scene, 32);
    let free = outcome.records.iter().filter(|record| record.iterations == 0).count();
    assert!(free >= 78, "{free}");
    // The factors of an increment serve the start of the next, but for the one in which the first nodes touch: to estimate their friction takes
    // factors of its own.
    assert!(outcome.linear.factorizations <= iterations(&outcome) + 3, "{}", outcome.linear.factorizations);
}

/// Directions of slip turn; from the last state, or going on as before, 36.
#[test]
fn slip_that_turns_goes_on_turning() {
    // One more than with errors relative to the loads.
    agrees_within(&scene("cube.toml", &["mesh.elements=[6,6,6]"]), 33);
}

/// Where friction changes, the last matrix is not that of the new data, and no tangent is taken.
#[test]
fn other_friction_has_no_tangent() {
    let rising = "contact[0].friction_history=[[0,0.5],[1,1],[2,0.25]]";
    let overrides = ["mesh.elements=[8,8]", "time.increments=20", "solver.setting='default'"];
    let steady = agrees_within(&block(&overrides), usize::MAX);
    let changing = agrees_within(&block(&[&overrides[..], &[rising]].concat()), usize::MAX);
    assert!(steady.records.iter().any(|record| record.iterations == 0));
    assert!(changing.records.iter().all(|record| record.iterations > 0 || record.contact.open == 8));
}
