//! The paths of a picture: unions of polygons, and lines joined end to end. Few bytes tell many of them.
//!
//! Coordinates are whole tenths of a pixel, so that points that are drawn at one place are one point.

use std::collections::BTreeMap;
use std::fmt::Write;

/// A point of the picture, in tenths of a pixel.
type Point = [i64; 2];

/// Returns the outlines of the union of `polygons`. Common sides of neighbours are left out.
///
/// Each polygon is taken anticlockwise. Then the sides that two neighbours share run in opposite directions and cancel,
/// and what remains has the winding number of all polygons together, also where they overlap.
pub(super) fn union<'a>(polygons: impl IntoIterator<Item = &'a [[f64; 2]]>) -> String {
    let mut sides: BTreeMap<Point, Vec<Point>> = BTreeMap::new();
    for polygon in polygons {
        let mut corners: Vec<Point> = polygon.iter().copied().map(point).collect();
        corners.dedup();
        if twice_area(&corners) < 0 {
            corners.reverse();
        }
        for (k, &a) in corners.iter().enumerate() {
            let b = corners[(k + 1) % corners.len()];
            if a == b {
                continue;
            }
            match sides.get_mut(&b).and_then(|ends| ends.iter().position(|end| *end == a).map(|k| (ends, k))) {
                Some((ends, k)) => {
                    ends.swap_remove(k);
                }
                None => sides.entry(a).or_default().push(b),
            }
        }
    }
    let mut path = String::new();
    for start in sides.keys().copied().collect::<Vec<_>>() {
        // As many sides end at a point as begin there, so that every walk comes back.
        while let Some(mut next) = sides.get_mut(&start).and_then(Vec::pop) {
            let mut outline = vec![start];
            while next != start {
                outline.push(next);
                let Some(end) = sides.get_mut(&next).and_then(Vec::pop) else { break };
                next = end;
            }
            append(&mut path, &straightened(&outline, true));
            path.push('z');
        }
    }
    path
}

/// Returns `segments` as lines as long as possible: a line goes straight on where it can.
pub(super) fn lines(segments: impl IntoIterator<Item = [[f64; 2]; 2]>) -> String {
    let mut ends: BTreeMap<Point, Vec<Point>> = BTreeMap::new();
    for segment in segments {
        let [a, b] = segment.map(point);
        if a != b && !ends.get(&a).is_some_and(|known| known.contains(&b)) {
            ends.entry(a).or_default().push(b);
            ends.entry(b).or_default().push(a);
        }
    }
    let mut path = String::new();
    for start in ends.keys().copied().collect::<Vec<_>>() {
        while let Some(mut here) = ends.get(&start).and_then(|ends| ends.iter().min().copied()) {
            let mut line = vec![start];
            let mut last = start;
            loop {
                cut(&mut ends, last, here);
                line.push(here);
                let straight = |to: &Point| turn(last, here, *to);
                let onwards = ends.get(&here).into_iter().flatten();
                match onwards.max_by(|a, b| straight(a).total_cmp(&straight(b)).then(b.cmp(a))).copied() {
                    Some(next) => (last, here) = (here, next),
                    None => break,
                }
            }
            append(&mut path, &straightened(&line, false));
        }
    }
    path
}

/// Removes the segment between two points.
fn cut(ends: &mut BTreeMap<Point, Vec<Point>>, a: Point, b: Point) {
    for (from, to) in [(a, b), (b, a)] {
        if let Some(known) = ends.get_mut(&from) {
            known.retain(|end| *end != to);
        }
    }
}

fn point(place: [f64; 2]) -> Point {
    place.map(|x| (10.0 * x).round() as i64)
}

/// Returns the cosine of the angle by which a line through `a` and `b` turns towards `c`.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    let [before, after] = [[a, b], [b, c]].map(|[from, to]| [0, 1].map(|k| (to[k] - from[k]) as f64));
    let length = |v: [f64; 2]| (v[0] * v[0] + v[1] * v[1]).sqrt();
    (before[0] * after[0] + before[1] * after[1]) / (length(before) * length(after))
}

fn twice_area(corners: &[Point]) -> i64 {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum()
}

/// Leaves out points on the straight line between their neighbours.
fn straightened(points: &[Point], closed: bool) -> Vec<Point> {
    let n = points.len();
    let is_corner = |k: usize| {
        if !closed && (k == 0 || k + 1 == n) {
            return true;
        }
        let [a, b, c] = [points[(k + n - 1) % n], points[k], points[(k + 1) % n]];
        let [before, after] = [[a, b], [b, c]].map(|[from, to]| [0, 1].map(|k| to[k] - from[k]));
        before[0] * after[1] != before[1] * after[0] || before[0] * after[0] + before[1] * after[1] < 0
    };
    (0..n).filter(|&k| is_corner(k)).map(|k| points[k]).collect()
}

/// Appends a line through points, each relative to the one before it.
fn append(path: &mut String, points: &[Point]) {
    let mut last = [0, 0];
    for (k, &point) in points.iter().enumerate() {
        match k {
            0 => path.push('M'),
            1 => path.push('l'),
            _ => {}
        }
        for (now, before) in point.into_iter().zip(last) {
            append_tenths(path, now - before);
        }
        last = point;
    }
}

/// Appends a number of tenths: a decimal number, with a space if it would run into the one before it.
fn append_tenths(path: &mut String, tenths: i64) {
    if tenths >= 0 && path.ends_with(|c: char| c.is_ascii_digit()) {
        path.push(' ');
    }
    if tenths < 0 {
        path.push('-');
    }
    let (whole, rest) = (tenths.abs() / 10, tenths.abs() % 10);
    // Writing to a string cannot fail.
    let _ = match (whole, rest) {
        (whole, 0) => write!(path, "{whole}"),
        (0, rest) => write!(path, ".{rest}"),
        (whole, rest) => write!(path, "{whole}.{rest}"),
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64) -> Vec<[f64; 2]> {
        vec![[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]]
    }

    #[test]
    fn neighbours_are_one_figure() {
        let path = |squares: &[Vec<[f64; 2]>]| union(squares.iter().map(Vec::as_slice));
        assert_eq!(path(&[square(0.0, 0.0), square(1.0, 0.0)]), "M0 0l2 0 0 1-2 0z");
        // Clockwise as well.
        let mut turned = square(1.0, 0.0);
        turned.reverse();
        assert_eq!(path(&[square(0.0, 0.0), turned]), "M0 0l2 0 0 1-2 0z");
        // Around a hole, whose outline runs the other way.
        let ring = (0..9).filter(|k| *k != 4).map(|k| square(f64::from(k % 3), f64::from(k / 3)));
        assert_eq!(path(&ring.collect::<Vec<_>>()), "M0 0l3 0 0 3-3 0zM1 1l0 1 1 0 0-1z");
        // Overlapping squares are filled.
        assert_eq!(path(&[square(0.0, 0.0), square(0.5, 0.5)]).matches('z').count(), 2);
        assert_eq!(path(&[]), "");
    }

    #[test]
    fn lines_go_straight_on() {
        let grid = (0..3).flat_map(|k| {
            let k = f64::from(k);
            (0..2).map(f64::from).flat_map(move |j| [[[j, k], [j + 1.0, k]], [[k, j], [k, j + 1.0]]])
        });
        let path = lines(grid);
        // Two lines inside, and the sides around.
        assert!(path.matches('M').count() <= 4, "{path}");
        assert_eq!(lines([[[0.0, 0.0], [0.26, -3.0]], [[0.26, -3.0], [0.0, 0.0]]]), "M0 0l.3-3");
    }
}
