//! Nodes that come into contact, or begin to stick, within an increment.

use super::{NEGLIGIBLE, Node};
use crate::solver::laws::coulomb::{TangentialCase, length};

/// How a node comes into contact, or to stick, within an increment.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Begin {
    /// Whether it sticks from within the increment on.
    pub sticks: bool,
    /// Whether it slipped before that.
    pub slipped: bool,
    /// The share of the increment after which it touches.
    pub touches: Option<f64>,
    /// How far from where the increment has it the node sticks.
    pub delta: [f64; 2],
    /// Of a node that slips in the end, how far it moved before it touched.
    pub before_touch: [f64; 2],
}

impl Begin {
    /// Of a node that ends the increment in this `case`, after a `slip` from where it was `before`, and set out at this `rate`.
    pub(super) fn of(before: &Node, case: TangentialCase, slip: [f64; 2], rate: Option<(f64, [f64; 2])>) -> Self {
        let Some((approach, pace)) = rate else { return Begin::default() };
        let ahead = |share: f64| pace.map(|w| share * w);
        match (before.case, case) {
            _ if before.is_open() && case != TangentialCase::NoPressure => {
                // What was not seen to close closes at the end.
                let share = if approach > 0.0 { (before.distance / approach).min(1.0) } else { 1.0 };
                let share = if share > NEGLIGIBLE { share } else { 0.0 };
                let moved = ahead(share);
                let (farther, before_touch, falls_short) = match case {
                    TangentialCase::Slip { direction, .. } => {
                        let farther = [moved[0] - slip[0], moved[1] - slip[1]];
                        // The increment takes its way to where it touched for slip.
                        let short = direction[0] * farther[0] + direction[1] * farther[1];
                        (farther, moved, short > NEGLIGIBLE * length(moved))
                    }
                    _ => (moved, [0.0; 2], true),
                };
                let sticks = falls_short && share > 0.0;
                let delta = if sticks { farther } else { [0.0; 2] };
                Begin { sticks, slipped: false, touches: Some(share), delta, before_touch }
            }
            (TangentialCase::Slip { direction, .. }, TangentialCase::Stick)
                if direction[0] * pace[0] + direction[1] * pace[1] > 0.0 =>
            {
                Begin { sticks: true, slipped: true, delta: ahead(0.5), ..Begin::default() }
            }
            _ => Begin::default(),
        }
    }
}
