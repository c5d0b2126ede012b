//! What becomes of a light on a paint: on intervals, and by operators for three components.

use serde::Serialize;
use spectral_core::adaptive::{Mode, Piece, Status, Target, evaluate};
use spectral_core::bilinear::Tensor;
use spectral_core::colour::{RgbSpace, delta_e_00, delta_e_ab, xyz_to_lab};
use spectral_core::expression::{Op, Program};
use spectral_core::interval::{Domain, Interval, Pyramid, Weight, node_count};
use spectral_core::prefilter::Prefilter;
use spectral_core::spectrum::{Constant, Outside};
use spectral_core::tables::{colorchecker, illuminants};
use spectral_core::upsampling::smits::Basis;
use spectral_core::{Observer, Spectrum, tristimulus};

use crate::catalogue::product;
use crate::light::SpectralTable;
use crate::swatch::{Display, xyz};

/// Intervals down to 1.5625 nm.
const DEPTH: u8 = 8;
/// The most intervals: all on the deepest level.
const MOST: usize = 256;
/// The most reflections: the products are integrated exactly up to eight factors.
const MOST_REFLECTIONS: usize = 5;
/// The bins of Smits in nm; the last one goes on to the end of the visible range.
const SMITS_ENDS: [f64; 11] = [380.0, 414.0, 448.0, 482.0, 516.0, 550.0, 584.0, 618.0, 652.0, 686.0, 780.0];

type Rgb = [f64; 3];

/// One of the intervals.
#[derive(Serialize)]
struct Part {
    from: f64,
    to: f64,
    /// The product's mean, relative to the light's largest value.
    mean: f64,
    /// How much of the bound of ΔE*ab is this interval's, to first order: 0 to 1.
    share: f64,
}

/// One way to multiply light and reflectance.
#[derive(Serialize)]
struct Operator {
    key: &'static str,
    name: &'static str,
    /// How it looks, as it is and to an adapted eye; nothing where the way can't be gone.
    shown: Option<[[u8; 3]; 2]>,
    /// Its colour in CIELAB, relative to the light.
    lab: Option<[f64; 3]>,
    /// ΔE00 from the spectral truth.
    delta_e_00: Option<f64>,
    /// Why there is none.
    note: Option<String>,
}

/// What becomes of a light.
#[derive(Serialize)]
pub(crate) struct Examined {
    intervals: usize,
    /// The bound of ΔE*ab, or its estimate in other modes than the certified one.
    delta_e: f64,
    /// ΔE*ab from the spectral truth.
    error: f64,
    reached: bool,
    parts: Vec<Part>,
    #[serde(flatten)]
    curves: Curves,
    operators: Vec<Operator>,
}

/// Light, reflectance and product at every nanometre of 380–780 nm; lights relative to the light's largest value.
#[derive(Serialize)]
struct Curves {
    light: Vec<f64>,
    paint: Vec<f64>,
    product: Vec<f64>,
    #[serde(skip)]
    largest: f64,
}

/// What all ways start from.
struct Scene<'a> {
    light: &'a dyn Spectrum<f64>,
    paint: &'a dyn Spectrum<f64>,
    reflections: usize,
    white: [f64; 3],
    truth: [f64; 3],
}

impl Scene<'_> {
    fn lab(&self, xyz: [f64; 3]) -> [f64; 3] {
        xyz_to_lab(xyz, self.white)
    }
}

pub(crate) fn examine(
    light: &SpectralTable,
    threshold: f64,
    mode: usize,
    paint: usize,
    reflections: usize,
) -> Result<Examined, String> {
    let modes = [Mode::Certified, Mode::Corrected, Mode::Paper];
    let mode = *modes.get(mode).ok_or("there is no such mode")?;
    if !(threshold > 0.0 && threshold.is_finite()) {
        return Err("the threshold must be above 0".to_owned());
    }
    if !(1..=MOST_REFLECTIONS).contains(&reflections) {
        return Err(format!("there must be 1 to {MOST_REFLECTIONS} reflections"));
    }
    let paint = colorchecker::ALL.get(paint).ok_or("there is no such paint")?.spectrum(Outside::Hold);
    let light = light.spectrum().ok_or("the light is no spectrum")?;
    let mut factors: Vec<&dyn Spectrum<f64>> = vec![&light];
    factors.resize(1 + reflections, &paint);
    let truth = product(&factors).ok_or("the product has no colour")?;
    let scene = Scene { light: &light, paint: &paint, reflections, white: xyz(&light), truth };
    let split = split(&scene, mode, threshold)?;
    Ok(Examined { operators: operators(&scene)?, ..split })
}

/// The product on intervals, and its curves.
fn split(scene: &Scene<'_>, mode: Mode, threshold: f64) -> Result<Examined, String> {
    let nodes = node_count(DEPTH);
    let mut weights = vec![Weight::default(); nodes];
    let domain = Domain::build(Observer::cie_1931_2deg(), DEPTH, &mut weights).map_err(|e| e.to_string())?;
    let mut buffers = [vec![Interval::zero(); nodes], vec![Interval::zero(); nodes]];
    let [first, second] = &mut buffers;
    let leaves = [
        Pyramid::build(scene.light, &domain, first).map_err(|e| e.to_string())?,
        Pyramid::build(scene.paint, &domain, second).map_err(|e| e.to_string())?,
    ];
    let mut ops = vec![Op::Leaf(0)];
    ops.extend((0..scene.reflections).flat_map(|_| [Op::Leaf(1), Op::Product]));
    let program = Program::new(&ops).map_err(|e| e.to_string())?;
    let target = Target { mode, threshold, white: scene.white };
    let (mut stack, mut pieces) = ([Interval::zero(); 2], [Piece::default(); MOST]);
    let mut sources = leaves.as_slice();
    let found =
        evaluate(&program, &domain, &target, &mut sources, &mut stack, &mut pieces).map_err(|e| e.to_string())?;

    let curves = curves(scene)?;
    let total = found.radius.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let mut parts = Vec::new();
    for piece in pieces.iter().take(found.intervals) {
        let [from, to] = piece.node.limits();
        let weight = domain.weight(piece.node);
        let interval = program.evaluate(piece.node, &weight, mode.order(), &mut sources, &mut stack);
        let mean = interval.map_err(|e| e.to_string())?.mean / curves.largest;
        parts.push(Part { from, to, mean, share: piece.radius.iter().sum::<f64>() / total });
    }
    parts.sort_by(|a, b| a.from.total_cmp(&b.from));
    Ok(Examined {
        intervals: found.intervals,
        delta_e: found.delta_e,
        error: delta_e_ab(scene.lab(found.xyz), scene.lab(scene.truth)),
        reached: found.status == Status::Reached,
        parts,
        curves,
        operators: Vec::new(),
    })
}

/// Light, reflectance and product at every nanometre.
fn curves(scene: &Scene<'_>) -> Result<Curves, String> {
    let curve = |spectrum: &dyn Spectrum<f64>| (380..=780).map(|w| spectrum.value(f64::from(w))).collect::<Vec<_>>();
    let (mut light, paint) = (curve(scene.light), curve(scene.paint));
    let largest = light.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    light.iter_mut().for_each(|value| *value /= largest);
    let times = i32::try_from(scene.reflections).map_err(|e| e.to_string())?;
    let product = light.iter().zip(&paint).map(|(light, paint)| light * paint.powi(times)).collect();
    Ok(Curves { light, paint, product, largest })
}

/// The spectral truth, and the ways that know three components only.
fn operators(scene: &Scene<'_>) -> Result<Vec<Operator>, String> {
    let observer = Observer::cie_1931_2deg();
    let daylight = illuminants::D65.spectrum::<f64>(Outside::Zero);
    let space = rec_709(&daylight)?;
    let daylight = Prefilter::new(&observer, &daylight, space).map_err(|e| e.to_string())?;
    let (light, paint) = (space.from_xyz(scene.white), daylight.material(scene.paint));
    let after = |step: &dyn Fn(Rgb) -> Rgb| (0..scene.reflections).fold(light, |colour, _| step(colour));

    let tensor = Tensor::rec_709().reflection(paint);
    let ways = [
        ("truth", "Spectral truth", Ok(scene.truth)),
        ("rgb", "RGB product", Ok(space.to_xyz(after(&|c| core::array::from_fn(|k| c[k] * paint[k]))))),
        ("bilinear", "Bilinear product", Ok(space.to_xyz(after(&|c| tensor.apply(c))))),
        ("prefiltered", "Prefiltered", prefiltered(scene)),
        ("smits", "Smits’ spectra", smits(&space, light, paint, scene.reflections)),
    ];
    let display = Display::new(scene.white);
    let truth = scene.lab(scene.truth);
    Ok(ways
        .into_iter()
        .map(|(key, name, found)| {
            let found = found.and_then(|xyz: [f64; 3]| {
                if xyz.iter().all(|c| c.is_finite()) { Ok(xyz) } else { Err("its colour overflows".to_owned()) }
            });
            let colour = found.as_ref().ok().copied();
            let lab = colour.map(|xyz| scene.lab(xyz));
            Operator {
                key,
                name,
                shown: colour.map(|xyz| [display.as_is(xyz), display.adapted(xyz)]),
                lab,
                delta_e_00: lab.map(|lab| delta_e_00(lab, truth)),
                note: found.err(),
            }
        })
        .collect())
}

/// Linear Rec. 709 with the white of the table of CIE D65.
fn rec_709(daylight: &dyn Spectrum<f64>) -> Result<RgbSpace, String> {
    let [x, y, z] = xyz(daylight);
    let sum = x + y + z;
    RgbSpace::new(RgbSpace::REC_709.primaries(), [x / sum, y / sum]).map_err(|e| e.to_string())
}

/// Components made under this very light, in sharp primaries (Ward and Eydelberg-Vileshin 2002): exact after one reflection.
fn prefiltered(scene: &Scene<'_>) -> Result<[f64; 3], String> {
    let observer = Observer::cie_1931_2deg();
    let prefilter = Prefilter::new(&observer, scene.light, RgbSpace::SHARP)
        .map_err(|_| "The light is too saturated for its RGB space.".to_owned())?;
    let paint = prefilter.material(scene.paint);
    let times = i32::try_from(scene.reflections).map_err(|e| e.to_string())?;
    let light = RgbSpace::SHARP.from_xyz(scene.white);
    Ok(RgbSpace::SHARP.to_xyz(core::array::from_fn(|k| light[k] * paint[k].powi(times))))
}

/// Spectra made of components (Smits 1999): what an engine does that has nothing else. Negative components become 0.
fn smits(space: &RgbSpace, light: Rgb, paint: Rgb, reflections: usize) -> Result<[f64; 3], String> {
    let bins = |basis: Basis<f64>, rgb: Rgb| basis.spectrum(rgb.map(|c| c.max(0.0))).map_err(|e| e.to_string());
    let (mut powers, paint) = (bins(Basis::lights(), light)?.values(), bins(Basis::reflectances(), paint)?.values());
    for _ in 0..reflections {
        powers = core::array::from_fn(|bin| powers[bin] * paint[bin]);
    }
    // The white of Smits is a flat spectrum: components are taken for an equal-energy white and then mean this one.
    let flat = Constant::new(1.0).map_err(|e| e.to_string())?;
    let observer = Observer::cie_1931_2deg();
    let equal_energy = RgbSpace::new(RgbSpace::REC_709.primaries(), [1.0 / 3.0; 2]).map_err(|e| e.to_string())?;
    let unit = xyz(&flat)[1];
    let mut sum = [0.0; 3];
    for (ends, power) in SMITS_ENDS.windows(2).zip(powers) {
        let [from, to] = [ends[0], ends[1]];
        let bin = space.to_xyz(equal_energy.from_xyz(tristimulus(&observer, &flat, from, to)));
        sum = core::array::from_fn(|a| sum[a] + power * bin[a] / unit);
    }
    Ok(sum)
}
