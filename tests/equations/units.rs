//! The default settings in other units: the same statuses, the same counts, the same results.

use crate::common::prelude::*;
use proptest::prelude::*;

/// A unit of stress (Pa) and one of length (m): what a scene's numbers are multiples of.
#[derive(Debug, Clone, Copy)]
struct Units {
    stress: f64,
    length: f64,
}

const SI: Units = Units { stress: 1.0, length: 1.0 };
const MM_N_MPA: Units = Units { stress: 1e6, length: 1e-3 };
/// Meganewtons and hundredths of a millimetre.
const MN: Units = Units { stress: 1e16, length: 1e-5 };

/// A paper's scene, written in `units`, with so many increments.
#[derive(Debug, Clone, Copy)]
enum Problem {
    Block { n: i64, mu: f64, increments: i64 },
    Punch { increments: i64 },
}

const PROBLEMS: [Problem; 5] = [
    Problem::Block { n: 5, mu: 0.1, increments: 10 },
    Problem::Block { n: 10, mu: 0.8, increments: 10 },
    Problem::Block { n: 20, mu: 0.4, increments: 4 },
    Problem::Punch { increments: 1 },
    Problem::Punch { increments: 5 },
];

fn scene(problem: Problem, Units { stress, length }: Units) -> Scene {
    let parse = |text: String| text.parse::<Override>().unwrap();
    let side = 1.0 / length;
    let common =
        [parse(format!("mesh.size=[{side:e},{side:e}]")), parse(format!("material.young={:e}", 210e9 / stress))];
    match problem {
        Problem::Block { n, mu, increments } => {
            let traction = -10e6 / stress;
            let overrides = [
                parse(format!("mesh.elements=[{n},{n}]")),
                Override::value("contact.friction", mu),
                Override::value("time.increments", increments),
                Override::value("contact.obstacle.gap", 1e-5 / length),
                parse(format!("load[0].traction=[0,{traction:e}]")),
                parse(format!("load[1].traction=[{traction:e},0]")),
            ];
            let text = BLOCK;
            Scene::parse("block.toml", text, &[&common[..], &overrides].concat()).unwrap()
        }
        Problem::Punch { increments } => {
            let overrides = [
                Override::value("mesh.contact_width", 0.1 / length),
                Override::value("time.increments", increments),
                Override::value("contact.obstacle.radius", 100.0 / length),
                parse(format!("contact.obstacle.apex=[0,{side:e}]")),
                parse(format!("contact.obstacle.approach=[[0,0],[1,{:e}]]", 1e-4 / length)),
            ];
            let text = PUNCH;
            Scene::parse("punch.toml", text, &[&common[..], &overrides].concat()).unwrap()
        }
    }
}

/// What has to be the same in all units, and the states, which have to be the same when converted.
#[derive(Default)]
struct Told {
    iterations: Vec<usize>,
    statuses: Vec<Vec<ContactStatus>>,
    states: Vec<State>,
}

impl Observer for Told {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        self.iterations.push(step.record.iterations);
        self.statuses.push(step.statuses.to_vec());
        self.states.push(step.state.clone());
        ControlFlow::Continue(())
    }
}

fn run(method: &str, scene: &Scene, inside: impl Fn(Scaling) -> Scaling) -> Told {
    let model = discretise(scene).unwrap();
    let scaling = inside(model.scaling());
    let method = if method == "bn" { Method::BN } else { Method::Ip };
    let settings = settings_of(&model, method).until(100, 1e-10);
    let settings = HistorySettings { scaling, ..settings };
    let (mut told, times, system) = (Told::default(), scene.time.all(), SystemSolver::default());
    let outcome = history_of(&model, &times, &settings, system, &mut told);
    assert_eq!(outcome.status, Status::Converged);
    told
}

/// `found` in units of which one is `unit` SI units, against `expected` in SI.
fn assert_close(found: &[f64], unit: f64, expected: &[f64], largest: f64) {
    for (x, y) in found.iter().zip(expected) {
        assert!((x * unit - y).abs() <= 1e-9 * largest, "{} {y}", x * unit);
    }
}

fn assert_same(found: &Told, units: Units, expected: &Told) {
    assert_eq!(found.iterations, expected.iterations, "{units:?}");
    assert_eq!(found.statuses, expected.statuses, "{units:?}");
    let largest =
        |field: fn(&State) -> &[f64]| expected.states.iter().flat_map(field).fold(0.0_f64, |m, x| m.max(x.abs()));
    let (u, p) = (largest(|state| &state.u), largest(|state| &state.p_n));
    // A force per unit depth: the depth is one unit of length.
    let force = units.stress * units.length;
    for (found, expected) in found.states.iter().zip(&expected.states) {
        assert_close(&found.u, units.length, &expected.u, u);
        assert_close(&found.p_n, force, &expected.p_n, p);
        assert_close(&found.p_t, force, &expected.p_t, p);
    }
}

fn written_in(units: Units) {
    for problem in PROBLEMS {
        for method in ["bn", "ip"] {
            let expected = run(method, &scene(problem, SI), |scaling| scaling);
            assert_same(&run(method, &scene(problem, units), |scaling| scaling), units, &expected);
        }
    }
}

#[test]
fn scenes_in_millimetres_newtons_and_megapascals() {
    written_in(MM_N_MPA);
}

#[test]
fn scenes_in_meganewtons_and_hundredths_of_millimetres() {
    written_in(MN);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any units, over 24 decades of stress and 12 of length.
    #[test]
    fn scenes_in_any_units(stress in -12.0..12.0_f64, length in -6.0..6.0_f64, which in 0..PROBLEMS.len()) {
        let units = Units { stress: 10_f64.powf(stress), length: 10_f64.powf(length) };
        for method in ["bn", "ip"] {
            let expected = run(method, &scene(PROBLEMS[which], SI), |scaling| scaling);
            assert_same(&run(method, &scene(PROBLEMS[which], units), |scaling| scaling), units, &expected);
        }
    }
}

/// The numbers inside are the program's own affair: with others than it chooses, nothing changes.
#[test]
fn units_inside() {
    for problem in PROBLEMS {
        for method in ["bn", "ip"] {
            let scene = scene(problem, SI);
            let expected = run(method, &scene, |scaling| scaling);
            for other in [Scaling::SI, Scaling { force: 1e6, length: 1e-5 }, Scaling { force: 1.0, length: 1e-3 }] {
                assert_same(&run(method, &scene, |_| other), SI, &expected);
            }
        }
    }
}
