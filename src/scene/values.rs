//! Values of a scene file that have several forms: lists of a fixed length, a value or a list, a number or a formula.

use std::fmt;
use std::marker::PhantomData;

use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{IntoDeserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, de};

/// A list of `N` values, by default two.
// A plain array would not do because the TOML reader ignores surplus values.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(try_from = "Vec<T>")]
#[schemars(inline, with = "Vec<T>", extend("minItems" = N, "maxItems" = N))]
pub(super) struct Tuple<T, const N: usize = 2>(pub [T; N]);

impl<T, const N: usize> TryFrom<Vec<T>> for Tuple<T, N> {
    type Error = String;

    fn try_from(values: Vec<T>) -> Result<Self, String> {
        let count = values.len();
        values.try_into().map(Tuple).map_err(|_| format!("invalid length {count}, expected {N} values"))
    }
}

/// One value, or a list of several.
#[derive(Clone, JsonSchema)]
#[schemars(inline, untagged)]
pub(super) enum OneOrMany<T> {
    One(T),
    Many(#[schemars(length(min = 1))] Vec<T>),
}

impl<T> OneOrMany<T> {
    /// Returns the values as a list.
    pub fn into_vec(self) -> Vec<T> {
        match self {
            OneOrMany::One(one) => vec![one],
            OneOrMany::Many(all) => all,
        }
    }
}

impl<T: fmt::Debug> fmt::Debug for OneOrMany<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OneOrMany::One(one) => one.fmt(f),
            OneOrMany::Many(all) => all.fmt(f),
        }
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for OneOrMany<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(OneOrManyVisitor(PhantomData))
    }
}

/// Reads one value or a list with the errors of the values themselves, which an untagged enum would hide.
struct OneOrManyVisitor<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for OneOrManyVisitor<T> {
    type Value = OneOrMany<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("one value or a list of them")
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<Self::Value, E> {
        T::deserialize(value.into_deserializer()).map(OneOrMany::One)
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<Self::Value, E> {
        T::deserialize(value.into_deserializer()).map(OneOrMany::One)
    }

    fn visit_str<E: de::Error>(self, value: &str) -> Result<Self::Value, E> {
        T::deserialize(value.into_deserializer()).map(OneOrMany::One)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        T::deserialize(MapAccessDeserializer::new(map)).map(OneOrMany::One)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<Self::Value, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(values)).map(OneOrMany::Many)
    }
}

/// A number, or a formula of x, y, z (m).
#[derive(Clone, JsonSchema)]
#[schemars(inline, untagged)]
pub(super) enum Scalar {
    Number(f64),
    Text(String),
}

impl<'de> Deserialize<'de> for Scalar {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ScalarVisitor)
    }
}

struct ScalarVisitor;

impl Visitor<'_> for ScalarVisitor {
    type Value = Scalar;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or a formula in quotes, of x, y and z")
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<Scalar, E> {
        Ok(Scalar::Number(value as f64))
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<Scalar, E> {
        Ok(Scalar::Number(value))
    }

    fn visit_str<E: de::Error>(self, value: &str) -> Result<Scalar, E> {
        Ok(Scalar::Text(value.to_string()))
    }
}

/// A list of times, s, or the word in its place: that of [`WORDS`] with this number.
pub(super) enum TimesOr<const WORD: usize> {
    Word,
    Times(Vec<f64>),
}

pub(super) const ALL: usize = 0;
pub(super) const LAST: usize = 1;

/// Each word, and what is expected where it may stand.
const WORDS: [(&str, &str); 2] =
    [("all", "a list of times or \"all\""), ("last", "the times of its beginning and its end, or \"last\"")];

impl<'de, const WORD: usize> Deserialize<'de> for TimesOr<WORD> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(TimesVisitor)
    }
}

struct TimesVisitor<const WORD: usize>;

impl<'de, const WORD: usize> Visitor<'de> for TimesVisitor<WORD> {
    type Value = TimesOr<WORD>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(WORDS[WORD].1)
    }

    fn visit_str<E: de::Error>(self, word: &str) -> Result<Self::Value, E> {
        let is_known = word == WORDS[WORD].0;
        if is_known { Ok(TimesOr::Word) } else { Err(E::invalid_value(de::Unexpected::Str(word), &self)) }
    }

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<Self::Value, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(values)).map(TimesOr::Times)
    }
}
