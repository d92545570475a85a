//! The output of a scene.

use super::{foreign, needed};
use crate::base::input_error::{InputError, ensure, finite};
use crate::body::description::{CycleChoice, CycleRequest, Probe, ProbePlace};
use crate::scene::document::{self, Times};
use crate::scene::{Output, Time};

/// Converts `given` to the output of a history over `time`.
pub(super) fn output(given: document::Output, time: &Time) -> Result<Output, InputError> {
    let document::Output { times, every, fields, deformed, magnification, cycle, wear_coefficient, probe } = given;
    if let Some(every) = every {
        let help = "1 stands for each increment, 10 for every tenth; the last one is always written";
        ensure(every >= 1, "output.every", &every, "at least 1", help)?;
    }
    let mut every = every.map(|every| every as usize);
    let times = match times {
        Some(Times::All) => {
            foreign("every", every.as_ref(), "output.times = \"all\"").map_err(|fault| fault.with_key("output"))?;
            every = Some(1);
            vec![0.0]
        }
        Some(Times::These(times)) => times,
        None if every.is_some() => Vec::new(),
        None => vec![time.end],
    };
    if let Some(t) = times.iter().find(|&&t| t.is_nan() || t < 0.0 || t > time.end) {
        let message = format!("output.times holds {t}, but the history runs from 0 to {}", time.end);
        return Err(InputError::new(
            "output.times",
            message,
            "give times from 0 (before the first increment) to time.end, s",
        ));
    }
    if let Some(magnification) = magnification {
        let key = "output.magnification";
        finite(key, magnification)?;
        ensure(
            magnification >= 0.0,
            key,
            &magnification,
            "0 or more",
            "displacements are drawn so many times as long",
        )?;
        if !deformed {
            let message = "output.magnification is given, but no picture of the deformed body is asked for";
            return Err(InputError::new(key, message, "add output.deformed = true, or remove the key"));
        }
    }
    let probes = probe.into_iter().enumerate().map(|(k, given)| self::probe(&format!("output.probe[{k}]"), given));
    let probes: Vec<Probe> = probes.collect::<Result<_, _>>()?;
    Probe::check(&probes)?;
    let cycle = self::cycle(cycle, wear_coefficient, time).map_err(|fault| fault.with_key("output"))?;
    Ok(Output { times, every, fields, deformed, magnification, cycle, probes })
}

/// Converts the keys of a load cycle.
fn cycle(
    given: Option<document::Cycle>,
    wear_coefficient: Option<f64>,
    time: &Time,
) -> Result<Option<CycleRequest>, InputError> {
    let choice = match given {
        None => {
            return foreign("wear_coefficient", wear_coefficient.as_ref(), "an output without a cycle").map(|()| None);
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

fn probe(key: &str, given: document::Probe) -> Result<Probe, InputError> {
    let document::Probe { name, point, from, to, points } = given;
    let place = if let Some(point) = point {
        let alone = |name: &str, is_given: bool| {
            let whose = "a probe with a point";
            foreign(name, is_given.then_some(&()), whose).map_err(|fault| fault.with_key(key))
        };
        alone("from", from.is_some())?;
        alone("to", to.is_some())?;
        alone("points", points.is_some())?;
        ProbePlace::Point(point)
    } else {
        let whose = "a probe without a point";
        let from = needed("from", from, key, whose)?;
        let to = needed("to", to, key, whose)?;
        let count = needed("points", points, key, whose)?;
        let help = "the ends count; use output.fields for the whole body";
        ensure(count >= 2, &format!("{key}.points"), &count, "at least 2 and at most 10000", help)?;
        ProbePlace::Line { from, to, count: count as usize }
    };
    Ok(Probe { name, place })
}
