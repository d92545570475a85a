//! Meshes from files and arrays, and numbers in units.

mod abaqus;
mod given_meshes;
mod gmsh;
pub mod mesh_formats;
mod pieces;
mod unit_conversion;
mod unv;
