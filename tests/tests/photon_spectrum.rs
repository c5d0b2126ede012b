//! Spectra of a prism's beam on a wall, by photons: no bands show, and photons interpolated between wavelengths are those that were traced.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use renderers::geometry::glam::DVec3;
use renderers::photon::{Bundle, Rethrow};
use renderers::render::{Options, PhotonCount, PhotonOptions, Spectra};
use renderers::scene::{Scene, builtin};
use renderers::spectral::Y_INTEGRAL;
use spectral_core::Observer;
use spectral_core::dispersion::{Dispersion, Glass};
use spectral_tests::bodies;
use spectral_tests::receiver::Receiver;
use spectral_tests::snell::Prism;

/// The length of the prism's faces.
const LENGTH: f64 = 2.0;
/// Where the wall is behind its edge.
const WALL: f64 = 8.0;
/// Where along the left face light comes in.
const SLIT: [f64; 2] = [0.8, 0.86];
const GLASS: &str = "N-SF11";

/// A narrow beam of flat parallel light through a prism onto a wall, which shows the spectrum from red to violet along columns.
struct Bench {
    apex: f64,
    incidence: f64,
    glass: Glass<f64>,
    receiver: Receiver,
}

impl Bench {
    fn new() -> Self {
        let receiver = Receiver {
            centre: DVec3::new(WALL, -4.7, 0.0),
            normal: DVec3::NEG_X,
            down: DVec3::Z,
            half: 0.72,
            eye: 1.0,
        };
        let [apex, incidence] = [50.0_f64, 48.0].map(f64::to_radians);
        Self { apex, incidence, glass: Glass::find(GLASS).unwrap(), receiver }
    }

    fn prism(&self, wavelength: f64) -> Prism {
        Prism { apex: self.apex, index: self.glass.index(wavelength) }
    }

    /// Blockers close to the left face leave the slit open.
    fn scene(&self, light: &str) -> Scene {
        let direction = self.incidence - self.apex / 2.0;
        let way = DVec3::new(direction.cos(), direction.sin(), 0.0);
        // Along the plane of the slit, across the beam.
        let across = DVec3::new(-way.y, way.x, 0.0);
        let foot = |entry: f64| {
            let [x, y] = self.prism(500.0).face(-1.0, entry);
            DVec3::new(x, y, 0.0)
        };
        let origin = foot(SLIT[0]) - way * 3.0;
        let text = |v: DVec3| format!("{}, {}, {}", v.x, v.y, v.z);
        let blocker = |side: f64, entry: f64| {
            // Its edge is where the ray to this end of the slit passes.
            let ahead = foot(entry);
            let edge = ahead - way * (ahead - origin).dot(way);
            let centre = edge + across * (side * 1.5);
            format!(
                "<shape type='rectangle'><transform name='to_world'><scale x='2' y='1.5'/><lookat origin='{}' target='{}' up='{}'/></transform>
                <bsdf type='diffuse'><spectrum name='reflectance' value='0'/></bsdf></shape>",
                text(centre),
                text(centre - way),
                text(across)
            )
        };
        let body = format!(
            "<emitter type='directional'><vector name='direction' x='{}' y='{}' z='0'/><spectrum name='irradiance' value='{light}'/></emitter>
            <shape type='obj'><string name='filename' value='prism.obj'/><boolean name='face_normals' value='true'/>
            <bsdf type='dielectric'><string name='int_ior' value='{GLASS}'/><float name='ext_ior' value='1'/></bsdf></shape>{}{}",
            way.x,
            way.y,
            blocker(1.0, SLIT[0]),
            blocker(-1.0, SLIT[1])
        );
        let mesh = bodies::prism(Prism { apex: self.apex, index: 1.0 }, LENGTH);
        self.receiver.scene(&body, &[("prism.obj", &mesh)]).unwrap()
    }

    /// Closed form: the irradiance in XYZ, mean over each of some columns. Each wavelength lights a strip evenly.
    fn truth(&self, columns: u32) -> Vec<[f64; 3]> {
        const FINE: u32 = 8;
        let observer = Observer::<f64>::cie_1931_2deg();
        let Receiver { centre, half, .. } = self.receiver;
        let width = 2.0 * half / f64::from(columns);
        let mut sums = vec![[0.0; 3]; columns as usize];
        for wavelength in (0..400 * FINE).map(|k| 380.0 + (f64::from(k) + 0.5) / f64::from(FINE)) {
            let prism = self.prism(wavelength);
            let [a, b] = SLIT.map(|entry| self.height(prism, entry) - (centre.y - half));
            let [low, high] = [a.min(b), a.max(b)];
            let share = prism.ray(1.0, self.incidence).unwrap().share;
            let irradiance = share * (SLIT[1] - SLIT[0]) * self.incidence.cos() / (high - low);
            let value = observer.value(wavelength).map(|v| v * irradiance / (Y_INTEGRAL * f64::from(FINE)));
            for (column, sum) in (0..columns).zip(&mut sums) {
                let from = f64::from(column) * width;
                let part = ((from + width).min(high) - from.max(low)).max(0.0) / width;
                *sum = core::array::from_fn(|c| sum[c] + part * value[c]);
            }
        }
        sums
    }

    fn height(&self, prism: Prism, entry: f64) -> f64 {
        prism.height(entry, self.incidence, WALL).unwrap()
    }
}

fn options(photons: PhotonOptions, side: u32) -> Options {
    let photons = PhotonOptions { between: false, ..photons };
    Options { size: Some([side; 2]), samples: Some(4), photons, ..Options::default() }
}

/// Mean squares of second differences: what bands and steps have much of, smooth spectra little.
fn roughness(profile: &[[f64; 3]]) -> f64 {
    let squares = profile.windows(3).map(|p| (0..3).map(|c| (p[0][c] - 2.0 * p[1][c] + p[2][c]).powi(2)).sum::<f64>());
    squares.sum::<f64>()
}

fn distance(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let squares = |a: &[[f64; 3]], b: &[[f64; 3]]| {
        a.iter().zip(b).map(|(a, b)| (0..3).map(|c| (a[c] - b[c]).powi(2)).sum::<f64>()).sum::<f64>()
    };
    (squares(a, b) / squares(b, &vec![[0.0; 3]; b.len()])).sqrt()
}

#[test]
fn no_bands_show_in_a_prisms_spectrum() {
    let bench = Bench::new();
    let scene = bench.scene("1");
    let side = 96;
    let truth = bench.truth(side);
    println!("truth roughness {:.3e}", roughness(&truth));
    for bundle in [Bundle::Continuous, Bundle::Single] {
        for (count, radius) in [(100_000, 0.02), (400_000, 0.02), (100_000, 0.05)] {
            let t = std::time::Instant::now();
            let photons = PhotonOptions {
                count: PhotonCount::Count(count),
                bundle,
                radius: Some(radius),
                nearest: 100,
                ..PhotonOptions::default()
            };
            let (map, report) = bench.receiver.caustics(&scene, &options(photons, side)).unwrap();
            let profile = map.profile(&(-0.5..0.5));
            println!(
                "{bundle:?} {count} {radius} {:.1} s rough {:.3e} distance {:.4} flux {:?} bands {} disp {}",
                t.elapsed().as_secs_f64(),
                roughness(&profile),
                distance(&profile, &truth),
                map.flux_in(&(-1.0..1.0), &(-0.5..0.5)),
                report.bands.len(),
                report.dispersed
            );
            if count == 100_000 && radius == 0.02 {
                for (k, (p, t)) in profile.iter().zip(&truth).enumerate() {
                    if k % 2 == 0 {
                        println!("{k} {:.4?} {:.4?}", p, t);
                    }
                }
            }
        }
    }
}

#[test]
fn interpolated_photons_are_those_that_are_traced() {
    for (name, glass) in [("cornell-box-glass", "N-BK7"), ("caustic-ring", "437907"), ("prism", "SF10")] {
        let parameters = if name == "caustic-ring" { vec![] } else { vec![("glass".to_owned(), glass.to_owned())] };
        let scene = builtin::load(name, &parameters).unwrap();
        let picture = |rethrow, seed| {
            let photons = PhotonOptions { count: PhotonCount::Count(30_000), rethrow, ..PhotonOptions::default() };
            let options = Options {
                seed: Some(seed),
                spectra: Spectra::Uniform(20),
                renderer: renderers::render::Renderer::PhotonMap,
                ..options(photons, 48)
            };
            let t = std::time::Instant::now();
            let r = renderers::render::render(&scene, &options, &|_| {}).unwrap();
            println!("{:.2} s keys {}", t.elapsed().as_secs_f64(), r.photons.as_ref().unwrap().keys.len());
            r.picture
        };
        let [interpolated, traced] = [Rethrow::Interpolated, Rethrow::Traced].map(|rethrow| picture(rethrow, 1));
        let other = picture(Rethrow::Traced, 2);
        let difference = |a: &renderers::image::Picture, b: &renderers::image::Picture| {
            let squares = a
                .pixels()
                .iter()
                .zip(b.pixels())
                .map(|(a, b)| (0..3).map(|c| f64::from(a[c] - b[c]).powi(2)).sum::<f64>());
            squares.sum::<f64>().sqrt()
        };
        println!("{name}: {} against noise {}", difference(&interpolated, &traced), difference(&traced, &other));
    }
}

/// Closed forms at ten wavelengths: where a prism's light falls on a wall, and how much of it; red is turned least.
#[test]
fn a_prisms_light_is_where_its_closed_form_says() {
    const RADIUS: f64 = 0.02;
    let bench = Bench::new();
    let Receiver { centre, half, .. } = bench.receiver;
    let mut before = f64::NEG_INFINITY;
    for from in (0..10).map(|k| 410.0 + 30.0 * f64::from(k)) {
        let to = from + 10.0;
        let scene = bench.scene(&format!("{}:0, {from}:1, {to}:1, {}:0", from - 1e-6, to + 1e-6));
        let prism = bench.prism(f64::midpoint(from, to));
        let [high, low] = SLIT.map(|entry| bench.height(prism, entry) - centre.y);
        // Where the bin's ends would be.
        let [red, violet] =
            [bench.height(bench.prism(to), SLIT[0]) - centre.y, bench.height(bench.prism(from), SLIT[1]) - centre.y];
        let expected =
            1.44 * (SLIT[1] - SLIT[0]) * bench.incidence.cos() * prism.ray(1.0, bench.incidence).unwrap().share;
        let unit: f64 = (0..=100)
            .map(|k| {
                let w = from + f64::from(k) / 10.0;
                let end = if k == 0 || k == 100 { 0.05 } else { 0.1 };
                end * Observer::<f64>::cie_1931_2deg().value(w).iter().sum::<f64>() / Y_INTEGRAL
            })
            .sum();
        for seed in 0..2 {
            let photons = PhotonOptions {
                count: PhotonCount::Count(10_000),
                radius: Some(RADIUS),
                nearest: 1000,
                adaptive: false,
                ..PhotonOptions::default()
            };
            let (map, report) = bench
                .receiver
                .caustics(&scene, &Options { spectra: Spectra::Uniform(40), seed: Some(seed), ..options(photons, 64) })
                .unwrap();
            let flux = map.flux().iter().sum::<f64>() / unit;
            let middle =
                (0..3).map(|c| map.centroid(c)[0] * map.flux()[c]).sum::<f64>() / map.flux().iter().sum::<f64>();
            let profile: Vec<f64> = map.profile(&(-half..half)).iter().map(|p| p.iter().sum()).collect();
            let most = profile.iter().copied().fold(0.0, f64::max);
            let lit: Vec<usize> = (0..64).filter(|k| profile[*k] > 0.05 * most).collect();
            println!(
                "{from}: {:+.3} % centroid {middle:.4} expected {:.4}; extent {:.3} {:.3} expected {violet:.3} {red:.3} bands {} keys {}",
                100.0 * (flux / expected - 1.0),
                f64::midpoint(high, low),
                map.place(lit[0] as f64),
                map.place(lit[lit.len() - 1] as f64 + 1.0),
                report.bands.len(),
                report.keys.len()
            );
        }
        assert!(f64::midpoint(high, low) > before);
        before = f64::midpoint(high, low);
    }
}
