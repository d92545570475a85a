//! The linear solvers available for a model. Multigrid is one of them if its iterations do not grow with the size of
//! the model.

use crate::algebra::linear::built_in::ranks;
use crate::algebra::linear::{Statistics, engine};
use crate::algebra::vector::{minus, norm};
use crate::base::memory::Budget;
use crate::body::model::Model;
use crate::run::auto::AvailableSolvers;
use crate::solver::history::{HistoryMethod, LinearAlgebra};

/// The largest Poisson's ratio for multigrid. Beyond it iterations grow: 35 to 41 at 0.45 and 76 to 84 at 0.49 on a
/// cube.
const LARGEST_POISSON: f64 = 0.45;
/// The largest stretch of an element for multigrid. A flexible body of elements four times as wide as high needs no
/// more iterations than others; with ten times or more the iteration stagnates unless contact constrains most of the
/// body. Meshes with elements stretched in different directions are unsuitable too.
const MAX_STRETCHED: f64 = 8.0;

/// The reason why multigrid is not chosen for a model.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Unsuited {
    /// The program has added none.
    #[error("this build has no PETSc")]
    NotBuiltIn,
    /// Factors of plane bodies are small anyway.
    #[error("it suits only bodies in space")]
    Plane,
    /// Multigrid has not been tested widely with interior point methods and exact paths.
    #[error("it suits only BN")]
    Method,
    /// A material is nearly incompressible.
    #[error("ν = {0} is too close to 1/2")]
    NearlyIncompressible(f64),
    /// Elements are long and thin.
    #[error("the longest distance between corners of an element is {0:.0} times the shortest")]
    Stretched(f64),
    /// A node has two contacts, or its contact rows involve displacements of other nodes.
    #[error("a node has two contacts, or shares its contact with others")]
    Rows,
}

/// Returns the linear solvers available for `model` with `method`.
pub(super) fn available_solvers(model: &Model, method: HistoryMethod, budget: Option<Budget>) -> AvailableSolvers {
    let multigrid = LinearAlgebra::Multigrid.is_built_in() && unsuited(model, method).is_none();
    AvailableSolvers { available: budget.map(|budget| budget.bytes), multigrid, ranks: ranks() }
}

/// Returns the reason why multigrid is not chosen for `model` with `method`; `None` if it is suitable.
pub fn unsuited(model: &Model, method: HistoryMethod) -> Option<Unsuited> {
    if model.mesh.dimension == 2 {
        return Some(Unsuited::Plane);
    }
    if method.is_exact_path() || method.increments().is_interior() {
        return Some(Unsuited::Method);
    }
    let poisson = model.materials().iter().map(|law| law.lambda / (2.0 * (law.lambda + law.mu))).fold(-1.0, f64::max);
    if poisson >= LARGEST_POISSON {
        return Some(Unsuited::NearlyIncompressible(poisson));
    }
    let stretched = stretch(model);
    if stretched > MAX_STRETCHED {
        return Some(Unsuited::Stretched(stretched));
    }
    match engine() {
        None => Some(Unsuited::NotBuiltIn),
        Some(_) => super::grid::grid(model).is_none().then_some(Unsuited::Rows),
    }
}

/// Returns the reason why multigrid fell back to another solver, if it did and the reason is known.
pub(super) fn fell_back(linear: &Statistics, model: &Model, method: HistoryMethod) -> Option<String> {
    linear.instead.and_then(|_| unsuited(model, method)).map(|why| why.to_string())
}

/// Returns the largest ratio of the longest to the shortest distance between corners of an element.
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
