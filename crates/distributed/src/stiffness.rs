//! A stiffness with rows on all ranks, from the view of rank 0: vectors, and the columns near contact.

use std::fmt;
use std::sync::Arc;

use stickslip::algebra::linear::{Distributed, LinearError, Stiffness};
use stickslip::algebra::{Csc, DoubleDouble, MatrixError, NodeRows, Symmetric};

use crate::job::{Job, Own, Product, Remote};
use crate::ranks;
use crate::rows::Numbering;

/// Creates the stiffness of `body`, of which each MPI rank assembles the rows of its own nodes. This process keeps a
/// copy of the columns at the nodes `near` contact. Returns `None` if a rank cannot assemble its rows, or has another
/// body.
///
/// # Errors
/// If MPI does not run, or memory is short.
pub(crate) fn share(body: &dyn NodeRows, near: &[bool]) -> Result<Option<Stiffness>, LinearError> {
    Ok(SharedStiffness::new(body, near)?.map(|shared| Stiffness::Distributed(Arc::new(shared))))
}

/// The shared stiffness; clones share it.
#[derive(Clone)]
pub(crate) struct SharedStiffness(Arc<Inner>);

struct Inner {
    rows: Remote,
    numbering: Arc<Numbering>,
    entries: usize,
    /// The displacement in each row of the whole; those of missing directions are of no displacement.
    displacements: Vec<usize>,
    near: Csc,
    diagonal: Vec<f64>,
    row_norms: Vec<f64>,
}

impl fmt::Debug for SharedStiffness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SharedStiffness").field("order", &self.0.diagonal.len()).finish_non_exhaustive()
    }
}

impl SharedStiffness {
    fn new(body: &dyn NodeRows, near: &[bool]) -> Result<Option<Self>, LinearError> {
        let rows = Remote::new(Job::Rows, Own { body: Some(body), ..Own::default() })?;
        let Some(numbering) = ranks::numbering(rows.0) else { return Ok(None) };
        let d = body.dimension();
        let mut displacements = vec![usize::MAX; numbering.bounds.last().map_or(0, |nodes| nodes * d)];
        for (node, number) in (0..body.nodes()).filter_map(|node| Some((node, numbering.number(node)?))) {
            for (direction, dof) in body.places(node).into_iter().enumerate() {
                if let Some(dof) = dof {
                    displacements[number * d + direction] = dof;
                }
            }
        }
        let [mut diagonal, mut row_norms] = [(); 2].map(|()| vec![0.0; body.order()]);
        let reply = rows.run(Job::Norms, Own { y: [&mut diagonal, &mut row_norms], ..Own::default() })?;
        let entries = reply.iter().sum::<f64>() as usize;
        let Some(Ok(near)) = body.rows(near).map(|rows| columns(&rows, body, near)) else { return Ok(None) };
        Ok(Some(SharedStiffness(Arc::new(Inner {
            rows,
            numbering,
            entries,
            displacements,
            near,
            diagonal,
            row_norms,
        }))))
    }

    /// Returns its number on all ranks.
    pub(crate) fn number(&self) -> i64 {
        self.0.rows.0
    }

    /// Returns the numbers of the nodes, and the ranges of the ranks.
    pub(crate) fn numbering(&self) -> &Arc<Numbering> {
        &self.0.numbering
    }

    fn product(&self, product: Product, x: [&[f64]; 2], y: [&mut [f64]; 2]) -> Result<(), LinearError> {
        self.0.rows.run(Job::Product(product), Own { x, y, ..Own::default() }).map(drop)
    }
}

/// Returns the columns of `rows` at the nodes `near` contact, with both triangles.
fn columns(rows: &Symmetric, body: &dyn NodeRows, near: &[bool]) -> Result<Csc, MatrixError> {
    let n = rows.order();
    let mut is_near = vec![false; n];
    for node in (0..body.nodes()).filter(|node| near[*node]) {
        body.places(node).into_iter().flatten().for_each(|dof| is_near[dof] = true);
    }
    let entries = rows.entries().filter(|(_, column, _)| is_near[*column]);
    Csc::from_triplets(n, n, &entries.collect::<Vec<_>>())
}

impl Distributed for SharedStiffness {
    fn order(&self) -> usize {
        self.0.diagonal.len()
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
        self.product(Product::Plain, [x, &[]], [y, &mut []])
    }

    fn products(&self, x: &[f64], y: &mut [f64], sizes: &mut [f64]) -> Result<(), LinearError> {
        self.product(Product::Sizes, [x, &[]], [y, sizes])
    }

    fn add_beyond(&self, factor: f64, x: &[f64], rest: &[f64], sums: &mut [DoubleDouble]) -> Result<(), LinearError> {
        let (mut high, mut low) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        self.product(Product::Beyond, [x, rest], [&mut high, &mut low])?;
        for (sum, (high, low)) in sums.iter_mut().zip(high.into_iter().zip(low)) {
            sum.add_product(factor, high);
            sum.add(factor * low);
        }
        Ok(())
    }

    fn gathered(&self) -> Result<Symmetric, LinearError> {
        let reply = self.0.rows.run(Job::Lower, Own::default())?;
        let dof = &self.0.displacements;
        let entry = |[row, column, value]: &[f64; 3]| {
            let (row, column) = (dof[*row as usize], dof[*column as usize]);
            // Directions that supports have removed are no displacements.
            (row.max(column) < self.order()).then_some((row.max(column), row.min(column), *value))
        };
        let entries: Vec<_> = reply.as_chunks().0.iter().filter_map(entry).collect();
        Symmetric::from_triplets(self.order(), &entries).map_err(|_| LinearError::NotFinite)
    }
}
