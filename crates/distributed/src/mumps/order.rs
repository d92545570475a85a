//! The order of elimination for MUMPS: nested dissection by METIS, computed here. A build of MUMPS without METIS
//! would silently take another order, which has 1.7 times the fill.
//!
//! METIS orders groups of unknowns with the same couplings, usually those of a node, so that in space its graph has a
//! ninth of the size of the matrix. If a group is coupled with only one other group, as contact forces with the
//! displacements of their node, it joins that group. In a group displacements come before forces, whose diagonal is
//! zero at closed nodes.

use std::collections::HashMap;
use std::ffi::c_int;

use crate::ranks::{Graph, order};
use stickslip::algebra::Pattern;
use stickslip::algebra::linear::LinearError;

/// Returns the slots of the entries of a column.
pub(super) fn column(pattern: &Pattern, j: usize) -> std::ops::Range<usize> {
    pattern.column_starts()[j] as usize..pattern.column_starts()[j + 1] as usize
}

const STEP: &str = "ordering the unknowns";

/// Returns the place of each unknown in the order, from 1: `PERM_IN` of MUMPS.
///
/// # Errors
/// If memory is short, or if there are more couplings than the 32-bit integers of METIS can count.
pub(super) fn places(pattern: &Pattern) -> Result<Vec<c_int>, LinearError> {
    let Groups { members, graph } = Groups::new(&symmetric(pattern)?)?;
    let mut place = vec![0; pattern.columns()];
    let unknowns = order(STEP, graph)?.into_iter().flat_map(|group| &members[group]);
    unknowns.zip(1..).for_each(|(&unknown, next)| place[unknown] = next);
    Ok(place)
}

/// Returns the pattern of `A + Aᵀ` with the whole diagonal.
fn symmetric(pattern: &Pattern) -> Result<Pattern, LinearError> {
    let n = pattern.columns();
    Pattern::from_entries(n, n, |take| {
        for j in 0..n {
            take(j, j);
            for &i in &pattern.row_indices()[column(pattern, j)] {
                take(i as usize, j);
                take(j, i as usize);
            }
        }
    })
    .map_err(|_| LinearError::OutOfMemory { step: STEP })
}

/// Unknowns that are ordered as one, as the vertices of a graph.
struct Groups {
    /// The unknowns of each group, in their order.
    members: Vec<Vec<usize>>,
    graph: Graph,
}

impl Groups {
    fn new(pattern: &Pattern) -> Result<Self, LinearError> {
        let n = pattern.columns();
        let column = |j: usize| &pattern.row_indices()[column(pattern, j)];
        // Unknowns with the same couplings have the same column pattern, diagonal included.
        let mut first_of = HashMap::new();
        let mut group_of = Vec::with_capacity(n);
        let mut members: Vec<Vec<usize>> = Vec::new();
        for j in 0..n {
            let group = *first_of.entry(column(j)).or_insert(members.len());
            if group == members.len() {
                members.push(Vec::new());
            }
            members[group].push(j);
            group_of.push(group);
        }
        drop(first_of);
        let others = |group: usize, group_of: &[usize]| {
            let mut others: Vec<usize> = column(members[group][0]).iter().map(|&i| group_of[i as usize]).collect();
            others.sort_unstable();
            others.dedup();
            others.retain(|&other| other != group);
            others
        };
        // A group with one neighbour joins it, unless that would also join another one.
        let only: Vec<Option<usize>> = (0..members.len())
            .map(|group| match others(group, &group_of)[..] {
                [other] => Some(other),
                _ => None,
            })
            .collect();
        let head = |group: usize| only[group].filter(|&other| only[other].is_none()).unwrap_or(group);
        let mut vertex = vec![usize::MAX; members.len()];
        let heads: Vec<usize> = (0..members.len()).filter(|&group| head(group) == group).collect();
        heads.iter().enumerate().for_each(|(v, &group)| vertex[group] = v);
        let mut together: Vec<Vec<usize>> = vec![Vec::new(); heads.len()];
        for (group, members) in members.iter().enumerate() {
            together[vertex[head(group)]].extend(members);
        }
        for unknowns in &mut together {
            unknowns.sort_unstable();
        }
        let beside = |group: usize| others(group, &group_of).into_iter().map(|other| vertex[other]);
        let vertices = heads.iter().zip(&together).map(|(&group, members)| (members.len(), beside(group)));
        let graph = Graph::new(STEP, vertices)?;
        Ok(Groups { members: together, graph })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern(entries: &[(usize, usize)], n: usize) -> Pattern {
        Pattern::from_entries(n, n, |take| entries.iter().for_each(|&(i, j)| take(i, j))).unwrap()
    }

    #[test]
    fn nodes_are_found_and_forces_come_after_their_displacements() {
        // Three nodes with two displacements each in a row, and two forces at the last node.
        let mut entries = Vec::new();
        for (a, b) in [(0, 0), (0, 1), (1, 1), (1, 2), (2, 2)] {
            entries.extend([0, 1].into_iter().flat_map(|i| [0, 1].map(|j| (2 * a + i, 2 * b + j))));
        }
        entries.extend([(6, 4), (4, 6), (7, 5), (5, 7), (6, 5), (7, 4), (6, 7)]);
        let pattern = pattern(&entries, 8);
        let groups = Groups::new(&symmetric(&pattern).unwrap()).unwrap();
        // The first node also has only one neighbour.
        assert_eq!(groups.members, [[0, 1, 2, 3], [4, 5, 6, 7]]);
        assert_eq!(groups.graph.lists(), (&[0, 1, 2][..], &[1, 0][..]));
        let place = places(&pattern).unwrap();
        assert!(place[6] > place[4] && place[6] > place[5] && place[7] > place[5]);
    }

    #[test]
    fn every_unknown_has_a_place() {
        // A square of nodes, each coupled with those around it; one unknown alone, and two coupled only with each
        // other.
        let side = 12;
        let mut entries = vec![(side * side + 1, side * side + 2)];
        let at = |i: usize, j: usize| side * i + j;
        for i in 0..side {
            for j in 0..side {
                entries.push((at(i, j), at(i.saturating_sub(1), j)));
                entries.push((at(i, j), at(i, j.saturating_sub(1))));
            }
        }
        let n = side * side + 3;
        let mut place = places(&pattern(&entries, n)).unwrap();
        place.sort_unstable();
        assert!(place.into_iter().eq(1..=n as c_int));
    }

    #[test]
    fn few_unknowns_are_ordered_too() {
        assert_eq!(places(&pattern(&[(0, 0)], 1)).unwrap(), [1]);
        let mut place = places(&pattern(&[(0, 1), (1, 0)], 2)).unwrap();
        place.sort_unstable();
        assert_eq!(place, [1, 2]);
        assert!(places(&pattern(&[], 0)).unwrap().is_empty());
    }
}
