//! Triangles of six nodes, tetrahedra of ten, and other cells of second order: stiffness, loads, curved edges, Gmsh meshes.
// Reference figures are quoted as printed.
#![allow(clippy::unwrap_used, clippy::unreadable_literal)]

use crate::common;
use crate::common::solve;
use miette::Diagnostic;
use std::ops::ControlFlow;
use stickslip::algebra::{cross, dot, minus, norm};
use stickslip::body::Model;
use stickslip::body::constraints::{Dofs, assemble, facet_load};
use stickslip::body::fem::{
    Elasticity, Element, body_force, element_stiffness, facet_normals, facet_weights, thermal_forces, traction,
};
use stickslip::body::mesh::{Cell, CellKind, Geometry, Mesh, MeshFault, MeshSource, block, from_gmsh};
use stickslip::run::{Run, discretise};
use stickslip::scene::Scene;
use stickslip::solver::history::Status;
use stickslip_output::{Grid, fields};

const TRIANGLE: [[f64; 3]; 3] = [[1.0, 0.2, 0.0], [3.0, 0.5, 0.0], [1.5, 2.0, 0.0]];
const TETRAHEDRON: [[f64; 3]; 4] = [[0.0; 3], [2.0, 0.1, 0.2], [0.3, 1.5, 0.1], [0.2, 0.4, 1.8]];

/// Returns a mesh of one straight element with these corners.
fn one(kind: CellKind, corners: &[[f64; 3]]) -> Mesh {
    let cell = Cell { kind, nodes: (0..corners.len()).collect(), group: 0 };
    Mesh::new(corners.to_vec(), vec![cell], Vec::new(), Vec::new()).unwrap().into_second_order()
}

/// A mesh, a field and the expected values of its stiffness.
type Case<'a> = (Mesh, &'a dyn Fn([f64; 3]) -> Vec<f64>, [f64; 4]);

/// Entry, trace, norm and energy of one straight element, calculated by an independent program.
#[test]
fn stiffness_of_one_element() {
    let plane = |[x, y, _]: [f64; 3]| vec![0.1 * x + 0.2 * y * y + 0.05 * x * y, 0.3 * x - 0.1 * y + 0.07 * x * x];
    let space = |[x, y, z]: [f64; 3]| {
        vec![0.1 * x + 0.2 * y * y + 0.05 * x * z, 0.3 * x - 0.1 * y + 0.07 * x * x, 0.2 * z + 0.11 * x * y]
    };
    let cases: [Case<'_>; 2] = [
        (
            one(CellKind::Triangle, &TRIANGLE),
            &plane,
            [5.643_812_709_030e-1, 1.515_050_167_224e1, 6.744_839_311_003, 7.373_255_408_654e-1],
        ),
        (
            one(CellKind::Tetrahedron, &TETRAHEDRON),
            &space,
            [2.241_035_197_601e-1, 1.463_025_121_540e1, 4.616_359_753_879, 1.946_411_826_154e-1],
        ),
    ];
    for (mesh, field, expected) in cases {
        let kind = mesh.cells[0].kind;
        let k = element_stiffness(
            kind,
            Geometry::Cartesian,
            &mesh.nodes,
            Element::Bilinear,
            &Elasticity::isotropic(1.0, 0.3),
        )
        .unwrap();
        let u: Vec<f64> = mesh.nodes.iter().flat_map(|&x| field(x)).collect();
        let trace: f64 = (0..k.len()).map(|i| k[i][i]).sum();
        let frobenius = k.iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
        let energy: f64 = k.iter().zip(&u).map(|(row, u_i)| u_i * dot(row, &u)).sum();
        for (found, expected) in [k[0][0], trace, frobenius, energy].into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-12, "{kind:?}: {found:.12e} {expected:.12e}");
        }
    }
}

/// A body rotated together with its forces and material moves as before, rotated.
#[test]
fn frames_do_not_matter() {
    let turn = |[x, y, z]: [f64; 3], d: usize| {
        let (c, s) = (0.7_f64.cos(), 0.7_f64.sin());
        let [x, y, z] = [c * x - s * y, s * x + c * y, z];
        if d == 2 { [x, y, z] } else { [x, c * y - s * z, s * y + c * z] }
    };
    for mesh in [block(&[2.0, 1.0], &[3, 2]), block(&[2.0, 1.0, 1.0], &[2, 1, 1])] {
        let d = mesh.dimension;
        let mut straight = mesh.into_simplices().into_second_order();
        for x in &mut straight.nodes {
            *x = [
                x[0] + 0.05 * x[1] * x[1],
                x[1] + 0.1 * x[0] * x[0],
                x[2] + if d == 3 { 0.1 * x[0] * x[1] } else { 0.0 },
            ];
        }
        let mut turned = straight.clone();
        turned.nodes.iter_mut().for_each(|x| *x = turn(*x, d));
        let left: Vec<usize> = straight.boundary("left").unwrap().nodes();
        let up = if d == 2 { [0.3, 1.0, 0.0] } else { [0.3, 1.0, -0.5] };
        let moved = |mesh: &Mesh, traction: [f64; 3]| {
            let dofs = Dofs::new(mesh, |node, _| left.contains(&node));
            let k = assemble(mesh, &dofs, Element::Bilinear, |_| Elasticity::isotropic(1.0, 0.3)).unwrap();
            dofs.displacements(&solve(&k, &facet_load(mesh, &dofs, mesh.boundary("right").unwrap(), traction)))
        };
        let (u, v) = (moved(&straight, up), moved(&turned, turn(up, d)));
        let size = u.iter().map(|u| norm(*u)).fold(0.0, f64::max);
        assert!(u.iter().zip(&v).all(|(u, v)| norm(minus(turn(*u, d), *v)) < 1e-12 * size));
    }
}

/// Under pressure the corners of a flat triangle of six nodes carry nothing, and the ends of an edge a sixth each.
#[test]
fn consistent_loads() {
    let plane = block(&[3.0, 1.0], &[2, 1]).into_simplices().into_second_order();
    let space = block(&[3.0, 2.0, 1.0], &[2, 1, 1]).into_simplices().into_second_order();
    let top = |mesh: &Mesh| mesh.boundary("top").unwrap().facets[0].clone();
    let near = |found: &[f64], expected: &[f64]| found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15);
    assert!(near(&facet_weights(&plane, &top(&plane)), &[0.25, 1.0, 0.25]));
    assert!(near(&facet_weights(&space, &top(&space)), &[0.0, 0.5, 0.0, 0.5, 0.0, 0.5]));
    // A quadratic traction, its sum and its work on x.
    for (mesh, width) in [(&plane, 1.0), (&space, 2.0)] {
        let up = mesh.dimension - 1;
        let forces = traction(mesh, mesh.boundary("top").unwrap(), |[x, ..], area| area.map(|a| a * x * x));
        let sum = forces.iter().map(|(_, force)| force[up]).sum::<f64>();
        let work = forces.iter().map(|(node, force)| mesh.nodes[*node][0] * force[up]).sum::<f64>();
        assert!((sum - 9.0 * width).abs() < 1e-13 && (work - 20.25 * width).abs() < 1e-13, "{sum} {work}");
    }
    // The mass, and the work of the centrifugal force on the displacements x and x²: ∫ x² dV and ∫ x³ dV.
    for (mesh, area) in [(&plane, 1.0), (&space, 2.0)] {
        let forces = body_force(mesh, |_, [x, ..]| [x, 0.0, 0.0]);
        let work = |power: i32| forces.iter().map(|(node, f)| mesh.nodes[*node][0].powi(power) * f[0]).sum::<f64>();
        for (power, exact) in [(0, 4.5), (1, 9.0), (2, 20.25)] {
            assert!((work(power) - exact * area).abs() < 1e-12, "{power}: {}", work(power));
        }
    }
}

/// The length of a disk's rim of curved triangles agrees with the circle to the fourth power of their size, and its
/// normals are radial to the third.
#[test]
fn curved_boundaries() {
    let errors = [8, 16].map(|n| {
        let disk = disk(n);
        disk.check().unwrap();
        let rim = disk.boundary("rim").unwrap();
        let area: f64 = rim.facets.iter().flat_map(|f| facet_weights(&disk, f)).sum();
        for facet in &rim.facets {
            for (&node, normal) in facet.iter().zip(facet_normals(&disk, facet)) {
                let x = disk.nodes[node];
                assert!(norm(cross(x, normal)) < 10.0 / f64::from(n).powi(3) * norm(normal), "{x:?} {normal:?}");
            }
        }
        area / std::f64::consts::TAU - 1.0
    });
    assert!((errors[0] / errors[1] - 16.0).abs() < 1.0 && errors[1].abs() < 1e-4, "{errors:?}");
}

/// Returns a unit disk of `n` sectors, each with a triangle and two that form a quadrilateral.
fn disk(n: u32) -> Mesh {
    let at = |r: f64, k: u32| {
        let angle = std::f64::consts::TAU * f64::from(k % n) / f64::from(n);
        [r * angle.cos(), r * angle.sin(), 0.0]
    };
    let mut nodes = vec![[0.0; 3]];
    nodes.extend((0..n).map(|k| at(0.5, k)).chain((0..n).map(|k| at(1.0, k))));
    let n = n as usize;
    let (inner, outer) = (|k: usize| 1 + k % n, |k: usize| 1 + n + k % n);
    let cell = |nodes: Vec<usize>| Cell { kind: CellKind::Triangle, nodes, group: 0 };
    let sector = |k: usize| {
        [
            vec![0, inner(k), inner(k + 1)],
            vec![inner(k), outer(k), outer(k + 1)],
            vec![inner(k), outer(k + 1), inner(k + 1)],
        ]
    };
    let cells = (0..n).flat_map(sector).map(cell).collect();
    let rim = stickslip::body::mesh::Boundary {
        name: "rim".into(),
        facets: (0..n).map(|k| vec![outer(k), outer(k + 1)]).collect(),
    };
    let mut mesh = Mesh::new(nodes, cells, Vec::new(), vec![rim]).unwrap().into_second_order();
    let rim: Vec<[usize; 3]> =
        mesh.boundaries[0].facets.clone().iter().flat_map(|facet| mesh.bent_edges(facet)).collect();
    for [_, middle, _] in rim {
        let x = mesh.nodes[middle];
        mesh.nodes[middle] = x.map(|c| c / norm(x));
    }
    mesh
}

/// A disk under pressure at its rim has uniform stress, whatever its curved edges.
#[test]
fn a_disk_under_pressure() {
    let text = r#"
        [mesh]
        kind = "block"
        size = [1, 1]
        elements = [1, 1]
        [material]
        young = 1.0
        poisson = 0.3
        [[support]]
        point = [0, 0]
        fix = ["x", "y"]
        [[support]]
        point = [1, 0]
        fix = ["y"]
        [[load]]
        boundary = "rim"
        pressure = 1e-3
        [time]
        end = 1
        increments = 1
    "#;
    let mut scene = Scene::parse("disk.toml", text, &[]).unwrap();
    scene.description.mesh = MeshSource::from(disk(16));
    let model = discretise(&scene).unwrap();
    let outcome = common::run(&scene, &model, &mut ());
    assert_eq!(outcome.status, Status::Converged);
    let u = model.constraints.dofs.displacements(&outcome.state.u);
    let radial = -1e-3 * 1.3 * 0.4;
    for (x, u) in model.mesh.nodes.iter().zip(&u) {
        assert!((0..2).all(|c| (u[c] - radial * x[c]).abs() < 2e-4 * radial.abs()), "{x:?}: {u:?}");
    }
}

/// Uniform heat causes no stress in a free body, even with curved edges.
#[test]
fn even_heat_makes_no_stress() {
    let mut space = block(&[1.0, 1.0, 1.0], &[2, 1, 1]).into_simplices().into_second_order();
    for x in &mut space.nodes {
        *x = [x[0] + 0.1 * x[1] * x[2], x[1] + 0.1 * x[0] * x[0], x[2] - 0.1 * x[0] * x[1]];
    }
    for mesh in [disk(8), space] {
        let d = mesh.dimension;
        let law = Elasticity::isotropic(1.0, 0.3);
        let dofs = Dofs::new(&mesh, |_, _| false);
        let k = assemble(&mesh, &dofs, Element::Bilinear, |_| law).unwrap();
        // In plane strain, with z constrained, the in-plane strain is (1 + ν) times as large.
        let stretch = if d == 2 { 1.3 } else { 1.0 };
        let u: Vec<f64> = mesh.nodes.iter().flat_map(|x| x[..d].iter().map(|x| stretch * x)).collect();
        let thermal = dofs.forces(thermal_forces(&mesh, Element::Bilinear, false, |_| law, |_, _| 1.0));
        let worst = k.times(&u).unwrap().iter().zip(&thermal).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-14, "{worst:e}");
    }
}

/// Cells turned inside out by a mid-side node are refused, and so are meshes of mixed order.
#[test]
fn unsound_cells_are_refused() {
    let straight = block(&[2.0, 1.0], &[2, 1]).into_simplices().into_second_order();
    let middle = straight.cells[0].nodes[4];
    let moved = |by: [f64; 2]| {
        let mut mesh = straight.clone();
        (0..2).for_each(|c| mesh.nodes[middle][c] += by[c]);
        mesh.check()
    };
    assert_eq!(moved([0.05, 0.05]), Ok(()));
    let Err(MeshFault::Folded(cells)) = moved([-0.6, 0.0]) else { panic!("{:?}", moved([-0.6, 0.0])) };
    assert!(cells.contains(&0), "{cells:?}");
    // A node at a quarter of its edge leaves no volume at the corner there.
    let edge = straight.cells[0].nodes[3];
    let mut quarter = straight.clone();
    quarter.nodes[edge] = [0.25, 0.0, 0.0];
    assert_eq!(quarter.check(), Err(MeshFault::Folded(vec![0])));
    let mut mixed = straight.clone();
    mixed.cells[3].kind = CellKind::Triangle;
    mixed.cells[3].nodes.truncate(3);
    assert_eq!(mixed.check(), Err(MeshFault::MixedOrders { elements: (0, 3) }));
    let mut short = straight;
    short.cells[2].nodes.pop();
    assert_eq!(short.check(), Err(MeshFault::Corners { element: 2, given: 5, needed: 6 }));
}

/// Reads a Gmsh file with the nodes, in Gmsh's order, of one element and its boundary.
#[test]
fn gmsh_files_of_second_order() {
    let file = |mesh: &Mesh, order: &[usize], kind: u8, facet: &[usize], facet_kind: u8| {
        let (d, n) = (mesh.dimension, mesh.nodes.len());
        let lines = |line: &dyn Fn(usize) -> String, count: usize| (0..count).map(line).collect::<Vec<_>>().join("\n");
        let list = |nodes: &[usize]| nodes.iter().map(|k| (k + 1).to_string()).collect::<Vec<_>>().join(" ");
        let entity = "1 0 0 0 1 1 1 1 1 0";
        let entities = if d == 2 { "0 1 1 0" } else { "0 0 1 1" };
        let coordinates = lines(&|k| mesh.nodes[k].map(|c| c.to_string()).join(" "), n);
        format!(
            "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n{} 1 \"side\"\n{d} 1 \"body\"\n$EndPhysicalNames\n\
             $Entities\n{entities}\n{entity}\n{entity}\n$EndEntities\n$Nodes\n1 {n} 1 {n}\n{d} 1 0 {n}\n{}\n{coordinates}\n$EndNodes\n\
             $Elements\n2 2 1 2\n{} 1 {facet_kind} 1\n1 {}\n{d} 1 {kind} 1\n2 {}\n$EndElements\n",
            d - 1,
            lines(&|k| (k + 1).to_string(), n),
            d - 1,
            list(facet),
            list(order),
        )
    };
    let triangle = one(CellKind::Triangle, &TRIANGLE);
    let text = file(&triangle, &[0, 1, 2, 3, 4, 5], 9, &[2, 1, 4], 8);
    let read = from_gmsh("triangle.msh", text.as_bytes(), 1.0).unwrap();
    assert_eq!((&read.nodes, &read.cells[0].nodes), (&triangle.nodes, &triangle.cells[0].nodes));
    assert_eq!(read.cells[0].kind, CellKind::Triangle6);
    // The edge has the body on its left, and its middle node between its ends.
    assert_eq!(read.boundary("side").unwrap().facets, [[1, 4, 2]]);
    assert_eq!(read.boundary("side").unwrap().nodes(), [1, 4, 2]);
    // A clockwise element is turned over.
    let text = file(&triangle, &[0, 2, 1, 5, 4, 3], 9, &[2, 1, 4], 8);
    let turned = from_gmsh("clockwise.msh", text.as_bytes(), 1.0).unwrap();
    assert_eq!(turned.boundary("side").unwrap().facets, [[1, 4, 2]]);
    // Gmsh's last two edges are those from 3 to 2 and from 3 to 1.
    let tetrahedron = one(CellKind::Tetrahedron, &TETRAHEDRON);
    let text = file(&tetrahedron, &[0, 1, 2, 3, 4, 5, 6, 7, 9, 8], 11, &[0, 1, 2, 4, 5, 6], 9);
    let read = from_gmsh("tetrahedron.msh", text.as_bytes(), 1.0).unwrap();
    assert_eq!((&read.nodes, &read.cells[0].nodes), (&tetrahedron.nodes, &tetrahedron.cells[0].nodes));
    assert_eq!(read.boundary("side").unwrap().facets, [[0, 6, 2, 5, 1, 4]]);
    // In another order the element is folded.
    let text = file(&tetrahedron, &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9], 11, &[0, 1, 2, 4, 5, 6], 9);
    let refused = from_gmsh("swapped.msh", text.as_bytes(), 1.0).unwrap_err();
    assert!(refused.to_string().contains("element 2 is folded"), "{refused}");
    assert!(refused.help().unwrap().to_string().contains("HighOrderOptimize"));
}

const BAR: &str = r#"
    [mesh]
    kind = "block"
    size = SIZE
    elements = ELEMENTS
    cells = "CELLS"
    [material]
    young = 210e9
    poisson = 0.3
    [[support]]
    boundary = "left"
    fix = ["x"]
    [[support]]
    point = ORIGIN
    fix = ALL
    [[support]]
    point = BESIDE
    fix = REST
    [[spring]]
    boundary = "bottom"
    normal = 1e3
    [[load]]
    boundary = "right"
    traction = TRACTION
    [time]
    end = 1.0
    increments = 1
    [output]
    fields = true
"#;

/// Observer that keeps the fields.
struct Fields<'a>(&'a Model, &'a mut Vec<Grid>);
impl stickslip::solver::history::Observer for Fields<'_> {
    fn increment(&mut self, step: &stickslip::solver::history::IncrementView<'_>) -> ControlFlow<()> {
        self.1.push(fields(self.0, step));
        ControlFlow::Continue(())
    }
}

/// A pulled bar: stresses in the nodes and at the centre, fields on cells of second order, balanced reactions.
#[test]
fn a_bar_that_is_pulled() {
    for (cells, vtk, d) in [
        ("triangle6", 22, 2),
        ("tetrahedron10", 24, 3),
        ("quadrilateral8", 23, 2),
        ("quadrilateral9", 28, 2),
        ("hexahedron20", 25, 3),
        ("prism15", 26, 3),
    ] {
        let pairs: [[&str; 2]; 7] = [
            ["SIZE", if d == 2 { "[2, 1]" } else { "[2, 1, 1]" }],
            ["ELEMENTS", if d == 2 { "[3, 2]" } else { "[3, 2, 1]" }],
            ["ORIGIN", if d == 2 { "[0, 0]" } else { "[0, 0, 0]" }],
            ["ALL", if d == 2 { "[\"y\"]" } else { "[\"y\", \"z\"]" }],
            ["BESIDE", if d == 2 { "[0, 0]" } else { "[0, 1, 0]" }],
            ["REST", if d == 2 { "[\"y\"]" } else { "[\"z\"]" }],
            ["TRACTION", if d == 2 { "[1e6, 0]" } else { "[1e6, 0, 0]" }],
        ];
        let text = pairs.iter().fold(BAR.replace("CELLS", cells), |text, [from, to]| text.replace(from, to));
        let scene = Scene::parse("bar.toml", &text, &[]).unwrap();
        let model = discretise(&scene).unwrap();
        let mut grids = Vec::new();
        let outcome = common::run(&scene, &model, &mut Fields(&model, &mut grids));
        assert_eq!(outcome.status, Status::Converged);
        let grid = &grids[0];
        assert!(grid.cells.iter().all(|(nodes, kind)| *kind == vtk && nodes.len() == model.mesh.cells[0].nodes.len()));
        let stress = grid.point_fields.iter().find(|field| field.name == "nodal_stress").unwrap();
        let stickslip_output::Values::Real(values) = &stress.values else { panic!() };
        assert_eq!(values.len(), 9 * model.mesh.nodes.len());
        assert!(values.chunks_exact(9).all(|s| (s[0] / 1e6 - 1.0).abs() < 1e-6 && s[1].abs() < 1.0), "{cells}");
        let report = Run::new(&scene).unwrap().solve(&mut ()).unwrap();
        let record = &report.reactions[0];
        assert!(record.balance < 1e-12, "{record:?}");
        assert!((record.supports[0].force[0] + 1e6).abs() < 1e-4, "{record:?}");
    }
}

/// The number of nodes is known before the mesh is made. Cell types of another dimension are refused.
#[test]
fn blocks_of_second_order() {
    let source =
        |cells, axes: usize| MeshSource::segmented(&vec![vec![1.0]; axes], &vec![vec![3]; axes], None, Some(cells));
    let second = CellKind::ALL.into_iter().filter(|kind| kind.is_quadratic());
    for (cells, axes) in second.map(|kind| (kind, kind.dimension())) {
        let source = source(cells, axes).unwrap();
        assert_eq!(source.nodes(), Some((source.build().unwrap().nodes.len(), axes)));
    }
    let fault = source(CellKind::Tetrahedron10, 2).unwrap_err();
    assert!(fault.to_string().contains("mesh.cells have 3 dimensions, but mesh.size has 2"), "{fault}");
}
