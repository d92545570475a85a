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

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::interior::{Face, InteriorPoint, Pair, Paired, largest_step, least, max_step_of};
use super::mixed::TangentialRow;
use super::natural::half_square;
use super::{Assembled, FormulationScaling, Layout};
use crate::base::units::Scaling;
use crate::solver::problem::ContactProblem;

/// The equations that stay positive, besides the unknowns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, schemars::JsonSchema)]
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
    paired: Paired,
    layout: SlackLayout,
    partition: Partition,
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
        let layout = SlackLayout::new(assembled.layout());
        let paired = Paired::new(assembled, conventions, layout.pairs().collect());
        Constrained { paired, layout, partition }
    }

    /// Returns the layout of `z`.
    pub fn layout(&self) -> &SlackLayout {
        &self.layout
    }

    /// Returns `μ` of every contact node.
    pub fn mu(&self) -> &[f64] {
        &self.paired.data.mu
    }

    /// Returns n_2, the number of rows of `G`.
    pub fn n_2(&self) -> usize {
        self.paired.pairs.len() + self.positive_cone_rows().len()
    }

    /// Returns the places of the rows of `G`.
    pub fn g_rows(&self) -> impl Iterator<Item = usize> + '_ {
        self.paired.pairs.iter().map(|pair| pair.length).chain(self.positive_cone_rows())
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
        self.paired.data.refer_to(z);
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
            self.paired.pairs.iter().for_each(|pair| add(at(pair.force) * at(pair.length)));
            self.positive_cone_rows().for_each(|k| add((1.0 - t) * h[k] + t * centring));
            zeta * ((1.0 - t).powi(2) * f_square + sum).ln() - logarithms
        }
    }

    /// Returns `δ`, the largest step for which `z + δ dz` is in the closure of `Ω₊₊`; infinite if there is no
    /// largest. `h` is the residual at `z`, and `centring` the target of the rows of `G`.
    pub fn largest_step(&self, z: &[f64], dz: &[f64], h: &[f64], centring: f64) -> f64 {
        let cone = self.positive_cone_rows().map(|k| max_step_of(h[k], centring - h[k]));
        least(cone.chain([largest_step(&self.paired.pairs, z, dz)]))
    }
}

impl InteriorPoint for Constrained {
    fn paired(&self) -> &Paired {
        &self.paired
    }

    fn paired_mut(&mut self) -> &mut Paired {
        &mut self.paired
    }

    fn friction_rows(&self, i: usize, z: &[f64], h: &mut [f64]) {
        let (data, layout) = (&self.paired.data, &self.layout);
        let Some(p_t) = data.layout.p_t(i) else { return };
        let ([s_plus, s_minus], [l_plus, l_minus]) = (layout.s(p_t), layout.lambda(p_t));
        let p_n = data.layout.p_n(i);
        h[p_t] = z[l_plus] - z[l_minus] - (data.w_t(i, z) - data.w_t_last[i]);
        h[s_plus] = z[s_plus] - data.mu[i] * z[p_n] + z[p_t];
        h[s_minus] = z[s_minus] - data.mu[i] * z[p_n] - z[p_t];
    }

    /// Writes the slip row. With the right-hand sides `b_w` (slip row), `b_s` (cone rows) and `b_sλ` (products), the rows
    /// of `s` give `ds± = b_s± + μ dp_n ∓ dp_t`. In the products they leave
    ///
    /// `(λ⁺ s⁻ + λ⁻ s⁺) dp_t - μ (λ⁺ s⁻ - λ⁻ s⁺) dp_n - s⁺ s⁻ dw_t
    ///   = s⁺ s⁻ b_w + s⁻ (λ⁺ b_s⁺ - b_sλ⁺) - s⁺ (λ⁻ b_s⁻ - b_sλ⁻)`
    ///
    /// The row is multiplied by `s⁺ s⁻`, so that nothing is divided by a quantity that goes to zero. It is in the pattern
    /// of (21).
    fn linearize_friction(&mut self, i: usize, z: &[f64]) {
        let Some(p_t) = self.forces().p_t(i) else { return };
        let [s_plus, s_minus] = self.layout.s(p_t).map(|k| z[k]);
        let [l_plus, l_minus] = self.layout.lambda(p_t).map(|k| z[k]);
        let (by_plus, by_minus, by_w_t) = (l_plus * s_minus, l_minus * s_plus, s_plus * s_minus);
        let scale = (by_plus + by_minus).max(by_w_t);
        let by_p_n = -self.paired.data.mu[i] * (by_plus - by_minus);
        let row =
            TangentialRow { w: [-by_w_t / scale, 0.0], p: [(by_plus + by_minus) / scale, 0.0], p_n: by_p_n / scale };
        self.paired.matrix.set_tangential(i, 0, &row);
        self.paired.row_scale[i][1] = scale;
    }

    fn reduce_friction(&self, i: usize, z: &[f64], b: &[f64], rhs: &mut [f64]) {
        let Some(p_t) = self.forces().p_t(i) else { return };
        let ([s_plus, s_minus], [l_plus, l_minus]) = (self.layout.s(p_t), self.layout.lambda(p_t));
        let plus = z[s_minus] * (z[l_plus] * b[s_plus] - b[l_plus]);
        let minus = z[s_plus] * (z[l_minus] * b[s_minus] - b[l_minus]);
        rhs[p_t] = (z[s_plus] * z[s_minus] * b[p_t] + plus - minus) / self.paired.row_scale[i][1];
    }

    fn recover_friction(&self, i: usize, z: &[f64], b: &[f64], dz: &mut [f64]) {
        let data = &self.paired.data;
        let Some(p_t) = data.layout.p_t(i) else { return };
        let ([s_plus, s_minus], [l_plus, l_minus]) = (self.layout.s(p_t), self.layout.lambda(p_t));
        for (sign, s, lambda) in [(1.0, s_plus, l_plus), (-1.0, s_minus, l_minus)] {
            dz[s] = b[s] + data.mu[i] * dz[data.layout.p_n(i)] - sign * dz[p_t];
            dz[lambda] = (b[lambda] - z[lambda] * dz[s]) / z[s];
        }
        // If a node slips, λ follows from the slip row.
        let slip = b[p_t] + data.w_t(i, dz);
        let (slips_plus, slips_minus) = (z[s_plus] < z[l_plus], z[s_minus] < z[l_minus]);
        if slips_plus && !slips_minus {
            dz[l_plus] = dz[l_minus] + slip;
            dz[s_plus] = (b[l_plus] - z[s_plus] * dz[l_plus]) / z[l_plus];
        } else if slips_minus && !slips_plus {
            dz[l_minus] = dz[l_plus] - slip;
            dz[s_minus] = (b[l_minus] - z[s_minus] * dz[l_minus]) / z[l_minus];
        }
    }

    /// Chooses the distance from the last solution by the scales.
    fn move_inside(&self, z: &mut [f64], force: f64, length: f64) {
        let (data, layout) = (&self.paired.data, &self.layout);
        for i in 0..data.layout.contacts() {
            let (p_n, v_n) = self.paired.normal(i);
            let pressure = z[p_n].max(0.0);
            if let Some(p_t) = data.layout.p_t(i) {
                let (mu, s, lambda) = (data.mu[i], layout.s(p_t), layout.lambda(p_t));
                let [slip, _] = data.excess_slip(i, z, length);
                for (sign, s, lambda) in [(1.0, s[0], lambda[0]), (-1.0, s[1], lambda[1])] {
                    let reserve = (mu * pressure - sign * z[p_t]).max(0.0);
                    (z[s], z[lambda]) = central_pair(reserve, mu * force, (sign * slip).max(0.0), length);
                }
            }
            let distance = self.distance(i, z).max(0.0);
            (z[p_n], z[v_n]) = central_pair(pressure, force, distance, length);
        }
    }

    /// Returns the face that a step from `before` to `z` has approached: the member of each pair that has shrunk more
    /// vanishes (Tapia's indicator). It compares no force with a length, so it does not depend on units. `H_I` is linear
    /// on a face, so on the right face a single Newton step ends the iteration.
    fn face_ahead(&self, before: &[f64], z: &[f64]) -> Option<Face> {
        let force_shrinks_more =
            |pair: &Pair| z[pair.force] * before[pair.length] <= z[pair.length] * before[pair.force];
        let mut vanishes: Vec<bool> = self.pairs().iter().map(force_shrinks_more).collect();
        // Without pressure both s vanish, and with them p_t, so the row of the first s suffices. With pressure at
        // most one s vanishes.
        let (n_c, n_t) = (self.forces().contacts(), self.forces().tangentials());
        for i in 0..n_c {
            let Some(p_t) = self.forces().p_t(i) else { continue };
            let plus = n_c + p_t - self.forces().displacements();
            let minus = plus + n_t;
            if vanishes[i] || vanishes[plus] && vanishes[minus] {
                let [s_plus, s_minus] = self.layout.s(p_t);
                vanishes[plus] = vanishes[i] || z[s_plus] <= z[s_minus];
                vanishes[minus] = !vanishes[plus];
            }
        }
        Some(Face(vanishes))
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

/// The layout of `z = (u, p_t, p_n, v_n, s, λ)`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SlackLayout {
    forces: Layout,
}

impl SlackLayout {
    /// Creates the layout of the slacks and multipliers for the unknowns of `forces`.
    pub fn new(forces: &Layout) -> Self {
        SlackLayout { forces: forces.clone() }
    }

    /// Returns the layout of `(u, p_t, p_n)`, with which `z` begins.
    pub fn forces(&self) -> &Layout {
        &self.forces
    }

    /// Returns the length of `z`.
    pub fn unknowns(&self) -> usize {
        self.s_start() + 4 * self.forces.tangentials()
    }

    fn s_start(&self) -> usize {
        self.forces.unknowns() + self.forces.contacts()
    }

    /// Returns the place of `v_n` of contact node `i`.
    pub fn v_n(&self, i: usize) -> usize {
        self.forces.unknowns() + i
    }

    /// Returns the places of `s⁺` and `s⁻` of the node whose tangential force is at `p_t`.
    pub fn s(&self, p_t: usize) -> [usize; 2] {
        let k = self.s_start() + p_t - self.forces.displacements();
        [k, k + self.forces.tangentials()]
    }

    /// Returns the places of `λ⁺` and `λ⁻` of the node whose tangential force is at `p_t`.
    pub fn lambda(&self, p_t: usize) -> [usize; 2] {
        self.s(p_t).map(|k| k + 2 * self.forces.tangentials())
    }

    /// Returns the places of all `s`, which are also those of the cone rows.
    pub fn cone_rows(&self) -> Range<usize> {
        self.s_start()..self.s_start() + 2 * self.forces.tangentials()
    }

    /// Returns the complementary pairs `(p_n, v_n)`, then `(s, λ)`.
    pub fn pairs(&self) -> impl Iterator<Item = Pair> + '_ {
        let normal = (0..self.forces.contacts()).map(|i| Pair { force: self.forces.p_n(i), length: self.v_n(i) });
        let cone = self.cone_rows();
        normal.chain(cone.clone().map(move |k| Pair { force: k, length: k + cone.len() }))
    }
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
