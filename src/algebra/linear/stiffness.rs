//! The stiffness of a body: assembled in this process, or distributed over several.

use std::any::Any;
use std::borrow::Cow;
use std::fmt;
use std::sync::Arc;

use super::Computed;
use crate::algebra::sparse::{Csc, DoubleDouble, Symmetric};

/// The stiffness of a body.
#[derive(Debug, Clone)]
pub enum Stiffness {
    /// All entries are in this process.
    Assembled(Arc<Symmetric>),
    /// Several processes have the rows.
    Distributed(Arc<dyn Distributed>),
}

/// A stiffness whose rows several processes have, by nodes. This process knows few of the entries. All processes take
/// part in products, which fail if one of them has failed.
pub trait Distributed: Any + fmt::Debug + Send + Sync {
    /// Returns the order.
    fn order(&self) -> usize;

    /// Returns the number of entries in both triangles, with those that are 0 because of supports.
    fn entries(&self) -> usize;

    /// Returns the process that has the rows of this mesh node, from 0, or `None` if the node has no rows.
    fn owner(&self, node: usize) -> Option<usize>;

    /// Returns the diagonal.
    fn diagonal(&self) -> &[f64];

    /// Returns the largest absolute value in each row.
    fn row_norms(&self) -> &[f64];

    /// Returns the columns at the nodes near contact, with both triangles; all others are empty.
    fn near(&self) -> &Csc;

    /// Computes `y = K x`.
    ///
    /// # Errors
    /// [`super::LinearError`] if a process has failed, here and below.
    fn mul(&self, x: &[f64], y: &mut [f64]) -> Computed<()>;

    /// Computes `y = K x` and `sizes = |K| |x|`.
    ///
    /// # Errors
    /// As [`Distributed::mul`].
    fn products(&self, x: &[f64], y: &mut [f64], sizes: &mut [f64]) -> Computed<()>;

    /// Adds `factor K (x + rest)` to `sums`, in twice the working precision.
    ///
    /// # Errors
    /// As [`Distributed::mul`].
    fn add_beyond(&self, factor: f64, x: &[f64], rest: &[f64], sums: &mut [DoubleDouble]) -> Computed<()>;

    /// Gathers all entries in this process, which should be avoided.
    ///
    /// # Errors
    /// As [`Distributed::mul`].
    fn gathered(&self) -> Computed<Symmetric>;
}

impl From<Symmetric> for Stiffness {
    fn from(assembled: Symmetric) -> Self {
        Stiffness::Assembled(Arc::new(assembled))
    }
}

impl Stiffness {
    /// Returns the order.
    pub fn order(&self) -> usize {
        match self {
            Stiffness::Assembled(k) => k.order(),
            Stiffness::Distributed(k) => k.order(),
        }
    }

    /// Returns the number of entries on and below the diagonal.
    pub(crate) fn lower_entries(&self) -> usize {
        match self {
            Stiffness::Assembled(k) => k.lower().values().len(),
            Stiffness::Distributed(k) => usize::midpoint(k.entries(), k.order()),
        }
    }

    /// Returns the diagonal.
    pub fn diagonal(&self) -> Vec<f64> {
        match self {
            Stiffness::Assembled(k) => k.diagonal(),
            Stiffness::Distributed(k) => k.diagonal().to_vec(),
        }
    }

    /// Returns the stiffness with all entries in this process. They are gathered if several processes have them.
    ///
    /// # Errors
    /// [`super::LinearError`] if a process has failed.
    pub fn assembled(&self) -> Computed<Arc<Symmetric>> {
        match self {
            Stiffness::Assembled(k) => Ok(Arc::clone(k)),
            Stiffness::Distributed(k) => k.gathered().map(Arc::new),
        }
    }

    /// Returns the stiffness if its entries are in compressed columns: assembled, and not dense.
    pub(crate) fn compressed(&self) -> Option<&Symmetric> {
        match self {
            Stiffness::Assembled(k) if k.dense().is_none() => Some(k),
            Stiffness::Assembled(_) | Stiffness::Distributed(_) => None,
        }
    }

    /// Returns the distributed stiffness, if it is one.
    pub fn distributed(&self) -> Option<&dyn Distributed> {
        match self {
            Stiffness::Assembled(_) => None,
            Stiffness::Distributed(k) => Some(&**k),
        }
    }

    /// Returns the entries in this process: the lower triangle, or the columns near contact with both triangles.
    pub(crate) fn at_hand(&self) -> Cow<'_, Csc> {
        match self {
            Stiffness::Assembled(k) => k.lower(),
            Stiffness::Distributed(k) => Cow::Borrowed(k.near()),
        }
    }

    /// Computes `y = K x`.
    pub(crate) fn mul(&self, x: &[f64], y: &mut [f64]) -> Computed<()> {
        match self {
            Stiffness::Assembled(k) => {
                k.mul(x, y);
                Ok(())
            }
            Stiffness::Distributed(k) => k.mul(x, y),
        }
    }

    /// Computes `|K| |x|`.
    pub(crate) fn sizes(&self, x: &[f64]) -> Computed<Vec<f64>> {
        let mut sizes = vec![0.0; x.len()];
        match self {
            Stiffness::Assembled(k) => k.add_sizes(x, &mut sizes),
            Stiffness::Distributed(k) => k.products(x, &mut vec![0.0; x.len()], &mut sizes)?,
        }
        Ok(sizes)
    }

    /// Adds `K (x + rest)` to `sums`, in twice the working precision.
    pub(crate) fn add_beyond(&self, x: &[f64], rest: &[f64], sums: &mut [DoubleDouble]) -> Computed<()> {
        match self {
            Stiffness::Assembled(k) => {
                for (row, column, value) in k.entries() {
                    sums[row].add_product(value, x[column]);
                    sums[row].add(value * rest[column]);
                }
                Ok(())
            }
            Stiffness::Distributed(k) => k.add_beyond(1.0, x, rest, sums),
        }
    }
}
