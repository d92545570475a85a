//! Elimination of contact at one node, from the rows of the Newton matrix alone: exact in the oblique form, and without
//! friction. The symmetric form leaves out the coupling of friction to the normal forces.
//!
//! With the displacements `w` and the forces `p` of the node, equilibrium contains `B p`, and the contact rows are
//! `R w + D p = r`. If `D` is singular, a combination of these rows constrains displacements independently of the
//! forces: the normal and the tangents of a sticking node, the normal of a sliding node, the direction across the
//! slip on the edge of the cone. The singular values of `D` find these directions, without statuses and in any frame.
//! Along the other directions the forces follow from the displacements, and act as springs.

use super::small::{Decomposition, ONE, Small, decompose, minus, product, pseudo_inverse, times, transposed};

/// `D` is singular if a value is at most this, in units of the stiffness. In Newton's method it is exactly singular.
/// During an interior point method there are springs instead, and stiffer springs are harder to precondition.
const SINGULAR: f64 = 1e-8;
const NEARLY_SINGULAR: f64 = 1e-4;
/// The relative stiffness above which springs are swept out of the other directions.
const STIFF: f64 = 1.0;
/// A row of displacements is linearly dependent if a decomposition leaves less than this.
const DEPENDENT: f64 = 1e-10;

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

/// One node with its contact eliminated, in mesh directions.
#[derive(Clone, Copy)]
pub(super) struct Eliminated {
    /// The number of directions in which contact constrains the node.
    pub held: usize,
    /// The maps from the right-hand side of the contact rows to the constrained displacements, and to the forces that
    /// follow from them.
    pub prescribed: Small,
    pub given: Small,
    /// The projection of displacements on the unconstrained directions, and the forces that follow from the projection.
    pub free: Small,
    pub following: Small,
    /// The map from equilibrium to the unconstrained directions: the projection, in the oblique form without the
    /// effects of reactions and of stiff springs.
    pub swept: Small,
    /// The terms that the matrix between the unconstrained directions needs: a diagonal in the constrained ones, and in
    /// the symmetric form what makes the springs symmetric.
    pub added: Small,
    /// The map from the equilibrium residual in the constrained directions to the forces.
    pub reactions: Small,
}

impl Local {
    /// Eliminates contact, in the `oblique` form with friction, so that the matrix of the rest is unsymmetric.
    pub(super) fn eliminated(&self, oblique: bool) -> Eliminated {
        let negligible = if oblique { NEARLY_SINGULAR } else { SINGULAR };
        // Rows of size one, and forces in units of the stiffness.
        let k = if self.stiffness > 0.0 { self.stiffness } else { 1.0 };
        let sizes = [0, 1, 2].map(|i| {
            let size = (0..3).fold(0.0_f64, |size, j| size.hypot(self.r[i][j]).hypot(self.d[i][j] * k));
            if size > 0.0 { size } else { 1.0 }
        });
        let r = [0, 1, 2].map(|i| self.r[i].map(|v| v / sizes[i]));
        let mut d = [0, 1, 2].map(|i| self.d[i].map(|v| v * k / sizes[i]));
        (0..3).filter(|&i| !self.forces[i]).for_each(|i| d[i][i] = 1.0);
        let unscaled = |m: Small, factor: f64| m.map(|row| [0, 1, 2].map(|j| row[j] * factor / sizes[j]));
        let law = decompose(&d);
        let singular = law.values.map(|s| s <= negligible);
        let compliance = unscaled(law.inverse(negligible), k);
        // The combinations of rows without forces, and the forces that the rows leave undetermined.
        let free_rows = masked_columns(&decompose(&transposed(&d)).right, singular);
        let untold = masked_columns(&law.right, singular);
        let constraints = decompose(&times(&transposed(&free_rows), &r));
        let held = constraints.values.map(|strength| strength > DEPENDENT);
        let prescribed = unscaled(times(&constraints.inverse(DEPENDENT), &transposed(&free_rows)), 1.0);
        let constrained = masked_columns(&constraints.right, held);
        let on_constrained = times(&constrained, &transposed(&constrained));
        let free = minus(&ONE, &on_constrained);
        let by_untold = times(&self.b, &untold);
        let inverse = pseudo_inverse(&times(&on_constrained, &by_untold), DEPENDENT);
        let reactions = product(&[&untold, &inverse, &on_constrained]);
        let springs = product(&[&self.b, &compliance, &self.r]).map(|row| row.map(|v| -v));
        let diagonal = on_constrained.map(|row| row.map(|v| k * v));
        let (swept, added) = if oblique {
            let coupling = product(&[&free, &by_untold, &inverse, &on_constrained]);
            let present = [0, 1, 2].map(|i| [0, 1, 2].map(|j| if self.directions[j] { free[i][j] } else { 0.0 }));
            let sweep = times(&self.stiff_sweep(&springs), &present);
            let swept = times(&free, &minus(&minus(&ONE, &coupling), &sweep));
            (swept, diagonal)
        } else {
            let skew = [0, 1, 2].map(|i| [0, 1, 2].map(|j| 0.5 * (springs[j][i] - springs[i][j])));
            let skew = product(&[&free, &skew, &free]);
            (free, [0, 1, 2].map(|i| [0, 1, 2].map(|j| diagonal[i][j] + skew[i][j])))
        };
        let forced = times(&compliance, &self.r);
        Eliminated {
            held: held.into_iter().filter(|held| *held).count(),
            given: minus(&compliance, &times(&forced, &prescribed)),
            prescribed,
            free,
            following: times(&forced, &free).map(|row| row.map(|v| -v)),
            swept,
            added,
            reactions,
        }
    }

    /// Returns the sweep for stiff springs `U S Vᵀ`, which keeps their rows along `V` and removes their effect
    /// across: `(1 - V Vᵀ) U (Vᵀ U)⁻¹ Vᵀ`.
    fn stiff_sweep(&self, springs: &Small) -> Small {
        let Decomposition { left, values, right } = decompose(springs);
        let stiff = values.map(|s| s > STIFF * self.stiffness);
        let (u, v) = (masked_columns(&left, stiff), masked_columns(&right, stiff));
        let along = times(&transposed(&v), &u);
        let through = product(&[&u, &pseudo_inverse(&along, DEPENDENT), &transposed(&v)]);
        minus(&through, &product(&[&v, &transposed(&v), &through]))
    }
}

fn masked_columns(m: &Small, keep: [bool; 3]) -> Small {
    m.map(|row| [0, 1, 2].map(|k| if keep[k] { row[k] } else { 0.0 }))
}

#[cfg(test)]
mod tests {
    use super::super::small::{ZERO, on};
    use super::*;

    const NORMAL: [f64; 3] = [0.0, -1.0, 0.0];
    const TANGENT: [f64; 3] = [1.0, 0.0, 0.0];

    /// Creates a node in the plane above an obstacle, with its rows `(p_t, p_n)` of the laws.
    fn local(r: [[f64; 2]; 2], d: [[f64; 2]; 2]) -> Local {
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
        local
    }

    fn node(r: [[f64; 2]; 2], d: [[f64; 2]; 2]) -> Eliminated {
        local(r, d).eliminated(false)
    }

    #[test]
    fn an_open_node_keeps_its_forces() {
        let open = node([[0.0; 2]; 2], [[1.0, 0.0], [0.0, 1.0]]);
        assert_eq!(open.held, 0);
        assert_eq!(on(&open.given, [3.0, -4.0, 0.0]), [3.0, -4.0, 0.0]);
    }

    #[test]
    fn a_node_that_sticks_is_held_and_its_reactions_are_what_lacks() {
        let stick = node([[1.0, 0.0], [0.0, 1.0]], [[0.0; 2]; 2]);
        assert_eq!(stick.held, 2);
        // The direction that the node does not have is left alone.
        assert_eq!(on(&stick.free, [1.0, 1.0, 1.0]), [0.0, 0.0, 1.0]);
        let w = on(&stick.prescribed, [0.25, 0.5, 0.0]);
        assert!((w[0] - 0.25).abs() < 1e-15 && (w[1] + 0.5).abs() < 1e-15, "{w:?}");
        let p = on(&stick.reactions, [2.0, -3.0, 0.0]);
        assert!((p[0] - 2.0).abs() < 1e-15 && (p[1] - 3.0).abs() < 1e-15, "{p:?}");
    }

    #[test]
    fn one_that_slides_is_held_along_its_normal_and_its_friction_follows() {
        // p_t + 0.4 p_n = r_t, w_n = r_n.
        let slip = [[0.0, 0.0], [0.0, 1.0]];
        let law = [[1.0, 0.4], [0.0, 0.0]];
        let (slip, oblique) = (node(slip, law), local(slip, law).eliminated(true));
        assert_eq!(slip.held, 1);
        let (given, reaction) = (on(&slip.given, [0.0, 0.5, 0.0]), on(&slip.reactions, [0.0, -3.0, 0.0]));
        let p = [given[0] + reaction[0], given[1] + reaction[1]];
        assert!((p[1] - 3.0).abs() < 1e-14 && (p[0] + 0.4 * p[1]).abs() < 1e-14, "{p:?}");
        // The effect of the reaction along the slip, from the residual along the normal.
        assert!((oblique.swept[0][1].abs() - 0.4).abs() < 1e-14, "{:?}", oblique.swept);
        assert!(slip.following.iter().flatten().all(|v| v.abs() < 1e-14));
    }

    #[test]
    fn a_compliant_contact_is_a_spring() {
        // p_n = 5 w_n, no friction.
        let law = local([[0.0, 0.0], [0.0, -5.0]], [[1.0, 0.0], [0.0, 1.0]]);
        let compliant = law.eliminated(false);
        assert_eq!(compliant.held, 0);
        let springs = times(&law.b, &compliant.following);
        assert!((springs[1][1] - 5.0).abs() < 1e-14 && springs[0][0].abs() < 1e-14, "{springs:?}");
    }
}
