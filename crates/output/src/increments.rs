//! The comma-separated tables that grow with the increments: a line per increment, and a line per force.

use stickslip::base::UnitSystem;
use stickslip::body::Model;
use stickslip::run::report::{AppliedForce, BalanceRecord, PointRecord, SectionRecord};
use stickslip::run::report::{Columns, csv_line, csv_number};
use stickslip::run::report::{ComponentSums, ForceRecord, OnObstacle, Resultant};
use stickslip::solver::Event;
use stickslip::solver::history::IncrementRecord;

/// The first columns of the table in every version, by which a run recognises the folder of an earlier one.
pub(super) const FIRST_COLUMNS: &str = "index,time,status,iterations,backtracks,theta,";

/// The columns of energies.
const ENERGIES: [&str; 2] = ["friction_work", "strain_energy"];

/// The columns of a position.
const POSITION: [&str; 3] = ["x", "y", "z"];

/// Returns the header of the table.
pub(super) fn header() -> String {
    let kkt = ["equilibrium", "penetration", "tension", "complementarity", "cone", "dissipation"];
    let fields = [
        &kkt[..],
        &["backward_error", "open", "stick", "slip"],
        &["seconds_assembly", "seconds_factorization", "seconds_solve", "seconds_rest"],
        &["parts", "attempts", "rescued"],
        &ENERGIES,
    ];
    format!("{FIRST_COLUMNS}{}\n", fields.concat().join(","))
}

/// Formats the line of an increment.
pub(super) fn line(record: &IncrementRecord, units: &UnitSystem) -> String {
    let r = record;
    let mut fields = vec![
        r.index.to_string(),
        csv_number(r.time),
        r.status.to_string(),
        r.iterations.to_string(),
        r.backtracks.to_string(),
        csv_number(r.theta),
    ];
    fields.extend(r.kkt.components().map(|(_, value)| csv_number(value)));
    fields.push(csv_number(r.backward_error));
    fields.extend([r.contact.open, r.contact.stick, r.contact.slip].map(|count| count.to_string()));
    let s = r.seconds;
    fields.extend([s.assembly, s.factorization, s.solve, s.rest].map(|seconds| format!("{seconds:.6}")));
    fields.extend([r.parts.to_string(), r.attempts.to_string(), r.rescued.to_string()]);
    fields.extend(Columns::new(units, ENERGIES).cells([r.friction_work, r.strain_energy]));
    csv_line(&fields)
}

/// Returns the header of the table of events in this number of dimensions.
pub(super) fn events_header(dimension: usize) -> String {
    csv_line(&[&["time", "index", "node"], &POSITION[..dimension], &["from", "to"]].concat())
}

/// Formats the line of a contact node that changes its status in increment `index`.
pub(super) fn event_line(model: &Model, index: usize, event: &Event) -> String {
    let node = model.contact.nodes.get(event.node).map_or(0, |contact| contact.node);
    let position = &model.mesh.nodes[node][..model.mesh.dimension];
    let mut fields = vec![csv_number(event.time), index.to_string(), node.to_string()];
    fields.extend(Columns::new(&model.units(), POSITION).cells(position.iter().copied()));
    fields.extend([event.from.to_string(), event.to.to_string()]);
    csv_line(&fields)
}

/// Returns the header of the table of forces, for this number of dimensions, with `several` obstacles in front of a
/// boundary, and with the rotation of reference points if the scene is `coupled`.
pub(super) fn forces_header(components: usize, several: bool, coupled: bool) -> String {
    let obstacle: &[&str] = if several { &["obstacle"] } else { &[] };
    let [forces, motions] = [force_columns(components), &motion_columns(components, coupled)];
    let slip = &["slip_state", "friction_used"];
    csv_line(&[&["index", "time", "boundary"], forces, &["kind", "balance"], obstacle, motions, slip].concat())
}

/// Returns the columns of force, moment and sums of components.
fn force_columns(components: usize) -> &'static [&'static str] {
    match components {
        2 => &["f_x", "f_y", "m_z", "sum_p_n", "sum_p_t"],
        _ => &["f_x", "f_y", "f_z", "m_x", "m_y", "m_z", "sum_p_n", "sum_p_t", "sum_p_o"],
    }
}

/// Returns the columns of the mean displacement of the nodes of a support, spring or load, and of the rotation of reference
/// points if the scene is `coupled`.
fn motion_columns(components: usize, coupled: bool) -> Vec<&'static str> {
    let rotations = &["rotation_x", "rotation_y", "rotation_z"][if components == 2 { 2.. } else { 0.. }];
    [&["u_x", "u_y", "u_z"][..components], if coupled { rotations } else { &[] }].concat()
}

/// No obstacle and no slip.
const NONE: (&str, [String; 2]) = ("", [String::new(), String::new()]);

/// Formats the force lines of an increment: the forces on the obstacles in front of each boundary, on each single
/// obstacle if there are several, then the forces of supports, springs and loads on the body, the reference points, and the sections with a pretension.
pub(super) fn forces_lines(contact: &[ForceRecord], balance: &BalanceRecord, units: &UnitSystem) -> String {
    let BalanceRecord { index, time, supports, springs, loads, couplings, pretensions, balance, .. } = balance;
    let several = contact.iter().any(|record| !record.resultant.obstacles.is_empty());
    let components = units.components;
    let forces = Columns::new(units, force_columns(components).iter().copied());
    let motions = Columns::new(units, motion_columns(components, !couplings.is_empty()));
    let line = |at: &str,
                force: &[f64],
                moment: &[f64],
                [moved, turned]: [&[f64]; 2],
                sums: [Option<f64>; 3],
                kind: &str,
                (obstacle, slip): (&str, [String; 2])| {
        let padded = |x: &[f64], length: usize| (0..length).map(|k| x.get(k).copied()).collect::<Vec<_>>();
        let mut fields = vec![index.to_string(), csv_number(*time), at.to_string()];
        let moment = padded(moment, if components == 2 { 1 } else { 3 });
        fields.extend(forces.cells(force.iter().copied().map(Some).chain(moment).chain(sums)));
        fields.extend([kind.to_string(), csv_number(*balance)]);
        fields.extend(several.then(|| obstacle.to_string()));
        fields.extend(motions.cells([padded(moved, components), padded(turned, 3)].concat()));
        fields.extend(slip);
        csv_line(&fields)
    };
    let components = |sums: &ComponentSums| [Some(sums.sum_p_n), Some(sums.sum_p_t), sums.sum_p_o];
    let on_each = |at: &str, on: &OnObstacle| {
        line(at, &on.force, &on.moment, [&[]; 2], components(&on.sums), "obstacle", (&on.obstacle, NONE.1))
    };
    let on_obstacle = |record: &ForceRecord| {
        let Resultant { boundary, force, moment, sums, obstacles, opposite } = &record.resultant;
        let state = record.slip_state.map(|slip| format!("{slip:?}").to_lowercase());
        let slip = [state, record.friction_used.map(csv_number)].map(Option::unwrap_or_default);
        let all = line(boundary, force, moment, [&[]; 2], components(sums), "contact", ("", slip));
        let other_side =
            opposite.iter().map(|of| line(&of.boundary, &of.force, &of.moment, [&[]; 2], [None; 3], "opposite", NONE));
        [all].into_iter().chain(other_side).chain(obstacles.iter().map(|on| on_each(boundary, on))).collect::<String>()
    };
    let mut lines: String = contact.iter().map(on_obstacle).collect();
    for (kind, acting) in [("support", supports), ("spring", springs), ("load", loads)] {
        lines.extend(acting.iter().map(|AppliedForce { at, force, moment, displacement }| {
            line(at, force, moment, [displacement, &[]], [None; 3], kind, NONE)
        }));
    }
    lines.extend(couplings.iter().map(|PointRecord { at, force, moment, displacement, rotation }| {
        line(at, force, moment, [displacement, rotation], [None; 3], "coupling", NONE)
    }));
    lines.extend(pretensions.iter().map(|SectionRecord { at, force, moment, displacement, .. }| {
        line(at, force, moment, [displacement, &[]], [None; 3], "pretension", NONE)
    }));
    lines
}
