//! What increments leave, as a warning.

use super::warnings::{Warning, WarningKind};
use crate::base::units::{Quantity, UnitSystem};
use crate::solver::history::IncrementError;

/// A larger share of the work of friction that is due to the increments is told.
const WORK: f64 = 0.1;

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

/// The error estimates of the increments of a run.
pub(super) struct Known<'a> {
    /// The estimate by the run itself.
    pub found: Option<&'a IncrementError>,
    /// The error of the tangential forces by a second run, and its increments.
    pub companion: Option<(f64, usize)>,
    /// The error of the friction forces by loads at t = 0, see [`crate::run`].
    pub start: Option<f64>,
    /// The increments of the run.
    pub increments: usize,
}

/// The warnings that follow.
pub(super) fn warnings(known: &Known<'_>, units: &UnitSystem) -> Vec<Warning> {
    let work = known.found.filter(|found| found.work_error.abs() > WORK).map(|found| work(found, units));
    let force = known.start.filter(|error| *error > FORCE).map(of_start).or_else(|| known.force());
    let force = force.map(|message| Warning { kind: WarningKind::IncrementsForce, message });
    work.into_iter().chain(force).collect()
}

fn work(found: &IncrementError, units: &UnitSystem) -> Warning {
    let energy = |x: f64| format!("{:.3e} {}", units.of_si(Quantity::Energy, x), units.name(Quantity::Energy));
    let share = found.work_error.abs();
    let is = if found.work_error > 0.0 { "too large" } else { "too small" };
    let message = format!(
        "the work of friction, {}, is {is} by about {:.0} % of it, which the increments do: {} is the better value; four times as many \
         would leave about {:.0} %",
        energy(found.friction_work),
        100.0 * share,
        energy(found.friction_work_corrected),
        25.0 * share
    );
    Warning { kind: WarningKind::IncrementsWork, message }
}

/// That what is there at t = 0 comes with the first increment.
fn of_start(error: f64) -> String {
    format!(
        "loads or interference are there at t = 0, and the first increment takes them together with what changes in it: friction is {:.0} % of what \
         contact can bear off from there on. Begin with a stage that holds what is there, as in history = [[0, 1], [1, 1], [2, 0]], or let it grow from 0",
        100.0 * error
    )
}

impl Known<'_> {
    /// That the increments change the tangential forces much, or are too few to tell. A second run is believed before the run itself. Where no node
    /// begins to stick on the way the forces are exact.
    fn force(&self) -> Option<String> {
        let increments = self.increments;
        let enough = |error: f64| (increments as f64 * error / GOOD).ceil();
        if let Some((error, others)) = self.companion {
            return (error > FORCE).then(|| {
                format!(
                    "{increments} increments leave about {:.0} % in the tangential forces, by a run with {others}: take {:.0} for {:.0} %",
                    100.0 * error,
                    enough(error),
                    100.0 * GOOD
                )
            });
        }
        let found = self.found.filter(|found| found.sticking_begins > 0)?;
        if let Some(fewest) = found.fewest.filter(|fewest| *fewest <= FEW) {
            let increments =
                if fewest == 1 { "a single increment".to_string() } else { format!("{fewest} increments") };
            return Some(format!(
                "nodes begin to stick while loads go one way in {increments}: so few cannot tell what they leave in the tangential \
                 forces; take {ENOUGH} or more, or let {COMPANION} tell it by a second run"
            ));
        }
        found.force_error.filter(|error| *error > FORCE).map(|error| {
            format!(
                "{increments} increments leave about {:.0} % in the tangential forces, by a rough estimate: take {:.0} for {:.0} %; {COMPANION} \
                 tells it better, by a second run",
                100.0 * error,
                enough(error),
                100.0 * GOOD
            )
        })
    }
}
