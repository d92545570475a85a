//! Errors of the pairing of two boundaries.

use crate::algebra::vector::Vector;
use crate::body::mesh::Mesh;

/// The error of two boundaries that cannot be paired.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MortarFault {
    /// The master is nowhere in front of the slave within the search distance.
    #[error(
        "nothing of `{master}` is in front of `{slave}` within {search} m; the least distance is {least} m, at {at:?}"
    )]
    NothingInFront {
        /// The slave boundary.
        slave: String,
        /// The master boundary.
        master: String,
        /// The search distance, m.
        search: f64,
        /// The least distance between the two, m.
        least: f64,
        /// The position of the least distance, m.
        at: Vector,
    },
    /// Two layers of the master are in front of part of a slave facet.
    #[error("two layers of `{master}` are in front of the facet of `{slave}` at {at:?}")]
    TwoLayers {
        /// The slave boundary.
        slave: String,
        /// The master boundary.
        master: String,
        /// The centre of the facet, m.
        at: Vector,
    },
    /// A quadrilateral that cannot be clipped.
    #[error("the quadrilateral of `{boundary}` at {at:?} is not convex")]
    NotConvex {
        /// The boundary.
        boundary: String,
        /// The centre of the facet, m.
        at: Vector,
    },
    /// A facet is bent so much that places in front of the other boundary have no local coordinates: the facet folds there, or an edge
    /// bends far away from its chord.
    #[error("the facet of `{boundary}` at {at:?} is bent too much, seen along the normal of the slave")]
    TooBent {
        /// The boundary.
        boundary: String,
        /// The centre of the facet, m.
        at: Vector,
    },
    /// Supports hold all slave nodes in front of the master along their normals.
    #[error("supports or a coupling hold `{slave}` along its normal wherever `{master}` is in front of it")]
    SlaveHeld {
        /// The slave boundary.
        slave: String,
        /// The master boundary.
        master: String,
    },
    /// Facets that meet in a node, or that are in front of it, have opposite normals.
    #[error("the normals of the facets of `{boundary}` around {at:?} cancel")]
    NormalsCancel {
        /// The boundary.
        boundary: String,
        /// The position of the node, m.
        at: Vector,
    },
    /// The given direction points into the slave.
    #[error("the direction points into the body at {at:?} of `{slave}`")]
    Inwards {
        /// The slave boundary.
        slave: String,
        /// The position of the node, m.
        at: Vector,
    },
}

impl MortarFault {
    /// Returns the correction, in words.
    pub fn help(&self) -> &'static str {
        match self {
            MortarFault::NothingInFront { search, least, .. } if least <= search => {
                "let the two face each other, so that the normals of the one meet facets of the other that look back"
            }
            MortarFault::NothingInFront { .. } => "give a longer `search`, or move the bodies to where they meet",
            MortarFault::TwoLayers { .. } => {
                "give a shorter `search`, or name only the part of the boundary that is to be met"
            }
            MortarFault::NotConvex { .. } => {
                "mesh again; no angle of a quadrilateral on a contact boundary may exceed 180°"
            }
            MortarFault::TooBent { .. } => {
                "mesh again, finer where the boundary is curved, or name only the part of it that faces the other"
            }
            MortarFault::SlaveHeld { .. } => "swap the two: what nothing holds is to be the slave",
            MortarFault::NormalsCancel { .. } => "name the two sides of a sharp edge as different boundaries",
            MortarFault::Inwards { .. } => "turn the direction round: it points out of the slave, towards the master",
        }
    }
}

/// Returns a point for messages, with two coordinates in two dimensions.
pub(super) fn place(mesh: &Mesh, [x, y, z]: [f64; 3]) -> Vector {
    if mesh.dimension == 2 { [x, y].into() } else { [x, y, z].into() }
}
