//! Schlick's reflectance model.

use super::antithetic::{self, Lobe, Side};
use super::direction::{above, half_slope};
use super::mixture::Mixture;
use super::{Brdf, BrdfError, Sample};
use crate::Real;

/// The roughness and isotropy of Schlick's single-layer model (C. Schlick, *An Inexpensive BRDF Model for Physically-based
/// Rendering*, Computer Graphics Forum 13(3), 1994), whose spectral and geometric terms Iehl and Péroche (2000, §3.1) use.
///
/// The BRDF is S(u) D(t, v, v′, w) in 1/sr with S(u) = C + (1 − C)(1 − u)⁵ and cosines t (normal and half vector), u (light and half
/// vector), v and v′ (normal and the two directions), w (tangent and projected half vector). The geometric term is
/// D = a/π + b B/(4π v v′) + c δ/…: b = 4r(1 − r), and the rest 1 − b is ideal specular (c) for r < ½, Lambertian (a)
/// for r ≥ ½ (equation 31 and below). B = G(v) G(v′) Z(t) A(w), with Smith's shadowing in Schlick's approximation: what is shadowed is
/// lost. (Schlick's second version sends it out again diffusely, and then reflects up to 1.4 times what it receives.)
///
/// With C = 1 the model reflects at most what it receives for v ≥ 0.1, and up to 1.06 times that nearer to grazing for r ≤ 0.1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schlick<R> {
    roughness: R,
    isotropy: R,
}

impl<R: Real> Schlick<R> {
    /// A model with roughness r in [0, 1] (0 specular, 1 diffuse) and isotropy p in (0, 1] (1 isotropic).
    ///
    /// # Errors
    /// [`BrdfError::Roughness`] and [`BrdfError::Isotropy`] outside.
    pub fn new(roughness: R, isotropy: R) -> Result<Self, BrdfError> {
        if !(roughness >= R::ZERO && roughness <= R::ONE) {
            return Err(BrdfError::Roughness);
        }
        if !(isotropy > R::ZERO && isotropy <= R::ONE) {
            return Err(BrdfError::Isotropy);
        }
        Ok(Self { roughness, isotropy })
    }

    /// The roughness.
    pub const fn roughness(&self) -> R {
        self.roughness
    }

    /// The isotropy.
    pub const fn isotropy(&self) -> R {
        self.isotropy
    }

    /// The weights of the Lambertian, the glossy and the ideal specular part, which add up to 1.
    pub fn weights(&self) -> [R; 3] {
        let glossy = R::from_f64(4.0) * self.roughness * (R::ONE - self.roughness);
        let rest = R::ONE - glossy;
        if self.roughness < R::HALF { [R::ZERO, glossy, rest] } else { [rest, glossy, R::ZERO] }
    }

    /// The Lambertian and glossy parts of D in 1/sr, for cosines t, v, v′ in [0, 1] and w in [−1, 1]; 0 where v or v′ is not positive.
    ///
    /// Symmetric in v and v′, to the bit. At most about 1/(4π r² p^½ v v′).
    pub fn geometric(&self, t: R, v: R, v_prime: R, w: R) -> R {
        if !(v > R::ZERO && v_prime > R::ZERO) {
            return R::ZERO;
        }
        let [diffuse, glossy, _] = self.weights();
        let mut sum = diffuse / R::PI;
        if glossy > R::ZERO {
            let shadowing = self.shadowing(v) * self.shadowing(v_prime);
            let below = R::from_f64(4.0) * R::PI * (v * v_prime);
            sum += glossy * shadowing * self.zenith(t) * self.azimuth(w) / below;
        }
        sum
    }

    /// Smith's shadowing as Schlick has it: G(v) = v / (r − r v + v).
    fn shadowing(&self, v: R) -> R {
        v / (self.roughness - self.roughness * v + v)
    }

    /// Z(t) = r / (1 + r t² − t²)².
    fn zenith(&self, t: R) -> R {
        let t2 = t * t;
        let below = (R::ONE - t2).max(R::ZERO) + self.roughness * t2;
        self.roughness / (below * below)
    }

    /// A(w) = √(p / (p² − p² w² + w²)).
    fn azimuth(&self, w: R) -> R {
        let (p2, w2) = (self.isotropy * self.isotropy, w * w);
        (self.isotropy / (p2 - p2 * w2 + w2)).sqrt()
    }
}

/// The glossy part of D for b = 1, B/(4π v v′).
struct Gloss<R> {
    roughness: R,
    isotropy: R,
}

impl<R: Real> Gloss<R> {
    /// G(v)/v = 1/(r − r v + v).
    #[inline]
    fn unshadowed(&self, cosine: R) -> R {
        R::ONE / (self.roughness * (R::ONE - cosine) + cosine)
    }

    /// A as a function of the half vector's azimuth, a unit vector.
    #[inline]
    fn azimuth(&self, [cos, sin]: [R; 2]) -> R {
        let p = self.isotropy;
        (p / (p * p * sin * sin + cos * cos)).sqrt()
    }

    /// How much likelier an azimuth is drawn than uniformly: √p/(cos²φ + p sin²φ), which is A or more.
    #[inline]
    fn preference(&self, [cos, sin]: [R; 2]) -> R {
        self.isotropy.sqrt() / (cos * cos + self.isotropy * sin * sin)
    }
}

impl<R: Real> Lobe<R> for Gloss<R> {
    fn stretch(&self) -> [R; 2] {
        [self.isotropy.sqrt(), R::ONE]
    }

    fn spread(&self, _length: R) -> R {
        self.roughness.sqrt()
    }

    /// Of Z: ε²/(r + ε²).
    fn cumulative(&self, y: R) -> R {
        if y > R::ZERO { R::ONE / (R::ONE + R::ONE / (y * y)) } else { R::ZERO }
    }

    fn quantile(&self, p: R) -> R {
        (p / (R::ONE - p)).sqrt()
    }

    fn complement(&self, y: R) -> R {
        R::ONE / (R::ONE + y * y)
    }

    fn density(&self, azimuth: [R; 2], complement: R) -> R {
        self.preference(azimuth) * complement / (R::PI * self.roughness) * complement
    }

    fn weight(&self, side: &Side<R>, view_z: R, azimuth: [R; 2]) -> R {
        let rise = side.height * side.secant2 * R::HALF;
        let shadowing = side.light_z * self.unshadowed(side.light_z) * self.unshadowed(view_z);
        shadowing * rise * (self.azimuth(azimuth) / self.preference(azimuth))
    }

    fn chart(&self, y: R) -> R {
        y.atan()
    }

    fn unchart(&self, x: R) -> (R, R) {
        let (sin, cos) = (x.sin(), x.cos());
        (sin / cos, R::TWO * sin * cos)
    }
}

impl<R: Real> Brdf<R> for Gloss<R> {
    fn evaluate(&self, light: [R; 3], view: [R; 3]) -> R {
        let (Some(light), Some(view)) = (above(light), above(view)) else { return R::ZERO };
        let ([x, y], _) = half_slope(light, view);
        let epsilon = x.hypot(y);
        let azimuth = if epsilon > R::ZERO { [x / epsilon, y / epsilon] } else { [R::ZERO, R::ONE] };
        let scaled = epsilon / self.roughness.sqrt();
        let complement = self.complement(scaled);
        if !(complement > R::ZERO) {
            return R::ZERO;
        }
        // Z = (1 + ε²)²/(r (1 + ε²/r)²).
        let ratio = (R::ONE + epsilon * epsilon) * complement;
        let zenith = ratio / self.roughness * ratio;
        let shadowing = self.unshadowed(light[2]) * self.unshadowed(view[2]);
        (shadowing * zenith * self.azimuth(azimuth) / (R::from_f64(4.0) * R::PI)).min(R::MAX)
    }

    fn sample(&self, view: [R; 3], u: [R; 3]) -> Option<Sample<R>> {
        antithetic::sample(self, view, u)
    }

    fn pdf(&self, light: [R; 3], view: [R; 3]) -> R {
        antithetic::pdf(self, light, view)
    }

    fn invert(&self, light: [R; 3], view: [R; 3]) -> Option<[R; 3]> {
        antithetic::invert(self, light, view)
    }

    fn albedo(&self, view: [R; 3]) -> R {
        antithetic::albedo(self, view)
    }
}

impl<R: Real> Schlick<R> {
    /// The Lambertian and the glossy part as a sum; no glossy part where its lobe is narrower than numbers can tell.
    fn with_mixture<T>(&self, then: impl FnOnce(Mixture<'_, R, Gloss<R>>) -> T) -> T {
        let [diffuse, glossy, _] = self.weights();
        let specular = if self.roughness > R::EPSILON { glossy } else { R::ZERO };
        let model = &Gloss { roughness: self.roughness, isotropy: self.isotropy.max(R::EPSILON) };
        then(Mixture { diffuse, specular, model })
    }
}

/// The Lambertian and the glossy part; the ideal specular one is a separate ray's, with [`Schlick::weights`].
///
/// The spectral term S(u) isn't included. Sampled by the Lambertian part and by antithetic half vectors from Z (and an
/// azimuth that A prefers); a model that is only specular (r ≤ ε) is sampled as a diffuse one, with weight 0. An isotropy
/// below ε counts as ε here. The albedo is by quadrature, within 10⁻⁴, absolutely.
impl<R: Real> Brdf<R> for Schlick<R> {
    fn evaluate(&self, light: [R; 3], view: [R; 3]) -> R {
        self.with_mixture(|m| m.evaluate(light, view))
    }

    fn sample(&self, view: [R; 3], u: [R; 3]) -> Option<Sample<R>> {
        self.with_mixture(|m| m.sample(view, u))
    }

    fn pdf(&self, light: [R; 3], view: [R; 3]) -> R {
        self.with_mixture(|m| m.pdf(light, view))
    }

    fn invert(&self, light: [R; 3], view: [R; 3]) -> Option<[R; 3]> {
        self.with_mixture(|m| m.invert(light, view))
    }

    fn albedo(&self, view: [R; 3]) -> R {
        self.with_mixture(|m| m.albedo(view))
    }
}

#[cfg(test)]
mod tests {
    use super::{BrdfError, Schlick};

    /// What the rounding of each of the quadrature's 80 000 terms can add up to.
    const ROUNDING: f64 = 80_000.0 * f64::EPSILON;

    /// Albedo of the non-specular parts by midpoint quadrature over the hemisphere.
    fn albedo(model: &Schlick<f64>, v: f64) -> f64 {
        let (steps, around) = (400, 200);
        let view = [(1.0 - v * v).sqrt(), 0.0, v];
        let mut sum = 0.0;
        for i in 0..steps {
            for j in 0..around {
                let u = (f64::from(i) + 0.5) / f64::from(steps);
                let phi = core::f64::consts::TAU * (f64::from(j) + 0.5) / f64::from(around);
                // Equal parts of projected solid angle.
                let sine = libm::sqrt(u);
                let light = [sine * libm::cos(phi), sine * libm::sin(phi), libm::sqrt(1.0 - u)];
                let half: [f64; 3] = core::array::from_fn(|a| view[a] + light[a]);
                let length = libm::sqrt(half.iter().map(|h| h * h).sum());
                let t = half[2] / length;
                let across = libm::hypot(half[0], half[1]);
                let w = if across > 0.0 { half[0] / across } else { 0.0 };
                sum += model.geometric(t, v, light[2], w);
            }
        }
        sum * core::f64::consts::PI / f64::from(steps * around)
    }

    #[test]
    fn loses_no_more_than_it_receives() {
        for r in [0.1, 0.3, 0.5, 0.8, 1.0] {
            let model = Schlick::<f64>::new(r, 1.0).unwrap();
            let [diffuse, glossy, specular] = model.weights();
            assert!((diffuse + glossy + specular - 1.0).abs() <= 1e-15);
            for v in [0.2, 0.5, 0.9, 1.0] {
                let reflected = albedo(&model, v) + specular;
                assert!(reflected <= 1.0 + ROUNDING && reflected > 0.4, "r {r} v {v}: {reflected}");
            }
        }
        let lambert = Schlick::<f64>::new(1.0, 1.0).unwrap();
        assert!((albedo(&lambert, 0.4) - 1.0).abs() <= ROUNDING);
    }

    #[test]
    fn is_reciprocal_and_refuses_what_is_outside() {
        let model = Schlick::new(0.3_f32, 0.4).unwrap();
        assert_eq!(model.geometric(0.9, 0.3, 0.8, 0.2), model.geometric(0.9, 0.8, 0.3, 0.2));
        assert_eq!(Schlick::new(f64::NAN, 1.0), Err(BrdfError::Roughness));
        assert_eq!(Schlick::new(0.5, 0.0), Err(BrdfError::Isotropy));
        assert_eq!(model.geometric(0.5, 0.0, 0.5, 0.0), 0.0);
    }
}
