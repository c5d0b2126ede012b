//! Photons in all directions against closed forms, and against direct light.

use super::{Balance, Global, GlobalSettings, Kept, longest};
use crate::direct::Receiver;
use crate::luminaire::{LuminousIntensity, PhotometricFile};
use crate::photon::surface;
use crate::scene::{Scene, Source, builtin, load};
use crate::spectral::{FactorOrder, Palette};
use crate::whitted::{Whitted, Worker};
use glam::DVec3;

const DOWN: &str = r#"<rotate x="1" angle="90"/>"#;
const LIT: &str = r#"<emitter type="area"><spectrum name="radiance" value="1"/></emitter>"#;

fn scene(elements: &str) -> Scene {
    let (gammas, candela) = (vec![0.0, 90.0, 180.0], vec![100.0, 190.0, 280.0, 200.0, 110.0, 20.0]);
    let lamp = PhotometricFile::new(LuminousIntensity::table(vec![0.0, 90.0], gammas, candela).unwrap(), "lamp");
    let xml = format!(
        r#"<scene version="3.0.0"><sensor type="perspective"><float name="fov" value="40"/></sensor>{elements}</scene>"#
    );
    load(&Source::text("test.xml", xml).with_asset("lamp.ies", lamp.to_ies()), &[]).unwrap()
}

fn ready(scene: &Scene) -> (Whitted, Palette) {
    let mut palette = Palette::default();
    let whitted = Whitted::new(scene, [16, 16], &mut palette).unwrap();
    (whitted, palette)
}

const fn settings(reflections: Option<u32>) -> GlobalSettings {
    GlobalSettings { seed: 5, reflections, order: FactorOrder::Free }
}

fn diffuse(reflectance: f64) -> String {
    format!(r#"<bsdf type="diffuse"><spectrum name="reflectance" value="{reflectance}"/></bsdf>"#)
}

/// The inside of a cube whose half side is 1.
fn cube(reflectance: f64) -> String {
    format!(r#"<shape type="cube"><boolean name="flip_normals" value="true"/>{}</shape>"#, diffuse(reflectance))
}

/// Nothing is lost: what was emitted is accounted for, and roulette takes nothing on average.
#[test]
fn the_balance_closes() {
    for name in ["cornell-box-glass", "cornell-box-spheres", "cornell-box-paper"] {
        let scene = builtin::load(name, &[]).unwrap();
        let (whitted, palette) = ready(&scene);
        let global = Global::new(&whitted, &palette, settings(None));
        let Balance { emitted, absorbed, gone, too_deep, roulette } =
            global.emit(20_000, (0, Kept::Indirect), &|_| {}).balance;
        assert!(emitted >= 20_000.0 && gone > 0.0, "{name}");
        assert!((emitted - absorbed - gone - too_deep - roulette).abs() <= 1e-9 * emitted, "{name}");
        // Each decision adds a variance of less than 1/4, and there are few for each photon.
        assert!(roulette.abs() <= 5.0 * emitted.sqrt(), "{name}: {roulette}");
    }
}

/// In a closed space, light is reflected ρ/(1 − ρ) times; a limit of reflections leaves the first terms of the series.
#[test]
fn closed_spaces_have_the_sum_of_a_series() {
    let lamp = r#"<emitter type="point"><point name="position" x="0.3" y="0.2" z="-0.4"/><spectrum name="intensity" value="2"/></emitter>"#;
    for (reflectance, limit) in [(0.5_f64, None), (0.9, None), (0.8, Some(0)), (0.8, Some(2))] {
        let scene = scene(&(cube(reflectance) + lamp));
        let (whitted, palette) = ready(&scene);
        let count = 100_000.0;
        let released = Global::new(&whitted, &palette, settings(limit)).emit(100_000, (0, Kept::Indirect), &|_| {});
        let flux: f64 = released.photons.iter().map(|photon| f64::from(photon.flux)).sum();
        let emitted = 4.0 * core::f64::consts::PI * 2.0;
        let mean = match limit {
            None => reflectance / (1.0 - reflectance),
            Some(limit) => (1..=limit).map(|n| reflectance.powi(i32::try_from(n).unwrap())).sum(),
        };
        // The variance of a geometric distribution.
        let error = reflectance.sqrt() / (1.0 - reflectance) / f64::sqrt(count);
        assert!((flux / emitted - mean).abs() <= 5.0 * error, "{reflectance} {limit:?}: {} {mean}", flux / emitted);
        assert!(released.spots.len() == released.photons.len() && !released.caustic.contains(&true));
    }
}

/// `independent`: direct light on a floor, over a grid, for each kind of light.
#[test]
#[allow(clippy::cast_precision_loss, reason = "counts")]
fn photons_bring_as_much_as_direct_light() {
    const SIDE: usize = 64;
    let area = |shape: &str, transform: &str| {
        format!(r#"<shape type="{shape}"><transform name="to_world">{transform}</transform>{LIT}</shape>"#)
    };
    let lights = [
        r#"<emitter type="point"><point name="position" x="0.2" y="1.5" z="0.1"/></emitter>"#.to_owned(),
        area("rectangle", &format!(r#"<scale value="0.3"/>{DOWN}<translate y="1"/>"#)),
        area("disk", &format!(r#"<scale value="0.4"/>{DOWN}<translate y="1"/>"#)),
        area("sphere", r#"<scale value="0.3"/><translate y="1.2"/>"#),
        r#"<emitter type="directional"><vector name="direction" x="0.4" y="-1" z="0.1"/></emitter>"#.to_owned(),
        r#"<emitter type="luminaire"><string name="filename" value="lamp.ies"/><transform name="to_world">
        <rotate x="1" angle="-90"/><translate y="2"/></transform></emitter>"#
            .to_owned(),
    ];
    for light in lights {
        let floor = r#"<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/></transform>"#;
        let scene = scene(&format!("{floor}{}</shape>{light}", diffuse(0.0)));
        let (whitted, palette) = ready(&scene);
        let count = 200_000;
        let global = Global::new(&whitted, &palette, settings(None));
        let released = global.emit(count, (0, Kept::Spread), &|_| {});
        let on_floor = || released.photons.iter().filter(|photon| photon.surface == surface(0, true));
        // One of four counts.
        let found: f64 = on_floor().map(|photon| 4.0 * f64::from(photon.flux)).sum();
        let mut worker = Worker::new(&whitted, FactorOrder::Free);
        let scale = whitted.light_factors().next().unwrap().scale;
        let mut sum = 0.0;
        for cell in 0..SIDE * SIDE {
            let middle = |i: usize| (i as f64 + 0.5) * 2.0 / SIDE as f64 - 1.0;
            let position = DVec3::new(middle(cell % SIDE), 1e-6, middle(cell / SIDE));
            sum += worker.direct(&Receiver::new(position, DVec3::Y, whitted.world()))[0];
        }
        let expected = scale * sum * 4.0 / (SIDE * SIDE) as f64;
        let hits = on_floor().count();
        assert!(hits > 1000, "{light}");
        let error = 5.0 / (hits as f64).sqrt() + 1e-3;
        assert!((found / expected - 1.0).abs() <= error, "{light}: {found} {expected}");
        let fluxes = || on_floor().map(|photon| photon.flux);
        assert!(fluxes().fold(0.0, f32::max) <= 1.001 * fluxes().fold(f32::INFINITY, f32::min), "{light}");
    }
}

/// Products have numbers whatever the number of threads, and as many factors as there is room for.
#[test]
fn products_are_few() {
    let scene = builtin::load("cornell-box", &[]).unwrap();
    let (whitted, palette) = ready(&scene);
    // Of 3 reflectances, products of n or less are n + 3 over 3.
    assert_eq!(longest(&whitted, FactorOrder::Free), 16);
    // 3⁸ < 2¹⁴ < 3⁹.
    assert_eq!(longest(&whitted, FactorOrder::Kept), 8);
    let global = Global::new(&whitted, &palette, settings(None));
    let [one, three] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| global.emit(30_000, (0, Kept::Indirect), &|_| {}))
    });
    assert_eq!((&one.photons, &one.spots), (&three.photons, &three.spots));
    assert!(one.shades.iter().eq(three.shades.iter()));
    assert!(one.shades.iter().all(|(_, leaves)| leaves.len() <= 16) && one.shades.len() <= 969);
}
