//! Convergence of the mesh error with mesh size and with CPU time, for each kind of elements, beside the estimates of
//! each mesh alone.

use super::{Comparison, ElementChoice, MeshErrors, MeshResult};
use crate::study::curve;
use stickslip::run::report::Estimates;
use stickslip_output::{Axis, Chart, Curve, Dash, Line, Panel, Scale};

/// A measure of the mesh error.
struct Measure {
    /// The name of the quantity.
    name: &'static str,
    error: fn(&MeshErrors) -> f64,
    /// The estimate of this error by the mesh alone.
    estimate: Option<fn(&Estimates) -> Option<f64>>,
    /// The errors for which the cheapest mesh is reported.
    targets: [f64; 2],
}

const MEASURES: [Measure; 4] = [
    Measure { name: "normal force", error: |errors| errors.sum_p_n, estimate: None, targets: [1e-2, 1e-3] },
    Measure {
        name: "energy norm",
        error: MeshErrors::norm,
        estimate: Some(|estimates| estimates.discretisation),
        targets: [1e-1, 1e-2],
    },
    Measure { name: "tractions", error: |errors| errors.tractions, estimate: None, targets: [1e-1, 1e-2] },
    Measure {
        name: "peak pressure",
        error: |errors| errors.peak,
        estimate: Some(|estimates| estimates.peak_error),
        targets: [1e-1, 1e-2],
    },
];

/// Describes the cheapest mesh for each error; only if elements are compared.
pub(super) fn answers(comparison: &Comparison) -> Vec<String> {
    let answer = |measure: &Measure, target: f64| {
        let name = measure.name;
        let head = format!("Mesh for an error of {target:.0e} in the {name}:");
        let known = || {
            let of = |result: &MeshResult| {
                Some(((measure.error)(result.errors.as_ref()?), comparison.seconds(&result.mesh)?))
            };
            comparison.meshes.iter().filter_map(move |result| Some((result, of(result)?)))
        };
        // A coarse mesh may be accurate by chance. It counts only if all finer meshes reach the error too.
        let holds = |result: &MeshResult| {
            let finer = |(other, _): &(&MeshResult, (f64, f64))| {
                other.mesh.elements == result.mesh.elements && other.displacements >= result.displacements
            };
            known().filter(finer).all(|(_, (error, _))| error <= target)
        };
        let near = known().filter(|(result, _)| holds(result));
        let best = known().min_by(|a, b| a.1.0.total_cmp(&b.1.0));
        match (near.min_by(|a, b| a.1.1.total_cmp(&b.1.1)), best) {
            (Some((MeshResult { mesh, displacements, .. }, (error, seconds))), _) => format!(
                "{head} the cheapest is {mesh}, {displacements} displacements, {seconds:.2e} s (error {error:.2e}), and finer ones keep it."
            ),
            (None, Some((MeshResult { mesh, .. }, (error, _)))) => {
                format!("{head} none keeps it as it gets finer; the nearest is {mesh} with {error:.2e}.")
            }
            (None, None) => format!("{head} there is nothing to compare with."),
        }
    };
    // Without contact there are no contact forces or pressures to compare.
    let there = |measure: &&Measure| {
        let errors = comparison.meshes.iter().filter_map(|result| result.errors.as_ref());
        errors.map(measure.error).any(|error| error > 0.0)
    };
    let answers = MEASURES.iter().filter(there);
    answers.flat_map(|measure| measure.targets.map(|target| answer(measure, target))).collect()
}

/// Returns the charts: errors against the number of displacements and against CPU time.
pub(super) fn charts(comparison: &Comparison) -> Vec<(&'static str, &'static str, Chart)> {
    let displacements = |result: &MeshResult| Some(result.displacements as f64);
    let seconds = |result: &MeshResult| comparison.seconds(&result.mesh);
    vec![
        ("mesh-size", "Error of the mesh against its size", chart(comparison, "displacements", &displacements)),
        ("mesh-time", "Error of the mesh against CPU time", chart(comparison, "CPU time, s", &seconds)),
    ]
}

fn chart(comparison: &Comparison, label: &str, x: &dyn Fn(&MeshResult) -> Option<f64>) -> Chart {
    let of_kind = |measure: &Measure, k: usize, elements: Option<ElementChoice>| {
        let points = |y: &dyn Fn(&MeshResult) -> Option<f64>| {
            let of_kind = comparison.meshes.iter().filter(|result| result.mesh.elements == elements);
            let y = |result| Some(y(result).filter(|y| y.is_finite() && *y > 0.0)?.max(comparison.tolerance));
            let point = |result| Some([x(result)?, y(result)?]);
            of_kind.filter_map(point).collect::<Vec<_>>()
        };
        let name = elements.map_or("the scene's elements".to_string(), |elements| elements.to_string());
        let errors = points(&|result| Some((measure.error)(result.errors.as_ref()?)));
        let estimates = points(&|result| measure.estimate?(result.estimates.as_ref()?));
        let line = Some(Line { dash: Dash::Dashed, width: 1.2 });
        [curve(k, name, errors), Curve { line, marker: None, ..curve(k, String::new(), estimates) }]
    };
    let panel = |measure: &Measure| {
        let kinds = comparison.elements().into_iter().enumerate();
        let curves = kinds.flat_map(|(k, elements)| of_kind(measure, k, elements));
        let curves = curves.filter(|curve| !curve.points.is_empty()).collect();
        Panel { title: measure.name.into(), curves, ..Panel::default() }
    };
    let finest = comparison.meshes.last().map_or(String::new(), |result| result.mesh.to_string());
    Chart {
        title: comparison.title.clone(),
        subtitle: format!(
            "distance to {finest}; dashed: what a mesh estimates by itself; below the tolerance, {:.0e}, drawn at it",
            comparison.tolerance
        ),
        x: Axis { label: label.into(), scale: Scale::Decades },
        y: Axis { label: "relative error".into(), scale: Scale::Decades },
        columns: 2,
        panels: MEASURES.iter().map(panel).filter(|panel| !panel.curves.is_empty()).collect(),
    }
}
