//! The paper's block from its scene file, with an observer that draws the history of contact.
//!
//! `cargo run --release --example block`

#![allow(clippy::print_stdout)]

use stickslip::history::{self, HistorySettings, Method, Observer, Step};
use stickslip::linear::Direct;
use stickslip::model::Model;
use stickslip::nonlinear::Flow;
use stickslip::scene::Scene;

/// One character for each contact node, one line for each increment.
struct Picture;

impl Observer for Picture {
    fn increment(&mut self, step: &Step<'_>) -> Flow {
        use stickslip::contact::ContactStatus::{Open, Slip, Stick};
        let nodes = step.statuses.iter().map(|status| match status {
            Open => ' ',
            Stick => '#',
            Slip => '-',
        });
        println!("{:4.2} |{}|", step.record.time, nodes.collect::<String>());
        Flow::Continue
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let overrides = ["mesh.elements=[60,60]".parse()?];
    let scene = Scene::read("data/scenes/block.toml".as_ref(), &overrides)?;
    let model = Model::new(&scene)?;
    let settings = HistorySettings::new(&model.problem, &model.loading, Method::PaperBn).unwrap().until(200, 1e-10);
    let mut linear = Direct::default();
    println!("time  contact line from the wall: # stick, - slip");
    let outcome = history::run(&model.problem, &model.loading, &scene.time.all(), &settings, linear, &mut Picture)?;
    println!("{}", outcome.status);
    Ok(())
}
