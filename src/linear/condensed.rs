//! Static condensation: unknowns whose part of the matrix never changes are eliminated once.
//!
//! With interior unknowns `r` and the others `c`, as in (33)–(35),
//!
//! ```text
//! A = [ A_rr A_rc ]      B = A_cc - A_cr A_rr⁻¹ A_rc
//!     [ A_cr A_cc ]
//! ```
//!
//! `A_rr` is factored and the correction of `A_cc` formed when they are first met or have changed;
//! afterwards a factorisation is that of the small, mostly dense `B`. The system solved is the whole
//! one, so everything else stays as it is: unknowns, errors, refinement.

use std::sync::Arc;

use super::{FactorInfo, LinearError, LinearSolver, Umfpack};
use crate::sparse::{Csc, Pattern};

/// A solver that condenses the interior unknowns away.
pub struct Condensed {
    interior: Vec<usize>,
    blocks: Option<Blocks>,
    factored: Option<Interior>,
    border: Umfpack,
}

/// Where the entries of `A` go.
struct Blocks {
    pattern: Arc<Pattern>,
    /// For each unknown: interior or not, and its place among those.
    place: Vec<(bool, usize)>,
    /// The block `A_rr`, and the slots of `A` its values come from.
    rr: (Csc, Vec<usize>),
    /// `A_rc` and `A_cr` as (row, column, slot in `A`), with places for rows and columns.
    rc: Vec<(usize, usize, usize)>,
    cr: Vec<(usize, usize, usize)>,
    /// `B` on its pattern, and the (slot in `B`, slot in `A`) of `A_cc`.
    b: Csc,
    cc: Vec<(usize, usize)>,
}

/// What depends on the interior values alone.
struct Interior {
    solver: Umfpack,
    /// The values of `A_rr`, `A_rc` and `A_cr` that it was made of.
    made_of: Vec<f64>,
    /// `A_cr A_rr⁻¹ A_rc` as (slot in `B`, value).
    correction: Vec<(usize, f64)>,
    info: FactorInfo,
}

impl Condensed {
    /// A solver that eliminates the unknowns `interior` first. Their rows and columns should be the
    /// same in all matrices to come: when they change, everything is done anew.
    pub fn new(interior: Vec<usize>) -> Self {
        Condensed { interior, blocks: None, factored: None, border: Umfpack::default() }
    }
}

impl Blocks {
    fn new(pattern: &Arc<Pattern>, interior: &[usize]) -> Self {
        let n = pattern.columns();
        let mut place = vec![(false, 0); n];
        for &k in interior {
            place[k].0 = true;
        }
        let (mut inside, mut outside) = (0, 0);
        for (is_interior, place) in &mut place {
            let count = if *is_interior { &mut inside } else { &mut outside };
            *place = *count;
            *count += 1;
        }
        let entries = |visit: &mut dyn FnMut((bool, usize), (bool, usize), usize)| {
            for column in 0..n {
                for slot in pattern.column(column) {
                    visit(place[pattern.row_indices()[slot] as usize], place[column], slot);
                }
            }
        };
        let (mut rc, mut cr) = (Vec::new(), Vec::new());
        entries(&mut |(r_in, row), (c_in, column), slot| match (r_in, c_in) {
            (true, false) => rc.push((row, column, slot)),
            (false, true) => cr.push((row, column, slot)),
            _ => {}
        });
        let (coupled_columns, coupled_rows) = (distinct(rc.iter().map(|e| e.1)), distinct(cr.iter().map(|e| e.0)));
        let rr = Pattern::from_entries(inside, inside, |take| {
            entries(&mut |(r_in, row), (c_in, column), _| {
                if r_in && c_in {
                    take(row, column);
                }
            });
        });
        let b = Pattern::from_entries(outside, outside, |take| {
            entries(&mut |(r_in, row), (c_in, column), _| {
                if !r_in && !c_in {
                    take(row, column);
                }
            });
            for &column in &coupled_columns {
                for &row in &coupled_rows {
                    take(row, column);
                }
            }
        });
        // The entries of a block come in the order of its slots, as places keep the order.
        let (mut from, mut cc) = (Vec::with_capacity(rr.len()), Vec::new());
        entries(&mut |(r_in, row), (c_in, column), slot| match (r_in, c_in) {
            (true, true) => from.push(slot),
            (false, false) => cc.extend(b.slot(row, column).map(|k| (k, slot))),
            _ => {}
        });
        Blocks {
            pattern: Arc::clone(pattern),
            rr: (Csc::zeros(Arc::new(rr)), from),
            b: Csc::zeros(Arc::new(b)),
            place,
            rc,
            cr,
            cc,
        }
    }

    /// The slots of `A` that the interior part is made of.
    fn interior_slots(&self) -> impl Iterator<Item = usize> + '_ {
        self.rr.1.iter().copied().chain(self.rc.iter().chain(&self.cr).map(|entry| entry.2))
    }

    /// Factors `A_rr` and forms the correction, a solve for each column of `A_rc`.
    fn eliminate(&mut self, values: &[f64]) -> Result<Interior, LinearError> {
        let (rr, from) = &mut self.rr;
        rr.values.iter_mut().zip(from).for_each(|(value, &mut slot)| *value = values[slot]);
        let mut solver = Umfpack::default();
        solver.analyze(&rr.pattern)?;
        let info = solver.factorize(&rr.values)?;
        let n = rr.pattern.columns();
        let (mut column_of_rc, mut x) = (vec![0.0; n], vec![0.0; n]);
        let mut sums = vec![0.0; self.b.pattern.rows()];
        let rows = distinct(self.cr.iter().map(|entry| entry.0));
        let mut correction = Vec::new();
        // A_rc is listed column after column.
        for entries in self.rc.chunk_by(|a, b| a.1 == b.1) {
            column_of_rc.fill(0.0);
            for &(row, _, slot) in entries {
                column_of_rc[row] = values[slot];
            }
            solver.solve(&column_of_rc, &mut x)?;
            sums.fill(0.0);
            self.cr.iter().for_each(|&(row, column, slot)| sums[row] += values[slot] * x[column]);
            let column = entries[0].1;
            correction.extend(rows.iter().filter_map(|&row| Some((self.b.pattern.slot(row, column)?, sums[row]))));
        }
        let made_of = self.interior_slots().map(|slot| values[slot]).collect();
        Ok(Interior { solver, made_of, correction, info })
    }
}

impl LinearSolver for Condensed {
    fn name(&self) -> &'static str {
        "condensed"
    }

    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<(), LinearError> {
        let blocks = Blocks::new(pattern, &self.interior);
        self.factored = None;
        self.border.analyze(&blocks.b.pattern)?;
        self.blocks = Some(blocks);
        Ok(())
    }

    fn factorize(&mut self, values: &[f64]) -> Result<FactorInfo, LinearError> {
        let blocks = self.blocks.as_mut().ok_or(LinearError::Order { missing: "analyze" })?;
        if values.len() != blocks.pattern.len() {
            return Err(LinearError::PatternChanged);
        }
        let kept = self.factored.take().filter(|old| {
            blocks.interior_slots().zip(&old.made_of).all(|(slot, old)| values[slot].to_bits() == old.to_bits())
        });
        let interior = match kept {
            Some(interior) => interior,
            None => blocks.eliminate(values)?,
        };
        blocks.b.values.fill(0.0);
        blocks.cc.iter().for_each(|&(slot, from)| blocks.b.values[slot] = values[from]);
        interior.correction.iter().for_each(|&(slot, value)| blocks.b.values[slot] -= value);
        let (inside, border) = (interior.info, self.border.factorize(&blocks.b.values));
        self.factored = Some(interior);
        let border = border?;
        Ok(FactorInfo {
            entries: inside.entries + border.entries,
            flops: border.flops,
            pivot_ratio: inside.pivot_ratio.min(border.pivot_ratio),
            peak_bytes: inside.peak_bytes + border.peak_bytes,
        })
    }

    /// `x_c = B⁻¹ (b_c - A_cr A_rr⁻¹ b_r)`, then `x_r = A_rr⁻¹ (b_r - A_rc x_c)` (35).
    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        let (Some(blocks), Some(interior)) = (&self.blocks, &mut self.factored) else {
            return Err(LinearError::Order { missing: "factorize" });
        };
        let values = &interior.made_of[blocks.rr.1.len()..];
        let (rc_values, cr_values) = values.split_at(blocks.rc.len());
        let (mut b_r, mut b_c) = (vec![0.0; blocks.rr.0.pattern.rows()], vec![0.0; blocks.b.pattern.rows()]);
        for (value, &(inside, place)) in b.iter().zip(&blocks.place) {
            (if inside { &mut b_r } else { &mut b_c })[place] = *value;
        }
        let (mut x_r, mut x_c) = (vec![0.0; b_r.len()], vec![0.0; b_c.len()]);
        interior.solver.solve(&b_r, &mut x_r)?;
        blocks.cr.iter().zip(cr_values).for_each(|(&(row, column, _), value)| b_c[row] -= value * x_r[column]);
        self.border.solve(&b_c, &mut x_c)?;
        blocks.rc.iter().zip(rc_values).for_each(|(&(row, column, _), value)| b_r[row] -= value * x_c[column]);
        interior.solver.solve(&b_r, &mut x_r)?;
        for (value, &(inside, place)) in x.iter_mut().zip(&blocks.place) {
            *value = if inside { x_r[place] } else { x_c[place] };
        }
        Ok(())
    }
}

/// The distinct values, ascending.
fn distinct(values: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut values: Vec<usize> = values.collect();
    values.sort_unstable();
    values.dedup();
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::Direct;

    /// A chain of springs whose ends are not interior.
    fn chain(n: usize, last: f64) -> Csc {
        let pattern = Pattern::from_entries(n, n, |take| {
            for i in 0..n {
                take(i, i);
                if i > 0 {
                    take(i - 1, i);
                    take(i, i - 1);
                }
            }
        });
        let mut a = Csc::zeros(Arc::new(pattern));
        for i in 0..n {
            let k = a.pattern.slot(i, i).unwrap();
            a.values[k] = if i == n - 1 { last } else { 2.5 };
            if i > 0 {
                for (row, column) in [(i - 1, i), (i, i - 1)] {
                    let k = a.pattern.slot(row, column).unwrap();
                    a.values[k] = -1.0;
                }
            }
        }
        a
    }

    #[test]
    fn solves_the_whole_system_and_keeps_the_interior() {
        let n = 30;
        let mut condensed = Direct::new(Box::new(Condensed::new((3..n - 1).collect())));
        let mut whole = Direct::new(Box::new(Umfpack::default()));
        let b: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
        let (mut x, mut y) = (vec![0.0; n], vec![0.0; n]);
        for (k, last) in [3.0, 7.0, 0.9].into_iter().enumerate() {
            let a = chain(n, last);
            if k == 0 {
                condensed.analyze(&a.pattern).unwrap();
                whole.analyze(&a.pattern).unwrap();
            }
            condensed.factorize(&a).unwrap();
            whole.factorize(&a).unwrap();
            let info = condensed.solve(&a, &b, &mut x).unwrap();
            whole.solve(&a, &b, &mut y).unwrap();
            assert!(info.backward_error < 1e-15);
            assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() < 1e-13 * (1.0 + y.abs())));
        }
    }

    #[test]
    fn an_interior_that_changes_is_eliminated_anew() {
        let n = 12;
        let mut condensed = Direct::new(Box::new(Condensed::new((0..n - 1).collect())));
        let mut a = chain(n, 2.0);
        condensed.analyze(&a.pattern).unwrap();
        let b = vec![1.0; n];
        for value in [2.5, 4.0] {
            let k = a.pattern.slot(5, 5).unwrap();
            a.values[k] = value;
            condensed.factorize(&a).unwrap();
            let mut x = vec![0.0; n];
            // Unrefined, so that stale factors would show.
            assert!(condensed.solve(&a, &b, &mut x).unwrap().refinements <= 1);
            assert!(crate::linear::backward_error(&a, &b, &x) < 1e-15);
        }
    }

    #[test]
    fn a_singular_interior_is_an_error() {
        let mut a = chain(4, 2.0);
        for i in 0..2 {
            let k = a.pattern.slot(i, i).unwrap();
            a.values[k] = 1.0;
        }
        let mut condensed = Condensed::new(vec![0, 1]);
        assert!(matches!(condensed.factorize(&a.values), Err(LinearError::Order { .. })));
        condensed.analyze(&a.pattern).unwrap();
        assert!(matches!(condensed.factorize(&a.values), Err(LinearError::Singular { .. })));
    }
}
