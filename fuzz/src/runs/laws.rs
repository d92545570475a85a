//! The laws of the increments that count as converged, measured again: from the loads and the displacements alone, with nothing of
//! the library's own measure.
//!
//! Forces are compared with the largest external or contact force so far, lengths with the largest displacement or interference; where
//! loads cancel, with what rounding leaves of their terms.

use stickslip::algebra::Csr;
use stickslip::body::Model;
use stickslip::run::RecordedIncrement;
use stickslip::solver::history::{SolverChoice, Status};
use stickslip::solver::{Loading, State};

/// A law that is met by so many tolerances is met: the scales here are not quite those of the library.
const SLACK: f64 = 2.0;

/// A sum of two doubles, by Knuth's exact sum and the fused product.
#[derive(Clone, Copy, Default)]
struct Double {
    high: f64,
    low: f64,
}

impl Double {
    fn add(&mut self, x: f64) {
        let sum = self.high + x;
        let of_x = sum - self.high;
        self.low += (self.high - (sum - of_x)) + (x - of_x);
        self.high = sum;
    }

    fn add_product(&mut self, a: f64, b: f64) {
        let product = a * b;
        self.add(product);
        self.low += a.mul_add(b, -product);
    }

    fn value(self) -> f64 {
        self.high + self.low
    }
}

/// The displacements without their part along the motions that strain nothing, for what rounding has left of these in `K` is not
/// the state's.
fn strained(model: &Model, state: &State) -> Vec<Double> {
    let u_rest = |i: usize| state.u_rest.get(i).copied().unwrap_or(0.0);
    let mut u: Vec<Double> = state.u.iter().enumerate().map(|(i, u)| Double { high: *u, low: u_rest(i) }).collect();
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for motion in model.problem.rigid_modes() {
        let mut motion = motion.clone();
        for other in &basis {
            let share = product(&motion, other) / product(other, other);
            motion.iter_mut().zip(other).for_each(|(r, other)| *r -= share * other);
        }
        basis.push(motion);
    }
    // The second time takes what rounding has left of the first.
    for motion in basis.iter().chain(&basis) {
        let values: Vec<f64> = u.iter().map(|u| u.value()).collect();
        let share = -product(motion, &values) / product(motion, motion);
        u.iter_mut().zip(motion).for_each(|(u, r)| {
            u.add_product(share, *r);
            let high = u.value();
            *u = Double { high, low: (u.high - high) + u.low };
        });
    }
    u
}

/// `K u + Cᵀ p - f`, N.
fn imbalance(model: &Model, force: &[f64], state: &State) -> Vec<f64> {
    let problem = &model.problem;
    let u = strained(model, state);
    let mut balance = vec![Double::default(); u.len()];
    let stiffness = problem.stiffness().assembled().expect("a stiffness in this process");
    for (row, column, value) in stiffness.entries() {
        balance[row].add_product(value, u[column].high);
        balance[row].add(value * u[column].low);
    }
    for (map, forces) in [(problem.c_n(), &state.p_n), (problem.c_t(), &state.p_t), (problem.c_o(), &state.p_o)] {
        for (i, p) in forces.iter().enumerate() {
            map.row(i).iter().for_each(|(dof, c)| balance[*dof].add_product(*c, *p));
        }
    }
    balance.iter_mut().zip(force).for_each(|(sum, force)| sum.add(-force));
    balance.into_iter().map(Double::value).collect()
}

/// A row of `map` on the displacements of a state beside those of another, less `offset`; either may be far beyond the difference.
fn along(map: &Csr, i: usize, state: &State, other: &State, offset: f64) -> f64 {
    let u_rest = |state: &State, dof: usize| state.u_rest.get(dof).copied().unwrap_or(0.0);
    let mut sum = Double::default();
    for (dof, c) in map.row(i) {
        sum.add_product(*c, state.u[*dof]);
        sum.add_product(-*c, other.u[*dof]);
        sum.add(c * (u_rest(state, *dof) - u_rest(other, *dof)));
    }
    sum.add(-offset);
    sum.value()
}

fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// An error beside its scale; where there is nothing to compare with, any is infinite.
fn relative(error: f64, scale: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error.abs() / scale }
}

/// The smaller one, or what is no number.
fn smaller(a: f64, b: f64) -> f64 {
    if a.is_nan() || a < b { a } else { b }
}

/// What forces and lengths are compared with.
#[derive(Default)]
struct Scales {
    force: f64,
    length: f64,
}

impl Scales {
    fn raise(&mut self, model: &Model, force: &[f64], gap: &[f64], state: &State) {
        let friction = state.p_t.iter().zip(&state.p_o).map(|(t, o)| t.hypot(*o)).fold(0.0, f64::max);
        self.force = self.force.max(largest(force)).max(largest(&state.p_n)).max(friction);
        let interference = gap.iter().fold(0.0_f64, |m, g| m.max(-g));
        let stiffest = largest(&model.problem.stiffness().diagonal());
        self.length = self.length.max(largest(&state.u)).max(interference);
        if stiffest > 0.0 {
            self.length = self.length.max(largest(force) / stiffest);
        }
    }
}

/// The sizes of the terms that loads add up from, the largest of all displacements.
fn terms(loading: &Loading, time: f64) -> f64 {
    let mut sizes: Vec<f64> = Vec::new();
    for case in loading.cases() {
        sizes.resize(case.force().len(), 0.0);
        sizes.iter_mut().zip(case.force()).for_each(|(size, force)| *size += (case.factor(time) * force).abs());
    }
    largest(&sizes)
}

/// Measures every increment that counts as converged.
///
/// # Errors
/// The law that does not hold, where, and by how much.
pub fn check(model: &Model, solver: &SolverChoice, increments: &[RecordedIncrement]) -> Result<(), String> {
    for (k, found) in increments.iter().enumerate() {
        if found.record.status != Status::Converged {
            break;
        }
        let data = Data::of(model, solver, &increments[..k], found)?;
        let balance = data.equilibrium(&found.state);
        if let Some(wrong) = balance.into_iter().chain(contact_faults(model, solver, &increments[..k], found)).next() {
            return Err(format!("increment {} counts as converged: {wrong}", found.record.index));
        }
    }
    Ok(())
}

/// The laws of contact and friction that do not hold in an increment that others came `before`.
pub fn contact_faults(
    model: &Model,
    solver: &SolverChoice,
    before: &[RecordedIncrement],
    found: &RecordedIncrement,
) -> Vec<String> {
    let data = match Data::of(model, solver, before, found) {
        Ok(data) => data,
        Err(wrong) => return vec![wrong],
    };
    let start = State::zero(&model.problem);
    let (state, from) = before.last().map_or((&start, 0.0), |before| (&before.state, before.record.time));
    let passed = [0, 1].map(|k| data.passed(k, from, found.record.time));
    let maps = model.problem.tangential_maps();
    let slip = |k: usize, i: usize| {
        if found.record.parts > 1 {
            // The last part began at another state, of which only the tangential displacements are known.
            let last = [&found.w_t_last, &found.w_o_last][k][i];
            along(maps[k], i, &found.state, &start, last)
        } else {
            along(maps[k], i, &found.state, state, passed[k][i])
        }
    };
    // The exact path asks for the law of friction all along, and not of the ends of increments.
    let dissipates = !solver.method.is_exact_path();
    let friction = data.friction(&found.state, slip, found.record.time, dissipates);
    data.contact(&found.state).into_iter().chain(friction).collect()
}

/// An increment, as the loading has it.
struct Data<'a> {
    model: &'a Model,
    force: Vec<f64>,
    gap: Vec<f64>,
    scales: Scales,
    /// The force that it would take to strain the body by as much as it moves, N.
    moving: f64,
    allowed: f64,
}

impl<'a> Data<'a> {
    fn of(
        model: &'a Model,
        solver: &SolverChoice,
        before: &[RecordedIncrement],
        found: &RecordedIncrement,
    ) -> Result<Self, String> {
        let mut scales = Scales::default();
        let (mut force, mut gap) = (Vec::new(), Vec::new());
        for increment in before.iter().chain([found]) {
            let time = increment.record.time;
            force = model.loading.force_at(time, &model.problem).map_err(|error| error.to_string())?;
            gap = model.loading.gaps_at(time);
            scales.raise(model, &force, &gap, &increment.state);
        }
        let known = (16.0 * f64::EPSILON / solver.tolerance).min(1.0);
        scales.force = scales.force.max(known * terms(&model.loading, found.record.time));
        let moving = largest(&model.problem.stiffness().diagonal()) * scales.length;
        if scales.force <= f64::EPSILON * moving {
            // A body that is moved by nothing that holds out: what rounding the way leaves is no force.
            scales.force = known * moving;
        }
        Ok(Data { model, force, gap, scales, moving, allowed: SLACK * solver.tolerance })
    }

    /// What is wrong, if an error, relative to its scale, is above what is allowed, or no number.
    fn too_large(&self, what: &str, place: usize, error: f64, scale: f64) -> Option<String> {
        let relative = relative(error, scale);
        let holds = relative <= self.allowed;
        (!holds).then(|| format!("{what} at {place}: {relative:.2e} instead of {:.2e}", self.allowed))
    }

    fn equilibrium(&self, state: &State) -> Option<String> {
        // The way of a body that contact alone holds is told to so many digits: what rounding it strains is no error of the run.
        let tolerance =
            if self.model.problem.rigid_modes().is_empty() { 0.0 } else { 4.0 * f64::EPSILON * self.moving };
        let balance = imbalance(self.model, &self.force, state);
        let residual = balance.iter().map(|r| if r.abs() <= tolerance { 0.0 } else { *r });
        residual.enumerate().find_map(|(dof, r)| self.too_large("equilibrium", dof, r, self.scales.force))
    }

    fn contact(&self, state: &State) -> Option<String> {
        let start = State::zero(&self.model.problem);
        (0..self.gap.len()).find_map(|i| {
            let inside = along(self.model.problem.c_n(), i, state, &start, self.gap[i]);
            let pressed = state.p_n[i];
            let apart = relative((-inside).max(0.0), self.scales.length);
            let both = smaller(relative(pressed.max(0.0), self.scales.force), apart);
            self.too_large("penetration", i, inside.max(0.0), self.scales.length)
                .or_else(|| self.too_large("tension", i, pressed.min(0.0), self.scales.force))
                .or_else(|| self.too_large("pressure across a gap", i, both, 1.0))
        })
    }

    /// How far obstacles have passed the nodes along a tangent, m.
    fn passed(&self, k: usize, from: f64, to: f64) -> Vec<f64> {
        let loading = &self.model.loading;
        loading.drift_at(to, k).iter().zip(loading.drift_at(from, k)).map(|(now, then)| now - then).collect()
    }

    fn friction(
        &self,
        state: &State,
        slip: impl Fn(usize, usize) -> f64,
        time: f64,
        dissipates: bool,
    ) -> Option<String> {
        let problem = &self.model.problem;
        let mu = self.model.loading.friction().map_or_else(|| problem.mu().to_vec(), |friction| friction.at(time));
        (0..mu.len()).find_map(|i| {
            let (p, radius) = ([state.p_t[i], state.p_o[i]], mu[i] * state.p_n[i].max(0.0));
            let size = p[0].hypot(p[1]);
            let outside = self.too_large("friction beyond the cone", i, (size - radius).max(0.0), self.scales.force);
            if outside.is_some() || !dissipates {
                return outside;
            }
            let maps = problem.tangential_maps();
            if maps.iter().all(|map| map.row(i).is_empty()) {
                return None;
            }
            let slip = [0, 1].map(|k| slip(k, i));
            let length = slip[0].hypot(slip[1]);
            // A force a little beyond the cone has been judged.
            let within = if size > radius { radius / size } else { 1.0 };
            let lacking = if length > 0.0 {
                (0..2).map(|k| (radius * slip[k] / length - within * p[k]).powi(2)).sum::<f64>().sqrt()
            } else {
                0.0
            };
            // Beside the way of a body that contact alone holds a slip may be so small that its direction is lost in rounding.
            let tolerance =
                if problem.rigid_modes().is_empty() { 0.0 } else { 4.0 * f64::EPSILON * self.scales.length };
            let unknown = if length > 0.0 { radius * (tolerance / length).min(2.0) } else { 0.0 };
            let lacking = (lacking - unknown).max(0.0);
            let both = smaller(relative(lacking, self.scales.force), relative(length, self.scales.length));
            self.too_large("slip without full friction against it", i, both, 1.0)
        })
    }
}
