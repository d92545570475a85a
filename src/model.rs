//! From a scene to the discrete problem: mesh, `K`, contact maps, loads.

mod contact;
mod range;
mod stress;

use crate::contact::{ContactBoundary, ContactNode, Facing, Obstacle, ObstacleMotion};
use crate::fem::{Dofs, Elasticity, Element, InvertedElement, RigidMotion, assemble, facet_load, rigid_motions};
use crate::linear::{Condensed, Direct, FaerLu, Umfpack};
use crate::loading::{LoadCase, Loading, Motion};
use crate::mesh::{self, Boundary, Mesh, MeshFileError};
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
        let mesh = match &scene.mesh {
            scene::Mesh::Block { size, elements, grading } => mesh::graded_block(size, elements, grading),
            scene::Mesh::HalfPlane(m) => {
                mesh::half_plane(m.size, m.contact_width, m.contact_elements, m.outer_elements, m.layers)
            }
            scene::Mesh::Gmsh { file, scale } => mesh::gmsh(file, *scale)?,
        };

        let mut fixed = vec![[false; 2]; mesh.nodes.len()];
        for support in &scene.supports {
            for node in find(scene, &mesh, &support.boundary)?.nodes() {
                for (fixed, fix) in fixed[node].iter_mut().zip(support.fix) {
                    *fixed |= fix;
                }
            }
        }
        let dofs = Dofs::new(&mesh, |node, component| fixed[node][component]);
        if let (0, Some(support)) = (dofs.free(), scene.supports.first()) {
            let help = "support fewer boundaries, or use a finer mesh";
            let message = "the supports fix every node of the mesh, so nothing is left to solve";
            return Err(scene.error_at(support.boundary.span(), message, help).into());
        }

        let element = match scene.element {
            scene::Element::Bilinear => Element::Bilinear,
            scene::Element::BBar => Element::BBar,
        };
        let materials = materials(scene, &mesh)?;
        let stiffness = assemble(&mesh, &dofs, element, |e| materials[e])?;

        let (mut contacts, mut mu) = (Vec::<ContactNode>::new(), Vec::new());
        let (mut contact_boundaries, mut obstacles, mut motions) = (Vec::new(), Vec::new(), Vec::new());
        for contact in &scene.contacts {
            let first = contacts.len();
            let (obstacle, motion, nodes) = contact::boundary(scene, &mesh, &dofs, contact)?;
            contact::no_contradiction(scene, contact, &contacts, &nodes)?;
            contacts.extend(nodes);
            mu.resize(contacts.len(), contact.friction);
            let nodes = first..contacts.len();
            let positions: Vec<[f64; 3]> = contacts[first..].iter().map(|contact| contact.position).collect();
            let facings: Vec<Facing> = contacts[first..].iter().map(|contact| contact.facing).collect();
            for (rates, history) in motion.rates(&positions, &facings) {
                let (gap, drift) = rates.iter().map(|rates| (rates.gap, rates.drift)).unzip();
                motions.push(Motion { nodes: nodes.clone(), gap, drift, history });
            }
            contact_boundaries.push(ContactBoundary { name: contact.boundary.to_string(), nodes });
            obstacles.push((obstacle, motion));
        }
        // Two obstacles at one node can hold it in both directions; then there is no slip, and friction
        // there would make the equations dependent. Such a corner node carries none.
        let mut obstacles_at = vec![0_usize; mesh.nodes.len()];
        for contact in &contacts {
            obstacles_at[contact.node] += 1;
        }
        for contact in contacts.iter_mut().filter(|contact| obstacles_at[contact.node] > 1) {
            contact.tangents = Default::default();
        }
        let [mut c_n, mut c_t, mut c_o] = [(); 3].map(|()| Csr::new(dofs.free()));
        for contact in &contacts {
            c_n.push_row(contact.normal.iter().copied());
            c_t.push_row(contact.tangents[0].iter().copied());
            c_o.push_row(contact.tangents[1].iter().copied());
        }

        let mut loading = Loading { cases: Vec::new(), gap: contacts.iter().map(|c| c.facing.gap).collect(), motions };
        for load in &scene.loads {
            let boundary = find(scene, &mesh, &load.boundary)?;
            let [x, y] = load.traction;
            let force = facet_load(&mesh, &dofs, boundary, [x, y, 0.0]);
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
        Direct::new(match backend {
            LinearBackend::Umfpack => Box::new(Umfpack::default()),
            LinearBackend::Faer => Box::new(FaerLu::default()),
            LinearBackend::Condensed => Box::new(Condensed::new(self.problem.displacements())),
        })
    }

    /// Units for the numbers inside, see [`ContactProblem::scaling`].
    pub fn scaling(&self) -> Scaling {
        self.problem.scaling(self.loading.largest_force(), self.loading.largest_interference())
    }
}

/// The material of each element: that of the layer that holds its centre.
fn materials(scene: &Scene, mesh: &Mesh) -> Result<Vec<Elasticity>, SceneError> {
    let body = &scene.material;
    let of_element: Vec<Option<usize>> = (0..mesh.cells.len()).map(|e| body.layer(mesh.centre(e)[1])).collect();
    let mut filled = vec![false; body.layers.len()];
    of_element.iter().flatten().for_each(|&k| filled[k] = true);
    if let Some(k) = filled.iter().position(|filled| !filled) {
        let message = format!("no element of the mesh has its centre in material.layers[{k}]");
        let help = "use more elements, a thicker layer or fewer layers; thicknesses are in m, from the bottom up";
        return Err(scene.error_at(body.layers[k].span.clone(), message, help));
    }
    let elasticity = |young, poisson| match body.plane {
        scene::Plane::Strain => Elasticity::plane_strain(young, poisson),
        scene::Plane::Stress => Elasticity::plane_stress(young, poisson),
    };
    let base = elasticity(body.young, body.poisson);
    let layers: Vec<Elasticity> = body.layers.iter().map(|layer| elasticity(layer.young, layer.poisson)).collect();
    Ok(of_element.into_iter().map(|layer| layer.map_or(base, |k| layers[k])).collect())
}

fn find<'a>(scene: &Scene, mesh: &'a Mesh, name: &scene::Name) -> Result<&'a Boundary, SceneError> {
    mesh.boundary(name.as_str()).ok_or_else(|| scene.unknown_boundary(name, &mesh.boundary_names()))
}
