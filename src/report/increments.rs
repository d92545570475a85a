//! The tables that grow with the increments, comma-separated: a line for each, and one for the forces on each obstacle.

use super::csv::{self, number};
use super::resultant::{ForceRecord, Resultant};
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
        &["parts", "rescued", "friction_work", "strain_energy"],
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
    fields.extend([r.parts.to_string(), r.rescued.to_string(), number(r.friction_work), number(r.strain_energy)]);
    csv::line(&fields)
}

/// The header of the table of forces, for so many dimensions.
pub(super) fn forces_header(dimension: usize) -> String {
    let columns: &[&str] = match dimension {
        2 => &["f_x", "f_y", "m_z", "sum_p_n", "sum_p_t"],
        _ => &["f_x", "f_y", "f_z", "m_x", "m_y", "m_z", "sum_p_n", "sum_p_t", "sum_p_o"],
    };
    csv::table(&[&["index", "time", "boundary"], columns].concat(), std::iter::empty())
}

/// The line of the forces on an obstacle.
pub(super) fn forces_line(record: &ForceRecord) -> String {
    let Resultant { boundary, force, moment, sums } = &record.resultant;
    let numbers = force.iter().chain(moment).chain([&sums.sum_p_n, &sums.sum_p_t]).chain(&sums.sum_p_o);
    let fields = [record.index.to_string(), number(record.time), boundary.clone()];
    csv::line(&fields.into_iter().chain(numbers.map(|x| number(*x))).collect::<Vec<_>>())
}
