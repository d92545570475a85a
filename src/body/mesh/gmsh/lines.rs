//! The lines of a Gmsh file, with their numbers for messages.

use std::str::FromStr;

use super::GmshError;

/// An iterator over the lines of a text that skips empty lines.
pub(super) struct Lines<'a> {
    file: &'a str,
    rest: std::iter::Enumerate<std::str::Lines<'a>>,
    /// The number of the last line read, from 1.
    number: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn new(file: &'a str, text: &'a str) -> Self {
        Lines { file, rest: text.lines().enumerate(), number: 1 }
    }

    fn advance(&mut self) -> Option<&'a str> {
        for (k, line) in self.rest.by_ref() {
            self.number = k + 1;
            if !line.trim().is_empty() {
                return Some(line.trim());
            }
        }
        None
    }

    /// Returns the next line of `section`.
    pub(super) fn next(&mut self, section: &str) -> Result<&'a str, GmshError> {
        match self.advance() {
            None => {
                let help = "the file is cut off: export or copy it again";
                Err(self.error(format!("the file ends within ${section}"), help))
            }
            Some(line) if line.starts_with('$') => {
                let message = format!("${section} ends before all it announces is there");
                Err(self.error(message, "export the mesh again from Gmsh"))
            }
            Some(line) => Ok(line),
        }
    }

    /// Returns the next line of `section` as `N` integers.
    pub(super) fn numbers<const N: usize, T: FromStr>(&mut self, section: &str) -> Result<[T; N], GmshError> {
        let line = self.next(section)?;
        let values: Option<Vec<T>> = line.split_whitespace().map(|word| word.parse().ok()).collect();
        values.and_then(|values| values.try_into().ok()).ok_or_else(|| {
            let plural = if N == 1 { "" } else { "s" };
            self.malformed(section, &format!("{N} whole number{plural}"))
        })
    }

    /// Returns the name of the next section; `None` at the end of the file.
    pub(super) fn section(&mut self) -> Result<Option<String>, GmshError> {
        match self.advance() {
            None => Ok(None),
            Some(line) => match line.strip_prefix('$') {
                Some(name) => Ok(Some(name.to_string())),
                None => Err(self.error(
                    format!("a section was expected, but there is `{}`", shortened(line)),
                    "export the mesh in the format MSH 4.1 (ASCII): gmsh -2 part.geo -format msh41, in space -3",
                )),
            },
        }
    }

    /// Reads the end of `section`.
    pub(super) fn end(&mut self, section: &str) -> Result<(), GmshError> {
        let help = "export or copy the file again";
        match self.advance() {
            Some(line) if line.strip_prefix("$End") == Some(section) => Ok(()),
            Some(line) => {
                Err(self.error(format!("$End{section} was expected, but there is `{}`", shortened(line)), help))
            }
            None => Err(self.error(format!("the file ends within ${section}"), help)),
        }
    }

    /// Skips a section that is not needed.
    pub(super) fn skip_to_end(&mut self, section: &str) -> Result<(), GmshError> {
        while let Some(line) = self.advance() {
            if line.strip_prefix("$End") == Some(section) {
                return Ok(());
            }
        }
        Err(self.error(format!("the file ends within ${section}"), "the file is cut off: export or copy it again"))
    }

    /// Creates an error at the last line read.
    pub(super) fn error(&self, message: impl Into<String>, help: impl Into<String>) -> GmshError {
        GmshError { file: self.file.to_string(), line: self.number, message: message.into(), help: help.into() }
    }

    /// Creates the error of a line of `section` that does not contain `what`.
    pub(super) fn malformed(&self, section: &str, what: &str) -> GmshError {
        self.error(format!("${section}: {what} expected in this line"), "export the mesh again from Gmsh")
    }
}

/// Shortens a line for messages.
fn shortened(line: &str) -> String {
    line.chars().take(40).collect()
}
