//! How the friction coefficient changes what the foundation carries: one scene, many runs.
//!
//! `cargo run --release --example friction_study`

#![allow(clippy::print_stdout)]

use stickslip::run::Run;
use stickslip::scene::{Override, Scene};
use stickslip_output::Table;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut table = Table::new(&["mu", "status", "sum p_n, MN", "sum p_t, MN", "stick", "slip", "open"]);
    for mu in [0.0, 0.1, 0.2, 0.4, 0.8] {
        let overrides = ["mesh.elements=[40,40]".parse()?, Override::value("contact.friction", mu)];
        let scene = Scene::read("data/scenes/block.toml".as_ref(), &overrides)?;
        let report = Run::new(&scene)?.solve(&mut ())?;
        let contact = report.increments.last().map(|record| record.contact).unwrap_or_default();
        table.push(vec![
            mu.to_string(),
            report.status.to_string(),
            format!("{:.4}", report.end.sum_p_n * 1e-6),
            format!("{:.4}", report.end.sum_p_t * 1e-6),
            contact.stick.to_string(),
            contact.slip.to_string(),
            contact.open.to_string(),
        ]);
    }
    println!("the block at the end of its history\n\n{table}");
    Ok(())
}
