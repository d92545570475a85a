//! Linear elasticity in two and three dimensions: `K`, consistent loads, rigid motions.

mod assembly;
mod dofs;
mod elastic;
mod facet;
mod locate;
mod material;
mod quadrature;
mod rigid;
mod shape;
mod stiffness;
mod strain;
mod stress;

pub use assembly::{InvertedElement, assemble};
pub use dofs::Dofs;
pub use elastic::Elasticity;
pub use facet::{facet_load, facet_weights};
pub use locate::reference_point;
pub use material::{Layer, Material, MaterialGroup, Plane};
pub use quadrature::quadrature;
pub use rigid::{RigidMotion, rigid_motions};
pub use shape::{gradients, shape};
pub use stiffness::element_stiffness;
pub use strain::Element;
pub use stress::{centre_stress, stress_at};
