//! The output table of a scene file.

use std::fmt;

use serde::de::value::SeqAccessDeserializer;
use serde::de::{self, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::algebra::vector::Vector;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct Output {
    pub times: Option<Times>,
    pub every: Option<i64>,
    #[serde(default)]
    pub fields: bool,
    #[serde(default)]
    pub deformed: bool,
    pub magnification: Option<f64>,
    pub cycle: Option<Cycle>,
    pub wear_coefficient: Option<f64>,
    #[serde(default)]
    pub probe: Vec<Probe>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct Probe {
    pub name: String,
    pub point: Option<Vector>,
    pub from: Option<Vector>,
    pub to: Option<Vector>,
    pub points: Option<i64>,
}

/// A load cycle.
pub(in crate::scene) enum Cycle {
    /// The last one.
    Last,
    /// The one between these times, s.
    Between(Vec<f64>),
}

/// Times of output.
pub(in crate::scene) enum Times {
    /// The beginning and the end of each increment.
    All,
    /// The end of the first increment that reaches each of these times, s.
    These(Vec<f64>),
}

impl<'de> Deserialize<'de> for Times {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let visitor = WordOrTimes { word: "all", expected: "a list of times or \"all\"" };
        Ok(deserializer.deserialize_any(visitor)?.map_or(Times::All, Times::These))
    }
}

impl<'de> Deserialize<'de> for Cycle {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let visitor = WordOrTimes { word: "last", expected: "the times of its beginning and its end, or \"last\"" };
        Ok(deserializer.deserialize_any(visitor)?.map_or(Cycle::Last, Cycle::Between))
    }
}

/// Reads a list of times, or one word: `None`.
struct WordOrTimes {
    word: &'static str,
    expected: &'static str,
}

impl<'de> Visitor<'de> for WordOrTimes {
    type Value = Option<Vec<f64>>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.expected)
    }

    fn visit_str<E: de::Error>(self, word: &str) -> Result<Self::Value, E> {
        if word == self.word { Ok(None) } else { Err(E::invalid_value(de::Unexpected::Str(word), &self)) }
    }

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<Self::Value, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(values)).map(Some)
    }
}
