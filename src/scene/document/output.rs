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

/// Times of output.
pub(in crate::scene) enum Times {
    /// The beginning and the end of each increment.
    All,
    /// The end of the first increment that reaches each of these times, s.
    These(Vec<f64>),
}

impl<'de> Deserialize<'de> for Times {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(TimesVisitor)
    }
}

struct TimesVisitor;

impl<'de> Visitor<'de> for TimesVisitor {
    type Value = Times;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of times or \"all\"")
    }

    fn visit_str<E: de::Error>(self, word: &str) -> Result<Times, E> {
        if word == "all" { Ok(Times::All) } else { Err(E::invalid_value(de::Unexpected::Str(word), &self)) }
    }

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<Times, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(values)).map(Times::These)
    }
}
