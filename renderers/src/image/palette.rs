//! Colours for numbers: even to the eye, and telling high from low without hue.

use super::Rgb8;
use core::f64::consts::PI;
use spectral_core::colour::rgb::WHITE;
use spectral_core::colour::{
    decode_srgb, lab_to_xyz, linear_rgb_to_srgb8, linear_rgb_to_xyz, srgb8_to_linear_rgb, xyz_to_lab, xyz_to_linear_rgb,
};

/// A way to colour the numbers from 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Palette {
    /// Dark violet over green to bright yellow, for magnitudes; lightness rises all along, and the steps stay even for
    /// dichromats.
    ///
    /// Source: viridis of Stéfan van der Walt and Nathaniel Smith (2015, CC0), 16 of its 256 colours, with straight
    /// lines in CIELAB between them.
    #[default]
    Viridis,
    /// Dark blue over grey to bright yellow, for magnitudes to be read off: steps of ΔE00 that are even to 15 % for normal eyes, and to 25 % for
    /// eyes without long-wave or without medium-wave cones.
    ///
    /// Source: cividis of Nuñez, Anderton and Renslow, "Optimizing colormaps with consideration for color vision deficiency" (PLoS ONE
    /// 13(7), 2018), 25 of its colours, at equal distances by the mean of the three eyes' ΔE00, with straight lines in CIELAB between them.
    Cividis,
    /// Blue over light grey to red, for signed numbers: ½ is neutral, and lightness falls to both sides.
    ///
    /// Source: Moreland, "Diverging color maps for scientific visualization", ISVC 2009 (LNCS 5876): straight
    /// lines in Msh (polar CIELAB) space between sRGB (59, 76, 192), white and (180, 4, 38).
    CoolWarm,
}

/// Entries 0, 17, 34, …, 255 of the published table of viridis, in sRGB.
const VIRIDIS: [[f64; 3]; 16] = [
    [0.267_004, 0.004_874, 0.329_415],
    [0.282_656, 0.100_196, 0.422_16],
    [0.277_134, 0.185_228, 0.489_898],
    [0.253_935, 0.265_254, 0.529_983],
    [0.221_989, 0.339_161, 0.548_752],
    [0.190_631, 0.407_061, 0.556_089],
    [0.163_625, 0.471_133, 0.558_148],
    [0.139_147, 0.533_812, 0.555_298],
    [0.120_565, 0.596_422, 0.543_611],
    [0.134_692, 0.658_636, 0.517_649],
    [0.208_03, 0.718_701, 0.472_873],
    [0.327_796, 0.773_98, 0.406_64],
    [0.477_504, 0.821_444, 0.318_195],
    [0.647_257, 0.858_4, 0.209_861],
    [0.824_94, 0.884_72, 0.106_217],
    [0.993_248, 0.906_157, 0.143_936],
];

/// Entries of cividis at 0, 11.3, 24.7, 37.8, … of 255, interpolated.
const CIVIDIS: [Rgb8; 25] = [
    [0, 34, 78],
    [0, 42, 97],
    [7, 51, 112],
    [36, 60, 110],
    [52, 69, 108],
    [64, 76, 108],
    [75, 84, 108],
    [85, 91, 109],
    [94, 98, 110],
    [103, 105, 113],
    [111, 112, 115],
    [120, 120, 119],
    [128, 126, 120],
    [136, 132, 120],
    [144, 139, 120],
    [152, 146, 119],
    [162, 153, 117],
    [171, 161, 114],
    [182, 169, 111],
    [193, 178, 106],
    [204, 187, 100],
    [217, 197, 92],
    [230, 208, 81],
    [243, 219, 66],
    [254, 232, 56],
];

impl Palette {
    /// The colour of a number in [0, 1]; numbers outside have the colour of the nearer end, NaN that of 0.
    #[must_use]
    pub fn colour(self, fraction: f64) -> Rgb8 {
        let fraction = if fraction.is_nan() { 0.0 } else { fraction.clamp(0.0, 1.0) };
        let lab = match self {
            Self::Viridis => between(&VIRIDIS.map(|colour| colour.map(decode_srgb)), fraction),
            Self::Cividis => between(&CIVIDIS.map(srgb8_to_linear_rgb), fraction),
            Self::CoolWarm => cool_warm(fraction),
        };
        linear_rgb_to_srgb8(xyz_to_linear_rgb(lab_to_xyz(lab, WHITE)))
    }

    /// The colours of `count` equal steps from 0 to 1, the ends included.
    #[must_use]
    pub fn steps(self, count: usize) -> Vec<Rgb8> {
        #[allow(clippy::cast_precision_loss, reason = "a count of colours")]
        (0..count).map(|k| self.colour(k as f64 / count.saturating_sub(1).max(1) as f64)).collect()
    }
}

fn mix(a: [f64; 3], b: [f64; 3], t: f64) -> [f64; 3] {
    [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t]
}

/// Straight lines in CIELAB between colours at equal distances, at a place from 0 to 1.
fn between<const N: usize>(knots: &[[f64; 3]; N], fraction: f64) -> [f64; 3] {
    let lab = |index: usize| xyz_to_lab(linear_rgb_to_xyz(knots[index]), WHITE);
    #[allow(clippy::cast_precision_loss, reason = "few knots")]
    let position = fraction * (N - 1) as f64;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the knots")]
    let index = (position.floor() as usize).min(N - 2);
    #[allow(clippy::cast_precision_loss, reason = "few knots")]
    let within = position - index as f64;
    mix(lab(index), lab(index + 1), within)
}

const COOL: Rgb8 = [59, 76, 192];
const WARM: Rgb8 = [180, 4, 38];
/// Magnitude M of the neutral middle.
const NEUTRAL: f64 = 88.0;

/// Moreland's interpolation between one end and the neutral middle.
fn cool_warm(fraction: f64) -> [f64; 3] {
    let (end, towards_end) = if fraction < 0.5 { (COOL, 1.0 - 2.0 * fraction) } else { (WARM, 2.0 * fraction - 1.0) };
    let end = polar(xyz_to_lab(linear_rgb_to_xyz(srgb8_to_linear_rgb(end)), WHITE));
    let middle = [NEUTRAL, 0.0, unsaturated_hue(end, NEUTRAL)];
    cartesian(mix(middle, end, towards_end))
}

/// CIELAB in polar form Msh: magnitude M, angle s from the L\* axis, hue h, both in radians.
fn polar([lightness, a, b]: [f64; 3]) -> [f64; 3] {
    let magnitude = (lightness * lightness + a * a + b * b).sqrt();
    [magnitude, (lightness / magnitude).acos(), b.atan2(a)]
}

fn cartesian([magnitude, angle, hue]: [f64; 3]) -> [f64; 3] {
    [magnitude * angle.cos(), magnitude * angle.sin() * hue.cos(), magnitude * angle.sin() * hue.sin()]
}

/// The hue to head for near grey, so that the steps stay even while the magnitude changes (Moreland's `AdjustHue`).
fn unsaturated_hue([magnitude, angle, hue]: [f64; 3], unsaturated: f64) -> f64 {
    if magnitude >= unsaturated {
        return hue;
    }
    let spin = angle * (unsaturated * unsaturated - magnitude * magnitude).sqrt() / (magnitude * angle.sin());
    if hue > -PI / 3.0 { hue + spin } else { hue - spin }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectral_core::colour::delta_e_00;

    fn lab(colour: Rgb8) -> [f64; 3] {
        xyz_to_lab(linear_rgb_to_xyz(srgb8_to_linear_rgb(colour)), WHITE)
    }

    /// `published`: entries of the 256 of viridis between those that are used here.
    #[test]
    fn viridis_is_the_published_one_also_between_its_knots() {
        let published = [
            (8, [0.277_018, 0.050_344, 0.375_715]),
            (60, [0.237_441, 0.305_202, 0.541_921]),
            (100, [0.166_617, 0.463_708, 0.558_119]),
            (128, [0.127_568, 0.566_949, 0.550_556]),
            (200, [0.440_137, 0.811_138, 0.340_967]),
            (247, [0.916_242, 0.896_091, 0.100_717]),
        ];
        for (entry, srgb) in published {
            let expected = xyz_to_lab(linear_rgb_to_xyz(srgb.map(decode_srgb)), WHITE);
            let actual = lab(Palette::Viridis.colour(f64::from(entry) / 255.0));
            // Straight lines between 16 knots cut the curve's corners, by less than an eye sees.
            assert!(delta_e_00(actual, expected) <= 1.0, "{entry}: {actual:?}, published {expected:?}");
        }
    }

    /// `published`: the middle and the quarters of Moreland's table of 33 colours.
    #[test]
    fn cool_warm_is_the_published_one() {
        let published = [
            (0, [59, 76, 192]),
            (8, [141, 176, 254]),
            (16, [221, 221, 221]),
            (24, [244, 154, 123]),
            (32, [180, 4, 38]),
        ];
        for (entry, expected) in published {
            let actual = Palette::CoolWarm.colour(f64::from(entry) / 32.0);
            for (a, e) in actual.iter().zip(expected) {
                assert!(a.abs_diff(e) <= 1, "{entry}: {actual:?}, published {expected:?}");
            }
        }
    }

    /// `published`: entries 0, 64, 128, 192 and 255 of cividis lie on the line, wherever they are along it.
    #[test]
    fn cividis_has_the_published_colours() {
        for published in [[0, 34, 78], [64, 77, 107], [125, 124, 120], [188, 174, 108], [254, 232, 56]] {
            let nearest = Palette::Cividis.steps(1000).into_iter().map(|c| delta_e_00(lab(c), lab(published)));
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            assert!(nearest <= 1.0, "{published:?}: {nearest}");
        }
    }

    #[test]
    fn lightness_rises_all_along() {
        for palette in [Palette::Viridis, Palette::Cividis] {
            let steps = palette.steps(64);
            assert!(steps.windows(2).all(|pair| lab(pair[0])[0] < lab(pair[1])[0]));
        }
    }

    #[test]
    fn lightness_falls_to_both_sides_of_neutral() {
        let steps = Palette::CoolWarm.steps(33);
        assert!(steps[..17].windows(2).all(|pair| lab(pair[0])[0] < lab(pair[1])[0]));
        assert!(steps[16..].windows(2).all(|pair| lab(pair[0])[0] > lab(pair[1])[0]));
    }

    #[test]
    fn numbers_outside_take_the_ends() {
        for palette in [Palette::Viridis, Palette::Cividis, Palette::CoolWarm] {
            assert_eq!(palette.colour(-3.0), palette.colour(0.0));
            assert_eq!(palette.colour(f64::NAN), palette.colour(0.0));
            assert_eq!(palette.colour(f64::INFINITY), palette.colour(1.0));
            assert_eq!(palette.steps(16).len(), 16);
            assert_eq!(palette.steps(1), [palette.colour(0.0)]);
        }
    }
}
