//! Complementary pairs, how far they may go, and which of their members a solution lets vanish.

/// Two unknowns of which one vanishes in the solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    /// The place of `p_n` or `s`, a force.
    pub force: usize,
    /// The place of `v_n` or `λ`, a length, and of the product's row.
    pub length: usize,
}

impl Pair {
    /// The product at `z + t dz`.
    pub fn product_ahead(&self, z: &[f64], dz: &[f64], t: f64) -> f64 {
        let at = |k: usize| z[k] + t * dz[k];
        at(self.force) * at(self.length)
    }
}

/// What every contact node does: for each pair, in their order, whether the force vanishes (else
/// the length does).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Face(Vec<bool>);

impl Face {
    /// The face on which of each pair the force vanishes, where `force_vanishes`, or else the length.
    pub(super) fn new(force_vanishes: Vec<bool>) -> Self {
        Face(force_vanishes)
    }

    /// A point of length `unknowns` in the relative interior of the face, at which the products'
    /// linearisation says which member of each of the `pairs` is to vanish.
    pub fn point(&self, pairs: &[Pair], unknowns: usize) -> Vec<f64> {
        let mut point = vec![0.0; unknowns];
        for (pair, &force_vanishes) in pairs.iter().zip(&self.0) {
            point[if force_vanishes { pair.length } else { pair.force }] = 1.0;
        }
        point
    }

    /// The right-hand side of the step from `z` (with residual `h`) to the face: `-h`, and in the
    /// products the member that is to vanish.
    pub fn towards(&self, pairs: &[Pair], z: &[f64], h: &[f64], b: &mut [f64]) {
        b.iter_mut().zip(h).for_each(|(b, h)| *b = -h);
        for (pair, &force_vanishes) in pairs.iter().zip(&self.0) {
            b[pair.length] = -z[if force_vanishes { pair.force } else { pair.length }];
        }
    }
}

/// The largest step for which all `pairs` of `z + t dz` are at least 0; infinite if there is no largest.
pub fn largest_step(pairs: &[Pair], z: &[f64], dz: &[f64]) -> f64 {
    least(pairs.iter().flat_map(|pair| [pair.force, pair.length]).map(|k| reach(z[k], dz[k])))
}

/// How far a positive `value` may go along its `change`.
pub(super) fn reach(value: f64, change: f64) -> f64 {
    if change < 0.0 { -value / change } else { f64::INFINITY }
}

/// The least of the `steps`; not by `f64::min`, which loses a NaN.
pub(super) fn least(steps: impl Iterator<Item = f64>) -> f64 {
    steps.fold(f64::INFINITY, |least, step| if step < least || step.is_nan() { step } else { least })
}
