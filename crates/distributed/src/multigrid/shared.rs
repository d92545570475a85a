//! A stiffness with rows on all ranks, from the view of rank 0: vectors, and the columns near contact.

use std::fmt;
use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use super::numbering::Numbering;
use super::piece::{Job, Piece, State};
use crate::ranks::{self, Kind, Shared, World};
use stickslip::algebra::linear::{Distributed, LinearError, Stiffness};
use stickslip::algebra::{Csc, DoubleDouble, MatrixError, NodeRows, Symmetric};

/// Creates the stiffness of `body`, of which each MPI rank assembles the rows of its own nodes. This process keeps a
/// copy of the columns at the nodes `near` contact. Returns `None` if a rank cannot assemble its rows, or has another
/// body.
///
/// # Errors
/// If MPI does not run, or memory is short.
pub fn share(body: &dyn NodeRows, near: &[bool]) -> Result<Option<Stiffness>, LinearError> {
    Ok(SharedStiffness::new(body, near)?.map(|shared| Stiffness::Distributed(Arc::new(shared))))
}

/// The shared stiffness; clones share it.
#[derive(Clone)]
pub(super) struct SharedStiffness(Arc<Inner>);

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
}

impl fmt::Debug for SharedStiffness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SharedStiffness").field("order", &self.0.places.len()).field("ranks", &self.bounds()).finish()
    }
}

impl SharedStiffness {
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
        let Some(Ok(near)) = body.rows(near).map(|rows| columns(&rows, body, near)) else { return Ok(None) };
        Ok(Some(SharedStiffness(Arc::new(Inner {
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
        }))))
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

    /// Distributes gathered values to the displacements.
    fn spread(&self, all: &[f64], to: &mut [f64]) {
        to.iter_mut().zip(&self.0.places).for_each(|(to, place)| *to = all[*place as usize]);
    }
}

fn on(piece: &mut Option<Piece>, job: impl FnOnce(&mut Piece) -> Result<(), LinearError>) -> Result<(), LinearError> {
    piece.as_mut().map_or(Ok(()), job)
}

/// Returns the columns of `rows` at the nodes `near` contact, with both triangles.
fn columns(rows: &Symmetric, body: &dyn NodeRows, near: &[bool]) -> Result<Csc, MatrixError> {
    let n = rows.order();
    let mut is_near = vec![false; n];
    for node in (0..body.nodes()).filter(|node| near[*node]) {
        body.places(node).into_iter().flatten().for_each(|dof| is_near[dof] = true);
    }
    let entries = || rows.entries().filter(|(_, column, _)| is_near[*column]);
    Csc::from_triplets(n, n, &entries().collect::<Vec<_>>())
}

impl Distributed for SharedStiffness {
    fn order(&self) -> usize {
        self.0.places.len()
    }

    fn entries(&self) -> usize {
        self.0.entries
    }

    fn owner(&self, node: usize) -> Option<usize> {
        self.0.numbering.owner(node)
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

    fn mul(&self, x: &[f64], y: &mut [f64]) -> Result<(), LinearError> {
        let (x, mut all) = (self.to_be_dealt(x), self.room());
        self.run(Job::Product, |world, piece| piece.product(world, &x, &mut all))?;
        self.spread(&all, y);
        Ok(())
    }

    fn products(&self, x: &[f64], y: &mut [f64], sizes: &mut [f64]) -> Result<(), LinearError> {
        let (x, mut all, mut all_sizes) = (self.to_be_dealt(x), self.room(), self.room());
        self.run(Job::Products, |world, piece| piece.products(world, &x, [&mut all, &mut all_sizes]))?;
        self.spread(&all, y);
        self.spread(&all_sizes, sizes);
        Ok(())
    }

    fn add_beyond(&self, factor: f64, x: &[f64], rest: &[f64], sums: &mut [DoubleDouble]) -> Result<(), LinearError> {
        let (x, rest) = (self.to_be_dealt(x), self.to_be_dealt(rest));
        let (mut high, mut low) = (self.room(), self.room());
        self.run(Job::Beyond, |world, piece| piece.beyond(world, [&x, &rest], [&mut high, &mut low]))?;
        for (sum, place) in sums.iter_mut().zip(&self.0.places) {
            sum.add_product(factor, high[*place as usize]);
            sum.add(factor * low[*place as usize]);
        }
        Ok(())
    }

    fn gathered(&self) -> Result<Symmetric, LinearError> {
        let entries = self.run(Job::Lower, |world, piece| piece.all_lower(world))?;
        let mut dof = vec![0; self.0.numbering.count() * self.0.dimension];
        self.0.places.iter().enumerate().for_each(|(k, place)| dof[*place as usize] = k);
        let entry = |[row, column, value]: &[f64; 3]| {
            let (row, column) = (dof[*row as usize], dof[*column as usize]);
            (row.max(column), row.min(column), *value)
        };
        let entries: Vec<_> = entries.as_chunks().0.iter().map(entry).collect();
        Symmetric::from_triplets(self.order(), &entries).map_err(|_| LinearError::NotFinite)
    }
}

/// A hierarchy with parts on all ranks.
pub(super) struct SharedCycle {
    stiffness: SharedStiffness,
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
