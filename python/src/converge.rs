//! A scene with finer meshes and increments until a quantity is known.

use crate::error::{of_run, of_scene};
use crate::foreign::Raised;
use crate::recorder::{Keep, Recorder};
use crate::scene::parsed;
use crate::solve::watched;
use miette::Diagnostic;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use stickslip::base::Units;
use stickslip::scene::{Contents, Scene, with_contents};
use stickslip_cli::converge::{Limits, Plan, compute};
use stickslip_cli::study::{MeshSize, StudyError, TableQuantity};

fn refused(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

fn of_study(error: StudyError) -> PyErr {
    match error {
        StudyError::Run(error) => of_run(error),
        of_the_plan => {
            let help = of_the_plan.help().map_or(String::new(), |help| format!("; {help}"));
            PyValueError::new_err(format!("{of_the_plan}{help}"))
        }
    }
}

/// The quantity of a study, its meshes, and its limits.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Wanted {
    quantity: String,
    to: f64,
    meshes: Vec<String>,
    ratio: f64,
    max_runs: usize,
    within: f64,
}

impl Wanted {
    fn plan(self) -> PyResult<Plan> {
        let Wanted { quantity, to, meshes, ratio, max_runs, within } = self;
        let named = |error: String| PyValueError::new_err(format!("meshes: {error}"));
        let sought = quantity.parse::<TableQuantity>().map_err(|error| refused(format!("quantity: {error}")))?;
        let meshes = meshes.iter().map(|mesh| mesh.parse::<MeshSize>()).collect::<Result<_, _>>().map_err(named)?;
        Ok(Plan { sought, meshes, ratio, limits: Limits { to, most_runs: max_runs, within } })
    }
}

/// The study as JSON, and its chart as SVG.
#[pyfunction]
pub(crate) fn converge(
    py: Python<'_>,
    text: (String, String),
    overrides: Vec<String>,
    files: Contents,
    wanted: Wanted,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, String)> {
    let overrides = parsed(&overrides)?;
    let plan = wanted.plan()?;
    let raised = Raised::default();
    let mut tell = |what: String| {
        if let Some(Err(error)) = progress.as_ref().map(|call| Python::attach(|py| call.call1(py, (what,)).map(drop))) {
            raised.set(error);
        }
    };
    let recorder = Recorder::new(Keep::All(false), None, raised.clone());
    let (study, _) = watched(py, recorder, |recorder| {
        Ok(with_contents(files, || {
            let scene = Scene::parse(&text.0, &text.1, &overrides).map_err(of_scene)?;
            compute(&scene, &plan, &mut tell, recorder).map_err(of_study)
        }))
    })?;
    let mut study = study?;
    let chart = study.chart().to_svg().map_err(refused)?;
    let message = study.outcome();
    // Python has SI numbers; words and pictures have the units of the scene.
    study.last.units.units = Units::default();
    let mut json = study.to_json();
    json["message"] = message.into();
    Ok((json.to_string(), chart))
}
