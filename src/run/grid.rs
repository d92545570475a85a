//! The positions of a model's unknowns, for multigrid.

use crate::algebra::linear::{Grid, GridContact, SparseLu, engine};
use crate::algebra::vector::{axis, cross, minus};
use crate::body::model::Model;
use crate::solver::formulation::Layout;
use crate::solver::history::{LinearAlgebra, Method, SystemSolver};
use crate::solver::problem::OwnBasis;

/// Returns the multigrid system of `model`, with `options` if the solver is PETSc's, or one with a direct solver if there is no grid.
pub(super) fn system(model: &Model, method: Method, options: Option<&str>) -> SystemSolver {
    let Some(engine) = engine() else { return LinearAlgebra::Multigrid.into() };
    let Some(grid) = grid(model) else { return LinearAlgebra::Whole(SparseLu::for_ranks()).into() };
    let grid = Grid { interior: method.is_interior(), ..grid };
    SystemSolver::from(engine.iterative(grid, options))
}

/// Returns the grid of `model`. `None` if the contact rows of a node involve displacements of other nodes, a node has
/// two contacts, or there are nodes outside the mesh: reference points, and jumps of joints.
pub fn grid(model: &Model) -> Option<Grid> {
    let (mesh, dofs, problem) = (&model.mesh, &model.constraints.dofs, &model.problem);
    if dofs.has_nodes_outside() {
        return None;
    }
    let mut displacements = vec![(0, 0); problem.displacements()];
    for node in 0..mesh.nodes.len() {
        for (direction, dof) in dofs.node(node).iter().enumerate() {
            if let Some(dof) = dof {
                displacements[*dof] = (node, direction);
            }
        }
    }
    let basis = OwnBasis::of(problem);
    let layout = Layout::new(problem);
    let mut used = vec![false; mesh.nodes.len()];
    let mut contacts = Vec::with_capacity(layout.contacts());
    for i in 0..layout.contacts() {
        let row = match &basis {
            Some(basis) => basis.row(problem.c_n(), i),
            None => problem.c_n().row(i).to_vec(),
        };
        let mut nodes = row.iter().map(|(dof, _)| displacements[*dof].0);
        let node = nodes.next()?;
        if nodes.any(|other| other != node) || std::mem::replace(&mut used[node], true) {
            return None;
        }
        contacts.push(GridContact { node, forces: [layout.p_t(i), layout.p_o(i), Some(layout.p_n(i))] });
    }
    let dimension = mesh.components();
    let count = mesh.nodes.len().max(1) as f64;
    let centre = [0, 1, 2].map(|c| mesh.nodes.iter().map(|x| x[c]).sum::<f64>() / count);
    let shifts = (0..dimension).map(|c| dofs.unknowns(|_| axis(c)));
    let turns = if dimension == 2 { 2..3 } else { 0..3 };
    let rotations = turns.map(|c| dofs.unknowns(|node| cross(axis(c), minus(mesh.nodes[node], centre))));
    Some(Grid {
        interior: false,
        dimension,
        nodes: mesh.nodes.len(),
        displacements,
        contacts,
        changed: basis.map(|basis| basis.changes().to_vec()).unwrap_or_default(),
        motions: shifts.chain(rotations).collect(),
    })
}
