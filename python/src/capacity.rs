//! The factor by which a load may grow until a joint slips.

use crate::error::{of_run, of_scene};
use crate::foreign::Raised;
use crate::recorder::{Keep, Recorder};
use crate::scene::parsed;
use crate::solve::watched;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use stickslip::scene::{Contents, Scene, with_contents};
use stickslip_cli::capacity;

/// The capacity as JSON. The load has its number, or the name of its place.
#[pyfunction]
pub(crate) fn find_capacity(
    py: Python<'_>,
    text: (String, String),
    overrides: Vec<String>,
    files: Contents,
    load: String,
) -> PyResult<String> {
    let overrides = parsed(&overrides)?;
    let refused = |message: String| PyValueError::new_err(format!("load: {message}"));
    let recorder = Recorder::new(Keep::All(false), None, Raised::default());
    let (found, _) = watched(py, recorder, |recorder| {
        Ok(with_contents(files, || {
            let scene = Scene::parse(&text.0, &text.1, &overrides).map_err(of_scene)?;
            let load = capacity::load(&scene, &load).map_err(refused)?;
            capacity::compute(&scene, load, recorder).map_err(of_run)?.map_err(refused)
        }))
    })?;
    Ok(found?.to_json().to_string())
}
