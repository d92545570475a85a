//! Conversion of the numbers of a description from the units of an input to SI; this module assigns a kind of quantity
//! to each number.

use std::sync::Arc;

use super::{
    Action, Against, Bed, Contact, Coupling, Description, Direction, Field, FirstGap, Held, Load, Opposite, Pretension,
    Probe, ProbePlace, Support, Tightening, Where,
};
use crate::algebra::vector::Vector;
use crate::base::formula::{Formula, FormulaUnits};
use crate::base::units::{Depth, Quantity, UnitSystem, Units};
use crate::body::contact::{Friction, Obstacle, Place, Rotation, Shape};
use crate::body::fem::{Layer, Material, MaterialGroup};
use crate::body::mesh::{Body, HalfPlane, Mesh, MeshSource, Segment};

impl Description {
    /// Converts a description whose numbers, including those of its mesh and files, are in `units` to SI. Results are
    /// reported in `units`.
    ///
    /// ```
    /// use stickslip::body::Description;
    /// use stickslip::body::fem::Material;
    /// use stickslip::body::mesh::MeshSource;
    /// use stickslip::base::{LengthUnit, StressUnit, Units};
    ///
    /// let plate = Description::new(MeshSource::block([200.0, 50.0], [20, 5]), Material::new(210e3, 0.3), vec![1.0]);
    /// let plate = plate.given_in(Units::new(LengthUnit::Millimetre, StressUnit::Megapascal));
    /// assert_eq!((plate.mesh, plate.material.young), (MeshSource::block([0.2, 0.05], [20, 5]), 210e9));
    /// ```
    #[must_use]
    pub fn given_in(self, units: Units) -> Self {
        if units == Units::SI && self.material.thickness.is_none() {
            return Description { units, ..self };
        }
        let Description {
            mesh,
            element,
            material,
            couplings,
            supports,
            contacts,
            pretensions,
            springs,
            loads,
            times,
            units: _,
        } = self;
        let material = Si { units, depth: Depth::Whole }.material(material);
        let si = Si { units, depth: material.depth(2) };
        Description {
            mesh: si.mesh(mesh),
            element,
            material,
            couplings: couplings.into_iter().map(|coupling| si.coupling(coupling)).collect(),
            supports: supports.into_iter().map(|support| si.support(support)).collect(),
            contacts: contacts.into_iter().map(|contact| si.contact(contact)).collect(),
            pretensions: pretensions.into_iter().map(|pretension| si.pretension(pretension)).collect(),
            springs: springs.into_iter().map(|spring| si.spring(spring)).collect(),
            loads: loads
                .into_iter()
                .map(|Load { action, history }| Load { action: si.action(action), history })
                .collect(),
            times,
            units,
        }
    }
}

impl Probe {
    /// Converts a probe with coordinates in `units` to SI.
    #[must_use]
    pub fn given_in(self, units: Units) -> Self {
        let si = Si { units, depth: Depth::Whole };
        let Probe { name, place } = self;
        let place = match place {
            ProbePlace::Point(point) => ProbePlace::Point(si.point(point)),
            ProbePlace::Line { from, to, count } => ProbePlace::Line { from: si.point(from), to: si.point(to), count },
        };
        Probe { name, place }
    }
}

/// Converts to SI from these units. Patterns here do not use `..`, so that the compiler demands a quantity for each new
/// field.
#[derive(Clone, Copy)]
struct Si {
    units: Units,
    /// The depth of a plane body.
    depth: Depth,
}

impl Si {
    /// Converts a quantity with the same unit in two and three dimensions.
    fn of(self, quantity: Quantity, x: f64) -> f64 {
        self.in_dimension(3, quantity, x)
    }

    fn in_dimension(self, dimension: usize, quantity: Quantity, x: f64) -> f64 {
        let depth = if dimension == 2 { self.depth } else { Depth::Whole };
        UnitSystem { units: self.units, dimension, depth }.to_si(quantity, x)
    }

    fn length(self, x: f64) -> f64 {
        self.of(Quantity::Length, x)
    }

    fn point(self, x: Vector) -> Vector {
        x.map(|c| self.length(c))
    }

    /// Converts components, one for each dimension of the body; other numbers of components are errors of the model.
    fn components(self, quantity: Quantity, x: Vec<f64>) -> Vec<f64> {
        let dimension = x.len();
        x.into_iter().map(|c| self.in_dimension(dimension, quantity, c)).collect()
    }

    fn formula(self, quantity: Quantity, formula: Formula) -> Formula {
        formula.written_in(FormulaUnits { length: self.length(1.0), value: self.of(quantity, 1.0) })
    }

    fn field(self, quantity: Quantity, field: Field) -> Field {
        match field {
            Field::Uniform(value) => Field::Uniform(self.of(quantity, value)),
            Field::Formula(formula) => Field::Formula(self.formula(quantity, formula)),
        }
    }

    fn mesh(self, mesh: MeshSource) -> MeshSource {
        match mesh {
            MeshSource::Block { axes, cells, origin } => {
                let segment =
                    |Segment { length, elements, grading }| Segment { length: self.length(length), elements, grading };
                let axes = axes.into_iter().map(|axis| axis.into_iter().map(segment).collect()).collect();
                MeshSource::Block { axes, cells, origin: origin.map(|x| self.point(x)) }
            }
            MeshSource::HalfPlane(HalfPlane { size, contact_width, contact_elements, outer_elements, layers }) => {
                MeshSource::HalfPlane(HalfPlane {
                    size: size.map(|x| self.length(x)),
                    contact_width: self.length(contact_width),
                    contact_elements,
                    outer_elements,
                    layers,
                })
            }
            MeshSource::File { format, file, scale } => MeshSource::File { format, file, scale: self.length(scale) },
            MeshSource::Given(mesh) => {
                let nodes = mesh.nodes.iter().map(|x| x.map(|c| self.length(c))).collect();
                MeshSource::Given(Arc::new(Mesh { nodes, ..Arc::unwrap_or_clone(mesh) }))
            }
            MeshSource::Bodies(bodies) => {
                let body =
                    |Body { name, mesh, at }| Body { name, mesh: self.mesh(mesh), at: at.map(|at| self.point(at)) };
                MeshSource::Bodies(bodies.into_iter().map(body).collect())
            }
        }
    }

    fn material(self, material: Material) -> Material {
        let Material { young, poisson, plane, thickness, density, expansion, layers, groups } = material;
        let stress = |x| self.of(Quantity::Stress, x);
        let mass = |density: Option<f64>| density.map(|x| self.of(Quantity::Density, x));
        let layer = |Layer { thickness, young, poisson }| Layer {
            thickness: self.length(thickness),
            young: stress(young),
            poisson,
        };
        let group = |MaterialGroup { name, young, poisson, density, expansion }| MaterialGroup {
            name,
            young: stress(young),
            poisson,
            density: mass(density),
            expansion,
        };
        Material {
            young: stress(young),
            poisson,
            plane,
            thickness: thickness.map(|x| self.length(x)),
            density: mass(density),
            expansion,
            layers: layers.into_iter().map(layer).collect(),
            groups: groups.into_iter().map(group).collect(),
        }
    }

    fn place(self, at: Where) -> Where {
        match at {
            Where::Boundary(_) | Where::Coupling(_) => at,
            Where::Point(point) => Where::Point(self.point(point)),
        }
    }

    fn coupling(self, Coupling { name, part, point, kind }: Coupling) -> Coupling {
        Coupling { name, part, point: point.map(|point| self.point(point)), kind }
    }

    fn support(self, Support { at, held, history }: Support) -> Support {
        let held = held.into_iter().map(|Held { direction, displacement }| match direction {
            Direction::Rotation(_) => Held { direction, displacement },
            _ => Held { direction, displacement: self.length(displacement) },
        });
        Support { at: self.place(at), held: held.collect(), history }
    }

    /// Converts moments about z, of a plane body, or about x, y and z.
    fn moments(self, x: Vec<f64>) -> Vec<f64> {
        let dimension = if x.len() == 1 { 2 } else { 3 };
        x.into_iter().map(|c| self.in_dimension(dimension, Quantity::Moment, c)).collect()
    }

    fn spring(self, spring: Bed) -> Bed {
        match spring {
            Bed::Axes { at, stiffness } => {
                let quantity = match at {
                    Where::Boundary(_) => Quantity::Foundation,
                    Where::Point(_) | Where::Coupling(_) => Quantity::Spring,
                };
                Bed::Axes { at: self.place(at), stiffness: self.components(quantity, stiffness) }
            }
            Bed::Rotational { coupling, rotational } => {
                Bed::Rotational { coupling, rotational: self.moments(rotational) }
            }
            Bed::Surface { boundary, normal, tangential } => {
                let [normal, tangential] = [normal, tangential].map(|x| self.of(Quantity::Foundation, x));
                Bed::Surface { boundary, normal, tangential }
            }
        }
    }

    fn contact(self, contact: Contact) -> Contact {
        let Contact { boundary, friction, friction_history, against } = contact;
        let friction = match friction {
            Friction::Uniform(coefficient) => Friction::Uniform(coefficient),
            Friction::Formula(formula) => Friction::Formula(self.formula(Quantity::Number, formula)),
        };
        let against = match against {
            Against::Obstacles(all) => {
                Against::Obstacles(all.into_iter().map(|obstacle| self.obstacle(obstacle)).collect())
            }
            Against::Boundary(opposite) => Against::Boundary(self.opposite(opposite)),
        };
        Contact { boundary, friction, friction_history, against }
    }

    fn pretension(self, pretension: Pretension) -> Pretension {
        let Pretension { name, boundary, tightening, history, lock } = pretension;
        let tightening = match tightening {
            Tightening::Force { space, plane } => Tightening::Force {
                space: self.of(Quantity::Force, space),
                plane: self.in_dimension(2, Quantity::Force, plane),
            },
            Tightening::Shortening(shortening) => Tightening::Shortening(self.length(shortening)),
        };
        Pretension { name, boundary, tightening, history, lock }
    }

    fn opposite(self, opposite: Opposite) -> Opposite {
        let Opposite { boundaries, glued, shift, search, gap, adjust, direction, slave } = opposite;
        let gap = match gap {
            FirstGap::Measured => FirstGap::Measured,
            FirstGap::Uniform(gap) => FirstGap::Uniform(self.length(gap)),
            FirstGap::Formula(formula) => FirstGap::Formula(self.formula(Quantity::Length, formula)),
        };
        let search = search.map(|x| self.length(x));
        let shift = shift.map(|shift| self.point(shift));
        Opposite { boundaries, glued, shift, search, gap, adjust: self.length(adjust), direction, slave }
    }

    fn obstacle(self, obstacle: Obstacle) -> Obstacle {
        let Obstacle { shape, normal, tangent, direction, approach, translation, rotation } = obstacle;
        let distance = |[time, distance]: [f64; 2]| [time, self.length(distance)];
        let place = |(time, to)| (time, self.point(to));
        Obstacle {
            shape: self.shape(shape),
            normal,
            tangent,
            direction,
            approach: approach.map(|points| points.into_iter().map(distance).collect()),
            translation: translation.map(|points| points.into_iter().map(place).collect()),
            rotation: rotation.map(|Rotation { axis, through, history }| Rotation {
                axis,
                through: self.point(through),
                history,
            }),
        }
    }

    fn round(self, place: Place) -> Place {
        place.map(|point| self.point(point))
    }

    fn shape(self, shape: Shape) -> Shape {
        match shape {
            Shape::Plane { gap } => Shape::Plane { gap: self.length(gap) },
            Shape::PlaneThrough { through } => Shape::PlaneThrough { through: self.point(through) },
            Shape::Cylinder { radius, place, axis } => {
                Shape::Cylinder { radius: self.length(radius), place: self.round(place), axis }
            }
            Shape::Bore { radius, place, axis } => {
                Shape::Bore { radius: self.length(radius), place: self.round(place), axis }
            }
            Shape::Sphere { radius, place } => Shape::Sphere { radius: self.length(radius), place: self.round(place) },
            Shape::Socket { radius, place } => Shape::Socket { radius: self.length(radius), place: self.round(place) },
            Shape::Cone { apex, half_angle, axis } => Shape::Cone { apex: self.point(apex), half_angle, axis },
            Shape::Wedge { apex, angle, axis } => Shape::Wedge { apex: self.point(apex), angle, axis },
            Shape::Formula(formula) => Shape::Formula(self.formula(Quantity::Length, formula)),
            Shape::Surface { file, scale } => Shape::Surface { file, scale: self.length(scale) },
            Shape::Table { file, scale } => Shape::Table { file, scale: self.length(scale) },
        }
    }

    fn action(self, action: Action) -> Action {
        match action {
            Action::Traction { boundary, traction } => Action::Traction {
                boundary,
                traction: traction.into_iter().map(|t| self.field(Quantity::Stress, t)).collect(),
            },
            Action::Pressure { boundary, pressure } => {
                Action::Pressure { boundary, pressure: self.field(Quantity::Stress, pressure) }
            }
            Action::Force { at, force } => {
                Action::Force { at: self.place(at), force: self.components(Quantity::Force, force) }
            }
            Action::Moment { coupling, moment } => Action::Moment { coupling, moment: self.moments(moment) },
            Action::Acceleration(acceleration) => {
                Action::Acceleration(self.components(Quantity::Acceleration, acceleration))
            }
            Action::Spin { axis, through, speed } => {
                Action::Spin { axis, through: through.map(|through| self.point(through)), speed }
            }
            Action::Temperature(field) => Action::Temperature(self.field(Quantity::Number, field)),
        }
    }
}
