//! What a history costs on the whole system, factored or by multigrid, and on a condensed one, estimated from sizes alone.
//!
//! With `n` displacements, `m` of them in contact, `|L|` entries in the Cholesky factor of `K` and `φ` operations to make it:
//!
//! | | whole system, sparse LU | condensed | multigrid |
//! | --- | --- | --- | --- |
//! | once | order the unknowns | order, factor `K` (`|L|`, `φ`), form `S` (`2/3 m³`), store it (`m²`) | – |
//! | a Newton matrix | `2 |L|` entries, `2 φ` operations | `2/3 k³` operations, some passes over `m²` entries | `n` |
//! | an increment | – | substitutions with `L`, some passes over `m²` entries | – |
//! | memory | `2 |L|` | `2 |L|`, `m²` | `n` |
//!
//! `k` is the number of displacements that contact leaves free, half of `m` where nothing better is known.
//! Contact rows add a few per cent to the sparse factors and are left out. So is what all ways share: mesh,
//! assembly, error measure.

use super::{FactorInfo, SparseLu};

/// Seconds for each unit of work, from runs of the paper's block (n = 25 … 200), of strips (1000 × 4 …
/// 2000 × 50) and of plates (16 × 16 × 4 … 32 × 32 × 2) on one core with AVX-512: CPU time of whole runs and of their parts, sizes from the
/// factorisations. Elsewhere all of them change together, and the choice hangs on their ratios.
mod seconds {
    /// An operation in a dense kernel.
    pub const OPERATION: f64 = 1.0 / 30e9;
    /// An unknown of the sparse system: nested dissection.
    pub const ORDER: f64 = 10e-6;
    /// An entry of `L` and `U`. Fronts are small: moving their entries takes longer than the operations.
    pub const LU_ENTRY: f64 = 26e-9;
    /// The same with faer.
    pub const FAER_LU_ENTRY: f64 = 34e-9;
    /// What MUMPS takes of the time of UMFPACK: 0.90 and 0.75 on cubes of 16³ and 24³ elements, 0.80 on the block with n = 200.
    pub const MUMPS_SHARE: f64 = 0.8;
    /// What MPI takes to start and to end.
    pub const MPI: f64 = 0.15;
    /// A displacement in a Newton system that is solved by multigrid, its share of the hierarchies included: 20e-6 to 27e-6 on cubes of 16³
    /// to 48³ elements, in 2 and 10 increments.
    pub const MULTIGRID: f64 = 25e-6;
    /// An entry of `L` and `U` in a refined solve.
    pub const LU_SOLVE_ENTRY: f64 = 4e-9;
    /// An entry of `L` of `K`, ordering by minimum degree included.
    pub const L_ENTRY: f64 = 35e-9;
    /// An entry of `L` in the substitutions of an increment.
    pub const L_SOLVE_ENTRY: f64 = 4e-9;
    /// An entry of `S`: taken from the factors and formed.
    pub const S_ENTRY: f64 = 75e-9;
    /// An entry of `S` with each factorisation: gathered, multiplied in the solve.
    pub const S_FACTOR_ENTRY: f64 = 8e-9;
    /// An entry of `S` in an increment: residuals, and the iterations that keep their factors. Runs of strips of 1000 × 4 to
    /// 2000 × 50 elements with 2 and with 40 increments tell it from the former.
    pub const S_INCREMENT_ENTRY: f64 = 9e-9;
}

/// Bytes an entry of `S` takes at most: `S`, the block of `L` that it comes from, the same as a square while `S` is made, and later the
/// factors of what is free (measured: 43 at m = 4000).
const S_BYTES: f64 = 44.0;
/// Bytes an entry of a sparse factor takes at most, while it is made.
const LU_BYTES: f64 = 16.0;
/// The same of MUMPS.
const MUMPS_BYTES: f64 = 12.0;

/// What multigrid takes for a displacement: the matrix with contact eliminated and its hierarchy, twice, and the vectors of GMRES (measured, with
/// all that a run has beside: 5700 to 5900 on cubes of 24³ to 48³ elements).
const MULTIGRID_BYTES: f64 = 4400.0;

/// The part of the contact displacements that contact leaves free in a Newton matrix of BN.
const FREE_SHARE: f64 = 0.5;

/// What there is to solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sizes {
    /// Unknowns of the whole system.
    pub unknowns: usize,
    /// Contact displacements that the condensed system has, `m`.
    pub contact_displacements: usize,
    /// The Cholesky factor of `K`, see [`super::Cholesky::predict`].
    pub stiffness: FactorInfo,
}

/// How often.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Work {
    /// Increments.
    pub increments: f64,
    /// Factorisations in all of them.
    pub factorizations: f64,
    /// Whether all contact displacements stay free, as in an interior point method.
    pub all_free: bool,
}

/// An estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// The linear algebra of the whole history, set-up included, s.
    pub seconds: f64,
    /// Peak memory, bytes.
    pub bytes: f64,
}

/// What ranks keep twice of factors: four of them take 1.24 times the memory of one.
const KEPT_TWICE: f64 = 0.3;

impl Cost {
    /// That of each of so many ranks that share it, at best.
    #[must_use]
    pub fn shared_by(self, ranks: usize) -> Self {
        let ranks = ranks as f64;
        let twice = 1.0 + KEPT_TWICE * (1.0 - 1.0 / ranks);
        Cost { seconds: self.seconds / ranks, bytes: self.bytes * twice / ranks }
    }
}

/// Ordering so many unknowns, s: about what an estimate takes itself.
pub fn order(unknowns: usize) -> f64 {
    unknowns as f64 * seconds::ORDER
}

/// The least work with the body in a condensed history: ordering `unknowns`, and in each increment a substitution with a factor of
/// `K` that has at least the `entries` of its lower triangle, s.
pub fn body(unknowns: usize, entries: usize, increments: usize) -> f64 {
    order(unknowns) + (increments * entries) as f64 * seconds::L_SOLVE_ENTRY
}

/// What `m` contact displacements cost in a condensed history: `S`, its factorisations, an increment's passes over it, s.
pub fn border(m: usize, work: &Work) -> f64 {
    let entries = (m * m) as f64;
    let once = entries * seconds::S_ENTRY + 2.0 / 3.0 * (m as f64).powi(3) * seconds::OPERATION;
    let iteration = factorization(m, work) * seconds::OPERATION + entries * seconds::S_FACTOR_ENTRY;
    once + work.factorizations * iteration + work.increments * entries * seconds::S_INCREMENT_ENTRY
}

/// Operations to factor what contact leaves free of `m` displacements.
fn factorization(m: usize, work: &Work) -> f64 {
    let free = if work.all_free { m as f64 } else { FREE_SHARE * m as f64 };
    2.0 / 3.0 * free.powi(3)
}

/// The whole system, factored by `lu`.
pub fn sparse(sizes: &Sizes, work: &Work, lu: SparseLu) -> Cost {
    let (entries, flops) = (2.0 * sizes.stiffness.entries as f64, 2.0 * sizes.stiffness.flops);
    let factor = if lu == SparseLu::Faer { seconds::FAER_LU_ENTRY } else { seconds::LU_ENTRY };
    let iteration = entries * (factor + seconds::LU_SOLVE_ENTRY) + flops * seconds::OPERATION;
    let all = order(sizes.unknowns) + work.factorizations * iteration;
    match lu {
        SparseLu::Mumps => Cost { seconds: seconds::MPI + seconds::MUMPS_SHARE * all, bytes: MUMPS_BYTES * entries },
        SparseLu::Umfpack | SparseLu::Faer => Cost { seconds: all, bytes: LU_BYTES * entries },
    }
}

/// The whole system by multigrid, a solve for each Newton matrix and for each increment that keeps its own.
pub fn multigrid(displacements: usize, work: &Work) -> Cost {
    let n = displacements as f64;
    let systems = work.factorizations.max(work.increments);
    Cost { seconds: seconds::MPI + systems * n * seconds::MULTIGRID, bytes: n * MULTIGRID_BYTES }
}

/// The condensed system.
pub fn condensed(sizes: &Sizes, work: &Work) -> Cost {
    let (m, entries) = (sizes.contact_displacements, sizes.stiffness.entries as f64);
    let once = entries * seconds::L_ENTRY + sizes.stiffness.flops * seconds::OPERATION;
    let increments = work.increments * entries * seconds::L_SOLVE_ENTRY;
    Cost { seconds: once + increments + border(m, work), bytes: LU_BYTES * entries + S_BYTES * (m * m) as f64 }
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
        // The whole of S is factored, eight times the operations.
        assert_eq!(factorization(200, &Work { all_free: true, ..work }), 8.0 * factorization(200, &work));
        assert!(sparse(&sizes, &work, SparseLu::Faer).seconds > whole(&work));
        assert!(sparse(&sizes, &work, SparseLu::Mumps).seconds < whole(&work));
    }
}
