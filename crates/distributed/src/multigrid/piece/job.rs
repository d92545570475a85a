//! The collective operations of all ranks. Rank 0 has whole vectors and receives whole results; those of the others
//! are empty.

use super::{Piece, State};
use crate::petsc::Share;
use crate::ranks::{RankLocal, World};
use stickslip::algebra::DoubleDouble;
use stickslip::algebra::linear::LinearError;

/// A collective operation. Hierarchies are identified by numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Job {
    Needs,
    Norms,
    Product,
    Products,
    Beyond,
    Lower,
    Hierarchy(i64),
    Cycle(i64),
    Drop(i64),
}

impl Job {
    const KINDS: i64 = 9;

    /// Returns the number by which rank 0 calls the operation.
    pub(crate) fn number(self) -> i64 {
        match self {
            Job::Needs => 0,
            Job::Norms => 1,
            Job::Product => 2,
            Job::Products => 3,
            Job::Beyond => 4,
            Job::Lower => 5,
            Job::Hierarchy(of) => 6 + Job::KINDS * of,
            Job::Cycle(of) => 7 + Job::KINDS * of,
            Job::Drop(of) => 8 + Job::KINDS * of,
        }
    }

    fn of(number: i64) -> Self {
        let of = number / Job::KINDS;
        match number % Job::KINDS {
            0 => Job::Needs,
            1 => Job::Norms,
            2 => Job::Product,
            3 => Job::Products,
            4 => Job::Beyond,
            5 => Job::Lower,
            6 => Job::Hierarchy(of),
            7 => Job::Cycle(of),
            _ => Job::Drop(of),
        }
    }
}

impl Piece {
    /// Gathers the node numbers of the vector parts that rank 0 must scatter, rank after rank, and the number of
    /// entries on all ranks.
    pub(crate) fn needs(&self, world: &World) -> Result<(Vec<u32>, usize), LinearError> {
        let bounds = world.bounds(self.nodes.len());
        let entries = world.of_each([self.values.len() as f64]);
        let mut all = on_first(world, bounds[world.size()]);
        world.collect(&self.nodes.iter().map(|node| *node as f64).collect::<Vec<_>>(), &bounds, &mut all)?;
        let entries: f64 = entries.into_iter().map(|[count]| count).sum();
        Ok((all.into_iter().map(|node| node as u32).collect(), entries as usize))
    }

    /// Gathers the largest size in each row, and the diagonal.
    pub(crate) fn all_norms(&self, world: &World, all: &mut [Vec<f64>; 2]) -> Result<(), LinearError> {
        let bounds = self.row_bounds();
        self.norms(self.first(world)).iter().zip(all).try_for_each(|(own, all)| world.collect(own, &bounds, all))
    }

    /// Computes `K x` for an `x` as it is scattered.
    pub(crate) fn product(&self, world: &World, x: &[f64], y: &mut [f64]) -> Result<(), LinearError> {
        let x = self.dealt(world, x)?;
        world.collect(&self.sums(&x, |value, x| value * x), &self.row_bounds(), y)
    }

    /// Computes `K x` and `|K| |x|`.
    pub(crate) fn products(&self, world: &World, x: &[f64], [y, sizes]: [&mut [f64]; 2]) -> Result<(), LinearError> {
        let x = self.dealt(world, x)?;
        world.collect(&self.sums(&x, |value, x| value * x), &self.row_bounds(), y)?;
        world.collect(&self.sums(&x, |value, x| (value * x).abs()), &self.row_bounds(), sizes)
    }

    /// Computes `K (x + rest)` in twice the working precision, as two numbers.
    pub(crate) fn beyond(
        &self,
        world: &World,
        [x, rest]: [&[f64]; 2],
        [high, low]: [&mut [f64]; 2],
    ) -> Result<(), LinearError> {
        let (d, x, rest) = (self.dimension, self.dealt(world, x)?, self.dealt(world, rest)?);
        let sums = self.of_rows(|columns, values| {
            let mut sum = DoubleDouble::default();
            for (values, column) in values.chunks_exact(d).zip(columns) {
                for (value, at) in values.iter().zip(*column as usize * d..) {
                    sum.add_product(*value, x[at]);
                    sum.add(value * rest[at]);
                }
            }
            sum.parts()
        });
        for (k, all) in [high, low].into_iter().enumerate() {
            let own: Vec<f64> = sums.iter().map(|parts| parts[k]).collect();
            world.collect(&own, &self.row_bounds(), all)?;
        }
        Ok(())
    }

    /// Gathers row, column and value of each entry on and below the diagonal.
    pub(crate) fn all_lower(&self, world: &World) -> Result<Vec<f64>, LinearError> {
        let own = self.lower(self.first(world));
        let bounds = world.bounds(own.len());
        let mut all = on_first(world, bounds[world.size()]);
        world.collect(&own, &bounds, &mut all)?;
        Ok(all)
    }

    /// Builds the hierarchy of the Newton matrix of rank 0, the only rank with its `state` and rigid modes.
    pub(crate) fn hierarchy(
        &mut self,
        world: &World,
        number: i64,
        state: Option<&State>,
        kernel: &[Vec<f64>],
    ) -> Result<(), LinearError> {
        let state = State::told(state, world);
        let mut motions = [kernel.len() as i64];
        world.tell(&mut motions);
        let bounds = self.row_bounds();
        let motions = (0..motions[0] as usize).map(|k| {
            let mut own = vec![0.0; bounds[world.rank() + 1] - bounds[world.rank()]];
            world.deal(kernel.get(k).map_or(&[], Vec::as_slice), &bounds, &mut own).map(|()| own)
        });
        let motions = motions.collect::<Result<_, _>>()?;
        let rows = self.eliminated(self.first(world), &state)?;
        self.hierarchies.insert(number, Share::new(world, rows, motions, bounds)?);
        Ok(())
    }

    /// Applies one cycle of a hierarchy.
    pub(crate) fn cycle(&mut self, world: &World, number: i64, r: &[f64], z: &mut [f64]) -> Result<(), LinearError> {
        self.hierarchies.get_mut(&number).map_or(Ok(()), |share| share.cycle(world, r, z))
    }

    /// Drops a hierarchy.
    pub(crate) fn forget(&mut self, number: i64) {
        self.hierarchies.remove(&number);
    }

    /// Scatters a vector of rank 0, which has it rank after rank. Returns the part that this rank needs.
    fn dealt(&self, world: &World, x: &[f64]) -> Result<Vec<f64>, LinearError> {
        let mut own = vec![0.0; self.nodes.len() * self.dimension];
        world.deal(x, &self.needs, &mut own)?;
        Ok(own)
    }
}

/// Returns zeros for `many` gathered numbers on rank 0, nothing on other ranks.
fn on_first(world: &World, many: usize) -> Vec<f64> {
    vec![0.0; if world.rank() == 0 { many } else { 0 }]
}

impl RankLocal for Option<Piece> {
    fn serve(&mut self, world: &World, job: i64) -> Result<(), LinearError> {
        let Some(piece) = self else { return Ok(()) };
        let [one, other]: [&mut [f64]; 2] = [&mut [], &mut []];
        match Job::of(job) {
            Job::Needs => piece.needs(world).map(drop),
            Job::Norms => piece.all_norms(world, &mut Default::default()),
            Job::Product => piece.product(world, &[], one),
            Job::Products => piece.products(world, &[], [one, other]),
            Job::Beyond => piece.beyond(world, [&[], &[]], [one, other]),
            Job::Lower => piece.all_lower(world).map(drop),
            Job::Hierarchy(number) => piece.hierarchy(world, number, None, &[]),
            Job::Cycle(number) => piece.cycle(world, number, &[], one),
            Job::Drop(number) => {
                piece.forget(number);
                Ok(())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jobs_have_numbers() {
        let single = [Job::Needs, Job::Norms, Job::Product, Job::Products, Job::Beyond, Job::Lower];
        let numbered = (0..3).flat_map(|k| [Job::Hierarchy(k), Job::Cycle(k), Job::Drop(k)]);
        for job in single.into_iter().chain(numbered) {
            assert_eq!(Job::of(job.number()), job);
        }
    }
}
