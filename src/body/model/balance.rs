//! The balance of all forces on a body: loads, supports, springs and contact.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Add;

use super::Model;
use super::constraints::Constraints;
use super::load::{FreeStrain, NodalLoad};
use super::support::PrescribedMotion;
use crate::algebra::vector::{cross, dot, minus, norm, plus};
use crate::body::constraints::{Dofs, HeldRows};
use crate::body::contact::{ContactNode, Facing, Term};
use crate::body::description::{Coupling, Description};
use crate::body::fem::{NodalForces, Spring, facet_weights};
use crate::body::mesh::{Geometry, Mesh};
use crate::solver::problem::error::expect_length;
use crate::solver::problem::{ProblemError, State};

/// A force and its moment about the origin at the reference positions of the nodes; in two dimensions per m of depth.
///
/// For a body of revolution, forces are those of the full circumference, the components along x and z are the sums of the
/// radial and the circumferential forces, and the only moment is the torque about the axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wrench {
    /// The force, N.
    pub force: [f64; 3],
    /// The moment, N m.
    pub moment: [f64; 3],
}

impl Wrench {
    /// Creates the wrench of a `force` (N) at `x` (m) on a body of this geometry.
    pub fn at(geometry: Geometry, x: [f64; 3], force: [f64; 3]) -> Self {
        let moment = match geometry {
            Geometry::Cartesian => cross(x, force),
            Geometry::Axisymmetric | Geometry::Torsion => [0.0, 0.0 - x[0] * force[2], 0.0],
        };
        Wrench { force, moment }
    }

    /// Creates the wrench of a `force` (N) on a node of the mesh or of a reference point.
    pub(super) fn on(mesh: &Mesh, dofs: &Dofs, node: usize, force: [f64; 3]) -> Self {
        match dofs.moment(node, force) {
            None => Wrench::at(mesh.geometry, dofs.position(mesh, node), force),
            Some(moment) => Wrench { force: [0.0; 3], moment },
        }
    }

    fn times(self, factor: f64) -> Self {
        Wrench { force: self.force.map(|f| factor * f), moment: self.moment.map(|m| factor * m) }
    }
}

impl Add for Wrench {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Wrench { force: plus(self.force, 1.0, other.force), moment: plus(self.moment, 1.0, other.moment) }
    }
}

impl std::iter::Sum for Wrench {
    fn sum<I: Iterator<Item = Self>>(wrenches: I) -> Self {
        wrenches.fold(Wrench::default(), Add::add)
    }
}

/// All forces on a body, in the order of its description.
#[derive(Debug, Clone, PartialEq)]
pub struct Balance {
    /// The force of each load.
    pub loads: Vec<Wrench>,
    /// The force of each support on the body.
    pub supports: Vec<Wrench>,
    /// The force of each spring or foundation on the body.
    pub springs: Vec<Wrench>,
    /// The force across the section of each pretension on the first of its two sides, and its moment about the centroid of
    /// the section.
    pub sections: Vec<Wrench>,
    /// The force of the obstacles on the body. Forces between bodies cancel, except for the moment of friction across a
    /// gap.
    pub contact: Wrench,
    /// The residual of all forces and moments, relative to the sum of the magnitudes of the forces on the nodes.
    pub closure: f64,
    /// The residual of all forces without moments, relative to the sum of the magnitudes.
    pub force_closure: f64,
    /// The sum of the magnitudes of the forces on the nodes, N.
    pub size: f64,
}

/// The forces that act on a body at factor 1, for its balance.
#[derive(Debug, Clone)]
pub(super) struct Statics {
    rows: HeldRows,
    /// The share of each support in the forces on held nodes, see [`super::support::shares`].
    shares: Vec<Vec<(usize, [[f64; 3]; 3])>>,
    springs: Vec<Vec<Spring>>,
    loads: Vec<UnitLoad>,
    /// The nodes of each support, spring or foundation, and load, with their shares in its area.
    nodes: [Vec<Vec<(usize, f64)>>; 3],
    /// For each motion of supports, the forces of springs (N) on the nodes due to its rigid offset at factor 1.
    on_springs: Vec<NodalForces>,
}

/// A load at factor 1.
#[derive(Debug, Clone)]
struct UnitLoad {
    whole: Wrench,
    /// The sum of the magnitudes of its forces, N.
    size: f64,
    /// Its force on each node, N.
    at_nodes: NodalForces,
    /// The stress-free strain, if it is thermal.
    free_strain: Option<FreeStrain>,
}

/// Returns the translating `nodes` with their shares in the area of the facets between them, or equal ones if some are on
/// no such facet.
fn shares_of_area(mesh: &Mesh, dofs: &Dofs, nodes: Vec<usize>) -> Vec<(usize, f64)> {
    let mut shares: BTreeMap<usize, f64> = nodes.into_iter().map(|node| (dofs.translating(node), 0.0)).collect();
    let facets = mesh.boundaries.iter().flat_map(|boundary| &boundary.facets);
    let between = facets.filter(|facet| facet.iter().all(|node| shares.contains_key(node)));
    let facets: BTreeMap<BTreeSet<usize>, _> = between.map(|facet| (facet.iter().copied().collect(), facet)).collect();
    let is_surface = facets.keys().flatten().collect::<BTreeSet<_>>().len() == shares.len();
    for facet in facets.values().filter(|_| is_surface) {
        for (node, weight) in facet.iter().zip(facet_weights(mesh, facet)) {
            *shares.entry(*node).or_default() += weight;
        }
    }
    let whole: f64 = shares.values().sum();
    let equal = 1.0 / shares.len() as f64;
    shares.into_iter().map(|(node, share)| (node, if whole > 0.0 { share / whole } else { equal })).collect()
}

impl Statics {
    pub(super) fn new(
        mesh: &Mesh,
        constraints: &Constraints,
        rows: HeldRows,
        shares: Vec<Vec<(usize, [[f64; 3]; 3])>>,
        springs: Vec<Vec<Spring>>,
        loads: Vec<NodalLoad>,
    ) -> Self {
        let Constraints { dofs, prescribed, groups, .. } = constraints;
        let all: Vec<Spring> = springs.iter().flatten().cloned().collect();
        let at_nodes = |forces: &NodalForces| {
            let mut sums = BTreeMap::<usize, [f64; 3]>::new();
            for (node, force) in forces {
                let sum = sums.entry(*node).or_default();
                *sum = plus(*sum, 1.0, *force);
            }
            sums.into_iter().collect()
        };
        let acting = |(forces, free_strain): NodalLoad| {
            let whole = forces.iter().map(|(node, force)| Wrench::on(mesh, dofs, *node, *force)).sum();
            let size = forces.iter().map(|(_, force)| norm(*force)).sum();
            UnitLoad { whole, size, at_nodes: at_nodes(&forces), free_strain }
        };
        let of_supports = |share: &Vec<(usize, _)>| share.iter().map(|(node, _)| *node).collect();
        let of_springs = |springs: &Vec<Spring>| springs.iter().flat_map(Spring::nodes).copied().collect();
        let of_loads = |(forces, _): &NodalLoad| forces.iter().map(|(node, _)| *node).collect();
        let nodes: [Vec<Vec<usize>>; 3] = [
            shares.iter().map(of_supports).collect(),
            springs.iter().map(of_springs).collect(),
            loads.iter().map(of_loads).collect(),
        ];
        let nodes = nodes.map(|all| all.into_iter().map(|nodes| shares_of_area(mesh, dofs, nodes)).collect());
        let loads = loads.into_iter().map(acting).collect();
        let on_springs = prescribed.iter().map(|motion| at_nodes(&motion.forces_of_springs(groups, &all))).collect();
        Statics { rows, shares, springs, loads, nodes, on_springs }
    }

    /// Returns the stress-free strain of each thermal load at factor 1, with the number of the load.
    pub(super) fn free_strains(&self) -> impl Iterator<Item = (usize, &FreeStrain)> {
        self.loads.iter().enumerate().filter_map(|(k, load)| Some((k, load.free_strain.as_ref()?)))
    }

    /// Returns all springs; foundations have one for each facet.
    pub(super) fn springs(&self) -> impl Iterator<Item = &Spring> {
        self.springs.iter().flatten()
    }
}

impl Model {
    /// Returns the displacements (m) of all nodes from the unknowns `u` (n_u, m) at time `t` (s), including the motion
    /// by supports.
    ///
    /// # Errors
    /// [`ProblemError`] if the length of `u` is wrong.
    pub fn displacements(&self, t: f64, u: &[f64]) -> Result<Vec<[f64; 3]>, ProblemError> {
        expect_length("u", self.constraints.dofs.free(), u.len(), "one for each displacement")?;
        Ok(self.displaced(t, u))
    }

    /// Returns the displacements of all nodes of the mesh; the length of `u` is not checked.
    pub(crate) fn displaced(&self, t: f64, u: &[f64]) -> Vec<[f64; 3]> {
        let mut all = self.constraints.displaced(t, u);
        all.truncate(self.mesh.nodes.len());
        all
    }

    /// Returns the force of each load at factor 1, N, including the forces on held nodes; in two dimensions per m of
    /// depth, for a body of revolution over the full circumference.
    pub fn forces_of_loads(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        self.statics.loads.iter().map(|load| load.whole.force)
    }

    /// Returns the prescribed displacement of contact node `i` along its normal beyond the rigid offset, m; its gap
    /// refers to this position.
    pub(super) fn normal_deviation(&self, i: usize, t: f64) -> f64 {
        let ContactNode { node, facing, .. } = &self.contact.nodes[i];
        self.constraints
            .prescribed
            .iter()
            .map(|motion| motion.factor(t) * dot(motion.deviation[*node], facing.normal))
            .sum()
    }

    /// Returns the displacement of contact node `i` by supports along its normal and its tangents at time `t` (s), in
    /// addition to that of its unknowns, m.
    pub(crate) fn moved(&self, i: usize, t: f64) -> [f64; 3] {
        let contact = &self.contact.nodes[i];
        let directions = [contact.facing.normal, contact.facing.tangents[0], contact.facing.tangents[1]];
        let coupled = contact.coupled().is_some();
        // A rigid offset of both bodies causes no relative motion.
        let offset =
            if coupled { [0.0; 3] } else { self.constraints.offset(self.constraints.groups.of_node[contact.node], t) };
        let of = |motion: &PrescribedMotion| {
            if coupled {
                return motion.deviation_of(&self.constraints.dofs, &self.constraints.groups, contact);
            }
            directions.map(|n| dot(motion.deviation[contact.node], n))
        };
        let mut sum = directions.map(|n| dot(offset, n));
        for motion in &self.constraints.prescribed {
            let (factor, deviation) = (motion.factor(t), of(motion));
            (0..3).for_each(|c| sum[c] += factor * deviation[c]);
        }
        sum
    }

    /// Returns the gap (m) of contact node `i` at time `t` (s) that belongs to the displacement of the node itself.
    /// `of_rows` (n_c) are the gaps of the rows, which on boundaries of second order combine several nodes.
    pub(crate) fn nodal_gap(&self, i: usize, t: f64, of_rows: &[f64]) -> f64 {
        let contact = &self.contact.nodes[i];
        let Some((k, facing)) = self.assigned(i, t) else { return self.of_node_from_rows(i, |j| of_rows[j]) };
        if contact.is_single() {
            return of_rows[i];
        }
        let (obstacle, motion) = &self.contact.obstacles[k];
        motion.exact_gap(obstacle, t, contact.position, &facing) - self.normal_deviation(i, t)
    }

    /// Returns the force (N) of the body on the opposite side at contact node `i`, from the contact forces of `state`.
    pub(crate) fn contact_force(&self, state: &State, i: usize) -> [f64; 3] {
        force_along(&self.contact.nodes[i].facing, [state.p_n[i], state.p_t[i], state.p_o[i]])
    }

    /// Returns the total force (N) on the opposite side of all nodes in the rows of contact node `i`. On boundaries of
    /// second order the nodes have different normals.
    pub(crate) fn force_of_row(&self, state: &State, i: usize) -> [f64; 3] {
        if self.contact.nodes[i].is_single() {
            return self.contact_force(state, i);
        }
        self.forces_of_rows(state, i).fold([0.0; 3], |sum, (_, force)| plus(sum, 1.0, force))
    }

    /// Returns the force (N) on the opposite side of each node in the rows of contact node `i`.
    pub(crate) fn forces_of_rows(&self, state: &State, i: usize) -> impl Iterator<Item = (Term, [f64; 3])> + '_ {
        let p = [state.p_n[i], state.p_t[i], state.p_o[i]];
        self.contact.nodes[i].terms().map(move |term| {
            let force = force_along(&term.facing, p);
            (term, if term.coefficient == 1.0 { force } else { force.map(|f| term.coefficient * f) })
        })
    }

    /// Computes all forces on the body at time `t` (s) in the `state` at that time. The force of a support is the
    /// residual of the stiffness, contact and loads at its nodes, `K u + Cᵀ p - f`.
    ///
    /// # Errors
    /// [`ProblemError`] if the length of an array of the state does not fit the problem.
    pub fn balance(&self, t: f64, state: &State) -> Result<Balance, ProblemError> {
        state.check(&self.problem)?;
        Ok(self.balanced(t, state))
    }

    /// Computes all forces on the body; the lengths of the state are not checked.
    pub(crate) fn balanced(&self, t: f64, state: &State) -> Balance {
        let Statics { rows, shares, springs, loads, on_springs, .. } = &self.statics;
        let (strained, u_rest) = if state.u_rest.is_empty() {
            (self.constraints.strained(t, &state.u), Vec::new())
        } else {
            let (u, u_rest) = self.problem.strained(state);
            (self.constraints.strained(t, &u), self.constraints.dofs.displacements(&u_rest))
        };
        let mut forces = rows.forces(&strained, &u_rest);
        let factors: Vec<f64> = self.loading.cases().iter().take(loads.len()).map(|case| case.factor(t)).collect();
        for (load, factor) in loads.iter().zip(&factors) {
            add(&mut forces, -factor, load.at_nodes.iter().copied());
        }
        for (motion, at_nodes) in self.constraints.prescribed.iter().zip(on_springs) {
            add(&mut forces, -motion.factor(t), at_nodes.iter().copied());
        }
        let geometry = self.mesh.geometry;
        let mut size = 0.0;
        let mut contact = Wrench::default();
        for i in 0..self.contact.nodes.len() {
            size += norm(self.contact_force(state, i));
            for (term, force) in self.forces_of_rows(state, i) {
                contact = contact + Wrench::at(geometry, term.position, force.map(|f| -f));
                add(&mut forces, 1.0, [(term.node, force)]);
            }
        }
        // Forces that glue transfers to held nodes act on their supports, those on jumps on their sections.
        let mut glue = Wrench::default();
        let mut sections = vec![Wrench::default(); self.description.pretensions.len()];
        for node in self.constraints.dofs.followers().into_iter().rev() {
            let free = self.constraints.dofs.free_axes(node).into_iter();
            let passed = free.fold([0.0; 3], |sum, n| plus(sum, dot(forces[node], n), n));
            let parts = self.constraints.dofs.passed_on(node, passed);
            let (jumps, in_mesh): (Vec<_>, Vec<_>) =
                parts.iter().partition(|(other, _)| self.constraints.dofs.is_jump(*other));
            if !jumps.is_empty() {
                size += norm(passed);
                let across = in_mesh.into_iter().map(|&(other, part)| self.wrench_on(other, part.map(|f| -f)));
                glue = across.fold(glue + Wrench::at(geometry, self.mesh.nodes[node], passed), Add::add);
            }
            for &&(jump, part) in &jumps {
                if let Some((of, centre)) = self.constraints.joints.section(&self.constraints.dofs, jump) {
                    let arm = minus(self.mesh.nodes[node], centre);
                    sections[of] = sections[of] + Wrench { force: part, ..Wrench::at(geometry, arm, part) };
                }
            }
            add(&mut forces, 1.0, parts);
        }
        let mut wrench = |node: usize, force: [f64; 3]| {
            size += norm(force);
            self.wrench_on(node, force)
        };
        let mut supports = Vec::with_capacity(shares.len());
        for share in shares {
            let of_node = |(node, matrix): &(usize, [[f64; 3]; 3])| (*node, matrix.map(|row| dot(row, forces[*node])));
            supports.push(share.iter().map(of_node).map(|(node, force)| wrench(node, force)).sum());
        }
        let displaced = if springs.is_empty() { Vec::new() } else { self.constraints.displaced(t, &state.u) };
        let of_bed = |bed: &Vec<Spring>| {
            bed.iter().flat_map(|spring| spring.forces(&displaced)).map(|(node, force)| wrench(node, force)).sum()
        };
        let springs: Vec<Wrench> = springs.iter().map(of_bed).collect();
        size += loads.iter().zip(&factors).map(|(load, factor)| factor.abs() * load.size).sum::<f64>();
        let loads: Vec<Wrench> = loads.iter().zip(factors).map(|(load, factor)| load.whole.times(factor)).collect();
        let mut imbalance = loads.iter().chain(&supports).chain(&springs).copied().sum::<Wrench>() + contact;
        imbalance.moment = plus(imbalance.moment, 1.0, glue.moment);
        let [closure, force_closure] = self.left_of(imbalance).map(|left| if size > 0.0 { left / size } else { 0.0 });
        Balance { loads, supports, springs, sections, contact, closure, force_closure, size }
    }

    /// Returns the wrench of a `force` (N) on a node of the mesh or of a reference point.
    fn wrench_on(&self, node: usize, force: [f64; 3]) -> Wrench {
        Wrench::on(&self.mesh, &self.constraints.dofs, node, force)
    }

    /// Returns for each pretension the mean outward normal of its section and the jump there (m) at time `t` (s) in the
    /// `state` at that time.
    pub(crate) fn sections(&self, t: f64, state: &State) -> Vec<[[f64; 3]; 2]> {
        let mut sections = vec![[[0.0; 3]; 2]; self.description.pretensions.len()];
        if !sections.is_empty() {
            let all = self.constraints.displaced(t, &state.u);
            for (k, section) in self.constraints.joints.sections() {
                sections[section.of] = [section.normal, all[self.constraints.dofs.node_of_jump(k)]];
            }
        }
        sections
    }

    /// Returns the shortening (m) of each pretension at time `t` (s) in the `state` at that time.
    pub(crate) fn shortenings(&self, t: f64, state: &State) -> Vec<f64> {
        self.sections(t, state).into_iter().map(|[normal, jump]| dot(normal, jump)).collect()
    }

    /// Returns the mean displacement (m) over the area of each support, of each spring or foundation, and of each load at
    /// time `t` (s) in the `state` at that time; over the nodes where there is no area.
    pub(crate) fn mean_displacements(&self, t: f64, state: &State) -> [Vec<[f64; 3]>; 3] {
        let all = self.constraints.displaced(t, &state.u);
        let mean =
            |nodes: &Vec<(usize, f64)>| nodes.iter().fold([0.0; 3], |sum, &(node, share)| plus(sum, share, all[node]));
        self.statics.nodes.each_ref().map(|nodes| nodes.iter().map(mean).collect())
    }

    /// Returns for each node of the mesh `true` if no support, spring, contact or joint acts there, and no load but of whole bodies.
    pub(crate) fn untouched(&self) -> Vec<bool> {
        let of_contact = self.contact.nodes.iter().flat_map(|contact| contact.normal.iter().map(|(dof, _)| *dof));
        let mut untouched = self.constraints.dofs.untouched(of_contact);
        let nodes = self.statics.nodes.iter().flatten().filter(|nodes| nodes.len() < self.mesh.nodes.len());
        for (node, _) in nodes.flatten() {
            untouched.get_mut(*node).into_iter().for_each(|node| *node = false);
        }
        untouched
    }

    /// Returns for each coupling the force and the moment about its reference point that the forces of all `[loads,
    /// supports, springs]` there have, and the displacement (m) and the rotation (rad) of the point, at time `t` (s) in
    /// the `state` at that time.
    pub(crate) fn coupled(&self, t: f64, state: &State, acting: [&[Wrench]; 3]) -> Vec<(Wrench, [[f64; 3]; 2])> {
        if self.constraints.couplings.all.is_empty() {
            return Vec::new();
        }
        let all = self.constraints.displaced(t, &state.u);
        let is_revolved = self.mesh.geometry.is_revolved();
        let Description { loads, supports, springs, couplings, .. } = &self.description;
        let [of_loads, of_supports, of_springs] = acting;
        let one = |(k, coupling): (usize, &Coupling)| {
            let here = |name: Option<&str>| name == Some(coupling.name.as_str());
            let of_loads = loads.iter().zip(of_loads).filter(|(load, _)| here(load.action.coupling()));
            let of_supports = supports.iter().zip(of_supports).filter(|(support, _)| here(support.at.coupling()));
            let of_springs = springs.iter().zip(of_springs).filter(|(bed, _)| here(bed.coupling()));
            let wrenches = of_loads.map(|(_, w)| *w).chain(of_supports.map(|(_, w)| *w));
            let Wrench { force, moment } = wrenches.chain(of_springs.map(|(_, w)| *w)).sum();
            let position = self.constraints.couplings.all[k].position;
            let moment = minus(moment, cross(position, force));
            let [force, moment] = [force, moment].map(|of| if is_revolved { [0.0, of[1], 0.0] } else { of });
            (Wrench { force, moment }, self.constraints.couplings.motion(&self.mesh, &self.constraints.dofs, k, &all))
        };
        couplings.iter().enumerate().map(one).collect()
    }

    /// Returns the larger of the magnitudes of the force and of the moment about the middle of the body divided by its
    /// size; and the magnitude of the force.
    fn left_of(&self, left: Wrench) -> [f64; 2] {
        if self.mesh.geometry.is_revolved() {
            // Radial and circumferential forces are in equilibrium by symmetry.
            let force = left.force[1].abs();
            return [force.max(left.moment[1].abs() / self.mesh.size()), force];
        }
        let middle = self.mesh.bounds().map(|(lowest, highest)| 0.5 * (lowest + highest));
        let moment = minus(left.moment, cross(middle, left.force));
        [norm(left.force).max(norm(moment) / self.mesh.size()), norm(left.force)]
    }
}

/// Returns the force with these components along the normal and the tangents of a node.
fn force_along(facing: &Facing, [p_n, p_t, p_o]: [f64; 3]) -> [f64; 3] {
    let [t, o] = facing.tangents;
    [0, 1, 2].map(|c| p_n * facing.normal[c] + p_t * t[c] + p_o * o[c])
}

/// Adds `factor` times each of `terms` at its index.
fn add(sums: &mut [[f64; 3]], factor: f64, terms: impl IntoIterator<Item = (usize, [f64; 3])>) {
    for (k, term) in terms {
        (0..3).for_each(|c| sums[k][c] += factor * term[c]);
    }
}
