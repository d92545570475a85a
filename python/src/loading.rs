//! Histories from tables: a row for each increment.

use crate::arrays::{Rows, expect_length, rows};
use crate::error::of_problem;
use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::iter::once;
use std::sync::Arc;
use stickslip::solver::{ContactProblem, FrictionHistory, GapCorrection, LoadCase, Loading, Motion, ProblemError};

/// What drives a history whose increments end at `times`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Tables<'py> {
    times: Vec<f64>,
    /// Loads (cases × n_u), N.
    forces: Rows<'py>,
    /// Their factors (increments × cases).
    factors: Rows<'py>,
    /// Gaps, m: one row, or one for t = 0 and one for each increment.
    gap: Rows<'py>,
    /// How far the obstacle has moved past each node along each tangent (increments × n_c), m.
    drift: [Option<Rows<'py>>; 2],
    /// Friction coefficients where they change (increments × n_c).
    mu: Option<Rows<'py>>,
}

/// Tables apart from the interpreter, from which a thread of any kind makes a loading.
pub(crate) struct History {
    pub times: Vec<f64>,
    forces: Arc<Vec<Vec<f64>>>,
    /// By cases.
    factors: Vec<Vec<f64>>,
    gap: Vec<Vec<f64>>,
    drift: [Option<Vec<Vec<f64>>>; 2],
    mu: Option<Vec<Vec<f64>>>,
}

impl Tables<'_> {
    /// A copy, which shares the forces with `last` if Python has given both the same array.
    pub fn history(&self, problem: &ContactProblem, last: Option<(&Self, &History)>) -> PyResult<History> {
        let (increments, contacts) = (self.times.len(), problem.contacts());
        expect_length("factors", increments, self.factors.shape()[0])?;
        expect_length("factors[0]", self.forces.shape()[0], self.factors.shape()[1])?;
        let drift = self.drift.each_ref().map(Option::as_ref);
        let tables = [("gap", Some(&self.gap)), ("drift", drift[0]), ("drift", drift[1]), ("mu", self.mu.as_ref())];
        for (name, table) in tables {
            if let Some(table) = table {
                expect_length(name, contacts, table.shape()[1])?;
            }
        }
        let shared = last.filter(|(tables, _)| tables.forces.is(&*self.forces));
        Ok(History {
            times: self.times.clone(),
            forces: shared.map_or_else(|| Arc::new(rows(&self.forces)), |(_, history)| Arc::clone(&history.forces)),
            factors: self.factors.as_array().columns().into_iter().map(|column| column.to_vec()).collect(),
            gap: rows(&self.gap),
            drift: drift.map(|drift| drift.map(rows)),
            mu: self.mu.as_ref().map(rows),
        })
    }

    pub fn loading(&self, problem: &ContactProblem) -> PyResult<(Loading, Vec<f64>)> {
        let history = self.history(problem, None)?;
        Ok((history.loading().map_err(of_problem)?, history.times))
    }
}

/// The time 0 and the others.
fn from_zero(times: &[f64]) -> Vec<f64> {
    once(0.0).chain(times.iter().copied()).collect()
}

impl History {
    pub fn loading(&self) -> Result<Loading, ProblemError> {
        let case = |(force, factors): (&Vec<f64>, &Vec<f64>)| {
            let points = self.times.iter().zip(factors).map(|(time, factor)| [*time, *factor]);
            LoadCase::new(force.clone(), once([0.0, 0.0]).chain(points.filter(|point| point[0] > 0.0)).collect())
        };
        let cases = self.forces.iter().zip(&self.factors).map(case).collect::<Result<Vec<_>, _>>()?;
        let first = self.gap.first().cloned().unwrap_or_default();
        let nodes = 0..first.len();
        let mut motions = Vec::new();
        for (d, drift) in self.drift.iter().enumerate() {
            let Some(drift) = drift else { continue };
            for (k, row) in drift.iter().enumerate() {
                let along = row.iter().map(|&drift| if d == 0 { [drift, 0.0] } else { [0.0, drift] });
                let hat = from_zero(&self.times).into_iter().enumerate();
                let hat = hat.map(|(j, time)| [time, f64::from(u8::from(j == k + 1))]);
                motions.push(Motion::new(nodes.clone(), vec![0.0; nodes.len()], along.collect(), hat.collect())?);
            }
        }
        let mut bends = Vec::new();
        if self.gap.len() > 1 {
            let beyond = self.gap.iter().map(|row| row.iter().zip(&first).map(|(gap, first)| gap - first).collect());
            bends.push(GapCorrection::new(nodes, from_zero(&self.times), beyond.collect())?);
        }
        Loading::new(cases, first)?.with_motions(motions, bends)?.with_friction(self.friction()?)
    }

    /// Coefficients that change, as histories of factors: one for all nodes whose coefficients go up and down together.
    fn friction(&self) -> Result<Option<FrictionHistory>, ProblemError> {
        let Some(mu) = &self.mu else { return Ok(None) };
        let first = mu.first().cloned().unwrap_or_default();
        let mut cases: BTreeMap<Vec<u64>, Vec<f64>> = BTreeMap::new();
        for (node, &at_first) in first.iter().enumerate() {
            // A node without friction has none at all times, as Python has made sure.
            let factor =
                |row: &Vec<f64>| if at_first > 0.0 { (row[node] / at_first).to_bits() } else { 1.0_f64.to_bits() };
            let coefficients = cases.entry(mu.iter().map(factor).collect()).or_insert_with(|| vec![0.0; first.len()]);
            coefficients[node] = at_first;
        }
        let case = |(factors, mu): (Vec<u64>, Vec<f64>)| {
            (mu, self.times.iter().zip(factors).map(|(time, factor)| [*time, f64::from_bits(factor)]).collect())
        };
        FrictionHistory::new(first.len(), cases.into_iter().map(case).collect()).map(Some)
    }
}
