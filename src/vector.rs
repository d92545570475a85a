//! Vectors in space; those of the plane have z = 0.

use std::fmt;

use serde::Deserialize;

/// Two or three coordinates, as an input gives them.
#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(try_from = "Vec<f64>")]
pub struct Vector {
    components: [f64; 3],
    dimension: usize,
}

impl Vector {
    /// All three, z = 0 where it is not given.
    pub fn components(self) -> [f64; 3] {
        self.components
    }

    /// How many are given, 2 or 3.
    pub fn dimension(self) -> usize {
        self.dimension
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

/// `a · b`.
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a × b`.
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a - b`.
pub fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `|a|`, without overflow.
pub fn norm(a: [f64; 3]) -> f64 {
    a[0].hypot(a[1]).hypot(a[2])
}

/// `a / |a|`.
pub fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = norm(a);
    a.map(|c| c / length)
}
