//! The same body told otherwise: in other units, in a mirror, with its nodes in another order.

use super::case::Case;
use super::solved::Solved;
use super::{TextOptions, parsed};
use crate::random::Random;
use std::collections::BTreeMap;
use stickslip::body::mesh::{Mesh, MeshSource};
use stickslip::body::{Description, Model};
use stickslip::run::Run;
use stickslip::scene::Scene;

/// By place, in parts of the body's size: the contact forces there, normal and tangential.
pub(super) type Places = BTreeMap<[i64; 3], [f64; 2]>;

/// The contact forces of an increment by place, as they are.
pub(super) fn sorted(solved: &Solved, increment: usize) -> Places {
    by_place(solved, increment, |x| x)
}

fn by_place(solved: &Solved, increment: usize, place: impl Fn([f64; 3]) -> [f64; 3]) -> Places {
    let mut places = Places::new();
    let (state, size) = (&solved.increments[increment].state, solved.model.mesh.size());
    for (i, contact) in solved.model.contact.nodes.iter().enumerate() {
        // No node is where one place ends and another begins.
        let key = place(contact.position).map(|x| (1e6 * x / size + 0.37).floor() as i64);
        let forces = places.entry(key).or_insert([0.0; 2]);
        forces[0] += state.p_n[i];
        forces[1] += state.p_t[i].hypot(state.p_o[i]);
    }
    places
}

/// Where the contact forces of two runs differ by more than `tolerance`, relative to the largest force: the number of the increment
/// from 0, and by how much. Nothing is asked of runs that did not converge, or to which the laws may leave a choice.
pub(super) fn difference(
    one: &Solved,
    other: &Solved,
    places: impl Fn(&Solved, usize) -> Places,
    tolerance: f64,
) -> Result<Option<(usize, f64)>, String> {
    let both = [one, other];
    if !both.iter().all(|solved| solved.converged() && solved.is_unique()) {
        return Ok(None);
    }
    // A method that asks for less gives less, and where moduli differ much, by a factor.
    let asked = both.iter().map(|solved| solved.solver.tolerance).fold(0.0, f64::max);
    let tolerance = if asked > 1e-10 { 1e2 * tolerance * asked / 1e-10 } else { tolerance };
    let mut scale = 0.0_f64;
    for k in 0..one.increments.len().min(other.increments.len()) {
        // An increment in parts has another path, which friction remembers.
        if one.increments[k].record.parts != other.increments[k].record.parts {
            return Ok(None);
        }
        let (a, b) = (sorted(one, k), places(other, k));
        if !a.keys().eq(b.keys()) {
            return Err("other contact nodes".to_string());
        }
        let sizes = a.values().flatten().chain(&one.increments[k].force);
        scale = sizes.fold(scale, |m, force| m.max(force.abs()));
        let differences = a.values().flatten().zip(b.values().flatten()).map(|(a, b)| (a - b).abs());
        let difference = differences.fold(0.0, f64::max);
        if difference > tolerance * scale {
            return Ok(Some((k, difference / scale)));
        }
    }
    Ok(None)
}

/// Fails if there is such a [`difference`].
pub(super) fn alike(
    one: &Solved,
    other: &Solved,
    places: impl Fn(&Solved, usize) -> Places,
    tolerance: f64,
) -> Result<(), String> {
    let message = |(k, by): (usize, f64)| format!("contact forces of increment {} differ by {by:.2e}", k + 1);
    difference(one, other, places, tolerance)?.map_or(Ok(()), |found| Err(message(found)))
}

const UNITS: [([&str; 2], [f64; 2]); 4] = [
    (["mm", "MPa"], [1e-3, 1e6]),
    (["in", "psi"], [0.0254, 6_894.757_293_168_361]),
    (["km", "Pa"], [1e3, 1.0]),
    (["um", "GPa"], [1e-6, 1e9]),
];

/// In other units.
pub(super) fn in_other_units(case: &Case, solved: &Solved) -> Result<(), String> {
    let units = UNITS[(case.end.to_bits() as usize ^ case.increments ^ case.contacts.len()) % UNITS.len()];
    let scene = parsed(&case.text(&TextOptions { units: Some(units), mirrored: false }))?;
    let wrong = |wrong: String| format!("in {:?}: {wrong}", units.0);
    match Solved::of(&scene).map_err(wrong)? {
        Some(other) => alike(solved, &other, sorted, 1e-9).map_err(wrong),
        None => Err(wrong(format!("refused: {}", refusal(&scene)))),
    }
}

/// With left and right in each other's place. What is divided along a diagonal is not the same in a mirror.
pub(super) fn mirrored(case: &Case, solved: &Solved) -> Result<(), String> {
    if !["quadrilateral", "hexahedron"].contains(&case.cells) || case.plane == "axisymmetric" {
        return Ok(());
    }
    let scene = parsed(&case.text(&TextOptions { units: None, mirrored: true }))?;
    let wrong = |wrong: String| format!("mirrored: {wrong}");
    let width = case.width();
    let places = |solved: &Solved, k: usize| by_place(solved, k, |[x, y, z]| [width - x, y, z]);
    match Solved::of(&scene).map_err(wrong)? {
        Some(other) => alike(solved, &other, places, 1e-8).map_err(wrong),
        None => Err(wrong(format!("refused: {}", refusal(&scene)))),
    }
}

/// With nodes and cells in another order.
pub(super) fn renumbered(case: &Case, scene: &Scene, solved: &Solved) -> Result<(), String> {
    if case.bodies.len() > 1 {
        return Ok(());
    }
    let wrong = |wrong: String| format!("renumbered: {wrong}");
    let mesh = scene.description.mesh.build().map_err(|error| wrong(error.to_string()))?;
    let description = Description { mesh: MeshSource::from(shuffled(&mesh)), ..scene.description.clone() };
    let model = Model::build(&description).map_err(|error| wrong(format!("refused: {error}")))?;
    let run =
        Run::of(&model, model.times().to_vec(), scene.solver).map_err(|error| wrong(format!("refused: {error}")))?;
    let other = Solved::run(run, scene.solver).map_err(wrong)?;
    alike(solved, &other, sorted, 1e-8).map_err(wrong)
}

fn shuffled(mesh: &Mesh) -> Mesh {
    let mut random = Random::new("order", mesh.nodes.len() as u64);
    let mut places: Vec<usize> = (0..mesh.nodes.len()).collect();
    for k in (1..places.len()).rev() {
        places.swap(k, random.below(k + 1));
    }
    let mut other = mesh.clone();
    places.iter().zip(&mesh.nodes).for_each(|(&place, x)| other.nodes[place] = *x);
    let moved = |nodes: &mut Vec<usize>| nodes.iter_mut().for_each(|node| *node = places[*node]);
    other.cells.iter_mut().for_each(|cell| moved(&mut cell.nodes));
    other.cells.reverse();
    other.boundaries.iter_mut().flat_map(|boundary| &mut boundary.facets).for_each(moved);
    other
}

/// Why a scene is refused.
fn refusal(scene: &Scene) -> String {
    Run::new(scene).err().map_or(String::new(), |error| error.to_string())
}
