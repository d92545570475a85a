//! A stiffness with rows on all ranks, from the view of rank 0: vectors, and the columns near contact.

use std::any::Any;
use std::fmt;
use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::numbering::Numbering;
use super::piece::{Job, Piece, State};
use crate::algebra::linear::LinearError;
use crate::algebra::linear::ranks::{self, Kind, Shared, World};
use crate::algebra::sparse::{
    Csc, DoubleDouble, NodeRows, Pattern, SharedMatrix, SharedSymmetric, Symmetric, SystemMatrix,
};

/// Creates the matrix of `body`, of which each MPI rank assembles the rows of its own nodes. This process keeps a
/// copy of the columns at the nodes `near` contact. Returns `None` if a rank cannot assemble its rows, or has another
/// body.
///
/// # Errors
/// If MPI does not run, or memory is short.
pub fn share(body: &dyn NodeRows, near: &[bool]) -> Result<Option<Symmetric>, LinearError> {
    let stiffness = Stiffness::new(body, near)?;
    Ok(stiffness.map(|stiffness| Symmetric::from(SharedSymmetric::from(Arc::new(stiffness) as Arc<dyn SharedMatrix>))))
}

/// The shared stiffness; clones share it.
#[derive(Clone)]
pub(super) struct Stiffness(Arc<Inner>);

struct Inner {
    pieces: Mutex<Shared<Option<Piece>>>,
    numbering: Numbering,
    dimension: usize,
    /// The place of each displacement among all directions of all nodes.
    places: Vec<u32>,
    /// The nodes of the vector parts that the ranks need, rank after rank.
    needs: Vec<u32>,
    entries: usize,
    near: Csc,
    diagonal: Vec<f64>,
    row_norms: Vec<f64>,
    /// The number of hierarchies built so far.
    hierarchies: AtomicI64,
    /// The lower triangle, computed on demand.
    lower: OnceLock<Csc>,
}

impl fmt::Debug for Stiffness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Stiffness").field("order", &self.0.places.len()).field("ranks", &self.bounds()).finish()
    }
}

impl Stiffness {
    fn new(body: &dyn NodeRows, near: &[bool]) -> Result<Option<Self>, LinearError> {
        let own = Numbering::new(body, ranks::count())?;
        let make = |world: &World| Ok(Piece::assembled(world, Some(body), Some(&own)));
        let mut pieces = Shared::new(Kind::Stiffness, make)?;
        let mut shared = false;
        let d = body.dimension();
        let mut norms = [0, 1].map(|_| vec![0.0; own.count() * d]);
        let (needs, entries) = pieces.run(Job::Needs.number(), |world, piece| match piece {
            Some(piece) => {
                shared = true;
                piece.needs(world)
            }
            None => Ok(Default::default()),
        })?;
        if !shared {
            return Ok(None);
        }
        pieces.run(Job::Norms.number(), |world, piece| on(piece, |piece| piece.all_norms(world, &mut norms)))?;
        let mut places = vec![0; body.order()];
        for (node, number) in (0..body.nodes()).filter_map(|node| Some((node, own.number(node)?))) {
            for (direction, dof) in body.places(node).into_iter().enumerate() {
                if let Some(dof) = dof {
                    places[dof] = (number * d + direction) as u32;
                }
            }
        }
        let [row_norms, diagonal] = norms.map(|of| places.iter().map(|place| of[*place as usize]).collect());
        let Some(near) = body.rows(near).map(|rows| columns(&rows, body, near)) else { return Ok(None) };
        Ok(Some(Stiffness(Arc::new(Inner {
            pieces: Mutex::new(pieces),
            numbering: own,
            dimension: d,
            places,
            needs,
            entries,
            near,
            diagonal,
            row_norms,
            hierarchies: AtomicI64::new(0),
            lower: OnceLock::new(),
        }))))
    }

    /// Returns the shared stiffness of a matrix, if ranks share it.
    pub(super) fn of(matrix: &SystemMatrix) -> Option<&Self> {
        (matrix.shared()?.matrix() as &dyn Any).downcast_ref()
    }

    /// Returns the number of displacements.
    pub(super) fn displacements(&self) -> usize {
        self.0.places.len()
    }

    /// Returns the number of nodes of the mesh.
    pub(super) fn nodes(&self) -> usize {
        self.0.numbering.nodes()
    }

    /// Returns the number of a node of the mesh that has displacements.
    pub(super) fn number(&self, node: usize) -> Option<usize> {
        self.0.numbering.number(node)
    }

    /// Returns the ranges of nodes of the ranks.
    pub(super) fn bounds(&self) -> &[usize] {
        &self.0.numbering.bounds
    }

    /// Returns the number of entries of `K̂`.
    pub(super) fn entries(&self) -> usize {
        self.0.entries
    }

    /// Builds a hierarchy of `K̂` for `factor` times this stiffness, with `springs` on its diagonal and these contact
    /// nodes. Each rank assembles its rows.
    pub(super) fn cycle(&self, state: &State, kernel: &[Vec<f64>]) -> Result<SharedCycle, LinearError> {
        let number = self.0.hierarchies.fetch_add(1, Ordering::Relaxed);
        // It is dropped on all ranks even if this rank did not build it.
        let cycle = SharedCycle { stiffness: self.clone(), number };
        self.run(Job::Hierarchy(number), |world, piece| piece.hierarchy(world, number, Some(state), kernel))?;
        Ok(cycle)
    }

    fn run<T>(
        &self,
        job: Job,
        own: impl FnOnce(&World, &mut Piece) -> Result<T, LinearError>,
    ) -> Result<T, LinearError> {
        let mut pieces = self.0.pieces.lock().unwrap_or_else(PoisonError::into_inner);
        pieces.run(job.number(), |world, piece| match piece {
            Some(piece) => own(world, piece),
            None => Err(LinearError::Order { missing: "the rows of this rank" }),
        })
    }

    /// Returns the parts of a vector in the order of the scatter.
    fn to_be_dealt(&self, x: &[f64]) -> Vec<f64> {
        let Inner { dimension, places, needs, numbering, .. } = &*self.0;
        let mut all = vec![0.0; numbering.count() * dimension];
        places.iter().zip(x).for_each(|(place, x)| all[*place as usize] = *x);
        needs.iter().flat_map(|node| &all[*node as usize * dimension..][..*dimension]).copied().collect()
    }

    /// Returns zeros for a gathered vector.
    fn room(&self) -> Vec<f64> {
        vec![0.0; self.0.numbering.count() * self.0.dimension]
    }

    /// Distributes gathered values to the displacements; NaN if the ranks did not answer.
    fn spread(&self, result: &Result<(), LinearError>, all: &[f64], to: &mut [f64]) {
        match result {
            Ok(()) => to.iter_mut().zip(&self.0.places).for_each(|(to, place)| *to = all[*place as usize]),
            Err(_) => to.fill(f64::NAN),
        }
    }

    fn gathered(&self) -> Result<Csc, LinearError> {
        let entries = self.run(Job::Lower, |world, piece| piece.all_lower(world))?;
        let mut dof = vec![0; self.0.numbering.count() * self.0.dimension];
        self.0.places.iter().enumerate().for_each(|(k, place)| dof[*place as usize] = k);
        let entry = |[row, column, value]: &[f64; 3]| {
            let (row, column) = (dof[*row as usize], dof[*column as usize]);
            (row.max(column), row.min(column), *value)
        };
        let entries: Vec<_> = entries.as_chunks().0.iter().map(entry).collect();
        let n = self.displacements();
        Csc::from_triplets(n, n, &entries).map_err(|_| LinearError::NotFinite)
    }
}

fn on(piece: &mut Option<Piece>, job: impl FnOnce(&mut Piece) -> Result<(), LinearError>) -> Result<(), LinearError> {
    piece.as_mut().map_or(Ok(()), job)
}

/// Returns the columns of `rows` at the nodes `near` contact, with both triangles.
fn columns(rows: &Symmetric, body: &dyn NodeRows, near: &[bool]) -> Csc {
    let n = rows.order();
    let mut is_near = vec![false; n];
    for node in (0..body.nodes()).filter(|node| near[*node]) {
        body.places(node).into_iter().flatten().for_each(|dof| is_near[dof] = true);
    }
    let entries = || rows.entries().filter(|(_, column, _)| is_near[*column]);
    let mut columns =
        Csc::zeros(Arc::new(Pattern::of(n, n, |take| entries().for_each(|(row, column, _)| take(row, column)))));
    let (pattern, values) = columns.parts_mut();
    for (row, column, value) in entries() {
        if let Some(slot) = pattern.slot(row, column) {
            values[slot] = value;
        }
    }
    columns
}

impl SharedMatrix for Stiffness {
    fn order(&self) -> usize {
        self.displacements()
    }

    fn owner(&self, node: usize) -> Option<usize> {
        self.0.numbering.owner(node)
    }

    fn mul(&self, x: &[f64], y: &mut [f64]) {
        let (x, mut all) = (self.to_be_dealt(x), self.room());
        let result = self.run(Job::Product, |world, piece| piece.product(world, &x, &mut all));
        self.spread(&result, &all, y);
    }

    fn products(&self, x: &[f64], y: &mut [f64], sizes: &mut [f64]) {
        let (x, mut all, mut all_sizes) = (self.to_be_dealt(x), self.room(), self.room());
        let to = [&mut all[..], &mut all_sizes[..]];
        let result = self.run(Job::Products, |world, piece| piece.products(world, &x, to));
        self.spread(&result, &all, y);
        self.spread(&result, &all_sizes, sizes);
    }

    fn add_beyond(&self, factor: f64, x: &[f64], rest: &[f64], sums: &mut [DoubleDouble]) {
        let (x, rest) = (self.to_be_dealt(x), self.to_be_dealt(rest));
        let (mut high, mut low) = (self.room(), self.room());
        let to = [&mut high[..], &mut low[..]];
        let result = self.run(Job::Beyond, |world, piece| piece.beyond(world, [&x, &rest], to));
        for (sum, place) in sums.iter_mut().zip(&self.0.places) {
            let of = |all: &[f64]| if result.is_ok() { all[*place as usize] } else { f64::NAN };
            sum.add_product(factor, of(&high));
            sum.add(factor * of(&low));
        }
    }

    fn diagonal(&self) -> &[f64] {
        &self.0.diagonal
    }

    fn row_norms(&self) -> &[f64] {
        &self.0.row_norms
    }

    fn near(&self) -> &Csc {
        &self.0.near
    }

    fn get(&self, row: usize, column: usize) -> f64 {
        let place = [row, column].map(|dof| i64::from(self.0.places[dof]));
        self.run(Job::Entry, |world, piece| Ok(piece.entry_at(world, place))).unwrap_or(f64::NAN)
    }

    fn lower(&self) -> Csc {
        let nothing = || {
            let n = self.displacements();
            let mut diagonal = Csc::zeros(Arc::new(Pattern::of(n, n, |take| (0..n).for_each(|i| take(i, i)))));
            diagonal.values_mut().fill(f64::NAN);
            diagonal
        };
        self.0.lower.get_or_init(|| self.gathered().unwrap_or_else(|_| nothing())).clone()
    }
}

/// A hierarchy with parts on all ranks.
pub(super) struct SharedCycle {
    stiffness: Stiffness,
    number: i64,
}

impl SharedCycle {
    /// Applies one cycle: `z` with `K̂ z ≈ r`.
    pub(super) fn cycle(&mut self, r: &[f64], z: &mut [f64]) -> Result<(), LinearError> {
        self.stiffness.run(Job::Cycle(self.number), |world, piece| piece.cycle(world, self.number, r, z))
    }
}

impl Drop for SharedCycle {
    fn drop(&mut self) {
        // If the ranks no longer answer, there is nothing to drop.
        let _ = self.stiffness.run(Job::Drop(self.number), |_, piece| {
            piece.forget(self.number);
            Ok(())
        });
    }
}
