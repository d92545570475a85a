//! Bodies where contact between them is incomplete.

use super::prelude::*;
use crate::body::contact::Passed;
use crate::body::mesh::Boundary;
use crate::body::model::Pair;

kinds! {
    /// More than 5 % of a contact force is on slave nodes beyond the end of the master (less than half covered). A body
    /// may seem to rest where it would tip.
    BEYOND_THE_END("beyond-the-end", "Exchange the sides, or put nodes where the other body ends.", "never");
    /// A node entered another body without a contact there, by more than 2 % of what the bodies deform; beside a contact,
    /// a given `gap` counts.
    PASSED_THROUGH("passed-through", "Define a `[[contact]]`, or a longer `search`.", "never");
}

/// The share of the force on nodes beyond the end above which a warning is given.
const BEYOND: f64 = 0.05;

/// Warns of the pair with the largest share of its normal force on nodes beyond the end of the other body.
///
/// The row of such a node extrapolates the displacement of the other body beyond its end: it presses the nodes at the
/// end with more than the whole force and pulls the nodes behind them.
pub(super) fn beyond_the_end(model: &Model, step: &IncrementView<'_>) -> Option<(f64, Warning)> {
    let share = |k: usize| {
        let (mut all, mut outside) = (0.0, 0.0);
        for (contact, p_n) in model.contact.nodes.iter().zip(&step.state.p_n) {
            let Some(coupled) = contact.coupled().filter(|coupled| coupled.pair == k) else { continue };
            all += p_n;
            outside += if coupled.beyond_the_end { *p_n } else { 0.0 };
        }
        (if all > 0.0 { outside / all } else { 0.0 }, &model.contact.pairs[k])
    };
    let largest = (0..model.contact.pairs.len()).map(share).max_by(|a, b| a.0.total_cmp(&b.0));
    let (share, pair) = largest.filter(|(share, _)| *share > BEYOND)?;
    let (time, slave, master) = (six_digits(step.record.time), &pair.slave, &pair.master.name);
    let cure = if pair.mortar.overhangs()[1] {
        format!("give the mesh of `{slave}` nodes where `{master}` ends, or smaller elements there")
    } else {
        format!("make `{master}` the slave, or the elements of `{slave}` smaller there")
    };
    let warning = WarningKind::BEYOND_THE_END.warning(format!(
        "at t = {time} s {:.0} % of the force of `{slave}` on `{master}` is on nodes beyond the end of `{master}`, \
         which also pull at its inner nodes; {cure}",
        100.0 * share
    ));
    Some((share, warning))
}

/// Warns of the node deepest inside another body.
pub(super) fn passed_through(model: &Model, step: &IncrementView<'_>) -> Option<(f64, Warning)> {
    let time = six_digits(step.record.time);
    let Passed { node, bodies, depth: of_depth, apart } =
        model.passed(&model.displaced(step.record.time, &step.state.u))?;
    let (units, all) = (model.units(), model.mesh.bodies());
    let of = all.of_nodes();
    let [depth, apart] = [of_depth, apart].map(|x| units.rounded(Quantity::Length, x, 3));
    let place = units.point(model.mesh.nodes[node]);
    let nodes_of = |name: &str| model.mesh.boundary(name).map_or(Vec::new(), Boundary::nodes);
    let is_between = |pair: &&Pair| {
        let (slave, master) = (nodes_of(&pair.slave), pair.master.nodes());
        let faces =
            |own: &[usize], other: &[usize]| own.contains(&node) && other.iter().any(|&node| of[node] == bodies[1]);
        faces(&slave, &master) || faces(&master, &slave)
    };
    let message = if let Some(pair) = model.contact.pairs.iter().find(is_between) {
        let search = units.rounded(Quantity::Length, pair.mortar.search, 3);
        format!(
            "at t = {time} s the node at {place} is {depth} inside the other side of `{}` against `{}`, and no \
             contact stops it: nothing was in front of it within the search distance of {search}, and it was \
             {apart} away; set contact[{}].search larger than every gap that closes",
            pair.slave, pair.master.name, pair.contact
        )
    } else {
        format!(
            "at t = {time} s the node at {place} of {} is {depth} inside {}, and no contact stops it; define a \
             [[contact]] with `against` between the boundaries of the two there",
            all.label(bodies[0]),
            all.label(bodies[1])
        )
    };
    Some((of_depth, WarningKind::PASSED_THROUGH.warning(message)))
}
