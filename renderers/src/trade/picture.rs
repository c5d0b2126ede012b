//! Whole pictures by each representation of spectra: with rays, and with glass that bends light by its wavelength.

use alloc::rc::Rc;

use super::plan::{Plan, Run, Setting, count64, mean_and_worst};
use super::spectra::{naming, representations};
use crate::image::Picture;
use crate::render::{Options, Spectra, render};
use crate::scene::{Scene, builtin};
use spectral_core::colour::rgb::{WHITE, linear_rgb_to_xyz};
use spectral_core::colour::{delta_e_ab, xyz_to_lab};

/// The bins of the picture that stands for truth, which is between 401 bins and infinitely many.
const FINE: [usize; 2] = [1600, 801];

/// Pictures of a scene without, and of one with dispersion.
pub(super) fn plans(quick: bool) -> Vec<Plan> {
    let tasks: [(&'static str, &'static str, [u32; 2]); 2] =
        [("picture", "cornell-box", [256, 64]), ("dispersion", "cornell-box-spheres", [256, 64])];
    let plan = |(name, scene, sides): (&'static str, &'static str, [u32; 2])| {
        let (side, fine) = (sides[usize::from(quick)], FINE[usize::from(quick)]);
        Plan {
            name,
            title: format!("whole pictures of {scene}, {side} × {side} pixels, one ray each, preparation included"),
            error: "mean ΔE*ab",
            operations: "rays",
            truth: format!("uniform:{fine} with the same rays; its own error is below 0.0003"),
            floor: if quick { 3e-4 } else { 1e-4 },
            rounds: if quick { 3 } else { 7 },
            weight: if quick { 4.0 } else { 110.0 },
            build: Box::new(move || {
                let scene = Rc::new(builtin::load(scene, &[]).map_err(|e| e.to_string())?);
                let truth = Rc::new(picture(&scene, side, Spectra::Uniform(fine))?.1);
                let setting = |spectra: &Spectra| setting(*spectra, side, &scene, &truth);
                Ok(representations(quick).iter().map(setting).collect())
            }),
        }
    };
    tasks.into_iter().map(plan).collect()
}

fn picture(scene: &Scene, side: u32, spectra: Spectra) -> Result<(f64, Picture, u64), String> {
    let options = Options { spectra, size: Some([side; 2]), samples: Some(1), ..Options::default() };
    let found = render(scene, &options, &|_| {}).map_err(|e| e.to_string())?;
    Ok((found.seconds + found.preparation_seconds, found.picture, found.rays))
}

fn setting(spectra: Spectra, side: u32, scene: &Rc<Scene>, truth: &Rc<Picture>) -> Setting {
    let (name, method, own) = naming(spectra);
    let (scene, truth) = (Rc::clone(scene), Rc::clone(truth));
    Setting::new(name, method, own, move |_| {
        let (seconds, picture, rays) = picture(&scene, side, spectra)?;
        let lab = |rgb: &[f32; 3]| xyz_to_lab(linear_rgb_to_xyz(rgb.map(f64::from)), WHITE);
        let pairs = picture.pixels().iter().zip(truth.pixels());
        let [error, worst] = mean_and_worst(pairs.map(|(a, b)| delta_e_ab(lab(a), lab(b))));
        Ok(Run { seconds, operations: count64(rays), error, worst })
    })
}
