//! A case as the text of a scene: in any units, and as it is or in a mirror.

use std::fmt::Write;

use super::case::{Action, Body, Case, Contact, Motion, Scalar, Shape, Support};

/// The units and the orientation in which a case is written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextOptions {
    /// The names of the units of length and stress, and what they are in m and Pa; SI without.
    pub units: Option<([&'static str; 2], [f64; 2])>,
    /// Whether left and right change places.
    pub mirrored: bool,
}

impl TextOptions {
    /// As it is.
    pub const SI: TextOptions = TextOptions { units: None, mirrored: false };
}

/// The data to write a case.
struct SceneWriter {
    length: f64,
    stress: f64,
    /// The width about whose middle x is mirrored, m.
    mirror: Option<f64>,
    dimension: usize,
}

const AXES: [&str; 3] = ["x", "y", "z"];

impl SceneWriter {
    fn side(&self, name: &str) -> String {
        let swapped = |name: &str| {
            if name.contains("left") { name.replace("left", "right") } else { name.replace("right", "left") }
        };
        if self.mirror.is_some() { swapped(name) } else { name.to_string() }
    }

    fn sign(&self) -> f64 {
        if self.mirror.is_some() { -1.0 } else { 1.0 }
    }

    /// A list of as many values as there are dimensions, of a vector in a unit.
    fn vector(&self, vector: [f64; 3], unit: f64) -> String {
        let components = [self.sign() * vector[0], vector[1], vector[2]].map(|x| x / unit);
        format!("{:?}", &components[..self.dimension])
    }

    fn place(&self, place: [f64; 3]) -> String {
        let x = self.mirror.map_or(place[0], |width| width - place[0]);
        format!("{:?}", &[x, place[1], place[2]].map(|x| x / self.length)[..self.dimension])
    }

    /// A number, or a formula in quotes.
    fn scalar(&self, scalar: Scalar, unit: f64) -> String {
        let Scalar { constant, slope, curve, middle } = scalar;
        if slope == [0.0; 3] && curve == 0.0 {
            return format!("{:?}", constant / unit);
        }
        let (shift, sign) = (self.mirror.unwrap_or(0.0), self.sign());
        let mut text = format!("'{:?}", (constant + slope[0] * shift) / unit);
        for (k, axis) in AXES.into_iter().enumerate().take(self.dimension) {
            let along = if k == 0 { sign * slope[0] } else { slope[k] };
            let slope = along * self.length / unit;
            if slope != 0.0 {
                let _ = write!(text, " + {slope:?} * {axis}");
            }
        }
        if curve != 0.0 {
            let middle = (shift + sign * middle) / self.length;
            let _ = write!(text, " + {:?} * (x - {middle:?})^2", curve * self.length * self.length / unit);
        }
        text + "'"
    }

    fn history(history: &[[f64; 2]], unit: f64) -> String {
        format!("{:?}", history.iter().map(|[t, x]| [*t, x / unit]).collect::<Vec<_>>())
    }

    fn mesh(&self, case: &Case, body: &Body) -> String {
        let [size, grading] = [body.size.map(|x| x / self.length), body.grading];
        let grading = [if self.mirror.is_some() { 1.0 / grading[0] } else { grading[0] }, grading[1], grading[2]];
        let n = self.dimension;
        format!(
            "kind = 'block'\nsize = {:?}\nelements = {:?}\ngrading = {:?}\ncells = '{}'\nelement = '{}'\n",
            &size[..n],
            &body.elements[..n],
            &grading[..n],
            case.cells,
            case.element
        )
    }

    fn material(&self, case: &Case, body: &Body) -> String {
        let density = case.density * self.length * self.length / self.stress;
        let mut text = format!(
            "young = {:?}\npoisson = {:?}\ndensity = {density:?}\nexpansion = {:?}\n",
            body.young / self.stress,
            body.poisson,
            case.expansion
        );
        if !case.plane.is_empty() {
            let _ = writeln!(text, "plane = '{}'", case.plane);
        }
        if !case.layers.is_empty() {
            let layers: Vec<_> = case.layers.iter().map(|[t, e, nu]| [t / self.length, e / self.stress, *nu]).collect();
            let _ = writeln!(text, "layers = {layers:?}");
        }
        text
    }

    fn support(&self, support: &Support) -> String {
        let fix: Vec<&str> = support.fix.iter().map(|&k| AXES[k]).collect();
        let mut text = format!("[[support]]\nboundary = '{}'\nfix = {fix:?}\n", self.side(support.boundary));
        if let Some(displacement) = &support.displacement {
            let components = support.fix.iter().zip(displacement);
            let values: Vec<f64> =
                components.map(|(&k, u)| (if k == 0 { self.sign() } else { 1.0 }) * u / self.length).collect();
            let _ = writeln!(text, "displacement = {values:?}\nhistory = {:?}", support.history);
        }
        text
    }

    fn contact(&self, contact: &Contact) -> String {
        let mut text = format!(
            "[[contact]]\nboundary = '{}'\nfriction = {}\n",
            self.side(contact.boundary),
            self.scalar(contact.friction, 1.0)
        );
        if let Some(history) = &contact.history {
            let _ = writeln!(text, "friction_history = {history:?}");
        }
        let shape = match &contact.shape {
            Shape::Body { boundary } => return text + &format!("against = '{boundary}'\n"),
            Shape::Plane { gap } => format!("kind = 'plane'\ngap = {:?}\n", gap / self.length),
            Shape::Formula { gap } => {
                let gap = self.scalar(*gap, self.length);
                format!("kind = 'formula'\nformula = '{}'\n", gap.trim_matches('\''))
            }
            Shape::Round { kind, radius, apex, axis } => format!(
                "kind = '{kind}'\nradius = {:?}\napex = {}\n{}",
                radius / self.length,
                self.place(*apex),
                self.axis(kind, *axis)
            ),
            Shape::Edge { kind, angle, apex, axis } => {
                let key = if *kind == "cone" { "half_angle" } else { "angle" };
                format!("kind = '{kind}'\n{key} = {angle:?}\napex = {}\n{}", self.place(*apex), self.axis(kind, *axis))
            }
        };
        text += "[contact.obstacle]\n";
        text += &shape;
        if contact.nearest {
            text += "direction = 'nearest'\n";
        }
        text + &self.motion(&contact.motion)
    }

    /// The axis of what has one in space.
    fn axis(&self, kind: &str, axis: usize) -> String {
        let has = self.dimension == 3 && ["cylinder", "bore", "wedge"].contains(&kind);
        if has { format!("axis = {}\n", ["[1, 0, 0]", "[0, 1, 0]"][axis]) } else { String::new() }
    }

    fn motion(&self, motion: &Motion) -> String {
        match motion {
            Motion::None => String::new(),
            Motion::Approach(history) => format!("approach = {}\n", Self::history(history, self.length)),
            Motion::Translation(along, history) => {
                let point = |[t, distance]: &[f64; 2]| {
                    let moved = [self.sign() * along[0], along[1], along[2]].map(|x| x * distance / self.length);
                    [&[*t], &moved[..self.dimension]].concat()
                };
                format!("motion.translation = {:?}\n", history.iter().map(point).collect::<Vec<_>>())
            }
            // A turn about an axis across the mirrored direction is turned round.
            Motion::Rotation(through, history) => {
                let history: Vec<_> = history.iter().map(|[t, angle]| [*t, self.sign() * angle]).collect();
                let axis = if self.dimension == 3 { "axis = [0, 0, 1], " } else { "" };
                format!("motion.rotation = {{ {axis}through = {}, history = {history:?} }}\n", self.place(*through))
            }
        }
    }

    fn action(&self, action: &Action) -> String {
        match action {
            Action::Traction(boundary, traction) => {
                let turned = |k: usize| match (k, traction[k]) {
                    (0, Scalar { constant, slope, curve, middle }) => {
                        let s = self.sign();
                        Scalar { constant: s * constant, slope: slope.map(|x| s * x), curve: s * curve, middle }
                    }
                    (_, scalar) => scalar,
                };
                let components: Vec<String> =
                    (0..self.dimension).map(|k| self.scalar(turned(k), self.stress)).collect();
                format!("boundary = '{}'\ntraction = [{}]\n", self.side(boundary), components.join(", "))
            }
            Action::Pressure(boundary, pressure) => {
                format!("boundary = '{}'\npressure = {}\n", self.side(boundary), self.scalar(*pressure, self.stress))
            }
            Action::Acceleration(acceleration) => {
                format!("acceleration = {}\n", self.vector(*acceleration, self.length))
            }
            Action::Temperature(temperature) => format!("temperature = {}\n", self.scalar(*temperature, 1.0)),
        }
    }
}

impl Case {
    /// The text of the scene.
    pub fn text(&self, options: &TextOptions) -> String {
        let [length, stress] = options.units.map_or([1.0, 1.0], |(_, units)| units);
        let mirror = options.mirrored.then(|| self.width());
        let teller = SceneWriter { length, stress, mirror, dimension: self.dimension };
        let mut text = String::new();
        if let Some(([length, stress], _)) = options.units {
            let _ = writeln!(text, "[units]\nlength = '{length}'\nstress = '{stress}'");
        }
        if let [body] = &self.bodies[..] {
            let _ = write!(text, "[mesh]\n{}[material]\n{}", teller.mesh(self, body), teller.material(self, body));
        } else {
            for body in &self.bodies {
                let mut at = body.at;
                if let Some(width) = mirror {
                    // The corner on the other side.
                    at[0] = width - at[0] - body.size[0];
                }
                let at = &at.map(|x| x / length)[..self.dimension];
                let (mesh, material) = (teller.mesh(self, body), teller.material(self, body));
                let _ = write!(
                    text,
                    "[[body]]\nname = '{}'\nat = {at:?}\n[body.mesh]\n{mesh}[body.material]\n{material}",
                    body.name
                );
            }
        }
        self.supports.iter().for_each(|support| text += &teller.support(support));
        self.contacts.iter().for_each(|contact| text += &teller.contact(contact));
        if let Some((boundary, normal, tangential)) = self.spring {
            let [normal, tangential] = [normal, tangential].map(|k| k * length / stress);
            let boundary = teller.side(boundary);
            let _ =
                write!(text, "[[spring]]\nboundary = '{boundary}'\nnormal = {normal:?}\ntangential = {tangential:?}\n");
        }
        for load in &self.loads {
            let _ = write!(text, "[[load]]\n{}history = {:?}\n", teller.action(&load.action), load.history);
        }
        let _ =
            write!(text, "[time]\nend = {:?}\nincrements = {}\n[solver]\n{}", self.end, self.increments, self.solver);
        text
    }
}
