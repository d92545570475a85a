//! A Newton system on all ranks: its matrix, the elimination of contact from it, and the solver.
//!
//! The matrix is `A = f J K Jᵀ + C`, with a stiffness `K` between displacements, the ones `J`, and all others `C`.
//! Contact is eliminated exactly, node by node: first the held displacements `E r`, then a cycle of algebraic multigrid
//! on the matrix `R A F` between the free displacements, then the reactions `T`,
//!
//! ```text
//! y = E r,   y += F (R A F)⁻¹ R (r - A y),   y += T (r - A y).
//! ```
//!
//! If an exact inverse takes the place of the cycle, this is the inverse of `A`. Multiplied out, with the products of
//! `A` and the matrices of contact, which have few entries, it is `(E + T - T A E) + (F - T A F) (R A F)⁻¹ (R - R A
//! E)`.

use std::collections::HashMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use stickslip::algebra::linear::{FactorInfo, LinearError};

use crate::exchange::Exchange;
use crate::job::{Job, Own, Remote};
use crate::petsc::{self, Cycle, Entry, Found, Int, Krylov, Matrix, Parts, Vector};

/// The data of a system that all ranks know.
#[derive(Default, Serialize, Deserialize)]
pub(crate) struct Setup {
    /// The dimension; 0 for a system that is factored.
    pub dimension: usize,
    pub options: String,
    /// The ranges of nodes and of rows of the ranks.
    pub nodes: Vec<usize>,
    pub rows: Vec<usize>,
    /// The number of rigid motions.
    pub motions: usize,
    /// The number of the shared stiffness, if it is one.
    pub stiffness: Option<i64>,
}

/// The data of a system that rank 0 alone has.
#[derive(Default)]
pub(crate) struct Places<'a> {
    /// The row of each unknown.
    pub rows: &'a [Int],
    /// The displacements of the rigid motions, followed by zeros.
    pub motions: Vec<Vec<f64>>,
    /// Row and column of each entry of a stiffness that is not shared, and of all others.
    pub stiffness: [Vec<Int>; 2],
    pub rest: [Vec<Int>; 2],
}

/// The change of a system that all ranks know.
#[derive(Serialize, Deserialize)]
pub(crate) struct Change {
    /// The factor of the stiffness; nothing if all values stay.
    pub factor: Option<f64>,
    pub by: By,
}

/// The way to solve.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(crate) enum By {
    /// MUMPS.
    Factors,
    /// The options, with contact eliminated and the cycle of this number, which may be made anew.
    Options { cycle: i64, fresh: bool, unsymmetric: bool },
}

/// The values of the entries that rank 0 alone has, in the order of [`Places`], and the entries of the matrices that
/// eliminate contact.
#[derive(Default, Clone, Copy)]
pub(crate) struct Values<'a> {
    pub stiffness: &'a [f64],
    pub rest: &'a [f64],
    pub contact: Option<&'a Contact>,
}

/// The entries of the matrices that eliminate contact.
#[derive(Default)]
pub(crate) struct Contact {
    pub held: Vec<Entry>,
    pub to_all: Vec<Entry>,
    pub from_all: Vec<Entry>,
    pub reactions: Vec<Entry>,
    /// The terms that are added to the matrix between the free displacements.
    pub added: Vec<Entry>,
}

/// The part of one rank.
pub(crate) struct System {
    setup: Setup,
    rank: usize,
    stiffness: Option<Arc<Matrix>>,
    factor: f64,
    rest: Matrix,
    /// The ones from displacements to all unknowns, and back.
    ones: [Matrix; 2],
    exchange: Exchange,
    solution: Vector,
    kernel: Vec<Vector>,
    /// `true` if the options name a preconditioner, so that contact is not eliminated.
    has_other: bool,
    krylov: Option<Krylov>,
    is_factored: bool,
    cycles: HashMap<i64, Cycle>,
}

impl System {
    /// Creates the part of this rank.
    pub(crate) fn new(
        rank: usize,
        setup: Setup,
        shared: Option<Arc<Matrix>>,
        own: Places<'_>,
    ) -> Result<Self, LinearError> {
        petsc::start(&setup.options)?;
        let here = |bounds: &[usize]| bounds[rank + 1] - bounds[rank];
        let (d, free, all) = (setup.dimension, here(&setup.nodes) * setup.dimension, here(&setup.rows));
        let exchange = Exchange::new(all, own.rows)?;
        let mut kernel = Vec::new();
        for k in 0..setup.motions {
            exchange.deal(own.motions.get(k).map_or(&[], |motion| motion))?;
            let (motion, vector) = (exchange.own.with(|all| all[..free].to_vec())?, Vector::new(free)?);
            vector.with(|to| to.copy_from_slice(&motion))?;
            kernel.push(vector);
        }
        let stiffness = match shared {
            None if d > 0 => Some(Arc::new(Matrix::with_places([free; 2], [d; 2], own.stiffness)?)),
            shared => shared,
        };
        // Every rank has the ones of its own displacements.
        let (row, column) = (setup.rows[rank] as Int, (setup.nodes[rank] * d) as Int);
        let ones = (0..free as Int).map(|k| (row + k, column + k, 1.0));
        let back = ones.clone().map(|(row, column, one)| (column, row, one));
        Ok(System {
            rank,
            stiffness,
            factor: 1.0,
            rest: Matrix::with_places([all; 2], [1; 2], own.rest)?,
            ones: [Matrix::of([all, free], [1, d.max(1)], ones)?, Matrix::of([free, all], [d.max(1), 1], back)?],
            exchange,
            solution: Vector::new(all)?,
            kernel,
            has_other: d > 0 && petsc::has(c"-pc_type")?,
            krylov: None,
            is_factored: false,
            cycles: HashMap::new(),
            setup,
        })
    }

    /// Takes over values, and prepares to solve. Returns the numbers of [`info`].
    pub(crate) fn factorize(&mut self, change: &Change, own: Values<'_>) -> Result<Vec<f64>, LinearError> {
        // Another system may have replaced them.
        petsc::start(&self.setup.options)?;
        if let Some(factor) = change.factor {
            self.factor = factor;
            self.rest.set(own.rest)?;
            if let (Some(stiffness), None) = (&self.stiffness, self.setup.stiffness) {
                stiffness.set(own.stiffness)?;
            }
        }
        if let By::Factors = change.by {
            return self.factors();
        }
        self.krylov = None;
        self.is_factored = false;
        let stiffness = self.stiffness.clone().ok_or(crate::NOT_ANALYZED)?;
        if self.has_other {
            self.krylov = Some(Krylov::new(c"", &self.assembled(&stiffness)?, None)?);
        } else {
            self.by_options(&stiffness, own.contact.unwrap_or(&Contact::default()), change.by)?;
        }
        let entries = stiffness.entries()? + self.rest.entries()?;
        Ok(vec![0.0, entries, 0.0, 1.0, 0.0])
    }

    /// Returns the whole matrix, assembled.
    fn assembled(&self, k: &Matrix) -> Result<Matrix, LinearError> {
        let [to, back] = &self.ones;
        to.times(k)?.times(back)?.plus(self.factor, &[(1.0, &self.rest)])
    }

    /// Prepares to solve as the options say, with contact eliminated.
    fn by_options(&mut self, k: &Matrix, contact: &Contact, by: By) -> Result<(), LinearError> {
        let System { factor, rest, ones: [to, back], rank, .. } = self;
        let (d, f, nodes, rows) = (self.setup.dimension, *factor, &self.setup.nodes, &self.setup.rows);
        let here = |bounds: &[usize]| bounds[*rank + 1] - bounds[*rank];
        let (free, all) = (here(nodes) * d, here(rows));
        let of = |sizes, entries: &[Entry]| Matrix::of(sizes, [1; 2], entries.iter().copied());
        let (held, reactions) = (of([all; 2], &contact.held)?, of([all; 2], &contact.reactions)?);
        let (to_more, from_more) = (of([all, free], &contact.to_all)?, of([free, all], &contact.from_all)?);
        let to_all = to.plus(1.0, &[(1.0, &to_more)])?;
        let from_all = back.plus(1.0, &[(1.0, &from_more)])?;
        let a_times = |m: &Matrix| to.times(&k.times(&back.times(m)?)?)?.plus(f, &[(1.0, &rest.times(m)?)]);
        let times_a = |m: &Matrix| m.times(to)?.times(k)?.times(back)?.plus(f, &[(1.0, &m.times(rest)?)]);
        let By::Options { cycle, fresh, unsymmetric } = by else { return Err(crate::NOT_FACTORIZED) };
        if fresh {
            // The old cycle is dropped before a new one is made.
            self.cycles.remove(&cycle);
            // F = J + F_c and R = Jᵀ + R_c make R A F = f K + Jᵀ C J + R A F_c + R_c A J.
            let added = of([free; 2], &contact.added)?;
            let by_rest = back.times(rest)?.times(to)?;
            let by_to = from_all.times(&a_times(&to_more)?)?;
            let by_from = times_a(&from_more)?.times(to)?;
            let beside = added.plus(1.0, &[(1.0, &by_rest), (1.0, &by_to), (1.0, &by_from)])?;
            let between = k.plus_within(f, &beside)?;
            self.cycles.insert(cycle, Cycle::new(&between, d, &self.kernel, !unsymmetric)?);
        }
        let (by_held, by_reactions) = (a_times(&held)?, times_a(&reactions)?);
        let [less_from, less_to] = [from_all.times(&by_held)?, by_reactions.times(&to_all)?];
        let less = reactions.times(&by_held)?;
        let parts = Parts {
            known: held.plus(1.0, &[(1.0, &reactions), (-1.0, &less)])?,
            from_all: from_all.plus(1.0, &[(-1.0, &less_from)])?,
            to_all: to_all.plus(1.0, &[(-1.0, &less_to)])?,
        };
        let places: Vec<Int> = (rows[*rank]..rows[*rank + 1]).map(|row| row as Int).collect();
        let (of_free, of_forces) = places.split_at(free);
        let matrix = Matrix::beside(k, f, [of_free, of_forces], rest)?;
        let cycle = self.cycles.get(&cycle).ok_or(crate::NOT_FACTORIZED)?;
        cycle.set(&matrix, &parts)?;
        self.krylov = Some(Krylov::new(c"", &matrix, Some(cycle))?);
        Ok(())
    }

    /// Factors the matrix. If that takes more memory than predicted, it is repeated with more room.
    fn factors(&mut self) -> Result<Vec<f64>, LinearError> {
        /// The room of the factors beyond the prediction, in per cent, and the number of attempts with more.
        const ROOM: usize = 30;
        const TRIES: usize = 7;
        let mut room = ROOM;
        self.cycles.clear();
        let mut krylov = self.krylov.take().filter(|_| self.is_factored);
        let assembled = self.stiffness.as_ref().map(|k| self.assembled(k)).transpose()?;
        let matrix = assembled.as_ref().unwrap_or(&self.rest);
        for _ in 0..TRIES {
            let made = if let Some(made) = krylov.take() {
                made.set_up(matrix)?;
                made
            } else {
                petsc::set(c"-factors_mat_mumps_icntl_14", room)?;
                Krylov::new(c"factors_", matrix, None)?
            };
            let ([status, peak, entries], [flops, least, largest]) = made.factor_info()?;
            self.is_factored = status >= 0;
            if !matches!(status, -8 | -9 | -11 | -14 | -15 | -17 | -20) {
                // Large counts are told in millions.
                let entries = if entries < 0 { -1e6 * f64::from(entries) } else { f64::from(entries) };
                let (pivots, peak_bytes) = (least / largest, 1e6 * f64::from(peak));
                // MUMPS does not factor with an instance that has failed.
                self.krylov = Some(made).filter(|_| self.is_factored);
                return Ok(vec![status.into(), entries, flops, pivots, peak_bytes]);
            }
            room = 2 * room + 20;
        }
        Ok(vec![-9.0, 0.0, 0.0, 0.0, 0.0])
    }

    /// Solves `A x = b` from 0 to a relative residual of `tolerance`, in at most `limit` iterations if that is given.
    /// Rank 0 has both vectors. Returns the numbers of what was [`Found`].
    pub(crate) fn solve(
        &self,
        tolerance: f64,
        limit: Option<usize>,
        b: &[f64],
        x: &mut [f64],
    ) -> Result<Vec<f64>, LinearError> {
        let Some(krylov) = &self.krylov else { return Err(crate::NOT_FACTORIZED) };
        self.exchange.deal(b)?;
        let Found { iterations, reason } = krylov.solve(&self.exchange.own, &self.solution, tolerance, limit)?;
        self.exchange.collect(&self.solution, x)?;
        Ok(vec![iterations as f64, reason.into()])
    }
}

/// Returns the properties of the present factors or of the matrix: MUMPS's status, which is equal on all ranks and 0
/// without it, the entries, operations, ratio of pivots, and peak memory in bytes.
///
/// # Errors
/// If MUMPS failed.
fn info(reply: &[f64]) -> Result<FactorInfo, LinearError> {
    /// The status of a zero pivot.
    const SINGULAR: Int = -10;
    const STEP: &str = "the factorisation";
    let &[status, entries, flops, pivot_ratio, peak_bytes] = reply else { return Err(crate::NOT_FACTORIZED) };
    match status as Int {
        // Positive statuses are warnings.
        0.. => Ok(FactorInfo { entries: entries as usize, flops, pivot_ratio, peak_bytes }),
        SINGULAR => Err(LinearError::Singular { pivot_ratio: 0.0 }),
        // Memory was refused, a caller's limit or the 32-bit range was exceeded, or the prediction was too small
        // despite more memory.
        -7 | -8 | -9 | -11 | -15..=-13 | -17 | -19 | -20 | -51 | -52 => Err(LinearError::OutOfMemory { step: STEP }),
        status => Err(LinearError::Backend { backend: "mumps", step: STEP, status: status.into() }),
    }
}

/// Passes a change to all ranks, which prepare to solve.
pub(crate) fn factorize(system: &Remote, change: Change, values: Values<'_>) -> Result<FactorInfo, LinearError> {
    info(&system.run(Job::Factorize(change), Own { values, ..Own::default() })?)
}

/// Solves `A x = b` as [`System::solve`] says.
pub(crate) fn solve(
    system: &Remote,
    tolerance: f64,
    limit: Option<usize>,
    b: &[f64],
    x: &mut [f64],
) -> Result<Found, LinearError> {
    let own = Own { x: [b, &[]], y: [x, &mut []], ..Own::default() };
    let reply = system.run(Job::Solve { tolerance, limit }, own)?;
    let &[iterations, reason] = &reply[..] else { return Err(crate::NOT_FACTORIZED) };
    Ok(Found { iterations: iterations as usize, reason: reason as i32 })
}
