//! The error of the mesh in the energy norm, by recovered strains (Zienkiewicz and Zhu, Int. J. Numer. Meth. Engng 24
//! (1987) 337).
//!
//! The strains of a mesh jump from cell to cell; interpolated values recovered at the nodes are more accurate. Their
//! difference is the estimate of the error,
//!
//! ```text
//! η² = ∫ (ε* - ε) D (ε* - ε) dV,
//! ```
//!
//! relative to `√(uᵀ K u + η²)`.

use super::recovery::{Places, recovered};
use super::strains::{Strains, sum};
use crate::algebra::vector::minus;
use crate::body::mesh::MAX_NODES;
use crate::body::model::Model;

/// The error of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct DiscretisationError {
    /// The error of a part of the body, as a share of the energy norm of its solution: of the part where it is largest. Neither
    /// elasticity nor contact connects parts, so that a load on one hides no error of another.
    pub whole: f64,
    /// The error of each cell, as a share of the energy norm of its part.
    pub of_cells: Vec<f64>,
    /// The share of each cell in the squared energy norm of its part.
    pub energies: Vec<f64>,
    /// The relative error of the stresses in the root mean square; only for laws with a Poisson's ratio of 0.45 or
    /// more, where pressures may be very inaccurate but contribute little to the energy.
    pub stresses: Option<f64>,
    /// η², J; in two dimensions J per m of depth.
    square: f64,
}

/// The least ratio of bulk to shear modulus for which the stresses are examined: that of ν = 0.45 minus a margin for
/// rounding.
const STIFF: f64 = 9.66;

/// Computes `σ : σ`.
fn sum_of_squares([xx, yy, zz, xy, yz, zx]: [f64; 6]) -> f64 {
    xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + yz * yz + zx * zx)
}

impl DiscretisationError {
    /// Estimates the error of a state with these strains; `None` if no strains can be recovered.
    pub(super) fn new(model: &Model, places: &Places, strains: &Strains) -> Option<Self> {
        let in_nodes = recovered(model, places, strains)?;
        let (mut squares, mut samples) = (Vec::with_capacity(model.mesh.cells.len()), Vec::new());
        let mut stresses = [0.0; 2];
        for (e, law) in model.materials().iter().enumerate() {
            let mut at_nodes = [[0.0; 6]; MAX_NODES];
            let places = places.of_cell(e);
            at_nodes.iter_mut().zip(places).for_each(|(own, &place)| *own = in_nodes[place]);
            let mut square = 0.0;
            // The difference has the degree of the shape functions, and its square twice that degree.
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
        let (mut whole, mut of_cells, mut energies) = (0.0_f64, vec![0.0; squares.len()], vec![0.0; squares.len()]);
        for cells in strains.parts() {
            let square = sum(&cells, &squares);
            let energy = 2.0 * sum(&cells, &strains.energies) + square;
            if energy > 0.0 {
                whole = whole.max((square / energy).sqrt());
                for e in cells {
                    of_cells[e] = (squares[e] / energy).sqrt();
                    energies[e] = (2.0 * strains.energies[e] + squares[e]) / energy;
                }
            }
        }
        Some(DiscretisationError {
            whole,
            of_cells,
            energies,
            square: squares.iter().sum(),
            stresses: (stresses[1] > 0.0).then(|| (stresses[0] / stresses[1]).sqrt()),
        })
    }
}

/// The error of a force relative to that of recovered strains, which miss a part of the error at corners and edges of the
/// contact: the median of measured forces.
const OF_RECOVERED: f64 = 1.6;

/// Returns the error of a contact force by the mesh, N: `a(u - u_h, z - z_h)` with recovered strains, for the
/// displacements `u` (m) at time `t` (s) and the influence function `z` of the force. `None` if it cannot be estimated.
pub(crate) fn error_of_force(model: &Model, t: f64, u: &[f64], z: &[f64]) -> Option<f64> {
    let factors = model.thermal_factors(t);
    let displaced = |by: f64| {
        let sum: Vec<f64> = u.iter().zip(z).map(|(u, z)| u + by * z).collect();
        model.displaced(t, &sum)
    };
    let (at_rest, moved) = (displaced(0.0), displaced(1.0));
    let mode: Vec<[f64; 3]> = moved.iter().zip(&at_rest).map(|(moved, rest)| minus(*moved, *rest)).collect();
    let energy = |strains: &Strains<'_>| strains.energies.iter().sum::<f64>();
    let idle = vec![0.0; factors.len()];
    let (strains, influence) = (Strains::new(model, &factors, &at_rest), Strains::new(model, &idle, &mode));
    if influence.are_rounding(&mode) || strains.are_rounding(&at_rest) {
        return Some(0.0);
    }
    // Both fields have the same energy, so that their product is not lost in rounding.
    let by = (energy(&strains) / energy(&influence)).sqrt();
    let places = Places::new(model);
    let square = |by: f64| {
        let displacements = displaced(by);
        let strains = Strains::new(model, &factors, &displacements);
        DiscretisationError::new(model, &places, &strains).map(|error| error.square)
    };
    Some(OF_RECOVERED * (square(by)? - square(-by)?).abs() / (4.0 * by))
}
