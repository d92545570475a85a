//! The biorthogonal basis on the covered part of a slave facet, and the contribution of the facet to the rows of its
//! nodes.

use std::collections::BTreeSet;

use super::cover::Cover;
use super::facet::{MOST, Values};
use crate::body::mesh::Mesh;

/// A sum counts as rounding if it is at most this share of its terms.
const CANCELLED_SHARE: f64 = 1e-13;

/// A pivot below this counts as rounding; the diagonal is scaled to 1.
const SINGULAR: f64 = 1e-15;

/// The contribution of a facet to the row of one of its nodes.
pub(super) struct FacetShare {
    pub node: usize,
    /// `∫ ψ_j dA`, m or m².
    pub weight: f64,
    /// `∫ ψ_j Ñ_i dA` for nodes of the facet.
    pub slave: Vec<(usize, f64)>,
    /// `∫ ψ_j Ñ_k dA` for nodes of the master, in ascending order; the values add up to the weight.
    pub master: Vec<(usize, f64)>,
    /// `∫ ψ_j b dA` with the bulges `b` of both sides, see [`Cover::bulge`], m² or m³.
    pub bulge: [f64; 2],
}

/// Computes the contributions of a `facet` to its nodes that are not `lost`. The functions ψ_j are
///
/// ```text
/// ψ = A Ñ,   A = diag(∫ Ñ) (∫ Ñ Ñᵀ)⁻¹:   ∫ ψ_i Ñ_j dA = δ_ij ∫ Ñ_j dA,   Σ ψ_j = 1,
/// ```
///
/// with integrals over the covered part of the facet. The function of a lost node is added in equal parts to the
/// functions of the nodes that [`takers`] returns. Empty if the cover is too thin to distinguish the functions.
pub(super) fn parts(mesh: &Mesh, facet: &[usize], cover: &Cover, lost: &BTreeSet<usize>) -> Vec<FacetShare> {
    let (kept, gone): (Vec<usize>, Vec<usize>) = (0..facet.len()).partition(|&i| !lost.contains(&facet[i]));
    let Some(dual) = dual(cover, facet.len()).filter(|_| cover.counts() && !kept.is_empty()) else { return Vec::new() };
    let edges = if gone.is_empty() { Vec::new() } else { mesh.bent_edges(facet) };
    let gone: Vec<(usize, Vec<usize>)> = gone.into_iter().map(|k| (k, takers(facet, &edges, &kept, k))).collect();
    let part = |&i: &usize| {
        let taken = gone.iter().filter(|(_, takers)| takers.contains(&i));
        let terms =
            || std::iter::once((i, 1.0)).chain(taken.clone().map(|(k, takers)| (*k, 1.0 / takers.len() as f64)));
        let weight = terms().map(|(k, share)| share * cover.functions[k]).sum();
        let slave = terms().map(|(k, share)| (facet[k], share * cover.functions[k]));
        let bulge = cover.bulge.map(|bulge| {
            terms().map(|(k, share)| share * dual[k].iter().zip(&bulge).map(|(a, c)| a * c).sum::<f64>()).sum()
        });
        let psi: Values = std::array::from_fn(|j| terms().map(|(k, share)| share * dual[k][j]).sum());
        FacetShare { node: facet[i], weight, slave: slave.collect(), master: on_master(cover, &psi, weight), bulge }
    };
    kept.iter().map(part).collect()
}

/// Returns the nodes of `kept`, by their local numbers, that take the function of the lost node `k` of a facet. On
/// facets of second order the displacement of a node between corners contains those of the two corners. If both corners
/// took the function, each would have a displacement relative to the other. Therefore a corner takes it only if no
/// other end of that edge is kept; if no node qualifies, the kept node with the lowest number takes it.
fn takers(facet: &[usize], edges: &[[usize; 3]], kept: &[usize], k: usize) -> Vec<usize> {
    let edge = |node: usize| edges.iter().find(|[_, middle, _]| *middle == node);
    let Some(&[a, _, b]) = edge(facet[k]) else { return kept.to_vec() };
    let other_end_is_kept = |i: usize| kept.iter().any(|&j| j != i && [a, b].contains(&facet[j]));
    let takes = |i: &usize| edge(facet[*i]).is_some() || !other_end_is_kept(*i);
    let takers: Vec<usize> = kept.iter().copied().filter(takes).collect();
    if takers.is_empty() { kept.iter().copied().min_by_key(|&i| facet[i]).into_iter().collect() } else { takers }
}

/// Computes `∫ ψ Ñ_k dA` without rounding errors of zeros; the largest value is set so that the sum equals the weight.
fn on_master(cover: &Cover, psi: &Values, weight: f64) -> Vec<(usize, f64)> {
    let integral = |(node, values): &(usize, Values)| {
        let (sum, size) =
            psi.iter().zip(values).fold((0.0, 0.0), |(sum, size), (a, c)| (sum + a * c, size + (a * c).abs()));
        (sum.abs() > CANCELLED_SHARE * size).then_some((*node, sum))
    };
    let mut master: Vec<(usize, f64)> = cover.cross.iter().filter_map(integral).collect();
    let rest = weight - master.iter().map(|(_, value)| value).sum::<f64>();
    if let Some((_, largest)) = master.iter_mut().max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs())) {
        *largest += rest;
    }
    if let [(_, only)] = &mut master[..] {
        *only = weight;
    }
    master
}

/// Computes A by elimination in the mass matrix with its diagonal scaled to 1, so that a thin cover does not harm the
/// condition.
fn dual(cover: &Cover, count: usize) -> Option<[Values; MOST]> {
    let scale: Values = std::array::from_fn(|i| if i < count { cover.mass[i][i].sqrt().recip() } else { 0.0 });
    let mut mass: [Values; MOST] =
        std::array::from_fn(|i| std::array::from_fn(|j| cover.mass[i][j] * scale[i] * scale[j]));
    let mut inverse: [Values; MOST] = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    for k in 0..count {
        let pivot = mass[k][k];
        if !(SINGULAR..f64::INFINITY).contains(&pivot) {
            return None;
        }
        for matrix in [&mut mass, &mut inverse] {
            matrix[k] = matrix[k].map(|c| c / pivot);
        }
        for i in (0..count).filter(|&i| i != k) {
            let factor = mass[i][k];
            for matrix in [&mut mass, &mut inverse] {
                let row = matrix[k];
                matrix[i].iter_mut().zip(row).for_each(|(c, r)| *c -= factor * r);
            }
        }
    }
    Some(std::array::from_fn(|i| std::array::from_fn(|j| cover.functions[i] * scale[i] * inverse[i][j] * scale[j])))
}
