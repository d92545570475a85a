//! Kinds of elements on problems whose answers are known: how fast the error falls with the unknowns and with time.

use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::sync::Arc;
use stickslip::base::Formula;
use stickslip::body::fem::{Material, Plane};
use stickslip::body::mesh::{CellKind, MeshSource, Segment};
use stickslip::body::{Axis, Description, Load, Model, Support};
use stickslip::body::{Obstacle, Shape};
use stickslip::run::report::cpu_seconds;
use stickslip::run::{Recording, Run};
use stickslip::solver::history::{LinearAlgebra, Method, SolverChoice, Status};
use stickslip_cli::compare::ElementChoice;

/// Why a problem cannot be solved.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// A problem. Young's modulus is 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Problem {
    /// Cook's membrane: the corners (0, 0), (48, 44), (48, 60), (0, 44), clamped on the left, a shear force of 1 on the right.
    Cook,
    /// A parabola `x²/2`, 0.001 deep in the half `0 < x < 1` of a block of height 1 on a rigid base.
    Line,
    /// A paraboloid `r²/2`, 0.0004 deep in a quarter of a block of width 0.8 and height 0.4 on a rigid base.
    Sphere,
    /// The same paraboloid, as a body of revolution of radius and height 1, which is moved at its outside as a half-space is there.
    Revolved,
}

/// A problem on one mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// The elements.
    pub elements: ElementChoice,
    /// How many of them there are along the fine part of the mesh.
    pub n: usize,
    /// Displacements and contact forces that are solved for.
    pub unknowns: usize,
    /// CPU time of mesh, assembly and solution, s.
    pub seconds: f64,
    /// What is asked for: [`Problem::quantity`].
    pub value: f64,
    /// Its distance to [`Problem::exact`], relative to that.
    pub error: f64,
    /// By what share the mesh says that its elements make the body too stiff.
    pub locking: Option<f64>,
    /// What it says of its error in the energy norm.
    pub discretisation: Option<f64>,
}

/// Hertz' force of a paraboloid of radius 1 that is 0.0004 deep in a half-space with ν = 0.3: `4/3 E/(1 - ν²) √(R d³)`.
const HERTZ: f64 = 4.0 / 3.0 / 0.91 * 8e-6;

/// Displacements of a half-space with E = 1 and ν = 0.3 under Hertz' force at a point (Boussinesq), along r and upwards, at the radius
/// `r` and `depth`.
fn boussinesq(r: f64, depth: f64) -> [f64; 2] {
    let (nu, rho) = (0.3, r.hypot(depth));
    let factor = HERTZ * (1.0 + nu) / (2.0 * PI * rho);
    let along_r = r * depth / (rho * rho) - (1.0 - 2.0 * nu) * r / (rho + depth);
    let down = (depth / rho).powi(2) + 2.0 * (1.0 - nu);
    [factor * along_r, -factor * down]
}

/// Width of the fine part of the meshes with a contact.
const FINE: f64 = 0.03;

impl Problem {
    /// All of them.
    pub const ALL: [Problem; 4] = [Problem::Cook, Problem::Line, Problem::Sphere, Problem::Revolved];

    /// What it is called in names of files.
    pub fn name(self) -> &'static str {
        match self {
            Problem::Cook => "cook",
            Problem::Line => "line",
            Problem::Sphere => "sphere",
            Problem::Revolved => "revolved",
        }
    }

    /// What it is.
    pub fn title(self) -> &'static str {
        match self {
            Problem::Cook => "Cook's membrane, nu = 0.4999",
            Problem::Line => "Hertz: a parabolic cylinder on a block, nu = 0.3",
            Problem::Sphere => "Hertz: a paraboloid on a block, nu = 0.3",
            Problem::Revolved => "Hertz: a paraboloid on a half-space, axisymmetric, nu = 0.3",
        }
    }

    /// What is asked for.
    pub fn quantity(self) -> &'static str {
        match self {
            Problem::Cook => "displacement of the middle of the free side",
            Problem::Line | Problem::Sphere | Problem::Revolved => "force",
        }
    }

    /// The answer, from much finer meshes where there is no closed form; see doc/method/verification.md.
    pub fn exact(self) -> f64 {
        match self {
            Problem::Cook => 18.507,
            Problem::Line => 3.77283e-4,
            Problem::Sphere => 1.2227e-5,
            Problem::Revolved => HERTZ,
        }
    }

    /// Poisson's ratio.
    pub fn poisson(self) -> f64 {
        match self {
            Problem::Cook => 0.4999,
            Problem::Line | Problem::Sphere | Problem::Revolved => 0.3,
        }
    }

    /// The elements that are compared, as `compare --elements` has them.
    pub fn elements(self) -> Vec<ElementChoice> {
        let names: &[&str] = match self {
            Problem::Cook => &[
                "triangle",
                "triangle:nodal-volume",
                "triangle6",
                "triangle6:nodal-volume",
                "quadrilateral",
                "quadrilateral:b-bar",
            ],
            Problem::Line | Problem::Revolved => &["triangle", "triangle6", "quadrilateral", "quadrilateral:b-bar"],
            Problem::Sphere => {
                &["tetrahedron", "tetrahedron10", "prism", "prism:b-bar", "hexahedron", "hexahedron:b-bar"]
            }
        };
        names.iter().filter_map(|name| name.parse().ok()).collect()
    }

    /// The elements along the fine part of the meshes with so many displacements, from coarse to fine: half as many of second order.
    pub fn sizes(self, elements: ElementChoice) -> Vec<usize> {
        let sizes: &[usize] = match self {
            Problem::Cook => &[4, 8, 16, 32, 64],
            Problem::Line | Problem::Revolved => &[8, 16, 32, 64],
            Problem::Sphere => &[4, 6, 8, 12],
        };
        let order = if elements.cells.is_some_and(CellKind::is_quadratic) { 2 } else { 1 };
        sizes.iter().map(|n| n / order).collect()
    }

    /// The problem with `n` elements of a kind along the fine part of the mesh.
    ///
    /// # Errors
    /// When the mesh is none, or the linear algebra cannot go on.
    pub fn solve(self, elements: ElementChoice, n: usize) -> Result<Point, Failure> {
        let start = cpu_seconds();
        let model = Model::build(&self.description(elements, n)?)?;
        let solver = SolverChoice { linear: Some(LinearAlgebra::condensed()), ..SolverChoice::new(Method::BN) };
        let mut end = Recording::last();
        let run = Run::of(&model, vec![1.0], solver)?;
        let report = run.solve(&mut end)?;
        let seconds = cpu_seconds() - start;
        let value = match end.increments.last() {
            Some(end) if end.record.status == Status::Converged => self.value(&model, &end.state.u, &end.state.p_n)?,
            _ => f64::NAN,
        };
        Ok(Point {
            elements,
            n,
            unknowns: report.unknowns.u + report.unknowns.p_n,
            seconds,
            value,
            error: (value / self.exact() - 1.0).abs(),
            locking: report.estimates.locking,
            discretisation: report.estimates.discretisation,
        })
    }

    /// What is asked for, of these displacements of the free directions and contact forces.
    fn value(self, model: &Model, u: &[f64], p_n: &[f64]) -> Result<f64, Failure> {
        match self {
            Problem::Cook => {
                let middle = [48.0, 52.0];
                let distance = |x: &[f64; 3]| (x[0] - middle[0]).hypot(x[1] - middle[1]);
                let nodes = model.mesh.nodes.iter().map(distance).enumerate();
                let node = nodes.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(node, _)| node);
                Ok(model.displacements(1.0, u)?[node][1])
            }
            Problem::Line => Ok(2.0 * p_n.iter().sum::<f64>()),
            Problem::Sphere => Ok(4.0 * p_n.iter().sum::<f64>()),
            Problem::Revolved => Ok(p_n.iter().sum()),
        }
    }

    fn description(self, elements: ElementChoice, n: usize) -> Result<Description, Failure> {
        let material = Material::new(1.0, self.poisson());
        let of = |mesh: MeshSource| Description::new(mesh, material.clone(), vec![1.0]).element(elements.element);
        let block = |axes: Vec<Vec<Segment>>| match elements.cells {
            Some(cells) => MeshSource::Block { axes, cells, origin: None },
            None => MeshSource::block([1.0; 2], [n; 2]),
        };
        Ok(match self {
            Problem::Cook => {
                let side = || vec![Segment { length: 1.0, elements: n, grading: 1.0 }];
                let mut mesh = (*block(vec![side(), side()]).build()?).clone();
                for x in &mut mesh.nodes {
                    let [s, t, _] = *x;
                    *x = [48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s), 0.0];
                }
                of(mesh.into()).support("left", &[Axis::X, Axis::Y]).load(Load::new("right", &[0.0, 1.0 / 16.0]))
            }
            Problem::Line => of(block(vec![graded(1.0, n, false), graded(1.0, n, true)]))
                .support("bottom", &[Axis::X, Axis::Y])
                .support("left", &[Axis::X])
                .contact("top", 0.0, gap("0.5 * x^2 - 0.001")?),
            Problem::Sphere => of(block(vec![graded(0.4, n, false), graded(0.4, n, false), graded(0.4, n, true)]))
                .support("bottom", &[Axis::X, Axis::Y, Axis::Z])
                .support("left", &[Axis::X])
                .support("front", &[Axis::Y])
                .contact("top", 0.0, gap("0.5 * (x^2 + y^2) - 0.0004")?),
            Problem::Revolved => {
                let mesh = block(vec![graded(1.0, n, false), graded(1.0, n, true)]).build()?;
                let outside = ["right", "bottom"].into_iter().filter_map(|name| mesh.boundary(name));
                let nodes: BTreeSet<usize> = outside.flat_map(|boundary| boundary.facets.concat()).collect();
                let supported = nodes.into_iter().map(|node| {
                    let [r, y, _] = mesh.nodes[node];
                    Support::new("", &[Axis::X, Axis::Y]).at([r, y]).moved(&boussinesq(r, 1.0 - y))
                });
                let supports = supported.collect();
                let description = of(MeshSource::Given(Arc::clone(&mesh)));
                let material = description.material.clone().in_plane(Plane::Axisymmetric);
                Description { supports, material, ..description }.contact("top", 0.0, gap("0.5 * x^2 - 0.0004")?)
            }
        })
    }
}

/// An axis with `n` equal elements on the fine part at its beginning, or its end, and as many in geometric progression on the rest of
/// its `length`, the first of which is longer than the fine ones by the ratio of the progression.
fn graded(length: f64, n: usize, fine_at_the_end: bool) -> Vec<Segment> {
    let (fine, rest) = (FINE / n as f64, length - FINE);
    let extent = |ratio: f64| (1..=n as i32).map(|k| fine * ratio.powi(k)).sum::<f64>();
    let (mut low, mut high) = (1.0, 1e6_f64);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if extent(middle) < rest { low = middle } else { high = middle }
    }
    let grading = low.powi(n as i32 - 1);
    let equal = Segment { length: FINE, elements: n, grading: 1.0 };
    let growing = |grading| Segment { length: rest, elements: n, grading };
    if fine_at_the_end { vec![growing(1.0 / grading), equal] } else { vec![equal, growing(grading)] }
}

/// An obstacle of which a formula gives the gap (m).
fn gap(formula: &str) -> Result<Obstacle, Failure> {
    Ok(Obstacle::at_rest(Shape::Formula(Formula::parse(formula)?)))
}
