//! How far a history is from its reference, and a mesh from the finest.

use crate::contact::ContactNode;
use crate::model::Model;
use crate::problem::{ContactProblem, Increment, State};

/// What a history comes to, SI.
#[derive(Debug, Clone, PartialEq)]
pub struct End {
    /// `p_n` at the end, n_c, N.
    pub p_n: Vec<f64>,
    /// `p_t` at the end, n_c, N.
    pub p_t: Vec<f64>,
    /// Work that friction has dissipated in the whole history, J per m of depth; NaN if an increment was
    /// halved, since the slip of its parts is not seen.
    pub work: f64,
    /// `½ uᵀ K u` at the end, J per m of depth.
    pub energy: f64,
    /// The contact tractions at the end.
    pub profile: Profile,
}

/// Contact tractions along the contact boundaries.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Position of each contact node, n_c, m.
    pub positions: Vec<[f64; 2]>,
    /// Integration weights `l`, n_c, m.
    pub weight: Vec<f64>,
    /// `(σ_n, σ_t)` of each contact node (32), n_c, Pa.
    pub tractions: Vec<[f64; 2]>,
}

/// The error of time stepping: the distance to a reference on the same mesh, relative to the reference.
/// Forces are compared as tractions at the end of the history, in the L2 norm of the contact line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeErrors {
    /// In `p_n`.
    pub p_n: f64,
    /// In `p_t`, relative to `p_t` alone.
    pub p_t: f64,
    /// In the contact forces, `(p_n, p_t)` together.
    pub forces: f64,
    /// In the work that friction has dissipated in the whole history.
    pub work: f64,
}

/// The error of the mesh: the distance to the finest mesh, relative to that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshErrors {
    /// In `Σ p_n`.
    pub sum_p_n: f64,
    /// In `Σ p_t`, relative to `Σ p_n`: it may vanish.
    pub sum_p_t: f64,
    /// In the strain energy.
    pub energy: f64,
    /// In the tractions, L2 norm, without the ends of the contact line, see [`Profile::interior`].
    pub tractions: f64,
}

/// The work that friction dissipates in one increment, `p_tᵀ (w_t - w̄_t)`, J per m of depth: by (8) no node
/// has a negative share in it.
pub fn friction_work(problem: &ContactProblem, increment: &Increment<'_>, state: &State) -> f64 {
    let slip = |i: usize| problem.c_t.dot(i, &state.u) - increment.w_t_last[i];
    (0..problem.contacts()).map(|i| state.p_t[i] * slip(i)).sum()
}

impl End {
    /// A `state` of `model` after so much friction `work`.
    pub(super) fn new(model: &Model, state: &State, work: f64) -> Self {
        let problem = &model.problem;
        let mut force = vec![0.0; state.u.len()];
        problem.stiffness.mul(&state.u, &mut force);
        let traction = |i: usize| [state.p_n[i], state.p_t[i]].map(|p| p / problem.weight[i]);
        End {
            p_n: state.p_n.clone(),
            p_t: state.p_t.clone(),
            work,
            energy: 0.5 * state.u.iter().zip(&force).map(|(u, f)| u * f).sum::<f64>(),
            profile: Profile {
                positions: model.contacts.iter().map(|ContactNode { position, .. }| *position).collect(),
                weight: problem.weight.clone(),
                tractions: (0..problem.contacts()).map(traction).collect(),
            },
        }
    }
}

impl TimeErrors {
    /// Those of `end` against `reference`, both with the integration weights `l`.
    pub fn new(end: &End, reference: &End, weight: &[f64]) -> Self {
        let [p_n, p_t] = [(&end.p_n, &reference.p_n), (&end.p_t, &reference.p_t)].map(|(p, exact)| {
            let difference: Vec<f64> = p.iter().zip(exact).map(|(p, exact)| p - exact).collect();
            [square(&difference, weight), square(exact, weight)]
        });
        TimeErrors {
            p_n: relative(p_n[0].sqrt(), p_n[1].sqrt()),
            p_t: relative(p_t[0].sqrt(), p_t[1].sqrt()),
            forces: relative((p_n[0] + p_t[0]).sqrt(), (p_n[1] + p_t[1]).sqrt()),
            work: relative(end.work - reference.work, reference.work),
        }
    }
}

/// `∫ σ² = Σ l (p/l)²`.
fn square(p: &[f64], weight: &[f64]) -> f64 {
    p.iter().zip(weight).map(|(p, l)| p * p / l).sum()
}

/// `|value| / scale`; nothing is no error, whatever it is compared with.
fn relative(value: f64, scale: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.abs() / scale.abs() }
}

impl MeshErrors {
    /// Those of `end` against the `finest` mesh, tractions between two points of the contact line only.
    pub fn new(end: &End, finest: &End, between: [[f64; 2]; 2]) -> Self {
        let sum = |forces: &[f64]| forces.iter().sum::<f64>();
        let normal = sum(&finest.p_n);
        MeshErrors {
            sum_p_n: relative(sum(&end.p_n) - normal, normal),
            sum_p_t: relative(sum(&end.p_t) - sum(&finest.p_t), normal),
            energy: relative(end.energy - finest.energy, finest.energy),
            tractions: end.profile.distance(&finest.profile, between),
        }
    }
}

/// So many elements are left out at either end of the contact line: corners of the body are singular.
const OUTERMOST: usize = 2;

impl Profile {
    /// The nodes between which the tractions of finer meshes are compared with those of this one: without the
    /// two outermost elements at either end. On a short line its ends.
    pub fn interior(&self) -> [[f64; 2]; 2] {
        let last = self.positions.len().saturating_sub(1);
        let skip = if last > 2 * OUTERMOST { OUTERMOST } else { 0 };
        let at = |i: usize| self.positions.get(i).copied().unwrap_or_default();
        [at(skip), at(last - skip)]
    }

    /// The distance of the tractions to those of a `finer` mesh in the L2 norm of the line between two points,
    /// relative to the finer; at the nodes of this mesh, with the finer ones linear between their nodes.
    pub fn distance(&self, finer: &Profile, between: [[f64; 2]; 2]) -> f64 {
        let (mut difference, mut whole) = (0.0, 0.0);
        for ((position, l), traction) in self.positions.iter().zip(&self.weight).zip(&self.tractions) {
            // Nodes at the ends count, whatever rounding makes of their place.
            if !(-1e-9..=1.0 + 1e-9).contains(&share(between, *position)) {
                continue;
            }
            for (coarse, fine) in traction.iter().zip(finer.at(*position)) {
                difference += l * (coarse - fine).powi(2);
                whole += l * fine * fine;
            }
        }
        relative(difference.sqrt(), whole.sqrt())
    }

    /// The tractions at the point of the line nearest to `position`.
    fn at(&self, position: [f64; 2]) -> [f64; 2] {
        let sides = self.positions.windows(2).zip(self.tractions.windows(2)).map(|(ends, tractions)| {
            let ends = [ends[0], ends[1]];
            let t = share(ends, position).clamp(0.0, 1.0);
            let mix = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|k| a[k] + t * (b[k] - a[k]));
            let [x, y] = mix(ends[0], ends[1]);
            ((x - position[0]).hypot(y - position[1]), mix(tractions[0], tractions[1]))
        });
        let nearest = sides.min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map_or_else(|| self.tractions.first().copied().unwrap_or_default(), |(_, tractions)| tractions)
    }
}

/// How far along the line from `a` to `b` the point nearest to `position` is.
fn share([a, b]: [[f64; 2]; 2], position: [f64; 2]) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let length = along[0] * along[0] + along[1] * along[1];
    let reach = (position[0] - a[0]) * along[0] + (position[1] - a[1]) * along[1];
    if length == 0.0 { 0.0 } else { reach / length }
}
