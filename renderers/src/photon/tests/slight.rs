//! Light whose way depends on the wavelength, where it hardly counts.

use glam::Vec3A;

use super::{Stage, emit};
use crate::photon::{Bundle, Density, Maps, Rethrow, Settings};
use crate::whitted::{Arrived, Caustics, Dispersion, How};

const SIDE: u8 = 48;

/// Of some places that light comes to, how many have light of about all waves: where it is slight that would not be if it were of one third of them.
fn white_places(name: &str, is_asked: impl Fn(Vec3A) -> bool) -> (u32, u32) {
    let stage = Stage::built_in(name);
    let emission = stage.emission(Settings::default());
    let emitted = emit(&emission, 100_000, 0);
    let how = (Bundle::Continuous, Rethrow::Interpolated);
    let maps = Maps::new((&stage.scene, &stage.whitted), &emission, emitted, (Density::default(), 1.0), how);
    let (mut white, mut lit, mut found) = (0, 0, Arrived::default());
    for place in 0..u16::from(SIDE) * u16::from(SIDE) {
        let [x, y] =
            [place % u16::from(SIDE), place / u16::from(SIDE)].map(|p| 16.0 * (f32::from(p) + 0.5) / f32::from(SIDE));
        let Some(hit) = stage.whitted.world().closest_hit(&stage.whitted.camera().ray(x, y)) else { continue };
        let mut looked = |slight: f64| maps.dispersed(&hit, How { least: 0.0, alike: true, slight }, None, &mut found);
        assert!(!matches!(looked(0.0), Dispersion::Slight(_)));
        assert!(matches!(looked(f64::INFINITY), Dispersion::Slight(_)));
        let light = found.scratch.value;
        let sum: f64 = found.list.iter().map(|arriving| arriving.irradiance).sum();
        let squares: f64 = found.list.iter().map(|arriving| arriving.error * arriving.error).sum();
        assert!(light >= 0.0 && (light > 0.0) == (sum > 0.0));
        if found.list.len() < 20 || !is_asked(hit.position) {
            continue;
        }
        let mut is_slight = |slight: f64| {
            matches!(
                maps.dispersed(&hit, How { least: 0.0, alike: true, slight }, None, &mut found),
                Dispersion::Slight(_)
            )
        };
        // Never more than ten times what it would be were it of one third of the waves, and always if it is less than that.
        assert!(!is_slight(0.099 * light) && is_slight(1.415 * light));
        let is_white = is_slight(light);
        // What it costs to take it as white is an error.
        assert!(is_white || squares.sqrt() > sum);
        lit += 1;
        white += u32::from(is_white);
    }
    (white, lit)
}

#[test]
fn light_of_one_colour_is_not_slight() {
    // The spectrum on the wall, without its upper end, which overlaps itself.
    let (white, lit) = white_places("prism", |position| position.y < -6.9 && position.z < 1.7);
    assert!(lit > 20 && white <= 1, "{white} of {lit}");
    let (white, lit) = white_places("cornell-box-spheres", |_| true);
    assert!(lit > 500 && 20 * (lit - white) < lit, "{white} of {lit}");
}
