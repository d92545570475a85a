//! Discretisation of a description: mesh, `K`, contact maps and loads.

mod balance;
mod between_nodes;
mod constraints;
mod contact;
mod contact_geometry;
mod coupling;
mod discrete;
mod glued_contact;
mod holding;
mod joint;
mod load;
mod motions;
mod pair;
mod place;
mod range;
mod recovery;
mod sliding;
mod stress;
mod support;
mod surface;

pub use balance::{Balance, Wrench};
pub use between_nodes::{BetweenNodes, Overlap, PassedNode};
pub use constraints::Constraints;
pub use contact_geometry::ContactGeometry;
pub use discrete::{Body, Share};
pub use pair::Pair;
pub use range::{DeformedNode, RangeLeft, TOLERATED_SHARE, range_left};
pub use sliding::LargeMotion;
pub use surface::SurfaceStress;

use std::sync::{Arc, OnceLock};

use crate::algebra::linear::{LinearError, Stiffness};
use crate::algebra::sparse::Csr;
use crate::base::input_error::InputError;
use crate::base::timeline::within;
use crate::base::units::{Scaling, UnitSystem};
use crate::body::constraints::HeldRows;
use crate::body::contact::{ContactNode, Row};
use crate::body::description::Description;
use crate::body::fem::{Elasticity, Element, InvertedElement, Plane, Spring};
use crate::body::mesh::{Boundary, Mesh, MeshError, MeshFileError};
use crate::solver::loading::{FrictionHistory, LoadCase, Loading, Motion};
use crate::solver::problem::{ContactProblem, Parts, ProblemError};
use balance::Statics;
use contact::Contacts;
use discrete::{Discrete, Elements};
use load::NodalLoad;
use motions::{Motions, Nearest};
use surface::Surface;

/// A discretised description.
#[derive(Debug, Clone)]
pub struct Model {
    /// The description that it was built from.
    description: Description,
    /// The mesh.
    pub mesh: Arc<Mesh>,
    elements: Elements,
    /// The constraints of the displacements.
    pub constraints: Constraints,
    /// The contact nodes with what is opposite.
    pub contact: ContactGeometry,
    /// The loads and gaps over time.
    pub loading: Loading,
    statics: Statics,
    /// The algebraic problem.
    pub problem: ContactProblem,
    /// The set-up of the stresses along the contact surface, made when these are first asked for.
    surface: OnceLock<Surface>,
}

/// An error in the discretisation of a description.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ModelError {
    /// A value of the description is invalid or contradicts the mesh.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Description(#[from] InputError),
    /// The mesh file is invalid.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Mesh(#[from] MeshFileError),
    /// The discrete problem is invalid, for example because numbers overflow.
    #[error(transparent)]
    #[diagnostic(help("moduli, loads or lengths leave the range of double precision: check their units"))]
    Problem(#[from] ProblemError),
    /// An element of the mesh is inverted.
    #[error(transparent)]
    Element(#[from] InvertedElement),
    /// A rank that shares the stiffness has failed.
    #[error(transparent)]
    Linear(#[from] LinearError),
}

impl From<MeshError> for ModelError {
    fn from(error: MeshError) -> Self {
        match error {
            MeshError::Source(fault) => ModelError::Description(fault),
            MeshError::File(error) => ModelError::Mesh(error),
        }
    }
}

/// Assembles the contact problem of the contact nodes with their friction coefficients `mu`.
fn contact_problem(
    mesh: &Mesh,
    Constraints { dofs, rigid_motions, .. }: &Constraints,
    stiffness: Stiffness,
    contacts: &[ContactNode],
    mu: Vec<f64>,
) -> Result<ContactProblem, ProblemError> {
    let map = |row: fn(&ContactNode) -> &Row| {
        Csr::of_rows(dofs.free(), contacts.iter().map(|contact| row(contact).iter().copied()))
    };
    ContactProblem::new(Parts {
        stiffness,
        c_n: map(|contact| &contact.normal),
        c_t: map(|contact| &contact.tangents[0]),
        c_o: map(|contact| &contact.tangents[1]),
        mu,
        weight: Some(contacts.iter().map(|contact| contact.weight).collect()),
        rigid_modes: Some(rigid_motions.iter().map(|motion| motion.displacements(mesh, dofs)).collect()),
    })
}

/// Computes the effect of `ū(t)` beyond the rigid offset: forces on the free part of the body, and gaps.
fn prescribed_effect(
    Constraints { dofs, prescribed, groups, .. }: &Constraints,
    contacts: &[ContactNode],
    rows: &HeldRows,
    springs: &[Spring],
) -> Result<(Vec<LoadCase>, Vec<Motion>), ProblemError> {
    let (mut cases, mut motions) = (Vec::new(), Vec::new());
    for motion in prescribed {
        cases.push(LoadCase::new(dofs.forces(motion.forces(groups, rows, springs)), motion.history.clone())?);
        let deviations: Vec<_> = contacts.iter().map(|contact| motion.deviation_of(dofs, groups, contact)).collect();
        if deviations.iter().any(|deviation| *deviation != [0.0; 3]) {
            let gap = deviations.iter().map(|[n, ..]| -n).collect();
            let drift = deviations.iter().map(|[_, t, o]| [-t, -o]).collect();
            motions.push(Motion::new(0..contacts.len(), gap, drift, motion.history.clone())?);
        }
    }
    Ok((cases, motions))
}

/// Computes the loads of `description` and the gaps of `contacts` over time, each load with its forces at factor 1, and
/// the obstacle that each contact node meets.
fn loaded(
    description: &Description,
    discrete: &Discrete,
    rows: &HeldRows,
    contacts: &Contacts,
) -> Result<(Loading, Vec<NodalLoad>, Nearest), ModelError> {
    let Discrete { constraints, beds, .. } = discrete;
    let Constraints { dofs, joints, .. } = constraints;
    let Contacts { nodes, obstacles, .. } = contacts;
    let springs: Vec<Spring> = beds.iter().flatten().cloned().collect();
    let gap = |node: &ContactNode| node.obstacle().map_or(node.facing.gap, |k| node.gap_at_rest(&obstacles[k].0));
    let gap: Vec<f64> = nodes.iter().map(gap).collect();
    let Motions { mut rates, gap_corrections, nearest } = motions::motions(nodes, obstacles, &gap, &description.times)?;
    let (mut cases, mut loads) = (Vec::new(), Vec::new());
    let end = description.end();
    for (k, given) in description.loads.iter().enumerate() {
        let load = load::load(description, discrete, k)?;
        cases.push(LoadCase::new(dofs.forces(load.0.iter().copied()), within(end, &given.factors(end)))?);
        loads.push(load);
    }
    let (of_prescribed, motions) = prescribed_effect(constraints, nodes, rows, &springs)?;
    cases.extend(of_prescribed);
    rates.extend(motions);
    for (force, history) in joints.tightened(description, dofs, true) {
        cases.push(LoadCase::new(dofs.forces([force]), history)?);
    }
    let friction = contacts.friction_history(description)?;
    let loading = Loading::new(cases, gap)?.with_motions(rates, gap_corrections)?.with_friction(friction)?;
    Ok((loading, loads, nearest))
}

impl Model {
    /// Discretises `description`.
    ///
    /// # Errors
    /// If a value is invalid or contradicts the mesh: a missing boundary, an obstacle that is in front of no node,
    /// contact where supports hold the body inside the obstacle, no free displacement. The message names the key.
    pub fn build(description: &Description) -> Result<Self, ModelError> {
        Self::shared(description, None)
    }

    /// Discretises `description` with a stiffness distributed by `share`, if the stiffness can be distributed.
    ///
    /// # Errors
    /// As [`Model::build`], and the errors of `share`.
    pub fn shared(description: &Description, share: Option<Share<'_>>) -> Result<Self, ModelError> {
        let discrete = Discrete::new(description)?;
        let times = description.ends_at_kinks(&description.times);
        let description = Description { times, ..description.clone() };
        let sharing = share.and_then(|share| Some((share, Body::on(&discrete)?)));
        let (stiffness, rows) = discrete.assembled(sharing.is_some())?;
        let contacts = Contacts::new(&description, &discrete.mesh, &discrete.constraints, &discrete.pairs)?;
        let (loading, loads, nearest) = loaded(&description, &discrete, &rows, &contacts)?;
        let stiffness = match (stiffness, &sharing) {
            (Some(stiffness), _) => Some(stiffness.into()),
            (None, Some((share, body))) => body.stiffness(&contacts.nodes, share)?,
            (None, None) => None,
        };
        let stiffness = stiffness.map_or_else(|| discrete.stiffness().map(Stiffness::from), Ok)?;
        let Discrete { mesh, elements, constraints, holdings, pairs, beds } = discrete;
        let mu = loading.friction().map_or_else(|| contacts.mu.clone(), FrictionHistory::largest);
        let problem = contact_problem(&mesh, &constraints, stiffness, &contacts.nodes, mu)?;
        let statics = Statics::new(&mesh, &constraints, rows, support::shares(&holdings), beds, loads);
        let contact = ContactGeometry::new(&mesh, &constraints, contacts, nearest, pairs.all);
        let surface = OnceLock::new();
        Ok(Model { description, mesh, elements, constraints, contact, loading, statics, problem, surface })
    }

    /// Returns the description that the model was built from.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// Returns the units of the results.
    pub fn units(&self) -> UnitSystem {
        self.description.system(self.mesh.dimension)
    }

    /// Returns the ends of the increments, s; the gaps of moving obstacles are exact at these times.
    pub fn times(&self) -> &[f64] {
        &self.description.times
    }

    /// Returns the elastic law of each cell of the mesh.
    pub fn materials(&self) -> &[Elasticity] {
        &self.elements.materials
    }

    /// Returns the element formulation.
    pub fn element(&self) -> Element {
        self.description.element
    }

    /// Returns `true` if the body is in plane stress.
    pub fn is_thin(&self) -> bool {
        self.description.material.plane == Some(Plane::Stress)
    }

    /// Returns the key of obstacle `k` of `contact.obstacles` in a scene, such as `contact[0].obstacle[1]`.
    pub fn obstacle_key(&self, k: usize) -> String {
        let boundary = self.contact.boundaries.iter().find(|boundary| boundary.obstacles.contains(&k));
        let (contact, first) = boundary.map_or((0, 0), |boundary| (boundary.contact, boundary.obstacles.start));
        self.description.contacts[contact].obstacle_key(contact, k - first)
    }

    /// Returns the units for the internal numbers, see [`ContactProblem::scaling`].
    pub fn scaling(&self) -> Scaling {
        self.problem.scaling(self.loading.largest_force(), self.loading.largest_interference())
    }
}

/// Returns the boundary named by the table at `key`.
fn find<'a>(mesh: &'a Mesh, name: &str, key: &str) -> Result<&'a Boundary, InputError> {
    mesh.boundary(name).ok_or_else(|| {
        if let Some((_, fault)) = mesh.notes.unusable.iter().find(|(group, _)| group == name) {
            let message = format!("`{name}` is no boundary: {fault}");
            return InputError::new(format!("{key}.boundary"), message, fault.help());
        }
        let known = mesh.boundary_names();
        let help = if known.is_empty() {
            let sides = if mesh.dimension == 2 { "curves" } else { "surfaces" };
            format!(
                "the mesh has no boundaries: put its outer {sides} into physical groups, too, and mesh again (Gmsh); define a *SURFACE or \
                 an *NSET with all their nodes (Abaqus); export groups of them (UNV)"
            )
        } else {
            format!("the mesh has the boundaries {}", known.join(", "))
        };
        InputError::new(format!("{key}.boundary"), format!("the mesh has no boundary `{name}`"), help)
    })
}
