//! Linear elasticity in two and three dimensions: elements, materials, consistent loads, springs.

mod body_force;
mod element;
mod facet;
mod locate;
mod material;
mod nodal_volume;
mod spring;

pub(crate) use body_force::free_stretch;
pub(crate) use body_force::thermal_stress;
pub use body_force::{body_force, thermal_forces};
pub(crate) use element::with_dilatation;
pub use element::{Element, InvertedElement, cell_volume, element_stiffness, gradients, strain_at, strains};
pub(crate) use facet::facet_mass;
pub use facet::{NodalForces, area, bernstein, facet_normals, facet_weights, traction, uniform_traction};
pub use locate::{Overlap, overlaps};
pub(crate) use locate::{is_inside_cell, reference_point};
pub(crate) use material::numbered;
pub use material::{Elasticity, Layer, Material, MaterialGroup, Plane};
pub(crate) use nodal_volume::{NodalVolume, NodalVolumes};
pub use spring::{Bedding, Spring};
