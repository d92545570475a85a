//! Plane linear elasticity with bilinear quadrilaterals: `K`, consistent loads, rigid motions.

mod assembly;
mod dofs;
mod elastic;
mod load;
mod quadrature;
mod rigid;
mod shape;

pub use assembly::{InvertedElement, assemble};
pub use dofs::Dofs;
pub use elastic::{Elasticity, element_stiffness};
pub use load::edge_load;
pub use quadrature::GAUSS_2X2;
pub use rigid::{RigidMotion, rigid_motions};
pub use shape::{gradients, shape};
