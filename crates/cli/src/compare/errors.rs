//! Measures the distance of a history from its reference, and of a mesh from the finest.

use super::tractions::{Interior, Tractions, relative};
use serde::Serialize;
use stickslip::body::ContactNode;
use stickslip::body::Model;
use stickslip::solver::State;

/// The results at the end of a history, SI.
#[derive(Debug, Clone, PartialEq)]
pub struct End {
    /// `p_n` at the end, n_c, N.
    pub p_n: Vec<f64>,
    /// `p_t` at the end, n_c, N.
    pub p_t: Vec<f64>,
    /// `p_o` at the end, n_c, N.
    pub p_o: Vec<f64>,
    /// The total work dissipated by friction, J, or J per m of depth. For a halved increment it is the sum over its
    /// substeps.
    pub work: f64,
    /// `½ uᵀ K u` at the end, J, or J per m of depth.
    pub energy: f64,
    /// The largest contact pressure at the end, Pa.
    pub peak: f64,
    /// The contact tractions at the end.
    pub tractions: Tractions,
}

/// The error of time stepping: the distance to a reference on the same mesh, relative to the reference. Forces are
/// compared as tractions at the end of the history, in the L2 norm of the contact boundary.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TimeErrors {
    /// The error of `p_n`.
    pub p_n: f64,
    /// The error of the tangential forces, relative to these alone.
    pub p_t: f64,
    /// The error of all contact forces.
    pub forces: f64,
    /// The error of the total work dissipated by friction.
    pub work: f64,
}

/// The error of the mesh: the distance to the finest mesh, relative to the finest mesh.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MeshErrors {
    /// The error of `Σ p_n`.
    pub sum_p_n: f64,
    /// The error of the tangential resultant `(Σ p_t, Σ p_o)`, relative to `Σ p_n` because the resultant may vanish.
    pub sum_p_t: f64,
    /// The error of the strain energy.
    pub energy: f64,
    /// The error of the tractions, L2 norm, without the rim of the contact boundary, see [`Tractions::interior`].
    pub tractions: f64,
    /// The error of the largest contact pressure.
    pub peak: f64,
}

impl End {
    /// Evaluates a `state` of `model` after the friction `work`.
    pub(super) fn new(model: &Model, state: &State, work: f64) -> Self {
        let traction = |(i, contact): (usize, &ContactNode)| contact.in_frame([state.p_t[i], state.p_o[i]]);
        let (p_t, p_o) = model.contact.nodes.iter().enumerate().map(traction).map(|[p_t, p_o]| (p_t, p_o)).unzip();
        End {
            p_n: state.p_n.clone(),
            p_t,
            p_o,
            work,
            energy: model.problem.strain_energy(state).expect("a state of this model"),
            peak: model.contact_pressures(state).into_iter().fold(0.0, f64::max),
            tractions: Tractions::of(model, state),
        }
    }
}

/// Differences below this share of the normal forces, or of the strain energy, are rounding.
const NOTHING: f64 = 1e-10;

impl TimeErrors {
    /// No errors, where there is nothing to compare with.
    pub(super) const UNKNOWN: Self = TimeErrors { p_n: f64::NAN, p_t: f64::NAN, forces: f64::NAN, work: f64::NAN };

    /// Measures `end` against `reference`, both with the integration weights `l`.
    pub fn new(end: &End, reference: &End, weight: &[f64]) -> Self {
        let components = [(&end.p_n, &reference.p_n), (&end.p_t, &reference.p_t), (&end.p_o, &reference.p_o)];
        let [p_n, p_t, p_o] = components.map(|(p, exact)| {
            let difference: Vec<f64> = p.iter().zip(exact).map(|(p, exact)| p - exact).collect();
            [square(&difference, weight), square(exact, weight)]
        });
        let p_t = [p_t[0] + p_o[0], p_t[1] + p_o[1]];
        let work = end.work - reference.work;
        TimeErrors {
            p_n: relative(p_n[0].sqrt(), p_n[1].sqrt()),
            p_t: if p_t[0] <= NOTHING * NOTHING * p_n[1] { 0.0 } else { relative(p_t[0].sqrt(), p_t[1].sqrt()) },
            forces: relative((p_n[0] + p_t[0]).sqrt(), (p_n[1] + p_t[1]).sqrt()),
            work: if work.abs() <= NOTHING * reference.energy.abs() { 0.0 } else { relative(work, reference.work) },
        }
    }
}

/// `∫ σ² = Σ l (p/l)²`.
fn square(p: &[f64], weight: &[f64]) -> f64 {
    p.iter().zip(weight).map(|(p, l)| p * p / l).sum()
}

impl MeshErrors {
    /// No errors, where there is nothing to compare with.
    pub(super) const UNKNOWN: Self =
        MeshErrors { sum_p_n: f64::NAN, sum_p_t: f64::NAN, energy: f64::NAN, tractions: f64::NAN, peak: f64::NAN };

    /// Returns the error in the energy norm, √|ΔU / U|. This is exact for a body that only loads or supports deform.
    /// With an obstacle it neglects the work of contact forces over gaps.
    pub fn norm(&self) -> f64 {
        self.energy.sqrt()
    }

    /// Measures `end` against the `finest` mesh; tractions only `within` a part of the contact boundary.
    pub fn new(end: &End, finest: &End, within: &Interior) -> Self {
        let sum = |forces: &[f64]| forces.iter().sum::<f64>();
        let apart = |of: fn(&End) -> &[f64]| sum(of(end)) - sum(of(finest));
        let normal = sum(&finest.p_n);
        MeshErrors {
            sum_p_n: relative(apart(|end| &end.p_n), normal),
            sum_p_t: relative(apart(|end| &end.p_t).hypot(apart(|end| &end.p_o)), normal),
            energy: relative(end.energy - finest.energy, finest.energy),
            peak: relative(end.peak - finest.peak, finest.peak),
            tractions: end.tractions.distance(&finest.tractions, within),
        }
    }
}
