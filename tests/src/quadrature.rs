//! Configuration factors by adaptive quadrature over area or solid angle: independent of every closed form, `f64` only.

use core::f64::consts::{FRAC_PI_2, PI};

type Vector = [f64; 3];

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: Vector) -> Vector {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

fn combine(a: Vector, s: f64, u: Vector, t: f64, v: Vector) -> Vector {
    core::array::from_fn(|i| a[i] + s * u[i] + t * v[i])
}

/// A unit vector perpendicular to `n`: along `wish` as far as it goes.
fn perpendicular(n: Vector, wish: Vector) -> Vector {
    let part = combine(wish, -dot(wish, n), n, 0.0, n);
    if dot(part, part) > 1e-20 {
        return unit(part);
    }
    let axis = if n[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    unit(cross(n, axis))
}

/// Nodes and weights of the 15-point Kronrod rule and the weights of the 7-point Gauss rule within it (QUADPACK, `qk15`).
const KRONROD: [(f64, f64, f64); 8] = [
    (0.0, 0.209_482_141_084_727_83, 0.417_959_183_673_469_4),
    (0.207_784_955_007_898_47, 0.204_432_940_075_298_9, 0.0),
    (0.405_845_151_377_397_2, 0.190_350_578_064_785_4, 0.381_830_050_505_118_9),
    (0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.0),
    (0.741_531_185_599_394_4, 0.140_653_259_715_525_92, 0.279_705_391_489_276_67),
    (0.864_864_423_359_769_1, 0.104_790_010_322_250_19, 0.0),
    (0.949_107_912_342_758_5, 0.063_092_092_629_978_55, 0.129_484_966_168_869_7),
    (0.991_455_371_120_812_6, 0.022_935_322_010_529_224, 0.0),
];

fn kronrod(f: &dyn Fn(f64) -> f64, a: f64, b: f64) -> (f64, f64) {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let (mut fine, mut coarse) = (0.0, 0.0);
    for (i, (node, weight, gauss)) in KRONROD.into_iter().enumerate() {
        let value = if i == 0 { f(middle) } else { f(middle - half * node) + f(middle + half * node) };
        fine += weight * value;
        coarse += gauss * value;
    }
    (fine * half, (fine - coarse).abs() * half)
}

/// ∫ `f` over [`a`, `b`] by bisection until Kronrod's and Gauss's rule agree within `tolerance` of a part's share of the whole.
#[must_use]
pub fn integrate(f: &dyn Fn(f64) -> f64, a: f64, b: f64, tolerance: f64) -> f64 {
    let whole = kronrod(f, a, b).0.abs();
    let mut open = vec![(a, b, 0)];
    let mut sum = 0.0;
    let mut carry = 0.0;
    while let Some((a, b, depth)) = open.pop() {
        let (value, error) = kronrod(f, a, b);
        if depth < 50 && !(error <= tolerance * value.abs().max(1e-3 * whole)) {
            let middle = 0.5 * (a + b);
            open.push((a, middle, depth + 1));
            open.push((middle, b, depth + 1));
            continue;
        }
        // Kahan's sum: parts are many where the integrand peaks.
        let term = value - carry;
        let next = sum + term;
        carry = (next - sum) - term;
        sum = next;
    }
    sum
}

/// Difference of Gauss's and Kronrod's rule that is passed: the square of it bounds the error of the latter.
const TOLERANCE: f64 = 1e-9;

/// The factor of the part of a disk that is above the receiver's horizon, over its area: ∫ cos θ₁ cos θ₂ / (π d²) dA.
#[must_use]
pub fn disk_factor(centre: Vector, normal: Vector, radius: f64, position: Vector, receiver: Vector) -> f64 {
    let (normal, receiver) = (unit(normal), unit(receiver));
    let d = combine(centre, -1.0, position, 0.0, position);
    let height = -dot(d, normal);
    if height <= 0.0 {
        return 0.0;
    }
    // v points up from the horizon's trace in the disk's plane, u along it.
    let v = perpendicular(normal, receiver);
    let u = cross(normal, v);
    let (middle, slope) = (dot(d, receiver), dot(v, receiver));
    let start = if middle >= radius * slope { PI } else { (-middle / (radius * slope)).clamp(-1.0, 1.0).acos() };
    let strip = |angle: f64| {
        let (y, half) = (radius * angle.cos(), radius * angle.sin());
        let line = |x: f64| {
            let p = combine(d, x, u, y, v);
            let d2 = dot(p, p);
            dot(p, receiver) * height / (d2 * d2)
        };
        // The foot of the perpendicular on the line, where the integrand peaks.
        let foot = -dot(d, u);
        let inner = if foot.abs() < half {
            integrate(&line, -half, foot, TOLERANCE) + integrate(&line, foot, half, TOLERANCE)
        } else {
            integrate(&line, -half, half, TOLERANCE)
        };
        inner * half
    };
    integrate(&strip, 0.0, start, TOLERANCE) / PI
}

/// The factor of the part of a sphere above the receiver's horizon, over the solid angle of its cap: ∫ cos θ dω / π.
#[must_use]
pub fn sphere_factor(centre: Vector, radius: f64, position: Vector, receiver: Vector) -> f64 {
    let receiver = unit(receiver);
    let d = combine(centre, -1.0, position, 0.0, position);
    let distance2 = dot(d, d);
    if distance2 < radius * radius {
        return 1.0;
    }
    let axis = unit(d);
    let cosine = dot(axis, receiver);
    let sine = dot(cross(axis, receiver), cross(axis, receiver)).sqrt();
    let rim = radius.atan2((distance2 - radius * radius).sqrt());
    // On the circle at `angle` from the axis, n·ω = cos a cos t + sin a sin t cos φ.
    let circle = |angle: f64| {
        let (level, swing) = (angle.cos() * cosine, angle.sin() * sine);
        let end = if level >= swing {
            PI
        } else if level <= -swing {
            return 0.0;
        } else {
            (-level / swing).acos()
        };
        2.0 * integrate(&|f: f64| level + swing * f.cos(), 0.0, end, TOLERANCE) * angle.sin()
    };
    // Circles touch the horizon where their angle is that of the horizon from the axis.
    let touch = (FRAC_PI_2 - cosine.clamp(-1.0, 1.0).acos()).abs();
    let parts = if touch < rim { vec![(0.0, touch), (touch, rim)] } else { vec![(0.0, rim)] };
    let smooth = |(a, b): (f64, f64)| {
        // Square-root ends become smooth by angle = a + (b − a) sin² s.
        integrate(
            &|s: f64| circle(a + (b - a) * s.sin().powi(2)) * (2.0 * s).sin() * (b - a),
            0.0,
            FRAC_PI_2,
            TOLERANCE,
        )
    };
    parts.into_iter().map(smooth).sum::<f64>() / PI
}

/// The factor of a triangle, over its area; the part below the horizon counts nothing.
///
/// Precise for triangles above the horizon; the kink at the horizon costs bisections.
#[must_use]
pub fn triangle_factor(position: Vector, receiver: Vector, corners: [Vector; 3]) -> f64 {
    let receiver = unit(receiver);
    let [a, b, c] = corners.map(|x| combine(x, -1.0, position, 0.0, position));
    let (ab, ac) = (combine(b, -1.0, a, 0.0, a), combine(c, -1.0, a, 0.0, a));
    let volume = dot(a, cross(ab, ac)).abs();
    let strip = |s: f64| {
        let line = |t: f64| {
            let p = combine(a, s * (1.0 - t), ab, s * t, ac);
            let d2 = dot(p, p);
            dot(p, receiver).max(0.0) / (d2 * d2)
        };
        s * integrate(&line, 0.0, 1.0, TOLERANCE)
    };
    integrate(&strip, 0.0, 1.0, TOLERANCE) * volume / PI
}
