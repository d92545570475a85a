//! METIS on the graph of a matrix: an order of elimination, or parts of equal size with few couplings.

#![allow(unsafe_code)]

use std::ptr;
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::sys;
use stickslip::algebra::linear::LinearError;

/// A symmetric graph: the neighbours of each vertex, without itself, and the weight of each vertex.
pub(crate) struct Graph {
    starts: Vec<sys::idx_t>,
    neighbours: Vec<sys::idx_t>,
    weights: Vec<sys::idx_t>,
}

impl Graph {
    /// Creates the graph in which each vertex, with its weight, has these neighbours. Numbers that are no vertex, and
    /// a vertex as its own neighbour, are ignored. The caller must pass each coupling in both directions.
    ///
    /// # Errors
    /// If there are more couplings than 32-bit integers can count.
    pub(crate) fn new<N: IntoIterator<Item = usize>>(
        step: &'static str,
        vertices: impl ExactSizeIterator<Item = (usize, N)>,
    ) -> Result<Self, LinearError> {
        let (count, too_many) = (vertices.len(), |_| LinearError::OutOfMemory { step });
        sys::idx_t::try_from(count).map_err(too_many)?;
        let mut graph = Graph { starts: vec![0], neighbours: Vec::new(), weights: Vec::with_capacity(count) };
        for (vertex, (weight, neighbours)) in vertices.enumerate() {
            let others = neighbours.into_iter().filter(|&other| other < count && other != vertex);
            graph.neighbours.extend(others.map(|other| other as sys::idx_t));
            graph.starts.push(sys::idx_t::try_from(graph.neighbours.len()).map_err(too_many)?);
            graph.weights.push(sys::idx_t::try_from(weight).map_err(too_many)?);
        }
        Ok(graph)
    }

    #[cfg(test)]
    pub(crate) fn lists(&self) -> (&[i32], &[i32]) {
        (&self.starts, &self.neighbours)
    }

    fn count(&self) -> usize {
        self.weights.len()
    }
}

/// Returns the vertices in a fill-reducing order of elimination: nested dissection.
///
/// # Errors
/// If memory is short.
pub(crate) fn order(step: &'static str, mut graph: Graph) -> Result<Vec<usize>, LinearError> {
    let count = graph.count();
    if graph.neighbours.is_empty() {
        return Ok((0..count).collect());
    }
    let (mut order, mut place) = (vec![0; count], vec![0; count]);
    let mut n = count as sys::idx_t;
    let _alone = alone();
    // SAFETY: a graph of `n` vertices has `n + 1` starts, the neighbours that they span, all below `n`, and `n`
    // weights. Both results have `n` places. Null options are the defaults.
    let status = unsafe {
        sys::METIS_NodeND(
            &raw mut n,
            graph.starts.as_mut_ptr(),
            graph.neighbours.as_mut_ptr(),
            graph.weights.as_mut_ptr(),
            ptr::null_mut(),
            order.as_mut_ptr(),
            place.as_mut_ptr(),
        )
    };
    check(step, status)?;
    Ok(order.into_iter().map(|vertex| vertex as usize).collect())
}

/// Returns the part of each vertex, one of `parts` parts of nearly equal weight.
///
/// # Errors
/// If memory is short.
pub(crate) fn partition(step: &'static str, mut graph: Graph, parts: usize) -> Result<Vec<usize>, LinearError> {
    let count = graph.count();
    let mut part = vec![0; count];
    if parts > 1 && count > 0 {
        let (mut n, mut constraints, mut cut) = (count as sys::idx_t, 1, 0);
        let mut parts = sys::idx_t::try_from(parts).map_err(|_| LinearError::OutOfMemory { step })?;
        let _alone = alone();
        // SAFETY: a graph as above, one weight for each vertex, and a place for its part. Null arguments are the
        // defaults.
        let status = unsafe {
            sys::METIS_PartGraphKway(
                &raw mut n,
                &raw mut constraints,
                graph.starts.as_mut_ptr(),
                graph.neighbours.as_mut_ptr(),
                graph.weights.as_mut_ptr(),
                ptr::null_mut(),
                ptr::null_mut(),
                &raw mut parts,
                ptr::null_mut(),
                ptr::null_mut(),
                ptr::null_mut(),
                &raw mut cut,
                part.as_mut_ptr(),
            )
        };
        check(step, status)?;
    }
    Ok(part.into_iter().map(|part| part as usize).collect())
}

/// Returns a guard to be held while METIS runs: it uses the random numbers of the C library.
fn alone() -> MutexGuard<'static, ()> {
    static ORDERING: Mutex<()> = Mutex::new(());
    ORDERING.lock().unwrap_or_else(PoisonError::into_inner)
}

fn check(step: &'static str, status: i32) -> Result<(), LinearError> {
    match status {
        sys::rstatus_et_METIS_OK => Ok(()),
        sys::rstatus_et_METIS_ERROR_MEMORY => Err(LinearError::OutOfMemory { step }),
        status => Err(LinearError::Backend { backend: "METIS", step, status: i64::from(status) }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Creates a strip of squares with this length and width.
    fn strip(length: usize, width: usize) -> Graph {
        let beside = move |v: usize| {
            let (i, j) = (v / width, v % width);
            let across = [j.checked_sub(1), Some(j + 1).filter(|&j| j < width)];
            let along = [i.checked_sub(1), Some(i + 1).filter(|&i| i < length)];
            let across = across.into_iter().flatten().map(move |j| i * width + j);
            across.chain(along.into_iter().flatten().map(move |i| i * width + j))
        };
        Graph::new("a test", (0..length * width).map(|v| (1, beside(v)))).unwrap()
    }

    #[test]
    fn parts_are_equal_and_a_strip_is_cut_across() {
        let graph = strip(40, 5);
        let neighbours: Vec<Vec<usize>> = graph
            .starts
            .windows(2)
            .map(|ends| graph.neighbours[ends[0] as usize..ends[1] as usize].iter().map(|&v| v as usize).collect())
            .collect();
        let part = partition("a test", graph, 4).unwrap();
        for k in 0..4 {
            let size = part.iter().filter(|part| **part == k).count();
            assert!((45..=55).contains(&size), "{size}");
        }
        let cut = (0..200).flat_map(|v| neighbours[v].iter().map(move |&w| (v, w))).filter(|&(v, w)| part[v] < part[w]);
        assert!(cut.count() <= 21);
        assert_eq!(partition("a test", strip(3, 1), 1).unwrap(), [0; 3]);
    }

    #[test]
    fn every_vertex_is_ordered_once() {
        let mut order = order("a test", strip(12, 12)).unwrap();
        order.sort_unstable();
        assert!(order.into_iter().eq(0..144));
    }
}
