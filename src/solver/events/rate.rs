//! The rate problem: the next statuses where the laws allow several.
//!
//! If a node is on the border of a law, its rates obey complementarity: a grazing node has `w_n' ≤ g'`, `p_n' ≥ 0`
//! and Coulomb's law for both rates; a node on the border of its cone has `sign w_t' ≥ 0`, `sign p_t' ≤ μ p_n'`.
//! Statuses are guessed and corrected where their rates break a law, all at once as in Newton's method. This usually
//! takes one or two solves. If statuses repeat, nodes are changed one by one. If this fails, Lemke's method treats
//! all of them together. If Lemke's method ends on a ray and the nodes are few, all their statuses are tried, so that
//! the absence of a continuation is proved.

use super::complementarity::Unknowns;
use super::node::{AdmissibleTransition, NodeStatus};
use super::rate_problem::{Breach, RATE_ROUNDING, RateSearch, largest_breach};
use crate::algebra::linear::Computed;

/// The largest relative breach that is accepted if no better statuses are found: a rate problem that is nearly
/// singular.
const ACCEPTED: f64 = 1e-9;

/// The number of solves with all nodes changed at once, then the number of solves for each node, one by one.
const TOGETHER: usize = 12;
const EACH: usize = 4;

/// The largest number of nodes whose statuses are all tried: 4^5 = 1024 solves.
const FEW: usize = 5;

/// The result of trying all statuses.
enum Tried {
    /// Some statuses obey all laws.
    Found,
    /// No statuses obey the laws, and all were regular.
    AllRegular,
    /// No regular statuses obey the laws. Singular ones may have rates, but not unique ones.
    SomeSingular,
}

/// The result of the search for rates.
pub(super) enum Found {
    /// Statuses were found whose rates obey all laws.
    Rates,
    /// It is certain that there are none: all statuses of the nodes concerned were tried, and all were regular.
    None,
    /// None were found, and it is not certain that there are none.
    Nothing,
}

impl RateSearch<'_> {
    /// Finds `statuses` and their rates, starting from a guess.
    pub(super) fn solve(&mut self, statuses: &mut Vec<NodeStatus>) -> Computed<Found> {
        if self.by_correction(statuses)? {
            return Ok(Found::Rates);
        }
        let concerned: Vec<usize> =
            (0..self.problem.may.len()).filter(|&i| self.problem.may[i] != AdmissibleTransition::Stay).collect();
        for unknowns in [Unknowns::Forces, Unknowns::Motions] {
            let Some(found) = self.by_lemke(unknowns, statuses, &concerned)? else { continue };
            let size = self.try_out(&found)?;
            self.keep(size, &found);
            let mut settled = found;
            if size.is_some_and(|size| size <= RATE_ROUNDING) || self.by_correction(&mut settled)? {
                self.effort.lemke += 1;
                *statuses = settled;
                return Ok(Found::Rates);
            }
        }
        let mut all_tried = false;
        if concerned.len() <= FEW {
            self.effort.enumerated += 1;
            match self.by_enumeration(statuses, &concerned)? {
                Tried::Found => return Ok(Found::Rates),
                Tried::AllRegular => all_tried = true,
                Tried::SomeSingular => {}
            }
        }
        match self.best.take() {
            Some((size, found)) if size <= ACCEPTED => {
                self.try_out(&found)?;
                *statuses = found;
                Ok(Found::Rates)
            }
            _ if all_tried => Ok(Found::None),
            _ => Ok(Found::Nothing),
        }
    }

    /// Corrects statuses whose rates break a law: all at once, then one by one if this cycles.
    fn by_correction(&mut self, statuses: &mut [NodeStatus]) -> Computed<bool> {
        let concerned = self.problem.may.iter().filter(|may| **may != AdmissibleTransition::Stay).count();
        let mut visited: Vec<Vec<NodeStatus>> = Vec::new();
        let mut tried = vec![[0_usize; 4]; statuses.len()];
        let mut one_by_one = false;
        for turn in 0..TOGETHER + EACH * concerned {
            if !self.rates(statuses)? {
                return Ok(false);
            }
            let breaches = self.problem.breaches(statuses, self.rate);
            self.keep(Some(largest_breach(&breaches)), statuses);
            if breaches.is_empty() {
                return Ok(true);
            }
            if !one_by_one && (turn >= TOGETHER || visited.iter().any(|before| before == statuses)) {
                one_by_one = true;
                self.effort.one_by_one += 1;
            }
            if !one_by_one {
                visited.push(statuses.to_vec());
                for breach in &breaches {
                    statuses[breach.node] = breach.to;
                }
                continue;
            }
            let worst = breaches.iter().max_by(|a, b| a.size.total_cmp(&b.size));
            let Some(Breach { node, to, .. }) = worst else { return Ok(true) };
            // A grazing node may skip the correct status in a cycle, so each status is tried in turn.
            let next = if self.problem.may[*node] == AdmissibleTransition::Anything && self.problem.has_friction[*node]
            {
                tried[*node][index(statuses[*node])] += 1;
                let others = ALL.into_iter().filter(|status| *status != statuses[*node]);
                others.min_by_key(|status| (tried[*node][index(*status)], *status != *to)).unwrap_or(*to)
            } else {
                *to
            };
            statuses[*node] = next;
        }
        Ok(false)
    }

    /// Tries all statuses of the nodes `concerned`.
    fn by_enumeration(&mut self, statuses: &mut [NodeStatus], concerned: &[usize]) -> Computed<Tried> {
        let choices: Vec<Vec<NodeStatus>> = concerned.iter().map(|&i| self.choices(i)).collect();
        let all = choices.iter().map(Vec::len).product::<usize>();
        let before = statuses.to_vec();
        let mut tried = Tried::AllRegular;
        for mut number in 0..all {
            for (&i, choices) in concerned.iter().zip(&choices) {
                statuses[i] = choices[number % choices.len()];
                number /= choices.len();
            }
            let size = self.try_out(statuses)?;
            self.keep(size, statuses);
            match size {
                Some(size) if size <= RATE_ROUNDING => return Ok(Tried::Found),
                Some(_) => {}
                None => tried = Tried::SomeSingular,
            }
        }
        statuses.copy_from_slice(&before);
        Ok(tried)
    }

    /// Returns the admissible statuses of node `i`.
    fn choices(&self, i: usize) -> Vec<NodeStatus> {
        match self.problem.may[i] {
            AdmissibleTransition::Turn(sign) => vec![NodeStatus::Stick, NodeStatus::slip(sign)],
            _ if self.problem.has_friction[i] => ALL.to_vec(),
            _ => vec![NodeStatus::Forward, NodeStatus::Open],
        }
    }
}

const ALL: [NodeStatus; 4] = [NodeStatus::Stick, NodeStatus::Forward, NodeStatus::Backward, NodeStatus::Open];

fn index(status: NodeStatus) -> usize {
    ALL.iter().position(|other| *other == status).unwrap_or(0)
}
