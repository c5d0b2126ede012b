//! Sampling by antithetic half vectors: every slope of a half vector stands with its mirror image, one of which always
//! reflects above the horizon.

use super::direction::{above, floor, half_slope, unit};
use super::lambert::turn;
use super::{Sample, quadrature};
use crate::Real;

/// A model with a distribution of half vectors' slopes that is symmetric, P(s) = P(−s).
///
/// A slope is ε·(cos φ, sin φ), with (cos φ, sin φ) along `stretch`·(cos ψ, sin ψ) for ψ uniform, and ε is `spread`·y
/// with y distributed alike for all ψ.
pub(super) trait Lobe<R: Real> {
    /// How a circle of uniform azimuths is stretched along x and y.
    fn stretch(&self) -> [R; 2];
    /// The scale of slopes along an azimuth, from its length |`stretch`·(cos ψ, sin ψ)|.
    fn spread(&self, length: R) -> R;
    /// The probability F of a scaled slope up to y.
    fn cumulative(&self, y: R) -> R;
    /// y for F in [0, 1).
    fn quantile(&self, p: R) -> R;
    /// 1 − F(y).
    fn complement(&self, y: R) -> R;
    /// The density of slopes P(s) along an azimuth (unit vector), where 1 − F is `complement`.
    fn density(&self, azimuth: [R; 2], complement: R) -> R;
    /// f cos θ / pdf for a slope drawn by P alone; called for lights above the horizon.
    fn weight(&self, side: &Side<R>, view_z: R, azimuth: [R; 2]) -> R;
    /// What (w(s) + w(−s))/2 mostly is, or 0; if it is the largest value too, the albedo by quadrature is at most that.
    fn typical_weight(&self) -> R {
        R::ZERO
    }
    /// Whether weights have a kink where both cosines are equal.
    fn has_kink(&self) -> bool {
        false
    }
    /// A coordinate in which F is smooth, of finite range: x for y.
    fn chart(&self, y: R) -> R;
    /// y and dF/dx for a coordinate x.
    fn unchart(&self, x: R) -> (R, R);
}

/// What one of the two slopes reflects: the light's cosine, the sum of both cosines, 1 + ε².
pub(super) struct Side<R> {
    pub(super) light_z: R,
    pub(super) height: R,
    pub(super) secant2: R,
}

/// The slopes that share an azimuth, for a view.
pub(super) struct Axis<R> {
    pub(super) azimuth: [R; 2],
    pub(super) spread: R,
    /// The view's horizontal part along the azimuth.
    pub(super) along: R,
    pub(super) view_z: R,
}

impl<R: Real> Axis<R> {
    #[inline]
    pub(super) fn new<L: Lobe<R>>(lobe: &L, view: [R; 3], [cos, sin]: [R; 2]) -> Self {
        let [a, b] = lobe.stretch();
        let (x, y) = (a * cos, b * sin);
        let length = (x * x + y * y).sqrt();
        let azimuth = [x / length, y / length];
        let along = azimuth[0] * view[0] + azimuth[1] * view[1];
        Self { azimuth, spread: lobe.spread(length), along, view_z: view[2] }
    }

    /// The larger ε up to which a slope reflects above the horizon; the smaller, of its mirror image, is the reciprocal.
    #[inline]
    pub(super) fn horizon(&self) -> R {
        let along = self.along.abs();
        (along + (along * along + self.view_z * self.view_z).sqrt()) / self.view_z
    }

    /// The side of signed ε, if it can be above the horizon.
    #[inline]
    fn side(&self, epsilon: R) -> Option<Side<R>> {
        let rise = self.view_z + epsilon * self.along;
        if !(rise > R::ZERO) {
            return None;
        }
        let secant2 = R::ONE + epsilon * epsilon;
        let height = R::TWO * rise / secant2;
        Some(Side { light_z: height - self.view_z, height, secant2 })
    }

    /// The weight of signed ε, 0 below the horizon.
    #[inline]
    pub(super) fn weight<L: Lobe<R>>(&self, lobe: &L, epsilon: R) -> R {
        match self.side(epsilon) {
            Some(side) if side.light_z > R::ZERO => lobe.weight(&side, self.view_z, self.azimuth),
            _ => R::ZERO,
        }
    }

    /// The probability of the slope of signed ε rather than its mirror image, and the sum of their weights.
    #[inline]
    fn choice<L: Lobe<R>>(&self, lobe: &L, epsilon: R) -> (R, R) {
        let (this, other) = (self.weight(lobe, epsilon), self.weight(lobe, -epsilon));
        let sum = this + other;
        // Where both touch the horizon, what is nearer to the mirror direction.
        let this = if sum > R::ZERO {
            this / sum
        } else if epsilon * self.along >= R::ZERO {
            R::ONE
        } else {
            R::ZERO
        };
        (this, sum)
    }

    /// The light of signed ε; at least as high as [`floor`].
    fn light(&self, view: [R; 3], epsilon: R) -> ([R; 3], R, R) {
        let secant2 = R::ONE + epsilon * epsilon;
        let height = R::TWO * (self.view_z + epsilon * self.along).max(R::ZERO) / secant2;
        let run = epsilon * height;
        let light =
            [run * self.azimuth[0] - view[0], run * self.azimuth[1] - view[1], (height - self.view_z).max(floor())];
        (light, height, secant2)
    }
}

/// Draws a light direction; the weight is S·(w(s) + w(−s))/2.
pub(super) fn sample<R: Real, L: Lobe<R>>(lobe: &L, view: [R; 3], u: [R; 3]) -> Option<Sample<R>> {
    let view = above(view)?;
    let psi = R::TWO * R::PI * unit(u[1]);
    let axis = Axis::new(lobe, view, [psi.cos(), psi.sin()]);
    let horizon = axis.horizon();
    let reached = lobe.cumulative(horizon / axis.spread);
    let y = lobe.quantile(unit(u[0]) * reached);
    let epsilon = (axis.spread * y).min(horizon);
    let (chance, sum) = axis.choice(lobe, epsilon);
    let (epsilon, chance) = if unit(u[2]) < chance { (epsilon, chance) } else { (-epsilon, R::ONE - chance) };
    let (direction, height, secant2) = axis.light(view, epsilon);
    let slopes = lobe.density(axis.azimuth, lobe.complement(y));
    let pdf = solid_angle_pdf(slopes, height, secant2) * (R::TWO * chance / reached);
    Some(Sample { direction, pdf: pdf.min(R::MAX), weight: reached * sum * R::HALF })
}

/// The density of [`sample`] per steradian.
pub(super) fn pdf<R: Real, L: Lobe<R>>(lobe: &L, light: [R; 3], view: [R; 3]) -> R {
    let Some(found) = locate(lobe, light, view) else { return R::ZERO };
    let slopes = lobe.density(found.axis.azimuth, lobe.complement(found.y));
    if !(slopes > R::ZERO) {
        return R::ZERO;
    }
    let (chance, _) = found.axis.choice(lobe, found.epsilon);
    let reached = lobe.cumulative(found.axis.horizon() / found.axis.spread);
    let secant2 = R::ONE + found.epsilon * found.epsilon;
    (solid_angle_pdf(slopes, found.height, secant2) * (R::TWO * chance / reached)).min(R::MAX)
}

/// Numbers that [`sample`] maps to this light.
pub(super) fn invert<R: Real, L: Lobe<R>>(lobe: &L, light: [R; 3], view: [R; 3]) -> Option<[R; 3]> {
    let found = locate(lobe, light, view)?;
    let reached = lobe.cumulative(found.axis.horizon() / found.axis.spread);
    let (chance, _) = found.axis.choice(lobe, found.epsilon);
    Some([unit(lobe.cumulative(found.y) / reached), found.turn, chance * R::HALF])
}

/// The density of lights per steradian, from that of slopes: dω_l = 4 (v·h) dω_h, dω_h = cos³δ ds.
#[inline]
pub(super) fn solid_angle_pdf<R: Real>(slopes: R, height: R, secant2: R) -> R {
    slopes * secant2 / (R::TWO * height)
}

/// Draws a light direction by P alone, as Ward does; `None` below the horizon.
pub(super) fn sample_half_vector<R: Real, L: Lobe<R>>(lobe: &L, view: [R; 3], u: [R; 2]) -> Option<Sample<R>> {
    let view = above(view)?;
    let psi = R::TWO * R::PI * unit(u[1]);
    let axis = Axis::new(lobe, view, [psi.cos(), psi.sin()]);
    let y = lobe.quantile(unit(u[0]));
    let epsilon = axis.spread * y;
    let side = axis.side(epsilon)?;
    if !(side.light_z > R::ZERO) {
        return None;
    }
    let (direction, height, secant2) = axis.light(view, epsilon);
    let slopes = lobe.density(axis.azimuth, lobe.complement(y));
    let pdf = solid_angle_pdf(slopes, height, secant2).min(R::MAX);
    Some(Sample { direction, pdf, weight: lobe.weight(&side, axis.view_z, axis.azimuth) })
}

/// The density of [`sample_half_vector`] per steradian; over the hemisphere it integrates to the chance of `Some`.
pub(super) fn half_vector_pdf<R: Real, L: Lobe<R>>(lobe: &L, light: [R; 3], view: [R; 3]) -> R {
    let Some(found) = locate(lobe, light, view) else { return R::ZERO };
    let slopes = lobe.density(found.axis.azimuth, lobe.complement(found.y));
    if !(slopes > R::ZERO) {
        return R::ZERO;
    }
    solid_angle_pdf(slopes, found.height, R::ONE + found.epsilon * found.epsilon).min(R::MAX)
}

/// Where a light's half vector lies among the slopes of a lobe.
struct Found<R> {
    axis: Axis<R>,
    turn: R,
    y: R,
    epsilon: R,
    height: R,
}

fn locate<R: Real, L: Lobe<R>>(lobe: &L, light: [R; 3], view: [R; 3]) -> Option<Found<R>> {
    let (light, view) = (above(light)?, above(view)?);
    let (slope, height) = half_slope(light, view);
    let [a, b] = lobe.stretch();
    let (x, y) = (slope[0] / a, slope[1] / b);
    let length = x.hypot(y);
    let circle = if length > R::ZERO { [x / length, y / length] } else { [R::ONE, R::ZERO] };
    let axis = Axis::new(lobe, view, circle);
    let epsilon = slope[0].hypot(slope[1]);
    Some(Found { y: epsilon / axis.spread, axis, turn: turn(x, y), epsilon, height })
}

/// The albedo by quadrature.
pub(super) fn albedo<R: Real, L: Lobe<R>>(lobe: &L, view: [R; 3]) -> R {
    above(view).map_or(R::ZERO, |view| quadrature::albedo(lobe, view))
}
