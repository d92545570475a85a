//! Every reader of the library: it takes a text, or refuses it with a message.

mod formula;
mod mesh;
mod problem;
mod results;
mod scene;
mod tables;

use miette::Diagnostic;

use crate::corpus::{Corpus, corpus};
use crate::mutate::mutated;
use crate::pool::Verdict;
use crate::random::Random;

/// A reader: what it is given, and what has to hold then.
#[derive(Debug, Clone, Copy)]
pub struct Reader {
    /// Its name, that of the folder with what was found.
    pub name: &'static str,
    /// How many of a hundred inputs are for it.
    share: usize,
    make: fn(&mut Random, &Corpus) -> Vec<u8>,
    check: fn(&[u8]) -> Verdict,
}

/// All readers; the shares add up to 100.
pub const ALL: [Reader; 12] = [
    Reader { name: "scene", share: 18, make: scene::make, check: scene::check },
    Reader { name: "override", share: 8, make: scene::make_override, check: scene::check_override },
    Reader { name: "formula", share: 18, make: formula::make, check: formula::check },
    Reader { name: "gmsh", share: 6, make: mesh::make_gmsh, check: mesh::check_gmsh },
    Reader { name: "abaqus", share: 3, make: mesh::make_abaqus, check: mesh::check_abaqus },
    Reader { name: "unv", share: 3, make: mesh::make_unv, check: mesh::check_unv },
    Reader { name: "surface", share: 4, make: tables::make_surface, check: tables::check_surface },
    Reader { name: "table", share: 10, make: tables::make, check: tables::check },
    Reader { name: "results", share: 6, make: results::make, check: results::check },
    Reader { name: "fclib", share: 8, make: problem::make_fclib, check: problem::check },
    Reader { name: "siconos", share: 8, make: problem::make_siconos, check: problem::check },
    Reader { name: "variation", share: 8, make: results::make_variation, check: results::check_variation },
];

impl Reader {
    /// Gives `bytes` to the reader.
    ///
    /// # Errors
    /// What is wrong with what it does then.
    pub fn check(&self, bytes: &[u8]) -> Verdict {
        (self.check)(bytes)
    }
}

/// The reader and the bytes of a seed.
pub fn input(seed: u64) -> (Reader, Vec<u8>) {
    let mut random = Random::new("readers", seed);
    let mut place = random.below(100);
    let reader = ALL.into_iter().find(|reader| {
        let here = place < reader.share;
        place = place.wrapping_sub(reader.share);
        here
    });
    let reader = reader.unwrap_or(ALL[0]);
    let bytes = (reader.make)(&mut random, corpus());
    (reader, bytes)
}

/// The reader and the bytes of a seed, if only the reader of this name is tried; of any without a name or with an unknown one.
pub fn input_of(name: Option<&str>, seed: u64) -> (Reader, Vec<u8>) {
    match ALL.into_iter().find(|reader| Some(reader.name) == name) {
        Some(reader) => (reader, (reader.make)(&mut Random::new(reader.name, seed), corpus())),
        None => input(seed),
    }
}

/// Gives the input of `seed` to its reader.
///
/// # Errors
/// As [`Reader::check`].
pub fn check(seed: u64) -> Verdict {
    check_of(None, seed)
}

/// Gives the input of `seed` to the reader of this name, as [`input_of`] does.
///
/// # Errors
/// As [`Reader::check`].
pub fn check_of(name: Option<&str>, seed: u64) -> Verdict {
    let (reader, bytes) = input_of(name, seed);
    reader.check(&bytes).map_err(|wrong| format!("{}: {wrong}", reader.name))
}

/// One of these texts, as it is or with changes.
fn changed(random: &mut Random, texts: &[Vec<u8>], words: &[String]) -> Vec<u8> {
    if texts.is_empty() {
        return Vec::new();
    }
    let [text, other] = [0, 1].map(|_| &texts[random.below(texts.len())]);
    if random.percent(2) { text.clone() } else { mutated(random, text, other, words) }
}

/// Fails unless a refusal has words.
fn said(error: &dyn std::error::Error) -> Verdict {
    if error.to_string().trim().is_empty() {
        Err(format!("an error without a message: {error:?}"))
    } else {
        Ok("refused")
    }
}

/// The same of one that also helps, and points into a text.
fn check_diagnostic(error: &dyn Diagnostic) -> Verdict {
    let message = error.to_string();
    let help = error.help().map(|help| help.to_string()).unwrap_or_default();
    if message.trim().is_empty() || help.trim().is_empty() {
        return Err(format!("an error without a message or without help: `{message}`, `{help}`"));
    }
    if let Some(source) = error.source_code() {
        for label in error.labels().into_iter().flatten() {
            source
                .read_span(label.inner(), 1, 1)
                .map_err(|why| format!("`{message}` points out of the text: {why}"))?;
        }
    }
    Ok("refused")
}
