//! The photon map's irradiance on receivers against closed forms of geometrical optics: how much light there is, and where.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use renderers::render::{Options, PhotonCount, PhotonOptions, Spectra};
use spectral_tests::bodies::hemisphere;
use spectral_tests::receiver::Receiver;
use spectral_tests::snell::{Focus, Lens, Way};

const DOWN: &str = "<emitter type='directional'><vector name='direction' x='0' y='-1' z='0'/>
    <spectrum name='irradiance' value='1'/></emitter>";

fn glass(index: &str) -> String {
    format!("<bsdf type='dielectric'>{index}<float name='ext_ior' value='1'/></bsdf>")
}

fn options(count: u64, seed: u64, radius: f64, nearest: usize) -> Options {
    let photons = PhotonOptions { count: PhotonCount::Count(count), radius: Some(radius), nearest, between: false, ..PhotonOptions::default() };
    Options { spectra: Spectra::Uniform(1), samples: Some(4), seed: Some(seed), photons, ..Options::default() }
}

fn closed(focus: &Focus, r: f64) -> f64 {
    let ways: &[Way] = if focus.lens == Lens::Ball { &[Way::Reflected, Way::Through(0), Way::Through(1), Way::Through(2), Way::Through(3), Way::Through(4)] } else { &[Way::Through(0)] };
    ways.iter().map(|w| focus.flux(*w, r)).sum()
}

#[test]
fn explore() {
    let ball = format!("<shape type='sphere'>{}</shape>", glass("<float name='int_ior' value='1.5'/>"));
    let (dome, mesh) = hemisphere(true, 48, &glass("<float name='int_ior' value='1.5'/>"));
    for (lens, distance, half, body) in [(Lens::Ball, 2.0, 2.0, &ball), (Lens::Ball, 1.5, 2.0, &ball), (Lens::RoundFirst, 1.2, 1.5, &dome)] {
        let focus = Focus { lens, radius: 1.0, index: 1.5, distance };
        let eye = if lens == Lens::Ball { 0.45 } else { 1.0 };
        let receiver = Receiver::floor(-distance, half, eye);
        let scene = receiver.scene(&format!("{DOWN}{body}"), &[("dome.obj", &mesh)]).unwrap();
        for (radius, nearest, count) in [(0.18, 50, 20_000), (0.18, 50, 200_000), (0.1, 400, 200_000), (0.05, 400, 200_000), (0.05, 4000, 200_000), (0.02, 400, 200_000)] {
            for adaptive in [true, false] {
                for seed in 0..2 {
                    let mut o = options(count, seed, radius, nearest);
                    o.photons.adaptive = adaptive;
                    let t = std::time::Instant::now();
                    let (map, report) = receiver.caustics(&scene, &o).unwrap();
                    let s = t.elapsed().as_secs_f64();
                    print!("{lens:?} {distance} r{radius} k{nearest} n{count} {adaptive} {s:.2}s em {} even {} flux {:?}: ", report.emitted, report.even, report.flux);
                    for r in [0.2, 0.5, 1.0, half] {
                        print!("{:.4} ({:+.3} %) ", map.flux_within(r)[1], 100.0 * (map.flux_within(r)[1] / closed(&focus, r) - 1.0));
                    }
                    println!("{:?}", map.centroid(1));
                }
            }
        }
    }
}
