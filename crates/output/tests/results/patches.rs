//! Pressures of nodes and of patches on irregular tetrahedra. doc/method/estimates.md has the figures, which `--nocapture`
//! prints.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use crate::common::hertz::Hertz;
use crate::common::random::Random;
use std::ops::ControlFlow;
use stickslip::body::fem::Material;
use stickslip::body::mesh::{CellKind, Mesh, MeshSource};
use stickslip::body::{Axis, Description, Model, PeakOf};
use stickslip::body::{Obstacle, Place, Shape};
use stickslip::run::Run;
use stickslip::run::report::{ContactLine, RunReport, WarningKind};
use stickslip::solver::history::{IncrementView, Method, Observer, SolverChoice, Status};
use stickslip_output::fields;

const YOUNG: f64 = 210e9;
const NU: f64 = 0.3;
const RADIUS: f64 = 100.0;
/// The size of the region with uniform elements, m.
const REACH: f64 = 0.06;
const SIZE: f64 = 2.0;

/// Returns half of a slab in plane strain with `n` elements in [`REACH`]. Its inner nodes, and those inside the
/// contact, are moved by up to a quarter of an element.
fn slab(n: usize, kind: CellKind) -> Mesh {
    let thickness = 6.0 * REACH / n as f64;
    let grading = 12.0 * n as f64;
    let source = MeshSource::segmented(
        &[vec![REACH, SIZE - REACH], vec![thickness], vec![SIZE]],
        &[vec![n, 12], vec![6], vec![14]],
        Some(&[vec![1.0, grading], vec![1.0], vec![1.0 / grading]]),
        None,
    );
    let mut mesh = (*source.unwrap().build().unwrap()).clone();
    let bounds = mesh.bounds();
    // The nearest nodes along each axis, in the block before nodes are moved.
    let lines: [Vec<f64>; 3] = [0, 1, 2].map(|c| {
        let mut line: Vec<f64> = mesh.nodes.iter().map(|x| x[c]).collect();
        line.sort_by(f64::total_cmp);
        line.dedup();
        line
    });
    let mut random = Random(7);
    for x in &mut mesh.nodes {
        for c in 0..3 {
            let (place, line) = (lines[c].iter().position(|y| *y == x[c]).unwrap(), &lines[c]);
            let inside = x[c] > bounds[c].0 && x[c] < bounds[c].1;
            let by = 0.25 * random.sign();
            if inside {
                x[c] += by * (line[place + 1] - line[place]).min(line[place] - line[place - 1]);
            }
        }
    }
    let mesh = mesh.into_simplices();
    if kind.is_quadratic() { mesh.into_second_order() } else { mesh }
}

/// Observer that keeps the last contact line, and the fields.
struct Last<'a>(&'a Model, Option<ContactLine>, Vec<&'static str>);

impl Observer for Last<'_> {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        self.1 = ContactLine::all(self.0, step).pop();
        self.2 = fields(self.0, step).point_fields.iter().map(|field| field.name).collect();
        ControlFlow::Continue(())
    }
}

fn pressed(n: usize, kind: CellKind, approach: f64) -> (RunReport, ContactLine, Vec<&'static str>) {
    let cylinder = Shape::Cylinder {
        radius: RADIUS,
        place: Place::Apex([0.0, 0.0, SIZE].into()),
        axis: Some([0.0, 1.0, 0.0].into()),
    };
    let body = Description::new(MeshSource::Given(slab(n, kind).into()), Material::new(YOUNG, NU), vec![1.0])
        .support("bottom", &[Axis::X, Axis::Y, Axis::Z])
        .support("left", &[Axis::X])
        .support("front", &[Axis::Y])
        .support("back", &[Axis::Y])
        .contact("top", 0.0, Obstacle::at_rest(cylinder).approaching(&[[0.0, 0.0], [1.0, approach]]));
    let model = Model::build(&body).unwrap();
    let mut last = Last(&model, None, Vec::new());
    let report = Run::of(&model, vec![1.0], SolverChoice::new(Method::BN)).unwrap().solve(&mut last).unwrap();
    assert_eq!(report.status, Status::Converged, "{}", report.explanation.reason);
    (report, last.1.unwrap(), last.2)
}

/// On linear tetrahedra the pressures of nodes scatter, and those of patches do not. From five nodes across on, patches
/// give the peak. Below that neither does.
#[test]
fn patches_are_the_peak_on_tetrahedra() {
    patches_are_the_peak(CellKind::Tetrahedron, &[(4, 2e-5), (5, 2e-5), (5, 5e-5)]);
    patches_are_the_peak(CellKind::Tetrahedron10, &[(4, 2e-5)]);
}

#[test]
#[ignore = "a minute without optimisation"]
fn patches_are_the_peak_on_fine_tetrahedra() {
    patches_are_the_peak(CellKind::Tetrahedron, &[(8, 5e-5)]);
}

/// Checks each state, given by a number of cells per side and an approach (m).
fn patches_are_the_peak(kind: CellKind, states: &[(usize, f64)]) {
    for &(n, approach) in states {
        let (report, line, fields) = pressed(n, kind, approach);
        let contact = &report.estimates.contact[0];
        let thickness = 6.0 * REACH / n as f64;
        let hertz = Hertz::line(2.0 * contact.force / thickness, RADIUS, YOUNG / (1.0 - NU * NU));
        let [nodes, patches] = [contact.peak_pressure, contact.patch_pressure].map(|peak| peak / hertz.p0 - 1.0);
        let across = contact.nodes_across.unwrap();
        println!(
            "{kind:?} {n}, a/h {:.1}, {across} across: nodes {:.1} %, patches {:.1} %, said {:.1} %",
            hertz.a * n as f64 / REACH,
            100.0 * nodes,
            100.0 * patches,
            100.0 * contact.peak_error.unwrap()
        );
        // The column and the field agree with the estimate.
        let column = line.points.iter().map(|point| point.sigma_patch.unwrap()).fold(0.0, f64::max);
        assert!((column / contact.patch_pressure - 1.0).abs() < 1e-12);
        assert!(line.to_csv().lines().next().unwrap().contains("sigma_o,sigma_patch,w_n"));
        assert!(fields.contains(&"patch_pressure"));
        let largest = report.largest_pressure.as_ref().unwrap();
        assert_eq!(largest.peak_of, contact.peak_of);
        let expected = match kind {
            CellKind::Tetrahedron if across < 5 => None,
            CellKind::Tetrahedron => Some((PeakOf::Patches, contact.patch_pressure)),
            _ => Some((PeakOf::Nodes, contact.peak_pressure)),
        };
        assert_eq!(largest.peak_of, expected.map(|(of, _)| of));
        assert_eq!(largest.pressure.is_some(), expected.is_some());
        if let (Some(pressure), Some((_, peak))) = (largest.pressure, expected) {
            assert!((pressure / peak - 1.0).abs() < 1e-9, "{pressure} {peak}");
        }
        if across >= 5 {
            let [best, other] = if kind.is_quadratic() { [nodes, patches] } else { [patches, nodes] };
            assert!(best.abs() < 0.09 && best.abs() < 0.6 * other.abs(), "{kind:?} {n}: {nodes} {patches}");
        }
        let scattered = report.warnings.iter().any(|warning| warning.kind == WarningKind::PEAK_SCATTER);
        assert_eq!(scattered, across >= 5 && !kind.is_quadratic());
    }
}
