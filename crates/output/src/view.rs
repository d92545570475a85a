//! The data of the page of a run besides the tables: names, units, and the body in the plane.
//!
//! The hidden file begins with a line of JSON, [`Head`]. A further line for some of the output times holds the state of
//! the body, so that the page can magnify displacements as its reader likes. Numbers are small integers in base64:
//!
//! | key | contents |
//! | --- | --- |
//! | `mesh.low`, `mesh.step` | the lowest coordinates, and the length of 1 in `mesh.nodes` |
//! | `mesh.nodes` | x and y of each node, 16 bits without sign |
//! | `mesh.corners`, `mesh.patches` | corners of a patch; their nodes, 16 bits: cells, or of a large body the sides of its outline |
//! | `index`, `time` | increment and its end, s |
//! | `step`, `u` | the length of 1 in `u`; displacements, 16 bits with sign |
//! | `most`, `stress` | largest von Mises stress; stresses of the cells as 0 to 255 of it, without them for an outline |

use std::collections::BTreeMap;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use stickslip::base::{Depth, Quantity, UnitSystem};
use stickslip::body::Model;
use stickslip::run::report::{UnitNames, deformation, von_mises};
use stickslip::solver::history::IncrementView;

/// The hidden file.
pub(crate) const FILE: &str = ".page.jsonl";

/// A body with more cells is drawn as an outline: its cells would be smaller than the dots of a screen.
const MAX_CELLS: usize = 20_000;

/// The first line of the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Head {
    /// The units of the tables, if not SI or per depth.
    #[serde(default)]
    pub units: Option<Value>,
    /// The boundaries with contact, in their order.
    pub boundaries: Vec<String>,
    /// The probes, in their order.
    pub probes: Vec<String>,
    /// The mesh of a body in the plane.
    #[serde(default)]
    pub mesh: Option<Value>,
}

/// The drawn part of a body in the plane.
#[derive(Debug)]
pub(crate) struct View {
    units: UnitSystem,
    /// The drawn nodes of the mesh.
    nodes: Vec<usize>,
    /// The nodes of each patch, by their place in `nodes`.
    patches: Vec<Vec<usize>>,
    /// `true` if the patches are the cells of the mesh.
    has_cells: bool,
}

impl View {
    /// Returns the drawn part of a body in the plane. There is none in space.
    pub(crate) fn of(model: &Model) -> Option<Self> {
        let mesh = &model.mesh;
        if mesh.dimension != 2 {
            return None;
        }
        let has_cells = mesh.cells.len() <= MAX_CELLS;
        let patches: Vec<Vec<usize>> = if has_cells {
            let corners =
                |around: Vec<usize>, count: usize| around.iter().step_by(around.len() / count).copied().collect();
            mesh.cells.iter().map(|cell| corners(cell.around(), cell.kind.corners())).collect()
        } else {
            mesh.surface().iter().map(|(side, _)| vec![side[0], side[side.len() - 1]]).collect()
        };
        let mut index_of: BTreeMap<usize, usize> = patches.iter().flatten().map(|node| (*node, 0)).collect();
        index_of.values_mut().enumerate().for_each(|(k, place)| *place = k);
        let patches = patches.iter().map(|patch| patch.iter().map(|node| index_of[node]).collect()).collect();
        let nodes: Vec<usize> = index_of.into_keys().collect();
        // The outline of a body with so many nodes is not worth more bytes.
        (u16::try_from(nodes.len()).is_ok()).then_some(View { units: model.units(), nodes, patches, has_cells })
    }

    /// Returns the mesh.
    pub(crate) fn mesh(&self, model: &Model) -> Value {
        let at = |c: usize| self.nodes.iter().map(move |&node| model.mesh.nodes[node][c]);
        let low = [0, 1].map(|c| at(c).fold(f64::INFINITY, f64::min));
        let size = [0, 1].map(|c| at(c).fold(f64::NEG_INFINITY, f64::max) - low[c]);
        let step = size[0].max(size[1]) / f64::from(u16::MAX);
        let corners = self.patches.iter().map(Vec::len).max().unwrap_or(0);
        let nodes = self.nodes.iter().flat_map(|&node| {
            [0, 1].map(|c| ((model.mesh.nodes[node][c] - low[c]) / step).round() as u16).map(u16::to_le_bytes)
        });
        // A triangle among quadrilaterals has its last corner twice.
        let patches = self.patches.iter().flat_map(|patch| {
            (0..corners).map(|k| patch[k.min(patch.len() - 1)] as u16).map(u16::to_le_bytes).collect::<Vec<_>>()
        });
        let length = |x: f64| self.units.of_si(Quantity::Length, x);
        json!({
            "low": low.map(length),
            "step": length(step),
            "nodes": encoded(nodes.flatten()),
            "corners": corners,
            "patches": encoded(patches.flatten()),
        })
    }

    /// Returns the line of the state at the end of `step`.
    pub(crate) fn line(&self, model: &Model, step: &IncrementView<'_>) -> String {
        let (displacements, factors) = deformation(model, step);
        let drawn = || self.nodes.iter().flat_map(|&node| [0, 1].map(|c| displacements[node][c]));
        let unit = drawn().map(f64::abs).fold(0.0, f64::max) / f64::from(i16::MAX);
        let u = drawn().map(|u| if unit > 0.0 { (u / unit).round() as i16 } else { 0 });
        // The index is first: by it the page finds a state.
        let mut line = format!("{{\"index\":{},", step.record.index);
        let mut rest = json!({
            "time": step.record.time,
            "step": self.units.of_si(Quantity::Length, unit),
            "u": encoded(u.flat_map(i16::to_le_bytes)),
        });
        if self.has_cells {
            let stresses: Vec<f64> = model.stresses(&factors, &displacements).into_iter().map(von_mises).collect();
            let most = stresses.iter().copied().fold(0.0, f64::max);
            let shares =
                stresses.iter().map(|s| if most > 0.0 { (s / most * f64::from(u8::MAX)).round() as u8 } else { 0 });
            rest["most"] = self.units.of_si(Quantity::Stress, most).into();
            rest["stress"] = encoded(shares).into();
        }
        line += &rest.to_string()[1..];
        line + "\n"
    }
}

/// Returns the first line of the file.
pub(crate) fn head(model: &Model, view: Option<&View>, probes: &[&str]) -> String {
    let units = model.units();
    let names = || {
        let mut names = json!(UnitNames::of(&units));
        for (key, quantity) in [("area", Quantity::Area), ("energy_per_area", Quantity::EnergyPerArea)] {
            names[key] = json!({ "name": units.name(quantity) });
        }
        names
    };
    let head = json!({
        "units": (!units.is_si() || units.depth == Depth::Unit).then(names),
        "boundaries": model.contact.boundaries.iter().map(|boundary| &boundary.name).collect::<Vec<_>>(),
        "probes": probes,
        "mesh": view.map(|view| view.mesh(model)),
    });
    head.to_string() + "\n"
}

fn encoded(bytes: impl Iterator<Item = u8>) -> String {
    BASE64_STANDARD.encode(bytes.collect::<Vec<u8>>())
}
