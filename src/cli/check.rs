//! `stickslip check`.

use std::collections::BTreeSet;

use clap::Args;
use stickslip::fem::RigidMotion;
use stickslip::formulation::Layout;
use stickslip::model::Model;
use stickslip::scene::{Element, HalfPlane, Material, Mesh, Plane, Scene, Shape};
use stickslip::solvability::{Conditions, rigid_equilibrium};

use super::{Failure, SceneArgs, discretise};

#[derive(Args)]
pub(super) struct CheckArgs {
    #[command(flatten)]
    scene: SceneArgs,
}

pub(super) fn check(args: &CheckArgs) -> Result<(), Failure> {
    let scene = args.scene.read()?;
    let model = discretise(&scene)?;
    say!("{}", scene.title);
    body(&scene, &model);
    contact(&scene, &model);
    loads(&scene, &model);
    let solver = &scene.solver;
    say!(
        "history      {} increments of {} s to t = {} s",
        scene.time.increments,
        scene.time.end / scene.time.increments as f64,
        scene.time.end
    );
    say!(
        "solver       {}, setting {}, {}; at most {} iterations; error of every law at most {:.0e}",
        solver.method.name(),
        solver.method.setting(),
        solver.linear.map_or("auto".to_string(), |linear| linear.to_string()),
        solver.max_iterations,
        solver.tolerance
    );
    holding(&model);
    if !model.contacts.is_empty() {
        theorem(&model);
        equilibrium(&scene, &model);
    }
    Ok(())
}

fn body(scene: &Scene, model: &Model) {
    let kind = match scene.mesh {
        Mesh::Block { size: [width, height], elements: [nx, ny], grading } => {
            let graded = match grading {
                [1.0, 1.0] => String::new(),
                [x, y] => format!(" (graded 1 : {x} and 1 : {y})"),
            };
            format!("block {width} m x {height} m, {nx} x {ny}{graded}")
        }
        Mesh::HalfPlane(HalfPlane { size: [width, height], contact_elements, outer_elements, layers, .. }) => {
            format!("half-plane {width} m x {height} m, ({contact_elements} + {outer_elements}) x {layers}")
        }
    };
    let element = match scene.element {
        Element::Bilinear => "bilinear",
        Element::BBar => "B-bar",
    };
    say!(
        "mesh         {kind} {element} quadrilaterals, {} nodes, boundaries {}",
        model.mesh.nodes.len(),
        model.mesh.boundary_names().join(", ")
    );
    let Material { young, poisson, plane, layers } = &scene.material;
    let state = match plane {
        Plane::Strain => "plane strain",
        Plane::Stress => "plane stress",
    };
    say!("material     E = {} Pa, nu = {poisson}, {state}, unit thickness", number(*young));
    let mut bottom = 0.0;
    for layer in layers {
        // A height is a sum of thicknesses; fifteen digits hide its rounding.
        let top: f64 = format!("{:.14e}", layer.top).parse().unwrap_or(layer.top);
        let young = number(layer.young);
        say!("layer        y = {bottom} to {top} m: E = {young} Pa, nu = {}", layer.poisson);
        bottom = top;
    }
    for support in &scene.supports {
        let held = ["x", "y"].into_iter().zip(support.fix).filter(|&(_, fix)| fix).map(|(name, _)| name);
        say!("support      {}: {} held", support.boundary, held.collect::<Vec<_>>().join(" and "));
    }
}

fn contact(scene: &Scene, model: &Model) {
    for contact in &scene.contacts {
        let shape = match contact.obstacle.shape {
            Shape::Plane { gap } => format!("plane at {} m", number(gap)),
            Shape::Cylinder { radius, apex: [x, y] } => format!("cylinder, radius {radius} m, apex ({x}, {y}) m"),
        };
        let moves = match contact.obstacle.approach.last() {
            Some([t, distance]) => format!(", moves in by {} m until {t} s", number(*distance)),
            None => String::new(),
        };
        say!("contact      {}: {shape}{moves}, mu = {}", contact.boundary, contact.friction);
    }
    let layout = Layout::new(&model.problem);
    say!("unknowns     {} displacements u", layout.displacements());
    match (layout.contacts(), layout.tangentials()) {
        (0, _) => say!("             no contact: one linear solve an increment, one factorisation"),
        (n, t) => {
            say!("             {n} normal forces p_n");
            let rest = n - t;
            match rest {
                0 => say!("             {t} tangential forces p_t"),
                _ => say!("             {t} tangential forces p_t; {rest} nodes have no friction or cannot slide"),
            }
        }
    }
}

fn loads(scene: &Scene, model: &Model) {
    for (load, case) in scene.loads.iter().zip(&model.loading.cases) {
        let [mut x, mut y] = [0.0; 2];
        for node in 0..model.mesh.nodes.len() {
            let [dx, dy] = model.dofs.node(node);
            x += dx.map_or(0.0, |dof| case.force[dof]);
            y += dy.map_or(0.0, |dof| case.force[dof]);
        }
        let mut history: Vec<String> = load.history.iter().map(|[t, factor]| format!("{factor} at {t} s")).collect();
        if history.len() > 8 {
            let left_out = format!("({} more)", history.len() - 7);
            history.splice(6..history.len() - 1, [left_out]);
        }
        say!(
            "load         {}: ({}, {}) N/m2, in all ({}, {}) N on what is free; factor {}",
            load.boundary,
            number(load.traction[0]),
            number(load.traction[1]),
            number(x),
            number(y),
            history.join(", ")
        );
    }
}

/// A number in few digits, 0 as 0.
fn number(x: f64) -> String {
    if x == 0.0 { "0".to_string() } else { format!("{:e}", (format!("{x:.5e}")).parse().unwrap_or(x)) }
}

fn holding(model: &Model) {
    if model.rigid_motions.is_empty() {
        say!("held         by its supports");
        return;
    }
    let by = if model.contacts.is_empty() { "nothing holds" } else { "only contact can hold" };
    for motion in &model.rigid_motions {
        say!("NOT HELD     {by} the body against {motion}");
    }
}

fn theorem(model: &Model) {
    let conditions = Conditions::of(&model.problem);
    if conditions.hold() {
        say!("theorem 3    holds: (a) no rigid motion leaves every obstacle; (b) contact rows independent");
        return;
    }
    let mut label = "theorem 3";
    if let Some(motion) = conditions.leaving.as_deref().and_then(|weights| named(model, weights)) {
        say!(
            "{label:<12} (a) violated: {motion} moves no node towards an obstacle, \
             so the loads have to keep the body from it; or add a support"
        );
        label = "";
    }
    let nodes: BTreeSet<usize> = conditions.dependent.iter().map(|&i| model.contacts[i].node).collect();
    if let Some(&first) = nodes.first() {
        let [x, y] = model.mesh.nodes[first];
        let others = match nodes.len() - 1 {
            0 => String::new(),
            n => format!(" (and at {n} more)"),
        };
        say!(
            "{label:<12} (b) violated: the contact rows at ({x}, {y}) m{others} depend on each other, so the contact \
             forces there are not unique; turn a normal, or take away a contact or a support"
        );
    }
}

/// Tells the first increment that no contact force can bring into balance.
fn equilibrium(scene: &Scene, model: &Model) {
    if model.rigid_motions.is_empty() {
        return;
    }
    let mut force = vec![0.0; model.problem.displacements()];
    let failed = scene.time.all().into_iter().find_map(|time| {
        model.loading.force(time, &mut force);
        Some((time, rigid_equilibrium(&model.problem, &force).err()?))
    });
    if let Some((time, weights)) = failed
        && let Some(motion) = named(model, &weights)
    {
        say!(
            "NO BALANCE   first at t = {time} s: the loads drive {motion}, which no contact force within its friction \
             resists; change the loads or add a support"
        );
    }
}

fn named(model: &Model, weights: &[f64]) -> Option<RigidMotion> {
    RigidMotion::combination(&model.rigid_motions, weights)
}
