//! The path tracer against closed forms and against the Whitted renderer: z-tests with Šidák's correction.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]
#![allow(clippy::cast_precision_loss, reason = "numbers of pixels and comparisons are small")]

use core::f64::consts::PI;

use renderers::luminaire::{LuminousIntensity, PhotometricFile};
use renderers::path::{Run, Strategy, render};
use renderers::render::{Options, Renderer, Rendering, Spectra};
use renderers::scene::{Integrator, Scene, Source, builtin, load};
use spectral_core::colour::rgb::linear_rgb_to_xyz;
use spectral_tests::statistics::upper_gamma;

/// Rays, hits and pixels are f32: some roundings of each.
const ROUNDING: f64 = 16.0 * f32::EPSILON as f64;
/// The probability that one of a test's comparisons fails by chance.
const SIGNIFICANCE: f64 = 0.01;
/// Independent runs of 64 samples: enough for the normal distribution.
const SAMPLES: u32 = 64 * 128;
const REFLECTANCE: f64 = 0.625;
const RADIANCE: f64 = 7.0;

const FLOOR: &str = "<shape type='rectangle'>
    <transform name='to_world'><rotate x='1' angle='-90'/><scale value='50'/></transform>
    <bsdf type='diffuse'><spectrum name='reflectance' value='0.625'/></bsdf></shape>";

/// A value with the variance of its estimate.
#[derive(Clone, Copy, Debug)]
struct Estimate {
    value: f64,
    variance: f64,
}

impl Estimate {
    /// The mean luminance of some pixels.
    fn of(rendering: &Rendering, pixels: impl Iterator<Item = usize>) -> Self {
        let variances = rendering.variance.as_ref().unwrap().luminance.pixels();
        let (mut value, mut variance, mut count) = (0.0, 0.0, 0.0);
        for pixel in pixels {
            value += luminance(rendering, pixel);
            variance += f64::from(variances[pixel]);
            count += 1.0;
        }
        Self { value: value / count, variance: variance / (count * count) }
    }
}

fn luminance(rendering: &Rendering, pixel: usize) -> f64 {
    linear_rgb_to_xyz(rendering.picture.pixels()[pixel].map(f64::from))[1]
}

/// Collects comparisons, then judges all of them together.
#[derive(Debug, Default)]
struct Comparisons(Vec<(String, f64, f64)>);

impl Comparisons {
    /// An estimate and its expectation, which is known to `tolerance`.
    fn add(&mut self, name: impl ToString, found: Estimate, expected: f64, tolerance: f64) {
        let excess = ((found.value - expected).abs() - tolerance).max(0.0);
        assert!(found.value.is_finite() && found.variance.is_finite(), "{}: {found:?}", name.to_string());
        let z = if excess == 0.0 { 0.0 } else { excess / found.variance.sqrt() };
        let text = format!("{}: {found:?}, expected {expected} within {tolerance}, z = {z:.2}", name.to_string());
        self.0.push((text, z, found.variance.sqrt() / expected.abs()));
    }

    /// Every comparison must pass, and none may be so noisy that it says nothing: a standard error of more than `noise` is refused.
    #[track_caller]
    fn judge(&self, noise: f64) {
        let tests = self.0.len() as f64;
        assert!(tests > 0.0);
        let least = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / tests);
        for (text, z, error) in &self.0 {
            // The probability that a normal number is as far from its mean.
            let p = upper_gamma(0.5, z * z / 2.0);
            assert!(p >= least, "{text}: p = {p:.2e}, less than {least:.2e}");
            assert!(*error <= noise, "{text}: standard error of {error}");
        }
    }
}

fn integrator(max_depth: i32) -> String {
    format!("<integrator type='path'><integer name='max_depth' value='{max_depth}'/></integrator>")
}

/// A camera with so narrow a view that its one pixel is a point, at `eye`, looking at `target`.
fn scene(max_depth: i32, eye: [f64; 3], target: [f64; 3], body: &str) -> Scene {
    let [eye, target] = [eye, target].map(|p| p.map(|x| x.to_string()).join(" "));
    let xml = format!(
        "<scene version='3.0.0'>{}
        <sensor type='perspective'><float name='fov' value='1e-4'/>
        <transform name='to_world'><lookat origin='{eye}' target='{target}' up='0 0 1'/></transform>
        <film type='hdrfilm'><integer name='width' value='1'/><integer name='height' value='1'/>
        <rfilter type='box'/></film></sensor>{body}</scene>",
        integrator(max_depth)
    );
    let gammas = vec![0.0, 90.0, 180.0];
    let candela = vec![100.0, 190.0, 280.0, 200.0, 110.0, 20.0];
    let lamp = PhotometricFile::new(LuminousIntensity::table(vec![0.0, 90.0], gammas, candela).unwrap(), "lamp");
    let source = Source::text("test.xml", xml).with_asset("light.obj", POLYGON).with_asset("lamp.ies", lamp.to_ies());
    load(&source, &[]).unwrap()
}

fn options(spectra: Spectra, samples: u32) -> Options {
    Options { renderer: Renderer::Path, spectra, samples: Some(samples), ..Options::default() }
}

fn traced(scene: &Scene, strategy: Strategy, options: &Options) -> Rendering {
    render(scene, options, Run { strategy, ..Run::default() }, &|_| {}).unwrap()
}

/// Luminance of a scene's one pixel.
fn point(scene: &Scene) -> Estimate {
    let rendering = traced(scene, Strategy::Both, &options(Spectra::Uniform(8), SAMPLES));
    Estimate::of(&rendering, 0..1)
}

/// Luminance of the floor at (x, 0, 0) in direct light, seen from straight above.
fn floor(x: f64, body: &str) -> Estimate {
    point(&scene(2, [x, 0.05, 0.0], [x, 0.0, 0.0], &format!("{FLOOR}{body}")))
}

const DOWN: &str = "<rotate x='1' angle='90'/>";

fn area_light(shape: &str, transform: &str) -> String {
    format!(
        "<shape type='{shape}'><transform name='to_world'>{transform}</transform>
        <emitter type='area'><spectrum name='radiance' value='{RADIANCE}'/></emitter></shape>"
    )
}

/// Hamilton and Morgan 1952: a disk parallel to the receiver at distance h, its axis at distance x.
fn disk_factor(r: f64, h: f64, x: f64) -> f64 {
    let sum = h * h + x * x;
    0.5 * (1.0 - (sum - r * r) / ((sum + r * r).powi(2) - 4.0 * r * r * x * x).sqrt())
}

/// `published`: configuration factors of a disk, and of a sphere above the horizon: (r/d)² cos θ.
#[test]
fn round_lights_over_a_plane_are_their_closed_forms() {
    let mut all = Comparisons::default();
    for (r, h) in [(0.4, 3.55), (1.0, 1.0), (1.0, 0.1)] {
        let light = area_light("disk", &format!("{DOWN}<scale value='{r}'/><translate y='{h}'/>"));
        for x in [0.0, 0.9, 3.0] {
            let expected = RADIANCE * REFLECTANCE * disk_factor(r, h, x);
            all.add(format!("disk {r} {h} {x}"), floor(x, &light), expected, ROUNDING * expected * (1.0 + x / h));
        }
    }
    for (r, h) in [(0.25_f64, 1.0_f64), (1.0, 1.05), (0.001, 1.0)] {
        let light = format!(
            "<shape type='sphere'><point name='center' value='0 {h} 0'/><float name='radius' value='{r}'/>
            <emitter type='area'><spectrum name='radiance' value='{RADIANCE}'/></emitter></shape>"
        );
        for x in [0.0_f64, 1.0] {
            let distance = h.hypot(x);
            let expected = RADIANCE * REFLECTANCE * (r / distance).powi(2) * h / distance;
            // The camera would be in the larger sphere: it looks from the side.
            let eye = scene(2, [x + 3.0, 0.5, 0.0], [x, 0.0, 0.0], &format!("{FLOOR}{light}"));
            all.add(format!("sphere {r} {h} {x}"), point(&eye), expected, 8.0 * ROUNDING * expected);
        }
    }
    all.judge(0.02);
}

/// A polygon of four corners that aren't a rectangle's, as two triangles that face down.
const POLYGON: &str = "v -1 2 -0.5\nv 1.5 2 -1\nv 1 2 1.5\nv -0.5 2 1\nf 1 2 3\nf 1 3 4\n";
const CORNERS: [[f64; 3]; 4] = [[-1.0, 2.0, -0.5], [1.5, 2.0, -1.0], [1.0, 2.0, 1.5], [-0.5, 2.0, 1.0]];

/// Lambert's formula: half the sum over edges of the angle they subtend times the cosine of their plane's normal, over 2π.
fn polygon_factor(x: f64) -> f64 {
    let corners = CORNERS.map(|[a, b, c]| [a - x, b, c]);
    let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let edge = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % 4]);
        let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let length = dot(cross, cross).sqrt();
        length.atan2(dot(a, b)) * cross[1] / length
    };
    ((0..4).map(edge).sum::<f64>() / (2.0 * PI)).abs()
}

/// `independent`: Lambert's formula for polygons; a rectangle on the axis by its own closed form.
#[test]
fn polygon_lights_over_a_plane_are_their_closed_forms() {
    let mut all = Comparisons::default();
    let mesh = "<shape type='obj'><string name='filename' value='light.obj'/>
        <boolean name='face_normals' value='true'/>
        <emitter type='area'><spectrum name='radiance' value='7'/></emitter></shape>";
    for x in [0.0, 1.0, 4.0] {
        let expected = RADIANCE * REFLECTANCE * polygon_factor(x);
        all.add(format!("mesh {x}"), floor(x, mesh), expected, 4.0 * ROUNDING * expected);
    }
    for h in [0.5, 2.0_f64] {
        let light = area_light("rectangle", &format!("{DOWN}<scale x='1.5' z='0.75'/><translate y='{h}'/>"));
        let (a, b) = (1.5, 0.75);
        let (p, q) = (h.hypot(a), h.hypot(b));
        let factor = 2.0 / PI * (a / p * (b / p).atan() + b / q * (a / q).atan());
        let expected = RADIANCE * REFLECTANCE * factor;
        all.add(format!("rectangle {h}"), floor(0.0, &light), expected, 2.0 * ROUNDING * expected);
    }
    all.judge(0.02);
}

/// `independent`: the Whitted renderer, which meets lights without area exactly.
#[test]
fn a_luminaire_lights_the_floor_as_in_the_whitted_renderer() {
    let lamp = "<emitter type='luminaire'><string name='filename' value='lamp.ies'/><transform name='to_world'>
        <rotate x='1' angle='-90'/><rotate y='1' angle='30'/><translate y='2'/></transform></emitter>";
    // Right below, azimuths and thus intensities are undecided.
    for x in [0.5, 1.5, -4.0] {
        let scene = scene(2, [x, 0.05, 0.0], [x, 0.0, 0.0], &format!("{FLOOR}{lamp}"));
        let whitted = Options { spectra: Spectra::Uniform(8), samples: Some(1), ..Options::default() };
        let expected = luminance(&renderers::render::render(&scene, &whitted, &|_| {}).unwrap(), 0);
        let found = Estimate::of(&traced(&scene, Strategy::Both, &options(Spectra::Uniform(8), 64)), 0..1);
        assert!(expected > 0.0 && (found.value / expected - 1.0).abs() <= 64.0 * ROUNDING, "{x}: {found:?} {expected}");
    }
}

#[test]
fn lights_without_area_follow_cosine_and_inverse_square() {
    let mut all = Comparisons::default();
    for (x, h) in [(0.0_f64, 0.5_f64), (8.0, 2.0)] {
        let light = format!(
            "<emitter type='point'><point name='position' value='0 {h} 0'/>
            <spectrum name='intensity' value='{RADIANCE}'/></emitter>"
        );
        let distance = h.hypot(x);
        let expected = REFLECTANCE / PI * RADIANCE * (h / distance) / (distance * distance);
        all.add(format!("point {x} {h}"), floor(x, &light), expected, ROUNDING * expected * (1.0 + x / h));
    }
    let (sin, cos) = 30.0_f64.to_radians().sin_cos();
    let parallel = format!(
        "<emitter type='directional'><vector name='direction' x='{sin}' y='{}' z='0'/>
        <spectrum name='irradiance' value='{RADIANCE}'/></emitter>",
        -cos
    );
    let expected = REFLECTANCE / PI * RADIANCE * cos;
    all.add("directional", floor(3.0, &parallel), expected, ROUNDING * expected);
    // Two lights that are chosen in turns: noise comes of the choice alone.
    let both = format!(
        "{parallel}<emitter type='point'><point name='position' value='3 1 0'/>
        <spectrum name='intensity' value='{RADIANCE}'/></emitter>"
    );
    all.add("both", floor(3.0, &both), expected + REFLECTANCE / PI * RADIANCE, 2.0 * ROUNDING * expected);
    all.judge(0.01);
}

/// A floor under an even sky reflects its share of it; so does a sphere from all around.
#[test]
fn an_environment_is_reflected_by_the_reflectance() {
    let sky = format!("<emitter type='constant'><spectrum name='radiance' value='{RADIANCE}'/></emitter>");
    let mut all = Comparisons::default();
    let sphere =
        "<shape type='sphere'><bsdf type='diffuse'><spectrum name='reflectance' value='0.625'/></bsdf></shape>";
    let expected = RADIANCE * REFLECTANCE;
    let body = format!("{sphere}{sky}");
    all.add("sphere", point(&scene(-1, [3.0, 0.5, 1.0], [0.0, 0.0, 0.0], &body)), expected, ROUNDING * expected);
    // Seen directly, and not at all from above a floor that reaches far.
    all.add("sky", point(&scene(1, [0.0, 3.0, 0.0], [0.0, 9.0, 0.0], &body)), RADIANCE, ROUNDING * RADIANCE);
    // A wall along the floor, that hides half of the sky and is black: its half counts for (1 + 0)/2 of the cosine.
    let wall =
        "<shape type='rectangle'><transform name='to_world'><scale value='1e4'/><translate z='-1e-3'/></transform>
        <bsdf type='diffuse'><spectrum name='reflectance' value='0'/></bsdf></shape>";
    let body = format!("{FLOOR}{wall}{sky}");
    let half = point(&scene(-1, [0.0, 0.25, 0.0], [0.0, 0.0, 0.0], &body));
    all.add("half", half, expected / 2.0, 1e-6 * expected);
    all.judge(0.01);
}

/// A closed box or sphere that shines with E everywhere: E / (1 − ρ), or the first terms of E (1 + ρ + ρ² + …).
#[test]
fn a_furnace_is_a_geometric_series() {
    let mut all = Comparisons::default();
    for shape in ["cube", "sphere"] {
        for (reflectance, depth) in [(0.5, -1), (0.8, -1), (0.8, 1), (0.8, 2), (0.8, 3), (0.8, 7), (0.9, 12)] {
            let body = format!(
                "<shape type='{shape}'><boolean name='flip_normals' value='true'/>
                <bsdf type='diffuse'><spectrum name='reflectance' value='{reflectance}'/></bsdf>
                <emitter type='area'><spectrum name='radiance' value='1'/></emitter></shape>"
            );
            let expected = match depth {
                -1 => 1.0 / (1.0 - reflectance),
                depth => (0..depth).map(|k| f64::powi(reflectance, k)).sum(),
            };
            let found = point(&scene(depth, [0.1, 0.2, 0.3], [0.5, -0.3, 0.4], &body));
            all.add(format!("{shape} {reflectance} {depth}"), found, expected, ROUNDING * expected);
        }
    }
    all.judge(0.02);
    let nothing = point(&scene(0, [0.1, 0.2, 0.3], [0.5, -0.3, 0.4], "<shape type='sphere'/>"));
    assert_eq!(nothing.value, 0.0);
}

/// Two wide parallel planes, one of which shines: (E₁ + ρ₁ E₂) / (1 − ρ₁ ρ₂) for each.
#[test]
fn light_between_two_planes_is_a_geometric_series() {
    let plane = |turn: f64, y: f64, reflectance: f64, radiance: f64| {
        format!(
            "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='{turn}'/><scale value='1e4'/>
            <translate y='{y}'/></transform>
            <bsdf type='diffuse'><spectrum name='reflectance' value='{reflectance}'/></bsdf>
            <emitter type='area'><spectrum name='radiance' value='{radiance}'/></emitter></shape>"
        )
    };
    let (e, r) = ([1.0, 3.0], [0.7, 0.4]);
    let body = format!("{}{}", plane(-90.0, 0.0, r[0], e[0]), plane(90.0, 1.0, r[1], e[1]));
    let mut all = Comparisons::default();
    for side in 0..2 {
        let target = if side == 0 { [0.1, 0.0, 0.0] } else { [0.1, 1.0, 0.0] };
        let found = point(&scene(-1, [0.0, 0.5, 0.0], target, &body));
        let expected = (e[side] + r[side] * e[1 - side]) / (1.0 - r[0] * r[1]);
        // What escapes at the edges, 10⁴ heights away, is of the order of 10⁻⁸.
        all.add(side, found, expected, 1e-6 * expected);
    }
    all.judge(0.01);
}

/// Every way of finding lights has the same mean: on rough, glossy and specular surfaces, near a light and far from it.
#[test]
fn all_strategies_have_the_same_mean() {
    let mut all = Comparisons::default();
    let lights = format!(
        "{}{}<shape type='sphere'><point name='center' value='-2 1.5 1'/><float name='radius' value='0.75'/>
        <emitter type='area'><spectrum name='radiance' value='4'/></emitter></shape>
        <emitter type='constant'><spectrum name='radiance' value='0.25'/></emitter>",
        area_light("rectangle", &format!("{DOWN}<scale x='1.5' z='0.75'/><translate y='1'/>")),
        area_light("disk", &format!("{DOWN}<translate x='3' y='2'/>")),
    );
    for material in [
        "<bsdf type='diffuse'><spectrum name='reflectance' value='0.625'/></bsdf>",
        "<bsdf type='schlick'><float name='roughness' value='0.2'/><float name='isotropy' value='1'/></bsdf>",
        "<bsdf type='schlick'><float name='roughness' value='0.7'/><float name='isotropy' value='0.3'/></bsdf>",
        "<bsdf type='ward'><float name='alpha_u' value='0.1'/><float name='alpha_v' value='0.3'/>
        <spectrum name='specular_reflectance' value='0.3'/><spectrum name='diffuse_reflectance' value='0.3'/></bsdf>",
        "<bsdf type='twosided'><bsdf type='schlick'><float name='roughness' value='0.4'/></bsdf></bsdf>",
    ] {
        let floor = format!(
            "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/><scale value='50'/></transform>
            {material}</shape>"
        );
        let scene = scene(4, [2.0, 0.9, 3.0], [0.0, 0.0, 0.0], &format!("{floor}{lights}"));
        let [both, lights, scattering] = [Strategy::Both, Strategy::Lights, Strategy::Scattering]
            .map(|s| Estimate::of(&traced(&scene, s, &options(Spectra::Uniform(4), 2 * SAMPLES)), 0..1));
        for (name, other) in [("lights", lights), ("scattering", scattering)] {
            let difference = Estimate { value: other.value, variance: other.variance + both.variance };
            all.add(format!("{material} {name}"), difference, both.value, ROUNDING * both.value);
        }
        assert!(both.variance <= 1.5 * lights.variance.min(scattering.variance), "{both:?} {lights:?} {scattering:?}");
    }
    // Scattering alone is noisy where lights are small.
    all.judge(0.06);
}

fn cornell(max_depth: Option<u32>) -> Scene {
    let mut scene = builtin::load("cornell-box", &[]).unwrap();
    scene.integrator = Integrator::Path { max_depth, rr_depth: 5 };
    scene
}

/// Pixels along a side of the picture, and of each block.
const SIDE: usize = 32;
const BLOCK: usize = 4;

/// `independent`: the Whitted renderer's direct light is exact but for where its camera rays fall.
#[test]
fn the_cornell_box_in_direct_light_is_that_of_the_whitted_renderer() {
    let scene = cornell(Some(2));
    let size = Some([32; 2]);
    let spectra = Spectra::Uniform(12);
    let whitted = [1, 2].map(|seed| {
        let options = Options { spectra, size, seed: Some(seed), samples: Some(256), ..Options::default() };
        renderers::render::render(&scene, &options, &|_| {}).unwrap()
    });
    let path = traced(&scene, Strategy::Both, &Options { size, ..options(spectra, 512) });
    // Edges, where camera rays make a difference, are left out.
    let steady = |pixel: &usize| {
        let [a, b] = [0, 1].map(|i| luminance(&whitted[i], *pixel));
        (a - b).abs() <= 1e-3 * a
    };
    let mut all = Comparisons::default();
    let mut used = 0;
    for block in 0..(SIDE / BLOCK).pow(2) {
        let (left, top) = (block % (SIDE / BLOCK) * BLOCK, block / (SIDE / BLOCK) * BLOCK);
        let pixels = || (0..BLOCK * BLOCK).map(move |i| (top + i / BLOCK) * SIDE + left + i % BLOCK).filter(steady);
        let count = pixels().count();
        used += count;
        if count > 0 {
            let expected = pixels().map(|p| luminance(&whitted[0], p)).sum::<f64>() / count as f64;
            if expected > 0.0 {
                all.add(block, Estimate::of(&path, pixels()), expected, 2e-4 * expected);
            }
        }
    }
    assert!(used * 10 >= SIDE * SIDE * 6, "{used} pixels");
    // Blocks in the deepest shadows are the noisiest.
    all.judge(0.1);
}

/// A light behind a plane-parallel plate of glass, seen directly and at an angle: both renderers follow the one path that goes straight
/// through, and bands of wavelengths are dimmed each by its own index.
#[test]
fn a_light_through_a_dispersive_plate_is_that_of_the_whitted_renderer() {
    let mut all = Comparisons::default();
    for band in ["430:0, 431:1, 470:1, 471:0", "530:0, 531:1, 570:1, 571:0", "600:0, 601:1, 680:1, 681:0"] {
        for (material, tolerance) in
            [("<string name='int_ior' value='N-SF11'/>", 1e-4), ("<float name='int_ior' value='1.7'/>", 4.0 * ROUNDING)]
        {
            let body = format!(
                "<shape type='cube'><transform name='to_world'><scale x='40' y='0.5' z='40'/><translate y='1.5'/></transform>
                <bsdf type='dielectric'>{material}<spectrum name='absorption' value='400:0.1, 700:0.6'/></bsdf></shape>
                <shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/><scale value='50'/></transform>
                <emitter type='area'><spectrum name='radiance' value='{band}'/></emitter></shape>"
            );
            let scene = scene(4, [0.0, 3.0, 0.0], [2.0, 1.5, 1.0], &body);
            let whitted = Options { spectra: Spectra::Uniform(81), samples: Some(1), ..Options::default() };
            let expected = luminance(&renderers::render::render(&scene, &whitted, &|_| {}).unwrap(), 0);
            let found = traced(&scene, Strategy::Both, &options(Spectra::Uniform(81), SAMPLES));
            // Whitted has the index in the middle of each bin, and the bins' means of everything else.
            all.add(format!("{material} {band}"), Estimate::of(&found, 0..1), expected, tolerance * expected);
        }
    }
    all.judge(0.02);
}

/// Light in a closed box of glass walls' worth: a sphere of glass in a furnace changes nothing, since radiance is kept in and out.
#[test]
fn clear_glass_in_a_furnace_is_invisible() {
    let mut all = Comparisons::default();
    for material in ["<string name='int_ior' value='N-SF11'/>", "<float name='int_ior' value='1.5'/>"] {
        let body = format!(
            "<shape type='sphere'><bsdf type='dielectric'>{material}</bsdf></shape>
            <emitter type='constant'><spectrum name='radiance' value='1'/></emitter>"
        );
        for x in [0.0, 0.6, 0.95] {
            let found = point(&scene(-1, [x, 5.0, 0.0], [x, 0.0, 0.0], &body));
            all.add(format!("{material} {x}"), found, 1.0, ROUNDING);
        }
    }
    all.judge(0.02);
}

/// Representations agree where all spectra are flat, and those of one product where they aren't: the mean over a box of paints.
#[test]
fn components_multiply_as_their_own_renderers_say() {
    let scene = cornell(Some(2));
    let size = Some([8; 2]);
    for spectra in [Spectra::Rgb, Spectra::RgbPrefiltered, Spectra::Bilinear, Spectra::Smits] {
        let whitted = Options { spectra, size, samples: Some(256), ..Options::default() };
        let expected = renderers::render::render(&scene, &whitted, &|_| {}).unwrap();
        let found = traced(&scene, Strategy::Both, &Options { size, ..options(spectra, 1024) });
        let total = |r: &Rendering| [0, 1, 2].map(|c| r.picture.pixels().iter().map(|p| f64::from(p[c])).sum::<f64>());
        let noise = Estimate::of(&found, 0..64);
        let tolerance = 4.0 * noise.variance.sqrt() / noise.value + 2e-3;
        for (found, expected) in total(&found).into_iter().zip(total(&expected)) {
            assert!((found / expected - 1.0).abs() <= tolerance, "{spectra}: {found}, expected {expected}");
        }
    }
}
