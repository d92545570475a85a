//! The collective operations that rank 0 tells to all, and the objects on all ranks that they are about.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicI64, Ordering};

use serde::{Deserialize, Serialize};
use stickslip::algebra::NodeRows;
use stickslip::algebra::linear::LinearError;
use stickslip::algebra::linear::process::prepare_blas;
use stickslip::run::report::{cpu_seconds, peak_rss_bytes};

use crate::petsc::{Entries, Int};
use crate::ranks::run;
use crate::ranks::shim::World;
use crate::rows::{Numbering, Rows};
use crate::system::{By, Contact, Setup, System};

/// A collective operation on an object.
#[derive(Serialize, Deserialize)]
pub(crate) enum Job {
    /// The end of all ranks.
    End,
    /// CPU time and memory of each rank, and 1 if it has the memory for the buffers of the BLAS.
    Use,
    /// A stiffness of the body of this rank, with this many rows for contact forces.
    Rows(usize),
    /// A product of the stiffness with a vector.
    Product,
    /// Sums of the terms of such a product: in twice the working precision if `true`, else with the sums of the sizes.
    Sums(bool),
    /// A system.
    System(Setup),
    /// Values with a factor of the stiffness, or the present ones, and the way to solve.
    Factorize(Option<f64>, By),
    /// A solve to a tolerance.
    Solve(f64),
    Drop,
}

/// The data of an operation that rank 0 alone has; a body is on all ranks.
#[derive(Default)]
pub(crate) struct Own<'a> {
    pub body: Option<&'a dyn NodeRows>,
    /// The row of each unknown of a system, and the displacements of the rigid motions, followed by zeros.
    pub places: Vec<Int>,
    pub motions: Vec<Vec<f64>>,
    /// The shares of displacements that others contain: the matrix and its transpose.
    pub shares: [Entries; 2],
    /// All entries outside a shared stiffness.
    pub rest: Entries,
    pub contact: Option<&'a Contact>,
    /// The place of the numbers of the nodes of a stiffness, and of the number of its entries.
    pub numbering: Option<&'a mut Option<(Numbering, usize)>>,
    /// Vectors, and the results.
    pub x: [&'a [f64]; 2],
    pub y: [&'a mut [f64]; 2],
}

/// The results of an operation that are no vectors.
pub(crate) type Reply = Result<Vec<f64>, LinearError>;

/// The objects of one rank.
#[derive(Default)]
pub(crate) struct Objects {
    rows: BTreeMap<i64, Rows>,
    systems: BTreeMap<i64, System>,
}

impl Objects {
    /// Does the work of this rank in the `job` on the object of this number. Returns the results that are no vectors.
    ///
    /// # Errors
    /// If this rank cannot continue; the others then wait in vain, so that it has to end all of them.
    pub(crate) fn perform(&mut self, world: &World, (number, job): (i64, Job), own: Own<'_>) -> Reply {
        let rows = self.rows.get(&number).ok_or(crate::NOT_ANALYZED);
        let system = self.systems.get_mut(&number).ok_or(crate::NOT_ANALYZED);
        match job {
            Job::End => {}
            Job::Use => {
                let room = f64::from(prepare_blas().is_ok());
                return Ok(world.of_each([cpu_seconds(), peak_rss_bytes().unwrap_or(0) as f64, room]));
            }
            Job::Rows(forces) => self.rows.extend(Rows::assembled(world, forces, own)?.map(|rows| (number, rows))),
            Job::Product => rows?.product(own)?,
            Job::Sums(beyond) => rows?.sums(beyond, own)?,
            Job::System(setup) => {
                let rows = setup.stiffness.and_then(|number| self.rows.get(&number));
                self.systems.insert(number, System::new(world.rank, setup, rows, own)?);
            }
            Job::Factorize(factor, by) => return system?.factorize(factor, by, &own),
            Job::Solve(tolerance) => return system?.solve(tolerance, own),
            Job::Drop => drop((self.rows.remove(&number), self.systems.remove(&number))),
        }
        Ok(Vec::new())
    }
}

/// An object on all ranks, from the view of rank 0.
#[derive(Debug)]
pub(crate) struct Remote(pub i64);

impl Remote {
    /// Creates the object of this `job`.
    ///
    /// # Errors
    /// As [`run`], and if memory is short.
    pub(crate) fn new(job: Job, own: Own<'_>) -> Result<Self, LinearError> {
        static OBJECTS: AtomicI64 = AtomicI64::new(0);
        if run((0, Job::Use), Own::default())?.chunks(3).any(|of_rank| of_rank[2] == 0.0) {
            return Err(LinearError::OutOfMemory { step: "the BLAS of a rank, which takes 128 MiB for itself" });
        }
        let made = Remote(OBJECTS.fetch_add(1, Ordering::Relaxed));
        made.run(job, own)?;
        Ok(made)
    }

    /// Runs a `job` on the object.
    ///
    /// # Errors
    /// As [`run`].
    pub(crate) fn run(&self, job: Job, own: Own<'_>) -> Reply {
        run((self.0, job), own)
    }
}

impl Drop for Remote {
    fn drop(&mut self) {
        // If the ranks no longer answer, there is nothing to drop.
        let _ = self.run(Job::Drop, Own::default());
    }
}
