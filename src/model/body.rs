//! The body of a scene: mesh, supports, elements, materials and tractions, which have to fit each other.

use super::{ModelError, find};
use crate::fem::{Dofs, Elasticity, Element};
use crate::mesh::{self, CellKind, Mesh};
use crate::scene::{self, Scene, SceneError, Segment};

pub(super) fn mesh(scene: &Scene) -> Result<Mesh, ModelError> {
    Ok(match &scene.mesh {
        scene::Mesh::Block { axes, cells } => {
            let mesh = mesh::graded_block(&axes.iter().map(|segments| mesh_lines(segments)).collect::<Vec<_>>());
            if cells.is_simplex() { mesh.into_simplices() } else { mesh }
        }
        scene::Mesh::HalfPlane(m) => {
            mesh::half_plane(m.size, m.contact_width, m.contact_elements, m.outer_elements, m.layers)
        }
        scene::Mesh::Gmsh { file, scale } => mesh::gmsh(file, *scale)?,
    })
}

/// Where the elements of `segments` in a row end, m.
fn mesh_lines(segments: &[Segment]) -> Vec<f64> {
    let mut lines = vec![0.0];
    let mut end = 0.0;
    for &Segment { length, elements, grading } in segments {
        lines.extend(mesh::progression(length, elements, grading)[1..].iter().map(|x| end + x));
        end += length;
    }
    lines
}

/// The displacements that the supports leave free.
pub(super) fn dofs(scene: &Scene, mesh: &Mesh) -> Result<Dofs, SceneError> {
    let mut fixed = vec![[false; 3]; mesh.nodes.len()];
    for support in &scene.supports {
        if support.fix[2] && mesh.dimension == 2 {
            let message = format!("the support of `{}` holds z, but the body has two dimensions", support.boundary);
            return Err(scene.error_at(support.span.clone(), message, "leave out \"z\""));
        }
        for node in find(scene, mesh, &support.boundary)?.nodes() {
            for (fixed, fix) in fixed[node].iter_mut().zip(support.fix) {
                *fixed |= fix;
            }
        }
    }
    let dofs = Dofs::new(mesh, |node, component| fixed[node][component]);
    if let (0, Some(support)) = (dofs.free(), scene.supports.first()) {
        let help = "support fewer boundaries, or use a finer mesh";
        let message = "the supports fix every node of the mesh, so nothing is left to solve";
        return Err(scene.error_at(support.boundary.span(), message, help));
    }
    Ok(dofs)
}

/// How strains follow from displacements; B-bar needs cells that have a dilatation to average.
pub(super) fn element(scene: &Scene, mesh: &Mesh) -> Result<Element, SceneError> {
    let simplex = |kind: CellKind| matches!(kind, CellKind::Triangle | CellKind::Tetrahedron);
    match scene.element {
        scene::Element::Bilinear => Ok(Element::Bilinear),
        scene::Element::BBar if mesh.cells.iter().any(|cell| simplex(cell.kind)) => {
            let message = "mesh.element is \"b-bar\", but the mesh has triangles or tetrahedra";
            let help = "their dilatation is uniform already, so that they lock: use quadrilaterals or hexahedra";
            Err(scene.error_at(scene.element_span.clone().unwrap_or_default(), message, help))
        }
        scene::Element::BBar => Ok(Element::BBar),
    }
}

/// The material of each element: that of its group, or of the layer that holds its centre, or of the body.
pub(super) fn materials(scene: &Scene, mesh: &Mesh) -> Result<Vec<Elasticity>, SceneError> {
    let body = &scene.material;
    if let (3, Some(span)) = (mesh.dimension, &body.plane_span) {
        let message = "the material has a plane state, but the body has three dimensions";
        return Err(scene.error_at(span.clone(), message, "remove material.plane"));
    }
    let elasticity = |young, poisson| match (mesh.dimension, body.plane) {
        (2, scene::Plane::Strain) => Elasticity::plane_strain(young, poisson),
        (2, scene::Plane::Stress) => Elasticity::plane_stress(young, poisson),
        _ => Elasticity::isotropic(young, poisson),
    };
    let base = elasticity(body.young, body.poisson);
    if !body.groups.is_empty() {
        let mut of_group = vec![base; mesh.groups.len()];
        for group in &body.groups {
            let Some(k) = mesh.groups.iter().position(|name| name == group.name.as_str()) else {
                let help = format!("the mesh has the groups {}", mesh.groups.join(", "));
                let message = format!("the mesh has no material group `{}`", group.name);
                return Err(scene.error_at(group.name.span(), message, help));
            };
            of_group[k] = elasticity(group.young, group.poisson);
        }
        return Ok(mesh.cells.iter().map(|cell| of_group[cell.group]).collect());
    }
    let height = |e: usize| mesh.centre(e)[mesh.dimension - 1];
    let of_element: Vec<Option<usize>> = (0..mesh.cells.len()).map(|e| body.layer(height(e))).collect();
    let mut filled = vec![false; body.layers.len()];
    of_element.iter().flatten().for_each(|&k| filled[k] = true);
    if let Some(k) = filled.iter().position(|filled| !filled) {
        let message = format!("no element of the mesh has its centre in material.layers[{k}]");
        let help = "use more elements, a thicker layer or fewer layers; thicknesses are in m, from the bottom up";
        return Err(scene.error_at(body.layers[k].span.clone(), message, help));
    }
    let layers: Vec<Elasticity> = body.layers.iter().map(|layer| elasticity(layer.young, layer.poisson)).collect();
    Ok(of_element.into_iter().map(|layer| layer.map_or(base, |k| layers[k])).collect())
}

/// The traction of `load`, which has to have as many components as the body has dimensions.
pub(super) fn traction(scene: &Scene, mesh: &Mesh, load: &scene::Load) -> Result<[f64; 3], SceneError> {
    match (mesh.dimension, &load.traction[..]) {
        (2, &[x, y]) => Ok([x, y, 0.0]),
        (3, &[x, y, z]) => Ok([x, y, z]),
        (dimension, components) => {
            let n = components.len();
            let message = format!(
                "the traction on `{}` has {n} components, but the body has {dimension} dimensions",
                load.boundary
            );
            let help = if dimension == 2 { "give [x, y], N/m²" } else { "give [x, y, z], N/m²" };
            Err(scene.error_at(load.traction_span.clone(), message, help))
        }
    }
}
