//! From a scene to the discrete problem: mesh, `K`, contact maps, loads.

mod body;
mod contact;
mod range;
mod stress;

use crate::contact::{ContactBoundary, ContactNode, Facing, Obstacle, ObstacleMotion, share_edges};
use crate::fem::{Dofs, Elasticity, Element, InvertedElement, RigidMotion, assemble, facet_load, rigid_motions};
use crate::linear::{Direct, built_in};
use crate::loading::{Bend, LoadCase, Loading, Motion};
use crate::mesh::{Boundary, Mesh, MeshFileError};
use crate::problem::ContactProblem;
use crate::scene::{self, LinearBackend, Scene, SceneError};
use crate::sparse::Csr;
use crate::units::Scaling;

/// A scene, discretised.
#[derive(Debug, Clone)]
pub struct Model {
    /// The mesh.
    pub mesh: Mesh,
    /// The law of each cell.
    pub materials: Vec<Elasticity>,
    /// Its strains.
    pub element: Element,
    /// Whether the body is a thin plate, in plane stress.
    pub thin: bool,
    /// The numbering of the free displacements.
    pub dofs: Dofs,
    /// The contact nodes, in the order of `problem`'s rows.
    pub contacts: Vec<ContactNode>,
    /// The boundaries they stand on.
    pub contact_boundaries: Vec<ContactBoundary>,
    /// The obstacle in front of each of these boundaries, and how it moves.
    pub obstacles: Vec<(Obstacle, ObstacleMotion)>,
    /// The algebraic problem.
    pub problem: ContactProblem,
    /// The loads and gaps over time.
    pub loading: Loading,
    /// The rigid motions behind `problem.free_motions`.
    pub rigid_motions: Vec<RigidMotion>,
}

/// Why a scene cannot be discretised.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ModelError {
    /// The scene contradicts its mesh.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scene(#[from] SceneError),
    /// The scene's mesh file is not sound.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Mesh(#[from] MeshFileError),
    /// An element of the mesh is not sound.
    #[error(transparent)]
    Element(#[from] InvertedElement),
}

impl Model {
    /// Discretises `scene`.
    ///
    /// # Errors
    /// When the scene names a boundary the mesh does not have, asks for contact where supports hold
    /// the body inside the obstacle, or leaves nothing free.
    pub fn new(scene: &Scene) -> Result<Self, ModelError> {
        let mesh = body::mesh(scene)?;
        let dofs = body::dofs(scene, &mesh)?;
        let element = body::element(scene, &mesh)?;
        let materials = body::materials(scene, &mesh)?;
        let stiffness = assemble(&mesh, &dofs, element, |e| materials[e])?;

        let (mut contacts, mut mu) = (Vec::<ContactNode>::new(), Vec::new());
        let (mut contact_boundaries, mut obstacles) = (Vec::new(), Vec::new());
        for contact in &scene.contacts {
            let first = contacts.len();
            let (obstacle, motion, nodes) = contact::boundary(scene, &mesh, &dofs, contact)?;
            contact::no_contradiction(scene, contact, &contacts, &nodes)?;
            contacts.extend(nodes);
            mu.resize(contacts.len(), contact.friction);
            let nodes = first..contacts.len();
            contact_boundaries.push(ContactBoundary { name: contact.boundary.to_string(), nodes });
            obstacles.push((obstacle, motion));
        }
        share_edges(&mut contacts, &mu, &dofs);
        let (mut motions, mut bends) = (Vec::new(), Vec::new());
        let times: Vec<f64> = [0.0].into_iter().chain(scene.time.all()).collect();
        for (ContactBoundary { nodes, .. }, (obstacle, motion)) in contact_boundaries.iter().zip(&obstacles) {
            let contacts = &contacts[nodes.clone()];
            let positions: Vec<[f64; 3]> = contacts.iter().map(|contact| contact.position).collect();
            let facings: Vec<Facing> = contacts.iter().map(|contact| contact.facing).collect();
            for (rates, history) in motion.rates(&positions, &facings) {
                let (gap, drift) = rates.iter().map(|rates| (rates.gap, rates.drift)).unzip();
                motions.push(Motion { nodes: nodes.clone(), gap, drift, history });
            }
            if let Some(gap) = motion.bends(obstacle, &positions, &facings, &times) {
                bends.push(Bend { nodes: nodes.clone(), times: times.clone(), gap });
            }
        }
        let [mut c_n, mut c_t, mut c_o] = [(); 3].map(|()| Csr::new(dofs.free()));
        for contact in &contacts {
            c_n.push_row(contact.normal.iter().copied());
            c_t.push_row(contact.tangents[0].iter().copied());
            c_o.push_row(contact.tangents[1].iter().copied());
        }

        let mut loading =
            Loading { cases: Vec::new(), gap: contacts.iter().map(|c| c.facing.gap).collect(), motions, bends };
        for load in &scene.loads {
            let boundary = find(scene, &mesh, &load.boundary)?;
            let force = facet_load(&mesh, &dofs, boundary, body::traction(scene, &mesh, load)?);
            loading.cases.push(LoadCase { force, history: load.history.clone() });
        }

        let rigid_motions = rigid_motions(&mesh, &dofs);
        let problem = ContactProblem {
            stiffness,
            c_n,
            c_t,
            c_o,
            mu,
            weight: contacts.iter().map(|c| c.weight).collect(),
            free_motions: rigid_motions.iter().map(|motion| motion.displacements(&mesh, &dofs)).collect(),
        };
        let thin = mesh.dimension == 2 && scene.material.plane == scene::Plane::Stress;
        Ok(Model {
            mesh,
            materials,
            element,
            thin,
            dofs,
            contacts,
            contact_boundaries,
            obstacles,
            problem,
            loading,
            rigid_motions,
        })
    }

    /// The linear algebra that a scene names.
    pub fn linear(&self, backend: LinearBackend) -> Direct {
        match backend {
            LinearBackend::Umfpack => Direct::new(built_in::umfpack()),
            LinearBackend::Faer => Direct::new(built_in::faer()),
            LinearBackend::Condensed => Direct::condensing(self.problem.contact_displacements().len()),
        }
    }

    /// Units for the numbers inside, see [`ContactProblem::scaling`].
    pub fn scaling(&self) -> Scaling {
        self.problem.scaling(self.loading.largest_force(), self.loading.largest_interference())
    }
}

fn find<'a>(scene: &Scene, mesh: &'a Mesh, name: &scene::Name) -> Result<&'a Boundary, SceneError> {
    mesh.boundary(name.as_str()).ok_or_else(|| scene.unknown_boundary(name, &mesh.boundary_names()))
}
