//! The default settings of BN and IP on scenes far from the paper's: they converge wherever there is an
//! equilibrium, and say so where there is none.

use crate::common::prelude::*;
use stickslip::solver::formulation::{Layout, SlackLayout};

const SUPPORT: &str = "[[support]]\nboundary = \"left\"\nfix = [\"x\", \"y\"]\n";

/// The default settings of both methods.
const METHODS: [&str; 2] = ["bn", "ip"];

fn solve(method: &str, model: &Model, times: &[f64]) -> HistoryOutcome {
    let method = if method == "bn" { Method::BN } else { Method::Ip };
    let settings = settings_of(model, method).until(100, 1e-10);
    let settings = HistorySettings { halvings: 0, ..settings };
    history_of(model, times, &settings, SystemSolver::default(), &mut ())
}

/// Fails unless both methods get through whole increments by themselves, in 40 iterations each and 20
/// on average at most, with the same forces.
fn assert_solved(name: &str, model: &Model, times: &[f64]) {
    assert!(solved(name, model, times, 40) == 0, "{name}: BN needs the interior point method");
}

/// The same within so many iterations, where BN may leave increments to the interior point method; returns
/// how many.
fn solved(name: &str, model: &Model, times: &[f64], at_most: usize) -> usize {
    let [bn, ip] = METHODS.map(|method| {
        let outcome = solve(method, model, times);
        let iterations: Vec<usize> = iterations(&outcome);
        assert_eq!(outcome.status, Status::Converged, "{name}, {method}: {iterations:?} {:?}", outcome.violation);
        let most = *iterations.iter().max().unwrap();
        let mean = iterations.iter().sum::<usize>() as f64 / iterations.len() as f64;
        assert!(most <= at_most && mean <= 20.0, "{name}, {method}: {iterations:?}");
        for record in &outcome.records {
            assert!(record.kkt.worst().1 <= 1e-10, "{name}, {method}");
        }
        outcome
    });
    let loads = model.loading.cases().iter().flat_map(stickslip::solver::LoadCase::force);
    let largest = loads.chain(&bn.state.p_n).fold(f64::MIN_POSITIVE, |m, p| m.max(p.abs()));
    for (bn, ip) in bn.state.p_n.iter().chain(&bn.state.p_t).zip(ip.state.p_n.iter().chain(&ip.state.p_t)) {
        assert!((bn - ip).abs() <= 1e-7 * largest, "{name}: {bn} {ip}");
    }
    bn.records.iter().filter(|record| record.rescued).count()
}

fn block(text: &str, n: usize, overrides: &[&str]) -> (Model, Vec<f64>) {
    let mesh = format!("mesh.elements=[{n},{n}]");
    let all = [&[mesh.as_str(), "time.increments=4"], overrides].concat();
    let scene = parsed_with(text, &all);
    (discretise(&scene).unwrap(), scene.time.all())
}

fn base() -> &'static str {
    BLOCK
}

#[test]
fn gaps_loads_shapes_materials_and_friction() {
    let roller = "support.fix=[\"x\"]";
    let unloaded = ["load[0].traction=[0,0]", "load[1].traction=[0,0]"];
    let loads_times = |factor: f64| {
        let traction = -10e6 * factor;
        [format!("load[0].traction=[0,{traction:e}]"), format!("load[1].traction=[{traction:e},0]")]
    };
    let scaled = [1e3, 1e-3, 1e6].map(loads_times);
    let scaled: Vec<Vec<&str>> = scaled.iter().map(|pair| pair.iter().map(String::as_str).collect()).collect();
    for n in [10, 20] {
        for (name, overrides) in [
            ("no contact", vec!["contact.obstacle.gap=1"]),
            ("no contact by far", vec!["contact.obstacle.gap=1e3"]),
            ("no load", unloaded.to_vec()),
            ("zero gap", vec!["contact.obstacle.gap=0"]),
            ("no load, zero gap", [&unloaded[..], &["contact.obstacle.gap=0"]].concat()),
            ("interference", vec!["contact.obstacle.gap=-1e-5", roller]),
            ("load times 1e3", scaled[0].clone()),
            ("load times 1e-3", scaled[1].clone()),
            ("load times 1e6", scaled[2].clone()),
            ("soft", vec!["material.young=2.1e5"]),
            ("nearly incompressible", vec!["material.poisson=0.4999"]),
            ("1000 m x 1 m", vec!["mesh.size=[1000,1]"]),
            ("1 m x 1000 m", vec!["mesh.size=[1,1000]"]),
            ("1000 m x 1 m, 200 x 4", vec!["mesh.size=[1000,1]", "mesh.elements=[200,4]"]),
            ("1 m x 1000 m, 4 x 200", vec!["mesh.size=[1,1000]", "mesh.elements=[4,200]"]),
            ("mu = 0", vec!["contact.friction=0"]),
            ("mu = 1e-6", vec!["contact.friction=1e-6"]),
            ("mu = 1", vec!["contact.friction=1"]),
            ("mu = 2", vec!["contact.friction=2"]),
            ("mu = 5", vec!["contact.friction=5"]),
            ("mu = 10", vec!["contact.friction=10"]),
            ("held by a roller and contact", vec![roller]),
        ] {
            let (model, times) = block(base(), n, &overrides);
            assert_solved(&format!("{name}, n = {n}"), &model, &times);
        }
    }
}

#[test]
fn held_by_contact_only() {
    let text = base().replace(SUPPORT, "");
    assert!(!text.contains("[[support]]"));
    for gap in ["contact.obstacle.gap=1e-5", "contact.obstacle.gap=0"] {
        let (model, times) = block(&text, 10, &[gap, "load[1].traction=[-1e6,0]"]);
        assert_eq!(model.problem.rigid_modes().len(), 3);
        assert_solved(gap, &model, &times);
    }
}

/// r is no part of the problem: wrong by as much as this, it costs iterations, or BN leaves the increment
/// to the interior point method, but the solution is the same.
#[test]
fn r_does_not_matter() {
    let (model, times) = block(base(), 20, &[]);
    let with = |factor: f64| {
        let mut settings = settings_of(&model, Method::BN).until(200, 1e-10);
        settings.conventions.scale_r(factor);
        let outcome = history_of(&model, &times, &settings, SystemSolver::default(), &mut ());
        assert_eq!(outcome.status, Status::Converged, "{factor:e}: {:?}", outcome.violation);
        outcome.state
    };
    let expected = with(1.0);
    for factor in [1e-8, 1e-6, 1e-4, 1e-3, 1e-2, 0.1, 10.0, 1e2, 1e3, 1e4, 1e6, 1e8] {
        let found = with(factor);
        assert!(forces_apart(&found, &expected) <= 1e-9, "{factor:e}: {:e}", forces_apart(&found, &expected));
    }
}

/// Gives every element a modulus of its own, over so many decades.
fn randomise_stiffness(model: &mut Model, decades: f64, random: &mut Random) {
    let young: Vec<f64> =
        model.mesh.cells.iter().map(|_| 210e9 * 10_f64.powf(decades * (random.next() - 0.5))).collect();
    let material = |element| Elasticity::isotropic(young[element], 0.3);
    let stiffness = assemble(&model.mesh, &model.constraints.dofs, Element::Bilinear, material).unwrap();
    model.problem = common::changed(&model.problem, |parts| parts.stiffness = stiffness.into());
}

/// Stiffness that jumps by up to eight decades from element to element.
#[test]
fn random_stiffness() {
    let mut random = Random(1);
    let mut rescued = 0;
    for sample in 0..8 {
        let (mut model, times) = block(base(), 12, &[]);
        randomise_stiffness(&mut model, 8.0, &mut random);
        rescued += solved(&format!("sample {sample}"), &model, &times, 60);
    }
    assert!(rescued <= 2, "of 32 increments: {rescued}");
}

/// Histories in which everything is random: mesh, shape, loads that turn, gaps (none, small, negative),
/// friction by node, stiffness in some.
#[test]
fn random_histories() {
    // The last four are hard for the interior point method, the three before for BN, which leaves
    // increments of them to it.
    for seed in (0..60).chain([241, 364, 407]).chain([614, 1088, 1122, 1290_u64]) {
        let mut random = Random(seed * 7919 + 13);
        let mut r = || random.next();
        let (nx, ny) = (1 + (r() * 14.0) as usize, 1 + (r() * 10.0) as usize);
        let roller = r() < 0.3;
        let mut overrides = vec![
            format!("mesh.elements=[{nx},{ny}]"),
            format!("mesh.size=[{},{}]", 10_f64.powf(2.0 * r() - 1.0), 10_f64.powf(2.0 * r() - 1.0)),
            "time.increments=8".to_string(),
        ];
        let mut history = |of: fn(f64) -> f64| {
            let points = [0.0, 0.5, 1.0, 1.5, 2.0].map(|t| format!("[{t},{}]", if t == 0.0 { 0.0 } else { of(r()) }));
            format!("[{}]", points.join(","))
        };
        overrides.push(format!("load[0].history={}", history(|x| x)));
        overrides.push(format!("load[1].history={}", history(|x| 2.0 * x - 1.0)));
        let (down, side) = (10_f64.powf(r()), 10_f64.powf(2.0 * r() - 1.0));
        overrides.push(format!("load[0].traction=[0,{}]", -down * 1e7));
        overrides.push(format!("load[1].traction=[{},{}]", side * 1e7, if roller { 0.0 } else { (r() - 0.5) * 1e7 }));
        if roller {
            overrides.push("support.fix=[\"x\"]".to_string());
        }
        let scene = parsed_with(base(), &overrides.iter().map(String::as_str).collect::<Vec<_>>());
        let mut model = discretise(&scene).unwrap();
        let kind = (r() * 4.0) as usize;
        let (mut friction, mut gaps) = (Vec::new(), Vec::new());
        for _ in 0..model.contact.nodes.len() {
            friction.push(match kind {
                0 => 0.4,
                1 => r(),
                2 => [0.0, r()][usize::from(r() >= 0.5)],
                _ => 10_f64.powf(-6.0 * r()),
            });
            let depth = r() - if roller { 0.3 } else { 0.0 };
            gaps.push([1e-5, 0.0, 5e-5 * depth][(r() * 3.0) as usize]);
        }
        model.problem = common::changed(&model.problem, |parts| parts.mu = friction);
        model.loading = Loading::new(model.loading.cases().to_vec(), gaps).unwrap();
        if r() < 0.3 {
            let decades = 6.0 * r();
            randomise_stiffness(&mut model, decades, &mut random);
        }
        for method in METHODS {
            let outcome = solve(method, &model, &scene.time.all());
            let iterations: Vec<usize> = iterations(&outcome);
            assert_eq!(
                outcome.status,
                Status::Converged,
                "{method}, seed {seed}: {iterations:?} {:?}",
                outcome.violation
            );
            assert!(iterations.iter().all(|&count| count <= 60), "{method}, seed {seed}: {iterations:?}");
        }
    }
}

#[test]
fn friction_that_differs_by_node() {
    let (mut model, times) = block(base(), 20, &[]);
    let mu = [0.0, 0.1, 2.0, 0.4, 1e-6];
    model.problem = common::changed(&model.problem, |parts| {
        parts.mu.iter_mut().enumerate().for_each(|(i, value)| *value = mu[i % mu.len()]);
    });
    assert_solved("mixed", &model, &times);
}

#[test]
fn without_friction_there_are_no_multipliers() {
    let (model, _) = block(base(), 10, &["contact.friction=0"]);
    let problem = &model.problem;
    let layout = SlackLayout::new(&Layout::new(problem));
    assert_eq!(layout.unknowns(), problem.displacements() + 2 * problem.contacts());
}

/// A side load of 0.6 of the normal load with mu = 0.4: no contact force can balance it, and either
/// method says so and names the motion. At 0.39 it can.
#[test]
fn no_equilibrium() {
    let text = base().replace(SUPPORT, "");
    let run = |side: &str| {
        let (model, times) = block(&text, 8, &["contact.obstacle.gap=0", "load[0].history=[[0,1]]", side]);
        let paper = settings_of(&model, Method::PaperBn).until(100, 1e-10);
        let bn = history_of(&model, &times, &paper, SystemSolver::default(), &mut ());
        let [default, ip] = METHODS.map(|method| solve(method, &model, &times));
        (model, [bn, default, ip])
    };
    let (model, outcomes) = run("load[1].traction=[-6e6,0]");
    for outcome in outcomes {
        assert_eq!(outcome.status, Status::Slips);
        let motion = RigidMotion::combination(&model.constraints.rigid_motions, &outcome.free_motion.unwrap()).unwrap();
        assert!(motion.to_string().contains("translation"), "{motion}");
    }
    let (model, times) =
        block(&text, 8, &["contact.obstacle.gap=0", "load[0].history=[[0,1]]", "load[1].traction=[-3.0e6,0]"]);
    assert_solved("below the limit", &model, &times);
}
