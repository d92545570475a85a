//! What the results of a run take on the disk, estimated before it.

use stickslip::body::description::{Probe, ProbePlace};
use stickslip::body::model::Model;
use stickslip::scene::Scene;

/// The record of an increment, in its hidden file and in `run.json`, and its line in `increments.csv`, bytes.
const INCREMENT: usize = 1400;

/// The force on a boundary in an increment, in the same files and in `forces.csv`.
const FORCE: usize = 350;

/// A probe point in an increment.
const PROBE: usize = 250;

/// A contact node in a table and in a picture, and what any picture has.
const NODE: usize = 1000;
const PICTURE: usize = 25_000;

/// A node in the fields, and in a picture of the deformed body.
const FIELDS: usize = 400;
const DEFORMED: usize = 200;

/// The most that the results of a run of `scene` take on the disk, bytes: while `run.json` is made of what the increments have left in hidden files,
/// which are a third of it. It is good to a factor of two or so.
pub fn bytes_on_disk(scene: &Scene, model: &Model) -> u64 {
    let (ends, of) = (scene.time.all(), &scene.description);
    let boundaries = of.contacts.len() + of.supports.len() + of.springs.len() + of.loads.len();
    let points = |probe: &Probe| match probe.place {
        ProbePlace::Point(_) => 1,
        ProbePlace::Line { count, .. } => count,
    };
    let probes: usize = scene.output.probes.iter().map(points).sum();
    let nodes = model.mesh.nodes.len();
    let pictures = of.contacts.len() * PICTURE + model.contacts.len() * NODE;
    let fields = if scene.output.fields { nodes * FIELDS } else { 0 };
    let deformed = if scene.output.deformed { PICTURE + nodes * DEFORMED } else { 0 };
    let each = INCREMENT + boundaries * FORCE + probes * PROBE;
    let written = scene.output.increments(&ends).len() * (pictures + fields + deformed);
    (ends.len() * each + written) as u64
}
