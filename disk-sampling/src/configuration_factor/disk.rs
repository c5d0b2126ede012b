//! Disks of uniform radiance.

use spectral_core::Real;

use super::cone::Cone;
use super::double_word::{DoubleWord, WideVector, wide_cross, wide_difference, wide_dot, widened};
use super::scale::power_of_two;
use crate::shape::{Disk, Receiver};
use crate::vector::{Vector, cross, dot, length, scale, subtract};

/// The configuration factor from a receiver to a disk, clipped at the receiver's horizon: irradiance over π times the disk's radiance.
pub fn disk_configuration_factor<R: Real>(disk: &Disk<R>, receiver: &Receiver<R>) -> R {
    let Some(view) = View::new(disk, receiver.position()) else { return R::ZERO };
    view.factor(disk.normal(), receiver.normal())
}

/// The irradiance vector of a whole disk over π times its radiance.
pub fn disk_irradiance_vector<R: Real>(disk: &Disk<R>, position: [R; 3]) -> [R; 3] {
    let Some(view) = View::new(disk, position) else { return [R::ZERO; 3] };
    let axis = view.axis(disk.normal());
    let size = view.cone.irradiance() / length(axis);
    axis.map(|x| x * size)
}

/// A disk as seen from a point on its shining side, lengths over a power of two.
struct View<R> {
    /// From the point to the centre.
    offset: WideVector<R>,
    /// Height of the point over the disk's plane, and radius.
    height: R,
    radius: R,
    /// The eigenvalues λ₊ ≥ 0 and −λ₋ ≥ 0 of the cone's matrix: the latter, and their sum.
    inward: R,
    sum: R,
    cone: Cone<R>,
}

impl<R: Real> View<R> {
    /// None from behind and where the disk is seen edge-on.
    fn new(disk: &Disk<R>, position: Vector<R>) -> Option<Self> {
        let offset = wide_difference(disk.centre(), position);
        let factor = power_of_two(offset.iter().fold(disk.radius(), |m, x| m.max(x.value().abs())))?;
        let offset = offset.map(|x| x * factor);
        let radius = disk.radius() * factor;
        let height = -wide_dot(offset, widened(disk.normal())).value();
        // |offset|² − r²: positive outside the sphere that has the disk's rim as a great circle.
        let power = (wide_dot(offset, offset) - DoubleWord::product(radius, radius)).value();
        let height = if height == R::ZERO && !(power > R::ZERO) { radius * R::EPSILON * R::EPSILON } else { height };
        if !(height > R::ZERO) {
            return None;
        }
        let area = radius * height;
        let sum = power.hypot(R::TWO * area);
        let (across, inward) = if power > R::ZERO {
            let across = R::HALF * (sum + power);
            (across, area * (area / across))
        } else {
            let inward = R::HALF * (sum - power);
            (area * (area / inward), inward)
        };
        let side = inward.sqrt().hypot(height);
        let cone = Cone {
            narrow: [(inward / sum).sqrt(), (across / sum).sqrt()],
            wide: [inward.sqrt() / side, height / side],
        };
        Some(Self { offset, height, radius, inward, sum, cone })
    }

    /// A vector along the cone's axis: h d − λ₋ times the inward normal.
    fn axis(&self, normal: Vector<R>) -> Vector<R> {
        core::array::from_fn(|i| self.height * self.offset[i].value() - self.inward * normal[i])
    }

    fn factor(&self, disk: Vector<R>, receiver: Vector<R>) -> R {
        // Heights over the horizon: of the centre, and how far the rim goes above and below it.
        let wide_middle = wide_dot(self.offset, widened(receiver));
        let middle = wide_middle.value();
        let tilt = wide_cross(widened(receiver), widened(disk));
        let sine2 = wide_dot(tilt, tilt);
        let reach = wide_dot(widened(disk), widened(disk)) * wide_middle * wide_middle;
        let cut = (sine2 * self.radius * self.radius - reach).value();
        if !(cut > R::ZERO) && !(middle > R::ZERO) {
            return R::ZERO;
        }
        let axis = self.axis(disk);
        let axis_length = length(axis);
        let toward = -dot(receiver, disk);
        let along = (self.height * middle + self.inward * toward) / axis_length;
        if !(cut > R::ZERO) {
            return along * self.cone.irradiance();
        }
        let chord = self.cone.wide[1] * (cut / self.sum).sqrt();
        let [inner, side, rho] = self.lateral(disk, tilt.map(DoubleWord::value));
        let h2 = self.height * self.height;
        let outward = ((h2 + self.inward) * inner - self.height * rho * toward) / axis_length;
        self.cone.cut([outward, side, along], chord)
    }

    /// The receiver's normal within the disk's plane, towards the axis and across, and the distance from the axis; `tilt` is
    /// receiver × disk.
    fn lateral(&self, disk: Vector<R>, tilt: Vector<R>) -> [R; 3] {
        let offset = self.offset.map(DoubleWord::value);
        // Rounding turns the direction a little, which matters the less the nearer the axis is; it must stay in the plane.
        let foot = cross(offset, disk);
        let foot = subtract(foot, scale(disk, dot(foot, disk)));
        let rho = length(foot);
        if !(rho > R::EPSILON * length(offset)) {
            return [length(tilt), R::ZERO, R::ZERO];
        }
        [dot(foot, tilt) / rho, dot(disk, cross(foot, tilt)) / rho, rho]
    }
}
