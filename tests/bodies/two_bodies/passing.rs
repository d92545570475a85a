//! What contact rows do not hold apart, and what facets of curved boundaries do to gaps: told by warnings.

use super::whole;
use crate::common::round::moved;
use std::f64::consts::FRAC_PI_2;
use stickslip::algebra::linear::SparseLu;
use stickslip::base::Formula;
use stickslip::body::fem::{Material, Plane};
use stickslip::body::mesh::{Body, Mesh, MeshSource, block};
use stickslip::body::{Axis, Description, FirstGap, Opposite, Support};
use stickslip::run::report::{RunReport, WarningKind};
use stickslip::solver::history::{LinearAlgebra, Method};

fn run(body: &Description) -> RunReport {
    whole::report(body, Method::BN, LinearAlgebra::Whole(SparseLu::default()))
}

fn message(report: &RunReport, kind: WarningKind) -> Option<&str> {
    report.warnings.iter().find(|warning| warning.kind == kind).map(|warning| &warning.message[..])
}

/// A block above another, `gap` (m) apart, that is pressed down by 1 % of its height.
fn pressed(gap: f64, space: bool) -> Description {
    let mesh = |n: usize| if space { block(&[1.0, 1.0, 0.5], &[n, n, 1]) } else { block(&[1.0, 0.5], &[n, 2]) };
    let upper = Body::new("upper", mesh(4));
    let upper = if space { upper.at([0.0, 0.0, 0.5 + gap]) } else { upper.at([0.0, 0.5 + gap]) };
    let mesh = MeshSource::Bodies(vec![Body::new("lower", mesh(3)), upper]);
    let axes = if space { vec![Axis::X, Axis::Y, Axis::Z] } else { vec![Axis::X, Axis::Y] };
    let down = if space { vec![0.0, 0.0, -0.005] } else { vec![0.0, -0.005] };
    Description::new(mesh, Material::new(70e9, 0.3), vec![1.0])
        .support("lower:bottom", &axes)
        .held(Support::new("upper:top", &axes).moved(&down))
}

/// Bodies that pass through each other without a contact are told, with the place and the depth; with one they do not.
#[test]
fn bodies_that_pass_through_each_other() {
    for space in [false, true] {
        let report = run(&pressed(1e-6, space));
        let told = message(&report, WarningKind::PassedThrough).unwrap();
        assert!(told.contains("5.00 mm inside") && told.contains("[[contact]]"), "{told}");
        for slave in [["upper:bottom", "lower:top"], ["lower:top", "upper:bottom"]] {
            let report = run(&pressed(1e-6, space).pair(slave[0], 0.3, slave[1]));
            assert_eq!(message(&report, WarningKind::PassedThrough), None);
        }
        assert_eq!(message(&run(&pressed(0.01, space)), WarningKind::PassedThrough), None);
    }
}

/// A search that is shorter than the gap that closes cuts the contact off.
#[test]
fn a_search_that_is_too_short() {
    let wedge = |search: f64, upper_is_slave: bool| {
        let leaning = moved(block(&[1.0, 0.5], &[8, 4]), |[x, y, z]| [x, y + 0.01 * x * (1.0 - 2.0 * y), z]);
        let mesh = MeshSource::Bodies(vec![
            Body::new("lower", block(&[1.0, 0.5], &[6, 4])),
            Body::new("upper", leaning).at([0.0, 0.5]),
        ]);
        let [slave, master] =
            if upper_is_slave { ["upper:bottom", "lower:top"] } else { ["lower:top", "upper:bottom"] };
        let body = Description::new(mesh, Material::new(70e9, 0.3), vec![1.0])
            .pair(slave, 0.3, Opposite::from(master).within(search))
            .support("lower:bottom", &[Axis::X, Axis::Y])
            .held(Support::new("upper:top", &[Axis::X, Axis::Y]).moved(&[0.0, -0.02]));
        run(&body)
    };
    for upper_is_slave in [true, false] {
        let report = wedge(3e-3, upper_is_slave);
        let told = message(&report, WarningKind::PassedThrough).unwrap();
        assert!(told.contains("within the search distance of 3.00 mm") && told.contains("contact[0].search"), "{told}");
        assert_eq!(message(&wedge(0.05, upper_is_slave), WarningKind::PassedThrough), None);
    }
}

/// The edges of a punch are drawn sharp, and their rounding is a given gap. The drawn edges enter the body below before
/// the true ones: no body passes through another. A body that sinks in deeper than that does.
#[test]
fn roundings_that_are_given_as_a_gap() {
    // The edges are 0.02 m behind the flat.
    let gap = Formula::parse("max(0, abs(x - 0.5) - 0.1)^2 / (2 * 0.0625)").unwrap();
    let punch = |gap: Option<Formula>| {
        let mesh = MeshSource::Bodies(vec![
            Body::new("lower", block(&[1.0, 0.5], &[37, 20])),
            Body::new("punch", block(&[0.3, 0.2], &[12, 40])).at([0.35, 0.500_001]),
        ]);
        let body = Description::new(mesh, Material::new(70e9, 0.3), vec![1.0])
            .support("lower:bottom", &[Axis::X, Axis::Y])
            .held(Support::new("punch:top", &[Axis::X, Axis::Y]).moved(&[0.0, -0.015]));
        match gap {
            Some(gap) => {
                let against = Opposite { gap: FirstGap::Formula(gap), ..Opposite::from("lower:top") };
                body.pair("punch:bottom", 0.0, against)
            }
            None => body,
        }
    };
    assert_eq!(message(&run(&punch(Some(gap))), WarningKind::PassedThrough), None);
    assert!(message(&run(&punch(None)), WarningKind::PassedThrough).is_some());
}

/// A quarter of a ring that is drawn larger than the bore of another by `overlap` (m), with `n` facets along the inner and `m` along the outer one.
fn rings([n, m]: [usize; 2], second: bool, overlap: f64, gap: Option<f64>) -> RunReport {
    let ring = |radii: [f64; 2], n: usize| -> Mesh {
        let mut mesh = block(&[1.0, 1.0], &[3, n]);
        if second {
            mesh = mesh.into_simplices().into_second_order();
        }
        moved(mesh, |[s, t, _]| {
            let (r, angle) = (radii[0] + s * (radii[1] - radii[0]), FRAC_PI_2 * t);
            [if t == 1.0 { 0.0 } else { r * angle.cos() }, r * angle.sin(), 0.0]
        })
    };
    let mesh = MeshSource::Bodies(vec![
        Body::new("inner", ring([0.05, 0.1 + overlap], n)),
        Body::new("outer", ring([0.1, 0.2], m)),
    ]);
    let against = Opposite::from("outer:left").within(0.01);
    let against = gap.map_or(against.clone(), |gap| against.apart(gap));
    let body = Description::new(mesh, Material::new(210e9, 0.3).in_plane(Plane::Stress), vec![1.0]);
    let body = body.pair("inner:right", 0.0, against);
    run(&["inner", "outer"].iter().fold(body, |body, name| {
        body.support(&format!("{name}:bottom"), &[Axis::Y]).support(&format!("{name}:top"), &[Axis::X])
    }))
}

/// Facets whose chords are as far from the circle as the bodies overlap are told, and the right cure is.
#[test]
fn facets_that_change_the_gaps() {
    let report = rings([8, 6], false, 1e-5, None);
    let told = message(&report, WarningKind::FacetedGaps).unwrap();
    assert!(told.contains("contact[0].gap") && told.contains("second order"), "{told}");
    for kind in [WarningKind::ContactUnresolved, WarningKind::PeakScatter, WarningKind::SingularEdge] {
        assert_eq!(message(&report, kind), None);
    }
    // Facets of second order leave the circle, too, by a tenth of this overlap: some pressures are off by 80 %.
    assert!(message(&rings([8, 6], true, 1e-5, None), WarningKind::FacetedGaps).is_some());
    // Chords that are a fortieth of the overlap make pressures of a fifth too much.
    assert!(message(&rings([32, 34], false, 1e-4, None), WarningKind::FacetedGaps).is_some());
    let right = [
        ([8, 6], false, 1e-5, Some(-1e-5)),
        ([8, 8], false, 1e-5, None),
        ([16, 12], true, 1e-5, None),
        ([8, 6], true, 1e-3, None),
        ([40, 30], false, 1e-3, None),
    ];
    for (counts, second, overlap, gap) in right {
        let report = rings(counts, second, overlap, gap);
        assert_eq!(message(&report, WarningKind::FacetedGaps), None, "{counts:?} {second} {gap:?}");
        assert_eq!(message(&report, WarningKind::PassedThrough), None, "{counts:?} {second} {gap:?}");
    }
}
