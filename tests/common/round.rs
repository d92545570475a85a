//! Bodies with a round end, finer where they touch another.

use super::pairs::Side;
use stickslip::body::mesh::{Mesh, block};

/// `n` equal lengths up to `fine`, then lengths in geometric progression by `ratio` up to `end`: the first of those is as near to
/// theirs as their number allows.
pub fn lines(fine: f64, n: usize, end: f64, ratio: f64) -> Vec<f64> {
    let (h, rest) = (fine / n as f64, end - fine);
    let sum = |k: i32| (ratio.powi(k + 1) - ratio) / (ratio - 1.0);
    let count = (1..1000).find(|&k| h * sum(k) >= rest).unwrap();
    let grown = (1..=count).map(|k| fine + rest * sum(k) / sum(count));
    (0..=n).map(|i| fine * i as f64 / n as f64).chain(grown).collect()
}

/// The coordinate at the place `s`, counted in cells.
fn at(lines: &[f64], s: f64) -> f64 {
    let i = (s as usize).min(lines.len() - 2);
    lines[i] + (s - i as f64) * (lines[i + 1] - lines[i])
}

/// The mesh with its nodes moved.
pub fn moved(mut mesh: Mesh, place: impl Fn([f64; 3]) -> [f64; 3]) -> Mesh {
    mesh.nodes.iter_mut().for_each(|x| *x = place(*x));
    mesh
}

/// A body whose end, at the origin, is round, and flat if the radius is infinite.
#[derive(Debug, Clone, Copy)]
pub struct Round {
    /// m.
    pub radius: f64,
    /// Equal elements from the axis on, up to `fine` (m).
    pub n: usize,
    pub fine: f64,
    /// Of each element to the one before it, further out.
    pub ratio: f64,
    /// From the axis to the side, m.
    pub width: f64,
    /// m.
    pub height: f64,
}

impl Round {
    /// How far the end is behind its apex at the distance `r` (m) from the axis.
    pub fn sag(&self, r: f64) -> f64 {
        r * r / (self.radius + (self.radius * self.radius - r * r).sqrt())
    }

    fn across(&self) -> Vec<f64> {
        lines(self.fine, self.n, self.width, self.ratio)
    }

    /// Lines by the distance from the end, from the bottom to the top of the body.
    fn along(&self, side: Side) -> Vec<f64> {
        let depths = lines(2.0 * self.fine / self.n as f64, 2, self.height, self.ratio);
        match side {
            Side::Upper => depths,
            Side::Lower => depths.iter().rev().map(|depth| -depth).collect(),
        }
    }

    /// The coordinate along the axis of what is `y` from a flat end; the other end stays flat.
    fn bent(&self, y: f64, r: f64, side: Side) -> f64 {
        let sag = self.sag(r);
        match side {
            Side::Upper => y + sag * (1.0 - y / self.height),
            Side::Lower => y - sag * (1.0 + y / self.height),
        }
    }

    fn plane(&self, xs: &[f64], side: Side) -> Mesh {
        let ys = self.along(side);
        let elements = [xs.len() - 1, ys.len() - 1];
        moved(block(&elements.map(|n| n as f64), &elements), |[s, t, _]| {
            let x = at(xs, s);
            [x, self.bent(at(&ys, t), x, side), 0.0]
        })
    }

    /// The half x ≥ 0 of a cylinder, or of the section of a ball.
    pub fn half(&self, side: Side) -> Mesh {
        self.plane(&self.across(), side)
    }

    /// The whole of a cylinder.
    pub fn whole(&self, side: Side) -> Mesh {
        let half = self.across();
        let xs: Vec<f64> = half.iter().skip(1).rev().map(|x| -x).chain(half.iter().copied()).collect();
        self.plane(&xs, side)
    }

    /// The quarter x, y ≥ 0 of a ball.
    pub fn quarter(&self, side: Side) -> Mesh {
        let (xs, zs) = (self.across(), self.along(side));
        let elements = [xs.len() - 1, xs.len() - 1, zs.len() - 1];
        moved(block(&elements.map(|n| n as f64), &elements), |[s, t, v]| {
            let (x, y) = (at(&xs, s), at(&xs, t));
            [x, y, self.bent(at(&zs, v), x.hypot(y), side)]
        })
    }
}
