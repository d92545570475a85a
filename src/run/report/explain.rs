//! Explains why a run did not converge: the violated law, its place, and the cure, by the keys of a scene.

use serde::Serialize;

use crate::base::units::Quantity;
use crate::body::fem::RigidMotion;
use crate::body::model::Model;
use crate::solver::history::{HistoryMethod, HistoryOutcome, Method, SolverChoice, Status};
use crate::solver::laws::Law;

/// A smaller motion of contact nodes, relative to that of the body, is rounding.
const NEGLIGIBLE: f64 = 1e-9;

/// The share of all friction in use above which it is reported.
const MUCH: f64 = 0.8;

/// The reason why a run ended early.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Explanation {
    /// The reason in words; empty if the run reached its end.
    pub reason: String,
    /// The node of the largest violation in the increment that failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub worst: Option<WorstNode>,
}

/// A node where a law is violated.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct WorstNode {
    /// The law.
    pub law: Law,
    /// The relative error.
    pub error: f64,
    /// The number of the node in the mesh, from 0.
    pub node: usize,
    /// The position of the node, m, with one coordinate per dimension.
    pub position: Vec<f64>,
}

impl Explanation {
    /// Explains the `outcome` of `model` solved by `solver`; empty if it converged.
    pub fn new(solver: &SolverChoice, model: &Model, outcome: &HistoryOutcome) -> Self {
        Explanation { reason: reason(solver, model, outcome), worst: worst_node(model, outcome) }
    }
}

fn reason(solver: &SolverChoice, model: &Model, outcome: &HistoryOutcome) -> String {
    let exact_path = solver.method.is_exact_path();
    let Some(record) = outcome.records.iter().find(|record| record.status != Status::Converged) else {
        return match outcome.status {
            Status::Singular => unheld(model, outcome),
            Status::Interrupted => "stopped on request".to_string(),
            Status::Unsupported if exact_path => {
                "the exact path requires nodes that slide along lines, constant friction and independent contact \
                 rows; use the method bn"
                    .to_string()
            }
            Status::Unsupported => {
                "this interior point method has only one tangent per node, but nodes slide in a plane; use the \
                 method bn"
                    .to_string()
            }
            Status::OutOfMemory => {
                "memory ran out; the increments before are complete: use a coarser mesh or a machine with more memory"
                    .to_string()
            }
            _ => String::new(),
        };
    };
    let (law, error) = record.kkt.worst();
    let place = worst_node(model, outcome)
        .map_or(String::new(), |worst| format!(" at the node {}", model.units().place(model.mesh.nodes[worst.node])));
    let violated =
        format!("{}{place}: relative error {error:.1e}, tolerance {:.0e} ({law})", broken(law), solver.tolerance);
    let why = match outcome.status {
        Status::Singular => unheld(model, outcome),
        Status::NoEquilibrium => no_equilibrium(model, outcome),
        Status::EdgeFriction => edge_friction(model, outcome),
        Status::NoContinuation => no_continuation(solver, model, outcome),
        Status::Interrupted => "stopped on request".to_string(),
        Status::Inaccurate | Status::Stalled if law == "equilibrium" && error <= 10.0 * outcome.rounding => format!(
            "{violated}; displacements that are so much larger than the deformation, as of a slender or a hardly held \
             body, have this rounding error: hold the body by a support or stiffer springs, or, if this accuracy \
             suffices, set solver.tolerance above it"
        ),
        Status::Inaccurate if exact_path => {
            format!(
                "{violated} on the exact path, most likely by rounding; compare with the method bn, and with \
                 another solver.linear"
            )
        }
        Status::Inaccurate => {
            format!(
                "the method stopped with Theta = {:.1e}, but {violated}; {}",
                record.theta,
                advice(solver, model, outcome)
            )
        }
        Status::MaxIterations => {
            let limit = solver.max_iterations;
            // From 100 on, the limit is hardly the cause: no increment of the extreme test cases is known to need more.
            let advice = if limit < 100 {
                "try a larger solver.max_iterations".to_string()
            } else {
                advice(solver, model, outcome)
            };
            format!("no convergence within max_iterations = {limit}: {violated}; {advice}")
        }
        Status::Cycling => {
            format!("the iteration cycles: {violated}; {}", advice(solver, model, outcome))
        }
        Status::Stalled => format!("the iteration stalls: {violated}; {}", advice(solver, model, outcome)),
        Status::Diverged | Status::NotFinite => {
            format!("the numbers left the range of double precision: {violated}; {}", advice(solver, model, outcome))
        }
        Status::Converged | Status::OutOfMemory | Status::Unsupported => violated,
    };
    let reached = if exact_path || record.parts == 0 {
        String::new()
    } else {
        format!("; substeps of it converged until t = {} s", outcome.reached)
    };
    format!("increment {} (t = {} s): {why}{reached}", record.index, record.time)
}

/// Suggests a cure if the iteration stops too late or too early.
fn advice(solver: &SolverChoice, model: &Model, outcome: &HistoryOutcome) -> String {
    let words = match solver.method.increments() {
        Method::Bn { r_factor, .. } if r_factor != 1.0 => {
            "r is not scaled to the problem: remove solver.r_factor from the scene"
        }
        Method::Bn { .. } => {
            "there may be no equilibrium beyond this load, or several: try solver.method = \"ip\", more increments \
             (time.increments) or less friction; `stickslip check` shows what holds the body"
        }
        Method::Ip => {
            "try solver.method = \"bn\" or more increments (time.increments); `stickslip check` shows what holds \
             the body"
        }
        // The setting's r is ten times the modulus of steel. It works within two decades.
        Method::PaperBn | Method::PaperIp { .. } if (1e10..1e13).contains(&stiffest(model)) => {
            "the setting paper stops at an absolute Theta meant for loads of MN; try solver.setting = \"default\", \
             loads of that size or more increments (time.increments)"
        }
        Method::PaperBn | Method::PaperIp { .. } => {
            let units = model.units();
            let (modulus, unit) = (units.number(Quantity::Stress, 2e11), units.name(Quantity::Stress));
            return format!(
                "the setting paper has constants meant for moduli near {modulus:e} {unit}: try solver.setting = \
                 \"default\", or scale modulus and loads by the same factor"
            );
        }
    };
    format!("{words}{}", held_by_contact(model, outcome))
}

/// Returns the largest Young's modulus of any cell, Pa; in plane stress a slightly smaller value.
fn stiffest(model: &Model) -> f64 {
    let young = |lambda: f64, mu: f64| mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu);
    model.materials().iter().map(|law| young(law.lambda, law.mu)).fold(0.0, f64::max)
}

/// Returns what the violation of a law is, by its name in reports.
fn broken(law: &str) -> &'static str {
    match law {
        "equilibrium" => "the forces are not in equilibrium",
        "penetration" => "a node penetrates its obstacle",
        "tension" => "a contact force pulls",
        "complementarity" => "a contact force acts across a gap",
        "cone" => "friction exceeds mu times the normal force",
        _ => "a node slips without full friction against its slip",
    }
}

fn unheld(model: &Model, outcome: &HistoryOutcome) -> String {
    match (motion(model, outcome), &outcome.free_motion) {
        (Some(motion), Some(weights)) if !meets_contact(model, weights) => {
            format!("nothing holds {}; add a support", motion.against(&model.units()))
        }
        _ => format!(
            "the stiffness is singular for the present contact statuses{}; look at the contact rows that `stickslip check` \
             names as dependent, or take more increments",
            held_by_contact(model, outcome)
        ),
    }
}

/// Returns `true` if contact forces do work along the rigid motion with these weights.
fn meets_contact(model: &Model, weights: &[f64]) -> bool {
    let problem = &model.problem;
    let mut u = vec![0.0; problem.displacements()];
    for (weight, motion) in weights.iter().zip(problem.rigid_modes()) {
        u.iter_mut().zip(motion).for_each(|(u, r)| *u += weight * r);
    }
    let largest = |x: &[f64]| x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let [w_n, w_t, w_o] = problem.contact_motion(&u);
    let rubs =
        |w: &[f64]| w.iter().zip(problem.mu()).map(|(w, mu)| if *mu > 0.0 { *w } else { 0.0 }).collect::<Vec<_>>();
    [w_n, rubs(&w_t), rubs(&w_o)].iter().any(|w| largest(w) > NEGLIGIBLE * largest(&u))
}

/// Explains a failure for a body that only contact holds. An equilibrium may exist, which was checked before.
fn held_by_contact(model: &Model, outcome: &HistoryOutcome) -> String {
    if model.rigid_motions.is_empty() || model.contacts.is_empty() {
        return String::new();
    }
    let motions: Vec<String> = model.rigid_motions.iter().map(|motion| motion.against(&model.units())).collect();
    format!(
        "; only contact can hold {}: contact forces within the friction limit could balance the loads, but no such \
         state was found{}; add a support, or loads that press the body on its obstacles from the start",
        motions.join(" and "),
        used_up(model, outcome)
    )
}

/// Reports if most of the friction is in use at the end of the last converged increment.
fn used_up(model: &Model, outcome: &HistoryOutcome) -> String {
    let (state, mu) = (&outcome.state, model.problem.mu());
    let used: f64 = state.p_t.iter().zip(&state.p_o).map(|(t, o)| t.hypot(*o)).sum();
    let most: f64 = state.p_n.iter().zip(mu).map(|(p_n, mu)| mu * p_n.max(0.0)).sum();
    if most <= 0.0 || used < MUCH * most {
        return String::new();
    }
    format!(
        ". At t = {} s {:.0} % of all friction is in use: if the loads overcome it, prescribe a displacement in \
         their place",
        outcome.reached,
        100.0 * used / most
    )
}

fn no_equilibrium(model: &Model, outcome: &HistoryOutcome) -> String {
    let motion = motion(model, outcome).map_or("the body".to_string(), |motion| motion.told(&model.units()));
    format!(
        "no equilibrium exists: the loads drive {motion}, and no contact force within the friction limit resists; \
         change the loads or add a support"
    )
}

/// Explains why the exact path ends, and suggests a cure.
fn no_continuation(solver: &SolverChoice, model: &Model, outcome: &HistoryOutcome) -> String {
    if let Some(motion) = motion(model, outcome) {
        return format!(
            "the quasi-static motion ends here: within this increment the loads drive {}, and no contact force \
             within the friction limit resists; change the loads or add a support",
            motion.told(&model.units())
        );
    }
    let proof = if outcome.lost.is_some_and(|lost| lost.certain) {
        "no rates satisfy the laws for any contact statuses"
    } else {
        "no rates that satisfy the laws were found"
    };
    let cure = if solver.method == (HistoryMethod::ExactPath { jump: true }) {
        "no state to jump to was found up to the end of this increment: fewer increments let the jump reach further, \
         and less friction may avoid it"
    } else if model.rigid_motions.is_empty() {
        "the motion can continue only by a jump, with solver.jump = true; less friction may avoid it"
    } else {
        "supports leave the body a rigid motion, and rates are not unique if contact leaves it too: add a support, \
         or continue with solver.jump = true to where the body comes to rest"
    };
    format!("the quasi-static motion ends here: {proof}; {cure}")
}

fn edge_friction(model: &Model, outcome: &HistoryOutcome) -> String {
    let motion = motion(model, outcome).map_or("the body".to_string(), |motion| motion.told(&model.units()));
    format!(
        "the loads drive {motion}, and only friction across an edge between two obstacles could resist, but nodes \
         in front of both have friction along that edge alone: let the boundaries share no node, change the loads \
         or add a support"
    )
}

fn motion(model: &Model, outcome: &HistoryOutcome) -> Option<RigidMotion> {
    // In the first increment nothing is known of the contact.
    let knows = outcome.state.p_n.iter().any(|p| *p > 0.0);
    let is_closed = |i: usize| !knows || outcome.state.p_n.get(i).is_some_and(|p| *p > 0.0);
    let time = outcome.records.last().map_or(outcome.reached, |record| record.time);
    model.motion_along_contact(time, outcome.free_motion.as_ref()?, is_closed)
}

/// Returns the node of the largest violation. `None` for a body that comes free, which violates no law at any node.
fn worst_node(model: &Model, outcome: &HistoryOutcome) -> Option<WorstNode> {
    let violation = outcome.violation.filter(|violation| violation.error > 0.0 || violation.error.is_nan())?;
    let node = match violation.law {
        Law::Equilibrium => model.dofs.in_mesh(model.dofs.node_of(violation.place)?),
        _ => model.contacts.get(violation.place)?.node,
    };
    let position = model.mesh.nodes[node][..model.mesh.dimension].to_vec();
    Some(WorstNode { law: violation.law, error: violation.error, node, position })
}
