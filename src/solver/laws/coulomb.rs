//! The laws of Signorini and Coulomb at one contact node as equations, and their linearisation:
//! the rows of (19) and the cases of (21). Pure functions of numbers, in any consistent units.
//!
//! Tangential vectors have a component along each of the node's two tangents, `[t, o]`. A component that a node does
//! not have, such as the second in two dimensions, is 0 and has no effect.

use serde::{Deserialize, Serialize};

/// Returns `x₊ = max(x, 0)`; NaN stays NaN, where `f64::max` would give 0.
pub fn positive(x: f64) -> f64 {
    if x <= 0.0 { 0.0 } else { x }
}

/// Returns `|v|` of a tangential vector.
pub fn length([t, o]: [f64; 2]) -> f64 {
    t.hypot(o)
}

/// Returns `v / |v|`; 0 for 0.
pub fn direction(v: [f64; 2]) -> [f64; 2] {
    let length = length(v);
    if length == 0.0 { [0.0; 2] } else { v.map(|x| x / length) }
}

/// Returns `Π(q)`, the projection on the friction disk `|p_T| ≤ radius` (18).
pub fn project(q: [f64; 2], radius: f64) -> [f64; 2] {
    if length(q) > radius { direction(q).map(|n| radius * n) } else { q }
}

/// Returns the normal row of (19): `-min(p_n, r (g - w_n))`.
pub(crate) fn normal_residual(p_n: f64, w_n: f64, gap: f64, r: f64) -> f64 {
    -p_n.min(r * (gap - w_n))
}

/// Returns the tangential rows of (19): `-p_T + Π(p_T + r Δw_T)` with the radius `μ (pressure)₊`; in (19) the
/// pressure is `p_n`. They are computed along and across `p_T`: across `p_T` only the slip contributes, even if it is
/// below the rounding of `p_T / r`.
pub(crate) fn tangential_residual(p: [f64; 2], pressure: f64, slip: [f64; 2], mu: f64, r: f64) -> [f64; 2] {
    let (q, radius) = (trial(p, slip, r), mu * positive(pressure));
    let (size, reach) = (length(p), length(q));
    if reach <= radius {
        return slip.map(|w| r * w);
    }
    if size == 0.0 {
        return project(q, radius);
    }
    // With e along p_T and a across it, p_T + r Δw_T = (|p_T| + r Δw · e) e + (r Δw · a) a.
    let e = direction(p);
    let (along, across) = (r * (e[0] * slip[0] + e[1] * slip[1]), r * (e[0] * slip[1] - e[1] * slip[0]));
    let (along, across) = (radius * ((size + along) / reach) - size, radius * (across / reach));
    [along * e[0] - across * e[1], along * e[1] + across * e[0]]
}

/// Returns `q = p_T + r Δw_T`.
fn trial(p: [f64; 2], slip: [f64; 2], r: f64) -> [f64; 2] {
    [0, 1].map(|d| p[d] + r * slip[d])
}

/// The normal cases of (21).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum NormalCase {
    /// `p_n + r (w_n - g) ≤ 0`; row `-dp_n`.
    Open,
    /// `p_n + r (w_n - g) > 0`; row `r C_n du`.
    Closed,
}

impl From<bool> for NormalCase {
    /// Returns `Closed` for `true`, `Open` for `false`.
    fn from(closed: bool) -> Self {
        if closed { NormalCase::Closed } else { NormalCase::Open }
    }
}

/// The tangential cases of (21), in which the pressure is `p_n`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum TangentialCase {
    /// `pressure ≤ 0`; rows `-dp_T`.
    NoPressure,
    /// `pressure > 0`, `|q| ≤ (1 - SLIP_BORDER) μ pressure`; rows `r C_T du`.
    Stick,
    /// `pressure > 0`, a larger `|q|`; rows `-dp_T + μ n dp_n + R (dp_T + r C_T du)`.
    Slip {
        /// `n = q / |q|`.
        direction: [f64; 2],
        /// `R`, the change of friction with the direction of `q`, row by row. It vanishes if a node has only one
        /// tangent.
        turning: [[f64; 2]; 2],
    },
}

/// The distance of `|q|` below `μ p_n`, as a share of it, from which a node counts as sticking. A node that slipped
/// starts every new increment exactly on that border. The paper's counts are only reproduced if it keeps slipping
/// there in its old direction. The share is well above rounding and far below the effect of any load.
pub(crate) const SLIP_BORDER: f64 = 1e-9;

/// The largest change of slip row coefficients, which are of order one, for which the rows are kept. The factors are
/// then reused, and Newton's step gains as many more digits.
const SAME_SLIP: f64 = 1e-8;

impl TangentialCase {
    /// Returns slip along `q` with the term `R = (μ pressure / |q|) (1 - n nᵀ)` of (21).
    fn slip(q: [f64; 2], pressure: f64, mu: f64) -> Self {
        let ([t, o], share) = (direction(q), mu * pressure / length(q));
        let turning = [[o * o, -t * o], [-t * o, t * t]].map(|row| row.map(|x| share * x));
        TangentialCase::Slip { direction: [t, o], turning }
    }

    /// Returns the case for a node with only one tangent, where friction cannot turn.
    #[must_use]
    pub fn straight(self) -> Self {
        match self {
            TangentialCase::Slip { direction, .. } => TangentialCase::Slip { direction, turning: [[0.0; 2]; 2] },
            other => other,
        }
    }

    /// Returns `true` if the rows equal those of `other`, in slip to eight digits.
    pub fn is_like(&self, other: &Self) -> bool {
        let near = |a: &[f64; 2], b: &[f64; 2]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME_SLIP);
        match (self, other) {
            (TangentialCase::Slip { direction: n, turning: a }, TangentialCase::Slip { direction: m, turning: b }) => {
                near(n, m) && a.iter().zip(b).all(|(a, b)| near(a, b))
            }
            (one, other) => one == other,
        }
    }
}

/// Returns the normal case of a node.
pub fn normal_case(p_n: f64, w_n: f64, gap: f64, r: f64) -> NormalCase {
    if p_n + r * (w_n - gap) > 0.0 { NormalCase::Closed } else { NormalCase::Open }
}

/// Returns the tangential case of a node with the slip increment `slip = w_T - w̄_T`.
pub fn tangential_case(p: [f64; 2], pressure: f64, slip: [f64; 2], mu: f64, r: f64) -> TangentialCase {
    let q = trial(p, slip, r);
    if pressure <= 0.0 {
        TangentialCase::NoPressure
    } else if length(q) <= mu * pressure * (1.0 - SLIP_BORDER) {
        TangentialCase::Stick
    } else {
        TangentialCase::slip(q, pressure, mu)
    }
}

/// A sum of two terms at the start of a direction, and its rate along the direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DirectionalDerivative {
    /// The value of the sum.
    pub value: f64,
    /// The sum of the absolute values of the terms, relative to which rounding is judged.
    pub size: f64,
    /// The rate of the sum.
    pub rate: f64,
}

impl DirectionalDerivative {
    /// Creates `a + b` with the rate of the sum.
    pub fn new(a: f64, b: f64, rate: f64) -> Self {
        DirectionalDerivative { value: a + b, size: a.abs() + b.abs(), rate }
    }

    /// Returns a number with the sign of the sum immediately along the direction; 0 if it stays 0.
    fn ahead(&self) -> f64 {
        if self.value.abs() > SLIP_BORDER * self.size { self.value } else { self.rate }
    }
}

/// Returns the normal case into which a direction leads, from `p_n + r (w_n - g)`: the branch of the directional
/// derivative (20).
pub(crate) fn normal_case_ahead(trial: DirectionalDerivative) -> NormalCase {
    if trial.ahead() > 0.0 { NormalCase::Closed } else { NormalCase::Open }
}

/// Returns the tangential case into which a direction leads, from the pressure and both components of `q`.
pub(crate) fn tangential_case_ahead(
    pressure: DirectionalDerivative,
    q: [DirectionalDerivative; 2],
    mu: f64,
) -> TangentialCase {
    if pressure.ahead() <= 0.0 {
        return TangentialCase::NoPressure;
    }
    let (value, rate) = (q.map(|q| q.value), q.map(|q| q.rate));
    let grown = length(value) > SLIP_BORDER * length(q.map(|q| q.size));
    let n = direction(if grown { value } else { rate });
    let along = |v: [f64; 2]| n[0] * v[0] + n[1] * v[1];
    let excess = DirectionalDerivative::new(along(value), -mu * pressure.value, along(rate) - mu * pressure.rate);
    if excess.ahead() < 0.0 {
        TangentialCase::Stick
    } else if grown {
        TangentialCase::slip(value, pressure.value, mu)
    } else {
        TangentialCase::slip(rate, pressure.rate, mu)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns `true` for slip along the only tangent with this sign.
    fn slips(case: TangentialCase, sign: f64) -> bool {
        matches!(case, TangentialCase::Slip { direction, .. } if direction == [sign, 0.0])
    }

    #[test]
    fn residuals_vanish_exactly_on_the_law() {
        let r = 3.0;
        // The cases open, grazing and closed.
        for (p_n, w_n) in [(0.0, -1.0), (0.0, 0.5), (2.0, 0.5)] {
            assert_eq!(normal_residual(p_n, w_n, 0.5, r), 0.0);
        }
        assert_ne!(normal_residual(2.0, 0.4, 0.5, r), 0.0);
        assert_ne!(normal_residual(-1.0, 0.5, 0.5, r), 0.0);
        assert_ne!(normal_residual(0.0, 0.6, 0.5, r), 0.0);
        // The cases stick, slip either way and no pressure; then along the other tangent, and between both.
        let residual = |p, p_n, slip| tangential_residual(p, p_n, slip, 0.4, r);
        for (p, p_n, slip) in [(0.3, 1.0, 0.0), (0.4, 1.0, 2.0), (-0.4, 1.0, -2.0), (0.0, 0.0, 7.0)] {
            assert_eq!(residual([p, 0.0], p_n, [slip, 0.0]), [0.0; 2]);
            assert_eq!(residual([0.0, p], p_n, [0.0, slip]), [0.0; 2]);
        }
        assert_eq!(residual([0.2, -0.3], 1.0, [0.0; 2]), [0.0; 2]);
        let slip = residual([0.24, -0.32], 1.0, [3.0, -4.0]);
        assert!(length(slip) < 1e-16, "{slip:?}");
        assert_ne!(residual([-0.4, 0.0], 1.0, [2.0, 0.0]), [0.0; 2]);
        assert_ne!(residual([0.3, 0.0], 1.0, [0.1, 0.0]), [0.0; 2]);
        assert_ne!(residual([0.5, 0.0], 1.0, [0.1, 0.0]), [0.0; 2]);
        assert_ne!(residual([0.32, 0.24], 1.0, [3.0, 4.0]), [0.0; 2]);
    }

    #[test]
    fn the_border_counts_as_slip() {
        let case = |p, p_n, slip| tangential_case([p, 0.0], p_n, [slip, 0.0], 0.4, 1.0);
        assert!(slips(case(0.4, 1.0, 0.0), 1.0));
        assert!(slips(case(-0.4, 1.0, 0.0), -1.0));
        assert_eq!(case(0.399, 1.0, 0.0), TangentialCase::Stick);
        assert_eq!(case(0.1, 0.0, 1.0), TangentialCase::NoPressure);
        assert_eq!(normal_case(0.0, 0.5, 0.5, 1.0), NormalCase::Open);
    }

    /// `R` is the derivative of `μ pressure q / |q|`, and vanishes along the only tangent.
    #[test]
    fn friction_turns_with_slip() {
        let (q, pressure, mu, step) = ([0.9, -1.2], 2.0, 0.4, 1e-6);
        let TangentialCase::Slip { turning, .. } = tangential_case(q, pressure, [0.0; 2], mu, 1.0) else { panic!() };
        for b in 0..2 {
            let [ahead, behind] = [step, -step].map(|step| {
                let mut q = q;
                q[b] += step;
                project(q, mu * pressure)
            });
            for a in 0..2 {
                let difference = (ahead[a] - behind[a]) / (2.0 * step);
                assert!((difference - turning[a][b]).abs() < 1e-10, "{difference} {turning:?}");
            }
        }
        let case = tangential_case([0.9, 0.0], pressure, [0.0; 2], mu, 1.0);
        let TangentialCase::Slip { turning, .. } = case else { panic!() };
        assert_eq!((turning[0], turning[1][0]), ([0.0; 2], 0.0));
    }

    #[test]
    fn where_cases_meet_the_direction_decides() {
        let grazing = |rate| DirectionalDerivative::new(0.0, 0.0, rate);
        let flat = |q| [q, grazing(0.0)];
        assert_eq!(normal_case_ahead(grazing(1.0)), NormalCase::Closed);
        assert_eq!(normal_case_ahead(grazing(-1.0)), NormalCase::Open);
        assert_eq!(normal_case_ahead(DirectionalDerivative::new(0.3, -0.1 - 0.2, 1.0)), NormalCase::Closed);
        assert_eq!(normal_case_ahead(DirectionalDerivative::new(0.3, -0.4, 1.0)), NormalCase::Open);
        // On the border of the cone q grows slower than the limit, faster, or turns.
        let border = |dq| {
            tangential_case_ahead(
                DirectionalDerivative::new(1.0, 0.0, 1.0),
                flat(DirectionalDerivative::new(0.4, 0.0, dq)),
                0.4,
            )
        };
        assert_eq!(border(0.3), TangentialCase::Stick);
        assert!(slips(border(0.5), 1.0));
        assert_eq!(border(-1.0), TangentialCase::Stick);
        // At the tip of the cone only the rates decide.
        let tip = |dp, dq| tangential_case_ahead(grazing(dp), flat(grazing(dq)), 0.4);
        assert_eq!(tip(-1.0, 0.0), TangentialCase::NoPressure);
        assert_eq!(tip(1.0, 0.1), TangentialCase::Stick);
        assert!(slips(tip(1.0, -0.5), -1.0));
        // Off the borders the case ahead is the case itself.
        let inside = tangential_case_ahead(
            DirectionalDerivative::new(1.0, 0.0, -9.0),
            flat(DirectionalDerivative::new(0.1, 0.0, 9.0)),
            0.4,
        );
        assert_eq!(inside, TangentialCase::Stick);
        // In two directions, motion along the rim keeps |q| at the limit, which grows.
        let rim = |rate| {
            tangential_case_ahead(
                DirectionalDerivative::new(1.0, 0.0, rate),
                [DirectionalDerivative::new(0.4, 0.0, 0.0), grazing(3.0)],
                0.4,
            )
        };
        assert_eq!(rim(1.0), TangentialCase::Stick);
        assert!(slips(rim(-1.0), 1.0));
    }

    #[test]
    fn the_row_is_the_projection() {
        let (mu, r) = (0.4, 1.5);
        for (p, p_n, slip) in [
            ([0.3, -0.1], 1.0, [0.2, 0.4]),
            ([0.3, -0.1], 1.0, [-0.2, 0.1]),
            ([0.1, 0.1], 1.0, [0.01, 0.0]),
            ([0.0, 0.0], 1.0, [1.0, 1.0]),
            ([0.3, 0.2], -1.0, [0.1, 0.0]),
            ([-0.3, 0.0], 1.0, [-0.7, 0.0]),
        ] {
            let (row, projected) =
                (tangential_residual(p, p_n, slip, mu, r), project(trial(p, slip, r), mu * positive(p_n)));
            assert!(
                (0..2).all(|d| (row[d] + p[d] - projected[d]).abs() < 1e-15),
                "{p:?} {slip:?}: {row:?} {projected:?}"
            );
        }
        // Across a force of 0.5 a slip of 1e-20 has an effect.
        let [_, across] = tangential_residual([0.5, 0.0], 1.0, [1e-9, 1e-20], 0.5, 1.0);
        assert!((across - 1e-20).abs() < 1e-28, "{across:e}");
    }
}
