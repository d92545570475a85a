//! The supports of a description on its mesh: which displacements are held, and where they are moved to.

use super::find;
use super::place::{nodes, normals, suits};
use crate::description::{Axis, Description, Direction, Held, Support, Where};
use crate::fault::Fault;
use crate::fem::{Dofs, HeldRows, NodalForces, nearest_rigid_motion};
use crate::mesh::Mesh;
use crate::timeline::within;
use crate::units::UnitSystem;
use crate::vector::{axis, dot, minus, norm, unit};

/// What one support holds: nodes, unit vectors, displacements (m) at factor 1.
pub(super) type Holding = Vec<(usize, [f64; 3], f64)>;

/// What each support of `description` holds.
pub(super) fn holdings(description: &Description, mesh: &Mesh) -> Result<Vec<Holding>, Fault> {
    let units = description.system(mesh.dimension);
    description.supports.iter().enumerate().map(|(k, support)| holding(mesh, support, &units, k)).collect()
}

fn holding(mesh: &Mesh, support: &Support, units: &UnitSystem, k: usize) -> Result<Holding, Fault> {
    let key = format!("support[{k}]");
    let nodes = nodes(mesh, &support.at, units, &key)?;
    let mut holding = Vec::new();
    for Held { direction, displacement } in &support.held {
        let hold = |node: usize, n: [f64; 3]| (node, n, *displacement);
        match direction {
            Direction::Axis(Axis::Z) if mesh.dimension == 2 => {
                let place = support.at.place(units);
                let message = format!("the support of `{place}` holds z, but the body has two dimensions");
                return Err(Fault::new(format!("{key}.fix"), message, "leave out \"z\""));
            }
            Direction::Axis(along) => holding.extend(nodes.iter().map(|&node| hold(node, axis(*along as usize)))),
            Direction::Along(vector) => {
                suits(mesh, *vector, &format!("{key}.direction"))?;
                let n = unit(vector.components());
                holding.extend(nodes.iter().map(|&node| hold(node, n)));
            }
            Direction::Normal => {
                let Where::Boundary(name) = &support.at else { continue };
                let normals = normals(mesh, find(mesh, name, &key)?);
                for &node in &nodes {
                    let Some(n) = normals[node] else {
                        let place = units.place(mesh.nodes[node]);
                        let message = format!("`{name}` has no normal at {place}: its facets there cancel each other");
                        return Err(Fault::new(format!("{key}.fix"), message, "give a direction, or fix axes"));
                    };
                    holding.push(hold(node, n));
                }
            }
        }
    }
    Ok(holding)
}

/// The displacements that the supports leave free.
pub(super) fn dofs(mesh: &Mesh, holdings: &[Holding]) -> Result<Dofs, Fault> {
    let mut directions = vec![Vec::new(); mesh.nodes.len()];
    for (node, n, _) in holdings.iter().flatten() {
        directions[*node].push(*n);
    }
    let dofs = Dofs::holding(mesh, |node| std::mem::take(&mut directions[node]));
    if dofs.free() == 0 {
        let message = "the supports fix every node of the mesh, so nothing is left to solve";
        return Err(Fault::new("support[0].boundary", message, "support fewer boundaries, or use a finer mesh"));
    }
    Ok(dofs)
}

/// A motion of supports that have one history: displacements of the whole body that agree with theirs, from which the unknown
/// ones count.
#[derive(Debug, Clone)]
pub(super) struct Moved {
    /// Of all nodes (m) at factor 1: a rigid motion, as near to the supports as there is, and at what is held the rest.
    pub displacements: Vec<[f64; 3]>,
    /// That rest, at the nodes of [`HeldRows`].
    pub beyond_rigid: Vec<[f64; 3]>,
    /// Points `[time (s), factor]`.
    pub history: Vec<[f64; 2]>,
}

impl Moved {
    /// The motions of all supports. A body that is moved as a whole is not strained by it; one that `stands_on_springs` is.
    pub(super) fn all(
        description: &Description,
        mesh: &Mesh,
        dofs: &Dofs,
        holdings: &[Holding],
        rows: &HeldRows,
        stands_on_springs: bool,
    ) -> Result<Vec<Self>, Fault> {
        let mut moved: Vec<Moved> = Vec::new();
        let supports = || description.supports.iter().zip(holdings).enumerate();
        let (mut histories, end) = (Vec::<Vec<[f64; 2]>>::new(), description.end());
        for (_, (support, _)) in supports().filter(|(_, (support, _))| support.moves()) {
            let history = within(end, &support.factors(end));
            if !histories.contains(&history) {
                histories.push(history);
            }
        }
        for history in histories {
            // What others hold stays where it is.
            let part = |(k, (support, holding)): (usize, (&Support, &Holding))| {
                let moves = support.moves() && within(end, &support.factors(end)) == history;
                holding.iter().map(move |&(node, n, to)| (k, node, n, if moves { to } else { 0.0 })).collect::<Vec<_>>()
            };
            let mut prescribed: Vec<_> = supports().flat_map(part).collect();
            prescribed.sort_by_key(|(_, node, ..)| *node);
            let rigid = if stands_on_springs {
                None
            } else {
                let values: Vec<_> = prescribed.iter().map(|&(_, node, n, to)| (node, n, to)).collect();
                nearest_rigid_motion(mesh, &values)
            };
            let mut displacements: Vec<[f64; 3]> =
                mesh.nodes.iter().map(|x| rigid.as_ref().map_or([0.0; 3], |motion| motion.at(*x))).collect();
            let mut beyond_rigid = vec![[0.0; 3]; rows.nodes().len()];
            let size = prescribed.iter().fold(0.0_f64, |m, (.., to)| m.max(to.abs()));
            for at_node in prescribed.chunk_by(|a, b| a.1 == b.1) {
                let node = at_node[0].1;
                let values: Vec<_> =
                    at_node.iter().map(|&(_, _, n, to)| (n, to - dot(displacements[node], n))).collect();
                let rest = solved(dofs, node, &values);
                if let Some((k, ..)) = at_node
                    .iter()
                    .zip(&values)
                    .find_map(|((k, ..), (n, to))| ((dot(rest, *n) - to).abs() > 1e-9 * size).then_some((*k, ())))
                {
                    let place = description.system(mesh.dimension).place(mesh.nodes[node]);
                    let message = format!("two supports move the node at {place} to different places");
                    let help = "let them agree there, or hold it by one of them";
                    return Err(Fault::new(format!("support[{k}].displacement"), message, help));
                }
                if let Ok(held) = rows.nodes().binary_search(&node) {
                    beyond_rigid[held] = rest;
                }
                displacements[node] = [0, 1, 2].map(|c| displacements[node][c] + rest[c]);
            }
            moved.push(Moved { displacements, beyond_rigid, history });
        }
        Ok(moved)
    }

    /// The forces (N) on all nodes at factor 1 that take the place of this motion.
    pub(super) fn forces(&self, rows: &HeldRows) -> NodalForces {
        rows.response(&self.beyond_rigid).into_iter().map(|(node, force)| (node, force.map(|f| -f))).collect()
    }
}

/// The displacement (m) of `node` along what is held there with the components `values` along unit vectors: the nearest in the
/// mean square.
fn solved(dofs: &Dofs, node: usize, values: &[([f64; 3], f64)]) -> [f64; 3] {
    let mut basis: Vec<([f64; 3], f64)> = Vec::new();
    for (n, value) in values {
        let (mut rest, mut to) = (*n, *value);
        for (b, along) in &basis {
            let share = dot(rest, *b);
            rest = minus(rest, b.map(|c| share * c));
            to -= share * along;
        }
        let length = norm(rest);
        if length > 1e-9 && basis.len() < dofs.node(node).len() {
            basis.push((rest.map(|c| c / length), to / length));
        }
    }
    [0, 1, 2].map(|c| basis.iter().map(|(b, along)| b[c] * along).sum())
}

/// For each support, what share of the force on a held node is its own: pairs of the place of the node in [`HeldRows`] and a
/// matrix. Directions that several supports hold they share evenly.
pub(super) fn shares(holdings: &[Holding], rows: &HeldRows) -> Vec<Vec<(usize, [[f64; 3]; 3])>> {
    let place = |node: usize| rows.nodes().binary_search(&node).unwrap_or(0);
    let mut of_node: Vec<Vec<(usize, [f64; 3])>> = vec![Vec::new(); rows.nodes().len()];
    for (k, holding) in holdings.iter().enumerate() {
        for (node, n, _) in holding {
            of_node[place(*node)].push((k, *n));
        }
    }
    let mut shares = vec![Vec::new(); holdings.len()];
    for (held, directions) in of_node.iter().enumerate() {
        let inverse = pseudo_inverse(directions.iter().map(|(_, n)| *n));
        for support in directions.iter().map(|(k, _)| *k).collect::<std::collections::BTreeSet<_>>() {
            let own = directions.iter().filter(|(k, _)| *k == support).map(|(_, n)| *n);
            shares[support].push((held, product(outer(own), inverse)));
        }
    }
    shares
}

/// `Σ n nᵀ`.
fn outer(directions: impl Iterator<Item = [f64; 3]>) -> [[f64; 3]; 3] {
    let mut sum = [[0.0; 3]; 3];
    for n in directions {
        (0..3).for_each(|r| (0..3).for_each(|c| sum[r][c] += n[r] * n[c]));
    }
    sum
}

fn product(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    a.map(|row| [0, 1, 2].map(|c| (0..3).map(|k| row[k] * b[k][c]).sum()))
}

/// The pseudo-inverse of `Σ n nᵀ`, by eliminating one direction after the other in a basis of them.
fn pseudo_inverse(directions: impl Iterator<Item = [f64; 3]> + Clone) -> [[f64; 3]; 3] {
    let matrix = outer(directions.clone());
    let mut basis: Vec<[f64; 3]> = Vec::new();
    for n in directions {
        let rest = basis.iter().fold(n, |rest, b| {
            let along = dot(rest, *b);
            minus(rest, b.map(|c| along * c))
        });
        if basis.len() < 3 && norm(rest) > 1e-9 {
            basis.push(unit(rest));
        }
    }
    // Gram-Schmidt again, in the inner product of the matrix: then it is diagonal.
    let times = |x: [f64; 3]| matrix.map(|row| dot(row, x));
    let mut inverse = [[0.0; 3]; 3];
    let mut done: Vec<([f64; 3], f64)> = Vec::new();
    for b in basis {
        let x = done.iter().fold(b, |x, (d, square)| {
            let along = dot(times(b), *d) / square;
            minus(x, d.map(|c| along * c))
        });
        let square = dot(times(x), x);
        (0..3).for_each(|r| (0..3).for_each(|c| inverse[r][c] += x[r] * x[c] / square));
        done.push((x, square));
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_belong_to_whom_they_can() {
        let s = 0.5_f64.sqrt();
        let directions = [[1.0, 0.0, 0.0], [s, s, 0.0]];
        let inverse = pseudo_inverse(directions.into_iter());
        // 3 along the first and 2 along the second.
        let force = [3.0 + 2.0 * s, 2.0 * s, 0.0];
        for (n, share) in directions.into_iter().zip([3.0, 2.0]) {
            let own = product(outer([n].into_iter()), inverse).map(|row| dot(row, force));
            assert!((0..3).all(|c| (own[c] - share * n[c]).abs() < 1e-14), "{own:?}");
        }
        // Whoever holds the same direction has half.
        let inverse = pseudo_inverse([axis(1), axis(1)].into_iter());
        assert_eq!(product(outer([axis(1)].into_iter()), inverse)[1], [0.0, 0.5, 0.0]);
    }
}
