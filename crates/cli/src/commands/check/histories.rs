//! Describes histories: their points, and their kinks within increments.

use stickslip::base::{UnitSystem, equal_increments};
use stickslip::body::Kinks;
use stickslip::scene::{Scene, Time};

/// Histories with more points than this are shortened.
const SHOWN: usize = 8;

/// Formats points as `1 at 0 s, 2 at 1 s`. Long lists are shortened.
pub(super) fn points<const N: usize>(history: &[[f64; N]], value: impl Fn(&[f64]) -> String) -> String {
    shortened(history.iter().map(|point| format!("{} at {} s", value(&point[1..]), point[0])).collect())
}

fn shortened(mut words: Vec<String>) -> String {
    if words.len() > SHOWN {
        let left_out = format!("({} more)", words.len() + 1 - SHOWN);
        words.splice(SHOWN - 2..words.len() - 1, [left_out]);
    }
    words.join(", ")
}

/// Lists the kinks of the histories of `scene` that do not coincide with the end of an increment: `the kink of the load
/// on top at 1 s`.
pub(super) fn between(scene: &Scene, units: &UnitSystem) -> Vec<String> {
    let Time { end, increments, .. } = scene.time;
    let in_words = |found: Kinks<'_>| {
        let times: Vec<String> = found.times.iter().map(|t| format!("{t} s")).collect();
        let kinks = if times.len() == 1 { "kink" } else { "kinks" };
        format!("the {kinks} of {} at {}", found.history(units), shortened(times))
    };
    scene.description.kinks_between(&equal_increments(end, increments)).into_iter().map(in_words).collect()
}
