//! The errors of linear solvers.

/// An error of a linear solver, after which the run cannot continue with this matrix.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinearError {
    /// A pivot is exactly zero.
    #[error("the matrix is singular (smallest over largest pivot: {pivot_ratio:.1e})")]
    Singular {
        /// The ratio of the smallest to the largest pivot.
        pivot_ratio: f64,
    },
    /// The solution has NaN or an infinity although every pivot was accepted.
    #[error("the solution of the linear system is not finite")]
    NotFinite,
    /// The solution is further from one than the question asked of it bears.
    #[error("the linear system is solved badly (backward error {backward_error:.1e})")]
    Inaccurate {
        /// The componentwise backward error.
        backward_error: f64,
    },
    /// The backend could not get the memory it needs.
    #[error("out of memory in {step}")]
    OutOfMemory {
        /// The step that failed.
        step: &'static str,
    },
    /// The pattern differs from the analysed one.
    #[error("the matrix has another pattern than the one analysed")]
    PatternChanged,
    /// The matrix is not square, or an array has the wrong length.
    #[error("{what}: expected length {expected}, got {found}")]
    Shape {
        /// The array or dimension.
        what: &'static str,
        /// The required length.
        expected: usize,
        /// The given length.
        found: usize,
    },
    /// `factorize` was called before `analyze`, or `solve` before `factorize`.
    #[error("{missing} must be called first")]
    Order {
        /// The step that is missing.
        missing: &'static str,
    },
    /// The solver factors the stiffness apart, and the matrix does not say which unknowns are displacements.
    #[error(
        "the solver \"partial\" must know which unknowns are displacements: create the matrix with \
         SystemMatrix::with_displacements, or use another solver"
    )]
    UnknownDisplacements,
    /// The cargo feature of the backend is off.
    #[error("this build has no {backend}")]
    NotBuiltIn {
        /// The missing backend.
        backend: &'static str,
    },
    /// A process that shares this work has failed, or this process has left it, so that the others no longer answer.
    #[error("a rank has failed before, and the ranks can no longer work together: start the program again")]
    RankFailed,
    /// The loaded C library is not the one whose headers were compiled in. None of its functions was called.
    #[error(
        "{library} {} is loaded, but this was built with the headers of {}: rebuild it here, or let LD_LIBRARY_PATH lead to \
         the library that it was built with",
        dotted(.loaded),
        dotted(.built)
    )]
    Version {
        /// The name of the library.
        library: &'static str,
        /// The version of the headers, `[main, sub, subsub]`.
        built: [i32; 3],
        /// The loaded version.
        loaded: [i32; 3],
    },
    /// Another status of a backend.
    #[error("{backend} failed in {step} with status {status}")]
    Backend {
        /// The name of the backend.
        backend: &'static str,
        /// The step that failed.
        step: &'static str,
        /// The status code.
        status: i64,
    },
}

/// Formats a version.
fn dotted([main, sub, subsub]: &[i32; 3]) -> String {
    format!("{main}.{sub}.{subsub}")
}

/// Returns an error unless both lengths agree.
pub(super) fn expect_length(what: &'static str, expected: usize, found: usize) -> Result<(), LinearError> {
    if expected == found { Ok(()) } else { Err(LinearError::Shape { what, expected, found }) }
}

/// Returns an error if one of `values` is NaN or infinite.
#[cfg(any(feature = "umfpack", feature = "faer"))]
pub(super) fn expect_finite(values: &[f64]) -> Result<(), LinearError> {
    if values.iter().all(|value| value.is_finite()) { Ok(()) } else { Err(LinearError::NotFinite) }
}
