//! A method of one's own in the history loop, whole and condensed.

use crate::common::prelude::*;
use std::sync::Mutex;

/// BN, and a diary of the displacements that each increment has.
struct Diary {
    settings: HistorySettings,
    pages: Arc<Mutex<Vec<usize>>>,
}

impl Algorithm for Diary {
    fn start(&self, problem: &ContactProblem, loading: &Loading) -> Box<dyn IncrementSolver> {
        let pages = Arc::clone(&self.pages);
        around(self.settings.start(problem, loading), move |inner, task, linear, observe| {
            pages.lock().unwrap().push(task.increment.force.len());
            inner.solve(task, linear, observe)
        })
    }
}

#[test]
fn a_method_of_ones_own() {
    let scene = common::block(&["mesh.elements=[6,6]", "time.increments=4"]);
    let model = discretise(&scene).unwrap();
    let (problem, loading, times) = (&model.problem, &model.loading, scene.time.all());
    // Each increment is one task.
    let settings = HistorySettings { halvings: 0, ..HistorySettings::new(problem, loading, Method::BN).unwrap() };
    let known = history::run(problem, loading, &times, &settings, SystemSolver::default(), &mut ()).unwrap();
    let border = problem.contact_displacements().len();
    for (linear, n) in [(LinearAlgebra::default(), problem.displacements()), (LinearAlgebra::condensed(), border)] {
        let diary = Diary { settings: settings.clone(), pages: Arc::default() };
        let outcome = history::run_with(problem, loading, &times, &diary, &settings, linear.into(), &mut ()).unwrap();
        assert_eq!(outcome.status, Status::Converged);
        assert_eq!(*diary.pages.lock().unwrap(), vec![n; times.len()]);
        assert!(apart(&outcome.state.p_n, &known.state.p_n) <= 1e-9);
    }
}
