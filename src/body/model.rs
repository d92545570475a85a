//! Discretisation of a description: mesh, `K`, contact maps and loads.

mod balance;
mod between_nodes;
mod contact;
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
pub use discrete::{Body, Share};
pub use pair::Pair;
pub use range::{DeformedNode, RangeLeft, TOLERATED_SHARE, range_left};
pub use sliding::LargeMotion;
pub use surface::SurfaceStress;

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use crate::algebra::linear::{LinearError, Stiffness};
use crate::algebra::sparse::Csr;
use crate::base::input_error::InputError;
use crate::base::timeline::within;
use crate::base::units::{Scaling, UnitSystem};
use crate::body::constraints::{Dofs, HeldRows, RigidMotion, assemble, unresisted_motions};
use crate::body::contact::{ContactBoundary, ContactNode, ObstacleMotion, Passages, PlacedObstacle, Row};
use crate::body::description::Description;
use crate::body::fem::{Elasticity, Element, InvertedElement, NodalVolumes, Plane, Spring};
use crate::body::mesh::{Boundary, Mesh, MeshError, MeshFileError};
use crate::solver::loading::{FrictionHistory, LoadCase, Loading, Motion};
use crate::solver::problem::{ContactProblem, Parts, ProblemError};
use balance::Statics;
use contact::Contacts;
use coupling::Couplings;
use discrete::Discrete;
use joint::Joints;
use load::FreeStrain;
use motions::{Motions, Nearest};
use recovery::Recovery;
use support::{PrescribedMotion, RigidGroups};
use surface::Surface;

/// A discretised description.
#[derive(Debug, Clone)]
pub struct Model {
    /// The description that it was built from.
    description: Description,
    /// The mesh.
    pub mesh: Arc<Mesh>,
    /// The elastic law of each cell.
    materials: Vec<Elasticity>,
    /// The nodal volumes over which dilatations are averaged; empty for other elements.
    volumes: NodalVolumes,
    /// The numbering of the free displacements.
    pub dofs: Dofs,
    /// The contact nodes, in the order of `problem`'s rows.
    pub contacts: Vec<ContactNode>,
    /// The boundaries in contact.
    pub contact_boundaries: Vec<ContactBoundary>,
    /// The obstacles in front of the boundaries, and their motions.
    pub obstacles: Vec<(PlacedObstacle, ObstacleMotion)>,
    /// The obstacle that each contact node meets, where there are several.
    nearest: Nearest,
    /// The pairs of boundaries in contact with each other.
    pub pairs: Vec<Pair>,
    /// The algebraic problem.
    pub problem: ContactProblem,
    /// The loads and gaps over time.
    pub loading: Loading,
    /// The rigid motions that `problem.rigid_modes()` represents.
    pub rigid_motions: Vec<RigidMotion>,
    /// The displacements that moving supports prescribe, and the bodies that they move as rigid bodies.
    prescribed: Vec<PrescribedMotion>,
    groups: RigidGroups,
    couplings: Couplings,
    joints: Joints,
    /// The stress-free strain at factor 1 of each thermal load, and the number of the load.
    thermal: Vec<(FreeStrain, usize)>,
    statics: Statics,
    /// The recovery of tractions from contact forces, where dividing by the weights is not enough.
    recovery: Option<Recovery>,
    /// For each contact node beyond the end of the other body: the contact nodes whose forces add up to the pressure
    /// there.
    beside_the_end: BTreeMap<usize, Vec<usize>>,
    /// The search for bodies that pass through each other.
    passages: Option<Passages>,
    /// For each contact node: `true` if the opposite side moves past it along a direction in which supports hold the
    /// node, so that friction is missing there.
    passed_by: Vec<bool>,
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

/// Assembles the contact problem of the contact nodes.
fn contact_problem(
    stiffness: Stiffness,
    contacts: &[ContactNode],
    mu: Vec<f64>,
    rigid_modes: Vec<Vec<f64>>,
    free: usize,
) -> Result<ContactProblem, ProblemError> {
    let map =
        |row: fn(&ContactNode) -> &Row| Csr::of_rows(free, contacts.iter().map(|contact| row(contact).iter().copied()));
    ContactProblem::new(Parts {
        stiffness,
        c_n: map(|contact| &contact.normal),
        c_t: map(|contact| &contact.tangents[0]),
        c_o: map(|contact| &contact.tangents[1]),
        mu,
        weight: Some(contacts.iter().map(|contact| contact.weight).collect()),
        rigid_modes: Some(rigid_modes),
    })
}

/// Adds the effect of prescribed displacements beyond the rigid offset: forces on the free part of the body, and gaps.
fn add_prescribed(
    prescribed: &[PrescribedMotion],
    contacts: &[ContactNode],
    (dofs, rows, groups, springs): (&Dofs, &HeldRows, &RigidGroups, &[Spring]),
    (cases, motions): (&mut Vec<LoadCase>, &mut Vec<Motion>),
) -> Result<(), ProblemError> {
    for motion in prescribed {
        cases.push(LoadCase::new(dofs.forces(motion.forces(groups, rows, springs)), motion.history.clone())?);
        let deviations: Vec<_> = contacts.iter().map(|contact| motion.deviation_of(dofs, groups, contact)).collect();
        if deviations.iter().any(|deviation| *deviation != [0.0; 3]) {
            let gap = deviations.iter().map(|[n, ..]| -n).collect();
            let drift = deviations.iter().map(|[_, t, o]| [-t, -o]).collect();
            motions.push(Motion::new(0..contacts.len(), gap, drift, motion.history.clone())?);
        }
    }
    Ok(())
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
        let laid_out = Description { times, ..description.clone() };
        let description = &laid_out;
        let sharing = share.and_then(|share| Some((share, Body::on(&discrete)?)));
        let Discrete { mesh, couplings, joints, holdings, dofs, element, materials, pairs, volumes, beds } = &discrete;
        let law = |e: usize| materials[e];
        let springs: Vec<Spring> = beds.iter().flatten().cloned().collect();
        let (stiffness, rows) = if sharing.is_some() {
            (None, HeldRows::rows_only(mesh, dofs, *element, law)?)
        } else {
            let (stiffness, rows) = HeldRows::beside(mesh, dofs, *element, volumes, law, &springs)?;
            (Some(stiffness), rows)
        };
        let groups = RigidGroups::new(description, mesh, dofs, (couplings, pairs), holdings)?;
        let mut prescribed = PrescribedMotion::all(description, mesh, dofs, holdings, &groups)?;
        let jumps = joints.tightened(description, dofs, false);
        prescribed.extend(jumps.map(|(jump, history)| PrescribedMotion::of_jump(dofs, groups.count, jump, history)));

        let contacts = Contacts::new(description, mesh, dofs, &prescribed, pairs, &groups)?;
        let friction = contacts.friction_history(description)?;
        let Contacts { nodes: contacts, mu, boundaries: contact_boundaries, obstacles, .. } = contacts;
        let mu = friction.as_ref().map_or(mu, FrictionHistory::largest);
        let gap = |contact: &ContactNode| {
            contact.obstacle().map_or(contact.facing.gap, |k| contact.gap_at_rest(&obstacles[k].0))
        };
        let gap: Vec<f64> = contacts.iter().map(gap).collect();
        let Motions { rates: mut motions, gap_corrections, nearest } =
            motions::motions(&contacts, &obstacles, &gap, &description.times)?;
        let (mut cases, mut forces, mut thermal) = (Vec::new(), Vec::new(), Vec::new());
        let end = description.end();
        for (k, load) in description.loads.iter().enumerate() {
            let (on_nodes, free_strain) = load::load(description, &discrete, k)?;
            cases.push(LoadCase::new(dofs.forces(on_nodes.iter().copied()), within(end, &load.factors(end)))?);
            thermal.extend(free_strain.map(|strain| (strain, k)));
            forces.push(on_nodes);
        }
        add_prescribed(&prescribed, &contacts, (dofs, &rows, &groups, &springs), (&mut cases, &mut motions))?;
        for (force, history) in joints.tightened(description, dofs, true) {
            cases.push(LoadCase::new(dofs.forces([force]), history)?);
        }
        let on_springs: Vec<_> = prescribed.iter().map(|motion| motion.forces_of_springs(&groups, &springs)).collect();
        let statics = Statics::new(mesh, dofs, rows, support::shares(holdings), beds.clone(), &forces, &on_springs);
        let loading = Loading::new(cases, gap)?.with_motions(motions, gap_corrections)?.with_friction(friction)?;

        let recovery = Recovery::new(mesh, &contacts, &contact_boundaries, &pairs.all);
        let past = |contact: &ContactNode| support::moves_past(&prescribed, dofs, &groups, contact);
        let ties = [pairs.ties(dofs, joints), holding::ties(couplings, mesh, dofs)].concat();
        let rigid_motions = unresisted_motions(mesh, dofs, &springs, &ties);
        let shared = match &sharing {
            Some((share, body)) => body.stiffness(&contacts, share)?,
            None => None,
        };
        let stiffness = match stiffness.map(Stiffness::from).or(shared) {
            Some(stiffness) => stiffness,
            None => assemble(mesh, dofs, *element, law)?.into(),
        };
        let rigid_modes = rigid_motions.iter().map(|motion| motion.displacements(mesh, dofs)).collect();
        let problem = contact_problem(stiffness, &contacts, mu, rigid_modes, dofs.free())?;
        let passed_by =
            contacts.iter().map(|contact| motions::passes(contact, mesh.dimension, &obstacles, past)).collect();
        let mortars = pairs.all.iter().filter(|pair| !pair.shifted).map(|pair| (&pair.mortar, &pair.gaps[..]));
        let passages = Passages::new(mesh, mortars);
        let beside_the_end = recovery::beside_the_end(mesh, &contacts, &contact_boundaries);
        let Discrete { mesh, couplings, joints, dofs, materials, pairs, volumes, .. } = discrete;
        Ok(Model {
            description: laid_out,
            mesh,
            materials,
            volumes,
            dofs,
            contacts,
            contact_boundaries,
            obstacles,
            nearest,
            pairs: pairs.all,
            problem,
            loading,
            rigid_motions,
            prescribed,
            groups,
            couplings,
            joints,
            thermal,
            statics,
            recovery,
            beside_the_end,
            passages,
            passed_by,
            surface: OnceLock::new(),
        })
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
        &self.materials
    }

    /// Returns the element formulation.
    pub fn element(&self) -> Element {
        self.description.element
    }

    /// Returns `true` if the body is in plane stress.
    pub fn is_thin(&self) -> bool {
        self.description.material.plane == Some(Plane::Stress)
    }

    /// Returns the key of obstacle `k` of [`Model::obstacles`] in a scene, such as `contact[0].obstacle[1]`.
    pub fn obstacle_key(&self, k: usize) -> String {
        let boundary = self.contact_boundaries.iter().find(|boundary| boundary.obstacles.contains(&k));
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
