//! What a companion run tells of increments, beside the exact path in time. doc/method/estimates.md has the figures, which `--nocapture` prints.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use stickslip::run::discretise;
use stickslip::run::report::CompanionEstimate;
use stickslip::run::{Recording, Run, increments_for};
use stickslip::scene::{Override, Scene};
use stickslip::solver::history::{HistoryMethod, LinearAlgebra, Status};

const PUNCH: &str = include_str!("../../data/scenes/punch.toml");
const BLOCK: &str = include_str!("../../data/scenes/block.toml");

/// A history of some stretches, each as long as the others.
struct History {
    name: &'static str,
    scene: Scene,
    stretches: usize,
}

fn history(name: &'static str, text: &str, stretches: usize, overrides: &[&str]) -> History {
    let overrides: Vec<Override> = overrides.iter().map(|text| text.parse().unwrap()).collect();
    let mut scene = Scene::parse("scene.toml", text, &overrides).unwrap();
    scene.solver.linear = Some(LinearAlgebra::condensed());
    History { name, scene, stretches }
}

fn punch(mu: &'static str, friction: &str) -> History {
    history(mu, PUNCH, 1, &[friction])
}

fn block(name: &'static str, friction: &str) -> History {
    history(name, BLOCK, 2, &["mesh.elements=[20,20]", "solver.setting=\"default\"", friction])
}

impl History {
    /// With so many increments in each stretch.
    fn with(&self, increments: usize) -> Scene {
        let count = (increments * self.stretches) as i64;
        let mut scene = self.scene.with(&[Override::value("time.increments", count)]).unwrap();
        scene.solver = self.scene.solver;
        scene
    }

    /// `p_t / √l` at the ends of all stretches, along the exact path.
    fn exact(&self) -> Vec<Vec<f64>> {
        let mut scene = self.with(1);
        scene.solver.method = HistoryMethod::EVENTS;
        self.ends(&scene, 1, false).0
    }

    /// The same by so many increments in each stretch, and what the companion tells.
    fn solved(&self, increments: usize, companion: bool) -> (Vec<Vec<f64>>, Option<CompanionEstimate>) {
        self.ends(&self.with(increments), increments, companion)
    }

    fn ends(&self, scene: &Scene, increments: usize, companion: bool) -> (Vec<Vec<f64>>, Option<CompanionEstimate>) {
        let run = Run::new(scene).unwrap();
        let run = if companion { run.with_companion() } else { run };
        let mut recording = Recording::of((1..=self.stretches).map(|k| k * increments));
        let report = run.solve(&mut recording).unwrap();
        assert_eq!(report.status, Status::Converged, "{}", report.explanation.reason);
        let weight = discretise(scene).unwrap().problem.weight().unwrap().to_vec();
        let forces = recording.states().map(|state| state.p_t.iter().zip(&weight).map(|(p, l)| p / l.sqrt()).collect());
        (forces.collect(), report.estimates.companion)
    }

    /// The true error with so many increments in each stretch, and the estimate.
    fn errors(&self, increments: usize, exact: &[Vec<f64>]) -> (f64, f64) {
        let (forces, companion) = self.solved(increments, true);
        (distance(&forces, exact), companion.unwrap().error.unwrap())
    }
}

/// The largest distance, relative to the largest of `exact`.
fn distance(forces: &[Vec<f64>], exact: &[Vec<f64>]) -> f64 {
    let size = |x: &mut dyn Iterator<Item = f64>| x.map(|x| x * x).sum::<f64>().sqrt();
    let largest = exact.iter().map(|p| size(&mut p.iter().copied())).fold(0.0, f64::max);
    let apart = forces.iter().zip(exact).map(|(p, q)| size(&mut p.iter().zip(q).map(|(p, q)| p - q)));
    apart.fold(0.0, f64::max) / largest
}

#[test]
fn companions_tell_what_increments_leave() {
    let histories = [
        punch("punch, mu = 0.2", "contact.friction=0.2"),
        punch("punch, mu = 0.4", "contact.friction=0.4"),
        punch("punch, mu = 0.8", "contact.friction=0.8"),
        block("block, mu = 0.8", "contact.friction=0.8"),
    ];
    for history in histories {
        let exact = history.exact();
        for increments in [2, 4, 8, 16, 32] {
            let (error, estimate) = history.errors(increments, &exact);
            println!(
                "{}: {increments:2} increments, {:5.2} % true, {:5.2} % estimated",
                history.name,
                100.0 * error,
                100.0 * estimate
            );
            if error > 0.01 {
                assert!(estimate > error / 3.0 && estimate < 3.0 * error, "{error} {estimate}");
            } else {
                assert!(estimate < 0.03, "{error} {estimate}");
            }
        }
    }
}

/// Every node that slips in this block went on slipping: any increments give the same.
#[test]
fn companions_find_nothing_where_nothing_is_left() {
    let history = block("block, mu = 0.1", "contact.friction=0.1");
    for increments in [1, 2, 4, 8] {
        let companion = history.solved(increments, true).1.unwrap();
        let error = companion.error.unwrap();
        assert!(error < 1e-9, "{error}");
        let expected = if increments < 4 { 4 * increments } else { increments / 2 };
        assert_eq!((companion.increments, companion.status), (expected, Status::Converged));
    }
    assert_eq!(block("no friction", "contact.friction=0.0").solved(4, true).1, None);
}

/// As many increments as leave the error that was asked for, and corners at their ends.
#[test]
fn increments_for_an_error() {
    for (history, asked) in [
        (punch("punch, mu = 0.4", "contact.friction=0.4"), 0.05),
        (punch("punch, mu = 0.8", "contact.friction=0.8"), 0.1),
        (block("block, mu = 0.8", "contact.friction=0.8"), 0.05),
        (block("block, mu = 0.1", "contact.friction=0.1"), 0.01),
    ] {
        let mut models = 0;
        let chosen = increments_for(&history.with(1), asked, |_| models += 1, &mut ()).unwrap();
        assert_eq!((chosen.asked, chosen.tried, models), (asked, 8 * history.stretches, 1));
        assert_eq!(chosen.increments % history.stretches, 0);
        let exact = history.exact();
        let (forces, _) = history.solved(chosen.increments / history.stretches, false);
        let error = distance(&forces, &exact);
        println!("{}: {} increments for {asked}, {error:.4} true", history.name, chosen.increments);
        assert!(error < asked, "{error}");
        // Not a multiple of what is needed.
        let needed = 1.3 * chosen.error.unwrap() / asked;
        assert!(chosen.increments as f64 <= chosen.tried as f64 * needed.max(1.0) + history.stretches as f64);
    }
}
