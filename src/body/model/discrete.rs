//! A description on its mesh, before anything is assembled: displacements, laws, springs.

use std::sync::Arc;

use super::holding::{self, Holding};
use super::pair::{Pair, Pairs};
use super::{ModelError, bodies, element, load, meridian};
use crate::body::description::Description;
use crate::body::fem::{Dofs, Elasticity, Element, NodalVolumes, Spring};
use crate::body::mesh::Mesh;

/// What a model begins with.
pub(super) struct Discrete {
    pub mesh: Arc<Mesh>,
    /// What holds the body, support by support.
    pub holdings: Vec<Holding>,
    pub dofs: Dofs,
    pub element: Element,
    /// The law of each cell.
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
        let holdings = holding::holdings(description, &mesh)?;
        let dofs = holding::dofs(&mesh, &holdings)?;
        let element = element::element(description, &mesh)?;
        let materials = description.material.laws(&mesh)?;
        let mut pairs = Pairs::new(description, &mesh, &dofs, &holdings, &materials)?;
        let dofs = pairs.dofs(description, &mesh, dofs)?;
        let volumes = NodalVolumes::new(&mesh, element, |e| materials[e])?;
        let beds = load::springs(description, &mesh)?;
        Ok(Discrete { mesh, holdings, dofs, element, materials, pairs, volumes, beds })
    }
}

/// Whether the stiffness is the sum of those of the cells, each on displacements of its own nodes.
pub(super) fn is_a_sum_over_cells<'a>(
    pairs: &[Pair],
    volumes: &NodalVolumes,
    mut springs: impl Iterator<Item = &'a Spring>,
) -> bool {
    pairs.is_empty() && volumes.is_empty() && springs.next().is_none()
}
