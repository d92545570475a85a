//! Formulas of the position, such as `0.5 * x^2 / 0.1`, and numbers that may be formulas.

mod grammar;

use std::fmt;
use std::ops::Range;

use super::input_error::{InputError, finite};

/// A formula in `x`, `y` and `z` (m).
#[derive(Debug, Clone)]
pub struct Formula {
    text: String,
    /// The instructions in postfix order: operands before operators.
    steps: Vec<Instruction>,
    units: FormulaUnits,
}

/// The units in which a formula is written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FormulaUnits {
    /// The unit of `x`, `y` and `z`, m.
    pub length: f64,
    /// The unit of the value, in SI units.
    pub value: f64,
}

/// An instruction of the evaluation, on a stack of values.
#[derive(Debug, Clone, Copy)]
enum Instruction {
    Number(f64),
    Coordinate(usize),
    /// A function of the last value.
    One(fn(f64) -> f64),
    /// A function of the last two values.
    Two(fn(f64, f64) -> f64),
}

/// The error of an invalid formula.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}, at character {character}")]
pub struct FormulaError {
    /// The description of the error.
    pub message: String,
    /// The position of the first wrong character, from 1.
    pub character: usize,
    /// The range of the wrong bytes.
    pub span: Range<usize>,
}

impl PartialEq for Formula {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text && self.units == other.units
    }
}

impl Formula {
    /// Parses a formula: numbers, `x`, `y`, `z`, `+ - * / ^`, brackets, functions and constants, as listed in
    /// doc/reference/scene/formulas.md.
    ///
    /// `^` has the highest precedence and is right-associative. Signs follow, then `*` and `/`, then `+` and `-`:
    /// `-x^2` is `-(x^2)`, and `2^x^2` is `2^(x^2)`.
    ///
    /// # Errors
    /// [`FormulaError`], with its position in the text.
    ///
    /// ```
    /// use stickslip::base::Formula;
    ///
    /// let formula = Formula::parse("1 - x^2 / 2")?;
    /// assert_eq!(formula.at([2.0, 0.0, 0.0]), -1.0);
    /// assert_eq!(Formula::parse("2x").unwrap_err().to_string(), "an operator is missing before `x`, at character 2");
    /// # Ok::<(), stickslip::base::FormulaError>(())
    /// ```
    pub fn parse(text: &str) -> Result<Self, FormulaError> {
        let units = FormulaUnits { length: 1.0, value: 1.0 };
        Ok(Formula { text: text.to_string(), steps: grammar::steps(text)?, units })
    }

    /// Returns the formula with its coordinates and value in `units`: its value at a place is that at the coordinates
    /// of the place in these units.
    ///
    /// ```
    /// use stickslip::base::{Formula, FormulaUnits};
    ///
    /// let square = Formula::parse("x^2")?.written_in(FormulaUnits { length: 1e-3, value: 1e6 });
    /// assert_eq!(square.at([0.003, 0.0, 0.0]), 9e6);
    /// # Ok::<(), stickslip::base::FormulaError>(())
    /// ```
    #[must_use]
    pub fn written_in(self, units: FormulaUnits) -> Self {
        Formula { units, ..self }
    }

    /// Returns the text of the formula.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns `true` if the formula contains coordinate `k`: 0 is x, 1 is y, 2 is z.
    pub fn has_coordinate(&self, k: usize) -> bool {
        self.steps.iter().any(|step| matches!(step, Instruction::Coordinate(c) if *c == k))
    }

    /// Evaluates the formula at `x` (m), in SI units; NaN if it has no value there.
    pub fn at(&self, x: [f64; 3]) -> f64 {
        let FormulaUnits { length, value } = self.units;
        self.evaluate(x.map(|c| c / length)).map_or(f64::NAN, |found| found * value)
    }

    fn evaluate(&self, x: [f64; 3]) -> Option<f64> {
        let mut stack = Vec::new();
        for step in &self.steps {
            let value = match *step {
                Instruction::Number(value) => value,
                Instruction::Coordinate(k) => x[k],
                Instruction::One(f) => f(stack.pop()?),
                Instruction::Two(f) => {
                    let last = stack.pop()?;
                    f(stack.pop()?, last)
                }
            };
            stack.push(value);
        }
        stack.pop()
    }
}

/// A number, or a formula of the position.
#[derive(Debug, Clone, PartialEq)]
pub enum Field {
    /// A uniform value.
    Uniform(f64),
    /// A formula of x, y and z (m).
    Formula(Formula),
}

impl Field {
    /// Returns the value at `x` (m); NaN where a formula is undefined.
    pub fn at(&self, x: [f64; 3]) -> f64 {
        match self {
            Field::Uniform(value) => *value,
            Field::Formula(formula) => formula.at(x),
        }
    }

    /// Returns the value if it is uniform.
    pub fn uniform(&self) -> Option<f64> {
        match self {
            Field::Uniform(value) => Some(*value),
            Field::Formula(_) => None,
        }
    }

    /// Checks the value of `key`.
    pub(crate) fn check(&self, key: &str) -> Result<(), InputError> {
        self.uniform().map_or(Ok(()), |value| finite(key, value))
    }
}

impl From<f64> for Field {
    fn from(value: f64) -> Self {
        Field::Uniform(value)
    }
}

impl From<Formula> for Field {
    fn from(formula: Formula) -> Self {
        Field::Formula(formula)
    }
}

impl fmt::Display for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Field::Uniform(value) => write!(f, "{value:?}"),
            Field::Formula(formula) => f.write_str(formula.text()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Formula;

    fn at(text: &str) -> f64 {
        Formula::parse(text).unwrap().at([2.0, 3.0, 5.0])
    }

    #[test]
    fn formulas_of_the_position() {
        assert_eq!(at("0.5 * x^2 / 4"), 0.5);
        assert_eq!(at("z - y"), 2.0);
        assert_eq!((at("1e-3"), at("2.5E2*x"), at(".5"), at("1.+x"), at("1.e1")), (1e-3, 500.0, 0.5, 3.0, 10.0));
        assert_eq!(at("-sqrt(y + 6)"), -3.0);
        assert_eq!(at("max(x, z) + abs(0 - y)"), 8.0);
        assert_eq!(at(" ( ( x+y )*( z ) ) "), 25.0);
        assert_eq!(at("cos(π) + ln(e) + log(E^2)"), 2.0);
    }

    #[test]
    fn the_usual_precedence() {
        for (text, value) in [
            ("-x^2 + 2", -2.0),
            ("1 + -x^2 * 0.5", -1.0),
            ("5 - 2*-x^2", 13.0),
            ("2^x^y", 256.0),
            ("(2^x)^y", 64.0),
            ("2^-x", 0.25),
            ("x^-1^2", 0.5),
            ("(-x)^2", 4.0),
            ("2*x^2", 8.0),
            ("8/2*x", 8.0),
            ("8/2/x", 2.0),
            ("9 - y - x", 4.0),
            ("9 - y + x", 8.0),
            ("--x", 2.0),
            ("+x - -y", 5.0),
            ("sqrt(x + 2)^3", 8.0),
            ("-sqrt(4)^2", -4.0),
        ] {
            assert_eq!(at(text), value, "{text}");
        }
    }

    #[test]
    fn a_value_that_is_not_defined_stays_so() {
        for text in ["sqrt(0 - x)", "max(ln(-x), 1)", "min(1, ln(-x))", "0/0", "sign(0/0)"] {
            assert!(at(text).is_nan(), "{text}");
        }
    }

    #[test]
    fn what_is_wrong_and_where() {
        for (text, said, span) in [
            ("", "nothing is given", 0..0),
            ("  ", "nothing is given", 2..2),
            ("x +", "something is missing at the end", 3..3),
            ("x *", "something is missing at the end", 3..3),
            ("2x", "an operator is missing before `x`", 1..2),
            ("π (x)", "an operator is missing before `(`", 3..4),
            ("1.2.3", "an operator is missing before `.`", 3..4),
            ("r^2", "`r` is neither x, y nor z", 0..1),
            ("1 + foo(x)", "`foo` is not a function that is known", 4..7),
            ("sin x", "`sin` needs its arguments in brackets", 0..3),
            ("atan2(y)", "`atan2` takes 2 arguments, not 1", 0..5),
            ("abs(x, y)", "`abs` takes 1 argument, not 2", 0..3),
            ("max(x)", "`max` takes 2 arguments or more, not 1", 0..3),
            ("1 + (x", "this bracket is not closed", 4..5),
            ("sin(x", "this bracket is not closed", 3..4),
            ("x)", "this bracket closes none", 1..2),
            ("()", "`)` stands where a number", 1..2),
            ("0,5", "`,` stands outside the brackets of a function", 1..2),
            ("x**2", "`*` stands where a number", 2..3),
            ("x > 1", "`>` means nothing in a formula", 2..3),
            ("{x}", "`{` means nothing in a formula", 0..1),
            (".", "`.` is not a number", 0..1),
            ("1e999", "1e999 is too large", 0..5),
        ] {
            let error = Formula::parse(text).unwrap_err();
            assert!(error.message.contains(said), "{text}: {error}");
            assert_eq!(error.span, span, "{text}: {error}");
        }
        assert_eq!(Formula::parse("π + r").unwrap_err().character, 5);
    }

    /// Neither long nor deeply nested formulas overflow the stack.
    #[test]
    fn long_and_deep_formulas() {
        assert_eq!(at(&vec!["x"; 100_000].join("-")), -199_996.0);
        assert_eq!(at(&format!("{}x{}", "(".repeat(90), ")".repeat(90))), 2.0);
        for text in ["(".repeat(100_000), "-".repeat(100_000), "2^".repeat(100_000), "sin(".repeat(100_000)] {
            let error = Formula::parse(&text).unwrap_err();
            assert!(error.message.contains("nested"), "{error}");
        }
    }
}
