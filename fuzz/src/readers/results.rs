//! What is read back: reports of runs, and what a sweep varies.

use std::error::Error;

use stickslip_cli::sweep::{VariantResult, Variation, combinations};

use super::{changed, said};
use crate::corpus::Corpus;
use crate::mutate::mutated;
use crate::pool::Verdict;
use crate::random::Random;

pub(super) fn make(random: &mut Random, corpus: &Corpus) -> Vec<u8> {
    changed(random, &corpus.results, &corpus.words)
}

/// Errors that an outcome tells are numbers, and none is above the largest.
pub(super) fn check(bytes: &[u8]) -> Verdict {
    let Some(outcome) = VariantResult::read(&String::from_utf8_lossy(bytes), &[]) else { return Ok("refused") };
    if outcome.values["error"].as_f64().is_some_and(f64::is_nan) {
        return Err("an error that is no number".to_string());
    }
    let text = outcome.values.to_string();
    let again: serde_json::Value = serde_json::from_str(&text).map_err(|error| format!("read again: {error}"))?;
    if again["status"] == outcome.status.as_str() { Ok("read") } else { Err(format!("written as {text}")) }
}

const VARIATIONS: [&str; 7] = [
    "contact.friction=0.1:0.8:8",
    "load[0].traction=[0,-1e6], [0,-2e6]",
    "mesh.file=a.msh,'b,c.msh',\"d.msh\"",
    "time.increments=10:30:3",
    "material.young=1e9:-1e9:3",
    "title=a:b:c,d",
    "solver.method=bn,ip",
];

pub(super) fn make_variation(random: &mut Random, corpus: &Corpus) -> Vec<u8> {
    let [text, other] = [0, 1].map(|_| random.one(&VARIATIONS).as_bytes());
    mutated(random, text, other, &corpus.words)
}

/// What is varied has its values all different, and as many combinations as values.
pub(super) fn check_variation(bytes: &[u8]) -> Verdict {
    let variation: Variation = match String::from_utf8_lossy(bytes).parse() {
        Ok(variation) => variation,
        Err(error) => return said(&*Box::<dyn Error>::from(error)),
    };
    let mut values = variation.values.clone();
    values.sort();
    values.dedup();
    if values.len() != variation.values.len() || values.len() < 2 {
        return Err(format!("values {:?}", variation.values));
    }
    match combinations(std::slice::from_ref(&variation)) {
        Ok(variants) if variants.len() == values.len() => Ok("read"),
        Ok(variants) => Err(format!("{} combinations of {} values", variants.len(), values.len())),
        Err(error) => said(&*Box::<dyn Error>::from(error)),
    }
}
