//! The B-differentiable formulation: `H_N` (19) and its linearisation (21) on `z = (u, p_t, p_o, p_n)`.
//!
//! # The change of a solution with the data of the increments, by the last linearisation
//!
//! While no contact node changes its case, the equations of an increment are affine (if slip turns, to first order)
//! and have the matrix of the last linearisation: one substitution leads from a solution to the next.

mod free;

use crate::algebra::linear::{Computed, SystemMatrix};
use crate::algebra::null_space::NEGLIGIBLE;
use crate::solver::laws::coulomb::{
    DirectionalDerivative, NormalCase, TangentialCase, direction, length, normal_case, normal_case_ahead,
    tangential_case, tangential_case_ahead,
};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

use super::mixed::{MixedMatrix, TangentialRow};
use super::natural::{NaturalRows, Pressure, half_square};
use super::scaled::ScaledData;
use super::{Assembled, FormulationScaling, Layout};
use crate::algebra::sparse::DoubleDouble;
use crate::base::units::Scaling;
use crate::solver::problem::{ContactProblem, Increment, strained};

/// `H_N` of a problem, in the units of its scaling, with its Jacobian on one fixed pattern.
pub struct Bdiff {
    data: ScaledData,
    rows: NaturalRows,
    matrix: MixedMatrix,
    cases: Vec<Option<Case>>,
}

/// The normal case of a contact node, and its tangential case if it has a tangential unknown.
type Case = (NormalCase, Option<TangentialCase>);

impl Bdiff {
    /// Sets up `H_N` of `problem`.
    pub fn new(problem: &ContactProblem, scaling: Scaling, conventions: &FormulationScaling) -> Self {
        Self::on(Assembled::new(problem, scaling), conventions)
    }

    /// Creates `H_N` on an assembled problem.
    pub fn on(assembled: Assembled, conventions: &FormulationScaling) -> Self {
        let Assembled { data, matrix } = assembled;
        let cases = vec![None; data.layout.contacts()];
        Bdiff { rows: NaturalRows::new(conventions, &data.scaling), matrix, cases, data }
    }

    /// Returns the assembled problem for another formulation.
    pub fn assembled(&self) -> Assembled {
        let mut matrix = self.matrix.clone();
        matrix.release();
        Assembled { data: self.data.clone(), matrix }
    }

    /// Returns the layout of `z`.
    pub fn layout(&self) -> &Layout {
        &self.data.layout
    }

    /// Returns the units of `z`.
    pub fn scaling(&self) -> &Scaling {
        &self.data.scaling
    }

    /// Returns `r` of the normal row of node `i`, scaled.
    pub fn r_n(&self, i: usize) -> f64 {
        self.rows.r_n[i]
    }

    /// Returns the cases of node `i` at `z`.
    fn case(&self, i: usize, z: &[f64]) -> Case {
        let (data, r_n, r_t) = (&self.data, self.rows.r_n[i], self.rows.r_t[i]);
        let (p_n, w_n) = (z[data.layout.p_n(i)], data.w_n(i, z));
        let tangential = data.layout.has_friction(i).then(|| {
            let (p, slip) = (data.friction(i, z), data.slip(i, data.tangential(i, z)));
            let pressure = self.rows.pressure(i, p_n, w_n - data.gap[i]);
            self.of_tangents(i, tangential_case(p, pressure, slip, data.mu[i], r_t))
        });
        (normal_case(p_n, w_n, data.gap[i], r_n), tangential)
    }

    /// Returns the cases of node `i` at `z + t dz`, `t → 0+`.
    fn case_ahead(&self, i: usize, z: &[f64], dz: &[f64]) -> Case {
        let (data, r_n, r_t) = (&self.data, self.rows.r_n[i], self.rows.r_t[i]);
        let n = data.layout.p_n(i);
        let trial =
            DirectionalDerivative::new(z[n], r_n * (data.w_n(i, z) - data.gap[i]), dz[n] + r_n * data.w_n(i, dz));
        let tangential = data.layout.has_friction(i).then(|| {
            let pressure = match self.rows.kind {
                Pressure::Unknown => DirectionalDerivative::new(z[n], 0.0, dz[n]),
                Pressure::Trial => trial,
            };
            let (p, dp, dw) = (data.friction(i, z), data.friction(i, dz), data.tangential(i, dz));
            let slip = data.slip(i, data.tangential(i, z));
            let q = [0, 1].map(|d| DirectionalDerivative::new(p[d], r_t * slip[d], dp[d] + r_t * dw[d]));
            self.of_tangents(i, tangential_case_ahead(pressure, q, data.mu[i]))
        });
        (normal_case_ahead(trial), tangential)
    }

    /// Restricts a tangential case to the tangents of node `i`.
    fn of_tangents(&self, i: usize, case: TangentialCase) -> TangentialCase {
        if self.layout().slides_in_a_plane(i) { case } else { case.straight() }
    }

    /// Computes the contact rows of (19). The low-order part `z_lo` of `z` is used because a small gap and the
    /// direction of a small slip may be lost in the rounding of `z`.
    fn contact_rows(&self, z: &[f64], z_lo: Option<&[f64]>, h: &mut [f64]) {
        let Bdiff { data, rows, .. } = self;
        for i in 0..data.layout.contacts() {
            let n = data.layout.p_n(i);
            let approach = match z_lo {
                None => data.w_n(i, z) - data.gap[i],
                Some(z_lo) => data.approach_dd(i, z, z_lo),
            };
            h[n] = rows.normal(i, z[n], approach);
            if data.layout.has_friction(i) {
                let pressure = rows.pressure(i, z[n], approach);
                let slip = match z_lo {
                    None => data.slip(i, data.tangential(i, z)),
                    Some(z_lo) => data.slip_dd(i, z, z_lo),
                };
                let tangential = rows.tangential(data, i, data.friction(i, z), pressure, slip);
                data.layout.set_tangential(i, tangential, h);
            }
        }
    }

    /// Linearises for given cases of (21), one for each contact node, instead of the cases at a `z`. The tangential
    /// case applies only if there is a tangential unknown.
    pub fn set_cases(&mut self, cases: impl IntoIterator<Item = (NormalCase, TangentialCase)>) {
        self.matrix.release();
        for (i, (normal, tangential)) in (0..self.layout().contacts()).zip(cases) {
            self.write_rows(i, (normal, self.layout().has_friction(i).then_some(tangential)));
        }
    }

    /// Writes the rows of node `i` for its cases in (21). Returns `true` if they changed.
    fn write_rows(&mut self, i: usize, (normal, tangential): Case) -> bool {
        let keeps_case = self.cases[i].is_some_and(|(last_normal, last)| {
            let like = match (&last, &tangential) {
                (Some(last), Some(tangential)) => tangential.is_like(last),
                _ => last == tangential,
            };
            last_normal == normal && like
        });
        if keeps_case {
            return false;
        }
        self.cases[i] = Some((normal, tangential));
        let (r_n, r_t) = (self.rows.r_n[i], self.rows.r_t[i]);
        match normal {
            NormalCase::Open => self.matrix.set_normal(i, 0.0, -1.0),
            NormalCase::Closed => self.matrix.set_normal(i, r_n, 0.0),
        }
        for (d, unit) in [[1.0, 0.0], [0.0, 1.0_f64]].into_iter().enumerate() {
            let row = match tangential {
                None => continue,
                Some(TangentialCase::NoPressure) => TangentialRow { w: [0.0; 2], p: unit.map(|x| -x), p_n: 0.0 },
                Some(TangentialCase::Stick) => TangentialRow { w: unit.map(|x| r_t * x), p: [0.0; 2], p_n: 0.0 },
                Some(TangentialCase::Slip { direction, turning }) => TangentialRow {
                    w: turning[d].map(|x| r_t * x),
                    p: [0, 1].map(|e| turning[d][e] - unit[e]),
                    p_n: self.data.mu[i] * direction[d],
                },
            };
            self.matrix.set_tangential(i, d, &row);
        }
        true
    }

    /// Returns `true` if contact rows depend on each other.
    pub fn has_dependent_nodes(&self) -> bool {
        self.data.has_dependent_nodes()
    }

    /// Returns `true` if the forces of dependent nodes have been referred to a solution, or there are none.
    pub fn is_referred(&self) -> bool {
        self.data.is_referred()
    }

    /// Refers the forces of dependent nodes to those in `z`. Returns `true` if there are such nodes, so that the
    /// residual changes.
    pub fn refer_to(&mut self, z: &[f64]) -> bool {
        self.data.refer_to(z);
        self.data.has_dependent_nodes()
    }

    /// Returns the length of `z`.
    pub fn unknowns(&self) -> usize {
        self.layout().unknowns()
    }

    /// Sets the data of a new increment after the solution `z`.
    pub fn begin(&mut self, increment: &Increment<'_>, z: &[f64]) {
        if *self.data.mu != *increment.mu {
            // The rows of slipping nodes contain the old coefficient.
            self.cases.fill(None);
        }
        self.data.begin(increment, z);
    }

    /// Computes `h = H_N(z)` (19).
    ///
    /// # Errors
    /// If a rank that shares the stiffness has failed.
    pub fn residual(&self, z: &[f64], h: &mut [f64]) -> Computed<()> {
        let data = &self.data;
        // The equilibrium rows of the Jacobian are constant: K u + C_nᵀ p_n + C_tᵀ p_t + C_oᵀ p_o - f.
        self.matrix.matrix().mul(z, h)?;
        for (row, force) in h.iter_mut().zip(&data.force) {
            *row -= force;
        }
        for spring in self.matrix.springs() {
            h[spring.dof] -= spring.stiffness * z[spring.dof];
        }
        self.contact_rows(z, None, h);
        Ok(())
    }

    /// Computes `h = H_N(z + z_lo)`, the linear rows in twice the working precision. `z_lo` is below the rounding of
    /// `z`.
    ///
    /// # Errors
    /// As [`Bdiff::residual`].
    pub fn residual_dd(&self, z: &[f64], z_lo: &[f64], h: &mut [f64]) -> Computed<()> {
        let mut sums = vec![DoubleDouble::default(); h.len()];
        let n = self.layout().displacements();
        let (mut strained, mut strained_lo) = strained(&self.data.rigid_modes, &z[..n], &z_lo[..n]);
        strained.extend(&z[n..]);
        strained_lo.extend(&z_lo[n..]);
        self.matrix.matrix().add_beyond(&strained, &strained_lo, &mut sums)?;
        for spring in self.matrix.springs() {
            sums[spring.dof].add_product(-spring.stiffness, strained[spring.dof]);
            sums[spring.dof].add(-spring.stiffness * strained_lo[spring.dof]);
        }
        sums.iter_mut().zip(&self.data.force).for_each(|(sum, force)| sum.add(-force));
        h.iter_mut().zip(sums).for_each(|(row, sum)| *row = sum.value());
        self.contact_rows(z, Some(z_lo), h);
        Ok(())
    }

    /// Returns `Theta` (10) of a residual, `½ Hᵀ H` with every row in its unit of [`FormulationScaling`], SI.
    pub fn merit(&self, h: &[f64]) -> f64 {
        self.rows.theta_of(&self.data, h)
    }

    /// Returns `t ↦ Theta(z + t dz)` along a Newton direction `dz` from `z` with `h = H(z)`. The equilibrium rows are
    /// linear and `dz` solves them, so they shrink by `1 - t`: a trial step costs O(n_c). Forces in pinning springs
    /// count as balanced.
    pub fn merit_along<'a>(&'a self, z: &'a [f64], dz: &'a [f64], h: &[f64]) -> impl Fn(f64) -> f64 + 'a {
        let equilibrium = half_square(&h[..self.layout().displacements()]);
        move |t| self.rows.theta(&self.data, (1.0 - t).powi(2) * equilibrium, z, dz, t)
    }

    /// Linearises at `z` (21) and pins unconstrained rigid modes. Rewrites the values of [`Bdiff::jacobian`] that
    /// depend on `z`, and returns `true` if any of them changed. Where slip can turn, coefficients that agree to
    /// eight digits are kept.
    pub fn linearize(&mut self, z: &[f64]) -> bool {
        self.write_cases(|this, i| this.case(i, z))
    }

    /// Linearises at `z` as seen from `z + t dz`, `t → 0+`: if several cases meet in `z`, each node takes the case
    /// that `dz` leads into. If solving with this matrix gives the same `dz` again, `dz` is the direction of the
    /// B-derivative (20). Returns `true` if any case changed.
    pub fn linearize_towards(&mut self, z: &[f64], dz: &[f64]) -> bool {
        self.write_cases(|this, i| this.case_ahead(i, z, dz))
    }

    /// Writes the rows of every node for its case and pins unconstrained rigid modes. Returns `true` if any row
    /// changed.
    fn write_cases(&mut self, case: impl Fn(&Self, usize) -> Case) -> bool {
        let mut changed = false;
        for i in 0..self.layout().contacts() {
            changed |= self.write_rows(i, case(self, i));
        }
        if changed {
            self.pin_unconstrained_modes();
        }
        changed
    }

    /// Converts a residual into the right-hand side for [`Bdiff::jacobian`], whose rows are those of the derivative
    /// up to row operations. The slip rows of (21) have no `C_n du`. The derivative with the trial pressure has the
    /// term `μ n r C_n du`, and subtracting `μ n` times the normal row of the closed node removes it.
    pub fn right_hand_side(&self, h: &mut [f64]) {
        if self.rows.kind == Pressure::Unknown {
            return;
        }
        for i in 0..self.layout().contacts() {
            let Some((_, Some(TangentialCase::Slip { direction, .. }))) = self.cases[i] else { continue };
            let (h_n, h_t) = (h[self.layout().p_n(i)], self.data.friction(i, h));
            self.layout().set_tangential(i, [0, 1].map(|d| h_t[d] - self.data.mu[i] * direction[d] * h_n), h);
        }
    }

    /// Returns a code for the case of every contact node in the last linearisation, for comparisons.
    pub fn cases(&self) -> Vec<u8> {
        let tangential = |case: &Option<TangentialCase>| match case {
            None => 0,
            Some(TangentialCase::NoPressure) => 1,
            Some(TangentialCase::Stick) => 2,
            // The quadrant, if slip is in a plane.
            Some(TangentialCase::Slip { direction: [t, o], .. }) => 3 + u8::from(*t > 0.0) + 2 * u8::from(*o > 0.0),
        };
        let cases = self.cases.iter().flatten();
        cases.flat_map(|(normal, case)| [u8::from(*normal == NormalCase::Closed), tangential(case)]).collect()
    }

    /// Linearises with every contact node clamped: closed, and sticking if there is friction. With this matrix the
    /// other displacements follow a change of the load.
    pub fn clamp_contacts(&mut self) {
        self.set_cases(vec![(NormalCase::Closed, TangentialCase::Stick); self.layout().contacts()]);
    }

    /// Returns the matrix of the last linearisation, including pinning springs. Its pattern never changes.
    pub fn jacobian(&self) -> &SystemMatrix {
        self.matrix.matrix()
    }

    /// Returns `true` if `H` is affine, so that a single step solves it.
    pub fn is_affine(&self) -> bool {
        self.layout().contacts() == 0
    }
}

/// The length of a motion, relative to the displacements and to the motion of obstacles, that decides the case of every node.
const FAR: f64 = 1e3;

impl Bdiff {
    /// Returns `true` if all nodes of the parts that the rigid `motion` moves keep their cases of the last linearisation at `z`
    /// and however far they move on along it; `part` are the parts of the nodes. Other parts know nothing of it.
    pub fn keeps_cases_along(&self, z: &[f64], mut motion: Vec<f64>, part: &[usize]) -> bool {
        let largest = |x: &[f64]| x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        motion.resize(z.len(), 0.0);
        let data = &self.data;
        let lengths = [&z[..self.layout().displacements()], &data.w_t_last, &data.w_o_last].map(largest);
        let size = FAR * lengths.into_iter().fold(0.0, f64::max) / largest(&motion);
        let ahead: Vec<f64> = z.iter().zip(&motion).map(|(z, u)| z + size * u).collect();
        let farthest = NEGLIGIBLE * largest(&motion);
        let moves = |i: usize| data.w_n(i, &motion).abs().max(length(data.tangential(i, &motion))) > farthest;
        let moved: BTreeSet<usize> = (0..part.len()).filter(|&i| moves(i)).map(|i| part[i]).collect();
        (0..part.len()).filter(|i| moved.contains(&part[*i])).all(|i| self.keeps_case(i, &ahead))
    }
}

impl Bdiff {
    /// Returns `true` if there is a linearisation without pinned modes.
    pub fn has_tangent(&self) -> bool {
        !self.is_pinned() && self.cases.iter().all(Option::is_some)
    }

    /// Returns the residual at `z`, with the data of the present increment, of the equations with the matrix of the
    /// last linearisation: `w_n = g` if a node is closed, `p_n = 0` if it is open, `Δw_T = 0` if it sticks, `p_T = 0`
    /// without pressure, and `p_T = μ p_n n + R r Δw_T` if it slips.
    ///
    /// # Errors
    /// As [`Bdiff::residual`].
    pub fn residual_of_cases(&self, z: &[f64]) -> Computed<Vec<f64>> {
        let Bdiff { data, rows, .. } = self;
        let mut h = vec![0.0; z.len()];
        self.residual(z, &mut h)?;
        for (i, case) in self.cases.iter().enumerate() {
            let Some((normal, tangential)) = *case else { continue };
            let p_n = data.layout.p_n(i);
            h[p_n] = match normal {
                NormalCase::Open => -z[p_n],
                NormalCase::Closed => rows.r_n[i] * (data.w_n(i, z) - data.gap[i]),
            };
            let Some(tangential) = tangential else { continue };
            let (p, slip) = (data.friction(i, z), data.slip(i, data.tangential(i, z)));
            let moved = slip.map(|w| rows.r_t[i] * w);
            let row = match tangential {
                TangentialCase::NoPressure => p.map(|p| -p),
                TangentialCase::Stick => moved,
                TangentialCase::Slip { direction, turning } => [0, 1].map(|d| {
                    let turned = turning[d][0] * moved[0] + turning[d][1] * moved[1];
                    data.mu[i] * direction[d] * z[p_n] - p[d] + turned
                }),
            };
            data.layout.set_tangential(i, row, &mut h);
        }
        Ok(h)
    }

    /// Makes nodes slip that were open in the last linearisation and are closed at `z`: puts their `p_T` on the cone,
    /// along their slip. A closing node has moved tangentially, and immediate sticking would hold it without a
    /// reason.
    pub fn slip_where_closing(&self, z: &mut [f64]) {
        let data = &self.data;
        for (i, case) in self.cases.iter().enumerate() {
            let trial = z[data.layout.p_n(i)] + self.rows.r_n[i] * (data.w_n(i, z) - data.gap[i]);
            if !matches!(case, Some((NormalCase::Open, _))) || trial <= 0.0 {
                continue;
            }
            let along = direction(data.slip(i, data.tangential(i, z)));
            data.layout.set_tangential(i, along.map(|n| data.mu[i] * trial * n), z);
        }
    }
}

/// Slip directions count as different if the cosine between them is smaller.
const ALIKE: f64 = 0.99;

impl Bdiff {
    /// Returns the tangential case of node `i` at `z`: [`TangentialCase::NoPressure`] if the node is open or has no
    /// friction.
    pub fn friction_case(&self, i: usize, z: &[f64]) -> TangentialCase {
        match self.case(i, z) {
            (NormalCase::Closed, Some(case)) => case,
            _ => TangentialCase::NoPressure,
        }
    }

    /// Returns `true` if node `i` is closed at `z`.
    pub fn is_closed(&self, i: usize, z: &[f64]) -> bool {
        self.case(i, z).0 == NormalCase::Closed
    }

    /// Returns `true` if the last linearisation has these cases (closed or not, tangential case), ignoring small
    /// changes of slip direction.
    pub fn is_linearized_for(&self, cases: &[(bool, TangentialCase)]) -> bool {
        let alike = |last: &TangentialCase, case: &TangentialCase| match (last, case) {
            (TangentialCase::Slip { direction: n, .. }, TangentialCase::Slip { direction: m, .. }) => {
                n[0] * m[0] + n[1] * m[1] > ALIKE
            }
            (last, case) => last == case,
        };
        self.cases.iter().zip(cases).all(|(last, &(closed, case))| match last {
            None => false,
            Some((normal, last)) => {
                closed == (*normal == NormalCase::Closed)
                    && last.as_ref().is_none_or(|last| !closed || alike(last, &case))
            }
        })
    }

    /// Linearises for these cases, as [`Bdiff::linearize`] does for those of a `z`.
    pub fn linearize_for(&mut self, cases: &[(bool, TangentialCase)]) {
        self.write_cases(|this, i| {
            let (closed, case) = cases[i];
            (closed.into(), this.layout().has_friction(i).then_some(case))
        });
    }

    /// Returns the right-hand side of [`Bdiff::jacobian`] for the change of a solution when the forces change by
    /// `force`, the gaps by `gap`, and the origins of slip by `origin`, with the cases of the last linearisation.
    pub fn change(&self, force: impl IntoIterator<Item = f64>, gap: &[f64], origin: &[[f64; 2]]) -> Vec<f64> {
        let mut b = vec![0.0; self.unknowns()];
        b.iter_mut().zip(force).for_each(|(b, force)| *b = force);
        for (i, (gap, origin)) in gap.iter().zip(origin).enumerate() {
            let Some((normal, tangential)) = self.cases[i] else { continue };
            if normal == NormalCase::Closed {
                b[self.layout().p_n(i)] = self.rows.r_n[i] * gap;
            }
            let moved = match tangential {
                Some(TangentialCase::Stick) => *origin,
                Some(TangentialCase::Slip { turning, .. }) => {
                    turning.map(|row| row[0] * origin[0] + row[1] * origin[1])
                }
                Some(TangentialCase::NoPressure) | None => continue,
            };
            self.layout().set_tangential(i, moved.map(|moved| self.rows.r_t[i] * moved), &mut b);
        }
        b
    }

    /// Returns `w_n` of node `i` in a `z`, or in a change of one.
    pub fn w_n(&self, i: usize, z: &[f64]) -> f64 {
        self.data.w_n(i, z)
    }

    /// Returns `w_T` of node `i`.
    pub fn w_t(&self, i: usize, z: &[f64]) -> [f64; 2] {
        self.data.tangential(i, z)
    }

    /// Returns `p_T` of node `i`.
    pub fn p_t(&self, i: usize, z: &[f64]) -> [f64; 2] {
        self.data.friction(i, z)
    }

    /// Returns the slip increment of node `i` at `z`.
    pub fn slip(&self, i: usize, z: &[f64]) -> [f64; 2] {
        self.data.slip(i, self.data.tangential(i, z))
    }

    /// Returns the gap, the coefficient of friction and the origins of slip of node `i` in this increment.
    pub fn at_node(&self, i: usize) -> (f64, f64, [f64; 2]) {
        (self.data.gap[i], self.data.mu[i], [self.data.w_t_last[i], self.data.w_o_last[i]])
    }

    /// Returns the forces of this increment.
    pub fn force(&self) -> &[f64] {
        &self.data.force
    }
}

/// The cases of the last linearisation and the friction coefficients of its slip rows. Slip coefficients are reused
/// while the slip direction changes little, so they cannot be reconstructed from `z`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Linearization {
    cases: Vec<Option<Case>>,
    mu: Vec<f64>,
}

impl Bdiff {
    /// Returns a snapshot of the last linearisation.
    pub fn linearization(&self) -> Linearization {
        Linearization { cases: self.cases.clone(), mu: self.data.mu.to_vec() }
    }

    /// Restores a linearisation from a snapshot. Returns `false` if the snapshot belongs to another problem.
    pub fn linearize_as(&mut self, saved: &Linearization) -> bool {
        let contacts = self.layout().contacts();
        let has_friction = |i: usize| self.layout().has_friction(i);
        let fits = |(i, case): (usize, &Option<Case>)| case.is_none_or(|(_, case)| case.is_some() == has_friction(i));
        if [saved.cases.len(), saved.mu.len()] != [contacts; 2] || !saved.cases.iter().enumerate().all(fits) {
            return false;
        }
        self.data.mu = saved.mu.clone().into();
        self.cases.fill(None);
        self.matrix.release();
        for (i, case) in saved.cases.iter().enumerate() {
            if let Some(case) = case {
                self.write_rows(i, *case);
            }
        }
        if saved.cases.iter().any(Option::is_some) {
            self.pin_unconstrained_modes();
        }
        true
    }
}
