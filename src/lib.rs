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
//! Data flows one way, from room to room:
//!
//! | room | what it does |
//! | --- | --- |
//! | [`scene`] | reads TOML into a description of bodies, loads and contacts |
//! | [`body`] | meshes, finite elements and contact geometry: from a description to matrices |
//! | [`solver`] | the paper: contact laws, Algorithms BN and IP, histories of increments; it knows no mesh |
//! | [`algebra`] | sparse matrices and linear solvers |
//! | [`run`] | the door to all of it: a scene or a model in, a report out |
//! | [`base`] | what every room stands on |
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

pub mod algebra;
pub mod base;
pub mod body;
pub mod run;
pub mod scene;
pub mod solver;

/// The README, whose Rust is compiled and run with the examples of the documentation.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
