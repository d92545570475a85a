//! Coulomb's disk: friction in two tangential directions.
#![allow(clippy::unwrap_used)]

mod common;

use common::random::{self, Random};
use stickslip::history::{self, HistoryOutcome, HistorySettings, Status};
use stickslip::linear::{Direct, Umfpack};
use stickslip::loading::Loading;
use stickslip::problem::ContactProblem;

const TIMES: [f64; 8] = [0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0];

fn scaling(problem: &ContactProblem, loading: &Loading) -> stickslip::units::Scaling {
    problem.scaling(loading.largest_force(), loading.largest_interference())
}

fn run(problem: &ContactProblem, loading: &Loading, times: &[f64], settings: &HistorySettings) -> HistoryOutcome {
    let mut linear = Direct::new(Box::new(Umfpack::default()));
    history::run(problem, loading, times, settings, &mut linear, &mut ()).unwrap()
}

#[test]
fn random_problems() {
    for coupling in [0.1, 0.3, 1.0] {
        for mu in [0.1, 0.4, 0.8, 2.0] {
            let (mut its, mut bts, mut incs, mut bad, mut facts, mut parts) = (0, 0, 0, 0, 0, 0);
            let (mut pits, mut pbts, mut pincs, mut pbad) = (0, 0, 0, 0);
            let mut most = 0;
            for seed in 0..40_u64 {
                let mut random = Random(seed * 7919 + 3);
                let contacts = 1 + (30.0 * random.next()) as usize;
                let (problem, loading) = random::problem(&mut random, contacts, mu, coupling);
                let s = scaling(&problem, &loading);
                let settings = HistorySettings { halvings: 0, ..HistorySettings::bn(&problem, s, 100, 1e-10) };
                let o = run(&problem, &loading, &TIMES, &settings);
                facts += o.linear.factorizations;
                for r in &o.records {
                    incs += 1;
                    its += r.iterations;
                    bts += r.backtracks;
                    parts += r.parts;
                    most = most.max(r.iterations);
                }
                if o.status != Status::Converged {
                    bad += 1;
                    println!("seed {seed} n_c {contacts} mu {mu}: {:?} {:?}", o.status, o.violation);
                }
                let o = run(&problem, &loading, &TIMES, &HistorySettings::paper_bn(&problem, s, 100, 1e-6));
                for r in &o.records {
                    pincs += 1;
                    pits += r.iterations;
                    pbts += r.backtracks;
                }
                if o.status != Status::Converged {
                    pbad += 1;
                    println!("   paper seed {seed} n_c {contacts} mu {mu}: {:?} {:?}", o.status, o.violation);
                }
            }
            println!(
                "coupling {coupling} mu {mu}: bn {:.2} its {:.2} bts of {incs} incs, parts {parts}, most {most}, facts {:.2}, bad {bad}; paper {:.2} {:.2} of {pincs}, bad {pbad}",
                its as f64 / incs as f64, bts as f64 / incs as f64, facts as f64 / incs as f64, pits as f64 / pincs as f64, pbts as f64 / pincs as f64
            );
        }
    }
}
