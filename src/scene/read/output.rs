//! The output of a scene.

use super::{Reader, given, needed, reject_keys};
use crate::base::input_error::{InputError, each, ensure, finite};
use crate::base::units::Quantity;
use crate::body::description::{CycleChoice, CycleRequest, Probe, ProbePlace};
use crate::scene::document::{self, Times};
use crate::scene::{Output, Time};

/// Converts `given` to the output of a history over `time`.
pub(super) fn output(given: document::Output, time: &Time, reader: Reader<'_>) -> Result<Output, InputError> {
    let in_output = |fault: InputError| fault.with_key("output");
    let document::Output { times, every, fields, deformed, magnification, cycle, wear_coefficient, probe } = given;
    if let Some(every) = every {
        let help = "1 stands for each increment, 10 for every tenth; the last one is always written";
        ensure(every >= 1, "output.every", &every, "at least 1", help)?;
    }
    let mut every = every.map(|every| every as usize);
    let times = match times {
        Some(Times::All) => {
            reject_keys("output.times = \"all\"", &[("every", every.is_some())]).map_err(in_output)?;
            every = Some(1);
            vec![0.0]
        }
        Some(Times::These(times)) => times,
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
    given: Option<document::Cycle>,
    wear_coefficient: Option<f64>,
    time: &Time,
) -> Result<Option<CycleRequest>, InputError> {
    let choice = match given {
        None => {
            let key = [("wear_coefficient", wear_coefficient.is_some())];
            return reject_keys("an output without a cycle", &key).map(|()| None);
        }
        Some(document::Cycle::Last) => CycleChoice::Last,
        Some(document::Cycle::Between(times)) => match times[..] {
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

fn probe(given: document::Probe, reader: Reader<'_>) -> Result<Probe, InputError> {
    let place = if let Some(point) = given.point {
        reject_keys("a probe with a point", given!(given; from to points))?;
        ProbePlace::Point(reader.point(point))
    } else {
        let whose = "a probe without a point";
        let [from, to] = [("from", given.from), ("to", given.to)].map(|(key, point)| needed(key, point, "", whose));
        let (from, to) = (reader.point(from?), reader.point(to?));
        let count = needed("points", given.points, "", whose)?;
        let help = "the ends count; use output.fields for the whole body";
        ensure(count >= 2, "points", &count, "at least 2 and at most 10000", help)?;
        ProbePlace::Line { from, to, count: count as usize }
    };
    Ok(Probe { name: given.name, place })
}
