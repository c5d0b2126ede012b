//! Renderers over the radiance of their lights, and closed rooms whose walls reflect nearly everything.

use super::{Sweep, domain, powers};
use crate::radiosity::{Flat, Radiosity, Settings};
use crate::render::{Between, Options, PhotonCount, PhotonOptions, Renderer, Spectra, render};
use crate::scene::{Emitter, Scene, SpectrumKind, builtin};
use crate::spectral::Palette;

/// All sweeps of renderers.
pub(super) fn sweeps(quick: bool) -> Result<Vec<Sweep>, String> {
    let mut all = Vec::new();
    for (name, renderer, scene, between) in [
        ("whitted", Renderer::Whitted, "cornell-box", Between::Ambient),
        ("radiosity", Renderer::Radiosity, "cornell-box", Between::Radiosity),
        ("photon map", Renderer::PhotonMap, "cornell-box-glass", Between::Ambient),
        ("paths", Renderer::Path, "cornell-box", Between::Ambient),
    ] {
        all.push(radiance(name, renderer, scene, between, if quick { 10 } else { 2 })?);
    }
    all.push(furnace(quick)?);
    Ok(all)
}

const STEPS_TO_FURTHEST: i32 = 30;

/// Pictures are proportional to the lights' radiance, wherever single precision can hold them.
fn radiance(name: &str, renderer: Renderer, scene: &str, between: Between, stride: usize) -> Result<Sweep, String> {
    let scene = builtin::load(scene, &[]).map_err(|e| e.to_string())?;
    let photons = PhotonOptions { count: PhotonCount::Count(2000), between, ..PhotonOptions::default() };
    let options = Options {
        renderer,
        photons,
        spectra: Spectra::Uniform(8),
        size: Some([16; 2]),
        samples: Some(4),
        between: crate::render::BetweenOptions { accuracy: 0.3, exact: false },
        ..Options::default()
    };
    let picture = |scale: f64| {
        let lit = scaled(&scene, scale);
        let found = render(&lit, &options, &|_| {}).map_err(|e| e.to_string())?;
        Ok::<_, String>(found.picture.pixels().iter().map(|p| p.map(f64::from)).collect::<Vec<_>>())
    };
    let one = picture(1.0)?;
    let brightest = one.iter().flatten().fold(0.0, |m: f64, v| m.max(*v));
    let places: Vec<f64> = powers(-STEPS_TO_FURTHEST, STEPS_TO_FURTHEST, 1).into_iter().step_by(stride).collect();
    let source = "render: linear radiance in f32; the built-in boxes' brightest pixel is some tens, so that f32 holds it from 1e-30 to 1e30 (tolerance: \
                  32 ε of f32, of the brightest pixel)";
    Ok(Sweep::new(
        [&format!("{name}: pictures over radiance"), "f32 pixels", "scale of all lights", "error over the brightest"],
        domain([1e-30, 1e30], 32.0 * f64::from(f32::EPSILON), source),
        &places,
        |scale| {
            let found = picture(scale).ok()?;
            let off = |(f, o): (&[f64; 3], &[f64; 3])| {
                (0..3).map(|c| (f[c] / scale - o[c]).abs() / brightest).fold(0.0, f64::max)
            };
            Some(found.iter().zip(&one).map(off).fold(0.0, f64::max))
        },
    ))
}

/// The scene with all lights so many times as bright.
fn scaled(scene: &Scene, factor: f64) -> Scene {
    let mut scene = scene.clone();
    let lights: Vec<usize> = scene
        .emitters
        .iter()
        .filter_map(|emitter| match emitter {
            Emitter::Area { radiance, .. } | Emitter::Constant { radiance, .. } | Emitter::Ambient { radiance } => {
                Some(radiance.0)
            }
            Emitter::Point { intensity, .. } => Some(intensity.0),
            Emitter::Directional { irradiance, .. } => Some(irradiance.0),
            Emitter::Luminaire { .. } => None,
        })
        .collect();
    let mut done: Vec<usize> = Vec::new();
    for light in lights {
        if done.contains(&light) {
            continue;
        }
        done.push(light);
        match &mut scene.spectra[light].kind {
            SpectrumKind::Constant(value) => *value *= factor,
            SpectrumKind::Table { values, .. } => values.iter_mut().for_each(|v| *v *= factor),
            SpectrumKind::D65 { scale } | SpectrumKind::Blackbody { scale, .. } => *scale *= factor,
        }
    }
    scene
}

/// Radiosity in a closed cube that shines and reflects alike: M/(1 − ρ) everywhere.
fn furnace(quick: bool) -> Result<Sweep, String> {
    // Beyond it, a sum of form factors that is rounded by ε is an error of ε/(1 − ρ), which no iteration mends.
    let source = "README, light between surfaces: closed rooms lose no light, ρ up to 0.999, a furnace within 1e-9";
    let run = |absorbed: f64| {
        let define = [("reflectance".to_owned(), format!("{}", 1.0 - absorbed))];
        let scene = builtin::load("furnace", &define).map_err(|e| e.to_string())?;
        let mut palette = Palette::default();
        let settings = Settings { accuracy: 0.1, ..Settings::default() };
        let radiosity = Radiosity::new(&scene, &settings, &mut palette, &|_| {}).map_err(|e| e.to_string())?;
        let solution = radiosity.solve(&Flat).map_err(|e| e.to_string())?;
        // Reflected radiosity over the radiance that sides send out: ρ π / (1 − ρ), with the reflectance that was read.
        let reflectance: f64 = define[0].1.parse().map_err(|_| "no number".to_owned())?;
        let truth = core::f64::consts::PI * 0.2 * reflectance / (1.0 - reflectance);
        let patches = solution.patches().map(|(row, _)| row.first().copied().unwrap_or(f64::NAN));
        Ok::<_, String>(
            patches.map(|b| (b / truth - 1.0).abs()).fold(0.0, |m: f64, e| if e > m || e.is_nan() { e } else { m }),
        )
    };
    run(0.5)?;
    Ok(Sweep::new(
        ["radiosity: a furnace over what its walls absorb", "f64", "absorbed share 1 − ρ", "relative error"],
        domain([1e-3, 0.9], 1e-9, source),
        &powers(-12, 0, if quick { 1 } else { 2 }),
        |absorbed| if absorbed < 1.0 { run(absorbed).ok() } else { None },
    ))
}
