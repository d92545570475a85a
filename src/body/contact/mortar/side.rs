//! Which of two boundaries is better the slave.

use std::fmt;

use super::{Mortar, MortarFault, MortarOptions, Supports};
use crate::body::mesh::{Boundary, Mesh};

/// Numbers of nodes that differ by no more than this share of the larger are alike.
const ALIKE: f64 = 0.1;

/// Which of two boundaries is better the slave, and why.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SlaveChoice {
    /// The first, 0, or the second, 1.
    pub slave: usize,
    /// How many nodes of each would have a row: those in front of the other that supports do not hold.
    pub rows: [usize; 2],
    /// Why it is that one.
    pub reason: SlaveReason,
}

/// Why a boundary is better the slave.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SlaveReason {
    /// Supports hold the other.
    OtherHeld,
    /// The nodes of the other carry the forces of another contact.
    OtherTaken,
    /// Nodes of the other are beyond its end.
    OtherOverhangs,
    /// It has more nodes in front of the other.
    MoreNodes,
    /// It is the softer, with about as many nodes.
    Softer,
    /// The two are alike: the one that is named first.
    Alike,
}

impl fmt::Display for SlaveReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            SlaveReason::OtherHeld => "supports hold the other",
            SlaveReason::OtherTaken => "the other is that of another contact",
            SlaveReason::OtherOverhangs => "the other has nodes beyond its end",
            SlaveReason::MoreNodes => "it has more nodes in front of the other",
            SlaveReason::Softer => "it is the softer, with about as many nodes",
            SlaveReason::Alike => "the two are alike",
        })
    }
}

impl Mortar {
    /// The rows of two boundaries with the better one as the slave: what supports leave free; of two that are free the one without
    /// nodes beyond the end of the other; then the one with more nodes in front of the other, for the law is asked at the nodes of the
    /// slave; with about as many the softer, by the two Young's
    /// moduli `young` (Pa). One that is `taken`, as it is the slave of another contact, gives way.
    ///
    /// # Errors
    ///
    /// As [`Mortar::new`], of the first as the slave if neither can be.
    pub fn of_better_slave(
        mesh: &Mesh,
        sides: [&Boundary; 2],
        young: [f64; 2],
        taken: [bool; 2],
        options: &MortarOptions,
        supports: &dyn Supports,
    ) -> Result<(Self, SlaveChoice), MortarFault> {
        let of = |slave: usize| {
            // A direction points out of the first.
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
        let (slave, reason) = match taken {
            [true, false] => (1, SlaveReason::OtherTaken),
            [false, true] => (0, SlaveReason::OtherTaken),
            _ => match first.overhangs() {
                [true, false] => (1, SlaveReason::OtherOverhangs),
                [false, true] => (0, SlaveReason::OtherOverhangs),
                _ => better(rows, young),
            },
        };
        Ok((if slave == 0 { first } else { second }, SlaveChoice { slave, rows, reason }))
    }
}

fn held_other(mortar: Mortar, slave: usize) -> (Mortar, SlaveChoice) {
    let rows = [0, 1].map(|side| if side == slave { mortar.rows.len() } else { 0 });
    (mortar, SlaveChoice { slave, rows, reason: SlaveReason::OtherHeld })
}

fn better([first, second]: [usize; 2], young: [f64; 2]) -> (usize, SlaveReason) {
    let alike = first.abs_diff(second) as f64 <= ALIKE * first.max(second) as f64;
    match () {
        () if !alike => (usize::from(second > first), SlaveReason::MoreNodes),
        () if young[0] != young[1] => (usize::from(young[1] < young[0]), SlaveReason::Softer),
        () => (0, SlaveReason::Alike),
    }
}
