//! faer's sparse factorisations, in pure Rust.

use faer::Par;
use faer::dyn_stack::{MemBuffer, StackReq};
use faer::perm::PermRef;
use faer::sparse::FaerError;

use super::LinearError;

mod indices;
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
