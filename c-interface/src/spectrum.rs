//! Spectra: given at nodes, integrated, sampled, looked up.

use core::ffi::c_char;

use spectral_core::spectrum::{Outside, PiecewiseLinear, Uniform};
use spectral_core::summation::SumGrid;
use spectral_core::tables::find_light;
use spectral_core::{Real, Spectrum, tristimulus};

use crate::boundary::{Outcome, Output, read, representable, slice};
use crate::{SpectralObserver, SpectralOutside, SpectralStatus};

/// A spectrum of the caller's: linear between values at wavelengths.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct SpectralSpectrum<R> {
    /// `count` wavelengths in nm, strictly increasing.
    pub wavelengths: *const R,
    /// `count` values: spectral power of any unit, or reflectance; finite.
    pub values: *const R,
    /// How many nodes there are, at least 2.
    pub count: usize,
    /// A `SpectralOutside`: what the spectrum is outside its nodes.
    pub outside: i32,
}

impl<R: Real> SpectralSpectrum<R> {
    /// What the structure describes, checked.
    pub(crate) unsafe fn view<'a>(&self) -> Outcome<PiecewiseLinear<'a, R>> {
        let (wavelengths, values) = (slice(self.wavelengths, self.count)?, slice(self.values, self.count)?);
        Ok(PiecewiseLinear::new(wavelengths, values, SpectralOutside::meaning(self.outside)?)?)
    }
}

unsafe fn tristimulus_of<R: Real>(spectrum: *const SpectralSpectrum<R>, observer: i32, xyz: *mut R) -> Outcome {
    let output = Output::at(xyz.cast::<[R; 3]>())?;
    let spectrum = read(spectrum)?.view()?;
    let observer = SpectralObserver::meaning(observer)?.observer();
    let found = tristimulus(&observer, &spectrum, R::from_f64(380.0), R::from_f64(780.0));
    representable(&found)?;
    output.put(found)
}

unsafe fn sample<R: Real>(spectrum: *const SpectralSpectrum<R>, count: usize, powers: *mut R) -> Outcome {
    write_samples(&read(spectrum)?.view()?, count, powers)
}

unsafe fn write_samples<R: Real, S: Spectrum<R>>(spectrum: &S, count: usize, powers: *mut R) -> Outcome {
    match count {
        81 => Output::at(powers.cast::<[R; 81]>())?.put(SumGrid::CIE_5NM.sample(spectrum)),
        401 => Output::at(powers.cast::<[R; 401]>())?.put(SumGrid::CIE_1NM.sample(spectrum)),
        _ => Err(SpectralStatus::Length),
    }
}

unsafe fn builtin<R: Real>(name: *const c_char, count: usize, powers: *mut R) -> Outcome {
    let light: Uniform<'_, R> = find_light(text(name)?).ok_or(SpectralStatus::Name)?.spectrum(Outside::Zero);
    write_samples(&light, count, powers)
}

/// The longest name that is looked up, its end included.
const LONGEST_NAME: usize = 32;

unsafe fn text<'a>(pointer: *const c_char) -> Outcome<&'a str> {
    let first = pointer.cast::<u8>();
    read(first)?;
    let length = (0..LONGEST_NAME).find(|&place| first.add(place).read() == 0).ok_or(SpectralStatus::Name)?;
    core::str::from_utf8(slice(first, length)?).map_err(|_| SpectralStatus::Name)
}

macro_rules! exports {
    ($R:ident) => { pastey::paste! { mod [<exports_ $R>] {
        use super::*;
        use crate::boundary::export;

        export! {
            /// CIE XYZ of a light or any other spectrum: the integrals of its products with the colour-matching functions over 380–780 nm,
            /// in the spectrum's unit times nm.
            ///
            /// Exact but for rounding, whatever the nodes: the spectrum and the functions (tabulated at 1 nm) are linear between nodes.
            ///
            /// @param observer a SpectralObserver
            /// @param[out] xyz 3 numbers
            /// @return NULL, MISALIGNED, LENGTH, NOT_FINITE, ORDER, CODE; RANGE when the result overflows
            [<spectral_tristimulus_ $R>] = tristimulus_of(spectrum: *const SpectralSpectrum<$R>, observer: i32, xyz: *mut $R);

            /// Samples of a spectrum for the functions that measure lights: its values at 380, …, 780 nm.
            ///
            /// @param count 81 for steps of 5 nm (tables of the CIE, as CIE 13.3 prescribes), 401 for 1 nm (everything else)
            /// @param[out] powers `count` numbers
            /// @return NULL, MISALIGNED, LENGTH, NOT_FINITE, ORDER, CODE
            [<spectral_sample_ $R>] = sample(spectrum: *const SpectralSpectrum<$R>, count: usize, powers: *mut $R);

            /// Samples of a built-in light: "A", "D65", "FL1" … "FL12", "FL3.1", "HP1", "LED-B1" and others.
            ///
            /// Links the tables of all lights.
            ///
            /// @param name ends with a zero byte
            /// @param count, powers as those of spectral_sample
            /// @return NULL, MISALIGNED, LENGTH, NAME
            [<spectral_builtin_light_ $R>] = builtin(name: *const c_char, count: usize, powers: *mut $R);
        }
    } pub use [<exports_ $R>]::*; }};
}
exports!(f32);
exports!(f64);
