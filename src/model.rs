//! From a scene to the discrete problem: mesh, `K`, contact maps, loads.

use crate::contact::{ContactBoundary, ContactNode, Obstacle, contact_nodes, unreachable};
use crate::fem::{Dofs, Elasticity, Element, InvertedElement, RigidMotion, assemble, facet_load, rigid_motions};
use crate::linear::{Condensed, Direct, FaerLu, Umfpack};
use crate::loading::{Approach, LoadCase, Loading};
use crate::mesh::{self, Boundary, Mesh};
use crate::problem::ContactProblem;
use crate::scene::{self, LinearBackend, Scene, SceneError};
use crate::sparse::Csr;
use crate::units::Scaling;

/// A scene, discretised.
#[derive(Debug, Clone)]
pub struct Model {
    /// The mesh.
    pub mesh: Mesh,
    /// The numbering of the free displacements.
    pub dofs: Dofs,
    /// The contact nodes, in the order of `problem`'s rows.
    pub contacts: Vec<ContactNode>,
    /// The boundaries they stand on.
    pub contact_boundaries: Vec<ContactBoundary>,
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
        let mesh = match scene.mesh {
            scene::Mesh::Block { size, elements, grading } => mesh::graded_block(&size, &elements, &grading),
            scene::Mesh::HalfPlane(m) => {
                mesh::half_plane(m.size, m.contact_width, m.contact_elements, m.outer_elements, m.layers)
            }
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
        let stiffness = assemble(&mesh, &dofs, element, materials(scene, &mesh)?)?;

        let (mut contacts, mut mu) = (Vec::<ContactNode>::new(), Vec::new());
        let (mut contact_boundaries, mut approaches) = (Vec::new(), Vec::new());
        for contact in &scene.contacts {
            let first = contacts.len();
            contacts.extend(contact_boundary(scene, &mesh, &dofs, contact)?);
            mu.resize(contacts.len(), contact.friction);
            let nodes = first..contacts.len();
            if !contact.obstacle.approach.is_empty() {
                approaches.push(Approach { nodes: nodes.clone(), history: contact.obstacle.approach.clone() });
            }
            contact_boundaries.push(ContactBoundary { name: contact.boundary.to_string(), nodes });
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
        let (mut c_n, mut c_t) = (Csr::new(dofs.free()), Csr::new(dofs.free()));
        for contact in &contacts {
            c_n.push_row(contact.normal.iter().copied());
            c_t.push_row(contact.tangents[0].iter().copied());
        }

        let mut loading = Loading { cases: Vec::new(), gap: contacts.iter().map(|c| c.gap).collect(), approaches };
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
            mu,
            weight: contacts.iter().map(|c| c.weight).collect(),
            free_motions: rigid_motions.iter().map(|motion| motion.displacements(&mesh, &dofs)).collect(),
        };
        Ok(Model { mesh, dofs, contacts, contact_boundaries, problem, loading, rigid_motions })
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
fn materials(scene: &Scene, mesh: &Mesh) -> Result<impl Fn(usize) -> Elasticity, SceneError> {
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
    Ok(move |e: usize| of_element[e].map_or(base, |k| layers[k]))
}

fn flat([x, y]: [f64; 2]) -> [f64; 3] {
    [x, y, 0.0]
}

fn find<'a>(scene: &Scene, mesh: &'a Mesh, name: &scene::Name) -> Result<&'a Boundary, SceneError> {
    mesh.boundary(name.as_str()).ok_or_else(|| scene.unknown_boundary(name, &mesh.boundary_names()))
}

fn contact_boundary(
    scene: &Scene,
    mesh: &Mesh,
    dofs: &Dofs,
    contact: &scene::Contact,
) -> Result<Vec<ContactNode>, SceneError> {
    let boundary = find(scene, mesh, &contact.boundary)?;
    let scene::Obstacle { shape, normal, tangent, .. } = contact.obstacle.clone();
    let obstacle = Obstacle::facing(mesh, boundary, shape, normal.map(flat), tangent.map(flat)).ok_or_else(|| {
        let message = format!("the boundary `{}` has no mean normal to face an obstacle with", contact.boundary);
        scene.error_at(contact.boundary.span(), message, "give the obstacle a `normal`")
    })?;
    if !obstacle.faces(mesh, boundary) {
        let message = format!("the normal of the obstacle points into the body at `{}`, or along it", contact.boundary);
        return Err(scene.error_at(contact.obstacle.span.clone(), message, "let the normal point out of the body"));
    }
    let nodes = boundary.nodes();
    if let Some((&node, _)) = nodes.iter().zip(obstacle.gaps(mesh, &nodes)).find(|(_, gap)| gap.is_nan()) {
        let place = mesh.place(mesh.nodes[node]);
        let message = format!("the cylinder does not reach over the contact node at {place} m");
        return Err(scene.error_at(contact.obstacle.span.clone(), message, "use a larger radius"));
    }
    let furthest = contact.obstacle.approach.iter().fold(0.0_f64, |m, point| m.max(point[1]));
    if let Some(node) = unreachable(mesh, dofs, boundary, &obstacle, furthest) {
        let place = mesh.place(mesh.nodes[node]);
        let message = format!("supports hold the body where the obstacle is or comes to be, at {place} m");
        let help = "use a gap of at least 0, a shorter approach or fewer supports";
        return Err(scene.error_at(contact.boundary.span(), message, help));
    }
    let nodes = contact_nodes(mesh, dofs, boundary, &obstacle);
    if nodes.is_empty() {
        let message = format!("supports hold every node of the contact boundary `{}`", contact.boundary);
        return Err(scene.error_at(contact.boundary.span(), message, "remove the contact or the support"));
    }
    Ok(nodes)
}
