//! What is in front of a boundary: obstacles smaller than it, several of them, boundaries that share nodes.

use crate::common::prelude::*;

const PLANE: &str = "kind = \"plane\", motion = { translation = [[0, 0, 0], [1, 0, 0], [2, 0.5, 0]] }";

fn belt(obstacle: &str) -> (Model, Vec<State>) {
    let scene = parsed(&BELT.replace(&format!("{{ {PLANE} }}"), obstacle));
    let (model, mut keep) = (discretise(&scene).unwrap(), Keep::default());
    assert_eq!(common::run(&scene, &model, &mut keep).status, Status::Converged, "{obstacle}");
    (model, keep.states)
}

pub fn solved(description: &Description) -> (Model, Vec<State>) {
    let (model, mut keep) = (Model::build(description).unwrap(), Keep::default());
    let run = Run::of(&model, model.times().to_vec(), bn()).unwrap();
    assert_eq!(run.history(&mut keep).unwrap().status, Status::Converged);
    (model, keep.states)
}

fn largest_difference(a: &[State], b: &[State]) -> f64 {
    let largest = a.iter().flat_map(|state| &state.u).fold(0.0_f64, |m, u| m.max(u.abs()));
    let pairs = a.iter().flat_map(|state| &state.u).zip(b.iter().flat_map(|state| &state.u));
    pairs.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / largest
}

/// A cylinder under a wider face: what it does not reach stays open and has no unknowns, and the rest is as with a formula that
/// is far away there.
#[test]
fn an_obstacle_smaller_than_the_face_leaves_the_rest_open() {
    let (model, small) = belt("{ kind = \"cylinder\", radius = 0.3, apex = [0.5, 0] }");
    let places: Vec<f64> = model.contact.nodes.iter().map(|contact| contact.position[0]).collect();
    assert_eq!(places, [0.25, 0.375, 0.5, 0.625, 0.75]);
    assert_eq!(model.contact.boundaries[0].unreached, 4);
    let left_out = EliminatedUnknown::all(&model, false, None);
    assert!(left_out.iter().any(|out| (out.count, out.unknown) == (4, "p_n") && out.reason.contains("ever reaches")));
    assert!(left_out.iter().all(|out| !out.reason.contains("along the normal")));
    let formula = "0.3 - sqrt(max(0, 0.09 - (x - 0.5)^2)) + 1e3 * max(0, abs(x - 0.5) - 0.3)";
    let (_, whole) = belt(&format!("{{ kind = \"formula\", formula = \"{formula}\" }}"));
    assert!(largest_difference(&small, &whole) < 1e-9);
    // The load of 1e5 N/m² on 1 m.
    assert!((small[3].p_n.iter().sum::<f64>() - 1e5).abs() < 1e-3);
}

/// A small roller that rolls along: nodes come into its reach and leave it, and the gaps of both ends are those of rollers that
/// stand there.
#[test]
fn a_small_roller_reaches_nodes_later() {
    let rolls = "{ kind = \"cylinder\", radius = 0.2, apex = [0.25, 0], \
                 motion = { translation = [[0, 0, 0], [2, 0.5, 0]] } }";
    let scene = |obstacle: &str| {
        let text = BELT.replace(&format!("{{ {PLANE} }}"), obstacle);
        model_of(&text)
    };
    let model = scene(rolls);
    // From 0.05 to 0.95 in the end.
    assert_eq!(model.contact.nodes.len(), 7);
    for (t, x) in [(0.0, 0.25), (0.5, 0.375), (1.0, 0.5), (2.0, 0.75)] {
        for (contact, gap) in model.contact.nodes.iter().zip(model.loading.gaps_at(t)) {
            let aside = contact.position[0] - x;
            // As far as the boundary is long where the roller is not.
            let expected = if aside.abs() < 0.2 { 0.2 - (0.04 - aside * aside).sqrt() } else { 1.0 };
            assert!((gap - expected).abs() < 1e-12, "{t} {}: {gap} {expected}", contact.position[0]);
        }
    }
    // Straight towards the body it reaches no more than at first.
    let rises = "{ kind = \"cylinder\", radius = 0.2, apex = [0.25, 0], approach = [[0, 0], [2, 1e-3]] }";
    assert_eq!(scene(rises).contact.nodes.len(), 3);
}

/// Two rollers under one face are as the nearer of two gaps at each node; the list may be one of tables or in a line.
#[test]
fn of_several_obstacles_the_nearest_counts() {
    let one = "{ kind = \"cylinder\", radius = 0.3, apex = [0.3, 0] }";
    let other = "{ kind = \"cylinder\", radius = 0.5, apex = [0.7, -1e-5] }";
    let (model, both) = belt(&format!("[{one}, {other}]"));
    let assigned: Vec<usize> = model.contact.nodes.iter().filter_map(ContactNode::obstacle).collect();
    assert_eq!(assigned, [0, 0, 0, 1, 1, 1, 1, 1]);
    let formula = |r: f64, x: f64, y: f64| {
        format!("{y} + {r} - sqrt(max(0, {r}^2 - (x - {x})^2)) + 1e3 * max(0, abs(x - {x}) - {r})")
    };
    let nearer = format!("min({}, {})", formula(0.3, 0.3, 0.0), formula(0.5, 0.7, 1e-5));
    let (_, whole) = belt(&format!("{{ kind = \"formula\", formula = \"{nearer}\" }}"));
    assert!(largest_difference(&both, &whole) < 1e-9);
    let table = |body: &str| {
        format!(
            "[[contact.obstacle]]\n{}\n",
            body.trim_matches(['{', '}', ' ']).replace(", a", "\na").replace(", r", "\nr")
        )
    };
    let text = BELT.replace(&format!("obstacle = {{ {PLANE} }}\n"), &format!("{}{}", table(one), table(other)));
    let scene = parsed_with(&text, &["contact.obstacle[0].radius=0.3"]);
    let by_tables = discretise(&scene).unwrap();
    assert_eq!(by_tables.loading, model.loading);
    let wider = scene.with(&["contact.obstacle.radius=0.4".parse().unwrap()]).unwrap();
    let radii = wider.description.contacts[0].obstacles().iter().map(|o| match o.shape {
        Shape::Cylinder { radius, .. } => radius,
        _ => 0.0,
    });
    assert_eq!(radii.collect::<Vec<_>>(), [0.4, 0.4]);
}

/// A block whose bottom is in the parts that `divide` numbers, by the centres of the edges.
pub fn divided(names: &[&str], divide: impl Fn(f64) -> usize) -> MeshSource {
    let mut mesh: Mesh = block(&[1.0, 0.5], &[8, 4]);
    let facets = mesh.boundary("bottom").unwrap().facets.clone();
    for (k, name) in names.iter().enumerate() {
        let centre = |facet: &Vec<usize>| 0.5 * (mesh.nodes[facet[0]][0] + mesh.nodes[facet[1]][0]);
        let own = facets.iter().filter(|facet| divide(centre(facet)) == k).cloned().collect();
        mesh.boundaries.push(Boundary { name: (*name).to_string(), facets: own });
    }
    MeshSource::Given(Arc::new(mesh))
}

pub fn pushed(source: MeshSource) -> Description {
    Description::new(source, Material::new(1e9, 0.3), vec![0.5, 1.0, 1.5, 2.0])
        .load(Load::new("top", &[0.0, -1e6]).over(&[[0.0, 0.0], [1.0, 1.0], [2.0, 1.0]]))
        .load(Load::new("left", &[1.2e6, 0.0]).over(&[[1.0, 0.0], [2.0, 1.0]]))
        .support("right", &[Axis::X])
}

/// Two boundaries on one plane are as one: the node between them is there once, with the weight of both, and the forces on the
/// boundaries add up. Where friction differs the node between has the mean by area.
#[test]
fn boundaries_that_share_nodes_are_one_contact() {
    let source = divided(&["one", "two"], |x| usize::from(x > 0.4));
    let (model, parts) = solved(&pushed(source.clone()).contact("one", 0.3, Obstacle::plane(0.0)).contact(
        "two",
        0.3,
        Obstacle::plane(0.0),
    ));
    let (whole, all) = solved(&pushed(source.clone()).contact("bottom", 0.3, Obstacle::plane(0.0)));
    assert_eq!((model.contact.nodes.len(), model.problem.mu()), (9, whole.problem.mu()));
    assert!(difference(&parts, &all) < 1e-9);
    let sum = |model: &Model, state: &State| {
        Resultant::all(model, 2.0, state).iter().fold([0.0; 2], |sum, one| [0, 1].map(|c| sum[c] + one.force[c]))
    };
    let ([x, y], [of_x, of_y]) = (sum(&model, &parts[3]), sum(&whole, &all[3]));
    assert!((x - of_x).abs() < 1e-6 * of_y.abs() && (y - of_y).abs() < 1e-9 * of_y.abs());
    let [one, two] = &model.contact.boundaries[..] else { panic!() };
    assert_eq!((one.nodes.len(), two.nodes.len(), one.nodes[3], two.nodes[0]), (4, 6, 3, 3));
    assert_eq!(one.shares(&model.contact.nodes).map(|(_, part)| part).collect::<Vec<_>>(), [1.0, 1.0, 1.0, 0.5]);

    let (solved, _) =
        solved(&pushed(source).contact("one", 0.2, Obstacle::plane(0.0)).contact("two", 0.4, Obstacle::plane(0.0)));
    assert_eq!(solved.problem.mu()[..3], [0.2; 3]);
    assert!((solved.problem.mu()[3] - 0.3).abs() < 1e-15 && solved.problem.mu()[4..] == [0.4; 5]);
}

/// On a shared node the obstacle that is nearer at first counts, whichever contact it is of.
#[test]
fn of_the_obstacles_of_shared_nodes_the_nearest_counts() {
    let source = divided(&["one", "two"], |x| usize::from(x > 0.4));
    let contact = |gaps: [f64; 2]| {
        let [one, two] = gaps.map(|y| Obstacle::at_rest(Shape::PlaneThrough { through: [0.0, -y].into() }));
        let moving = two.approaching(&[[0.0, 0.0], [2.0, 1e-4]]);
        Model::build(&pushed(source.clone()).contact("one", 0.3, one).contact("two", 0.3, moving)).unwrap()
    };
    for (gaps, at_first, in_the_end) in [([1e-3, 2e-3], 1e-3, 1e-3), ([2e-3, 1e-3], 1e-3, 0.9e-3)] {
        let model = contact(gaps);
        let seam = model.contact.nodes.iter().position(|contact| contact.position[0] == 0.375).unwrap();
        assert!((model.loading.gaps_at(0.0)[seam] - at_first).abs() < 1e-15);
        assert!((model.loading.gaps_at(2.0)[seam] - in_the_end).abs() < 1e-15, "{gaps:?}");
    }
}

/// A body in a box that is one boundary: each side sees the wall that it faces, although the floor is nearer to its lower nodes
/// and the other wall is on its line.
#[test]
fn a_box_of_three_walls() {
    let mut mesh: Mesh = block(&[1.0, 0.5], &[4, 8]);
    let sides = ["left", "bottom", "right"].map(|name| mesh.boundary(name).unwrap().facets.clone());
    mesh.boundaries.push(Boundary { name: "skin".into(), facets: sides.concat() });
    let wall = |through: [f64; 2], normal: [f64; 2]| Obstacle {
        normal: Some(normal.into()),
        ..Obstacle::at_rest(Shape::PlaneThrough { through: through.into() })
    };
    let walls = vec![wall([-0.1, 0.0], [-1.0, 0.0]), wall([0.0, -1e-3], [0.0, -1.0]), wall([1.2, 0.0], [1.0, 0.0])];
    let description = Description::new(mesh, Material::new(1e9, 0.3), vec![1.0]).contact("skin", 0.1, walls);
    let model = Model::build(&description).unwrap();
    assert_eq!(model.contact.nodes.len(), 8 + 5 + 8);
    for contact in &model.contact.nodes {
        let [x, y, _] = contact.position;
        let (wall, gap) = match () {
            () if y == 0.0 => (1, 1e-3),
            () if x == 0.0 => (0, 0.1),
            () => (2, 0.2),
        };
        assert_eq!(contact.obstacle(), Some(wall), "{:?}", contact.position);
        assert!((contact.facing.gap - gap).abs() < 1e-15);
    }
}

/// A ring on a shaft that is too thick for it by δ, all around and in four parts that share nodes: the same.
#[test]
fn a_ring_on_a_shaft_in_parts() {
    let (around, across, inner, outer) = (16, 2, 1.0, 1.5);
    let at = |i: usize, j: usize| {
        let angle = std::f64::consts::TAU * i as f64 / around as f64;
        let radius = inner + (outer - inner) * j as f64 / across as f64;
        [radius * angle.cos(), radius * angle.sin(), 0.0]
    };
    let node = |i: usize, j: usize| (i % around) * (across + 1) + j;
    let cells = (0..around).flat_map(|i| (0..across).map(move |j| (i, j))).map(|(i, j)| stickslip::body::mesh::Cell {
        kind: stickslip::body::mesh::CellKind::Quadrilateral,
        nodes: vec![node(i, j), node(i, j + 1), node(i + 1, j + 1), node(i + 1, j)],
        group: 0,
    });
    // The body is on the left of an edge.
    let inside = |from: usize, to: usize| (from..to).map(|i| vec![node(i + 1, 0), node(i, 0)]).rev().collect();
    let quarter = around / 4;
    let mut boundaries: Vec<Boundary> =
        (0..4).map(|k| Boundary { name: format!("q{k}"), facets: inside(k * quarter, (k + 1) * quarter) }).collect();
    boundaries.push(Boundary { name: "bore".into(), facets: inside(0, around) });
    let outside = (0..around).map(|i| vec![node(i, across), node(i + 1, across)]).collect();
    boundaries.push(Boundary { name: "outside".into(), facets: outside });
    let nodes = (0..around).flat_map(|i| (0..=across).map(move |j| at(i, j))).collect();
    let mesh = Mesh {
        dimension: 2,
        geometry: Geometry::Cartesian,
        nodes,
        cells: cells.collect(),
        groups: vec!["ring".into()],
        boundaries,
        notes: Notes::default(),
    };
    let shaft = |normal: [f64; 2]| Obstacle {
        normal: Some(normal.into()),
        direction: GapDirection::Nearest,
        ..Obstacle::at_rest(Shape::Cylinder {
            radius: 1.001,
            place: Place::Apex(normal.map(|c| -1.001 * c).into()),
            axis: None,
        })
    };
    let base = Description::new(mesh, Material::new(1e9, 0.3), vec![1.0]);
    let (whole, once) = solved(&base.clone().contact("bore", 0.3, shaft([-1.0, 0.0])));
    let half = 0.5_f64.sqrt();
    let mut parts = base;
    for (k, normal) in [[-half, -half], [half, -half], [half, half], [-half, half]].into_iter().enumerate() {
        parts = parts.contact(&format!("q{k}"), 0.3, shaft(normal));
    }
    // A facet may be of one contact only: it would count twice.
    let error = Model::build(&parts.clone().contact("bore", 0.3, shaft([-1.0, 0.0]))).unwrap_err().to_string();
    assert!(error.starts_with("contact[4].boundary: the boundaries `q3` and `bore` have the facet at ("), "{error}");
    let (model, four) = solved(&parts);
    assert_eq!((model.contact.nodes.len(), whole.contact.nodes.len()), (around, around));
    let order: Vec<usize> = whole
        .contact
        .nodes
        .iter()
        .map(|contact| model.contact.nodes.iter().position(|other| other.node == contact.node).unwrap())
        .collect();
    let largest = largest(&once[0].p_n);
    assert!(largest > 0.0);
    // All the way round the tangent is the normal turned by +90°, and the tangential forces make up the moment of the shaft.
    for contact in whole.contact.nodes.iter().chain(&model.contact.nodes) {
        let ([x, y, _], [t, _]) = (contact.facing.normal, contact.frame);
        assert!(norm(minus(t, [-y, x, 0.0])) < 1e-15, "{contact:?}");
    }
    for (i, &j) in order.iter().enumerate() {
        assert!((once[0].p_n[i] - four[0].p_n[j]).abs() < 1e-8 * largest, "{i}");
        assert!((whole.contact.nodes[i].weight - model.contact.nodes[j].weight).abs() < 1e-12);
    }
}

/// What has moved before the beginning is where it then is: nodes meet the nearer of two rollers wherever their histories start.
#[test]
fn what_has_moved_before_the_beginning_is_there() {
    let body = |apex: f64, before: f64, approach: f64| {
        let cylinder = |x: f64| Shape::Cylinder { radius: 0.05, place: Place::Apex([x, -1e-4].into()), axis: None };
        let first = Obstacle {
            translation: Some(vec![(0.0, [before, 0.0].into()), (1.0, [before, approach].into())]),
            ..Obstacle::at_rest(cylinder(apex))
        };
        let second = Obstacle::at_rest(cylinder(0.0303)).approaching(&[[0.0, 0.0], [1.0, approach]]);
        let description =
            Description::new(MeshSource::block([0.04, 0.01], [40, 10]), Material::new(5e6, 0.3), vec![1.0])
                .support("top", &[Axis::X, Axis::Y])
                .contact("bottom", 0.0, vec![first, second]);
        Model::build(&description).unwrap()
    };
    let still = body(0.01, 0.0, 2.4e-3);
    for (apex, before) in [(0.02, -0.01), (0.018, -0.008), (0.003, 0.007)] {
        let moved = body(apex, before, 2.4e-3);
        for (a, b) in still.contact.nodes.iter().zip(&moved.contact.nodes) {
            assert_eq!((a.node, a.obstacle()), (b.node, b.obstacle()), "{apex}");
        }
        let (gaps, expected) = (moved.loading.gaps_at(1.0), still.loading.gaps_at(1.0));
        assert!(gaps.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-15), "{apex}");
    }
}
