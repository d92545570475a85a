//! The data of a contact node in a cycle.

use serde::{Deserialize, Serialize};

use super::super::contact_line::ContactPoint;
use crate::body::model::Model;
use crate::solver::laws::ContactStatus;

/// A contact node in a cycle. Means are those of the largest and the smallest value, as for fatigue.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct CycleNode {
    /// The boundary.
    pub boundary: String,
    /// The number of the node in the mesh, from 0.
    pub node: usize,
    /// Position, m.
    pub position: [f64; 3],
    /// The node's share of the boundary, m²; in two dimensions m² per m of depth.
    pub area: f64,
    /// The slip range, m: in the plane the difference between the extremes of the slip, in space the diagonal of the
    /// rectangle of both slips.
    pub slip_range: f64,
    /// The length of the slip path, m.
    pub slip_path: f64,
    /// The net slip from the beginning to the end, m.
    pub slip_net: f64,
    /// The friction work per area, J/m².
    pub energy_density: f64,
    /// The mean and the range of the contact pressure, Pa.
    pub pressure: [f64; 2],
    /// The mean and the range of the tangential contact stress along each tangent, Pa.
    pub traction: [[f64; 2]; 2],
    /// The largest magnitude of the tangential contact stress times the slip range, J/m² (the first parameter of Ruiz,
    /// Boddington and Chen, Exp. Mech. 24 (1984) 208).
    pub ruiz_1: f64,
    /// The mean and the range of the normal stress along the surface in the direction t, Pa.
    pub along: [f64; 2],
    /// [`CycleNode::ruiz_1`] times the largest tension along the surface in the direction t, Pa J/m²; 0 without tension (the
    /// second parameter of Ruiz).
    pub ruiz_2: f64,
    /// The wear depth of one cycle (Archard), m, if a coefficient is given: the coefficient times the integral of the
    /// pressure over the slip path.
    pub wear_depth: Option<f64>,
}

/// The smallest and the largest value so far.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Extremes {
    low: f64,
    high: f64,
}

impl Extremes {
    fn at(x: f64) -> Self {
        Extremes { low: x, high: x }
    }

    fn add(&mut self, x: f64) {
        (self.low, self.high) = (self.low.min(x), self.high.max(x));
    }

    fn range(self) -> f64 {
        self.high - self.low
    }

    /// Returns the mean of the extremes and the range.
    fn mean_and_range(self) -> [f64; 2] {
        [0.5 * (self.low + self.high), self.range()]
    }
}

/// Collects the data of a contact node. Only motion in contact counts as slip.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct NodeWatch {
    /// The motion past the obstacle at the end of the last step, m.
    motion: [f64; 2],
    /// The slip since the beginning of the cycle, m.
    slip: [f64; 2],
    slips: [Extremes; 2],
    path: f64,
    /// The friction work, J.
    pub work: f64,
    /// The pressure at the end of the last step, Pa, and its integral over the slip path, Pa m.
    last: f64,
    pressed_path: f64,
    /// The tangential forces at the end of the last step, N.
    force: [f64; 2],
    pressure: Extremes,
    traction: [Extremes; 2],
    along: Extremes,
    largest_traction: f64,
}

impl NodeWatch {
    /// Begins a cycle in this state.
    pub fn at(point: &ContactPoint) -> Self {
        NodeWatch {
            motion: [point.slip_t, point.slip_o],
            last: point.sigma_n,
            force: [point.p_t, point.p_o],
            pressure: Extremes::at(point.sigma_n),
            traction: [point.sigma_t, point.sigma_o].map(Extremes::at),
            along: Extremes::at(point.sigma_along),
            largest_traction: point.sigma_t.hypot(point.sigma_o),
            ..NodeWatch::default()
        }
    }

    /// Adds a step that ends in this state, and in which friction has done this `work` (J).
    pub fn observe(&mut self, point: &ContactPoint, work: f64) {
        let slips = point.status == ContactStatus::Slip;
        self.add(point, slips.then_some(work));
    }

    /// Adds a step along an exact path that ends in this state. Its friction work is that of the mean force.
    pub fn observe_path(&mut self, point: &ContactPoint) {
        let slip = self.slip_to(point);
        let work = 0.5 * ((self.force[0] + point.p_t) * slip[0] + (self.force[1] + point.p_o) * slip[1]);
        self.add(point, (point.status != ContactStatus::Open).then_some(work));
    }

    fn slip_to(&self, point: &ContactPoint) -> [f64; 2] {
        [point.slip_t - self.motion[0], point.slip_o - self.motion[1]]
    }

    /// Adds a step with the friction `work`; `None` if the node has not slipped.
    fn add(&mut self, point: &ContactPoint, work: Option<f64>) {
        if let Some(work) = work {
            let slip = self.slip_to(point);
            let length = slip[0].hypot(slip[1]);
            self.slip = [0, 1].map(|k| self.slip[k] + slip[k]);
            self.slips.iter_mut().zip(self.slip).for_each(|(slips, slip)| slips.add(slip));
            self.path += length;
            self.pressed_path += 0.5 * (self.last + point.sigma_n) * length;
            self.work += work;
        }
        self.motion = [point.slip_t, point.slip_o];
        self.force = [point.p_t, point.p_o];
        self.last = point.sigma_n;
        self.pressure.add(point.sigma_n);
        self.along.add(point.sigma_along);
        self.traction.iter_mut().zip([point.sigma_t, point.sigma_o]).for_each(|(of, sigma)| of.add(sigma));
        self.largest_traction = self.largest_traction.max(point.sigma_t.hypot(point.sigma_o));
    }

    pub fn slip_range(&self) -> f64 {
        let [t, o] = self.slips;
        t.range().hypot(o.range())
    }

    pub fn slip_net(&self) -> f64 {
        self.slip[0].hypot(self.slip[1])
    }

    /// Returns the data of contact node `i` on a `boundary`.
    pub fn node(&self, model: &Model, boundary: &str, i: usize, wear_coefficient: Option<f64>) -> CycleNode {
        let contact = &model.contact.nodes[i];
        CycleNode {
            boundary: boundary.to_string(),
            node: contact.node,
            position: contact.position,
            area: contact.weight,
            slip_range: self.slip_range(),
            slip_path: self.path,
            slip_net: self.slip_net(),
            energy_density: self.work / contact.weight,
            pressure: self.pressure.mean_and_range(),
            traction: self.traction.map(Extremes::mean_and_range),
            ruiz_1: self.largest_traction * self.slip_range(),
            along: self.along.mean_and_range(),
            ruiz_2: self.largest_traction * self.slip_range() * self.along.high.max(0.0),
            wear_depth: wear_coefficient.map(|k| k * self.pressed_path),
        }
    }
}
