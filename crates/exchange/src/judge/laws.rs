//! The laws of Signorini and Coulomb at each contact, without units.

use super::Errors;
use stickslip::solver::{direction, length, positive, project};

/// The reference values of the forces and velocities of a contact.
#[derive(Clone, Copy, Default)]
pub(super) struct Scales {
    pub(super) force: f64,
    pub(super) velocity: f64,
}

/// Raises `worst` to `value`; NaN remains.
pub(super) fn raise(worst: &mut f64, value: f64) {
    if !worst.is_nan() && (value.is_nan() || value > *worst) {
        *worst = value;
    }
}

/// Returns `|value|` relative to `scale`. A nonzero value relative to 0 is infinite.
pub(super) fn relative(value: f64, scale: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.abs() / scale }
}

/// Raises `errors` to those of all contacts.
pub(super) fn laws(dimension: usize, mu: &[f64], scales: &[Scales], r: &[f64], u: &[f64], errors: &mut Errors) {
    for (i, mu) in mu.iter().enumerate() {
        let at = |from: &[f64], scale: f64| {
            let mut whole = [0.0; 3];
            let own = &from[dimension * i..dimension * (i + 1)];
            whole.iter_mut().zip(own).for_each(|(to, x)| *to = if *x == 0.0 { 0.0 } else { x / scale });
            whole
        };
        let ([r_n, r_t @ ..], [u_n, u_t @ ..]) = (at(r, scales[i].force), at(u, scales[i].velocity));
        let normal = if r_n < u_n { r_n } else { u_n };
        let radius = mu * positive(r_n);
        raise(&mut errors.normal, normal.abs());
        raise(&mut errors.cone, positive(length(r_t) - radius));
        let against = direction(u_t);
        let lacking = length([0, 1].map(|k| r_t[k] + radius * against[k]));
        if *mu > 0.0 {
            raise(&mut errors.dissipation, if lacking < length(u_t) { lacking } else { length(u_t) });
        }
        let admissible = project([0, 1].map(|k| r_t[k] - u_t[k]), radius);
        let map = normal.hypot(length([0, 1].map(|k| r_t[k] - admissible[k])));
        if map.is_nan() || map > errors.natural_map {
            errors.contact = i;
        }
        raise(&mut errors.natural_map, map);
    }
}
