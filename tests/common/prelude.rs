//! The names that most tests use: the types of the library, and the helpers that stand beside this file.

pub use super::runs::{
    apart, balanced, bn, both, converged, each, forces_apart, history_of, iterations, largest, recorded, settings_of,
    solved_by_bn, solver_of,
};
pub use super::{
    BELT, Keep,
    around::around,
    convergence::order,
    difference, edit,
    faults::{built, line_of, located, refused, rows, says, verify, verify_all},
    hertz::Hertz,
    pairs::{Side, bodies, solved, solver},
    random::Random,
    rings::ring,
    round::{Round, moved},
    scenes::{BLOCK, CUBE, PUNCH, model_of, model_with, parsed, parsed_with, scene_text},
    scratch::Scratch,
};
pub(crate) use crate::common;
pub(crate) use crate::common::scenes::scene;
pub use miette::Diagnostic;
pub use std::{
    f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI},
    fs,
    ops::{ControlFlow, Range},
    path::Path,
    sync::{Arc, LazyLock},
};
pub use stickslip::algebra::{
    Csc, Csr, Pattern, Symmetric, Vector, cross, dot,
    linear::{FactorInfo, LinearError, LinearSolver, RefinedSolver, SparseCholesky, SparseLu, SystemMatrix},
    minus, norm, unit,
};
pub use stickslip::base::{Field, Formula, LengthUnit, Quantity, Scaling, StressUnit, Units, equal_increments};
pub use stickslip::body::{
    Action, Axis, Bed, ContactNode, Coupling, Description, GapDirection, Load, Model, ModelError, Obstacle,
    ObstacleMotion, Opposite, Place, PlacedObstacle, Probe, Rotation, Shape, Slave, SlaveReason, Support, Where,
    constraints::{Dofs, RigidMotion, assemble, facet_load, rigid_motions},
    fem::{Elasticity, Element, Material, MaterialGroup, Plane, element_stiffness, gradients, strain_at},
    mesh::{
        Body, Boundary, Cell, CellKind, Geometry, HalfPlane, Mesh, MeshFault, MeshFileError, MeshFormat, MeshSource,
        Notes, Segment, block, fine_quadrature, from_gmsh, quadrature, shape,
    },
};
pub use stickslip::run::{
    RecordedIncrement, Recording, Run, RunError, discretise,
    report::{ContactLine, EliminatedUnknown, Resultant, RunReport, Warning, WarningKind},
};
pub use stickslip::scene::{Override, Scene, SceneError};
pub use stickslip::solver::{
    Checkpoint, Condensed, ContactProblem, ContactStatus, CriticalFriction, Increment, KktErrors, KktScales, LoadCase,
    Loading, Motion, Parts, State, critical_friction,
    formulation::{Bdiff, FormulationScaling, InteriorPoint, Partition},
    history::{
        self, Algorithm, HistoryOutcome, HistorySettings, IncrementSolver, IncrementView, LinearAlgebra, Method,
        Observer, SolverChoice, Start, Status, SystemSolver,
    },
    statuses,
};
