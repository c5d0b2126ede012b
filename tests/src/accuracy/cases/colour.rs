//! Colour spaces and differences.

use spectral_core::Real;
use spectral_core::colour::{self, RgbSpace, rgb, xyz};

use crate::accuracy::gauge::{Axis, Gauge};
use crate::accuracy::wide::{Wide, apply, dot, inverse, wide, wides};

/// (x, y, 1 − x − y)/y of a chromaticity.
fn unit_luminance([x, y]: [Wide; 2]) -> [Wide; 3] {
    [x / y, Wide::ONE, (1.0 - x - y) / y]
}

/// XYZ of a white.
fn white_of(xy: [f64; 2]) -> [Wide; 3] {
    unit_luminance(xy.map(Wide::from))
}

/// The matrix from RGB to XYZ (SMPTE RP 177): the primaries' columns, scaled so that they add up to white.
pub(super) fn matrix(primaries: [[f64; 2]; 3], white: [Wide; 3]) -> [[Wide; 3]; 3] {
    let [r, g, b] = primaries.map(|xy| unit_luminance(xy.map(Wide::from)));
    let columns = core::array::from_fn(|i| [r[i], g[i], b[i]]);
    let scale = apply(&inverse(&columns), white);
    columns.map(|row: [Wide; 3]| core::array::from_fn(|j| row[j] * scale[j]))
}

/// The matrix from XYZ to linear Rec. 709, whose white is (0.3127, 0.3290).
pub(super) fn to_rec_709() -> [[Wide; 3]; 3] {
    inverse(&matrix(RgbSpace::REC_709.primaries(), white_of([0.3127, 0.3290])))
}

const SPACES: [(&str, RgbSpace); 4] = [
    ("Rec. 709", RgbSpace::REC_709),
    ("Rec. 2020", RgbSpace::REC_2020),
    ("ACEScg", RgbSpace::ACESCG),
    ("sharp", RgbSpace::SHARP),
];
const WHITES: [[f64; 2]; 4] = [[0.3127, 0.3290], [0.3127, 0.3290], [0.321_68, 0.337_67], [1.0 / 3.0, 1.0 / 3.0]];

/// The primaries of the named spaces, and random ones near them.
pub fn rgb_to_xyz_matrix<R: Real>(gauge: &mut Gauge) {
    gauge.note("the named spaces, and each chromaticity moved by up to 0.03; in f64");
    for ((_, space), white) in SPACES.into_iter().zip(WHITES) {
        for move_by in [0.0, 0.01, 0.03] {
            for _ in 0..200 {
                let mut moved = |x: f64| x + move_by * (2.0 * gauge.rng().unit() - 1.0);
                let primaries = space.primaries().map(|xy| xy.map(&mut moved));
                let white = white.map(&mut moved);
                let (got, exact) = (rgb::rgb_to_xyz_matrix(primaries, white), matrix(primaries, white_of(white)));
                for (got, exact) in got.into_iter().zip(exact) {
                    gauge.compare_all(got, exact);
                }
            }
        }
    }
}

/// Measures a matrix, with the terms' magnitudes as the scale.
fn measure_matrix<R: Real>(
    gauge: &mut Gauge,
    name: [&'static str; 3],
    matrix: &[[Wide; 3]; 3],
    function: impl Fn([R; 3]) -> [R; 3],
) {
    let axes = name.map(|name| Axis::signed(name, 1e-3, 100.0).list(&[1.0, -1.0, 0.5]));
    gauge.each(&axes, |gauge, vector: [R; 3]| {
        for (got, row) in function(vector).into_iter().zip(matrix) {
            let terms: [Wide; 3] = core::array::from_fn(|i| (row[i] * wide(vector[i])).abs());
            gauge.compare_to(got, dot(*row, wides(vector)), terms[0] + terms[1] + terms[2]);
        }
    });
}

const RGB: [&str; 3] = ["R", "G", "B"];
const XYZ: [&str; 3] = ["X", "Y", "Z"];

/// Linear RGB to XYZ.
pub fn linear_rgb_to_xyz<R: Real>(gauge: &mut Gauge) {
    let matrix = matrix(rgb::PRIMARIES, white_of(rgb::WHITE_CHROMATICITY));
    measure_matrix::<R>(gauge, RGB, &matrix, colour::linear_rgb_to_xyz);
}

/// XYZ to linear RGB.
pub fn xyz_to_linear_rgb<R: Real>(gauge: &mut Gauge) {
    let matrix = inverse(&matrix(rgb::PRIMARIES, white_of(rgb::WHITE_CHROMATICITY)));
    measure_matrix::<R>(gauge, XYZ, &matrix, colour::xyz_to_linear_rgb);
}

/// The four spaces to XYZ.
pub fn space_to_xyz<R: Real>(gauge: &mut Gauge) {
    gauge.note("Rec. 709, Rec. 2020, ACEScg, sharp");
    for ((_, space), white) in SPACES.into_iter().zip(WHITES) {
        measure_matrix::<R>(gauge, RGB, &matrix(space.primaries(), white_of(white)), |v| space.to_xyz(v));
    }
}

/// XYZ to the four spaces.
pub fn space_from_xyz<R: Real>(gauge: &mut Gauge) {
    gauge.note("Rec. 709, Rec. 2020, ACEScg, sharp");
    for ((_, space), white) in SPACES.into_iter().zip(WHITES) {
        measure_matrix::<R>(gauge, XYZ, &inverse(&matrix(space.primaries(), white_of(white))), |v| space.from_xyz(v));
    }
}

/// Whites of the four spaces.
pub fn space_white<R: Real>(gauge: &mut Gauge) {
    gauge.note("Rec. 709, Rec. 2020, ACEScg, sharp; in f64");
    for ((_, space), white) in SPACES.into_iter().zip(WHITES) {
        gauge.compare_all(space.white(), white_of(white));
    }
}

fn encoded(linear: Wide) -> Wide {
    let size = linear.abs();
    let code = if size > Wide::decimal("0.0031308") {
        Wide::decimal("1.055") * size.powf(Wide::ONE / Wide::decimal("2.4")) - Wide::decimal("0.055")
    } else {
        Wide::decimal("12.92") * size
    };
    if linear < 0.0 { -code } else { code }
}

fn decoded(code: Wide) -> Wide {
    let size = code.abs();
    let linear = if size > Wide::decimal("0.04045") {
        ((size + Wide::decimal("0.055")) / Wide::decimal("1.055")).powf(Wide::decimal("2.4"))
    } else {
        size / Wide::decimal("12.92")
    };
    if code < 0.0 { -linear } else { linear }
}

/// IEC 61966-2-1, with the branches where the standard has them: rounding a limit may put a number on the other one.
fn branch_free(gauge: &mut Gauge, name: &'static str, joint: f64) -> Axis {
    gauge.note("but for the numbers next to the joint");
    Axis::signed(name, 1e-6, 8.0).list(&[1.0, 0.5, -1.0]).edges(&[1.0, joint * (1.0 + 1e-6), joint * (1.0 - 1e-6)])
}

/// The curve of sRGB.
pub fn encode_srgb<R: Real>(gauge: &mut Gauge) {
    let axis = branch_free(gauge, "C", 0.003_130_8);
    gauge.each(&[axis], |gauge, [x]: [R; 1]| gauge.compare(colour::encode_srgb(x), encoded(wide(x))));
}

/// Its inverse.
pub fn decode_srgb<R: Real>(gauge: &mut Gauge) {
    let axis = branch_free(gauge, "V", 0.040_45);
    gauge.each(&[axis], |gauge, [x]: [R; 1]| gauge.compare(colour::decode_srgb(x), decoded(wide(x))));
}

/// How far the code is from what it should be before rounding.
pub fn linear_rgb_to_srgb8<R: Real>(gauge: &mut Gauge) {
    gauge.each(&[Axis::linear("C", -0.5, 1.5).edges(&[0.0, 0.003_130_8, 1.0])], |gauge, [x]: [R; 1]| {
        let [code, zero, one] = colour::linear_rgb_to_srgb8([x, R::ZERO, R::ONE]);
        let exact = encoded(wide(x)).max(Wide::ZERO).min(Wide::ONE) * 255.0;
        gauge.record((exact - f64::from(code)).abs().to_f64());
        gauge.require(zero == 0 && one == 255);
    });
}

/// All codes.
pub fn srgb8_to_linear_rgb<R: Real>(gauge: &mut Gauge) {
    gauge.note("all codes");
    for code in 0..=255 {
        let [got, ..]: [R; 3] = colour::srgb8_to_linear_rgb([code; 3]);
        gauge.compare(got, decoded(Wide::from(f64::from(code)) / 255.0));
    }
}

/// ISO/CIE 11664-4, equations 4 to 9.
fn lab_curve(t: Wide) -> Wide {
    let delta = Wide::from(6.0) / 29.0;
    if t > delta.powi(3) { t.cbrt() } else { t / (delta.squared() * 3.0) + Wide::from(4.0) / 29.0 }
}

fn lab_curve_inverse(s: Wide) -> Wide {
    let delta = Wide::from(6.0) / 29.0;
    if s > delta { s.powi(3) } else { delta.squared() * 3.0 * (s - Wide::from(4.0) / 29.0) }
}

/// f of CIELAB.
pub fn lab_f<R: Real>(gauge: &mut Gauge) {
    let axis = Axis::log("t", 1e-30, 1e30).list(&[0.0]).edges(&[216.0 / 24_389.0, 1.0, 8.0, 0.125]);
    gauge.each(&[axis], |gauge, [t]: [R; 1]| gauge.compare(colour::lab_f(t), lab_curve(wide(t))));
}

/// Its inverse.
pub fn lab_f_inverse<R: Real>(gauge: &mut Gauge) {
    let axis = Axis::signed("s", 1e-6, 1e3).edges(&[6.0 / 29.0, 4.0 / 29.0, 0.2, 1.0]);
    gauge.each(&[axis], |gauge, [s]: [R; 1]| {
        let exact = lab_curve_inverse(wide(s));
        let slope = (Wide::from(6.0) / 29.0).squared() * 3.0;
        let size = if exact > (Wide::from(6.0) / 29.0).powi(3) { exact } else { slope * (wide(s).abs() + 4.0 / 29.0) };
        gauge.compare_to(colour::lab_f_inverse(s), exact, size);
    });
}

pub(super) fn lab(xyz: [Wide; 3], white: [Wide; 3]) -> [Wide; 3] {
    let [x, y, z]: [Wide; 3] = core::array::from_fn(|i| lab_curve(xyz[i] / white[i]));
    [y * 116.0 - 16.0, (x - y) * 500.0, (y - z) * 200.0]
}

fn whites<R: Real>() -> [[R; 3]; 3] {
    [xyz::WHITE_D65, xyz::WHITE_A, xyz::WHITE_E].map(colour::in_precision)
}

/// Colours up to three times white, under D65, A and E.
pub fn xyz_to_lab<R: Real>(gauge: &mut Gauge) {
    let axes = XYZ.map(|name| Axis::linear(name, -0.1, 3.0).list(&[0.5, 1.0]).edges(&[0.0, 216.0 / 24_389.0]));
    gauge.note("white D65, A, E");
    for white in whites::<R>() {
        gauge.each(&axes, |gauge, xyz: [R; 3]| {
            let (got, exact) = (colour::xyz_to_lab(xyz, white), lab(wides(xyz), wides(white)));
            for (got, exact) in got.into_iter().zip(exact) {
                gauge.compare_to(got, exact, Wide::from(500.0));
            }
        });
    }
}

/// The same, back.
pub fn lab_to_xyz<R: Real>(gauge: &mut Gauge) {
    let axes = [
        Axis::linear("L*", 0.0, 100.0).edges(&[8.0]),
        Axis::linear("a*", -128.0, 128.0).list(&[0.0]),
        Axis::linear("b*", -128.0, 128.0).list(&[0.0]),
    ];
    gauge.note("white D65, A, E");
    for white in whites::<R>() {
        gauge.each(&axes, |gauge, lab: [R; 3]| {
            let [lightness, a, b] = wides(lab);
            let y = (lightness + 16.0) / 116.0;
            let f = [y + a / 500.0, y, y - b / 200.0];
            for (i, got) in colour::lab_to_xyz(lab, white).into_iter().enumerate() {
                gauge.compare_to(got, lab_curve_inverse(f[i]) * wide(white[i]), wide(white[i]));
            }
        });
    }
}

const LABS: [&str; 6] = ["L*₁", "a*₁", "b*₁", "L*₂", "a*₂", "b*₂"];

fn pairs() -> [Axis; 6] {
    LABS.map(|name| {
        if name.starts_with('L') {
            Axis::linear(name, 0.0, 100.0).list(&[50.0])
        } else {
            Axis::linear(name, -128.0, 128.0).list(&[0.0, 2.5, -2.5])
        }
    })
}

/// Pairs of colours, far and near.
fn each_pair<R: Real>(gauge: &mut Gauge, mut measure: impl FnMut(&mut Gauge, [R; 3], [R; 3])) {
    gauge.each(&pairs(), |gauge, [l, a, b, m, c, d]: [R; 6]| {
        let first = [l, a, b];
        measure(gauge, first, [m, c, d]);
        // A neighbour: differences of a few units, a hundredth, and a few units in the last place.
        for size in [0.02, 1e-4, 2.0 * R::EPSILON.to_f64()] {
            let other = [m, c, d];
            measure(gauge, first, core::array::from_fn(|i| first[i] + (other[i] - first[i]) * R::from_f64(size)));
        }
    });
}

/// Euclid's distance.
pub fn delta_e_ab<R: Real>(gauge: &mut Gauge) {
    gauge.note("and neighbours at 2 %, 10⁻⁴ and 2 ε of the way");
    each_pair(gauge, |gauge, first: [R; 3], second| {
        let squares: [Wide; 3] = core::array::from_fn(|i| (wide(second[i]) - wide(first[i])).squared());
        gauge.compare(colour::delta_e_ab(first, second), (squares[0] + squares[1] + squares[2]).sqrt());
    });
}

fn degrees(radians: Wide) -> Wide {
    radians * 180.0 / Wide::PI
}

fn cos_degrees(angle: Wide) -> Wide {
    (angle * Wide::PI / 180.0).cos()
}

/// √(C⁷/(C⁷ + 25⁷)).
fn seventh(chroma: Wide) -> Wide {
    let power = chroma.powi(7);
    (power / (power + 6_103_515_625.0)).sqrt()
}

/// Hue in [0°, 360°), 0 for grey.
fn hue(a: Wide, b: Wide) -> Wide {
    if a == 0.0 && b == 0.0 {
        return Wide::ZERO;
    }
    let angle = degrees(b.atan2(a));
    if angle < 0.0 { angle + 360.0 } else { angle }
}

/// CIEDE2000 by Sharma, Wu and Dalal 2005, equations 2 to 22, step by step; and how far it is from jumping, in degrees: the hues from being
/// opposite, or their mean from 0°, where the Gaussian of equation 16 isn't periodic.
pub(super) fn ciede2000(first: [Wide; 3], second: [Wide; 3], [k_l, k_c, k_h]: [Wide; 3]) -> (Wide, f64) {
    let chroma = |lab: [Wide; 3]| lab[1].hypot(lab[2]);
    let g = (1.0 - seventh((chroma(first) + chroma(second)) * 0.5)) * 0.5;
    let a = [first, second].map(|lab| (g + 1.0) * lab[1]);
    let c = [a[0].hypot(first[2]), a[1].hypot(second[2])];
    let h = [hue(a[0], first[2]), hue(a[1], second[2])];
    let grey = c[0] * c[1] == 0.0;
    let turn = h[1] - h[0];
    // Of opposite hues the difference is 180° exactly, whatever rounding makes of it.
    let turn = if (turn.abs() - 180.0).abs() < 1e-24 {
        if turn < 0.0 { Wide::from(-180.0) } else { Wide::from(180.0) }
    } else {
        turn
    };
    let opposite = if grey { 180.0 } else { (turn.abs() - 180.0).abs().to_f64() };
    let difference = match turn {
        _ if grey => Wide::ZERO,
        turn if turn > 180.0 => turn - 360.0,
        turn if turn < -180.0 => turn + 360.0,
        turn => turn,
    };
    let lightness = second[0] - first[0];
    let hue_step = (c[0] * c[1]).sqrt() * 2.0 * (difference * 0.5 * Wide::PI / 180.0).sin();
    let mean_lightness = (first[0] + second[0]) * 0.5;
    let mean_chroma = (c[0] + c[1]) * 0.5;
    let sum = h[0] + h[1];
    let mean_hue = match turn.abs() {
        _ if grey => sum,
        turn if turn <= 180.0 => sum * 0.5,
        _ if sum < 360.0 => (sum + 360.0) * 0.5,
        _ => (sum - 360.0) * 0.5,
    };
    let t = 1.0 - cos_degrees(mean_hue - 30.0) * Wide::decimal("0.17")
        + cos_degrees(mean_hue * 2.0) * Wide::decimal("0.24")
        + cos_degrees(mean_hue * 3.0 + 6.0) * Wide::decimal("0.32")
        - cos_degrees(mean_hue * 4.0 - 63.0) * Wide::decimal("0.20");
    let turn = (-((mean_hue - 275.0) / 25.0).squared()).exp() * 30.0;
    let rotation = -(seventh(mean_chroma) * 2.0) * (turn * 2.0 * Wide::PI / 180.0).sin();
    let offset = (mean_lightness - 50.0).squared();
    let s_l = offset * Wide::decimal("0.015") / (offset + 20.0).sqrt() + 1.0;
    let s_c = mean_chroma * Wide::decimal("0.045") + 1.0;
    let s_h = mean_chroma * t * Wide::decimal("0.015") + 1.0;
    let (l, c, h) = (lightness / (k_l * s_l), (c[1] - c[0]) / (k_c * s_c), hue_step / (k_h * s_h));
    let jump = if grey { 180.0 } else { opposite.min((sum - 360.0).abs().to_f64()) };
    ((l.squared() + c.squared() + h.squared() + rotation * c * h).max(Wide::ZERO).sqrt(), jump)
}

/// Measures ΔE00. The formula jumps where hues are opposite: rounding may put a pair on the other side.
fn measure_ciede2000<R: Real>(gauge: &mut Gauge, factors: [R; 3], function: impl Fn([R; 3], [R; 3]) -> R) {
    gauge.note("hues a little more or less than opposite, and mean hues next to 0°, left out");
    let near = 1e3 * R::EPSILON.to_f64();
    each_pair(gauge, |gauge, first: [R; 3], second| {
        let (exact, jump) = ciede2000(wides(first), wides(second), wides(factors));
        let exactly = first[1] == -second[1] && first[2] == -second[2] && first[1] != R::ZERO && first[2] != R::ZERO;
        if jump > near || exactly {
            // What rounding of the chromas leaves is relative to them; the rest to the difference.
            let size = first.iter().chain(&second).fold(0.0_f64, |m, x| m.max(x.to_f64().abs()));
            let scale = exact + size * 1e-2;
            gauge.compare_to(function(first, second), exact, scale);
        }
    });
}

/// ΔE00.
pub fn delta_e_00<R: Real>(gauge: &mut Gauge) {
    gauge.effort(0.4);
    gauge.note("and neighbours at 2 %, 10⁻⁴ and 2 ε of the way");
    measure_ciede2000(gauge, [R::ONE; 3], colour::delta_e_00);
}

/// ΔE00 with factors.
pub fn delta_e_00_weighted<R: Real>(gauge: &mut Gauge) {
    gauge.effort(0.2);
    gauge.note("factors 2, 1, 1 and 1, 0.5, 3");
    for factors in [[2.0, 1.0, 1.0], [1.0, 0.5, 3.0]] {
        let factors = factors.map(R::from_f64);
        measure_ciede2000(gauge, factors, |first, second| colour::delta_e_00_weighted(first, second, factors));
    }
}

/// Chromaticities.
pub fn xyz_to_xyy<R: Real>(gauge: &mut Gauge) {
    gauge.each(&XYZ.map(|name| Axis::log(name, 1e-6, 1e6).list(&[0.0])), |gauge, xyz: [R; 3]| {
        let [x, y, z] = wides(xyz);
        let sum = x + y + z;
        match colour::xyz_to_xyy(xyz) {
            Some(got) => gauge.compare_all(got, [x / sum, y / sum, y]),
            None => gauge.require(sum == 0.0),
        }
    });
}

/// Tristimulus values of chromaticities.
pub fn xyy_to_xyz<R: Real>(gauge: &mut Gauge) {
    let axes = [
        Axis::linear("x", 0.0, 0.8).list(&[0.3127]),
        Axis::linear("y", 0.001, 0.9).list(&[0.329]),
        Axis::log("Y", 1e-6, 1e6).list(&[0.0, 1.0]),
    ];
    gauge.each(&axes, |gauge, xyy: [R; 3]| {
        let [x, y, luminance] = wides(xyy);
        let scale = (x + y + 1.0) * luminance / y;
        let exact = [x * luminance / y, luminance, (1.0 - x - y) * luminance / y];
        let Some(got) = colour::xyy_to_xyz(xyy) else { return gauge.require(false) };
        for (got, exact) in got.into_iter().zip(exact) {
            gauge.compare_to(got, exact, scale);
        }
    });
}

/// Rounding to nearest.
pub fn in_precision<R: Real>(gauge: &mut Gauge) {
    gauge.each(&[Axis::signed("x", 1e-30, 1e30)], |gauge, [x]: [f64; 1]| {
        gauge.compare(colour::in_precision::<R>([x; 3])[1], x.into());
    });
}
