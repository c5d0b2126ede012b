#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]
//! Pictures with all light between surfaces.

use renderers::render::{BetweenOptions, Options, Renderer, Rendering, Spectra, render};
use renderers::scene::{self, Scene, Source, builtin};
use renderers::spectral::IntervalSettings;
use spectral_core::adaptive::Mode;
use spectral_core::colour::rgb;
use spectral_core::colour::{delta_e_ab, linear_rgb_to_xyz, xyz_to_lab};

fn options(spectra: Spectra, size: [u32; 2], accuracy: f64) -> Options {
    Options {
        renderer: Renderer::Radiosity,
        spectra,
        size: Some(size),
        samples: Some(1),
        between: BetweenOptions { accuracy, exact: false },
        ..Options::default()
    }
}

fn load(xml: &str) -> Scene {
    scene::load(&Source::text("test.xml", xml), &[]).unwrap()
}

fn picture(scene: &Scene, options: &Options) -> Rendering {
    render(scene, options, &|_| {}).unwrap()
}

fn luminances(rendering: &Rendering) -> Vec<f64> {
    let y = |rgb: &[f32; 3]| linear_rgb_to_xyz(rgb.map(f64::from))[1];
    rendering.picture.pixels().iter().map(y).collect()
}

/// A camera in the middle of things.
fn camera(origin: &str, target: &str, up: &str, fov: f64) -> String {
    format!(
        r#"<sensor type="perspective"><float name="fov" value="{fov}"/>
        <transform name="to_world"><lookat origin="{origin}" target="{target}" up="{up}"/></transform>
        <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/><rfilter type="box"/></film></sensor>"#
    )
}

/// A square with half side 1, moved and turned so that it faces the middle of the cube from −1 to 1.
fn wall(turn: &str, shift: &str, inside: &str) -> String {
    format!(
        r#"<shape type="rectangle"><transform name="to_world">{turn}<translate {shift}/></transform>{inside}</shape>"#
    )
}

fn cube(insides: [&str; 6]) -> String {
    let [floor, ceiling, left, right, front, back] = insides;
    [
        wall(r#"<rotate x="1" angle="-90"/>"#, r#"y="-1""#, floor),
        wall(r#"<rotate x="1" angle="90"/>"#, r#"y="1""#, ceiling),
        wall(r#"<rotate y="1" angle="90"/>"#, r#"x="-1""#, left),
        wall(r#"<rotate y="1" angle="-90"/>"#, r#"x="1""#, right),
        wall("", r#"z="-1""#, front),
        wall(r#"<rotate y="1" angle="180"/>"#, r#"z="1""#, back),
    ]
    .concat()
}

fn diffuse(reflectance: f64) -> String {
    format!(r#"<bsdf type="diffuse"><spectrum name="reflectance" value="{reflectance}"/></bsdf>"#)
}

/// A room made of a mesh, of glossy surfaces without gloss, and of rectangles: all the same.
#[test]
fn all_kinds_of_walls_are_lit_alike() {
    let ward = r#"<bsdf type="ward"><spectrum name="specular_reflectance" value="0"/><spectrum name="diffuse_reflectance" value="0.7"/></bsdf>"#;
    let lamp = r#"<emitter type="point"><point name="position" x="0.2" y="0.3" z="0.1"/><spectrum name="intensity" value="1"/></emitter>"#;
    let mesh = format!(r#"<shape type="cube"><boolean name="flip_normals" value="true"/>{}</shape>"#, diffuse(0.7));
    let [rectangles, mesh, ward] = [cube([&diffuse(0.7); 6]), mesh, cube([ward; 6])].map(|walls| {
        let camera = camera("0.1 0.2 0.3", "0.4 -0.5 -1", "0 1 0", 100.0);
        let scene = load(&format!("<scene version=\"3.0.0\">{camera}{lamp}{walls}</scene>"));
        luminances(&picture(&scene, &options(Spectra::Rgb, [16, 16], 0.02)))
    });
    for other in [mesh, ward] {
        for (a, b) in other.iter().zip(&rectangles) {
            assert!((a / b - 1.0).abs() <= 0.02, "{a} {b}");
        }
    }
}

/// All walls shine with radiance 1 and reflect ρ: everything has radiance 1/(1 − ρ).
#[test]
fn furnace() {
    for reflectance in [0.3, 0.9] {
        let inside = diffuse(reflectance) + r#"<emitter type="area"><spectrum name="radiance" value="1"/></emitter>"#;
        let xml = format!(
            "<scene version=\"3.0.0\">{}{}</scene>",
            camera("0.1 0.2 0.3", "0.4 -0.5 -1", "0 1 0", 100.0),
            cube([&inside; 6])
        );
        let found = picture(&load(&xml), &options(Spectra::Uniform(2), [16, 16], 0.05));
        let expected = 1.0 / (1.0 - reflectance);
        for y in luminances(&found) {
            assert!((y / expected - 1.0).abs() <= 1e-5, "{y} for {expected}");
        }
    }
}

/// What interpolation adds is within the accuracy; gathers at every pixel are the same but for it.
#[test]
fn cells_are_as_good_as_gathers_everywhere() {
    let scene = builtin::load("cornell-box", &[]).unwrap();
    let accuracy = 0.05;
    let cells = options(Spectra::Rgb, [64, 64], accuracy);
    let exact = Options { between: BetweenOptions { accuracy, exact: true }, ..cells };
    let [cells, exact] = [cells, exact].map(|options| picture(&scene, &options));
    let gathers = [&cells, &exact].map(|r| r.between.unwrap().gathers);
    assert!(gathers[0] > 0 && gathers[1] == 0, "{gathers:?}");
    let (cells, exact) = (luminances(&cells), luminances(&exact));
    let lit = || cells.iter().zip(&exact).filter(|(_, e)| **e > 0.0);
    let mut errors: Vec<f64> = lit().map(|(c, e)| (c / e - 1.0).abs()).collect();
    errors.sort_by(f64::total_cmp);
    assert!(errors.len() > 3000);
    assert!(errors[errors.len() * 95 / 100] <= accuracy, "{:?}", &errors[errors.len() - 200..]);
    let sums = [cells.iter().sum::<f64>(), exact.iter().sum::<f64>()];
    assert!((sums[0] / sums[1] - 1.0).abs() <= accuracy / 5.0, "{sums:?}");
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let scene = builtin::load("cornell-box-spheres", &[]).unwrap();
    let options = options(Spectra::Rgb, [24, 24], 0.1);
    let [one, three] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| picture(&scene, &options))
    });
    assert_eq!(one.picture, three.picture);
    let [a, b] = [&one, &three].map(|r| r.between.unwrap());
    assert_eq!((a.radiosity, a.gathers), (b.radiosity, b.gathers));
}

/// Where light is gathered doesn't depend on the representation, so that bounds can be told from truth pixel by pixel.
#[test]
fn certified_bounds_hold_at_every_pixel() {
    for name in ["cornell-box", "cornell-box-lamp"] {
        let scene = builtin::load(name, &[]).unwrap();
        let threshold = 1.0;
        let interval = Spectra::Interval(IntervalSettings { mode: Mode::Certified, threshold, white: 1.0 });
        let found = picture(&scene, &options(interval, [24, 24], 0.1));
        let [coarse, truth] = [401, 1600].map(|bins| picture(&scene, &options(Spectra::Uniform(bins), [24, 24], 0.1)));
        assert_eq!(found.between.unwrap().gathers, truth.between.unwrap().gathers);
        let bounds = found.delta_e.as_ref().unwrap().pixels();
        let mut lit = 0;
        let references = coarse.picture.pixels().iter().zip(truth.picture.pixels());
        for ((pixel, (coarse, truth)), bound) in found.picture.pixels().iter().zip(references).zip(bounds) {
            let lab = |rgb: &[f32; 3]| xyz_to_lab(linear_rgb_to_xyz(rgb.map(f64::from)), rgb::WHITE);
            let error = delta_e_ab(lab(pixel), lab(truth));
            // What a quarter of the bins differs by is more than the error of all of them. Pictures are rounded to f32.
            let own = delta_e_ab(lab(coarse), lab(truth)) + 1e-4;
            assert!(error <= f64::from(*bound) + own, "{name}: {error} over {bound} and {own}");
            lit += usize::from(*bound > 0.0);
        }
        assert!(lit > 400, "{lit}");
        let worst = bounds.iter().fold(0.0_f32, |worst, bound| worst.max(*bound));
        assert!(f64::from(worst) <= threshold, "{name}: {worst}");
    }
}

/// A ceiling that only the floor lights, seen directly and in a mirror.
#[test]
fn mirrors_show_what_other_surfaces_light() {
    let lamp = r#"<emitter type="point"><point name="position" x="0.2" y="0.9" z="0.1"/><spectrum name="intensity" value="1"/></emitter>"#;
    let shade = wall(r#"<rotate x="1" angle="90"/><scale value="0.3"/>"#, r#"x="0.2" y="0.95" z="0.1""#, "");
    let walls = diffuse(0.7);
    let mirror = r#"<shape type="rectangle"><transform name="to_world"><scale value="0.2"/><translate x="-0.5" y="-0.2" z="-0.6"/></transform>
        <bsdf type="conductor"/></shape>"#;
    let scene = |camera: String| {
        load(&format!("<scene version=\"3.0.0\">{camera}{lamp}{shade}{mirror}{}</scene>", cube([&walls; 6])))
    };
    // From (−0.5, −0.6, 0.4) to the mirror's middle and on to (−0.5, 1, 2.4) · along (0, 0.4, 1) towards the ceiling or the back wall.
    let through = scene(camera("-0.5 -0.6 0.4", "-0.5 -0.2 -0.6", "0 1 0", 0.01));
    let straight = scene(camera("-0.5 -0.199996 -0.59999", "-0.5 0.2 0.4", "0 1 0", 0.01));
    let options = options(Spectra::Rgb, [1, 1], 0.02);
    let exact = Options { between: BetweenOptions { accuracy: 0.02, exact: true }, ..options };
    let [seen, direct] = [&through, &straight].map(|scene| luminances(&picture(scene, &exact))[0]);
    assert!(direct > 0.0 && (seen / direct - 1.0).abs() <= 1e-3, "{seen} {direct}");
    let whitted = Options { renderer: Renderer::Whitted, ..options };
    let without = luminances(&picture(&through, &whitted))[0];
    assert!(without < 0.9 * seen, "{without} {seen}");
}

/// All representations gather at the same places and agree about luminance as far as they can.
#[test]
fn every_representation_has_light_between_surfaces() {
    let scene = builtin::load("cornell-box", &[]).unwrap();
    let truth = picture(&scene, &options(Spectra::Uniform(81), [16, 16], 0.1));
    let sum = |rendering: &Rendering| luminances(rendering).iter().sum::<f64>();
    let whitted = Options { renderer: Renderer::Whitted, ..options(Spectra::Uniform(81), [16, 16], 0.1) };
    assert!(sum(&picture(&scene, &whitted)) < 0.85 * sum(&truth));
    for spectra in [
        Spectra::default(),
        Spectra::Interval(IntervalSettings { mode: Mode::Corrected, ..IntervalSettings::default() }),
        Spectra::Interval(IntervalSettings { mode: Mode::Paper, ..IntervalSettings::default() }),
        Spectra::Rgb,
        Spectra::RgbPrefiltered,
        Spectra::Bilinear,
        Spectra::Smits,
    ] {
        let found = picture(&scene, &options(spectra, [16, 16], 0.1));
        assert_eq!(found.between.unwrap().gathers, truth.between.unwrap().gathers, "{spectra}");
        let ratio = sum(&found) / sum(&truth);
        assert!((ratio - 1.0).abs() <= 0.06, "{spectra}: {ratio}");
        assert_eq!(found.delta_e.is_some(), matches!(spectra, Spectra::Interval(_)));
    }
}

#[test]
fn balance_and_convergence_are_reported() {
    let scene = builtin::load("cornell-box", &[]).unwrap();
    let found = picture(&scene, &options(Spectra::Rgb, [16, 16], 0.05)).between.unwrap();
    let report = found.radiosity;
    assert!(report.patches > 20 && report.links > report.patches && report.iterations > 2, "{report:?}");
    assert!(report.residual <= 1e-7 && report.energy_balance.abs() <= 1e-7, "{report:?}");
    assert!(found.seconds.iter().all(|s| *s >= 0.0));
}

/// A path of so many segments has so many reflections.
#[test]
fn depth_is_honoured() {
    let scene = |depth: i32| {
        let inside = diffuse(0.5);
        let light = r#"<emitter type="point"><point name="position" x="0" y="0" z="0"/><spectrum name="intensity" value="1"/></emitter>"#;
        let camera = camera("0.1 0.2 0.3", "0.4 -0.5 -1", "0 1 0", 60.0);
        let integrator = format!(r#"<integrator type="path"><integer name="max_depth" value="{depth}"/></integrator>"#);
        load(&format!("<scene version=\"3.0.0\">{integrator}{camera}{light}{}</scene>", cube([&inside; 6])))
    };
    let options = options(Spectra::Uniform(1), [8, 8], 0.02);
    let mean = |scene: &Scene, options: &Options| luminances(&picture(scene, options)).iter().sum::<f64>() / 64.0;
    let means = [2, 3, 4, 64].map(|depth| mean(&scene(depth), &options));
    let direct = mean(&scene(2), &Options { renderer: Renderer::Whitted, ..options });
    assert!((means[0] / direct - 1.0).abs() <= 1e-6, "{means:?}");
    // In a closed space whose walls reflect one half, each reflection brings about half as much as the one before.
    let steps = [means[1] - means[0], means[2] - means[1]];
    assert!(steps.iter().all(|s| *s > 0.0), "{means:?}");
    assert!((steps[1] / steps[0] - 0.5).abs() <= 0.03, "{means:?}");
    assert!(((means[3] - means[2]) / steps[1] - 1.0).abs() <= 0.06, "{means:?}");
}

#[test]
fn what_has_no_radiosity_is_refused() {
    let refused = |body: &str, accuracy: f64| {
        let xml = format!("<scene version=\"3.0.0\">{}{body}</scene>", camera("0 0 0", "0 0 -1", "0 1 0", 60.0));
        render(&load(&xml), &options(Spectra::Rgb, [4, 4], accuracy), &|_| {}).unwrap_err().to_string()
    };
    let lamp = r#"<emitter type="point"><spectrum name="intensity" value="1"/></emitter>"#;
    let mirrors = cube([r#"<bsdf type="conductor"/>"#; 6]);
    let error = refused(&format!("{lamp}{mirrors}"), 0.1);
    assert!(error.contains("no surface that reflects diffusely"), "{error}");
    assert!(refused(lamp, 0.1).contains("no surface"));
    let white = cube([&diffuse(1.0); 6]);
    assert!(refused(&format!("{lamp}{white}"), 0.1).contains("no radiosity solution"));
    for accuracy in [0.0, -1.0, 1.5, f64::NAN] {
        assert!(refused(&format!("{lamp}{}", cube([&diffuse(0.5); 6])), accuracy).contains("accuracy"));
    }
}
