//! What the linear algebra of a model may be chosen from: multigrid where it needs few iterations whatever the size.

use crate::algebra::linear::Statistics;
use crate::algebra::linear::built_in::ranks;
use crate::algebra::vector::{minus, norm};
use crate::base::memory::Budget;
use crate::body::model::Model;
use crate::run::auto::AvailableSolvers;
use crate::solver::history::{LinearAlgebra, Method};

/// From here on towards 1/2 iterations grow, 35 to 41 at 0.45 and 76 to 84 at 0.49 on a cube.
const LARGEST_POISSON: f64 = 0.45;
/// A body that may bend of elements four times as wide as high needs no more iterations than others; of ten times and more it
/// stands still unless contact holds most of it. Nor do meshes serve of which some elements are long in one direction and some in another.
const MOST_STRETCHED: f64 = 8.0;

/// Why multigrid is not chosen for a model.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Unsuited {
    /// Its cargo feature is off.
    #[error("this build has no PETSc")]
    NotBuiltIn,
    /// Factors of plane bodies are small.
    #[error("it is for bodies in space")]
    Plane,
    /// Interior point methods and exact paths have matrices that it was not tried on widely.
    #[error("it is for BN")]
    Method,
    /// Nearly incompressible.
    #[error("ν = {0} is too near to 1/2")]
    NearlyIncompressible(f64),
    /// Elements are long and thin.
    #[error("an element has corners {0:.0} times as far from each other as others")]
    Stretched(f64),
    /// Two contacts at a node, or rows that cannot be had on its own displacements.
    #[error("a node has two contacts, or shares its contact with others")]
    Rows,
}

/// What `model` may be solved by with `method`.
pub(super) fn means(model: &Model, method: Method, budget: Option<Budget>) -> AvailableSolvers {
    let multigrid = LinearAlgebra::Multigrid.is_built_in() && unsuited(model, method).is_none();
    AvailableSolvers { available: budget.map(|budget| budget.bytes), multigrid, ranks: ranks() }
}

/// Why multigrid is not chosen for `model` with `method`, if it is not.
pub fn unsuited(model: &Model, method: Method) -> Option<Unsuited> {
    if model.mesh.dimension == 2 {
        return Some(Unsuited::Plane);
    }
    if method.is_interior() || matches!(method, Method::Events { .. }) {
        return Some(Unsuited::Method);
    }
    let poisson = model.materials().iter().map(|law| law.lambda / (2.0 * (law.lambda + law.mu))).fold(-1.0, f64::max);
    if poisson >= LARGEST_POISSON {
        return Some(Unsuited::NearlyIncompressible(poisson));
    }
    let stretched = stretch(model);
    if stretched > MOST_STRETCHED {
        return Some(Unsuited::Stretched(stretched));
    }
    built_in(model)
}

/// Why multigrid gave way, if it did and that is known.
pub(super) fn gave_way(linear: &Statistics, model: &Model, method: Method) -> Option<String> {
    linear.instead.and_then(|_| unsuited(model, method)).map(|why| why.to_string())
}

#[cfg(feature = "petsc")]
fn built_in(model: &Model) -> Option<Unsuited> {
    super::grid::grid(model).is_none().then_some(Unsuited::Rows)
}

#[cfg(not(feature = "petsc"))]
#[allow(clippy::unnecessary_wraps, reason = "the other build has one to return")]
fn built_in(_: &Model) -> Option<Unsuited> {
    Some(Unsuited::NotBuiltIn)
}

/// The largest distance between corners of an element over the least, at most.
fn stretch(model: &Model) -> f64 {
    let of_cell = |corners: &[usize]| {
        let each = |i: usize| corners[..i].iter().map(move |&other| (corners[i], other));
        let distances =
            (1..corners.len()).flat_map(each).map(|(a, b)| norm(minus(model.mesh.nodes[a], model.mesh.nodes[b])));
        let (least, largest) = distances.fold((f64::INFINITY, 0.0_f64), |(l, m), x| (l.min(x), m.max(x)));
        largest / least
    };
    model.mesh.cells.iter().map(|cell| of_cell(&cell.nodes[..cell.kind.corners()])).fold(1.0, f64::max)
}
