//! The comma-separated tables that grow with the increments: a line per increment, and a line per force.

use stickslip::base::UnitSystem;
use stickslip::body::Model;
use stickslip::run::report::Column;
use stickslip::run::report::{AppliedForce, BalanceRecord, PointRecord, SectionRecord};
use stickslip::run::report::{ComponentSums, ForceRecord, OnObstacle, Resultant};
use stickslip::run::report::{csv_line, csv_number, csv_table};
use stickslip::solver::Event;
use stickslip::solver::history::IncrementRecord;

/// The columns of energies, J.
const ENERGIES: [Column; 2] = Column::all(["friction_work", "strain_energy"]).expect("columns with known quantities");

/// The columns of a position, m.
const POSITION: [Column; 3] = Column::all(["x", "y", "z"]).expect("columns with known quantities");

/// The first columns of the table in every version, by which a run recognises the folder of an earlier one.
pub(super) const FIRST_COLUMNS: &str = "index,time,status,iterations,backtracks,theta,";

/// Returns the header of the table.
pub(super) fn header() -> String {
    let kkt = ["equilibrium", "penetration", "tension", "complementarity", "cone", "dissipation"];
    let fields = [
        &kkt[..],
        &["backward_error", "open", "stick", "slip"],
        &["seconds_assembly", "seconds_factorization", "seconds_solve", "seconds_rest"],
        &["parts", "attempts", "rescued", "friction_work", "strain_energy"],
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
    fields.extend(ENERGIES.iter().zip([r.friction_work, r.strain_energy]).map(|(column, x)| column.cell(units, x)));
    csv_line(&fields)
}

/// Returns the header of the table of events in this number of dimensions.
pub(super) fn events_header(dimension: usize) -> String {
    csv_table(
        &[&["time", "index", "node"], &["x", "y", "z"][..dimension], &["from", "to"]].concat(),
        std::iter::empty(),
    )
}

/// Formats the line of a contact node that changes its status in increment `index`.
pub(super) fn event_line(model: &Model, index: usize, event: &Event) -> String {
    let node = model.contact.nodes.get(event.node).map_or(0, |contact| contact.node);
    let position = &model.mesh.nodes[node][..model.mesh.dimension];
    let mut fields = vec![csv_number(event.time), index.to_string(), node.to_string()];
    fields.extend(POSITION.iter().zip(position).map(|(column, x)| column.cell(&model.units(), *x)));
    fields.extend([event.from.to_string(), event.to.to_string()]);
    csv_line(&fields)
}

/// Returns the header of the table of forces, for this number of dimensions, with `several` obstacles in front of a
/// boundary, and with the rotation of reference points if the scene is `coupled`.
pub(super) fn forces_header(dimension: usize, several: bool, coupled: bool) -> String {
    let obstacle: &[&str] = if several { &["obstacle"] } else { &[] };
    let forces: Vec<&str> = force_columns(dimension).iter().map(|column| column.name()).collect();
    let moved = DISPLACEMENT[..dimension].iter().map(|column| column.name()).collect::<Vec<_>>();
    let turned = rotation_columns(dimension).iter().map(|column| column.name());
    let turned: Vec<&str> = turned.filter(|_| coupled).collect();
    let header =
        [&["index", "time", "boundary"], &forces[..], &["kind", "balance"], obstacle, &moved, &turned].concat();
    csv_table(&header, std::iter::empty())
}

/// Returns the columns of force, moment and sums of components.
fn force_columns(dimension: usize) -> &'static [Column] {
    const PLANE: &[Column] =
        &Column::all(["f_x", "f_y", "m_z", "sum_p_n", "sum_p_t"]).expect("columns with known quantities");
    const SPACE: &[Column] = &Column::all(["f_x", "f_y", "f_z", "m_x", "m_y", "m_z", "sum_p_n", "sum_p_t", "sum_p_o"])
        .expect("columns with known quantities");
    if dimension == 2 { PLANE } else { SPACE }
}

/// The columns of the mean displacement of the nodes of a support, spring or load.
const DISPLACEMENT: [Column; 3] = Column::all(["u_x", "u_y", "u_z"]).expect("columns with known quantities");

/// Returns the columns of the rotation of reference points.
fn rotation_columns(dimension: usize) -> &'static [Column] {
    const ALL: &[Column] =
        &Column::all(["rotation_x", "rotation_y", "rotation_z"]).expect("columns with known quantities");
    if dimension == 2 { &ALL[2..] } else { ALL }
}

/// Formats the force lines of an increment: the forces on the obstacles in front of each boundary, on each single
/// obstacle if there are several, then the forces of supports, springs and loads on the body, the reference points, and the sections with a pretension.
pub(super) fn forces_lines(contact: &[ForceRecord], balance: &BalanceRecord, units: &UnitSystem) -> String {
    let BalanceRecord { index, time, supports, springs, loads, couplings, pretensions, balance, .. } = balance;
    let several = contact.iter().any(|record| !record.resultant.obstacles.is_empty());
    let turning = if couplings.is_empty() { 0 } else { usize::MAX };
    let line = |at: &str,
                force: &[f64],
                moment: &[f64],
                moved: [&[f64]; 2],
                sums: [Option<f64>; 3],
                kind: &str,
                obstacle: &str| {
        let numbers = force.iter().chain(moment).copied().map(Some).chain(sums);
        let numbers = force_columns(force.len()).iter().zip(numbers);
        let mut fields = vec![index.to_string(), csv_number(*time), at.to_string()];
        fields.extend(numbers.map(|(column, x)| x.map_or(String::new(), |x| column.cell(units, x))));
        fields.extend([kind.to_string(), csv_number(*balance)]);
        fields.extend(several.then(|| obstacle.to_string()));
        let [moved, turned] = moved;
        let cell = |column: &Column, u: Option<&f64>| u.map_or(String::new(), |u| column.cell(units, *u));
        let displaced = DISPLACEMENT[..force.len()].iter().enumerate();
        fields.extend(displaced.map(|(k, column)| cell(column, moved.get(k))));
        let rotated = rotation_columns(force.len()).iter().take(turning).enumerate();
        fields.extend(rotated.map(|(k, column)| cell(column, turned.get(k))));
        csv_line(&fields)
    };
    let components = |sums: &ComponentSums| [Some(sums.sum_p_n), Some(sums.sum_p_t), sums.sum_p_o];
    let on_each = |at: &str, on: &OnObstacle| {
        line(at, &on.force, &on.moment, [&[]; 2], components(&on.sums), "obstacle", &on.obstacle)
    };
    let on_obstacle = |record: &ForceRecord| {
        let Resultant { boundary, force, moment, sums, obstacles, opposite } = &record.resultant;
        let all = line(boundary, force, moment, [&[]; 2], components(sums), "contact", "");
        let other_side =
            opposite.iter().map(|of| line(&of.boundary, &of.force, &of.moment, [&[]; 2], [None; 3], "opposite", ""));
        [all].into_iter().chain(other_side).chain(obstacles.iter().map(|on| on_each(boundary, on))).collect::<String>()
    };
    let mut lines: String = contact.iter().map(on_obstacle).collect();
    for (kind, acting) in [("support", supports), ("spring", springs), ("load", loads)] {
        lines.extend(acting.iter().map(|AppliedForce { at, force, moment, displacement }| {
            line(at, force, moment, [displacement, &[]], [None; 3], kind, "")
        }));
    }
    lines.extend(couplings.iter().map(|PointRecord { at, force, moment, displacement, rotation }| {
        line(at, force, moment, [displacement, rotation], [None; 3], "coupling", "")
    }));
    lines.extend(pretensions.iter().map(|SectionRecord { at, force, moment, displacement, .. }| {
        line(at, force, moment, [displacement, &[]], [None; 3], "pretension", "")
    }));
    lines
}
