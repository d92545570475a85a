//! How many increments leave a given error.

use super::companion::{equal_parts, shortest_stretch};
use super::discretise::for_run;
use super::{Run, RunError};
use crate::body::model::Model;
use crate::run::report::ChosenIncrements;
use crate::scene::{Override, Scene};
use crate::solver::history::Observer;
use crate::solver::newton::IterationRecord;
use std::ops::ControlFlow;

/// A first run has so many increments in the shortest stretch of a history in which everything goes on in one direction.
const FIRST: usize = 8;

/// So many times the increments that would do if errors were proportional to their length.
const ON_THE_SAFE_SIDE: f64 = 1.3;

/// The equal increments of `scene` that leave a share `asked` of error in the tangential forces, by a first run with a companion.
/// Corners of the loads lie between equal increments, where few can do that, and are further ends otherwise. `prepare` sees the model before anything is solved; `observer` sees iterations, and may stop the run.
///
/// # Errors
/// As [`Run::new`] and [`Run::solve`], and where there would be more increments than a scene may have.
pub fn increments_for(
    scene: &Scene,
    asked: f64,
    prepare: impl FnOnce(&Model),
    observer: &mut dyn Observer,
) -> Result<ChosenIncrements, RunError> {
    let model = for_run(scene)?;
    prepare(&model);
    let kinks = model.loading.kinks();
    drop(model);
    let (parts, shortest) = equal_parts(scene.time.end, &kinks);
    let tried = parts * FIRST.div_ceil(shortest);
    let first = scene.with(&[Override::value("time.increments", tried as i64)])?;
    let report = Run::new(&first)?.with_companion().solve(&mut OnlyIterations(observer))?;
    let error = report.estimates.force_error();
    // A stretch that is shorter than an increment has one all the same: only increments that are shorter than it divide it.
    let dividing = (tried as f64).max(scene.time.end / shortest_stretch(scene.time.end, &kinks));
    let needed = |error: f64| {
        let increments = ON_THE_SAFE_SIDE * dividing * error / asked;
        parts * (increments / parts as f64).ceil() as usize
    };
    let increments = error.filter(|error| *error > asked).map_or(tried, |error| needed(error).max(tried));
    Ok(ChosenIncrements { asked, tried, error, increments })
}

/// Passes on iterations, and nothing else.
struct OnlyIterations<'a>(&'a mut dyn Observer);

impl Observer for OnlyIterations<'_> {
    fn waits_for(&mut self, _index: usize) -> bool {
        false
    }

    fn iteration(&mut self, index: usize, record: &IterationRecord) -> ControlFlow<()> {
        self.0.iteration(index, record)
    }
}
