//! A uniform pressure goes through any meshes as it is.

use crate::common::pairs::paired;
use crate::common::prelude::*;
use stickslip::run::report::ContactPoint;

const PRESSURE: f64 = 1e7;

pub(super) fn mesh<const D: usize>(size: [f64; D], elements: [usize; D], cells: CellKind) -> MeshSource {
    let axes = (0..D).map(|k| vec![Segment { length: size[k], elements: elements[k], grading: 1.0 }]).collect();
    MeshSource::Block { axes, cells, origin: None }
}

/// The largest errors of the stresses and of the contact pressures, relative to the pressure.
fn errors(description: &Description) -> [f64; 2] {
    let model = Model::build(description).unwrap();
    let condensed = LinearAlgebra::Condensed(SparseCholesky::default());
    let state = solved(&model, solver(Method::BN, condensed), &mut ()).state;
    let up = model.mesh.dimension - 1;
    let displacements = model.displacements(1.0, &state.u).unwrap();
    let off = |stress: [f64; 6]| {
        let expected = |c: usize| if c == up { -PRESSURE } else { 0.0 };
        (0..6).filter(|&c| c != 2 || up == 2).map(|c| (stress[c] - expected(c)).abs() / PRESSURE).fold(0.0, f64::max)
    };
    let of_stresses = model.centre_stresses(1.0, &displacements).unwrap().into_iter().map(off).fold(0.0, f64::max);
    let pressure = |(contact, p): (&ContactNode, &f64)| (p / contact.weight / PRESSURE - 1.0).abs();
    [of_stresses, model.contact.nodes.iter().zip(&state.p_n).map(pressure).fold(0.0, f64::max)]
}

/// Rollers below, one point of each body held aside.
fn held(description: Description, points: [[f64; 2]; 2]) -> Description {
    let aside = |point: [f64; 2]| Support::new("", &[Axis::X]).at(point);
    description.support("lower:bottom", &[Axis::Y]).with_support(aside(points[0])).with_support(aside(points[1]))
}

#[test]
fn in_the_plane() {
    use CellKind::{Quadrilateral, Triangle, Triangle6};
    for (lower, upper, kinds) in [
        ([7, 3], [5, 3], [Quadrilateral, Quadrilateral]),
        ([7, 3], [5, 3], [Triangle, Triangle]),
        ([7, 3], [5, 3], [Triangle, Quadrilateral]),
        ([3, 2], [40, 8], [Quadrilateral, Quadrilateral]),
        ([40, 8], [3, 2], [Quadrilateral, Quadrilateral]),
        ([3, 2], [4, 2], [Triangle6, Triangle6]),
        ([5, 2], [2, 2], [Triangle6, Quadrilateral]),
    ] {
        for slave in [Side::Upper, Side::Lower] {
            let lower = (mesh([1.0, 0.5], lower, kinds[0]), 210e9);
            let upper = (mesh([1.0, 0.5], upper, kinds[1]), 70e9);
            let body = paired(bodies(lower, upper, Some([0.0, 0.5].into()), vec![1.0]), slave, 0.0);
            let body = held(body, [[0.0, 0.0], [0.0, 1.0]]).load(Load::new("upper:top", &[0.0, -PRESSURE]));
            let errors = errors(&body);
            assert!(errors.iter().all(|error| *error < 1e-11), "{kinds:?} {slave:?} {errors:?}");
        }
    }
}

/// The upper body covers parts of facets at its ends; beside it the lower one has the pressure as a load.
#[test]
fn partly_covered_in_the_plane() {
    // Of the facet at one end as little as rounding leaves is covered.
    let covered = [0.5, 0.1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-11].map(|share| (0.3 - 0.1 * share, 0.8 - 0.1 * share));
    let ends = covered.into_iter().chain([(0.211, 0.741)]).flat_map(|ends| [(ends, Side::Upper), (ends, Side::Lower)]);
    for ((from, to), slave) in ends {
        let lower = (MeshSource::block([1.0, 0.5], [10, 4]), 210e9);
        let upper = (MeshSource::block([to - from, 0.5], [4, 3]), 70e9);
        let body = bodies(lower, upper, Some([from, 0.501].into()), vec![1.0]);
        // Apart, so that a point is one of one body.
        let body = match slave {
            Side::Upper => body.pair("upper:bottom", 0.0, Opposite::from("lower:top").apart(0.0)),
            Side::Lower => body.pair("lower:top", 0.0, Opposite::from("upper:bottom").apart(0.0)),
        };
        let mut body = held(body, [[0.0, 0.0], [from, 1.001]]).load(Load::new("upper:top", &[0.0, -PRESSURE]));
        let mut forces = [0.0; 11];
        for k in 0..10 {
            let [a, b] = [0.1 * k as f64, 0.1 * (k + 1) as f64];
            for [start, end] in [[a, b.min(from)], [a.max(to), b]] {
                if end > start {
                    let (length, share) = (end - start, (0.5 * (start + end) - a) / (b - a));
                    forces[k] -= PRESSURE * length * (1.0 - share);
                    forces[k + 1] -= PRESSURE * length * share;
                }
            }
        }
        for (k, force) in forces.into_iter().enumerate().filter(|(_, force)| *force != 0.0) {
            let at = Where::Point([0.1 * k as f64, 0.5].into());
            body = body.load(Action::Force { at, force: vec![0.0, force] }.into());
        }
        let errors = errors(&body);
        assert!(errors[0] < 1e-11 && errors[1] < 1e-8, "{slave:?} {from} {errors:?}");
    }
}

#[test]
fn in_space() {
    use CellKind::{Hexahedron, Prism, Tetrahedron, Tetrahedron10};
    for (lower, upper, kinds) in [
        ([3, 3, 2], [4, 5, 2], [Hexahedron, Hexahedron]),
        ([3, 3, 2], [4, 4, 2], [Tetrahedron, Tetrahedron]),
        ([3, 3, 2], [4, 4, 2], [Hexahedron, Tetrahedron]),
        ([3, 3, 2], [2, 2, 1], [Prism, Tetrahedron]),
        ([2, 2, 1], [3, 3, 1], [Tetrahedron10, Tetrahedron10]),
        ([3, 2, 1], [2, 2, 1], [Hexahedron, Tetrahedron10]),
    ] {
        for slave in [Side::Upper, Side::Lower] {
            let lower = (mesh([1.0, 1.0, 0.5], lower, kinds[0]), 210e9);
            let upper = (mesh([1.0, 1.0, 0.5], upper, kinds[1]), 70e9);
            let body = paired(bodies(lower, upper, Some([0.0, 0.0, 0.5].into()), vec![1.0]), slave, 0.0);
            let point = |axes: &[Axis], point: [f64; 3]| Support::new("", axes).at(point);
            let body = body
                .support("lower:bottom", &[Axis::Z])
                .with_support(point(&[Axis::X, Axis::Y], [0.0, 0.0, 0.0]))
                .with_support(point(&[Axis::Y], [1.0, 0.0, 0.0]))
                .with_support(point(&[Axis::X, Axis::Y], [0.0, 0.0, 1.0]))
                .with_support(point(&[Axis::Y], [1.0, 0.0, 1.0]))
                .load(Load::new("upper:top", &[0.0, 0.0, -PRESSURE]));
            let errors = errors(&body);
            assert!(errors.iter().all(|error| *error < 1e-11), "{kinds:?} {slave:?} {errors:?}");
        }
    }
}

/// A hub on a shaft with interference has Lamé's pressure and no gap at all nodes, at corners and between them.
#[test]
fn nodes_of_second_order_tell_what_is_there() {
    let group =
        |name: &str| MaterialGroup { name: name.into(), young: 210e9, poisson: 0.3, ..MaterialGroup::default() };
    let mut material = Material::new(210e9, 0.3).in_plane(Plane::Axisymmetric);
    material.groups = vec![group("hub"), group("shaft")];
    let ring =
        |name: &str, at: f64, n: usize| Body::new(name, mesh([0.02, 0.01], [8, n], CellKind::Triangle6)).at([at, 0.0]);
    let all = MeshSource::Bodies(vec![ring("hub", 0.03, 3), ring("shaft", 0.01, 4)]);
    let interference = Opposite::from("shaft:right").apart(-1e-5);
    let mut body = Description::new(all, material, vec![1.0]).pair("hub:left", 0.0, interference);
    for boundary in ["hub:bottom", "hub:top", "shaft:bottom", "shaft:top"] {
        body = body.support(boundary, &[Axis::Y]);
    }
    let model = Model::build(&body).unwrap();
    let mut line: Vec<ContactPoint> = Vec::new();
    let record = |step: &IncrementView<'_>| line = ContactLine::all(&model, step).remove(0).points;
    solved(&model, solver(Method::BN, LinearAlgebra::condensed()), &mut each(record));
    // Radii of 10, 30 and 50 mm.
    let pressure = 210e9 / 0.91 / 0.03 * 1e-5 * (800.0 * 1600.0) / (2.0 * 900.0 * 2400.0);
    assert_eq!(line.len(), 7);
    for point in &line {
        assert!((point.sigma_n / pressure - 1.0).abs() < 1e-3, "{} {}", point.y, point.sigma_n / pressure);
        assert!(point.gap.abs() < 1e-15 && (point.w_n + 1e-5).abs() < 1e-15, "{} {}", point.y, point.gap);
    }
}
