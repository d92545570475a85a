//! The text of a scene from an input file of Abaqus or CalculiX: materials, sections, contacts, supports and loads.
//!
//! What has no counterpart, or cannot be converted without a choice, stands in comments at the end.

use std::fmt::Write as _;
use std::path::Path;

use super::Scene;
use crate::body::mesh::{AbaqusData, AbaqusKeyword, MeshFileError, abaqus_keywords};

/// The moduli above which a file is taken to be in Pa and m, and below in MPa and mm.
const PASCALS: f64 = 1e7;

impl Scene {
    /// Returns the text of a scene for the input file of Abaqus or CalculiX at `path`, which it names as its mesh by
    /// `file`. Steps follow each other; a value that a step changes goes there evenly.
    ///
    /// # Errors
    /// If the file cannot be read, or is none of keywords.
    pub fn text_from_abaqus(path: &Path, file: &str) -> Result<String, MeshFileError> {
        let mut found = Found::default();
        abaqus_keywords(path, &mut |keyword, data| found.take(keyword, data))?;
        Ok(found.text(file))
    }
}

/// A quantity that steps change: its values at times, the first one before it changes.
#[derive(Default)]
struct Changing<K> {
    of: K,
    points: Vec<[f64; 2]>,
}

/// What a load is of: the place, and the lines of the table without the value.
type Load = (String, Vec<f64>);

#[derive(Default)]
struct Found {
    title: String,
    /// Line of the key `plane`, and of `element`.
    plane: &'static str,
    element: &'static str,
    materials: Vec<(String, Vec<(&'static str, f64)>)>,
    /// The ELSETs with their materials.
    sections: Vec<(String, String)>,
    frictions: Vec<(String, f64)>,
    /// Slave, master, and further keys; the surface interaction gives the friction.
    contacts: Vec<(String, String, String, Option<String>)>,
    supports: Vec<Changing<(String, usize)>>,
    loads: Vec<Changing<Load>>,
    /// Beginning and end of the step; the end is 0 before the first one.
    step: [f64; 2],
    shortest: Option<f64>,
    left: Vec<String>,
}

/// Sets the value of the quantity `of` at the end of a step.
fn change<K: PartialEq>(all: &mut Vec<Changing<K>>, of: K, value: f64, [from, to]: [f64; 2]) {
    let k = all.iter().position(|known| known.of == of).unwrap_or_else(|| {
        all.push(Changing { of, points: Vec::new() });
        all.len() - 1
    });
    let points = &mut all[k].points;
    if to == 0.0 {
        // Before the first step: from the beginning on.
        *points = vec![[0.0, value]];
        return;
    }
    let before = points.last().map_or(0.0, |[_, value]| *value);
    points.retain(|[time, _]| *time < from);
    points.extend([[from, before], [to, value]]);
}

/// Returns the largest value, and the line of the history relative to it.
fn history(points: &[[f64; 2]]) -> (f64, String) {
    let size = |value: &f64| value.abs();
    let largest = points.iter().map(|[_, value]| *value).max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(0.0);
    let over = if largest == 0.0 { 1.0 } else { largest };
    let rows: Vec<String> =
        points.iter().map(|[time, value]| format!("[{time:?}, {:?}]", value / over + 0.0)).collect();
    (largest, format!("history = [{}]\n", rows.join(", ")))
}

impl Found {
    fn take(&mut self, keyword: &AbaqusKeyword<'_>, data: &[AbaqusData<'_>]) {
        let rows = || data.iter().map(|row| row.fields.as_slice());
        let real = |field: Option<&&str>| field.and_then(|field| field.replace(['D', 'd'], "e").parse::<f64>().ok());
        let first = |k: usize| real(data.first().and_then(|row| row.fields.get(k)));
        match keyword.name.as_str() {
            "HEADING" => self.title = data.first().map_or(String::new(), |row| row.fields.join(", ")),
            "ELEMENT" => self.take_element(&keyword.set("TYPE").unwrap_or_default()),
            "MATERIAL" => self.materials.push((keyword.set("NAME").unwrap_or_default(), Vec::new())),
            "ELASTIC" | "DENSITY" | "EXPANSION" => {
                let names: &[&str] = match keyword.name.as_str() {
                    "ELASTIC" => &["young", "poisson"],
                    "DENSITY" => &["density"],
                    _ => &["expansion"],
                };
                let is_plain = keyword.set("TYPE").is_none_or(|kind| ["ISOTROPIC", "ISO"].contains(&kind.as_str()));
                let values: Option<Vec<_>> = (0..names.len()).map(first).collect();
                match (self.materials.last_mut(), values) {
                    (Some((_, known)), Some(values)) if is_plain => known.extend(names.iter().copied().zip(values)),
                    _ => self.leave(keyword, &[]),
                }
            }
            "SOLID SECTION" | "SOLIDSECTION" => {
                let [set, material] = ["ELSET", "MATERIAL"].map(|name| keyword.set(name).unwrap_or_default());
                self.sections.push((set, material));
            }
            "SURFACE INTERACTION" => self.frictions.push((keyword.set("NAME").unwrap_or_default(), 0.0)),
            "FRICTION" => match (self.frictions.last_mut(), first(0)) {
                (Some((_, friction)), Some(value)) => *friction = value,
                _ => self.leave(keyword, &[]),
            },
            "CONTACT PAIR" | "TIE" => {
                let adjust = keyword.value("ADJUST").and_then(|value| value.parse::<f64>().ok());
                let mut keys = adjust.map_or(String::new(), |adjust| format!("adjust = {adjust:?}\n"));
                if keyword.name == "TIE" {
                    keys.push_str("glue = true\n");
                }
                let interaction = (keyword.name != "TIE").then(|| keyword.set("INTERACTION").unwrap_or_default());
                for row in rows().filter(|row| row.len() >= 2) {
                    let [slave, master] = [row[0], row[1]].map(str::to_uppercase);
                    self.contacts.push((slave, master, keys.clone(), interaction.clone()));
                }
            }
            "STEP" => self.step = [self.step[1], self.step[1] + 1.0],
            "STATIC" => {
                let [increment, period] = [first(0), first(1)].map(|value| value.filter(|value| *value > 0.0));
                let period = period.unwrap_or(1.0);
                let increment = increment.unwrap_or(period);
                self.step[1] = self.step[0] + period;
                self.shortest = Some(self.shortest.map_or(increment, |shortest| shortest.min(increment)));
            }
            "BOUNDARY" => rows().for_each(|row| self.take_support(keyword, row)),
            "DSLOAD" | "DLOAD" => rows().for_each(|row| self.take_load(keyword, row)),
            "NODE" | "NSET" | "ELSET" | "SURFACE" | "SURFACE BEHAVIOR" | "END STEP" => {}
            name if name.ends_with("PRINT") || name.ends_with("FILE") || name.ends_with("OUTPUT") => {}
            _ if data.is_empty() => self.leave(keyword, &[]),
            _ => rows().take(5).for_each(|row| self.leave(keyword, row)),
        }
    }

    fn leave(&mut self, keyword: &AbaqusKeyword<'_>, row: &[&str]) {
        let line = format!("# *{} {}", keyword.name, row.join(", "));
        if !self.left.contains(&line) {
            self.left.push(line);
        }
    }

    fn take_element(&mut self, kind: &str) {
        let full = ["CPE4", "CAX4", "C3D8"].iter().any(|name| kind == *name || kind == format!("{name}H"));
        if full {
            self.element = "element = \"b-bar\"\n";
        }
        for (family, plane) in [("CPE", "strain"), ("CPS", "stress"), ("CAX", "axisymmetric")] {
            if kind.starts_with(family) {
                self.plane = plane;
            }
        }
    }

    fn take_support(&mut self, keyword: &AbaqusKeyword<'_>, row: &[&str]) {
        let directions: Option<Vec<usize>> = match row.get(1).map(|word| word.to_uppercase()).as_deref() {
            Some("ENCASTRE" | "PINNED") => Some(vec![1, 2, 3]),
            Some("XSYMM") => Some(vec![1]),
            Some("YSYMM") => Some(vec![2]),
            Some("ZSYMM") => Some(vec![3]),
            Some(number) => number.parse().ok().and_then(|from: usize| {
                let to = row.get(2).filter(|word| !word.is_empty()).map_or(Some(from), |word| word.parse().ok())?;
                ((1..=3).contains(&from) && to <= 3).then(|| (from..=to).collect())
            }),
            None => None,
        };
        let value = row.get(3).map_or(Some(0.0), |value| if value.is_empty() { Some(0.0) } else { value.parse().ok() });
        let is_node = row.first().is_none_or(|set| set.parse::<usize>().is_ok());
        match (directions, value) {
            (Some(directions), Some(value)) if !is_node && keyword.value("FIXED").is_none() => {
                for direction in directions.into_iter().filter(|k| *k < 3 || self.plane.is_empty()) {
                    change(&mut self.supports, (row[0].to_uppercase(), direction), value, self.step);
                }
            }
            _ => self.leave(keyword, row),
        }
    }

    fn take_load(&mut self, keyword: &AbaqusKeyword<'_>, row: &[&str]) {
        let numbers: Option<Vec<f64>> =
            row.get(2..).map(|fields| fields.iter().map_while(|f| f.parse().ok()).collect());
        let place = row.first().map(|set| set.to_uppercase()).unwrap_or_default();
        let boundary = format!("boundary = {place:?}\n");
        let (load, value) = match (row.get(1).map(|kind| kind.to_uppercase()).as_deref(), numbers.as_deref()) {
            (Some("P"), Some(&[value, ..])) if keyword.name == "DSLOAD" => {
                ((format!("{boundary}pressure"), vec![]), value)
            }
            (Some("TRVEC"), Some([value, direction @ ..])) if direction.len() >= 2 => {
                ((format!("{boundary}traction"), direction.to_vec()), *value)
            }
            (Some("GRAV"), Some([value, direction @ ..])) if direction.len() >= 2 => {
                (("acceleration".to_string(), direction.to_vec()), *value)
            }
            _ => return self.leave(keyword, row),
        };
        change(&mut self.loads, load, value, self.step);
    }

    fn text(&self, file: &str) -> String {
        let mut text = format!("title = {:?}\n\n", if self.title.is_empty() { file } else { &self.title });
        let young =
            |material: &[(&str, f64)]| material.iter().find(|(name, _)| *name == "young").map(|(_, value)| *value);
        if self.materials.iter().find_map(|(_, material)| young(material)).is_some_and(|young| young < PASCALS) {
            text.push_str(
                "[units]                   # by the size of the moduli\nlength = \"mm\"\nstress = \"MPa\"\n\n",
            );
        }
        let _ = write!(text, "[mesh]\nkind = \"abaqus\"\nfile = {file:?}\n{}\n", self.element);
        self.write_materials(&mut text);
        for (slave, master, keys, interaction) in &self.contacts {
            let _ = writeln!(text, "[[contact]]\nboundary = {slave:?}\nagainst = {master:?}");
            if let Some(name) = interaction {
                let friction = self.frictions.iter().find(|(known, _)| known == name).map_or(0.0, |(_, value)| *value);
                let _ = writeln!(text, "friction = {friction:?}");
            }
            let _ = writeln!(text, "{keys}");
        }
        self.write_supports(&mut text);
        for Changing { of: (load, direction), points } in &self.loads {
            let (factor, line) = history(points);
            let values: Vec<f64> = direction.iter().map(|component| factor * component).collect();
            let value = if direction.is_empty() { format!("{factor:?}") } else { format!("{:?}", self.cut(&values)) };
            let _ = writeln!(text, "[[load]]\n{load} = {value}\n{line}");
        }
        let end = if self.step[1] > 0.0 { self.step[1] } else { 1.0 };
        let increments = self.shortest.map_or(10.0, |shortest| (end / shortest).round().clamp(1.0, 1000.0));
        let _ = writeln!(text, "[time]\nend = {end:?}\nincrements = {increments}");
        if !self.left.is_empty() {
            let _ = writeln!(text, "\n# Not converted:\n{}", self.left.join("\n"));
        }
        text
    }

    /// Returns the components of a vector of the mesh's dimension.
    fn cut<'a>(&self, values: &'a [f64]) -> &'a [f64] {
        if self.plane.is_empty() { values } else { &values[..values.len().min(2)] }
    }

    fn write_materials(&self, text: &mut String) {
        let of = |name: &str| self.materials.iter().find(|(known, _)| known == name).or(self.materials.first());
        let mut sections: Vec<_> = self.sections.iter().map(|(set, material)| (set.as_str(), of(material))).collect();
        if sections.is_empty() {
            sections.push(("", self.materials.first()));
        }
        for (k, (set, material)) in sections.iter().enumerate() {
            let (head, name) = if k == 0 {
                ("[material]", String::new())
            } else {
                ("[[material.group]]", format!("name = {set:?}\n"))
            };
            let from = material.map_or("", |(name, _)| name);
            let _ = write!(text, "{head:<25} # *MATERIAL, NAME={from}\n{name}");
            material.iter().flat_map(|(_, values)| values).for_each(|(name, value)| {
                let _ = writeln!(text, "{name} = {value:?}");
            });
            if k == 0 && !self.plane.is_empty() {
                let _ = writeln!(text, "plane = {:?}", self.plane);
            }
            text.push('\n');
        }
    }

    fn write_supports(&self, text: &mut String) {
        let mut still: Vec<(&str, Vec<&str>)> = Vec::new();
        let mut moved = String::new();
        for Changing { of: (set, direction), points } in &self.supports {
            let axis = ["x", "y", "z"][direction - 1];
            if points.iter().all(|[_, value]| *value == 0.0) {
                match still.iter_mut().find(|(known, _)| known == set) {
                    Some((_, axes)) => axes.push(axis),
                    None => still.push((set, vec![axis])),
                }
                continue;
            }
            let (factor, line) = history(points);
            let _ = writeln!(
                moved,
                "[[support]]\nboundary = {set:?}\nfix = [{axis:?}]\ndisplacement = [{factor:?}]\n{line}"
            );
        }
        for (set, axes) in still {
            let _ = writeln!(text, "[[support]]\nboundary = {set:?}\nfix = {axes:?}\n");
        }
        text.push_str(&moved);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The converted file has the description of the scene that was written by hand.
    #[test]
    fn a_file_becomes_the_scene_written_by_hand() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/doc/howto/abaqus");
        let text = Scene::text_from_abaqus(&Path::new(folder).join("two_blocks.inp"), "two_blocks.inp").unwrap();
        let name = format!("{folder}/converted.toml");
        let found = Scene::parse(&name, &text, &[]).unwrap();
        let expected = Scene::read(&Path::new(folder).join("two_blocks.toml"), &[]).unwrap();
        let (found, expected) = (found.description, expected.description);
        assert_eq!(found.material, expected.material);
        assert_eq!(found.contacts, expected.contacts);
        assert_eq!(found.times, expected.times);
        assert_eq!(found.supports.len(), expected.supports.len(), "{text}");
        for expected in &expected.supports {
            let found = found.supports.iter().find(|found| (&found.at, &found.held) == (&expected.at, &expected.held));
            let found = found.unwrap_or_else(|| panic!("{expected:?} {text}"));
            for time in [0.0, 0.5, 1.0, 1.5, 2.0] {
                let at = |points: &[[f64; 2]]| crate::base::within(time, points).last().map(|[_, factor]| *factor);
                assert_eq!(at(&found.factors(2.0)), at(&expected.factors(2.0)));
            }
        }
    }
}
