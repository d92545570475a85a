//! CHOLMOD, SuiteSparse's supernodal Cholesky: calls and memory. For the meaning of the factors see
//! [`super::Cholesky`].

#![allow(unsafe_code)]

use std::ffi::{c_int, c_void};
use std::ptr::{self, NonNull};

use super::process::blas::blas_buffer;
use super::supernodal::{Supernodal, Supernode};
use super::{Computed, FactorInfo, LinearError, ordering, sys, versions};
use crate::algebra::sparse::{Csc, Pattern};

// The bindings pass `Pattern`'s indices by pointer: C's 64-bit index must be exactly i64.
const _: () = assert!(size_of::<std::ffi::c_long>() == size_of::<i64>(), "CHOLMOD's long must have 64 bits");

/// The value of true in C.
const TRUE: c_int = 1;
const FALSE: c_int = 0;

/// The settings, statistics and workspace of CHOLMOD, which every call needs.
pub(super) struct Session {
    /// A pointer from a box. It must not move, because CHOLMOD keeps pointers into it.
    common: NonNull<sys::cholmod_common>,
}

impl Session {
    /// Creates a session without output that leaves `L` supernodal.
    pub(super) fn new() -> Computed<Self> {
        versions::agree()?;
        // SAFETY: integers, floats, pointers and optional functions, all of which may be zero.
        let mut common: Box<sys::cholmod_common> = Box::new(unsafe { std::mem::zeroed() });
        // SAFETY: the call writes defaults into the structure and allocates nothing outside it.
        let started = unsafe { sys::cholmod_l_start(&raw mut *common) };
        if started != TRUE {
            return Err(LinearError::Backend { backend: "cholmod", step: "the start", status: common.status.into() });
        }
        common.print = 0;
        common.error_handler = None;
        common.final_ll = TRUE;
        common.quick_return_if_not_posdef = TRUE;
        Ok(Session { common: NonNull::from(Box::leak(common)) })
    }

    /// Returns the settings and statistics.
    fn common(&self) -> &sys::cholmod_common {
        // SAFETY: alive as long as `self`; C writes to it only during calls, when no reference of
        // ours exists, since none leaves this file.
        unsafe { self.common.as_ref() }
    }

    /// Returns the settings for changing them.
    fn common_mut(&mut self) -> &mut sys::cholmod_common {
        // SAFETY: alive as long as `self`, and borrowed as exclusively as `self` is.
        unsafe { self.common.as_mut() }
    }

    /// Converts the status of the last call to an error.
    fn check(&self, step: &'static str) -> Computed<()> {
        const OK: c_int = sys::CHOLMOD_OK as c_int;
        const NOT_POSITIVE_DEFINITE: c_int = sys::CHOLMOD_NOT_POSDEF as c_int;
        const OUT_OF_MEMORY: c_int = sys::CHOLMOD_OUT_OF_MEMORY as c_int;
        match self.common().status {
            OK => Ok(()),
            // The pivot that ended the factorisation is zero or less.
            NOT_POSITIVE_DEFINITE => Err(LinearError::Singular { pivot_ratio: 0.0 }),
            OUT_OF_MEMORY => Err(LinearError::OutOfMemory { step }),
            status => Err(LinearError::Backend { backend: "cholmod", step, status: status.into() }),
        }
    }

    /// Returns a fill-reducing, postordered permutation for a symmetric matrix with this lower triangle: minimum
    /// degree, or, if METIS is available and minimum degree has much fill, nested dissection.
    pub(super) fn order(&mut self, lower: &Pattern) -> Computed<Vec<usize>> {
        let common = self.common_mut();
        // CHOLMOD's own strategy: these factors are computed once, so the time for ordering counts. On plane grids of
        // 200² and 400² nodes METIS took 5 to 16 times as long as AMD and the whole 1.5 to 3 times as long, to save 2
        // to 6 % of the fill; on solid grids the strategy chose METIS.
        common.nmethods = 0;
        common.postorder = TRUE;
        // Supernodes are not needed for this block alone.
        common.supernodal = sys::CHOLMOD_SIMPLICIAL as c_int;
        let mut matrix = sparse(lower, None);
        let _alone = ordering::alone();
        // SAFETY: `matrix` describes the arrays of `lower`, which CHOLMOD reads only; the session
        // is alive.
        let factor = unsafe { sys::cholmod_l_analyze(&raw mut matrix, self.common.as_ptr()) };
        let Some(mut factor) = NonNull::new(factor).map(NonNull::as_ptr) else {
            return Err(self.failure("the ordering"));
        };
        // SAFETY: a factor of order n holds a permutation of n long integers; it is copied before
        // the factor is freed.
        unsafe {
            let permutation = slice::<i64>((*factor).Perm, (*factor).n).iter().map(|&k| k as usize).collect();
            sys::cholmod_l_free_factor(&raw mut factor, self.common.as_ptr());
            Ok(permutation)
        }
    }

    /// Returns the entries and operations of the factor that was analysed last.
    pub(super) fn predicted(&self) -> FactorInfo {
        let common = self.common();
        FactorInfo { entries: common.lnz as usize, flops: common.fl, ..FactorInfo::default() }
    }

    /// Factors the symmetric matrix with this lower triangle in the given order.
    pub(super) fn factor(mut self, lower: &Csc, order: &[usize]) -> Computed<Factor> {
        blas_buffer::prepare()?;
        let mut permutation: Vec<i64> = order.iter().map(|&unknown| unknown as i64).collect();
        let common = self.common_mut();
        common.nmethods = 1;
        common.method[0].ordering = sys::CHOLMOD_GIVEN as c_int;
        common.postorder = FALSE;
        // Supernodal even if simplicial factors would be faster, so that there is only one format to read.
        common.supernodal = sys::CHOLMOD_SUPERNODAL as c_int;
        let mut matrix = sparse(lower.pattern(), Some(lower.values()));
        // SAFETY: `matrix` describes the arrays of `lower` and `permutation` has an entry for each
        // column, all of which CHOLMOD reads only; no subset of columns is passed.
        let factor = unsafe {
            sys::cholmod_l_analyze_p(
                &raw mut matrix,
                permutation.as_mut_ptr(),
                ptr::null_mut(),
                0,
                self.common.as_ptr(),
            )
        };
        let Some(l) = NonNull::new(factor) else {
            return Err(self.failure("the symbolic analysis"));
        };
        let factor = Factor { session: self, l };
        // SAFETY: the same matrix, the factor it was analysed for, the session that made it.
        unsafe { sys::cholmod_l_factorize(&raw mut matrix, factor.l.as_ptr(), factor.session.common.as_ptr()) };
        factor.session.check("the factorisation")?;
        let raw = factor.get();
        if raw.is_super == FALSE || raw.xtype != sys::CHOLMOD_REAL as c_int {
            return Err(LinearError::Backend { backend: "cholmod", step: "the form of the factors", status: 0 });
        }
        // SAFETY: a factor of order n holds a permutation of n long integers.
        let kept: &[i64] = unsafe { slice(raw.Perm, raw.n) };
        // The factors are read in this order, so it is verified.
        if kept != permutation {
            return Err(LinearError::Backend { backend: "cholmod", step: "keeping the given order", status: 0 });
        }
        Ok(factor)
    }

    /// Returns the error of a call that returned nothing.
    fn failure(&self, step: &'static str) -> LinearError {
        let status = self.common().status.into();
        self.check(step).err().unwrap_or(LinearError::Backend { backend: "cholmod", step, status })
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        // SAFETY: the session was started, came from a box and is not used again; what it allocated
        // besides its own workspace, `Factor` has freed before.
        unsafe {
            sys::cholmod_l_finish(self.common.as_ptr());
            drop(Box::from_raw(self.common.as_ptr()));
        }
    }
}

/// Numeric supernodal factors, the only owner of all their CHOLMOD memory.
pub(super) struct Factor {
    session: Session,
    /// `L`, with its order and supernodes.
    l: NonNull<sys::cholmod_factor>,
}

// SAFETY: plain heap memory without thread affinity, of which `Factor` is the only owner.
unsafe impl Send for Factor {}
// SAFETY: through `&Factor` the memory is only read.
unsafe impl Sync for Factor {}

impl Factor {
    fn get(&self) -> &sys::cholmod_factor {
        // SAFETY: alive as long as `self`; CHOLMOD changes a factor only when it factorises.
        unsafe { self.l.as_ref() }
    }
}

impl Supernodal for Factor {
    fn len(&self) -> usize {
        self.get().nsuper
    }

    fn supernode(&self, k: usize) -> Supernode<'_> {
        let raw = self.get();
        let starts = raw.nsuper + 1;
        // SAFETY: the lengths and types are those CHOLMOD documents for a numeric supernodal factor,
        // which `Session::factor` has checked this is.
        let (first, row_starts, value_starts, rows, values) = unsafe {
            (
                slice::<i64>(raw.super_, starts),
                slice::<i64>(raw.pi, starts),
                slice::<i64>(raw.px, starts),
                slice::<i64>(raw.s, raw.ssize),
                slice::<f64>(raw.x, raw.xsize),
            )
        };
        // The first rows are those of the columns themselves.
        let rows = &rows[row_starts[k] as usize..row_starts[k + 1] as usize];
        let (first, columns) = (first[k] as usize, (first[k + 1] - first[k]) as usize);
        let start = value_starts[k] as usize;
        Supernode { first, columns, below: &rows[columns..], values: &values[start..start + columns * rows.len()] }
    }

    fn info(&self) -> FactorInfo {
        FactorInfo { peak_bytes: self.session.common().memory_usage as f64, ..self.session.predicted() }
    }
}

impl Drop for Factor {
    fn drop(&mut self) {
        let mut factor = self.l.as_ptr();
        // SAFETY: the factor came from this session, which is dropped after it, and is not used again.
        unsafe { sys::cholmod_l_free_factor(&raw mut factor, self.session.common.as_ptr()) };
    }
}

/// Returns a description of a symmetric matrix by its lower triangle, or of its pattern if there are no `values`.
fn sparse(lower: &Pattern, values: Option<&[f64]>) -> sys::cholmod_sparse {
    let xtype = if values.is_some() { sys::CHOLMOD_REAL } else { sys::CHOLMOD_PATTERN };
    sys::cholmod_sparse {
        nrow: lower.rows(),
        ncol: lower.columns(),
        nzmax: lower.len(),
        p: lower.column_starts().as_ptr().cast_mut().cast(),
        i: lower.row_indices().as_ptr().cast_mut().cast(),
        nz: ptr::null_mut(),
        x: values.map_or(ptr::null_mut(), |values| values.as_ptr().cast_mut().cast()),
        z: ptr::null_mut(),
        stype: -1,
        itype: sys::CHOLMOD_LONG as c_int,
        xtype: xtype as c_int,
        dtype: sys::CHOLMOD_DOUBLE as c_int,
        sorted: TRUE,
        packed: TRUE,
    }
}

/// Returns a C array as a slice; null is empty.
///
/// # Safety
/// `array` is null or holds `length` values of type `T` that are not written to during `'a`.
unsafe fn slice<'a, T>(array: *mut c_void, length: usize) -> &'a [T] {
    if array.is_null() {
        return &[];
    }
    // SAFETY: the caller guarantees this.
    unsafe { std::slice::from_raw_parts(array.cast(), length) }
}
