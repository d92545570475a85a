//! Reports on pairs of opposing boundaries.

use serde::Serialize;

use crate::algebra::vector::norm;
use crate::body::model::{Model, Pair};
use crate::solver::problem::State;

/// A pair of opposing boundaries.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct PairRecord {
    /// The boundary whose nodes have the contact forces.
    pub slave: String,
    /// The opposite boundary.
    pub master: String,
    /// The reason for the choice of the slave, if it was chosen automatically.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// `true` if the two are glued.
    pub glued: bool,
    /// The number of slave nodes with the other side in front of them.
    pub rows: usize,
    /// The number of pairs of overlapping facets.
    pub segments: usize,
    /// The share of the slave surface with the other side in front of it.
    pub covered: f64,
    /// The smallest gap of the mesh, m; negative if the bodies overlap.
    pub least_gap: f64,
    /// The largest gap of the mesh, m.
    pub largest_gap: f64,
    /// The largest overlap of facets at the end, m, if gaps are those of the mesh. The contact law holds in the mean
    /// over the facets around a node, and the overlap shows how well the meshes suit it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub overlap: Option<f64>,
}

impl PairRecord {
    /// Returns all pairs of `model` without a state.
    pub fn all(model: &Model) -> Vec<Self> {
        model.contact.pairs.iter().map(|pair| PairRecord::of(model, pair)).collect()
    }

    /// Returns all pairs in the `state` at time `t` (s).
    pub(in crate::run) fn all_at(model: &Model, t: f64, state: &State) -> Vec<Self> {
        let displacements = if model.contact.pairs.is_empty() { Vec::new() } else { model.displaced(t, &state.u) };
        let overlap = |pair: &Pair| {
            let here = pair.is_measured() && !pair.jumps;
            let least = pair.mortar.least_gap(&model.mesh, &displacements).filter(|_| here)?;
            Some((-least.gap).max(0.0))
        };
        model
            .contact
            .pairs
            .iter()
            .map(|pair| PairRecord { overlap: overlap(pair), ..PairRecord::of(model, pair) })
            .collect()
    }

    fn of(model: &Model, pair: &Pair) -> Self {
        let facets = model.mesh.boundary(&pair.slave).map_or(&[][..], |slave| &slave.facets);
        let areas: Vec<f64> = facets.iter().map(|facet| norm(model.mesh.area_vector(facet))).collect();
        let covered: f64 = areas.iter().zip(&pair.mortar.covered).map(|(area, share)| area * share).sum();
        let [least, largest] = pair.mortar.gaps.map(|gap| gap.gap);
        PairRecord {
            slave: pair.slave.clone(),
            master: pair.master.name.clone(),
            reason: pair.choice.map(|choice| choice.reason.to_string()),
            glued: pair.glued,
            rows: pair.mortar.rows.len(),
            segments: pair.mortar.segments(),
            covered: covered / areas.iter().sum::<f64>(),
            least_gap: least,
            largest_gap: largest,
            overlap: None,
        }
    }
}
