//! How the friction coefficient changes what the foundation carries: one scene, many runs.
//!
//! `cargo run --release --example friction_study`

#![allow(clippy::print_stdout)]

use stickslip::history::{self, HistorySettings, Method};
use stickslip::linear::Direct;
use stickslip::model::Model;
use stickslip::report::Table;
use stickslip::scene::{Override, Scene};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut table = Table::new(&["mu", "status", "sum p_n, MN", "sum p_t, MN", "stick", "slip", "open"]);
    for mu in [0.0, 0.1, 0.2, 0.4, 0.8] {
        let overrides = ["mesh.elements=[40,40]".parse()?, Override::value("contact.friction", mu)];
        let scene = Scene::read("data/scenes/block.toml".as_ref(), &overrides)?;
        let model = Model::new(&scene)?;
        let settings = HistorySettings::new(&model.problem, &model.loading, Method::PaperBn).unwrap().until(200, 1e-10);
        let mut linear = Direct::default();
        let times = scene.time.all();
        let outcome = history::run(&model.problem, &model.loading, &times, &settings, linear, &mut ())?;
        let contact = outcome.records.last().map(|record| record.contact).unwrap_or_default();
        table.push(vec![
            mu.to_string(),
            outcome.status.to_string(),
            format!("{:.4}", outcome.state.p_n.iter().sum::<f64>() * 1e-6),
            format!("{:.4}", outcome.state.p_t.iter().sum::<f64>() * 1e-6),
            contact.stick.to_string(),
            contact.slip.to_string(),
            contact.open.to_string(),
        ]);
    }
    println!("the block at the end of its history\n\n{table}");
    Ok(())
}
