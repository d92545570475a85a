//! The requested records: displacement and stress of points over time, slip and stresses of a load cycle.

use crate::algebra::vector::Vector;
use crate::base::input_error::{InputError, each, ensure, finite, in_one_line};

/// The largest number of points of a probe; output of more points belongs in a field file.
const MAX_POINTS: usize = 10_000;

/// A named point, or a named row of points on a line.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// The name of the probe.
    pub name: String,
    /// The position of the probe.
    pub place: ProbePlace,
}

/// The position of a probe; vectors have as many components as the body has dimensions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ProbePlace {
    /// At a point, m.
    Point(Vector),
    /// On a line.
    Line {
        /// The first point, m.
        from: Vector,
        /// The last point, m.
        to: Vector,
        /// The number of equally spaced points, including the ends.
        count: usize,
    },
}

impl Probe {
    /// Creates a probe at `point`, m.
    pub fn at(name: &str, point: impl Into<Vector>) -> Self {
        Probe { name: name.to_string(), place: ProbePlace::Point(point.into()) }
    }

    /// Creates a probe at `count` points between two ends (m), including the ends.
    pub fn along(name: &str, from: impl Into<Vector>, to: impl Into<Vector>, count: usize) -> Self {
        let (from, to) = (from.into(), to.into());
        Probe { name: name.to_string(), place: ProbePlace::Line { from, to, count } }
    }

    /// Returns its points, m; missing components are 0.
    pub fn points(&self) -> Vec<[f64; 3]> {
        match self.place {
            ProbePlace::Point(point) => vec![point.components()],
            ProbePlace::Line { from, to, count } => {
                let (from, to) = (from.components(), to.components());
                let share = |k: usize| k as f64 / (count.max(2) - 1) as f64;
                // The ends are exact.
                let at = |k: usize| [0, 1, 2].map(|c| (1.0 - share(k)) * from[c] + share(k) * to[c]);
                (0..count).map(at).collect()
            }
        }
    }

    /// Checks `probes` as far as possible without a mesh.
    ///
    /// # Errors
    /// [`InputError`] with the key of the wrong value, such as `output.probe[0].point`.
    pub fn check(probes: &[Probe]) -> Result<(), InputError> {
        let one = |k: usize, Probe { name, place }: &Probe| {
            in_one_line("a probe", name, "give a name such as \"corner\"")?;
            if probes[..k].iter().any(|other| other.name == *name) {
                let message = format!("another probe is called {name:?}");
                return Err(InputError::new("name", message, "give each probe a name of its own"));
            }
            let each = |key: &str, point: Vector| point.components().iter().try_for_each(|x| finite(key, *x));
            match *place {
                ProbePlace::Point(point) => each("point", point),
                ProbePlace::Line { from, to, count } => {
                    each("from", from)?;
                    each("to", to)?;
                    let help = "the ends count; use output.fields for the whole body";
                    let is_valid = (2..=MAX_POINTS).contains(&count);
                    ensure(is_valid, "points", &count, "at least 2 and at most 10000", help)?;
                    let message = "the line from a point to itself has no length";
                    let help = "give point = [x, y] for a single point";
                    if from == to { Err(InputError::new("to", message, help)) } else { Ok(()) }
                }
            }
        };
        each("output.probe", probes, one).map(drop)
    }
}

/// The choice of a load cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CycleChoice {
    /// The last cycle. It ends with the last increment in which a load changes, and begins at the last earlier increment at
    /// which all loads had the same values and, just before, changed in the same proportions.
    Last,
    /// The times of its beginning and its end, s.
    Between([f64; 2]),
}

/// A load cycle whose slip and stresses are recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CycleRequest {
    /// The cycle.
    pub choice: CycleChoice,
    /// Archard's coefficient k, 1/Pa: the wear depth is k times the integral of the pressure over the slip path. `None` if
    /// no wear depth is wanted.
    pub wear_coefficient: Option<f64>,
}

impl CycleRequest {
    /// Creates the request of a cycle.
    ///
    /// # Errors
    /// [`InputError`] if the times of the cycle do not increase from 0, or if the coefficient is not positive.
    pub fn new(choice: CycleChoice, wear_coefficient: Option<f64>) -> Result<Self, InputError> {
        if let CycleChoice::Between(times) = choice {
            let [start, end] = times;
            if !(start >= 0.0 && start < end && end.is_finite()) {
                let help = "give the times of the beginning and the end of the cycle, s, or \"last\"";
                return Err(InputError::new("cycle", format!("cycle is {times:?}, but times increase from 0"), help));
            }
        }
        if let Some(k) = wear_coefficient {
            finite("wear_coefficient", k)?;
            let help = "the wear depth is this times the integral of the pressure over the slip path";
            ensure(k > 0.0, "wear_coefficient", &k, "above 0", help)?;
        }
        Ok(CycleRequest { choice, wear_coefficient })
    }
}
