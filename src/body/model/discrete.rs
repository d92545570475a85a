//! A description on its mesh before assembly: bodies that do not overlap, displacements, laws and springs. Without parts that
//! join cells, several processes may each assemble rows of its stiffness.

use std::collections::{BTreeMap, BTreeSet};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

use super::constraints::Constraints;
use super::coupling::{Couplings, about_axes};
use super::holding::{self, Holding};
use super::joint::Joints;
use super::pair::{self, Pair, Pairs};
use super::place::{along_the_axis, in_space, node, with_area};
use super::{Model, ModelError, find};
use crate::algebra::linear::{Computed, Stiffness};
use crate::algebra::sparse::{NodeRows, Symmetric};
use crate::algebra::union_find::UnionFind;
use crate::algebra::vector::{cross, minus, norm};
use crate::base::input_error::InputError;
use crate::body::constraints::{Dofs, HeldRows, assemble, assemble_part};
use crate::body::contact::ContactNode;
use crate::body::description::{Bed, Description, Where};
use crate::body::fem::{Bedding, Elasticity, Element, InvertedElement, NodalVolumes, Plane, Spring, overlaps};
use crate::body::mesh::{Bodies, Boundary, CellKind, Geometry, Mesh, MeshFault, MeshSource};

/// The parts of a model before assembly.
pub(super) struct Discrete {
    pub mesh: Arc<Mesh>,
    pub elements: Elements,
    pub constraints: Constraints,
    /// The displacements that each support holds.
    pub holdings: Vec<Holding>,
    pub pairs: Pairs,
    /// The springs of each bed.
    pub beds: Vec<Vec<Spring>>,
}

/// The elements of the cells.
#[derive(Debug, Clone)]
pub(super) struct Elements {
    pub element: Element,
    /// The elastic law of each cell.
    pub materials: Vec<Elasticity>,
    /// The nodal volumes over which dilatations are averaged; empty for other elements.
    pub volumes: NodalVolumes,
}

impl Discrete {
    pub(super) fn new(description: &Description) -> Result<Self, ModelError> {
        description.check()?;
        let mesh = self::meridian(description, description.mesh.made()?)?;
        description.formulas_suit(mesh.dimension)?;
        keep_apart(description, &mesh)?;
        let couplings = Couplings::new(description, &mesh)?;
        let points = couplings.points(&mesh);
        let holdings = holding::holdings(description, &mesh, &couplings, &points)?;
        let joints = Joints::new(description, &mesh)?;
        joints.meet_no_contact(description, &mesh)?;
        let dofs = holding::dofs(&mesh, points, &joints, &holdings)?;
        let element = self::element(description, &mesh)?;
        let materials = description.material.laws(&mesh)?;
        let mut pairs = Pairs::new(description, &mesh, &dofs, &holdings, &materials, (&couplings, &joints))?;
        let dofs = pairs.dofs(description, &mesh, &joints, dofs)?;
        let volumes = NodalVolumes::new(&mesh, element, |e| materials[e])?;
        let beds = springs(description, &mesh, &couplings, &dofs)?;
        let elements = Elements { element, materials, volumes };
        let held = (&holdings[..], &beds[..]);
        let constraints = Constraints::new(description, &mesh, dofs, (couplings, joints), &pairs, held)?;
        Ok(Discrete { mesh, elements, constraints, holdings, pairs, beds })
    }

    /// Assembles the stiffness and its rows of held displacements; for a `shared` stiffness the rows alone.
    pub(super) fn assembled(&self, shared: bool) -> Result<(Option<Symmetric>, HeldRows), InvertedElement> {
        let Discrete { mesh, elements: Elements { element, volumes, .. }, constraints, beds, .. } = self;
        if shared {
            return Ok((None, HeldRows::rows_only(mesh, &constraints.dofs, *element, self.law())?));
        }
        let springs: Vec<Spring> = beds.iter().flatten().cloned().collect();
        let (stiffness, rows) = HeldRows::beside(mesh, &constraints.dofs, *element, volumes, self.law(), &springs)?;
        Ok((Some(stiffness), rows))
    }

    /// Assembles the stiffness of a body without springs and nodal volumes.
    pub(super) fn stiffness(&self) -> Result<Symmetric, InvertedElement> {
        assemble(&self.mesh, &self.constraints.dofs, self.elements.element, self.law())
    }

    /// Returns the elastic law of a cell.
    fn law(&self) -> impl Fn(usize) -> Elasticity + Sync {
        |e| self.elements.materials[e]
    }
}

/// Returns `true` if the stiffness is a sum over cells, each on displacements of its own nodes.
fn is_a_sum_over_cells<'a>(
    dofs: &Dofs,
    pairs: &[Pair],
    volumes: &NodalVolumes,
    mut springs: impl Iterator<Item = &'a Spring>,
) -> bool {
    !dofs.has_nodes_outside() && pairs.is_empty() && volumes.is_empty() && springs.next().is_none()
}

/// Returns the element formulation and checks it: B-bar is for quadrilaterals, hexahedra and prisms of first order,
/// nodal volumes are for triangles, tetrahedra, prisms and all cells of second order. The one mean dilatation of B-bar
/// would make a cell of second order far too soft.
pub(super) fn element(description: &Description, mesh: &Mesh) -> Result<Element, InputError> {
    let element = description.element;
    let kinds = || mesh.cells.iter().map(|cell| cell.kind);
    match element {
        Element::BBar if kinds().any(CellKind::is_simplex) => {
            let message = "mesh.element is \"b-bar\", but the mesh has triangles or tetrahedra";
            let help = "use \"nodal-volume\", quadrilaterals or hexahedra, or triangles of six and tetrahedra of ten nodes without b-bar, which need no \
                        remedy up to nu = 0.499";
            Err(InputError::new("mesh.element", message, help))
        }
        Element::BBar if kinds().any(CellKind::is_quadratic) => {
            let message = "mesh.element is \"b-bar\", but the mesh has cells of second order";
            let help = "use \"nodal-volume\" near nu = 1/2; up to nu = 0.49 cells of second order need no remedy";
            Err(InputError::new("mesh.element", message, help))
        }
        Element::NodalVolume => match kinds().find(|kind| !NodalVolumes::apply_to(*kind)) {
            None => Ok(element),
            Some(kind) => {
                let message = format!("mesh.element is \"nodal-volume\", but the mesh has a {}", kind.name());
                let help = "nodal volumes are for triangles, tetrahedra and prisms, and for second order: use \"b-bar\", or a mesh of these alone";
                Err(InputError::new("mesh.element", message, help))
            }
        },
        Element::Bilinear | Element::BBar => Ok(element),
    }
}

/// Returns the mesh of `description`; for an axisymmetric material, as half the section of a body of revolution.
fn meridian(description: &Description, mesh: Arc<Mesh>) -> Result<Arc<Mesh>, InputError> {
    // The check of the material fails for a plane state of a three-dimensional mesh.
    let geometry = match description.material.plane {
        Some(Plane::Axisymmetric) if mesh.dimension == 2 => Geometry::Axisymmetric,
        Some(Plane::Torsion) if mesh.dimension == 2 => Geometry::Torsion,
        _ if mesh.geometry == Geometry::Cartesian => return Ok(mesh),
        _ => {
            let message = "the mesh is the section of a body of revolution, but the material is not axisymmetric";
            return Err(InputError::new("material.plane", message, "use \"axisymmetric\""));
        }
    };
    let place = |nodes: &[usize]| {
        let furthest = nodes.iter().copied().min_by(|&a, &b| mesh.nodes[a][0].total_cmp(&mesh.nodes[b][0]));
        furthest.map_or(String::new(), |node| description.system(2).point(mesh.nodes[node]))
    };
    let revolved = Mesh::clone(&mesh).into_revolved(geometry);
    revolved.map(Arc::new).map_err(|fault| {
        let message = match &fault {
            MeshFault::LeftOfAxis(nodes) => format!(
                "the body is axisymmetric, with x as the distance from the axis, but its mesh reaches to {}",
                place(nodes)
            ),
            other => other.to_string(),
        };
        InputError::new("material.plane", message, fault.help())
    })
}

/// Creates the springs of each bed of `description`.
fn springs(
    description: &Description,
    mesh: &Mesh,
    couplings: &Couplings,
    dofs: &Dofs,
) -> Result<Vec<Vec<Spring>>, InputError> {
    let units = description.system(mesh.dimension);
    let bedded = |name: &str, key: &str| {
        with_area(mesh, name, &format!("{key}.boundary"), find(mesh, name, key)?, "a foundation")
    };
    let of_bed = |(k, bed): (usize, &Bed)| {
        let key = format!("spring[{k}]");
        match bed {
            Bed::Axes { at, stiffness } => {
                let stiffness = in_space(mesh, stiffness, &format!("{key}.stiffness"))?;
                match at {
                    Where::Point(point) => Ok(vec![Spring::at_node(node(mesh, *point, &units, &key)?, stiffness)]),
                    Where::Boundary(name) => {
                        Ok(Spring::foundation(mesh, bedded(name, &key)?, Bedding::Axes(stiffness)))
                    }
                    Where::Coupling(name) => {
                        along_the_axis(mesh, "stiffness", stiffness, &format!("{key}.stiffness"))?;
                        let (_, [translation, _]) = couplings.rigid(name, "the spring", &key)?;
                        Ok(vec![Spring::at_node(translation, stiffness)])
                    }
                }
            }
            Bed::Rotational { coupling, rotational } => {
                let about = about_axes(mesh, rotational, &format!("{key}.rotational"))?;
                let (point, [_, rotation]) = couplings.rigid(coupling, "the spring", &key)?;
                Ok(vec![Spring::at_node(rotation, dofs.of_rotational(point, about))])
            }
            Bed::Surface { boundary, normal, tangential } => {
                let bedding = Bedding::Surface { normal: *normal, tangential: *tangential };
                Ok(Spring::foundation(mesh, bedded(boundary, &key)?, bedding))
            }
        }
    };
    description.springs.iter().enumerate().map(of_bed).collect()
}

/// A function that distributes a stiffness over processes, from its rows, the nodes whose columns this process keeps,
/// and the number of contact nodes. `None` if this is impossible, for example because another process does not have
/// the same body.
pub type Share<'a> = &'a dyn Fn(Arc<dyn NodeRows>, &[bool], usize) -> Computed<Option<Stiffness>>;

/// A body before assembly.
#[derive(Debug, Clone)]
pub struct Body {
    mesh: Arc<Mesh>,
    dofs: Dofs,
    element: Element,
    materials: Vec<Elasticity>,
}

impl Body {
    /// Creates the body of `description`; `None` if its stiffness is not a sum over cells, each on displacements of its
    /// own nodes.
    ///
    /// # Errors
    /// As [`super::Model::build`], for mesh, supports and materials.
    pub fn of(description: &Description) -> Result<Option<Self>, ModelError> {
        let discrete = Discrete::new(description)?;
        Ok(Self::on(&discrete))
    }

    pub(super) fn on(discrete: &Discrete) -> Option<Self> {
        let Discrete { mesh, elements, constraints: Constraints { dofs, .. }, pairs, beds, .. } = discrete;
        let Elements { element, materials, volumes } = elements;
        let body =
            || Body { mesh: Arc::clone(mesh), dofs: dofs.clone(), element: *element, materials: materials.clone() };
        is_a_sum_over_cells(dofs, &pairs.all, volumes, beds.iter().flatten()).then(body)
    }

    /// Returns `K` distributed by `share`; `None` if the rows of a contact node contain displacements of other nodes.
    pub(super) fn stiffness(&self, contacts: &[ContactNode], share: Share<'_>) -> Computed<Option<Stiffness>> {
        let Some(is_contact) = alone_with_contact(&self.mesh, &self.dofs, contacts) else { return Ok(None) };
        let mut near = is_contact.clone();
        for cell in self.mesh.cells.iter().filter(|cell| cell.nodes.iter().any(|node| is_contact[*node])) {
            cell.nodes.iter().for_each(|&node| near[node] = true);
        }
        share(Arc::new(self.clone()), &near, contacts.len())
    }
}

/// Marks the nodes with contact; `None` if the rows of a node contain displacements of other nodes.
fn alone_with_contact(mesh: &Mesh, dofs: &Dofs, contacts: &[ContactNode]) -> Option<Vec<bool>> {
    let mut is_contact = vec![false; mesh.nodes.len()];
    for contact in contacts {
        let own = dofs.node(contact.node);
        let rows = [&contact.normal, &contact.tangents[0], &contact.tangents[1]];
        let is_local = rows.into_iter().flatten().all(|(dof, _)| own.contains(&Some(*dof)));
        if !is_local || std::mem::replace(&mut is_contact[contact.node], true) {
            return None;
        }
    }
    Some(is_contact)
}

impl Model {
    /// Returns `true` if its stiffness can be assembled by rows of nodes on each process: [`Body::of`] returns a body,
    /// and contact rows contain displacements of single nodes.
    pub(crate) fn has_rows(&self) -> bool {
        is_a_sum_over_cells(&self.constraints.dofs, &self.contact.pairs, &self.elements.volumes, self.statics.springs())
            && alone_with_contact(&self.mesh, &self.constraints.dofs, &self.contact.nodes).is_some()
    }
}

impl NodeRows for Body {
    fn dimension(&self) -> usize {
        self.mesh.dimension
    }

    fn nodes(&self) -> usize {
        self.mesh.nodes.len()
    }

    fn order(&self) -> usize {
        self.dofs.free()
    }

    fn places(&self, node: usize) -> [Option<usize>; 3] {
        [0, 1, 2].map(|c| self.dofs.node(node).get(c).copied().flatten())
    }

    fn each_cell(&self, take: &mut dyn FnMut(&[usize])) {
        self.mesh.cells.iter().for_each(|cell| take(&cell.nodes));
    }

    fn fingerprint(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        let mut number = |x: f64| x.to_bits().hash(&mut hasher);
        self.mesh.nodes.iter().flatten().for_each(|x| number(*x));
        self.materials.iter().for_each(|law| [law.lambda, law.mu].into_iter().for_each(&mut number));
        self.mesh.cells.iter().for_each(|cell| cell.nodes.hash(&mut hasher));
        (0..self.nodes()).for_each(|node| self.places(node).hash(&mut hasher));
        hasher.finish()
    }

    fn rows(&self, nodes: &[bool]) -> Option<Symmetric> {
        // The first process finds the invalid cell when it assembles all cells.
        assemble_part(&self.mesh, &self.dofs, self.element, |e| self.materials[e], nodes).ok()
    }
}

/// Fails if two bodies without a contact between them have coincident nodes or are inside one another; they would pass
/// through each other. Bodies that touch at a node may also be connected through contacts with other bodies, such as
/// blocks around a point.
fn keep_apart(description: &Description, mesh: &Mesh) -> Result<(), InputError> {
    let bodies = &mesh.bodies();
    if !bodies.are_several() {
        return Ok(());
    }
    let of = bodies.of_nodes();
    let contacts = paired(description, mesh, bodies)?;
    let mut together = UnionFind::new(bodies.count());
    for &(a, b) in &contacts {
        together.join(a, b);
    }
    let together: Vec<usize> = (0..bodies.count()).map(|k| together.least(k)).collect();
    let pair = |a: usize, b: usize| (of[a].min(of[b]), of[a].max(of[b]));
    let place = |node: usize| description.system(mesh.dimension).point(mesh.nodes[node]);
    let touching = mesh.touching_nodes(bodies);
    // Bodies connected through others may touch at a point or, in three dimensions, along an edge, but not over a side.
    let mut at: BTreeMap<(usize, usize), Vec<[f64; 3]>> = BTreeMap::new();
    let mut joined = |a: usize, b: usize| {
        let of_pair = pair(a, b);
        if contacts.contains(&of_pair) {
            return true;
        }
        let places = at.entry(of_pair).or_default();
        places.push(mesh.nodes[a]);
        together[of[a]] == together[of[b]] && !spans_a_side(places, mesh.dimension)
    };
    if let Some(&(node, other)) = touching.iter().find(|&&(a, b)| !joined(a, b)) {
        let (a, b) = pair(node, other);
        let message = format!(
            "the bodies {} and {} both have a node at {}, but nothing joins them",
            bodies.label(a),
            bodies.label(b),
            place(node)
        );
        let help = "let a [[contact]] with `against` join their boundaries, make one body of them in Gmsh (Coherence, or Coherence \
                    Mesh), or move them apart";
        return Err(InputError::new(key(&description.mesh, bodies, b), message, help));
    }
    if let Some(overlap) = overlaps(mesh, bodies, |a, b| !contacts.contains(&(a.min(b), a.max(b)))).first() {
        let (inner, outer) = overlap.bodies;
        let message =
            format!("the body {} is inside {}, at {}", bodies.label(inner), bodies.label(outer), place(overlap.node));
        let help = "move them apart, or let a [[contact]] with `against` press them out of each other";
        return Err(InputError::new(key(&description.mesh, bodies, inner.max(outer)), message, help));
    }
    Ok(())
}

/// Returns `true` if `places` span more than a point or, in three dimensions, more than a line, because of the last
/// one.
fn spans_a_side(places: &[[f64; 3]], dimension: usize) -> bool {
    let (Some(first), Some(last)) = (places.first(), places.last()) else { return false };
    let arm = minus(*last, *first);
    if dimension == 2 {
        return places.len() > 1;
    }
    let aside = |other: &[f64; 3]| {
        let other = minus(*other, *first);
        norm(cross(arm, other)) > ASIDE * norm(arm) * norm(other)
    };
    places.iter().any(aside)
}

/// Points are on one line if their directions differ by less than this.
const ASIDE: f64 = 1e-6;

/// Returns the pairs of bodies with a contact between them, the smaller number first.
fn paired(description: &Description, mesh: &Mesh, bodies: &Bodies) -> Result<BTreeSet<(usize, usize)>, InputError> {
    let mut pairs = BTreeSet::new();
    for (k, contact) in description.contacts.iter().enumerate() {
        let Some(opposite) = contact.opposite() else { continue };
        let key = format!("contact[{k}]");
        let of = |boundary: &Boundary| -> BTreeSet<usize> {
            boundary.facets.iter().map(|facet| bodies.of_nodes()[facet[0]]).collect()
        };
        let first = of(find(mesh, &contact.boundary, &key)?);
        let second = of(&pair::opposite(mesh, opposite, k)?);
        pairs.extend(first.iter().flat_map(|&a| second.iter().map(move |&b| (a.min(b), a.max(b)))));
    }
    Ok(pairs)
}

/// Returns the key of body `k`.
fn key(source: &MeshSource, bodies: &Bodies, k: usize) -> String {
    let MeshSource::Bodies(given) = source else { return "mesh".to_string() };
    // If the mesh of a body has several pieces, its name is followed by a number.
    let name = &bodies.names()[k];
    let own = given
        .iter()
        .position(|body| body.name == *name)
        .or_else(|| given.iter().position(|body| name.rsplit_once(' ').is_some_and(|(first, _)| first == body.name)));
    own.map_or("body".to_string(), |k| format!("body[{k}]"))
}
