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

use super::places::Places;
use super::recovery::recovered;
use super::strains::Strains;
use crate::body::mesh::MOST_NODES;
use crate::body::model::Model;

/// The error of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct DiscretisationError {
    /// The whole, as a share of the energy norm of the solution.
    pub whole: f64,
    /// Of each cell, in the same measure: their squares add up to that of the whole.
    pub of_cells: Vec<f64>,
    /// The error of the stresses, as a share of these, both in the root of the mean square; only of laws with a Poisson's ratio of 0.45 or
    /// more, where pressures may be far off and hardly count in the energy.
    pub stresses: Option<f64>,
}

/// The bulk modulus over the shear modulus from which on pressures are looked at: that of ν = 0.45, less what rounding leaves.
const STIFF: f64 = 9.66;

/// `σ : σ`.
fn sum_of_squares([xx, yy, zz, xy, yz, zx]: [f64; 6]) -> f64 {
    xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + yz * yz + zx * zx)
}

impl DiscretisationError {
    /// That of a state with these strains; none where nothing is strained, or too few cells of second order hang together.
    pub(super) fn new(model: &Model, places: &Places, strains: &Strains) -> Option<Self> {
        let in_nodes = recovered(model, places, strains)?;
        let (mut squares, mut samples) = (Vec::with_capacity(model.mesh.cells.len()), Vec::new());
        let mut stresses = [0.0; 2];
        for (e, law) in model.materials().iter().enumerate() {
            let mut at_nodes = [[0.0; 6]; MOST_NODES];
            let places = places.of_cell(e);
            at_nodes.iter_mut().zip(places).for_each(|(own, &place)| *own = in_nodes[place]);
            let mut square = 0.0;
            // The difference is of the degree of the shape functions, and its square of twice that.
            let points = strains.at_fine_points(e, &mut samples);
            for (point, (volume, strain)) in points.iter().zip(&samples) {
                let mut off = strain.map(|strain| -strain);
                for (n, at_node) in point.shape.iter().zip(&at_nodes[..places.len()]) {
                    off.iter_mut().zip(at_node).for_each(|(off, x)| *off += n * x);
                }
                square += 2.0 * volume * law.energy_density(&off);
                if law.bulk() > STIFF * law.mu {
                    stresses[0] += volume * sum_of_squares(law.stress(off));
                    stresses[1] += volume * sum_of_squares(law.stress(*strain));
                }
            }
            squares.push(square);
        }
        let all = 2.0 * strains.energies().iter().sum::<f64>() + squares.iter().sum::<f64>();
        let share = |square: f64| (square / all).sqrt();
        (all > 0.0).then(|| DiscretisationError {
            whole: share(squares.iter().sum()),
            of_cells: squares.into_iter().map(share).collect(),
            stresses: (stresses[1] > 0.0).then(|| (stresses[0] / stresses[1]).sqrt()),
        })
    }
}
