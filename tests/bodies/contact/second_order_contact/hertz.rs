//! Cylinders, spheres and flat punches on boundaries of second order, with friction and on bodies that hardly change their volume. The
//! forces are those of a program that shares nothing with this one.

use super::{lines, pressed, solve, sums};
use crate::common::prelude::*;
use std::collections::HashMap;

/// A rectangle with the lines `xs` and `ys` of which each square is cut in two, by turns one way and the other.
pub fn alternating(xs: &[f64], ys: &[f64]) -> Mesh {
    let n = xs.len();
    let nodes: Vec<[f64; 3]> = ys.iter().flat_map(|&y| xs.iter().map(move |&x| [x, y, 0.0])).collect();
    let mut cells = Vec::new();
    for (i, j) in (0..ys.len() - 1).flat_map(|j| (0..n - 1).map(move |i| (i, j))) {
        let [a, b, c, d] = [j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i];
        let halves = if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
        cells.extend(halves.map(|nodes| Cell { kind: CellKind::Triangle, nodes: nodes.to_vec(), group: 0 }));
    }
    let edges = |k: &dyn Fn(usize) -> usize| (0..n - 1).map(|i| vec![k(i), k(i + 1)]).collect();
    let top = (ys.len() - 1) * n;
    let boundaries = vec![
        Boundary { name: "bottom".into(), facets: edges(&|i| i) },
        Boundary { name: "top".into(), facets: edges(&|i| top + i) },
    ];
    Mesh::new(nodes, cells, Vec::new(), boundaries).unwrap()
}

/// `n` equal lengths up to `zone`, then `n` more, at least three, in geometric progression up to 1.
pub fn graded(n: usize, zone: f64, end: f64) -> Vec<f64> {
    let (h, k) = (zone / n as f64, n.max(3));
    let sum = |q: f64| (1..=k).map(|i| h * q.powi(i as i32)).sum::<f64>();
    let (mut low, mut high) = (1.0, 50.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        *(if sum(middle) > end - zone { &mut high } else { &mut low }) = middle;
    }
    let mut lines: Vec<f64> = (0..=n).map(|i| zone * i as f64 / n as f64).collect();
    let mut at = zone;
    for i in 0..k {
        at += h * low.powi(i as i32 + 1);
        lines.push(at);
    }
    lines
}

/// Keeps to `name` what of the top is within `zone` of the axis.
pub fn keep_zone(mesh: &mut Mesh, name: &str, zone: f64) {
    let facets = mesh.boundary("top").unwrap().facets.clone();
    let d = mesh.dimension - 1;
    let inside = |facet: &Vec<usize>| facet.iter().all(|&k| mesh.nodes[k][..d].iter().all(|c| c.abs() < 1.0001 * zone));
    let facets = facets.into_iter().filter(inside).collect();
    mesh.boundaries.push(Boundary { name: name.into(), facets });
}

/// A cylinder that is pressed on the zone of a half-plane of triangles.
fn cylinder(n: usize, friction: f64, formula: &str) -> Scene {
    let right = graded(n, 0.03, 1.0);
    let xs: Vec<f64> = right.iter().skip(1).rev().map(|x| -x).chain(right.iter().copied()).collect();
    let ys: Vec<f64> = right.iter().rev().map(|y| -y).collect();
    let mut mesh = alternating(&xs, &ys).into_second_order();
    keep_zone(&mut mesh, "zone", 0.03);
    let mut scene = pressed("triangle6", "[1, 1]", friction, formula, "");
    scene.description.mesh = MeshSource::from(mesh);
    scene.description.contacts[0].boundary = "zone".into();
    scene
}

/// A quarter of a block of such cells, `n` along each axis of the zone, under a formula of the gap.
fn quarter(kind: CellKind, n: usize, friction: f64, formula: &str) -> Scene {
    let lines = graded(n, 0.03, 0.4);
    let outside = lines.len() - 1 - n;
    let ratio = (lines[n + outside] - lines[n + outside - 1]) / (lines[n + 1] - lines[n]);
    let outwards = vec![1.0, ratio];
    let source = MeshSource::segmented(
        &[vec![0.03, 0.37], vec![0.03, 0.37], vec![0.37, 0.03]],
        &[vec![n, outside], vec![n, outside], vec![outside, n]],
        Some(&[outwards.clone(), outwards, vec![1.0 / ratio, 1.0]]),
        Some(kind),
    );
    let mut mesh = (*source.unwrap().build().unwrap()).clone();
    keep_zone(&mut mesh, "zone", 0.03);
    let symmetric =
        "[[support]]\nboundary = \"left\"\nfix = [\"x\"]\n[[support]]\nboundary = \"front\"\nfix = [\"y\"]\n";
    let mut scene = pressed("tetrahedron10", "[1, 1, 1]", friction, formula, symmetric);
    scene.description.mesh = MeshSource::from(mesh);
    scene.description.contacts[0].boundary = "zone".into();
    scene
}

/// Half of the rectangle of such cells, `n` along the zone, under a parabola.
fn half(kind: CellKind, n: usize) -> Scene {
    let lines = graded(n, 0.03, 1.0);
    let outside = lines.len() - 1 - n;
    let ratio = (lines[n + outside] - lines[n + outside - 1]) / (lines[n + 1] - lines[n]);
    let source = MeshSource::segmented(
        &[vec![0.03, 0.97], vec![0.97, 0.03]],
        &[vec![n, outside], vec![outside, n]],
        Some(&[vec![1.0, ratio], vec![1.0 / ratio, 1.0]]),
        Some(kind),
    );
    let mut mesh = (*source.unwrap().build().unwrap()).clone();
    keep_zone(&mut mesh, "zone", 0.03);
    let symmetric = "[[support]]\nboundary = \"left\"\nfix = [\"x\"]\n";
    let mut scene = pressed("triangle6", "[1, 1]", 0.0, "0.5 * x^2 - 0.001", symmetric);
    scene.description.mesh = MeshSource::from(mesh);
    scene.description.contacts[0].boundary = "zone".into();
    scene
}

const SPHERE: &str = "0.5 * (x^2 + y^2) - 4e-4";

fn condensed() -> SolverChoice {
    SolverChoice { linear: Some(LinearAlgebra::condensed()), ..SolverChoice::default() }
}

/// A cylinder on a half-plane: the force as another program finds it on the same mesh, the stresses at the nodes near Hertz'.
#[test]
fn hertz_line_of_second_order() {
    for (n, force) in [(4, 3.811_741_265_8e-4), (8, 3.780_432_604_0e-4)] {
        let model = discretise(&cylinder(n, 0.0, "0.5 * x^2 - 0.001")).unwrap();
        let (outcome, lines) = lines(&model, &[1.0], SolverChoice::default());
        let found = sums(&outcome.state)[0];
        assert!((found / force - 1.0).abs() < 1e-9, "{n}: {found:.10e}");
        let hertz = Hertz::line(found, 1.0, 1.0 / 0.91);
        let inside = lines[0].points.iter().filter(|p| p.x.abs() < 0.8 * hertz.a);
        let off = inside.map(|p| (p.sigma_n - hertz.pressure(p.x)).abs() / hertz.p0);
        let worst = off.fold(0.0, f64::max);
        assert!(worst < 0.03, "{n}: {worst}");
    }
}

/// A quarter of a block of tetrahedra under a punch or a sphere, whose zone is fine: the forces as another program finds them. No corner
/// opens under the flat punch, and the corrected stresses under the sphere are near Hertz'.
#[test]
fn hertz_sphere_and_flat_punch_of_second_order() {
    for (formula, force) in [("0 * x - 1e-4", 8.763_792_915_0e-6), (SPHERE, 1.237_097_934_2e-5)] {
        let model = discretise(&quarter(CellKind::Tetrahedron10, 4, 0.0, formula)).unwrap();
        let solver = SolverChoice { linear: Some(LinearAlgebra::condensed()), ..SolverChoice::default() };
        let facets = &model.mesh.boundary("zone").unwrap().facets;
        let corners: Vec<usize> = facets.iter().flat_map(|f| f.iter().step_by(2)).copied().collect();
        let (outcome, lines) = lines(&model, &[1.0], solver);
        let found = 4.0 * sums(&outcome.state)[0];
        assert!((found / force - 1.0).abs() < 1e-9, "{formula}: {found:.10e}");
        if formula.starts_with('0') && formula.contains("1e-4") {
            let inner = |x: f64| x < 0.0299;
            let open = lines[0]
                .points
                .iter()
                .filter(|p| corners.contains(&p.node) && inner(p.x) && inner(p.y) && p.status == ContactStatus::Open);
            assert_eq!(open.count(), 0);
            assert!(lines[0].points.iter().all(|p| p.status != ContactStatus::Open));
            continue;
        }
        let modulus = 1.0 / 0.91;
        let a = (0.75 * found / modulus).cbrt();
        let p0 = 1.5 * found / (std::f64::consts::PI * a * a);
        let inside = lines[0].points.iter().filter(|p| p.x.hypot(p.y) < 0.8 * a);
        let (mut error, mut whole) = (0.0, 0.0);
        for (point, contact) in inside.map(|p| (p, model.contact.nodes.iter().find(|c| c.node == p.node).unwrap())) {
            let exact = p0 * (1.0 - (point.x.hypot(point.y) / a).powi(2)).sqrt();
            error += contact.weight * (point.sigma_n - exact).powi(2);
            whole += contact.weight * exact * exact;
        }
        let rms = f64::sqrt(error / whole);
        assert!(rms < 0.028, "{rms}");
    }
}

/// The errors of the force and of the largest pressure, and their means over the contact, for a scene of which `share` is
/// meshed. The force is that of much finer meshes, see doc/method/elements.md; the pressures are Hertz' for it.
fn errors(scene: &Scene, share: f64, force: f64) -> [f64; 3] {
    let model = discretise(scene).unwrap();
    let (outcome, lines) = lines(&model, &[1.0], condensed());
    let found = sums(&outcome.state)[0] / share;
    let of = if model.mesh.dimension == 2 { Hertz::line } else { Hertz::sphere };
    let hertz = of(force, 1.0, 1.0 / 0.91);
    let away = |x: [f64; 3]| x[..model.mesh.dimension - 1].iter().map(|c| c * c).sum::<f64>().sqrt();
    let peak = lines[0].points.iter().map(|p| p.sigma_n).fold(0.0, f64::max);
    let (mut error, mut whole) = (0.0, 0.0);
    for (point, contact) in lines[0].points.iter().zip(&model.contact.nodes) {
        let exact = hertz.pressure(away(contact.position));
        error += contact.weight * (point.sigma_n - exact).powi(2);
        whole += contact.weight * exact * exact;
    }
    [found / force - 1.0, peak / hertz.p0 - 1.0, (error / whole).sqrt()]
}

/// A cylinder on quadrilaterals and a sphere on hexahedra of first and second order, with as many nodes along the zone.
#[test]
fn hertz_of_quadrilaterals_and_hexahedra() {
    use CellKind::{Hexahedron, Hexahedron20, Prism15, Quadrilateral, Quadrilateral8, Quadrilateral9};
    let mut all = Vec::new();
    for (kind, sizes, share, force) in [
        (Quadrilateral, &[8, 16, 32][..], 0.5, 3.77283e-4),
        (Quadrilateral8, &[4, 8, 16], 0.5, 3.77283e-4),
        (Quadrilateral9, &[4, 8, 16], 0.5, 3.77283e-4),
        (Hexahedron, &[4, 8], 0.25, 1.2227e-5),
        (Hexahedron20, &[2, 4], 0.25, 1.2227e-5),
        (Prism15, &[2, 4], 0.25, 1.2227e-5),
    ] {
        let plane = kind.dimension() == 2;
        let scene = |n: usize| if plane { half(kind, n) } else { quarter(kind, n, 0.0, SPHERE) };
        let found: Vec<[f64; 3]> = sizes.iter().map(|&n| errors(&scene(n), share, force)).collect();
        let order =
            |k: usize| found.windows(2).map(|pair| (pair[0][k] / pair[1][k]).abs().log2()).collect::<Vec<f64>>();
        println!(
            "{kind:?} {sizes:?}: force, peak, mean {found:.5?}; orders {:.2?} {:.2?} {:.2?}",
            order(0),
            order(1),
            order(2)
        );
        all.push(found);
    }
    // The force is several times as accurate with as many nodes along the zone, and the pressure with as many elements.
    for second in 1..3 {
        for (coarse, first) in all[second].iter().zip(&all[0]) {
            assert!(coarse[0].abs() < 0.25 * first[0].abs(), "{coarse:?} {first:?}");
        }
        let [force, peak, mean] = all[second][2];
        assert!(force.abs() < 5e-4 && peak.abs() < 1e-3 && mean < 0.01, "{force} {peak} {mean}");
        let order = (all[second][0][0] / all[second][2][0]).log2() / 2.0;
        assert!(order > 1.5, "{order}");
    }
    for second in 4..6 {
        let [force, peak, mean] = all[second][1];
        assert!(force.abs() < 0.012 && peak.abs() < 0.02 && mean < 0.12, "{force} {peak} {mean}");
        assert!(force.abs() < 1.5 * all[3][1][0].abs(), "{force}");
    }
}

/// The sphere with 46875 displacements, as a quarter of the body has them.
#[test]
#[ignore = "a minute without optimisation"]
fn hertz_sphere_on_a_fine_mesh() {
    let model = discretise(&quarter(CellKind::Tetrahedron10, 6, 0.0, SPHERE)).unwrap();
    let found = 4.0 * sums(&solve(&model, &[1.0], condensed(), &mut ()).state)[0];
    assert!((found / 1.224_880_853_5e-5 - 1.0).abs() < 1e-9, "{found:.10e}");
}

fn force_of_sphere(kind: CellKind, element: Element, n: usize, poisson: f64) -> f64 {
    let mut scene = quarter(kind, n, 0.0, SPHERE);
    scene.description.element = element;
    scene.description.material.poisson = poisson;
    let model = discretise(&scene).unwrap();
    4.0 * sums(&solve(&model, &[1.0], condensed(), &mut ()).state)[0]
}

/// The sphere on bodies that hardly change their volume, with each of the elements for that.
#[test]
fn hertz_sphere_nearly_incompressible() {
    forces_of_spheres(1);
}

#[test]
#[ignore = "a minute without optimisation"]
fn hertz_sphere_less_incompressible() {
    forces_of_spheres(0);
}

/// With the first or the second of Poisson's ratios, 0.49 and 0.499.
fn forces_of_spheres(which: usize) {
    use CellKind::{Hexahedron, Prism, Tetrahedron, Tetrahedron10};
    for (kind, element, n, expected) in [
        (Tetrahedron10, Element::Bilinear, 4, [1.511_709_333_8e-5, 1.545_840_930_9e-5]),
        (Tetrahedron10, Element::NodalVolume, 4, [1.480_190_847_3e-5, 1.501_385_153_6e-5]),
        (Tetrahedron, Element::NodalVolume, 8, [1.519_829_186_9e-5, 1.549_964_087_5e-5]),
        (Hexahedron, Element::BBar, 8, [1.475_143_836_4e-5, 1.493_378_774_8e-5]),
        (Prism, Element::BBar, 8, [1.524_843_084_1e-5, 1.678_532_696_8e-5]),
    ] {
        let (poisson, expected) = ([0.49, 0.499][which], expected[which]);
        let found = force_of_sphere(kind, element, n, poisson);
        assert!((found / expected - 1.0).abs() < 1e-8, "{kind:?}, {element:?}, nu {poisson}: {found:.10e}");
    }
}

/// Under a sphere prisms with nodal volumes hardly lock: their forces over those of bricks. With B-bar they do, as the forces above show: by
/// 3.4 and 12.4 %.
#[test]
fn hertz_sphere_on_prisms() {
    spheres_on_prisms(0.499, 1.493_378_774_8e-5, 1.021);
}

#[test]
#[ignore = "half a minute without optimisation"]
fn hertz_sphere_on_prisms_less_incompressible() {
    spheres_on_prisms(0.49, 1.475_143_836_4e-5, 1.013);
}

/// With the force on bricks, and that on prisms as a share of it.
fn spheres_on_prisms(poisson: f64, bricks: f64, nodal: f64) {
    let found = force_of_sphere(CellKind::Prism, Element::NodalVolume, 8, poisson) / bricks;
    println!("nu {poisson}: prisms with nodal volumes {found:.4}");
    assert!((found - nodal).abs() < 2e-3, "{poisson}: {found:?}");
}

/// With friction, pressed in four increments, the nodes that stick are one piece without a hole, and so it is with the closed ones:
/// nothing slips or opens inside, be it at corners or between them.
#[test]
fn hertz_with_friction_has_one_core() {
    let line = |n: usize| (cylinder(n, 0.3, "0.5 * x^2"), 1e-3, 2);
    let sphere = (quarter(CellKind::Tetrahedron10, 4, 0.3, "0.5 * (x^2 + y^2)"), 4e-4, 1);
    // Of what is around the core, and around the contact, a line has a piece on each side.
    for (mut scene, depth, around) in [line(8), line(16), sphere] {
        let contact = &mut scene.description.contacts[0];
        contact.against = contact.obstacles()[0].clone().approaching(&[[0.0, 0.0], [1.0, depth]]).into();
        let times = stickslip::base::equal_increments(1.0, 4);
        scene.description.times.clone_from(&times);
        let model = Model::build(&scene.description).unwrap();
        let (_, lines) = lines(&model, &times, condensed());
        let (at_node, neighbours) = neighbours(&model);
        for (k, line) in lines.iter().enumerate() {
            let mut statuses = vec![ContactStatus::Open; model.contact.nodes.len()];
            line.points.iter().for_each(|point| statuses[at_node[&point.node]] = point.status);
            let set = |holds: fn(ContactStatus) -> bool| statuses.iter().map(|s| holds(*s)).collect::<Vec<_>>();
            let (sticks, slides) = (set(|s| s == ContactStatus::Stick), set(|s| s != ContactStatus::Stick));
            let (open, closed) = (set(|s| s == ContactStatus::Open), set(|s| s != ContactStatus::Open));
            let found = [sticks, closed, slides, open].map(|set| pieces(&neighbours, &set));
            assert_eq!(found, [1, 1, around, around], "increment {k}: {statuses:?}");
        }
    }
}

/// The number of the contact node at each node, and for each those next to it: the ends and the middle of an edge, the middles of a triangle.
fn neighbours(model: &Model) -> (HashMap<usize, usize>, Vec<Vec<usize>>) {
    let at_node: HashMap<usize, usize> = model.contact.nodes.iter().enumerate().map(|(i, c)| (c.node, i)).collect();
    let mut all = vec![Vec::new(); model.contact.nodes.len()];
    for facet in &model.mesh.boundary("zone").unwrap().facets {
        for piece in model.mesh.pieces_of(facet) {
            for (a, b) in piece.iter().flat_map(|a| piece.iter().map(move |b| (a, b))).filter(|(a, b)| a != b) {
                all[at_node[a]].push(at_node[b]);
            }
        }
    }
    (at_node, all)
}

/// Into how many pieces the nodes of a set fall.
fn pieces(neighbours: &[Vec<usize>], of: &[bool]) -> usize {
    let mut left = of.to_vec();
    let mut count = 0;
    while let Some(first) = left.iter().position(|left| *left) {
        count += 1;
        let mut front = vec![first];
        left[first] = false;
        while let Some(i) = front.pop() {
            for &j in &neighbours[i] {
                if std::mem::take(&mut left[j]) {
                    front.push(j);
                }
            }
        }
    }
    count
}
