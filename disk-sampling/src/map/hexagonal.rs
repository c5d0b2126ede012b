//! The area-preserving map between the hexagon and the disk.

use spectral_core::Real;

use super::uniform_pdf;

/// Side, and distance of the corners from the centre, of the regular hexagon that has the area π of the unit disk:
/// √(2π/(3√3)).
pub(crate) const HEXAGON_SIDE: f64 = 1.099_636_110_791_267_8;

/// The area-preserving map from the regular hexagon of area π, centred, with a corner on the x axis, to the unit disk.
///
/// Each of the six triangles around the centre becomes a circular sector: the fraction ρ of the apothem that a point's
/// ring has reached becomes the radius, its place t along the ring's edge the angle 60° t within the sector. Area is
/// proportional to ρ dρ dt on both sides, so equal areas stay equal. Domain: the hexagon; outside it, the disk is left.
pub fn hexagon_to_disk<R: Real>(point: [R; 2]) -> [R; 2] {
    let (sector, triangle) = sector_coordinates(point);
    triangle_to_disk(sector, triangle)
}

/// The density on the disk of points that are uniform on the hexagon: 1/π, and 0 outside the disk.
pub fn hexagon_to_disk_pdf<R: Real>(point: [R; 2]) -> R {
    uniform_pdf(point)
}

/// The inverse of [`hexagon_to_disk`].
pub fn disk_to_hexagon<R: Real>([x, y]: [R; 2]) -> [R; 2] {
    let turn = y.atan2(x) * R::from_f64(3.0) / R::PI;
    let turn = if turn < R::ZERO { turn + R::from_f64(6.0) } else { turn };
    let sector = turn.floor();
    let along = turn - sector;
    let radius = x.hypot(y);
    triangle_to_hexagon(sector.to_usize(), [radius * (R::ONE - along), radius * along])
}

/// The point of sector 0 to 5 at coordinates (x, y) of the triangle x, y ≥ 0, x + y ≤ 1 with the centre at (0, 0), on
/// the hexagon.
pub(crate) fn triangle_to_hexagon<R: Real>(sector: usize, [x, y]: [R; 2]) -> [R; 2] {
    let (u, w) = (corner::<R>(sector), corner::<R>(sector + 1));
    [x * u[0] + y * w[0], x * u[1] + y * w[1]]
}

/// The same point on the disk: radius x + y, angle 60° (sector + y/(x + y)).
pub(crate) fn triangle_to_disk<R: Real>(sector: usize, [x, y]: [R; 2]) -> [R; 2] {
    let radius = (x + y).min(R::ONE);
    if !(radius > R::ZERO) {
        return [R::ZERO; 2];
    }
    // The angle is taken from the sector's bisector, so that mirrored points stay mirrored to the last bit.
    let angle = R::PI / R::from_f64(6.0) * ((y - x) / (x + y));
    let (sin, cos) = (angle.sin(), angle.cos());
    let [c, s] = bisector(sector);
    [radius * (cos * c - sin * s), radius * (cos * s + sin * c)]
}

/// Corner 0 to 6 of the hexagon, anticlockwise from the x axis; 6 is 0 again.
pub(crate) fn corner<R: Real>(index: usize) -> [R; 2] {
    let half = HEXAGON_SIDE * 0.5;
    let height = HEXAGON_SIDE * 0.5 * SQRT_3;
    let [x, y] = match index {
        1 => [half, height],
        2 => [-half, height],
        3 => [-HEXAGON_SIDE, 0.0],
        4 => [-half, -height],
        5 => [half, -height],
        _ => [HEXAGON_SIDE, 0.0],
    };
    [R::from_f64(x), R::from_f64(y)]
}

/// The direction of a sector's bisector, at 30° + 60° · sector.
fn bisector<R: Real>(sector: usize) -> [R; 2] {
    let long = SQRT_3 * 0.5;
    let [x, y] = match sector {
        0 => [long, 0.5],
        1 => [0.0, 1.0],
        2 => [-long, 0.5],
        3 => [-long, -0.5],
        4 => [0.0, -1.0],
        _ => [long, -0.5],
    };
    [R::from_f64(x), R::from_f64(y)]
}

const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// The sector of a point of the plane and its coordinates there.
fn sector_coordinates<R: Real>(point: [R; 2]) -> (usize, [R; 2]) {
    let [x, y] = [point[0] / R::from_f64(HEXAGON_SIDE), point[1] / R::from_f64(HEXAGON_SIDE)];
    // Oblique coordinates along 0° and 60°: (x, y) = a (1, 0) + b (½, √3/2); they turn by 60° as (a, b) → (−b, a + b).
    let b = y / R::from_f64(SQRT_3 * 0.5);
    let a = x - b * R::HALF;
    let (upper, [a, b]) = if b < R::ZERO || (b == R::ZERO && a < R::ZERO) { (3, [-a, -b]) } else { (0, [a, b]) };
    // Now 0° to 180°: turning back by 60° is (a, b) → (a + b, −a).
    if a > R::ZERO {
        (upper, [a, b])
    } else if a + b > R::ZERO {
        (upper + 1, [a + b, -a])
    } else {
        (upper + 2, [b, -(a + b)])
    }
}
