//! A Newton system on all ranks: its matrix, the elimination of contact from it, and the solver.
//!
//! The matrix is `A = f K + C`, with a stiffness `K` between displacements and all others `C`; rows of
//! removed directions have a diagonal alone. Contact is eliminated node by node: first the held displacements `E r`,
//! then a cycle of algebraic multigrid on the matrix `R A F` between the free displacements, then the reactions `T`,
//!
//! ```text
//! y = E r,   y += F (R A F)⁻¹ R (r - A y),   y += T (r - A y).
//! ```
//!
//! If an exact inverse takes the place of the cycle, this is the inverse of `A` in the oblique form (`node`). Multiplied
//! out, with the products of `A` and the matrices of contact, which have few entries, it is
//! `(E + T - T A E) + (F - T A F) (R A F)⁻¹ (R - R A E)`.

use std::ffi::CString;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use stickslip::algebra::linear::{FactorInfo, LinearError};

use crate::expect_length;
use crate::job::{Job, Own, Remote, Reply};
use crate::petsc::{self, Cycle, Entries, Exchange, Int, Krylov, Matrix, Vector};
use crate::rows::Rows;

/// The data of a system that all ranks know.
#[derive(Default, Serialize, Deserialize)]
pub(crate) struct Setup {
    /// The dimension; 0 for a system that is factored.
    pub dimension: usize,
    pub options: String,
    /// The ranges of rows of the ranks, and the number of rows of displacements, which are the first.
    pub rows: Vec<usize>,
    pub displacements: usize,
    /// The number of rigid motions.
    pub motions: usize,
    /// The number of the shared stiffness, if it is one.
    pub stiffness: Option<i64>,
}

/// The way to solve.
#[derive(Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) enum By {
    /// MUMPS.
    Factors,
    /// The options, with contact eliminated, and the present cycle.
    Cycle,
    /// The same with a new cycle.
    NewCycle { spd: bool },
}

/// The entries of `E`, `F`, `R` and `T` without the ones of the identity, and those that are added to `R A F`.
pub(crate) type Contact = [Entries; 5];

/// The part of one rank.
pub(crate) struct System {
    setup: Setup,
    /// The number of rows of this rank.
    size: usize,
    /// The shared stiffness, its factor, all other entries, and the sum, which is computed where its entries are needed.
    stiffness: Option<Arc<Matrix>>,
    factor: f64,
    rest: Matrix,
    entries_of_rest: usize,
    sum: Option<Matrix>,
    /// The ones of the displacements, and the identity with shares and its transpose.
    ones: Matrix,
    shares: [Matrix; 2],
    exchange: Exchange,
    kernel: Vec<Vector>,
    krylov: Option<Krylov>,
    cycle: Option<Cycle>,
}

impl System {
    /// Creates the part of this rank, with the `shared` stiffness.
    pub(crate) fn new(rank: usize, setup: Setup, shared: Option<&Rows>, own: Own<'_>) -> Result<Self, LinearError> {
        petsc::start(&setup.options)?;
        let own_rows = setup.rows[rank]..setup.rows[rank + 1];
        let size = own_rows.len();
        let exchange = Exchange::new(size, own.places)?;
        let mut kernel = Vec::new();
        for k in 0..setup.motions {
            kernel.push(Vector::new(size)?);
            exchange.deal(own.motions.get(k).map_or(&[], |motion| motion), &kernel[k])?;
        }
        let with_ones = |mut entries: Entries, end: usize| {
            own_rows.clone().filter(|row| *row < end).for_each(|row| entries.push(row as Int, row as Int, 1.0));
            Matrix::of(size, entries)
        };
        let [shares, back] = own.shares.map(|entries| with_ones(entries, usize::MAX));
        Ok(System {
            size,
            stiffness: shared.map(|rows| Arc::clone(&rows.matrix)),
            factor: 1.0,
            entries_of_rest: own.rest.values.len(),
            rest: Matrix::of(size, own.rest)?,
            sum: None,
            ones: with_ones(Entries::default(), setup.displacements)?,
            shares: [shares?, back?],
            exchange,
            kernel,
            krylov: None,
            cycle: None,
            setup,
        })
    }

    /// Takes over the values of the rest, with a factor of the stiffness, unless all values stay. Prepares to solve.
    /// Returns the numbers of [`info`].
    pub(crate) fn factorize(&mut self, factor: Option<f64>, by: By, own: &Own<'_>) -> Reply {
        // Another system may have replaced them.
        petsc::start(&self.setup.options)?;
        // Factors without a cycle before them have an analysis to go on with.
        let kept = self.krylov.take().filter(|_| by == By::Factors && self.cycle.is_none());
        if let Some(factor) = factor {
            self.factor = factor;
            expect_length("values of the matrix", self.entries_of_rest, own.x[0].len())?;
            self.rest.set(own.x[0])?;
        }
        let is_whole = by == By::Factors || petsc::has(c"-pc_type")?;
        if let Some(stiffness) = &self.stiffness {
            let sum = Matrix::sum(self.factor, stiffness, &self.rest)?;
            // One that is computed keeps its pattern, of which there may be an analysis.
            self.sum = Some(match self.sum.take().filter(|_| kept.is_some() || is_whole && by != By::Factors) {
                Some(before) => before.set_sum(self.factor, stiffness, &self.rest).map(|()| before)?,
                None if is_whole => sum.merged()?,
                None => sum,
            });
        }
        if by == By::Factors {
            self.cycle = None;
            return self.factors(kept);
        }
        if !is_whole {
            self.eliminate(by, own.contact.cloned().unwrap_or_default())?;
        }
        self.krylov = Some(Krylov::new(c"", self.matrix(), self.cycle.as_ref())?);
        let shared = self.stiffness.as_ref().map_or(Ok(0.0), |stiffness| stiffness.entries())?;
        Ok(vec![0.0, shared + self.rest.entries()?, 0.0, 1.0, 0.0])
    }

    fn matrix(&self) -> &Matrix {
        self.sum.as_ref().unwrap_or(&self.rest)
    }

    /// Computes a product with `A` as the sum of those with its parts.
    fn of_parts(&self, product: impl Fn(&Matrix) -> Result<Matrix, LinearError>) -> Result<Matrix, LinearError> {
        let of_rest = product(&self.rest)?;
        let Some(stiffness) = &self.stiffness else { return Ok(of_rest) };
        of_rest.plus(self.factor, &product(stiffness)?)
    }

    /// Prepares the cycle, with this `contact` eliminated.
    fn eliminate(&mut self, by: By, contact: Contact) -> Result<(), LinearError> {
        let (ones, [shares, back]) = (&self.ones, &self.shares);
        let [held, freed, sweeping, reactions, added] = contact.map(|entries| Matrix::of(self.size, entries));
        let (freed, sweeping) = (freed?, sweeping?);
        let [mut held, mut reactions] = [held?, reactions?];
        let [mut free, mut swept] = [ones.copy()?.plus(1.0, &freed)?, ones.copy()?.plus(1.0, &sweeping)?];
        // Displacements contain others only without a shared stiffness.
        if self.stiffness.is_none() {
            [held, free] = [shares.times(&held)?, shares.times(&free)?];
            [reactions, swept] = [reactions.times(back)?, swept.times(back)?];
        }
        if let By::NewCycle { spd } = by {
            // The old cycle is dropped before a new one is made.
            self.cycle = None;
            let mut between = swept.times(&self.rest)?.times(&free)?.plus(1.0, &added?)?;
            if let Some(stiffness) = &self.stiffness {
                // Contact changes few of its entries, and adds none.
                let changed = stiffness.copy()?;
                changed.add(&stiffness.times(&freed)?)?;
                changed.add(&sweeping.times(&changed)?)?;
                between = between.plus(self.factor, &changed)?;
            }
            self.cycle = Some(Cycle::new(&between, self.setup.dimension, &self.kernel, spd)?);
        }
        let by_held = self.of_parts(|a| a.times(&held))?;
        let [of_held, of_swept] = [reactions.times(&by_held)?, swept.times(&by_held)?];
        let of_free = self.of_parts(|a| reactions.times(a)?.times(&free))?;
        let (from_all, to_all) = (swept.plus(-1.0, &of_swept)?, free.plus(-1.0, &of_free)?);
        let known = held.plus(1.0, &reactions)?.plus(-1.0, &of_held)?;
        self.cycle.as_ref().ok_or(crate::NOT_FACTORIZED)?.set(&known, [&from_all, &to_all])
    }

    /// Factors the matrix. If that takes more memory than predicted, it is repeated with more room.
    fn factors(&mut self, mut kept: Option<Krylov>) -> Reply {
        // The room of the factors beyond the prediction, in per cent.
        for room in [30, 80, 180, 380, 780, 1580, 3180] {
            let made = if let Some(made) = kept.take() {
                made.set_up(self.matrix()).map(|()| made)?
            } else {
                petsc::set(c"-factors_mat_mumps_icntl_14", &CString::new(room.to_string()).unwrap_or_default())?;
                Krylov::new(c"factors_", self.matrix(), None)?
            };
            let ([status, peak, entries], [flops, least, largest]) = made.factor_info()?;
            if !matches!(status, -8 | -9 | -11 | -14 | -15 | -17 | -20) {
                // Large counts are told in millions.
                let entries = if entries < 0 { -1e6 * f64::from(entries) } else { f64::from(entries) };
                let (pivots, peak_bytes) = (least / largest, 1e6 * f64::from(peak));
                // MUMPS does not factor with an instance that has failed.
                self.krylov = Some(made).filter(|_| status >= 0);
                return Ok(vec![status.into(), entries, flops, pivots, peak_bytes]);
            }
        }
        Ok(vec![-9.0, 0.0, 0.0, 0.0, 0.0])
    }

    /// Solves `A x = b` from 0 to a relative residual of `tolerance`. Rank 0 has both vectors. Returns the number of
    /// iterations and the reason for the end, or nothing without a solver.
    pub(crate) fn solve(&self, tolerance: f64, own: Own<'_>) -> Reply {
        let Some(krylov) = &self.krylov else { return Ok(Vec::new()) };
        let Own { x: [b, _], y: [x, _], .. } = own;
        self.exchange.deal(b, &self.exchange.own)?;
        let (iterations, reason) = krylov.solve(&self.exchange.own, tolerance)?;
        self.exchange.collect(&self.exchange.own, x)?;
        Ok(vec![iterations.into(), reason.into()])
    }
}

/// Returns the properties of the present factors or of the matrix: MUMPS's status, which is equal on all ranks and 0
/// without it, the entries, operations, ratio of pivots, and peak memory in bytes.
///
/// # Errors
/// If MUMPS failed.
pub(crate) fn info(reply: &[f64]) -> Result<FactorInfo, LinearError> {
    const STEP: &str = "the factorisation";
    let &[status, entries, flops, pivot_ratio, peak_bytes] = reply else { return Err(crate::NOT_FACTORIZED) };
    match status as Int {
        // Positive statuses are warnings.
        0.. => Ok(FactorInfo { entries: entries as usize, flops, pivot_ratio, peak_bytes }),
        // A pivot is zero.
        -10 => Err(LinearError::Singular { pivot_ratio: 0.0 }),
        // Memory was refused, a caller's limit or the 32-bit range was exceeded, or the prediction was too small
        // despite more memory.
        -7 | -8 | -9 | -11 | -15..=-13 | -17 | -19 | -20 | -51 | -52 => Err(LinearError::OutOfMemory { step: STEP }),
        status => Err(LinearError::Backend { backend: "mumps", step: STEP, status: status.into() }),
    }
}

/// Solves `A x = b` as [`System::solve`] says. Returns the number of iterations, and PETSc's reason for the end, which
/// is negative if the solver did not converge.
pub(crate) fn solve(system: &Remote, tolerance: f64, b: &[f64], x: &mut [f64]) -> Result<(usize, i32), LinearError> {
    let reply = system.run(Job::Solve(tolerance), Own { x: [b, &[]], y: [x, &mut []], ..Own::default() })?;
    let &[iterations, reason] = &reply[..] else { return Err(crate::NOT_FACTORIZED) };
    Ok((iterations as usize, reason as i32))
}
