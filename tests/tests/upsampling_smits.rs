//! Smits' basis spectra: the printed ones for reflectances, and those for lights, solved for again.
#![allow(clippy::unwrap_used, clippy::needless_range_loop, reason = "helpers of tests; indices as in the formulae")]

use spectral_core::colour::RgbSpace;
use spectral_core::spectrum::{Constant, Spectrum};
use spectral_core::tables::smits;
use spectral_core::upsampling::UpsamplingError;
use spectral_core::upsampling::smits::Basis;
use spectral_core::{Observer, Real, tristimulus};
use spectral_tests::generators::Draw;

const BINS: usize = 10;
const NAMED: [(&str, [f64; 3]); 7] = [
    ("white", [1.0, 1.0, 1.0]),
    ("cyan", [0.0, 1.0, 1.0]),
    ("magenta", [1.0, 0.0, 1.0]),
    ("yellow", [1.0, 1.0, 0.0]),
    ("red", [1.0, 0.0, 0.0]),
    ("green", [0.0, 1.0, 0.0]),
    ("blue", [0.0, 0.0, 1.0]),
];

/// Linear RGB with an equal-energy white, over 380–780 nm: a flat 1 is (1, 1, 1) exactly.
fn colour<S: Spectrum<f64> + ?Sized>(spectrum: &S) -> [f64; 3] {
    let space = RgbSpace::new(RgbSpace::REC_709.primaries(), [1.0 / 3.0, 1.0 / 3.0]).unwrap();
    let observer = Observer::cie_1931_2deg();
    let flat = tristimulus(&observer, &Constant::new(1.0).unwrap(), 380.0, 780.0);
    let xyz = tristimulus(&observer, spectrum, 380.0, 780.0);
    space.from_xyz([0, 1, 2].map(|a| xyz[a] / flat[a]))
}

/// The colours of the bins, the last one held to 780 nm.
fn bin_colours() -> [[f64; BINS]; 3] {
    let mut colours = [[0.0; BINS]; 3];
    for bin in 0..BINS {
        let mut values = [0.0; 402];
        for (index, value) in values.iter_mut().enumerate() {
            let end = if bin == BINS - 1 { 401 } else { 34 * (bin + 1) };
            *value = if (34 * bin..end).contains(&index) { 1.0 } else { 0.0 };
        }
        let rgb = colour(&Steps(values));
        for channel in 0..3 {
            colours[channel][bin] = rgb[channel];
        }
    }
    colours
}

/// Constant over each nanometre from 380 nm.
struct Steps([f64; 402]);

impl Spectrum<f64> for Steps {
    fn segment(&self, wavelength: f64) -> spectral_core::spectrum::Segment<f64> {
        let index = (wavelength - 380.0).to_usize().min(401);
        let value = self.0[index];
        let end = if index == 401 { f64::INFINITY } else { 381.0 + f64::from(u32::try_from(index).unwrap()) };
        spectral_core::spectrum::Segment { end, first: value, last: value }
    }
}

/// Solves A x = b by elimination with pivoting.
fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|i, j| a[*i][k].abs().total_cmp(&a[*j][k].abs())).unwrap();
        a.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..n {
            let f = a[i][k] / a[k][k];
            for j in k..n {
                a[i][j] -= f * a[k][j];
            }
            b[i] -= f * b[k];
        }
    }
    for k in (0..n).rev() {
        let sum: f64 = (k + 1..n).map(|j| a[k][j] * b[j]).sum();
        b[k] = (b[k] - sum) / a[k][k];
    }
    b
}

/// 2 Dᵀ D, the matrix of Σ (s_{i+1} − s_i)².
fn roughness() -> [[f64; BINS]; BINS] {
    let mut q = [[0.0; BINS]; BINS];
    for i in 0..BINS - 1 {
        q[i][i] += 2.0;
        q[i + 1][i + 1] += 2.0;
        q[i][i + 1] -= 2.0;
        q[i + 1][i] -= 2.0;
    }
    q
}

/// The smoothest spectrum with a colour when some bins are 0: the values, and the multipliers of the three conditions.
fn smoothest_with(zero: &[bool; BINS], colours: &[[f64; BINS]; 3], rgb: [f64; 3]) -> ([f64; BINS], [f64; 3]) {
    let (q, n) = (roughness(), BINS + 3);
    let mut a = vec![vec![0.0; n]; n];
    let mut b = vec![0.0; n];
    for i in 0..BINS {
        if zero[i] {
            a[i][i] = 1.0;
            continue;
        }
        for j in 0..BINS {
            a[i][j] = q[i][j];
        }
        for c in 0..3 {
            a[i][BINS + c] = -colours[c][i];
        }
    }
    for c in 0..3 {
        a[BINS + c][..BINS].copy_from_slice(&colours[c]);
        b[BINS + c] = rgb[c];
    }
    let x = solve(a, b);
    (x[..BINS].try_into().unwrap(), x[BINS..].try_into().unwrap())
}

/// What the smoothness would gain if a bin were let go from 0: below 0 where it should be.
fn gradient(values: &[f64; BINS], multipliers: [f64; 3], colours: &[[f64; BINS]; 3]) -> [f64; BINS] {
    let q = roughness();
    core::array::from_fn(|i| {
        let rough: f64 = (0..BINS).map(|j| q[i][j] * values[j]).sum();
        rough - (0..3).map(|c| multipliers[c] * colours[c][i]).sum::<f64>()
    })
}

/// The smoothest spectrum that is nowhere negative: of all sets of zeros, the one that meets the conditions of Karush, Kuhn
/// and Tucker; the problem is convex, so that there is one answer.
fn smoothest(colours: &[[f64; BINS]; 3], rgb: [f64; 3]) -> [f64; BINS] {
    let mut found = None;
    for set in 0..1_u32 << BINS {
        if set.count_ones() > 7 {
            continue;
        }
        let zero: [bool; BINS] = core::array::from_fn(|i| set & (1 << i) != 0);
        let (values, multipliers) = smoothest_with(&zero, colours, rgb);
        let gradient = gradient(&values, multipliers, colours);
        let feasible = (0..BINS).all(|i| zero[i] || values[i] >= -1e-13);
        let optimal = (0..BINS).all(|i| !zero[i] || gradient[i] >= 1e-12);
        if feasible && optimal {
            assert!(found.is_none(), "{rgb:?}: two answers");
            found = Some(values.map(|v| if v.abs() <= 1e-12 { 0.0 } else { v }));
        }
    }
    found.unwrap()
}

#[test]
fn the_spectra_for_lights_are_the_smoothest() {
    let colours = bin_colours();
    for (name, rgb) in NAMED {
        let expected = smoothest(&colours, rgb);
        let actual = Basis::<f64>::lights().spectrum(rgb).unwrap().values();
        for (actual, expected) in actual.iter().zip(expected) {
            assert!((actual - expected).abs() <= 1e-11, "{name}: {actual} {expected}");
        }
    }
}

/// Any light, however saturated or bright, comes back, in both precisions; above 1 where it has to be.
#[test]
fn lights_come_back() {
    let mut draw = Draw::new(1);
    let (double, single) = (Basis::<f64>::lights(), Basis::<f32>::lights());
    for case in 0..300 {
        let size = draw.magnitude(1e-20, 1e20);
        let rgb = NAMED.get(case).map_or_else(|| core::array::from_fn(|_| size * draw.unit()), |(_, rgb)| *rgb);
        let most = rgb.into_iter().fold(0.0, f64::max);
        let spectrum = double.spectrum(rgb).unwrap();
        assert!(spectrum.values().iter().all(|v| *v >= 0.0));
        for (back, c) in colour(&spectrum).iter().zip(rgb) {
            assert!((back - c).abs() <= 1e-11 * most, "{rgb:?}");
        }
        let narrow = single.spectrum(rgb.map(Real::from_f64)).unwrap().values();
        for (narrow, wide) in narrow.iter().zip(spectrum.values()) {
            // Rounded tables, differences of components, three products and two sums.
            assert!((f64::from(*narrow) - wide).abs() <= 6.0 * f64::from(f32::EPSILON) * most);
        }
    }
    assert!(double.spectrum([0.0, 1.0, 1.0]).unwrap().values().iter().any(|v| *v > 1.1));
}

/// `published`: Smits' table. Its own error is up to 0.008: he summed on another grid.
#[test]
fn the_seven_reflectances_come_back() {
    let basis = Basis::<f64>::reflectances();
    let tables = [smits::WHITE, smits::CYAN, smits::MAGENTA, smits::YELLOW, smits::RED, smits::GREEN, smits::BLUE];
    let mut worst = 0.0_f64;
    for ((name, rgb), table) in NAMED.into_iter().zip(tables) {
        let spectrum = basis.spectrum(rgb).unwrap();
        assert_eq!(table.name, name);
        assert_eq!(&spectrum.values()[..], table.samples.double);
        for (back, c) in colour(&spectrum).iter().zip(rgb) {
            assert!((back - c).abs() <= 0.01, "{name}: {back}");
            worst = worst.max((back - c).abs());
        }
    }
    println!("worst round trip of the printed table: {worst}");
}

/// `independent`: `RGB_to_sd_Smits1999` of colour-science 0.4.7, whose samples are these bins.
#[test]
fn spectra_agree_with_colour_science() {
    let cases = [
        (
            [0.4, 0.3, 0.2],
            [0.210_13, 0.205_15, 0.210_86, 0.266_37, 0.299_84, 0.299_96, 0.383_21, 0.397_35, 0.398_34, 0.399_89],
        ),
        ([0.1, 0.5, 0.2], [0.1971, 0.194_26, 0.208_25, 0.438_11, 0.499_99, 0.482_59, 0.167_21, 0.1, 0.1, 0.100_75]),
        (
            [0.1, 0.2, 0.9],
            [0.8971, 0.894_26, 0.824_18, 0.432_61, 0.199_99, 0.200_05, 0.115_85, 0.125_83, 0.133_81, 0.134_72],
        ),
        (
            [0.7, 0.1, 0.3],
            [0.340_48, 0.3206, 0.293_69, 0.144_51, 0.099_92, 0.109_14, 0.600_38, 0.705_96, 0.705_96, 0.705_14],
        ),
        ([0.3, 0.1, 0.7], [0.7, 0.7, 0.650_33, 0.277_43, 0.099_92, 0.109_14, 0.2675, 0.314_76, 0.319_32, 0.319_02]),
        ([0.7, 0.9, 0.1], [0.100_06, 0.1, 0.170_73, 0.657_73, 0.899_92, 0.888_34, 0.734_14, 0.675_16, 0.6811, 0.6909]),
    ];
    let basis = Basis::<f64>::reflectances();
    for (rgb, expected) in cases {
        for (value, expected) in basis.spectrum(rgb).unwrap().values().iter().zip(expected) {
            assert!((value - expected).abs() <= 4.0 * f64::EPSILON, "{rgb:?}");
        }
    }
}

#[test]
fn bins_are_where_they_should_be() {
    let spectrum = Basis::<f32>::reflectances().spectrum([0.2, 0.9, 0.5]).unwrap();
    let values = spectrum.values();
    for (bin, value) in values.iter().enumerate() {
        let low = 380.0 + 34.0 * f32::from(u8::try_from(bin).unwrap());
        for inside in [low, low + 17.0, f32::from_bits((low + 34.0).to_bits() - 1)] {
            let segment = spectrum.segment(inside);
            assert_eq!((segment.first, segment.last), (*value, *value), "{inside}");
            assert!(segment.end > inside);
        }
    }
    assert_eq!((spectrum.value(100.0), spectrum.value(900.0)), (values[0], values[9]));
    for bad in [-1e-30, f64::NAN, f64::INFINITY] {
        let refused = Basis::<f64>::lights().spectrum([0.1, 0.2, bad]);
        assert_eq!(refused, Err(UpsamplingError::Component { channel: 2 }));
    }
}
