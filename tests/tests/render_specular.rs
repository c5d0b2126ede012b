#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]
//! Light between surfaces by way of mirrors and glass.

use core::f64::consts::PI;

use renderers::direct;
use renderers::geometry::glam::{DVec3, Vec3A};
use renderers::geometry::{Hit, Ray};
use renderers::radiosity::{Caustics, Deposit, Field, FieldSettings, Others, Radiosity, Settings};
use renderers::render::{BetweenOptions, Options, Renderer, Rendering, Spectra, render};
use renderers::scene::{self, Scene, Source};
use renderers::spectral::{Palette, Role, UniformBins};
use renderers::whitted::{Indirect, Whitted};

const GLASS: &str =
    r#"<bsdf type="dielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>"#;
const MIRROR: &str = r#"<bsdf type="conductor"/>"#;
const GOLD: &str = r#"<bsdf type="conductor"><string name="material" value="Au"/></bsdf>"#;

fn load(body: &str) -> Scene {
    let camera = r#"<sensor type="perspective"><float name="fov" value="70"/>
        <transform name="to_world"><lookat origin="0 0.1 0.95" target="0 -0.5 -0.2" up="0 1 0"/></transform>
        <film type="hdrfilm"><rfilter type="box"/></film></sensor>"#;
    let xml = format!("<scene version=\"3.0.0\"><integrator type=\"path\"/>{camera}{body}</scene>");
    scene::load(&Source::text("test.xml", &xml), &[]).unwrap()
}

fn diffuse(reflectance: f64) -> String {
    format!(r#"<bsdf type="diffuse"><spectrum name="reflectance" value="{reflectance}"/></bsdf>"#)
}

/// The cube from −1 to 1, seen from inside: floor, ceiling, left, right, back and front.
fn cube(insides: [&str; 6]) -> String {
    let places = [
        (r#"<rotate x="1" angle="-90"/>"#, r#"y="-1""#),
        (r#"<rotate x="1" angle="90"/>"#, r#"y="1""#),
        (r#"<rotate y="1" angle="90"/>"#, r#"x="-1""#),
        (r#"<rotate y="1" angle="-90"/>"#, r#"x="1""#),
        ("", r#"z="-1""#),
        (r#"<rotate y="1" angle="180"/>"#, r#"z="1""#),
    ];
    let wall = |((turn, shift), inside): ((&str, &str), &str)| {
        format!(
            r#"<shape type="rectangle"><transform name="to_world">{turn}<translate {shift}/></transform>{inside}</shape>"#
        )
    };
    places.into_iter().zip(insides).map(wall).collect()
}

fn sphere([x, y, z]: [f64; 3], radius: f64, inside: &str) -> String {
    format!(
        r#"<shape type="sphere"><point name="center" x="{x}" y="{y}" z="{z}"/><float name="radius" value="{radius}"/>{inside}</shape>"#
    )
}

/// What a ray from inside the cube meets.
fn hit(scene: &Scene, origin: [f32; 3], direction: [f32; 3]) -> Hit {
    let ray = Ray::new(Vec3A::from_array(origin), Vec3A::from_array(direction));
    direct::world(scene).unwrap().closest_hit(&ray).unwrap()
}

/// Irradiance of indirect light at some places, gathered there, in one bin of the spectrum.
fn irradiances(
    scene: &Scene,
    caustics: impl Fn(u32) -> Vec<([f64; 3], [f64; 3], f64, u32)>,
    gathered: bool,
    places: &[Hit],
) -> Vec<f64> {
    let mut palette = Palette::default();
    let whitted = Whitted::new(scene, [8, 8], &mut palette).unwrap();
    let light = (0..).zip(palette.leaves()).find(|(_, (_, role))| *role == Role::Light).unwrap().0;
    let settings = Settings { accuracy: 0.02, points: false, others: Others::Simplified, ..Settings::default() };
    let radiosity = Radiosity::new(scene, &settings, &mut palette, &|_| {}).unwrap();
    let bins = UniformBins::new(&palette, 1).unwrap();
    let solution = radiosity.solve(&bins).unwrap();
    let given = caustics(light);
    let leaves: Vec<[u32; 1]> = given.iter().map(|(.., leaf)| [*leaf]).collect();
    let deposits: Vec<Deposit<'_>> = given
        .iter()
        .zip(&leaves)
        .map(|((position, direction, flux, _), leaves)| Deposit {
            position: DVec3::from_array(*position),
            direction: DVec3::from_array(*direction),
            flux: *flux,
            leaves,
        })
        .collect();
    let caustics = if gathered { Caustics::Gathered } else { Caustics::Given(&deposits) };
    let settings = FieldSettings { accuracy: 0.02, exact: true, caustics };
    let field = Field::new(scene, &whitted, [&solution, &solution], settings, &[], &|_| {});
    let irradiance = |place: &Hit| {
        let mut row = [0.0];
        field.irradiance(place, &mut row);
        row[0]
    };
    places.iter().map(irradiance).collect()
}

/// Places on all walls: in their middles and elsewhere, one of them under a sphere.
fn places(scene: &Scene) -> Vec<Hit> {
    let from = [0.05, 0.6, 0.1];
    [[0.0, 1.0, 0.0], [-1.0, 0.1, 0.3], [1.0, -0.2, 0.1], [0.1, -0.1, -1.0], [0.2, 0.3, 1.0], [0.8, -1.0, 0.7]]
        .map(|direction| hit(scene, from, direction))
        .to_vec()
}

/// Walls that reflect ρ and receive H everywhere send each other H (ρ + ρ² + …), as far as gathers go, whatever clear glass and perfect mirrors make
/// of the ways of light. Lamps that are all but dark send nothing else.
#[test]
fn clear_glass_and_perfect_mirrors_lose_nothing() {
    const CELLS: i32 = 64;
    let (reflectance, arriving) = (0.6_f64, 2.0);
    let lamp = r#"<emitter type="point"><point name="position" x="0" y="0.5" z="0"/><spectrum name="intensity" value="1e-30"/></emitter>"#;
    let walls = cube([&diffuse(reflectance); 6]);
    let flux = arriving * (2.0 / f64::from(CELLS)).powi(2);
    let everywhere = |leaf: u32| {
        let at = |i: i32| (2.0 * f64::from(i) + 1.0) / f64::from(CELLS) - 1.0;
        let cells = || (0..CELLS).flat_map(move |i| (0..CELLS).map(move |j| [at(i), at(j)]));
        let on_walls = |axis: usize, side: f64| {
            cells().map(move |[u, v]| {
                let (mut position, mut direction) = ([u; 3], [0.0; 3]);
                (position[axis], position[(axis + 1) % 3], direction[axis]) = (side, v, -side);
                (position, direction, flux, leaf)
            })
        };
        (0..3).flat_map(|axis| [-1.0, 1.0].map(|side| on_walls(axis, side))).flatten().collect()
    };
    for inside in [GLASS, MIRROR] {
        let spheres = sphere([-0.3, -0.5, -0.2], 0.45, inside) + &sphere([0.5, -0.7, 0.4], 0.25, GLASS);
        let scene = load(&format!("{lamp}{walls}{spheres}"));
        for found in irradiances(&scene, everywhere, false, &places(&scene)) {
            let left = 1.0 - found / arriving * (1.0 - reflectance) / reflectance;
            let terms = (left.ln() / reflectance.ln()).round();
            let expected = arriving * reflectance * (1.0 - reflectance.powf(terms)) / (1.0 - reflectance);
            // Of some hundred thousand rays, one may leave the cube by its edges.
            assert!(terms >= 2.0 && (found / expected - 1.0).abs() <= 1e-5, "{found} for {terms} terms, {expected}");
        }
    }
}

/// Where all walls shine with radiance 1 and reflect ρ, everything has radiance 1/(1 − ρ), in mirrors and through glass, too. Of irradiance π/(1 − ρ)
/// the share that comes straight from walls is direct light: all of 1 but for the sphere's r² cos θ/d².
#[test]
fn furnace_with_a_sphere() {
    for reflectance in [0.3, 0.8] {
        let inside = diffuse(reflectance) + r#"<emitter type="area"><spectrum name="radiance" value="1"/></emitter>"#;
        for material in [GLASS, MIRROR] {
            let (centre, radius) = (DVec3::new(-0.2, -0.3, 0.1), 0.4);
            let scene = load(&(cube([&inside; 6]) + &sphere(centre.to_array(), radius, material)));
            let places = places(&scene);
            let found = irradiances(&scene, |_| Vec::new(), true, &places);
            for (place, found) in places.iter().zip(found) {
                let way = centre - place.position.as_dvec3();
                let cosine = way.normalize().dot(place.facing_normal().as_dvec3());
                let hidden = (radius / way.length()).powi(2) * cosine;
                assert!(cosine * way.length() > radius, "the sphere is above the horizon");
                let expected = PI * (reflectance / (1.0 - reflectance) + hidden);
                assert!((found / expected - 1.0).abs() <= 0.01, "{material} {reflectance}: {found} for {expected}");
            }
        }
    }
}

fn picture(scene: &Scene, renderer: Renderer, samples: u32) -> Rendering {
    let options = Options {
        renderer,
        spectra: Spectra::Uniform(8),
        size: Some([32, 32]),
        samples: Some(samples),
        between: BetweenOptions { accuracy: 0.05, exact: false },
        ..Options::default()
    };
    render(scene, &options, &|_| {}).unwrap()
}

/// Blocks of pixels: mean colours, and the variances of these.
fn blocks(values: &[[f32; 3]], scale: f64) -> Vec<[f64; 3]> {
    let block = |number: usize| {
        let (left, top) = (number % 8 * 4, number / 8 * 4);
        let pixels = (0..16).map(|i| values[(top + i / 4) * 32 + left + i % 4]);
        pixels.fold([0.0; 3], |sum, p| core::array::from_fn(|a| sum[a] + f64::from(p[a]) * scale))
    };
    (0..64).map(block).collect()
}

/// A lamp that shines upwards lights a box with a sphere of glass and one of gold by way of the ceiling alone: there is no light that comes
/// straight from the lamp by way of the spheres, which only the path tracer would find.
#[test]
fn a_box_with_glass_and_gold_is_as_paths_say() {
    let lamp = r#"<shape type="rectangle"><transform name="to_world"><scale value="0.25"/><rotate x="1" angle="-90"/><translate y="0.3"/></transform>
        <emitter type="area"><spectrum name="radiance" value="20"/></emitter></shape>"#;
    let red =
        r#"<bsdf type="diffuse"><spectrum name="reflectance" value="400:0.1, 570:0.15, 620:0.6, 780:0.6"/></bsdf>"#;
    let (white, grey) = (diffuse(0.75), diffuse(0.5));
    let walls = cube([&white, &white, red, &grey, &white, &grey]);
    let spheres = sphere([-0.4, -0.62, -0.1], 0.35, GLASS) + &sphere([0.45, -0.6, -0.2], 0.35, GOLD);
    let scene = load(&format!("{lamp}{walls}{spheres}"));
    let found = picture(&scene, Renderer::Radiosity, 16);
    let truth = picture(&scene, Renderer::Path, 1024);
    let variances = truth.variance.as_ref().unwrap().rgb.pixels();
    let [found, truth] = [&found, &truth].map(|r| blocks(r.picture.pixels(), 1.0 / 16.0));
    let variances = blocks(variances, 1.0 / 256.0);
    let (mut sums, mut variance) = ([[0.0; 3]; 2], [0.0; 3]);
    for ((found, truth), variances) in found.iter().zip(&truth).zip(&variances) {
        for a in 0..3 {
            // What interpolation and patches leave is within the accuracy that was asked for.
            let tolerance = 0.05 * truth[a] + 4.0 * variances[a].sqrt();
            assert!((found[a] - truth[a]).abs() <= tolerance, "{a}: {found:?} for {truth:?} ± {tolerance}");
            sums[0][a] += found[a];
            sums[1][a] += truth[a];
            variance[a] += variances[a];
        }
    }
    for a in 0..3 {
        let tolerance = 0.005 * sums[1][a] + 3.0 * variance[a].sqrt();
        assert!((sums[0][a] - sums[1][a]).abs() <= tolerance, "{a}: {sums:?} ± {tolerance}");
    }
}
