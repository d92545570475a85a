//! The quantities whose convergence can be asked for, and their values in the report of a run.

use std::fmt;
use std::str::FromStr;

use serde::Serialize;

use stickslip::base::Quantity;
use stickslip::run::report::RunReport;

/// A quantity of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Sought {
    /// The largest contact pressure of the history, Pa.
    Peak,
    /// The largest resultant of the contact forces of a boundary in the history, N.
    Force,
    /// The friction work of the whole history, J.
    FrictionWork,
    /// The width of the stick zone as a share of the width of the contact, at the largest tangential force.
    StickRatio,
}

/// Narrower zones have no peak that says anything about finer meshes.
const FINE_FOR_PEAK: usize = 5;

/// The stick ratio does not count if the mesh alone makes a larger uncertainty, as in zones of fewer than nine nodes.
const FINE_FOR_STICK: f64 = 1.0 / (3.0 * 9.0);

impl Sought {
    /// All quantities.
    pub const ALL: [Sought; 4] = [Sought::Peak, Sought::Force, Sought::FrictionWork, Sought::StickRatio];

    /// Returns the name on the command line.
    pub fn key(self) -> &'static str {
        match self {
            Sought::Peak => "peak",
            Sought::Force => "force",
            Sought::FrictionWork => "friction_work",
            Sought::StickRatio => "stick_ratio",
        }
    }

    /// Returns the kind of its unit.
    pub fn quantity(self) -> Quantity {
        match self {
            Sought::Peak => Quantity::Stress,
            Sought::Force => Quantity::Force,
            Sought::FrictionWork => Quantity::Energy,
            Sought::StickRatio => Quantity::Number,
        }
    }

    /// Returns the value in `report`, SI; `None` if the run has none.
    pub fn value(self, report: &RunReport) -> Option<f64> {
        match self {
            Sought::Peak => report.largest_pressure.as_ref()?.pressure,
            Sought::Force => Some(report.largest_force.as_ref()?.magnitude),
            Sought::FrictionWork => Some(report.friction.as_ref()?.friction_work),
            Sought::StickRatio => Some(report.stick_zone.as_ref()?.ratio),
        }
    }

    /// Returns the error of the value by rounding to whole elements: half an element at each end of the stick zone, three
    /// times the typical error.
    pub(super) fn rounding(self, report: &RunReport) -> f64 {
        let stick = report.stick_zone.as_ref().filter(|_| self == Sought::StickRatio);
        stick.map_or(0.0, |stick| 3.0 * stick.uncertainty)
    }

    /// Returns `true` if the contact has enough nodes across for the value to follow an order.
    pub(super) fn is_resolved(self, report: &RunReport) -> bool {
        match self {
            Sought::Peak => {
                let across = report.largest_pressure.as_ref().and_then(|largest| largest.nodes_across);
                across.is_none_or(|across| across >= FINE_FOR_PEAK)
            }
            Sought::StickRatio => report.stick_zone.as_ref().is_some_and(|stick| stick.uncertainty <= FINE_FOR_STICK),
            Sought::Force | Sought::FrictionWork => true,
        }
    }
}

impl fmt::Display for Sought {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Sought::Peak => "peak pressure",
            Sought::Force => "contact force",
            Sought::FrictionWork => "friction work",
            Sought::StickRatio => "stick ratio",
        })
    }
}

impl FromStr for Sought {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = Sought::ALL.iter().find(|sought| sought.key() == text);
        known.copied().ok_or_else(|| format!("the quantities are {}", Sought::ALL.map(Sought::key).join(", ")))
    }
}
