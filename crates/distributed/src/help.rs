//! The worker loop for MPI ranks other than 0.

use super::ranks::{self, Kind, RankLocal, World};
use stickslip::algebra::NodeRows;
use stickslip::algebra::linear::LinearError;

/// A function that assembles a rank's rows of the shared stiffness, or returns `None` if it cannot.
pub type RankRows<'a> = &'a mut dyn FnMut() -> Option<Box<dyn NodeRows>>;

/// Runs the worker loop of this rank until rank 0 ends MPI. The `body` must be that of rank 0; without one rank 0
/// assembles alone.
///
/// # Errors
/// As [`ranks::start`], and if this rank cannot do its work: the process then has to end without a call to MPI, whose
/// launcher ends the others. On rank 0 the function returns at once.
pub fn help(body: RankRows<'_>) -> Result<(), LinearError> {
    ranks::serve(&mut |kind: Kind, world: &World| -> Result<Box<dyn RankLocal>, LinearError> {
        Ok(match kind {
            Kind::Mumps => Box::new(super::mumps::Instance::new(world)),
            Kind::Amg => Box::new(super::petsc::Share::dealt(world)?),
            Kind::Stiffness => Box::new(super::multigrid::Piece::helping(world, body().as_deref())),
        })
    })
}
