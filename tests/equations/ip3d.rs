//! The interior point method with the exact cone, for friction in two tangential directions.

use crate::common::nodes::Count;
use crate::common::prelude::*;
use crate::common::random;
use stickslip::solver::formulation::ConeSystem;

const TIMES: [f64; 5] = [0.2, 0.4, 0.6, 0.8, 1.0];

fn run(problem: &ContactProblem, loading: &Loading, times: &[f64], settings: &HistorySettings) -> HistoryOutcome {
    history::run(problem, loading, times, settings, SystemSolver::default(), &mut ()).unwrap()
}

/// Without halving.
fn ip(problem: &ContactProblem, loading: &Loading) -> HistorySettings {
    HistorySettings { halvings: 0, ..HistorySettings::new(problem, loading, Method::Ip).unwrap().until(100, 1e-12) }
}

fn bn(problem: &ContactProblem, loading: &Loading) -> HistorySettings {
    HistorySettings { halvings: 0, ..HistorySettings::new(problem, loading, Method::BN).unwrap().until(100, 1e-12) }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    let largest = a.iter().chain(b).fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs() / largest).fold(0.0, f64::max)
}

/// Runs both methods, which have to agree; the history of the interior point method.
fn agree(problem: &ContactProblem, loading: &Loading, what: &str) -> HistoryOutcome {
    let one = run(problem, loading, &TIMES, &ip(problem, loading));
    assert_eq!(one.status, Status::Converged, "{what}: {:?}, {:?}", one.violation, iterations(&one));
    let other = run(problem, loading, &TIMES, &bn(problem, loading));
    assert_eq!(other.status, Status::Converged, "{what}: {:?}", other.violation);
    let (a, b) = (&one.state, &other.state);
    for (a, b) in [(&a.u, &b.u), (&a.p_n, &b.p_n), (&a.p_t, &b.p_t), (&a.p_o, &b.p_o)] {
        assert!(distance(a, b) <= 1e-8, "{what}: {}", distance(a, b));
    }
    one
}

/// Fails unless an increment takes 15 iterations at most, on average.
fn few(count: &Count) {
    println!("{count}");
    assert!(count.mean() <= 15.0, "{count}");
}

/// Loads that turn, friction from little to much.
fn random_histories(seeds: Range<u64>) {
    for mu in [0.1, 0.4, 0.8, 2.0] {
        let mut count = Count::default();
        for seed in seeds.clone() {
            let mut random = Random(seed * 7919 + 3);
            let contacts = 1 + (30.0 * random.next()) as usize;
            let (problem, loading) = random::problem(&mut random, contacts, mu, 0.0);
            count.add(&agree(&problem, &loading, &format!("mu {mu}, seed {seed}")));
        }
        println!("mu {mu}: {count}");
        assert!(count.mean() <= 15.0, "mu {mu}: {count}");
    }
}

#[test]
fn ten_random_histories() {
    random_histories(0..10);
}

#[test]
#[ignore = "four times as many as the test before"]
fn forty_random_histories() {
    random_histories(0..40);
}

/// Stiffness over three decades.
#[test]
fn random_histories_of_uneven_bodies() {
    let mut count = Count::default();
    for seed in 0..40 {
        let mut random = Random(seed * 613 + 11);
        let contacts = 1 + (20.0 * random.next()) as usize;
        let (problem, loading) = random::problem(&mut random, contacts, 0.8, 3.0);
        let outcome = run(&problem, &loading, &TIMES, &ip(&problem, &loading));
        assert_eq!(outcome.status, Status::Converged, "seed {seed}: {:?}", iterations(&outcome));
        count.add(&outcome);
    }
    few(&count);
}

/// Nodes without friction among others, and nodes that have one tangent or none.
#[test]
fn nodes_with_fewer_tangents() {
    let mut count = Count::default();
    for seed in 0..20 {
        let mut random = Random(seed * 271 + 5);
        let contacts = 4 + (12.0 * random.next()) as usize;
        let (problem, loading) = random::problem(&mut random, contacts, 0.7, 0.0);
        let without = |map: &Csr, nodes: &[usize]| {
            let row = |i: usize| map.row(i).iter().copied().filter(|_| !nodes.contains(&i)).collect();
            random::rows(problem.displacements(), (0..contacts).map(row))
        };
        let problem = common::changed(&problem, |parts| {
            (parts.c_t, parts.c_o) = (without(problem.c_t(), &[1, 3]), without(problem.c_o(), &[2, 3]));
            parts.mu.iter_mut().step_by(3).for_each(|mu| *mu = 0.0);
        });
        count.add(&agree(&problem, &loading, &format!("seed {seed}")));
    }
    few(&count);
}

/// A motion that moves all nodes along their normals costs no energy.
#[test]
fn a_body_held_by_contact_only() {
    let mut count = Count::default();
    for seed in 0..20 {
        let mut random = Random(seed * 1009 + 2);
        let contacts = 2 + (12.0 * random.next()) as usize;
        let (held, loading) = random::problem(&mut random, contacts, 0.6, 0.0);
        let n = held.displacements();
        let mut motion = vec![0.0; n];
        (0..contacts).flat_map(|i| held.c_n().row(i)).for_each(|(dof, c)| motion[*dof] += c);
        let force = held.stiffness().assembled().unwrap().times(&motion).unwrap();
        let energy: f64 = force.iter().zip(&motion).map(|(a, b)| a * b).sum();
        let mut full = vec![0.0; n * n];
        for (row, column, value) in held.stiffness().assembled().unwrap().entries() {
            full[row * n + column] = value;
        }
        let stiffness: Symmetric = random::symmetric(n, |i, j| full[i * n + j] - force[i] * force[j] / energy);
        let size = motion.iter().map(|x| x * x).sum::<f64>().sqrt();
        for x in &mut motion {
            *x /= size;
        }
        let problem = common::changed(&held, |parts| {
            (parts.stiffness, parts.rigid_modes) = (stiffness.into(), Some(vec![motion]));
        });
        count.add(&agree(&problem, &loading, &format!("seed {seed}")));
    }
    few(&count);
}

/// Whatever pair of tangents a node has: the same displacements and forces in as many iterations.
#[test]
fn the_choice_of_tangents_does_not_matter() {
    for seed in 0..12 {
        let mut random = Random(seed * 104_729 + 1);
        let (problem, loading) = random::problem(&mut random, 1 + seed as usize, 0.7, 0.0);
        let turned = random::turn_tangents(&problem, &mut random);
        // The interior point method alone: below 1e-10 rounding decides how many steps of BN it takes to the end.
        let settings = |problem| HistorySettings {
            halvings: 0,
            ..HistorySettings::new(problem, &loading, Method::Ip).unwrap().until(100, 1e-8)
        };
        let [own, other] = [&problem, &turned].map(|problem| run(problem, &loading, &TIMES, &settings(problem)));
        assert_eq!(own.status, Status::Converged, "seed {seed}");
        assert_eq!(iterations(&own), iterations(&other), "seed {seed}");
        assert!(distance(&own.state.u, &other.state.u) <= 1e-7);
        assert!(distance(&own.state.p_n, &other.state.p_n) <= 1e-7);
    }
}

/// The Newton system is the derivative of the residual: its solution, completed, gives back the
/// right-hand side when the equations are differentiated along it.
#[test]
fn the_newton_system_is_the_derivative() {
    let mut random = Random(5);
    let (problem, loading) = random::problem(&mut random, 7, 0.5, 0.0);
    let problem = common::changed(&problem, |parts| parts.mu[3] = 0.0);
    let mut formulation =
        ConeSystem::new(&problem, Scaling::near(1e11, 1.0), &FormulationScaling::paper(problem.weight().unwrap()));
    let force = loading.cases()[0].force();
    let last = [(); 2].map(|()| (0..7).map(|_| 0.3 * random.sign()).collect::<Vec<f64>>());
    formulation.begin(
        &Increment { force, gap: loading.gap(), mu: problem.mu(), w_t_last: &last[0], w_o_last: &last[1] },
        &vec![0.0; formulation.unknowns()],
    );
    let mut linear = RefinedSolver::default();
    linear.analyze(formulation.matrix()).unwrap();
    for spread in [0.0, 0.5, 1.0] {
        // Inside and outside of the cone, pairs tilted either way.
        let n = formulation.unknowns();
        let mut z: Vec<f64> = (0..n).map(|_| 0.4 * random.sign()).collect();
        for pair in formulation.pairs().to_vec() {
            let tilt = spread * random.sign();
            (z[pair.force], z[pair.length]) = (1.2 * 10_f64.powf(tilt), 0.8 * 10_f64.powf(-tilt));
        }
        let b: Vec<f64> = (0..n).map(|_| random.sign()).collect();
        formulation.linearize(&z);
        linear.factorize(formulation.matrix()).unwrap();
        let m = formulation.matrix().order();
        let (mut rhs, mut dz) = (vec![0.0; m], vec![0.0; n]);
        formulation.reduce(&z, &b, &mut rhs);
        linear.solve(formulation.matrix(), &rhs, &mut dz[..m]).unwrap();
        formulation.recover(&z, &b, &mut dz);
        let size = dz.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
        let step = 1e-6 / size;
        let at = |t: f64| {
            let moved: Vec<f64> = z.iter().zip(&dz).map(|(z, dz)| z + t * dz).collect();
            let mut h = vec![0.0; n];
            formulation.residual(&moved, &mut h).unwrap();
            h
        };
        let (ahead, behind) = (at(step), at(-step));
        for k in 0..n {
            let difference = (ahead[k] - behind[k]) / (2.0 * step);
            assert!((difference - b[k]).abs() <= 1e-6 * size, "row {k} of {n}: {difference} {}", b[k]);
        }
    }
}

/// The paper's interior point method has no second tangent, and says so.
#[test]
fn the_paper_knows_one_tangent() {
    let (problem, loading) = random::problem(&mut Random(1), 3, 0.5, 0.0);
    let paper = HistorySettings::new(&problem, &loading, Method::paper_ip(Start::Safe)).unwrap().until(100, 1e-6);
    assert_eq!(run(&problem, &loading, &TIMES, &paper).status, Status::Unsupported);
}

fn punch(overrides: &[&str]) -> Scene {
    parsed_with(PUNCH, overrides)
}

/// A problem in two dimensions with a third displacement at every contact node, along its second tangent,
/// which nothing moves. The exact cone then takes the place of the two constraints of (25).
fn thickened(problem: &ContactProblem, loading: &Loading) -> (ContactProblem, Loading) {
    let (n, contacts) = (problem.displacements(), problem.contacts());
    let whole = problem.stiffness().assembled().unwrap();
    let own = whole.lower();
    let idle = problem.contact_stiffness().iter().enumerate().map(|(i, k)| (n + i, n + i, *k));
    let stiffness = Symmetric::from_triplets(n + contacts, &own.entries().chain(idle).collect::<Vec<_>>()).unwrap();
    let wide = |map: &Csr| random::rows(n + contacts, (0..contacts).map(|i| map.row(i).to_vec()));
    let padded = |values: &[f64]| [values, &vec![0.0; contacts]].concat();
    let thick = ContactProblem::new(Parts {
        stiffness: stiffness.into(),
        c_n: wide(problem.c_n()),
        c_t: wide(problem.c_t()),
        c_o: random::rows(n + contacts, (0..contacts).map(|i| vec![(n + i, 1.0)])),
        rigid_modes: Some(problem.rigid_modes().iter().map(|motion| padded(motion)).collect()),
        ..problem.clone().into_parts()
    })
    .unwrap();
    let cases = loading.cases().iter();
    let cases = cases.map(|case| LoadCase::new(padded(case.force()), case.history().to_vec()).unwrap()).collect();
    let moving = Loading::new(cases, loading.gap().to_vec()).unwrap();
    let loading = moving.with_motions(loading.motions().to_vec(), loading.gap_corrections().to_vec()).unwrap();
    (thick, loading)
}

/// Both interior point methods on the paper's problems: the two constraints of (25) need fewer iterations
/// than the exact cone, which is why they serve two dimensions.
#[test]
fn two_dimensions() {
    two_dimensions_on(&[10]);
}

#[test]
#[ignore = "half a minute without optimisation"]
fn two_dimensions_on_a_larger_block() {
    two_dimensions_on(&[20]);
}

/// On blocks of these sizes and the punch.
fn two_dimensions_on(sizes: &[usize]) {
    let [mut flat, mut cone] = [Count::default(), Count::default()];
    for mu in ["0.1", "0.4", "0.8"] {
        let friction = format!("contact.friction={mu}");
        let blocks = sizes.iter().map(|n| common::block(&[&format!("mesh.elements=[{n},{n}]"), &friction]));
        for scene in blocks.chain([punch(&[&friction])]) {
            let model = discretise(&scene).unwrap();
            let times = scene.time.all();
            let (thick, loading) = thickened(&model.problem, &model.loading);
            let two = run(&model.problem, &model.loading, &times, &ip(&model.problem, &model.loading));
            let three = run(&thick, &loading, &times, &ip(&thick, &loading));
            assert_eq!((two.status, three.status), (Status::Converged, Status::Converged), "mu {mu}");
            assert!(distance(&two.state.p_n, &three.state.p_n) <= 1e-8);
            println!("mu {mu}: {:?} {:?}", iterations(&two), iterations(&three));
            flat.add(&two);
            cone.add(&three);
        }
    }
    println!("(25): {flat}; the exact cone: {cone}");
    assert!(flat.mean() < 0.6 * cone.mean(), "{flat}, {cone}");
}
