//! The slip of a joint as a whole: the criterion by which an increment that does not converge has no equilibrium at its end.
//!
//! Let a rigid motion `v` move the body along its contact, and let friction act against `v` at every node that presses.
//! The equations of this *sliding state*, with a drag along `v`, have neither a history nor a slip: they depend
//! only on the loads, gaps and friction at the end of the increment. If the loads do more work on `v` than friction
//! takes up, and all laws of contact hold however far the body moves along `v`, then the body slides without end while
//! a drag proportional to its velocity carries the excess, for any such drag. If an equilibrium existed, a body with a
//! vanishing drag would have two states, one at rest and one that slides. That is excluded where the solution of such an
//! increment is unique, which is assumed.
//!
//! The motion is that of a rigid body with the normal forces of the last state; a linear solve gives the forces of its
//! sliding state, and these the next motion. Where the load takes pressure off the joint, that friction still suffices: then the
//! first motion is that against half of it.

use super::task::{Observe, Task};
use crate::algebra::linear::{LinearError, RefinedSolver};
use crate::algebra::vector::dot;
use crate::solver::formulation::Bdiff;
use crate::solver::newton::{Bn, MethodResult, Termination};
use crate::solver::problem::State;
use crate::solver::solvability::{Load, excess, friction_work, sliding_motion};

/// The largest number of linear solves. The nodes that press in the sliding state are those of the last state but for a
/// few.
const ROUNDS: usize = 4;

/// Looks for a sliding state, from the normal forces `pressed` (n_c, N) and this `share` of their friction. Returns the
/// solves that it took, with the state if it has found one.
pub(super) fn sliding_state(
    task: &Task<'_>,
    (formulation, bn): (&mut Bdiff, &mut Bn),
    linear: &mut RefinedSolver,
    from: &State,
    (pressed, share): (&[f64], f64),
    observe: Observe<'_>,
) -> Result<(MethodResult, Option<State>), LinearError> {
    let (problem, increment) = (task.problem, task.increment);
    let sizes: Vec<f64> = increment.force.iter().map(|f| f.abs()).collect();
    let load = Load { force: increment.force, sizes: &sizes };
    let (layout, scaling) = (formulation.layout().clone(), *formulation.scaling());
    let mut result = MethodResult { attempts: 0, ..MethodResult::new(f64::NAN) };
    // Without pressure nothing is known of the contact.
    let presses = pressed.iter().all(|p| p.is_finite()) && pressed.iter().any(|p| *p > 0.0);
    let rounds = if presses { ROUNDS } else { 0 };
    let from = layout.packed(from, &scaling);
    let (mut z, mut p_n) = (from.clone(), pressed.to_vec());
    for round in 0..rounds {
        if round == ROUNDS / 2 {
            p_n.copy_from_slice(pressed);
        }
        let share = if round == 0 { share } else { 1.0 };
        let mu: Vec<f64> = increment.mu.iter().map(|mu| share * mu).collect();
        let Some(motion) = sliding_motion(problem, &mu, &load, &p_n) else { break };
        // Pins carry what exceeds the friction of these forces. If that is much, it changes the pressure at these nodes:
        // then a drag spreads it over the body.
        let v = problem.rigid_motion(&motion);
        let much = excess(problem, increment.mu, increment.force, &p_n, &motion) / (dot(&v, &v) * scaling.force);
        let drag = if round < ROUNDS / 2 { 0.0 } else { much };
        let drag: Vec<f64> = v.iter().map(|v| drag * v).collect();
        formulation.begin(increment, &from);
        formulation.linearize_sliding(&p_n, &motion);
        if !bn.solve_cases(formulation, linear, &drag, &mut z, &mut result, observe)? {
            break;
        }
        p_n = formulation.pressing(&z).into_iter().map(|p| p * scaling.force).collect();
        // At the very limit of friction the excess is rounding, and the joint still holds.
        let limit = task.tolerance * friction_work(problem, increment.mu, &p_n, &v);
        let slides = excess(problem, increment.mu, increment.force, &p_n, &motion) > limit;
        if slides && formulation.slides_on(&z, &motion, &problem.natural().contact_part) {
            result.stop = Termination::Slips(motion);
            return Ok((result, Some(layout.unpacked(&z, &scaling))));
        }
    }
    Ok((result, None))
}
