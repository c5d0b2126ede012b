//! Single against double precision: colours of products, indices of lights, closed forms.

use alloc::rc::Rc;

use disk_sampling::{Disk, Receiver, Sphere, disk_configuration_factor, sphere_configuration_factor};
use spectral_core::adaptive::{Mode, Piece, Target, evaluate};
use spectral_core::colour::rgb::WHITE;
use spectral_core::colour::{delta_e_ab, xyz_to_lab};
use spectral_core::expression::{Op, Program};
use spectral_core::interval::{Domain, Interval, Pyramid, Weight, node_count};
use spectral_core::light::measure_indices;
use spectral_core::spectrum::{Outside, PiecewiseLinear, RadiationConstant};
use spectral_core::summation::SumGrid;
use spectral_core::tables::{fluorescent, high_pressure, illuminants};
use spectral_core::{Observer, Real};

use super::plan::{Plan, Random, Run, Setting, count, mean_and_worst, rms_and_worst, timed_items};
use super::products::{Pixels, lamp};
use crate::spectral::{Tabulated, Y_INTEGRAL};
use crate::verify::oracle;

/// All tasks.
pub(super) fn plans(quick: bool) -> Vec<Plan> {
    let plan = |name, title: &str, error, truth: &str, build| Plan {
        name,
        title: title.to_owned(),
        error,
        operations: "bytes of numbers touched",
        truth: truth.to_owned(),
        floor: 1e-15,
        rounds: if quick { 3 } else { 9 },
        weight: if quick { 1.0 } else { 12.0 },
        build,
    };
    let thresholds: Vec<f64> = if quick { vec![3.0, 0.1] } else { vec![10.0, 3.0, 1.0, 0.3, 0.1, 0.03, 0.01] };
    vec![
        plan(
            "products",
            "FL11 reflected by each patch of the ColorChecker, certified intervals",
            "mean ΔE*ab",
            "integrals of the products, exact but for f64's rounding",
            Box::new(move || products(&thresholds)),
        ),
        plan(
            "indices",
            "R_a of D65, FL2, FL7, FL11 and a sodium lamp, and of the same a third as bright",
            "error of R_a, RMS",
            "the lamp as it is, in f64; f64 itself: what scaling by a third changes, which is rounding alone",
            Box::new(|| Ok(vec![indices::<f32>("f32", 4.0), indices::<f64>("f64", 8.0)])),
        ),
        plan(
            "closed-forms",
            "configuration factors of disks and spheres, 500 random receivers that see all of them",
            "relative error, RMS",
            "contour integral by quadrature, and (r/d)² cos θ; both to about 1e-14",
            Box::new(|| {
                let mut all = vec![disks::<f32>("f32", 4.0), disks::<f64>("f64", 8.0)];
                all.extend([spheres::<f32>("f32", 4.0), spheres::<f64>("f64", 8.0)]);
                Ok(all)
            }),
        ),
    ]
}

/// Depth of the intervals, as in renderers.
const DEPTH: u8 = 8;

/// Spectra on intervals in one precision.
struct Spectra<R: Real> {
    weights: Vec<Weight<R>>,
    nodes: Vec<(Vec<R>, Vec<R>)>,
}

impl<R: Real> Spectra<R> {
    fn new(leaves: &[&Tabulated]) -> Self {
        let cast = |values: &[f64]| values.iter().map(|v| R::from_f64(*v)).collect();
        let nodes = leaves.iter().map(|leaf| (cast(&leaf.wavelengths), cast(&leaf.values))).collect();
        Self { weights: vec![Weight::default(); node_count(DEPTH)], nodes }
    }

    /// Colours of the first spectrum times each of the others.
    fn colours(&mut self, threshold: f64) -> Result<(Vec<[f64; 3]>, usize, f64), String> {
        let domain =
            Domain::build(Observer::<R>::cie_1931_2deg(), DEPTH, &mut self.weights).map_err(|e| e.to_string())?;
        let mut buffers = vec![vec![Interval::zero(); node_count(DEPTH)]; self.nodes.len()];
        let mut pyramids = Vec::new();
        for ((wavelengths, values), buffer) in self.nodes.iter().zip(&mut buffers) {
            let spectrum = PiecewiseLinear::new(wavelengths, values, Outside::Zero).map_err(|e| e.to_string())?;
            pyramids.push(Pyramid::build(&spectrum, &domain, buffer).map_err(|e| e.to_string())?);
        }
        let white = WHITE.map(|w| R::from_f64(w * Y_INTEGRAL));
        let target = Target { mode: Mode::Certified, threshold: R::from_f64(threshold), white };
        let (mut stack, mut pieces) = ([Interval::zero(); 2], vec![Piece::default(); 512]);
        let leaves: Vec<u32> = (1..).take(pyramids.len() - 1).collect();
        let (found, seconds) = timed_items(
            &leaves,
            4,
            || (),
            |(), leaf| {
                let ops = [Op::Leaf(0), Op::Leaf(*leaf), Op::Product];
                let program = Program::new(&ops)?;
                evaluate(&program, &domain, &target, &mut &*pyramids, &mut stack, &mut pieces)
            },
        );
        let found = found.into_iter().collect::<Result<Vec<_>, _>>().map_err(|e| e.to_string())?;
        let evaluated = found.iter().map(|colour| 2 * colour.intervals - 1).sum();
        let found = found.iter().map(|colour| colour.xyz.map(|v| v.to_f64() / Y_INTEGRAL)).collect();
        Ok((found, evaluated, seconds))
    }
}

fn products(thresholds: &[f64]) -> Result<Vec<Setting>, String> {
    let pixels = Rc::new(Patches::new()?);
    let mut all = Vec::new();
    for threshold in thresholds {
        all.push(product::<f32>("f32", 4.0, *threshold, &pixels));
        all.push(product::<f64>("f64", 8.0, *threshold, &pixels));
    }
    all.sort_by_key(|setting| setting.method);
    Ok(all)
}

/// A lamp, the patches, and their colours.
struct Patches {
    leaves: Vec<Tabulated>,
    truth: Vec<[f64; 3]>,
}

impl Patches {
    fn new() -> Result<Self, String> {
        let pixels = Pixels::of_patches(lamp("FL11", 1.0)?, 1, 1)?;
        // The lamp is the first leaf, the patches follow in order. Pixels' weights are taken off again.
        let scale = |radiance: &crate::spectral::Radiance| radiance.terms().first().map_or(1.0, |(_, weight)| *weight);
        let truth = pixels.truth.iter().zip(&pixels.free.1).map(|(xyz, r)| xyz.map(|v| v / scale(r))).collect();
        let leaves = pixels.palette.leaves().iter().map(|(leaf, _)| leaf.clone()).collect();
        Ok(Self { leaves, truth })
    }
}

/// Numbers of an interval with its bounds.
const INTERVAL_NUMBERS: f64 = 15.0;

fn product<R: Real + 'static>(kind: &'static str, bytes: f64, threshold: f64, patches: &Rc<Patches>) -> Setting {
    let patches = Rc::clone(patches);
    let mut spectra = Spectra::<R>::new(&patches.leaves.iter().collect::<Vec<_>>());
    Setting::new(format!("{kind}, threshold {threshold}"), kind, true, move |_| {
        let (found, evaluated, seconds) = spectra.colours(threshold)?;
        let lab = |xyz: [f64; 3]| xyz_to_lab(xyz, WHITE);
        let errors = found.iter().zip(&patches.truth).map(|(f, t)| delta_e_ab(lab(*f), lab(*t)));
        let [error, worst] = mean_and_worst(errors);
        let all = count(found.len());
        let operations = bytes * INTERVAL_NUMBERS * 3.0 * count(evaluated) / all;
        Ok(Run { seconds: seconds / all, operations, error, worst })
    })
}

const GRID: SumGrid<81> = SumGrid::CIE_5NM;

fn indices<R: Real + 'static>(kind: &'static str, bytes: f64) -> Setting {
    const REPEATS: usize = 5;
    Setting::new(kind, kind, true, move |_| {
        let lights = [&illuminants::D65, &fluorescent::FL2, &fluorescent::FL7, &fluorescent::FL11, &high_pressure::HP1];
        let (mut errors, mut seconds) = (Vec::new(), 0.0);
        for table in lights {
            let exact: [f64; 81] = GRID.sample(&table.spectrum(Outside::Zero));
            let truth = index::<f64>(&exact)?;
            for scale in [1.0, 1.0 / 3.0] {
                let light: [R; 81] = exact.map(|v| R::from_f64(v) * R::from_f64(scale));
                let (mut found, taken) = timed_items(&[(); REPEATS], 1, || (), |(), ()| index::<R>(&light));
                seconds += taken / count(REPEATS);
                errors.push(found.pop().ok_or("no index")?? - truth);
            }
        }
        let [error, worst] = rms_and_worst(errors.iter().copied());
        // 81 samples, each with the products of observer and eight samples, for the light and thirteen references.
        let operations = bytes * 81.0 * 27.0 * 14.0;
        Ok(Run { seconds: seconds / count(errors.len()), operations, error, worst })
    })
}

fn index<R: Real>(light: &[R; 81]) -> Result<f64, String> {
    let found = measure_indices(GRID, light, RadiationConstant::Its1990).map_err(|e| e.to_string())?;
    found.ra.map(Real::to_f64).ok_or_else(|| "no reference light".to_owned())
}

/// Receivers that see all of a body around the origin, as positions and normals that are the same in both precisions.
fn receivers(sees: impl Fn([f64; 3], [f64; 3]) -> bool) -> Vec<([f64; 3], [f64; 3])> {
    let mut random = Random::new(2, 0);
    let mut all = Vec::new();
    while all.len() < 500 {
        let mut point = |low: f64, high: f64| [0; 3].map(|_| f64::from(single(random.between(low, high))));
        let (position, normal) = (point(-4.0, 4.0), point(-1.0, 1.0));
        let position = [position[0], position[1], -position[2].abs() - 1.5];
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > 0.1 && sees(position, normal.map(|x| x / length)) {
            all.push((position, normal));
        }
    }
    all
}

#[allow(clippy::cast_possible_truncation, reason = "rounded on purpose")]
const fn single(value: f64) -> f32 {
    value as f32
}

fn disks<R: Real + 'static>(kind: &'static str, bytes: f64) -> Setting {
    let down = [0.0, 0.0, -1.0];
    let all = receivers(|position, normal| oracle::sees_all_of_a_disk([0.0; 3], down, 1.0, position, normal));
    let unit = |normal: [f64; 3]| normal.map(|x| x / normal.iter().map(|x| x * x).sum::<f64>().sqrt());
    let truth: Vec<f64> = all.iter().map(|(p, n)| oracle::disk([0.0; 3], down, 1.0, *p, unit(*n))).collect();
    let name = if kind == "f32" { "disk, f32" } else { "disk, f64" };
    Setting::new(name, name, true, move |_| {
        let disk = Disk::new([R::ZERO; 3], down.map(R::from_f64), R::ONE).map_err(|e| e.to_string())?;
        // A position, a normal, a disk.
        factors(&all, &truth, bytes * 13.0, |receiver| disk_configuration_factor(&disk, receiver))
    })
}

fn spheres<R: Real + 'static>(kind: &'static str, bytes: f64) -> Setting {
    let middle = |position: [f64; 3], normal: [f64; 3]| -(0..3).map(|i| position[i] * normal[i]).sum::<f64>();
    let all = receivers(|position, normal| middle(position, normal) >= 1.0);
    let truth = all.iter().map(|(position, normal)| {
        let [d2, n2] = [position, normal].map(|v| v.iter().map(|x| x * x).sum::<f64>());
        middle(*position, *normal) / n2.sqrt() / (d2 * d2.sqrt())
    });
    let truth: Vec<f64> = truth.collect();
    let name = if kind == "f32" { "sphere, f32" } else { "sphere, f64" };
    Setting::new(name, name, true, move |_| {
        let sphere = Sphere::new([R::ZERO; 3], R::ONE).map_err(|e| e.to_string())?;
        factors(&all, &truth, bytes * 10.0, |receiver| sphere_configuration_factor(&sphere, receiver))
    })
}

fn factors<R: Real>(
    all: &[([f64; 3], [f64; 3])],
    truth: &[f64],
    operations: f64,
    of: impl Fn(&Receiver<R>) -> R,
) -> Result<Run, String> {
    let receiver = |(position, normal): &([f64; 3], [f64; 3])| {
        Receiver::new(position.map(R::from_f64), normal.map(R::from_f64)).map_err(|e| e.to_string())
    };
    let receivers = all.iter().map(receiver).collect::<Result<Vec<_>, _>>()?;
    let (found, seconds) = timed_items(&receivers, 50, || (), |(), receiver| of(receiver).to_f64());
    let [error, worst] = rms_and_worst(found.iter().zip(truth).map(|(f, t)| f / t - 1.0));
    Ok(Run { seconds: seconds / count(found.len()), operations, error, worst })
}
