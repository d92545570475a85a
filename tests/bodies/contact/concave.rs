//! Bores, sockets and cones: bodies in conforming ones, Sneddon's cone, and gaps that end on the surface wherever it has gone.

use crate::common::prelude::*;
use stickslip::body::{DeformedNode, range_left};

fn nearest(shape: Shape, normal: &[f64]) -> Obstacle {
    Obstacle {
        normal: Some(normal.to_vec().try_into().unwrap()),
        direction: GapDirection::Nearest,
        ..Obstacle::at_rest(shape)
    }
}

/// A quarter of a disk of radius 1, or an eighth of a ball: a block whose far sides are pushed out. Its symmetry planes are
/// `left` and `bottom`, in space `front` besides.
fn rounded(dimension: usize, elements: usize) -> Mesh {
    let mut mesh = if dimension == 2 { block(&[1.0; 2], &[elements; 2]) } else { block(&[1.0; 3], &[elements; 3]) };
    for x in &mut mesh.nodes {
        let (largest, length) = (largest(x), norm(*x));
        if length > 0.0 {
            *x = x.map(|c| c * largest / length);
        }
    }
    mesh
}

/// The last state of a history in the default setting.
fn solved(description: &Description) -> (Model, State) {
    let model = Model::build(description).unwrap();
    let mut keep = Keep::default();
    let run = Run::of(&model, model.times().to_vec(), bn()).unwrap();
    assert_eq!(run.history(&mut keep).unwrap().status, Status::Converged);
    (model, keep.states.pop().unwrap())
}

/// A disk and a ball that are too large for a bore and a socket by δ are squeezed to them: u = -δ x / R, which these elements
/// have exactly, under a uniform pressure of E δ / (R (1 + ν) (1 - 2 ν)) in plane strain and E δ / (R (1 - 2 ν)) in space. The
/// sides of the mesh share nodes on which the normals are the same. Friction holds what the flat facets push aside.
#[test]
fn what_is_too_large_for_its_bore_is_squeezed() {
    let (young, poisson, delta) = (1e9, 0.3, 1e-3);
    for dimension in [2, 3] {
        let apex = |c: usize| (0..dimension).map(|k| if k == c { 1.0 - delta } else { 0.0 }).collect::<Vec<_>>();
        let vector = |c: usize| apex(c).try_into().unwrap();
        let shape = |c: usize| match dimension {
            2 => Shape::Bore { radius: 1.0 - delta, place: Place::Apex(vector(c)), axis: None },
            _ => Shape::Socket { radius: 1.0 - delta, place: Place::Apex(vector(c)) },
        };
        let mesh = rounded(dimension, 4);
        let outside = mesh.boundaries.iter().filter(|b| ["right", "top", "back"].contains(&b.name.as_str()));
        let facets: Vec<Vec<usize>> = outside.flat_map(|boundary| boundary.facets.clone()).collect();
        let source = MeshSource::Given(Arc::new(mesh.clone()));
        let mut description = Description::new(source, Material::new(young, poisson), vec![1.0])
            .support("left", &[Axis::X])
            .support("bottom", &[if dimension == 2 { Axis::Y } else { Axis::Z }])
            .contact("right", 0.9, nearest(shape(0), &apex(0)))
            .contact("top", 0.9, nearest(shape(dimension - 1), &apex(dimension - 1)));
        if dimension == 3 {
            description = description.support("front", &[Axis::Y]).contact("back", 0.9, nearest(shape(1), &apex(1)));
        }
        let (model, state) = solved(&description);
        for (x, u) in model.mesh.nodes.iter().zip(model.constraints.dofs.displacements(&state.u)) {
            assert!((0..3).all(|c| (u[c] + delta * x[c]).abs() < 1e-9 * delta), "{x:?} {u:?}");
        }
        let pressure = young * delta / (1.0 - 2.0 * poisson) / if dimension == 2 { 1.0 + poisson } else { 1.0 };
        // No contact node is there twice, and the forces on the boundaries are those on their facets.
        let nodes: std::collections::BTreeSet<usize> = facets.iter().flatten().copied().collect();
        assert_eq!(model.contact.nodes.len(), nodes.len());
        let whole: f64 = model.contact.nodes.iter().map(|contact| contact.weight).sum();
        let areas: f64 = facets.iter().map(|facet| norm(mesh.area_vector(facet))).sum();
        assert!((whole / areas - 1.0).abs() < 1e-3, "{whole} {areas}");
        // On the symmetry planes supports bear what friction does across them, so only free components are compared.
        let mut expected = vec![[0.0; 3]; mesh.nodes.len()];
        for facet in &facets {
            if facet.len() == 2 {
                let half = mesh.area_vector(facet).map(|c| 0.5 * pressure * c);
                for &node in facet {
                    (0..3).for_each(|c| expected[node][c] += half[c]);
                }
            }
        }
        for (i, contact) in model.contact.nodes.iter().enumerate().filter(|_| dimension == 2) {
            let [t, _] = contact.facing.tangents;
            let n = contact.facing.normal;
            let force = [0, 1].map(|c| state.p_n[i] * n[c] + state.p_t[i] * t[c]);
            let free = model.constraints.dofs.node(contact.node);
            for c in (0..2).filter(|&c| free[c].is_some()) {
                let f = expected[contact.node][c];
                assert!((force[c] - f).abs() < 1e-8 * pressure, "{:?}: {force:?} {f}", contact.position);
            }
        }
    }
}

/// Where a point was before it moved as an obstacle does: by `by`, after a turn by `angle` about `axis` through `through`.
fn back(x: [f64; 3], by: [f64; 3], (axis, through, angle): ([f64; 3], [f64; 3], f64)) -> [f64; 3] {
    let r = minus(minus(x, by), through);
    let along = dot(r, axis);
    let aside = cross(axis, r);
    [0, 1, 2].map(|c| through[c] + axis[c] * along + (r[c] - axis[c] * along) * angle.cos() - aside[c] * angle.sin())
}

/// How far a place, from the apex, is inside an obstacle about an axis.
type Depth = fn([f64; 3], [f64; 3]) -> f64;

/// However far a bore, a socket or a cone has moved and turned, the gap of each node ends on it.
#[test]
fn gaps_end_on_the_surface_wherever_it_has_gone() {
    let (apex, axis) = ([0.1, -0.2, 1.5], [0.6, 0.8, 0.0]);
    let cone_axis = unit([0.1, -0.1, 1.0]);
    let cases: [(Shape, Depth); 3] = [
        (Shape::Bore { radius: 4.0, place: Place::Apex(apex.into()), axis: Some(axis.into()) }, |r, axis| {
            // The centre is 4 m below the apex.
            let from = [r[0], r[1], r[2] + 4.0];
            let along = dot(from, axis);
            norm([0, 1, 2].map(|c| from[c] - along * axis[c])) - 4.0
        }),
        (Shape::Socket { radius: 4.0, place: Place::Apex(apex.into()) }, |r, _| norm([r[0], r[1], r[2] + 4.0]) - 4.0),
        (Shape::Cone { apex: apex.into(), half_angle: 1.1, axis: Some(cone_axis.into()) }, |r, _| {
            let axis = unit([0.1, -0.1, 1.0]);
            let along = dot(r, axis);
            along * 1.1_f64.tan() - norm([0, 1, 2].map(|c| r[c] - along * axis[c]))
        }),
    ];
    let by = [0.2, -0.1, -0.05];
    let turn = (unit([1.0, 2.0, 2.0]), [0.3, 0.3, 1.2], 0.2);
    for (shape, depth) in cases {
        for direction in [GapDirection::Normal, GapDirection::Nearest] {
            let given = Obstacle {
                direction,
                translation: Some(vec![(0.0, [0.0; 3].into()), (2.0, by.into())]),
                rotation: Some(Rotation {
                    axis: Some(turn.0.into()),
                    through: turn.1.into(),
                    history: vec![[0.0, 0.0], [2.0, turn.2]],
                }),
                ..Obstacle::at_rest(shape.clone())
            };
            let description =
                Description::new(MeshSource::block([1.0; 3], [3, 3, 2]), Material::new(1e9, 0.3), vec![1.0, 2.0])
                    .support("bottom", &[Axis::X, Axis::Y, Axis::Z])
                    .contact("top", 0.1, given);
            let model = Model::build(&description).unwrap();
            assert_eq!(model.contact.nodes.len(), 16);
            for (t, share) in [(0.0, 0.0), (1.0, 0.5), (2.0, 1.0)] {
                for (contact, gap) in model.contact.nodes.iter().zip(model.loading.gaps_at(t)) {
                    let (x, n) = (contact.position, contact.facing.normal);
                    let end = back(
                        [0, 1, 2].map(|c| x[c] + gap * n[c]),
                        by.map(|c| share * c),
                        (turn.0, turn.1, share * turn.2),
                    );
                    let left = depth(minus(end, apex), axis);
                    assert!(left.abs() < 1e-12, "{shape:?} {direction:?} {t} {x:?}: {left}");
                }
            }
        }
    }
}

/// A shaft in a bore: gaps as a pencil gives them, along the normal and to the nearest point, in and outside of it.
#[test]
fn gaps_in_a_bore() {
    let mesh = block(&[1.0, 1.0], &[2, 2]);
    let top = mesh.boundary("top").unwrap();
    let project = |given: &Obstacle, x: [f64; 3]| PlacedObstacle::new(&mesh, top, given).unwrap().at(x);
    // About (0, 0.6), with 3-4-5 at (0.3, 1.0).
    let bore = Obstacle::at_rest(Shape::Bore { radius: 0.5, place: Place::Apex([0.0, 1.1].into()), axis: None });
    let near = Obstacle { direction: GapDirection::Nearest, ..bore.clone() };
    assert!((project(&bore, [0.3, 0.9, 0.0]).gap - 0.1).abs() < 1e-15);
    assert!((project(&bore, [0.3, 1.05, 0.0]).gap + 0.05).abs() < 1e-15);
    assert!(project(&bore, [0.6, 0.6, 0.0]).gap.is_nan());
    let facing = project(&near, [0.24, 0.92, 0.0]);
    assert!((facing.gap - 0.1).abs() < 1e-15 && norm(minus(facing.normal, [0.6, 0.8, 0.0])) < 1e-14, "{facing:?}");
    assert!((project(&near, [0.36, 1.08, 0.0]).gap + 0.1).abs() < 1e-15);
    // In the centre the way along the normal is as near as any.
    let centred = Obstacle {
        direction: GapDirection::Nearest,
        ..Obstacle::at_rest(Shape::Bore { radius: 0.5, place: Place::Apex([0.0, 0.5].into()), axis: None })
    };
    assert_eq!((project(&centred, [0.0; 3]).gap, project(&centred, [0.0; 3]).normal), (0.5, [0.0, 1.0, 0.0]));
    // The surface leans as the circle does: a bore that moves aside opens on one side.
    let inward = project(&bore, [0.3, 0.9, 0.0]).inward;
    assert!(norm(minus(inward, [0.75, 1.0, 0.0])) < 1e-14, "{inward:?}");
}

/// A body that moves in a bore, on a cone or under a sphere leaves the range of its linearised gaps by what a pencil gives.
#[test]
fn the_range_of_round_and_pointed_obstacles() {
    let cube = block(&[1.0; 3], &[1; 3]);
    let square = block(&[1.0; 2], &[1; 2]);
    // About (0, 0.6): from (0.3, 1.0) the node goes to (0, 1), where its old normal (0.6, 0.8) meets the circle after
    // g² + 2 g 0.32 = 0.09.
    let bore = nearest(Shape::Bore { radius: 0.5, place: Place::Apex([0.0, 1.1].into()), axis: None }, &[0.0, 1.0]);
    let along_the_bore = -0.32 + (0.32_f64 * 0.32 + 0.09).sqrt();
    // From (0.3, 0, 1) on a cone of 45 degrees to the other side of its tip.
    let cone = Obstacle::at_rest(Shape::Cone { apex: [0.0, 0.0, 0.7].into(), half_angle: 0.25 * PI, axis: None });
    for (mesh, given, from, to, linearised, exact) in [
        (&square, &bore, [0.3, 1.0, 0.0], [0.0, 1.0, 0.0], 0.18, along_the_bore),
        (&cube, &cone, [0.3, 0.0, 1.0], [-0.1, 0.0, 1.0], 0.0, -0.2),
    ] {
        let obstacle = PlacedObstacle::new(mesh, mesh.boundary("top").unwrap(), given).unwrap();
        let motion = ObstacleMotion::new(given, obstacle.normal, 1.0);
        let facing = obstacle.at(from);
        let node = DeformedNode {
            node: 0,
            position: from,
            displacement: minus(to, from),
            normal: facing.normal,
            gap: facing.gap,
            closed: true,
        };
        let left = range_left(&obstacle, &motion, 0.0, 0.01, &[node]).unwrap();
        assert!((left.linearised - linearised).abs() < 1e-14 && (left.exact - exact).abs() < 1e-14, "{left:?}");
        let still = DeformedNode { displacement: [0.0; 3], ..node };
        assert!(range_left(&obstacle, &motion, 0.0, 0.01, &[still]).is_none());
    }
}

/// A cone on a block, as a cone and as a formula of its gaps. The force is that of Sneddon, P = 2 E* δ² tan(α) / π, as far as
/// the block is a half-space; `verification.rs` has the same for the radius that is found.
#[test]
fn a_cone_is_its_gaps() {
    let (half_angle, delta, young, poisson) = (1.45_f64, 0.03, 1e9, 0.3);
    let axis = |elements: usize, fine: usize| {
        let segment = |length, elements, grading| stickslip::body::mesh::Segment { length, elements, grading };
        vec![segment(0.4, fine, 1.0), segment(2.0, elements, 6.0)]
    };
    let mut down = axis(4, 4);
    down.reverse();
    for segment in &mut down {
        segment.grading = 1.0 / segment.grading;
    }
    let source = MeshSource::Block {
        axes: vec![axis(4, 6), axis(4, 6), down],
        cells: stickslip::body::mesh::CellKind::Hexahedron,
        origin: None,
    };
    let pressed = |shape: Shape| {
        let description = Description::new(source.clone(), Material::new(young, poisson), vec![0.5, 1.0])
            .support("bottom", &[Axis::Z])
            .support("left", &[Axis::X])
            .support("front", &[Axis::Y])
            .contact("top", 0.0, Obstacle::at_rest(shape).approaching(&[[0.0, 0.0], [1.0, delta]]));
        let (_, state) = solved(&description);
        (4.0 * state.p_n.iter().sum::<f64>(), state.u)
    };
    let (force, u) = pressed(Shape::Cone { apex: [0.0, 0.0, 2.4].into(), half_angle, axis: None });
    let formula = stickslip::base::Formula::parse("sqrt(x^2 + y^2) / tan(1.45)").unwrap();
    let (same, v) = pressed(Shape::Formula(formula));
    assert!((force / same - 1.0).abs() < 1e-9 && u.iter().zip(&v).all(|(a, b)| (a - b).abs() < 1e-9 * delta));
    let exact = 2.0 * young / (1.0 - poisson * poisson) * delta * delta * half_angle.tan() / PI;
    assert!((force / exact - 1.0).abs() < 0.15, "{force} {exact}");
}
