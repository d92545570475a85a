//! A tree of bounding boxes, to find the items near a line or a point without examining all of them.

use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree, RTreeObject, SelectionFunction};

/// The smallest and the largest coordinate along each axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds {
    pub low: [f64; 3],
    pub high: [f64; 3],
}

/// The bounds of an item, with its number.
type Item = GeomWithData<Rectangle<[f64; 3]>, usize>;

/// Items with their bounds.
#[derive(Debug, Clone)]
pub(super) struct Tree(RTree<Item>);

/// The line through a point x along n: whatever is within a distance (m) of it.
struct Along([f64; 3], [f64; 3], f64);

impl Bounds {
    /// Returns the bounds of `points`.
    pub(super) fn of(points: &[[f64; 3]]) -> Self {
        let bounds = AABB::from_points(points);
        Bounds { low: bounds.lower(), high: bounds.upper() }
    }

    /// Returns the longest side.
    pub(super) fn extent(&self) -> f64 {
        (0..3).map(|c| self.high[c] - self.low[c]).fold(0.0, f64::max)
    }

    /// Returns the bounds extended by `by` (m) on all sides.
    pub(super) fn grown(self, by: f64) -> Self {
        Bounds { low: self.low.map(|c| c - by), high: self.high.map(|c| c + by) }
    }

    /// Returns `true` if the two have a common point.
    pub(super) fn overlaps(&self, other: &Bounds) -> bool {
        (0..3).all(|c| self.low[c] <= other.high[c] && other.low[c] <= self.high[c])
    }
}

impl SelectionFunction<Item> for Along {
    fn should_unpack_parent(&self, envelope: &AABB<[f64; 3]>) -> bool {
        let Along(x, n, slack) = self;
        let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
        for c in 0..3 {
            let (low, high) = (envelope.lower()[c] - slack - x[c], envelope.upper()[c] + slack - x[c]);
            if n[c] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return false;
                }
                continue;
            }
            let (a, b) = (low / n[c], high / n[c]);
            (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
        }
        from <= to
    }

    fn should_unpack_leaf(&self, leaf: &Item) -> bool {
        self.should_unpack_parent(&leaf.envelope())
    }
}

impl Tree {
    /// Creates the tree of items with these bounds.
    pub(super) fn new(bounds: impl IntoIterator<Item = Bounds>) -> Self {
        Self::of_boxes(bounds.into_iter().enumerate().map(|(k, bounds)| (bounds, k)))
    }

    /// Creates the tree of items of which each has one or more boxes, with the items' numbers.
    pub(super) fn of_boxes(boxes: impl Iterator<Item = (Bounds, usize)>) -> Self {
        let item = |(bounds, k): (Bounds, usize)| Item::new(Rectangle::from_corners(bounds.low, bounds.high), k);
        let is_finite = |(Bounds { low, high }, _): &(Bounds, usize)| low.iter().chain(high).all(|c| c.is_finite());
        Tree(RTree::bulk_load(boxes.filter(is_finite).map(item).collect()))
    }

    /// Returns the items whose bounds are within `slack` of the line through `x` along `n`.
    pub(super) fn along(&self, x: [f64; 3], n: [f64; 3], slack: f64) -> impl Iterator<Item = usize> {
        self.0.locate_with_selection_function(Along(x, n, slack)).map(|item| item.data)
    }

    /// Returns the items whose bounds overlap `others`.
    pub(super) fn around(&self, others: &Bounds) -> impl Iterator<Item = usize> {
        self.0.locate_in_envelope_intersecting(AABB::from_corners(others.low, others.high)).map(|item| item.data)
    }

    /// Returns the item nearest to `x`, with the square of its distance, which `square` computes; the first of equally near ones.
    pub(super) fn nearest(&self, x: [f64; 3], square: impl Fn(usize) -> f64) -> Option<(f64, usize)> {
        if x.iter().any(|c| c.is_nan()) {
            return None;
        }
        let mut nearest = None::<(f64, usize)>;
        for (item, least) in self.0.nearest_neighbor_iter_with_distance_2(x) {
            // No item is nearer than its bounds.
            if nearest.is_some_and(|(square, _)| square < least) {
                break;
            }
            let of = (square(item.data), item.data);
            nearest = nearest.filter(|nearest| *nearest <= of).or(Some(of));
        }
        nearest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Boxes in a row are found by their number, and few others are examined.
    #[test]
    fn what_is_near_is_found_and_little_else() {
        let n = 1000;
        let at = |k: usize| [k as f64, (k % 7) as f64, (k % 3) as f64];
        let tree = Tree::new((0..n).map(|k| Bounds::of(&[at(k), at(k).map(|c| c + 0.5)])));
        assert_eq!(Tree::new([]).nearest([0.0; 3], |_| 0.0), None);
        assert_eq!(tree.nearest([f64::NAN; 3], |_| 0.0), None);
        for k in [0, 17, 500, 999] {
            let found: Vec<usize> = tree.along([at(k)[0] + 0.2, 0.0, at(k)[2] + 0.1], [0.0, 1.0, 0.0], 0.0).collect();
            assert_eq!(found, [k]);
            assert_eq!(tree.around(&Bounds::of(&[at(k), at(k)])).collect::<Vec<_>>(), [k]);
            let looked = std::cell::Cell::new(0);
            let x = at(k).map(|c| c + 0.6);
            let square = |thing: usize| {
                looked.set(looked.get() + 1);
                (0..3).map(|c| (at(thing)[c] - x[c]).max(x[c] - at(thing)[c] - 0.5).max(0.0).powi(2)).sum()
            };
            assert_eq!(tree.nearest(x, square).map(|of| of.1), Some(k));
            assert!(looked.get() < 80, "{}", looked.get());
        }
    }
}
