//! Colour differences between two CIELAB colours: ΔE\*ab (1976) and ΔE00 (CIEDE2000).

use crate::Real;
use crate::lanes::Lanes;

/// The CIE 1976 colour difference ΔE\*ab of two colours (L\*, a\*, b\*).
///
/// The Euclidean distance. Exactly symmetric; 0 for equal colours; accurate to 3 ε relative, the colours being
/// taken as exact. Differences whose square overflows (above 1e19 in `f32`, 1e154 in `f64`) give ∞, those whose square
/// underflows (below 1e-19, 1e-154) lose accuracy or give 0. NaN in, NaN out.
///
/// Source: ISO/CIE 11664-4:2019.
#[inline]
#[must_use]
pub fn delta_e_ab<R: Real>(first: [R; 3], second: [R; 3]) -> R {
    let [l, a, b] = [second[0] - first[0], second[1] - first[1], second[2] - first[2]];
    (l * l + a * a + b * b).sqrt()
}

/// The CIEDE2000 colour difference ΔE00 of two colours (L\*, a\*, b\*), with unit parametric factors.
///
/// Fitted to differences of surface colours up to about 5 units; larger values order colours, no more. Exactly
/// symmetric, unless products of a\* and b\* underflow; in `f64` within 1e-13 relative of the standard's own steps, plus 1e-15 of the chromas. Computed without
/// angles, from the vectors of the hues. The formula jumps where two hues are 180° apart, by up to a few percent; exactly opposite hues take the
/// branch that the standard prescribes, and elsewhere `f32` is within 1e-4 + 1e-5 ΔE00 of `f64` for colours with |a\*|,
/// |b\*| ≤ 128. Finite for |a\*|, |b\*| up to 1e9 in `f32`, 1e100 in `f64`, and |L\*| up to 1e9 and 1e50. NaN in, NaN out.
///
/// Source: CIE 142-2001, ISO/CIE 11664-6:2014, in the form of Sharma, Wu and Dalal, "The CIEDE2000 color-difference
/// formula: implementation notes, supplementary test data, and mathematical observations", Color Research and
/// Application 30 (2005), 21–30, equations 2 to 22.
///
/// ```
/// use spectral_core::colour::delta_e_00;
/// let difference: f64 = delta_e_00([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485]);
/// assert!((difference - 2.0425).abs() <= 5e-5);
/// ```
#[inline]
#[must_use]
pub fn delta_e_00<R: Real>(first: [R; 3], second: [R; 3]) -> R {
    delta_e_00_weighted(first, second, [R::ONE; 3])
}

/// [`delta_e_00`] with the parametric factors `[k_L, k_C, k_H]` of the viewing conditions, which must be positive;
/// textiles are often compared with `k_L` = 2.
#[must_use]
pub fn delta_e_00_weighted<R: Real>(first: [R; 3], second: [R; 3], factors: [R; 3]) -> R {
    let single = |lab: [R; 3]| lab.map(|c| Lanes([c]));
    differences(&single(first), &single(second), factors).0[0]
}

/// ΔE00 of `W` pairs at once, each as [`delta_e_00_weighted`] to the bit.
///
/// Here and below what is marked as not to be inlined is a stage of its own: compilers find the vector instructions in
/// short functions between memory and memory.
pub(crate) fn differences<R: Real, const W: usize>(
    first: &[Lanes<R, W>; 3],
    second: &[Lanes<R, W>; 3],
    factors: [R; 3],
) -> Lanes<R, W> {
    let stretch = chroma_stretch(first, second);
    let (p, q) = (Polar::new(first, &stretch), Polar::new(second, &stretch));
    let hue = Hue::between(&p, &q);
    let mean_chroma = (p.chroma + q.chroma) * Lanes::constant(0.5);
    let rotation = hue.rotation() * saturation(&mean_chroma);
    let square = Scales::new([first[0], second[0]], &mean_chroma, &hue.dependence(), factors).square(
        &(second[0] - first[0]),
        &(q.chroma - p.chroma),
        &hue.difference,
        &rotation,
    );
    square.sqrt()
}

/// k_L S_L, k_C S_C and k_H S_H, the first one times √(20 + (L̄ − 50)²).
struct Scales<R, const W: usize> {
    root: Lanes<R, W>,
    lightness: Lanes<R, W>,
    chroma: Lanes<R, W>,
    hue: Lanes<R, W>,
}

impl<R: Real, const W: usize> Scales<R, W> {
    /// From lightnesses, mean chroma and T.
    #[inline(never)]
    fn new([first, second]: [Lanes<R, W>; 2], chroma: &Lanes<R, W>, t: &Lanes<R, W>, [k_l, k_c, k_h]: [R; 3]) -> Self {
        let constant = Lanes::<R, W>::constant;
        let offset = (first + second) * constant(0.5) - constant(50.0);
        let square = offset * offset;
        let root = (constant(20.0) + square).sqrt();
        Self {
            root,
            lightness: Lanes::all(k_l) * (root + constant(0.015) * square),
            chroma: Lanes::all(k_c) * (constant(1.0) + constant(0.045) * *chroma),
            hue: Lanes::all(k_h) * (constant(1.0) + constant(0.015) * *chroma * *t),
        }
    }

    /// The square of ΔE00 from the differences (equation 22), with one division for three quotients.
    #[inline(never)]
    fn square(
        &self,
        lightness: &Lanes<R, W>,
        chroma: &Lanes<R, W>,
        hue: &Lanes<R, W>,
        rotation: &Lanes<R, W>,
    ) -> Lanes<R, W> {
        let chroma_hue = self.chroma * self.hue;
        let inverse = Lanes::constant(1.0) / (self.lightness * chroma_hue);
        let lightness = *lightness * self.root * chroma_hue * inverse;
        let chroma = *chroma * (self.lightness * self.hue) * inverse;
        let hue = *hue * (self.lightness * self.chroma) * inverse;
        let square = lightness * lightness + chroma * chroma + hue * hue - *rotation * chroma * hue;
        // The quadratic form is positive definite (|rotation| < 2), so that only rounding can take it below zero; and
        // `max` keeps NaN when it is the second operand.
        square.map(|square| R::ZERO.max(square))
    }
}

/// A colour's a′, b′ and chroma C′.
struct Polar<R, const W: usize> {
    a: Lanes<R, W>,
    b: Lanes<R, W>,
    chroma: Lanes<R, W>,
}

impl<R: Real, const W: usize> Polar<R, W> {
    /// Equations 5 and 6.
    fn new(lab: &[Lanes<R, W>; 3], stretch: &Lanes<R, W>) -> Self {
        let a = lab[1] * *stretch;
        Self { a, b: lab[2], chroma: chroma(&a, &lab[2]) }
    }
}

/// The hue difference ΔH′, in units of chroma, and cosine and sine of the mean hue.
struct Hue<R, const W: usize> {
    difference: Lanes<R, W>,
    cosine: Lanes<R, W>,
    sine: Lanes<R, W>,
}

impl<R: Real, const W: usize> Hue<R, W> {
    /// Equations 7, 10, 11 and 14 without angles.
    ///
    /// The mean hue is that of the bisector of the shorter arc. With unit vectors u, v of the two hues and half their
    /// difference β it is the direction of u + v, of length 2 cos β, or that of v − u, of length 2 |sin β|, turned by 90°;
    /// the longer one is taken. The same lengths give ΔH′ = 2 √(C′₁ C′₂) sin β. Vectors are scaled by C′₁ C′₂.
    fn between(p: &Polar<R, W>, q: &Polar<R, W>) -> Self {
        let pair = Pair::new(p, q);
        let (scale, length) = (pair.product.sqrt(), pair.length.sqrt());
        pair.hue(&scale, &length, &pair.bisector(p, q), &(p.chroma + q.chroma))
    }

    /// T (equation 15): cosines of the multiples of the mean hue.
    #[inline(never)]
    fn dependence(&self) -> Lanes<R, W> {
        let constant = Lanes::<R, W>::constant;
        let (one, two) = (constant(1.0), constant(2.0));
        let (c1, s1) = (self.cosine, self.sine);
        let (c2, s2) = (two * c1 * c1 - one, two * s1 * c1);
        let (c3, s3) = (c2 * c1 - s2 * s1, s2 * c1 + c2 * s1);
        let (c4, s4) = (two * c2 * c2 - one, two * s2 * c2);
        let wave = |amplitude: f64, [cosine, sine]: [f64; 2], c, s| {
            constant(amplitude * cosine) * c - constant(amplitude * sine) * s
        };
        one - wave(0.17, [0.866_025_403_784_438_6, -0.5], c1, s1)
            + constant(0.24) * c2
            + wave(0.32, [0.994_521_895_368_273_3, 0.104_528_463_267_653_47], c3, s3)
            - wave(0.20, [0.453_990_499_739_546_8, -0.891_006_524_188_367_9], c4, s4)
    }

    /// 2 sin 2Δθ: the coupling of chroma and hue differences among blues, −R_T without the factor R_C (equations 16 and 21).
    ///
    /// The standard's Gaussian is of a hue in [0°, 360°) and is not periodic: in the first quadrant, to which it would
    /// come round, it is below 1e-23.
    #[inline(never)]
    fn rotation(&self) -> Lanes<R, W> {
        let constant = Lanes::<R, W>::constant;
        let [cosine, sine] = [0.087_155_742_747_658_17, -0.996_194_698_091_745_5];
        let gauss = (constant(cosine) * self.cosine + constant(sine) * self.sine).polynomial(&GAUSSIAN);
        let value = constant(2.0) * gauss * (gauss * gauss).polynomial(&SINE);
        // Of neither −0 nor 0 is the smaller one below −MIN_POSITIVE.
        self.cosine.lesser(self.sine).if_above(-R::MIN_POSITIVE, Lanes::ZERO, value)
    }
}

/// What the mean hue and the hue difference of two colours are made of.
struct Pair<R, const W: usize> {
    /// C′₁ C′₂.
    product: Lanes<R, W>,
    cross: Lanes<R, W>,
    dot: Lanes<R, W>,
    /// 1 where the second hue is ahead of the first one by less than 180°, −1 where it is behind.
    side: Lanes<R, W>,
    /// The square of 2 √(C′₁ C′₂) times the larger one of cos β and |sin β|.
    length: Lanes<R, W>,
}

impl<R: Real, const W: usize> Pair<R, W> {
    #[inline(never)]
    fn new(p: &Polar<R, W>, q: &Polar<R, W>) -> Self {
        let product = p.chroma * q.chroma;
        let cross = p.a * q.b - q.a * p.b;
        let dot = p.a * q.a + p.b * q.b;
        // Of exactly opposite hues the standard takes the one in [180°, 360°) as that ahead. Otherwise the cross product
        // tells: rounded angles of nearly opposite hues could differ by a little more or less than 180°, and the formula
        // jumps there.
        let (zero, one) = (Lanes::ZERO, Lanes::all(R::ONE));
        let ahead = |value: Lanes<R, W>, tie| value.if_above(R::ZERO, one, (-value).if_above(R::ZERO, zero - one, tie));
        let side = ahead(cross, ahead(p.b, ahead(p.a, zero - one)));
        Self { product, cross, dot, side, length: (product + dot.abs()) * Lanes::constant(2.0) }
    }

    /// The direction of the mean hue.
    #[inline(never)]
    fn bisector(&self, p: &Polar<R, W>, q: &Polar<R, W>) -> [Lanes<R, W>; 2] {
        let (pa, pb) = (p.a * q.chroma, p.b * q.chroma);
        let (qa, qb) = (q.a * p.chroma, q.b * p.chroma);
        let near = [pa + qa, pb + qb];
        let far = [self.side * (qb - pb), self.side * (pa - qa)];
        // A grey has no hue: the mean is then the other's hue.
        let grey = [p.a + q.a, p.b + q.b];
        core::array::from_fn(|c| {
            self.product.if_above(R::MIN_POSITIVE, self.dot.if_above(R::ZERO, near[c], far[c]), grey[c])
        })
    }

    /// From the square roots of `product` and `length`, the bisector, and the sum of the chromas.
    #[inline(never)]
    fn hue(
        &self,
        scale: &Lanes<R, W>,
        length: &Lanes<R, W>,
        [x, y]: &[Lanes<R, W>; 2],
        sum: &Lanes<R, W>,
    ) -> Hue<R, W> {
        let one = Lanes::all(R::ONE);
        let norm = self.product.if_above(R::MIN_POSITIVE, *scale * *length, *sum);
        // The mean hue of two greys is 0.
        let x = norm.if_above(R::ZERO, *x, one);
        let inverse = one / norm.if_above(R::ZERO, norm, one);
        let near = self.cross * Lanes::constant(2.0) * *scale * inverse;
        let difference = self.dot.if_above(R::ZERO, near, self.side * *length);
        Hue { difference, cosine: x * inverse, sine: *y * inverse }
    }
}

/// 1 + G: the stretch of the a\* axis near grey (equations 2 to 5).
fn chroma_stretch<R: Real, const W: usize>(first: &[Lanes<R, W>; 3], second: &[Lanes<R, W>; 3]) -> Lanes<R, W> {
    let mean = (chroma(&first[1], &first[2]) + chroma(&second[1], &second[2])) * Lanes::constant(0.5);
    Lanes::constant(1.5) - Lanes::constant(0.5) * saturation(&mean)
}

/// √(a² + b²).
#[inline(never)]
fn chroma<R: Real, const W: usize>(a: &Lanes<R, W>, b: &Lanes<R, W>) -> Lanes<R, W> {
    (*a * *a + *b * *b).sqrt()
}

/// √(C⁷ / (C⁷ + 25⁷)); from C = 10⁴ on, where C⁷ might overflow, it is 1 to rounding.
#[inline(never)]
fn saturation<R: Real, const W: usize>(chroma: &Lanes<R, W>) -> Lanes<R, W> {
    let chroma = chroma.lesser(Lanes::constant(1e4));
    let cube = chroma * chroma * chroma;
    let seventh = cube * cube * chroma;
    (seventh / (seventh + Lanes::constant(6_103_515_625.0))).sqrt()
}

/// exp(−(θ / 25°)²) as a polynomial in cos θ, within 4 ε on [−1, 1] as computed in `f64`.
///
/// The truncated Chebyshev series in powers: it converges fast since θ² is an analytic function of cos θ but for
/// θ = 180°, where the exponential is 3e-23. All coefficients are positive and their sum is 1, so that rounding stays small.
const GAUSSIAN: [[f64; 2]; 14] = [
    [2.352_575_199_994_513_7e-6, 3.882_027_743_057_913e-5],
    [0.000_307_933_401_977_766_86, 0.001_564_289_921_957_133_6],
    [0.005_720_404_184_521_16, 0.016_048_785_969_893_45],
    [0.035_951_340_614_857_96, 0.066_084_161_358_816_35],
    [0.101_661_545_430_728_79, 0.132_843_738_794_089_37],
    [0.149_159_349_489_681_96, 0.145_228_398_044_426_3],
    [0.123_523_069_362_874_24, 0.092_334_607_373_778_81],
    [0.060_964_049_974_088_9, 0.035_701_932_422_800_64],
    [0.018_610_452_053_347_326, 0.008_661_305_546_062_968],
    [0.003_607_610_639_118_238, 0.001_347_311_189_812_375_4],
    [0.000_452_472_428_742_288_73, 0.000_137_265_063_315_649_08],
    [3.734_117_385_561_352e-5, 8.886_691_006_752_573e-6],
    [1.990_875_149_603_400_7e-6, 4.973_466_094_053_569e-7],
    [8.779_585_612_243_098e-8, 0.0],
];

/// sin(60° x) / x as a polynomial in x², such that sin(60° x) is within 4 ε on [−1, 1] as computed in `f64`.
const SINE: [[f64; 2]; 4] = [
    [1.047_197_551_196_597_6, -0.191_396_769_631_462_38],
    [0.010_494_502_221_429_313, -0.000_274_012_128_732_233_44],
    [4.173_438_461_589_499_6e-6, -4.159_903_234_733_966e-8],
    [2.871_773_151_581_584_5e-10, 0.0],
];

#[cfg(test)]
#[path = "delta_e_by_angles.rs"]
mod by_angles;

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "exact values are what is stated")]
mod tests {
    use super::*;
    use crate::colour::in_precision;

    /// `published`: Sharma, Wu and Dalal 2005, table 1: two colours and ΔE00 rounded to four decimals.
    #[rustfmt::skip]
    const SHARMA: [([f64; 3], [f64; 3], f64); 34] = [
        ([50.0, 2.677_2, -79.775_1], [50.0, 0.0, -82.748_5], 2.042_5),
        ([50.0, 3.157_1, -77.280_3], [50.0, 0.0, -82.748_5], 2.861_5),
        ([50.0, 2.836_1, -74.02], [50.0, 0.0, -82.748_5], 3.441_2),
        ([50.0, -1.380_2, -84.281_4], [50.0, 0.0, -82.748_5], 1.0),
        ([50.0, -1.184_8, -84.800_6], [50.0, 0.0, -82.748_5], 1.0),
        ([50.0, -0.900_9, -85.521_1], [50.0, 0.0, -82.748_5], 1.0),
        ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.366_9),
        ([50.0, -1.0, 2.0], [50.0, 0.0, 0.0], 2.366_9),
        ([50.0, 2.49, -0.001], [50.0, -2.49, 0.000_9], 7.179_2),
        ([50.0, 2.49, -0.001], [50.0, -2.49, 0.001], 7.179_2),
        ([50.0, 2.49, -0.001], [50.0, -2.49, 0.001_1], 7.219_5),
        ([50.0, 2.49, -0.001], [50.0, -2.49, 0.001_2], 7.219_5),
        ([50.0, -0.001, 2.49], [50.0, 0.000_9, -2.49], 4.804_5),
        ([50.0, -0.001, 2.49], [50.0, 0.001, -2.49], 4.804_5),
        ([50.0, -0.001, 2.49], [50.0, 0.001_1, -2.49], 4.746_1),
        ([50.0, 2.5, 0.0], [50.0, 0.0, -2.5], 4.306_5),
        ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.149_2),
        ([50.0, 2.5, 0.0], [61.0, -5.0, 29.0], 22.897_7),
        ([50.0, 2.5, 0.0], [56.0, -27.0, -3.0], 31.903),
        ([50.0, 2.5, 0.0], [58.0, 24.0, 15.0], 19.453_5),
        ([50.0, 2.5, 0.0], [50.0, 3.173_6, 0.585_4], 1.0),
        ([50.0, 2.5, 0.0], [50.0, 3.297_2, 0.0], 1.0),
        ([50.0, 2.5, 0.0], [50.0, 1.863_4, 0.575_7], 1.0),
        ([50.0, 2.5, 0.0], [50.0, 3.259_2, 0.335], 1.0),
        ([60.257_4, -34.009_9, 36.267_7], [60.462_6, -34.175_1, 39.438_7], 1.264_4),
        ([63.010_9, -31.096_1, -5.866_3], [62.818_7, -29.794_6, -4.086_4], 1.263),
        ([61.290_1, 3.719_6, -5.390_1], [61.429_2, 2.248, -4.962], 1.873_1),
        ([35.083_1, -44.116_4, 3.793_3], [35.023_2, -40.071_6, 1.590_1], 1.864_5),
        ([22.723_3, 20.090_4, -46.694], [23.033_1, 14.973, -42.561_9], 2.037_3),
        ([36.461_2, 47.858, 18.385_2], [36.271_5, 50.506_5, 21.223_1], 1.414_6),
        ([90.802_7, -2.083_1, 1.441], [91.152_8, -1.643_5, 0.044_7], 1.444_1),
        ([90.925_7, -0.540_6, -0.920_8], [88.638_1, -0.898_5, -0.723_9], 1.538_1),
        ([6.774_7, -0.290_8, -2.424_7], [5.871_4, -0.098_5, -2.228_6], 0.637_7),
        ([2.077_6, 0.079_5, -1.135], [0.903_3, -0.063_6, -0.551_4], 0.908_2),
    ];

    #[test]
    fn reproduces_the_published_pairs() {
        for (first, second, expected) in SHARMA {
            for (p, q) in [(first, second), (second, first)] {
                let actual = delta_e_00(p, q);
                assert!((actual - expected).abs() <= 1e-4, "{p:?} {q:?}: {actual}, published {expected}");
            }
        }
    }

    #[test]
    fn single_precision_reproduces_the_published_pairs() {
        for (first, second, expected) in SHARMA {
            let actual = f64::from(delta_e_00::<f32>(in_precision(first), in_precision(second)));
            // The colours themselves move by up to 4e-6 when rounded.
            assert!((actual - expected).abs() <= 1e-4, "{first:?} {second:?}: {actual}, published {expected}");
        }
    }

    /// A fixed sequence of colours in L\* 0…100, a\* and b\* −128…128, each representable in `f32`.
    fn colours(count: u32) -> impl Iterator<Item = [f64; 3]> {
        let mut state = 1_u64;
        let mut unit = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            f64::from(u16::try_from(state >> 48).unwrap()) / 65_536.0
        };
        (0..count)
            .map(move |_| [100.0 * unit(), 256.0 * unit() - 128.0, 256.0 * unit() - 128.0])
            .map(|lab| lab.map(|c| f64::from(f32::from_f64(c))))
    }

    #[test]
    fn single_precision_is_as_accurate_as_stated() {
        for (first, second) in colours(100_000).zip(colours(100_007).skip(7)) {
            // Near opposite hues the formula jumps.
            if near_opposite(first, second) {
                continue;
            }
            let exact = delta_e_00(first, second);
            let single = f64::from(delta_e_00::<f32>(in_precision(first), in_precision(second)));
            assert!((single - exact).abs() <= 1e-4 + 1e-5 * exact, "{first:?} {second:?}: {single}, exact {exact}");
        }
    }

    /// `independent`: the standard's own steps with angles, for colours far apart, near each other and near grey.
    #[test]
    fn agrees_with_the_form_by_angles() {
        for (first, second) in colours(200_000).zip(colours(200_007).skip(7)) {
            for share in [1.0, 0.1, 1e-3] {
                for size in [1.0, 1e-2] {
                    let first = [first[0], size * first[1], size * first[2]];
                    let second =
                        core::array::from_fn(|i| first[i] + share * ([1.0, size, size][i] * second[i] - first[i]));
                    let factors = [1.0, 1.5, 0.7];
                    let exact = by_angles::delta_e_00_weighted(first, second, factors);
                    let found = delta_e_00_weighted(first, second, factors);
                    // Rounded hues make ΔH′ uncertain by some ε of the chroma, however small the difference is.
                    assert!(
                        (found - exact).abs() <= 1e-13 * (exact + 10.0 * size),
                        "{first:?} {second:?}: {found}, {exact}"
                    );
                    assert_eq!(found, delta_e_00_weighted(second, first, factors));
                }
            }
        }
    }

    #[test]
    fn special_pairs_agree_with_the_form_by_angles() {
        let hues = [
            [1.0, 0.0],
            [1.0, -0.0],
            [0.0, 1.0],
            [-0.0, 1.0],
            [-1.0, 0.0],
            [-1.0, -0.0],
            [0.0, -1.0],
            [-0.0, -1.0],
            [0.0, 0.0],
            [-0.0, -0.0],
            [3.0, 4.0],
            [-3.0, -4.0],
            [3.0, -4.0],
            [-3.0, 4.0],
            [1e-200, 1e-200],
            [-1e-170, 1e-150],
        ];
        for first in hues {
            for second in hues {
                for scale in [1.0, 12.0] {
                    let (p, q) = ([50.0, first[0], first[1]], [55.0, scale * second[0], scale * second[1]]);
                    let (found, exact) = (delta_e_00(p, q), by_angles::delta_e_00_weighted(p, q, [1.0; 3]));
                    assert!((found - exact).abs() <= 1e-13 * exact, "{p:?} {q:?}: {found}, {exact}");
                    assert_eq!(found, delta_e_00(q, p), "{p:?} {q:?}");
                }
            }
        }
    }

    #[test]
    fn lockstep_changes_no_bit() {
        let mut pairs = colours(80).zip(colours(87).skip(7));
        while let Some(pair) = pairs.next() {
            let all: [_; 8] = core::array::from_fn(|lane| if lane == 0 { pair } else { pairs.next().unwrap_or(pair) });
            let first = core::array::from_fn(|c| Lanes(all.map(|(first, _)| first[c])));
            let second = core::array::from_fn(|c| Lanes(all.map(|(_, second)| second[c])));
            let found = differences(&first, &second, [1.0; 3]);
            for (found, (first, second)) in found.0.into_iter().zip(all) {
                assert_eq!(found, delta_e_00(first, second));
            }
        }
    }

    /// `independent`: `libm`'s exponential, arc cosine and sine.
    #[test]
    fn polynomials_are_as_accurate_as_stated() {
        for step in -100_000..=100_000 {
            let x = f64::from(step) / 100_000.0;
            let angle = x.acos() / radians(25.0);
            let gauss = Lanes([x]).polynomial(&GAUSSIAN).0[0];
            assert!((gauss - (-(angle * angle)).exp()).abs() <= 4.0 * f64::EPSILON, "{x}: {gauss:e}");
            let sine = x * Lanes([x * x]).polynomial(&SINE).0[0];
            assert!((sine - radians(60.0 * x).sin()).abs() <= 4.0 * f64::EPSILON, "{x}: {sine:e}");
        }
    }

    fn radians(degrees: f64) -> f64 {
        degrees.to_radians()
    }

    fn near_opposite([_, a, b]: [f64; 3], [_, c, d]: [f64; 3]) -> bool {
        let (cross, dot) = (a * d - b * c, a * c + b * d);
        dot < 0.0 && cross.abs() <= 1e-3 * dot.abs()
    }

    /// `independent`: `delta_E` of colour-science 0.4.7, methods CIE 1976 and CIE 2000, on large differences.
    #[test]
    fn agrees_with_colour_science_far_apart() {
        let cases = [
            ([61.29, 3.7, -5.39], [35.08, -44.12, 3.79], 55.299_085_887_562_37, 39.669_667_635_036_84),
            ([20.0, 60.0, -90.0], [22.0, 55.0, -70.0], 20.712_315_177_207_98, 6.143_658_375_562_895),
            ([97.0, -30.0, 80.0], [60.0, 40.0, -80.0], 178.518_906_561_742_08, 84.330_718_035_811_23),
        ];
        for (first, second, ab, ciede) in cases {
            assert!((delta_e_ab(first, second) - ab).abs() <= 4.0 * f64::EPSILON * ab);
            assert!((delta_e_00(first, second) - ciede).abs() <= 1e-12 * ciede);
        }
    }

    #[test]
    fn equal_colours_do_not_differ() {
        for lab in [[0.0; 3], [-0.0; 3], [50.0, -0.0, 0.0], [100.0, -80.0, 1e-320], [1e9, -1e9, 1e9]] {
            assert_eq!(delta_e_ab(lab, lab), 0.0);
            assert_eq!(delta_e_00(lab, lab), 0.0);
        }
    }

    #[test]
    fn a_grey_has_no_hue() {
        // A hue read from the signs of zeros would move the mean hue of these pairs.
        let chromatic = [50.0, 10.0, 20.0];
        let expected = delta_e_00([50.0, 0.0, 0.0], chromatic);
        for grey in [[50.0, -0.0, 0.0], [50.0, 0.0, -0.0], [50.0, -0.0, -0.0]] {
            assert_eq!(delta_e_00(grey, chromatic), expected);
        }
    }

    #[test]
    fn weights_divide_each_part() {
        let doubled = delta_e_00_weighted([40.0, 0.0, 0.0], [60.0, 0.0, 0.0], [2.0, 1.0, 1.0_f64]);
        let single = delta_e_00([40.0, 0.0, 0.0], [60.0, 0.0, 0.0]);
        assert!((single - 20.0).abs() <= 1e-13, "S_L is 1 at L* = 50");
        assert_eq!(doubled, single / 2.0);
    }

    #[test]
    fn huge_and_not_finite_values() {
        let huge = delta_e_00([50.0, 1e9, -1e9_f32], [50.0, -1e9, 1e9]);
        assert!(huge.is_finite() && huge > 0.0, "{huge}");
        let huge = delta_e_00([50.0, 1e100, -1e100_f64], [50.0, -1e100, 1e100]);
        assert!(huge.is_finite() && huge > 0.0, "{huge}");
        assert_eq!(delta_e_ab([1e200, 0.0, 0.0], [0.0; 3]), f64::INFINITY);
        for position in 0..3 {
            for bad in [f64::NAN, f64::INFINITY] {
                let mut lab = [50.0, 10.0, 10.0];
                lab[position] = bad;
                assert!(!delta_e_ab(lab, [50.0; 3]).is_finite());
                assert!(!delta_e_00(lab, [50.0; 3]).is_finite(), "{lab:?}: {}", delta_e_00(lab, [50.0; 3]));
            }
        }
    }
}
