//! The parts of Algorithm IP, each against its definition: the direction of (14), the step to the border,
//! the potential (13), both partitions.

use crate::common::prelude::*;
use crate::common::random;
use stickslip::solver::formulation::Constrained;

/// A small block in which a node has friction, one has none, and one cannot slide.
fn model() -> Model {
    let scene = common::block(&["mesh.elements=[5,2]", "contact.friction=0.4"]);
    let mut model = discretise(&scene).unwrap();
    let row = |i: usize| model.problem.c_t().row(i).iter().copied().filter(|_| i != 2).collect::<Vec<_>>();
    let c_t = random::rows(model.problem.displacements(), (0..model.problem.contacts()).map(row));
    model.problem = common::changed(&model.problem, |parts| {
        parts.mu[1] = 0.0;
        parts.c_t = c_t;
    });
    model
}

fn formulation(model: &Model, partition: Partition) -> Constrained {
    let problem = &model.problem;
    let conventions = FormulationScaling::paper(problem.weight().unwrap());
    let mut formulation = Constrained::new(problem, model.scaling(), &conventions, partition);
    let force = model.loading.force_at(0.7, problem).unwrap();
    let w_t_last: Vec<f64> = (0..problem.contacts()).map(|i| 1e-6 * (i as f64).cos()).collect();
    let w_o_last = vec![0.0; w_t_last.len()];
    let increment = Increment {
        force: &force,
        gap: model.loading.gap(),
        mu: problem.mu(),
        w_t_last: &w_t_last,
        w_o_last: &w_o_last,
    };
    formulation.begin(&increment, &vec![0.0; formulation.unknowns()]);
    formulation
}

/// A point inside; `spread` is how many decades the members of its pairs differ by.
fn point(formulation: &Constrained, spread: f64) -> Vec<f64> {
    let mut z: Vec<f64> = (0..formulation.layout().unknowns()).map(|k| (1.0 + k as f64 * 0.7).sin()).collect();
    for (k, pair) in formulation.pairs().iter().enumerate() {
        let tilt = spread * (1.0 + 2.3 * k as f64).sin();
        z[pair.force] = 1.2 * 10_f64.powf(tilt);
        z[pair.length] = 0.8 * 10_f64.powf(-tilt);
    }
    z
}

fn residual(formulation: &Constrained, z: &[f64]) -> Vec<f64> {
    let mut h = vec![0.0; z.len()];
    formulation.residual(z, &mut h).unwrap();
    h
}

/// The direction for the right-hand side `b`.
fn direction(formulation: &mut Constrained, z: &[f64], b: &[f64]) -> Vec<f64> {
    formulation.linearize(z);
    let n = formulation.matrix().order();
    let (mut rhs, mut dz) = (vec![0.0; n], vec![0.0; z.len()]);
    formulation.reduce(z, b, &mut rhs);
    let mut direct = RefinedSolver::default();
    direct.analyze(formulation.matrix()).unwrap();
    direct.factorize(formulation.matrix()).unwrap();
    direct.solve(formulation.matrix(), &rhs, &mut dz[..n]).unwrap();
    formulation.recover(z, b, &mut dz);
    dz
}

/// For any right-hand side, also close to the border: the derivative of `H_I` along the direction is the right-hand
/// side. `H_I` is quadratic, so that central differences are exact but for rounding.
#[test]
fn the_direction_solves_the_linearised_equations() {
    let model = model();
    let mut formulation = formulation(&model, Partition::Products);
    for spread in [0.0, 1.0, 4.0] {
        let z = point(&formulation, spread);
        let b: Vec<f64> = (0..z.len()).map(|k| (2.0 + k as f64 * 1.3).cos()).collect();
        let dz = direction(&mut formulation, &z, &b);
        let step = largest(&z) / largest(&dz);
        let at = |t: f64| z.iter().zip(&dz).map(|(z, dz)| z + t * dz).collect::<Vec<f64>>();
        let (ahead, behind) = (residual(&formulation, &at(step)), residual(&formulation, &at(-step)));
        let rounding = 1e-12 * largest(&ahead).max(largest(&behind)) / step;
        for (row, b) in b.iter().enumerate() {
            let derivative = (ahead[row] - behind[row]) / (2.0 * step);
            assert!((derivative - b).abs() <= rounding, "spread {spread}, row {row}: {derivative} {b} {rounding:e}");
        }
    }
}

/// Along a direction of (14) F shrinks by `1 - t`, `largest_step` is where the first member of Ω₊₊
/// vanishes, and `potential_along` is ψ.
#[test]
fn along_a_direction() {
    let model = model();
    for partition in [Partition::Products, Partition::Cone] {
        let mut formulation = formulation(&model, partition);
        let mut z = point(&formulation, 0.3);
        // Into the cone.
        for k in formulation.layout().cone_rows() {
            z[k] += 3.0;
        }
        let h = residual(&formulation, &z);
        let g: Vec<usize> = formulation.g_rows().collect();
        assert_eq!(g.len(), formulation.n_2());
        assert!(g.iter().all(|&k| h[k] > 0.0));
        let beta = g.iter().map(|&k| h[k]).sum::<f64>() / g.len() as f64;
        assert!((formulation.beta(&h) - beta).abs() <= 1e-15 * beta);
        let centring = 0.3 * beta;
        let mut b: Vec<f64> = h.iter().map(|h| -h).collect();
        for &k in &g {
            b[k] += centring;
        }
        let dz = direction(&mut formulation, &z, &b);
        let ahead = |t: f64| z.iter().zip(&dz).map(|(z, dz)| z + t * dz).collect::<Vec<f64>>();

        let half = residual(&formulation, &ahead(0.5));
        let size = largest(&h);
        for k in (0..h.len()).filter(|k| !g.contains(k)) {
            assert!((half[k] - 0.5 * h[k]).abs() <= 1e-12 * size, "row {k}");
        }

        let inside = |t: f64| {
            let (z, h) = (ahead(t), residual(&formulation, &ahead(t)));
            let pairs = formulation.pairs().iter().all(|pair| z[pair.force] > 0.0 && z[pair.length] > 0.0);
            pairs && (partition == Partition::Products || formulation.layout().cone_rows().all(|k| h[k] > 0.0))
        };
        let longest = formulation.largest_step(&z, &dz, &h, centring);
        assert!(longest.is_finite() && inside(longest * (1.0 - 1e-9)) && !inside(longest * (1.0 + 1e-9)));

        let zeta = 10.0 * g.len() as f64;
        let psi = |t: f64| {
            let h = residual(&formulation, &ahead(t));
            let f = (0..h.len()).filter(|k| !g.contains(k)).map(|k| h[k] * h[k]).sum::<f64>();
            zeta * (f + g.iter().map(|&k| h[k]).sum::<f64>()).ln() - g.iter().map(|&k| h[k].ln()).sum::<f64>()
        };
        let along = formulation.potential_along(zeta, &z, &dz, &h, centring);
        for t in [0.0, 0.3, 0.9].map(|share| share * longest.min(1.0)) {
            assert!(
                (along(t) - psi(t)).abs() <= 1e-10 * psi(t).abs(),
                "{partition:?}, t = {t}: {} {}",
                along(t),
                psi(t)
            );
        }
        // The direction descends.
        assert!(along(1e-6) < along(0.0));
    }
}

/// Algorithm IP with either partition ends at the paper's Theta.
#[test]
fn both_partitions_solve_the_block() {
    let scene = common::block(&["mesh.elements=[10,10]", "time.increments=6"]);
    let model = discretise(&scene).unwrap();
    for partition in [Partition::Products, Partition::Cone] {
        for start in [Start::Safe, Start::PREV] {
            let solver = SolverChoice::new(Method::PaperIp { start, partition });
            let run = Run::of(&model, scene.time.all(), solver).unwrap().history(&mut ()).unwrap();
            assert_eq!(run.status, Status::Converged, "{partition:?} {start:?}");
            assert!(run.records.iter().all(|record| record.theta <= 1e-2));
            assert_eq!(run.linear.analyses, 1);
        }
    }
}
