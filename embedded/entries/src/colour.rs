//! Colour spaces, differences and adaptation.

use core::hint::black_box;

use spectral_core::Real;
use spectral_core::adaptation::{Adaptation, Cie1994, Cie1994Conditions, von_kries_uv};
use spectral_core::colour::{self, RgbSpace, in_precision, rgb};

use crate::Run;

/// A CIELAB colour.
fn lab<R: Real>(run: &mut Run) -> [R; 3] {
    [run.within(0.0, 100.0), run.within(-80.0, 80.0), run.within(-80.0, 80.0)]
}

/// The white of some light.
fn white<R: Real>(run: &mut Run) -> [R; 3] {
    [run.within(0.8, 1.2), R::ONE, run.within(0.3, 1.4)]
}

/// One of the built-in spaces.
fn space(run: &mut Run) -> RgbSpace {
    black_box(match run.below(4) {
        0 => RgbSpace::REC_709,
        1 => RgbSpace::REC_2020,
        2 => RgbSpace::ACESCG,
        _ => RgbSpace::SHARP,
    })
}

entries! {
    colour_delta_e_ab 48 ["colour::delta_e_ab"] |run, R| {
        let (first, second) = (lab::<R>(run), lab::<R>(run));
        let result = run.time_call(|| colour::delta_e_ab(first, second));
        run.put(result);
    }
    colour_delta_e_00 96 ["colour::delta_e_00"] |run, R| {
        let (first, second) = (lab::<R>(run), lab::<R>(run));
        let result = run.time_call(|| colour::delta_e_00(first, second));
        run.put(result);
    }
    colour_delta_e_00_weighted 32 ["colour::delta_e_00_weighted"] |run, R| {
        let (first, second, factors) = (lab::<R>(run), lab::<R>(run), run.array(0.5, 2.0));
        let result = run.time_call(|| colour::delta_e_00_weighted(first, second, factors));
        run.put(result);
    }
    colour_xyz_to_lab 48 ["colour::xyz_to_lab"] |run, R| {
        let (xyz, white) = (run.array(-0.05, 1.2), white::<R>(run));
        let result = run.time_call(|| colour::xyz_to_lab(xyz, white));
        run.put_all(&result);
    }
    colour_lab_to_xyz 48 ["colour::lab_to_xyz"] |run, R| {
        let (lab, white) = (lab::<R>(run), white(run));
        let result = run.time_call(|| colour::lab_to_xyz(lab, white));
        run.put_all(&result);
    }
    colour_lab_f 48 ["colour::lab_f", "colour::lab_f_inverse"] |run, R| {
        let t = run.within::<R>(-0.1, 1.5);
        let result = run.time_call(|| colour::lab_f(t));
        run.put_all(&[result, colour::lab_f_inverse(t)]);
    }
    colour_xyy 32 ["colour::xyz_to_xyy", "colour::xyy_to_xyz"] |run, R| {
        let values = run.array::<R, 3>(-0.05, 1.0);
        let (xyy, xyz) = run.time_call(|| (colour::xyz_to_xyy(values), colour::xyy_to_xyz(values)));
        run.put_option(xyy, |run, values| run.put_all(&values));
        run.put_option(xyz, |run, values| run.put_all(&values));
    }
    colour_linear_rgb 32 ["colour::linear_rgb_to_xyz", "colour::xyz_to_linear_rgb", "colour::in_precision"] |run, R| {
        let values = run.array::<R, 3>(-0.1, 1.1);
        let xyz = run.time_call(|| rgb::linear_rgb_to_xyz(values));
        run.put_all(&xyz);
        run.put_all(&rgb::xyz_to_linear_rgb(values));
        let vector = run.array(0.0, 1.0);
        run.put_all(&in_precision::<R>(vector));
    }
    colour_encode_srgb 48 [
        "colour::encode_srgb", "colour::quantise_8bit", "colour::linear_rgb_to_srgb8",
    ] |run, R| {
        let values = run.array::<R, 3>(-0.1, 1.1);
        let code = run.time_call(|| rgb::encode_srgb(values[0]));
        run.put(code);
        run.put_bits(u64::from(rgb::quantise_8bit(values[1])));
        for code in rgb::linear_rgb_to_srgb8(values) {
            run.put_bits(u64::from(code));
        }
    }
    colour_decode_srgb 48 ["colour::decode_srgb", "colour::srgb8_to_linear_rgb"] |run, R| {
        let code = run.within::<R>(-0.1, 1.1);
        let value = run.time_call(|| rgb::decode_srgb(code));
        run.put(value);
        let [r, g, b, _] = run.bits().to_le_bytes();
        run.put_all(&rgb::srgb8_to_linear_rgb::<R>([r, g, b]));
    }
    colour_rgb_space 24 ["colour::RgbSpace::to_xyz", "colour::RgbSpace::from_xyz"] |run, R| {
        let (space, values) = (space(run), run.array::<R, 3>(0.0, 1.0));
        let xyz = run.time_call(|| space.to_xyz(values));
        run.put_all(&xyz);
        run.put_all(&space.from_xyz(values));
    }
    colour_rgb_space_new 12 [
        "colour::RgbSpace::new", "colour::RgbSpace::primaries", "colour::RgbSpace::white", "colour::rgb_to_xyz_matrix",
    ] |run, R| {
        let [a, b, c, white] = core::array::from_fn(|_| run.array::<f64, 2>(0.05, 0.6));
        let found = run.time_call(|| RgbSpace::new([a, b, c], white));
        run.put_option(found.ok(), |run, space| {
            run.put_all(&in_precision::<R>(space.white()));
            run.put_all(space.primaries().as_flattened());
        });
        run.put_all(rgb::rgb_to_xyz_matrix([a, b, c], white).as_flattened());
    }
    adaptation_bradford 24 [
        "adaptation::Adaptation::bradford", "adaptation::Adaptation::von_kries", "adaptation::Adaptation::apply",
    ] |run, R| {
        let (from, to, xyz) = (white::<R>(run), white(run), run.array(0.0, 1.0));
        let result = run.time_call(|| Adaptation::bradford(from, to).apply(xyz));
        run.put_all(&result);
        run.put_all(&Adaptation::von_kries(from, to).apply(xyz));
    }
    adaptation_von_kries_uv 24 ["adaptation::von_kries_uv"] |run, R| {
        let [sample, test, reference] = core::array::from_fn(|_| run.array::<R, 2>(0.15, 0.4));
        let result = run.time_call(|| von_kries_uv(sample, test, reference));
        run.put_all(&result);
    }
    adaptation_cie_1994 24 ["adaptation::Cie1994::new", "adaptation::Cie1994::apply"] |run, R| {
        let (from, to, xyz) = (white::<R>(run), white(run), run.array(0.01, 1.0));
        let conditions = black_box(Cie1994Conditions::default());
        let result = run.time_call(|| Cie1994::new(from, to, &conditions).apply(xyz));
        run.put_all(&result);
    }
}
