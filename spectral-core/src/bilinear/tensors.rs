//! Tensors of known spaces.

use super::Tensor;
use crate::Real;

/// The matrices K_r, K_g, K_b for ISO RGB as printed in section 5.3 of Granier and Damez 2004: `[e][c][d]` = k^c_{e,d}.
///
/// Symmetric exactly, coherent to 2e-10.
#[rustfmt::skip]
pub const ISO_RGB_PRINTED: [[[f64; 3]; 3]; 3] = [
    [
        [0.653_304_377_6, 0.270_856_777_8, 0.075_838_844_4],
        [0.059_436_855_5, -0.041_317_927_8, -0.018_118_927_73],
        [-0.011_190_566_64, 0.000_553_666_7, 0.010_636_899_9],
    ],
    [
        [0.270_856_777_8, -0.213_525_822_2, -0.057_330_955_55],
        [-0.041_317_927_8, 0.994_386_088_9, 0.046_931_838_8],
        [0.000_553_666_7, -0.040_148_299_95, 0.039_594_633_3],
    ],
    [
        [0.075_838_844_4, -0.057_330_955_55, -0.018_507_888_91],
        [-0.018_118_927_73, 0.046_931_838_8, -0.028_812_911_07],
        [0.010_636_899_9, 0.039_594_633_3, 0.949_768_466_7],
    ],
];

const ISO_RGB: [[f64; 3]; 3] = [
    [ISO_RGB_PRINTED[0][0][1], ISO_RGB_PRINTED[1][0][2], ISO_RGB_PRINTED[2][0][0]],
    [ISO_RGB_PRINTED[0][1][1], ISO_RGB_PRINTED[1][1][2], ISO_RGB_PRINTED[2][1][0]],
    [ISO_RGB_PRINTED[0][2][1], ISO_RGB_PRINTED[1][2][2], ISO_RGB_PRINTED[2][2][0]],
];

/// Estimated by [`estimate_rgb`](super::estimate_rgb), rounded to twelve decimals; a test estimates them again.
const REC_709: [[f64; 3]; 3] = [
    [0.270_692_762_709, -0.057_289_040_571, 0.075_982_323_826],
    [-0.041_189_725_089, 0.047_086_968_553, -0.018_117_804_602],
    [0.000_471_797_788, 0.039_517_156_393, 0.010_789_634_404],
];
const REC_2020: [[f64; 3]; 3] = [
    [-0.121_882_812_215, -0.041_969_554_683, 0.021_952_939_343],
    [-0.280_358_000_451, 0.066_180_967_761, -0.045_099_219_620],
    [-0.019_551_898_847, -0.069_913_717_164, 0.008_997_854_305],
];
const ACESCG: [[f64; 3]; 3] = [
    [-0.137_541_522_549, -0.039_894_693_244, -0.009_147_204_009],
    [-0.296_869_001_307, 0.077_660_217_488, -0.058_172_291_288],
    [-0.027_666_572_338, -0.092_724_171_413, 0.002_758_833_446],
];

impl<R: Real> Tensor<R> {
    /// The tensor that the paper prints for ISO RGB, [`ISO_RGB_PRINTED`]: its nine coefficients off the diagonal, and
    /// the others from coherence, which moves them by less than 3e-10.
    #[must_use]
    pub fn iso_rgb() -> Self {
        Self::known(&ISO_RGB)
    }

    /// The tensor for linear Rec. 709 and linear sRGB, from [`estimate_rgb`](super::estimate_rgb); within 3e-4 of
    /// [`iso_rgb`](Self::iso_rgb), which was estimated alike.
    #[must_use]
    pub fn rec_709() -> Self {
        Self::known(&REC_709)
    }

    /// The tensor for linear Rec. 2020, from [`estimate_rgb`](super::estimate_rgb).
    ///
    /// Not better than the classical product, on average: see the [module](super#which-tensor).
    #[must_use]
    pub fn rec_2020() -> Self {
        Self::known(&REC_2020)
    }

    /// The tensor for ACEScg, from [`estimate_rgb`](super::estimate_rgb).
    ///
    /// Not better than the classical product, on average: see the [module](super#which-tensor).
    #[must_use]
    pub fn acescg() -> Self {
        Self::known(&ACESCG)
    }
}
