//! The paper's block from its scene file, with an observer that draws the history of contact.
//!
//! `cargo run --release --example block`

#![allow(clippy::print_stdout)]

use std::ops::ControlFlow;
use stickslip::run::Run;
use stickslip::scene::Scene;
use stickslip::solver::history::{IncrementView, Observer};

/// One character for each contact node, one line for each increment.
struct Picture;

impl Observer for Picture {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        use stickslip::solver::ContactStatus::{Open, Slip, Stick};
        let nodes = step.statuses.iter().map(|status| match status {
            Open => ' ',
            Stick => '#',
            Slip => '-',
        });
        println!("{:4.2} |{}|", step.record.time, nodes.collect::<String>());
        ControlFlow::Continue(())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let overrides = ["mesh.elements=[60,60]".parse()?];
    let scene = Scene::read("data/scenes/block.toml".as_ref(), &overrides)?;
    println!("time  contact line from the wall: # stick, - slip");
    let report = Run::new(&scene)?.solve(&mut Picture)?;
    println!("{}", report.status);
    Ok(())
}
