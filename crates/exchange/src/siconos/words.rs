//! The words of a text, with their lines.

use stickslip::base::InputError;

/// The remaining words of a text.
pub(super) struct Words<'a> {
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    /// The remaining words of the line.
    here: std::str::SplitWhitespace<'a>,
    /// The line of the last word, from 1.
    line: usize,
}

impl<'a> Words<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Words { lines: text.lines().enumerate(), here: "".split_whitespace(), line: 1 }
    }

    /// Returns the line of the last word, from 1.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    /// Describes an error in the line of the last word.
    pub(super) fn fault(&self, message: &str, help: &str) -> InputError {
        InputError::new(format!("line {}", self.line), message, help)
    }

    pub(super) fn next(&mut self) -> Option<&'a str> {
        loop {
            if let Some(word) = self.here.next() {
                return Some(word);
            }
            let (number, line) = self.lines.next()?;
            (self.here, self.line) = (line.split_whitespace(), number + 1);
        }
    }

    /// Reads the next word; `what` names it in errors.
    pub(super) fn word(&mut self, what: &str) -> Result<&'a str, InputError> {
        let word = self.next();
        word.ok_or_else(|| {
            self.fault(&format!("the text ends before {what}"), "the file was truncated: write it again")
        })
    }

    /// Reads a whole number, 0 or more; `what` names it in errors.
    pub(super) fn count(&mut self, what: &str) -> Result<usize, InputError> {
        let word = self.word(what)?;
        word.parse()
            .map_err(|_| self.fault(&format!("expected {what}, found `{word}`"), "give a whole number, 0 or more"))
    }

    /// Reads a number; `what` names it in errors.
    pub(super) fn number(&mut self, what: &str) -> Result<f64, InputError> {
        let word = self.word(what)?;
        match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(self.fault(&format!("expected {what}, found `{word}`"), "give a finite number")),
        }
    }

    /// Reads `count` numbers. Memory grows with the words.
    pub(super) fn numbers(&mut self, what: &str, count: usize) -> Result<Vec<f64>, InputError> {
        let mut numbers = Vec::new();
        for _ in 0..count {
            numbers.push(self.number(what)?);
        }
        Ok(numbers)
    }

    /// Reads `count` whole numbers, 0 or more.
    pub(super) fn counts(&mut self, what: &str, count: usize) -> Result<Vec<usize>, InputError> {
        let mut counts = Vec::new();
        for _ in 0..count {
            counts.push(self.count(what)?);
        }
        Ok(counts)
    }

    /// Returns the words that are left.
    pub(super) fn left(&self) -> impl Iterator<Item = &'a str> {
        self.here.clone().chain(self.lines.clone().flat_map(|(_, line)| line.split_whitespace()))
    }

    /// Returns `true` if at most `count` words are left.
    pub(super) fn are_at_most(&self, count: usize) -> bool {
        self.left().take(count.saturating_add(1)).count() <= count
    }
}
