//! What the estimates of a run are worth, in a few states of the suite that doc/method/estimates.md tells of.

use stickslip::body::mesh::CellKind;
use stickslip_studies::estimates::{Row, Task, cantilevers, lines, pressed};

use super::program::{stdout, studies};

const PLANE: [CellKind; 2] = [CellKind::Quadrilateral, CellKind::Triangle];

fn rows(tasks: &[Task]) -> Vec<Row> {
    tasks.iter().flat_map(|task| task.rows().unwrap()).collect()
}

/// From three nodes across on the estimate of the peak is above its error, wherever in an element the apex is.
#[test]
fn peaks_are_within_their_estimates() {
    let rows = rows(&lines(&PLANE, &[4], &[2e-6, 1e-5]));
    assert_eq!(rows.len(), 12);
    for row in rows.iter().filter(|row| row.across >= 3) {
        assert!(row.error.abs() < row.estimate, "{row:?}");
    }
}

/// Elements that make a body too stiff by more than 5 % are told, by a number within three times of that up to 300 %.
#[test]
fn locking_is_within_its_estimate() {
    let pressed = rows(&pressed(&PLANE, &[0.3, 0.49], &[4, 8], 32));
    let bent = rows(&cantilevers(&PLANE[..1], &[0.3, 0.45], &[2, 4], 8));
    assert_eq!((pressed.len(), bent.len()), (8, 4));
    for row in pressed.iter().chain(&bent) {
        if row.error > 0.05 && row.error < 3.0 {
            assert!((row.error / 3.0..3.0 * row.error).contains(&row.estimate), "{row:?}");
        }
        assert!(row.error > 0.01 || row.estimate < 0.03, "{row:?}");
    }
}

#[test]
fn the_program_says_so() {
    let output = studies(&["estimates", "--only", "line, quadrilateral 4", "--csv"]);
    assert_eq!(output.status.code(), Some(0));
    let text = stdout(&output);
    assert!(text.starts_with("subject,cells,poisson,across,error,estimate\nline,quadrilateral,0.3,"), "{text}");
    let none = studies(&["estimates", "--only", "nothing of the kind"]);
    assert_eq!(none.status.code(), Some(2));
}
