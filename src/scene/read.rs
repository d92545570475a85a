//! Conversion of the deserialised tables to a scene. This module checks which keys belong to which kind of table; the
//! types that use the values check their ranges.

mod action;
mod bodies;
mod contact;
mod coupling;
mod mesh;
mod obstacle;
mod output;
mod pretension;
mod solver;

use std::path::Path;

use super::document::{self, Document, Tuple};
use super::error::Source;
use super::{Scene, SceneError, Time};
use crate::base::formula::Formula;
use crate::base::input_error::{InputError, ensure, finite};
use crate::base::timeline::with_further_ends;
use crate::base::units::Units;
use crate::body::description::Description;
use bodies::Bodies;

/// Converts `document`, which was read from `source`, to a scene.
pub(super) fn scene(mut document: Document, mut source: Source) -> Result<Scene, SceneError> {
    let Bodies { mesh, element, material, keys } =
        bodies::bodies(&mut document, &source).map_err(|fault| source.located(fault))?;
    source.material_keys = keys;
    let at = |fault: InputError| source.located(fault);
    let mut time = time(&document.time).map_err(at)?;
    let contacts: Vec<_> = document.contact.into_iter().enumerate().collect();
    let mut given = Description {
        mesh,
        element,
        material,
        couplings: keyed("coupling", document.coupling, |given, key| coupling::coupling(given, key).map_err(at))?,
        supports: keyed("support", document.support, |given, key| action::support(given, key).map_err(at))?,
        contacts: contacts
            .into_iter()
            .map(|(k, given)| contact::contact(k, given, &source))
            .collect::<Result<_, _>>()?,
        pretensions: keyed("pretension", document.pretension, |given, key| {
            pretension::pretension(given, key).map_err(at)
        })?,
        springs: keyed("spring", document.spring, |given, key| action::spring(given, key).map_err(at))?,
        loads: keyed("load", document.load, |given, key| action::load(given, key, &source))?,
        times: time.all(),
        units: Units::SI,
    };
    // The values are checked before and after the conversion of units: messages quote the numbers of the scene, but
    // numbers too large for the solver are found only in SI.
    given.check().map_err(at)?;
    let is_further = |t: &f64| given.times.binary_search_by(|end| end.total_cmp(t)).is_err();
    let of_cycle = match &document.output.cycle {
        Some(document::Cycle::Between(times)) => times.iter().copied().filter(|t| *t > 0.0 && *t <= time.end).collect(),
        _ => Vec::new(),
    };
    let ends = with_further_ends(&given.ends_at_kinks(&given.times), of_cycle);
    time.kinks = ends.into_iter().filter(is_further).collect();
    given.times = time.all();
    let description = given.given_in(document.units);
    description.check().map_err(|fault| at(fault.in_si()))?;
    let solver = solver::solver(&document.solver, !description.contacts.is_empty()).map_err(at)?;
    let one_tangent_key = solver::one_tangent_key(solver.method.increments());
    let mut output = output::output(document.output, &time).map_err(at)?;
    output.probes = output.probes.into_iter().map(|probe| probe.given_in(document.units)).collect();
    output.cycle = output.cycle.map(|cycle| cycle.given_in(document.units));
    let stem = || Path::new(&source.name).file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
    let title = document.title.unwrap_or_else(stem);
    Ok(Scene { title, description, time, solver, one_tangent_key, output, source })
}

/// Converts each entry of a list with its key.
fn keyed<T, U>(
    list: &str,
    given: Vec<T>,
    read: impl Fn(T, &str) -> Result<U, SceneError>,
) -> Result<Vec<U>, SceneError> {
    given.into_iter().enumerate().map(|(k, given)| read(given, &format!("{list}[{k}]"))).collect()
}

/// Returns the value at `key`, which `whose` requires. If it is missing, the error points at `kind`.
fn needed<T>(key: &str, value: Option<T>, kind: &str, whose: &str) -> Result<T, InputError> {
    value.ok_or_else(|| InputError::new(kind, format!("{whose} needs {key}"), "add the key"))
}

/// Fails if `value` is given although `key` does not belong to `whose`.
fn foreign<T>(key: &str, value: Option<&T>, whose: &str) -> Result<(), InputError> {
    value.map_or(Ok(()), |_| Err(InputError::new(key, format!("{whose} has no {key}"), "remove the key")))
}

fn time(time: &document::Time) -> Result<Time, InputError> {
    let document::Time { end, increments } = *time;
    finite("time.end", end)?;
    ensure(end > 0.0, "time.end", &end, "positive", "the history runs from 0 to this time, s")?;
    let help = "the history is divided into this many equal increments";
    let sound = (1..=10_000_000).contains(&increments);
    ensure(sound, "time.increments", &increments, "at least 1 and at most 10 million", help)?;
    Ok(Time { end, increments: increments as usize, kinks: Vec::new() })
}

/// Parses the formula at `key`; the error points at the wrong part of the formula.
fn formula(text: &str, key: String, help: &str, source: &Source) -> Result<Formula, SceneError> {
    Formula::parse(text).map_err(|why| {
        let fault = InputError::new(key, format!("the formula: {why}"), help);
        source.located_within(fault, text, &why.span)
    })
}

fn points(given: Vec<Tuple<f64>>) -> Vec<[f64; 2]> {
    given.into_iter().map(|Tuple(point)| point).collect()
}
