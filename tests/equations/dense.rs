//! The dense solver against a sparse LU, matrix by matrix.

use crate::common::prelude::*;
use stickslip::algebra::DenseSymmetric;
use stickslip::algebra::linear::{Dense, backward_error};
use stickslip::solver::formulation::Constrained;
use stickslip::solver::{NormalCase, TangentialCase};

/// A matrix with these entries, the first `displacements` rows and columns of which are stored as a dense block.
fn matrix(n: usize, displacements: usize, entries: &[(usize, usize, f64)]) -> SystemMatrix {
    let mut values = vec![0.0; displacements * displacements];
    let (block, beside): (Vec<_>, Vec<_>) = entries.iter().partition(|e| e.0.max(e.1) < displacements);
    for &(row, column, value) in block {
        values[column * displacements + row] = value;
    }
    let pattern = Pattern::from_entries(n, n, |take| beside.iter().for_each(|e| take(e.0, e.1))).unwrap();
    let mut rest = Csc::zeros(Arc::new(pattern));
    for &(row, column, value) in beside {
        let slot = rest.pattern().slot(row, column).unwrap();
        rest.values_mut()[slot] = value;
    }
    SystemMatrix::new(DenseSymmetric::from_lower(displacements, values).unwrap(), rest).unwrap()
}

/// A chain of `n` springs, held at its beginning if `held`, with a contact force at its end, and
/// the contact row `by_u du + by_p dp`.
fn chain(n: usize, held: f64, [by_u, by_p]: [f64; 2]) -> SystemMatrix {
    let mut entries = vec![(n - 1, n, 1.0), (n, n - 1, by_u), (n, n, by_p)];
    for i in 0..n {
        let ends = usize::from(i > 0) + usize::from(i + 1 < n);
        entries.push((i, i, ends as f64 + if i == 0 { held } else { 0.0 }));
        if i > 0 {
            entries.extend([(i - 1, i, -1.0), (i, i - 1, -1.0)]);
        }
    }
    matrix(n + 1, n, &entries)
}

fn right_hand_side(n: usize) -> Vec<f64> {
    (0..n).map(|i| (1.0 + 0.7 * i as f64).sin()).collect()
}

/// Solves with `solver` and with a sparse LU, and returns the order of the dense part.
fn compare(solver: &mut Dense, a: &SystemMatrix, tolerance: f64) -> usize {
    let n = a.order();
    let b = right_hand_side(n);
    // Unrefined, so that stale or wrong factors would show.
    let mut x = vec![0.0; n];
    solver.factorize_system(a).unwrap();
    solver.solve(&b, &mut x).unwrap();
    let error = backward_error(a, &b, &x).unwrap();
    assert!(error < 1e-9, "{error:e}");

    let refined = |mut direct: RefinedSolver| {
        let mut x = vec![0.0; n];
        direct.analyze(a).unwrap();
        direct.factorize(a).unwrap();
        let info = direct.solve(a, &b, &mut x).unwrap();
        assert!(info.backward_error <= 1e-15, "{}: {info:?}", direct.name());
        x
    };
    let (x, y) = (refined(RefinedSolver::new(Box::new(Dense::default()))), refined(RefinedSolver::default()));
    assert!(apart(&x, &y) <= tolerance, "{:e}", apart(&x, &y));
    // The flops are 2/3 of the order cubed.
    let info = solver.factorize_system(a).unwrap();
    assert!(info.pivot_ratio > 0.0);
    (1.5 * info.flops).cbrt().round() as usize
}

fn condensed(model: &Model) -> ContactProblem {
    Condensed::new(&model.problem, &model.loading, SparseCholesky::default()).unwrap().problem
}

fn bdiff(model: &Model, condensed: &ContactProblem) -> Bdiff {
    Bdiff::new(condensed, model.scaling(), &FormulationScaling::natural(&model.problem))
}

/// Open, sticking and slipping nodes by thirds, in turn or in a row; then cases that only iterates
/// show. Returns the orders of the dense parts.
fn mixed_states(model: &Model, tolerance: f64) -> Vec<usize> {
    let n_c = model.problem.contacts();
    let sign = |i: usize| if i.is_multiple_of(2) { 1.0 } else { -1.0 };
    let slip = |i: usize| TangentialCase::Slip { direction: [sign(i), 0.0], turning: [[0.0; 2]; 2] };
    let case = |third: usize, i: usize| match third {
        0 => (NormalCase::Open, TangentialCase::NoPressure),
        1 => (NormalCase::Closed, TangentialCase::Stick),
        _ => (NormalCase::Closed, slip(i)),
    };
    let odd = |i: usize| match i % 4 {
        0 => (NormalCase::Closed, TangentialCase::NoPressure),
        1 => (NormalCase::Open, TangentialCase::Stick),
        2 => (NormalCase::Open, slip(i)),
        _ => (NormalCase::Closed, TangentialCase::Stick),
    };
    let states: [Vec<_>; 6] = [
        (0..n_c).map(|i| case(i % 3, i)).collect(),
        (0..n_c).map(|i| case(3 * i / n_c, i)).collect(),
        (0..n_c).map(|i| case(1, i)).collect(),
        (0..n_c).map(|i| case(2, i)).collect(),
        (0..n_c).map(odd).collect(),
        (0..n_c).map(|i| case(usize::from(i < 4), i)).collect(),
    ];
    let condensed = condensed(model);
    let mut formulation = bdiff(model, &condensed);
    let mut solver = Dense::default();
    solver.analyze_system(formulation.jacobian()).unwrap();
    let orders = states.into_iter().map(|state| {
        formulation.set_cases(state);
        // Where nothing holds the body there is nothing to compare.
        let held = formulation.unconstrained_mode().is_none();
        held.then(|| compare(&mut solver, formulation.jacobian(), tolerance))
    });
    orders.flatten().collect()
}

#[test]
fn the_order_is_what_contact_leaves_free() {
    let model = model_with(BLOCK, &["mesh.elements=[12,12]"]);
    assert_eq!(mixed_states(&model, 1e-12), [12, 12, 0, 12, 12, 16]);
    let smooth = self::model_with(BLOCK, &["mesh.elements=[12,12]", "contact.friction=0.0"]);
    // Without friction no contact row names the tangential displacements.
    assert_eq!(mixed_states(&smooth, 1e-12), [4, 4, 0, 0, 6, 8]);
}

#[test]
fn oblique_obstacles() {
    for normal in ["[-0.3,-1.0]", "[0.8,-0.6]", "[0.001,-1.0]"] {
        let model = model_with(BLOCK, &["mesh.elements=[12,9]", &format!("contact.obstacle.normal={normal}")]);
        assert_eq!(mixed_states(&model, 1e-12), [12, 12, 0, 12, 12, 16]);
    }
}

/// Obstacles on two sides share a corner, whose unknowns make one group. Its rows depend on each other, so that its two
/// displacements stay.
#[test]
fn two_obstacles_at_a_node() {
    let other = "[[contact]]\nboundary = \"right\"\nfriction = 0.3\nobstacle = { kind = \"plane\" }\n\n[[load]]";
    let model = model_with(&BLOCK.replacen("[[load]]", other, 1), &["mesh.elements=[6,6]", "contact[0].friction=0.4"]);
    let orders = mixed_states(&model, 1e-12);
    assert_eq!(orders[2], 2);
}

/// What holds a body without supports is contact alone: its K is singular, on the outside only.
#[test]
fn a_body_held_by_contact() {
    let support = "[[support]]\nboundary = \"left\"\nfix = [\"x\", \"y\"]\n";
    for (text, kind) in [(BLOCK.replace(support, ""), 3), (BLOCK.replace("\"x\", \"y\"", "\"x\""), 1)] {
        let model = model_with(&text, &["mesh.elements=[10,10]"]);
        assert_eq!(model.problem.rigid_modes().len(), kind);
        assert!(mixed_states(&model, 1e-11).len() >= 4);
        // With every node open nothing holds it.
        let condensed = condensed(&model);
        let mut formulation = bdiff(&model, &condensed);
        formulation.set_cases(vec![(NormalCase::Open, TangentialCase::NoPressure); model.problem.contacts()]);
        let mut solver = Dense::default();
        solver.analyze_system(formulation.jacobian()).unwrap();
        let singular = solver.factorize_system(formulation.jacobian());
        assert!(matches!(singular, Err(LinearError::Singular { .. })), "{singular:?}");
    }
}

/// Rows that hold displacements and forces, whose sizes differ by many decades.
#[test]
fn matrices_of_an_interior_point_method() {
    let model = model_with(BLOCK, &["mesh.elements=[10,10]"]);
    let conventions = FormulationScaling::paper(model.problem.weight().unwrap());
    let condensed = condensed(&model);
    let mut formulation = Constrained::new(&condensed, model.scaling(), &conventions, Partition::Products);
    let mut solver = Dense::default();
    solver.analyze_system(formulation.matrix()).unwrap();
    for spread in [0.0, 1.0, 3.0, 5.0] {
        let mut z = vec![0.0; formulation.layout().unknowns()];
        for (k, pair) in formulation.pairs().iter().enumerate() {
            let tilt = spread * (1.0 + 2.3 * k as f64).sin();
            (z[pair.force], z[pair.length]) = (1.2 * 10_f64.powf(tilt), 0.8 * 10_f64.powf(-tilt));
        }
        formulation.linearize(&z);
        assert_eq!(compare(&mut solver, formulation.matrix(), 1e-9), 20);
    }
}

/// A stiffness that is not dense has zeros where nothing is stored, and displacements that no contact
/// row names are groups of their own.
#[test]
fn a_chain_of_springs() {
    let n = 12;
    let mut solver = Dense::default();
    solver.analyze_system(&chain(n, 1.0, [1.0, 0.0])).unwrap();
    for (rows, order) in [([1.0, 0.0], n - 1), ([0.0, -1.0], n), ([3.0, 0.5], n)] {
        assert_eq!(compare(&mut solver, &chain(n, 1.0, rows), 1e-13), order);
    }
}

#[test]
fn errors() {
    let n = 4;
    let a = chain(n, 1.0, [1.0, 0.0]);
    let mut solver = Dense::default();
    let mut x = vec![0.0; n + 1];
    assert!(matches!(solver.factorize_system(&a), Err(LinearError::Order { missing: "analyze" })));
    solver.analyze_system(&a).unwrap();
    assert!(matches!(solver.solve(&[1.0; 5], &mut x), Err(LinearError::Order { missing: "factorize" })));
    for other in [chain(n + 1, 1.0, [1.0, 0.0]), matrix(n + 1, n, &[]), a.rest().clone().into()] {
        assert!(matches!(solver.factorize_system(&other), Err(LinearError::Shape { .. })));
    }
    solver.factorize_system(&a).unwrap();
    assert!(matches!(solver.solve(&[1.0; 4], &mut x), Err(LinearError::Shape { .. })));
    assert!(matches!(solver.solve(&[1.0; 5], &mut x[1..]), Err(LinearError::Shape { .. })));
    let wide = SystemMatrix::from(Csc::from_triplets(2, 3, &[(0, 1, 1.0)]).unwrap());
    assert!(matches!(Dense::default().analyze_system(&wide), Err(LinearError::Shape { .. })));

    // Neither row holds anything; the chain is held by nothing; an entry is no number.
    for (a, not_finite) in [
        (chain(n, 1.0, [0.0, 0.0]), false),
        (chain(n, 0.0, [0.0, -1.0]), false),
        (chain(n, 1.0, [f64::NAN, 0.0]), true),
    ] {
        let error = solver.factorize_system(&a).unwrap_err();
        assert!(matches!((error, not_finite), (LinearError::Singular { .. }, false) | (LinearError::NotFinite, true)));
        // A failed factorisation leaves no stale factors behind.
        assert!(matches!(solver.solve(&[1.0; 5], &mut x), Err(LinearError::Order { .. })));
    }
    // An interior that no contact can hold: a second chain, free and apart.
    let mut entries: Vec<_> = [(0, 0, 1.0), (1, 1, 1.0), (2, 2, 1.0), (1, 2, -1.0), (2, 1, -1.0)].to_vec();
    entries.extend([(0, 3, 1.0), (3, 0, 1.0), (3, 3, 0.0)]);
    let apart = matrix(4, 3, &entries);
    let mut solver = Dense::default();
    solver.analyze_system(&apart).unwrap();
    assert!(matches!(solver.factorize_system(&apart), Err(LinearError::Singular { .. })));
}

#[test]
fn without_contact_and_without_a_body() {
    let springs = matrix(2, 2, &[(0, 0, 2.0), (1, 1, 3.0), (0, 1, -1.0), (1, 0, -1.0)]);
    let mut solver = Dense::default();
    solver.analyze_system(&springs).unwrap();
    assert_eq!(compare(&mut solver, &springs, 1e-15), 2);
    let forces = matrix(2, 0, &[(0, 0, 2.0), (1, 1, 3.0), (0, 1, -1.0)]);
    let mut solver = Dense::default();
    solver.analyze_system(&forces).unwrap();
    let mut x = [0.0; 2];
    solver.factorize_system(&forces).unwrap();
    solver.solve(&[1.0, 6.0], &mut x).unwrap();
    assert_eq!(x, [1.5, 2.0]);
}

/// Springs on single displacements of the dense block, and no contact where they stand.
#[test]
fn springs_on_the_diagonal() {
    let a = chain(5, 0.0, [0.0, -1.0]);
    let mut entries: Vec<_> = a.rest().entries().chain([(2, 2, 3.0), (4, 4, 0.5)]).collect();
    let held = SystemMatrix::new(a.leading().unwrap().clone(), Csc::from_triplets(6, 6, &entries).unwrap()).unwrap();
    let mut solver = Dense::default();
    solver.analyze_system(&held).unwrap();
    assert_eq!(compare(&mut solver, &held, 1e-13), 5);
    // On a displacement with a contact row that holds it, too.
    entries.retain(|entry| entry.0 < 5 || entry.1 < 4);
    entries.extend([(5, 4, 2.0)]);
    let held = SystemMatrix::new(a.leading().unwrap().clone(), Csc::from_triplets(6, 6, &entries).unwrap()).unwrap();
    solver.analyze_system(&held).unwrap();
    assert_eq!(compare(&mut solver, &held, 1e-13), 4);
}

/// What is kept of the last factors is of use only where nothing has changed: statuses that change one at a time leave no trace.
#[test]
fn statuses_that_change_one_at_a_time() {
    let model = model_with(BLOCK, &["mesh.elements=[12,9]", "contact.obstacle.normal=[-0.3,-1.0]"]);
    let condensed = condensed(&model);
    let mut formulation = bdiff(&model, &condensed);
    let mut kept = Dense::default();
    kept.analyze_system(formulation.jacobian()).unwrap();
    let (n, n_c) = (formulation.unknowns(), model.problem.contacts());
    let b = right_hand_side(n);
    let mut cases = vec![(NormalCase::Open, TangentialCase::NoPressure); n_c];
    for change in 0..3 * n_c {
        cases[5 * change % n_c] = match change % 4 {
            0 => (NormalCase::Closed, TangentialCase::Stick),
            1 => (NormalCase::Closed, TangentialCase::Slip { direction: [1.0, 0.0], turning: [[0.0; 2]; 2] }),
            2 => (NormalCase::Closed, TangentialCase::Slip { direction: [-1.0, 0.0], turning: [[0.0; 2]; 2] }),
            _ => (NormalCase::Open, TangentialCase::NoPressure),
        };
        formulation.set_cases(cases.clone());
        let mut fresh = Dense::default();
        fresh.analyze_system(formulation.jacobian()).unwrap();
        let solutions = [&mut kept, &mut fresh].map(|solver| {
            let mut x = vec![0.0; n];
            let info = solver.factorize_system(formulation.jacobian()).unwrap();
            solver.solve(&b, &mut x).unwrap();
            (info, x)
        });
        assert_eq!(solutions[0], solutions[1], "{change}");
    }
}

/// As large as threads share the work: the dense kernels differ by rounding, and all else not at all.
#[test]
fn any_number_of_threads() {
    let n = 450;
    let entry =
        |i: usize, j: usize| if i == j { 4.0 } else { (0.3 * (i * j) as f64).sin() / (1 + i.abs_diff(j)) as f64 };
    let values = (0..n * n).map(|k| entry(k % n, k / n)).collect();
    // A contact force at every tenth displacement, on which it depends.
    let contact = |k: usize| [(10 * k, n + k, 1.0), (n + k, 10 * k, 0.5), (n + k, n + k, -1.0)];
    let entries: Vec<_> = (0..n / 10).flat_map(contact).collect();
    let size = n + n / 10;
    let rest = Csc::from_triplets(size, size, &entries).unwrap();
    let a = SystemMatrix::new(DenseSymmetric::from_lower(n, values).unwrap(), rest).unwrap();
    let b = right_hand_side(size);
    let solved = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let (mut direct, mut x) = (RefinedSolver::new(Box::new(Dense::default())), vec![0.0; size]);
            direct.analyze(&a).unwrap();
            assert_eq!((1.5 * direct.factorize(&a).unwrap().flops).cbrt().round() as usize, n);
            let info = direct.solve(&a, &b, &mut x).unwrap();
            assert!(info.backward_error <= 1e-15, "{info:?}");
            x
        })
    };
    let one = solved(1);
    for threads in [2, 3] {
        assert!(apart(&solved(threads), &one) <= 1e-12, "{threads}");
    }
}
