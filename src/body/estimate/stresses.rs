//! Stresses at the nodes, recovered from patches of cells (Zienkiewicz and Zhu, Int. J. Numer. Meth. Engng 33 (1992)
//! 1331).
//!
//! Around each inner corner, a polynomial is fitted to the strains of its cells: a linear one to the means of linear
//! cells, which are most accurate in their middle, or a quadratic one to the strains at the integration points of cells
//! of second order. A corner on the surface has too few cells around it and takes the mean of the polynomials of the
//! inner corners beside it; a node between two corners has the mean of both ends. Patches contain cells of one material,
//! so that an interface between materials counts as surface.

use std::collections::{BTreeSet, HashSet};

use super::recovery::{LAYERS, MONOMIALS, Places, SPARE, monomials, scaled};
use super::strains::{Strains, points_of};
use crate::algebra::elimination::solve;
use crate::algebra::vector::minus;
use crate::body::mesh::{CellKind, Mesh, ReferenceCells};
use crate::body::model::Model;
use crate::solver::problem::ProblemError;
use crate::solver::problem::error::expect_length;

/// The number of rings of corners around a corner, itself included, in which inner corners are looked for.
const RINGS: usize = 3;

/// The set-up of the recovery: what depends on the mesh alone.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StressRecovery {
    places: Places,
    /// For each place, the patches whose polynomials make up its value; none where no value is wanted.
    patches_of: Vec<Vec<usize>>,
    /// A node and a cell of each place.
    at: Vec<(usize, usize)>,
    patches: Vec<Patch>,
    /// The integration points of each cell that is in a patch.
    points: Vec<Points>,
}

/// The integration points of a cell; none if no patch contains it.
#[derive(Debug, Clone, Default, PartialEq)]
struct Points {
    positions: Vec<[f64; 3]>,
    /// The shares of the points in the volume.
    shares: Vec<f64>,
    /// The mean position.
    middle: [f64; 3],
}

impl Points {
    fn new(mesh: &Mesh, kinds: &ReferenceCells, e: usize) -> Self {
        let points = points_of(mesh, mesh.geometry, kinds, e);
        let volume: f64 = points.iter().map(|(volume, _)| volume).sum();
        let shares: Vec<f64> = points.iter().map(|(v, _)| v / volume).collect();
        let positions: Vec<[f64; 3]> = points.into_iter().map(|(_, x)| x).collect();
        let middle = weighted(&shares, positions.iter().copied());
        Points { positions, shares, middle }
    }
}

/// Computes `Σ w x`.
fn weighted<const N: usize>(weights: &[f64], values: impl Iterator<Item = [f64; N]>) -> [f64; N] {
    weights.iter().zip(values).fold([0.0; N], |sum, (w, x)| std::array::from_fn(|c| sum[c] + w * x[c]))
}

/// The polynomial of a patch, before its values are known.
#[derive(Debug, Clone, PartialEq)]
struct Patch {
    cells: Vec<usize>,
    /// `true` if the polynomial is fitted to the integration points and not to the means of cells.
    at_points: bool,
    about: [f64; 3],
    /// The size of the patch along each axis, m.
    size: [f64; 3],
    /// The inverse of the matrix of the normal equations.
    inverse: Vec<[f64; MONOMIALS]>,
}

impl Patch {
    /// Prepares the fit of a polynomial with `count` monomials about a point; `None` if the samples do not determine it.
    fn new(
        cells: Vec<usize>,
        at_points: bool,
        count: usize,
        about: [f64; 3],
        mesh: &Mesh,
        points: &[Points],
    ) -> Option<Self> {
        let dimension = mesh.dimension;
        let positions: Vec<[f64; 3]> = if at_points {
            cells.iter().flat_map(|&e| &points[e].positions).copied().collect()
        } else {
            cells.iter().map(|&e| points[e].middle).collect()
        };
        let spare = match count {
            1 => 0,
            _ if count == dimension + 1 => 1,
            _ => SPARE,
        };
        if positions.len() < count + spare {
            return None;
        }
        let extent = |c: usize| positions.iter().map(|x| (x[c] - about[c]).abs()).fold(0.0, f64::max);
        let size = [0, 1, 2].map(|c| if c < dimension && count > 1 { extent(c) } else { 1.0 });
        if size.contains(&0.0) {
            return None;
        }
        let mut rows = [[0.0; 2 * MONOMIALS]; MONOMIALS];
        let rows = &mut rows[..count];
        for x in &positions {
            let q = monomials(scaled(minus(*x, about), size), dimension);
            for (row, a) in rows.iter_mut().zip(&q) {
                let a = a / positions.len() as f64;
                row.iter_mut().zip(&q[..count]).for_each(|(sum, b)| *sum += a * b);
            }
        }
        rows.iter_mut().enumerate().for_each(|(k, row)| row[count + k] = 1.0 / positions.len() as f64);
        solve(rows)?;
        let inverse =
            |row: &[f64; 2 * MONOMIALS]| std::array::from_fn(|c| if c < count { row[count + c] } else { 0.0 });
        Some(Patch { inverse: rows.iter().map(inverse).collect(), cells, at_points, about, size })
    }

    /// Returns the monomials at `x`.
    fn monomials(&self, x: [f64; 3], dimension: usize) -> [f64; MONOMIALS] {
        monomials(scaled(minus(x, self.about), self.size), dimension)
    }
}

/// The patches while they are searched.
struct Search<'a> {
    model: &'a Model,
    places: &'a Places,
    /// The cells around each corner.
    around: Vec<Vec<usize>>,
    /// For each place: `true` if cells of its material surround it.
    inner: Vec<bool>,
    at: Vec<(usize, usize)>,
    kinds: ReferenceCells,
    /// The integration points of the cells that were needed so far.
    points: Vec<Points>,
    /// The number of monomials.
    count: usize,
    quadratic: bool,
    patches: Vec<Patch>,
    /// The patch of each inner corner, once it was needed.
    known: Vec<Option<usize>>,
}

impl<'a> Search<'a> {
    fn new(model: &'a Model, places: &'a Places) -> Self {
        let mesh = &model.mesh;
        let quadratic = mesh.cells.iter().any(|cell| cell.kind.is_quadratic());
        let mut around = vec![Vec::new(); places.count];
        let mut at = vec![(usize::MAX, usize::MAX); places.count];
        let mut outside: HashSet<[usize; 4]> = HashSet::new();
        for (e, cell) in mesh.cells.iter().enumerate() {
            let own = places.of_cell(e);
            let corners = cell.kind.corners();
            for (&place, &node) in own.iter().zip(&cell.nodes) {
                if at[place].0 == usize::MAX {
                    at[place] = (node, e);
                }
            }
            own[..corners].iter().for_each(|&place| around[place].push(e));
            for side in cell.kind.sides() {
                let mut ends = [usize::MAX; 4];
                let of_side = side.iter().filter(|&&k| k < corners);
                ends.iter_mut().zip(of_side).for_each(|(end, &k)| *end = own[k]);
                ends.sort_unstable();
                if !outside.remove(&ends) {
                    outside.insert(ends);
                }
            }
        }
        let mut inner: Vec<bool> = around.iter().map(|cells| !cells.is_empty()).collect();
        outside.iter().flatten().filter(|&&place| place != usize::MAX).for_each(|&place| inner[place] = false);
        let count = match (quadratic, mesh.dimension) {
            (false, d) => d + 1,
            (true, 2) => 6,
            (true, _) => MONOMIALS,
        };
        Search {
            model,
            places,
            known: vec![None; around.len()],
            around,
            inner,
            at,
            kinds: ReferenceCells::new(mesh),
            points: vec![Points::default(); mesh.cells.len()],
            count,
            quadratic,
            patches: Vec::new(),
        }
    }

    fn corners(&self, e: usize) -> &[usize] {
        &self.places.of_cell(e)[..self.model.mesh.cells[e].kind.corners()]
    }

    /// Returns the corners of the cells around these `corners`.
    fn beside(&self, corners: &BTreeSet<usize>) -> BTreeSet<usize> {
        corners.iter().flat_map(|&place| &self.around[place]).flat_map(|&e| self.corners(e)).copied().collect()
    }

    /// Adds the patch of `cells` about a place, if its polynomial is determined.
    fn patch(&mut self, corner: usize, cells: Vec<usize>, count: usize, at_points: bool) -> Option<usize> {
        let mesh = &self.model.mesh;
        for &e in &cells {
            if self.points[e].shares.is_empty() {
                self.points[e] = Points::new(mesh, &self.kinds, e);
            }
        }
        let patch = Patch::new(cells, at_points, count, mesh.nodes[self.at[corner].0], mesh, &self.points)?;
        self.patches.push(patch);
        Some(self.patches.len() - 1)
    }

    /// Returns the patch of an inner corner.
    fn of_inner(&mut self, corner: usize) -> Option<usize> {
        if self.known[corner].is_none() {
            self.known[corner] = self.patch(corner, self.around[corner].clone(), self.count, self.quadratic);
        }
        self.known[corner]
    }

    /// Returns the patches of a corner: its own in the interior; elsewhere those of the inner corners beside it, or of
    /// those beside these. A part that is too thin for inner corners has a larger patch for each corner, with the
    /// integration points of its cells if their means do not determine the polynomial, and at last their mean.
    fn of_corner(&mut self, corner: usize) -> Vec<usize> {
        let mut corners = BTreeSet::from([corner]);
        for _ in 0..RINGS {
            let inner: Vec<usize> = corners.iter().copied().filter(|&corner| self.inner[corner]).collect();
            let patches: Vec<usize> = inner.into_iter().filter_map(|corner| self.of_inner(corner)).collect();
            if !patches.is_empty() {
                return patches;
            }
            corners = self.beside(&corners);
        }
        // Strains that are constant along a triangle scatter from cell to cell.
        let kind = self.model.mesh.cells[self.at[corner].1].kind;
        let scatter = matches!(kind, CellKind::Triangle | CellKind::Tetrahedron | CellKind::Prism);
        let own = BTreeSet::from([corner]);
        let first = if scatter { self.beside(&own) } else { own };
        for at_points in [self.quadratic, true] {
            let mut corners = first.clone();
            for _ in 0..LAYERS {
                let cells: BTreeSet<usize> = corners.iter().flat_map(|&corner| &self.around[corner]).copied().collect();
                if let Some(patch) = self.patch(corner, cells.into_iter().collect(), self.count, at_points) {
                    return vec![patch];
                }
                corners = self.beside(&corners);
            }
        }
        self.patch(corner, self.around[corner].clone(), 1, true).into_iter().collect()
    }
}

impl StressRecovery {
    /// Prepares the recovery at the nodes of the `wanted` cells.
    pub(crate) fn new(model: &Model, wanted: impl Fn(usize) -> bool) -> Self {
        let places = Places::by_material(model);
        let mut search = Search::new(model, &places);
        let mut patches_of = vec![Vec::new(); places.count];
        for (e, cell) in model.mesh.cells.iter().enumerate().filter(|(e, _)| wanted(*e)) {
            let own = places.of_cell(e);
            // Corners come before the nodes between them.
            for (k, &place) in own.iter().enumerate() {
                if !patches_of[place].is_empty() {
                    continue;
                }
                patches_of[place] = match cell.kind.between(k) {
                    [] => search.of_corner(place),
                    ends => {
                        let mut both: Vec<usize> = ends.iter().flat_map(|&end| patches_of[own[end]].clone()).collect();
                        both.sort_unstable();
                        both.dedup();
                        both
                    }
                };
            }
        }
        let Search { patches, at, mut points, .. } = search;
        // Patches that were too small have been left behind.
        let mut needed = vec![false; points.len()];
        patches.iter().flat_map(|patch| &patch.cells).for_each(|&e| needed[e] = true);
        points.iter_mut().zip(needed).filter(|(_, needed)| !needed).for_each(|(points, _)| *points = Points::default());
        StressRecovery { places, patches_of, at, patches, points }
    }

    /// Returns the indices of the values of the nodes of cell `e` in [`StressRecovery::stresses`].
    pub(crate) fn of_cell(&self, e: usize) -> &[usize] {
        self.places.of_cell(e)
    }

    /// Computes the stresses `(σ_xx, σ_yy, σ_zz, τ_xy, τ_yz, τ_zx)` (Pa) at the places, for the `displacements` of all
    /// nodes (m) and the `factors` of `Model::thermal_factors`; 0 where no value is wanted.
    pub(crate) fn stresses(&self, model: &Model, factors: &[f64], displacements: &[[f64; 3]]) -> Vec<[f64; 6]> {
        let (mesh, d) = (&model.mesh, model.mesh.dimension);
        let strains = Strains::in_cells(model, factors, displacements, |e| !self.points[e].shares.is_empty());
        let of_cell = |e: usize| strains.of_cell(e).iter().map(|(_, strain)| *strain);
        let means: Vec<[f64; 6]> =
            self.points.iter().enumerate().map(|(e, points)| weighted(&points.shares, of_cell(e))).collect();
        let fit = |patch: &Patch| {
            let mut sums = [[0.0; 6]; MONOMIALS];
            let mut add = |x: [f64; 3], strain: [f64; 6]| {
                for (sum, q) in sums.iter_mut().zip(patch.monomials(x, d)) {
                    *sum = std::array::from_fn(|c| sum[c] + q * strain[c]);
                }
            };
            for &e in &patch.cells {
                if patch.at_points {
                    self.points[e].positions.iter().zip(of_cell(e)).for_each(|(x, strain)| add(*x, strain));
                } else {
                    add(self.points[e].middle, means[e]);
                }
            }
            let row = |row: &[f64; MONOMIALS]| {
                let mut all = [0.0; 6];
                for (a, sum) in row.iter().zip(&sums) {
                    all = std::array::from_fn(|c| all[c] + a * sum[c]);
                }
                all
            };
            patch.inverse.iter().map(row).collect::<Vec<[f64; 6]>>()
        };
        let fits: Vec<_> = self.patches.iter().map(fit).collect();
        let value = |(of, &(node, e)): (&Vec<usize>, &(usize, usize))| {
            let mut strain = [0.0; 6];
            for &k in of {
                let q = self.patches[k].monomials(mesh.nodes[node], d);
                for (q, coefficient) in q.iter().zip(&fits[k]) {
                    strain = std::array::from_fn(|c| strain[c] + q * coefficient[c] / of.len() as f64);
                }
            }
            model.law_stress(e, strain)
        };
        self.patches_of.iter().zip(&self.at).map(value).collect()
    }
}

impl Model {
    /// Computes the stress at each node (Pa), recovered from the cells around it (Zienkiewicz and Zhu 1992), for the
    /// displacements of all nodes (m) at time `t` (s). At an interface between materials, the value is that of the first
    /// cell.
    ///
    /// # Errors
    /// If `displacements` does not have one entry for each node of the mesh.
    pub fn nodal_stresses_at(&self, t: f64, displacements: &[[f64; 3]]) -> Result<Vec<[f64; 6]>, ProblemError> {
        expect_length("displacements", self.mesh.nodes.len(), displacements.len(), "one for each node of the mesh")?;
        Ok(self.nodal_stresses(&self.thermal_factors(t), displacements))
    }

    /// Computes [`Model::nodal_stresses_at`] for displacements of the right length, with the `factors` of
    /// `Model::thermal_factors`.
    pub fn nodal_stresses(&self, factors: &[f64], displacements: &[[f64; 3]]) -> Vec<[f64; 6]> {
        let recovery = StressRecovery::new(self, |_| true);
        let at_places = recovery.stresses(self, factors, displacements);
        let mut at_nodes = vec![None; self.mesh.nodes.len()];
        for (e, cell) in self.mesh.cells.iter().enumerate() {
            for (&node, &place) in cell.nodes.iter().zip(recovery.of_cell(e)) {
                at_nodes[node].get_or_insert(at_places[place]);
            }
        }
        // Every node belongs to a cell.
        at_nodes.into_iter().map(|stress| stress.unwrap_or([f64::NAN; 6])).collect()
    }
}
