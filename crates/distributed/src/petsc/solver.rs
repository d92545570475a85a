//! Solvers of PETSc, as its options say.

use std::ffi::CStr;
use std::ptr;

use stickslip::algebra::linear::LinearError;

use super::start::OPTIONS;
use super::{ELIMINATING, Int, Matrix, Object, Vector, call, comm, int, make, sys};

/// A preconditioner with contact eliminated: the sum of what is known without a cycle of algebraic multigrid, and of
/// that cycle between two ways.
pub(crate) struct Cycle {
    whole: Object<sys::_p_PC>,
    known: Object<sys::_p_PC>,
    inner: Object<sys::_p_PC>,
}

impl Cycle {
    /// Creates the preconditioner with a cycle on `matrix`, with rows in blocks. The orthonormal `kernel` is the null
    /// space of its operator without supports.
    pub(crate) fn new(matrix: &Matrix, block: usize, kernel: &[Vector], spd: bool) -> Result<Self, LinearError> {
        const STEP: &str = "the multigrid hierarchy";
        let vectors: Vec<sys::Vec> = kernel.iter().map(|vector| vector.0).collect();
        let (no, count) = (sys::PetscBool_PETSC_FALSE, int(kernel.len())?);
        let space = make!(STEP, MatNullSpaceCreate(comm(), no, count, vectors.as_ptr()));
        call!(STEP, MatSetNearNullSpace(matrix.0, space.0))?;
        call!(STEP, MatSetBlockSize(matrix.0, int(block)?))?;
        call!(STEP, MatSetOption(matrix.0, sys::MatOption_MAT_SPD, sys::PetscBool::from(spd)))?;
        let part = |kind: &CStr| {
            let made = make!(STEP, PCCreate(comm()));
            call!(STEP, PCSetType(made.0, kind.as_ptr())).map(|()| made)
        };
        let made = Cycle { whole: part(c"composite")?, known: part(c"mat")?, inner: part(c"galerkin")? };
        call!(STEP, PCCompositeSetType(made.whole.0, sys::PCCompositeType_PC_COMPOSITE_ADDITIVE))?;
        call!(STEP, PCCompositeAddPC(made.whole.0, made.known.0))?;
        call!(STEP, PCCompositeAddPC(made.whole.0, made.inner.0))?;
        let mut method = ptr::null_mut();
        call!(STEP, PCGalerkinGetKSP(made.inner.0, &raw mut method))?;
        call!(STEP, KSPSetOptionsPrefix(method, c"contact_".as_ptr()))?;
        call!(STEP, KSPSetOperators(method, matrix.0, matrix.0))?;
        call!(OPTIONS, KSPSetFromOptions(method))?;
        call!(STEP, KSPSetUp(method))?;
        Ok(made)
    }

    /// Takes over what is `known`, and the ways of a residual to the cycle and of its result to the unknowns.
    pub(crate) fn set(&self, known: &Matrix, [from_all, to_all]: [&Matrix; 2]) -> Result<(), LinearError> {
        call!(ELIMINATING, PCSetOperators(self.known.0, known.0, known.0))?;
        call!(ELIMINATING, PCSetOperators(self.inner.0, known.0, known.0))?;
        let [from_all, to_all] =
            [(from_all, true), (to_all, false)].map(|(way, restricts)| as_multiplied(way, restricts));
        call!(ELIMINATING, PCGalerkinSetRestriction(self.inner.0, from_all?.0))?;
        call!(ELIMINATING, PCGalerkinSetInterpolation(self.inner.0, to_all?.0))
    }
}

/// Returns the matrix by which PETSc multiplies with `way` when it restricts or interpolates. Of a square matrix, some
/// versions take the transpose.
fn as_multiplied(way: &Matrix, restricts: bool) -> Result<Matrix, LinearError> {
    let (mut x, mut product) = (Object(ptr::null_mut()), Object(ptr::null_mut()));
    call!(ELIMINATING, MatCreateVecs(way.0, &raw mut x.0, &raw mut product.0))?;
    let applied: Vector = make!(ELIMINATING, VecDuplicate(product.0));
    call!(ELIMINATING, VecSetRandom(x.0, ptr::null_mut()))?;
    way.apply(&x, &product)?;
    if restricts {
        call!(ELIMINATING, MatRestrict(way.0, x.0, applied.0))?;
    } else {
        call!(ELIMINATING, MatInterpolate(way.0, x.0, applied.0))?;
    }
    let (mut is_same, mut owned) = (sys::PetscBool_PETSC_FALSE, Object(ptr::null_mut()));
    call!(ELIMINATING, VecEqual(product.0, applied.0, &raw mut is_same))?;
    if is_same == sys::PetscBool_PETSC_TRUE {
        call!(ELIMINATING, PetscObjectReference(way.0.cast()))?;
        owned.0 = way.0;
    } else {
        call!(ELIMINATING, MatCreateTranspose(way.0, &raw mut owned.0))?;
    }
    Ok(owned)
}

/// A solver.
pub(crate) type Krylov = Object<sys::_p_KSP>;

impl Krylov {
    /// Creates the solver for `matrix` that the options with this `prefix` describe, with a preconditioner if there is
    /// one.
    pub(crate) fn new(prefix: &CStr, matrix: &Matrix, cycle: Option<&Cycle>) -> Result<Self, LinearError> {
        let made = make!(OPTIONS, KSPCreate(comm()));
        call!(OPTIONS, KSPSetOptionsPrefix(made.0, prefix.as_ptr()))?;
        call!(OPTIONS, KSPSetOperators(made.0, matrix.0, matrix.0))?;
        if let Some(cycle) = cycle {
            call!(OPTIONS, KSPSetPC(made.0, cycle.whole.0))?;
        }
        call!(OPTIONS, KSPSetFromOptions(made.0))?;
        made.set_up(matrix)?;
        Ok(made)
    }

    /// Takes over a matrix of the same size.
    pub(crate) fn set_up(&self, matrix: &Matrix) -> Result<(), LinearError> {
        const STEP: &str = "the set-up of the solver";
        call!(STEP, KSPSetOperators(self.0, matrix.0, matrix.0))?;
        call!(STEP, KSPSetUp(self.0))
    }

    /// Returns MUMPS's `INFOG` of 1, 22 and 29, and its `RINFOG` of 3, 19 and 21.
    pub(crate) fn factor_info(&self) -> Result<([Int; 3], [f64; 3]), LinearError> {
        const STEP: &str = "the factorisation";
        let (mut pc, mut factor, mut counts, mut numbers) = (ptr::null_mut(), ptr::null_mut(), [0; 3], [0.0; 3]);
        call!(STEP, KSPGetPC(self.0, &raw mut pc))?;
        call!(STEP, PCFactorGetMatrix(pc, &raw mut factor))?;
        for (k, value) in [1, 22, 29].into_iter().zip(&mut counts) {
            call!(STEP, MatMumpsGetInfog(factor, k, value))?;
        }
        for (k, value) in [3, 19, 21].into_iter().zip(&mut numbers) {
            call!(STEP, MatMumpsGetRinfog(factor, k, value))?;
        }
        Ok((counts, numbers))
    }

    /// Solves from 0 to a relative residual of `tolerance`. The solution takes the place of the right-hand side.
    pub(crate) fn solve(&self, x: &Vector, tolerance: f64) -> Result<(Int, i32), LinearError> {
        const STEP: &str = "the solve";
        let (mut reason, mut iterations) = (0, 0);
        call!(STEP, KSPSetTolerances(self.0, tolerance, f64::MIN_POSITIVE, f64::MAX, sys::PETSC_DEFAULT))?;
        call!(STEP, KSPSolve(self.0, x.0, x.0))?;
        call!(STEP, KSPGetConvergedReason(self.0, &raw mut reason))?;
        call!(STEP, KSPGetIterationNumber(self.0, &raw mut iterations))?;
        Ok((iterations, reason))
    }
}
