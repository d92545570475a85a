//! The uncondensed system with its interior factored once a run.
//!
//! Let `c` be the displacements on which contact acts (in the code: the border), `r` the interior, and `q` all other unknowns.
//! The matrices of a run are
//!
//! ```text
//! [ K_rr K_rc  0 ] [u_r]   [b_r]
//! [ K_cr K_cc' B ] [u_c] = [b_c]
//! [  0    A    D ] [ q ]   [b_q]
//! ```
//!
//! with `K_cc' = K_cc + pins`. Between two iterations only the rows and columns of `q` change, and the pins, which are on the
//! diagonal. A Cholesky factorisation of `K` with `c` last eliminates the interior once; it contains the Schur complement `S`. With
//! `S' = S + pins`, each iteration factors
//!
//! ```text
//! [ S' B ]
//! [ A  D ]
//! ```
//!
//! which has the form of the matrix of a condensed body. Unknowns, right-hand sides and residuals are those of the whole system.

use std::ops::Range;
use std::sync::Arc;

use faer::Mat;

use super::{
    Cholesky, Computed, Dense, FactorInfo, LinearError, LinearSolver, Lu, SparseCholesky, SystemMatrix, expect_length,
};
use crate::algebra::sparse::{Csc, DenseSymmetric, Pattern, Symmetric};

/// If a group of coupled contact unknowns is larger than this, the contact block is factored as one dense matrix: eliminating the
/// group first costs a multiple of the cube of its size.
const LARGE_GROUP: usize = 64;

/// A direct solver that factors the interior of the body once a run, and contact in each iteration. The matrix must state the
/// number of its displacements, see [`SystemMatrix::with_displacements`].
#[derive(Default)]
pub struct Partial {
    cholesky: SparseCholesky,
    shape: Option<Shape>,
    interior: Option<Interior>,
    stiffness_factorizations: usize,
}

/// The places of the blocks in the matrix.
struct Shape {
    pattern: Arc<Pattern>,
    displacements: usize,
    /// The displacements on which contact acts, ascending.
    border: Vec<usize>,
    /// The slots of `K` without the diagonal of the border, ascending. They are constant.
    constant: Vec<Range<usize>>,
    /// The pattern of contact, on the border and the other unknowns: the entries outside `K`, and the diagonal of the border.
    contact: Arc<Pattern>,
    /// The slot of each entry of contact, and `true` if the entry is in `K`.
    slots: Vec<(usize, bool)>,
}

/// The factors of the interior, and the matrix that is left.
struct Interior {
    /// The values of the matrix from which `K` was taken.
    values: Vec<f64>,
    factor: Cholesky,
    /// `S`, the rows and columns of contact, and the changes of the diagonal of the border.
    contact: SystemMatrix,
    trailing: Trailing,
}

/// The solver for contact.
enum Trailing {
    /// Contact nodes are eliminated one by one.
    ByNodes(Box<Dense>),
    /// Contact rows couple many nodes.
    Coupled(Option<Lu>),
}

impl From<SparseCholesky> for Partial {
    /// Creates a solver that factors the interior with `cholesky`.
    fn from(cholesky: SparseCholesky) -> Self {
        Partial { cholesky, ..Partial::default() }
    }
}

impl Partial {
    /// Returns the number of factorisations of the stiffness so far: one, unless its values or the contact nodes have changed.
    pub fn stiffness_factorizations(&self) -> usize {
        self.stiffness_factorizations
    }
}

impl LinearSolver for Partial {
    fn name(&self) -> &'static str {
        "partial"
    }

    /// # Errors
    /// [`LinearError::UnknownDisplacements`]: a pattern alone does not tell which unknowns are displacements.
    fn analyze(&mut self, _pattern: &Arc<Pattern>) -> Computed<()> {
        (self.shape, self.interior) = (None, None);
        Err(LinearError::UnknownDisplacements)
    }

    fn factorize(&mut self, values: &[f64]) -> Computed<FactorInfo> {
        let shape = self.shape.as_ref().ok_or(LinearError::Order { missing: "analyze" })?;
        expect_length("values of the matrix", shape.pattern.len(), values.len())?;
        let known = self.interior.take().filter(|interior| shape.has_stiffness_of(values, &interior.values));
        let is_known = known.is_some();
        let interior = if let Some(interior) = known {
            interior
        } else {
            self.stiffness_factorizations += 1;
            Interior::new(shape, self.cholesky, values)?
        };
        let interior = self.interior.insert(interior);
        let contact = interior.factorize_contact(shape, values)?;
        let body = interior.factor.info();
        Ok(FactorInfo {
            entries: body.entries + contact.entries,
            flops: contact.flops + if is_known { 0.0 } else { body.flops },
            pivot_ratio: contact.pivot_ratio,
            peak_bytes: body.peak_bytes + contact.peak_bytes,
        })
    }

    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Computed<()> {
        let (Some(shape), Some(interior)) = (&self.shape, &mut self.interior) else {
            return Err(LinearError::Order { missing: "factorize" });
        };
        expect_length("right-hand side", shape.pattern.columns(), b.len())?;
        expect_length("solution", shape.pattern.columns(), x.len())?;
        let (n_u, m) = (shape.displacements, shape.border.len());
        let reduced = interior.factor.reduce(&b[..n_u])?;
        let given = [&reduced.border[..], &b[n_u..]].concat();
        let found = interior.trailing.solve(&given)?;
        interior.factor.expand(&reduced, &found[..m], &mut x[..n_u])?;
        x[n_u..].copy_from_slice(&found[m..]);
        Ok(())
    }

    fn analyze_system(&mut self, a: &SystemMatrix) -> Computed<()> {
        (self.shape, self.interior) = (None, None);
        let displacements = a.displacements().ok_or(LinearError::UnknownDisplacements)?;
        self.shape = Some(Shape::new(a.to_csc()?.pattern(), displacements)?);
        Ok(())
    }

    fn factorize_system(&mut self, a: &SystemMatrix) -> Computed<FactorInfo> {
        let whole = a.to_csc()?;
        let shape = self.shape.as_ref().ok_or(LinearError::Order { missing: "analyze" })?;
        let same = Arc::ptr_eq(&shape.pattern, whole.pattern()) || shape.pattern == *whole.pattern();
        if !same || a.displacements() != Some(shape.displacements) {
            return Err(LinearError::PatternChanged);
        }
        self.factorize(whole.values())
    }
}

impl Shape {
    /// Finds the blocks of a matrix with this number of displacements.
    ///
    /// # Errors
    /// If the pattern is not square.
    fn new(pattern: &Arc<Pattern>, displacements: usize) -> Computed<Self> {
        let n = pattern.columns();
        expect_length("rows of the matrix", n, pattern.rows())?;
        let rows = |j: usize| pattern.column(j).map(move |slot| (pattern.row_indices()[slot] as usize, slot));
        let mut is_border = vec![false; n];
        for j in 0..n {
            for (i, _) in rows(j).filter(|(i, _)| (*i < displacements) != (j < displacements)) {
                is_border[i.min(j)] = true;
            }
        }
        let border: Vec<usize> = (0..displacements).filter(|&k| is_border[k]).collect();
        // The places of the unknowns in the matrix of contact.
        let mut place = vec![None; n];
        border.iter().copied().chain(displacements..n).enumerate().for_each(|(k, unknown)| place[unknown] = Some(k));
        let mut constant = Vec::<Range<usize>>::new();
        let (mut entries, mut slots) = (Vec::new(), Vec::new());
        for j in 0..n {
            for (i, slot) in rows(j) {
                let is_stiffness = i.max(j) < displacements;
                match (place[i], place[j]) {
                    (Some(row), Some(column)) if !is_stiffness || i == j => {
                        entries.push((row, column));
                        slots.push((slot, is_stiffness));
                    }
                    _ => match constant.last_mut() {
                        Some(last) if last.end == slot => last.end += 1,
                        _ => constant.push(slot..slot + 1),
                    },
                }
            }
        }
        let order = border.len() + n - displacements;
        // Places are ascending, so that the entries are in the order of the pattern.
        let contact = Pattern::of(order, order, |take| entries.iter().for_each(|&(row, column)| take(row, column)));
        Ok(Shape { pattern: Arc::clone(pattern), displacements, border, constant, contact: Arc::new(contact), slots })
    }

    /// Returns `true` if `values` have the stiffness of `known`, apart from the diagonal of the border.
    fn has_stiffness_of(&self, values: &[f64], known: &[f64]) -> bool {
        self.constant.iter().all(|slots| values[slots.clone()] == known[slots.clone()])
    }

    /// Returns the stiffness in `values`, from its lower triangle.
    fn stiffness(&self, values: &[f64]) -> Symmetric {
        let n_u = self.displacements;
        let lower = || {
            (0..n_u).flat_map(|j| {
                let rows = self.pattern.column(j).map(|slot| (self.pattern.row_indices()[slot] as usize, slot));
                rows.filter(move |(i, _)| (j..n_u).contains(i)).map(move |(i, slot)| (i, j, values[slot]))
            })
        };
        let pattern = Pattern::of(n_u, n_u, |take| lower().for_each(|(i, j, _)| take(i, j)));
        let mut stiffness = Csc::zeros(Arc::new(pattern));
        stiffness.values_mut().iter_mut().zip(lower()).for_each(|(to, (.., value))| *to = value);
        Symmetric::of_lower(stiffness)
    }
}

impl Interior {
    fn new(shape: &Shape, cholesky: SparseCholesky, values: &[f64]) -> Computed<Self> {
        let (factor, shift) = cholesky.factor_held(&shape.stiffness(values), &shape.border)?;
        let s = DenseSymmetric::of_lower(shape.border.len(), factor.schur_complement(&shift)?);
        let contact = SystemMatrix::new(s, Csc::zeros(Arc::clone(&shape.contact)))?;
        let mut dense = Dense::default();
        dense.analyze_system(&contact)?;
        let trailing = match dense.largest_group() {
            0..=LARGE_GROUP => Trailing::ByNodes(Box::new(dense)),
            _ => Trailing::Coupled(None),
        };
        Ok(Interior { values: values.to_vec(), factor, contact, trailing })
    }

    /// Factors what is left of the matrix with `values`.
    fn factorize_contact(&mut self, shape: &Shape, values: &[f64]) -> Computed<FactorInfo> {
        for (to, &(slot, is_stiffness)) in self.contact.rest_mut().values_mut().iter_mut().zip(&shape.slots) {
            *to = values[slot] - if is_stiffness { self.values[slot] } else { 0.0 };
        }
        self.trailing.factorize(&self.contact)
    }
}

impl Trailing {
    fn factorize(&mut self, a: &SystemMatrix) -> Computed<FactorInfo> {
        let factors = match self {
            Trailing::ByNodes(dense) => return dense.factorize_system(a),
            Trailing::Coupled(factors) => factors,
        };
        *factors = None;
        let n = a.order();
        let mut matrix = Mat::zeros(n, n);
        let entries = a.leading().into_iter().flat_map(DenseSymmetric::entries).chain(a.rest().entries());
        entries.for_each(|(row, column, value)| matrix[(row, column)] += value);
        let size = |column: &[f64]| column.iter().fold(0.0_f64, |m, value| m.max(value.abs()));
        let sizes: Vec<f64> = (0..n).map(|j| size(matrix.col_as_slice(j))).collect();
        let lu = factors.insert(Lu::new(matrix, &sizes)?);
        Ok(FactorInfo {
            entries: n * n,
            flops: 2.0 / 3.0 * (n as f64).powi(3),
            pivot_ratio: lu.pivot_ratio(),
            peak_bytes: 8.0 * (n * n) as f64,
        })
    }

    fn solve(&mut self, b: &[f64]) -> Computed<Vec<f64>> {
        match self {
            Trailing::ByNodes(dense) => {
                let mut x = vec![0.0; b.len()];
                dense.solve(b, &mut x)?;
                Ok(x)
            }
            Trailing::Coupled(factors) => {
                factors.as_ref().ok_or(LinearError::Order { missing: "factorize" })?.solution(b)
            }
        }
    }
}
