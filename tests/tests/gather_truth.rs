#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]
//! Light between surfaces by final gathers from photons, against closed forms and path tracing.

use renderers::render::{Between, GatherOptions, Options, PhotonOptions, Renderer, Rendering, Spectra, render};
use renderers::scene::{self, Scene, Source, builtin};
use spectral_core::colour::linear_rgb_to_xyz;

fn options(spectra: Spectra, size: [u32; 2], samples: u32) -> Options {
    Options {
        renderer: Renderer::PhotonMap,
        spectra,
        size: Some(size),
        samples: Some(samples),
        photons: PhotonOptions { between: Between::Gather, ..PhotonOptions::default() },
        ..Options::default()
    }
}

fn picture(scene: &Scene, options: &Options) -> Rendering {
    render(scene, options, &|_| {}).unwrap()
}

fn luminances(rendering: &Rendering) -> Vec<f64> {
    let y = |rgb: &[f32; 3]| linear_rgb_to_xyz(rgb.map(f64::from))[1];
    rendering.picture.pixels().iter().map(y).collect()
}

/// A cube from −1 to 1, seen from within; all its walls shine with radiance 1.
fn furnace(reflectance: f64, depth: i32) -> Scene {
    let turns = [
        r#"<rotate x="1" angle="-90"/><translate y="-1"/>"#,
        r#"<rotate x="1" angle="90"/><translate y="1"/>"#,
        r#"<rotate y="1" angle="90"/><translate x="-1"/>"#,
        r#"<rotate y="1" angle="-90"/><translate x="1"/>"#,
        r#"<translate z="-1"/>"#,
        r#"<rotate y="1" angle="180"/><translate z="1"/>"#,
    ];
    let wall = |turn: &str| {
        format!(
            r#"<shape type="rectangle"><transform name="to_world">{turn}</transform>
            <bsdf type="diffuse"><spectrum name="reflectance" value="{reflectance}"/></bsdf>
            <emitter type="area"><spectrum name="radiance" value="1"/></emitter></shape>"#
        )
    };
    let walls: String = turns.map(wall).concat();
    let xml = format!(
        r#"<scene version="3.0.0"><integrator type="path"><integer name="max_depth" value="{depth}"/></integrator>
        <sensor type="perspective"><float name="fov" value="100"/>
        <transform name="to_world"><lookat origin="0.1 0.2 0.3" target="0.4 -0.5 -1" up="0 1 0"/></transform>
        <film type="hdrfilm"><rfilter type="box"/></film></sensor>{walls}</scene>"#
    );
    scene::load(&Source::text("test.xml", xml), &[]).unwrap()
}

/// `closed form`: everything has radiance 1/(1 − ρ); with paths of n segments at most, the first n terms of its series.
#[test]
fn furnaces_are_the_sum_of_a_series() {
    for (reflectance, depth) in [(0.5_f64, -1), (0.9, -1), (0.8, 2), (0.8, 3), (0.8, 4), (0.8, 5)] {
        let found = luminances(&picture(&furnace(reflectance, depth), &options(Spectra::Uniform(2), [16, 16], 1)));
        let expected = match depth {
            -1 => 1.0 / (1.0 - reflectance),
            depth => (0..depth).map(|n| reflectance.powi(n)).sum(),
        };
        let mean = found.iter().sum::<f64>() / 256.0;
        assert!((mean / expected - 1.0).abs() <= 0.01, "{reflectance} {depth}: {mean} {expected}");
        for y in found {
            assert!((y / expected - 1.0).abs() <= 0.03, "{reflectance} {depth}: {y} {expected}");
        }
    }
}

/// Sums over blocks of `side` pixels of luminance and of its variance.
fn blocks(rendering: &Rendering, width: usize, side: usize) -> Vec<[f64; 2]> {
    let variances = rendering.variance.as_ref().map(|v| v.luminance.pixels().to_vec());
    let mut sums = vec![[0.0; 2]; (width / side).pow(2)];
    for (pixel, y) in luminances(rendering).into_iter().enumerate() {
        let (column, row) = (pixel % width / side, pixel / width / side);
        let [sum, variance] = &mut sums[row * (width / side) + column];
        *sum += y;
        *variance += variances.as_ref().map_or(0.0, |v| f64::from(v[pixel]));
    }
    sums
}

/// `independent`: path tracing. Light by way of glass and mirrors counts once where it lands, and for what it is reflected to.
#[test]
fn pictures_are_those_of_path_tracing() {
    for (name, samples) in [("cornell-box", 256), ("cornell-box-glass", 512), ("cornell-box-spheres", 512)] {
        let scene = builtin::load(name, &[]).unwrap();
        let (width, side) = (32, 8);
        let spectra = Spectra::Uniform(8);
        let found = blocks(&picture(&scene, &options(spectra, [32, 32], 64)), width, side);
        let path = Options { renderer: Renderer::Path, ..options(spectra, [32, 32], samples) };
        let truth = blocks(&picture(&scene, &path), width, side);
        let mut sums = [[0.0; 2]; 2];
        for (block, (found, truth)) in found.iter().zip(&truth).enumerate() {
            // Interpolation, nearest places and estimates of density have a bias of a part of this in most blocks.
            let allowed = 4.0 * truth[1].sqrt() + 0.02 * truth[0];
            assert!((found[0] - truth[0]).abs() <= allowed, "{name} {block}: {found:?} {truth:?}");
            for (sum, own) in sums.iter_mut().zip([found, truth]) {
                *sum = [sum[0] + own[0], sum[1] + own[1]];
            }
        }
        let [found, truth] = sums;
        let allowed = 4.0 * truth[1].sqrt() + 0.005 * truth[0];
        assert!((found[0] - truth[0]).abs() <= allowed, "{name}: {found:?} {truth:?}");
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let scene = builtin::load("cornell-box-glass", &[("glass".to_owned(), "SF10".to_owned())]).unwrap();
    let gather = GatherOptions { photons: 20_000, rays: 64 };
    for exact in [false, true] {
        let options = Options { gather, ..options(Spectra::Rgb, [12, 12], 1) };
        let options = Options { between: renderers::render::BetweenOptions { exact, ..options.between }, ..options };
        let [one, three] = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| picture(&scene, &options))
        });
        assert_eq!(one.picture, three.picture);
        let [a, b] = [&one, &three].map(|r| r.gather.unwrap());
        assert_eq!((a.gathers, a.photons, a.products, a.places), (b.gathers, b.photons, b.products, b.places));
        assert_eq!(a.gathers == 0, exact);
    }
}

/// Nothing of gathered light is certain, so that nothing is said of bounds.
#[test]
fn gathered_pictures_have_no_bound() {
    let scene = builtin::load("cornell-box", &[]).unwrap();
    let gather = GatherOptions { photons: 10_000, rays: 64 };
    let found = picture(&scene, &Options { gather, ..options(Spectra::default(), [8, 8], 1) });
    assert!(found.delta_e.is_none() && found.between.is_none());
    let absurd = GatherOptions { photons: 1 << 40, rays: 64 };
    for gather in [absurd, GatherOptions { photons: 0, rays: 64 }, GatherOptions { photons: 64, rays: 0 }] {
        let refused = render(&scene, &Options { gather, ..options(Spectra::Rgb, [8, 8], 1) }, &|_| {});
        assert!(refused.unwrap_err().to_string().contains("photon"));
    }
}
