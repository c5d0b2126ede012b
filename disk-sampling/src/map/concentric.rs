//! The area-preserving map between the unit square and the unit disk.

use spectral_core::Real;

use super::uniform_pdf;

/// Shirley and Chiu's concentric map from the square [0, 1]² to the unit disk: squares around the centre become
/// circles, and equal areas stay equal (J. Graphics Tools 2(3), 1997).
///
/// Domain: [0, 1]²; outside, the disk is left. The map's pdf on the disk is 1/π everywhere.
pub fn square_to_disk<R: Real>([u, v]: [R; 2]) -> [R; 2] {
    let x = R::TWO * u - R::ONE;
    let y = R::TWO * v - R::ONE;
    if x == R::ZERO && y == R::ZERO {
        return [R::ZERO; 2];
    }
    let quarter = R::PI / R::from_f64(4.0);
    let (radius, angle) =
        if x.abs() > y.abs() { (x, quarter * (y / x)) } else { (y, R::PI / R::TWO - quarter * (x / y)) };
    [radius * angle.cos(), radius * angle.sin()]
}

/// The density of [`square_to_disk`] at a point of the disk: 1/π, and 0 outside.
pub fn square_to_disk_pdf<R: Real>(point: [R; 2]) -> R {
    uniform_pdf(point)
}

/// The inverse of [`square_to_disk`].
pub fn disk_to_square<R: Real>([x, y]: [R; 2]) -> [R; 2] {
    let radius = x.hypot(y);
    let quarter = R::PI / R::from_f64(4.0);
    let (a, b) = if x.abs() > y.abs() {
        let signed = if x < R::ZERO { -radius } else { radius };
        (signed, signed * (y / x).atan() / quarter)
    } else if y == R::ZERO {
        (R::ZERO, R::ZERO)
    } else {
        let signed = if y < R::ZERO { -radius } else { radius };
        (signed * (x / y).atan() / quarter, signed)
    };
    [(a + R::ONE) * R::HALF, (b + R::ONE) * R::HALF]
}

#[cfg(test)]
mod tests {
    use super::{disk_to_square, square_to_disk};

    #[test]
    fn comes_back_and_stays_inside() {
        for i in 0..=64 {
            for j in 0..=64 {
                let square = [f64::from(i) / 64.0, f64::from(j) / 64.0];
                let [x, y] = square_to_disk(square);
                assert!(x.hypot(y) <= 1.0 + 2.0 * f64::EPSILON);
                let back = disk_to_square([x, y]);
                assert!((back[0] - square[0]).abs().max((back[1] - square[1]).abs()) <= 4.0 * f64::EPSILON);
            }
        }
    }

    #[test]
    fn keeps_area() {
        // The Jacobian determinant by central differences is π everywhere off the diagonals.
        for (u, v) in [(0.1, 0.4), (0.7, 0.55), (0.52, 0.9), (0.3, 0.05)] {
            let h = 1e-5;
            let d = |a: [f64; 2], b: [f64; 2]| [(a[0] - b[0]) / (2.0 * h), (a[1] - b[1]) / (2.0 * h)];
            let du = d(square_to_disk([u + h, v]), square_to_disk([u - h, v]));
            let dv = d(square_to_disk([u, v + h]), square_to_disk([u, v - h]));
            let jacobian = (du[0] * dv[1] - du[1] * dv[0]).abs();
            assert!((jacobian - core::f64::consts::PI).abs() <= 1e-8, "{jacobian}");
        }
    }
}
