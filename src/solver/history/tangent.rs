//! The start of an increment on the tangent of the history: where the solution would be if no contact node changed its status.
//!
//! The last factors tell that by one substitution. Nodes that do change their status show there, and Newton's method begins with
//! their new cases; if there are none, it has nothing left to do.

use crate::algebra::linear::{LinearError, RefinedSolver};
use crate::solver::formulation::Bdiff;
use crate::solver::newton::Bn;

/// The start on the tangent at the solution `z` of the increment before, for the data that `formulation` has by now. `None` where
/// the factors that `linear` has are not those of the last linearisation, or this has no tangent.
pub(super) fn ahead(
    formulation: &Bdiff,
    bn: &mut Bn,
    linear: &mut RefinedSolver,
    z: &[f64],
) -> Result<Option<Vec<f64>>, LinearError> {
    let Some(h) = formulation.residual_of_cases(z) else { return Ok(None) };
    let Some(dz) = bn.substitute(formulation, linear, &h)? else { return Ok(None) };
    let mut ahead: Vec<f64> = z.iter().zip(dz).map(|(z, dz)| z + dz).collect();
    formulation.slip_where_closing(&mut ahead);
    Ok(Some(ahead))
}
