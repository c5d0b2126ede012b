//! Scene files.

use std::sync::OnceLock;

use renderers::render::{Options, Spectra, render};
use renderers::scene::{Geometry, Scene, Source, SpectrumKind, builtin, load};
use renderers::spectral::IntervalSettings;

/// Between the scene and the three files that it may name, `fuzz.spd`, `fuzz.obj` and `fuzz.ies`.
const SEPARATOR: u8 = 0;
/// Scenes larger than this are read but not rendered, for the sake of speed.
const MOST_SHAPES: usize = 64;
const MOST_SPECTRA: usize = 16;

/// Reads the bytes as a scene, with the files of the built-in ones beside it, and renders one pixel of what is accepted.
pub fn scene_xml(bytes: &[u8]) {
    let mut parts = bytes.splitn(4, |byte| *byte == SEPARATOR).map(String::from_utf8_lossy);
    let xml = parts.next().unwrap_or_default();
    let mut source = Source::text("fuzz.xml", xml);
    for (name, text) in assets() {
        source = source.with_asset(name, text);
    }
    for (name, text) in ["fuzz.spd", "fuzz.obj", "fuzz.ies"].into_iter().zip(parts) {
        source = source.with_asset(name, text);
    }
    match load(&source, &[]) {
        Err(error) => super::assert_one_line(&error.to_string()),
        Ok(scene) => {
            check(&scene);
            if scene.shapes.len() <= MOST_SHAPES && scene.spectra.len() <= MOST_SPECTRA {
                render_pixel(&scene);
            }
        }
    }
}

/// Meshes and spectra of all built-in scenes.
fn assets() -> &'static [(String, String)] {
    static ASSETS: OnceLock<Vec<(String, String)>> = OnceLock::new();
    ASSETS.get_or_init(|| {
        let files = builtin::names().filter_map(builtin::source).filter_map(|source| match source {
            Source::Memory { assets, .. } => Some(assets),
            Source::Disk(_) => None,
        });
        let mut all: Vec<_> = files.flatten().collect();
        all.sort();
        all.dedup();
        all
    })
}

/// What the type promises: valid ids, finite numbers in their domains.
fn check(scene: &Scene) {
    for shape in &scene.shapes {
        assert!(shape.bsdf.0 < scene.bsdfs.len() && shape.emitter.is_none_or(|e| e.0 < scene.emitters.len()));
        assert!(shape.geometry.area() > 0.0 && shape.geometry.area().is_finite(), "{}", shape.label);
        if let Geometry::Mesh(mesh) = &shape.geometry {
            assert!(mesh.positions.iter().all(|p| p.is_finite()), "{}", shape.label);
            assert!(mesh.triangles.iter().flatten().all(|i| (*i as usize) < mesh.positions.len()), "{}", shape.label);
        }
    }
    for spectrum in &scene.spectra {
        if let SpectrumKind::Table { wavelengths, values } = &spectrum.kind {
            assert!(wavelengths.windows(2).all(|pair| pair[0] < pair[1]), "{}", spectrum.label);
            assert!(values.iter().all(|v| *v >= 0.0 && v.is_finite()), "{}", spectrum.label);
        }
    }
    assert!(scene.film.width > 0 && scene.film.height > 0);
    assert!(scene.camera.fov > 0.0 && scene.camera.fov < 180.0 && scene.camera.to_world.is_finite());
}

/// A pixel may be refused, but not be NaN, and its bound not be negative.
fn render_pixel(scene: &Scene) {
    for spectra in [Spectra::Rgb, Spectra::Interval(IntervalSettings::default())] {
        let options = Options { spectra, size: Some([1, 1]), samples: Some(2), seed: Some(0), ..Options::default() };
        match render(scene, &options, &|_| {}) {
            Err(error) => super::assert_one_line(&error.to_string()),
            Ok(rendering) => {
                let pixel = rendering.picture.pixels()[0];
                assert!(pixel.iter().all(|value| !value.is_nan()), "{spectra}: {pixel:?}");
                if let Some(bound) = rendering.delta_e {
                    assert!(bound.pixels()[0] >= 0.0, "{:?}", bound.pixels());
                }
            }
        }
    }
}
