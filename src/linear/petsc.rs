//! One cycle of PETSc's algebraic multigrid, GAMG, as an approximate inverse.
//!
//! Smoothed aggregation wants to know what has no energy, the rigid motions, and which rows are of one node. Smoothing is by two
//! Chebyshev steps: over an incomplete Cholesky factorisation where the matrix is symmetric, which bears stretched elements, and over
//! the diagonal where it is not.

#![allow(unsafe_code)]

mod sys;

use std::ffi::CStr;
use std::ptr;
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::LinearError;
use super::error::expect_finite;

const NAME: &str = "PETSc";

/// PETSc is not made for several threads: one call at a time.
static CALLS: Mutex<Started> = Mutex::new(Started(None));

/// Whether PETSc has been started, and with what.
struct Started(Option<Result<(), LinearError>>);

/// A square matrix by compressed rows, sorted.
pub(super) struct Rows {
    pub starts: Vec<i32>,
    pub columns: Vec<i32>,
    pub values: Vec<f64>,
    /// So many successive rows are of one node.
    pub block: usize,
    pub symmetric: bool,
}

/// The hierarchy of one matrix.
pub(super) struct Amg {
    // The handles go before what they point to.
    pc: sys::PC,
    work: [sys::Vec; 2],
    order: usize,
    _matrix: Box<Rows>,
    _kernel: Vec<Vec<f64>>,
}

// SAFETY: the objects are of one process, without thread affinity, and every call goes through `CALLS`.
unsafe impl Send for Amg {}

/// Starts PETSc, once, and lets nobody else call it in the meantime.
fn started() -> Result<MutexGuard<'static, Started>, LinearError> {
    let mut calls = CALLS.lock().unwrap_or_else(PoisonError::into_inner);
    calls.0.get_or_insert_with(start).clone()?;
    Ok(calls)
}

fn start() -> Result<(), LinearError> {
    const LOADED: [i32; 3] =
        [sys::PETSC_VERSION_MAJOR as i32, sys::PETSC_VERSION_MINOR as i32, sys::PETSC_VERSION_SUBMINOR as i32];
    let mut loaded = [0; 4];
    // SAFETY: the version may be asked for at any time, and goes to four places; nothing else runs inside PETSc.
    unsafe {
        let [major, minor, sub, release] = &mut loaded;
        check("asking for its version", sys::PetscGetVersionNumber(major, minor, sub, release))?;
    }
    if loaded[..2] != LOADED[..2] {
        let [major, minor, sub, _] = loaded;
        return Err(LinearError::Version { library: NAME, built: LOADED, loaded: [major, minor, sub] });
    }
    // SAFETY: set before the start, which is under the lock of `CALLS`; MPI then bears calls of several threads, one at a time
    // (MPI_THREAD_SERIALIZED). Options are kept as copies. Signals stay ours, and errors come back as statuses.
    unsafe {
        sys::PETSC_MPI_THREAD_REQUIRED = 2;
        let option =
            |name: &CStr, value: &CStr| sys::PetscOptionsSetValue(ptr::null_mut(), name.as_ptr(), value.as_ptr());
        check("the start", option(c"-no_signal_handler", c"true"))?;
        check("the start", sys::PetscInitializeNoArguments())?;
        check("the start", sys::PetscPushErrorHandler(Some(sys::PetscReturnErrorHandler), ptr::null_mut()))?;
        for (name, value) in [(c"-symmetric_mg_levels_pc_type", c"icc"), (c"-oblique_mg_levels_pc_type", c"jacobi")] {
            check("its options", option(name, value))?;
        }
    }
    Ok(())
}

/// An error of a call that did not go well.
fn check(step: &'static str, status: sys::PetscErrorCode) -> Result<(), LinearError> {
    const OUT_OF_MEMORY: i64 = 55;
    match i64::from(status) {
        0 => Ok(()),
        OUT_OF_MEMORY => Err(LinearError::OutOfMemory { step: "the multigrid hierarchy" }),
        status => Err(LinearError::Backend { backend: NAME, step, status }),
    }
}

/// The length of an array that PETSc counts with 32 bits.
fn count(n: usize) -> Result<sys::PetscInt, LinearError> {
    sys::PetscInt::try_from(n)
        .map_err(|_| LinearError::OutOfMemory { step: "the multigrid hierarchy, whose indices have 32 bits" })
}

impl Amg {
    /// The hierarchy of `matrix`, where the orthonormal `kernel` has what its operator without supports leaves alone.
    pub(super) fn new(matrix: Rows, kernel: Vec<Vec<f64>>) -> Result<Self, LinearError> {
        let order = matrix.starts.len() - 1;
        let n = count(order)?;
        count(matrix.values.len())?;
        expect_finite(&matrix.values)?;
        let (pc, work) = (ptr::null_mut(), [ptr::null_mut(); 2]);
        let mut amg = Amg { pc, work, order, _matrix: Box::new(matrix), _kernel: kernel };
        // After `amg`, whose end waits for it when this fails.
        let _calls = started()?;
        let Amg { pc, work, _matrix: matrix, _kernel: kernel, .. } = &mut amg;
        let mut objects = Objects::default();
        // SAFETY: all arrays are as long as `n` and `starts` say, and live as long as the objects that point to them: matrix and kernel
        // are owned by `amg`, whose hierarchy holds references to both; PETSc does not write to a matrix of arrays that it only reads.
        // The work vectors get their arrays in `cycle`.
        unsafe {
            let comm = sys::PETSC_COMM_WORLD;
            let (starts, columns, values) =
                (matrix.starts.as_mut_ptr(), matrix.columns.as_mut_ptr(), matrix.values.as_mut_ptr());
            check(
                "making a matrix",
                sys::MatCreateSeqAIJWithArrays(comm, n, n, starts, columns, values, &raw mut objects.matrix),
            )?;
            check("making a matrix", sys::MatSetBlockSize(objects.matrix, count(matrix.block)?))?;
            if matrix.symmetric {
                check(
                    "making a matrix",
                    sys::MatSetOption(objects.matrix, sys::MatOption_MAT_SPD, sys::PetscBool_PETSC_TRUE),
                )?;
            }
            for motion in kernel.iter() {
                let mut vector = ptr::null_mut();
                check("rigid motions", sys::VecCreateSeqWithArray(comm, 1, n, motion.as_ptr(), &raw mut vector))?;
                objects.kernel.push(vector);
            }
            let motions = objects.kernel.as_ptr();
            let k = count(kernel.len())?;
            check(
                "rigid motions",
                sys::MatNullSpaceCreate(comm, sys::PetscBool_PETSC_FALSE, k, motions, &raw mut objects.space),
            )?;
            check("rigid motions", sys::MatSetNearNullSpace(objects.matrix, objects.space))?;
            check("making a hierarchy", sys::PCCreate(comm, pc))?;
            check("making a hierarchy", sys::PCSetType(*pc, c"gamg".as_ptr()))?;
            let prefix = if matrix.symmetric { c"symmetric_" } else { c"oblique_" };
            check("making a hierarchy", sys::PCSetOptionsPrefix(*pc, prefix.as_ptr()))?;
            check("making a hierarchy", sys::PCSetOperators(*pc, objects.matrix, objects.matrix))?;
            check("making a hierarchy", sys::PCSetFromOptions(*pc))?;
            check("making a hierarchy", sys::PCSetUp(*pc))?;
            for vector in work {
                check("making a vector", sys::VecCreateSeqWithArray(comm, 1, n, ptr::null(), vector))?;
            }
        }
        Ok(amg)
    }

    /// One cycle: `z` with `A z ≈ r`.
    pub(super) fn cycle(&mut self, r: &[f64], z: &mut [f64]) -> Result<(), LinearError> {
        super::error::expect_length("residual", self.order, r.len())?;
        super::error::expect_length("correction", self.order, z.len())?;
        let _calls = started()?;
        let [from, to] = self.work;
        // SAFETY: both arrays have the order of the vectors, and are taken back before they are lent to anybody else; `r` is only
        // read.
        unsafe {
            check("a cycle", sys::VecPlaceArray(from, r.as_ptr()))?;
            let placed = sys::VecPlaceArray(to, z.as_ptr());
            let applied = if placed == 0 { sys::PCApply(self.pc, from, to) } else { placed };
            let back = [sys::VecResetArray(from), if placed == 0 { sys::VecResetArray(to) } else { 0 }];
            check("a cycle", applied)?;
            back.into_iter().try_for_each(|status| check("a cycle", status))?;
        }
        Ok(())
    }
}

impl Drop for Amg {
    fn drop(&mut self) {
        let Ok(_calls) = started() else { return };
        let [from, to] = &mut self.work;
        // SAFETY: the handles are ours, or null, which PETSc passes over; none is used again. Matrix and kernel go with the hierarchy,
        // which holds the last references to them, before their arrays.
        unsafe {
            sys::PCDestroy(&raw mut self.pc);
            sys::VecDestroy(from);
            sys::VecDestroy(to);
        }
    }
}

/// What a hierarchy keeps references to; ours end with its making.
struct Objects {
    matrix: sys::Mat,
    space: sys::MatNullSpace,
    kernel: Vec<sys::Vec>,
}

impl Default for Objects {
    fn default() -> Self {
        Objects { matrix: ptr::null_mut(), space: ptr::null_mut(), kernel: Vec::new() }
    }
}

impl Drop for Objects {
    fn drop(&mut self) {
        // SAFETY: made under the lock of the caller, ours alone, or null; whoever refers to them has references of its own.
        unsafe {
            sys::MatNullSpaceDestroy(&raw mut self.space);
            sys::MatDestroy(&raw mut self.matrix);
            self.kernel.iter_mut().for_each(|vector| {
                sys::VecDestroy(vector);
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// -u'' with u = 0 at both ends: nothing rigid but the constant.
    fn bar(n: usize, symmetric: bool) -> Amg {
        let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
        for i in 0..n as i32 {
            for (j, v) in [(i - 1, -1.0), (i, 2.0), (i + 1, -1.0)] {
                if (0..n as i32).contains(&j) {
                    columns.push(j);
                    values.push(v);
                }
            }
            starts.push(columns.len() as i32);
        }
        let constant = vec![1.0 / (n as f64).sqrt(); n];
        Amg::new(Rows { starts, columns, values, block: 1, symmetric }, vec![constant]).unwrap()
    }

    #[test]
    fn cycles_solve() {
        for symmetric in [true, false] {
            let n = 200;
            let mut amg = bar(n, symmetric);
            let (b, mut x) = (vec![1.0; n], vec![0.0; n]);
            let mut last = f64::INFINITY;
            for _ in 0..30 {
                let at = |i: usize| if i < n { x[i] } else { 0.0 };
                let r: Vec<f64> = (0..n).map(|i| b[i] - 2.0 * x[i] + at(i.wrapping_sub(1)) + at(i + 1)).collect();
                last = r.iter().map(|r| r * r).sum::<f64>().sqrt();
                let mut z = vec![0.0; n];
                amg.cycle(&r, &mut z).unwrap();
                x.iter_mut().zip(z).for_each(|(x, z)| *x += z);
            }
            assert!(last < 1e-6, "{symmetric} {last}");
        }
    }

    #[test]
    fn what_does_not_fit_is_an_error() {
        let mut amg = bar(10, true);
        assert!(matches!(amg.cycle(&[0.0; 9], &mut [0.0; 10]), Err(LinearError::Shape { .. })));
        let rows = Rows { starts: vec![0, 1], columns: vec![0], values: vec![f64::NAN], block: 1, symmetric: true };
        assert!(matches!(Amg::new(rows, vec![vec![1.0]]), Err(LinearError::NotFinite)));
    }
}
