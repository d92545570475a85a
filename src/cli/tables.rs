//! `stickslip tables`.

use std::process::ExitCode;

use clap::{Args, Subcommand};
use serde::Serialize;
use stickslip::history::Status;
use stickslip::linear;
use stickslip::report::Table;
use stickslip::tables::{Agreement, Case, Cell, PaperTable, TableError};

use super::Failure;
use super::progress::bar;

#[derive(Args)]
pub(super) struct TablesArgs {
    #[command(subcommand)]
    table: WhichTable,
}

#[derive(Subcommand)]
enum WhichTable {
    /// Table I: the punch
    Punch(Selection),
    /// Table II: the elastic block
    Block(BlockSelection),
}

#[derive(Args)]
struct BlockSelection {
    /// Only these numbers of contact nodes
    #[arg(long, value_delimiter = ',')]
    contact_nodes: Vec<usize>,
    #[command(flatten)]
    rest: Selection,
}

#[derive(Args)]
struct Selection {
    /// Only these friction coefficients
    #[arg(long, value_delimiter = ',')]
    mu: Vec<f64>,
    /// Only these numbers of increments (per path of the block)
    #[arg(long, value_delimiter = ',')]
    increments: Vec<usize>,
    /// Print one JSON object and nothing else
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Computed {
    table: &'static str,
    cells: Vec<Cell>,
    nle: Agreement,
    nls: Agreement,
}

pub(super) fn tables(args: &TablesArgs) -> Result<ExitCode, Failure> {
    let (table, contact_nodes, selection) = match &args.table {
        WhichTable::Punch(selection) => (PaperTable::Punch, &[][..], selection),
        WhichTable::Block(block) => (PaperTable::Block, &block.contact_nodes[..], &block.rest),
    };
    let cases = select(table, contact_nodes, selection)?;
    linear::process::keep_freed_memory();
    let bar = bar(cases.len(), "cells");
    let mut cells = Vec::with_capacity(cases.len());
    for case in &cases {
        bar.set_message(format!("n_c = {}, mu = {}, {} increments", case.contact_nodes, case.mu, case.increments));
        cells.push(table.cell(case).map_err(|error| match error {
            TableError::Model(error) => Failure::from(error),
            TableError::Linear(error) => Failure::linear(&error),
        })?);
        bar.inc(1);
    }
    bar.finish_and_clear();

    let converged = cells.iter().all(|cell| cell.status == Status::Converged);
    let nle = Agreement::of(cells.iter().map(Cell::nle_difference));
    let nls = Agreement::of(cells.iter().map(Cell::nls_difference));
    let computed = Computed { table: table.title(), cells, nle, nls };
    if selection.json {
        let json =
            serde_json::to_string_pretty(&computed).map_err(|error| Failure::Machine(miette::miette!("{error}")))?;
        say!("{json}");
    } else {
        print(&computed);
    }
    Ok(if converged { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// The published cases that the options leave.
fn select(table: PaperTable, contact_nodes: &[usize], selection: &Selection) -> Result<Vec<Case>, Failure> {
    let all = table.cases();
    let wanted = |case: &&Case| {
        (contact_nodes.is_empty() || contact_nodes.contains(&case.contact_nodes))
            && (selection.mu.is_empty() || selection.mu.contains(&case.mu))
            && (selection.increments.is_empty() || selection.increments.contains(&case.increments))
    };
    let cases: Vec<Case> = all.iter().filter(wanted).copied().collect();
    if cases.is_empty() {
        let list = |values: Vec<String>| {
            let mut values = values;
            values.dedup();
            values.join(", ")
        };
        let help = format!(
            "it has contact nodes {}; mu 0.1, 0.4, 0.8; increments {}",
            list(all.iter().map(|case| case.contact_nodes.to_string()).collect()),
            list(all.iter().filter(|case| case.mu == 0.1).map(|case| case.increments.to_string()).take(7).collect()),
        );
        return Err(Failure::Input(miette::miette!(help = help, "the table has no such cell")));
    }
    Ok(cases)
}

fn print(computed: &Computed) {
    say!("{}\n", computed.table);
    let mut text =
        Table::new(&["n_c", "mu", "inc", "nle paper", "here", "diff", "nls paper", "here", "diff", "error", "s"]);
    for cell in &computed.cells {
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
    for (name, agreement) in [("nle", &computed.nle), ("nls", &computed.nls)] {
        let Agreement { mean, largest, equal, cells } = agreement;
        say!("{name}: equal to rounding in {equal} of {cells} cells; mean difference {mean:.3}, largest {largest:.3}");
    }
}
