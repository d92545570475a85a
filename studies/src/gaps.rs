//! Gaps of curved bodies on meshes that do not match: forces and pressures beside closed forms, or beside a fine mesh of second order
//! whose nodes meet.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use stickslip::body::fem::{Material, Plane};
use stickslip::body::mesh::{Body, Mesh, MeshSource, block};
use stickslip::body::{Axis, Description, Load, Model, Opposite, Slave, Support};
use stickslip::run::Run;
use stickslip::run::report::{RunReport, WarningKind};
use stickslip::solver::history::{Method, SolverChoice, Status};

/// Why a case cannot be solved.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Two bodies in contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// A quarter of a ring, drawn larger than the ring around it.
    Rings,
    /// A hollow ball in another, drawn larger, as a section.
    Balls,
    /// An eighth of such balls in space: what a quarter of the side of a cube sees.
    Space,
    /// Half of a pin that is pressed into a hole, with a clearance.
    Pin,
    /// A ball in a socket with a clearance, as a section.
    Socket,
    /// A flat that ends in roundings, on a flat.
    Flat,
    /// A roller with a worn flat, which ends at edges, on a flat.
    Worn,
    /// A crowned strip on a flat.
    Crown,
    /// Two crowned strips.
    Crowns,
}

/// Inner radius, radius of the contact, outer radius, m.
const RADII: [f64; 3] = [0.05, 0.1, 0.2];
const YOUNG: f64 = 210e9;
const NU: f64 = 0.3;
const INTERFERENCE: f64 = 1e-5;
const CLEARANCE: f64 = 2e-5;
/// Pressure in the pin, Pa.
const PRESSURE: f64 = 2e7;
/// Half of the width of a flat, the radius of its roundings, and that of a worn roller, m.
const HALF: f64 = 0.25;
const ROUNDING: f64 = 1.0;
const ROLLER: f64 = 1.25;
/// The radius of a crown, m.
const CROWN: f64 = 20.0;
/// The approach of strips, m: the contact is half as wide as they are.
const APPROACH: f64 = 4e-3;
/// Elements of the reference.
const FINE: usize = 96;

/// A case: elements along the contact of the first and of the second body, which is the slave, and cells of the second order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// The bodies.
    pub shape: Shape,
    /// The elements along the contact of both bodies.
    pub elements: [usize; 2],
    /// The body that is the slave.
    pub slave: usize,
    /// Cells of the second order, with nodes on the surface.
    pub second_order: bool,
}

/// A force and a pressure, N and Pa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// The sum of the normal forces.
    pub force: f64,
    /// The largest pressure.
    pub peak: f64,
}

/// The statements of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Statements {
    /// Its force and its pressure.
    pub found: Found,
    /// The error of the mesh of the peak, as a share.
    pub peak: Option<f64>,
    /// Kinds of its warnings.
    pub kinds: Vec<WarningKind>,
    /// The body that `slave = "automatic"` would choose.
    pub automatic: usize,
}

impl Shape {
    /// All of them.
    pub const ALL: [Shape; 9] = [
        Shape::Rings,
        Shape::Balls,
        Shape::Space,
        Shape::Pin,
        Shape::Socket,
        Shape::Flat,
        Shape::Worn,
        Shape::Crown,
        Shape::Crowns,
    ];

    /// Elements of both bodies in the ratios 1 : 1, 1 : 2, 2 : 3, 3 : 4 and 1 : 3.
    pub fn elements(self) -> Vec<[usize; 2]> {
        let unit = match self {
            Shape::Space => 1,
            Shape::Pin | Shape::Socket => 4,
            _ => 2,
        };
        let pairs: [[usize; 2]; 5] = [[6, 6], [6, 12], [6, 9], [6, 8], [4, 12]];
        let pairs = if self == Shape::Space { [[4, 4], [3, 6], [4, 6], [3, 4], [2, 6]] } else { pairs };
        let each = pairs.into_iter().flat_map(|[a, b]| if a == b { vec![[a, b]] } else { vec![[a, b], [b, a]] });
        each.map(|pair| pair.map(|n| unit * n)).collect()
    }

    /// The force and the pressure of the bodies themselves.
    ///
    /// # Errors
    /// When the reference cannot be solved.
    pub fn exact(self) -> Result<Found, Failure> {
        let r = RADII[1];
        let [a, c, b] = RADII.map(|x| if self == Shape::Rings { x * x } else { x * x * x });
        let (stiff, area) = match self {
            Shape::Rings => ((b + c) / (b - c) + (c + a) / (c - a), FRAC_PI_2 * r),
            Shape::Balls | Shape::Space => {
                let outer = ((1.0 - 2.0 * NU) * c + 0.5 * (1.0 + NU) * b) / (b - c);
                let inner = ((1.0 - 2.0 * NU) * c + 0.5 * (1.0 + NU) * a) / (c - a);
                // A quarter of the side of a cube, or the half above the equator, all around.
                (outer + inner, if self == Shape::Space { 4.0 * PI / 24.0 } else { 2.0 * PI } * r * r)
            }
            _ => {
                let fine = Case { shape: self, elements: [FINE; 2], slave: 0, second_order: true };
                return Ok(fine.run()?.found);
            }
        };
        let peak = YOUNG * INTERFERENCE / (r * stiff);
        Ok(Found { force: peak * area, peak })
    }

    fn is_round(self) -> bool {
        !matches!(self, Shape::Flat | Shape::Worn | Shape::Crown | Shape::Crowns)
    }
}

impl Case {
    fn mesh_of(&self, body: usize) -> Mesh {
        let Case { shape, second_order, .. } = *self;
        let n = self.elements[body];
        let across = (n / 2).max(3);
        let grid = match shape {
            Shape::Space => block(&[1.0; 3], &[across, n, n]),
            _ if shape.is_round() => block(&[1.0; 2], &[across, n]),
            _ => block(&[1.0, 0.5], &[n, across]),
        };
        let mut mesh = if second_order { grid.into_simplices().into_second_order() } else { grid };
        mesh.nodes.iter_mut().for_each(|x| *x = self.place(body, *x));
        mesh
    }

    fn place(&self, body: usize, [s, t, v]: [f64; 3]) -> [f64; 3] {
        let drawn = if matches!(self.shape, Shape::Pin | Shape::Socket) { -CLEARANCE } else { INTERFERENCE };
        let [from, to] = [[RADII[0], RADII[1] + drawn], [RADII[1], RADII[2]]][body];
        let r = from + s * (to - from);
        let around = |angle: f64, down: f64| {
            let is_end = (angle.abs() - FRAC_PI_2).abs() < 1e-9;
            [if is_end { 0.0 } else { r * angle.cos() }, r * angle.sin() - down, 0.0]
        };
        let sag = |x: f64, radius: f64| x * x / (radius + (radius * radius - x * x).sqrt());
        let sag = match self.shape {
            Shape::Rings | Shape::Balls => return around(FRAC_PI_2 * t, 0.0),
            Shape::Pin | Shape::Socket => return around(PI * (t - 0.5), if body == 0 { CLEARANCE } else { 0.0 }),
            Shape::Space => {
                let [a, b] = [t, v].map(|t| if t == 1.0 { 1.0 } else { (FRAC_PI_4 * t).tan() });
                let size = r / (1.0 + a * a + b * b).sqrt();
                return [size, size * a, size * b];
            }
            Shape::Flat => sag((s - HALF).max(0.0), ROUNDING),
            Shape::Worn => (sag(s, ROLLER) - sag(HALF, ROLLER)).max(0.0),
            Shape::Crown | Shape::Crowns => sag(s, CROWN),
        };
        match body {
            0 if self.shape == Shape::Crowns => [s, t - 0.5 - 2.0 * sag * t, 0.0],
            0 => [s, t - 0.5, 0.0],
            _ => [s, t + sag * (1.0 - 2.0 * t), 0.0],
        }
    }

    /// The two bodies, with gaps that are measured.
    pub fn description(&self, slave: Slave) -> Description {
        let mesh = MeshSource::Bodies(
            ["first", "second"].iter().enumerate().map(|(k, name)| Body::new(name, self.mesh_of(k))).collect(),
        );
        let material = Material::new(YOUNG, NU);
        let material = match self.shape {
            Shape::Rings => material.in_plane(Plane::Stress),
            Shape::Balls | Shape::Socket => material.in_plane(Plane::Axisymmetric),
            _ => material,
        };
        let sides = if self.shape.is_round() { ["first:right", "second:left"] } else { ["first:top", "second:bottom"] };
        let against = Opposite { slave, ..Opposite::from(sides[1 - self.slave]).within(0.02) };
        let body = Description::new(mesh, material, vec![1.0]).pair(sides[self.slave], 0.0, against);
        if matches!(self.shape, Shape::Pin | Shape::Socket) {
            let both = ["first", "second"];
            let ends = both.iter().flat_map(|name| ["bottom", "top"].map(|end| format!("{name}:{end}")));
            let supported = ends.fold(body, |body, end| body.support(&end, &[Axis::X]));
            return supported
                .support("second:right", &[Axis::X, Axis::Y])
                .load(Load::new("first:left", &[0.0, -PRESSURE]));
        }
        let body = ["first", "second"].iter().fold(body, |body, name| {
            let at = |side: &str| format!("{name}:{side}");
            match self.shape {
                Shape::Rings => body.support(&at("bottom"), &[Axis::Y]).support(&at("top"), &[Axis::X]),
                Shape::Balls => body.support(&at("bottom"), &[Axis::Y]),
                Shape::Space => body
                    .support(&at("front"), &[Axis::Y])
                    .support(&at("bottom"), &[Axis::Z])
                    .with_support(Support::normal(&at("back")))
                    .with_support(Support::normal(&at("top"))),
                _ => body.support(&at("left"), &[Axis::X]),
            }
        });
        if self.shape.is_round() {
            return body;
        }
        let down = Support::new("second:top", &[Axis::Y]).moved(&[-APPROACH]);
        body.support("first:bottom", &[Axis::Y]).with_support(down)
    }

    /// Solves the case.
    ///
    /// # Errors
    /// When its model cannot be built, or does not converge.
    pub fn run(&self) -> Result<Statements, Failure> {
        let model = Model::build(&self.description(Slave::First))?;
        let report: RunReport =
            Run::of(&model, model.times().to_vec(), SolverChoice::new(Method::BN))?.solve(&mut ())?;
        if report.status != Status::Converged {
            return Err(format!("{self:?}: {}", report.status).into());
        }
        let peak = report.largest_pressure.as_ref().and_then(|largest| Some((largest.pressure?, largest.mesh_error)));
        let (peak, error) = peak.ok_or("no pressure")?;
        let force = report.forces.last().ok_or("no force")?.resultant.sums.sum_p_n;
        let mut kinds: Vec<WarningKind> = report.warnings.iter().map(|warning| warning.kind).collect();
        kinds.dedup();
        let automatic = Model::build(&self.description(Slave::Automatic))?;
        let choice = automatic.contact.pairs[0].choice.map_or(0, |choice| choice.slave);
        let automatic = if choice == 0 { self.slave } else { 1 - self.slave };
        Ok(Statements { found: Found { force, peak }, peak: error, kinds, automatic })
    }
}
