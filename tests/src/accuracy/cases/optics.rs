//! Smooth boundaries and refractive indices.

use spectral_core::dispersion::{Cauchy, Dispersion, Glass, LINE_C, LINE_D, LINE_F, Sellmeier};
use spectral_core::tables::{Formula, GlassTable, glasses};
use spectral_core::{Real, fresnel};

use crate::accuracy::gauge::{Axis, Gauge};
use crate::accuracy::wide::{Wide, wide, wides};

fn cosine() -> Axis {
    Axis::linear("cos θ", -0.5, 1.5).edges(&[0.0, 1.0]).list(&[1e-8, 1e-4, 0.5])
}

fn limited(x: Wide) -> Wide {
    x.max(Wide::ZERO).min(Wide::ONE)
}

/// (1 − cos θ)⁵.
pub fn schlick_factor<R: Real>(gauge: &mut Gauge) {
    gauge.each(&[cosine()], |gauge, [c]: [R; 1]| {
        gauge.compare(fresnel::schlick_factor(c), (1.0 - limited(wide(c))).powi(5));
    });
}

fn reflectance() -> Axis {
    Axis::linear("ρ", 0.0, 1.0).list(&[0.04, 0.5])
}

fn raised(rho: Wide, factor: Wide) -> Wide {
    rho + (1.0 - rho) * factor
}

/// Schlick's approximation.
pub fn schlick<R: Real>(gauge: &mut Gauge) {
    gauge.each(&[reflectance(), cosine()], |gauge, [rho, c]: [R; 2]| {
        gauge.compare(fresnel::schlick(rho, c), raised(wide(rho), (1.0 - limited(wide(c))).powi(5)));
    });
}

fn ward_exact(cosine: Wide) -> Wide {
    limited((-(Wide::decimal("5.85") * limited(cosine))).exp() - Wide::decimal("0.00287989916"))
}

/// Ward's exponential.
pub fn ward_factor<R: Real>(gauge: &mut Gauge) {
    gauge.each(&[cosine()], |gauge, [c]: [R; 1]| {
        gauge.compare_to(fresnel::ward_factor(c), ward_exact(wide(c)), Wide::from(0.75));
    });
}

/// Ward's approximation.
pub fn ward<R: Real>(gauge: &mut Gauge) {
    gauge.each(&[reflectance(), cosine()], |gauge, [rho, c]: [R; 2]| {
        gauge.compare_to(fresnel::ward(rho, c), raised(wide(rho), ward_exact(wide(c))), Wide::from(0.75));
    });
}

/// Fresnel's formulae by Snell's law, for the reflectance and the cosine of refraction.
fn dielectric_exact(cosine: Wide, eta: Wide) -> Option<(Wide, Wide)> {
    let square = 1.0 - (1.0 - cosine.squared()) / eta.squared();
    if square <= 0.0 {
        return None;
    }
    let refracted = square.sqrt();
    let s = (cosine - eta * refracted) / (cosine + eta * refracted);
    let p = (eta * cosine - refracted) / (eta * cosine + refracted);
    Some(((s.squared() + p.squared()) * 0.5, refracted))
}

/// Media whose indices differ by 5 % and more: nearly equal ones reflect next to nothing, and nothing is known of it relatively.
pub fn dielectric<R: Real>(gauge: &mut Gauge) {
    let epsilon = R::EPSILON.to_f64();
    gauge.note("but for angles within 64 ε of total reflection in cos²");
    for eta in [Axis::linear("η", 1.05, 4.0).list(&[1.5]), Axis::linear("η", 0.25, 0.95).list(&[0.75])] {
        gauge.each(&[cosine(), eta], |gauge, [cosine, eta]: [R; 2]| {
            let c = limited(wide(cosine));
            let margin = (1.0 - (1.0 - c.squared()) / wide(eta).squared()).abs().to_f64();
            match (fresnel::dielectric(cosine, eta), dielectric_exact(c, wide(eta))) {
                (Some((got, refracted)), Some((exact, exactly))) if margin > 64.0 * epsilon => {
                    // Where the refracted ray is grazing its cosine has the error of a square root of a difference.
                    let scale = 1.0 / exactly.min(Wide::ONE);
                    gauge.compare_to(got, exact, scale);
                    gauge.compare_to(refracted, exactly, scale);
                }
                (got, exact) => gauge.require(margin <= 64.0 * epsilon || got.is_some() == exact.is_some()),
            }
        });
    }
}

/// Fresnel's formulae with a complex index, in complex arithmetic: r_s = (c − q)/(c + q), r_p = (m² c − q)/(m² c + q), q² = m² − s².
fn conductor_exact(c: Wide, n: Wide, k: Wide) -> Wide {
    let (re, im) = (n.squared() - k.squared(), n * k * 2.0);
    let (x, y) = (re - (1.0 - c.squared()), im);
    let size = x.hypot(y);
    // The root with positive parts, without a difference.
    let (p, q) = if x > 0.0 {
        let p = ((size + x) * 0.5).sqrt();
        (p, y / (p * 2.0))
    } else {
        let q = ((size - x) * 0.5).sqrt();
        (y / (q * 2.0), q)
    };
    let s = ((c - p).squared() + q.squared()) / ((c + p).squared() + q.squared());
    let (a, b) = (re * c, im * c);
    let t = ((a - p).squared() + (b - q).squared()) / ((a + p).squared() + (b + q).squared());
    (s + t) * 0.5
}

/// Metals.
pub fn conductor<R: Real>(gauge: &mut Gauge) {
    let axes = [cosine(), Axis::log("n", 0.03, 10.0).list(&[1.0]), Axis::log("k", 0.3, 10.0).list(&[1.0])];
    gauge.each(&axes, |gauge, [cosine, n, k]: [R; 3]| {
        gauge.compare(fresnel::conductor(cosine, n, k), conductor_exact(limited(wide(cosine)), wide(n), wide(k)));
    });
}

/// Wavelengths over a range of validity and beyond.
fn wavelength([short, long]: [f64; 2]) -> Axis {
    Axis::linear("λ", short - 50.0, long + 50.0).edges(&[short, long]).list(&[LINE_C, LINE_D, LINE_F, 500.0])
}

/// n², n and dn/dλ in nm⁻¹ of a table's glass, from its coefficients in `f64`.
fn glass_exact(table: &GlassTable, wavelength: Wide) -> [Wide; 2] {
    let c: Vec<Wide> = table.coefficients.double.iter().map(|c| Wide::from(*c)).collect();
    let [short, long] = table.valid.map(|w| Wide::from(f64::from(w)));
    let held = wavelength.max(short).min(long);
    let micro = held / 1000.0;
    let square = micro.squared();
    let (n, slope) = match table.formula {
        Formula::Cauchy => (c[0] + c[1] / square, -(c[1] * 2.0) / (square * micro)),
        Formula::Sellmeier => {
            let terms = || c.chunks(2).filter(|term| term[0] != 0.0);
            let square_n = terms().fold(Wide::ONE, |sum, t| sum + t[0] * square / (square - t[1]));
            let slope = terms().fold(Wide::ZERO, |sum, t| sum + t[0] * t[1] / (square - t[1]).squared());
            (square_n.sqrt(), -(micro * slope) / square_n.sqrt())
        }
    };
    [n, if wavelength < short || wavelength > long { Wide::ZERO } else { slope / 1000.0 }]
}

/// Calls for each built-in glass of a formula.
fn each_glass<R: Real>(
    gauge: &mut Gauge,
    formula: Option<Formula>,
    mut measure: impl FnMut(&mut Gauge, &Glass<R>, R, [Wide; 2]),
) {
    gauge.effort(0.2);
    gauge.note("the built-in materials over their range of validity");
    for table in glasses::ALL.iter().filter(|table| formula.is_none_or(|formula| formula == table.formula)) {
        let glass = Glass::from_table(table);
        gauge.quietly(|gauge| {
            gauge.each(&[wavelength(table.valid.map(f64::from))], |gauge, [w]: [R; 1]| {
                measure(gauge, &glass, w, glass_exact(table, wide(w)));
            });
        });
    }
}

/// By Sellmeier's formula.
pub fn sellmeier_index<R: Real>(gauge: &mut Gauge) {
    each_glass(gauge, Some(Formula::Sellmeier), |gauge, glass: &Glass<R>, w, exact| {
        if let Glass::Sellmeier(glass) = glass {
            gauge.compare(glass.index(w), exact[0]);
        }
    });
}

/// dn/dλ by Sellmeier's formula.
pub fn sellmeier_derivative<R: Real>(gauge: &mut Gauge) {
    each_glass(gauge, Some(Formula::Sellmeier), |gauge, glass: &Glass<R>, w, exact| {
        if let Glass::Sellmeier(glass) = glass {
            gauge.compare(glass.derivative(w), exact[1]);
        }
    });
}

/// By Cauchy's formula.
pub fn cauchy_index<R: Real>(gauge: &mut Gauge) {
    each_glass(gauge, Some(Formula::Cauchy), |gauge, glass: &Glass<R>, w, exact| {
        if let Glass::Cauchy(glass) = glass {
            gauge.compare(glass.index(w), exact[0]);
        }
    });
}

/// dn/dλ by Cauchy's formula.
pub fn cauchy_derivative<R: Real>(gauge: &mut Gauge) {
    each_glass(gauge, Some(Formula::Cauchy), |gauge, glass: &Glass<R>, w, exact| {
        if let Glass::Cauchy(glass) = glass {
            gauge.compare(glass.derivative(w), exact[1]);
        }
    });
}

/// V_d of the built-in materials that are valid at the three lines.
pub fn abbe_number<R: Real>(gauge: &mut Gauge) {
    gauge.note("the built-in materials");
    for table in &glasses::ALL {
        let [d, f, c] = [LINE_D, LINE_F, LINE_C].map(|line| glass_exact(table, line.into())[0]);
        gauge.compare(Glass::<R>::from_table(table).abbe_number(), (d - 1.0) / (f - c));
    }
}

/// Sellmeier's formula with two random terms.
pub fn sellmeier_new<R: Real>(gauge: &mut Gauge) {
    let axes = [
        Axis::linear("B₁", 0.5, 2.0),
        Axis::linear("C₁", 0.003, 0.02),
        Axis::linear("B₂", 0.1, 1.5),
        Axis::linear("C₂", 20.0, 200.0),
        Axis::linear("λ", 380.0, 780.0),
    ];
    gauge.each(&axes, |gauge, [b1, c1, b2, c2, w]: [R; 5]| {
        let terms = [[b1, c1], [b2, c2], [R::ZERO; 2], [R::ZERO; 2]];
        let Ok(glass) = Sellmeier::new(terms, [380.0, 780.0].map(R::from_f64)) else { return gauge.require(false) };
        let square = (wide(w) / 1000.0).squared();
        let term = |[b, c]: [Wide; 2]| b * square / (square - c);
        let exact = (term(wides([b1, c1])) + term(wides([b2, c2])) + 1.0).sqrt();
        gauge.compare(glass.index(w), exact);
    });
}

/// Cauchy's formula with random coefficients.
pub fn cauchy_new<R: Real>(gauge: &mut Gauge) {
    let axes = [Axis::linear("A", 1.2, 2.0), Axis::linear("B", 0.0, 0.02), Axis::linear("λ", 380.0, 780.0)];
    gauge.each(&axes, |gauge, [a, b, w]: [R; 3]| {
        let Ok(glass) = Cauchy::new(a, b, [380.0, 780.0].map(R::from_f64)) else { return gauge.require(false) };
        gauge.compare(glass.index(w), wide(a) + wide(b) / (wide(w) / 1000.0).squared());
    });
}
