//! The table of increments: comma-separated, a line for each.

use super::csv::number;
use crate::history::IncrementRecord;

/// What the table of every version begins with: by that a run knows the folder of an earlier one.
pub(super) const FIRST_COLUMNS: &str = "index,time,status,iterations,backtracks,theta,";

/// The header of the table.
pub(super) fn header() -> String {
    let kkt = ["equilibrium", "penetration", "tension", "complementarity", "cone", "dissipation"];
    let fields = [
        &kkt[..],
        &["backward_error", "open", "stick", "slip"],
        &["seconds_assembly", "seconds_factorization", "seconds_solve", "seconds_rest"],
        &["parts", "rescued", "friction_work"],
    ];
    format!("{FIRST_COLUMNS}{}\n", fields.concat().join(","))
}

/// The line of an increment.
pub(super) fn line(record: &IncrementRecord) -> String {
    let r = record;
    let mut fields = vec![
        r.index.to_string(),
        number(r.time),
        r.status.to_string(),
        r.iterations.to_string(),
        r.backtracks.to_string(),
        number(r.theta),
    ];
    fields.extend(r.kkt.components().map(|(_, value)| number(value)));
    fields.push(number(r.backward_error));
    fields.extend([r.contact.open, r.contact.stick, r.contact.slip].map(|count| count.to_string()));
    let s = r.seconds;
    fields.extend([s.assembly, s.factorization, s.solve, s.rest].map(|seconds| format!("{seconds:.6}")));
    fields.extend([r.parts.to_string(), r.rescued.to_string(), number(r.friction_work)]);
    fields.join(",") + "\n"
}
