//! A problem of matrices: solved, and the judge of anybody's answer.

use crate::arrays::{Compressed, Exported, Rows, Vector, export_lower, export_map, map, rows, symmetric};
use crate::condensed::CondensedBody;
use crate::error::{of_linear, of_problem};
use crate::foreign::Raised;
use crate::loading::Tables;
use crate::recorder::{Keep, Recorder, codes};
use crate::solve::{Algebra, by_size, detached, method, watched};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;
use stickslip::algebra::Csr;
use stickslip::algebra::linear::SparseCholesky;
use stickslip::run::RunError;
use stickslip::solver::history::{HistoryOutcome, HistorySettings, LinearAlgebra, SolverChoice, SystemSolver};
use stickslip::solver::{
    self, Condensation, Condensed, ContactProblem, Increment, InitialWorkingSet, Loading, Parts, State,
};
use stickslip::solver::{KktErrors, KktScales, statuses};

/// A body against rigid obstacles: K, `C_n`, `C_t`, `C_o`, mu, l and the free motions.
#[pyclass(frozen, module = "stickslip._core")]
pub(crate) struct Problem(pub Arc<ContactProblem>, pub Condensation);

impl From<ContactProblem> for Problem {
    fn from(problem: ContactProblem) -> Self {
        Problem(Arc::new(problem), SparseCholesky::default().into())
    }
}

/// `C_n`, `C_t` and `C_o` by rows, for so many displacements.
fn maps_of(order: usize, [c_n, c_t, c_o]: &[Compressed<'_>; 3]) -> PyResult<[Csr; 3]> {
    Ok([map("C_n", order, c_n)?, map("C_t", order, c_t)?, map("C_t[1]", order, c_o)?])
}

/// A state and what drove it, as the judge wants it.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Answer<'py> {
    force: Vector<'py>,
    gap: Vector<'py>,
    mu: Vector<'py>,
    w_last: [Vector<'py>; 2],
    u: Vector<'py>,
    u_rest: Vector<'py>,
    p_n: Vector<'py>,
    p_t: Vector<'py>,
    p_o: Vector<'py>,
}

impl Answer<'_> {
    fn state(&self) -> PyResult<State> {
        let own = |values: &Vector<'_>| values.as_slice().map(<[f64]>::to_vec);
        Ok(State {
            u: own(&self.u)?,
            u_rest: own(&self.u_rest)?,
            p_t: own(&self.p_t)?,
            p_o: own(&self.p_o)?,
            p_n: own(&self.p_n)?,
        })
    }

    fn increment(&self) -> PyResult<Increment<'_>> {
        Ok(Increment {
            force: self.force.as_slice()?,
            gap: self.gap.as_slice()?,
            mu: self.mu.as_slice()?,
            w_t_last: self.w_last[0].as_slice()?,
            w_o_last: self.w_last[1].as_slice()?,
        })
    }
}

/// Errors by law, statuses of the nodes, scales of the parts of the body.
type Judged = (Vec<f64>, Vec<u8>, Vec<f64>);

/// The words of `ContactProblem.solve`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Options {
    method: String,
    setting: String,
    r_factor: f64,
    tolerance: Option<f64>,
    max_iterations: usize,
}

impl Options {
    pub fn solver(&self, linear: Option<LinearAlgebra>) -> PyResult<SolverChoice> {
        let solver = SolverChoice::new(method(&self.method, &self.setting, self.r_factor)?);
        let tolerance = self.tolerance.unwrap_or(solver.tolerance);
        if !(tolerance > 0.0 && tolerance < 1.0) {
            return Err(PyValueError::new_err(format!("tolerance is {tolerance}, but must be between 0 and 1")));
        }
        if self.max_iterations == 0 {
            return Err(PyValueError::new_err("max_iterations is 0, but must be 1 or more"));
        }
        Ok(SolverChoice { linear, tolerance, max_iterations: self.max_iterations, ..solver })
    }
}

/// The linear system and the settings of a history: that which suits the sizes where nobody says which. A body that `condensation`
/// has condensed already stays so.
fn prepared(
    Problem(problem, condensation): &Problem,
    loading: &Loading,
    times: &[f64],
    solver: &SolverChoice,
) -> Result<(SystemSolver, HistorySettings), RunError> {
    let settings = solver.settings(problem, loading)?;
    if let Some(LinearAlgebra::Whole(_)) = solver.linear {
        return Ok((solver.linear.unwrap_or_default().into(), settings));
    }
    let condensing = match solver.linear {
        Some(LinearAlgebra::Condensed(cholesky)) => Some(cholesky),
        _ => None,
    };
    if condensing.is_none_or(|cholesky| cholesky == condensation.cholesky()) && condensation.is_for(problem) {
        return Ok((SystemSolver::Condensed(condensation.clone()), settings));
    }
    let mut reach = InitialWorkingSet::default();
    if !solver.method.increments().is_of_paper() {
        reach = solver::working_set(problem, loading, times, solver::AFFORDABLE, condensing)?;
    }
    let linear = match solver.linear {
        Some(linear) => linear,
        None => by_size(problem, &reach)?,
    };
    Ok((system(condensation, linear), HistorySettings { working_set: reach.nodes, ..settings }))
}

/// A linear system, that of a body which `condensation` condenses or has condensed if it is one of this kind.
pub(crate) fn system(condensation: &Condensation, linear: LinearAlgebra) -> SystemSolver {
    match linear {
        LinearAlgebra::Condensed(cholesky) if cholesky == condensation.cholesky() => {
            SystemSolver::Condensed(condensation.clone())
        }
        linear => linear.into(),
    }
}

/// An outcome with what was recorded of it.
pub(crate) fn exported<'py>(
    py: Python<'py>,
    outcome: &HistoryOutcome,
    recorder: Recorder,
) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    let json = |error: serde_json::Error| PyValueError::new_err(error.to_string());
    result.set_item("status", outcome.status.to_string())?;
    result.set_item("free_motion", &outcome.free_motion)?;
    result.set_item("records", serde_json::to_string(&recorder.kept.records).map_err(json)?)?;
    result.set_item("analyses", outcome.linear.analyses)?;
    result.set_item("factorizations", outcome.linear.factorizations)?;
    recorder.write(&result)?;
    Ok(result)
}

#[pymethods]
impl Problem {
    /// K by the columns of its lower triangle, the maps by rows.
    #[new]
    #[pyo3(signature = (order, stiffness, maps, mu, weight, free_motions))]
    fn new(
        py: Python<'_>,
        order: usize,
        stiffness: Compressed<'_>,
        maps: [Compressed<'_>; 3],
        mu: Vector<'_>,
        weight: Option<Vector<'_>>,
        free_motions: Option<Rows<'_>>,
    ) -> PyResult<Self> {
        let [c_n, c_t, c_o] = maps_of(order, &maps)?;
        let parts = Parts {
            stiffness: symmetric("K", order, &stiffness)?.into(),
            c_n,
            c_t,
            c_o,
            mu: mu.as_slice()?.to_vec(),
            weight: weight.map(|weight| weight.as_slice().map(<[f64]>::to_vec)).transpose()?,
            rigid_modes: free_motions.as_ref().map(rows),
        };
        detached(py, || ContactProblem::new(parts)).map(Problem::from).map_err(of_problem)
    }

    /// The problem with other friction coefficients, weights or maps by rows. It shares the stiffness, and the condensed body once
    /// there is one.
    #[pyo3(signature = (maps, mu, weight))]
    fn with_parts(
        &self,
        py: Python<'_>,
        maps: Option<[Compressed<'_>; 3]>,
        mu: Option<Vector<'_>>,
        weight: Option<Vector<'_>>,
    ) -> PyResult<Self> {
        let own = |values: Vector<'_>| values.as_slice().map(<[f64]>::to_vec);
        let (mu, weight) = (mu.map(own).transpose()?, weight.map(own).transpose()?);
        if let (None, Some(mu), None) = (&maps, &mu, &weight) {
            let problem = self.0.with_friction(mu.clone()).map_err(of_problem)?;
            return Ok(Problem(Arc::new(problem), self.1.clone()));
        }
        let mut parts = (*self.0).clone().into_parts();
        if let Some(maps) = &maps {
            [parts.c_n, parts.c_t, parts.c_o] = maps_of(parts.stiffness.order(), maps)?;
        }
        parts.mu = mu.unwrap_or(parts.mu);
        parts.weight = weight.or(parts.weight);
        let problem = detached(py, || ContactProblem::new(parts));
        Ok(Problem(Arc::new(problem.map_err(of_problem)?), self.1.clone()))
    }

    /// The problem on the contact displacements, with all tangents, and the body behind it.
    fn condense(&self, py: Python<'_>) -> PyResult<(Self, CondensedBody)> {
        // Rows of nodes without friction are left out of what is condensed.
        let rough = self.0.with_friction(vec![1.0; self.0.contacts()]).map_err(of_problem)?;
        let loading = Loading::new(Vec::new(), vec![0.0; self.0.contacts()]).map_err(of_problem)?;
        let body = detached(py, || Condensed::new(&rough, &loading, self.1.clone())).map_err(of_linear)?;
        let problem = body.problem.with_friction(self.0.mu().to_vec()).map_err(of_problem)?;
        Ok((problem.into(), CondensedBody(body)))
    }

    #[getter]
    fn n_u(&self) -> usize {
        self.0.displacements()
    }

    #[getter]
    fn n_c(&self) -> usize {
        self.0.contacts()
    }

    #[getter]
    fn mu<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.0.mu())
    }

    #[getter]
    fn weight<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.0.weight().map(|weight| PyArray1::from_slice(py, weight))
    }

    /// `r_i = 1 / (largest eigenvalue of the compliance of node i)`, N/m.
    #[getter]
    fn contact_stiffness<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, detached(py, || self.0.contact_stiffness().to_vec()))
    }

    fn free_motions(&self) -> Vec<Vec<f64>> {
        self.0.rigid_modes().to_vec()
    }

    /// The lower triangle of K by columns: data, row indices, column starts.
    fn lower<'py>(&self, py: Python<'py>) -> PyResult<Exported<'py>> {
        let stiffness = self.0.stiffness().assembled().map_err(|error| of_problem(error.into()))?;
        Ok(export_lower(py, &stiffness))
    }

    /// `C_n` (0), `C_t` (1) or `C_o` (2) by rows.
    fn map<'py>(&self, py: Python<'py>, which: usize) -> PyResult<Exported<'py>> {
        match which {
            0 => Ok(export_map(py, self.0.c_n())),
            1 => Ok(export_map(py, self.0.c_t())),
            2 => Ok(export_map(py, self.0.c_o())),
            _ => Err(PyValueError::new_err("a map is 0, 1 or 2")),
        }
    }

    /// The error measure of an answer to one increment: by law, the statuses, the scales.
    fn errors<'py>(&self, py: Python<'py>, answer: Answer<'py>, scales: Vec<f64>) -> PyResult<Judged> {
        let (state, increment) = (answer.state()?, answer.increment()?);
        let judged = detached(py, || {
            let earlier = KktScales::new(&scales)?;
            let errors = KktErrors::measure(&self.0, &increment, &state, &earlier)?;
            let statuses = statuses(&self.0, &increment, &state)?;
            let scales = KktScales::after(&earlier, &self.0, &increment, &state)?;
            let errors = errors.components().map(|(_, error)| error).to_vec();
            Ok((errors, codes(&statuses).collect(), scales.values()))
        });
        judged.map_err(of_problem)
    }

    /// Solves a history, or a single increment, of whose beginning only the tangential displacements are known: it has no
    /// path along which it could be divided.
    #[pyo3(signature = (tables, options, linear, keep, callback, is_single))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn run<'py>(
        &self,
        py: Python<'py>,
        tables: Tables<'py>,
        options: Options,
        linear: Option<&Bound<'py, PyAny>>,
        keep: Keep,
        callback: Option<Py<PyAny>>,
        is_single: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        let problem = &*self.0;
        let (loading, times) = tables.loading(problem)?;
        let raised = Raised::default();
        let (linear, own) = Algebra::new(linear, &raised)?.split(None);
        let solver = options.solver(linear)?;
        let (outcome, recorder) = watched(py, Recorder::new(keep, callback, raised), |recorder| {
            let (system, mut settings) = prepared(self, &loading, &times, &solver)?;
            if is_single {
                settings.halvings = 0;
            }
            Ok(solver.solve(problem, &loading, &times, &settings, own.unwrap_or(system), recorder)?)
        })?;
        exported(py, &outcome, recorder)
    }
}
