//! Random scenes that are run: what converges obeys the laws, and the same body told otherwise answers the same.

mod case;
mod compare;
mod generate;
pub mod laws;
mod solved;
mod tell;

pub use case::Case;
pub use tell::Telling;

use stickslip::run::Run;
use stickslip::scene::{Override, Scene};

use crate::pool::Verdict;
use crate::random::Random;
use solved::Solved;

/// The case of a seed.
pub fn case(seed: u64) -> Case {
    Case::random(&mut Random::new("runs", seed))
}

/// Runs the case of `seed` in all the ways that it can be told.
///
/// # Errors
/// What contradicts what.
pub fn check(seed: u64) -> Verdict {
    check_case(&case(seed))
}

/// The same of any case.
///
/// # Errors
/// As [`check`].
pub fn check_case(case: &Case) -> Verdict {
    let scene = parsed(&case.text(&Telling::SI))?;
    let Some(solved) = Solved::of(&scene)? else { return Ok("refused") };
    others(&scene, &solved)?;
    if !solved.converged() {
        return Ok(solved.kind());
    }
    compare::in_other_units(case, &solved)?;
    compare::mirrored(case, &solved)?;
    compare::renumbered(case, &scene, &solved)?;
    Ok(if solved.is_unique() { "converged and compared" } else { "converged" })
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

/// Other linear algebra, and the other method.
fn others(scene: &Scene, solved: &Solved) -> Result<(), String> {
    let all = [("linear", "condensed"), ("linear", "faer"), ("method", "ip")];
    // What does not converge takes all iterations that it may, and is judged in one other way only.
    for (key, value) in &all[..if solved.converged() { 3 } else { 1 }] {
        let Ok(other) = scene.with(&[Override::value(&format!("solver.{key}"), *value)]) else { continue };
        let Some(found) = Solved::of(&other).map_err(|wrong| format!("{value}: {wrong}"))? else { continue };
        compare::alike(solved, &found, compare::sorted, 1e-8).map_err(|wrong| format!("{value}: {wrong}"))?;
    }
    Ok(())
}

fn parsed(text: &str) -> Result<Scene, String> {
    Scene::parse("fuzz.toml", text, &[]).map_err(|error| format!("a sound scene is refused: {error}"))
}
