//! The violation of the laws of Signorini and Coulomb, without units: one measure for local and for global problems. It uses
//! nothing of the solvers.
//!
//! With `ρ` and `υ`, force and velocity of a contact in scales of its own, each error is the largest over all contacts of
//!
//! ```text
//! normal        |min(ρ_N, υ_N)|                         no penetration, no tension, no pressure across a gap
//! cone          (|ρ_T| - μ (ρ_N)₊)₊                     Coulomb's cone
//! dissipation   min(|υ_T|, |ρ_T + μ (ρ_N)₊ υ_T/|υ_T||)  slip against full friction
//! natural map   |(min(ρ_N, υ_N), ρ_T - Π(ρ_T - υ_T))|   Π projects on the disk of radius μ (ρ_N)₊
//! ```
//!
//! The natural map is 0 exactly if all laws hold. Without friction, the only law of the tangents is `r_T = 0`.

use serde::{Deserialize, Serialize};

/// The tolerance: a problem counts as solved if no error exceeds it.
pub const TOLERANCE: f64 = 1e-10;

/// The violation of each law, the largest over all rows and contacts, without units.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Errors {
    /// Imbalance of the forces on the bodies, `M v = f + H r`; for a local problem error of a given `u = W r + q`.
    pub equilibrium: f64,
    /// Difference between the velocities and those of the bodies, `u = Hᵀ v + w`; 0 for a local problem.
    pub velocities: f64,
    /// Penetration, tension, or a pressure across a gap.
    pub normal: f64,
    /// Friction beyond Coulomb's cone.
    pub cone: f64,
    /// Slip without full friction opposing it.
    pub dissipation: f64,
    /// The natural map: all laws of a contact in one number.
    pub natural_map: f64,
    /// The contact where the natural map is largest, from 0.
    pub contact: usize,
}

/// A law of [`Errors`], with its meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Law {
    /// The name of the law and of its field.
    pub name: &'static str,
    /// The requirement.
    pub demands: &'static str,
    /// The meaning of its violation.
    pub violation: &'static str,
}

const fn law(name: &'static str, demands: &'static str, violation: &'static str) -> Law {
    Law { name, demands, violation }
}

const LAWS: [Law; 6] = [
    law("equilibrium", "forces and velocities are consistent", "forces and velocities are not consistent"),
    law("velocities", "u = H'v + w", "the relative velocities are not those of the bodies"),
    law(
        "normal",
        "no penetration, no tension, no pressure across a gap",
        "a contact penetrates, pulls, or presses across a gap",
    ),
    law("cone", "|r_T| <= mu r_N", "friction is larger than mu times the pressure"),
    law("dissipation", "full friction opposes slip", "a contact slips without full friction opposing it"),
    law("natural_map", "all laws of a contact", "the laws of a contact are violated"),
];

impl Errors {
    /// Returns every law with its violation.
    pub fn laws(&self) -> [(Law, f64); 6] {
        let Errors { equilibrium, velocities, normal, cone, dissipation, natural_map, .. } = *self;
        let errors = [equilibrium, velocities, normal, cone, dissipation, natural_map];
        std::array::from_fn(|k| (LAWS[k], errors[k]))
    }

    /// Returns the largest error of equilibrium, velocities and natural map. The natural map includes the laws of
    /// single contacts.
    pub fn worst(&self) -> f64 {
        let mut worst = self.natural_map;
        raise(&mut worst, self.equilibrium);
        raise(&mut worst, self.velocities);
        worst
    }

    /// Returns `true` if all laws hold within `tolerance`, and `false` if an error is NaN.
    pub fn within(&self, tolerance: f64) -> bool {
        self.worst() <= tolerance
    }

    /// Returns `true` if all laws hold within [`TOLERANCE`].
    pub fn is_solved(&self) -> bool {
        self.within(TOLERANCE)
    }

    /// Raises the errors to those of the laws at all contacts, in the `scales` of each contact.
    pub(crate) fn add_laws(&mut self, dimension: usize, mu: &[f64], scales: &[Scales], r: &[f64], u: &[f64]) {
        let size = |[a, b]: [f64; 2]| a.hypot(b);
        for (i, (mu, scales)) in mu.iter().zip(scales).enumerate() {
            let at = |from: &[f64], scale: f64| {
                let mut whole = [0.0; 3];
                let own = &from[dimension * i..dimension * (i + 1)];
                whole.iter_mut().zip(own).for_each(|(to, x)| *to = if *x == 0.0 { 0.0 } else { x / scale });
                whole
            };
            let ([r_n, r_t @ ..], [u_n, u_t @ ..]) = (at(r, scales.force), at(u, scales.velocity));
            let normal = if r_n < u_n { r_n } else { u_n };
            let radius = if r_n <= 0.0 { 0.0 } else { mu * r_n };
            raise(&mut self.normal, normal.abs());
            let beyond = size(r_t) - radius;
            raise(&mut self.cone, if beyond <= 0.0 { 0.0 } else { beyond });
            let slip = size(u_t);
            let missing = [0, 1].map(|k| if slip > 0.0 { r_t[k] + radius * (u_t[k] / slip) } else { 0.0 });
            if *mu > 0.0 {
                raise(&mut self.dissipation, if size(missing) < slip { size(missing) } else { slip });
            }
            let trial = [0, 1].map(|k| r_t[k] - u_t[k]);
            let reach = size(trial);
            let tangential = [0, 1].map(|k| if reach > radius { r_t[k] - radius * (trial[k] / reach) } else { u_t[k] });
            let map = normal.hypot(size(tangential));
            if map.is_nan() || map > self.natural_map {
                self.contact = i;
            }
            raise(&mut self.natural_map, map);
        }
    }
}

/// The reference values of the forces and velocities of a contact.
#[derive(Clone, Copy, Default)]
pub(crate) struct Scales {
    pub(crate) force: f64,
    pub(crate) velocity: f64,
}

impl Scales {
    /// Returns the scales of a contact with this `unit` from those of its part, whose units are one.
    pub(crate) fn of_contact(self, unit: f64) -> Self {
        Scales { force: self.force / unit, velocity: self.velocity * unit }
    }
}

/// Raises `worst` to `value`; NaN remains.
pub(crate) fn raise(worst: &mut f64, value: f64) {
    if !worst.is_nan() && (value.is_nan() || value > *worst) {
        *worst = value;
    }
}

/// Returns `|value|` relative to `scale`. A nonzero value relative to 0 is infinite; 0 relative to 0 is 0.
pub(crate) fn relative(value: f64, scale: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.abs() / scale }
}
