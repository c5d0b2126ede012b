//! The palette of maps: how even its steps are to the eye, also to eyes without one kind of cone.
#![allow(clippy::print_stdout, reason = "figures for people who run the test with --nocapture")]

use renderers::image::Palette;
use spectral_core::colour::rgb::WHITE;
use spectral_core::colour::{delta_e_00, linear_rgb_to_xyz, srgb8_to_linear_rgb, xyz_to_lab};

/// Linear sRGB as it looks without long-wave and without medium-wave cones: Machado, Oliveira and Fernandes, "A
/// Physiologically-based Model for Simulation of Color Vision Deficiency" (IEEE TVCG 15(6), 2009), severity 1.0.
const PROTANOPIA: [[f64; 3]; 3] =
    [[0.152_286, 1.052_583, -0.204_868], [0.114_503, 0.786_281, 0.099_216], [-0.003_882, -0.048_116, 1.051_998]];
const DEUTERANOPIA: [[f64; 3]; 3] =
    [[0.367_322, 0.860_646, -0.227_968], [0.280_085, 0.672_501, 0.047_413], [-0.011_820, 0.042_940, 0.968_881]];
const NORMAL: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// CIELAB of the palette's colours as an eye sees them; what is outside the gamut is cut off, as the authors do.
fn seen(palette: Palette, count: usize, eye: [[f64; 3]; 3]) -> Vec<[f64; 3]> {
    let colours = palette.steps(count).into_iter().map(srgb8_to_linear_rgb::<f64>);
    let look = |rgb: [f64; 3]| eye.map(|row| (row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2]).clamp(0.0, 1.0));
    colours.map(|rgb| xyz_to_lab(linear_rgb_to_xyz(look(rgb)), WHITE)).collect()
}

/// The least, the mean and the largest ΔE00 between neighbours.
fn steps(labs: &[[f64; 3]]) -> [f64; 3] {
    let steps: Vec<f64> = labs.windows(2).map(|pair| delta_e_00(pair[0], pair[1])).collect();
    #[allow(clippy::cast_precision_loss, reason = "few steps")]
    let mean = steps.iter().sum::<f64>() / steps.len() as f64;
    [steps.iter().copied().fold(f64::INFINITY, f64::min), mean, steps.iter().copied().fold(0.0, f64::max)]
}

#[test]
fn steps_are_even_and_lightness_rises_for_all_eyes() {
    for (name, eye) in [("normal", NORMAL), ("protanopia", PROTANOPIA), ("deuteranopia", DEUTERANOPIA)] {
        let labs = seen(Palette::Cividis, 17, eye);
        let [least, mean, most] = steps(&labs);
        let share = if name == "normal" { 0.15 } else { 0.25 };
        println!("{name}: ΔE00 of 16 steps {least:.2} to {most:.2}, mean {mean:.2}");
        // A difference of 1 is just noticeable, and lightness alone tells the order.
        assert!(
            least >= (1.0 - share) * mean && most <= (1.0 + share) * mean && least >= 4.0,
            "{name}: {least} {mean} {most}"
        );
        assert!(labs.windows(2).all(|pair| pair[0][0] + 3.0 < pair[1][0]), "{name}");
    }
}

/// Signs are told apart by dichromats, too: the ends differ from each other by more than from the middle's neighbours.
#[test]
fn signs_are_told_apart_by_all_eyes() {
    for (name, eye) in [("normal", NORMAL), ("protanopia", PROTANOPIA), ("deuteranopia", DEUTERANOPIA)] {
        let labs = seen(Palette::CoolWarm, 17, eye);
        for off in 3..=8 {
            let difference = delta_e_00(labs[8 - off], labs[8 + off]);
            println!("{name}: ±{off}/8: ΔE00 {difference:.1}");
            assert!(difference >= 5.0, "{name}, ±{off}/8: {difference}");
        }
    }
}

/// Grey, where there is no value, is no colour of the palette for any eye.
#[test]
fn grey_is_not_a_value() {
    for eye in [NORMAL, PROTANOPIA, DEUTERANOPIA] {
        let grey = srgb8_to_linear_rgb::<f64>([222; 3]);
        let grey = xyz_to_lab(linear_rgb_to_xyz(grey), WHITE);
        let nearest =
            seen(Palette::Cividis, 256, eye).into_iter().map(|lab| delta_e_00(lab, grey)).fold(f64::INFINITY, f64::min);
        println!("grey is {nearest:.1} from the nearest colour");
        assert!(nearest >= 20.0, "{nearest}");
    }
}
