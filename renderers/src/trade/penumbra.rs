//! A penumbra: illuminance behind a straight edge, by the part of the light that is seen and by shadow rays.

use alloc::rc::Rc;
use core::f64::consts::PI;

use super::plan::{Plan, Random, Run, Setting, count, count64, rms_and_worst, timed_items};
use crate::illuminance::{Meter, Settings};
use crate::path::PathTracer;
use crate::scene::glam::DVec3;
use crate::scene::{Scene, Source, load};
use crate::spectral::{Palette, Y_INTEGRAL};
use crate::verify::oracle::parallel_rectangle;
use spectral_core::action::MAXIMUM_LUMINOUS_EFFICACY;

/// Height of the square light of side 1, and of the screen half way.
const HEIGHT: f64 = 3.0;
const PLACES: u32 = 64;

/// How shadow rays are placed on the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Placing {
    Random,
    Stratified,
}

/// The task.
pub(super) fn plan(quick: bool) -> Plan {
    Plan {
        name: "penumbra",
        title: "illuminance across the penumbra of a straight edge, 64 places".to_owned(),
        error: "error over the mean, RMS",
        operations: "rays and cut polygons",
        truth: "closed form of the part of the rectangle that is seen".to_owned(),
        floor: 1e-12,
        rounds: if quick { 3 } else { 9 },
        weight: if quick { 2.0 } else { 20.0 },
        build: Box::new(move || {
            let scene = Rc::new(scene()?);
            let places: Rc<Vec<(DVec3, f64)>> = Rc::new((0..PLACES).map(place).collect());
            let mut all = Vec::new();
            let accuracies: &[f64] = if quick { &[1e-3] } else { &[1e-1, 1e-3, 1e-5] };
            for accuracy in accuracies {
                all.push(exact(*accuracy, &scene, &places));
            }
            let sides: &[u32] = if quick { &[2, 8] } else { &[1, 2, 4, 8, 16, 32, 64] };
            for (placing, name) in
                [(Placing::Random, "random shadow rays"), (Placing::Stratified, "stratified shadow rays")]
            {
                for side in sides {
                    all.push(shadow_rays(name, placing, *side, &scene, &places));
                }
            }
            Ok(all)
        }),
    }
}

/// A place on the floor, and its configuration factor to the part of the light that it sees: the screen hides what is at x beyond −x.
fn place(index: u32) -> (DVec3, f64) {
    let x = -0.49 + 0.98 * (f64::from(index) + 0.37) / f64::from(PLACES);
    let y = 0.1;
    (DVec3::new(x, y, 0.0), parallel_rectangle([-0.5 - x, -x - x], [-0.5 - y, 0.5 - y], HEIGHT))
}

fn scene() -> Result<Scene, String> {
    let xml = format!(
        "<scene version='3.0.0'><integrator type='direct'/><sensor type='perspective'><float name='fov' value='40'/></sensor>
        <shape type='rectangle'><transform name='to_world'><scale value='5'/></transform>
        <bsdf type='diffuse'><spectrum name='reflectance' value='0.5'/></bsdf></shape>
        <shape type='rectangle'><transform name='to_world'><scale value='2'/><translate x='2' z='{}'/></transform>
        <bsdf type='twosided'><bsdf type='diffuse'><spectrum name='reflectance' value='0.5'/></bsdf></bsdf></shape>
        <shape type='rectangle'><transform name='to_world'><scale value='0.5'/><rotate x='1' angle='180'/><translate z='{HEIGHT}'/></transform>
        <emitter type='area'><spectrum name='radiance' value='1'/></emitter></shape></scene>",
        HEIGHT / 2.0
    );
    load(&Source::text("penumbra.xml", xml), &[]).map_err(|e| e.to_string())
}

/// Errors relative to the mean: in the dark end of a penumbra nothing else means much.
fn judged(found: &[f64], places: &[(DVec3, f64)], seconds: f64, operations: f64) -> Run {
    let all = count(places.len());
    let mean = places.iter().map(|(_, truth)| truth).sum::<f64>() / all;
    let [error, worst] = rms_and_worst(found.iter().zip(places).map(|(f, (_, truth))| (f - truth) / mean));
    Run { seconds: seconds / all, operations: operations / all, error, worst }
}

fn exact(accuracy: f64, scene: &Rc<Scene>, places: &Rc<Vec<(DVec3, f64)>>) -> Setting {
    let (scene, places) = (Rc::clone(scene), Rc::clone(places));
    Setting::new(format!("illuminance, accuracy {accuracy}"), "exact visibility", true, move |_| {
        let meter = Meter::new(&scene, Settings { accuracy }, None).map_err(|e| e.to_string())?;
        let (found, seconds) = timed_items(&places, 8, || (), |(), (place, _)| meter.read(*place, DVec3::Z));
        let found = found.into_iter().collect::<Result<Vec<_>, _>>().map_err(|e| e.to_string())?;
        // One polygon is cut for each place, where no rays are needed.
        let rays: u64 = found.iter().map(|reading| reading.samples + 1).sum();
        let unit = MAXIMUM_LUMINOUS_EFFICACY * Y_INTEGRAL * PI;
        let factors: Vec<f64> = found.iter().map(|reading| reading.direct_lux / unit).collect();
        Ok(judged(&factors, &places, seconds, count64(rays)))
    })
}

fn shadow_rays(
    name: &'static str,
    placing: Placing,
    side: u32,
    scene: &Rc<Scene>,
    places: &Rc<Vec<(DVec3, f64)>>,
) -> Setting {
    let (scene, places) = (Rc::clone(scene), Rc::clone(places));
    let rays = side * side;
    Setting::new(format!("{rays} {name}"), name, false, move |round| {
        let mut palette = Palette::default();
        let tracer = PathTracer::new(&scene, [16; 2], &mut palette).map_err(|e| e.to_string())?;
        let mut random = Random::new(u64::from(rays) << 1 | u64::from(placing == Placing::Random), round);
        let chunk = (512 / rays as usize).clamp(1, 16);
        let (found, seconds) = timed_items(
            &places,
            chunk,
            || (),
            |(), (place, _)| {
                let probe = tracer.probe(*place + DVec3::Z * 0.1, -DVec3::Z)?;
                let ray = |k: u32| {
                    let jitter = [random.unit(), random.unit()];
                    let u = match placing {
                        Placing::Random => jitter,
                        Placing::Stratified => {
                            let at = |cell: u32, part: f64| (f64::from(cell) + part) / f64::from(side);
                            [at(k % side, jitter[0]), at(k / side, jitter[1])]
                        }
                    };
                    probe.sample_light(0.5, u.map(single)).map_or(0.0, |s| s.weight * s.direction.z)
                };
                Some((0..rays).map(ray).sum::<f64>() / f64::from(rays) / PI)
            },
        );
        let found: Option<Vec<f64>> = found.into_iter().collect();
        let found = found.ok_or("a place is not on the floor")?;
        Ok(judged(&found, &places, seconds, f64::from(rays) * count(places.len())))
    })
}

#[allow(clippy::cast_possible_truncation, reason = "random numbers for f32")]
fn single(value: f64) -> f32 {
    (value as f32).min(1.0 - f32::EPSILON)
}
