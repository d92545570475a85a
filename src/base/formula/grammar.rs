//! A recursive descent parser from the text of a formula to its instructions:
//!
//! ```text
//! sum     = product { ("+" | "-") product }
//! product = signed { ("*" | "/") signed }
//! signed  = ["+" | "-"] signed | power
//! power   = operand ["^" signed]
//! operand = number | coordinate | constant | function "(" sum { "," sum } ")" | "(" sum ")"
//! ```

use super::functions::{Function, constant, function};
use super::{FormulaError, Instruction};

/// The names of the coordinates, m.
const COORDINATES: [&str; 3] = ["x", "y", "z"];

/// The largest nesting depth of brackets, signs and powers, far larger than in practice and far smaller than the
/// stack allows.
const DEEPEST: usize = 100;

/// Parses the formula `text` into instructions in postfix order.
pub(super) fn steps(text: &str) -> Result<Vec<Instruction>, FormulaError> {
    let mut parser = Parser { text, at: 0, depth: 0, steps: Vec::new() };
    if parser.peek().is_none() {
        return Err(parser.error(parser.at, 0, "nothing is given"));
    }
    parser.sum()?;
    match parser.peek() {
        None => Ok(parser.steps),
        Some(next) => Err(parser.unexpected(next)),
    }
}

struct Parser<'a> {
    text: &'a str,
    /// The number of bytes already read.
    at: usize,
    /// The nesting depth of the present part.
    depth: usize,
    steps: Vec<Instruction>,
}

impl Parser<'_> {
    fn sum(&mut self) -> Result<(), FormulaError> {
        self.product()?;
        while let Some(operator) = self.take(&['+', '-']) {
            self.product()?;
            self.steps.push(Instruction::Two(if operator == '+' { |a, b| a + b } else { |a, b| a - b }));
        }
        Ok(())
    }

    fn product(&mut self) -> Result<(), FormulaError> {
        self.signed()?;
        while let Some(operator) = self.take(&['*', '/']) {
            self.signed()?;
            self.steps.push(Instruction::Two(if operator == '*' { |a, b| a * b } else { |a, b| a / b }));
        }
        Ok(())
    }

    /// Parses a `signed`. All nesting passes here and is counted.
    fn signed(&mut self) -> Result<(), FormulaError> {
        self.depth += 1;
        if self.depth > DEEPEST {
            let message = format!("brackets, signs and powers are nested more than {DEEPEST} times");
            return Err(self.error(self.at, 0, message));
        }
        match self.take(&['+', '-']) {
            None => self.power()?,
            Some(sign) => {
                self.signed()?;
                if sign == '-' {
                    self.steps.push(Instruction::One(|a| -a));
                }
            }
        }
        self.depth -= 1;
        Ok(())
    }

    fn power(&mut self) -> Result<(), FormulaError> {
        self.operand()?;
        if self.take(&['^']).is_some() {
            self.signed()?;
            self.steps.push(Instruction::Two(f64::powf));
        }
        Ok(())
    }

    fn operand(&mut self) -> Result<(), FormulaError> {
        let step = match self.peek() {
            Some('(') => self.enclosed(None).map(|_| None)?,
            Some(c) if c.is_ascii_digit() || c == '.' => Some(self.number()?),
            Some(c) if c.is_alphabetic() => self.name()?,
            Some(c @ ('+' | '-' | '*' | '/' | '^' | ')' | ',')) => {
                let message = format!("`{c}` stands where a number, x, y, z, a function or a bracket should");
                return Err(self.error(self.at, 1, message));
            }
            Some(other) => return Err(self.unexpected(other)),
            None => return Err(self.error(self.at, 0, "something is missing at the end")),
        };
        self.steps.extend(step);
        Ok(())
    }

    /// Parses a number in Rust's notation, which includes `1e-3`.
    fn number(&mut self) -> Result<Instruction, FormulaError> {
        let text = &self.text[self.at..];
        let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
        let mut length = digits(text);
        if text[length..].starts_with('.') {
            length += 1 + digits(&text[length + 1..]);
        }
        if let Some(power) = text[length..].strip_prefix(['e', 'E']) {
            let sign = usize::from(power.starts_with(['+', '-']));
            if digits(&power[sign..]) > 0 {
                length += 1 + sign + digits(&power[sign..]);
            }
        }
        let number = &text[..length];
        let Ok(value) = number.parse::<f64>() else {
            return Err(self.error(self.at, length, format!("`{number}` is not a number")));
        };
        if value.is_infinite() {
            return Err(self.error(self.at, length, format!("{number} is too large")));
        }
        self.at += length;
        Ok(Instruction::Number(value))
    }

    /// Parses a coordinate, a constant or a function call. Returns its instruction, or `None` if the instructions are
    /// among the arguments.
    fn name(&mut self) -> Result<Option<Instruction>, FormulaError> {
        let (start, text) = (self.at, &self.text[self.at..]);
        let name = &text[..text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len())];
        self.at += name.len();
        if let Some(k) = COORDINATES.iter().position(|coordinate| *coordinate == name) {
            return Ok(Some(Instruction::Coordinate(k)));
        }
        if let Some(value) = constant(name) {
            return Ok(Some(Instruction::Number(value)));
        }
        let bracket = self.peek() == Some('(');
        let message = match function(name) {
            Some(function) if bracket => match (function, self.enclosed(Some(function))?) {
                (Function::One(f), 1) => return Ok(Some(Instruction::One(f))),
                (Function::Two(f), 2) => return Ok(Some(Instruction::Two(f))),
                (Function::Several(_), 2..) => return Ok(None),
                (_, given) => format!("`{name}` takes {}, not {given}", function.arguments()),
            },
            Some(_) => format!("`{name}` needs its arguments in brackets"),
            None if bracket => format!("`{name}` is not a function that is known"),
            None => format!("`{name}` is neither x, y nor z nor a constant that is known"),
        };
        Err(self.error(start, name.len(), message))
    }

    /// Parses the contents of brackets: a sum, or the arguments of a function. Returns their number.
    fn enclosed(&mut self, of: Option<Function>) -> Result<usize, FormulaError> {
        let open = self.at;
        self.at += 1;
        self.sum()?;
        let mut count = 1;
        while of.is_some() && self.take(&[',']).is_some() {
            self.sum()?;
            count += 1;
            if let Some(Function::Several(f)) = of {
                self.steps.push(Instruction::Two(f));
            }
        }
        match self.peek() {
            Some(')') => self.at += 1,
            Some(next) => return Err(self.unexpected(next)),
            None => return Err(self.error(open, 1, "this bracket is not closed")),
        }
        Ok(count)
    }

    /// Returns the next character that is not a space, and moves `self.at` to it.
    fn peek(&mut self) -> Option<char> {
        let rest = self.text[self.at..].trim_start();
        self.at = self.text.len() - rest.len();
        rest.chars().next()
    }

    /// Reads the next character if it is one of `wanted`.
    fn take(&mut self, wanted: &[char]) -> Option<char> {
        let next = self.peek().filter(|next| wanted.contains(next))?;
        self.at += next.len_utf8();
        Some(next)
    }

    /// Returns the error for a character after a complete sum.
    fn unexpected(&self, next: char) -> FormulaError {
        let message = match next {
            ')' => "this bracket closes none".to_string(),
            ',' => "`,` stands outside the brackets of a function".to_string(),
            '(' | '.' => format!("an operator is missing before `{next}`"),
            next if next.is_alphanumeric() => format!("an operator is missing before `{next}`"),
            next => format!("`{next}` means nothing in a formula"),
        };
        self.error(self.at, next.len_utf8(), message)
    }

    fn error(&self, start: usize, length: usize, message: impl Into<String>) -> FormulaError {
        let character = 1 + self.text[..start].chars().count();
        FormulaError { message: message.into(), character, span: start..start + length }
    }
}
