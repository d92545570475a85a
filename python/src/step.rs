//! An increment of a result once more, as the library shows it to observers: for fields, pictures and files.

use crate::arrays::{Vector, expect_length, table};
use numpy::{IntoPyArray, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use stickslip::body::Model;
use stickslip::run::RecordedIncrement;
use stickslip::run::report::{ContactLine, contact_points};
use stickslip::solver::history::{IncrementRecord, IncrementView};
use stickslip::solver::{ContactStatus, Increment, State};
use stickslip_exchange::{Info, export, export_local};
use stickslip_output::{ContactSurface, DeformedBody, Values, contact_stresses, fields};

/// An increment of a `Result`, as its arrays and the record in JSON.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct GivenStep<'py> {
    record: String,
    u: Vector<'py>,
    u_rest: Vector<'py>,
    p_n: Vector<'py>,
    p_t: Vector<'py>,
    p_o: Vector<'py>,
    force: Vector<'py>,
    gap: Vector<'py>,
    mu: Vector<'py>,
    w_t_last: Vector<'py>,
    w_o_last: Vector<'py>,
    contact: PyReadonlyArray1<'py, u8>,
}

impl GivenStep<'_> {
    /// The increment, whose arrays have the lengths of `model`.
    pub fn recorded(&self, model: &Model) -> PyResult<RecordedIncrement> {
        let (n_u, n_c) = (model.problem.displacements(), model.problem.contacts());
        let of_body = [("u", &self.u), ("u_rest", &self.u_rest), ("force", &self.force)];
        let of_nodes = [("p_n", &self.p_n), ("p_t", &self.p_t), ("p_o", &self.p_o), ("gap", &self.gap)];
        let rest = [("mu", &self.mu), ("w_t_last", &self.w_t_last), ("w_t_last", &self.w_o_last)];
        for (name, values) in of_body {
            expect_length(name, n_u, values.len()?)?;
        }
        for (name, values) in of_nodes.into_iter().chain(rest) {
            expect_length(name, n_c, values.len()?)?;
        }
        expect_length("contact", n_c, self.contact.len()?)?;
        let record = record(&self.record).map_err(|error| PyValueError::new_err(format!("records: {error}")))?;
        let statuses: Vec<_> = self.contact.as_slice()?.iter().map(|code| status(*code)).collect();
        let state = State {
            u: self.u.to_vec()?,
            u_rest: self.u_rest.to_vec()?,
            p_t: self.p_t.to_vec()?,
            p_o: self.p_o.to_vec()?,
            p_n: self.p_n.to_vec()?,
        };
        let increment = Increment {
            force: self.force.as_slice()?,
            gap: self.gap.as_slice()?,
            mu: self.mu.as_slice()?,
            w_t_last: self.w_t_last.as_slice()?,
            w_o_last: self.w_o_last.as_slice()?,
        };
        Ok(RecordedIncrement::new(&IncrementView {
            record: &record,
            increment: &increment,
            state: &state,
            statuses: &statuses,
        }))
    }
}

/// JSON has no word for numbers that are not finite; an increment that failed has some.
fn record(text: &str) -> serde_json::Result<IncrementRecord> {
    let mut record: serde_json::Value = serde_json::from_str(text)?;
    let fields = record.as_object_mut().into_iter().flat_map(serde_json::Map::values_mut);
    for value in fields {
        for value in value.as_object_mut().into_iter().flat_map(serde_json::Map::values_mut) {
            finite(value);
        }
        finite(value);
    }
    serde_json::from_value(record)
}

fn finite(value: &mut serde_json::Value) {
    if value.is_null() {
        *value = 0.0.into();
    }
}

fn status(code: u8) -> ContactStatus {
    match code {
        0 => ContactStatus::Open,
        1 => ContactStatus::Stick,
        _ => ContactStatus::Slip,
    }
}

/// Stresses, slip and gap of every contact node, SI.
pub(crate) fn contact_values<'py>(
    py: Python<'py>,
    model: &Model,
    step: &RecordedIncrement,
) -> PyResult<Bound<'py, PyDict>> {
    let data = step.data();
    let points = py.detach(|| contact_points(model, 0..model.contact.nodes.len(), &step.step(&data)));
    let values = PyDict::new(py);
    let column =
        |value: fn(&stickslip::run::report::ContactPoint) -> f64| -> Vec<f64> { points.iter().map(value).collect() };
    values.set_item("pressure", column(|p| p.sigma_n).into_pyarray(py))?;
    values.set_item("traction_t", column(|p| p.sigma_t).into_pyarray(py))?;
    values.set_item("traction_o", column(|p| p.sigma_o).into_pyarray(py))?;
    values.set_item("slip_t", column(|p| p.slip_t).into_pyarray(py))?;
    values.set_item("slip_o", column(|p| p.slip_o).into_pyarray(py))?;
    values.set_item("opening", column(|p| p.gap).into_pyarray(py))?;
    Ok(values)
}

/// The fields of the VTU file, SI: those of points, those of cells.
pub(crate) fn field_arrays<'py>(
    py: Python<'py>,
    model: &Model,
    step: &RecordedIncrement,
) -> PyResult<[Bound<'py, PyDict>; 2]> {
    let data = step.data();
    let grid = py.detach(|| fields(model, &step.step(&data)));
    let arrays = |count: usize, fields: Vec<stickslip_output::Field>| {
        let of = PyDict::new(py);
        for field in fields {
            match (field.values, field.components) {
                (Values::Real(values), 1) => of.set_item(field.name, values.into_pyarray(py))?,
                (Values::Real(values), _) => of.set_item(field.name, table(py, count, values)?)?,
                (Values::Whole(values), _) => of.set_item(field.name, values.into_pyarray(py))?,
            }
        }
        PyResult::Ok(of)
    };
    Ok([arrays(grid.points.len(), grid.point_fields)?, arrays(grid.cells.len(), grid.cell_fields)?])
}

/// The text of the VTU file, in the units of the scene.
pub(crate) fn vtu(py: Python<'_>, model: &Model, step: &RecordedIncrement) -> String {
    let data = step.data();
    py.detach(|| fields(model, &step.step(&data)).to_string())
}

/// The pictures of one kind, each with its boundary if there are several, as SVG.
pub(crate) fn pictures(
    py: Python<'_>,
    model: &Model,
    step: &RecordedIncrement,
    title: &str,
    deformed: bool,
    magnification: Option<f64>,
) -> PyResult<Vec<(Option<String>, String)>> {
    let data = step.data();
    let drawn = py.detach(|| {
        let step = step.step(&data);
        if deformed {
            return Ok(vec![(None, DeformedBody::new(model, &step, magnification).to_svg(title)?)]);
        }
        if model.mesh.dimension == 3 {
            let surfaces = ContactSurface::all(model, &step).into_iter();
            return surfaces.map(|surface| Ok((surface.boundary.clone(), surface.to_svg(title)?))).collect();
        }
        let lines = ContactLine::all(model, &step).into_iter().filter(|line| line.points.len() > 1);
        lines.map(|line| Ok((line.boundary.clone(), contact_stresses(&line, title)?))).collect()
    });
    drawn.map_err(|error: stickslip_output::PlotError| PyValueError::new_err(error.to_string()))
}

/// The bytes of an FCLIB file with the increment as a problem, and its solution if it converged.
pub(crate) fn fclib<'py>(
    py: Python<'py>,
    model: &Model,
    (step, before): (&RecordedIncrement, Option<&RecordedIncrement>),
    title: String,
    local: bool,
    solved: bool,
) -> PyResult<Bound<'py, PyBytes>> {
    let info = Info {
        title: Some(title),
        description: Some(format!(
            "Written by stickslip {} at t = {} s, SI units",
            env!("CARGO_PKG_VERSION"),
            step.record.time
        )),
        math_info: None,
    };
    let nothing = State::zero(&model.problem);
    let before = before.map_or(&nothing, |before| &before.state);
    let made = py.detach(|| {
        let file = export(&model.problem, model.mesh.components(), &step.data(), &step.state, before, info);
        let mut file = file.map_err(|fault| fault.to_string())?;
        if !solved {
            file.solution = None;
        }
        if local {
            file = export_local(file).map_err(|error| format!("form: {error}; export the global form"))?;
        }
        file.to_fclib().map_err(|error| error.to_string())
    });
    made.map(|bytes| PyBytes::new(py, &bytes)).map_err(PyRuntimeError::new_err)
}
