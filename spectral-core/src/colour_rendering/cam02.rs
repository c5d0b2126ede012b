//! CIECAM02 in the viewing conditions of CIE 224, and the uniform space on it: CAM02-UCS.

use crate::Real;
use crate::colour::rgb::{invert, transform};

/// XYZ to the cone responses of CAT02.
const CAT02: [[f64; 3]; 3] = [[0.7328, 0.4296, -0.1624], [-0.7036, 1.6975, 0.0061], [0.0030, 0.0136, 0.9834]];
const CAT02_INVERSE: [[f64; 3]; 3] = invert(CAT02);
/// XYZ to the cone responses of Hunt, Pointer and Estévez, for equal energy.
const HPE: [[f64; 3]; 3] = [[0.389_71, 0.688_98, -0.078_68], [-0.229_81, 1.183_40, 0.046_41], [0.0, 0.0, 1.0]];

/// Adapting luminance in cd/m².
const ADAPTING_LUMINANCE: f64 = 100.0;
/// Luminance factor of the background, relative to white.
const BACKGROUND: f64 = 0.2;
/// Surround: average. c and N_c; F does not matter under complete adaptation.
const SURROUND: [f64; 2] = [0.69, 1.0];

/// CIECAM02 with complete adaptation to a white, L_A = 100 cd/m², Y_b = 20, average surround (CIE 159:2004; conditions of
/// CIE 224:2017).
pub(super) struct Cam02<R> {
    scale: [R; 3],
    level: R,
    induction: R,
    base: R,
    achromatic: R,
}

impl<R: Real> Cam02<R> {
    /// For a white with Y = 1.
    pub(super) fn new(white: [R; 3]) -> Self {
        let hundred = R::from_f64(100.0);
        let responses = transform(&CAT02, white.map(|c| c * hundred));
        let five = 5.0 * ADAPTING_LUMINANCE;
        let k = 1.0 / (five + 1.0);
        let k4 = k * k * k * k;
        let level = 0.2 * k4 * five + 0.1 * (1.0 - k4) * (1.0 - k4) * libm::cbrt(five);
        let mut cam = Self {
            scale: responses.map(|response| hundred / response),
            level: R::from_f64(level),
            induction: R::from_f64(0.725 * libm::pow(1.0 / BACKGROUND, 0.2)),
            base: R::from_f64(1.48 + libm::sqrt(BACKGROUND)),
            achromatic: R::ONE,
        };
        cam.achromatic = cam.achromatic_response(cam.responses(white));
        cam
    }

    /// The compressed cone responses R′a, G′a, B′a.
    fn responses(&self, xyz: [R; 3]) -> [R; 3] {
        let cones = transform(&CAT02, xyz.map(|c| c * R::from_f64(100.0)));
        let adapted = core::array::from_fn(|i| cones[i] * self.scale[i]);
        transform(&HPE, transform(&CAT02_INVERSE, adapted)).map(|response| self.compress(response))
    }

    fn compress(&self, response: R) -> R {
        let power = (self.level * response.abs() / R::from_f64(100.0)).powf(R::from_f64(0.42));
        let compressed = R::from_f64(400.0) * power / (power + R::from_f64(27.13));
        let signed = if response < R::ZERO { -compressed } else { compressed };
        signed + R::from_f64(0.1)
    }

    fn achromatic_response(&self, [r, g, b]: [R; 3]) -> R {
        (R::TWO * r + g + b / R::from_f64(20.0) - R::from_f64(0.305)) * self.induction
    }

    /// J′, a′, b′ of CAM02-UCS (Luo, Cui and Li 2006) of XYZ relative to Y = 1 for white.
    pub(super) fn uniform(&self, xyz: [R; 3]) -> [R; 3] {
        let [r, g, b] = self.responses(xyz);
        let [c, n_c] = SURROUND.map(R::from_f64);
        let red_green = r - R::from_f64(12.0) * g / R::from_f64(11.0) + b / R::from_f64(11.0);
        let yellow_blue = (r + g - R::TWO * b) / R::from_f64(9.0);
        let hue = yellow_blue.atan2(red_green);
        let eccentricity = R::from_f64(0.25) * ((hue + R::TWO).cos() + R::from_f64(3.8));
        let opponent = red_green.hypot(yellow_blue);
        let t = R::from_f64(50_000.0 / 13.0) * n_c * self.induction * eccentricity * opponent
            / (r + g + R::from_f64(21.0 / 20.0) * b);
        let ratio = (self.achromatic_response([r, g, b]) / self.achromatic).max(R::ZERO);
        let lightness = R::from_f64(100.0) * ratio.powf(c * self.base);
        let contrast = R::from_f64(libm::pow(1.64 - libm::pow(0.29, BACKGROUND), 0.73));
        let chroma = t.powf(R::from_f64(0.9)) * (lightness / R::from_f64(100.0)).sqrt() * contrast;
        let colourfulness = chroma * self.level.powf(R::from_f64(0.25));
        let compressed = (R::ONE + R::from_f64(0.0228) * colourfulness).ln() / R::from_f64(0.0228);
        let lightness = R::from_f64(1.7) * lightness / (R::ONE + R::from_f64(0.007) * lightness);
        [lightness, compressed * hue.cos(), compressed * hue.sin()]
    }
}
