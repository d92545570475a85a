//! What a rank of MPI other than 0 is there for: its part of all that rank 0 shares.

use super::LinearError;
use super::ranks::{self, Kind, RankLocal, World};
use crate::algebra::sparse::NodeRows;

/// What makes the rows of a rank in the stiffness that all share, when it is asked for them; `None` if it cannot.
pub type RankRows<'a> = &'a mut dyn FnMut() -> Option<Box<dyn NodeRows>>;

/// Helps rank 0 from the start of this rank on, and comes back when that ends MPI. The `body` has to be that of rank 0; without one
/// rank 0 assembles alone.
///
/// # Errors
/// As [`ranks::start`], and where this rank cannot do its part: the process has to end then, without a word to MPI, whose launcher ends the
/// others. On rank 0 it returns at once.
#[cfg_attr(not(feature = "petsc"), allow(unused_variables))]
pub fn help(body: RankRows<'_>) -> Result<(), LinearError> {
    ranks::serve(&mut |kind: Kind, world: &World| -> Result<Box<dyn RankLocal>, LinearError> {
        Ok(match kind {
            #[cfg(feature = "mumps")]
            Kind::Mumps => Box::new(super::mumps::Instance::new(world)),
            #[cfg(feature = "petsc")]
            Kind::Amg => Box::new(super::petsc::Share::dealt(world)?),
            #[cfg(feature = "petsc")]
            Kind::Stiffness => Box::new(super::multigrid::Piece::helping(world, body().as_deref())),
        })
    })
}
