//! Displacement and stress at points of the body, over time.

use std::collections::BTreeSet;

use super::csv::{self, number};
use super::deformation::deformation;
use super::principal::von_mises;
use super::quantities::Columns;
use crate::algebra::vector::{minus, norm};
use crate::base::input_error::InputError;
use crate::base::units::{Quantity, UnitSystem};
use crate::body::description::{Probe, ProbePlace};
use crate::body::estimate::StressRecovery;
use crate::body::fem::reference_point;
use crate::body::mesh::{Mesh, shape};
use crate::body::model::Model;
use crate::solver::history::IncrementView;

/// The distance from the box around the nodes of a cell, in sizes of the cell, up to which points are tried: for
/// straight and for curved edges. A curved edge leaves the box by at most an eighth of its length.
const MARGINS: [f64; 2] = [1e-6, 0.25];

/// The points of a probe, each with the cell that contains it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ProbeTable {
    /// The name of the probe.
    pub name: String,
    dimension: usize,
    points: Vec<Held>,
    recovery: StressRecovery,
}

/// A point and its cell.
#[derive(Debug, Clone, PartialEq)]
struct Held {
    position: [f64; 3],
    cell: usize,
    /// The coordinates in the reference cell.
    reference: [f64; 3],
}

/// The values at a point of a probe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProbeValue {
    /// The point before the deformation, m.
    pub position: [f64; 3],
    /// The displacement, interpolated in the cell, m.
    pub displacement: [f64; 3],
    /// The stress `(σ_xx, σ_yy, σ_zz, τ_xy, τ_yz, τ_zx)` at the point, Pa, interpolated between the stresses recovered
    /// at the nodes of its cell. On an interface between materials, the cell with the lowest number counts.
    pub stress: [f64; 6],
}

impl ProbeTable {
    /// Creates the tables of `probes`, after checking these by [`Probe::check`].
    ///
    /// # Errors
    /// [`InputError`] of the key of a point that is outside the body of `model`, or has another dimension.
    pub fn all(model: &Model, probes: &[Probe]) -> Result<Vec<Self>, InputError> {
        Probe::check(probes)?;
        let mut tables = Vec::with_capacity(probes.len());
        for (k, probe) in probes.iter().enumerate() {
            tables.push(Self::new(model, probe).map_err(|fault| fault.with_key(&format!("output.probe[{k}]")))?);
        }
        Ok(tables)
    }

    fn new(model: &Model, probe: &Probe) -> Result<Self, InputError> {
        let (mesh, name) = (&*model.mesh, probe.name.clone());
        let dimension = mesh.dimension;
        let given = match probe.place {
            ProbePlace::Point(point) => vec![("point", point)],
            ProbePlace::Line { from, to, .. } => vec![("from", from), ("to", to)],
        };
        if let Some((key, point)) = given.iter().find(|(_, point)| point.dimension() != dimension) {
            let x = point.map(|x| model.units().number(Quantity::Length, x));
            let message =
                format!("the point {x:?} has {} components, but the body {dimension} dimensions", point.dimension());
            let help = if dimension == 2 { "give [x, y]" } else { "give [x, y, z]" };
            return Err(InputError::new(*key, message, help));
        }
        let positions = probe.points();
        let cells = cells(mesh, &positions);
        let mut points = Vec::with_capacity(positions.len());
        for (k, (position, located)) in positions.iter().zip(cells).enumerate() {
            let Some((cell, reference)) = located else {
                let key = if k == 0 { given[0].0 } else { given[given.len() - 1].0 };
                return Err(outside(mesh, &model.units(), key, *position));
            };
            points.push(Held { position: *position, cell, reference });
        }
        let of_probe: BTreeSet<usize> = points.iter().map(|point| point.cell).collect();
        let recovery = StressRecovery::new(model, |e| of_probe.contains(&e));
        Ok(ProbeTable { name, dimension: mesh.components(), points, recovery })
    }

    /// Returns the values at the points at the end of a `step` of `model`, which must be the model of the table.
    pub fn values(&self, model: &Model, step: &IncrementView<'_>) -> Vec<ProbeValue> {
        let (displacements, factors) = deformation(model, step);
        let at_places = self.recovery.stresses(model, &factors, &displacements);
        let value = |point: &Held| {
            let cell = &model.mesh.cells[point.cell];
            let shares = shape(cell.kind, point.reference);
            let along = |c: usize| cell.nodes.iter().zip(&shares).map(|(&node, n)| n * displacements[node][c]).sum();
            let mut stress = [0.0; 6];
            for (n, &place) in shares.iter().zip(self.recovery.of_cell(point.cell)) {
                stress.iter_mut().zip(at_places[place]).for_each(|(sum, s)| *sum += n * s);
            }
            ProbeValue { position: point.position, displacement: [0, 1, 2].map(along), stress }
        };
        self.points.iter().map(value).collect()
    }

    /// Returns the names of the columns.
    pub fn header(&self) -> String {
        header(self.dimension)
    }

    /// Formats a line for each point at the end of a step.
    pub fn lines(&self, model: &Model, step: &IncrementView<'_>) -> String {
        let d = self.dimension;
        let written = Columns::new(&model.units(), columns(d).iter().copied());
        let line = |(k, value): (usize, ProbeValue)| {
            let ProbeValue { position, displacement, stress } = value;
            let components = if d == 2 { 4 } else { 6 };
            let mises = von_mises(stress);
            let numbers = position[..d].iter().chain(&displacement[..d]).chain(&stress[..components]).chain([&mises]);
            let mut fields = vec![step.record.index.to_string(), number(step.record.time), (k + 1).to_string()];
            fields.extend(written.cells(numbers.copied()));
            csv::line(&fields)
        };
        self.values(model, step).into_iter().enumerate().map(line).collect()
    }
}

/// Returns the names of the columns in this number of dimensions.
pub(super) fn header(dimension: usize) -> String {
    csv::line(&[&["index", "time", "point"], columns(dimension)].concat())
}

/// Returns the columns of the values at a point.
fn columns(dimension: usize) -> &'static [&'static str] {
    match dimension {
        2 => &["x", "y", "u_x", "u_y", "s_xx", "s_yy", "s_zz", "s_xy", "von_mises"],
        _ => &["x", "y", "z", "u_x", "u_y", "u_z", "s_xx", "s_yy", "s_zz", "s_xy", "s_yz", "s_zx", "von_mises"],
    }
}

/// Returns the first cell that contains each of `points`, with the coordinates in its reference cell.
fn cells(mesh: &Mesh, points: &[[f64; 3]]) -> Vec<Option<(usize, [f64; 3])>> {
    let mut found = vec![None; points.len()];
    for (e, cell) in mesh.cells.iter().enumerate() {
        let nodes = || cell.nodes.iter().map(|&node| mesh.nodes[node]);
        let bounds = [0, 1, 2].map(|c| {
            nodes().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x[c]), high.max(x[c])))
        });
        let margin = MARGINS[usize::from(cell.kind.is_quadratic())]
            * bounds.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
        let near = |x: &[f64; 3]| (0..3).all(|c| x[c] >= bounds[c].0 - margin && x[c] <= bounds[c].1 + margin);
        for (point, place) in points.iter().zip(&mut found).filter(|(_, place)| place.is_none()) {
            if near(point) {
                *place = reference_point(cell.kind, &mesh.points(&cell.nodes), *point).map(|reference| (e, reference));
            }
        }
    }
    found
}

fn outside(mesh: &Mesh, units: &UnitSystem, key: &str, point: [f64; 3]) -> InputError {
    let nearest = mesh.nodes.iter().min_by(|a, b| norm(minus(**a, point)).total_cmp(&norm(minus(**b, point))));
    let message = format!("the point {} is outside of the body", units.point(point));
    let node = nearest.map_or(String::new(), |node| format!("; the nearest node is at {}", units.point(*node)));
    InputError::new(key, message, format!("give a point of the undeformed mesh{node}"))
}
