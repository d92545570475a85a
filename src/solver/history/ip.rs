//! The paper's interior point method along a history, with its starting points.

use super::method::Start;
use super::saved::{Snapshot, take_over};
use super::settings::HistorySettings;
use super::task::{IncrementSolver, Observe, Task};
use crate::algebra::linear::{Computed, RefinedSolver, SystemMatrix};
use crate::solver::formulation::{Constrained, InteriorPoint, Pair, Partition, SlackLayout};
use crate::solver::newton::{Ip, IpSettings, MethodResult, Termination};
use crate::solver::problem::{ContactProblem, State};

/// The paper's interior point method with its starts in a history.
pub(super) struct IpMethod {
    formulation: Constrained,
    settings: IpSettings,
    start: Start,
    partition: Partition,
    ip: Ip,
    z: Vec<f64>,
}

impl IpMethod {
    pub(super) fn new(problem: &ContactProblem, history: &HistorySettings, start: Start, partition: Partition) -> Self {
        let formulation = Constrained::new(problem, history.scaling, &history.conventions, partition);
        let mut z = first_point(formulation.layout(), problem.weight().unwrap_or_default());
        if partition == Partition::Cone {
            enter_cone(formulation.layout(), formulation.mu(), &mut z);
        }
        let settings = IpSettings::paper(history.max_iterations);
        IpMethod { formulation, settings, start, partition, ip: Ip::default(), z }
    }

    fn move_to_safe_point(&mut self) {
        move_to_safe_point(self.formulation.layout(), &mut self.z);
        if self.partition == Partition::Cone {
            enter_cone(self.formulation.layout(), self.formulation.mu(), &mut self.z);
        }
    }

    fn iterate(
        &mut self,
        settings: &IpSettings,
        linear: &mut RefinedSolver,
        observe: Observe<'_>,
    ) -> Computed<MethodResult> {
        self.ip.solve(settings, &mut self.formulation, linear, &mut self.z, observe)
    }
}

impl IncrementSolver for IpMethod {
    fn matrix(&self) -> &SystemMatrix {
        self.formulation.matrix()
    }

    fn linearize(&mut self) {
        self.formulation.linearize(&self.z);
    }

    fn clamp_contacts(&mut self) -> Result<(), Vec<f64>> {
        self.formulation.clamp_contacts();
        self.formulation.unconstrained_mode().map_or(Ok(()), Err)
    }

    fn solve(&mut self, task: &Task<'_>, linear: &mut RefinedSolver, observe: Observe<'_>) -> Computed<MethodResult> {
        self.formulation.begin(task.increment, &self.z);
        task.response.add_to(&mut self.z);
        let settings = self.settings;
        match self.start {
            _ if task.first => self.iterate(&settings, linear, observe),
            Start::Safe => {
                self.move_to_safe_point();
                self.iterate(&settings, linear, observe)
            }
            Start::Prev { shortest_step, far, patience } => {
                let mut hasty = settings;
                hasty.shortest_step = Some(shortest_step);
                hasty.centring.far = far;
                hasty.max_iterations = settings.max_iterations.min(patience);
                let before = self.z.clone();
                let substep = self.iterate(&hasty, linear, observe)?;
                if matches!(substep.stop, Termination::Converged | Termination::Interrupted)
                    || patience >= settings.max_iterations
                {
                    return Ok(substep);
                }
                self.z = before;
                self.move_to_safe_point();
                Ok(substep.then(self.iterate(&settings, linear, observe)?))
            }
        }
    }

    fn state(&self) -> State {
        self.formulation.layout().forces().unpacked(&self.z, self.formulation.scaling())
    }

    /// Moves the positive unknowns that are not forces away from the border.
    fn set_state(&mut self, state: &State) {
        let forces = self.formulation.layout().forces();
        let z = forces.packed(state, self.formulation.scaling());
        self.z[..forces.unknowns()].copy_from_slice(&z);
        self.move_to_safe_point();
    }

    fn unknowns(&mut self) -> &mut Vec<f64> {
        &mut self.z
    }

    fn snapshot(&self, _linear: &RefinedSolver) -> Snapshot {
        Snapshot { unknowns: self.z.clone(), ..Snapshot::default() }
    }

    fn restore(&mut self, snapshot: Snapshot, _linear: &mut RefinedSolver) -> Computed<bool> {
        Ok(take_over(&mut self.z, &snapshot.unknowns))
    }
}

/// Returns the first point: `p_n = l`, all other positive unknowns 1, the rest 0; in MN, m and 10⁻⁵ m.
fn first_point(layout: &SlackLayout, weight: &[f64]) -> Vec<f64> {
    let mut z = vec![0.0; layout.unknowns()];
    for pair in layout.pairs() {
        z[pair.force] = 1.0;
        z[pair.length] = 1.0;
    }
    let l = weight.iter().fold(0.0_f64, |m, l| m.max(*l));
    for i in 0..weight.len() {
        z[layout.forces().p_n(i)] = l;
    }
    z
}

/// Moves the positive unknowns away from the border: each block to a tenth of its largest value, but at least to a
/// tenth of 0.1 MN or of 10⁻⁵ m.
fn move_to_safe_point(layout: &SlackLayout, z: &mut [f64]) {
    let n_c = layout.forces().contacts();
    let pairs: Vec<_> = layout.pairs().collect();
    let (normal, cone) = pairs.split_at(n_c);
    for block in [normal, cone] {
        let largest = |place: fn(&Pair) -> usize| block.iter().map(|p| z[place(p)]).fold(0.0, f64::max);
        let force = if largest(|p| p.force) > 1e-1 { 0.1 * largest(|p| p.force) } else { 1e-2 };
        let length = if largest(|p| p.length) > 1.0 { 0.1 * largest(|p| p.length) } else { 0.1 };
        for pair in block {
            z[pair.force] = force;
            z[pair.length] = length;
        }
    }
}

/// Raises `s` if its cone row `s - μ p_n ± p_t` is not positive, so that the row gets the former value of `s`. The
/// safe point ignores these rows, and the first point satisfies them only if `μ l < 1`.
fn enter_cone(layout: &SlackLayout, mu: &[f64], z: &mut [f64]) {
    for (i, mu) in mu.iter().enumerate() {
        let Some(p_t) = layout.forces().p_t(i) else { continue };
        for (sign, s) in [1.0, -1.0].into_iter().zip(layout.s(p_t)) {
            let reserve = mu * z[layout.forces().p_n(i)] - sign * z[p_t];
            if z[s] <= reserve {
                z[s] += reserve;
            }
        }
    }
}
