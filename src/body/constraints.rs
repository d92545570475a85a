//! Kinematic constraints: the displacements of all nodes from the unknowns, `u = T û + ū`.
//!
//! `T` has a row for each component of each node ([`Dofs`]): its own unknown, and those of the nodes that it is relative to
//! ([`Relative`]). Supports remove unknowns, oblique ones turn the axes of their nodes; reference points and jumps are nodes
//! outside the mesh. Stiffness becomes `Tᵀ K T`, loads `Tᵀ f`, contact rows `C T`; the forces of supports are the rows of `K`
//! that are removed.

mod assembly;
mod bonds;
mod dofs;
mod relative;
mod rigid;
mod transform;

pub(crate) use assembly::{HeldRows, assemble_part};
pub use assembly::{assemble, facet_load};
pub(crate) use bonds::{Apart, Bonds};
pub use dofs::{Dofs, Jump, ReferencePoint, Tie};
pub(crate) use dofs::{SAME_DIRECTION, independent, normal_frame};
pub(crate) use relative::merged;
pub use relative::{Coefficient, Relative, Ring};
pub use rigid::{BodyMotion, RigidMotion, rigid_motions, unresisted_motions};
