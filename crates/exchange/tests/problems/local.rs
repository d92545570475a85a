//! Local problems of rigid bodies with more contact forces than needed. An independent measure confirms the laws for
//! every answer called solved, in any units and order, and never for another one.

use crate::common::random::draw;
use proptest::prelude::*;
use stickslip::algebra::{Csc, Csr, Symmetric};
use stickslip::solver::{ContactProblem, Increment, Parts, State};
use stickslip::solver::{KktErrors, KktScales};
use stickslip_exchange::TOLERANCE;
use stickslip_exchange::local::{CascadeSettings, LocalProblem, LocalStatus, Solved, solve};

/// A problem as plain numbers.
#[derive(Debug, Clone)]
struct Numbers {
    dimension: usize,
    w: Vec<(usize, usize, f64)>,
    q: Vec<f64>,
    mu: Vec<f64>,
}

impl Numbers {
    fn problem(&self) -> LocalProblem {
        let n = self.q.len();
        LocalProblem::new(self.dimension, Csc::from_triplets(n, n, &self.w).unwrap(), self.q.clone(), self.mu.clone())
            .unwrap()
    }

    fn solved(&self) -> Solved {
        solve(&self.problem(), &CascadeSettings::default(), None).unwrap()
    }

    /// Returns the problem with forces and velocities multiplied, and with contact `i` at index `place[i]`.
    fn scaled(&self, force: f64, velocity: f64, place: &[usize]) -> Numbers {
        let d = self.dimension;
        let to = |row: usize| d * place[row / d] + row % d;
        let (mut q, mut mu) = (self.q.clone(), self.mu.clone());
        self.q.iter().enumerate().for_each(|(row, value)| q[to(row)] = velocity * value);
        self.mu.iter().enumerate().for_each(|(i, value)| mu[place[i]] = *value);
        let w = self.w.iter().map(|&(i, j, w)| (to(i), to(j), velocity / force * w)).collect();
        Numbers { dimension: d, w, q, mu }
    }

    /// Returns the largest violation of any law as one number, calculated independently here.
    fn violation(&self, r: &[f64]) -> f64 {
        let d = self.dimension;
        let mut u = self.q.clone();
        self.w.iter().for_each(|&(i, j, w)| u[i] += w * r[j]);
        let largest = |values: &[f64]| values.iter().fold(f64::MIN_POSITIVE, |m, v| v.abs().max(m));
        let (force, velocity) = (largest(r), largest(&u).max(largest(&self.q)));
        let mut worst = 0.0_f64;
        for (i, mu) in self.mu.iter().enumerate() {
            let (r, u) = (&r[d * i..d * (i + 1)], &u[d * i..d * (i + 1)]);
            let norm = |t: &[f64]| t.iter().map(|t| t * t).sum::<f64>().sqrt();
            let (friction, slip) = (norm(&r[1..]), norm(&u[1..]));
            let work: f64 = r[1..].iter().zip(&u[1..]).map(|(r, u)| r * u).sum();
            worst = worst.max(-u[0] / velocity).max(-r[0] / force).max((friction - mu * r[0]) / force);
            // The work in Signorini's and Coulomb's laws: r_N u_N = 0, and r_T opposes the slip with the largest
            // possible work.
            worst = worst.max(r[0] * u[0] / (force * velocity)).max((work + mu * r[0] * slip) / (force * velocity));
        }
        worst
    }
}

/// Returns planks on top of each other, each on four points of the one below, pushed sideways. Six of the 3 forces at
/// each point suffice. The velocities of the planks have some `noise`.
fn planks(levels: usize, mu: f64, push: f64, noise: f64, seed: u64) -> Numbers {
    let mut random = seed;
    let (height, arm, mass) = (0.2, 0.7, 0.5);
    let inertia = [0.3, 0.3, 0.5];
    // A row for each direction of each point: velocity and rotation of its plank and of the lower plank.
    let mut rows: Vec<Vec<(usize, f64)>> = Vec::new();
    for level in 0..levels {
        for (x, y) in [(-arm, -arm), (-arm, arm), (arm, -arm), (arm, arm)] {
            for direction in [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
                let mut row = Vec::new();
                for (plank, sign, z) in [(Some(level), 1.0, -height / 2.0), (level.checked_sub(1), -1.0, height / 2.0)]
                {
                    let Some(plank) = plank else { continue };
                    let [a, b, c] = direction;
                    let turn = [y * c - z * b, z * a - x * c, x * b - y * a];
                    row.extend((0..3).map(|k| (6 * plank + k, sign * direction[k])));
                    row.extend((0..3).map(|k| (6 * plank + 3 + k, sign * turn[k])));
                }
                rows.push(row);
            }
        }
    }
    let compliance = |k: usize| if k % 6 < 3 { 1.0 / mass } else { 1.0 / inertia[k % 6 - 3] };
    let velocities: Vec<f64> =
        (0..6 * levels).map(|k| [push, 0.3 * push, -0.05, 0.0, 0.0, 0.0][k % 6] + noise * draw(&mut random)).collect();
    let q = rows.iter().map(|row| row.iter().map(|&(k, h)| h * velocities[k]).sum()).collect();
    let mut w = Vec::new();
    for (i, a) in rows.iter().enumerate() {
        for (j, b) in rows.iter().enumerate() {
            let terms = a.iter().flat_map(|x| b.iter().filter(|y| y.0 == x.0).map(|y| x.1 * y.1 * compliance(x.0)));
            let sum: f64 = terms.sum();
            if sum != 0.0 {
                w.push((i, j, sum));
            }
        }
    }
    Numbers { dimension: 3, w, q, mu: vec![mu; 4 * levels] }
}

fn permutation(n: usize, seed: u64) -> Vec<usize> {
    let mut random = seed;
    let mut place: Vec<usize> = (0..n).collect();
    for i in (1..n).rev() {
        place.swap(i, (f64::midpoint(draw(&mut random), 1.0) * i as f64).round() as usize);
    }
    place
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    /// Towers of planks are solved, by the program's measure and by the one here. A force changed by a thousandth of
    /// the largest is rejected by both.
    #[test]
    fn towers_stand_slide_and_fall(
        levels in 1_usize..6,
        mu in 0.05_f64..1.5,
        push in 0.0_f64..0.2,
        noise in prop_oneof![Just(0.0), 0.0..0.05_f64],
        seed in any::<u64>(),
    ) {
        let tower = planks(levels, mu, push, noise, seed);
        let solved = tower.solved();
        let violation = tower.violation(&solved.r);
        if solved.status == LocalStatus::Solved {
            prop_assert!(solved.errors.natural_map <= TOLERANCE && violation < 1e-9, "{violation:e} {:?}", solved.errors);
        } else {
            prop_assert!(solved.errors.natural_map > TOLERANCE);
        }
        prop_assert_eq!(solved.status, LocalStatus::Solved);
        let mut wrong = solved.r.clone();
        let largest = wrong.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
        prop_assume!(largest > 0.0);
        wrong[0] += 1e-3 * largest;
        let errors = tower.problem().errors(&wrong, None).unwrap();
        prop_assert!(!errors.is_solved(), "{errors:?}");
    }

    /// In other units and another order the verdict is the same, and the iterations agree within a tenth (or one if
    /// few).
    #[test]
    fn units_and_order_do_not_matter(levels in 1_usize..5, mu in 0.1_f64..1.0, push in 0.0_f64..0.1, seed in any::<u64>()) {
        let tower = planks(levels, mu, push, 0.02, seed);
        let one = tower.solved();
        for (force, velocity) in [(1.0, 1.0), (1e9, 1.0), (1.0, 1e-9), (1e9, 1e-9)] {
            let other = tower.scaled(force, velocity, &permutation(4 * levels, seed)).solved();
            prop_assert_eq!(one.status, other.status);
            let (a, b) = (one.iterations() as f64, other.iterations() as f64);
            prop_assert!((a - b).abs() <= (0.1 * a).max(1.0), "{a} {b}");
        }
    }
}

/// Elastic nodes on springs above a floor: the forces of the local problem, with the resulting displacements, satisfy
/// the error measure of the whole body. So signs and directions agree with those of `ContactProblem`.
#[test]
fn the_body_has_the_same_solution() {
    let mut random = 3;
    for case in 0..20 {
        let (nodes, dimension) = (6, 2 + case % 2);
        let n = nodes * dimension;
        // A definite stiffness that couples neighbours.
        let mut triplets = Vec::new();
        for i in 0..n {
            triplets.push((i, i, 3.0 + draw(&mut random)));
            if i >= dimension {
                triplets.push((i, i - dimension, -1.0 + 0.3 * draw(&mut random)));
            }
        }
        let stiffness = Symmetric::from_triplets(n, &triplets).unwrap();
        let mu: Vec<f64> = (0..nodes).map(|_| 0.4 + 0.3 * draw(&mut random)).collect();
        let force: Vec<f64> = (0..n).map(|i| if i % dimension == 0 { 1.0 } else { 2.0 * draw(&mut random) }).collect();
        let gap: Vec<f64> = (0..nodes).map(|_| 0.05 * draw(&mut random)).collect();
        let mut last: Vec<f64> = (0..2 * nodes).map(|_| 0.1 * draw(&mut random)).collect();
        if dimension == 2 {
            last[nodes..].fill(0.0);
        }
        // K⁻¹ column by column, by conjugate gradients: definite and small.
        let solve_with = |b: &[f64]| conjugate_gradients(&triplets, b);
        // Rows of relative velocity. The normal is directed away from the floor, along the node's first direction.
        let sign = |row: usize| if row.is_multiple_of(dimension) { -1.0 } else { 1.0 };
        let mut entries = Vec::new();
        for column in 0..n {
            let mut unit = vec![0.0; n];
            unit[column] = sign(column);
            let x = solve_with(&unit);
            entries.extend((0..n).map(|row| (row, column, sign(row) * x[row])));
        }
        let free = solve_with(&force);
        let start = |row: usize| match row % dimension {
            0 => gap[row / dimension],
            k => -last[(k - 1) * nodes + row / dimension],
        };
        let q = (0..n).map(|row| sign(row) * free[row] + start(row)).collect();
        let local = Numbers { dimension, w: entries, q, mu: mu.clone() }.solved();
        assert_eq!(local.status, LocalStatus::Solved);

        let component = |k: usize| (0..nodes).map(|i| local.r[dimension * i + k]).collect::<Vec<f64>>();
        let minus = |values: Vec<f64>| values.into_iter().map(|value| -value).collect::<Vec<f64>>();
        let (p_n, p_t) = (component(0), minus(component(1)));
        let p_o = if dimension == 3 { minus(component(2)) } else { vec![0.0; nodes] };
        let mut load = force.clone();
        for i in 0..nodes {
            load[dimension * i] -= p_n[i];
            load[dimension * i + 1] -= p_t[i];
            if dimension == 3 {
                load[dimension * i + 2] -= p_o[i];
            }
        }
        let map = |k: usize| Csr::from_rows(n, (0..nodes).map(|i| [(dimension * i + k, 1.0)])).unwrap();
        let c_o = if dimension == 3 { map(2) } else { Csr::empty(nodes, n).unwrap() };
        let parts = Parts { c_t: map(1), c_o, mu: mu.clone(), ..Parts::new(stiffness, map(0)) };
        let problem = ContactProblem::new(parts).unwrap();
        let increment =
            Increment { force: &force, gap: &gap, mu: &mu, w_t_last: &last[..nodes], w_o_last: &last[nodes..] };
        let state = State { u: solve_with(&load), p_t, p_o, p_n, ..State::default() };
        let errors = KktErrors::measure(&problem, &increment, &state, &KktScales::default()).unwrap();
        assert!(errors.worst().1 < 1e-9, "{case}: {errors:?}");
        assert!(local.r.iter().any(|r| r.abs() > 1e-3));
    }
}

/// Solves `K x = b` for a `K` with these entries and their mirror images.
fn conjugate_gradients(triplets: &[(usize, usize, f64)], b: &[f64]) -> Vec<f64> {
    let product = |x: &[f64]| {
        let mut y = vec![0.0; x.len()];
        for &(i, j, k) in triplets {
            y[i] += k * x[j];
            if i != j {
                y[j] += k * x[i];
            }
        }
        y
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (mut x, mut rest, mut along) = (vec![0.0; b.len()], b.to_vec(), b.to_vec());
    for _ in 0..10 * b.len() {
        let before = dot(&rest, &rest);
        if before < 1e-32 * dot(b, b) {
            break;
        }
        let k = product(&along);
        let step = before / dot(&along, &k);
        for i in 0..x.len() {
            x[i] += step * along[i];
            rest[i] -= step * k[i];
        }
        let share = dot(&rest, &rest) / before;
        along.iter_mut().zip(&rest).for_each(|(along, rest)| *along = rest + share * *along);
    }
    x
}
