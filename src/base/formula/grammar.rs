//! A recursive descent parser from the text of a formula to its instructions:
//!
//! ```text
//! sum     = product { ("+" | "-") product }
//! product = signed { ("*" | "/") signed }
//! signed  = ["+" | "-"] signed | power
//! power   = operand ["^" signed]
//! operand = number | coordinate | constant | function "(" sum { "," sum } ")" | "(" sum ")"
//! ```

use std::f64::consts::{E, PI, TAU};

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

/// A function, by its number of arguments.
#[derive(Debug, Clone, Copy)]
pub(super) enum Function {
    One(fn(f64) -> f64),
    Two(fn(f64, f64) -> f64),
    /// A function of two or more arguments, applied from the left.
    Several(fn(f64, f64) -> f64),
}

impl Function {
    /// Returns a description of the number of arguments.
    pub(super) fn arguments(self) -> &'static str {
        match self {
            Function::One(_) => "1 argument",
            Function::Two(_) => "2 arguments",
            Function::Several(_) => "2 arguments or more",
        }
    }
}

const CONSTANTS: &[(&str, f64)] = &[("PI", PI), ("π", PI), ("TAU", TAU), ("τ", TAU), ("E", E), ("e", E)];

const FUNCTIONS: &[(&str, Function)] = &[
    ("sqrt", Function::One(f64::sqrt)),
    ("cbrt", Function::One(f64::cbrt)),
    ("exp", Function::One(f64::exp)),
    ("ln", Function::One(f64::ln)),
    ("log", Function::One(f64::ln)),
    ("log2", Function::One(f64::log2)),
    ("log10", Function::One(f64::log10)),
    ("sin", Function::One(f64::sin)),
    ("cos", Function::One(f64::cos)),
    ("tan", Function::One(f64::tan)),
    ("asin", Function::One(f64::asin)),
    ("acos", Function::One(f64::acos)),
    ("atan", Function::One(f64::atan)),
    ("sinh", Function::One(f64::sinh)),
    ("cosh", Function::One(f64::cosh)),
    ("tanh", Function::One(f64::tanh)),
    ("abs", Function::One(f64::abs)),
    ("sign", Function::One(sign)),
    ("signum", Function::One(sign)),
    ("floor", Function::One(f64::floor)),
    ("ceil", Function::One(f64::ceil)),
    ("round", Function::One(f64::round)),
    ("trunc", Function::One(f64::trunc)),
    ("fract", Function::One(f64::fract)),
    ("atan2", Function::Two(f64::atan2)),
    ("hypot", Function::Two(f64::hypot)),
    ("min", Function::Several(min)),
    ("max", Function::Several(max)),
];

/// Returns the constant called `name`.
pub(super) fn constant(name: &str) -> Option<f64> {
    CONSTANTS.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
}

/// Returns the function called `name`.
pub(super) fn function(name: &str) -> Option<Function> {
    FUNCTIONS.iter().find(|(known, _)| *known == name).map(|(_, function)| *function)
}

/// Returns -1, 0 or 1; unlike [`f64::signum`] 0 at 0.
fn sign(a: f64) -> f64 {
    if a == 0.0 { 0.0 } else { a.signum() }
}

/// Returns the smaller number; unlike [`f64::min`], NaN if either is NaN.
fn min(a: f64, b: f64) -> f64 {
    if a.is_nan() || a < b { a } else { b }
}

/// Returns the larger number; unlike [`f64::max`], NaN if either is NaN.
fn max(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_documented() {
        let page = include_str!("../../../doc/reference/scene/formulas.md");
        let names = FUNCTIONS.iter().map(|(name, _)| name).chain(CONSTANTS.iter().map(|(name, _)| name));
        for name in names {
            assert!(page.contains(&format!("`{name}`")), "`{name}` is not in doc/reference/scene/formulas.md");
        }
    }

    #[test]
    fn names_mean_what_they_say() {
        let of = |text: &str| crate::base::formula::Formula::parse(text).unwrap().at([0.25, -3.0, 4.0]);
        for (text, value) in [
            ("exp(x)", 0.25_f64.exp()),
            ("tan(x) - sin(x)/cos(x)", 0.0),
            ("asin(x) + acos(x)", PI / 2.0),
            ("atan(y) - atan2(y, 1)", 0.0),
            ("cosh(x)^2 - sinh(x)^2", 1.0),
            ("tanh(x)", 0.25_f64.tanh()),
            ("sign(y) + 10*sign(z) + 100*signum(0)", 9.0),
            ("floor(-x) + 10*ceil(x) + 100*round(2.5)", 309.0),
            ("trunc(y - x) + fract(z + x)", -2.75),
            ("hypot(y, z)", 5.0),
            ("cbrt(27) + log2(8) + log10(1000)", 9.0),
            ("ln(z) - log(z)", 0.0),
            ("min(z, x, y) + 10*max(x, z, y)", 37.0),
            ("TAU - 2*PI", 0.0),
        ] {
            assert!((of(text) - value).abs() < 1e-15 * value.abs().max(1.0), "{text}: {}", of(text));
        }
    }
}
