//! Nodes that come into contact, or begin to stick, within an increment.

use super::{NEGLIGIBLE, Node};
use crate::contact::coulomb::TangentialCase;

/// How a node comes into contact, or to stick, within an increment.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Begin {
    /// Whether it sticks from within the increment on.
    pub sticks: bool,
    /// Whether it slipped before that.
    pub slipped: bool,
    /// How far it has slid by then.
    pub delta: [f64; 2],
    /// Of a node that slips in the end, how far it moved before it touched.
    pub before_touch: [f64; 2],
}

impl Begin {
    pub(super) fn of(before: &Node, case: TangentialCase, rate: Option<(f64, [f64; 2])>) -> Self {
        let Some((approach, slip)) = rate else { return Begin::default() };
        let ahead = |share: f64| slip.map(|w| share * w);
        match (before.case, case) {
            _ if before.is_open() && case != TangentialCase::NoPressure => {
                // What was not seen to close closes at the end.
                let share = if approach > 0.0 { (before.distance / approach).min(1.0) } else { 1.0 };
                let share = if share > NEGLIGIBLE { share } else { 0.0 };
                let (moved, sticks) = (ahead(share), case == TangentialCase::Stick && share > 0.0);
                Begin {
                    sticks,
                    slipped: false,
                    delta: if sticks { moved } else { [0.0; 2] },
                    before_touch: if sticks { [0.0; 2] } else { moved },
                }
            }
            (TangentialCase::Slip { direction, .. }, TangentialCase::Stick)
                if direction[0] * slip[0] + direction[1] * slip[1] > 0.0 =>
            {
                Begin { sticks: true, slipped: true, delta: ahead(0.5), before_touch: [0.0; 2] }
            }
            _ => Begin::default(),
        }
    }
}
