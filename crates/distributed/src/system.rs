//! A Newton system on all ranks: its matrix, the elimination of contact from it, and the solver.
//!
//! Contact is eliminated exactly, node by node: first the held displacements `E r`, then a cycle of algebraic multigrid on
//! the matrix `R A F` between the free displacements, then the reactions `T`,
//!
//! ```text
//! y = E r,   y += F (R A F)⁻¹ R (r - A y),   y += T (r - A y).
//! ```
//!
//! If an exact inverse takes the place of the cycle, this is the inverse of `A`. Multiplied out, with the products of `A` and the
//! matrices of contact, which have few entries, it is `(E + T - T A E) + (F - T A F) (R A F)⁻¹ (R - R A E)`.

use std::collections::HashMap;

use stickslip::algebra::linear::LinearError;

use crate::exchange::Exchange;
use crate::petsc::{self, Found, Int, Krylov, Matrix, Parts, Preconditioner, Vector};
use crate::ranks::shim::{World, tell, tell_text};
use crate::rows::Rows;

/// An entry: row and column in the whole, value.
pub(crate) type Entry = (Int, Int, f64);

/// The data of a system that rank 0 broadcasts.
pub(crate) struct Setup<'a> {
    /// The dimension; 0 for a system that is factored.
    pub dimension: usize,
    pub options: String,
    /// The ranges of nodes and of rows of the ranks.
    pub nodes: Vec<usize>,
    pub rows: Vec<usize>,
    /// The row of each unknown.
    pub places: &'a [Int],
    /// The displacements of the rigid motions, followed by zeros.
    pub motions: Vec<Vec<f64>>,
    /// Row and column of each entry, if rank 0 has the whole matrix.
    pub entries: Option<[Vec<Int>; 2]>,
}

/// The data of new values that rank 0 broadcasts.
pub(crate) struct Change<'a> {
    /// The values of the entries, or entries besides `factor` times the shared stiffness; nothing if they stay.
    pub values: Values<'a>,
    /// The way to solve.
    pub by: By<'a>,
}

pub(crate) enum Values<'a> {
    Same,
    Whole(&'a [f64]),
    Beside(f64, &'a [Entry]),
}

pub(crate) enum By<'a> {
    /// MUMPS.
    Factors,
    /// The options, with contact eliminated and the cycle of this number, which may be made anew.
    Options { contact: &'a Contact, cycle: i64, fresh: bool, unsymmetric: bool },
}

/// The entries of the matrices that eliminate contact.
#[derive(Default)]
pub(crate) struct Contact {
    pub held: Vec<Entry>,
    pub to_all: Vec<Entry>,
    pub from_all: Vec<Entry>,
    pub reactions: Vec<Entry>,
    /// The terms that are added to the matrix between the free displacements.
    pub added: Vec<Entry>,
}

/// The properties of the present factors or of the matrix.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Outcome {
    /// MUMPS's status, which is equal on all ranks; 0 without it.
    pub status: Int,
    pub entries: f64,
    pub flops: f64,
    pub pivots: f64,
    pub peak_bytes: f64,
}

/// The part of one rank.
pub(crate) struct System {
    dimension: usize,
    nodes: Vec<usize>,
    rows: Vec<usize>,
    rank: usize,
    matrix: Matrix,
    exchange: Exchange,
    solution: Vector,
    kernel: Vec<Vector>,
    /// `true` if the options name a preconditioner, so that contact is not eliminated.
    has_other: bool,
    krylov: Option<Krylov>,
    is_factored: bool,
    /// The cycles, each with the matrix that it was made for.
    cycles: HashMap<i64, (Preconditioner, Matrix)>,
}

impl System {
    /// Creates the part of this rank. Rank 0 has the setup.
    pub(crate) fn new(world: &World, stiffness: Option<&Rows>, own: Option<Setup<'_>>) -> Result<Self, LinearError> {
        let mut head = own
            .as_ref()
            .map_or([0; 3], |own| [own.dimension as i64, own.motions.len() as i64, i64::from(own.entries.is_some())]);
        tell(&mut head);
        let options = tell_text(own.as_ref().map_or("", |own| &own.options));
        let mut words: Vec<i64> = vec![0; 2 * (world.size() + 1)];
        if let Some(own) = &own {
            words.iter_mut().zip(own.nodes.iter().chain(&own.rows)).for_each(|(word, bound)| *word = *bound as i64);
        }
        tell(&mut words);
        petsc::start(&options)?;
        let bounds: Vec<usize> = words.into_iter().map(|word| word as usize).collect();
        let (nodes, rows) = bounds.split_at(world.size() + 1);
        let (dimension, rank) = (head[0] as usize, world.rank());
        let here = |bounds: &[usize]| bounds[rank + 1] - bounds[rank];
        let (displacements, all) = (here(nodes) * dimension, here(rows));
        let mut exchange = Exchange::new(all, own.as_ref().map_or(&[], |own| own.places))?;
        let mut kernel = Vec::new();
        for k in 0..head[1] as usize {
            exchange.deal(own.as_ref().map_or(&[], |own| &own.motions[k]))?;
            let motion = exchange.own.with(|all| all[..displacements].to_vec())?;
            let mut vector = Vector::new(displacements)?;
            vector.with(|to| to.copy_from_slice(&motion))?;
            if vector.orthonormalise(&kernel)? {
                kernel.push(vector);
            }
        }
        let matrix = if let Some(stiffness) = stiffness.filter(|_| head[2] == 0) {
            stiffness.room(all - displacements)?
        } else {
            let [mut at, mut columns] = own.and_then(|own| own.entries).unwrap_or_default();
            Matrix::with_places([all; 2], 1, &mut at, &mut columns)?
        };
        Ok(System {
            dimension,
            nodes: nodes.to_vec(),
            rows: rows.to_vec(),
            rank,
            matrix,
            exchange,
            solution: Vector::new(all)?,
            kernel,
            has_other: dimension > 0 && petsc::has(c"-pc_type")?,
            krylov: None,
            is_factored: false,
            cycles: HashMap::new(),
        })
    }

    /// Takes over the values of rank 0, and prepares to solve. Rank 0 has the change.
    pub(crate) fn factorize(
        &mut self,
        stiffness: Option<&Rows>,
        own: Option<&Change<'_>>,
    ) -> Result<Outcome, LinearError> {
        let mut head = own.map_or([0; 6], |own| {
            let (kind, factor) = match own.values {
                Values::Same => (0, 0.0),
                Values::Whole(_) => (1, 0.0),
                Values::Beside(factor, _) => (2, factor),
            };
            let by = match own.by {
                By::Factors => [0; 4],
                By::Options { cycle, fresh, unsymmetric, .. } => [1, cycle, fresh.into(), unsymmetric.into()],
            };
            [kind, f64::to_bits(factor) as i64, by[0], by[1], by[2], by[3]]
        });
        tell(&mut head);
        let [kind, factor, by_options, cycle, fresh, unsymmetric] = head;
        match (kind, stiffness) {
            (1, _) => self
                .matrix
                .set(own.map_or(&[], |own| if let Values::Whole(values) = own.values { values } else { &[] }))?,
            (2, Some(stiffness)) => {
                self.matrix.clear()?;
                stiffness.add_to(&mut self.matrix, f64::from_bits(factor as u64), &self.rows)?;
                if let Some(Change { values: Values::Beside(_, entries), .. }) = own {
                    for &(row, column, value) in *entries {
                        self.matrix.add(&[row], &[column], &[value])?;
                    }
                }
                self.matrix.assemble()?;
            }
            _ => {}
        }
        if by_options == 0 {
            return self.factors();
        }
        self.krylov = None;
        self.is_factored = false;
        let none = Contact::default();
        let contact = match own {
            Some(Change { by: By::Options { contact, .. }, .. }) => contact,
            _ => &none,
        };
        self.by_options(contact, cycle, fresh != 0, unsymmetric != 0)?;
        Ok(Outcome { entries: self.matrix.entries()?, pivots: 1.0, ..Outcome::default() })
    }

    /// Prepares to solve as the options say.
    fn by_options(&mut self, contact: &Contact, cycle: i64, fresh: bool, unsymmetric: bool) -> Result<(), LinearError> {
        if self.has_other {
            self.krylov = Some(Krylov::by_options(&self.matrix, None)?);
            return Ok(());
        }
        let d = self.dimension;
        let here = |bounds: &[usize]| bounds[self.rank + 1] - bounds[self.rank];
        let (all, free) = (here(&self.rows), here(&self.nodes) * d);
        // Every rank has the ones of its own displacements.
        let (row, column) = (self.rows[self.rank] as Int, (self.nodes[self.rank] * d) as Int);
        let ones = (0..free as Int).map(|k| (row + k, column + k, 1.0));
        let to_all: Vec<Entry> = ones.clone().chain(contact.to_all.iter().copied()).collect();
        let mut to_all = Matrix::of([all, free], d, &to_all)?;
        let only_ones = Matrix::of([all, free], d, &ones.clone().collect::<Vec<_>>())?;
        let ones = ones.map(|(row, column, one)| (column, row, one));
        let from_all: Vec<Entry> = ones.chain(contact.from_all.iter().copied()).collect();
        let mut from_all = Matrix::of([free, all], 1, &from_all)?;
        let mut known = Matrix::of([all; 2], 1, &contact.held)?;
        let reactions = Matrix::of([all; 2], 1, &contact.reactions)?;
        if fresh {
            // The old cycle is dropped before a new one is made.
            self.cycles.remove(&cycle);
            // F = J + F_c and R = Jᵀ + R_c, with the ones J, make it Jᵀ A J + R_c A J + R A F_c.
            let places: Vec<Int> = (row..).take(free).collect();
            let mut between = self.matrix.within(&places)?;
            let of_contact = Matrix::of([all, free], d, &contact.to_all)?;
            between.plus_within(&from_all.times(&self.matrix.times(&of_contact)?)?)?;
            let of_contact = Matrix::of([free, all], 1, &contact.from_all)?;
            between.plus_within(&of_contact.times(&self.matrix)?.times(&only_ones)?)?;
            for &(row, column, value) in &contact.added {
                between.add(&[row], &[column], &[value])?;
            }
            between.assemble()?;
            let made = Preconditioner::cycle(&between, d, &self.kernel, !unsymmetric)?;
            self.cycles.insert(cycle, (made, between));
        }
        let by_held = self.matrix.times(&known)?;
        let by_reactions = reactions.times(&self.matrix)?;
        from_all.plus(-1.0, &from_all.times(&by_held)?)?;
        to_all.plus(-1.0, &by_reactions.times(&to_all)?)?;
        known.plus(1.0, &reactions)?;
        known.plus(-1.0, &reactions.times(&by_held)?)?;
        let (cycle, _) = self.cycles.get(&cycle).ok_or(crate::NOT_FACTORIZED)?;
        let parts = Parts { known: &known, cycle, from_all: &from_all, to_all: &to_all };
        self.krylov = Some(Krylov::by_options(&self.matrix, Some(parts))?);
        Ok(())
    }

    /// Factors the matrix. If that takes more memory than predicted, it is repeated with more room.
    fn factors(&mut self) -> Result<Outcome, LinearError> {
        /// The room of the factors beyond the prediction, in per cent, and the number of attempts with more.
        const ROOM: Int = 30;
        const TRIES: usize = 7;
        let mut room = ROOM;
        self.cycles.clear();
        let mut krylov = self.krylov.take().filter(|_| self.is_factored);
        for _ in 0..TRIES {
            let mut made = match krylov.take() {
                Some(made) => made,
                None => Krylov::direct(&self.matrix, room)?,
            };
            made.factorize(&self.matrix)?;
            let ([status, peak, entries], [flops, least, largest]) = made.told()?;
            self.is_factored = status >= 0;
            if !matches!(status, -8 | -9 | -11 | -14 | -15 | -17 | -20) {
                // Large counts are told in millions.
                let entries = if entries < 0 { -1e6 * f64::from(entries) } else { f64::from(entries) };
                let (pivots, peak_bytes) = (least / largest, 1e6 * f64::from(peak));
                // MUMPS does not factor with an instance that has failed.
                self.krylov = Some(made).filter(|_| self.is_factored);
                return Ok(Outcome { status, entries, flops, pivots, peak_bytes });
            }
            room = 2 * room + 20;
        }
        Ok(Outcome { status: -9, ..Outcome::default() })
    }

    /// Solves `A x = b`. Rank 0 has the tolerance and the limit of iterations, and both vectors.
    pub(crate) fn solve(
        &mut self,
        own: Option<(f64, Option<usize>)>,
        b: &[f64],
        x: &mut [f64],
    ) -> Result<Found, LinearError> {
        let mut head = own
            .map_or([0; 2], |(tolerance, limit)| [tolerance.to_bits() as i64, limit.map_or(-1, |limit| limit as i64)]);
        tell(&mut head);
        let Some(krylov) = &mut self.krylov else { return Err(crate::NOT_FACTORIZED) };
        self.exchange.deal(b)?;
        let limit = usize::try_from(head[1]).ok();
        let found = krylov.solve(&self.exchange.own, &mut self.solution, f64::from_bits(head[0] as u64), limit)?;
        self.exchange.collect(&self.solution, x)?;
        Ok(found)
    }
}
