//! `stickslip tables`.

use std::process::ExitCode;

use clap::{Args, Subcommand, ValueEnum};
use serde::Serialize;
use stickslip::history::Status;
use stickslip::linear;
use stickslip::report::Table;
use stickslip::scene::LinearBackend;
use stickslip::tables::{Agreement, Case, Cell, Counts, PaperError, PaperMethod, PaperTable};

use super::{Failure, jobs};

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
    /// Only these methods
    #[arg(long, value_delimiter = ',')]
    methods: Vec<MethodArg>,
    /// The linear algebra: condensed, as the paper does it, or umfpack or faer, several times slower
    #[arg(long, default_value = "condensed")]
    solver: SolverArg,
    /// Cells computed at the same time; as many as there are processors
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=256))]
    jobs: Option<u16>,
    /// Print one JSON object and nothing else
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// Print comma-separated values and nothing else, a line for each case and method
    #[arg(long)]
    csv: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum MethodArg {
    Bn,
    IpSafe,
    IpPrev,
    Ip,
    BnDefault,
}

#[derive(Clone, Copy, ValueEnum)]
enum SolverArg {
    #[cfg(feature = "umfpack")]
    Umfpack,
    #[cfg(feature = "faer")]
    Faer,
    Condensed,
}

/// A column of a table: its cells, and how far they are from the paper's.
#[derive(Serialize)]
struct Column {
    method: PaperMethod,
    mean_nle: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    nle: Option<Agreement>,
    #[serde(skip_serializing_if = "Option::is_none")]
    nls: Option<Agreement>,
    cells: Vec<Cell>,
}

#[derive(Serialize)]
struct Computed {
    table: &'static str,
    /// What cannot be compared, and why.
    notes: Vec<String>,
    columns: Vec<Column>,
}

pub(super) fn tables(args: &TablesArgs) -> Result<ExitCode, Failure> {
    let (table, contact_nodes, selection) = match &args.table {
        WhichTable::Punch(selection) => (PaperTable::Punch, &[][..], selection),
        WhichTable::Block(block) => (PaperTable::Block, &block.contact_nodes[..], &block.rest),
    };
    let cases = select(table, contact_nodes, selection)?;
    let methods = methods(&selection.methods);
    linear::process::keep_freed_memory();
    let jobs = jobs::count(selection.jobs);
    let linear = match selection.solver {
        #[cfg(feature = "umfpack")]
        SolverArg::Umfpack => LinearBackend::Umfpack,
        #[cfg(feature = "faer")]
        SolverArg::Faer => LinearBackend::Faer,
        SolverArg::Condensed => LinearBackend::Condensed,
    };
    let cells = compute(table, &cases, &methods, linear, jobs)?;
    let columns: Vec<Column> = methods
        .iter()
        .map(|&method| Column::new(method, cells.iter().filter(|cell| cell.method == method).copied().collect()))
        .collect();
    // What the table says of prev is chance; the others have to get through.
    let sound = cells.iter().all(|cell| cell.status == Status::Converged || cell.method == PaperMethod::IpPrev);
    let computed = Computed { table: table.title(), notes: notes(table, &columns), columns };
    if selection.json {
        let json =
            serde_json::to_string_pretty(&computed).map_err(|error| Failure::Machine(miette::miette!("{error}")))?;
        say!("{json}");
    } else if selection.csv {
        print_csv(&computed);
    } else {
        print(&cases, &computed);
    }
    Ok(if sound { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

fn methods(wanted: &[MethodArg]) -> Vec<PaperMethod> {
    let of = |arg: &MethodArg| match arg {
        MethodArg::Bn => PaperMethod::Bn,
        MethodArg::IpSafe => PaperMethod::IpSafe,
        MethodArg::IpPrev => PaperMethod::IpPrev,
        MethodArg::Ip => PaperMethod::Ip,
        MethodArg::BnDefault => PaperMethod::BnDefault,
    };
    let wanted: Vec<PaperMethod> = wanted.iter().map(of).collect();
    PaperMethod::ALL.into_iter().filter(|method| wanted.is_empty() || wanted.contains(method)).collect()
}

/// Computes the cells, `jobs` at a time, and shows the progress.
fn compute(
    table: PaperTable,
    cases: &[Case],
    methods: &[PaperMethod],
    linear: LinearBackend,
    jobs: usize,
) -> Result<Vec<Cell>, Failure> {
    let pairs = cases.iter().flat_map(|&case| methods.iter().map(move |&method| (case, method)));
    let mut tasks: Vec<_> = pairs.enumerate().map(|(place, (case, method))| (place, case, method)).collect();
    // The long ones first, so that no processor is left with one at the end.
    tasks.sort_by_key(|(_, case, _)| std::cmp::Reverse(case.contact_nodes.pow(3) * case.increments));
    let describe = |(_, case, method): &(usize, Case, PaperMethod)| {
        let Case { contact_nodes, mu, increments, .. } = case;
        format!("{}, n_c = {contact_nodes}, mu = {mu}, {increments} increments", method.title())
    };
    let work = |(place, case, method): &(usize, Case, PaperMethod)| Ok((*place, table.cell(case, *method, linear)?));
    let mut cells = jobs::run(&tasks, jobs, "cells", describe, work).map_err(|error| match error {
        PaperError::Model(error) => Failure::from(error),
        PaperError::Linear(error) => Failure::linear(&error),
    })?;
    cells.sort_by_key(|(place, _)| *place);
    Ok(cells.into_iter().map(|(_, cell)| cell).collect())
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

impl Column {
    fn new(method: PaperMethod, cells: Vec<Cell>) -> Self {
        let has = |count: fn(&Counts) -> bool| cells.iter().any(|cell| cell.paper.as_ref().is_some_and(count));
        let nle = has(|_| true).then(|| Agreement::of(cells.iter().map(Cell::nle_difference)));
        let nls = has(|paper| paper.nls.is_some()).then(|| Agreement::of(cells.iter().map(Cell::nls_difference)));
        let mean_nle = cells.iter().map(|cell| cell.here.nle).sum::<f64>() / cells.len().max(1) as f64;
        Column { method, mean_nle, nle, nls, cells }
    }
}

/// What cannot be compared, and why.
fn notes(table: PaperTable, columns: &[Column]) -> Vec<String> {
    let mut notes = Vec::new();
    for column in columns {
        let failed = column.cells.iter().filter(|cell| cell.status != Status::Converged).count();
        if failed > 0 {
            notes.push(format!(
                "{}: {failed} of {} histories did not get through and are not compared; the table shows how far they got",
                column.method.title(),
                column.cells.len()
            ));
        }
        if (table, column.method) == (PaperTable::Punch, PaperMethod::IpPrev) {
            notes.push(
                "IP prev: not reproduced. With the paper's rule (36) for sigma the iteration stalls at the border \
                 in the second increment or soon after; shown is the block's rule (0.95), without a restart"
                    .to_string(),
            );
        }
        if (table, column.method) == (PaperTable::Block, PaperMethod::IpPrev) {
            notes.push(
                "IP prev: chaotic; single cells move by several iterations under changes of rounding size".to_string(),
            );
        }
    }
    notes
}

fn print(cases: &[Case], computed: &Computed) {
    say!("{}\n", computed.table);
    let mut heads = vec!["n_c".to_string(), "mu".to_string(), "inc".to_string()];
    for column in &computed.columns {
        let name = column.method.title();
        match (&column.nle, &column.nls) {
            (Some(_), Some(_)) => heads.extend([format!("{name} nle"), "here".into(), "nls".into(), "here".into()]),
            (Some(_), None) => heads.extend([format!("{name} nle"), "here".into()]),
            (None, _) => heads.push(format!("{name} nle")),
        }
    }
    heads.push("error".into());
    let mut text = Table::new(&heads.iter().map(String::as_str).collect::<Vec<_>>());
    for (k, case) in cases.iter().enumerate() {
        let mut row = vec![case.contact_nodes.to_string(), case.mu.to_string(), case.increments.to_string()];
        let mut worst = 0.0_f64;
        for column in &computed.columns {
            let cell = &column.cells[k];
            let sound = cell.status == Status::Converged;
            let [converged, all] = cell.converged;
            let here = if sound { format!("{:.2}", cell.here.nle) } else { format!("{converged} of {all}") };
            let nls = cell.here.nls.filter(|_| sound).map_or("-".to_string(), |nls| format!("{nls:.2}"));
            match cell.paper {
                Some(Counts { nle, nls: Some(paper) }) => {
                    row.extend([format!("{nle:.1}"), here, format!("{paper:.1}"), nls]);
                }
                Some(Counts { nle, nls: None }) => row.extend([format!("{nle:.1}"), here]),
                None => row.push(here),
            }
            if sound {
                worst = worst.max(cell.worst_error);
            }
        }
        row.push(format!("{worst:.0e}"));
        text.push(row);
    }
    say!("{text}");
    for column in &computed.columns {
        let name = column.method.title();
        for (count, agreement) in [("nle", &column.nle), ("nls", &column.nls)] {
            if let Some(Agreement { mean, largest, equal, cells, .. }) = agreement {
                say!(
                    "{name} {count}: mean difference {mean:.3}, largest {largest:.2}; \
                     equal to rounding in {equal} of {cells} cells"
                );
            }
        }
        if column.nle.is_none() {
            say!("{name} nle: {:.2} on average", column.mean_nle);
        }
        say!("{name}: {:.0} s", column.cells.iter().map(|cell| cell.seconds).sum::<f64>());
    }
    computed.notes.iter().for_each(|note| say!("{note}"));
}

fn print_csv(computed: &Computed) {
    say!("method,contact_nodes,mu,increments,nle_paper,nle,nls_paper,nls,status,converged,of,error,seconds");
    let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    for column in &computed.columns {
        for cell in &column.cells {
            let Cell { case, paper, here, status, converged: [converged, of], worst_error, seconds, .. } = cell;
            let Case { contact_nodes, mu, increments, .. } = case;
            say!(
                "{},{contact_nodes},{mu},{increments},{},{},{},{},{status},{converged},{of},{worst_error:e},{seconds:.3}",
                column.method.title(),
                number(paper.map(|paper| paper.nle)),
                here.nle,
                number(paper.and_then(|paper| paper.nls)),
                number(here.nls),
            );
        }
    }
}
