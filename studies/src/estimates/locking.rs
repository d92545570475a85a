//! Blocks that are clamped and pressed, and beams that are clamped and bent, against fine meshes with B-bar.

use super::{EstimateError, Row, Subject, Task, solved};
use stickslip::base::Field;
use stickslip::body::Obstacle;
use stickslip::body::fem::{Element, Material};
use stickslip::body::mesh::{CellKind, MeshSource};
use stickslip::body::{Action, Axis, Description};

const YOUNG: f64 = 1e9;

/// What is done to a body of `d` dimensions.
#[derive(Clone, Copy)]
struct Loaded {
    subject: Subject,
    d: usize,
    poisson: f64,
}

impl Loaded {
    /// The stiffness with `m` elements across, and what the run says of it.
    fn stiffness(self, kind: Option<CellKind>, element: Element, m: usize) -> Result<(f64, f64), EstimateError> {
        let axes = &[Axis::X, Axis::Y, Axis::Z][..self.d];
        let body = |sizes: Vec<Vec<f64>>, counts: Vec<Vec<usize>>| {
            let mesh = MeshSource::segmented(&sizes, &counts, None, kind)?;
            let body = Description::new(mesh, Material::new(YOUNG, self.poisson), vec![1.0]);
            Ok::<_, EstimateError>(body.element(element))
        };
        if self.subject == Subject::Cantilever {
            // Eight times as long as it is high.
            let along = |c: usize| if c == 0 { 8 } else { 1 };
            let sizes = (0..self.d).map(|c| vec![along(c) as f64]).collect();
            let counts = (0..self.d).map(|c| vec![along(c) * m]).collect();
            let down = |c: usize| Field::Uniform(if c + 1 == self.d { -1e3 } else { 0.0 });
            let traction = (0..self.d).map(down).collect();
            let action = Action::Traction { boundary: "right".to_string(), traction };
            let report = solved(&body(sizes, counts)?.support("left", axes).load(action.into()))?;
            let energy = report.increments[0].strain_energy;
            return Ok((1.0 / energy, report.estimates.locking.unwrap_or(0.0)));
        }
        let plane = Obstacle::plane(0.0).approaching(&[[0.0, 0.0], [1.0, 1e-3]]);
        let block = body(vec![vec![1.0]; self.d], vec![vec![m]; self.d])?;
        let report = solved(&block.support("bottom", axes).contact("top", 1e6, plane))?;
        Ok((report.estimates.contact[0].force, report.estimates.locking.unwrap_or(0.0)))
    }

    fn rows(self, kinds: &[CellKind], sizes: &[usize], fine: usize) -> Result<Vec<Row>, EstimateError> {
        let (coarse, _) = self.stiffness(None, Element::BBar, fine / 2)?;
        let (best, _) = self.stiffness(None, Element::BBar, fine)?;
        // The corners make the error one of first order.
        let exact = 2.0 * best - coarse;
        let mut rows = Vec::new();
        for &kind in kinds {
            for &m in sizes {
                let (stiffness, estimate) = self.stiffness(Some(kind), Element::Bilinear, m)?;
                let Loaded { subject, poisson, .. } = self;
                rows.push(Row {
                    subject,
                    kind,
                    poisson,
                    across: m,
                    error: stiffness / exact - 1.0,
                    estimate,
                    warned: None,
                });
            }
        }
        Ok(rows)
    }
}

fn tasks(subject: Subject, kinds: &[CellKind], ratios: &[f64], sizes: &[usize], fine: usize) -> Vec<Task> {
    let Some(d) = kinds.first().map(|kind| kind.dimension()) else { return Vec::new() };
    let task = |&poisson: &f64| {
        let (kinds, sizes) = (kinds.to_vec(), sizes.to_vec());
        let loaded = Loaded { subject, d, poisson };
        Task { name: format!("{subject}, nu = {poisson}"), work: Box::new(move || loaded.rows(&kinds, &sizes, fine)) }
    };
    ratios.iter().map(task).collect()
}

/// Blocks, clamped below and pressed by a plane on which nothing slips, with so many elements across, against `fine` ones; `kinds` of one
/// dimension, and Poisson's `ratios`.
pub fn pressed(kinds: &[CellKind], ratios: &[f64], sizes: &[usize], fine: usize) -> Vec<Task> {
    tasks(Subject::Pressed, kinds, ratios, sizes, fine)
}

/// Beams, clamped at one end and bent by a shear force at the other, as above.
pub fn cantilevers(kinds: &[CellKind], ratios: &[f64], sizes: &[usize], fine: usize) -> Vec<Task> {
    tasks(Subject::Cantilever, kinds, ratios, sizes, fine)
}
