//! From the file as it stands to a scene that can be solved.

use std::ops::Range;

use toml::Spanned;

use super::document::{self, Direction, Document, Pair};
use super::error::Source;
use super::{Contact, Load, Material, Mesh, Name, Obstacle, Output, Scene, SceneError, Solver, Support, Time};

/// Beyond this a mesh is a slip of the pen, not a model: no matrix of it would fit into memory.
const MOST_ELEMENTS: i64 = 50_000_000;

/// Checks every value of `document`, which was read from `source`.
pub(super) fn scene(document: Document, source: Source) -> Result<Scene, SceneError> {
    let check = Check { source: &source };
    let time = check.time(&document.time)?;
    let mesh = check.mesh(&document.mesh)?;
    let material = check.material(&document.material)?;
    let supports = document.support.into_iter().map(|support| check.support(support)).collect::<Result<_, _>>()?;
    let contacts = check.contacts(document.contact)?;
    let loads = document.load.into_iter().map(|load| check.load(load, &time)).collect::<Result<_, _>>()?;
    let solver = check.solver(&document.solver)?;
    let output = check.output(document.output, &time)?;
    let title = document.title.unwrap_or_else(|| source.name.clone());
    Ok(Scene { title, mesh, material, supports, contacts, loads, time, solver, output, source })
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

    fn finite_pair(&self, name: &str, value: &Spanned<Pair<f64>>) -> Result<[f64; 2], SceneError> {
        let Pair(pair) = *value.get_ref();
        let sound = pair.iter().all(|x| x.is_finite());
        self.demand(sound, name, value, "two finite numbers", "give numbers other than nan or inf")?;
        Ok(pair)
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

    fn mesh(&self, mesh: &document::Mesh) -> Result<Mesh, SceneError> {
        let document::MeshKind::Block = mesh.kind;
        let size = self.finite_pair("mesh.size", &mesh.size)?;
        let sound = size.iter().all(|&x| x > 0.0);
        self.demand(sound, "mesh.size", &mesh.size, "two positive lengths", "give width and height in m")?;
        let Pair([nx, ny]) = *mesh.elements.get_ref();
        let help = "give the numbers of elements along x and y";
        self.demand(nx > 0 && ny > 0, "mesh.elements", &mesh.elements, "two numbers of at least 1", help)?;
        let few = nx.checked_mul(ny).is_some_and(|n| n <= MOST_ELEMENTS);
        self.demand(few, "mesh.elements", &mesh.elements, "at most 50 million in all", "use a coarser mesh")?;
        Ok(Mesh::Block { size, elements: [nx as usize, ny as usize] })
    }

    fn material(&self, material: &document::Material) -> Result<Material, SceneError> {
        let young = self.finite("material.young", &material.young)?;
        self.demand(young > 0.0, "material.young", &material.young, "positive", "give Young's modulus in Pa")?;
        let poisson = self.finite("material.poisson", &material.poisson)?;
        let help = "an incompressible material cannot be computed with displacements alone; use e.g. 0.49";
        let sound = poisson > -1.0 && poisson < 0.5;
        self.demand(sound, "material.poisson", &material.poisson, "above -1 and below 0.5", help)?;
        Ok(Material { young, poisson, plane: material.plane })
    }

    fn support(&self, support: document::Support) -> Result<Support, SceneError> {
        let directions = support.fix.get_ref();
        if directions.is_empty() {
            return self.fail(support.fix.span(), "fix is empty, so the support holds nothing", "use [\"x\", \"y\"]");
        }
        let fix = [Direction::X, Direction::Y].map(|direction| directions.contains(&direction));
        Ok(Support { boundary: name(support.boundary), fix })
    }

    fn contacts(&self, contacts: Vec<document::Contact>) -> Result<Vec<Contact>, SceneError> {
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
            let obstacle = self.obstacle(&contact.obstacle)?;
            checked.push(Contact { boundary, friction, obstacle });
        }
        Ok(checked)
    }

    fn obstacle(&self, obstacle: &document::Obstacle) -> Result<Obstacle, SceneError> {
        let document::ObstacleKind::Plane = obstacle.kind;
        let gap = obstacle.gap.as_ref().map_or(Ok(0.0), |gap| self.finite("gap", gap))?;
        let normal = obstacle.normal.as_ref().map(|normal| self.direction("normal", normal)).transpose()?;
        let tangent = obstacle.tangent.as_ref().map(|tangent| self.direction("tangent", tangent)).transpose()?;
        if let (Some(given), Some(t)) = (&obstacle.tangent, tangent) {
            let help = "give both, at right angles, or leave the tangent out";
            let sound = normal.is_some_and(|n| (n[0] * t[0] + n[1] * t[1]).abs() <= 1e-9);
            self.demand(sound, "tangent", given, "at right angles to a given normal", help)?;
        }
        Ok(Obstacle::Plane { gap, normal, tangent })
    }

    /// A direction of any length, as a unit vector.
    fn direction(&self, name: &str, value: &Spanned<Pair<f64>>) -> Result<[f64; 2], SceneError> {
        let [x, y] = self.finite_pair(name, value)?;
        let length = x.hypot(y);
        self.demand(length > 0.0, name, value, "a vector with a direction", "give e.g. [0, -1]")?;
        Ok([x / length, y / length])
    }

    fn load(&self, load: document::Load, time: &Time) -> Result<Load, SceneError> {
        let traction = self.finite_pair("traction", &load.traction)?;
        let Some(history) = load.history else {
            let ramp = vec![[0.0, 0.0], [time.end, 1.0]];
            return Ok(Load { boundary: name(load.boundary), traction, history: ramp });
        };
        let span = history.span();
        let history: Vec<[f64; 2]> = history.into_inner().into_iter().map(|Pair(point)| point).collect();
        if history.is_empty() {
            return self.fail(span, "history is empty", "give points [time, factor], e.g. [[0, 0], [1, 1]]");
        }
        if let Some(point) = history.iter().find(|point| !point.iter().all(|x| x.is_finite())) {
            return self.fail(span, format!("history has the point {point:?}"), "give numbers other than nan or inf");
        }
        if let Some(pair) = history.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
            let message = format!("history goes from time {} to {}, but times must increase", pair[0][0], pair[1][0]);
            return self.fail(span, message, "order the points [time, factor] by time, each time once");
        }
        Ok(Load { boundary: name(load.boundary), traction, history })
    }

    fn solver(&self, solver: &document::Solver) -> Result<Solver, SceneError> {
        let (mut max_iterations, mut tolerance) = (200, 1e-10);
        if let Some(given) = &solver.max_iterations {
            let help = "an increment that needs more iterations has not converged";
            let sound = (1..=1_000_000).contains(given.get_ref());
            self.demand(sound, "solver.max_iterations", given, "at least 1 and at most a million", help)?;
            max_iterations = *given.get_ref() as usize;
        }
        if let Some(given) = &solver.tolerance {
            tolerance = self.finite("solver.tolerance", given)?;
            let help = "the relative error that every law may have, e.g. 1e-10";
            let sound = tolerance > 0.0 && tolerance < 1.0;
            self.demand(sound, "solver.tolerance", given, "above 0 and below 1", help)?;
        }
        let document::Solver { method, setting, linear, .. } = *solver;
        Ok(Solver { method, setting, linear, max_iterations, tolerance })
    }

    fn output(&self, output: document::Output, time: &Time) -> Result<Output, SceneError> {
        let Some(times) = output.times else { return Ok(Output { times: vec![time.end] }) };
        if let Some(t) = times.get_ref().iter().find(|&&t| t.is_nan() || t <= 0.0 || t > time.end) {
            let message = format!("output.times holds {t}, but the history runs from 0 to {}", time.end);
            return self.fail(times.span(), message, "give times after 0 and up to time.end, s");
        }
        Ok(Output { times: times.into_inner() })
    }
}

fn name(text: Spanned<String>) -> Name {
    Name { span: text.span(), text: text.into_inner() }
}
