//! The stiffness of a contact node against a force on it: the scale of `r`.

use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, Side};

use super::ContactProblem;
use crate::algebra::sparse::{Csc, Csr};
use crate::algebra::vector::median;

/// The displacements that share a stiffness entry with the normal motion of a contact node, ascending; with finite
/// elements, those of the adjacent elements.
type Patch = Vec<usize>;

/// A patch stiffness below this share of a node's own stiffness may be rounding of a patch that rotates about clamped
/// displacements. True contrasts of twelve decades cannot be distinguished from that.
const STIFFNESS_ROUNDING: f64 = 1e-12;

impl ContactProblem {
    /// Returns the stiffness of each contact node along its normal, with all other displacements of its patch free
    /// and everything beyond clamped, n_c, N/m: `1 / (C_n K_PP⁻¹ C_nᵀ)_ii` with `K_PP` the rows and columns of the
    /// displacements that the node's own are coupled to.
    ///
    /// It approximates `1 / C_nn`, the inverse of the compliance `C_n K⁻¹ C_nᵀ`, without far-field effects such as
    /// bending of a slender body, or a stiffness against volume change that does not act on surface nodes. If the
    /// patch could move as a rigid body, it is a quarter of the node's own `c K cᵀ / (c cᵀ)²`, which is about the same
    /// in a uniform mesh.
    pub fn contact_stiffness(&self) -> &[f64] {
        &self.natural().contact_stiffness
    }

    /// Returns `c K cᵀ / (c cᵀ)²`, N/m, of row `i` of `C_n`: the stiffness of the contact node along its normal with all
    /// other displacements clamped.
    pub(crate) fn own_stiffness(&self, i: usize) -> f64 {
        own_stiffness(&self.stiffness().at_hand(), self.c_n(), i)
    }

    /// Factors `K_PP`. Returns `None` if the patch is the whole body and nothing stops it, or if it is singular.
    fn factors(&self, at_hand: &Csc, patch: &Patch) -> Option<Llt<f64>> {
        if patch.len() == self.displacements() && !self.rigid_modes.is_empty() {
            return None;
        }
        let (pattern, values) = (at_hand.pattern(), at_hand.values());
        let mut matrix = Mat::zeros(patch.len(), patch.len());
        for (j, &column) in patch.iter().enumerate() {
            for slot in pattern.column(column) {
                if let Ok(i) = patch.binary_search(&(pattern.row_indices()[slot] as usize)) {
                    matrix[(i, j)] = values[slot];
                }
            }
        }
        matrix.llt(Side::Lower).ok()
    }
}

/// Computes [`ContactProblem::contact_stiffness`].
pub(super) fn contact_stiffness(problem: &ContactProblem) -> Vec<f64> {
    // The entries of a distributed stiffness in this process cover the patches.
    let at_hand = problem.stiffness().at_hand();
    let patches = patches(&at_hand, problem.c_n());
    let mut last: Option<(&Patch, Option<Llt<f64>>)> = None;
    let mut stiffness = Vec::with_capacity(patches.len());
    for (i, patch) in patches.iter().enumerate() {
        // In a dense matrix all patches are the same.
        let factors = match last.take() {
            Some((same, factors)) if same == patch => factors,
            _ => problem.factors(&at_hand, patch),
        };
        let compliance = factors.as_ref().map(|factors| compliance(factors, patch, problem.c_n().row(i)));
        let own = own_stiffness(&at_hand, problem.c_n(), i);
        let usable = compliance.map(|c| 1.0 / c).filter(|k| k.is_finite() && *k > STIFFNESS_ROUNDING * own);
        stiffness.push(usable.unwrap_or(0.25 * own));
        last = Some((patch, factors));
    }
    // A node without stiffness of its own gets a typical value of the body; any scale will do.
    if stiffness.contains(&0.0) {
        let mut present: Vec<f64> = problem.stiffness().diagonal().into_iter().filter(|k| *k > 0.0).collect();
        let typical = median(&mut present).unwrap_or(1.0);
        stiffness.iter_mut().filter(|k| **k == 0.0).for_each(|k| *k = typical);
    }
    stiffness
}

/// Returns `c K cᵀ / (c cᵀ)²` of row `i` of `C_n` from the entries in this process, which contain the lower triangle at contact nodes.
fn own_stiffness(at_hand: &Csc, c_n: &Csr, i: usize) -> f64 {
    let entry =
        |a: usize, b: usize| at_hand.pattern().slot(a.max(b), a.min(b)).map_or(0.0, |slot| at_hand.values()[slot]);
    let row = c_n.row(i);
    let pairs = row.iter().flat_map(|a| row.iter().map(move |b| (a, b)));
    let square: f64 = row.iter().map(|(_, c)| c * c).sum();
    if square == 0.0 { 0.0 } else { pairs.map(|(a, b)| a.1 * b.1 * entry(a.0, b.0)).sum::<f64>() / square.powi(2) }
}

/// Returns `c K_PP⁻¹ cᵀ` of a row `c` of `C_n`.
fn compliance(factors: &Llt<f64>, patch: &Patch, row: &[(usize, f64)]) -> f64 {
    let mut force = Mat::zeros(patch.len(), 1);
    let place = |dof: usize| patch.binary_search(&dof);
    for &(dof, c) in row {
        if let Ok(k) = place(dof) {
            force[(k, 0)] = c;
        }
    }
    let moved = factors.solve(&force);
    row.iter().map(|&(dof, c)| place(dof).map_or(0.0, |k| c * moved[(k, 0)])).sum()
}

/// Returns the patch of each contact node.
fn patches(at_hand: &Csc, c_n: &Csr) -> Vec<Patch> {
    let mut nodes_of = vec![Vec::new(); c_n.columns()];
    for i in 0..c_n.rows() {
        c_n.row(i).iter().for_each(|&(dof, _)| nodes_of[dof].push(i));
    }
    let mut patches = vec![Patch::new(); c_n.rows()];
    for (row, column, _) in at_hand.entries() {
        nodes_of[row].iter().for_each(|&i| patches[i].push(column));
        nodes_of[column].iter().for_each(|&i| patches[i].push(row));
    }
    for patch in &mut patches {
        patch.sort_unstable();
        patch.dedup();
    }
    patches
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::sparse::Symmetric;
    use crate::solver::problem::Parts;

    /// Creates `n` points in a row with unit springs between them, the last one on a wall by another if it is `held`;
    /// every point is a contact node.
    fn chain(n: usize, held: bool) -> ContactProblem {
        let held_end = (n - 1, n - 1, f64::from(u8::from(held)));
        let springs = (1..n).flat_map(|i| [(i - 1, i - 1, 1.0), (i, i, 1.0), (i, i - 1, -1.0)]);
        let stiffness = Symmetric::from_triplets(n, &springs.chain([held_end]).collect::<Vec<_>>()).unwrap();
        let c_n = Csr::of_rows(n, (0..n).map(|i| [(i, -1.0)]));
        let none = Csr::empty(n, n).unwrap();
        ContactProblem::new(Parts {
            stiffness: stiffness.into(),
            c_n,
            c_t: none.clone(),
            c_o: none,
            mu: vec![0.0; n],
            weight: Some(vec![1.0; n]),
            rigid_modes: Some(if held { Vec::new() } else { vec![vec![1.0; n]] }),
        })
        .unwrap()
    }

    fn assert_close(found: &[f64], expected: &[f64]) {
        assert_eq!(found.len(), expected.len());
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?}");
    }

    /// There are two springs in a row on either side; those to the free end carry nothing.
    #[test]
    fn what_is_beyond_the_neighbours_is_held() {
        assert_close(chain(6, true).contact_stiffness(), &[0.5, 0.5, 1.0, 1.0, 1.0, 1.5]);
    }

    /// The middle point has no points beyond its neighbours.
    #[test]
    fn a_patch_that_moves_as_a_rigid_body() {
        assert_close(chain(3, false).contact_stiffness(), &[0.5, 0.25 * 2.0, 0.5]);
    }

    #[test]
    fn in_a_dense_matrix_it_is_the_inverse_of_the_compliance() {
        // K = 1 + e eᵀ, K⁻¹ = 1 - e eᵀ / (n + 1).
        let n = 5;
        let entry = |i: usize, j: usize| (i, j, if i == j { 2.0 } else { 1.0 });
        let entries: Vec<_> = (0..n).flat_map(|i| (0..=i).map(move |j| entry(i, j))).collect();
        let stiffness = Symmetric::from_triplets(n, &entries).unwrap();
        let problem =
            ContactProblem::new(Parts { stiffness: stiffness.into(), ..chain(n, true).into_parts() }).unwrap();
        assert_close(problem.contact_stiffness(), &[1.2; 5]);
    }
}
