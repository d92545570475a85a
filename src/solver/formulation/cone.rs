//! The exact cone as the constraint of an interior point method: the equations on
//! `z = (u, p_t, p_o, p_n, v_n, s, λ)` with one `s` and one `λ` for every node with friction.
//!
//! With `ρ = μ p_n`, `p_T = (p_t, p_o)` and the slip increment `Δw_T`:
//!
//! | place | row |
//! | --- | --- |
//! | `u` | `K u + C_tᵀ p_t + C_oᵀ p_o + C_nᵀ p_n - f` |
//! | `p_n` | `v_n + C_n u - g` |
//! | `p_T` | `-Δw_T + 2 λ p_T / ρ` |
//! | `s` | `s - ρ + p_T² / ρ` |
//! | `v_n` | `p_n v_n` |
//! | `λ` | `λ s` |
//!
//! `ρ² - p_T² ≥ 0` divided by `ρ`: undivided, it has no gradient at the tip of the cone. In two dimensions
//! `s` is the product of the two slacks of (25) over `ρ`, and `λ` is half the slip.
//!
//! A node without friction or without tangential freedom has no `p_T`, `s` and `λ`.

use super::interior::{Face, InteriorPoint, Pair, Paired};
use super::mixed::TangentialRow;
use super::{Assembled, FormulationScaling};
use crate::algebra::vector::dot;
use crate::base::units::Scaling;
use crate::solver::laws::coulomb::{direction, length as size};
use crate::solver::problem::ContactProblem;

/// The equations of a problem, in the units of its scaling, and their Newton system on `(u, p_t, p_o, p_n)`.
pub struct ConeSystem {
    paired: Paired,
    /// The pair `(s, λ)` of each contact node with friction.
    friction: Vec<Option<Pair>>,
}

/// The values of a node with friction at a point.
struct Node {
    mu: f64,
    /// `e = p_T / ρ`.
    e: [f64; 2],
    s: f64,
    lambda: f64,
    /// `λ / ρ`.
    stiffness: f64,
}

impl Node {
    /// Returns `1 + e²`; `s` grows with `p_n` at the rate `μ` times this.
    fn widening(&self) -> f64 {
        1.0 + dot(self.e, self.e)
    }
}

impl ConeSystem {
    /// Sets up the equations of `problem`. The `conventions` affect [`InteriorPoint::theta`] alone.
    pub fn new(problem: &ContactProblem, scaling: Scaling, conventions: &FormulationScaling) -> Self {
        Self::on(Assembled::new(problem, scaling), conventions)
    }

    /// Creates the equations on an assembled problem.
    pub fn on(assembled: Assembled, conventions: &FormulationScaling) -> Self {
        let layout = assembled.layout();
        let (first, contacts) = (layout.unknowns(), layout.contacts());
        let normal = (0..contacts).map(|i| Pair { force: layout.p_n(i), length: first + i });
        let mut pairs: Vec<Pair> = normal.collect();
        let frictional = (0..contacts).filter(|&i| layout.has_friction(i)).count();
        let mut next = first + contacts;
        let mut place = |i: usize| {
            layout.has_friction(i).then(|| {
                let pair = Pair { force: next, length: next + frictional };
                next += 1;
                pair
            })
        };
        let friction: Vec<Option<Pair>> = (0..contacts).map(&mut place).collect();
        pairs.extend(friction.iter().flatten());
        ConeSystem { paired: Paired::new(assembled, conventions, pairs), friction }
    }

    /// Returns the values of node `i` at `z` and its pair `(s, λ)`, if it has friction.
    fn node(&self, i: usize, z: &[f64]) -> Option<(Node, Pair)> {
        let (pair, data) = (self.friction[i]?, &self.paired.data);
        let (mu, s, lambda) = (data.mu[i], z[pair.force], z[pair.length]);
        let radius = mu * z[data.layout.p_n(i)];
        let e = data.friction(i, z).map(|p| p / radius);
        Some((Node { mu, e, s, lambda, stiffness: lambda / radius }, pair))
    }
}

impl InteriorPoint for ConeSystem {
    fn paired(&self) -> &Paired {
        &self.paired
    }

    fn paired_mut(&mut self) -> &mut Paired {
        &mut self.paired
    }

    fn friction_rows(&self, i: usize, z: &[f64], h: &mut [f64]) {
        let Some((node, pair)) = self.node(i, z) else { return };
        let data = &self.paired.data;
        let slip = data.slip(i, data.tangential(i, z));
        data.layout.set_tangential(i, [0, 1].map(|d| 2.0 * node.lambda * node.e[d] - slip[d]), h);
        h[pair.force] = node.s - node.mu * z[data.layout.p_n(i)] * (1.0 - dot(node.e, node.e));
    }

    /// Writes the slip rows. With the right-hand sides `b_w` (slip rows), `b_s` (cone row) and `b_sλ` (product), the row
    /// of `s` gives `ds = b_s + μ (1 + e²) dp_n - 2 e·dp_T`. With `dλ` from the product, the slip rows times `s` are
    ///
    /// `-s dw_T + (2 λ s / ρ) (dp_T - μ e dp_n) + 4 λ e (e·dp_T) - 2 λ μ (1 + e²) e dp_n
    ///   = s b_w - 2 e (b_sλ - λ b_s)`
    ///
    /// Only `p_T` and `λ s` are divided by a quantity that goes to zero, `ρ`, and they go to zero with it.
    fn linearize_friction(&mut self, i: usize, z: &[f64]) {
        let Some((node, _)) = self.node(i, z) else { return };
        let Node { mu, e, s, lambda, stiffness } = node;
        let (round, along) = (2.0 * stiffness * s, 4.0 * lambda);
        let scale = s.max(round + along * dot(e, e));
        let by_p_n = -mu * (round + 2.0 * lambda * node.widening());
        for d in 0..2 {
            let unit = [f64::from(u8::from(d == 0)), f64::from(u8::from(d == 1))];
            let row = TangentialRow {
                w: unit.map(|x| -s * x / scale),
                p: [0, 1].map(|k| (round * unit[k] + along * e[d] * e[k]) / scale),
                p_n: by_p_n * e[d] / scale,
            };
            self.paired.matrix.set_tangential(i, d, &row);
        }
        self.paired.row_scale[i][1] = scale;
    }

    fn reduce_friction(&self, i: usize, z: &[f64], b: &[f64], rhs: &mut [f64]) {
        let Some((node, pair)) = self.node(i, z) else { return };
        let multiplier = b[pair.length] - node.lambda * b[pair.force];
        let (b, scale) = (self.paired.data.friction(i, b), self.paired.row_scale[i][1]);
        let rows = [0, 1].map(|d| (node.s * b[d] - 2.0 * node.e[d] * multiplier) / scale);
        self.forces().set_tangential(i, rows, rhs);
    }

    fn recover_friction(&self, i: usize, z: &[f64], b: &[f64], dz: &mut [f64]) {
        let Some((node, pair)) = self.node(i, z) else { return };
        let along = dot(node.e, self.paired.data.friction(i, dz));
        let dp_n = dz[self.pairs()[i].force];
        dz[pair.force] = b[pair.force] + node.mu * node.widening() * dp_n - 2.0 * along;
        dz[pair.length] = (b[pair.length] - node.lambda * dz[pair.force]) / node.s;
    }

    /// Uses the same values for all nodes, without friction: the last solution's forces affect the scale only. A
    /// start too far inside costs an iteration or two; one too near the border is a bad start.
    fn move_inside(&self, z: &mut [f64], force: f64, length: f64) {
        let (data, layout) = (&self.paired.data, &self.paired.data.layout);
        let last = (0..layout.contacts()).map(|i| z[layout.p_n(i)]).fold(0.0, f64::max);
        let share = (last / force).max(1.0);
        let (force, length) = (share * force, share * length);
        for i in 0..layout.contacts() {
            let (p_n, v_n) = self.paired.normal(i);
            (z[p_n], z[v_n]) = (force, length);
            layout.set_tangential(i, [0.0; 2], z);
            if let Some(pair) = self.friction[i] {
                let (mu, slip) = (data.mu[i], data.excess_slip(i, z, length));
                // With |p_T| = e ρ along the slip and e / (1 - e²) = far, both equations of friction hold, and the
                // product of the pair equals that without slip.
                let far = 0.5 * mu * size(slip) / length;
                let inside = 2.0 / (1.0 + 1.0_f64.hypot(2.0 * far));
                layout.set_tangential(i, direction(slip).map(|n| inside * far * mu * force * n), z);
                (z[pair.force], z[pair.length]) = (mu * force * inside, length / mu / inside);
            }
        }
    }

    /// The slip rows are not linear on the faces of the cone, since friction turns.
    fn face_ahead(&self, _before: &[f64], _z: &[f64]) -> Option<Face> {
        None
    }
}
