//! Errors of the placement of an obstacle.

use super::gap_table::TableError;
use super::triangles::SurfaceError;

/// The error of an obstacle that does not fit its boundary.
#[derive(Debug, thiserror::Error)]
pub enum ObstacleError {
    /// The boundary has no mean normal, because it is closed or symmetric.
    #[error("the boundary has no mean normal to face an obstacle with")]
    NoNormal,
    /// A vector leaves the plane of a two-dimensional body.
    #[error("{0} of the obstacle leaves the plane of the body, which has two dimensions")]
    OutOfPlane(&'static str),
    /// A vector has two components in three dimensions.
    #[error("{0} of the obstacle has two components, but the body has three dimensions")]
    PlaneVector(&'static str),
    /// The shape, for example a sphere, needs three dimensions.
    #[error("the obstacle is a {0}, but the body has two dimensions")]
    OnlyInSpace(&'static str),
    /// A cylinder, bore or wedge in three dimensions has no axis.
    #[error("a cylinder, bore or wedge in three dimensions needs an axis")]
    NoAxis,
    /// The axis is not at right angles to the normal.
    #[error("the axis of the obstacle is not at right angles to its normal")]
    SkewAxis,
    /// The cone opens towards the body.
    #[error("the axis of the cone points into the body, or along its surface")]
    ConeTowardsBody,
    /// A sphere, socket or cone in front of a body of revolution does not have the same axis.
    #[error("the obstacle is a {0} that is not about the axis x = 0 of the body")]
    OffAxis(&'static str),
    /// An obstacle in front of a body of revolution turns; it would lose the symmetry or rub across the section.
    #[error("the obstacle turns, but the body is axisymmetric")]
    TurnsRound,
    /// The radius of an obstacle of revolution changes.
    #[error("the obstacle moves away from the axis of the body, or towards it, by its {0}")]
    MovesAside(&'static str),
    /// The table of gaps cannot be used.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The file of triangles cannot be used.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
}

impl ObstacleError {
    /// Returns the correction, in words.
    pub fn help(&self) -> &'static str {
        match self {
            ObstacleError::NoNormal => "give the obstacle a `normal`",
            ObstacleError::OutOfPlane(_) => "let vectors have two components, and axes be [0, 0, 1] or left out",
            ObstacleError::PlaneVector(_) => "give [x, y, z], and points of a translation as [time, x, y, z]",
            ObstacleError::OnlyInSpace(_) => {
                "use a cylinder, bore or wedge, whose axis is across the plane, or a table"
            }
            ObstacleError::NoAxis => "give an axis, such as [0, 1, 0]",
            ObstacleError::SkewAxis => "turn the axis, or give the obstacle a normal at right angles to it",
            ObstacleError::ConeTowardsBody => "let the axis point from the tip into the cone, out of the body",
            ObstacleError::OffAxis(_) => {
                "give a point of the axis, [0, y], for its `center` or `apex`, and a cone the axis [0, 1] or [0, -1]; a cylinder, \
                 bore or wedge may be anywhere, and is a ring"
            }
            ObstacleError::TurnsRound => {
                "remove motion.rotation: what turns about the axis rubs across the section, which is not computed, and what turns \
                 about anything else is no obstacle of revolution"
            }
            ObstacleError::MovesAside(_) => {
                "let it move along y: by motion.translation, or by approach with the normal [0, 1] or [0, -1]; an interference of \
                 radii is a negative gap"
            }
            ObstacleError::Table(_) => {
                "give a CSV file with the header x,gap or x,y,gap and numbers in m or as [units] says"
            }
            ObstacleError::Surface(_) => {
                "give an STL file or a Gmsh file whose faces are counterclockwise seen from the body"
            }
        }
    }
}
