//! Intersection of a line with a surface that is given by its height.

/// The largest number of steps of the search. Each step at least doubles the previous step or halves the remaining
/// interval.
const MOST: usize = 200;

/// A line that approaches a surface by less than this share of its length counts as parallel to it; an intersection
/// would be millions of lengths away.
pub(super) const GRAZING: f64 = 1e-6;

/// The relative rounding error of a position on the line.
const POSITION_ROUNDING: f64 = 2.0 * f64::EPSILON;

/// Returns the distance along a line at which it meets a surface. `height` is the signed distance of the surface from a
/// point of the line along the surface's own direction: positive before the surface, negative behind it. `closing` is
/// the cosine of the angle between both directions. If there are several intersections, the result is the one that the
/// iteration reaches, with steps that would end on a level surface. NaN if the line leads away from the surface or off
/// it, where the height is NaN.
pub(super) fn crossing(height: impl Fn(f64) -> f64, closing: f64) -> f64 {
    let (mut here, mut above) = (0.0, height(0.0));
    if closing <= GRAZING || above.is_nan() {
        return f64::NAN;
    }
    let (mut reach, mut ends) = (1.0 / closing, false);
    for _ in 0..MOST {
        let next = here + reach * above;
        if !next.is_finite() {
            return f64::NAN;
        }
        if above == 0.0 || (next - here).abs() <= POSITION_ROUNDING * next.abs() {
            // Steps that had to be shortened lead to the rim.
            return if ends { f64::NAN } else { here };
        }
        let there = height(next);
        if there.is_nan() {
            // The step left the surface; the line may meet it before.
            (reach, ends) = (0.5 * reach, true);
        } else if there * above <= 0.0 {
            return between(height, (here, above), (next, there));
        } else {
            (here, above) = (next, there);
            reach *= 2.0;
        }
    }
    f64::NAN
}

/// Finds the zero of `height` between two points with their heights, one positive and one not, by the Illinois method:
/// secants in which the height of a retained end is halved.
fn between(height: impl Fn(f64) -> f64, mut one: (f64, f64), mut other: (f64, f64)) -> f64 {
    for _ in 0..MOST {
        if other.1 == 0.0 || (other.0 - one.0).abs() <= POSITION_ROUNDING * other.0.abs() {
            break;
        }
        let next = other.0 - other.1 * (other.0 - one.0) / (other.1 - one.1);
        let there = height(next);
        if there.is_nan() {
            return f64::NAN;
        }
        if there * other.1 < 0.0 {
            one = other;
        } else {
            one.1 *= 0.5;
        }
        if next == other.0 {
            break;
        }
        other = (next, there);
    }
    other.0
}

#[cfg(test)]
mod tests {
    use super::crossing;

    /// A line that leans by 30 degrees over a plane, a parabola, a roof and a step outside its path.
    #[test]
    fn the_places_where_a_line_ends() {
        let (sin, cos) = (0.5, 0.75_f64.sqrt());
        // From (x, 0) upwards to the side, to a surface at the height h(x).
        let met = |x: f64, h: &dyn Fn(f64) -> f64| crossing(|s| h(x + s * sin) - s * cos, cos);
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-15 * (1.0 + b.abs());
        assert!(close(met(0.3, &|_| 0.7), 0.7 / cos));
        assert!(close(met(0.3, &|_| -0.7), -0.7 / cos));
        assert_eq!(met(0.3, &|_| 0.0), 0.0);
        // 1/2 + (s/2)² = s cos at the first of two places.
        assert!(close(met(0.0, &|x| 0.5 + x * x), 2.0 * (cos - 0.25_f64.sqrt())));
        // A slope of 2 climbs faster than the line; downwards it is met.
        assert!(met(0.0, &|x| 1.0 + 2.0 * x).is_nan());
        assert!(close(met(0.0, &|x| 1.0 - 2.0 * x), 1.0 / (cos + 1.0)));
        assert!(close(met(0.0, &|x| (x - 0.25).abs()), 0.25 / (cos + 0.5)));
        // There is no surface beyond 1, neither for the first step nor at the intersection.
        let ends = |h: f64| move |x: f64| if x < 1.0 { h - x } else { f64::NAN };
        assert!(close(met(0.0, &ends(2.0)), 2.0 / (cos + 0.5)) && met(0.0, &ends(9.0)).is_nan());
        assert!(crossing(|s| 1.0 + s, 0.0).is_nan() && crossing(|_| f64::NAN, 1.0).is_nan());
    }
}
