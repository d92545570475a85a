//! What a report says of its own mesh. doc/method/estimates.md has the figures, which `--nocapture` prints.

use crate::common::prelude::*;
use stickslip::body::{ContactEstimate, peak_error};

const YOUNG: f64 = 210e9;
const NU: f64 = 0.3;
const MODULUS: f64 = YOUNG / (1.0 - NU * NU);
const RADIUS: f64 = 100.0;
/// The contact is looked for so far to each side.
const REACH: f64 = 0.06;

pub fn solved(description: &Description) -> RunReport {
    solved_by_bn(description, &mut ()).1
}

fn contact(report: &RunReport) -> &ContactEstimate {
    let [contact] = &report.estimates.contact[..] else { panic!("{:?}", report.estimates) };
    contact
}

fn kinds_of(report: &RunReport) -> Vec<WarningKind> {
    let kinds = report.warnings.iter().map(|warning| warning.kind);
    kinds.filter(|kind| *kind != WarningKind::SLOW_BLAS).collect()
}

/// A cylinder on a block, right of the symmetry plane x = 0 or on both sides of it, with elements of the size `REACH / n`.
fn pressed_by_a_cylinder(n: usize, half: bool, approach: f64) -> Description {
    let right = ([REACH, 2.0 - REACH], [n, 24], [1.0, 60.0]);
    let (sizes, elements, grading) = if half {
        (right.0.to_vec(), right.1.to_vec(), right.2.to_vec())
    } else {
        (vec![2.0 - REACH, 2.0 * REACH, 2.0 - REACH], vec![24, 2 * n, 24], vec![1.0 / 60.0, 1.0, 60.0])
    };
    let start = if half { 0.0 } else { -2.0 };
    let mesh = MeshSource::segmented(
        &[sizes, vec![2.0]],
        &[elements, vec![24 + n / 4]],
        Some(&[grading, vec![1.0 / 200.0]]),
        None,
    );
    // A block begins at 0, so that the cylinder stands in its middle, or at its left side.
    let cylinder = Shape::Cylinder { radius: RADIUS, place: Place::Apex([-start, 2.0].into()), axis: None };
    let body = Description::new(mesh.unwrap(), Material::new(YOUNG, NU), vec![1.0])
        .support("bottom", &[Axis::X, Axis::Y])
        .contact("top", 0.0, Obstacle::at_rest(cylinder).approaching(&[[0.0, 0.0], [1.0, approach]]));
    if half { body.support("left", &[Axis::X]) } else { body }
}

/// Whatever the number of nodes across, the peak is as near to Hertz' for the force as the estimate says.
#[test]
fn the_peak_is_within_its_estimate() {
    for n in [2, 3, 4, 5, 6, 8, 12, 16] {
        for approach in [2e-5, 5e-5] {
            let report = solved(&pressed_by_a_cylinder(n, true, approach));
            let contact = contact(&report);
            let across = contact.nodes_across.unwrap();
            let hertz = Hertz::line(2.0 * contact.force, RADIUS, MODULUS);
            let error = contact.peak_pressure / hertz.p0 - 1.0;
            println!(
                "{across} across: peak {:.1} %, estimate {:.1} %",
                100.0 * error,
                100.0 * contact.peak_error.unwrap()
            );
            assert!(across < 2 || error.abs() <= peak_error(across), "{across}: {error}");
            let expected = match across {
                0..4 => vec![WarningKind::CONTACT_UNRESOLVED],
                4..8 => vec![WarningKind::CONTACT_COARSE],
                _ => vec![],
            };
            assert_eq!(kinds_of(&report), expected, "{across}: {:?}", report.warnings);
            // What Hertz has for the force is told where the mesh cannot tell.
            assert_eq!(contact.hertz.is_some(), across < 4);
            if let Some(found) = contact.hertz {
                assert!(
                    (found.half_width / hertz.a - 1.0).abs() < 1e-12
                        && (found.peak_pressure / hertz.p0 - 1.0).abs() < 1e-12
                );
            }
        }
    }
}

/// Half of a body with a symmetry plane is told as the whole.
#[test]
fn a_symmetry_plane_hides_nothing() {
    for n in [4, 10] {
        let [half, whole] = [true, false].map(|half| solved(&pressed_by_a_cylinder(n, half, 5e-5)));
        let [a, b] = [contact(&half), contact(&whole)];
        assert_eq!(a.nodes_across, b.nodes_across);
        for (a, b) in [(a.peak_pressure, b.peak_pressure), (2.0 * a.force, b.force), (a.scatter, b.scatter)] {
            assert!((a - b).abs() < 1e-9 * b, "{a} {b}");
        }
        assert_eq!(kinds_of(&half), kinds_of(&whole));
    }
}

/// Under a cylinder across the diagonals of coarse elements no two closed nodes are neighbours; along the elements they are, but
/// only one is across.
#[test]
fn nodes_without_neighbours_are_told() {
    let mesh = || MeshSource::block([0.1, 0.1, 0.05], [10, 10, 5]);
    for (axis, isolated) in [([1.0, 1.0, 0.0], 1.0), ([0.0, 1.0, 0.0], 0.0)] {
        let cylinder =
            Shape::Cylinder { radius: 0.02, place: Place::Apex([0.05, 0.05, 0.05].into()), axis: Some(axis.into()) };
        let report = solved(
            &Description::new(mesh(), Material::new(YOUNG, NU), vec![1.0])
                .support("bottom", &[Axis::X, Axis::Y, Axis::Z])
                .contact("top", 0.0, Obstacle::at_rest(cylinder).approaching(&[[0.0, 0.0], [1.0, 1e-4]])),
        );
        let contact = contact(&report);
        assert_eq!((contact.nodes_across, contact.unresolved_share), (Some(1), 1.0));
        assert!((contact.isolated_share - isolated).abs() < 1e-12);
        // Elements that are pressed along a line of nodes are too stiff, too; single nodes are left out of that.
        let locking = (isolated < 0.5).then_some(WarningKind::LOCKING);
        let expected = [Some(WarningKind::CONTACT_UNRESOLVED), locking, Some(WarningKind::COARSE_MESH)];
        assert_eq!(kinds_of(&report), expected.into_iter().flatten().collect::<Vec<_>>());
        let length = 0.1 * axis.iter().map(|c: &f64| c * c).sum::<f64>().sqrt();
        let hertz = Hertz::line(contact.force / length, 0.02, MODULUS);
        let found = contact.hertz.unwrap();
        assert!((found.half_width / hertz.a - 1.0).abs() < 1e-12, "{found:?} {}", hertz.a);
    }
}

/// Under a flat punch the pressure is singular at the edge, and elements that jump in size there spoil the inside, too.
#[test]
fn punches_have_singular_edges() {
    for (outer, uneven) in [(8, true), (64, false)] {
        let mesh = MeshSource::HalfPlane(HalfPlane {
            size: [0.5, 0.5],
            contact_width: 0.06,
            contact_elements: 24,
            outer_elements: outer,
            layers: 20,
        });
        let report = solved(
            &Description::new(mesh, Material::new(YOUNG, NU), vec![1.0])
                .support("left", &[Axis::X])
                .support("bottom", &[Axis::Y])
                .contact("contact", 0.0, Obstacle::plane(0.0).approaching(&[[0.0, 0.0], [1.0, 1e-5]])),
        );
        let contact = contact(&report);
        println!("{outer} outside: {contact:?}");
        assert_eq!(contact.nodes_across, None);
        let expected = [Some(WarningKind::SINGULAR_EDGE), uneven.then_some(WarningKind::UNEVEN_ELEMENTS)];
        assert_eq!(kinds_of(&report), expected.into_iter().flatten().collect::<Vec<_>>());
    }
}

/// At the edge of a flat the pressure is singular if a flank begins there, steep or not; if the edge is rounded, a finer mesh helps,
/// however small its radius.
#[test]
fn edges_of_obstacles_are_told_from_roundings() {
    let cases = [
        ("max(0, x - 5) * 0.3", WarningKind::SINGULAR_EDGE),
        ("max(0, x - 5) * 3", WarningKind::SINGULAR_EDGE),
        ("max(0, x - 5)^2 / (2 * 50)", WarningKind::PEAK_SCATTER),
        ("max(0, x - 5)^2 / (2 * 0.2)", WarningKind::PEAK_SCATTER),
    ];
    for (formula, expected) in cases {
        let formula = format!("contact.obstacle.formula=\"{formula}\"").parse().unwrap();
        let increments = "time.increments=1".parse().unwrap();
        let text = include_str!("../../../data/tutorials/punch.toml");
        let scene = Scene::parse("punch.toml", text, &[formula, increments]).unwrap();
        let report = Run::new(&scene).unwrap().solve(&mut ()).unwrap();
        let of_peak = [WarningKind::SINGULAR_EDGE, WarningKind::PEAK_SCATTER];
        let found: Vec<WarningKind> = kinds_of(&report).into_iter().filter(|kind| of_peak.contains(kind)).collect();
        assert_eq!(found, [expected], "{scene:?} {:?}", report.estimates.peak);
    }
}

/// A block that is clamped below and pressed by a plane on which nothing slips, as wide as it is high: the strain energy is half
/// of the force times the approach.
fn pressed(d: usize, n: usize, poisson: f64, cells: Option<CellKind>, element: Element) -> RunReport {
    let mesh = MeshSource::segmented(&vec![vec![1.0]; d], &vec![vec![n]; d], None, cells).unwrap();
    let all = &[Axis::X, Axis::Y, Axis::Z][..d];
    solved(
        &Description::new(mesh, Material::new(1e9, poisson), vec![1.0])
            .element(element)
            .support("bottom", all)
            .contact("top", 1e6, Obstacle::plane(0.0).approaching(&[[0.0, 0.0], [1.0, 1e-3]])),
    )
}

/// Where elements make the block too stiff by 5 % or more, against fine elements with B-bar, the estimate is within three times
/// of that, and where they do by less than 1 % it is below 3 %.
#[test]
fn locking_is_seen() {
    let kinds = [
        (2, CellKind::Quadrilateral, [4, 8]),
        (2, CellKind::Triangle, [4, 8]),
        (3, CellKind::Hexahedron, [3, 6]),
        (3, CellKind::Tetrahedron, [3, 6]),
        (3, CellKind::Prism, [3, 6]),
    ];
    for poisson in [0.3, 0.45, 0.49, 0.499] {
        let fine = [2, 3].map(|d| {
            let reports =
                [12, 24].map(|n| pressed(d, if d == 2 { 2 * n } else { n / 3 }, poisson, None, Element::BBar));
            assert!(reports.iter().all(|report| report.estimates.locking.is_none()));
            let [coarse, fine] = reports.map(|report| contact(&report).force);
            // The corners make the error one of first order.
            2.0 * fine - coarse
        });
        for (d, kind, sizes) in kinds {
            for n in sizes {
                let report = pressed(d, n, poisson, Some(kind), Element::Bilinear);
                let error = contact(&report).force / fine[d - 2] - 1.0;
                let estimate = report.estimates.locking.unwrap();
                println!("{kind:?} {n}, nu {poisson}: {:.1} %, estimate {:.1} %", 100.0 * error, 100.0 * estimate);
                if error > 0.05 {
                    assert!((error / 3.0..3.0 * error).contains(&estimate) || error > 1.0, "{error} {estimate}");
                }
                assert!(error > 0.01 || estimate < 0.03, "{error} {estimate}");
                assert_eq!(kinds_of(&report).contains(&WarningKind::LOCKING), estimate > 0.05);
            }
        }
    }
}

/// A block that a force, or a small obstacle, presses in the middle of its top, where the strain is singular: what elements lock falls all
/// the same as they get smaller.
#[test]
fn a_single_node_that_is_pressed_does_not_lock() {
    let axes = [Axis::X, Axis::Y, Axis::Z];
    let kinds = [CellKind::Quadrilateral, CellKind::Triangle, CellKind::Hexahedron, CellKind::Tetrahedron];
    for (kind, poisson) in kinds.into_iter().flat_map(|kind| [(kind, 0.3), (kind, 0.4)]) {
        let d = kind.dimension();
        let mut last = f64::INFINITY;
        for n in [4, 8, 16].into_iter().filter(|n| d == 2 || *n <= 8) {
            let mesh = MeshSource::segmented(&vec![vec![1.0]; d], &vec![vec![n]; d], None, Some(kind)).unwrap();
            let body = Description::new(mesh, Material::new(1e9, poisson), vec![1.0]).support("bottom", &axes[..d]);
            let top: Vector = if d == 2 { [0.5, 1.0].into() } else { [0.5, 0.5, 1.0].into() };
            let (radius, place) = (1e-3, Place::Apex(top));
            let (force, shape) = match d {
                2 => (vec![0.0, -1e3], Shape::Cylinder { radius, place, axis: None }),
                _ => (vec![0.0, 0.0, -1e3], Shape::Sphere { radius, place }),
            };
            let by_force = body.clone().load(Action::Force { at: Where::Point(top), force }.into());
            let by_force = solved(&by_force).estimates.locking.unwrap();
            let sharp = Obstacle::at_rest(shape).approaching(&[[0.0, 0.0], [1.0, 1e-5]]);
            let report = solved(&body.contact("top", 0.0, sharp));
            let by_contact = report.estimates.locking.unwrap();
            println!("{kind:?} {n}, nu {poisson}: {:.1} %", 100.0 * by_force);
            assert_eq!(contact(&report).closed, 1);
            assert!((by_contact / by_force - 1.0).abs() < 1e-6, "{by_contact} {by_force}");
            assert!(by_force < 0.97 * last, "{kind:?} {n}: {by_force} {last}");
            last = by_force;
        }
    }
}

/// Two blocks of triangles, or of quadrilaterals and one of them narrow, pressed together by 1 mm and then moved.
fn blocks(cells: &str, [lower, upper]: [[usize; 2]; 2], [x, width]: [f64; 2], friction: f64, motion: f64) -> String {
    let body = |name: &str, at: [f64; 2], width: f64, elements: [usize; 2]| {
        format!(
            "[[body]]\nname = \"{name}\"\nat = {at:?}\n[body.mesh]\nkind = \"block\"\nsize = [{width:?}, 0.5]\nelements = {elements:?}\n\
             cells = \"{cells}\"\n[body.material]\nyoung = 1e9\npoisson = 0.2\n"
        )
    };
    [
        body("lower", [0.0, 0.0], 1.0, lower),
        body("upper", [x, 0.5], width, upper),
        format!(
            "[[support]]\nboundary = \"lower:bottom\"\nfix = [\"x\", \"y\"]\n[[support]]\nboundary = \"upper:top\"\nfix = [\"y\"]\n\
             displacement = -1e-3\nhistory = [[0, 0], [1, 1], [2, 1]]\n[[support]]\nboundary = \"upper:top\"\nfix = [\"x\"]\n\
             displacement = {motion}\nhistory = [[0, 0], [1, 0], [2, 1]]\n[[contact]]\nboundary = \"upper:bottom\"\n\
             against = \"lower:top\"\nfriction = {friction}\n"
        ),
    ]
    .concat()
}

/// Runs a scene of blocks.
fn moved(blocks: &str) -> RunReport {
    let text = format!("{blocks}[time]\nend = 2.0\nincrements = 12\n");
    let report = Run::new(&parsed(&text)).unwrap().solve(&mut ()).unwrap();
    assert_eq!(report.status, Status::Converged, "{}", report.explanation.reason);
    report
}

/// At the edges of a narrow block one node slips where ten stick, and the work of friction changes with every refinement.
#[test]
fn the_work_of_zones_that_slip_and_are_narrow_is_warned_of() {
    let work = |report: &RunReport| report.increments.iter().map(|record| record.friction_work).sum::<f64>();
    let narrow = |n: usize| blocks("quadrilateral", [[2 * n, n], [n + 1, n]], [0.25, 0.5], 0.3, 1.5e-4);
    let (coarse, fine) = (moved(&narrow(9)), moved(&narrow(18)));
    println!(
        "work: {:.3e} {:.3e}, nodes across {:?}",
        work(&coarse),
        work(&fine),
        coarse.estimates.contact[0].slip_across
    );
    assert!((work(&coarse) / work(&fine) - 1.0).abs() > 0.1);
    assert!(kinds_of(&coarse).contains(&WarningKind::SLIP_ZONE_COARSE), "{:?}", coarse.warnings);
    // Each contact of a scene has its own slip zones, whatever happens in another.
    let beside = narrow(36).replace("at = [0", "at = [9").replace("lower", "second").replace("upper", "third");
    let both = moved(&[narrow(9), beside].concat());
    let across = |report: &RunReport| report.estimates.contact[0].slip_across.unwrap();
    let [alone, together] = [&coarse, &both].map(across);
    assert!((together / alone - 1.0).abs() < 1e-6 && both.estimates.contact[1].slip_across.unwrap() > 1.5 * alone);
    let said =
        |of: &str| both.warnings.iter().any(|warning| warning.message.starts_with(&format!("`{of}`: slip zones")));
    assert!(said("upper:bottom") && said("third:bottom"), "{:?}", both.warnings);
}

/// The diagonals of triangles make normal forces pull sideways: by a share of these, and by a large one of a small tangential force. A large one is
/// told well.
#[test]
fn tangential_forces_that_are_small_beside_the_error_of_the_mesh_are_warned_of() {
    let finer =
        |k: usize, motion: f64| moved(&blocks("triangle", [[6 * k, 3 * k], [8 * k, 4 * k]], [0.0, 1.0], 0.3, motion));
    let force = |report: &RunReport| report.end.sum_p_t;
    let (coarse, fine) = (finer(1, 3e-5), finer(2, 3e-5));
    assert!((force(&coarse) / force(&fine) - 1.0).abs() > 0.1, "{:e} {:e}", force(&coarse), force(&fine));
    for (motion, warned) in [(3e-5, true), (1.5e-3, false)] {
        let report = finer(1, motion);
        println!("{motion:e}: {:?} {:?}", report.estimates.tangential, report.estimates.discretisation);
        assert_eq!(kinds_of(&report).contains(&WarningKind::TANGENTIAL_COARSE), warned, "{:?}", report.warnings);
        assert!(!kinds_of(&report).contains(&WarningKind::COARSE_MESH));
    }
}
