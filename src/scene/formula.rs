//! Formulas of the position, such as `0.5 * x^2 / 0.1`.

use exmex::{Express, FlatEx, FloatOpsFactory, MatchLiteral};

/// The names of the coordinates, m.
const COORDINATES: [&str; 3] = ["x", "y", "z"];

/// Numbers as Rust writes them, `1e-3` among them, which exmex would read as a product with e.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct Number;

impl MatchLiteral for Number {
    fn is_literal(text: &str) -> Option<&str> {
        let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
        let whole = digits(text);
        let mut length = whole;
        if text[length..].starts_with('.') {
            length += 1 + digits(&text[length + 1..]);
        }
        if length == 0 || &text[..length] == "." {
            return None;
        }
        if let Some(power) = text[length..].strip_prefix(['e', 'E']) {
            let sign = usize::from(power.starts_with(['+', '-']));
            let digits = digits(&power[sign..]);
            if digits > 0 {
                length += 1 + sign + digits;
            }
        }
        Some(&text[..length])
    }
}

type Expression = FlatEx<f64, FloatOpsFactory<f64>, Number>;

/// A formula of `x`, `y` and `z` (m).
#[derive(Debug, Clone)]
pub struct Formula {
    text: String,
    expression: Box<Expression>,
    /// Which coordinate each variable of the expression is.
    variables: Vec<usize>,
}

impl PartialEq for Formula {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text
    }
}

impl Formula {
    /// Reads a formula: numbers, `x`, `y`, `z`, `+ - * / ^`, brackets, functions such as `sqrt`, `sin`, `abs`,
    /// and `PI`.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn parse(text: &str) -> Result<Self, String> {
        let expression = Expression::parse(text).map_err(|error| error.to_string())?;
        let variable = |name: &String| {
            let unknown = || format!("`{name}` is neither x, y nor z nor a known function");
            COORDINATES.iter().position(|c| c == name).ok_or_else(unknown)
        };
        let variables = expression.var_names().iter().map(variable).collect::<Result<_, _>>()?;
        Ok(Formula { text: text.to_string(), expression: Box::new(expression), variables })
    }

    /// The formula as it was given.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Its value at `x` (m); NaN where it has none.
    pub fn at(&self, x: [f64; 3]) -> f64 {
        self.expression.eval_iter(self.variables.iter().map(|&k| x[k])).unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::Formula;

    #[test]
    fn formulas_of_the_position() {
        let at = |text: &str| Formula::parse(text).unwrap().at([2.0, 3.0, 5.0]);
        assert_eq!(at("0.5 * x^2 / 4"), 0.5);
        assert_eq!(at("z - y"), 2.0);
        assert_eq!((at("1e-3"), at("2.5E2*x"), at(".5"), at("1.+x")), (1e-3, 500.0, 0.5, 3.0));
        assert_eq!(at("-sqrt(y + 6)"), -3.0);
        assert_eq!(at("max(x, z) + abs(0 - y)"), 8.0);
        for (text, said) in [("x +", ""), ("r^2", "`r` is neither"), ("(x", ""), ("", "")] {
            let error = Formula::parse(text).unwrap_err();
            assert!(error.contains(said), "{text}: {error}");
        }
    }
}
