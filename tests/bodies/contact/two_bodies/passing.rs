//! Bodies that contact rows do not hold apart, told by warnings.

use super::whole;
use crate::common::prelude::*;

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
        .with_support(Support::new("upper:top", &axes).moved(&down))
}

/// Bodies that pass through each other without a contact are told, with the place and the depth; with one they do not.
#[test]
fn bodies_that_pass_through_each_other() {
    for space in [false, true] {
        let report = run(&pressed(1e-6, space));
        let warning = message(&report, WarningKind::PASSED_THROUGH).unwrap();
        assert!(warning.contains("5.00 mm inside") && warning.contains("[[contact]]"), "{warning}");
        for slave in [["upper:bottom", "lower:top"], ["lower:top", "upper:bottom"]] {
            let report = run(&pressed(1e-6, space).pair(slave[0], 0.3, slave[1]));
            assert_eq!(message(&report, WarningKind::PASSED_THROUGH), None);
        }
        assert_eq!(message(&run(&pressed(0.01, space)), WarningKind::PASSED_THROUGH), None);
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
            .with_support(Support::new("upper:top", &[Axis::X, Axis::Y]).moved(&[0.0, -0.02]));
        run(&body)
    };
    for upper_is_slave in [true, false] {
        let report = wedge(3e-3, upper_is_slave);
        let warning = message(&report, WarningKind::PASSED_THROUGH).unwrap();
        assert!(
            warning.contains("within the search distance of 3.00 mm") && warning.contains("contact[0].search"),
            "{warning}"
        );
        assert_eq!(message(&wedge(0.05, upper_is_slave), WarningKind::PASSED_THROUGH), None);
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
            .with_support(Support::new("punch:top", &[Axis::X, Axis::Y]).moved(&[0.0, -0.015]));
        match gap {
            Some(gap) => {
                let against = Opposite { gap: Some(gap.into()), ..Opposite::from("lower:top") };
                body.pair("punch:bottom", 0.0, against)
            }
            None => body,
        }
    };
    assert_eq!(message(&run(&punch(Some(gap))), WarningKind::PASSED_THROUGH), None);
    assert!(message(&run(&punch(None)), WarningKind::PASSED_THROUGH).is_some());
}
