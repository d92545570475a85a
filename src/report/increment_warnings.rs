//! What increments leave, as a warning.

use super::warnings::{Warning, WarningKind};
use crate::history::IncrementError;
use crate::units::{Quantity, UnitSystem};

/// A larger share of the work of friction that is due to the increments is told.
const WORK: f64 = 0.2;

/// A larger error of the tangential forces is told.
const FORCE: f64 = 0.05;

/// What more increments are counted for.
const GOOD: f64 = 0.02;

/// Up to so many increments of a stretch in which nodes begin to stick an estimate has nothing to go by.
const FEW: usize = 3;

/// What is asked for instead.
const ENOUGH: usize = 8;

/// What tells the error of the forces well, at the ends of stretches.
const COMPANION: &str = "`stickslip run --companion`";

/// The warnings of a run of so many increments. Where no node begins to stick on the way the forces are exact.
pub(super) fn warnings(found: &IncrementError, increments: usize, units: &UnitSystem) -> Vec<Warning> {
    let &IncrementError { friction_work, friction_work_corrected, work_error, force_error, sticking_begins, fewest } =
        found;
    if sticking_begins == 0 {
        return Vec::new();
    }
    let energy = |x: f64| format!("{:.3e} {}", units.of_si(Quantity::Energy, x), units.name(Quantity::Energy));
    let share = work_error.abs();
    let is = if work_error > 0.0 { "too large" } else { "too small" };
    let work = format!(
        "the work of friction, {}, is {is} by about {:.0} % of it, which the increments do: {} is the better value; four times as many \
         would leave about {:.0} %",
        energy(friction_work),
        100.0 * share,
        energy(friction_work_corrected),
        25.0 * share
    );
    let work = (share > WORK).then_some(Warning { kind: WarningKind::IncrementsWork, message: work });
    let few = fewest.filter(|fewest| *fewest <= FEW).map(|fewest| {
        let increments = if fewest == 1 { "a single increment".to_string() } else { format!("{fewest} increments") };
        format!(
            "nodes begin to stick while loads go one way in {increments}: so few cannot tell what they leave in the tangential \
             forces; take {ENOUGH} or more, or let {COMPANION} tell it by a second run"
        )
    });
    let force = force_error.filter(|error| *error > FORCE).map(|error| {
        format!(
            "{increments} increments leave about {:.0} % in the tangential forces, by a rough estimate: take {:.0} for {:.0} %; {COMPANION} tells \
             it better, by a second run",
            100.0 * error,
            (increments as f64 * error / GOOD).ceil(),
            100.0 * GOOD
        )
    });
    let force = few.or(force).map(|message| Warning { kind: WarningKind::IncrementsForce, message });
    work.into_iter().chain(force).collect()
}
