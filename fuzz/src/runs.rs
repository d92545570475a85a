//! Random scenes that are run: what converges obeys the laws, and the same body told otherwise answers the same.

mod case;
mod compare;
mod generate;
mod joined;
pub mod laws;
mod scene_text;
mod solved;

pub use case::Case;
pub use scene_text::TextOptions;

use stickslip::run::Run;
use stickslip::scene::{Override, Scene};

use crate::pool::Verdict;
use crate::random::Random;
use solved::Solved;

/// One of so many seeds is a scene whose bodies are joined or beside each other.
const JOINED: u64 = 5;

/// The case of a seed.
pub fn case(seed: u64) -> Case {
    Case::random(&mut Random::new("runs", seed))
}

/// Runs the case of `seed` in all the ways that it can be told.
///
/// # Errors
/// What contradicts what.
pub fn check(seed: u64) -> Verdict {
    if is_joined(seed) { check_scene(&text(seed)) } else { check_case(&case(seed)) }
}

/// The text of the scene of a seed.
pub fn text(seed: u64) -> String {
    if is_joined(seed) { joined::text(&mut Random::new("joined", seed)) } else { case(seed).text(&TextOptions::SI) }
}

fn is_joined(seed: u64) -> bool {
    seed % JOINED == JOINED - 1
}

/// The same of any case.
///
/// # Errors
/// As [`check`].
pub fn check_case(case: &Case) -> Verdict {
    let scene = parsed(&case.text(&TextOptions::SI))?;
    let Some(solved) = Solved::of(&scene)? else { return Ok("refused") };
    let two = others(&scene, &solved)?;
    if !solved.converged() {
        return Ok(solved.kind());
    }
    compare::in_other_units(case, &solved)?;
    compare::mirrored(case, &solved)?;
    compare::renumbered(case, &scene, &solved)?;
    Ok(match (two, solved.is_unique()) {
        (true, _) => "of two solutions",
        (false, true) => "converged and compared",
        (false, false) => "converged",
    })
}

/// Runs a scene file that is sound, also by other linear algebra and by the other method.
///
/// # Errors
/// As [`check`], and where it is refused.
pub fn check_scene(text: &str) -> Verdict {
    let name = crate::corpus::scenes().join("fuzz.toml").display().to_string();
    let refused = |error: &dyn std::error::Error| format!("a sound scene is refused: {error}");
    let scene = Scene::parse(&name, text, &[]).map_err(|error| refused(&error))?;
    let run = Run::new(&scene).map_err(|error| refused(&error))?;
    let solved = Solved::run(run, scene.solver)?;
    others(&scene, &solved)?;
    Ok(solved.kind())
}

/// Other linear algebra, and the other method. Tells whether that has found another solution: where its contact nodes are in other
/// statuses, and either obeys all laws, there are two, as there may be at any friction above some bound that nobody knows.
fn others(scene: &Scene, solved: &Solved) -> Result<bool, String> {
    let all = [("linear", "condensed"), ("linear", "faer"), ("method", "ip")];
    let mut two = false;
    // What does not converge takes all iterations that it may, and is judged in one other way only.
    for (key, value) in &all[..if solved.converged() { 3 } else { 1 }] {
        let wrong = |wrong: String| format!("{value}: {wrong}");
        let Ok(other) = scene.with(&[Override::value(&format!("solver.{key}"), *value)]) else { continue };
        let Some(found) = Solved::of(&other).map_err(wrong)? else { continue };
        match compare::difference(solved, &found, compare::sorted, 1e-8).map_err(wrong)? {
            Some((k, _)) if *key == "method" && solved.increments[k].statuses != found.increments[k].statuses => {
                two = true;
            }
            Some((k, by)) => return Err(wrong(format!("contact forces of increment {} differ by {by:.2e}", k + 1))),
            None => {}
        }
    }
    Ok(two)
}

fn parsed(text: &str) -> Result<Scene, String> {
    Scene::parse("fuzz.toml", text, &[]).map_err(|error| format!("a sound scene is refused: {error}"))
}
