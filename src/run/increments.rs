//! Chooses the number of increments for a given error.

use super::companion::{equal_parts, shortest_stretch};
use super::discretise::for_run;
use super::{Run, RunError};
use crate::body::model::Model;
use crate::run::report::ChosenIncrements;
use crate::scene::{Override, Scene};
use crate::solver::history::Observer;
use crate::solver::newton::IterationRecord;
use std::ops::ControlFlow;

/// The number of increments of a first run in the shortest load segment.
const FIRST: usize = 8;

/// The safety factor of the number of increments, because errors are only roughly proportional to their length.
const ON_THE_SAFE_SIDE: f64 = 1.3;

/// Returns the equal increments of `scene` for a share `asked` of error in the tangential forces, estimated by a first
/// run with a companion. Kinks of the loads coincide with ends of equal increments if few suffice for that, and are
/// additional ends otherwise. `prepare` sees the model before anything is solved. `observer` sees iterations, and may
/// stop the run.
///
/// # Errors
/// As [`Run::new`] and [`Run::solve`], and when more increments would be needed than a scene may have.
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
    let mut first = scene.with(&[Override::value("time.increments", tried as i64)])?;
    // A mesh that was put in place of that of the text stays.
    first.description.mesh = scene.description.mesh.clone();
    let report = Run::new(&first)?.with_companion().solve(&mut OnlyIterations(observer))?;
    let error = report.estimates.force_error();
    // A segment shorter than an increment still has one increment, and is divided only by increments shorter than
    // itself.
    let dividing = (tried as f64).max(scene.time.end / shortest_stretch(scene.time.end, &kinks));
    let needed = |error: f64| {
        let increments = ON_THE_SAFE_SIDE * dividing * error / asked;
        parts * (increments / parts as f64).ceil() as usize
    };
    let increments = error.filter(|error| *error > asked).map_or(tried, |error| needed(error).max(tried));
    Ok(ChosenIncrements { asked, tried, error, increments })
}

/// An observer that passes on iterations only.
struct OnlyIterations<'a>(&'a mut dyn Observer);

impl Observer for OnlyIterations<'_> {
    fn iteration(&mut self, index: usize, record: &IterationRecord) -> ControlFlow<()> {
        self.0.iteration(index, record)
    }
}
