//! The table of increments: comma-separated, a line for each.

use crate::history::IncrementRecord;

/// The header of the table.
pub(super) fn header() -> String {
    let kkt = ["equilibrium", "penetration", "tension", "complementarity", "cone", "dissipation"];
    let fields = [
        &["index", "time", "status", "iterations", "backtracks", "theta"][..],
        &kkt,
        &["backward_error", "open", "stick", "slip"],
        &["seconds_assembly", "seconds_factorization", "seconds_solve", "seconds_rest"],
        &["parts", "rescued"],
    ];
    fields.concat().join(",") + "\n"
}

/// The line of an increment.
pub(super) fn line(record: &IncrementRecord) -> String {
    let r = record;
    let mut fields = vec![
        r.index.to_string(),
        r.time.to_string(),
        r.status.to_string(),
        r.iterations.to_string(),
        r.backtracks.to_string(),
        r.theta.to_string(),
    ];
    fields.extend(r.kkt.components().map(|(_, value)| value.to_string()));
    fields.push(r.backward_error.to_string());
    fields.extend([r.contact.open, r.contact.stick, r.contact.slip].map(|count| count.to_string()));
    let s = r.seconds;
    fields.extend([s.assembly, s.factorization, s.solve, s.rest].map(|seconds| format!("{seconds:.6}")));
    fields.extend([r.parts.to_string(), r.rescued.to_string()]);
    fields.join(",") + "\n"
}
