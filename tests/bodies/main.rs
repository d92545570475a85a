//! From a scene to matrices and back: meshes, elements, obstacles, closed forms, result files.

#[path = "../common/mod.rs"]
mod common;

mod auto;
mod axisymmetric;
mod axisymmetric_bodies;
mod axisymmetric_contact;
mod axisymmetric_refused;
mod closed_forms;
mod concave;
mod contact_surface;
mod cube;
mod description;
mod door;
mod estimates;
mod fronts;
mod gmsh;
mod layers;
mod loads;
mod locking;
mod mesh_error;
mod moving_obstacles;
mod nodal_volume;
mod nodal_volume_scenes;
mod obstacles;
mod outputs;
mod patch_hex8;
mod patch_quad4;
mod patches;
mod prisms;
mod published;
mod rubber;
mod scene_against_mesh;
mod scene_errors;
mod scene_loads;
mod scene_output;
mod scene_overrides;
mod scene_values;
mod second_order;
mod second_order_contact;
mod surfaces;
mod turning;
mod unit_conversion;
mod units;
mod verification;
mod vtu;
