//! Refinement of triangles and tetrahedra by bisection: the meshes conform. Where edges are straight, they are nested, and
//! their angles stay above a bound that depends on the first mesh alone.
//!
//! Each cell has an edge at whose middle it is divided. In a triangle it is the edge opposite the newest corner; in a
//! tetrahedron it is one of the edges that are marked in its sides, of which each child inherits one (Arnold, Mukherjee and
//! Pouly, SIAM J. Sci. Comput. 22 (2000) 431). In the first mesh the longest edges are marked.

use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

use super::{Boundary, Cell, CellKind, Facet, Mesh, sorted};
use crate::algebra::vector::{across, cross, dot, minus, norm, plus};

/// The largest distance of a surface from the middle of its chord, as a share of the height of the cells at it.
const FOLDING: f64 = 0.25;

/// The ends of an edge, the lower number first.
type Edge = [usize; 2];

/// The surface of which facets of a first mesh are chords.
pub(crate) trait Round: fmt::Debug + Send + Sync {
    /// Returns the unit normal of a facet.
    fn normal(&self, facet: usize) -> [f64; 3];

    /// Returns the point of the surface at these shares of the corners of a facet, m; `None` if the facet is flat.
    fn point(&self, facet: usize, shares: [f64; 3]) -> Option<[f64; 3]>;
}

/// A place on the surface: a facet, and the shares of its corners.
type SurfacePlace = (usize, [f64; 3]);

/// A triangle, or a tetrahedron.
#[derive(Debug, Clone)]
struct Simplex {
    /// The corners; a triangle has three.
    corners: [usize; 4],
    /// The edge at whose middle it is divided.
    edge: Edge,
    /// The edge that is marked in the side opposite each corner of a tetrahedron.
    marked: [Edge; 4],
    /// `true` if the new side between its two children is marked at an edge of the newest corner, where the marked edges
    /// are in one plane: the flag of Arnold et al.
    turns: bool,
    /// The facet of the first mesh on which the side opposite each corner lies.
    facets: [Option<usize>; 4],
    /// The material group.
    group: usize,
    /// The number of times that it is to be divided.
    due: usize,
}

/// A mesh of triangles or of tetrahedra that is refined by bisection.
#[derive(Debug, Clone)]
pub struct Bisection {
    /// The first mesh without cells and nodes.
    first: Mesh,
    is_quadratic: bool,
    nodes: Vec<[f64; 3]>,
    simplices: Vec<Simplex>,
    /// The surface on which new nodes are, if it is curved, and the places of nodes on it.
    round: Option<Arc<dyn Round>>,
    places: HashMap<usize, Vec<SurfacePlace>>,
    /// The corners of each facet of the boundaries of the first mesh.
    facets: Vec<Facet>,
    /// The facets of each boundary, in order.
    of_boundaries: Vec<Vec<usize>>,
}

fn edge(a: usize, b: usize) -> Edge {
    [a.min(b), a.max(b)]
}

/// Returns the edges between these `corners`.
fn edges(corners: &[usize]) -> impl Iterator<Item = Edge> {
    corners.iter().enumerate().flat_map(|(k, &a)| corners[..k].iter().map(move |&b| edge(a, b)))
}

/// Returns the least height of a triangle or a tetrahedron.
fn height(corners: &[[f64; 3]]) -> f64 {
    let [a, b] = [1, 2].map(|k| minus(corners[k], corners[0]));
    let Some(&top) = corners.get(3) else {
        let longest = [norm(a), norm(b), norm(minus(a, b))].into_iter().fold(0.0, f64::max);
        return norm(cross(a, b)) / longest;
    };
    let volume = dot(cross(a, b), minus(top, corners[0])).abs();
    let area = |skipped: usize| {
        let own: Vec<[f64; 3]> = (0..4).filter(|k| *k != skipped).map(|k| corners[k]).collect();
        norm(cross(minus(own[1], own[0]), minus(own[2], own[0])))
    };
    volume / (0..4).map(area).fold(0.0, f64::max)
}

fn between(x: [f64; 3], y: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|c| 0.5 * (x[c] + y[c]))
}

impl Simplex {
    /// Returns the child that keeps one end of the divided edge and has the `middle` in place of the other, `ends` by
    /// their places among the corners of a cell of `dimension`.
    fn child(&self, dimension: usize, [kept, dropped]: [usize; 2], middle: usize) -> Simplex {
        let mut child = self.clone();
        child.due = self.due.saturating_sub(1);
        child.corners[dropped] = middle;
        child.facets[kept] = None;
        let [a, b] = [kept, dropped].map(|k| self.corners[k]);
        let apart: Vec<usize> = (0..=dimension).filter(|k| ![kept, dropped].contains(k)).collect();
        let &[c, d] = &apart[..] else {
            child.edge = edge(a, self.corners[apart[0]]);
            return child;
        };
        let [corner_c, corner_d] = [c, d].map(|k| self.corners[k]);
        // The side opposite the middle is a side of the parent. The sides that are halved are marked opposite the middle.
        child.edge = self.marked[dropped];
        child.marked[c] = edge(a, corner_d);
        child.marked[d] = edge(a, corner_c);
        // The marked edges of the parent are in one plane if they meet in a corner that is not divided.
        let meet_in = |corner: usize| self.marked[dropped] == edge(a, corner) && self.marked[kept] == edge(b, corner);
        let common = [corner_c, corner_d].into_iter().find(|corner| meet_in(*corner));
        child.marked[kept] = match common {
            Some(corner) if self.turns => edge(middle, corner),
            _ => edge(corner_c, corner_d),
        };
        child.turns = common.is_some() && !self.turns;
        child
    }
}

impl Bisection {
    /// Prepares the refinement of `mesh`; `None` if it has other cells than triangles or tetrahedra.
    pub fn new(mesh: &Mesh) -> Option<Self> {
        if mesh.cells.iter().any(|cell| !cell.kind.is_simplex()) {
            return None;
        }
        let corners = mesh.dimension + 1;
        let mut of_boundaries = Vec::with_capacity(mesh.boundaries.len());
        let (mut facets, mut by_corners) = (Vec::new(), HashMap::<Facet, usize>::new());
        for boundary in &mesh.boundaries {
            let number = |facet: &Facet| {
                let step = if mesh.is_quadratic(facet) { 2 } else { 1 };
                let facet: Facet = facet.iter().copied().step_by(step).collect();
                *by_corners.entry(sorted(&facet)).or_insert_with(|| {
                    facets.push(facet);
                    facets.len() - 1
                })
            };
            of_boundaries.push(boundary.facets.iter().map(number).collect());
        }
        // Equal lengths are in the order of the nodes, so that neighbours mark the same edge.
        let length = |[a, b]: Edge| {
            let along = minus(mesh.nodes[b], mesh.nodes[a]);
            dot(along, along)
        };
        let longest = |corners: &[usize]| {
            let all = edges(corners).max_by(|a, b| length(*a).total_cmp(&length(*b)).then(a.cmp(b)));
            all.unwrap_or_default()
        };
        let simplex = |cell: &Cell| {
            let own = &cell.nodes[..corners];
            let side = |k: usize| -> Facet { own.iter().copied().filter(|node| Some(node) != own.get(k)).collect() };
            Simplex {
                corners: std::array::from_fn(|k| own.get(k).copied().unwrap_or_default()),
                edge: longest(own),
                marked: std::array::from_fn(|k| longest(&side(k))),
                turns: false,
                facets: std::array::from_fn(|k| by_corners.get(&sorted(&side(k))).copied()),
                group: cell.group,
                due: 0,
            }
        };
        Some(Bisection {
            first: Mesh { nodes: Vec::new(), cells: Vec::new(), ..mesh.clone() },
            is_quadratic: mesh.cells.iter().any(|cell| cell.kind.is_quadratic()),
            nodes: mesh.nodes.clone(),
            simplices: mesh.cells.iter().map(simplex).collect(),
            round: None,
            places: HashMap::new(),
            facets,
            of_boundaries,
        })
    }

    /// Lets new nodes of these `facets` lie on the surface `round`.
    ///
    /// # Errors
    /// The middle of an edge from which the surface is further away than a share of the height of a cell, which might fold.
    pub(crate) fn follow(mut self, facets: &[Facet], round: Arc<dyn Round>) -> Result<Self, [f64; 3]> {
        for (f, facet) in facets.iter().enumerate() {
            let step = if facet.len() > self.first.dimension { 2 } else { 1 };
            for (k, &node) in facet.iter().step_by(step).enumerate() {
                let shares = std::array::from_fn(|j| f64::from(u8::from(j == k)));
                self.places.entry(node).or_default().push((f, shares));
            }
        }
        self.round = Some(round);
        for simplex in self.simplices.iter().filter(|_| !self.is_quadratic) {
            let own = &simplex.corners[..=self.first.dimension];
            let height = height(&own.iter().map(|&node| self.nodes[node]).collect::<Vec<_>>());
            if let Some(edge) = edges(own).find(|&edge| self.sag(edge) > FOLDING * height) {
                return Err(between(self.nodes[edge[0]], self.nodes[edge[1]]));
            }
        }
        Ok(self)
    }

    /// Returns the point of the surface over the middle of an edge, m, and its places there; none if the edge is inside.
    fn middle(&self, [a, b]: Edge) -> ([f64; 3], Vec<SurfacePlace>) {
        let chord = between(self.nodes[a], self.nodes[b]);
        let (Some(round), Some(of_a), Some(of_b)) = (&self.round, self.places.get(&a), self.places.get(&b)) else {
            return (chord, Vec::new());
        };
        let common = |(f, x): &SurfacePlace| Some((*f, between(*x, of_b.iter().find(|(g, _)| g == f)?.1)));
        let places: Vec<SurfacePlace> = of_a.iter().filter_map(common).collect();
        let points: Vec<_> = places.iter().map(|(f, shares)| round.point(*f, *shares)).collect();
        let mut moved = points.iter().flatten().next().map_or([0.0; 3], |point| minus(*point, chord));
        // Beside a flat facet the edge stays in its plane.
        for ((f, _), _) in places.iter().zip(&points).filter(|(_, point)| point.is_none()) {
            moved = across(moved, round.normal(*f));
        }
        (plus(chord, 1.0, moved), places)
    }

    /// Returns the distance of the surface from the middle of an edge, m.
    fn sag(&self, edge: Edge) -> f64 {
        norm(minus(self.middle(edge).0, between(self.nodes[edge[0]], self.nodes[edge[1]])))
    }

    /// Returns the mean square of the angle between the edges of each cell, from corner to corner, and the curved surfaces of
    /// which they are chords: a twelfth of the square of the angle by which the surface turns along the edge.
    pub(crate) fn angles(&self) -> impl Iterator<Item = f64> {
        let turn = |[a, b]: Edge| (8.0 * self.sag([a, b]) / norm(minus(self.nodes[b], self.nodes[a]))).powi(2) / 12.0;
        let corners = self.first.dimension + 1;
        self.simplices.iter().map(move |simplex| edges(&simplex.corners[..corners]).map(turn).fold(0.0, f64::max))
    }

    /// Divides the cells with these numbers in [`Bisection::mesh`] until they have half the size, and others until the
    /// mesh conforms.
    pub fn refine(&mut self, cells: &[usize]) {
        let corners = self.first.dimension + 1;
        let mut middles = HashMap::<Edge, usize>::new();
        for &k in cells {
            self.simplices[k].due = self.first.dimension;
        }
        let mut due = cells.to_vec();
        while !due.is_empty() {
            for k in due {
                let divided = self.simplices[k].edge;
                let middle = *middles.entry(divided).or_insert_with(|| self.divide(divided));
                let [kept, dropped] = divided.map(|end| self.simplices[k].corners.iter().position(|node| *node == end));
                let (Some(kept), Some(dropped)) = (kept, dropped) else { continue };
                let dimension = self.first.dimension;
                let parent = &self.simplices[k];
                let [first, second] =
                    [[kept, dropped], [dropped, kept]].map(|ends| parent.child(dimension, ends, middle));
                self.simplices[k] = first;
                self.simplices.push(second);
            }
            let hangs = |simplex: &Simplex| edges(&simplex.corners[..corners]).any(|edge| middles.contains_key(&edge));
            let is_due = |simplex: &Simplex| simplex.due > 0 || hangs(simplex);
            due = (0..self.simplices.len()).filter(|&k| is_due(&self.simplices[k])).collect();
        }
    }

    /// Adds the node at the middle of an edge.
    fn divide(&mut self, edge: Edge) -> usize {
        let (middle, places) = self.middle(edge);
        self.nodes.push(middle);
        let new = self.nodes.len() - 1;
        if !places.is_empty() {
            self.places.insert(new, places);
        }
        new
    }

    /// Returns the mesh, of the order, groups and boundaries of the first one.
    pub fn mesh(&self) -> Mesh {
        let dimension = self.first.dimension;
        let kind = if dimension == 2 { CellKind::Triangle } else { CellKind::Tetrahedron };
        // Middles of edges that were not divided are nodes of the first mesh, but no corners.
        let mut numbers = vec![None; self.nodes.len()];
        let mut nodes = Vec::new();
        for &corner in self.simplices.iter().flat_map(|simplex| &simplex.corners[..=dimension]) {
            numbers[corner].get_or_insert_with(|| {
                nodes.push(self.nodes[corner]);
                nodes.len() - 1
            });
        }
        let renumbered = |all: &[usize]| all.iter().filter_map(|corner| numbers[*corner]).collect::<Vec<usize>>();
        let mut parts: Vec<Vec<Facet>> = vec![Vec::new(); self.facets.len()];
        let mut cells = Vec::with_capacity(self.simplices.len());
        for simplex in &self.simplices {
            let own = &simplex.corners[..=dimension];
            let cell = Cell { kind, nodes: own.to_vec(), group: simplex.group };
            for side in cell.facets() {
                let opposite = (0..=dimension).find(|&k| !side.contains(&own[k]));
                if let Some(facet) = opposite.and_then(|k| simplex.facets[k]) {
                    parts[facet].push(side);
                }
            }
            cells.push(Cell { nodes: renumbered(own), ..cell });
        }
        for (whole, parts) in self.facets.iter().zip(&mut parts) {
            // Edges follow one another.
            let from = |part: &Facet| norm(minus(self.nodes[part[0]], self.nodes[whole[0]]));
            if dimension == 2 {
                parts.sort_by(|a, b| from(a).total_cmp(&from(b)));
            }
        }
        let boundary = |(boundary, facets): (&Boundary, &Vec<usize>)| Boundary {
            name: boundary.name.clone(),
            facets: facets.iter().flat_map(|&facet| parts[facet].iter().map(|part| renumbered(part))).collect(),
        };
        let boundaries = self.first.boundaries.iter().zip(&self.of_boundaries).map(boundary).collect();
        let mesh = Mesh { nodes, cells, boundaries, ..self.first.clone() };
        if !self.is_quadratic {
            return mesh;
        }
        let mut mesh = mesh.into_second_order();
        for (cell, simplex) in mesh.cells.iter().zip(&self.simplices) {
            for (ends, &middle) in cell.kind.properties().edges.iter().zip(&cell.nodes[dimension + 1..]) {
                let (position, places) = self.middle(ends.map(|k| simplex.corners[k]));
                if !places.is_empty() {
                    mesh.nodes[middle] = position;
                }
            }
        }
        mesh
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::vector::unit;
    use crate::body::mesh::block;

    fn following(mesh: &Mesh) -> Bisection {
        let facets: Vec<Facet> = mesh.surface().into_iter().map(|(facet, _)| facet).collect();
        let round = crate::body::contact::RoundSurface::new(mesh, facets.clone());
        Bisection::new(mesh).unwrap().follow(&facets, Arc::new(round)).unwrap()
    }

    /// A generator of numbers that look random.
    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn volume(mesh: &Mesh, cell: &Cell) -> f64 {
        let x = |k: usize| mesh.nodes[cell.nodes[k]];
        let [a, b] = [1, 2].map(|k| minus(x(k), x(0)));
        if mesh.dimension == 2 {
            return 0.5 * (a[0] * b[1] - a[1] * b[0]);
        }
        let normal = crate::algebra::vector::cross(a, b);
        dot(normal, minus(x(3), x(0))) / 6.0
    }

    /// Returns the least volume of a cell as a share of the power of its longest edge.
    fn least_shape(mesh: &Mesh) -> f64 {
        let of_cell = |cell: &Cell| {
            let length = |[a, b]: Edge| norm(minus(mesh.nodes[b], mesh.nodes[a]));
            let longest = edges(&cell.nodes[..=mesh.dimension]).map(length).fold(0.0, f64::max);
            volume(mesh, cell) / longest.powi(mesh.dimension as i32)
        };
        mesh.cells.iter().map(of_cell).fold(f64::INFINITY, f64::min)
    }

    /// Returns the least angle between two sides of a cell.
    fn least_angle(mesh: &Mesh) -> f64 {
        let of_cell = |cell: &Cell| {
            let normals: Vec<[f64; 3]> = cell.facets().iter().map(|side| unit(mesh.area_vector(side))).collect();
            let angle = |[a, b]: Edge| (-dot(normals[a], normals[b])).acos();
            edges(&(0..normals.len()).collect::<Vec<_>>()).map(angle).fold(f64::INFINITY, f64::min)
        };
        mesh.cells.iter().map(of_cell).fold(f64::INFINITY, f64::min)
    }

    fn distorted(mut mesh: Mesh, state: &mut u64) -> Mesh {
        let dimension = mesh.dimension;
        for x in &mut mesh.nodes {
            let inside = (0..dimension).all(|c| x[c] > 1e-9 && x[c] < 1.0 - 1e-9);
            for x in x.iter_mut().take(dimension).filter(|_| inside) {
                *x += 0.08 * (random(state) - 0.5);
            }
        }
        mesh
    }

    #[test]
    fn refined_meshes_conform_and_keep_volumes_boundaries_and_shapes() {
        let (mut state, mut bisections) = (7, 0);
        for round in 0..60 {
            let (plane, space) = (block(&[1.0, 1.0], &[3, 3]), block(&[1.0, 1.0, 1.0], &[2, 3, 2]));
            let first = distorted(if round % 2 == 0 { plane } else { space }.into_simplices(), &mut state);
            let first = if round % 3 == 0 { first.into_second_order() } else { first };
            let mut first = first;
            first.groups = ["even", "odd"].map(str::to_string).to_vec();
            first.cells.iter_mut().enumerate().for_each(|(e, cell)| cell.group = e % 2);
            let mut bisection = Bisection::new(&first).unwrap();
            let bounds = [least_shape(&first), least_angle(&first)];
            for level in 0..if first.dimension == 2 { 6 } else { 2 } {
                let mesh = bisection.mesh();
                let share = if level % 2 == 0 { 0.3 } else { 0.05 };
                // Meshes are refined most towards a corner.
                let is_marked = |e: &usize| random(&mut state) < share || norm(mesh.centre(*e)) < 0.5_f64.powi(level);
                let marked: Vec<usize> = (0..mesh.cells.len()).filter(is_marked).collect();
                bisection.refine(&marked);
            }
            let mesh = bisection.mesh();
            mesh.check().unwrap();
            assert_eq!(
                mesh.surface().len(),
                mesh.boundaries.iter().map(|b| b.facets.len()).sum::<usize>(),
                "hanging nodes"
            );
            bisections += mesh.cells.len() - first.cells.len();
            for group in 0..2 {
                let volume = |mesh: &Mesh| -> f64 {
                    mesh.cells.iter().filter(|cell| cell.group == group).map(|cell| volume(mesh, cell)).sum()
                };
                let [now, before] = [&mesh, &first].map(volume);
                assert!((now / before - 1.0).abs() < 1e-12, "{group}: {now} {before}");
            }
            for (boundary, old) in mesh.boundaries.iter().zip(&first.boundaries) {
                let area = |mesh: &Mesh, boundary: &Boundary| {
                    boundary.facets.iter().map(|facet| norm(mesh.area_vector(facet))).sum::<f64>()
                };
                assert!((area(&mesh, boundary) - area(&first, old)).abs() < 1e-12, "{}", boundary.name);
            }
            let shares = if first.dimension == 2 { [0.25, 0.5] } else { [0.05, 0.2] };
            for ((least, bound), share) in [least_shape(&mesh), least_angle(&mesh)].into_iter().zip(bounds).zip(shares)
            {
                assert!(least > share * bound, "{} dimensions: {least} {bound}", first.dimension);
            }
        }
        assert!(bisections > 10_000, "{bisections}");
    }

    /// The edges of a boundary run along it, each from where the last one ended.
    #[test]
    fn edges_of_a_refined_boundary_follow_one_another() {
        let mut bisection = Bisection::new(&block(&[2.0, 1.0], &[4, 2]).into_simplices()).unwrap();
        for _ in 0..5 {
            bisection.refine(&[0, 3, 5]);
        }
        for boundary in &bisection.mesh().boundaries {
            assert!(boundary.facets.windows(2).all(|pair| pair[0][1] == pair[1][0] || pair[0][0] == pair[1][1]));
        }
    }

    /// New nodes on a curved edge lie on the circle through its nodes.
    #[test]
    fn curved_edges_stay_curved() {
        let mut mesh = block(&[1.0, 1.0], &[1, 1]).into_simplices().into_second_order();
        let bottom = mesh.boundary("bottom").unwrap().facets[0].clone();
        mesh.nodes[bottom[1]][1] = -0.1;
        let mut bisection = following(&mesh);
        for _ in 0..6 {
            bisection.refine(&(0..bisection.mesh().cells.len()).collect::<Vec<_>>());
        }
        let mesh = bisection.mesh();
        mesh.check().unwrap();
        let nodes = mesh.boundary("bottom").unwrap().nodes();
        assert!(nodes.len() > 16);
        for [x, y, _] in mesh.points(&nodes) {
            assert!(((x - 0.5).hypot(y - 1.2) / 1.3 - 1.0).abs() < 1e-5, "({x}, {y})");
        }
    }

    /// New nodes of polygons lie on the circles, and those of tubes and balls of tetrahedra on these, whose cells keep
    /// their shapes.
    #[test]
    fn polygons_become_round() {
        let mut state = 3;
        for (round, second_order) in (0..3).flat_map(|round| [(round, false), (round, true)]) {
            let grid = if round == 0 { block(&[1.0, 1.0], &[2, 6]) } else { block(&[1.0, 1.0, 1.0], &[2, 4, 4]) };
            let mut first = grid.into_simplices();
            for x in &mut first.nodes {
                let (r, [a, b]) = (1.0 + x[0], [1, 2].map(|c| (0.25 * std::f64::consts::PI * x[c]).tan()));
                let size = r / (1.0 + a * a + if round == 2 { b * b } else { 0.0 }).sqrt();
                *x = [size, size * a, if round == 2 { size * b } else { x[2] }];
            }
            let first = if second_order { first.into_second_order() } else { first };
            let mut bisection = following(&first);
            for _ in 0..if round == 0 { 6 } else { 2 } {
                let cells = bisection.mesh().cells.len();
                bisection.refine(&(0..cells).filter(|_| random(&mut state) < 0.3).collect::<Vec<_>>());
            }
            let mesh = bisection.mesh();
            mesh.check().unwrap();
            for (side, radius) in [("left", 1.0), ("right", 2.0)] {
                for [x, y, z] in mesh.points(&mesh.boundary(side).unwrap().nodes()) {
                    let off = x.hypot(y).hypot(if round == 2 { z } else { 0.0 }) / radius - 1.0;
                    assert!(off.abs() < 1e-5, "{round} {second_order}, {side}: {off}");
                }
            }
            let shapes = [&mesh, &first].map(least_shape);
            assert!(shapes[0] > if round == 0 { 0.25 } else { 0.05 } * shapes[1], "{round}: {shapes:?}");
        }
    }
}
