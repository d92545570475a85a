//! A stiffness whose rows are distributed over several processes; each process assembles its own rows.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

use super::discrete::{self, Discrete};
use super::pair::Pairs;
use super::{Model, ModelError};
use crate::algebra::linear::{LinearError, Stiffness};
use crate::algebra::sparse::{NodeRows, Symmetric};
use crate::body::constraints::{Dofs, assemble_part};
use crate::body::contact::ContactNode;
use crate::body::description::Description;
use crate::body::fem::{Elasticity, Element};
use crate::body::mesh::Mesh;

/// A function that distributes a stiffness over processes, from its rows and the nodes whose columns this process
/// keeps. `None` if this is impossible, for example because another process does not have the same body.
pub type Share<'a> = &'a dyn Fn(&dyn NodeRows, &[bool]) -> Result<Option<Stiffness>, LinearError>;

/// A body before assembly.
#[derive(Debug, Clone)]
pub struct Body {
    mesh: Arc<Mesh>,
    dofs: Dofs,
    element: Element,
    materials: Vec<Elasticity>,
}

impl Body {
    /// Creates the body of `description`; `None` if its stiffness is not a sum over cells, each on displacements of its
    /// own nodes.
    ///
    /// # Errors
    /// As [`super::Model::build`], for mesh, supports and materials.
    pub fn of(description: &Description) -> Result<Option<Self>, ModelError> {
        let discrete = Discrete::new(description)?;
        Ok(Self::on(&discrete))
    }

    pub(super) fn on(discrete: &Discrete) -> Option<Self> {
        let Discrete { mesh, dofs, element, materials, pairs: Pairs { all: pairs, .. }, volumes, beds, .. } = discrete;
        let body =
            || Body { mesh: Arc::clone(mesh), dofs: dofs.clone(), element: *element, materials: materials.clone() };
        discrete::is_a_sum_over_cells(dofs, pairs, volumes, beds.iter().flatten()).then(body)
    }

    /// Returns `K` distributed by `share`; `None` if the rows of a contact node contain displacements of other nodes.
    pub(super) fn stiffness(
        &self,
        contacts: &[ContactNode],
        share: Share<'_>,
    ) -> Result<Option<Stiffness>, LinearError> {
        let Some(is_contact) = alone_with_contact(&self.mesh, &self.dofs, contacts) else { return Ok(None) };
        let mut near = is_contact.clone();
        for cell in self.mesh.cells.iter().filter(|cell| cell.nodes.iter().any(|node| is_contact[*node])) {
            cell.nodes.iter().for_each(|&node| near[node] = true);
        }
        share(self, &near)
    }
}

/// Marks the nodes with contact; `None` if the rows of a node contain displacements of other nodes.
fn alone_with_contact(mesh: &Mesh, dofs: &Dofs, contacts: &[ContactNode]) -> Option<Vec<bool>> {
    let mut is_contact = vec![false; mesh.nodes.len()];
    for contact in contacts {
        let own = dofs.node(contact.node);
        let rows = [&contact.normal, &contact.tangents[0], &contact.tangents[1]];
        let is_local = rows.into_iter().flatten().all(|(dof, _)| own.contains(&Some(*dof)));
        if !is_local || std::mem::replace(&mut is_contact[contact.node], true) {
            return None;
        }
    }
    Some(is_contact)
}

impl Model {
    /// Returns `true` if its stiffness can be assembled by rows of nodes on each process: [`Body::of`] returns a body,
    /// and contact rows contain displacements of single nodes.
    pub(crate) fn has_rows(&self) -> bool {
        discrete::is_a_sum_over_cells(&self.dofs, &self.pairs, &self.volumes, self.statics.springs())
            && alone_with_contact(&self.mesh, &self.dofs, &self.contacts).is_some()
    }
}

impl NodeRows for Body {
    fn dimension(&self) -> usize {
        self.mesh.dimension
    }

    fn nodes(&self) -> usize {
        self.mesh.nodes.len()
    }

    fn order(&self) -> usize {
        self.dofs.free()
    }

    fn places(&self, node: usize) -> [Option<usize>; 3] {
        [0, 1, 2].map(|c| self.dofs.node(node).get(c).copied().flatten())
    }

    fn each_cell(&self, take: &mut dyn FnMut(&[usize])) {
        self.mesh.cells.iter().for_each(|cell| take(&cell.nodes));
    }

    fn fingerprint(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        let mut number = |x: f64| x.to_bits().hash(&mut hasher);
        self.mesh.nodes.iter().flatten().for_each(|x| number(*x));
        self.materials.iter().for_each(|law| [law.lambda, law.mu].into_iter().for_each(&mut number));
        self.mesh.cells.iter().for_each(|cell| cell.nodes.hash(&mut hasher));
        (0..self.nodes()).for_each(|node| self.places(node).hash(&mut hasher));
        hasher.finish()
    }

    fn rows(&self, nodes: &[bool]) -> Option<Symmetric> {
        // The first process finds the invalid cell when it assembles all cells.
        assemble_part(&self.mesh, &self.dofs, self.element, |e| self.materials[e], nodes).ok()
    }
}
