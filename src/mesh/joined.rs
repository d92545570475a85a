//! Several bodies in one mesh.

use std::sync::Arc;

use super::{Boundary, Cell, Mesh, MeshError, MeshSource};
use crate::fault::{Fault, demand, not_huge};
use crate::vector::{Vector, plus};

/// A body of several, with a mesh of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Its name, without a colon. Its boundaries are called `name:boundary`, its groups `name:group`; the one group of a mesh
    /// that names none is called `name`.
    pub name: String,
    /// Its mesh.
    pub mesh: MeshSource,
    /// Where the origin of that is put, m; where it is, without it.
    pub at: Option<Vector>,
}

impl Body {
    /// The body `name` where its mesh is.
    pub fn new(name: &str, mesh: impl Into<MeshSource>) -> Self {
        Body { name: name.to_string(), mesh: mesh.into(), at: None }
    }

    /// The same with its origin at `at` (m).
    #[must_use]
    pub fn at(self, at: impl Into<Vector>) -> Self {
        Body { at: Some(at.into()), ..self }
    }

    /// Adds it to `all`, the bodies before it.
    fn join(&self, k: usize, all: &mut Mesh) -> Result<(), MeshError> {
        let mesh = self.made(k)?;
        let differs = |what: &str, help: &str| {
            let message = format!("the mesh of `{}` {what}", self.name);
            MeshError::Source(Fault::new(format!("body[{k}].mesh"), message, help))
        };
        if mesh.dimension != all.dimension {
            let what = format!("has {} dimensions, those before it have {}", mesh.dimension, all.dimension);
            return Err(differs(&what, "let all bodies be plane, or all have a volume"));
        }
        if mesh.geometry != all.geometry {
            let what = "is the section of a body of revolution and those before it are not, or the other way round";
            return Err(differs(what, "let all meshes be sections, or none"));
        }
        let (first, group) = (all.nodes.len(), all.groups.len());
        let from = |nodes: &[usize]| nodes.iter().map(|node| first + node).collect::<Vec<_>>();
        all.nodes.extend(&mesh.nodes);
        let cell = |cell: &Cell| Cell { kind: cell.kind, nodes: from(&cell.nodes), group: group + cell.group };
        all.cells.extend(mesh.cells.iter().map(cell));
        all.groups.extend(mesh.groups.iter().cloned());
        let facets = |facets: &[Vec<usize>]| facets.iter().map(|facet| from(facet)).collect();
        let boundary = |boundary: &Boundary| Boundary { name: boundary.name.clone(), facets: facets(&boundary.facets) };
        all.boundaries.extend(mesh.boundaries.iter().map(boundary));
        Ok(())
    }

    /// Its mesh in its place, with its name on boundaries and groups; `k` is its number.
    fn made(&self, k: usize) -> Result<Mesh, MeshError> {
        let mesh = self.mesh.made().map_err(|error| match error {
            MeshError::Source(fault) => MeshError::Source(fault.under(&format!("body[{k}]"))),
            file => file,
        })?;
        let mut mesh = Arc::unwrap_or_clone(mesh);
        if let Some(at) = self.at {
            mesh.nodes.iter_mut().for_each(|x| *x = plus(*x, 1.0, at.components()));
        }
        let alone = matches!(&mesh.groups[..], [one] if one == "body");
        for group in &mut mesh.groups {
            *group = if alone || group.is_empty() { self.name.clone() } else { format!("{}:{group}", self.name) };
        }
        for boundary in &mut mesh.boundaries {
            boundary.name = format!("{}:{}", self.name, boundary.name);
        }
        Ok(mesh)
    }
}

/// Whether one mesh can be made of `bodies`, as far as that is known before files are read.
pub(super) fn check(bodies: &[Body]) -> Result<(), Fault> {
    if bodies.is_empty() {
        return Err(Fault::new("body", "there is no body", "give one at least"));
    }
    let mut plane_or_not: Option<(usize, &str)> = None;
    for (k, Body { name, mesh, at }) in bodies.iter().enumerate() {
        let key = |what: &str| format!("body[{k}].{what}");
        if name.is_empty() || name.contains(':') {
            let message = format!("the name of the body is {name:?}, but must have a letter and no colon");
            return Err(Fault::new(key("name"), message, "its boundaries will be called `name:boundary`"));
        }
        if bodies[..k].iter().any(|other| other.name == *name) {
            let message = format!("another body is called `{name}`");
            return Err(Fault::new(key("name"), message, "give every body a name of its own"));
        }
        if let MeshSource::Bodies(_) = mesh {
            let message = format!("the body `{name}` is made of bodies");
            return Err(Fault::new(key("mesh"), message, "list all bodies side by side"));
        }
        mesh.check().map_err(|fault| fault.under(&format!("body[{k}]")))?;
        let dimension = mesh.nodes().map(|(_, dimension)| dimension);
        if let Some(at) = at {
            let sound = at.components().iter().all(|c| c.is_finite());
            let sound = sound && dimension.is_none_or(|dimension| dimension == at.dimension());
            let help = "give where the origin of the body's mesh is put, such as [0, 0.5]";
            demand(sound, &key("at"), at, "a finite number for each dimension of the body", help)?;
            not_huge(&key("at"), at.components())?;
        }
        let known = dimension.or(at.map(|at| at.dimension()));
        match (plane_or_not, known) {
            (Some((first, of)), Some(other)) if first != other => {
                let message = format!("`{name}` has {other} dimensions, but `{of}` has {first}");
                return Err(Fault::new(key("mesh"), message, "let all bodies be plane, or all have a volume"));
            }
            (None, Some(dimension)) => plane_or_not = Some((dimension, name)),
            _ => {}
        }
    }
    Ok(())
}

/// The one mesh of `bodies` that were checked.
pub(super) fn joined(bodies: &[Body]) -> Result<Mesh, MeshError> {
    let [first, others @ ..] = bodies else {
        return Err(MeshError::Source(Fault::new("body", "there is no body", "give one at least")));
    };
    let mut all = first.made(0)?;
    for (k, body) in others.iter().enumerate() {
        body.join(k + 1, &mut all)?;
    }
    Ok(all)
}
