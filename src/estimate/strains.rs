//! The strains of a body at its integration points, and means of them in its nodes.

use std::collections::HashMap;

use crate::fem::{Element, numbered};
use crate::model::Model;

/// The elastic strains of a body, and where its nodes have values of their own: one for each law of the cells around, for at a
/// border between materials strains jump.
pub(super) struct Strains {
    /// Volumes (m³; in two dimensions areas, m²; in a body of revolution all around) and strains of all integration points, cell by cell.
    points: Vec<(f64, [f64; 6])>,
    /// Where those of each cell begin, and the end.
    begins: Vec<usize>,
    /// The place of each node of each cell among nodal values.
    places: Vec<usize>,
    /// Where those of each cell begin.
    places_of: Vec<usize>,
    /// How many nodal values there are.
    values: usize,
}

impl Strains {
    /// Those of `displacements` of all nodes (m), with the `factors` of [`Model::thermal_factors`].
    pub(super) fn new(model: &Model, factors: &[f64], displacements: &[[f64; 3]]) -> Self {
        let (mut points, mut begins) = (Vec::new(), vec![0]);
        for e in 0..model.mesh.cells.len() {
            let strains = model.elastic_strains(e, factors, displacements);
            match model.element() {
                Element::NodalVolume => points.extend(strains.chunks(model.mesh.cells[e].nodes.len()).map(mean)),
                Element::Bilinear | Element::BBar => points.extend(strains),
            }
            begins.push(points.len());
        }
        let laws = numbered(model.materials().iter().copied());
        let mut known: HashMap<(usize, usize), usize> = HashMap::new();
        let (mut places, mut places_of) = (Vec::new(), Vec::new());
        for (cell, law) in model.mesh.cells.iter().zip(laws) {
            places_of.push(places.len());
            let next = |node: &usize| {
                let new = known.len();
                *known.entry((*node, law)).or_insert(new)
            };
            places.extend(cell.nodes.iter().map(next));
        }
        Strains { points, begins, places, places_of, values: known.len() }
    }

    /// Volume and strain at the integration points of cell `e`.
    pub(super) fn of_cell(&self, e: usize) -> &[(f64, [f64; 6])] {
        &self.points[self.begins[e]..self.begins[e + 1]]
    }

    /// The volume of cell `e`.
    pub(super) fn volume(&self, e: usize) -> f64 {
        self.of_cell(e).iter().map(|(volume, _)| volume).sum()
    }

    /// The place among nodal values of node `k` of cell `e`.
    pub(super) fn place(&self, e: usize, k: usize) -> usize {
        self.places[self.places_of[e] + k]
    }

    /// In each node, of each law, the mean of what the cells around have there: `value` of a cell and the number of its node, each
    /// with the weight of its volume.
    pub(super) fn means<const N: usize>(
        &self,
        model: &Model,
        value: impl Fn(usize, usize) -> [f64; N],
    ) -> Vec<[f64; N]> {
        let mut sums = vec![([0.0; N], 0.0); self.values];
        for (e, cell) in model.mesh.cells.iter().enumerate() {
            let volume = self.volume(e);
            for k in 0..cell.nodes.len() {
                let (sum, weight) = &mut sums[self.place(e, k)];
                sum.iter_mut().zip(value(e, k)).for_each(|(sum, x)| *sum += volume * x);
                *weight += volume;
            }
        }
        sums.into_iter().map(|(sum, weight)| sum.map(|x| x / weight)).collect()
    }
}

/// The volume and the mean strain of a point, whose strains by its nodes differ in dilatation alone.
fn mean(strains: &[(f64, [f64; 6])]) -> (f64, [f64; 6]) {
    let volume: f64 = strains.iter().map(|(volume, _)| volume).sum();
    let component = |c: usize| strains.iter().map(|(v, strain)| v / volume * strain[c]).sum();
    (volume, std::array::from_fn(component))
}
