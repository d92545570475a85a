//! Histories in words: their points, and where increments step over them.

use stickslip::contact::{Obstacle, Rotation};
use stickslip::description::Load;
use stickslip::scene::{Scene, Time};
use stickslip::timeline::kinks;
use stickslip::units::UnitSystem;

/// More points than this are shortened.
const SHOWN: usize = 8;
/// Relative to the length of an increment: far above its rounding, far below what matters.
const ROUNDING: f64 = 1e-9;

/// `1 at 0 s, 2 at 1 s`; long lists are shortened.
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

/// The kinks of the histories of `scene` at which no increment ends: `the kink of the load on top at 1 s`.
pub(super) fn stepped_over(scene: &Scene, units: &UnitSystem) -> Vec<String> {
    let time = &scene.time;
    let of_load =
        |load: &Load| (format!("the load on {}", load.action.place(units)), missed(&load.factors(time.end), time));
    let of_obstacle = |boundary: &str, obstacle: &Obstacle| {
        let rotation: &[[f64; 2]] = obstacle.rotation.as_ref().map_or(&[], |Rotation { history, .. }| history);
        [
            ("approach", missed(obstacle.approach.as_deref().unwrap_or_default(), time)),
            ("translation", missed(&obstacle.path(), time)),
            ("rotation", missed(rotation, time)),
        ]
        .map(|(what, times)| (format!("the {what} of the obstacle at {boundary}"), times))
    };
    let contacts = &scene.description.contacts;
    let obstacles =
        contacts.iter().flat_map(|contact| contact.obstacles().iter().map(|given| (&contact.boundary, given)));
    let of_obstacles = obstacles.flat_map(|(boundary, obstacle)| of_obstacle(boundary, obstacle));
    let of_friction = contacts.iter().map(|contact| {
        let missed = missed(contact.friction_history.as_deref().unwrap_or_default(), time);
        (format!("the friction at {}", contact.boundary), missed)
    });
    let all = scene.description.loads.iter().map(of_load).chain(of_friction).chain(of_obstacles);
    let missed = all.filter(|(_, times)| !times.is_empty());
    let in_words = |(what, times): (String, Vec<f64>)| {
        let kinks = if times.len() == 1 { "kink" } else { "kinks" };
        format!("the {kinks} of {what} at {}", shortened(times.iter().map(|t| format!("{t} s")).collect()))
    };
    missed.map(in_words).collect()
}

/// The times of the kinks of `history` that lie inside an increment.
fn missed<const N: usize>(history: &[[f64; N]], time: &Time) -> Vec<f64> {
    let inside = |t: f64| {
        let increments = t / time.end * time.increments as f64;
        (increments - increments.round()).abs() > ROUNDING
    };
    kinks(history).into_iter().filter(|&t| t > 0.0 && t < time.end && inside(t)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinks_between_increments() {
        let time = |increments| Time { end: 2.0, increments };
        let there_and_back = [[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]];
        assert_eq!(missed(&there_and_back, &time(7)), [1.0]);
        assert_eq!(missed(&there_and_back, &time(8)), [0.0; 0]);
        // Where nothing changes there is no kink, but there is one where a history begins or ends.
        assert_eq!(missed(&[[0.0, 0.0], [0.3, 0.3], [2.0, 2.0]], &time(7)), [0.0; 0]);
        assert_eq!(missed(&[[0.3, 1.0], [0.9, 1.0]], &time(7)), [0.0; 0]);
        assert_eq!(missed(&[[0.3, 0.0], [0.9, 1.0]], &time(7)), [0.3, 0.9]);
        // Any component counts; times after the end do not.
        assert_eq!(missed(&[[0.0, 0.0, 0.0], [1.0, 0.0, 1.0], [3.0, 0.0, 0.0]], &time(3)), [1.0]);
        // 0.1 s is 3 increments but for rounding.
        assert_eq!(missed(&[[0.0, 0.0], [0.1, 1.0]], &Time { end: 0.3, increments: 9 }), [0.0; 0]);
    }
}
