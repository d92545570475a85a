//! The data of the page of a run besides the tables: names, units, and the body: in the plane its cells, in space its surface.
//!
//! The hidden file begins with a line of JSON, [`Head`]. A further line for some of the output times holds the state of
//! the body, so that the page can magnify displacements and turn the body as its reader likes. Numbers are small integers in
//! base64:
//!
//! | key | contents |
//! | --- | --- |
//! | `mesh.low`, `mesh.step` | the lowest coordinates, two in the plane and three in space, and the length of 1 in `mesh.nodes` |
//! | `mesh.nodes` | the coordinates of each node, 16 bits without sign |
//! | `mesh.corners`, `mesh.patches` | corners of a patch; their nodes, 16 bits: cells, or of a large body the sides of its outline; in space the facets |
//! | `mesh.contact` | the nodes of the contact, 16 bits |
//! | `index`, `time` | increment and its end, s |
//! | `step`, `u` | the length of 1 in `u`; displacements, 16 bits with sign |
//! | `most`, `stress` | largest von Mises stress; stresses of the patches as 0 to 255 of it, without them for an outline |
//! | `pressure`, `slip` | at the nodes of the contact: the stress or length of 1, and 16 bits with sign |
//! | `status` | a letter for each of them: open (o), stick (t), slip (l) |

use std::collections::{BTreeMap, BTreeSet};

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use stickslip::base::{Depth, Quantity, UnitSystem};
use stickslip::body::Model;
use stickslip::run::report::{ContactPoint, UnitNames, contact_points, deformation, von_mises};
use stickslip::solver::ContactStatus;
use stickslip::solver::history::IncrementView;

/// The hidden file.
pub(crate) const FILE: &str = ".page.jsonl";

/// A body in the plane with more cells is drawn as an outline: its cells would be smaller than the dots of a screen.
const MAX_CELLS: usize = 20_000;

/// A body with more nodes on its surface is not drawn: it would be most of the page.
const MAX_NODES: usize = 34_000;

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
    /// The mesh of the body.
    #[serde(default)]
    pub mesh: Option<Value>,
}

/// The drawn part of a body.
#[derive(Debug)]
pub(crate) struct View {
    units: UnitSystem,
    dimension: usize,
    /// The drawn nodes of the mesh, ascending.
    nodes: Vec<usize>,
    /// The nodes of each patch, by their place in `nodes`.
    patches: Vec<Vec<usize>>,
    /// The cell of each patch; empty for an outline.
    cells: Vec<usize>,
}

impl View {
    /// Returns the drawn part of a body that is not too large.
    pub(crate) fn of(model: &Model) -> Option<Self> {
        let mesh = &model.mesh;
        let corners = |cell: usize| &mesh.cells[cell].nodes[..mesh.cells[cell].kind.corners()];
        let has_cells = mesh.dimension == 2 && mesh.cells.len() <= MAX_CELLS;
        let mut patches = if has_cells {
            mesh.cells.iter().enumerate().map(|(e, cell)| (cell.around(), e)).collect()
        } else {
            mesh.surface()
        };
        for (patch, e) in &mut patches {
            patch.retain(|node| corners(*e).contains(node));
        }
        let mut index_of: BTreeMap<usize, usize> =
            patches.iter().flat_map(|(patch, _)| patch).map(|node| (*node, 0)).collect();
        index_of.values_mut().enumerate().for_each(|(k, place)| *place = k);
        let cells = patches.iter().filter(|_| has_cells || mesh.dimension == 3).map(|(_, e)| *e).collect();
        let patches = patches.iter().map(|(patch, _)| patch.iter().map(|node| index_of[node]).collect()).collect();
        let nodes: Vec<usize> = index_of.into_keys().collect();
        (nodes.len() <= MAX_NODES).then_some(View {
            units: model.units(),
            dimension: mesh.dimension,
            nodes,
            patches,
            cells,
        })
    }

    /// Returns the mesh.
    pub(crate) fn mesh(&self, model: &Model) -> Value {
        let at = |c: usize| self.nodes.iter().map(move |&node| model.mesh.nodes[node][c]);
        let low: Vec<f64> = (0..self.dimension).map(|c| at(c).fold(f64::INFINITY, f64::min)).collect();
        let size = (0..self.dimension).map(|c| at(c).fold(f64::NEG_INFINITY, f64::max) - low[c]);
        let step = size.fold(0.0, f64::max) / f64::from(u16::MAX);
        let corners = self.patches.iter().map(Vec::len).max().unwrap_or(0);
        let nodes = self.nodes.iter().flat_map(|&node| {
            low.iter().zip(model.mesh.nodes[node]).map(move |(low, x)| ((x - low) / step).round() as u16)
        });
        // A triangle among quadrilaterals has its last corner twice.
        let patches =
            self.patches.iter().flat_map(|patch| (0..corners).map(move |k| patch[k.min(patch.len() - 1)] as u16));
        let contact: BTreeSet<usize> = model.contact.nodes.iter().filter_map(|node| self.place(node.node)).collect();
        let length = |x: f64| self.units.of_si(Quantity::Length, x);
        json!({
            "low": low.iter().map(|x| length(*x)).collect::<Vec<_>>(),
            "step": length(step),
            "nodes": encoded(nodes.flat_map(u16::to_le_bytes)),
            "corners": corners,
            "patches": encoded(patches.flat_map(u16::to_le_bytes)),
            "contact": encoded(contact.into_iter().flat_map(|place| (place as u16).to_le_bytes())),
        })
    }

    /// Returns the place of a drawn node.
    fn place(&self, node: usize) -> Option<usize> {
        self.nodes.binary_search(&node).ok()
    }

    /// Returns the line of the state at the end of `step`.
    pub(crate) fn line(&self, model: &Model, step: &IncrementView<'_>) -> String {
        let (displacements, factors) = deformation(model, step);
        let drawn = self.nodes.iter().flat_map(|&node| &displacements[node][..self.dimension]);
        let (unit, u) = packed(drawn.copied());
        // The index is first: by it the page finds a state.
        let mut line = format!("{{\"index\":{},", step.record.index);
        let mut rest = json!({ "time": step.record.time, "step": self.units.of_si(Quantity::Length, unit), "u": u });
        if !self.cells.is_empty() {
            let all = model.stresses(&factors, &displacements);
            let stresses: Vec<f64> = self.cells.iter().map(|e| von_mises(all[*e])).collect();
            let most = stresses.iter().copied().fold(0.0, f64::max);
            let shares =
                stresses.iter().map(|s| if most > 0.0 { (s / most * f64::from(u8::MAX)).round() as u8 } else { 0 });
            rest["most"] = self.units.of_si(Quantity::Stress, most).into();
            rest["stress"] = encoded(shares).into();
        }
        let points = contact_points(model, 0..model.contact.nodes.len(), step);
        let mut contact: BTreeMap<usize, &ContactPoint> = BTreeMap::new();
        for (place, point) in points.iter().filter_map(|point| Some((self.place(point.node)?, point))) {
            // A node that meets two obstacles shows the one that presses more.
            let shown = contact.entry(place).or_insert(point);
            if point.sigma_n > shown.sigma_n {
                *shown = point;
            }
        }
        if !contact.is_empty() {
            let (unit, pressure) = packed(contact.values().map(|point| point.sigma_n));
            rest["pressure"] = json!([self.units.of_si(Quantity::Stress, unit), pressure]);
            let (unit, slip) = packed(contact.values().map(|point| point.slip_t.hypot(point.slip_o)));
            rest["slip"] = json!([self.units.of_si(Quantity::Length, unit), slip]);
            let letter = |point: &&ContactPoint| match point.status {
                ContactStatus::Open => 'o',
                ContactStatus::Stick => 't',
                ContactStatus::Slip => 'l',
            };
            rest["status"] = contact.values().map(letter).collect::<String>().into();
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

/// Returns the value of 1, and `values` as 16 bits with sign.
fn packed(values: impl Iterator<Item = f64> + Clone) -> (f64, String) {
    let unit = values.clone().map(f64::abs).fold(0.0, f64::max) / f64::from(i16::MAX);
    let short = values.map(|x| if unit > 0.0 { (x / unit).round() as i16 } else { 0 });
    (unit, encoded(short.flat_map(i16::to_le_bytes)))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use stickslip::run::{Recording, Run};
    use stickslip::scene::Scene;

    fn decoded(text: &Value) -> Vec<[u8; 2]> {
        let bytes = BASE64_STANDARD.decode(text.as_str().unwrap()).unwrap();
        bytes.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
    }

    fn unsigned(text: &Value) -> Vec<usize> {
        decoded(text).into_iter().map(|pair| u16::from_le_bytes(pair).into()).collect()
    }

    fn signed(text: &Value, unit: &Value) -> Vec<f64> {
        decoded(text).into_iter().map(|pair| f64::from(i16::from_le_bytes(pair)) * unit.as_f64().unwrap()).collect()
    }

    /// Returns the largest difference, relative to the largest number.
    fn difference(found: &[f64], exact: impl Iterator<Item = f64>) -> f64 {
        let exact: Vec<f64> = exact.collect();
        assert_eq!(found.len(), exact.len());
        let most = exact.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        found.iter().zip(exact).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs() / most))
    }

    /// Returns the sum over the facets, which is the volume of the body only if each has its corners in order.
    fn volume(nodes: &[Vec<f64>], patches: &[&[usize]]) -> f64 {
        let at = |node: usize| -> [f64; 3] { nodes[node].clone().try_into().unwrap() };
        let part = |a, b, c| stickslip::algebra::dot(at(a), stickslip::algebra::cross(at(b), at(c))) / 6.0;
        patches.iter().flat_map(|patch| (1..patch.len() - 1).map(|k| part(patch[0], patch[k], patch[k + 1]))).sum()
    }

    #[test]
    fn the_page_shows_the_body_where_it_is() {
        for (cells, unit) in [("hexahedron", "m"), ("hexahedron20", "mm"), ("tetrahedron", "m"), ("tetrahedron10", "m")]
        {
            let text = format!(
                "units = {{ length = '{unit}', stress = 'Pa' }}\n[mesh]\nkind = 'block'\nsize = [2, 1, 1]\norigin = [-1, 3, 0]\n\
                 elements = [3, 2, 2]\ncells = '{cells}'\n[material]\nyoung = 1e9\npoisson = 0.25\n\
                 [[support]]\nboundary = 'left'\nfix = ['x', 'y', 'z']\n\
                 [[contact]]\nboundary = 'bottom'\nfriction = 0.4\nobstacle = {{ kind = 'plane' }}\n\
                 [[load]]\nboundary = 'top'\ntraction = [1e5, 0, -1e6]\n[time]\nend = 1\nincrements = 1\n"
            );
            let run = Scene::parse("box.toml", &text, &[]).unwrap();
            let run = Run::new(&run).unwrap();
            let mut recording = Recording::last();
            run.solve(&mut recording).unwrap();
            let (model, last) = (run.model(), &recording.increments[0]);
            let data = last.data();
            let (step, view) = (last.step(&data), View::of(model).unwrap());
            let (mesh, length) = (view.mesh(model), model.units().of_si(Quantity::Length, 1.0));
            let low: Vec<f64> = mesh["low"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
            let numbers = unsigned(&mesh["nodes"]);
            let of = |(k, n): (usize, &usize)| low[k % 3] + mesh["step"].as_f64().unwrap() * *n as f64;
            let places: Vec<f64> = numbers.iter().enumerate().map(of).collect();
            let of_mesh = view.nodes.iter().flat_map(|&node| model.mesh.nodes[node]);
            assert!(difference(&places, of_mesh.map(|x| x * length)) < 1e-5, "{cells}");

            let corners = mesh["corners"].as_u64().unwrap() as usize;
            let patches = unsigned(&mesh["patches"]);
            let patches: Vec<&[usize]> = patches.chunks_exact(corners).collect();
            let places: Vec<Vec<f64>> = places.chunks_exact(3).map(<[f64]>::to_vec).collect();
            assert!((volume(&places, &patches) / 2.0 - 1.0).abs() < 1e-4, "{cells}");

            let state: Value = serde_json::from_str(&view.line(model, &step)).unwrap();
            let (all, _) = deformation(model, &step);
            let moved = view.nodes.iter().flat_map(|&node| all[node]).map(|u| u * length);
            assert!(difference(&signed(&state["u"], &state["step"]), moved) < 2e-5, "{cells}");
            let contact = unsigned(&mesh["contact"]);
            assert!(contact.iter().all(|&place| (places[place][2] - low[2]).abs() < 1e-9 * length), "{cells}");
            let points = contact_points(model, 0..model.contact.nodes.len(), &step);
            let at = |&place: &usize| points.iter().find(|point| point.node == view.nodes[place]).unwrap();
            let pressure = signed(&state["pressure"][1], &state["pressure"][0]);
            let exact = contact.iter().map(|place| at(place).sigma_n);
            assert!(difference(&pressure, exact) < 2e-5, "{cells}");
            let slip = signed(&state["slip"][1], &state["slip"][0]);
            assert!(difference(&slip, contact.iter().map(|k| at(k).slip_t.hypot(at(k).slip_o) * length)) < 2e-5);
            let is_open = |place| at(place).status == ContactStatus::Open;
            assert!(contact.iter().map(is_open).eq(state["status"].as_str().unwrap().chars().map(|of| of == 'o')));
            let stresses = BASE64_STANDARD.decode(state["stress"].as_str().unwrap()).unwrap();
            assert!(stresses.len() == patches.len() && stresses.contains(&u8::MAX), "{cells}");
        }
    }
}
