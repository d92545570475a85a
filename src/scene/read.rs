//! Conversion of the deserialised tables to a scene. This module checks which keys belong to which kind of table; the
//! types that use the values check their ranges. Numbers become SI here, each where its key is read.

mod action;
mod bodies;
mod contact;
mod output;
mod solver;

use std::path::Path;

use super::document::{self, Document, Scalar, Tuple};
use super::error::Source;
use super::{Scene, SceneError, Time};
use crate::algebra::vector::Vector;
use crate::base::formula::{Field, Formula, FormulaUnits};
use crate::base::input_error::{InputError, ensure, finite};
use crate::base::timeline::with_further_ends;
use crate::base::units::{Depth, Quantity, UnitSystem, Units};
use crate::body::description::Description;
use crate::body::fem::Material;
use bodies::Bodies;

/// Lists optional keys of a table, each with `true` if it is given. Messages name them behind the prefix `under`, such
/// as `obstacle.`.
macro_rules! given {
    ($table:expr; $($key:ident)*) => { $crate::scene::read::given!("", $table; $($key)*) };
    ($under:literal, $table:expr; $($key:ident)*) => {
        &[$((concat!($under, stringify!($key)), $table.$key.is_some())),*]
    };
}
use given;

/// Reads the scene of `source`.
///
/// The scene is read twice: first with the numbers of the text, which messages quote, then in SI units. The second
/// reading can only find numbers that are too large for the solver.
pub(super) fn scene(source: &Source) -> Result<Scene, SceneError> {
    let as_written = Reader { source, key: "", units: Units::SI, depth: Depth::Whole };
    let scene = scene_by(as_written)?;
    let (units, material) = (scene.description.units, &scene.description.material);
    if units == Units::SI && material.thickness.is_none() {
        return Ok(scene);
    }
    let in_units = Reader { units, ..as_written };
    let thickness = material.thickness.map(|x| in_units.length(x));
    let depth = Material { thickness, ..material.clone() }.depth(2);
    scene_by(Reader { depth, ..in_units }).map_err(SceneError::in_si)
}

fn scene_by(reader: Reader<'_>) -> Result<Scene, SceneError> {
    let mut document = Document::parse(reader.source)?;
    let Bodies { mesh, element, refine, material, keys } = bodies::bodies(&mut document, reader)?;
    let source = Source { material_keys: keys, ..reader.source.clone() };
    let reader = Reader { source: &source, ..reader };
    let mut time = time(&document.time).map_err(|fault| reader.at(fault))?;
    let mut description = Description {
        mesh,
        element,
        material,
        couplings: reader.each("coupling", document.coupling, action::coupling)?,
        supports: reader.each("support", document.support, action::support)?,
        contacts: reader.each("contact", document.contact, contact::contact)?,
        pretensions: reader.each("pretension", document.pretension, action::pretension)?,
        springs: reader.each("spring", document.spring, action::spring)?,
        loads: reader.each("load", document.load, action::load)?,
        times: time.all(),
        units: document.units,
    };
    description.check().map_err(|fault| reader.at(fault))?;
    let is_further = |t: &f64| description.times.binary_search_by(|end| end.total_cmp(t)).is_err();
    let of_cycle = match &document.output.cycle {
        Some(document::Cycle::Between(times)) => times.iter().copied().filter(|t| *t > 0.0 && *t <= time.end).collect(),
        _ => Vec::new(),
    };
    let ends = with_further_ends(&description.ends_at_kinks(&description.times), of_cycle);
    time.kinks = ends.into_iter().filter(is_further).collect();
    description.times = time.all();
    let solver = solver::solver(&document.solver).map_err(|fault| reader.at(fault))?;
    let petsc = solver::petsc(&document.solver, &solver).map_err(|fault| reader.at(fault))?;
    let one_tangent_key = solver::one_tangent_key(solver.method.increments());
    let output = output::output(document.output, &time, reader).map_err(|fault| reader.at(fault))?;
    let stem = || Path::new(&source.name).file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
    let title = document.title.unwrap_or_else(stem);
    Ok(Scene { title, description, refine, time, solver, one_tangent_key, petsc, output, source })
}

/// Reads a table of a scene: names its keys in errors, and converts its numbers to SI.
#[derive(Clone, Copy)]
struct Reader<'a> {
    source: &'a Source,
    /// The key of the table; empty for the scene itself.
    key: &'a str,
    units: Units,
    /// The depth of a plane body.
    depth: Depth,
}

impl Reader<'_> {
    /// Reads each entry of the list of tables at `list`.
    fn each<T, U>(
        self,
        list: &str,
        given: Vec<T>,
        mut read: impl FnMut(T, Reader<'_>) -> Result<U, SceneError>,
    ) -> Result<Vec<U>, SceneError> {
        let list = self.path(list);
        let entry = |(k, given)| read(given, Reader { key: &format!("{list}[{k}]"), ..self });
        given.into_iter().enumerate().map(entry).collect()
    }

    /// Returns the path of the key `name`.
    fn path(self, name: &str) -> String {
        match (self.key, name) {
            ("", key) | (key, "") => key.to_string(),
            (table, name) => format!("{table}.{name}"),
        }
    }

    /// Places the error of a key of the table, or of the table itself where the key is empty.
    fn at(self, fault: InputError) -> SceneError {
        self.source.located(InputError { key: self.path(&fault.key), ..fault })
    }

    fn fault<T>(self, name: &str, message: impl Into<String>, help: impl Into<String>) -> Result<T, SceneError> {
        Err(self.at(InputError::new(name, message, help)))
    }

    /// Returns the value at `name`, which `whose` requires. If it is missing, the error points at `kind`.
    fn needed<T>(self, name: &str, value: Option<T>, kind: &str, whose: &str) -> Result<T, SceneError> {
        needed(name, value, kind, whose).map_err(|fault| self.at(fault))
    }

    /// Fails if one of `keys` is given, which do not belong to `whose`.
    fn reject_keys(self, whose: &str, keys: &[(&str, bool)]) -> Result<(), SceneError> {
        reject_keys(whose, keys).map_err(|fault| self.at(fault))
    }

    /// Converts a quantity with the same unit in two and three dimensions.
    fn si(self, quantity: Quantity, x: f64) -> f64 {
        self.in_dimension(3, quantity, x)
    }

    fn in_dimension(self, dimension: usize, quantity: Quantity, x: f64) -> f64 {
        let depth = if dimension == 2 { self.depth } else { Depth::Whole };
        UnitSystem { units: self.units, dimension, depth }.to_si(quantity, x)
    }

    fn length(self, x: f64) -> f64 {
        self.si(Quantity::Length, x)
    }

    fn point(self, x: Vector) -> Vector {
        x.map(|c| self.length(c))
    }

    /// Converts components of a vector, or about the axes: one of a plane body.
    fn components(self, quantity: Quantity, x: Vec<f64>) -> Vec<f64> {
        let dimension = x.len().clamp(2, 3);
        x.into_iter().map(|c| self.in_dimension(dimension, quantity, c)).collect()
    }

    /// Parses the formula at `name`; the error points at the wrong part of the formula.
    fn formula(self, quantity: Quantity, name: &str, text: &str, help: &str) -> Result<Formula, SceneError> {
        let units = FormulaUnits { length: self.length(1.0), value: self.si(quantity, 1.0) };
        let formula = Formula::parse(text).map_err(|why| {
            let fault = InputError::new(self.path(name), format!("the formula: {why}"), help);
            self.source.located_within(fault, text, &why.span)
        });
        Ok(formula?.written_in(units))
    }

    /// Converts a number or a formula at `name`.
    fn field(self, quantity: Quantity, name: &str, given: Scalar, help: &str) -> Result<Field, SceneError> {
        Ok(match given {
            Scalar::Number(value) => self.si(quantity, value).into(),
            Scalar::Text(text) => self.formula(quantity, name, &text, help)?.into(),
        })
    }
}

/// Returns the value at `name`, which `whose` requires. If it is missing, the error points at `kind`.
fn needed<T>(name: &str, value: Option<T>, kind: &str, whose: &str) -> Result<T, InputError> {
    value.ok_or_else(|| InputError::new(kind, format!("{whose} needs {name}"), "add the key"))
}

/// Fails if one of `keys` is given, which do not belong to `whose`.
fn reject_keys(whose: &str, keys: &[(&str, bool)]) -> Result<(), InputError> {
    only(whose, &[], keys)
}

/// Fails if one of `keys` is given, but those of `whose` are only its `own`.
fn only(whose: &str, own: &[&str], keys: &[(&str, bool)]) -> Result<(), InputError> {
    match keys.iter().find(|(key, given)| *given && !own.contains(key)) {
        None => Ok(()),
        Some((key, _)) => Err(InputError::new(*key, format!("{whose} has no {key}"), "remove the key")),
    }
}

fn time(time: &document::Time) -> Result<Time, InputError> {
    let document::Time { end, increments } = *time;
    finite("time.end", end)?;
    ensure(end > 0.0, "time.end", &end, "positive", "the history runs from 0 to this time, s")?;
    let help = "the history is divided into this many equal increments";
    let is_valid = (1..=10_000_000).contains(&increments);
    ensure(is_valid, "time.increments", &increments, "at least 1 and at most 10 million", help)?;
    Ok(Time { end, increments: increments as usize, kinks: Vec::new() })
}

fn points(given: Vec<Tuple<f64>>) -> Vec<[f64; 2]> {
    given.into_iter().map(|Tuple(point)| point).collect()
}
