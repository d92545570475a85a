//! A tree of bounding boxes, to find the items near a line or a point without examining all of them.

/// The smallest and the largest coordinate along each axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds {
    pub low: [f64; 3],
    pub high: [f64; 3],
}

/// A binary tree of boxes, each around its two children.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tree {
    /// The boxes in depth-first order: each is followed by its first child.
    boxes: Vec<Node>,
    /// The items, in the order of the leaves.
    things: Vec<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Node {
    bounds: Bounds,
    /// The index of the box after all descendants of this one.
    next: usize,
    /// The index of the first item of a leaf, and the number of its items; 0 items in other boxes.
    first: usize,
    count: usize,
}

/// The largest number of items of a leaf.
const LEAF: usize = 4;

impl Bounds {
    /// Returns the bounds of `points`.
    pub(super) fn of(points: &[[f64; 3]]) -> Self {
        let nothing = Bounds { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };
        points.iter().fold(nothing, |bounds, x| bounds.with(&Bounds { low: *x, high: *x }))
    }

    fn with(self, other: &Bounds) -> Self {
        Bounds {
            low: [0, 1, 2].map(|c| self.low[c].min(other.low[c])),
            high: [0, 1, 2].map(|c| self.high[c].max(other.high[c])),
        }
    }

    fn centre(&self, c: usize) -> f64 {
        0.5 * (self.low[c] + self.high[c])
    }

    /// Returns the longest side.
    pub(super) fn extent(&self) -> f64 {
        (0..3).map(|c| self.high[c] - self.low[c]).fold(0.0, f64::max)
    }

    /// Returns the bounds extended by `by` (m) on all sides.
    pub(super) fn grown(self, by: f64) -> Self {
        Bounds { low: self.low.map(|c| c - by), high: self.high.map(|c| c + by) }
    }

    /// Returns `true` if the bounds contain `x`.
    pub(super) fn holds(&self, x: [f64; 3]) -> bool {
        (0..3).all(|c| self.low[c] <= x[c] && x[c] <= self.high[c])
    }

    /// Returns `true` if the two have a common point.
    pub(super) fn overlaps(&self, other: &Bounds) -> bool {
        (0..3).all(|c| self.low[c] <= other.high[c] && other.low[c] <= self.high[c])
    }

    /// Returns `true` if the line through `x` along `n` comes within `slack`.
    fn meets(&self, x: [f64; 3], n: [f64; 3], slack: f64) -> bool {
        let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
        for c in 0..3 {
            let (low, high) = (self.low[c] - slack - x[c], self.high[c] + slack - x[c]);
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

    /// Returns the square of the distance from `x`.
    fn square_distance(&self, x: [f64; 3]) -> f64 {
        (0..3).map(|c| (self.low[c] - x[c]).max(x[c] - self.high[c]).max(0.0).powi(2)).sum()
    }
}

impl Tree {
    /// Creates the tree of items with these bounds.
    pub(super) fn new(bounds: &[Bounds]) -> Self {
        let mut tree = Tree { boxes: Vec::new(), things: (0..bounds.len()).collect() };
        tree.build(bounds, 0, bounds.len());
        tree
    }

    /// Creates the tree of items of which each has one or more boxes, with the items' numbers.
    pub(super) fn of_boxes(boxes: &[(Bounds, usize)]) -> Self {
        let mut tree = Tree::new(&boxes.iter().map(|part| part.0).collect::<Vec<_>>());
        tree.things.iter_mut().for_each(|k| *k = boxes[*k].1);
        tree
    }

    /// Builds the boxes of the items from `first` to `end`. Each box splits its items into halves of equal number,
    /// which limits the depth of the tree.
    fn build(&mut self, all: &[Bounds], first: usize, end: usize) {
        let things = &mut self.things[first..end];
        let bounds = things.iter().fold(Bounds::of(&[]), |bounds, &k| bounds.with(&all[k]));
        let (index, leaf) = (self.boxes.len(), end - first <= LEAF);
        self.boxes.push(Node { bounds, next: 0, first, count: if leaf { end - first } else { 0 } });
        if !leaf {
            let spread = Bounds::of(&things.iter().map(|&k| [0, 1, 2].map(|c| all[k].centre(c))).collect::<Vec<_>>());
            let width = |c: usize| spread.high[c] - spread.low[c];
            let longest = (1..3).fold(0, |best, c| if width(c) > width(best) { c } else { best });
            let half = things.len() / 2;
            things.select_nth_unstable_by(half, |&a, &b| all[a].centre(longest).total_cmp(&all[b].centre(longest)));
            self.build(all, first, first + half);
            self.build(all, first + half, end);
        }
        self.boxes[index].next = self.boxes.len();
    }

    fn things(&self, node: &Node) -> impl Iterator<Item = usize> {
        self.things[node.first..node.first + node.count].iter().copied()
    }

    /// Visits the items whose bounds are within `slack` of the line through `x` along `n`, and a few others nearby.
    pub(super) fn along(&self, x: [f64; 3], n: [f64; 3], slack: f64, each: impl FnMut(usize)) {
        self.within(|bounds| bounds.meets(x, n, slack), each);
    }

    /// Visits the items whose bounds overlap `others`, and a few others nearby.
    pub(super) fn around(&self, others: &Bounds, each: impl FnMut(usize)) {
        self.within(|bounds| bounds.overlaps(others), each);
    }

    /// Visits the items of the leaves for which `wanted` holds, as well as for all enclosing boxes.
    fn within(&self, wanted: impl Fn(&Bounds) -> bool, mut each: impl FnMut(usize)) {
        let mut at = 0;
        while let Some(node) = self.boxes.get(at) {
            if wanted(&node.bounds) {
                self.things(node).for_each(&mut each);
                at += 1;
            } else {
                at = node.next;
            }
        }
    }

    /// Visits the items around `x` until no other can be nearer. `each` returns the square of the distance of an item.
    pub(super) fn near(&self, x: [f64; 3], mut each: impl FnMut(usize) -> f64) {
        let mut nearest = f64::INFINITY;
        let mut open = vec![(0.0, 0)];
        while let Some((distance, at)) = open.pop() {
            let Some(node) = self.boxes.get(at).filter(|_| distance <= nearest) else { continue };
            for thing in self.things(node) {
                nearest = nearest.min(each(thing));
            }
            if node.count == 0 {
                let [one, other] = [at + 1, self.boxes.get(at + 1).map_or(at, |child| child.next)]
                    .map(|child| (self.boxes[child].bounds.square_distance(x), child));
                // The nearer box is visited first.
                open.extend(if one.0 < other.0 { [other, one] } else { [one, other] });
            }
        }
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
        let bounds: Vec<Bounds> = (0..n).map(|k| Bounds::of(&[at(k), at(k).map(|c| c + 0.5)])).collect();
        let tree = Tree::new(&bounds);
        assert_eq!(Tree::new(&[]).things.len(), 0);
        for k in [0, 17, 500, 999] {
            let mut found = Vec::new();
            tree.along([at(k)[0] + 0.2, 0.0, at(k)[2] + 0.1], [0.0, 1.0, 0.0], 0.0, |thing| found.push(thing));
            assert!(found.contains(&k) && found.len() < 3 * LEAF, "{found:?}");
            let (mut looked, mut best) = (0, (f64::INFINITY, n));
            let x = at(k).map(|c| c + 0.6);
            tree.near(x, |thing| {
                looked += 1;
                let d = bounds[thing].square_distance(x);
                best = if d < best.0 { (d, thing) } else { best };
                d
            });
            assert!(best.1 == k && looked < 20 * LEAF, "{best:?} {looked}");
        }
    }
}
