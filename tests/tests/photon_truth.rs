//! The photon map's caustics in built-in scenes against those of light tracing.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]
#![allow(clippy::print_stdout, reason = "figures for who runs a test with --nocapture")]

use renderers::direct;
use renderers::geometry::{Camera, FovAxis};
use renderers::render::{Between, Options, PhotonCount, PhotonOptions, Renderer, Rendering, Spectra, render};
use renderers::scene::{BsdfKind, Scene, builtin};
use spectral_core::colour::rgb::{WHITE, linear_rgb_to_xyz};
use spectral_core::colour::{delta_e_00, xyz_to_lab};
use spectral_tests::bodies::tilted_square;
use spectral_tests::light_tracing::{Aim, Estimate, Film, LightTracer};
use spectral_tests::receiver::Receiver;

/// Pixels along a side.
const SIDE: u32 = 64;
const SEEDS: u64 = 4;
/// How far fluxes may be from those of light tracing.
const TOLERANCE: f64 = 0.005;

/// A scene, and how it is rendered.
struct Case {
    name: &'static str,
    parameters: &'static [(&'static str, &'static str)],
    /// Batches of light tracing.
    batches: u64,
    photons: u64,
    /// Bins of the spectrum where fluxes are compared, and where colours are.
    bins: [usize; 2],
    /// Camera rays a pixel, where fluxes are compared.
    samples: u32,
    /// The radius of the estimates whose flux is compared: so small that little light crosses the limits of what is seen.
    radius: f64,
    /// The most that a standard error may be.
    noise: f64,
    /// The most that mean and 95th percentile of ΔE00 may be by default.
    differences: [f64; 2],
}

fn options(photons: u64, seed: u64) -> Options {
    let photons =
        PhotonOptions { count: PhotonCount::Count(photons), between: Between::Ambient, ..PhotonOptions::default() };
    Options { size: Some([SIDE; 2]), samples: Some(16), seed: Some(seed), photons, ..Options::default() }
}

fn xyz(rendering: &Rendering) -> Vec<[f64; 3]> {
    rendering.picture.pixels().iter().map(|p| linear_rgb_to_xyz(p.map(f64::from))).collect()
}

fn picture(scene: &Scene, renderer: Renderer, options: &Options) -> Vec<[f64; 3]> {
    xyz(&render(scene, &Options { renderer, ..*options }, &|_| {}).unwrap())
}

/// Caustics alone, and all other light.
fn caustics(scene: &Scene, options: &Options) -> [Vec<[f64; 3]>; 2] {
    let [whole, direct] = [Renderer::PhotonMap, Renderer::Whitted].map(|renderer| picture(scene, renderer, options));
    let minus = |(a, b): (&[f64; 3], &[f64; 3])| core::array::from_fn(|c| a[c] - b[c]);
    [whole.iter().zip(&direct).map(minus).collect(), direct]
}

/// The pixels that see surfaces which scatter, and nothing else: caustics behind glass or in mirrors are not the light tracer's.
fn seen_directly(scene: &Scene) -> Vec<bool> {
    const FINE: u32 = 6;
    let world = direct::world(scene).unwrap();
    // Pictures are square: all axes have the same field of view.
    let eye = &scene.camera;
    let camera = Camera::new(&eye.to_world, eye.fov, FovAxis::X, SIDE, SIDE).unwrap();
    let scatters = |shape: u32| {
        let kind = &scene.bsdf(scene.shapes[shape as usize].bsdf).kind;
        !matches!(kind, BsdfKind::Dielectric { .. } | BsdfKind::Conductor { .. })
    };
    let sees = |x: f32, y: f32| world.closest_hit(&camera.ray(x, y)).is_none_or(|hit| scatters(hit.shape));
    #[allow(clippy::cast_precision_loss, reason = "pixel coordinates")]
    let pixel = |x: u32, y: u32| {
        let at = |number: u32, part: u32| number as f32 + part as f32 / FINE as f32;
        (0..=FINE).all(|b| (0..=FINE).all(|a| sees(at(x, a), at(y, b))))
    };
    (0..SIDE * SIDE).map(|number| pixel(number % SIDE, number / SIDE)).collect()
}

/// A scene's caustics by light tracing.
struct Truth {
    xyz: Vec<[f64; 3]>,
    /// The variance of luminance.
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

    /// The sum of what counts.
    fn sum(&self, values: impl Iterator<Item = f64>) -> f64 {
        values.zip(&self.counts).filter(|(_, counts)| **counts).map(|(value, _)| value).sum()
    }

    fn flux_of(&self, xyz: &[[f64; 3]]) -> f64 {
        self.sum(xyz.iter().map(|p| p[1]))
    }

    /// The flux of caustics relative to the truth, over seeds, with the error of both.
    fn ratio(&self, scene: &Scene, of_seed: impl Fn(u64) -> Options) -> Estimate {
        let flux = self.flux_of(&self.xyz);
        let found: Vec<f64> = (0..SEEDS).map(|seed| self.flux_of(&caustics(scene, &of_seed(seed))[0]) / flux).collect();
        let Estimate { mean, error } = Estimate::of(&found);
        Estimate { mean, error: error.hypot(self.sum(self.variance.iter().copied()).sqrt() / flux) }
    }

    /// Mean and 95th percentile of ΔE00 over the caustic, where it has a twentieth of the luminance of bright places.
    fn differences(&self, [caustic, direct]: &[Vec<[f64; 3]>; 2]) -> [f64; 2] {
        let lit = |k: &usize| self.counts[*k] && self.xyz[*k][1] > 0.0;
        let mut luminances: Vec<f64> = (0..self.xyz.len()).filter(lit).map(|k| self.xyz[k][1]).collect();
        let bright = percentile(&mut luminances);
        let lab = |caustic: &[f64; 3], direct: &[f64; 3]| xyz_to_lab([0, 1, 2].map(|c| caustic[c] + direct[c]), WHITE);
        let on_caustic = (0..self.xyz.len()).filter(|k| self.counts[*k] && self.xyz[*k][1] >= 0.05 * bright);
        let mut found: Vec<f64> =
            on_caustic.map(|k| delta_e_00(lab(&caustic[k], &direct[k]), lab(&self.xyz[k], &direct[k]))).collect();
        #[allow(clippy::cast_precision_loss, reason = "pixels")]
        let mean = found.iter().sum::<f64>() / found.len() as f64;
        [mean, percentile(&mut found)]
    }
}

/// The 95th.
fn percentile(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() * 95 / 100]
}

/// `independent`: light tracing, with another emission, other optics and another camera.
fn check(case: &Case) {
    let parameters: Vec<_> = case.parameters.iter().map(|(n, v)| ((*n).to_owned(), (*v).to_owned())).collect();
    let scene = builtin::load(case.name, &parameters).unwrap();
    let truth = Truth::new(&scene, case.batches);
    let plain = |seed| Options {
        spectra: Spectra::Uniform(case.bins[0]),
        samples: Some(case.samples),
        ..options(case.photons, seed)
    };
    let fixed = |seed| {
        let Options { photons, .. } = plain(seed);
        let photons = PhotonOptions { radius: Some(case.radius), nearest: 1 << 20, adaptive: false, ..photons };
        Options { photons, ..plain(seed) }
    };
    let fine = Options { spectra: Spectra::Uniform(case.bins[1]), ..options(case.photons, SEEDS) };
    let [mean, most] = truth.differences(&caustics(&scene, &fine));
    println!("{} {:?}: ΔE00 {mean:.2}, 95 % {most:.2}", case.name, case.parameters);
    assert!(mean <= case.differences[0] && most <= case.differences[1], "{}: {mean} {most}", case.name);
    assert_flux(&format!("{}, fixed radius", case.name), truth.ratio(&scene, fixed), [TOLERANCE, case.noise]);
    assert_flux(&format!("{}, by default", case.name), truth.ratio(&scene, plain), [TOLERANCE, case.noise]);
}

/// The ratio of a flux to that of light tracing is 1, to a tolerance and three standard errors, which are small enough to tell.
#[track_caller]
fn assert_flux(name: &str, ratio: Estimate, [tolerance, noise]: [f64; 2]) {
    println!("{name}: flux {:+.3} ± {:.3} %", 100.0 * (ratio.mean - 1.0), 100.0 * ratio.error);
    assert!((ratio.mean - 1.0).abs() <= tolerance + 3.0 * ratio.error && ratio.error <= noise, "{name}: {ratio:?}");
}

#[test]
fn a_glass_spheres_caustics_are_those_of_light_tracing() {
    check(&Case {
        name: "cornell-box-glass",
        parameters: &[],
        batches: 24,
        photons: 200_000,
        bins: [20, 20],
        samples: 16,
        radius: 4.0,
        noise: TOLERANCE,
        differences: [0.3, 1.0],
    });
}

#[test]
fn a_dispersive_spheres_caustics_are_those_of_light_tracing() {
    check(&Case {
        name: "cornell-box-glass",
        parameters: &[("glass", "N-BK7")],
        batches: 8,
        photons: 30_000,
        bins: [16, 20],
        samples: 16,
        radius: 4.0,
        noise: TOLERANCE,
        differences: [0.8, 3.0],
    });
}

#[test]
fn a_glass_rings_caustics_are_those_of_light_tracing() {
    check(&Case {
        name: "caustic-ring",
        parameters: &[],
        batches: 12,
        photons: 60_000,
        bins: [16, 16],
        samples: 4,
        radius: 0.05,
        noise: TOLERANCE,
        differences: [2.0, 5.5],
    });
}

#[test]
fn a_mirror_rings_caustics_are_those_of_light_tracing() {
    check(&Case {
        name: "caustic-ring-mirror",
        parameters: &[],
        batches: 32,
        photons: 200_000,
        bins: [40, 40],
        samples: 16,
        radius: 0.05,
        noise: TOLERANCE,
        differences: [1.3, 3.5],
    });
}

#[test]
fn a_prisms_caustics_are_those_of_light_tracing() {
    check(&Case {
        name: "prism",
        parameters: &[],
        batches: 48,
        photons: 20_000,
        bins: [10, 20],
        samples: 16,
        radius: 0.02,
        noise: 0.01,
        differences: [5.0, 16.0],
    });
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
        let truth = Truth { counts: vec![true; (SIDE * SIDE) as usize], ..Truth::new(&scene, 24) };
        let ratio = truth.ratio(&scene, |seed| {
            let Options { photons, .. } = options(50_000, seed);
            let photons = PhotonOptions { radius: Some(0.1), nearest: 1 << 20, adaptive: false, ..photons };
            Options { spectra: Spectra::Uniform(1), samples: Some(4), photons, ..options(50_000, seed) }
        });
        assert_flux(&format!("tilted {name}"), ratio, [TOLERANCE; 2]);
    }
}
