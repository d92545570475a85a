//! Linear elasticity in two and three dimensions: elements, materials, consistent loads, springs.

mod body_force;
mod elastic;
mod facet;
mod inverted;
mod locate;
mod material;
mod nodal_volume;
mod overlap;
mod shape;
mod spring;
mod stiffness;
mod strain;
mod stress;

pub(crate) use body_force::free_stretch;
pub(crate) use body_force::thermal_stress;
pub use body_force::{body_force, thermal_forces};
pub use elastic::Elasticity;
pub(crate) use elastic::numbered;
pub(crate) use facet::facet_mass;
pub use facet::{NodalForces, area, bernstein, facet_normals, facet_weights, traction, uniform_traction};
pub use inverted::InvertedElement;
pub(crate) use locate::reference_point;
pub use material::{Layer, Material, MaterialGroup, Plane};
pub(crate) use nodal_volume::{NodalVolume, NodalVolumes};
pub(crate) use overlap::is_inside_cell;
pub use overlap::{Overlap, overlaps};
pub use shape::gradients;
pub use spring::{Bedding, Spring};
pub use stiffness::element_stiffness;
pub use strain::Element;
pub(crate) use strain::with_dilatation;
pub use stress::{cell_volume, strain_at, strains};
