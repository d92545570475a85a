//! Sets of nodes or elements.

use std::collections::HashMap;

use super::{Data, Keyword};
use crate::body::mesh::file::MeshFormatError;

/// The numbers `first`, `first + step`, ... up to `last`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Span {
    first: usize,
    last: usize,
    step: usize,
}

impl Span {
    pub(super) fn one(number: usize) -> Self {
        Span { first: number, last: number, step: 1 }
    }

    fn contains(&self, number: usize) -> bool {
        (self.first..=self.last).contains(&number) && (number - self.first).is_multiple_of(self.step)
    }
}

/// Sets of numbers by name. A set of many numbers may be one [`Span`].
#[derive(Default)]
pub(super) struct Sets {
    /// The names in the order of the file.
    pub names: Vec<String>,
    spans: HashMap<String, Vec<Span>>,
    /// The number of spans of all sets.
    pub(super) size: usize,
}

impl Sets {
    /// Adds members to the set `name`.
    pub(super) fn add(&mut self, name: &str, members: impl IntoIterator<Item = Span>) {
        if !self.spans.contains_key(name) {
            self.names.push(name.to_string());
        }
        let spans = self.spans.entry(name.to_string()).or_default();
        let before = spans.len();
        spans.extend(members);
        self.size += spans.len() - before;
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.spans.contains_key(name)
    }

    /// Adds the data of `*NSET` or `*ELSET` to the set `name`: numbers and names of sets, or with GENERATE first and last
    /// number and increment. There may be `most` members of all sets.
    pub(super) fn define(
        &mut self,
        name: &str,
        keyword: &Keyword<'_>,
        data: &[Data<'_>],
        most: usize,
    ) -> Result<(), MeshFormatError> {
        let mut members = Vec::new();
        for row in data {
            let fields = row.words();
            if keyword.value("GENERATE").is_some() {
                let numbers: Option<Vec<usize>> = fields.map(|field| field.parse().ok()).collect();
                members.push(match numbers.as_deref() {
                    Some(&[first, last]) => Span { first, last, step: 1 },
                    Some(&[first, last, step]) if step > 0 => Span { first, last, step },
                    _ => {
                        let help = "give first number, last number, increment, such as 1, 9, 2";
                        return Err(keyword.error_at(row, "GENERATE needs two or three whole numbers", help));
                    }
                });
                continue;
            }
            for field in fields {
                members.extend(self.members(field).ok_or_else(|| {
                    let message = format!("`{field}` is neither a number nor a set that is defined before");
                    keyword.error_at(row, message, "define the set first, or correct its name")
                })?);
                if members.len() > most {
                    return Err(too_many(keyword));
                }
            }
        }
        members.sort_unstable();
        members.dedup();
        self.add(name, members);
        // Sets that name one another could otherwise grow without bound.
        if self.size > most { Err(too_many(keyword)) } else { Ok(()) }
    }

    /// Returns the members of a set, or the number itself, of a `field`; `None` if it is neither.
    pub(super) fn members(&self, field: &str) -> Option<Vec<Span>> {
        match field.parse() {
            Ok(number) => Some(vec![Span::one(number)]),
            Err(_) => self.spans.get(&field.trim_matches('"').to_uppercase()).cloned(),
        }
    }

    /// Returns the indices of all members of the set `name` that `indices` has, in increasing order of numbers.
    pub(super) fn indices(&self, name: &str, indices: &HashMap<usize, usize>) -> Vec<usize> {
        present(self.spans.get(name).map_or(&[], Vec::as_slice), indices)
    }
}

/// Returns the indices of all numbers in `spans` that `indices` has, each once, in increasing order of numbers.
pub(super) fn present(spans: &[Span], indices: &HashMap<usize, usize>) -> Vec<usize> {
    let mut found: Vec<(usize, usize)> = Vec::new();
    for span in spans {
        let count = span.last.saturating_sub(span.first) / span.step;
        if span.first > span.last {
            continue;
        }
        if count < indices.len() {
            let numbers = (0..=count).map(|k| span.first + k * span.step);
            found.extend(numbers.filter_map(|number| Some((number, *indices.get(&number)?))));
        } else {
            found.extend(indices.iter().filter(|(number, _)| span.contains(**number)).map(|(a, b)| (*a, *b)));
        }
        if found.len() > 2 * indices.len() {
            found.sort_unstable();
            found.dedup();
        }
    }
    found.sort_unstable();
    found.dedup();
    found.into_iter().map(|(_, index)| index).collect()
}

pub(super) fn too_many(keyword: &Keyword<'_>) -> MeshFormatError {
    keyword
        .error("the sets repeat one another: they have far more members than the file has numbers", "define fewer sets")
}
