//! UMFPACK, SuiteSparse's unsymmetric multifrontal LU, with settings for the uncondensed contact Jacobian.
//!
//! The pattern of that Jacobian is almost symmetric, and its diagonal entries are almost always suitable pivots, so
//! the symmetric strategy is forced. The automatic choice would take the unsymmetric strategy if it sees no values,
//! and removing singletons first would silently have the same effect. Refinement is left to [`super::RefinedSolver`].

#![allow(unsafe_code)]

use std::ffi::c_void;
use std::ptr::{self, NonNull};
use std::sync::Arc;

use super::process::blas::blas_buffer;
use super::{Computed, FactorInfo, LinearError, LinearSolver, expect_length, ordering, sys, versions};
use crate::algebra::sparse::Pattern;

const CONTROL: usize = sys::UMFPACK_CONTROL as usize;
const INFO: usize = sys::UMFPACK_INFO as usize;
type Control = [f64; CONTROL];
type Info = [f64; INFO];

// The bindings pass `Pattern`'s indices by pointer: C's 64-bit index must be exactly i64.
const _: () = assert!(size_of::<std::ffi::c_long>() == size_of::<i64>(), "UMFPACK's long must have 64 bits");

/// The strategy of UMFPACK for orderings and pivots.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Strategy {
    /// Orders A + Aᵀ and prefers diagonal pivots: the choice for contact Jacobians.
    #[default]
    Symmetric,
    /// The symmetric strategy in the best of several orders, which take longer to find: for many factorisations in
    /// the plane.
    SymmetricInBestOrder,
    /// All defaults of UMFPACK, including its own refinement, for comparisons.
    Automatic,
}

/// A function that releases one kind of UMFPACK object.
type Free = unsafe extern "C" fn(*mut *mut c_void);

/// The owner of an object that UMFPACK allocated; frees it when dropped.
struct Owned {
    object: NonNull<c_void>,
    free: Free,
}

impl Drop for Owned {
    fn drop(&mut self) {
        let mut object = self.object.as_ptr();
        // SAFETY: `object` came from UMFPACK together with the matching `free`, is owned by `self`
        // alone and never used again.
        unsafe { (self.free)(&raw mut object) }
    }
}

// SAFETY: the object is plain heap memory without thread affinity, and `Owned` is its only owner.
unsafe impl Send for Owned {}

/// The UMFPACK backend.
pub struct Umfpack {
    strategy: Strategy,
    /// The settings, set by the analysis.
    control: Control,
    pattern: Option<Arc<Pattern>>,
    /// The factored values, kept only if UMFPACK's own refinement needs them.
    values: Vec<f64>,
    symbolic: Option<Owned>,
    numeric: Option<Owned>,
    index_work: Vec<i64>,
    work: Vec<f64>,
}

impl Default for Umfpack {
    fn default() -> Self {
        Self::new(Strategy::Symmetric)
    }
}

impl Umfpack {
    /// Creates a solver with the given strategy.
    pub fn new(strategy: Strategy) -> Self {
        Umfpack {
            strategy,
            control: [0.0; CONTROL],
            pattern: None,
            values: Vec::new(),
            symbolic: None,
            numeric: None,
            index_work: Vec::new(),
            work: Vec::new(),
        }
    }

    /// Returns `true` if UMFPACK refines its solutions itself.
    fn refines(&self) -> bool {
        self.control[sys::UMFPACK_IRSTEP as usize] > 0.0
    }

    /// Runs [`LinearSolver::analyze`] with the values for the automatic strategy.
    ///
    /// # Errors
    /// As [`LinearSolver::analyze`].
    pub fn analyze_with(&mut self, pattern: &Arc<Pattern>, values: Option<&[f64]>) -> Computed<()> {
        const STEP: &str = "the symbolic analysis";
        let n = pattern.columns();
        expect_length("rows of the matrix", n, pattern.rows())?;
        if let Some(values) = values {
            expect_length("values of the matrix", pattern.len(), values.len())?;
        }
        versions::agree()?;
        self.numeric = None;
        self.symbolic = None;
        self.control = control(self.strategy);
        let mut info: Info = [0.0; INFO];
        let mut symbolic = ptr::null_mut();
        let _alone = ordering::alone();
        // SAFETY: `pattern` holds n + 1 column starts and the row indices they span, `values` is
        // null or as long as those; `control` and `info` have the lengths UMFPACK prescribes.
        let status = unsafe {
            sys::umfpack_dl_symbolic(
                n as i64,
                n as i64,
                pattern.column_starts().as_ptr(),
                pattern.row_indices().as_ptr(),
                values.map_or(ptr::null(), <[f64]>::as_ptr),
                &raw mut symbolic,
                self.control.as_ptr(),
                info.as_mut_ptr(),
            )
        };
        let symbolic = NonNull::new(symbolic).map(|object| Owned { object, free: sys::umfpack_dl_free_symbolic });
        check(status, STEP, 0.0)?;
        self.symbolic = symbolic;
        self.pattern = Some(Arc::clone(pattern));
        self.index_work = vec![0; n];
        self.work = vec![0.0; if self.refines() { 5 * n } else { n }];
        Ok(())
    }
}

/// Returns the settings of a strategy.
fn control(strategy: Strategy) -> Control {
    let mut control = [0.0; CONTROL];
    // SAFETY: the array has the UMFPACK_CONTROL entries the call fills.
    unsafe { sys::umfpack_dl_defaults(control.as_mut_ptr()) };
    if strategy != Strategy::Automatic {
        control[sys::UMFPACK_STRATEGY as usize] = f64::from(sys::UMFPACK_STRATEGY_SYMMETRIC);
        control[sys::UMFPACK_SINGLETONS as usize] = 0.0;
        // Nested dissection. Against AMD 17 % less fill on squares at n = 100 and 41 % at n = 400, 28 % on cubes at
        // n = 16, in half the time, and 41 % at n = 24, in 0.97 GB instead of 2.18. UMFPACK's "best of all"
        // fills 1 % more at n = 16, CHOLMOD's choice there is METIS.
        let one = strategy == Strategy::Symmetric;
        let ordering = if one { sys::UMFPACK_ORDERING_METIS } else { sys::UMFPACK_ORDERING_BEST };
        control[sys::UMFPACK_ORDERING as usize] = f64::from(ordering);
        control[sys::UMFPACK_IRSTEP as usize] = 0.0;
    }
    control
}

impl LinearSolver for Umfpack {
    fn name(&self) -> &'static str {
        "umfpack"
    }

    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Computed<()> {
        self.analyze_with(pattern, None)
    }

    fn factorize(&mut self, values: &[f64]) -> Computed<FactorInfo> {
        const STEP: &str = "the factorisation";
        let (Some(pattern), Some(symbolic)) = (&self.pattern, &self.symbolic) else {
            return Err(LinearError::Order { missing: "analyze" });
        };
        expect_length("values of the matrix", pattern.len(), values.len())?;
        blas_buffer::prepare()?;
        // The old factors are dropped first: keeping both would double the peak memory.
        self.numeric = None;
        let mut info: Info = [0.0; INFO];
        let mut numeric = ptr::null_mut();
        // SAFETY: the arrays are those of the analysed pattern and as long as it says; `symbolic`
        // is alive; `control` and `info` have the lengths UMFPACK prescribes.
        let status = unsafe {
            sys::umfpack_dl_numeric(
                pattern.column_starts().as_ptr(),
                pattern.row_indices().as_ptr(),
                values.as_ptr(),
                symbolic.object.as_ptr(),
                &raw mut numeric,
                self.control.as_ptr(),
                info.as_mut_ptr(),
            )
        };
        let numeric = NonNull::new(numeric).map(|object| Owned { object, free: sys::umfpack_dl_free_numeric });
        let pivot_ratio = info[sys::UMFPACK_RCOND as usize];
        check(status, STEP, pivot_ratio)?;
        self.numeric = numeric;
        if self.refines() {
            self.values.clear();
            self.values.extend_from_slice(values);
        }
        Ok(FactorInfo {
            entries: (info[sys::UMFPACK_LNZ as usize] + info[sys::UMFPACK_UNZ as usize]) as usize,
            flops: info[sys::UMFPACK_FLOPS as usize],
            pivot_ratio,
            peak_bytes: info[sys::UMFPACK_PEAK_MEMORY as usize] * info[sys::UMFPACK_SIZE_OF_UNIT as usize],
        })
    }

    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Computed<()> {
        const STEP: &str = "the solve";
        let (Some(pattern), Some(numeric)) = (&self.pattern, &self.numeric) else {
            return Err(LinearError::Order { missing: "factorize" });
        };
        let n = pattern.columns();
        expect_length("right-hand side", n, b.len())?;
        expect_length("solution", n, x.len())?;
        let mut info: Info = [0.0; INFO];
        #[allow(clippy::cast_lossless)] // The argument is a long in 5.x and an int in 7.x.
        let system = sys::UMFPACK_A as _;
        // SAFETY: the matrix is the one factored; its values, empty without refinement, are then
        // not read. `b` and `x` have n entries, the work arrays n and, with refinement, 5 n;
        // `numeric` is alive.
        let status = unsafe {
            sys::umfpack_dl_wsolve(
                system,
                pattern.column_starts().as_ptr(),
                pattern.row_indices().as_ptr(),
                self.values.as_ptr(),
                x.as_mut_ptr(),
                b.as_ptr(),
                numeric.object.as_ptr(),
                self.control.as_ptr(),
                info.as_mut_ptr(),
                self.index_work.as_mut_ptr(),
                self.work.as_mut_ptr(),
            )
        };
        check(status, STEP, info[sys::UMFPACK_RCOND as usize])
    }
}

/// Maps every status but 0 to an error: even the warning "singular" leaves Inf and NaN behind. The status is a long
/// in 5.x and an int in 7.x.
fn check(status: impl Into<i64>, step: &'static str, pivot_ratio: f64) -> Computed<()> {
    const OK: i64 = sys::UMFPACK_OK as i64;
    const SINGULAR: i64 = sys::UMFPACK_WARNING_singular_matrix as i64;
    const OUT_OF_MEMORY: i64 = sys::UMFPACK_ERROR_out_of_memory as i64;
    // The orderings accept every valid pattern, so this failure of METIS means lack of memory.
    const NOT_ORDERED: i64 = sys::UMFPACK_ERROR_ordering_failed as i64;
    const DIFFERENT_PATTERN: i64 = sys::UMFPACK_ERROR_different_pattern as i64;
    match status.into() {
        OK => Ok(()),
        SINGULAR => Err(LinearError::Singular { pivot_ratio }),
        OUT_OF_MEMORY | NOT_ORDERED => Err(LinearError::OutOfMemory { step }),
        DIFFERENT_PATTERN => Err(LinearError::PatternChanged),
        status => Err(LinearError::Backend { backend: "umfpack", step, status }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern(entries: &[(usize, usize)], n: usize) -> Arc<Pattern> {
        Arc::new(Pattern::from_entries(n, n, |take| entries.iter().for_each(|&(i, j)| take(i, j))).unwrap())
    }

    #[test]
    fn factors_and_solves() {
        let pattern = pattern(&[(0, 0), (1, 0), (0, 1), (1, 1)], 2);
        let mut solver = Umfpack::default();
        solver.analyze(&pattern).unwrap();
        let mut x = [0.0; 2];
        for scale in [1.0, 3.0] {
            // Column-wise [[2, 1], [4, 3]] with right-hand side [4, 10]: x = [1, 2].
            let values = [2.0, 4.0, 1.0, 3.0].map(|v| v * scale);
            let info = solver.factorize(&values).unwrap();
            assert!(info.entries >= 4);
            solver.solve(&[4.0 * scale, 10.0 * scale], &mut x).unwrap();
            assert!((x[0] - 1.0).abs() < 1e-14 && (x[1] - 2.0).abs() < 1e-14, "{x:?}");
        }
    }

    #[test]
    fn every_misuse_has_its_error() {
        let pattern = pattern(&[(0, 0), (1, 1)], 2);
        let mut solver = Umfpack::default();
        let mut x = [0.0; 2];
        assert_eq!(solver.factorize(&[1.0, 1.0]), Err(LinearError::Order { missing: "analyze" }));
        solver.analyze(&pattern).unwrap();
        assert_eq!(solver.solve(&[1.0, 1.0], &mut x), Err(LinearError::Order { missing: "factorize" }));
        assert!(matches!(solver.factorize(&[1.0]), Err(LinearError::Shape { expected: 2, found: 1, .. })));
        assert!(matches!(solver.factorize(&[1.0, 0.0]), Err(LinearError::Singular { .. })));
        // A failed factorisation leaves no old factors behind.
        assert_eq!(solver.solve(&[1.0, 1.0], &mut x), Err(LinearError::Order { missing: "factorize" }));
        let wide = Arc::new(Pattern::from_entries(1, 2, |take| take(0, 1)).unwrap());
        assert!(matches!(solver.analyze(&wide), Err(LinearError::Shape { .. })));
    }

    #[test]
    fn statuses_map_to_errors() {
        let map = |status| check(status, "a test", 0.5);
        assert_eq!(map(0), Ok(()));
        assert_eq!(map(1), Err(LinearError::Singular { pivot_ratio: 0.5 }));
        for refused in [-1, -18] {
            assert_eq!(map(refused), Err(LinearError::OutOfMemory { step: "a test" }));
        }
        assert_eq!(map(-11), Err(LinearError::PatternChanged));
        assert!(matches!(map(-911), Err(LinearError::Backend { status: -911, .. })));
    }
}
