//! Reflectance models: values, densities and samples from the vectors themselves.

use spectral_core::Real;
use spectral_core::brdf::{Brdf, Glossy, Lambert, Sample, Schlick, Variant, Ward, direction as unit_vector};

use crate::accuracy::gauge::{Axis, Gauge};
use crate::accuracy::wide::{Wide, dot, wide, wides};

type Vector = [Wide; 3];

/// A unit vector by its polar and azimuthal angle, rounded.
pub(super) fn direction<R: Real>(polar: R, azimuth: R) -> [R; 3] {
    [polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos()]
}

/// Polar angles up to 89.9° of both directions, and azimuths.
fn directions() -> [Axis; 4] {
    let polar = |name| Axis::linear(name, 0.0, 1.569).list(&[0.5]).edges(&[1.0]);
    let azimuth = |name| Axis::linear(name, -3.14, 3.14).list(&[0.0, 1.5]);
    [polar("θ_l"), azimuth("φ_l"), polar("θ_v"), azimuth("φ_v")]
}

fn normalized(v: Vector) -> Vector {
    let length = dot(v, v).sqrt();
    v.map(|x| x / length)
}

/// A distribution of slopes and a reflectance, from the models' definitions.
pub(super) enum Model {
    /// Variant, α, β.
    Ward(Variant, Wide, Wide),
    /// r, p of Schlick's glossy part for b = 1.
    Gloss(Wide, Wide),
}

/// A half vector and what belongs to it.
pub(super) struct Half {
    slope: [Wide; 2],
    light: Vector,
    view: Vector,
}

impl Half {
    fn new(light: Vector, view: Vector) -> Self {
        let height = light[2] + view[2];
        Self { slope: [(light[0] + view[0]) / height, (light[1] + view[1]) / height], light, view }
    }

    /// The view reflected about the normal of a slope.
    pub(super) fn reflected(slope: [Wide; 2], view: Vector) -> Self {
        let secant2 = slope[0].squared() + slope[1].squared() + 1.0;
        let rise = (dot([slope[0], slope[1], Wide::ONE], view) * 2.0) / secant2;
        Self { slope, light: [rise * slope[0] - view[0], rise * slope[1] - view[1], rise - view[2]], view }
    }

    fn secant2(&self) -> Wide {
        self.slope[0].squared() + self.slope[1].squared() + 1.0
    }

    /// Density of lights per steradian from that of slopes: dω_h = cos³δ ds, dω_l = 4 (v·h) dω_h, v·h = (l_z + v_z)/(2 cos δ).
    fn per_steradian(&self) -> Wide {
        self.secant2() / ((self.light[2] + self.view[2]) * 2.0)
    }
}

impl Model {
    /// By how much an error of the arguments grows in the kernel.
    fn growth(&self, half: &Half) -> Wide {
        match self {
            Self::Ward(_, a, b) => (half.slope[0] / *a).squared() + (half.slope[1] / *b).squared() + 1.0,
            Self::Gloss(..) => Wide::ONE,
        }
    }

    /// How a circle of uniform azimuths is stretched.
    pub(super) fn stretch(&self) -> [Wide; 2] {
        match self {
            Self::Ward(_, a, b) => [*a, *b],
            Self::Gloss(_, p) => [p.sqrt(), Wide::ONE],
        }
    }

    /// A coordinate of finite range for a slope's length along an azimuth whose stretched length is given.
    pub(super) fn chart(&self, epsilon: Wide, length: Wide) -> Wide {
        match self {
            Self::Ward(..) => (epsilon / length).min(Wide::from(7.0)),
            Self::Gloss(r, _) => (epsilon / r.sqrt()).atan(),
        }
    }

    /// The length for the coordinate, and the probability's derivative by it.
    pub(super) fn unchart(&self, x: Wide, length: Wide) -> (Wide, Wide) {
        match self {
            Self::Ward(..) => (x * length, x * 2.0 * (-x.squared()).exp()),
            Self::Gloss(r, _) => {
                let (sin, cos) = x.sin_cos();
                (r.sqrt() * sin / cos, sin * cos * 2.0)
            }
        }
    }

    /// P(s).
    fn density(&self, [x, y]: [Wide; 2]) -> Wide {
        match self {
            Self::Ward(_, a, b) => (-((x / *a).squared() + (y / *b).squared())).exp() / (Wide::PI * *a * *b),
            Self::Gloss(r, p) => {
                // Azimuths by √p/(2π (cos² + p sin²)) in the frame where x is the short one, ε² by r/(r + ε²)².
                let square = x.squared() + y.squared();
                let preference =
                    if square == 0.0 { 1.0 / p.sqrt() } else { p.sqrt() * square / (x.squared() + *p * y.squared()) };
                preference * *r / ((*r + square).squared() * Wide::PI)
            }
        }
    }

    /// f.
    fn value(&self, half: &Half) -> Wide {
        let (l, v) = (half.light[2], half.view[2]);
        match self {
            Self::Ward(variant, ..) => {
                let kernel = self.density(half.slope);
                match variant {
                    Variant::Ward => kernel / ((l * v).sqrt() * 4.0),
                    Variant::WardDuer => kernel / (l * v * 4.0),
                    Variant::WardNeumann => kernel / (l.max(v) * 4.0),
                    Variant::Balanced => kernel * half.secant2() / (l + v).squared(),
                }
            }
            Self::Gloss(r, p) => {
                // G(v) G(v′) Z(t) A(w)/(4π v v′) with t² = 1/(1 + ε²).
                let shadow = |c: Wide| 1.0 / (*r - *r * c + c);
                let square = half.secant2() - 1.0;
                let t2 = 1.0 / half.secant2();
                let zenith = *r / (1.0 + *r * t2 - t2).squared();
                let w2 = if square == 0.0 { Wide::ZERO } else { half.slope[0].squared() / square };
                let azimuth = (*p / (p.squared() - p.squared() * w2 + w2)).sqrt();
                shadow(l) * shadow(v) * zenith * azimuth / (Wide::PI * 4.0)
            }
        }
    }

    /// f cos θ over the density of the half vector's method; 0 below the horizon.
    pub(super) fn weight(&self, half: &Half) -> Wide {
        if half.light[2] <= 0.0 {
            return Wide::ZERO;
        }
        self.value(half) * half.light[2] / (self.density(half.slope) * half.per_steradian())
    }

    /// The probability of slopes along one azimuth up to a length.
    fn cumulative(&self, [x, y]: [Wide; 2], length: Wide) -> Wide {
        match self {
            Self::Ward(_, a, b) => -(-(((x / *a).squared() + (y / *b).squared()) * length.squared())).exp_m1(),
            Self::Gloss(r, _) => length.squared() / (*r + length.squared()),
        }
    }

    /// The share of slopes within the farther horizon, the chance of this slope rather than its mirror image, and both weights' sum.
    fn choice(&self, half: &Half) -> [Wide; 3] {
        let (x, y) = (half.slope[0], half.slope[1]);
        let length = x.hypot(y);
        let azimuth = if length == 0.0 { [Wide::ONE, Wide::ZERO] } else { [x / length, y / length] };
        let along = (azimuth[0] * half.view[0] + azimuth[1] * half.view[1]).abs();
        let horizon = (along + along.hypot(half.view[2])) / half.view[2];
        // Both as the slope reflects them: near the horizon the light itself isn't that, by the rounding of both directions' lengths.
        let side = |slope: [Wide; 2]| self.weight(&Half::reflected(slope, half.view));
        let (this, other) = (side([x, y]), side([-x, -y]));
        [self.cumulative(azimuth, horizon), this / (this + other), this + other]
    }

    fn pdf(&self, half: &Half) -> Wide {
        let [share, chance, _] = self.choice(half);
        self.density(half.slope) * half.per_steradian() * chance * 2.0 / share
    }

    /// The slope of random numbers; `within` the farther horizon or anywhere.
    fn slope(&self, view: Vector, u: [Wide; 2], within: bool) -> [Wide; 2] {
        let (sin, cos) = (u[1] * Wide::PI * 2.0).sin_cos();
        let (x, y) = match self {
            Self::Ward(_, a, b) => (*a * cos, *b * sin),
            Self::Gloss(_, p) => (p.sqrt() * cos, sin),
        };
        let length = x.hypot(y);
        let azimuth = [x / length, y / length];
        let along = (azimuth[0] * view[0] + azimuth[1] * view[1]).abs();
        let horizon = (along + along.hypot(view[2])) / view[2];
        let share = if within { self.cumulative(azimuth, horizon) } else { Wide::ONE };
        let p = u[0] * share;
        let y = match self {
            Self::Ward(..) => (-(1.0 - p).ln()).sqrt() * length,
            Self::Gloss(r, _) => (p / (1.0 - p) * *r).sqrt(),
        };
        [azimuth[0] * y, azimuth[1] * y]
    }
}

pub(super) fn wards<R: Real>(mut each: impl FnMut(Ward<R>, Model)) {
    for variant in Variant::ALL {
        for [a, b] in [[0.1, 0.1], [0.02, 0.3], [1.0, 0.5]] {
            let (a, b) = (R::from_f64(a), R::from_f64(b));
            if let Ok(ward) = Ward::new(variant, a, b) {
                each(ward, Model::Ward(variant, wide(a), wide(b)));
            }
        }
    }
}

const WARDS: &str = "all variants; α, β = 0.1, 0.1; 0.02, 0.3; 1, 0.5";

/// Half vectors whose kernel is above e⁻⁶⁰, from a view and a light near its mirror direction or anywhere.
fn each_pair<R: Real>(gauge: &mut Gauge, model: &Model, mut measure: impl FnMut(&mut Gauge, [R; 3], [R; 3], &Half)) {
    gauge.effort(0.25);
    gauge.each(&directions(), |gauge, [polar, azimuth, tilt, turn]: [R; 4]| {
        let view = direction(tilt, turn);
        let mirror = [-view[0], -view[1], view[2]];
        let near = R::from_f64(0.05);
        let aside = direction(polar, azimuth);
        let lights = [aside, normalize(core::array::from_fn(|i| mirror[i] + near * aside[i]))];
        for light in lights {
            let half = Half::new(wides(light), wides(view));
            if light[2] > R::ZERO && model.growth(&half) < 60.0 {
                measure(gauge, light, view, &half);
            }
        }
    });
}

fn normalize<R: Real>(v: [R; 3]) -> [R; 3] {
    unit_vector(v).unwrap_or([R::ZERO, R::ZERO, R::ONE])
}

/// Ward's family.
pub fn ward_evaluate<R: Real>(gauge: &mut Gauge) {
    gauge.note(WARDS);
    wards(|ward: Ward<R>, model| {
        each_pair(gauge, &model, |gauge, light, view, half| {
            let exact = model.value(half);
            gauge.compare_to(ward.evaluate(light, view), exact, exact * model.growth(half));
        });
    });
}

/// Equation 2.26 for the very angles.
pub fn ward_trigonometric<R: Real>(gauge: &mut Gauge) {
    gauge.note(WARDS);
    wards(|ward: Ward<R>, model| {
        gauge.effort(0.25);
        gauge.each(&directions(), |gauge, [polar, azimuth, tilt, turn]: [R; 4]| {
            let exact = |polar: R, azimuth: R| {
                let ((s, c), (sin, cos)) = (wide(polar).sin_cos(), wide(azimuth).sin_cos());
                [s * cos, s * sin, c]
            };
            let half = Half::new(exact(polar, azimuth), exact(tilt, turn));
            if model.growth(&half) < 60.0 {
                let value = model.value(&half);
                gauge.compare_to(
                    ward.trigonometric([polar, azimuth], [tilt, turn]),
                    value,
                    value * model.growth(&half),
                );
            }
        });
    });
}

/// The density of Ward's own method.
pub fn ward_half_vector_pdf<R: Real>(gauge: &mut Gauge) {
    gauge.note(WARDS);
    wards(|ward: Ward<R>, model| {
        each_pair(gauge, &model, |gauge, light, view, half| {
            let exact = model.density(half.slope) * half.per_steradian();
            gauge.compare_to(ward.half_vector_pdf(light, view), exact, exact * model.growth(half));
        });
    });
}

/// The density of antithetic half vectors.
pub fn ward_pdf<R: Real>(gauge: &mut Gauge) {
    gauge.note(WARDS);
    wards(|ward: Ward<R>, model| {
        each_pair(gauge, &model, |gauge, light, view, half| {
            let exact = model.pdf(half);
            gauge.compare_to(ward.pdf(light, view), exact, exact * model.growth(half));
        });
    });
}

fn numbers() -> [Axis; 5] {
    let number = |name| Axis::linear(name, 0.0, 0.999).list(&[0.25, 0.5]);
    let [polar, azimuth, ..] = directions();
    [number("u₀"), number("u₁"), number("u₂"), polar, azimuth]
}

/// Compares a sample with that of the exact slope: its direction, absolutely.
fn compare_sample<R: Real>(gauge: &mut Gauge, sample: Option<Sample<R>>, half: &Half) {
    let Some(sample) = sample else { return gauge.require(false) };
    for (got, exact) in sample.direction.into_iter().zip(half.light) {
        gauge.compare_to(got, exact, Wide::from(0.75));
    }
}

/// Samples of antithetic half vectors; numbers that rounding may turn to the mirror image are left out.
fn measure_samples<R: Real, B: Brdf<R>>(gauge: &mut Gauge, brdf: &B, model: &Model) {
    gauge.effort(0.25);
    gauge.each(&numbers(), |gauge, [a, b, c, tilt, turn]: [R; 5]| {
        let view = direction(tilt, turn);
        let slope = model.slope(wides(view), [wide(a), wide(b)], true);
        let half = Half::reflected(slope, wides(view));
        let [_, chance, _] = model.choice(&half);
        let clear = (chance - wide(c)).abs().to_f64() > 1e4 * R::EPSILON.to_f64();
        if clear {
            let half = if wide(c) < chance { half } else { Half::reflected(slope.map(|x| -x), wides(view)) };
            compare_sample(gauge, brdf.sample(view, [a, b, c]), &half);
        }
    });
}

/// Directions by antithetic half vectors.
pub fn ward_sample<R: Real>(gauge: &mut Gauge) {
    gauge.note(WARDS);
    wards(|ward: Ward<R>, model| measure_samples(gauge, &ward, &model));
}

/// Directions by Ward's own method.
pub fn ward_sample_half_vector<R: Real>(gauge: &mut Gauge) {
    gauge.note(WARDS);
    wards(|ward: Ward<R>, model| {
        gauge.effort(0.25);
        gauge.each(&numbers(), |gauge, [a, b, _, tilt, turn]: [R; 5]| {
            let view = direction(tilt, turn);
            let half = Half::reflected(model.slope(wides(view), [wide(a), wide(b)], false), wides(view));
            // Within rounding of the horizon either answer will do.
            if half.light[2] > 1e-4 {
                compare_sample(gauge, ward.sample_half_vector(view, [a, b]), &half);
            } else if half.light[2] < -1e-4 {
                gauge.require(ward.sample_half_vector(view, [a, b]).is_none());
            }
        });
    });
}

/// Numbers that come back as the light, through the exact sample of them.
fn measure_inverse<R: Real, B: Brdf<R>>(gauge: &mut Gauge, brdf: &B, model: &Model) {
    each_pair(gauge, model, |gauge, light: [R; 3], view, half| {
        let Some([a, b, _]) = brdf.invert(light, view) else { return gauge.require(false) };
        // Numbers near 1 can't tell slopes in the tail apart.
        if model.growth(half) < 4.0 && a < R::from_f64(0.9) {
            let slope = model.slope(wides(view), [wide(a), wide(b)], true);
            let light = normalized(wides(light));
            let back = Half::reflected(slope, normalized(wides(view))).light;
            let off = (0..3).fold(Wide::ZERO, |m, i| m.max((back[i] - light[i]).abs()));
            // Near the horizon a slope has the error of the directions over their cosines.
            gauge.record((off * light[2].min(wide(view[2]))).to_f64() / R::EPSILON.to_f64());
        }
    });
}

/// Numbers of a light.
pub fn ward_invert<R: Real>(gauge: &mut Gauge) {
    gauge.note(WARDS);
    wards(|ward: Ward<R>, model| measure_inverse(gauge, &ward, &model));
}

/// Lambert's 1/π.
pub fn lambert_evaluate<R: Real>(gauge: &mut Gauge) {
    gauge.each(&directions(), |gauge, [polar, azimuth, tilt, turn]: [R; 4]| {
        let got: R = Lambert.evaluate(direction(polar, azimuth), direction(tilt, turn));
        gauge.compare(got, 1.0 / Wide::PI);
    });
}

/// cos θ/π.
pub fn lambert_pdf<R: Real>(gauge: &mut Gauge) {
    gauge.each(&directions(), |gauge, [polar, azimuth, tilt, turn]: [R; 4]| {
        let light = direction(polar, azimuth);
        gauge.compare(Lambert.pdf(light, direction(tilt, turn)), wide(light[2]) / Wide::PI);
    });
}

/// √u₀ (cos, sin) 2πu₁, √(1 − u₀).
pub fn lambert_sample<R: Real>(gauge: &mut Gauge) {
    gauge.each(&numbers(), |gauge, [a, b, c, tilt, turn]: [R; 5]| {
        let Some(sample) = Lambert.sample(direction(tilt, turn), [a, b, c]) else { return gauge.require(false) };
        let ((sin, cos), radius) = ((wide(b) * Wide::PI * 2.0).sin_cos(), wide(a).sqrt());
        for (got, exact) in sample.direction.into_iter().zip([radius * cos, radius * sin, (1.0 - wide(a)).sqrt()]) {
            gauge.compare_to(got, exact, Wide::from(0.75));
        }
    });
}

/// The same, back.
pub fn lambert_invert<R: Real>(gauge: &mut Gauge) {
    gauge.each(&directions(), |gauge, [polar, azimuth, tilt, turn]: [R; 4]| {
        let light = direction(polar, azimuth);
        let Some([a, b, _]) = Lambert.invert(light, direction(tilt, turn)) else { return gauge.require(false) };
        let [x, y, _] = wides(light);
        let angle = y.atan2(x) / (Wide::PI * 2.0);
        gauge.compare_to(a, x.squared() + y.squared(), Wide::from(0.75));
        gauge.compare_to(b, if angle < 0.0 { angle + 1.0 } else { angle }, Wide::from(0.75));
    });
}

/// Schlick's models: the parameters in R, and the exact shares.
pub(super) fn schlicks<R: Real>(mut each: impl FnMut(Schlick<R>, Model, [Wide; 2])) {
    for [r, p] in [[0.02, 1.0], [0.1, 0.5], [0.3, 0.2], [0.5, 1.0], [0.8, 0.7], [1.0, 1.0]] {
        let (r, p) = (R::from_f64(r), R::from_f64(p));
        if let Ok(model) = Schlick::new(r, p) {
            let glossy = wide(r) * (1.0 - wide(r)) * 4.0;
            let diffuse = if wide(r) < 0.5 { Wide::ZERO } else { 1.0 - glossy };
            each(model, Model::Gloss(wide(r), wide(p)), [diffuse, glossy]);
        }
    }
}

const SCHLICKS: &str = "r, p = 0.02, 1; 0.1, 0.5; 0.3, 0.2; 0.5, 1; 0.8, 0.7; 1, 1";

/// Lambertian and glossy part.
pub fn schlick_evaluate<R: Real>(gauge: &mut Gauge) {
    gauge.note(SCHLICKS);
    schlicks(|schlick: Schlick<R>, model, [diffuse, glossy]| {
        each_pair(gauge, &model, |gauge, light, view, half| {
            let exact = diffuse / Wide::PI + glossy * model.value(half);
            gauge.compare(schlick.evaluate(light, view), exact);
        });
    });
}

/// The mixture's density.
pub fn schlick_pdf<R: Real>(gauge: &mut Gauge) {
    gauge.note(SCHLICKS);
    gauge.note("but for slope 0, where densities depend on the azimuth");
    schlicks(|schlick: Schlick<R>, model, [diffuse, glossy]| {
        each_pair(gauge, &model, |gauge, light, view, half| {
            if half.secant2() == 1.0 {
                return;
            }
            let total = diffuse + glossy;
            let gloss = if glossy == 0.0 { Wide::ZERO } else { glossy * model.pdf(half) };
            gauge.compare(schlick.pdf(light, view), (diffuse * half.light[2] / Wide::PI + gloss) / total);
        });
    });
}

/// Directions of the glossy part, where there is no other.
pub fn schlick_sample<R: Real>(gauge: &mut Gauge) {
    gauge.note("r, p = 0.02, 1; 0.1, 0.5; 0.3, 0.2");
    schlicks(|schlick: Schlick<R>, model, [diffuse, _]| {
        if diffuse == 0.0 && schlick.roughness() < R::HALF {
            measure_samples(gauge, &schlick, &model);
        }
    });
}

/// Numbers of a light, where there is only the glossy part.
pub fn schlick_invert<R: Real>(gauge: &mut Gauge) {
    gauge.note("r, p = 0.02, 1; 0.1, 0.5; 0.3, 0.2");
    schlicks(|schlick: Schlick<R>, model, [diffuse, _]| {
        if diffuse == 0.0 && schlick.roughness() < R::HALF {
            measure_inverse(gauge, &schlick, &model);
        }
    });
}

/// 4r(1 − r) and the rest.
pub fn schlick_weights<R: Real>(gauge: &mut Gauge) {
    let axis = Axis::linear("r", 0.0, 1.0).edges(&[0.5]);
    gauge.each(&[axis], |gauge, [r]: [R; 1]| {
        let Ok(model) = Schlick::new(r, R::ONE) else { return gauge.require(false) };
        let glossy = wide(r) * (1.0 - wide(r)) * 4.0;
        let (rest, none) = (1.0 - glossy, Wide::ZERO);
        let exact = if wide(r) < 0.5 { [none, glossy, rest] } else { [rest, glossy, none] };
        for (got, exact) in model.weights().into_iter().zip(exact) {
            gauge.compare_to(got, exact, Wide::from(0.75));
        }
    });
}

/// D of four cosines.
pub fn schlick_geometric<R: Real>(gauge: &mut Gauge) {
    let axes = [
        Axis::linear("r", 0.01, 1.0).edges(&[0.5]),
        Axis::linear("p", 0.01, 1.0),
        Axis::linear("t", 0.0, 1.0),
        Axis::linear("v", 0.001, 1.0),
        Axis::linear("v′", 0.001, 1.0),
        Axis::linear("w", -1.0, 1.0).list(&[0.0]),
    ];
    gauge.each(&axes, |gauge, [r, p, t, v, u, w]: [R; 6]| {
        let Ok(model) = Schlick::new(r, p) else { return gauge.require(false) };
        let got = model.geometric(t, v, u, w);
        let [r, p, t, v, u, w] = wides([r, p, t, v, u, w]);
        let glossy = r * (1.0 - r) * 4.0;
        let diffuse = if r < 0.5 { Wide::ZERO } else { 1.0 - glossy };
        let shadow = |c: Wide| c / (r - r * c + c);
        let zenith = r / (1.0 + r * t * t - t * t).squared();
        let azimuth = (p / (p * p - p * p * w * w + w * w)).sqrt();
        let part = glossy * shadow(v) * shadow(u) * zenith * azimuth / (v * u * 4.0 * Wide::PI);
        // Towards t = 1 the error is that of 1 − t² over r.
        let exact = diffuse / Wide::PI + part;
        gauge.compare_to(got, exact, exact + part / r + 1.0 / Wide::PI);
    });
}

/// A coat over a body.
pub(super) fn glossy<R: Real>() -> Option<(Glossy<R>, Model, [Wide; 2])> {
    let [diffuse, specular, alpha] = [0.3, 0.5, 0.2].map(R::from_f64);
    let ward = Ward::new(Variant::Balanced, alpha, alpha).ok()?;
    let model = Model::Ward(Variant::Balanced, wide(alpha), wide(alpha));
    Some((Glossy::new(diffuse, specular, ward).ok()?, model, wides([diffuse, specular])))
}

const GLOSSY: &str = "balanced, α = 0.2, ρ_d = 0.3, ρ_s = 0.5";

/// ρ_d/π + ρ_s f.
pub fn glossy_evaluate<R: Real>(gauge: &mut Gauge) {
    gauge.note(GLOSSY);
    let Some((glossy, model, [diffuse, specular])) = glossy::<R>() else { return gauge.require(false) };
    each_pair(gauge, &model, |gauge, light, view, half| {
        let coat = specular * model.value(half);
        let exact = diffuse / Wide::PI + coat;
        gauge.compare_to(glossy.evaluate(light, view), exact, exact + coat * model.growth(half));
    });
}

/// The mixture's density.
pub fn glossy_pdf<R: Real>(gauge: &mut Gauge) {
    gauge.note(GLOSSY);
    let Some((glossy, model, [diffuse, specular])) = glossy::<R>() else { return gauge.require(false) };
    each_pair(gauge, &model, |gauge, light, view, half| {
        let (coat, total) = (specular * model.pdf(half), diffuse + specular);
        let exact = (diffuse * half.light[2] / Wide::PI + coat) / total;
        gauge.compare_to(glossy.pdf(light, view), exact, exact + coat * model.growth(half));
    });
}

/// Unit vectors of any length.
pub fn unit_direction<R: Real>(gauge: &mut Gauge) {
    let ends = if R::EPSILON.to_f64() < 1e-10 { [1e-200, 1e200] } else { [1e-30, 1e30] };
    let axes = ["x", "y", "z"].map(|name| Axis::signed(name, ends[0], ends[1]));
    gauge.each(&axes, |gauge, v: [R; 3]| {
        let [x, y, z] = wides(v);
        let length = x.hypot(y).hypot(z);
        match unit_vector(v) {
            Ok(got) => {
                for (got, exact) in got.into_iter().zip([x, y, z]) {
                    gauge.compare_to(got, exact / length, Wide::from(0.75));
                }
            }
            Err(_) => gauge.require(length == 0.0),
        }
    });
}
