//! Makes reference pictures: caustics seen directly by light tracing, and with `--samples` all other light by path tracing on top.
//!
//! `cargo run --release -p spectral-tests --bin caustic_truth -- SCENE OUT.exr [--size WxH] [--seconds S] [--samples N] [--bins N] [--seed N]`
//!
//! SCENE is a file or the name of a built-in scene. Without `--samples` the picture has the paths L S⁺ D E alone: light of surfaces, points
//! and parallel light that comes by way of mirrors and smooth glass to a diffuse surface that is seen directly. With it, the same
//! scene without these paths is path-traced with so many samples a pixel and so many bins of the spectrum (80), and the sum is written: the
//! whole, but for what path tracing can't find of lights without area. Linear Rec. 709, Y = ∫Lȳ / ∫ȳ over 380–780 nm; the channels
//! `variance.R` … `variance.Y` have the variance of each pixel.

use core::time::Duration;
use std::io::Write;
use std::path::Path;
use std::time::Instant;

use renderers::image::{Raster, write_exr};
use renderers::path::{self, Paths, Run};
use renderers::render::{Options, Renderer, Spectra, Variance};
use renderers::scene::{self, Scene, Source, builtin};
use spectral_tests::light_tracing::{Aim, Balance, Film, LightTracer, PARTICLES};

type Error = Box<dyn core::error::Error>;

const USAGE: &str = "usage: caustic_truth SCENE OUT.exr [--size WxH] [--seconds S] [--samples N] [--bins N] [--seed N]";

struct Arguments {
    scene: String,
    out: String,
    size: Option<[u32; 2]>,
    seconds: f64,
    samples: Option<u32>,
    bins: usize,
    seed: u64,
}

impl Arguments {
    fn parse(mut words: impl Iterator<Item = String>) -> Result<Self, Error> {
        let (Some(scene), Some(out)) = (words.next(), words.next()) else { return Err(USAGE.into()) };
        let mut found = Self { scene, out, size: None, seconds: 60.0, samples: None, bins: 80, seed: 1 };
        while let Some(option) = words.next() {
            let value = words.next().ok_or(USAGE)?;
            match option.as_str() {
                "--size" => {
                    let (width, height) = value.split_once('x').ok_or(USAGE)?;
                    found.size = Some([width.parse()?, height.parse()?]);
                }
                "--seconds" => found.seconds = value.parse()?,
                "--samples" => found.samples = Some(value.parse()?),
                "--bins" => found.bins = value.parse()?,
                "--seed" => found.seed = value.parse()?,
                _ => return Err(USAGE.into()),
            }
        }
        Ok(found)
    }

    fn scene(&self) -> Result<Scene, Error> {
        if builtin::source(&self.scene).is_some() {
            return Ok(builtin::load(&self.scene, &[])?);
        }
        Ok(scene::load(&Source::disk(&self.scene), &[])?)
    }
}

/// The picture of caustics with its variance.
fn caustics(scene: &Scene, size: [u32; 2], arguments: &Arguments) -> Result<(Raster<[f64; 3]>, Variance), Error> {
    let tracer = LightTracer::new(scene, Aim::Specular)?;
    let mut film = Film::new(&tracer, size, arguments.seed)?;
    let (start, limit) = (Instant::now(), Duration::try_from_secs_f64(arguments.seconds)?);
    let mut balance = Balance::default();
    while film.batches() < 2 || start.elapsed() < limit {
        balance = balance.plus(film.add(2 * rayon::current_num_threads() as u64)?);
    }
    let seconds = start.elapsed().as_secs_f64();
    #[allow(clippy::cast_precision_loss, reason = "for a message")]
    let particles = (film.batches() * u64::from(PARTICLES)) as f64;
    let [caustic, gap] = [balance.caustic / balance.emitted, balance.gap()];
    writeln!(
        std::io::stderr(),
        "{particles:.3e} particles in {seconds:.1} s, {:.3e} a second; caustics have {:.2} % of the flux aimed, the balance closes to {gap:.1e}",
        particles / seconds,
        100.0 * caustic
    )?;
    Ok(film.picture()?)
}

/// Adds all other light.
fn add_rest(
    picture: &mut Raster<[f64; 3]>,
    variance: &mut Variance,
    scene: &Scene,
    options: &Options,
) -> Result<(), Error> {
    let run = Run { paths: Paths::WithoutCaustics, ..Run::default() };
    let rest = path::render(scene, options, run, &|_| {})?;
    writeln!(std::io::stderr(), "all other light in {:.1} s", rest.seconds)?;
    let noise = rest.variance.ok_or("two samples a pixel at least")?;
    for (sum, part) in picture.pixels_mut().iter_mut().zip(rest.picture.pixels()) {
        *sum = core::array::from_fn(|c| sum[c] + f64::from(part[c]));
    }
    for (sum, part) in variance.rgb.pixels_mut().iter_mut().zip(noise.rgb.pixels()) {
        *sum = core::array::from_fn(|c| sum[c] + part[c]);
    }
    for (sum, part) in variance.luminance.pixels_mut().iter_mut().zip(noise.luminance.pixels()) {
        *sum += part;
    }
    Ok(())
}

fn main() -> Result<(), Error> {
    let arguments = Arguments::parse(std::env::args().skip(1))?;
    let scene = arguments.scene()?;
    let size = arguments.size.unwrap_or([scene.film.width, scene.film.height]);
    let (mut picture, mut variance) = caustics(&scene, size, &arguments)?;
    if let Some(samples) = arguments.samples {
        let options = Options {
            renderer: Renderer::Path,
            spectra: Spectra::Uniform(arguments.bins),
            size: Some(size),
            samples: Some(samples),
            seed: Some(arguments.seed),
            ..Options::default()
        };
        add_rest(&mut picture, &mut variance, &scene, &options)?;
    }
    #[allow(clippy::cast_possible_truncation, reason = "pictures are f32")]
    let single = picture.map(|rgb| rgb.map(|c| c as f32));
    let [r, g, b] = [0, 1, 2].map(|c: usize| variance.rgb.map(|rgb| rgb[c]));
    let channels = [("variance.R", &r), ("variance.G", &g), ("variance.B", &b), ("variance.Y", &variance.luminance)];
    write_exr(Path::new(&arguments.out), &single, &channels, &[])?;
    Ok(())
}
