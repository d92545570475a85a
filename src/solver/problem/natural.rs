//! The natural units of a problem: what the error measure compares forces and motions with, whatever units single
//! unknowns and rows have.

use super::ContactProblem;
use super::contact_stiffness::contact_stiffness;
use crate::algebra::linear::Stiffness;
use crate::algebra::union_find::UnionFind;

/// The parts of the bodies that elasticity or contact connects, and the units of displacements and contact nodes.
///
/// With `√K_ii` as the unit of the forces on displacement `i`, and `√k_i` as that of the forces on contact node `i`,
/// where `k_i` is [`ContactProblem::contact_stiffness`], all forces are in `√J`. They do not change if an unknown or a
/// row of `C` is scaled.
#[derive(Debug, Clone)]
pub(crate) struct NaturalUnits {
    /// The part of each displacement.
    pub part: Vec<usize>,
    /// The part of each contact node.
    pub contact_part: Vec<usize>,
    /// The number of parts.
    pub parts: usize,
    /// `√K_ii`, or the largest of the part where `K_ii` is 0.
    pub displacement: Vec<f64>,
    /// `√k_i`.
    pub contact: Vec<f64>,
    /// `k_i`, N/m.
    pub contact_stiffness: Vec<f64>,
    /// The compliances of dependent contact nodes along normal and tangents in the proximal point method, m/N.
    pub compliance: Vec<[f64; 2]>,
}

impl NaturalUnits {
    pub(super) fn of(problem: &ContactProblem) -> Self {
        let mut sets = UnionFind::new(problem.displacements());
        match problem.stiffness() {
            Stiffness::Assembled(stiffness) => {
                let connected = stiffness.lower_entries().filter(|(.., value)| *value != 0.0);
                connected.for_each(|(row, column, _)| sets.join(row, column));
            }
            // No process sees all entries, so the whole is one part.
            Stiffness::Distributed(_) => (1..problem.displacements()).for_each(|dof| sets.join(0, dof)),
        }
        let row_of = |i: usize| [problem.c_n(), problem.c_t(), problem.c_o()].into_iter().flat_map(move |c| c.row(i));
        for i in 0..problem.contacts() {
            let mut row = row_of(i).map(|(dof, _)| *dof);
            if let Some(first) = row.next() {
                row.for_each(|dof| sets.join(first, dof));
            }
        }
        let (mut part, mut parts) = (vec![0; problem.displacements()], 0);
        for dof in 0..part.len() {
            let least = sets.least(dof);
            part[dof] = if least == dof { parts } else { part[least] };
            parts += usize::from(least == dof);
        }
        let contact_part = (0..problem.contacts()).map(|i| {
            row_of(i).next().map_or_else(
                || {
                    parts += 1;
                    parts - 1
                },
                |(dof, _)| part[*dof],
            )
        });
        let contact_part = contact_part.collect();
        let displacement = units(&problem.stiffness().diagonal(), &part, parts);
        let contact_stiffness = contact_stiffness(problem);
        let contact = contact_stiffness.iter().map(|k| k.sqrt()).collect();
        let compliance = problem.proximal_compliance(&contact_stiffness);
        NaturalUnits { part, contact_part, parts, displacement, contact, contact_stiffness, compliance }
    }

    /// Returns the units of the problem on some contact `nodes`.
    pub(super) fn of_nodes(&self, nodes: &[usize]) -> Self {
        let of_nodes = |values: &[f64]| nodes.iter().map(|&i| values[i]).collect();
        NaturalUnits {
            contact_part: nodes.iter().map(|&i| self.contact_part[i]).collect(),
            contact: of_nodes(&self.contact),
            contact_stiffness: of_nodes(&self.contact_stiffness),
            compliance: nodes.iter().map(|&i| self.compliance[i]).collect(),
            ..self.clone()
        }
    }

    /// Returns the units of a problem condensed on the displacements `kept`, with the `diagonal` of its stiffness.
    pub(crate) fn condensed(&self, kept: &[usize], diagonal: &[f64]) -> Self {
        let part: Vec<usize> = kept.iter().map(|&dof| self.part[dof]).collect();
        NaturalUnits { displacement: units(diagonal, &part, self.parts), part, ..self.clone() }
    }
}

/// Returns the square roots of the `diagonal`, or the largest of the part where it is 0.
fn units(diagonal: &[f64], part: &[usize], parts: usize) -> Vec<f64> {
    let mut units: Vec<f64> = diagonal.iter().map(|k| k.max(0.0).sqrt()).collect();
    let mut largest = vec![0.0_f64; parts];
    part.iter().zip(&units).for_each(|(&part, unit)| largest[part] = largest[part].max(*unit));
    for (unit, &part) in units.iter_mut().zip(part).filter(|(unit, _)| **unit == 0.0) {
        *unit = if largest[part] > 0.0 { largest[part] } else { 1.0 };
    }
    units
}
