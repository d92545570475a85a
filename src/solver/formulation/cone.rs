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

use super::interior::InteriorPoint;
use super::mixed::{MixedMatrix, TangentialRow};
use super::natural::{NaturalRows, half_square};
use super::pairs::{Face, Pair};
use super::scaled::ScaledData;
use super::{Assembled, FormulationScaling, Layout};
use crate::algebra::linear::{LinearError, SystemMatrix};
use crate::algebra::vector::dot;
use crate::base::units::Scaling;
use crate::solver::laws::coulomb::{direction, length as size};
use crate::solver::problem::{ContactProblem, Increment};

/// The equations of a problem, in the units of its scaling, and their Newton system on `(u, p_t, p_o, p_n)`.
pub struct ConeSystem {
    data: ScaledData,
    natural: NaturalRows,
    matrix: MixedMatrix,
    pairs: Vec<Pair>,
    /// The pair `(s, λ)` of each contact node with friction.
    friction: Vec<Option<Pair>>,
    /// The largest coefficient, by which each normal row and then each tangential row was divided.
    row_scale: Vec<[f64; 2]>,
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
        let Assembled { data, matrix } = assembled;
        let (first, contacts) = (data.layout.unknowns(), data.layout.contacts());
        let normal = (0..contacts).map(|i| Pair { force: data.layout.p_n(i), length: first + i });
        let mut pairs: Vec<Pair> = normal.collect();
        let rough = (0..contacts).filter(|&i| data.layout.has_friction(i)).count();
        let mut next = first + contacts;
        let mut place = |i: usize| {
            data.layout.has_friction(i).then(|| {
                let pair = Pair { force: next, length: next + rough };
                next += 1;
                pair
            })
        };
        let friction: Vec<Option<Pair>> = (0..contacts).map(&mut place).collect();
        pairs.extend(friction.iter().flatten());
        ConeSystem {
            natural: NaturalRows::new(conventions, &data.scaling),
            matrix,
            row_scale: vec![[1.0; 2]; contacts],
            pairs,
            friction,
            data,
        }
    }

    /// Returns the values of node `i` at `z` and its pair `(s, λ)`, if it has friction.
    fn node(&self, i: usize, z: &[f64]) -> Option<(Node, Pair)> {
        let pair = self.friction[i]?;
        let (mu, s, lambda) = (self.data.mu[i], z[pair.force], z[pair.length]);
        let radius = mu * z[self.data.layout.p_n(i)];
        let e = self.data.friction(i, z).map(|p| p / radius);
        Some((Node { mu, e, s, lambda, stiffness: lambda / radius }, pair))
    }

    /// Returns the entries of `b` at the `p_T` of node `i`, or 0 where it has none.
    fn tangential(&self, i: usize, b: &[f64]) -> [f64; 2] {
        self.data.friction(i, b)
    }
}

impl InteriorPoint for ConeSystem {
    fn unknowns(&self) -> usize {
        self.data.layout.unknowns() + 2 * self.pairs.len() - self.data.layout.contacts()
    }

    fn forces(&self) -> &Layout {
        &self.data.layout
    }

    fn scaling(&self) -> &Scaling {
        &self.data.scaling
    }

    fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    fn distance(&self, i: usize, z: &[f64]) -> f64 {
        self.data.gap[i] - self.data.w_n(i, z)
    }

    fn begin(&mut self, increment: &Increment<'_>, z: &[f64]) {
        self.data.begin(increment, z);
    }

    fn residual(&self, z: &[f64], h: &mut [f64]) -> Result<(), LinearError> {
        let (data, matrix) = (&self.data, self.matrix.matrix());
        let n = matrix.order();
        // The equilibrium rows of the matrix are constant: K u + C_nᵀ p_n + C_tᵀ p_t + C_oᵀ p_o - f.
        matrix.mul(&z[..n], &mut h[..n])?;
        h.iter_mut().zip(&data.force).for_each(|(row, force)| *row -= force);
        for i in 0..data.layout.contacts() {
            h[data.layout.p_n(i)] = z[self.pairs[i].length] - self.distance(i, z);
            let Some((node, pair)) = self.node(i, z) else { continue };
            let slip = data.slip(i, data.tangential(i, z));
            for ((k, slip), e) in data.layout.tangential(i).into_iter().zip(slip).zip(node.e) {
                if let Some(k) = k {
                    h[k] = 2.0 * node.lambda * e - slip;
                }
            }
            h[pair.force] = node.s - node.mu * z[data.layout.p_n(i)] * (1.0 - dot(node.e, node.e));
        }
        for pair in &self.pairs {
            h[pair.length] = z[pair.force] * z[pair.length];
        }
        Ok(())
    }

    fn theta(&self, z: &[f64], h: &[f64]) -> f64 {
        let equilibrium = half_square(&h[..self.data.layout.displacements()]);
        self.natural.theta(&self.data, equilibrium, z, z, 0.0)
    }

    /// Writes the reduced rows. With the right-hand sides `b_v` (gap row), `b_w` (slip rows), `b_s` (cone row),
    /// `b_pv` and `b_sλ` (products), the rows of `v_n` and `s` give `dv_n = b_v - dw_n` and
    /// `ds = b_s + μ (1 + e²) dp_n - 2 e·dp_T`. In the products, and with `dλ` in the slip rows times `s`, they leave
    ///
    /// - `v_n dp_n - p_n dw_n = b_pv - p_n b_v`
    /// - `-s dw_T + (2 λ s / ρ) (dp_T - μ e dp_n) + 4 λ e (e·dp_T) - 2 λ μ (1 + e²) e dp_n
    ///   = s b_w - 2 e (b_sλ - λ b_s)`
    ///
    /// Only `p_T` and `λ s` are divided by a quantity that goes to zero, `ρ`, and they go to zero with it.
    fn linearize(&mut self, z: &[f64]) {
        for i in 0..self.data.layout.contacts() {
            let (p_n, v_n) = (z[self.data.layout.p_n(i)], z[self.pairs[i].length]);
            let normal = p_n.max(v_n);
            self.matrix.set_normal(i, -p_n / normal, v_n / normal);
            self.row_scale[i][0] = normal;
            let Some((node, _)) = self.node(i, z) else { continue };
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
                self.matrix.set_tangential(i, d, &row);
            }
            self.row_scale[i][1] = scale;
        }
    }

    fn matrix(&self) -> &SystemMatrix {
        self.matrix.matrix()
    }

    fn reduce(&self, z: &[f64], b: &[f64], rhs: &mut [f64]) {
        let layout = &self.data.layout;
        rhs[..layout.displacements()].copy_from_slice(&b[..layout.displacements()]);
        for i in 0..layout.contacts() {
            let [normal, tangential] = self.row_scale[i];
            let (p_n, v_n) = (layout.p_n(i), self.pairs[i].length);
            rhs[p_n] = (b[v_n] - z[p_n] * b[p_n]) / normal;
            let Some((node, pair)) = self.node(i, z) else { continue };
            let multiplier = b[pair.length] - node.lambda * b[pair.force];
            for (k, e) in layout.tangential(i).into_iter().zip(node.e) {
                if let Some(k) = k {
                    rhs[k] = (node.s * b[k] - 2.0 * e * multiplier) / tangential;
                }
            }
        }
    }

    /// Recovers the other unknowns. The small member of a normal pair gets its change from the product row, divided
    /// by the large member: as a difference of large numbers it would lose most of its digits.
    fn recover(&self, z: &[f64], b: &[f64], dz: &mut [f64]) {
        for i in 0..self.data.layout.contacts() {
            let (p_n, v_n) = (self.data.layout.p_n(i), self.pairs[i].length);
            dz[v_n] =
                if z[p_n] > z[v_n] { (b[v_n] - z[v_n] * dz[p_n]) / z[p_n] } else { b[p_n] - self.data.w_n(i, dz) };
            let Some((node, pair)) = self.node(i, z) else { continue };
            let along = dot(node.e, self.tangential(i, dz));
            dz[pair.force] = b[pair.force] + node.mu * node.widening() * dz[p_n] - 2.0 * along;
            dz[pair.length] = (b[pair.length] - node.lambda * dz[pair.force]) / node.s;
        }
    }

    fn unconstrained_mode(&self) -> Option<Vec<f64>> {
        self.data.unconstrained_mode()
    }

    /// Uses the same values for all nodes, without friction: the last solution's forces affect the scale only. A
    /// start too far inside costs an iteration or two; one too near the border is a bad start.
    fn move_inside(&self, z: &mut [f64], force: f64, length: f64) {
        let layout = &self.data.layout;
        let last = (0..layout.contacts()).map(|i| z[layout.p_n(i)]).fold(0.0, f64::max);
        let share = (last / force).max(1.0);
        let (force, length) = (share * force, share * length);
        for i in 0..layout.contacts() {
            (z[layout.p_n(i)], z[self.pairs[i].length]) = (force, length);
            layout.tangential(i).into_iter().flatten().for_each(|k| z[k] = 0.0);
            if let Some(pair) = self.friction[i] {
                let (mu, slip) = (self.data.mu[i], self.data.slip_beyond_reach(i, z, length));
                // With |p_T| = e ρ along the slip and e / (1 - e²) = far, both equations of friction hold, and the
                // product of the pair equals that without slip.
                let far = 0.5 * mu * size(slip) / length;
                let inside = 2.0 / (1.0 + 1.0_f64.hypot(2.0 * far));
                for (k, n) in layout.tangential(i).into_iter().zip(direction(slip)) {
                    if let Some(k) = k {
                        z[k] = inside * far * mu * force * n;
                    }
                }
                (z[pair.force], z[pair.length]) = (mu * force * inside, length / mu / inside);
            }
        }
    }

    /// The slip rows are not linear on the faces of the cone, since friction turns.
    fn face_ahead(&self, _before: &[f64], _z: &[f64]) -> Option<Face> {
        None
    }
}
