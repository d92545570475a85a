//! The Pareto front of runs.

/// Errors that differ by a smaller share count as equal: paths with the same increments reach the same state up to
/// algebraic errors.
const SAME: f64 = 0.01;

/// Returns the indices of the `points` (time, error) whose error is smaller than those of all faster points, in the
/// order of increasing time. Points that are not finite are ignored.
pub fn front(points: &[[f64; 2]]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).filter(|&k| points[k].iter().all(|x| x.is_finite())).collect();
    order.sort_by(|&a, &b| {
        let ([time_a, error_a], [time_b, error_b]) = (points[a], points[b]);
        time_a.total_cmp(&time_b).then(error_a.total_cmp(&error_b))
    });
    let mut best = f64::INFINITY;
    order.retain(|&k| {
        let better = points[k][1] < (1.0 - SAME) * best;
        if better {
            best = points[k][1];
        }
        better
    });
    order
}
