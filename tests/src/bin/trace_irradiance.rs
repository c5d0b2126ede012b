//! Prints indirect illuminances in the Cornell box, found by random walks, as they are in `tests/data/cornell_irradiance.csv`.
//!
//! `cargo run --release -p spectral-tests --bin trace_irradiance [BATCHES] > tests/data/cornell_irradiance.csv`

use std::io::Write;

use disk_sampling::Receiver;
use renderers::scene::{Scene, builtin};
use renderers::spectral::{Palette, UniformBins};
use spectral_tests::generators::Draw;
use spectral_tests::irradiance::{Walker, spectra};

/// Bins of the spectrum.
const BINS: usize = 8;

type Place = ([f64; 3], [f64; 3]);

/// Where shadows, contacts and narrow gaps are.
const HARD: [Place; 22] = [
    // Floor: between the blocks, along the tall one, and in the shade behind it.
    ([278.0, 0.0, 279.5], [0.0, 1.0, 0.0]),
    ([253.0, 0.0, 283.0], [0.0, 1.0, 0.0]),
    ([300.0, 0.0, 240.0], [0.0, 1.0, 0.0]),
    ([340.0, 0.0, 265.0], [0.0, 1.0, 0.0]),
    ([275.0, 0.0, 200.0], [0.0, 1.0, 0.0]),
    ([451.0, 0.0, 325.5], [0.0, 1.0, 0.0]),
    ([400.0, 0.0, 450.0], [0.0, 1.0, 0.0]),
    ([300.0, 0.0, 500.0], [0.0, 1.0, 0.0]),
    // Floor beside the short block, and in its shade.
    ([211.0, 0.0, 86.0], [0.0, 1.0, 0.0]),
    ([100.0, 0.0, 100.0], [0.0, 1.0, 0.0]),
    ([103.0, 0.0, 145.0], [0.0, 1.0, 0.0]),
    // Floor beside the walls.
    ([3.0, 0.0, 100.0], [0.0, 1.0, 0.0]),
    ([100.0, 0.0, 556.0], [0.0, 1.0, 0.0]),
    ([547.0, 0.0, 279.0], [0.0, 1.0, 0.0]),
    // The back wall above the floor, and behind the tall block.
    ([50.0, 4.0, 559.2], [0.0, 0.0, -1.0]),
    ([330.0, 150.0, 559.2], [0.0, 0.0, -1.0]),
    // The left wall in the upper corner.
    ([0.0, 545.0, 20.0], [1.0, 0.0, 0.0]),
    // The ceiling beside the lamp and in a corner.
    ([278.0, 548.8, 220.0], [0.0, -1.0, 0.0]),
    ([540.0, 548.8, 540.0], [0.0, -1.0, 0.0]),
    // The short block's top, and the lamp.
    ([188.0, 165.0, 165.0], [0.0, 1.0, 0.0]),
    ([285.0, 165.0, 115.0], [0.0, 1.0, 0.0]),
    ([278.0, 548.8, 279.5], [0.0, -1.0, 0.0]),
];
/// How many more are anywhere on the surfaces.
const RANDOM: usize = 26;

/// Places spread at random over the triangles of the meshes, by area.
fn random_places(scene: &Scene) -> Vec<Place> {
    let mut triangles = Vec::new();
    let mut area = 0.0;
    for shape in &scene.shapes {
        if let renderers::scene::Geometry::Mesh(mesh) = &shape.geometry {
            for index in 0..mesh.triangles.len() {
                area += mesh.face_cross(index).length() / 2.0;
                triangles.push((area, mesh.corners(index), mesh.face_cross(index).normalize()));
            }
        }
    }
    let mut random = Draw::new(171);
    let mut places = Vec::new();
    while places.len() < RANDOM {
        let (choice, mut u, mut v) = (random.unit() * area, random.unit(), random.unit());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let Some((_, [a, b, c], normal)) = triangles.iter().find(|(sum, ..)| choice < *sum) else { continue };
        // On a grid that f32 keeps.
        let round = |x: f64| (x * 64.0).round() / 64.0;
        let place = *a + (*b - *a) * u + (*c - *a) * v;
        // Faces of the blocks can be turned: the nearest point of the plane again.
        let rounded = renderers::scene::glam::DVec3::new(round(place.x), round(place.y), round(place.z));
        let place = rounded - *normal * (rounded - *a).dot(*normal);
        // Under the blocks is no light.
        let under = normal.y > 0.9 && place.y == 0.0 && is_under_a_block([place.x, place.z]);
        if !under {
            places.push((place.to_array(), normal.to_array()));
        }
    }
    places
}

/// Outlines of the blocks in x and z.
const BLOCKS: [[[f64; 2]; 4]; 2] = [
    [[130.0, 65.0], [82.0, 225.0], [240.0, 272.0], [290.0, 114.0]],
    [[423.0, 247.0], [265.0, 296.0], [314.0, 456.0], [472.0, 406.0]],
];

fn is_under_a_block([x, z]: [f64; 2]) -> bool {
    let inside = |corners: &[[f64; 2]; 4]| {
        (0..4).all(|i| {
            let ([a, b], [c, d]) = (corners[i], corners[(i + 1) % 4]);
            (c - a) * (z - b) - (d - b) * (x - a) <= 0.0
        })
    };
    BLOCKS.iter().any(inside)
}

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let batches: u32 = std::env::args().nth(1).map_or(Ok(1024), |text| text.parse())?;
    let scene = builtin::load("cornell-box", &[])?;
    let mut palette = Palette::default();
    spectra(&scene, &mut palette);
    let bins = UniformBins::new(&palette, BINS)?;
    let walker = Walker::new(&scene, &mut palette, &bins)?;
    let mut out = std::io::stdout().lock();
    writeln!(
        out,
        "# Indirect illuminance in the built-in Cornell box, all interreflections, {BINS} bins of the spectrum: the mean of"
    )?;
    writeln!(
        out,
        "# {batches} batches of 4096 random walks and its standard deviation. Written by tests/src/bin/trace_irradiance.rs."
    )?;
    writeln!(out, "# x, y, z, nx, ny, nz, lux, deviation")?;
    for (position, normal) in HARD.into_iter().chain(random_places(&scene)) {
        let found = walker.indirect(&Receiver::new(position, normal)?, batches);
        let numbers = position.iter().chain(&normal).map(|x| format!("{x}, ")).collect::<String>();
        writeln!(out, "{numbers}{:.2}, {:.2}", found.mean, found.deviation)?;
    }
    Ok(())
}
