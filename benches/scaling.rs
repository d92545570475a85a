//! How time, fill, operations and memory grow with the mesh, on the whole system and on the condensed one.
//!
//! `cargo bench --bench scaling [-- N ... --increments N --csv]`: the block with n × n elements, BN in the default
//! setting, mu = 0.4, CPU. The exponents are least-squares fits of log against log n. Nested dissection of a plane
//! grid takes O(n³) operations and O(n² log n) entries, an exponent of about 2.3 in this range.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::growth::Growth;
use common::run::Elements;

fn main() {
    let blocks = Growth {
        mesh: |n| Elements::Plane([n, n]),
        sizes: &[25, 50, 100, 200, 400],
        increments: 4,
        paths: &["umfpack", "faer", "condensed"],
        theory: "theory: entries 2.3, flops 3.0",
    };
    blocks.print();
}
