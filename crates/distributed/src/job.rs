//! The collective operations that rank 0 tells to all, and the objects on all ranks that they are about.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicI64, Ordering};

use serde::{Deserialize, Serialize};
use stickslip::algebra::NodeRows;
use stickslip::algebra::linear::LinearError;
use stickslip::algebra::linear::process::prepare_blas;
use stickslip::run::report::{cpu_seconds, peak_rss_bytes};

use crate::petsc;
use crate::ranks::run;
use crate::ranks::shim::World;
use crate::rows::Rows;
use crate::system::{Change, Places, Setup, System, Values};

/// A collective operation on an object.
#[derive(Serialize, Deserialize)]
pub(crate) enum Job {
    /// The end of all ranks.
    End,
    /// CPU time and memory of each rank.
    Use,
    /// The memory for the buffers of the BLAS.
    Room,
    /// A stiffness of the body of this rank.
    Rows,
    Norms,
    Product(Product),
    Lower,
    /// A system.
    System(Setup),
    Factorize(Change),
    Solve {
        tolerance: f64,
        limit: Option<usize>,
    },
    Drop,
}

/// A product of the stiffness with a vector.
#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Product {
    Plain,
    /// The product of the sizes besides.
    Sizes,
    /// The product of a sum of two vectors, in twice the working precision.
    Beyond,
}

/// The data of an operation that rank 0 alone has; a body is on all ranks.
#[derive(Default)]
pub(crate) struct Own<'a> {
    pub body: Option<&'a dyn NodeRows>,
    pub places: Places<'a>,
    pub values: Values<'a>,
    /// Vectors, and the results.
    pub x: [&'a [f64]; 2],
    pub y: [&'a mut [f64]; 2],
}

/// The objects of one rank.
#[derive(Default)]
pub(crate) struct Objects {
    pub rows: BTreeMap<i64, Rows>,
    systems: BTreeMap<i64, System>,
}

impl Objects {
    /// Does the work of this rank in the `job` on the object of this number. Returns the results that are no vectors.
    ///
    /// # Errors
    /// If this rank cannot continue; the others then wait in vain, so that it has to end all of them.
    pub(crate) fn perform(
        &mut self,
        world: &World,
        number: i64,
        job: Job,
        own: Own<'_>,
    ) -> Result<Vec<f64>, LinearError> {
        let rows = self.rows.get(&number).ok_or(crate::NOT_ANALYZED);
        match job {
            Job::End => {}
            Job::Use => return Ok(world.of_each([cpu_seconds(), peak_rss_bytes().unwrap_or(0) as f64])),
            Job::Room => return Ok(world.of_each([f64::from(prepare_blas().is_ok())])),
            Job::Rows => {
                petsc::start("")?;
                self.rows.extend(Rows::assembled(world, own.body)?.map(|rows| (number, rows)));
            }
            Job::Norms => return Ok(vec![rows?.norms(own.y)?]),
            Job::Product(product) => rows?.product(product, own.x, own.y)?,
            Job::Lower => return rows?.lower(world),
            Job::System(setup) => {
                petsc::start("")?;
                let shared = setup.stiffness.and_then(|number| self.rows.get(&number));
                let shared = shared.map(|rows| rows.matrix.clone());
                self.systems.insert(number, System::new(world.rank(), setup, shared, own.places)?);
            }
            Job::Factorize(change) => {
                let system = self.systems.get_mut(&number).ok_or(crate::NOT_ANALYZED)?;
                return system.factorize(&change, own.values);
            }
            Job::Solve { tolerance, limit } => {
                let system = self.systems.get(&number).ok_or(crate::NOT_ANALYZED)?;
                let ([b, _], [x, _]) = (own.x, own.y);
                return system.solve(tolerance, limit, b, x);
            }
            Job::Drop => {
                self.rows.remove(&number);
                self.systems.remove(&number);
            }
        }
        Ok(Vec::new())
    }
}

/// An object on all ranks, from the view of rank 0.
pub(crate) struct Remote(pub i64);

impl Remote {
    /// Creates the object of this `job`.
    ///
    /// # Errors
    /// As [`run`], and if memory is short.
    pub(crate) fn new(job: Job, own: Own<'_>) -> Result<Self, LinearError> {
        static OBJECTS: AtomicI64 = AtomicI64::new(0);
        if run(0, Job::Room, Own::default())?.contains(&0.0) {
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
    pub(crate) fn run(&self, job: Job, own: Own<'_>) -> Result<Vec<f64>, LinearError> {
        run(self.0, job, own)
    }
}

impl Drop for Remote {
    fn drop(&mut self) {
        // If the ranks no longer answer, there is nothing to drop.
        let _ = self.run(Job::Drop, Own::default());
    }
}
