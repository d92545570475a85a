//! Solvers of PETSc, as its options say.

use std::ffi::CStr;
use std::ptr;

use stickslip::algebra::linear::LinearError;

use super::{Int, Matrix, Vector, call, comm, int, object, sys};

object!(Preconditioner, PC, PCDestroy);
object!(Method, KSP, KSPDestroy);
object!(NullSpace, MatNullSpace, MatNullSpaceDestroy);

/// The parts of a preconditioner with contact eliminated: what is known without a cycle, and the ways of a residual to
/// the cycle and of its result to the unknowns.
pub(crate) struct Parts {
    pub known: Matrix,
    pub from_all: Matrix,
    pub to_all: Matrix,
}

/// A preconditioner with contact eliminated around a cycle of algebraic multigrid.
pub(crate) struct Cycle {
    whole: Preconditioner,
    known: Preconditioner,
    inner: Preconditioner,
}

impl Cycle {
    /// Creates the preconditioner with a cycle on `matrix`, with rows in blocks. The orthonormal `kernel` is the null
    /// space of its operator without supports.
    pub(crate) fn new(matrix: &Matrix, block: usize, kernel: &[Vector], spd: bool) -> Result<Self, LinearError> {
        const STEP: &str = "the multigrid hierarchy";
        let vectors: Vec<sys::Vec> = kernel.iter().map(|vector| vector.0).collect();
        let (mut space, no) = (NullSpace(ptr::null_mut()), sys::PetscBool_PETSC_FALSE);
        call!(STEP, MatNullSpaceCreate(comm(), no, int(kernel.len())?, vectors.as_ptr(), &raw mut space.0))?;
        call!(STEP, MatSetNearNullSpace(matrix.0, space.0))?;
        call!(STEP, MatSetBlockSize(matrix.0, int(block)?))?;
        call!(STEP, MatSetOption(matrix.0, sys::MatOption_MAT_SPD, sys::PetscBool::from(spd)))?;
        let [whole, known, inner] = [c"composite", c"mat", c"galerkin"].map(Preconditioner::new);
        let made = Cycle { whole: whole?, known: known?, inner: inner? };
        let additive = sys::PCCompositeType_PC_COMPOSITE_ADDITIVE;
        call!(STEP, PCCompositeSetType(made.whole.0, additive))?;
        call!(STEP, PCCompositeAddPC(made.whole.0, made.known.0))?;
        call!(STEP, PCCompositeAddPC(made.whole.0, made.inner.0))?;
        let mut method: sys::KSP = ptr::null_mut();
        call!(STEP, PCGalerkinGetKSP(made.inner.0, &raw mut method))?;
        call!(STEP, KSPSetOptionsPrefix(method, c"contact_".as_ptr()))?;
        call!(STEP, KSPSetOperators(method, matrix.0, matrix.0))?;
        call!(super::start::OPTIONS, KSPSetFromOptions(method))?;
        call!(STEP, KSPSetUp(method))?;
        Ok(made)
    }

    /// Takes these `parts` for a `matrix`.
    pub(crate) fn set(&self, matrix: &Matrix, parts: &Parts) -> Result<(), LinearError> {
        const STEP: &str = "eliminating contact";
        call!(STEP, PCSetOperators(self.known.0, parts.known.0, parts.known.0))?;
        call!(STEP, PCSetOperators(self.inner.0, matrix.0, matrix.0))?;
        call!(STEP, PCGalerkinSetInterpolation(self.inner.0, parts.to_all.0))?;
        call!(STEP, PCGalerkinSetRestriction(self.inner.0, parts.from_all.0))
    }
}

impl Preconditioner {
    fn new(kind: &CStr) -> Result<Self, LinearError> {
        const STEP: &str = "making a preconditioner";
        let mut made = Preconditioner(ptr::null_mut());
        call!(STEP, PCCreate(comm(), &raw mut made.0))?;
        call!(STEP, PCSetType(made.0, kind.as_ptr()))?;
        Ok(made)
    }
}

/// The end of a solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Found {
    pub iterations: usize,
    /// PETSc's reason for the end, negative if the solver did not converge.
    pub reason: i32,
}

/// A solver.
pub(crate) struct Krylov(Method);

impl Krylov {
    /// Creates the solver for `matrix` that the options with this `prefix` describe, with a preconditioner if there is
    /// one.
    pub(crate) fn new(prefix: &CStr, matrix: &Matrix, cycle: Option<&Cycle>) -> Result<Self, LinearError> {
        const STEP: &str = super::start::OPTIONS;
        let mut method = Method(ptr::null_mut());
        call!(STEP, KSPCreate(comm(), &raw mut method.0))?;
        call!(STEP, KSPSetOptionsPrefix(method.0, prefix.as_ptr()))?;
        if let Some(cycle) = cycle {
            call!(STEP, KSPSetPC(method.0, cycle.whole.0))?;
        }
        call!(STEP, KSPSetOperators(method.0, matrix.0, matrix.0))?;
        call!(STEP, KSPSetFromOptions(method.0))?;
        let made = Krylov(method);
        made.set_up(matrix)?;
        Ok(made)
    }

    /// Takes over a matrix of the same size.
    pub(crate) fn set_up(&self, matrix: &Matrix) -> Result<(), LinearError> {
        const STEP: &str = "the set-up of the solver";
        call!(STEP, KSPSetOperators(self.0.0, matrix.0, matrix.0))?;
        call!(STEP, KSPSetUp(self.0.0))
    }

    /// Returns MUMPS's `INFOG` of 1, 22 and 29, and its `RINFOG` of 3, 19 and 21.
    pub(crate) fn factor_info(&self) -> Result<([Int; 3], [f64; 3]), LinearError> {
        const STEP: &str = "the factorisation";
        let (mut pc, mut factor, mut counts, mut numbers) = (ptr::null_mut(), ptr::null_mut(), [0; 3], [0.0; 3]);
        call!(STEP, KSPGetPC(self.0.0, &raw mut pc))?;
        call!(STEP, PCFactorGetMatrix(pc, &raw mut factor))?;
        for (k, value) in [1, 22, 29].into_iter().zip(&mut counts) {
            call!(STEP, MatMumpsGetInfog(factor, k, value))?;
        }
        for (k, value) in [3, 19, 21].into_iter().zip(&mut numbers) {
            call!(STEP, MatMumpsGetRinfog(factor, k, value))?;
        }
        Ok((counts, numbers))
    }

    /// Solves from 0 to a relative residual of `tolerance`, in at most `limit` iterations if that is given.
    pub(crate) fn solve(
        &self,
        b: &Vector,
        x: &Vector,
        tolerance: f64,
        limit: Option<usize>,
    ) -> Result<Found, LinearError> {
        const STEP: &str = "the solve";
        let limit = limit.map_or(Ok(sys::PETSC_DEFAULT), int)?;
        let (mut reason, mut iterations) = (0, 0);
        call!(STEP, KSPSetTolerances(self.0.0, tolerance, f64::MIN_POSITIVE, f64::MAX, limit))?;
        call!(STEP, KSPSolve(self.0.0, b.0, x.0))?;
        call!(STEP, KSPGetConvergedReason(self.0.0, &raw mut reason))?;
        call!(STEP, KSPGetIterationNumber(self.0.0, &raw mut iterations))?;
        Ok(Found { iterations: iterations as usize, reason })
    }
}
