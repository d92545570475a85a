//! Integration rules on reference cells.

/// Points of a reference cell, each with its weight.
pub(super) type Rule = Vec<([f64; 3], f64)>;

/// 1/√3.
const A: f64 = 0.577_350_269_189_625_8;

/// 2 × 2 × 2 Gauss points on [-1, 1]³, corner by corner; the points of a square are the first four.
const GAUSS: [[f64; 3]; 8] =
    [[-A, -A, -A], [A, -A, -A], [A, A, -A], [-A, A, -A], [-A, -A, A], [A, -A, A], [A, A, A], [-A, A, A]];

pub(super) fn triangle1() -> Rule {
    vec![([1.0 / 3.0, 1.0 / 3.0, 0.0], 0.5)]
}

pub(super) fn square4() -> Rule {
    GAUSS[..4].iter().map(|&[xi, eta, _]| ([xi, eta, 0.0], 1.0)).collect()
}

pub(super) fn tetrahedron1() -> Rule {
    vec![([0.25; 3], 1.0 / 6.0)]
}

pub(super) fn cube8() -> Rule {
    GAUSS.iter().map(|&point| (point, 1.0)).collect()
}

/// Three Gauss points on [-1, 1].
pub(crate) const GAUSS3: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 0.555_555_555_555_555_6),
    (0.0, 0.888_888_888_888_888_8),
    (0.774_596_669_241_483_4, 0.555_555_555_555_555_6),
];

/// Three Gauss points on [0, 1].
pub(crate) const UNIT_GAUSS3: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 0.277_777_777_777_777_8),
    (0.5, 0.444_444_444_444_444_4),
    (0.887_298_334_620_741_7, 0.277_777_777_777_777_8),
];

/// Returns a rule that is exact for degree 5 along both axes.
pub(super) fn square9() -> Rule {
    let row = |(eta, w_eta): (f64, f64)| GAUSS3.map(|(xi, w_xi)| ([xi, eta, 0.0], w_xi * w_eta));
    GAUSS3.into_iter().flat_map(row).collect()
}

/// Returns the points of a plane rule at three heights.
fn layers(plane: &Rule) -> Rule {
    let layer = |(zeta, w_zeta): (f64, f64)| plane.iter().map(move |&([xi, eta, _], w)| ([xi, eta, zeta], w * w_zeta));
    GAUSS3.into_iter().flat_map(layer).collect()
}

/// Returns a rule that is exact for degree 5 along each axis.
pub(super) fn cube27() -> Rule {
    layers(&square9())
}

/// Returns a rule that is exact for degree 4 across the axis and 5 along it.
pub(super) fn prism18() -> Rule {
    layers(&triangle6())
}

fn near_corner(k: usize, near: f64, far: f64) -> [f64; 3] {
    [0, 1, 2].map(|c| if c == k { near } else { far })
}

/// Returns a rule that is exact for quadratic polynomials.
pub(super) fn triangle3() -> Rule {
    (0..3)
        .map(|k| {
            let [xi, eta, _] = near_corner(k, 2.0 / 3.0, 1.0 / 6.0);
            ([xi, eta, 0.0], 1.0 / 6.0)
        })
        .collect()
}

/// Returns a rule that is exact for polynomials that are quadratic across the axis and cubic along it.
pub(super) fn prism6() -> Rule {
    let above = |zeta: f64| triangle3().into_iter().map(move |([xi, eta, _], weight)| ([xi, eta, zeta], weight));
    above(-A).chain(above(A)).collect()
}

/// Returns a rule with positive weights that is exact for degree 4 (Cowper, Int. J. Numer. Meth. Engng 7 (1973) 405).
pub(super) fn triangle6() -> Rule {
    let orbits =
        [(0.445_948_490_915_964_9, 0.111_690_794_839_005_74), (0.091_576_213_509_770_74, 0.054_975_871_827_660_935)];
    let orbit = |(far, weight): (f64, f64)| {
        (0..3).map(move |k| {
            let [xi, eta, _] = near_corner(k, 1.0 - 2.0 * far, far);
            ([xi, eta, 0.0], weight)
        })
    };
    orbits.into_iter().flat_map(orbit).collect()
}

/// Returns a rule that is exact for quadratic polynomials.
pub(super) fn tetrahedron4() -> Rule {
    let far = (5.0 - 5.0_f64.sqrt()) / 20.0;
    (0..4).map(|k| (near_corner(k, 1.0 - 3.0 * far, far), 1.0 / 24.0)).collect()
}

/// Returns a rule with positive weights that is exact for cubic polynomials.
pub(super) fn tetrahedron8() -> Rule {
    conical(CONICAL2)
}

/// Returns a rule with positive weights that is exact for degree 5.
pub(super) fn tetrahedron27() -> Rule {
    conical(CONICAL3)
}

/// Points on [0, 1] and weights of Gauss-Jacobi rules for `∫ f(x) (1 - x)^k dx`, k = 0, 1, 2.
type Conical<const N: usize> = [[(f64, f64); N]; 3];

const CONICAL2: Conical<2> = [
    [(0.211_324_865_405_187_1, 0.5), (0.788_675_134_594_812_9, 0.5)],
    [(0.155_051_025_721_682_2, 0.318_041_381_743_977_17), (0.644_948_974_278_317_8, 0.181_958_618_256_022_83)],
    [(0.122_514_822_655_441_38, 0.232_547_451_253_507_9), (0.544_151_844_011_225_3, 0.100_785_882_079_825_43)],
];

const CONICAL3: Conical<3> = [
    UNIT_GAUSS3,
    [
        (0.088_587_959_512_703_94, 0.200_931_913_738_959_63),
        (0.409_466_864_440_734_7, 0.229_241_106_359_586_25),
        (0.787_659_461_760_847, 0.069_826_979_901_454_12),
    ],
    [
        (0.072_994_024_073_149_73, 0.157_136_361_064_886_63),
        (0.347_003_766_038_351_87, 0.146_246_269_259_866_03),
        (0.705_002_209_888_498_4, 0.029_950_703_008_580_697),
    ],
];

/// Returns the product of these rules on the unit cube, mapped to the tetrahedron: along ζ, then along η and ξ in the
/// remaining ranges.
fn conical<const N: usize>([first, second, third]: Conical<N>) -> Rule {
    let mut rule = Vec::with_capacity(N * N * N);
    for (z, w_z) in third {
        for (y, w_y) in second {
            for (x, w_x) in first {
                let eta = y * (1.0 - z);
                rule.push(([x * (1.0 - z - eta), eta, z], w_x * w_y * w_z));
            }
        }
    }
    rule
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `∫ ξ^a η^b ζ^c` over the reference simplex is `a! b! c! / (a + b + c + d)!`.
    #[test]
    fn rules_are_exact_up_to_their_degrees() {
        let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
        let rules: [(usize, i32, Rule); 7] = [
            (2, 1, triangle1()),
            (2, 2, triangle3()),
            (2, 4, triangle6()),
            (3, 1, tetrahedron1()),
            (3, 2, tetrahedron4()),
            (3, 3, tetrahedron8()),
            (3, 5, tetrahedron27()),
        ];
        for (dimension, degree, rule) in rules {
            assert!(rule.iter().all(|(_, weight)| *weight > 0.0));
            let powers = |most: i32| (0..=most).flat_map(move |a| (0..=most - a).map(move |b| (a, b)));
            for ((a, b), c) in powers(degree).flat_map(|(a, b)| (0..=degree - a - b).map(move |c| ((a, b), c))) {
                if dimension == 2 && c > 0 {
                    continue;
                }
                let exact = factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + dimension as i32);
                let sum: f64 = rule.iter().map(|([x, y, z], w)| w * x.powi(a) * y.powi(b) * z.powi(c)).sum();
                assert!((sum - exact).abs() < 1e-15, "{dimension} {degree}: ({a}, {b}, {c}) {sum} {exact}");
            }
        }
    }

    /// `∫ ξ^a η^b ζ^c` is a product of `2 / (a + 1)` for even exponents.
    #[test]
    fn products_are_exact_up_to_their_degrees() {
        let along = |a: i32| if a % 2 == 0 { 2.0 / f64::from(a + 1) } else { 0.0 };
        for (a, b, c) in (0..6).flat_map(|a| (0..6).flat_map(move |b| (0..6).map(move |c| (a, b, c)))) {
            let sum = |rule: Rule| rule.iter().map(|([x, y, z], w)| w * x.powi(a) * y.powi(b) * z.powi(c)).sum::<f64>();
            assert!((sum(cube27()) - along(a) * along(b) * along(c)).abs() < 1e-14);
            if c == 0 {
                assert!((sum(square9()) - along(a) * along(b)).abs() < 1e-14);
            }
            if a + b <= 4 {
                let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
                let triangle = factorial(a) * factorial(b) / factorial(a + b + 2);
                assert!((sum(prism18()) - triangle * along(c)).abs() < 1e-15);
            }
        }
    }
}
