//! Variations of keys, and all their combinations.

use std::collections::HashSet;
use std::str::FromStr;

use serde::Serialize;

use crate::study::listed;
use stickslip::scene::{Override, OverrideSyntax};

/// The largest number of variants; more are taken for a mistake.
pub const MAX_VARIANTS: usize = 100_000;

/// A key and its values, or several keys that change together.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Variation {
    /// The key, in the syntax of an [`Override`]; several are separated by commas.
    pub key: String,
    /// The values, in the syntax of an override: two or more, all different. With several keys each is a list of one value
    /// for each key.
    pub values: Vec<String>,
}

/// A combination of values, one of each variation.
#[derive(Debug, Clone)]
pub struct Variant {
    /// The values, in the order of the variations.
    pub values: Vec<String>,
    /// The overrides that set the values in a scene.
    pub overrides: Vec<Override>,
}

impl FromStr for Variation {
    type Err = String;

    /// Parses `key=a,b,c`, in which commas within brackets and quotes do not separate, `key=from:to:count`, or
    /// `key,other=[a,b],[c,d]`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (key, given) = text.split_at(text.find('=').unwrap_or(text.len()));
        // Parsing as an override checks each key.
        let checked = |one: &str| format!("{one}{given}").parse::<Override>().map(drop);
        key.split(',').try_for_each(checked).map_err(|error| error.to_string())?;
        let (key, given) = (key.trim().to_string(), given.trim_start_matches('=').trim());
        let values = range(given)?.unwrap_or_else(|| listed(given));
        if values.len() < 2 {
            let many = "give several, a,b,c, or a range from:to:count";
            return Err(match &values.concat()[..] {
                "" | "[]" => format!("{key} has no value; {many}"),
                one if one.contains(';') => format!("{key} has one value only: commas separate values; {many}"),
                _ => format!("{key} has one value only; {many}, or use --set"),
            });
        }
        let mut values_so_far = HashSet::new();
        if let Some(value) = values.iter().find(|value| !values_so_far.insert(Value::of(value))) {
            return Err(format!("{key} has the value {value} twice; give each once"));
        }
        let variation = Variation { key, values };
        let count = variation.keys().count();
        if let Some(value) = variation.values.iter().find(|value| variation.entries(value).len() != count) {
            let key = &variation.key;
            return Err(format!(
                "{value} is no list of {count} values, one for each of {key}; give them as [a,b],[c,d]"
            ));
        }
        Ok(variation)
    }
}

impl Variation {
    /// Returns its keys: one, or those that change together.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        self.key.split(',').map(str::trim)
    }

    /// Returns the value of each key in one of its values; empty if the value is no list.
    fn entries(&self, value: &str) -> Vec<String> {
        if self.keys().count() == 1 {
            return vec![value.to_string()];
        }
        value.strip_prefix('[').and_then(|value| value.strip_suffix(']')).map(listed).unwrap_or_default()
    }

    /// Returns the overrides that set one of its values.
    fn overrides(&self, value: &str) -> Result<Vec<Override>, OverrideSyntax> {
        self.keys().zip(self.entries(value)).map(|(key, value)| format!("{key}={value}").parse()).collect()
    }
}

/// A canonical form of a value, by which duplicates are found.
#[derive(PartialEq, Eq, Hash)]
enum Value<'a> {
    /// The bits of a number: 0.1 and 1e-1 are equal, as are 0 and -0.
    Number(u64),
    Text(&'a str),
}

impl<'a> Value<'a> {
    fn of(text: &'a str) -> Self {
        let number = text.parse::<f64>().ok().filter(|x| !x.is_nan());
        number.map_or(Value::Text(text), |x| Value::Number((x + 0.0).to_bits()))
    }
}

/// Returns the values of `from:to:count`, equally spaced. `None` if the text is not of this form.
fn range(given: &str) -> Result<Option<Vec<String>>, String> {
    let [from, to, count] = given.split(':').map(str::trim).collect::<Vec<_>>()[..] else { return Ok(None) };
    let (Ok(from), Ok(to)) = (from.parse::<f64>(), to.parse::<f64>()) else { return Ok(None) };
    let count = count.parse::<usize>().ok().filter(|count| (2..=MAX_VARIANTS).contains(count));
    let count = count.filter(|_| from.is_finite() && to.is_finite());
    let Some(count) = count else {
        return Err(format!(
            "{given} is no range from:to:count of two finite numbers and a count from 2 to {MAX_VARIANTS}"
        ));
    };
    let value = |k: usize| {
        let share = k as f64 / (count - 1) as f64;
        // Removes rounding errors, such as the last digits of 0.1 + 0.2.
        let rounded = format!("{:.14e}", from + share * (to - from));
        rounded.parse::<f64>().map_or(rounded, |value| (value + 0.0).to_string())
    };
    Ok(Some((0..count).map(value).collect()))
}

/// Returns `true` if two keys name the same value, or one contains the other. A list without an index refers to all of
/// its tables or entries.
fn overlap(a: &str, b: &str) -> bool {
    let bracket = |segment: &str| segment.find('[').unwrap_or(segment.len());
    a.split('.').zip(b.split('.')).all(|(a, b)| {
        let ((name, index), (other_name, other)) = (a.split_at(bracket(a)), b.split_at(bracket(b)));
        name == other_name && (index.starts_with(other) || other.starts_with(index))
    })
}

/// Returns every combination of the values of `variations`. The last one changes fastest.
///
/// # Errors
/// When a key is varied twice, or units are varied, there are too many combinations, or a value is none of a scene.
pub fn combinations(variations: &[Variation]) -> Result<Vec<Variant>, String> {
    let keys: Vec<&str> = variations.iter().flat_map(Variation::keys).collect();
    let again = |(k, one): &(usize, &&str)| keys[..*k].iter().any(|other| overlap(other, one));
    if let Some((_, key)) = keys.iter().enumerate().find(again) {
        return Err(format!("{key} is varied twice; give all of its values at once"));
    }
    if let Some(key) = keys.iter().find(|key| **key == "units" || key.starts_with("units.")) {
        return Err(format!("{key} cannot be varied: one table has one unit in each column; use --set"));
    }
    let all = variations.iter().try_fold(1_usize, |all, variation| all.checked_mul(variation.values.len()));
    let Some(all) = all.filter(|&all| all <= MAX_VARIANTS) else {
        return Err(format!("there are more than {MAX_VARIANTS} combinations; vary less at once"));
    };
    let variant = |mut number: usize| {
        let mut values: Vec<String> = Vec::with_capacity(variations.len());
        for variation in variations.iter().rev() {
            values.push(variation.values[number % variation.values.len()].clone());
            number /= variation.values.len();
        }
        values.reverse();
        let overrides = variations.iter().zip(&values).map(|(variation, value)| variation.overrides(value));
        Ok(Variant { overrides: overrides.collect::<Result<Vec<_>, _>>()?.concat(), values })
    };
    (0..all).map(variant).collect::<Result<_, OverrideSyntax>>().map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Vec<String> {
        text.parse::<Variation>().unwrap_or_else(|error| panic!("{text}: {error}")).values
    }

    fn refused(text: &str) -> String {
        text.parse::<Variation>().map(|variation| variation.values).unwrap_err()
    }

    #[test]
    fn ranges_and_lists() {
        assert_eq!(values("contact.friction=0.1:0.8:8"), ["0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7", "0.8"]);
        assert_eq!(values("time.increments=10:30:3"), ["10", "20", "30"]);
        assert_eq!(values("load[0].traction=[0,-1e6], [0,-2e6]"), ["[0,-1e6]", "[0,-2e6]"]);
        assert_eq!(values("mesh.file=a.msh,'b,c.msh',\"d.msh\""), ["a.msh", "'b,c.msh'", "\"d.msh\""]);
        assert_eq!(values("material.young=1e9:-1e9:3"), ["1000000000", "0", "-1000000000"]);
        // Anything but three numbers is no range.
        assert_eq!(values("title=a:b:c,d"), ["a:b:c", "d"]);
    }

    #[test]
    fn what_cannot_be_varied_is_refused() {
        for (text, words) in [
            ("contact.friction", "is not of the form key=value"),
            ("=1,2", "is not of the form"),
            ("contact.friction=0.4", "has one value only"),
            ("contact.friction=", "has no value; give several"),
            ("contact.friction=[]", "has no value; give several"),
            ("contact.friction=0.1;0.2", "commas separate values"),
            ("contact.friction=0.4,0.2,0.4", "has the value 0.4 twice"),
            ("contact.friction=0.1,0.2,1e-1", "has the value 1e-1 twice"),
            ("contact.friction=0,-0", "has the value -0 twice"),
            ("title=nan,a,nan", "has the value nan twice"),
            ("contact.friction=0.1:0.1:2", "has the value 0.1 twice"),
            ("a,b=[1,2],3", "3 is no list of 2 values, one for each of a,b; give them as [a,b],[c,d]"),
            ("a,b=[1,2],[1,2,3]", "[1,2,3] is no list of 2 values"),
            ("a,b=1:2:3", "1 is no list of 2 values"),
            ("a,=[1,2],[3,4]", "is not of the form"),
            ("contact.friction=0.1:0.8:1", "is no range"),
            ("contact.friction=0.1:0.8:-3", "is no range"),
            ("contact.friction=0.1:inf:3", "is no range"),
            ("contact.friction=0.1:0.8:1000000", "is no range"),
        ] {
            assert!(refused(text).contains(words), "{text}: {}", refused(text));
        }
        let [a, b] = ["a=1:2:1000", "b=1:2:1000"].map(|text| text.parse::<Variation>().unwrap());
        assert!(combinations(&[a.clone(), b]).unwrap_err().contains("more than 100000 combinations"));
        assert!(combinations(&[a.clone(), a.clone()]).unwrap_err().contains("a is varied twice"));
        let together: Variation = "b,a=[1,2],[3,4]".parse().unwrap();
        assert!(combinations(&[a, together]).unwrap_err().contains("a is varied twice"));
        for (a, b, same) in [
            ("contact.friction", "contact[0].friction", true),
            ("contact[1].friction", "contact[0].friction", false),
            ("contact[0].friction", "contact[0].obstacle.gap", false),
            ("mesh", "mesh.elements", true),
            ("load[1].traction", "load[1].traction[0]", true),
            ("load[1].traction[1]", "load[1].traction[0]", false),
            ("load[0].history[1]", "load[0].history[1][0]", true),
            ("load[1].history", "load[10].history", false),
        ] {
            assert_eq!(overlap(a, b), same, "{a} {b}");
        }
    }

    #[test]
    fn keys_change_together() {
        let variations = ["a, b[0].c=[1,[2,3]],[4,'x,y']", "d=5,6"].map(|text| text.parse::<Variation>().unwrap());
        let variants = combinations(&variations).unwrap();
        let all: Vec<String> = variants
            .iter()
            .map(|variant| variant.overrides.iter().map(ToString::to_string).collect::<Vec<_>>().join(" "))
            .collect();
        assert_eq!(
            all,
            ["a=1 b[0].c=[2,3] d=5", "a=1 b[0].c=[2,3] d=6", "a=4 b[0].c='x,y' d=5", "a=4 b[0].c='x,y' d=6"]
        );
        assert_eq!(variants[3].values, ["[4,'x,y']", "6"]);
    }

    #[test]
    fn the_last_changes_first() {
        let variations = ["a.b=1,2", "c=x,y,z"].map(|text| text.parse::<Variation>().unwrap());
        let variants = combinations(&variations).unwrap();
        let values: Vec<String> = variants.iter().map(|variant| variant.values.join("")).collect();
        assert_eq!(values, ["1x", "1y", "1z", "2x", "2y", "2z"]);
        assert_eq!(variants[5].overrides[0].to_string(), "a.b=2");
    }
}
