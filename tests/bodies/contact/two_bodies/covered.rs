//! Slaves that the other body covers in part.

use super::whole;
use crate::common::prelude::*;

fn run(body: &Description) -> RunReport {
    whole::report(body, Method::BN, LinearAlgebra::Whole(SparseLu::default()))
}

/// A block that is pressed on a shorter one and sticks out at both ends, with `n` elements along.
fn overhang(n: usize, second: bool) -> Description {
    let mesh = |size: [f64; 2], n: [usize; 2]| {
        let mesh = block(&size, &n);
        if second { mesh.into_simplices().into_second_order() } else { mesh }
    };
    let mesh = MeshSource::Bodies(vec![
        Body::new("lower", mesh([10.0, 5.0], [10, 3])),
        Body::new("upper", mesh([20.9, 5.0], [n, 3])).at([-5.0, 5.0]),
    ]);
    Description::new(mesh, Material::new(210e9, 0.3), vec![1.0])
        .support("lower:bottom", &[Axis::X, Axis::Y])
        .with_support(Support::new("upper:top", &[Axis::X, Axis::Y]).moved(&[0.0, -0.002]))
}

/// The peak pressure changes little with the place of the slave's nodes beside the end of the other body.
#[test]
fn the_peak_of_an_overhanging_slave() {
    let peak = |report: &RunReport| report.largest_pressure.as_ref().unwrap().pressure.unwrap();
    for second in [false, true] {
        let aligned = peak(&run(&overhang(20, second).pair("lower:top", 0.3, "upper:bottom")));
        for n in 17..25 {
            let body = overhang(n, second).pair("upper:bottom", 0.3, "lower:top");
            let report = run(&body);
            let ratio = peak(&report) / aligned;
            assert!((0.4..1.6).contains(&ratio), "{second} {n} {ratio}");
        }
    }
}

/// The side without nodes beyond the end of the other is the slave that is chosen, also where the other has more nodes.
#[test]
fn the_covered_side_is_chosen() {
    let chosen = Opposite { slave: Slave::Automatic, ..Opposite::from("lower:top") };
    for n in [20, 38, 60] {
        let model = Model::build(&overhang(n, false).pair("upper:bottom", 0.3, chosen.clone())).unwrap();
        assert_eq!(model.contact.pairs[0].choice.unwrap().reason, SlaveReason::OtherOverhangs, "{n}");
        assert_eq!(model.contact.pairs[0].slave, "lower:top");
    }
}

/// Blocks of second order with one end have no forces beyond it, whatever their numbers of elements; one that sticks out has.
#[test]
fn forces_beyond_the_end_of_second_order() {
    let warned = |[n, m]: [usize; 2], space: bool| {
        let mesh = |n: usize| {
            let mesh: Mesh = if space { block(&[1.0, 1.0, 0.5], &[n, n, 1]) } else { block(&[1.0, 0.5], &[n, 2]) };
            mesh.into_simplices().into_second_order()
        };
        let upper = Body::new("upper", mesh(m));
        let upper = if space { upper.at([0.0, 0.0, 0.5]) } else { upper.at([0.0, 0.5]) };
        let mesh = MeshSource::Bodies(vec![Body::new("lower", mesh(n)), upper]);
        let axes = if space { vec![Axis::X, Axis::Y, Axis::Z] } else { vec![Axis::X, Axis::Y] };
        let down = if space { [0.0, 0.0, -1e-4].to_vec() } else { [0.0, -1e-4].to_vec() };
        let body = Description::new(mesh, Material::new(210e9, 0.3), vec![1.0])
            .pair("upper:bottom", 0.3, "lower:top")
            .support("lower:bottom", &axes)
            .with_support(Support::new("upper:top", &axes).moved(&down));
        whole::warns(&run(&body), WarningKind::BEYOND_THE_END)
    };
    for counts in [[10, 14], [10, 7], [5, 4], [4, 4], [3, 10]] {
        assert!(!warned(counts, false), "{counts:?}");
    }
    assert!(!warned([2, 3], true));
    let second = |size: [f64; 2], n: [usize; 2]| block(&size, &n).into_simplices().into_second_order();
    let mesh = MeshSource::Bodies(vec![
        Body::new("lower", second([1.0, 0.5], [10, 2])),
        Body::new("upper", second([0.4, 0.1], [3, 2])).at([0.83, 0.5]),
    ]);
    let tips = Description::new(mesh, Material::new(210e9, 0.3), vec![1.0])
        .pair("upper:bottom", 0.3, "lower:top")
        .support("lower:bottom", &[Axis::X, Axis::Y])
        .load(Load::new("upper:top", &[0.0, -1e5]));
    assert!(whole::warns(&run(&tips), WarningKind::BEYOND_THE_END));
}

/// A facet of second order across a slit: its middle is not covered and has no row, both its ends have.
#[test]
fn a_facet_of_second_order_across_a_slit() {
    for space in [false, true] {
        let mesh = |size: f64, n: usize| {
            let mesh = if space { block(&[size, 1.0, 0.5], &[n, 2, 1]) } else { block(&[size, 0.5], &[n, 1]) };
            mesh.into_simplices().into_second_order()
        };
        let at = |x: f64, up: f64| if space { vec![x, 0.0, up] } else { vec![x, up] };
        let place = |body: Body, at: Vec<f64>| match at[..] {
            [x, y] => body.at([x, y]),
            _ => body.at([at[0], at[1], at[2]]),
        };
        let side = 1.0 + 1e-4;
        let bodies = vec![
            place(Body::new("left", mesh(side, 2)), at(0.0, 0.0)),
            place(Body::new("right", mesh(side, 2)), at(3.0 - side, 0.0)),
            place(Body::new("above", mesh(3.0, 3)), at(0.0, 0.5)),
        ];
        let axes = if space { vec![Axis::X, Axis::Y, Axis::Z] } else { vec![Axis::X, Axis::Y] };
        let body = Description::new(MeshSource::Bodies(bodies), Material::new(210e9, 0.3), vec![1.0])
            .pair("above:bottom", 0.3, ["left:top", "right:top"])
            .support("left:bottom", &axes)
            .support("right:bottom", &axes)
            .load(Load::new("above:top", &at(0.0, -1e6)));
        let report = run(&body);
        let up = report.boundaries[0].force[if space { 2 } else { 1 }];
        assert!((up / -3e6 - 1.0).abs() < 1e-9, "{up}");
    }
}
