//! Linear elasticity in two and three dimensions: `K`, consistent loads, springs, supports, rigid motions.

mod assembly;
mod body_force;
mod dofs;
mod elastic;
mod facet;
mod held;
mod inverted;
mod locate;
mod material;
mod nodal_volume;
mod overlap;
mod part;
mod relative;
mod rigid;
mod shape;
mod spring;
mod stiffness;
mod strain;
mod stress;
mod transform;

pub use assembly::assemble;
pub use body_force::{body_force, free_stretch, thermal_forces, thermal_stress};
pub use dofs::Dofs;
pub(crate) use dofs::{SAME_DIRECTION, independent};
pub use elastic::Elasticity;
pub(crate) use elastic::numbered;
pub use facet::{
    NodalForces, area, bernstein, facet_load, facet_mass, facet_normals, facet_weights, traction, uniform_traction,
};
pub use held::{HeldRows, nearest_translation};
pub use inverted::InvertedElement;
pub use locate::reference_point;
pub use material::{Layer, Material, MaterialGroup, Plane};
pub use nodal_volume::NodalVolumes;
pub use overlap::{Overlap, is_inside_cell, overlaps};
pub use part::assemble_part;
pub(crate) use relative::merged;
pub use relative::{Relative, Ring};
pub use rigid::{BodyMotion, RigidMotion, Tie, rigid_motions, unresisted_motions};
pub use shape::gradients;
pub use spring::{Bedding, Spring};
pub use stiffness::element_stiffness;
pub use strain::Element;
pub(crate) use strain::with_dilatation;
pub use stress::{cell_volume, centre_stress, strain_at, strains};
