//! The constrained equation formulation: `H_I` (25) on `z = (u, p_t, p_n, v_n, s, λ)`, whose last four blocks stay
//! positive, and its Newton system, in which `v_n`, `s` and `λ` are eliminated.
//!
//! Each row is at the place of an unknown: equilibrium at `u`, the slip row at `p_t`, the gap row at `p_n`, the cone
//! rows at `s`, and the products at `v_n` and `λ`. Here `L_n = [I; I]` and `L_t = [I; -I]`:
//!
//! | place | row |
//! | --- | --- |
//! | `u` | `K u + C_tᵀ p_t + C_nᵀ p_n - f` |
//! | `p_n` | `v_n + C_n u - g` |
//! | `p_t` | `-C_t u + L_tᵀ λ + w̄_t` |
//! | `s` | `s - μ L_n p_n + L_t p_t` |
//! | `v_n` | `p_n ∘ v_n` |
//! | `λ` | `λ ∘ s` |
//!
//! A node without friction or without tangential freedom has no `p_t`, `s` and `λ`.

mod face;
mod layout;
mod reduced;

pub use layout::SlackLayout;

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::interior::InteriorPoint;
use super::natural::{NaturalRows, half_square};
use super::pairs::{Face, Pair, largest_step, least, reach};
use super::scaled::ScaledData;
use super::{Assembled, FormulationScaling, Layout};
use crate::algebra::linear::{LinearError, SystemMatrix};
use crate::base::units::Scaling;
use crate::solver::problem::{ContactProblem, Increment};
use reduced::Reduced;

/// The equations that stay positive, besides the unknowns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Partition {
    /// The products, `(F̃, G̃)` (29)–(31).
    #[default]
    Products,
    /// The products and the friction cone, `(F, G)` (26)–(28).
    Cone,
}

/// `H_I` of a problem, in the units of its scaling.
pub struct Constrained {
    data: ScaledData,
    natural: NaturalRows,
    layout: SlackLayout,
    /// The complementary pairs of unknowns, with the place of their product.
    pairs: Vec<Pair>,
    partition: Partition,
    system: Reduced,
}

impl Constrained {
    /// Sets up `H_I` of `problem`. The `conventions` affect [`Constrained::theta`] alone.
    pub fn new(
        problem: &ContactProblem,
        scaling: Scaling,
        conventions: &FormulationScaling,
        partition: Partition,
    ) -> Self {
        Self::on(Assembled::new(problem, scaling), conventions, partition)
    }

    /// Creates `H_I` on an assembled problem.
    pub fn on(assembled: Assembled, conventions: &FormulationScaling, partition: Partition) -> Self {
        let Assembled { data, matrix } = assembled;
        let system = Reduced::new(matrix, data.layout.contacts());
        let layout = SlackLayout::new(&data.layout);
        let pairs = layout.pairs().collect();
        Constrained { natural: NaturalRows::new(conventions, &data.scaling), data, layout, pairs, partition, system }
    }

    /// Returns the layout of `z`.
    pub fn layout(&self) -> &SlackLayout {
        &self.layout
    }

    /// Returns `μ` of every contact node.
    pub fn mu(&self) -> &[f64] {
        &self.data.mu
    }

    /// Returns n_2, the number of rows of `G`.
    pub fn n_2(&self) -> usize {
        self.pairs.len() + self.positive_cone_rows().len()
    }

    /// Returns the places of the rows of `G`.
    pub fn g_rows(&self) -> impl Iterator<Item = usize> + '_ {
        self.pairs.iter().map(|pair| pair.length).chain(self.positive_cone_rows())
    }

    /// Returns the places of the cone rows in `G`: all with (26)–(28), none with (29)–(31).
    fn positive_cone_rows(&self) -> Range<usize> {
        match self.partition {
            Partition::Products => 0..0,
            Partition::Cone => self.layout.cone_rows(),
        }
    }

    /// Returns `β = eᵀG / n_2` of a residual.
    pub fn beta(&self, h: &[f64]) -> f64 {
        self.g_rows().map(|k| h[k]).sum::<f64>() / self.n_2() as f64
    }

    /// Refers the forces of dependent nodes to those in `z`, so that their compliance is in the matrix alone.
    pub fn refer_to(&mut self, z: &[f64]) {
        self.data.refer_to(z);
    }

    /// Returns `t ↦ ψ(z + t dz)` (13), with `h = H_I(z)` and a direction `dz` that solves (14) with `centring = σ β`.
    /// The rows of `F` are linear and `dz` solves them, so they shrink by `1 - t`.
    pub fn potential_along<'a>(
        &'a self,
        zeta: f64,
        z: &'a [f64],
        dz: &'a [f64],
        h: &'a [f64],
        centring: f64,
    ) -> impl Fn(f64) -> f64 + 'a {
        let g_square: f64 = self.g_rows().map(|k| h[k] * h[k]).sum();
        let f_square = (2.0 * half_square(h) - g_square).max(0.0);
        move |t| {
            let at = |k: usize| z[k] + t * dz[k];
            let (mut sum, mut logarithms) = (0.0, 0.0);
            let mut add = |g: f64| {
                sum += g;
                logarithms += g.ln();
            };
            self.pairs.iter().for_each(|pair| add(at(pair.force) * at(pair.length)));
            self.positive_cone_rows().for_each(|k| add((1.0 - t) * h[k] + t * centring));
            zeta * ((1.0 - t).powi(2) * f_square + sum).ln() - logarithms
        }
    }

    /// Returns `δ`, the largest step for which `z + δ dz` is in the closure of `Ω₊₊`; infinite if there is no
    /// largest. `h` is the residual at `z`, and `centring` the target of the rows of `G`.
    pub fn largest_step(&self, z: &[f64], dz: &[f64], h: &[f64], centring: f64) -> f64 {
        let cone = self.positive_cone_rows().map(|k| reach(h[k], centring - h[k]));
        least(cone.chain([largest_step(&self.pairs, z, dz)]))
    }
}

impl InteriorPoint for Constrained {
    fn unknowns(&self) -> usize {
        self.layout.unknowns()
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
        let Constrained { data, layout, .. } = self;
        // The equilibrium rows of the matrix are constant: K u + C_nᵀ p_n + C_tᵀ p_t - f.
        let matrix = self.matrix();
        let n = matrix.order();
        matrix.mul(&z[..n], &mut h[..n])?;
        for (row, force) in h.iter_mut().zip(&data.force) {
            *row -= force;
        }
        for i in 0..data.layout.contacts() {
            let p_n = data.layout.p_n(i);
            h[p_n] = z[layout.v_n(i)] - self.distance(i, z);
            if let Some(p_t) = data.layout.p_t(i) {
                let ([s_plus, s_minus], [l_plus, l_minus]) = (layout.s(p_t), layout.lambda(p_t));
                h[p_t] = z[l_plus] - z[l_minus] - (data.w_t(i, z) - data.w_t_last[i]);
                h[s_plus] = z[s_plus] - data.mu[i] * z[p_n] + z[p_t];
                h[s_minus] = z[s_minus] - data.mu[i] * z[p_n] - z[p_t];
            }
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

    fn linearize(&mut self, z: &[f64]) {
        self.system.linearize(&self.data, &self.layout, z);
    }

    fn matrix(&self) -> &SystemMatrix {
        self.system.matrix()
    }

    fn reduce(&self, z: &[f64], b: &[f64], rhs: &mut [f64]) {
        self.system.reduce(&self.data, &self.layout, z, b, rhs);
    }

    fn recover(&self, z: &[f64], b: &[f64], dz: &mut [f64]) {
        reduced::recover(&self.data, &self.layout, z, b, dz);
    }

    fn unconstrained_mode(&self) -> Option<Vec<f64>> {
        self.data.unconstrained_mode()
    }

    /// Chooses the distance from the last solution by the scales.
    fn move_inside(&self, z: &mut [f64], force: f64, length: f64) {
        let layout = &self.layout;
        for i in 0..self.data.layout.contacts() {
            let (p_n, v_n) = (self.data.layout.p_n(i), layout.v_n(i));
            let pressure = z[p_n].max(0.0);
            if let Some(p_t) = self.data.layout.p_t(i) {
                let (mu, s, lambda) = (self.data.mu[i], layout.s(p_t), layout.lambda(p_t));
                let [slip, _] = self.data.slip_beyond_reach(i, z, length);
                for (sign, s, lambda) in [(1.0, s[0], lambda[0]), (-1.0, s[1], lambda[1])] {
                    let reserve = (mu * pressure - sign * z[p_t]).max(0.0);
                    (z[s], z[lambda]) = central_pair(reserve, mu * force, (sign * slip).max(0.0), length);
                }
            }
            let distance = self.distance(i, z).max(0.0);
            (z[p_n], z[v_n]) = central_pair(pressure, force, distance, length);
        }
    }

    fn face_ahead(&self, before: &[f64], z: &[f64]) -> Option<Face> {
        Some(self.face_between(before, z))
    }
}

/// Returns the pair with the product `force · length` nearest to a force `x` and a length `y` of which one is about
/// zero: the positive root of `a - 1/a = x/force - y/length`.
fn central_pair(x: f64, force: f64, y: f64, length: f64) -> (f64, f64) {
    let q = x / force - y / length;
    // The larger of a and 1/a, without cancellation.
    let larger = 0.5 * (q.abs() + q.hypot(2.0));
    let a = if q > 0.0 { larger } else { 1.0 / larger };
    (force * a, length / a)
}

#[cfg(test)]
mod tests {
    use super::central_pair;

    #[test]
    fn a_central_pair_keeps_what_is_large() {
        for (x, y) in [(0.0, 0.0), (5.0, 0.0), (0.0, 7.0), (1e12, 0.0), (0.0, 1e12)] {
            let (a, b) = central_pair(x, 2.0, y, 3.0);
            assert!((a * b / 6.0 - 1.0).abs() < 1e-12, "{a} {b}");
            assert!((a / 2.0 - b / 3.0 - (x / 2.0 - y / 3.0)).abs() <= 1e-12 * (a + b));
        }
    }
}
