//! Two blocks that are pressed and pushed to and fro, judged by displacements and contact forces alone: element forces, gaps and slip are computed
//! here, with linear triangles and weights on the facets of the slave that are written for this test.

use crate::common::pairs::pushed;
use crate::common::prelude::*;

const YOUNG: [f64; 2] = [210e9, 70e9];
const FRICTION: f64 = 0.2;
const HEIGHT: f64 = 0.5;

/// Errors relative to the largest contact force, and to the largest displacement.
const ROUNDING: f64 = 1e-9;

type Plane = [f64; 2];

/// The forces (N per m of depth) that strained triangles exert on their nodes, of plane strain.
fn element_forces(mesh: &Mesh, u: &[Plane]) -> Vec<Plane> {
    let mut forces = vec![[0.0; 2]; mesh.nodes.len()];
    for cell in &mesh.cells {
        let at = |k: usize| mesh.nodes[cell.nodes[k % 3]];
        // Twice the gradients of the shape functions times the area.
        let gradients: Vec<Plane> =
            (0..3).map(|k| [at(k + 1)[1] - at(k + 2)[1], at(k + 2)[0] - at(k + 1)[0]]).collect();
        let area = 0.5 * (0..3).map(|k| at(k)[0] * gradients[k][0]).sum::<f64>();
        let mut slope = [[0.0; 2]; 2];
        for (k, gradient) in gradients.iter().enumerate() {
            for (row, u) in slope.iter_mut().zip(u[cell.nodes[k]]) {
                row.iter_mut().zip(gradient).for_each(|(sum, g)| *sum += u * g / (2.0 * area));
            }
        }
        let middle = (0..3).map(|k| at(k)[1]).sum::<f64>() / 3.0;
        let (young, nu) = (YOUNG[usize::from(middle > HEIGHT)], 0.3);
        let (lame, shear) = (young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), young / (2.0 * (1.0 + nu)));
        let trace = slope[0][0] + slope[1][1];
        let stress = [0, 1]
            .map(|i| [0, 1].map(|j| shear * (slope[i][j] + slope[j][i]) + if i == j { lame * trace } else { 0.0 }));
        for (k, gradient) in gradients.iter().enumerate() {
            let force = &mut forces[cell.nodes[k]];
            for (f, row) in force.iter_mut().zip(stress) {
                *f += 0.5 * (row[0] * gradient[0] + row[1] * gradient[1]);
            }
        }
    }
    forces
}

/// The nodes of a boundary along x.
fn along(mesh: &Mesh, name: &str) -> Vec<usize> {
    let mut nodes: Vec<usize> = mesh.boundary(name).unwrap().facets.iter().flatten().copied().collect();
    nodes.sort_by(|a, b| mesh.nodes[*a][0].total_cmp(&mesh.nodes[*b][0]));
    nodes.dedup();
    nodes
}

/// What lines through points at `x` with these `values` have at `at`.
fn linear(x: &[f64], values: &[Plane], at: f64) -> Plane {
    let k = (1..x.len() - 1).find(|k| at < x[*k]).unwrap_or(x.len() - 1);
    let share = (at - x[k - 1]) / (x[k] - x[k - 1]);
    [0, 1].map(|c| (1.0 - share) * values[k - 1][c] + share * values[k][c])
}

/// `∫ ψ_a (u_slave - u_master)` of each node of the slave, with `ψ_a = 2 φ_a - φ_b` on the facet from `a` to `b`, over pieces on which all is linear.
fn relative(x: [&[f64]; 2], u: [&[Plane]; 2]) -> Vec<Plane> {
    let mut sums = vec![[0.0; 2]; x[0].len()];
    for (a, ends) in x[0].windows(2).enumerate() {
        let inside = x[1].iter().copied().filter(|at| ends[0] < *at && *at < ends[1]);
        let breaks: Vec<f64> = [ends[0]].into_iter().chain(inside).chain([ends[1]]).collect();
        for piece in breaks.windows(2) {
            let (middle, half) = (0.5 * (piece[0] + piece[1]), 0.5 * (piece[1] - piece[0]));
            for at in [middle - half / 3.0_f64.sqrt(), middle + half / 3.0_f64.sqrt()] {
                let [slave, master] = [0, 1].map(|side| linear(x[side], u[side], at));
                let share = (at - ends[0]) / (ends[1] - ends[0]);
                for (node, weight) in [(a, 2.0 - 3.0 * share), (a + 1, 3.0 * share - 1.0)] {
                    sums[node]
                        .iter_mut()
                        .zip([0, 1])
                        .for_each(|(sum, c)| *sum += half * weight * (slave[c] - master[c]));
                }
            }
        }
    }
    sums
}

struct Judge<'a> {
    model: &'a Model,
    names: [&'a str; 2],
    last: Vec<Plane>,
    counts: [usize; 3],
}

impl Observer for Judge<'_> {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        assert_eq!(step.record.status, Status::Converged);
        let mesh = &*self.model.mesh;
        let u: Vec<Plane> =
            self.model.constraints.dofs.displacements(&step.state.u).iter().map(|u| [u[0], u[1]]).collect();
        let line = ContactLine::all(self.model, step).pop().unwrap();
        let nodes = self.names.map(|name| along(mesh, name));
        // What each slave node exerts on the master.
        let mut exerted = vec![[0.0; 2]; mesh.nodes.len()];
        line.points.iter().for_each(|point| exerted[point.node] = [point.force[0], point.force[1]]);
        let largest = exerted.iter().flatten().fold(0.0_f64, |m, f| m.max(f.abs()));
        let far = u.iter().flatten().fold(0.0_f64, |m, u| m.max(u.abs()));
        let inner = element_forces(mesh, &u);

        // Balance: of nodes without loads, of the slave's nodes, and of the master as a whole with its moments.
        let outer: Vec<usize> = ["lower:bottom", "upper:top"].iter().flat_map(|name| along(mesh, name)).collect();
        for node in (0..mesh.nodes.len()).filter(|node| !outer.contains(node) && !nodes[1].contains(node)) {
            for c in [0, 1] {
                let left = (inner[node][c] + exerted[node][c]).abs();
                assert!(left <= ROUNDING * largest, "{} {node}: {left} of {largest}", step.record.time);
            }
        }
        let moment = |node: usize, f: Plane| mesh.nodes[node][0] * f[1] - mesh.nodes[node][1] * f[0];
        let whole = |side: usize, forces: &[Plane]| {
            nodes[side].iter().fold([0.0; 3], |sum, &node| {
                let f = forces[node];
                [sum[0] + f[0], sum[1] + f[1], sum[2] + moment(node, f)]
            })
        };
        for (on_master, by_slave) in whole(1, &inner).into_iter().zip(whole(0, &exerted)) {
            assert!((on_master - by_slave).abs() <= 10.0 * ROUNDING * largest, "{on_master} {by_slave}");
        }

        // The laws of each slave node: a slave above presses down.
        let down = if self.names[0].starts_with("upper") { -1.0 } else { 1.0 };
        let x = [0, 1].map(|side| nodes[side].iter().map(|node| mesh.nodes[*node][0]).collect::<Vec<_>>());
        let moved = [0, 1].map(|side| nodes[side].iter().map(|node| u[*node]).collect::<Vec<_>>());
        let apart = relative([&x[0], &x[1]], [&moved[0], &moved[1]]);
        let small = ROUNDING * far;
        for (k, node) in nodes[0].iter().enumerate() {
            let (pressure, friction) = (down * exerted[*node][1], exerted[*node][0]);
            let (gap, slip) = (-down * apart[k][1], apart[k][0] - self.last[k][0]);
            assert!(pressure >= -ROUNDING * largest && gap >= -small, "{pressure} {gap}");
            assert!(friction.abs() <= FRICTION * pressure + ROUNDING * largest, "{friction} {pressure}");
            let closed = pressure > 1e-6 * largest;
            let sticks = closed && friction.abs() < FRICTION * pressure - 1e-6 * largest;
            assert!(!closed || gap <= small, "{pressure} {gap}");
            assert!(!sticks || slip.abs() <= small, "{friction} {pressure} {slip}");
            assert!(friction * slip >= -small * largest, "{friction} {slip}");
            self.counts[if sticks { 1 } else { 2 * usize::from(closed) }] += 1;
        }
        self.last = apart;
        ControlFlow::Continue(())
    }
}

#[test]
fn by_displacements_and_forces_alone() {
    let triangles = |elements: [usize; 2]| MeshSource::Given(block(&[1.0, HEIGHT], &elements).into_simplices().into());
    for (side, names) in [(Side::Upper, ["upper:bottom", "lower:top"]), (Side::Lower, ["lower:top", "upper:bottom"])] {
        for (method, linear) in [
            (Method::BN, LinearAlgebra::default()),
            (Method::BN, LinearAlgebra::condensed()),
            (Method::Ip, LinearAlgebra::default()),
        ] {
            let body = bodies(
                (triangles([7, 4]), YOUNG[0]),
                (triangles([10, 5]), YOUNG[1]),
                Some([0.0, HEIGHT].into()),
                equal_increments(20.0, 20),
            );
            let model = Model::build(&pushed(body, side)).unwrap();
            let count = along(&model.mesh, names[0]).len();
            let mut judge = Judge { model: &model, names, last: vec![[0.0; 2]; count], counts: [0; 3] };
            solved(&model, solver(method, linear), &mut judge);
            assert!(judge.counts[1] > 20 && judge.counts[2] > 20, "{:?}", judge.counts);
        }
    }
}
