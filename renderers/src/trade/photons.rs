//! Caustics by photons: their number, radius and estimates, against the closed form of light through a ball of glass.

use alloc::rc::Rc;
use core::f64::consts::PI;

use spectral_core::colour::rgb::linear_rgb_to_xyz;

use super::plan::{Plan, Run, Setting, count64, mean_and_worst, rms_and_worst};
use crate::render::{Between, Options, PhotonCount, PhotonOptions, Renderer, Rendering, Spectra, render};
use crate::scene::{Scene, Source, load};

/// Index of the ball's glass, and how far the floor is below its middle; its radius is 1.
const INDEX: f64 = 1.5;
const DISTANCE: f64 = 2.0;
/// Half the side of the floor that is seen, its reflectance, and from where it is seen.
const HALF: f64 = 1.0;
const REFLECTANCE: f64 = 0.5;
const EYE: f64 = 0.8;
/// Pixels whose middles are between these distances from the axis count: at the axis irradiance is infinite, and beyond the ball's shadow
/// light comes straight, too.
const RING: [f64; 2] = [0.3, 0.85];

/// All tasks.
pub(super) fn plans(quick: bool) -> Vec<Plan> {
    let side = if quick { 32 } else { 64 };
    vec![Plan {
        name: "ball",
        title: format!(
            "parallel light through a ball of glass, index {INDEX}, on a floor, {side} × {side} pixels, 4 rays each"
        ),
        error: "relative error, RMS",
        operations: "photons thrown",
        truth: "Snell's and Fresnel's laws along 2·10⁶ rays, up to six reflections within the ball, in rings of 1/400"
            .to_owned(),
        floor: 1e-3,
        rounds: if quick { 2 } else { 5 },
        weight: if quick { 5.0 } else { 110.0 },
        build: Box::new(move || {
            let scene = Rc::new(scene()?);
            let options =
                Options { spectra: Spectra::Uniform(1), size: Some([side; 2]), samples: Some(4), ..Options::default() };
            let without = Rc::new(irradiance(&picture(&scene, &options)?));
            let truth = Rc::new(truth(side));
            let task = Task { scene, options, without, truth };
            Ok(settings(quick).into_iter().map(|(name, method, photons)| task.setting(name, method, photons)).collect())
        }),
    }]
}

/// Settings by the names of the options that users have.
fn settings(quick: bool) -> Vec<(String, &'static str, PhotonOptions)> {
    let base = PhotonOptions { between: Between::Ambient, radius: Some(0.5), ..PhotonOptions::default() };
    let counts: &[u64] =
        if quick { &[2000, 20_000] } else { &[1000, 3000, 10_000, 30_000, 100_000, 300_000, 1_000_000] };
    let mut all = Vec::new();
    for &count in counts {
        let photons = PhotonOptions { count: PhotonCount::Count(count), ..base };
        all.push((format!("--photons {count}"), "adaptive, 50 nearest", photons));
        all.push((
            format!("--photons {count} --estimate nearest"),
            "50 nearest",
            PhotonOptions { adaptive: false, ..photons },
        ));
        for nearest in [200, 1000] {
            if nearest * 5 <= count {
                #[allow(clippy::cast_possible_truncation, reason = "a thousand")]
                let photons = PhotonOptions { nearest: nearest as usize, ..photons };
                let method = if nearest == 200 { "adaptive, 200 nearest" } else { "adaptive, 1000 nearest" };
                all.push((format!("--photons {count} --nearest {nearest}"), method, photons));
            }
        }
    }
    let passes: &[u32] = if quick { &[4] } else { &[4, 16, 64] };
    for &passes in passes {
        let photons = PhotonOptions { count: PhotonCount::Count(10_000), passes, ..base };
        all.push((format!("--photons 10000 --passes {passes}"), "adaptive, passes", photons));
    }
    all
}

/// What all settings share.
struct Task {
    scene: Rc<Scene>,
    options: Options,
    /// Irradiance without photons.
    without: Rc<Vec<f64>>,
    /// That by way of the glass; `None` where it doesn't count.
    truth: Rc<Vec<Option<f64>>>,
}

impl Task {
    fn setting(&self, name: String, method: &'static str, photons: PhotonOptions) -> Setting {
        let (scene, without, truth) = (Rc::clone(&self.scene), Rc::clone(&self.without), Rc::clone(&self.truth));
        let options = Options { renderer: Renderer::PhotonMap, photons, ..self.options };
        Setting::new(name, method, method.starts_with("adaptive"), move |round| {
            let (found, seconds) = super::plan::timed(|| picture(&scene, &Options { seed: Some(round), ..options }));
            let found = found?;
            let pairs = irradiance(&found).into_iter().zip(without.iter()).zip(truth.iter());
            let errors = pairs.filter_map(|((whole, direct), truth)| truth.map(|truth| (whole - direct) / truth - 1.0));
            let [error, worst] = rms_and_worst(errors);
            let emitted = found.photons.as_ref().map_or(0, |report| report.emitted);
            let operations = count64(emitted) * f64::from(options.photons.passes);
            Ok(Run { seconds, operations, error, worst })
        })
    }
}

fn scene() -> Result<Scene, String> {
    let fov = 2.0 * (HALF / EYE).atan().to_degrees();
    let (floor, eye) = (-DISTANCE, EYE - DISTANCE);
    let xml = format!(
        "<scene version='3.0.0'><integrator type='path'/><sensor type='perspective'><float name='fov' value='{fov}'/>
        <transform name='to_world'><lookat origin='0, {eye}, 0' target='0, {floor}, 0' up='0, 0, -1'/></transform>
        <film type='hdrfilm'><integer name='width' value='64'/><integer name='height' value='64'/><rfilter type='box'/></film></sensor>
        <emitter type='directional'><vector name='direction' x='0' y='-1' z='0'/><spectrum name='irradiance' value='1'/></emitter>
        <shape type='sphere'><bsdf type='dielectric'><float name='int_ior' value='{INDEX}'/><float name='ext_ior' value='1'/></bsdf></shape>
        <shape type='rectangle'><transform name='to_world'><scale value='{HALF}'/>
        <lookat origin='0, {floor}, 0' target='0, {up}, 0' up='0, 0, -1'/></transform>
        <bsdf type='diffuse'><spectrum name='reflectance' value='{REFLECTANCE}'/></bsdf></shape></scene>",
        up = floor + 1.0
    );
    load(&Source::text("ball.xml", xml), &[]).map_err(|e| e.to_string())
}

fn picture(scene: &Scene, options: &Options) -> Result<Rendering, String> {
    render(scene, options, &|_| {}).map_err(|e| e.to_string())
}

/// What a picture's luminance says of the floor's irradiance: E = π L / ρ.
fn irradiance(rendering: &Rendering) -> Vec<f64> {
    let luminance = |rgb: &[f32; 3]| linear_rgb_to_xyz(rgb.map(f64::from))[1];
    rendering.picture.pixels().iter().map(|rgb| PI * luminance(rgb) / REFLECTANCE).collect()
}

/// Rings up to the corner of the floor.
const RINGS: usize = 600;
const RING_WIDTH: f64 = 1.5 / 600.0;

/// The irradiance of each ring.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few hundred rings")]
fn rings() -> Vec<f64> {
    const RAYS: u32 = 2_000_000;
    let mut flux = vec![0.0; RINGS];
    for ray in 0..RAYS {
        // Equal shares of the flux π that meets the ball.
        let height = ((f64::from(ray) + 0.5) / f64::from(RAYS)).sqrt();
        for (radius, share) in landings(height) {
            if let Some(ring) = flux.get_mut((radius / RING_WIDTH) as usize) {
                *ring += share * PI / f64::from(RAYS);
            }
        }
    }
    let area = |k: usize| PI * RING_WIDTH * RING_WIDTH * (2.0 * super::plan::count(k) + 1.0);
    flux.iter().enumerate().map(|(k, flux)| flux / area(k)).collect()
}

/// Where the parts of a ray at a height over the axis land: distances from the axis with shares of its flux.
///
/// The ray meets the ball at the angle i, sin i = height, and goes on within at t, sin i = n sin t. After k reflections within it leaves at
/// a place turned by (k + 1)(π − 2t), its direction by 2(i − t) + k(π − 2t).
fn landings(height: f64) -> Vec<(f64, f64)> {
    let (i, t) = (height.asin(), (height / INDEX).asin());
    let reflected = reflectance(i.cos(), t.cos());
    let mut all = Vec::new();
    // Angles in the plane of the ray, from +x across the axis; the ray comes down along −y.
    let entry = PI / 2.0 - i;
    let down = -PI / 2.0;
    // The reflection at the first face: the direction is turned by π − 2i to the other side.
    all.extend(landing(entry, down + (PI - 2.0 * i), reflected));
    let mut share = (1.0 - reflected) * (1.0 - reflected);
    for k in 0..6_u32 {
        let turns = f64::from(k);
        let exit = entry - (turns + 1.0) * (PI - 2.0 * t);
        let direction = down - (2.0 * (i - t) + turns * (PI - 2.0 * t));
        all.extend(landing(exit, direction, share));
        share *= reflected;
    }
    all
}

/// Where light lands that leaves the ball at a place in a direction, both as angles; `None` if it doesn't.
fn landing(place: f64, direction: f64, share: f64) -> Option<(f64, f64)> {
    let ((y, x), (dy, dx)) = (place.sin_cos(), direction.sin_cos());
    if !(dy < 0.0 && share > 0.0) {
        return None;
    }
    Some(((x + dx * (-DISTANCE - y) / dy).abs(), share))
}

/// Fresnel's reflectance from the cosines before and behind the face.
fn reflectance(outside: f64, inside: f64) -> f64 {
    let s = (outside - INDEX * inside) / (outside + INDEX * inside);
    let p = (INDEX * outside - inside) / (INDEX * outside + inside);
    f64::midpoint(s * s, p * p)
}

/// The mean irradiance of each pixel that counts, from 8 × 8 places in it.
fn truth(side: u32) -> Vec<Option<f64>> {
    const FINE: u32 = 8;
    let rings = rings();
    let pixel = 2.0 * HALF / f64::from(side);
    // Linear between the middles of rings.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few hundred rings")]
    let at = |radius: f64| {
        let place = (radius / RING_WIDTH - 0.5).max(0.0);
        let first = (place as usize).min(RINGS - 2);
        let part = place - super::plan::count(first);
        rings[first] + (rings[first + 1] - rings[first]) * part
    };
    (0..side * side)
        .map(|n| {
            let corner = [n % side, n / side].map(|k| f64::from(k) * pixel - HALF);
            let middle = (corner[0] + pixel / 2.0).hypot(corner[1] + pixel / 2.0);
            if !(RING[0]..RING[1]).contains(&middle) {
                return None;
            }
            let place = |k: u32| (f64::from(k) + 0.5) / f64::from(FINE) * pixel;
            let places = (0..FINE).flat_map(|a| (0..FINE).map(move |b| [place(a), place(b)]));
            let [mean, _] = mean_and_worst(places.map(|[x, y]| at((corner[0] + x).hypot(corner[1] + y))));
            Some(mean)
        })
        .collect()
}
