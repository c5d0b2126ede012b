//! Elementary functions: `libm`'s, behind the trait of scalars.

use spectral_core::Real;

use crate::accuracy::gauge::{Axis, Gauge};
use crate::accuracy::wide::{Wide, wide};

/// Measures a function of one argument.
fn unary<R: Real>(gauge: &mut Gauge, axis: Axis, function: impl Fn(R) -> R, exact: impl Fn(Wide) -> Wide) {
    gauge.each(&[axis], |gauge, [x]: [R; 1]| gauge.compare(function(x), exact(wide(x))));
}

/// All positive normal numbers of the precision, but for the ends.
fn positive<R: Real>(name: &'static str) -> Axis {
    let ends = if R::EPSILON.to_f64() > 1e-10 { [1e-37, 1e38] } else { [1e-280, 1e280] };
    Axis::log(name, ends[0], ends[1]).edges(&[1.0, 2.0, 4.0, 0.125, 8.0, 1e-3])
}

/// √x.
pub fn sqrt<R: Real>(gauge: &mut Gauge) {
    unary(gauge, positive::<R>("x").list(&[0.0]), R::sqrt, Wide::sqrt);
}

/// ∛x.
pub fn cbrt<R: Real>(gauge: &mut Gauge) {
    let ends = if R::EPSILON.to_f64() > 1e-10 { [1e-37, 1e38] } else { [1e-280, 1e280] };
    unary(gauge, Axis::signed("x", ends[0], ends[1]).edges(&[1.0, 27.0, -8.0]), R::cbrt, Wide::cbrt);
}

/// eˣ.
pub fn exp<R: Real>(gauge: &mut Gauge) {
    let end = if R::EPSILON.to_f64() > 1e-10 { 87.0 } else { 650.0 };
    let axis = Axis::linear("x", -end, end).edges(&[0.0, 1.0, -1.0, 0.346_573_590_279_972_64]);
    unary(gauge, axis, R::exp, Wide::exp);
}

/// eˣ − 1.
pub fn exp_m1<R: Real>(gauge: &mut Gauge) {
    let axis = Axis::signed("x", 1e-30, 80.0).edges(&[0.346_573_590_279_972_64, 1.0, -1.0, -0.5, 1e-6]);
    unary(gauge, axis, R::exp_m1, Wide::exp_m1);
}

/// ln x.
pub fn ln<R: Real>(gauge: &mut Gauge) {
    unary(gauge, positive::<R>("x"), R::ln, Wide::ln);
    unary(gauge, Axis::linear("x", 0.5, 2.0).edges(&[1.0, 0.707_106_781_186_547_5]), R::ln, Wide::ln);
}

/// xʸ.
pub fn powf<R: Real>(gauge: &mut Gauge) {
    let axes = [Axis::log("x", 1e-3, 1e3).edges(&[1.0]), Axis::linear("y", -5.0, 5.0).edges(&[0.0, 1.0, 0.5, 2.4])];
    gauge.each(&axes, |gauge, [x, y]: [R; 2]| gauge.compare(x.powf(y), wide(x).powf(wide(y))));
}

fn turns() -> Axis {
    let quarter = core::f64::consts::FRAC_PI_2;
    Axis::linear("x", -100.0, 100.0).edges(&[0.0, quarter, 2.0 * quarter, 3.0 * quarter, -quarter, quarter / 2.0])
}

/// sin x.
pub fn sin<R: Real>(gauge: &mut Gauge) {
    unary(gauge, turns(), R::sin, Wide::sin);
}

/// cos x.
pub fn cos<R: Real>(gauge: &mut Gauge) {
    unary(gauge, turns(), R::cos, Wide::cos);
}

/// tan x.
pub fn tan<R: Real>(gauge: &mut Gauge) {
    unary(gauge, turns(), R::tan, Wide::tan);
}

/// arcsin x.
pub fn asin<R: Real>(gauge: &mut Gauge) {
    unary(gauge, Axis::linear("x", -1.0, 1.0).edges(&[0.0, 0.5, -0.5, 0.975]), R::asin, Wide::asin);
}

/// arccos x.
pub fn acos<R: Real>(gauge: &mut Gauge) {
    unary(gauge, Axis::linear("x", -1.0, 1.0).edges(&[0.0, 0.5, -0.5]), R::acos, Wide::acos);
}

/// arctan x.
pub fn atan<R: Real>(gauge: &mut Gauge) {
    let joints = [0.4375, 0.6875, 1.1875, 2.4375, -1.0];
    unary(gauge, Axis::signed("x", 1e-30, 1e30).edges(&joints), R::atan, Wide::atan);
}

/// The angle of (x, y).
pub fn atan2<R: Real>(gauge: &mut Gauge) {
    let axes = [Axis::signed("y", 1e-6, 1e6).edges(&[1.0]), Axis::signed("x", 1e-6, 1e6).edges(&[1.0, -1.0])];
    gauge.each(&axes, |gauge, [y, x]: [R; 2]| gauge.compare(y.atan2(x), wide(y).atan2(wide(x))));
}

/// √(x² + y²).
pub fn hypot<R: Real>(gauge: &mut Gauge) {
    let ends = if R::EPSILON.to_f64() > 1e-10 { [1e-30, 1e37] } else { [1e-250, 1e300] };
    let axes =
        [Axis::signed("x", ends[0], ends[1]).list(&[3.0, 5.0]), Axis::signed("y", ends[0], ends[1]).list(&[4.0, 12.0])];
    gauge.each(&axes, |gauge, [x, y]: [R; 2]| gauge.compare(x.hypot(y), wide(x).hypot(wide(y))));
    let near = [Axis::log("x", 0.1, 10.0), Axis::log("y", 0.1, 10.0)];
    gauge.each(&near, |gauge, [x, y]: [R; 2]| gauge.compare(x.hypot(y), wide(x).hypot(wide(y))));
}

/// A guess at x^(−⅓).
pub fn reciprocal_cbrt_estimate<R: Real>(gauge: &mut Gauge) {
    unary(gauge, positive::<R>("x"), R::reciprocal_cbrt_estimate, |x| Wide::ONE / x.cbrt());
}
