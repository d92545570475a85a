//! The paper's figures: the numbers are those of the solution, and the pictures can be read.

use stickslip::solver::ContactStatus;
use stickslip_studies::figures::{self, Descent, FigureData, MU, PaperFigure, Stresses};
use stickslip_studies::tables::PaperMethod;

use super::svg::texts;

/// The rows of a table under its head, every field of the head with its unit.
fn csv<'a>(text: &'a str, head: &str) -> Vec<Vec<&'a str>> {
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some(head));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert!(rows.iter().all(|row| row.len() == head.split(',').count()));
    rows
}

fn number(field: &str) -> f64 {
    field.parse().unwrap()
}

#[track_caller]
fn assert_shows(data: &FigureData, expected: &[&str]) {
    let svg = data.chart().to_svg().unwrap();
    let texts = texts(&svg);
    for text in expected {
        assert!(texts.contains(text), "`{text}` is not in {texts:?}");
    }
}

fn sum(stresses: &Stresses, force: fn(&stickslip::run::report::ContactPoint) -> f64) -> f64 {
    stresses.line.points.iter().map(force).sum()
}

/// Coulomb's law holds at every node, and the resultants come close to those without time error,
/// 5.330137 and -1.023347 MN.
#[test]
fn figure_4() {
    let mut solved = 0;
    let all = figures::punch_stresses(&[1, 20, 100], &mut || solved += 1).unwrap();
    assert_eq!((solved, all.len()), (121, 3));
    for stresses in &all {
        let points = &stresses.line.points;
        assert_eq!(points.len(), 31);
        assert_eq!(points.iter().filter(|p| p.status == ContactStatus::Open).count(), 8);
        for p in points {
            assert!(p.sigma_t.abs() <= MU * p.sigma_n * (1.0 + 1e-9), "{p:?}");
            assert!(p.status != ContactStatus::Slip || p.sigma_t.abs() >= MU * p.sigma_n * (1.0 - 1e-9), "{p:?}");
        }
    }
    let errors = |force, exact: f64| all.iter().map(move |stresses| (sum(stresses, force) - exact).abs());
    let normal: Vec<f64> = errors(|p| p.p_n, 5.330_137e6).collect();
    let tangential: Vec<f64> = errors(|p| p.p_t, -1.023_347e6).collect();
    assert!(normal[2] < 0.1e3 && normal[0] > 10e3, "{normal:?}");
    assert!(tangential[2] < 3e3 && tangential[1] > 5e3 && tangential[0] > 200e3, "{tangential:?}");

    let data = FigureData::PunchStresses(all);
    assert!(data.converged());
    let text = data.to_csv();
    let rows = csv(&text, "increments,time [s],x [m],sigma_n [Pa],sigma_t [Pa]");
    assert_eq!(rows.len(), 3 * 31);
    assert!(rows.iter().all(|row| row[0].parse::<usize>().is_ok() && (0.0..=0.1 + 1e-12).contains(&number(row[2]))));
    assert!(rows.iter().any(|row| (90e6..100e6).contains(&number(row[3]))));
    let labels = ["x, m", "contact stress, MPa", "σₙ, normal", "σₜ, tangential", "stick", "slip"];
    assert_shows(&data, &labels);
    assert_shows(&data, &["(a) 1 increment", "(b) 20 increments", "(c) 100 increments", "μ = 0.4, Algorithm BN"]);
}

/// Both methods begin at the same error norm and fall below the paper's bound; no step of IP is
/// shortened, as the paper says of the safe start.
#[test]
fn figure_5() {
    let all = figures::punch_theta(&mut || ()).unwrap();
    for Descent { method, iterations, .. } in &all {
        assert!(iterations.iter().map(|record| record.iteration).eq(0..iterations.len()), "{method:?}");
        assert!(iterations[0].theta > 1e10 && iterations.last().unwrap().theta <= 1e-2, "{method:?}");
        let before_last = &iterations[..iterations.len() - 1];
        assert!(before_last.iter().all(|record| record.theta > 1e-2), "{method:?}");
    }
    assert_eq!((all[0].method, all[0].iterations.len() - 1), (PaperMethod::Bn, 6));
    assert_eq!(all[1].method, PaperMethod::IpSafe);
    assert!((all[0].iterations[0].theta / all[1].iterations[0].theta - 1.0).abs() < 1e-6);
    assert!(all[1].iterations.iter().all(|record| record.backtracks == 0));

    let data = FigureData::PunchTheta(all);
    let text = data.to_csv();
    let rows = csv(&text, "method,iteration,theta [N^2 and Pa^2],step,backtracks");
    assert!(rows.iter().all(|row| number(row[2]) > 0.0 && number(row[3]) <= 1.0));
    let labels = ["iteration", "error norm Θ (rows in N and Pa)", "10⁻¹⁰", "10¹⁵", "BN", "IP", "IP default"];
    assert_shows(&data, &labels);
}

/// 5 × 5 elements: the sums that the check values of `table_block` make.
#[test]
fn figure_6() {
    let all = figures::block_stresses(5, 5, &mut || ()).unwrap();
    assert_eq!(all.iter().map(|stresses| stresses.line.time).collect::<Vec<_>>(), [1.0, 2.0]);
    for (stresses, [p_n, p_t]) in all.iter().zip([[5.117_647e6, -2.047_059e6], [5.302_096e6, 1.268_765e6]]) {
        assert!((sum(stresses, |p| p.p_n) - p_n).abs() < 1.0 && (sum(stresses, |p| p.p_t) - p_t).abs() < 1.0);
    }
    let data = FigureData::BlockStresses(all);
    let text = data.to_csv();
    assert_eq!(csv(&text, "increments,time [s],x [m],sigma_n [Pa],sigma_t [Pa]").len(), 10);
    assert_shows(&data, &["(a) Q₁ = 10 MN/m, t = 1 s", "(b) Q₁ = 0, t = 2 s", "x, m", "contact stress, MPa"]);
}

#[test]
fn figure_7() {
    let all = figures::block_iterations(5, 5, &mut || ()).unwrap();
    let iterations = |method| -> Vec<usize> {
        let effort = all.iter().find(|effort| effort.method == method).unwrap();
        effort.increments.iter().map(|record| record.iterations).collect()
    };
    assert_eq!(iterations(PaperMethod::Bn), [5, 3, 1, 1, 3, 2, 2, 2, 1, 1]);
    let (safe, prev) = (iterations(PaperMethod::IpSafe), iterations(PaperMethod::IpPrev));
    // In the first increment there is no last solution; safe is steady, prev is not.
    assert_eq!((safe[0], safe.len()), (prev[0], prev.len()));
    let spread = |counts: &[usize]| counts.iter().max().unwrap() - counts.iter().min().unwrap();
    assert!(spread(&safe) <= 7 && spread(&prev) > 7, "{safe:?} {prev:?}");

    let data = FigureData::BlockIterations(all);
    assert!(data.converged() && data.summary().len() == 3);
    let text = data.to_csv();
    let rows = csv(&text, "method,increment,time [s],iterations,backtracks");
    assert_eq!(rows.len(), 30);
    let labels = ["iterations", "increment (1 to 5: Q₁ grows; 6 to 10: Q₁ falls)", "BN", "IP safe", "IP prev"];
    assert_shows(&data, &labels);
}

#[test]
fn figures_have_the_papers_numbers() {
    assert_eq!(PaperFigure::ALL.map(PaperFigure::number), [4, 5, 6, 7]);
}
