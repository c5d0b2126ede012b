//! What a lamp's own microcontroller can know of it, in `f32`, from a spectrum in flash: no heap, no operating system, no
//! panic, and the same bits wherever it runs.
//!
//! The same code prints on the host, over semihosting on bare metal, and in WebAssembly.
#![no_std]

mod text;

use disk_sampling::{Disk, Receiver, disk_configuration_factor};
use spectral_core::adaptive::{Evaluation, Mode, Piece, Target, evaluate};
use spectral_core::bilinear::Tensor;
use spectral_core::expression::{Op, Program};
use spectral_core::interval::{Domain, Interval, Pyramid, Weight, node_count};
use spectral_core::light::{GeneralIndices, measure_indices};
use spectral_core::spectrum::{Outside, RadiationConstant};
use spectral_core::summation::SumGrid;
use spectral_core::tables::{UniformTable, colorchecker, led};
use spectral_core::{Observer, tristimulus};

use text::Text;

/// The lamp: a white LED of 4100 K, a phosphor over blue.
const LAMP: UniformTable = led::LED_B3;
/// Its luminous flux in lm, and the radius in m of the disk that it is spread over.
const FLUX: f32 = 5000.0;
const RADIUS: f32 = 0.4;

/// Levels of the division of the visible range.
const DEPTH: u8 = 4;
const NODES: usize = node_count(DEPTH);

/// Colour temperature, R_a and CRI00 of the lamp.
#[inline(never)]
fn indices() -> Option<GeneralIndices<f32>> {
    let grid = SumGrid::CIE_5NM;
    let lamp = grid.sample(&LAMP.spectrum(Outside::Zero));
    measure_indices(grid, &lamp, RadiationConstant::Its1990).ok()
}

/// The colour of a green paint under the lamp, and how far it is off at most: a certified product of intervals.
#[inline(never)]
fn paint() -> Option<Evaluation<f32>> {
    let mut weights = [Weight::default(); NODES];
    let domain = Domain::build(Observer::cie_1931_2deg(), DEPTH, &mut weights).ok()?;
    let mut buffers = [[Interval::zero(); NODES]; 2];
    let [first, second] = &mut buffers;
    let lamp = LAMP.spectrum(Outside::Zero);
    let leaves = [
        Pyramid::build(&lamp, &domain, first).ok()?,
        Pyramid::build(&colorchecker::GREEN.spectrum(Outside::Hold), &domain, second).ok()?,
    ];
    let ops = [Op::Leaf(0), Op::Leaf(1), Op::Product];
    let program = Program::new(&ops).ok()?;
    let white = tristimulus(domain.observer(), &lamp, 380.0, 780.0);
    let target = Target { mode: Mode::Certified, threshold: 2.0, white };
    let (mut stack, mut pieces) = ([Interval::zero(); 2], [Piece::default(); 16]);
    evaluate(&program, &domain, &target, &mut leaves.as_slice(), &mut stack, &mut pieces).ok()
}

/// The RGB of a reflection by the bilinear operator.
#[inline(never)]
fn reflection() -> [f32; 3] {
    Tensor::iso_rgb().reflection([0.2, 0.6, 0.1]).apply([1.0, 0.8, 0.5])
}

/// Illuminance in lx of a tilted desk beside the lamp, from the configuration factor: E = Φ F / A.
#[inline(never)]
fn illuminance() -> Option<f32> {
    let disk = Disk::new([0.0, 0.0, 3.55], [0.0, 0.0, -1.0], RADIUS).ok()?;
    let desk = Receiver::new([1.2, 0.5, 0.8], [0.1, 0.0, 0.99]).ok()?;
    let area = core::f32::consts::PI * RADIUS * RADIUS;
    Some(FLUX * disk_configuration_factor(&disk, &desk) / area)
}

/// Writes all results, line by line, as decimals and as the bits of an `f32`; whether there were all of them.
pub fn report(write: &mut impl FnMut(&str)) -> bool {
    let mut all = true;
    let mut line = |name: &str, value: Option<f32>| {
        all &= value.is_some_and(f32::is_finite);
        write(Text::new(name, value.unwrap_or(f32::NAN)).as_str());
    };
    let found = indices();
    line("colour temperature / K", found.map(|found| found.chromaticity.cct.temperature));
    line("distance from Planck", found.map(|found| found.chromaticity.cct.duv));
    line("R_a", found.and_then(|found| found.ra));
    line("CRI00", found.and_then(|found| found.cri00));
    for (name, value) in ["red", "green", "blue"].into_iter().zip(reflection()) {
        line(name, Some(value));
    }
    let found = paint();
    for (name, channel) in ["X", "Y", "Z"].into_iter().zip(0..) {
        line(name, found.and_then(|found| found.xyz.get(channel).copied()));
    }
    line("within delta E*ab", found.map(|found| found.delta_e));
    line("illuminance / lx", illuminance());
    all
}
