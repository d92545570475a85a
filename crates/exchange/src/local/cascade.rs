//! The cascade: the methods tried on a local problem, from cheap to expensive, until the independent measure shows that
//! it is solved.
//!
//! Each island is solved separately. Its stages share only the forces with the smallest natural map so far.

use super::LocalProblem;
use super::errors::measure;
use super::interior::{Path, interior, plain};
use super::islands::{Island, islands};
use super::judge::Judge;
use super::newton::newton;
use super::record::{CascadeSettings, LocalStatus, Solved, Stage, StageRecord};
use super::scaled::ScaledContacts;
use super::sweeps::sweep;
use stickslip::base::InputError;

/// Solves `problem`, from a `guess` of its forces (n_c d) if given. Failure is reported by the status, not by an error.
///
/// # Errors
/// When the guess does not fit the problem or is not finite, or the tolerance is not positive.
pub fn solve(problem: &LocalProblem, settings: &CascadeSettings, guess: Option<&[f64]>) -> Result<Solved, InputError> {
    let tolerance = settings.tolerance;
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(InputError::new("tolerance", format!("it is {tolerance}"), "give a finite number above 0"));
    }
    if let Some(guess) = guess {
        problem.check("guess", guess)?;
    }
    let mut r = vec![0.0; problem.q().len()];
    let mut stages = Vec::new();
    let islands = islands(problem);
    for island in &islands {
        let guess = guess.map(|guess| island.read(guess));
        island.write(&forces(island, settings, guess.as_deref(), &mut stages), &mut r);
    }
    stages.sort_by_key(|record| record.stage);
    let (errors, u) = measure(problem, &r, None);
    let status = if errors.within(tolerance) {
        LocalStatus::Solved
    } else {
        helpless(problem, tolerance).map_or(LocalStatus::NotSolved, |contact| LocalStatus::Unsolvable { contact })
    };
    Ok(Solved { r, u, status, errors, islands: islands.len(), stages })
}

/// Returns a contact that approaches whatever the forces are, beyond rounding.
fn helpless(problem: &LocalProblem, tolerance: f64) -> Option<usize> {
    let least = -tolerance * problem.q().iter().fold(0.0_f64, |m, q| m.max(q.abs()));
    let d = problem.dimension();
    let mut has_normal = vec![false; problem.contacts()];
    for (row, _, w) in problem.delassus().entries() {
        has_normal[row / d] |= row % d == 0 && w != 0.0;
    }
    (0..problem.contacts()).find(|&i| !has_normal[i] && problem.q()[d * i] < least)
}

/// Returns the best forces of one island, and adds the stages tried to the `records`.
fn forces(
    island: &Island,
    settings: &CascadeSettings,
    guess: Option<&[f64]>,
    records: &mut Vec<StageRecord>,
) -> Vec<f64> {
    let scaled = ScaledContacts::new(&island.problem);
    let mut judge = Judge::new(&island.problem, &scaled, settings.tolerance);
    let stages = [
        Stage::Free,
        Stage::Guess,
        Stage::Newton,
        Stage::Interior,
        Stage::InteriorElsewhere,
        Stage::InteriorOnCone,
        Stage::Sweeps,
    ];
    for stage in stages {
        let left_out = match stage {
            Stage::Free => false,
            Stage::Guess => guess.is_none(),
            Stage::Newton => settings.newton_iterations == 0,
            Stage::Interior | Stage::InteriorElsewhere | Stage::InteriorOnCone => settings.interior_iterations == 0,
            Stage::Sweeps => settings.sweeps == 0,
        };
        if left_out {
            continue;
        }
        let iterations = run(stage, &mut judge, settings, guess);
        note(records, stage, iterations, &judge);
        if judge.is_solved() {
            break;
        }
    }
    judge.forces
}

/// Adds the result of a stage to its record.
fn note(records: &mut Vec<StageRecord>, stage: Stage, iterations: usize, judge: &Judge<'_>) {
    let (solved, residual) = (usize::from(judge.is_solved()), judge.error);
    match records.iter_mut().find(|record| record.stage == stage) {
        Some(record) => {
            record.islands += 1;
            record.solved += solved;
            record.iterations += iterations;
            record.residual = record.residual.max(residual);
        }
        None => records.push(StageRecord { stage, islands: 1, solved, iterations, residual }),
    }
}

/// The number of sweeps before the first stage. More sweeps do not improve the statuses.
const FIRST_SWEEPS: usize = 10;
/// The paths of each stage of the interior point method. Of 240 problems of spheres, rocks, boxes, capsules, planks,
/// arches and walls, most of them with a singular `W`, BN solves 137, the first path 62 more, the paths from other
/// starting points 21, the paths on the cone 2, and sweeps 3.
const PATHS: [&[Path]; 3] = [
    &[plain(1.0)],
    &[plain(10.0), plain(100.0), plain(0.1)],
    &[plain(1.0).on_cone(), plain(10.0).on_cone(), plain(100.0).on_cone()],
];

/// Tries one stage. Returns its number of iterations.
fn run(stage: Stage, judge: &mut Judge<'_>, settings: &CascadeSettings, guess: Option<&[f64]>) -> usize {
    let scaled = judge.scaled;
    let limit = settings.newton_iterations;
    match stage {
        Stage::Free => 0,
        Stage::Guess => guess.map_or(0, |guess| newton(judge, scaled.read(guess), limit)),
        Stage::Newton => {
            let mut r = vec![0.0; scaled.rows()];
            sweep(scaled, &mut r, FIRST_SWEEPS);
            newton(judge, r, limit)
        }
        Stage::Interior => follow(judge, settings, PATHS[0]),
        Stage::InteriorElsewhere => follow(judge, settings, PATHS[1]),
        Stage::InteriorOnCone => follow(judge, settings, PATHS[2]),
        Stage::Sweeps => {
            let mut r = judge.scaled.read(&judge.forces);
            let (mut done, mut iterations, mut next) = (0, 0, 2 * FIRST_SWEEPS);
            while done < settings.sweeps && !judge.is_solved() {
                let more = next.min(settings.sweeps - done);
                sweep(scaled, &mut r, more);
                (done, next) = (done + more, done + more);
                iterations += newton(judge, r.clone(), limit);
            }
            done + iterations
        }
    }
}

/// Follows one path after the other, each finished by BN.
fn follow(judge: &mut Judge<'_>, settings: &CascadeSettings, paths: &[Path]) -> usize {
    let mut iterations = 0;
    for path in paths {
        if !judge.is_solved() {
            let (r, more) = interior(judge, *path, settings.interior_iterations);
            iterations += more + newton(judge, r, settings.newton_iterations);
        }
    }
    iterations
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TOLERANCE;
    use stickslip::algebra::Csc;

    fn problem(dimension: usize, entries: &[(usize, usize, f64)], q: &[f64], mu: &[f64]) -> LocalProblem {
        let n = q.len();
        LocalProblem::new(dimension, Csc::from_triplets(n, n, entries).unwrap(), q.to_vec(), mu.to_vec()).unwrap()
    }

    fn solved(problem: &LocalProblem) -> Solved {
        solve(problem, &CascadeSettings::default(), None).unwrap()
    }

    /// Returns a block on two feet, 2 wide and with its centre 1 above the floor, unit mass and inertia, which
    /// approaches the floor at speed `fall` and slides at speed `slide`: normals, then tangents of the feet at (∓1,
    /// -1).
    fn block(fall: f64, slide: f64, mu: f64) -> LocalProblem {
        // The moment of a force along (x, y) at (a, b) is a y - b x.
        let directions = [[0.0, 1.0, -1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 0.0, 1.0]];
        let product = |i: usize, j: usize| (0..3).map(|k| directions[i][k] * directions[j][k]).sum::<f64>();
        let entries: Vec<_> = (0..16).map(|k| (k / 4, k % 4, product(k / 4, k % 4))).collect();
        problem(2, &entries, &[-fall, slide, -fall, slide], &[mu, mu])
    }

    #[test]
    fn nothing_at_all_is_solved() {
        let nothing = solved(&problem(3, &[], &[], &[]));
        assert_eq!((nothing.status, nothing.islands, nothing.iterations()), (LocalStatus::Solved, 0, 0));
        assert!(nothing.r.is_empty() && nothing.stages.is_empty());
    }

    #[test]
    fn what_flies_off_is_free() {
        let free = solved(&problem(3, &[(0, 0, 1.0), (1, 1, 1.0)], &[0.0, -3.0, 1.0], &[0.5]));
        assert_eq!((free.status, free.r, free.u), (LocalStatus::Solved, vec![0.0; 3], vec![0.0, -3.0, 1.0]));
        assert_eq!(free.stages.len(), 1);
        assert_eq!((free.stages[0].stage, free.stages[0].iterations), (Stage::Free, 0));
    }

    /// Three cases of a block, solved by hand. Both feet stick: `W` of the tangents is singular, and only the sum of
    /// the tangential forces is known. Both slide: the moment of friction loads the front foot. With larger friction
    /// the block tips.
    #[test]
    fn a_block_on_two_feet() {
        let holds = solved(&block(2.0, 1.0, 1.0));
        assert_eq!(holds.status, LocalStatus::Solved, "{holds:?}");
        assert!(holds.u.iter().all(|u| u.abs() < 1e-10), "{holds:?}");
        // Moments of 2 r_N and r_T = -1: r_N2 - r_N1 = 1.
        assert!((holds.r[0] - 0.5).abs() < 1e-9 && (holds.r[2] - 1.5).abs() < 1e-9, "{holds:?}");
        assert!((holds.r[1] + holds.r[3] + 1.0).abs() < 1e-9);
        let slides = solved(&block(2.0, 3.0, 0.5));
        assert_eq!(slides.status, LocalStatus::Solved);
        let expected = [0.5, -0.25, 1.5, -0.75];
        assert!(slides.r.iter().zip(expected).all(|(r, e)| (r - e).abs() < 1e-12), "{slides:?}");
        assert!((slides.u[1] - 2.0).abs() < 1e-12);
        let tips = solved(&block(2.0, 30.0, 2.0));
        assert_eq!(tips.status, LocalStatus::Solved);
        assert!(tips.r[0].abs() < 1e-12 && tips.u[0] > 0.1 && tips.r[2] > 2.0, "{tips:?}");
    }

    #[test]
    fn without_friction_there_is_no_force_along() {
        let slides = solved(&block(2.0, 3.0, 0.0));
        assert_eq!((slides.status, slides.r), (LocalStatus::Solved, vec![1.0, 0.0, 1.0, 0.0]));
        assert_eq!(slides.u, [0.0, 3.0, 0.0, 3.0]);
    }

    /// First, a row of `W` is 0 and its contact approaches, so no force can stop it. Second, each of two contacts needs
    /// the other's force to be smaller than its own: there is no solution, but no proof either.
    #[test]
    fn what_cannot_be_solved_is_not() {
        let helpless = solved(&problem(2, &[(0, 0, 1.0), (1, 1, 1.0)], &[-1.0, 0.0, -1.0, 0.0], &[0.5, 0.5]));
        assert_eq!(helpless.status, LocalStatus::Unsolvable { contact: 1 });
        assert_eq!(helpless.r[0], 1.0);
        let wedge = [(0, 0, 1.0), (0, 2, -1.0), (2, 0, -1.0), (2, 2, 1.0)];
        for dimension in [2, 3] {
            let of = |k: usize| k / 2 * dimension;
            let entries = wedge.map(|(i, j, w)| (of(i), of(j), w));
            let mut q = vec![0.0; 2 * dimension];
            (q[0], q[dimension]) = (-1.0, -0.5);
            let squeezed = solved(&problem(dimension, &entries, &q, &[0.3, 0.0]));
            assert_eq!(squeezed.status, LocalStatus::NotSolved);
            assert!(squeezed.errors.natural_map > 1e-3, "{squeezed:?}");
            assert_eq!(squeezed.stages.last().unwrap().stage, Stage::Sweeps);
        }
    }

    #[test]
    fn a_guess_is_judged_first() {
        let block = block(2.0, 3.0, 0.5);
        let settings = CascadeSettings::default();
        let guessed = solve(&block, &settings, Some(&[0.5, -0.25, 1.5, -0.75])).unwrap();
        let stages: Vec<Stage> = guessed.stages.iter().map(|record| record.stage).collect();
        assert_eq!((guessed.status, stages), (LocalStatus::Solved, vec![Stage::Free, Stage::Guess]));
        // A bad guess does no harm.
        let misled = solve(&block, &settings, Some(&[-1e9, 3e7, 1e-9, 5.0])).unwrap();
        assert_eq!(misled.status, LocalStatus::Solved);
        let error = solve(&block, &settings, Some(&[1.0; 3])).unwrap_err();
        assert!(error.to_string().starts_with("guess: it has 3 entries, but must have 4"), "{error}");
    }

    #[test]
    fn a_tolerance_is_above_zero() {
        for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let settings = CascadeSettings { tolerance, ..CascadeSettings::default() };
            let error = solve(&block(1.0, 1.0, 0.5), &settings, None).unwrap_err();
            assert_eq!(error.key, "tolerance", "{error}");
        }
    }

    #[test]
    fn stages_without_iterations_are_left_out() {
        let stages = |settings: CascadeSettings| {
            let solved = solve(&block(2.0, 3.0, 0.5), &settings, None).unwrap();
            (solved.status, solved.stages.iter().map(|record| record.stage).collect::<Vec<_>>())
        };
        let all = CascadeSettings::default();
        let none = CascadeSettings { newton_iterations: 0, interior_iterations: 0, sweeps: 0, ..all };
        assert_eq!(stages(none), (LocalStatus::NotSolved, vec![Stage::Free]));
        let swept = stages(CascadeSettings { sweeps: 1280, ..none });
        assert_eq!(swept, (LocalStatus::Solved, vec![Stage::Free, Stage::Sweeps]));
        let inside = stages(CascadeSettings { interior_iterations: 60, ..none });
        assert_eq!(inside.1[..2], [Stage::Free, Stage::Interior]);
        let newton = stages(CascadeSettings { newton_iterations: 50, ..none });
        assert_eq!(newton, (LocalStatus::Solved, vec![Stage::Free, Stage::Newton]));
    }

    #[test]
    fn numbers_out_of_all_bounds_do_no_harm() {
        for (w, q) in [(1e308, -1e308), (1e-308, -1e308), (1e308, -1e-308), (5e-324, -1.0), (-1.0, -1.0)] {
            let extreme = solved(&problem(2, &[(0, 0, w), (1, 1, w), (0, 1, 0.5 * w)], &[q, -q], &[0.3]));
            assert!(extreme.r.iter().all(|r| r.is_finite()), "{extreme:?}");
            assert_eq!(extreme.status == LocalStatus::Solved, extreme.errors.within(TOLERANCE));
        }
    }
}
