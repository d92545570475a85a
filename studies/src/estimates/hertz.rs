//! Cylinders and spheres on bodies that are large beside the contact, with the apex anywhere in an element.

use super::{EstimateError, Row, Subject, Task, solved};
use std::f64::consts::PI;
use stickslip::body::fem::Material;
use stickslip::body::mesh::{CellKind, MeshSource};
use stickslip::body::{Axis, Description};
use stickslip::body::{Obstacle, Place, Shape};

const YOUNG: f64 = 210e9;
const NU: f64 = 0.3;
const MODULUS: f64 = YOUNG / (1.0 - NU * NU);
const RADIUS: f64 = 100.0;
/// Elements have one size so far to each side of the apex, m, and more of it than the contact.
const REACH: f64 = 0.06;
/// The size of the body, m.
const SIZE: f64 = 2.0;
/// Where in an element the apex is, as a share of its size from a node.
const PLACES: [f64; 3] = [0.0, 0.25, 0.5];

/// The peak under a cylinder, with so many elements in `REACH`, and approaches (m).
pub fn lines(kinds: &[CellKind], elements: &[usize], approaches: &[f64]) -> Vec<Task> {
    let each = kinds.iter().flat_map(|&kind| elements.iter().map(move |&n| (kind, n)));
    each.map(|(kind, n)| {
        let approaches = approaches.to_vec();
        Task {
            name: format!("line, {} {n}", kind.name()),
            work: Box::new(move || {
                let states = PLACES.iter().flat_map(|&place| approaches.iter().map(move |&approach| (place, approach)));
                states.filter_map(|(place, approach)| line(kind, n, place, approach).transpose()).collect()
            }),
        }
    })
    .collect()
}

/// A cylinder on a block; none where it reaches beyond the fine elements.
fn line(kind: CellKind, n: usize, place: f64, approach: f64) -> Result<Option<Row>, EstimateError> {
    let grading = 3.0 * n as f64;
    // Cells of second order have a node in the middle of each element.
    let (across, outside) = if kind.is_quadratic() { (n / 2, 12) } else { (n, 24) };
    let mesh = MeshSource::segmented(
        &[vec![SIZE - REACH, 2.0 * REACH, SIZE - REACH], vec![SIZE]],
        &[vec![outside, 2 * across, outside], vec![outside + n / 4]],
        Some(&[vec![1.0 / grading, 1.0, grading], vec![0.3 / grading]]),
        Some(kind),
    )?;
    let apex = [SIZE + place * REACH / n as f64, SIZE];
    let cylinder = Shape::Cylinder { radius: RADIUS, place: Place::Apex(apex.into()), axis: None };
    let body = Description::new(mesh, Material::new(YOUNG, NU), vec![1.0])
        .support("bottom", &[Axis::X, Axis::Y])
        .contact("top", 0.0, Obstacle::at_rest(cylinder).approaching(&[[0.0, 0.0], [1.0, approach]]));
    let report = solved(&body)?;
    let contact = &report.estimates.contact[0];
    let half_width = (4.0 * contact.force * RADIUS / (PI * MODULUS)).sqrt();
    let exact = 2.0 * contact.force / (PI * half_width);
    Ok((half_width < 0.9 * REACH).then(|| Row {
        subject: Subject::Line,
        kind,
        poisson: NU,
        across: contact.nodes_across.unwrap_or(0),
        error: contact.peak_pressure / exact - 1.0,
        estimate: contact.peak_error.unwrap_or(f64::NAN),
        warned: None,
    }))
}

/// The peak under a sphere, by a quarter of the body.
pub fn spheres(kinds: &[CellKind], elements: &[usize], approaches: &[f64]) -> Vec<Task> {
    let each = kinds.iter().flat_map(|&kind| elements.iter().map(move |&n| (kind, n)));
    each.map(|(kind, n)| {
        let approaches = approaches.to_vec();
        Task {
            name: format!("sphere, {} {n}", kind.name()),
            work: Box::new(move || {
                approaches.iter().filter_map(|&approach| sphere(kind, n, approach).transpose()).collect()
            }),
        }
    })
    .collect()
}

fn sphere(kind: CellKind, n: usize, approach: f64) -> Result<Option<Row>, EstimateError> {
    let (size, grading) = (10.0 * REACH, 1.5 * n as f64);
    let axis = || (vec![REACH, size - REACH], vec![n, 7], vec![1.0, grading]);
    let (sizes, counts, gradings): (Vec<_>, Vec<_>, Vec<_>) = (axis().0, axis().1, axis().2);
    let mesh = MeshSource::segmented(
        &[sizes.clone(), sizes, vec![size]],
        &[counts.clone(), counts, vec![7 + n / 2]],
        Some(&[gradings.clone(), gradings, vec![0.3 / grading]]),
        Some(kind),
    )?;
    let sphere = Shape::Sphere { radius: RADIUS, place: Place::Apex([0.0, 0.0, size].into()) };
    let body = Description::new(mesh, Material::new(YOUNG, NU), vec![1.0])
        .support("bottom", &[Axis::X, Axis::Y, Axis::Z])
        .support("left", &[Axis::X])
        .support("front", &[Axis::Y])
        .contact("top", 0.0, Obstacle::at_rest(sphere).approaching(&[[0.0, 0.0], [1.0, approach]]));
    let report = solved(&body)?;
    let contact = &report.estimates.contact[0];
    let force = 4.0 * contact.force;
    let radius = (0.75 * force * RADIUS / MODULUS).cbrt();
    let exact = 1.5 * force / (PI * radius * radius);
    Ok((radius < 0.9 * REACH).then(|| Row {
        subject: Subject::Sphere,
        kind,
        poisson: NU,
        across: contact.nodes_across.unwrap_or(0),
        error: contact.peak_pressure / exact - 1.0,
        estimate: contact.peak_error.unwrap_or(f64::NAN),
        warned: None,
    }))
}
