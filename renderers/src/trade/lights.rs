//! Light samples and rays in a pixel: direct light with exact visibility against light found by shadow rays.

use alloc::rc::Rc;

use super::penumbra;
use super::plan::{Plan, Run, Setting, count64, rms_and_worst, timed};
use crate::image::Picture;
use crate::render::{Options, Renderer, Spectra, render};
use crate::scene::{Integrator, Scene, builtin};
use spectral_core::colour::rgb::linear_rgb_to_xyz;

/// Pixels along a side and camera rays of the picture that stands for truth.
const FULL: (u32, u32) = (96, 4096);
const QUICK: (u32, u32) = (32, 1024);

/// For each pixel its luminance, and whether it counts.
type Truth = Vec<(f64, bool)>;

/// All tasks.
pub(super) fn plans(quick: bool) -> Vec<Plan> {
    let (side, rays) = if quick { QUICK } else { FULL };
    let picture = Plan {
        name: "picture",
        title: format!(
            "direct light in the Cornell box, {side} × {side} pixels, edges and penumbrae included, the lamp itself left out"
        ),
        error: "error of luminance, RMS over the mean",
        operations: "rays",
        truth: format!("exact visibility with {rays} camera rays a pixel and other random numbers"),
        floor: 1e-3,
        rounds: if quick { 3 } else { 7 },
        weight: if quick { 4.0 } else { 110.0 },
        build: Box::new(move || {
            let mut scene = builtin::load(builtin::DEFAULT, &[]).map_err(|e| e.to_string())?;
            let truth = luminances(&image(&scene, side, &options(rays, Renderer::Whitted, 977))?.0);
            scene.integrator = Integrator::Path { max_depth: Some(1), rr_depth: 5 };
            // Paths of one segment see lamps alone.
            let lamps = luminances(&image(&scene, side, &options(256, Renderer::Path, 977))?.0);
            let truth = Rc::new(truth.iter().copied().zip(without_lamps(&lamps, side)).collect::<Vec<_>>());
            scene.integrator = Integrator::Path { max_depth: Some(2), rr_depth: 5 };
            let scene = Rc::new(scene);
            let mut all = Vec::new();
            let counts: &[u32] = if quick { &[1, 4, 16] } else { &[1, 2, 4, 8, 16, 64, 256] };
            for &spp in counts {
                let name = format!("whitted --spp {spp}");
                all.push(setting(name, "exact visibility", true, (Renderer::Whitted, spp), side, (&scene, &truth)));
            }
            let counts: &[u32] = if quick { &[1, 16, 64] } else { &[1, 4, 16, 64, 256, 1024] };
            for &spp in counts {
                let name = format!("path --spp {spp}, max_depth 2");
                all.push(setting(name, "shadow rays", false, (Renderer::Path, spp), side, (&scene, &truth)));
            }
            Ok(all)
        }),
    };
    let mut all = vec![penumbra::plan(quick)];
    all.push(picture);
    all
}

fn options(samples: u32, renderer: Renderer, seed: u64) -> Options {
    Options { renderer, spectra: Spectra::Uniform(8), samples: Some(samples), seed: Some(seed), ..Options::default() }
}

fn image(scene: &Scene, side: u32, options: &Options) -> Result<(Picture, u64), String> {
    let found = render(scene, &Options { size: Some([side; 2]), ..*options }, &|_| {}).map_err(|e| e.to_string())?;
    Ok((found.picture, found.rays))
}

fn luminances(picture: &Picture) -> Vec<f64> {
    picture.pixels().iter().map(|rgb| linear_rgb_to_xyz(rgb.map(f64::from))[1]).collect()
}

fn setting(
    name: String,
    method: &'static str,
    own: bool,
    (renderer, samples): (Renderer, u32),
    side: u32,
    (scene, truth): (&Rc<Scene>, &Rc<Truth>),
) -> Setting {
    let (scene, truth) = (Rc::clone(scene), Rc::clone(truth));
    Setting::new(name, method, own, move |round| {
        let (found, seconds) = timed(|| image(&scene, side, &options(samples, renderer, round)));
        let (picture, rays) = found?;
        let judged = || truth.iter().filter(|(_, counts)| *counts);
        let mean = judged().map(|(y, _)| y).sum::<f64>() / super::plan::count(judged().count());
        let pairs = luminances(&picture).into_iter().zip(truth.iter()).filter(|(_, (_, counts))| *counts);
        let [error, worst] = rms_and_worst(pairs.map(|(found, (truth, _))| (found - truth) / mean));
        Ok(Run { seconds, operations: count64(rays), error, worst })
    })
}

/// Pixels that see no lamp, nor a neighbour that does: a lamp is so bright that its edge would be all that counts.
fn without_lamps(lamps: &[f64], side: u32) -> Vec<bool> {
    let side = side as usize;
    let sees = |x: usize, y: usize| lamps.get(y * side + x).is_some_and(|y| *y > 0.0);
    let near = |at: usize| at.saturating_sub(1)..=(at + 1).min(side - 1);
    let place = |n: usize| !near(n / side).any(|y| near(n % side).any(|x| sees(x, y)));
    (0..lamps.len()).map(place).collect()
}
