//! Bodies beside closed forms and published results, and what a report estimates of its own errors.

pub mod axisymmetric_bodies;
mod cycle;
pub mod estimates;
mod increments;
mod key_results;
mod layers;
mod loads;
mod mesh_error;
mod nearly_incompressible;
mod on_paper;
mod published;
mod refinement;
mod rubber;
mod surface_stress;
mod torsion;
mod verification;
