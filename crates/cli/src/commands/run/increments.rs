//! `stickslip run --increments`.

use super::super::interrupt::UntilInterrupted;
use super::super::{Failure, threads};
use clap::Args;
use std::str::FromStr;
use stickslip::run::increments_for;
use stickslip::run::report::ChosenIncrements;
use stickslip::scene::{Override, Scene};

/// The default error of the tangential forces.
const ERROR: f64 = 0.05;

#[derive(Args)]
pub(super) struct IncrementArgs {
    /// Number of increments, replaces time.increments; auto: as many as the error of --to requires
    #[arg(long, value_name = "N|auto")]
    increments: Option<Increments>,
    /// Error of the tangential forces that --increments auto is to reach, as a share [default: 0.05]
    #[arg(long, value_name = "ERROR", requires = "increments", value_parser = share)]
    to: Option<f64>,
}

#[derive(Clone, Copy)]
enum Increments {
    Auto,
    Number(u32),
}

impl FromStr for Increments {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match (text, text.parse()) {
            ("auto", _) => Ok(Increments::Auto),
            (_, Ok(number)) => Ok(Increments::Number(number)),
            _ => Err("neither a number nor auto".to_string()),
        }
    }
}

/// Parses a share.
pub(in crate::commands) fn share(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share| *share > 0.0 && *share < 1.0);
    share.ok_or_else(|| "not a number between 0 and 1".to_string())
}

impl IncrementArgs {
    /// Returns `scene` with the wanted increments, and how they were chosen if they were; on `count` threads.
    pub(super) fn of(&self, scene: Scene, count: usize) -> Result<(Scene, Option<ChosenIncrements>), Failure> {
        let with = |number: i64| scene.with(&[Override::value("time.increments", number)]);
        if let (Some(_), None | Some(Increments::Number(_))) = (self.to, self.increments) {
            let cure = "remove it, or give --increments auto";
            return Err(Failure::input("--to is the error for --increments auto", cure));
        }
        match self.increments {
            None => Ok((scene, None)),
            Some(Increments::Number(number)) => Ok((with(i64::from(number))?, None)),
            Some(Increments::Auto) if scene.solver.method.is_exact_path() => {
                let help = "give the number of times for output, or remove --increments";
                Err(Failure::input("the exact path has no increments to choose", help))
            }
            Some(Increments::Auto) => {
                let prepare = |model: &_| threads::share_with_the_blas(model, count);
                let chosen = increments_for(&scene, self.to.unwrap_or(ERROR), prepare, &mut UntilInterrupted)?;
                Ok((with(chosen.increments as i64)?, Some(chosen)))
            }
        }
    }
}

/// Explains how the increments were chosen.
pub(super) fn explain(chosen: &ChosenIncrements) -> String {
    let ChosenIncrements { asked, tried, error, increments } = chosen;
    let found = match error {
        Some(error) => format!("have a time-step error of about {:.1} % in the tangential forces", 100.0 * error),
        None => "have an unknown time-step error".to_string(),
    };
    let then = if increments > tried { format!("; {increments} for {:.1} %", 100.0 * asked) } else { String::new() };
    format!("auto: {tried} {found}{then}")
}
