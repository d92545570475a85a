//! Solves a scene on one mesh: its reference, and the histories measured against it.

use super::cell::{Cells, Solved};
use super::errors::{End, TimeErrors};
use super::{Course, Iterate, MeshChoice, MeshResult, Phases, SolverPath, Trial};
use std::ops::ControlFlow;
use std::time::Instant;
use stickslip::base::UnitSystem;
use stickslip::body::Model;
use stickslip::run::report::{EstimateWatch, thread_cpu_seconds};
use stickslip::run::{Run, RunError, discretise, expect_exact_path};
use stickslip::scene::{Override, Scene};
use stickslip::solver::IterationRecord;
use stickslip::solver::formulation::Layout;
use stickslip::solver::history::{HistoryMethod, IncrementView, Method, Observer, SolverChoice, Status};

/// Returns why the solution may not converge to the exact path for increasingly many increments. The exact path is known
/// only if nodes slide along lines and friction is constant. It applies the actions at t = 0 in proportion, while the
/// first increment, however short, applies them at once.
///
/// Where gaps change by motions the path follows chords of these, and is the reference only if `events` is compared.
fn against_exact_path(model: &Model, paths: &[SolverPath]) -> Option<&'static str> {
    let Model { problem, loading, .. } = model;
    let layout = Layout::new(problem);
    let moves = !loading.gap_corrections().is_empty() && !paths.iter().any(|path| path.method.is_exact_path());
    let reasons = [
        ((0..layout.contacts()).any(|i| layout.slides_in_a_plane(i)), "nodes slide in a plane"),
        (loading.gaps_at(0.0).iter().any(|gap| *gap < 0.0), "bodies overlap at t = 0"),
        (loading.cases().iter().any(|case| case.factor(0.0) != 0.0), "loads act at t = 0"),
        (loading.friction().is_some(), "friction changes in time"),
        (moves, "gaps change by motions, and the method events is not compared"),
    ];
    reasons.into_iter().find(|(holds, _)| *holds).map(|(_, reason)| reason)
}

/// A scene on one mesh.
struct Body {
    scene: Scene,
    model: Model,
    /// Wall and CPU time of building the model, s.
    built: [f64; 2],
    /// Returns `true` once no history is to be solved any more.
    stop: fn() -> bool,
}

/// A scene on one mesh, with its reference.
pub(super) struct Study {
    body: Body,
    pub result: MeshResult,
}

impl Study {
    /// Builds `scene` on `mesh` and solves its reference with this number of increments, unless `cells` has stored it.
    /// All `paths` must suit the scene.
    pub(super) fn new(
        scene: &Scene,
        mesh: MeshChoice,
        reference: usize,
        paths: &[SolverPath],
        cells: &dyn Cells,
        stop: fn() -> bool,
    ) -> Result<Self, RunError> {
        // The gaps of moving obstacles are exact at the ends of the increments of the reference, and so for all
        // histories whose increments are unions of these.
        let scene = scene.with(&mesh.overrides(&scene.description.mesh))?.with(&[increments_of(reference)])?;
        let (wall, cpu) = (Instant::now(), thread_cpu_seconds());
        let model = discretise(&scene)?;
        if paths.iter().any(|path| path.method.is_exact_path()) {
            expect_exact_path(&scene, &model)?;
        }
        let built = [wall.elapsed().as_secs_f64(), thread_cpu_seconds() - cpu];
        let body = Body { scene, model, built, stop };
        let (name, model) = (format!("{mesh}, reference, {reference}"), &body.model);
        let against = against_exact_path(model, paths);
        let reference = || body.reference(reference, against.is_none());
        let reference = Solved::stored_or(cells, &name, &model.problem, reference)?;
        let watch = reference.seen.and_then(|seen| seen.of(model));
        let estimates = watch.unwrap_or_else(|| EstimateWatch::new(model)).estimates(model);
        let result = MeshResult {
            mesh,
            displacements: model.problem.displacements(),
            contacts: model.problem.contacts(),
            increments: reference.increments,
            not_exact: against.unwrap_or("the exact path ends early"),
            status: reference.course.status,
            seconds: reference.course.seconds.cpu,
            end: End::new(model, &reference.state, reference.work),
            errors: None,
            estimates: (reference.course.status == Status::Converged).then_some(estimates),
        };
        Ok(Study { body, result })
    }

    /// Returns the units of the scene in the dimension of the mesh.
    pub(super) fn units(&self) -> UnitSystem {
        self.body.model.units()
    }

    /// Returns the history by `path` in this number of increments, solved unless `cells` has stored it.
    pub(super) fn run(&self, path: SolverPath, increments: usize, cells: &dyn Cells) -> Result<Trial, RunError> {
        let Study { body, result } = self;
        let (mesh, model) = (&result.mesh, &body.model);
        let solved = Solved::stored_or(cells, &format!("{mesh}, {path}, {increments}"), &model.problem, || {
            body.solve(path.solver(&body.scene.solver), increments, None)
        })?;
        let end = End::new(model, &solved.state, solved.work);
        let converged = solved.course.status == Status::Converged && result.status == Status::Converged;
        let errors = || TimeErrors::new(&end, &result.end, model.problem.weight().unwrap_or_default());
        let course = solved.course;
        Ok(Trial { path, mesh: mesh.clone(), increments, course, errors: converged.then(errors) })
    }
}

fn increments_of(number: usize) -> Override {
    Override::value("time.increments", number as i64)
}

impl Body {
    /// Solves the exact path; if it is unknown or ends early, solves this number of increments.
    fn reference(&self, increments: usize, has_path: bool) -> Result<Solved, RunError> {
        let Body { scene, model, .. } = self;
        let end = scene.time.all().last().copied();
        let by = |method: HistoryMethod, increments| {
            let last = LastIncrement { model, end, watch: EstimateWatch::new(model) };
            // The linear solver is the one that suits the sizes.
            self.solve(SolverChoice { method, linear: None, ..scene.solver }, increments, Some(last))
        };
        if has_path {
            let path = by(HistoryMethod::ExactPath, 1)?;
            if path.course.status == Status::Converged {
                return Ok(Solved { increments: 0, ..path });
            }
        }
        by(Method::BN.into(), increments)
    }

    fn solve(
        &self,
        solver: SolverChoice,
        increments: usize,
        last: Option<LastIncrement<'_>>,
    ) -> Result<Solved, RunError> {
        let Body { scene, model, built, stop } = self;
        let scene = scene.with(&[increments_of(increments)])?;
        let (wall, cpu) = (Instant::now(), thread_cpu_seconds());
        let mut recorder = Recorder { since: thread_cpu_seconds(), iterates: Vec::new(), last, stop: *stop };
        let outcome = Run::of(model, scene.time.all(), solver)?.history(&mut recorder)?;
        let (wall, cpu) = (wall.elapsed().as_secs_f64(), thread_cpu_seconds() - cpu);
        let linear = &outcome.linear;
        let [analysis, factor, solve] = [linear.analysis_seconds, linear.factor_seconds, linear.solve_seconds];
        let assembly: f64 = outcome.records.iter().map(|record| record.seconds.assembly).sum();
        let other = wall - analysis - assembly - factor - solve;
        let [wall, cpu] = [built[0] + wall, built[1] + cpu];
        let seconds = Phases { cpu, wall, model: built[0], analysis, assembly, factor, solve, rest: other };
        let records = &outcome.records;
        let course = Course {
            status: outcome.status,
            converged: outcome.tally.converged,
            iterations: outcome.tally.iterations,
            factorizations: linear.factorizations,
            seconds,
            factor_entries: linear.factor.entries,
            factor_peak_bytes: linear.factor.peak_bytes,
            kkt: records.iter().map(|record| record.kkt.worst().1).fold(0.0, f64::max),
            iterates: recorder.iterates,
        };
        let work = records.iter().map(|record| record.friction_work).sum();
        let watch = recorder.last.map(|last| last.watch);
        Ok(Solved { increments, course, state: outcome.state, work, seen: watch })
    }
}

impl SolverPath {
    /// Returns the solver with the tolerance and the iteration limit of the scene.
    fn solver(self, of_scene: &SolverChoice) -> SolverChoice {
        let SolverChoice { max_iterations, tolerance, .. } = *of_scene;
        let SolverPath { method, linear } = self;
        let tolerance = match method.increments() {
            paper @ Method::PaperIp { .. } => tolerance.max(paper.default_tolerance()),
            _ => tolerance,
        };
        SolverChoice { method, linear, max_iterations, tolerance }
    }
}

/// Observes only the end of a history, where errors are compared.
struct LastIncrement<'a> {
    model: &'a Model,
    /// The end of the history, s.
    end: Option<f64>,
    watch: EstimateWatch,
}

/// Records the iterations.
struct Recorder<'a> {
    /// The CPU time at the start of the increment, s.
    since: f64,
    iterates: Vec<Iterate>,
    last: Option<LastIncrement<'a>>,
    stop: fn() -> bool,
}

impl Observer for Recorder<'_> {
    fn iteration(&mut self, increment: usize, record: &IterationRecord) -> ControlFlow<()> {
        let begun = self.iterates.last().filter(|last| last.increment == increment).map(|last| last.iteration);
        if (self.stop)() {
            return ControlFlow::Break(());
        }
        if begun.is_none() {
            self.since = thread_cpu_seconds();
        }
        let iteration = match begun {
            // A further attempt at the increment starts where the last one is known to have failed.
            Some(_) if record.iteration == 0 => return ControlFlow::Continue(()),
            Some(last) => last + 1,
            None => record.iteration,
        };
        let seconds = thread_cpu_seconds() - self.since;
        self.iterates.push(Iterate { increment, iteration, seconds, theta: record.theta, error: record.error });
        ControlFlow::Continue(())
    }

    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        if let Some(last) = self.iterates.iter_mut().rfind(|last| last.increment == step.record.index) {
            last.error = Some(step.record.kkt.worst().1);
        }
        if let Some(LastIncrement { model, end, watch }) = &mut self.last
            && end.is_some_and(|end| step.record.time >= end)
        {
            watch.observe(model, step);
        }
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::super::MeshSize;
    use super::*;

    /// However many increments the scene itself has.
    #[test]
    fn moving_obstacles_are_where_the_reference_sees_them() {
        let text = include_str!("../../../../data/scenes/hertz_line.toml");
        let overrides = ["mesh.contact_elements=4", "mesh.outer_elements=4", "mesh.layers=4", "time.increments=1"];
        let moving = "contact.obstacle.motion.translation=[[0,0,0],[1,0.02,0]]";
        let overrides = overrides.into_iter().chain([moving]).map(|text| text.parse().unwrap()).collect::<Vec<_>>();
        let study = Study::new(
            &Scene::parse("roller.toml", text, &overrides).unwrap(),
            MeshSize::Elements(4).into(),
            8,
            &[],
            &(),
            || false,
        )
        .unwrap();
        let ends: Vec<f64> = (0..=8).map(|k| f64::from(k) / 8.0).collect();
        assert_eq!(study.body.model.loading.gap_corrections()[0].times(), ends);
    }
}
