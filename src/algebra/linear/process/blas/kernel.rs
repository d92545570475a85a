//! The kernels of OpenBLAS, by name.

/// The widest vector instructions of a kernel or a processor. Wider ones are faster.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Vectors {
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
    #[cfg_attr(
        target_arch = "x86_64",
        allow(clippy::unnecessary_wraps, reason = "processors of other architectures have none of them")
    )]
    pub(super) fn of_processor() -> Option<Self> {
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
    pub(super) fn of_kernel(name: &str) -> Option<Self> {
        let has_name = |names: &str| names.split(' ').any(|known| known.eq_ignore_ascii_case(name));
        KERNELS.iter().find(|(_, names)| has_name(names)).map(|(vectors, _)| *vectors)
    }
}

/// The kernels of OpenBLAS for x86-64, as words.
const KERNELS: [(Vectors, &str); 5] = [
    (Vectors::Sse, "Katmai Coppermine Northwood Prescott Banias Atom Core2 Penryn Dunnington Nehalem"),
    (Vectors::Sse, "Athlon Opteron Opteron_SSE3 Barcelona Bobcat Nano"),
    (Vectors::Avx, "Sandybridge Bulldozer Piledriver Steamroller"),
    (Vectors::Avx2, "Haswell Zen Excavator"),
    (Vectors::Avx512, "SkylakeX Cooperlake SapphireRapids"),
];

/// Returns the name of an OpenBLAS kernel, available for years, that is faster than `kernel` on a processor with such
/// vectors. Returns `None` if `kernel` is as fast or not known, or if the processor has no faster one.
pub(super) fn better_kernel(kernel: &str, processor: Option<Vectors>) -> Option<&'static str> {
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
        for kernel in KERNELS.iter().flat_map(|(_, names)| names.split_whitespace()) {
            for vectors in [Vectors::Sse, Vectors::Avx, Vectors::Avx2, Vectors::Avx512] {
                if let Some(better) = better_kernel(kernel, Some(vectors)) {
                    assert_eq!(better_kernel(better, Some(vectors)), None, "{kernel}");
                    assert!(Vectors::of_kernel(better) > Vectors::of_kernel(kernel), "{kernel}");
                }
            }
        }
    }
}
