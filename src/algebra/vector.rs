//! Vectors, mostly in space; plane vectors have z = 0.

use std::fmt;

use serde::Deserialize;

/// A vector with two or three coordinates, as in an input.
#[derive(Clone, Copy, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(try_from = "Vec<f64>")]
#[schemars(inline, extend("minItems" = 2, "maxItems" = 3))]
pub struct Vector {
    components: [f64; 3],
    dimension: usize,
}

impl Vector {
    /// Returns all three coordinates; z = 0 if it is not given.
    pub fn components(self) -> [f64; 3] {
        self.components
    }

    /// Returns the number of given coordinates, 2 or 3.
    pub fn dimension(self) -> usize {
        self.dimension
    }

    /// Applies `change` to each coordinate.
    #[must_use]
    pub fn map(self, change: impl FnMut(f64) -> f64) -> Self {
        Vector { components: self.components.map(change), ..self }
    }
}

impl fmt::Debug for Vector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.components[..self.dimension].fmt(f)
    }
}

impl From<[f64; 2]> for Vector {
    fn from([x, y]: [f64; 2]) -> Self {
        Vector { components: [x, y, 0.0], dimension: 2 }
    }
}

impl From<[f64; 3]> for Vector {
    fn from(components: [f64; 3]) -> Self {
        Vector { components, dimension: 3 }
    }
}

impl TryFrom<Vec<f64>> for Vector {
    type Error = String;

    fn try_from(values: Vec<f64>) -> Result<Self, String> {
        match values[..] {
            [x, y] => Ok([x, y].into()),
            [x, y, z] => Ok([x, y, z].into()),
            _ => Err(format!("invalid length {}, expected 2 or 3 values", values.len())),
        }
    }
}

/// Returns `a · b` for vectors of equal length, in eight parallel sums.
#[inline]
pub fn dot(a: impl AsRef<[f64]>, b: impl AsRef<[f64]>) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_ref().as_chunks::<8>(), b.as_ref().as_chunks::<8>());
    let mut sums = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        for k in 0..8 {
            sums[k] += a[k] * b[k];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.into_iter().sum::<f64>() + rest
}

/// Returns `a × b`.
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Returns `a - b`.
pub fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Returns `a + s b`.
pub fn plus(a: [f64; 3], s: f64, b: [f64; 3]) -> [f64; 3] {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

/// Returns `a` without its component along the unit vector `axis`.
pub fn across(a: [f64; 3], axis: [f64; 3]) -> [f64; 3] {
    plus(a, -dot(a, axis), axis)
}

/// Returns `|a|`, without overflow.
pub fn norm(a: [f64; 3]) -> f64 {
    a[0].hypot(a[1]).hypot(a[2])
}

/// Returns `a / |a|`.
pub fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = norm(a);
    a.map(|c| c / length)
}

/// Returns the unit vector along axis `c`: 0 for x, 1 for y, 2 for z.
pub fn axis(c: usize) -> [f64; 3] {
    [0, 1, 2].map(|k| if k == c { 1.0 } else { 0.0 })
}

/// Returns the unit vector orthogonal to the unit vector `normal` that is closest to axis `c`.
pub fn axis_across(c: usize, normal: [f64; 3]) -> [f64; 3] {
    // + 0.0 turns -0 into 0.
    unit(minus(axis(c), normal.map(|n| n * normal[c])).map(|c| c + 0.0))
}

/// Returns the upper median of `values`, which are reordered, or `None` if there are none.
pub fn median(values: &mut [f64]) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_of_any_length() {
        let a: Vec<f64> = (0..20).map(f64::from).collect();
        for n in [0, 1, 3, 7, 8, 9, 16, 20] {
            let squares: f64 = a[..n].iter().map(|x| x * x).sum();
            assert_eq!(dot(&a[..n], &a[..n]), squares);
        }
        assert_eq!(dot([1.0, 2.0, 3.0], [4.0, -5.0, 6.0]), 12.0);
    }

    #[test]
    fn axes_lie_across_a_normal() {
        assert_eq!(axis_across(0, axis(2)), axis(0));
        assert_eq!(axis_across(0, [-0.6, 0.0, 0.8]).map(|c| (10.0 * c).round()), [8.0, 0.0, 6.0]);
    }

    #[test]
    fn medians_are_values() {
        assert_eq!(
            [median(&mut [3.0, 1.0, 2.0]), median(&mut [2.0, 1.0]), median(&mut [])],
            [Some(2.0), Some(2.0), None]
        );
    }
}
