//! Colours: their spaces, differences and bounds.

use spectral_core::Real;
use spectral_core::bound::{delta_e_bound, delta_e_majorant};
use spectral_core::colour::{
    decode_srgb, delta_e_00, delta_e_ab, encode_srgb, lab_f, lab_f_inverse, lab_to_xyz, linear_rgb_to_srgb8,
    linear_rgb_to_xyz, quantise_8bit, srgb8_to_linear_rgb, xyy_to_xyz, xyz_to_lab, xyz_to_linear_rgb, xyz_to_xyy,
};

use crate::numbers::{Numbers, assert_finite, assert_in};

/// Takes colours through their spaces and back, compares them, and looks for one outside the bound of its box.
pub fn colour(bytes: &[u8]) {
    check::<f64>(&mut Numbers::new(bytes), 1e100);
    check::<f32>(&mut Numbers::new(bytes), 1e9);
}

fn check<R: Real>(numbers: &mut Numbers, range: f64) {
    transfer(numbers.any::<R>(), numbers.any());
    bytes_of(core::array::from_fn(|_| numbers.byte()), numbers.any_vector::<R, 3>());
    spaces(numbers.vector_within::<R, 3>(1e12), core::array::from_fn(|_| numbers.positive::<R>(6)));
    let lab = |numbers: &mut Numbers| {
        let [a, b] = numbers.vector_within::<R, 2>(range);
        // Products of smaller ones underflow.
        let plain = |c: R| if c.abs().to_f64() >= 1e-15 { c } else { R::ZERO };
        [numbers.within(range.min(1e50)), plain(a), plain(b)]
    };
    differences([lab(numbers), lab(numbers)]);
    bound::<R>(numbers);
}

/// The transfer curve and f are monotone for all numbers, and come back.
fn transfer<R: Real>(a: R, b: R) {
    let (low, high) = if a <= b { (a, b) } else { (b, a) };
    if low <= high {
        assert!(lab_f(low) <= lab_f(high), "f({low}) = {}, f({high}) = {}", lab_f(low), lab_f(high));
        assert!(lab_f_inverse(low) <= lab_f_inverse(high), "f⁻¹ of {low}, {high}");
        assert!(quantise_8bit(low) <= quantise_8bit(high), "bytes of {low}, {high}");
    }
    if a >= R::ZERO && a <= R::ONE {
        let code = encode_srgb(a);
        assert_in(code, 0.0, 1.0, "sRGB code");
        assert_in(decode_srgb(code) - a, -1e-4, 1e-4, "sRGB round trip");
    }
    if a.abs().to_f64() <= 1e30 {
        let scale = a.abs().to_f64().max(216.0 / 24389.0);
        let most = 6.0 * R::EPSILON.to_f64() * scale;
        assert_in(lab_f_inverse(lab_f(a)) - a, -most, most, "f⁻¹(f)");
    }
}

/// Bytes come back, and any number has bytes.
fn bytes_of<R: Real>(code: [u8; 3], rgb: [R; 3]) {
    let linear = srgb8_to_linear_rgb::<R>(code);
    assert_eq!(linear_rgb_to_srgb8(linear), code);
    let _ = linear_rgb_to_srgb8(rgb);
}

fn spaces<R: Real>(xyz: [R; 3], white: [R; 3]) {
    let epsilon = R::EPSILON.to_f64();
    let size = xyz.iter().fold(0.0, |most: f64, x| most.max(x.abs().to_f64()));
    let back = linear_rgb_to_xyz(xyz_to_linear_rgb(xyz));
    for (a, b) in back.iter().zip(&xyz) {
        let most = 32.0 * epsilon * size + R::MIN_POSITIVE.to_f64();
        assert_in(*a - *b, -most, most, "RGB round trip");
    }
    if let Some(xyy) = xyz_to_xyy(xyz) {
        assert_finite(&xyy, "xyY");
        // y = 0 is black's, by convention.
        if let Some(back) = xyy_to_xyz(xyy).filter(|_| xyy[1] != R::ZERO) {
            // 1/y is what magnifies the rounding of chromaticities.
            let gain = xyy.iter().fold(1.0, |most: f64, c| most.max(c.abs().to_f64() / xyy[1].abs().to_f64()));
            for (a, b) in back.iter().zip(&xyz) {
                let most = 16.0 * epsilon * gain * (size + b.abs().to_f64()) + R::MIN_POSITIVE.to_f64();
                assert!(!((*a - *b).abs().to_f64() > most), "xyY round trip: {back:?} of {xyz:?}");
            }
        }
    }
    let relative: [R; 3] = core::array::from_fn(|i| xyz[i] / white[i]);
    if relative.iter().all(|t| t.abs().to_f64() <= 1e12) {
        let lab = xyz_to_lab(xyz, white);
        assert_finite(&lab, "Lab");
        let back = lab_to_xyz(lab, white);
        for i in 0..3 {
            // L*, a*, b* share f(Y): the rounding of a channel's f is relative to the greatest of them.
            let f = relative.map(|t| lab_f(t).abs().to_f64());
            let rounding = 16.0 * epsilon * (f[i] + f[1] + 1.0);
            let most = white[i].to_f64() * rounding * 3.0 * (f[i] + rounding).powi(2).max(0.05);
            assert_in(back[i] - xyz[i], -most, most, "Lab round trip");
        }
    }
}

fn differences<R: Real>([first, second]: [[R; 3]; 2]) {
    let (ab, de00) = (delta_e_ab(first, second), delta_e_00(first, second));
    assert!(ab >= R::ZERO, "ΔE*ab {ab}");
    assert!(de00 >= R::ZERO && de00.is_finite(), "ΔE00 {de00} of {first:?}, {second:?}");
    assert_eq!(ab, delta_e_ab(second, first));
    assert_eq!(de00, delta_e_00(second, first), "{first:?}, {second:?}");
    assert_eq!(delta_e_ab(first, first), R::ZERO);
    assert_eq!(delta_e_00(first, first), R::ZERO);
}

/// A colour inside a box is no farther away than the bound, which the majorant is not below.
fn bound<R: Real>(numbers: &mut Numbers) {
    let white: [R; 3] = core::array::from_fn(|_| numbers.positive(6));
    let xyz: [R; 3] = core::array::from_fn(|i| white[i] * numbers.within::<R>(1e6));
    let radius: [R; 3] = core::array::from_fn(|i| white[i] * numbers.within::<R>(1e6).abs());
    let inside: [R; 3] = core::array::from_fn(|i| {
        let shift = radius[i] * (R::TWO * numbers.unit::<R>() - R::ONE);
        // Rounding must not leave the box by more than the bound allows.
        xyz[i] + shift
    });
    let limit = delta_e_bound(xyz, radius, white);
    assert!(limit.delta_e >= R::ZERO && limit.delta_e.is_finite(), "{limit:?}");
    let exact = |c: [R; 3]| xyz_to_lab(c.map(R::to_f64), white.map(R::to_f64));
    let away = delta_e_ab(exact(xyz), exact(inside));
    assert!(
        away <= limit.delta_e.to_f64(),
        "{away} of {limit:?}: {xyz:?} ± {radius:?} with {inside:?}, white {white:?}"
    );
    if xyz.iter().all(|c| *c >= R::ZERO) {
        let majorant = delta_e_majorant(xyz, radius, white);
        // But for rounding, which the bound of a single colour is made of.
        let rounding = delta_e_bound(xyz, [R::ZERO; 3], white).delta_e;
        let most = majorant * (R::ONE + R::from_f64(64.0) * R::EPSILON) + rounding;
        assert!(most >= limit.delta_e, "{majorant} below {limit:?}");
    }
}
