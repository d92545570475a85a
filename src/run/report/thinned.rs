//! Curves thinned to the resolution of a picture.

use serde::{Deserialize, Serialize};

/// The largest number of stored segments of a curve, which exceeds the width of a picture in pixels.
const MOST: usize = 4096;

/// A curve whose points come in order. It stores the lowest and the highest point of each segment. These are all points
/// as long as there are few. Later, an oscillation within a pixel still covers its full range.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Thinned {
    stretches: Vec<Stretch>,
    /// The number of points of a segment, a power of two, and the number of points in the last one.
    size: usize,
    filled: usize,
}

/// The lowest and the highest point, in order.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Stretch([[f64; 2]; 2]);

impl Stretch {
    fn with(self, other: Stretch) -> Stretch {
        let points = self.0.into_iter().chain(other.0);
        let low = points.clone().fold(self.0[0], |low, point| if point[1] < low[1] { point } else { low });
        let high = points.fold(self.0[0], |high, point| if point[1] > high[1] { point } else { high });
        Stretch(if low[0] <= high[0] { [low, high] } else { [high, low] })
    }
}

impl Thinned {
    pub(super) fn push(&mut self, point: [f64; 2]) {
        let new = Stretch([point; 2]);
        match self.stretches.last_mut() {
            Some(last) if self.filled < self.size => {
                *last = last.with(new);
                self.filled += 1;
            }
            _ => {
                if self.stretches.len() == MOST {
                    self.stretches = self.stretches.chunks(2).map(|two| two[0].with(two[two.len() - 1])).collect();
                    self.size *= 2;
                }
                self.stretches.push(new);
                (self.size, self.filled) = (self.size.max(1), 1);
            }
        }
    }

    /// Returns the stored points, each once.
    pub fn points(&self) -> Vec<[f64; 2]> {
        let mut points: Vec<[f64; 2]> = self.stretches.iter().flat_map(|stretch| stretch.0).collect();
        points.dedup();
        points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_points_are_all_kept_and_of_many_the_extremes() {
        let curve = |count: usize| {
            let mut curve = Thinned::default();
            // A curve that oscillates within every pixel, and has a peak.
            (0..count).for_each(|k| curve.push([k as f64, if k == 777 { 5.0 } else { (k % 2) as f64 }]));
            curve.points()
        };
        assert_eq!(curve(MOST).len(), MOST);
        for count in [MOST + 1, 100_000] {
            let points = curve(count);
            assert!(points.len() <= 2 * MOST + 2 && points.is_sorted_by(|a, b| a[0] < b[0]), "{}", points.len());
            assert!(points.contains(&[777.0, 5.0]) && points[0][0] == 0.0);
            assert!(points.last().unwrap()[0] > count as f64 - 64.0);
        }
    }
}
