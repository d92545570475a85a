//! The output of a scene: its tables, and what they become.

use serde_json::Value;

use super::{Deserialize, JsonSchema, Reader, given, needed, reject_keys};
use crate::algebra::vector::Vector;
use crate::base::input_error::{InputError, each, ensure, finite};
use crate::base::units::Quantity;
use crate::body::description::{CycleChoice, CycleRequest, Probe, ProbePlace};
use crate::scene::values::{ALL, LAST, TimesOr};
use crate::scene::{Output, Time};

/// The output.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(default, deny_unknown_fields, rename = "output")]
pub(super) struct OutputTable {
    /// Times of contact tables and pictures, at the first increment that reaches each; 0 is the undeformed body;
    /// `"all"`: 0 and every increment.
    /// Example: `times = [0, 1.0, 2.0]`. Value: list of times, s, or `"all"`. Default: `[end]`; none with `every`.
    #[schemars(with = "Value", extend("anyOf" = [{"const": "all"}, {"type": "array", "items": {"type": "number", "minimum": 0}}]))]
    pub times: Option<TimesOr<ALL>>,
    /// Also every so many increments, and the last. Not with `"all"`.
    /// Example: `every = 10`. Value: integer.
    #[schemars(extend("minimum" = 1))]
    pub every: Option<i64>,
    /// Fields for ParaView at these times.
    /// Example: `fields = true`. Default: `false`.
    pub fields: bool,
    /// Pictures of the deformed body at these times.
    /// Example: `deformed = true`. Default: `false`.
    pub deformed: bool,
    /// Their factor on displacements. Automatic: 1, 2 or 5 times a power of ten, at least 1, with which the longest
    /// is at most a twentieth of the body.
    /// Example: `magnification = 100`. Default: automatic.
    #[schemars(extend("minimum" = 0))]
    pub magnification: Option<f64>,
    /// Load cycle whose slip, friction work and stresses are written to [`cycle.csv`](../files.md#columns) and
    /// `run.json`. Increments end at both times. `"last"`: the last whole cycle. It ends with the last increment in
    /// which a load changes, and begins one period earlier: loads, motions and friction factors have the same
    /// values there, and change in the same direction.
    /// Example: `cycle = [1.0, 2.0]`. Value: two times, s, or `"last"`.
    #[schemars(with = "Value", extend("anyOf" = [{"const": "last"}, {"type": "array", "minItems": 2, "maxItems": 2, "items": {"type": "number", "minimum": 0}}]))]
    pub cycle: Option<TimesOr<LAST>>,
    /// Archard's coefficient k: `cycle.csv` has the wear depth of the cycle, k ∫ pressure d(slip path).
    /// Example: `wear_coefficient = 1e-14`. Value: number, 1/Pa.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub wear_coefficient: Option<f64>,
    /// Points whose displacements and stresses are written in every increment.
    pub probe: Vec<ProbeTable>,
}

/// A point of the body, or a row of them on a line.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "probe")]
pub(super) struct ProbeTable {
    /// Part of the file name, `probe_root.csv`.
    /// Example: `name = "root"`. Value: text.
    pub name: String,
    /// The point.
    /// Example: `point = [0.1, 0.05]`. Value: point, m. Default: this or a line.
    pub point: Option<Vector>,
    /// First point of a line.
    /// Example: `from = [0, 0.05]`. Value: point, m.
    pub from: Option<Vector>,
    /// Last point of the line.
    /// Example: `to = [0.2, 0.05]`. Value: point, m.
    pub to: Option<Vector>,
    /// Equally spaced points, ends included.
    /// Example: `points = 21`. Value: integer.
    #[schemars(extend("minimum" = 2, "maximum" = 10_000))]
    pub points: Option<usize>,
}

/// Converts `given` to the output of a history over `time`.
pub(super) fn output(given: OutputTable, time: &Time, reader: Reader<'_>) -> Result<Output, InputError> {
    let in_output = |fault: InputError| fault.with_key("output");
    let OutputTable { times, every, fields, deformed, magnification, cycle, wear_coefficient, probe } = given;
    if let Some(every) = every {
        let help = "1 stands for each increment, 10 for every tenth; the last one is always written";
        ensure(every >= 1, "output.every", &every, "at least 1", help)?;
    }
    let mut every = every.map(|every| every as usize);
    let times = match times {
        Some(TimesOr::Word) => {
            reject_keys("output.times = \"all\"", &[("every", every.is_some())]).map_err(in_output)?;
            every = Some(1);
            vec![0.0]
        }
        Some(TimesOr::Times(times)) => times,
        None if every.is_some() => Vec::new(),
        None => vec![time.end],
    };
    if let Some(t) = times.iter().find(|&&t| t.is_nan() || t < 0.0 || t > time.end) {
        let message = format!("output.times holds {t}, but the history runs from 0 to {}", time.end);
        let help = "give times from 0 (before the first increment) to time.end, s";
        return Err(InputError::new("output.times", message, help));
    }
    if let Some(magnification) = magnification {
        let key = "output.magnification";
        finite(key, magnification)?;
        let help = "displacements are drawn so many times as long";
        ensure(magnification >= 0.0, key, &magnification, "0 or more", help)?;
        if !deformed {
            let message = "output.magnification is given, but no picture of the deformed body is asked for";
            return Err(InputError::new(key, message, "add output.deformed = true, or remove the key"));
        }
    }
    let probes: Vec<Probe> = each("output.probe", probe, |_, given| self::probe(given, reader))?;
    Probe::check(&probes)?;
    let wear_coefficient = wear_coefficient.map(|k| k / reader.si(Quantity::Stress, 1.0));
    let cycle = self::cycle(cycle, wear_coefficient, time).map_err(in_output)?;
    Ok(Output { times, every, fields, deformed, magnification, cycle, probes })
}

/// Converts the keys of a load cycle; `wear_coefficient` is in 1/Pa.
fn cycle(
    given: Option<TimesOr<LAST>>,
    wear_coefficient: Option<f64>,
    time: &Time,
) -> Result<Option<CycleRequest>, InputError> {
    let choice = match given {
        None => {
            let key = [("wear_coefficient", wear_coefficient.is_some())];
            return reject_keys("an output without a cycle", &key).map(|()| None);
        }
        Some(TimesOr::Word) => CycleChoice::Last,
        Some(TimesOr::Times(times)) => match times[..] {
            [start, end] if end <= time.end => CycleChoice::Between([start, end]),
            _ => {
                let message = format!("cycle is {times:?}, but the history runs from 0 to {}", time.end);
                let help = "give the times of the beginning and the end of the cycle, s, or \"last\"";
                return Err(InputError::new("cycle", message, help));
            }
        },
    };
    CycleRequest::new(choice, wear_coefficient).map(Some)
}

fn probe(given: ProbeTable, reader: Reader<'_>) -> Result<Probe, InputError> {
    let place = if let Some(point) = given.point {
        reject_keys("a probe with a point", given!(given; from to points))?;
        ProbePlace::Point(reader.point(point))
    } else {
        let whose = "a probe without a point";
        let [from, to] = [("from", given.from), ("to", given.to)].map(|(key, point)| needed(key, point, "", whose));
        let (from, to) = (reader.point(from?), reader.point(to?));
        let count = needed("points", given.points, "", whose)?;
        ProbePlace::Line { from, to, count }
    };
    Ok(Probe { name: given.name, place })
}
