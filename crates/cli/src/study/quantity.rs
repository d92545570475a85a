//! Quantities of a run, by which studies name what they show or refine for.
//!
//! ```text
//! QUANTITY = WORD                             a key result: peak, force, friction_work, stick_ratio, tangential
//!          | KEY                              a key of run.json with one value: cycle.regime, boundaries[0].force[1]
//!          | size:KEY                         the length of a vector: size:largest_force.force
//!          | max|min|last:[KIND:]PLACE.COLUMN a column of forces.csv over the increments: max:top.f_x, last:load:top.u_y
//! ```

use std::str::FromStr;

use serde_json::Value;

use stickslip::base::{Quantity, UnitSystem};
use stickslip::run::report::{column_quantity, key_quantity};

use super::keys::{self, Kind};
use super::places::{KINDS, Places};
use super::{distinct, labelled};

/// A result that every study knows by a word.
pub(crate) struct KeyResult {
    /// The word.
    pub word: &'static str,
    /// The key of the report.
    pub key: &'static str,
    /// The name in sentences.
    pub name: &'static str,
    /// The name in the head of a table.
    pub head: &'static str,
}

/// The key results. Tables show the first ones by themselves, [`IN_TABLES`].
pub(crate) const KEY_RESULTS: [KeyResult; 5] = [
    KeyResult { word: "peak", key: "largest_pressure.pressure", name: "peak pressure", head: "pressure" },
    KeyResult { word: "force", key: "largest_force.magnitude", name: "contact force", head: "force" },
    KeyResult { word: "friction_work", key: "friction.friction_work", name: "friction work", head: "friction work" },
    KeyResult { word: "stick_ratio", key: "stick_zone.ratio", name: "stick ratio", head: "stick ratio" },
    KeyResult {
        word: "tangential",
        key: "holding_force.magnitude",
        name: "tangential force",
        head: "tangential force",
    },
];

/// The number of key results that a table shows unless it is asked for others.
pub(crate) const IN_TABLES: usize = 4;

/// A quantity of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TableQuantity {
    /// The quantity as it was given.
    text: String,
    source: Source,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Source {
    /// A key, as a JSON pointer; of a vector its length.
    Key { pointer: String, name: String, kind: Kind },
    /// A column of `forces.csv`, of which the function picks one increment. What acts there may not be known yet.
    Column { function: &'static str, acting: Option<&'static str>, place: String, column: Column },
}

/// A column of `forces.csv`: its name, the key of the report with its numbers, and the axis if the key has a vector.
type Column = (&'static str, &'static str, Option<usize>);

const COLUMNS: [Column; 16] = [
    ("f_x", "force", Some(0)),
    ("f_y", "force", Some(1)),
    ("f_z", "force", Some(2)),
    ("m_x", "moment", Some(0)),
    ("m_y", "moment", Some(1)),
    ("m_z", "moment", Some(2)),
    ("u_x", "displacement", Some(0)),
    ("u_y", "displacement", Some(1)),
    ("u_z", "displacement", Some(2)),
    ("rotation_x", "rotation", Some(0)),
    ("rotation_y", "rotation", Some(1)),
    ("rotation_z", "rotation", Some(2)),
    ("sum_p_n", "sum_p_n", None),
    ("sum_p_t", "sum_p_t", None),
    ("sum_p_o", "sum_p_o", None),
    ("friction_used", "friction_used", None),
];

const FUNCTIONS: [&str; 4] = ["max", "min", "last", "size"];

fn meant(similar: &[String]) -> String {
    if similar.is_empty() { String::new() } else { format!("; did you mean {}?", similar.join(" or ")) }
}

/// Parses quantities separated by commas; commas within brackets and quotes belong to a quantity.
///
/// # Errors
/// When one of them is no quantity, with those of a similar spelling.
pub fn quantities(text: &str) -> Result<Vec<TableQuantity>, String> {
    listed(text).iter().map(|one| one.parse()).collect()
}

/// Splits a list of values at its commas, except within brackets and quotes.
pub fn listed(given: &str) -> Vec<String> {
    let (mut values, mut depth, mut quote) = (vec![String::new()], 0_usize, None);
    for c in given.chars() {
        match (c, quote) {
            (',', None) if depth == 0 => {
                values.push(String::new());
                continue;
            }
            ('[' | '{', None) => depth += 1,
            (']' | '}', None) => depth = depth.saturating_sub(1),
            ('"' | '\'', None) => quote = Some(c),
            (c, Some(open)) if c == open => quote = None,
            _ => {}
        }
        if let Some(value) = values.last_mut() {
            value.push(c);
        }
    }
    values.into_iter().map(|value| value.trim().to_string()).filter(|value| !value.is_empty()).collect()
}

impl FromStr for TableQuantity {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let of_word = |text| KEY_RESULTS.iter().find(|result| result.word == text).map_or(text, |result| result.key);
        let text = of_word(text.trim()).to_string();
        let source = match text.split_once(':') {
            None => key(&text, false)?,
            Some((name, rest)) => match FUNCTIONS.into_iter().find(|function| *function == name) {
                Some("size") => key(of_word(rest), true)?,
                Some(function) => column(&text, function, rest)?,
                None => {
                    let similar = nearest(name, FUNCTIONS.into_iter()).into_iter().map(|name| format!("{name}:{rest}"));
                    return Err(format!(
                        "`{name}` is no function of a quantity; the functions are max:, min: and last: of PLACE.COLUMN, \
                         and size: of a vector{}",
                        meant(&similar.collect::<Vec<_>>())
                    ));
                }
            },
        };
        Ok(TableQuantity { text, source })
    }
}

/// Returns the names of a similar spelling.
fn nearest<'a>(name: &str, names: impl Iterator<Item = &'a str>) -> Vec<String> {
    // One of three letters may differ.
    const ALIKE: f64 = 0.6;
    names.filter(|other| strsim::normalized_damerau_levenshtein(name, other) >= ALIKE).map(String::from).collect()
}

/// Parses a key: its name with `[]` for each index, and its JSON pointer.
fn parsed(text: &str) -> (String, String) {
    let (mut name, mut pointer) = (Vec::new(), vec![""]);
    for part in text.split('.') {
        let mut pieces = part.split('[');
        pointer.push(pieces.next().unwrap_or_default());
        let key = pointer[pointer.len() - 1];
        let index = |piece: &str| piece.strip_suffix(']')?.parse::<usize>().ok();
        let indices: Option<Vec<usize>> = pieces.clone().map(index).collect();
        // Anything but numbers in brackets stays in the name, which is then no key.
        name.push(indices.map_or(part.to_string(), |all| format!("{key}{}", "[]".repeat(all.len()))));
        pointer.extend(pieces.map(|piece| piece.trim_end_matches(']')));
    }
    (name.join("."), pointer.join("/"))
}

/// Returns the name, the pointer and the kind of a key; otherwise what is below the part of it that exists, and similar
/// keys.
fn found(text: &str) -> Result<(String, String, Kind), String> {
    let (name, pointer) = parsed(text);
    if let Some(kind) = keys::kind(&name) {
        return Ok((name, pointer, kind));
    }
    let mut parents = name.match_indices('.').map(|(at, _)| &name[..at]).rev();
    let parent = parents.find(|part| !keys::children(part).is_empty()).unwrap_or_default();
    let children = keys::children(parent).join(", ");
    let spelt = keys::similar(&name).into_iter().map(|name| name.replace("[]", "[0]"));
    let similar = distinct(keys::described(&name).into_iter().chain(spelt));
    // All keys of a report are too many if there are similar ones.
    let existing = match (parent, &similar[..]) {
        ("", []) => format!("; its keys are {children}"),
        ("", _) => String::new(),
        _ => format!("; the keys of {parent} are {children}"),
    };
    let words = if parent.is_empty() {
        format!("none of {}, and is ", KEY_RESULTS.map(|result| result.word).join(", "))
    } else {
        String::new()
    };
    Err(format!("`{text}` is {words}no key of a report{}{existing}", meant(&similar)))
}

/// Parses a key with one value, or of a vector whose `size` is asked for.
fn key(text: &str, size: bool) -> Result<Source, String> {
    let (name, pointer, kind) = found(text)?;
    let values = match (kind, size) {
        (Kind::Number | Kind::Word, false) | (Kind::Vector, true) => return Ok(Source::Key { pointer, name, kind }),
        (Kind::Number | Kind::Word, true) => return Err(format!("`{text}` is no vector; leave out size:")),
        (Kind::Vector, false) => vec![format!("{text}[0]"), format!("{text}[1]"), format!("size:{text}")],
        (Kind::Several, _) => {
            let list = if keys::kind(&format!("{name}[]")).is_some() { "[0]" } else { "" };
            match &keys::children(&name)[..] {
                [] => vec![format!("{text}{list}")],
                below => below.iter().map(|child| format!("{text}{list}.{child}")).collect(),
            }
        }
    };
    Err(format!("`{text}` has several values; give one of them: {}", values.join(", ")))
}

fn column(text: &str, function: &'static str, rest: &str) -> Result<Source, String> {
    let kind = |name: &str| KINDS.into_iter().find(|kind| *kind == name);
    let given = rest.split_once(':').and_then(|(name, rest)| Some((kind(name)?, rest)));
    let (acting, rest) = given.map_or((None, rest), |(acting, rest)| (Some(acting), rest));
    let Some((place, name)) = rest.rsplit_once('.').filter(|(place, _)| !place.is_empty()) else {
        return Err(format!("`{text}` is not of the form {{max,min,last}}:PLACE.COLUMN, such as max:top.f_x"));
    };
    let found = COLUMNS.into_iter().find(|(column, ..)| *column == name);
    let column = found.ok_or_else(|| no_column(text, name, None))?;
    Ok(Source::Column { function, acting, place: place.to_string(), column })
}

/// Returns `true` if forces of this kind have the numbers of a key.
fn has(acting: Option<&str>, key: &str) -> bool {
    match acting {
        Some("contact") => !["displacement", "rotation"].contains(&key),
        Some("coupling") => !key.starts_with("sum_p"),
        Some(_) => !key.starts_with("sum_p") && key != "rotation",
        None => true,
    }
}

fn no_column(text: &str, name: &str, acting: Option<&str>) -> String {
    let columns: Vec<&str> = COLUMNS.iter().filter(|(_, key, _)| has(acting, key)).map(|(name, ..)| *name).collect();
    let of = acting.map_or("forces.csv".to_string(), |acting| format!("a {acting}"));
    let similar: Vec<String> = nearest(name, columns.iter().copied()).into_iter().take(1).collect();
    format!("`{text}`: {of} has no column `{name}`; it has {}{}", columns.join(", "), meant(&similar))
}

impl TableQuantity {
    /// Returns the quantity as it was given.
    pub fn text(&self) -> &str {
        &self.text
    }

    fn known(&self) -> Option<&'static KeyResult> {
        KEY_RESULTS.iter().find(|result| result.key == self.text)
    }

    /// Returns its word, if it is a key result, otherwise the quantity as it was given.
    pub(crate) fn word(&self) -> &str {
        self.known().map_or(&self.text, |result| result.word)
    }

    /// Returns its name in sentences.
    pub(crate) fn name(&self) -> String {
        self.known().map_or_else(|| self.label(), |result| result.name.to_string())
    }

    /// Returns its name for people: `friction work`, `time of largest pressure`, `max f_x of support left`.
    pub fn label(&self) -> String {
        if let Some(known) = self.known() {
            return known.head.to_string();
        }
        match &self.source {
            Source::Key { .. } => in_words(&self.text),
            Source::Column { function, column: (name, ..), .. } => {
                let place = self.text.trim_start_matches(&format!("{function}:"));
                let place = place.strip_suffix(&format!(".{name}")).unwrap_or(place);
                let kind = KINDS.iter().find_map(|kind| Some((kind, place.strip_prefix(&format!("{kind}:"))?)));
                let place = kind.map_or(place.to_string(), |(kind, place)| format!("{kind} {place}"));
                format!("{function} {name} of {place}")
            }
        }
    }

    /// Returns its name for people with its unit.
    pub(crate) fn head(&self, units: UnitSystem) -> String {
        labelled(&self.label(), &self.unit(&self.units_for_people(units)))
    }

    /// Returns the units for tables and charts: in SI, MPa for pressures.
    pub(crate) fn units_for_people(&self, units: UnitSystem) -> UnitSystem {
        if self.quantity() == Quantity::Stress { units.of_pictures() } else { units }
    }

    /// Returns the kind of its unit.
    pub fn quantity(&self) -> Quantity {
        match &self.source {
            Source::Key { name, .. } => key_quantity(last(name)),
            Source::Column { column: (name, ..), .. } => column_quantity(name).unwrap_or(Quantity::Number),
        }
    }

    /// Returns the name of its unit in a system of units.
    pub(crate) fn unit(&self, units: &UnitSystem) -> String {
        format!("{}{}", units.name(self.quantity()), self.fixed_unit())
    }

    /// Returns the name of a unit that no system of units changes: s or B.
    fn fixed_unit(&self) -> &'static str {
        let Source::Key { name, kind: Kind::Number, .. } = &self.source else { return "" };
        match last(name) {
            "time" | "start" | "end" | "slips_from" | "slips_wholly_from" => "s",
            key if key.ends_with("seconds") => "s",
            key if key.ends_with("bytes") => "B",
            _ => "",
        }
    }

    /// Returns it completed with what acts at its place, and as a number only if it is `drawn`.
    ///
    /// # Errors
    /// When it is a text that cannot be drawn, when nothing with such a column acts at its place, or several do.
    pub fn at(&self, places: &Places, drawn: bool) -> Result<Self, String> {
        let (function, acting, place, column) = match &self.source {
            Source::Key { kind: Kind::Word, .. } if drawn => {
                return Err(format!("`{}` is no number; the table of a sweep shows it (sweep --table)", self.text));
            }
            Source::Key { pointer, .. } => {
                places.expect(pointer).map_err(|error| format!("`{}`: {error}", self.text))?;
                return Ok(self.clone());
            }
            Source::Column { function, acting, place, column } => (*function, *acting, place, *column),
        };
        // A boundary of a body has the name of the body before a colon, which may be that of a kind of force.
        let of_body = acting.map(|acting| format!("{acting}:{place}")).filter(|name| !places.at(name).is_empty());
        let (acting, place) = match of_body {
            Some(name) if places.at(place).is_empty() => (None, name),
            _ => (acting, place.clone()),
        };
        let (text, there) = (&self.text, places.at(&place));
        if there.is_empty() {
            let names = places.names();
            let is_of_body = |name: &&str| name.rsplit_once(':').is_some_and(|(_, name)| name == place);
            let mut similar: Vec<String> = names.iter().copied().filter(is_of_body).map(String::from).collect();
            similar.extend(nearest(&place, names.iter().copied()));
            return Err(format!(
                "`{text}`: no contact, support, spring or load of the scene is at `{place}`; they are at {}{}",
                names.join(", "),
                meant(&similar)
            ));
        }
        if let Some(kind) = acting.filter(|kind| !there.contains(kind)) {
            return Err(format!("`{text}`: there is no {kind} at `{place}`, but {}", there.join(", ")));
        }
        // Kinds without the column do not count.
        let able = |kind: &&'static str| has(Some(kind), column.1) && acting.is_none_or(|acting| acting == *kind);
        let acting = match there.iter().copied().filter(able).collect::<Vec<_>>()[..] {
            [acting] => acting,
            [] => return Err(no_column(text, column.0, acting.or(Some(there[0])))),
            ref several => {
                let (function, rest) = text.split_once(':').unwrap_or_default();
                let choices: Vec<String> = several.iter().map(|kind| format!("{function}:{kind}:{rest}")).collect();
                return Err(format!("`{text}`: several forces act at `{place}`; give one of {}", choices.join(", ")));
            }
        };
        places.expect(column.0).map_err(|error| format!("`{text}`: {error}"))?;
        let source = Source::Column { function, acting: Some(acting), place, column };
        Ok(TableQuantity { text: text.clone(), source })
    }

    /// Returns the key of the report itself with all that the value depends on.
    pub fn root(&self) -> &str {
        match &self.source {
            Source::Key { name, .. } => name.split(['.', '[']).next().unwrap_or_default(),
            Source::Column { acting: None | Some("contact"), .. } => "forces",
            Source::Column { .. } => "reactions",
        }
    }

    /// Returns the value in a report: a number in the units of the report, a text, or null if the run has no such value.
    pub fn of(&self, report: &Value) -> Value {
        match &self.source {
            Source::Key { pointer, kind: Kind::Vector, .. } => {
                let components = report.pointer(pointer).and_then(Value::as_array);
                let squares = components.map(|all| all.iter().map(|f| Some(f.as_f64()?.powi(2))).sum::<Option<f64>>());
                squares.flatten().map(f64::sqrt).into()
            }
            Source::Key { pointer, .. } => report.pointer(pointer).cloned().unwrap_or_default(),
            Source::Column { function, acting, place, column } => {
                let values = of_column(report, *acting, place, *column).into_iter();
                match *function {
                    "max" => values.reduce(f64::max),
                    "min" => values.reduce(f64::min),
                    _ => values.last(),
                }
                .into()
            }
        }
    }
}

/// Returns a key in words: of a value and what it belongs to, the value first, where this does not name it already.
fn in_words(key: &str) -> String {
    let axes = ["x", "y", "z"].into_iter().enumerate();
    let with_axis = |child: &str| {
        axes.clone().fold(child.to_string(), |child, (k, axis)| child.replace(&format!("[{k}]"), &format!(" {axis}")))
    };
    let spelt = |part: &str| part.replace("holding_force", "tangential_force").replace(['_', '.'], " ");
    let (parent, child) = key.trim_start_matches("size:").rsplit_once('.').unwrap_or(("", key));
    let (parent, child) = (spelt(parent), spelt(&with_axis(child)));
    let last = |words: &str| words.rsplit(' ').next().unwrap_or_default().to_string();
    match &*parent {
        "" | "totals" => child,
        _ if child == "magnitude" => parent,
        _ if last(&parent) == last(&child) || child.starts_with(&parent) => child,
        _ => format!("{child} of {parent}"),
    }
}

/// Returns the last part of the name of a key, without the brackets of a list.
fn last(name: &str) -> &str {
    name.rsplit('.').next().unwrap_or_default().trim_end_matches("[]")
}

/// Returns the values of a column in all converged increments. Forces of equal kind at one place add up; they move
/// together. Between bodies each side has the force on the other one.
fn of_column(report: &Value, acting: Option<&str>, place: &str, (_, key, axis): Column) -> Vec<f64> {
    let list = |key: &str| report[key].as_array().map_or(&[][..], Vec::as_slice);
    let number = |of: &Value| axis.map_or(&of[key], |axis| component(of, key, axis)).as_f64();
    let adds = key != "displacement";
    match acting {
        None | Some("contact") => {
            let of_increment = |records: &[Value]| {
                let sides = records.iter().flat_map(|record| [record, &record["opposite"]]);
                sides.filter(|side| side["boundary"] == place).filter_map(number).reduce(|sum, more| sum + more)
            };
            list("forces").chunk_by(|a, b| a["index"] == b["index"]).filter_map(of_increment).collect()
        }
        Some(kind) => {
            let of_increment = |reactions: &Value| {
                let here = reactions[format!("{kind}s")].as_array()?.iter().filter(|of| of["at"] == place);
                here.filter_map(number).reduce(|sum, more| if adds { sum + more } else { sum })
            };
            list("reactions").iter().filter_map(of_increment).collect()
        }
    }
}

/// Returns a component of a vector. In two dimensions a moment has one component, about z.
fn component<'a>(of: &'a Value, key: &str, axis: usize) -> &'a Value {
    let vector = &of[key];
    let is_plane = ["moment", "rotation"].contains(&key) && vector.as_array().is_some_and(|all| all.len() == 1);
    match axis {
        2 if is_plane => &vector[0],
        _ if is_plane => &Value::Null,
        axis => &vector[axis],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn report() -> Value {
        json!({
            "largest_pressure": { "pressure": 5.5, "boundary": "bottom", "singular": true },
            "largest_force": { "force": [3.0, -4.0] },
            "boundaries": [{ "boundary": "bottom", "force": [1.0, -2.0] }],
            "forces": [
                { "index": 1, "boundary": "bottom", "force": [1.0, -7.0], "moment": [0.5], "sum_p_n": 7.0 },
                { "index": 1, "boundary": "side", "force": [100.0, 0.0], "moment": [0.0], "sum_p_n": 100.0,
                  "opposite": { "boundary": "a+b", "force": [-100.0, 1.0], "moment": [0.0] } },
                { "index": 2, "boundary": "bottom", "force": [-3.0, -2.0], "moment": [0.25], "sum_p_n": 2.0 },
                { "index": 2, "boundary": "side", "force": [50.0, 0.0], "moment": [0.0], "sum_p_n": 100.0,
                  "opposite": { "boundary": "a+b", "force": [-50.0, 0.0], "moment": [0.0] } },
                { "index": 2, "boundary": "edge", "force": [5.0, 0.0], "moment": [0.0], "sum_p_n": 5.0,
                  "opposite": { "boundary": "a+b", "force": [-5.0, 0.0], "moment": [0.0] } },
            ],
            "reactions": [
                { "supports": [{ "at": "top", "force": [1.0, 2.0], "displacement": [0.0, 0.1] },
                               { "at": "top", "force": [0.0, 3.0], "displacement": [0.0, 0.1] }],
                  "loads": [{ "at": "top", "force": [0.0, -9.0], "displacement": [0.0, 0.1] }] },
                { "supports": [{ "at": "top", "force": [2.0, 1.0], "displacement": [0.0, 0.3] },
                               { "at": "top", "force": [0.0, 1.0], "displacement": [0.0, 0.3] }],
                  "loads": [{ "at": "top", "force": [0.0, -8.0], "displacement": [0.0, 0.3] }] },
            ],
        })
    }

    fn places() -> Places {
        let scene = "mesh = { kind = 'block', size = [1, 1], elements = [1, 1] }
            material = { young = 1e9, poisson = 0.3 }
            support = [{ boundary = 'top', fix = ['x', 'y'] }, { point = [0, 1], fix = ['x'] }]
            load = [{ boundary = 'top', traction = [0, 1] }, { acceleration = [0, -1] }]
            contact = [
              { boundary = 'bottom', friction = 0.3, obstacle = { kind = 'plane', gap = 0 } },
              { boundary = 'side', friction = 0.3, against = ['a', 'b'] },
            ]
            time = { end = 1, increments = 2 }";
        let scene = stickslip::scene::Scene::parse("scene.toml", scene, &[]).unwrap();
        let mut places = Places::default();
        places.add(&scene.description);
        places
    }

    fn value(text: &str) -> Value {
        let quantity = text.parse::<TableQuantity>().and_then(|quantity| quantity.at(&places(), false));
        quantity.unwrap_or_else(|error| panic!("{text}: {error}")).of(&report())
    }

    #[test]
    fn quantities_have_values() {
        for (text, expected) in [
            ("largest_pressure.pressure", json!(5.5)),
            ("largest_pressure.boundary", json!("bottom")),
            ("largest_pressure.singular", json!(true)),
            ("size:largest_force.force", json!(5.0)),
            ("boundaries[0].force[1]", json!(-2.0)),
            ("boundaries[1].force[1]", Value::Null),
            ("friction.friction_work", Value::Null),
            ("max:bottom.f_x", json!(1.0)),
            ("min:bottom.f_x", json!(-3.0)),
            ("last:contact:bottom.m_z", json!(0.25)),
            ("max:bottom.sum_p_n", json!(7.0)),
            // One side of two contacts between bodies.
            ("min:a+b.f_x", json!(-100.0)),
            ("last:contact:a+b.f_x", json!(-55.0)),
            ("max:a+b.sum_p_n", Value::Null),
            // Two supports of one place act together, but move once.
            ("max:support:top.f_y", json!(5.0)),
            ("last:support:top.u_y", json!(0.3)),
            ("min:load:top.f_y", json!(-9.0)),
        ] {
            assert_eq!(value(text), expected, "{text}");
        }
    }

    #[test]
    fn quantities_have_units() {
        for (text, quantity) in [
            ("largest_pressure.pressure", Quantity::Stress),
            ("largest_pressure.position[0]", Quantity::Length),
            ("size:largest_force.force", Quantity::Force),
            ("cycle.friction_work", Quantity::Energy),
            ("stick_zone.ratio", Quantity::Number),
            ("max:top.f_x", Quantity::Force),
            ("max:top.u_x", Quantity::Length),
            ("max:top.m_z", Quantity::Moment),
        ] {
            assert_eq!(text.parse::<TableQuantity>().unwrap().quantity(), quantity, "{text}");
        }
        let fixed = |text: &str| text.parse::<TableQuantity>().unwrap().fixed_unit();
        assert_eq!(
            ["totals.cpu_seconds", "largest_pressure.time", "totals.peak_rss_bytes", "stick_zone.ratio"].map(fixed),
            ["s", "s", "B", ""]
        );
    }

    #[test]
    fn what_is_no_quantity_is_told_with_what_exists() {
        for (text, words) in [
            ("frictionwork", "did you mean friction.friction_work or cycle.friction_work or "),
            ("tangential_force", "did you mean holding_force.magnitude or "),
            ("friction.work", "the keys of friction are friction_work, time_error"),
            ("largest_presure.pressure", "did you mean largest_pressure.pressure or largest_pressure.mean_pressure?"),
            ("boundaries.force[0]", "did you mean boundaries[0].force[0]"),
            ("boundaries[x].force[0]", "is no key of a report"),
            ("", "is no key of a report"),
            ("status[", "is no key of a report"),
            ("size:peak", "`largest_pressure.pressure` is no vector; leave out size:"),
            ("largest_force.force[0", "is no key of a report"),
            ("largest_pressure", "give one of them: largest_pressure.pressure, "),
            ("largest_force.force", "largest_force.force[0], largest_force.force[1], size:largest_force.force"),
            ("boundaries", "boundaries[0].boundary"),
            ("boundaries[0]", "boundaries[0].boundary"),
            ("size:stick_zone.ratio", "is no vector; leave out size:"),
            ("maxx:top.f_x", "did you mean max:top.f_x"),
            ("mean:top.f_x", "`mean` is no function of a quantity; the functions are max:, min: and last:"),
            ("max:top", "is not of the form"),
            ("max:.f_x", "is not of the form"),
            ("max:bottom.m_x", "the scene is plane"),
            ("max:bottom.f_z", "the scene is plane"),
            ("boundaries[0].sum_p_o", "the scene is plane"),
            ("boundaries[2].sum_p_t", "the number of boundaries with contact, from 0, is 2"),
            ("max:top.fx", "did you mean f_x?"),
            ("max:tpo.f_x", "they are at [0.0, 1.0], a+b, bottom, side, the body, top; did you mean top?"),
            ("max:top.f_x", "give one of max:support:top.f_x, max:load:top.f_x"),
            ("max:spring:top.f_x", "there is no spring at `top`, but support, load"),
            ("max:bottom.u_x", "a contact has no column `u_x`; it has f_x, f_y"),
            ("max:top.sum_p_n", "a support has no column `sum_p_n`"),
        ] {
            let error = text.parse::<TableQuantity>().and_then(|quantity| quantity.at(&places(), false)).unwrap_err();
            assert!(error.contains(words), "{text}: {error}");
        }
        let word: TableQuantity = "cycle.regime".parse().unwrap();
        assert!(word.at(&places(), true).unwrap_err().contains("is no number"));
    }

    #[test]
    fn quantities_have_names() {
        for (text, label) in [
            ("peak", "pressure"),
            ("friction.friction_work", "friction work"),
            ("holding_force.magnitude", "tangential force"),
            ("size:largest_force.force", "force"),
            ("largest_pressure.mean_pressure", "mean pressure"),
            ("largest_pressure.position[1]", "position y of largest pressure"),
            ("boundaries[0].force[0]", "force x of boundaries[0]"),
            ("totals.cpu_seconds", "cpu seconds"),
            ("status", "status"),
            ("max:bottom.f_x", "max f_x of bottom"),
            ("last:support:a+b.sum_p_n", "last sum_p_n of support a+b"),
        ] {
            assert_eq!(text.parse::<TableQuantity>().unwrap().label(), label, "{text}");
        }
        let heads =
            ["max:bottom.f_x", "peak"].map(|text| text.parse::<TableQuantity>().unwrap().head(UnitSystem::si(2)));
        assert_eq!(heads, ["max f_x of bottom [N/m]", "pressure [MPa]"]);
    }

    #[test]
    fn lists_of_quantities_have_commas() {
        let all = quantities("stick_zone.ratio, max:[0.0, 1.0].u_x").unwrap();
        let texts: Vec<&str> = all.iter().map(TableQuantity::text).collect();
        assert_eq!(texts, ["stick_zone.ratio", "max:[0.0, 1.0].u_x"]);
    }
}
