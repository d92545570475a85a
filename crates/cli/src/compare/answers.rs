//! Summarises a comparison: the fastest way to an error, BN against IP, growth with the mesh.

use super::{Comparison, MeshChoice, MeshResult, SolverPath, Trial, convergence};
use stickslip::base::Quantity;
use stickslip::solver::history::{Method, Start, Status};

/// The contact force errors for which the fastest run is reported.
const TARGETS: [f64; 2] = [1e-3, 1e-6];

/// Runs whose contact forces are so near to the reference agree.
const AGREEMENT: f64 = 1e-2;

/// Below this order, the error does not decrease with more increments, and no extrapolation is made.
const LEAST_ORDER: f64 = 0.25;

/// The extrapolated cost of an error that no run of a path reaches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The path.
    pub path: SolverPath,
    /// The order of convergence between its two finest runs.
    pub order: f64,
    /// The increments required at that order.
    pub increments: f64,
    /// The CPU time for these increments, s.
    pub seconds: f64,
}

/// BN against IP with one linear solver.
#[derive(Debug, Clone, PartialEq)]
pub struct Lead {
    /// BN with its setting and its linear solver, which are those of IP, too.
    pub bn: SolverPath,
    /// Each mesh with the ratio of the CPU times of IP and BN, over all histories that both completed.
    pub ratios: Vec<(MeshChoice, f64)>,
}

impl Comparison {
    /// Returns the fastest run on a mesh with a contact force error of at most `target`, among the `wanted` paths.
    pub fn cheapest<'a>(
        &'a self,
        mesh: &'a MeshChoice,
        target: f64,
        wanted: impl Fn(&SolverPath) -> bool,
    ) -> Option<&'a Trial> {
        let near = |run: &&Trial| run.errors.is_some_and(|errors| errors.forces <= target);
        let runs = self.on(mesh).filter(|run| wanted(&run.path)).filter(near);
        runs.min_by(|a, b| a.course.seconds.cpu.total_cmp(&b.course.seconds.cpu))
    }

    /// Returns the path that would be fastest for an error of `target` which no run on this mesh reaches, extrapolated
    /// from the two finest histories of each path.
    pub fn estimate(&self, mesh: &MeshChoice, target: f64) -> Option<Estimate> {
        let of = |path| {
            let runs: Vec<&Trial> = self.on(mesh).filter(|run| run.path == path && run.errors.is_some()).collect();
            let [.., coarse, fine] = runs[..] else { return None };
            let [before, after] = [coarse, fine].map(|run| run.errors.map_or(f64::NAN, |errors| errors.forces));
            let order = (before / after).ln() / (fine.increments as f64 / coarse.increments as f64).ln();
            let times = (after / target).powf(1.0 / order);
            let (increments, seconds) = (times * fine.increments as f64, times * fine.course.seconds.cpu);
            (order >= LEAST_ORDER).then_some(Estimate { path, order, increments, seconds })
        };
        self.paths().into_iter().filter_map(of).min_by(|a, b| a.seconds.total_cmp(&b.seconds))
    }

    /// Compares BN with IP for every linear solver and setting in which both were run.
    pub fn leads(&self) -> Vec<Lead> {
        let bn = self.paths().into_iter().filter(|path| path.method.name() == "bn");
        let lead = |bn: SolverPath| {
            let interior =
                if bn.method.increments().is_of_paper() { Method::paper_ip(Start::Safe) } else { Method::Ip };
            let ip = SolverPath { method: interior.into(), ..bn };
            let ratio = |result: &MeshResult| Some((result.mesh.clone(), self.ratio(&result.mesh, ip, bn)?));
            Lead { bn, ratios: self.meshes.iter().filter_map(ratio).collect() }
        };
        bn.map(lead).filter(|lead| !lead.ratios.is_empty()).collect()
    }

    /// Returns the ratio of the CPU times of paths `a` and `b`, over the histories on a mesh that both completed.
    fn ratio(&self, mesh: &MeshChoice, a: SolverPath, b: SolverPath) -> Option<f64> {
        let solved = |path| self.on(mesh).filter(move |run| run.path == path && run.course.status == Status::Converged);
        let partner = |run: &Trial| solved(b).find(|other| other.increments == run.increments);
        let pairs = solved(a).filter_map(|run| Some([run.course.seconds.cpu, partner(run)?.course.seconds.cpu]));
        let [of_a, of_b] = pairs.fold([0.0; 2], |sum, pair| [sum[0] + pair[0], sum[1] + pair[1]]);
        (of_b > 0.0).then_some(of_a / of_b)
    }

    /// Returns the exponent with which the CPU time of a path grows with the number of displacements, from the coarsest
    /// mesh to the finest, for the most increments.
    pub fn growth(&self, path: SolverPath) -> Option<f64> {
        let [coarsest, .., finest] = &self.meshes[..] else { return None };
        let most = self.runs.iter().map(|run| run.increments).max()?;
        let solved =
            |run: &&Trial| run.path == path && run.increments == most && run.course.status == Status::Converged;
        let seconds = |result: &MeshResult| Some(self.on(&result.mesh).find(solved)?.course.seconds.cpu);
        let size = finest.displacements as f64 / coarsest.displacements as f64;
        Some((seconds(finest)? / seconds(coarsest)?).ln() / size.ln())
    }

    /// Returns the summary in sentences: for several kinds of elements the fastest mesh, otherwise the fastest path.
    pub fn answers(&self) -> Vec<String> {
        if self.elements().len() > 1 {
            return convergence::answers(self);
        }
        let mut answers: Vec<String> = self.agreement().into_iter().collect();
        for result in &self.meshes {
            let found = TARGETS.map(|target| (target, self.about_target(&result.mesh, target)));
            // One sentence says both if the way to the smaller error is the cheapest to the larger one, too.
            let first = usize::from(found[0].1 == found[1].1);
            let head = |target| format!("Contact forces to {target:.0e}, {}:", result.mesh);
            answers.extend(found[first..].iter().map(|(target, way)| format!("{} {way}.", head(target))));
        }
        let leads = self.leads();
        answers.extend(leads.iter().filter(|lead| lead.bn.is_uncondensed()).map(Lead::sentence));
        let growth = |path| Some(format!("{path} {:.2}", self.growth(path)?));
        let growths: Vec<String> = self.paths().into_iter().filter_map(growth).collect();
        if !growths.is_empty() {
            answers.push(format!(
                "With the number of displacements n_u the CPU time grows like n_u to the power of: {}.",
                growths.join("; ")
            ));
        }
        answers
    }

    /// Tells whether all methods and solvers agree, on the finest mesh with the most increments.
    fn agreement(&self) -> Option<String> {
        let MeshResult { mesh, .. } = self.meshes.last()?;
        let most = self.on(mesh).map(|run| run.increments).max()?;
        let mut finest = self.on(mesh).filter(|run| run.increments == most);
        let error = finest.try_fold(self.tolerance, |error, run| Some(error.max(run.errors?.forces)));
        let verdict = match error {
            Some(error) if error <= AGREEMENT => {
                format!("agree: contact forces are within {error:.1e} of the reference")
            }
            Some(error) => format!("differ: contact forces are up to {error:.1e} off the reference"),
            None => "do not agree: not all of them, or not the reference, converged".to_string(),
        };
        Some(format!("All runs with {most} increments on {mesh} {verdict}."))
    }

    fn about_target(&self, mesh: &MeshChoice, target: f64) -> String {
        let two_digits = |x: f64| self.units.rounded(Quantity::Number, x, 2);
        let describe = |run: &Trial| {
            format!("{} with {} increments, {} s", run.path, run.increments, two_digits(run.course.seconds.cpu))
        };
        let Some(run) = self.cheapest(mesh, target, |_| true) else {
            let nearest = self.on(mesh).filter_map(|run| Some(run.errors?.forces)).fold(f64::INFINITY, f64::min);
            let said = if nearest.is_finite() {
                format!("no run comes so near, the best to {nearest:.1e}")
            } else {
                "there is nothing to compare with".to_string()
            };
            let most = self.on(mesh).map(|run| run.increments).max().unwrap_or(0) as f64;
            let near = self.estimate(mesh, target).filter(|estimate| estimate.increments <= FARTHEST * most);
            let estimate = near.map_or(String::new(), |estimate| {
                let Estimate { path, order, increments, seconds } = estimate;
                format!(
                    "; if its error keeps falling at order {order:.2}, {path} takes about {} increments and {} s",
                    two_digits(increments),
                    two_digits(seconds)
                )
            });
            return format!("{said}{estimate}");
        };
        let error = run.errors.map_or(f64::NAN, |errors| errors.forces.max(self.tolerance));
        let below = if error > self.tolerance { "" } else { "below " };
        let sentence = format!("the cheapest is {} (error {below}{error:.1e})", describe(run));
        match self.cheapest(mesh, target, SolverPath::is_uncondensed).filter(|_| !run.path.is_uncondensed()) {
            Some(uncondensed) => format!("{sentence}; on the uncondensed system {}", describe(uncondensed)),
            None => sentence,
        }
    }
}

/// Estimates for more increments than this, as a multiple of those that were tried, say nothing.
const FARTHEST: f64 = 1e3;

impl Lead {
    fn sentence(&self) -> String {
        let Lead { bn, ratios } = self;
        let (solver, setting) = (bn.solver_name(), bn.method.setting());
        let times: Vec<String> = ratios.iter().map(|(mesh, ratio)| format!("{ratio:.2} ({mesh})")).collect();
        format!("On {solver}, setting {setting}, IP takes {} times as long as BN.", times.join(", "))
    }
}
