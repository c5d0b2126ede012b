//! The light tracer against closed forms, and against path tracing: z-tests with Šidák's correction.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]
#![allow(clippy::cast_precision_loss, reason = "counts are small")]

use core::f64::consts::PI;

use renderers::geometry::glam::DVec3;
use renderers::path::{Paths, Run, render};
use renderers::render::{Options, Renderer, Rendering, Spectra};
use renderers::scene::{Integrator, Scene, Source, load};
use spectral_core::colour::rgb::linear_rgb_to_xyz;
use spectral_core::dispersion::{Dispersion, Glass};
use spectral_tests::bodies::{self, hemisphere, tilted_square};
use spectral_tests::comparisons::Comparisons;
use spectral_tests::light_tracing::{Aim, Estimate, Film, Grid, Landing, LightTracer, TraceError, Waves};
use spectral_tests::snell::{Focus, Lens, Plate, Prism, Way, refracted};

/// Positions are f32: some roundings of the scenes' sizes.
const ROUNDING: f64 = 64.0 * f32::EPSILON as f64;

/// Parallel light straight down, of irradiance 1.
const DOWN: &str = "<emitter type='directional'><vector name='direction' x='0' y='-1' z='0'/>
    <spectrum name='irradiance' value='1'/></emitter>";

fn scene_with(body: &str, assets: &[(&str, String)]) -> Scene {
    let xml = format!(
        "<scene version='3.0.0'><integrator type='path'/>
        <sensor type='perspective'><float name='fov' value='40'/>
        <transform name='to_world'><lookat origin='0 3 -12' target='0 0 0' up='0 1 0'/></transform></sensor>{body}</scene>"
    );
    let source = Source::text("test.xml", xml);
    let source = assets.iter().fold(source, |source, (name, text)| source.with_asset(*name, text.clone()));
    load(&source, &[]).unwrap()
}

fn scene(body: &str) -> Scene {
    scene_with(body, &[])
}

/// A diffuse rectangle across y that sees up.
fn floor(y: f64, half: f64) -> String {
    format!(
        "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/><scale value='{half}'/>
        <translate y='{y}'/></transform></shape>"
    )
}

fn glass(index: &str) -> String {
    format!("<bsdf type='dielectric'>{index}<float name='ext_ior' value='1'/></bsdf>")
}

fn constant(index: f64) -> String {
    glass(&format!("<float name='int_ior' value='{index}'/>"))
}

/// Sums over the landings of a batch, as estimates over batches.
fn sums<const N: usize>(
    tracer: &LightTracer<'_>,
    wavelength: f64,
    batches: u64,
    of: impl Fn(&Landing<1>) -> [f64; N] + Send + Sync,
) -> [Estimate; N] {
    let waves = Waves::single(tracer.scene(), wavelength).unwrap();
    let batch = |number| {
        let mut sums = [0.0; N];
        tracer.batch(&waves, [7, number], |landing| {
            let values = of(landing);
            sums = core::array::from_fn(|k| sums[k] + values[k]);
        });
        sums
    };
    let all = tracer.batches(0, batches, batch);
    core::array::from_fn(|k| Estimate::of(&all.iter().map(|sums| sums[k]).collect::<Vec<_>>()))
}

/// `independent`: the trigonometric trace through a ball, way by way, in one glass and in another at two wavelengths.
#[test]
fn a_balls_flux_within_radii_is_its_closed_form() {
    const RADII: [f64; 6] = [0.02, 0.1, 0.3, 0.7, 1.3, 3.0];
    let sf11 = Glass::<f64>::find("N-SF11").unwrap();
    let mut all = Comparisons::default();
    for (bsdf, wavelength, index, distance) in [
        (constant(1.5), 550.0, 1.5, 1.5),
        (constant(1.5), 550.0, 1.5, 3.0),
        (glass("<string name='int_ior' value='N-SF11'/>"), 420.0, sf11.index(420.0), 1.2),
        (glass("<string name='int_ior' value='N-SF11'/>"), 680.0, sf11.index(680.0), 1.2),
    ] {
        let scene = scene(&format!("{DOWN}<shape type='sphere'>{bsdf}</shape>{}", floor(-distance, 4.0)));
        let tracer = LightTracer::new(&scene, Aim::Specular).unwrap();
        let focus = Focus { lens: Lens::Ball, radius: 1.0, index, distance };
        // With the number of reflections and refractions by which a way is known.
        let ways = [(Way::Reflected, 1), (Way::Through(0), 2), (Way::Through(2), 4), (Way::Through(3), 5)];
        let places: [_; 24] = core::array::from_fn(|k| (ways[k / RADII.len()], RADII[k % RADII.len()]));
        let found = sums(&tracer, wavelength, 32, |landing| {
            let [x, _, z] = landing.point.position.as_dvec3().to_array();
            let radius = x.hypot(z);
            places.map(
                |((_, specular), within)| {
                    if landing.specular == specular && radius <= within { landing.flux[0] } else { 0.0 }
                },
            )
        });
        for (found, ((way, _), radius)) in found.into_iter().zip(places) {
            let expected = focus.flux(way, radius);
            // Less is too rare for a normal distribution.
            if expected > 6e-3 {
                // Where rays crowd, rounded radii matter the more.
                let edge = focus.flux(way, radius * (1.0 + ROUNDING)) - focus.flux(way, radius * (1.0 - ROUNDING));
                all.add(format!("{focus:?} {way:?} {radius}"), found, expected, edge + ROUNDING * expected);
            }
        }
    }
    assert!(all.count() >= 30, "{}", all.count());
    all.judge(0.02);
}

/// `independent`: the trigonometric trace; a mesh with smooth normals refracts as the sphere does, up to its facets.
#[test]
fn a_hemispheres_flux_within_radii_is_its_closed_form() {
    const RADII: [f64; 4] = [0.05, 0.2, 0.4, 0.8];
    let mut all = Comparisons::default();
    for (lens, up, distance) in [(Lens::RoundFirst, true, 1.2), (Lens::FlatFirst, false, 2.0)] {
        let (body, dome) = hemisphere(up, 64, &constant(1.5));
        let scene = scene_with(&format!("{DOWN}{body}{}", floor(-distance, 4.0)), &[("dome.obj", dome)]);
        let tracer = LightTracer::new(&scene, Aim::Specular).unwrap();
        let focus = Focus { lens, radius: 1.0, index: 1.5, distance };
        let found = sums(&tracer, 550.0, 16, |landing| {
            let [x, _, z] = landing.point.position.as_dvec3().to_array();
            RADII.map(|radius| if landing.specular == 2 && x.hypot(z) <= radius { landing.flux[0] } else { 0.0 })
        });
        for (found, radius) in found.into_iter().zip(RADII) {
            let expected = focus.flux(Way::Through(0), radius);
            all.add(format!("{focus:?} {radius}"), found, expected, 1e-3 * expected);
        }
    }
    all.judge(0.01);
}

/// Parallel light at an angle in the xy plane.
fn slanted(degrees: f64) -> String {
    let (sin, cos) = degrees.to_radians().sin_cos();
    format!(
        "<emitter type='directional'><vector name='direction' x='{sin}' y='{}' z='0'/>
        <spectrum name='irradiance' value='1'/></emitter>",
        -cos
    )
}

/// Closed forms: all that passes a clear and an absorbing plate, and the shadow of an edge, which the plate moves.
#[test]
fn a_plate_transmits_and_shifts_by_its_closed_form() {
    let [mut all, mut shifts] = [(); 2].map(|()| Comparisons::default());
    for (degrees, absorption) in [(0.0, 0.0), (35.0, 0.7), (60.0, 0.0), (75.0, 0.3)] {
        let angle = f64::to_radians(degrees);
        let plate = Plate { thickness: 0.5, index: 1.6, absorption };
        let coloured = format!("<float name='int_ior' value='1.6'/><spectrum name='absorption' value='{absorption}'/>");
        let body = format!(
            "{}<shape type='cube'><transform name='to_world'><scale x='8' y='0.25' z='8'/><translate y='0.5'/></transform>
            {}</shape>{}",
            slanted(degrees),
            glass(&coloured),
            floor(0.0, 2.0)
        );
        let lit = scene(&body);
        let tracer = LightTracer::new(&lit, Aim::Specular).unwrap();
        let grid = Grid::new(&lit, 1, [1, 1]).unwrap();
        let expected = angle.cos() * plate.shares(angle)[0];
        for (cell, found) in tracer.irradiance(&grid, 550.0, 32, 3).unwrap().into_iter().enumerate() {
            all.add(format!("{degrees}° {cell}"), found, expected, ROUNDING * expected);
        }
        // An edge above the plate, whose shadow's edge would be at x = 0 without it.
        let shade = format!(
            "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/><scale value='20'/>
            <translate x='{}' y='2'/></transform></shape>",
            -20.0 - 2.0 * angle.tan()
        );
        let shaded = scene(&format!("{body}{shade}"));
        let tracer = LightTracer::new(&shaded, Aim::Specular).unwrap();
        let before = |l: &Landing<1>| {
            let counts = l.shape == 1 && l.specular == 2 && l.point.position.x < 0.0;
            [if counts { l.flux[0] } else { 0.0 }]
        };
        let [found] = sums(&tracer, 550.0, 32, before);
        let back = plate.shift(angle) / angle.cos();
        let remaining = (-absorption * plate.thickness / refracted(angle, plate.index).unwrap().cos()).exp();
        let once = (1.0 - spectral_tests::snell::reflectance(angle, plate.index)).powi(2) * remaining;
        if degrees > 0.0 {
            let expected = angle.cos() * once * 4.0 * back;
            shifts.add(format!("{degrees}° shift"), found, expected, ROUNDING * (1.0 + expected));
        } else {
            assert!(found.mean <= ROUNDING, "{found:?}");
        }
    }
    all.judge(0.008);
    shifts.judge(0.02);
}

/// Closed forms at ten wavelengths: where a prism's light falls on a wall, and how much of it.
#[test]
fn a_prisms_light_is_where_its_closed_form_says() {
    const LENGTH: f64 = 2.0;
    const WALL: f64 = 6.0;
    let apex = f64::to_radians(50.0);
    let incidence = f64::to_radians(48.0);
    let glass_ = Glass::<f64>::find("N-SF11").unwrap();
    let direction = incidence - apex / 2.0;
    let body = format!(
        "<emitter type='directional'><vector name='direction' x='{}' y='{}' z='0'/>
        <spectrum name='irradiance' value='1'/></emitter>
        <shape type='obj'><string name='filename' value='prism.obj'/><boolean name='face_normals' value='true'/>{}</shape>
        <shape type='rectangle'><transform name='to_world'><rotate y='1' angle='-90'/><scale value='12'/>
        <translate x='{WALL}'/></transform></shape>",
        direction.cos(),
        direction.sin(),
        glass("<string name='int_ior' value='N-SF11'/>")
    );
    let mesh = bodies::prism(Prism { apex, index: 1.0 }, LENGTH);
    let scene = scene_with(&body, &[("prism.obj", mesh)]);
    let tracer = LightTracer::new(&scene, Aim::Specular).unwrap();
    let mut all = Comparisons::default();
    let mut before = f64::INFINITY;
    for wavelength in (0..10).map(|k| 400.0 + 38.0 * f64::from(k)) {
        let prism = Prism { apex, index: glass_.index(wavelength) };
        // Light that meets the base instead is left out.
        let most = LENGTH * (LENGTH / prism.ray(LENGTH, incidence).unwrap().exit).min(1.0);
        let [top, bottom] = [0.0, most].map(|entry| prism.height(entry, incidence, WALL).unwrap());
        let direct = |l: &Landing<1>| l.shape == 1 && l.specular == 2;
        let [flux, moment, outside] = sums(&tracer, wavelength, 16, |l: &Landing<1>| {
            let y = f64::from(l.point.position.y);
            let out = direct(l) && !(bottom - 1e-5..=top + 1e-5).contains(&y);
            let flux = if direct(l) { l.flux[0] } else { 0.0 };
            [flux, flux * (y - bottom) / (top - bottom), if out { 1.0 } else { 0.0 }]
        });
        assert!(outside.mean == 0.0, "{wavelength} nm: {outside:?} outside {bottom} to {top}");
        let expected = 2.0 * most * incidence.cos() * prism.ray(1.0, incidence).unwrap().share;
        all.add(format!("{wavelength} nm flux"), flux, expected, ROUNDING * expected);
        all.add(format!("{wavelength} nm place"), moment, expected / 2.0, ROUNDING * expected);
        // Red is turned least: upper, since the base is below.
        let middle = f64::midpoint(top, bottom);
        assert!(middle > -before, "{wavelength} nm: {middle}");
        before = -middle;
    }
    all.judge(0.005);
}

/// Closed form: what a mirror sends is the light of the light's image. Points, isotropic luminaires, and an area light whose every point is
/// nearly as far.
#[test]
fn a_mirrors_light_is_that_of_the_image() {
    let mirror = "<shape type='rectangle'><transform name='to_world'><rotate y='1' angle='90'/><scale value='6'/>
        <translate x='-2'/></transform><bsdf type='conductor'><spectrum name='specular_reflectance' value='0.75'/></bsdf></shape>";
    let point = "<emitter type='point'><point name='position' x='1' y='2' z='0'/><spectrum name='intensity' value='3'/></emitter>";
    let small = format!(
        "<shape type='sphere'><point name='center' x='1' y='2' z='0'/><float name='radius' value='0.01'/>
        <emitter type='area'><spectrum name='radiance' value='{}'/></emitter></shape>",
        3.0 / (PI * 0.01 * 0.01)
    );
    // The image is at (−5, 2, 0).
    let image = DVec3::new(-5.0, 2.0, 0.0);
    let cells = 4_u32;
    let mut all = Comparisons::default();
    for light in [point.to_owned(), small] {
        let scene = scene(&format!("{mirror}{}{light}", floor(0.0, 1.0)));
        for aim in [Aim::Everywhere, Aim::Specular] {
            let tracer = LightTracer::new(&scene, aim).unwrap();
            let grid = Grid::new(&scene, 1, [cells as usize; 2]).unwrap();
            let found = tracer.irradiance(&grid, 500.0, 64, 11).unwrap();
            let fine = 16 * cells;
            let mut expected = vec![0.0; found.len()];
            for (row, column) in (0..fine).flat_map(|row| (0..fine).map(move |column| (row, column))) {
                // The rectangle's second edge is along −z.
                let [x, z] = [column, row].map(|k| 2.0 * (f64::from(k) + 0.5) / f64::from(fine) - 1.0);
                let way = image - DVec3::new(x, 0.0, -z);
                let cell = (row / 16 * cells + column / 16) as usize;
                expected[cell] += 0.75 * 3.0 * way.y / way.length().powi(3) / 256.0;
            }
            for (cell, (found, expected)) in found.into_iter().zip(expected).enumerate() {
                // The midpoint rule is good to 10⁻⁵ here, and the small sphere to the square of its size.
                all.add(format!("{aim:?} {cell} {light}"), found, expected, 1e-4 * expected);
            }
        }
    }
    all.judge(0.05);
}

const NESTED: &str = "<shape type='sphere'><point name='center' x='0' y='1.5' z='0'/><float name='radius' value='1.2'/>
    <bsdf type='dielectric'><string name='int_ior' value='N-SF11'/><spectrum name='absorption' value='400:0.1, 700:0.6'/>
    <spectrum name='specular_transmittance' value='0.9'/></bsdf></shape>
    <shape type='sphere'><point name='center' x='0.2' y='1.5' z='0'/><float name='radius' value='0.6'/>
    <bsdf type='dielectric'><float name='int_ior' value='1.2'/><string name='ext_ior' value='N-SF11'/>
    <spectrum name='absorption' value='0.2'/></bsdf></shape>
    <shape type='disk'><transform name='to_world'><rotate y='1' angle='60'/><translate x='-2.5' y='1.5'/></transform>
    <bsdf type='twosided'><bsdf type='conductor'><string name='material' value='Au'/></bsdf></bsdf></shape>";

const LAMP: &str =
    "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='90'/><scale x='0.8' z='0.5'/>
    <translate x='0.4' y='5'/></transform><bsdf type='diffuse'><spectrum name='reflectance' value='0.3'/></bsdf>
    <emitter type='area'><spectrum name='radiance' value='4'/></emitter></shape>";

const DISK: &str = "<shape type='disk'><transform name='to_world'><rotate y='1' angle='-110'/><scale value='0.7'/>
    <translate x='4' y='2'/></transform><emitter type='area'><spectrum name='radiance' value='2'/></emitter></shape>";

/// Nothing is lost or made: to rounding in every scene, and what is emitted is what the lights' closed forms say.
#[test]
fn flux_balances_close() {
    let point = "<emitter type='point'><point name='position' x='3' y='3' z='1'/><spectrum name='intensity' value='2'/></emitter>";
    let (dome, mesh) = hemisphere(true, 6, &constant(1.5));
    for (light, emitted) in
        [(LAMP, Some(4.0 * PI * 1.6)), (DISK, Some(2.0 * PI * PI * 0.49)), (point, Some(8.0 * PI)), (DOWN, None)]
    {
        for body in [NESTED, &dome] {
            let scene = scene_with(&format!("{light}{body}{}", floor(0.0, 5.0)), &[("dome.obj", mesh.clone())]);
            for aim in [Aim::Everywhere, Aim::Specular] {
                let tracer = LightTracer::new(&scene, aim).unwrap();
                let balance = tracer.balance(480.0, 4, 1).unwrap();
                assert!(balance.gap() <= 1e-12, "{balance:?}");
                // A coarse dome's smooth normals send some to the wrong side of its facets.
                let lost = if body == NESTED { 1e-4 } else { 0.02 };
                assert!(balance.caustic > 0.005 * balance.emitted, "{balance:?}");
                assert!(balance.lost <= lost * balance.emitted, "{balance:?}");
                assert!(balance.absorbed > 0.0 || body != NESTED, "{balance:?}");
                if body == NESTED {
                    assert!(balance.bent.abs() <= 1e-15 * balance.emitted, "{balance:?}");
                }
                if let (Aim::Everywhere, Some(emitted)) = (aim, emitted) {
                    assert!((balance.emitted / emitted - 1.0).abs() <= 1e-11, "{balance:?}, not {emitted}");
                }
            }
        }
    }
}

#[test]
fn aimed_particles_make_the_same_caustics() {
    let scene = scene(&format!("{LAMP}{DISK}{DOWN}{NESTED}{}", floor(0.0, 5.0)));
    let grid = Grid::new(&scene, 5, [3, 3]).unwrap();
    let [plain, aimed] = [Aim::Everywhere, Aim::Specular]
        .map(|aim| LightTracer::new(&scene, aim).unwrap().irradiance(&grid, 600.0, 64, 2).unwrap());
    let mut all = Comparisons::default();
    for (cell, (plain, aimed)) in plain.into_iter().zip(aimed).enumerate() {
        let difference = Estimate { mean: plain.mean, error: plain.error.hypot(aimed.error) };
        all.add(cell, difference, aimed.mean, ROUNDING * aimed.mean);
    }
    all.judge(0.05);
}

#[test]
fn what_cannot_be_traced_is_refused() {
    let rough = scene("<shape type='sphere'><bsdf type='ward'/></shape>");
    let error = LightTracer::new(&rough, Aim::Everywhere).unwrap_err().to_string();
    assert!(error.ends_with("light tracing knows Lambertian surfaces, mirrors and glass"), "{error}");
    let dark = scene("<shape type='sphere'/><emitter type='constant'/>");
    assert_eq!(LightTracer::new(&dark, Aim::Everywhere).unwrap_err(), TraceError::NoLight);
    assert_eq!(Grid::new(&dark, 0, [1, 1]).unwrap_err(), TraceError::Grid);
    let lit = scene(&format!("{LAMP}<shape type='sphere'/>"));
    assert_eq!(Grid::new(&lit, 0, [0, 1]).unwrap_err(), TraceError::Grid);
    let tracer = LightTracer::new(&lit, Aim::Everywhere).unwrap();
    assert_eq!(Film::new(&tracer, [0, 1], 0).unwrap_err(), TraceError::Picture);
    assert_eq!(Film::new(&tracer, [1, 1], 0).unwrap().picture().unwrap_err(), TraceError::Picture);
}

/// Pixels along a side of the picture, and of each block.
const SIDE: u32 = 24;
const BLOCK: u32 = 6;

fn traced(scene: &Scene, paths: Paths, seed: u64) -> Rendering {
    let options = Options {
        renderer: Renderer::Path,
        spectra: Spectra::Uniform(80),
        size: Some([SIDE; 2]),
        samples: Some(256),
        seed: Some(seed),
        ..Options::default()
    };
    render(scene, &options, Run { paths, ..Run::default() }, &|_| {}).unwrap()
}

fn blocks(xyz: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let (width, block) = (SIDE as usize, BLOCK as usize);
    let side = width / block;
    let mut sums = vec![[0.0; 3]; side * side];
    for (pixel, xyz) in xyz.iter().enumerate() {
        let sum = &mut sums[pixel / width / block * side + pixel % width / block];
        *sum = core::array::from_fn(|c| sum[c] + xyz[c] / f64::from(BLOCK * BLOCK));
    }
    sums
}

fn xyz(rendering: &Rendering) -> Vec<[f64; 3]> {
    rendering.picture.pixels().iter().map(|p| linear_rgb_to_xyz(p.map(f64::from))).collect()
}

/// X, Y and Z of every block: path tracing of all paths less that without caustics, by several seeds, against the light tracer's picture.
fn compare_with_paths(name: &str, scene: &Scene, seeds: u64, batches: u64, all: &mut Comparisons) {
    let tracer = LightTracer::new(scene, Aim::Specular).unwrap();
    let pictures: Vec<_> = (0..8)
        .map(|seed| {
            let mut film = Film::new(&tracer, [SIDE; 2], seed).unwrap();
            film.add(batches).unwrap();
            blocks(&film.xyz())
        })
        .collect();
    let differences: Vec<_> = (0..seeds)
        .map(|seed| {
            let [whole, rest] = [Paths::All, Paths::WithoutCaustics].map(|p| blocks(&xyz(&traced(scene, p, seed))));
            whole.into_iter().zip(rest).map(|(a, b)| [0, 1, 2].map(|c| a[c] - b[c])).collect::<Vec<_>>()
        })
        .collect();
    let of = |list: &[Vec<[f64; 3]>], block: usize, channel: usize| {
        Estimate::of(&list.iter().map(|picture| picture[block][channel]).collect::<Vec<_>>())
    };
    let brightest = (0..pictures[0].len()).map(|b| of(&pictures, b, 1).mean).fold(0.0, f64::max);
    let mut used = 0;
    for (block, channel) in (0..pictures[0].len()).flat_map(|b| (0..3).map(move |c| (b, c))) {
        let [light, path] = [&pictures, &differences].map(|list| of(list, block, channel));
        if light.mean > 0.35 * brightest {
            let found = Estimate { mean: path.mean, error: path.error.hypot(light.error) };
            all.add(format!("{name} {block} {channel}"), found, light.mean, 1e-4 * light.mean);
            used += 1;
        }
    }
    assert!(used >= 6, "{name}: {used} blocks");
}

/// A lamp that paths from the eye come upon often enough.
const LARGE: &str = "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='90'/><scale x='2' z='1.5'/>
    <translate x='0.4' y='5'/></transform><emitter type='area'><spectrum name='radiance' value='300:2, 800:6'/></emitter></shape>";

const WALL: &str = "<shape type='rectangle'><transform name='to_world'><rotate y='1' angle='180'/><scale value='5'/>
    <translate z='4'/></transform><bsdf type='diffuse'><spectrum name='reflectance' value='400:0.2, 700:0.8'/></bsdf></shape>";

fn ball(bsdf: &str) -> String {
    format!(
        "<shape type='sphere'><point name='center' x='0' y='1.5' z='0'/><float name='radius' value='1.2'/>{bsdf}</shape>"
    )
}

/// `independent`: what path tracing from the eye finds of these paths is what light tracing does.
#[test]
fn caustics_are_those_of_the_path_tracer() {
    let coloured =
        glass("<string name='int_ior' value='N-SF11'/><spectrum name='absorption' value='400:0.1, 700:0.6'/>");
    let gold = "<shape type='disk'><transform name='to_world'><rotate y='1' angle='60'/><translate x='-2.5' y='1.5'/></transform>
        <bsdf type='twosided'><bsdf type='conductor'><string name='material' value='Au'/></bsdf></bsdf></shape>";
    let sphere = "<shape type='sphere'><point name='center' x='3' y='2' z='-1'/><float name='radius' value='0.9'/>
        <emitter type='area'><spectrum name='radiance' value='8'/></emitter></shape>";
    // Shading normals that are not the geometric ones make the adjoint count: by a fifth and more here.
    let tilted = |bsdf: &str, transform: &str| {
        format!(
            "<shape type='obj'><string name='filename' value='square.obj'/>
            <transform name='to_world'>{transform}</transform>{bsdf}</shape>"
        )
    };
    let mirror = "<bsdf type='conductor'/>";
    let tilted = [
        tilted(&constant(1.5), "<translate x='1.6' y='2'/>"),
        tilted(mirror, "<rotate z='1' angle='-50'/><scale value='1.6'/><translate x='-3' y='2.5'/>"),
    ];
    let mut all = Comparisons::default();
    for (name, depth, height, body) in [
        ("clear ball", -1, 0.0, format!("{LARGE}{}", ball(&constant(1.5)))),
        ("coloured ball, two paths", 4, 0.0, format!("{sphere}{LARGE}{}{gold}", ball(&coloured))),
        ("tilted glass", -1, 0.0, format!("{LARGE}{}", tilted[0])),
        ("tilted mirror", -1, 0.0, format!("{LARGE}{}", tilted[1])),
    ] {
        let body = format!("{body}{WALL}{}", floor(height, 5.0));
        let mut scene = scene_with(&body, &[("square.obj", tilted_square())]);
        scene.integrator = Integrator::Path { max_depth: u32::try_from(depth).ok(), rr_depth: 5 };
        compare_with_paths(name, &scene, 8, 4, &mut all);
    }
    all.judge(0.1);
}

/// Without glass and mirrors nothing is left out, and where there is nothing but caustics all is.
#[test]
fn what_is_left_out_is_caustics_seen_directly() {
    let same = |body: &str| {
        let scene = scene(body);
        let [whole, rest] = [Paths::All, Paths::WithoutCaustics].map(|paths| traced(&scene, paths, 5).picture);
        (whole == rest, whole, rest)
    };
    let open = format!("{LARGE}{WALL}{}", floor(0.0, 5.0));
    assert!(same(&open).0);
    // The lamp itself is seen through glass and in a mirror, and so is its direct light: nothing scatters before.
    let lens = "<shape type='sphere'><point name='center' x='0' y='3' z='-9'/>";
    let black = "<bsdf type='diffuse'><spectrum name='reflectance' value='0'/></bsdf>";
    let through = format!(
        "{LARGE}{lens}{}</shape>{}",
        constant(1.5),
        floor(0.0, 5.0).replace("</shape>", &format!("{black}</shape>"))
    );
    assert!(same(&through).0);
    // The environment's light through glass isn't particles'.
    let sky = format!("<emitter type='constant'/>{}{}", ball(&constant(1.5)), floor(0.0, 5.0));
    assert!(same(&sky).0);
    // A lamp inside a ball of glass: whatever comes to the floor is a caustic, once or scattered again.
    let inside = "<shape type='sphere'><point name='center' x='0' y='1.5' z='0'/><float name='radius' value='0.7'/>
        <bsdf type='diffuse'><spectrum name='reflectance' value='0'/></bsdf>
        <emitter type='area'><spectrum name='radiance' value='3'/></emitter></shape>";
    let (equal, whole, rest) = same(&format!("{inside}{}{}", ball(&constant(1.3)), floor(0.0, 5.0)));
    assert!(!equal);
    let mut dark = 0_u32;
    for (whole, rest) in whole.pixels().iter().zip(rest.pixels()) {
        assert!(rest[1] <= whole[1]);
        // The floor is seen directly, or the ball is.
        dark += u32::from(whole[1] > 0.0 && rest[1] == 0.0);
    }
    assert!(dark > SIDE * SIDE / 8, "{dark} pixels");
}
