//! Writes the four pictures of figure 8 into a folder, `out` unless told, and prints the price of the bilinear product.

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

use spectral_core::bilinear::Tensor;
use spectral_gpu::instructions::{count, extra, vector_instructions};
use spectral_gpu::model::Scene;
use spectral_gpu::picture::Picture;
use spectral_gpu::renderer::{Fragment, Gpu, Pass};
use spectral_gpu::shader::{self, Product};

/// Without red, as far as a lamp can be.
const CYAN: [f32; 3] = [0.1, 0.9, 1.0];
const WHITE: [f32; 3] = [1.0; 3];
/// Width and height of the pictures, as in the paper, in pixels.
const SIZE: u16 = 400;
const FRAMES: u32 = 40;
const ROUNDS: usize = 9;

fn main() -> ExitCode {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "out".into());
    match run(Path::new(&folder)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(folder: &Path) -> Result<(), Box<dyn Error>> {
    let gpu = Gpu::new()?;
    println!("device: {}", gpu.name());
    std::fs::create_dir_all(folder)?;
    let (classical, bilinear) = (Product::Classical, Product::Bilinear(Tensor::iso_rgb()));
    let pictures = [
        ("a-classical", classical, CYAN),
        ("b-bilinear", bilinear, CYAN),
        ("c-difference", Product::Difference(Tensor::iso_rgb()), CYAN),
        ("d-white", classical, WHITE),
    ];
    for (name, product, light) in pictures {
        let mut picture = Picture::halved(&gpu.render(&pass(&gpu, &product, light, 2 * SIZE)?)?, SIZE.into());
        if !matches!(product, Product::Difference(_)) {
            picture.show_colour(light);
        }
        let path = folder.join(format!("{name}.png"));
        picture.write_png(&path)?;
        println!("{}", path.display());
    }
    print_instructions(&classical, &bilinear)?;
    print_times(&gpu, &classical, &bilinear)
}

fn pass(gpu: &Gpu, product: &Product, light: [f32; 3], size: u16) -> Result<Pass, Box<dyn Error>> {
    let text = shader::sphere(product)?;
    Ok(gpu.prepare(Fragment::Wgsl(&text), Some(Scene::new(size, light).uniforms().as_flattened()), size)?)
}

fn print_instructions(classical: &Product, bilinear: &Product) -> Result<(), Box<dyn Error>> {
    let (less, more) = (shader::sphere(classical)?, shader::sphere(bilinear)?);
    let extra = extra(&count(Fragment::Wgsl(&more))?, &count(Fragment::Wgsl(&less))?);
    let vectors: usize = extra.iter().map(|(name, n)| n * vector_instructions(name)).sum();
    let spirv: usize = extra.values().sum();
    println!("extra instructions: {vectors} on vectors; {spirv} of unoptimised SPIR-V {extra:?}");
    Ok(())
}

/// The shortest of several rounds for each product, taken in turns so that both see the same disturbances.
fn print_times(gpu: &Gpu, classical: &Product, bilinear: &Product) -> Result<(), Box<dyn Error>> {
    let passes = [pass(gpu, classical, CYAN, SIZE)?, pass(gpu, bilinear, CYAN, SIZE)?];
    let mut best = [Duration::MAX; 2];
    for _ in 0..ROUNDS {
        for (best, pass) in best.iter_mut().zip(&passes) {
            *best = gpu.frame_time(pass, FRAMES)?.min(*best);
        }
    }
    let [classical, bilinear] = best.map(|time| time.as_secs_f64());
    let percent = 100.0 * (bilinear / classical - 1.0);
    println!("{SIZE} × {SIZE}: {:.0} and {:.0} pictures a second ({percent:+.1} %)", 1.0 / classical, 1.0 / bilinear);
    Ok(())
}
