//! The tables and figures of the paper, the suite of extremes, and the program that computes them.
#![allow(clippy::unwrap_used)]

mod estimates;
mod exact_path;
mod extremes;
mod figures;
mod program;
mod svg;
mod table_block;
mod table_punch;

use std::ops::ControlFlow;
use stickslip::body::Model;
use stickslip::run::{Run, discretise};
use stickslip::solver::State;
use stickslip::solver::history::{HistoryOutcome, IncrementView, LinearAlgebra, Observer};
use stickslip_studies::tables::{PaperMethod, PaperTable};

/// The states at the ends of all increments.
#[derive(Default)]
struct States(Vec<State>);

impl Observer for States {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        self.0.push(step.state.clone());
        ControlFlow::Continue(())
    }
}

/// Algorithm BN on a problem of the paper, mu = 0.4, with the model and the states of all increments.
fn bn(table: PaperTable, contact_nodes: usize, increments: usize) -> (Model, HistoryOutcome, Vec<State>) {
    let scene = table.scene(contact_nodes, 0.4, increments).unwrap();
    let model = discretise(&scene).unwrap();
    let mut states = States::default();
    let solver = table.solver(PaperMethod::Bn, LinearAlgebra::default());
    let times = scene.time.all();
    let outcome = Run::of(&model, times, solver).unwrap().history(&mut states).unwrap();
    (model, outcome, states.0)
}
