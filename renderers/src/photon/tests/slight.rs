//! Light whose way depends on the wavelength, where it hardly counts.

use glam::Vec3A;

use super::{Stage, glass, point};
use crate::geometry::Ray;
use crate::photon::passing::Passing;
use crate::photon::{Bundle, Density, Maps, Rethrow, Settings};
use crate::radiosity::Representation;
use crate::spectral::{Factor, UniformBins};
use crate::whitted::{Arrived, Caustics, Dispersion, How};

/// How many of some places, out of so many in each direction, are lit white, where light would not be slight that is of one third of the waves alone; and how many are lit.
fn white_places(name: &str, side: u16, shrink: f32, is_asked: impl Fn(Vec3A) -> bool) -> (u32, u32) {
    let stage = Stage::built_in(name);
    let emission = stage.emission(Settings::default());
    let photons: (_, _, &(dyn Fn(u64) + Sync)) = (100_000, 0, &|_| {});
    let how = (Bundle::Continuous, Rethrow::Interpolated);
    let maps = Maps::new((&stage.scene, &stage.whitted), &emission, photons, (Density::default(), shrink), how);
    // Of passes whose radii shrink, less is taken as white.
    let part = f64::from(shrink) * f64::from(shrink);
    let (mut white, mut lit, mut found) = (0, 0, Arrived::default());
    for place in 0..side * side {
        let [x, y] = [place % side, place / side].map(|p| 16.0 * (f32::from(p) + 0.5) / f32::from(side));
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
        // It is never taken to be more even than within a tenth, and never less even than of one third of the waves.
        assert!(!is_slight(0.099 / part * light) && is_slight(1.415 / part * light));
        let is_white = is_slight(light / part);
        // What it costs to take it as white is an error.
        assert!(is_white || squares.sqrt() > sum);
        lit += 1;
        white += u32::from(is_white);
    }
    (white, lit)
}

/// Light of photons, of lights and between surfaces is compared in one unit: each spectrum has the same luminance by its mean and by its bins.
#[test]
fn luminances_are_those_of_rows() {
    let stage = Stage::built_in("cornell-box-spheres");
    let emission = stage.emission(Settings::default());
    let bins = UniformBins::new(&stage.palette, 80).unwrap();
    let (luminances, mut row) = (bins.luminances(), vec![0.0; bins.width()]);
    let mut lit = 0;
    for factor in stage.whitted.light_factors().chain([Factor { scale: 3.0, leaf: None }]) {
        bins.light(factor, &mut row);
        let sum: f64 = luminances.iter().zip(&row).map(|(each, number)| each * number).sum();
        let own = emission.luminance(factor);
        assert!(own > 0.0 && (sum / own - 1.0).abs() <= 1e-3, "{sum} {own}");
        lit += 1;
    }
    assert!(lit > 1);
}

#[test]
fn light_of_one_colour_is_not_slight() {
    // The spectrum on the wall, without its upper end, which overlaps itself.
    let (white, lit) = white_places("prism", 48, 1.0, |position| position.y < -6.9 && position.z < 1.7);
    assert!(lit > 20 && white <= 1, "{white} of {lit}");
    // Few places have as many photons within smaller radii.
    for (shrink, fewest) in [(1.0, 800), (0.5, 25)] {
        let (white, lit) = white_places("cornell-box-spheres", 64, shrink, |_| true);
        assert!(lit > fewest && 20 * (lit - white) < lit, "{shrink}: {white} of {lit}");
    }
}

/// White light is as much as the mean of coloured light, on flat and on curved surfaces: interpolated photons are a little off these.
#[test]
fn white_light_is_the_mean_of_coloured_light() {
    let lens = |receiver: &str| {
        let shape = format!(r#"<shape type="{receiver}<bsdf type="diffuse"/></shape>"#);
        let ball =
            format!(r#"<shape type="sphere"><point name="center" value="0, 0, 5"/>{}</shape>"#, glass("SF10", ""));
        Stage::of(&format!("{shape}{ball}{}", point("0, 0, 9")))
    };
    let plane = r#"rectangle"><transform name="to_world"><scale value="4"/></transform>"#;
    let ball = r#"sphere"><point name="center" value="0, 0, 1"/>"#;
    for (receiver, height) in [(plane, 0.0_f32), (ball, 1.0)] {
        let stage = lens(receiver);
        let emission = stage.emission(Settings::default());
        let photons: (_, _, &(dyn Fn(u64) + Sync)) = (50_000, 0, &|_| {});
        let how = (Bundle::Continuous, Rethrow::Interpolated);
        let maps = Maps::new((&stage.scene, &stage.whitted), &emission, photons, (Density::default(), 1.0), how);
        let (mut white, mut coloured, mut found) = (0.0, 0.0, Arrived::default());
        for place in 0..400_u16 {
            let [x, y] = [place % 20, place / 20].map(|p| (f32::from(p) - 9.5) / 12.0);
            let ray = Ray::new(Vec3A::new(x, y, 3.5), Vec3A::NEG_Z);
            let Some(hit) = stage.whitted.world().closest_hit(&ray).filter(|hit| hit.position.z <= 1.0 + height) else {
                continue;
            };
            let mut look = |slight: f64| {
                maps.dispersed(&hit, How { least: 0.0, alike: true, slight }, None, &mut found);
                let passed = &found.passed;
                let mean = |passing: &Passing| {
                    let known = &passed.irradiances[passing.known.clone()];
                    known.iter().map(|x| f64::from(*x)).sum::<f64>() / known.iter().map(|_| 1.0).sum::<f64>()
                };
                let all: f64 = found.list.iter().map(|arriving| arriving.irradiance).sum();
                (all, passed.share * passed.list.iter().map(mean).sum::<f64>())
            };
            white += look(f64::INFINITY).0;
            coloured += look(0.0).1;
        }
        assert!(coloured > 0.0 && (white / coloured - 1.0).abs() <= 0.03, "{height}: {white} {coloured}");
    }
}
