//! The display of progress during a run.

use std::fmt::Write;
use std::io::{IsTerminal, stderr};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use stickslip::solver::history::IncrementRecord;

/// A table of increments on standard output, with a progress bar below it on a terminal.
pub(super) struct Progress {
    bar: ProgressBar,
    rows: bool,
}

/// The columns: heading and width.
const COLUMNS: [(&str, usize); 11] = [
    ("inc", 5),
    ("time", 9),
    ("iter", 5),
    ("back", 5),
    ("Theta", 9),
    ("error", 9),
    ("open", 6),
    ("stick", 6),
    ("slip", 6),
    ("s", 8),
    // Remarks on unusual increments.
    ("", 0),
];

impl Progress {
    /// Creates a display of `increments` increments, of which `done` are finished. Without `rows` it shows only the
    /// bar.
    pub(super) fn new(increments: usize, done: usize, rows: bool) -> Self {
        let bar = bar(increments, "increments").with_position(done as u64);
        let progress = Progress { bar, rows };
        progress.row(&COLUMNS.map(|(head, _)| head.to_string()));
        progress
    }

    /// Shows the `theta` reached by an iteration.
    pub(super) fn iteration(&self, iteration: usize, theta: f64) {
        self.bar.set_message(format!("iteration {iteration}, Theta {theta:.1e}"));
    }

    /// Shows a finished increment.
    pub(super) fn increment(&self, record: &IncrementRecord) {
        let r = record;
        let seconds = r.seconds.assembly + r.seconds.factorization + r.seconds.solve + r.seconds.rest;
        let mut notes = Vec::new();
        if r.parts > 1 {
            notes.push(format!("{} parts", r.parts));
        }
        if r.joined > 0 {
            notes.push(format!("{} contact nodes joined", r.joined));
        }
        if r.rescued {
            notes.push("solved by ip".to_string());
        }
        self.row(&[
            r.index.to_string(),
            format!("{:.4}", r.time),
            r.iterations.to_string(),
            r.backtracks.to_string(),
            if r.theta.is_nan() { "-".to_string() } else { format!("{:.1e}", r.theta) },
            format!("{:.1e}", r.kkt.worst().1),
            r.contact.open.to_string(),
            r.contact.stick.to_string(),
            r.contact.slip.to_string(),
            format!("{seconds:.3}"),
            notes.join(", "),
        ]);
        self.bar.inc(1);
    }

    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn row(&self, fields: &[String; COLUMNS.len()]) {
        if !self.rows {
            return;
        }
        let fields = fields.iter().zip(COLUMNS).map(|(field, (_, width))| format!("{field:>width$}"));
        let line = fields.collect::<Vec<_>>().join(" ");
        self.bar.suspend(|| say!("{}", line.trim_end()));
    }
}

/// Creates a progress bar of `length` steps on a terminal, and an invisible one elsewhere.
pub(super) fn bar(length: usize, unit: &str) -> ProgressBar {
    let interactive = stderr().is_terminal();
    let target = if interactive { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let template = format!("{{bar:30}} {{pos}}/{{len}} {unit}, {{elapsed}}{{left}}  {{msg}}");
    let style = ProgressStyle::with_template(&template).unwrap_or_else(|_| ProgressStyle::default_bar());
    let style = style.with_key("left", |state: &ProgressState, f: &mut dyn Write| {
        // Nothing is known before the first step is done.
        let left = (state.pos() > 0).then(|| write!(f, ", {} left", HumanDuration(state.eta())));
        // The bar has no way to report a failure of its own text.
        let _ = left.transpose();
    });
    ProgressBar::with_draw_target(Some(length as u64), target).with_style(style)
}
