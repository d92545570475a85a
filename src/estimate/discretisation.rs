//! The error of the mesh in the energy norm, by recovered strains (Zienkiewicz and Zhu, Int. J. Numer. Meth. Engng 24 (1987) 337).
//!
//! Strains of a mesh jump from cell to cell; values recovered in the nodes, interpolated, are nearer to the truth. What is between
//! the two is taken for the error,
//!
//! ```text
//! η² = ∫ (ε* - ε) D (ε* - ε) dV,
//! ```
//!
//! relative to `√(uᵀ K u + η²)`.

use super::recovery::recovered;
use super::strains::Strains;
use crate::mesh::{quadrature_of, shape};
use crate::model::Model;

/// The error of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct DiscretisationError {
    /// The whole, as a share of the energy norm of the solution.
    pub whole: f64,
    /// Of each cell, in the same measure: their squares add up to that of the whole.
    pub of_cells: Vec<f64>,
}

impl DiscretisationError {
    /// That of a state with these strains; none where nothing is strained, or too few cells of second order hang together.
    pub(super) fn new(model: &Model, strains: &Strains) -> Option<Self> {
        let mesh = &model.mesh;
        let in_nodes = recovered(model, strains)?;
        let (mut squares, mut energy) = (Vec::with_capacity(mesh.cells.len()), 0.0);
        for (e, (cell, law)) in mesh.cells.iter().zip(model.materials()).enumerate() {
            let rule = quadrature_of(cell.kind, mesh.geometry, &mesh.points(&cell.nodes));
            let mut square = 0.0;
            for ((volume, strain), (point, _)) in strains.of_cell(e).iter().zip(rule) {
                let mut off = strain.map(|strain| -strain);
                for (k, n) in shape(cell.kind, point).into_iter().enumerate() {
                    off.iter_mut().zip(in_nodes[strains.place(e, k)]).for_each(|(off, x)| *off += n * x);
                }
                square += 2.0 * volume * law.energy_density(&off);
                energy += 2.0 * volume * law.energy_density(strain);
            }
            squares.push(square);
        }
        let all = energy + squares.iter().sum::<f64>();
        let share = |square: f64| (square / all).sqrt();
        (all > 0.0).then(|| DiscretisationError {
            whole: share(squares.iter().sum()),
            of_cells: squares.into_iter().map(share).collect(),
        })
    }
}
