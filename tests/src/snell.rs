//! Closed forms of geometrical optics, `independent` oracles for refraction: prisms, plane-parallel plates, and lenses bounded by a sphere.
//!
//! Angles are in radians, lengths in one unit of the caller's, indices relative to the medium around. Light is unpolarised at every boundary, as
//! in the renderers: the reflectance is the mean of both polarisations each time anew, so that shares of light that passes several
//! boundaries are products of these means ([`Plate::transmitted_polarised`] has the other way, which real light goes). Boundaries are
//! smooth, media clear unless they say otherwise.

use core::f64::consts::{FRAC_PI_2, PI};

use crate::quadrature::integrate;

/// Reflectance of a boundary for light polarised across and along the plane of incidence, by Fresnel's formulae; 1 where all is reflected.
/// `index` is that behind the boundary relative to that before it.
#[must_use]
pub fn reflectances(incidence: f64, index: f64) -> [f64; 2] {
    let Some(refraction) = refracted(incidence, index) else { return [1.0; 2] };
    let (before, behind) = (incidence.cos(), refraction.cos());
    let across = (before - index * behind) / (before + index * behind);
    let along = (index * before - behind) / (index * before + behind);
    [across * across, along * along]
}

/// The mean of both polarisations' [`reflectances`].
#[must_use]
pub fn reflectance(incidence: f64, index: f64) -> f64 {
    let [across, along] = reflectances(incidence, index);
    (across + along) / 2.0
}

/// The angle of refraction by Snell's law, with the sign of the angle of incidence; `None` where all is reflected.
#[must_use]
pub fn refracted(incidence: f64, index: f64) -> Option<f64> {
    let sine = incidence.sin() / index;
    (sine.abs() <= 1.0).then(|| sine.asin())
}

/// A plane-parallel plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plate {
    /// Distance of its faces.
    pub thickness: f64,
    /// Its index.
    pub index: f64,
    /// Absorption coefficient: exp(−a s) remains after a way s.
    pub absorption: f64,
}

impl Plate {
    /// How far light that passes is moved aside, across its direction, by its first passage: d sin θ (1 − cos θ / (n cos θ′)).
    #[must_use]
    pub fn shift(&self, incidence: f64) -> f64 {
        let inside = (incidence.sin() / self.index).asin();
        self.thickness * incidence.sin() * (1.0 - incidence.cos() / (self.index * inside.cos()))
    }

    /// The share that remains of light after one way through.
    fn remaining(&self, incidence: f64) -> f64 {
        let inside = (incidence.sin() / self.index).asin();
        (-self.absorption * self.thickness / inside.cos()).exp()
    }

    /// The shares of light that pass in the end and come back in the end, after all inner reflections: with the boundary's reflectance R
    /// and the share τ that remains after a way through, (1 − R)² τ / (1 − R² τ²) and R + R (1 − R)² τ² / (1 − R² τ²). For a clear plate the
    /// first is (1 − R) / (1 + R).
    #[must_use]
    pub fn shares(&self, incidence: f64) -> [f64; 2] {
        Self::series(reflectance(incidence, self.index), self.remaining(incidence))
    }

    /// The share that passes if each polarisation keeps to itself: the mean of both [`shares`](Self::shares).
    #[must_use]
    pub fn transmitted_polarised(&self, incidence: f64) -> f64 {
        let remaining = self.remaining(incidence);
        reflectances(incidence, self.index).map(|r| Self::series(r, remaining)[0]).iter().sum::<f64>() / 2.0
    }

    fn series(reflectance: f64, remaining: f64) -> [f64; 2] {
        let through = 1.0 - reflectance;
        let round = 1.0 - (reflectance * remaining).powi(2);
        let passes = through * through * remaining / round;
        [passes, reflectance * (1.0 + passes * remaining)]
    }
}

/// A prism in its principal section: the refracting edge is at the origin, the faces go down from there symmetrically to the y axis, and light
/// comes from the left through the left face and leaves through the right one.
///
/// Angles of incidence are positive for light that comes from the base's side of the face's normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prism {
    /// The angle between the faces.
    pub apex: f64,
    /// Its index.
    pub index: f64,
}

/// What becomes of a ray through a prism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dispersed {
    /// Where it leaves: how far from the edge along the right face.
    pub exit: f64,
    /// The angle of its direction to the x axis, upwards.
    pub direction: f64,
    /// The share of the light that passes both boundaries, without any inner reflection.
    pub share: f64,
}

impl Prism {
    /// The angle by which light is turned towards the base, i₁ + i₂ − A with sin i₂ = n sin(A − asin(sin i₁ / n)); `None` if it is totally
    /// reflected at the second face.
    #[must_use]
    pub fn deviation(&self, incidence: f64) -> Option<f64> {
        let first = refracted(incidence, self.index)?;
        Some(incidence + refracted(self.apex - first, 1.0 / self.index)? - self.apex)
    }

    /// The least deviation, 2 asin(n sin(A/2)) − A, and the angle of incidence that has it; `None` if nothing passes.
    #[must_use]
    pub fn least_deviation(&self) -> Option<[f64; 2]> {
        let incidence = refracted(self.apex / 2.0, 1.0 / self.index)?;
        Some([2.0 * incidence - self.apex, incidence])
    }

    /// A ray that meets the left face at distance `entry` from the edge, with this angle of incidence; `None` if it doesn't leave through the
    /// right face, which is taken as endless.
    #[must_use]
    pub fn ray(&self, entry: f64, incidence: f64) -> Option<Dispersed> {
        let first = refracted(incidence, self.index)?;
        let second = self.apex - first;
        let deviation = self.deviation(incidence)?;
        // The law of sines in the triangle of edge, entry and exit.
        let exit = entry * first.cos() / second.cos();
        let share = (1.0 - reflectance(incidence, self.index)) * (1.0 - reflectance(second.abs(), 1.0 / self.index));
        Some(Dispersed { exit, direction: incidence - self.apex / 2.0 - deviation, share })
    }

    /// The point of the left (−1) or right (1) face at a distance from the edge.
    #[must_use]
    pub fn face(&self, side: f64, distance: f64) -> [f64; 2] {
        let (sin, cos) = (self.apex / 2.0).sin_cos();
        [side * sin * distance, -cos * distance]
    }

    /// The height y at which a ray meets the plane x = `plane` behind the prism; `None` if it doesn't.
    #[must_use]
    pub fn height(&self, entry: f64, incidence: f64, plane: f64) -> Option<f64> {
        let ray = self.ray(entry, incidence)?;
        let [x, y] = self.face(1.0, ray.exit);
        (ray.direction.cos() > 0.0 && plane >= x).then(|| y + ray.direction.tan() * (plane - x))
    }
}

/// A lens with a spherical face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lens {
    /// A full sphere.
    Ball,
    /// A hemisphere whose round face is towards the light.
    RoundFirst,
    /// A hemisphere whose flat face is towards the light.
    FlatFirst,
}

/// Which way light goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Reflected from outside by the round face that light meets first.
    Reflected,
    /// Through the lens, with so many inner reflections. Hemispheres have the way without any alone.
    Through(u32),
}

/// Parallel light of irradiance 1 along the axis, through a lens onto a screen across the axis.
///
/// Rays are told apart by the angle i in [0, π/2] with the height sin i times the radius above the axis, which for the round face first is the
/// angle of incidence. Everything is exact: rays are traced in the meridional plane by trigonometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Focus {
    /// The lens, with the sphere's centre at the origin of the axis.
    pub lens: Lens,
    /// The sphere's radius.
    pub radius: f64,
    /// The index.
    pub index: f64,
    /// How far behind the sphere's centre the screen is; at least the radius.
    pub distance: f64,
}

/// Where a ray meets the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Height above the axis; negative if the ray has crossed it.
    pub height: f64,
    /// Its derivative by the ray's angle.
    pub slope: f64,
    /// The share of the light that goes this way.
    pub share: f64,
}

/// A ray behind the lens, in the meridional plane.
struct Outgoing {
    /// A point of it along the axis and above it, with derivatives by the angle i.
    place: [f64; 2],
    place_slope: [f64; 2],
    /// The angle by which it goes down towards the axis, and its derivative.
    turned: f64,
    turned_slope: f64,
    share: f64,
}

/// Cells in which roots are looked for.
const CELLS: u32 = 2048;
/// Of the quadrature.
const TOLERANCE: f64 = 1e-10;

impl Focus {
    /// Where the ray of angle i meets the screen; `None` if it doesn't or no light goes this way.
    #[must_use]
    pub fn spot(&self, way: Way, angle: f64) -> Option<Spot> {
        let ray = match (self.lens, way) {
            (Lens::Ball | Lens::RoundFirst, Way::Reflected) => self.reflected(angle),
            (Lens::Ball, Way::Through(inner)) => self.through_ball(angle, inner)?,
            (Lens::RoundFirst, Way::Through(0)) => self.round_first(angle)?,
            (Lens::FlatFirst, Way::Through(0)) => self.flat_first(angle)?,
            _ => return None,
        };
        let cosine = ray.turned.cos();
        let ahead = self.distance - ray.place[0];
        if cosine <= 0.0 || ahead < 0.0 {
            return None;
        }
        let tangent = ray.turned.tan();
        Some(Spot {
            height: ray.place[1] - tangent * ahead,
            slope: ray.place_slope[1] - ray.turned_slope * ahead / (cosine * cosine) + tangent * ray.place_slope[0],
            share: ray.share,
        })
    }

    /// A point of the sphere at an angle from the side that the light comes from, and its derivative where the angle's is `slope`.
    fn on_sphere(&self, angle: f64, slope: f64) -> [[f64; 2]; 2] {
        let (sin, cos) = angle.sin_cos();
        [[-self.radius * cos, self.radius * sin], [self.radius * sin * slope, self.radius * cos * slope]]
    }

    fn reflected(&self, angle: f64) -> Outgoing {
        let [place, place_slope] = self.on_sphere(angle, 1.0);
        let share = reflectance(angle, self.index);
        Outgoing { place, place_slope, turned: 2.0 * angle - PI, turned_slope: 2.0, share }
    }

    /// The angle of refraction and its derivative.
    fn inside(&self, angle: f64) -> Option<[f64; 2]> {
        let refraction = refracted(angle, self.index)?;
        Some([refraction, angle.cos() / (self.index * refraction.cos())])
    }

    /// Each chord takes the ray on by π − 2r around the centre, and each inner reflection turns it by as much.
    fn through_ball(&self, angle: f64, inner: u32) -> Option<Outgoing> {
        let [refraction, slope] = self.inside(angle)?;
        let inner = f64::from(inner);
        let chord = PI - 2.0 * refraction;
        let [place, place_slope] = self.on_sphere(angle + (inner + 1.0) * chord, 1.0 - 2.0 * (inner + 1.0) * slope);
        let reflected = reflectance(angle, self.index);
        Some(Outgoing {
            place,
            place_slope,
            // Taken into (−π, π], so that tangents of large angles lose nothing.
            turned: remainder(2.0 * (angle - refraction) + inner * chord),
            turned_slope: 2.0 * (1.0 - slope) - 2.0 * inner * slope,
            share: (1.0 - reflected).powi(2) * reflected.powf(inner),
        })
    }

    fn round_first(&self, angle: f64) -> Option<Outgoing> {
        let [refraction, slope] = self.inside(angle)?;
        let (down, down_slope) = (angle - refraction, 1.0 - slope);
        let turned = refracted(down, 1.0 / self.index)?;
        let [[z, height], [z_slope, height_slope]] = self.on_sphere(angle, 1.0);
        let (tangent, cosine) = (down.tan(), down.cos());
        Some(Outgoing {
            place: [0.0, height + tangent * z],
            place_slope: [0.0, height_slope + tangent * z_slope + down_slope * z / (cosine * cosine)],
            turned,
            turned_slope: self.index * cosine * down_slope / turned.cos(),
            share: (1.0 - reflectance(angle, self.index)) * (1.0 - reflectance(down, 1.0 / self.index)),
        })
    }

    fn flat_first(&self, angle: f64) -> Option<Outgoing> {
        let leaving = refracted(angle, 1.0 / self.index)?;
        let [place, place_slope] = self.on_sphere(PI - angle, -1.0);
        Some(Outgoing {
            place,
            place_slope,
            turned: leaving - angle,
            turned_slope: self.index * angle.cos() / leaving.cos() - 1.0,
            share: (1.0 - reflectance(0.0, self.index)) * (1.0 - reflectance(angle, 1.0 / self.index)),
        })
    }

    /// Angles between which the distance from the axis is monotonous: the ends of equal cells, and where it turns.
    fn nodes(&self, way: Way) -> Vec<f64> {
        let at = |cell: u32| FRAC_PI_2 * f64::from(cell) / f64::from(CELLS);
        let rising = |spot: Spot| spot.height * spot.slope > 0.0;
        let mut nodes = vec![0.0];
        for cell in 0..CELLS {
            let [from, to] = [at(cell), at(cell + 1)];
            nodes.extend(self.change(way, [from, to], rising));
            nodes.push(to);
        }
        nodes
    }

    /// Where between two angles a property of the spot changes, if it isn't the same at both; no spot has the property.
    fn change(&self, way: Way, [mut low, mut high]: [f64; 2], property: impl Fn(Spot) -> bool) -> Option<f64> {
        let has = |angle: f64| self.spot(way, angle).is_some_and(&property);
        let first = has(low);
        if has(high) == first {
            return None;
        }
        loop {
            let middle = f64::midpoint(low, high);
            if middle <= low || middle >= high {
                return Some(middle);
            }
            if has(middle) == first { low = middle } else { high = middle }
        }
    }

    /// The flux within a distance of the axis on the screen: ∫ share 2π h dh over the rays that end there, to 10⁻⁹ of it.
    #[must_use]
    pub fn flux(&self, way: Way, within: f64) -> f64 {
        let inside = |spot: Spot| spot.height.abs() <= within;
        let nodes = self.nodes(way);
        let mut ends = vec![0.0];
        for pair in nodes.windows(2) {
            ends.extend(self.change(way, [pair[0], pair[1]], inside));
        }
        ends.push(FRAC_PI_2);
        let share = |angle: f64| {
            let spot = self.spot(way, angle).filter(|spot| inside(*spot));
            spot.map_or(0.0, |spot| spot.share * angle.sin() * angle.cos())
        };
        let parts = ends.windows(2).filter(|p| self.spot(way, f64::midpoint(p[0], p[1])).is_some_and(inside));
        2.0 * PI * self.radius.powi(2) * parts.map(|p| integrate(&share, p[0], p[1], TOLERANCE)).sum::<f64>()
    }

    /// The irradiance at a distance r > 0 from the axis, relative to that of the beam: Σ share |h dh / (r dr)| over the rays that end there.
    #[must_use]
    pub fn irradiance(&self, way: Way, at: f64) -> f64 {
        let nodes = self.nodes(way);
        let roots = nodes.windows(2).filter_map(|p| self.change(way, [p[0], p[1]], |s| s.height.abs() <= at));
        let light = |angle: f64| {
            // A ray whose end leaves the screen is no root.
            let spot = self.spot(way, angle).filter(|s| (s.height.abs() / at - 1.0).abs() <= 1e-6)?;
            Some(spot.share * self.radius.powi(2) * angle.sin() * angle.cos() / (at * spot.slope.abs()))
        };
        roots.filter_map(light).sum()
    }

    /// The distances from the axis where caustics are: where neighbouring rays meet the screen at the same distance, and irradiance is
    /// infinite.
    #[must_use]
    pub fn folds(&self, way: Way) -> Vec<f64> {
        let at = |cell: u32| FRAC_PI_2 * f64::from(cell) / f64::from(CELLS);
        let turns = (0..CELLS).filter_map(|cell| self.change(way, [at(cell), at(cell + 1)], |s| s.slope > 0.0));
        let fold = |angle: f64| self.spot(way, angle).filter(|s| s.slope.abs() <= 1e-6 * self.radius);
        turns.filter_map(fold).map(|spot| spot.height.abs()).collect()
    }
}

/// An angle in (−π, π].
fn remainder(angle: f64) -> f64 {
    angle - 2.0 * PI * (angle / (2.0 * PI)).round()
}

#[cfg(test)]
mod tests {
    use super::*;

    const BALLS: [(f64, f64); 4] = [(1.5, 1.0), (1.5, 1.7), (1.33, 3.0), (1.8, 1.2)];

    #[allow(clippy::many_single_char_names, reason = "vectors of a formula")]
    fn refract([a, b]: [f64; 2], [x, y]: [f64; 2], index: f64) -> Option<[f64; 2]> {
        // Snell's law by tangential components: those of direction are kept up to the index.
        let sign = if a * x + b * y < 0.0 { 1.0 } else { -1.0 };
        let (normal, tangent) = ([x * sign, y * sign], [-y * sign, x * sign]);
        let along = (a * tangent[0] + b * tangent[1]) / index;
        let down = (1.0 - along * along).max(0.0).sqrt();
        (along.abs() <= 1.0).then(|| [0, 1].map(|k| tangent[k] * along - normal[k] * down))
    }

    /// The second meeting with the unit circle from a point on it.
    fn chord(p: [f64; 2], d: [f64; 2]) -> [f64; 2] {
        let t = -2.0 * (p[0] * d[0] + p[1] * d[1]);
        [p[0] + t * d[0], p[1] + t * d[1]]
    }

    fn mirror(d: [f64; 2], n: [f64; 2]) -> [f64; 2] {
        let c = d[0] * n[0] + d[1] * n[1];
        [d[0] - 2.0 * c * n[0], d[1] - 2.0 * c * n[1]]
    }

    fn at(p: [f64; 2], d: [f64; 2], plane: f64) -> Option<f64> {
        (d[0] > 0.0 && p[0] <= plane).then(|| p[1] + d[1] / d[0] * (plane - p[0]))
    }

    #[track_caller]
    fn assert_near(found: Option<f64>, expected: Option<f64>, tolerance: f64, what: &str) {
        match (found, expected) {
            (None, None) => {}
            (Some(a), Some(b)) => assert!((a - b).abs() <= tolerance * (1.0 + b.abs()), "{what}: {a}, not {b}"),
            _ => panic!("{what}: {found:?}, not {expected:?}"),
        }
    }

    /// `independent`: rays traced by vectors.
    #[test]
    fn spots_are_those_of_rays_traced_by_vectors() {
        for (index, distance) in BALLS {
            for step in 1..200 {
                let angle = (f64::from(step) - 0.37) / 200.0 * FRAC_PI_2;
                let entry = [-angle.cos(), angle.sin()];
                let height =
                    |lens, way| Focus { lens, radius: 1.0, index, distance }.spot(way, angle).map(|s| s.height);
                let name = |lens: Lens, way: Way| format!("{lens:?} {way:?} {index} {angle}");
                let outside = at(entry, mirror([1.0, 0.0], entry), distance);
                assert_near(height(Lens::Ball, Way::Reflected), outside, 1e-9, &name(Lens::Ball, Way::Reflected));
                let first = refract([1.0, 0.0], entry, index).unwrap();
                let (mut place, mut inside) = (chord(entry, first), first);
                for inner in 0..4 {
                    let out = refract(inside, place, 1.0 / index).unwrap();
                    let way = Way::Through(inner);
                    assert_near(height(Lens::Ball, way), at(place, out, distance), 1e-8, &name(Lens::Ball, way));
                    inside = mirror(inside, place);
                    place = chord(place, inside);
                }
                let middle = at(entry, first, 0.0).unwrap();
                let out = refract(first, [1.0, 0.0], 1.0 / index);
                let expected = out.and_then(|out| at([0.0, middle], out, distance));
                assert_near(height(Lens::RoundFirst, Way::Through(0)), expected, 1e-9, "round face first");
                let leaving = [angle.cos(), angle.sin()];
                let expected = refract([1.0, 0.0], leaving, 1.0 / index).and_then(|d| at(leaving, d, distance));
                assert_near(height(Lens::FlatFirst, Way::Through(0)), expected, 1e-9, "flat face first");
            }
        }
    }

    #[test]
    fn slopes_are_differences() {
        for (index, distance) in BALLS {
            for (lens, ways) in [
                (Lens::Ball, &[Way::Reflected, Way::Through(0), Way::Through(1), Way::Through(2)][..]),
                (Lens::RoundFirst, &[Way::Through(0)]),
                (Lens::FlatFirst, &[Way::Through(0)]),
            ] {
                let focus = Focus { lens, radius: 1.0, index, distance };
                let mut compared = 0;
                for (way, step) in ways.iter().flat_map(|way| (1..90).map(move |step| (*way, f64::from(step) / 60.0))) {
                    let height = |angle| focus.spot(way, angle).map(|s| s.height);
                    let slope = |h: f64| Some((height(step + h)? - height(step - h)?) / (2.0 * h));
                    let (Some(spot), Some(fine), Some(coarse)) = (focus.spot(way, step), slope(1e-5), slope(2e-5))
                    else {
                        continue;
                    };
                    // Truncation is a third of what the step makes; rounding is that of heights over the step.
                    let tolerance = (fine - coarse).abs() + 1e-9 * (1.0 + spot.height.abs());
                    assert!((spot.slope - fine).abs() <= tolerance, "{focus:?} {way:?} {step}: {spot:?}, not {fine}");
                    compared += 1;
                }
                assert!(compared >= 20, "{focus:?}");
            }
        }
    }

    /// Closed forms of Gaussian optics: focal lengths from the principal planes, here from the sphere's centre.
    #[test]
    fn rays_near_the_axis_meet_at_the_focus() {
        for index in [1.33_f64, 1.5, 1.9] {
            let ball = index / (2.0 * (index - 1.0));
            // A thick lens with one flat face: f = 1/(n − 1) from the curved face's vertex, or, seen through the flat face, 1/n less.
            let round = 1.0 / (index - 1.0) - 1.0 / index;
            let flat = 1.0 / (index - 1.0) + 1.0;
            for (lens, distance) in [(Lens::Ball, ball), (Lens::RoundFirst, round), (Lens::FlatFirst, flat)] {
                let angle = 1e-3;
                let focus = Focus { lens, radius: 1.0, index, distance };
                let Some(spot) = focus.spot(Way::Through(0), angle) else { continue };
                assert!(spot.height.abs() <= 10.0 * angle.powi(3), "{focus:?}: {spot:?}");
            }
        }
    }

    /// ∫ 2π r E dr over rings is the flux within them, away from folds.
    #[test]
    fn irradiance_is_the_density_of_flux() {
        let mut folds = 0;
        for (index, distance) in BALLS {
            for (lens, way) in [
                (Lens::Ball, Way::Through(0)),
                (Lens::Ball, Way::Through(2)),
                (Lens::Ball, Way::Reflected),
                (Lens::RoundFirst, Way::Through(0)),
                (Lens::FlatFirst, Way::Through(0)),
            ] {
                let focus = Focus { lens, radius: 1.0, index, distance };
                folds += focus.folds(way).len();
                for ring in [[0.1, 0.11], [0.2, 0.22], [0.5, 0.52], [2.0, 2.1]] {
                    if focus.folds(way).iter().any(|fold| (ring[0] - 0.05..ring[1] + 0.05).contains(fold)) {
                        continue;
                    }
                    let density = |r: f64| 2.0 * PI * r * focus.irradiance(way, r);
                    let [found, expected] = [
                        integrate(&density, ring[0], ring[1], 1e-7),
                        focus.flux(way, ring[1]) - focus.flux(way, ring[0]),
                    ];
                    let tolerance = 1e-6 * (expected + 1e-3);
                    assert!(
                        (found - expected).abs() <= tolerance,
                        "{focus:?} {way:?} {ring:?}: {found}, not {expected}"
                    );
                }
            }
        }
        assert!(folds >= 3, "{folds}");
    }

    /// Evenly spaced rays of equal flux are counted.
    #[test]
    fn flux_is_the_sum_over_rays() {
        for (index, distance) in BALLS {
            let focus = Focus { lens: Lens::Ball, radius: 1.0, index, distance };
            for way in [Way::Reflected, Way::Through(0), Way::Through(1), Way::Through(2)] {
                for within in [0.05, 0.4, 1.0, 3.0, 1e3] {
                    let rays = 100_000_u32;
                    let ray = |k: u32| ((f64::from(k) + 0.5) / f64::from(rays)).sqrt().asin();
                    let light = (0..rays).filter_map(|k| focus.spot(way, ray(k)));
                    let inside = light.filter(|s| s.height.abs() <= within).map(|s| s.share).sum::<f64>();
                    let (found, expected) = (focus.flux(way, within), PI * inside / f64::from(rays));
                    // A ray more or less at each of some limits.
                    assert!(
                        (found - expected).abs() <= 4.0 * PI / f64::from(rays),
                        "{focus:?} {way:?} {within}: {found}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_plates_shares_are_the_sums_of_their_series() {
        let plate = Plate { thickness: 0.5, index: 1.6, absorption: 0.3 };
        for incidence in [0.0, 0.5, 1.0, 1.4] {
            let (r, t) = (reflectance(incidence, 1.6), plate.remaining(incidence));
            let (mut light, mut passes, mut back) = ((1.0 - r) * t, 0.0, r);
            for _ in 0..200 {
                passes += light * (1.0 - r);
                light *= r * t;
                back += light * (1.0 - r);
                light *= r * t;
            }
            let [found, returned] = plate.shares(incidence);
            assert!((found - passes).abs() <= 1e-14 && (returned - back).abs() <= 1e-14, "{incidence}");
            let clear = Plate { absorption: 0.0, ..plate };
            let [found, returned] = clear.shares(incidence);
            assert!((found - (1.0 - r) / (1.0 + r)).abs() <= 1e-15 && (found + returned - 1.0).abs() <= 1e-15);
        }
        // The construction in the triangle of the way inside: d sin(θ − θ′) / cos θ′.
        let inside = (1.0_f64.sin() / 1.6).asin();
        assert!((plate.shift(1.0) - 0.5 * (1.0 - inside).sin() / inside.cos()).abs() <= 1e-15);
    }

    /// `independent`: rays traced by vectors.
    #[test]
    fn a_prisms_rays_are_those_traced_by_vectors() {
        for (apex, index) in [(60.0_f64, 1.5), (60.0, 1.78), (30.0, 1.9), (45.0, 1.33)] {
            let prism = Prism { apex: apex.to_radians(), index };
            let (sin, cos) = (prism.apex / 2.0).sin_cos();
            let [least, at_least] = prism.least_deviation().unwrap();
            assert!((prism.deviation(at_least).unwrap() - least).abs() <= 1e-14);
            assert!((((prism.apex + least) / 2.0).sin() / sin - index).abs() <= 1e-13);
            for step in -10..=14 {
                let incidence = f64::from(step) * 0.1;
                let direction = incidence - prism.apex / 2.0;
                let inside = refract([direction.cos(), direction.sin()], [-cos, sin], index).unwrap();
                let entry = prism.face(-1.0, 2.0);
                // Where it meets the other face's plane.
                let way = -(entry[0] * cos + entry[1] * sin) / (inside[0] * cos + inside[1] * sin);
                let exit = [entry[0] + way * inside[0], entry[1] + way * inside[1]];
                let expected = refract(inside, [cos, sin], 1.0 / index).and_then(|out| at(exit, out, 10.0));
                let expected = expected.filter(|_| way > 0.0);
                let found = prism.height(2.0, incidence, 10.0).filter(|_| way > 0.0);
                assert_near(found, expected, 1e-10, &format!("{prism:?} {incidence}"));
                if let (Some(deviation), Some(_)) = (prism.deviation(incidence), expected) {
                    assert!(deviation >= least - 1e-14);
                }
            }
        }
    }
}
