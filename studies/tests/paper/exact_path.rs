//! The exact path in time on every scene of both tables.

use std::collections::BTreeMap;

use stickslip::run::Run;
use stickslip::run::discretise;
use stickslip::solver::history::{HistoryMethod, HistoryOutcome, LinearAlgebra, Method, SolverChoice, Status};
use stickslip_studies::tables::{Case, PaperTable};

fn solve(table: PaperTable, case: &Case, method: impl Into<HistoryMethod>, linear: LinearAlgebra) -> HistoryOutcome {
    let scene = table.scene(case.contact_nodes, case.mu, case.increments).unwrap();
    let model = discretise(&scene).unwrap();
    let solver = SolverChoice { linear: Some(linear), ..SolverChoice::new(method) };
    Run::of(&model, scene.time.all(), solver).unwrap().history(&mut ()).unwrap()
}

/// The largest difference of contact forces, relative to the largest of them.
fn difference(a: &HistoryOutcome, b: &HistoryOutcome) -> f64 {
    let largest = |x: &[f64]| x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let of = |a: &[f64], b: &[f64]| largest(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>());
    of(&a.state.p_n, &b.state.p_n).max(of(&a.state.p_t, &b.state.p_t)) / largest(&b.state.p_n)
}

/// In all cells up to so many contact nodes every law holds to 1e-12 at every event, the number of increments changes nothing, and of
/// the increments of the default BN more are nearer to the path. Returns the number of cells.
fn every_law_at_every_event(most_nodes: usize) -> usize {
    let mut cells = 0;
    for table in [PaperTable::Punch, PaperTable::Block] {
        let mut scenes = BTreeMap::<(usize, u64), Vec<Case>>::new();
        for case in table.cases().into_iter().filter(|case| case.contact_nodes <= most_nodes) {
            scenes.entry((case.contact_nodes, case.mu.to_bits())).or_default().push(case);
        }
        for cases in scenes.values() {
            let what = format!("{table:?} n_c = {}, mu = {}", cases[0].contact_nodes, cases[0].mu);
            let paths: Vec<HistoryOutcome> = cases
                .iter()
                .map(|case| solve(table, case, HistoryMethod::ExactPath, LinearAlgebra::condensed()))
                .collect();
            let whole = (cases[0].contact_nodes <= 20)
                .then(|| solve(table, &cases[0], HistoryMethod::ExactPath, LinearAlgebra::default()));
            for path in paths.iter().chain(&whole) {
                let worst = path.records.iter().fold(0.0_f64, |m, record| m.max(record.kkt.worst().1));
                let rates: usize = path.records.iter().map(|record| record.iterations).sum();
                assert_eq!((path.status, worst <= 1e-12), (Status::Converged, true), "{what}: {worst:e}");
                // Of five nodes at mu = 0.8 it takes one more than three a node.
                assert!(rates <= 3 * cases[0].contact_nodes + 1, "{what}: {rates} rates");
                assert!(difference(path, &paths[0]) <= 1e-10, "{what}: {:e}", difference(path, &paths[0]));
            }
            cells += paths.len();
            let error =
                |case: &Case| difference(&solve(table, case, Method::BN, LinearAlgebra::condensed()), &paths[0]);
            let (few, many) = (error(&cases[0]), error(&cases[cases.len() - 1]));
            assert!(many <= few.max(1e-10), "{what}: {few:e}, {many:e}");
        }
    }
    cells
}

#[test]
fn coarse_cells() {
    assert_eq!(every_law_at_every_event(20), 45);
}

#[test]
#[ignore = "a minute"]
fn all_cells() {
    assert_eq!(every_law_at_every_event(usize::MAX), 96);
}
