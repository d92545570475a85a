//! Compressed rows, assembled node by node on all threads.

use std::ops::Range;

use rayon::prelude::*;

use super::form::Form;
use crate::petsc::Rows;
use stickslip::algebra::linear::LinearError;

/// The number of nodes whose rows one thread assembles at a time.
const TOGETHER: usize = 512;

/// Assembles the rows of all nodes. Each node has as many block columns as its entry of `widths`. `make` writes the
/// columns and values of a node's rows. Its other results are returned in the order of the nodes.
///
/// # Errors
/// If there are more entries than PETSc's 32-bit integers can count.
pub(super) fn rows<S, T: Send>(
    dimension: usize,
    form: Form,
    widths: impl Iterator<Item = usize>,
    scratch: impl Fn() -> S + Sync + Send,
    make: impl Fn(&mut S, usize, &mut [i32], &mut [f64]) -> Option<T> + Sync + Send,
) -> Result<(Rows, Vec<T>), LinearError> {
    let (mut starts, mut entries) = (vec![0], 0);
    for width in widths {
        for _ in 0..dimension {
            entries += width * dimension;
            starts.push(i32::try_from(entries).map_err(|_| LinearError::OutOfMemory {
                step: "the multigrid hierarchy, whose indices have 32 bits",
            })?);
        }
    }
    let (mut columns, mut values) = (vec![0; entries], vec![0.0; entries]);
    let nodes = (starts.len() - 1) / dimension;
    let places = |nodes: Range<usize>| starts[nodes.start * dimension] as usize..starts[nodes.end * dimension] as usize;
    let mut pieces = Vec::new();
    let (mut columns_left, mut values_left) = (&mut columns[..], &mut values[..]);
    for first in (0..nodes).step_by(TOGETHER) {
        let piece = first..nodes.min(first + TOGETHER);
        let length = places(piece.clone()).len();
        let (columns, values);
        (columns, columns_left) = columns_left.split_at_mut(length);
        (values, values_left) = values_left.split_at_mut(length);
        pieces.push((piece, columns, values));
    }
    let write = |scratch: &mut S, (piece, columns, values): (Range<usize>, &mut [i32], &mut [f64])| {
        let first = places(piece.clone()).start;
        let make = |node: usize| {
            let places = places(node..node + 1);
            let here = places.start - first..places.end - first;
            make(scratch, node, &mut columns[here.clone()], &mut values[here])
        };
        piece.filter_map(make).collect::<Vec<T>>()
    };
    let told: Vec<Vec<T>> = pieces.into_par_iter().map_init(scratch, write).collect();
    let symmetric = form == Form::Symmetric;
    Ok((Rows { starts, columns, values, block: dimension, symmetric }, told.into_iter().flatten().collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_one_after_the_other() {
        // More nodes than one thread assembles at a time, with one and two blocks in turn.
        let widths = || (0..1500).map(|node| 1 + node % 2);
        let make = |count: &mut usize, node: usize, columns: &mut [i32], values: &mut [f64]| {
            *count += 1;
            columns.fill(node as i32);
            values.fill(columns.len() as f64);
            (node % 700 == 3).then_some(node)
        };
        let (rows, told) = rows(2, Form::Symmetric, widths(), || 0, make).unwrap();
        assert_eq!((rows.starts.len(), rows.values.len(), rows.block), (3001, 4 * 750 * 3, 2));
        assert_eq!(told, [3, 703, 1403]);
        for (row, ends) in rows.starts.windows(2).enumerate() {
            let places = ends[0] as usize..ends[1] as usize;
            let width = 2 * (1 + (row / 2) % 2);
            assert_eq!(places.len(), width);
            assert!(rows.columns[places.clone()].iter().all(|column| *column as usize == row / 2));
            assert!(rows.values[places].iter().all(|value| *value == 2.0 * width as f64));
        }
    }

    #[test]
    fn more_than_is_counted_is_an_error() {
        let widths = std::iter::repeat_n(1 << 20, 1 << 10);
        let made = rows(2, Form::Symmetric, widths, || (), |(), _, _, _| None::<()>);
        assert!(matches!(made, Err(LinearError::OutOfMemory { .. })));
    }
}
