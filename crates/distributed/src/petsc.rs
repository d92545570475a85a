//! The objects of PETSc that this crate uses, distributed over all ranks. Calls are collective: every rank makes the same
//! ones, under the lock of `ranks`.

#![allow(unsafe_code)]

mod start;
mod sys;

use std::ffi::CStr;
use std::ptr;

use stickslip::algebra::linear::LinearError;

use crate::expect_length;
use start::check;
pub(crate) use start::{end, has, start};
pub(crate) use sys::PetscInt as Int;

/// Calls a function of PETSc, and converts its status.
macro_rules! call {
    ($step:expr, $function:ident($($argument:expr),* $(,)?)) => {{
        // SAFETY: PETSc runs. All handles are of objects of this module, which own them; the length of every array is
        // that of its slice, or is compared with it before; and the lock of `ranks` keeps other threads away.
        let status = unsafe { sys::$function($($argument),*) };
        check($step, status)
    }};
}

/// Defines the owner of a handle.
macro_rules! object {
    ($(#[$doc:meta])* $name:ident, $raw:ident, $destroy:ident) => {
        $(#[$doc])*
        pub(crate) struct $name(sys::$raw);

        // SAFETY: PETSc's objects belong to a process, without thread affinity, and callers hold the lock of `ranks`.
        unsafe impl Send for $name {}

        impl Drop for $name {
            fn drop(&mut self) {
                // SAFETY: the handle is ours, or null, which PETSc ignores, and is not used again.
                unsafe { sys::$destroy(&raw mut self.0) };
            }
        }
    };
}

object!(/** A sparse matrix. */ Matrix, Mat, MatDestroy);
object!(/** A vector. */ Vector, Vec, VecDestroy);
object!(/** A way of entries from one vector to another. */ Scatter, VecScatter, VecScatterDestroy);
object!(/** A preconditioner. */ Preconditioner, PC, PCDestroy);
object!(Method, KSP, KSPDestroy);
object!(IndexSet, IS, ISDestroy);
object!(NullSpace, MatNullSpace, MatNullSpaceDestroy);
object!(Partitioning, MatPartitioning, MatPartitioningDestroy);

/// Converts a number to PETSc's integers.
pub(crate) fn int(n: usize) -> Result<Int, LinearError> {
    Int::try_from(n).map_err(|_| LinearError::OutOfMemory { step: "PETSc, whose indices have 32 bits" })
}

fn comm() -> sys::MPI_Comm {
    // SAFETY: PETSc sets it when it starts, before any object is made.
    unsafe { sys::PETSC_COMM_WORLD }
}

const ALL: Int = sys::PETSC_DETERMINE;

impl Matrix {
    /// Creates a matrix with this number of rows and columns on this rank, whose columns come in blocks.
    fn new([rows, columns]: [usize; 2], block: usize) -> Result<Self, LinearError> {
        const STEP: &str = "making a matrix";
        let mut made = Matrix(ptr::null_mut());
        call!(STEP, MatCreate(comm(), &raw mut made.0))?;
        call!(STEP, MatSetSizes(made.0, int(rows)?, int(columns)?, ALL, ALL))?;
        call!(STEP, MatSetBlockSizes(made.0, 1, int(block)?))?;
        call!(STEP, MatSetType(made.0, c"aij".as_ptr()))?;
        Ok(made)
    }

    /// Creates a matrix with entries at these places of the whole, from any rank; places may come several times.
    pub(crate) fn with_places(
        sizes: [usize; 2],
        block: usize,
        rows: &mut [Int],
        columns: &mut [Int],
    ) -> Result<Self, LinearError> {
        let made = Self::new(sizes, block)?;
        expect_length("columns of entries", rows.len(), columns.len())?;
        let many = rows.len() as sys::PetscCount;
        call!("making a matrix", MatSetPreallocationCOO(made.0, many, rows.as_mut_ptr(), columns.as_mut_ptr()))?;
        Ok(made)
    }

    /// Sets the sums of the `values` at the places of [`Matrix::with_places`].
    pub(crate) fn set(&mut self, values: &[f64]) -> Result<(), LinearError> {
        call!("the values of a matrix", MatSetValuesCOO(self.0, values.as_ptr(), sys::InsertMode_INSERT_VALUES))
    }

    /// Creates the matrix of these entries: row and column in the whole, value.
    pub(crate) fn of(sizes: [usize; 2], block: usize, entries: &[(Int, Int, f64)]) -> Result<Self, LinearError> {
        let mut rows: Vec<Int> = entries.iter().map(|entry| entry.0).collect();
        let mut columns: Vec<Int> = entries.iter().map(|entry| entry.1).collect();
        let mut made = Self::with_places(sizes, block, &mut rows, &mut columns)?;
        made.set(&entries.iter().map(|entry| entry.2).collect::<Vec<_>>())?;
        Ok(made)
    }

    /// Creates a square matrix with room for this many entries in each row, in columns of this rank and of others.
    pub(crate) fn with_room(own: &[Int], beyond: &[Int]) -> Result<Self, LinearError> {
        const STEP: &str = "making a matrix";
        expect_length("rows with room", own.len(), beyond.len())?;
        let made = Self::new([own.len(); 2], 1)?;
        call!(STEP, MatSeqAIJSetPreallocation(made.0, 0, own.as_ptr()))?;
        call!(STEP, MatMPIAIJSetPreallocation(made.0, 0, own.as_ptr(), 0, beyond.as_ptr()))?;
        let option = sys::MatOption_MAT_NEW_NONZERO_ALLOCATION_ERR;
        call!(STEP, MatSetOption(made.0, option, sys::PetscBool_PETSC_FALSE))?;
        Ok(made)
    }

    /// Sets all entries to 0, which keeps the pattern.
    pub(crate) fn clear(&mut self) -> Result<(), LinearError> {
        call!("the values of a matrix", MatZeroEntries(self.0))
    }

    /// Adds a dense block, row by row, at any rows and columns.
    pub(crate) fn add(&mut self, rows: &[Int], columns: &[Int], values: &[f64]) -> Result<(), LinearError> {
        expect_length("values of a block", rows.len() * columns.len(), values.len())?;
        let (m, n) = (int(rows.len())?, int(columns.len())?);
        let mode = sys::InsertMode_ADD_VALUES;
        call!(
            "the values of a matrix",
            MatSetValues(self.0, m, rows.as_ptr(), n, columns.as_ptr(), values.as_ptr(), mode)
        )
    }

    /// Completes the additions of all ranks.
    pub(crate) fn assemble(&mut self) -> Result<(), LinearError> {
        const STEP: &str = "the values of a matrix";
        call!(STEP, MatAssemblyBegin(self.0, sys::MatAssemblyType_MAT_FINAL_ASSEMBLY))?;
        call!(STEP, MatAssemblyEnd(self.0, sys::MatAssemblyType_MAT_FINAL_ASSEMBLY))
    }

    /// Returns the entries in these rows and columns of the whole, which are of this rank.
    pub(crate) fn within(&self, places: &[Int]) -> Result<Matrix, LinearError> {
        const STEP: &str = "eliminating contact";
        let (places, mut made) = (IndexSet::new(places)?, Matrix(ptr::null_mut()));
        let reuse = sys::MatReuse_MAT_INITIAL_MATRIX;
        call!(STEP, MatCreateSubMatrix(self.0, places.0, places.0, reuse, &raw mut made.0))?;
        let option = sys::MatOption_MAT_NEW_NONZERO_ALLOCATION_ERR;
        call!(STEP, MatSetOption(made.0, option, sys::PetscBool_PETSC_FALSE))?;
        Ok(made)
    }

    /// Computes the product with another matrix.
    pub(crate) fn times(&self, other: &Matrix) -> Result<Matrix, LinearError> {
        let (mut made, reuse, fill) = (Matrix(ptr::null_mut()), sys::MatReuse_MAT_INITIAL_MATRIX, 1.0);
        call!("eliminating contact", MatMatMult(self.0, other.0, reuse, fill, &raw mut made.0))?;
        Ok(made)
    }

    /// Adds `factor` times another matrix.
    pub(crate) fn plus(&mut self, factor: f64, other: &Matrix) -> Result<(), LinearError> {
        let pattern = sys::MatStructure_DIFFERENT_NONZERO_PATTERN;
        call!("eliminating contact", MatAXPY(self.0, factor, other.0, pattern))
    }

    /// Adds another matrix, most of whose entries have room in this one.
    pub(crate) fn plus_within(&mut self, other: &Matrix) -> Result<(), LinearError> {
        call!("eliminating contact", MatAXPY(self.0, 1.0, other.0, sys::MatStructure_SUBSET_NONZERO_PATTERN))
    }

    /// Returns the number of entries on all ranks.
    pub(crate) fn entries(&self) -> Result<f64, LinearError> {
        // SAFETY: C's structure of numbers, which the call fills.
        let mut info: sys::MatInfo = unsafe { std::mem::zeroed() };
        call!("counting entries", MatGetInfo(self.0, sys::MatInfoType_MAT_GLOBAL_SUM, &raw mut info))?;
        Ok(info.nz_used)
    }
}

impl Vector {
    /// Creates a vector of zeros with this many entries on this rank.
    pub(crate) fn new(entries: usize) -> Result<Self, LinearError> {
        const STEP: &str = "making a vector";
        let mut made = Vector(ptr::null_mut());
        call!(STEP, VecCreate(comm(), &raw mut made.0))?;
        call!(STEP, VecSetSizes(made.0, int(entries)?, ALL))?;
        call!(STEP, VecSetType(made.0, c"standard".as_ptr()))?;
        Ok(made)
    }

    /// Returns the places of the entries of this rank in the whole.
    pub(crate) fn places(&self) -> Result<std::ops::Range<Int>, LinearError> {
        let (mut first, mut end) = (0, 0);
        call!("making a vector", VecGetOwnershipRange(self.0, &raw mut first, &raw mut end))?;
        Ok(first..end)
    }

    /// Calls `work` with the entries on this rank.
    pub(crate) fn with<T>(&mut self, work: impl FnOnce(&mut [f64]) -> T) -> Result<T, LinearError> {
        const STEP: &str = "the entries of a vector";
        let (mut entries, mut many) = (ptr::null_mut(), 0);
        call!(STEP, VecGetLocalSize(self.0, &raw mut many))?;
        call!(STEP, VecGetArray(self.0, &raw mut entries))?;
        let slice = if many == 0 {
            &mut []
        } else {
            // SAFETY: PETSc lends an array of the local size until it is given back below.
            unsafe { std::slice::from_raw_parts_mut(entries, many as usize) }
        };
        let result = work(slice);
        call!(STEP, VecRestoreArray(self.0, &raw mut entries))?;
        Ok(result)
    }

    /// Orthonormalises it against orthonormal `others`; returns `false` if it depends on them.
    pub(crate) fn orthonormalise(&mut self, others: &[Vector]) -> Result<bool, LinearError> {
        const STEP: &str = "rigid motions";
        let (mut before, mut size) = (0.0, 0.0);
        call!(STEP, VecNorm(self.0, sys::NormType_NORM_2, &raw mut before))?;
        for _ in 0..2 {
            for other in others {
                let mut share = 0.0;
                call!(STEP, VecDot(self.0, other.0, &raw mut share))?;
                call!(STEP, VecAXPY(self.0, -share, other.0))?;
            }
        }
        call!(STEP, VecNormalize(self.0, &raw mut size))?;
        Ok(size > 1e-10 * before)
    }
}

impl Scatter {
    /// Creates the way from these places of `from` to the same number of places of `to`.
    pub(crate) fn new(from: &Vector, at: &[Int], to: &Vector, places: &[Int]) -> Result<Self, LinearError> {
        expect_length("places of a vector", at.len(), places.len())?;
        let (at, places) = (IndexSet::new(at)?, IndexSet::new(places)?);
        let mut made = Scatter(ptr::null_mut());
        call!("sharing a vector", VecScatterCreate(from.0, at.0, to.0, places.0, &raw mut made.0))?;
        Ok(made)
    }

    /// Brings entries `from` one vector `to` the other.
    pub(crate) fn forward(&self, from: &Vector, to: &mut Vector) -> Result<(), LinearError> {
        self.bring(from, to, sys::ScatterMode_SCATTER_FORWARD)
    }

    /// Brings them back.
    pub(crate) fn back(&self, from: &Vector, to: &mut Vector) -> Result<(), LinearError> {
        self.bring(from, to, sys::ScatterMode_SCATTER_REVERSE)
    }

    fn bring(&self, from: &Vector, to: &mut Vector, mode: sys::ScatterMode) -> Result<(), LinearError> {
        const STEP: &str = "sharing a vector";
        call!(STEP, VecScatterBegin(self.0, from.0, to.0, sys::InsertMode_INSERT_VALUES, mode))?;
        call!(STEP, VecScatterEnd(self.0, from.0, to.0, sys::InsertMode_INSERT_VALUES, mode))
    }
}

impl IndexSet {
    fn new(places: &[Int]) -> Result<Self, LinearError> {
        let mut made = IndexSet(ptr::null_mut());
        let mode = sys::PetscCopyMode_PETSC_COPY_VALUES;
        call!("sharing a vector", ISCreateGeneral(comm(), int(places.len())?, places.as_ptr(), mode, &raw mut made.0))?;
        Ok(made)
    }
}

/// Returns the part of each vertex of a graph, one for each rank, nearly equal and with few edges between them. Rank 0
/// has the graph, by the `starts` of its rows and their columns, and gets the parts.
pub(crate) fn partition(starts: &[Int], columns: &[Int]) -> Result<Vec<usize>, LinearError> {
    const STEP: &str = "dealing the nodes among ranks";
    let vertices = starts.len().saturating_sub(1);
    // PETSc frees these arrays itself.
    let copy = |from: &[Int]| {
        let mut to: *mut Int = ptr::null_mut();
        let (bytes, place) = (size_of_val(from).max(size_of::<Int>()), (&raw mut to).cast::<std::ffi::c_void>());
        let (name, clear) = (c"partition".as_ptr(), sys::PetscBool_PETSC_TRUE);
        call!(STEP, PetscMallocA(1, clear, 0, name, name, bytes, place))?;
        // SAFETY: PETSc has just made room for as many.
        unsafe { ptr::copy_nonoverlapping(from.as_ptr(), to, from.len()) };
        Ok(to)
    };
    let (i, j) = (copy(if starts.is_empty() { &[0] } else { starts })?, copy(columns)?);
    let (mut graph, mut made) = (Matrix(ptr::null_mut()), Partitioning(ptr::null_mut()));
    let mut own = [vertices as i64];
    crate::ranks::shim::tell(&mut own);
    let all = int(own[0] as usize)?;
    call!(STEP, MatCreateMPIAdj(comm(), int(vertices)?, all, i, j, ptr::null_mut(), &raw mut graph.0))?;
    call!(STEP, MatPartitioningCreate(comm(), &raw mut made.0))?;
    call!(STEP, MatPartitioningSetAdjacency(made.0, graph.0))?;
    call!(STEP, MatPartitioningSetFromOptions(made.0))?;
    let (mut parts, mut numbers) = (IndexSet(ptr::null_mut()), ptr::null());
    call!(STEP, MatPartitioningApply(made.0, &raw mut parts.0))?;
    call!(STEP, ISGetIndices(parts.0, &raw mut numbers))?;
    // SAFETY: the set has as many numbers as there are vertices here, until it is destroyed.
    let part = (0..vertices).map(|k| unsafe { *numbers.add(k) } as usize).collect();
    call!(STEP, ISRestoreIndices(parts.0, &raw mut numbers))?;
    Ok(part)
}

impl Preconditioner {
    fn new(kind: &CStr, matrix: &Matrix) -> Result<Self, LinearError> {
        const STEP: &str = "making a preconditioner";
        let mut made = Preconditioner(ptr::null_mut());
        call!(STEP, PCCreate(comm(), &raw mut made.0))?;
        call!(STEP, PCSetType(made.0, kind.as_ptr()))?;
        call!(STEP, PCSetOperators(made.0, matrix.0, matrix.0))?;
        Ok(made)
    }

    /// Creates a cycle of algebraic multigrid on `matrix`, with rows in blocks. The orthonormal `kernel` is the null space
    /// of its operator without supports.
    pub(crate) fn cycle(matrix: &Matrix, block: usize, kernel: &[Vector], spd: bool) -> Result<Self, LinearError> {
        const STEP: &str = "the multigrid hierarchy";
        let vectors: Vec<sys::Vec> = kernel.iter().map(|vector| vector.0).collect();
        let mut space = NullSpace(ptr::null_mut());
        let no = sys::PetscBool_PETSC_FALSE;
        call!(STEP, MatNullSpaceCreate(comm(), no, int(kernel.len())?, vectors.as_ptr(), &raw mut space.0))?;
        call!(STEP, MatSetNearNullSpace(matrix.0, space.0))?;
        call!(STEP, MatSetBlockSize(matrix.0, int(block)?))?;
        call!(STEP, MatSetOption(matrix.0, sys::MatOption_MAT_SPD, sys::PetscBool::from(spd)))?;
        let made = Self::new(c"gamg", matrix)?;
        call!(STEP, PCSetOptionsPrefix(made.0, c"contact_".as_ptr()))?;
        call!(STEP, PCSetFromOptions(made.0))?;
        call!(STEP, PCSetUp(made.0))?;
        Ok(made)
    }
}

/// The parts of a preconditioner with contact eliminated.
pub(crate) struct Parts<'a> {
    /// The part of the inverse that is known without a cycle.
    pub known: &'a Matrix,
    /// The cycle, the way of a residual to it, and the way of its result to the unknowns.
    pub cycle: &'a Preconditioner,
    pub from_all: &'a Matrix,
    pub to_all: &'a Matrix,
}

/// The end of a solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Found {
    pub iterations: usize,
    /// PETSc's reason for the end, negative if the solver did not converge.
    pub reason: i32,
}

/// A solver.
pub(crate) struct Krylov {
    method: Method,
    /// The method that applies the cycle, if there is one.
    inner: Option<Method>,
}

impl Drop for Krylov {
    /// Takes the cycle out, which PETSc would empty.
    fn drop(&mut self) {
        if let Some(inner) = &self.inner {
            let mut none = Preconditioner(ptr::null_mut());
            // There is nobody left to tell an error to.
            let _ = call!("the end", PCCreate(comm(), &raw mut none.0))
                .and_then(|()| call!("the end", KSPSetPC(inner.0, none.0)));
        }
    }
}

impl Krylov {
    fn new(matrix: &Matrix, kind: &CStr) -> Result<(Self, sys::PC), LinearError> {
        const STEP: &str = "making a solver";
        let (mut method, mut pc) = (Method(ptr::null_mut()), ptr::null_mut());
        call!(STEP, KSPCreate(comm(), &raw mut method.0))?;
        call!(STEP, KSPSetType(method.0, kind.as_ptr()))?;
        call!(STEP, KSPSetOperators(method.0, matrix.0, matrix.0))?;
        call!(STEP, KSPGetPC(method.0, &raw mut pc))?;
        Ok((Krylov { method, inner: None }, pc))
    }

    /// Creates the solver for `matrix` that the options describe, by default with a preconditioner of these `parts`.
    pub(crate) fn by_options(matrix: &Matrix, parts: Option<Parts<'_>>) -> Result<Self, LinearError> {
        const STEP: &str = "its options";
        let (mut made, pc) = Self::new(matrix, c"fgmres")?;
        if let Some(parts) = parts {
            call!(STEP, PCSetType(pc, c"composite".as_ptr()))?;
            call!(STEP, PCCompositeSetType(pc, sys::PCCompositeType_PC_COMPOSITE_ADDITIVE))?;
            let galerkin = Preconditioner::new(c"galerkin", matrix)?;
            let mut inner: sys::KSP = ptr::null_mut();
            call!(STEP, PCGalerkinSetInterpolation(galerkin.0, parts.to_all.0))?;
            call!(STEP, PCGalerkinSetRestriction(galerkin.0, parts.from_all.0))?;
            call!(STEP, PCGalerkinGetKSP(galerkin.0, &raw mut inner))?;
            call!(STEP, PetscObjectReference(inner.cast()))?;
            made.inner = Some(Method(inner));
            call!(STEP, KSPSetType(inner, c"preonly".as_ptr()))?;
            call!(STEP, KSPSetPC(inner, parts.cycle.0))?;
            for part in [Preconditioner::new(c"mat", parts.known)?, galerkin] {
                call!(STEP, PCCompositeAddPC(pc, part.0))?;
            }
        }
        call!(STEP, KSPSetFromOptions(made.method.0))?;
        call!("the set-up of the solver", KSPSetUp(made.method.0))?;
        Ok(made)
    }

    /// Creates a factorisation by MUMPS, in which the room for the factors exceeds the prediction by these per cent.
    pub(crate) fn direct(matrix: &Matrix, room: Int) -> Result<Self, LinearError> {
        const STEP: &str = "the symbolic analysis";
        let (made, pc) = Self::new(matrix, c"preonly")?;
        call!(STEP, PCSetType(pc, c"lu".as_ptr()))?;
        call!(STEP, PCFactorSetMatSolverType(pc, c"mumps".as_ptr()))?;
        call!(STEP, PCFactorSetUpMatSolverType(pc))?;
        let mut factor = ptr::null_mut();
        call!(STEP, PCFactorGetMatrix(pc, &raw mut factor))?;
        // No permutation for the first values, which is useless for later ones; an order from the structure alone; no search for vanishing
        // pivots, which does not find the rigid modes of a body without supports.
        for (setting, value) in [(6, 0), (14, room), (24, 0)] {
            call!(STEP, MatMumpsSetIcntl(factor, setting, value))?;
        }
        Ok(made)
    }

    fn factor(&self) -> Result<sys::Mat, LinearError> {
        let (mut pc, mut factor) = (ptr::null_mut(), ptr::null_mut());
        call!("the factorisation", KSPGetPC(self.method.0, &raw mut pc))?;
        call!("the factorisation", PCFactorGetMatrix(pc, &raw mut factor))?;
        Ok(factor)
    }

    /// Factors the matrix, whose values have changed.
    pub(crate) fn factorize(&mut self, matrix: &Matrix) -> Result<(), LinearError> {
        const STEP: &str = "the factorisation";
        call!(STEP, KSPSetOperators(self.method.0, matrix.0, matrix.0))?;
        call!(STEP, KSPSetUp(self.method.0))
    }

    /// Returns MUMPS's `INFOG` of 1, 22 and 29, and its `RINFOG` of 3, 19 and 21.
    pub(crate) fn told(&self) -> Result<([Int; 3], [f64; 3]), LinearError> {
        const STEP: &str = "the factorisation";
        let (factor, mut counts, mut numbers) = (self.factor()?, [0; 3], [0.0; 3]);
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
        &mut self,
        b: &Vector,
        x: &mut Vector,
        tolerance: f64,
        limit: Option<usize>,
    ) -> Result<Found, LinearError> {
        const STEP: &str = "the solve";
        let limit = limit.map_or(Ok(sys::PETSC_DEFAULT), int)?;
        let (least, most) = (f64::MIN_POSITIVE, f64::MAX);
        call!(STEP, KSPSetTolerances(self.method.0, tolerance, least, most, limit))?;
        call!(STEP, KSPSolve(self.method.0, b.0, x.0))?;
        let (mut reason, mut iterations) = (0, 0);
        call!(STEP, KSPGetConvergedReason(self.method.0, &raw mut reason))?;
        call!(STEP, KSPGetIterationNumber(self.method.0, &raw mut iterations))?;
        Ok(Found { iterations: iterations as usize, reason })
    }
}
