//! Meshes of several bodies: what is accepted, what they are called, and how meshes are joined.

use crate::common::prelude::*;
use stickslip::body::mesh::MeshError;

fn square(n: usize) -> MeshSource {
    MeshSource::block([1.0, 0.5], [n, 2])
}

fn two() -> MeshSource {
    MeshSource::Bodies(vec![Body::new("lower", square(3)), Body::new("upper", square(4)).at([0.25, 2.0])])
}

/// `mesh` twice, the second time moved by `by`, in one mesh without any join.
fn twice(mesh: &Mesh, by: [f64; 3]) -> Mesh {
    let mut all = mesh.clone();
    let n = mesh.nodes.len();
    all.nodes.extend(mesh.nodes.iter().map(|x| [0, 1, 2].map(|c| x[c] + by[c])));
    let moved = |nodes: &[usize]| nodes.iter().map(|node| node + n).collect::<Vec<_>>();
    all.cells.extend(mesh.cells.iter().map(|cell| Cell { nodes: moved(&cell.nodes), ..cell.clone() }));
    all
}

#[test]
fn bodies_are_joined_in_order() {
    let mesh = two().build().unwrap();
    assert_eq!(mesh.check(), Ok(()));
    let (lower, upper) = (square(3).build().unwrap(), square(4).build().unwrap());
    let n = lower.nodes.len();
    assert_eq!(mesh.nodes[..n], lower.nodes);
    let moved: Vec<_> = upper.nodes.iter().map(|[x, y, _]| [x + 0.25, y + 2.0, 0.0]).collect();
    assert_eq!(mesh.nodes[n..], moved);
    assert_eq!(mesh.groups, ["lower", "upper"]);
    let names = |name: &str| ["bottom", "right", "top", "left"].map(|side| format!("{name}:{side}"));
    assert_eq!(mesh.boundary_names(), [names("lower"), names("upper")].concat());
    let facets = |mesh: &Mesh, name: &str| mesh.boundary(name).unwrap().facets.concat();
    assert_eq!(facets(&mesh, "lower:top"), facets(&lower, "top"));
    assert!(facets(&mesh, "upper:top").into_iter().eq(facets(&upper, "top").into_iter().map(|node| node + n)));
    let bodies = mesh.bodies();
    assert_eq!((bodies.count(), bodies.names()), (2, &["lower".to_string(), "upper".to_string()][..]));
    assert_eq!((bodies.label(0), bodies.label(1)), ("`lower`".to_string(), "`upper`".to_string()));
    assert!(bodies.nodes(0).eq(0..n) && bodies.nodes(1).eq(n..mesh.nodes.len()));
    assert!(bodies.cells(0).eq(0..6) && bodies.cells(1).eq(6..14));
    assert_eq!(two().nodes(), Some((mesh.nodes.len(), 2)));
    assert_eq!(mesh.touching_nodes(&bodies), []);
    // One body keeps its mesh, and messages call it as ever.
    let one = MeshSource::Bodies(vec![Body::new("beam", square(3))]).build().unwrap();
    assert_eq!((&one.nodes, &one.cells), (&lower.nodes, &lower.cells));
    assert_eq!((one.bodies().label(0), one.bodies().names()[0].as_str()), ("the body".to_string(), "beam"));
}

#[test]
fn groups_of_a_body_are_its_own() {
    let mut mesh = Mesh::clone(&square(4).build().unwrap());
    mesh.groups = vec!["core".into(), "rim".into()];
    mesh.cells[2].group = 1;
    let plain = square(2).build().unwrap();
    let all = MeshSource::Bodies(vec![Body::new("a", mesh), Body::new("b", Mesh::clone(&plain)).at([5.0, 0.0])]);
    let all = all.build().unwrap();
    assert_eq!(all.groups, ["a:core", "a:rim", "b"]);
    assert_eq!((all.cells[1].group, all.cells[2].group, all.cells[8].group), (0, 1, 2));
    assert_eq!(all.bodies().names(), ["a", "b"]);
}

#[test]
fn two_pieces_are_two_bodies_and_no_fault() {
    let one = block(&[1.0, 1.0], &[2, 2]);
    let apart = twice(&one, [3.0, 0.0, 0.0]);
    assert_eq!(apart.check(), Ok(()));
    let bodies = apart.bodies();
    assert_eq!(bodies.names(), ["body 1", "body 2"]);
    // Matching interfaces have two nodes in one place, each of its own body; where both are one body that is a fault.
    let matching = twice(&one, [1.0, 0.0, 0.0]);
    assert_eq!(matching.check(), Ok(()));
    assert_eq!(matching.touching_nodes(&matching.bodies()), [(2, 9), (5, 12), (8, 15)]);
    let mut bridged = matching.clone();
    bridged.cells.push(Cell { kind: CellKind::Triangle, nodes: vec![0, 10, 2], group: 0 });
    assert!(matches!(bridged.check(), Err(MeshFault::Degenerate(_) | MeshFault::CoincidentNodes(_))));
    let mut slit = block(&[2.0, 1.0], &[2, 2]);
    let twin = slit.nodes.len();
    slit.nodes.push(slit.nodes[4]);
    slit.cells[3].nodes.iter_mut().filter(|node| **node == 4).for_each(|node| *node = twin);
    assert_eq!(slit.check(), Err(MeshFault::CoincidentNodes(vec![(4, twin)])));
    // In space, and with names from groups.
    let mut boxes = twice(&block(&[1.0; 3], &[1; 3]), [0.0, 0.0, 2.0]);
    boxes.groups = vec!["foot".into(), "head".into()];
    boxes.cells[1].group = 1;
    assert_eq!((boxes.check(), boxes.bodies().names()), (Ok(()), &["foot".to_string(), "head".to_string()][..]));
}

/// Bodies may be of different orders, one body may not.
#[test]
fn an_order_for_each_body() {
    let linear = block(&[1.0, 1.0], &[2, 2]).into_simplices();
    let quadratic = linear.clone().into_second_order();
    let both = MeshSource::Bodies(vec![Body::new("a", linear), Body::new("b", quadratic).at([2.0, 0.0])]);
    let both = both.build().unwrap();
    assert_eq!(both.check(), Ok(()));
    let mut mixed = Mesh::clone(&both);
    let last = mixed.cells.len() - 1;
    mixed.cells[last].kind = CellKind::Triangle;
    mixed.cells[last].nodes.truncate(3);
    assert_eq!(mixed.check(), Err(MeshFault::MixedOrders { elements: (8, last) }));
}

#[test]
fn bodies_that_touch_in_a_node_or_an_edge_are_refused() {
    // Two squares with one common node, and a third one far away, of which nothing is said.
    let mut corner = block(&[2.0, 2.0], &[2, 2]);
    corner.cells = vec![corner.cells[0].clone(), corner.cells[3].clone()];
    corner.nodes[2] = [7.0, 7.0, 0.0];
    corner.nodes[6] = [8.0, 7.0, 0.0];
    corner.nodes.extend([[8.0, 8.0, 0.0], [7.0, 8.0, 0.0]]);
    corner.cells.push(Cell { kind: CellKind::Quadrilateral, nodes: vec![2, 6, 9, 10], group: 0 });
    let joined = Mesh::new(corner.nodes, corner.cells, Vec::new(), Vec::new());
    assert_eq!(joined, Err(MeshFault::Jointed { elements: vec![0, 1], node: 4 }));
    let mut edge = block(&[2.0, 1.0, 2.0], &[2, 1, 2]);
    edge.cells = vec![edge.cells[0].clone(), edge.cells[3].clone()];
    let used: Vec<usize> = (0..edge.nodes.len()).filter(|k| edge.cells.iter().any(|c| c.nodes.contains(k))).collect();
    let place = |node: usize| used.iter().position(|k| *k == node).unwrap();
    edge.cells.iter_mut().flat_map(|cell| &mut cell.nodes).for_each(|node| *node = place(*node));
    let nodes = used.iter().map(|&k| edge.nodes[k]).collect();
    let joined = Mesh::new(nodes, edge.cells, Vec::new(), Vec::new());
    assert!(matches!(joined, Err(MeshFault::Jointed { .. })), "{joined:?}");
}

/// Boundaries of one mesh may be on both bodies.
#[test]
fn a_boundary_of_two_bodies() {
    let mesh = twice(&block(&[1.0, 1.0], &[2, 1]), [3.0, 0.0, 0.0]);
    let top = Boundary { name: "tops".into(), facets: vec![vec![3, 4], vec![9, 10], vec![4, 5], vec![11, 10]] };
    let mesh = Mesh::new(mesh.nodes, mesh.cells, Vec::new(), vec![top]).unwrap();
    assert_eq!(mesh.boundary("tops").unwrap().facets, [[5, 4], [4, 3], [11, 10], [10, 9]]);
}

#[test]
fn what_makes_no_bodies_is_refused() {
    let bodies = |bodies: Vec<Body>| MeshSource::Bodies(bodies);
    let named = |name: &str| Body::new(name, square(2));
    let cube = || Body::new("cube", MeshSource::block([1.0; 3], [1; 3]));
    let half = HalfPlane { size: [1.0, 1.0], contact_width: 2.0, contact_elements: 2, outer_elements: 2, layers: 2 };
    for (source, key, says) in [
        (bodies(Vec::new()), "body", "there is no body"),
        (bodies(vec![named("")]), "body[0].name", "must be a text in one line"),
        (bodies(vec![named("a:b")]), "body[0].name", "no colon"),
        (bodies(vec![named("a"), named("b"), named("a")]), "body[2].name", "another body is called `a`"),
        (bodies(vec![named("a"), Body::new("b", two())]), "body[1].mesh", "made of bodies"),
        (bodies(vec![named("a"), cube()]), "body[1].mesh", "`cube` has 3 dimensions, but `a` has 2"),
        (bodies(vec![named("a"), named("b").at([0.0; 3])]), "body[1].at", "for each dimension"),
        (bodies(vec![named("a").at([0.0, f64::NAN])]), "body[0].at", "finite"),
        (bodies(vec![named("a").at([0.0, 1e60])]), "body[0].at", "overflow"),
        (bodies(vec![named("a"), Body::new("b", square(0))]), "body[1].mesh.elements", "at least 1"),
        (
            bodies(vec![Body::new("b", MeshSource::HalfPlane(half))]),
            "body[0].mesh.contact_width",
            "less than the width",
        ),
    ] {
        let Err(MeshError::Source(fault)) = source.build() else { panic!("accepted: {says}") };
        assert!(fault.key == key && fault.message.contains(says), "{key}, {says}: {fault}");
    }
    // What only the meshes tell.
    let ring = block(&[1.0, 1.0], &[1, 1]).into_axisymmetric().unwrap();
    assert_eq!(ring.geometry, Geometry::Axisymmetric);
    let source = bodies(vec![named("a"), Body::new("ring", ring).at([3.0, 0.0])]);
    let Err(MeshError::Source(fault)) = source.build() else { panic!("accepted") };
    assert!(fault.key == "body[1].mesh" && fault.message.contains("body of revolution"), "{fault}");
}
