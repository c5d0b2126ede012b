//! Pictures with all light between surfaces: radiosity, gathers and paths, against very many paths.

use alloc::rc::Rc;

use super::plan::{Plan, Run, Setting, count, count64};
use crate::compare::{CompareOptions, difference};
use crate::image::Picture;
use crate::render::{
    Between, BetweenOptions, GatherOptions, Options, PhotonOptions, Renderer, Rendering, Spectra, render,
};
use crate::scene::{Scene, builtin};

/// Pixels along a side, and paths in a pixel of the picture that stands for truth.
const FULL: (u32, u32) = (64, 16_384);
const QUICK: (u32, u32) = (24, 4096);

/// The Cornell box with all interreflections.
pub(super) fn plans(quick: bool) -> Vec<Plan> {
    let (side, paths) = if quick { QUICK } else { FULL };
    let plan = Plan {
        name: "picture",
        title: format!("the Cornell box with all interreflections, {side} × {side} pixels, 24 bins"),
        error: "mean ΔE00",
        operations: "rays, and links carried over",
        truth: format!(
            "{paths} paths a pixel with other random numbers: its own mean ΔE00 is that of the most paths shown, times the root of the \
             ratio of their numbers"
        ),
        floor: 0.05,
        rounds: if quick { 2 } else { 5 },
        weight: if quick { 10.0 } else { 300.0 },
        build: Box::new(move || {
            let scene = Rc::new(all_light()?);
            let seeded = Options { seed: Some(977), ..path(paths) };
            let truth = Rc::new(picture(&scene, side, &seeded)?.picture);
            let mut all = Vec::new();
            let accuracies: &[f64] = if quick { &[0.1] } else { &[0.3, 0.1, 0.05, 0.02] };
            for accuracy in accuracies {
                let between = BetweenOptions { accuracy: *accuracy, exact: false };
                let samples: &[u32] = if quick { &[1, 16] } else { &[1, 4, 16, 64] };
                for spp in samples {
                    let options = Options { renderer: Renderer::Radiosity, between, ..with(*spp) };
                    let name = format!("radiosity --accuracy {accuracy} --spp {spp}");
                    all.push(setting(name, "radiosity", true, options, side, (&scene, &truth)));
                }
            }
            let rays: &[u32] = if quick { &[64] } else { &[64, 256, 1024] };
            for rays in rays {
                let photons = PhotonOptions { between: Between::Gather, ..PhotonOptions::default() };
                let gather = GatherOptions { rays: *rays, ..GatherOptions::default() };
                let options = Options { renderer: Renderer::PhotonMap, photons, gather, ..with(16) };
                let name = format!("photon-map --between gather --gather-rays {rays} --spp 16");
                all.push(setting(name, "photon map, gathers", true, options, side, (&scene, &truth)));
            }
            let counts: &[u32] = if quick { &[16, 256] } else { &[1, 4, 16, 64, 256, 1024] };
            for spp in counts {
                all.push(setting(format!("path --spp {spp}"), "paths", false, path(*spp), side, (&scene, &truth)));
            }
            Ok(all)
        }),
    };
    vec![plan]
}

/// The Cornell box whose integrator asks for all light.
fn all_light() -> Result<Scene, String> {
    let mut scene = builtin::load(builtin::DEFAULT, &[]).map_err(|e| e.to_string())?;
    scene.integrator = crate::scene::Integrator::Path { max_depth: None, rr_depth: 5 };
    Ok(scene)
}

fn with(samples: u32) -> Options {
    Options { spectra: Spectra::Uniform(24), samples: Some(samples), ..Options::default() }
}

fn path(samples: u32) -> Options {
    Options { renderer: Renderer::Path, ..with(samples) }
}

fn picture(scene: &Scene, side: u32, options: &Options) -> Result<Rendering, String> {
    render(scene, &Options { size: Some([side; 2]), ..*options }, &|_| {}).map_err(|e| e.to_string())
}

fn setting(
    name: String,
    method: &'static str,
    own: bool,
    options: Options,
    side: u32,
    (scene, truth): (&Rc<Scene>, &Rc<Picture>),
) -> Setting {
    let (scene, truth) = (Rc::clone(scene), Rc::clone(truth));
    Setting::new(name, method, own, move |round| {
        let (found, seconds) = super::plan::timed(|| picture(&scene, side, &Options { seed: Some(round), ..options }));
        let found = found?;
        let between = found.between.as_ref().map_or(0.0, |between| {
            count(between.radiosity.links) * (1.0 + count(between.radiosity.passes)) + count(between.gathers)
        });
        let gathered = found
            .gather
            .as_ref()
            .map_or(0.0, |report| count64(report.emitted) + f64::from(options.gather.rays) * count(report.gathers));
        let statistics = difference(&found.picture, &truth, &CompareOptions::default()).map_err(|e| e.to_string())?;
        let statistics = statistics.statistics().delta_e00;
        let operations = count64(found.rays) + between + gathered;
        Ok(Run { seconds, operations, error: statistics.mean, worst: statistics.max })
    })
}
