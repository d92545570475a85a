//! The objects of PETSc that this crate uses, distributed over all ranks. Calls are collective: every rank makes the
//! same ones, under the lock of `ranks`.

#![allow(unsafe_code)]

mod exchange;
mod solver;
mod start;
mod sys;

use std::{ptr, slice};

use stickslip::algebra::linear::LinearError;

pub(crate) use exchange::Exchange;
pub(crate) use solver::{Cycle, Krylov};
use start::check;
pub(crate) use start::{check_options, end, has, set, start};
pub(crate) use sys::PetscInt as Int;

/// Calls a function of PETSc, and converts its status.
macro_rules! call {
    ($step:expr, $function:ident($($argument:expr),* $(,)?)) => {{
        // SAFETY: PETSc runs, or starts by this call. All handles are of objects of this module, which own them; the
        // length of every array is that of its slice, or callers compare it before; and the lock of `ranks` keeps other
        // threads away.
        let status = unsafe { $crate::petsc::sys::$function($($argument),*) };
        $crate::petsc::check($step, status)
    }};
}
use call;

/// Calls a function of PETSc whose last argument takes a new object, and returns the object.
macro_rules! make {
    ($step:expr, $function:ident($($argument:expr),* $(,)?)) => {{
        let mut made = $crate::petsc::Object(std::ptr::null_mut());
        $crate::petsc::call!($step, $function($($argument,)* &raw mut made.0))?;
        made
    }};
}
use make;

/// The owner of an object of PETSc.
pub(crate) struct Object<T>(*mut T);

// SAFETY: PETSc's objects belong to a process, without thread affinity, and callers hold the lock of `ranks`.
unsafe impl<T> Send for Object<T> {}
// SAFETY: as above; no two threads use an object at a time.
unsafe impl<T> Sync for Object<T> {}

impl<T> Drop for Object<T> {
    fn drop(&mut self) {
        // SAFETY: the handle is ours, or null, which PETSc ignores, and is not used again.
        unsafe { sys::PetscObjectDestroy((&raw mut self.0).cast()) };
    }
}

/// A sparse square matrix.
pub(crate) type Matrix = Object<sys::_p_Mat>;
/// A vector.
pub(crate) type Vector = Object<sys::_p_Vec>;

/// Entries of a matrix: rows and columns in the whole, and values. Those of the same place are added.
#[derive(Default, Clone)]
pub(crate) struct Entries {
    pub rows: Vec<Int>,
    pub columns: Vec<Int>,
    pub values: Vec<f64>,
}

impl Entries {
    pub(crate) fn push(&mut self, row: Int, column: Int, value: f64) {
        self.rows.push(row);
        self.columns.push(column);
        self.values.push(value);
    }
}

/// Converts a number to PETSc's integers.
pub(crate) fn int(n: usize) -> Result<Int, LinearError> {
    Int::try_from(n).map_err(|_| LinearError::OutOfMemory { step: "PETSc, whose indices have 32 bits" })
}

fn comm() -> sys::MPI_Comm {
    // SAFETY: PETSc sets it when it starts, before any object is made.
    unsafe { sys::PETSC_COMM_WORLD }
}

/// Returns the array of this length at `first`, which may be null if it is empty.
unsafe fn lent<'a, T>(first: *const T, length: Int) -> &'a [T] {
    // SAFETY: as the caller says.
    if length == 0 { &[] } else { unsafe { slice::from_raw_parts(first, length as usize) } }
}

const ALL: Int = sys::PETSC_DETERMINE;
const MAKING: &str = "making a matrix";
const ELIMINATING: &str = "eliminating contact";

impl Matrix {
    /// Creates the matrix of these entries of any rank, with this number of rows on this rank.
    pub(crate) fn of(rows: usize, mut entries: Entries) -> Result<Self, LinearError> {
        let (made, count) = (make!(MAKING, MatCreate(comm())), entries.values.len() as sys::PetscCount);
        call!(MAKING, MatSetSizes(made.0, int(rows)?, int(rows)?, ALL, ALL))?;
        call!(MAKING, MatSetType(made.0, c"aij".as_ptr()))?;
        let [rows, columns] = [&mut entries.rows, &mut entries.columns].map(Vec::as_mut_ptr);
        call!(MAKING, MatSetPreallocationCOO(made.0, count, rows, columns))?;
        made.set(&entries.values)?;
        Ok(made)
    }

    /// Sets the sums of these values at the places of [`Matrix::of`], which are as many.
    pub(crate) fn set(&self, values: &[f64]) -> Result<(), LinearError> {
        call!(MAKING, MatSetValuesCOO(self.0, values.as_ptr(), sys::InsertMode_INSERT_VALUES))
    }

    /// Creates `factor` times `first` plus `other`, which products with vectors compute each time.
    pub(crate) fn sum(factor: f64, first: &Matrix, other: &Matrix) -> Result<Self, LinearError> {
        let made = make!(MAKING, MatCreateComposite(comm(), 2, [first.0, other.0].as_ptr()));
        call!(MAKING, MatCompositeSetScalings(made.0, [factor, 1.0].as_ptr()))?;
        Ok(made)
    }

    /// Computes such a sum.
    pub(crate) fn merged(self) -> Result<Self, LinearError> {
        call!(MAKING, MatCompositeMerge(self.0)).map(|()| self)
    }

    /// Sets `factor` times `first` plus `other`, for whose entries it has room.
    pub(crate) fn set_sum(&self, factor: f64, first: &Matrix, other: &Matrix) -> Result<(), LinearError> {
        call!(MAKING, MatZeroEntries(self.0))?;
        call!(MAKING, MatAXPY(self.0, factor, first.0, sys::MatStructure_SUBSET_NONZERO_PATTERN))?;
        self.add(other)
    }

    /// Adds a matrix for whose entries this one has room.
    pub(crate) fn add(&self, other: &Matrix) -> Result<(), LinearError> {
        call!(MAKING, MatAXPY(self.0, 1.0, other.0, sys::MatStructure_SUBSET_NONZERO_PATTERN))
    }

    /// Creates a copy, which does not know [`Matrix::set`].
    pub(crate) fn copy(&self) -> Result<Self, LinearError> {
        Ok(make!(MAKING, MatDuplicate(self.0, sys::MatDuplicateOption_MAT_COPY_VALUES)))
    }

    /// Adds `factor` times another matrix.
    pub(crate) fn plus(self, factor: f64, other: &Matrix) -> Result<Self, LinearError> {
        call!(MAKING, MatAXPY(self.0, factor, other.0, sys::MatStructure_DIFFERENT_NONZERO_PATTERN)).map(|()| self)
    }

    /// Computes the product with another matrix.
    pub(crate) fn times(&self, other: &Matrix) -> Result<Self, LinearError> {
        Ok(make!(ELIMINATING, MatMatMult(self.0, other.0, sys::MatReuse_MAT_INITIAL_MATRIX, 1.0)))
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

    /// Calls `take` with each row of this rank: its columns in the whole with the values.
    pub(crate) fn each_row(&self, mut take: impl FnMut(&[Int], &[f64])) -> Result<(), LinearError> {
        const STEP: &str = "the rows of a matrix";
        let (mut first, mut end) = (0, 0);
        call!(STEP, MatGetOwnershipRange(self.0, &raw mut first, &raw mut end))?;
        for row in first..end {
            let (mut many, mut columns, mut values) = (0, ptr::null(), ptr::null());
            call!(STEP, MatGetRow(self.0, row, &raw mut many, &raw mut columns, &raw mut values))?;
            // SAFETY: PETSc lends arrays of this length until they are given back below.
            unsafe { take(lent(columns, many), lent(values, many)) };
            call!(STEP, MatRestoreRow(self.0, row, &raw mut many, &raw mut columns, &raw mut values))?;
        }
        Ok(())
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
        let made = make!(STEP, VecCreate(comm()));
        call!(STEP, VecSetSizes(made.0, int(entries)?, ALL))?;
        call!(STEP, VecSetType(made.0, c"standard".as_ptr()))?;
        Ok(made)
    }

    /// Calls `work` with the entries on this rank.
    pub(crate) fn with<T>(&self, work: impl FnOnce(&mut [f64]) -> T) -> Result<T, LinearError> {
        const STEP: &str = "the entries of a vector";
        let (mut first, mut many) = (ptr::null_mut(), 0);
        call!(STEP, VecGetLocalSize(self.0, &raw mut many))?;
        call!(STEP, VecGetArray(self.0, &raw mut first))?;
        // SAFETY: PETSc lends an array of the local size until it is given back below.
        let result = work(if many == 0 { &mut [] } else { unsafe { slice::from_raw_parts_mut(first, many as usize) } });
        call!(STEP, VecRestoreArray(self.0, &raw mut first))?;
        Ok(result)
    }
}

/// Returns the part of each row of this rank, one part for each rank, nearly equal and with few entries between them.
pub(crate) fn partition(graph: &Matrix, rows: usize) -> Result<Vec<usize>, LinearError> {
    const STEP: &str = "dealing the nodes among ranks";
    let made = make!(STEP, MatPartitioningCreate(comm()));
    call!(STEP, MatPartitioningSetAdjacency(made.0, graph.0))?;
    call!(STEP, MatPartitioningSetFromOptions(made.0))?;
    let (parts, mut numbers) = (make!(STEP, MatPartitioningApply(made.0)), ptr::null());
    call!(STEP, ISGetIndices(parts.0, &raw mut numbers))?;
    // SAFETY: the set has as many numbers as there are rows here, until it is destroyed.
    let part = unsafe { lent(numbers, int(rows)?) }.iter().map(|part| *part as usize).collect();
    call!(STEP, ISRestoreIndices(parts.0, &raw mut numbers))?;
    Ok(part)
}
