//! Exact elimination of contact at one node, from the rows of the Newton matrix alone.
//!
//! With the displacements `w` and the forces `p` of the node, equilibrium contains `B p`, and the contact rows are
//! `R w + D p = r`. If `D` is singular, a combination of these rows constrains displacements independently of the
//! forces: the normal and the tangents of a sticking node, the normal of a sliding node, the direction across the
//! slip on the edge of the cone. The singular values of `D` find these directions, without statuses and in any frame.
//! Along the other directions the forces follow from the displacements, and act as springs.

use super::form::Form;
use super::small::{Decomposition, Small, decompose, on, pseudo_inverse, times, transposed, transposed_on};

/// `D` is singular if a value is at most this, in units of the stiffness. In Newton's method it is exactly singular.
/// During an interior point method there are springs instead, and stiffer springs are harder to precondition.
const SINGULAR: f64 = 1e-8;
const NEARLY_SINGULAR: f64 = 1e-4;
/// The relative stiffness above which springs are swept out of the other directions.
const STIFF: f64 = 1.0;
/// A row of displacements is linearly dependent if a decomposition leaves less than this.
const DEPENDENT: f64 = 1e-10;

/// The number of words that represent a node in messages to another rank.
pub(super) const WORDS: usize = 33;

/// The rows and columns of one contact node. Missing entries are 0.
#[derive(Clone, Copy)]
pub(super) struct Local {
    /// The effect of the forces on equilibrium: a row for each direction.
    pub b: Small,
    /// The coefficients of the displacements in the rows of the contact laws.
    pub r: Small,
    /// The coefficients of the forces in these rows.
    pub d: Small,
    /// `true` for the directions that the node has; `forces` for the forces.
    pub directions: [bool; 3],
    pub forces: [bool; 3],
    /// The largest of the node's entries on the diagonal of `K`.
    pub stiffness: f64,
}

/// One node with its contact eliminated.
#[derive(Clone, Copy)]
pub(crate) struct Eliminated {
    /// The frame: its columns are directions, the constrained ones first.
    pub frame: Small,
    pub held: [bool; 3],
    /// `true` for directions of the frame that supports have removed.
    pub missing: [bool; 3],
    /// The effect of forces on equilibrium; `r` that of displacements on the laws, both in the frame.
    b: Small,
    r: Small,
    /// The map from the right-hand side of the rows to the constrained displacements.
    prescribed: Small,
    /// `D⁺`.
    compliance: Small,
    /// The map from the equilibrium residual in the constrained directions to the forces.
    reactions: Small,
    /// The terms that the oblique form sweeps out of the unconstrained rows: effects of reactions, and of stiff
    /// springs.
    pub sweep: Small,
    /// The stiffness of the forces that follow the displacements, in the frame: `-B D⁺ R`.
    pub springs: Small,
}

impl Local {
    pub(super) fn eliminated(&self, form: Form) -> Eliminated {
        let negligible = if form == Form::Oblique { NEARLY_SINGULAR } else { SINGULAR };
        let mut law = self.scaled();
        for k in (0..3).filter(|&k| !self.forces[k]) {
            law.d[k][k] = 1.0;
        }
        let Decomposition { left, values, right } = decompose(&law.d);
        let singular = values.map(|s| s <= negligible);
        let compliance = {
            let inverse = [0, 1, 2].map(|k| if singular[k] { 0.0 } else { 1.0 / values[k] });
            let by_value = right.map(|row| [0, 1, 2].map(|k| row[k] * inverse[k]));
            let d = times(&by_value, &transposed(&left));
            [0, 1, 2].map(|i| [0, 1, 2].map(|j| d[i][j] * law.force / law.rows[j]))
        };
        // The combinations of rows without forces, and the forces that the rows leave undetermined.
        let free_rows = masked_columns(&decompose(&transposed(&law.d)).right, singular);
        let untold = masked_columns(&right, singular);
        let constraints = times(&transposed(&law.r), &free_rows);
        let Decomposition { left: combined, values: strength, right: basis } = decompose(&transposed(&constraints));
        let independent = [0, 1, 2].map(|k| strength[k] > DEPENDENT);
        let (frame, held, missing) = self.frame(&basis, independent);
        let by_rows = times(&transposed(&combined), &transposed(&free_rows));
        let prescribed = [0, 1, 2].map(|k| {
            let factor = |j: usize| if independent[k] { by_rows[k][j] / (strength[k] * law.rows[j]) } else { 0.0 };
            [0, 1, 2].map(factor)
        });
        let (b, r) = (times(&transposed(&frame), &self.b), times(&self.r, &frame));
        let by_untold = times(&b, &untold);
        let part = |mask: [bool; 3]| [0, 1, 2].map(|i| if mask[i] { by_untold[i] } else { [0.0; 3] });
        let inverse = pseudo_inverse(&part(held), DEPENDENT);
        let reactions = times(&untold, &inverse);
        let coupling = times(&part(held.map(|held| !held)), &inverse);
        let springs = times(&times(&b, &compliance), &r).map(|row| row.map(|v| -v));
        let free = [0, 1, 2].map(|k| !held[k] && !missing[k]);
        let stiff = masked_columns(&self.stiff_sweep(&springs), free);
        let sweep = [0, 1, 2].map(|i| [0, 1, 2].map(|j| coupling[i][j] + stiff[i][j]));
        Eliminated { frame, held, missing, b, r, prescribed, compliance, reactions, sweep, springs }
    }

    /// Returns the sweep for stiff springs `U S Vᵀ`, which keeps their rows along `V` and removes their effect
    /// across: `(1 - V Vᵀ) U (Vᵀ U)⁻¹ Vᵀ`.
    fn stiff_sweep(&self, springs: &Small) -> Small {
        let Decomposition { left, values, right } = decompose(springs);
        let stiff = values.map(|s| s > STIFF * self.stiffness);
        let (u, v) = (masked_columns(&left, stiff), masked_columns(&right, stiff));
        let along = times(&transposed(&v), &u);
        let through = times(&times(&u, &pseudo_inverse(&along, DEPENDENT)), &transposed(&v));
        let back = times(&times(&v, &transposed(&v)), &through);
        [0, 1, 2].map(|i| [0, 1, 2].map(|j| through[i][j] - back[i][j]))
    }

    /// Returns the laws with rows of size one and forces in units of the stiffness.
    fn scaled(&self) -> ScaledNode {
        let force = if self.stiffness > 0.0 { self.stiffness } else { 1.0 };
        let rows = [0, 1, 2].map(|i| {
            let size = (0..3).fold(0.0_f64, |size, j| size.hypot(self.r[i][j]).hypot(self.d[i][j] * force));
            if size > 0.0 { size } else { 1.0 }
        });
        let by = |m: &Small, factor: f64| [0, 1, 2].map(|i| m[i].map(|v| v * factor / rows[i]));
        ScaledNode { r: by(&self.r, 1.0), d: by(&self.d, force), rows, force }
    }

    /// Returns the frame: the constrained directions of a `basis`, then the rest of the mesh axes, then the
    /// directions that the node does not have.
    fn frame(&self, basis: &Small, independent: [bool; 3]) -> (Small, [bool; 3], [bool; 3]) {
        let mut columns: Vec<[f64; 3]> = (0..3).filter(|&k| independent[k]).map(|k| basis.map(|row| row[k])).collect();
        let held = columns.len();
        let present = self.directions.iter().filter(|there| **there).count();
        while columns.len() < present {
            let rest = |axis: usize| {
                let mut e = [0.0; 3];
                e[axis] = 1.0;
                for _ in 0..2 {
                    for column in &columns {
                        let share: f64 = (0..3).map(|i| column[i] * e[i]).sum();
                        (0..3).for_each(|i| e[i] -= share * column[i]);
                    }
                }
                e
            };
            let size = |v: &[f64; 3]| v.iter().fold(0.0_f64, |size, v| size.hypot(*v));
            let rests = (0..3).filter(|&axis| self.directions[axis]).map(rest);
            let Some(largest) = rests.max_by(|a, b| size(a).total_cmp(&size(b))) else { break };
            columns.push(largest.map(|v| v / size(&largest)));
        }
        let missing: Vec<usize> = (0..3).filter(|&axis| !self.directions[axis]).collect();
        columns.extend(missing.iter().map(|&axis| [0, 1, 2].map(|i| f64::from(u8::from(i == axis)))));
        let frame = [0, 1, 2].map(|i| [0, 1, 2].map(|k| columns[k][i]));
        (frame, [0, 1, 2].map(|k| k < held), [0, 1, 2].map(|k| k >= present))
    }
}

struct ScaledNode {
    r: Small,
    d: Small,
    rows: [f64; 3],
    force: f64,
}

impl Eliminated {
    /// Returns the constrained displacements, in the frame.
    pub(super) fn prescribed(&self, rows: [f64; 3]) -> [f64; 3] {
        on(&self.prescribed, rows)
    }

    /// Returns the forces that follow the displacements `w` in the frame.
    pub(super) fn following(&self, rows: [f64; 3], w: [f64; 3]) -> [f64; 3] {
        let by_w = on(&self.r, w);
        on(&self.compliance, [0, 1, 2].map(|k| rows[k] - by_w[k]))
    }

    /// Returns the effect of forces on equilibrium, in the frame.
    pub(super) fn on_equilibrium(&self, p: [f64; 3]) -> [f64; 3] {
        on(&self.b, p)
    }

    /// Returns the forces that balance the equilibrium residual in the constrained directions.
    pub(super) fn reactions(&self, lacking: [f64; 3]) -> [f64; 3] {
        on(&self.reactions, [0, 1, 2].map(|k| if self.held[k] { lacking[k] } else { 0.0 }))
    }

    /// Rotates a vector into the frame.
    pub(super) fn in_frame(&self, v: [f64; 3]) -> [f64; 3] {
        transposed_on(&self.frame, v)
    }

    /// Rotates a vector from the frame into mesh directions.
    pub(super) fn out_of_frame(&self, v: [f64; 3]) -> [f64; 3] {
        on(&self.frame, v)
    }

    /// Returns the data that a rank needs for its rows of `K̂`.
    pub(super) fn words(&self) -> [i64; WORDS] {
        let flags = [self.held, self.missing].map(|flags| flags.map(|flag| f64::from(u8::from(flag))));
        let numbers = [self.frame, self.sweep, self.springs].into_iter().flatten().chain(flags).flatten();
        let mut words = [0; WORDS];
        words.iter_mut().zip(numbers).for_each(|(word, number)| *word = number.to_bits() as i64);
        words
    }

    /// Creates a node from these data alone.
    pub(super) fn of_words(words: &[i64; WORDS]) -> Self {
        let number = |k: usize| f64::from_bits(words[k] as u64);
        let matrix = |from: usize| [0, 1, 2].map(|i| [0, 1, 2].map(|j| number(from + 3 * i + j)));
        let flags = |from: usize| [0, 1, 2].map(|k| number(from + k) != 0.0);
        let zero = [[0.0; 3]; 3];
        Eliminated {
            frame: matrix(0),
            held: flags(27),
            missing: flags(30),
            b: zero,
            r: zero,
            prescribed: zero,
            compliance: zero,
            reactions: zero,
            sweep: matrix(9),
            springs: matrix(18),
        }
    }

    /// Returns `true` for the directions of the frame that are not solved for.
    pub(super) fn gone(&self) -> [bool; 3] {
        [0, 1, 2].map(|k| self.held[k] || self.missing[k])
    }
}

fn masked_columns(m: &Small, keep: [bool; 3]) -> Small {
    m.map(|row| [0, 1, 2].map(|k| if keep[k] { row[k] } else { 0.0 }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multigrid::small::ZERO;

    const NORMAL: [f64; 3] = [0.0, -1.0, 0.0];
    const TANGENT: [f64; 3] = [1.0, 0.0, 0.0];

    /// Creates a node in the plane above an obstacle, with its rows `(p_t, p_n)` of the laws.
    fn node(r: [[f64; 2]; 2], d: [[f64; 2]; 2]) -> Eliminated {
        let mut local = Local {
            b: ZERO,
            r: ZERO,
            d: ZERO,
            directions: [true, true, false],
            forces: [true, true, false],
            stiffness: 2.0,
        };
        for (b, (t, n)) in local.b.iter_mut().zip(TANGENT.iter().zip(NORMAL)) {
            (b[0], b[1]) = (*t, n);
        }
        for (row, [along, across]) in r.into_iter().enumerate() {
            local.r[row] = [0, 1, 2].map(|i| along * TANGENT[i] + across * NORMAL[i]);
            local.d[row][..2].copy_from_slice(&d[row]);
        }
        local.eliminated(Form::Symmetric)
    }

    #[test]
    fn what_is_told_of_a_node_is_what_makes_its_rows() {
        let slip = node([[0.0, 0.0], [0.0, 1.0]], [[1.0, 0.4], [0.0, 0.0]]);
        let told = Eliminated::of_words(&slip.words());
        assert_eq!((told.frame, told.gone(), told.held), (slip.frame, slip.gone(), slip.held));
        assert_eq!((told.sweep, told.springs), (slip.sweep, slip.springs));
    }

    #[test]
    fn an_open_node_keeps_its_forces() {
        let open = node([[0.0; 2]; 2], [[1.0, 0.0], [0.0, 1.0]]);
        assert_eq!(open.held, [false; 3]);
        assert_eq!(open.following([3.0, -4.0, 0.0], [0.0; 3]), [3.0, -4.0, 0.0]);
    }

    #[test]
    fn a_node_that_sticks_is_held_and_its_reactions_are_what_lacks() {
        let stick = node([[1.0, 0.0], [0.0, 1.0]], [[0.0; 2]; 2]);
        assert_eq!((stick.held, stick.missing), ([true, true, false], [false, false, true]));
        let w = stick.out_of_frame(stick.prescribed([0.25, 0.5, 0.0]));
        assert!((w[0] - 0.25).abs() < 1e-15 && (w[1] + 0.5).abs() < 1e-15, "{w:?}");
        let p = stick.reactions(stick.in_frame([2.0, -3.0, 0.0]));
        assert!((p[0] - 2.0).abs() < 1e-15 && (p[1] - 3.0).abs() < 1e-15, "{p:?}");
    }

    #[test]
    fn one_that_slides_is_held_along_its_normal_and_its_friction_follows() {
        // p_t + 0.4 p_n = r_t, w_n = r_n.
        let slip = node([[0.0, 0.0], [0.0, 1.0]], [[1.0, 0.4], [0.0, 0.0]]);
        assert_eq!(slip.held, [true, false, false]);
        let w = slip.prescribed([0.0, 0.5, 0.0]);
        let lacking = slip.in_frame([0.0, -3.0, 0.0]);
        let q = slip.reactions(lacking);
        let p = slip.following([0.0, 0.5, 0.0], w);
        let p = [p[0] + q[0], p[1] + q[1]];
        assert!((p[1] - 3.0).abs() < 1e-14 && (p[0] + 0.4 * p[1]).abs() < 1e-14, "{p:?}");
        // The effect of the reaction along the slip, from the residual along the normal.
        let down = slip.in_frame([0.0, -1.0, 0.0])[0];
        assert!(((slip.sweep[1][0] * down).abs() - 0.4).abs() < 1e-14);
        assert!(slip.springs.iter().flatten().all(|v| v.abs() < 1e-14));
    }

    #[test]
    fn a_compliant_contact_is_a_spring() {
        // p_n = 5 w_n, no friction.
        let compliant = node([[0.0, 0.0], [0.0, -5.0]], [[1.0, 0.0], [0.0, 1.0]]);
        assert_eq!(compliant.held, [false; 3]);
        let physical = times(&times(&compliant.frame, &compliant.springs), &transposed(&compliant.frame));
        assert!((physical[1][1] - 5.0).abs() < 1e-14 && physical[0][0].abs() < 1e-14, "{physical:?}");
    }
}
