//! The loaded BLAS, its active kernel, and the best kernel for the processor.
//!
//! OpenBLAS has kernels for many processors and chooses among them when it is loaded. A version older than the
//! processor may not recognise it and then uses the oldest kernels, which are four times slower. [`KERNEL_VARIABLE`]
//! selects others when the library is loaded: the program starts itself again with it.

#[cfg(feature = "blas")]
pub(in crate::algebra::linear) mod blas_buffer;
#[cfg(feature = "blas")]
mod kernel;
#[cfg(feature = "blas")]
pub(super) mod loaded;

use std::fmt;

use serde::Serialize;

/// The environment variable that selects the kernel of OpenBLAS.
pub const KERNEL_VARIABLE: &str = "OPENBLAS_CORETYPE";

/// The properties of a BLAS, as far as it reports them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, schemars::JsonSchema)]
pub struct Blas {
    /// The name: `OpenBLAS`, `MKL` or `BLIS`; `unknown` for any other, such as the reference BLAS.
    pub library: &'static str,
    /// The version of the library.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub version: Option<String>,
    /// The processor of the active kernel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kernel: Option<String>,
    /// The number of threads for a large product.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub threads: Option<usize>,
    /// The value of `OPENBLAS_CORETYPE`, if it is set.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kernel_asked: Option<String>,
    /// The name of a faster kernel for this processor, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub better_kernel: Option<&'static str>,
    /// `true` if the library has kernels for several processors and [`KERNEL_VARIABLE`] selects among them.
    #[serde(skip)]
    pub selectable: bool,
}

impl Blas {
    /// Returns the BLAS of this process, or `None` in a build without one. It has no side effects.
    pub fn loaded() -> Option<Self> {
        #[cfg(feature = "blas")]
        return Some(loaded::describe());
        #[cfg(not(feature = "blas"))]
        None
    }

    /// Returns the name and the number of threads.
    pub fn with_threads(&self) -> String {
        match self.threads {
            Some(1) => format!("{self}, one thread"),
            Some(threads) => format!("{self}, {threads} threads"),
            None => self.to_string(),
        }
    }

    /// Returns `true` if a faster kernel is known.
    pub fn is_slow(&self) -> bool {
        self.better_kernel.is_some() || self.library == UNKNOWN
    }
}

/// The name of a library that does not identify itself.
pub(super) const UNKNOWN: &str = "unknown";

impl fmt::Display for Blas {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.library {
            UNKNOWN => write!(f, "an unknown BLAS")?,
            library => write!(f, "{library}")?,
        }
        if let Some(version) = &self.version {
            write!(f, " {version}")?;
        }
        match &self.kernel {
            Some(kernel) => write!(f, " with the kernel {kernel}"),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_build_with_a_blas_knows_it() {
        assert_eq!(Blas::loaded().is_some(), cfg!(feature = "blas"));
        if let Some(blas) = Blas::loaded().filter(|blas| blas.library == "OpenBLAS") {
            assert!(blas.kernel.is_some() && blas.threads.is_some_and(|threads| threads > 0), "{blas:?}");
            let numbered = |version: &String| version.starts_with(|c: char| c.is_ascii_digit());
            assert!(blas.version.as_ref().is_some_and(numbered), "{blas:?}");
        }
    }
}
