//! Kinks of histories within increments, and increments that end at kinks.

use super::{Description, Load, Pretension, Support};
use crate::base::timeline::{kinks_between, with_further_ends};
use crate::base::units::UnitSystem;

/// The kinks of a history at which no increment ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Kinks<'a> {
    of: History<'a>,
    /// The times, s, ascending.
    pub times: Vec<f64>,
}

#[derive(Debug, Clone, PartialEq)]
enum History<'a> {
    Load(&'a Load),
    Support(&'a Support),
    Pretension(&'a Pretension),
    Lock(&'a Pretension),
    Friction(&'a str),
    Obstacle { motion: &'static str, boundary: &'a str },
}

impl Kinks<'_> {
    /// Describes the history, for example as `the load on top`, with coordinates in `units`.
    pub fn history(&self, units: &UnitSystem) -> String {
        match &self.of {
            History::Load(load) => format!("the load on {}", load.action.location(units)),
            History::Support(support) => format!("the support of {}", support.at.location(units)),
            History::Pretension(pretension) => format!("the pretension {}", pretension.name),
            History::Lock(pretension) => format!("the lock of the pretension {}", pretension.name),
            History::Friction(boundary) => format!("the friction at {boundary}"),
            History::Obstacle { motion, boundary } => format!("the {motion} of the obstacle at {boundary}"),
        }
    }
}

impl Description {
    /// Returns the histories with kinks between `times` (s), the ends of increments.
    pub fn kinks_between(&self, times: &[f64]) -> Vec<Kinks<'_>> {
        let end = times.last().copied().unwrap_or(0.0);
        let loads = self.loads.iter().map(|load| (History::Load(load), kinks_between(times, &load.factors(end))));
        let moved = self.supports.iter().filter(|support| support.moves());
        let supports = moved.map(|support| (History::Support(support), kinks_between(times, &support.factors(end))));
        let contacts = self.contacts.iter().flat_map(|contact| {
            let boundary = contact.boundary.as_str();
            let factors = contact.friction_history.as_deref().unwrap_or_default();
            let friction = (History::Friction(boundary), kinks_between(times, factors));
            let obstacles = contact.obstacles().iter().flat_map(move |obstacle| {
                let approach = obstacle.approach.as_deref().unwrap_or_default();
                let turned = obstacle.rotation.as_ref().map_or(&[][..], |rotation| &rotation.history);
                [
                    ("approach", kinks_between(times, approach)),
                    ("translation", kinks_between(times, &obstacle.path())),
                    ("rotation", kinks_between(times, turned)),
                ]
                .map(|(motion, kinks)| (History::Obstacle { motion, boundary }, kinks))
            });
            [friction].into_iter().chain(obstacles)
        });
        let pretensions = self.pretensions.iter().flat_map(|pretension| {
            let factors = pretension.factors(end);
            let own = (History::Pretension(pretension), kinks_between(times, &factors));
            let lock = pretension.lock.map_or(Vec::new(), |lock| kinks_between(times, &[[0.0, 0.0], [lock, 1.0]]));
            [own, (History::Lock(pretension), lock)]
        });
        let all = loads.chain(supports).chain(pretensions).chain(contacts).filter(|(_, times)| !times.is_empty());
        all.map(|(of, times)| Kinks { of, times }).collect()
    }

    /// Inserts the kinks of all histories in `times` (s), the ends of increments. Then forces, motions and friction
    /// change linearly within an increment, and no peak of a history is missed.
    pub fn ends_at_kinks(&self, times: &[f64]) -> Vec<f64> {
        with_further_ends(times, self.kinks_between(times).into_iter().flat_map(|kinks| kinks.times))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::vector::Vector;
    use crate::body::contact::{Obstacle, Rotation};
    use crate::body::description::{Axis, Contact};
    use crate::body::fem::Material;
    use crate::body::mesh::MeshSource;

    /// Every history has a different kink; a support without displacement has none.
    #[test]
    fn increments_end_at_the_kinks_of_all_histories() {
        let there_and_back = |t: f64| vec![[0.0, 1.0], [t, 2.0], [1.0, 1.0]];
        let obstacle = Obstacle {
            translation: Some(vec![(0.0, Vector::from([0.0, 0.0])), (0.6, Vector::from([1.0, 0.0]))]),
            rotation: Some(Rotation { axis: None, through: Vector::from([0.0, 0.0]), history: there_and_back(0.7) }),
            ..Obstacle::plane(1.0).approaching(&there_and_back(0.5))
        };
        let mut given = Description::new(MeshSource::block([1.0; 2], [1; 2]), Material::new(1.0, 0.3), vec![0.5, 1.0])
            .support("left", &[Axis::X])
            .with_support(Support::new("right", &[Axis::X]).moved(&[1.0]).over(&there_and_back(0.1)))
            .contact("bottom", 0.4, obstacle)
            .load(Load::new("top", &[0.0, -1.0]).over(&there_and_back(0.2)));
        given.supports[0].history = Some(there_and_back(0.9));
        let history = Some(there_and_back(0.3));
        given.contacts = vec![Contact { friction_history: history, ..given.contacts[0].clone() }];
        assert_eq!(given.ends_at_kinks(&given.times), [0.1, 0.2, 0.3, 0.5, 0.6, 0.7, 1.0]);
        assert_eq!(given.ends_at_kinks(&[1.0]), [0.1, 0.2, 0.3, 0.5, 0.6, 0.7, 1.0]);
        let units = UnitSystem::si(2);
        let names: Vec<String> = given.kinks_between(&given.times).iter().map(|kinks| kinks.history(&units)).collect();
        let of_obstacle = ["translation", "rotation"].map(|motion| format!("the {motion} of the obstacle at bottom"));
        assert_eq!(names[..3], ["the load on top", "the support of right", "the friction at bottom"]);
        assert_eq!(names[3..], of_obstacle);
    }
}
