//! Contact of bodies of revolution. Figures without a closed form are those of a program that shares nothing with this one.
#![allow(clippy::unwrap_used)]

use crate::common::{Keep, difference};
use stickslip::contact::ContactNode;
use stickslip::history::{HistoryOutcome, LinearAlgebra, Method, Observer, Solver, Status};
use stickslip::linear::{SparseCholesky, SparseLu};
use stickslip::model::Model;
use stickslip::problem::State;
use stickslip::run::Run;
use stickslip::scene::Scene;

/// A cylinder of radius and height 1 on its base under a parabola.
fn cylinder(cells: &str, n: usize, element: &str, poisson: f64, friction: f64) -> Scene {
    let text = format!(
        "[mesh]\nkind = \"block\"\nsize = [1, 1]\nelements = [{n}, {n}]\ncells = \"{cells}\"\nelement = \"{element}\"\n\
         [material]\nyoung = 1.0\npoisson = {poisson}\nplane = \"axisymmetric\"\n\
         [[support]]\nboundary = \"bottom\"\nfix = [\"x\", \"y\"]\n\
         [[contact]]\nboundary = \"top\"\nfriction = {friction}\n\
         obstacle = {{ kind = \"formula\", formula = \"0.1 * x^2 - 0.02\" }}\n\
         [time]\nend = 1.0\nincrements = 1\n"
    );
    Scene::parse("cylinder.toml", &text, &[]).unwrap()
}

fn solve(model: &Model, times: &[f64], solver: Solver, observer: &mut dyn Observer) -> HistoryOutcome {
    let outcome = Run::of(model, times.to_vec(), solver).unwrap().history(observer).unwrap();
    assert_eq!(outcome.status, Status::Converged, "{solver:?}");
    outcome
}

/// The sums of the normal forces and of the sizes of the tangential ones.
fn sums(state: &State) -> [f64; 2] {
    [state.p_n.iter().sum(), state.p_t.iter().map(|t| t.abs()).sum()]
}

const METHODS: [(Method, LinearAlgebra); 4] = [
    (Method::BN, LinearAlgebra::Whole(SparseLu::Umfpack)),
    (Method::BN, LinearAlgebra::Whole(SparseLu::Faer)),
    (Method::BN, LinearAlgebra::Condensed(SparseCholesky::Faer)),
    (Method::IP, LinearAlgebra::Whole(SparseLu::Umfpack)),
];

#[test]
fn parabolas_on_cylinders() {
    for (cells, n, element, poisson, smooth, rough) in [
        ("quadrilateral", 8, "bilinear", 0.3, 1.1850842985e-2, [1.2069905644e-2, 2.5737876657e-3]),
        ("quadrilateral", 8, "b-bar", 0.49, 1.4591289663e-2, [1.4638428227e-2, 1.3485380984e-3]),
        ("triangle", 8, "bilinear", 0.3, 1.2522199908e-2, [1.2895770264e-2, 3.1785468064e-3]),
        ("triangle6", 4, "bilinear", 0.3, 1.3076735922e-2, [1.3366498782e-2, 3.3713382041e-3]),
    ] {
        for (mu, expected) in [(0.0, [smooth, 0.0]), (0.3, rough)] {
            let model = Model::new(&cylinder(cells, n, element, poisson, mu)).unwrap();
            // A node on the axis cannot slide.
            let cannot = |contact: &ContactNode| contact.tangents[0].is_empty() == (contact.position[0] == 0.0);
            assert!(model.contacts.iter().all(cannot));
            for (method, linear) in METHODS {
                let solver = Solver { method, linear: Some(linear), ..Solver::default() };
                let state = solve(&model, &[1.0], solver, &mut ()).state;
                let mut found = sums(&state);
                // The node between the axis and the next corner pulls at the axis with half its friction, which the other program
                // counts at the axis.
                let beside = |contact: &ContactNode| contact.ends.is_some() && contact.position[0] < 0.2;
                found[1] += model.contacts.iter().position(beside).map_or(0.0, |i| 0.5 * state.p_t[i].abs());
                for (found, expected) in found.into_iter().zip(expected) {
                    let close = (found - expected).abs() <= 2e-9 * expected.abs() + 1e-16;
                    assert!(close, "{cells} {element} {mu} {solver:?}: {found:.10e} {expected:.10e}");
                }
            }
        }
    }
}

/// Sliding history: all methods agree on every state.
#[test]
fn methods_agree_over_a_history() {
    let times: Vec<f64> = (1..=4).map(f64::from).collect();
    for cells in ["quadrilateral", "triangle6"] {
        let mut scene = cylinder(cells, 4, "bilinear", 0.3, 0.2);
        scene.description.times = times.clone();
        let contact = &mut scene.description.contacts[0];
        contact.obstacles[0].approach = Some(vec![[0.0, -0.02], [2.0, 0.01], [4.0, -0.005]]);
        let model = Model::new(&scene).unwrap();
        let all = METHODS.map(|(method, linear)| {
            let mut keep = Keep::default();
            let solver = Solver { method, linear: Some(linear), ..Solver::default() };
            solve(&model, &times, solver, &mut keep);
            keep.states
        });
        for other in &all[1..] {
            let off = difference(&all[0], other);
            assert!(off < 1e-8, "{cells}: {off:e}");
        }
    }
}
