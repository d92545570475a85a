//! The text of a scene from an input file of Abaqus or CalculiX: materials, sections, contacts, supports and loads.
//!
//! A keyword without a counterpart, or one that needs a choice, is never passed over: it stands in comments at the end.

use std::fmt::Write as _;
use std::path::Path;

use super::Scene;
use crate::body::mesh::{AbaqusData, AbaqusKeyword, MeshFileError, abaqus_keywords};

/// The moduli from which on a file is taken to be in Pa and m; below it is in MPa and mm.
const PASCALS: f64 = 1e7;

/// The parameters of keywords, some with their only value, that are understood; others are named in the comments.
const UNDERSTOOD: [(&str, &[&str]); 18] = [
    ("HEADING", &[]),
    ("ELEMENT", &["TYPE", "ELSET"]),
    ("MATERIAL", &["NAME"]),
    ("ELASTIC", &["TYPE=ISOTROPIC", "TYPE=ISO"]),
    ("DENSITY", &[]),
    ("EXPANSION", &["TYPE=ISO"]),
    ("SOLID SECTION", &["ELSET", "MATERIAL"]),
    ("SURFACE INTERACTION", &["NAME"]),
    ("SURFACE BEHAVIOR", &["PRESSURE-OVERCLOSURE=HARD"]),
    ("FRICTION", &[]),
    ("CONTACT PAIR", &["INTERACTION", "TYPE", "ADJUST"]),
    ("TIE", &["NAME"]),
    ("STEP", &["NAME", "INC", "NLGEOM=NO"]),
    ("STATIC", &[]),
    ("BOUNDARY", &["OP=MOD"]),
    ("DSLOAD", &["OP=MOD"]),
    ("DLOAD", &["OP=MOD"]),
    ("END STEP", &[]),
];

/// Keywords of the mesh, which its reader takes, and of output.
const OTHERS: [&str; 5] = ["NODE", "NSET", "ELSET", "SURFACE", "INCLUDE"];

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

/// A quantity that steps change: its values at times.
struct Changing<K> {
    of: K,
    points: Vec<[f64; 2]>,
}

#[derive(Default)]
struct Found {
    title: String,
    /// The value of the key `plane`; empty in space.
    plane: &'static str,
    materials: Vec<(String, Vec<(&'static str, f64)>)>,
    /// The ELSETs with their materials and thicknesses.
    sections: Vec<(String, String, Option<f64>)>,
    /// Surface interactions with their friction; `None` if it is not understood.
    frictions: Vec<(String, Option<f64>)>,
    /// Slave, master, and the other keys.
    contacts: Vec<(String, String, String)>,
    /// The boundary and the axis of each support.
    supports: Vec<Changing<(String, usize)>>,
    /// The lines of each load without its value, and its direction, if it has one.
    loads: Vec<Changing<(String, Vec<f64>)>>,
    /// Beginning and end of the step; the end is 0 before the first one.
    step: [f64; 2],
    shortest: Option<f64>,
    left: Vec<String>,
}

/// Changes the quantity `of` in a step. Returns `false` if the step has changed it already.
fn change<K: PartialEq>(all: &mut Vec<Changing<K>>, of: K, value: f64, [from, to]: [f64; 2]) -> bool {
    let k = all.iter().position(|known| known.of == of).unwrap_or_else(|| {
        all.push(Changing { of, points: Vec::new() });
        all.len() - 1
    });
    let points = &mut all[k].points;
    let before = points.last().copied();
    if before.is_some_and(|[time, _]| time >= to) {
        return false;
    }
    // Before the first step a value is there from the beginning on.
    if to > 0.0 && before.is_none_or(|[time, _]| time < from) {
        points.push([from, before.map_or(0.0, |[_, value]| value)]);
    }
    points.push([to, value]);
    true
}

/// Returns the largest value, and the line of the history relative to it.
fn history(points: &[[f64; 2]]) -> (f64, String) {
    let largest = points.iter().map(|[_, value]| *value).max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0);
    let over = if largest == 0.0 { 1.0 } else { largest };
    let rows = points.iter().map(|[time, value]| format!("[{time:?}, {:?}]", value / over + 0.0));
    (largest, format!("history = [{}]\n", rows.collect::<Vec<_>>().join(", ")))
}

fn real(field: Option<&&str>) -> Option<f64> {
    field.and_then(|field| field.replace(['D', 'd'], "e").parse().ok())
}

/// Returns the name of a set in a line of data, as the mesh has it.
fn name(field: &str) -> String {
    field.trim_matches('"').to_uppercase()
}

impl Found {
    fn take(&mut self, keyword: &AbaqusKeyword<'_>, data: &[AbaqusData<'_>]) {
        let rows = || data.iter().map(|row| row.fields.as_slice());
        let first = |k: usize| real(data.first().and_then(|row| row.fields.get(k)));
        let of = keyword.name.as_str();
        let is_output = ["PRINT", "FILE", "OUTPUT"].iter().any(|end| of.ends_with(end));
        let Some((_, understood)) = UNDERSTOOD.iter().find(|(known, _)| *known == of) else {
            if !OTHERS.contains(&of) && !is_output {
                self.leave(keyword, &[]);
                rows().take(5).for_each(|row| self.leave(keyword, row));
            }
            return;
        };
        let knows = |(parameter, value): &(String, String)| {
            understood.iter().any(|known| match known.split_once('=') {
                Some((known, only)) => known == parameter && value.eq_ignore_ascii_case(only),
                None => known == parameter,
            })
        };
        let is_understood = keyword.parameters().iter().all(knows);
        let is_one_row = data.len() <= 1 || !["ELASTIC", "DENSITY", "EXPANSION", "FRICTION"].contains(&of);
        if !(is_understood && is_one_row) {
            self.leave(keyword, &[]);
        }
        match of {
            "HEADING" => self.title = data.first().map_or(String::new(), |row| row.fields.join(", ")),
            "ELEMENT" => self.take_element(keyword),
            "MATERIAL" => self.materials.push((keyword.set("NAME").unwrap_or_default(), Vec::new())),
            "ELASTIC" | "DENSITY" | "EXPANSION" => {
                let names: &[&str] = match of {
                    "ELASTIC" => &["young", "poisson"],
                    "DENSITY" => &["density"],
                    _ => &["expansion"],
                };
                let values: Option<Vec<_>> = (0..names.len()).map(first).collect();
                match (self.materials.last_mut(), values) {
                    (Some((_, known)), Some(values)) if is_understood => {
                        known.extend(names.iter().copied().zip(values));
                    }
                    _ => rows().for_each(|row| self.leave(keyword, row)),
                }
            }
            "SOLID SECTION" => {
                let [set, material] = ["ELSET", "MATERIAL"].map(|name| keyword.set(name).unwrap_or_default());
                self.sections.push((set, material, first(0)));
            }
            "SURFACE INTERACTION" => self.frictions.push((keyword.set("NAME").unwrap_or_default(), Some(0.0))),
            "FRICTION" => {
                let value = first(0).filter(|_| is_understood && is_one_row && self.step[1] == 0.0);
                if value.is_none() {
                    rows().for_each(|row| self.leave(keyword, row));
                }
                if let (Some((_, friction)), true) = (self.frictions.last_mut(), self.step[1] == 0.0) {
                    *friction = value;
                }
            }
            "CONTACT PAIR" | "TIE" => {
                let adjust = keyword.value("ADJUST").and_then(|value| value.parse::<f64>().ok());
                let mut keys = adjust.map_or(String::new(), |adjust| format!("adjust = {adjust:?}\n"));
                let friction = keyword.set("INTERACTION").and_then(|name| {
                    self.frictions.iter().find(|(known, _)| *known == name).and_then(|(_, friction)| *friction)
                });
                match friction {
                    _ if of == "TIE" => keys.push_str("glue = true\n"),
                    Some(friction) => keys += &["friction = ", &format!("{friction:?}"), "\n"].concat(),
                    None => keys.push_str("# friction =              # it was not understood\n"),
                }
                for row in rows() {
                    match row {
                        [slave, master, ..] => self.contacts.push((name(slave), name(master), keys.clone())),
                        _ => self.leave(keyword, row),
                    }
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
            "BOUNDARY" | "DSLOAD" | "DLOAD" => {
                for row in rows() {
                    let is_taken = is_understood
                        && if of == "BOUNDARY" { self.take_support(row) } else { self.take_load(of, row) };
                    if !is_taken {
                        self.leave(keyword, row);
                    }
                }
            }
            _ => {}
        }
    }

    fn leave(&mut self, keyword: &AbaqusKeyword<'_>, row: &[&str]) {
        let parameters = keyword.parameters().iter().map(|(parameter, value)| match value.as_str() {
            "" => format!(", {parameter}"),
            value => format!(", {parameter}={value}"),
        });
        let data = if row.is_empty() { String::new() } else { format!(": {}", row.join(", ")) };
        let line = format!("# *{}{}{data}", keyword.name, parameters.collect::<String>());
        if !self.left.contains(&line) {
            self.left.push(line);
        }
    }

    fn take_element(&mut self, keyword: &AbaqusKeyword<'_>) {
        let kind = keyword.set("TYPE").unwrap_or_default();
        let families = [("CPE", "strain"), ("CPS", "stress"), ("CAX", "axisymmetric")];
        let plane = families.iter().find(|(family, _)| kind.starts_with(family)).map_or("", |(_, plane)| plane);
        let is_other = !self.plane.is_empty() && !plane.is_empty() && plane != self.plane;
        // Elements are integrated in full here, without incompatible modes.
        if is_other || kind.ends_with(['R', 'I']) {
            self.leave(keyword, &[]);
        }
        if !plane.is_empty() {
            self.plane = plane;
        }
    }

    /// Takes a line of `*BOUNDARY`. Returns `false` if it is not understood.
    fn take_support(&mut self, row: &[&str]) -> bool {
        let number = |k: usize| row.get(k).filter(|word| !word.is_empty()).map(|word| word.parse::<usize>());
        let kind = row.get(1).map(|word| word.to_uppercase());
        let directions = match (kind.as_deref(), number(1), number(2)) {
            (Some("ENCASTRE" | "PINNED"), ..) => 1..=3,
            (Some("XSYMM"), ..) => 1..=1,
            (Some("YSYMM"), ..) => 2..=2,
            (Some("ZSYMM"), ..) => 3..=3,
            (_, Some(Ok(from @ 1..=3)), None) => from..=from,
            (_, Some(Ok(from @ 1..=3)), Some(Ok(to @ 1..=6))) => from..=to,
            _ => return false,
        };
        let value = row.get(3).filter(|word| !word.is_empty()).map_or(Some(0.0), |value| real(Some(value)));
        let Some(value) = value.filter(|_| row[0].parse::<usize>().is_err()) else { return false };
        let axes = if self.plane.is_empty() { 3 } else { 2 };
        directions.filter(|direction| *direction <= axes).fold(true, |all, direction| {
            let of = (name(row[0]), direction);
            if self.step[0] > 0.0 && !self.supports.iter().any(|known| known.of == of) {
                let [from, _] = self.step;
                self.left
                    .push(format!("# {}, {direction} is held from the beginning, in the file from {from:?} s", of.0));
            }
            change(&mut self.supports, of, value, self.step) && all
        })
    }

    /// Takes a line of `*DSLOAD` or `*DLOAD`. Returns `false` if it is not understood.
    fn take_load(&mut self, of: &str, row: &[&str]) -> bool {
        let numbers: Option<Vec<f64>> =
            row.get(2..).and_then(|row| row.iter().map(|field| real(Some(field))).collect());
        let (Some(kind), Some(numbers)) = (row.get(1).map(|kind| kind.to_uppercase()), numbers) else { return false };
        let boundary = format!("boundary = {:?}\n", name(row[0]));
        let unit = |direction: &[f64]| {
            let size = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
            direction.iter().map(|x| x / size).collect::<Vec<_>>()
        };
        let is_whole = row[0].is_empty() || self.sections.len() <= 1;
        let (load, value) = match (of, kind.as_str(), &numbers[..]) {
            ("DSLOAD", "P", &[value]) => ((format!("{boundary}pressure"), Vec::new()), value),
            ("DSLOAD", "TRVEC", [value, direction @ ..]) if direction.len() >= 2 => {
                ((format!("{boundary}traction"), unit(direction)), *value)
            }
            ("DLOAD", "GRAV", [value, direction @ ..]) if direction.len() >= 2 && is_whole => {
                (("acceleration".to_string(), unit(direction)), *value)
            }
            _ => return false,
        };
        change(&mut self.loads, load, value, self.step)
    }

    fn text(mut self, file: &str) -> String {
        let mut text = format!("title = {:?}\n\n", if self.title.is_empty() { file } else { &self.title });
        let mut values = self.materials.iter().flat_map(|(_, values)| values);
        match values.find(|(name, _)| *name == "young") {
            Some((_, young)) if *young < PASCALS => text.push_str(
                "[units]                   # by the size of the moduli\nlength = \"mm\"\nstress = \"MPa\"\n\n",
            ),
            _ => text.push_str("# Lengths are in m and stresses in Pa, by the size of the moduli.\n\n"),
        }
        let _ = write!(text, "[mesh]\nkind = \"abaqus\"\nfile = {file:?}\n\n");
        self.write_materials(&mut text);
        for (slave, master, keys) in &self.contacts {
            let _ = write!(text, "[[contact]]\nboundary = {slave:?}\nagainst = {master:?}\n{keys}\n");
        }
        self.write_supports(&mut text);
        for Changing { of: (load, direction), points } in &self.loads {
            let (factor, line) = history(points);
            let components = direction.iter().map(|component| factor * component);
            let list: Vec<f64> = components.take(if self.plane.is_empty() { 3 } else { 2 }).collect();
            let value = if direction.is_empty() { format!("{factor:?}") } else { format!("{list:?}") };
            let _ = writeln!(text, "[[load]]\n{load} = {value}\n{line}");
        }
        let end = if self.step[1] > 0.0 { self.step[1] } else { 1.0 };
        let increments = self.shortest.map_or(10.0, |shortest| (end / shortest).round().clamp(1.0, 1000.0));
        let _ = writeln!(text, "[time]\nend = {end:?}\nincrements = {increments}");
        if !self.left.is_empty() {
            let _ = writeln!(text, "\n# Not converted, or not in all:\n{}", self.left.join("\n"));
        }
        text
    }

    fn write_materials(&mut self, text: &mut String) {
        let of = |name: &str| self.materials.iter().find(|(known, _)| known == name).or(self.materials.first());
        let write = |text: &mut String, head: &str, section: &str, all: bool| {
            let Some((name, values)) = of(section) else { return };
            let _ = writeln!(text, "{head:<25} # *MATERIAL, NAME={name}");
            for (name, value) in values.iter().filter(|(name, _)| all || ["young", "poisson"].contains(name)) {
                let _ = writeln!(text, "{name} = {value:?}");
            }
        };
        // Groups would inherit the density of the first material.
        let several = self.sections.len() > 1;
        let missing = "[material]                # there is no *MATERIAL: give young and poisson\n";
        text.push_str(if self.materials.is_empty() { missing } else { "" });
        write(text, "[material]", self.sections.first().map_or("", |(_, material, _)| material), !several);
        if !self.plane.is_empty() {
            let _ = writeln!(text, "plane = {:?}", self.plane);
        }
        let mut thicknesses = self.sections.iter().map(|(.., thickness)| thickness.unwrap_or(1.0));
        let first = thicknesses.next().unwrap_or(1.0);
        if thicknesses.any(|other| other != first) {
            self.left.push("# thicknesses of *SOLID SECTION: they differ".to_string());
        } else if first != 1.0 && ["strain", "stress"].contains(&self.plane) {
            let _ = writeln!(text, "thickness = {first:?}");
        }
        text.push('\n');
        for (set, material, _) in self.sections.iter().filter(|_| several) {
            write(text, "[[material.group]]", material, true);
            let _ = writeln!(text, "name = {set:?}\n");
        }
    }

    fn write_supports(&self, text: &mut String) {
        let mut still: Vec<(&str, Vec<&str>)> = Vec::new();
        let mut moved = String::new();
        for Changing { of: (set, direction), points } in &self.supports {
            let axis = ["x", "y", "z"][direction - 1];
            let (value, line) = history(points);
            if value != 0.0 {
                let _ = writeln!(
                    moved,
                    "[[support]]\nboundary = {set:?}\nfix = [{axis:?}]\ndisplacement = [{value:?}]\n{line}"
                );
            } else if let Some((_, axes)) = still.iter_mut().find(|(known, _)| known == set) {
                axes.push(axis);
            } else {
                still.push((set, vec![axis]));
            }
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
        // All sections are groups.
        assert_eq!(found.material.young, expected.material.young);
        assert!(expected.material.groups.iter().all(|group| found.material.groups.contains(group)), "{text}");
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

    /// Keywords that are not understood are named, and never converted in part without a word.
    #[test]
    fn what_is_not_converted_is_named() {
        let mesh = "*NODE\n1,0,0\n2,1,0\n3,1,1\n4,0,1\n*ELEMENT,TYPE=CPS4R,ELSET=A\n1,1,2,3,4\n*NSET,NSET=BASE\n1,2\n";
        let solid = "*MATERIAL,NAME=M\n*ELASTIC\n2.1e5,.3\n*SOLID SECTION,ELSET=A,MATERIAL=M\n5.\n";
        for (text, expected) in [
            ("*STEP\n*STATIC\n*DSLOAD,OP=NEW\nTOP,P,1.\n*END STEP\n", "# *DSLOAD, OP=NEW: TOP, P, 1."),
            ("*STEP\n*STATIC\n*DSLOAD,AMPLITUDE=A\nTOP,P,1.\n", "# *DSLOAD, AMPLITUDE=A: TOP, P, 1."),
            (
                "*STEP\n*STATIC\n*STEP\n*STATIC\n*BOUNDARY\nBASE,1,1,2.\n",
                "# BASE, 1 is held from the beginning, in the file",
            ),
            ("*STEP\n*STATIC\n*DSLOAD\nT,P,5.\nT,P,3.\n", "# *DSLOAD: T, P, 3."),
            ("*BOUNDARY,TYPE=VELOCITY\nBASE,1,1,2.\n", "# *BOUNDARY, TYPE=VELOCITY: BASE, 1, 1, 2."),
            ("*SURFACE INTERACTION,NAME=I\n*FRICTION,ROUGH\n", "# *FRICTION, ROUGH"),
            (
                "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n1e3\n",
                "# *SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
            ),
            ("*STEP,NLGEOM=YES\n*STATIC\n", "# *STEP, NLGEOM=YES"),
            ("*CHANGE FRICTION,INTERACTION=I\n*FRICTION\n.05\n", "# *CHANGE FRICTION, INTERACTION=I"),
            ("", "# *ELEMENT, TYPE=CPS4R, ELSET=A"),
        ] {
            let name = format!("stickslip-{}-{}.inp", std::process::id(), text.len());
            let file = std::env::temp_dir().join(name);
            std::fs::write(&file, format!("{mesh}{solid}{text}")).unwrap();
            let scene = Scene::text_from_abaqus(&file, "part.inp").unwrap();
            std::fs::remove_file(&file).unwrap();
            assert!(scene.contains(expected) && scene.contains("thickness = 5.0"), "{text} {scene}");
        }
    }
}
