//! The tables of a scene, and what they become. This module checks which keys belong to which kind of table; the types
//! that use the values check their ranges. Numbers become SI here, each where its key is read.

mod action;
mod bodies;
mod contact;
mod output;
mod solver;

use std::path::Path;

use schemars::JsonSchema;
use serde::Deserialize;

use super::error::Source;
use super::values::{OneOrMany, Scalar, TimesOr, Tuple};
use super::{Scene, SceneError, Time, syntax};
use crate::algebra::vector::Vector;
use crate::base::formula::{Field, Formula, FormulaUnits};
use crate::base::input_error::{InputError, each, ensure, positive};
use crate::base::timeline::with_further_ends;
use crate::base::units::{Depth, Quantity, UnitSystem, Units};
use crate::body::description::Description;
use crate::body::fem::Material;
use action::{CouplingTable, LoadTable, PretensionTable, SpringTable, SupportTable};
use bodies::{Bodies, BodyTable, MeshTable};
use contact::ContactTable;
use output::OutputTable;
use solver::SolverTable;

/// An elastic body, its supports, obstacles and loads, and how to solve it. SI units, unless units says otherwise.
#[derive(Default, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(title = "A scene of stickslip", extend("required" = ["time"],
    "oneOf" = [{"required": ["mesh", "material"]}, {"required": ["body"]}]))]
pub(super) struct Document {
    /// A line for headings; the file's name unless given.
    title: Option<String>,
    /// The units of all numbers of the scene, its meshes and tables, and of its results, in place of those named below:
    /// others follow from these, force as stress · length². Time is in s, temperature in K, angles are in rad.
    units: Units,
    mesh: Option<MeshTable>,
    material: Option<Material>,
    /// Several bodies, in place of mesh and material; boundaries are called name:boundary.
    #[schemars(length(min = 1))]
    body: Vec<BodyTable>,
    /// Reference points that move with a boundary or a body.
    coupling: Vec<CouplingTable>,
    /// Where the body is held.
    support: Vec<SupportTable>,
    /// Boundaries that can touch an obstacle, each at most once, or another boundary.
    contact: Vec<ContactTable>,
    /// Bolts that are tightened across a section between two glued parts.
    pretension: Vec<PretensionTable>,
    /// Springs and elastic foundations.
    spring: Vec<SpringTable>,
    /// The loads of the body, which add up.
    load: Vec<LoadTable>,
    time: Option<Time>,
    solver: SolverTable,
    output: OutputTable,
}

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
    let as_written = Reader { source, units: Units::SI, depth: Depth::Whole };
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
    let parsed = toml::from_str(&reader.source.text);
    let mut document: Document = parsed.map_err(|error| syntax::error(error, reader.source))?;
    let locate = |fault| reader.source.located(fault);
    let time = document.time.take().ok_or_else(|| missing("time")).map_err(locate)?;
    let bodies = bodies::bodies(&mut document, reader).map_err(locate)?;
    let source = Source { material_keys: bodies.keys.clone(), ..reader.source.clone() };
    checked(document, time, bodies, Reader { source: &source, ..reader }).map_err(|fault| source.located(fault))
}

fn checked(document: Document, mut time: Time, bodies: Bodies, reader: Reader<'_>) -> Result<Scene, InputError> {
    let Bodies { mesh, element, refine, material, .. } = bodies;
    check_time(&time)?;
    let mut description = Description {
        mesh,
        element,
        material,
        couplings: each("coupling", document.coupling, |_, given| action::coupling(given, reader))?,
        supports: each("support", document.support, |_, given| action::support(given, reader))?,
        contacts: each("contact", document.contact, |_, given| contact::contact(given, reader))?,
        pretensions: each("pretension", document.pretension, |_, given| action::pretension(given, reader))?,
        springs: each("spring", document.spring, |_, given| action::spring(given, reader))?,
        loads: each("load", document.load, |_, given| action::load(given, reader))?,
        times: time.all(),
        units: document.units,
    };
    description.check()?;
    let is_further = |t: &f64| description.times.binary_search_by(|end| end.total_cmp(t)).is_err();
    let of_cycle = match &document.output.cycle {
        Some(TimesOr::Times(times)) => times.iter().copied().filter(|t| *t > 0.0 && *t <= time.end).collect(),
        _ => Vec::new(),
    };
    let ends = with_further_ends(&description.ends_at_kinks(&description.times), of_cycle);
    time.kinks = ends.into_iter().filter(is_further).collect();
    description.times = time.all();
    let solver = solver::solver(&document.solver)?;
    let petsc = solver::petsc(&document.solver, &solver)?;
    let output = output::output(document.output, &time, reader)?;
    let source = reader.source.clone();
    let stem = || Path::new(&source.name).file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
    let title = document.title.unwrap_or_else(stem);
    Ok(Scene { title, description, refine, time, solver, petsc, output, source })
}

/// Reads a table of a scene, and converts its numbers to SI. Errors have the keys of the table.
#[derive(Clone, Copy)]
struct Reader<'a> {
    source: &'a Source,
    units: Units,
    /// The depth of a plane body.
    depth: Depth,
}

impl Reader<'_> {
    /// Converts a quantity with the same unit in two and three dimensions.
    fn si(self, quantity: Quantity, x: f64) -> f64 {
        self.in_dimension(3, quantity, x)
    }

    fn in_dimension(self, dimension: usize, quantity: Quantity, x: f64) -> f64 {
        let depth = if dimension == 2 { self.depth } else { Depth::Whole };
        UnitSystem { depth, ..UnitSystem::new(self.units, dimension) }.to_si(quantity, x)
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

    /// Parses the formula at `name`.
    fn formula(self, quantity: Quantity, name: &str, text: &str, help: &str) -> Result<Formula, InputError> {
        let units = FormulaUnits { length: self.length(1.0), value: self.si(quantity, 1.0) };
        let formula = Formula::parse(text).map_err(|why| InputError::new(name, format!("the formula: {why}"), help))?;
        Ok(formula.written_in(units))
    }

    /// Converts a number or a formula at `name`.
    fn field(self, quantity: Quantity, name: &str, given: Scalar, help: &str) -> Result<Field, InputError> {
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

/// The error of a scene without the table `table`.
fn missing(table: &str) -> InputError {
    let help = "add the key; `stickslip init block` shows a complete scene";
    InputError::new("", format!("missing field `{table}`"), help)
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

/// Fails if several of `keys` are given, of which `whose` may have one.
fn at_most_one(whose: &str, keys: &[(&str, bool)], help: &str) -> Result<(), InputError> {
    let mut given = keys.iter().filter(|(_, given)| *given).map(|(key, _)| *key);
    match (given.next(), given.next()) {
        (Some(first), Some(second)) => {
            Err(InputError::new(second, format!("{whose} has both {first} and {second}"), help))
        }
        _ => Ok(()),
    }
}

/// The cure where two keys exclude each other.
const KEEP_ONE: &str = "keep one of them";

fn check_time(time: &Time) -> Result<(), InputError> {
    positive("time.end", time.end, "the history runs from 0 to this time, s")?;
    let help = "the history is divided into this many equal increments";
    let is_valid = (1..=10_000_000).contains(&time.increments);
    ensure(is_valid, "time.increments", &time.increments, "at least 1 and at most 10 million", help)
}

fn points(given: Vec<Tuple<f64>>) -> Vec<[f64; 2]> {
    given.into_iter().map(|Tuple(point)| point).collect()
}
