//! The visible parts of polygons that are drawn one over the other, from samples of the picture.

/// Samples along a pixel.
const FINE: f64 = 2.0;

/// The visible part of a polygon.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Visibility {
    /// Nothing: others cover it.
    Hidden,
    /// All of it, and it covers no other that is seen. Its place in the order does not matter.
    Alone,
    /// A part of it, or it covers a part of another.
    Layered,
}

/// Returns what is seen of `polygons` in a picture of `size`, px. Later ones cover earlier ones.
pub(super) fn visibility(polygons: &[&[[f64; 2]]], size: [f64; 2]) -> Vec<Visibility> {
    let [columns, rows] = size.map(|x| (FINE * x).ceil().max(1.0) as usize);
    let mut front: Vec<Option<usize>> = vec![None; columns * rows];
    let samples = |k: usize| spans(polygons[k], [columns, rows]).into_iter().flatten();
    for k in 0..polygons.len() {
        samples(k).for_each(|sample| front[sample] = Some(k));
    }
    let mut is_visible = vec![false; polygons.len()];
    front.iter().flatten().for_each(|&k| is_visible[k] = true);
    let mut covers = vec![0_u8; columns * rows];
    for k in (0..polygons.len()).filter(|&k| is_visible[k]) {
        samples(k).for_each(|sample| covers[sample] = covers[sample].saturating_add(1));
    }
    let of = |k: usize| match is_visible[k] {
        false => Visibility::Hidden,
        true if samples(k).all(|sample| covers[sample] == 1) => Visibility::Alone,
        true => Visibility::Layered,
    };
    (0..polygons.len()).map(of).collect()
}

/// Returns the samples inside a polygon, row by row. A sample on a common side belongs to one of the two neighbours.
fn spans(polygon: &[[f64; 2]], [columns, rows]: [usize; 2]) -> Vec<std::ops::Range<usize>> {
    let sample = |x: f64, most: usize| (FINE * x - 0.5).ceil().clamp(0.0, most as f64) as usize;
    let bound = |start: f64, f: fn(f64, f64) -> f64| polygon.iter().map(|corner| corner[1]).fold(start, f);
    let (top, bottom) = (bound(f64::INFINITY, f64::min), bound(f64::NEG_INFINITY, f64::max));
    let mut spans = Vec::new();
    for row in sample(top, rows)..sample(bottom, rows) {
        let y = (row as f64 + 0.5) / FINE;
        let mut crossings: Vec<f64> = polygon
            .iter()
            .zip(polygon.iter().cycle().skip(1))
            .filter_map(|(a, b)| {
                // Both neighbours of a side begin at the same end of it, so that they find the same crossing.
                let ([low, high], crosses) = (if a[1] <= b[1] { [a, b] } else { [b, a] }, (a[1] <= y) != (b[1] <= y));
                crosses.then(|| low[0] + (y - low[1]) / (high[1] - low[1]) * (high[0] - low[0]))
            })
            .collect();
        crossings.sort_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            spans.push(row * columns + sample(pair[0], columns)..row * columns + sample(pair[1], columns));
        }
    }
    spans
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64, size: f64) -> Vec<[f64; 2]> {
        vec![[x, y], [x + size, y], [x + size, y + size], [x, y + size]]
    }

    #[test]
    fn what_is_covered_is_not_seen() {
        let squares = [
            square(10.0, 10.0, 5.0),
            square(0.0, 0.0, 30.0),
            square(30.0, 0.0, 30.0),
            square(50.0, 20.0, 30.0),
            square(100.0, 100.0, 0.1),
        ];
        let polygons: Vec<&[[f64; 2]]> = squares.iter().map(Vec::as_slice).collect();
        let [hidden, alone, layered] = [Visibility::Hidden, Visibility::Alone, Visibility::Layered];
        assert_eq!(visibility(&polygons, [120.0, 120.0]), [hidden, alone, layered, layered, hidden]);
        // Neighbours share no sample, wherever their sides are.
        let fine: Vec<_> = (0..900).map(|k| square(0.37 * f64::from(k % 30), 0.41 * f64::from(k / 30), 0.7)).collect();
        let apart: Vec<_> = (0..900)
            .map(|k| {
                let (x, y) = (1.37 * f64::from(k % 30), 1.41 * f64::from(k / 30));
                vec![[x, y], [x + 1.37, y], [x + 1.37, y + 1.41], [x, y + 1.41]]
            })
            .collect();
        let of =
            |squares: &[Vec<[f64; 2]>]| visibility(&squares.iter().map(Vec::as_slice).collect::<Vec<_>>(), [60.0; 2]);
        assert!(of(&apart).iter().all(|of| *of == alone) && of(&fine).contains(&layered));
    }
}
