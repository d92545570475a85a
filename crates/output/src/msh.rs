//! Meshes of triangles and tetrahedra as files of Gmsh, in MSH 4.1 as text.

use std::fmt::Write;

use stickslip::body::mesh::Mesh;

/// The dimension of an element, the number of its nodes, and Gmsh's number of its type.
const TYPES: [(usize, usize, u32); 6] = [(1, 2, 1), (1, 3, 8), (2, 3, 2), (2, 6, 9), (3, 4, 4), (3, 10, 11)];

/// Dimension, physical groups and elements of an entity of the geometry, the elements by their nodes in the order of Gmsh.
type Entity<'a> = (usize, Vec<&'a str>, Vec<Vec<usize>>);

/// Returns the boundaries and the groups of cells.
fn entities(mesh: &Mesh) -> Vec<Entity<'_>> {
    let corners_first = |facet: &Vec<usize>| {
        let (step, middles) = if mesh.is_quadratic(facet) { (2, 1) } else { (1, facet.len()) };
        let nodes = |first: usize| facet.iter().skip(first).step_by(step).copied();
        nodes(0).chain(nodes(middles)).collect()
    };
    let boundaries = mesh.boundaries.iter().map(|boundary| {
        let elements = boundary.facets.iter().map(corners_first).collect();
        (mesh.dimension - 1, vec![boundary.name.as_str()], elements)
    });
    let groups = mesh.groups.iter().enumerate().map(|(k, group)| {
        let cells = mesh.cells.iter().filter(|cell| cell.group == k);
        let mut elements: Vec<Vec<usize>> = cells.map(|cell| cell.nodes.clone()).collect();
        elements.iter_mut().filter(|nodes| nodes.len() == 10).for_each(|nodes| nodes.swap(8, 9));
        let names = mesh.notes.members(group).iter().map(String::as_str).filter(|name| !name.is_empty());
        (mesh.dimension, names.collect(), elements)
    });
    boundaries.chain(groups).filter(|(.., elements)| !elements.is_empty()).collect()
}

/// Formats indices as numbers from 1, with a space before each.
fn numbers(indices: impl IntoIterator<Item = usize>) -> String {
    indices.into_iter().flat_map(|k| [" ".to_string(), (k + 1).to_string()]).collect()
}

/// Returns the file of a mesh with physical groups for boundaries and bodies, and lengths in another unit than m; `None` if it has
/// other cells than triangles and tetrahedra.
pub fn msh(mesh: &Mesh, length: impl Fn(f64) -> f64) -> Option<String> {
    let entities = entities(mesh);
    let named = entities.iter().flat_map(|(dimension, names, _)| names.iter().map(|name| (*dimension, *name)));
    let mut groups: Vec<(usize, &str)> = named.collect();
    groups.sort_unstable();
    groups.dedup();
    let mut text = format!("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n{}\n", groups.len());
    text.extend((1..).zip(&groups).map(|(k, (dimension, name))| format!("{dimension} {k} \"{name}\"\n")));
    let [lines, faces, volumes] = [1, 2, 3].map(|d| entities.iter().filter(|entity| entity.0 == d).count());
    writeln!(text, "$EndPhysicalNames\n$Entities\n0 {lines} {faces} {volumes}").ok()?;
    for (k, (dimension, names, _)) in (1..).zip(&entities) {
        let groups = numbers(names.iter().filter_map(|name| groups.binary_search(&(*dimension, *name)).ok()));
        writeln!(text, "{k} 0 0 0 0 0 0 {}{groups} 0", names.len()).ok()?;
    }
    let (nodes, count) = (mesh.nodes.len(), entities.len());
    writeln!(text, "$EndEntities\n$Nodes\n1 {nodes} 1 {nodes}\n{} {count} 0 {nodes}", mesh.dimension).ok()?;
    text.extend((1..=nodes).map(|k| format!("{k}\n")));
    text.extend(mesh.nodes.iter().map(|x| x.map(&length)).map(|[x, y, z]| format!("{x:e} {y:e} {z:e}\n")));
    let all: usize = entities.iter().map(|(.., elements)| elements.len()).sum();
    writeln!(text, "$EndNodes\n$Elements\n{count} {all} 1 {all}").ok()?;
    let mut tags = 1..;
    for (k, (dimension, _, elements)) in (1..).zip(&entities) {
        let (.., kind) = TYPES.iter().find(|(d, nodes, _)| d == dimension && *nodes == elements[0].len())?;
        writeln!(text, "{dimension} {k} {kind} {}", elements.len()).ok()?;
        let rows = elements.iter().zip(tags.by_ref());
        text.extend(rows.map(|(nodes, tag)| format!("{tag}{}\n", numbers(nodes.iter().copied()))));
    }
    Some(text + "$EndElements\n")
}
