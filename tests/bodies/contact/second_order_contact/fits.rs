//! Obstacles that fit curved boundaries of second order, or nearly.

use super::{lines, solve};
use crate::common::prelude::*;

#[derive(Debug, Clone, Copy)]
enum Cells {
    Quadrilaterals,
    Triangles6,
    Quadrilaterals8,
}

/// A quarter of a ring between the radii 1 and 2, `n` elements along each side, those of second order on the circles.
fn quarter(n: usize, cells: Cells) -> Mesh {
    let mesh = ring(1.0, 2.0, n);
    let mut mesh = match cells {
        Cells::Quadrilaterals => return mesh,
        Cells::Triangles6 => mesh.into_simplices().into_second_order(),
        Cells::Quadrilaterals8 => mesh.into_second_order(),
    };
    for side in ["inner", "outer"] {
        let radius = if side == "inner" { 1.0 } else { 2.0 };
        for facet in mesh.boundary(side).unwrap().facets.clone() {
            let x = mesh.nodes[facet[1]];
            mesh.nodes[facet[1]] = x.map(|c| c * radius / norm(x));
        }
    }
    mesh
}

/// The ring on a shaft of that radius, which comes along y by `approach`; `more` are further tables.
fn on_a_shaft(mesh: Mesh, radius: f64, approach: f64, more: &str) -> Model {
    let text = format!(
        "[mesh]\nkind = \"block\"\nsize = [1, 1]\nelements = [1, 1]\n[material]\nyoung = 1\npoisson = 0.3\n\
         [[support]]\nboundary = \"x axis\"\nfix = [\"y\"]\n[[support]]\nboundary = \"y axis\"\nfix = [\"x\"]\n{more}\
         [[contact]]\nboundary = \"inner\"\nfriction = 0\n\
         obstacle = {{ kind = \"cylinder\", radius = {radius}, center = [0, 0], normal = [-1, -1], direction = \"nearest\", \
         motion = {{ translation = [[0, 0, 0], [1, 0, {approach}]] }} }}\n[time]\nend = 1\nincrements = 1\n"
    );
    let mut scene = parsed(&text);
    scene.description.mesh = MeshSource::from(mesh);
    discretise(&scene).unwrap()
}

/// A ring on a shaft that is too thick for it by δ: Lamé's pressure at every node, at corners and between them, whatever the mesh.
#[test]
fn shrink_fits() {
    let sizes = [1e-4, 1e-2].into_iter().flat_map(|delta| [4, 8, 16].map(|n| (delta, n)));
    for (cells, (delta, n)) in [Cells::Triangles6, Cells::Quadrilaterals8]
        .into_iter()
        .flat_map(|cells| sizes.clone().map(move |size| (cells, size)))
    {
        let model = on_a_shaft(quarter(n, cells), 1.0 + delta, 0.0, "");
        let (HistoryOutcome { state, .. }, lines) = lines(&model, &[1.0], SolverChoice::default());
        let (a2, b2, nu) = (1.0, 4.0, 0.3);
        let exact = delta / (1.0 + nu) * (b2 - a2) / ((1.0 - 2.0 * nu) * a2 + b2);
        let off = |pressure: f64| (pressure / exact - 1.0).abs();
        let means = model.contact.nodes.iter().zip(&state.p_n).map(|(contact, p)| off(p / contact.weight));
        let worst = [
            means.fold(0.0, f64::max),
            lines[0].points.iter().map(|point| off(point.sigma_n)).fold(0.0, f64::max),
            lines[0].points.iter().map(|point| (point.gap / delta).abs()).fold(0.0, f64::max),
        ];
        println!(
            "{cells:?}, delta {delta}, n {n}: means {:.2e}, at nodes {:.2e}, gap {:.2e}",
            worst[0], worst[1], worst[2]
        );
        // What is left is the error of the stresses of the ring, of second order.
        let size = 1.57 / n as f64;
        assert!(worst[0].max(worst[1]) < 0.6 * size.powi(2) && worst[2] < 1e-9, "{worst:?}");
        let balance = model.balance(1.0, &state).unwrap();
        assert!(balance.closure < 1e-12, "{balance:?}");
    }
}

/// A part of a ball in a socket that is too small for it, under the pressure all around that squeezes it evenly: all nodes of the contact
/// have about that pressure, along normals of every direction.
#[test]
fn a_ball_in_a_socket() {
    let bricks = block(&[1.0, 1.0, 1.0], &[4, 4, 2]);
    in_a_socket(bricks.clone().into_simplices().into_second_order());
    in_a_socket(bricks.clone().into_prisms().into_second_order());
    in_a_socket(bricks.into_second_order());
}

fn in_a_socket(mut mesh: Mesh) {
    let delta = 1e-3;
    for x in &mut mesh.nodes {
        let ray = [0.8 * x[0] - 0.4, 0.8 * x[1] - 0.4, 1.0];
        let r = (0.6 + 0.4 * x[2]) / norm(ray);
        *x = ray.map(|c| r * c);
    }
    let pressure = 2.5 * delta;
    let sides = ["bottom", "left", "right", "front", "back"];
    let loads = sides.map(|side| format!("[[load]]\nboundary = \"{side}\"\npressure = {pressure}\n")).concat();
    let edge = mesh.nodes.iter().find(|x| x[1].abs() < 1e-12 && x[0] > 0.2 && norm(**x) < 0.61).unwrap();
    let text = format!(
        "[mesh]\nkind = \"block\"\nsize = [1, 1, 1]\nelements = [1, 1, 1]\n[material]\nyoung = 1\npoisson = 0.3\n\
         [[support]]\npoint = [0, 0, 0.6]\nfix = [\"x\", \"y\"]\n[[support]]\npoint = {edge:?}\nfix = [\"y\"]\n{loads}\
         [[contact]]\nboundary = \"top\"\nfriction = 0\n\
         obstacle = {{ kind = \"socket\", radius = {}, center = [0, 0, 0], normal = [0, 0, 1], direction = \"nearest\" }}\n\
         [time]\nend = 1\nincrements = 1\n",
        1.0 - delta
    );
    let mut scene = parsed(&text);
    scene.description.mesh = MeshSource::from(mesh);
    let model = discretise(&scene).unwrap();
    let (HistoryOutcome { state, .. }, lines) = lines(&model, &[1.0], SolverChoice::default());
    let u = model.displacements(1.0, &state.u).unwrap();
    let off = model.mesh.nodes.iter().zip(&u).map(|(x, u)| (0..3).map(|c| (u[c] + delta * x[c]).powi(2)).sum::<f64>());
    let moved = off.fold(0.0, f64::max).sqrt() / delta;
    let worst = lines[0].points.iter().map(|p| (p.sigma_n / pressure - 1.0).abs()).fold(0.0, f64::max);
    let balance = model.balance(1.0, &state).unwrap();
    let kind = model.mesh.cells[0].kind;
    println!("{kind:?}: displacements {moved:.2e}, pressure {worst:.2e}, balance {:.1e}", balance.closure);
    // On a curved face the forces of an even pressure are not quite along the normals of its nodes.
    let [displacements, pressures] = if kind.is_simplex() { [0.02, 0.01] } else { [0.03, 0.015] };
    assert!(moved < displacements && worst < pressures && balance.closure < 1e-12);
}

/// A shaft with clearance that comes to bear on one side: the force of cells of second order is near that of fine ones of the first.
#[test]
fn a_shaft_with_clearance() {
    let outer = "[[support]]\nboundary = \"outer\"\nfix = [\"x\", \"y\"]\n";
    let force = |n: usize, cells: Cells| {
        let model = on_a_shaft(quarter(n, cells), 0.95, 0.051, outer);
        let state = solve(&model, &[1.0], SolverChoice::default(), &mut ()).state;
        let balance = model.balance(1.0, &state).unwrap();
        assert!(balance.closure < 1e-12);
        balance.contact.force[1]
    };
    let fine = [32, 64].map(|n| force(n, Cells::Quadrilaterals));
    assert!((fine[0] / fine[1] - 1.0).abs() < 0.002);
    for cells in [Cells::Triangles6, Cells::Quadrilaterals8] {
        let off = [8, 16, 32].map(|n| force(n, cells) / fine[1] - 1.0);
        println!("{cells:?}: {fine:?} {off:?}");
        assert!(off[0].abs() < 0.06 && off[1].abs() < 0.015 && off[2].abs() < 0.01, "{cells:?}: {off:?}");
    }
}
