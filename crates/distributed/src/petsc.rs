//! The objects of PETSc that this crate uses, distributed over all ranks. Calls are collective: every rank makes the
//! same ones, under the lock of `ranks`.

#![allow(unsafe_code)]

mod solver;
mod start;
mod sys;

use std::ptr;

use stickslip::algebra::linear::LinearError;

use crate::expect_length;
pub(crate) use solver::{Cycle, Found, Krylov, Parts};
use start::check;
pub(crate) use start::{check_options, end, has, set, start};
pub(crate) use sys::PetscInt as Int;

/// An entry: row and column in the whole, value.
pub(crate) type Entry = (Int, Int, f64);

/// Calls a function of PETSc, and converts its status.
macro_rules! call {
    ($step:expr, $function:ident($($argument:expr),* $(,)?)) => {{
        // SAFETY: PETSc runs. All handles are of objects of this module, which own them; the length of every array is
        // that of its slice, or is compared with it before; and the lock of `ranks` keeps other threads away.
        let status = unsafe { $crate::petsc::sys::$function($($argument),*) };
        $crate::petsc::check($step, status)
    }};
}
use call;

/// Defines the owner of a handle.
macro_rules! object {
    ($(#[$doc:meta])* $name:ident, $raw:ident, $destroy:ident) => {
        $(#[$doc])*
        pub(crate) struct $name($crate::petsc::sys::$raw);

        // SAFETY: PETSc's objects belong to a process, without thread affinity, and callers hold the lock of `ranks`.
        unsafe impl Send for $name {}
        // SAFETY: as above; no two threads use an object at a time.
        unsafe impl Sync for $name {}

        impl Drop for $name {
            fn drop(&mut self) {
                // SAFETY: the handle is ours, or null, which PETSc ignores, and is not used again.
                unsafe { $crate::petsc::sys::$destroy(&raw mut self.0) };
            }
        }
    };
}

use object;

object!(/** A sparse matrix. */ Matrix, Mat, MatDestroy);
object!(/** A vector. */ Vector, Vec, VecDestroy);
object!(/** A way of entries from one vector to another. */ Scatter, VecScatter, VecScatterDestroy);
object!(IndexSet, IS, ISDestroy);
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
const MAKING: &str = "making a matrix";

impl Matrix {
    /// Creates a matrix with this number of rows and columns on this rank, which come in these blocks.
    fn new([rows, columns]: [usize; 2], [by_rows, by_columns]: [usize; 2]) -> Result<Self, LinearError> {
        let mut made = Matrix(ptr::null_mut());
        call!(MAKING, MatCreate(comm(), &raw mut made.0))?;
        call!(MAKING, MatSetSizes(made.0, int(rows)?, int(columns)?, ALL, ALL))?;
        call!(MAKING, MatSetBlockSizes(made.0, int(by_rows)?, int(by_columns)?))?;
        call!(MAKING, MatSetType(made.0, c"aij".as_ptr()))?;
        Ok(made)
    }

    /// Creates a square matrix of rows in blocks: the starts of the rows of this rank, and their sorted columns in the
    /// whole with the values.
    pub(crate) fn of_rows(block: usize, starts: &[Int], columns: &[Int], values: &[f64]) -> Result<Self, LinearError> {
        expect_length("columns of rows", starts.last().map_or(0, |end| *end as usize), columns.len())?;
        expect_length("values of rows", columns.len(), values.len())?;
        let made = Self::new([starts.len() - 1; 2], [block; 2])?;
        let (i, j, v) = (starts.as_ptr(), columns.as_ptr(), values.as_ptr());
        call!(MAKING, MatSeqAIJSetPreallocationCSR(made.0, i, j, v))?;
        call!(MAKING, MatMPIAIJSetPreallocationCSR(made.0, i, j, v))?;
        Ok(made)
    }

    /// Creates a matrix with entries at these places of the whole, from any rank; places may come several times.
    pub(crate) fn with_places(
        sizes: [usize; 2],
        blocks: [usize; 2],
        [mut rows, mut columns]: [Vec<Int>; 2],
    ) -> Result<Self, LinearError> {
        let made = Self::new(sizes, blocks)?;
        expect_length("columns of entries", rows.len(), columns.len())?;
        let many = rows.len() as sys::PetscCount;
        call!(MAKING, MatSetPreallocationCOO(made.0, many, rows.as_mut_ptr(), columns.as_mut_ptr()))?;
        Ok(made)
    }

    /// Sets the sums of the `values` at the places of [`Matrix::with_places`].
    pub(crate) fn set(&self, values: &[f64]) -> Result<(), LinearError> {
        call!(MAKING, MatSetValuesCOO(self.0, values.as_ptr(), sys::InsertMode_INSERT_VALUES))
    }

    /// Creates the matrix of these entries.
    pub(crate) fn of(
        sizes: [usize; 2],
        blocks: [usize; 2],
        entries: impl Iterator<Item = Entry>,
    ) -> Result<Self, LinearError> {
        let (mut places, mut values) = ([Vec::new(), Vec::new()], Vec::new());
        for (row, column, value) in entries {
            places[0].push(row);
            places[1].push(column);
            values.push(value);
        }
        let made = Self::with_places(sizes, blocks, places)?;
        made.set(&values)?;
        Ok(made)
    }

    /// Creates `factor` times this matrix, plus others times their factors.
    pub(crate) fn plus(&self, factor: f64, terms: &[(f64, &Matrix)]) -> Result<Self, LinearError> {
        let mut made = Matrix(ptr::null_mut());
        call!(MAKING, MatDuplicate(self.0, sys::MatDuplicateOption_MAT_COPY_VALUES, &raw mut made.0))?;
        call!(MAKING, MatScale(made.0, factor))?;
        let pattern = sys::MatStructure_DIFFERENT_NONZERO_PATTERN;
        for (factor, term) in terms {
            call!(MAKING, MatAXPY(made.0, *factor, term.0, pattern))?;
        }
        Ok(made)
    }

    /// Creates `factor` times this matrix, plus another one, most of whose entries have room in it.
    pub(crate) fn plus_within(&self, factor: f64, other: &Matrix) -> Result<Self, LinearError> {
        let (made, option) = (self.plus(factor, &[])?, sys::MatOption_MAT_NEW_NONZERO_ALLOCATION_ERR);
        call!(MAKING, MatSetOption(made.0, option, sys::PetscBool_PETSC_FALSE))?;
        call!(MAKING, MatAXPY(made.0, 1.0, other.0, sys::MatStructure_SUBSET_NONZERO_PATTERN))?;
        Ok(made)
    }

    /// Creates `factor` times `leading`, in the first of these rows of this rank and none in the others, plus `rest`.
    /// The result is not assembled: it refers to both.
    pub(crate) fn beside(
        leading: &Matrix,
        factor: f64,
        places: [&[Int]; 2],
        rest: &Matrix,
    ) -> Result<Self, LinearError> {
        let [first, second] = places.map(IndexSet::new);
        let sets = [first?, second?];
        let sets = [sets[0].0, sets[1].0];
        let (none, mut wide, mut made) = (ptr::null_mut(), Matrix(ptr::null_mut()), Matrix(ptr::null_mut()));
        let blocks = [leading.0, none, none, none];
        let at = sets.as_ptr();
        call!(MAKING, MatCreateNest(comm(), 2, at, 2, at, blocks.as_ptr(), &raw mut wide.0))?;
        call!(MAKING, MatCreateComposite(comm(), 2, [wide.0, rest.0].as_ptr(), &raw mut made.0))?;
        call!(MAKING, MatCompositeSetScalings(made.0, [factor, 1.0].as_ptr()))?;
        Ok(made)
    }

    /// Creates the matrix of these rows and the columns of the same numbers, which any rank may ask for.
    pub(crate) fn within(&self, places: &[Int]) -> Result<Self, LinearError> {
        let (places, mut made) = (IndexSet::new(places)?, Matrix(ptr::null_mut()));
        let reuse = sys::MatReuse_MAT_INITIAL_MATRIX;
        call!(MAKING, MatCreateSubMatrix(self.0, places.0, places.0, reuse, &raw mut made.0))?;
        Ok(made)
    }

    /// Computes the product with another matrix.
    pub(crate) fn times(&self, other: &Matrix) -> Result<Self, LinearError> {
        let (mut made, reuse, fill) = (Matrix(ptr::null_mut()), sys::MatReuse_MAT_INITIAL_MATRIX, 1.0);
        call!("eliminating contact", MatMatMult(self.0, other.0, reuse, fill, &raw mut made.0))?;
        Ok(made)
    }

    /// Computes `y = A x`.
    pub(crate) fn apply(&self, x: &Vector, y: &Vector) -> Result<(), LinearError> {
        call!("a product", MatMult(self.0, x.0, y.0))
    }

    /// Returns the diagonal and the largest sizes of the rows in `to`.
    pub(crate) fn norms(&self, to: [&Vector; 2]) -> Result<(), LinearError> {
        call!("a product", MatGetDiagonal(self.0, to[0].0))?;
        call!("a product", MatGetRowMaxAbs(self.0, to[1].0, ptr::null_mut()))
    }

    /// Calls `take` with each row of this rank: its number in the whole, and its columns there with the values.
    pub(crate) fn each_row(&self, mut take: impl FnMut(Int, &[Int], &[f64])) -> Result<(), LinearError> {
        const STEP: &str = "the rows of a matrix";
        let (mut first, mut end) = (0, 0);
        call!(STEP, MatGetOwnershipRange(self.0, &raw mut first, &raw mut end))?;
        for row in first..end {
            let (mut many, mut columns, mut values) = (0, ptr::null(), ptr::null());
            call!(STEP, MatGetRow(self.0, row, &raw mut many, &raw mut columns, &raw mut values))?;
            if many > 0 {
                // SAFETY: PETSc lends arrays of this length until they are given back below.
                let (columns, values) = unsafe {
                    let many = many as usize;
                    (std::slice::from_raw_parts(columns, many), std::slice::from_raw_parts(values, many))
                };
                take(row, columns, values);
            }
            call!(STEP, MatRestoreRow(self.0, row, &raw mut many, &raw mut columns, &raw mut values))?;
        }
        Ok(())
    }

    /// Returns the number of rows of all ranks.
    pub(crate) fn size(&self) -> Result<Int, LinearError> {
        let (mut rows, mut columns) = (0, 0);
        call!("the rows of a matrix", MatGetSize(self.0, &raw mut rows, &raw mut columns))?;
        Ok(rows)
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

    /// Calls `work` with the entries on this rank.
    pub(crate) fn with<T>(&self, work: impl FnOnce(&mut [f64]) -> T) -> Result<T, LinearError> {
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

    /// Creates the way from all entries of `from` to a vector that every rank has whole.
    pub(crate) fn to_all(from: &Vector) -> Result<(Self, Vector), LinearError> {
        let (mut made, mut whole) = (Scatter(ptr::null_mut()), Vector(ptr::null_mut()));
        call!("sharing a vector", VecScatterCreateToAll(from.0, &raw mut made.0, &raw mut whole.0))?;
        Ok((made, whole))
    }

    /// Brings entries `from` one vector `to` the other.
    pub(crate) fn forward(&self, from: &Vector, to: &Vector) -> Result<(), LinearError> {
        self.bring(from, to, sys::ScatterMode_SCATTER_FORWARD)
    }

    /// Brings them back.
    pub(crate) fn back(&self, from: &Vector, to: &Vector) -> Result<(), LinearError> {
        self.bring(from, to, sys::ScatterMode_SCATTER_REVERSE)
    }

    fn bring(&self, from: &Vector, to: &Vector, mode: sys::ScatterMode) -> Result<(), LinearError> {
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

/// Returns the part of each row of this rank, one part for each rank, nearly equal and with few entries between them.
pub(crate) fn partition(graph: &Matrix, rows: usize) -> Result<Vec<usize>, LinearError> {
    const STEP: &str = "dealing the nodes among ranks";
    let (mut made, mut parts) = (Partitioning(ptr::null_mut()), IndexSet(ptr::null_mut()));
    call!(STEP, MatPartitioningCreate(comm(), &raw mut made.0))?;
    call!(STEP, MatPartitioningSetAdjacency(made.0, graph.0))?;
    call!(STEP, MatPartitioningSetFromOptions(made.0))?;
    call!(STEP, MatPartitioningApply(made.0, &raw mut parts.0))?;
    let mut numbers = ptr::null();
    call!(STEP, ISGetIndices(parts.0, &raw mut numbers))?;
    // SAFETY: the set has as many numbers as there are rows here, until it is destroyed.
    let part = (0..rows).map(|k| unsafe { *numbers.add(k) } as usize).collect();
    call!(STEP, ISRestoreIndices(parts.0, &raw mut numbers))?;
    Ok(part)
}
