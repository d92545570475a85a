//! `stickslip tables`.

use std::process::ExitCode;

use clap::{Args, Subcommand};
use serde::Serialize;
use stickslip::history::Status;
use stickslip::report::Table;
use stickslip::tables::{Agreement, BlockCase, BlockCell, TableError, block_cases, block_cell};

use super::Failure;
use super::progress::bar;

#[derive(Args)]
pub(super) struct TablesArgs {
    #[command(subcommand)]
    table: WhichTable,
}

#[derive(Subcommand)]
enum WhichTable {
    /// Table II: the elastic block
    Block(BlockArgs),
}

#[derive(Args)]
struct BlockArgs {
    /// Only these numbers of contact nodes
    #[arg(long, value_delimiter = ',')]
    contact_nodes: Vec<usize>,
    /// Only these friction coefficients
    #[arg(long, value_delimiter = ',')]
    mu: Vec<f64>,
    /// Only these numbers of increments per path
    #[arg(long, value_delimiter = ',')]
    increments: Vec<usize>,
    /// Print one JSON object and nothing else
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct BlockTable {
    table: &'static str,
    cells: Vec<BlockCell>,
    nle: Agreement,
    nls: Agreement,
}

pub(super) fn tables(args: &TablesArgs) -> Result<ExitCode, Failure> {
    let WhichTable::Block(args) = &args.table;
    let cases = select(args)?;
    let bar = bar(cases.len(), "cells");
    let mut cells = Vec::with_capacity(cases.len());
    for case in &cases {
        bar.set_message(format!("n_c = {}, mu = {}, {} increments", case.contact_nodes, case.mu, case.increments));
        cells.push(block_cell(case).map_err(|error| match error {
            TableError::Model(error) => Failure::from(error),
            TableError::Linear(error) => Failure::linear(&error),
        })?);
        bar.inc(1);
    }
    bar.finish_and_clear();

    let converged = cells.iter().all(|cell| cell.status == Status::Converged);
    let nle = Agreement::of(cells.iter().map(BlockCell::nle_difference));
    let nls = Agreement::of(cells.iter().map(BlockCell::nls_difference));
    let table = BlockTable { table: "Table II, elastic block, Algorithm BN", cells, nle, nls };
    if args.json {
        let json =
            serde_json::to_string_pretty(&table).map_err(|error| Failure::Machine(miette::miette!("{error}")))?;
        say!("{json}");
    } else {
        print(&table);
    }
    Ok(if converged { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// The published cases that the options leave.
fn select(args: &BlockArgs) -> Result<Vec<BlockCase>, Failure> {
    let mut cases = block_cases();
    cases.retain(|case| {
        (args.contact_nodes.is_empty() || args.contact_nodes.contains(&case.contact_nodes))
            && (args.mu.is_empty() || args.mu.contains(&case.mu))
            && (args.increments.is_empty() || args.increments.contains(&case.increments))
    });
    if cases.is_empty() {
        let help = "it has contact nodes 5, 10, 20, 50, 100; mu 0.1, 0.4, 0.8; increments 1, 5, 10, 20, 50";
        return Err(Failure::Input(miette::miette!(help = help, "Table II has no such cell")));
    }
    Ok(cases)
}

fn print(table: &BlockTable) {
    say!("{}\n", table.table);
    let mut text =
        Table::new(&["n_c", "mu", "inc", "nle paper", "here", "diff", "nls paper", "here", "diff", "error", "s"]);
    for cell in &table.cells {
        let case = cell.case;
        text.push(vec![
            case.contact_nodes.to_string(),
            case.mu.to_string(),
            case.increments.to_string(),
            format!("{:.1}", case.paper_nle),
            format!("{:.3}", cell.nle),
            format!("{:+.3}", cell.nle_difference()),
            format!("{:.1}", case.paper_nls),
            format!("{:.3}", cell.nls),
            format!("{:+.3}", cell.nls_difference()),
            if cell.status == Status::Converged {
                format!("{:.0e}", cell.worst_error)
            } else {
                cell.status.to_string()
            },
            format!("{:.2}", cell.seconds),
        ]);
    }
    say!("{text}");
    for (name, agreement) in [("nle", &table.nle), ("nls", &table.nls)] {
        let Agreement { mean, largest, equal, cells } = agreement;
        say!("{name}: equal to rounding in {equal} of {cells} cells; mean difference {mean:.3}, largest {largest:.3}");
    }
}
