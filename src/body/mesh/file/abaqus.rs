//! Parser of the mesh in input files of Abaqus and CalculiX: their keywords with parameters and data.
//!
//! Names are in capitals, as Abaqus does not tell capitals from small letters. The ELSETs of `*SOLID SECTION` are groups
//! of elements, without any section all ELSETs are. A `*SURFACE` is a boundary, and so is a node set with all nodes of a
//! side that belongs to one element only. Sources: Abaqus keywords reference manual; G. Dhondt, CalculiX CrunchiX user's
//! manual, version 2.20, chapters 6 and 7.

mod model;

use std::path::{Path, PathBuf};

use super::raw::RawMesh;
use super::{MeshFileError, MeshFormatError, Parsed, Place, expect};
use crate::base::input::FileKind;
use model::Model;

/// Parses `bytes`; messages name the file `name`, and files that it includes are read from its folder.
pub(super) fn read(name: &str, bytes: &[u8]) -> Parsed<RawMesh> {
    expect(name, bytes, FileKind::Abaqus)?;
    let mut keywords = Keywords::default();
    let mut model = Model::default();
    keywords.read(Path::new(name), bytes, &mut |keyword, data| model.read(keyword, data))?;
    model.finish(name)
}

/// Returns the files that the file at `path` includes, as far as they can be read.
pub(super) fn includes(path: &Path) -> Vec<PathBuf> {
    let mut keywords = Keywords::default();
    if let Ok(bytes) = crate::base::input::read_bytes(path) {
        // A fault is reported when the mesh is read.
        let _ = keywords.read(path, &bytes, &mut |_, _| Ok(()));
    }
    keywords.included
}

/// Hands each keyword of the file at `path`, and of the files that it includes, to `take`, with its data.
pub(crate) fn keywords(path: &Path, take: &mut dyn FnMut(&Keyword<'_>, &[Data<'_>])) -> Result<(), MeshFileError> {
    let name = path.display().to_string();
    let bytes =
        crate::base::input::read_bytes(path).map_err(|error| MeshFileError::Io { path: name.clone(), error })?;
    expect(&name, &bytes, FileKind::Abaqus)?;
    let mut take = |keyword: &Keyword<'_>, data: &[Data<'_>]| {
        take(keyword, data);
        Ok(())
    };
    Ok(Keywords::default().read(path, &bytes, &mut take)?)
}

/// The number of files that may include one another; Abaqus allows five.
const MAX_LEVELS: usize = 5;

/// The number of files that may be included.
const MAX_FILES: usize = 1000;

/// A keyword with its parameters.
pub(crate) struct Keyword<'a> {
    file: &'a Path,
    line: usize,
    /// The keyword in capitals without its star.
    pub name: String,
    /// The parameters: the names in capitals without spaces, the values as they are.
    parameters: Vec<(String, String)>,
}

/// A line of data of a keyword, divided at commas.
pub(crate) struct Data<'a> {
    /// The number of the line in the file, from 1.
    pub line: usize,
    pub fields: Vec<&'a str>,
}

impl<'a> Data<'a> {
    /// Returns the fields that are not empty.
    fn words(&self) -> impl Iterator<Item = &'a str> {
        self.fields.iter().copied().filter(|field| !field.is_empty())
    }
}

/// A function that takes a keyword and its data.
type Take<'a> = &'a mut dyn FnMut(&Keyword<'_>, &[Data<'_>]) -> Parsed<()>;

impl Keyword<'_> {
    /// Returns the parameters with their values.
    pub(crate) fn parameters(&self) -> &[(String, String)] {
        &self.parameters
    }

    /// Returns the value of a parameter, without quotes; empty if it has none.
    pub(crate) fn value(&self, parameter: &str) -> Option<&str> {
        let (_, value) = self.parameters.iter().find(|(name, _)| name == parameter)?;
        Some(value.trim_matches('"'))
    }

    /// Returns the name of a set that a parameter gives, in capitals.
    pub(crate) fn set(&self, parameter: &str) -> Option<String> {
        self.value(parameter).filter(|value| !value.is_empty()).map(str::to_uppercase)
    }

    /// Returns the name of a set that the keyword has to give, in capitals.
    fn needed(&self, parameter: &str) -> Parsed<String> {
        let message = || format!("*{} has no {parameter}=", self.name);
        self.set(parameter).ok_or_else(|| self.error(message(), format!("write it with {parameter}=NAME")))
    }

    /// Creates an error at the keyword.
    fn error(&self, message: impl Into<String>, help: impl Into<String>) -> MeshFormatError {
        error(self.file, self.line, message, help)
    }

    /// Creates an error at a line of its data.
    fn error_at(&self, data: &Data<'_>, message: impl Into<String>, help: impl Into<String>) -> MeshFormatError {
        error(self.file, data.line, message, help)
    }
}

fn error(file: &Path, line: usize, message: impl Into<String>, help: impl Into<String>) -> MeshFormatError {
    MeshFormatError::new(&file.display().to_string(), Place::Line(line), message, help)
}

/// A reader of keywords, which remembers the files that it has read.
#[derive(Default)]
struct Keywords {
    included: Vec<PathBuf>,
    level: usize,
}

impl Keywords {
    /// Hands each keyword of the file at `path` with these `bytes` to `take`, and those of included files in their place.
    fn read(&mut self, path: &Path, bytes: &[u8], take: Take<'_>) -> Parsed<()> {
        let text = String::from_utf8_lossy(bytes);
        let mut lines = text.lines().enumerate().map(|(k, line)| (k + 1, line.trim()));
        let mut lines = lines.by_ref().filter(|(_, line)| !line.is_empty() && !line.starts_with("**")).peekable();
        while let Some((line, text)) = lines.next() {
            let Some(words) = text.strip_prefix('*') else {
                let help = "begin every keyword with a star, such as *NODE";
                return Err(error(path, line, "data without a keyword before them", help));
            };
            let mut words = words.to_string();
            // A keyword goes on in the next line after a comma.
            while words.ends_with(',') {
                let Some((_, more)) = lines.next_if(|(_, next)| !next.starts_with('*')) else { break };
                words.push_str(more);
            }
            let keyword = keyword(path, line, &words);
            let mut data = Vec::new();
            while let Some((line, text)) = lines.next_if(|(_, next)| !next.starts_with('*')) {
                data.push(Data { line, fields: text.split(',').map(str::trim).collect() });
            }
            if keyword.name == "INCLUDE" {
                self.include(&keyword, take)?;
            } else {
                take(&keyword, &data)?;
            }
        }
        Ok(())
    }

    fn include(&mut self, keyword: &Keyword<'_>, take: Take<'_>) -> Parsed<()> {
        let Some(input) = keyword.value("INPUT").filter(|input| !input.is_empty()) else {
            return Err(keyword.error("*INCLUDE has no INPUT=", "name the file: *INCLUDE, INPUT=mesh.inp"));
        };
        let path = keyword.file.parent().unwrap_or(Path::new("")).join(input);
        let shown = path.display();
        if self.included.contains(&path) {
            return Err(keyword.error(format!("{shown} is included twice"), "include each file once"));
        }
        if self.level >= MAX_LEVELS || self.included.len() >= MAX_FILES {
            let message =
                format!("*INCLUDE of {shown}: more than {MAX_LEVELS} levels, or {MAX_FILES} files, of included files");
            return Err(keyword.error(message, "put them into fewer files"));
        }
        let bytes = crate::base::input::read_bytes(&path).map_err(|fault| {
            let message = format!("{shown} cannot be read: {fault}");
            keyword.error(message, "name an existing file; paths are relative to the file that includes it")
        })?;
        self.included.push(path.clone());
        self.level += 1;
        self.read(&path, &bytes, take)?;
        self.level -= 1;
        Ok(())
    }
}

fn keyword<'a>(file: &'a Path, line: usize, words: &str) -> Keyword<'a> {
    let solid = |word: &str| word.split_whitespace().collect::<String>().to_uppercase();
    let mut parts = words.split(',');
    let words: Vec<&str> = parts.next().unwrap_or_default().split_whitespace().collect();
    let name = words.join(" ").to_uppercase();
    let parameters = parts.filter(|part| !part.trim().is_empty()).map(|part| {
        let (parameter, value) = part.split_once('=').unwrap_or((part, ""));
        (solid(parameter), value.trim().to_string())
    });
    Keyword { file, line, name, parameters: parameters.collect() }
}
