//! An instance of MUMPS on one rank. Its jobs are collective: every rank must call the same one.

#![allow(unsafe_code)]

use std::ffi::{CStr, c_int};
use std::mem;
use std::ptr;

use super::sys;
use crate::ranks::{RankLocal, World};
use stickslip::algebra::linear::LinearError;

/// A job of MUMPS.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Job {
    Analyze = 1,
    Factorize = 2,
    Solve = 3,
}

const BEGIN: c_int = -1;
const END: c_int = -2;

/// Unsymmetric; rank 0 also works.
const UNSYMMETRIC: c_int = 0;
const HOST_WORKS: c_int = 1;

/// The structure of MUMPS. The owner of the arrays keeps them alive.
pub(crate) struct Instance(Box<sys::DMUMPS_STRUC_C>);

// SAFETY: heap memory and MPI handles without thread affinity, and one call at a time: see `ranks`.
unsafe impl Send for Instance {}

impl Instance {
    /// Creates an instance. Every rank creates its own.
    pub fn new(world: &World) -> Self {
        // SAFETY: a C structure of numbers and pointers, for which 0 is valid. MUMPS requires zeros before its first
        // job.
        let mut id: Box<sys::DMUMPS_STRUC_C> = Box::new(unsafe { mem::zeroed() });
        (id.sym, id.par) = (UNSYMMETRIC, HOST_WORKS);
        id.comm_fortran = world.fortran();
        let mut instance = Instance(id);
        instance.call(BEGIN);
        // Otherwise MUMPS prints on every rank.
        for (k, silence) in [(1, -1), (2, -1), (3, -1), (4, 0)] {
            instance.set(k, silence);
        }
        instance
    }

    /// Analyses a matrix of order `order.len()` with its entries at `rows` and `columns`, from 1, for elimination in
    /// that order, see [`super::order`]. Every other rank must take part, here and below.
    pub fn analyze(&mut self, rows: &mut [c_int], columns: &mut [c_int], order: &mut [c_int]) {
        self.matrix(rows, columns);
        self.0.n = order.len() as c_int;
        self.0.perm_in = order.as_mut_ptr();
        self.call(Job::Analyze as c_int);
        self.0.perm_in = ptr::null_mut();
        self.forget_the_matrix();
    }

    /// Factors the analysed matrix with these values.
    pub fn factorize(&mut self, rows: &mut [c_int], columns: &mut [c_int], values: &[f64]) {
        self.matrix(rows, columns);
        // The values are only read, since they are not scaled in place.
        self.0.a = values.as_ptr().cast_mut();
        self.call(Job::Factorize as c_int);
        self.0.a = ptr::null_mut();
        self.forget_the_matrix();
    }

    /// Replaces the right-hand side by the solution.
    pub fn solve(&mut self, x: &mut [f64]) {
        (self.0.nrhs, self.0.lrhs) = (1, x.len() as c_int);
        self.0.rhs = x.as_mut_ptr();
        self.call(Job::Solve as c_int);
        self.0.rhs = ptr::null_mut();
    }

    fn matrix(&mut self, rows: &mut [c_int], columns: &mut [c_int]) {
        self.0.nnz = rows.len() as i64;
        self.0.irn = rows.as_mut_ptr();
        self.0.jcn = columns.as_mut_ptr();
    }

    fn forget_the_matrix(&mut self) {
        self.0.irn = ptr::null_mut();
        self.0.jcn = ptr::null_mut();
    }

    fn call(&mut self, job: c_int) {
        self.0.job = job;
        // SAFETY: the structure is complete. The functions above set and borrow all arrays that this job reads or
        // writes on this rank. Their only caller, `Mumps`, ensures that the lengths fit the analysed matrix.
        unsafe { sys::dmumps_c(&raw mut *self.0) }
    }

    /// Sets `ICNTL(k)`.
    pub fn set(&mut self, k: usize, value: c_int) {
        self.0.icntl[k - 1] = value;
    }

    /// Returns `ICNTL(k)`.
    pub fn setting(&self, k: usize) -> c_int {
        self.0.icntl[k - 1]
    }

    /// Returns `INFOG(k)`, which is equal on every rank.
    pub fn told(&self, k: usize) -> c_int {
        self.0.infog[k - 1]
    }

    /// Returns a count in `INFOG(k)`, which is in millions if it would not fit.
    pub fn counted(&self, k: usize) -> usize {
        match self.told(k) {
            few @ 0.. => few as usize,
            millions => 1_000_000 * millions.unsigned_abs() as usize,
        }
    }

    /// Returns `RINFOG(k)`, which is equal on every rank.
    pub fn measured(&self, k: usize) -> f64 {
        self.0.rinfog[k - 1]
    }

    /// Returns `true` if the last factorisation ended because the predicted memory was too small.
    pub fn lacks_room(&self) -> bool {
        matches!(self.told(1), -8 | -9 | -11 | -14 | -15 | -17 | -20)
    }

    /// Returns the ratio of the smallest to the largest pivot of the last factorisation.
    pub fn pivot_ratio(&self) -> f64 {
        self.measured(19) / self.measured(21)
    }

    /// Returns an error unless the last job succeeded and the loaded MUMPS is that of the headers.
    pub fn check(&self, step: &'static str) -> Result<(), LinearError> {
        /// The status of a zero pivot.
        const SINGULAR: c_int = -10;
        match self.told(1) {
            // Positive statuses are warnings.
            0.. => self.check_version(),
            SINGULAR => Err(LinearError::Singular { pivot_ratio: 0.0 }),
            // Memory was refused, a caller's limit or the 32-bit range was exceeded, or the prediction was too small
            // despite more memory.
            -7 | -13 | -19 | -51 | -52 => Err(LinearError::OutOfMemory { step }),
            _ if self.lacks_room() => Err(LinearError::OutOfMemory { step }),
            status => Err(LinearError::Backend { backend: "mumps", step, status: i64::from(status) }),
        }
    }

    /// Checks the version: the length of the structure changes with its second number.
    fn check_version(&self) -> Result<(), LinearError> {
        let built = version(sys::MUMPS_VERSION);
        let text: Vec<u8> = self.0.version_number.iter().map(|&c| c as u8).collect();
        let loaded = version(CStr::from_bytes_until_nul(&text).map_or(&[], CStr::to_bytes));
        if built[..2] == loaded[..2] { Ok(()) } else { Err(LinearError::Version { library: "MUMPS", built, loaded }) }
    }
}

/// Parses the numbers of a version.
fn version(text: &[u8]) -> [i32; 3] {
    let text = String::from_utf8_lossy(text);
    let mut numbers = text.split(|c: char| !c.is_ascii_digit()).filter_map(|number| number.parse().ok());
    [(); 3].map(|()| numbers.next().unwrap_or(0))
}

impl RankLocal for Instance {
    /// Runs a job. Only rank 0 has the arrays, and it evaluates the status that all ranks receive.
    fn serve(&mut self, _: &World, job: i64) -> Result<(), LinearError> {
        for known in [Job::Analyze, Job::Factorize, Job::Solve] {
            if known as i64 == job {
                self.call(known as c_int);
            }
        }
        Ok(())
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        self.call(END);
    }
}

#[cfg(test)]
mod tests {
    use super::version;

    #[test]
    fn versions_are_read() {
        assert_eq!(version(b"5.5.1\0"), [5, 5, 1]);
        assert_eq!(version(b"5.7"), [5, 7, 0]);
        assert_eq!(version(b""), [0, 0, 0]);
    }
}
