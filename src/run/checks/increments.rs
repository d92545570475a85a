//! Warnings of time-step errors.

use super::prelude::*;
use crate::base::units::UnitSystem;
use crate::solver::history::IncrementError;

kinds! {
    /// The time-step error of tangential forces is above 5 %; or loads or interference at t = 0 change friction by more
    /// than 5 % of its limit; or nodes begin to stick in at most 3 increments of a load direction, too few for an estimate.
    INCREMENTS_FORCE("increments-force", "More increments; a constant first stage.", "tangential forces do not matter");
    /// More than 10 % of the friction work is due to increments.
    INCREMENTS_WORK("increments-work", "More increments, or the corrected value; loads that grow from 0; interference that is fitted without friction.",
        "the work does not matter");
}

/// The error of the friction work above which a warning is given, as a share.
const WORK: f64 = 0.1;

/// The error of the tangential forces above which a warning is given.
const FORCE: f64 = 0.05;

/// The error for which the suggested number of increments is calculated.
const GOOD: f64 = 0.02;

/// No estimate is possible with at most this number of increments in a load segment in which nodes begin to stick.
const FEW: usize = 3;

/// The number suggested instead.
const ENOUGH: usize = 8;

/// Returns the warnings of time-step errors.
pub(super) fn warnings(solved: &Solved<'_>) -> Vec<Warning> {
    let Solved { model, estimates, .. } = solved;
    let found = estimates.increments.as_ref();
    let is_wrong = |found: &&IncrementError| {
        let work = found.friction_work.max(found.friction_work_corrected);
        found.work_error.abs() > WORK && work > estimates.negligible_work
    };
    let is_loaded = model.loading.is_present_at_start(model.problem.displacements());
    let work = found.filter(is_wrong).map(|found| work(found, is_loaded, &model.units()));
    let work = work.map(|message| WarningKind::INCREMENTS_WORK.warning(message));
    let force = estimates.start.filter(|error| *error > FORCE).map(of_start).or_else(|| force(solved));
    let force = force.map(|message| WarningKind::INCREMENTS_FORCE.warning(message));
    work.into_iter().chain(force).collect()
}

fn work(found: &IncrementError, is_loaded: bool, units: &UnitSystem) -> String {
    let IncrementError { friction_work, friction_work_corrected, .. } = *found;
    let [value, better] = [friction_work, friction_work_corrected].map(|x| units.rounded(Quantity::Energy, x, 4));
    if found.work_error.abs() > 1.0 {
        return format!(
            "the increments leave an error of more than 100 % of the friction work, {value}; take four times as many"
        );
    }
    // The first increment applies what exists at t = 0 at once, however short it is.
    let stays = if is_loaded { found.first_work_error } else { 0.0 };
    let cure = if stays.abs() > WORK {
        format!(
            "more increments leave {:+.0} %: let loads at t = 0 grow from 0; fit interference without \
             friction (contact.friction_history)",
            100.0 * stays
        )
    } else {
        let share = (stays + 0.25 * (found.work_error - stays)).abs();
        format!("four times as many increments would leave about {:.0} %", 100.0 * share)
    };
    format!(
        "the friction work, {value}, has an error of about {:+.0} % of this value because of the increments: {better} is \
         the better value; {cure}",
        100.0 * found.work_error
    )
}

/// Warns that the first increment applies the actions at t = 0 together with their changes.
fn of_start(error: f64) -> String {
    format!(
        "loads or interference exist at t = 0, and the first increment applies them together with later changes: \
         the friction error from there on is {:.0} % of the largest possible friction. Begin with a constant \
         stage, as in history = [[0, 1], [1, 1], [2, 0]], let loads grow from 0, or fit interference without friction \
         (contact.friction_history)",
        100.0 * error
    )
}

/// Warns if the time-step error of the tangential forces is large, or there are too few increments to estimate it. If no
/// node begins to stick during a load segment, the forces are exact.
fn force(Solved { estimates, outcome, .. }: &Solved<'_>) -> Option<String> {
    let found = estimates.increments.filter(|found| found.sticking_begins > 0)?;
    if let Some(fewest) = found.fewest.filter(|fewest| *fewest <= FEW) {
        let increments = if fewest == 1 { "a single increment".to_string() } else { format!("{fewest} increments") };
        return Some(format!(
            "nodes begin to stick while loads change in one direction for {increments}, too few to estimate the \
             time-step error of the tangential forces; take {ENOUGH} or more"
        ));
    }
    found.force_error.filter(|error| *error > FORCE).map(|error| {
        let increments = outcome.tally.increments;
        let more = (increments as f64 * error / GOOD).ceil();
        format!(
            "the tangential forces have a time-step error of roughly {:.0} % with {increments} increments; take \
             {more:.0} for {:.0} %",
            100.0 * error,
            100.0 * GOOD
        )
    })
}
