//! Estimates of a history's cost from sizes alone: whole system (factored or by multigrid) and condensed system.
//!
//! Let `n` be the number of displacements, `m` of them in contact, `|L|` the entries of the Cholesky factor of `K`
//! and `φ` its operations:
//!
//! | | whole system, sparse LU | condensed | multigrid |
//! | --- | --- | --- | --- |
//! | once | order the unknowns | order, factor `K` (`|L|`, `φ`), form `S` (`2/3 m³`), store it (`m²`) | – |
//! | a Newton matrix | `2 |L|` entries, `2 φ` operations | `2/3 k³` operations, some passes over `m²` entries | `n` |
//! | an increment | – | substitutions with `L`, some passes over `m²` entries | – |
//! | memory | `2 |L|` | `2 |L|`, `m²` | `n` |
//!
//! The whole system with its interior factored once (`partial`) costs what the condensed one does, and two substitutions with `L` for each
//! Newton matrix.
//!
//! `k` is the number of displacements that contact leaves unconstrained; half of `m` if nothing better is known.
//! Contact rows add a few per cent to the sparse factors and are neglected, as are mesh, assembly and error measure,
//! which all variants share.

use super::{FactorInfo, SparseLu};

/// The time in seconds for each unit of work, from runs of the paper's block (n = 25 … 200), of strips (1000 × 4 …
/// 2000 × 50) and of plates (16 × 16 × 4 … 32 × 32 × 2) on one core with AVX-512: CPU time of whole runs and of their
/// parts, sizes from the factorisations. On other machines all times change together, and the choice depends on their
/// ratios.
mod seconds {
    /// The time for an operation in a dense kernel.
    pub const OPERATION: f64 = 1.0 / 30e9;
    /// The time for ordering an unknown of the sparse system by nested dissection.
    pub const ORDER: f64 = 10e-6;
    /// The time for an entry of `L` and `U`. Fronts are small: moving their entries takes longer than the operations.
    pub const LU_ENTRY: f64 = 26e-9;
    /// The time for an entry of `L` and `U` with faer.
    pub const FAER_LU_ENTRY: f64 = 34e-9;
    /// The time of MUMPS relative to UMFPACK: 0.90 and 0.75 on cubes of 16³ and 24³ elements, 0.80 on the block with
    /// n = 200.
    pub const MUMPS_SHARE: f64 = 0.8;
    /// The time for starting and ending MPI.
    pub const MPI: f64 = 0.15;
    /// The time for a displacement in a Newton system that is solved by multigrid, including its share of the
    /// hierarchies: 20e-6 to 27e-6 on cubes of 16³ to 48³ elements, in 2 and 10 increments.
    pub const MULTIGRID: f64 = 25e-6;
    /// The time for an entry of `L` and `U` in a refined solve.
    pub const LU_SOLVE_ENTRY: f64 = 4e-9;
    /// The time for an entry of `L` of `K`, including ordering by minimum degree.
    pub const L_ENTRY: f64 = 35e-9;
    /// The time for an entry of `L` in the substitutions of an increment.
    pub const L_SOLVE_ENTRY: f64 = 4e-9;
    /// The time for extracting an entry of `S` from the factors and forming it.
    pub const S_ENTRY: f64 = 75e-9;
    /// The time for an entry of `S` in each factorisation: gathered, and multiplied in the solve.
    pub const S_FACTOR_ENTRY: f64 = 8e-9;
    /// The time for an entry of `S` in an increment: residuals, and iterations that reuse their factors. Runs of
    /// strips of 1000 × 4 to 2000 × 50 elements with 2 and with 40 increments separate it from the time above.
    pub const S_INCREMENT_ENTRY: f64 = 9e-9;
}

/// The largest memory of an entry of `S`, bytes: `S`, the block of `L` that it comes from, a square of the same size
/// while `S` is formed, and later the factors of the unconstrained part (measured: 43 at m = 4000).
const S_BYTES: f64 = 44.0;
/// The largest memory of an entry of a sparse factor during the factorisation, bytes.
const LU_BYTES: f64 = 16.0;
/// The memory of an entry of `L` once it is factored, bytes.
const L_BYTES: f64 = 8.0;
/// The largest memory of such an entry with MUMPS, bytes.
const MUMPS_BYTES: f64 = 12.0;

/// The memory of multigrid for a displacement, bytes: the Newton matrix, the matrix with contact eliminated and its
/// hierarchy, twice, and the vectors of GMRES (measured, including everything else in a run: 9700 on a cube of 24³
/// elements).
const MULTIGRID_BYTES: f64 = 8200.0;

/// The share of the contact displacements that contact leaves unconstrained in a Newton matrix of BN.
const FREE_SHARE: f64 = 0.5;

/// The sizes of the systems.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sizes {
    /// The number of unknowns of the whole system.
    pub unknowns: usize,
    /// The number of contact displacements in the condensed system, `m`.
    pub contact_displacements: usize,
    /// The Cholesky factor of `K`, see [`super::Cholesky::predict`].
    pub stiffness: FactorInfo,
}

/// The amount of work.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Work {
    /// The number of increments.
    pub increments: f64,
    /// The number of factorisations in all increments.
    pub factorizations: f64,
    /// `true` if all contact displacements are unconstrained, as in an interior point method.
    pub all_free: bool,
}

/// An estimate of time and memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// The time for linear algebra in the whole history, including set-up, s.
    pub seconds: f64,
    /// The peak memory, bytes.
    pub bytes: f64,
}

/// The share of the factors that ranks store twice: four ranks take 1.24 times the memory of one.
const KEPT_TWICE: f64 = 0.3;

impl Cost {
    /// Returns the cost for each of `ranks` ranks that share the work, at best.
    #[must_use]
    pub fn shared_by(self, ranks: usize) -> Self {
        let ranks = ranks as f64;
        let twice = 1.0 + KEPT_TWICE * (1.0 - 1.0 / ranks);
        Cost { seconds: self.seconds / ranks, bytes: self.bytes * twice / ranks }
    }
}

/// Returns the time for ordering this number of unknowns, s: about the time of an estimate.
pub fn order(unknowns: usize) -> f64 {
    unknowns as f64 * seconds::ORDER
}

/// Returns the minimum time of the body in a condensed history, s: ordering `unknowns`, and in each increment a
/// substitution with a factor of `K` that has at least the `entries` of its lower triangle.
pub fn body(unknowns: usize, entries: usize, increments: usize) -> f64 {
    order(unknowns) + (increments * entries) as f64 * seconds::L_SOLVE_ENTRY
}

/// Returns the time for `m` contact displacements in a condensed history, s: `S`, its factorisations, and an
/// increment's passes over it.
pub fn border(m: usize, work: &Work) -> f64 {
    let entries = (m * m) as f64;
    let once = entries * seconds::S_ENTRY + 2.0 / 3.0 * (m as f64).powi(3) * seconds::OPERATION;
    let iteration = factorization(m, work) * seconds::OPERATION + entries * seconds::S_FACTOR_ENTRY;
    once + work.factorizations * iteration + work.increments * entries * seconds::S_INCREMENT_ENTRY
}

/// Returns the operations for factoring the unconstrained part of `m` displacements.
fn factorization(m: usize, work: &Work) -> f64 {
    let free = if work.all_free { m as f64 } else { FREE_SHARE * m as f64 };
    2.0 / 3.0 * free.powi(3)
}

/// Estimates the whole system, factored by `lu`.
pub fn sparse(sizes: &Sizes, work: &Work, lu: SparseLu) -> Cost {
    let (entries, flops) = (2.0 * sizes.stiffness.entries as f64, 2.0 * sizes.stiffness.flops);
    let factor = if lu == SparseLu::Faer { seconds::FAER_LU_ENTRY } else { seconds::LU_ENTRY };
    let iteration = entries * (factor + seconds::LU_SOLVE_ENTRY) + flops * seconds::OPERATION;
    let all = order(sizes.unknowns) + work.factorizations * iteration;
    match lu {
        SparseLu::Mumps => Cost { seconds: seconds::MPI + seconds::MUMPS_SHARE * all, bytes: MUMPS_BYTES * entries },
        SparseLu::Partial => partial(sizes, work),
        SparseLu::Umfpack | SparseLu::Faer => Cost { seconds: all, bytes: LU_BYTES * entries },
    }
}

/// Estimates the whole system by multigrid, with a solve for each Newton matrix and for each increment that keeps its
/// own.
pub fn multigrid(displacements: usize, work: &Work) -> Cost {
    let n = displacements as f64;
    let systems = work.factorizations.max(work.increments);
    Cost { seconds: seconds::MPI + systems * n * seconds::MULTIGRID, bytes: n * MULTIGRID_BYTES }
}

/// Estimates the condensed system.
pub fn condensed(sizes: &Sizes, work: &Work) -> Cost {
    factored_once(sizes, work, work.increments)
}

/// Estimates the whole system with its interior factored once: an iteration has both substitutions with `L`, and a residual.
fn partial(sizes: &Sizes, work: &Work) -> Cost {
    factored_once(sizes, work, work.increments + 2.0 * work.factorizations)
}

/// Returns the cost with `K` factored once and this number of substitutions with `L`.
fn factored_once(sizes: &Sizes, work: &Work, substitutions: f64) -> Cost {
    let (m, entries) = (sizes.contact_displacements, sizes.stiffness.entries as f64);
    let once = entries * seconds::L_ENTRY + sizes.stiffness.flops * seconds::OPERATION;
    let interior = substitutions * entries * seconds::L_SOLVE_ENTRY;
    let bytes = (LU_BYTES * entries).max(L_BYTES * entries + S_BYTES * (m * m) as f64);
    Cost { seconds: once + interior + border(m, work), bytes }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sizes(unknowns: usize, m: usize, entries: usize, flops: f64) -> Sizes {
        Sizes { unknowns, contact_displacements: m, stiffness: FactorInfo { entries, flops, ..FactorInfo::default() } }
    }

    #[test]
    fn a_square_condenses_and_a_strip_does_not() {
        // 100 × 100 and 1000 × 4 elements.
        let (square, strip) = (sizes(20_400, 200, 1_300_000, 1.5e8), sizes(12_000, 2000, 190_000, 4e6));
        for increments in [2.0, 40.0] {
            let work = Work { increments, factorizations: 3.0 * increments, all_free: false };
            assert!(condensed(&square, &work).seconds < 0.5 * sparse(&square, &work, SparseLu::Umfpack).seconds);
            assert!(sparse(&strip, &work, SparseLu::Umfpack).seconds < 0.5 * condensed(&strip, &work).seconds);
        }
    }

    #[test]
    fn costs_grow_with_the_work() {
        let sizes = sizes(20_400, 200, 1_300_000, 1.5e8);
        let work = Work { increments: 10.0, factorizations: 30.0, all_free: false };
        let twice = Work { increments: 20.0, factorizations: 60.0, all_free: false };
        let whole = |work: &Work| sparse(&sizes, work, SparseLu::Umfpack).seconds;
        assert!(whole(&twice) > whole(&work));
        assert!(condensed(&sizes, &twice).seconds > condensed(&sizes, &work).seconds);
        assert!(multigrid(20_400, &twice).seconds > multigrid(20_400, &work).seconds);
        // All of S is factored, with eight times the operations.
        assert_eq!(factorization(200, &Work { all_free: true, ..work }), 8.0 * factorization(200, &work));
        assert!(sparse(&sizes, &work, SparseLu::Faer).seconds > whole(&work));
        assert!(sparse(&sizes, &work, SparseLu::Mumps).seconds < whole(&work));
    }
}
