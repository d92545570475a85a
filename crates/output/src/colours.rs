//! The colours of a stress in bands with round limits, and their bar.

use super::chart::axis::number_to;
use super::svg::{Anchor, BLACK, Colour, LABEL_SIZE, NUMBER_SIZE, Svg, THIN};

/// The width of the bar, px.
const BAR: f64 = 20.0;

/// Viridis of matplotlib (van der Walt and Smith, CC0) at ten equal distances: these ten numbers are all that a crate
/// of colour maps would give. Its lightness grows evenly, so that it can be read without colours.
const VIRIDIS: [Colour; 10] = [
    [68, 1, 84],
    [72, 40, 120],
    [62, 73, 137],
    [49, 104, 142],
    [38, 130, 142],
    [31, 158, 137],
    [53, 183, 121],
    [110, 206, 88],
    [181, 222, 43],
    [253, 231, 37],
];

/// The steps between band limits, relative to a power of ten, each with the value of its last digit. Neighbours differ
/// by a third at most, so that there are at least eight bands.
const STEPS: [(f64, f64); 10] = [
    (1.0, 1.0),
    (1.25, 0.01),
    (1.5, 0.1),
    (2.0, 1.0),
    (2.5, 0.1),
    (3.0, 1.0),
    (4.0, 1.0),
    (5.0, 1.0),
    (6.0, 1.0),
    (8.0, 1.0),
];

/// Bands from zero to a highest value, 8 to 10 of them; none if there is no positive value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bands {
    step: f64,
    /// The value of the last digit of the limits.
    digit: f64,
    count: usize,
}

impl Bands {
    pub(super) fn up_to(most: f64) -> Self {
        let power = 10.0_f64.powf(most.log10().floor() - 1.0);
        let steps =
            [power, 10.0 * power].into_iter().flat_map(|power| STEPS.map(|(k, digit)| (k * power, digit * power)));
        // The slack absorbs the rounding of a highest value that is a limit.
        let band = |(step, digit): (f64, f64)| Bands { step, digit, count: (most / step - SLACK).ceil() as usize };
        let fits = |bands: &Bands| (1..=VIRIDIS.len()).contains(&bands.count);
        steps.map(band).find(fits).unwrap_or(Bands { step: 1.0, digit: 1.0, count: 0 })
    }

    /// Returns the number of the band of a value, from 0; a limit belongs to the band below it.
    pub(super) fn of(&self, value: f64) -> usize {
        ((value / self.step - SLACK).max(0.0) as usize).min(self.count.saturating_sub(1))
    }

    /// Returns the colour of a band.
    pub(super) fn colour(&self, band: usize) -> Colour {
        let place = band as f64 / self.count.saturating_sub(1).max(1) as f64 * (VIRIDIS.len() - 1) as f64;
        let k = (place as usize).min(VIRIDIS.len() - 2);
        let t = place - k as f64;
        [0, 1, 2].map(|c| {
            let [a, b] = [VIRIDIS[k][c], VIRIDIS[k + 1][c]].map(f64::from);
            (a + t * (b - a)).round() as u8
        })
    }

    /// Fills `polygons`, each with its band, band by band. Within a band the order does not matter.
    pub(super) fn fill(&self, svg: &mut Svg, polygons: &[(usize, Vec<[f64; 2]>)]) {
        for band in 0..self.count.max(1) {
            let own = polygons.iter().filter(|(of, _)| *of == band).map(|(_, corners)| corners.as_slice());
            svg.region(own, self.colour(band));
        }
    }

    /// Draws the bar of the bands, in the unit named by `label`, from `top` to `bottom` with its left side at `from`,
    /// px. Draws nothing if there is no stress.
    pub(super) fn draw_bar(&self, svg: &mut Svg, from: f64, [top, bottom]: [f64; 2], label: &str) {
        if self.count == 0 {
            return;
        }
        let to = from + BAR;
        let height = |limit: usize| bottom - limit as f64 / self.count as f64 * (bottom - top);
        for band in 0..self.count {
            let (low, high) = (height(band), height(band + 1));
            svg.rectangle([from, low], [to, high], self.colour(band));
        }
        svg.frame([from, top], [to, bottom], BLACK);
        // On a low bar, not every limit has room for its number.
        let stride = (1.2 * NUMBER_SIZE * self.count as f64 / (bottom - top)).ceil().max(1.0) as usize;
        for limit in 0..=self.count {
            let y = height(limit);
            svg.line(&[[from, y], [to + 5.0, y]], THIN, BLACK);
            if limit % stride == 0 {
                let number = number_to(limit as f64 * self.step, self.digit);
                svg.text([to + 9.0, y], &number, NUMBER_SIZE, Anchor::Start);
            }
        }
        svg.text([to + 74.0, 0.5 * (top + bottom)], label, LABEL_SIZE, Anchor::Upwards);
    }
}

/// The rounding of a value in steps.
const SLACK: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_to_ten_bands_hold_every_value() {
        for k in 0..2000 {
            let most = 1e-7 * 1.02_f64.powi(k);
            let bands = Bands::up_to(most);
            assert!((8..=10).contains(&bands.count), "{most}: {bands:?}");
            let top = bands.count as f64 * bands.step;
            assert!(most <= top * (1.0 + 1e-6) && top - most < bands.step, "{most}: {bands:?}");
            assert_eq!((bands.of(0.0), bands.of(most)), (0, bands.count - 1));
        }
        assert_eq!([0.0, -1.0, f64::NAN].map(|most| Bands::up_to(most).count), [0; 3]);
    }

    #[test]
    fn limits_are_round_and_belong_to_the_band_below() {
        let bands = Bands::up_to(10.0);
        assert_eq!((bands.step, bands.count), (1.0, 10));
        assert_eq!([0.5, 1.0, 1.1, 9.9, 10.0, 10.000_001].map(|value| bands.of(value)), [0, 0, 1, 9, 9, 9]);
        let mut svg = Svg::new([100.0, 100.0]);
        Bands::up_to(11.9).draw_bar(&mut svg, 0.0, [0.0, 200.0], "MPa");
        let svg = svg.finish();
        let numbers: Vec<&str> = svg.lines().filter(|line| !line.starts_with('<')).collect();
        assert_eq!(
            numbers,
            ["0", "1.25", "2.50", "3.75", "5.00", "6.25", "7.50", "8.75", "10.00", "11.25", "12.50", "MPa"]
        );
    }

    #[test]
    fn colours_grow_lighter() {
        for most in [8.0, 9.0, 10.0] {
            let bands = Bands::up_to(most);
            let light = |band: usize| {
                bands.colour(band).map(u32::from).into_iter().zip([3, 6, 1]).map(|(c, w)| c * w).sum::<u32>()
            };
            assert!((1..bands.count).all(|band| light(band) > light(band - 1)), "{bands:?}");
        }
    }
}
