//! Time for exchanges between polygons, and for radiosity. `cargo bench -p renderers --bench radiosity`.
//!
//! `… -- spectral` compares representations of spectra instead (with `corrected`, that mode and 81 bins, often), `… -- scaling` time and memory
//! from hundreds of patches to tens of thousands, and `… -- places` time for light at places of scenes of as many faces: as tables.
//!
//! The cube is CIE 171 5.8 at ρ = 0.95 with 400 points; the Cornell box is solved for 81 bins at several accuracies, without points.

#![allow(clippy::expect_used, clippy::panic, clippy::cast_precision_loss, reason = "the scenes are constants")]
#![allow(clippy::print_stdout, reason = "the table")]

mod places;
mod scaling;
mod spectral;

fn main() {
    let asked = |what: &str| std::env::args().any(|argument| argument == what);
    if asked("spectral") {
        spectral::run();
    } else if asked("scaling") {
        scaling::run();
    } else if asked("places") {
        places::run();
    } else {
        divan::main();
    }
}

use disk_sampling::Receiver;
use divan::{Bencher, black_box};
use renderers::radiosity::{Flat, Radiosity, Settings, polygon_exchange};
use renderers::scene::{Scene, Source, builtin, load};
use renderers::spectral::{Palette, UniformBins};

type Quad = [[f64; 3]; 4];

const FLOOR: Quad = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

fn opposite(h: f64) -> Quad {
    [[0.0, 0.0, h], [0.0, 1.0, h], [1.0, 1.0, h], [1.0, 0.0, h]]
}

#[divan::bench(args = [1e-3, 0.1, 1.0, 5.0, 5.5, 6.0, 7.0, 10.0, 20.0, 100.0])]
fn opposite_squares(bencher: Bencher<'_, '_>, h: f64) {
    let (one, other) = (FLOOR, opposite(h));
    bencher.bench(|| polygon_exchange(black_box(&one), black_box(&other)));
}

#[divan::bench(args = [0.0, 1e-6, 1.0, 4.0, 4.5, 5.0, 5.5, 6.0, 7.0, 10.0, 20.0])]
fn perpendicular_squares(bencher: Bencher<'_, '_>, gap: f64) {
    let (one, x) = (FLOOR, -gap);
    let other = [[x, 0.0, 0.0], [x, 1.0, 0.0], [x, 1.0, 1.0], [x, 0.0, 1.0]];
    bencher.bench(|| polygon_exchange(black_box(&one), black_box(&other)));
}

/// Triangles that have no parallel edges.
#[divan::bench(args = [0.0, 0.3, 3.0])]
fn skew_triangles(bencher: Bencher<'_, '_>, h: f64) {
    let one = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.2, 1.0, 0.0]];
    let other = [[0.1, -0.1, h], [0.3, 0.2, h + 1.0], [1.0, 0.1, h + 0.1]];
    bencher.bench(|| polygon_exchange(black_box(&one), black_box(&other)));
}

fn cube() -> Scene {
    let xml = "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='40'/></sensor>
        <shape type='cube'><transform name='to_world'><scale value='2'/></transform>
        <boolean name='flip_normals' value='true'/>
        <bsdf type='diffuse'><spectrum name='reflectance' value='0.95'/></bsdf></shape>
        <emitter type='point'><spectrum name='intensity' value='795.774715459'/></emitter></scene>";
    load(&Source::text("cube.xml", xml), &[]).expect("a scene")
}

#[divan::bench(sample_count = 10, args = [1e-2, 3e-3, 1e-3])]
fn cie_171_5_8(bencher: Bencher<'_, '_>, accuracy: f64) {
    let scene = cube();
    bencher.bench(|| {
        let settings = Settings { accuracy, ..Settings::default() };
        let radiosity = Radiosity::new(&scene, &settings, &mut Palette::default(), &|_| {}).expect("a solution");
        let solution = radiosity.solve(&Flat).expect("a solution");
        let at = |i: u32| 4.0 * (f64::from(i) + 0.5) / 20.0 - 2.0;
        let points = (0..20).flat_map(|i| (0..20).map(move |j| [at(i), at(j), -2.0]));
        let receivers = points.filter_map(|p| Receiver::new(p, [0.0, 0.0, 1.0]).ok());
        receivers.map(|r| solution.indirect(&r)[0]).sum::<f64>()
    });
}

#[divan::bench(sample_count = 3, sample_size = 1, args = [3e-2, 3e-3, 3e-4, 3e-5, 1e-5])]
fn cornell_box(bencher: Bencher<'_, '_>, accuracy: f64) {
    let scene = builtin::load("cornell-box", &[]).expect("a built-in scene");
    bencher.bench(|| {
        let settings = Settings { accuracy, ..Settings::default() };
        let mut palette = Palette::default();
        let radiosity = Radiosity::new(&scene, &settings, &mut palette, &|_| {}).expect("a solution");
        let bins = UniformBins::new(&palette, 81).expect("bins");
        let report = *radiosity.solve(&bins).expect("a solution").report();
        eprintln!("{} patches, {} links, {:.1} MB", report.patches, report.links, report.bytes as f64 / 1e6);
        report
    });
}
