//! The algebra: laws, equations, solvers, error measure and verdicts, on matrices and on small bodies.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

#[path = "../common/mod.rs"]
mod common;

mod arrays;
mod backends_agree;
mod bn_vs_ip;
mod carried;
mod cholesky;
mod condensed;
mod coulomb3d;
mod dense;
mod distributed;
mod error_measure;
mod events;
mod faer_agrees;
mod fewer_tangents;
mod halving;
mod invariance;
mod ip3d;
mod ip_step;
mod jacobian_fd;
mod labels;
mod left_out;
mod matrices;
mod neutral;
mod own_method;
mod own_solvers;
mod partial;
mod robust;
mod stops;
mod tangent_start;
mod touches;
mod uniqueness;
mod uniqueness_of_rows;
mod units;
mod verdicts;
mod working_set;
