//! The loop of a study: what is refined next, and when it ends.

use std::time::Instant;

use super::extrapolation::{Behaviour, Limit, is_singular, limit};
use super::{Ladder, Verdict};
use crate::study::StudyError;
use stickslip::solver::history::Status;

/// Meshes with known values before a quantity counts as known.
const MESHES: usize = 3;

/// Meshes whose values grow without a limit before a peak counts as singular. An edge that is rounded looks singular as
/// long as elements are larger than its radius. If the run itself sees a singular edge, three are enough.
const GROWING: usize = 4;

/// The order below which an edge that the run calls singular is so.
const SINGULAR_ORDER: f64 = 0.5;

/// A peak is erratic if each of the last four changes is at least the first share of the one before, and the last one at
/// least the second share of the value.
const ERRATIC_FALL: f64 = 0.7;
const ERRATIC: f64 = 0.2;

/// The exponent by which the time grows with the number of elements: its range, and its value before it is measured.
const GROWTH_OF_TIME: [f64; 3] = [1.0, 1.5, 2.5];

/// The aim and the limits of a study.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// The share to which the quantity is to be known.
    pub to: f64,
    /// The largest number of runs.
    pub most_runs: usize,
    /// The largest time, s.
    pub within: f64,
}

/// A run of a study.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Step {
    /// The level of the mesh.
    pub level: usize,
    /// The name of the mesh.
    pub mesh: String,
    /// `true` if the mesh is the scene's own.
    pub is_own_mesh: bool,
    /// The number of elements.
    pub elements: usize,
    /// The size of the elements, relative to one that all meshes have in common.
    pub size: f64,
    /// The dimension of the mesh.
    pub dimension: usize,
    /// The number of increments.
    pub increments: usize,
    /// The value, SI; `None` if the run has none.
    pub value: Option<f64>,
    /// The errors of the value by rounding to whole elements, and to whole increments.
    pub rounding: [f64; 2],
    /// `true` if the contact has enough nodes across.
    pub is_resolved: bool,
    /// The reason why the value is never known, if the run tells one: a singular peak, or a warning.
    pub doubt: Option<Verdict>,
    /// `true` if the value depends on the increments.
    pub follows_path: bool,
    /// The end of the study and its reason, if the run did not converge.
    pub failure: Option<(Verdict, String)>,
    /// Wall time, s.
    pub seconds: f64,
}

/// The errors of the last run of a study.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// The limit for ever finer meshes.
    pub mesh: Option<Limit>,
    /// The limit for ever more increments; `None` if the value does not depend on them, or they were not refined.
    pub increments: Option<Limit>,
    /// `true` if the value depends on the increments.
    pub follows_path: bool,
    /// The errors by rounding to whole elements, and to whole increments.
    pub rounding: [f64; 2],
    /// The value of the last run.
    pub value: f64,
}

impl Errors {
    /// Returns the uncertainty of the mesh as a share of the value.
    pub fn of_mesh(&self) -> Option<f64> {
        self.share(self.mesh?.uncertainty.max(self.rounding[0]))
    }

    /// Returns the uncertainty of the increments as a share of the value; 0 if it does not depend on them, `None` if it is
    /// unknown.
    pub fn of_increments(&self) -> Option<f64> {
        let unknown = if self.follows_path { None } else { Some(0.0) };
        self.increments.map_or(unknown, |limit| self.share(limit.uncertainty.max(self.rounding[1])))
    }

    /// Returns the uncertainty of the value as a share.
    pub fn total(&self) -> Option<f64> {
        Some(self.of_mesh()? + self.of_increments()?)
    }

    /// Returns the value for ever finer meshes and ever more increments.
    pub fn extrapolated(&self) -> f64 {
        let steps = self.mesh.iter().chain(&self.increments).map(|limit| limit.extrapolated - self.value);
        self.value + steps.sum::<f64>()
    }

    fn share(&self, uncertainty: f64) -> Option<f64> {
        if uncertainty == 0.0 { Some(0.0) } else { Some(uncertainty / self.value.abs()).filter(|x| x.is_finite()) }
    }
}

/// The end of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyResult {
    /// The verdict.
    pub verdict: Verdict,
    /// The reason why a run or the study ended early; empty otherwise.
    pub reason: String,
    /// The runs, in order.
    pub steps: Vec<Step>,
    /// The estimated errors of the last run; `None` for fewer than two runs.
    pub errors: Option<Errors>,
    /// The predicted time of the next run, s, if it is the reason for the end.
    pub predicted: Option<f64>,
}

/// The part of a run that is refined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Refined {
    Mesh,
    Increments,
}

/// The values that count for one kind of refinement, coarse to fine, all at the last level of the other kind.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Series {
    /// Element sizes, or lengths of increments, relative.
    pub sizes: Vec<f64>,
    /// Values.
    pub values: Vec<f64>,
    /// The steps that refined so.
    pub steps: Vec<usize>,
}

/// Returns the series of the steps that refined the mesh, or the increments. It ends at the first step, from the last
/// one on, without a value, or with `resolved` at the first one with too few nodes across.
pub(super) fn series(steps: &[Step], of_mesh: bool, resolved: bool) -> Series {
    let mut series = Series::default();
    let usable = |step: &Step| step.value.filter(|_| !resolved || step.is_resolved);
    let Some(last) = steps.len().checked_sub(1) else { return series };
    let Some(mut value) = usable(&steps[last]) else { return series };
    let size = |step: &Step| if of_mesh { step.size } else { 1.0 / step.increments as f64 };
    let mut points = vec![(size(&steps[last]), value, last)];
    for (k, pair) in steps.windows(2).enumerate().rev() {
        let (Some(before), Some(after)) = (usable(&pair[0]), usable(&pair[1])) else { break };
        if (pair[0].level == pair[1].level) == of_mesh {
            // The step before refined the other kind: it is an earlier run of the same level.
            points.last_mut().into_iter().for_each(|(_, _, step)| *step = k);
            continue;
        }
        value -= after - before;
        points.push((size(&pair[0]), value, k));
    }
    for (size, value, step) in points.into_iter().rev() {
        series.sizes.push(size);
        series.values.push(value);
        series.steps.push(step);
    }
    series
}

/// Solves, after the steps so far, with these levels of mesh and increments.
type Solve<'a> = dyn FnMut(&[Step], usize, usize) -> Result<Step, StudyError> + 'a;

/// Refines until the value is known, calling `solve` with the steps so far and the levels of mesh and increments.
pub(super) fn refine(
    ladder: &Ladder,
    limits: Limits,
    may_be_singular: bool,
    solve: &mut Solve<'_>,
) -> Result<StudyResult, StudyError> {
    let start = Instant::now();
    let (mut mesh, mut increments) = (0, 0);
    let mut steps: Vec<Step> = Vec::new();
    let mut predicted = None;
    let (verdict, reason) = loop {
        match solve(&steps, mesh, increments) {
            Ok(step) => steps.push(step),
            Err(StudyError::Run(error)) if !error.is_of_the_input() && !steps.is_empty() => {
                break (Verdict::MemoryLimit, error.to_string());
            }
            Err(error @ StudyError::NoValue { .. }) if steps.iter().any(|step| step.value.is_some()) => {
                break (Verdict::NoFinerMesh, error.to_string());
            }
            Err(error @ StudyError::NotRefined(_)) if !steps.is_empty() => {
                let is_interrupted = matches!(error, StudyError::NotRefined(Status::Interrupted));
                let verdict = if is_interrupted { Verdict::Interrupted } else { Verdict::NoFinerMesh };
                break (verdict, error.to_string());
            }
            Err(error) => return Err(error),
        }
        if let Some(failure) = steps.last().and_then(|step| step.failure.clone()) {
            // The runs before one that was interrupted tell what is known.
            if failure.0 == Verdict::Interrupted && steps.len() > 1 {
                steps.pop();
            }
            break failure;
        }
        let found = errors(&steps);
        if is_known(&steps, found.as_ref(), limits.to) {
            let doubt = steps.last().and_then(|step| step.doubt);
            break (doubt.unwrap_or(Verdict::Known), String::new());
        }
        if may_be_singular && grows(&steps) {
            break (Verdict::Singular, String::new());
        }
        if steps.len() >= limits.most_runs {
            break (Verdict::RunLimit, String::new());
        }
        let next = next(&steps, found.as_ref(), limits.to);
        let last_mesh = ladder.meshes().is_some_and(|number| mesh + 1 >= number);
        let growth = match next {
            Refined::Mesh if last_mesh => break (Verdict::NoFinerMesh, "no finer mesh is named (--meshes)".into()),
            Refined::Mesh => ladder.growth(mesh),
            Refined::Increments => None,
        };
        let seconds = predict(&steps, next, growth);
        if start.elapsed().as_secs_f64() + seconds.unwrap_or(0.0) > limits.within {
            predicted = seconds;
            break (Verdict::TimeLimit, String::new());
        }
        match next {
            Refined::Mesh => mesh += 1,
            Refined::Increments => increments += 1,
        }
    };
    let errors = errors(&steps);
    Ok(StudyResult { verdict, reason, steps, errors, predicted })
}

/// Returns the errors of the last run; `None` without a value.
fn errors(steps: &[Step]) -> Option<Errors> {
    let last = steps.last()?;
    let value = last.value?;
    let of = |of_mesh: bool, resolved: bool| {
        let Series { sizes, values, .. } = series(steps, of_mesh, resolved);
        limit(&sizes, &values)
    };
    let increments = if last.follows_path { of(false, false) } else { None };
    let mesh = of(true, true);
    Some(Errors { mesh, increments, follows_path: last.follows_path, rounding: last.rounding, value })
}

fn is_known(steps: &[Step], errors: Option<&Errors>, to: f64) -> bool {
    let Some(total) = errors.and_then(Errors::total) else { return false };
    let follows_path = steps.last().is_some_and(|step| step.follows_path);
    let enough = series(steps, true, true).values.len() >= MESHES
        && (!follows_path || errors.is_some_and(|errors| errors.increments.is_some()));
    enough && total <= to
}

/// Returns `true` if the peak is singular.
fn grows(steps: &[Step]) -> bool {
    if is_erratic(steps) {
        return true;
    }
    let Series { sizes, values, steps: at } = series(steps, true, true);
    let n = values.len();
    if n >= GROWING && is_singular(&sizes, &values) && is_singular(&sizes[..n - 1], &values[..n - 1]) {
        return true;
    }
    let flagged = n >= MESHES && at[n - 2..].iter().all(|&k| steps[k].doubt == Some(Verdict::Singular));
    flagged
        && values[n - 1] > values[n - 2]
        && limit(&sizes, &values).is_some_and(|limit| {
            limit.behaviour == Behaviour::Growing || limit.order.is_some_and(|order| order < SINGULAR_ORDER)
        })
}

/// Returns `true` if the changes of the peak do not fall on ever finer meshes, as elements of second order let it at a sharp
/// edge. Where no mesh has enough nodes across, the contact is only narrow.
fn is_erratic(steps: &[Step]) -> bool {
    let Series { values, steps: at, .. } = series(steps, true, false);
    let n = values.len();
    if n <= GROWING || at[n - GROWING..].iter().filter(|&&k| steps[k].is_resolved).count() < 2 {
        return false;
    }
    let changes: Vec<f64> = values[n - GROWING - 1..].windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    let last = changes[changes.len() - 1];
    changes.windows(2).all(|pair| pair[1] >= ERRATIC_FALL * pair[0]) && last >= ERRATIC * values[n - 1].abs()
}

/// Returns what to refine: first both until each has an error, then the one with the larger error. The mesh it is, too, if
/// both errors are small enough, but of too few meshes.
fn next(steps: &[Step], errors: Option<&Errors>, to: f64) -> Refined {
    let follows_path = steps.last().is_some_and(|step| step.follows_path);
    let number = |of_mesh, resolved| series(steps, of_mesh, resolved).values.len();
    let (meshes, increments) = (number(true, true), number(false, false));
    if !follows_path || meshes < 2 {
        return Refined::Mesh;
    }
    if increments < 2 {
        return Refined::Increments;
    }
    let shares = errors.and_then(|errors| Some([errors.of_mesh()?, errors.of_increments()?]));
    match shares {
        Some([of_mesh, of_increments]) if of_increments > of_mesh.max(to - of_mesh) => Refined::Increments,
        _ => Refined::Mesh,
    }
}

/// Returns the expected time of the next run, s, from the last ones. `growth` is the factor of the elements along an
/// axis; without it a finer mesh has no prediction.
fn predict(steps: &[Step], next: Refined, growth: Option<f64>) -> Option<f64> {
    let last = steps.last()?;
    if next == Refined::Increments {
        return Some(2.0 * last.seconds);
    }
    let cost = |run: &Step| run.seconds / run.increments as f64;
    let before = steps.iter().rev().find(|run| run.size > last.size);
    let measured = before.map(|run| (cost(last) / cost(run)).ln() / (last.elements as f64 / run.elements as f64).ln());
    let [least, usual, most] = GROWTH_OF_TIME;
    let exponent = measured.filter(|exponent| exponent.is_finite()).unwrap_or(usual).clamp(least, most);
    Some(last.seconds * growth?.powi(last.dimension as i32).powf(exponent))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use stickslip::scene::Scene;

    /// Refines a manufactured value of the element size h and the length of increments k, both halved each time.
    fn study(to: f64, value: impl Fn(f64, f64) -> f64, more: impl Fn(&mut Step, f64)) -> StudyResult {
        let text = include_str!("../../../../data/scenes/block.toml");
        let overrides = ["mesh.elements=[8,8]".parse().unwrap(), "time.increments=8".parse().unwrap()];
        let ladder = Ladder::new(&Scene::parse("block.toml", text, &overrides).unwrap(), &[], 2.0).unwrap();
        let limits = Limits { to, most_runs: 12, within: 1e9 };
        refine(&ladder, limits, true, &mut |_, mesh, level| {
            let [h, k] = [mesh, level].map(|level| 0.5_f64.powi(level as i32));
            let mut run = Step {
                level: mesh,
                elements: 4 << (2 * mesh),
                size: h,
                dimension: 2,
                increments: ladder.increments(level),
                value: Some(value(h, k)),
                is_resolved: true,
                follows_path: true,
                seconds: 1.0,
                ..Step::default()
            };
            more(&mut run, h);
            Ok(run)
        })
        .unwrap()
    }

    /// The error that is told is never below the true one, of mesh and increments together.
    #[test]
    fn both_errors_are_found() {
        for (p, c, d) in [(1.0, 0.1, 0.01), (2.0, 0.3, 0.2), (1.0, 0.01, 0.4), (0.5, 0.02, -0.1), (1.5, 0.2, 0.0)] {
            let result = study(0.02, |h, k| 5.0 * (1.0 + c * h.powf(p) + d * k), |_, _| ());
            assert_eq!(result.verdict, Verdict::Known, "{p} {c} {d}: {result:?}");
            let errors = result.errors.unwrap();
            let truth = (errors.value / 5.0 - 1.0).abs();
            let total = errors.total().unwrap();
            assert!(total <= 0.02 && truth <= total, "{p} {c} {d}: {truth} {total}");
            // Errors of opposite signs cancel in the value, but not in the uncertainty.
            assert!(c * d < 0.0 || total < 3.0 * truth, "{p} {c} {d}: {truth} {total}");
            let mesh = errors.mesh.unwrap();
            assert!((mesh.order.unwrap() - p).abs() < 0.01, "{mesh:?}");
        }
    }

    /// More increments do not take the place of a third mesh, and a time is not known better than to its increment.
    #[test]
    fn small_errors_lead_to_a_third_mesh_and_whole_increments_count() {
        let result = study(0.02, |h, k| 1.0 + 1e-4 * h + 3e-3 * k, |_, _| ());
        assert_eq!(result.verdict, Verdict::Known);
        let increments: Vec<usize> = result.steps.iter().map(|step| step.increments).collect();
        assert_eq!((increments, result.steps[3].level), (vec![4, 4, 8, 8], 2));
        let result = study(0.02, |_, _| 1.0, |run, _| run.rounding = [0.0, 1.0 / run.increments as f64]);
        assert_eq!((result.verdict, result.steps[result.steps.len() - 1].increments), (Verdict::Known, 64));
        assert_eq!(result.errors.unwrap().of_increments(), Some(1.0 / 64.0));
    }

    #[test]
    fn without_a_path_only_the_mesh_is_refined() {
        let result = study(0.02, |h, _| 1.0 + 0.2 * h * h, |run, _| run.follows_path = false);
        let increments: Vec<usize> = result.steps.iter().map(|step| step.increments).collect();
        assert_eq!((result.verdict, increments), (Verdict::Known, vec![4; 3]));
        assert_eq!(result.errors.unwrap().increments, None);
    }

    /// Four meshes show a singular peak, three if the run sees it as well.
    #[test]
    fn singular_peaks_end_the_study() {
        for (seen, meshes) in [(false, 4), (true, 3)] {
            let result = study(0.02, |h, _| h.powf(-0.5), |run, _| run.doubt = seen.then_some(Verdict::Singular));
            assert_eq!(result.verdict, Verdict::Singular, "{result:?}");
            assert_eq!(result.steps.last().unwrap().level + 1, meshes);
        }
        // Elements of second order: up and down.
        let erratic = |h: f64, _: f64| if (1.0 / h).log2() as i32 % 2 == 0 { 370.0 } else { 3250.0 } / h.sqrt();
        let result = study(0.02, erratic, |run, h| run.is_resolved = (1.0 / h).log2() as i32 % 2 == 0);
        assert_eq!((result.verdict, result.steps.last().unwrap().level), (Verdict::Singular, 4));
        // A contact of one node on all meshes.
        let narrow = study(0.02, |h, _| 1.0 / h, |run, _| run.is_resolved = false);
        assert_eq!(narrow.verdict, Verdict::RunLimit);
        // A rounded edge: the growth ends.
        let rounded = |h: f64, _: f64| (h + 0.2).powf(-0.5);
        assert_eq!(study(0.05, rounded, |_, _| ()).verdict, Verdict::Known);
    }

    #[test]
    fn coarse_meshes_and_failed_runs_do_not_count() {
        // Two meshes with garbage are left out.
        let value = |h: f64, _: f64| if h > 0.4 { 100.0 * h } else { 1.0 + 0.1 * h };
        let result = study(0.02, value, |run, h| run.is_resolved = h < 0.4);
        assert_eq!(result.verdict, Verdict::Known);
        assert!((result.errors.unwrap().extrapolated() - 1.0).abs() < 1e-6);
        let result = study(
            0.02,
            |h, _| 1.0 + h,
            |run, h| {
                run.failure = (h < 0.6).then(|| (Verdict::NotConverged, "no equilibrium".into()));
            },
        );
        assert_eq!((result.verdict, result.steps.len()), (Verdict::NotConverged, 2));
        let stopped = |run: &mut Step, h: f64| {
            run.failure = (h < 0.3).then(|| (Verdict::Interrupted, "interrupted".into()));
        };
        let result = study(1e-6, |h, _| 1.0 + 0.1 * h, stopped);
        assert_eq!((result.verdict, result.steps.last().unwrap().level), (Verdict::Interrupted, 1));
        assert!(result.errors.unwrap().of_mesh().is_some());
    }

    #[test]
    fn limits_end_the_study() {
        let slow = |h: f64, _: f64| 1.0 + h.sqrt();
        assert_eq!(study(1e-6, slow, |_, _| ()).verdict, Verdict::RunLimit);
        let result = study(1e-6, slow, |run, h| run.seconds = 1e6 / (h * h));
        assert_eq!(result.verdict, Verdict::TimeLimit);
        assert!(result.predicted.unwrap() > 1e9);
    }
}
