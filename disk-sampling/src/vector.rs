//! Three-component vectors as plain arrays.

use spectral_core::Real;

pub(crate) type Vector<R> = [R; 3];

pub(crate) fn add<R: Real>(a: Vector<R>, b: Vector<R>) -> Vector<R> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn subtract<R: Real>(a: Vector<R>, b: Vector<R>) -> Vector<R> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn scale<R: Real>(a: Vector<R>, factor: R) -> Vector<R> {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

pub(crate) fn dot<R: Real>(a: Vector<R>, b: Vector<R>) -> R {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross<R: Real>(a: Vector<R>, b: Vector<R>) -> Vector<R> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Euclidean length without undue overflow or underflow.
pub(crate) fn length<R: Real>(a: Vector<R>) -> R {
    a[0].hypot(a[1]).hypot(a[2])
}

/// The unit vector along `a`, of any finite length but zero.
pub(crate) fn normalized<R: Real>(a: Vector<R>) -> Option<Vector<R>> {
    let largest = a[0].abs().max(a[1].abs()).max(a[2].abs());
    if !a.iter().all(|x| x.is_finite()) || !(largest > R::ZERO) {
        return None;
    }
    // Dividing by the largest component first keeps squares in range, subnormal vectors included.
    let b = a.map(|x| x / largest);
    let length = dot(b, b).sqrt();
    Some(b.map(|x| x / length))
}

/// Two unit vectors that make a right-handed frame with the unit vector `n`: u × v = n.
///
/// Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
pub(crate) fn perpendicular_frame<R: Real>(n: Vector<R>) -> [Vector<R>; 2] {
    let sign = if n[2] < R::ZERO { -R::ONE } else { R::ONE };
    let a = -R::ONE / (sign + n[2]);
    let b = n[0] * n[1] * a;
    let u = [R::ONE + sign * n[0] * n[0] * a, sign * b, -sign * n[0]];
    let v = [b, sign + n[1] * n[1] * a, -n[1]];
    [u, v]
}
