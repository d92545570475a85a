//! Static condensation: the body is eliminated once, an iteration factors what contact leaves free.
//!
//! The matrices of a run, on displacements `u` and other unknowns `q` (contact forces, slacks), are
//!
//! ```text
//! [ K B ] [u]   [b_u]
//! [ A D ] [q] = [b_q]
//! ```
//!
//! where `A`, `B` and `D` reach only the contact displacements `u_c`, and `K`, which is symmetric,
//! never changes. It is factored once with `u_c` last, so that its Schur complement `S` stands in the
//! factors, see [`Cholesky`]. This stiffness form bears slender bodies, where the compliance form
//! `C K⁻¹ Cᵀ` loses half the digits. There remains, with the reduced right-hand side,
//!
//! ```text
//! S u_c + B q = b̃_c        A u_c + D q = b_q.
//! ```
//!
//! Contact rows couple a node's unknowns only to each other. Their solutions (see `local`) are
//! `u_c = P_u b_q + V t`, `q = P_q b_q + Y t + Z s`, where the reactions `s` stand in the equilibrium
//! rows of their own node alone; `Wᵀ` takes the combinations of those rows that are without them:
//!
//! ```text
//! Wᵀ (S V + B Y) t = Wᵀ (b̃_c - (S P_u + B P_q) b_q).
//! ```
//!
//! This dense matrix is all that an iteration factors. Its order is the number of displacements that
//! contact leaves free: two for an open node, one for a slipping one, none for a sticking one, and
//! two for all nodes in an interior point method, where the same elimination serves.
//!
//! The system solved is the whole one, so everything else stays as it is: unknowns, errors,
//! refinement. A body that only contact holds has a singular `K`; then `ρ`, the diagonal of `K`, is
//! added to the contact block and taken off again, `S = L_cc L_ccᵀ - ρ`, which changes nothing else.

use std::sync::Arc;

use faer::Mat;

use super::error::expect_length;
use super::{Cholesky, FactorInfo, LinearError, LinearSolver};
use crate::sparse::Pattern;

mod border;
mod dense;
mod local;

use border::Border;
use dense::Lu;
use local::Local;

/// A solver that condenses to the contact displacements.
pub struct Condensed {
    displacements: usize,
    border: Option<Border>,
    body: Option<Body>,
    contact: Option<Contact>,
}

/// What depends on `K` alone.
struct Body {
    factor: Cholesky,
    /// `S`.
    schur: Mat<f64>,
    /// The diagonal of `K_cc + ρ`: what rounding in `S` is relative to.
    sizes: Vec<f64>,
    /// The values of `K` that it was made of.
    made_of: Vec<f64>,
    pivot_ratio: f64,
}

/// What depends on the contact rows.
struct Contact {
    /// The groups, solved.
    groups: Vec<Local>,
    /// The factors of `Wᵀ (S V + B Y)`.
    lu: Lu,
}

impl Condensed {
    /// A solver for matrices whose first `displacements` unknowns are `u`. Of `K` the lower triangle is
    /// read. It should be the same in all matrices to come: when it changes, everything is done anew.
    pub fn new(displacements: usize) -> Self {
        Condensed { displacements, border: None, body: None, contact: None }
    }

    /// How many unknowns are displacements.
    pub fn displacements(&self) -> usize {
        self.displacements
    }
}

impl Body {
    fn new(border: &Border, values: &[f64]) -> Result<Self, LinearError> {
        let made_of = border.stiffness_values(values);
        let mut k = border.stiffness(made_of.clone());
        let (last, mut shift) = (&border.last, Vec::new());
        let factor = match Cholesky::factor(&k, last) {
            Err(LinearError::Singular { .. }) if !last.is_empty() => {
                let diagonal = k.diagonal();
                shift.extend(last.iter().map(|&unknown| diagonal[unknown]));
                last.iter().zip(&shift).filter(|entry| *entry.1 > 0.0).for_each(|(&i, rho)| k.add(i, i, *rho));
                Cholesky::factor(&k, last)?
            }
            factor => factor?,
        };
        let pivot_ratio = factor.interior_pivot_ratio()?;
        // What moves freely without contact taking part.
        if pivot_ratio <= f64::EPSILON {
            return Err(LinearError::Singular { pivot_ratio });
        }
        let mut schur = dense::square(&factor.trailing(), last.len());
        let diagonal = k.diagonal();
        let sizes = last.iter().map(|&unknown| diagonal[unknown]).collect();
        shift.iter().enumerate().for_each(|(i, rho)| schur[(i, i)] -= rho);
        Ok(Body { factor, schur, sizes, made_of, pivot_ratio })
    }
}

impl Contact {
    fn new(border: &Border, body: &Body, values: &[f64]) -> Result<Self, LinearError> {
        let groups = border.groups.iter().map(|group| group.solve(values)).collect::<Result<Vec<_>, _>>()?;
        let order = groups.iter().map(Local::moving).sum();
        let mut matrix = Mat::zeros(order, order);
        let mut column_of_s_v = vec![0.0; border.last.len()];
        let mut sizes = Vec::with_capacity(order);
        let all = || border.groups.iter().zip(&groups);
        for (k, (group, local)) in all().enumerate() {
            for j in 0..local.moving() {
                let own = local.own(j);
                let mut size = own.iter().fold(0.0_f64, |m, value| m.max(value.abs()));
                column_of_s_v.fill(0.0);
                for (place, factor) in group.displacements.clone().zip(local.motion(j)) {
                    // Most nodes move along an axis.
                    if *factor != 0.0 {
                        let s = body.schur.col_as_slice(place);
                        column_of_s_v.iter_mut().zip(s).for_each(|(sum, s)| *sum += factor * s);
                        size += factor.abs() * body.sizes[place];
                    }
                }
                let to = matrix.col_as_slice_mut(sizes.len());
                let mut row = 0;
                for (i, (group, local)) in all().enumerate() {
                    let to = &mut to[row..row + local.moving()];
                    let sums = local.project(&column_of_s_v[group.displacements.clone()]);
                    to.iter_mut().zip(sums).for_each(|(to, sum)| *to = sum);
                    if i == k {
                        to.iter_mut().zip(&own).for_each(|(to, own)| *to += own);
                    }
                    row += local.moving();
                }
                sizes.push(size);
            }
        }
        Ok(Contact { groups, lu: Lu::new(matrix, &sizes)? })
    }

    /// `u_c` and, in `x`, `q`.
    fn solve(&self, border: &Border, schur: &Mat<f64>, reduced: &[f64], b: &[f64], x: &mut [f64]) -> Vec<f64> {
        let mut u = vec![0.0; border.last.len()];
        let mut rest = reduced.to_vec();
        let all = || border.groups.iter().zip(&self.groups);
        let gather = |x: &[f64], others: &[usize]| others.iter().map(|&unknown| x[unknown]).collect::<Vec<f64>>();
        let scatter = |q: &[f64], others: &[usize], x: &mut [f64]| {
            others.iter().zip(q).for_each(|(&unknown, q)| x[unknown] = *q);
        };
        for (group, local) in all() {
            let mut q = vec![0.0; group.others.len()];
            local.start(&gather(b, &group.others), &mut u[group.displacements.clone()], &mut q);
            local.subtract_forces(&q, &mut rest[group.displacements.clone()]);
            scatter(&q, &group.others, x);
        }
        dense::subtract_product(schur, &u, &mut rest);
        let projected: Vec<f64> =
            all().flat_map(|(group, local)| local.project(&rest[group.displacements.clone()])).collect();
        let t = self.lu.solve(&projected);
        let (mut change, mut t) = (vec![0.0; u.len()], &t[..]);
        for (group, local) in all() {
            let (own, others) = t.split_at(local.moving());
            t = others;
            let mut q = vec![0.0; group.others.len()];
            local.move_by(own, &mut change[group.displacements.clone()], &mut q);
            local.subtract_forces(&q, &mut rest[group.displacements.clone()]);
            group.others.iter().zip(&q).for_each(|(&unknown, q)| x[unknown] += q);
        }
        dense::subtract_product(schur, &change, &mut rest);
        u.iter_mut().zip(&change).for_each(|(u, change)| *u += change);
        for (group, local) in all() {
            let mut q = gather(x, &group.others);
            local.react(&rest[group.displacements.clone()], &mut q);
            scatter(&q, &group.others, x);
        }
        u
    }
}

impl LinearSolver for Condensed {
    fn name(&self) -> &'static str {
        "condensed"
    }

    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<(), LinearError> {
        (self.body, self.contact) = (None, None);
        self.border = Some(Border::new(pattern, self.displacements)?);
        Ok(())
    }

    /// The flops are those of the dense part, with those of the body when it was factored anew.
    fn factorize(&mut self, values: &[f64]) -> Result<FactorInfo, LinearError> {
        let border = self.border.as_ref().ok_or(LinearError::Order { missing: "analyze" })?;
        expect_length("values of the matrix", border.pattern.len(), values.len())?;
        self.contact = None;
        let mut flops = 0.0;
        let body = match self.body.take() {
            Some(body) if border.has_stiffness(values, &body.made_of) => body,
            // The old factors are gone by now: two at a time would double the peak memory.
            _ => {
                let body = Body::new(border, values)?;
                flops += body.factor.info().flops + (border.last.len() as f64).powi(3) / 3.0;
                body
            }
        };
        let body = self.body.insert(body);
        let contact = self.contact.insert(Contact::new(border, body, values)?);
        let (whole, m, k) = (body.factor.info(), border.last.len(), contact.lu.order());
        Ok(FactorInfo {
            entries: whole.entries + m * m + k * k,
            flops: flops + 2.0 / 3.0 * (k as f64).powi(3),
            pivot_ratio: body.pivot_ratio.min(contact.lu.pivot_ratio()),
            peak_bytes: whole.peak_bytes + 8.0 * (m * m + k * k) as f64,
        })
    }

    /// The border first, then the interior (35).
    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        let (Some(border), Some(body), Some(contact)) = (&self.border, &self.body, &self.contact) else {
            return Err(LinearError::Order { missing: "factorize" });
        };
        expect_length("right-hand side", border.pattern.columns(), b.len())?;
        expect_length("solution", border.pattern.columns(), x.len())?;
        let reduced = body.factor.reduce(&b[..self.displacements])?;
        let u_c = contact.solve(border, &body.schur, &reduced.border, b, x);
        body.factor.expand(&reduced, &u_c, &mut x[..self.displacements])
    }
}
