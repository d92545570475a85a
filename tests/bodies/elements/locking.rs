//! Nearly incompressible bodies in plane strain: bilinear elements lock, B-bar elements do not.

use crate::common::prelude::*;
use crate::common::solve;

/// A quadrilateral without parallel sides.
const DISTORTED: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [2.0, 0.3, 0.0], [1.7, 1.4, 0.0], [-0.2, 1.1, 0.0]];

/// A linear displacement field of distorted elements leaves every inner node without force, to
/// round-off of the largest entries of K.
#[test]
fn patch_test_of_b_bar() {
    let n = 5;
    let mut mesh = block(&[1.0, 1.0], &[n, n]);
    let h = 1.0 / n as f64;
    let inner = |x: [f64; 3]| x[..2].iter().all(|&c| c > 0.5 * h && c < 1.0 - 0.5 * h);
    for (k, x) in mesh.nodes.iter_mut().enumerate().filter(|(_, x)| inner(**x)) {
        let phase = k as f64 * 2.399_963;
        *x = [x[0] + 0.3 * h * phase.cos(), x[1] + 0.3 * h * (1.7 * phase).sin(), 0.0];
    }
    let dofs = Dofs::new(&mesh, |_, _| false);
    for poisson in [0.0, 0.3, 0.4999, 0.499_999] {
        let material = Elasticity::isotropic(1.0, poisson);
        let k = assemble(&mesh, &dofs, Element::BBar, |_| material).unwrap();
        let [ux, uy] = [[0.3, -0.2], [0.7, 0.4]];
        let u: Vec<f64> = mesh.nodes.iter().flat_map(|[x, y, _]| [ux, uy].map(|g| 0.1 + g[0] * x + g[1] * y)).collect();
        let mut force = k.times(&u).unwrap();
        // The forces of the uniform stress on the sides are all there are.
        let [sx, sy, _, txy, _, _] = material.stress([ux[0], uy[1], 0.0, ux[1] + uy[0], 0.0, 0.0]);
        for (side, [nx, ny]) in
            [("bottom", [0.0, -1.0]), ("right", [1.0, 0.0]), ("top", [0.0, 1.0]), ("left", [-1.0, 0.0])]
        {
            let traction = [sx * nx + txy * ny, txy * nx + sy * ny, 0.0];
            let load = facet_load(&mesh, &dofs, mesh.boundary(side).unwrap(), traction);
            force.iter_mut().zip(load).for_each(|(sum, f)| *sum -= f);
        }
        let worst = largest(&force);
        assert!(worst < 1e-14 * (material.lambda + material.mu), "{worst:e} at nu = {poisson}");
    }
}

/// The pivots of a Cholesky factorisation of K + R Rᵀ, R orthonormal rigid motions: all positive if and
/// only if no other motion is free of energy.
#[test]
fn only_rigid_motions_are_free_of_energy() {
    let about = [0, 1].map(|c| DISTORTED.iter().map(|x| x[c]).sum::<f64>() / 4.0);
    let rotation: Vec<f64> = DISTORTED.iter().flat_map(|x| [about[1] - x[1], x[0] - about[0]]).collect();
    let length = rotation.iter().map(|r| r * r).sum::<f64>().sqrt();
    let translation = |c: usize| (0..8).map(|i| if i % 2 == c { 0.5 } else { 0.0 }).collect::<Vec<f64>>();
    let rigid = [translation(0), translation(1), rotation.iter().map(|r| r / length).collect()];
    for poisson in [0.0, 0.3, 0.4999, 0.499_999] {
        let material = Elasticity::isotropic(1.0, poisson);
        let mut a =
            element_stiffness(CellKind::Quadrilateral, Geometry::Cartesian, &DISTORTED, Element::BBar, &material)
                .unwrap();
        for r in &rigid {
            for row in &a {
                let force: f64 = row.iter().zip(r).map(|(k, r)| k * r).sum();
                assert!(force.abs() < 1e-15 * (material.lambda + material.mu), "{force:e} at nu = {poisson}");
            }
        }
        for r in &rigid {
            for i in 0..8 {
                for j in 0..8 {
                    a[i][j] += r[i] * r[j];
                }
            }
        }
        for p in 0..8 {
            let pivot = a[p].clone();
            assert!(pivot[p] > 0.05, "pivot {p} is {:e} at nu = {poisson}", pivot[p]);
            for row in a.iter_mut().skip(p + 1) {
                let factor = row[p] / pivot[p];
                row.iter_mut().zip(&pivot).for_each(|(x, y)| *x -= factor * y);
            }
        }
    }
}

/// Cook's membrane: the corners (0, 0), (48, 44), (48, 60), (0, 44), clamped at x = 0, with a shear
/// force of 1 in all on x = 48. Returns the displacement upwards of the middle of that side.
fn cook(n: usize, element: Element, material: Elasticity) -> f64 {
    let mut mesh = block(&[1.0, 1.0], &[n, n]);
    for x in &mut mesh.nodes {
        let (bottom, top) = (44.0 * x[0], 44.0 + 16.0 * x[0]);
        *x = [48.0 * x[0], bottom + (top - bottom) * x[1], 0.0];
    }
    let dofs = Dofs::new(&mesh, |node, _| mesh.nodes[node][0] == 0.0);
    let force = facet_load(&mesh, &dofs, mesh.boundary("right").unwrap(), [0.0, 1.0 / 16.0, 0.0]);
    let u = dofs.displacements(&solve(&assemble(&mesh, &dofs, element, |_| material).unwrap(), &force));
    u[(n / 2) * (n + 1) + n][1]
}

/// In plane stress nothing locks, and the literature agrees on 23.96 with nu = 1/3.
#[test]
fn cooks_membrane_in_plane_stress() {
    let tip = cook(64, Element::Bilinear, Elasticity::plane_stress(1.0, 1.0 / 3.0));
    assert!((tip / 23.96 - 1.0).abs() < 2e-3, "{tip}");
}

/// B-bar: 18.21 with 16 x 16 elements, 18.46 with 64 x 64, whatever nu; bilinear: 5.79 and 5.21.
#[test]
fn cooks_membrane_nearly_incompressible() {
    for poisson in [0.4999, 0.499_999] {
        let material = Elasticity::isotropic(1.0, poisson);
        let fine = cook(64, Element::BBar, material);
        assert!((fine / 18.46 - 1.0).abs() < 1e-3, "{fine} at nu = {poisson}");
        let coarse = cook(16, Element::BBar, material);
        assert!((coarse / fine - 1.0).abs() < 0.02, "{coarse}, {fine} at nu = {poisson}");
        let locked = cook(16, Element::Bilinear, material);
        assert!(locked < 0.35 * fine, "{locked}, {fine} at nu = {poisson}");
    }
    // Where nothing locks, the elements agree.
    let ordinary = Elasticity::isotropic(1.0, 0.3);
    let [plain, bar] = [Element::Bilinear, Element::BBar].map(|element| cook(64, element, ordinary));
    assert!((plain / bar - 1.0).abs() < 2e-3, "{plain}, {bar}");
}

/// The displacement (m) of the upper right corner of the paper's block at the end of its history, with
/// nu = 0.4999.
fn block_corner(n: usize, element: &str) -> [f64; 3] {
    let overrides = [
        format!("mesh.elements=[{n}, {n}]"),
        format!("mesh.element=\"{element}\""),
        "material.poisson=0.4999".to_string(),
        "time.increments=10".to_string(),
    ];
    let scene = common::block(&overrides.each_ref().map(String::as_str));
    let model = discretise(&scene).unwrap();
    let outcome = common::run(&scene, &model, &mut common::Keep::default());
    assert_eq!(outcome.status, Status::Converged, "{n} x {n} {element}");
    model.constraints.dofs.displacements(&outcome.state.u)[(n + 1) * (n + 1) - 1]
}

#[test]
fn the_block_in_contact() {
    let fine = block_corner(40, "b-bar");
    let off = |[x, y, _]: [f64; 3]| (x - fine[0]).hypot(y - fine[1]) / fine[0].hypot(fine[1]);
    let [coarse, locked] = ["b-bar", "bilinear"].map(|element| off(block_corner(20, element)));
    assert!(coarse < 0.005, "b-bar is off by {coarse}");
    assert!(locked > 0.3, "bilinear is off by {locked}");
}

/// Triangles that cannot deform at all hold their volume, each of them: the estimate tells all the same, and is silent where a block
/// that cannot deform is none that locks.
#[test]
fn what_is_locked_altogether_is_told() {
    let material = || Material::new(1.0, 0.4999);
    let locking = |description: Description| {
        let model = Model::build(&description).unwrap();
        let report = Run::of(&model, vec![1.0], SolverChoice::default()).unwrap().solve(&mut ()).unwrap();
        report.estimates.locking.unwrap()
    };
    for n in [4, 8, 16] {
        let mut mesh = block(&[1.0, 1.0], &[n, n]).into_simplices();
        for x in &mut mesh.nodes {
            *x = [48.0 * x[0], 44.0 * x[0] + x[1] * (44.0 - 28.0 * x[0]), 0.0];
        }
        let cook = Description::new(MeshSource::from(mesh), material(), vec![1.0]);
        let cook = cook.support("left", &[Axis::X, Axis::Y]).load(Load::new("right", &[0.0, 1.0 / 16.0]));
        // By 245 to 257 %, see doc/method/elements.md.
        assert_eq!(locking(cook), 1.0, "{n}");
    }
    let confined =
        Description::new(MeshSource::from(block(&[1.0, 1.0], &[4, 4]).into_simplices()), material(), vec![1.0]);
    let confined =
        confined.support("bottom", &[Axis::X, Axis::Y]).support("left", &[Axis::X]).support("right", &[Axis::X]);
    assert!(locking(confined.load(Load::new("top", &[0.0, -0.01]))) < 1e-6);
}

/// A beam of linear tetrahedra is stiff in bending; volume has no part in it at nu = 0.3.
#[test]
fn stiffness_in_bending_is_not_called_incompressible() {
    for (poisson, reason) in
        [(0.3, "too stiff in bending; use tetrahedra of second order"), (0.4999, "lock near nu = 0.5")]
    {
        let mesh = block(&[10.0, 0.5, 1.0], &[20, 1, 2]).into_simplices();
        let beam = Description::new(MeshSource::from(mesh), Material::new(1.0, poisson), vec![1.0]);
        let beam = beam.support("left", &[Axis::X, Axis::Y, Axis::Z]).load(Load::new("right", &[0.0, 0.0, -1e-6]));
        let model = Model::build(&beam).unwrap();
        let report = Run::of(&model, vec![1.0], SolverChoice::default()).unwrap().solve(&mut ()).unwrap();
        let is_warned = report.warnings.iter().any(|warning| warning.message.contains(reason));
        assert!(is_warned, "{poisson}: {:?}", report.warnings);
    }
}
