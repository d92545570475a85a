//! Choice of the slave of two boundaries.

use std::fmt;

use super::{Mortar, MortarFault, MortarOptions, MortarRow, Supports};
use crate::body::mesh::{Boundary, Mesh};

/// Numbers of nodes count as equal if they differ by no more than this share of the larger.
const ALIKE: f64 = 0.1;

/// The choice of the slave of two boundaries, and its reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SlaveChoice {
    /// The slave: 0 for the first boundary, 1 for the second.
    pub slave: usize,
    /// The number of nodes of each boundary that would have a row: nodes in front of the other boundary that supports
    /// do not hold.
    pub rows: [usize; 2],
    /// The reason of the choice.
    pub reason: SlaveReason,
}

/// The reason of the choice of the slave.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SlaveReason {
    /// Supports hold the other boundary.
    OtherHeld,
    /// The nodes of the other boundary carry the forces of another contact.
    OtherTaken,
    /// Nodes of the other boundary are beyond the end of the chosen one.
    OtherOverhangs,
    /// The chosen boundary has more nodes in front of the other.
    MoreNodes,
    /// The chosen boundary has fewer nodes in front of the other, and both are curved there.
    FewerNodes,
    /// The chosen boundary is softer, and both have about the same number of nodes.
    Softer,
    /// No criterion distinguishes the two; the first one is chosen.
    Alike,
}

impl fmt::Display for SlaveReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            SlaveReason::OtherHeld => "supports or a coupling hold the other",
            SlaveReason::OtherTaken => "the other is that of another contact",
            SlaveReason::OtherOverhangs => "the other has nodes beyond its end",
            SlaveReason::MoreNodes => "it has more nodes in front of the other",
            SlaveReason::FewerNodes => "it has fewer nodes in front of the other, and the two are curved",
            SlaveReason::Softer => "it is the softer, with about as many nodes",
            SlaveReason::Alike => "the two are alike",
        })
    }
}

impl Mortar {
    /// Computes the rows of two boundaries and chooses the slave.
    ///
    /// The criteria in order: the boundary that supports do not hold; the boundary without nodes beyond the end of the
    /// other; the boundary with more nodes in front of the other, since the law applies at the slave nodes, but with fewer
    /// if the two are curved, since facets of the master move as chords, which nodes between their ends feel; if the numbers
    /// are about equal, the softer one by the Young's moduli `young` (Pa). A boundary of `are_slaves`, as the slave of
    /// another contact, is avoided.
    ///
    /// # Errors
    ///
    /// As [`Mortar::new`]. If neither boundary can be the slave, the error is that of the first.
    pub fn of_better_slave(
        mesh: &Mesh,
        sides: [&Boundary; 2],
        young: [f64; 2],
        are_slaves: [bool; 2],
        options: &MortarOptions,
        supports: &dyn Supports,
    ) -> Result<(Self, SlaveChoice), MortarFault> {
        let of = |slave: usize| {
            // The given direction points out of the first boundary.
            let direction = options.direction.map(|n| if slave == 0 { n } else { n.map(|c| -c) });
            Mortar::new(mesh, sides[slave], sides[1 - slave], &MortarOptions { direction, ..*options }, supports)
        };
        let (first, second) = match (of(0), of(1)) {
            (Ok(first), Ok(second)) => (first, second),
            (Ok(first), Err(MortarFault::SlaveHeld { .. })) => return Ok(held_other(first, 0)),
            (Err(MortarFault::SlaveHeld { .. }), Ok(second)) => return Ok(held_other(second, 1)),
            (Err(fault), _) | (_, Err(fault)) => return Err(fault),
        };
        let rows = [first.rows.len(), second.rows.len()];
        let (slave, reason) = match are_slaves {
            [true, false] => (1, SlaveReason::OtherTaken),
            [false, true] => (0, SlaveReason::OtherTaken),
            _ => match first.overhangs() {
                [true, false] => (1, SlaveReason::OtherOverhangs),
                [false, true] => (0, SlaveReason::OtherOverhangs),
                _ => better(rows, first.is_curved(), young),
            },
        };
        Ok((if slave == 0 { first } else { second }, SlaveChoice { slave, rows, reason }))
    }

    /// Returns `true` if the two boundaries are curved where they are nearest: at most of the nearest quarter of the nodes.
    fn is_curved(&self) -> bool {
        let mut rows: Vec<&MortarRow> = self.rows.iter().collect();
        rows.sort_by(|a, b| (a.gap - a.bulge).total_cmp(&(b.gap - b.bulge)));
        rows.truncate(rows.len().div_ceil(4));
        2 * rows.iter().filter(|row| row.bulge != 0.0).count() > rows.len()
    }
}

fn held_other(mortar: Mortar, slave: usize) -> (Mortar, SlaveChoice) {
    let rows = [0, 1].map(|side| if side == slave { mortar.rows.len() } else { 0 });
    (mortar, SlaveChoice { slave, rows, reason: SlaveReason::OtherHeld })
}

fn better([first, second]: [usize; 2], curved: bool, young: [f64; 2]) -> (usize, SlaveReason) {
    let alike = first.abs_diff(second) as f64 <= ALIKE * first.max(second) as f64;
    match () {
        () if !alike && curved => (usize::from(second < first), SlaveReason::FewerNodes),
        () if !alike => (usize::from(second > first), SlaveReason::MoreNodes),
        () if young[0] != young[1] => (usize::from(young[1] < young[0]), SlaveReason::Softer),
        () => (0, SlaveReason::Alike),
    }
}
