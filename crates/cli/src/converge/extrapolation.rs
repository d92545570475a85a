//! The limit of a sequence of values under refinement, and the error of the last one.
//!
//! This is the grid convergence index of Celik et al., J. Fluids Eng. 130 (2008) 078001, with limited orders as proposed
//! by Eça and Hoekstra, J. Comput. Phys. 262 (2014) 104. With the values f1 (finest), f2, f3 of the element sizes
//! h1 < h2 < h3 and r = h2 / h1, the order p follows from
//!
//! (f3 - f2) / (f2 - f1) = (h3^p - h2^p) / (h2^p - h1^p),
//!
//! the limit is f1 + (f1 - f2) / (r^p - 1), and the error of f1 is 1.25 |f1 - f2| / (r^p - 1).

use std::fmt;

use serde::Serialize;

/// The limit of a sequence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// The behaviour of the last three values.
    pub behaviour: Behaviour,
    /// The observed order; `None` for two values, and if the values oscillate or are constant.
    pub order: Option<f64>,
    /// The extrapolated value; the last value if extrapolation means nothing.
    pub extrapolated: f64,
    /// The uncertainty of the last value, in the unit of the values.
    pub uncertainty: f64,
}

/// The behaviour of a sequence under refinement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Behaviour {
    /// There are only two values.
    TwoValues,
    /// The differences have one sign, and fall.
    Monotone,
    /// The differences change their sign.
    Oscillating,
    /// The differences have one sign, and do not fall.
    Growing,
    /// The values are equal up to rounding.
    Constant,
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.behaviour, self.order) {
            (Behaviour::TwoValues, _) => f.write_str("two values"),
            (Behaviour::Monotone, Some(order)) => write!(f, "order {order:.1}"),
            (Behaviour::Oscillating, _) => f.write_str("oscillating"),
            (Behaviour::Constant, _) => f.write_str("constant"),
            _ => f.write_str("no order"),
        }
    }
}

/// The safety factor of three values that approach a limit.
const SAFETY: f64 = 1.25;

/// The safety factor of two values, and of values that do not approach a limit.
const SAFETY_OF_TWO: f64 = 3.0;

/// The order of two values, the lowest one of the elements and increments here.
const ORDER_OF_TWO: f64 = 1.0;

/// The range of the order in the formulas. A larger observed order is an accident of the last difference, which then
/// counts as at least the one before, times the factor of the highest order.
const ORDERS: [f64; 2] = [0.5, 2.0];

/// Differences below this share of the value are rounding errors, and errors of the solver.
pub(super) const ROUNDING: f64 = 1e-8;

/// Values with a smaller observed order have no limit.
const NO_ORDER: f64 = 0.3;

/// A singular value grows at least so fast: as `h^-0.1`, by 7 % with half the element size.
const SINGULAR_GROWTH: f64 = 0.1;

/// A singular value keeps this share of its rate of growth. At an edge with a radius the rate falls as soon as elements are
/// a few times as large as the radius.
const STEADY: f64 = 0.9;

/// Returns the limit of `values`, the finest last, with the element sizes or increments `sizes`. `None` for fewer than
/// two values.
pub fn limit(sizes: &[f64], values: &[f64]) -> Option<Limit> {
    let (&[.., h2, h1], &[.., f2, f1]) = (sizes, values) else { return None };
    let r = h2 / h1;
    let last = f1 - f2;
    let growth = |p: f64| r.powf(p) - 1.0;
    let (&[.., h3, _, _], &[.., f3, _, _]) = (sizes, values) else {
        let uncertainty = SAFETY_OF_TWO * last.abs() / growth(ORDER_OF_TWO);
        let is_constant = last.abs() <= ROUNDING * f1.abs();
        let behaviour = if is_constant { Behaviour::Constant } else { Behaviour::TwoValues };
        return Some(Limit { behaviour, order: None, extrapolated: f1, uncertainty });
    };
    let before = f2 - f3;
    // The last difference that follows from the one before with order p.
    let follows = |p: f64| before * (h2.powf(p) - h1.powf(p)) / (h3.powf(p) - h2.powf(p));
    let largest = last.abs().max(before.abs());
    if largest <= ROUNDING * f1.abs() {
        return Some(Limit { behaviour: Behaviour::Constant, order: None, extrapolated: f1, uncertainty: largest });
    }
    if last * before < 0.0 {
        return Some(Limit { behaviour: Behaviour::Oscillating, order: None, extrapolated: f1, uncertainty: largest });
    }
    let order = observed_order([h3, h2, h1], last / before);
    if order < NO_ORDER {
        let uncertainty = SAFETY_OF_TWO * last.abs() / growth(ORDERS[0]);
        return Some(Limit { behaviour: Behaviour::Growing, order: Some(order), extrapolated: f1, uncertainty });
    }
    let p = order.clamp(ORDERS[0], ORDERS[1]);
    let step = if order > ORDERS[1] { follows(p) } else { last };
    let distance = step / growth(p);
    Some(Limit {
        behaviour: Behaviour::Monotone,
        order: Some(order),
        extrapolated: f1 + last / growth(p),
        uncertainty: SAFETY * distance.abs(),
    })
}

/// Returns the order p at which the last difference is `share` of the one before, between -2 and 8.
fn observed_order([h3, h2, h1]: [f64; 3], share: f64) -> f64 {
    // The share falls with p. At p = 0 powers become logarithms.
    let of = |p: f64| {
        if p.abs() < 1e-9 {
            (h2 / h1).ln() / (h3 / h2).ln()
        } else {
            (h2.powf(p) - h1.powf(p)) / (h3.powf(p) - h2.powf(p))
        }
    };
    let [mut low, mut high] = [-2.0, 8.0];
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if of(middle) > share {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Returns `true` if `values`, the finest last, grow without a limit: twice in a row by about the same factor for the
/// same ratio of the sizes.
pub fn is_singular(sizes: &[f64], values: &[f64]) -> bool {
    let (&[.., h3, h2, h1], &[.., f3, f2, f1]) = (sizes, values) else { return false };
    if f3 <= 0.0 {
        return false;
    }
    let rate = |coarse: [f64; 2], fine: [f64; 2]| (fine[1] / coarse[1]).ln() / (coarse[0] / fine[0]).ln();
    let (before, last) = (rate([h3, f3], [h2, f2]), rate([h2, f2], [h1, f1]));
    let limit = limit(&[h3, h2, h1], &[f3, f2, f1]);
    last > SINGULAR_GROWTH
        && last > STEADY * before
        && before > 0.5 * SINGULAR_GROWTH
        && limit.is_some_and(|limit| limit.behaviour == Behaviour::Growing)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    /// Values 3 + c h^p.
    fn values(sizes: &[f64], c: f64, p: f64) -> Vec<f64> {
        sizes.iter().map(|h| 3.0 + c * h.powf(p)).collect()
    }

    const HALVED: [f64; 3] = [1.0, 0.5, 0.25];
    /// Ratios that differ, as of rounded numbers of elements.
    const UNEVEN: [f64; 3] = [1.0, 0.7, 0.4];

    #[test]
    fn powers_are_extrapolated_exactly() {
        for sizes in [HALVED, UNEVEN] {
            for p in [0.5, 1.0, 1.7, 2.0] {
                for c in [0.8, -0.8] {
                    let values = values(&sizes, c, p);
                    let found = limit(&sizes, &values).unwrap();
                    assert_eq!(found.behaviour, Behaviour::Monotone);
                    assert!((found.order.unwrap() - p).abs() < 1e-6, "{found:?}");
                    assert!((found.extrapolated - 3.0).abs() < 1e-6, "{found:?}");
                    let error = (values[2] - 3.0).abs();
                    assert!((found.uncertainty - 1.25 * error).abs() < 1e-6, "{found:?}");
                }
            }
        }
    }

    #[test]
    fn high_orders_are_not_believed() {
        // The last difference of order 4 is 1/16 of the one before. It counts as a quarter.
        let found = limit(&HALVED, &values(&HALVED, 1.0, 4.0)).unwrap();
        let before: f64 = 1.0 - 1.0 / 16.0;
        assert!((found.uncertainty - 1.25 * before / 4.0 / 3.0).abs() < 1e-9, "{found:?}");
        // A last difference of zero says nothing about the error.
        let found = limit(&HALVED, &[2.0, 3.0, 3.0]).unwrap();
        assert!((found.uncertainty - 1.25 / 12.0).abs() < 1e-9 && found.extrapolated == 3.0, "{found:?}");
    }

    #[test]
    fn two_values_have_a_wide_margin() {
        let found = limit(&[1.0, 0.5], &[3.2, 3.1]).unwrap();
        assert_eq!(found.behaviour, Behaviour::TwoValues);
        assert!((found.uncertainty - 0.3).abs() < 1e-12);
        assert_eq!(limit(&[1.0], &[3.0]), None);
    }

    #[test]
    fn oscillating_values_are_known_to_their_swing() {
        let found = limit(&HALVED, &[3.2, 2.9, 3.05]).unwrap();
        assert_eq!(found.behaviour, Behaviour::Oscillating);
        assert!((found.uncertainty - 0.3).abs() < 1e-12 && found.order.is_none());
    }

    #[test]
    fn constant_values_are_exact() {
        let found = limit(&HALVED, &[3.0; 3]).unwrap();
        assert_eq!((found.behaviour, found.uncertainty, found.extrapolated), (Behaviour::Constant, 0.0, 3.0));
        assert_eq!(limit(&HALVED, &[0.0; 3]).unwrap().behaviour, Behaviour::Constant);
    }

    #[test]
    fn singular_values_have_no_limit() {
        for sizes in [HALVED, UNEVEN] {
            for p in [-0.5, -0.3, -0.15] {
                let values: Vec<f64> = sizes.iter().map(|h| 2.0 * h.powf(p)).collect();
                assert_eq!(limit(&sizes, &values).unwrap().behaviour, Behaviour::Growing);
                assert!(is_singular(&sizes, &values), "{values:?}");
            }
            for p in [0.5, 1.0, 2.0] {
                assert!(!is_singular(&sizes, &values(&sizes, -1.0, p)));
            }
        }
        // A slow change of equal steps has no limit either, but is too small to be called singular.
        assert!(!is_singular(&HALVED, &[3.0, 3.01, 3.02]));
    }
}
