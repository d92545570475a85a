//! The forces on the body and their balance.

use serde::{Deserialize, Serialize};

use crate::algebra::vector::dot;
use crate::body::model::{Balance, Model, Wrench};
use crate::solver::history::IncrementView;

/// The forces on the body at the end of an increment, except contact. Loads, supports and springs act on the body,
/// contact forces ([`super::ForceRecord`]) on the obstacles. `balance` measures the sum of the first three minus the
/// last.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct BalanceRecord {
    /// The increment, from 1.
    pub index: usize,
    /// The time at its end, s.
    pub time: f64,
    /// The force of each support on the body (reaction). Supports that constrain the same displacement share its
    /// reaction evenly.
    pub supports: Vec<AppliedForce>,
    /// The force of each spring or foundation on the body.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub springs: Vec<AppliedForce>,
    /// The force of each load.
    pub loads: Vec<AppliedForce>,
    /// The motion of each reference point, and the force and moment on the body there: the sum of loads, supports and
    /// springs that act on the point. The moment is about the point.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub couplings: Vec<PointRecord>,
    /// The force across each section with a pretension, and its shortening.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pretensions: Vec<SectionRecord>,
    /// The imbalance of all forces on the body: the magnitude of the resultant force, or of the moment about the body's
    /// middle divided by its size, relative to the sum of the magnitudes of the nodal forces.
    pub balance: f64,
    /// The imbalance of the forces alone, relative to that sum.
    #[serde(skip)]
    pub of_forces: f64,
    /// The sum of the magnitudes of the nodal forces, N.
    #[serde(skip)]
    pub size: f64,
}

/// A force on the body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct AppliedForce {
    /// The boundary, the point or the coupling.
    pub at: String,
    /// x, y and, in three dimensions, z, N; in two dimensions N per m of depth.
    pub force: Vec<f64>,
    /// The moment about the origin at the reference positions of the nodes: about z in two dimensions, about x, y and z
    /// in three, N m; in two dimensions N m per m of depth.
    pub moment: Vec<f64>,
    /// The mean displacement of the nodes on which it acts: x, y and, in three dimensions, z, m.
    #[serde(default)]
    pub displacement: Vec<f64>,
}

/// The reference point of a coupling.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct PointRecord {
    /// The name of the coupling.
    pub at: String,
    /// The force on the body at the point: x, y and, in three dimensions, z, N; in two dimensions N per m of depth.
    pub force: Vec<f64>,
    /// The moment on the body about the point: about z in two dimensions, about x, y and z in three, N m; in two
    /// dimensions N m per m of depth.
    pub moment: Vec<f64>,
    /// The displacement of the point: x, y and, in three dimensions, z, m.
    pub displacement: Vec<f64>,
    /// The rotation of the point: about z in two dimensions, about x, y and z in three, rad.
    pub rotation: Vec<f64>,
}

/// A section with a pretension.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct SectionRecord {
    /// The name of the pretension.
    pub at: String,
    /// The force along the outward normal of the boundary, positive for tension, N; in two dimensions N per m of depth.
    pub normal_force: f64,
    /// The length by which the boundary has moved beyond the other side, m.
    pub shortening: f64,
    /// The force across the section on the side of the boundary: x, y and, in three dimensions, z, N; in two dimensions N
    /// per m of depth.
    pub force: Vec<f64>,
    /// The moment of this force about the centroid of the section: about z in two dimensions, about x, y and z in three,
    /// N m; in two dimensions N m per m of depth. Empty for periodic boundaries.
    pub moment: Vec<f64>,
    /// The motion of the boundary beyond the other side: x, y and, in three dimensions, z, m.
    pub displacement: Vec<f64>,
}

impl BalanceRecord {
    /// Returns the balance at the end of a step.
    pub fn new(model: &Model, step: &IncrementView<'_>) -> Self {
        let (index, time) = (step.record.index, step.record.time);
        let Balance { loads, supports, springs, sections, closure, force_closure, size, .. } =
            model.balanced(time, step.state);
        let (description, units) = (model.description(), model.units());
        let [of_supports, of_springs, of_loads] = model.mean_displacements(time, step.state);
        let acting = |names: Vec<String>, wrenches: Vec<Wrench>, displacements: Vec<[f64; 3]>| {
            let acting = names.into_iter().zip(wrenches).zip(displacements);
            acting.map(|((at, wrench), u)| AppliedForce::new(at, wrench, u, model.mesh.components())).collect()
        };
        let couplings = model.coupled(time, step.state, [&loads, &supports, &springs]);
        // A load on a reference point moves with it.
        let at_point = |name: Option<&str>| {
            let names = description.couplings.iter().map(|coupling| coupling.name.as_str());
            names.zip(&couplings).find(|(own, _)| Some(*own) == name).map(|(_, (_, [u, _]))| *u)
        };
        let of_loads = description.loads.iter().zip(of_loads);
        let of_loads = of_loads.map(|(load, u)| at_point(load.action.coupling()).unwrap_or(u)).collect();
        let couplings = couplings.into_iter().zip(&description.couplings).map(|((wrench, [u, rotation]), coupling)| {
            let components = model.mesh.components();
            let AppliedForce { at, force, moment, displacement } =
                AppliedForce::new(coupling.name.clone(), wrench, u, components);
            PointRecord { at, force, moment, displacement, rotation: about_axes(rotation, components) }
        });
        let jumps = sections.into_iter().zip(model.sections(time, step.state)).zip(&description.pretensions);
        let pretensions = jumps.map(|((wrench, [normal, jump]), pretension)| {
            let (normal_force, shortening) = (dot(wrench.force, normal), dot(jump, normal));
            let AppliedForce { at, force, moment, displacement } =
                AppliedForce::new(pretension.name.clone(), wrench, jump, model.mesh.components());
            // Forces at the corners of a cell are shared by its periods, which have no moments of their own.
            let moment = if description.is_periodic(&pretension.boundary) { Vec::new() } else { moment };
            SectionRecord { at, normal_force, shortening, force, moment, displacement }
        });
        BalanceRecord {
            index,
            time,
            couplings: couplings.collect(),
            pretensions: pretensions.collect(),
            supports: acting(
                description.supports.iter().map(|support| support.at.location(&units)).collect(),
                supports,
                of_supports,
            ),
            springs: acting(description.springs.iter().map(|bed| bed.location(&units)).collect(), springs, of_springs),
            loads: acting(description.loads.iter().map(|load| load.action.location(&units)).collect(), loads, of_loads),
            balance: closure,
            of_forces: force_closure,
            size,
        }
    }
}

impl AppliedForce {
    fn new(at: String, wrench: Wrench, displacement: [f64; 3], components: usize) -> Self {
        let Wrench { force, moment } = wrench;
        let displacement = displacement[..components].to_vec();
        let (force, moment) = (force[..components].to_vec(), about_axes(moment, components));
        AppliedForce { at, force, moment, displacement }
    }
}

/// Returns the components of an axial vector: z if forces have two components, otherwise all.
pub(super) fn about_axes(vector: [f64; 3], components: usize) -> Vec<f64> {
    if components == 2 { vec![vector[2]] } else { vector.to_vec() }
}
