//! The part of a shared object on one rank: rows of a stiffness, and systems on it. Every method is collective; rank 0 has
//! whole vectors and receives whole results, those of the others are empty.

use std::collections::HashMap;

use stickslip::algebra::NodeRows;
use stickslip::algebra::linear::LinearError;

use crate::petsc;
use crate::ranks::shim::World;
use crate::rows::Rows;
use crate::system::System;

/// A collective operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Job {
    Norms,
    Product,
    Products,
    Beyond,
    Lower,
    /// A request about a system: to make it, to take over values, to solve, to drop it.
    System,
    Factorize,
    Solve,
    Drop,
}

impl Job {
    /// Returns the operation of a number, by which rank 0 calls it.
    pub(crate) fn of(number: i64) -> Option<Self> {
        use Job::{Beyond, Drop, Factorize, Lower, Norms, Product, Products, Solve, System};
        let all = [Norms, Product, Products, Beyond, Lower, System, Factorize, Solve, Drop];
        all.into_iter().find(|job| *job as i64 == number)
    }
}

/// The part of one rank.
#[derive(Default)]
pub(crate) struct Part {
    /// The rows of the stiffness, if it is shared.
    pub rows: Option<Rows>,
    pub systems: HashMap<i64, System>,
}

impl Part {
    /// Creates the part of rank 0, with rows of `body` if there is one.
    pub(crate) fn leading(world: &World, body: Option<&dyn NodeRows>) -> Result<Self, LinearError> {
        petsc::start("")?;
        let rows = body.map(|body| Rows::assembled(world, Some(body))).transpose()?.flatten();
        Ok(Part { rows, ..Part::default() })
    }

    /// Creates the part of another rank, with rows if they are `wanted`.
    pub(crate) fn helping(world: &World, body: Option<&dyn NodeRows>, wanted: bool) -> Result<Self, LinearError> {
        petsc::start("")?;
        let rows = if wanted { Rows::assembled(world, body)? } else { None };
        Ok(Part { rows, ..Part::default() })
    }

    /// Does the work of another rank than 0 in a `job`, of the system of this number if it is of one.
    ///
    /// # Errors
    /// If this rank cannot continue; the others then wait in vain, so that it has to end all of them.
    pub(crate) fn serve(&mut self, world: &World, job: Job, of: i64) -> Result<(), LinearError> {
        let Part { rows, systems } = self;
        let nothing: [&mut [f64]; 2] = [&mut [], &mut []];
        match (job, rows, systems.get_mut(&of)) {
            (Job::Norms, Some(rows), _) => rows.norms(world, nothing).map(drop),
            (Job::Product | Job::Products | Job::Beyond, Some(rows), _) => rows.products(job, [&[], &[]], nothing),
            (Job::Lower, Some(rows), _) => rows.lower(world).map(drop),
            (Job::Factorize, rows, Some(system)) => system.factorize(rows.as_ref(), None).map(drop),
            (Job::Solve, _, Some(system)) => system.solve(None, &[], &mut []).map(drop),
            (Job::System, rows, _) => {
                systems.insert(of, System::new(world, rows.as_ref(), None)?);
                Ok(())
            }
            (Job::Drop, ..) => {
                systems.remove(&of);
                Ok(())
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jobs_have_numbers() {
        for number in 0..9 {
            assert_eq!(Job::of(number).map(|job| job as i64), Some(number));
        }
        assert_eq!(Job::of(9), None);
    }
}
