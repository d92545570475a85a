//! The Cholesky factors of every backend that is built in: border last, Schur complement, reduction and
//! completion, against dense elimination and against each other.

#![cfg(any(feature = "umfpack", feature = "faer"))]

use crate::common::prelude::*;
use crate::common::random::draw;
use stickslip::algebra::linear::Cholesky;

type Factor = fn(&Symmetric, &[usize]) -> Result<Cholesky, LinearError>;

const BACKENDS: &[Factor] = &[
    #[cfg(feature = "umfpack")]
    Cholesky::cholmod,
    #[cfg(feature = "faer")]
    Cholesky::faer,
];

fn vector(n: usize, mut seed: u64) -> Vec<f64> {
    (0..n).map(|_| draw(&mut seed)).collect()
}

/// Diagonally dominant with about a fifth of the entries.
fn random(n: usize, mut seed: u64) -> Symmetric {
    let mut entries = Vec::new();
    let mut diagonal = vec![0.1; n];
    for i in 0..n {
        for j in 0..i {
            if draw(&mut seed) > 0.6 {
                let value = draw(&mut seed);
                entries.push((i, j, value));
                diagonal[i] += value.abs();
                diagonal[j] += value.abs();
            }
        }
    }
    entries.extend(diagonal.iter().enumerate().map(|(i, &value)| (i, i, value)));
    from(n, &entries)
}

fn from(n: usize, entries: &[(usize, usize, f64)]) -> Symmetric {
    let mut k = Symmetric::from_entries(n, |take| entries.iter().for_each(|&(i, j, _)| take(i, j))).unwrap();
    for &(i, j, value) in entries.iter().filter(|(i, j, _)| i >= j) {
        k.add(i, j, value).unwrap();
    }
    k
}

/// The Laplacian on a grid of `nx` × `ny` nodes, nine points a row, held above the top.
fn laplacian(nx: usize, ny: usize) -> Symmetric {
    let mut entries = Vec::new();
    for (i, j) in (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j))) {
        let mut diagonal = if j + 1 == ny { 3.0 } else { 0.0 };
        for (p, q) in
            (j.saturating_sub(1)..ny.min(j + 2)).flat_map(|q| (i.saturating_sub(1)..nx.min(i + 2)).map(move |p| (p, q)))
        {
            if (p, q) != (i, j) {
                diagonal += 1.0;
                if q * nx + p < j * nx + i {
                    entries.push((j * nx + i, q * nx + p, -1.0));
                }
            }
        }
        entries.push((j * nx + i, j * nx + i, diagonal));
    }
    from(nx * ny, &entries)
}

/// The Schur complement of `last` by eliminating the others one by one, column-major.
fn schur(k: &Symmetric, last: &[usize]) -> Vec<f64> {
    let n = k.order();
    let mut a = vec![0.0; n * n];
    k.entries().for_each(|(i, j, value)| a[j * n + i] = value);
    let mut left: Vec<usize> = (0..n).collect();
    for p in (0..n).filter(|p| !last.contains(p)) {
        left.retain(|&i| i != p);
        for &j in &left {
            let factor = a[j * n + p] / a[p * n + p];
            for &i in &left {
                a[j * n + i] -= a[p * n + i] * factor;
            }
        }
    }
    last.iter().flat_map(|&j| last.iter().map(move |&i| (i, j))).map(|(i, j)| a[j * n + i]).collect()
}

/// `L Lᵀ` of a column-major lower triangle, which must be zero above the diagonal.
fn square(l: &[f64], m: usize) -> Vec<f64> {
    assert!((0..m).all(|j| (0..j).all(|i| l[j * m + i] == 0.0)));
    let dot = |i, j| (0..m).map(|k: usize| l[k * m + i] * l[k * m + j]).sum();
    (0..m).flat_map(|j| (0..m).map(move |i| (i, j))).map(|(i, j)| dot(i, j)).collect()
}

/// `‖b - K x‖ / (‖K‖ ‖x‖ + ‖b‖)`, largest entries and row sums.
fn error(k: &Symmetric, b: &[f64], x: &[f64]) -> f64 {
    let (kx, mut sums) = (k.times(x).unwrap(), vec![0.0; b.len()]);
    k.entries().for_each(|(i, _, value)| sums[i] += value.abs());
    let residual: Vec<f64> = b.iter().zip(&kx).map(|(b, kx)| b - kx).collect();
    largest(&residual) / (largest(&sums) * largest(x) + largest(b)).max(f64::MIN_POSITIVE)
}

fn close(a: &[f64], b: &[f64], tolerance: f64) {
    assert_eq!(a.len(), b.len());
    let scale = b.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
    let worst = a.iter().zip(b).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
    assert!(worst <= tolerance * scale, "{worst:e} against {scale:e}");
}

/// Everything a caller may ask of one matrix, from every backend; they agree.
fn exercise(k: &Symmetric, last: &[usize]) {
    let solutions: Vec<_> = BACKENDS.iter().map(|&factor| exercise_one(factor, k, last)).collect();
    for (s, x) in &solutions {
        close(s, &solutions[0].0, 1e-13);
        close(x, &solutions[0].1, 1e-11);
    }
}

/// The Schur complement and a solution, by one backend.
fn exercise_one(of: Factor, k: &Symmetric, last: &[usize]) -> (Vec<f64>, Vec<f64>) {
    let (n, m) = (k.order(), last.len());
    let factor = of(k, last).unwrap();
    assert_eq!(factor.order(), n);
    let s = square(&factor.trailing(), m);
    if n <= 100 {
        close(&s, &schur(k, last), 1e-13);
    }
    let (b, mut x, mut y) = (vector(n, 7), vec![0.0; n], vec![0.0; n]);
    factor.solve(&b, &mut x).unwrap();
    assert!(error(k, &b, &x) <= 1e-15);
    // The border by its own factors, which knows nothing of the interior.
    let pairs: Vec<_> = (0..m).flat_map(|j| (0..m).map(move |i| (i, j))).collect();
    let entries: Vec<_> = pairs.iter().zip(&s).map(|(&(i, j), &value)| (i, j, value)).collect();
    let reduced = factor.reduce(&b).unwrap();
    let mut x_c = vec![0.0; m];
    of(&from(m, &entries), &[]).unwrap().solve(&reduced.border, &mut x_c).unwrap();
    factor.expand(&reduced, &x_c, &mut y).unwrap();
    assert!(last.iter().zip(&x_c).all(|(&unknown, &value)| y[unknown] == value));
    assert!(error(k, &b, &y) <= 1e-15);
    close(&x, &y, 1e-11);
    (s, x)
}

#[test]
fn scattered_unknowns_come_last() {
    for seed in 0..20 {
        exercise(&random(60, seed), &[31, 4, 59, 0, 17, 18, 44]);
    }
}

#[test]
fn empty_cases() {
    let k = random(25, 3);
    exercise(&k, &[]);
    exercise(&k, &(0..25).rev().collect::<Vec<_>>());
    exercise(&from(0, &[]), &[]);
    exercise(&from(1, &[(0, 0, 4.0)]), &[0]);
    for factor in BACKENDS {
        assert_eq!(factor(&from(1, &[(0, 0, 4.0)]), &[0]).unwrap().trailing(), [2.0]);
    }
    exercise(&from(3, &[(0, 0, 1.0), (1, 1, 2.0), (2, 2, 3.0)]), &[1]);
}

#[test]
fn a_grid_on_its_bottom_row() {
    let k = laplacian(60, 60);
    exercise(&k, &(0..60).collect::<Vec<_>>());
    for factor in BACKENDS {
        let info = factor(&k, &[]).unwrap().info();
        assert!(info.entries > k.lower().pattern().len() && info.entries < 200_000, "{info:?}");
        assert!(info.flops > info.entries as f64 && info.peak_bytes > 8.0 * info.entries as f64, "{info:?}");
        assert!(info.pivot_ratio > 1e-4 && info.pivot_ratio < 1.0, "{info:?}");
    }
}

/// Large factors are swept in branches, and the rows of wide supernodes in parts.
#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let with = |threads: usize| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    for (k, last) in [(laplacian(140, 140), 140), (random(1400, 7), 60)] {
        let n = k.order();
        let (last, b) = ((0..last).collect::<Vec<_>>(), vector(n, 5));
        for factor in BACKENDS {
            let factor = factor(&k, &last).unwrap();
            let sweeps = || {
                let (mut x, mut completed) = (vec![0.0; n], vec![0.0; n]);
                factor.solve(&b, &mut x).unwrap();
                let reduced = factor.reduce(&b).unwrap();
                let border: Vec<f64> = last.iter().map(|&i| x[i]).collect();
                factor.expand(&reduced, &border, &mut completed).unwrap();
                (x, reduced.border, completed)
            };
            let found = with(1).install(sweeps);
            assert_eq!(with(3).install(sweeps), found);
            close(&k.times(&found.0).unwrap(), &b, 1e-11);
            close(&found.2, &found.0, 1e-11);
        }
    }
}

#[test]
fn what_cannot_be_factored() {
    for factor in BACKENDS {
        let singular = |k: &Symmetric, last: &[usize]| {
            assert!(matches!(factor(k, last), Err(LinearError::Singular { pivot_ratio: 0.0 })));
        };
        let indefinite = from(3, &[(0, 0, 1.0), (1, 0, 2.0), (1, 1, 1.0), (2, 2, 1.0)]);
        for last in [&[][..], &[0], &[1], &[0, 1], &[2, 1, 0]] {
            singular(&indefinite, last);
        }
        singular(&from(2, &[(0, 0, 1.0)]), &[1]);
        singular(&from(2, &[(0, 0, 1.0), (1, 0, 1.0), (1, 1, 1.0)]), &[]);
        singular(&from(2, &[(0, 0, 0.0), (1, 1, 1.0)]), &[]);
        for bad in [f64::NAN, f64::INFINITY] {
            let regular = from(2, &[(0, 0, 1.0), (1, 0, 0.1), (1, 1, 1.0)]);
            // Column by column: below the diagonal, and on it.
            for place in [1, 2] {
                let mut values = regular.lower().values().to_vec();
                values[place] = bad;
                let lower = Csc::new(regular.lower().pattern().clone(), values).unwrap();
                let unsound = Symmetric::from_lower(lower).unwrap();
                assert!(matches!(factor(&unsound, &[]), Err(LinearError::NotFinite)));
            }
        }
        for last in [&[3][..], &[1, 1]] {
            assert!(matches!(factor(&indefinite, last), Err(LinearError::Shape { .. })));
        }
    }
}

#[test]
fn wrong_lengths_are_errors() {
    for of in BACKENDS {
        let factor = of(&random(5, 1), &[2]).unwrap();
        let (reduced, mut x) = (factor.reduce(&[1.0; 5]).unwrap(), [0.0; 5]);
        let shape = |result| assert!(matches!(result, Err(LinearError::Shape { .. })));
        shape(factor.solve(&[1.0; 4], &mut x));
        shape(factor.solve(&[1.0; 5], &mut x[1..]));
        shape(factor.reduce(&[1.0; 6]).map(|_| ()));
        shape(factor.expand(&reduced, &[], &mut x));
        shape(factor.expand(&reduced, &[1.0], &mut x[1..]));
        shape(of(&random(5, 1), &[]).unwrap().expand(&reduced, &[], &mut x));
    }
}

#[test]
fn factors_move_between_threads_and_do_not_share_state() {
    for factor in BACKENDS {
        let k = random(40, 9);
        let factors: Vec<_> = (0..100).map(|i| factor(&k, &[i % 40]).unwrap()).collect();
        let work = move || {
            for factor in factors {
                let (b, mut x) = (vector(40, 2), vec![0.0; 40]);
                factor.solve(&b, &mut x).unwrap();
                assert!(error(&k, &b, &x) <= 1e-15);
            }
        };
        std::thread::spawn(work).join().unwrap();
    }
}

/// The least pivot of the interior says how near it is to being singular, whatever the border holds.
#[test]
fn pivots_of_the_interior() {
    for factor in BACKENDS {
        let k = from(3, &[(0, 0, 4.0), (1, 1, 1e-6), (2, 2, 16.0)]);
        let of = |last: &[usize]| factor(&k, last).unwrap().interior_pivot_ratio().unwrap();
        close(&[of(&[1]), of(&[0]), of(&[]), of(&[2, 1, 0])], &[0.25, 6.25e-8, 6.25e-8, 1.0], 1e-14);
    }
}

/// The default is one of them.
#[test]
fn the_default_of_this_build() {
    let (k, last) = (random(30, 5), [3, 8]);
    let info = Cholesky::factor(&k, &last).unwrap().info();
    assert_eq!(info, BACKENDS[0](&k, &last).unwrap().info());
}

/// Matrices as large as threads share the work: the factors differ by rounding.
#[cfg(feature = "faer")]
#[test]
fn any_number_of_threads() {
    use stickslip::algebra::linear::{FaerLu, RefinedSolver, SystemMatrix};

    let n = 1000;
    let entry = |i: usize, j: usize| if i == j { 4.0 } else { (0.3 * (i * j) as f64).sin() / (i - j) as f64 };
    let entries: Vec<_> = (0..n).flat_map(|i| (0..=i).map(move |j| (i, j, entry(i, j)))).collect();
    let k = Symmetric::from_triplets(n, &entries).unwrap();
    let (a, b) =
        (SystemMatrix::from(Csc::from_triplets(n, n, &k.entries().collect::<Vec<_>>()).unwrap()), vector(n, 4));
    let solved = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let (mut direct, mut x, mut y) =
                (RefinedSolver::new(Box::new(FaerLu::default())), vec![0.0; n], vec![0.0; n]);
            direct.analyze(&a).unwrap();
            direct.factorize(&a).unwrap();
            direct.solve(&a, &b, &mut x).unwrap();
            let factor = Cholesky::faer(&k, &[]).unwrap();
            assert!(factor.info().flops > 3e8);
            factor.solve(&b, &mut y).unwrap();
            [x, y]
        })
    };
    let [one, y] = solved(1);
    close(&one, &y, 1e-12);
    for threads in [2, 3] {
        for x in solved(threads) {
            close(&x, &one, 1e-12);
        }
    }
}
