//! A stiffness with rows on all ranks, from the view of rank 0: vectors, and the columns near contact.

use std::sync::Arc;

use stickslip::algebra::linear::{Distributed, LinearError, Stiffness};
use stickslip::algebra::{Csc, DoubleDouble, MatrixError, NodeRows, Symmetric};

use crate::job::{Job, Own, Remote};
use crate::rows::Numbering;

/// The shared stiffness.
#[derive(Debug)]
pub(crate) struct SharedStiffness {
    pub rows: Remote,
    body: Arc<dyn NodeRows>,
    pub numbering: Numbering,
    /// The number of contact nodes.
    pub contacts: usize,
    entries: usize,
    near: Csc,
    diagonal: Vec<f64>,
    row_norms: Vec<f64>,
}

/// Creates the stiffness of `body`, of which each MPI rank assembles the rows of its own nodes. This process keeps a
/// copy of the columns at the nodes `near` contact, which has this number of nodes, `contacts`. Returns `None` if a rank
/// cannot assemble its rows, or has another body.
///
/// # Errors
/// If MPI does not run, or memory is short.
pub(crate) fn share(body: Arc<dyn NodeRows>, near: &[bool], contacts: usize) -> Result<Option<Stiffness>, LinearError> {
    let [mut diagonal, mut row_norms] = [(); 2].map(|()| vec![0.0; body.order()]);
    let (mut numbering, y) = (None, [&mut diagonal[..], &mut row_norms]);
    let own = Own { body: Some(&*body), numbering: Some(&mut numbering), y, ..Own::default() };
    let rows = Remote::new(Job::Rows(contacts * body.dimension()), own)?;
    let Some((numbering, entries)) = numbering else { return Ok(None) };
    let own = body.rows(near).ok_or(LinearError::RankFailed)?;
    let near = columns(&own, &*body, near).map_err(|_| LinearError::PatternChanged)?;
    let shared = SharedStiffness { rows, body, numbering, contacts, entries, near, diagonal, row_norms };
    Ok(Some(Stiffness::Distributed(Arc::new(shared))))
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

impl SharedStiffness {
    fn run(&self, job: Job, x: [&[f64]; 2], y: [&mut [f64]; 2]) -> Result<(), LinearError> {
        self.rows.run(job, Own { x, y, ..Own::default() }).map(drop)
    }
}

impl Distributed for SharedStiffness {
    fn order(&self) -> usize {
        self.diagonal.len()
    }

    fn entries(&self) -> usize {
        self.entries
    }

    fn owner(&self, node: usize) -> Option<usize> {
        self.numbering.owner(node)
    }

    fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    fn row_norms(&self) -> &[f64] {
        &self.row_norms
    }

    fn near(&self) -> &Csc {
        &self.near
    }

    fn mul(&self, x: &[f64], y: &mut [f64]) -> Result<(), LinearError> {
        self.run(Job::Product, [x, &[]], [y, &mut []])
    }

    fn products(&self, x: &[f64], y: &mut [f64], sizes: &mut [f64]) -> Result<(), LinearError> {
        self.run(Job::Sums(false), [x, &[]], [y, sizes])
    }

    fn add_beyond(&self, factor: f64, x: &[f64], rest: &[f64], sums: &mut [DoubleDouble]) -> Result<(), LinearError> {
        let (mut high, mut low) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        self.run(Job::Sums(true), [x, rest], [&mut high, &mut low])?;
        for (sum, (high, low)) in sums.iter_mut().zip(high.into_iter().zip(low)) {
            sum.add_product(factor, high);
            sum.add(factor * low);
        }
        Ok(())
    }

    fn gathered(&self) -> Result<Symmetric, LinearError> {
        self.body.rows(&vec![true; self.body.nodes()]).ok_or(LinearError::RankFailed)
    }
}
