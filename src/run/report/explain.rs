//! Explains why a run did not converge: the violated law, its place, and the cure, by the keys of a scene.

use serde::{Deserialize, Serialize};

use crate::algebra::vector::dot;
use crate::base::units::{Quantity, UnitSystem, six_digits};
use crate::body::constraints::RigidMotion;
use crate::body::model::Model;
use crate::solver::history::{HistoryOutcome, Method, SolverChoice, Status};
use crate::solver::laws::Law;
use crate::solver::solvability::friction_work;

/// A smaller motion of contact nodes, relative to that of the body, is rounding.
const NEGLIGIBLE: f64 = 1e-9;

/// The reason why a run ended early.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct Explanation {
    /// The reason in words; empty if the run reached its end.
    pub reason: String,
    /// The node of the largest violation in the increment that failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub worst: Option<WorstNode>,
    /// The slip of a joint as a whole, if the verdict is `slips`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slip: Option<JointSlip>,
}

/// The slip of a joint as a whole.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct JointSlip {
    /// The bodies that slide, and how.
    pub motion: String,
    /// The latest time at which equilibrium was found, and a time at which the joint slips, s.
    pub between: [f64; 2],
    /// The loads that change between these times, with their factors.
    pub factors: Vec<ChangingLoad>,
    /// The share of the friction against this motion that the loads use at the first of these times.
    pub friction_used: f64,
    /// The force (N) along the motion that friction can take up there, if one body is translated.
    pub force: Option<f64>,
    /// The moment (N m) about the axis of the motion that friction can take up there, if one body turns.
    pub moment: Option<f64>,
}

/// A load that changes where nodes or a joint slip.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct ChangingLoad {
    /// The number of the load, from 0.
    pub load: usize,
    /// Its factors at two times: those of [`JointSlip::between`], or when some nodes slip, and all.
    pub between: [f64; 2],
}

/// A node where a law is violated.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
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
        let slip = JointSlip::of(model, outcome);
        Explanation { reason: reason(solver, model, outcome, slip.as_ref()), worst: worst_node(model, outcome), slip }
    }
}

impl ChangingLoad {
    /// Returns the loads that one of these pairs of times (s) has different factors of, with their factors at `times` (s).
    pub(super) fn all(model: &Model, times: [f64; 2], pairs: &[[f64; 2]]) -> Vec<Self> {
        let cases = model.loading.cases().iter().take(model.description().loads.len()).enumerate();
        let changing = cases.filter(|(_, case)| pairs.iter().any(|[t, s]| case.factor(*t) != case.factor(*s)));
        changing.map(|(load, case)| ChangingLoad { load, between: times.map(|t| case.factor(t)) }).collect()
    }

    /// Returns the factors of `all` at the first or second time in brackets; empty without loads.
    pub fn in_words(all: &[Self], k: usize) -> String {
        let point = |changing: &Self| format!("load[{}] at {:.4}", changing.load, changing.between[k]);
        let all = all.iter().map(point).collect::<Vec<_>>().join(", ");
        if all.is_empty() { all } else { format!(" ({all})") }
    }
}

impl JointSlip {
    fn of(model: &Model, outcome: &HistoryOutcome) -> Option<Self> {
        let (reached, slip) = (outcome.reached, outcome.slip.as_ref()?);
        let motion = motion(model, outcome)?;
        let u = motion.displacements(&model.mesh, &model.constraints.dofs);
        let mu = model.loading.friction().map_or(model.problem.mu().to_vec(), |friction| friction.at(reached));
        let most = friction_work(&model.problem, &mu, &slip.p_n, &u);
        let mut force = vec![0.0; u.len()];
        model.loading.force(reached, &mut force);
        let against = |wanted| motion.extent().filter(|(quantity, _)| *quantity == wanted).map(|(_, size)| most / size);
        let between = [reached, slip.by];
        Some(JointSlip {
            motion: motion.sliding(&model.units()),
            between,
            factors: ChangingLoad::all(model, between, &[between]),
            friction_used: dot(&u, &force) / most,
            force: against(Quantity::Force),
            moment: against(Quantity::Moment),
        })
    }

    /// Describes the slip; an exact path ends where the joint gives way.
    fn in_words(&self, units: &UnitSystem, exact_path: bool) -> String {
        // Six digits tell times apart that are a part of an increment apart.
        let [from, by] = self.between.map(six_digits);
        let at = |k: usize| ChangingLoad::in_words(&self.factors, k);
        let (found, there) = if exact_path {
            (format!("The quasi-static motion ends at t = {from} s{}", at(0)), "there")
        } else {
            let found = format!("Equilibrium was found up to t = {from} s{}, and none at t = {by} s{}", at(0), at(1));
            (found, "at the former")
        };
        let most = [(Quantity::Force, self.force), (Quantity::Moment, self.moment)];
        let most = most
            .into_iter()
            .filter_map(|(quantity, most)| Some(format!(" ({} at most)", units.rounded(quantity, most?, 4))));
        // Without a pressure before, there was no friction to use; loads along the motion alone use it.
        let used = match self.friction_used {
            used if used > 0.0 && used.is_finite() => {
                let most = most.collect::<String>();
                format!("; {there} the loads use {:.1} % of the friction{most}", 100.0 * used)
            }
            _ => String::new(),
        };
        format!(
            "the joint slips as a whole: {}. {found}{used}. To follow the slip, prescribe a displacement in place of \
             the load",
            self.motion
        )
    }
}

fn reason(solver: &SolverChoice, model: &Model, outcome: &HistoryOutcome, slip: Option<&JointSlip>) -> String {
    let exact_path = solver.method.is_exact_path();
    let Some(record) = outcome.records.iter().find(|record| record.status != Status::Converged) else {
        let words = match outcome.status {
            Status::Singular => return unconstrained(model, outcome),
            Status::Interrupted => "stopped on request",
            Status::Unsupported if exact_path => {
                "the exact path requires nodes that slide along lines, constant friction and independent contact \
                 rows; use the method bn"
            }
            Status::Unsupported => {
                "this interior point method has only one tangent per node, but nodes slide in a plane; use the \
                 method bn"
            }
            Status::OutOfMemory => {
                "memory ran out; the increments before are complete: use a coarser mesh or a machine with more memory"
            }
            _ => "",
        };
        return words.to_string();
    };
    let increment = format!("increment {} (t = {} s)", record.index, six_digits(record.time));
    if let Some(slip) = slip {
        return format!("{increment}: {}", slip.in_words(&model.units(), exact_path));
    }
    let (law, error) = record.kkt.worst();
    let place = worst_node(model, outcome)
        .map_or(String::new(), |worst| format!(" at the node {}", model.units().point(model.mesh.nodes[worst.node])));
    let violated =
        format!("{}{place}: relative error {error:.1e}, tolerance {:.0e} ({law})", broken(law), solver.tolerance);
    let why = match outcome.status {
        Status::Singular => unconstrained(model, outcome),
        Status::NoEquilibrium => no_equilibrium(model, outcome),
        Status::NoContinuation => no_continuation(model, outcome),
        Status::Interrupted => "stopped on request".to_string(),
        Status::Inaccurate | Status::Stalled if law == Law::Equilibrium && error <= 10.0 * outcome.rounding => format!(
            "{violated}; displacements that are so much larger than the deformation, as of a slender or a hardly held \
             body, have this rounding error: hold the body by a support or stiffer springs, or, if this accuracy \
             suffices, set solver.tolerance above it"
        ),
        Status::Inaccurate if exact_path => {
            format!("{violated} on the exact path, which was lost; use the method bn, or another solver.linear")
        }
        Status::Inaccurate => {
            format!("the method stopped with Theta = {:.1e}, but {violated}; {}", record.theta, advice(solver, model))
        }
        Status::MaxIterations => {
            let limit = solver.max_iterations;
            // From 100 on, the limit is hardly the cause: no increment of the extreme test cases is known to need more.
            let advice =
                if limit < 100 { "try a larger solver.max_iterations".to_string() } else { advice(solver, model) };
            format!("no convergence within max_iterations = {limit}: {violated}; {advice}")
        }
        Status::Cycling => {
            format!("the iteration cycles: {violated}; {}", advice(solver, model))
        }
        Status::Stalled => format!("the iteration stalls: {violated}; {}", advice(solver, model)),
        Status::Diverged | Status::NotFinite => {
            format!("the numbers left the range of double precision: {violated}; {}", advice(solver, model))
        }
        Status::Converged | Status::Slips | Status::OutOfMemory | Status::Unsupported => violated,
    };
    let reached = if exact_path || record.parts == 0 {
        String::new()
    } else {
        format!("; substeps of it converged until t = {} s", six_digits(outcome.reached))
    };
    format!("{increment}: {why}{reached}")
}

/// Suggests a cure if the iteration stops too late or too early.
fn advice(solver: &SolverChoice, model: &Model) -> String {
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
    format!("{words}{}", held_by_contact(model))
}

/// Returns the largest Young's modulus of any cell, Pa; in plane stress a slightly smaller value.
fn stiffest(model: &Model) -> f64 {
    let young = |lambda: f64, mu: f64| mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu);
    model.materials().iter().map(|law| young(law.lambda, law.mu)).fold(0.0, f64::max)
}

/// Returns what the violation of a law is, by its name in reports.
fn broken(law: Law) -> &'static str {
    match law {
        Law::Equilibrium => "the forces are not in equilibrium",
        Law::Penetration => "a node penetrates its obstacle",
        Law::Tension => "a contact force pulls",
        Law::Complementarity => "a contact force acts across a gap",
        Law::Cone => "friction exceeds mu times the normal force",
        Law::Dissipation => "a node slips without full friction against its slip",
    }
}

fn unconstrained(model: &Model, outcome: &HistoryOutcome) -> String {
    match (motion(model, outcome), &outcome.free_motion) {
        (Some(motion), Some(weights)) if !meets_contact(model, weights) => {
            format!("nothing holds {}; add a support", motion.against(&model.units()))
        }
        _ => format!(
            "the stiffness is singular for the present contact statuses{}; look at the contact rows that `stickslip check` \
             names as dependent, or take more increments",
            held_by_contact(model)
        ),
    }
}

/// Returns `true` if contact forces do work along the rigid motion with these weights.
fn meets_contact(model: &Model, weights: &[f64]) -> bool {
    let problem = &model.problem;
    let u = problem.rigid_motion(weights);
    let largest = |x: &[f64]| x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let [w_n, w_t, w_o] = problem.contact_motion(&u);
    let rubs =
        |w: &[f64]| w.iter().zip(problem.mu()).map(|(w, mu)| if *mu > 0.0 { *w } else { 0.0 }).collect::<Vec<_>>();
    [w_n, rubs(&w_t), rubs(&w_o)].iter().any(|w| largest(w) > NEGLIGIBLE * largest(&u))
}

/// Explains a failure for a body that only contact holds. An equilibrium may exist, which was checked before.
fn held_by_contact(model: &Model) -> String {
    if model.constraints.rigid_motions.is_empty() || model.contact.nodes.is_empty() {
        return String::new();
    }
    let motions: Vec<String> =
        model.constraints.rigid_motions.iter().map(|motion| motion.against(&model.units())).collect();
    format!(
        "; only contact can hold {}: contact forces within the friction limit could balance the loads, but no such \
         state was found; add a support, or loads that press the body on its obstacles from the start",
        motions.join(" and ")
    )
}

fn no_equilibrium(model: &Model, outcome: &HistoryOutcome) -> String {
    let motion = motion(model, outcome).map_or("the body".to_string(), |motion| motion.describe(&model.units()));
    format!(
        "no equilibrium: the loads drive {motion}, and no contact force within the friction limit resists; \
         change the loads or add a support"
    )
}

/// Explains why the exact path ends, and suggests a cure.
fn no_continuation(model: &Model, outcome: &HistoryOutcome) -> String {
    if let Some(motion) = motion(model, outcome) {
        return format!(
            "the quasi-static motion ends here: within this increment the loads drive {}, and no contact force \
             within the friction limit resists; change the loads or add a support",
            motion.describe(&model.units())
        );
    }
    let proof = if outcome.lost.is_some_and(|lost| lost.certain) {
        "no rates satisfy the laws for any contact statuses"
    } else {
        "no rates that satisfy the laws were found"
    };
    let cure = if model.constraints.rigid_motions.is_empty() {
        "the motion can continue only by a jump, which solver.method = \"bn\" solves with a warning; less friction may avoid it"
    } else {
        "supports leave the body a rigid motion, and rates are not unique if contact leaves it too: add a support, or take \
         solver.method = \"bn\", which finds where the body comes to rest"
    };
    format!("the quasi-static motion ends here: {proof}; {cure}")
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
        Law::Equilibrium => model.constraints.dofs.in_mesh(model.constraints.dofs.node_of(violation.place)?),
        _ => model.contact.nodes.get(violation.place)?.node,
    };
    let position = model.mesh.nodes[node][..model.mesh.dimension].to_vec();
    Some(WorstNode { law: violation.law, error: violation.error, node, position })
}
