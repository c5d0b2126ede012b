//! Light between surfaces: radiosity by its accuracy, against a finer solution; and whole pictures of it against many paths.

use alloc::rc::Rc;

use disk_sampling::Receiver;

use super::global;
use super::plan::{Plan, Run, Setting, count, rms_and_worst, timed};
use super::products::scene_under;
use crate::geometry::sampling::SobolSequence;
use crate::radiosity::{Flat, Radiosity, Settings};
use crate::scene::glam::DVec3;
use crate::scene::{Scene, Source, load};
use crate::spectral::{FactorOrder, Palette, Radiance, UniformBins};
use crate::whitted::{Whitted, Worker, receiver};

/// All tasks.
pub(super) fn plans(quick: bool) -> Vec<Plan> {
    let mut all = vec![
        plan("box", "indirect irradiance at places that the camera sees in the Cornell box", quick, || {
            scene_under("cornell-box", None)
        }),
        plan(
            "cube",
            "indirect irradiance in a closed cube, reflectance 0.8, a point light off its middle",
            quick,
            cube,
        ),
    ];
    all.extend(global::plans(quick));
    all
}

/// How accurate the solution is that stands for truth, of the box and of the cube, in the whole and in the quick account.
const FINE: [[f64; 2]; 2] = [[1e-3, 5e-3], [1e-4, 1e-3]];

fn plan(name: &'static str, title: &str, quick: bool, scene: impl FnOnce() -> Result<Scene, String> + 'static) -> Plan {
    let is_box = name == "box";
    let fine = FINE[usize::from(!is_box)][usize::from(quick)];
    Plan {
        name,
        title: title.to_owned(),
        error: "relative error, RMS",
        operations: "links and their transports",
        truth: format!("the same by --accuracy {fine}, whose own error is of that order"),
        floor: fine,
        rounds: if quick { 2 } else { 3 },
        weight: if quick { 6.0 } else { 120.0 },
        build: Box::new(move || {
            let scene = Rc::new(scene()?);
            let places = Rc::new(places(&scene)?);
            let truth = solve(&scene, &places, fine)?.0;
            let mean = truth.iter().sum::<f64>() / count(truth.len());
            let truth = Rc::new(truth);
            let accuracies: &[f64] =
                if quick { &[0.5, 0.2, 0.05] } else { &[0.5, 0.3, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005] };
            let setting = |accuracy: &f64| {
                let (scene, places, truth, accuracy) =
                    (Rc::clone(&scene), Rc::clone(&places), Rc::clone(&truth), *accuracy);
                Setting::new(format!("--accuracy {accuracy}"), "radiosity", true, move |_| {
                    let (found, seconds, operations) = solve(&scene, &places, accuracy)?;
                    // Places behind walls have none.
                    let lit = found.iter().zip(truth.iter()).filter(|(_, t)| **t > 1e-2 * mean);
                    let [error, worst] = rms_and_worst(lit.map(|(f, t)| f / t - 1.0));
                    Ok(Run { seconds, operations, error, worst })
                })
            };
            Ok(accuracies.iter().map(setting).collect())
        }),
    }
}

/// A cube with sides of 2 around the origin.
fn cube() -> Result<Scene, String> {
    let turns = [("x", 0), ("x", 180), ("x", 90), ("x", -90), ("y", 90), ("y", -90)];
    let face = |(axis, angle): (&str, i32)| {
        format!(
            "<shape type='rectangle'><transform name='to_world'><translate z='-1'/><rotate {axis}='1' angle='{angle}'/></transform>
            <bsdf type='diffuse'><spectrum name='reflectance' value='0.8'/></bsdf></shape>"
        )
    };
    let faces: String = turns.into_iter().map(face).collect();
    let xml = format!(
        "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='110'/>
        <transform name='to_world'><lookat origin='-0.9 -0.8 -0.7' target='0.3 0.2 0.1' up='0 0 1'/></transform></sensor>{faces}
        <emitter type='point'><point name='position' x='0.3' y='0.2' z='0.4'/>
        <spectrum name='intensity' value='1'/></emitter></scene>"
    );
    load(&Source::text("cube.xml", xml), &[]).map_err(|e| e.to_string())
}

/// Places on surfaces that the camera sees, on a grid over the picture.
fn places(scene: &Scene) -> Result<Vec<Receiver<f64>>, String> {
    const SIDE: u32 = 16;
    let mut palette = Palette::default();
    let whitted = Whitted::new(scene, [SIDE; 2], &mut palette).map_err(|e| e.to_string())?;
    let mut worker = Worker::new(&whitted, FactorOrder::Free).noting();
    for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
        worker.start_pixel(SobolSequence::for_pixel(x, y, 0));
        worker.sample(f64::from(x) + 0.5, f64::from(y) + 0.5, 1.0, &mut Radiance::default());
    }
    let place = |hit: &_| {
        let at = receiver(hit);
        let [position, normal]: [DVec3; 2] = [at.position, at.normal];
        Receiver::new(position.to_array(), normal.to_array()).map_err(|e| e.to_string())
    };
    worker.into_noted().iter().map(place).collect()
}

/// Irradiance at the places, time, and counted work: links made, and carried over once for each step and component.
fn solve(scene: &Scene, places: &[Receiver<f64>], accuracy: f64) -> Result<(Vec<f64>, f64, f64), String> {
    let (found, seconds) = timed(|| {
        let mut palette = Palette::default();
        let settings = Settings { accuracy, ..Settings::default() };
        let radiosity = Radiosity::new(scene, &settings, &mut palette, &|_| {}).map_err(|e| e.to_string())?;
        let is_grey = palette.leaves().len() <= 1;
        let bins = UniformBins::new(&palette, 8)?;
        let solution = if is_grey { radiosity.solve(&Flat) } else { radiosity.solve(&bins) };
        let solution = solution.map_err(|e| e.to_string())?;
        let report = solution.report();
        let operations = count(report.links) * (1.0 + count(report.passes));
        let irradiance = |place: &Receiver<f64>| {
            let row = solution.indirect(place);
            row.iter().sum::<f64>() / count(row.len())
        };
        Ok::<_, String>((places.iter().map(irradiance).collect::<Vec<f64>>(), operations))
    });
    let (irradiances, operations) = found?;
    Ok((irradiances, seconds, operations))
}
