//! The prescribed displacements of the supports of a description on its mesh, and the groups of bodies with a common rigid
//! offset by them.
//!
//! A rigid offset causes no strain, and forces of the stiffness that would cancel are left out (`PrescribedMotion`).
//! Bodies that are moved by different supports have different offsets. With one offset for all, a stiff body at rest
//! would be pulled back against the mean by forces far above the actual ones.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::coupling::Couplings;
use super::find;
use super::holding::Holding;
use super::pair::Pairs;
use crate::algebra::union_find::UnionFind;
use crate::algebra::vector::{axis, dot, minus, norm, plus};
use crate::base::input_error::InputError;
use crate::base::timeline::within;
use crate::body::constraints::{Dofs, HeldRows, SAME_DIRECTION, independent};
use crate::body::contact::{ContactNode, Facing};
use crate::body::description::{Description, Support};
use crate::body::fem::{NodalForces, Spring};
use crate::body::mesh::Mesh;
use crate::solver::loading::piecewise_linear;

/// The tolerance of different displacements prescribed at one node, as a share of the largest.
const SAME: f64 = 1e-9;

/// A few times the relative rounding error of a displacement.
const DISPLACEMENT_ROUNDING: f64 = 1e-15;

/// The motion of all supports with one history. It is split into a rigid offset of the body, the nearest translation,
/// and the rest. The offset causes no strain: it is equivalent to the opposite motion of the obstacles, and
/// displacements are relative to it. Bodies with different supports have different offsets, see [`RigidGroups`].
#[derive(Debug, Clone)]
pub(super) struct PrescribedMotion {
    /// The rigid offset of the bodies of each group at factor 1, m.
    pub offset: Vec<[f64; 3]>,
    /// The displacements of all nodes by supports beyond the offset at factor 1, m.
    pub deviation: Vec<[f64; 3]>,
    /// Points `[time (s), factor]`.
    pub history: Vec<[f64; 2]>,
}

impl PrescribedMotion {
    /// Returns the motions of all supports.
    pub(super) fn all(
        description: &Description,
        mesh: &Mesh,
        dofs: &Dofs,
        holdings: &[Holding],
        groups: &RigidGroups,
    ) -> Result<Vec<Self>, InputError> {
        let supports = || description.supports.iter().zip(holdings).enumerate();
        let history = |support: &Support| within(description.end(), &support.factors(description.end()));
        let mut histories: Vec<Vec<[f64; 2]>> = Vec::new();
        for (_, (support, _)) in supports().filter(|(_, (support, _))| support.moves()) {
            if !histories.contains(&history(support)) {
                histories.push(history(support));
            }
        }
        let axisymmetric = mesh.geometry.is_revolved();
        let of_history = |of: Vec<[f64; 2]>| {
            // Displacements that other supports hold are 0.
            let mut prescribed = Vec::new();
            for (k, (support, holding)) in supports() {
                let moves = support.moves() && history(support) == of;
                prescribed.extend(holding.iter().map(|&(node, n, to)| (k, node, n, if moves { to } else { 0.0 })));
            }
            prescribed.sort_by_key(|(_, node, ..)| *node);
            // A body of revolution has an offset along its axis alone.
            let carrying_along = |n: [f64; 3]| if axisymmetric { [0.0, n[1], 0.0] } else { n };
            let offset: Vec<[f64; 3]> = (groups.carrier.iter())
                .map(|&group| {
                    if groups.turns == Some(group) {
                        return [0.0; 3];
                    }
                    let own = prescribed.iter().filter(|(_, node, ..)| groups.of_node[*node] == group);
                    nearest_translation(own.map(|(_, _, n, to)| (carrying_along(*n), *to)))
                })
                .collect();
            let size = prescribed.iter().fold(0.0_f64, |m, (.., to)| m.max(to.abs()));
            let mut deviation = vec![[0.0; 3]; dofs.nodes()];
            for at_node in prescribed.chunk_by(|a, b| a.1 == b.1) {
                let node = at_node[0].1;
                let offset = offset[groups.of_node[node]];
                let values: Vec<_> = at_node.iter().map(|(_, _, n, to)| (*n, to - dot(offset, *n))).collect();
                let displacement = solved(dofs, node, &values);
                let missed = |(n, to): &([f64; 3], f64)| (dot(displacement, *n) - to).abs() > SAME * size;
                if let Some(j) = values.iter().position(missed) {
                    let place = description.system(mesh.dimension).point(dofs.position(mesh, node));
                    let message = format!("two supports move the node at {place} to different places");
                    let help = "let them agree there, or hold it by one of them";
                    return Err(InputError::new(format!("support[{}].displacement", at_node[j].0), message, help));
                }
                // Rounding errors of a rigid offset would cause strains.
                deviation[node] = displacement.map(|x| if x.abs() > DISPLACEMENT_ROUNDING * size { x } else { 0.0 });
            }
            dofs.follow(&mut deviation);
            Ok(PrescribedMotion { offset, deviation, history: of })
        };
        histories.into_iter().map(of_history).collect()
    }

    /// Returns the motion due to a jump, a node and its displacement (m) at factor 1, of bodies in this many groups.
    pub(super) fn of_jump(dofs: &Dofs, groups: usize, (node, jump): (usize, [f64; 3]), history: Vec<[f64; 2]>) -> Self {
        let mut deviation = vec![[0.0; 3]; dofs.nodes()];
        deviation[node] = jump;
        dofs.follow(&mut deviation);
        PrescribedMotion { offset: vec![[0.0; 3]; groups], deviation, history }
    }

    /// Returns the forces (N) on all nodes at factor 1 that are equivalent to this motion, from the strain of the body
    /// and of the springs fixed to the ground.
    pub(super) fn forces(&self, groups: &RigidGroups, rows: &HeldRows, springs: &[Spring]) -> NodalForces {
        let strained = rows.response(&self.deviation).into_iter().map(|(node, force)| (node, force.map(|f| -f)));
        strained.chain(self.forces_of_springs(groups, springs)).collect()
    }

    /// Returns the forces (N) at factor 1 of springs due to the rigid offset.
    pub(super) fn forces_of_springs(&self, groups: &RigidGroups, springs: &[Spring]) -> NodalForces {
        if springs.is_empty() || self.offset.iter().all(|offset| *offset == [0.0; 3]) {
            return Vec::new();
        }
        let offsets: Vec<[f64; 3]> = groups.of_node.iter().map(|group| self.offset[*group]).collect();
        springs.iter().flat_map(|spring| spring.forces(&offsets)).collect()
    }

    /// Returns the displacement beyond the rigid offset of the rows of a contact node, along its normal and its
    /// tangents. If the body in front of it has another offset, the displacement is relative to that offset.
    pub(super) fn deviation_of(&self, dofs: &Dofs, groups: &RigidGroups, contact: &ContactNode) -> [f64; 3] {
        let relative = contact.coupled().is_some_and(|coupled| coupled.relative);
        let own = self.offset[groups.of_node[contact.node]];
        let apart = contact.terms().filter(|term| term.opposite).fold([0.0; 3], |sum, term| {
            plus(sum, term.coefficient, minus(self.offset[groups.of_node[term.node]], own))
        });
        let along = |direction: fn(&Facing) -> [f64; 3]| {
            let apart = dot(apart, direction(&contact.facing));
            if !relative {
                return apart + contact.sum(|term| dot(self.deviation[term.node], direction(&term.facing)));
            }
            // Free displacements follow the other side.
            let held = dofs.held(contact.node).filter(|held| dot(*held, direction(&contact.facing)) != 0.0);
            let of_axis = |held: [f64; 3]| {
                dot(held, direction(&contact.facing)) * contact.sum(|term| dot(self.deviation[term.node], held))
            };
            apart + held.map(of_axis).sum::<f64>()
        };
        [along(|facing| facing.normal), along(|facing| facing.tangents[0]), along(|facing| facing.tangents[1])]
    }

    /// Returns the factor at time `t` (s).
    pub(super) fn factor(&self, t: f64) -> f64 {
        piecewise_linear(&self.history, t).unwrap_or(0.0)
    }
}

/// Returns the displacement (m) of `node` in its held directions with the components `values` along unit vectors;
/// linearly dependent vectors are ignored.
fn solved(dofs: &Dofs, node: usize, values: &[([f64; 3], f64)]) -> [f64; 3] {
    let mut basis: Vec<([f64; 3], f64)> = Vec::new();
    for (n, value) in values {
        let (mut remainder, mut to) = (*n, *value);
        for (b, along) in &basis {
            let share = dot(remainder, *b);
            remainder = minus(remainder, b.map(|c| share * c));
            to -= share * along;
        }
        let length = norm(remainder);
        if length > SAME_DIRECTION && basis.len() < dofs.node(node).len() {
            basis.push((remainder.map(|c| c / length), to / length));
        }
    }
    [0, 1, 2].map(|c| basis.iter().map(|(b, along)| b[c] * along).sum())
}

/// Returns the share of each support in the forces on held nodes: pairs of a node and a matrix. Supports share a common
/// direction equally.
pub(super) fn shares(holdings: &[Holding]) -> Vec<Vec<(usize, [[f64; 3]; 3])>> {
    let mut of_node = BTreeMap::<usize, Vec<(usize, [f64; 3])>>::new();
    for (k, holding) in holdings.iter().enumerate() {
        for (node, n, _) in holding {
            of_node.entry(*node).or_default().push((k, *n));
        }
    }
    let mut shares = vec![Vec::new(); holdings.len()];
    for (node, directions) in of_node {
        let inverse = pseudo_inverse(directions.iter().map(|(_, n)| *n));
        for support in directions.iter().map(|(k, _)| *k).collect::<BTreeSet<_>>() {
            let own = directions.iter().filter(|(k, _)| *k == support).map(|(_, n)| *n);
            shares[support].push((node, product(outer(own), inverse)));
        }
    }
    shares
}

/// Computes `Σ n nᵀ`.
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

/// Computes the pseudo-inverse of `Σ n nᵀ` by eliminating one direction after the other in a basis of the directions.
fn pseudo_inverse(directions: impl Iterator<Item = [f64; 3]> + Clone) -> [[f64; 3]; 3] {
    let matrix = outer(directions.clone());
    let basis = independent(directions.collect(), 3);
    // Gram-Schmidt in the inner product of the matrix makes it diagonal.
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

/// The groups of bodies with a common rigid offset: bodies that are glued together, and bodies in front of the same
/// obstacle.
#[derive(Debug, Clone)]
pub(super) struct RigidGroups {
    /// The group of each node.
    pub of_node: Vec<usize>,
    /// The number of groups.
    pub count: usize,
    /// For each group, the group whose supports determine its offset: the group itself or, if it has no supports, the
    /// nearest group in contact that has supports.
    pub carrier: Vec<usize>,
    /// The group of the rotations of reference points and of jumps, if there are any; it has no offset.
    pub turns: Option<usize>,
}

impl RigidGroups {
    /// Creates the groups of the bodies of `mesh`, where supports hold the nodes of `holdings`.
    pub(super) fn new(
        description: &Description,
        mesh: &Mesh,
        dofs: &Dofs,
        (couplings, pairs): (&Couplings, &Pairs),
        holdings: &[Holding],
    ) -> Result<Self, InputError> {
        let bodies = mesh.bodies();
        let mut together = UnionFind::new(bodies.count());
        let of = |node: usize| bodies.of_nodes()[dofs.in_mesh(node)];
        for (.., nodes) in couplings.each_rigid() {
            let all: BTreeSet<usize> = nodes.into_iter().map(of).collect();
            all.iter().zip(all.iter().skip(1)).for_each(|(a, b)| together.join(*a, *b));
        }
        let mut neighbours: BTreeSet<(usize, usize)> = BTreeSet::new();
        for (k, contact) in description.contacts.iter().enumerate() {
            let key = format!("contact[{k}]");
            let first: BTreeSet<usize> = find(mesh, &contact.boundary, &key)?.nodes().into_iter().map(of).collect();
            let opposite: BTreeSet<usize> = match pairs.of_contact(k).map(|pair| &pairs.all[pair]) {
                Some(pair) => {
                    let both = pair.master.nodes().into_iter().chain(pair.mortar.rows.iter().map(|row| row.node));
                    let both: BTreeSet<usize> = both.map(of).collect();
                    if !pair.glued {
                        neighbours.extend(both.iter().flat_map(|&a| both.iter().map(move |&b| (a, b))));
                        continue;
                    }
                    both
                }
                None => BTreeSet::new(),
            };
            let all: Vec<usize> = first.union(&opposite).copied().collect();
            for pair in all.windows(2) {
                together.join(pair[0], pair[1]);
            }
        }
        let least: Vec<usize> = (0..bodies.count()).map(|k| together.least(k)).collect();
        let firsts: Vec<usize> = (0..bodies.count()).filter(|&k| least[k] == k).collect();
        let group = |body: usize| firsts.binary_search(&least[body]).unwrap_or(0);
        let held: BTreeSet<usize> = holdings.iter().flatten().map(|(node, ..)| group(of(*node))).collect();
        let carrier = |from: usize| {
            let (mut visited, mut queue) = (BTreeSet::from([from]), VecDeque::from([from]));
            while let Some(k) = queue.pop_front() {
                if held.contains(&k) {
                    return k;
                }
                let next = neighbours.iter().filter(|(a, _)| group(*a) == k).map(|(_, b)| group(*b));
                queue.extend(next.filter(|k| visited.insert(*k)));
            }
            from
        };
        // A translation does not turn reference points, and both sides of a jump take part in it.
        let stays = |node: usize| dofs.is_rotation(node) || dofs.is_jump(node);
        let turns = (mesh.nodes.len()..dofs.nodes()).any(stays).then_some(firsts.len());
        let carrier = (0..firsts.len()).map(carrier).chain(turns).collect();
        let group_of = |node: usize| turns.filter(|_| stays(node)).unwrap_or_else(|| group(of(node)));
        let of_node = (0..dofs.nodes()).map(group_of).collect();
        Ok(RigidGroups { of_node, count: firsts.len() + usize::from(turns.is_some()), carrier, turns })
    }
}

/// A translation counts as not prescribed if its effect on the held directions is below this share of the largest
/// effect.
const FELT: f64 = 1e-6;

/// Computes the translation (m) nearest in the least-squares sense to displacements prescribed at nodes, pairs of a
/// unit vector and the displacement (m) along it. The translation is 0 along directions that are not prescribed.
fn nearest_translation(prescribed: impl Iterator<Item = ([f64; 3], f64)> + Clone) -> [f64; 3] {
    // Gram-Schmidt on the columns of `n · t = value`, twice, recording the combination for each basis vector. The
    // longest column is first, since a column that is small because a direction is off its axis by rounding contains no
    // information.
    let mut columns: Vec<(usize, Vec<f64>)> =
        (0..3).map(|c| (c, prescribed.clone().map(|(n, _)| n[c]).collect())).collect();
    columns.sort_by(|(_, a), (_, b)| dot(b, b).total_cmp(&dot(a, a)));
    let whole = dot(&columns[0].1, &columns[0].1).sqrt();
    let mut basis: Vec<(Vec<f64>, [f64; 3])> = Vec::new();
    for (c, mut member) in columns {
        let mut made_of = axis(c);
        for (other, of) in basis.iter().chain(&basis) {
            let along = dot(&member, other);
            member.iter_mut().zip(other).for_each(|(x, y)| *x -= along * y);
            made_of = minus(made_of, of.map(|x| along * x));
        }
        let length = dot(&member, &member).sqrt();
        if length > FELT * whole {
            basis.push((member.into_iter().map(|x| x / length).collect(), made_of.map(|x| x / length)));
        }
    }
    let mut residual: Vec<f64> = prescribed.map(|(_, value)| value).collect();
    let mut translation = [0.0; 3];
    for (member, made_of) in basis.iter().chain(&basis) {
        let along = dot(&residual, member);
        residual.iter_mut().zip(member).for_each(|(x, y)| *x -= along * y);
        (0..3).for_each(|c| translation[c] += along * made_of[c]);
    }
    translation
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::vector::unit;

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
        // Two supports of the same direction have half each.
        let inverse = pseudo_inverse([axis(1), axis(1)].into_iter());
        assert_eq!(product(outer([axis(1)].into_iter()), inverse)[1], [0.0, 0.5, 0.0]);
    }

    #[test]
    fn what_moves_as_a_whole_is_seen_to() {
        let to = [1.0, -2.0, 3e-3];
        let along = |n: [f64; 3]| (n, dot(n, to));
        let oblique = unit([1.0, 1.0, 0.0]);
        let all = [axis(0), axis(1), axis(2), oblique].map(along);
        let found = nearest_translation(all.into_iter());
        assert!((0..3).all(|c| (found[c] - to[c]).abs() < 1e-15), "{found:?}");
        // The motion across is not prescribed.
        let found = nearest_translation([along(oblique), along(oblique)].into_iter());
        assert!((dot(found, oblique) - dot(to, oblique)).abs() < 1e-15 && found[2] == 0.0, "{found:?}");
        assert_eq!(nearest_translation(std::iter::empty()), [0.0; 3]);
        // A direction turned off its axis by rounding.
        for off in [1e-25, 6e-17, 1e-10, 1e-7] {
            let found = nearest_translation([(unit([off, -1.0, 0.0]), 1e-6); 5].into_iter());
            assert!(norm(found) < 1.1e-6 && (found[1] + 1e-6).abs() < 1e-12, "{off}: {found:?}");
        }
    }
}
