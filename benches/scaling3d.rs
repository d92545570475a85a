//! How time, fill, operations and memory grow with the mesh in three dimensions.
//!
//! `cargo bench --bench scaling3d [-- N ... --increments N --csv]`: the cube with n × n × n elements, BN in the default
//! setting, mu = 0.4, CPU; n = 32 by hand. The exponents are least-squares fits of log against
//! log n. Nested dissection of a solid grid takes O(n⁶) operations and O(n⁴) entries. The condensed path makes such a
//! factor of K once, and in each iteration a dense one of some share of the 3 n (n + 1) contact displacements: O(n⁶),
//! too. faer is left out: without nested dissection a run with n = 24 takes 2.7 GB.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::growth::Growth;
use common::run::Elements;

fn main() {
    let cubes = Growth {
        mesh: |n| Elements::Solid([n; 3]),
        sizes: &[8, 12, 16, 20, 24],
        increments: 10,
        paths: &["umfpack", "condensed"],
        theory: "theory: entries 4, flops 6",
    };
    cubes.print();
}
