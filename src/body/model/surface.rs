//! The stress along the contact surface.
//!
//! The strains along the surface are derivatives of the displacements of its own nodes: around each contact node a
//! quadratic polynomial is fitted to them (Zhang and Naga, SIAM J. Sci. Comput. 26 (2005) 1192). Hooke's law and the known traction then give the rest of the stress. With m the
//! outward normal of the body, t and o along its surface,
//!
//! ```text
//! σ_mm = -p,   λ tr ε = λ (σ_mm + 2 μ (ε_tt + ε_oo)) / (λ + 2 μ),   σ_tt = λ tr ε + 2 μ ε_tt.
//! ```
//!
//! No derivative across the surface occurs, which the mesh knows on one side only, and no pressure is computed from the
//! change of volume of a nearly incompressible body.

use std::collections::{BTreeMap, BTreeSet};

use super::Model;
use super::recovery::beside;
use crate::algebra::elimination::solve;
use crate::algebra::vector::{across, cross, dot, minus, norm, plus, unit};
use crate::body::description::{Action, Bed, Where};
use crate::body::fem::facet_normals;
use crate::body::mesh::{CellKind, Facet, sorted};
use crate::solver::problem::State;

/// Facets belong to one smooth surface if the cosine between their normals exceeds this: the angle of 40 degrees at which
/// estimates begin to see a corner.
const SMOOTH: f64 = 0.766;

/// A direction counts as held if the cosine between it and the direction of a support exceeds this.
const HELD: f64 = 0.1;

/// The largest number of layers of facets for a fit.
const LAYERS: usize = 4;

/// The degree of the polynomials. Near the end of a slip zone, where strains have a kink, those of higher degree
/// oscillate.
const DEGREE: i32 = 2;

/// The number of monomials on a surface in space.
const MONOMIALS: usize = 6;

/// The stress at a contact node, with the known traction. Directions: t is that of the contact stresses, in space
/// projected on the surface; o is at right angles to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceStress {
    /// The normal stress along t, Pa.
    pub along: f64,
    /// The normal stress along o, Pa: in two dimensions out of the plane, the hoop stress of a body of revolution.
    pub across: f64,
    /// The shear stress between t and o in the surface, Pa; 0 in two dimensions.
    pub shear: f64,
    /// The whole stress `(σ_xx, σ_yy, σ_zz, τ_xy, τ_yz, τ_zx)`, Pa.
    pub stress: [f64; 6],
}

/// The set-up of the stresses along the contact surface: what depends on the mesh alone.
#[derive(Debug, Clone)]
pub(crate) struct Surface {
    /// One for each contact node.
    fits: Vec<Fit>,
    /// For each contact node, itself and its neighbours; only with linear tetrahedra, whose nodal pressures scatter.
    patches: Option<Vec<Vec<usize>>>,
}

#[derive(Debug, Clone)]
struct Fit {
    /// The node of the mesh.
    node: usize,
    /// The cells whose sides meet at the node; they have one law.
    cells: Vec<usize>,
    /// The outward normal of the body, t and o.
    axes: [[f64; 3]; 3],
    /// The derivatives along t and o at the node: the factors of the displacements of nodes.
    slopes: Vec<(usize, [f64; 2])>,
    /// For each direction of `axes`: `true` if contact alone makes the traction along it.
    known: [bool; 3],
}

/// Computes the monomials up to `degree` at a point of a curve (`dimension` 2) or of a surface.
fn monomials([x, y]: [f64; 2], degree: i32, dimension: usize) -> Vec<f64> {
    let powers = |total: i32| (0..=total).map(move |k| x.powi(total - k) * y.powi(k));
    match dimension {
        2 => (0..=degree).map(|k| x.powi(k)).collect(),
        _ => (0..=degree).flat_map(powers).collect(),
    }
}

/// Returns the factors of values at `points` whose sums are the derivatives at the origin of the polynomial of this
/// `degree` fitted to the values; `None` if they do not determine one.
fn slopes(points: &[[f64; 2]], degree: i32, dimension: usize) -> Option<Vec<[f64; 2]>> {
    let count = monomials([0.0; 2], degree, dimension).len();
    if points.len() < count {
        return None;
    }
    let size = |c: usize| points.iter().map(|x| x[c].abs()).fold(0.0, f64::max);
    let size = [size(0), if dimension == 2 { 1.0 } else { size(1) }];
    if size.contains(&0.0) {
        return None;
    }
    let values: Vec<Vec<f64>> =
        points.iter().map(|[x, y]| monomials([x / size[0], y / size[1]], degree, dimension)).collect();
    let mut rows = [[0.0; MONOMIALS + 2]; MONOMIALS];
    let rows = &mut rows[..count];
    for q in &values {
        for (row, a) in rows.iter_mut().zip(q) {
            row.iter_mut().zip(q).for_each(|(sum, b)| *sum += a * b / points.len() as f64);
        }
    }
    // The derivatives of the monomials at the origin.
    for k in 0..dimension - 1 {
        rows[1 + k][count + k] = 1.0 / (size[k] * points.len() as f64);
    }
    solve(rows)?;
    let factors = |q: &Vec<f64>| [0, 1].map(|k| q.iter().zip(&*rows).map(|(q, row)| q * row[count + k]).sum());
    Some(values.iter().map(factors).collect())
}

impl Surface {
    pub(super) fn new(model: &Model) -> Self {
        let mesh = &model.mesh;
        let of_contact: BTreeSet<usize> = model.contact.nodes.iter().map(|contact| contact.node).collect();
        let surface = mesh.surface_at(|node| of_contact.contains(&node));
        let mut at_node: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (f, (facet, _)) in surface.iter().enumerate() {
            for &node in facet {
                at_node.entry(node).or_default().push(f);
            }
        }
        let normals = surface.iter().map(|(facet, _)| unit(mesh.area_vector(facet))).collect();
        let sides = Sides { facets: surface, normals, at_node };
        let in_contact: BTreeSet<Facet> = (model.contact.boundaries.iter())
            .filter_map(|own| mesh.boundary(&own.name))
            .flat_map(|boundary| boundary.facets.iter().map(|facet| sorted(facet)))
            .collect();
        let loaded = loaded_elsewhere(model);
        let fits = (0..model.contact.nodes.len()).map(|i| Fit::new(model, i, &sides, &in_contact, &loaded)).collect();
        let scatters = mesh.cells.iter().any(|cell| cell.kind == CellKind::Tetrahedron);
        let patches = scatters.then(|| {
            let beside = beside(mesh, &model.contact.nodes, &model.contact.boundaries, |_| true);
            (0..model.contact.nodes.len()).map(|i| beside.get(&i).map_or_else(|| vec![i], Vec::clone)).collect()
        });
        Surface { fits, patches }
    }
}

/// Returns the facets on which loads, springs or the contact forces of other nodes act.
fn loaded_elsewhere(model: &Model) -> BTreeSet<Facet> {
    let description = model.description();
    let of_loads = description.loads.iter().filter_map(|load| match &load.action {
        Action::Traction { boundary, .. }
        | Action::Pressure { boundary, .. }
        | Action::Force { at: Where::Boundary(boundary), .. } => Some(boundary),
        _ => None,
    });
    let of_springs = description.springs.iter().filter_map(|bed| match bed {
        Bed::Surface { boundary, .. } | Bed::Axes { at: Where::Boundary(boundary), .. } => Some(boundary),
        Bed::Axes { .. } | Bed::Rotational { .. } => None,
    });
    let masters = model.contact.pairs.iter().map(|pair| &pair.master);
    let boundaries = of_loads.chain(of_springs).filter_map(|name| model.mesh.boundary(name)).chain(masters);
    boundaries.flat_map(|boundary| boundary.facets.iter().map(|facet| sorted(facet))).collect()
}

/// The sides of the body at contact nodes.
struct Sides {
    facets: Vec<(Facet, usize)>,
    /// The unit outward normals.
    normals: Vec<[f64; 3]>,
    at_node: BTreeMap<usize, Vec<usize>>,
}

impl Sides {
    /// Returns the sides at `nodes` that continue side `first` smoothly in its material.
    fn beside<'a>(&self, model: &Model, nodes: impl Iterator<Item = &'a usize>, first: usize) -> BTreeSet<usize> {
        let cell = |f: usize| self.facets[f].1;
        let group = |f: usize| model.mesh.cells[cell(f)].group;
        let continues = |f: &usize| {
            dot(self.normals[*f], self.normals[first]) > SMOOTH
                && group(*f) == group(first)
                && model.materials()[cell(*f)] == model.materials()[cell(first)]
        };
        nodes.filter_map(|node| self.at_node.get(node)).flatten().copied().filter(continues).collect()
    }

    fn nodes(&self, sides: &BTreeSet<usize>) -> BTreeSet<usize> {
        sides.iter().flat_map(|&f| &self.facets[f].0).copied().collect()
    }
}

impl Fit {
    /// Prepares the fit at contact node `i`; `contact` are the sides in contact, `loaded` those on which something else
    /// acts.
    fn new(model: &Model, i: usize, sides: &Sides, contact: &BTreeSet<Facet>, loaded: &BTreeSet<Facet>) -> Self {
        let (mesh, d) = (&model.mesh, model.mesh.dimension);
        let contact_node = &model.contact.nodes[i];
        let (node, normal, tangent) = (contact_node.node, contact_node.facing.normal, contact_node.frame[0]);
        let all = sides.at_node.get(&node).map_or(&[][..], |all| all);
        let towards =
            |f: usize| dot(sides.normals[f], normal) + f64::from(contact.contains(&sorted(&sides.facets[f].0)));
        let first = all.iter().copied().max_by(|&a, &b| towards(a).total_cmp(&towards(b)));
        let own = first.map_or_else(BTreeSet::new, |first| sides.beside(model, [node].iter(), first));
        let mut sum = [0.0; 3];
        for facet in own.iter().map(|&f| &sides.facets[f].0) {
            let at = facet.iter().position(|other| *other == node).unwrap_or(0);
            sum = plus(sum, 1.0, facet_normals(mesh, facet)[at]);
        }
        let m = if norm(sum) > 0.0 { unit(sum) } else { normal };
        let t = if d == 2 { [-m[1], m[0], 0.0] } else { unit(across(tangent, m)) };
        let axes = [m, t, cross(m, t)];
        let held: Vec<[f64; 3]> = model.constraints.dofs.held(node).collect();
        let is_loaded = own.iter().any(|&f| loaded.contains(&sorted(&sides.facets[f].0)));
        // Nothing acts out of the plane.
        let is_free =
            |axis: [f64; 3]| d == 2 && axis[2] != 0.0 || held.iter().all(|held| dot(*held, axis).abs() < HELD);
        let slopes = first.and_then(|first| {
            (1..=DEGREE).rev().find_map(|degree| {
                let mut patch = sides.nodes(&own);
                (0..LAYERS).find_map(|_| {
                    let nodes: Vec<usize> = patch.iter().copied().collect();
                    let coordinates = |other: &usize| {
                        let from = minus(mesh.nodes[*other], mesh.nodes[node]);
                        [dot(from, axes[1]), if d == 2 { 0.0 } else { dot(from, axes[2]) }]
                    };
                    let coordinates: Vec<[f64; 2]> = nodes.iter().map(coordinates).collect();
                    let slopes = slopes(&coordinates, degree, d);
                    patch = sides.nodes(&sides.beside(model, nodes.iter(), first));
                    Some(nodes.into_iter().zip(slopes?).collect())
                })
            })
        });
        Fit {
            node,
            cells: own.iter().map(|&f| sides.facets[f].1).collect(),
            axes,
            slopes: slopes.unwrap_or_default(),
            known: axes.map(|axis| !is_loaded && is_free(axis)),
        }
    }

    /// Computes the stress for the `traction` (Pa) of the body on its surroundings. Where something else acts, the
    /// traction is that of the cells.
    fn stress(&self, model: &Model, factors: &[f64], displacements: &[[f64; 3]], traction: [f64; 3]) -> SurfaceStress {
        let Some([along, across, shear]) = self.strain(model, factors, displacements) else {
            return SurfaceStress::of(self.of_cells(model, factors, displacements), self.axes);
        };
        let mut on_surface = self.axes.map(|axis| -dot(traction, axis));
        if self.known.contains(&false) {
            let [mm, _, _, mt, _, om] = self.of_cells(model, factors, displacements);
            let of_cells = [mm, mt, om];
            (0..3).filter(|&k| !self.known[k]).for_each(|k| on_surface[k] = of_cells[k]);
        }
        let law = model.materials()[self.cells[0]];
        let [mm, mt, om] = on_surface;
        let pressure = law.lambda / (law.lambda + 2.0 * law.mu) * (mm + 2.0 * law.mu * (along + across));
        let direct = |strain: f64| pressure + 2.0 * law.mu * strain;
        let out = if model.is_thin() { 0.0 } else { direct(across) };
        SurfaceStress::of([mm, direct(along), out, mt, law.mu * shear, om], self.axes)
    }

    /// Returns the mean of the stresses of the cells in the node, on the axes.
    fn of_cells(&self, model: &Model, factors: &[f64], displacements: &[[f64; 3]]) -> [f64; 6] {
        let of_cell = |&e: &usize| {
            let cell = &model.mesh.cells[e];
            let k = cell.nodes.iter().position(|node| *node == self.node).unwrap_or(0);
            model.stress_in(e, cell.kind.reference_node(k), factors, displacements)
        };
        let share = 1.0 / self.cells.len() as f64;
        let add = |sum: [f64; 6], stress: [f64; 6]| std::array::from_fn(|c| sum[c] + share * stress[c]);
        turned(self.cells.iter().map(of_cell).fold([0.0; 6], add), self.axes)
    }

    /// Computes `(ε_tt, ε_oo, γ_to)` without the thermal strain; `None` if the derivatives along the surface are
    /// unknown.
    fn strain(&self, model: &Model, factors: &[f64], displacements: &[[f64; 3]]) -> Option<[f64; 3]> {
        let (mesh, [_, t, o]) = (&model.mesh, self.axes);
        if self.slopes.is_empty() {
            return None;
        }
        let own = displacements[self.node];
        let mut rates = [[0.0; 3]; 2];
        for (node, slopes) in &self.slopes {
            let u = minus(displacements[*node], own);
            rates = [0, 1].map(|k| plus(rates[k], slopes[k], u));
        }
        let [along_t, along_o] = rates;
        let mut strain = [dot(along_t, t), dot(along_o, o), dot(along_t, o) + dot(along_o, t)];
        if mesh.geometry.is_revolved() {
            let r = mesh.nodes[self.node][0];
            let (on_axis, around) = (mesh.is_on_axis(self.node), dot(own, o));
            strain[1] = if on_axis { strain[0] } else { own[0] / r };
            strain[2] -= if on_axis { strain[2] } else { around * t[0] / r };
        }
        if !factors.is_empty() {
            let share = 1.0 / self.cells.len() as f64;
            for &e in &self.cells {
                let free = model.free_stretch(e, factors);
                strain[0] -= share * free[0];
                // Out of the plane; in space the same as along the surface.
                strain[1] -= share * free[2];
            }
        }
        Some(strain)
    }
}

/// Returns the components of a stress on `axes`, in the same order.
fn turned([xx, yy, zz, xy, yz, zx]: [f64; 6], axes: [[f64; 3]; 3]) -> [f64; 6] {
    let rows = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
    let on = |a: usize, b: usize| dot(axes[a], rows.map(|row| dot(row, axes[b])));
    [on(0, 0), on(1, 1), on(2, 2), on(0, 1), on(1, 2), on(2, 0)]
}

impl SurfaceStress {
    /// Creates the stress with these components on the `axes` m, t and o.
    fn of(stress: [f64; 6], axes: [[f64; 3]; 3]) -> Self {
        let back = [0, 1, 2].map(|c| axes.map(|axis| axis[c]));
        SurfaceStress { along: stress[1], across: stress[2], shear: stress[4], stress: turned(stress, back) }
    }
}

impl Model {
    fn surface(&self) -> &Surface {
        self.surface.get_or_init(|| Surface::new(self))
    }

    /// Computes the stress at each contact node in a `state` at time `t` (s). What depends on the mesh is computed once
    /// for each model.
    pub fn surface_stresses(&self, t: f64, state: &State) -> Vec<SurfaceStress> {
        self.surface_stresses_of(&self.thermal_factors(t), &self.displaced(t, &state.u), state)
    }

    /// Computes [`Model::surface_stresses`] for the displacements of all nodes (m) and the `factors` of
    /// `Model::thermal_factors`.
    pub(crate) fn surface_stresses_of(
        &self,
        factors: &[f64],
        displacements: &[[f64; 3]],
        state: &State,
    ) -> Vec<SurfaceStress> {
        let fits = self.surface().fits.iter().zip(self.surface_tractions(state));
        fits.map(|(fit, traction)| fit.stress(self, factors, displacements, traction)).collect()
    }

    /// Returns the traction (Pa) of the body on its surroundings at each contact node: that of
    /// [`Model::recovered_tractions`], or the contact force divided by the node's weight (32), with linear tetrahedra of
    /// the node and its neighbours together.
    fn surface_tractions(&self, state: &State) -> Vec<[f64; 3]> {
        let recovered = self.recovered_tractions(state);
        recovered.unwrap_or_else(|| {
            let forces: Vec<[f64; 3]> = (0..self.contact.nodes.len()).map(|i| self.contact_force(state, i)).collect();
            if let Some(patches) = &self.surface().patches {
                let mean = |patch: &Vec<usize>| {
                    let weight: f64 = patch.iter().map(|&j| self.contact.nodes[j].weight).sum();
                    patch.iter().fold([0.0; 3], |sum, &j| plus(sum, 1.0 / weight, forces[j]))
                };
                return patches.iter().map(mean).collect();
            }
            let [x, y, z] = [0, 1, 2].map(|c| self.over_weights(|i| forces[i][c]));
            (0..forces.len()).map(|i| [x[i], y[i], z[i]]).collect()
        })
    }
}
