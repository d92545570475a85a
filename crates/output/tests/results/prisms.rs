//! Prisms: stiffness, contact on both kinds of sides, meshes of several cell types, files.
#![allow(clippy::unwrap_used)]

use crate::common;
use crate::common::solve;
use std::ops::ControlFlow;
use stickslip::algebra::{cross, dot, minus};
use stickslip::body::Model;
use stickslip::body::constraints::{Dofs, assemble};
use stickslip::body::fem::{Elasticity, Element, element_stiffness, traction};
use stickslip::body::mesh::{Boundary, Cell, CellKind, Geometry, Mesh, MeshFault, block, from_gmsh};
use stickslip::run::discretise;
use stickslip::scene::Scene;
use stickslip::solver::history::{IncrementView, Observer, Status};
use stickslip_output::fields;

const CORNERS: [[f64; 3]; 6] =
    [[0.0; 3], [2.0, 0.1, 0.0], [0.3, 1.5, 0.1], [0.1, 0.2, 1.8], [2.2, 0.3, 1.6], [0.4, 1.7, 2.0]];

/// Entry, trace, norm and energy of one element, calculated by an independent program.
#[test]
fn stiffness_of_one_prism() {
    let field = |[x, y, z]: [f64; 3]| {
        [0.1 * x + 0.2 * y * y + 0.05 * x * z, 0.3 * x - 0.1 * y + 0.07 * x * x, 0.2 * z + 0.11 * x * y]
    };
    let u: Vec<f64> = CORNERS.iter().flat_map(|&x| field(x)).collect();
    for (element, expected) in [
        (Element::Bilinear, [4.096_086_112_376e-1, 6.695_469_546_415, 2.607_588_459_259, 8.806_470_656_459e-1]),
        (Element::BBar, [3.716_519_265_530e-1, 5.973_063_159_367, 2.506_643_653_099, 8.794_433_147_321e-1]),
    ] {
        let k = element_stiffness(
            CellKind::Prism,
            Geometry::Cartesian,
            &CORNERS,
            element,
            &Elasticity::isotropic(1.0, 0.3),
        )
        .unwrap();
        let trace: f64 = (0..k.len()).map(|i| k[i][i]).sum();
        let frobenius = k.iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
        let energy: f64 = k.iter().zip(&u).map(|(row, u_i)| u_i * dot(row, &u)).sum();
        for (found, expected) in [k[0][0], trace, frobenius, energy].into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-12, "{element:?}: {found:.12e} {expected:.12e}");
        }
    }
}

/// Returns a scene on a block of prisms.
fn pressed(element: &str, poisson: f64, friction: f64) -> Scene {
    let text = format!(
        "[mesh]\nkind = \"block\"\nsize = [1, 1, 1]\nelements = [4, 4, 4]\ncells = \"prism\"\nelement = \"{element}\"\n\
         [material]\nyoung = 1.0\npoisson = {poisson}\n\
         [[support]]\nboundary = \"bottom\"\nfix = [\"x\", \"y\", \"z\"]\n\
         [[contact]]\nboundary = \"top\"\nfriction = {friction}\n\
         obstacle = {{ kind = \"formula\", formula = \"0.1 * ((x - 0.5)^2 + (y - 0.5)^2) - 0.02\" }}\n\
         [time]\nend = 1.0\nincrements = 1\n"
    );
    Scene::parse("pressed.toml", &text, &[]).unwrap()
}

/// A parabola pressed into the top, compared with another program.
#[test]
fn a_parabola_on_a_cube() {
    for (element, poisson, mu, expected) in [
        ("bilinear", 0.3, 0.0, [9.116_710_743_6e-3, 0.0]),
        ("bilinear", 0.3, 0.3, [9.121_633_580_0e-3, 6.083_829_902_0e-4]),
        ("b-bar", 0.49, 0.0, [9.749_197_003_4e-3, 0.0]),
        ("b-bar", 0.49, 0.3, [9.885_707_504_9e-3, 1.980_156_567_5e-3]),
    ] {
        let scene = pressed(element, poisson, mu);
        let model = discretise(&scene).unwrap();
        let outcome = common::run(&scene, &model, &mut ());
        assert_eq!(outcome.status, Status::Converged);
        let friction = outcome.state.p_t.iter().zip(&outcome.state.p_o).map(|(t, o)| t.hypot(*o)).sum::<f64>();
        for (found, expected) in [outcome.state.p_n.iter().sum(), friction].into_iter().zip(expected) {
            let off: f64 = found - expected;
            assert!(off.abs() <= 2e-10 * expected, "{element} {mu}: {found:.10e} {expected:.10e}");
        }
    }
}

/// The force on one eighth of a bonded, nearly incompressible block, compared with another program.
#[test]
fn a_bonded_block() {
    let mesh = block(&[1.0, 1.0, 0.5], &[8, 8, 4]).into_prisms();
    let top = |x: [f64; 3]| x[2] == 0.5;
    let dofs = Dofs::new(&mesh, |node, c| top(mesh.nodes[node]) || mesh.nodes[node][c] == 0.0);
    for (poisson, expected) in [(0.49, 3.330_912_251_8e-2), (0.499, 3.472_152_321_5e-2)] {
        let law = Elasticity::isotropic(1.0, poisson);
        // All displacements are included, to move the top.
        let all = Dofs::new(&mesh, |_, _| false);
        let k = assemble(&mesh, &all, Element::BBar, |_| law).unwrap();
        let moved: Vec<f64> = mesh.nodes.iter().flat_map(|&x| [0.0, 0.0, if top(x) { -0.01 } else { 0.0 }]).collect();
        let force = all.displacements(&k.times(&moved).unwrap());
        let load = dofs.forces(force.into_iter().map(|f| f.map(|f| -f)).enumerate());
        let free = dofs.displacements(&solve(&assemble(&mesh, &dofs, Element::BBar, |_| law).unwrap(), &load));
        let u: Vec<f64> = free.iter().flatten().zip(&moved).map(|(u, moved)| u + moved).collect();
        let reaction = all.displacements(&k.times(&u).unwrap());
        let found: f64 = -mesh.nodes.iter().zip(&reaction).filter(|(x, _)| top(**x)).map(|(_, f)| f[2]).sum::<f64>();
        assert!((found / expected - 1.0).abs() < 1e-9, "{poisson}: {found:.10e}");
    }
}

/// Returns a mesh of a hexahedron, two prisms beside it, and six tetrahedra on these.
fn mixed() -> Mesh {
    let whole = block(&[2.0, 1.0, 2.0], &[2, 1, 2]);
    let with = |e: usize| Mesh { cells: vec![whole.cells[e].clone()], boundaries: Vec::new(), ..whole.clone() };
    let cells = [with(0).cells, with(1).into_prisms().cells, with(3).into_simplices().cells]
        .into_iter()
        .flatten()
        .collect::<Vec<_>>();
    let used: Vec<usize> = (0..whole.nodes.len()).filter(|k| cells.iter().any(|cell| cell.nodes.contains(k))).collect();
    let place = |node: usize| used.binary_search(&node).unwrap();
    let cells: Vec<Cell> = (cells.into_iter())
        .map(|cell| Cell { nodes: cell.nodes.iter().map(|&k| place(k)).collect(), ..cell })
        .collect();
    let mut nodes: Vec<[f64; 3]> = used.iter().map(|&k| whole.nodes[k]).collect();
    for (k, x) in nodes.iter_mut().enumerate() {
        *x = [0, 1, 2].map(|c| x[c] + 0.1 * ((c + 1) as f64 * 2.4 * k as f64).sin());
    }
    let mesh = Mesh::new(nodes, cells, Vec::new(), Vec::new()).unwrap();
    let facets = mesh.surface().into_iter().map(|(facet, _)| facet).collect();
    Mesh::new(mesh.nodes, mesh.cells, Vec::new(), vec![Boundary { name: "all".into(), facets }]).unwrap()
}

/// A linear field leaves only the surface forces of the uniform stress, in cells of three types without parallel sides.
#[test]
fn patch_test_of_mixed_cells() {
    let mesh = mixed();
    let kinds = [CellKind::Hexahedron, CellKind::Prism, CellKind::Tetrahedron];
    assert_eq!(kinds.map(|kind| mesh.cells.iter().filter(|cell| cell.kind == kind).count()), [1, 2, 6]);
    let gradient = [[0.3, -0.2, 0.4], [0.7, 0.4, -0.5], [0.1, 0.6, -0.35]];
    let law = Elasticity::isotropic(1.0, 0.3);
    let dofs = Dofs::new(&mesh, |_, _| false);
    let u: Vec<f64> = mesh.nodes.iter().flat_map(|&x| gradient.map(|row| dot(row, x))).collect();
    let gamma = |a: usize, b: usize| gradient[a][b] + gradient[b][a];
    let [xx, yy, zz, xy, yz, zx] =
        law.stress([gradient[0][0], gradient[1][1], gradient[2][2], gamma(0, 1), gamma(1, 2), gamma(2, 0)]);
    let stress = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
    let load = dofs.forces(traction(&mesh, mesh.boundary("all").unwrap(), |_, area| stress.map(|row| dot(row, area))));
    // With nodal volumes the hexahedron has its own dilatation.
    for element in [Element::Bilinear, Element::NodalVolume] {
        let k = assemble(&mesh, &dofs, element, |_| law).unwrap();
        let worst = k.times(&u).unwrap().iter().zip(&load).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-14, "{element:?}: {worst:e}");
    }
}

/// A quadrilateral of a prism on two triangles of tetrahedra would open between its corners.
#[test]
fn quadrilaterals_do_not_meet_triangles() {
    let whole = block(&[2.0, 1.0, 1.0], &[2, 1, 1]);
    let with = |e: usize| Mesh { cells: vec![whole.cells[e].clone()], boundaries: Vec::new(), ..whole.clone() };
    let cells = [with(0).into_prisms().cells, with(1).into_simplices().cells].concat();
    let fault = Mesh::new(whole.nodes.clone(), cells, Vec::new(), Vec::new()).unwrap_err();
    let MeshFault::Unmatched(pairs) = &fault else { panic!("{fault}") };
    assert!(pairs.iter().all(|(a, b)| *a < 2 && *b >= 2) && pairs.len() == 2, "{pairs:?}");
    assert!(fault.help().contains("Mesh.RecombineAll"));
}

/// One prism in a Gmsh file, with both kinds of sides as boundaries.
#[test]
fn gmsh_files_with_prisms() {
    let list = |nodes: &[usize]| nodes.iter().map(|k| (k + 1).to_string()).collect::<Vec<_>>().join(" ");
    let coordinates = CORNERS.map(|x| x.map(|c| c.to_string()).join(" ")).join("\n");
    let text = format!(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 2 1\n1 0 0 0 1 1 1 1 1 0\n2 0 0 0 1 1 1 1 2 0\n1 0 0 0 1 1 1 0 0\n\
         $EndEntities\n$Nodes\n1 6 1 6\n3 1 0 6\n1\n2\n3\n4\n5\n6\n{coordinates}\n$EndNodes\n\
         $Elements\n3 3 1 3\n2 1 2 1\n1 {}\n2 2 3 1\n2 {}\n3 1 6 1\n3 {}\n$EndElements\n",
        list(&[0, 1, 2]),
        list(&[0, 1, 4, 3]),
        list(&[0, 1, 2, 3, 4, 5]),
    );
    let mesh = from_gmsh("prism.msh", text.as_bytes(), 1.0).unwrap();
    assert_eq!((mesh.cells[0].kind, &mesh.cells[0].nodes[..]), (CellKind::Prism, &[0, 1, 2, 3, 4, 5][..]));
    assert_eq!(mesh.boundary("1").unwrap().facets, [[0, 2, 1]]);
    assert_eq!(mesh.boundary("2").unwrap().facets, [[0, 1, 4, 3]]);
}

/// VTK computes a positive volume if the normal of the first three points is directed towards the other three, which
/// are in the same order.
fn check_wedge(points: &[[f64; 3]], nodes: &[usize]) {
    let at = |k: usize| points[nodes[k]];
    let normal = cross(minus(at(1), at(0)), minus(at(2), at(0)));
    assert!((0..3).all(|k| dot(normal, minus(at(k + 3), at(k))) > 0.0));
    assert!((0..3).all(|k| (at(k + 3)[0] - at(k)[0]).hypot(at(k + 3)[1] - at(k)[1]) < 1e-12));
}

/// Observer that checks the cells of a grid.
struct Seen<'a>(&'a Model);

impl Observer for Seen<'_> {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        let grid = fields(self.0, step);
        assert!(grid.cells.iter().all(|(nodes, kind)| *kind == 13 && nodes.len() == 6));
        grid.cells.iter().for_each(|(nodes, _)| check_wedge(&grid.points, nodes));
        ControlFlow::Continue(())
    }
}

#[test]
fn wedges_of_vtk() {
    let scene = pressed("bilinear", 0.3, 0.0);
    let model = discretise(&scene).unwrap();
    common::run(&scene, &model, &mut Seen(&model));
}
