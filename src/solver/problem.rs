//! The discrete frictional contact problem: algebra only, no mesh.

pub(crate) mod error;
mod natural;
mod own_basis;
mod strained;

use crate::algebra::linear::{Computed, LinearError, Stiffness, null_space_of};
use crate::algebra::sparse::{Csr, DoubleDouble};
use error::{expect_each, expect_finite, expect_length};
use std::collections::BTreeSet;
use std::sync::{Arc, OnceLock};

pub use error::ProblemError;
pub(crate) use natural::NaturalUnits;
pub(crate) use own_basis::OwnBasis;
use serde::{Deserialize, Serialize};
pub(crate) use strained::strained;

use crate::algebra::vector::median;
use crate::base::units::Scaling;

/// A body against rigid obstacles, in SI units. [`ContactProblem::new`] has checked its parts.
///
/// ```
/// use stickslip::solver::{ContactProblem, Parts, ProblemError};
/// use stickslip::algebra::{Csr, Symmetric};
///
/// // A node on two springs, above a floor that it meets along -y; friction 0.3.
/// let stiffness = Symmetric::from_triplets(2, &[(0, 0, 2e6), (1, 1, 2e6)])?;
/// let c_n = Csr::from_rows(2, [[(1, -1.0)]])?;
/// let c_t = Csr::from_rows(2, [[(0, 1.0)]])?;
/// let problem = ContactProblem::new(Parts { c_t, mu: vec![0.3], ..Parts::new(stiffness, c_n) })?;
/// assert_eq!((problem.displacements(), problem.contacts()), (2, 1));
///
/// let error = ContactProblem::new(Parts { mu: vec![-0.3], ..problem.into_parts() }).unwrap_err();
/// assert_eq!(error.to_string(), "mu[0] is -0.3, but must be 0 or more");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// With the unknowns `u`, `p_T = (p_t, p_o)`, `p_n` and in the conventions of the paper:
/// equilibrium `K u + C_nᵀ p_n + C_tᵀ p_t + C_oᵀ p_o = f` (15); contact `w_n = C_n u ≤ g`, `p_n ≥ 0`,
/// `p_n (w_n - g) = 0` (4); friction `|p_T| ≤ μ p_n`, dissipating most against the slip increment
/// `w_T - w̄_T` with `w_T = (C_t u, C_o u)` (8).
///
/// A contact node has two tangents in three dimensions (any orthonormal pair), one in two, and fewer if supports
/// leave less freedom: a row of `C_t` or `C_o` without such freedom is empty.
#[derive(Debug, Clone)]
pub struct ContactProblem {
    parts: Parts,
    rigid_modes: Vec<Vec<f64>>,
    /// The largest entry of `K`, N/m, which is on the diagonal of a semidefinite matrix.
    stiffest: f64,
    /// The natural units, once they are needed.
    natural: OnceLock<Arc<NaturalUnits>>,
}

/// The parts of a [`ContactProblem`], in SI units.
#[derive(Debug, Clone)]
pub struct Parts {
    /// `K`, symmetric positive semidefinite, n_u × n_u, N/m.
    pub stiffness: Stiffness,
    /// `C_n`, n_c × n_u: contact displacements, positive towards the obstacle.
    pub c_n: Csr,
    /// `C_t`, n_c × n_u: tangential contact displacements. A row is empty if supports leave no tangential freedom.
    pub c_t: Csr,
    /// `C_o`, n_c × n_u: displacements along the other tangent, orthogonal to the first. Every row is empty in two
    /// dimensions.
    pub c_o: Csr,
    /// `μ`, friction coefficients, n_c; the largest values if they change in time.
    pub mu: Vec<f64>,
    /// `l`, integration weights of the contact nodes, n_c, m (m² in space): `σ = p / l` (32). Stresses and the
    /// constants of the paper need them, the equations do not.
    pub weight: Option<Vec<f64>>,
    /// A basis of the null space of `K`, each vector of length n_u: the rigid modes that no support stops; empty for
    /// a supported body. If it is not given, it is computed from `K`.
    pub rigid_modes: Option<Vec<Vec<f64>>>,
}

impl Parts {
    /// Creates the parts of a body without friction: no tangents, no weights, rigid modes to be computed from
    /// `stiffness`.
    pub fn new(stiffness: impl Into<Stiffness>, c_n: Csr) -> Self {
        let none = c_n.emptied();
        let mu = vec![0.0; c_n.rows()];
        Parts { stiffness: stiffness.into(), c_t: none.clone(), c_o: none, mu, c_n, weight: None, rigid_modes: None }
    }
}

/// The data of one increment, in SI units.
#[derive(Debug, Clone, Copy)]
pub struct Increment<'a> {
    /// `f`, external nodal forces at the end of the increment, n_u, N.
    pub force: &'a [f64],
    /// `g`, gaps at the end of the increment, n_c, m; negative for interference.
    pub gap: &'a [f64],
    /// `μ`, friction coefficients at the end of the increment, n_c: 0 where those of the problem are, and perhaps
    /// elsewhere, too.
    pub mu: &'a [f64],
    /// `w̄_t`, tangential displacements at the end of the last increment, n_c, m.
    pub w_t_last: &'a [f64],
    /// `w̄_o`, those along the other tangent, n_c, m.
    pub w_o_last: &'a [f64],
}

/// A state of the body, in SI units.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// `u`, free displacements, n_u, m.
    pub u: Vec<f64>,
    /// The low-order part of `u` in double-double arithmetic, n_u, m; empty where it does not matter. In slender
    /// bodies the forces follow from such small differences of displacements that it does.
    pub u_rest: Vec<f64>,
    /// `p_t`, tangential contact forces, n_c, N.
    pub p_t: Vec<f64>,
    /// `p_o`, those along the other tangent, n_c, N; 0 where there is none.
    pub p_o: Vec<f64>,
    /// `p_n`, normal contact forces, n_c, N; positive in compression.
    pub p_n: Vec<f64>,
}

impl ContactProblem {
    /// Creates the problem of these parts.
    ///
    /// # Errors
    /// [`ProblemError`] names the array that has another length than the others require, has a number that is not
    /// finite, or violates a condition of [`Parts`]: `μ ≥ 0`, positive weights, no displacement with negative energy
    /// in `K`, `K r = 0` for each rigid mode `r`. [`ProblemError::Linear`] if the rigid modes cannot be computed.
    pub fn new(parts: Parts) -> Result<Self, ProblemError> {
        check_parts(&parts)?;
        let rigid_modes = match &parts.rigid_modes {
            Some(motions) => {
                check_rigid_modes(&parts.stiffness, motions)?;
                motions.clone()
            }
            None => parts.stiffness.assembled().and_then(|k| null_space_of(&k)).map_err(|error| match error {
                // The Cholesky factorisation of a semidefinite matrix succeeds after a small increase of the
                // stiffness.
                LinearError::Singular { .. } => ProblemError::NotSemidefinite,
                error => ProblemError::Linear(error),
            })?,
        };
        Ok(Self::of(Parts { rigid_modes: Some(rigid_modes), ..parts }))
    }

    /// Creates a problem from parts that this crate derived from a checked one.
    pub(crate) fn of(mut parts: Parts) -> Self {
        let rigid_modes = parts.rigid_modes.take().unwrap_or_default();
        let stiffest = parts.stiffness.diagonal().iter().fold(0.0_f64, |m, k| m.max(*k));
        ContactProblem { parts, rigid_modes, stiffest, natural: OnceLock::new() }
    }

    /// Sets the natural units of a problem derived from another one.
    pub(crate) fn with_natural_units(self, natural: NaturalUnits) -> Self {
        ContactProblem { natural: OnceLock::from(Arc::new(natural)), ..self }
    }

    /// Returns the natural units.
    pub(crate) fn natural(&self) -> &NaturalUnits {
        self.natural.get_or_init(|| Arc::new(NaturalUnits::of(self)))
    }

    /// Returns the problem with other friction coefficients `mu`, n_c. It shares the stiffness with this one.
    ///
    /// # Errors
    /// As [`ContactProblem::new`] for the coefficients.
    pub fn with_friction(&self, mu: Vec<f64>) -> Result<Self, ProblemError> {
        check_friction(&mu, self.contacts())?;
        let mut problem = self.clone();
        // Rows depend on each other with friction that do not without it.
        if mu.iter().zip(self.mu()).any(|(now, before)| (*now > 0.0) != (*before > 0.0)) {
            problem.natural = OnceLock::new();
        }
        problem.parts.mu = mu;
        Ok(problem)
    }

    /// Restricts the problem to these contact `nodes`. The result must not be used to judge whether loads can be
    /// balanced.
    pub(crate) fn of_nodes(&self, nodes: &[usize]) -> Self {
        let Parts { stiffness, c_n, c_t, c_o, mu, weight, .. } = &self.parts;
        let rows = |map: &Csr| Csr::of_rows(map.columns(), nodes.iter().map(|&i| map.row(i).iter().copied()));
        let values = |values: &Vec<f64>| nodes.iter().map(|&i| values[i]).collect();
        Self::of(Parts {
            stiffness: stiffness.clone(),
            c_n: rows(c_n),
            c_t: rows(c_t),
            c_o: rows(c_o),
            mu: values(mu),
            weight: weight.as_ref().map(values),
            rigid_modes: Some(self.rigid_modes.clone()),
        })
        .with_natural_units(self.natural().of_nodes(nodes))
    }

    /// Returns the parts, for building another problem.
    pub fn into_parts(self) -> Parts {
        Parts { rigid_modes: Some(self.rigid_modes), ..self.parts }
    }

    /// Returns `K`, n_u × n_u, N/m.
    pub fn stiffness(&self) -> &Stiffness {
        &self.parts.stiffness
    }

    /// Returns the largest entry of `K`, N/m.
    pub(crate) fn stiffest(&self) -> f64 {
        self.stiffest
    }

    /// Returns `C_n`, n_c × n_u.
    pub fn c_n(&self) -> &Csr {
        &self.parts.c_n
    }

    /// Returns `C_t`, n_c × n_u.
    pub fn c_t(&self) -> &Csr {
        &self.parts.c_t
    }

    /// Returns `C_o`, n_c × n_u.
    pub fn c_o(&self) -> &Csr {
        &self.parts.c_o
    }

    /// Returns `μ`, n_c.
    pub fn mu(&self) -> &[f64] {
        &self.parts.mu
    }

    /// Returns `l`, n_c, m (m² in space), if they are known.
    pub fn weight(&self) -> Option<&[f64]> {
        self.parts.weight.as_deref()
    }

    /// Returns `√(Σ |p_i|² / l_i)` over the contact nodes: a norm of the contact forces `p_i` (N) that does not grow
    /// with the number of nodes. If no weights are known, `l_i = 1`.
    pub(crate) fn force_norm<const N: usize>(&self, force: impl Fn(usize) -> [f64; N]) -> f64 {
        let weight = self.weight();
        let square = |i: usize| force(i).map(|p| p * p).iter().sum::<f64>() / weight.map_or(1.0, |l| l[i]);
        (0..self.contacts()).map(square).sum::<f64>().sqrt()
    }

    /// Returns a basis of the null space of `K`, each vector of length n_u.
    pub fn rigid_modes(&self) -> &[Vec<f64>] {
        &self.rigid_modes
    }

    /// Returns the number of free displacements, n_u.
    pub fn displacements(&self) -> usize {
        self.stiffness().order()
    }

    /// Returns the number of contact nodes, n_c.
    pub fn contacts(&self) -> usize {
        self.c_n().rows()
    }

    /// Returns `K u + C_nᵀ p_n + C_tᵀ p_t + C_oᵀ p_o - f`, n_u, N, for external forces `force` (n_u, N); in twice the
    /// working precision if the state has a `u_rest`.
    ///
    /// # Errors
    /// If an array has another length than the problem needs, or a rank that shares the stiffness has failed.
    pub fn equilibrium(&self, force: &[f64], state: &State) -> Result<Vec<f64>, ProblemError> {
        state.check(self)?;
        error::expect_length("force", self.displacements(), force.len(), "one for each displacement")?;
        Ok(self.imbalance(force, state)?)
    }

    /// Returns `K u + C_nᵀ p_n + C_tᵀ p_t + C_oᵀ p_o - f`, N; in twice the working precision if the state has a
    /// `u_rest`.
    ///
    /// # Errors
    /// If a rank that shares the stiffness has failed.
    pub(crate) fn imbalance(&self, force: &[f64], state: &State) -> Computed<Vec<f64>> {
        if state.u_rest.is_empty() {
            let mut balance = vec![0.0; state.u.len()];
            self.stiffness().mul(&state.u, &mut balance)?;
            self.c_n().add_transposed(&state.p_n, &mut balance);
            self.c_t().add_transposed(&state.p_t, &mut balance);
            self.c_o().add_transposed(&state.p_o, &mut balance);
            balance.iter_mut().zip(force).for_each(|(sum, force)| *sum -= force);
            return Ok(balance);
        }
        let mut balance = vec![DoubleDouble::default(); state.u.len()];
        let (u, u_rest) = self.strained(state);
        self.stiffness().add_beyond(&u, &u_rest, &mut balance)?;
        for (map, forces) in [(self.c_n(), &state.p_n), (self.c_t(), &state.p_t), (self.c_o(), &state.p_o)] {
            for (i, p) in forces.iter().enumerate() {
                map.row(i).iter().for_each(|&(dof, c)| balance[dof].add_product(c, *p));
            }
        }
        balance.iter_mut().zip(force).for_each(|(sum, force)| sum.add(-force));
        Ok(balance.into_iter().map(DoubleDouble::value).collect())
    }

    /// Computes [`strained`] of the displacements of `state`.
    pub(crate) fn strained(&self, state: &State) -> (Vec<f64>, Vec<f64>) {
        strained(&self.rigid_modes, &state.u, &state.u_rest)
    }

    /// Returns the slip increment `w_T - w̄_T` of contact node `i` (m), including the `u_rest` of `state`: the
    /// direction of a small slip may be lost in the rounding of the displacements.
    pub(crate) fn slip(&self, increment: &Increment<'_>, state: &State, i: usize) -> [f64; 2] {
        let last = [increment.w_t_last[i], increment.w_o_last[i]];
        [0, 1].map(|d| self.tangential_maps()[d].difference(i, &state.u, &state.u_rest, last[d]))
    }

    /// Returns the motion of each contact node relative to its obstacle, `[w_n - g, w_t - w̄_t, w_o - w̄_o]`, m, including the
    /// `u_rest` of `state`, in twice the working precision.
    ///
    /// # Errors
    /// If an array of `increment` or `state` does not fit this problem.
    pub fn relative_motions(&self, increment: &Increment<'_>, state: &State) -> Result<Vec<[f64; 3]>, ProblemError> {
        increment.check(self)?;
        state.check(self)?;
        let motion = |i: usize| {
            let normal = self.c_n().difference(i, &state.u, &state.u_rest, increment.gap[i]);
            let [t, o] = self.slip(increment, state, i);
            [normal, t, o]
        };
        Ok((0..self.contacts()).map(motion).collect())
    }

    /// Returns the work that friction dissipates in one increment, `p_Tᵀ (w_T - w̄_T)`, J, or J per m of depth. By
    /// (8) the contribution of every node is nonnegative.
    pub(crate) fn friction_work(&self, increment: &Increment<'_>, state: &State) -> f64 {
        let of_node = |i: usize| {
            let [slip_t, slip_o] = self.slip(increment, state, i);
            state.p_t[i] * slip_t + state.p_o[i] * slip_o
        };
        (0..self.contacts()).map(of_node).sum()
    }

    /// Returns the strain energy `½ uᵀ K u` of a state of this problem, J, or J per m of depth.
    ///
    /// # Errors
    /// If an array of `state` does not fit this problem, or a rank that shares the stiffness has failed.
    pub fn strain_energy(&self, state: &State) -> Result<f64, ProblemError> {
        state.check(self)?;
        let mut force = vec![0.0; state.u.len()];
        self.stiffness().mul(&state.u, &mut force)?;
        Ok(0.5 * state.u.iter().zip(&force).map(|(u, f)| u * f).sum::<f64>())
    }

    /// Computes [`ContactProblem::energy_of_parts`] with friction: those that elasticity or contact rows connect to a rough node.
    pub(crate) fn energy_with_friction(&self, force: &[f64], state: &State) -> f64 {
        let part = &self.natural().contact_part;
        let frictional: BTreeSet<_> = (0..self.contacts()).filter(|&i| self.mu()[i] > 0.0).map(|i| part[i]).collect();
        self.energy_of_parts(force, state, |part| frictional.contains(&part))
    }

    /// Computes the strain energy of the parts that count, of a state in equilibrium with the external forces `force` (N), as half
    /// the work of all forces: `½ uᵀ (f - Cᵀ p)`.
    pub(crate) fn energy_of_parts(&self, force: &[f64], state: &State, counts: impl Fn(usize) -> bool) -> f64 {
        let NaturalUnits { part, contact_part, .. } = self.natural();
        let loads = state.u.iter().zip(force).zip(part).filter(|(_, part)| counts(**part));
        let loads: f64 = loads.map(|((u, f), _)| u * f).sum();
        let maps = [(self.c_n(), &state.p_n), (self.c_t(), &state.p_t), (self.c_o(), &state.p_o)];
        let contact = |(map, forces): (&Csr, &Vec<f64>)| -> f64 {
            let pressed = forces.iter().enumerate().filter(|(i, p)| **p != 0.0 && counts(contact_part[*i]));
            pressed.map(|(i, p)| p * map.dot(i, &state.u)).sum()
        };
        0.5 * (loads - maps.into_iter().map(contact).sum::<f64>())
    }

    /// Returns the displacements on which contact forces act, ascending. There are none along an obstacle without
    /// friction.
    pub fn contact_displacements(&self) -> Vec<usize> {
        self.contact_displacements_of(0..self.contacts())
    }

    /// Returns the displacements on which the forces of some contact `nodes` act.
    pub(crate) fn contact_displacements_of(&self, nodes: impl Iterator<Item = usize> + Clone) -> Vec<usize> {
        let normal = nodes.clone().flat_map(|i| self.c_n().row(i));
        let frictional = nodes.filter(|&i| self.mu()[i] > 0.0);
        let tangential = frictional.flat_map(|i| self.tangential_maps().map(|map| map.row(i))).flatten();
        normal.chain(tangential).map(|&(dof, _)| dof).collect::<BTreeSet<_>>().into_iter().collect()
    }

    /// Returns the displacements (n_u, m) in the sum of the rigid modes with these `weights`.
    pub(crate) fn rigid_motion(&self, weights: &[f64]) -> Vec<f64> {
        let mut u = vec![0.0; self.displacements()];
        for (motion, weight) in self.rigid_modes().iter().zip(weights) {
            u.iter_mut().zip(motion).for_each(|(u, r)| *u += weight * r);
        }
        u
    }

    /// Returns `w_n`, `w_t` and `w_o` (n_c, m) of displacements `u`.
    pub(crate) fn contact_motion(&self, u: &[f64]) -> [Vec<f64>; 3] {
        [self.c_n(), self.c_t(), self.c_o()].map(|map| map.mul(u))
    }

    /// Returns `(C_t, C_o)`.
    pub fn tangential_maps(&self) -> [&Csr; 2] {
        [self.c_t(), self.c_o()]
    }

    /// Returns units of order one for a run whose external nodal forces reach `largest_force` (N) and whose obstacles
    /// penetrate the body by up to `interference` (m): the stiffness of a typical node, and the resulting
    /// displacement.
    pub fn scaling(&self, largest_force: f64, interference: f64) -> Scaling {
        let stiffness = median(&mut self.stiffness().diagonal()).unwrap_or(1.0);
        Scaling::near(stiffness, interference.max(largest_force / stiffness))
    }
}

impl State {
    /// Returns the undeformed body without contact forces.
    pub fn zero(problem: &ContactProblem) -> Self {
        let none = vec![0.0; problem.contacts()];
        State {
            u: vec![0.0; problem.displacements()],
            u_rest: Vec::new(),
            p_t: none.clone(),
            p_o: none.clone(),
            p_n: none,
        }
    }
}

const PER_CONTACT: &str = "one for each row of c_n";
const PER_DISPLACEMENT: &str = "one for each displacement";

/// The relative negative eigenvalue of a 2 × 2 block of `K` that counts as rounding.
const SEMIDEFINITE: f64 = 1e-10;

/// The largest `K r` of a rigid mode `r`, relative to its terms. Rotations of bodies with a thousand elements per
/// side leave 1e-13.
const FREE: f64 = 1e-9;

/// A unit vector is linearly independent if its component orthogonal to the vectors before it is longer than this.
const INDEPENDENT: f64 = 1e-8;

fn check_parts(parts: &Parts) -> Result<(), ProblemError> {
    let Parts { stiffness, c_n, c_t, c_o, mu, weight, .. } = parts;
    let (n_u, n_c) = (stiffness.order(), c_n.rows());
    if n_u == 0 {
        return Err(ProblemError::Empty);
    }
    check_semidefinite(stiffness)?;
    for (name, map) in [("c_n", c_n), ("c_t", c_t), ("c_o", c_o)] {
        check_size(name, map, n_c, n_u)?;
    }
    check_friction(mu, n_c)?;
    if let Some(weight) = weight {
        expect_length("weight", n_c, weight.len(), PER_CONTACT)?;
        expect_each("weight", weight, "above 0", |l| l > 0.0 && l.is_finite())?;
    }
    Ok(())
}

/// Checks friction coefficients of `n_c` contact nodes.
fn check_friction(mu: &[f64], n_c: usize) -> Result<(), ProblemError> {
    expect_length("mu", n_c, mu.len(), PER_CONTACT)?;
    expect_each("mu", mu, "0 or more", |mu| mu >= 0.0 && mu.is_finite())
}

fn check_size(name: &str, map: &Csr, rows: usize, columns: usize) -> Result<(), ProblemError> {
    let fault = |of, expected, found, reason| {
        Err(ProblemError::Length { array: name.to_string(), of, expected, found, reason })
    };
    if map.rows() != rows {
        return fault("rows", rows, map.rows(), PER_CONTACT);
    }
    if map.columns() != columns {
        return fault("columns", columns, map.columns(), PER_DISPLACEMENT);
    }
    Ok(())
}

/// Checks every 2 × 2 block: `K_ii ≥ 0` and `K_ij² ≤ K_ii K_jj`. The factorisations detect what only larger blocks
/// would show. A distributed one is a sum of element stiffnesses, and no process sees all of it.
fn check_semidefinite(stiffness: &Stiffness) -> Result<(), ProblemError> {
    let stiffness = match stiffness {
        Stiffness::Assembled(stiffness) => stiffness,
        Stiffness::Distributed(rows) => return expect_finite("stiffness", rows.row_norms()),
    };
    let diagonal = stiffness.diagonal();
    for (row, column, between) in stiffness.lower_entries() {
        if !between.is_finite() {
            return Err(ProblemError::Value {
                array: format!("stiffness({row}, {column})"),
                value: between,
                must: "finite",
            });
        }
        let (first, second) = (diagonal[row], diagonal[column]);
        let bound = first.max(0.0).sqrt() * second.max(0.0).sqrt();
        if first < 0.0 || between.abs() > (1.0 + SEMIDEFINITE) * bound {
            return Err(ProblemError::Indefinite { row, column, first, between, second });
        }
    }
    Ok(())
}

/// Checks that `K r = 0` for each motion `r`, and that the motions are linearly independent.
fn check_rigid_modes(stiffness: &Stiffness, motions: &[Vec<f64>]) -> Result<(), ProblemError> {
    let n_u = stiffness.order();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for (motion, r) in motions.iter().enumerate() {
        let name = format!("rigid_modes[{motion}]");
        expect_length(&name, n_u, r.len(), PER_DISPLACEMENT)?;
        expect_finite(&name, r)?;
        let (mut force, sizes) = (vec![0.0; n_u], stiffness.sizes(r)?);
        stiffness.mul(r, &mut force)?;
        let largest = sizes.iter().fold(0.0_f64, |m, size| m.max(*size));
        let worst = (0..n_u).max_by(|&i, &j| force[i].abs().total_cmp(&force[j].abs()));
        if let Some(row) = worst.filter(|&row| force[row].abs() > FREE * largest) {
            return Err(ProblemError::Resisted { motion, row, share: force[row].abs() / largest });
        }
        let length = r.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let mut direction: Vec<f64> = r.iter().map(|x| x / length).collect();
        let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        let whole = norm(&direction);
        for other in &basis {
            let along: f64 = direction.iter().zip(other).map(|(x, y)| x * y).sum();
            direction.iter_mut().zip(other).for_each(|(x, y)| *x -= along * y);
        }
        let remainder = norm(&direction);
        if remainder.is_nan() || remainder <= INDEPENDENT * whole {
            return Err(ProblemError::Dependent { motion });
        }
        for x in &mut direction {
            *x /= remainder;
        }
        basis.push(direction);
    }
    Ok(())
}

impl Increment<'_> {
    /// # Errors
    /// [`ProblemError`] with the array that does not fit `problem`, or has a number that is not finite.
    pub fn check(&self, problem: &ContactProblem) -> Result<(), ProblemError> {
        expect_length("force", problem.displacements(), self.force.len(), PER_DISPLACEMENT)?;
        expect_finite("force", self.force)?;
        for (name, values) in [("gap", self.gap), ("w_t_last", self.w_t_last), ("w_o_last", self.w_o_last)] {
            expect_length(name, problem.contacts(), values.len(), PER_CONTACT)?;
            expect_finite(name, values)?;
        }
        expect_length("mu", problem.contacts(), self.mu.len(), PER_CONTACT)?;
        expect_finite("mu", self.mu)?;
        let mut pairs = self.mu.iter().zip(problem.mu());
        match pairs.position(|(now, ever)| !(*now >= 0.0 && (*now > 0.0) == (*ever > 0.0))) {
            None => Ok(()),
            Some(i) => {
                let must = "above 0 where that of the problem is, and 0 elsewhere";
                Err(ProblemError::Value { array: format!("mu[{i}]"), value: self.mu[i], must })
            }
        }
    }
}

impl State {
    /// Checks that the arrays have the lengths that `problem` needs. Their values are not checked: the error measure
    /// rejects a state that is not finite.
    ///
    /// # Errors
    /// [`ProblemError`] with the array of another length.
    pub fn check(&self, problem: &ContactProblem) -> Result<(), ProblemError> {
        expect_length("u", problem.displacements(), self.u.len(), PER_DISPLACEMENT)?;
        if !self.u_rest.is_empty() {
            expect_length("u_rest", problem.displacements(), self.u_rest.len(), PER_DISPLACEMENT)?;
        }
        for (name, values) in [("p_t", &self.p_t), ("p_o", &self.p_o), ("p_n", &self.p_n)] {
            expect_length(name, problem.contacts(), values.len(), PER_CONTACT)?;
        }
        Ok(())
    }
}
