//! Estimates the disk space for the results of a run before the run.

use crate::page::MAX_STATES;
use stickslip::body::{Model, Probe, ProbePlace};
use stickslip::scene::Scene;

/// Bytes per increment: its record in a hidden file and in `run.json`, and its line in `increments.csv`.
const INCREMENT: usize = 1400;

/// Bytes per force on a boundary and increment, in the same files and in `forces.csv`.
const FORCE: usize = 350;

/// Bytes per probe point and increment.
const PROBE: usize = 250;

/// Bytes per contact node in a table and in a picture, and for the rest of a picture.
const NODE: usize = 1000;
const PICTURE: usize = 25_000;

/// Bytes per node in the fields, and in a picture of the deformed body.
const FIELDS: usize = 400;
const DEFORMED: usize = 200;

/// Bytes per node of a plane body for the page.
const STATE: usize = 8;

/// Estimates the largest disk space of the results of a run of `scene`, bytes, within a factor of about two. The
/// largest is reached while `run.json` is written from the hidden files of the increments, which make up a third of it.
pub fn bytes_on_disk(scene: &Scene, model: &Model) -> u64 {
    let (ends, of) = (scene.time.all(), &scene.description);
    let boundaries = of.contacts.len()
        + of.supports.len()
        + of.springs.len()
        + of.loads.len()
        + of.couplings.len()
        + of.pretensions.len();
    let points = |probe: &Probe| match probe.place {
        ProbePlace::Point(_) => 1,
        ProbePlace::Line { count, .. } => count,
    };
    let probes: usize = scene.output.probes.iter().map(points).sum();
    let nodes = model.mesh.nodes.len();
    let pictures = of.contacts.len() * PICTURE + model.contact.nodes.len() * NODE;
    let fields = if scene.output.fields { nodes * FIELDS } else { 0 };
    let deformed = if scene.output.deformed { PICTURE + nodes * DEFORMED } else { 0 };
    let state = if model.mesh.dimension == 2 { nodes * STATE } else { 0 };
    let each = INCREMENT + boundaries * FORCE + probes * PROBE;
    let times = scene.output.increments(&ends).len();
    let written = times.min(MAX_STATES) * state + times * (pictures + fields + deformed);
    (ends.len() * each + written) as u64
}
