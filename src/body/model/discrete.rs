//! A description on its mesh before assembly: displacements, laws and springs.

use std::sync::Arc;

use super::coupling::Couplings;
use super::holding::{self, Holding};
use super::joint::Joints;
use super::pair::{Pair, Pairs};
use super::{ModelError, bodies, element, load, meridian};
use crate::body::constraints::Dofs;
use crate::body::description::Description;
use crate::body::fem::{Elasticity, Element, NodalVolumes, Spring};
use crate::body::mesh::Mesh;

/// The parts of a model before assembly.
pub(super) struct Discrete {
    pub mesh: Arc<Mesh>,
    pub couplings: Couplings,
    pub joints: Joints,
    /// The displacements that each support holds.
    pub holdings: Vec<Holding>,
    pub dofs: Dofs,
    pub element: Element,
    /// The elastic law of each cell.
    pub materials: Vec<Elasticity>,
    pub pairs: Pairs,
    pub volumes: NodalVolumes,
    /// The springs of each bed.
    pub beds: Vec<Vec<Spring>>,
}

impl Discrete {
    pub(super) fn new(description: &Description) -> Result<Self, ModelError> {
        description.check()?;
        let mesh = meridian::meridian(description, description.mesh.made()?)?;
        description.formulas_suit(mesh.dimension)?;
        bodies::keep_apart(description, &mesh)?;
        let couplings = Couplings::new(description, &mesh)?;
        let points = couplings.points(&mesh);
        let holdings = holding::holdings(description, &mesh, &couplings, &points)?;
        let joints = Joints::new(description, &mesh)?;
        joints.meet_no_contact(description, &mesh)?;
        let dofs = holding::dofs(&mesh, points, &joints, &holdings)?;
        let element = element::element(description, &mesh)?;
        let materials = description.material.laws(&mesh)?;
        let mut pairs = Pairs::new(description, &mesh, &dofs, &holdings, &materials, (&couplings, &joints))?;
        let dofs = pairs.dofs(description, &mesh, &joints, dofs)?;
        let volumes = NodalVolumes::new(&mesh, element, |e| materials[e])?;
        let beds = load::springs(description, &mesh, &couplings, &dofs)?;
        Ok(Discrete { mesh, couplings, joints, holdings, dofs, element, materials, pairs, volumes, beds })
    }
}

/// Returns `true` if the stiffness is a sum over cells, each on displacements of its own nodes.
pub(super) fn is_a_sum_over_cells<'a>(
    dofs: &Dofs,
    pairs: &[Pair],
    volumes: &NodalVolumes,
    mut springs: impl Iterator<Item = &'a Spring>,
) -> bool {
    !dofs.has_nodes_outside() && pairs.is_empty() && volumes.is_empty() && springs.next().is_none()
}
