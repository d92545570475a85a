//! `stickslip-studies tables`.

use clap::{Args, Subcommand};
use miette::IntoDiagnostic;
use serde::Serialize;
use stickslip::run::report::csv_table;
use stickslip::solver::history::{LinearAlgebra, Status};
use stickslip_output::Table;
use stickslip_studies::tables::{Agreement, Case, Cell, Counts, PaperMethod, PaperTable};

use super::{Answer, jobs};

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
    methods: Vec<PaperMethod>,
    /// The linear algebra: condensed, as the paper does it, or umfpack or faer, several times slower
    #[arg(long, default_value = "condensed", value_parser = built_in)]
    solver: LinearAlgebra,
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

/// The linear algebra of that name, if this build has it.
fn built_in(word: &str) -> Result<LinearAlgebra, String> {
    let linear: LinearAlgebra = word.parse()?;
    if linear.is_built_in() { Ok(linear) } else { Err(format!("this build has no {linear}")) }
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
    /// What is not compared, and why.
    notes: Vec<String>,
    columns: Vec<Column>,
}

pub(super) fn tables(args: &TablesArgs) -> miette::Result<Answer> {
    let (table, contact_nodes, selection) = match &args.table {
        WhichTable::Punch(selection) => (PaperTable::Punch, &[][..], selection),
        WhichTable::Block(block) => (PaperTable::Block, &block.contact_nodes[..], &block.rest),
    };
    let cases = select(table, contact_nodes, selection)?;
    let wanted = |method: &PaperMethod| selection.methods.is_empty() || selection.methods.contains(method);
    let methods: Vec<PaperMethod> = PaperMethod::ALL.into_iter().filter(wanted).collect();
    let cells = compute(table, &cases, &methods, selection)?;
    let columns: Vec<Column> = methods
        .iter()
        .map(|&method| Column::new(method, cells.iter().filter(|cell| cell.method == method).copied().collect()))
        .collect();
    // What the table says of prev is chance; the others have to get through.
    let has_passed = cells.iter().all(|cell| cell.status == Status::Converged || cell.method == PaperMethod::IpPrev);
    let computed = Computed { table: table.title(), notes: notes(table, &columns), columns };
    let lines = if selection.json {
        vec![serde_json::to_string_pretty(&computed).into_diagnostic()?]
    } else if selection.csv {
        csv(&computed).lines().map(str::to_string).collect()
    } else {
        words(&cases, &computed)
    };
    Ok(Answer { lines, has_passed })
}

/// Computes the cells, several at a time, and shows the progress.
fn compute(
    table: PaperTable,
    cases: &[Case],
    methods: &[PaperMethod],
    selection: &Selection,
) -> miette::Result<Vec<Cell>> {
    let pairs = cases.iter().flat_map(|&case| methods.iter().map(move |&method| (case, method)));
    let mut tasks: Vec<_> = pairs.enumerate().map(|(place, (case, method))| (place, case, method)).collect();
    // The long ones first, so that no processor is left with one at the end.
    tasks.sort_by_key(|(_, case, _)| std::cmp::Reverse(case.contact_nodes.pow(3) * case.increments));
    let describe = |(_, case, method): &(usize, Case, PaperMethod)| {
        let Case { contact_nodes, mu, increments, .. } = case;
        format!("{}, n_c = {contact_nodes}, mu = {mu}, {increments} increments", method.title())
    };
    let work = |(place, case, method): &(usize, Case, PaperMethod)| {
        table.cell(case, *method, selection.solver).map(|cell| (*place, cell))
    };
    let mut cells = jobs::run(&tasks, jobs::count(selection.jobs), describe, work)?;
    cells.sort_by_key(|(place, _)| *place);
    Ok(cells.into_iter().map(|(_, cell)| cell).collect())
}

/// The published cases that the options leave.
fn select(table: PaperTable, contact_nodes: &[usize], selection: &Selection) -> miette::Result<Vec<Case>> {
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
        return Err(miette::miette!(help = help, "the table has no such cell"));
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

/// What is not compared, and why: of the histories that were computed, and of the columns that are not the paper's method.
fn notes(table: PaperTable, columns: &[Column]) -> Vec<String> {
    let mut notes = Vec::new();
    for column in columns {
        let failed = column.cells.iter().filter(|cell| cell.status != Status::Converged).count();
        if failed > 0 {
            notes.push(format!(
                "{}: {failed} of {} histories did not converge and are not compared; the table shows how many increments did",
                column.method.title(),
                column.cells.len()
            ));
        }
        if (table, column.method) == (PaperTable::Punch, PaperMethod::IpPrev) {
            notes.push(
                "IP prev: sigma by the block's rule (0.95) instead of the paper's (36), without a restart".into(),
            );
        }
    }
    notes
}

/// What a person reads.
fn words(cases: &[Case], computed: &Computed) -> Vec<String> {
    let mut lines = vec![format!("{}\n", computed.table)];
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
            let is_solved = cell.status == Status::Converged;
            let [converged, all] = cell.converged;
            let here = if is_solved { format!("{:.2}", cell.here.nle) } else { format!("{converged} of {all}") };
            let nls = cell.here.nls.filter(|_| is_solved).map_or("-".to_string(), |nls| format!("{nls:.2}"));
            match cell.paper {
                Some(Counts { nle, nls: Some(paper) }) => {
                    row.extend([format!("{nle:.1}"), here, format!("{paper:.1}"), nls]);
                }
                Some(Counts { nle, nls: None }) => row.extend([format!("{nle:.1}"), here]),
                None => row.push(here),
            }
            if is_solved {
                worst = worst.max(cell.worst_error);
            }
        }
        row.push(format!("{worst:.0e}"));
        text.push(row);
    }
    lines.push(text.to_string());
    for column in &computed.columns {
        let name = column.method.title();
        for (count, agreement) in [("nle", &column.nle), ("nls", &column.nls)] {
            if let Some(Agreement { mean, largest, equal, cells, .. }) = agreement {
                lines.push(format!(
                    "{name} {count}: mean difference {mean:.3}, largest {largest:.2}; \
                     equal to rounding in {equal} of {cells} cells"
                ));
            }
        }
        if column.nle.is_none() {
            lines.push(format!("{name} nle: {:.2} on average", column.mean_nle));
        }
        lines.push(format!("{name}: {:.0} s", column.cells.iter().map(|cell| cell.seconds).sum::<f64>()));
    }
    lines.extend(computed.notes.iter().cloned());
    lines
}

const HEADER: [&str; 13] = [
    "method",
    "contact_nodes",
    "mu",
    "increments",
    "nle_paper",
    "nle",
    "nls_paper",
    "nls",
    "status",
    "converged",
    "of",
    "error",
    "seconds",
];

fn csv(computed: &Computed) -> String {
    let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    let row = |cell: &Cell| {
        let Cell { case, method, paper, here, status, converged: [converged, of], worst_error, seconds } = cell;
        let nls = [paper.and_then(|paper| paper.nls), here.nls].map(number);
        let mut row = vec![method.title().to_string(), case.contact_nodes.to_string(), case.mu.to_string()];
        row.extend([case.increments.to_string(), number(paper.map(|paper| paper.nle)), here.nle.to_string()]);
        row.extend(nls.into_iter().chain([status.to_string(), converged.to_string(), of.to_string()]));
        row.extend([format!("{worst_error:e}"), format!("{seconds:.3}")]);
        row
    };
    csv_table(&HEADER, computed.columns.iter().flat_map(|column| &column.cells).map(row))
}
