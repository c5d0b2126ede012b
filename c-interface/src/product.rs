//! The colour of a light times reflectances, to a bound of ΔE*ab.

use spectral_core::Real;
use spectral_core::adaptive::{Evaluation, Piece, Target, evaluate};
use spectral_core::expression::{Op, Program, Sources};
use spectral_core::interval::{Domain, Interval, Node, Weight, node_count};
use spectral_core::spectrum::PiecewiseLinear;

use crate::boundary::{Outcome, Output, finite, read, representable, slice, within};
use crate::{SpectralEvaluationStatus, SpectralMode, SpectralObserver, SpectralSpectrum, SpectralStatus};

/// The deepest level of the subdivision: intervals of 6.25 nm.
const DEPTH: u8 = 6;
/// The most intervals: 2 to the power of the deepest level.
pub const SPECTRAL_MOST_INTERVALS: usize = 64;
/// The parts of the visible range on all levels.
const NODES: usize = 127;
/// The most reflectances of one product.
pub const SPECTRAL_MOST_REFLECTANCES: usize = 7;

/// Room for what a product works with; what it holds before and after a call does not matter.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct SpectralWorkspace<R> {
    /// Nothing to be read.
    pub room: [[R; 9]; 127],
}

const _: () = assert!(NODES == node_count(DEPTH) && SPECTRAL_MOST_INTERVALS == 1 << DEPTH);
const _: () = assert!(size_of::<[Weight<f32>; NODES]>() == size_of::<SpectralWorkspace<f32>>());
const _: () = assert!(size_of::<[Weight<f64>; NODES]>() == size_of::<SpectralWorkspace<f64>>());
const _: () = assert!(align_of::<Weight<f32>>() == align_of::<SpectralWorkspace<f32>>());
const _: () = assert!(align_of::<Weight<f64>>() == align_of::<SpectralWorkspace<f64>>());

/// What a product aims at.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct SpectralTarget<R> {
    /// The ΔE*ab to reach, above 0.
    pub threshold: R,
    /// XYZ of the white point in the product's unit times nm, as of spectral_tristimulus for the light; above 0.
    pub white: [R; 3],
    /// A `SpectralMode`.
    pub mode: i32,
    /// A `SpectralObserver`.
    pub observer: i32,
    /// The most intervals, 1 to `SPECTRAL_MOST_INTERVALS`.
    pub most_intervals: usize,
}

/// One of the intervals that the visible range was split into.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct SpectralPiece<R> {
    /// Where it starts, in nm.
    pub from: R,
    /// Where it ends, in nm.
    pub to: R,
    /// Its contribution to XYZ.
    pub xyz: [R; 3],
    /// How far off that contribution may be.
    pub radius: [R; 3],
}

/// A product's colour and what is known of its error.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct SpectralProduct<R> {
    /// XYZ of the product, in its unit times nm.
    pub xyz: [R; 3],
    /// How far each may be off: certain in the certified mode.
    pub radius: [R; 3],
    /// The largest ΔE*ab within that radius.
    pub delta_e: R,
    /// How many intervals there are.
    pub intervals: usize,
    /// Whether the threshold was met.
    pub status: SpectralEvaluationStatus,
}

/// Spectra whose intervals are integrated when they are asked for: no more memory than the caller's arrays.
struct OnDemand<'a, R> {
    domain: &'a Domain<'a, R>,
    light: PiecewiseLinear<'a, R>,
    reflectances: &'a [SpectralSpectrum<R>],
}

impl<R: Real> Sources<R> for OnDemand<'_, R> {
    fn leaf(&self, _: u32, _: Node) -> Option<&Interval<R>> {
        None
    }

    fn deferred(&mut self, id: u32, node: Node) -> Option<Interval<R>> {
        let Some(place) = usize::try_from(id).ok()?.checked_sub(1) else {
            return Some(Interval::of_spectrum(&self.light, self.domain, node));
        };
        // SAFETY: `product` has checked all of them, and the caller keeps the arrays.
        let reflectance = unsafe { self.reflectances.get(place)?.view() }.ok()?;
        Some(Interval::of_spectrum(&reflectance, self.domain, node))
    }
}

/// The light, and then a reflectance and a product each.
fn program<R: Real>() -> [Op<R>; 2 * SPECTRAL_MOST_REFLECTANCES + 1] {
    let mut ops = [Op::Deferred(0); 2 * SPECTRAL_MOST_REFLECTANCES + 1];
    for (pair, number) in ops.get_mut(1..).unwrap_or_default().chunks_exact_mut(2).zip(1..) {
        pair.copy_from_slice(&[Op::Deferred(number), Op::Product]);
    }
    ops
}

fn target<R: Real>(asked: &SpectralTarget<R>) -> Outcome<Target<R>> {
    finite(&[asked.threshold])?;
    finite(&asked.white)?;
    within(asked.threshold > R::ZERO && asked.white.iter().all(|&value| value > R::ZERO))?;
    Ok(Target { mode: SpectralMode::meaning(asked.mode)?, threshold: asked.threshold, white: asked.white })
}

/// The intervals in the order of their wavelengths.
fn sorted<R: Real>(pieces: &[Piece<R>]) -> [SpectralPiece<R>; SPECTRAL_MOST_INTERVALS] {
    let zero = R::ZERO;
    let mut sorted =
        [SpectralPiece { from: zero, to: zero, xyz: [zero; 3], radius: [zero; 3] }; SPECTRAL_MOST_INTERVALS];
    for piece in pieces {
        let [from, to] = piece.node.limits();
        let before = pieces.iter().filter(|other| other.node.limits::<R>()[0] < from).count();
        if let Some(place) = sorted.get_mut(before) {
            *place = SpectralPiece { from, to, xyz: piece.xyz, radius: piece.radius };
        }
    }
    sorted
}

unsafe fn product<R: Real>(
    light: *const SpectralSpectrum<R>,
    reflectances: *const SpectralSpectrum<R>,
    count: usize,
    asked: *const SpectralTarget<R>,
    workspace: *mut SpectralWorkspace<R>,
    pieces: *mut SpectralPiece<R>,
    capacity: usize,
    found: *mut SpectralProduct<R>,
) -> Outcome {
    let output = Output::at(found)?;
    let room = Output::at(workspace)?;
    let light = read(light)?.view()?;
    let reflectances = if count == 0 { &[][..] } else { slice(reflectances, count)? };
    for reflectance in reflectances {
        reflectance.view()?;
    }
    let asked = read(asked)?;
    let target = target(&asked)?;
    let observer = SpectralObserver::meaning(asked.observer)?.observer();
    let most = asked.most_intervals;
    if count > SPECTRAL_MOST_REFLECTANCES || most == 0 || most > SPECTRAL_MOST_INTERVALS {
        return Err(SpectralStatus::Length);
    }
    if capacity > 0 {
        Output::at(pieces)?;
    }

    let weights = room.fill_as([Weight::default(); NODES]);
    let domain = Domain::build(observer, DEPTH, weights)?;
    let ops = program();
    let program = Program::new(ops.get(..2 * count + 1).unwrap_or_default())?;
    let mut sources = OnDemand { domain: &domain, light, reflectances };
    let mut stack = [Interval::zero(); 2];
    let mut split = [Piece::default(); SPECTRAL_MOST_INTERVALS];
    let room = split.get_mut(..most).unwrap_or_default();
    let evaluation = evaluate(&program, &domain, &target, &mut sources, &mut stack, room)?;
    report(&evaluation, split.get(..evaluation.intervals).unwrap_or_default(), pieces, capacity, output)
}

unsafe fn report<R: Real>(
    evaluation: &Evaluation<R>,
    split: &[Piece<R>],
    pieces: *mut SpectralPiece<R>,
    capacity: usize,
    output: Output<SpectralProduct<R>>,
) -> Outcome {
    let Evaluation { xyz, radius, delta_e, intervals, status } = *evaluation;
    representable(&xyz)?;
    representable(&radius)?;
    representable(&[delta_e])?;
    if capacity > 0 && capacity < intervals {
        return Err(SpectralStatus::Length);
    }
    if capacity > 0 {
        for (place, piece) in sorted(split).iter().take(intervals).enumerate() {
            pieces.add(place).write(*piece);
        }
    }
    output.put(SpectralProduct { xyz, radius, delta_e, intervals, status: status.into() })
}

macro_rules! exports {
    ($R:ident) => {
        pastey::paste! { mod [<exports_ $R>] {
            use super::*;
            use crate::boundary::export;

            export! {
                /// The colour of light · reflectance · reflectance …, on intervals of 380–780 nm that are split where the error is until its
                /// bound is at or under a threshold (Iehl and Péroche 2000, with a bound that holds).
                ///
                /// In the certified mode, XYZ is certainly within `radius` of that of the exact product of the piecewise linear spectra, and its
                /// colour certainly within `delta_e` (ΔE*ab) of it, rounding included.
                ///
                /// @param reflectances `count` spectra, 0 to SPECTRAL_MOST_REFLECTANCES; may be null when there are none
                /// @param workspace must not overlap anything else; keeps nothing from call to call
                /// @param[out] pieces the intervals in the order of wavelengths; not written, and may be null, when `capacity` is 0
                /// @param capacity how many there is room for: 0, or at least as many as are found; `most_intervals` is always enough
                /// @return NULL, MISALIGNED, LENGTH, NOT_FINITE, ORDER, CODE; RANGE for a threshold or white that is not positive, or a result that overflows
                [<spectral_product_ $R>] = product(
                    light: *const SpectralSpectrum<$R>,
                    reflectances: *const SpectralSpectrum<$R>,
                    count: usize,
                    target: *const SpectralTarget<$R>,
                    workspace: *mut SpectralWorkspace<$R>,
                    pieces: *mut SpectralPiece<$R>,
                    capacity: usize,
                    found: *mut SpectralProduct<$R>,
                );
            }
        } pub use [<exports_ $R>]::*; }
    };
}
exports!(f32);
exports!(f64);
