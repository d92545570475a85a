//! faer's sparse factorisations, in pure Rust and on one thread.

use faer::dyn_stack::{MemBuffer, StackReq};
use faer::perm::PermRef;
use faer::sparse::FaerError;

use super::LinearError;

mod indices;
mod llt;
mod lu;

pub(super) use llt::{Llt, minimum_degree};
pub use lu::FaerLu;

fn permutation<'a>(forward: &'a [usize], inverse: &'a [usize]) -> PermRef<'a, usize> {
    PermRef::new_checked(forward, inverse, forward.len())
}

fn memory(size: StackReq) -> Result<MemBuffer, FaerError> {
    Ok(MemBuffer::try_new(size)?)
}

/// The only other error is an index beyond 64 bits, which no memory could hold.
fn out_of_memory(_: FaerError, step: &'static str) -> LinearError {
    LinearError::OutOfMemory { step }
}
