//! Elements of every kind: patch tests, orders, locking.

mod axisymmetric;
mod cube;
mod locking;
mod nodal_volume;
mod nodal_volume_scenes;
mod patch_hex8;
mod patch_quad4;
