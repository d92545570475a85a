//! Random contact problems in three dimensions, without a mesh.

use stickslip::algebra::{Csr, Symmetric};
use stickslip::solver::{ContactProblem, LoadCase, Loading, Parts};

/// Splitmix64, in [0, 1).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// In [-1, 1).
    pub fn sign(&mut self) -> f64 {
        2.0 * self.next() - 1.0
    }
}

/// A number from (-1, 1) by a congruence, whose low bits are left out.
pub fn draw(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// The matrix with these rows, one or more non-zero entries each.
pub fn rows(columns: usize, rows: impl IntoIterator<Item = Vec<(usize, f64)>>) -> Csr {
    Csr::from_rows(columns, rows).unwrap()
}

/// A symmetric matrix from its entries `(i, j)`.
pub fn symmetric(n: usize, entry: impl Fn(usize, usize) -> f64) -> Symmetric {
    let entries = (0..n).flat_map(|i| (0..=i).map(move |j| (i, j)));
    Symmetric::from_triplets(n, &entries.map(|(i, j)| (i, j, entry(i, j))).collect::<Vec<_>>()).unwrap()
}

/// A random orthonormal frame `(n, t, o)`.
fn frame(random: &mut Random) -> [[f64; 3]; 3] {
    let mut vector = || [random.sign(), random.sign(), random.sign()];
    let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let unit = |a: [f64; 3]| a.map(|x| x / dot(a, a).sqrt());
    let n = unit(vector());
    let v = vector();
    let t = unit([0, 1, 2].map(|k| v[k] - dot(v, n) * n[k]));
    let o = [n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0]];
    [n, t, o]
}

/// `contacts` nodes with three displacements each and obstacles at any angle, and as many displacements
/// within; `K = k S (1 + 3 B Bᵀ / n) S` with k = 1e11 N/m, a random `B` and a random diagonal `S` that spreads the
/// stiffness over so many `decades`; friction up to `mu`; loads of some MN that press, and push along a direction
/// that turns in the time 0 … 1.
pub fn problem(random: &mut Random, contacts: usize, mu: f64, decades: f64) -> (ContactProblem, Loading) {
    let n = 6 * contacts;
    let stiffness = 1e11;
    let factor: Vec<f64> = (0..n * n).map(|_| random.sign()).collect();
    let spread: Vec<f64> = (0..n).map(|_| 10_f64.powf(0.25 * decades * random.sign())).collect();
    let product = |i: usize, j: usize| {
        let [a, b] = [i, j].map(|k| &factor[k * n..][..n]);
        a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>()
    };
    let k = symmetric(n, |i, j| {
        let unit = f64::from(u8::from(i == j));
        stiffness * spread[i] * spread[j] * (unit + 3.0 * product(i, j) / n as f64)
    });
    let frames: Vec<_> = (0..contacts).map(|_| frame(random)).collect();
    let map = |axis: usize| {
        rows(n, (0..contacts).map(|i| (0..3).map(|k| (3 * i + k, frames[i][axis][k])).collect::<Vec<_>>()))
    };
    let problem = ContactProblem::new(Parts {
        stiffness: k.into(),
        c_n: map(0),
        c_t: map(1),
        c_o: map(2),
        mu: (0..contacts).map(|_| mu * (0.5 + 0.5 * random.next())).collect(),
        weight: Some(vec![0.05; contacts]),
        rigid_modes: Some(Vec::new()),
    })
    .unwrap();
    // Loads along the normals and along both tangents, and a general one.
    let mut along = |axis: usize, least: f64| {
        let mut force = vec![0.0; n];
        for (i, frame) in frames.iter().enumerate() {
            let size = 1e6 * (least + (1.0 - least) * random.next());
            (0..3).for_each(|k| force[3 * i + k] += size * frame[axis][k]);
        }
        force
    };
    let [press, push, turn] = [along(0, 0.3), along(1, 0.5), along(2, 0.5)];
    let general = (0..n).map(|_| 2e5 * random.sign()).collect();
    let size = 0.2 + 2.0 * random.next();
    let phase = 6.0 * random.next();
    let circle = |shift: f64| {
        let points = (0..=12).map(|k| f64::from(k) / 12.0);
        points.map(|t| [t, size * (phase + shift + 5.0 * t).cos() * (4.0 * t).min(1.0)]).collect::<Vec<_>>()
    };
    let history = [vec![[0.0, 0.0], [0.3, 1.0], [1.0, 0.6]], circle(0.0), circle(-1.57), vec![[0.0, 0.0], [1.0, 1.0]]];
    let cases = [press, push, turn, general].into_iter().zip(history);
    let cases = cases.map(|(force, history)| LoadCase::new(force, history).unwrap()).collect();
    let gap = (0..contacts).map(|_| [0.0, 2e-6, 5e-6 * random.sign()][(3.0 * random.next()) as usize]).collect();
    let loading = Loading::new(cases, gap).unwrap();
    (problem, loading)
}

/// The same problem with the tangents of every node turned by a random angle.
pub fn turn_tangents(problem: &ContactProblem, random: &mut Random) -> ContactProblem {
    let n = problem.displacements();
    let angles: Vec<f64> = (0..problem.contacts()).map(|_| 6.3 * random.next()).collect();
    let turned = |shift: f64| {
        rows(
            n,
            (0..problem.contacts()).map(|i| {
                let (c, s) = ((angles[i] + shift).cos(), (angles[i] + shift).sin());
                let both = problem.c_t().row(i).iter().zip(problem.c_o().row(i));
                both.map(|(&(dof, t), &(other, o))| {
                    assert_eq!(dof, other);
                    (dof, c * t + s * o)
                })
                .collect::<Vec<_>>()
            }),
        )
    };
    ContactProblem::new(Parts {
        c_t: turned(0.0),
        c_o: turned(std::f64::consts::FRAC_PI_2),
        ..problem.clone().into_parts()
    })
    .unwrap()
}
