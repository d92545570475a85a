//! Quasi-static elastic contact with Coulomb friction, without a penalty: solved on the whole sparse system or condensed
//! on the contact nodes, and judged by an error measure that is independent of the solver.
//!
//! The problem of one load increment, in the notation of Christensen, Klarbring, Pang and Strömberg
//! (Int. J. Numer. Meth. Engng 42, 1998), whose equation numbers are used throughout:
//!
//! - equilibrium (15): `K u + C_nᵀ p_n + C_tᵀ p_t = f`;
//! - contact (4): `w_n = C_n u ≤ g`, `p_n ≥ 0`, `p_n (w_n - g) = 0`;
//! - friction, backward Euler (8): with `w_t = C_t u`, and `w̄_t` its value at the end of the increment before, moved with the
//!   obstacle, `p_t` satisfies `|p_t| ≤ μ p_n`. Among all such forces it maximises the dissipation `p_t · (w_t - w̄_t)`. In space
//!   there are two tangents, `C_t` and `C_o`.
//!
//! # Start here
//!
//! | you have | you want | begin with |
//! | --- | --- | --- |
//! | a scene, a TOML file | forces, pressures, slip, their errors | [`Scene::read`], [`Run::new`], [`Run::solve`]: a [`RunReport`] |
//! | a mesh and loads in Rust | the same | [`body::Description`], [`body::Model::build`], [`Run::of`] |
//! | matrices `K`, `C_n`, `C_t` | states and records | [`ContactProblem::new`], [`solver::Loading`], [`solver::history::run`] or [`solver::history::follow_exact_path`] |
//! | a time loop of your own | one increment after the other | [`solver::history::Stepper`] |
//! | a linear solver of your own | BN and IP on it | the trait [`LinearSolver`] |
//! | a method of your own | histories, verdicts, checkpoints for it | the traits [`solver::history::IncrementSolver`] and [`solver::history::Algorithm`], [`solver::history::run_with`] |
//!
//! # The rooms
//!
//! Data flows one way. Each room uses only the rooms below it.
//!
//! | room | what it does |
//! | --- | --- |
//! | [`run`] | the door to all of it: a scene or a model in, a report out |
//! | [`scene`] | reads TOML into a description of bodies, loads and contacts |
//! | [`body`] | meshes, finite elements and contact geometry: from a description to matrices |
//! | [`solver`] | the paper: contact laws, Algorithms BN and IP, histories of increments; it knows no mesh |
//! | [`algebra`] | sparse matrices and linear solvers |
//! | [`base`] | errors of input, units, histories in time: every room uses it |
//!
//! Crates above: `stickslip-output` writes results and pictures, `stickslip-exchange` reads problems of other programs,
//! `stickslip-cli` is the program.
//!
//! ```
//! use stickslip::{Run, Scene};
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

pub use algebra::linear::LinearSolver;
pub use run::report::RunReport;
pub use run::{Recording, Run};
pub use scene::Scene;
pub use solver::ContactProblem;

/// The README, whose Rust is compiled and run with the examples of the documentation.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
