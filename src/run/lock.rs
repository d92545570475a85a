//! Pretensions that lock: the shortening stays as the force made it.
//!
//! A model holds a displacement in all increments or in none, so that its pattern is fixed. The history until the lock is
//! therefore solved first with the force. The shortenings at the ends of its increments are prescribed in the actual run,
//! which then has the same states until the lock.

use std::borrow::Cow;
use std::ops::ControlFlow;

use super::{Run, RunError};
use crate::base::timeline::ends_until;
use crate::body::description::{Pretension, Tightening};
use crate::body::model::Model;
use crate::scene::Scene;
use crate::solver::history::{IncrementView, Observer, Status};

/// Returns the name of a pretension of `model` that is still to be locked.
pub(super) fn unlocked(model: &Model) -> Option<&str> {
    let open = model.description().pretensions.iter().find(|pretension| pretension.lock.is_some());
    open.map(|pretension| pretension.name.as_str())
}

/// Returns `scene` with prescribed shortenings for the pretensions that lock; `tightening` makes the model before. If the history until a lock does not
/// converge, the pretension keeps its force, and the run will end there, too.
///
/// # Errors
/// As [`super::discretise`], and when the linear algebra cannot go on.
pub(super) fn locked(
    scene: &Scene,
    tightening: impl Fn(&Scene) -> Result<Model, RunError>,
) -> Result<Cow<'_, Scene>, RunError> {
    let mut scene = Cow::Borrowed(scene);
    let lock = |given: &Pretension| given.lock;
    while let Some(first) = scene.description.pretensions.iter().filter_map(lock).min_by(f64::total_cmp) {
        let mut free = scene.clone().into_owned();
        for pretension in &mut free.description.pretensions {
            pretension.lock = None;
        }
        let model = tightening(&free)?;
        let times = model.times()[..ends_until(model.times(), first)].to_vec();
        let mut watch = Watch { model: &model, points: vec![vec![[0.0; 2]]; free.description.pretensions.len()] };
        let report = Run::of(&model, times, free.solver)?.solve(&mut watch)?;
        let Watch { points, .. } = watch;
        if report.status != Status::Converged {
            return Ok(Cow::Owned(free));
        }
        let own = scene.to_mut().description.pretensions.iter_mut().zip(points);
        for (pretension, points) in own.filter(|(pretension, _)| pretension.lock == Some(first)) {
            *pretension = Pretension {
                tightening: Tightening::Shortening(1.0),
                history: Some(points),
                lock: None,
                ..pretension.clone()
            };
        }
    }
    Ok(scene)
}

/// Collects points `[time (s), shortening (m)]` of each pretension.
struct Watch<'a> {
    model: &'a Model,
    points: Vec<Vec<[f64; 2]>>,
}

impl Observer for Watch<'_> {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        let time = step.record.time;
        for (points, shortening) in self.points.iter_mut().zip(self.model.shortenings(time, step.state)) {
            points.push([time, shortening]);
        }
        ControlFlow::Continue(())
    }
}
