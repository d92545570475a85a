//! Complementary pairs, the largest feasible steps, and the faces on which one member of each pair vanishes.

/// Two unknowns of which at least one vanishes in the solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    /// The place of `p_n` or `s`, a force.
    pub force: usize,
    /// The place of `v_n` or `λ`, a length; also the row of the product.
    pub length: usize,
}

impl Pair {
    /// Returns the product at `z + t dz`.
    pub fn product_ahead(&self, z: &[f64], dz: &[f64], t: f64) -> f64 {
        let at = |k: usize| z[k] + t * dz[k];
        at(self.force) * at(self.length)
    }
}

/// The face of a solution: `true` for each pair, in their order, if the force vanishes, `false` if the length does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Face(Vec<bool>);

impl Face {
    /// Creates the face on which, for each pair, the force vanishes if `force_vanishes`, and else the length.
    pub(super) fn new(force_vanishes: Vec<bool>) -> Self {
        Face(force_vanishes)
    }

    /// Returns a point of length `unknowns` in the relative interior of the face. The linearised products at this
    /// point set the vanishing member of each of the `pairs` to zero.
    pub fn point(&self, pairs: &[Pair], unknowns: usize) -> Vec<f64> {
        let mut point = vec![0.0; unknowns];
        for (pair, &force_vanishes) in pairs.iter().zip(&self.0) {
            point[if force_vanishes { pair.length } else { pair.force }] = 1.0;
        }
        point
    }

    /// Computes the right-hand side of the step from `z` (with residual `h`) to the face: `-h`, and in the rows of
    /// the products the vanishing member.
    pub fn towards(&self, pairs: &[Pair], z: &[f64], h: &[f64], b: &mut [f64]) {
        b.iter_mut().zip(h).for_each(|(b, h)| *b = -h);
        for (pair, &force_vanishes) in pairs.iter().zip(&self.0) {
            b[pair.length] = -z[if force_vanishes { pair.force } else { pair.length }];
        }
    }
}

/// Returns the largest step for which all `pairs` of `z + t dz` are nonnegative; infinite if there is no largest.
pub fn largest_step(pairs: &[Pair], z: &[f64], dz: &[f64]) -> f64 {
    least(pairs.iter().flat_map(|pair| [pair.force, pair.length]).map(|k| reach(z[k], dz[k])))
}

/// Returns the largest step for which a positive `value` stays nonnegative along its `change`.
pub(super) fn reach(value: f64, change: f64) -> f64 {
    if change < 0.0 { -value / change } else { f64::INFINITY }
}

/// Returns the smallest of the `steps`. `f64::min` would lose a NaN.
pub(super) fn least(steps: impl Iterator<Item = f64>) -> f64 {
    steps.fold(f64::INFINITY, |least, step| if step < least || step.is_nan() { step } else { least })
}
