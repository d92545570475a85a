//! A system on all ranks, from the view of rank 0.

use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use stickslip::algebra::linear::LinearError;

use crate::part::Job;
use crate::petsc::Found;
use crate::ranks::Shared;
use crate::system::{Change, Outcome, Setup, System};

/// Parts on all ranks, which several systems may use.
pub(crate) type Parts = Arc<Mutex<Shared>>;

/// Returns the parts for one caller at a time.
pub(crate) fn locked(parts: &Mutex<Shared>) -> MutexGuard<'_, Shared> {
    parts.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A system with parts on all ranks.
pub(crate) struct Handle {
    parts: Parts,
    number: i64,
}

impl Handle {
    /// Creates a system on these parts, or on new ones without a stiffness.
    pub(crate) fn new(parts: Option<&Parts>, setup: Setup<'_>) -> Result<Self, LinearError> {
        static SYSTEMS: AtomicI64 = AtomicI64::new(0);
        let parts = match parts {
            Some(parts) => Arc::clone(parts),
            None => Arc::new(Mutex::new(Shared::new(None)?)),
        };
        let number = SYSTEMS.fetch_add(1, Ordering::Relaxed);
        locked(&parts).run(Job::System, number, |world, part| {
            let system = System::new(world, part.rows.as_ref(), Some(setup))?;
            part.systems.insert(number, system);
            Ok(())
        })?;
        Ok(Handle { parts, number })
    }

    /// Passes new values to all ranks, which prepare to solve.
    pub(crate) fn factorize(&mut self, change: &Change<'_>) -> Result<Outcome, LinearError> {
        locked(&self.parts).run(Job::Factorize, self.number, |_, part| match part.systems.get_mut(&self.number) {
            Some(system) => system.factorize(part.rows.as_ref(), Some(change)),
            None => Err(crate::NOT_ANALYZED),
        })
    }

    /// Solves `A x = b` to a relative residual of `tolerance`, in at most `limit` iterations if that is given.
    pub(crate) fn solve(
        &mut self,
        tolerance: f64,
        limit: Option<usize>,
        b: &[f64],
        x: &mut [f64],
    ) -> Result<Found, LinearError> {
        locked(&self.parts).run(Job::Solve, self.number, |_, part| match part.systems.get_mut(&self.number) {
            Some(system) => system.solve(Some((tolerance, limit)), b, x),
            None => Err(crate::NOT_ANALYZED),
        })
    }
}

impl Drop for Handle {
    fn drop(&mut self) {
        // If the ranks no longer answer, there is nothing to drop.
        let _ = locked(&self.parts).run(Job::Drop, self.number, |_, part| {
            part.systems.remove(&self.number);
            Ok(())
        });
    }
}

impl Outcome {
    /// Returns an error unless MUMPS succeeded.
    pub(crate) fn checked(self) -> Result<Self, LinearError> {
        /// The status of a zero pivot.
        const SINGULAR: i32 = -10;
        const STEP: &str = "the factorisation";
        match self.status {
            // Positive statuses are warnings.
            0.. => Ok(self),
            SINGULAR => Err(LinearError::Singular { pivot_ratio: 0.0 }),
            // Memory was refused, a caller's limit or the 32-bit range was exceeded, or the prediction was too small
            // despite more memory.
            -7 | -8 | -9 | -11 | -15..=-13 | -17 | -19 | -20 | -51 | -52 => {
                Err(LinearError::OutOfMemory { step: STEP })
            }
            status => Err(LinearError::Backend { backend: "mumps", step: STEP, status: status.into() }),
        }
    }
}
