//! From a scene to matrices and back: meshes, elements, obstacles, closed forms, result files.

#![allow(clippy::unwrap_used)]

#[path = "../common/mod.rs"]
mod common;

mod abaqus;
mod auto;
mod axisymmetric;
mod axisymmetric_bodies;
mod axisymmetric_contact;
mod axisymmetric_refused;
mod checkpoints;
mod closed_forms;
mod concave;
mod couplings;
mod cube;
mod cycle;
mod description;
mod door;
mod estimates;
mod friction;
mod fronts;
mod given_meshes;
mod gmsh;
mod increments;
mod joints;
mod key_results;
mod layers;
mod loads;
mod locking;
mod mesh_error;
mod mesh_formats;
mod mortar;
mod moving_obstacles;
mod nearly_incompressible;
mod nodal_volume;
mod nodal_volume_scenes;
mod obstacle_errors;
mod obstacles;
mod patch_hex8;
mod patch_quad4;
mod pieces;
mod published;
mod rubber;
mod scene_against_mesh;
mod scene_bodies;
mod scene_errors;
mod scene_loads;
mod scene_output;
mod scene_overrides;
mod scene_pairs;
mod scene_values;
mod second_order_contact;
mod several_bodies;
mod slip;
mod steps;
mod surface_stress;
mod surfaces;
mod turning;
mod two_bodies;
mod unit_conversion;
mod unseen;
mod unv;
mod verification;
