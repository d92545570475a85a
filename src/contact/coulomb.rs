//! The laws of Signorini and Coulomb at one contact node as equations, and their linearisation:
//! the rows of (19) and the cases of (21). Pure functions of scalars, in any consistent units.

/// `x₊ = max(x, 0)`; NaN stays NaN, where `f64::max` would make it 0.
pub fn positive(x: f64) -> f64 {
    if x <= 0.0 { 0.0 } else { x }
}

/// `Π(q)`, the projection on the friction interval `|p_t| ≤ radius`, the 2D form of (18).
pub fn project(q: f64, radius: f64) -> f64 {
    // Not `clamp`, which panics if the radius is not a number.
    if q > radius {
        radius
    } else if q < -radius {
        -radius
    } else {
        q
    }
}

/// The normal row of (19): `-min(p_n, r (g - w_n))`.
pub fn normal_residual(p_n: f64, w_n: f64, gap: f64, r: f64) -> f64 {
    -p_n.min(r * (gap - w_n))
}

/// The tangential row of (19): `-p_t + Π(p_t + r Δw_t)` with the radius `μ (pressure)₊`; in (19) the
/// pressure is `p_n`.
pub fn tangential_residual(p_t: f64, pressure: f64, slip: f64, mu: f64, r: f64) -> f64 {
    -p_t + project(p_t + r * slip, mu * positive(pressure))
}

/// The normal cases of (21).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NormalCase {
    /// `p_n + r (w_n - g) ≤ 0`; row `-dp_n`.
    Open,
    /// `p_n + r (w_n - g) > 0`; row `r C_n du`.
    Closed,
}

/// The tangential cases of (21), where the pressure is `p_n`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TangentialCase {
    /// `pressure ≤ 0`; row `-dp_t`.
    NoPressure,
    /// `pressure > 0`, `|q| < μ pressure`; row `r C_t du`.
    Stick,
    /// `pressure > 0`, `|q| ≥ μ pressure`; row `-dp_t + μ sign dp_n`. The term `R` vanishes in 2D.
    Slip {
        /// `q / |q|`.
        sign: f64,
    },
}

/// The share of `μ p_n` by which `|q|` must stay below it to count as stick: a node that slipped
/// starts every new increment exactly on that border, and there the paper's counts are only
/// reproduced if it goes on slipping in its old direction. Well above rounding, far below any load.
pub const SLIP_BORDER: f64 = 1e-9;

/// The normal case of a node.
pub fn normal_case(p_n: f64, w_n: f64, gap: f64, r: f64) -> NormalCase {
    if p_n + r * (w_n - gap) > 0.0 { NormalCase::Closed } else { NormalCase::Open }
}

/// The tangential case of a node with the slip increment `slip = w_t - w̄_t`.
pub fn tangential_case(p_t: f64, pressure: f64, slip: f64, mu: f64, r: f64) -> TangentialCase {
    let q = p_t + r * slip;
    if pressure <= 0.0 {
        TangentialCase::NoPressure
    } else if q.abs() <= mu * pressure * (1.0 - SLIP_BORDER) {
        TangentialCase::Stick
    } else {
        TangentialCase::Slip { sign: q.signum() }
    }
}

/// A sum of two terms at the start of a direction, and the rate at which it changes along it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Germ {
    /// The sum.
    pub value: f64,
    /// The sum of the terms' absolute values, beside which rounding is judged.
    pub size: f64,
    /// The rate.
    pub rate: f64,
}

impl Germ {
    /// `a + b` with the rate of the sum.
    pub fn new(a: f64, b: f64, rate: f64) -> Self {
        Germ { value: a + b, size: a.abs() + b.abs(), rate }
    }

    /// A number with the sign that the sum takes at once along the direction; 0 if it stays 0.
    fn ahead(&self) -> f64 {
        if self.value.abs() > SLIP_BORDER * self.size { self.value } else { self.rate }
    }
}

/// The normal case that a direction leads into, from `p_n + r (w_n - g)`: the branch of the
/// directional derivative (20).
pub fn normal_case_ahead(trial: Germ) -> NormalCase {
    if trial.ahead() > 0.0 { NormalCase::Closed } else { NormalCase::Open }
}

/// The tangential case that a direction leads into, from the pressure and `q`.
pub fn tangential_case_ahead(pressure: Germ, q: Germ, mu: f64) -> TangentialCase {
    if pressure.ahead() <= 0.0 {
        return TangentialCase::NoPressure;
    }
    let sign = if q.ahead() < 0.0 { -1.0 } else { 1.0 };
    let beyond = Germ::new(sign * q.value, -mu * pressure.value, sign * q.rate - mu * pressure.rate);
    if beyond.ahead() < 0.0 { TangentialCase::Stick } else { TangentialCase::Slip { sign } }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn residuals_vanish_exactly_on_the_law() {
        let r = 3.0;
        // Open, grazing, closed.
        for (p_n, w_n) in [(0.0, -1.0), (0.0, 0.5), (2.0, 0.5)] {
            assert_eq!(normal_residual(p_n, w_n, 0.5, r), 0.0);
        }
        assert_ne!(normal_residual(2.0, 0.4, 0.5, r), 0.0);
        assert_ne!(normal_residual(-1.0, 0.5, 0.5, r), 0.0);
        assert_ne!(normal_residual(0.0, 0.6, 0.5, r), 0.0);
        // Stick, slip either way, no pressure.
        for (p_t, p_n, slip) in [(0.3, 1.0, 0.0), (0.4, 1.0, 2.0), (-0.4, 1.0, -2.0), (0.0, 0.0, 7.0)] {
            assert_eq!(tangential_residual(p_t, p_n, slip, 0.4, r), 0.0);
        }
        assert_ne!(tangential_residual(-0.4, 1.0, 2.0, 0.4, r), 0.0);
        assert_ne!(tangential_residual(0.3, 1.0, 0.1, 0.4, r), 0.0);
        assert_ne!(tangential_residual(0.5, 1.0, 0.1, 0.4, r), 0.0);
    }

    #[test]
    fn the_border_counts_as_slip() {
        assert_eq!(tangential_case(0.4, 1.0, 0.0, 0.4, 1.0), TangentialCase::Slip { sign: 1.0 });
        assert_eq!(tangential_case(-0.4, 1.0, 0.0, 0.4, 1.0), TangentialCase::Slip { sign: -1.0 });
        assert_eq!(tangential_case(0.399, 1.0, 0.0, 0.4, 1.0), TangentialCase::Stick);
        assert_eq!(tangential_case(0.1, 0.0, 1.0, 0.4, 1.0), TangentialCase::NoPressure);
        assert_eq!(normal_case(0.0, 0.5, 0.5, 1.0), NormalCase::Open);
    }

    #[test]
    fn where_cases_meet_the_direction_decides() {
        let grazing = |rate| Germ::new(0.0, 0.0, rate);
        assert_eq!(normal_case_ahead(grazing(1.0)), NormalCase::Closed);
        assert_eq!(normal_case_ahead(grazing(-1.0)), NormalCase::Open);
        assert_eq!(normal_case_ahead(Germ::new(0.3, -0.1 - 0.2, 1.0)), NormalCase::Closed);
        assert_eq!(normal_case_ahead(Germ::new(0.3, -0.4, 1.0)), NormalCase::Open);
        // On the border of the cone: q grows slower than the limit, faster, or turns.
        let border = |dq| tangential_case_ahead(Germ::new(1.0, 0.0, 1.0), Germ::new(0.4, 0.0, dq), 0.4);
        assert_eq!(border(0.3), TangentialCase::Stick);
        assert_eq!(border(0.5), TangentialCase::Slip { sign: 1.0 });
        assert_eq!(border(-1.0), TangentialCase::Stick);
        // At the tip of the cone everything depends on the rates.
        let tip = |dp, dq| tangential_case_ahead(grazing(dp), grazing(dq), 0.4);
        assert_eq!(tip(-1.0, 0.0), TangentialCase::NoPressure);
        assert_eq!(tip(1.0, 0.1), TangentialCase::Stick);
        assert_eq!(tip(1.0, -0.5), TangentialCase::Slip { sign: -1.0 });
        // Off the borders it is the case itself.
        assert_eq!(
            tangential_case_ahead(Germ::new(1.0, 0.0, -9.0), Germ::new(0.1, 0.0, 9.0), 0.4),
            TangentialCase::Stick
        );
    }
}
