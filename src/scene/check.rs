//! From the file as it stands to a scene that can be solved.

mod material;
mod mesh;
mod obstacle;
mod solver;

use std::ops::Range;
use std::path::Path;

use toml::Spanned;

use super::document::{self, Direction, Document, Tuple};
use super::error::Source;
use super::{Contact, Load, Name, Output, Scene, SceneError, Support, Time};

/// Checks every value of `document`, which was read from `source`.
pub(super) fn scene(document: Document, source: Source) -> Result<Scene, SceneError> {
    let check = Check { source: &source };
    let time = check.time(&document.time)?;
    let mesh = check.mesh(&document.mesh)?;
    let material = check.material(&document.material)?;
    let element = check.element(&document.mesh, &material)?;
    let element_span = document.mesh.element.as_ref().map(Spanned::span);
    let supports = document.support.into_iter().map(|support| check.support(support)).collect::<Result<_, _>>()?;
    let contacts = check.contacts(document.contact, &time)?;
    let loads = document.load.into_iter().map(|load| check.load(load, &time)).collect::<Result<_, _>>()?;
    let solver = check.solver(&document.solver, !contacts.is_empty())?;
    let one_tangent_span = solver::one_tangent_span(&document.solver, solver.method);
    let output = check.output(document.output, &time)?;
    let stem = || Path::new(&source.name).file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
    let title = document.title.unwrap_or_else(stem);
    Ok(Scene {
        title,
        mesh,
        element,
        element_span,
        material,
        supports,
        contacts,
        loads,
        time,
        solver,
        one_tangent_span,
        output,
        source,
    })
}

struct Check<'a> {
    source: &'a Source,
}

impl Check<'_> {
    fn fail<T>(&self, span: Range<usize>, message: impl Into<String>, help: &str) -> Result<T, SceneError> {
        Err(self.source.error(span, message, help))
    }

    /// Fails unless `sound`, saying what `name` is and what it must be.
    fn demand<T: std::fmt::Debug>(
        &self,
        sound: bool,
        name: &str,
        value: &Spanned<T>,
        must: &str,
        help: &str,
    ) -> Result<(), SceneError> {
        if sound {
            return Ok(());
        }
        self.fail(value.span(), format!("{name} is {:?}, but must be {must}", value.get_ref()), help)
    }

    /// The value of a key that this kind of thing needs.
    fn needed<'a, T>(
        &self,
        name: &str,
        value: Option<&'a Spanned<T>>,
        kind: &Range<usize>,
        whose: &str,
    ) -> Result<&'a Spanned<T>, SceneError> {
        value.map_or_else(|| self.fail(kind.clone(), format!("{whose} needs {name}"), "add the key"), Ok)
    }

    /// Fails if a key is given that belongs to another kind of thing.
    fn foreign<T>(&self, name: &str, value: Option<&Spanned<T>>, whose: &str) -> Result<(), SceneError> {
        value.map_or(Ok(()), |value| self.fail(value.span(), format!("{whose} has no {name}"), "remove the key"))
    }

    fn finite(&self, name: &str, value: &Spanned<f64>) -> Result<f64, SceneError> {
        self.demand(
            value.get_ref().is_finite(),
            name,
            value,
            "a finite number",
            "give a number other than nan or inf",
        )?;
        Ok(*value.get_ref())
    }

    /// Two or three finite numbers.
    fn components(&self, name: &str, value: &Spanned<Vec<f64>>) -> Result<Vec<f64>, SceneError> {
        let components = value.get_ref();
        let sound = (2..=3).contains(&components.len()) && components.iter().all(|x| x.is_finite());
        self.demand(sound, name, value, "two or three finite numbers", "give one for each axis, not nan or inf")?;
        Ok(components.clone())
    }

    fn time(&self, time: &document::Time) -> Result<Time, SceneError> {
        let end = self.finite("time.end", &time.end)?;
        self.demand(end > 0.0, "time.end", &time.end, "positive", "the history runs from 0 to this time, s")?;
        let increments = *time.increments.get_ref();
        let help = "the history is divided into this many equal increments";
        let sound = (1..=10_000_000).contains(&increments);
        self.demand(sound, "time.increments", &time.increments, "at least 1 and at most 10 million", help)?;
        Ok(Time { end, increments: increments as usize })
    }

    fn support(&self, support: document::Support) -> Result<Support, SceneError> {
        let directions = support.fix.get_ref();
        if directions.is_empty() {
            return self.fail(support.fix.span(), "fix is empty, so the support holds nothing", "use [\"x\", \"y\"]");
        }
        let fix = [Direction::X, Direction::Y, Direction::Z].map(|direction| directions.contains(&direction));
        Ok(Support { boundary: name(support.boundary), fix, span: support.fix.span() })
    }

    fn contacts(&self, contacts: Vec<document::Contact>, time: &Time) -> Result<Vec<Contact>, SceneError> {
        let mut checked: Vec<Contact> = Vec::with_capacity(contacts.len());
        for contact in contacts {
            let boundary = name(contact.boundary);
            if checked.iter().any(|other| other.boundary.text == boundary.text) {
                let message = format!("the boundary `{boundary}` has a [[contact]] already");
                return self.fail(boundary.span(), message, "keep one [[contact]] for each boundary");
            }
            let friction = self.finite("friction", &contact.friction)?;
            let help = "give Coulomb's coefficient, 0 for a frictionless contact";
            self.demand(friction >= 0.0, "friction", &contact.friction, "0 or more", help)?;
            let obstacle = self.obstacle(&contact.obstacle, time)?;
            checked.push(Contact { boundary, friction, obstacle });
        }
        Ok(checked)
    }

    fn load(&self, load: document::Load, time: &Time) -> Result<Load, SceneError> {
        let traction = self.components("traction", &load.traction)?;
        let history = match load.history {
            Some(history) => self.history("history", "factor", &history, time)?,
            None => vec![[0.0, 0.0], [time.end, 1.0]],
        };
        Ok(Load { boundary: name(load.boundary), traction, traction_span: load.traction.span(), history })
    }

    /// The points `[time, value]` of a history, as far as it is within `time`.
    fn history(
        &self,
        name: &str,
        value: &str,
        given: &Spanned<Vec<Tuple<f64>>>,
        time: &Time,
    ) -> Result<Vec<[f64; 2]>, SceneError> {
        let span = given.span();
        let points: Vec<[f64; 2]> = given.get_ref().iter().map(|&Tuple(point)| point).collect();
        if points.is_empty() {
            let help = format!("give points [time, {value}], e.g. [[0, 0], [1, 1]]");
            return self.fail(span, format!("{name} is empty"), &help);
        }
        if let Some(point) = points.iter().find(|point| !point.iter().all(|x| x.is_finite())) {
            return self.fail(span, format!("{name} has the point {point:?}"), "give numbers other than nan or inf");
        }
        if let Some(pair) = points.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
            let message = format!("{name} goes from time {} to {}, but times must increase", pair[0][0], pair[1][0]);
            let help = format!("order the points [time, {value}] by time, each time once");
            return self.fail(span, message, &help);
        }
        Ok(within(time, &points))
    }

    fn output(&self, output: document::Output, time: &Time) -> Result<Output, SceneError> {
        let fields = output.fields;
        let Some(times) = output.times else { return Ok(Output { times: vec![time.end], fields }) };
        if let Some(t) = times.get_ref().iter().find(|&&t| t.is_nan() || t <= 0.0 || t > time.end) {
            let message = format!("output.times holds {t}, but the history runs from 0 to {}", time.end);
            return self.fail(times.span(), message, "give times after 0 and up to time.end, s");
        }
        Ok(Output { times: times.into_inner(), fields })
    }
}

/// The part from 0 to the end of `time` of a history whose points begin with their times, linear between them and constant
/// outside. What is never reached must not count as the largest of anything.
fn within<const N: usize>(time: &Time, points: &[[f64; N]]) -> Vec<[f64; N]> {
    let mut times: Vec<f64> = points.iter().map(|point| point[0].clamp(0.0, time.end)).collect();
    times.dedup();
    let at = |t: f64| {
        let after = points.partition_point(|point| point[0] <= t);
        let mut point = points[after.saturating_sub(1)];
        if let (1.., Some(next)) = (after, points.get(after)) {
            let share = (t - point[0]) / (next[0] - point[0]);
            point = std::array::from_fn(|k| point[k] + share * (next[k] - point[k]));
        }
        point[0] = t;
        point
    };
    times.into_iter().map(at).collect()
}

fn name(text: Spanned<String>) -> Name {
    Name { span: text.span(), text: text.into_inner() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn histories_are_cut_where_the_time_ends() {
        let time = Time { end: 2.0, increments: 1 };
        let whole = [[0.0, 1.0], [0.5, -3.0], [2.0, 4.0]];
        assert_eq!(within(&time, &whole), whole);
        assert_eq!(within(&time, &[[-1.0, 2.0], [1.0, 4.0], [5.0, 8.0]]), [[0.0, 3.0], [1.0, 4.0], [2.0, 5.0]]);
        assert_eq!(within(&time, &[[-3.0, 9.0], [-1.0, 2.0], [3.0, 6.0], [4.0, 9.0]]), [[0.0, 3.0], [2.0, 5.0]]);
        // Constant outside.
        assert_eq!(within(&time, &[[1.0, 7.0]]), [[1.0, 7.0]]);
        assert_eq!(within(&time, &[[3.0, 7.0], [4.0, 9.0]]), [[2.0, 7.0]]);
        assert_eq!(within(&time, &[[-3.0, 9.0], [-2.0, 7.0]]), [[0.0, 7.0]]);
        assert_eq!(within(&time, &[[0.0, 0.0, 1.0], [4.0, 2.0, -1.0]]), [[0.0, 0.0, 1.0], [2.0, 1.0, 0.0]]);
    }
}
