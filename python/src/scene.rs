//! A scene, discretised.

use crate::arrays::{Vector, rows, table};
use crate::error::{of_problem, of_run, of_scene};
use crate::foreign::Raised;
use crate::problem::Problem;
use crate::recorder::{Keep, Recorder};
use crate::saver::{Identity, Saver, hash_of};
use crate::solve::{Algebra, detached, watched};
use crate::step::{GivenStep, contact_values, fclib, field_arrays, pictures, vtu};
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use serde_json::{Value, json};
use std::borrow::Cow;
use std::mem;
use std::path::{Path, PathBuf};
use std::time::Duration;
use stickslip::base::Depth;
use stickslip::body::Model;
use stickslip::body::mesh::{Boundary, Cell, CellKind, Mesh};
use stickslip::run::{Run, Sink, discretise};
use stickslip::scene::{Contents, Override, OverrideSyntax, Provenance, Scene, with_contents};
use stickslip::solver::history::SolverChoice;
use stickslip_cli::study::{Places, TableQuantity};

/// The kinds of cells by the names of meshio.
const KINDS: [(&str, CellKind); 11] = [
    ("triangle", CellKind::Triangle),
    ("quad", CellKind::Quadrilateral),
    ("tetra", CellKind::Tetrahedron),
    ("hexahedron", CellKind::Hexahedron),
    ("wedge", CellKind::Prism),
    ("triangle6", CellKind::Triangle6),
    ("tetra10", CellKind::Tetrahedron10),
    ("quad8", CellKind::Quadrilateral8),
    ("quad9", CellKind::Quadrilateral9),
    ("hexahedron20", CellKind::Hexahedron20),
    ("wedge15", CellKind::Prism15),
];

fn kind_name(kind: CellKind) -> &'static str {
    KINDS.iter().find(|(_, known)| *known == kind).map_or("", |(name, _)| name)
}

/// A mesh of arrays: points in m, cells with the material group of each, boundaries by their facets.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct GivenMesh<'py> {
    points: PyReadonlyArray2<'py, f64>,
    cells: Vec<(String, PyReadonlyArray2<'py, i64>, PyReadonlyArray1<'py, i64>)>,
    groups: Vec<String>,
    boundaries: Vec<(String, Vec<Vec<usize>>)>,
}

impl GivenMesh<'_> {
    fn mesh(self) -> PyResult<Mesh> {
        let fault = |message: String| PyValueError::new_err(format!("mesh: {message}"));
        let point =
            |point: Vec<f64>| <[f64; 3]>::try_from(point).map_err(|_| fault("points have 3 coordinates".into()));
        let nodes = rows(&self.points).into_iter().map(point).collect::<PyResult<Vec<_>>>()?;
        let mut cells = Vec::new();
        for (name, of_kind, groups) in &self.cells {
            let kind = KINDS.iter().find(|(known, _)| known == name);
            let (_, kind) = kind.ok_or_else(|| fault(format!("no cells of the kind {name}")))?;
            let index = |n: i64| usize::try_from(n).map_err(|_| fault(format!("a cell has the node {n}")));
            for (corners, group) in of_kind.as_array().rows().into_iter().zip(groups.as_array()) {
                let nodes = corners.iter().map(|n| index(*n)).collect::<PyResult<_>>()?;
                cells.push(Cell { kind: *kind, nodes, group: index(*group)? });
            }
        }
        let boundaries = self.boundaries.into_iter().map(|(name, facets)| Boundary { name, facets }).collect();
        Mesh::new(nodes, cells, self.groups, boundaries).map_err(|error| fault(error.to_string()))
    }
}

/// Points, cells, groups and boundaries of a mesh.
type RefinedMesh<'py> =
    (Bound<'py, PyArray2<f64>>, Vec<(&'static str, Vec<usize>, usize)>, Vec<String>, Vec<(String, Vec<Vec<usize>>)>);

/// What a run is asked for besides, and what takes the place of the scene's.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct RunOptions {
    uniqueness: bool,
    /// The friction coefficients of the contact nodes.
    mu: Option<Vec<f64>>,
    max_iterations: Option<usize>,
    tolerance: Option<f64>,
    /// The file in which the run is saved as it goes, and the seconds between.
    checkpoint: Option<(PathBuf, Option<f64>)>,
}

/// Changes of a scene from their texts.
pub(crate) fn parsed(overrides: &[String]) -> PyResult<Vec<Override>> {
    let all = overrides.iter().map(|text| text.parse()).collect::<Result<_, _>>();
    all.map_err(|error: OverrideSyntax| PyValueError::new_err(error.to_string()))
}

#[pyclass(frozen, module = "stickslip._core")]
pub(crate) struct SceneModel {
    scene: Scene,
    model: Model,
    /// The files that the scene names, as they were when it was discretised.
    files: Contents,
}

#[pymethods]
impl SceneModel {
    #[new]
    #[pyo3(signature = (name, text, overrides, mesh, files))]
    fn new(
        py: Python<'_>,
        name: &str,
        text: &str,
        overrides: Vec<String>,
        mesh: Option<GivenMesh<'_>>,
        files: Contents,
    ) -> PyResult<Self> {
        let overrides = parsed(&overrides)?;
        let mesh = mesh.map(GivenMesh::mesh).transpose()?;
        let read = || {
            let mut scene = Scene::parse(name, text, &overrides).map_err(of_scene)?;
            if let Some(mesh) = mesh {
                scene.description.mesh = mesh.into();
            }
            let model = discretise(&scene).map_err(of_run)?;
            let files = scene.contents().map_err(of_scene)?;
            Ok(SceneModel { scene, model, files })
        };
        detached(py, || with_contents(files, read))
    }

    #[getter]
    fn title(&self) -> &str {
        &self.scene.title
    }

    #[getter]
    fn text(&self) -> &str {
        self.scene.text()
    }

    /// The files that the scene names with their contents, as they were when it was discretised.
    fn files<'py>(&self, py: Python<'py>) -> Vec<(&std::path::Path, Bound<'py, PyBytes>)> {
        self.files.iter().map(|(path, bytes)| (path.as_path(), PyBytes::new(py, bytes))).collect()
    }

    #[getter]
    fn dimension(&self) -> usize {
        self.model.mesh.dimension
    }

    /// The number of components of forces: the dimension, and 3 with torsion.
    #[getter]
    fn components(&self) -> usize {
        self.model.mesh.components()
    }

    /// The thickness of a plane body whose forces are those of the whole body, m; otherwise 1.
    #[getter]
    fn thickness(&self) -> f64 {
        if let Depth::Thickness(thickness) = self.model.units().depth { thickness } else { 1.0 }
    }

    #[getter]
    fn times(&self) -> Vec<f64> {
        self.model.times().to_vec()
    }

    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.model.mesh.nodes.len(), self.model.mesh.nodes.as_flattened().to_vec())
    }

    /// Kind, nodes and group of each cell, in the order of the mesh.
    fn cells(&self) -> Vec<(&'static str, Vec<usize>, usize)> {
        self.model.mesh.cells.iter().map(|cell| (kind_name(cell.kind), cell.nodes.clone(), cell.group)).collect()
    }

    /// The share up to which the mesh refines itself, as the scene says.
    #[getter]
    fn refine(&self) -> Option<f64> {
        self.scene.refine
    }

    /// The mesh that has refined itself up to this error: points, cells as above, groups, boundaries by their facets.
    fn refined<'py>(&self, py: Python<'py>, error: f64) -> PyResult<RefinedMesh<'py>> {
        let mut scene = self.scene.clone();
        scene.refine = Some(error);
        let recorder = Recorder::new(Keep::All(false), None, Raised::default());
        let (model, _) = watched(py, recorder, |recorder| {
            let refined = || Ok(Run::prepared(&scene, &mut |_| (), recorder)?.into_model());
            with_contents(self.files.clone(), refined)
        })?;
        let Mesh { nodes, cells, groups, boundaries, .. } = &*model.mesh;
        let cells = cells.iter().map(|cell| (kind_name(cell.kind), cell.nodes.clone(), cell.group)).collect();
        let boundaries = boundaries.iter().map(|boundary| (boundary.name.clone(), boundary.facets.clone())).collect();
        Ok((table(py, nodes.len(), nodes.as_flattened().to_vec())?, cells, groups.clone(), boundaries))
    }

    /// Node and position of each contact node.
    fn contacts(&self) -> Vec<(usize, [f64; 3])> {
        self.model.contact.nodes.iter().map(|contact| (contact.node, contact.position)).collect()
    }

    /// Normal towards the obstacle and tangents of each contact node.
    fn frames(&self) -> Vec<[[f64; 3]; 3]> {
        let facings = self.model.contact.nodes.iter().map(|contact| &contact.facing);
        facings.map(|facing| [facing.normal, facing.tangents[0], facing.tangents[1]]).collect()
    }

    /// Name of each boundary with contact, and its nodes among all contact nodes.
    fn boundaries(&self) -> Vec<(String, Vec<usize>)> {
        let all = self.model.contact.boundaries.iter();
        all.map(|boundary| (boundary.name.clone(), boundary.nodes.clone())).collect()
    }

    fn problem(&self) -> Problem {
        self.model.problem.clone().into()
    }

    /// The displacements (m) of all nodes at time `t` (s) that the unknowns `u` are.
    fn displacements<'py>(&self, py: Python<'py>, t: f64, u: Vector<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let u = u.as_slice()?;
        let all = detached(py, || self.model.displacements(t, u)).map_err(of_problem)?;
        table(py, all.len(), all.as_flattened().to_vec())
    }

    /// The stress (Pa; xx, yy, zz, xy, yz, zx) in the middle of each cell.
    fn stresses<'py>(&self, py: Python<'py>, t: f64, u: Vector<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let u = u.as_slice()?;
        let stresses = detached(py, || self.model.centre_stresses(t, &self.model.displacements(t, u)?));
        let stresses = stresses.map_err(of_problem)?;
        table(py, stresses.len(), stresses.as_flattened().to_vec())
    }

    /// Loads, factors (increments × loads), gaps (increments + 1), drifts and friction (increments).
    fn history<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let loading = &self.model.loading;
        let (times, cases) = (self.model.times(), loading.cases());
        let history = PyDict::new(py);
        let rows = |all: Vec<Vec<f64>>| table(py, all.len(), all.concat());
        let factors = times.iter().map(|t| cases.iter().map(|case| case.factor(*t)).collect());
        let n_u = self.model.problem.displacements();
        let forces = cases.iter().flat_map(|case| case.force().to_vec()).collect();
        history.set_item("cases", numpy::PyArray1::from_vec(py, forces).reshape([cases.len(), n_u])?)?;
        history.set_item("factors", rows(factors.collect())?)?;
        history.set_item("gap", rows([0.0].iter().chain(times).map(|t| loading.gaps_at(*t)).collect())?)?;
        for (k, name) in ["drift", "drift_o"].into_iter().enumerate() {
            history.set_item(name, rows(times.iter().map(|t| loading.drift_at(*t, k)).collect())?)?;
        }
        let mu = |t: &f64| loading.friction().map_or_else(|| self.model.problem.mu().to_vec(), |mu| mu.at(*t));
        history.set_item("mu", rows(times.iter().map(mu).collect())?)?;
        Ok(history)
    }

    /// Stresses, slip and gap of the contact nodes at the end of an increment.
    fn contact_values<'py>(&self, py: Python<'py>, step: GivenStep<'py>) -> PyResult<Bound<'py, PyDict>> {
        contact_values(py, &self.model, &step.recorded(&self.model)?)
    }

    /// The fields of the body at the end of an increment: those of points, those of cells.
    fn fields<'py>(&self, py: Python<'py>, step: GivenStep<'py>) -> PyResult<[Bound<'py, PyDict>; 2]> {
        field_arrays(py, &self.model, &step.recorded(&self.model)?)
    }

    /// The value of a quantity in a `report` of the scene, in SI units, as JSON; null if the run has none.
    fn quantity(&self, name: &str, report: &Bound<'_, PyDict>) -> PyResult<String> {
        let mut places = Places::default();
        places.add(&self.scene.description);
        let quantity = name.parse().and_then(|quantity: TableQuantity| quantity.at(&places, false));
        let quantity = quantity.map_err(|error| PyValueError::new_err(format!("name: {error}")))?;
        let root = quantity.root();
        let part = report.py().import("json")?.call_method1("dumps", (report.get_item(root)?,))?.extract::<String>()?;
        let part: Value = serde_json::from_str(&part).map_err(|error| PyValueError::new_err(error.to_string()))?;
        let value = quantity.of(&json!({ root: part }));
        let si = |x| self.model.units().to_si(quantity.quantity(), x);
        Ok(value.as_f64().filter(|_| value.is_f64()).map_or(value, |x| si(x).into()).to_string())
    }

    fn vtu(&self, py: Python<'_>, step: GivenStep<'_>) -> PyResult<String> {
        Ok(vtu(py, &self.model, &step.recorded(&self.model)?))
    }

    #[pyo3(signature = (step, deformed, magnification))]
    fn pictures(
        &self,
        py: Python<'_>,
        step: GivenStep<'_>,
        deformed: bool,
        magnification: Option<f64>,
    ) -> PyResult<Vec<(Option<String>, String)>> {
        pictures(py, &self.model, &step.recorded(&self.model)?, &self.scene.title, deformed, magnification)
    }

    /// An FCLIB file of an increment, and of the one before it as a guess.
    fn fclib<'py>(
        &self,
        py: Python<'py>,
        step: GivenStep<'py>,
        before: Option<GivenStep<'py>>,
        local: bool,
        solved: bool,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let step = step.recorded(&self.model)?;
        let before = before.map(|before| before.recorded(&self.model)).transpose()?;
        let title = format!("{}, increment {} of {}", self.scene.title, step.record.index, self.model.times().len());
        fclib(py, &self.model, (&step, before.as_ref()), title, local, solved)
    }

    fn run<'py>(
        &self,
        py: Python<'py>,
        linear: Option<&Bound<'py, PyAny>>,
        keep: Keep,
        callback: Option<Py<PyAny>>,
        options: RunOptions,
    ) -> PyResult<Bound<'py, PyDict>> {
        let RunOptions { uniqueness, mu, max_iterations, tolerance, checkpoint } = options;
        let SceneModel { scene, model, .. } = self;
        let mut model = Cow::Borrowed(model);
        if let Some(mu) = mu {
            if model.loading.friction().is_some() {
                let message = "mu: the friction of the scene changes in time; leave out contact.friction_history";
                return Err(PyValueError::new_err(message));
            }
            let problem = model.problem.with_friction(mu).map_err(of_problem)?;
            model.to_mut().problem = problem;
        }
        let raised = Raised::default();
        let (linear, own) = Algebra::new(linear, &raised)?.split(scene.solver.linear);
        let solver = SolverChoice {
            linear,
            max_iterations: max_iterations.unwrap_or(scene.solver.max_iterations),
            tolerance: tolerance.unwrap_or(scene.solver.tolerance),
            ..scene.solver
        };
        let saver =
            checkpoint.map(|(file, every)| self.saver(&file, every, solver.tolerance, keep.clone())).transpose()?;
        let (recorder, left) = Recorder::new(keep, callback, raised).saved_by(saver)?;
        let (mut report, mut recorder) = watched(py, recorder, |recorder| {
            let mut run = Run::of(&model, model.times().to_vec(), solver)?;
            if let Some(cycle) = scene.output.cycle {
                run = run.with_cycle(cycle);
            }
            if uniqueness {
                run = run.with_uniqueness()?;
            }
            if let Some(checkpoint) = left {
                run = run.from(checkpoint);
            }
            match own {
                Some(system) => run.solve_with(system, Sink::RecordWriter(recorder)),
                None => run.solve_to(recorder),
            }
        })?;
        let result = PyDict::new(py);
        let json = |error: serde_json::Error| PyValueError::new_err(error.to_string());
        report.scene = Some(scene.file().to_string());
        report.scene_text = Some(scene.text().to_string());
        // The lists of an earlier part of the run are among them.
        report.increments = mem::take(&mut recorder.kept.records);
        report.forces = mem::take(&mut recorder.kept.forces);
        report.reactions = mem::take(&mut recorder.kept.reactions);
        result.set_item("status", report.status.to_string())?;
        result.set_item("records", serde_json::to_string(&report.increments).map_err(json)?)?;
        result.set_item("report", report.to_json().map_err(json)?)?;
        result.set_item("unsaved", recorder.unsaved.take())?;
        recorder.write(&result)?;
        Ok(result)
    }
}

impl SceneModel {
    fn saver(&self, file: &Path, every: Option<f64>, tolerance: f64, keep: Keep) -> PyResult<Saver> {
        let every = every.map(Duration::try_from_secs_f64).transpose();
        let every = every.map_err(|error| PyValueError::new_err(format!("checkpoint_every: {error}")))?;
        let origin = with_contents(self.files.clone(), || Provenance::new(&self.scene, env!("CARGO_PKG_VERSION")));
        let unread =
            |(file, error): (PathBuf, std::io::Error)| PyValueError::new_err(format!("{}: {error}", file.display()));
        let of = Identity { origin: origin.map_err(unread)?, mesh: hash_of(&self.model.mesh), tolerance, keep };
        Saver::new(file, every, of)
    }
}
