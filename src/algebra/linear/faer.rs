//! faer's sparse factorisations, in pure Rust.

use crate::algebra::sparse::Pattern;
use faer::Par;
use faer::dyn_stack::{MemBuffer, StackReq};
use faer::perm::PermRef;
use faer::sparse::{FaerError, SparseColMatRef, SymbolicSparseColMatRef};

use super::LinearError;

mod llt;
mod lu;

pub(super) use llt::{Llt, minimum_degree};
pub use lu::FaerLu;

/// The number of operations below which one thread is used: they take a few milliseconds, mostly in fronts too small
/// for several threads.
const PARALLEL_FLOPS: f64 = 3e8;

/// Returns the number of threads for a factorisation with this number of operations.
fn parallelism(flops: f64) -> Par {
    if flops < PARALLEL_FLOPS || rayon::current_num_threads() == 1 { Par::Seq } else { Par::rayon(0) }
}

fn permutation<'a>(forward: &'a [usize], inverse: &'a [usize]) -> PermRef<'a, usize> {
    PermRef::new_checked(forward, inverse, forward.len())
}

fn memory(size: StackReq) -> Result<MemBuffer, FaerError> {
    Ok(MemBuffer::try_new(size)?)
}

/// Converts an error of faer. The only other error is an index beyond 64 bits, which no memory could hold.
fn out_of_memory(_: FaerError, step: &'static str) -> LinearError {
    LinearError::OutOfMemory { step }
}

/// A square pattern with the unsigned indices of faer.
struct Indices {
    starts: Vec<usize>,
    rows: Vec<usize>,
}

impl Indices {
    fn new(pattern: &Pattern) -> Self {
        let unsigned = |indices: &[i64]| indices.iter().map(|&i| i as usize).collect();
        Indices { starts: unsigned(pattern.column_starts()), rows: unsigned(pattern.row_indices()) }
    }

    fn n(&self) -> usize {
        self.starts.len() - 1
    }

    /// Returns the transposed pattern, and for each of its slots the one here.
    fn transposed(&self) -> (Self, Vec<usize>) {
        let n = self.n();
        let mut starts = vec![0; n + 1];
        self.rows.iter().for_each(|&row| starts[row + 1] += 1);
        for row in 0..n {
            starts[row + 1] += starts[row];
        }
        let mut next = starts.clone();
        let (mut rows, mut slots) = (vec![0; self.rows.len()], vec![0; self.rows.len()]);
        for column in 0..n {
            for slot in self.starts[column]..self.starts[column + 1] {
                let to = &mut next[self.rows[slot]];
                (rows[*to], slots[*to]) = (column, slot);
                *to += 1;
            }
        }
        (Indices { starts, rows }, slots)
    }

    fn symbolic(&self) -> SymbolicSparseColMatRef<'_, usize> {
        SymbolicSparseColMatRef::new_checked(self.n(), self.n(), &self.starts, None, &self.rows)
    }

    fn with<'a>(&'a self, values: &'a [f64]) -> SparseColMatRef<'a, usize, f64> {
        SparseColMatRef::new(self.symbolic(), values)
    }
}
