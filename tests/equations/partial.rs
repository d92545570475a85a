//! The uncondensed system with its interior factored once a run: the results of a factorisation in each iteration.

#![cfg(any(feature = "umfpack", feature = "faer"))]

use crate::common::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

use stickslip::algebra::linear::Partial;

const PARTIAL: LinearAlgebra = LinearAlgebra::Whole(SparseLu::Partial);

/// The scenes that are shipped, with coarse meshes.
const SCENES: [(&str, &[&str]); 22] = [
    ("block.toml", &["mesh.elements=[16,16]", "time.increments=8"]),
    ("bolt.toml", &["time.increments=4"]),
    ("boxed.toml", &["mesh.elements=[8,8]", "time.increments=4"]),
    ("cattaneo_mindlin.toml", &["mesh.elements=[[6,12,6],8]"]),
    ("confined.toml", &["mesh.elements=[8,8]", "time.increments=4"]),
    ("cube.toml", &["mesh.elements=[4,4,4]", "time.increments=4"]),
    ("cycles.toml", &["mesh.elements=[6,6]"]),
    ("disk.toml", &["mesh.elements=[6,6,2]", "time.increments=4"]),
    ("frictionless.toml", &["mesh.elements=[16,16]", "time.increments=8"]),
    ("held_by_contact.toml", &["mesh.elements=[10,10]", "time.increments=5"]),
    ("hertz_line.toml", &[]),
    ("hertz_sphere.toml", &["mesh.elements=[[3,3],[3,3],4]"]),
    ("mindlin_sphere.toml", &["mesh.elements=[[2,5,2],[3,2],3]"]),
    ("punch.toml", &["time.increments=4"]),
    ("seal.toml", &["mesh.elements=[8,8]", "time.increments=5"]),
    ("ssnv128.toml", &["mesh.elements=[8,8]"]),
    ("strip.toml", &["mesh.elements=[60,4]", "time.increments=5"]),
    ("tilted_punch.toml", &["time.increments=4"]),
    ("tip.toml", &["mesh.elements=[10,6,3]", "time.increments=4"]),
    ("turning_load.toml", &["mesh.elements=[8,8]", "time.increments=8"]),
    ("two_blocks.toml", &["body[0].mesh.elements=[8,4]", "body[1].mesh.elements=[11,5]", "time.increments=5"]),
    ("wedge.toml", &["mesh.elements=[8,4]"]),
];

fn run(scene: &Scene, model: &Model, method: Method, system: SystemSolver) -> (HistoryOutcome, Vec<State>) {
    run_to(if method.is_of_paper() { method.default_tolerance() } else { 1e-12 }, scene, model, method, system)
}

fn run_to(
    tolerance: f64,
    scene: &Scene,
    model: &Model,
    method: Method,
    system: SystemSolver,
) -> (HistoryOutcome, Vec<State>) {
    let settings = settings_of(model, method).until(200, tolerance);
    let (outcome, keep) = recorded(model, &scene.time.all(), &settings, system);
    (outcome, keep.states)
}

/// The largest difference of contact forces, relative to the largest of the history.
fn difference(a: &[State], b: &[State]) -> f64 {
    let forces = |state: &State| [&state.p_t[..], &state.p_o, &state.p_n].concat();
    let (a, b) = (a.iter().flat_map(forces), b.iter().flat_map(forces));
    let (worst, largest) =
        a.zip(b).fold((0.0_f64, 0.0_f64), |(worst, largest), (a, b)| (worst.max((a - b).abs()), largest.max(a.abs())));
    if worst == 0.0 { 0.0 } else { worst / largest }
}

/// Compares with the sparse LU of this build.
fn assert_agree(scene: &Scene, name: &str) {
    let model = discretise(scene).unwrap();
    for method in [Method::BN, Method::Ip] {
        let [(whole, a), (partial, b)] =
            [LinearAlgebra::default(), PARTIAL].map(|linear| run(scene, &model, method, linear.into()));
        let counts = |outcome: &HistoryOutcome| -> Vec<_> {
            outcome.records.iter().map(|record| (record.status, record.iterations)).collect()
        };
        assert_eq!((whole.status, partial.status), (Status::Converged, Status::Converged), "{name}, {method}");
        // The last matrices of the interior point method are nearly singular if only contact holds the body.
        let is_regular = method == Method::BN || model.problem.rigid_modes().is_empty();
        if is_regular {
            // At 1e-12 rounding of the equilibrium would decide when the interior point method ends.
            let [whole, partial] = [LinearAlgebra::default(), PARTIAL]
                .map(|linear| run_to(method.default_tolerance(), scene, &model, method, linear.into()).0);
            assert_eq!(counts(&whole), counts(&partial), "{name}, {method}");
        }
        let found = difference(&a, &b);
        assert!(found <= 1e-11, "{name}, {method}: {found:e}");
        let (error, most) = (partial.linear.worst_backward_error, if is_regular { 1e-14 } else { 1e-10 });
        assert!(error <= most, "{name}, {method}: backward error {error:e}");
    }
}

#[test]
fn on_the_scenes_that_are_shipped() {
    for (name, overrides) in SCENES {
        assert_agree(&common::scene(name, overrides), name);
    }
}

#[test]
fn with_the_interior_point_method_of_the_paper() {
    let scene = common::block(&["mesh.elements=[8,8]", "time.increments=4"]);
    let model = discretise(&scene).unwrap();
    for partition in [Partition::Products, Partition::Cone] {
        let method = Method::PaperIp { start: Start::Safe, partition };
        let [whole, partial] =
            [LinearAlgebra::default(), PARTIAL].map(|linear| run(&scene, &model, method, linear.into()));
        assert_eq!((whole.0.status, partial.0.status), (Status::Converged, Status::Converged), "{partition:?}");
        let found = difference(&whole.1, &partial.1);
        assert!(found <= 1e-11, "{partition:?}: {found:e}");
    }
}

/// Contact rows of second order couple all nodes of a boundary.
#[test]
fn on_boundaries_of_second_order() {
    for (name, overrides) in [
        ("block.toml", ["mesh.elements=[12,12]", "mesh.cells=\"triangle6\"", "time.increments=4"]),
        ("cube.toml", ["mesh.elements=[2,2,2]", "mesh.cells=\"tetrahedron10\"", "time.increments=4"]),
    ] {
        assert_agree(&common::scene(name, &overrides), &format!("{name}, second order"));
    }
}

/// Counts the factorisations of the stiffness.
struct Counting {
    partial: Partial,
    stiffness: Arc<AtomicUsize>,
}

impl LinearSolver for Counting {
    fn name(&self) -> &'static str {
        self.partial.name()
    }

    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<(), LinearError> {
        self.partial.analyze(pattern)
    }

    fn factorize(&mut self, values: &[f64]) -> Result<FactorInfo, LinearError> {
        self.partial.factorize(values)
    }

    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        self.partial.solve(b, x)
    }

    fn analyze_system(&mut self, a: &SystemMatrix) -> Result<(), LinearError> {
        self.partial.analyze_system(a)
    }

    fn factorize_system(&mut self, a: &SystemMatrix) -> Result<FactorInfo, LinearError> {
        let info = self.partial.factorize_system(a);
        self.stiffness.store(self.partial.stiffness_factorizations(), Ordering::Relaxed);
        info
    }
}

/// Also where only contact holds the body, and springs come and go.
#[test]
fn the_stiffness_is_factored_once() {
    let held_by_contact = ("held_by_contact.toml", &["mesh.elements=[10,10]", "time.increments=5"][..]);
    for (name, overrides) in [SCENES[0], SCENES[5], SCENES[20], held_by_contact] {
        let scene = common::scene(name, overrides);
        let model = discretise(&scene).unwrap();
        for method in [Method::BN, Method::Ip] {
            for cholesky in [SparseCholesky::Cholmod, SparseCholesky::Faer].into_iter().filter(|c| c.is_built_in()) {
                let stiffness = Arc::default();
                let counting = Counting { partial: cholesky.into(), stiffness: Arc::clone(&stiffness) };
                let outcome =
                    run(&scene, &model, method, SystemSolver::from(Box::new(counting) as Box<dyn LinearSolver>)).0;
                assert_eq!(outcome.status, Status::Converged, "{name}, {method}");
                assert!(outcome.linear.factorizations > 1, "{name}, {method}");
                assert_eq!(stiffness.load(Ordering::Relaxed), 1, "{name}, {method}, {cholesky}");
            }
        }
    }
}

/// Failures have the verdicts of a factorisation in each iteration.
#[test]
fn verdicts_agree() {
    let block = BLOCK;
    let coarse = || ["mesh.elements=[4,4]", "time.increments=2"].map(|text| text.parse().unwrap());
    let [contact, load] = ["[[contact]]", "[[load]]"].map(|table| block.find(table).unwrap());
    let without_contact = [&block[..contact], &block[load..]].concat();
    let unsupported = |text: &str| common::edit(text, "[[support]]\nboundary = \"left\"\nfix = [\"x\", \"y\"]\n", "");
    for (name, text) in [
        ("held by nothing", unsupported(&without_contact)),
        ("held by contact alone, and pushed along", unsupported(block)),
        ("without contact", without_contact),
    ] {
        let scene = Scene::parse("block.toml", &text, &coarse()).unwrap();
        let model = discretise(&scene).unwrap();
        for method in [Method::BN, Method::Ip] {
            let [whole, partial] = [LinearAlgebra::default(), PARTIAL].map(|linear| {
                let outcome = run(&scene, &model, method, linear.into()).0;
                (outcome.status, outcome.records.len(), outcome.free_motion.is_some())
            });
            assert_eq!(whole, partial, "{name}, {method}");
        }
    }
}

/// Three displacements, the last in contact, and its force.
fn small(spring: f64, interior: f64, contact: [f64; 2]) -> SystemMatrix {
    let [by_w, by_p] = contact;
    let entries = [
        (0, 0, interior),
        (1, 0, -1.0),
        (0, 1, -1.0),
        (1, 1, 2.0),
        (2, 1, -1.0),
        (1, 2, -1.0),
        (2, 2, 1.0 + spring),
        (2, 3, 1.0),
        (3, 2, by_w),
        (3, 3, by_p),
    ];
    SystemMatrix::from(Csc::from_triplets(4, 4, &entries).unwrap())
}

#[test]
fn what_changes_is_factored() {
    let mut partial = Partial::default();
    let of = |spring, interior, contact| small(spring, interior, contact).with_displacements(3).unwrap();
    let (open, closed) = ([0.0, -1.0], [3.0, 0.0]);
    partial.analyze_system(&of(0.0, 2.0, open)).unwrap();
    for (matrix, factored) in [
        (of(1.0, 2.0, open), 1),
        (of(0.0, 2.0, closed), 1),
        (of(0.0, 2.0, open), 1),
        (of(0.0, 2.5, closed), 2),
        (of(1.0, 2.5, closed), 2),
    ] {
        partial.factorize_system(&matrix).unwrap();
        assert_eq!(partial.stiffness_factorizations(), factored);
        let expected = [1.0, -2.0, 0.5, 3.0];
        let mut x = [0.0; 4];
        partial.solve(&matrix.times(&expected).unwrap(), &mut x).unwrap();
        assert!(x.iter().zip(expected).all(|(x, expected)| (x - expected).abs() < 1e-14), "{x:?}");
    }
}

#[test]
fn errors_are_those_of_other_solvers() {
    let known = |a: SystemMatrix| a.with_displacements(3).unwrap();
    let open = || known(small(0.0, 2.0, [0.0, -1.0]));
    let mut partial = Partial::default();
    assert_eq!(partial.analyze_system(&small(0.0, 2.0, [0.0, -1.0])), Err(LinearError::UnknownDisplacements));
    assert_eq!(partial.analyze(open().pattern()), Err(LinearError::UnknownDisplacements));
    assert!(matches!(partial.factorize_system(&open()), Err(LinearError::Order { .. })));
    partial.analyze_system(&open()).unwrap();
    assert!(matches!(partial.solve(&[0.0; 4], &mut [0.0; 4]), Err(LinearError::Order { .. })));
    let singular = partial.factorize_system(&known(small(0.0, 2.0, [0.0; 2])));
    assert!(matches!(singular, Err(LinearError::Singular { .. })), "{singular:?}");
    assert!(matches!(partial.solve(&[0.0; 4], &mut [0.0; 4]), Err(LinearError::Order { .. })));
    for place in [0, 7, 9] {
        let mut values = small(0.0, 2.0, [0.0, -1.0]).rest().values().to_vec();
        values[place] = f64::NAN;
        assert_eq!(partial.factorize(&values), Err(LinearError::NotFinite), "{place}");
    }
    // The interior alone is singular: [1 -1; -1 1].
    let loose = [(0, 0, 1.0), (1, 0, -1.0), (0, 1, -1.0), (1, 1, 1.0), (2, 2, 1.0), (2, 3, 1.0), (3, 2, 1.0)];
    let loose = known(SystemMatrix::from(Csc::from_triplets(4, 4, &loose).unwrap()));
    let mut solver = RefinedSolver::new(Box::new(Partial::default()));
    solver.analyze(&loose).unwrap();
    assert!(matches!(solver.factorize(&loose), Err(LinearError::Singular { .. })));
    let other = small(0.0, 2.0, [0.0, -1.0]).with_displacements(2).unwrap();
    partial.analyze_system(&open()).unwrap();
    assert_eq!(partial.factorize_system(&other), Err(LinearError::PatternChanged));
    assert!(matches!(open().with_displacements(5), Err(LinearError::Shape { .. })));
    partial.factorize_system(&open()).unwrap();
    assert!(matches!(partial.solve(&[0.0; 3], &mut [0.0; 4]), Err(LinearError::Shape { .. })));
}
