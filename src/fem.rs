//! Plane linear elasticity with four-node quadrilaterals: `K`, consistent loads, rigid motions.

mod assembly;
mod dofs;
mod elastic;
mod load;
mod quadrature;
mod rigid;
mod shape;
mod stiffness;
mod strain;

pub use assembly::{InvertedElement, assemble};
pub use dofs::Dofs;
pub use elastic::Elasticity;
pub use load::edge_load;
pub use quadrature::GAUSS_2X2;
pub use rigid::{RigidMotion, rigid_motions};
pub use shape::{gradients, shape};
pub use stiffness::element_stiffness;
pub use strain::Element;
