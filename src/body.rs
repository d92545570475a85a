//! From a mesh to a [`ContactProblem`](crate::solver::problem::ContactProblem): finite elements, contact geometry, loads, error estimates.

pub mod contact;
pub(crate) mod description;
pub(crate) mod estimate;
pub mod fem;
pub mod mesh;
pub(crate) mod model;
pub use description::{
    Action, Against, Axis, Bed, Contact, Description, Direction, Field, FirstGap, Held, Kinks, Load, Opposite, Probe,
    ProbePlace, Slave, Support, Where,
};
pub use estimate::{
    ContactEstimate, ContactGraph, DiscretisationError, ElementEstimate, HertzContact, PeakOf, StickZone, peak_error,
};
pub use model::{
    Balance, BetweenNodes, Body, Faceted, Model, ModelError, OnTheWay, Overlap, Pair, Share, Slid, Wrench,
};
