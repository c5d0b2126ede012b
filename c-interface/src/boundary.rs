//! What every function does at the boundary: pointers in, values and a status out.

use core::ffi::{CStr, c_char};

use disk_sampling::ShapeError;
use disk_sampling::estimate::EstimateError;
use disk_sampling::partition::PartitionError;
use spectral_core::Real;
use spectral_core::brdf::BrdfError;
use spectral_core::expression::ExpressionError;
use spectral_core::interval::BuildError;
use spectral_core::light::LightError;
use spectral_core::spectrum::SpectrumError;
use spectral_core::upsampling::{UpsamplerError, UpsamplingError};

/// What became of a call: 0 when it was done, otherwise why it was refused. A refused call has written nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum SpectralStatus {
    /// Done.
    Ok = 0,
    /// A pointer is null.
    Null = 1,
    /// A pointer is not aligned for what it points to.
    Misaligned = 2,
    /// A count is not one of those that are served, or a buffer is too small.
    Length = 3,
    /// A number is infinite or NaN.
    NotFinite = 4,
    /// A number that must not be is negative.
    Negative = 5,
    /// Wavelengths do not increase strictly.
    Order = 6,
    /// A code is none of its enumeration's.
    Code = 7,
    /// A number is outside the function's domain, or its result is outside the number type.
    Range = 8,
    /// A light has no power in the visible range.
    Dark = 9,
    /// No reflectance of this kind has the colour asked for.
    Unreachable = 10,
    /// There is nothing of this name.
    Name = 11,
    /// The caller's function answered with a number that is infinite, NaN or negative.
    Response = 12,
}

impl SpectralStatus {
    const fn text(code: i32) -> &'static CStr {
        match code {
            0 => c"done",
            1 => c"a pointer is null",
            2 => c"a pointer is not aligned",
            3 => c"a count is not served, or a buffer is too small",
            4 => c"a number is infinite or not a number",
            5 => c"a number is negative",
            6 => c"wavelengths do not increase strictly",
            7 => c"an unknown code",
            8 => c"a number is outside the domain",
            9 => c"the light has no power in the visible range",
            10 => c"no reflectance of this kind has this colour",
            11 => c"there is nothing of this name",
            12 => c"the function called back answered with no valid number",
            _ => c"an unknown status",
        }
    }
}

/// What a status means: one line of ASCII, never null, valid for ever.
#[unsafe(no_mangle)]
pub extern "C" fn spectral_status_text(status: i32) -> *const c_char {
    SpectralStatus::text(status).as_ptr()
}

pub(crate) type Outcome<T = ()> = Result<T, SpectralStatus>;

/// Exports functions: a name for C, and the generic function behind it.
macro_rules! export {
    ($($(#[$doc:meta])* $name:ident = $function:ident($($argument:ident: $kind:ty),* $(,)?);)*) => {$(
        $(#[$doc])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name($($argument: $kind),*) -> $crate::SpectralStatus {
            match super::$function($($argument),*) {
                Ok(()) => $crate::SpectralStatus::Ok,
                Err(status) => status,
            }
        }
    )*};
}
pub(crate) use export;

fn check<T>(pointer: *const T) -> Outcome {
    if pointer.is_null() {
        return Err(SpectralStatus::Null);
    }
    if pointer.is_aligned() { Ok(()) } else { Err(SpectralStatus::Misaligned) }
}

/// A copy of what a pointer points to, so that results may be written over it.
pub(crate) unsafe fn read<T: Copy>(pointer: *const T) -> Outcome<T> {
    check(pointer)?;
    Ok(pointer.read())
}

/// A copy of finite numbers.
pub(crate) unsafe fn numbers<R: Real, const N: usize>(pointer: *const R) -> Outcome<[R; N]> {
    let values = read(pointer.cast::<[R; N]>())?;
    finite(&values)?;
    Ok(values)
}

/// An array of the caller's, which must outlive the call and not be written to meanwhile.
pub(crate) unsafe fn slice<'a, T>(pointer: *const T, count: usize) -> Outcome<&'a [T]> {
    check(pointer)?;
    fits::<T>(count)?;
    Ok(core::slice::from_raw_parts(pointer, count))
}

/// No array is larger than half the address space.
fn fits<T>(count: usize) -> Outcome {
    let bytes = count.checked_mul(size_of::<T>()).ok_or(SpectralStatus::Length)?;
    isize::try_from(bytes).map(|_| ()).map_err(|_| SpectralStatus::Length)
}

/// Where a result goes, once there is one.
pub(crate) struct Output<T>(*mut T);

impl<T> Output<T> {
    pub(crate) unsafe fn at(pointer: *mut T) -> Outcome<Self> {
        check(pointer)?;
        Ok(Self(pointer))
    }

    /// The room as another type of no larger size and alignment, filled.
    pub(crate) unsafe fn fill_as<'a, U>(self, filling: U) -> &'a mut U {
        const { assert!(size_of::<U>() <= size_of::<T>() && align_of::<U>() <= align_of::<T>()) };
        let place = self.0.cast::<U>();
        place.write(filling);
        &mut *place
    }

    /// Writes the result.
    pub(crate) unsafe fn put(self, value: T) -> Outcome {
        self.0.write(value);
        Ok(())
    }
}

/// Refuses numbers that are infinite or NaN.
pub(crate) fn finite<R: Real>(values: &[R]) -> Outcome {
    if values.iter().all(|value| value.is_finite()) { Ok(()) } else { Err(SpectralStatus::NotFinite) }
}

/// Refuses numbers below zero; they are finite.
pub(crate) fn not_negative<R: Real>(values: &[R]) -> Outcome {
    if values.iter().all(|&value| value >= R::ZERO) { Ok(()) } else { Err(SpectralStatus::Negative) }
}

/// Refuses what is outside a domain.
pub(crate) fn within(condition: bool) -> Outcome {
    if condition { Ok(()) } else { Err(SpectralStatus::Range) }
}

/// Refuses results that overflow the number type.
pub(crate) fn representable<R: Real>(values: &[R]) -> Outcome {
    within(values.iter().all(|value| value.is_finite()))
}

impl From<SpectrumError> for SpectralStatus {
    fn from(error: SpectrumError) -> Self {
        match error {
            SpectrumError::TooFewNodes { .. } | SpectrumError::LengthMismatch { .. } => Self::Length,
            SpectrumError::Wavelength { .. } | SpectrumError::Value { .. } => Self::NotFinite,
            SpectrumError::Order { .. } => Self::Order,
            SpectrumError::Negative { .. } => Self::Negative,
            _ => Self::Range,
        }
    }
}

impl From<LightError> for SpectralStatus {
    fn from(error: LightError) -> Self {
        match error {
            LightError::Value { .. } => Self::NotFinite,
            LightError::Negative { .. } => Self::Negative,
            _ => Self::Dark,
        }
    }
}

impl From<BrdfError> for SpectralStatus {
    fn from(_: BrdfError) -> Self {
        Self::Range
    }
}

impl From<ShapeError> for SpectralStatus {
    fn from(error: ShapeError) -> Self {
        if error == ShapeError::NotFinite { Self::NotFinite } else { Self::Range }
    }
}

impl From<PartitionError> for SpectralStatus {
    fn from(error: PartitionError) -> Self {
        match error {
            PartitionError::Buffer { .. } => Self::Length,
            PartitionError::NotFinite => Self::NotFinite,
            _ => Self::Range,
        }
    }
}

impl From<EstimateError> for SpectralStatus {
    fn from(error: EstimateError) -> Self {
        match error {
            EstimateError::NoPanels => Self::Length,
            EstimateError::Response => Self::Response,
            _ => Self::Range,
        }
    }
}

impl From<UpsamplingError> for SpectralStatus {
    fn from(error: UpsamplingError) -> Self {
        if error == UpsamplingError::Unreachable { Self::Unreachable } else { Self::Range }
    }
}

impl From<UpsamplerError> for SpectralStatus {
    fn from(_: UpsamplerError) -> Self {
        Self::Range
    }
}

impl From<BuildError> for SpectralStatus {
    fn from(error: BuildError) -> Self {
        if error == BuildError::NotFinite { Self::NotFinite } else { Self::Length }
    }
}

impl From<ExpressionError> for SpectralStatus {
    fn from(error: ExpressionError) -> Self {
        if error == ExpressionError::NoPieces { Self::Length } else { Self::Range }
    }
}
