//! What most tests use: the types of the library, and the helpers that stand beside this file.

pub use super::scenes::{model_of, model_with, parsed, parsed_with, scene_text};
pub use super::{Keep, difference, edit};
pub use miette::Diagnostic;
pub use std::{
    f64::consts::PI,
    ops::ControlFlow,
    sync::{Arc, LazyLock},
};
pub use stickslip::algebra::{
    Csc, Csr, Pattern, Symmetric, Vector, dot,
    linear::{FactorInfo, LinearError, LinearSolver, RefinedSolver, SparseCholesky, SparseLu, SystemMatrix},
    minus, norm,
};
pub use stickslip::base::{Field, Formula, Scaling, equal_increments};
pub use stickslip::body::{
    Action, Axis, ContactNode, Description, GapDirection, Load, Model, Obstacle, ObstacleMotion, Opposite, Place,
    PlacedObstacle, Rotation, Shape, Slave, SlaveReason, Support, Where,
    constraints::{Dofs, RigidMotion, assemble},
    fem::{Elasticity, Element, Material, MaterialGroup, Plane},
    mesh::{
        Body, Boundary, Cell, CellKind, Geometry, HalfPlane, Mesh, MeshFault, MeshFormat, MeshSource, Notes, Segment,
        block,
    },
};
pub use stickslip::run::{
    Recording, Run, discretise,
    report::{ContactLine, EliminatedUnknown, Resultant, RunReport, Warning, WarningKind},
};
pub use stickslip::scene::{Scene, SceneError};
pub use stickslip::solver::{
    Checkpoint, Condensed, ContactProblem, ContactStatus, KktErrors, KktScales, LoadCase, Loading, Motion, Parts,
    State,
    formulation::{Bdiff, FormulationScaling, InteriorPoint, Partition},
    history::{
        self, HistoryOutcome, HistorySettings, IncrementSolver, IncrementView, LinearAlgebra, Method, Observer,
        SolverChoice, Start, Status, SystemSolver,
    },
};
