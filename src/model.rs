//! From a scene to the discrete problem: mesh, `K`, contact maps, loads.

mod body;
mod contact;
mod range;
mod stress;

use crate::contact::{ContactBoundary, ContactNode, Facing, Obstacle, ObstacleMotion, Row, share_edges};
use crate::fem::{Dofs, Elasticity, Element, InvertedElement, RigidMotion, assemble, facet_load, rigid_motions};
use crate::loading::{Bend, LoadCase, Loading, Motion};
use crate::mesh::{Boundary, Mesh, MeshFileError};
use crate::problem::{ContactProblem, Parts, ProblemError};
use crate::scene::{self, Scene, SceneError};
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
    /// The rigid motions behind `problem.free_motions()`.
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
    /// What the mesh makes of the scene is no sound problem, as where its numbers overflow.
    #[error(transparent)]
    #[diagnostic(help("moduli, loads or lengths leave the range of double precision: check their units"))]
    Problem(#[from] ProblemError),
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
                motions.push(Motion::new(nodes.clone(), gap, drift, history)?);
            }
            if let Some(gap) = motion.bends(obstacle, &positions, &facings, &times) {
                bends.push(Bend::new(nodes.clone(), times.clone(), gap)?);
            }
        }
        let map = |row: fn(&ContactNode) -> &Row| {
            Csr::of_rows(dofs.free(), contacts.iter().map(|contact| row(contact).iter().copied()))
        };
        let mut cases = Vec::with_capacity(scene.loads.len());
        for load in &scene.loads {
            let boundary = find(scene, &mesh, &load.boundary)?;
            let force = facet_load(&mesh, &dofs, boundary, body::traction(scene, &mesh, load)?);
            cases.push(LoadCase::new(force, load.history.clone())?);
        }
        let gap = contacts.iter().map(|contact| contact.facing.gap).collect();
        let loading = Loading::new(cases, gap)?.with_motions(motions, bends)?;

        let rigid_motions = rigid_motions(&mesh, &dofs);
        let problem = ContactProblem::new(Parts {
            stiffness,
            c_n: map(|contact| &contact.normal),
            c_t: map(|contact| &contact.tangents[0]),
            c_o: map(|contact| &contact.tangents[1]),
            mu,
            weight: Some(contacts.iter().map(|contact| contact.weight).collect()),
            free_motions: Some(rigid_motions.iter().map(|motion| motion.displacements(&mesh, &dofs)).collect()),
        })?;
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

    /// Units for the numbers inside, see [`ContactProblem::scaling`].
    pub fn scaling(&self) -> Scaling {
        self.problem.scaling(self.loading.largest_force(), self.loading.largest_interference())
    }
}

fn find<'a>(scene: &Scene, mesh: &'a Mesh, name: &scene::Name) -> Result<&'a Boundary, SceneError> {
    mesh.boundary(name.as_str()).ok_or_else(|| scene.unknown_boundary(name, &mesh.boundary_names()))
}
