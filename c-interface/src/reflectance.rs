//! Reflectance models and Fresnel's formulae.

use spectral_core::brdf::{Brdf, Glossy, Ward, direction};
use spectral_core::{Real, fresnel};

use crate::SpectralWardModel;
use crate::boundary::{Outcome, Output, finite, numbers, read, representable, within};

/// A glossy coat over a diffuse body: ρ_d/π + ρ_s f in 1/sr, with f of the Ward family.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct SpectralReflector<R> {
    /// ρ_d in [0, 1].
    pub diffuse: R,
    /// ρ_s in [0, 1]; the sum of both is at most 1.
    pub specular: R,
    /// Roughness along x, 1e-6 to 100.
    pub alpha_u: R,
    /// Roughness along y, 1e-6 to 100.
    pub alpha_v: R,
    /// A `SpectralWardModel`.
    pub model: i32,
}

/// A direction drawn from a reflector.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct SpectralSample<R> {
    /// Unit vector above the surface.
    pub direction: [R; 3],
    /// Its density in 1/sr.
    pub pdf: R,
    /// The reflector's value times cos θ over the density; the mean of weights is the albedo.
    pub weight: R,
}

unsafe fn model<R: Real>(pointer: *const SpectralReflector<R>) -> Outcome<Glossy<R>> {
    let SpectralReflector { diffuse, specular, alpha_u, alpha_v, model } = read(pointer)?;
    finite(&[diffuse, specular, alpha_u, alpha_v])?;
    let ward = Ward::new(SpectralWardModel::meaning(model)?, alpha_u, alpha_v)?;
    Ok(Glossy::new(diffuse, specular, ward)?)
}

/// A unit vector along three numbers.
unsafe fn along<R: Real>(pointer: *const R) -> Outcome<[R; 3]> {
    Ok(direction(numbers(pointer)?)?)
}

unsafe fn evaluate<R: Real>(
    reflector: *const SpectralReflector<R>,
    light: *const R,
    view: *const R,
    value: *mut R,
) -> Outcome {
    let output = Output::at(value)?;
    output.put(model(reflector)?.evaluate(along(light)?, along(view)?))
}

unsafe fn pdf<R: Real>(
    reflector: *const SpectralReflector<R>,
    light: *const R,
    view: *const R,
    value: *mut R,
) -> Outcome {
    let output = Output::at(value)?;
    output.put(model(reflector)?.pdf(along(light)?, along(view)?))
}

unsafe fn albedo<R: Real>(reflector: *const SpectralReflector<R>, view: *const R, value: *mut R) -> Outcome {
    let output = Output::at(value)?;
    output.put(model(reflector)?.albedo(along(view)?))
}

unsafe fn sample<R: Real>(
    reflector: *const SpectralReflector<R>,
    view: *const R,
    random: *const R,
    found: *mut SpectralSample<R>,
) -> Outcome {
    let output = Output::at(found)?;
    let (reflector, view, random) = (model(reflector)?, along(view)?, numbers::<R, 3>(random)?);
    within(random.iter().all(|&u| u >= R::ZERO && u < R::ONE))?;
    let drawn = reflector.sample(view, random).ok_or(crate::SpectralStatus::Range)?;
    output.put(SpectralSample { direction: drawn.direction, pdf: drawn.pdf, weight: drawn.weight })
}

unsafe fn schlick<R: Real>(reflectance: R, cosine: R, value: *mut R) -> Outcome {
    let output = Output::at(value)?;
    finite(&[reflectance, cosine])?;
    within(unit(reflectance) && unit(cosine))?;
    output.put(fresnel::schlick(reflectance, cosine))
}

unsafe fn dielectric<R: Real>(cosine: R, eta: R, reflectance: *mut R, refracted: *mut R) -> Outcome {
    let (output, behind) = (Output::at(reflectance)?, Output::at(refracted)?);
    finite(&[cosine, eta])?;
    within(unit(cosine) && eta > R::ZERO)?;
    let (reflected, cosine) = fresnel::dielectric(cosine, eta).unwrap_or((R::ONE, R::ZERO));
    representable(&[reflected, cosine])?;
    output.put(reflected)?;
    behind.put(cosine)
}

unsafe fn conductor<R: Real>(cosine: R, n: R, k: R, reflectance: *mut R) -> Outcome {
    let output = Output::at(reflectance)?;
    finite(&[cosine, n, k])?;
    within(unit(cosine) && n > R::ZERO && k >= R::ZERO)?;
    let result = fresnel::conductor(cosine, n, k);
    representable(&[result])?;
    output.put(result)
}

fn unit<R: Real>(value: R) -> bool {
    value >= R::ZERO && value <= R::ONE
}

macro_rules! exports {
    ($R:ident) => { pastey::paste! { mod [<exports_ $R>] {
        use super::*;
        use crate::boundary::export;

        export! {
            /// The value of a reflector in 1/sr; 0 where a direction is not above the surface.
            ///
            /// Directions point away from the surface, in its frame: z along the normal, x along alpha_u. Any length but zero.
            ///
            /// @param light, view 3 numbers each
            /// @return NULL, MISALIGNED, NOT_FINITE, CODE; RANGE for a reflector outside its domain or a direction of zero length
            [<spectral_reflector_evaluate_ $R>] = evaluate(
                reflector: *const SpectralReflector<$R>,
                light: *const $R,
                view: *const $R,
                value: *mut $R,
            );

            /// A direction that light comes from, drawn about in proportion to the reflector's value times cos θ.
            ///
            /// @param view 3 numbers, above the surface
            /// @param random 3 numbers in [0, 1)
            /// @return as spectral_reflector_evaluate; RANGE also for a view that is not above the surface and numbers outside [0, 1)
            [<spectral_reflector_sample_ $R>] = sample(
                reflector: *const SpectralReflector<$R>,
                view: *const $R,
                random: *const $R,
                found: *mut SpectralSample<$R>,
            );

            /// The density of spectral_reflector_sample in 1/sr; 0 where a direction is not above the surface.
            ///
            /// @param light, view 3 numbers each
            /// @return as spectral_reflector_evaluate
            [<spectral_reflector_pdf_ $R>] = pdf(
                reflector: *const SpectralReflector<$R>,
                light: *const $R,
                view: *const $R,
                value: *mut $R,
            );

            /// The part of light from a direction that is reflected, ∫ f cos θ dω; 0 where it is not above the surface.
            ///
            /// @param view 3 numbers
            /// @return as spectral_reflector_evaluate
            [<spectral_reflector_albedo_ $R>] = albedo(reflector: *const SpectralReflector<$R>, view: *const $R, value: *mut $R);

            /// Schlick's approximation ρ + (1 − ρ)(1 − cos θ)⁵ of Fresnel's formulae.
            ///
            /// @param reflectance at normal incidence, in [0, 1]
            /// @param cosine of the angle of incidence, in [0, 1]
            /// @return NULL, MISALIGNED, NOT_FINITE, RANGE
            [<spectral_fresnel_schlick_ $R>] = schlick(reflectance: $R, cosine: $R, value: *mut $R);

            /// Reflectance of a boundary of transparent media, for unpolarised light.
            ///
            /// @param cosine of the angle of incidence, in [0, 1]
            /// @param eta the index behind the boundary relative to the one before it, above 0
            /// @param[out] reflectance 1 for total reflection
            /// @param[out] refracted the cosine of the angle of refraction; 0 for total reflection
            /// @return NULL, MISALIGNED, NOT_FINITE, RANGE
            [<spectral_fresnel_dielectric_ $R>] = dielectric(
                cosine: $R,
                eta: $R,
                reflectance: *mut $R,
                refracted: *mut $R,
            );

            /// Reflectance of a metal of relative index n + i k, for unpolarised light.
            ///
            /// @param cosine of the angle of incidence, in [0, 1]
            /// @param n above 0
            /// @param k not negative
            /// @return NULL, MISALIGNED, NOT_FINITE, RANGE
            [<spectral_fresnel_conductor_ $R>] = conductor(cosine: $R, n: $R, k: $R, reflectance: *mut $R);
        }
    } pub use [<exports_ $R>]::*; }};
}
exports!(f32);
exports!(f64);
