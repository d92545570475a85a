//! Groups of bodies with a common rigid offset by supports.
//!
//! A rigid offset causes no strain, and forces of the stiffness that would cancel are left out (`Moved`). Bodies that
//! are moved by different supports have different offsets. With one offset for all, a stiff body at rest would be
//! pulled back against the mean by forces far above the actual ones.

use std::collections::{BTreeSet, VecDeque};

use super::coupling::Couplings;
use super::find;
use super::holding::Holding;
use super::pair::Pairs;
use crate::algebra::union_find::UnionFind;
use crate::base::input_error::InputError;
use crate::body::constraints::Dofs;
use crate::body::description::Description;
use crate::body::mesh::Mesh;

/// The groups of bodies with a common rigid offset: bodies that are glued together, and bodies in front of the same
/// obstacle.
#[derive(Debug, Clone)]
pub(super) struct Carrying {
    /// The group of each node.
    of_node: Vec<usize>,
    /// The number of groups.
    pub groups: usize,
    /// For each group, the group whose supports determine its offset: the group itself or, if it has no supports, the
    /// nearest group in contact that has supports.
    pub carrier: Vec<usize>,
    /// The group of the rotations of reference points and of jumps, if there are any; it has no offset.
    pub turns: Option<usize>,
}

impl Carrying {
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
            let (mut seen, mut queue) = (BTreeSet::from([from]), VecDeque::from([from]));
            while let Some(k) = queue.pop_front() {
                if held.contains(&k) {
                    return k;
                }
                let next = neighbours.iter().filter(|(a, _)| group(*a) == k).map(|(_, b)| group(*b));
                queue.extend(next.filter(|k| seen.insert(*k)));
            }
            from
        };
        // A translation does not turn reference points, and both sides of a jump take part in it.
        let stays = |node: usize| dofs.is_rotation(node) || dofs.is_jump(node);
        let turns = (mesh.nodes.len()..dofs.nodes()).any(stays).then_some(firsts.len());
        let carrier = (0..firsts.len()).map(carrier).chain(turns).collect();
        let group_of = |node: usize| turns.filter(|_| stays(node)).unwrap_or_else(|| group(of(node)));
        let of_node = (0..dofs.nodes()).map(group_of).collect();
        Ok(Carrying { of_node, groups: firsts.len() + usize::from(turns.is_some()), carrier, turns })
    }

    /// Returns the number of nodes.
    pub(super) fn nodes(&self) -> usize {
        self.of_node.len()
    }

    /// Returns the group of `node`.
    pub(super) fn of(&self, node: usize) -> usize {
        self.of_node[node]
    }
}
