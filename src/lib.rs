//! Quasi-static elastic contact with Coulomb friction: the exact law, on the full uncondensed
//! sparse system, with an error measure that does not trust the solver.
//!
//! The problem of one load increment, in the notation of Christensen, Klarbring, Pang and Strömberg
//! (Int. J. Numer. Meth. Engng 42, 1998), whose equation numbers stand throughout:
//!
//! - equilibrium (15): `K u + C_nᵀ p_n + C_tᵀ p_t = f`;
//! - contact (4): `w_n = C_n u ≤ g`, `p_n ≥ 0`, `p_n (w_n - g) = 0`;
//! - friction, backward Euler (8): `|p_t| ≤ μ p_n`, dissipating most against `w_t - w̄_t`, `w_t = C_t u`.
//!
//! Data flows one way: [`scene`] (TOML) → [`model`] ([`mesh`], [`fem`], [`contact`]) → [`problem`]
//! (algebra only) → [`formulation`] (the equations `H(z) = 0` and their Jacobian on one fixed
//! pattern) → [`nonlinear`] (Algorithms BN and IP) with [`linear`] (sparse LU) → [`history`] (increments and
//! verdicts) → [`report`]. [`local`] solves problems in contact forces alone, whose matrix may be singular. [`events`] follows the exact path in time instead. [`run`] is the door to all of it. [`solvability`] tells beforehand what to expect of a
//! problem, [`uniqueness`] afterwards how far friction is from making a solution ambiguous.
//!
//! ```
//! use stickslip::run::Run;
//! use stickslip::scene::Scene;
//!
//! let text = include_str!("../data/scenes/block.toml");
//! let scene = Scene::parse("block.toml", text, &["mesh.elements=[10,10]".parse()?])?;
//! let report = Run::new(&scene)?.solve(&mut ())?;
//! assert_eq!(report.status.to_string(), "converged");
//! assert!(report.increments.iter().all(|record| record.kkt.worst().1 < 1e-10));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod auto;
pub mod checkpoint;
pub mod compare;
pub mod condense;
pub mod contact;
pub mod description;
pub mod estimate;
pub mod events;
pub mod exchange;
pub mod fem;
pub mod formula;
pub mod formulation;
pub mod history;
pub mod initial_working_set;
mod input;
pub mod input_error;
pub mod jobs;
pub mod laws;
pub mod linear;
pub mod loading;
pub mod local;
pub mod memory;
pub mod mesh;
pub mod model;
pub mod nonlinear;
pub mod null_space;
pub mod problem;
pub mod report;
pub mod run;
pub mod scene;
pub mod solvability;
pub mod sparse;
pub mod sweep;
pub mod timeline;
pub mod union_find;
pub mod uniqueness;
pub mod units;
pub mod vector;

/// The README, whose Rust is compiled and run with the examples of the documentation.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
