//! The photon map's caustics against those of light tracing, and how errors fall with the number of photons.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use core::f64::consts::PI;

use renderers::direct;
use renderers::geometry::{Camera, FovAxis};
use renderers::render::{Options, PhotonCount, PhotonOptions, Renderer, Rendering, Spectra, render};
use renderers::scene::{BsdfKind, Scene, builtin};
use spectral_core::colour::rgb::{WHITE, linear_rgb_to_xyz};
use spectral_core::colour::{delta_e_00, xyz_to_lab};
use spectral_tests::bodies::tilted_square;
use spectral_tests::light_tracing::{Aim, Estimate, Film, LightTracer};
use spectral_tests::receiver::Receiver;
use spectral_tests::snell::{Focus, Lens, Way};

const SIDE: u32 = 64;

fn options(count: u64, seed: u64) -> Options {
    let photons = PhotonOptions { count: PhotonCount::Count(count), between: false, ..PhotonOptions::default() };
    Options { size: Some([SIDE; 2]), samples: Some(4), seed: Some(seed), photons, ..Options::default() }
}

fn xyz(rendering: &Rendering) -> Vec<[f64; 3]> {
    rendering.picture.pixels().iter().map(|p| linear_rgb_to_xyz(p.map(f64::from))).collect()
}

fn picture(scene: &Scene, renderer: Renderer, options: &Options) -> Vec<[f64; 3]> {
    xyz(&render(scene, &Options { renderer, ..*options }, &|_| {}).unwrap())
}

fn minus(a: &[[f64; 3]], b: &[[f64; 3]]) -> Vec<[f64; 3]> {
    a.iter().zip(b).map(|(a, b)| core::array::from_fn(|c| a[c] - b[c])).collect()
}

/// The pixels that see surfaces which scatter, and nothing else: caustics behind glass or in mirrors are not the light tracer's.
fn seen_directly(scene: &Scene) -> Vec<bool> {
    const FINE: u32 = 6;
    let world = direct::world(scene).unwrap();
    // Pictures are square: all axes have the same field of view.
    let eye = &scene.camera;
    let camera = Camera::new(&eye.to_world, eye.fov, FovAxis::X, SIDE, SIDE).unwrap();
    let scatters = |shape: u32| {
        !matches!(
            scene.bsdf(scene.shapes[shape as usize].bsdf).kind,
            BsdfKind::Dielectric { .. } | BsdfKind::Conductor { .. }
        )
    };
    let sees = |x: f32, y: f32| world.closest_hit(&camera.ray(x, y)).is_none_or(|hit| scatters(hit.shape));
    #[allow(clippy::cast_precision_loss, reason = "pixel coordinates")]
    let pixel = |x: u32, y: u32| {
        let at = |number: u32, part: u32| number as f32 + part as f32 / FINE as f32;
        (0..=FINE).all(|b| (0..=FINE).all(|a| sees(at(x, a), at(y, b))))
    };
    (0..SIDE * SIDE).map(|number| pixel(number % SIDE, number / SIDE)).collect()
}

/// A scene's caustics by light tracing, with standard errors of luminance.
struct Truth {
    xyz: Vec<[f64; 3]>,
    variance: Vec<f64>,
    /// The pixels that count.
    counts: Vec<bool>,
}

impl Truth {
    fn new(scene: &Scene, batches: u64) -> Self {
        let tracer = LightTracer::new(scene, Aim::Specular).unwrap();
        let mut film = Film::new(&tracer, [SIDE; 2], 1).unwrap();
        film.add(batches).unwrap();
        let variance = film.variances().into_iter().map(|[.., y]| y).collect();
        Self { xyz: film.xyz(), variance, counts: seen_directly(scene) }
    }

    /// The sum over all pixels that count, and its standard error.
    fn flux(&self) -> Estimate {
        let of = |values: &mut dyn Iterator<Item = f64>| {
            values.zip(&self.counts).filter(|(_, c)| **c).map(|(v, _)| v).sum::<f64>()
        };
        Estimate { mean: of(&mut self.xyz.iter().map(|p| p[1])), error: of(&mut self.variance.iter().copied()).sqrt() }
    }

    fn flux_of(&self, xyz: &[[f64; 3]]) -> f64 {
        xyz.iter().zip(&self.counts).filter(|(_, c)| **c).map(|(p, _)| p[1]).sum()
    }
}

/// Mean and 95th percentile.
fn statistics(mut values: Vec<f64>) -> [f64; 2] {
    values.sort_by(f64::total_cmp);
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    [mean, values[values.len() * 95 / 100]]
}

/// `independent`: light tracing, with another emission, other optics and another camera.
#[test]
fn caustics_are_those_of_light_tracing() {
    for (name, parameters) in [
        ("cornell-box-glass", vec![]),
        ("cornell-box-glass", vec![("glass".to_owned(), "N-BK7".to_owned())]),
        ("caustic-ring", vec![]),
        ("caustic-ring-mirror", vec![("metal".to_owned(), "Au".to_owned())]),
        ("prism", vec![]),
        ("prism-lamp", vec![]),
    ] {
        let scene = builtin::load(name, &parameters).unwrap();
        let t = std::time::Instant::now();
        let truth = Truth::new(&scene, 48);
        let seconds = t.elapsed().as_secs_f64();
        let flux = truth.flux();
        let t = std::time::Instant::now();
        let mut found = vec![];
        for seed in 0..4 {
            let options = options(200_000, seed);
            let direct = picture(&scene, Renderer::Whitted, &options);
            let caustic = minus(&picture(&scene, Renderer::PhotonMap, &options), &direct);
            found.push(truth.flux_of(&caustic) / flux.mean);
            if seed == 0 {
                // Where caustics have a hundredth of what they have in bright places.
                let bright = statistics(
                    truth.xyz.iter().zip(&truth.counts).filter(|(p, c)| **c && p[1] > 0.0).map(|(p, _)| p[1]).collect(),
                )[1];
                let lab =
                    |caustic: [f64; 3], direct: [f64; 3]| xyz_to_lab([0, 1, 2].map(|c| caustic[c] + direct[c]), WHITE);
                let pixels = (0..direct.len()).filter(|k| truth.counts[*k] && truth.xyz[*k][1] >= 0.05 * bright);
                let differences: Vec<f64> =
                    pixels.map(|k| delta_e_00(lab(caustic[k], direct[k]), lab(truth.xyz[k], direct[k]))).collect();
                println!("{name}: {} pixels, bright {bright} ΔE00 {:.3?}", differences.len(), statistics(differences));
            }
        }
        let photon = Estimate::of(&found);
        println!(
            "{name}: ratio {photon:?} truth ± {:.5}; truth {seconds:.1} s, four pictures {:.1} s",
            flux.error / flux.mean,
            t.elapsed().as_secs_f64()
        );
    }
}

/// Shading normals that are not the geometric ones: light is the adjoint of what is seen.
#[test]
fn tilted_normals_bend_light_as_they_bend_sight() {
    let glass = "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";
    let square = |bsdf: &str, transform: &str| {
        format!(
            "<shape type='obj'><string name='filename' value='square.obj'/><transform name='to_world'>{transform}</transform>{bsdf}</shape>"
        )
    };
    let lamp = "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='90'/><scale x='2' z='1.5'/>
        <translate x='0.4' y='5'/></transform><emitter type='area'><spectrum name='radiance' value='1'/></emitter></shape>";
    let receiver = Receiver::floor(0.0, 4.0, 1.5);
    for (name, body) in [
        ("glass", square(glass, "<translate x='1.0' y='2'/>")),
        (
            "mirror",
            square(
                "<bsdf type='conductor'/>",
                "<rotate z='1' angle='-50'/><scale value='1.6'/><translate x='-3' y='2.5'/>",
            ),
        ),
    ] {
        let scene = receiver.scene(&format!("{lamp}{body}"), &[("square.obj", &tilted_square())]).unwrap();
        let tracer = LightTracer::new(&scene, Aim::Specular).unwrap();
        let mut film = Film::new(&tracer, [SIDE; 2], 1).unwrap();
        film.add(24).unwrap();
        let truth: f64 = film.xyz().iter().map(|p| p[1]).sum();
        let of = |seed| {
            let options = Options { spectra: Spectra::Uniform(1), ..options(50_000, seed) };
            let direct = picture(&scene, Renderer::Whitted, &options);
            minus(&picture(&scene, Renderer::PhotonMap, &options), &direct).iter().map(|p| p[1]).sum::<f64>() / truth
        };
        println!(
            "tilted {name}: {:?} {}",
            Estimate::of(&(0..4).map(of).collect::<Vec<_>>()),
            film.variances().iter().map(|v| v[3]).sum::<f64>().sqrt() / truth
        );
    }
}

/// A smooth receiver behind a ball, whose irradiance is known.
#[test]
fn errors_fall_with_the_number_of_photons() {
    let receiver = Receiver::floor(-2.0, 1.0, 0.8);
    let body = "<emitter type='directional'><vector name='direction' x='0' y='-1' z='0'/><spectrum name='irradiance' value='1'/></emitter>
        <shape type='sphere'><bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf></shape>";
    let scene = receiver.scene(body, &[]).unwrap();
    let focus = Focus { lens: Lens::Ball, radius: 1.0, index: 1.5, distance: 2.0 };
    let ways: Vec<Way> = (0..6).map(Way::Through).chain([Way::Reflected]).collect();
    // The flux within circles.
    const STEPS: usize = 300;
    let step = 1.5 / STEPS as f64;
    let flux: Vec<f64> = (0..=STEPS)
        .map(|k| if k == 0 { 0.0 } else { ways.iter().map(|way| focus.flux(*way, k as f64 * step)).sum() })
        .collect();
    let irradiance = |r: f64| {
        let k = ((r / step) as usize).min(STEPS - 1);
        (flux[k + 1] - flux[k]) / (PI * step * step * (2 * k + 1) as f64)
    };
    let side = 48_u32;
    let pixel = 2.0 / f64::from(side);
    let truth: Vec<f64> = (0..side * side)
        .map(|n| {
            let at = |number: u32, part: u32| (f64::from(number) + (f64::from(part) + 0.5) / 16.0) * pixel - 1.0;
            (0..256).map(|p| irradiance(at(n % side, p % 16).hypot(at(n / side, p / 16)))).sum::<f64>() / 256.0
        })
        .collect();
    println!("within 0.2 {}, centre {}", irradiance(0.01), irradiance(0.2));
    for adaptive in [true, false] {
        for (seed, count) in [1000_u64, 4000, 16_000, 64_000, 256_000, 1_024_000].into_iter().enumerate() {
            let nearest = (1.0 * (count as f64).powf(2.0 / 3.0)) as usize;
            let photons = PhotonOptions {
                count: PhotonCount::Count(count),
                radius: Some(1.0),
                nearest,
                adaptive,
                between: false,
                ..PhotonOptions::default()
            };
            let options = Options {
                spectra: Spectra::Uniform(1),
                size: Some([side; 2]),
                samples: Some(4),
                seed: Some(seed as u64),
                photons,
                ..Options::default()
            };
            let t = std::time::Instant::now();
            let (map, _) = receiver.caustics(&scene, &options).unwrap();
            let (mut squares, mut norm) = (0.0, 0.0);
            for (found, truth) in map.pixels().iter().zip(&truth) {
                squares += (found[1] - truth).powi(2);
                norm += truth * truth;
            }
            println!(
                "{adaptive} {count} k {nearest}: {:.5} {:.2} s flux {:?}",
                (squares / norm).sqrt(),
                t.elapsed().as_secs_f64(),
                map.flux_within(0.9)[1] / flux[180]
            );
        }
    }
}
