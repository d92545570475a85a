//! The loaded BLAS, its active kernel, and the best kernel for the processor.
//!
//! OpenBLAS has kernels for many processors and chooses among them when it is loaded. A version older than the
//! processor may not recognise it and then uses the oldest kernels, which are four times slower. [`KERNEL_VARIABLE`]
//! selects others. It is read when the library is loaded, so that only a new process benefits.

#[cfg(feature = "blas")]
pub(super) mod loaded;
#[cfg(feature = "blas")]
pub(super) mod room;

use std::fmt;

use serde::Serialize;

/// The environment variable that selects the kernel of OpenBLAS.
pub const KERNEL_VARIABLE: &str = "OPENBLAS_CORETYPE";

/// The properties of a BLAS, as far as it reports them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
    /// The kernel that the library had chosen before the program restarted itself for the present one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kernel_before: Option<String>,
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

/// The widest vector instructions of a kernel or a processor. Wider ones are faster.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Vectors {
    /// Two numbers at once.
    Sse,
    /// Four numbers at once.
    Avx,
    /// Four numbers at once, with fused multiply-add.
    Avx2,
    /// Eight numbers at once.
    Avx512,
}

impl Vectors {
    /// Returns those of this processor that the system lets programs use, or `None` if it is no x86-64.
    pub fn of_processor() -> Option<Self> {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::is_x86_feature_detected as has;
            // The kernels for Skylake need these instructions.
            let avx512 =
                has!("avx512f") && has!("avx512dq") && has!("avx512bw") && has!("avx512vl") && has!("avx512cd");
            Some(match () {
                () if avx512 => Vectors::Avx512,
                () if has!("avx2") && has!("fma") => Vectors::Avx2,
                () if has!("avx") => Vectors::Avx,
                () => Vectors::Sse,
            })
        }
        #[cfg(not(target_arch = "x86_64"))]
        None
    }

    /// Returns those of the OpenBLAS kernel for the processor `name`, in upper or lower case, or `None` if it is not
    /// known.
    pub fn of_kernel(name: &str) -> Option<Self> {
        let vectors = |(vectors, names): &(Vectors, &[&str])| {
            names.iter().any(|known| known.eq_ignore_ascii_case(name)).then_some(*vectors)
        };
        KERNELS.iter().find_map(vectors)
    }
}

/// The kernels of OpenBLAS for x86-64.
const KERNELS: [(Vectors, &[&str]); 4] = [
    (
        Vectors::Sse,
        &[
            "Katmai",
            "Coppermine",
            "Northwood",
            "Prescott",
            "Banias",
            "Atom",
            "Core2",
            "Penryn",
            "Dunnington",
            "Nehalem",
            "Athlon",
            "Opteron",
            "Opteron_SSE3",
            "Barcelona",
            "Bobcat",
            "Nano",
        ],
    ),
    (Vectors::Avx, &["Sandybridge", "Bulldozer", "Piledriver", "Steamroller"]),
    (Vectors::Avx2, &["Haswell", "Zen", "Excavator"]),
    (Vectors::Avx512, &["SkylakeX", "Cooperlake", "SapphireRapids"]),
];

/// Returns the names of the OpenBLAS kernels for x86-64. The kernels in a library depend on its build.
pub fn kernel_names() -> impl Iterator<Item = &'static str> {
    KERNELS.iter().flat_map(|(_, names)| names.iter().copied())
}

/// The kernels with instructions that only AMD's processors of some years have.
const RETIRED: [&str; 6] = ["Opteron", "Opteron_SSE3", "Bulldozer", "Piledriver", "Steamroller", "Excavator"];

/// Returns `true` if this processor can run the OpenBLAS kernel `name`, as far as its requirements are known.
pub fn may_run_here(name: &str) -> bool {
    let Some(processor) = Vectors::of_processor() else { return true };
    let retired = RETIRED.iter().any(|retired| retired.eq_ignore_ascii_case(name));
    Vectors::of_kernel(name) <= Some(processor) && (!retired || has_retired_instructions())
}

fn has_retired_instructions() -> bool {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::is_x86_feature_detected as has;
        has!("sse4a") && (has!("tbm") || !has!("avx2"))
    }
    #[cfg(not(target_arch = "x86_64"))]
    false
}

/// Returns the name of an OpenBLAS kernel, available for years, that is faster than `kernel` on a processor with such
/// vectors. Returns `None` if `kernel` is as fast or not known, or if the processor has no faster one.
pub fn better_kernel(kernel: &str, processor: Option<Vectors>) -> Option<&'static str> {
    let (taken, processor) = (Vectors::of_kernel(kernel)?, processor?);
    let best = match processor {
        Vectors::Avx512 => "SKYLAKEX",
        Vectors::Avx2 => "HASWELL",
        Vectors::Avx | Vectors::Sse => return None,
    };
    (taken < processor).then_some(best)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kernel_that_falls_short_of_the_processor_has_a_better_one() {
        use Vectors::{Avx, Avx2, Avx512, Sse};
        let (haswell, skylake) = (Some("HASWELL"), Some("SKYLAKEX"));
        // A processor with SSE, AVX, AVX2 and AVX-512.
        for (kernel, better) in [
            ("Prescott", [None, None, haswell, skylake]),
            ("PRESCOTT", [None, None, haswell, skylake]),
            ("core2", [None, None, haswell, skylake]),
            ("Nehalem", [None, None, haswell, skylake]),
            ("Barcelona", [None, None, haswell, skylake]),
            ("Sandybridge", [None, None, haswell, skylake]),
            ("Bulldozer", [None, None, haswell, skylake]),
            ("Haswell", [None, None, None, skylake]),
            ("Zen", [None, None, None, skylake]),
            ("Excavator", [None, None, None, skylake]),
            ("SkylakeX", [None; 4]),
            ("skylakex", [None; 4]),
            ("Cooperlake", [None; 4]),
            ("SapphireRapids", [None; 4]),
            ("SAPPHIRERAPIDS", [None; 4]),
            ("Generic", [None; 4]),
            ("Unknown", [None; 4]),
            ("armv8", [None; 4]),
            ("neoversen1", [None; 4]),
            ("GraniteRapids", [None; 4]),
            ("", [None; 4]),
        ] {
            let told = [Sse, Avx, Avx2, Avx512].map(|vectors| better_kernel(kernel, Some(vectors)));
            assert_eq!(told, better, "{kernel}");
            assert_eq!(better_kernel(kernel, None), None, "{kernel} on another architecture");
        }
    }

    /// The better kernel is the best one, so that it is requested only once.
    #[test]
    fn the_better_kernel_has_no_better_one() {
        for kernel in kernel_names() {
            for vectors in [Vectors::Sse, Vectors::Avx, Vectors::Avx2, Vectors::Avx512] {
                if let Some(better) = better_kernel(kernel, Some(vectors)) {
                    assert_eq!(better_kernel(better, Some(vectors)), None, "{kernel}");
                    assert!(Vectors::of_kernel(better) > Vectors::of_kernel(kernel), "{kernel}");
                }
            }
        }
    }

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
