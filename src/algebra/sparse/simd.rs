//! Packs of four vectors, so that a matrix or its factors are read only once for all of them.

use pulp::{Arch, Simd, WithSimd};

use super::Symmetric;

/// The number of vectors in a pack, which suits the registers of every processor.
pub const LANES: usize = 4;

/// The entries of the packed vectors at one place.
pub type SimdPack = [f64; LANES];

/// Packs up to four vectors of length `n`; missing vectors are 0.
pub fn side_by_side<'a>(n: usize, vectors: impl IntoIterator<Item = &'a [f64]>) -> Vec<SimdPack> {
    let mut lanes = vec![[0.0; LANES]; n];
    for (k, vector) in vectors.into_iter().take(LANES).enumerate() {
        lanes.iter_mut().zip(vector).for_each(|(lanes, value)| lanes[k] = *value);
    }
    lanes
}

/// Returns vector `k` of a pack.
pub fn lane(lanes: &[SimdPack], k: usize) -> Vec<f64> {
    lanes.iter().map(|lanes| lanes[k]).collect()
}

impl Symmetric {
    /// Computes `A x` and `|A| |x|` for four vectors `x`. Each result equals that of a single vector.
    pub(crate) fn products(&self, x: &[SimdPack]) -> (Vec<SimdPack>, Vec<SimdPack>) {
        Arch::new().dispatch(Products { of: self, x })
    }
}

/// The products, compiled for each kind of processor, with the same result.
struct Products<'a> {
    of: &'a Symmetric,
    x: &'a [SimdPack],
}

impl WithSimd for Products<'_> {
    type Output = (Vec<SimdPack>, Vec<SimdPack>);

    #[allow(clippy::inline_always)] // Only inlined code is compiled for more than the oldest processor.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let (of, x) = (self.of, self.x);
        let lower = of.lower();
        let (pattern, values) = (lower.pattern(), lower.values());
        let (mut products, mut sizes) = (vec![[0.0; LANES]; x.len()], vec![[0.0; LANES]; x.len()]);
        let add =
            |to: &mut SimdPack, value: f64, x: &SimdPack| to.iter_mut().zip(x).for_each(|(to, x)| *to += value * x);
        let add_size = |to: &mut SimdPack, value: f64, x: &SimdPack| {
            to.iter_mut().zip(x).for_each(|(to, x)| *to += (value * x).abs());
        };
        for column in 0..of.order() {
            let slots = pattern.column(column);
            let (mut product, mut size) = ([0.0; LANES], [0.0; LANES]);
            for (&row, &value) in pattern.row_indices()[slots.clone()].iter().zip(&values[slots]) {
                let row = row as usize;
                add(&mut products[row], value, &x[column]);
                add_size(&mut sizes[row], value, &x[column]);
                if row != column {
                    add(&mut product, value, &x[row]);
                    add_size(&mut size, value, &x[row]);
                }
            }
            add(&mut products[column], 1.0, &product);
            add(&mut sizes[column], 1.0, &size);
        }
        (products, sizes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_products_are_those_of_each_alone() {
        let entries = (0..7).flat_map(|i| (0..=i).map(move |j| (i, j, f64::from(1 + (3 * i + 5 * j) % 7) / 3.0)));
        let entries: Vec<_> = entries.map(|(i, j, value)| (i as usize, j as usize, value)).collect();
        let a = Symmetric::from_triplets(7, &entries).unwrap();
        let x: Vec<Vec<f64>> = (0..3).map(|k| (0..7).map(|i| f64::from(i * i - 3 * k).sin()).collect()).collect();
        let (products, sizes) = a.products(&side_by_side(7, x.iter().map(Vec::as_slice)));
        for (k, x) in x.iter().enumerate() {
            let (mut product, mut size) = (vec![0.0; 7], vec![0.0; 7]);
            a.mul(x, &mut product);
            a.add_sizes(x, &mut size);
            assert_eq!((lane(&products, k), lane(&sizes, k)), (product, size));
        }
        assert_eq!(lane(&products, LANES - 1), [0.0; 7]);
    }
}
