//! Formulas: expressions whose values are known, written with as few brackets as the rules ask for, and broken texts.

use super::said;
use crate::corpus::Corpus;
use crate::mutate::mutated;
use crate::pool::Verdict;
use crate::random::Random;
use stickslip::base::Formula;

type One = (&'static str, fn(f64) -> f64);
type Two = (&'static str, fn(f64, f64) -> f64);

const ONE: [One; 10] = [
    ("sqrt", f64::sqrt),
    ("exp", f64::exp),
    ("ln", f64::ln),
    ("sin", f64::sin),
    ("atan", f64::atan),
    ("tanh", f64::tanh),
    ("abs", f64::abs),
    ("floor", f64::floor),
    ("fract", f64::fract),
    ("cbrt", f64::cbrt),
];
const TWO: [Two; 2] = [("atan2", f64::atan2), ("hypot", f64::hypot)];

/// The places of the values that a text announces behind a line break.
const PLACES: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [2.0, -3.0, 0.5], [1e-3, 7.25, -1e4]];

enum Tree {
    Number(f64),
    Coordinate(usize),
    Minus(Box<Tree>),
    Call(One, Box<Tree>),
    CallTwo(Two, Box<[Tree; 2]>),
    Operation(char, Box<[Tree; 2]>),
}

impl Tree {
    fn random(random: &mut Random, depth: usize) -> Self {
        let child = |random: &mut Random| Tree::random(random, depth - 1);
        match if depth == 0 { random.below(2) } else { random.below(9) } {
            0 => Tree::Number(match random.below(3) {
                0 => random.below(10) as f64,
                1 => random.decades(-12.0, 12.0),
                _ => random.between(0.0, 4.0),
            }),
            1 => Tree::Coordinate(random.below(3)),
            2 => Tree::Minus(Box::new(child(random))),
            3 => Tree::Call(random.one(&ONE), Box::new(child(random))),
            4 => Tree::CallTwo(random.one(&TWO), Box::new([child(random), child(random)])),
            _ => Tree::Operation(random.one(&['+', '-', '*', '/', '^']), Box::new([child(random), child(random)])),
        }
    }

    fn at(&self, x: [f64; 3]) -> f64 {
        match self {
            Tree::Number(value) => *value,
            Tree::Coordinate(k) => x[*k],
            Tree::Minus(a) => -a.at(x),
            Tree::Call((_, f), a) => f(a.at(x)),
            Tree::CallTwo((_, f), both) => f(both[0].at(x), both[1].at(x)),
            Tree::Operation(operator, both) => {
                let (a, b) = (both[0].at(x), both[1].at(x));
                match operator {
                    '+' => a + b,
                    '-' => a - b,
                    '*' => a * b,
                    '/' => a / b,
                    _ => a.powf(b),
                }
            }
        }
    }

    /// How much it binds: sums 0, products 1, signs 2, powers 3, operands 4.
    fn binds(&self) -> usize {
        match self {
            Tree::Operation('+' | '-', _) => 0,
            Tree::Operation('*' | '/', _) => 1,
            Tree::Minus(_) => 2,
            Tree::Operation(..) => 3,
            _ => 4,
        }
    }

    /// In brackets where it stands for something that binds at least so much, and does not.
    fn text(&self, at_least: usize) -> String {
        let text = match self {
            Tree::Number(value) => format!("{value:?}"),
            Tree::Coordinate(k) => ["x", "y", "z"][*k].to_string(),
            Tree::Minus(a) => format!("-{}", a.text(2)),
            Tree::Call((name, _), a) => format!("{name}({})", a.text(0)),
            Tree::CallTwo((name, _), both) => format!("{name}({}, {})", both[0].text(0), both[1].text(0)),
            // To the right of ^ stands what binds as signs do.
            Tree::Operation('^', both) => format!("{}^{}", both[0].text(4), both[1].text(2)),
            Tree::Operation(operator, both) => {
                let binds = self.binds();
                format!("{} {operator} {}", both[0].text(binds), both[1].text(binds + 1))
            }
        };
        if self.binds() < at_least { format!("({text})") } else { text }
    }
}

/// A formula; if it is sound, its values at [`PLACES`] as bits, each behind a line break.
pub(super) fn make(random: &mut Random, corpus: &Corpus) -> Vec<u8> {
    let depth = 1 + random.below(5);
    let tree = Tree::random(random, depth);
    let text = tree.text(0);
    if random.percent(50) {
        return mutated(random, text.as_bytes(), b"2 * x^-y + max(1, PI, z) - sqrt(e)", &corpus.words);
    }
    let values = PLACES.map(|x| format!("\n{}", tree.at(x).to_bits()));
    [text, values.concat()].concat().into_bytes()
}

pub(super) fn check(bytes: &[u8]) -> Verdict {
    let text = String::from_utf8_lossy(bytes);
    let mut lines = text.split('\n');
    let text = lines.next().unwrap_or_default();
    let known: Vec<f64> = lines.filter_map(|line| line.parse().ok()).map(f64::from_bits).collect();
    let formula = match Formula::parse(text) {
        Ok(formula) => formula,
        Err(error) if known.len() == PLACES.len() => return Err(format!("a sound formula is refused: {error}")),
        Err(error) => {
            let within = text.get(error.span.clone()).is_some();
            return if within { said(&error) } else { Err(format!("`{error}` points out of the text")) };
        }
    };
    let values = PLACES.map(|x| formula.at(x));
    if formula.text() != text {
        return Err(format!("its text is {}", formula.text()));
    }
    if known.len() < PLACES.len() {
        return Ok("read");
    }
    for (found, known) in values.iter().zip(known) {
        if found.to_bits() != known.to_bits() && !(found.is_nan() && known.is_nan()) {
            return Err(format!("its value is {found:e}, not {known:e}"));
        }
    }
    Ok("valued")
}
